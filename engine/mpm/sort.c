// Where particles are, and what follows: nothing where none has changed its bin, the blocks that it has changed in
// while there are the same ones and they have room (sort_blocks.c), else all of them anew, by a counting sort: to
// blocks, stable, ranges in order, then inside each block by bin, then every array is moved once. In a body that is
// hit, and in one that flies, where rows of particles pass from block to block together, a fifth of the blocks change.
#include "mpm/sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/simd_math.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "grid/background.h"
#include "mpm/node_window.h"
#include "mpm/sort_parts.h"

void brunt_sort_workspace_free(brunt_sort_workspace *workspace) {
    if (!workspace) return;
    for (int q = 0; q < SORT_RANGES; q++) {
        brunt_free(workspace->ranges[q].missing);
        brunt_free(workspace->ranges[q].count);
        brunt_free(workspace->ranges[q].mover);
    }
    brunt_free(workspace->total);
    brunt_free(workspace->keys);
    brunt_free(workspace->arrivals);
    brunt_free(workspace->arrival);
    brunt_free(workspace->changed);
    brunt_free(workspace->carried);
    brunt_free(workspace->carried_id);
    brunt_free(workspace->old);
    brunt_free(workspace->old_id);
    brunt_free(workspace);
}

static bool range_miss(sort_range *r, uint64_t key) {
    if (r->missing_count && r->missing[r->missing_count - 1] == key) return true;
    if (BRUNT_RESERVE(r->missing, (size_t)(r->missing_count + 1), (size_t)r->missing_count)) return false;
    r->missing[r->missing_count++] = key;
    return true;
}

static bool range_mover(sort_range *r, int64_t slot, uint64_t from, uint64_t to) {
    if (BRUNT_RESERVE(r->mover, (size_t)(r->mover_count + 1), (size_t)r->mover_count)) return false;
    r->mover[r->mover_count++] =
        (sort_mover){.slot = (int32_t)slot, .from = (int32_t)(from >> 6), .to = (int32_t)(to >> 6), .bin = to & 63};
    return true;
}

// Block coordinates and bin of a particle at x; false when it is not finite or too far away.
static bool find_bin(const brunt_grid *grid, const real *origin, real *const *x, int64_t s, int32_t block[3],
                     int *bin) {
    const int dim = grid->dim, shift = dim == 3 ? 2 : 3, mask = grid->side - 1;
    const double offset = 0.5 * (grid->order - 1);
    *bin = 0, block[2] = 0;
    for (int a = 0; a < dim; a++) {
        double u = floor((double)((x[a][s] - origin[a]) * grid->inv_h) - offset);
        if (!(fabs(u) < 4.0 * (BRUNT_COORD_LIMIT - 1))) return false; // NaN too
        const int32_t base = (int32_t)u;
        block[a] = base >> shift;
        *bin = *bin << shift | (base & mask);
    }
    return true;
}

// The same of a mesh; false when it is outside of it.
static bool find_triangle(const brunt_grid *grid, real *const *x, int64_t s, int32_t block[3], int *bin) {
    const int32_t triangle = brunt_background_find(grid->mesh, (const double[2]){(double)x[0][s], (double)x[1][s]});
    if (triangle < 0) return false;
    block[0] = triangle / BRUNT_BLOCK_NODES, block[1] = block[2] = 0;
    *bin = triangle % BRUNT_BLOCK_NODES;
    return true;
}

// The particles begin .. end of a range, one by one; `mesh`: of the grid.
BRUNT_INLINE void find_places_of(sort_job *j, sort_range *r, int64_t begin, int64_t end, bool mesh) {
    const brunt_grid *grid = j->grid;
    brunt_particles *p = j->particles;
    real *const *x = brunt_kernel_position(p);
    const real origin[3] = {(real)grid->origin[0], (real)grid->origin[1], (real)grid->origin[2]};
    uint64_t last_key = UINT64_MAX;
    int32_t last = -1;
    uint8_t *changed = j->workspace->changed;
    for (int64_t s = begin; s < end; s++) {
        int32_t block[3];
        int bin;
        if (p->id[s] < 0) continue;
        if (!(mesh ? find_triangle(grid, x, s, block, &bin) : find_bin(grid, origin, x, s, block, &bin))) {
            if (r->bad < 0) r->bad = s;
            continue;
        }
        uint64_t key = brunt_key(block);
        if (key != last_key) last_key = key, last = brunt_grid_block(grid, key);
        if (last < 0) {
            r->lost = r->lost || !range_miss(r, key);
            r->moved = true;
            continue;
        }
        const uint64_t place = (uint64_t)last << 6 | (uint64_t)bin, before = p->key[s];
        if (place == before) continue;
        r->moved = true;
        p->key[s] = place;
        if (j->renewed) continue;
        changed[before >> 6] = 1;
        if (place >> 6 != before >> 6) r->lost = r->lost || !range_mover(r, s, before, place);
    }
}

