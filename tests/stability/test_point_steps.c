// How long steps may be for material points: alone in their cells, and where they shorten without end.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"
#include "mpm/courant.h"

static const brunt_kernel kernels[] = {BRUNT_LINEAR, BRUNT_QUADRATIC, BRUNT_CUBIC};
static const brunt_transfer transfers[] = {BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC};

typedef struct lone {
    int dimension;
    bool rings;
    brunt_kernel kernel;
    brunt_transfer transfer;
    double nu;
} lone;

// A particle or two with no neighbours, breathing a little, at 11 places in a cell: how many times as great as at the
// start its energy is at most. See engine/mpm/courant.c for what limits the step.
static double breathing_growth(const lone *c, double cfl) {
    const double h = 0.1;
    double worst = 0;
    for (int o = 0; o < 11; o++) {
        brunt_world_def def = def_begin(c->dimension, h);
        def.axisymmetric = c->rings;
        def.kernel = c->kernel;
        def.transfer = c->transfer;
        def.cfl = cfl;
        def_material(&def, "neo-hookean", 1000, 1e5, c->nu);
        const double at[3] = {0.1 * h * o + (c->rings ? 2 * h : 0), 0.1 * h * (3 * o % 11), 0.1 * h * (5 * o % 11)};
        brunt_body_def *b = def_point(&def, "a", at, 0.5 * h, XYZ(0, 0, 0));
        if (c->transfer != BRUNT_APIC) b->shape.max[0] += 0.5 * h; // one particle alone has nothing to breathe with
        for (int a = 0; a < c->dimension; a++)
            b->wave_velocity[a] = 1e-5, b->wave_vector[a] = 1, b->wave_phase -= at[a];
        brunt_world *world = world_take(&def);
        brunt_error error = {0};
        int status = BRUNT_OK;
        for (int s = 0; s < 400 && !status; s++) status = brunt_world_step(world, INFINITY, &error);
        brunt_energy e = world_energy(world);
        worst = fmax(worst, status ? INFINITY : (e.kinetic + e.internal) / e.initial);
        brunt_world_destroy(world);
    }
    return worst;
}

// C11: at the default step nothing gains energy, at the limit of the table neither; two tenths above most do.
START_TEST(lone_particles_are_stable_at_the_default_step) {
    for (int space = 0; space < 3; space++) { // 2D, 3D, rings
        double worst = 0;
        int above = 0;
        for (int i = 0; i < 9; i++) {
            lone c = {space == 1 ? 3 : 2, space == 2, kernels[i % 3], transfers[i / 3], 0.3};
            const double limit = brunt_lone_points_cfl(c.dimension, c.kernel, c.transfer);
            if (limit == 0) continue; // linear with APIC: energy is made at every step
            const double growth = breathing_growth(&c, 0), more = breathing_growth(&c, fmin(1, limit + 0.2));
            worst = fmax(worst, growth);
            above += !(more < 100);
            if (space < 2) ck_assert_double_le(breathing_growth(&c, limit), 10); // swings of an energy kept to O(dt^2)
            printf("  breathing, %s kernel %d transfer %d: energy grows %.1e fold, %.1e fold at cfl %.1f\n",
                   space == 2   ? "rings"
                   : space == 1 ? "3D"
                                : "2D",
                   (int)c.kernel, (int)c.transfer, growth, more, fmin(1, limit + 0.2));
        }
        hard_case("C11", worst, 2, 2, "points alone, default step, %s: energy, of that at the start",
                  space == 2   ? "rings"
                  : space == 1 ? "3D"
                               : "2D");
        ck_assert_int_ge(above, 5);
    }
}
END_TEST

// What hardly shears is the stiffest for its wave speed: at the default step, which bodies that hold together bear,
// some kernels and transfers gain energy.
START_TEST(lone_particles_that_hardly_shear) {
    static const int known[] = {2, 5, 2};
    for (int space = 0; space < 3; space++) {
        int unstable = 0;
        for (int i = 0; i < 6; i++) {
            lone c = {space == 1 ? 3 : 2, space == 2, kernels[1 + i % 2], transfers[i / 2], 0.49};
            unstable += !(breathing_growth(&c, 0) < 100);
        }
        hard_case(
            "C11", unstable, 0, known[space],
            "points alone, Poisson's ratio 0.49, default step, %s: of 6 kernels and transfers, how many gain energy",
            space == 2   ? "rings"
            : space == 1 ? "3D"
                         : "2D");
    }
}
END_TEST

