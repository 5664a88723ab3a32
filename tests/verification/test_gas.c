// Labels: conservation
// Gas in enclosed volumes and mass-proportional damping: closed forms, accounts, restart.
#include "tests/support/hard_world.h"

static const double GAMMA = 1.4, OUTSIDE = 1000;

// A soft box of 0.4 x 0.3 x 0.2 m, turned, with gas that pushes its surface from inside.
static brunt_world_def box(brunt_element_kind kind, double pressure, double inflow) {
    brunt_world_def def = def_begin(3, 0);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *body = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.4, 0.3, 0.2));
    body->method = BRUNT_FEM, body->element = kind, body->size = 0.1;
    body->place = brunt_placement_rotate(brunt_placement_identity(), XYZ(1, 2, 3), 0.7, XYZ(1, -1, 2));
    def.groups = brunt_alloc(2 * sizeof *def.groups);
    brunt_group_def *g = &def.groups[def.group_count++];
    *g = brunt_group_def_default();
    snprintf(g->name, sizeof g->name, "gas");
    snprintf(g->body, sizeof g->body, "box");
    snprintf(g->group, sizeof g->group, "surface");
    g->action = BRUNT_GROUP_GAS;
    g->gas = (brunt_gas_def){.gamma = GAMMA, .pressure = pressure, .outside = OUTSIDE, .inflow = inflow};
    def.cfl = 0.9;
    return def;
}

static brunt_gas gas_of(const brunt_world *world) {
    brunt_gas gas;
    ck_assert_int_eq(brunt_gas_count(world), 1);
    brunt_world_gas(world, 0, &gas);
    return gas;
}

static const brunt_element_kind kinds[] = {BRUNT_HEX8, BRUNT_TET4};

START_TEST(equal_pressures_do_nothing) {
    brunt_world_def def = box(kinds[_i], OUTSIDE, 0);
    brunt_world *world = world_take(&def);
    brunt_gas gas = gas_of(world);
    ck_assert_str_eq(gas.name, "gas");
    ck_assert_double_eq_tol(gas.volume, 0.024, 0.024 * ROUNDING);
    ck_assert_double_eq_tol(gas.energy, OUTSIDE * 0.024 / (GAMMA - 1), gas.energy * 10 * ROUNDING);
    world_steps(world, 20);
    ck_assert_double_lt(world_energy(world).kinetic, 1e-12);
    brunt_world_destroy(world);
}
END_TEST

// Inside more than outside: the body swings. The gas keeps p V^gamma; the pressure has neither resultant nor torque,
// though the faces are warped by then.
START_TEST(gas_keeps_its_entropy) {
    brunt_world_def def = box(kinds[_i], 4 * OUTSIDE, 0);
    def.bodies[0].wave_velocity[0] = 0.8, def.bodies[0].wave_velocity[1] = 0.5, def.bodies[0].wave_velocity[2] = -0.7;
    def.bodies[0].wave_vector[0] = 7, def.bodies[0].wave_vector[1] = -5, def.bodies[0].wave_vector[2] = 9;
    brunt_world *world = world_take(&def);
    brunt_gas start = gas_of(world);
    double widest = 0;
    for (int k = 0; k < 60; k++) {
        world_steps(world, 1);
        brunt_gas now = gas_of(world);
        ck_assert_double_eq_tol(now.pressure * pow(now.volume, GAMMA) / (start.pressure * pow(start.volume, GAMMA)), 1,
                                100 * ROUNDING);
        widest = fmax(widest, now.volume / start.volume);
    }
    ck_assert_double_gt(widest, 1.002);
    brunt_reaction push = world_boundary(world, 0);
    double scale = 3 * OUTSIDE * 0.52 * brunt_world_time(world); // pressure times surface times time
    for (int a = 0; a < 3; a++) ck_assert_double_lt(fabs(push.impulse[a]), ROUNDING * scale);
    brunt_momentum m = world_momentum(world);
    for (int a = 0; a < 3; a++) ck_assert_double_lt(fabs(m.angular_impulse[a]), ROUNDING * scale);
    brunt_world_destroy(world);
}
END_TEST

// What the load does on the body is what the gas loses, less the work against the pressure outside, to second order in
// the step; and what flows in is the integral of the table.
static double work_error(double step) {
    brunt_world_def def = box(BRUNT_HEX8, 3 * OUTSIDE, 2000);
    def.groups[0].table.points = brunt_alloc(3 * sizeof *def.groups[0].table.points);
    def.groups[0].table.count = 2;
    def.groups[0].table.points[1][0] = 0.01, def.groups[0].table.points[1][1] = 1;
    def.step = step;
    brunt_world *world = world_take(&def);
    brunt_gas start = gas_of(world);
    world_until(world, 0.01 - 0.5 * step);
    const brunt_gas before = gas_of(world);
    world_steps(world, 1);
    brunt_gas end = gas_of(world); // of the middle of the last step, as the work is
    end.volume = 0.5 * (end.volume + before.volume), end.energy = 0.5 * (end.energy + before.energy);
    end.inflow = 0.5 * (end.inflow + before.inflow);
    double outside = OUTSIDE * (end.volume - start.volume), lost = start.energy + end.inflow - end.energy;
    ck_assert_double_eq_tol(end.inflow, 10, 1.5 * 2000 * step); // a step's share less at the end
    const brunt_energy e = world_energy(world);
    ck_assert_double_ge(e.kinetic, 0);
    const double done = e.external_work;
    ck_assert_double_gt(fabs(outside), 1e-3);
    brunt_world_destroy(world);
    return fabs(done - (lost - outside)) / fabs(lost);
}

