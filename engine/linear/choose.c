// Which solver is the quicker one, by estimates of both for one iteration of Newton's method: an analysis, a factor and
// a solution; or an incomplete factor and conjugate gradients to 1e-3. Fitted to bench/micro/solvers.c on one core of
// an EPYC of the second generation, within a factor of two.
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "linear/linear.h"

// Steps so long that inertia, which alone holds what is free, is nothing beside what deforms, (c dt / cells across)^2:
// conjugate gradients end before they have seen such motions, and Newton's method makes up for it.
#define SOFT 100.0
#define TINY 3e-4 // [s] that nobody notices: waves cross the whole body, and a factor has its motions exactly

// Blocks a node of grids of quadratic splines, over those of linear elements.
static bool of_splines(const brunt_linear_size *s) { return s->blocks > (s->dim == 2 ? 14 : 50); }

// [s] METIS and MUMPS' analysis, what goes with its entries, and the flops of the fronts by nested dissection.
static double direct_seconds(const brunt_linear_size *s) {
    const double n = (double)s->nodes, b = s->blocks,
                 flops = s->dim == 2 ? 1.55e8 * pow(n / 1e4, 1.52) * pow(b / 7, 1.85)
                                     : 2.85e9 * pow(n / 4096, 2.2) * pow(b / 13.5, 1.1);
    return n * (2.3e-6 + 6e-7 * b) + flops / 3.5e10;
}

// Cells that a wave can cross before it has met every wall.
static double cells_across(const brunt_linear_size *s) { return 3 * pow((double)s->nodes, 1. / s->dim); }

// [s] Iterations grow with the cells that a wave crosses in a step, up to those that the body has.
static double pcg_seconds(const brunt_linear_size *s) {
    const double n = (double)s->nodes, b = s->blocks, cells = fmin(s->courant, cells_across(s)),
                 iterations = 2 + (of_splines(s) ? 1.25 : 2.6) * pow(fmax(cells, 1), 0.75);
    return n * (6e-10 * b * b + 1.3e-9 * b * s->dim * s->dim * iterations);
}

brunt_linear_choice brunt_linear_choose(const brunt_linear_size *s) {
    BRUNT_ASSERT((s->dim == 2 || s->dim == 3) && s->nodes > 0 && s->blocks >= 1 && s->courant > 0);
    brunt_linear_choice choice = {.direct_seconds = direct_seconds(s), .pcg_seconds = pcg_seconds(s)};
    const double d = choice.direct_seconds, p = choice.pcg_seconds;
    const bool tiny = d < TINY && s->courant > cells_across(s),
               soft = isfinite(s->courant) && s->courant > SOFT * cells_across(s),
               direct = d < (soft ? 8 : 2) * p || tiny;
    choice.solver = direct ? &brunt_linear_direct : &brunt_linear_pcg;
    choice.preconditioner = BRUNT_INCOMPLETE_CHOLESKY;
    snprintf(choice.why, sizeof choice.why, "%s: some %.2g s an iteration, %s %.2g s (%dD, %lld nodes, c dt/h %.3g)%s",
             choice.solver->name, direct ? d : p, direct ? "pcg" : "direct", direct ? p : d, s->dim,
             (long long)s->nodes, s->courant,
             direct && p < d ? soft || tiny ? "; inertia alone holds what is free" : "; it cannot stall" : "");
    return choice;
}
