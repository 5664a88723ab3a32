#include "linear/newton.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"

enum { HALVINGS = 60, FEW_HALVINGS = 12, MEMORY = 3 };
#define ROUNDING 4e-16      // of a sum, over the sizes of what was added
#define CLOSE 1e3           // a decrease within so many roundings is not judged by the energy
#define LEAST_GAIN 2        // roundings
#define LEAST_DECREASE 1e-4 // of the gradient, of what the step promises
#define LEAST_SHIFT 1e-13
#define MORE_SHIFT 100.0
#define SHIFT_LIMIT 1e-2
#define SOFTEST 1e-9 // of the diagonal: where bodies as wholes give way, they do so by about as much
#define SOFT 2e-5    // or by no more
#define CLOSELY 1e-2 // of the forces that act, to balance
#define SPARE 1e-14  // of the diagonal, that a matrix may miss by rounding to be positive definite
#define STUCK 0.5    // of the length two iterations ago
#define EARLY 0.1    // of the tolerance, that the next step would be; of the last step, that this one is

typedef struct newton_run {
    brunt_newton *n;
    const brunt_team *team;
    const brunt_problem *problem;
    const brunt_newton_options *options;
    brunt_newton_report *report;
    brunt_error *error;
    double *u;
    brunt_energy_sum energy; // at u
    double slope;            // gradient . step
    double length[MEMORY];   // without energies: of the gradient, of the last iterates
    double before;           // measure of the step before; 0: not of a full, unprojected one
    bool plain;              // the matrix was taken as it is
    bool looked;             // at u
    bool endless;            // what terms keep beside u followed without end
} newton_run;

static void phase(const newton_run *r, brunt_newton_phase now) {
    if (r->options->phase) r->options->phase(r->options->context, now);
}

static int64_t unknowns(const newton_run *r) { return (int64_t)r->problem->nodes * r->problem->dim; }

static void gather(const newton_run *r, double *g) {
    if (r->problem->fold) brunt_fold_gather(r->problem->fold, r->problem->dim, g);
}

// What there is instead of a minimum; the error has been said.
static int broken(newton_run *r, brunt_newton_result result) {
    r->report->result = result;
    return BRUNT_FAILED;
}

static int look(newton_run *r, const double *p) {
    for (int t = 0; t < r->problem->count; t++) {
        const brunt_term *term = r->problem->terms + t;
        if (term->ops->look && term->ops->look(term->self, r->team, r->u, p, r->error))
            return broken(r, BRUNT_NEWTON_BROKEN);
    }
    return BRUNT_OK;
}

// Sum over the terms; *outside: which of them is not finite, -1: none.
static brunt_energy_sum energy_at(const newton_run *r, const double *u, int *outside) {
    brunt_energy_sum sum = {0};
    *outside = -1;
    for (int t = 0; t < r->problem->count && *outside < 0; t++) {
        const brunt_term *term = r->problem->terms + t;
        const brunt_energy_sum e = term->ops->energy(term->self, r->team, u);
        sum.value += e.value, sum.magnitude += e.magnitude, sum.moduli += e.moduli;
        if (!isfinite(e.value)) *outside = t;
    }
    return sum;
}

// Its length. `asks`: how much is unbalanced is of interest, as it is not of places that are tried.
static double gradient_at(newton_run *r, const double *u, bool asks) {
    double *g = r->n->gradient, square = 0;
    memset(g, 0, (size_t)unknowns(r) * sizeof *g);
    for (int t = 0; t < r->problem->count; t++)
        r->problem->terms[t].ops->gradient(r->problem->terms[t].self, r->team, u, g);
    gather(r, g);
    if (asks && r->options->unbalance) r->report->unbalance = r->options->unbalance(r->options->context, g);
    for (int64_t i = 0; i < unknowns(r); i++) {
        if (r->problem->held && r->problem->held[i]) g[i] = 0;
        square += g[i] * g[i];
    }
    return sqrt(square);
}

static int take_gradient(newton_run *r) {
    const double *g = r->n->gradient;
    r->length[r->report->iterations % MEMORY] = gradient_at(r, r->u, true);
    r->report->residual = 0, r->report->residual_dof = -1;
    for (int64_t i = 0; i < unknowns(r); i++) {
        if (!isfinite(g[i])) {
            r->report->residual = g[i], r->report->residual_dof = i;
            brunt_fail(r->error, BRUNT_FAILED, "Newton's method: component %d of the gradient at node %lld is %g.",
                       (int)(i % r->problem->dim), (long long)(i / r->problem->dim), g[i]);
            return broken(r, BRUNT_NEWTON_BROKEN);
        }
        if (fabs(g[i]) > r->report->residual) r->report->residual = fabs(g[i]), r->report->residual_dof = i;
    }
    return BRUNT_OK;
}

