// Preconditioners by blocks: the inverse of each diagonal block, or an incomplete Cholesky factor on the pattern of the
// matrix, A ~ (I + V)' D (I + V) with V strictly upper and D of blocks.
#pragma once

#include "linear/block_matrix.h"

typedef struct brunt_incomplete {
    const brunt_block_matrix *a; // pattern
    int64_t *upper;              // nodes + 1: where a row's blocks of V begin; NULL of block Jacobi
    double *v, *d, *inverse;     // dim * dim each; d and its inverse of each node
    int64_t *next;               // of each row of V: the next column that has not been a row
    int32_t *slot;               // of each node: its place in the row under way
    size_t upper_capacity, v_capacity, d_capacity, inverse_capacity, next_capacity, slot_capacity;
} brunt_incomplete;

// Room for matrices of a pattern; `whole`: for the incomplete factor, else for block Jacobi. 0, or -1: out of memory.
int brunt_incomplete_analyse(brunt_incomplete *f, const brunt_block_matrix *a, bool whole);
// The factor with diagonal blocks multiplied by `raise`: -1, or the first node whose pivot is not positive definite.
int32_t brunt_incomplete_factor(brunt_incomplete *f, const brunt_block_matrix *a, double raise);
// The inverse of each diagonal block: -1, or the first node whose block is not positive definite.
int32_t brunt_incomplete_jacobi(brunt_incomplete *f, const brunt_block_matrix *a);
// z = M^-1 r with the factor, or (whole false) with the diagonal blocks.
void brunt_incomplete_apply(const brunt_incomplete *f, const brunt_team *team, bool whole, const double *r, double *z);
void brunt_incomplete_free(brunt_incomplete *f);
