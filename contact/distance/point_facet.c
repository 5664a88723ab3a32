#include "contact/distance/point_facet.h"
#include "base/quad.h"

#include <math.h>
#include <string.h>

static const double NEAR_SPOKE = 1e-3; // of a quadrilateral's area, as the area between a place and a spoke

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}

// Nearest point of a segment, as its share of the way; `ends` when that is an end.
static double on_segment(const double a[3], const double b[3], const double x[3], bool *ends) {
    double e[3], r[3];
    for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], r[k] = x[k] - a[k];
    double length = dot(e, e), t = length > 0 ? dot(e, r) / length : 0;
    *ends = t <= 0 || t >= 1;
    return t <= 0 ? 0 : t >= 1 ? 1 : t;
}

// Ericson, Real-Time Collision Detection (2005), 5.1.5: by the regions of the triangle's Voronoi diagram.
static void on_triangle(const double *const p[3], const double x[3], double d[3], bool *inside) {
    double ab[3], ac[3], ap[3], bp[3], cp[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = p[1][k] - p[0][k], ac[k] = p[2][k] - p[0][k];
        ap[k] = x[k] - p[0][k], bp[k] = x[k] - p[1][k], cp[k] = x[k] - p[2][k];
    }
    const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                 d6 = dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    double v = 0, w = 0;
    *inside = false;
    if (d1 <= 0 && d2 <= 0)
        v = w = 0;
    else if (d3 >= 0 && d4 <= d3)
        v = 1, w = 0;
    else if (d6 >= 0 && d5 <= d6)
        v = 0, w = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        v = d1 / (d1 - d3), w = 0;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        v = 0, w = d2 / (d2 - d6);
    else if (va <= 0 && d4 >= d3 && d5 >= d6)
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6)), v = 1 - w;
    else {
        const double sum = va + vb + vc;
        v = vb / sum, w = vc / sum;
        *inside = true;
    }
    for (int k = 0; k < 3; k++) d[k] = ap[k] - v * ab[k] - w * ac[k];
}

static void unit_normal(const double *const p[3], double n[3]) {
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) ab[k] = p[1][k] - p[0][k], ac[k] = p[2][k] - p[0][k];
    cross(ab, ac, n);
    double size = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) n[k] = size > 0 ? n[k] / size : 0;
}

// Corners of triangle `t` of a face; the third of a quadrilateral's is its centre.
static void triangle_of(const brunt_contact_surface *s, int32_t face, int t, const double *p[3]) {
    const int32_t *node = s->face[face];
    p[0] = s->x[node[t]];
    p[1] = s->x[node[node[3] < 0 ? 1 : (t + 1) % 4]];
    p[2] = node[3] < 0 ? s->x[node[2]] : s->face_centre[face];
}