// Whether a term is left out of the matrix, for products of its own.
static bool has_product(const newton_run *r, int term) {
    return r->options->matrix_free && r->problem->terms[term].ops->product;
}

// The matrix that the solver is given.
static brunt_block_matrix *system_of(newton_run *r) {
    return r->options->matrix_free ? &r->n->free.blocks : &r->n->matrix;
}

static int make_pattern(newton_run *r) {
    brunt_newton *n = r->n;
    int lists = 0;
    for (int t = 0; t < r->problem->count; t++)
        if (r->problem->terms[t].ops->stencils && !has_product(r, t) &&
            !brunt_condensation_has(r->problem->condensed, t))
            n->stencils[lists++] = r->problem->terms[t].ops->stencils(r->problem->terms[t].self);
    const bool more = r->report->iterations > 0;
    if (brunt_condensation_touch(r->problem->condensed, r->team, n->stencils, &lists, more, r->error))
        return broken(r, BRUNT_NEWTON_BROKEN);
    const brunt_pattern pattern = {.dim = r->problem->dim,
                                   .nodes = r->problem->nodes,
                                   .stencils = n->stencils,
                                   .lists = lists,
                                   .keep = more,
                                   .fold = r->problem->fold};
    if (brunt_block_matrix_pattern(&n->matrix, r->team, &pattern, r->error)) return broken(r, BRUNT_NEWTON_BROKEN);
    return BRUNT_OK;
}

// `again`: it has been filled since its pattern was made, which leaves it 0.
static int fill_matrix(newton_run *r, bool project, bool again) {
    brunt_block_matrix *m = &r->n->matrix;
    brunt_matrix_free *f = &r->n->free;
    if (again) brunt_block_matrix_zero(m, r->team);
    for (int t = 0; t < r->problem->count; t++)
        if (r->problem->terms[t].ops->hessian && !has_product(r, t) &&
            !brunt_condensation_has(r->problem->condensed, t))
            r->problem->terms[t].ops->hessian(r->problem->terms[t].self, r->team, r->u, project, m);
    brunt_condensation_fill(r->problem->condensed, r->team, m);
    if (r->problem->fold) brunt_fold_matrix(r->problem->fold, r->team, m);
    if (!r->options->matrix_free) return BRUNT_OK;
    f->fold = r->problem->fold;
    f->rest = m, f->terms = r->problem->terms, f->count = r->problem->count, f->held = r->problem->held;
    return brunt_matrix_free_take(f, r->team, r->u, project, r->error) ? broken(r, BRUNT_NEWTON_BROKEN) : BRUNT_OK;
}

static void hold_matrix(newton_run *r) {
    if (r->options->matrix_free)
        brunt_matrix_free_hold(&r->n->free, r->team);
    else if (r->problem->held)
        brunt_block_matrix_hold(&r->n->matrix, r->team, r->problem->held, 1);
    if (r->problem->fold) brunt_fold_hold(r->problem->fold, system_of(r));
}

// Diagonal entries times 1 + next, which are times 1 + before.
static void raise_matrix(newton_run *r, double before, double next) {
    if (r->options->matrix_free)
        brunt_matrix_free_raise(&r->n->free, next);
    else
        brunt_block_matrix_scale_diagonal(&r->n->matrix, (1 + next) / (1 + before));
}

static int open_solver(newton_run *r, const brunt_linear_ops *solver) {
    const brunt_linear_options options = {.accuracy = r->options->accuracy,
                                          .iterations = r->options->linear_iterations,
                                          .preconditioner = r->options->preconditioner,
                                          .memory = r->options->memory,
                                          .product = r->options->matrix_free ? brunt_matrix_free_product : NULL,
                                          .context = &r->n->free,
                                          .stop = r->options->stop};
    brunt_linear *l = &r->n->linear;
    if (l->ops != solver || l->options.preconditioner != options.preconditioner) r->n->analysed = 0;
    return brunt_linear_open(l, solver, &options, r->error) ? broken(r, BRUNT_NEWTON_BROKEN) : BRUNT_OK;
}

