#include "contact/constraint/impulse_account.h"

#include <math.h>

#include "base/error.h"

void brunt_impulse_account_add(brunt_impulse_account *sum, const brunt_impulse_account *part) {
    for (int a = 0; a < 3; a++) sum->impulse[a] += part->impulse[a], sum->angular[a] += part->angular[a];
    sum->external_work += part->external_work;
    sum->normal_loss += part->normal_loss;
    sum->friction_loss += part->friction_loss;
    sum->area = part->area;
}

void brunt_impulse_account_record(brunt_impulse_account *account, double *loss, const double J[3], const double x[3],
                                  const double old[3], const double now[3], const double carrier[3]) {
    for (int a = 0; a < 3; a++) {
        int i = (a + 1) % 3, j = (a + 2) % 3;
        account->impulse[a] += J[a];
        account->angular[a] += x[i] * J[j] - x[j] * J[i];
        account->external_work += J[a] * carrier[a];
        *loss -= J[a] * (0.5 * (old[a] + now[a]) - carrier[a]);
    }
}

void brunt_impulse_account_reaction(brunt_impulse_account *account, const double linear[3], const double angular[3]) {
    for (int a = 0; a < 3; a++) account->impulse[a] += linear[a], account->angular[a] += angular[a];
}

double brunt_impulse_account_node(brunt_contact_surface *s, brunt_impulse_account *account,
                                  const brunt_node_impulse *impulse, bool second) {
    const int32_t n = impulse->node;
    double loss = 0;
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, l = (a + 2) % 3;
        const double J = impulse->J[a], work = J * 0.5 * (s->old[n][a] + s->v[n][a]);
        if (second) {
            account->impulse[a] += J;
            account->angular[a] += s->x[n][i] * impulse->J[l] - s->x[n][l] * impulse->J[i];
        }
        s->output.impulse[n][a] += J;
        // What prescribes a motion pays what the contact does to it.
        if (!(s->inverse[n][a] > 0)) account->external_work -= work;
        loss -= work;
    }
    return loss;
}

void brunt_impulse_account_validate(const brunt_impulse_account *a) {
    for (int k = 0; k < 3; k++) BRUNT_ASSERT(isfinite(a->impulse[k]) && isfinite(a->angular[k]));
    BRUNT_ASSERT(isfinite(a->external_work) && isfinite(a->normal_loss) && isfinite(a->friction_loss) && a->area >= 0);
}