// How far inside its bin a particle is at least, in cells, of which no rounding of its place makes another bin.
static real clear_of_rounding(const brunt_grid *grid, const brunt_block *block) {
    int32_t most = 0;
    for (int a = 0; a < grid->dim; a++) most = abs(block->coord[a]) > most ? abs(block->coord[a]) : most;
    return 16 * LANES_REAL_EPSILON * (real)(((double)most + 2) * grid->side);
}

// Whether all particles of a vector are clearly in the bins of the last sort; `corner`: of their block, in cells from
// the origin.
BRUNT_INLINE bool all_stay(const brunt_grid *grid, const brunt_particles *p, real *const *x, int64_t s,
                           const real corner[3], real clear, int dim) {
    lane_mask stays = lanes_set(0) == lanes_set(0);
    for (int a = 0; a < dim; a++) {
        const lanes cells = (lanes_load(x[a] + s) - (real)grid->origin[a]) * grid->inv_h,
                    within = cells - corner[a] - bin_coordinate(p->bin + s, dim, a);
        stays &= (within > clear) & (within < 1 - clear);
    }
    return !lanes_any(~stays);
}

// Those of one block, a vector at a time while they stay.
BRUNT_INLINE void find_places_in(sort_job *j, sort_range *r, const brunt_block *block, int dim) {
    const brunt_grid *grid = j->grid;
    const brunt_particles *p = j->particles;
    real *const *x = brunt_kernel_position(p);
    const real clear = clear_of_rounding(grid, block);
    real corner[3] = {0};
    for (int a = 0; a < dim; a++) corner[a] = (real)((double)block->coord[a] * grid->side + 0.5 * (grid->order - 1));
    for (int64_t s = block->first; s < block->first + block->count; s += BRUNT_LANES)
        if (!all_stay(grid, p, x, s, corner, clear, dim)) find_places_of(j, r, s, s + BRUNT_LANES, false);
}

// Round one. key[] gets block rank * 64 + bin; of a particle whose block is not alive yet, nothing.
static void find_places(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    const brunt_grid *grid = j->grid;
    for (int64_t q = begin; q < end; q++) {
        sort_range *r = &j->ranges[q];
        r->bad = -1, r->moved = r->lost = false, r->missing_count = r->mover_count = 0;
        if (grid->mesh)
            find_places_of(j, r, r->begin, r->end, true);
        else if (j->renewed)
            find_places_of(j, r, r->begin, r->end, false);
        else
            for (int32_t b = r->first_block; b < r->end_block; b++)
                if (grid->dim == 3)
                    find_places_in(j, r, &grid->blocks[b], 3);
                else
                    find_places_in(j, r, &grid->blocks[b], 2);
    }
}

static int compare_keys(const void *a, const void *b) {
    uint64_t u = *(const uint64_t *)a, v = *(const uint64_t *)b;
    return (u > v) - (u < v);
}

static void count_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    brunt_particles *p = j->particles;
    for (int64_t q = begin; q < end; q++) {
        sort_range *r = &j->ranges[q];
        memset(r->count, 0, (size_t)j->grid->block_count * sizeof *r->count);
        for (int64_t s = r->begin; s < r->end; s++)
            if (p->id[s] >= 0) r->count[p->key[s] >> 6]++;
    }
}

// Round two: the particles of each block in their old order.
static void fill_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    brunt_particles *p = j->particles;
    for (int64_t q = begin; q < end; q++) {
        sort_range *r = &j->ranges[q];
        for (int64_t s = r->begin; s < r->end; s++)
            if (p->id[s] >= 0) p->order[r->count[p->key[s] >> 6]++] = (int32_t)s;
    }
}

