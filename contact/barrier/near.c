#include "contact/barrier/near.h"

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ENTRIES = 32, CELLS = 8, SPARE = 4096, QUERIES = 64, PARTS = 64 };

static int32_t cell_of(const brunt_near_cells *c, double x, int k) {
    const double i = floor((x - c->low[k]) / c->cell);
    return i < 0 ? 0 : i >= c->n[k] ? c->n[k] - 1 : (int32_t)i;
}

typedef struct cell_range {
    int32_t low[3], high[3];
} cell_range;

static cell_range range_of(const brunt_near_cells *c, const brunt_near_box *box) {
    cell_range r = {0};
    for (int k = 0; k < c->dim; k++) r.low[k] = cell_of(c, box->low[k], k), r.high[k] = cell_of(c, box->high[k], k);
    return r;
}

static int64_t cells_in(const cell_range *r) {
    int64_t n = 1;
    for (int k = 0; k < 3; k++) n *= r->high[k] - r->low[k] + 1;
    return n;
}

typedef struct cells_work {
    brunt_near_cells *c;
    int parts; // of the items
    bool fill; // else entries are counted
    double low[PARTS][3], high[PARTS][3], mean[PARTS];
    int64_t entries[PARTS];
} cells_work;

static int32_t part_begin(const cells_work *w, int64_t part) {
    return (int32_t)((int64_t)w->c->count * part / w->parts);
}

static void take_bounds(void *context, int64_t begin, int64_t end, int worker) {
    cells_work *w = context;
    (void)worker;
    for (int64_t part = begin; part < end; part++) {
        double *low = w->low[part], *high = w->high[part], mean = 0;
        for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
        for (int32_t i = part_begin(w, part); i < part_begin(w, part + 1); i++)
            for (int k = 0; k < w->c->dim; k++) {
                const double from = w->c->box[i].low[k], to = w->c->box[i].high[k];
                if (from < low[k]) low[k] = from;
                if (to > high[k]) high[k] = to;
                mean += to - from;
            }
        w->mean[part] = mean;
    }
}

static void count_entries(void *context, int64_t begin, int64_t end, int worker) {
    cells_work *w = context;
    (void)worker;
    for (int64_t part = begin; part < end; part++) {
        w->entries[part] = 0;
        for (int32_t i = part_begin(w, part); i < part_begin(w, part + 1); i++) {
            const cell_range r = range_of(w->c, &w->c->box[i]);
            w->entries[part] += cells_in(&r);
        }
    }
}

// Cells of the mean box's size: larger ones where they, or the entries in them, would be many more than the items.
static int64_t choose_cells(cells_work *w, const brunt_team *team) {
    brunt_near_cells *c = w->c;
    double mean = 0, span = 0;
    w->parts = PARTS;
    brunt_parallel(team->threads, w->parts, 1, take_bounds, w, team->timer);
    for (int k = 0; k < 3; k++) {
        c->n[k] = 1, c->low[k] = k < c->dim ? INFINITY : 0, c->high[k] = k < c->dim ? -INFINITY : 0;
        for (int part = 0; part < w->parts && k < c->dim; part++)
            c->low[k] = fmin(c->low[k], w->low[part][k]), c->high[k] = fmax(c->high[k], w->high[part][k]);
        span = fmax(span, c->high[k] - c->low[k]);
    }
    for (int part = 0; part < w->parts; part++) mean += w->mean[part] / c->dim / c->count;
    c->cell = fmax(fmax(mean, span / 1024), 1e-300);
    for (;; c->cell *= 2) {
        int64_t cells = 1, entries = 0;
        for (int k = 0; k < c->dim; k++) cells *= c->n[k] = (int32_t)((c->high[k] - c->low[k]) / c->cell) + 1;
        if (cells > CELLS * (int64_t)c->count + SPARE) continue;
        brunt_parallel(team->threads, w->parts, 1, count_entries, w, team->timer);
        for (int part = 0; part < w->parts; part++) entries += w->entries[part];
        if (entries <= ENTRIES * (int64_t)c->count + SPARE || cells == 1) return entries;
    }
}

static int64_t cell_index(const brunt_near_cells *c, int32_t i, int32_t j, int32_t k) {
    return ((int64_t)k * c->n[1] + j) * c->n[0] + i;
}

