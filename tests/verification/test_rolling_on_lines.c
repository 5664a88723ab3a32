// What rolls on lines in implicit steps, lets go of them and comes again: momentum, energy, and no step without end.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.12, RADIUS = 0.5, G = 9.81;

// A disk on a slope of 60 degrees, that does not slip.
static brunt_world *disk(brunt_integrator integrator, brunt_fill fill, double step, int cut) {
    brunt_world_def def = def_begin(2, CELL);
    const double s = sin(PI / 3), c = cos(PI / 3);
    def_material(&def, "neo-hookean", 7800, 2e9, 0.3);
    hold_by_surfaces(&def, 2, step);
    brunt_body_def *b = def_ball(&def, "disk", XYZ(RADIUS * s, RADIUS * c, 0), RADIUS);
    b->fill = fill, b->particles_per_cell = 16;
    def_line(&def, -2 * c, 2 * s, 12 * c, -12 * s, BRUNT_SEPARATE)->friction = 2;
    def.gravity[1] = -G;
    def.integrator = integrator;
    def.newton.tolerance = 1e-10, def.newton.cut = cut;
    return world_take(&def);
}

// It hops, as it begins at once and its rim has corners: what the line has given is what is there, at any time.
START_TEST(lets_go) {
    enum { STEPS = 100 };
    brunt_world *world = disk(BRUNT_NEWMARK, _i % 2 ? BRUNT_FILL_RINGS : BRUNT_FILL_REGULAR, 2e-3 * (1 + _i / 2), 6);
    double drift = 0, off = 0;
    int free = 0, before = 1, hops = 0;
    for (int k = 0; k < STEPS; k++) {
        brunt_boundary_surface_report report;
        world_steps(world, 1);
        brunt_boundary_surface_read(world, 0, &report);
        drift = fmax(drift, world_momentum(world).linear_drift);
        off = fmax(off, fabs(world_energy(world).error_relative));
        free += !report.active, hops += before && !report.active, before = report.active;
    }
    printf("  case %d: free in %d of %d steps, %d hops; momentum %.1e, energy %.1e\n", _i, free, STEPS, hops, drift,
           off);
    ck_assert_double_le(drift, 1e-9);
    ck_assert_double_le(off, 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// Where its tractions find no end a shorter step does.
START_TEST(goes_on) {
    brunt_newton_counts n;
    brunt_world *world = disk(BRUNT_EULER, _i % 2 ? BRUNT_FILL_RINGS : BRUNT_FILL_REGULAR, 7.5e-3 * (1 + _i / 2), 6);
    world_until(world, 0.7);
    brunt_world_newton(world, &n, NULL);
    printf("  case %d: %g cuts of %g steps\n", _i, n.cuts, n.steps);
    brunt_world_destroy(world);
}
END_TEST

// A disk falls on a line by Newmark's rule in steps longer than it touches, and is thrown back as fast or faster than
// it came: 2.2 times, without a word. A run that has been given energy by that stops.
START_TEST(thrown_back) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    hold_by_surfaces(&def, 2, _i ? 2e-3 : 5e-2); // a touch takes some 20 ms
    brunt_body_def *b = def_ball(&def, "disk", XYZ(0, 0.6, 0), 0.5);
    b->fill = BRUNT_FILL_RINGS;
    def_velocity(b, 0, -1, 0);
    def_line(&def, -10, 0, 10, 0, BRUNT_SEPARATE);
    def.integrator = BRUNT_NEWMARK, def.newton.tolerance = 1e-10, def.energy_limit = 0.1;
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    int status = BRUNT_OK;
    while (!status && brunt_world_time(world) < 0.25) status = brunt_world_step(world, 0.25, &error);
    printf("  thrown back: %g m/s, %s\n", world_sums(world, 0).velocity[1], error.message);
    ck_assert_int_eq(status, _i ? BRUNT_OK : BRUNT_FAILED);
    if (!_i) ck_assert_ptr_nonnull(strstr(error.message, "the integrator has made"));
    if (_i) ck_assert_double_lt(world_sums(world, 0).velocity[1], 1);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("rolling_on_lines");
    ADD_LOOP(lets_go, 8);
    ADD_LOOP(goes_on, 4);
    ADD_LOOP(thrown_back, 2);
    return suite_main(suite);
}
#endif
