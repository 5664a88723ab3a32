// Labels: verification
//
// Finite elements by themselves: kinematics, forces, hourglass control, energy, stable steps, the order of things in
// memory. Every check goes over all elements.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fem_bodies.h"
#include "base/simd.h"
#include "fem/layout.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "tests/support/suite.h"

static const double tolerance = sizeof(real) == 4 ? 2e-5 : 1e-11;

// ------------------------------------------------------------------------------------------ geometry

static double quadrature_volume(brunt_element_kind kind, const double (*x)[3]) {
    const int dim = brunt_element_dimension(kind), nodes = brunt_element_nodes(kind);
    double sum = 0, g = 1 / sqrt(3);
    for (int q = 0; q < (dim == 3 ? 8 : 4); q++) {
        double at[3], J[3][3] = {{0}};
        for (int a = 0; a < 3; a++) at[a] = q >> a & 1 ? g : -g;
        for (int n = 0; n < nodes; n++)
            for (int d = 0; d < dim; d++) {
                double slope = 1;
                for (int a = 0; a < dim; a++) {
                    double sign = hex_corner[n][a] ? 1 : -1;
                    slope *= 0.5 * (a == d ? sign : 1 + sign * at[a]);
                }
                for (int i = 0; i < dim; i++) J[i][d] += slope * x[n][i];
            }
        if (dim == 2) J[2][2] = 1;
        sum += J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
               J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
    }
    return sum;
}

static void random_corners(brunt_element_kind kind, double jitter, double (*x)[3]) {
    for (int n = 0; n < 8; n++)
        for (int a = 0; a < 3; a++) {
            int n2 = kind == BRUNT_TET4 ? tet_of_cube[0][n % 4] : n;
            bool flat = a == 2 && brunt_element_dimension(kind) == 2;
            x[n][a] = flat ? 0 : hex_corner[n2][a] + jitter * uniform(-1, 1);
        }
}

// The volume of a hexahedron and a quadrilateral with curved faces: 2 Gauss points along each axis are exact for it.
START_TEST(volume_is_exact) {
    for (int k = 0; k < 20; k++) {
        double x[8][3];
        random_corners(BRUNT_HEX8, 0.3, x);
        ck_assert_double_eq_tol(brunt_elements[BRUNT_HEX8]->volume((const double(*)[3])x),
                                quadrature_volume(BRUNT_HEX8, (const double(*)[3])x), 1e-13);
        random_corners(BRUNT_QUAD4, 0.3, x);
        ck_assert_double_eq_tol(brunt_elements[BRUNT_QUAD4]->volume((const double(*)[3])x),
                                quadrature_volume(BRUNT_QUAD4, (const double(*)[3])x), 1e-13);
    }
    // A frustum of height h and edges a, b: h (a^2 + a b + b^2) / 3; a sheared box keeps its volume.
    double x[8][3], a = 2, b = 0.5, h = 3;
    for (int n = 0; n < 8; n++) {
        double edge = hex_corner[n][2] ? b : a;
        for (int i = 0; i < 2; i++) x[n][i] = edge * (hex_corner[n][i] - 0.5) + 100;
        x[n][2] = h * hex_corner[n][2];
        x[n][0] += 0.7 * x[n][2];
    }
    ck_assert_double_eq_tol(brunt_elements[BRUNT_HEX8]->volume((const double(*)[3])x), h * (a * a + a * b + b * b) / 3,
                            1e-12);
    const double tet[4][3] = {{0, 0, 0}, {2, 0, 0}, {1, 3, 0}, {5, 5, 4}},
                 triangle[3][3] = {{0, 0, 0}, {2, 0, 0}, {1, 3, 0}};
    ck_assert_double_eq_tol(brunt_elements[BRUNT_TET4]->volume(tet), 4, 1e-14);
    ck_assert_double_eq_tol(brunt_elements[BRUNT_TRI3]->volume(triangle), 3, 1e-14);
    const double turned[3][3] = {{0, 0, 0}, {1, 3, 0}, {2, 0, 0}};
    ck_assert_double_eq_tol(brunt_elements[BRUNT_TRI3]->volume(turned), -3, 1e-14);
}
END_TEST

// sum_a X_a (x) b_a = I (Flanagan and Belytschko 1981), sum_a b_a = 0, and V b_a = dV/dX_a by differences.
START_TEST(mean_gradient_is_the_slope_of_the_volume) {
    FOR_KINDS(kind) {
        const brunt_element *type = brunt_elements[kind];
        for (int k = 0; k < 10; k++) {
            double x[8][3];
            real b[8][3];
            random_corners(kind, 0.2, x);
            type->gradient((const double(*)[3])x, b);
            double V = type->volume((const double(*)[3])x);
            for (int i = 0; i < type->traits->dimension; i++) {
                double sum = 0;
                for (int a = 0; a < type->traits->nodes; a++) sum += (double)b[a][i];
                ck_assert_double_eq_tol(sum, 0, 10 * tolerance);
                for (int j = 0; j < type->traits->dimension; j++) {
                    double identity = 0;
                    for (int a = 0; a < type->traits->nodes; a++) identity += x[a][i] * (double)b[a][j];
                    ck_assert_double_eq_tol(identity, i == j, 10 * tolerance);
                }
                for (int a = 0; a < type->traits->nodes; a++) {
                    double at = x[a][i], h = 1e-3, up, down;
                    x[a][i] = at + h, up = type->volume((const double(*)[3])x);
                    x[a][i] = at - h, down = type->volume((const double(*)[3])x);
                    x[a][i] = at;
                    ck_assert_double_eq_tol((up - down) / (2 * h), V * (double)b[a][i],
                                            1e2 * tolerance); // V is linear in each
                }
            }
        }
    }
}
END_TEST

