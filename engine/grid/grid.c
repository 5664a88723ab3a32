#include "grid/grid.h"

#include <string.h>

#include "base/hash.h"
#include "base/array.h"
#include "base/memory.h"
#include "grid/background.h"

void brunt_grid_init(brunt_grid *grid, int dim, int order, double h, const double origin[3]) {
    *grid = (brunt_grid){.dim = dim,
                         .order = order,
                         .kernel = order,
                         .side = dim == 3 ? 4 : 8,
                         .corners = dim == 3 ? 8 : 4,
                         .h = (real)h,
                         .inv_h = (real)(1.0 / h)};
    grid->span = grid->side + order;
    grid->span_nodes = dim == 3 ? grid->span * grid->span * grid->span : grid->span * grid->span;
    memcpy(grid->origin, origin, sizeof grid->origin);
}

void brunt_grid_use_triangles(brunt_grid *grid, const brunt_background *mesh) {
    BRUNT_ASSERT(grid->dim == 2 && grid->order == 1);
    grid->kernel = mesh ? BRUNT_GRID_MESH : BRUNT_GRID_CUT;
    grid->mesh = mesh;
    if (mesh) grid->span_nodes = BRUNT_MESH_CORNERS;
}

void brunt_grid_free(brunt_grid *grid) {
    void *owned[] = {
        grid->blocks,         grid->block_key,        grid->bin_start, grid->slots,           grid->slot_key,
        grid->nodes,          grid->p2g_buffer,       grid->spare_key, grid->block_table.key, grid->block_table.value,
        grid->slot_table.key, grid->slot_table.value, grid->held,      grid->corner,          grid->source_first,
        grid->source,         grid->reached};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *grid = (brunt_grid){0};
}

size_t brunt_grid_bytes(const brunt_grid *grid) {
    return grid->blocks_capacity + grid->block_key_capacity + grid->bin_start_capacity + grid->slots_capacity +
           grid->slot_key_capacity + grid->nodes_capacity + grid->p2g_buffer_capacity + grid->spare_key_capacity +
           grid->held_capacity + grid->corner_capacity + grid->source_first_capacity + grid->source_capacity +
           grid->reached_capacity + 12 * (size_t)(grid->block_table.capacity + grid->slot_table.capacity);
}

// ------------------------------------------------------------------------------------------ keys and tables

// 21 bits a coordinate, biased so that the order of keys is the lexicographic order of coordinates.
enum { BIAS = 1 << 20, BITS = 21 };

uint64_t brunt_key(const int32_t c[3]) {
    return (uint64_t)(c[0] + BIAS) << (2 * BITS) | (uint64_t)(c[1] + BIAS) << BITS | (uint64_t)(c[2] + BIAS);
}
static void key_coord(uint64_t key, int32_t c[3]) {
    const uint64_t mask = (1u << BITS) - 1;
    c[0] = (int32_t)(key >> (2 * BITS)) - BIAS;
    c[1] = (int32_t)(key >> BITS & mask) - BIAS;
    c[2] = (int32_t)(key & mask) - BIAS;
}

enum { EMPTY = -1 };

static int table_build(brunt_table *table, const uint64_t *keys, int32_t count, brunt_error *error) {
    int32_t capacity = 64;
    while (capacity < 2 * count) capacity *= 2;
    if (capacity > table->capacity) {
        brunt_free(table->key);
        brunt_free(table->value);
        table->capacity = 0, table->value = NULL;
        if (BRUNT_NEW(table->key, capacity, "keys of blocks of the grid", error) ||
            BRUNT_NEW(table->value, capacity, "blocks of the grid by their keys", error))
            return BRUNT_FAILED;
        table->capacity = capacity;
    }
    for (int32_t i = 0; i < table->capacity; i++) table->value[i] = EMPTY;
    uint64_t mask = (uint64_t)table->capacity - 1;
    for (int32_t i = 0; i < count; i++) {
        uint64_t at = brunt_mix(keys[i]) & mask;
        while (table->value[at] != EMPTY) at = (at + 1) & mask;
        table->key[at] = keys[i];
        table->value[at] = i;
    }
    return BRUNT_OK;
}

static int32_t table_find(const brunt_table *table, uint64_t key) {
    if (!table->capacity) return BRUNT_NONE;
    uint64_t mask = (uint64_t)table->capacity - 1, at = brunt_mix(key) & mask;
    while (table->value[at] != EMPTY) {
        if (table->key[at] == key) return table->value[at];
        at = (at + 1) & mask;
    }
    return BRUNT_NONE;
}

