// Vectors of reals, written once with the compilers' portable vector extension.
//
// BRUNT_LANES is the number of reals a vector holds: as many as a register of the machine that the program is built for
// (64 bytes with AVX-512, 32 with AVX, else 16), 1 in the scalar build that the tests run too. Wider vectors than
// registers are correct but slow: compilers keep their parts in memory (gcc 12, eight doubles in AVX2's registers:
// material points take three times as long). Sums over particles have the order of the lanes, so that last digits are
// those of a width. Element-wise arithmetic is the language's own (a + b, a * b); this header adds loads, selects and
// the few functions the kernels need. Comparisons give lane_mask vectors of 0 and -1.
#pragma once

#include "base/real.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef BRUNT_LANES
#if defined(__AVX512F__)
#define BRUNT_REGISTER_BYTES 64
#elif defined(__AVX__)
#define BRUNT_REGISTER_BYTES 32
#else
#define BRUNT_REGISTER_BYTES 16
#endif
#ifdef BRUNT_FLOAT
#define BRUNT_LANES (BRUNT_REGISTER_BYTES / 4)
#else
#define BRUNT_LANES (BRUNT_REGISTER_BYTES / 8)
#endif
#endif
#define BRUNT_LANE_BYTES (BRUNT_LANES * sizeof(real))

#if defined(__AVX512F__) && BRUNT_LANES > 1
#include <immintrin.h>
#define BRUNT_WHOLE_ROOTS
#endif

#ifdef BRUNT_FLOAT
typedef int32_t lane_int;
#else
typedef int64_t lane_int;
#endif

typedef real lanes __attribute__((vector_size(BRUNT_LANE_BYTES)));
typedef lane_int lane_mask __attribute__((vector_size(BRUNT_LANE_BYTES)));
// The same type as it lies in memory, aligned no better than one real.
typedef real lanes_unaligned __attribute__((vector_size(BRUNT_LANE_BYTES), aligned(sizeof(real)), may_alias));

#define BRUNT_INLINE static inline __attribute__((always_inline))

BRUNT_INLINE lanes lanes_load(const real *p) { return (lanes) * (const lanes_unaligned *)p; }
BRUNT_INLINE void lanes_store(real *p, lanes a) { *(lanes_unaligned *)p = a; }
BRUNT_INLINE lanes lanes_set(real a) { return a - (lanes){0}; }
BRUNT_INLINE lanes lanes_select(lane_mask m, lanes a, lanes b) {
    return (lanes)(((lane_mask)a & m) | ((lane_mask)b & ~m));
}
BRUNT_INLINE lanes lanes_max(lanes a, lanes b) { return lanes_select(a > b, a, b); }
BRUNT_INLINE lanes lanes_min(lanes a, lanes b) { return lanes_select(a < b, a, b); }
BRUNT_INLINE lanes lanes_abs(lanes a) { return lanes_max(a, -a); }

// Compilers that like registers of 32 bytes better take the roots of 64 in two parts, and hand them on through memory,
// where the halves are waited for before the whole can be read.
BRUNT_INLINE lanes lanes_sqrt(lanes a) {
#if defined(BRUNT_WHOLE_ROOTS) && defined(BRUNT_FLOAT)
    return (lanes)_mm512_sqrt_ps((__m512)a);
#elif defined(BRUNT_WHOLE_ROOTS)
    return (lanes)_mm512_sqrt_pd((__m512d)a);
#else
    lanes r = a; // set whole: compilers that vectorise the loop in parts would call it uninitialised
    for (int l = 0; l < BRUNT_LANES; l++)
#ifdef BRUNT_FLOAT
        r[l] = __builtin_sqrtf(a[l]);
#else
        r[l] = __builtin_sqrt(a[l]);
#endif
    return r;
#endif
}

BRUNT_INLINE bool lanes_any(lane_mask m) {
#if defined(BRUNT_WHOLE_ROOTS) && defined(BRUNT_FLOAT)
    return _mm512_test_epi32_mask((__m512i)m, (__m512i)m) != 0;
#elif defined(BRUNT_WHOLE_ROOTS)
    return _mm512_test_epi64_mask((__m512i)m, (__m512i)m) != 0;
#else
    lane_int any = 0;
    for (int l = 0; l < BRUNT_LANES; l++) any |= m[l];
    return any != 0;
#endif
}

