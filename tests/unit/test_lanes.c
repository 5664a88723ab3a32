// The vector functions against libm in a wider type, over the whole range and at its ends.
#include <check.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/simd_math.h"
#include "tests/support/suite.h"

#ifdef BRUNT_FLOAT
#define REAL_MAX FLT_MAX
#define REAL_EPSILON FLT_EPSILON
#define next_after nextafterf
#else
#define REAL_MAX DBL_MAX
#define REAL_EPSILON DBL_EPSILON
#define next_after nextafter
#endif

static uint64_t random_bits(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = *state;
    return (x ^ (x >> 31)) * 0x9e3779b97f4a7c15u >> 11;
}

static double uniform(uint64_t *state, double low, double high) {
    return low + (high - low) * (double)random_bits(state) / 9007199254740992.0;
}

// Distance of a from the exact value in units in the last place of a real of that size.
static double ulps(real a, long double exact) {
    real rounded = (real)exact;
    if (isinf(rounded) || isinf(a)) return rounded == a ? 0 : 1e30;
    real size = rounded < 0 ? -rounded : rounded;
    long double unit = size < LANES_REAL_MIN ? LANES_REAL_MIN * (long double)REAL_EPSILON
                                             : (long double)next_after(size, REAL_MAX) - size;
    if (size == REAL_MAX) unit = size * (long double)REAL_EPSILON / 2;
    return (double)(fabsl((long double)a - exact) / unit);
}

enum { COUNT = 200000 };

START_TEST(logarithm) {
    uint64_t seed = 1;
    double worst = 0, worst1p = 0;
    for (int i = 0; i < COUNT; i++) {
        lanes x, d;
        for (int l = 0; l < BRUNT_LANES; l++) {
            double decades = i % 2 ? uniform(&seed, log((double)LANES_REAL_MIN), log((double)REAL_MAX) * 0.9999)
                                   : uniform(&seed, -1, 1);
            x[l] = (real)exp(decades);
            // Through memory: a product that is fused with what the function does to it is not the number it is
            // compared with.
            volatile real argument = (real)(uniform(&seed, -0.9, 1) * pow(10, uniform(&seed, -12, 0)));
            d[l] = argument;
        }
        lanes y = lanes_log(x), z = lanes_log1p(d);
        for (int l = 0; l < BRUNT_LANES; l++) {
            worst = fmax(worst, ulps(y[l], logl((long double)x[l])));
            worst1p = fmax(worst1p, ulps(z[l], log1pl((long double)d[l])));
        }
    }
    printf("log %.3f ulp, log1p %.3f ulp\n", worst, worst1p);
    ck_assert_double_le(worst, 1);
    ck_assert_double_le(worst1p, 2);
}
END_TEST

START_TEST(logarithm_ends) {
    const real x[] = {1, LANES_REAL_MIN, REAL_MAX, LANES_REAL_MIN / 1024, next_after(1, 2), next_after(1, 0)};
    for (unsigned i = 0; i < sizeof x / sizeof *x; i++)
        ck_assert_double_le(ulps(lanes_log(lanes_set(x[i]))[0], logl((long double)x[i])), 1);
    ck_assert(lanes_log(lanes_set(1))[0] == 0);
    ck_assert(lanes_log(lanes_set(0))[0] == -(real)INFINITY);
    ck_assert(lanes_log(lanes_set((real)INFINITY))[0] == (real)INFINITY);
    ck_assert(isnan(lanes_log(lanes_set(-1))[0]));
    ck_assert(isnan(lanes_log(lanes_set((real)NAN))[0]));
    ck_assert(lanes_log1p(lanes_set(0))[0] == 0);
    ck_assert(lanes_log1p(lanes_set(-1))[0] == -(real)INFINITY);
}
END_TEST

