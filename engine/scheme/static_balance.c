// What forces leave of each body once a load step has ended: those that act on it add up to nothing, but for this.
//
// Forces within a body add up to nothing, so that the sum of what is left at its free nodes is that of contact, loads
// and reactions on it. It says more than what is unbalanced of all forces: there a small body with small forces does
// not count.
#include <math.h>
#include <string.h>

#include "scheme/implicit.h"

typedef struct body_sum {
    double left[3], all; // [N] sum over free components; sizes of contact, loads and reactions, node by node
} body_sum;

static void add_nodes(const struct brunt_implicit *m, int32_t begin, int32_t end, body_sum *sum) {
    const brunt_fields *f = &m->field;
    const int dim = m->unknowns.dim;
    for (int64_t k = (int64_t)begin * dim; k < (int64_t)end * dim; k++) {
        sum->all += fabs(f->contact[k]) + fabs(f->load[k]);
        if (m->unknowns.held[k])
            sum->all += fabs(f->step[k]);
        else
            sum->left[k % dim] += f->step[k];
    }
}

static double part(const double left[3], double all) {
    return all > 0 ? sqrt(left[0] * left[0] + left[1] * left[1] + left[2] * left[2]) / all : 0;
}

static void take_body(struct brunt_implicit *m, int body, const body_sum *sum, body_sum *whole) {
    const double share = part(sum->left, sum->all);
    for (int a = 0; a < 3; a++) whole->left[a] += sum->left[a];
    whole->all += sum->all;
    if (share <= m->balance.body) return;
    m->balance.body = share, m->balance.worst = body;
}

void brunt_static_take_balance(struct brunt_implicit *m) {
    const brunt_unknowns *u = &m->unknowns;
    const brunt_bodies *bodies = &m->world->bodies;
    const brunt_fold *fold = brunt_unknowns_fold(u);
    body_sum whole = {.all = 0};
    m->balance = (brunt_balance){.worst = -1};
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        m->field.step[k] = m->field.gradient[k] - m->field.load[k];
    if (fold) brunt_fold_gather(fold, u->dim, m->field.step);
    for (int k = 0; k < bodies->fem_count; k++) {
        body_sum sum = {.all = 0};
        add_nodes(m, u->base[k], u->base[k] + bodies->fem[k].node_count, &sum);
        take_body(m, bodies->fem[k].index, &sum, &whole);
    }
    for (int i = 0; i < bodies->mpm_count; i++) {
        body_sum sum = {.all = 0};
        if (u->tie[i] != i) continue;
        for (int k = i; k < bodies->mpm_count; k++)
            if (u->tie[k] == i) add_nodes(m, u->grid_base[k], u->grid_base[k + 1], &sum);
        take_body(m, bodies->mpm[i].index, &sum, &whole);
    }
    m->balance.all = part(whole.left, whole.all);
}

bool brunt_world_balance(const brunt_world *world, brunt_balance *balance) {
    *balance = (brunt_balance){.worst = -1};
    if (!world->plan.implicit || !world->plan.implicit->still) return false;
    *balance = world->plan.implicit->balance;
    return true;
}