// The step that the factor gives.
static brunt_linear_status solve_with_factor(newton_run *r) {
    brunt_newton *n = r->n;
    phase(r, BRUNT_NEWTON_SOLVE);
    for (int64_t i = 0; i < unknowns(r); i++) n->trial[i] = -n->gradient[i];
    brunt_condensation_gather(r->problem->condensed, r->team, n->trial);
    const brunt_linear_status status = brunt_linear_solve(&n->linear, r->team, n->trial, n->step, r->error);
    if (status == BRUNT_LINEAR_DONE && r->problem->fold) brunt_fold_spread(r->problem->fold, r->problem->dim, n->step);
    if (status == BRUNT_LINEAR_DONE) brunt_condensation_spread(r->problem->condensed, r->team, n->step);
    return status;
}

// Factors of the matrix as it stands.
static brunt_linear_status factor(newton_run *r) {
    brunt_newton *n = r->n;
    const brunt_block_matrix *matrix = system_of(r);
    brunt_linear_status status = BRUNT_LINEAR_DONE;
    phase(r, BRUNT_NEWTON_FACTOR);
    if (n->analysed != matrix->pattern) {
        n->analysed = 0;
        status = brunt_linear_analyse(&n->linear, r->team, matrix, r->error);
        if (status != BRUNT_LINEAR_DONE) return status;
        n->analysed = matrix->pattern, r->report->analyses++;
    }
    status = brunt_linear_factor(&n->linear, r->team, matrix, r->error);
    r->report->factorisations++;
    return status;
}

// The step of the matrix as it stands.
static brunt_linear_status solve(newton_run *r) {
    brunt_newton *n = r->n;
    brunt_linear_status status = factor(r);
    if (status != BRUNT_LINEAR_DONE) return status;
    n->linear.report.iterations = 0, status = solve_with_factor(r);
    r->report->linear_iterations += n->linear.report.iterations;
    return status;
}

static bool sweeps(const newton_run *r) {
    for (int t = 0; t < r->problem->count; t++)
        if (r->problem->terms[t].ops->sweep) return true;
    return false;
}

// Where the last factor takes the unknowns by forces, one set after the other.
static int ways(void *context, int count, double *x) {
    newton_run *r = context;
    BRUNT_ASSERT(!r->problem->condensed);
    for (int k = 0; k < count; k++) gather(r, x + k * unknowns(r));
    for (int64_t i = 0; i < count * unknowns(r); i++)
        if (r->problem->held && r->problem->held[i % unknowns(r)]) x[i] = 0;
    if (brunt_linear_solve_many(&r->n->linear, r->team, count, x, r->error) != BRUNT_LINEAR_DONE) return BRUNT_FAILED;
    for (int k = 0; r->problem->fold && k < count; k++)
        brunt_fold_spread(r->problem->fold, r->problem->dim, x + k * unknowns(r));
    return BRUNT_OK;
}

// What terms keep beside u follows the step, and the step follows it, until neither changes. Energies are then others.
static brunt_linear_status sweep(newton_run *r) {
    brunt_newton *n = r->n;
    const brunt_response response = {r, ways};
    int outside;
    for (bool changed = true; changed;) {
        changed = false;
        for (int t = 0; t < r->problem->count; t++) {
            const brunt_term *term = r->problem->terms + t;
            if (!term->ops->sweep) continue;
            phase(r, BRUNT_NEWTON_SWEEP);
            r->endless =
                term->ops->sweep(term->self, r->u, n->step, n->gradient, &response, &changed, r->error) != BRUNT_OK;
            if (r->endless) return BRUNT_LINEAR_FAILED;
        }
        if (!changed) break;
        gather(r, n->gradient);
        for (int64_t i = 0; i < unknowns(r); i++)
            if (r->problem->held && r->problem->held[i]) n->gradient[i] = 0;
        const brunt_linear_status status = solve_with_factor(r);
        if (status != BRUNT_LINEAR_DONE) return status;
    }
    if (!r->problem->forces) r->energy = energy_at(r, r->u, &outside);
    return BRUNT_LINEAR_DONE;
}

static double measure_step(newton_run *r) {
    brunt_newton_report *report = r->report;
    if (r->options->measure) {
        report->step = r->options->measure(r->options->context, r->team, r->n->step, &report->step_where);
        return report->step;
    }
    report->step = 0, report->step_where = -1;
    for (int64_t i = 0; i < unknowns(r); i++)
        if (fabs(r->n->step[i]) > report->step) report->step = fabs(r->n->step[i]), report->step_where = i;
    return report->step;
}

