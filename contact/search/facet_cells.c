// Facets by cell: a grid of cells, each with the facets within reach of it, made anew when things have moved.
#include "base/quad.h"
#include "contact/search/node_to_facet_parts.h"

enum { CHUNK = 1024 };
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

// Counts, or lists, the facets of every cell; with them their edges. BRUNT_OK, or BRUNT_FAILED: out of memory.
static int list_facets(const brunt_contact_context *m, brunt_node_to_facet *f, bool list, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    const double by = f->cells.range + MARGIN * s->mean_edge;
    for (int k = 0; k < s->fem_count; k++) {
        if (f->bodies.first[f->bodies.box_of[k] + 1] == f->bodies.first[f->bodies.box_of[k]]) continue;
        for (int32_t face = s->face_range[k]; face < s->face_end[k]; face++) { // of a membrane, for both its sides
            const double *low = s->face_box[face], *high = low + 3;
            int32_t from[3], to[3];
            if (!brunt_broad_phase_in_range(f, f->bodies.box_of[k], low, high, 2 * by)) continue;
            for (int c = 0; c < 4 && s->face[face][c] >= 0; c++) f->cells.near[s->face[face][c]] = true;
            if (list && s->dim == 3 && brunt_feature_edges_add(f, s, k, face, error)) return BRUNT_FAILED;
            cell_range(f, low, high, by, from, to);
            for (int32_t x = from[0]; x <= to[0]; x++)
                for (int32_t y = from[1]; y <= to[1]; y++)
                    for (int32_t z = from[2]; z <= to[2]; z++) {
                        size_t cell =
                            ((size_t)x * (size_t)f->cells.n[1] + (size_t)y) * (size_t)f->cells.n[2] + (size_t)z;
                        if (list)
                            f->cells.face[f->cells.first[cell + 1]++] = face;
                        else
                            f->cells.first[cell + 2]++;
                    }
        }
    }
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
    memset(f->cells.first, 0, (cells + 3) * sizeof *f->cells.first);
    memset(f->cells.near, false, (size_t)s->node_count);
    list_facets(m, f, false, error);
    for (size_t c = 2; c <= cells + 1; c++) f->cells.first[c] += f->cells.first[c - 1];
    if (RESERVE(&f->cells, face, f->cells.first[cells + 1] + 1, "facets in cells", error)) return BRUNT_FAILED;
    if (brunt_feature_edges_clear(f, s, error) || list_facets(m, f, true, error)) return BRUNT_FAILED;
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
