// Labels: long
// Hard cases that need many steps: a million in free flight, a hundred turns of a finer ring.
#include "hard_world.h"

enum { MILLION = 1000000 };

// Rounding grows with the steps; its bound does so too.
START_TEST(million_steps_of_free_flight) {
    for (int t = 0; t < 3; t++) {
        flight f = fly(BRUNT_QUADRATIC, (brunt_transfer)(BRUNT_PIC + t), MILLION, 0);
        printf("  flight, 1e6 steps, transfer %d: place %.1e, velocity %.1e, contact %.1e N s, stress %.1e of E\n", t,
               f.place, f.velocity, f.contact, f.stress);
        ck_assert_double_le(f.place, ROUNDING > 1e-8 ? 0.1 : 1e-10);
        ck_assert_double_le(f.velocity, ROUNDING > 1e-8 ? 0.1 : 1e-10);
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
    ck_assert_double_le(f.angular, ROUNDING > 1e-8 ? 1 : 1e-8);
}
END_TEST

START_TEST(hundred_turns_of_a_fine_ring) {
    spinning s = spin_ring(0.1, 100);
    printf("  ring, 100 turns: angular %.1e, radius %.1e, energy lost %.2e, most gained in 1/8 turn %.1e\n", s.angular,
           s.radius, s.lost, s.gained);
    ck_assert_double_le(s.angular, ROUNDING > 1e-8 ? 0.1 : 1e-10);
    ck_assert_double_le(s.radius, 0.04);
    ck_assert_double_le(s.lost, 0.08);
    ck_assert_double_ge(s.lost, 0);
    ck_assert_double_le(s.gained, 1e-4);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("long stability");
    ADD(million_steps_of_free_flight);
    ADD(million_steps_of_turning_flight);
    ADD(hundred_turns_of_a_fine_ring);
    return suite_main(suite);
}
