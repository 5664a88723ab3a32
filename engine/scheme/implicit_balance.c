// Whether the forces on each body balance where Newton's method would end.
//
// A correction says how far a minimum is, not what forces are left: where something is very stiff - a barrier of large
// stiffness, friction with a large coefficient or a small slip speed - next to no way is a large force. Elastic forces
// within a body add up to nothing, so that what is left of the sum over its nodes is what contact, loads and inertia
// are off by. A body may be off by a velocity below the tolerance, or by a small part of the forces on it.
#include <math.h>

#include "scheme/implicit.h"

static const double SMALL_FORCE = 1e-4; // of all forces on a body, node by node

typedef struct body_forces {
    double left[3], mass[3]; // [N] sum over its free components, [kg] of those
    double all;              // [N] sizes of contact, loads, inertia and what holders give
    double worst;            // [N] greatest that is left at a node
    int32_t node;            // which it is
} body_forces;

// Nodes [begin, end), with gradients of contact and surfaces in `field.step`, of all else in `field.gradient`.
static void add_nodes(const struct brunt_implicit *m, const double *u, int32_t begin, int32_t end, body_forces *sum) {
    const brunt_unknowns *unknowns = &m->unknowns;
    const brunt_fields *f = &m->field;
    const int dim = unknowns->dim;
    for (int64_t k = (int64_t)begin * dim; k < (int64_t)end * dim; k++) {
        const double left = f->step[k] + f->gradient[k], mass = unknowns->mass[k / dim];
        if (unknowns->held[k]) {
            sum->all += fabs(left);
            continue;
        }
        sum->left[k % dim] += left, sum->mass[k % dim] += mass;
        sum->all += fabs(f->step[k]) + fabs(f->load[k]) + mass * fabs(u[k] - f->aim[k]) / m->inertia.c;
        if (fabs(left) >= sum->worst) sum->worst = fabs(left), sum->node = (int32_t)(k / dim);
    }
}

// Of points that are tied, and share nodes, together.
static void add_points(const struct brunt_implicit *m, const double *u, int i, body_forces *sum) {
    for (int k = i; k < m->world->bodies.mpm_count; k++)
        if (m->unknowns.tie[k] == i) add_nodes(m, u, m->unknowns.grid_base[k], m->unknowns.grid_base[k + 1], sum);
}

// What a body is off by, of what it may be; not a number where forces are none.
static double off_by(const struct brunt_implicit *m, const body_forces *sum) {
    double most = 0;
    for (int a = 0; a < m->unknowns.dim; a++) {
        const double allowed = fmax(m->tolerance * sum->mass[a] / m->dt, SMALL_FORCE * sum->all);
        const double part = sum->left[a] == 0 ? 0 : fabs(sum->left[a]) / allowed;
        if (!(part <= most)) most = part;
    }
    return most;
}

static void add_gradients(const struct brunt_implicit *m, int first, int end, const double *u, double *g) {
    for (int t = first; t < end; t++)
        if (m->term[t].ops->gradient) m->term[t].ops->gradient(m->term[t].self, &m->team, u, g);
}

// Of contact and of surfaces that hold (the rows, which come before the last of the fixed terms); of all else.
static void take_gradients(const struct brunt_implicit *m, const double *u) {
    const int rows = m->fixed_terms - (m->holds ? 2 : 0), rest = rows + (m->holds ? 1 : 0);
    brunt_implicit_gradient(m, m->body_terms, m->term_count, u, m->field.step);
    add_gradients(m, rows, rest, u, m->field.step);
    brunt_implicit_gradient(m, rest, m->body_terms, u, m->field.gradient);
    add_gradients(m, 0, rows, u, m->field.gradient);
    const brunt_fold *fold = brunt_unknowns_fold(&m->unknowns);
    if (!fold) return;
    brunt_fold_gather(fold, m->unknowns.dim, m->field.step);
    brunt_fold_gather(fold, m->unknowns.dim, m->field.gradient);
}

double brunt_implicit_balance(void *context, const brunt_team *team, const double *u) {
    struct brunt_implicit *m = context;
    const brunt_bodies *bodies = &m->world->bodies;
    double most = 0;
    (void)team;
    m->off.body = -1;
    if (m->pull.weight) return 0; // on the way to where it is to be
    take_gradients(m, u);
    for (int b = 0; b < bodies->fem_count + bodies->mpm_count; b++) {
        const int i = b - bodies->fem_count;
        body_forces sum = {.all = 0};
        if (i < 0)
            add_nodes(m, u, m->unknowns.base[b], m->unknowns.base[b] + bodies->fem[b].node_count, &sum);
        else
            add_points(m, u, i, &sum);
        const double off = off_by(m, &sum);
        if (off <= most) continue;
        most = off;
        m->off.body = i < 0 ? bodies->fem[b].index : bodies->mpm[i].index;
        m->off.node = sum.node, m->off.all = sum.all;
        m->off.left = fmax(fabs(sum.left[0]), fmax(fabs(sum.left[1]), fabs(sum.left[2])));
    }
    return most;
}
