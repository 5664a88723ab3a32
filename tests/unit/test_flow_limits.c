// Flow stresses at the ends of their parameters: laws that rise by much within next to no strain.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/material_sample.h"
#include "tests/support/suite.h"

static double parameter_set(const brunt_model *model, double *parameters, const char *name, double value) {
    return parameters[parameter_index(model, name)] = value;
}

// Sheared step by step, by more each time: first hardly, then by as much as a hundredth.
static void shear_on(sample *s, int step) {
    const double by = 1e-5 * pow(10, fmin(step / 10.0, 3));
    step_all(s, (mat){{{0, by, 0}, {0, 0, 0}, {0, 0, 0}}});
}

// A + B eps^n with an exponent so small that the law stands near A + B from strains on that are no numbers any more:
// below that the point is elastic, above it flows at the law, never above.
START_TEST(power_of_a_small_exponent) {
    const double exponents[] = {0.1, 0.03, 0.01, 1e-3, 1e-6, 1e-30}, A = 90e6, B = 292e6;
    const brunt_model *model = brunt_find_strength("johnson-cook");
    double parameters[BRUNT_MAX_PARAMETERS];
    for (int k = 0; k < 6; k++) {
        typical_parameters(model, 0, parameters);
        parameter_set(model, parameters, "A", A), parameter_set(model, parameters, "B", B);
        parameter_set(model, parameters, "n", exponents[k]), parameter_set(model, parameters, "C", 0);
        parameter_set(model, parameters, "taylor_quinney", 0);
        sample s = sample_create(model, parameters, false, 2 + k % 2, BRUNT_LANES);
        const real *strain = state_of(&s, "plastic_strain");
        int between = 0;
        for (int step = 0; step < 45; step++) {
            shear_on(&s, step);
            const double q = equivalent(get_stress(&s, 0)), now = (double)strain[0],
                         law = A + B * (now > 0 ? pow(now, exponents[k]) : 1);
            ck_assert_double_le(q, law * (1 + TOLERANCE(1e-9, 1e-4)));
            if (now > TOLERANCE(1e-12, 1e-6)) ck_assert_double_ge(q, law * (1 - TOLERANCE(1e-8, 1e-3)));
            between += now < 1e-30 && q > 1.2 * A;
        }
        ck_assert_double_gt((double)strain[0], 1e-2);
        if (exponents[k] < 0.02) ck_assert_int_gt(between, 0);
        sample_destroy(&s);
    }
}
END_TEST

// Voce's term with a saturation stress that is many times the yield stress, so that all there is to it is its start.
START_TEST(saturation_far_above_yield) {
    const double times[] = {10, 1e3, 1e6, 1e9, 1e12}, rates[] = {1, 100};
    const brunt_model *model = brunt_find_strength("von-mises");
    double parameters[BRUNT_MAX_PARAMETERS];
    for (int k = 0; k < 10; k++) {
        typical_parameters(model, 0, parameters);
        const double yield = parameter_set(model, parameters, "yield", 1e6), rate = rates[k / 5],
                     saturated = parameter_set(model, parameters, "saturation_stress", times[k % 5] * yield);
        parameter_set(model, parameters, "hardening", 0), parameter_set(model, parameters, "saturation_rate", rate);
        sample s = sample_create(model, parameters, false, 2 + k % 2, BRUNT_LANES);
        const real *strain = state_of(&s, "plastic_strain");
        for (int step = 0; step < 35; step++) {
            shear_on(&s, step);
            const double q = equivalent(get_stress(&s, 0)), now = (double)strain[0],
                         law = yield - (saturated - yield) * expm1(-rate * now);
            ck_assert_double_le(q, law * (1 + TOLERANCE(1e-9, 1e-4)));
            if (now > 0) ck_assert_double_ge(q, law * (1 - TOLERANCE(1e-9, 1e-4)));
        }
        ck_assert_double_gt((double)strain[0], 0);
        sample_destroy(&s);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("flow_limits");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, power_of_a_small_exponent);
    tcase_add_test(all, saturation_far_above_yield);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
