// Lines that are far from a body in implicit steps: not looked at, and nothing is changed by them.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"
#include "scheme/implicit.h"
#include "world/world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static brunt_world_def block(brunt_condition condition, double step) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    hold_by_surfaces(&def, 2, step);
    def_box(&def, "block", XYZ(0.13, 0.02, 0), XYZ(0.73, 0.62, 0));
    def_line(&def, -2, 0.02, 3, 0.02, condition);
    return def;
}

// What the step brings near is not far, whichever of both goes.
START_TEST(far) {
    enum { NEITHER, LINE, BODY }; // which of them goes
    const int goes = _i / 2 % 3;
    const double way = 0.7, gap = _i % 2 ? 0.9 : 0.6, up = _i < 6 ? 1 : -1, at = _i < 6 ? 0.62 + gap : 0.02 - gap;
    brunt_world_def def = block(BRUNT_SEPARATE, 1);
    brunt_boundary_surface_def *q = def_line(&def, 3 * up, at, -3 * up, at, BRUNT_SEPARATE);
    if (goes == LINE) q->value[1] = -way * up;
    if (goes == BODY) def.bodies[0].velocity[1] = way * up;
    brunt_world *world = world_take(&def);
    brunt_boundary_surface *s = &world->boundaries.surfaces.surface[1];
    brunt_boundary_extent extent = {.dt = 1};
    brunt_boundary_bounds bounds;
    brunt_boundary_body_bounds(&world->bodies.mpm[0], 1, NULL, &bounds);
    if (goes == LINE) extent.step[1] = -way * up;
    ck_assert(brunt_boundary_surface_far(s, &bounds, &extent) == (goes == NEITHER || gap > way + 0.1));
    extent.way[1] = -gap * up; // the line is there by now
    ck_assert(!brunt_boundary_surface_far(s, &bounds, &extent));
    brunt_world_destroy(world);
}
END_TEST

START_TEST(far_changes_nothing) {
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = block(_i ? BRUNT_SEPARATE : BRUNT_SLIP, 5e-3);
        if (k) def_line(&def, -2, 5, 3, 5, _i ? BRUNT_SEPARATE : BRUNT_STICK)->value[1] = 1;
        def.gravity[1] = -9.81;
        brunt_world *world = world_take(&def);
        world_steps(world, 4);
        hash[k] = brunt_world_hash(world);
        brunt_world_destroy(world);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
}
END_TEST

// A grain that is drawn out to `gap` from a line that none of its nodes reaches: its lowest points are 0.275 m above
// the origin, and have boxes of 0.025 m; the line is at 0.03 m. A grain of next to no stiffness.
static brunt_world *drawn_out(double gap, double speed, double step) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e-6, 0);
    hold_by_surfaces(&def, 2, step);
    def_velocity(def_box(&def, "grain", XYZ(0.2, 0.25, 0), XYZ(0.4, 0.35, 0)), 0, -speed, 0);
    def_line(&def, -2, 0.03, 3, 0.03, BRUNT_SEPARATE)->friction = 0.3;
    brunt_world *world = world_take(&def);
    const double stretch = (0.275 - 0.03 - gap) / 0.025;
    brunt_particles *p = &world->bodies.mpm[0].particles;
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    for (int64_t s = 0; s < p->slots; s++) F[0][s] = (real)(1 / stretch), F[3][s] = (real)stretch;
    return world;
}

// What its nodes do not reach holds nothing, and ends nothing where it has come (a tenth of a cell).
START_TEST(end_of_a_drawn_grain_is_there) {
    brunt_world *world = drawn_out(_i ? 0.008 : 0.002, _i ? 6 : 0, 1e-3);
    brunt_newton_counts counts;
    world_steps(world, _i ? 1 : 3);
    brunt_world_newton(world, &counts, NULL);
    const brunt_reaction f = world_boundary(world, 0);
    ck_assert_int_gt(world->plan.implicit->rows.reached, 0);
    ck_assert_double_eq(counts.cuts, 0);
    ck_assert_double_eq(hypot(f.impulse[0], f.impulse[1]), 0);
    brunt_world_destroy(world);
}
END_TEST

// What comes from farther than that has shorter steps, until nodes of it see the line.
START_TEST(end_of_a_drawn_grain_comes) {
    brunt_world *world = drawn_out(0.04, 1, 0.05);
    brunt_newton_counts counts;
    world_steps(world, 1);
    brunt_world_newton(world, &counts, NULL);
    printf("  %g cuts\n", (double)counts.cuts);
    ck_assert_double_gt(counts.cuts, 0);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("far_lines");
    ADD_LOOP(far, 12);
    ADD_LOOP(far_changes_nothing, 2);
    ADD_LOOP(end_of_a_drawn_grain_is_there, 2);
    ADD_LOOP(end_of_a_drawn_grain_comes, 1);
    return suite_main(suite);
}
#endif
