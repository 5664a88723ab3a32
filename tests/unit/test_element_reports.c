// What blocks of elements say of themselves, and what they are told before the first step: bounds of materials that
// grow thicker when pulled, the norm of hourglass modes, stress at rest, failure in any tile, what turns inside out or
// is folded.
#include "tests/support/membrane_bodies.h"
#include "materials/prepared.h"

static const double AUXETIC = -0.5;

static brunt_material made(brunt_material_def *def, bool membrane) {
    brunt_material material;
    brunt_error error = {0};
    const int status = membrane ? brunt_material_make_membrane(def, false, &material, &error)
                                : brunt_material_make(def, &material, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    return material;
}

static void set(brunt_material_def *def, const char *key, double value, const char *word) {
    brunt_error error = {0};
    ck_assert_msg(brunt_material_set(def, key, value, word, &error) == BRUNT_OK, "%s", error.message);
}

// Takes the mesh.
static brunt_fem_body body_from(brunt_mesh *mesh, const brunt_material *material, bool rings) {
    brunt_body_def def = brunt_body_def_default();
    brunt_fem_body body;
    brunt_error error = {0};
    snprintf(def.name, sizeof def.name, "b");
    def.hourglass_coefficient = NAN, def.thickness = 0.01;
    const int status = rings ? brunt_fem_make_axisymmetric(&def, material, mesh, &body, &error)
                             : brunt_fem_make(&def, material, brunt_element_dimension(mesh->kind), mesh, &body, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    brunt_mesh_free(mesh);
    ck_assert_int_eq(brunt_fem_workspace_fit(&workspace, &body, NULL), 0);
    return body;
}

// Where lambda < 0 a cube of side h resists a change of shape the most, omega^2 = 8 mu / (rho h^2): at the start, and
// as the kernels have it. So do a square, a sheet and a ring far from its axis.
START_TEST(auxetic_bodies_are_held_by_their_shear) {
    static const struct {
        brunt_element_kind kind;
        double from;
    } cases[] = {{BRUNT_QUAD4, 0}, {BRUNT_HEX8, 0}, {BRUNT_MEMBRANE_QUAD4, 0}, {BRUNT_QUAD4, 100}};
    const brunt_element_kind kind = cases[_i].kind;
    const bool sheet = kind == BRUNT_MEMBRANE_QUAD4, rings = cases[_i].from > 0;
    const double h = 0.5, mu = E / (2 * (1 + AUXETIC)), step = h * sqrt(density / (2 * mu));
    brunt_material_def def = brunt_material_def_default("m", "neo-hookean");
    set(&def, "density", density, NULL), set(&def, "E", E, NULL), set(&def, "nu", AUXETIC, NULL);
    const brunt_material material = made(&def, sheet);
    brunt_mesh mesh = sheet ? membrane_mesh(kind, 1, 1, h, 0, 0, true) : box_mesh(kind, 1, h, 0, false);
    for (int32_t n = 0; n < mesh.node_count; n++) mesh.nodes[n][0] += cases[_i].from;
    brunt_fem_body body = body_from(&mesh, &material, rings);
    const double near = (rings ? 0.01 : 2e-3) * step;
    ck_assert_double_lt((double)body.lateral_ratio, -0.3);
    ck_assert_double_eq_tol(body.least_step, step, near);
    ck_assert_double_eq_tol(forces(&body, 0).stable_step, step, near);
    brunt_fem_free(&body);
}
END_TEST

// Greatest eigenvalue of the Gram matrix of an element's gamma = M - (M X) . b, over its nodes, by powers of it.
static double greatest_of_modes(const brunt_element *type, const double (*x)[3]) {
    const int n = type->traits->nodes, modes = type->hourglass_modes, dim = type->traits->span;
    real b[BRUNT_ELEMENT_NODES][3];
    double gamma[4][BRUNT_ELEMENT_NODES], v[4] = {1, 0.7, -0.4, 0.2}, value = 0;
    type->gradient(x, b);
    for (int m = 0; m < modes; m++)
        for (int a = 0; a < n; a++) {
            gamma[m][a] = type->hourglass[m][a];
            for (int c = 0; c < n; c++)
                for (int i = 0; i < dim; i++) gamma[m][a] -= type->hourglass[m][c] * x[c][i] * (double)b[a][i];
        }
    for (int k = 0; k < 500; k++) {
        double w[4] = {0}, size = 0;
        for (int m = 0; m < modes; m++)
            for (int q = 0; q < modes; q++)
                for (int a = 0; a < n; a++) w[m] += gamma[m][a] * gamma[q][a] * v[q] / n;
        for (int m = 0; m < modes; m++) size += w[m] * w[m];
        value = sqrt(size);
        for (int m = 0; m < modes; m++) v[m] = w[m] / value;
    }
    return value;
}

// The bound of the stable step takes no less for the hourglass modes than what they are together.
START_TEST(hourglass_modes_are_bounded_together) {
    double closest = 0;
    random_state = 7;
    for (int t = 0; t < 50; t++) {
        double x[8][3];
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) x[a][i] = hex_corner[a][i] + 0.25 * uniform(-1, 1);
        brunt_mesh mesh = single_mesh(BRUNT_HEX8, (const double(*)[3])x);
        brunt_fem_body body = body_of(&mesh, (options){0});
        const double modes = greatest_of_modes(body.element, (const double(*)[3])x);
        ck_assert_double_ge((double)body.hourglass_norm, modes * (1 - TOLERANCE(1e-9, 1e-4)));
        closest = fmax(closest, modes / (double)body.hourglass_norm);
        brunt_fem_free(&body);
    }
    ck_assert_double_gt(closest, 0.8);
}
END_TEST

static brunt_material gas(void) {
    brunt_material_def def = brunt_material_def_default("gas", "newtonian");
    set(&def, "density", 1, NULL), set(&def, "dynamic_viscosity", 1e-3, NULL), set(&def, "eos", 0, "ideal-gas");
    set(&def, "eos.gamma", 1.4, NULL), set(&def, "eos.initial_energy", 2e5, NULL);
    return made(&def, false);
}

// A gas has its pressure before the first step, the same on every side, p = (gamma - 1) rho e; and the whole of the
// standard springs, as it has no shear modulus by which they could go.
START_TEST(gas_presses_before_the_first_step) {
    static const brunt_element_kind kinds[] = {BRUNT_TRI3, BRUNT_QUAD4, BRUNT_TET4, BRUNT_HEX8, BRUNT_QUAD4};
    const bool rings = _i == 4;
    const double p = 0.4 * 2e5;
    const brunt_material material = gas();
    brunt_mesh mesh = box_mesh(kinds[_i], 2, 1, 0, false);
    brunt_fem_body body = body_from(&mesh, &material, rings);
    real *const *stress = brunt_element_scalars(&body, BRUNT_ELEMENT_kirchhoff_stress);
    for (int32_t s = 0; s < body.slots; s++)
        for (int c = 0; c < BRUNT_SYMMETRIC(body.point_dim); c++)
            ck_assert_double_eq_tol((double)stress[c][s], c < 3 ? -p : 0, TOLERANCE(1e-12, 1e-6) * p);
    ck_assert_double_eq_tol((double)body.hourglass_coefficient, 0.05, 1e-7);
    brunt_fem_free(&body);
}
END_TEST

// Of a block of several tiles: what one of them has is what the block has. `field` of one element is set to `value`.
static brunt_fem_report with(const brunt_material *material, const char *field, double factor, int32_t at) {
    brunt_mesh mesh = box_mesh(BRUNT_TRI3, 33, 1, 0, false);
    brunt_fem_body body = body_from(&mesh, material, false);
    ck_assert_int_gt(body.block[0].count, BRUNT_FEM_TILE);
    int f = BRUNT_ELEMENT_BASE_FIELDS;
    while (strcmp(body.field[f].name, field)) f++;
    real *value = &body.scalar[body.field[f].first][at < 0 ? body.block[0].count - 1 : at];
    *value = (real)(*value > 0 ? factor * (double)*value : factor);
    forces(&body, 1e-9);
    const brunt_fem_report report = body.report[0];
    brunt_fem_free(&body);
    return report;
}

START_TEST(blocks_tell_what_any_tile_has) {
    brunt_material_def def = brunt_material_def_default("m", "johnson-cook");
    set(&def, "density", density, NULL), set(&def, "E", E, NULL), set(&def, "nu", nu, NULL);
    set(&def, "A", 0.02 * E, NULL), set(&def, "B", 0.05 * E, NULL), set(&def, "n", 0.5, NULL);
    set(&def, "melt", 1000, NULL), set(&def, "heat_capacity", 500, NULL);
    set(&def, "failure", 0, "johnson-cook-damage"), set(&def, "failure.d1", 0.2, NULL);
    const brunt_material brittle = made(&def, false), air = gas();
    const double usual = with(&air, "internal_energy", 1, 0).wave_speed;
    for (int last = 0; last < 2; last++) {
        ck_assert(with(&brittle, "damage", 1, -last).failed);
        ck_assert(!with(&brittle, "damage", 0.5, -last).failed);
        ck_assert_double_eq_tol(with(&air, "internal_energy", 9, -last).wave_speed, 3 * usual, 0.05 * usual);
    }
}
END_TEST

// A warped sheet that is crushed to a point within a step has a metric whose both values are negative: it leaves as
// anything does that turns inside out, and keeps what it was.
START_TEST(sheets_crushed_to_a_point_leave) {
    random_state = 3;
    brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, 1, 1, 1, 0, 0.3, true);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){0});
    ck_assert_int_eq(brunt_fem_prepare_erosion(&body, true, NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_fem_workspace_fit(&workspace, &body, NULL), 0);
    for (int n = 0; n < 4; n++)
        for (int i = 0; i < 3; i++) brunt_fem_node(&body, n)[i] *= (real)(i < 2 ? 1e-3 : 0);
    ck_assert_int_eq(forces(&body, 1e-3).bad, -1);
    ck_assert_int_eq(body.mark[0], BRUNT_MARK_INVERTED);
    ck_assert_int_eq(body.report[0].marked, 1);
    ck_assert_double_eq((double)brunt_element_scalars(&body, BRUNT_ELEMENT_deformation_gradient)[0][0], 1);
    brunt_fem_free(&body);
}
END_TEST

