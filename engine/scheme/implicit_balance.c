// Whether the forces on each body balance where Newton's method would end.
//
// A correction says how far a minimum is, not what forces are left: where something is very stiff - a barrier of large
// stiffness, friction with a large coefficient or a small slip speed - next to no way is a large force. Elastic forces
// within a body add up to nothing, so that what is left of the sum over its nodes is what contact, loads and inertia
// are off by. A body may be off by a velocity below the tolerance, or by a small part of the forces on it. What is left
// within it, elastic forces too, does work over the step that no account has: it is to be as small a part of the work
// of the forces on it, or next to nothing of all energy there has been.
#include <math.h>

#include "scheme/implicit.h"

static const double SMALL = 1e-4;  // of all forces on a body, node by node; of their work
static const double LITTLE = 1e-6; // of the energy that the ledger's error is told of

typedef struct body_forces {
    double left[3], mass[3]; // [N] sum over its free components, [kg] of those
    double all;              // [N] sizes of contact, loads, inertia and what holders give
    double work, all_work;   // [J] of what is left over the step; sizes of that of contact, loads and inertia
    double momentum;         // [kg m] sizes of free components' motion over the step
    double worst;            // [N] greatest that is left at a node
    int32_t node;            // which it is
} body_forces;

// [N] sizes of contact, load and inertia on a component. Newmark's method begins where the forces at the start lead to:
// friction that turns around within a step then hardly acts, however large it is.
static double node_forces(const struct brunt_implicit *m, const double *u, int64_t k) {
    const brunt_fields *f = &m->field;
    const double mass = m->unknowns.mass[k / m->unknowns.dim], drift = f->aim[k] - m->dt * m->unknowns.velocity[k];
    const double start = mass * drift / m->inertia.c, contact = f->step[k];
    return fmin(fabs(contact), fabs(contact - start)) + fabs(f->load[k]) +
           fabs(mass * (u[k] - f->aim[k]) / m->inertia.c + start);
}

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
        const double acts = node_forces(m, u, k);
        sum->left[k % dim] += left, sum->mass[k % dim] += mass;
        sum->all += acts;
        sum->work += left * u[k], sum->all_work += acts * fabs(u[k]), sum->momentum += mass * fabs(u[k]);
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
        const double allowed = fmax(m->tolerance * sum->mass[a] / m->dt, SMALL * sum->all);
        const double part = sum->left[a] == 0 ? 0 : fabs(sum->left[a]) / allowed;
        if (!(part <= most)) most = part;
    }
    const double whole = LITTLE * m->world->ledger.energy_scale;
    const double work = fmax(fmax(m->tolerance * sum->momentum / m->dt, SMALL * sum->all_work), whole);
    const double part = sum->work == 0 ? 0 : fabs(sum->work) / work;
    return part <= most ? most : part;
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
