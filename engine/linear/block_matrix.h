// Square sparse matrices of dense blocks, dim x dim (2 or 3): one block for each pair of nodes that couple, both
// triangles, columns ascending within a row. The pattern is that of lists of stencils (term.h): the row of a node is
// the union of the stencils that hold it, and the node itself. Built, filled and multiplied with any number of threads
// to the same bits.
#pragma once

#include <stddef.h>

#include "linear/term.h"

typedef struct brunt_block_matrix {
    int dim;
    int32_t nodes;
    int64_t *first;    // nodes + 1: blocks of row r are first[r] .. first[r + 1] - 1
    int32_t *column;   // of each block
    int64_t *diagonal; // nodes: which block is (r, r)
    double *value;     // dim * dim of each block, row major
    int64_t pattern;   // a number that changes whenever the pattern does; 0: there is none yet
    size_t first_capacity, column_capacity, diagonal_capacity, value_capacity;
    struct brunt_pattern_scratch *scratch; // what building a pattern wants
} brunt_block_matrix;

// What a pattern is made of.
struct brunt_fold; // linear/fold.h
typedef struct brunt_pattern {
    int dim;
    int32_t nodes;
    const brunt_stencils *stencils; // `lists` lists, nodes within [0, nodes)
    int lists;                      // fewer than 2^23
    bool keep; // what the matrix has stays in it, when it has as many nodes: versions of lists are then of one problem
    const struct brunt_fold *fold; // stencils that hold a follower hold its leader too; NULL: none follows
} brunt_pattern;

// Makes room for a pattern, and sets all values to zero. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_block_matrix_pattern(brunt_block_matrix *m, const brunt_team *team, const brunt_pattern *pattern,
                               brunt_error *error);
void brunt_block_matrix_zero(brunt_block_matrix *m, const brunt_team *team);
void brunt_block_matrix_free(brunt_block_matrix *m);
// Aborts where rows, columns and diagonal blocks of a pattern are not in their places.
void brunt_block_matrix_validate(const brunt_block_matrix *m);

static inline int64_t brunt_block_matrix_blocks(const brunt_block_matrix *m) {
    return m->first ? m->first[m->nodes] : 0;
}
// Which block of a row a column's is, or where it would be.
int64_t brunt_block_matrix_place(const brunt_block_matrix *m, int64_t row, int64_t column);
// The values of a node's own block.
static inline double *brunt_block_matrix_diagonal(brunt_block_matrix *m, int32_t node) {
    return m->value + m->diagonal[node] * m->dim * m->dim;
}

enum { BRUNT_STENCIL_LIMIT = 1024 }; // nodes of a stencil

// Adds the dense matrix of `count` nodes, each once, that the pattern couples: entry (node[a], i; node[b], j) is
// dense[(a * dim + i) * count * dim + b * dim + j]. Quickest where nodes ascend. Not for two threads at rows of the
// same node: brunt_assemble sees to that.
void brunt_block_matrix_add(brunt_block_matrix *m, const int32_t *node, int count, const double *dense);

// A number for each node, of no value before and after, for whoever fills the matrix: of worker 0 .. threads - 1 of the
// team that made the pattern.
int32_t *brunt_block_matrix_marks(const brunt_block_matrix *m, int worker);

// y = A x; of nodes * dim.
void brunt_block_matrix_product(const brunt_block_matrix *m, const brunt_team *team, const double *x, double *y);

// Rows and columns of held unknowns (held[n * dim + c] not 0) become zero, their diagonal entry `diagonal`: positive,
// of the size of the others where a solver looks at sizes.
void brunt_block_matrix_hold(brunt_block_matrix *m, const brunt_team *team, const uint8_t *held, double diagonal);
// Mean of the diagonal entries of unknowns that are not held (NULL: all); 1 where there are none.
double brunt_block_matrix_mean_diagonal(const brunt_block_matrix *m, const uint8_t *held);
// Multiplies diagonal entries by `factor`.
void brunt_block_matrix_scale_diagonal(brunt_block_matrix *m, double factor);