START_TEST(work_is_what_the_gas_loses) {
    double coarse = work_error(2e-4), fine = work_error(1e-4);
    printf("gas: work error %.2e, at half the step %.2e\n", coarse, fine);
    ck_assert_double_lt(fine, 2e-4);
    ck_assert_double_lt(fine, 0.3 * coarse);
}
END_TEST

static const char *refused(brunt_world_def *def) {
    static brunt_error error;
    brunt_world *world = brunt_world_create(def, &error);
    ck_assert_ptr_null(world);
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    brunt_world_def_free(def);
    return error.message;
}

START_TEST(nonsense_is_refused) {
    brunt_world_def def = box(BRUNT_HEX8, OUTSIDE, 0);
    def.groups[0].gas.gamma = 1;
    ck_assert_ptr_nonnull(strstr(refused(&def), "gamma"));
    def = box(BRUNT_HEX8, -1, 0);
    ck_assert_ptr_nonnull(strstr(refused(&def), "pressures"));
    def = box(BRUNT_HEX8, OUTSIDE, 0);
    def.bodies[0].damping = -1;
    ck_assert_ptr_nonnull(strstr(refused(&def), "damping"));
    def = box(BRUNT_HEX8, OUTSIDE, 0);
    snprintf(def.groups[0].group, sizeof def.groups[0].group,
             "zmin"); // one face of six
    ck_assert_ptr_nonnull(strstr(refused(&def), "open at"));
}
END_TEST

// A body that flies freely slows down as exp(-damping t); the ground carries its momentum, viscosity its energy.
START_TEST(damping_slows) {
    brunt_world_def def = def_begin(3, 0);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *body = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.3, 0.2, 0.2));
    body->method = BRUNT_FEM, body->element = kinds[_i], body->size = 0.1;
    def_velocity(body, 1, 2, -3);
    body->spin[1] = 2;
    memcpy(body->spin_about, XYZ(0.15, 0.1, 0.1), sizeof body->spin_about);
    body->spin_about[0] = 0.15, body->spin_about[1] = 0.1, body->spin_about[2] = 0.1;
    body->damping = 20;
    def.cfl = 0.9;
    brunt_world *world = world_take(&def);
    double kinetic = world_energy(world).kinetic;
    world_until(world, 0.1);
    brunt_body_sums now = world_sums(world, 0);
    const double factor = exp(-20 * (brunt_world_time(world) - 0.5 * brunt_world_dt(world))); // half a step behind
    for (int a = 0; a < 3; a++)
        ck_assert_double_eq_tol(now.velocity[a] / ((const double[3]){1, 2, -3})[a], factor, 100 * ROUNDING * factor);
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.viscosity, 0.9 * kinetic);
    ck_assert_double_lt(fabs(e.error_relative), 1e-4);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    ck_assert_double_lt(world_momentum(world).angular_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// From next to no damping to more than stops it within a step: no velocity turns round, the loss is that of the closed
// form, and the accounts close.
START_TEST(any_damping_is_exact) {
    static const double of_step[] = {1e-3, 0.3, 2, 5, 50, 1e4};
    for (int heavy = 0; heavy < 6; heavy++) {
        brunt_world_def def = def_begin(3, 0);
        def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
        brunt_body_def *body = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.3, 0.2, 0.2));
        body->method = BRUNT_FEM, body->element = kinds[_i], body->size = 0.1;
        def_velocity(body, 1, 2, -3);
        def.step = 1e-3;
        body->damping = of_step[heavy] / def.step;
        brunt_world *world = world_take(&def);
        const double start = world_energy(world).kinetic;
        double viscosity = 0;
        for (int k = 0; k < 20; k++) {
            world_steps(world, 1);
            const double factor = exp(-of_step[heavy] / 1e-3 * (brunt_world_time(world) - 0.5 * brunt_world_dt(world)));
            const brunt_body_sums now = world_sums(world, 0);
            const brunt_energy e = world_energy(world);
            for (int a = 0; a < 3; a++)
                ck_assert_double_eq_tol(now.velocity[a], factor * ((const double[3]){1, 2, -3})[a], 100 * ROUNDING);
            ck_assert_double_lt(fabs(e.error), 100 * ROUNDING * start);
            ck_assert_double_ge(e.viscosity, viscosity - 100 * ROUNDING * start);
            viscosity = e.viscosity;
            ck_assert_double_lt(world_momentum(world).linear_drift, 100 * ROUNDING);
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// Weight on a plane: at rest nothing drags, whatever the damping, and the plane carries all of it.
START_TEST(contact_bears_all_of_the_weight) {
    static const double of_step[] = {0, 0.1, 3};
    for (int heavy = 0; heavy < 3; heavy++) {
        brunt_world_def def = def_begin(3, 0);
        def_material(&def, "neo-hookean", 1000, 1e5, 0);
        brunt_body_def *body = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.1, 0.1, 0.1));
        body->method = BRUNT_FEM, body->element = kinds[_i], body->size = 0.1;
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0);
        def.gravity[2] = -10;
        def.step = 2e-3;
        body->damping = of_step[heavy] / def.step;
        brunt_world *world = world_take(&def);
        world_steps(world, 1);
        // All nodes fall but those on the plane: of the first half step, what they bear of the weight is theirs.
        const double bottom = world_boundary(world, 0).impulse[2];
        ck_assert_double_eq_tol(bottom, 0.5 * 10 * 0.5 * 2e-3, 100 * ROUNDING);
        ck_assert_double_lt(world_momentum(world).linear_drift, 100 * ROUNDING);
        brunt_world_destroy(world);
    }
}
END_TEST

