// Four doubles at once, on any machine.
#pragma once

#include <stdint.h>

#ifdef __AVX__
#include <immintrin.h>
#endif

typedef double quad __attribute__((vector_size(32)));
typedef int64_t quad_mask __attribute__((vector_size(32)));
typedef double quad_unaligned __attribute__((vector_size(32), aligned(sizeof(double)), may_alias));

static inline quad quad_set(double a) { return (quad){a, a, a, a}; }
static inline quad quad_load(const double *p) { return (quad) * (const quad_unaligned *)p; }
static inline void quad_store(double *p, quad a) { *(quad_unaligned *)p = a; }
static inline quad quad_select(quad_mask m, quad a, quad b) { return (quad)(((quad_mask)a & m) | ((quad_mask)b & ~m)); }
// Of what is no number and b: b.
static inline quad quad_max(quad a, quad b) {
#ifdef __AVX__
    return (quad)_mm256_max_pd((__m256d)a, (__m256d)b); // compilers would compare, and blend by masks
#else
    return quad_select(a > b, a, b);
#endif
}

static inline quad quad_min(quad a, quad b) {
#ifdef __AVX__
    return (quad)_mm256_min_pd((__m256d)a, (__m256d)b);
#else
    return quad_select(a < b, a, b);
#endif
}
static inline quad quad_sqrt(quad a) {
#ifdef __AVX__
    return (quad)_mm256_sqrt_pd((__m256d)a);
#else
    quad r = a;
    for (int l = 0; l < 4; l++) r[l] = __builtin_sqrt(a[l]);
    return r;
#endif
}

// Which of four are so, a bit each.
static inline unsigned quad_bits(quad_mask m) {
#ifdef __AVX__
    return (unsigned)_mm256_movemask_pd((__m256d)m);
#else
    return (unsigned)(-m[0] - 2 * m[1] - 4 * m[2] - 8 * m[3]);
#endif
}

// Of each of four its first numbers' sum: a[0] + a[1] + (a[2] + a[3]).
static inline quad quad_sums(quad a, quad b, quad c, quad d) {
    const quad ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7),
               cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}
