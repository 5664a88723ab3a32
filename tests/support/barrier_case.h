// Small contact problems of the barrier for tests: boxes as surfaces, points with nodes of their own or interpolated.
#pragma once

#include "tests/support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/barrier/barrier.h"
#include "tests/support/numbers.h"

enum {
    CASE_VERTICES = 1500,
    CASE_FACETS = 3000,
    CASE_PAIRS = 8,
    CASE_PLANES = 3,
    CASE_PARTICLES = 300,
    CASE_WEIGHTS = 27
};

typedef struct barrier_case {
    int dim;
    bool round;
    int32_t vertices, facets, pairs, planes, particles, bodies, nodes;
    double x[CASE_VERTICES][3];
    int32_t body[CASE_VERTICES], node[CASE_VERTICES], facet[CASE_FACETS][4];
    brunt_barrier_pair pair[CASE_PAIRS];
    brunt_barrier_plane plane[CASE_PLANES];
    double particle_x[CASE_PARTICLES][3], particle_area[CASE_PARTICLES], particle_weight[CASE_PARTICLES * CASE_WEIGHTS];
    int32_t particle_body[CASE_PARTICLES], particle_node[CASE_PARTICLES * CASE_WEIGHTS];
    int64_t particle_first[CASE_PARTICLES + 1];
    double dt, factor, before[3 * (CASE_VERTICES + CASE_PARTICLES * CASE_WEIGHTS)];
    const double *inverse_mass;
    brunt_barrier *barrier;
    int threads;
} barrier_case;

static inline barrier_case *case_begin(int dim) {
    barrier_case *c = calloc(1, sizeof *c);
    c->dim = dim, c->dt = 1e-3, c->factor = 1, c->threads = 1;
    return c;
}

static inline int32_t case_vertex(barrier_case *c, double x, double y, double z, int32_t body) {
    const int32_t v = c->vertices++;
    ck_assert_int_lt(v, CASE_VERTICES);
    c->x[v][0] = x, c->x[v][1] = y, c->x[v][2] = z, c->body[v] = body, c->node[v] = c->nodes++;
    if (body >= c->bodies) c->bodies = body + 1;
    return v;
}

static inline void case_facet(barrier_case *c, int32_t a, int32_t b, int32_t d, int32_t e) {
    ck_assert_int_lt(c->facets, CASE_FACETS);
    int32_t *f = c->facet[c->facets++];
    f[0] = a, f[1] = b, f[2] = d, f[3] = e;
}

// A body's surface: polygon or box of n cells a side from `low` to `high`; 3D of quadrilaterals, or triangles.
static inline void case_polygon(barrier_case *c, int32_t body, const double (*x)[2], int count) {
    const int32_t first = c->vertices;
    for (int i = 0; i < count; i++) case_vertex(c, x[i][0], x[i][1], 0, body);
    for (int i = 0; i < count; i++) case_facet(c, first + i, first + (i + 1) % count, -1, -1);
}

static inline void case_rectangle(barrier_case *c, int32_t body, const double low[2], const double high[2], int n) {
    double x[400][2];
    for (int i = 0; i < n; i++) {
        const double t = (double)i / n;
        x[i][0] = low[0] + t * (high[0] - low[0]), x[i][1] = low[1];
        x[n + i][0] = high[0], x[n + i][1] = low[1] + t * (high[1] - low[1]);
        x[2 * n + i][0] = high[0] - t * (high[0] - low[0]), x[2 * n + i][1] = high[1];
        x[3 * n + i][0] = low[0], x[3 * n + i][1] = high[1] - t * (high[1] - low[1]);
    }
    case_polygon(c, body, (const double(*)[2])x, 4 * n);
}

// The number of the vertex at (i, j, k) of a box of n cells, made when it is asked for first.
static inline int32_t case_box_vertex(barrier_case *c, int32_t body, const double *low, const double *high,
                                      const int at[4], int32_t *made) {
    const int n = at[3];
    int32_t *v = &made[(at[2] * (n + 1) + at[1]) * (n + 1) + at[0]];
    if (*v < 0)
        *v = case_vertex(c, low[0] + (high[0] - low[0]) * at[0] / n, low[1] + (high[1] - low[1]) * at[1] / n,
                         low[2] + (high[2] - low[2]) * at[2] / n, body);
    return *v;
}

static inline void case_box(barrier_case *c, int32_t body, const double low[3], const double high[3], int n,
                            bool triangles) {
    int32_t made[9 * 9 * 9];
    ck_assert_int_le(n, 8);
    memset(made, 0xff, sizeof made);
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++)
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) {
                    int32_t q[4];
                    for (int k = 0; k < 4; k++) {
                        int at[4] = {0, 0, 0, n};
                        at[axis] = side * n;
                        at[(axis + 1) % 3] = i + (k == 1 || k == 2), at[(axis + 2) % 3] = j + (k >= 2);
                        q[k] = case_box_vertex(c, body, low, high, at, made);
                    }
                    if (triangles && (i + j) % 2)
                        case_facet(c, q[0], q[1], q[2], -1), case_facet(c, q[0], q[2], q[3], -1);
                    else if (triangles)
                        case_facet(c, q[0], q[1], q[3], -1), case_facet(c, q[1], q[2], q[3], -1);
                    else
                        case_facet(c, q[0], q[1], q[2], q[3]);
                }
}