START_TEST(faces_are_the_surface_and_point_outward) {
    FOR_KINDS(kind) {
        const int n = 3, dim = brunt_element_dimension(kind);
        brunt_mesh mesh = box_mesh(kind, n, 1, 0.1, false);
        brunt_fem_body body = body_of(&mesh, (options){0});
        brunt_faces faces;
        ck_assert_int_eq(brunt_fem_faces(&body, &faces, NULL), 0);
        ck_assert_int_eq(faces.count, dim == 2 ? 4 * n : kind == BRUNT_HEX8 ? 6 * n * n : 12 * n * n);
        double volume = 0; // by the divergence theorem, of a box with flat sides
        int64_t last = -1;
        for (int32_t f = 0; f < faces.count; f++) {
            const int32_t *node = faces.node[f];
            const real *a = start_of(&body, node[0]), *b = start_of(&body, node[1]);
            ck_assert_int_ge(faces.element[f], last);
            last = faces.element[f];
            if (dim == 2) {
                volume += 0.5 * ((double)a[0] * (double)b[1] - (double)a[1] * (double)b[0]);
                continue;
            }
            for (int k = 2; k < body.traits->face_nodes; k++) {
                const real *p = start_of(&body, node[k - 1]), *q = start_of(&body, node[k]);
                for (int i = 0; i < 3; i++)
                    volume += (double)a[i] *
                              ((double)p[(i + 1) % 3] * (double)q[(i + 2) % 3] -
                               (double)p[(i + 2) % 3] * (double)q[(i + 1) % 3]) /
                              6;
            }
        }
        ck_assert_double_eq_tol(volume, 1, 10 * tolerance);
        brunt_faces_free(&faces);
        brunt_fem_free(&body);
    }
}
END_TEST

// Each face of one element by itself: its normal points away from the element's middle.
START_TEST(every_face_points_outward) {
    FOR_KINDS(kind) {
        const brunt_element *type = brunt_elements[kind];
        double x[8][3], middle[3] = {0};
        random_corners(kind, 0.1, x);
        for (int a = 0; a < type->traits->nodes; a++)
            for (int i = 0; i < 3; i++) middle[i] += x[a][i] / type->traits->nodes;
        for (int f = 0; f < type->traits->face_count; f++) {
            const double *a = x[type->traits->face[f][0]], *b = x[type->traits->face[f][1]],
                         *c = x[type->traits->face[f][2]];
            double u[3], v[3] = {0, 0, 1}, out = 0;
            for (int i = 0; i < 3; i++) u[i] = b[i] - a[i];
            for (int i = 0; i < 3 && type->traits->dimension == 3; i++) v[i] = c[i] - a[i];
            for (int i = 0; i < 3; i++)
                out += (u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]) * (a[i] - middle[i]);
            ck_assert_msg(out > 0, "%s face %d", type->traits->name, f);
        }
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ motions

START_TEST(rigid_motion_makes_no_stress) {
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff", "von-mises"};
    FOR_KINDS(kind)
    for (int m = 0; m < 3; m++) {
        brunt_mesh mesh = box_mesh(kind, 2, 1, 0.25, true);
        brunt_fem_body body = body_of(&mesh, (options){.model = models[m]});
        const int turns = sizeof(real) == 4 ? 100 : 10000;
        for (int t = 1; t <= turns; t++) { // 1000 rad in the end
            double R[3][3], shift[3] = {0.01 * t, -0.02 * t, body.dim == 3 ? 0.003 * t : 0};
            rotation(body.dim, 0.1 * t, R);
            move_affine(&body, R, shift);
            brunt_fem_report report = forces(&body, 1e-3);
            ck_assert_int_eq(report.bad, -1);
        }
        double limit = sizeof(real) == 4 ? 2e-3 : 1e-9;
        ck_assert_msg(greatest_stress(&body) < limit * E, "%s %s: stress %g E after %d turns", body.traits->name,
                      models[m], greatest_stress(&body) / E, turns);
        double R[3][3], shift[3] = {0};
        rotation(body.dim, 3, R);
        move_affine(&body, R, shift);
        forces(&body, 1e-3);
        brunt_fem_free(&body);
    }
}
END_TEST

// An affine motion of a distorted patch gives the material's stress in every element, and no force on inner nodes.
START_TEST(patch_test) {
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff", "von-mises", "linear-elastic",
                                         "von-mises"};
    static const int many[] = {
        [BRUNT_TET4] = 11, [BRUNT_HEX8] = 21, [BRUNT_TRI3] = 65, [BRUNT_QUAD4] = 129}; // blocks of full size
    FOR_KINDS(kind)
    for (int m = 0; m < 5; m++)
        for (int viscous = 0; viscous < 2; viscous++) {
            brunt_mesh mesh = box_mesh(kind, m < 4 ? 3 : many[kind], 1, 0.25, false);
            brunt_fem_body body = body_of(&mesh, (options){.model = models[m], .hourglass = (brunt_hourglass)viscous});
            const int dim = body.dim;
            if (m == 4) ck_assert_int_gt(body.block[0].count, BRUNT_FEM_TILE);
            double A[3][3] = {{1.2, 0.3, -0.1}, {0.05, 0.9, 0.2}, {0.1, -0.2, 1.1}},
                   shift[3] = {3, 4, dim == 3 ? 5 : 0};
            const double dt = 1e-4;
            for (int32_t n = 0; n < body.node_count; n++)
                for (int i = 0; i < dim; i++) {
                    double v = 0;
                    for (int j = 0; j < dim; j++) v += (A[i][j] - (i == j)) * (double)start_of(&body, n)[j];
                    brunt_fem_node(&body, n)[BRUNT_FEM_V + i] = (real)((v + shift[i]) / dt);
                }
            brunt_fem_sums sums;
            brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
            forces(&body, dt);

            // The same in one vector of points of the material itself.
            real F[9][BRUNT_LANES], L[9][BRUNT_LANES], stress[6][BRUNT_LANES] = {{0}}, state[24][BRUNT_LANES] = {{0}};
            real volume[BRUNT_LANES], plastic[BRUNT_LANES], q[BRUNT_LANES];
            brunt_material_points points[BRUNT_COMPONENTS] = {{0}}, *p = &points[BRUNT_STRENGTH];
            *p = (brunt_material_points){.count = BRUNT_LANES, .dim = dim, .dt = (real)dt, .cell = 1, .volume = volume};
            const brunt_model *model = body.material.model[BRUNT_STRENGTH];
            int at = 0;
            for (int s = 0; s < model->state_count; s++)
                for (int c = 0; c < (dim == 3 ? model->state[s].components3 : model->state[s].components2); c++, at++) {
                    p->state[at] = state[at];
                    for (int l = 0; l < BRUNT_LANES && model->state[s].initial; l++)
                        state[at][l] = model->state[s].initial(body.material.constants[0], c);
                }
            for (int c = 0; c < dim * dim; c++) {
                p->F[c] = F[c], p->L[c] = L[c];
                for (int l = 0; l < BRUNT_LANES; l++) {
                    F[c][l] = (real)A[c / dim][c % dim];
                    L[c][l] = (real)((A[c / dim][c % dim] - (c / dim == c % dim)) / dt);
                }
            }
            for (int c = 0; c < 6; c++) p->stress[c] = stress[c];
            brunt_material_update(&body.material, points, plastic, q, NULL);

            // Floats of places 5 m away, in elements of a few centimetres.
            const double near = (sizeof(real) == 4 && m == 4 ? 2000 : 100) * tolerance;
            double most = 0;
            for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
                for (int32_t s = 0; s < body.slots; s++)
                    most = fmax(most, fabs((double)(brunt_element_scalars(&body, BRUNT_ELEMENT_kirchhoff_stress)[c][s] -
                                                    stress[c][0])));
            ck_assert_msg(most < near * E, "%s %s: stress off by %g E", body.traits->name, models[m], most / E);
            double inner = 0, outer = 0;
            for (int32_t n = 0; n < body.node_count; n++) {
                bool inside = true;
                for (int i = 0; i < dim; i++)
                    inside = inside && start_of(&body, n)[i] > (real)1e-6 && start_of(&body, n)[i] < (real)0.9999;
                real f[3];
                brunt_fem_internal_force(&body, n, f);
                for (int i = 0; i < 3; i++) {
                    double *greatest = inside ? &inner : &outer;
                    *greatest = fmax(*greatest, fabs((double)f[i]));
                }
            }
            ck_assert_double_gt(outer, 0);
            ck_assert_msg(inner < near * outer, "%s %s: force %g on inner nodes, %g on outer ones", body.traits->name,
                          models[m], inner, outer);
            brunt_fem_free(&body);
        }
}
END_TEST

