// Facets by cell: a grid of cells, each with the facets within reach of it, made anew when things have moved.
#include "base/quad.h"
#include "contact/search/node_to_facet_parts.h"

enum { CHUNK = 1024, RUN = 256, GRAIN = 4, SLABS = 4 };
static const double MARGIN = 0.125; // mean edges: how far facets may move before the cells are made anew
static const double CELL = 0.75;    // mean edges: of the cells that facets are found in ...
static const double COARSE = 0.25;  // ... of how far they are looked for, where all is fast

bool brunt_broad_phase_in_range(const brunt_node_to_facet *f, int32_t box, const double low[3], const double high[3],
                                double by) {
    for (int32_t q = f->bodies.first[box]; q < f->bodies.first[box + 1]; q++) {
        const body_box *other = &f->bodies.box[f->bodies.list[q]];
        bool apart = false;
        for (int a = 0; a < 3; a++) apart = apart || low[a] - by > other->high[a] || other->low[a] - by > high[a];
        if (!apart) return true;
    }
    return false;
}

// The cell of those along an axis that `at` is in, counted from the first, or the nearest one.
static inline int32_t cell_along(double at, int32_t count) {
    const double cell = floor(at), last = count - 1.0, below = cell < last ? cell : last;
    return (int32_t)(below > 0 ? below : 0);
}

static void cell_range(const brunt_node_to_facet *f, const double low[3], const double high[3], double by,
                       int32_t from[3], int32_t to[3]) {
    for (int a = 0; a < 3; a++) {
        from[a] = cell_along((low[a] - by - f->cells.origin[a]) / f->cells.cell, f->cells.n[a]);
        to[a] = cell_along((high[a] + by - f->cells.origin[a]) / f->cells.cell, f->cells.n[a]);
    }
}

typedef struct list_job {
    const brunt_contact_surface *surface;
    brunt_node_to_facet *f;
    double by;           // [m] from the cells to their facets
    int32_t slabs;       // that the rows of cells are cut into, each of which is one thread's
    int32_t *slab_count; // of each: facets in its cells
} list_job;

// Runs have so many facets of one body, but for its last one: number of the first of body k, and of all.
static int32_t first_run(const brunt_contact_surface *s, int k) { return s->face_range[k] / RUN + k; }

static int body_of_run(const brunt_contact_surface *s, int32_t run) {
    int low = 0, high = s->fem_count;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        *(first_run(s, middle) <= run ? &low : &high) = middle;
    }
    return low;
}

// The facets of body k from `begin` on that are to be listed; several threads may mark a node.
static void take_facets(const list_job *j, int k, int32_t begin, int32_t end, facet_run *run) {
    const brunt_contact_surface *s = j->surface;
    brunt_node_to_facet *f = j->f;
    const int32_t box = f->bodies.box_of[k], rows = f->cells.n[1];
    for (int32_t face = begin; face < end; face++) {
        const double *low = s->face_box[face], *high = low + 3;
        if (!brunt_broad_phase_in_range(f, box, low, high, 2 * j->by)) continue;
        for (int c = 0; c < 4 && s->face[face][c] >= 0; c++)
            __atomic_store_n(&f->cells.near[s->face[face][c]], true, __ATOMIC_RELAXED);
        listed_facet *one = &f->cells.listed[run->first + run->count++];
        one->face = face;
        if (s->dim == 3) run->edge_count += brunt_feature_edges_of(&f->edges, s, k, face, NULL);
        one->from[0] = 0, one->to[0] = -1; // in no cell
        if (!f->bodies.box[box].seen) continue;
        cell_range(f, low, high, j->by, one->from, one->to);
        const int32_t from = one->from[0] * rows + one->from[1], to = one->to[0] * rows + one->to[1];
        run->from = from < run->from ? from : run->from, run->to = to > run->to ? to : run->to;
    }
}

static void take_runs(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const list_job *j = context;
    const brunt_contact_surface *s = j->surface;
    int k = body_of_run(s, (int32_t)begin);
    for (int32_t r = (int32_t)begin; r < end; r++) {
        while (k + 1 < s->fem_count && first_run(s, k + 1) <= r) k++;
        const int32_t first = s->face_range[k] + (r - first_run(s, k)) * RUN, last = first + RUN;
        facet_run *run = &j->f->cells.run[r];
        *run = (facet_run){.first = first, .from = INT32_MAX, .to = -1};
        if (has_near_bodies(&j->f->bodies, j->f->bodies.box_of[k])) // of a membrane, its front for both its sides
            take_facets(j, k, first, last < s->face_end[k] ? last : s->face_end[k], run);
    }
}

