// A 64-bit mixing hash (finaliser of SplitMix64, Steele et al. 2014).
#pragma once

#include <stdint.h>

static inline uint64_t brunt_mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}
static inline uint64_t brunt_hash_add(uint64_t hash, uint64_t value) {
    return brunt_mix(hash + 0x9E3779B97F4A7C15u + value);
}
