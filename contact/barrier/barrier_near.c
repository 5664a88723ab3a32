// What may come near while u moves by p: boxes that hold points, facets and edges on the way, and which of them meet.
#include "contact/barrier/barrier_parts.h"

enum { PARTICLE_GRAIN = 512 };
static const double ROUNDING = 1e-14; // of boxes, over the size of numbers that they are differences of

// Where a place is on its way, from the origin of the boxes.
static void swept_box(const barrier_way *w, int32_t place, brunt_near_box *box) {
    const brunt_barrier *b = w->b;
    const double *x = barrier_start(b, place);
    double from[3], by[3];
    barrier_move(b, place, w->u, from), barrier_move(b, place, w->p, by);
    for (int k = 0; k < 3; k++) {
        const double at = k < b->dim ? (x[k] - b->origin[k]) + from[k] : 0, to = at + w->part * by[k];
        box->low[k] = to < at ? to : at, box->high[k] = to > at ? to : at;
    }
}

static bool finite_box(const brunt_near_box *box) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += box->low[k] - box->low[k] + (box->high[k] - box->high[k]);
    return sum == 0;
}

static void point_box(const barrier_way *w, int32_t point, int worker) {
    brunt_near_box *box = &w->b->point_box[point];
    swept_box(w, point, box);
    if (!finite_box(box)) w->bad[worker] = true;
}

static void surface_boxes(void *context, int64_t begin, int64_t end, int worker) {
    for (int64_t i = begin; i < end; i++) point_box(context, (int32_t)i, worker);
}

// The box about some vertices' boxes, and `more` around it.
static void hull_box(const brunt_near_box *vertex, const int32_t *v, int count, double more, brunt_near_box *box) {
    *box = vertex[v[0]];
    for (int i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const double low = vertex[v[i]].low[k], high = vertex[v[i]].high[k];
            if (low < box->low[k]) box->low[k] = low;
            if (high > box->high[k]) box->high[k] = high;
        }
    for (int k = 0; k < 3; k++) box->low[k] -= more, box->high[k] += more;
}

// A box about a facet becomes one about its curve as well, wherever that is on its way.
static void hold_arc(const barrier_way *w, int32_t facet, brunt_near_box *box) {
    const brunt_barrier *b = w->b;
    const barrier_arc *arc = &b->arc[facet];
    const double more = b->source.range + w->margin;
    double at[BRUNT_CUBIC_PLACES][3], by[BRUNT_CUBIC_PLACES][3], hull[4][3], way[4][3];
    for (int i = 0; i < arc->curve.places; i++) {
        const double *x = barrier_start(b, arc->place[i]);
        barrier_move(b, arc->place[i], w->u, at[i]), barrier_move(b, arc->place[i], w->p, by[i]);
        for (int k = 0; k < 2; k++) at[i][k] += x[k] - b->origin[k];
    }
    barrier_arc_hull(arc, (const double(*)[3])at, hull), barrier_arc_hull(arc, (const double(*)[3])by, way);
    for (int p = 1; p < 3; p++) // the others are the ends
        for (int k = 0; k < 2; k++) {
            const double to = hull[p][k] + w->part * way[p][k];
            box->low[k] = fmin(box->low[k], fmin(hull[p][k], to) - more);
            box->high[k] = fmax(box->high[k], fmax(hull[p][k], to) + more);
        }
}

static void facet_boxes(void *context, int64_t begin, int64_t end, int worker) {
    const barrier_way *w = context;
    brunt_barrier *b = w->b;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        hull_box(b->point_box, b->facet[i], b->dim, b->source.range + w->margin, &b->facet_box[i]);
        if (barrier_arc_of(b, (int32_t)i)) hold_arc(w, (int32_t)i, &b->facet_box[i]);
    }
}

static void edge_boxes(void *context, int64_t begin, int64_t end, int worker) {
    const barrier_way *w = context;
    brunt_barrier *b = w->b;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        hull_box(b->point_box, b->edge[i], 2, b->source.range + w->margin, &b->edge_box[i]);
}

