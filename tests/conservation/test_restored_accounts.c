// Labels: conservation
// A world that takes up the state of another tells the same of all that has happened to it: energy by its causes,
// momentum and what gave it, pairs and boundaries, steps.
#include "tests/support/def_world.h"

static brunt_body_def *mesh(brunt_body_def *body, double size) {
    body->method = BRUNT_FEM, body->element = BRUNT_HEX8, body->size = size;
    return body;
}

// A block that turns and is braked while it falls on another, which stands on a plane, both of metal that warms and
// goes where it is strained too far. The other world had another start, of which nothing is left.
static brunt_world_def scene(double speed) {
    brunt_world_def def = def_begin(3, 0.25);
    brunt_error error = {0};
    brunt_material_def *m = &def.materials[def.material_count++];
    *m = brunt_material_def_default("m", "johnson-cook");
    static const struct {
        const char *key;
        double value;
    } set[] = {{"density", 1000}, {"E", 1e7}, {"nu", 0.3},    {"A", 1e4},
               {"B", 1e4},        {"n", 0.5}, {"melt", 1000}, {"heat_capacity", 500}};
    for (size_t k = 0; k < sizeof set / sizeof *set; k++) brunt_material_set(m, set[k].key, set[k].value, NULL, &error);
    ck_assert_msg(error.code == BRUNT_OK, "%s", error.message);
    def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = 0.3;
    brunt_body_def *low = mesh(def_box(&def, "low", XYZ(2, 0.01, 1), XYZ(3, 0.51, 2)), 0.25),
                   *top = mesh(def_box(&def, "top", XYZ(2.2, 0.53, 1.1), XYZ(2.8, 1.13, 1.7)), 0.3);
    def_velocity(top, 4, -speed, 1);
    def_velocity(low, 0, -2, 0);
    top->spin[1] = 3, low->damping = 5, top->damping = 2;
    for (int a = 0; a < 3; a++) top->spin_about[a] = 2;
    low->hourglass = BRUNT_HOURGLASS_VISCOUS;
    low->erosion.strain = 0.1, top->erosion.inverted = true;
    def.gravity[0] = 1, def.gravity[1] = -10, def.gravity[2] = 2;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.2);
    def.cfl = 0.4;
    return def;
}

static void same(const double *a, const double *b, size_t bytes, const char *what) {
    for (size_t k = 0; k < bytes / sizeof *a; k++)
        ck_assert_msg(a[k] == b[k], "%s, number %d: %.17g and %.17g", what, (int)k, a[k], b[k]);
}

static void same_reaction(const brunt_reaction *a, const brunt_reaction *b, const char *what) {
    same(a->force, b->force, sizeof a->force, what), same(a->impulse, b->impulse, sizeof a->impulse, what);
    ck_assert_double_eq(a->normal_work, b->normal_work);
    ck_assert_double_eq(a->friction_work, b->friction_work);
    ck_assert_double_eq(a->area, b->area);
}

START_TEST(what_has_happened_is_taken_up) {
    brunt_world_def def = scene(15), slower = scene(7);
    brunt_world *old = world_take(&def), *other = world_take(&slower);
    brunt_eroded eroded = {0}, there;
    for (int s = 0; s < 2000 && !eroded.elements; s++) world_steps(old, 1), brunt_body_eroded(old, 0, &eroded);
    world_copy_state(old, other);
    const brunt_energy e = world_energy(old), f = world_energy(other);
    const brunt_momentum p = world_momentum(old), q = world_momentum(other);
    const brunt_reaction pair = world_pair(old, 0), plane = world_boundary(old, 0), pair_there = world_pair(other, 0),
                         plane_there = world_boundary(other, 0);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, ROUNDING);
    ck_assert_double_gt(e.heat, 1);
    ck_assert_double_gt(e.viscosity, 1);
    ck_assert_double_gt(fabs(p.angular_impulse[2]), 1);
    ck_assert_double_gt(pair.area, 0.01);
    ck_assert_double_gt(plane.area, 0.01);
    ck_assert_int_gt(eroded.elements, 0);
    same((const double *)&e, (const double *)&f, sizeof e, "energy");
    same((const double *)&p, (const double *)&q, sizeof p, "momentum");
    same_reaction(&pair, &pair_there, "pair"), same_reaction(&plane, &plane_there, "plane");
    brunt_body_eroded(other, 0, &there);
    ck_assert_mem_eq(&eroded, &there, sizeof eroded);
    ck_assert_double_eq(brunt_world_dt_min(old), brunt_world_dt_min(other));
    ck_assert_double_eq(brunt_world_dt_max(old), brunt_world_dt_max(other));
    brunt_world_destroy(old);
    brunt_world_destroy(other);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("restored accounts");
    ADD_LOOP(what_has_happened_is_taken_up, 1);
    return suite_main(suite);
}