// Whether a step is so small that it ends the run; nothing is where forces say so. Without energies it may go to and
// fro across a kink, as far each time: it is to be smaller.
static bool small(const newton_run *r) {
    const double share = r->problem->forces ? EARLY : 1;
    return !r->options->unbalance && r->report->step <= share * r->options->tolerance;
}

// Whether the step may be taken: it leads downhill, or is so small that rounding has the say.
static brunt_linear_status try_matrix(newton_run *r) {
    brunt_linear_status status = solve(r);
    if (status == BRUNT_LINEAR_STALLED && r->options->fallback && r->n->linear.ops != &brunt_linear_direct) {
        if (open_solver(r, &brunt_linear_direct)) return BRUNT_LINEAR_FAILED;
        status = solve(r);
    }
    if (status == BRUNT_LINEAR_DONE && sweeps(r)) status = sweep(r);
    if (status == BRUNT_LINEAR_SINGULAR) return BRUNT_LINEAR_INDEFINITE;
    if (status != BRUNT_LINEAR_DONE) return status;
    if (r->problem->forces) return status;
    r->slope = 0;
    for (int64_t i = 0; i < unknowns(r); i++) r->slope += r->n->gradient[i] * r->n->step[i];
    if (r->slope < 0) return BRUNT_LINEAR_DONE;
    measure_step(r);
    if (small(r)) return BRUNT_LINEAR_DONE;
    brunt_fail(r->error, BRUNT_FAILED, "The matrix is not positive definite: its step leads uphill, g.p = %.3g J.",
               r->slope);
    return BRUNT_LINEAR_INDEFINITE;
}

// The matrix as it is; projected; then its diagonal raised, ever more. Where forces nearly balance, and what is
// unstable is that bodies roll off each other, a projected matrix is too stiff for that by orders of magnitude, and
// they stay: the diagonal is raised by little first.
static int find_step(newton_run *r) {
    bool projected = !(r->options->unbalance && r->report->unbalance < CLOSELY);
    phase(r, BRUNT_NEWTON_MATRIX);
    if (make_pattern(r)) return BRUNT_FAILED;
    double shift = 0;
    for (int attempt = 0;; attempt++) {
        if (attempt > 0) phase(r, BRUNT_NEWTON_MATRIX);
        r->plain = attempt == 0;
        const double next = shift > 0 ? MORE_SHIFT * shift : projected ? LEAST_SHIFT : SOFTEST;
        const bool project = (projected && attempt == 1) || (!projected && next > SOFT);
        if (attempt == 0 || project) {
            if (fill_matrix(r, project, attempt > 0)) return BRUNT_FAILED;
            hold_matrix(r);
            shift = 0;
        } else {
            raise_matrix(r, shift, next);
            shift = next, r->report->shifts++;
        }
        if (project) r->report->projections++, projected = true;
        const brunt_linear_status status = try_matrix(r);
        if (status == BRUNT_LINEAR_DONE) return BRUNT_OK;
        if (status != BRUNT_LINEAR_INDEFINITE)
            return broken(r, r->endless ? BRUNT_NEWTON_BLOCKED : BRUNT_NEWTON_BROKEN);
        if (MORE_SHIFT * shift > SHIFT_LIMIT) return broken(r, BRUNT_NEWTON_INDEFINITE);
    }
}

// The part of the step that stays within the domains of all terms; 0: none.
static double within_domain(newton_run *r) {
    double t = 1;
    for (int k = 0; k < r->problem->count; k++) {
        const brunt_term *term = r->problem->terms + k;
        if (!term->ops->limit) continue;
        t = term->ops->limit(term->self, r->team, r->u, r->n->step, t);
        if (t > 0) continue;
        brunt_fail(r->error, BRUNT_FAILED, "Newton's method: %s lets no step be taken in iteration %d.",
                   term->ops->name, r->report->iterations + 1);
        broken(r, BRUNT_NEWTON_BLOCKED);
        return 0;
    }
    return t;
}

// Whether u + share * step, of energy e, may be gone to: it is not higher, or so near that rounding has the say, of
// sums or of strains: these are differences of numbers of order 1, so that an energy W is off by rounding times sqrt(W
// m c^2) whatever is added to it. A step below tolerance is taken as it is.
static bool acceptable(const newton_run *r, brunt_energy_sum e, double noise, bool whole) {
    if (whole && (small(r) || -r->slope < CLOSE * noise)) return true;
    return e.value <= r->energy.value + fmax(noise, ROUNDING * sqrt(e.magnitude * e.moduli));
}