static void shake(brunt_fem_body *body, double amount) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < body->dim; i++) brunt_fem_node(body, n)[i] += (real)(amount * uniform(-1, 1));
}

static void throw(brunt_fem_body * body, double speed) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < body->dim; i++) brunt_fem_node(body, n)[BRUNT_FEM_V + i] = (real)(speed * uniform(-1, 1));
}

// f = -dE/dx with the springs of the hourglass modes in E.
START_TEST(forces_are_the_slope_of_the_energy) {
    if (sizeof(real) == 4) return; // differences of float energies say nothing
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff"};
    FOR_KINDS(kind)
    for (int m = 0; m < 2; m++) {
        brunt_mesh mesh = box_mesh(kind, 2, 1, 0.2, true);
        brunt_fem_body body = body_of(&mesh, (options){.model = models[m], .coefficient = 0.5});
        double R[3][3], shift[3] = {0};
        rotation(body.dim, 1, R);
        move_affine(&body, R, shift);
        shake(&body, 0.08);
        forces(&body, 1);
        for (int32_t n = 0; n < body.node_count; n++)
            for (int i = 0; i < body.dim; i++) { check_force_is_slope(&body, models[m], n, i); }
        brunt_fem_free(&body);
    }
}
END_TEST

// Internal forces have no sum and no moment, whatever the motion, with springs and with dampers.
START_TEST(internal_forces_keep_momentum) {
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        brunt_mesh mesh = box_mesh(kind, 3, 1, 0.2, true);
        brunt_fem_body body = body_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous, .coefficient = 1});
        double R[3][3], shift[3] = {0};
        rotation(body.dim, 2, R);
        move_affine(&body, R, shift);
        shake(&body, 0.05);
        throw(&body, 10);
        forces(&body, 1e-4);
        double sum[3] = {0}, moment[3] = {0}, scale = 0;
        for (int32_t n = 0; n < body.node_count; n++) {
            real f[3];
            const real *x = brunt_fem_node(&body, n);
            brunt_fem_internal_force(&body, n, f);
            for (int i = 0; i < 3; i++) {
                int j = (i + 1) % 3, k = (i + 2) % 3;
                sum[i] += (double)f[i];
                double xj = j < body.dim ? (double)x[j] : 0, xk = k < body.dim ? (double)x[k] : 0;
                moment[i] += xj * (double)f[k] - xk * (double)f[j];
                scale += fabs((double)f[i]);
            }
        }
        for (int i = 0; i < 3; i++) {
            ck_assert_msg(fabs(sum[i]) < tolerance * scale, "%s: sum %g of %g", body.traits->name, sum[i], scale);
            ck_assert_msg(fabs(moment[i]) < tolerance * scale, "%s %s: moment %g of %g", body.traits->name,
                          viscous ? "viscous" : "stiffness", moment[i], scale);
        }
        brunt_fem_free(&body);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ hourglass control

