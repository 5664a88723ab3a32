// A term's stencils into a matrix by several threads, to the same bits for any number of them: stencils, of long lists
// bundles of them, that share no node are of one colour; colours go one after the other, what is of one side by side.
// What a block is the sum of is added in the order of colours.
#pragma once

#include "linear/block_matrix.h"

// The colours of a list of stencils, and room for the dense matrices. May be kept while the stencils stay as they are.
typedef struct brunt_colours {
    int64_t *stencil; // the first of each bundle, ordered by colour, ascending within one
    int64_t *first;   // colours + 1
    uint64_t *used;   // of each node from the first to the last of the list: colours that it has met
    int64_t *order;   // colour of each bundle
    double *dense;    // `dense_size` for each thread
    int64_t count, dense_size;
    int64_t bundle; // stencils that follow one another in the list, but for the last bundle: 1 of short lists
    int32_t colours, threads;
    size_t stencil_capacity, first_capacity, used_capacity, order_capacity, dense_capacity;
} brunt_colours;

// Colours stencils of nodes within [0, nodes), greedily, in their order. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_colours_make(brunt_colours *colours, const brunt_team *team, int dim, int32_t nodes,
                       const brunt_stencils *stencils, brunt_error *error);
void brunt_colours_free(brunt_colours *colours);

// The dense matrix of stencil s, of n nodes: dense[(a * dim + i) * n * dim + b * dim + j], all of it, both triangles;
// it comes filled with zeros. `worker`: 0 .. threads - 1.
typedef void brunt_stencil_fn(void *context, int64_t s, double *dense, int worker);

// Adds all stencils' blocks on the diagonal alone, to a matrix that needs no others.
void brunt_assemble_diagonal(brunt_block_matrix *m, const brunt_team *team, const brunt_stencils *stencils,
                             const brunt_colours *colours, brunt_stencil_fn *fill, void *context);
// Adds all stencils to a matrix that couples them, with no more threads than they were coloured for.
void brunt_assemble(brunt_block_matrix *m, const brunt_team *team, const brunt_stencils *stencils,
                    const brunt_colours *colours, brunt_stencil_fn *fill, void *context);
