#include "penetration.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct mesh {
    int nodes_each, corners, dim;
    int64_t nodes, elements, faces, boundary;
    int32_t *element, (*face)[4], *boundary_node;
    double (*x)[3], (*low)[3], (*high)[3];
    double bounds[2][3];
} mesh;

struct brunt_gap_probe {
    brunt_world *world;
    int32_t count;
    mesh *mesh;
};

static const int tet_faces[4][4] = {{1, 2, 3, -1}, {0, 3, 2, -1}, {0, 1, 3, -1}, {0, 2, 1, -1}};
static const int hex_faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
typedef struct keyed {
    int32_t key[4], face[4];
} keyed;
static int by_int(const void *a, const void *b) {
    return *(const int32_t *)a < *(const int32_t *)b ? -1 : *(const int32_t *)a > *(const int32_t *)b;
}
static int by_key(const void *a, const void *b) { return memcmp(a, b, sizeof(((keyed *)0)->key)); }

static void find_faces(mesh *m) {
    const int count = m->nodes_each == 8 ? 6 : 4, (*table)[4] = m->nodes_each == 8 ? hex_faces : tet_faces;
    keyed *all = calloc((size_t)(m->elements * count), sizeof *all);
    int64_t n = 0;
    for (int64_t e = 0; e < m->elements; e++)
        for (int f = 0; f < count; f++, n++) {
            for (int c = 0; c < 4; c++)
                all[n].face[c] = table[f][c] < 0 ? -1 : m->element[e * m->nodes_each + table[f][c]];
            memcpy(all[n].key, all[n].face, sizeof all[n].key);
            qsort(all[n].key, 4, sizeof(int32_t), by_int);
        }
    qsort(all, (size_t)n, sizeof *all, by_key);
    m->face = calloc((size_t)n + 1, sizeof *m->face);
    char *on = calloc((size_t)m->nodes, 1);
    for (int64_t i = 0; i < n; i++) {
        if (i + 1 < n && !memcmp(all[i].key, all[i + 1].key, sizeof all[i].key)) {
            i++;
            continue;
        }
        memcpy(m->face[m->faces++], all[i].face, sizeof *m->face);
        for (int c = 0; c < 4; c++)
            if (all[i].face[c] >= 0) on[all[i].face[c]] = 1;
    }
    m->boundary_node = calloc((size_t)m->nodes + 1, sizeof *m->boundary_node);
    for (int64_t i = 0; i < m->nodes; i++)
        if (on[i]) m->boundary_node[m->boundary++] = (int32_t)i;
    free(on);
    free(all);
}

brunt_gap_probe *brunt_gap_probe_make(brunt_world *world) {
    brunt_gap_probe *p = calloc(1, sizeof *p);
    p->world = world;
    p->count = brunt_body_count(world);
    p->mesh = calloc((size_t)p->count, sizeof *p->mesh);
    for (int32_t b = 0; b < p->count; b++) {
        mesh *m = &p->mesh[b];
        if (brunt_body_method(world, b) != BRUNT_FEM) continue;
        m->nodes_each = brunt_element_nodes(brunt_body_element(world, b));
        m->nodes = brunt_body_nodes(world, b), m->elements = brunt_body_elements(world, b);
        m->element = calloc((size_t)(m->elements * m->nodes_each), sizeof *m->element);
        brunt_body_connectivity(world, b, m->element);
        m->x = calloc((size_t)m->nodes, sizeof *m->x);
        m->low = calloc((size_t)m->elements, sizeof *m->low), m->high = calloc((size_t)m->elements, sizeof *m->high);
        find_faces(m);
    }
    return p;
}

void brunt_gap_probe_free(brunt_gap_probe *p) {
    for (int32_t b = 0; b < p->count; b++) {
        mesh *m = &p->mesh[b];
        free(m->element), free(m->x), free(m->low), free(m->high), free(m->face), free(m->boundary_node);
    }
    free(p->mesh);
    free(p);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static double triangle_distance2(const double *p0, const double *p1, const double *p2, const double x[3]) {
    double ab[3], ac[3], ap[3], bp[3], cp[3], d[3];
    for (int k = 0; k < 3; k++)
        ab[k] = p1[k] - p0[k], ac[k] = p2[k] - p0[k], ap[k] = x[k] - p0[k], bp[k] = x[k] - p1[k], cp[k] = x[k] - p2[k];
    double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, v = 0, w = 0;
    if (d1 <= 0 && d2 <= 0)
        v = w = 0;
    else if (d3 >= 0 && d4 <= d3)
        v = 1;
    else if (d6 >= 0 && d5 <= d6)
        w = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        v = d1 / (d1 - d3);
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        w = d2 / (d2 - d6);
    else if (va <= 0 && d4 >= d3 && d5 >= d6)
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6)), v = 1 - w;
    else
        v = vb / (va + vb + vc), w = vc / (va + vb + vc);
    for (int k = 0; k < 3; k++) d[k] = ap[k] - v * ab[k] - w * ac[k];
    return dot(d, d);
}

