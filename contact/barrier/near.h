// Which boxes of items others meet: items in cells of a grid, and lists of what each query found. Deterministic: lists
// ascend, whatever the threads.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "linear/term.h"

typedef struct brunt_near_box {
    double low[3], high[3];
} brunt_near_box;

typedef struct brunt_near_cells {
    int dim;
    double low[3], high[3], cell; // [m] of all boxes; edge of a cell
    int32_t n[3];
    int32_t count;
    const brunt_near_box *box; // of the items; the caller's
    int64_t *first;            // items of cell c: item[first[c]] .. item[first[c + 1] - 1], ascending
    int32_t *item, *next;      // (of each thread and cell, while they are filled: how many items it has)
    size_t first_capacity, item_capacity, next_capacity;
} brunt_near_cells;

typedef struct brunt_near_list {
    int64_t *first; // of query q: item[first[q]] .. item[first[q + 1] - 1], ascending
    int32_t *item;
    int32_t count; // queries
    size_t first_capacity, item_capacity;
} brunt_near_list;

// Boxes are finite. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_near_cells_make(brunt_near_cells *cells, const brunt_team *team, const brunt_near_box *box, int32_t count,
                          int dim, brunt_error *error);
void brunt_near_cells_free(brunt_near_cells *cells);

// Items whose box shares a point with `box` and that `wanted` takes for this query: their count, and themselves unless
// `out` is NULL, each once.
typedef bool brunt_near_wanted(const void *context, int32_t query, int32_t item);
int64_t brunt_near_find(const brunt_near_cells *cells, const brunt_near_box *box, brunt_near_wanted *wanted,
                        const void *context, int32_t query, int32_t *out);

// Of those that a list has for a query, the ones whose box shares a point with `box`: their count, and themselves
// unless `out` is NULL.
int64_t brunt_near_among(const brunt_near_list *list, const brunt_near_box *item, int dim, const brunt_near_box *box,
                         int32_t query, int32_t *out);

// Whether items may be where a box is: false is sure.
bool brunt_near_any(const brunt_near_cells *cells, const brunt_near_box *box);

// Lists of what `find` gives for each query: how many it found (out NULL), and themselves. All others but the queries
// `asked`, ascending (NULL: all are), find nothing. BRUNT_OK, or BRUNT_FAILED: out of memory.
typedef int64_t brunt_near_fn(const void *context, int32_t query, int32_t *out);
typedef struct brunt_near_queries {
    int32_t count; // in all
    const int32_t *asked;
    int32_t asked_count;
    brunt_near_fn *find;
    const void *context;
} brunt_near_queries;
int brunt_near_list_make(brunt_near_list *list, const brunt_team *team, const brunt_near_queries *queries,
                         brunt_error *error);
void brunt_near_list_free(brunt_near_list *list);
