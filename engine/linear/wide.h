// Two and four numbers at once, for small blocks: as they lie in memory, aligned no better than one.
#pragma once

#include "base/simd.h"

typedef double two __attribute__((vector_size(16)));
typedef double four __attribute__((vector_size(32)));
typedef double two_unaligned __attribute__((vector_size(16), aligned(8), may_alias));
typedef double four_unaligned __attribute__((vector_size(32), aligned(8), may_alias));

BRUNT_INLINE two two_load(const double *p) { return *(const two_unaligned *)p; }
BRUNT_INLINE void two_store(double *p, two a) { *(two_unaligned *)p = a; }
BRUNT_INLINE four four_load(const double *p) { return *(const four_unaligned *)p; }
BRUNT_INLINE void four_store(double *p, four a) { *(four_unaligned *)p = a; }
// Written so that gcc makes one instruction of it: of __builtin_convertvector it makes five, and numbers that are taken
// one by one it loads one by one where fours overlap.
BRUNT_INLINE four four_of_floats(const float *p) {
    float f __attribute__((vector_size(16)));
    memcpy(&f, p, sizeof f);
    return (four){f[0], f[1], f[2], f[3]};
}
