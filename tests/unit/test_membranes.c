// Labels: verification
//
// Membrane elements by themselves: kinematics, forces, control of the in-plane and the warping mode, stable step, and
// closed forms (uniaxial tension, the tense string, Hencky's membrane).
#include <stdlib.h>

#include "base/error.h"
#include "tests/support/membrane_bodies.h"
#include "tests/support/suite.h"

static const double tolerance = sizeof(real) == 4 ? 2e-5 : 1e-11;
static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff", "linear-elastic"};

// Any state: nodes thrown about by up to `size` of an element (edge 1 / n).
static void scatter(brunt_fem_body *body, double size) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < 3; i++) brunt_fem_node(body, n)[i] += (real)(size * uniform(-1, 1));
}

static double greatest_membrane_stress(const brunt_fem_body *body) {
    double most = 0, sigma[6];
    for (int32_t s = 0; s < body->slots; s++) {
        brunt_membrane_stress(body, s, sigma);
        for (int c = 0; c < 6; c++) most = fmax(most, fabs(sigma[c]));
    }
    return most;
}

// ------------------------------------------------------------------------------------------ geometry

// Area and sum_a X_a (x) b_a of a flat element anywhere in space; faces, each once and oriented like its element.
START_TEST(geometry_is_that_of_the_plane) {
    FOR_MEMBRANES(kind) {
        brunt_mesh mesh = membrane_mesh(kind, 3, 2, 0.5, 0.2, 0, false);
        turn_mesh(&mesh, 1);
        double area = 0, R[3][3];
        rotation(3, 1, R);
        for (int32_t e = 0; e < mesh.element_count; e++) {
            double x[8][3];
            real b[8][3];
            for (int a = 0; a < brunt_element_nodes(kind); a++)
                memcpy(x[a], mesh.nodes[mesh.elements[e * brunt_element_nodes(kind) + a]], sizeof x[a]);
            area += brunt_elements[kind]->volume((const double(*)[3])x);
            brunt_elements[kind]->gradient((const double(*)[3])x, b);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    double sum = 0;
                    for (int a = 0; a < brunt_element_nodes(kind); a++) sum += x[a][i] * (double)b[a][j];
                    ck_assert_double_eq_tol(sum, (i == j) - R[i][2] * R[j][2], 10 * tolerance);
                }
        }
        ck_assert_double_eq_tol(area, 1.5, tolerance);
        int elements = mesh.element_count;
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){.thickness = 0.02});
        double volume = 0, mass = 0;
        for (int32_t s = 0; s < body.slots; s++)
            volume += (double)brunt_element_scalars(&body, BRUNT_ELEMENT_reference_volume)[0][s];
        for (int32_t n = 0; n < body.node_count; n++) mass += (double)brunt_fem_node(&body, n)[BRUNT_FEM_MASS];
        ck_assert_double_eq_tol(volume, 1.5 * 0.02, tolerance);
        ck_assert_double_eq_tol(mass, 1.5 * 0.02 * density, tolerance * density);
        brunt_faces faces;
        ck_assert_int_eq(brunt_fem_faces(&body, &faces, NULL), 0);
        ck_assert_int_eq(faces.count, elements);
        for (int32_t f = 0; f < faces.count; f++)
            for (int k = 0; k < 4; k++)
                ck_assert_int_eq(faces.node[f][k],
                                 k < body.traits->nodes
                                     ? body.element_node[(int64_t)faces.element[f] * body.traits->nodes + k]
                                     : -1);
        brunt_faces_free(&faces);
        ck_assert_double_gt(body.mean_edge, 0.4);
        ck_assert_double_lt(body.mean_edge, 0.65);
        ck_assert_int_eq(brunt_fem_folded(&body), 0);
        brunt_fem_free(&body);
    }
}
END_TEST

