// Meshes of boxes and single elements, bodies made of them, and their steps, for the tests of finite elements.
#pragma once

#include "tests/support/suite.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fem/fem_body.h"
#include "base/memory.h"

static uint64_t random_state = 1;
static inline double uniform(double low, double high) {
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(random_state >> 11) / 9007199254740992.0;
}

static const int hex_corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int tet_of_cube[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                      {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
static const int triangle_of_square[2][3] = {{0, 1, 2}, {0, 2, 3}};

// n cells along each axis of a box [0, size]^dim. `jitter` [-] of a cell moves inner nodes, and outer ones too if
// `all`.
static inline brunt_mesh box_mesh(brunt_element_kind kind, int n, double size, double jitter, bool all) {
    const int dim = brunt_element_dimension(kind), nodes = brunt_element_nodes(kind), m = n + 1;
    const int parts = kind == BRUNT_TET4   ? 6
                      : kind == BRUNT_TRI3 ? 2
                                           : 1,
              layers = dim == 3 ? n : 1, mz = dim == 3 ? m : 1;
    brunt_mesh mesh = {.kind = kind, .node_count = m * m * mz, .element_count = n * n * layers * parts};
    mesh.nodes = brunt_alloc((size_t)mesh.node_count * sizeof *mesh.nodes);
    mesh.elements = brunt_alloc((size_t)mesh.element_count * (size_t)nodes * sizeof *mesh.elements);
    for (int z = 0, k = 0; z < mz; z++)
        for (int y = 0; y < m; y++)
            for (int x = 0; x < m; x++, k++) {
                const int at[3] = {x, y, z};
                bool inner = true;
                for (int a = 0; a < dim; a++) inner = inner && at[a] > 0 && at[a] < n;
                for (int a = 0; a < dim; a++)
                    mesh.nodes[k][a] = size * (at[a] + (inner || all ? jitter * uniform(-1, 1) : 0)) / n;
            }
    int32_t *out = mesh.elements;
    for (int z = 0; z < layers; z++)
        for (int y = 0; y < n; y++)
            for (int x = 0; x < n; x++) {
                int32_t corner[8];
                for (int c = 0; c < (dim == 3 ? 8 : 4); c++)
                    corner[c] = ((z + hex_corner[c][2]) * m + y + hex_corner[c][1]) * m + x + hex_corner[c][0];
                for (int p = 0; p < parts; p++)
                    for (int a = 0; a < nodes; a++)
                        *out++ = corner[kind == BRUNT_TET4   ? tet_of_cube[p][a]
                                        : kind == BRUNT_TRI3 ? triangle_of_square[p][a]
                                                             : a];
            }
    return mesh;
}

// One element, or a few by the names of their nodes.
static inline brunt_mesh single_mesh(brunt_element_kind kind, const double (*x)[3]) {
    int nodes = brunt_element_nodes(kind);
    brunt_mesh mesh = {.kind = kind, .node_count = nodes, .element_count = 1};
    mesh.nodes = brunt_alloc((size_t)nodes * sizeof *mesh.nodes);
    mesh.elements = brunt_alloc((size_t)nodes * sizeof *mesh.elements);
    for (int a = 0; a < nodes; a++) {
        memcpy(mesh.nodes[a], x[a], sizeof x[a]);
        mesh.elements[a] = a;
    }
    return mesh;
}

static const double E = 2e6, nu = 0.3, density = 1000;

static inline brunt_material material_of(const char *model) {
    brunt_material_def def = brunt_material_def_default("m", model);
    brunt_material material;
    brunt_error error = {0};
    brunt_material_set(&def, "density", density, NULL, &error);
    brunt_material_set(&def, "E", E, NULL, &error);
    brunt_material_set(&def, "nu", nu, NULL, &error);
    if (strcmp(model, "von-mises") == 0) brunt_material_set(&def, "yield", 0.01 * E, NULL, &error);
    ck_assert_msg(brunt_material_make(&def, &material, &error) == BRUNT_OK, "%s", error.message);
    return material;
}

typedef struct options {
    const char *model;
    brunt_hourglass hourglass;
    double coefficient, mass_scaling;
} options;

static brunt_fem_workspace workspace;

static inline brunt_fem_body body_of(brunt_mesh *mesh, options o) {
    brunt_body_def def = brunt_body_def_default();
    snprintf(def.name, sizeof def.name, "b");
    def.method = BRUNT_FEM;
    def.hourglass = o.hourglass;
    def.hourglass_coefficient = o.coefficient > 0 ? o.coefficient : NAN;
    def.mass_scaling = o.mass_scaling;
    brunt_material material = material_of(o.model ? o.model : "neo-hookean");
    brunt_fem_body body;
    brunt_error error = {0};
    int status = brunt_fem_make(&def, &material, brunt_element_dimension(mesh->kind), mesh, &body, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    brunt_mesh_free(mesh);
    ck_assert_int_eq(brunt_fem_workspace_fit(&workspace, &body, NULL), 0);
    return body;
}

static inline brunt_fem_report forces(brunt_fem_body *body, double dt) {
    brunt_fem_report total = {.bad = -1, .stable_step = INFINITY};
    for (int32_t b = 0; b < body->block_count; b++) {
        brunt_fem_report *r = &body->report[b];
        body->element->forces(body, b, (real)dt, &workspace, r);
        total.stress_work += r->stress_work;
        total.hourglass_stored += r->hourglass_stored;
        total.hourglass_lost += r->hourglass_lost;
        total.stable_step = fmin(total.stable_step, r->stable_step);
        if (r->bad >= 0 && total.bad < 0) total.bad = r->bad, total.reason = r->reason;
    }
    return total;
}

static inline brunt_fem_report step(brunt_fem_body *body, double dt, brunt_fem_sums *sums) {
    const double none[3] = {0};
    brunt_fem_sums own;
    if (!sums) sums = &own;
    brunt_fem_kick(body, 0, body->node_count, dt, none, sums);
    brunt_fem_drift(body, 0, body->node_count, dt, sums);
    return forces(body, dt);
}

static inline const real *start_of(const brunt_fem_body *body, int32_t n) { return body->start + (size_t)n * 4; }

// x = A X + c
static inline void move_affine(brunt_fem_body *body, double A[3][3], const double c[3]) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < body->dim; i++) {
            double x = c[i];
            for (int j = 0; j < body->dim; j++) x += A[i][j] * (double)start_of(body, n)[j];
            brunt_fem_node(body, n)[i] = (real)x;
        }
}

static inline void rotation(int dim, double angle, double R[3][3]) {
    const double axis[3] = {dim == 3 ? 2.0 / 7 : 0, dim == 3 ? 3.0 / 7 : 0, dim == 3 ? 6.0 / 7 : 1};
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) R[i][j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        R[k][j] += s * axis[i], R[j][k] -= s * axis[i];
    }
}