static void add_edges(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const list_job *j = context;
    brunt_node_to_facet *f = j->f;
    int k = body_of_run(j->surface, (int32_t)begin);
    for (int32_t r = (int32_t)begin; r < end; r++) {
        const facet_run *run = &f->cells.run[r];
        while (k + 1 < j->surface->fem_count && first_run(j->surface, k + 1) <= r) k++;
        near_edge *to = f->edges.near + run->first_edge;
        for (int32_t i = 0; i < run->count && run->edge_count; i++)
            to += brunt_feature_edges_of(&f->edges, j->surface, k, f->cells.listed[run->first + i].face, to);
    }
}

// Lists the facets that are near other bodies, and their edges, in the order of the surface. BRUNT_OK, or BRUNT_FAILED:
// out of memory.
static int list_facets(const brunt_contact_context *m, list_job *j, brunt_error *error) {
    const brunt_contact_surface *s = j->surface;
    brunt_node_to_facet *f = j->f;
    const int32_t runs = first_run(s, s->fem_count);
    if (RESERVE(&f->cells, listed, s->face_count + 1, "facets near other bodies", error) ||
        RESERVE(&f->cells, run, runs + 1, "runs of facets", error) || brunt_feature_edges_begin(f, s, error))
        return BRUNT_FAILED;
    brunt_parallel(m->threads, runs, GRAIN, take_runs, j, m->timer);
    f->edges.near_count = 0;
    for (int k = 0; k < s->fem_count; k++) {
        f->edges.first[2 * k] = f->edges.near_count;
        for (int32_t r = first_run(s, k); r < first_run(s, k + 1); r++) {
            f->cells.run[r].first_edge = f->edges.near_count;
            f->edges.near_count += f->cells.run[r].edge_count;
        }
        f->edges.first[2 * k + 1] = f->edges.near_count;
    }
    if (RESERVE(&f->edges, near, f->edges.near_count + 1, "edges near other bodies", error)) return BRUNT_FAILED;
    if (f->edges.near_count) brunt_parallel(m->threads, runs, GRAIN, add_edges, j, m->timer);
    return BRUNT_OK;
}

static inline int32_t rows_of(const facet_cells *cells) { return cells->n[0] * cells->n[1]; }

// Counts, or (`face` is there) lists, the facets in the cells of the rows begin .. end, whose next places are `next`.
static void go_through(const list_job *j, int32_t begin, int32_t end, int32_t *next, int32_t *face) {
    const facet_cells *cells = &j->f->cells;
    const int32_t runs = first_run(j->surface, j->surface->fem_count), rows = cells->n[1], deep = cells->n[2];
    for (int32_t r = 0; r < runs; r++) {
        const facet_run *run = &cells->run[r];
        if (run->from >= end || run->to < begin) continue;
        for (const listed_facet *one = cells->listed + run->first, *last = one + run->count; one < last; one++)
            for (int32_t x = one->from[0]; x <= one->to[0]; x++) {
                const int32_t low = begin - x * rows, high = end - 1 - x * rows;
                const int32_t from = one->from[1] > low ? one->from[1] : low,
                              to = one->to[1] < high ? one->to[1] : high;
                for (int32_t y = from; y <= to; y++) {
                    int32_t *row = next + ((size_t)x * (size_t)rows + (size_t)y) * (size_t)deep;
                    for (int32_t z = one->from[2]; z <= one->to[2]; z++)
                        if (face)
                            face[row[z]++] = one->face;
                        else
                            row[z]++;
                }
            }
    }
}

static void rows_of_slab(const list_job *j, int64_t slab, int32_t rows[2]) {
    const int64_t all = rows_of(&j->f->cells);
    rows[0] = (int32_t)(all * slab / j->slabs), rows[1] = (int32_t)(all * (slab + 1) / j->slabs);
}