// Two layers that are joined along their border may have elements of the same nodes: both are faces.
START_TEST(layers_of_the_same_nodes_are_two_faces) {
    const double corner[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    brunt_mesh mesh = single_mesh(BRUNT_MEMBRANE_TRI3, corner);
    brunt_free(mesh.elements);
    mesh.elements = brunt_alloc(6 * sizeof *mesh.elements);
    mesh.element_count = 2;
    memcpy(mesh.elements, (int32_t[]){0, 1, 2, 0, 2, 1}, 6 * sizeof *mesh.elements);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
    brunt_faces faces;
    ck_assert_int_eq(brunt_fem_faces(&body, &faces, NULL), 0);
    ck_assert_int_eq(faces.count, 2);
    brunt_faces_free(&faces);
    brunt_fem_free(&body);
}
END_TEST

START_TEST(corners_that_turn_over_are_counted) {
    double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.3, 0}, {0, 1, 0}};
    const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    brunt_mesh mesh = single_mesh(BRUNT_MEMBRANE_QUAD4, square);
    turn_mesh(&mesh, 2);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
    double R[3][3];
    rotation(3, 0.7, R);
    for (int32_t n = 0; n < 4; n++)
        for (int i = 0; i < 3; i++) {
            const double *at = x[body.node_id[n]];
            brunt_fem_node(&body, n)[i] = (real)(R[i][0] * at[0] + R[i][1] * at[1] + R[i][2] * at[2]);
        }
    ck_assert_int_eq(brunt_fem_folded(&body), 1);
    brunt_fem_free(&body);
}
END_TEST

// ------------------------------------------------------------------------------------------ motions

// B28. A warped sheet as it is made, and after ten thousand turns about an axis across it, has neither stress nor
// springs.
START_TEST(rigid_motion_makes_no_stress) {
    FOR_MEMBRANES(kind)
    for (int m = 0; m < 3; m++) {
        brunt_mesh mesh = membrane_mesh(kind, 4, 4, 0.25, 0.25, 0.3, true);
        turn_mesh(&mesh, 2);
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){.model = models[m]});
        for (int t = 1; t <= 1000; t++) {
            double R[3][3], shift[3] = {0.01 * t, -0.02 * t, 0.003 * t};
            rotation(3, 20 * acos(-1) * t + 1e-3 * t, R);
            move_affine(&body, R, shift);
            ck_assert_int_eq(forces(&body, 1e-3).bad, -1);
        }
        brunt_fem_report report = forces(&body, 1e-3);
        double limit = sizeof(real) == 4 ? 1e-3 : 1e-12;
        ck_assert_msg(greatest_membrane_stress(&body) < limit * E, "%s %s: stress %g E", body.traits->name, models[m],
                      greatest_membrane_stress(&body) / E);
        ck_assert_double_lt(energy_of(&body, &report), limit * limit * E);
        brunt_fem_free(&body);
    }
}
END_TEST

// Stress of a stretch A in the reference plane, by one element: the patch test compares others with it.
static void stress_of(double A[3][3], membrane_options o, double sigma[6], double *across) {
    const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    brunt_mesh mesh = single_mesh(BRUNT_MEMBRANE_QUAD4, square);
    brunt_fem_body body = membrane_of(&mesh, o);
    double shift[3] = {0};
    move_affine(&body, A, shift);
    forces(&body, 1e-3);
    brunt_membrane_stress(&body, 0, sigma);
    *across = (double)brunt_element_scalars(&body, BRUNT_ELEMENT_thickness_stretch)[0][0];
    brunt_fem_free(&body);
}