START_TEST(hourglass_modes_are_resisted) {
    FOR_KINDS(kind) {
        const brunt_element *type = brunt_elements[kind];
        for (int mode = 0; mode < type->hourglass_modes; mode++)
            for (int viscous = 0; viscous < 2; viscous++)
                for (int i = 0; i < type->traits->dimension; i++) {
                    double x[8][3];
                    random_corners(kind, 0, x);
                    brunt_mesh mesh = single_mesh(kind, (const double(*)[3])x);
                    brunt_fem_body body = body_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous});
                    const double size = 1e-4, dt = 1e-4;
                    for (int32_t n = 0; n < body.node_count; n++)
                        brunt_fem_node(&body, n)[BRUNT_FEM_V + i] =
                            (real)(size / dt * type->hourglass[mode][body.node_id[n]]);
                    brunt_fem_sums sums;
                    brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
                    brunt_fem_report report = forces(&body, dt);
                    ck_assert_double_lt(greatest_stress(&body), 1e-6 * E); // the point sees nothing of it
                    // E.g. the cube's spring, one unit of mode amplitude q = 8 size: k = coefficient M V (24 / 16) / (8
                    // 3).
                    double M = density * pow((double)body.material.wave_speed, 2), n = type->traits->nodes,
                           dim = type->traits->dimension;
                    double k = 0.05 * M * n * dim / pow(2, 2 * (dim - 1)) / (n * dim);
                    double c = 0.1 * density * (double)body.material.wave_speed * (dim == 3 ? 0.25 : 1);
                    for (int32_t a = 0; a < body.node_count; a++) {
                        real f[3];
                        brunt_fem_internal_force(&body, a, f);
                        double push = -n * size * type->hourglass[mode][body.node_id[a]] * (viscous ? c / dt : k);
                        // The dampers' vectors are those of the present shape, off by the amplitude.
                        ck_assert_double_eq_tol((double)f[i], push,
                                                fabs(push) * (sizeof(real) == 4 ? 1e-2
                                                              : viscous         ? 1e-3
                                                                                : 1e-6));
                    }
                    if (!viscous)
                        ck_assert_double_eq_tol(report.hourglass_stored, 0.5 * k * pow(n * size, 2),
                                                1e-3 * k * pow(n * size, 2));
                    else
                        ck_assert_double_gt(report.hourglass_lost, 0);
                    brunt_fem_free(&body);
                }
    }
}
END_TEST

START_TEST(affine_motions_are_no_hourglass) {
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        if (!brunt_elements[kind]->hourglass_modes) continue;
        brunt_mesh mesh = box_mesh(kind, 3, 1, 0.25, true);
        brunt_fem_body body = body_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous, .coefficient = 1});
        double A[3][3] = {{1.2, 0.3, -0.1}, {0.05, 0.9, 0.2}, {0.1, -0.2, 1.1}}, shift[3] = {0};
        for (int32_t n = 0; n < body.node_count; n++)
            for (int i = 0; i < body.dim; i++) {
                double v = 0;
                for (int j = 0; j < body.dim; j++) v += (A[i][j] - (i == j)) * (double)start_of(&body, n)[j];
                brunt_fem_node(&body, n)[BRUNT_FEM_V + i] = (real)(v / 1e-3);
            }
        move_affine(&body, A, shift);
        brunt_fem_report report = forces(&body, 1e-3);
        double scale = brunt_fem_energy(&body, 0, body.block_count).internal;
        ck_assert_double_lt(report.hourglass_stored + report.hourglass_lost, 1e3 * tolerance * tolerance * scale);
        ck_assert_double_gt(scale, 0);
        brunt_fem_free(&body);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ time

// Kinetic energy at the half step less half of the force's work (the middle of the trapezoid), stored and lost energy.
static double total_energy(brunt_fem_body *body, const brunt_fem_report *report, const brunt_fem_sums *sums,
                           double lost) {
    return sums->kinetic - 0.5 * report->stress_work + energy_of(body, report) + lost;
}

static double ledger_error(brunt_element_kind kind, int viscous, double dt, double end, double speed, double *lost) {
    random_state = 5;
    brunt_mesh mesh = box_mesh(kind, 3, 1, 0.2, true);
    brunt_fem_body body = body_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous});
    throw(&body, speed);
    brunt_fem_sums sums;
    brunt_fem_report report = forces(&body, 0);
    double kinetic = 0, worst = 0;
    for (int32_t n = 0; n < body.node_count; n++) {
        const real *node = brunt_fem_node(&body, n);
        for (int i = 0; i < body.dim; i++)
            kinetic += 0.5 * (double)node[BRUNT_FEM_MASS] * pow((double)node[BRUNT_FEM_V + i], 2);
    }
    *lost = 0;
    for (int k = 0; k < (int)(end / dt); k++) {
        report = step(&body, dt, &sums);
        ck_assert_int_eq(report.bad, -1);
        *lost += report.hourglass_lost;
        worst = fmax(worst, fabs(total_energy(&body, &report, &sums, *lost) / kinetic - 1));
    }
    *lost /= kinetic;
    brunt_fem_free(&body);
    return worst;
}

