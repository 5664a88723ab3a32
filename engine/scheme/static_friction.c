// Friction of load steps: Coulomb's law with what presses at the end of the step.
//
// With given normal forces friction has a potential (Coulomb's law becomes Tresca's), which Newton's method minimises
// with all else, however far it is; then they are taken anew where that has led, and so on. From round to round the
// normal forces come nearer to their own by a part alone, 0.7 to 0.9 of what is left with a coefficient of 0.5 between
// disks, and where they push each other to and fro, more at a time, they never do: in round after round they go past
// what they should be. Two things are done about it:
//
// - where a round has not come nearer, friction is taken halfway, or a quarter of the way, to where it led
// - once forces with what presses there are nearly balanced, friction follows what presses: Newton's method with the
//   whole derivative, which is not symmetric, in 2 to 12 steps: what slips is found with forces that are unknowns of
//   their own (barrier_slip.c). Where that does not get there, as where corners of surfaces slide onto each other and
//   no equilibrium is near, rounds go on from where less is left
//
// What is not balanced with friction taken where bodies are is no equilibrium, however well each potential is
// minimised: a body that slides away, say. It is in vain to minimise the first ones well, while bodies that only
// friction holds have none.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "scheme/implicit.h"

static const double NEAR = 0.5, NEARER = 0.5;          // of the forces that act; of what was left when it was in vain
static const double LEAST_SHARE = 0.25, NO_LESS = 0.9; // of the way; of what was left before
enum { AT_ONCE = 4, LONG = 12 };                       // iterations

typedef struct rubbing {
    struct brunt_implicit *m;
    brunt_minimise *minimise;
    brunt_newton_report *report;
    int32_t left;       // iterations
    double share;       // of the way from where friction was taken last at which it is taken
    double off, before; // what is unbalanced with friction as it is at u, and was after the round before
    double near;        // below it friction is let follow
} rubbing;

// Takes friction anew.
static int take(rubbing *r, brunt_error *error) {
    brunt_fields *f = &r->m->field;
    const int64_t all = brunt_implicit_components(r->m);
    for (int64_t k = 0; k < all; k++) f->rub[k] += r->share < 1 ? r->share * (f->u[k] - f->rub[k]) : 0;
    if (r->share == 1) memcpy(f->rub, f->u, (size_t)all * sizeof *f->u);
    return brunt_barrier_lag(r->m->contact.barrier, &r->m->team, f->rub, error);
}

// Minimises with friction as it was taken, for as many iterations.
static int minimise_some(rubbing *r, int32_t most, brunt_error *error) {
    const brunt_newton_options asked = r->m->options;
    r->m->options.stable = false;
    r->m->options.iterations = r->left > most ? most : r->left > 0 ? r->left : 1; // at last it is only looked at
    const int status = r->minimise(r->m, r->report, error);
    r->m->options = asked;
    r->left -= r->report->iterations;
    return status;
}

// What is left of forces with friction as it is at u.
static int measure(rubbing *r, brunt_error *error) {
    struct brunt_implicit *m = r->m;
    const brunt_fold *fold = brunt_unknowns_fold(&m->unknowns);
    int status = BRUNT_OK;
    brunt_barrier_follow(m->contact.barrier, true);
    for (int t = 0; !status && t < m->term_count; t++)
        if (m->term[t].ops->look) status = m->term[t].ops->look(m->term[t].self, &m->team, m->field.u, NULL, error);
    if (!status) brunt_implicit_gradient(m, 0, m->term_count, m->field.u, m->field.step);
    brunt_barrier_follow(m->contact.barrier, false);
    if (fold) brunt_fold_gather(fold, m->unknowns.dim, m->field.step);
    r->before = r->off;
    if (!status) r->off = brunt_static_unbalance(m, m->field.step);
    return status;
}

// Newton's method while friction follows what presses.
static int follow(rubbing *r, brunt_error *error) {
    struct brunt_implicit *m = r->m;
    const brunt_newton_options asked = m->options;
    const bool forces = m->forces;
    m->options.solver = &brunt_linear_unsymmetric, m->options.fallback = false, m->forces = true;
    brunt_barrier_follow(m->contact.barrier, true);
    const int status = minimise_some(r, LONG, error);
    brunt_barrier_follow(m->contact.barrier, false);
    m->options = asked, m->forces = forces;
    return status;
}

// Whether that has led to an equilibrium, and a stable one, which forces alone do not tell. In vain: u is where less is
// left, there or before.
static bool follows(rubbing *r) {
    struct brunt_implicit *m = r->m;
    const size_t bytes = (size_t)brunt_implicit_components(m) * sizeof(double);
    brunt_error vain = {.id = -1};
    memcpy(m->field.tried, m->field.u, bytes);
    const bool balanced = follow(r, &vain) == BRUNT_OK;
    const bool less = r->report->result != BRUNT_NEWTON_BROKEN && r->report->unbalance < r->off;
    r->share = 1;
    if (balanced && !take(r, &vain) && !r->minimise(m, r->report, &vain)) return true;
    r->near = NEARER * r->off;
    if (balanced || !less) memcpy(m->field.u, m->field.tried, bytes);
    return false;
}

static int reserve(struct brunt_implicit *m, brunt_error *error) {
    const size_t n = (size_t)brunt_implicit_components(m) + 1;
    return BRUNT_CAPACITY(m->field.rub, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(m->field.tried, n, 0, "unknowns", error);
}

int brunt_static_rub(struct brunt_implicit *m, brunt_minimise *minimise, brunt_newton_report *report,
                     brunt_error *error) {
    rubbing r = {
        .m = m, .minimise = minimise, .report = report, .left = m->options.iterations, .share = 1, .near = NEAR};
    const bool direct = m->options.solver != &brunt_linear_pcg || m->options.fallback;
    if (reserve(m, error)) return BRUNT_FAILED;
    for (int round = 0; r.left >= 0; round++) {
        const double share = r.share;
        brunt_error tried = {.id = -1};
        if (take(&r, error)) return BRUNT_FAILED;
        const int status = minimise_some(&r, round < 2 ? AT_ONCE : LONG, &tried);
        if (status && report->result != BRUNT_NEWTON_ITERATIONS) {
            if (error) *error = tried;
            return BRUNT_FAILED;
        }
        // Forces balance where friction has just been taken: nothing is left to do but to ask whether it is stable.
        if (!status && report->iterations == 0 && share == 1) return minimise(m, report, error);
        if (measure(&r, error)) return BRUNT_FAILED;
        r.share = round < 2 || r.off < NO_LESS * r.before ? 1 : fmax(LEAST_SHARE, 0.5 * share);
        if (!status && report->iterations == 0) r.share = 1;
        if (direct && r.left > 0 && r.off < r.near && follows(&r)) return BRUNT_OK;
    }
    report->result = BRUNT_NEWTON_ITERATIONS;
    return brunt_fail(error, BRUNT_FAILED,
                      "friction does not settle within %d iterations (newton.iterations): %.3g of the forces that act "
                      "are left.",
                      m->options.iterations, r.off);
}
