#include "contact/methods/augury_near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { RUN = 32, GRAIN = 16 };

void brunt_augury_near_free(brunt_augury_near *near) {
    brunt_free(near->found);
    brunt_free(near->order);
    brunt_free(near->node_run);
    brunt_free(near->face_run);
    *near = (brunt_augury_near){0};
}

// ------------------------------------------------------------------------------------------ bodies

// The axis along which bodies lie farthest apart.
static int sweep_axis(const brunt_contact_surface *s) {
    int best = 0;
    double widest = -1;
    for (int a = 0; a < s->dim; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < s->fem_count; k++) low = fmin(low, s->low[k][a]), high = fmax(high, s->low[k][a]);
        if (high - low > widest) widest = high - low, best = a;
    }
    return best;
}

// Bodies by their low ends. Sorted by insertion from the last step's order, which is nearly right; ties go by number,
// so that where it starts does not show.
static int sort_bodies(brunt_augury_near *near, const brunt_contact_surface *s, int axis, brunt_error *error) {
    const int32_t n = s->fem_count;
    if (near->order_count != n) {
        if (BRUNT_CAPACITY(near->order, (size_t)(n + 1), 0, "bodies in order", error)) return BRUNT_FAILED;
        for (int32_t k = 0; k < n; k++) near->order[k] = k;
        near->order_count = n;
    }
    for (int32_t k = 1; k < n; k++) {
        int32_t at = k, body = near->order[k];
        for (; at > 0; at--) {
            int32_t other = near->order[at - 1];
            double d = s->low[other][axis] - s->low[body][axis];
            if (!(d > 0 || (d == 0 && other > body))) break;
            near->order[at] = other;
        }
        near->order[at] = body;
    }
    return BRUNT_OK;
}

static int compare(const void *p, const void *q) {
    const brunt_augury_neighbours *u = p, *v = q;
    return (u->pair > v->pair) - (u->pair < v->pair);
}

int brunt_augury_near_find(brunt_augury_near *near, const brunt_contact_context *m, double margin, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    const int axis = sweep_axis(s);
    near->count = 0;
    if (sort_bodies(near, s, axis, error)) return BRUNT_FAILED;
    for (int32_t u = 0; u < near->order_count; u++) {
        const int32_t i = near->order[u];
        if (!s->active[i] || s->node_range[i + 1] == s->node_range[i]) continue;
        for (int32_t v = u + 1; v < near->order_count; v++) {
            const int32_t o = near->order[v];
            if (s->low[o][axis] > s->high[i][axis] + margin) break;
            if (!s->active[o] || s->node_range[o + 1] == s->node_range[o]) continue;
            bool apart = false;
            for (int a = 0; a < s->dim; a++)
                apart |= s->low[o][a] > s->high[i][a] + margin || s->low[i][a] > s->high[o][a] + margin;
            if (apart) continue;
            const int p = brunt_augury_body(s, i), q = brunt_augury_body(s, o);
            const int32_t pair = brunt_pair_of(m->pair_map, p, q);
            if (pair < 0 || !(m->pairs[pair].meets & BRUNT_MEET_AT_FACETS)) continue;
            size_t n = (size_t)near->count;
            if (BRUNT_CAPACITY(near->found, n + 1, n, "pairs of bodies near each other", error)) return BRUNT_FAILED;
            near->found[near->count++] = (brunt_augury_neighbours){pair, p < q ? i : o, p < q ? o : i};
        }
    }
    if (near->count > 1) qsort(near->found, (size_t)near->count, sizeof *near->found, compare);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ points

typedef struct bound_job {
    const double (*x)[3];
    const int32_t *range;
    const brunt_contact_surface *surface;
    brunt_augury_box *run;
} bound_job;

// Runs begin anew with each body, so that run r of body k is number range[k] / RUN + k + r: always enough room, and no
// table needed.
static int32_t run_of(const int32_t *range, int k) { return range[k] / RUN + k; }

static void bound_runs(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const bound_job *j = context;
    for (int k = (int)begin; k < end; k++) {
        if (!j->surface->active[k]) continue;
        brunt_augury_box *box = j->run + run_of(j->range, k);
        for (int32_t i = j->range[k]; i < j->range[k + 1]; i += RUN, box++) {
            for (int a = 0; a < 3; a++) box->low[a] = INFINITY, box->high[a] = -INFINITY;
            for (int32_t n = i; n < i + RUN && n < j->range[k + 1]; n++)
                for (int a = 0; a < 3; a++) {
                    box->low[a] = fmin(box->low[a], j->x[n][a]);
                    box->high[a] = fmax(box->high[a], j->x[n][a]);
                }
        }
    }
}

int brunt_augury_near_runs(brunt_augury_near *near, const brunt_contact_surface *s, int threads, brunt_timer *timer,
                           brunt_error *error) {
    size_t nodes = (size_t)(s->node_count / RUN + s->fem_count + 1),
           faces = (size_t)(s->face_count / RUN + s->fem_count + 1);
    if (BRUNT_CAPACITY(near->node_run, nodes, 0, "boxes about nodes", error) ||
        BRUNT_CAPACITY(near->face_run, faces, 0, "boxes about faces", error))
        return BRUNT_FAILED;
    bound_job node = {s->x, s->node_range, s, near->node_run};
    bound_job face = {s->face_centre, s->face_range, s, near->face_run};
    brunt_parallel(threads, s->fem_count, GRAIN, bound_runs, &node, timer);
    brunt_parallel(threads, s->fem_count, GRAIN, bound_runs, &face, timer);
    return BRUNT_OK;
}

static bool apart(const brunt_augury_box *u, const brunt_augury_box *v, int dim) {
    for (int a = 0; a < dim; a++)
        if (u->low[a] > v->high[a] || v->low[a] > u->high[a]) return true;
    return false;
}

int brunt_augury_near_visit(const brunt_augury_near *near, const brunt_contact_surface *s, int k, bool faces,
                            const brunt_augury_box *box, brunt_augury_visit_fn *visit, void *context) {
    const int32_t *range = faces ? s->face_range : s->node_range;
    const double(*x)[3] = faces ? s->face_centre : s->x;
    const brunt_augury_box *run = (faces ? near->face_run : near->node_run) + run_of(range, k);
    for (int32_t i = range[k]; i < range[k + 1]; i += RUN, run++) {
        if (apart(run, box, s->dim)) continue;
        for (int32_t n = i; n < i + RUN && n < range[k + 1]; n++) {
            bool inside = true;
            for (int a = 0; a < s->dim; a++) inside &= x[n][a] >= box->low[a] && x[n][a] <= box->high[a];
            int stop = inside ? visit(context, n, x[n]) : 0;
            if (stop) return stop;
        }
    }
    return 0;
}
