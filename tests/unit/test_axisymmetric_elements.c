//
// Axisymmetric elements by themselves: integrals over the ring, forces, hourglass control, stable step.
#include <stdlib.h>

#include "tests/support/fem_bodies.h"
#include "fem/layout.h"
#include "tests/support/suite.h"

static const double tolerance = sizeof(real) == 4 ? 2e-5 : 1e-11;
static const brunt_element_kind kinds[] = {BRUNT_TRI3, BRUNT_QUAD4};
#define FOR_RINGS(kind) for (int q_ = 0, kind = 0; q_ < 2 && (kind = (int)kinds[q_], true); q_++)

static brunt_fem_body ring_of(brunt_mesh *mesh, options o) {
    brunt_body_def def = brunt_body_def_default();
    snprintf(def.name, sizeof def.name, "b");
    def.method = BRUNT_FEM;
    def.hourglass = o.hourglass;
    def.hourglass_coefficient = o.coefficient > 0 ? o.coefficient : NAN;
    def.mass_scaling = o.mass_scaling;
    brunt_material material = material_of(o.model ? o.model : "neo-hookean");
    brunt_fem_body body;
    brunt_error error = {0};
    ck_assert_msg(brunt_fem_make_axisymmetric(&def, &material, mesh, &body, &error) == BRUNT_OK, "%s", error.message);
    brunt_mesh_free(mesh);
    ck_assert_int_eq(brunt_fem_workspace_fit(&workspace, &body, NULL), 0);
    return body;
}

// A box of n cells a side from r = `inner` on, distorted; nodes at r = 0 stay there.
static brunt_mesh ring_mesh(brunt_element_kind kind, int n, double inner, double jitter) {
    brunt_mesh mesh = box_mesh(kind, n, 1, jitter, true);
    for (int32_t k = 0; k < mesh.node_count; k++) {
        const bool first = k % (n + 1) == 0;
        mesh.nodes[k][0] = inner == 0 && first ? 0 : mesh.nodes[k][0] + inner;
    }
    return mesh;
}

// 2 pi int f R dA by 3 x 3 Gauss points of the bilinear map (triangles: of the collapsed quadrilateral).
static void integrate(int nodes, const double (*x)[3], double mass[4], double gradient[4][2], double hoop[4],
                      double *volume) {
    static const double at[3] = {-0.774596669241483377, 0, 0.774596669241483377}, w[3] = {5. / 9, 8. / 9, 5. / 9};
    double X[4][2];
    *volume = 0;
    for (int a = 0; a < 4; a++) {
        for (int i = 0; i < 2; i++) X[a][i] = x[nodes == 3 && a == 3 ? 2 : a][i];
        mass[a] = hoop[a] = gradient[a][0] = gradient[a][1] = 0;
    }
    for (int p = 0; p < 9; p++) {
        const double s = at[p % 3], t = at[p / 3];
        const double N[4] = {(1 - s) * (1 - t) / 4, (1 + s) * (1 - t) / 4, (1 + s) * (1 + t) / 4,
                             (1 - s) * (1 + t) / 4};
        const double d[2][4] = {{-(1 - t) / 4, (1 - t) / 4, (1 + t) / 4, -(1 + t) / 4},
                                {-(1 - s) / 4, -(1 + s) / 4, (1 + s) / 4, (1 - s) / 4}};
        double J[2][2] = {{0}}, R = 0;
        for (int a = 0; a < 4; a++) {
            R += N[a] * X[a][0];
            for (int i = 0; i < 2; i++)
                for (int k = 0; k < 2; k++) J[i][k] += X[a][i] * d[k][a];
        }
        const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0], g = w[p % 3] * w[p / 3] * 2 * M_PI;
        *volume += g * det * R;
        for (int a = 0; a < 4; a++) {
            const int to = nodes == 3 && a == 3 ? 2 : a;
            mass[to] += g * det * R * N[a];
            hoop[to] += g * det * N[a];
            gradient[to][0] += g * R * (d[0][a] * J[1][1] - d[1][a] * J[1][0]);
            gradient[to][1] += g * R * (d[1][a] * J[0][0] - d[0][a] * J[0][1]);
        }
    }
}

static void random_section(int kind, double inner, double jitter, double (*x)[3]) {
    static const double square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int a = 0; a < 4; a++) {
        for (int i = 0; i < 2; i++) x[a][i] = square[a][i] + jitter * uniform(-1, 1);
        x[a][0] = inner == 0 && (a == 0 || (a == 3 && kind == BRUNT_QUAD4)) ? 0 : x[a][0] + inner;
        x[a][2] = 0;
    }
}