// A block of four cells, of so many points a cell along each axis, that swings a little in many ways: as above.
static double swinging_growth(const lone *c, int points, double cfl) {
    enum { PLACES = 3, STEPS = 300 };
    const double h = 0.1;
    double worst = 0;
    for (int o = 0; o < PLACES && worst < 100; o++) {
        brunt_world_def def = def_begin(c->dimension, h);
        def.kernel = c->kernel, def.transfer = c->transfer, def.flip = 1, def.cfl = cfl;
        def_material(&def, "neo-hookean", 1000, 1e5, c->nu);
        double low[3], high[3];
        for (int a = 0; a < 3; a++) low[a] = h * (0.12 + (2 * a + 1) * o / (double)PLACES), high[a] = low[a] + 4 * h;
        brunt_body_def *b = def_box(&def, "a", low, high);
        b->spacing = h / points;
        for (int a = 0; a < c->dimension; a++) b->wave_velocity[a] = 1e-3, b->wave_vector[a] = 17 + 6 * a;
        brunt_world *world = world_take(&def);
        brunt_error error = {0};
        int status = BRUNT_OK;
        for (int s = 0; s < STEPS && !status && worst < 100; s++) {
            status = brunt_world_step(world, INFINITY, &error);
            const brunt_energy e = world_energy(world);
            worst = fmax(worst, status ? INFINITY : (e.kinetic + e.internal) / e.initial);
        }
        brunt_world_destroy(world);
    }
    return worst;
}

// What holds together is stable with longer steps than points alone; a quarter above what is said most is not.
START_TEST(points_that_hold_together_take_longer_steps) {
    for (int dimension = 2; dimension < 4; dimension++) {
        int above = 0;
        for (int i = 0; i < 6; i++) {
            lone c = {dimension, false, kernels[1 + i % 2], transfers[i / 2], 0.499};
            const double limit = brunt_together_cfl(dimension, c.kernel, c.transfer);
            ck_assert_double_ge(limit, brunt_default_cfl(dimension, c.kernel, c.transfer));
            const double soft = swinging_growth(&c, 1, limit), more = swinging_growth(&c, 1, fmin(1, limit + 0.25));
            c.nu = 0.3;
            const double solid = swinging_growth(&c, 2, limit);
            printf("  a block, %dD kernel %d transfer %d: energy grows %.2f and %.2f fold at cfl %.1f, %.1e at %.2f\n",
                   dimension, (int)c.kernel, (int)c.transfer, soft, solid, limit, more, fmin(1, limit + 0.25));
            ck_assert_double_le(fmax(soft, solid), 2);
            above += !(more < 100);
        }
        ck_assert_int_ge(above, 3);
    }
    ck_assert(brunt_together_cfl(2, BRUNT_LINEAR, BRUNT_FLIP) == 0);
}
END_TEST

// A block between mirror planes, pressed by one of them, of a solid whose equation of state ends at J = 1/3: it hardens
// without bound before, so that the end of the time is never reached.
static brunt_world_def def_press(brunt_method method, double speed) {
    brunt_world_def def = def_begin(2, 0.125);
    brunt_material_def *m = def_material(&def, "von-mises", 1000, 1e5, 0.3);
    snprintf(m->eos, sizeof m->eos, "mie-gruneisen");
    const double eos[] = {30, 1.5, 1.5, 0, INFINITY};
    memcpy(m->eos_parameters, eos, sizeof eos);
    m->strength_parameters[2] = 1e4; // yield stress
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SEPARATE, 0);
    def_plane(&def, XYZ(0.25, 0, 0), XYZ(-1, 0, 0), BRUNT_SEPARATE, 0)->velocity[0] = -speed;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, 0.25, 0), XYZ(0, -1, 0), BRUNT_SYMMETRY, 0);
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.25, 0.25, 0));
    b->method = method;
    if (method == BRUNT_FEM) b->size = 0.125, b->element = BRUNT_QUAD4;
    return def;
}

static int step_on(brunt_world *world, int most, brunt_error *error) {
    int status = BRUNT_OK;
    for (int s = 0; s < most && !status; s++) status = brunt_world_step(world, INFINITY, error);
    return status;
}

