#include "contact/barrier/closest.h"
#include "contact/distance/line_crossing.h"

#include <math.h>
#include <string.h>

// Regions end so far from their borders, as a part of an edge: what is right above a border, but for rounding, is at
// what lies there for all features that share it. Distances as near as a tie are the same.
static const double BORDER = 1e-13, TIE = 1e-14;
// A triangle flatter than this has no inside: its edges are as near, and its normal is not known.
static const double SLIVER = 1e-8;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void minus(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}

static double length(const double a[3]) { return sqrt(dot(a, a)); }

// What is left of r across e: twice, since the first difference leaves rounding along e that counts where r is short
// against where it came from.
static void across(const double r[3], const double e[3], double out[3]) {
    const double l2 = dot(e, e);
    memcpy(out, r, 3 * sizeof *out);
    for (int twice = 0; twice < 2; twice++) {
        const double u = dot(out, e) / l2;
        for (int k = 0; k < 3; k++) out[k] -= u * e[k];
    }
}

static void direction(const double r[3], brunt_closest *c) {
    c->d = length(r);
    for (int k = 0; k < 3; k++) c->n[k] = c->d > 0 ? r[k] / c->d : 0;
}

void brunt_closest_points(const double q[3], const double a[3], brunt_closest *c) {
    double r[3];
    *c = (brunt_closest){.places = 2, .w = {1, -1}};
    minus(q, a, r);
    direction(r, c);
}

// Coordinate of a point along an edge (0 at a) from the nearer end, and what is across it.
static double along_edge(const double q[3], const double a[3], const double b[3], double r[3]) {
    double e[3], qa[3], qb[3];
    minus(b, a, e), minus(q, a, qa), minus(q, b, qb);
    const double l2 = dot(e, e), from_a = dot(qa, e) / l2, from_b = -dot(qb, e) / l2;
    across(from_a <= from_b ? qa : qb, e, r);
    return from_a <= from_b ? from_a : 1 - from_b;
}

void brunt_closest_line(const double q[3], const double a[3], const double b[3], brunt_closest *c) {
    double r[3];
    const double u = along_edge(q, a, b, r);
    *c = (brunt_closest){.places = 3, .free = 1, .w = {1, u - 1, -u}, .g = {{0, 1, -1}}};
    minus(a, b, c->tangent[0]);
    direction(r, c);
}

int brunt_closest_of_edge(const double q[3], const double a[3], const double b[3], double *d) {
    double r[3];
    const double u = along_edge(q, a, b, r);
    if (u > BORDER && u < 1 - BORDER) return *d = length(r), BRUNT_AT_A | BRUNT_AT_B;
    minus(q, u < 0.5 ? a : b, r);
    *d = length(r);
    return u < 0.5 ? BRUNT_AT_A : BRUNT_AT_B;
}

// Whether a region is nearer than the best so far: where both are as far but for rounding, the larger one.
static bool nearer(double d, int region, double best, int best_region) {
    if (fabs(d - best) > TIE * best) return d < best;
    return __builtin_popcount((unsigned)region) > __builtin_popcount((unsigned)best_region);
}

// Coordinates of the foot of q on the plane of a triangle along its sides from p[0]; the distance with the sign of the
// normal. False: it has no plane.
static int on_plane(const double q[3], const double p[3][3], double n[3], double uv[2], double *height) {
    double e[2][3], r[3];
    minus(p[1], p[0], e[0]), minus(p[2], p[0], e[1]);
    cross(e[0], e[1], n);
    const double a = dot(e[0], e[0]), b = dot(e[0], e[1]), c = dot(e[1], e[1]), twice = length(n);
    if (!(twice > SLIVER * sqrt(a * c))) return 0;
    for (int k = 0; k < 3; k++) n[k] /= twice;
    int base = 0; // the nearest vertex
    double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        minus(q, p[i], r);
        if (dot(r, r) < least) least = dot(r, r), base = i;
    }
    minus(q, p[base], r);
    *height = dot(n, r);
    for (int k = 0; k < 3; k++) r[k] -= *height * n[k];
    const double ru = dot(r, e[0]), rv = dot(r, e[1]), det = twice * twice;
    uv[0] = (c * ru - b * rv) / det + (base == 1), uv[1] = (a * rv - b * ru) / det + (base == 2);
    return 1;
}

