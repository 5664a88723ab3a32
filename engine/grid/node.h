// Nodes as vectors: eight reals of a node, or four of them at once, and the transposition from particle lanes to nodes.
#pragma once

#include "base/simd.h"

typedef real node8 __attribute__((vector_size(8 * sizeof(real))));
typedef real node4 __attribute__((vector_size(4 * sizeof(real))));
typedef real node8_unaligned __attribute__((vector_size(8 * sizeof(real)), aligned(sizeof(real)), may_alias));
typedef real node4_unaligned __attribute__((vector_size(4 * sizeof(real)), aligned(sizeof(real)), may_alias));

BRUNT_INLINE node8 node8_load(const real *p) { return (node8) * (const node8_unaligned *)p; }
BRUNT_INLINE void node8_store(real *p, node8 a) { *(node8_unaligned *)p = a; }
BRUNT_INLINE node4 node4_load(const real *p) { return (node4) * (const node4_unaligned *)p; }
BRUNT_INLINE void node4_store(real *p, node4 a) { *(node4_unaligned *)p = a; }

// As much of a node's eight reals as a register of this machine holds: compilers keep wider vectors in memory.
#if defined(__AVX512F__) || (defined(__AVX__) && defined(BRUNT_FLOAT))
enum { NODE_PARTS = 1 };
#elif defined(__AVX__) || defined(BRUNT_FLOAT)
enum { NODE_PARTS = 2 };
#else
enum { NODE_PARTS = 4 };
#endif
enum { NODE_PART_REALS = 8 / NODE_PARTS };
typedef real node_part __attribute__((vector_size(NODE_PART_REALS * sizeof(real))));
typedef real node_part_unaligned
    __attribute__((vector_size(NODE_PART_REALS * sizeof(real)), aligned(sizeof(real)), may_alias));

// Part `part` of the node at p.
BRUNT_INLINE node_part node_part_load(const real *p, int part) {
    return (node_part) * (const node_part_unaligned *)(p + part * NODE_PART_REALS);
}
BRUNT_INLINE void node_part_store(real *p, int part, node_part a) {
    *(node_part_unaligned *)(p + part * NODE_PART_REALS) = a;
}

#define BRUNT_SHUFFLE8 __builtin_shufflevector

// out[l][c] = component[c][l] for eight components.
BRUNT_INLINE void node8_transpose(const lanes component[8], real out[BRUNT_LANES][8]) {
#if BRUNT_LANES == 8
    const lanes *c = component;
    lanes a0 = BRUNT_SHUFFLE8(c[0], c[1], 0, 8, 2, 10, 4, 12, 6, 14),
          a1 = BRUNT_SHUFFLE8(c[0], c[1], 1, 9, 3, 11, 5, 13, 7, 15);
    lanes a2 = BRUNT_SHUFFLE8(c[2], c[3], 0, 8, 2, 10, 4, 12, 6, 14),
          a3 = BRUNT_SHUFFLE8(c[2], c[3], 1, 9, 3, 11, 5, 13, 7, 15);
    lanes a4 = BRUNT_SHUFFLE8(c[4], c[5], 0, 8, 2, 10, 4, 12, 6, 14),
          a5 = BRUNT_SHUFFLE8(c[4], c[5], 1, 9, 3, 11, 5, 13, 7, 15);
    lanes a6 = BRUNT_SHUFFLE8(c[6], c[7], 0, 8, 2, 10, 4, 12, 6, 14),
          a7 = BRUNT_SHUFFLE8(c[6], c[7], 1, 9, 3, 11, 5, 13, 7, 15);
#define PAIR_LOW(a, b) BRUNT_SHUFFLE8(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define PAIR_HIGH(a, b) BRUNT_SHUFFLE8(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
    lanes b0 = PAIR_LOW(a0, a2), b1 = PAIR_LOW(a1, a3), b2 = PAIR_HIGH(a0, a2), b3 = PAIR_HIGH(a1, a3);
    lanes b4 = PAIR_LOW(a4, a6), b5 = PAIR_LOW(a5, a7), b6 = PAIR_HIGH(a4, a6), b7 = PAIR_HIGH(a5, a7);
#undef PAIR_LOW
#undef PAIR_HIGH
#define HALF_LOW(a, b) BRUNT_SHUFFLE8(a, b, 0, 1, 2, 3, 8, 9, 10, 11)
#define HALF_HIGH(a, b) BRUNT_SHUFFLE8(a, b, 4, 5, 6, 7, 12, 13, 14, 15)
    lanes_store(out[0], HALF_LOW(b0, b4));
    lanes_store(out[1], HALF_LOW(b1, b5));
    lanes_store(out[2], HALF_LOW(b2, b6));
    lanes_store(out[3], HALF_LOW(b3, b7));
    lanes_store(out[4], HALF_HIGH(b0, b4));
    lanes_store(out[5], HALF_HIGH(b1, b5));
    lanes_store(out[6], HALF_HIGH(b2, b6));
    lanes_store(out[7], HALF_HIGH(b3, b7));
#undef HALF_LOW
#undef HALF_HIGH
#elif BRUNT_LANES == 4
    for (int k = 0; k < 8; k += 4) {
        const lanes *c = component + k;
        const lanes low01 = __builtin_shufflevector(c[0], c[1], 0, 4, 2, 6),
                    low23 = __builtin_shufflevector(c[2], c[3], 0, 4, 2, 6),
                    high01 = __builtin_shufflevector(c[0], c[1], 1, 5, 3, 7),
                    high23 = __builtin_shufflevector(c[2], c[3], 1, 5, 3, 7);
        lanes_store(out[0] + k, __builtin_shufflevector(low01, low23, 0, 1, 4, 5));
        lanes_store(out[1] + k, __builtin_shufflevector(high01, high23, 0, 1, 4, 5));
        lanes_store(out[2] + k, __builtin_shufflevector(low01, low23, 2, 3, 6, 7));
        lanes_store(out[3] + k, __builtin_shufflevector(high01, high23, 2, 3, 6, 7));
    }
#else
    for (int l = 0; l < BRUNT_LANES; l++)
        for (int k = 0; k < 8; k++) out[l][k] = component[k][l];
#endif
}