static inline double greatest_stress(brunt_fem_body *body) {
    double most = 0;
    for (int c = 0; c < BRUNT_SYMMETRIC(body->dim); c++)
        for (int32_t s = 0; s < body->slots; s++)
            most = fmax(most, fabs((double)brunt_element_scalars(body, BRUNT_ELEMENT_kirchhoff_stress)[c][s]));
    return most;
}

static inline double energy_of(brunt_fem_body *body, const brunt_fem_report *report) {
    return brunt_fem_energy(body, 0, body->block_count).internal + report->hourglass_stored;
}

// The force on component i of node n is what the energy falls by along it, by central differences.
static inline void check_force_is_slope(brunt_fem_body *body, const char *model, int32_t n, int i) {
    forces(body, 1);
    real f[3], *x = brunt_fem_node(body, n) + i, at = *x;
    brunt_fem_internal_force(body, n, f);
    double energy[2], h = 1e-5;
    for (int side = 0; side < 2; side++) {
        *x = at + (real)(side ? h : -h);
        brunt_fem_report report = forces(body, 1);
        energy[side] = energy_of(body, &report);
    }
    *x = at;
    ck_assert_msg(fabs((energy[1] - energy[0]) / (2 * h) + (double)f[i]) < 1e-7 * E, "%s %s: node %d: %g, slope %g",
                  body->traits->name, model, n, (double)f[i], (energy[1] - energy[0]) / (2 * h));
}

// Of bodies that fill the room; those of membranes follow in the list and have tests of their own.
#define FOR_KINDS(kind) for (brunt_element_kind kind = 0; (int)kind < BRUNT_MEMBRANE_QUAD4; kind++)
