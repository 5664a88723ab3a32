// Kinds of boundaries: a row each, in the file of the kind. Boundaries of a definition are counted through all kinds,
// in their order.
#pragma once

#include "contact/planes/boundary.h"

#define BRUNT_EXPLICIT_ONLY "this belongs to time.scheme: explicit"
#define BRUNT_NOT_STATIC "this belongs to time.scheme: explicit or implicit"
#define BRUNT_FRICTION_NOT_STATIC                                                                                      \
    BRUNT_NOT_STATIC ": load steps have friction of meshes, that are not axisymmetric, and there are others"
// Whether load steps have friction: what surfaces have given is kept by vertices of meshes.
static inline bool brunt_friction_in_load_steps(const brunt_world_def *def) {
    bool meshes = !def->axisymmetric;
    for (int32_t i = 0; i < def->body_count; i++) meshes = meshes && def->bodies[i].method == BRUNT_FEM;
    return meshes;
}

extern const brunt_boundary_kind *const brunt_boundary_kinds[];
extern const int brunt_boundary_kind_count;

int32_t brunt_boundary_entry_count(const brunt_world_def *def);
// Number of the first of a kind, by its word.
int32_t brunt_boundary_first(const brunt_world_def *def, const char *word);
// All of them in their order: from {.w = -1} on, false: no more.
typedef struct brunt_boundary_entry {
    const brunt_boundary_kind *kind;
    const void *entry;
    int32_t w;     // its number, from 0
    int32_t k, at; // where the next is looked for: kind, and place in what there is of it
} brunt_boundary_entry;
bool brunt_boundary_entry_next(const brunt_world_def *def, brunt_boundary_entry *e);
// Whether a body of material points is a fluid.
bool brunt_boundary_has_fluid(const brunt_world_def *def);
// The name of its columns in the history: its own, or one by its kind and number.
void brunt_boundary_name(const brunt_boundary_entry *e, char out[BRUNT_NAME_LENGTH]);

// In the file of a kind: the functions that its entries are found by.
#define BRUNT_BOUNDARY_ENTRIES(kind, type)                                                                             \
    static int32_t count(const brunt_boundary_kind *row, const brunt_world_def *def) {                                 \
        (void)row;                                                                                                     \
        return def->kind##_count;                                                                                      \
    }                                                                                                                  \
    static const void *next(const brunt_boundary_kind *row, const brunt_world_def *def, int32_t *at) {                 \
        (void)row;                                                                                                     \
        return *at < def->kind##_count ? &def->kind##s[(*at)++] : NULL;                                                \
    }                                                                                                                  \
    static const char *name(const void *one) { return ((const type##_def *)one)->name; }
// ... and the part of its row that every kind has.
#define BRUNT_BOUNDARY_ROW(key)                                                                                        \
    .word = key, .count = count, .next = next, .name = name, .free = free_all, .check = check, .make = make

// A kind that lists its keys is a file: its row begins with this, which gives all but what it does, hold_at. Material
// points are held by that in explicit steps and in implicit ones, at the nodes of their grid.
int32_t brunt_listed_count(const brunt_boundary_kind *kind, const brunt_world_def *def);
const void *brunt_listed_next(const brunt_boundary_kind *kind, const brunt_world_def *def, int32_t *at);
const char *brunt_listed_name(const void *one);
const char *brunt_listed_body(const void *one);
void brunt_listed_free(brunt_world_def *def);
int brunt_listed_check(const brunt_world_def *def, const void *one, int32_t w, brunt_error *error);
// Every entry is of a kind that there is.
int brunt_listed_kinds_check(const brunt_world_def *def, brunt_error *error);
int brunt_listed_make(const brunt_boundary_making *m, const void *one, int w, brunt_error *error);
void brunt_listed_hold_grid(const brunt_held_grid *g, brunt_boundary *boundary, double time);
#define BRUNT_LISTED_ROW(key, text, list)                                                                              \
    .word = key, .doc = text, .keys = list, .key_count = sizeof(list) / sizeof *(list), .count = brunt_listed_count,   \
    .next = brunt_listed_next, .name = brunt_listed_name, .body = brunt_listed_body, .free = brunt_listed_free,        \
    .check = brunt_listed_check, .make = brunt_listed_make, .hold_grid = brunt_listed_hold_grid
