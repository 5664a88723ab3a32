// Labels: long
// Hard cases that need many steps: a million in free flight, a hundred turns of a finer ring.
#include "hard_case.h"
#include "hard_world.h"

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

int main(void) {
    Suite *suite = suite_create("long stability");
    ADD(million_steps_of_free_flight);
    ADD(million_steps_of_turning_flight);
    ADD(hundred_turns_of_a_fine_ring);
    return suite_main(suite);
}
