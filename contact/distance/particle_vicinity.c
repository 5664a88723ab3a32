// Particles of the bins about a slot: those of its own block and of the blocks before it along each axis.
//
// The ball of radius `reach` about a particle is an ellipsoid by now, with the matrix B = reach^2 F F^T. With half axes
// a >= b >= c a ball of radius c^2 / a, as it is curved where its longest axis ends, rolls about in it and touches
// every point.
#include "contact/distance/particle_vicinity.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/simd.h"

void brunt_vicinity_free(brunt_vicinity *vicinity) { brunt_free(vicinity->data); }

// Where the bins from `at` on along the last axis begin, as far as they are of one block: the bin's number of its first
// particle and of those behind it, from the block's first on, which is particle `*first` of the body. NULL: no block.
static inline const int32_t *find_bins(const brunt_vicinity *v, const int at[3], int64_t *first) {
    const brunt_grid *grid = &v->body->grid;
    const int x = at[0] - grid->order, y = at[1] - grid->order, z = at[2] - grid->order, side = grid->side;
    const int plane = 2 * (x < 0) + (y < 0), solid = grid->dim == 3; // bins are counted from `order` before the slot
    const int32_t b = grid->slots[v->slot].source[solid ? 2 * plane + (z < 0) : plane];
    if (b < 0) return NULL;
    *first = grid->blocks[b].first;
    return grid->bin_start + (int64_t)b * BRUNT_BIN_STARTS +
           brunt_node_index(grid, x + (x < 0) * side, y + (y < 0) * side, solid ? z + (z < 0) * side : 0);
}

// The particles of the bins from..to of a column, as far as they are of one block: `part` 0 is of the block before the
// slot. How many, from which on.
static int find_particles(const brunt_vicinity *v, const int column[3], int part, int64_t *first) {
    const brunt_grid *grid = &v->body->grid;
    const int last = grid->dim - 1, low = part ? grid->order : 0, high = part ? grid->span : grid->order,
              from = v->from > low ? v->from : low, to = v->to < high ? v->to : high;
    int at[3] = {column[0], column[1], column[2]};
    at[last] = from;
    const int32_t *bins = from < to ? find_bins(v, at, first) : NULL;
    if (bins) *first += bins[0];
    return bins ? bins[to - from] - bins[0] : 0;
}

// How many particles the bins before each of a column that is asked for have, from `*start` on; at its end: all.
static void count_column(brunt_vicinity *v, const int column[3], int32_t *start) {
    const brunt_grid *grid = &v->body->grid;
    const int last = grid->dim - 1, middle = grid->order < v->from ? v->from
                                             : grid->order < v->to ? grid->order
                                                                   : v->to;
    int at[3] = {column[0], column[1], column[2]};
    start[v->from] = start[0];
    for (int part = 0; part < 2; part++) {
        const int from = part ? middle : v->from, to = part ? v->to : middle;
        int64_t first;
        at[last] = from;
        const int32_t *bins = from < to ? find_bins(v, at, &first) : NULL;
        for (int k = from; k < to; k++) start[k + 1] = start[k] + (bins ? bins[k + 1 - from] - bins[k - from] : 0);
    }
    start[grid->span] = start[v->to];
}

int brunt_vicinity_turn(brunt_vicinity *v, brunt_body *body, int32_t slot, const int nodes[2], brunt_error *error) {
    const brunt_grid *grid = &body->grid;
    const int columns = grid->dim == 3 ? grid->span : 1;
    int at[3] = {0};
    int32_t *start = v->start, count = 0;
    v->body = body, v->slot = slot, v->from = nodes[0], v->to = nodes[1] + grid->order + 1;
    memset(v->made, 0, sizeof v->made);
    for (at[0] = 0; at[0] < grid->span; at[0]++)
        for (at[1] = 0; at[1] < columns; at[1]++, start += grid->span + 1) {
            start[0] = count;
            count_column(v, at, start);
            count =
                (start[grid->span] + 2 * BRUNT_SPARE - 2) / BRUNT_SPARE * BRUNT_SPARE; // registers are written whole
        }
    v->stride = (size_t)count + BRUNT_SPARE;
    return BRUNT_CAPACITY_IN(v->data, v->bytes, BRUNT_ROWS * v->stride, 0, "numbers of particles about nodes", error);
}

