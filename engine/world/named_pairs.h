// Pairs of bodies that a definition names, found by their bodies.
#pragma once

#include "world/definitions.h"

typedef struct brunt_named_pair {
    int32_t a, b, at; // bodies of the definition by number, a <= b; its place in contact.pairs
} brunt_named_pair;

typedef struct brunt_named_pairs {
    brunt_named_pair *pair; // ascending, those of two bodies in the order of the definition
    int32_t count;          // those whose names are bodies
} brunt_named_pairs;

// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_named_pairs_make(brunt_named_pairs *named, const brunt_world_def *def, brunt_error *error);
void brunt_named_pairs_free(brunt_named_pairs *named);
// The first two bodies a < b of which as many are meshes as `kinds` has a bit for, and which meet by the method of all:
// what names them last does not say another. BRUNT_OK, or BRUNT_FAILED: out of memory; there are none: a is BRUNT_NONE.
int brunt_first_usual_pair(const brunt_world_def *def, const brunt_named_pairs *named, unsigned kinds,
                           brunt_named_pair *first, brunt_error *error);