// Cell c's facets are counted in first[c + 1], which becomes where they begin in those of their slab ...
static void count_slabs(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const list_job *j = context;
    const size_t deep = (size_t)j->f->cells.n[2];
    for (int64_t slab = begin; slab < end; slab++) {
        int32_t *next = j->f->cells.first + 1, sum = 0, rows[2];
        rows_of_slab(j, slab, rows);
        const size_t from = (size_t)rows[0] * deep, to = (size_t)rows[1] * deep;
        memset(next + from, 0, (to - from) * sizeof *next);
        go_through(j, rows[0], rows[1], next, NULL);
        for (size_t c = from; c < to; c++) {
            const int32_t count = next[c];
            next[c] = sum, sum += count;
        }
        j->slab_count[slab] = sum;
    }
}

// ... and, as they are listed, where they end. `slab_count`: of all slabs before each.
static void fill_slabs(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const list_job *j = context;
    for (int64_t slab = begin; slab < end; slab++) {
        const size_t deep = (size_t)j->f->cells.n[2];
        int32_t *next = j->f->cells.first + 1, rows[2];
        rows_of_slab(j, slab, rows);
        for (size_t c = (size_t)rows[0] * deep; c < (size_t)rows[1] * deep; c++) next[c] += j->slab_count[slab];
        go_through(j, rows[0], rows[1], next, j->f->cells.face);
    }
}

// So many that each thread has a few, where there is as much to do; each goes through the runs by itself.
static int32_t slabs_for(const brunt_contact_context *m, const list_job *j) {
    int64_t listed = 0;
    for (int32_t r = 0; r < first_run(j->surface, j->surface->fem_count); r++) listed += j->f->cells.run[r].count;
    const int64_t most = m->threads > 1 ? SLABS * (int64_t)m->threads : 1, worth = listed / RUN;
    const int64_t slabs = worth < most ? worth : most, rows = rows_of(&j->f->cells);
    return (int32_t)(slabs < 1 ? 1 : slabs < rows ? slabs : rows);
}

static int fill_cells(const brunt_contact_context *m, list_job *j, brunt_error *error) {
    brunt_node_to_facet *f = j->f;
    int32_t counts[SLABS * BRUNT_THREAD_LIMIT], all = 0;
    j->slab_count = counts, j->slabs = slabs_for(m, j);
    f->cells.first[0] = 0;
    brunt_parallel(m->threads, j->slabs, 1, count_slabs, j, m->timer);
    for (int32_t slab = 0; slab < j->slabs; slab++) {
        const int32_t count = counts[slab];
        counts[slab] = all, all += count;
    }
    if (RESERVE(&f->cells, face, all + 1, "facets in cells", error)) return BRUNT_FAILED;
    brunt_parallel(m->threads, j->slabs, 1, fill_slabs, j, m->timer);
    return BRUNT_OK;
}

// The room that pairs share, cut into cells; few enough that making them costs no more than the facets do.
static void size_cells(const brunt_contact_context *m, brunt_node_to_facet *f) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t p = 0; p < f->bodies.pair_count; p++) {
        const body_box *a = &f->bodies.box[f->bodies.pair[p].a], *b = &f->bodies.box[f->bodies.pair[p].b];
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], fmax(a->low[k], b->low[k]) - 3 * f->cells.range);
            high[k] = fmax(high[k], fmin(a->high[k], b->high[k]) + 3 * f->cells.range);
        }
    }
    const double greatest = 32.0 * m->surface->face_count + 4096;
    f->cells.cell = fmax(CELL * m->surface->mean_edge, COARSE * f->cells.range);
    for (;; f->cells.cell *= 1.25) {
        double cells = 1;
        for (int k = 0; k < 3; k++) cells *= floor((high[k] - low[k]) / f->cells.cell) + 1;
        if (cells <= greatest) break;
    }
    for (int k = 0; k < 3; k++) {
        f->cells.origin[k] = low[k];
        f->cells.n[k] = (int32_t)(floor((high[k] - low[k]) / f->cells.cell) + 1);
    }
}

// Where a body's box is kept: bodies with facets, then bodies of material points.
static int32_t box_number(const brunt_contact_surface *s, const body_box *box) {
    return box->fem >= 0 ? box->fem : s->fem_count + box->mpm;
}