// C18, C26: told once at a thousandth of the longest step, an error that says where at a millionth, and with the same
// bits from a restart; a scene that sets its least step goes on.
START_TEST(steps_that_shorten_without_end_are_reported) {
    for (int i = 0; i < 2; i++) {
        brunt_error error = {0}, again = {0};
        brunt_world_def def = def_press(i ? BRUNT_FEM : BRUNT_MPM, i ? 5 : 100);
        brunt_world *world = world_from(&def), *other = world_from(&def);
        while (brunt_warning_count(world) == 0)
            ck_assert_msg(step_on(world, 1, &error) == BRUNT_OK, "%s", error.message);
        printf("  %s\n", brunt_world_warning(world, 0));
        ck_assert_int_eq(step_on(world, 1, &error), BRUNT_OK);
        const double share = brunt_world_dt(world) / brunt_world_dt_max(world);
        ck_assert_double_lt(share, 1e-3);
        ck_assert_double_gt(share, 1e-4);
        ck_assert_ptr_nonnull(strstr(brunt_world_warning(world, 0), "'block'"));
        while (brunt_world_dt(world) > 1.1e-6 * brunt_world_dt_max(world))
            ck_assert_int_eq(step_on(world, 1, &error), BRUNT_OK);
        world_copy_state(world, other);
        ck_assert_int_eq(step_on(world, 100000, &error), BRUNT_FAILED);
        printf("  %s\n", error.message);
        ck_assert_int_eq(brunt_warning_count(world), 1);
        ck_assert_str_eq(error.body, "block");
        ck_assert(error.id >= 0 && error.position[0] > 0 && error.position[0] < 1 && error.time > 0);
        ck_assert_ptr_nonnull(strstr(error.message, "least_step"));
        hard_case("C26", brunt_world_dt(world) / brunt_world_dt_max(world), 1.1e-6, 1.1e-6,
                  "hardening without bound, %s: last step, of the longest", i ? "elements" : "points");
        ck_assert_int_eq(step_on(other, 100000, &again), BRUNT_FAILED);
        ck_assert_str_eq(error.message, again.message);
        ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(other));
        brunt_world_destroy(world), brunt_world_destroy(other);

        def.least_step = 1e-30;
        world = world_from(&def);
        ck_assert_int_eq(step_on(world, 200, &error), BRUNT_OK);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
}
END_TEST

// C18: cut to end on times that somebody asks for, before and after long ones, they are sound.
START_TEST(steps_cut_short_do_not_count) {
    brunt_world_def def = def_bounce(0.1, XYZ(0, 0, 0));
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    const double whole = brunt_world_dt(world);
    for (int s = 0; s < 50; s++) {
        ck_assert_int_eq(brunt_world_step(world, brunt_world_time(world) + 1e-8 * whole, &error), BRUNT_OK);
        world_steps(world, 1);
    }
    ck_assert_int_eq(brunt_warning_count(world), 0);
    brunt_world_destroy(world);
}
END_TEST

// Points that soften stay, and bear pressure alone: above what that is stable with, the scene is told.
START_TEST(steps_too_long_for_lone_points_are_told) {
    for (int i = 0; i < 4; i++) {
        brunt_world_def def = def_press(BRUNT_MPM, 100);
        def.cfl = i & 1 ? 0.6 : 0.7; // 2D, quadratic, APIC
        if (i & 2) {
            brunt_error error = {0};
            ck_assert_int_eq(brunt_material_set(&def.materials[0], "failure", 0, "johnson-cook-damage", &error), 0);
            ck_assert_int_eq(brunt_material_set(&def.materials[0], "failure.d1", 3, NULL, &error), 0);
            def.materials[0].failure_action = BRUNT_FAILURE_SOFTEN;
        }
        brunt_world *world = world_take(&def);
        ck_assert_int_eq(brunt_warning_count(world), i == 2);
        if (i == 2) ck_assert_ptr_nonnull(strstr(brunt_world_warning(world, 0), "cfl 0.6"));
        brunt_world_destroy(world);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("point_steps");
    ADD(lone_particles_are_stable_at_the_default_step);
    ADD(lone_particles_that_hardly_shear);
    ADD(points_that_hold_together_take_longer_steps);
    ADD(steps_that_shorten_without_end_are_reported);
    ADD(steps_cut_short_do_not_count);
    ADD(steps_too_long_for_lone_points_are_told);
    return suite_main(suite);
}
