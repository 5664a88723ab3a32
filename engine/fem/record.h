// Records of four reals (place and mass, velocity, force) as vectors, and the way between records and element lanes.
#pragma once

#include "base/simd.h"

typedef real real4 __attribute__((vector_size(4 * sizeof(real))));
typedef real real4_unaligned __attribute__((vector_size(4 * sizeof(real)), aligned(sizeof(real)), may_alias));

BRUNT_INLINE real4 real4_load(const real *p) { return (real4) * (const real4_unaligned *)p; }
BRUNT_INLINE void real4_store(real *p, real4 a) { *(real4_unaligned *)p = a; }
BRUNT_INLINE real4 real4_set(real a) { return a - (real4){0}; }

// out[c][l] = component c < dim of the record of lane l, which is number index[l * step] of `records`, `stride` reals
// apart.
BRUNT_INLINE void gather_records(const real *records, int stride, const uint16_t *index, int step, int dim,
                                 lanes out[3]) {
#if BRUNT_LANES == 8
#define RECORD(l) real4_load(records + (size_t)index[(l)*step] * (size_t)stride)
#define BOTH(l) __builtin_shufflevector(RECORD(l), RECORD((l) + 4), 0, 1, 2, 3, 4, 5, 6, 7)
    lanes r0 = BOTH(0), r1 = BOTH(1), r2 = BOTH(2), r3 = BOTH(3);
    lanes low01 = __builtin_shufflevector(r0, r1, 0, 8, 2, 10, 4, 12, 6, 14); // x0 x1 z0 z1 x4 x5 z4 z5
    lanes low23 = __builtin_shufflevector(r2, r3, 0, 8, 2, 10, 4, 12, 6, 14);
    lanes high01 = __builtin_shufflevector(r0, r1, 1, 9, 3, 11, 5, 13, 7, 15);
    lanes high23 = __builtin_shufflevector(r2, r3, 1, 9, 3, 11, 5, 13, 7, 15);
    out[0] = __builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13);
    out[1] = __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13);
    if (dim == 3) out[2] = __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15);
#undef BOTH
#undef RECORD
#else
    real column[3][BRUNT_LANES] __attribute__((aligned(64)));
    for (int l = 0; l < BRUNT_LANES; l++) {
        const real *record = records + (size_t)index[l * step] * (size_t)stride;
        for (int c = 0; c < dim; c++) column[c][l] = record[c];
    }
    for (int c = 0; c < dim; c++) out[c] = lanes_load(column[c]);
#endif
}

// Adds component c of lane l, for the first `count` lanes, to record index[l * step] of `records`, 4 reals apart.
BRUNT_INLINE void add_to_records(real *records, const uint16_t *index, int step, int count, int dim,
                                 const lanes value[3]) {
    real row[BRUNT_LANES][4] __attribute__((aligned(64)));
#if BRUNT_LANES == 8
    lanes zero = lanes_set(0), x = value[0], y = value[1], z = dim == 3 ? value[2] : zero;
    lanes low = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14); // x0 y0 x2 y2 x4 y4 x6 y6
    lanes high = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
    lanes low_z = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
    lanes high_z = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
    lanes r02 = __builtin_shufflevector(low, low_z, 0, 1, 8, 9, 2, 3, 10, 11);
    lanes r46 = __builtin_shufflevector(low, low_z, 4, 5, 12, 13, 6, 7, 14, 15);
    lanes r13 = __builtin_shufflevector(high, high_z, 0, 1, 8, 9, 2, 3, 10, 11);
    lanes r57 = __builtin_shufflevector(high, high_z, 4, 5, 12, 13, 6, 7, 14, 15);
#define HALF(r, k) __builtin_shufflevector(r, r, 4 * (k), 4 * (k) + 1, 4 * (k) + 2, 4 * (k) + 3)
    real4_store(row[0], HALF(r02, 0)), real4_store(row[1], HALF(r13, 0));
    real4_store(row[2], HALF(r02, 1)), real4_store(row[3], HALF(r13, 1));
    real4_store(row[4], HALF(r46, 0)), real4_store(row[5], HALF(r57, 0));
    real4_store(row[6], HALF(r46, 1)), real4_store(row[7], HALF(r57, 1));
#undef HALF
#else
    for (int l = 0; l < BRUNT_LANES; l++)
        for (int c = 0; c < 4; c++) row[l][c] = c < dim ? value[c][l] : 0;
#endif
    for (int l = 0; l < count; l++) {
        real *record = records + (size_t)index[l * step] * 4;
        real4_store(record, real4_load(record) + real4_load(row[l]));
    }
}
