#include "base/sweep.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/memory.h"

typedef struct start {
    double low;
    int32_t box;
} start;

static int compare_starts(const void *left, const void *right) {
    const start *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    return (a->box > b->box) - (a->box < b->box);
}

static int compare_pairs(const void *left, const void *right) {
    const brunt_box_pair *a = left, *b = right;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return (a->b > b->b) - (a->b < b->b);
}

static bool share(const brunt_box *a, const brunt_box *b) {
    for (int k = 0; k < 3; k++)
        if (!(a->low[k] <= b->high[k] && b->low[k] <= a->high[k])) return false;
    return true;
}

void brunt_spread_add(brunt_spread *spread, const double x[3]) {
    for (int k = 0; k < 3; k++)
        if (!isfinite(x[k])) return;
    if (!spread->count++)
        for (int k = 0; k < 3; k++) spread->from[k] = x[k];
    for (int k = 0; k < 3; k++) {
        const double d = x[k] - spread->from[k];
        spread->sum[k] += d, spread->square[k] += d * d;
    }
}

int brunt_spread_axis(const brunt_spread *spread) {
    double most = 0;
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        const double variance = (double)spread->count * spread->square[k] - spread->sum[k] * spread->sum[k];
        if (variance > most) most = variance, axis = k;
    }
    return axis;
}

static int widest_axis(const brunt_box *boxes, int32_t count) {
    brunt_spread spread = {.count = 0};
    for (int32_t i = 0; i < count; i++) brunt_spread_add(&spread, boxes[i].low);
    return brunt_spread_axis(&spread);
}

int brunt_sweep(const brunt_box *boxes, int32_t first, int32_t count, brunt_box_pair **pairs, int64_t *found,
                brunt_error *error) {
    start *order;
    brunt_box_pair *list = NULL;
    size_t capacity = 0, pair = 0;
    *pairs = NULL, *found = 0;
    if (BRUNT_NEW(order, count + 1, "boxes in order", error)) return BRUNT_FAILED;
    const int axis = widest_axis(boxes, count);
    for (int32_t i = 0; i < count; i++) order[i] = (start){boxes[i].low[axis], i};
    qsort(order, (size_t)count, sizeof *order, compare_starts);
    bool failed = false;
    for (int32_t i = 0; i < count && !failed; i++)
        for (int32_t k = i + 1; k < count && !failed && order[k].low <= boxes[order[i].box].high[axis]; k++) {
            const int32_t p = order[i].box, q = order[k].box;
            if ((p >= first && q >= first) || !share(&boxes[p], &boxes[q])) continue;
            failed = BRUNT_CAPACITY_IN(list, capacity, pair + 1, pair, "pairs of boxes that share something", error);
            if (!failed) list[pair++] = p < q ? (brunt_box_pair){p, q} : (brunt_box_pair){q, p};
        }
    brunt_free(order);
    *pairs = list, *found = (int64_t)pair;
    if (pair) qsort(list, pair, sizeof *list, compare_pairs);
    return failed ? BRUNT_FAILED : BRUNT_OK;
}
