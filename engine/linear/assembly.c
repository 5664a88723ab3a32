#include "linear/assembly.h"

#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"

enum { COLOURS_A_ROUND = 64, GRAIN = 4 };
// Stencils side by side in a list, as elements of a mesh are, share most of their rows, which a bundle keeps in the
// cache; one by one, each colour would go through the whole matrix. Worth it where the matrix is larger than the cache.
enum { BUNDLE = 64, MANY = 16384 };

// The stencil after the last one of bundle g.
static int64_t bundle_end(const brunt_colours *c, int64_t g) {
    return (g + 1) * c->bundle < c->count ? (g + 1) * c->bundle : c->count;
}

static int64_t bundles(const brunt_colours *c) { return (c->count + c->bundle - 1) / c->bundle; }

// Nodes of a list: of one of many bodies they are next to none of all.
typedef struct node_range {
    int32_t begin, end;
} node_range;

static node_range range_of(const brunt_stencils *list) {
    node_range range = {INT32_MAX, 0};
    for (int64_t k = list->count ? list->first[0] : 0; k < (list->count ? list->first[list->count] : 0); k++) {
        if (list->node[k] < range.begin) range.begin = list->node[k];
        if (list->node[k] >= range.end) range.end = list->node[k] + 1;
    }
    return range.begin < range.end ? range : (node_range){0, 0};
}

// Gives colours base .. base + 63 to bundles that have none; how many are left without. A node remembers the colours
// of this round by one bit each.
static int64_t colour_round(brunt_colours *c, const brunt_stencils *list, const node_range *range, int64_t base) {
    int64_t left = 0;
    memset(c->used, 0, (size_t)(range->end - range->begin) * sizeof *c->used);
    for (int64_t g = 0; g < bundles(c); g++) {
        if (c->order[g] >= 0) continue;
        const int64_t from = list->first[g * c->bundle], to = list->first[bundle_end(c, g)];
        uint64_t used = 0;
        for (int64_t k = from; k < to; k++) used |= c->used[list->node[k] - range->begin];
        if (used == UINT64_MAX) {
            left++;
            continue;
        }
        const int bit = __builtin_ctzll(~used);
        c->order[g] = base + bit;
        if (base + bit >= c->colours) c->colours = (int32_t)(base + bit + 1);
        for (int64_t k = from; k < to; k++) c->used[list->node[k] - range->begin] |= (uint64_t)1 << bit;
    }
    return left;
}

static int sort_by_colour(brunt_colours *c, brunt_error *error) {
    if (BRUNT_CAPACITY(c->first, (size_t)c->colours + 2, 0, "colours of stencils", error)) return BRUNT_FAILED;
    int64_t *next = c->first + 1;
    memset(c->first, 0, ((size_t)c->colours + 2) * sizeof *c->first);
    for (int64_t g = 0; g < bundles(c); g++) next[c->order[g] + 1]++;
    for (int32_t k = 0; k < c->colours; k++) next[k + 1] += next[k];
    for (int64_t g = 0; g < bundles(c); g++) c->stencil[next[c->order[g]]++] = g * c->bundle;
    return BRUNT_OK;
}

int brunt_colours_make(brunt_colours *c, const brunt_team *team, int dim, int32_t nodes, const brunt_stencils *list,
                       brunt_error *error) {
    int64_t largest = 0;
    const node_range range = range_of(list);
    BRUNT_ASSERT(range.begin >= 0 && range.end <= nodes);
    if (BRUNT_CAPACITY(c->used, (size_t)(range.end - range.begin), 0, "nodes of stencils", error) ||
        BRUNT_CAPACITY(c->order, (size_t)list->count, 0, "stencils to assemble", error) ||
        BRUNT_CAPACITY(c->stencil, (size_t)list->count, 0, "stencils to assemble", error))
        return BRUNT_FAILED;
    for (int64_t s = 0; s < list->count; s++) {
        const int64_t size = list->first[s + 1] - list->first[s];
        if (size > largest) largest = size;
        c->order[s] = -1;
    }
    c->count = list->count, c->bundle = list->count < MANY ? 1 : BUNDLE, c->colours = 0, c->threads = team->threads,
    c->dense_size = largest * largest * dim * dim;
    for (int64_t base = 0, left = bundles(c); left; base += COLOURS_A_ROUND) left = colour_round(c, list, &range, base);
    if (sort_by_colour(c, error)) return BRUNT_FAILED;
    return BRUNT_CAPACITY(c->dense, (size_t)(c->dense_size * c->threads), 0, "values of dense matrices of stencils",
                          error);
}

void brunt_colours_free(brunt_colours *c) {
    brunt_free(c->stencil), brunt_free(c->first), brunt_free(c->used), brunt_free(c->order), brunt_free(c->dense);
    *c = (brunt_colours){0};
}

typedef struct colour_work {
    brunt_block_matrix *m;
    const brunt_stencils *stencils;
    const brunt_colours *colours;
    const int64_t *stencil; // of the colour
    brunt_stencil_fn *fill;
    void *context;
    bool diagonal; // alone
} colour_work;

static void add_diagonal(brunt_block_matrix *m, const int32_t *node, int count, const double *dense) {
    const int dim = m->dim, size = count * dim;
    for (int a = 0; a < count; a++) {
        double *block = brunt_block_matrix_diagonal(m, node[a]);
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) block[i * dim + j] += dense[(a * dim + i) * size + a * dim + j];
    }
}

static void add_stencil(const colour_work *w, int64_t s, double *dense, int worker) {
    const int64_t from = w->stencils->first[s];
    const int count = (int)(w->stencils->first[s + 1] - from);
    memset(dense, 0, (size_t)count * (size_t)count * (size_t)(w->m->dim * w->m->dim) * sizeof *dense);
    w->fill(w->context, s, dense, worker);
    (w->diagonal ? add_diagonal : brunt_block_matrix_add)(w->m, w->stencils->node + from, count, dense);
}

static void add_bundles(void *context, int64_t begin, int64_t end, int worker) {
    const colour_work *w = context;
    const brunt_colours *c = w->colours;
    for (int64_t i = begin; i < end; i++)
        for (int64_t s = w->stencil[i]; s < bundle_end(c, w->stencil[i] / c->bundle); s++)
            add_stencil(w, s, c->dense + worker * c->dense_size, worker);
}

static void assemble(colour_work work, const brunt_team *team) {
    const brunt_colours *c = work.colours;
    BRUNT_ASSERT(c->count == work.stencils->count && team->threads <= c->threads);
    for (int32_t k = 0; k < c->colours; k++) {
        work.stencil = c->stencil + c->first[k];
        brunt_parallel(team->threads, c->first[k + 1] - c->first[k], c->bundle > 1 ? 1 : GRAIN, add_bundles, &work,
                       team->timer);
    }
}

void brunt_assemble(brunt_block_matrix *m, const brunt_team *team, const brunt_stencils *stencils,
                    const brunt_colours *c, brunt_stencil_fn *fill, void *context) {
    assemble((colour_work){m, stencils, c, NULL, fill, context, false}, team);
}

void brunt_assemble_diagonal(brunt_block_matrix *m, const brunt_team *team, const brunt_stencils *stencils,
                             const brunt_colours *c, brunt_stencil_fn *fill, void *context) {
    assemble((colour_work){m, stencils, c, NULL, fill, context, true}, team);
}