// A material point that `weights` nodes carry (1: a node of its own).
static inline void case_particle(barrier_case *c, const double x[3], double area, int32_t body, int weights,
                                 uint64_t *state) {
    const int32_t p = c->particles++;
    ck_assert_int_lt(p, CASE_PARTICLES);
    double sum = 0;
    const int64_t first = c->particle_first[p];
    memcpy(c->particle_x[p], x, sizeof c->particle_x[p]);
    c->particle_area[p] = area, c->particle_body[p] = body, c->particle_first[p + 1] = first + weights;
    if (body >= c->bodies) c->bodies = body + 1;
    for (int i = 0; i < weights; i++) {
        c->particle_node[first + i] = c->nodes++;
        sum += c->particle_weight[first + i] = weights == 1 ? 1 : draw(state) + 0.01;
    }
    for (int i = 0; i < weights; i++) c->particle_weight[first + i] /= sum;
}

static inline brunt_barrier_pair *case_pair(barrier_case *c, int32_t a, int32_t b, double distance, double stiffness) {
    brunt_barrier_pair *p = &c->pair[c->pairs++];
    *p = (brunt_barrier_pair){.a = a, .b = b, .distance = distance, .stiffness = stiffness};
    bool facets[2] = {false, false};
    for (int32_t i = 0; i < c->facets; i++)
        facets[0] |= c->body[c->facet[i][0]] == a, facets[1] |= c->body[c->facet[i][0]] == b;
    brunt_barrier_shares(p, facets[0], facets[1]);
    return p;
}

static inline void case_step(barrier_case *c) {
    const brunt_barrier_step step = {
        .x = (const double(*)[3])c->x,
        .node = c->node,
        .particles = {c->particles, (const double(*)[3])c->particle_x, c->particle_area, c->particle_body,
                      c->particle_first, c->particle_node, c->particle_weight},
        .planes = c->plane,
        .plane_count = c->planes,
        .dt = c->dt,
        .factor = c->factor,
        .before = c->factor == 1 ? NULL : c->before,
        .inverse_mass = c->inverse_mass,
    };
    brunt_error error = {0};
    ck_assert_msg(brunt_barrier_set_step(c->barrier, &step, &error) == BRUNT_OK, "%s", error.message);
}

static inline bool case_meet(const void *self, int32_t a, int32_t b, brunt_barrier_pair *pair) {
    const barrier_case *c = self;
    for (int32_t i = 0; i < c->pairs; i++) {
        if ((c->pair[i].a != a || c->pair[i].b != b) && (c->pair[i].a != b || c->pair[i].b != a)) continue;
        *pair = c->pair[i];
        return true;
    }
    return false;
}

// Ready for terms.
static inline void case_ready(barrier_case *c) {
    brunt_barrier_mesh mesh = {.dim = c->dim,
                               .vertex_count = c->vertices,
                               .facet_count = c->facets,
                               .rest = (const double(*)[3])c->x,
                               .body = c->body,
                               .facet = (const int32_t(*)[4])c->facet,
                               .round = c->round};
    for (int32_t i = 0; i < c->pairs; i++) mesh.overlaps |= c->pair[i].reach > 0;
    brunt_error error = {0};
    c->barrier = brunt_barrier_make(&error);
    ck_assert_msg(brunt_barrier_set_mesh(c->barrier, &mesh, &error) == BRUNT_OK, "%s", error.message);
    brunt_barrier_pair_source source = {.between = case_meet, .self = c};
    for (int32_t i = 0; i < c->pairs; i++) {
        source.range = fmax(source.range, fmax(c->pair[i].distance, 2 * c->pair[i].reach) + c->pair[i].offset);
        source.friction = source.friction || c->pair[i].friction > 0;
    }
    brunt_barrier_set_pairs(c->barrier, &source);
    case_step(c);
}

static inline void case_end(barrier_case *c) {
    brunt_barrier_free(c->barrier);
    free(c);
}

static inline double *case_unknowns(const barrier_case *c) { return calloc((size_t)c->nodes * 3 + 3, sizeof(double)); }

static inline void case_look(barrier_case *c, const double *u, const double *p) {
    const brunt_term term = brunt_barrier_term(c->barrier);
    const brunt_team team = {c->threads, NULL};
    brunt_error error = {0};
    ck_assert_msg(term.ops->look(term.self, &team, u, p, &error) == BRUNT_OK, "%s", error.message);
}

static inline double case_energy(barrier_case *c, brunt_term term, const double *u) {
    const brunt_team team = {c->threads, NULL};
    return term.ops->energy(term.self, &team, u).value;
}

static inline void case_gradient(barrier_case *c, brunt_term term, const double *u, double *g) {
    const brunt_team team = {c->threads, NULL};
    memset(g, 0, (size_t)(c->nodes * c->dim) * sizeof *g);
    term.ops->gradient(term.self, &team, u, g);
}

static inline double case_limit(barrier_case *c, const double *u, const double *p, double largest) {
    const brunt_term term = brunt_barrier_term(c->barrier);
    const brunt_team team = {c->threads, NULL};
    return term.ops->limit(term.self, &team, u, p, largest);
}

static inline void case_lag(barrier_case *c, const double *u) {
    const brunt_team team = {c->threads, NULL};
    brunt_error error = {0};
    ck_assert_int_eq(brunt_barrier_lag(c->barrier, &team, u, &error), BRUNT_OK);
}

// `force`: of the first plane, or where there is none of the first pair that is near; NULL: not wanted.
static inline brunt_barrier_report case_report(barrier_case *c, const double *u, brunt_barrier_force *force) {
    const brunt_team team = {c->threads, NULL};
    brunt_barrier_report report;
    brunt_barrier_forces forces = {.count = 0};
    brunt_error error = {0};
    ck_assert_int_eq(brunt_barrier_look_back(c->barrier, &team, u, u, &report, force ? &forces : NULL, &error),
                     BRUNT_OK);
    if (force) *force = forces.count ? forces.force[0] : (brunt_barrier_force){.area = 0};
    brunt_barrier_forces_free(&forces);
    return report;
}
