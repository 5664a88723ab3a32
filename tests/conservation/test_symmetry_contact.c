// Material points that press on a mesh beside planes of symmetry: a quarter does what the whole does, and what the
// planes bear is booked, so that momentum is exact.
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

int main(void) {
    Suite *suite = suite_create("symmetry contact");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, quarter_is_a_quarter, 0, CASES);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