int32_t brunt_grid_block(const brunt_grid *grid, uint64_t key) { return table_find(&grid->block_table, key); }
int32_t brunt_grid_slot(const brunt_grid *grid, uint64_t key) { return table_find(&grid->slot_table, key); }

// ------------------------------------------------------------------------------------------ the set of blocks

// out = keys united with keys + shift, both sorted; returns the count. Adding a constant keeps the order.
static int32_t unite_shifted(const uint64_t *keys, int32_t count, uint64_t shift, uint64_t *out) {
    int32_t a = 0, b = 0, n = 0;
    while (a < count || b < count) {
        uint64_t u = a < count ? keys[a] : UINT64_MAX, v = b < count ? keys[b] + shift : UINT64_MAX;
        out[n++] = u < v ? u : v;
        a += u <= v;
        b += v <= u;
    }
    return n;
}

static uint64_t corner_shift(const brunt_grid *grid, int corner) {
    const int32_t zero[3] = {0, 0, 0};
    int32_t c[3] = {0, 0, 0};
    for (int a = 0; a < grid->dim; a++) c[a] = corner >> (grid->dim - 1 - a) & 1;
    return brunt_key(c) - brunt_key(zero);
}

// The nodes reached: the keys of blocks united with a shift by one along z, then y, then x.
static int find_slots(brunt_grid *grid, brunt_error *error) {
    const size_t n = (size_t)grid->block_count, most = n * (size_t)grid->corners;
    if (BRUNT_CAPACITY(grid->slot_key, most + 1, 0, "blocks of grid nodes", error) ||
        BRUNT_CAPACITY(grid->spare_key, most + 1, 0, "blocks of grid nodes", error))
        return BRUNT_FAILED;
    uint64_t *from = grid->slot_key, *to = grid->spare_key;
    memcpy(from, grid->block_key, n * sizeof *from);
    int32_t slots = grid->block_count;
    for (int a = grid->dim - 1; a >= 0; a--) {
        slots = unite_shifted(from, slots, corner_shift(grid, 1 << (grid->dim - 1 - a)), to);
        uint64_t *t = from;
        from = to, to = t;
    }
    if (from != grid->slot_key) memcpy(grid->slot_key, from, (size_t)slots * sizeof *from);
    grid->slot_count = slots;
    return BRUNT_OK;
}

static void link_blocks(brunt_grid *grid) {
    for (int32_t b = 0; b < grid->block_count; b++) {
        brunt_block *block = &grid->blocks[b];
        for (int c = 0; c < grid->corners; c++) {
            block->slot[c] = brunt_grid_slot(grid, grid->block_key[b] + corner_shift(grid, c));
            grid->slots[block->slot[c]].source[c] = b;
        }
    }
}

// ------------------------------------------------------------------------------------------ blocks of a mesh

// Triangles of a block: from the first to before the last.
static void triangles_of(const brunt_grid *grid, int32_t b, int32_t range[2]) {
    range[0] = grid->blocks[b].coord[0] * BRUNT_BLOCK_NODES;
    range[1] = range[0] + BRUNT_BLOCK_NODES;
    if (range[1] > grid->mesh->triangle_count) range[1] = grid->mesh->triangle_count;
}

// The slots of their corners.
static int find_mesh_slots(brunt_grid *grid, brunt_error *error) {
    const int32_t all = (grid->mesh->node_count + BRUNT_BLOCK_NODES - 1) / BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY(grid->slot_key, (size_t)all + 1, 0, "blocks of grid nodes", error) ||
        BRUNT_CAPACITY(grid->reached, (size_t)all + 1, 0, "marks of blocks of grid nodes", error))
        return BRUNT_FAILED;
    memset(grid->reached, 0, (size_t)all);
    for (int32_t b = 0; b < grid->block_count; b++) {
        int32_t t[2];
        for (triangles_of(grid, b, t); t[0] < t[1]; t[0]++)
            for (int k = 0; k < 3; k++) grid->reached[grid->mesh->corner[t[0]][k] / BRUNT_BLOCK_NODES] = 1;
    }
    grid->slot_count = 0;
    for (int32_t s = 0; s < all; s++)
        if (grid->reached[s]) grid->slot_key[grid->slot_count++] = brunt_key((const int32_t[3]){s, 0, 0});
    return BRUNT_OK;
}

