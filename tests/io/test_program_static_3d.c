// Friction of load steps in three dimensions, as a user meets it: Coulomb's law whatever the direction, what points and
// edges have given is kept from step to step and over a restart, and what has no equilibrium is said with exit code 70.
#include "tests/support/small_columns.h"
#include "tests/support/small_hash.h"

#ifndef BRUNT_FLOAT
static const char block[] =
    "brunt: 1\ntitle: a block is pressed, then sheared, held, and sheared back\ndimension: 3\n"
    "time: {scheme: static, steps: 12}\nnewton: {tolerance: 1e-9, iterations: 200}\n"
    "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 10 MPa, nu: 0.3}}\nbodies:\n"
    "  lower: {method: fem, element: hex8, size: 2.5 mm, material: m, shape: {box: {min: [-10 mm, -10 mm, -5 mm], max: "
    "[10 mm, 10 mm, 0 mm]}}}\n"
    "  upper: {method: fem, element: hex8, size: 2 mm, material: m, shape: {box: {min: [-3.7 mm, -3.2 mm, 0.01 mm], "
    "max: "
    "[2.3 mm, 2.8 mm, 4.01 mm]}}}\n"
    "boundaries:\n"
    "  - {name: base, body: lower, group: zmin, fix: [x, y, z]}\n"
    "  - {name: press, body: upper, group: zmax, displacement: [free, free, -0.1 mm], table: [[0 s, 0], [0.25 s, 1]]}\n"
    "  - {name: shear, body: upper, group: zmax, displacement: [0.16 mm, 0.12 mm, free], table: [[0.25 s, 0], [0.5 s, "
    "1], [0.75 s, 1], [1 s, -1]]}\n"
    "contact: {method: barrier, friction: 0.3, distance: 20 um}\n"
    "output: {history: 0 s, every: none}\n";

enum { TETRAHEDRA = 2 };
// Which way it is sheared, which of the two is sheared, and how far it sticks by.
static const struct {
    double x, y;
    const char *set;
} shears[] = {
    {0.16, 0.12, ""},
    {-0.12, 0.16, "--set contact.slip_length='2 um' "},
    {0.2, 0, "--set bodies.lower.element=tet4 --set bodies.upper.element=tet4 "},
    {0.16, 0.12, "--set bodies.lower.size='2 mm' --set bodies.upper.size='3 mm' "},
};

// Forces stay below Coulomb's bound and come to it, against the shear, and the other way when that is turned; where
// nothing moves any more nothing changes, though each load step begins anew; heat is force times way.
START_TEST(friction_is_kept_from_step_to_step) {
    double fx[ROWS], fy[ROWS], fz[ROWS], base[ROWS], error[ROWS], heat[ROWS], iterations[ROWS];
    char run[600];
    small_put("block.yaml", block);
    snprintf(run, sizeof run, "run block.yaml -t 1 -q -o out %s--set 'boundaries[2].displacement=[%g mm, %g mm, free]'",
             shears[_i].set, shears[_i].x, shears[_i].y);
    small_expect(run, 0, NULL);
    const int rows = read_column("out", "contact.lower-upper.force_x", fx);
    read_column("out", "contact.lower-upper.force_y", fy), read_column("out", "contact.lower-upper.force_z", fz);
    read_column("out", "wall.base.force_x", base), read_column("out", "energy.error_relative", error);
    read_column("out", "energy.friction", heat), read_column("out", "newton.iterations", iterations);
    ck_assert_int_eq(rows, 13);
    const double way = hypot(shears[_i].x, shears[_i].y);
    for (int r = 1; r < rows; r++) {
        ck_assert_double_le(hypot(fx[r], fy[r]), 1.005 * 0.3 * fz[r]); // normals lean by as much
        ck_assert_double_eq_tol(base[r], fx[r], 1e-6 * fz[r]);
        ck_assert_double_lt(fabs(error[r]), 1e-6);
        ck_assert_double_ge(heat[r], heat[r - 1] - 0.3 * fz[r] * 2e-6); // what surfaces give by is given back
    }
    for (int r = 6; r <= 12; r += 6) {
        const double along = (fx[r] * shears[_i].x + fy[r] * shears[_i].y) / way;
        const double across = (fx[r] * shears[_i].y - fy[r] * shears[_i].x) / way;
        printf("  %d: %.5f of what presses along, %.5f across\n", r, along / fz[r], across / fz[r]);
        ck_assert_double_eq_tol(along, (r == 6 ? -0.3 : 0.3) * fz[r], 0.01 * 0.3 * fz[r]);
        ck_assert_double_lt(fabs(across), 0.02 * 0.3 * fz[r]); // of what blocks give by while they begin to slip
    }
    for (int r = 7; r <= 9; r++) { // nothing moves
        ck_assert_double_eq_tol(fx[r], fx[6], 1e-6 * fz[6]);
        ck_assert_double_eq_tol(fz[r], fz[6], 1e-6 * fz[6]);
        ck_assert_double_le(iterations[r], 1);
        ck_assert_double_eq_tol(heat[r], heat[6], 1e-6 * heat[6]);
    }
    // Of the way back the last third is at full slip.
    ck_assert_double_eq_tol(heat[12] - heat[11], 0.3 * fz[12] * way * 2e-3 / 3, 0.01 * (heat[12] - heat[11]));
}
END_TEST