// B28. An affine motion, out of the plane too, of a distorted flat mesh that lies anywhere in space.
START_TEST(patch_test) {
    FOR_MEMBRANES(kind)
    for (int m = 0; m < 3; m++) {
        membrane_options o = {.model = models[m]};
        double A[3][3] = {{1.2, 0.3, 0}, {0.05, 0.9, 0}, {0.4, -0.2, 1}}, R[3][3], B[3][3] = {{0}},
               shift[3] = {3, 4, 5};
        double sigma[6], across;
        stress_of(A, o, sigma, &across);
        brunt_mesh mesh = membrane_mesh(kind, 4, 3, 0.25, 0.25, 0, false);
        turn_mesh(&mesh, 1);
        rotation(3, 1, R);
        for (int i = 0; i < 3; i++) // A R^T: back to the plane, then as above
            for (int j = 0; j < 3; j++)
                for (int k = 0; k < 3; k++) B[i][j] += A[i][k] * R[j][k];
        brunt_fem_body body = membrane_of(&mesh, o);
        move_affine(&body, B, shift);
        brunt_fem_report report = forces(&body, 1e-3);
        ck_assert_int_eq(report.bad, -1);
        for (int32_t s = 0; s < body.slots; s++) {
            double at[6];
            brunt_membrane_stress(&body, s, at);
            for (int c = 0; c < 6; c++) ck_assert_double_eq_tol(at[c], sigma[c], 100 * tolerance * E);
            ck_assert_double_eq_tol((double)brunt_element_scalars(&body, BRUNT_ELEMENT_thickness_stretch)[0][s], across,
                                    100 * tolerance);
        }
        ck_assert_double_lt(report.hourglass_stored, 1e4 * tolerance * tolerance * E);
        double scale = force_scale(&body);
        int inner = 0;
        for (int32_t n = 0; n < body.node_count; n++) {
            int k = body.node_id[n], x = k % 5, y = k / 5;
            if (x == 0 || x == 4 || y == 0 || y == 3) continue;
            real f[3];
            brunt_fem_internal_force(&body, n, f);
            for (int i = 0; i < 3; i++) ck_assert_double_lt(fabs((double)f[i]), 100 * tolerance * scale);
            inner++;
        }
        ck_assert_int_eq(inner, 6);
        brunt_fem_free(&body);
    }
}
END_TEST

// Uniaxial tension of St. Venant-Kirchhoff material: S = E (l^2 - 1) / 2 along, width and thickness strain -nu times it
// (both Green's), sigma = l S / (l2 l3).
START_TEST(uniaxial_tension_is_exact) {
    FOR_MEMBRANES(kind) {
        double l = 1.3, green = 0.5 * (l * l - 1), l2 = sqrt(1 - 2 * nu * green), l3 = l2;
        brunt_mesh mesh = membrane_mesh(kind, 3, 3, 1, 0.2, 0, false);
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){.model = "st-venant-kirchhoff"});
        double A[3][3] = {{l, 0, 0}, {0, l2, 0}, {0, 0, 1}}, shift[3] = {0};
        move_affine(&body, A, shift);
        forces(&body, 1e-3);
        for (int32_t s = 0; s < body.slots; s++) {
            double sigma[6];
            brunt_membrane_stress(&body, s, sigma);
            ck_assert_double_eq_tol(sigma[0], l * E * green / (l2 * l3), 100 * tolerance * E);
            for (int c = 1; c < 6; c++) ck_assert_double_eq_tol(sigma[c], 0, 100 * tolerance * E);
            ck_assert_double_eq_tol((double)brunt_element_scalars(&body, BRUNT_ELEMENT_thickness_stretch)[0][s], l3,
                                    100 * tolerance);
        }
        brunt_fem_free(&body);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ forces

START_TEST(forces_are_the_slope_of_the_energy) {
    if (sizeof(real) == 4) return;
    FOR_MEMBRANES(kind)
    for (int m = 0; m < 6; m++) {
        membrane_options o = {
            .model = models[m % 3], .tension_only = m >= 3, .coefficient = m % 2 ? 1 : 0, .thickness = 0.15};
        brunt_mesh mesh = membrane_mesh(kind, 2, 2, 0.5, 0.2, 0.3, true);
        turn_mesh(&mesh, 1);
        brunt_fem_body body = membrane_of(&mesh, o);
        scatter(&body, 0.08);
        brunt_fem_report report = forces(&body, 1e-3);
        ck_assert_int_eq(report.bad, -1);
        double f[16][3], scale = force_scale(&body);
        for (int32_t n = 0; n < body.node_count; n++) {
            real g[3];
            brunt_fem_internal_force(&body, n, g);
            for (int i = 0; i < 3; i++) f[n][i] = (double)g[i];
        }
        for (int32_t n = 0; n < body.node_count; n++)
            for (int i = 0; i < 3; i++) {
                real *x = brunt_fem_node(&body, n) + i, at = *x;
                double energy[2], h = 1e-6;
                for (int side = 0; side < 2; side++) {
                    *x = (real)((double)at + (side ? h : -h));
                    report = forces(&body, 1e-3);
                    energy[side] = energy_of(&body, &report);
                }
                *x = at;
                ck_assert_msg(fabs((energy[0] - energy[1]) / (2 * h) - f[n][i]) < 1e-6 * scale,
                              "%s %s %d: node %d, %d: %g, force %g", body.traits->name, o.model, m, n, i,
                              (energy[0] - energy[1]) / (2 * h), f[n][i]);
            }
        if (kind == BRUNT_MEMBRANE_QUAD4) ck_assert_double_gt(report.hourglass_stored, 0);
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(forces_have_no_resultant) {
    FOR_MEMBRANES(kind)
    for (int k = 0; k < 20; k++) {
        brunt_mesh mesh = membrane_mesh(kind, 3, 3, 1, 0.25, 0.3, true);
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){.coefficient = 1});
        scatter(&body, 0.3);
        if (forces(&body, 1e-3).bad >= 0) {
            brunt_fem_free(&body);
            continue;
        }
        double sum[3] = {0}, torque[3] = {0}, scale = force_scale(&body);
        for (int32_t n = 0; n < body.node_count; n++) {
            const real *x = brunt_fem_node(&body, n);
            real f[3];
            brunt_fem_internal_force(&body, n, f);
            for (int i = 0; i < 3; i++) {
                int a = (i + 1) % 3, b = (i + 2) % 3;
                sum[i] += (double)f[i];
                torque[i] += (double)x[a] * (double)f[b] - (double)x[b] * (double)f[a];
            }
        }
        for (int i = 0; i < 3; i++) {
            ck_assert_double_lt(fabs(sum[i]), 10 * tolerance * scale);
            ck_assert_double_lt(fabs(torque[i]), 30 * tolerance * scale);
        }
        brunt_fem_free(&body);
    }
}
END_TEST

