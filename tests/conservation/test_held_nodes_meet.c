// Labels: conservation
// Bodies that meet where nodes of their grids are held, or are reflected at a plane of symmetry: what one of them gets
// the other gives, and what the plane takes of it is the plane's.
#include "tests/support/def_world.h"

static brunt_world_def begin(int dimension, double friction) {
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY, def.contact.friction = friction;
    return def;
}

// Two blocks side by side that reach behind a plane, which holds the first one's nodes there, of which one comes upon
// the other and slides along it; the other is of points, or a mesh.
START_TEST(what_is_held_passes_on_what_it_gets) {
    const bool mesh = _i % 2;
    const int dimension = 2 + _i / 2 % 2;
    const brunt_condition condition = _i / 4 ? BRUNT_SLIP : BRUNT_STICK;
    brunt_world_def def = begin(dimension, 0.3);
    def_box(&def, "held", XYZ(-1, -0.5, 0), XYZ(0, 1, 1));
    brunt_body_def *body = def_box(&def, "other", XYZ(0.02, -0.45, 0.1), XYZ(1.02, 0.8, 0.9));
    def_velocity(body, -3, 1, dimension == 3 ? 0.5 : 0);
    if (mesh) body->method = BRUNT_FEM, body->element = dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, body->size = 0.2;
    const double height = condition == BRUNT_SLIP ? 0.1 : 0; // on a line of the grid it would be one of symmetry
    snprintf(def_plane(&def, XYZ(0, height, 0), XYZ(0, 1, 0), condition, 0)->body, BRUNT_NAME_LENGTH, "held");
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 1);
    world_until(world, 0.05);
    const brunt_body_sums after = world_sums(world, 1);
    const brunt_reaction pair = world_pair(world, 0), plane = world_boundary(world, 0);
    const double size = before.mass * 3;
    ck_assert_double_gt(pair.impulse[0], 0.1 * size);
    ck_assert_double_gt(fabs(plane.impulse[1]), 0.005 * size);
    for (int a = 0; a < dimension; a++)
        ck_assert_double_eq_tol(after.momentum[a] - before.momentum[a], pair.impulse[a], 100 * ROUNDING * size);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A block slides over another along a plane of symmetry, which takes nothing along itself: what the pair is told to
// give is what the block gets, push and friction.
START_TEST(halves_tell_what_they_get) {
    brunt_world_def def = begin(3, 0.2);
    def_box(&def, "low", XYZ(-1, -0.5, 0), XYZ(1, 0, 0.5));
    def_velocity(def_box(&def, "top", XYZ(-0.25, 0.01, 0), XYZ(0.25, 0.51, 0.5)), 4, -1, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SYMMETRY, 0);
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 1);
    world_until(world, 0.03);
    const brunt_body_sums after = world_sums(world, 1);
    const brunt_reaction pair = world_pair(world, 0);
    ck_assert_double_lt(pair.impulse[0], -0.02 * before.mass);
    for (int a = 0; a < 2; a++)
        ck_assert_double_eq_tol(after.momentum[a] - before.momentum[a], pair.impulse[a], 400 * ROUNDING * before.mass);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("held nodes meet");
    ADD_LOOP(what_is_held_passes_on_what_it_gets, 8);
    ADD_LOOP(halves_tell_what_they_get, 1);
    return suite_main(suite);
}
