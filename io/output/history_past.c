// What forces in the history are means over: the impulses of the lines before. None of it is saved: a run that goes on
// has it from the lines that it takes over.
#include "io/output/history_lines.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

enum { OF_A_FORCE = 3 };

static int64_t width(const brunt_history *h) { return 1 + OF_A_FORCE * (int64_t)h->force_count; }

// Transits of an element: a mesh rings behind a front with a period of pi to four of them.
static const double transits = 4;

static double window(const brunt_scene *scene, double transit) {
    return isinf(scene->output.force_window) ? transits * transit : scene->output.force_window;
}

int brunt_history_find_forces(brunt_history *h, const brunt_world *world, const brunt_scene *scene,
                              brunt_error *error) {
    const int32_t pairs = brunt_pair_count(world), walls = brunt_boundary_count(world);
    if (BRUNT_NEW(h->forces, pairs + walls, "forces of the history", error)) return BRUNT_FAILED;
    h->force_count = pairs + walls;
    for (int32_t k = 0; k < pairs + walls; k++) {
        const double transit = k < pairs ? brunt_pair_transit(world, k) : brunt_boundary_transit(world, k - pairs);
        h->forces[k].window = window(scene, transit);
        h->past.longest = fmax(h->past.longest, h->forces[k].window);
    }
    return BRUNT_OK;
}

int brunt_history_keep_past(brunt_history *h, brunt_error *error) {
    past *p = &h->past;
    const int64_t n = width(h);
    if (!(p->longest > 0)) return BRUNT_OK;
    if (p->old > p->count / 2) {
        memmove(p->line, p->line + n * p->old, sizeof *p->line * (size_t)(n * (p->count - p->old)));
        p->count -= p->old, p->old = 0;
    }
    if (p->count > p->old && p->line[n * (p->count - 1)] == h->columns[0].now) p->count--; // the same line again
    const size_t used = (size_t)(n * p->count);
    if (BRUNT_RESERVE(p->line, used + (size_t)n, used))
        return brunt_fail(error, BRUNT_FAILED, "out of memory for the impulses of %lld history lines",
                          (long long)p->count);
    double *line = p->line + used;
    const double now = *line++ = h->columns[0].now;
    for (int32_t k = 0; k < h->force_count; k++)
        for (int c = 0; c < OF_A_FORCE; c++) *line++ = h->columns[h->forces[k].impulse + c].now;
    p->count++;
    while (p->old + 1 < p->count && p->line[n * (p->old + 1)] <= now - p->longest) p->old++;
    return BRUNT_OK;
}

// The number of the last line at or before a time, of those that are kept; the first of them if there is none.
static int64_t line_before(const past *p, int64_t n, double time) {
    int64_t low = p->old, high = p->count;
    while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        if (p->line[n * middle] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Where the interval begins over which force number k is a mean [s], and the impulse by then.
static double force_from(const brunt_history *h, int32_t k, double from[3]) {
    const past *p = &h->past;
    const double last = h->columns[0].last, start = h->columns[0].now - h->forces[k].window;
    if (start >= last) {
        for (int c = 0; c < OF_A_FORCE; c++) from[c] = h->columns[h->forces[k].impulse + c].last;
        return last;
    }
    const int64_t n = width(h), i = line_before(p, n, start);
    const double *a = p->line + n * i, *b = i + 1 < p->count ? a + n : a;
    const double share = b[0] > a[0] ? fmax(0, (start - a[0]) / (b[0] - a[0])) : 0;
    const double *of_a = a + 1 + OF_A_FORCE * k, *of_b = b + 1 + OF_A_FORCE * k;
    for (int c = 0; c < OF_A_FORCE; c++) from[c] = of_a[c] + share * (of_b[c] - of_a[c]);
    return start;
}

void brunt_history_mean_force(const brunt_history *h, int32_t k, const double impulse[3], double mean[3]) {
    double from[OF_A_FORCE];
    const double interval = h->columns[0].now - force_from(h, k, from);
    for (int c = 0; c < OF_A_FORCE; c++) mean[c] = interval > 0 ? (impulse[c] - from[c]) / interval : 0;
}