// Beside the nodes of facets that are listed: what has no facets, and the backs of membranes, whose fronts are listed.
static void mark_others(const brunt_contact_surface *s, brunt_node_to_facet *f) {
    for (int32_t n = 0; n < s->node_count; n++) {
        if (s->face_first[n + 1] == s->face_first[n]) f->cells.near[n] = true;
        if (s->membrane.front) f->cells.near[n] = f->cells.near[n] || f->cells.near[s->membrane.front[n]];
    }
}

static int make_cells(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    f->cells.range = 1.25 * f->bodies.range;
    size_cells(m, f);
    size_t cells = (size_t)f->cells.n[0] * (size_t)f->cells.n[1] * (size_t)f->cells.n[2];
    if (RESERVE(&f->cells, first, cells + 3, "cells of facets", error) ||
        RESERVE(&f->cells, x, s->node_count + 1, "places of nodes", error) ||
        RESERVE(&f->cells, moved, s->node_count / CHUNK + 1, "chunks of nodes", error) ||
        RESERVE(&f->cells, near, s->node_count + 1, "marks of nodes", error) ||
        RESERVE(&f->cells, box, f->bodies.box_count + 1, "boxes of cells of facets", error))
        return BRUNT_FAILED;
    memset(f->cells.near, false, (size_t)s->node_count);
    list_job j = {.surface = s, .f = f, .by = f->cells.range + MARGIN * s->mean_edge};
    if (list_facets(m, &j, error) || fill_cells(m, &j, error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k]) continue;
        memcpy(f->cells.x + s->node_range[k], s->x + s->node_range[k],
               (size_t)(s->node_range[k + 1] - s->node_range[k]) * sizeof *s->x);
    }
    for (int32_t b = 0; b < f->bodies.box_count; b++) f->cells.box[box_number(s, &f->bodies.box[b])] = f->bodies.box[b];
    mark_others(s, f);
    memset(f->cells.shift, 0, sizeof f->cells.shift);
    f->cells.made = true;
    return BRUNT_OK;
}

// Whether all that look in are where the cells were made for: what they share then is within the room (three ranges, of
// which looking takes one), and the facets in their range are listed (two ranges from where they were).
static bool boxes_hold(const brunt_contact_context *m, const brunt_node_to_facet *f) {
    for (int32_t b = 0; b < f->bodies.box_count; b++) {
        const body_box *now = &f->bodies.box[b], *then = &f->cells.box[box_number(m->surface, now)];
        if (f->bodies.first[b + 1] == f->bodies.first[b]) continue;
        for (int a = 0; a < 3; a++)
            if (now->low[a] - f->cells.shift[a] < then->low[a] - f->cells.range ||
                now->high[a] - f->cells.shift[a] > then->high[a] + f->cells.range)
                return false;
    }
    return true;
}

typedef struct motion_job {
    const brunt_contact_surface *surface;
    const brunt_node_to_facet *f;
} motion_job;

static void bound_motion(const motion_job *j, int k, int32_t begin, int32_t end, motion_bounds bounds[2]) {
    const brunt_contact_surface *s = j->surface;
    const uint8_t *near = j->f->cells.near;
    quad low[2] = {{0}, {0}}, high[2] = {{0}, {0}};
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) low[i][a] = bounds[i].low[a], high[i][a] = bounds[i].high[a];
    for (int32_t n = begin > s->node_range[k] ? begin : s->node_range[k]; n < end && n < s->node_range[k + 1]; n++) {
        const quad moved = quad_load(s->x[n]) - quad_load(j->f->cells.x[n]);
        const int i = !near[n];
        low[i] = quad_min(moved, low[i]), high[i] = quad_max(moved, high[i]);
    }
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) bounds[i].low[a] = low[i][a], bounds[i].high[a] = high[i][a];
}

static void look_at_motion(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const motion_job *j = context;
    const brunt_contact_surface *s = j->surface;
    int k = 0;
    for (int64_t c = begin; c < end; c++) {
        const int32_t first = (int32_t)c * CHUNK, last = first + CHUNK;
        motion_bounds *bounds = j->f->cells.moved[c];
        for (int i = 0; i < 2; i++)
            for (int a = 0; a < 3; a++) bounds[i].low[a] = INFINITY, bounds[i].high[a] = -INFINITY;
        while (s->node_range[k + 1] <= first) k++;
        for (int body = k; body < s->fem_count && s->node_range[body] < last; body++)
            if (has_near_bodies(&j->f->bodies, j->f->bodies.box_of[body])) bound_motion(j, body, first, last, bounds);
    }
}