// Sums and extremes over the lanes, always in lane order.
BRUNT_INLINE real lanes_sum(lanes a) {
    real s = a[0];
    for (int l = 1; l < BRUNT_LANES; l++) s += a[l];
    return s;
}
BRUNT_INLINE real lanes_max_of(lanes a) {
    real s = a[0];
    for (int l = 1; l < BRUNT_LANES; l++) s = a[l] > s ? a[l] : s;
    return s;
}
BRUNT_INLINE real lanes_min_of(lanes a) {
    real s = a[0];
    for (int l = 1; l < BRUNT_LANES; l++) s = a[l] < s ? a[l] : s;
    return s;
}

// Doubles, whatever a real is: as many as a register holds, and masks of them.
#ifdef BRUNT_FLOAT
enum { BRUNT_DOUBLES = BRUNT_LANES > 1 ? BRUNT_LANES / 2 : 1 };
#else
enum { BRUNT_DOUBLES = BRUNT_LANES };
#endif
typedef double doubles __attribute__((vector_size(BRUNT_DOUBLES * sizeof(double))));
typedef int64_t doubles_mask __attribute__((vector_size(BRUNT_DOUBLES * sizeof(double))));
typedef double doubles_unaligned
    __attribute__((vector_size(BRUNT_DOUBLES * sizeof(double)), aligned(sizeof(double)), may_alias));
BRUNT_INLINE doubles doubles_load(const double *p) { return (doubles) * (const doubles_unaligned *)p; }
BRUNT_INLINE void doubles_store(double *p, doubles a) { *(doubles_unaligned *)p = a; }
BRUNT_INLINE doubles doubles_set(double a) { return a - (doubles){0}; }
BRUNT_INLINE doubles doubles_select(doubles_mask m, doubles a, doubles b) {
    return (doubles)(((doubles_mask)a & m) | ((doubles_mask)b & ~m));
}
BRUNT_INLINE doubles doubles_max(doubles a, doubles b) { return doubles_select(a > b, a, b); }
BRUNT_INLINE doubles doubles_sqrt(doubles a) {
#ifdef BRUNT_WHOLE_ROOTS
    return (doubles)_mm512_sqrt_pd((__m512d)a);
#else
    doubles r = a;
    for (int l = 0; l < BRUNT_DOUBLES; l++) r[l] = __builtin_sqrt(a[l]);
    return r;
#endif
}

BRUNT_INLINE doubles_mask doubles_lane(void) {
    doubles_mask lane = {0};
    for (int l = 0; l < BRUNT_DOUBLES; l++) lane[l] = l;
    return lane;
}
BRUNT_INLINE doubles_mask doubles_mask_select(doubles_mask m, doubles_mask a, doubles_mask b) {
    return (a & m) | (b & ~m);
}
BRUNT_INLINE doubles_mask doubles_set_mask(int64_t a) { return a - (doubles_mask){0}; }

// The greatest and the least over the lanes, by halves: none waits for all those before it.
BRUNT_INLINE double doubles_greatest(doubles a) {
    double most[BRUNT_DOUBLES];
    doubles_store(most, a);
    for (int w = BRUNT_DOUBLES / 2; w > 0; w /= 2)
        for (int l = 0; l < w; l++) most[l] = most[l + w] > most[l] ? most[l + w] : most[l];
    return most[0];
}
BRUNT_INLINE int64_t doubles_mask_least(doubles_mask a) {
    int64_t least[BRUNT_DOUBLES];
    memcpy(least, &a, sizeof a);
    for (int w = BRUNT_DOUBLES / 2; w > 0; w /= 2)
        for (int l = 0; l < w; l++) least[l] = least[l + w] < least[l] ? least[l + w] : least[l];
    return least[0];
}

// Of reals.
BRUNT_INLINE doubles doubles_of(const real *p) {
#ifdef BRUNT_FLOAT
    typedef real reals __attribute__((vector_size(BRUNT_DOUBLES * sizeof(real)), aligned(sizeof(real)), may_alias));
    return __builtin_convertvector(*(const reals *)p, doubles);
#else
    return doubles_load(p); // gcc 12 converts a type to itself one by one
#endif
}