// Free vibration: the ledger closes to second order in the step, and exactly where the stress is linear.
START_TEST(energy_ledger_closes) {
    if (sizeof(real) == 4) return; // the orders drown in rounding
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        double coarse, fine, lost, dt = 4e-4;
        coarse = ledger_error(kind, viscous, dt, 400 * dt, 5, &lost);
        fine = ledger_error(kind, viscous, dt / 4, 400 * dt, 5, &lost);
        ck_assert_msg(fine < 1e-3 && coarse / fine > 10, "%s %d: errors %g, %g", brunt_element_name(kind), viscous,
                      coarse, fine);
        if (viscous && brunt_elements[kind]->hourglass_modes) ck_assert_double_gt(lost, 0.01);
        // Of small motions, where stress is linear, what is left is of third order in the strain.
        double small = ledger_error(kind, viscous, dt, 400 * dt, 5e-5, &lost);
        ck_assert_msg(small < 1e-7, "%s %d: small motion %g", brunt_element_name(kind), viscous, small);
    }
}
END_TEST

START_TEST(nodes_give_the_sums_of_the_step) {
    FOR_KINDS(kind) {
        brunt_mesh mesh = box_mesh(kind, 3, 1, 0.2, true);
        brunt_fem_body body = body_of(&mesh, (options){0});
        const int dim = body.dim;
        shake(&body, 0.03);
        throw(&body, 3);
        body.load = brunt_alloc((size_t)body.node_count * 4 * sizeof *body.load);
        for (int32_t n = 0; n < body.node_count; n++)
            for (int i = 0; i < dim; i++) body.load[n * 4 + i] = (real)uniform(-50, 50);
        forces(&body, 1e-4);
        const double dt = 1e-3, g[3] = {1, -2, dim == 3 ? 3 : 0};
        double K[2] = {0}, work = 0, load[3] = {0}, moment[3] = {0}, L[2][3] = {{0}}, P[2][3] = {{0}};
        brunt_fem_sums sums;
        for (int after = 0; after < 2; after++) {
            double old[256][3] = {{0}};
            for (int32_t n = 0; n < body.node_count; n++)
                for (int i = 0; i < dim; i++) old[n][i] = (double)brunt_fem_node(&body, n)[BRUNT_FEM_V + i];
            if (after) {
                brunt_fem_kick(&body, 0, body.node_count, dt, g, &sums);
                for (int32_t n = 0; n < body.node_count; n++) {
                    real f[3];
                    brunt_fem_internal_force(&body, n, f);
                    const real *node = brunt_fem_node(&body, n), *F = body.load + 4 * n;
                    for (int i = 0; i < dim; i++) {
                        work += 0.5 * dt * (double)(f[i] + F[i]) * (old[n][i] + (double)node[BRUNT_FEM_V + i]);
                        load[i] += (double)F[i];
                    }
                    for (int i = 0; i < 3; i++) {
                        const int j = (i + 1) % 3, k = (i + 2) % 3;
                        moment[i] +=
                            (j < dim && k < dim) ? (double)node[j] * (double)F[k] - (double)node[k] * (double)F[j] : 0;
                    }
                }
                brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
            }
            for (int32_t n = 0; n < body.node_count; n++) {
                const real *node = brunt_fem_node(&body, n);
                double m = (double)node[BRUNT_FEM_MASS];
                for (int i = 0; i < 3; i++) {
                    int j = (i + 1) % 3, k = (i + 2) % 3;
                    double xj = j < dim ? (double)node[j] : 0, xk = k < dim ? (double)node[k] : 0;
                    K[after] += 0.5 * m * pow((double)node[BRUNT_FEM_V + i], 2);
                    P[after][i] += m * (double)node[BRUNT_FEM_V + i];
                    L[after][i] += m * (xj * (double)node[BRUNT_FEM_V + k] - xk * (double)node[BRUNT_FEM_V + j]);
                }
            }
        }
        const double near = 1e3 * tolerance;
        for (int i = 0; i < 3; i++) work += 0.5 * dt * g[i] * (sums.momentum_old[i] + sums.momentum[i]);
        ck_assert_double_eq_tol(K[1] - K[0], work, near * K[0]);
        ck_assert_double_eq_tol(K[1], sums.kinetic, near * K[0]);
        double mass = 0;
        for (int32_t n = 0; n < body.node_count; n++) mass += (double)brunt_fem_node(&body, n)[BRUNT_FEM_MASS];
        ck_assert_double_eq_tol(sums.mass, mass, near * mass);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double turn = sums.first_moment[j] * g[k] - sums.first_moment[k] * g[j];
            ck_assert_double_eq_tol(sums.momentum[i], P[1][i], near * K[0]);
            ck_assert_double_eq_tol(sums.momentum_old[i], P[0][i], near * K[0]);
            ck_assert_double_eq_tol(P[1][i] - P[0][i], dt * (sums.mass * g[i] + load[i]), near * K[0]);
            ck_assert_double_eq_tol(sums.angular[i], L[1][i], near * K[0]);
            ck_assert_double_eq_tol(L[1][i] - L[0][i], dt * (turn + moment[i]), near * K[0]);
        }
        brunt_fem_free(&body);
    }
}
END_TEST

// Growth of a small random motion of one free element in many steps.
static double growth(brunt_fem_body *body, double dt, int steps) {
    const double speed = sizeof(real) == 4 ? 0.02 : 1e-7; // floats must resolve it
    throw(body, speed);
    brunt_fem_sums sums = {0};
    double most = 0;
    for (int k = 0; k < steps; k++) {
        brunt_fem_report report = step(body, dt, &sums);
        if (report.bad >= 0 || sums.speed > 1e3 * speed) return INFINITY;
        most = fmax(most, sums.speed);
    }
    return most / speed;
}

