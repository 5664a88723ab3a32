// Meshes of sheets and membranes made of them, for the tests of membranes.
#pragma once

#include "tests/support/fem_bodies.h"
#include "fem/layout.h"

typedef struct membrane_options {
    const char *model; // neo-hookean when NULL
    bool tension_only;
    double nu, thickness, coefficient, mass_scaling; // 0: standard
} membrane_options;

static inline brunt_material membrane_material(membrane_options o) {
    brunt_material_def def = brunt_material_def_default("m", o.model ? o.model : "neo-hookean");
    brunt_material material;
    brunt_error error = {0};
    brunt_material_set(&def, "density", density, NULL, &error);
    brunt_material_set(&def, "E", E, NULL, &error);
    brunt_material_set(&def, "nu", o.nu < 0 ? 0 : o.nu > 0 ? o.nu : nu, NULL, &error);
    ck_assert_msg(brunt_material_make_membrane(&def, o.tension_only, &material, &error) == BRUNT_OK, "%s",
                  error.message);
    return material;
}

// Takes the mesh.
static inline brunt_fem_body membrane_of(brunt_mesh *mesh, membrane_options o) {
    brunt_body_def def = brunt_body_def_default();
    snprintf(def.name, sizeof def.name, "sheet");
    def.method = BRUNT_MEMBRANE;
    def.thickness = o.thickness > 0 ? o.thickness : 0.01;
    def.hourglass_coefficient = o.coefficient > 0 ? o.coefficient : NAN;
    def.mass_scaling = o.mass_scaling;
    brunt_material material = membrane_material(o);
    brunt_fem_body body;
    brunt_error error = {0};
    int status = brunt_fem_make(&def, &material, 3, mesh, &body, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    brunt_mesh_free(mesh);
    ck_assert_int_eq(brunt_fem_workspace_fit(&workspace, &body, NULL), 0);
    return body;
}

// A rectangle of nx x ny squares of size h in the plane z = 0; inner nodes (or all) moved by up to `jitter` h in the
// plane and `warp` h across it.
static inline brunt_mesh membrane_mesh(brunt_element_kind kind, int nx, int ny, double h, double jitter, double warp,
                                       bool all) {
    const int parts = kind == BRUNT_MEMBRANE_TRI3 ? 2 : 1, nodes = brunt_element_nodes(kind), m = nx + 1;
    brunt_mesh mesh = {.kind = kind, .node_count = m * (ny + 1), .element_count = nx * ny * parts};
    mesh.nodes = brunt_alloc((size_t)mesh.node_count * sizeof *mesh.nodes);
    mesh.elements = brunt_alloc((size_t)mesh.element_count * (size_t)nodes * sizeof *mesh.elements);
    for (int y = 0, k = 0; y <= ny; y++)
        for (int x = 0; x < m; x++, k++) {
            bool move = all || (x > 0 && x < nx && y > 0 && y < ny);
            mesh.nodes[k][0] = h * (x + (move ? jitter * uniform(-1, 1) : 0));
            mesh.nodes[k][1] = h * (y + (move ? jitter * uniform(-1, 1) : 0));
            mesh.nodes[k][2] = h * warp * uniform(-1, 1);
        }
    int32_t *out = mesh.elements;
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            const int corner[4] = {y * m + x, y * m + x + 1, (y + 1) * m + x + 1, (y + 1) * m + x};
            for (int p = 0; p < parts; p++)
                for (int a = 0; a < nodes; a++)
                    *out++ = corner[kind == BRUNT_MEMBRANE_TRI3 ? triangle_of_square[p][a] : a];
        }
    return mesh;
}

static inline void turn_mesh(brunt_mesh *mesh, double angle) {
    double R[3][3];
    rotation(3, angle, R);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double x[3];
        memcpy(x, mesh->nodes[n], sizeof x);
        for (int i = 0; i < 3; i++) mesh->nodes[n][i] = R[i][0] * x[0] + R[i][1] * x[1] + R[i][2] * x[2];
    }
}

