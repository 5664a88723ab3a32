// How far a step may go before some gap is a tenth of what it was. Places move along straight lines; two convex
// features are at least as far apart as along any one direction, so the way to the first touch is taken in parts, each
// as long as the gap along the present normal allows (additive continuous collision detection, Li, Kaufman and Jiang
// 2021, with the velocities along the normal for their greatest speed: what slides along a surface is done in one
// part). Each part is a bound from below: no gap is stepped over, however fast things are. What rounding may take from
// a gap is counted as taken.
#include "contact/barrier/barrier_parts.h"

#include <float.h>

static const double LEFT = 0.1, CLOSE = 1.05; // of the gap; of what is to be left: near enough
static const double ROUNDING = 4 * DBL_EPSILON;
enum { PARTS = 500 };

typedef struct moving_pair {
    double x[4][3], v[4][3]; // [m] places, and what they move by
    int first, count;        // places of the first feature; of both
    double rounding;         // [m]
    double distance, offset; // [m] dhat; what of the distance is no gap
    double reach;            // [m] as of a pair
} moving_pair;

typedef struct limit_work {
    const brunt_barrier *b;
    const double *u, *p;
    double largest;
    double way;    // [m] p takes no point farther along what it may overlap; INFINITY: it is not known
    double *least; // of each worker
} limit_work;

static moving_pair pair_of(const limit_work *w, const int32_t *place, int first, int count) {
    moving_pair m = {.first = first, .count = count};
    double most = 0;
    barrier_relative(w->b, w->u, place[0], place, count, m.x);
    double base[3];
    barrier_move(w->b, place[0], w->p, base);
    for (int i = 0; i < count; i++) {
        const double *x = barrier_start(w->b, place[i]);
        double from[3];
        barrier_move(w->b, place[i], w->p, m.v[i]), barrier_move(w->b, place[i], w->u, from);
        for (int k = 0; k < w->b->dim; k++) {
            most = fmax(most, fabs(x[k]) + fabs(from[k]) + fabs(m.v[i][k]) * w->largest);
            m.v[i][k] -= base[k];
        }
    }
    m.rounding = ROUNDING * most;
    return m;
}

// Distance and normal at t, from the other feature to the first.
static double distance_at(const moving_pair *m, double t, double n[3]) {
    double y[4][3], d;
    brunt_closest c;
    const double(*z)[3] = (const double(*)[3])y;
    for (int i = 0; i < m->count; i++)
        for (int k = 0; k < 3; k++) y[i][k] = m->x[i][k] + t * m->v[i][k];
    if (m->first == 2) {
        brunt_closest_edges(z, z + 2, &c);
    } else {
        const int region =
            m->count == 4 ? brunt_closest_of_triangle(y[0], z + 1, &d) : brunt_closest_of_edge(y[0], y[1], y[2], &d);
        int v[3] = {0}, count = 0;
        for (int i = 0; i < 3; i++)
            if (region >> i & 1) v[count++] = 1 + i;
        if (count == 3)
            brunt_closest_plane(y[0], z + 1, &c);
        else if (count == 2)
            brunt_closest_line(y[0], y[v[0]], y[v[1]], &c);
        else
            brunt_closest_points(y[0], y[v[0]], &c);
    }
    memcpy(n, c.n, sizeof c.n);
    return c.d;
}

// How long, from t on, all places stay `left` apart along n.
static double part_of(const moving_pair *m, double t, double left, const double n[3]) {
    double part = INFINITY;
    for (int i = 0; i < m->first; i++)
        for (int j = m->first; j < m->count; j++) {
            double gap = -m->rounding - left, closing = 0;
            for (int k = 0; k < 3; k++) {
                const double v = m->v[i][k] - m->v[j][k];
                gap += n[k] * (m->x[i][k] - m->x[j][k] + t * v), closing -= n[k] * v;
            }
            if (closing > 0) part = fmin(part, fmax(gap, 0) / closing);
        }
    return part;
}

// The greatest way of the first feature along the other.
static double way_of(const moving_pair *m) {
    double most = 0;
    for (int i = 0; i < m->first; i++)
        for (int j = m->first; j < m->count; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) square += (m->v[i][k] - m->v[j][k]) * (m->v[i][k] - m->v[j][k]);
            most = fmax(most, square);
        }
    return sqrt(most);
}

static double pair_limit(const moving_pair *m, double largest) {
    double n[3], t = 0, d = distance_at(m, 0, n);
    if (m->reach > 0) return barrier_overlap_limit(d - m->offset, m->reach, way_of(m), largest);
    const double left = LEFT * fmin(d - m->offset, m->distance);
    for (int i = 0; i < PARTS; i++) {
        const double part = part_of(m, t, left + m->offset, n);
        if (!(t + part < largest)) return largest;
        t += part;
        if (part == 0) break;
        d = distance_at(m, t, n);
        if (d - m->offset <= CLOSE * left) break;
    }
    return t;
}

