// Material points that press on a mesh beside planes of symmetry: a quarter does what the whole does, and what the
// planes bear is booked, so that momentum is exact. Planes at one place are one; those of other bodies are not there.
#include "tests/support/def_world.h"

static const double H = 0.1;

// A soft block of particles falls on a block of elements that is held from below; a quarter of it, or all.
static brunt_world_def fall(bool quarter, brunt_transfer transfer, double friction) {
    brunt_world_def def = def_begin(3, H);
    const double low = quarter ? 0 : -0.3, wide = quarter ? 0 : -0.5;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *floor = def_box(&def, "floor", XYZ(wide, wide, -0.2), XYZ(0.5, 0.5, 0));
    floor->method = BRUNT_FEM, floor->element = BRUNT_HEX8, floor->size = H;
    brunt_body_def *block = def_box(&def, "block", XYZ(low, low, 0.02), XYZ(0.3, 0.3, 0.42));
    def_velocity(block, 0, 0, -2);
    block->wave_velocity[0] = 0.6, block->wave_velocity[1] = 0.4; // it spreads, so that friction has work to do
    block->wave_vector[0] = 3, block->wave_vector[1] = 0;
    block->wave_velocity[1] = 0;
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = friction;
    def.contact.iterations = 200; // the same solution, not the same way to it
    def.transfer = transfer, def.flip = 1;
    def.groups = brunt_alloc(sizeof *def.groups);
    def.groups[def.group_count++] = brunt_group_def_default();
    snprintf(def.groups[0].body, sizeof def.groups[0].body, "floor");
    snprintf(def.groups[0].group, sizeof def.groups[0].group, "zmin");
    def.groups[0].action = BRUNT_GROUP_VELOCITY;
    if (quarter) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    }
    def.step = 2e-3;
    return def;
}

static const struct {
    brunt_transfer transfer;
    double friction, apic;
} cases[] = {{BRUNT_APIC, 0, 0}, {BRUNT_APIC, 0.3, 0}, {BRUNT_PIC, 0.3, 0}, {BRUNT_APIC, 0.3, 0.9}};
enum { CASES = sizeof cases / sizeof cases[0] };

START_TEST(quarter_is_a_quarter) {
    brunt_world_def one = fall(true, cases[_i].transfer, cases[_i].friction),
                    all = fall(false, cases[_i].transfer, cases[_i].friction);
    one.apic = all.apic = cases[_i].apic;
    brunt_world *quarter = world_take(&one), *whole = world_take(&all);
    double loudest = 0;
    for (int k = 0; k < 12; k++) {
        world_steps(quarter, 10);
        world_steps(whole, 10);
        brunt_body_sums a = world_sums(quarter, 0), b = world_sums(whole, 0), c = world_sums(quarter, 1),
                        d = world_sums(whole, 1);
        ck_assert_double_eq_tol(4 * a.momentum[2], b.momentum[2], 1e-3 * b.mass);
        ck_assert_double_eq_tol(4 * c.momentum[2], d.momentum[2], 1e-3 * b.mass);
        ck_assert_double_eq_tol(4 * (a.kinetic + a.internal), b.kinetic + b.internal, 1e-3 * b.mass);
        loudest = fmax(loudest, fabs(world_pair(quarter, 0).force[2]));
    }
    ck_assert_double_gt(loudest, 100); // they do meet
    brunt_world *const both[] = {quarter, whole};
    for (int k = 0; k < 2; k++) {
        brunt_momentum m = world_momentum(both[k]);
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        if (cases[_i].transfer == BRUNT_APIC) ck_assert_double_lt(m.angular_drift, ROUNDING);
        ck_assert_double_lt(fabs(world_energy(both[k]).error_relative), 1e-2);
        brunt_world_destroy(both[k]);
    }
}
END_TEST

