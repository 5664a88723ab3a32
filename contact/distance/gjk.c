// Distance between two bodies near a node: the algorithm of Gilbert, Johnson and Keerthi (1988).
//
// What a body has near a node is the convex hull of its particles, each an ellipsoid of material (particle_cloud.c);
// only the farthest point along a direction is ever asked for. The difference of two hulls holds the origin when they
// overlap; else its point nearest the origin gives distance and direction. That point is approached by simplices of at
// most four support points. Every direction tried bounds the distance from below, and the best bound is what is
// returned: a direction that does separate the bodies, however early the search ends.
//
// Ellipsoids are round, and polytopes come near to what is round slowly. So all of a body's are taken without a ball
// that rolls about in each: the hulls of what is left are that much farther apart, in the same direction, and are
// nearly those of the centres. Bodies that press on each other overlap by a thousandth of a cell and less, and these
// cores are apart: that they are not by as much as the balls are thick is soon seen, mostly from the particles that
// were the nearest between centres, without a look at any other.
#include <math.h>
#include <string.h>

#include "contact/distance/gjk.h"

enum { MAX_ROUNDS = 24 };
static const double CLOSE_ENOUGH = 1e-8; // relative gap between bound and distance
static const double OVERLAP = 1e-9;      // cells: nearer to the origin than this is in it

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Solves the n by n system (n <= 3) by Cramer's rule; false when it is singular.
static inline __attribute__((always_inline)) bool solve(int n, double m[3][3], const double r[3], double x[3]) {
    double size = 0, det;
    for (int i = 0; i < n; i++) size = fmax(size, m[i][i]);
    if (n == 1) {
        if (!(m[0][0] > 0)) return false;
        x[0] = r[0] / m[0][0];
        return true;
    }
    if (n == 2) {
        det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        if (!(fabs(det) > 1e-14 * size * size)) return false;
        x[0] = (r[0] * m[1][1] - r[1] * m[0][1]) / det;
        x[1] = (m[0][0] * r[1] - m[1][0] * r[0]) / det;
        return true;
    }
    double c[3] = {m[1][1] * m[2][2] - m[1][2] * m[2][1], m[1][2] * m[2][0] - m[1][0] * m[2][2],
                   m[1][0] * m[2][1] - m[1][1] * m[2][0]};
    det = m[0][0] * c[0] + m[0][1] * c[1] + m[0][2] * c[2];
    if (!(fabs(det) > 1e-14 * size * size * size)) return false;
    for (int k = 0; k < 3; k++) {
        double t[3][3];
        memcpy(t, m, sizeof t);
        for (int i = 0; i < 3; i++) t[i][k] = r[i];
        x[k] = (t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) - t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
                t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0])) /
               det;
    }
    return true;
}

typedef struct corner {
    double x[3];
    int a, b; // particles
} corner;

// Corners of a simplex, and its point nearest the origin.
typedef struct simplex {
    corner corner[BRUNT_CORNERS];
    int count;
    double v[3];
} simplex;

// Finds the point nearest the origin, and drops the corners that it does not need. The last one is nearer than the hull
// of the others was: every face that it is a corner of is tried, 8 at most.
static inline __attribute__((always_inline)) void try_faces(simplex *s, int others) {
    const corner *last = &s->corner[others];
    double e[3][3], gram[3][3], right[3], best = INFINITY;
    int best_faces = 0;
    for (int i = 0; i < others; i++) {
        for (int k = 0; k < 3; k++) e[i][k] = s->corner[i].x[k] - last->x[k];
        right[i] = -dot(e[i], last->x);
        for (int k = 0; k <= i; k++) gram[i][k] = gram[k][i] = dot(e[i], e[k]);
    }
    for (int mask = 0; mask < 1 << others; mask++) {
        double part[3][3], wanted[3], weight[3], at[3], first = 1;
        int use[3], n = 0;
        for (int i = 0; i < others; i++)
            if (mask >> i & 1) use[n++] = i;
        for (int i = 0; i < n; i++) {
            wanted[i] = right[use[i]];
            for (int k = 0; k < n; k++) part[i][k] = gram[use[i]][use[k]];
        }
        if (n && !solve(n, part, wanted, weight)) continue;
        bool inside = true;
        memcpy(at, last->x, sizeof at);
        for (int i = 0; i < n; i++) {
            inside = inside && weight[i] >= 0;
            first -= weight[i];
            for (int k = 0; k < 3; k++) at[k] += weight[i] * e[use[i]][k];
        }
        if (!inside || first < 0 || dot(at, at) >= best) continue;
        best = dot(at, at);
        best_faces = mask;
        memcpy(s->v, at, sizeof at);
    }
    int kept = 0;
    for (int i = 0; i <= others; i++)
        if (i == others || best_faces >> i & 1) s->corner[kept++] = s->corner[i];
    s->count = kept;
}