static double surface_distance(const mesh *m, const double x[3]) {
    double best = INFINITY;
    for (int64_t f = 0; f < m->faces; f++) {
        const int32_t *c = m->face[f];
        const double *p = m->x[c[0]];
        double far =
            sqrt((x[0] - p[0]) * (x[0] - p[0]) + (x[1] - p[1]) * (x[1] - p[1]) + (x[2] - p[2]) * (x[2] - p[2]));
        double size = 0;
        for (int k = 1; k < 4 && c[k] >= 0; k++) {
            const double *q = m->x[c[k]];
            size = fmax(size,
                        (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
        }
        if (far - sqrt(size) > sqrt(best)) continue;
        if (c[3] < 0) {
            best = fmin(best, triangle_distance2(p, m->x[c[1]], m->x[c[2]], x));
            continue;
        }
        double middle[3]; // a quadrilateral is the four triangles about its centre
        for (int k = 0; k < 3; k++) middle[k] = 0.25 * (p[k] + m->x[c[1]][k] + m->x[c[2]][k] + m->x[c[3]][k]);
        for (int t = 0; t < 4; t++) best = fmin(best, triangle_distance2(m->x[c[t]], m->x[c[(t + 1) % 4]], middle, x));
    }
    return sqrt(best);
}

static int in_tet(const double *p0, const double *p1, const double *p2, const double *p3, const double x[3]) {
    double a[3][3], r[3];
    for (int k = 0; k < 3; k++)
        r[k] = x[k] - p0[k], a[0][k] = p1[k] - p0[k], a[1][k] = p2[k] - p0[k], a[2][k] = p3[k] - p0[k];
#define DET(u, v, w)                                                                                                   \
    ((u)[0] * ((v)[1] * (w)[2] - (v)[2] * (w)[1]) - (u)[1] * ((v)[0] * (w)[2] - (v)[2] * (w)[0]) +                     \
     (u)[2] * ((v)[0] * (w)[1] - (v)[1] * (w)[0]))
    double d = DET(a[0], a[1], a[2]), u = DET(r, a[1], a[2]) / d, v = DET(a[0], r, a[2]) / d,
           w = DET(a[0], a[1], r) / d;
    return u >= 0 && v >= 0 && w >= 0 && u + v + w <= 1;
}

// A hexahedron is the 24 tetrahedra between its centre and the triangles of its faces.
static int in_hex(const mesh *m, const int32_t *c, const double x[3]) {
    double centre[3] = {0};
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 8; n++) centre[k] += m->x[c[n]][k] / 8;
    for (int f = 0; f < 6; f++) {
        double middle[3] = {0};
        for (int k = 0; k < 3; k++)
            for (int n = 0; n < 4; n++) middle[k] += m->x[c[hex_faces[f][n]]][k] / 4;
        for (int n = 0; n < 4; n++)
            if (in_tet(centre, middle, m->x[c[hex_faces[f][n]]], m->x[c[hex_faces[f][(n + 1) % 4]]], x)) return 1;
    }
    return 0;
}

static int inside(const mesh *m, const double x[3]) {
    for (int64_t e = 0; e < m->elements; e++) {
        if (x[0] < m->low[e][0] || x[0] > m->high[e][0] || x[1] < m->low[e][1] || x[1] > m->high[e][1] ||
            x[2] < m->low[e][2] || x[2] > m->high[e][2])
            continue;
        const int32_t *c = m->element + e * m->nodes_each;
        if (m->nodes_each == 8 ? in_hex(m, c, x) : in_tet(m->x[c[0]], m->x[c[1]], m->x[c[2]], m->x[c[3]], x)) return 1;
    }
    return 0;
}

static void update(brunt_gap_probe *p) {
    for (int32_t b = 0; b < p->count; b++) {
        mesh *m = &p->mesh[b];
        if (!m->nodes) continue;
        brunt_body_read(p->world, b, brunt_body_find_field(p->world, b, "position"), (double *)m->x);
        for (int k = 0; k < 3; k++) m->bounds[0][k] = INFINITY, m->bounds[1][k] = -INFINITY;
        for (int64_t e = 0; e < m->elements; e++)
            for (int k = 0; k < 3; k++) {
                double low = INFINITY, high = -INFINITY;
                for (int c = 0; c < m->nodes_each; c++)
                    low = fmin(low, m->x[m->element[e * m->nodes_each + c]][k]),
                    high = fmax(high, m->x[m->element[e * m->nodes_each + c]][k]);
                m->low[e][k] = low, m->high[e][k] = high;
                m->bounds[0][k] = fmin(m->bounds[0][k], low), m->bounds[1][k] = fmax(m->bounds[1][k], high);
            }
    }
}

void brunt_gap_measure(brunt_gap_probe *p, double *depth, double *distance) {
    *depth = 0, *distance = INFINITY;
    update(p);
    for (int32_t a = 0; a < p->count; a++)
        for (int32_t b = 0; b < p->count; b++) {
            const mesh *m = &p->mesh[a], *o = &p->mesh[b];
            if (a == b || !m->nodes || !o->nodes) continue;
            for (int64_t i = 0; i < m->boundary; i++) {
                const double *x = m->x[m->boundary_node[i]];
                double outside = 0;
                for (int k = 0; k < 3; k++)
                    outside = fmax(outside, fmax(o->bounds[0][k] - x[k], x[k] - o->bounds[1][k]));
                if (outside > *distance) continue;
                double d = surface_distance(o, x);
                if (outside <= 0 && inside(o, x))
                    *depth = fmax(*depth, d);
                else
                    *distance = fmin(*distance, d);
            }
        }
}