// Round three: by bin inside the block. The old places are sorted through spare_id, which is free until the arrays
// move.
static void sort_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    brunt_particles *p = j->particles;
    for (int64_t b = begin; b < end; b++) {
        brunt_block *block = &j->grid->blocks[b];
        int32_t *start = j->grid->bin_start + b * BRUNT_BIN_STARTS, at[BRUNT_BIN_STARTS];
        memset(start, 0, BRUNT_BIN_STARTS * sizeof *start);
        int32_t *order = p->order + block->first;
        int64_t *sorted = p->spare_id + block->first;
        for (int32_t i = 0; i < block->count; i++) start[(p->key[order[i]] & 63) + 1]++;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++) start[k + 1] += start[k];
        memcpy(at, start, sizeof at);
        for (int32_t i = 0; i < block->count; i++) sorted[at[p->key[order[i]] & 63]++] = order[i];
        for (int32_t i = 0; i < block->room; i++) {
            order[i] = (int32_t)sorted[i < block->count ? i : block->count - 1];
            p->bin[block->first + i] = (uint8_t)(p->key[order[i]] & 63);
        }
    }
}

static void move_scalars(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    brunt_particles *p = j->particles;
    int first = j->group, last = first + BRUNT_SORT_GROUP;
    if (last > p->scalar_count) last = p->scalar_count;
    for (int k = first; k < last; k++) {
        const real *restrict from = p->scalar[k];
        real *restrict to = p->scalar[p->scalar_count + k - first];
        const int32_t *restrict order = p->order;
        for (int64_t s = begin; s < end; s++) to[s] = from[order[s]];
    }
}

static void set_keys(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    for (int64_t b = begin; b < end; b++) {
        const brunt_block *block = &j->grid->blocks[b];
        for (int32_t i = 0; i < block->count; i++)
            j->particles->key[block->first + i] = (uint64_t)b << 6 | j->particles->bin[block->first + i];
    }
}

static int fail_position(const brunt_grid *grid, const brunt_particles *p, int64_t s, brunt_error *error) {
    real *const *x = p->scalar + p->field[BRUNT_FIELD_position].first;
    double place[3] = {0, 0, 0};
    bool finite = true;
    for (int a = 0; a < p->dim; a++) place[a] = (double)x[a][s], finite = finite && isfinite(place[a]);
    if (error) {
        memcpy(error->position, place, sizeof place);
        error->id = p->id[s];
    }
    return brunt_fail(error, BRUNT_FAILED,
                      !finite      ? "the position is not a finite number"
                      : grid->mesh ? BRUNT_OUTSIDE_OF_MESH
                                   : "the particle is more than four million cells away from the origin of the grid");
}

// United set of the blocks that are alive and needed: those with particles now, and the missing ones.
static int renew_blocks(sort_job *j, brunt_error *error) {
    brunt_grid *grid = j->grid;
    int64_t most = j->renewed ? 0 : grid->block_count;
    for (int q = 0; q < j->range_count; q++) most += j->ranges[q].missing_count;
    if (BRUNT_CAPACITY(j->workspace->keys, (size_t)(most + 1), 0, "blocks of the grid", error)) return BRUNT_FAILED;
    uint64_t *keys = j->workspace->keys;
    int64_t n = 0;
    if (!j->renewed)
        for (int32_t b = 0; b < grid->block_count; b++) keys[n++] = grid->block_key[b];
    for (int q = 0; q < j->range_count; q++)
        for (int64_t i = 0; i < j->ranges[q].missing_count; i++) keys[n++] = j->ranges[q].missing[i];
    qsort(keys, (size_t)n, sizeof *keys, compare_keys);
    int64_t unique = 0;
    for (int64_t i = 0; i < n; i++)
        if (!unique || keys[i] != keys[unique - 1]) keys[unique++] = keys[i];
    return brunt_grid_set_blocks(grid, keys, (int32_t)unique, error);
}

// Blocks that have lost all their particles go; their number is rare and their presence would change no sum.
static int drop_empty(brunt_grid *grid, const int64_t *total, brunt_error *error) {
    int32_t kept = 0;
    for (int32_t b = 0; b < grid->block_count; b++)
        if (total[b]) grid->block_key[kept++] = grid->block_key[b];
    return brunt_grid_set_blocks(grid, grid->block_key, kept, error);
}

