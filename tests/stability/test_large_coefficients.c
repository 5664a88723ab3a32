// Coefficients of what dissipates, up to a thousand times the usual or to their bound: the stable step knows them, and
// what they take is booked.
#include "tests/support/def_world.h"

// A block of elements and one of points that meet at 10 m/s, a quarter of the speed of sound, and a block of fluid that
// shears itself.
static brunt_world_def impact(double cfl) {
    brunt_world_def def = def_begin(2, 0.02);
    def.cfl = cfl;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.materials[0].bulk_viscosity = true;
    def.materials[0].viscosity_parameters[0] = 0.06, def.materials[0].viscosity_parameters[1] = 1.5;
    def.materials[1] = brunt_material_def_default("water", "newtonian");
    def.material_count = 2;
    brunt_error error;
    def.materials[1].density = 1000;
    ck_assert_int_eq(brunt_material_set(&def.materials[1], "dynamic_viscosity", 1, NULL, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(&def.materials[1], "eos", 0, "tait", &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(&def.materials[1], "eos.c0", 20, NULL, &error), BRUNT_OK);
    brunt_body_def *a = def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.2, 0.2, 0));
    a->method = BRUNT_FEM, a->element = BRUNT_QUAD4, a->size = 0.02;
    def_velocity(a, 5, 0, 0);
    def_velocity(def_box(&def, "b", XYZ(0.202, 0, 0), XYZ(0.4, 0.2, 0)), -5, 0, 0);
    brunt_body_def *c = def_box(&def, "c", XYZ(1, 0, 0), XYZ(1.2, 0.2, 0));
    c->material = 1;
    c->wave_velocity[0] = 2, c->wave_vector[1] = 30;
    return def;
}

// Its energy error [-], and that it has not more energy than at the start.
static double error_of(brunt_world_def *def, const char *what) {
    brunt_world *world = world_take(def);
    world_until(world, 2e-3);
    const brunt_energy e = world_energy(world);
    printf("  %s: error %.2g %%, E/E0 %.3f\n", what, 100 * e.error_relative, (e.kinetic + e.internal) / e.initial);
    ck_assert_double_lt(e.kinetic + e.internal, e.initial * 1.001);
    brunt_world_destroy(world);
    return fabs(e.error_relative);
}

START_TEST(what_they_take_is_accounted) {
    for (int k = 0; k < 2; k++) {
        const double cfl = k ? 0.9 : 0.5;
        brunt_world_def def = impact(cfl);
        ck_assert_double_lt(error_of(&def, "usual"), 2e-3);
        def = impact(cfl);
        def.materials[0].viscosity_parameters[0] = 1;
        ck_assert_double_lt(error_of(&def, "linear viscosity 1"), 0.01);
        def = impact(cfl);
        def.materials[0].viscosity_parameters[1] = 10;
        ck_assert_double_lt(error_of(&def, "quadratic viscosity 10"), 0.03);
        def = impact(cfl);
        def.materials[1].strength_parameters[0] = 1000;
        ck_assert_double_lt(error_of(&def, "dynamic viscosity 1000"), 5e-3);
        def = impact(cfl);
        def.bodies[0].damping = 1e5;
        ck_assert_double_lt(error_of(&def, "damping 1e5"), 2e-3);
        for (int form = 0; form < 2; form++) {
            def = impact(cfl);
            def.bodies[0].hourglass = form ? BRUNT_HOURGLASS_VISCOUS : BRUNT_HOURGLASS_STIFFNESS;
            def.bodies[0].hourglass_coefficient = 1;
            ck_assert_double_lt(error_of(&def, form ? "hourglass dampers 1" : "hourglass springs 1"), 5e-3);
        }
    }
}
END_TEST

// Where it sets in within a step that was chosen without it, what it makes is out of nothing: it was 13 % of an impact.
START_TEST(bulk_viscosity_has_bounds) {
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = impact(0.5);
        brunt_error error;
        def.materials[0].viscosity_parameters[k] *= 1000;
        brunt_world *world = brunt_world_create(&def, &error);
        ck_assert_ptr_null(world);
        ck_assert_msg(strstr(error.message, k ? "viscosity.quadratic" : "viscosity.linear") != NULL, "%s",
                      error.message);
        brunt_world_def_free(&def);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("large_coefficients");
    TCase *tests = tcase_create("large coefficients");
    tcase_add_test(tests, what_they_take_is_accounted);
    tcase_add_test(tests, bulk_viscosity_has_bounds);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