// Where the corners of triangles stand among the nodes, and nodes among the corners.
static int link_mesh(brunt_grid *grid, brunt_error *error) {
    const size_t corners = (size_t)grid->block_count * BRUNT_MESH_CORNERS,
                 nodes = (size_t)grid->slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY(grid->corner, corners, 0, "corners of triangles of the grid", error) ||
        BRUNT_CAPACITY(grid->source, corners + 1, 0, "corners of triangles of the grid", error) ||
        BRUNT_CAPACITY(grid->source_first, nodes + 2, 0, "nodes of triangles of the grid", error))
        return BRUNT_FAILED;
    memset(grid->source_first, 0, (nodes + 2) * sizeof *grid->source_first);
    for (int32_t b = 0; b < grid->block_count; b++) {
        int32_t *corner = grid->corner + (size_t)b * BRUNT_MESH_CORNERS, t[2];
        for (int c = 0; c < BRUNT_MESH_CORNERS; c++) corner[c] = BRUNT_NONE;
        for (triangles_of(grid, b, t); t[0] < t[1]; t[0]++)
            for (int k = 0; k < 3; k++, corner++) {
                const int32_t node = grid->mesh->corner[t[0]][k];
                const int32_t slot = brunt_grid_slot(grid, brunt_key((const int32_t[3]){node / BRUNT_BLOCK_NODES}));
                *corner = slot * BRUNT_BLOCK_NODES + node % BRUNT_BLOCK_NODES;
                grid->source_first[*corner + 2]++;
            }
    }
    for (size_t n = 2; n < nodes + 2; n++) grid->source_first[n] += grid->source_first[n - 1];
    for (size_t c = 0; c < corners; c++)
        if (grid->corner[c] >= 0) grid->source[grid->source_first[grid->corner[c] + 1]++] = (int32_t)c;
    return BRUNT_OK;
}

int brunt_grid_set_blocks(brunt_grid *grid, const uint64_t *keys, int32_t count, brunt_error *error) {
    const size_t n = (size_t)count;
    if (BRUNT_CAPACITY(grid->block_key, n, 0, "blocks of the grid", error) ||
        BRUNT_CAPACITY(grid->blocks, n, 0, "blocks of the grid", error) ||
        BRUNT_CAPACITY(grid->bin_start, n * BRUNT_BIN_STARTS, 0, "bins of blocks of the grid", error) ||
        BRUNT_CAPACITY(grid->p2g_buffer, n * (size_t)grid->span_nodes * BRUNT_NODE_REALS, 0,
                       "numbers of nodes of blocks of the grid", error))
        return BRUNT_FAILED;
    memmove(grid->block_key, keys, n * sizeof *keys);
    grid->block_count = count;
    for (int32_t b = 0; b < count; b++) key_coord(grid->block_key[b], grid->blocks[b].coord);
    if (table_build(&grid->block_table, grid->block_key, count, error)) return BRUNT_FAILED;
    if (grid->mesh ? find_mesh_slots(grid, error) : find_slots(grid, error)) return BRUNT_FAILED;
    const int32_t slots = grid->slot_count;
    if (BRUNT_CAPACITY(grid->slots, (size_t)slots, 0, "blocks of grid nodes", error) ||
        BRUNT_CAPACITY(grid->nodes, (size_t)slots * BRUNT_BLOCK_NODES * BRUNT_NODE_REALS, 0, "numbers of grid nodes",
                       error) ||
        table_build(&grid->slot_table, grid->slot_key, slots, error))
        return BRUNT_FAILED;
    for (int32_t s = 0; s < slots; s++) {
        key_coord(grid->slot_key[s], grid->slots[s].coord);
        for (int c = 0; c < 8; c++) grid->slots[s].source[c] = -1;
    }
    if (grid->mesh) return link_mesh(grid, error);
    link_blocks(grid);
    return BRUNT_OK;
}

// Every corner of a triangle is a node's, and listed there.
static void validate_mesh(const brunt_grid *grid) {
    const int64_t nodes = (int64_t)grid->slot_count * BRUNT_BLOCK_NODES;
    for (int64_t n = 0; n < nodes; n++) {
        BRUNT_ASSERT(grid->source_first[n] <= grid->source_first[n + 1]);
        for (int32_t k = grid->source_first[n]; k < grid->source_first[n + 1]; k++)
            BRUNT_ASSERT(grid->corner[grid->source[k]] == n);
    }
}