static double plane_limit(const limit_work *w, int32_t point, int32_t k, double largest) {
    const brunt_barrier_plane *plane = &w->b->step.planes[k];
    const int32_t place[2] = {point, barrier_points(w->b) + k};
    const moving_pair m = pair_of(w, place, 1, 2);
    const double offset = barrier_plane_offset(w->b, plane, point);
    double gap = -offset;
    for (int j = 0; j < 3; j++) gap -= plane->normal[j] * m.x[1][j];
    double left = LEFT * fmin(gap, plane->distance) + offset;
    if (plane->reach > 0) left = fmin(gap, 0) - plane->reach / 2 + offset;
    const double part = part_of(&m, 0, left, plane->normal);
    return fmin(part, largest);
}

static void apart(const brunt_barrier *b, int32_t law, moving_pair *m) {
    const brunt_barrier_pair *pair = barrier_pair_of(b, law);
    m->distance = pair->distance, m->offset = pair->offset, m->reach = pair->reach;
}

// Of a curve, which may be overlapped: no place of it moves farther than those that hold it between them.
static double arc_limit(const limit_work *w, int32_t point, const barrier_arc *arc, const brunt_barrier_pair *pair,
                        double largest) {
    static const double here[3] = {0};
    double x[BRUNT_CUBIC_PLACES][3], v[BRUNT_CUBIC_PLACES][3], hull[4][3], own[3], s, d, way = 0;
    barrier_relative(w->b, w->u, point, arc->place, arc->curve.places, x);
    brunt_closest_of_cubic(here, (const double(*)[3])x, &arc->curve, &s, &d);
    barrier_move(w->b, point, w->p, own);
    for (int i = 0; i < BRUNT_CUBIC_PLACES; i++) // of more than there are vertex 0, which has no weight
        barrier_move(w->b, arc->place[i], w->p, v[i]);
    barrier_arc_hull(arc, (const double(*)[3])v, hull);
    for (int i = 0; i < 4; i++) way = fmax(way, hypot(hull[i][0] - own[0], hull[i][1] - own[1]));
    return barrier_overlap_limit(d - pair->offset, pair->reach, way, largest);
}

// Whether no gap may bound the step of a pair: as barrier_overlap_limit.
static bool is_free(const limit_work *w, int32_t law, double largest) {
    return barrier_overlap_limit(0, barrier_pair_of(w->b, law)->reach, w->way, largest) >= largest;
}

static double point_limit(const limit_work *w, int32_t point, double largest) {
    const brunt_barrier *b = w->b;
    const int32_t body = barrier_body_of(b, point);
    int32_t other = BRUNT_NONE, law = BRUNT_NONE;
    int8_t side;
    for (int64_t i = b->facets.first[point]; i < b->facets.first[point + 1]; i++) {
        const int32_t *f = b->facet[b->facets.item[i]], place[4] = {point, f[0], f[1], f[2]};
        const barrier_arc *arc = barrier_arc_of(b, b->facets.item[i]);
        if (b->body[f[0]] != other) other = b->body[f[0]], law = barrier_law_between(b, body, other, &side);
        if (is_free(w, law, largest)) continue;
        if (arc) {
            largest = arc_limit(w, point, arc, barrier_pair_of(b, law), largest);
            continue;
        }
        moving_pair m = pair_of(w, place, 1, 1 + b->dim);
        apart(b, law, &m);
        largest = pair_limit(&m, largest);
    }
    for (int64_t i = b->planes.first[point]; i < b->planes.first[point + 1]; i++)
        largest = plane_limit(w, point, b->planes.item[i], largest);
    return largest;
}

static double edge_limit(const limit_work *w, int32_t edge, double largest) {
    const brunt_barrier *b = w->b;
    const int32_t *e = b->edge[edge];
    int8_t side;
    for (int64_t i = b->edges.first[edge]; i < b->edges.first[edge + 1]; i++) {
        const int32_t *f = b->edge[b->edges.item[i]], place[4] = {e[0], e[1], f[0], f[1]};
        moving_pair m = pair_of(w, place, 2, 4);
        apart(b, barrier_law_between(b, b->body[e[0]], b->body[f[0]], &side), &m);
        largest = pair_limit(&m, largest);
    }
    return largest;
}

static void limit_task(void *context, int64_t begin, int64_t end, int worker) {
    limit_work *w = context;
    for (int64_t i = begin; i < end; i++) {
        const int32_t point = w->b->task[i];
        w->least[worker] =
            point < 0 ? edge_limit(w, -1 - point, w->least[worker]) : point_limit(w, point, w->least[worker]);
    }
}

// The least of all, whichever thread has it: what one has found only spares the others' work.
double barrier_limit(const brunt_barrier *b, const brunt_team *team, const double *u, const double *p, double largest) {
    double least[BRUNT_THREAD_LIMIT], all = largest;
    limit_work work = {b, u, p, largest, b->overlaps ? barrier_clear_way(b, p) : INFINITY, least};
    for (int i = 0; i < BRUNT_THREAD_LIMIT; i++) least[i] = largest;
    brunt_parallel(team->threads, b->task_count, BARRIER_TASK_GRAIN, limit_task, &work, team->timer);
    for (int i = 0; i < BRUNT_THREAD_LIMIT; i++) all = fmin(all, least[i]);
    return all;
}
