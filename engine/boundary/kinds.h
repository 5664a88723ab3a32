// Kinds of boundaries: a row each, in the file of the kind. Boundaries of a definition are counted through all kinds,
// in their order.
#pragma once

#include "contact/planes/boundary.h"

#define BRUNT_EXPLICIT_ONLY "this belongs to time.scheme: explicit"

#define BRUNT_BOUNDARY_ONE(NAME, kind, type, word, what) +1
enum { BRUNT_BOUNDARY_KIND_COUNT = 0 BRUNT_BOUNDARY_KINDS(BRUNT_BOUNDARY_ONE) };
extern const brunt_boundary_kind *const brunt_boundary_kinds[BRUNT_BOUNDARY_KIND_COUNT];

int32_t brunt_boundary_count(const brunt_world_def *def);
// Number of the first of a kind, by its word.
int32_t brunt_boundary_first(const brunt_world_def *def, const char *word);
const void *brunt_boundary_entry(const brunt_world_def *def, int32_t w, const brunt_boundary_kind **kind);
// The name of its columns in the history: its own, or one by its kind and number.
void brunt_boundary_name(const brunt_world_def *def, int32_t w, char out[BRUNT_NAME_LENGTH]);

// In the file of a kind: the functions that its entries are found by.
#define BRUNT_BOUNDARY_ENTRIES(kind, type)                                                                             \
    static int32_t count(const brunt_world_def *def) { return def->kind##_count; }                                     \
    static const void *entry(const brunt_world_def *def, int32_t i) { return &def->kind##s[i]; }                       \
    static const char *name(const void *one) { return ((const type##_def *)one)->name; }
// ... and the part of its row that every kind has.
#define BRUNT_BOUNDARY_ROW(key)                                                                                        \
    .word = key, .count = count, .entry = entry, .name = name, .free = free_all, .check = check, .make = make
