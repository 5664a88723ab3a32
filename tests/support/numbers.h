// Numbers that look random and are the same everywhere, for tests that draw many cases.
#pragma once

#include <stdint.h>

// Of the generator's state; in [0, 1).
static inline double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = *state >> 11;
    x ^= x >> 23;
    return (double)(x & 0xffffffffffffu) / 0x1p48;
}

static inline double draw_between(uint64_t *state, double low, double high) { return low + (high - low) * draw(state); }

static inline int draw_whole(uint64_t *state, int count) { return (int)(draw(state) * count); }
