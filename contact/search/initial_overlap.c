#include "contact/planes/condition.h"
#include "contact/search/initial_overlap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/distance/point_facet.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/sweep.h"
#include "mpm/particles.h"

static const double BEHIND = 1e-3;    // edges or spacings: how far behind a plane a body is behind it
static const double CUT = 1e-3;       // edges on either side from which on an edge goes through a facet ...
static const double RIM = 1e-6;       // ... and share of a triangle that is its rim
static const double NEXT = 1.25;      // edges: nodes so near to a membrane tell on which sides of it a body is
static const double SPACING = 0.5;    // of the other body's elements: how close a long facet is looked at
static const double FARTHEST = 1e150; // [m] squares of distances are still numbers
enum { PIECE_LIMIT = 64 };

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// ------------------------------------------------------------------------------------------ boxes and cells

typedef struct box {
    double low[3], high[3];
} box;

static box empty_box(void) { return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}; }

static void widen(box *b, const double x[3]) {
    for (int a = 0; a < 3; a++) b->low[a] = fmin(b->low[a], x[a]), b->high[a] = fmax(b->high[a], x[a]);
}

static box grown(box b, int dim, double by) {
    for (int a = 0; a < dim; a++) b.low[a] -= by, b.high[a] += by;
    return b;
}

// What two boxes share; false when that is nothing.
static bool common(const box *p, const box *q, box *out) {
    for (int a = 0; a < 3; a++) {
        out->low[a] = fmax(p->low[a], q->low[a]), out->high[a] = fmin(p->high[a], q->high[a]);
        if (!(out->low[a] <= out->high[a])) return false;
    }
    return true;
}

static bool holds(const box *b, const double x[3]) {
    for (int a = 0; a < 3; a++)
        if (x[a] < b->low[a] || x[a] > b->high[a]) return false;
    return true;
}

// A room in cells, with what reaches into each.
typedef struct cells {
    box bounds;
    double edge;
    int32_t n[3], count;
    int32_t *first, *item;
    size_t first_capacity, item_capacity;
} cells;

static void size_cells(cells *c, const box *bounds, double edge, int32_t items) {
    c->bounds = *bounds;
    double widest = 0;
    for (int a = 0; a < 3; a++) widest = fmax(widest, bounds->high[a] - bounds->low[a]);
    c->edge = widest < FARTHEST ? fmax(edge, 1e-9 * widest) : INFINITY; // one cell
    c->edge = c->edge > 0 ? c->edge : 1;
    for (;; c->edge *= 1.25) {
        double count = 1;
        for (int a = 0; a < 3; a++) {
            c->n[a] = isinf(c->edge) ? 1 : (int32_t)floor((bounds->high[a] - bounds->low[a]) / c->edge) + 1;
            count *= c->n[a];
        }
        if (!(count > 4.0 * items + 64)) break;
    }
    c->count = c->n[0] * c->n[1] * c->n[2];
}

static int32_t cell_along(const cells *c, int a, double x) {
    return (int32_t)fmin(fmax(floor((x - c->bounds.low[a]) / c->edge), 0), c->n[a] - 1);
}

static int32_t cell_at(const cells *c, const double x[3]) {
    return (cell_along(c, 0, x[0]) * c->n[1] + cell_along(c, 1, x[1])) * c->n[2] + cell_along(c, 2, x[2]);
}