START_TEST(integrals_over_the_ring_are_exact) {
    FOR_RINGS(kind)
    for (int t = 0; t < 40; t++) {
        const brunt_element *type = brunt_axisymmetric_elements[kind];
        double x[4][3], mass[4], gradient[4][2], hoop[4], volume, share[4], sum = 0, round_ = 0;
        random_section(kind, t % 4 == 0 ? 0 : t % 4 == 1 ? 0.3 : 3, 0.25, x);
        integrate(type->traits->nodes, (const double(*)[3])x, mass, gradient, hoop, &volume);
        real b[BRUNT_ELEMENT_NODES][3];
        type->gradient((const double(*)[3])x, b);
        type->shares((const double(*)[3])x, share);
        for (int a = 0; a < type->traits->nodes; a++) {
            ck_assert_double_eq_tol(share[a], mass[a], tolerance * volume);
            ck_assert_double_eq_tol((double)b[a][2] * volume, hoop[a], tolerance * volume);
            for (int i = 0; i < 2; i++)
                ck_assert_double_eq_tol((double)b[a][i] * volume, gradient[a][i], 10 * tolerance * volume);
            sum += share[a];
            round_ += (double)b[a][2] * x[a][0];
        }
        ck_assert_double_eq_tol(sum, volume, tolerance * volume);
        ck_assert_double_eq_tol(round_, 1, 10 * tolerance);
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) {
                double unit = 0;
                for (int a = 0; a < type->traits->nodes; a++) unit += x[a][i] * (double)b[a][j];
                ck_assert_double_eq_tol(unit, i == j, 20 * tolerance);
            }
    }
}
END_TEST

START_TEST(bodies_have_the_mass_of_the_circle) {
    FOR_RINGS(kind)
    for (int far = 0; far < 2; far++) {
        brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 5, far, 0);
        for (int32_t n = 0; n < mesh.node_count; n++) // inner nodes elsewhere: the volume is the same
            if (mesh.nodes[n][1] > 0.1 && mesh.nodes[n][1] < 0.9 && mesh.nodes[n][0] > far + 0.1 &&
                mesh.nodes[n][0] < far + 0.9)
                for (int i = 0; i < 2; i++) mesh.nodes[n][i] += 0.04 * uniform(-1, 1);
        brunt_fem_body body = ring_of(&mesh, (options){0});
        double mass = 0, moment = 0;
        for (int32_t n = 0; n < body.node_count; n++) {
            const real *node = brunt_fem_node(&body, n);
            mass += (double)node[BRUNT_FEM_MASS], moment += (double)node[BRUNT_FEM_MASS] * (double)node[1];
            ck_assert_int_eq(body.held[n], node[0] == 0);
        }
        const double exact = density * M_PI * (pow(far + 1, 2) - far * far);
        ck_assert_double_eq_tol(mass, exact, tolerance * exact);
        ck_assert_double_eq_tol(moment, exact / 2, tolerance * exact); // rows of the consistent matrix keep the centre
        brunt_faces faces;
        ck_assert_int_eq(brunt_fem_faces(&body, &faces, NULL), 0);
        ck_assert_int_eq(faces.count, far ? 20 : 15);
        brunt_faces_free(&faces);
        brunt_fem_free(&body);
    }
}
END_TEST

static void stretch_to(brunt_fem_body *body, double a, double c, double d, double shift) {
    for (int32_t n = 0; n < body->node_count; n++) {
        const real *X = start_of(body, n);
        brunt_fem_node(body, n)[0] = (real)a * X[0];
        brunt_fem_node(body, n)[1] = (real)c * X[0] + (real)d * X[1] + (real)shift;
    }
}

static double greatest_of(brunt_fem_body *body, int component, bool least) {
    double most = 0, low = INFINITY;
    for (int32_t s = 0; s < body->slots; s++) {
        double value = (double)brunt_element_scalars(body, BRUNT_ELEMENT_kirchhoff_stress)[component][s];
        most = fmax(most, fabs(value)), low = fmin(low, fabs(value));
    }
    return least ? low : most;
}