// A quarter of a disk of radius 1 about the origin: a block of m x m elements inside, `rings` rings of 2 m around it;
// m + rings elements along a radius.
static inline brunt_mesh quarter_disk(int m, int rings) {
    const int arc = 2 * m + 1, inner = (m + 1) * (m + 1);
    brunt_mesh mesh = {
        .kind = BRUNT_MEMBRANE_QUAD4, .node_count = inner + rings * arc, .element_count = m * m + 2 * m * rings};
    mesh.nodes = brunt_alloc((size_t)mesh.node_count * sizeof *mesh.nodes);
    mesh.elements = brunt_alloc((size_t)mesh.element_count * 4 * sizeof *mesh.elements);
    const double size = (double)m / (m + rings), quarter = acos(0.0) / 2;
    for (int j = 0; j <= m; j++)
        for (int i = 0; i <= m; i++) {
            // Squares about the origin, the outer ones rounded half way to circles.
            double p[2] = {(double)i / m, (double)j / m}, most = fmax(p[0], p[1]), round = 0.5 * most;
            double angle = most > 0 ? p[0] >= p[1] ? quarter * p[1] / p[0] : quarter * (2 - p[0] / p[1]) : 0;
            double *x = mesh.nodes[j * (m + 1) + i];
            x[0] = size * ((1 - round) * p[0] + round * most * cos(angle));
            x[1] = size * ((1 - round) * p[1] + round * most * sin(angle));
        }
#define ON_ARC(ring, k)                                                                                                \
    ((ring) == 0 ? (k) <= m ? (k) * (m + 1) + m : m * (m + 1) + 2 * m - (k) : inner + ((ring)-1) * arc + (k))
    for (int ring = 1; ring <= rings; ring++)
        for (int k = 0; k < arc; k++) {
            const double *from = mesh.nodes[ON_ARC(0, k)], angle = quarter * k / m, share = (double)ring / rings;
            mesh.nodes[ON_ARC(ring, k)][0] = from[0] + share * (cos(angle) - from[0]);
            mesh.nodes[ON_ARC(ring, k)][1] = from[1] + share * (sin(angle) - from[1]);
        }
    int32_t *out = mesh.elements;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++, out += 4) {
            const int32_t corner[4] = {j * (m + 1) + i, j * (m + 1) + i + 1, (j + 1) * (m + 1) + i + 1,
                                       (j + 1) * (m + 1) + i};
            memcpy(out, corner, sizeof corner);
        }
    for (int ring = 0; ring < rings; ring++)
        for (int k = 0; k < 2 * m; k++, out += 4) {
            const int32_t corner[4] = {ON_ARC(ring, k), ON_ARC(ring + 1, k), ON_ARC(ring + 1, k + 1),
                                       ON_ARC(ring, k + 1)};
            memcpy(out, corner, sizeof corner);
        }
#undef ON_ARC
    return mesh;
}

// The greatest component of the forces on its nodes [N].
static inline double force_scale(const brunt_fem_body *body) {
    double most = 0;
    for (int32_t n = 0; n < body->node_count; n++) {
        real f[3];
        brunt_fem_internal_force(body, n, f);
        for (int i = 0; i < 3; i++) most = fmax(most, fabs((double)f[i]));
    }
    return most;
}

// Greatest omega^2 of a free element by differences of its forces, by Rayleigh quotients of a power iteration.
static inline double true_frequency(brunt_fem_body *body) {
    const int count = 3 * body->node_count;
    double K[12][12], v[12], w[12], h = 1e-6, quotient = 0;
    for (int j = 0; j < count; j++) {
        real *x = brunt_fem_node(body, j / 3) + j % 3, at = *x;
        for (int side = 0; side < 2; side++) {
            *x = (real)((double)at + (side ? h : -h));
            forces(body, 1e-3);
            for (int i = 0; i < count; i++) {
                real f[3];
                brunt_fem_internal_force(body, i / 3, f);
                double root = sqrt((double)brunt_fem_node(body, i / 3)[BRUNT_FEM_MASS] *
                                   (double)brunt_fem_node(body, j / 3)[BRUNT_FEM_MASS]);
                double value = (side ? -1 : 1) * (double)f[i % 3] / (2 * h * root);
                K[i][j] = side ? K[i][j] + value : value;
            }
        }
        *x = at;
    }
    // Shifted, so that the greatest eigenvalue is not outdone by a negative one.
    double shift = 0;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) shift = fmax(shift, fabs(K[i][j]));
    if (!(shift > 0)) return 0; // slack
    for (int i = 0; i < count; i++) v[i] = uniform(-1, 1);
    for (int step = 0; step < 3000; step++) {
        double norm = 0;
        for (int i = 0; i < count; i++) {
            w[i] = shift * v[i];
            for (int j = 0; j < count; j++) w[i] += 0.5 * (K[i][j] + K[j][i]) * v[j];
            norm += w[i] * w[i];
        }
        quotient = sqrt(norm) - shift;
        for (int i = 0; i < count; i++) v[i] = w[i] / sqrt(norm);
    }
    forces(body, 1e-3);
    return quotient;
}

#define FOR_MEMBRANES(kind)                                                                                            \
    for (brunt_element_kind kind = BRUNT_MEMBRANE_QUAD4; (int)kind <= BRUNT_MEMBRANE_TRI3; kind++)