START_TEST(stable_step_is_a_bound_and_a_close_one) {
    FOR_KINDS(kind)
    for (int form = 0; form < 4; form++) // springs and dampers, weak and strong
        for (int shape = 0; shape < 4; shape++) {
            options o = {.hourglass = form % 2 ? BRUNT_HOURGLASS_VISCOUS : BRUNT_HOURGLASS_STIFFNESS,
                         .coefficient = form < 2 ? 0 : 1};
            double x[8][3];
            random_corners(kind, shape == 0 ? 0 : 0.25, x);
            if (shape == 2) // flat and sheared
                for (int n = 0; n < 8; n++) x[n][1] *= 0.2, x[n][0] += x[n][1];
            for (int fast = 0; fast < 2; fast++) {
                brunt_mesh mesh = single_mesh(kind, (const double(*)[3])x);
                brunt_fem_body body = body_of(&mesh, o);
                brunt_fem_report report = forces(&body, 0);
                ck_assert_double_eq_tol(report.stable_step, body.least_step, 1e-3 * body.least_step);
                double grown = growth(&body, (fast ? 1.1 : 0.98) * body.least_step, fast ? 3000 : 4000);
                if (!fast)
                    ck_assert_msg(grown < 50, "%s %d shape %d: grows by %g", body.traits->name, form, shape, grown);
                // The bound is sharp where the element is regular.
                else if (shape == 0 && kind != BRUNT_TET4 && kind != BRUNT_TRI3 && o.coefficient < 1)
                    ck_assert_msg(grown > 1e2, "%s %d: only grows by %g", body.traits->name, form, grown);
                brunt_fem_free(&body);
            }
        }
}
END_TEST

