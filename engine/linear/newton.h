// Minimises a sum of terms (term.h) by Newton's method. The matrix is taken as it is, since only then do iterations
// converge quadratically; where it is not positive definite, or the step leads uphill, each term takes its negative
// eigenvalues away, and where even that is not enough the diagonal is raised. Steps keep within the domain of every
// term and never raise the energy by more than its rounding.
//
// A term is asked, at each iterate u: look (at u), gradient, stencils, hessian; then look (along p), limit, energies
// between; where there is none, gradients.
#pragma once

#include "linear/condense.h"
#include "linear/fold.h"
#include "linear/linear.h"
#include "linear/matrix_free.h"

// What the method is at; from the call on, time is that of the phase.
typedef enum brunt_newton_phase {
    BRUNT_NEWTON_EVALUATE, // look, gradient
    BRUNT_NEWTON_MATRIX,   // pattern, Hessian
    BRUNT_NEWTON_FACTOR,   // analysis, factor; the preconditioner of an iterative solver
    BRUNT_NEWTON_SOLVE,    // solution
    BRUNT_NEWTON_SWEEP,    // what terms keep beside the unknowns follows them
    BRUNT_NEWTON_LIMIT,    // look along the step, limits of terms
    BRUNT_NEWTON_SEARCH,   // energies along the step
    BRUNT_NEWTON_PHASES
} brunt_newton_phase;

typedef struct brunt_newton_options {
    double tolerance;               // of `measure`: [m/s]; of `unbalance` where there is that: [-]
    int32_t iterations;             // at most
    double accuracy;                // pcg: of each iteration's solution; 1e-3
    const brunt_linear_ops *solver; // direct or pcg
    brunt_preconditioner preconditioner;
    bool matrix_free;          // pcg with the products of terms, by block Jacobi: no matrix of what has them
    int32_t linear_iterations; // pcg: at most
    bool fallback;             // where pcg stalls, the direct solver goes on (`auto`)
    bool early;     // a step after which the next would be below tolerance/10 is the last; not of `unbalance`
    bool stable;    // no saddle will do: what has converged is to have a positive definite matrix. By the
                    // direct solver; not where pcg is to be alone
    int64_t memory; // [bytes] direct; 0: what the machine has
    // The size of a step p [m/s]: of particles and mesh nodes, never of grid nodes. *where: which has it (the caller's
    // numbering; -1: none). NULL: the greatest component of p, where = its unknown.
    double (*measure)(void *context, const brunt_team *team, const double *p, int64_t *where);
    // How large a gradient is beside the forces that act [-], of all unknowns, held ones too, of followers with their
    // leaders: where it is given it says what has converged, in place of the steps. NULL: steps do.
    double (*unbalance)(void *context, const double *gradient);
    // What forces at u are off by, of what they may be, asked where corrections have become small, after `look`: above
    // 1 the method goes on. NULL: it is not asked.
    double (*balance)(void *context, const brunt_team *team, const double *u);
    void (*phase)(void *context, brunt_newton_phase phase); // NULL: it is not told
    brunt_stop stop;                                        // see linear.h; the method is then broken
    void *context;
} brunt_newton_options;

// What is usual: 100 iterations, pcg to 1e-3, at most 5,000 of its iterations, an early end. Tolerance and solver are
// the caller's to choose.
brunt_newton_options brunt_newton_defaults(void);

typedef enum brunt_newton_result {
    BRUNT_NEWTON_CONVERGED,
    BRUNT_NEWTON_BAD_START,  // the energy is not finite where it begins
    BRUNT_NEWTON_ITERATIONS, // tolerance not reached within as many, or balance
    BRUNT_NEWTON_INDEFINITE, // no positive definite matrix, projected and shifted
    BRUNT_NEWTON_BLOCKED,    // a term lets no step be taken, or what it keeps follows without end
    BRUNT_NEWTON_UPHILL,     // no step, however short, lowers the energy
    BRUNT_NEWTON_UNSTABLE,   // converged, to what is no minimum
    BRUNT_NEWTON_BROKEN      // memory, the solver, or a number that is not finite
} brunt_newton_result;

typedef struct brunt_newton_report {
    brunt_newton_result result;
    int32_t iterations, halvings;
    int32_t projections, shifts; // matrices made anew with projected blocks; raised diagonals
    int32_t linear_iterations, factorisations, analyses;
    double step;             // measure of the last step [m/s]; of `unbalance`: the greatest component [m]
    double unbalance;        // of the last gradient; 0 where it is not asked for
    int64_t step_where;      // what had it
    double balance;          // as `balance` said last; 0: not asked
    double least_share;      // smallest part of a step that was taken
    double residual;         // greatest component of the gradient [J/m], the last time it was taken
    int64_t residual_dof;    // which it is: node * dim + component; -1: none
    int64_t weakest_dof;     // unstable: what goes farthest where the matrix is least; -1: it is not known
    brunt_energy_sum energy; // at u
} brunt_newton_report;

// What is to be minimised.
typedef struct brunt_problem {
    int dim;
    int32_t nodes;
    const brunt_term *terms;
    int count;
    const uint8_t *held;    // unknowns that stay as they are, nodes * dim; NULL: none. Followers as their leaders
    const brunt_fold *fold; // nodes that follow others, where u has them already; NULL: none
    brunt_condensation *condensed; // bodies whose Hessian never changes; NULL: none. Not with followers or products of
                                   // terms, nor where terms sweep or a minimum is led to
    // There is no energy: `gradient` is that of forces, whose derivative need not be symmetric. It is brought to 0:
    // steps are those of the unsymmetric solver, and lower its length.
    bool forces;
} brunt_problem;

// Memory that lasts from one minimisation to the next; starts as all zero. What it remembers does not change results.
typedef struct brunt_newton {
    brunt_block_matrix matrix; // matrix-free: of terms without products
    brunt_matrix_free free;    // matrix-free: the system
    brunt_linear linear;
    int64_t analysed;                // the matrix's pattern when it was analysed
    double *gradient, *step, *trial; // *trial: places tried, and minus the gradient before
    brunt_stencils *stencils;
    size_t gradient_capacity, step_capacity, trial_capacity, stencils_capacity;
} brunt_newton;

// From u to a minimum near it. BRUNT_OK: u is it. BRUNT_FAILED: error and report->result say why it is not; u is then
// the last place reached, of no use but to look at.
int brunt_newton_minimise(brunt_newton *newton, const brunt_team *team, const brunt_problem *problem,
                          const brunt_newton_options *options, double *u, brunt_newton_report *report,
                          brunt_error *error);
// Where held unknowns go to, and the matrix at u takes all others: K p = -gradient there, p = way where it is held.
typedef struct brunt_newton_way {
    const double *way; // [m] of held unknowns; 0 of all others
    double *p;         // [m] of all; another array
    int32_t factorisations;
} brunt_newton_way;
// BRUNT_OK; BRUNT_FAILED: the matrix is not positive definite, or there is no memory for it: p is of no use.
int brunt_newton_lead(brunt_newton *newton, const brunt_team *team, const brunt_problem *problem,
                      const brunt_newton_options *options, double *u, brunt_newton_way *lead, brunt_error *error);
void brunt_newton_free(brunt_newton *newton);
// Aborts where what lasts is not as it must be: the matrices, and what the solver knows of them.
void brunt_newton_validate(const brunt_newton *newton);
