// What an implicit step minimises is a sum of terms: inertia, what bodies store, barriers, friction, loads. A term is a
// function of the unknowns, and says what couples what; it knows nothing of the other terms, of Newton's method or of
// the solver. New physics of implicit and static steps is a new term.
//
// Unknowns: the displacement u [m] over the step of each node of `dim` components, nodes of meshes first and active
// nodes of the grids after them; component c of node n is u[n * dim + c]. A displacement, not a position: energies keep
// their digits far from the origin. Energies are in J (of plane strain J for a metre of depth), so that a gradient is
// a force [N] with its sign turned.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "brunt.h"

struct brunt_block_matrix;

// Threads, and where their time goes (NULL: nowhere). Results are the same for any number of threads.
typedef struct brunt_team {
    int threads;
    brunt_timer *timer;
} brunt_team;

// A sum, and the sum of the sizes of what was added: the sum is known to some 1e-16 of the latter.
typedef struct brunt_energy_sum {
    double value;     // [J]; INFINITY outside the term's domain (J <= 0, a gap that is closed)
    double magnitude; // [J]
    double moduli;    // [J] m c^2 of a body: densities are differences of numbers as large, whatever is left of them
} brunt_energy_sum;

// Sets of nodes that couple with each other: those of set s are node[first[s]] .. node[first[s + 1] - 1], each once.
typedef struct brunt_stencils {
    int64_t count;
    const int64_t *first; // count + 1
    const int32_t *node;
    int64_t version; // of a term: a number that changes whenever its sets do; 0: they may have changed
} brunt_stencils;

// What the last factor makes of forces: where it takes all unknowns by them, followers with their leaders; held ones
// stay. x: sets of forces, one after the other; then ways. BRUNT_OK, or BRUNT_FAILED.
typedef struct brunt_response {
    void *context;
    int (*ways)(void *context, int count, double *x);
} brunt_response;

// Functions that a term has not are NULL. `u` and `p` are of all unknowns, read by the term's own nodes.
typedef struct brunt_term_ops {
    const char *name; // in messages: "barrier"
    // Finds what the term depends on at u + t p for all 0 <= t <= 1 that `limit` lets (p NULL: at u), before the others
    // are asked about places between: candidates of contact. BRUNT_OK, or BRUNT_FAILED with the reason.
    int (*look)(void *term, const brunt_team *team, const double *u, const double *p, brunt_error *error);
    brunt_energy_sum (*energy)(void *term, const brunt_team *team, const double *u);
    // Adds the gradient at u to g [J/m].
    void (*gradient)(void *term, const brunt_team *team, const double *u, double *g);
    // What its Hessian couples, until the next `look`; NULL: nothing but each node with itself.
    brunt_stencils (*stencils)(void *term);
    // Adds the Hessian at u [J/m^2] to blocks that the matrix has. `project`: without its negative eigenvalues, of each
    // point or stencil.
    void (*hessian)(void *term, const brunt_team *team, const double *u, bool project, struct brunt_block_matrix *h);
    // Without a matrix: takes what products with the Hessian at u go by, as `hessian` has it, and adds its blocks on
    // the diagonal to `blocks`, which has no others. NULL: the matrix has the term's Hessian all the same.
    void (*linearise)(void *term, const brunt_team *team, const double *u, bool project,
                      struct brunt_block_matrix *blocks);
    // Adds the Hessian of the last `linearise` times x to y. NULL where that is.
    void (*product)(void *term, const brunt_team *team, const double *x, double *y);
    // Greatest t in [0, largest] for which u + t p stays within the domain, with what is left of it for the next step;
    // NULL: any.
    double (*limit)(void *term, const brunt_team *team, const double *u, const double *p, double largest);
    // Once a step p has been found: what the term keeps beside u (the multipliers of constraints) as it is to be at
    // u + p; the change of its gradient at u is added to g, and p is then found anew with the same factor, whose
    // `response` it may ask for. `changed`
    // becomes true unless that is as it is to be. BRUNT_OK, or BRUNT_FAILED: there is no end to it, with the reason.
    // NULL: it keeps nothing. The solver has to be exact.
    int (*sweep)(void *term, const double *u, const double *p, double *g, const brunt_response *response, bool *changed,
                 brunt_error *error);
    // Where there is no energy, so that lengths of gradients are compared: it keeps what it is to have once a share of
    // the step that it was swept for has been gone. NULL: it keeps nothing.
    void (*follow)(void *term, double share);
} brunt_term_ops;

typedef struct brunt_term {
    const brunt_term_ops *ops;
    void *self;
} brunt_term;