static void try_share(newton_run *r, double share) {
    for (int64_t i = 0; i < unknowns(r); i++) r->n->trial[i] = r->u[i] + share * r->n->step[i];
}

// To the place that was tried.
static int go(newton_run *r, int halvings, double share) {
    r->report->halvings += halvings;
    r->report->least_share = fmin(r->report->least_share, share);
    memcpy(r->u, r->n->trial, (size_t)unknowns(r) * sizeof *r->u);
    return BRUNT_OK;
}

// What terms keep beside u goes along with it: a short step changes the gradient by little.
static void follow_share(const newton_run *r, double share) {
    for (int t = 0; t < r->problem->count; t++)
        if (r->problem->terms[t].ops->follow) r->problem->terms[t].ops->follow(r->problem->terms[t].self, share);
}

// What a gradient is to be shorter than: the longest of the last ones, since near a kink it may grow for once (Grippo,
// Lampariello and Lucidi 1986, SIAM J. Numer. Anal. 23); of tractions, where two have not halved it, than it is.
static double length_to_beat(const newton_run *r) {
    const int now = r->report->iterations;
    const double here = r->length[now % MEMORY];
    if (sweeps(r) && now >= 2 && here > STUCK * r->length[(now - 2) % MEMORY]) return here;
    return fmax(r->length[0], fmax(r->length[1], r->length[2]));
}

// Halves the step until the gradient is short enough.
static int search_forces(newton_run *r, double *share) {
    const double longest = length_to_beat(r);
    for (int half = 0; half <= FEW_HALVINGS; half++, *share *= 0.5) {
        try_share(r, *share);
        follow_share(r, *share);
        const double length = gradient_at(r, r->n->trial, false);
        const bool taken = half == 0 && small(r);
        if (!isfinite(length) || !(taken || length <= (1 - LEAST_DECREASE * *share) * longest)) continue;
        return go(r, half, *share);
    }
    brunt_fail(
        r->error, BRUNT_FAILED,
        "Newton's method: no part of the step of iteration %d, of %.3g m/s, makes what is left of the forces less.",
        r->report->iterations + 1, r->report->step);
    return broken(r, BRUNT_NEWTON_UPHILL);
}

// Halves the step until it is acceptable; in vain once what is to be gained is lost in rounding.
static int search(newton_run *r, double *share) {
    if (r->problem->forces) return search_forces(r, share);
    for (int half = 0; half <= HALVINGS; half++, *share *= 0.5) {
        try_share(r, *share);
        int outside;
        const brunt_energy_sum e = energy_at(r, r->n->trial, &outside);
        // Where forces say when it ends: what is turned by load steps, and by nothing else, has no other energy.
        const double least = r->options->unbalance ? e.moduli : 0;
        const double noise = ROUNDING * fmax(fmax(e.magnitude, r->energy.magnitude), least);
        if (half > 0 && outside < 0 && -*share * r->slope <= LEAST_GAIN * noise) break;
        if (outside < 0 && acceptable(r, e, noise, half == 0)) {
            r->energy = r->report->energy = e;
            return go(r, half, *share);
        }
    }
    brunt_fail(
        r->error, BRUNT_FAILED,
        "Newton's method: no part of the step of iteration %d, of %.3g %s, lowers the energy of %.6g J, though its "
        "slope is %.3g J.",
        r->report->iterations + 1, r->report->step, r->options->unbalance ? "m" : "m/s", r->energy.value, r->slope);
    return broken(r, BRUNT_NEWTON_UPHILL);
}

// Whether the step that was taken is the last. Of quadratic convergence the next one is known: this one squared over
// the one before, or as inexact as the linear solution; near a kink it may not be, and this one has to be small too.
static bool last_step(newton_run *r, double share) {
    const double step = r->report->step, before = r->before;
    const bool full = r->plain && share == 1;
    r->before = full ? step : 0;
    if (small(r)) return true;
    if (r->problem->forces && step > r->options->tolerance) return false;
    if (!r->options->early || r->options->unbalance || !full || before <= 0 || step >= EARLY * before) return false;
    const double inexact = r->n->linear.ops != &brunt_linear_pcg ? 0 : r->options->accuracy;
    return fmax(step / before, inexact) * step <= EARLY * r->options->tolerance;
}