// A balloon without gas in it is crushed: the run ends with the name of the boundary before anything is divided by
// nothing.
START_TEST(volume_passes_zero) {
    brunt_world_def def = box(BRUNT_HEX8, 0, 0);
    brunt_body_def *body = &def.bodies[0];
    body->method = BRUNT_MEMBRANE, body->element = BRUNT_MEMBRANE_QUAD4, body->thickness = 1e-3;
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    int status = BRUNT_OK;
    for (int k = 0; k < 5000 && !status; k++) status = brunt_world_step(world, INFINITY, &error);
    ck_assert_int_eq(status, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "(gas)") && strstr(error.message, "volume"), "%s", error.message);
    brunt_world_destroy(world);
}
END_TEST

// A volume is what it is wherever it lies: closed by itself, or but for one face by a plane of symmetry, and far along
// the other axes.
START_TEST(volume_hangs_on_no_origin) {
    static const char *const faces[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
    static const double size[] = {0.4, 0.3, 0.2};
    const double far = sizeof(real) == sizeof(double) ? 4096 : 4;
    for (int open = -1; open < 6; open++) {
        brunt_world_def def = box(BRUNT_MEMBRANE_QUAD4, OUTSIDE, 0);
        brunt_body_def *body = &def.bodies[0];
        body->method = BRUNT_MEMBRANE, body->thickness = 1e-3;
        body->faces = brunt_alloc(6 * sizeof *body->faces);
        double by[3] = {-far, far, 2 * far};
        for (int f = 0; f < 6; f++)
            if (f != open) snprintf(body->faces[body->face_count++], BRUNT_NAME_LENGTH, "%s", faces[f]);
        if (open >= 0) by[open / 2] = open % 2 ? -size[open / 2] : 0;
        body->place = brunt_placement_translate(brunt_placement_identity(), by);
        brunt_world *world = world_take(&def);
        ck_assert_double_eq_tol(gas_of(world).volume, 0.024, 0.024 * (far > 4 ? 1e-10 : 1e-4));
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(goes_on_with_the_same_bits) {
    brunt_world_def def = box(BRUNT_HEX8, 3 * OUTSIDE, 500);
    def.bodies[0].damping = 10;
    brunt_world *whole = world_from(&def), *first = world_from(&def), *second = world_from(&def);
    def.threads = 3;
    brunt_world *threads = world_from(&def);
    brunt_world_def_free(&def);
    world_steps(whole, 60);
    world_steps(threads, 60);
    world_steps(first, 25);
    world_copy_state(first, second);
    world_steps(second, 35);
    ck_assert_uint_eq(brunt_world_hash(whole), brunt_world_hash(second));
    ck_assert_uint_eq(brunt_world_hash(whole), brunt_world_hash(threads));
    ck_assert_double_eq(gas_of(whole).energy, gas_of(second).energy);
    ck_assert_double_eq(world_energy(whole).viscosity, world_energy(second).viscosity);
    brunt_world *const all[] = {whole, first, second, threads};
    for (int k = 0; k < 4; k++) brunt_world_destroy(all[k]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("gas");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, equal_pressures_do_nothing, 0, 2);
    tcase_add_loop_test(all, gas_keeps_its_entropy, 0, 2);
    tcase_add_test(all, work_is_what_the_gas_loses);
    tcase_add_test(all, nonsense_is_refused);
    tcase_add_loop_test(all, damping_slows, 0, 2);
    tcase_add_loop_test(all, any_damping_is_exact, 0, 2);
    tcase_add_loop_test(all, contact_bears_all_of_the_weight, 0, 2);
    tcase_add_test(all, volume_passes_zero);
    tcase_add_test(all, volume_hangs_on_no_origin);
    tcase_add_test(all, goes_on_with_the_same_bits);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
