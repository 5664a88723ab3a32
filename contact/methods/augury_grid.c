#include "contact/methods/augury_grid.h"

#include <string.h>

#include "base/hash.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { FIRST_SLOTS = 1024, BLOCK_GRAIN = 4 };
static const double FARTHEST = 1 << 20; // [blocks] coordinates are packed in 21 bits

void brunt_augury_grid_start(brunt_augury_grid *grid, int dim, int width, double cell) {
    grid->dim = dim, grid->width = width, grid->cell = cell;
    grid->block_nodes = dim == 3 ? 64 : 16;
    grid->block_count = 0;
    grid->epoch++;
}

void brunt_augury_grid_free(brunt_augury_grid *grid) {
    brunt_free(grid->coord);
    brunt_free(grid->next);
    brunt_free(grid->reached);
    brunt_free(grid->coloured);
    brunt_free(grid->slot);
    *grid = (brunt_augury_grid){0};
}

void brunt_augury_cloud_free(brunt_augury_cloud *cloud) {
    brunt_free(cloud->point);
    brunt_free(cloud->item);
    brunt_free(cloud->block_first);
    brunt_free(cloud->unsorted);
    brunt_free(cloud->unsorted_item);
    *cloud = (brunt_augury_cloud){0};
}

// ------------------------------------------------------------------------------------------ blocks

static uint64_t pack(const int32_t c[3]) {
    uint64_t key = 0;
    for (int a = 0; a < 3; a++) key = key << 21 | ((uint64_t)(int64_t)(c[a] + (1 << 20)) & 0x1fffff);
    return key;
}

static brunt_augury_slot *probe(const brunt_augury_grid *grid, uint64_t key) {
    uint64_t mask = (uint64_t)grid->slot_count - 1, at = brunt_mix(key);
    for (;; at++) {
        brunt_augury_slot *s = &grid->slot[at & mask];
        if (s->epoch != grid->epoch || s->key == key) return s;
    }
}

// A table of at least twice as many slots as blocks.
static int widen(brunt_augury_grid *grid, brunt_error *error) {
    if (grid->slot_count >= 2 * (grid->block_count + 1)) return BRUNT_OK;
    int32_t count = grid->slot_count ? 2 * grid->slot_count : FIRST_SLOTS;
    if (BRUNT_CAPACITY(grid->slot, (size_t)count, 0, "slots for blocks of the contact grid", error))
        return BRUNT_FAILED;
    memset(grid->slot, 0, (size_t)count * sizeof *grid->slot);
    grid->slot_count = count;
    for (int32_t b = 0; b < grid->block_count; b++) {
        uint64_t key = pack(grid->coord[b]);
        *probe(grid, key) = (brunt_augury_slot){key, grid->epoch, b};
    }
    return BRUNT_OK;
}

// Number of the block at `coord`, which is made when there is none. BRUNT_NONE: out of memory.
static int32_t block_at(brunt_augury_grid *grid, const int32_t coord[3], brunt_error *error) {
    if (widen(grid, error)) return BRUNT_NONE;
    uint64_t key = pack(coord);
    brunt_augury_slot *s = probe(grid, key);
    if (s->epoch == grid->epoch) return s->block;
    size_t n = (size_t)grid->block_count;
    if (BRUNT_CAPACITY(grid->coord, n + 1, n, "blocks of the contact grid", error) ||
        BRUNT_CAPACITY(grid->reached, n + 1, n, "blocks of the contact grid", error))
        return BRUNT_NONE;
    memcpy(grid->coord[n], coord, sizeof grid->coord[n]);
    grid->reached[n] = 0;
    *s = (brunt_augury_slot){key, grid->epoch, grid->block_count};
    return grid->block_count++;
}

int brunt_augury_cloud_add(brunt_augury_grid *grid, brunt_augury_cloud *cloud, int32_t item, const double x[3],
                           brunt_error *error) {
    // Neighbours that a stencil reaches when it goes past the block's end along the axes of `k`: all their
    // combinations.
    static const uint8_t reaches[8] = {0x01, 0x03, 0x05, 0x0f, 0x11, 0x33, 0x55, 0xff};
    size_t n = (size_t)cloud->count;
    if (BRUNT_CAPACITY(cloud->unsorted, n + 1, n, "points in the contact grid", error) ||
        BRUNT_CAPACITY(cloud->unsorted_item, n + 1, n, "points in the contact grid", error))
        return BRUNT_FAILED;
    brunt_augury_point *p = &cloud->unsorted[n];
    int32_t coord[3];
    int past = 0;
    for (int a = 0; a < 3; a++) {
        double first = 0;
        if (a < grid->dim) {
            brunt_bspline_about(grid->width, x[a] / grid->cell, &first, p->weight[a]);
        } else {
            p->weight[a][0] = 1, p->weight[a][1] = p->weight[a][2] = p->weight[a][3] = 0;
        }
        p->first[a] = a < grid->dim ? first * grid->cell - x[a] : 0;
        double block = fmin(fmax(floor(first / BRUNT_AUGURY_EDGE), -FARTHEST), FARTHEST - 2);
        coord[a] = (int32_t)block;
        p->local[a] = (uint8_t)fmin(fmax(first - block * BRUNT_AUGURY_EDGE, 0), BRUNT_AUGURY_EDGE - 1);
        if (a < grid->dim && p->local[a] + grid->width > BRUNT_AUGURY_EDGE) past |= 1 << a;
    }
    // Points come roughly along a curve: most lie in the block of the one before.
    int32_t block = n ? cloud->unsorted[n - 1].block : BRUNT_NONE;
    if (block < 0 || memcmp(grid->coord[block], coord, sizeof coord)) block = block_at(grid, coord, error);
    if (block < 0) return BRUNT_FAILED;
    p->block = block;
    grid->reached[block] |= reaches[past];
    cloud->unsorted_item[n] = item;
    cloud->count++;
    return BRUNT_OK;
}

