// Logarithm, exponential, power and inverse cube root of vectors of reals, from bit patterns and polynomials alone, so
// that every compiler and vector length gives them; no table, no branch.
//
// Accuracy against the correctly rounded value, largest error seen in the tests (double, float):
//   lanes_log 1 ulp, lanes_log1p 2 ulp, lanes_exp 1.1 ulp, lanes_expm1 2 ulp, lanes_inverse_cbrt 2 ulp,
//   lanes_pow 2 ulp while |y| <= 4, then growing like |y| / 4 ulp.
// Special values as in libm: log(0) = -inf, log(x < 0) = nan, exp saturates to 0 and inf through the subnormal numbers,
// nan in gives nan out. lanes_pow and lanes_inverse_cbrt are for x > 0 (the latter: normal x).
#pragma once

#include "base/simd.h"

#include <float.h>

#ifdef BRUNT_FLOAT
enum { LANES_MANTISSA_BITS = 23, LANES_EXPONENT_BIAS = 127 };
#define LANES_REAL_MIN FLT_MIN
#define LANES_REAL_EPSILON FLT_EPSILON
#define LANES_LN2_HIGH 0x1.62ep-1f // 12 bits: exact times any exponent
#define LANES_LN2_LOW 0x1.0bfbe8e7bcd5ep-15f
#define LANES_EXP_LIMIT 160                // beyond it exp is 0 or inf with room to spare
#define LANES_HALF_MASK (~(lane_int)0xfff) // keeps the upper half of a mantissa
#else
enum { LANES_MANTISSA_BITS = 52, LANES_EXPONENT_BIAS = 1023 };
#define LANES_REAL_MIN DBL_MIN
#define LANES_REAL_EPSILON DBL_EPSILON
#define LANES_LN2_HIGH 0x1.62e42fefa2p-1 // 40 bits
#define LANES_LN2_LOW 0x1.9ef35793c7673p-41
#define LANES_EXP_LIMIT 1100
#define LANES_HALF_MASK (~(lane_int)0x7ffffff)
#endif
#define LANES_ONE_BITS ((lane_int)LANES_EXPONENT_BIAS << LANES_MANTISSA_BITS)

// Adding this number rounds to an integer and leaves it in the low mantissa bits (|a| below 2^(mantissa bits - 2)).
#define LANES_ROUND ((real)((lane_int)3 << (LANES_MANTISSA_BITS - 1)))

// The vector of a small integer vector; and the integers of a vector rounded by adding LANES_ROUND.
BRUNT_INLINE lanes lanes_of_int(lane_mask n) { return (lanes)(n + (lane_mask)lanes_set(LANES_ROUND)) - LANES_ROUND; }
BRUNT_INLINE lane_mask lanes_int_of_rounded(lanes shifted) {
    return (lane_mask)shifted - (lane_mask)lanes_set(LANES_ROUND);
}

// log x = high + low for normal x > 0, with low small. x = 2^e (1 + f), f in [sqrt(1/2) - 1, sqrt(2) - 1), s = f / (2 +
// f): log(1 + f) = 2 artanh s = f - s (f - R), R = 2 (s^2/3 + s^4/5 + ...); the form keeps f itself exact.
BRUNT_INLINE void lanes_log_parts(lanes x, lanes *high, lanes *low) {
    lane_mask bits = (lane_mask)x;
#ifdef BRUNT_FLOAT
    const lane_int root_half = 0x3f3504f3; // bits of sqrt(1/2), so that 1 + f starts there
#else
    const lane_int root_half = 0x3fe6a09e667f3bcd;
#endif
    lane_mask e = (bits - root_half) >> LANES_MANTISSA_BITS;
    lanes f = (lanes)(bits - (e << LANES_MANTISSA_BITS)) - 1;
    lanes s = f / (f + 2), z = s * s;
#ifdef BRUNT_FLOAT
    enum { TERMS = 5 };
#else
    enum { TERMS = 11 };
#endif
    lanes series = lanes_set((real)(2.0 / (2 * TERMS + 1)));
    for (int k = TERMS - 1; k > 0; k--) series = series * z + (real)(2.0 / (2 * k + 1));
    lanes n = lanes_of_int(e), a = n * LANES_LN2_HIGH, sum = a + f;
    lanes rest = ((a - sum) + f) + (n * LANES_LN2_LOW - s * (f - z * series));
    *high = sum + rest;
    *low = (sum - *high) + rest;
}

BRUNT_INLINE lanes lanes_log(lanes x) {
    const real up = (real)((lane_int)1 << LANES_MANTISSA_BITS);
    lane_mask tiny = x < LANES_REAL_MIN;
    lanes high, low;
    lanes_log_parts(lanes_select(tiny, x * up, x), &high, &low);
    high -= lanes_select(tiny, lanes_set((real)(LANES_MANTISSA_BITS * 0.693147180559945309)), lanes_set(0));
    lanes special = lanes_select(x == 0, lanes_set(-(real)INFINITY), lanes_set((real)NAN));
    special = lanes_select(x == (real)INFINITY, x, special);
    return lanes_select((x > 0) & (x < (real)INFINITY), high, special);
}

