// Friction of load steps: Coulomb's law with what presses at the end of the step.
//
// Rounds: in each, friction has a potential in which surfaces that slip come apart, and are given back what they came
// apart by where the round began (barrier_cone.c). Newton's method minimises it with all else, however far that is, for
// a few iterations, or as well as there is use for; the next round begins there. From round to round the slips change
// by less, by .1 to .9 of what they did, and forces are Coulomb's where they change no more. With given normal forces
// (Tresca's law) that goes on without end where disks push each other to and fro.
//
// Once forces are nearly balanced, and Newton's method goes straight, friction follows what presses: Newton's method
// with the whole derivative, which is not symmetric, in 2 to 12 steps: what slips is found with forces that are
// unknowns of their own (barrier_slip.c). Where that does not get there, as where corners of surfaces slide onto each
// other and no equilibrium is near, rounds go on from where less is left.
//
// What is not balanced with friction taken where bodies are is no equilibrium, however well each potential is
// minimised: a body that slides away, say.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "scheme/implicit.h"

// Of the forces that act; of what was left when it was in vain; of what is left, in a round.
static const double NEAR = 0.5, NEARER = 0.5, ENOUGH = 0.03, NO_LESS = 0.9;
enum { AT_ONCE = 3, LONG = 12 }; // iterations
enum { VAIN = 2 };               // rounds

typedef struct rubbing {
    struct brunt_implicit *m;
    brunt_minimise *minimise;
    brunt_newton_report *report;
    int32_t left; // iterations
    double off;   // what is unbalanced with friction as it is at u; INFINITY: not known
    double near;  // below it friction is let follow
    double best;  // of off after all rounds, where bodies were at field.best
    double least; // since rounds became of this kind
    int in_vain;  // rounds since that was lessened
    bool lags;    // what presses is given in rounds
} rubbing;

// Minimises for as many iterations, or until what is unbalanced is below the tolerance.
static int minimise_some(rubbing *r, int32_t most, double tolerance, brunt_error *error) {
    const brunt_newton_options asked = r->m->options;
    r->m->options.stable = false, r->m->options.tolerance = tolerance;
    r->m->options.iterations = r->left > most ? most : r->left > 0 ? r->left : 1; // at last it is only looked at
    const int status = r->minimise(r->m, r->report, error);
    r->m->options = asked;
    r->left -= r->report->iterations;
    return status;
}

// A round from where bodies are.
static int round_from(rubbing *r, brunt_error *error) {
    brunt_fields *f = &r->m->field;
    const double enough = r->off < INFINITY ? ENOUGH * r->off : 0;
    memcpy(f->rub, f->u, (size_t)brunt_implicit_components(r->m) * sizeof *f->u);
    r->report->result = BRUNT_NEWTON_BROKEN;
    if (r->lags && brunt_barrier_lag(r->m->contact.barrier, &r->m->team, f->u, error)) return BRUNT_FAILED;
    if (!r->lags) brunt_barrier_associate(r->m->contact.barrier, f->rub);
    const int status = minimise_some(r, r->lags ? LONG : AT_ONCE, fmax(r->m->options.tolerance, enough), error);
    brunt_barrier_associate(r->m->contact.barrier, NULL);
    return status;
}

// Rounds of the other kind where these have not led anywhere. Where least is left is kept.
static void turn(rubbing *r) {
    const brunt_fields *f = &r->m->field;
    if (r->off < r->best) memcpy(f->best, f->u, (size_t)brunt_implicit_components(r->m) * sizeof *f->u);
    r->best = fmin(r->best, r->off);
    r->in_vain = r->off < NO_LESS * r->least ? 0 : r->in_vain + 1;
    r->least = fmin(r->least, r->off);
    if (r->in_vain < VAIN) return;
    r->lags = !r->lags, r->in_vain = 0, r->least = INFINITY;
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
    const int status = minimise_some(r, LONG, asked.tolerance, error);
    brunt_barrier_follow(m->contact.barrier, false);
    m->options = asked, m->forces = forces;
    return status;
}

// Whether where bodies are is a stable equilibrium, which forces alone do not tell.
static bool rests(rubbing *r, brunt_error *error) {
    struct brunt_implicit *m = r->m;
    return !brunt_barrier_lag(m->contact.barrier, &m->team, m->field.u, error) && !r->minimise(m, r->report, error);
}

// Whether friction that follows has led to one. In vain: u is where less is left, there or before.
static bool follows(rubbing *r) {
    struct brunt_implicit *m = r->m;
    const size_t bytes = (size_t)brunt_implicit_components(m) * sizeof(double);
    brunt_error vain = {.id = -1};
    memcpy(m->field.tried, m->field.u, bytes);
    const bool balanced = follow(r, &vain) == BRUNT_OK;
    const bool less = r->report->result != BRUNT_NEWTON_BROKEN && r->report->unbalance < r->off;
    if (balanced && rests(r, &vain)) return true;
    if (balanced || !less) memcpy(m->field.u, m->field.tried, bytes);
    r->near = NEARER * r->off, r->off = INFINITY;
    return false;
}

static int reserve(struct brunt_implicit *m, brunt_error *error) {
    const size_t n = (size_t)brunt_implicit_components(m) + 1;
    return BRUNT_CAPACITY(m->field.rub, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(m->field.tried, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(m->field.best, n, 0, "unknowns", error);
}

int brunt_static_rub(struct brunt_implicit *m, brunt_minimise *minimise, brunt_newton_report *report,
                     brunt_error *error) {
    rubbing r = {.m = m,
                 .minimise = minimise,
                 .report = report,
                 .left = m->options.iterations,
                 .off = INFINITY,
                 .near = NEAR,
                 .best = INFINITY,
                 .least = INFINITY};
    const bool direct = m->options.solver != &brunt_linear_pcg || m->options.fallback;
    if (reserve(m, error)) return BRUNT_FAILED;
    brunt_error tried;
    while (r.left > 0) {
        tried = (brunt_error){.id = -1};
        const bool taken = !round_from(&r, &tried) || report->result == BRUNT_NEWTON_ITERATIONS;
        // Where a round has led the slope of its potential is no longer that of its energy to the last digit.
        if (!taken && !(report->result == BRUNT_NEWTON_UPHILL && report->iterations > 0)) {
            if (error) *error = tried;
            return BRUNT_FAILED;
        }
        const bool straight = report->projections == 0;
        if (measure(&r, error)) return BRUNT_FAILED;
        turn(&r);
        if (r.off <= m->options.tolerance) return rests(&r, error) ? BRUNT_OK : BRUNT_FAILED;
        if (direct && straight && r.left > 0 && r.off < r.near && follows(&r)) return BRUNT_OK;
    }
    // What is said of it is said of where least was left.
    if (r.best < INFINITY) memcpy(m->field.u, m->field.best, (size_t)brunt_implicit_components(m) * sizeof *m->field.u);
    r.lags = true, round_from(&r, &tried);
    report->result = BRUNT_NEWTON_ITERATIONS;
    return brunt_fail(error, BRUNT_FAILED,
                      "friction does not settle within %d iterations (newton.iterations): %.3g of the forces that act "
                      "are left.",
                      m->options.iterations, r.best);
}