// Facets that a point belongs to; one on a round rim to its own, and to those beside that.
static bool belongs_to(const brunt_barrier *b, int32_t point, int32_t facet) {
    const int32_t *f = b->facet[facet];
    const barrier_rim *rim = barrier_rim_of(b, point);
    const int32_t *own = rim ? b->facet[rim->facet] : NULL;
    if (own) return f[0] == own[0] || f[0] == own[1] || f[1] == own[0] || f[1] == own[1];
    return f[0] == point || f[1] == point || f[2] == point;
}

static bool facet_wanted(const void *context, int32_t point, int32_t facet) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    const int32_t *f = b->facet[facet];
    if (belongs_to(b, point, facet)) return false;
    return barrier_bodies_meet(b, barrier_body_of(b, point), b->body[f[0]], false);
}

static int64_t facets_of(const void *context, int32_t point, int32_t *out) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    if (!(barrier_area_of(b, point) > 0)) return 0;
    return brunt_near_find(&b->facet_cells, &b->point_box[point], facet_wanted, context, point, out);
}

static int64_t facets_among(const void *context, int32_t point, int32_t *out) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    return brunt_near_among(&b->wide.facets, b->facet_box, b->dim, &b->point_box[point], point, out);
}

static bool edge_wanted(const void *context, int32_t edge, int32_t other) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    const int32_t *e = b->edge[edge], *f = b->edge[other];
    if (other <= edge || e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return false;
    return barrier_bodies_meet(b, b->body[e[0]], b->body[f[0]], true);
}

static int64_t edges_of(const void *context, int32_t edge, int32_t *out) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    brunt_near_box box; // without what the boxes of the others have already
    hull_box(b->point_box, b->edge[edge], 2, 0, &box);
    return brunt_near_find(&b->edge_cells, &box, edge_wanted, context, edge, out);
}

static int64_t edges_among(const void *context, int32_t edge, int32_t *out) {
    const brunt_barrier *b = ((const barrier_way *)context)->b;
    brunt_near_box box;
    hull_box(b->point_box, b->edge[edge], 2, 0, &box);
    return brunt_near_among(&b->wide.edges, b->edge_box, b->dim, &box, edge, out);
}

// Whether a point may come near to a plane: the nearest corner of its box, and how far the plane comes towards it.
static bool plane_is_near(const barrier_way *w, int32_t point, const brunt_near_box *box, int32_t i) {
    const brunt_barrier *b = w->b;
    const brunt_barrier_plane *plane = &b->step.planes[i];
    if (plane->meets && !plane->meets[barrier_body_of(b, point)]) return false;
    double from[3], by[3], gap = 0, comes = 0;
    barrier_move(b, barrier_points(b) + i, w->u, from), barrier_move(b, barrier_points(b) + i, w->p, by);
    for (int k = 0; k < b->dim; k++) {
        const double n = plane->normal[k], corner = n > 0 ? box->low[k] : box->high[k];
        gap += n * (corner - (plane->origin[k] - b->origin[k]) - from[k]);
        comes += n * w->part * by[k];
    }
    return !(gap - fmax(comes, 0) > plane->distance + b->touch + barrier_plane_offset(b, plane, point) + w->margin);
}

static int64_t planes_of(const void *context, int32_t point, int32_t *out) {
    const barrier_way *w = context;
    const brunt_barrier *b = w->b;
    int64_t found = 0;
    if (!(barrier_area_of(b, point) > 0)) return 0;
    for (int32_t i = 0; i < b->step.plane_count; i++) {
        if (!plane_is_near(w, point, &b->point_box[point], i)) continue;
        if (out) out[found] = i;
        found++;
    }
    return found;
}

// Whether a material point is beyond all facets, and there are no planes: what most of them are is told at once.
static bool is_beyond(const barrier_way *w, const double *x) {
    const brunt_barrier *b = w->b;
    const brunt_near_cells *c = &b->facet_cells;
    bool beyond = b->facet_count == 0;
    for (int k = 0; k < b->dim && !beyond; k++) {
        const double at = x[k] - b->origin[k];
        beyond = at + w->reach[k] < c->low[k] || at - w->reach[k] > c->high[k];
    }
    return beyond && !b->step.plane_count;
}

