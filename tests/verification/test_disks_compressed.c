// The calibration of a packing's disks (bench/scenes/disks_compressed.yaml): friction makes no difference to forces
// between disks that are each other's mirror images, as nothing slips there.
#include "tests/support/small_program.h"

#include <jansson.h>

#ifndef BRUNT_FLOAT
// [N/m], between the disks.
static double force_with(double friction) {
    char words[400];
    snprintf(words, sizeof words,
             "run %s/bench/scenes/disks_compressed.yaml -t 1 -q -o out --fresh --set output.every=none --set "
             "contact.friction=%g",
             getenv("BRUNT_SOURCE"), friction);
    small_expect(words, 0, NULL);
    json_t *summary = json_load_file(small_path("out/summary.json"), 0, NULL);
    ck_assert_ptr_nonnull(summary);
    const json_t *measures = json_object_get(summary, "measures");
    const double force = json_number_value(json_object_get(json_object_get(measures, "between"), "value"));
    json_decref(summary);
    return force;
}

START_TEST(friction_makes_no_difference_between_disks_that_are_alike) {
    const double smooth = force_with(0);
    ck_assert_double_gt(smooth, 50);
    ck_assert_double_eq_tol(force_with(0.1), smooth, 1e-6 * smooth);
    ck_assert_double_eq_tol(force_with(0.5), smooth, 1e-6 * smooth);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("disks_compressed");
    TCase *tests = tcase_create("disks_compressed");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, friction_makes_no_difference_between_disks_that_are_alike);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#else
int main(void) { return 0; }
#endif