void brunt_closest_plane(const double q[3], const double p[3][3], brunt_closest *c) {
    double uv[2] = {0}, height = 0;
    *c = (brunt_closest){.places = 4, .free = 2, .g = {{0, 1, -1, 0}, {0, 1, 0, -1}}};
    on_plane(q, p, c->n, uv, &height);
    c->w[0] = 1, c->w[1] = uv[0] + uv[1] - 1, c->w[2] = -uv[0], c->w[3] = -uv[1];
    minus(p[0], p[1], c->tangent[0]), minus(p[0], p[2], c->tangent[1]);
    c->d = fabs(height);
    if (height < 0)
        for (int k = 0; k < 3; k++) c->n[k] = -c->n[k];
}

int brunt_closest_of_triangle(const double q[3], const double p[3][3], double *d) {
    static const int end[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    double n[3], uv[2], height;
    if (on_plane(q, p, n, uv, &height) && uv[0] > BORDER && uv[1] > BORDER && uv[0] + uv[1] < 1 - BORDER)
        return *d = fabs(height), BRUNT_AT_A | BRUNT_AT_B | BRUNT_AT_C;
    int region = 0;
    *d = INFINITY;
    for (int i = 0; i < 3; i++) {
        double at;
        const int a = end[i][0], b = end[i][1], side = brunt_closest_of_edge(q, p[a], p[b], &at);
        const int here = (side & BRUNT_AT_A ? 1 << a : 0) | (side & BRUNT_AT_B ? 1 << b : 0);
        if (i == 0 || nearer(at, here, *d, region)) *d = at, region = here;
    }
    return region;
}

// Crossing of the lines of two edges between their ends, s along a and t along b. False: it is not there.
static int crossing(const double a[2][3], const double b[2][3], brunt_closest *c) {
    brunt_line_crossing at;
    if (!brunt_lines_cross(a, b, 1e-24, &at)) return 0;
    const double s = at.s, t = at.t, sine = sqrt(at.sine2);
    if (!(s > BORDER && s < 1 - BORDER && t > BORDER && t < 1 - BORDER)) return 0;
    *c = (brunt_closest){.places = 4, .free = 2, .w = {1 - s, s, t - 1, -t}, .g = {{-1, 1, 0, 0}, {0, 0, 1, -1}}};
    memcpy(c->tangent[0], at.ea, sizeof at.ea);
    for (int k = 0; k < 3; k++) c->tangent[1][k] = -at.eb[k];
    direction(at.r, c);
    const double height = dot(at.r, at.n) / sine;
    if (at.sine2 > 1e-12 * at.aa * at.bb) { // else r is the better known
        c->d = fabs(height);
        for (int k = 0; k < 3; k++) c->n[k] = (height < 0 ? -1 : 1) * at.n[k] / sine;
    }
    return 1;
}

// An end of one edge at the other: places are those of both edges. `side` 0: the end is of a.
static void end_at_edge(const double a[2][3], const double b[2][3], int side, int end, brunt_closest *c) {
    const double(*own)[3] = side ? b : a, (*other)[3] = side ? a : b;
    double d;
    const int region = brunt_closest_of_edge(own[end], other[0], other[1], &d);
    brunt_closest part;
    if (region == (BRUNT_AT_A | BRUNT_AT_B))
        brunt_closest_line(own[end], other[0], other[1], &part);
    else
        brunt_closest_points(own[end], other[region == BRUNT_AT_B], &part);
    const double sign = side ? -1 : 1;
    const int mine = 2 * side + end, theirs = side ? 0 : 2;
    *c = (brunt_closest){.places = 4, .free = part.free, .d = part.d};
    c->w[mine] = sign;
    if (part.free)
        for (int i = 0; i < 2; i++)
            c->w[theirs + i] = sign * part.w[1 + i], c->g[0][theirs + i] = sign * part.g[0][1 + i];
    else
        c->w[theirs + (region == BRUNT_AT_B)] = -sign;
    for (int k = 0; k < 3; k++) c->n[k] = sign * part.n[k], c->tangent[0][k] = sign * part.tangent[0][k];
}

static int bearing(const brunt_closest *c) {
    int region = 0;
    for (int i = 0; i < 4; i++) region |= (c->w[i] != 0) << i;
    return region;
}

int brunt_closest_edges(const double a[2][3], const double b[2][3], brunt_closest *c) {
    for (int i = 0; i < 4; i++) {
        brunt_closest at;
        end_at_edge(a, b, i / 2, i % 2, &at);
        if (i == 0 || nearer(at.d, bearing(&at), c->d, bearing(c))) *c = at;
    }
    brunt_closest inner;
    if (crossing(a, b, &inner) && inner.d <= c->d * (1 + TIE)) *c = inner;
    return bearing(c);
}

// What of the plane across n is not along the features: there n turns as for points.
static void turning(const brunt_closest *c, int dim, double out[3][3]) {
    memset(out, 0, 9 * sizeof(double));
    if (c->flat || c->free == 2 || (c->free == 1 && dim == 2)) return;
    double m[3];
    if (c->free == 1) {
        cross(c->n, c->tangent[0], m);
        const double l2 = dot(m, m);
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) out[k][l] = m[k] * m[l] / l2;
        return;
    }
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) out[k][l] = (k == l) - c->n[k] * c->n[l];
}

