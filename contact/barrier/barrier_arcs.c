// Round rims (contact.surface: arcs), in two dimensions: a curve through the vertices of a rim in place of its edges,
// and points on it.
//
// A curve is a cubic between the two ends of an edge (Hermite's). At a vertex its tangent is that of the circle through
// the vertex and its two neighbours as they are in the reference configuration, (l2 / l1) e1 + (l1 / l2) e2 of the
// edges e1 and e2 that meet there, of length l / cos^2(alpha / 2) with alpha between tangent and edge: the height over
// the middle of the edge is that of the arc then. A circle of n edges is met to 1.2e-3 (pi / n)^6 of its radius, in
// place of (pi / n)^2 / 2, and its rim has no corners. All is linear in the places of the vertices, with constant
// weights: whatever moves, turns or stretches a body does so to its curve, and forces on points of it are those on
// vertices by the weights. Where a rim is pressed flat its curve is flat.
//
// Edges that meet at more than 30 degrees, or one of which is more than twice as long as the other, meet in a corner.
// What has a corner at one end is a parabola from the other; at both, or without a turn, it stays straight.
#include "contact/barrier/barrier_parts.h"

static const double CORNER = 0.5235987755982988 + 1e-9; // 30 degrees
static const double LONGER = 2 + 1e-9;
static const double STRAIGHT = 1e-9; // a turn less than that is none

typedef struct rim_maker {
    brunt_barrier *b;
    const double (*x)[3]; // of vertices in the reference configuration
    int32_t (*next)[2];   // vertices beside each
    int8_t *edges;        // that meet at each
} rim_maker;

// At the end v of the edge from v to w, away from v.
typedef struct rim_tangent {
    bool smooth, turns;
    int32_t before;               // the vertex on the other side of v
    double of_w, of_v, of_before; // weights of their places
} rim_tangent;

static void minus(const double a[3], const double b[3], double out[2]) { out[0] = a[0] - b[0], out[1] = a[1] - b[1]; }

static rim_tangent tangent_at(const rim_maker *m, int32_t v, int32_t w) {
    rim_tangent of = {.before = BRUNT_NONE};
    double e1[2], e2[2], t[2];
    if (m->edges[v] != 2) return of;
    of.before = m->next[v][m->next[v][0] == w];
    minus(m->x[v], m->x[of.before], e1), minus(m->x[w], m->x[v], e2);
    const double l1 = hypot(e1[0], e1[1]), l2 = hypot(e2[0], e2[1]), ratio = l2 / l1;
    const double turn = fabs(atan2(e1[0] * e2[1] - e1[1] * e2[0], e1[0] * e2[0] + e1[1] * e2[1]));
    of.smooth = turn <= CORNER && ratio <= LONGER && ratio * LONGER >= 1, of.turns = of.smooth && turn > STRAIGHT;
    for (int a = 0; a < 2; a++) t[a] = ratio * e1[a] + e2[a] / ratio;
    const double size = hypot(t[0], t[1]), cosine = (t[0] * e2[0] + t[1] * e2[1]) / (size * l2);
    const double length = 2 * l2 / (1 + cosine) / size; // 2 cos^2(alpha / 2) = 1 + cos(alpha)
    of.of_w = length / ratio, of.of_v = length * (ratio - 1 / ratio), of.of_before = -length * ratio;
    return of;
}

// Of a curve that turns at one end at least: Hermite's cubic, (1 - 3 s^2 + 2 s^3) x0 + (3 s^2 - 2 s^3) x1 +
// (s - 2 s^2 + s^3) t0 - (s^2 - s^3) t1.
static void make_curve(barrier_arc *arc, const rim_tangent of[2]) {
    static const double polynomial[2][4] = {{0, 1, -2, 1}, {0, 0, -1, 1}};
    double t[2][BRUNT_CUBIC_PLACES] = {{0}};
    arc->curve = (brunt_cubic){2, {{1, 0, -3, 2}, {0, 0, 3, -2}}};
    for (int end = 0; end < 2; end++) {
        if (!of[end].smooth) continue;
        const int sign = end ? -1 : 1, at = arc->curve.places++; // both look from the first vertex to the second
        arc->place[at] = of[end].before;
        t[end][!end] = sign * of[end].of_w, t[end][end] = sign * of[end].of_v, t[end][at] = sign * of[end].of_before;
    }
    for (int end = 0; end < 2; end++) { // a parabola's t0 + t1 = 2 (x1 - x0)
        if (of[end].smooth) continue;
        for (int i = 0; i < arc->curve.places; i++) t[end][i] = -t[!end][i];
        t[end][0] -= 2, t[end][1] += 2;
    }
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < arc->curve.places; i++)
            for (int k = 0; k < 4; k++) arc->curve.weight[i][k] += t[end][i] * polynomial[end][k];
}

static void make_arc(const rim_maker *m, int32_t facet) {
    brunt_barrier *b = m->b;
    barrier_arc *arc = &b->arc[facet];
    const int32_t *f = b->facet[facet];
    const rim_tangent of[2] = {tangent_at(m, f[0], f[1]), tangent_at(m, f[1], f[0])};
    *arc = (barrier_arc){.curve = {2, {{1, -1}, {0, 1}}}, .place = {f[0], f[1]}};
    if (!of[0].turns && !of[1].turns) return;
    make_curve(arc, of);
    for (int end = 0; end < 2; end++)
        if (of[end].smooth) b->joint[f[end]] = facet;
}