// Whether corners are folded is the same however the element is turned.
START_TEST(folded_corners_are_seen_from_anywhere) {
    random_state = 5;
    for (int t = 0; t < 40; t++) {
        double x[8][3], R[3][3];
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) x[a][i] = hex_corner[a][i] + 0.1 * uniform(-1, 1);
        rotation(3, 0.37 * t, R);
        brunt_mesh mesh = single_mesh(BRUNT_HEX8, (const double(*)[3])x);
        brunt_fem_body body = body_of(&mesh, (options){0});
        for (int folded = 0; folded < 2; folded++) {
            for (int32_t n = 0; n < 8; n++)
                for (int i = 0; i < 3; i++) {
                    double at = 0; // the corner at the origin beyond the diagonal of its neighbours
                    for (int j = 0; j < 3; j++)
                        at += R[i][j] * (folded && !body.node_id[n] ? 0.6 : x[body.node_id[n]][j]);
                    brunt_fem_node(&body, n)[i] = (real)at;
                }
            ck_assert_int_eq(brunt_fem_folded(&body), folded);
        }
        brunt_fem_free(&body);
    }
}
END_TEST

// What momenta are compared with: sums of m |v| and m |x| |v|.
START_TEST(scales_are_sums_of_sizes) {
    brunt_mesh mesh = box_mesh(BRUNT_HEX8, 3, 1, 0.2, true);
    brunt_fem_body body = body_of(&mesh, (options){0});
    double linear = 0, angular = 0;
    for (int32_t n = 0; n < body.node_count; n++) {
        real *node = brunt_fem_node(&body, n);
        double x2 = 0, v2 = 0;
        for (int i = 0; i < 3; i++) {
            node[BRUNT_FEM_V + i] = (real)uniform(-3, 3);
            x2 += pow((double)node[i], 2), v2 += pow((double)node[BRUNT_FEM_V + i], 2);
        }
        linear += (double)node[BRUNT_FEM_MASS] * sqrt(v2), angular += (double)node[BRUNT_FEM_MASS] * sqrt(x2 * v2);
    }
    const brunt_fem_sums sums = brunt_fem_audit(&body, 0, body.node_count);
    ck_assert_double_eq_tol(sums.scale_linear, linear, TOLERANCE(1e-12, 1e-5) * linear);
    ck_assert_double_eq_tol(sums.scale_angular, angular, TOLERANCE(1e-12, 1e-5) * angular);
    brunt_fem_free(&body);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("element reports");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, auxetic_bodies_are_held_by_their_shear, 0, 4);
    tcase_add_test(all, hourglass_modes_are_bounded_together);
    tcase_add_loop_test(all, gas_presses_before_the_first_step, 0, 5);
    tcase_add_test(all, blocks_tell_what_any_tile_has);
    tcase_add_test(all, sheets_crushed_to_a_point_leave);
    tcase_add_test(all, folded_corners_are_seen_from_anywhere);
    tcase_add_test(all, scales_are_sums_of_sizes);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