// A square of side 1 by its hourglass mode of amplitude a at each corner: q = 4 a. In the plane k = coefficient M t /
// 4; across it k_w = k t^2 without tension, with tension T (force per length) T tr M / (1 + ...) = T / 6 more.
START_TEST(hourglass_modes_are_resisted) {
    const double t = 0.05, a = sizeof(real) == 4 ? 1e-4 : 1e-5, stretched = 1.01;
    for (int tense = 0; tense < 2; tense++)
        for (int i = 0; i < 3; i++) {
            const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
            brunt_mesh mesh = single_mesh(BRUNT_MEMBRANE_QUAD4, square);
            brunt_fem_body body =
                membrane_of(&mesh, (membrane_options){.thickness = t, .model = "st-venant-kirchhoff"});
            double l = tense ? stretched : 1, A[3][3] = {{l, 0, 0}, {0, l, 0}, {0, 0, 1}}, shift[3] = {0};
            move_affine(&body, A, shift);
            for (int32_t n = 0; n < 4; n++) brunt_fem_node(&body, n)[i] += (real)(body.node_id[n] % 2 ? -a : a);
            brunt_fem_report report = forces(&body, 1e-3);
            double M = density * pow((double)body.material.wave_speed, 2), k = 0.05 * M * t / 4;
            double S = E / (1 - nu) * 0.5 * (l * l - 1); // second Piola-Kirchhoff
            double spring = i < 2 ? k : k * t * t, whole = spring + t * S / 6;
            for (int32_t n = 0; n < 4; n++) {
                real f[3];
                brunt_fem_internal_force(&body, n, f);
                double flat = 0; // the force of the stretch itself
                if (i < 2) {
                    double corner = square[body.node_id[n]][i] - 0.5;
                    flat = -corner * t * S * l;
                }
                double push = -(body.node_id[n] % 2 ? -1 : 1) * whole * 4 * a;
                ck_assert_double_eq_tol((double)f[i] - flat, push, sizeof(real) == 4 ? 0.05 * k * a : 2e-3 * whole * a);
            }
            ck_assert_double_eq_tol(report.hourglass_stored, 8 * spring * a * a, 1e-2 * 8 * spring * a * a);
            brunt_fem_free(&body);
        }
}
END_TEST

// ------------------------------------------------------------------------------------------ time