// A part's items into their cells, where those of earlier parts end; or how many it has in each.
static void fill_cells(void *context, int64_t begin, int64_t end, int worker) {
    const cells_work *w = context;
    brunt_near_cells *c = w->c;
    (void)worker;
    for (int64_t part = begin; part < end; part++) {
        int32_t *next = c->next + part * c->n[0] * c->n[1] * c->n[2];
        for (int32_t b = part_begin(w, part); b < part_begin(w, part + 1); b++) {
            const cell_range r = range_of(c, &c->box[b]);
            for (int32_t k = r.low[2]; k <= r.high[2]; k++)
                for (int32_t j = r.low[1]; j <= r.high[1]; j++)
                    for (int32_t i = r.low[0]; i <= r.high[0]; i++) {
                        const int64_t cell = cell_index(c, i, j, k);
                        if (w->fill) c->item[c->first[cell] + next[cell]] = b;
                        next[cell]++;
                    }
        }
    }
}

int brunt_near_cells_make(brunt_near_cells *c, const brunt_team *team, const brunt_near_box *box, int32_t count,
                          int dim, brunt_error *error) {
    cells_work work = {.c = c};
    c->dim = dim, c->count = count, c->box = box;
    if (count == 0) return BRUNT_OK;
    const int64_t entries = choose_cells(&work, team), cells = (int64_t)c->n[0] * c->n[1] * c->n[2];
    work.parts = team->threads < PARTS ? team->threads : PARTS;
    const size_t counts = (size_t)(cells * work.parts);
    if (BRUNT_CAPACITY(c->first, (size_t)cells + 1, 0, "cells of what may be in contact", error) ||
        BRUNT_CAPACITY(c->next, counts, 0, "cells of what may be in contact", error) ||
        BRUNT_CAPACITY(c->item, (size_t)entries, 0, "items in cells of what may be in contact", error))
        return BRUNT_FAILED;
    memset(c->next, 0, counts * sizeof *c->next);
    brunt_parallel_each(team->threads, work.parts, fill_cells, &work, team->timer);
    c->first[0] = 0;
    for (int64_t i = 0; i < cells; i++) {
        int32_t before = 0;
        for (int part = 0; part < work.parts; part++) {
            int32_t *at = &c->next[part * cells + i];
            const int32_t own = *at;
            *at = before, before += own;
        }
        c->first[i + 1] = c->first[i] + before;
    }
    work.fill = true;
    brunt_parallel_each(team->threads, work.parts, fill_cells, &work, team->timer);
    return BRUNT_OK;
}

void brunt_near_cells_free(brunt_near_cells *c) {
    brunt_free(c->first), brunt_free(c->item), brunt_free(c->next);
    *c = (brunt_near_cells){0};
}

static bool boxes_meet(const brunt_near_box *a, const brunt_near_box *b, int dim) {
    for (int k = 0; k < dim; k++)
        if (a->high[k] < b->low[k] || b->high[k] < a->low[k]) return false;
    return true;
}

// A pair of boxes counts in the first cell that both reach, and in no other.
static bool first_shared(const brunt_near_cells *c, const cell_range *query, const brunt_near_box *item,
                         const int32_t cell[3]) {
    for (int k = 0; k < c->dim; k++) {
        const int32_t low = cell_of(c, item->low[k], k);
        if (cell[k] != (low > query->low[k] ? low : query->low[k])) return false;
    }
    return true;
}

int64_t brunt_near_find(const brunt_near_cells *c, const brunt_near_box *box, brunt_near_wanted *wanted,
                        const void *context, int32_t query, int32_t *out) {
    if (c->count == 0) return 0;
    for (int k = 0; k < c->dim; k++)
        if (box->high[k] < c->low[k] || box->low[k] > c->high[k]) return 0;
    const cell_range r = range_of(c, box);
    int64_t found = 0;
    for (int32_t k = r.low[2]; k <= r.high[2]; k++)
        for (int32_t j = r.low[1]; j <= r.high[1]; j++)
            for (int32_t i = r.low[0]; i <= r.high[0]; i++) {
                const int64_t cell = cell_index(c, i, j, k);
                for (int64_t e = c->first[cell]; e < c->first[cell + 1]; e++) {
                    const int32_t item = c->item[e];
                    if (!boxes_meet(box, &c->box[item], c->dim)) continue;
                    if (!first_shared(c, &r, &c->box[item], (int32_t[]){i, j, k})) continue;
                    if (!wanted(context, query, item)) continue;
                    if (out) out[found] = item;
                    found++;
                }
            }
    return found;
}