START_TEST(exponential) {
    uint64_t seed = 2;
    double worst = 0, limit = log((double)REAL_MAX), lowest = log((double)LANES_REAL_MIN);
    for (int i = 0; i < COUNT; i++) {
        lanes x;
        for (int l = 0; l < BRUNT_LANES; l++)
            x[l] = (real)(i % 2 ? uniform(&seed, lowest * 0.999, limit * 0.999) : uniform(&seed, -1, 1));
        lanes y = lanes_exp(x);
        for (int l = 0; l < BRUNT_LANES; l++) worst = fmax(worst, ulps(y[l], expl((long double)x[l])));
    }
    printf("exp %.3f ulp\n", worst);
    ck_assert_double_le(worst, 1.1);
    ck_assert(lanes_exp(lanes_set(0))[0] == 1);
    const double beyond[] = {limit * 1.001, limit * 1.5, 1e4, 1e30, INFINITY};
    for (unsigned i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        ck_assert(lanes_exp(lanes_set((real)beyond[i]))[0] == (real)INFINITY);
        ck_assert(lanes_exp(lanes_set((real) - (beyond[i] * 1.25)))[0] == 0);
    }
    // Gradual underflow: within two units of the last subnormal place.
    real gradual = (real)(lowest - 5);
    ck_assert_double_le(ulps(lanes_exp(lanes_set(gradual))[0], expl((long double)gradual)), 2);
    ck_assert(lanes_exp(lanes_set(gradual))[0] > 0);
    ck_assert(isnan(lanes_exp(lanes_set((real)NAN))[0]));
}
END_TEST

// exp(x) - 1 keeps its digits at any size of x, and saturates.
START_TEST(exponential_less_one) {
    uint64_t seed = 6;
    double worst = 0, limit = log((double)REAL_MAX), decades = log((double)REAL_EPSILON) - 5;
    for (int i = 0; i < COUNT; i++) {
        lanes x;
        for (int l = 0; l < BRUNT_LANES; l++) {
            volatile real argument = (real)(i % 3 == 0   ? uniform(&seed, -limit, limit) * 0.999
                                            : i % 3 == 1 ? uniform(&seed, -2, 2)
                                                         : exp(uniform(&seed, decades, 0)) * (l % 2 ? 1 : -1));
            x[l] = argument;
        }
        lanes y = lanes_expm1(x);
        for (int l = 0; l < BRUNT_LANES; l++) worst = fmax(worst, ulps(y[l], expm1l((long double)x[l])));
    }
    printf("expm1 %.3f ulp\n", worst);
    ck_assert_double_le(worst, 2);
    ck_assert(lanes_expm1(lanes_set(0))[0] == 0);
    const real tiny = LANES_REAL_MIN;
    ck_assert(lanes_expm1(lanes_set(tiny))[0] == tiny && lanes_expm1(lanes_set(-tiny))[0] == -tiny);
    const double beyond[] = {limit * 1.001, limit * 1.5, 1e4, 1e30, INFINITY};
    for (unsigned i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        ck_assert(lanes_expm1(lanes_set((real)beyond[i]))[0] == (real)INFINITY);
        ck_assert(lanes_expm1(lanes_set((real)-beyond[i]))[0] == -1);
    }
    ck_assert(isnan(lanes_expm1(lanes_set((real)NAN))[0]));
}
END_TEST

START_TEST(power) {
    uint64_t seed = 3;
    double worst = 0, worst_large = 0;
    for (int i = 0; i < COUNT; i++) {
        lanes x, y;
        for (int l = 0; l < BRUNT_LANES; l++) {
            x[l] = (real)pow(10, uniform(&seed, -8, 8));
            y[l] = (real)uniform(&seed, -4, 4);
            if (i % 2) y[l] = (real)uniform(&seed, -30, 30), x[l] = (real)uniform(&seed, 0.1, 10);
        }
        lanes p = lanes_pow(x, y);
        for (int l = 0; l < BRUNT_LANES; l++) {
            double error = ulps(p[l], powl((long double)x[l], (long double)y[l]));
            if (i % 2)
                worst_large = fmax(worst_large, error);
            else
                worst = fmax(worst, error);
        }
    }
    printf("pow %.3f ulp for |y| <= 4, %.3f ulp for |y| <= 30\n", worst, worst_large);
    ck_assert_double_le(worst, 2);
    ck_assert_double_le(worst_large, 8);
    ck_assert(lanes_pow(lanes_set(2), lanes_set(10))[0] == 1024);
    ck_assert(lanes_pow(lanes_set(7), lanes_set(0))[0] == 1);
    ck_assert(lanes_pow(lanes_set(1), lanes_set(-3))[0] == 1);
    ck_assert(lanes_pow(lanes_set(10), lanes_set(1000))[0] == (real)INFINITY);
    ck_assert(lanes_pow(lanes_set(10), lanes_set(-1000))[0] == 0);
}
END_TEST