void brunt_grid_validate(const brunt_grid *grid) {
    BRUNT_ASSERT(grid->h > 0 && grid->corners == 1 << grid->dim);
    BRUNT_ASSERT(grid->mesh || grid->block_count <= grid->slot_count);
    if (grid->mesh && grid->block_count) validate_mesh(grid);
    for (int32_t b = 0; b < grid->block_count; b++) {
        const uint64_t key = grid->block_key[b];
        BRUNT_ASSERT(!b || grid->block_key[b - 1] < key);
        BRUNT_ASSERT(brunt_key(grid->blocks[b].coord) == key && brunt_grid_block(grid, key) == b);
        for (int c = 0; c < grid->corners && !grid->mesh; c++) {
            const int32_t slot = grid->blocks[b].slot[c];
            BRUNT_ASSERT(slot >= 0 && slot < grid->slot_count && grid->slots[slot].source[c] == b);
        }
    }
    for (int32_t s = 0; s < grid->slot_count && grid->block_count; s++) {
        const uint64_t key = grid->slot_key[s];
        BRUNT_ASSERT(!s || grid->slot_key[s - 1] < key);
        BRUNT_ASSERT(brunt_key(grid->slots[s].coord) == key && brunt_grid_slot(grid, key) == s);
        for (int c = 0; c < 8; c++)
            BRUNT_ASSERT(grid->slots[s].source[c] >= -1 && grid->slots[s].source[c] < grid->block_count);
    }
}

static int32_t floor_divide(int32_t a, int32_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

int64_t brunt_grid_number(const brunt_grid *grid, const int32_t at[3]) {
    int32_t block[3] = {0, 0, 0}, local[3] = {0, 0, 0};
    for (int a = 0; a < grid->dim; a++) {
        block[a] = floor_divide(at[a], grid->side);
        local[a] = at[a] - block[a] * grid->side;
    }
    int32_t slot = brunt_grid_slot(grid, brunt_key(block));
    if (slot < 0) return BRUNT_NONE;
    return (int64_t)slot * BRUNT_BLOCK_NODES + brunt_node_index(grid, local[0], local[1], local[2]);
}

real *brunt_grid_node(const brunt_grid *grid, const int32_t at[3]) {
    const int64_t number = brunt_grid_number(grid, at);
    return number < 0 ? NULL : grid->nodes + number * BRUNT_NODE_REALS;
}

static void mark_corners(const brunt_grid *grid, uint8_t *mark) {
    for (int32_t b = 0; b < grid->block_count; b++)
        for (int c = 0; c < BRUNT_MESH_CORNERS; c++) {
            const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS + c / 3;
            if (start[1] > start[0]) mark[grid->corner[(size_t)b * BRUNT_MESH_CORNERS + (size_t)c]] = 1;
        }
}

void brunt_grid_node_place(const brunt_grid *grid, int32_t slot, int node, double x[3]) {
    brunt_node_position(grid, grid->slots[slot].coord, node, x);
    if (!grid->mesh) return;
    const int32_t n = grid->slots[slot].coord[0] * BRUNT_BLOCK_NODES + node;
    for (int a = 0; a < 2; a++) x[a] = n < grid->mesh->node_count ? grid->mesh->node[n][a] : 0;
}

void brunt_grid_mark_reached(const brunt_grid *grid, uint8_t *mark) {
    if (grid->mesh) {
        mark_corners(grid, mark);
        return;
    }
    const int deep = grid->dim == 3 ? grid->order : 0;
    for (int32_t b = 0; b < grid->block_count; b++)
        for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++) {
            const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS;
            int from[3];
            if (start[bin + 1] == start[bin]) continue;
            brunt_node_local(grid, bin, from);
            for (int x = from[0]; x <= from[0] + grid->order; x++)
                for (int y = from[1]; y <= from[1] + grid->order; y++)
                    for (int z = from[2]; z <= from[2] + deep; z++) {
                        const int at[3] = {x, y, z};
                        int corner = 0, local[3] = {0};
                        for (int a = 0; a < grid->dim; a++) {
                            const int beyond = at[a] >= grid->side;
                            corner = 2 * corner + beyond, local[a] = at[a] - beyond * grid->side;
                        }
                        mark[(size_t)grid->blocks[b].slot[corner] * BRUNT_BLOCK_NODES +
                             (size_t)brunt_node_index(grid, local[0], local[1], local[2])] = 1;
                    }
        }
}