static int list_neighbours(rim_maker *m, brunt_error *error) {
    const brunt_barrier *b = m->b;
    const size_t n = (size_t)b->vertex_count + 1;
    if (BRUNT_NEW(m->next, n, "rims of bodies", error) || BRUNT_NEW(m->edges, n, "rims of bodies", error))
        return BRUNT_FAILED;
    for (int32_t f = 0; f < b->facet_count; f++)
        for (int end = 0; end < 2; end++) {
            const int32_t v = b->facet[f][end];
            if (m->edges[v] < 2) m->next[v][m->edges[v]] = b->facet[f][!end];
            if (m->edges[v] < 3) m->edges[v]++;
        }
    return BRUNT_OK;
}

static int reserve(brunt_barrier *b, brunt_error *error) {
    static const char rims[] = "round rims";
    const size_t facets = (size_t)b->facet_count + 1, points = (size_t)b->rim_count + 1;
    return BRUNT_CAPACITY(b->arc, facets, 0, rims, error) ||
                   BRUNT_CAPACITY(b->joint, (size_t)b->vertex_count + 1, 0, rims, error) ||
                   BRUNT_CAPACITY(b->rim, points, 0, rims, error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// Vertices and the points between them are evenly spaced along an edge; each stands for the same part of it.
static void make_points(brunt_barrier *b, int32_t facet, const double (*x)[3]) {
    const int32_t *f = b->facet[facet];
    double edge[2];
    minus(x[f[1]], x[f[0]], edge);
    for (int k = 0; k < BARRIER_RIM_POINTS; k++) {
        barrier_rim *rim = &b->rim[facet * BARRIER_RIM_POINTS + k];
        *rim = (barrier_rim){.facet = facet, .area = hypot(edge[0], edge[1]) / (BARRIER_RIM_POINTS + 1)};
        brunt_cubic_weights(&b->arc[facet].curve, (k + 1.0) / (BARRIER_RIM_POINTS + 1), rim->weight);
    }
}

int barrier_make_arcs(brunt_barrier *b, const double (*x)[3], brunt_error *error) {
    rim_maker m = {.b = b, .x = x};
    b->rim_count = b->facet_count * BARRIER_RIM_POINTS;
    const int status = reserve(b, error) || list_neighbours(&m, error) ? BRUNT_FAILED : BRUNT_OK;
    for (int32_t v = 0; v < b->vertex_count && !status; v++) b->joint[v] = BRUNT_NONE;
    for (int32_t f = 0; f < b->facet_count && !status; f++) make_arc(&m, f), make_points(b, f, x);
    b->round = !status;
    brunt_free(m.next), brunt_free(m.edges);
    return status;
}

// From differences: places far from the origin keep their digits.
void barrier_place_rims(brunt_barrier *b) {
    for (int32_t i = 0; i < b->rim_count; i++) {
        barrier_rim *rim = &b->rim[i];
        const barrier_arc *arc = &b->arc[rim->facet];
        const double *from = b->step.x[arc->place[0]];
        memcpy(rim->x, from, sizeof rim->x);
        for (int k = 0; k < arc->curve.places; k++) {
            const double *x = b->step.x[arc->place[k]];
            rim->node[k] = b->step.node[arc->place[k]];
            for (int a = 0; a < 2; a++) rim->x[a] += rim->weight[k] * (x[a] - from[a]);
        }
    }
}

const barrier_arc *barrier_arc_of(const brunt_barrier *b, int32_t facet) {
    return b->round && b->arc[facet].curve.places > 2 ? &b->arc[facet] : NULL;
}

// Bezier's points.
void barrier_arc_hull(const barrier_arc *arc, const double (*x)[3], double hull[4][3]) {
    memset(hull, 0, 12 * sizeof(double));
    for (int i = 0; i < arc->curve.places; i++) {
        const double *w = arc->curve.weight[i], end = w[0] + w[1] + w[2] + w[3];
        const double of[4] = {w[0], w[0] + w[1] / 3, end - (w[1] + 2 * w[2] + 3 * w[3]) / 3, end};
        for (int p = 0; p < 4; p++)
            for (int a = 0; a < 2; a++) hull[p][a] += of[p] * x[i][a];
    }
}

// Of a vertex, where two curves go on into each other, one of them.
int32_t barrier_arc_met(const brunt_barrier *b, const barrier_feature *f) {
    const int32_t facet = !b->round ? BRUNT_NONE : f->vertex[1] < 0 ? b->joint[f->vertex[0]] : f->facet;
    return facet >= 0 && barrier_arc_of(b, facet) ? facet : BRUNT_NONE;
}

void barrier_meet_arc(const brunt_barrier *b, const barrier_feature *f, int32_t facet, const double *u,
                      barrier_contact *c) {
    static const double here[3] = {0};
    const barrier_arc *arc = &b->arc[facet];
    const double s = f->vertex[1] >= 0 ? f->along : f->vertex[0] == b->facet[facet][1];
    double x[BRUNT_CUBIC_PLACES][3];
    const double(*at)[3] = (const double(*)[3])x;
    memcpy(c->place + 1, arc->place, (size_t)arc->curve.places * sizeof *arc->place);
    barrier_relative(b, u, c->place[0], arc->place, arc->curve.places, x);
    brunt_closest_cubic(here, at, &arc->curve, s, b->turned[facet] ? -1 : 1, &c->at);
}