// r = a R, z = c R + d Z: the stress of that F in every element; with c = 0 nothing is left on inner nodes.
START_TEST(patch_test) {
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff", "von-mises", "linear-elastic"};
    FOR_RINGS(kind)
    for (int m = 0; m < 4; m++)
        for (int viscous = 0; viscous < 2; viscous++)
            for (int far = 0; far < 2; far++)
                for (int sheared = 0; sheared < 2; sheared++) {
                    brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 4, 2 * far, 0.2);
                    brunt_fem_body body =
                        ring_of(&mesh, (options){.model = models[m], .hourglass = (brunt_hourglass)viscous});
                    const double dt = 1e-4, a = 1.1, c = sheared ? 0.2 : 0, d = 0.85;
                    for (int32_t n = 0; n < body.node_count; n++) {
                        const real *X = start_of(&body, n);
                        real *node = brunt_fem_node(&body, n);
                        node[BRUNT_FEM_V] = (real)((a - 1) * (double)X[0] / dt);
                        node[BRUNT_FEM_V + 1] = (real)((c * (double)X[0] + (d - 1) * (double)X[1] + 3) / dt);
                    }
                    brunt_fem_sums sums;
                    brunt_fem_drift(&body, 0, body.node_count, dt, &sums);
                    brunt_fem_report report = forces(&body, dt);
                    ck_assert_int_eq(report.bad, -1);
                    const double near = 1e3 * tolerance;
                    const double F[9] = {a, 0, 0, c, d, 0, 0, 0, a};
                    for (int k = 0; k < 9; k++)
                        for (int32_t s = 0; s < body.slots; s++)
                            ck_assert_double_eq_tol(
                                (double)brunt_element_scalars(&body, BRUNT_ELEMENT_deformation_gradient)[k][s], F[k],
                                near);
                    for (int k = 0; k < 6; k++)
                        ck_assert_double_eq_tol(greatest_of(&body, k, false), greatest_of(&body, k, true), near * E);
                    if (!sheared) // radial and hoop stress are one
                        ck_assert_double_eq_tol(greatest_of(&body, 0, false), greatest_of(&body, 2, false), near * E);
                    ck_assert_double_eq(greatest_of(&body, 4, false) + greatest_of(&body, 5, false), 0);
                    double inner = 0, outer = 0, axial = 0;
                    for (int32_t n = 0; n < body.node_count; n++) {
                        real f[3];
                        brunt_fem_internal_force(&body, n, f);
                        const int32_t id = body.node_id[n], i = id % 5, k = id / 5;
                        const bool inside = (i > 0 || !far) && i < 4 && k > 0 && k < 4;
                        double *greatest = inside ? &inner : &outer;
                        *greatest = fmax(*greatest, fmax(fabs((double)f[0]), fabs((double)f[1])));
                        axial += (double)f[1];
                        if (body.held[n]) ck_assert_double_eq((double)f[0], 0);
                    }
                    ck_assert_double_gt(outer, 0);
                    ck_assert_double_lt(fabs(axial), near * outer);
                    if (!sheared)
                        ck_assert_msg(inner < near * outer, "%s %s: force %g on inner nodes, %g on outer ones",
                                      body.traits->name, models[m], inner, outer);
                    brunt_fem_free(&body);
                }
}
END_TEST

// A uniform pressure leaves no force inside, shear or not.
START_TEST(uniform_pressure_leaves_no_force_inside) {
    FOR_RINGS(kind)
    for (int far = 0; far < 2; far++) {
        brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 4, 2 * far, 0.2);
        brunt_fem_body body = ring_of(&mesh, (options){0});
        stretch_to(&body, 1.2, 0.3, 0.9, 5);
        forces(&body, 1e-3);
        for (int c = 0; c < 6; c++)
            for (int32_t s = 0; s < body.slots; s++)
                brunt_element_scalars(&body, BRUNT_ELEMENT_kirchhoff_stress)[c][s] = c < 3 ? (real)-1e5 : 0;
        forces(&body, 0);
        double inner = 0, outer = 0;
        for (int32_t n = 0; n < body.node_count; n++) {
            real f[3];
            brunt_fem_internal_force(&body, n, f);
            const int32_t id = body.node_id[n], i = id % 5, k = id / 5;
            double *greatest = (i > 0 || !far) && i < 4 && k > 0 && k < 4 ? &inner : &outer;
            *greatest = fmax(*greatest, fmax(fabs((double)f[0]), fabs((double)f[1])));
        }
        ck_assert_msg(inner < 100 * tolerance * outer, "force %g inside, %g outside", inner, outer);
        brunt_fem_free(&body);
    }
}
END_TEST