// Elements of any shape, warped at the start or not, stretched, twisted, compressed.
START_TEST(stable_step_is_a_bound_and_a_close_one) {
    if (sizeof(real) == 4) return; // no second differences of floats
    FOR_MEMBRANES(kind) {
        double worst = INFINITY, mean = 0;
        int count = 0;
        for (int k = 0; k < 600; k++) {
            membrane_options o = {.model = models[k % 2],
                                  .thickness = k % 7 ? 0.05 : 0.8,
                                  .coefficient = k % 5 ? 0 : 1,
                                  .tension_only = k % 3 == 1};
            double jitter = k % 11 ? 0.3 : 0;
            brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, 1, 1, 1, jitter, k % 4 ? 0 : 0.3, true);
            if (kind == BRUNT_MEMBRANE_TRI3) mesh.kind = kind, mesh.node_count = 3;
            if (kind == BRUNT_MEMBRANE_TRI3) memcpy(mesh.elements, (int32_t[]){0, 1, 2}, 3 * sizeof(int32_t));
            if (k % 13 == 0)
                for (int n = 0; n < mesh.node_count; n++) mesh.nodes[n][1] *= 0.2;
            brunt_fem_body body = membrane_of(&mesh, o);
            double l = uniform(0.9, 1.3), A[3][3] = {{l, 0.1, 0}, {0.1, 0.95 * l, 0.2}, {0.2, 0.1, 1}}, shift[3] = {0};
            if (o.tension_only) // folds may be crushed to almost nothing, beside tension or not
                for (int i = 0; i < 3; i++) A[i][1] *= uniform(0.02, 1), A[i][0] *= uniform(0.9, 1.2);
            ck_assert_double_eq_tol(forces(&body, 0).stable_step, body.least_step, 1e-3 * body.least_step);
            if (k % 2) move_affine(&body, A, shift);
            scatter(&body, k % 3 ? 0.05 : 0.2);
            brunt_fem_report report = forces(&body, 1e-3);
            if (report.bad < 0) {
                double bound = 4 / (report.stable_step * report.stable_step), ratio = bound / true_frequency(&body);
                ck_assert_msg(ratio > 1 - 1e-4, "%s %d: bound over frequency squared %g", body.traits->name, k, ratio);
                worst = fmin(worst, ratio);
                // How close: not of slack ones, which may have no stiffness at all, nor where strain itself stiffens
                // the material along one axis and the bound takes it along both.
                if (!o.tension_only && k % 2 == 0) mean += ratio, count++;
            }
            brunt_fem_free(&body);
        }
        ck_assert_int_gt(count, 150);
        ck_assert_msg(mean / count < (kind == BRUNT_MEMBRANE_QUAD4 ? 1.3 : 1.2), "%s: bound on average %g too high",
                      brunt_element_name(kind), mean / count);
        if (getenv("SHOW"))
            printf("%s: bound / omega^2 %.4f .., mean %.4f\n", brunt_element_name(kind), worst, mean / count);
    }
}
END_TEST

static void throw_nodes(brunt_fem_body *body, double speed) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < 3; i++) brunt_fem_node(body, n)[BRUNT_FEM_V + i] = (real)(speed * uniform(-1, 1));
}

// Growth of a small motion in a tense sheet, held at its edge.
static double growth(double share) {
    random_state = 3;
    brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, 1, 1, 1, 0, 0, false);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
    throw_nodes(&body, 1e-4);
    double most = 0, dt = share * body.least_step;
    for (int k = 0; k < 3000 && most < 1e3; k++) {
        brunt_fem_sums sums;
        if (step(&body, dt, &sums).bad >= 0) most = INFINITY;
        most = fmax(most, sums.speed / 1e-4);
    }
    brunt_fem_free(&body);
    return most;
}

START_TEST(steps_below_the_stable_one_are_stable) {
    ck_assert_double_lt(growth(0.99), 50);
    ck_assert_double_gt(growth(1.05), 100); // the bound is sharp for a square
}
END_TEST