// Inverse of the products of the `turn`s, and their duals.
static void duals(const brunt_closest *c, double inverse[2][2], double dual[2][3]) {
    memset(inverse, 0, 4 * sizeof(double));
    memset(dual, 0, 6 * sizeof(double));
    const double a = dot(c->tangent[0], c->tangent[0]), b = dot(c->tangent[0], c->tangent[1]),
                 d = dot(c->tangent[1], c->tangent[1]);
    if (c->free == 1) inverse[0][0] = 1 / a;
    if (c->free == 2) {
        double normal[3];
        cross(c->tangent[0], c->tangent[1], normal);
        const double det = dot(normal, normal);
        inverse[0][0] = d / det, inverse[1][1] = a / det, inverse[0][1] = inverse[1][0] = -b / det;
    }
    for (int i = 0; i < c->free; i++)
        for (int j = 0; j < c->free; j++)
            for (int k = 0; k < 3; k++) dual[i][k] += inverse[i][j] * c->tangent[j][k];
}

void brunt_closest_hessian(const brunt_closest *c, int dim, double outer, double inner, double *h) {
    double turn[3][3], inverse[2][2], dual[2][3];
    if (c->curved) {
        brunt_cubic_hessian(c, outer, inner, h);
        return;
    }
    turning(c, dim, turn);
    duals(c, inverse, dual);
    const int rows = c->places * dim;
    const double d = c->d == 0 ? 1 : c->d; // `inner` is 0 there
    for (int i = 0; i < c->places; i++)
        for (int j = 0; j < c->places; j++) {
            const double ww = c->w[i] * c->w[j];
            double gg = 0, left[3] = {0}, right[3] = {0};
            for (int a = 0; a < c->free; a++) {
                for (int b = 0; b < c->free; b++) gg += inverse[a][b] * c->g[a][i] * c->g[b][j];
                for (int k = 0; k < 3; k++)
                    left[k] += c->w[i] * c->g[a][j] * dual[a][k], right[k] += c->g[a][i] * c->w[j] * dual[a][k];
            }
            const double nn = outer * ww - inner * c->d * gg;
            for (int k = 0; k < dim; k++)
                for (int l = 0; l < dim; l++)
                    h[(i * dim + k) * rows + j * dim + l] +=
                        nn * c->n[k] * c->n[l] + inner * (ww * turn[k][l] / d - left[k] * c->n[l] - c->n[k] * right[l]);
        }
}

double brunt_edge_cross(const double ea[3], const double eb[3], double gradient[6], double hessian[36]) {
    double x[3], ga[3], gb[3];
    cross(ea, eb, x);
    cross(eb, x, ga), cross(x, ea, gb);
    const double aa = dot(ea, ea), bb = dot(eb, eb), ab = dot(ea, eb);
    for (int k = 0; k < 3; k++) {
        gradient[k] = 2 * ga[k], gradient[3 + k] = 2 * gb[k];
        for (int l = 0; l < 3; l++) {
            hessian[k * 6 + l] = 2 * ((k == l) * bb - eb[k] * eb[l]);
            hessian[(3 + k) * 6 + 3 + l] = 2 * ((k == l) * aa - ea[k] * ea[l]);
            hessian[k * 6 + 3 + l] = hessian[(3 + l) * 6 + k] =
                4 * ea[k] * eb[l] - 2 * eb[k] * ea[l] - 2 * (k == l) * ab;
        }
    }
    return dot(x, x);
}
