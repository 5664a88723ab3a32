// Bodies whose Hessian never changes, without the unknowns that nothing else touches. With nodes kept (b) and left out
// (i)
//   S = K_bb - K_bi K_ii^-1 K_ib,    S x_b = f_b - K_bi K_ii^-1 f_i,    x_i = K_ii^-1 (f_i - K_ib x_b)
// is the same system. Inner nodes of a mesh go once, for all bodies that have it, whatever their moduli; nodes of a rim
// go body by body, whenever others of them are touched. Nodes that are left out stay among the unknowns, with rows of
// the unit matrix; what other terms have on their diagonal goes to the kept ones so that a rigid motion has it all.
// That is enough of what holds load steps near their iterates, and has no influence on where they end.
#pragma once

#include "linear/block_matrix.h"

// A mesh: `rim` and `inner` of its nodes, ascending. Matrices are row by row, of components.
enum { BRUNT_RIGID = 6 }; // motions at most

typedef struct brunt_condensed_mesh {
    int dim, motions; // rigid ones: 3 or 6
    int nodes, rim_count, inner_count;
    int32_t *rim, *inner;
    double *mode; // of each component, by `motions`: rigid ones about the middle, turns by the mesh's size
    double *K;    // of the rim, without the inner nodes
    double *U;    // factor of the inner nodes, K_ii = U^T U
    double *C;    // K_ii^-1 K_ib: a row for each inner component
} brunt_condensed_mesh;

// Of dim 2 or 3; K: of all nodes; x: their places [m]; on_rim: those that may be touched. BRUNT_OK, or BRUNT_FAILED:
// out of memory, or K is not that of a body whose rim holds it.
int brunt_condensed_mesh_make(brunt_condensed_mesh *mesh, int dim, int nodes, const double *K, const double *x,
                              const uint8_t *on_rim, brunt_error *error);
void brunt_condensed_mesh_free(brunt_condensed_mesh *mesh);

typedef struct brunt_condensed_body {
    const brunt_condensed_mesh *mesh;
    int32_t base;         // its first node
    double scale;         // its Hessian over the mesh's
    uint8_t *touched;     // of the rim; by now
    uint8_t *is_kept;     // as it was reduced last
    int32_t *kept, *gone; // numbers in the rim, ascending
    int kept_count;       // 0: it has not been reduced
    double *parts;        // of as many components as the rim has, squared: S, U, C
    double *S, *U, *C;    // of kept nodes, scaled; of those gone, as the mesh has them
    double *carry;        // of each kept component, by `motions`: P (P^T P)^-1 of its modes P
    double *solved;       // K_ii^-1 f_i of the last system: of the rim, then of inner nodes
} brunt_condensed_body;

typedef struct brunt_condensation {
    int32_t nodes; // of all unknowns, at least up to the last body's last
    int count;
    brunt_condensed_body *body;
    int32_t *owner,
        *place;     // of each of the nodes: its body, -1: none; its number in the rim, or -1 - that of inner ones
    bool *left_out; // of each term: whether it is such a body's
    int64_t *first; // a stencil each, of the kept nodes
    int32_t *node;
    double *dense; // of each worker: S as the matrix has it
    size_t dense_capacity;
    int64_t dense_size;
} brunt_condensation;

// Bodies {mesh, base, scale} become all that they are; terms that are left out are the caller's to mark.
int brunt_condensation_make(brunt_condensation *c, int32_t nodes, int terms, brunt_error *error);
void brunt_condensation_free(brunt_condensation *c);
size_t brunt_condensation_bytes(const brunt_condensation *c);
static inline bool brunt_condensation_has(const brunt_condensation *c, int term) { return c && c->left_out[term]; }

// What the others' stencils touch is kept; with `more` what has been so far as well. Of `count` lists; the bodies' own
// becomes one more. BRUNT_OK, or BRUNT_FAILED. Here and below a condensation that is NULL does nothing.
int brunt_condensation_touch(brunt_condensation *c, const brunt_team *team, brunt_stencils *lists, int *count,
                             bool more, brunt_error *error);
// Adds the bodies to a matrix that has all else; rows of nodes that are left out are the unit matrix's.
void brunt_condensation_fill(const brunt_condensation *c, const brunt_team *team, brunt_block_matrix *m);
// Right sides of the system, in place; then its solution.
void brunt_condensation_gather(const brunt_condensation *c, const brunt_team *team, double *f);
void brunt_condensation_spread(const brunt_condensation *c, const brunt_team *team, double *x);
// Nodes that are left out have 0.
void brunt_condensation_clear(const brunt_condensation *c, double *x);