START_TEST(mass_scaling_reaches_its_step) {
    FOR_MEMBRANES(kind) {
        membrane_options o = {.thickness = 0.02};
        random_state = 1;
        brunt_mesh mesh = membrane_mesh(kind, 4, 4, 0.25, 0.3, 0.1, false);
        brunt_fem_body plain = membrane_of(&mesh, o);
        double step = plain.least_step, mass = 0, added = 0;
        for (int32_t n = 0; n < plain.node_count; n++) mass += (double)brunt_fem_node(&plain, n)[BRUNT_FEM_MASS];
        brunt_fem_free(&plain);
        random_state = 1;
        mesh = membrane_mesh(kind, 4, 4, 0.25, 0.3, 0.1, false);
        o.mass_scaling = 1.2 * step;
        brunt_fem_body scaled = membrane_of(&mesh, o);
        for (int32_t n = 0; n < scaled.node_count; n++) added += (double)brunt_fem_node(&scaled, n)[BRUNT_FEM_MASS];
        ck_assert_double_ge(scaled.least_step, o.mass_scaling);
        ck_assert_double_ge(forces(&scaled, 0).stable_step, o.mass_scaling);
        ck_assert_int_gt(scaled.scaled_elements, 0);
        ck_assert_double_eq_tol(added - mass, scaled.added_mass, 1e2 * tolerance * mass);
        brunt_fem_free(&scaled);
    }
}
END_TEST

static double ledger_error(brunt_element_kind kind, double dt, double end) {
    random_state = 5;
    brunt_mesh mesh = membrane_mesh(kind, 3, 3, 0.33, 0.2, 0.2, true);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
    throw_nodes(&body, 3);
    brunt_fem_sums sums;
    brunt_fem_report report = forces(&body, 0);
    double kinetic = 0, worst = 0;
    for (int32_t n = 0; n < body.node_count; n++) {
        const real *node = brunt_fem_node(&body, n);
        for (int i = 0; i < 3; i++)
            kinetic += 0.5 * (double)node[BRUNT_FEM_MASS] * pow((double)node[BRUNT_FEM_V + i], 2);
    }
    for (int k = 0; k < (int)(end / dt); k++) {
        report = step(&body, dt, &sums);
        ck_assert_int_eq(report.bad, -1);
        double total = sums.kinetic - 0.5 * report.stress_work + energy_of(&body, &report);
        worst = fmax(worst, fabs(total / kinetic - 1));
    }
    brunt_fem_free(&body);
    return worst;
}

// Free vibration, with warping of elements that are in compression as often as in tension.
START_TEST(energy_ledger_closes) {
    if (sizeof(real) == 4) return;
    FOR_MEMBRANES(kind) {
        double dt = 1e-3, coarse = ledger_error(kind, dt, 200 * dt), fine = ledger_error(kind, dt / 4, 200 * dt);
        ck_assert_msg(fine < 2e-3 && coarse / fine > 10, "%s: errors %g, %g", brunt_element_name(kind), coarse, fine);
    }
}
END_TEST

START_TEST(forces_without_a_step_are_the_same_bits) {
    FOR_MEMBRANES(kind) {
        brunt_mesh mesh = membrane_mesh(kind, 9, 9, 0.1, 0.2, 0.2, true);
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
        scatter(&body, 0.02);
        double stable = forces(&body, 1e-3).stable_step;
        size_t bytes = (size_t)body.partial_count * 4 * sizeof(real);
        real *kept = brunt_alloc(bytes);
        memcpy(kept, body.partial, bytes);
        memset(body.partial, 1, bytes);
        ck_assert_double_gt(stable, 0);
        forces(&body, 0);
        ck_assert_int_eq(memcmp(kept, body.partial, bytes), 0);
        brunt_free(kept);
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(what_is_no_membrane_is_refused) {
    const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    brunt_material material = membrane_material((membrane_options){0});
    for (int k = 0; k < 3; k++) {
        brunt_mesh mesh = single_mesh(BRUNT_MEMBRANE_QUAD4, square);
        brunt_body_def def = brunt_body_def_default();
        def.thickness = k == 0 ? 0 : 0.1;
        if (k == 1) def.hourglass = BRUNT_HOURGLASS_VISCOUS;
        brunt_fem_body body;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_fem_make(&def, &material, k == 2 ? 2 : 3, &mesh, &body, &error), BRUNT_BAD_INPUT);
        ck_assert(strstr(error.message, k == 0 ? "thickness" : k == 1 ? "hourglass" : "dimensional") != NULL);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ closed forms

// Frequency of the first transverse mode of a string of n quadrilaterals held at both ends, over pi c / L with
// c^2 = sigma / rho in its present density.
static double string_frequency(int n) {
    const double l = 1.2, dt_share = 0.2;
    brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, n, 1, 1.0 / n, 0, 0, false);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){.model = "st-venant-kirchhoff", .nu = -1});
    double A[3][3] = {{l, 0, 0}, {0, 1, 0}, {0, 0, 1}}, shift[3] = {0}, sigma[6], pi = acos(-1);
    move_affine(&body, A, shift);
    double dt = dt_share * forces(&body, 1e-9).stable_step / n * 8, time = 0, mode = 0;
    brunt_membrane_stress(&body, 0, sigma);
    double c = sqrt(sigma[0] / (density / l)), expected = pi * c / l;
    for (int32_t k = 0; k < body.node_count; k++)
        brunt_fem_node(&body, k)[BRUNT_FEM_V + 2] = (real)(1e-4 * sin(pi * (double)start_of(&body, k)[0]));
    // A quarter of a period is when the velocity of the mode changes sign; here, three quarters.
    int turns = 0;
    double last = 1, crossing = 0;
    while (turns < 3) {
        const double none[3] = {0};
        brunt_fem_sums sums;
        brunt_fem_kick(&body, 0, body.node_count, dt, none, &sums);
        mode = 0;
        for (int32_t k = 0; k < body.node_count; k++) {
            double X = (double)start_of(&body, k)[0];
            real *v = brunt_fem_node(&body, k) + BRUNT_FEM_V;
            if (X < 1e-9 || X > 1 - 1e-9) v[0] = v[1] = v[2] = 0;
            mode += (double)v[2] * sin(pi * X);
        }
        if ((mode < 0) != (last < 0)) turns++, crossing = time - dt + dt * last / (last - mode);
        last = mode;
        brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
        forces(&body, dt);
        time += dt;
        ck_assert_double_lt(time, 100 * l / c);
    }
    brunt_fem_free(&body);
    // Velocities are at half steps; the first kick, without a force, is at time 0.
    return 2.5 * pi / (crossing + 0.5 * dt) / expected;
}

