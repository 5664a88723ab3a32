// Lines that are far from a body in implicit steps: not looked at, and nothing is changed by them.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"
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

int main(void) {
    Suite *suite = suite_create("far_lines");
    ADD_LOOP(far, 12);
    ADD_LOOP(far_changes_nothing, 2);
    return suite_main(suite);
}
#endif
