// Bars of finite elements against closed forms and published results: two that collide, one that hangs from its end.
#include "tests/support/def_world.h"

static brunt_body_def *bar(brunt_world_def *def, const char *name, double from, double to, double size) {
    brunt_body_def *b = def_box(def, name, XYZ(from, 0, 0), XYZ(to, size, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    return b;
}

// B06. A bar of length L1 and speed v hits one at rest of length L2 >= L1, of the same section and material, nu = 0.
// Until the wave has been to the striker's end and back, 2 L1 / c, the force is rho c v A / 2; then the striker is at
// rest, and the other has its momentum: v L1 / L2. Equal bars change their speeds, as do those of a cradle.
START_TEST(bars_that_collide) {
    const double L1 = _i ? 5 : 10, L2 = 10, size = 0.05, v = 1e-3, gap = 1e-4, c = 1;
    brunt_world_def def = def_begin(2, 1);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    brunt_error error;
    ck_assert_int_eq(brunt_material_set(def_material(&def, "neo-hookean", 1, 1, 0), "viscosity", 0, NULL, &error),
                     BRUNT_OK);
    def_velocity(bar(&def, "a", -L1, 0, size), v, 0, 0);
    bar(&def, "b", gap, L2 + gap, size);
    brunt_world *world = world_take(&def);
    const double touch = gap / v, window[2] = {touch + 0.2 * L1, touch + 1.8 * L1};
    double impulse[2], time[2];
    for (int k = 0; k < 2; k++) {
        world_until(world, window[k] / c);
        impulse[k] = world_pair(world, 0).impulse[0], time[k] = brunt_world_time(world);
    }
    world_until(world, touch + 4 * L2 / c);
    const double force = (impulse[1] - impulse[0]) / (time[1] - time[0]) / (0.5 * c * v * size);
    const double striker = world_sums(world, 0).velocity[0] / v, target = world_sums(world, 1).velocity[0] / v;
    const brunt_energy e = world_energy(world);
    printf(
        "  bars of %g and %g: force %.5f, striker %.5f, target %.5f of %.5f, energy error %.1e, internal left %.4f\n",
        L1, L2, force, striker, target, L1 / L2, e.error_relative, e.internal / e.initial);
    ck_assert_double_eq_tol(force, 1, 0.01);
    ck_assert_double_le(fabs(striker), 0.01);
    ck_assert_double_eq_tol(target, L1 / L2, 0.01 * L1 / L2);
    ck_assert_double_le(fabs(e.error_relative), 1e-3);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// B25. A cube of rubber, fixed at its top, let go under a hundred times the weight on earth: least place of its tip and
// when, by the finite elements that Karamelo ships its bar with (1.71458 m after 0.08816 s).
START_TEST(bar_that_hangs) {
    brunt_world_def def = def_begin(3, 1);
    def.groups = brunt_alloc(sizeof *def.groups);
    def_material(&def, "neo-hookean", 1050, 1e6, 0.3);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1, 1, 1));
    b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = 0.125;
    def.groups[0] = brunt_group_def_default(), def.group_count = 1;
    snprintf(def.groups[0].body, sizeof def.groups[0].body, "bar");
    snprintf(def.groups[0].group, sizeof def.groups[0].group, "zmax");
    def.gravity[2] = -1000;
    brunt_world *world = world_take(&def);
    double least = 0, when = 0;
    while (brunt_world_time(world) < 0.15) {
        world_steps(world, 1);
        const double tip = world_sums(world, 0).low[2];
        if (tip < least) least = tip, when = brunt_world_time(world);
    }
    printf("  bar that hangs: %.4f m after %.5f s\n", least, when);
    ck_assert_double_eq_tol(least, -1.71458, 0.03 * 1.71458);
    ck_assert_double_eq_tol(when, 0.08816, 0.03 * 0.08816);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("bars");
    TCase *tests = tcase_create("bars");
    tcase_add_loop_test(tests, bars_that_collide, 0, 2);
    tcase_add_test(tests, bar_that_hangs);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