// Counts, or lists, item `i` in the cells that its box reaches.
static void list_facets(cells *c, const box *b, int32_t i, bool list) {
    box in;
    if (!common(b, &c->bounds, &in)) return;
    int32_t from[3], to[3];
    for (int a = 0; a < 3; a++) from[a] = cell_along(c, a, in.low[a]), to[a] = cell_along(c, a, in.high[a]);
    for (int32_t x = from[0]; x <= to[0]; x++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            for (int32_t z = from[2]; z <= to[2]; z++) {
                const int32_t cell = (x * c->n[1] + y) * c->n[2] + z;
                if (list)
                    c->item[c->first[cell + 1]++] = i;
                else
                    c->first[cell + 2]++;
            }
}

typedef bool box_fn(const void *context, int32_t i, box *out); // false: it is nowhere

static int fill_cells(cells *c, const box *bounds, double edge, int32_t items, box_fn *box_of, const void *context,
                      brunt_error *error) {
    size_cells(c, bounds, edge, items);
    if (BRUNT_CAPACITY(c->first, (size_t)c->count + 3, 0, "cells of what may overlap", error)) return BRUNT_FAILED;
    memset(c->first, 0, ((size_t)c->count + 3) * sizeof *c->first);
    box b;
    for (int32_t i = 0; i < items; i++)
        if (box_of(context, i, &b)) list_facets(c, &b, i, false);
    for (int32_t k = 2; k <= c->count + 1; k++) c->first[k] += c->first[k - 1];
    if (BRUNT_CAPACITY(c->item, (size_t)c->first[c->count + 1] + 1, 0, "elements and facets that may overlap", error))
        return BRUNT_FAILED;
    for (int32_t i = 0; i < items; i++)
        if (box_of(context, i, &b)) list_facets(c, &b, i, true);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ one body in another

typedef struct search_job {
    const brunt_contact_context *m;
    const brunt_overlap_rule *rule;
    int k;        // the other body, of the surface
    double by;    // its facets reach so much further than they are [m]
    double size;  // of what it is made of: its elements, or all of it [m]
    double limit; // [m] what is no deeper is no overlap
    bool shares;  // the two bodies some room
    cells elements, facets;
    brunt_overlap *found;
} search_job;

static const double *corner(const brunt_fem_body *fem, int32_t slot, int c, double out[3]) {
    const real *at = brunt_fem_node(fem, fem->element_node[(size_t)slot * (size_t)fem->traits->nodes + (size_t)c]);
    for (int a = 0; a < 3; a++) out[a] = (double)at[a];
    return out;
}

static bool element_box(const void *context, int32_t slot, box *out) {
    const search_job *j = context;
    const brunt_fem_body *fem = j->m->surface->fem[j->k];
    if (fem->element_id[slot] < 0) return false; // padding
    double x[3];
    *out = empty_box();
    for (int c = 0; c < fem->traits->nodes; c++) widen(out, corner(fem, slot, c, x));
    return true;
}

static bool facet_box(const void *context, int32_t i, box *out) {
    const search_job *j = context;
    const brunt_contact_surface *s = j->m->surface;
    const double *b = s->face_box[s->face_range[j->k] + i];
    memcpy(out->low, b, sizeof out->low), memcpy(out->high, b + 3, sizeof out->high);
    *out = grown(*out, s->dim, j->by);
    return true;
}

// Six times the volume of a, b, c, d; of triangles (dim 2) twice the area of a, b, c.
static double size_of(int dim, const double a[3], const double b[3], const double c[3], const double d[3]) {
    const double p[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    if (dim == 2) return p[0] * q[1] - p[1] * q[0];
    const double r[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
}

static bool in_simplex(int dim, const double *const p[4], const double x[3]) {
    const double whole = size_of(dim, p[0], p[1], p[2], p[3]);
    for (int c = 0; c <= dim; c++) {
        const double *q[4] = {p[0], p[1], p[2], p[3]};
        q[c] = x;
        if (!(size_of(dim, q[0], q[1], q[2], q[3]) * whole >= 0)) return false;
    }
    return whole != 0;
}

static bool in_element(const brunt_fem_body *fem, int32_t slot, const double x[3]) {
    static const int triangle[2][4] = {{0, 1, 2, 0}, {0, 2, 3, 0}};
    static const int tetrahedron[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                          {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
    const int nodes = fem->traits->nodes, dim = fem->traits->dimension;
    const int parts = dim == 2 ? nodes - 2 : nodes == 8 ? 6 : 1;
    for (int q = 0; q < parts; q++) {
        const int *of = dim == 2 ? triangle[q] : tetrahedron[q];
        double at[4][3];
        const double *p[4];
        for (int c = 0; c < 4; c++) p[c] = corner(fem, slot, nodes == 4 && dim == 3 ? c : of[c], at[c]);
        if (in_simplex(dim, p, x)) return true;
    }
    return false;
}

// Distance of x from the facets listed near it [m], and how far before the nearest it is; INFINITY when there are none.
static double distance(const search_job *j, const double x[3], double *height) {
    const brunt_contact_surface *s = j->m->surface;
    const int32_t cell = cell_at(&j->facets, x);
    double least = INFINITY;
    for (int32_t q = j->facets.first[cell]; q < j->facets.first[cell + 1]; q++) {
        const brunt_closest at = brunt_closest_on_face(s, s->face_range[j->k] + j->facets.item[q], x);
        if (!(at.square < least)) continue;
        least = at.square, *height = dot(at.normal, at.d);
    }
    return sqrt(least);
}

static bool in_elements(const search_job *j, const double x[3]) {
    if (!holds(&j->elements.bounds, x)) return false;
    const int32_t cell = cell_at(&j->elements, x);
    for (int32_t q = j->elements.first[cell]; q < j->elements.first[cell + 1]; q++)
        if (in_element(j->m->surface->fem[j->k], j->elements.item[q], x)) return true;
    return false;
}

// Whether x is in an element of the other body, and with its `extent` deeper than the limit.
static bool is_deep(search_job *j, const double x[3], double extent) {
    const brunt_contact_surface *s = j->m->surface;
    double height, least = INFINITY;
    if (!in_elements(j, x) || !(extent + distance(j, x, &height) > j->limit)) return false;
    for (int32_t f = s->face_range[j->k]; f < s->face_end[j->k]; f++)
        least = fmin(least, brunt_closest_on_face(s, f, x).square);
    j->found->depth = extent + sqrt(least);
    memcpy(j->found->x, x, sizeof j->found->x);
    return true;
}

// ------------------------------------------------------------------------------------------ meshes

static box surface_box(const brunt_contact_surface *s, int k) {
    box b;
    memcpy(b.low, s->low[k], sizeof b.low), memcpy(b.high, s->high[k], sizeof b.high);
    return b;
}

static int corners(const int32_t face[4]) { return face[2] < 0 ? 2 : face[3] < 0 ? 3 : 4; }

// Calls for the edges of a body's facets; those of two facets twice. Whether any call said true.
typedef bool edge_fn(search_job *j, const double p[3], const double q[3]);
static bool any_edge(search_job *j, int other, edge_fn *visit) {
    const brunt_contact_surface *s = j->m->surface;
    for (int32_t f = s->face_range[other]; f < s->face_end[other]; f++) {
        const int n = corners(s->face[f]);
        for (int c = 0; c < (n == 2 ? 1 : n); c++)
            if (visit(j, s->x[s->face[f][c]], s->x[s->face[f][(c + 1) % n]])) return true;
    }
    return false;
}

static double pieces_of(const double p[3], const double q[3], double size) {
    const double e[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    return fmin(fmax(ceil(sqrt(dot(e, e)) / size), 1), PIECE_LIMIT);
}

// A facet that is long for the other body may go through it between its nodes: places on it, of a triangle as of a
// quadrilateral with two corners in one place.
static bool facet_is_deep(search_job *j, int32_t f) {
    const brunt_contact_surface *s = j->m->surface;
    const int32_t *node = s->face[f];
    const int n = corners(node);
    const double *p = s->x[node[0]], *q = s->x[node[1]], *r = n == 2 ? q : s->x[node[2]],
                 *t = n == 2   ? p
                      : n == 3 ? s->x[node[2]]
                               : s->x[node[3]],
                 size = SPACING * j->size;
    const double along = fmax(pieces_of(p, q, size), pieces_of(t, r, size)),
                 across = fmax(pieces_of(p, t, size), pieces_of(q, r, size));
    for (double i = 0; i <= along; i++)
        for (double k = 0; k <= across && along + across > 2; k++) {
            const double u = i / along, v = k / across;
            double x[3];
            for (int a = 0; a < 3; a++) x[a] = (1 - v) * ((1 - u) * p[a] + u * q[a]) + v * ((1 - u) * t[a] + u * r[a]);
            if (is_deep(j, x, 0)) return true;
        }
    return false;
}

// Bodies in one place, or with sides in common, have no node in each other: the middles of their elements have.
static bool element_is_deep(search_job *j, const brunt_fem_body *fem) {
    for (int32_t slot = 0; slot < fem->slots && !fem->traits->membrane; slot++) {
        if (fem->element_id[slot] < 0) continue;
        double x[3] = {0}, at[3];
        for (int c = 0; c < fem->traits->nodes; c++) {
            corner(fem, slot, c, at);
            for (int a = 0; a < 3; a++) x[a] += at[a] / fem->traits->nodes;
        }
        if (is_deep(j, x, 0)) return true;
    }
    return false;
}

// Whether the surface of body `other`, or an element of it, is in the solid body k.
static bool mesh_is_deep(search_job *j, int other) {
    const brunt_contact_surface *s = j->m->surface;
    if (element_is_deep(j, s->fem[other])) return true;
    for (int32_t n = s->node_range[other]; n < s->node_end[other]; n++)
        if (is_deep(j, s->x[n], 0)) return true;
    for (int32_t f = s->face_range[other]; f < s->face_end[other]; f++) {
        const double *b = s->face_box[f];
        box of_face, in;
        memcpy(of_face.low, b, sizeof of_face.low), memcpy(of_face.high, b + 3, sizeof of_face.high);
        if (common(&of_face, &j->elements.bounds, &in) && facet_is_deep(j, f)) return true;
    }
    return false;
}

// The angle of the triangle that is about where an edge goes through it: all of the circle inside, half of it on a rim,
// its own at a corner; 0 where the edge misses it.
static double angle_about(const double *const t[3], const double p[3], const double q[3], double least) {
    double a[3], b[3], n[3], d[2] = {0}, x[3], share[3];
    for (int k = 0; k < 3; k++) a[k] = t[1][k] - t[0][k], b[k] = t[2][k] - t[0][k];
    for (int k = 0; k < 3; k++) n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    const double size = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) d[0] += (p[k] - t[0][k]) * n[k] / size, d[1] += (q[k] - t[0][k]) * n[k] / size;
    if (!(d[0] * d[1] < 0) || !(fabs(d[0]) > least) || !(fabs(d[1]) > least)) return 0;
    for (int k = 0; k < 3; k++) x[k] = p[k] + d[0] / (d[0] - d[1]) * (q[k] - p[k]);
    int on = 0, off = 0; // rims it is on; the corner it is not next to, or the last that it is
    for (int c = 0; c < 3; c++) {
        const double *u = t[(c + 1) % 3], *v = t[(c + 2) % 3];
        const double e[3] = {u[0] - x[0], u[1] - x[1], u[2] - x[2]}, g[3] = {v[0] - x[0], v[1] - x[1], v[2] - x[2]};
        share[c] = 0;
        for (int k = 0; k < 3; k++)
            share[c] += (e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3]) * n[k] / (size * size);
        if (share[c] < -RIM) return 0;
        if (share[c] < RIM)
            on++;
        else
            off = c;
    }
    if (on < 2) return on ? M_PI : 2 * M_PI;
    const double *at = t[off], *u = t[(off + 1) % 3], *v = t[(off + 2) % 3];
    const double e[3] = {u[0] - at[0], u[1] - at[1], u[2] - at[2]}, g[3] = {v[0] - at[0], v[1] - at[1], v[2] - at[2]};
    return acos(fmax(-1, fmin(1, dot(e, g) / sqrt(dot(e, e) * dot(g, g)))));
}

// Whether an edge goes through the membrane k: there are facets all around the place, else it passes along the border.
static bool edge_cuts(search_job *j, const double p[3], const double q[3]) {
    const brunt_contact_surface *s = j->m->surface;
    const double least = CUT * s->fem[j->k]->mean_edge;
    double angle = 0;
    for (int32_t f = s->face_range[j->k]; f < s->face_end[j->k]; f++) {
        const double *b = s->face_box[f];
        const int32_t *node = s->face[f];
        bool apart = false;
        for (int a = 0; a < 3; a++)
            apart = apart || fmin(p[a], q[a]) > b[3 + a] + least || fmax(p[a], q[a]) < b[a] - least;
        for (int t = 1; t < corners(node) - 1 && !apart; t++) {
            const double *corner[3] = {s->x[node[0]], s->x[node[t]], s->x[node[t + 1]]};
            angle += angle_about(corner, p, q, least);
        }
    }
    if (!(angle > 1.5 * M_PI)) return false;
    for (int a = 0; a < 3; a++) j->found->x[a] = 0.5 * (p[a] + q[a]);
    return true;
}

// Whether the membrane k cuts body `other`: edges go through it, and there are nodes well on either side.
static bool is_cut(search_job *j, int other) {
    const brunt_contact_surface *s = j->m->surface;
    double side[2] = {0};
    for (int32_t n = s->node_range[other]; n < s->node_end[other]; n++) {
        double height = 0;
        if (!holds(&j->facets.bounds, s->x[n])) continue;
        const double d = distance(j, s->x[n], &height);
        if (!(height * height >= 0.5 * d * d)) continue; // beyond the border
        side[height > 0] = fmax(side[height > 0], fabs(height));
    }
    j->found->depth = fmin(side[0], side[1]);
    return j->found->depth > j->limit && any_edge(j, other, edge_cuts);
}

// A mesh's mean edge, or how thin all of it is [m].
static double size_of_body(const brunt_contact_surface *s, int k) {
    double size = s->fem[k]->mean_edge;
    for (int a = 0; a < s->dim && !s->fem[k]->traits->membrane; a++) size = fmin(size, s->high[k][a] - s->low[k][a]);
    return size;
}

// Facets, and elements of a solid, near what the other body's box shares with its own, if it does (`shares`).
static int look_at(search_job *j, int k, const box *other, double limit, double by, brunt_error *error) {
    const brunt_contact_surface *s = j->m->surface;
    const brunt_fem_body *fem = s->fem[k];
    const box own = grown(surface_box(s, k), s->dim, fem->traits->membrane ? by : -limit);
    box bounds;
    if (!(j->shares = common(&own, other, &bounds))) return BRUNT_OK;
    j->k = k, j->limit = limit, j->by = by, j->size = size_of_body(s, k);
    if (fill_cells(&j->facets, &bounds, fem->mean_edge, s->face_end[k] - s->face_range[k], facet_box, j, error))
        return BRUNT_FAILED;
    if (fem->traits->membrane) return BRUNT_OK;
    return fill_cells(&j->elements, &bounds, fem->mean_edge, fem->slots, element_box, j, error);
}

// Finds out whether mesh `other` is in mesh or membrane `k`.
static int meshes_overlap(search_job *j, int other, int k, brunt_error *error) {
    const brunt_contact_surface *s = j->m->surface;
    const double edge = s->fem[other]->mean_edge,
                 limit = j->rule->least * fmin(size_of_body(s, other), size_of_body(s, k));
    const box of_other = surface_box(s, other);
    const bool membrane = s->fem[k]->traits->membrane;
    if (look_at(j, k, &of_other, limit, membrane ? NEXT * edge : limit, error)) return BRUNT_FAILED;
    j->found->any = j->shares && (membrane ? is_cut(j, other) : mesh_is_deep(j, other));
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ material points

static void particle_at(brunt_body *body, int64_t i, double x[3]) {
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    for (int a = 0; a < 3; a++) x[a] = a < body->grid.dim ? (double)place[a][i] : 0;
}

static double extent_of(brunt_body *body, int64_t i) {
    return (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][i];
}

static bool is_point(brunt_body *body, int64_t i) {
    return brunt_field(&body->particles, BRUNT_FIELD_reference_volume)[0][i] > 0; // else it is padding
}

static double extent_in(const search_job *j, brunt_body *body, int64_t i) {
    return j->rule->centres ? 0 : extent_of(body, i);
}

// Whether a particle's centre is in the solid, or so near its surface that its reach is.
static bool point_is_deep(search_job *j, const double x[3], double extent) {
    double height;
    if (is_deep(j, x, extent)) return true;
    const double d = holds(&j->facets.bounds, x) ? distance(j, x, &height) : INFINITY;
    if (!(d < extent - j->limit)) return false;
    j->found->depth = extent - d;
    memcpy(j->found->x, x, sizeof j->found->x);
    return true;
}

static bool solid_holds_points(search_job *j, brunt_body *body) {
    double x[3];
    for (int64_t i = 0; i < body->particles.slots; i++) {
        particle_at(body, i, x);
        if (is_point(body, i) && point_is_deep(j, x, extent_in(j, body, i))) return true;
    }
    return false;
}

// Whether a membrane lies in particles of a body that is on both its sides.
static bool membrane_cuts_points(search_job *j, brunt_body *body) {
    bool side[2] = {false, false};
    for (int64_t i = 0; i < body->particles.slots; i++) {
        double x[3], height = 0;
        particle_at(body, i, x);
        if (!is_point(body, i) || !holds(&j->facets.bounds, x)) continue;
        const double d = distance(j, x, &height), depth = extent_in(j, body, i) - d;
        if (!(height * height >= 0.5 * d * d)) continue; // beyond the border
        side[height > 0] = true;
        if (!(depth > j->found->depth)) continue;
        j->found->depth = depth;
        memcpy(j->found->x, x, sizeof j->found->x);
    }
    return side[0] && side[1] && j->found->depth > j->limit;
}

// Finds out whether material points are in mesh or membrane k.
static int points_overlap(search_job *j, brunt_body *body, int k, brunt_error *error) {
    const brunt_contact_surface *s = j->m->surface;
    const bool membrane = s->fem[k]->traits->membrane;
    box of_points = empty_box();
    double x[3];
    if (!j->rule->centres && !body->particles.field[BRUNT_FIELD_reach].components) return BRUNT_OK;
    for (int64_t i = 0; i < body->particles.slots; i++)
        if (is_point(body, i)) particle_at(body, i, x), widen(&of_points, x);
    const double by = (membrane ? NEXT : 1) * body->spacing;
    if (look_at(j, k, &of_points, -by, by, error)) return BRUNT_FAILED;
    j->limit = j->rule->least * fmin(body->spacing, size_of_body(s, k));
    j->found->any = j->shares && (membrane ? membrane_cuts_points(j, body) : solid_holds_points(j, body));
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ planes

static bool keep_behind(const brunt_plane_def *plane, const double x[3], double extent, double greatest,
                        brunt_overlap *found) {
    double d = -extent, far = 0;
    for (int a = 0; a < 3; a++) d += plane->normal[a] * (x[a] - plane->point[a]), far = fmax(far, fabs(x[a]));
    if (!(-d > greatest + 1e-6 * far) || !(-d > found->depth)) return false;
    found->depth = -d;
    memcpy(found->x, x, sizeof found->x);
    return true;
}

// Whether nothing moves a node but what is prescribed.
static bool is_held(const brunt_contact_surface *s, int32_t n) {
    return !(s->inverse[n][0] + s->inverse[n][1] + s->inverse[n][2] > 0);
}

// The deepest place of a body behind a plane that pushes it, if there is one.
static void find_behind(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, int w, brunt_overlap *found) {
    const brunt_contact_surface *s = m->surface;
    const brunt_boundary *boundary = &m->boundaries[w];
    if (!brunt_boundary_pushes(boundary)) return;
    *found = (brunt_overlap){.b = -1, .boundary = w};
    int k, end;
    brunt_surface_meshes(s, boundary->body, &k, &end);
    for (; k < end; k++)
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++)
            if (!is_held(s, n) && keep_behind(&boundary->plane, s->x[n], 0, BEHIND * s->fem[k]->mean_edge, found))
                found->a = s->fem[k]->index, found->any = true;
    for (int i = 0; i < mpm_count; i++) {
        if (boundary->body >= 0 && boundary->body != mpm[i].index) continue;
        if (!mpm[i].particles.field[BRUNT_FIELD_reach].components) continue; // no plane pushes it
        for (int64_t p = 0; p < mpm[i].particles.slots; p++) {
            double x[3];
            particle_at(&mpm[i], p, x);
            if (keep_behind(&boundary->plane, x, extent_of(&mpm[i], p), BEHIND * mpm[i].spacing, found))
                found->a = mpm[i].index, found->any = true;
        }
    }
}

// ------------------------------------------------------------------------------------------ all

// Bounds of each mesh and then of each body of points, so wide that what is apart is not even looked at.
static void bound_bodies(const brunt_contact_surface *s, brunt_body *mpm, int mpm_count, brunt_box *out) {
    for (int k = 0; k < s->fem_count + mpm_count; k++) {
        brunt_body *points = k < s->fem_count ? NULL : &mpm[k - s->fem_count];
        box b = points ? empty_box() : surface_box(s, k);
        double x[3];
        for (int64_t i = 0; points && i < points->particles.slots; i++) particle_at(points, i, x), widen(&b, x);
        b = grown(b, s->dim, NEXT * (points ? points->spacing : (double)s->fem[k]->mean_edge));
        memcpy(out[k].low, b.low, sizeof b.low), memcpy(out[k].high, b.high, sizeof b.high);
    }
}

// One of the bodies in the other mesh.
typedef struct candidate_pair {
    int32_t mesh, other; // by place among the boxes
} candidate_pair;

static int compare_candidates(const void *left, const void *right) {
    const candidate_pair *p = left, *q = right;
    if (p->mesh != q->mesh) return p->mesh < q->mesh ? -1 : 1;
    return (p->other > q->other) - (p->other < q->other);
}

// Which bodies are near which meshes, ascending, and their count.
static int list_candidates(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, candidate_pair **list,
                           int64_t *found, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    const int32_t count = s->fem_count + mpm_count;
    brunt_box *boxes;
    brunt_box_pair *near;
    int64_t pairs;
    *list = NULL, *found = 0;
    if (BRUNT_NEW(boxes, count + 1, "boxes about bodies", error)) return BRUNT_FAILED;
    bound_bodies(s, mpm, mpm_count, boxes);
    int status = brunt_sweep(boxes, s->fem_count, count, &near, &pairs, error);
    brunt_free(boxes);
    if (!status) status = BRUNT_NEW(*list, 2 * (pairs + 1), "bodies near meshes", error);
    for (int64_t q = 0; !status && q < pairs; q++) {
        (*list)[(*found)++] = (candidate_pair){near[q].a, near[q].b};
        if (near[q].b < s->fem_count) (*list)[(*found)++] = (candidate_pair){near[q].b, near[q].a};
    }
    brunt_free(near);
    if (!status) qsort(*list, (size_t)*found, sizeof **list, compare_candidates);
    return status;
}

static int find_in_meshes(search_job *j, brunt_body *mpm, int mpm_count, brunt_error *error) {
    const brunt_contact_surface *s = j->m->surface;
    if (!s->fem_count) return BRUNT_OK;
    candidate_pair *list;
    int64_t count;
    int status = list_candidates(j->m, mpm, mpm_count, &list, &count, error);
    for (int64_t q = 0; q < count && !status && !j->found->any; q++) {
        const int k = list[q].mesh, i = list[q].other;
        const int b = s->fem[k]->index, a = i < s->fem_count ? s->fem[i]->index : mpm[i - s->fem_count].index;
        if (!j->rule->meets(j->rule->self, a, b)) continue;
        *j->found = (brunt_overlap){.a = a, .b = b, .boundary = -1};
        status =
            i < s->fem_count ? meshes_overlap(j, i, k, error) : points_overlap(j, &mpm[i - s->fem_count], k, error);
    }
    brunt_free(list);
    return status;
}

int brunt_overlap_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, int boundary_count,
                       const brunt_overlap_rule *rule, brunt_overlap *found, brunt_error *error) {
    search_job j = {.m = m, .rule = rule, .found = found};
    *found = (brunt_overlap){.b = -1, .boundary = -1};
    int status = find_in_meshes(&j, mpm, mpm_count, error);
    cells *made[] = {&j.elements, &j.facets};
    for (int k = 0; k < 2; k++) brunt_free(made[k]->first), brunt_free(made[k]->item);
    for (int w = 0; w < boundary_count && !status && !found->any; w++) find_behind(m, mpm, mpm_count, w, found);
    return status;
}