static void shake_rings(brunt_fem_body *body, double amount) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < 2; i++)
            if (i || !body->held[n]) brunt_fem_node(body, n)[i] += (real)(amount * uniform(-1, 1));
}

static void throw_rings(brunt_fem_body *body, double speed) {
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < 2; i++)
            brunt_fem_node(body, n)[BRUNT_FEM_V + i] = i == 0 && body->held[n] ? 0 : (real)(speed * uniform(-1, 1));
}

START_TEST(forces_are_the_slope_of_the_energy) {
    if (sizeof(real) == 4) return; // differences of float energies say nothing
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff"};
    FOR_RINGS(kind)
    for (int m = 0; m < 2; m++)
        for (int far = 0; far < 2; far++) {
            brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 2, far, 0.1);
            brunt_fem_body body = ring_of(&mesh, (options){.model = models[m], .coefficient = 0.5});
            stretch_to(&body, 1.2, 0.3, 0.9, 5);
            shake_rings(&body, 0.05);
            for (int32_t n = 0; n < body.node_count; n++)
                for (int i = 0; i < 2; i++) {
                    if (i == 0 && body.held[n]) continue;
                    check_force_is_slope(&body, models[m], n, i);
                }
            brunt_fem_free(&body);
        }
}
END_TEST

// Neither form resists 1, R, Z in either direction; both resist the mode.
START_TEST(hourglass_control_sees_the_mode_alone) {
    for (int viscous = 0; viscous < 2; viscous++)
        for (int field = 0; field < 7; field++) {
            double x[4][3];
            random_section(BRUNT_QUAD4, 0.7, 0.2, x);
            brunt_mesh mesh = single_mesh(BRUNT_QUAD4, (const double(*)[3])x);
            brunt_fem_body body = ring_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous, .coefficient = 1});
            const double dt = 1e-3, size = 1e-2;
            for (int32_t n = 0; n < 4; n++) {
                const real *X = start_of(&body, n);
                const double f = field == 6       ? (body.node_id[n] % 2 ? -1 : 1)
                                 : field % 3 == 0 ? 1
                                                  : (double)X[field % 3 - 1];
                brunt_fem_node(&body, n)[BRUNT_FEM_V + (field / 3) % 2] = (real)(size / dt * f);
            }
            brunt_fem_sums sums;
            brunt_fem_drift(&body, 0, 4, dt, &sums);
            brunt_fem_report report = forces(&body, dt);
            const double of = E * size * size, got = fabs(report.hourglass_stored) + fabs(report.hourglass_lost);
            if (field == 6)
                ck_assert_double_gt(got, 1e-3 * of);
            else
                ck_assert_msg(got < (sizeof(real) == 4 ? 1e-5 : 1e-12) * of, "field %d: %g of %g", field, got, of);
            brunt_fem_free(&body);
        }
}
END_TEST

// The greatest eigenvalue of M^-1 K of one element by power iteration; K from differences of the forces about the
// place.
static double greatest_frequency(brunt_fem_body *body) {
    const int n = body->node_count, count = 2 * n;
    double K[8][8] = {{0}}, v[8], w[8], value = 0;
    const double h = 1e-6;
    for (int j = 0; j < count; j++) {
        real *x = brunt_fem_node(body, j / 2) + j % 2, at = *x;
        for (int side = 0; side < 2; side++) {
            *x = at + (real)(side ? h : -h);
            forces(body, 1);
            for (int i = 0; i < count; i++) {
                real f[3];
                brunt_fem_internal_force(body, i / 2, f);
                K[i][j] -= (side ? 1 : -1) * (double)f[i % 2] / (2 * h);
            }
        }
        *x = at;
    }
    for (int i = 0; i < count; i++) v[i] = uniform(-1, 1);
    for (int t = 0; t < 3000; t++) {
        double size = 0;
        for (int i = 0; i < count; i++) {
            const bool fixed = i % 2 == 0 && body->held[i / 2];
            w[i] = 0;
            for (int j = 0; j < count; j++)
                if (j % 2 || !body->held[j / 2]) w[i] += K[i][j] * v[j];
            w[i] = fixed ? 0 : w[i] / (double)brunt_fem_node(body, i / 2)[BRUNT_FEM_MASS];
            size += w[i] * w[i];
        }
        value = sqrt(size);
        for (int i = 0; i < count; i++) v[i] = w[i] / value;
    }
    return value;
}

