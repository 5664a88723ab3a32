// What may come near while u moves by p: boxes that hold points, facets and edges on the way, and which of them meet.
#include "contact/barrier/barrier_parts.h"

typedef struct near_work {
    brunt_barrier *b;
    const double *u, *p;
    double margin; // [m] more than the distances: rounding of boxes
    bool *bad;     // of each worker: something is not a number
} near_work;

// Where a place is on its way, from the origin of the boxes.
static void swept_box(const near_work *w, int32_t place, brunt_near_box *box) {
    const brunt_barrier *b = w->b;
    const double *x = barrier_start(b, place);
    double from[3], by[3];
    barrier_move(b, place, w->u, from), barrier_move(b, place, w->p, by);
    for (int k = 0; k < 3; k++) {
        const double at = k < b->dim ? (x[k] - b->origin[k]) + from[k] : 0;
        box->low[k] = fmin(at, at + by[k]), box->high[k] = fmax(at, at + by[k]);
    }
}

static bool finite_box(const brunt_near_box *box) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += box->low[k] - box->low[k] + (box->high[k] - box->high[k]);
    return sum == 0;
}

static void point_boxes(void *context, int64_t begin, int64_t end, int worker) {
    near_work *w = context;
    for (int64_t i = begin; i < end; i++) {
        brunt_near_box *box = &w->b->point_box[i];
        swept_box(w, (int32_t)i, box);
        if (!finite_box(box)) w->bad[worker] = true;
    }
}

// The box about some vertices' boxes, and `more` around it.
static void hull_box(const brunt_near_box *vertex, const int32_t *v, int count, double more, brunt_near_box *box) {
    *box = vertex[v[0]];
    for (int i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            box->low[k] = fmin(box->low[k], vertex[v[i]].low[k]);
            box->high[k] = fmax(box->high[k], vertex[v[i]].high[k]);
        }
    for (int k = 0; k < 3; k++) box->low[k] -= more, box->high[k] += more;
}

static void facet_boxes(void *context, int64_t begin, int64_t end, int worker) {
    near_work *w = context;
    brunt_barrier *b = w->b;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        hull_box(b->point_box, b->facet[i], b->dim, b->source.range + w->margin, &b->facet_box[i]);
}

static void edge_boxes(void *context, int64_t begin, int64_t end, int worker) {
    near_work *w = context;
    brunt_barrier *b = w->b;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        hull_box(b->point_box, b->edge[i], 2, b->source.range + w->margin, &b->edge_box[i]);
}

static bool facet_wanted(const void *context, int32_t point, int32_t facet) {
    const brunt_barrier *b = ((const near_work *)context)->b;
    const int32_t *f = b->facet[facet];
    if (f[0] == point || f[1] == point || f[2] == point) return false;
    return barrier_bodies_meet(b, barrier_body_of(b, point), b->body[f[0]], false);
}

static int64_t facets_of(const void *context, int32_t point, int32_t *out) {
    const brunt_barrier *b = ((const near_work *)context)->b;
    if (!(barrier_area_of(b, point) > 0)) return 0;
    return brunt_near_find(&b->facet_cells, &b->point_box[point], facet_wanted, context, point, out);
}