// A cube of side h: its breathing mode, omega^2 = 4 (3 lambda + 2 mu) / (rho h^2), and a square's, 4 (2 lambda + 2 mu).
START_TEST(stable_step_of_a_cube) {
    FOR_KINDS(kind) {
        if (!brunt_elements[kind]->hourglass_modes) continue;
        brunt_mesh mesh = box_mesh(kind, 1, 0.5, 0, false);
        brunt_fem_body body = body_of(&mesh, (options){0});
        double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
        double h = 0.5, stiffness = body.dim * lambda + 2 * mu;
        ck_assert_double_eq_tol((double)body.lateral_ratio, lambda / (lambda + 2 * mu), 1e-3);
        ck_assert_double_eq_tol(body.least_step, h * sqrt(density / stiffness), 2e-3 * body.least_step);
        ck_assert_double_eq_tol((double)body.hourglass_norm, 1, 1e-5);
        ck_assert_double_lt((double)body.hourglass_overlap, 1e-5);
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(mass_scaling_reaches_its_step) {
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        options o = {.hourglass = (brunt_hourglass)viscous};
        random_state = 1;
        brunt_mesh mesh = box_mesh(kind, 4, 1, 0.3, false);
        brunt_fem_body plain = body_of(&mesh, o);
        o.mass_scaling = 1.2 * plain.least_step;
        random_state = 1;
        mesh = box_mesh(kind, 4, 1, 0.3, false);
        brunt_fem_body scaled = body_of(&mesh, o);
        double added = 0;
        for (int32_t n = 0; n < scaled.node_count; n++) added += (double)brunt_fem_node(&scaled, n)[BRUNT_FEM_MASS];
        ck_assert_double_ge(scaled.least_step, o.mass_scaling);
        ck_assert_double_ge(forces(&scaled, 0).stable_step, o.mass_scaling);
        ck_assert_int_gt(scaled.scaled_elements, 0);
        ck_assert_int_lt(scaled.scaled_elements, scaled.element_count);
        ck_assert_double_eq_tol(added - density, scaled.added_mass, 1e2 * tolerance * density);
        ck_assert_int_eq(plain.scaled_elements, 0);
        brunt_fem_free(&plain);
        brunt_fem_free(&scaled);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ order and bits

typedef struct crew {
    brunt_fem_body *body;
    brunt_fem_workspace work[4];
    double dt;
} crew;

static void forces_task(void *context, int64_t begin, int64_t end, int worker) {
    crew *c = context;
    for (int64_t b = begin; b < end; b++)
        c->body->element->forces(c->body, (int32_t)b, (real)c->dt, &c->work[worker], &c->body->report[b]);
}

START_TEST(same_bits_for_any_number_of_threads) {
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        brunt_fem_body body[2];
        for (int k = 0; k < 2; k++) {
            random_state = 3;
            brunt_mesh mesh = box_mesh(kind, brunt_element_dimension(kind) == 3 ? 9 : 33, 1, 0.2, true);
            body[k] = body_of(&mesh, (options){.model = "von-mises", .hourglass = (brunt_hourglass)viscous});
            ck_assert_int_ge(body[k].block_count, 12);
            throw(&body[k], 10);
            crew c = {.body = &body[k], .dt = 1e-5};
            for (int t = 0; t < 4; t++) ck_assert_int_eq(brunt_fem_workspace_fit(&c.work[t], &body[k], NULL), 0);
            for (int s = 0; s < 5; s++) {
                brunt_fem_sums sums;
                const double none[3] = {0};
                brunt_fem_kick(&body[k], 0, body[k].node_count, c.dt, none, &sums);
                brunt_fem_drift(&body[k], 0, body[k].node_count, c.dt, &sums);
                brunt_parallel(k ? 3 : 1, body[k].block_count, 1, forces_task, &c, NULL);
            }
            for (int t = 0; t < 4; t++) brunt_fem_workspace_free(&c.work[t]);
        }
        ck_assert_mem_eq(body[0].node, body[1].node, (size_t)body[0].node_count * BRUNT_FEM_NODE_REALS * sizeof(real));
        ck_assert_mem_eq(body[0].partial, body[1].partial, (size_t)body[0].partial_count * 4 * sizeof(real));
        ck_assert_mem_eq(body[0].slab, body[1].slab, body[0].slab_bytes);
        for (int32_t b = 0; b < body[0].block_count; b++) {
            ck_assert(body[0].report[b].stress_work == body[1].report[b].stress_work);
            ck_assert(body[0].report[b].stable_step == body[1].report[b].stable_step);
        }
        for (int k = 0; k < 2; k++) brunt_fem_free(&body[k]);
    }
}
END_TEST

START_TEST(forces_without_a_step_are_the_same_bits) {
    FOR_KINDS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        brunt_mesh mesh = box_mesh(kind, 5, 1, 0.2, true);
        brunt_fem_body body = body_of(&mesh, (options){.model = "von-mises", .hourglass = (brunt_hourglass)viscous});
        throw(&body, 10);
        for (int s = 0; s < 5; s++) step(&body, 1e-4, NULL);
        size_t bytes = (size_t)body.partial_count * 4 * sizeof(real);
        real *before = brunt_alloc(bytes), *state = brunt_alloc(body.slab_bytes);
        memcpy(before, body.partial, bytes);
        memcpy(state, body.slab, body.slab_bytes);
        memset(body.partial, 0xff, bytes);
        brunt_fem_report report = forces(&body, 0);
        ck_assert_mem_eq(before, body.partial, bytes);
        ck_assert_mem_eq(state, body.slab, body.slab_bytes);
        ck_assert(report.stress_work == 0 && report.hourglass_lost == 0);
        ck_assert(greatest_stress(&body) > 0);
        brunt_free(before);
        brunt_free(state);
        brunt_fem_free(&body);
    }
}
END_TEST

// Numbers of nodes and elements lead back to the mesh; unused nodes are dropped; groups follow; memory is given back.
START_TEST(numbering_leads_back_to_the_mesh) {
    brunt_fem_workspace_free(&workspace);
    size_t live = brunt_memory_live();
    FOR_KINDS(kind) {
        const int nodes = brunt_element_nodes(kind);
        brunt_mesh mesh = box_mesh(kind, 7, 1, 0.2, true), copy = box_mesh(kind, 7, 1, 0.2, true);
        memcpy(copy.nodes, mesh.nodes, (size_t)mesh.node_count * sizeof *mesh.nodes);
        // One more node, unused, and a group of it and others.
        double(*more)[3] = brunt_alloc(((size_t)mesh.node_count + 1) * sizeof *more);
        memcpy(more, mesh.nodes, (size_t)mesh.node_count * sizeof *more);
        brunt_free(mesh.nodes);
        mesh.nodes = more;
        mesh.groups = brunt_alloc(sizeof *mesh.groups);
        mesh.group_count = 1;
        mesh.groups[0] = (brunt_group){.name = "some", .count = 3, .nodes = brunt_alloc(3 * sizeof(int32_t))};
        mesh.groups[0].nodes[0] = 2, mesh.groups[0].nodes[1] = 11, mesh.groups[0].nodes[2] = mesh.node_count++;
        brunt_fem_body body = body_of(&mesh, (options){0});
        ck_assert_int_eq(body.node_count, copy.node_count);
        ck_assert_int_eq(body.element_count, copy.element_count);
        char *seen = calloc((size_t)copy.element_count, 1);
        for (int32_t s = 0; s < body.slots; s++) {
            int32_t e = body.element_id[s];
            double volume = (double)brunt_element_scalars(&body, BRUNT_ELEMENT_reference_volume)[0][s];
            ck_assert((e >= 0) == (volume > 0));
            if (e < 0) continue;
            ck_assert_int_eq(seen[e]++, 0);
            for (int a = 0; a < nodes; a++)
                ck_assert_int_eq(body.node_id[body.element_node[s * nodes + a]], copy.elements[e * nodes + a]);
        }
        for (int32_t b = 0; b < body.block_count; b++)
            for (int32_t s = body.block[b].first; s < body.block[b].first + body.block[b].count; s++)
                for (int a = 0; a < nodes; a++)
                    ck_assert_int_eq(body.block_node[body.block[b].node_first + body.local[s * nodes + a]],
                                     body.element_node[s * nodes + a]);
        for (int32_t n = 0; n < body.node_count; n++) {
            for (int i = 0; i < body.dim; i++)
                ck_assert(brunt_fem_node(&body, n)[i] == (real)copy.nodes[body.node_id[n]][i]);
            for (int32_t k = body.partial_first[n]; k < body.partial_first[n + 1]; k++)
                ck_assert_int_eq(body.block_node[body.partial_of[k]], n);
        }
        ck_assert_int_eq(body.group_count, 1);
        ck_assert_int_eq(body.groups[0].count, 2);
        ck_assert_int_lt(body.groups[0].nodes[0], body.groups[0].nodes[1]);
        ck_assert_int_eq(body.node_id[body.groups[0].nodes[0]] + body.node_id[body.groups[0].nodes[1]], 13);
        ck_assert_uint_gt(brunt_fem_bytes(&body), 0);
        free(seen);
        brunt_mesh_free(&copy);
        brunt_fem_free(&body);
    }
    brunt_fem_workspace_free(&workspace);
    ck_assert_uint_eq(brunt_memory_live(), live);
}
END_TEST

START_TEST(hilbert_curve_goes_from_neighbour_to_neighbour) {
    for (int dim = 2; dim <= 3; dim++) {
        enum { BITS = 3, SIDE = 1 << BITS };
        int32_t at[SIDE * SIDE * SIDE][3];
        int count = dim == 3 ? SIDE * SIDE * SIDE : SIDE * SIDE;
        memset(at, -1, sizeof at);
        for (int k = 0; k < count; k++) {
            uint32_t x[3] = {(uint32_t)(k % SIDE), (uint32_t)(k / SIDE % SIDE), (uint32_t)(k / SIDE / SIDE)};
            uint64_t key = brunt_hilbert_key(dim, BITS, x);
            ck_assert_uint_lt(key, (uint64_t)count);
            ck_assert_int_eq(at[key][0], -1);
            for (int a = 0; a < 3; a++) at[key][a] = (int32_t)x[a];
        }
        for (int k = 1; k < count; k++)
            ck_assert_int_eq(abs(at[k][0] - at[k - 1][0]) + abs(at[k][1] - at[k - 1][1]) + abs(at[k][2] - at[k - 1][2]),
                             1);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ what goes wrong

START_TEST(inversion_is_found_where_it_is) {
    FOR_KINDS(kind) {
        brunt_mesh mesh = box_mesh(kind, 5, 1, 0.1, true);
        brunt_fem_body body = body_of(&mesh, (options){0});
        int32_t slot = body.block[body.block_count - 1].first + 3;
        const int nodes = body.traits->nodes;
        // All nodes through the centroid's plane: that element is inside out.
        double centre = 0;
        for (int a = 0; a < nodes; a++)
            centre += (double)brunt_fem_node(&body, body.element_node[slot * nodes + a])[0] / nodes;
        for (int a = 0; a < nodes; a++) {
            real *x = brunt_fem_node(&body, body.element_node[slot * nodes + a]);
            x[0] = (real)(2 * centre) - x[0];
        }
        brunt_fem_report report = forces(&body, 1e-4);
        ck_assert_int_ge(report.bad, 0);
        bool near = false; // the first found is one of those that share the nodes
        for (int a = 0; a < nodes; a++)
            for (int b = 0; b < nodes; b++)
                near = near || body.element_node[report.bad * nodes + a] == body.element_node[slot * nodes + b];
        ck_assert(near && body.element_id[report.bad] >= 0);
        ck_assert_ptr_nonnull(strstr(report.reason, "inside out"));
        brunt_fem_node(&body, 0)[0] = (real)NAN;
        ck_assert_int_ge(forces(&body, 1e-4).bad, 0);
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(folded_corners_are_counted) {
    FOR_KINDS(kind) {
        if (!brunt_elements[kind]->hourglass_modes) continue;
        double x[8][3];
        random_corners(kind, 0, x);
        brunt_mesh mesh = single_mesh(kind, (const double(*)[3])x);
        brunt_fem_body body = body_of(&mesh, (options){0});
        ck_assert_int_eq(brunt_fem_folded(&body), 0);
        for (int32_t n = 0; n < body.node_count; n++) // the corner at the origin beyond the diagonal of its neighbours
            for (int i = 0; i < body.dim && body.node_id[n] == 0; i++) brunt_fem_node(&body, n)[i] = (real)0.6;
        ck_assert_int_eq(forces(&body, 1).bad, -1);
        ck_assert_int_eq(brunt_fem_folded(&body), 1);
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(bad_meshes_are_refused) {
    FOR_KINDS(kind) {
        brunt_mesh mesh = box_mesh(kind, 2, 1, 0, false);
        int32_t *last = mesh.elements + (mesh.element_count - 1) * brunt_element_nodes(kind), swap = last[0];
        last[0] = last[1], last[1] = swap;
        if (kind == BRUNT_HEX8)
            for (int a = 0; a < 8; a++) last[a] = last[0];
        if (kind == BRUNT_QUAD4) swap = last[2], last[2] = last[3], last[3] = swap;
        brunt_body_def def = brunt_body_def_default();
        snprintf(def.name, sizeof def.name, "rod");
        def.hourglass_coefficient = NAN;
        brunt_material material = material_of("neo-hookean");
        brunt_fem_body body;
        brunt_error error = {0};
        size_t live = brunt_memory_live();
        ck_assert_int_eq(brunt_fem_make(&def, &material, brunt_element_dimension(kind), &mesh, &body, &error),
                         BRUNT_BAD_INPUT);
        char number[32];
        snprintf(number, sizeof number, "element %d ", mesh.element_count);
        ck_assert_msg(strstr(error.message, number) && strstr(error.message, "rod"), "%s", error.message);
        ck_assert_int_eq(brunt_fem_make(&def, &material, 5 - brunt_element_dimension(kind), &mesh, &body, &error),
                         BRUNT_BAD_INPUT);
        ck_assert_uint_eq(brunt_memory_live(), live);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

static void add_case(Suite *suite, const char *name, const TTest *const *tests, int count) {
    TCase *tcase = tcase_create(name);
    for (int i = 0; i < count; i++) tcase_add_test(tcase, tests[i]);
    suite_add_tcase(suite, tcase);
}

int main(void) {
    Suite *suite = suite_create("elements");
    const TTest *const geometry[] = {volume_is_exact, mean_gradient_is_the_slope_of_the_volume,
                                     faces_are_the_surface_and_point_outward, every_face_points_outward};
    const TTest *const motion[] = {rigid_motion_makes_no_stress, patch_test, forces_are_the_slope_of_the_energy,
                                   internal_forces_keep_momentum};
    const TTest *const hourglass[] = {hourglass_modes_are_resisted, affine_motions_are_no_hourglass};
    const TTest *const time[] = {energy_ledger_closes, nodes_give_the_sums_of_the_step,
                                 stable_step_is_a_bound_and_a_close_one, stable_step_of_a_cube,
                                 mass_scaling_reaches_its_step};
    const TTest *const order[] = {same_bits_for_any_number_of_threads, forces_without_a_step_are_the_same_bits,
                                  numbering_leads_back_to_the_mesh, hilbert_curve_goes_from_neighbour_to_neighbour};
    const TTest *const wrong[] = {inversion_is_found_where_it_is, folded_corners_are_counted, bad_meshes_are_refused};
#define ADD(list) add_case(suite, #list, list, (int)(sizeof list / sizeof *list))
    ADD(geometry);
    ADD(motion);
    ADD(hourglass);
    ADD(time);
    ADD(order);
    ADD(wrong);
    return suite_main(suite);
}
