// Labels: long
// Hard cases that need many steps: a million in free flight and at rest, a hundred turns of a finer ring.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

enum { MILLION = 1000000 };

// Rounding grows with the steps; its bound does so too.
START_TEST(million_steps_of_free_flight) {
    for (int t = 0; t < 3; t++) {
        flight f = fly(BRUNT_QUADRATIC, (brunt_transfer)(BRUNT_PIC + t), MILLION, 0);
        printf("  flight, 1e6 steps, transfer %d: place %.1e, velocity %.1e, contact %.1e N s, stress %.1e of E\n", t,
               f.place, f.velocity, f.contact, f.stress);
        const double bound = ROUNDING > 1e-8 ? 0.1 : 1e-10;
        hard_case("C15", f.place, bound, bound, "points, %s: place after a million steps, of the way",
                  t == 0   ? "PIC"
                  : t == 1 ? "FLIP"
                           : "APIC");
        ck_assert_double_le(f.velocity, bound);
        ck_assert_double_eq(f.contact, 0);
    }
}
END_TEST

START_TEST(million_steps_of_turning_flight) {
    flight f = fly(BRUNT_QUADRATIC, BRUNT_APIC, MILLION, 3);
    printf("  flight, turning, 1e6 steps: place %.1e, velocity %.1e, angular momentum %.1e, growth %.1e\n", f.place,
           f.velocity, f.angular, f.growth);
    ck_assert_double_le(f.place, ROUNDING > 1e-8 ? 0.1 : 1e-10);
    ck_assert_double_le(f.velocity, ROUNDING > 1e-8 ? 0.1 : 1e-10);
    hard_case("C15", f.angular, ROUNDING > 1e-8 ? 1 : 1e-8, ROUNDING > 1e-8 ? 1 : 1e-8,
              "points, turning: drift of angular momentum");
}
END_TEST

START_TEST(hundred_turns_of_a_fine_ring) {
    spinning s = spin_ring(0.1, 100);
    printf("  ring, 100 turns: angular %.1e, radius %.1e, energy lost %.2e, most gained in 1/8 turn %.1e\n", s.angular,
           s.radius, s.lost, s.gained);
    hard_case("C16", s.angular, ROUNDING > 1e-8 ? 0.1 : 1e-10, ROUNDING > 1e-8 ? 0.1 : 1e-10,
              "four cells of rim: drift of angular momentum");
    hard_case("C16", s.radius, 1e-3, 0.04, "four cells of rim: radius, relative");
    ck_assert_double_le(s.lost, 0.08);
    ck_assert_double_ge(s.lost, 0);
    ck_assert_double_le(s.gained, 1e-4);
}
END_TEST

// C04. A block at rest on a plane and on held elements, without damping, under gravity that grows over two
// thousand periods. Without friction nothing holds the place of a block: only with it is a drift asked.
START_TEST(million_steps_at_rest) {
    const bool plane = _i & 1;
    const double h = 0.5, ramp = 200, g = 10, mu = _i & 2 ? 0.5 : 0;
    brunt_world_def def = def_begin(2, 1);
    def.groups = brunt_alloc(sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = mu;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *block = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0));
    block->method = BRUNT_FEM, block->element = BRUNT_QUAD4, block->size = h;
    if (plane) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, mu);
    } else {
        brunt_body_def *base = def_box(&def, "base", XYZ(-1, -0.5, 0), XYZ(2, 0, 0));
        base->method = BRUNT_FEM, base->element = BRUNT_QUAD4, base->size = h;
        def.groups[0] = brunt_group_def_default(), def.group_count = 1;
        snprintf(def.groups[0].body, sizeof def.groups[0].body, "base");
        snprintf(def.groups[0].group, sizeof def.groups[0].group, "surface");
    }
    def.gravity[1] = -g, def.gravity_ramp = ramp;
    brunt_world *world = world_take(&def);
    const int body = plane ? 0 : 1; // in order of name
    world_until(world, 1.1 * ramp);
    const brunt_body_sums start = world_sums(world, body);
    const double from = (plane ? world_boundary(world, 0) : world_pair(world, 0)).impulse[1],
                 begun = brunt_world_time(world);
    world_steps(world, MILLION - (int)brunt_world_steps(world));
    const brunt_body_sums end = world_sums(world, body);
    const brunt_reaction f = plane ? world_boundary(world, 0) : world_pair(world, 0);
    const double weight = end.mass * g, time = brunt_world_time(world) - begun;
    char what[64];
    snprintf(what, sizeof what, "mesh on %s, friction %g", plane ? "a plane" : "held elements", mu);
    if (mu > 0) hard_case("C04", fabs(end.centre[0] - start.centre[0]) / h, 1e-6, 1e-6, "%s: drift [edges]", what);
    hard_case("C04", -fmin(0, end.low[1]) / h, 0.02, 0.02, "%s: depth [edges]", what);
    hard_case("C04", end.kinetic / (weight * h), 1e-10, 1e-10, "%s: kinetic energy [m g h]", what);
    hard_case("C04", fabs((f.impulse[1] - from) / time / weight - 1), 1e-4, 1e-4, "%s: mean force of the weight", what);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("long stability");
    ADD(million_steps_of_free_flight);
    ADD(million_steps_of_turning_flight);
    ADD(hundred_turns_of_a_fine_ring);
    TCase *rest = tcase_create("million_steps_at_rest");
    tcase_add_loop_test(rest, million_steps_at_rest, 0, 4);
    suite_add_tcase(suite, rest);
    return suite_main(suite);
}