START_TEST(stable_step_is_a_bound_and_a_close_one) {
    if (sizeof(real) == 4) return; // differences of float forces say nothing
    double closest[2] = {0}, farthest[2] = {INFINITY, INFINITY};
    FOR_RINGS(kind)
    for (int t = 0; t < 120; t++) {
        double x[4][3];
        random_section(kind, t % 3 == 0 ? 0 : t % 3 == 1 ? 0.3 : 5, t < 3 ? 0 : 0.3, x);
        if (t % 2)
            for (int a = 0; a < 4; a++) x[a][1] *= t % 4 == 1 ? 0.3 : 3;
        brunt_mesh mesh = single_mesh((brunt_element_kind)kind, (const double(*)[3])x);
        brunt_fem_body body =
            ring_of(&mesh, (options){.model = "st-venant-kirchhoff", .coefficient = t % 5 == 0 ? 1 : 0});
        brunt_fem_report report = forces(&body, 0);
        ck_assert_double_eq_tol(report.stable_step, body.least_step, 1e-3 * body.least_step);
        const double omega2 = greatest_frequency(&body), bound = 4 / pow(body.least_step, 2);
        const int k = kind == BRUNT_QUAD4;
        closest[k] = fmax(closest[k], omega2 / bound), farthest[k] = fmin(farthest[k], omega2 / bound);
        ck_assert_msg(omega2 <= bound * (1 + 1e-4), "%s %d: omega^2 %g, bound %g", body.traits->name, t, omega2, bound);
        brunt_fem_free(&body);
    }
    for (int k = 0; k < 2; k++) {
        ck_assert_double_gt(closest[k], 0.8);
        ck_assert_double_gt(farthest[k], 0.3);
    }
}
END_TEST

static double growth(brunt_fem_body *body, double dt, int steps) {
    const double speed = sizeof(real) == 4 ? 0.02 : 1e-7; // floats must resolve it
    throw_rings(body, speed);
    brunt_fem_sums sums = {0};
    double most = 0;
    for (int k = 0; k < steps; k++) {
        brunt_fem_report report = step(body, dt, &sums);
        if (report.bad >= 0 || sums.speed > 1e3 * speed) return INFINITY;
        most = fmax(most, sums.speed);
    }
    return most / speed;
}

// Meshes at their stable step, with springs and with dampers.
START_TEST(meshes_are_stable_at_their_step) {
    FOR_RINGS(kind)
    for (int form = 0; form < 4; form++)
        for (int far = 0; far < 2; far++)
            for (int fast = 0; fast < 2; fast++) {
                random_state = 1;
                brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 3, far, 0.2);
                brunt_fem_body body = ring_of(
                    &mesh, (options){.hourglass = (brunt_hourglass)(form % 2), .coefficient = form < 2 ? 0 : 1});
                double grown = growth(&body, (fast ? 2 : 0.98) * body.least_step, 2000);
                if (fast)
                    ck_assert_msg(grown > 1e2, "%s %d: only grows by %g", body.traits->name, form, grown);
                else
                    ck_assert_msg(grown < 50, "%s %d far %d: grows by %g", body.traits->name, form, far, grown);
                brunt_fem_free(&body);
            }
}
END_TEST

START_TEST(mass_scaling_reaches_its_step) {
    FOR_RINGS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        options o = {.hourglass = (brunt_hourglass)viscous};
        random_state = 1;
        brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 4, 0, 0.2);
        brunt_fem_body plain = ring_of(&mesh, o);
        o.mass_scaling = 1.2 * plain.least_step;
        random_state = 1;
        mesh = ring_mesh((brunt_element_kind)kind, 4, 0, 0.2);
        brunt_fem_body scaled = ring_of(&mesh, o);
        double mass[2] = {0};
        for (int32_t n = 0; n < plain.node_count; n++) {
            mass[0] += (double)brunt_fem_node(&plain, n)[BRUNT_FEM_MASS];
            mass[1] += (double)brunt_fem_node(&scaled, n)[BRUNT_FEM_MASS];
        }
        ck_assert_int_gt(scaled.scaled_elements, 0);
        ck_assert_double_eq_tol(mass[1] - mass[0], scaled.added_mass, 1e3 * tolerance * mass[0]);
        ck_assert_double_ge(forces(&scaled, 0).stable_step, o.mass_scaling);
        brunt_fem_free(&plain);
        brunt_fem_free(&scaled);
    }
}
END_TEST