// The furthest that anything within bounds is off their shift [m].
static double off(const motion_bounds *b, const double shift[3]) {
    double square = 0;
    for (int a = 0; a < 3; a++) square += pow(fmax(0, fmax(b->high[a] - shift[a], shift[a] - b->low[a])), 2);
    return sqrt(square);
}

// Whether nothing has moved further than the cells allow, but together. What is near is listed that far around. What is
// not was further than twice the reach of a list from the boxes of all others, and may come half of the rest
// nearer; from material points it was that far from what may come by a range itself.
static bool motion_holds(const brunt_contact_context *m, brunt_node_to_facet *f) {
    const brunt_contact_surface *s = m->surface;
    const int64_t chunks = (s->node_count + CHUNK - 1) / CHUNK;
    const double margin = MARGIN * s->mean_edge, others = margin + (f->particles.mpm_count ? 0 : 0.5 * f->cells.range);
    motion_bounds all[2];
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) all[i].low[a] = INFINITY, all[i].high[a] = -INFINITY;
    brunt_parallel(m->threads, chunks, 1, look_at_motion, &(motion_job){s, f}, m->timer);
    for (int64_t c = 0; c < chunks; c++)
        for (int i = 0; i < 2; i++)
            for (int a = 0; a < 3; a++) {
                all[i].low[a] = fmin(all[i].low[a], f->cells.moved[c][i].low[a]);
                all[i].high[a] = fmax(all[i].high[a], f->cells.moved[c][i].high[a]);
            }
    const motion_bounds *together = &all[all[0].low[0] <= all[0].high[0] ? 0 : 1];
    for (int a = 0; a < 3; a++)
        f->cells.shift[a] = together->low[a] <= together->high[a] ? 0.5 * (together->low[a] + together->high[a]) : 0;
    return off(&all[0], f->cells.shift) <= margin && off(&all[1], f->cells.shift) <= others;
}

// Whether the cells still hold all that may be near: nothing has moved further than they allow, and the same bodies are
// near.
static bool cells_hold(const brunt_contact_context *m, brunt_node_to_facet *f, uint64_t pairs) {
    return f->cells.made && f->cells.pair_count == f->bodies.pair_count && f->cells.pairs_key == pairs &&
           f->bodies.range <= f->cells.range && motion_holds(m, f) && boxes_hold(m, f);
}

// A number that differs when other bodies are near or active.
static uint64_t pairs_key(const brunt_contact_context *m, const brunt_node_to_facet *f) {
    uint64_t key = 1469598103934665603ull;
    for (int32_t p = 0; p < f->bodies.pair_count; p++) {
        uint64_t a = (uint64_t)f->bodies.box[f->bodies.pair[p].a].body,
                 b = (uint64_t)f->bodies.box[f->bodies.pair[p].b].body;
        uint64_t low = a < b ? a : b, high = a < b ? b : a;
        key += (low * 1000003u + high + 1) * 0x9E3779B97F4A7C15ull;
    }
    for (int k = 0; k < m->surface->fem_count; k++)
        key += m->surface->active[k] ? (uint64_t)(k + 1) * 1099511628211ull : 0;
    return key;
}

int brunt_facet_cells_make(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error) {
    uint64_t key = pairs_key(m, f);
    if (cells_hold(m, f, key)) return BRUNT_OK;
    if (make_cells(m, f, error)) return BRUNT_FAILED;
    f->cells.pair_count = f->bodies.pair_count, f->cells.pairs_key = key;
    return BRUNT_OK;
}

void brunt_facet_cells_validate(const facet_cells *cells, int32_t faces) {
    if (!cells->made) return;
    const int64_t count = (int64_t)cells->n[0] * cells->n[1] * cells->n[2];
    BRUNT_ASSERT(cells->cell > 0 && cells->range >= 0 && count > 0 && cells->first[0] == 0);
    for (int64_t c = 0; c < count; c++) BRUNT_ASSERT(cells->first[c] <= cells->first[c + 1]);
    for (int32_t i = 0; i < cells->first[count]; i++) BRUNT_ASSERT(cells->face[i] >= 0 && cells->face[i] < faces);
}