// While it sticks with a force that earlier steps have left, at points and at edges that cross.
START_TEST(friction_is_kept_over_a_restart) {
    double iterations[ROWS];
    char words[200];
    small_put("block.yaml", block);
    small_expect("run block.yaml -t 1 -q -o one", 0, NULL);
    small_expect("run block.yaml -t 2 -q -o two", 0, NULL);
    ck_assert_int_eq(read_column("one", "newton.iterations", iterations), 13);
    int most = 1;
    for (int r = 2; r < 13; r++) most = iterations[r] > iterations[most] ? r : most;
    ck_assert_int_gt(most, 5); // the first to take the most: it has been sheared since step 3
    snprintf(words, sizeof words, "run block.yaml -t 1 -q -o legs --set newton.iterations=%g --set newton.cut=0",
             iterations[most] - 1);
    small_expect(words, 70, NULL);
    small_expect("run block.yaml -t 2 -q -o legs --resume", 0, NULL);
    ck_assert_uint_eq(hash_of("one"), hash_of("two"));
    ck_assert_uint_eq(hash_of("one"), hash_of("legs"));
    ck_assert_int_eq(small_shell("cmp one/history.csv two/history.csv"), 0);
}
END_TEST

// Two blocks of one cross section, without Poisson's ratio: pressures are even. Twisted until all slips they take a
// torque of mu p times the integral of the distance from the middle, (sqrt 2 + ln(1 + sqrt 2)) / 6 L^3, which the heat
// tells.
START_TEST(twisted_blocks_have_the_torque_of_even_pressure) {
    static const char twist[] =
        "brunt: 1\ndimension: 3\ntime: {scheme: static, steps: 6}\nnewton: {tolerance: 1e-8}\n"
        "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 100 MPa, nu: 0}}\nbodies:\n"
        "  low: {method: fem, element: hex8, size: 1.7 mm, material: m, shape: {box: {min: [-5 mm, -5 mm, -5 mm], max: "
        "[5 mm, 5 mm, 0 mm]}}}\n"
        "  up: {method: fem, element: hex8, size: 1.43 mm, material: m, shape: {box: {min: [-5 mm, -5 mm, 2 um], max: "
        "[5 "
        "mm, 5 mm, 5.002 mm]}}}\n"
        "boundaries:\n  - {body: low, group: zmin, fix: [x, y, z]}\n"
        "  - {body: up, group: zmax, displacement: [free, free, -12 um], table: [[0 s, 0], [0.3 s, 1]]}\n"
        "  - {body: up, group: zmax, rotation: {angle: 0.01 rad, axis: [0, 0, 1]}, table: [[0.3 s, 0], [1 s, 1]]}\n"
        "contact: {method: barrier, friction: 0.3, distance: 2 um}\noutput: {every: none, history: 0 s}\n";
    double heat[ROWS], force[ROWS];
    small_put("twist.yaml", twist);
    small_expect("run twist.yaml -t 1 -q -o twist", 0, NULL);
    ck_assert_int_eq(read_column("twist", "energy.friction", heat), 7);
    read_column("twist", "contact.low-up.force_z", force);
    const double turned = 0.01 / 0.7 / 6, arm = 10e-3 * (sqrt(2) + log(1 + sqrt(2))) / 6;
    for (int r = 5; r <= 6; r++) {
        const double torque = (heat[r] - heat[r - 1]) / turned, even = 0.3 * force[r] * arm;
        printf("  torque %.5f of that of even pressure\n", torque / even);
        ck_assert_double_eq_tol(torque, even, 0.01 * even);
    }
}
END_TEST