// A long way along the axis, and back: no stress, no force.
START_TEST(axial_motion_makes_no_stress) {
    FOR_RINGS(kind) {
        brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 3, 0, 0.2);
        brunt_fem_body body = ring_of(&mesh, (options){.model = "von-mises"});
        for (int32_t n = 0; n < body.node_count; n++) brunt_fem_node(&body, n)[BRUNT_FEM_V + 1] = 10;
        const int steps = sizeof(real) == 4 ? 100 : 10000;
        for (int k = 0; k < steps; k++) step(&body, 1e-3, NULL);
        ck_assert_msg(greatest_stress(&body) < (sizeof(real) == 4 ? 1e-4 : 1e-11) * E, "stress %g E",
                      greatest_stress(&body) / E);
        brunt_fem_free(&body);
    }
}
END_TEST

// Free vibration: kinetic energy at the time of the stress, stored and lost energy; the greatest change in `end` [s].
static double ledger_error(int kind, int viscous, double dt, double end, double speed) {
    random_state = 5;
    brunt_mesh mesh = ring_mesh((brunt_element_kind)kind, 3, 0, 0.15);
    brunt_fem_body body = ring_of(&mesh, (options){.hourglass = (brunt_hourglass)viscous});
    throw_rings(&body, speed);
    brunt_fem_sums sums;
    brunt_fem_report report = forces(&body, 0);
    brunt_fem_drift(&body, 0, body.node_count, 0, &sums);
    const double kinetic = sums.kinetic;
    double lost = 0, worst = 0;
    for (int k = 0; k < (int)(end / dt); k++) {
        report = step(&body, dt, &sums);
        ck_assert_int_eq(report.bad, -1);
        lost += report.hourglass_lost;
        double total = sums.kinetic - 0.5 * report.stress_work + energy_of(&body, &report) + lost;
        worst = fmax(worst, fabs(total / kinetic - 1));
    }
    brunt_fem_free(&body);
    return worst;
}

// The ledger closes to second order in the step, and exactly where the stress is linear.
START_TEST(energy_ledger_closes) {
    if (sizeof(real) == 4) return; // the orders drown in rounding
    FOR_RINGS(kind)
    for (int viscous = 0; viscous < 2; viscous++) {
        const double dt = 4e-4, coarse = ledger_error(kind, viscous, dt, 400 * dt, 3),
                     fine = ledger_error(kind, viscous, dt / 4, 400 * dt, 3),
                     small = ledger_error(kind, viscous, dt, 400 * dt, 3e-5);
        ck_assert_msg(fine < 1e-3 && coarse / fine > 10, "%d %d: errors %g, %g", kind, viscous, coarse, fine);
        ck_assert_msg(small < 1e-7, "%d %d: small motion %g", kind, viscous, small);
    }
}
END_TEST

START_TEST(places_beyond_the_axis_are_refused) {
    brunt_mesh mesh = ring_mesh(BRUNT_QUAD4, 2, -0.1, 0);
    brunt_body_def def = brunt_body_def_default();
    snprintf(def.name, sizeof def.name, "b");
    brunt_material material = material_of("neo-hookean");
    brunt_fem_body body;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_fem_make_axisymmetric(&def, &material, &mesh, &body, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "r >= 0") != NULL, "%s", error.message);
    brunt_mesh_free(&mesh);
    mesh = box_mesh(BRUNT_HEX8, 2, 1, 0, false);
    ck_assert_int_eq(brunt_fem_make_axisymmetric(&def, &material, &mesh, &body, &error), BRUNT_BAD_INPUT);
    brunt_mesh_free(&mesh);
}
END_TEST
int main(void) {
    Suite *suite = suite_create("axisymmetric elements");
    TCase *tests = tcase_create("unit");
    const TTest *const list[] = {integrals_over_the_ring_are_exact,
                                 bodies_have_the_mass_of_the_circle,
                                 patch_test,
                                 uniform_pressure_leaves_no_force_inside,
                                 forces_are_the_slope_of_the_energy,
                                 hourglass_control_sees_the_mode_alone,
                                 stable_step_is_a_bound_and_a_close_one,
                                 meshes_are_stable_at_their_step,
                                 mass_scaling_reaches_its_step,
                                 axial_motion_makes_no_stress,
                                 energy_ledger_closes,
                                 places_beyond_the_axis_are_refused};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) tcase_add_test(tests, list[k]);
    suite_add_tcase(suite, tests);
    const int code = suite_main(suite);
    brunt_fem_workspace_free(&workspace);
    return code;
}