// Makes the blocks that points reach into, and links them.
static int link_blocks(brunt_augury_grid *grid, brunt_error *error) {
    const int32_t with_points = grid->block_count;
    size_t n = (size_t)with_points;
    if (BRUNT_CAPACITY(grid->next, n + 1, 0, "blocks of the contact grid", error)) return BRUNT_FAILED;
    for (int32_t b = 0; b < with_points; b++)
        for (int k = 0; k < 8; k++) {
            int32_t c[3] = {grid->coord[b][0] + (k & 1), grid->coord[b][1] + (k >> 1 & 1),
                            grid->coord[b][2] + (k >> 2)};
            grid->next[b][k] = grid->reached[b] >> k & 1 ? block_at(grid, c, error) : 0;
            if (grid->next[b][k] < 0) return BRUNT_FAILED;
        }
    // Only blocks with points have anything to do.
    if (BRUNT_CAPACITY(grid->coloured, n + 1, 0, "blocks of the contact grid", error)) return BRUNT_FAILED;
    int32_t at = 0;
    for (int colour = 0; colour < BRUNT_AUGURY_COLOURS; colour++) {
        grid->colour_first[colour] = at;
        for (int32_t b = 0; b < with_points; b++) {
            const int32_t *c = grid->coord[b];
            if (((c[0] & 1) | (c[1] & 1) << 1 | (c[2] & 1) << 2) == colour) grid->coloured[at++] = b;
        }
    }
    grid->colour_first[BRUNT_AUGURY_COLOURS] = at;
    return BRUNT_OK;
}

static int sort_cloud(const brunt_augury_grid *grid, brunt_augury_cloud *cloud, brunt_error *error) {
    size_t n = (size_t)cloud->count, blocks = (size_t)grid->block_count;
    if (BRUNT_CAPACITY(cloud->point, n + 1, 0, "points in the contact grid", error) ||
        BRUNT_CAPACITY(cloud->item, n + 1, 0, "points in the contact grid", error) ||
        BRUNT_CAPACITY(cloud->block_first, blocks + 2, 0, "blocks of the contact grid", error))
        return BRUNT_FAILED;
    int32_t *first = cloud->block_first;
    memset(first, 0, (blocks + 2) * sizeof(int32_t));
    for (size_t k = 0; k < n; k++) first[cloud->unsorted[k].block + 2]++;
    for (size_t b = 2; b < blocks + 2; b++) first[b] += first[b - 1];
    for (size_t k = 0; k < n; k++) {
        int32_t at = first[cloud->unsorted[k].block + 1]++;
        cloud->point[at] = cloud->unsorted[k];
        cloud->item[at] = cloud->unsorted_item[k];
    }
    return BRUNT_OK;
}

int brunt_augury_grid_finish(brunt_augury_grid *grid, brunt_augury_cloud *clouds, int cloud_count, brunt_error *error) {
    if (link_blocks(grid, error)) return BRUNT_FAILED;
    for (int k = 0; k < cloud_count; k++)
        if (sort_cloud(grid, &clouds[k], error)) return BRUNT_FAILED;
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ scatter

typedef struct scatter_job {
    const brunt_augury_cloud *cloud;
    const int32_t *block;
    brunt_augury_scatter_fn *scatter;
    void *context;
} scatter_job;

static void scatter_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const scatter_job *j = context;
    for (int64_t k = begin; k < end; k++) {
        const int32_t *first = &j->cloud->block_first[j->block[k]];
        if (first[1] > first[0]) j->scatter(j->context, first[0], first[1]);
    }
}

void brunt_augury_scatter(const brunt_augury_grid *grid, const brunt_augury_cloud *cloud,
                          brunt_augury_scatter_fn *scatter, void *context, int threads, brunt_timer *timer) {
    if (cloud->count < BRUNT_AUGURY_PARALLEL) threads = 1;
    for (int colour = 0; colour < BRUNT_AUGURY_COLOURS; colour++) {
        scatter_job j = {cloud, grid->coloured + grid->colour_first[colour], scatter, context};
        int32_t blocks = grid->colour_first[colour + 1] - grid->colour_first[colour];
        brunt_parallel(threads, blocks, BLOCK_GRAIN, scatter_blocks, &j, timer);
    }
}