// Of a row, as much as is `left`. Numbers that are `whole` may be read as far as registers go.
BRUNT_INLINE doubles take(const real *from, bool whole, int left) {
    if (whole) return doubles_of(from);
    doubles a = {0};
    for (int l = 0; l < left; l++) a[l] = (double)from[l];
    return a;
}

// Of `count` particles from `first` on of the body. A column of F has no third component in two dimensions, and neither
// has B; volumes are left for later there.
BRUNT_INLINE void take_particles(const brunt_vicinity *v, int64_t first, int count, double *to, bool flat) {
    brunt_particles *p = &v->body->particles;
    const size_t stride = v->stride;
    const int y = p->point_dim, z = flat ? 0 : 2 * y, last = flat ? 0 : 2;
    const doubles none = {0};
    real *const *field = brunt_field(p, BRUNT_FIELD_deformation_gradient), *const *place =
                                                                               brunt_field(p, BRUNT_FIELD_position);
    const real *reach = brunt_field(p, BRUNT_FIELD_reach)[0], *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    const real *xx = field[0], *xy = field[1], *xz = field[last], *yx = field[y], *yy = field[y + 1],
               *yz = field[y + last], *zx = field[z], *zy = field[z + 1], *zz = field[z + last];
    const real *x0 = place[0], *x1 = place[1], *x2 = place[last];
    const int64_t end = p->slots - BRUNT_DOUBLES;
#define TAKE(row) take((row) + s, whole, left)
    for (int i = 0; i < count; i += BRUNT_DOUBLES, to += BRUNT_DOUBLES) {
        const int64_t s = first + i;
        const int left = count - i;
        const bool whole = s <= end;
        const doubles radius = TAKE(reach), ball = radius * radius, Fxx = TAKE(xx), Fxy = TAKE(xy), Fyx = TAKE(yx),
                      Fyy = TAKE(yy), Fxz = flat ? none : TAKE(xz), Fyz = flat ? none : TAKE(yz),
                      Fzx = flat ? none : TAKE(zx), Fzy = flat ? none : TAKE(zy), Fzz = flat ? none : TAKE(zz);
        const doubles Bxx = ball * (Fxx * Fxx + Fxy * Fxy + Fxz * Fxz),
                      Byy = ball * (Fyx * Fyx + Fyy * Fyy + Fyz * Fyz),
                      Bzz = ball * (Fzx * Fzx + Fzy * Fzy + Fzz * Fzz),
                      Byz = ball * (Fyx * Fzx + Fyy * Fzy + Fyz * Fzz),
                      Bxz = ball * (Fxx * Fzx + Fxy * Fzy + Fxz * Fzz),
                      Bxy = ball * (Fxx * Fyx + Fxy * Fyy + Fxz * Fyz);
        double *b = to + BRUNT_ROW_B * stride;
        doubles_store(to, TAKE(x0)), doubles_store(to + stride, TAKE(x1));
        doubles_store(to + 2 * stride, flat ? none : TAKE(x2));
        doubles_store(b, Bxx), doubles_store(b + stride, Byy), doubles_store(b + 2 * stride, Bzz);
        doubles_store(b + 3 * stride, Byz), doubles_store(b + 4 * stride, Bxz), doubles_store(b + 5 * stride, Bxy);
        if (!flat)
            doubles_store(to + BRUNT_ROW_VOLUME * stride,
                          TAKE(volume) * (Fxx * (Fyy * Fzz - Fyz * Fzy) - Fxy * (Fyx * Fzz - Fyz * Fzx) +
                                          Fxz * (Fyx * Fzy - Fyy * Fzx)));
    }
#undef TAKE
}

