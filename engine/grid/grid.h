// The sparse grid of one body.
//
// A bin is the lowest grid node a particle's kernel reaches: base = floor((x - origin)/h - (order-1)/2) per axis. A
// block is 4 x 4 x 4 bins (8 x 8 in 2D) and is alive only where the body has particles. A slot is the block of 64 nodes
// with the same coordinate; because the kernel reaches forward only, the bins of a block touch the nodes of 2^dim
// slots: its own and those one further along each axis. Memory follows the body, not the box around it.
//
// Blocks and slots are kept in lexicographic order of their coordinates (z fastest), which keeps neighbours close in
// memory, makes the order of every sum independent of threads, and lets the lists of two bodies be matched by a merge.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/real.h"

enum {
    BRUNT_BLOCK_NODES = 64, // bins of a block = nodes of a slot, in 2D and 3D
    BRUNT_NODE_REALS = 8,   // reals of a node
    BRUNT_BIN_STARTS = BRUNT_BLOCK_NODES + 1
};

// What links points to the nodes: B-splines of order 1, 2 or 3, or linear functions over triangles, those that the
// diagonals make of the cells or those of a mesh (background.h). Numbers as of the instances that are made of them.
enum { BRUNT_GRID_CUT = 4, BRUNT_GRID_MESH = 5, BRUNT_MESH_CORNERS = 3 * BRUNT_BLOCK_NODES };

// The reals of a node: one cache line in double precision. P2G leaves mass, momentum and the impulse of the internal
// force; the grid update turns them into the new and the old velocity. Momentum and impulse are kept apart because the
// energy ledger needs the kinetic energy before the forces act, and FLIP the change of velocity.
enum {
    BRUNT_NODE_MASS = 0,     // [kg]
    BRUNT_NODE_VELOCITY = 1, // after P2G: momentum [kg m/s]; after the update: velocity at the end of the step [m/s]
    BRUNT_NODE_OLD = 4,      // after P2G: dt times internal force [N s]; after the update: velocity at its start [m/s]
    BRUNT_NODE_SPARE = 7     // fills the cache line
};

typedef struct brunt_block {
    int32_t coord[3];
    int32_t first,
        count;    // its particles: slots first .. first+count-1 of the particle arrays, first a multiple of BRUNT_LANES
    int32_t room; // slots up to the next block's first; those that are no particles have id -1, no mass and no volume
    int32_t slot[8]; // node slots at coord + corner (corner x slowest)
} brunt_block;

typedef struct brunt_slot {
    int32_t coord[3];
    int32_t source[8]; // blocks at coord - corner whose particles reach these nodes, -1 where there is none
} brunt_slot;

typedef struct brunt_table {
    uint64_t *key;
    int32_t *value;
    int32_t capacity;
} brunt_table;

typedef struct brunt_grid {
    int dim, order;   // 2 or 3; 1 linear, 2 quadratic, 3 cubic
    int kernel;       // the order, or BRUNT_GRID_CUT, BRUNT_GRID_MESH, which are linear
    int side;         // bins along an edge of a block: 4 in 3D, 8 in 2D
    int corners;      // 2^dim
    int span;         // nodes along an edge that a block's bins touch: side + order
    int span_nodes;   // span^dim
    real h, inv_h;    // [m], [1/m]
    double origin[3]; // [m] place of node 0

    int32_t block_count, slot_count;
    brunt_block *blocks;
    size_t blocks_capacity;
    uint64_t *block_key;
    size_t block_key_capacity;
    int32_t *bin_start;
    size_t bin_start_capacity; // block_count x 65, relative to the block's first particle
    brunt_slot *slots;
    size_t slots_capacity;
    uint64_t *slot_key;
    size_t slot_key_capacity;
    real *nodes;
    size_t nodes_capacity; // slot_count x 64 x 8
    real *p2g_buffer;
    size_t p2g_buffer_capacity; // block_count x span_nodes x 8: what each block's particles give
    uint8_t *held;
    size_t held_capacity; // slot_count x 64, a bit for each component that a condition gives; NULL where none acts
    uint64_t *spare_key;
    size_t spare_key_capacity;
    brunt_table block_table, slot_table;

    // Of BRUNT_GRID_MESH, else NULL. The mesh lasts as long as the grid.
    const struct brunt_background *mesh;
    int32_t
        *corner; // of each block, three a bin: the node's number (slot * BRUNT_BLOCK_NODES + place), -1: no triangle
    int32_t *source_first, *source; // of each node: where it stands in `corner`, ascending
    uint8_t *reached;               // of each block of the mesh's nodes: whether blocks of triangles reach it
    size_t corner_capacity, source_first_capacity, source_capacity, reached_capacity;
} brunt_grid;