// Of the four triangles of a quadrilateral about its centre, at once: triangle t has corners t and t + 1.
static inline quad quad_dot(const quad a[3], const quad b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline quad quad_dot_turned(const quad a[3], const quad b[3]) { return a[1] * b[1] + a[0] * b[0] + a[2] * b[2]; }
static inline quad next_corner(quad a) { return __builtin_shufflevector(a, a, 1, 2, 3, 0); }

typedef struct four_triangles {
    quad corner[3];
    const double *centre, *normal;
    double area;
} four_triangles;

static inline four_triangles triangles_of(const brunt_contact_surface *s, int32_t face) {
    const int32_t *node = s->face[face];
    const double *a = s->x[node[0]], *b = s->x[node[1]], *c = s->x[node[2]], *d = s->x[node[3]];
    four_triangles f = {.centre = s->face_centre[face], .normal = s->face_normal[face], .area = s->face_area[face]};
    for (int k = 0; k < 3; k++) f.corner[k] = (quad){a[k], b[k], c[k], d[k]};
    return f;
}

// The one that x is over; `between`: whether it is on the way to another one, or over two, of one that is folded over.
static inline int sector(const four_triangles *f, const double x[3], bool *between) {
    const double near = NEAR_SPOKE * f->area;
    quad r[3], e[3], c[3], normal[3];
    for (int k = 0; k < 3; k++) {
        r[k] = quad_set(x[k] - f->centre[k]), e[k] = f->corner[k] - quad_set(f->centre[k]);
        normal[k] = quad_set(f->normal[k]);
    }
    c[0] = e[1] * r[2] - e[2] * r[1], c[1] = e[2] * r[0] - e[0] * r[2], c[2] = e[0] * r[1] - e[1] * r[0];
    const quad turn = quad_dot(c, normal);
    *between = false;
    for (int t = 0; t < 4; t++) *between = *between || fabs(turn[t]) < near;
    int over = 0, count = 0;
    for (int t = 0; t < 4; t++)
        if (turn[t] >= 0 && turn[(t + 1) % 4] <= 0) over = count++ ? over : t;
    *between = *between || count > 1;
    return over;
}

// As on_triangle, of all four.
static inline void on_triangles(const four_triangles *f, const double x[3], quad d[3], quad_mask *inside) {
    const quad zero = {0}, one = quad_set(1);
    quad ab[3], ac[3], ap[3], bp[3], cp[3];
    for (int k = 0; k < 3; k++) {
        const quad a = f->corner[k], b = next_corner(a), c = quad_set(f->centre[k]), place = quad_set(x[k]);
        ab[k] = b - a, ac[k] = c - a, ap[k] = place - a, bp[k] = place - b, cp[k] = place - c;
    }
    // Compilers round one of two products before a sum and the other with it: these are the same as on one triangle.
    const quad d1 = quad_dot(ab, ap), d2 = quad_dot(ac, ap), d3 = quad_dot_turned(ab, bp), d4 = quad_dot_turned(ac, bp),
               d5 = quad_dot_turned(ab, cp), d6 = quad_dot_turned(ac, cp);
    const quad va = -(d5 * d4 - d3 * d6), vb = -(d1 * d6 - d5 * d2), vc = -(d3 * d2 - d1 * d4), sum = va + vb + vc;
    const quad_mask at_a = (d1 <= zero) & (d2 <= zero), at_b = (d3 >= zero) & (d4 <= d3),
                    at_c = (d6 >= zero) & (d5 <= d6), on_ab = (vc <= zero) & (d1 >= zero) & (d3 <= zero),
                    on_ac = (vb <= zero) & (d2 >= zero) & (d6 <= zero), on_bc = (va <= zero) & (d4 >= d3) & (d5 >= d6);
    const quad way = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    quad v = quad_select(on_bc, one - way, vb / sum), w = quad_select(on_bc, way, vc / sum);
    v = quad_select(on_ac, zero, v), w = quad_select(on_ac, d2 / (d2 - d6), w);
    v = quad_select(on_ab, d1 / (d1 - d3), v), w = quad_select(on_ab, zero, w);
    v = quad_select(at_c, zero, v), w = quad_select(at_c, one, w);
    v = quad_select(at_b, one, v), w = quad_select(at_b, zero, w);
    v = quad_select(at_a, zero, v), w = quad_select(at_a, zero, w);
    *inside = ~(at_a | at_b | at_c | on_ab | on_ac | on_bc);
    for (int k = 0; k < 3; k++) d[k] = ap[k] - v * ab[k] - w * ac[k];
}

// Which of a quadrilateral's four triangles x is clearly over, as `sector` says where rounding does not matter; 4:
// none, or two.
static inline int clear_sector(const brunt_contact_surface *s, int32_t face, const double x[3]) {
    const double near = (1 + 1e-6) * NEAR_SPOKE * s->face_area[face], *centre = s->face_centre[face];
    double r[3], m[3], turn[5];
    bool clear = true;
    for (int k = 0; k < 3; k++) r[k] = x[k] - centre[k];
    cross(r, s->face_normal[face], m);
    for (int t = 0; t < 4; t++) {
        const double *corner = s->x[s->face[face][t]];
        turn[t] = (corner[0] - centre[0]) * m[0] + (corner[1] - centre[1]) * m[1] + (corner[2] - centre[2]) * m[2];
        clear = clear && fabs(turn[t]) > near;
    }
    turn[4] = turn[0];
    int over = 4, count = 0;
    for (int t = 0; t < 4; t++)
        if (turn[t] > 0 && turn[t + 1] < 0) over = t, count++;
    return clear && count == 1 ? over : 4;
}

// The nearest point of a quadrilateral where it is inside the triangle that x is clearly over. Whether it is.
static inline bool closest_in_sector(const brunt_contact_surface *s, int32_t face, const double x[3],
                                     brunt_closest *best) {
    const int t = clear_sector(s, face, x);
    if (t == 4) return false;
    const double *p[3];
    triangle_of(s, face, t, p);
    on_triangle(p, x, best->d, &best->inside);
    if (!best->inside) return false;
    best->square = dot(best->d, best->d), best->triangle = t, best->triangles = 0;
    unit_normal(p, best->normal);
    for (int k = 0; k < 3; k++) best->normal[k] += 0., best->d[k] += 0.; // no zero has a sign, as in a mean
    return true;
}

// Where one triangle has the nearest point, and not on its rim.
static inline brunt_closest within_triangle(const brunt_contact_surface *s, int32_t face, int t, const quad way[3],
                                            double square) {
    brunt_closest best = {.square = square, .inside = true, .triangle = t};
    const double *p[3];
    double n[3];
    triangle_of(s, face, t, p);
    unit_normal(p, n);
    for (int k = 0; k < 3; k++) best.normal[k] += n[k], best.d[k] = way[k][t];
    return best;
}

// Triangles that are as near as each other: the mean of their normals and of the ways to x, whose length is that of
// either, and as its triangle the one that most faces x, as between facets.
static brunt_closest on_rim(const brunt_contact_surface *s, int32_t face, int first, const quad way[3], quad squares,
                            quad_mask in, double least) {
    brunt_closest best = {.square = INFINITY};
    const double root = sqrt(least) + BRUNT_TIE * sqrt(s->face_area[face]);
    double most = -1;
    int count = 0;
    for (int k = 0; k < 4; k++) {
        const int t = (first + k) % 4;
        if (squares[t] > root * root) continue;
        const double d[3] = {way[0][t], way[1][t], way[2][t]}, *p[3];
        double n[3];
        triangle_of(s, face, t, p);
        unit_normal(p, n);
        const double normal_distance = in[t] ? INFINITY : fabs(dot(n, d));
        const bool nearer = best.inside && in[t] && squares[t] < best.square; // of two that it is over
        count++, best.triangles |= 1 << t;
        for (int c = 0; c < 3; c++) best.normal[c] += n[c], best.d[c] += d[c];
        if (nearer || normal_distance > most)
            most = normal_distance, best.square = squares[t], best.inside = in[t], best.triangle = t;
    }
    if (count == 1) best.triangles = 0;
    const double size = count > 1 ? sqrt(dot(best.normal, best.normal)) : 1;
    for (int c = 0; c < 3; c++) best.normal[c] = size > 0 ? best.normal[c] / size : 0, best.d[c] /= count;
    // The spokes of a quadrilateral are no edges of the surface: on a flat one the nearest point may lie on one.
    double along = dot(best.d, best.normal);
    if (!best.inside && best.square - along * along <= 1e-24 * s->face_area[face]) best.inside = true;
    best.square = least; // of what is as near one is the nearest: beside a corner that settles which facet is
    return best;
}

// Of a quadrilateral's four triangles the one whose sector x is in settles it, unless the nearest point is on its rim.
static brunt_closest closest_on_quadrilateral(const brunt_contact_surface *s, int32_t face, const double x[3],
                                              double beyond) {
    brunt_closest best = {.square = INFINITY};
    if (beyond == INFINITY && closest_in_sector(s, face, x, &best)) return best; // what is further is seldom over it
    const four_triangles f = triangles_of(s, face);
    bool between;
    quad way[3];
    quad_mask in;
    const int first = sector(&f, x, &between);
    on_triangles(&f, x, way, &in);
    const quad squares = quad_dot(way, way);
    const bool one = in[first] && !between;
    double least = squares[first];
    for (int t = 0; t < 4 && !one; t++) least = squares[t] < least ? squares[t] : least;
    if (least > beyond) return (brunt_closest){.square = least};
    return one ? within_triangle(s, face, first, way, least) : on_rim(s, face, first, way, squares, in, least);
}

brunt_closest brunt_closest_on_face(const brunt_contact_surface *s, int32_t face, const double x[3]) {
    return brunt_closest_on_face_within(s, face, x, INFINITY);
}

brunt_closest brunt_closest_on_face_within(const brunt_contact_surface *s, int32_t face, const double x[3],
                                           double beyond) {
    const int32_t *node = s->face[face];
    brunt_closest best = {.square = INFINITY};
    if (node[2] < 0) {
        bool ends;
        const double *a = s->x[node[0]], *b = s->x[node[1]], t = on_segment(a, b, x, &ends);
        best.inside = !ends;
        for (int k = 0; k < 3; k++) {
            best.d[k] = x[k] - (1 - t) * a[k] - t * b[k];
            best.normal[k] = s->face_normal[face][k];
        }
        best.square = dot(best.d, best.d);
        return best;
    }
    if (node[3] >= 0) return closest_on_quadrilateral(s, face, x, beyond);
    const double *p[3];
    triangle_of(s, face, 0, p);
    on_triangle(p, x, best.d, &best.inside);
    best.square = dot(best.d, best.d);
    unit_normal(p, best.normal);
    return best;
}

// Weights of a triangle's second and third corner at r from the first: e and g its edges from there, n = e x g.
static void triangle_weights(const double e[3], const double g[3], const double r[3], const double n[3], double inverse,
                             double *w1, double *w2) {
    double rg[3], er[3];
    cross(r, g, rg);
    cross(e, r, er);
    *w1 = dot(rg, n) * inverse, *w2 = dot(er, n) * inverse;
}

static void spread(const int32_t node[4], int triangle, double w0, double w1, double w2, double weight[4]) {
    const int i = triangle, j = node[3] < 0 ? 1 : (triangle + 1) % 4;
    for (int c = 0; c < 4; c++)
        weight[c] = node[3] < 0 ? (c == 2 ? w2 : 0) : 0.25 * w2; // the centre is the mean of the four
    weight[i] += w0, weight[j] += w1;
}

void brunt_face_values(const brunt_contact_surface *s, int32_t face, int triangle, const double x[3],
                       double weight[4]) {
    const int32_t *node = s->face[face];
    if (node[2] < 0) {
        const double *a = s->x[node[0]], *b = s->x[node[1]];
        double e[3], r[3];
        for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], r[k] = x[k] - a[k];
        double length = dot(e, e), t = length > 0 ? dot(e, r) / length : 0;
        weight[0] = 1 - t, weight[1] = t, weight[2] = weight[3] = 0;
        return;
    }
    const double *p[3];
    double e[3], g[3], r[3], n[3], w1, w2;
    triangle_of(s, face, triangle, p);
    for (int k = 0; k < 3; k++) e[k] = p[1][k] - p[0][k], g[k] = p[2][k] - p[0][k], r[k] = x[k] - p[0][k];
    cross(e, g, n);
    double size = dot(n, n);
    triangle_weights(e, g, r, n, size > 0 ? 1 / size : 0, &w1, &w2);
    spread(node, triangle, 1 - w1 - w2, w1, w2, weight);
}