// Boxes of material points that are not far from everything already by where all of them may go.
static void particle_boxes(void *context, int64_t begin, int64_t end, int worker) {
    const barrier_way *w = context;
    brunt_barrier *b = w->b;
    for (int64_t i = begin; i < end; i++) {
        const int32_t point = barrier_surface_points(b) + (int32_t)i;
        const double *x = b->step.particles.x[i];
        brunt_near_box box = {{0}, {0}};
        b->far[i] = is_beyond(w, x);
        if (b->far[i]) continue;
        for (int k = 0; k < b->dim; k++)
            box.low[k] = x[k] - b->origin[k] - w->reach[k], box.high[k] = x[k] - b->origin[k] + w->reach[k];
        bool near = !finite_box(&box) || brunt_near_any(&b->facet_cells, &box);
        for (int32_t k = 0; k < b->step.plane_count && !near; k++) near = plane_is_near(w, point, &box, k);
        b->far[i] = !near;
        if (near) point_box(w, point, worker);
    }
}

// Points of surfaces, and material points that are not far.
static void list_asked(brunt_barrier *b) {
    b->asked_count = 0;
    for (int32_t i = 0; i < barrier_surface_points(b); i++) b->asked[b->asked_count++] = i;
    for (int32_t i = 0; i < b->step.particles.count; i++)
        if (!b->far[i]) b->asked[b->asked_count++] = barrier_surface_points(b) + i;
}

// How large numbers are that boxes of vertices are differences of.
static double size_of_vertices(const brunt_barrier *b) {
    double most = 0;
    for (int32_t i = 0; i < b->vertex_count; i++) {
        const double *x = barrier_start(b, i);
        for (int k = 0; k < b->dim; k++)
            most = fmax(most, fabs(x[k]) + fmax(fabs(b->point_box[i].low[k]), fabs(b->point_box[i].high[k])));
    }
    return most;
}

static int check_boxes(const barrier_way *w, brunt_error *error) {
    for (int i = 0; i < BRUNT_THREAD_LIMIT; i++)
        if (w->bad[i]) return brunt_fail(error, BRUNT_FAILED, "a point of contact is at a place that is not a number");
    return BRUNT_OK;
}

// Of what has surfaces first: those say which material points are far from them.
static int make_boxes(barrier_way *w, const brunt_team *team, brunt_error *error) {
    brunt_barrier *b = w->b;
    for (int k = 0; k < 3; k++) b->origin[k] = barrier_points(b) ? barrier_start(b, 0)[k] : 0;
    brunt_parallel(team->threads, barrier_surface_points(b), BARRIER_GRAIN, surface_boxes, w, team->timer);
    if (check_boxes(w, error)) return BRUNT_FAILED;
    w->margin = ROUNDING * fmax(size_of_vertices(b), barrier_take_reach(w, team));
    brunt_parallel(team->threads, b->facet_count, BARRIER_GRAIN, facet_boxes, w, team->timer);
    brunt_parallel(team->threads, b->edge_count, BARRIER_GRAIN, edge_boxes, w, team->timer);
    if (b->step.particles.count == 0)
        return barrier_wide_holds(b) || !barrier_wide_make(b, team, error) ? BRUNT_OK : BRUNT_FAILED;
    if (brunt_near_cells_make(&b->facet_cells, team, b->facet_box, b->facet_count, b->dim, error) ||
        brunt_near_cells_make(&b->edge_cells, team, b->edge_box, b->edge_count, b->dim, error))
        return BRUNT_FAILED;
    brunt_parallel(team->threads, b->step.particles.count, PARTICLE_GRAIN, particle_boxes, w, team->timer);
    return check_boxes(w, error);
}

