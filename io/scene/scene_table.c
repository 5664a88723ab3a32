// The table of all keys of a scene: the rows of scene_keys.c, and among them those that kinds of measures and
// boundaries bring in files of their own. It is made before the program begins, and never changes.
#include "io/scene/scene_rows.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/check.h"
#include "boundary/kinds.h"
#include "io/scene/scene.h"
#include "io/scene/units.h"
#include "world/definitions.h"

enum { KEY_LIMIT = 600 };
static scene_key table[KEY_LIMIT];
static int table_count;
const scene_key *const brunt_scene_table = table;
const int *const brunt_scene_table_rows = &table_count;
const scene_format brunt_scene_format = {"scene", "brunt: 1", table, &table_count};

#define DECLARE(NAME, name) extern const scene_rows measure_##name##_keys;
BRUNT_MEASURE_KINDS(DECLARE)
#define ROWS(NAME, name) &measure_##name##_keys,
static const scene_rows *const measures[] = {BRUNT_MEASURE_KINDS(ROWS)};

static void add(const scene_rows *rows) {
    for (int i = 0; i < rows->count; i++) {
        if (table_count == KEY_LIMIT) abort();
        table[table_count++] = rows->row[i];
    }
}

static void add_measures(void) {
    for (size_t k = 0; k < sizeof measures / sizeof *measures; k++) add(measures[k]);
}

// What a key of a boundary has when it is not given, as typed; `room` for a number or a word.
static const char *initial_of(const brunt_boundary_key *key, char room[32]) {
    const double initial = key->in_scene.initial;
    if (isnan(initial)) return REQUIRED;
    switch (key->is) {
    case BRUNT_VALUE_NUMBER:
    case BRUNT_VALUE_VECTOR: brunt_format_number(initial, room); return room;
    case BRUNT_VALUE_WORD: brunt_scene_word_at(key->words, (int)initial, room, 32); return room;
    case BRUNT_VALUE_SHAPE:
    case BRUNT_VALUE_TABLE: break;
    }
    return OPTIONAL;
}

// Of a kind of boundary that lists its keys: its group, and a row for each, which fills a number where it is one.
static void add_boundary(const brunt_boundary_kind *kind) {
    static const struct {
        scene_type type;
        scene_store store;
    } as[] = {[BRUNT_VALUE_NUMBER] = {SCENE_REAL, STORE_REAL},
              [BRUNT_VALUE_VECTOR] = {SCENE_VECTOR, STORE_VECTOR},
              [BRUNT_VALUE_WORD] = {SCENE_WORD, STORE_REAL}, // its place
              [BRUNT_VALUE_SHAPE] = {SCENE_SHAPE, STORE_NOT},
              [BRUNT_VALUE_TABLE] = {SCENE_TABLE, STORE_NOT}};
    static char paths[KEY_LIMIT][64], defaults[KEY_LIMIT][32];
    scene_key row = {.path = paths[table_count], .type = SCENE_GROUP, .initial = OPTIONAL, .doc = kind->doc};
    snprintf(paths[table_count], sizeof *paths, "boundaries[].%s", kind->word);
    row.min = -INFINITY, row.max = INFINITY;
    add(&(scene_rows){&row, 1});
    for (int k = 0; k < kind->key_count; k++) {
        const brunt_boundary_key *key = &kind->keys[k];
        const brunt_parameter *in = &key->in_scene;
        snprintf(paths[table_count], sizeof *paths, "boundaries[].%s.%s", kind->word, in->key);
        row = (scene_key){
            .path = paths[table_count],
            .type = as[key->is].type,
            .unit = in->unit,
            .initial = initial_of(key, defaults[table_count]),
            .min = in->min,
            .max = in->max,
            .min_open = in->min_open,
            .max_open = in->max_open,
            .words = key->words,
            .dimension = key->dimension,
            .doc = in->doc,
            .field = {as[key->is].store, offsetof(brunt_boundary_def, number) + (size_t)key->at * sizeof(double)}};
        add(&(scene_rows){&row, 1});
    }
}

// Of a number of a body that says its key itself.
static void add_body_number(const brunt_body_number *number) {
    static char paths[KEY_LIMIT][64];
    const bool positive = number->rule & BRUNT_POSITIVE, limited = number->rule & (BRUNT_POSITIVE | BRUNT_NOT_NEGATIVE);
    snprintf(paths[table_count], sizeof *paths, "bodies.*%s", number->key);
    const scene_key row = {.path = paths[table_count],
                           .type = number->count == 3 ? SCENE_VECTOR : SCENE_REAL,
                           .unit = number->unit,
                           .initial = number->initial,
                           .min = limited ? 0 : -INFINITY,
                           .max = INFINITY,
                           .min_open = positive || !limited,
                           .max_open = true,
                           .doc = number->doc,
                           .only = number->methods, // SCENE_MPM, ... are these bits
                           .field = {number->count == 3 ? STORE_VECTOR : STORE_REAL, number->offset}};
    add(&(scene_rows){&row, 1});
}

static void add_body_numbers(void) {
    for (int k = 0; k < brunt_body_number_count; k++)
        if (brunt_body_numbers[k].doc) add_body_number(&brunt_body_numbers[k]);
}

static void add_boundaries(void) {
    for (int k = 0; k < brunt_boundary_kind_count; k++)
        if (brunt_boundary_kinds[k]->keys) add_boundary(brunt_boundary_kinds[k]);
}

__attribute__((constructor)) static void make_table(void) {
    const scene_rows *own = &brunt_scene_own_rows;
    for (int i = 0; i < own->count; i++) {
        if (strcmp(own->row[i].path, "measures.*.<kind>") == 0)
            add_measures();
        else if (strcmp(own->row[i].path, "bodies.*.<kind>") == 0)
            add_body_numbers();
        else if (strcmp(own->row[i].path, "boundaries[].<kind>") == 0)
            add_boundaries();
        else
            add(&(scene_rows){&own->row[i], 1});
    }
}