// Round one, for all ranges: whether some particle is not where the last sort put it, and whether some have no block.
static int look(sort_job *j, bool *moved, bool *missing, brunt_error *error) {
    brunt_parallel(j->threads, j->range_count, 1, find_places, j, j->timer);
    *moved = j->particles->holes || j->renewed, *missing = false;
    for (int q = 0; q < j->range_count; q++) {
        const sort_range *r = &j->ranges[q];
        if (r->bad >= 0) return fail_position(j->grid, j->particles, r->bad, error);
        if (r->lost)
            return brunt_fail_memory(error, "blocks of the grid that particles come to", (size_t)r->missing_count + 1,
                                     sizeof *r->missing);
        *moved = *moved || r->moved;
        *missing = *missing || r->missing_count > 0;
    }
    return BRUNT_OK;
}

// Particles of each block, by range and in all; whether there is one without any.
static int count_particles(sort_job *j, bool *empty, brunt_error *error) {
    const int32_t blocks = j->grid->block_count;
    for (int q = 0; q < j->range_count; q++)
        if (BRUNT_CAPACITY(j->ranges[q].count, (size_t)blocks, 0, "blocks of particles", error)) return BRUNT_FAILED;
    if (BRUNT_CAPACITY(j->workspace->total, (size_t)blocks, 0, "blocks of particles", error)) return BRUNT_FAILED;
    brunt_parallel(j->threads, j->range_count, 1, count_blocks, j, j->timer);
    *empty = false;
    for (int32_t b = 0; b < blocks; b++) {
        j->workspace->total[b] = 0;
        for (int q = 0; q < j->range_count; q++) j->workspace->total[b] += j->ranges[q].count[b];
        *empty = *empty || j->workspace->total[b] == 0;
    }
    return BRUNT_OK;
}

// Until every particle's block is alive and every block has a particle: at most a few looks. *rests: no particle has
// changed its bin, and nothing is to be done; *fits: those that have go where there is room.
static int settle_blocks(sort_job *j, bool *rests, bool *fits, brunt_error *error) {
    *fits = false;
    for (;;) {
        bool moved, missing, empty;
        if (look(j, &moved, &missing, error)) return BRUNT_FAILED;
        *rests = !moved;
        if (*rests) return BRUNT_OK;
        if (!missing && !j->renewed && !j->particles->holes && sort_changes_count(j, fits, error)) return BRUNT_FAILED;
        if (*fits) return BRUNT_OK;
        if (missing) {
            if (renew_blocks(j, error)) return BRUNT_FAILED;
        } else {
            if (count_particles(j, &empty, error)) return BRUNT_FAILED;
            if (!empty) return BRUNT_OK;
            if (drop_empty(j->grid, j->workspace->total, error)) return BRUNT_FAILED;
        }
        j->renewed = true;
    }
}

static void move_ids(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sort_job *j = context;
    brunt_particles *p = j->particles;
    real *mass = brunt_field(p, BRUNT_FIELD_mass)[0], *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    for (int64_t b = begin; b < end; b++) {
        const brunt_block *block = &j->grid->blocks[b];
        for (int32_t i = 0; i < block->room; i++) {
            int64_t s = block->first + i;
            p->spare_id[s] = i < block->count ? p->id[p->order[s]] : -1;
            if (i >= block->count) mass[s] = volume[s] = 0;
        }
    }
}

// How many particles more than it has a block gets room for, when there is memory for it: those that come in a row.
static int64_t extra_slots(const sort_job *j, int64_t count, int64_t spare) {
    const int64_t wanted = brunt_padded(count + count / 8 + 1) - brunt_padded(count);
    const int64_t share = spare / j->grid->block_count / BRUNT_LANES * BRUNT_LANES;
    return wanted < share ? wanted : share;
}

// Where each block begins, and each range's part of it; how many slots there are with the gaps.
static int64_t place_blocks(sort_job *j) {
    int64_t slots = 0, least = 0;
    for (int32_t b = 0; b < j->grid->block_count; b++) least += brunt_padded(j->workspace->total[b]);
    const int64_t spare = j->particles->capacity > least ? j->particles->capacity - least : 0;
    for (int32_t b = 0; b < j->grid->block_count; b++) {
        const int64_t count = j->workspace->total[b];
        brunt_block *block = &j->grid->blocks[b];
        block->first = (int32_t)slots, block->count = (int32_t)count;
        block->room = (int32_t)(brunt_padded(count) + extra_slots(j, count, spare));
        int32_t at = (int32_t)slots;
        for (int q = 0; q < j->range_count; q++) {
            int32_t here = j->ranges[q].count[b];
            j->ranges[q].count[b] = at;
            at += here;
        }
        slots += block->room;
    }
    return slots;
}