// A block that slides on another, which is on planes through y = 0; a third body is beside them.
typedef enum upper { POINTS, POINTS_BY_SURFACES, ELEMENTS, UPPERS } upper;
static brunt_world_def slide(upper u) {
    brunt_world_def def = def_begin(2, H);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "low", XYZ(0, 0, 0), XYZ(1, 0.2, 0));
    brunt_body_def *up = def_box(&def, "up", XYZ(0.2, 0.2, 0), XYZ(0.6, 0.5, 0));
    if (u == ELEMENTS) up->method = BRUNT_FEM, up->element = BRUNT_QUAD4, up->size = H;
    def_velocity(up, 2, -1, 0);
    def_box(&def, "yonder", XYZ(3, 0.2, 0), XYZ(3.4, 0.6, 0));
    def.contact.method = u == POINTS ? BRUNT_CONTACT_MULTI_VELOCITY : BRUNT_CONTACT_AUGURY;
    def.contact.friction = 0.3;
    def.gravity[1] = -10;
    def.step = 1e-3;
    return def;
}

// Both blocks end at the same places, to the bit.
static void expect_same(brunt_world *world[2], const char *what) {
    double momentum[2][3];
    for (int k = 0; k < 2; k++) {
        world_steps(world[k], 40);
        ck_assert_double_gt(fabs(world_pair(world[k], 0).impulse[1]), 10); // they do meet
    }
    for (int body = 0; body < 2; body++) {
        for (int k = 0; k < 2; k++) memcpy(momentum[k], world_sums(world[k], body).momentum, sizeof momentum[k]);
        ck_assert_msg(!memcmp(momentum[0], momentum[1], sizeof momentum[0]),
                      "%s: body %d: %.17g, %.17g for %.17g, %.17g", what, body, momentum[0][0], momentum[0][1],
                      momentum[1][0], momentum[1][1]);
    }
    for (int k = 0; k < 2; k++) brunt_world_destroy(world[k]);
}

static const struct {
    const char *name;
    brunt_condition first, second, alone; // two planes, and the one that they are
} placed[] = {{"slip, twice", BRUNT_SLIP, BRUNT_SLIP, BRUNT_SLIP},
              {"symmetry, twice", BRUNT_SYMMETRY, BRUNT_SYMMETRY, BRUNT_SYMMETRY},
              {"slip, symmetry", BRUNT_SLIP, BRUNT_SYMMETRY, BRUNT_SLIP},
              {"stick, twice", BRUNT_STICK, BRUNT_STICK, BRUNT_STICK},
              {"slip, stick", BRUNT_SLIP, BRUNT_STICK, BRUNT_STICK}};
enum { PLACED = sizeof placed / sizeof placed[0] };

// Its images were added up once for each: blocks met one of twice its mass.
START_TEST(planes_at_one_place_are_one) {
    const int c = _i / UPPERS;
    brunt_world *world[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = slide((upper)(_i % UPPERS));
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), k ? placed[c].alone : placed[c].first, 0);
        if (!k) def_plane(&def, XYZ(0.5, 0, 0), XYZ(0, 2, 0), placed[c].second, 0);
        world[k] = world_take(&def);
    }
    expect_same(world, placed[c].name);
}
END_TEST

// What the body beside them slides on is nothing to the others, wherever it is: here where they touch, or away.
START_TEST(planes_of_other_bodies_are_not_there) {
    brunt_world *world[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = slide((upper)(_i % UPPERS));
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
        brunt_plane_def *other = def_plane(&def, XYZ(0, k ? -0.3 : 0.2, 0), XYZ(0, 1, 0), BRUNT_SLIP, 0);
        snprintf(other->body, sizeof other->body, "yonder");
        world[k] = world_take(&def);
    }
    expect_same(world, "of another body");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("symmetry contact");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, quarter_is_a_quarter, 0, CASES);
    tcase_add_loop_test(all, planes_at_one_place_are_one, 0, PLACED * UPPERS);
    tcase_add_loop_test(all, planes_of_other_bodies_are_not_there, 0, UPPERS);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
