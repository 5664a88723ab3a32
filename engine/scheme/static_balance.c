// What forces leave of each body once a load step has ended: those that act on it add up to nothing, but for this.
//
// Forces within a body add up to nothing, so that the sum of what is left at its free nodes is that of contact, loads
// and reactions on it. It says more than what is unbalanced of all forces: there a small body with small forces does
// not count.
#include <math.h>
#include <string.h>

#include "scheme/implicit.h"

static const double RESOLVED = 1e3; // times what Newton's method may leave of all forces

typedef struct body_sum {
    double left[3], all; // [N] sum over free components; sizes of contact, loads and reactions, node by node
    double rounding;     // [N] what rounding of places makes of them
} body_sum;

// `gradient`: of all forces, with contact's in `field.contact`.
static void add_nodes(const struct brunt_implicit *m, const double *gradient, int32_t begin, int32_t end,
                      body_sum *sum) {
    const brunt_fields *f = &m->field;
    const int dim = m->unknowns.dim;
    for (int64_t k = (int64_t)begin * dim; k < (int64_t)end * dim; k++) {
        sum->all += fabs(f->contact[k]) + fabs(f->load[k]);
        sum->rounding += brunt_static_rounding(m, k);
        if (m->unknowns.held[k])
            sum->all += fabs(gradient[k]);
        else
            sum->left[k % dim] += gradient[k];
    }
}

static double length(const double left[3]) { return sqrt(left[0] * left[0] + left[1] * left[1] + left[2] * left[2]); }

static double part(const double left[3], double all) { return all > 0 ? length(left) / all : 0; }

// What acts on body k, of elements, then of points; BRUNT_NONE: it is told with another, that it is tied to.
static int sum_body(const struct brunt_implicit *m, const double *gradient, int k, body_sum *sum) {
    const brunt_unknowns *u = &m->unknowns;
    const brunt_bodies *bodies = &m->world->bodies;
    const int i = k - bodies->fem_count;
    *sum = (body_sum){.all = 0};
    if (i < 0) {
        add_nodes(m, gradient, u->base[k], u->base[k] + bodies->fem[k].node_count, sum);
        return bodies->fem[k].index;
    }
    if (u->tie[i] != i) return BRUNT_NONE;
    for (int j = i; j < bodies->mpm_count; j++)
        if (u->tie[j] == i) add_nodes(m, gradient, u->grid_base[j], u->grid_base[j + 1], sum);
    return bodies->mpm[i].index;
}

// `act`: what forces on all bodies, or those within them, add up to; what Newton's method leaves is beside that. What
// has next to no forces, as a loose disk in a packing, has none that it resolves: what is left of them is told beside
// all.
static double resolved(const struct brunt_implicit *m, double all, double act) {
    return all < RESOLVED * m->options.tolerance * act ? act : all;
}

static void take_body(struct brunt_implicit *m, int body, const body_sum *sum, double act) {
    const double all = resolved(m, sum->all, act);
    const double share = act > m->scale.rounding ? part(sum->left, all) : 0;
    if (share <= m->balance.body) return;
    m->balance.body = share, m->balance.worst = body;
}

void brunt_static_take_balance(struct brunt_implicit *m) {
    const int count = m->world->bodies.fem_count + m->world->bodies.mpm_count;
    const brunt_fold *fold = brunt_unknowns_fold(&m->unknowns);
    body_sum whole = {.all = 0}, sum;
    m->balance = (brunt_balance){.worst = -1};
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        m->field.step[k] = m->field.gradient[k] - m->field.load[k];
    if (fold) brunt_fold_gather(fold, m->unknowns.dim, m->field.step);
    for (int k = 0; k < count; k++) {
        if (sum_body(m, m->field.step, k, &sum) < 0) continue;
        for (int a = 0; a < 3; a++) whole.left[a] += sum.left[a];
        whole.all += sum.all;
    }
    const double act = fmax(whole.all, m->scale.least);
    for (int k = 0; k < count; k++) {
        const int body = sum_body(m, m->field.step, k, &sum);
        if (body >= 0) take_body(m, body, &sum, act);
    }
    m->balance.all = act > m->scale.rounding ? part(whole.left, resolved(m, whole.all, act)) : 0;
}

double brunt_static_alone(struct brunt_implicit *m, const double *gradient, double act) {
    const int count = m->world->bodies.fem_count + m->world->bodies.mpm_count;
    double most = 0;
    body_sum sum;
    brunt_implicit_gradient(m, m->body_terms, m->term_count, m->field.u, m->field.contact);
    for (int k = 0; k < count; k++) {
        if (sum_body(m, gradient, k, &sum) < 0 || length(sum.left) <= sum.rounding) continue;
        most = fmax(most, part(sum.left, resolved(m, sum.all, act)));
    }
    return most;
}

bool brunt_world_balance(const brunt_world *world, brunt_balance *balance) {
    *balance = (brunt_balance){.worst = -1};
    if (!world->plan.implicit || !world->plan.implicit->still) return false;
    *balance = world->plan.implicit->balance;
    return true;
}