// A small step is the last one if forces balance where it led.
static int ask_balance(newton_run *r, bool *last) {
    if (!r->options->balance) return BRUNT_OK;
    phase(r, BRUNT_NEWTON_EVALUATE);
    if (look(r, NULL)) return BRUNT_FAILED;
    r->looked = true;
    r->report->balance = r->options->balance(r->options->context, r->team, r->u);
    *last = r->report->balance <= 1;
    if (!*last) r->before = 0;
    return BRUNT_OK;
}

static int iterate(newton_run *r, bool *last) {
    phase(r, BRUNT_NEWTON_EVALUATE);
    if (!r->looked && look(r, NULL)) return BRUNT_FAILED;
    r->looked = false;
    if (take_gradient(r)) return BRUNT_FAILED;
    *last = r->options->unbalance && r->report->unbalance <= r->options->tolerance;
    if (*last) return BRUNT_OK;
    if (find_step(r)) return BRUNT_FAILED;
    measure_step(r);
    phase(r, BRUNT_NEWTON_LIMIT);
    if (look(r, r->n->step)) return BRUNT_FAILED;
    double share = within_domain(r);
    if (!(share > 0)) return BRUNT_FAILED;
    phase(r, BRUNT_NEWTON_SEARCH);
    if (search(r, &share)) return BRUNT_FAILED;
    r->report->iterations++;
    *last = last_step(r, share);
    return *last ? ask_balance(r, last) : BRUNT_OK;
}

// What gives way: the greatest component of the direction in which the matrix, as it is factored, is least, by inverse
// iteration. As loads grow by little that is the one in which it has just become negative.
static void find_weakest(newton_run *r) {
    enum { ROUNDS = 30 };
    double *x = r->n->trial, *y = r->n->step, along = 0;
    if (r->n->linear.report.negative == 0) return; // it has no factors
    for (int64_t i = 0; i < unknowns(r); i++)
        x[i] = r->problem->held && r->problem->held[i] ? 0 : ldexp((double)(int64_t)brunt_mix((uint64_t)i + 1), -63);
    brunt_condensation_clear(r->problem->condensed, x);
    for (int round = 0; round < ROUNDS; round++) {
        double square = 0;
        if (brunt_linear_solve(&r->n->linear, r->team, x, y, NULL) != BRUNT_LINEAR_DONE) return;
        along = 0;
        for (int64_t i = 0; i < unknowns(r); i++) along += x[i] * y[i], square += y[i] * y[i];
        if (!(square > 0)) return;
        for (int64_t i = 0; i < unknowns(r); i++) x[i] = y[i] / sqrt(square);
    }
    if (!(along < 0)) return;
    r->report->weakest_dof = 0;
    for (int64_t i = 0; i < unknowns(r); i++)
        if (fabs(x[i]) > fabs(x[r->report->weakest_dof])) r->report->weakest_dof = i;
}

// Whether what has converged is a minimum: the matrix as it is has no negative pivots.
static int check_stable(newton_run *r) {
    const bool direct = r->options->solver == &brunt_linear_direct || r->options->fallback;
    if (!r->options->stable || !direct) return BRUNT_OK;
    phase(r, BRUNT_NEWTON_MATRIX);
    if (make_pattern(r)) return BRUNT_FAILED;
    if (fill_matrix(r, false, false)) return BRUNT_FAILED;
    hold_matrix(r);
    raise_matrix(r, 0, SPARE);
    phase(r, BRUNT_NEWTON_FACTOR);
    if (open_solver(r, &brunt_linear_direct)) return BRUNT_FAILED;
    const brunt_linear_status status = factor(r);
    if (status == BRUNT_LINEAR_DONE) return BRUNT_OK;
    if (status == BRUNT_LINEAR_INDEFINITE) find_weakest(r);
    return broken(r, status == BRUNT_LINEAR_INDEFINITE ? BRUNT_NEWTON_UNSTABLE : BRUNT_NEWTON_BROKEN);
}

