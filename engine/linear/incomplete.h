// Preconditioners by blocks: the inverse of each diagonal block, or an incomplete Cholesky factor on the pattern of the
// matrix, S A S ~ (I + V)' D (I + V) with V strictly upper, D of blocks and S the sizes of nodes.
//
// Nodes are eliminated in pieces that threads take side by side, the same ones for any number of them: the nodes, in
// their order, are cut into slabs. What couples with no later slab comes first, slab beside slab; then, of what is
// left, again what couples with none of that in a later slab; and so on (levels). Every other slab
// goes from its last node to its first, so that two of them meet where what they have in common comes last: a factor
// that is twisted loses no iterations (van der Vorst 1987, Parallel Comput. 5).
#pragma once

#include "linear/block_matrix.h"

enum { BRUNT_SLABS = 8, BRUNT_LEVELS = 8 }; // at most

typedef struct brunt_incomplete {
    const brunt_block_matrix *a;    // pattern
    int32_t *order, *place;         // the node that is eliminated n-th; when a node is
    int8_t *turn;                   // of each node: 2 level + 1 of slabs that go from their last node to their first
    int64_t *upper, *lower;         // nodes + 1, of the n-th: where its blocks right of (left of) the diagonal begin
    int32_t *after, *before;        // of each of these: its column, as a place
    int32_t *source, *twin;         // of upper ones: where in the matrix's row; of lower ones: where in the row above
    double *v, *d, *inverse, *size; // dim * dim each, D and its inverse of each node (block Jacobi: by node); S
    float *right, *left;            // V and its transpose, as a solution reads them
    double *work;                   // a vector in the order of places, in 3D four numbers each, as they are read
    int32_t *slot;                  // of each worker and place: its place in the row under way + 1
    int32_t first[BRUNT_LEVELS * BRUNT_SLABS + 1]; // of level * slabs + slab: the place where the piece begins
    int slabs, levels;
    size_t order_capacity, place_capacity, turn_capacity, upper_capacity, lower_capacity, after_capacity,
        before_capacity, source_capacity, twin_capacity, v_capacity, d_capacity, inverse_capacity, size_capacity,
        right_capacity, left_capacity, work_capacity, slot_capacity;
} brunt_incomplete;

// Room for matrices of a pattern; `whole`: for the incomplete factor, else for block Jacobi. `slabs`: up to
// BRUNT_SLABS; 0: two, or one where threads would wait for each other longer than they work. BRUNT_OK, or BRUNT_FAILED:
// out of memory.
int brunt_incomplete_analyse(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a, bool whole,
                             int slabs, brunt_error *error);
// The order, levels and pieces that it begins with.
void brunt_incomplete_order(brunt_incomplete *f, int slabs);
// The factor with diagonal blocks multiplied by `raise`: BRUNT_NONE, or a node whose pivot is not positive definite.
int32_t brunt_incomplete_factor(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a, double raise);
// The inverse of each diagonal block: BRUNT_NONE, or the first node whose block is not positive definite.
int32_t brunt_incomplete_jacobi(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a);
// z = M^-1 r with the factor, or (whole false) with the diagonal blocks.
void brunt_incomplete_apply(const brunt_incomplete *f, const brunt_team *team, bool whole, const double *r, double *z);
void brunt_incomplete_free(brunt_incomplete *f);
