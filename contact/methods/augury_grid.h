// The contact grid: blocks of 4 x 4 x 4 nodes (2D: 4 x 4) where there are surface points, made anew each time.
//
// Node i lies at i * cell. A cloud holds points in the order of their blocks; a point reaches `width` nodes a
// direction, from the node at `local` of its block on, so into its own block and those one further up each axis. Blocks
// of the same colour (parity of their coordinates) are so far apart that points of two of them reach no common node:
// scatters go through the colours one after the other, and through the blocks of one in parallel, without locks and
// with the same order of sums for any number of threads.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "grid/bspline.h"

enum { BRUNT_AUGURY_EDGE = 4, BRUNT_AUGURY_STENCIL = 64, BRUNT_AUGURY_COLOURS = 8 };
// Points from which on a phase is worth more than one thread: a pair goes through some hundred phases a step, and on a
// busy machine each may wait for a thread that is not running (measured: 70 times slower with 512).
enum { BRUNT_AUGURY_PARALLEL = 4096 };

typedef struct brunt_augury_point {
    double weight[3][4]; // of the nodes along each axis
    double first[3];     // [m] from the point to the first node
    int32_t block;
    uint8_t local[3]; // first node within the block
} brunt_augury_point;

typedef struct brunt_augury_cloud {
    int32_t count;
    brunt_augury_point *point;
    int32_t *item;        // what each point is, for the caller
    int32_t *block_first; // points of block b: block_first[b] .. block_first[b + 1] - 1
    // as they come, before sorting
    brunt_augury_point *unsorted;
    int32_t *unsorted_item;
    size_t point_capacity, item_capacity, block_first_capacity, unsorted_capacity, unsorted_item_capacity;
} brunt_augury_cloud;

typedef struct brunt_augury_slot {
    uint64_t key;
    int64_t epoch; // slots of earlier grids are empty: the table is never cleared
    int32_t block;
} brunt_augury_slot;

typedef struct brunt_augury_grid {
    int dim, width;  // width: 3, quadratic B-spline, D = cell^2/4; 4, the paper's spline, D = cell^2/2 (its eq. (62)
                     // prints two of the factors as 1/8, which sums to less than one)
    double cell;     // [m]
    int block_nodes; // 64, 2D 16
    int32_t block_count;
    int32_t (*coord)[3]; // of each block, in blocks
    int32_t (*next)[8];  // block at coord + (k & 1, k >> 1 & 1, k >> 2): itself for k = 0, 0 where no point reaches
    uint8_t *reached;    // of each block: bit k set when a point reaches its neighbour k
    int32_t *coloured, colour_first[BRUNT_AUGURY_COLOURS + 1]; // blocks by colour
    brunt_augury_slot *slot;
    int32_t slot_count;
    int64_t epoch;
    size_t coord_capacity, next_capacity, reached_capacity, coloured_capacity, slot_capacity;
} brunt_augury_grid;

// Second moment of the weights, the same wherever the point lies [m^2].
static inline double brunt_augury_moment(const brunt_augury_grid *grid) {
    return grid->cell * grid->cell * (grid->width == 3 ? 0.25 : 0.5);
}

// Nodes in reach of a point, x fastest, and their weights; sizes are literals where it matters for speed.
static inline int brunt_augury_stencil_of(const brunt_augury_grid *grid, const brunt_augury_point *p, int width,
                                          int deep, int block_nodes, int32_t at[BRUNT_AUGURY_STENCIL],
                                          double w[BRUNT_AUGURY_STENCIL]) {
    const int32_t *next = grid->next[p->block];
    int n = 0;
    for (int c2 = 0; c2 < deep; c2++) {
        int l2 = p->local[2] + c2, in2 = (l2 & 3) << 4, up2 = l2 >> 2 << 2;
        for (int c1 = 0; c1 < width; c1++) {
            int l1 = p->local[1] + c1, in1 = in2 + ((l1 & 3) << 2), up1 = up2 + (l1 >> 2 << 1);
            double w21 = p->weight[2][c2] * p->weight[1][c1];
            for (int c0 = 0; c0 < width; c0++, n++) {
                int l0 = p->local[0] + c0;
                at[n] = next[up1 + (l0 >> 2)] * block_nodes + in1 + (l0 & 3);
                w[n] = w21 * p->weight[0][c0];
            }
        }
    }
    return n;
}

// The same for any grid. Their count.
static inline int brunt_augury_stencil(const brunt_augury_grid *grid, const brunt_augury_point *p,
                                       int32_t at[BRUNT_AUGURY_STENCIL], double w[BRUNT_AUGURY_STENCIL]) {
    if (grid->dim != 3) return brunt_augury_stencil_of(grid, p, grid->width, 1, 16, at, w);
    if (grid->width == 3) return brunt_augury_stencil_of(grid, p, 3, 3, 64, at, w);
    return brunt_augury_stencil_of(grid, p, 4, 4, 64, at, w);
}

// Where a node lies [m].
static inline void brunt_augury_position(const brunt_augury_grid *grid, int32_t node, double x[3]) {
    const int32_t *block = grid->coord[node / grid->block_nodes];
    int inside = node % grid->block_nodes;
    for (int a = 0; a < 3; a++) x[a] = (block[a] * BRUNT_AUGURY_EDGE + (inside >> 2 * a & 3)) * grid->cell;
}

// Begins a new grid. The caller empties its clouds (count = 0).
void brunt_augury_grid_start(brunt_augury_grid *grid, int dim, int width, double cell);
// Adds a point to a cloud of the grid. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_augury_cloud_add(brunt_augury_grid *grid, brunt_augury_cloud *cloud, int32_t item, const double x[3],
                           brunt_error *error);
// All points are there: links the blocks and sorts the clouds by them. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_augury_grid_finish(brunt_augury_grid *grid, brunt_augury_cloud *clouds, int cloud_count, brunt_error *error);

// Called with points [begin, end) of the cloud.
typedef void brunt_augury_scatter_fn(void *context, int32_t begin, int32_t end);
// Calls `scatter` for the points of each block, such that no two calls at a time reach a common node.
void brunt_augury_scatter(const brunt_augury_grid *grid, const brunt_augury_cloud *cloud,
                          brunt_augury_scatter_fn *scatter, void *context, int threads, brunt_timer *timer);

void brunt_augury_grid_free(brunt_augury_grid *grid);
void brunt_augury_cloud_free(brunt_augury_cloud *cloud);