static void find_nearest(simplex *s) {
    switch (s->count) { // each unrolled
    case 1: memcpy(s->v, s->corner[0].x, sizeof s->v); break;
    case 2: try_faces(s, 1); break;
    case 3: try_faces(s, 2); break;
    default: try_faces(s, 3);
    }
}

// What is looked for.
typedef struct search {
    const brunt_cloud *a, *b;
    double h;
    bool reach;
    double ball; // [m] radii of the balls, together, that both are taken without
} search;

// The difference of where particles c->a and c->b end along n and against it.
static void place(const search *in, const double n[3], corner *c) {
    const double back[3] = {-n[0], -n[1], -n[2]};
    double pa[3], pb[3];
    brunt_cloud_end(in->a, c->a, in->reach, n, pa), brunt_cloud_end(in->b, c->b, in->reach, back, pb);
    for (int k = 0; k < 3; k++) c->x[k] = pb[k] - pa[k] + in->ball * n[k];
}

// The same of the two that go farthest. Whether there are any.
static bool look(const search *in, const double n[3], corner *c) {
    const double back[3] = {-n[0], -n[1], -n[2]};
    if (!isfinite(brunt_cloud_extent(in->a, in->reach, n, &c->a)) ||
        !isfinite(brunt_cloud_extent(in->b, in->reach, back, &c->b)))
        return false;
    place(in, n, c);
    return true;
}

static bool overlaps(const search *in, const simplex *s) {
    return s->count == BRUNT_CORNERS || !(sqrt(dot(s->v, s->v)) > in->ball + OVERLAP * in->h);
}

// Searches on from a simplex, or along s->v where it has no corner yet; as brunt_gjk_centres.
static double search_from(const search *in, simplex *s, double n[3]) {
    double bound = 0;
    for (int round = 0; round < MAX_ROUNDS; round++) {
        const bool known = s->count > 0;
        const double size = sqrt(dot(s->v, s->v)), along[3] = {s->v[0] / size, s->v[1] / size, s->v[2] / size};
        corner *next = &s->corner[s->count];
        if ((known && overlaps(in, s)) || !(size > 0) || !isfinite(size) || !look(in, along, next)) return 0;
        const double reached = dot(next->x, along);
        if (reached - in->ball > bound) {
            bound = reached - in->ball;
            memcpy(n, along, sizeof along);
        }
        if (known && size - reached <= CLOSE_ENOUGH * (size - in->ball)) return bound;
        for (int i = 0; i < s->count; i++)
            if (!memcmp(s->corner[i].x, next->x, sizeof next->x)) return bound; // rounding has the last word
        s->count++;
        find_nearest(s);
    }
    return bound;
}

// The simplex of the pairs of particles given. Whether they alone tell that the bodies overlap.
static bool begin(const search *in, const double n[3], const brunt_corners *corners, simplex *s) {
    s->count = 0;
    memcpy(s->v, n, sizeof s->v);
    for (int i = 0; i < corners->count; i++) {
        corner *next = &s->corner[s->count];
        next->a = corners->a[i], next->b = corners->b[i];
        place(in, n, next);
        if (s->count && !(dot(next->x, s->v) < dot(s->v, s->v))) continue;
        s->count++;
        find_nearest(s);
        if (overlaps(in, s)) return true;
    }
    return false;
}

double brunt_gjk_centres(const brunt_cloud *a, const brunt_cloud *b, double h, const double start[3], double n[3],
                         brunt_corners *corners) {
    const search in = {.a = a, .b = b, .h = h};
    simplex s;
    const bool together = begin(&in, start, corners, &s);
    const double distance = together ? 0 : search_from(&in, &s, n);
    corners->count = distance > 0 ? s.count : 0;
    for (int i = 0; i < corners->count; i++) corners->a[i] = s.corner[i].a, corners->b[i] = s.corner[i].b;
    return distance;
}

double brunt_gjk_reaches(const brunt_cloud *a, const brunt_cloud *b, double h, const double start[3], double n[3],
                         const brunt_corners *corners) {
    const double size = sqrt(dot(start, start)), along[3] = {start[0] / size, start[1] / size, start[2] / size};
    search in = {.a = a, .b = b, .h = h, .reach = true};
    simplex s;
    in.ball = corners->count ? brunt_cloud_ball_of(a, corners->a, corners->count) +
                                   brunt_cloud_ball_of(b, corners->b, corners->count)
                             : 0;
    if (begin(&in, along, corners, &s)) return 0;
    in.ball = brunt_cloud_ball(a) + brunt_cloud_ball(b);
    if (!isfinite(in.ball) || begin(&in, along, corners, &s)) return 0;
    return search_from(&in, &s, n);
}
