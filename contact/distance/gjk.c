// Distance between two bodies near a node: the algorithm of Gilbert, Johnson and Keerthi (1988).
//
// What a body has near a node is the convex hull of its particles, each an ellipsoid of material (particle_cloud.c);
// only the farthest point along a direction is ever asked for. The difference of two hulls holds the origin when they
// overlap; else its point nearest the origin gives distance and direction. That point is approached by simplices of at
// most four support points. Every direction tried bounds the distance from below, and the best bound is what is
// returned: a direction that does separate the bodies, however early the search ends.
#include <math.h>
#include <string.h>

#include "contact/distance/gjk.h"

enum { MAX_POINTS = 4, MAX_ROUNDS = 24 };
static const double CLOSE_ENOUGH = 1e-8; // relative gap between bound and distance
static const double OVERLAP = 1e-9;      // cells: nearer to the origin than this is in it

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Solves the n by n system (n <= 3) by Cramer's rule; false when it is singular.
static bool solve(int n, double m[3][3], const double r[3], double x[3]) {
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

// Point of the hull of `points` nearest the origin; drops the points it does not need. The last one is nearer than the
// hull of the others was: every face that it is a corner of is tried, 8 at most.
static void nearest(double points[MAX_POINTS][3], int *count, double v[3]) {
    double best = INFINITY;
    int best_faces = 1 << (*count - 1);
    for (int mask = 1 << (*count - 1); mask < 1 << *count; mask++) {
        int use[MAX_POINTS], n = 0;
        for (int i = 0; i < *count; i++)
            if (mask >> i & 1) use[n++] = i;
        const double *p = points[use[0]];
        double e[3][3] = {{0}}, gram[3][3] = {{0}}, right[3] = {0}, weight[3] = {0}, at[3], first = 1;
        for (int i = 1; i < n; i++)
            for (int k = 0; k < 3; k++) e[i - 1][k] = points[use[i]][k] - p[k];
        for (int i = 0; i < n - 1; i++) {
            right[i] = -dot(e[i], p);
            for (int k = 0; k < n - 1; k++) gram[i][k] = dot(e[i], e[k]);
        }
        if (n > 1 && !solve(n - 1, gram, right, weight)) continue;
        bool inside = true;
        memcpy(at, p, sizeof at);
        for (int i = 0; i < n - 1; i++) {
            inside = inside && weight[i] >= 0;
            first -= weight[i];
            for (int k = 0; k < 3; k++) at[k] += weight[i] * e[i][k];
        }
        if (!inside || first < 0 || dot(at, at) >= best) continue;
        best = dot(at, at);
        best_faces = mask;
        memcpy(v, at, sizeof at);
    }
    int kept = 0;
    for (int i = 0; i < *count; i++)
        if (best_faces >> i & 1) memmove(points[kept++], points[i], sizeof points[0]);
    *count = kept;
}

double brunt_gjk_distance(const brunt_cloud *a, const brunt_cloud *b, double h, bool reach, const double start[3],
                          double n[3]) {
    double points[MAX_POINTS][3], v[3] = {start[0], start[1], start[2]}, bound = 0;
    int count = 0;
    for (int round = 0; round < MAX_ROUNDS; round++) {
        double size = sqrt(dot(v, v)), along[3], back[3], pa[3], pb[3], w[3];
        if (!(size > OVERLAP * h) || !isfinite(size)) return 0;
        for (int k = 0; k < 3; k++) along[k] = v[k] / size, back[k] = -along[k];
        if (!isfinite(brunt_cloud_extent(a, reach, along, pa)) || !isfinite(brunt_cloud_extent(b, reach, back, pb)))
            return 0;
        for (int k = 0; k < 3; k++) w[k] = pb[k] - pa[k];
        double reached = dot(w, along);
        if (reached > bound) {
            bound = reached;
            memcpy(n, along, sizeof along);
        }
        if (round > 0 && size - reached <= CLOSE_ENOUGH * size) break;
        for (int i = 0; i < count; i++)
            if (!memcmp(points[i], w, sizeof w)) return bound; // nothing new: rounding has the last word
        memcpy(points[count++], w, sizeof w);
        nearest(points, &count, v);
        if (count == MAX_POINTS) return 0; // the origin is inside
    }
    return bound;
}