// What there is after as many iterations as there may be.
static int give_up(newton_run *r) {
    r->report->result = BRUNT_NEWTON_ITERATIONS;
    if (small(r))
        return brunt_fail(r->error, BRUNT_FAILED,
                          "Newton's method did not converge: after %d iterations a step is %.3g m/s, but forces do not "
                          "balance.",
                          r->report->iterations, r->report->step);
    if (r->options->unbalance)
        return brunt_fail(r->error, BRUNT_FAILED,
                          "Newton's method did not converge: after %d iterations %.3g of the forces that act are "
                          "unbalanced, and %.3g is the tolerance.",
                          r->report->iterations, r->report->unbalance, r->options->tolerance);
    return brunt_fail(r->error, BRUNT_FAILED,
                      "Newton's method did not converge: after %d iterations a step is %.3g m/s, and %.3g m/s is the "
                      "tolerance.",
                      r->report->iterations, r->report->step, r->options->tolerance);
}

static int begin(newton_run *r) {
    brunt_newton *n = r->n;
    const size_t count = (size_t)unknowns(r);
    BRUNT_ASSERT(!r->problem->condensed || (!r->options->matrix_free && !r->problem->fold));
    // A factor of the diagonal blocks alone would pass for the system's.
    BRUNT_ASSERT(!r->options->matrix_free || (r->options->solver == &brunt_linear_pcg && !r->options->fallback));
    static const char what[] = "unknowns of Newton's method";
    if (BRUNT_CAPACITY(n->gradient, count, 0, what, r->error) || BRUNT_CAPACITY(n->step, count, 0, what, r->error) ||
        BRUNT_CAPACITY(n->trial, count, 0, what, r->error) ||
        BRUNT_CAPACITY(n->stencils, (size_t)r->problem->count + 1, 0, "terms of Newton's method", r->error))
        return broken(r, BRUNT_NEWTON_BROKEN);
    phase(r, BRUNT_NEWTON_EVALUATE);
    if (open_solver(r, r->options->solver) || look(r, NULL)) return BRUNT_FAILED;
    int outside = -1;
    if (r->problem->forces) return BRUNT_OK;
    r->energy = r->report->energy = energy_at(r, r->u, &outside);
    r->looked = true;
    if (outside < 0) return BRUNT_OK;
    brunt_fail(r->error, BRUNT_FAILED, "Newton's method: the energy of %s is not finite where it begins.",
               r->problem->terms[outside].ops->name);
    return broken(r, BRUNT_NEWTON_BAD_START);
}

int brunt_newton_minimise(brunt_newton *newton, const brunt_team *team, const brunt_problem *problem,
                          const brunt_newton_options *options, double *u, brunt_newton_report *report,
                          brunt_error *error) {
    *report = (brunt_newton_report){.residual_dof = -1, .weakest_dof = -1, .step_where = -1, .least_share = 1};
    newton_run run = {
        .n = newton, .team = team, .problem = problem, .options = options, .report = report, .error = error, .u = u};
    bool last = false;
    if (begin(&run)) return BRUNT_FAILED;
    while (!last && report->iterations < options->iterations)
        if (iterate(&run, &last)) return BRUNT_FAILED;
    return last ? check_stable(&run) : give_up(&run);
}

int brunt_newton_lead(brunt_newton *newton, const brunt_team *team, const brunt_problem *problem,
                      const brunt_newton_options *options, double *u, brunt_newton_way *lead, brunt_error *error) {
    brunt_newton_report report = {.residual_dof = -1, .weakest_dof = -1, .step_where = -1, .least_share = 1};
    newton_run run = {
        .n = newton, .team = team, .problem = problem, .options = options, .report = &report, .error = error, .u = u};
    double *p = lead->p;
    if (begin(&run) || take_gradient(&run)) return BRUNT_FAILED;
    phase(&run, BRUNT_NEWTON_MATRIX);
    if (make_pattern(&run)) return BRUNT_FAILED;
    if (fill_matrix(&run, false, false)) return BRUNT_FAILED;
    if (options->matrix_free)
        brunt_matrix_free_hessian(&newton->free, team, lead->way, p);
    else
        brunt_block_matrix_product(&newton->matrix, team, lead->way, p);
    gather(&run, p);
    for (int64_t i = 0; i < unknowns(&run); i++)
        if (!problem->held[i]) newton->gradient[i] += p[i];
    hold_matrix(&run);
    const brunt_linear_status status = solve(&run);
    lead->factorisations = report.factorisations;
    if (status != BRUNT_LINEAR_DONE) return BRUNT_FAILED;
    for (int64_t i = 0; i < unknowns(&run); i++) p[i] = problem->held[i] ? lead->way[i] : newton->step[i];
    return BRUNT_OK;
}
