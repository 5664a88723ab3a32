#include "contact/methods/augury_work.h"

#include "base/memory.h"

brunt_augury_workspace *brunt_augury_work(brunt_augury_workspace **work) {
    if (!*work) *work = brunt_alloc(sizeof **work);
    return *work;
}

void brunt_augury_workspace_free(brunt_augury_workspace *work) {
    if (!work) return;
    brunt_augury_near_free(&work->near);
    brunt_augury_grid_free(&work->grid);
    for (int c = 0; c < 4; c++) brunt_augury_cloud_free(&work->cloud[c]);
    brunt_averaged_work_free(work->averaged);
    brunt_published_work_free(work->published);
    brunt_free(work);
}

double brunt_impulse_account_node(brunt_contact_surface *s, brunt_impulse_account *action,
                                  const brunt_augury_impulse *impulse, bool second) {
    const int32_t n = impulse->node;
    double loss = 0;
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, l = (a + 2) % 3;
        const double J = impulse->J[a], work = J * 0.5 * (s->old[n][a] + s->v[n][a]);
        if (second) {
            action->impulse[a] += J;
            action->angular[a] += s->x[n][i] * impulse->J[l] - s->x[n][l] * impulse->J[i];
        }
        s->output.impulse[n][a] += J;
        // What prescribes a motion pays what the contact does to it.
        if (!(s->inverse[n][a] > 0)) action->external_work -= work;
        loss -= work;
    }
    return loss;
}
