// Which bodies may meet, how, and what their contact has done. Of many bodies most pairs are alike: what is usual
// between bodies of points and of meshes is kept once, and pairs one by one only where they are not.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

struct brunt_pair;

typedef struct brunt_pair_entry {
    int32_t a, b, pair; // a <= b; -1: the two do not meet
    int32_t added;      // before it: so many
} brunt_pair_entry;

typedef struct brunt_pair_map {
    const uint8_t *mesh;     // of each body; NULL: there is nothing usual
    int32_t usual[3];        // pair of two bodies of which none, one, both are meshes; -1: they do not meet
    brunt_pair_entry *entry; // ascending
    int32_t count;
    size_t entry_capacity;
} brunt_pair_map;

typedef struct brunt_pairs {
    struct brunt_pair *pair; // an account each
    int count;
    uint8_t *mesh; // of each body
    brunt_pair_map map;
} brunt_pairs;

// The pair of two bodies, in either order; BRUNT_NONE: they do not meet. A body meets itself only where an entry says
// so.
int32_t brunt_pair_of(const brunt_pair_map *map, int32_t a, int32_t b);
// Which of `bodies` bodies meet another, or themselves, by a pair that is wanted (`wanted` of each pair): in `met`.
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_pair_map_met(const brunt_pair_map *map, int32_t bodies, const bool *wanted, bool *met, brunt_error *error);
// An entry for two bodies; before brunt_pair_of they must be sorted, after which the last that was added for two bodies
// counts. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_pair_map_add(brunt_pair_map *map, int32_t a, int32_t b, int32_t pair, brunt_error *error);
void brunt_pair_map_sort(brunt_pair_map *map);
void brunt_pairs_free(brunt_pairs *pairs); // made in world/pairs.c; accounts are saved by world/state.c
// Aborts where an entry is not of two of `bodies` bodies, not in its order, or of a pair that there is not; or an
// account is no number.
void brunt_pairs_validate(const brunt_pairs *pairs, int bodies);
