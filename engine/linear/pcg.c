// Conjugate gradients with an incomplete block Cholesky on the pattern of the matrix (Meijerink and van der Vorst 1977,
// Math. Comp. 31), which takes contact's stiff blocks into the preconditioner. It may break down though the matrix is
// positive definite: then once more with diagonal blocks raised (Manteuffel 1980, Math. Comp. 34), in the
// preconditioner alone, and at last with these blocks only.
#include <math.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "linear/incomplete.h"
#include "linear/linear.h"
#include "linear/vectors.h"

typedef struct pcg {
    const brunt_block_matrix *a;
    brunt_incomplete factor;
    bool whole; // an incomplete factor stands; else diagonal blocks
    double *r, *z, *p, *q, *sums;
    size_t r_capacity, z_capacity, p_capacity, q_capacity, sums_capacity;
} pcg;

static const double raises[] = {1, 1.03, 1.1};
enum { RAISES = sizeof raises / sizeof *raises };

static void *pcg_make(brunt_error *error) {
    pcg *self;
    return BRUNT_NEW(self, 1, "conjugate gradients", error) ? NULL : self;
}

static void pcg_free(void *self) {
    pcg *g = self;
    brunt_incomplete_free(&g->factor);
    brunt_free(g->r), brunt_free(g->z), brunt_free(g->p), brunt_free(g->q), brunt_free(g->sums);
    brunt_free(g);
}

static brunt_linear_status pcg_analyse(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                       brunt_error *error) {
    pcg *g = s->self;
    const size_t n = (size_t)a->nodes * (size_t)a->dim;
    const bool whole = s->options.preconditioner == BRUNT_INCOMPLETE_CHOLESKY && !s->options.product;
    static const char unknowns[] = "unknowns of conjugate gradients";
    if (BRUNT_CAPACITY(g->r, n, 0, unknowns, error) || BRUNT_CAPACITY(g->z, n, 0, unknowns, error) ||
        BRUNT_CAPACITY(g->p, n, 0, unknowns, error) || BRUNT_CAPACITY(g->q, n, 0, unknowns, error) ||
        BRUNT_CAPACITY(g->sums, (size_t)brunt_sum_pieces((int64_t)n), 0, "sums of conjugate gradients", error) ||
        brunt_incomplete_analyse(&g->factor, team, a, whole, 0, error))
        return BRUNT_LINEAR_FAILED;
    return BRUNT_LINEAR_DONE;
}

static brunt_linear_status pcg_factor(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                      brunt_error *error) {
    pcg *g = s->self;
    const bool wanted = s->options.preconditioner == BRUNT_INCOMPLETE_CHOLESKY && !s->options.product;
    g->a = a;
    g->whole = false;
    s->report.tries = 0, s->report.shift = 0;
    for (int t = 0; wanted && t < RAISES && !g->whole; t++) {
        g->whole = brunt_incomplete_factor(&g->factor, team, a, raises[t]) < 0;
        if (g->whole)
            s->report.shift = raises[t];
        else
            s->report.tries++;
    }
    if (g->whole) return BRUNT_LINEAR_DONE;
    const int32_t node = brunt_incomplete_jacobi(&g->factor, team, a);
    if (node < 0) return BRUNT_LINEAR_DONE;
    brunt_fail(error, BRUNT_FAILED, "The matrix is not positive definite: negative curvature in the block of node %d.",
               node);
    return BRUNT_LINEAR_INDEFINITE;
}

static void pcg_product(const brunt_linear *s, const brunt_team *team, const double *x, double *y) {
    const pcg *g = s->self;
    if (s->options.product)
        s->options.product(s->options.context, team, x, y);
    else
        brunt_block_matrix_product(g->a, team, x, y);
}