// log(1 + x): what rounding 1 + x loses is put back to first order.
BRUNT_INLINE lanes lanes_log1p(lanes x) {
    lanes u = 1 + x, lost = x - (u - 1);
    return lanes_log(u) + lanes_select((u > 0) & (u < (real)INFINITY), lost / u, lanes_set(0));
}

// exp(x + tail) = (1 + rest) first second, |tail| much smaller than 1: returns rest. x = n ln 2 + r, |r| <= ln(2)/2,
// Taylor series of exp(r). Two powers of 2: 2^n alone would overflow where exp does not yet, and underflow where exp is
// subnormal.
BRUNT_INLINE lanes lanes_exp_rest(lanes x, lanes tail, lanes *first, lanes *second) {
    lanes bounded = lanes_max(lanes_min(x, lanes_set(LANES_EXP_LIMIT)), lanes_set(-LANES_EXP_LIMIT));
    lanes shifted = bounded * (real)1.44269504088896340736 + LANES_ROUND, n = shifted - LANES_ROUND;
    lanes r = ((bounded - n * LANES_LN2_HIGH) - n * LANES_LN2_LOW) + lanes_select(bounded == x, tail, lanes_set(0));
#ifdef BRUNT_FLOAT
    static const real inverse_factorial[] = {1.f / 5040, 1.f / 720, 1.f / 120, 1.f / 24, 1.f / 6, 0.5f};
#else
    static const real inverse_factorial[] = {1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800,
                                             1.0 / 362880,     1.0 / 40320,     1.0 / 5040,     1.0 / 720,
                                             1.0 / 120,        1.0 / 24,        1.0 / 6,        0.5};
#endif
    lanes series = lanes_set(inverse_factorial[0]);
    for (unsigned k = 1; k < sizeof inverse_factorial / sizeof *inverse_factorial; k++)
        series = series * r + inverse_factorial[k];
    lane_mask e = lanes_int_of_rounded(shifted), half = e >> 1;
    *first = (lanes)((half + LANES_EXPONENT_BIAS) << LANES_MANTISSA_BITS);
    *second = (lanes)((e - half + LANES_EXPONENT_BIAS) << LANES_MANTISSA_BITS);
    return r + r * r * series;
}

BRUNT_INLINE lanes lanes_exp_parts(lanes x, lanes tail) {
    lanes first, second, value = 1 + lanes_exp_rest(x, tail, &first, &second);
    return lanes_select(x == x, value * first * second, x);
}

BRUNT_INLINE lanes lanes_exp(lanes x) { return lanes_exp_parts(x, lanes_set(0)); }

// exp(x) - 1 = (rest first + (first - 1 / second)) second; a power of 2 is inverted by its exponent.
BRUNT_INLINE lanes lanes_expm1(lanes x) {
    lanes first, second, rest = lanes_exp_rest(x, lanes_set(0), &first, &second);
    lanes inverse = (lanes)(2 * LANES_ONE_BITS - (lane_mask)second);
    return lanes_select(x == x, (rest * first + (first - inverse)) * second, x);
}

// x^y for x > 0: the product y log x is carried with its rounding error (Dekker's exact product of halves).
BRUNT_INLINE lanes lanes_pow(lanes x, lanes y) {
    lanes log_high, log_low;
    lanes_log_parts(x, &log_high, &log_low);
    lanes xh = (lanes)((lane_mask)log_high & LANES_HALF_MASK), xl = log_high - xh;
    lanes yh = (lanes)((lane_mask)y & LANES_HALF_MASK), yl = y - yh;
    lanes product = y * log_high;
    lanes rest = ((xh * yh - product) + xh * yl + xl * yh) + xl * yl + y * log_low;
    return lanes_exp_parts(product, rest);
}

// x^(-1/3) for normal x > 0. The first guess divides the exponent by -3 in the bit pattern (within 3.5 %); then twice
// the series of (1 - e)^(-1/3), e = 1 - x y^3, to the fourth order, which takes the error below 1e-6 and below
// rounding.
BRUNT_INLINE lanes lanes_inverse_cbrt(lanes x) {
#ifdef BRUNT_FLOAT
    enum { SHIFT = 10, STEPS = 2 };
    const real offset = (real)(4.0 / 3 * 127 * (1 << 13) - 0.0315 * (1 << 13));
#else
    enum { SHIFT = 20, STEPS = 2 };
    const real offset = (real)(4.0 / 3 * 1023 * 4294967296.0 - 0.0315 * 4294967296.0);
#endif
    lanes guess = offset - lanes_of_int((lane_mask)x >> SHIFT) * (real)(1.0 / 3);
    lanes y = (lanes)(lanes_int_of_rounded(guess + LANES_ROUND) << SHIFT);
    for (int k = 0; k < STEPS; k++) {
        lanes e = 1 - x * y * y * y;
        lanes series = (e * (real)(35.0 / 243) + (real)(14.0 / 81)) * e + (real)(2.0 / 9);
        y += y * e * (series * e + (real)(1.0 / 3));
    }
    return y;
}