static bool edge_wanted(const void *context, int32_t edge, int32_t other) {
    const brunt_barrier *b = ((const near_work *)context)->b;
    const int32_t *e = b->edge[edge], *f = b->edge[other];
    if (other <= edge || e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return false;
    return barrier_bodies_meet(b, b->body[e[0]], b->body[f[0]], true);
}

static int64_t edges_of(const void *context, int32_t edge, int32_t *out) {
    const brunt_barrier *b = ((const near_work *)context)->b;
    brunt_near_box box; // without what the boxes of the others have already
    hull_box(b->point_box, b->edge[edge], 2, 0, &box);
    return brunt_near_find(&b->edge_cells, &box, edge_wanted, context, edge, out);
}

// Planes that a point may come near to: the nearest corner of its box, and how far the plane comes towards it.
static int64_t planes_of(const void *context, int32_t point, int32_t *out) {
    const near_work *w = context;
    const brunt_barrier *b = w->b;
    const brunt_near_box *box = &b->point_box[point];
    int64_t found = 0;
    if (!(barrier_area_of(b, point) > 0)) return 0;
    for (int32_t i = 0; i < b->step.plane_count; i++) {
        const brunt_barrier_plane *plane = &b->step.planes[i];
        if (plane->meets && !plane->meets[barrier_body_of(b, point)]) continue;
        double from[3], by[3], gap = 0, comes = 0;
        barrier_move(b, barrier_points(b) + i, w->u, from), barrier_move(b, barrier_points(b) + i, w->p, by);
        for (int k = 0; k < b->dim; k++) {
            const double n = plane->normal[k], corner = n > 0 ? box->low[k] : box->high[k];
            gap += n * (corner - (plane->origin[k] - b->origin[k]) - from[k]);
            comes += n * by[k];
        }
        if (gap - fmax(comes, 0) > plane->distance + barrier_plane_offset(b, plane, point) + w->margin) continue;
        if (out) out[found] = i;
        found++;
    }
    return found;
}

// How large numbers are that boxes are differences of, times some rounding.
static double rounding_of(const brunt_barrier *b, int32_t points) {
    double most = 0;
    for (int32_t i = 0; i < points; i++) {
        const double *x = barrier_start(b, i);
        for (int k = 0; k < b->dim; k++)
            most = fmax(most, fabs(x[k]) + fmax(fabs(b->point_box[i].low[k]), fabs(b->point_box[i].high[k])));
    }
    return 1e-14 * most;
}

static int make_boxes(near_work *w, const brunt_team *team, brunt_error *error) {
    brunt_barrier *b = w->b;
    const int32_t points = barrier_points(b);
    bool bad[BRUNT_THREAD_LIMIT] = {false};
    w->bad = bad;
    for (int k = 0; k < 3; k++) b->origin[k] = points ? barrier_start(b, 0)[k] : 0;
    brunt_parallel(team->threads, points, BARRIER_GRAIN, point_boxes, w, team->timer);
    w->bad = NULL;
    for (int i = 0; i < BRUNT_THREAD_LIMIT; i++)
        if (bad[i]) return brunt_fail(error, BRUNT_FAILED, "a point of contact is at a place that is not a number");
    w->margin = rounding_of(b, points);
    brunt_parallel(team->threads, b->facet_count, BARRIER_GRAIN, facet_boxes, w, team->timer);
    brunt_parallel(team->threads, b->edge_count, BARRIER_GRAIN, edge_boxes, w, team->timer);
    return BRUNT_OK;
}

static int make_lists(near_work *w, const brunt_team *team, brunt_error *error) {
    brunt_barrier *b = w->b;
    if (brunt_near_cells_make(&b->facet_cells, b->facet_box, b->facet_count, b->dim, error) ||
        brunt_near_cells_make(&b->edge_cells, b->edge_box, b->edge_count, b->dim, error))
        return BRUNT_FAILED;
    return brunt_near_list_make(&b->facets, team, barrier_points(b), facets_of, w, error) ||
                   brunt_near_list_make(&b->planes, team, barrier_points(b), planes_of, w, error) ||
                   brunt_near_list_make(&b->edges, team, b->edge_count, edges_of, w, error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// Points and edges that are near something; room for the threads, for as much as one of them is near.
static int make_tasks(brunt_barrier *b, int threads, brunt_error *error) {
    const int32_t points = barrier_points(b);
    const size_t most = (size_t)points + (size_t)b->edge_count + 1;
    int64_t longest = 0;
    if (BRUNT_CAPACITY(b->task, most, 0, "points and edges that may be in contact", error)) return BRUNT_FAILED;
    b->task_count = 0;
    for (int32_t i = 0; i < points; i++) {
        const int64_t near = b->facets.first[i + 1] - b->facets.first[i];
        if (near > longest) longest = near;
        if (near || b->planes.first[i + 1] > b->planes.first[i]) b->task[b->task_count++] = i;
    }
    for (int32_t i = 0; i < b->edge_count; i++)
        if (b->edges.first[i + 1] > b->edges.first[i]) b->task[b->task_count++] = -1 - i;
    if (BRUNT_CAPACITY(b->task_energy, (size_t)b->task_count + 1, 0, "points and edges near something", error) ||
        BRUNT_CAPACITY(b->task_first, (size_t)b->task_count + 1, 0, "points and edges near something", error) ||
        BRUNT_CAPACITY(b->workspace, (size_t)threads, (size_t)b->workspace_count, "threads that look for contact",
                       error))
        return BRUNT_FAILED;
    if (b->workspace_count < threads) b->workspace_count = threads;
    for (int i = 0; i < threads; i++) {
        barrier_workspace *r = &b->workspace[i];
        if (BRUNT_CAPACITY(r->feature, 7 * (size_t)longest + 1, 0, "features near a point", error) ||
            BRUNT_CAPACITY(r->edge, 3 * (size_t)longest + 1, 0, "edges near a point", error) ||
            BRUNT_CAPACITY(r->vertex, 3 * (size_t)longest + 1, 0, "vertices near a point", error))
            return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

int barrier_find_near(brunt_barrier *b, const brunt_team *team, const double *u, const double *p, brunt_error *error) {
    near_work work = {.b = b, .u = u, .p = p};
    const size_t points = (size_t)barrier_points(b) + 1;
    if (BRUNT_CAPACITY(b->point_box, points, 0, "boxes about points", error) ||
        BRUNT_CAPACITY(b->facet_box, (size_t)b->facet_count + 1, 0, "boxes about facets", error) ||
        BRUNT_CAPACITY(b->edge_box, (size_t)b->edge_count + 1, 0, "boxes about edges", error))
        return BRUNT_FAILED;
    const int code = make_boxes(&work, team, error);
    if (code) return code;
    if (make_lists(&work, team, error) || make_tasks(b, team->threads, error) || barrier_find_pairs(b, error))
        return BRUNT_FAILED;
    b->swept = p != NULL;
    return BRUNT_OK;
}