static brunt_linear_status not_definite(const brunt_linear *s, const char *what, double value, brunt_error *error) {
    const bool finite = isfinite(value);
    brunt_fail(error, BRUNT_FAILED,
               finite
                   ? "The matrix is not positive definite: negative curvature, %s = %.3g in iteration %d of conjugate "
                     "gradients."
                   : "Conjugate gradients met a number that is not finite: %s = %g in iteration %d.",
               what, value, s->report.iterations + 1);
    return finite ? BRUNT_LINEAR_INDEFINITE : BRUNT_LINEAR_FAILED;
}

// How far it is. x . Ax grows in an iteration by what the error's square in the norm of A falls by (Hestenes and
// Stiefel 1952, J. Res. NBS 49): by the length of its step times r . M^-1 r before it.
typedef struct progress {
    double rz, gain, energy; // r . M^-1 r; about what the next iteration brings to x . Ax; that
} progress;

// The residual alone says little of long waves: a stiff body's far end does not move until iterations have come there,
// and the residual is small long before. The error of x in the norm of A is to be as small: what as many
// iterations more like the next one would bring (Nash and Sofer 1990, Oper. Res. Lett. 9).
static bool accurate(const brunt_linear *s, const progress *now, const progress *begin) {
    const double square = s->options.accuracy * s->options.accuracy;
    return now->rz <= square * begin->rz && s->report.iterations * now->gain <= square * now->energy;
}

// One iteration.
static brunt_linear_status pcg_iterate(brunt_linear *s, const brunt_team *team, double *x, progress *at,
                                       brunt_error *error) {
    pcg *g = s->self;
    const int64_t n = (int64_t)g->a->nodes * g->a->dim;
    pcg_product(s, team, g->p, g->q);
    const double curvature = brunt_dot(team, n, g->p, g->q, g->sums);
    if (!(curvature > 0 && isfinite(curvature))) return not_definite(s, "p.Ap", curvature, error);
    const double a = at->rz / curvature;
    brunt_add_scaled(team, n, -a, g->q, g->r);
    brunt_incomplete_apply(&g->factor, team, g->whole, g->r, g->z);
    const double next = brunt_dot(team, n, g->r, g->z, g->sums);
    if (!(next >= 0 && isfinite(next))) return not_definite(s, "r.z", next, error);
    brunt_add_and_turn(team, n, a, g->p, x, next / at->rz, g->z);
    at->energy += a * at->rz, at->gain = a * next;
    at->rz = next;
    s->report.iterations++;
    return BRUNT_LINEAR_DONE;
}

static brunt_linear_status pcg_solve(brunt_linear *s, const brunt_team *team, const double *b, double *x,
                                     brunt_error *error) {
    pcg *g = s->self;
    const int64_t n = (int64_t)g->a->nodes * g->a->dim;
    s->report.iterations = 0;
    for (int64_t i = 0; i < n; i++) x[i] = 0, g->r[i] = b[i];
    brunt_incomplete_apply(&g->factor, team, g->whole, g->r, g->z);
    const progress begin = {brunt_dot(team, n, g->r, g->z, g->sums), 0, 0};
    if (!(begin.rz >= 0 && isfinite(begin.rz))) return not_definite(s, "r.z", begin.rz, error);
    for (int64_t i = 0; i < n; i++) g->p[i] = g->z[i];
    for (progress now = begin; !accurate(s, &now, &begin);) {
        if (s->report.iterations >= s->options.iterations) {
            brunt_fail(error, BRUNT_FAILED,
                       "Conjugate gradients: %d iterations brought the residual to %.2g and the next would change x by "
                       "%.2g: not both are below %.2g.",
                       s->report.iterations, sqrt(now.rz / begin.rz), sqrt(now.gain / now.energy), s->options.accuracy);
            return BRUNT_LINEAR_STALLED;
        }
        if (brunt_linear_stops(s, error)) return BRUNT_LINEAR_FAILED;
        const brunt_linear_status status = pcg_iterate(s, team, x, &now, error);
        if (status != BRUNT_LINEAR_DONE) return status;
    }
    return BRUNT_LINEAR_DONE;
}

const brunt_linear_ops brunt_linear_pcg = {"pcg", pcg_make, pcg_analyse, pcg_factor, pcg_solve, pcg_free, NULL};
