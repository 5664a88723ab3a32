// Which solver is the quicker one, by estimates of both for one iteration of Newton's method: an analysis where the
// pattern is new, a factor and a solution; or an incomplete factor and conjugate gradients to 1e-3. The numbers are
// those that bench/studies/implicit_table.py fits to its rows, to a tenth, of one core of an EPYC: most estimates are
// within a factor of two.
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "linear/linear.h"

// Steps so long that inertia, which alone holds what is free, is nothing beside what deforms, (c dt / cells across)^2:
// conjugate gradients end before they have seen such motions, and Newton's method makes up for it.
#define SOFT 100.0
#define TINY 1e-4 // [s] that is not noticed: waves cross the whole body, and a factor has its motions exactly

// Blocks a node of grids of quadratic splines, over those of linear elements.
static bool of_splines(const brunt_linear_size *s) { return s->blocks > (s->dim == 2 ? 14 : 50); }

// [s] What goes with nodes and entries, and the flops of the fronts by nested dissection (George 1973, SIAM J. Numer.
// Anal. 10).
static double direct_seconds(const brunt_linear_size *s) {
    const double n = (double)s->nodes, b = s->blocks,
                 fronts = s->dim == 2 ? 6.4e-3 * pow(n / 1e4, 1.5) * pow(b / 7, 1.85)
                                      : 6.9e-2 * pow(n / 4096, 2) * pow(b / 13.5, 1.1);
    return n * (2.1e-6 + 9.7e-8 * b) + fronts;
}

static double nodes_across(const brunt_linear_size *s) { return pow((double)s->nodes, 1. / s->dim); }

// Cells that a wave can cross before it has met every wall.
static double cells_across(const brunt_linear_size *s) { return 3 * nodes_across(s); }

// Of conjugate gradients: as many as the root of the condition, 1 + (c dt / h)^2 times a number, until the whole body
// moves as one.
static double iterations(const brunt_linear_size *s) {
    static const struct {
        double of_waves, of_nodes;
    } laws[2][2] = {{{2.1, 1.8}, {2.4, 2.8}}, {{0.91, 0.75}, {1.1, 1.3}}};
    const bool splines = of_splines(s), space = s->dim == 3;
    const double by_waves = laws[splines][space].of_waves * s->courant,
                 by_nodes = laws[splines][space].of_nodes * nodes_across(s);
    return 1 + 1 / hypot(1 / by_waves, 1 / by_nodes);
}

static double pcg_seconds(const brunt_linear_size *s) {
    const double n = (double)s->nodes, b = s->blocks;
    return n * (1.0e-8 * b + 4.4e-10 * b * b + (1.8e-8 + 3.4e-10 * b * s->dim * s->dim) * iterations(s));
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