START_TEST(inverse_cube_root) {
    uint64_t seed = 4;
    double worst = 0;
    for (int i = 0; i < COUNT; i++) {
        lanes x;
        for (int l = 0; l < BRUNT_LANES; l++)
            x[l] = (real)exp(i % 2 ? uniform(&seed, log((double)LANES_REAL_MIN), log((double)REAL_MAX)) * 0.999
                                   : uniform(&seed, -1, 1));
        lanes y = lanes_inverse_cbrt(x);
        for (int l = 0; l < BRUNT_LANES; l++) worst = fmax(worst, ulps(y[l], 1 / cbrtl((long double)x[l])));
    }
    printf("inverse cbrt %.3f ulp\n", worst);
    ck_assert_double_le(worst, 2);
    ck_assert(lanes_inverse_cbrt(lanes_set(1))[0] == 1);
}
END_TEST

// A lane's result has the same bits whatever the other lanes hold.
START_TEST(lanes_are_independent) {
    uint64_t seed = 5;
    for (int i = 0; i < 1000; i++) {
        lanes x;
        for (int l = 0; l < BRUNT_LANES; l++) x[l] = (real)exp(uniform(&seed, -30, 30));
        lanes log_all = lanes_log(x), pow_all = lanes_pow(x, lanes_set((real)0.31)), root_all = lanes_inverse_cbrt(x);
        for (int l = 0; l < BRUNT_LANES; l++) {
            ck_assert(lanes_log(lanes_set(x[l]))[0] == log_all[l]);
            ck_assert(lanes_pow(lanes_set(x[l]), lanes_set((real)0.31))[0] == pow_all[l]);
            ck_assert(lanes_inverse_cbrt(lanes_set(x[l]))[0] == root_all[l]);
        }
    }
}
END_TEST

START_TEST(selects_and_reductions) {
    lanes a, b;
    for (int l = 0; l < BRUNT_LANES; l++) a[l] = (real)(l * l - 10), b[l] = (real)(5 - l);
    lanes low = lanes_min(a, b), high = lanes_max(a, b), size = lanes_abs(a), root = lanes_sqrt(size);
    real sum = 0, most = a[0], least = a[0];
    for (int l = 0; l < BRUNT_LANES; l++) {
        ck_assert(low[l] == (a[l] < b[l] ? a[l] : b[l]) && high[l] == (a[l] < b[l] ? b[l] : a[l]));
        ck_assert(size[l] == (a[l] < 0 ? -a[l] : a[l]));
        ck_assert_double_eq_tol(root[l] * root[l], size[l], 8 * REAL_EPSILON * size[l]);
        sum += a[l], most = a[l] > most ? a[l] : most, least = a[l] < least ? a[l] : least;
    }
    ck_assert(lanes_sum(a) == sum && lanes_max_of(a) == most && lanes_min_of(a) == least);
    ck_assert(lanes_any(a == a[BRUNT_LANES - 1]) && !lanes_any(a > most));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("lanes");
    TCase *tests = tcase_create("functions");
    tcase_add_test(tests, logarithm);
    tcase_add_test(tests, logarithm_ends);
    tcase_add_test(tests, exponential);
    tcase_add_test(tests, exponential_less_one);
    tcase_add_test(tests, power);
    tcase_add_test(tests, inverse_cube_root);
    tcase_add_test(tests, lanes_are_independent);
    tcase_add_test(tests, selects_and_reductions);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