START_TEST(a_tense_string_carries_transverse_waves) {
    if (sizeof(real) == 4) return;
    double coarse = fabs(string_frequency(8) - 1), fine = fabs(string_frequency(16) - 1);
    ck_assert_msg(fine < 2e-3 && coarse / fine > 3.5 && coarse / fine < 4.6, "errors %g, %g", coarse, fine);
}
END_TEST

typedef struct hencky {
    double deflection, stress, hourglass; // over the closed form's; springs' share of the stored energy
    int steps;
} hencky;

// A clamped disk of radius 1 under pressure (Hencky 1915; coefficients for nu = 0.3): w0 = 0.6534 a (p a / E t)^(1/3),
// sigma_c = 0.4311 (E p^2 a^2 / t^2)^(1/3). Dynamic relaxation of a quarter, started from a paraboloid.
static hencky hencky_membrane(int m, int rings, double slope, double t) {
    const double p = E * t * pow(slope / 0.6534, 3), stress = 0.4311 * cbrt(E * p * p / (t * t));
    brunt_mesh mesh = quarter_disk(m, rings);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){.thickness = t, .nu = 0.3});
    body.load = brunt_alloc((size_t)body.node_count * 4 * sizeof(real));
    int32_t centre = 0;
    for (int32_t n = 0; n < body.node_count; n++) {
        const real *X = start_of(&body, n);
        brunt_fem_node(&body, n)[2] = (real)(slope * (1 - (double)X[0] * (double)X[0] - (double)X[1] * (double)X[1]));
        if (body.node_id[n] == 0) centre = n;
    }
    const double damping = 2 * 2.405 * sqrt(stress / density), none[3] = {0};
    brunt_fem_report report = forces(&body, 1e-9);
    double time = 0, end = 40 / damping;
    hencky result = {0};
    while (time < end) {
        double dt = 0.9 * report.stable_step;
        memset(body.load, 0, (size_t)body.node_count * 4 * sizeof(real));
        for (int32_t s = 0; s < body.slots; s++) {
            if (body.element_id[s] < 0) continue;
            const real *x[4];
            for (int a = 0; a < 4; a++) x[a] = brunt_fem_node(&body, body.element_node[(int64_t)s * 4 + a]);
            for (int i = 0; i < 3; i++) {
                int j = (i + 1) % 3, k = (i + 2) % 3;
                double twice =
                    (double)((x[2][j] - x[0][j]) * (x[3][k] - x[1][k]) - (x[2][k] - x[0][k]) * (x[3][j] - x[1][j]));
                for (int a = 0; a < 4; a++)
                    body.load[(size_t)body.element_node[(int64_t)s * 4 + a] * 4 + (size_t)i] += (real)(p * twice / 8);
            }
        }
        brunt_fem_sums sums;
        brunt_fem_kick(&body, 0, body.node_count, dt, none, &sums);
        for (int32_t n = 0; n < body.node_count; n++) {
            real *v = brunt_fem_node(&body, n) + BRUNT_FEM_V;
            const real *X = start_of(&body, n);
            for (int i = 0; i < 3; i++) v[i] *= (real)(1 - damping * dt);
            if (fabs((double)X[0]) < 1e-6) v[0] = 0;
            if (fabs((double)X[1]) < 1e-6) v[1] = 0;
            if (hypot((double)X[0], (double)X[1]) > 1 - 1e-6) v[0] = v[1] = v[2] = 0;
        }
        brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
        report = forces(&body, dt);
        ck_assert_int_eq(report.bad, -1);
        time += dt;
        result.steps++;
    }
    double sigma[6];
    for (int32_t s = 0; s < body.slots; s++)
        if (body.element_id[s] == 0) brunt_membrane_stress(&body, s, sigma);
    result.deflection = (double)brunt_fem_node(&body, centre)[2] / slope;
    result.stress = 0.5 * (sigma[0] + sigma[1]) / stress;
    result.hourglass = report.hourglass_stored / brunt_fem_energy(&body, 0, body.block_count).internal;
    brunt_fem_free(&body);
    return result;
}