void brunt_face_weights(const brunt_contact_surface *s, const brunt_facet_position *place, double weight[4],
                        double gradient[4][3], double normal[3], double *height) {
    const int32_t face = place->face, *node = s->face[face];
    const int triangle = place->triangle;
    const double *x = place->x;
    brunt_face_values(s, face, triangle, x, weight);
    if (node[2] < 0) {
        const double *a = s->x[node[0]], *b = s->x[node[1]];
        double e[3], length = 0;
        for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], normal[k] = s->face_normal[face][k], length += e[k] * e[k];
        *height = 0;
        for (int k = 0; k < 3; k++) {
            gradient[1][k] = length > 0 ? e[k] / length : 0, gradient[0][k] = -gradient[1][k];
            gradient[2][k] = gradient[3][k] = 0;
            *height += (x[k] - a[k]) * normal[k];
        }
        return;
    }
    const double *p[3];
    double e[3], g[3], r[3], n[3], g1[3], g2[3];
    triangle_of(s, face, triangle, p);
    for (int k = 0; k < 3; k++) e[k] = p[1][k] - p[0][k], g[k] = p[2][k] - p[0][k], r[k] = x[k] - p[0][k];
    cross(e, g, n);
    const double size = dot(n, n), inverse = size > 0 ? 1 / size : 0, root = sqrt(inverse);
    for (int k = 0; k < 3; k++) normal[k] = n[k] * root;
    *height = dot(r, normal);
    // Gradients of the triangle's own weights: g1 = (g x n)/n^2, g2 = (n x e)/n^2.
    cross(g, n, g1);
    cross(n, e, g2);
    for (int k = 0; k < 3; k++) {
        double weights[4];
        spread(node, triangle, -(g1[k] + g2[k]) * inverse, g1[k] * inverse, g2[k] * inverse, weights);
        for (int c = 0; c < 4; c++) gradient[c][k] = weights[c];
    }
}