// Pushed by tractions, at 30 degrees to its sides: stands below the bound and has no equilibrium above it, on a body
// and on a plane alike.
START_TEST(blocks_slide_beyond_their_friction) {
    static const char pushed[] =
        "brunt: 1\ndimension: 3\ntime: {scheme: static, steps: 4}\nnewton: {tolerance: 1e-8, cut: 1}\n"
        "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 100 MPa, nu: 0.3}}\nbodies:\n"
        "  base: {method: fem, element: hex8, size: 2.5 mm, material: m, shape: {box: {min: [-10 mm, -10 mm, %d mm], "
        "max: [10 mm, 10 mm, %d mm]}}}\n"
        "  block: {method: fem, element: hex8, size: 2 mm, material: m, shape: {box: {min: [-3.7 mm, -3.2 mm, 5 um], "
        "max: "
        "[2.3 mm, 2.8 mm, 2.005 mm]}}}\n"
        "boundaries:\n  - {body: base, group: zmin, fix: [x, y, z]}\n"
        "  - {name: press, body: block, group: zmax, traction: [0, 0, -0.1 MPa], table: [[0 s, 0], [0.5 s, 1]]}\n"
        "  - {name: push, body: block, group: zmax, traction: [%g MPa, %g MPa, 0], table: [[0.5 s, 0], [1 s, 1]]}\n%s"
        "contact: {method: barrier, friction: 0.3, distance: 10 um}\noutput: {every: none, history: 0 s}\n";
    static const char plane[] =
        "  - {name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate, friction: 0.3}\n";
    static const double part[] = {0.97, 1.03};
    char text[2000];
    for (int on_plane = 0; on_plane < 2; on_plane++)
        for (int k = 0; k < 2; k++) {
            snprintf(text, sizeof text, pushed, on_plane ? 20 : -5, on_plane ? 25 : 0, 0.03 * part[k] * sqrt(0.75),
                     0.03 * part[k] * 0.5, on_plane ? plane : "");
            small_put("pushed.yaml", text);
            small_expect("run pushed.yaml -t 1 -q -o pushed --fresh", k ? 70 : 0,
                         k ? "friction does not settle" : NULL);
        }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_static_3d");
    TCase *tests = tcase_create("program_static_3d");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    const int shear_count = (int)(sizeof shears / sizeof *shears);
    tcase_add_loop_test(tests, friction_is_kept_from_step_to_step, SANITIZED ? TETRAHEDRA : 0,
                        SANITIZED ? TETRAHEDRA + 1 : shear_count); // hexahedra are sheared below
    tcase_add_test(tests, friction_is_kept_over_a_restart);
    tcase_add_test(tests, twisted_blocks_have_the_torque_of_even_pressure);
    tcase_add_test(tests, blocks_slide_beyond_their_friction);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#else
int main(void) { return 0; }
#endif