// B26.
START_TEST(hencky_membrane_under_pressure) {
    hencky h[3];
    for (int k = 0; k < 3; k++) {
        h[k] = hencky_membrane(2 << k, 3 << k, 0.05, 0.001);
        if (getenv("SHOW"))
            printf("%d elements a radius: deflection %.5f, stress %.5f, hourglass %.2e, %d steps\n", 5 << k,
                   h[k].deflection, h[k].stress, h[k].hourglass, h[k].steps);
        ck_assert_double_lt(h[k].hourglass, 0.01);
    }
    ck_assert_double_eq_tol(h[2].deflection, 1, 0.01);
    ck_assert_double_eq_tol(h[2].stress, 1, 0.02);
    // The springs against warping are no bending stiffness, not even of a sheet as thick as its elements are long.
    ck_assert_double_eq_tol(hencky_membrane(4, 6, 0.05, 0.1).deflection, h[1].deflection, 0.003);
    // Differences of meshes fall by four with each halving of the elements.
    double change[2] = {h[1].deflection - h[0].deflection, h[2].deflection - h[1].deflection};
    ck_assert_double_gt(change[0] / change[1], 2.5);
}
END_TEST

static void add_case(Suite *suite, const char *name, const TTest *const *tests, int count) {
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 0);
    for (int i = 0; i < count; i++) tcase_add_test(tcase, tests[i]);
    suite_add_tcase(suite, tcase);
}

int main(void) {
    Suite *suite = suite_create("membranes");
    const TTest *const geometry[] = {geometry_is_that_of_the_plane, layers_of_the_same_nodes_are_two_faces,
                                     corners_that_turn_over_are_counted, what_is_no_membrane_is_refused};
    const TTest *const motion[] = {rigid_motion_makes_no_stress, patch_test, uniaxial_tension_is_exact};
    const TTest *const force[] = {forces_are_the_slope_of_the_energy, forces_have_no_resultant,
                                  hourglass_modes_are_resisted, forces_without_a_step_are_the_same_bits};
    const TTest *const time[] = {stable_step_is_a_bound_and_a_close_one, steps_below_the_stable_one_are_stable,
                                 mass_scaling_reaches_its_step, energy_ledger_closes};
    const TTest *const closed_form[] = {a_tense_string_carries_transverse_waves, hencky_membrane_under_pressure};
#define ADD(list) add_case(suite, #list, list, (int)(sizeof list / sizeof *list))
    ADD(geometry);
    ADD(motion);
    ADD(force);
    ADD(time);
    ADD(closed_form);
    return suite_main(suite);
}