// Rings count by their area: their volume grows with r, and would seem to have a surface that faces the axis. What is
// freed of stress has no volume, but its place.
static void take_volumes(const brunt_vicinity *v, int64_t first, int count, double *volume) {
    brunt_particles *p = &v->body->particles;
    for (int i = 0; p->dim == 2 && i < count; i++) volume[i] = (double)brunt_plane_volume(p, first + i);
    double place = 1;
    for (int a = 0; a < p->dim; a++) place *= v->body->spacing;
    for (int i = 0; v->body->keeps && i < count; i++)
        if (volume[i] == 0) volume[i] = place;
}

// The two parts of a column one behind the other: what is written behind the first is of the second.
static void make_column(brunt_vicinity *v, const int column[3], int32_t start) {
    for (int part = 0; part < 2; part++) {
        int64_t first;
        const int count = find_particles(v, column, part, &first);
        if (!count) continue;
        if (v->body->grid.dim == 3)
            take_particles(v, first, count, v->data + start, false);
        else
            take_particles(v, first, count, v->data + start, true);
        take_volumes(v, first, count, v->data + BRUNT_ROW_VOLUME * v->stride + start);
        start += count;
    }
}

// Places, less `at`, and volumes of a run, and what comes behind it up to whole registers; B stays where it is.
static void copy_run(const brunt_vicinity *v, const brunt_run run[2], const double at[3], const brunt_cloud *cloud) {
    const int count = run[1].from - run[0].from;
    const size_t there = v->stride, here = cloud->stride;
    const double *restrict x = v->data + run[0].first, *restrict volume = x + BRUNT_ROW_VOLUME * there;
    double *restrict to = cloud->data + run[0].from, *restrict to_volume = to + BRUNT_ROW_VOLUME * here;
    for (int i = 0; i < count; i += BRUNT_DOUBLES) {
        doubles_store(to + i, doubles_load(x + i) - at[0]);
        doubles_store(to + here + i, doubles_load(x + there + i) - at[1]);
        doubles_store(to + 2 * here + i, doubles_load(x + 2 * there + i) - at[2]);
        doubles_store(to_volume + i, doubles_load(volume + i));
    }
}

int brunt_vicinity_look(brunt_vicinity *v, int node, brunt_cloud *cloud, brunt_error *error) {
    const brunt_grid *grid = &v->body->grid;
    const int order = grid->order, columns = grid->dim == 3 ? grid->span : 1;
    brunt_run run[BRUNT_CLOUD_RUNS];
    int local[3], runs = 0, count = 0;
    double at[3];
    brunt_node_local(grid, node, local);
    brunt_node_position(grid, grid->slots[v->slot].coord, node, at);
    for (int kx = order; kx >= 0; kx--)
        for (int ky = grid->dim == 3 ? order : 0; ky >= 0; ky--) {
            const int place[3] = {local[0] + kx, grid->dim == 3 ? local[1] + ky : 0, 0},
                      column = place[0] * columns + place[1];
            const int32_t *start = v->start + column * (grid->span + 1), *here = start + local[grid->dim - 1];
            if (here[order + 1] == here[0]) continue;
            if (!v->made[column]) make_column(v, place, start[0]);
            v->made[column] = true;
            run[runs++] = (brunt_run){here[0], count};
            count += here[order + 1] - here[0];
        }
    run[runs].from = count;
    if (brunt_cloud_reserve(cloud, count, error)) return BRUNT_FAILED;
    memcpy(cloud->run, run, sizeof run);
    cloud->runs = runs, cloud->count = count, cloud->flat = grid->dim < 3;
    cloud->b = v->data + BRUNT_ROW_B * v->stride, cloud->b_stride = v->stride;
    for (int q = 0; q < runs; q++) copy_run(v, &run[q], at, cloud);
    // A register of particles without volume behind the last.
    for (int r = 0; r < 3; r++) doubles_store(cloud->data + (size_t)r * cloud->stride + count, (doubles){0});
    doubles_store(cloud->data + BRUNT_ROW_VOLUME * cloud->stride + count, (doubles){0});
    return BRUNT_OK;
}
