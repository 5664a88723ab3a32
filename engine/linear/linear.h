// Solvers of A x = b for block matrices, symmetric positive definite but for the last one's: a table of operations, a
// row for each.
//
//   direct  Cholesky's factors by MUMPS in the order of METIS; carries any stiffness of contact, tells for certain
//   whether
//           the matrix is positive definite
//   pcg     conjugate gradients with an incomplete block Cholesky or the diagonal blocks; little memory, less time
//   where
//           steps are short or space has three dimensions
//   unsymmetric
//           LU factors by MUMPS, of matrices whose values are not symmetric though their pattern is; twice the time and
//           memory of `direct`, and a negative eigenvalue is no mistake
//
// A solver is used by one thread at a time; it uses the team's. Bits do not depend on their number.
#pragma once

#include "linear/block_matrix.h"

typedef enum brunt_linear_status {
    BRUNT_LINEAR_DONE,
    BRUNT_LINEAR_INDEFINITE, // the matrix is not positive definite
    BRUNT_LINEAR_SINGULAR,   // unsymmetric: it has no inverse, to rounding
    BRUNT_LINEAR_STALLED,    // not solved within the iterations that it had
    BRUNT_LINEAR_FAILED      // memory, or the library said no
} brunt_linear_status;

typedef enum brunt_preconditioner { BRUNT_INCOMPLETE_CHOLESKY, BRUNT_BLOCK_JACOBI } brunt_preconditioner;

// y = A x in place of the matrix's own values, of which only the diagonal blocks are then read (block Jacobi).
typedef void brunt_product_fn(void *context, const brunt_team *team, const double *x, double *y);

typedef struct brunt_linear_options {
    double
        accuracy; // pcg: of the residual over that at x = 0, in the norm of the preconditioner, and of x in that of A
    int32_t iterations; // pcg: at most
    brunt_preconditioner preconditioner;
    int64_t memory;            // [bytes] direct, unsymmetric: what factors may take; 0: what the machine has
    brunt_product_fn *product; // pcg: NULL: of the matrix
    void *context;
    brunt_stop stop; // asked before each factorisation and iteration of pcg: once it says true they fail
} brunt_linear_options;

// What happened last; times are the caller's.
typedef struct brunt_linear_report {
    int32_t iterations;    // pcg, of the last solve
    int32_t negative;      // direct: pivots below zero
    int32_t tries;         // pcg: incomplete factors that broke down before one did not
    double shift;          // pcg: diagonal blocks times this in the preconditioner; 0: block Jacobi
    int64_t memory;        // [bytes] direct, unsymmetric: estimated for the factors
    double entries, flops; // direct, unsymmetric: of the factor
} brunt_linear_report;

typedef struct brunt_linear brunt_linear;

typedef struct brunt_linear_ops {
    const char *name;
    void *(*make)(brunt_error *e); // NULL: it cannot be set up, and `e` says why
    // All that follows from the pattern; then from the values; then x for a b. In this order, each as often as wanted.
    brunt_linear_status (*analyse)(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                   brunt_error *e);
    brunt_linear_status (*factor)(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a, brunt_error *e);
    brunt_linear_status (*solve)(brunt_linear *s, const brunt_team *team, const double *b, double *x, brunt_error *e);
    void (*free)(void *self);
    // Several systems by the last factor, x with the right sides one after the other; NULL: it has none.
    brunt_linear_status (*many)(brunt_linear *s, const brunt_team *team, int count, double *x, brunt_error *e);
} brunt_linear_ops;

struct brunt_linear {
    const brunt_linear_ops *ops; // NULL: none
    void *self;
    brunt_linear_options options;
    brunt_linear_report report;
};

extern const brunt_linear_ops brunt_linear_direct, brunt_linear_pcg, brunt_linear_unsymmetric;
// By name, or NULL; all of them, ended by NULL.
const brunt_linear_ops *brunt_linear_find(const char *name);
const brunt_linear_ops *const *brunt_linear_list(void);

// Sets up a solver, or another in its place. Its options may be changed between calls. BRUNT_OK, or BRUNT_FAILED.
int brunt_linear_open(brunt_linear *s, const brunt_linear_ops *ops, const brunt_linear_options *options,
                      brunt_error *error);
void brunt_linear_close(brunt_linear *s);

// Anything but BRUNT_LINEAR_DONE comes with a message in `error` (may be NULL).
brunt_linear_status brunt_linear_analyse(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                         brunt_error *error);
brunt_linear_status brunt_linear_factor(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                        brunt_error *error);
brunt_linear_status brunt_linear_solve(brunt_linear *s, const brunt_team *team, const double *b, double *x,
                                       brunt_error *error);
// The same of several at once: x has right sides, then solutions. Of what has a factor.
brunt_linear_status brunt_linear_solve_many(brunt_linear *s, const brunt_team *team, int count, double *x,
                                            brunt_error *error);
// Whether solving is to be left; it has then been said.
bool brunt_linear_stops(const brunt_linear *s, brunt_error *error);

// What a choice goes by.
typedef struct brunt_linear_size {
    int dim;
    int64_t nodes;
    double blocks;  // a node, about: 9 or 25 of grids in two dimensions, 15 of tetrahedra, 27 of bricks, 125 of grids
    double courant; // c dt / h; INFINITY: static
} brunt_linear_size;

typedef struct brunt_linear_choice {
    const brunt_linear_ops *solver;
    brunt_preconditioner preconditioner;
    double direct_seconds,
        pcg_seconds; // [s] estimated of one iteration with either, on one thread (choose.c)
    char why[200];   // for `brunt check`
} brunt_linear_choice;

// The quicker one by estimate, the direct one when it takes less than twice as long, for it cannot stall; and less than
// eight times as long where steps are so long that inertia is nothing beside stiffness; and always where it takes next
// to no time and waves cross the whole body in a step.
brunt_linear_choice brunt_linear_choose(const brunt_linear_size *size);