void brunt_grid_init(brunt_grid *grid, int dim, int order, double h, const double origin[3]);
// The same over triangles, in two dimensions and of order 1, before there are blocks: of the cells, or of `mesh`.
void brunt_grid_use_triangles(brunt_grid *grid, const struct brunt_background *mesh);
void brunt_grid_free(brunt_grid *grid);
size_t brunt_grid_bytes(const brunt_grid *grid);

// Coordinates must lie within +- BRUNT_COORD_LIMIT.
enum { BRUNT_COORD_LIMIT = (1 << 20) - 2 };
uint64_t brunt_key(const int32_t coord[3]);

// Index of a coordinate's block or slot, BRUNT_NONE when it is not alive.
int32_t brunt_grid_block(const brunt_grid *grid, uint64_t key);
int32_t brunt_grid_slot(const brunt_grid *grid, uint64_t key);

// Replaces the set of blocks by `count` keys (sorted, no duplicates) and makes slots and neighbour lists. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_grid_set_blocks(brunt_grid *grid, const uint64_t *keys, int32_t count, brunt_error *error);

// Aborts where blocks, slots, their keys and their neighbours do not belong to each other.
void brunt_grid_validate(const brunt_grid *grid);

// Node index within a slot of local coordinates (z fastest), and back.
static inline int brunt_node_index(const brunt_grid *grid, int x, int y, int z) {
    return grid->dim == 3 ? (x * 4 + y) * 4 + z : x * 8 + y;
}
static inline void brunt_node_local(const brunt_grid *grid, int node, int local[3]) {
    if (grid->dim == 3) {
        local[0] = node >> 4, local[1] = (node >> 2) & 3, local[2] = node & 3;
    } else {
        local[0] = node >> 3, local[1] = node & 7, local[2] = 0;
    }
}
static inline real *brunt_slot_nodes(const brunt_grid *grid, int32_t slot) {
    return grid->nodes + (size_t)slot * BRUNT_BLOCK_NODES * BRUNT_NODE_REALS;
}
// Whether a condition gives this component of a node's velocity: to contact its mass is infinite.
static inline bool brunt_node_held(const brunt_grid *grid, int64_t number, int component) {
    return grid->held && grid->held[number] >> component & 1;
}
// Where node n of a mesh stands: coordinates of a lattice whose slots are the mesh's.
static inline void brunt_grid_mesh_node(int32_t n, int32_t at[3]) { at[0] = n / 8, at[1] = n % 8, at[2] = 0; }
// Place of node `node` of a slot, whatever the grid is of [m].
void brunt_grid_node_place(const brunt_grid *grid, int32_t slot, int node, double x[3]);
// Its number (slot * BRUNT_BLOCK_NODES + place) of the node with global coordinates `at`; BRUNT_NONE: not alive.
int64_t brunt_grid_number(const brunt_grid *grid, const int32_t at[3]);
// The node with global coordinates `at`, NULL when it is not alive.
real *brunt_grid_node(const brunt_grid *grid, const int32_t at[3]);
// Marks the nodes that the kernels of particles reach, by their numbers (slot * BRUNT_BLOCK_NODES + place).
void brunt_grid_mark_reached(const brunt_grid *grid, uint8_t *mark);
// Position of a node [m].
static inline void brunt_node_position(const brunt_grid *grid, const int32_t coord[3], int node, double x[3]) {
    int local[3];
    brunt_node_local(grid, node, local);
    for (int a = 0; a < 3; a++)
        x[a] = a < grid->dim ? grid->origin[a] + (double)grid->h * (coord[a] * grid->side + local[a]) : 0.0;
}
