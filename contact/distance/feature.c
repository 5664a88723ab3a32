#include "contact/distance/feature.h"

#include <math.h>
#include <string.h>

#include "base/error.h"

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
static void between(const double from[3], const double to[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = to[a] - from[a];
}

static int corners(const int32_t face[4]) { return face[2] < 0 ? 2 : face[3] < 0 ? 3 : 4; }

// Which corner of a face a node is; -1: none.
static int corner_of(const int32_t face[4], int32_t node) {
    for (int c = 0; c < corners(face); c++)
        if (face[c] == node) return c;
    return BRUNT_NONE;
}

bool brunt_feature_share(const brunt_contact_surface *s, int32_t face, brunt_shared *shared) {
    const int32_t *node = s->face[face];
    brunt_shared both = {.count = 0};
    if (!shared->count) {
        memcpy(shared->node, node, sizeof shared->node);
        shared->count = corners(node);
        return true;
    }
    for (int32_t k = 0; k < shared->count; k++)
        if (corner_of(node, shared->node[k]) >= 0) both.node[both.count++] = shared->node[k];
    if (both.count) *shared = both;
    return both.count > 0;
}

// The two edges of a face that leave a corner, in the order in which their cross product is outward.
static void edges_at(const brunt_contact_surface *s, const int32_t face[4], int corner, double e[3], double g[3]) {
    const int n = corners(face);
    between(s->x[face[corner]], s->x[face[(corner + 1) % n]], e);
    between(s->x[face[corner]], s->x[face[(corner + n - 1) % n]], g);
}

// The normal of a face at a feature, as long as it counts there.
static void normal_at(const brunt_contact_surface *s, const brunt_feature *f, int32_t face, double out[3]) {
    const int32_t *node = s->face[face];
    const int n = corners(node), corner = corner_of(node, f->end[0]);
    double e[3], g[3], size = 1;
    memcpy(out, s->face_normal[face], sizeof(double[3]));
    if (n == 2 || corner < 0) return;
    edges_at(s, node, corner, e, g);
    if (f->end[1] != f->end[0]) { // of a quadrilateral's triangle at the edge
        if (n == 3) return;
        const bool forward = node[(corner + 1) % n] == f->end[1];
        between(s->x[f->end[forward ? 0 : 1]], s->x[f->end[forward ? 1 : 0]], e);
        between(s->x[f->end[forward ? 0 : 1]], s->face_centre[face], g);
    }
    double c[3];
    cross(e, g, c);
    const double length = sqrt(dot(c, c));
    if (f->end[1] == f->end[0]) size = atan2(length, dot(e, g));
    if (n == 3)
        for (int a = 0; a < 3; a++) out[a] *= size;
    else
        for (int a = 0; a < 3; a++) out[a] = length > 0 ? size * c[a] / length : 0;
}

bool brunt_feature_normal(const brunt_contact_surface *s, const brunt_feature *f, const int32_t *face, int count,
                          double n[3]) {
    double sum[3] = {0};
    for (int k = 0; k < count; k++) {
        double one[3];
        normal_at(s, f, face[k], one);
        for (int a = 0; a < 3; a++) sum[a] += one[a];
    }
    if (s->axisymmetric && s->x[f->end[0]][0] == 0) sum[0] = 0; // the other side of the axis
    const double size = sqrt(dot(sum, sum));
    for (int a = 0; a < 3; a++) n[a] = size > 0 ? sum[a] / size : 0;
    return size > 1e-6;
}

void brunt_feature_values(const brunt_contact_surface *s, const brunt_feature *f, const double x[3], double weight[2]) {
    weight[0] = 1, weight[1] = 0;
    if (f->end[0] == f->end[1]) return;
    double e[3], r[3];
    between(s->x[f->end[0]], s->x[f->end[1]], e);
    between(s->x[f->end[0]], x, r);
    const double length = dot(e, e), t = length > 0 ? fmin(1, fmax(0, dot(e, r) / length)) : 0;
    weight[0] = 1 - t, weight[1] = t;
}

// ------------------------------------------------------------------------------------------ as master

typedef struct about {
    int32_t *node;
    int count;
    double (*gradient)[3];
    double seen; // [m^2] twice the area of the faces as seen along the normal; 2D [m]
} about;

// The gradient of a node's weight, which begins as 0.
static double *gradient_of(about *to, int32_t node) {
    int k = 0;
    while (k < to->count && to->node[k] != node) k++;
    if (k < to->count) return to->gradient[k];
    to->node[to->count++] = node;
    return memset(to->gradient[k], 0, sizeof to->gradient[k]);
}

static inline void add_gradient(about *to, int32_t node, const double by[3], double factor) {
    double *gradient = gradient_of(to, node);
    for (int a = 0; a < 3; a++) gradient[a] += factor * by[a];
}

// A segment: its weights grow along the line across n.
static void add_segment(const brunt_contact_surface *s, const int32_t node[4], const double n[3], about *to) {
    const double along[3] = {-n[1], n[0], 0};
    double e[3];
    between(s->x[node[0]], s->x[node[1]], e);
    const double seen = dot(e, along);
    if (!(seen > 0)) return;
    to->seen += seen;
    add_gradient(to, node[0], along, -1), add_gradient(to, node[1], along, 1);
}

// The triangle of a face at the feature, as it is seen along n: twice its area times the gradients of its weights.
static void add_triangle(const brunt_contact_surface *s, const brunt_feature *f, int32_t face, const double n[3],
                         about *to) {
    const int32_t *node = s->face[face];
    const int count = corners(node), first = corner_of(node, f->end[0]);
    int i = first, j = (first + 1) % count, k = (first + count - 1) % count;
    const bool edge = f->end[1] != f->end[0], centred = edge && count == 4;
    if (edge && node[j] != f->end[1]) i = k, j = first, k = (first + 1) % count;
    const double *p = s->x[node[i]], *q = s->x[node[j]], *r = centred ? s->face_centre[face] : s->x[node[k]];
    double e[3], g[3], c[3], by_q[3], by_r[3];
    between(p, q, e), between(p, r, g);
    cross(e, g, c);
    const double seen = dot(c, n);
    if (!(seen > 0)) return;
    to->seen += seen;
    cross(g, n, by_q), cross(n, e, by_r);
    add_gradient(to, node[i], by_q, -1), add_gradient(to, node[i], by_r, -1);
    add_gradient(to, node[j], by_q, 1);
    for (int m = 0; centred && m < 4; m++) add_gradient(to, node[m], by_r, 0.25);
    if (!centred) add_gradient(to, node[k], by_r, 1);
}

// Those of a quadrilateral's triangles that meet, as they are seen along n.
static void add_sectors(const brunt_contact_surface *s, const brunt_feature *f, const double n[3], about *to) {
    const int32_t *node = s->face[f->face];
    for (int t = 0; t < 4; t++) {
        const brunt_feature edge = {.any = true, .end = {node[t], node[(t + 1) % 4]}};
        if (f->triangles >> t & 1) add_triangle(s, &edge, f->face, n, to);
    }
}

static void add_faces(const brunt_contact_surface *s, const brunt_feature *f, const double n[3], about *to) {
    for (int32_t q = s->face_first[f->end[0]]; q < s->face_first[f->end[0] + 1]; q++) {
        const int32_t *corner = s->face[s->face_of[q]];
        if (corner_of(corner, f->end[1]) < 0 || to->count > BRUNT_FEATURE_NODES - 4) continue;
        if (corner[2] < 0)
            add_segment(s, corner, n, to);
        else
            add_triangle(s, f, s->face_of[q], n, to);
    }
}

int brunt_feature_weights(const brunt_contact_surface *s, const brunt_feature_position *place,
                          int32_t node[BRUNT_FEATURE_NODES], double weight[BRUNT_FEATURE_NODES],
                          double gradient[BRUNT_FEATURE_NODES][3], double *height) {
    const brunt_feature *f = place->feature;
    const double *n = place->n, *x = place->x;
    const double none[3] = {0};
    about to = {.node = node, .gradient = gradient};
    double own[4] = {0.25, 0.25, 0.25, 0.25}, d[3]; // the triangles of a quadrilateral meet at its centre, too
    const int32_t *end = f->triangles ? s->face[f->face] : f->end;
    if (!f->triangles) brunt_feature_values(s, f, x, own);
    for (int k = 0; k < (f->triangles ? 4 : 2); k++) add_gradient(&to, end[k], none, 0);
    const int ends = to.count;
    memcpy(d, x, sizeof d);
    for (int k = 0; k < ends; k++)
        for (int a = 0; a < 3; a++) d[a] -= own[k] * s->x[end[k]][a];
    if (f->triangles)
        add_sectors(s, f, n, &to);
    else
        add_faces(s, f, n, &to);
    *height = dot(d, n);
    for (int k = 0; k < to.count; k++) {
        double rise[3];
        for (int a = 0; a < 3; a++) gradient[k][a] = to.seen > 0 ? gradient[k][a] / to.seen : 0;
        const double extended = dot(gradient[k], d);
        between(s->x[node[0]], s->x[node[k]], rise);
        weight[k] = extended + (k < ends ? own[k] : 0);
        *height -= extended * dot(rise, n);
    }
    return to.count;
}
