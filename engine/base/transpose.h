// Numbers that lie four in a row, of as many rows as a vector has lanes: to lanes.
#pragma once

#include <stdint.h>

#include "base/simd.h"

#ifdef BRUNT_FLOAT
#define BRUNT_EIGHT_DOUBLES (BRUNT_LANES == 16) // as preprocessors see it
#define BRUNT_FOUR_DOUBLES (BRUNT_LANES == 8)
#else
#define BRUNT_EIGHT_DOUBLES (BRUNT_LANES == 8)
#define BRUNT_FOUR_DOUBLES (BRUNT_LANES == 4)
#endif

// Four numbers of each lane, from where it has them.
BRUNT_INLINE void doubles_take(const double *const at[BRUNT_DOUBLES], doubles out[4]) {
#if BRUNT_EIGHT_DOUBLES
    typedef double four __attribute__((vector_size(32), may_alias));
    typedef double unaligned_four __attribute__((vector_size(32), aligned(sizeof(double)), may_alias));
    four r[BRUNT_DOUBLES];
    for (int l = 0; l < BRUNT_DOUBLES; l++) {
        r[l] = *(const unaligned_four *)at[l];
        __asm__("" : "+v"(r[l])); // whole: gcc 12 reads them one by one
    }
#define BOTH(l) __builtin_shufflevector(r[l], r[(l) + 4], 0, 1, 2, 3, 4, 5, 6, 7)
    const doubles r0 = BOTH(0), r1 = BOTH(1), r2 = BOTH(2), r3 = BOTH(3);
#undef BOTH
    const doubles low01 = __builtin_shufflevector(r0, r1, 0, 8, 2, 10, 4, 12, 6, 14); // x0 x1 z0 z1 x4 x5 z4 z5
    const doubles low23 = __builtin_shufflevector(r2, r3, 0, 8, 2, 10, 4, 12, 6, 14);
    const doubles high01 = __builtin_shufflevector(r0, r1, 1, 9, 3, 11, 5, 13, 7, 15);
    const doubles high23 = __builtin_shufflevector(r2, r3, 1, 9, 3, 11, 5, 13, 7, 15);
    out[0] = __builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13);
    out[1] = __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13);
    out[2] = __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15);
    out[3] = __builtin_shufflevector(high01, high23, 2, 3, 10, 11, 6, 7, 14, 15);
#elif BRUNT_FOUR_DOUBLES
    const doubles r0 = doubles_load(at[0]), r1 = doubles_load(at[1]), r2 = doubles_load(at[2]),
                  r3 = doubles_load(at[3]);
    const doubles low01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6),
                  low23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6),
                  high01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7),
                  high23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
    out[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
    out[2] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
    out[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
#else
    double column[4][BRUNT_DOUBLES] __attribute__((aligned(64)));
    for (int l = 0; l < BRUNT_DOUBLES; l++)
        for (int a = 0; a < 4; a++) column[a][l] = at[l][a];
    for (int a = 0; a < 4; a++) out[a] = doubles_load(column[a]);
#endif
}