// The slab may grow, which moves the keys; they are still needed by the rounds that follow.
static int reserve_arrays(brunt_particles *p, int64_t slots, brunt_error *error) {
    if (slots <= p->capacity) return BRUNT_OK;
    size_t bytes = (size_t)p->slots * sizeof *p->key;
    uint64_t *keys;
    if (BRUNT_NEW(keys, p->slots + 1, "keys of particles", error)) return BRUNT_FAILED;
    memcpy(keys, p->key, bytes);
    const int status = brunt_particles_reserve(p, slots, error);
    if (!status) memcpy(p->key, keys, bytes);
    brunt_free(keys);
    return status;
}

// Every array to its new order, a few at a time through the spare ones.
static void move_arrays(sort_job *j, int64_t slots) {
    brunt_particles *p = j->particles;
    for (int first = 0; first < p->scalar_count; first += BRUNT_SORT_GROUP) {
        j->group = first;
        brunt_parallel(j->threads, slots, SLOT_GRAIN, move_scalars, j, j->timer);
        for (int k = 0; k < BRUNT_SORT_GROUP && first + k < p->scalar_count; k++) {
            real *t = p->scalar[first + k];
            p->scalar[first + k] = p->scalar[p->scalar_count + k];
            p->scalar[p->scalar_count + k] = t;
        }
    }
    brunt_parallel(j->threads, j->grid->block_count, BLOCK_GRAIN, move_ids, j, j->timer);
    int64_t *t = p->id;
    p->id = p->spare_id, p->spare_id = t;
}

// All particles to their places, as many blocks as there are.
static int sort_all(sort_job *j, brunt_error *error) {
    brunt_particles *p = j->particles;
    const int64_t slots = place_blocks(j);
    if (reserve_arrays(p, slots, error)) return BRUNT_FAILED;
    brunt_parallel(j->threads, j->range_count, 1, fill_blocks, j, j->timer);
    brunt_parallel(j->threads, j->grid->block_count, BLOCK_GRAIN, sort_blocks, j, j->timer);
    move_arrays(j, slots);
    p->slots = slots;
    p->moves++;
    p->holes = false;
    brunt_parallel(j->threads, j->grid->block_count, BLOCK_GRAIN, set_keys, j, j->timer);
    return BRUNT_OK;
}

// Ranges of whole blocks, so that what is noted of a block is noted by one of them; of slots before there are any.
static void cut_ranges(sort_job *j) {
    const brunt_particles *p = j->particles;
    const int64_t blocks = j->grid->block_count, ranges = j->range_count;
    for (int q = 0; q < ranges; q++) {
        sort_range *r = &j->ranges[q];
        r->begin = q ? j->ranges[q - 1].end : 0;
        r->end = p->slots * (q + 1) / ranges;
        r->first_block = (int32_t)(blocks * q / ranges), r->end_block = (int32_t)(blocks * (q + 1) / ranges);
        if (!j->renewed && q + 1 < ranges) r->end = j->grid->blocks[r->end_block].first;
    }
}

int brunt_sort(brunt_grid *grid, brunt_particles *particles, int threads, brunt_timer *timer, brunt_error *error) {
    int ranges = threads > 1 && particles->slots >= 4096 ? 4 * threads : 1;
    if (ranges > SORT_RANGES) ranges = SORT_RANGES;
    if (!particles->sort_workspace) particles->sort_workspace = brunt_alloc(sizeof *particles->sort_workspace);
    if (!particles->sort_workspace) return brunt_fail(error, BRUNT_FAILED, "out of memory while sorting particles");
    sort_job j = {.grid = grid,
                  .particles = particles,
                  .workspace = particles->sort_workspace,
                  .ranges = particles->sort_workspace->ranges,
                  .range_count = ranges,
                  .threads = threads,
                  .timer = timer,
                  .renewed = grid->block_count == 0};
    cut_ranges(&j);
    particles->sorts++;
    bool rests, fits;
    if (sort_changes_clear(&j, error) || settle_blocks(&j, &rests, &fits, error)) return BRUNT_FAILED;
    if (rests) return BRUNT_OK;
    return fits ? sort_changed(&j, error) : sort_all(&j, error);
}