// What is near with room to spare, unless it is known.
static int make_wide_lists(barrier_way *w, const brunt_team *team, brunt_error *error) {
    brunt_barrier *b = w->b;
    const brunt_near_queries facets = {.count = barrier_points(b), .find = facets_of, .context = w},
                             edges = {.count = b->edge_count, .find = edges_of, .context = w};
    if (b->wide.known) return BRUNT_OK;
    b->wide.known = !brunt_near_list_make(&b->wide.facets, team, &facets, error) &&
                    !brunt_near_list_make(&b->wide.edges, team, &edges, error);
    return b->wide.known ? BRUNT_OK : BRUNT_FAILED;
}

static int make_lists(barrier_way *w, const brunt_team *team, brunt_error *error) {
    brunt_barrier *b = w->b;
    const bool wide = b->step.particles.count == 0;
    list_asked(b);
    if (wide && make_wide_lists(w, team, error)) return BRUNT_FAILED;
    const int32_t points = barrier_points(b), at_facets = b->facet_count ? b->asked_count : 0,
                  at_planes = b->step.plane_count ? b->asked_count : 0;
    const brunt_near_queries facets = {points, b->asked, at_facets, wide ? facets_among : facets_of, w},
                             planes = {points, b->asked, at_planes, planes_of, w},
                             edges = {.count = b->edge_count, .find = wide ? edges_among : edges_of, .context = w};
    return brunt_near_list_make(&b->facets, team, &facets, error) ||
                   brunt_near_list_make(&b->planes, team, &planes, error) ||
                   brunt_near_list_make(&b->edges, team, &edges, error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// Points and edges that are near something; room for the threads, for as much as one of them is near.
static int make_tasks(brunt_barrier *b, int threads, brunt_error *error) {
    const size_t most = (size_t)barrier_points(b) + (size_t)b->edge_count + 1;
    int64_t longest = 0;
    if (BRUNT_CAPACITY(b->task, most, 0, "points and edges that may be in contact", error)) return BRUNT_FAILED;
    b->task_count = 0;
    for (int32_t k = 0; k < b->asked_count; k++) {
        const int32_t i = b->asked[k];
        const int64_t near = b->facets.first[i + 1] - b->facets.first[i];
        if (near > longest) longest = near;
        if (near || b->planes.first[i + 1] > b->planes.first[i]) b->task[b->task_count++] = i;
    }
    for (int32_t i = 0; i < b->edge_count; i++)
        if (b->edges.first[i + 1] > b->edges.first[i]) b->task[b->task_count++] = -1 - i;
    if (BRUNT_CAPACITY(b->task_energy, (size_t)b->task_count + 1, 0, "points and edges near something", error) ||
        BRUNT_CAPACITY(b->task_first, (size_t)b->task_count + 1, 0, "points and edges near something", error) ||
        BRUNT_CAPACITY(b->task_place, (size_t)b->task_count + 1, 0, "points and edges near something", error) ||
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

int barrier_find_near(brunt_barrier *b, const brunt_team *team, const double *u, const double *p, double part,
                      brunt_error *error) {
    bool bad[BRUNT_THREAD_LIMIT] = {false};
    barrier_way work = {.b = b, .u = u, .p = p, .part = part, .bad = bad};
    const size_t points = (size_t)barrier_points(b) + 1;
    b->here_count = 0;
    if (BRUNT_CAPACITY(b->point_box, points, 0, "boxes about points", error) ||
        BRUNT_CAPACITY(b->far, (size_t)b->step.particles.count + 1, 0, "points in contact", error) ||
        BRUNT_CAPACITY(b->asked, points, 0, "points in contact", error) ||
        BRUNT_CAPACITY(b->facet_box, (size_t)b->facet_count + 1, 0, "boxes about facets", error) ||
        BRUNT_CAPACITY(b->edge_box, (size_t)b->edge_count + 1, 0, "boxes about edges", error))
        return BRUNT_FAILED;
    const int code = make_boxes(&work, team, error);
    if (code) return code;
    if (make_lists(&work, team, error) || make_tasks(b, team->threads, error) || barrier_find_pairs(b, error))
        return BRUNT_FAILED;
    b->swept = p != NULL, b->known = true, b->part = part;
    return BRUNT_OK;
}