int64_t brunt_near_among(const brunt_near_list *list, const brunt_near_box *item, int dim, const brunt_near_box *box,
                         int32_t query, int32_t *out) {
    int64_t found = 0;
    for (int64_t k = list->first[query]; k < list->first[query + 1]; k++) {
        if (!boxes_meet(box, &item[list->item[k]], dim)) continue;
        if (out) out[found] = list->item[k];
        found++;
    }
    return found;
}

bool brunt_near_any(const brunt_near_cells *c, const brunt_near_box *box) {
    if (c->count == 0) return false;
    for (int k = 0; k < c->dim; k++)
        if (box->high[k] < c->low[k] || box->low[k] > c->high[k]) return false;
    const cell_range r = range_of(c, box);
    for (int32_t k = r.low[2]; k <= r.high[2]; k++)
        for (int32_t j = r.low[1]; j <= r.high[1]; j++)
            if (c->first[cell_index(c, r.low[0], j, k)] < c->first[cell_index(c, r.high[0], j, k) + 1]) return true;
    return false;
}

typedef struct list_work {
    brunt_near_list *list;
    const brunt_near_queries *queries;
} list_work;

static int32_t query_of(const brunt_near_queries *q, int64_t i) { return q->asked ? q->asked[i] : (int32_t)i; }

static void list_count(void *context, int64_t begin, int64_t end, int worker) {
    const list_work *w = context;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const int32_t q = query_of(w->queries, i);
        w->list->first[q + 1] = w->queries->find(w->queries->context, q, NULL);
    }
}

static bool ascends(const int32_t *item, int64_t count) {
    for (int64_t i = 1; i < count; i++)
        if (item[i] < item[i - 1]) return false;
    return true;
}

static int ascending(const void *a, const void *b) {
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static void list_fill(void *context, int64_t begin, int64_t end, int worker) {
    const list_work *w = context;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const int32_t q = query_of(w->queries, i);
        const int64_t first = w->list->first[q], count = w->list->first[q + 1] - first;
        if (count == 0) continue;
        const int64_t found = w->queries->find(w->queries->context, q, w->list->item + first);
        BRUNT_ASSERT(found == count);
        if (!ascends(w->list->item + first, count))
            qsort(w->list->item + first, (size_t)count, sizeof *w->list->item, ascending);
    }
}

// Counts become beginnings, of those that were not asked as well.
static void add_up(brunt_near_list *list, const brunt_near_queries *queries, int64_t asked) {
    int32_t next = 0;
    int64_t sum = 0;
    for (int64_t i = 0; i < asked; i++) {
        const int32_t q = query_of(queries, i);
        const int64_t count = list->first[q + 1];
        while (next <= q) list->first[next++] = sum;
        sum += count;
    }
    while (next <= queries->count) list->first[next++] = sum;
}

int brunt_near_list_make(brunt_near_list *list, const brunt_team *team, const brunt_near_queries *queries,
                         brunt_error *error) {
    list_work work = {list, queries};
    const int64_t asked = queries->asked ? queries->asked_count : queries->count;
    if (BRUNT_CAPACITY(list->first, (size_t)queries->count + 1, 0, "points and edges that may be in contact", error))
        return BRUNT_FAILED;
    list->count = queries->count;
    brunt_parallel(team->threads, asked, QUERIES, list_count, &work, team->timer);
    add_up(list, queries, asked);
    const int64_t found = list->first[queries->count];
    if (BRUNT_CAPACITY(list->item, (size_t)found + 1, 0, "features near points and edges", error)) return BRUNT_FAILED;
    if (found) brunt_parallel(team->threads, asked, QUERIES, list_fill, &work, team->timer);
    return BRUNT_OK;
}

void brunt_near_list_free(brunt_near_list *list) {
    brunt_free(list->first), brunt_free(list->item);
    *list = (brunt_near_list){0};
}
