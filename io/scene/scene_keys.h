// The tables of keys, one a kind of file. Private to their readers: parser, checker, reference, resolved scene and
// schema are made from them.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "brunt.h"
#include "materials/material.h"

typedef enum scene_type {
    SCENE_GROUP,    // a map of the rows below its path
    SCENE_NAMED,    // a map from names of the user's own to groups; their rows are at "path.*"
    SCENE_ENTRIES,  // a list of groups; their rows are at "path[]"
    SCENE_REAL,     // number with unit
    SCENE_ANY_UNIT, // number with any unit, taken to SI base units
    SCENE_INTEGER,
    SCENE_VECTOR,     // as many numbers as there are dimensions
    SCENE_PARTIAL,    // a vector whose components may be `free`
    SCENE_TURN,       // a number or, in three dimensions, a vector
    SCENE_POLYGON,    // list of [x, y]
    SCENE_TABLE,      // list of [time, factor], ascending
    SCENE_PROFILE,    // list of [coordinate, number with any unit], not descending
    SCENE_CURVE,      // list of [time, number with any unit], ascending
    SCENE_AXES,       // list of x, y, z, or the word `all`
    SCENE_TEXT,       // free text
    SCENE_NAME,       // a name of the user's own, or of a field
    SCENE_NAMES,      // list of names
    SCENE_WORD,       // one of `words`
    SCENE_SHAPE,      // a shape: the rows at "<shape>"
    SCENE_SHAPES,     // a list of shapes
    SCENE_PARAMETERS, // stands for the parameters of the chosen model
    SCENE_REALS,      // list of numbers with unit
    SCENE_ANY         // anything: whoever reads it checks it
} scene_type;

// How a key's value is stored in the one field that it fills.
typedef enum scene_store {
    STORE_NOT, // whoever reads it does more than to store it
    STORE_REAL,
    STORE_INTEGER,
    STORE_CHOICE, // an enumeration in the order of `words`
    STORE_FLAG,   // false: the first word
    STORE_VECTOR
} scene_store;

typedef struct scene_field {
    scene_store store;
    size_t offset;
} scene_field;

// The field `member` of a structure; the way it is stored comes of its type, any other does not compile.
#define SCENE_FIELD(type, member)                                                                                        \
    {                                                                                                                    \
        _Generic(((type *)0)->member,                                                                                  \
            double: STORE_REAL,                                                                                        \
            int32_t: STORE_INTEGER,                                                                                    \
            uint32_t: STORE_CHOICE,                                                                                    \
            bool: STORE_FLAG,                                                                                          \
            double *: STORE_VECTOR),                                                                                   \
            offsetof(type, member) \
    }

typedef struct scene_key {
    const char *path; // "time.end", "bodies.*.velocity", "boundaries[].plane.point", "<shape>.box.min"
    scene_type type;
    const char *unit;    // NULL: none
    const char *initial; // default as typed; NULL: must be given; "": may be left out
    double min, max;     // range of a number ...
    bool min_open, max_open;
    const char *words; // "a|b|c": of SCENE_WORD; of a number: a word that stands for infinity
    int dimension;     // 2 or 3: exists in that one only; 0: in both
    bool depends;      // its default holds only where other keys let it
    const char *doc;
    // Columns that most rows leave out:
    const char *former;       // spelling of the key one version ago ...
    const char *former_words; // ... and of its words, "a|b|c", as many as `words`
    unsigned only; // the kinds that it is for (SCENE_MPM ..., SCENE_AT_PLANE ...), which also its default waits for;
                   // 0: all
    scene_field field; // that it fills
} scene_key;

extern const scene_key *const brunt_scene_table; // of all keys, made in scene_table.c
extern const int *const brunt_scene_table_rows;
#define brunt_scene_table_count (*brunt_scene_table_rows)

#define SCENE_NUMBER(NAME, kind, type, word, what) SCENE_NUMBER_##NAME,
enum { BRUNT_BOUNDARY_KINDS(SCENE_NUMBER) SCENE_KINDS_AT };
#undef SCENE_NUMBER
// Kinds of entries: bodies by their method, boundaries by what they act at (SCENE_AT_PLANE ...).
enum {
    SCENE_MPM = 1 << BRUNT_MPM,
    SCENE_FEM = 1 << BRUNT_FEM,
    SCENE_MEMBRANE = 1 << BRUNT_MEMBRANE,
    SCENE_MESHES = SCENE_FEM | SCENE_MEMBRANE,
#define SCENE_AT(NAME, kind, type, word, what) SCENE_AT_##NAME = SCENE_MEMBRANE << (SCENE_NUMBER_##NAME + 1),
    BRUNT_BOUNDARY_KINDS(SCENE_AT)
#undef SCENE_AT
        SCENE_AT_LISTED = SCENE_MEMBRANE << (SCENE_KINDS_AT + 1), // of kinds that list their keys
};

// A kind of file: what it is called, how it begins, and its rows.
typedef struct scene_format {
    const char *name, *first; // "scene", "brunt: 1"
    const scene_key *rows;
    const int *row_count;
} scene_format;

extern const scene_format brunt_scene_format, brunt_study_format;

// A section of the reference: a heading above the rows that start with one of its prefixes.
typedef struct scene_section {
    const char *name, *prefix, *doc;
} scene_section;

extern const scene_section brunt_scene_sections[];
extern const int brunt_scene_section_count;

// The row at a path, NULL when there is none.
const scene_key *brunt_format_row(const scene_format *format, const char *path);
const scene_key *brunt_scene_row(const char *path); // of scenes
// The last part of a row's path when the row is a child of `parent`, else NULL.
const char *brunt_scene_child_key(const scene_key *row, const char *parent);
// Whether a map may stand for the word, whose one key is such a word with a value of its own.
bool brunt_scene_word_or_map(const scene_key *row);
// The models behind a SCENE_PARAMETERS row or a "model" row.
const brunt_model *const *brunt_scene_models(const char *path, int *count);
// The one of them by name, other accepted spellings included; NULL: none.
const brunt_model *brunt_scene_model(const char *path, const char *name);
// True when the word is among "a|b|c", with - and _ counting as the same; `index` its place there, `length` its length.
bool brunt_scene_word(const char *words, const char *word, int *index);
// How many words "a|b|c" has; 0 of NULL.
int brunt_scene_word_count(const char *words);
// Copies word number `index` of "a|b|c"; false past the end.
bool brunt_scene_word_at(const char *words, int index, char *out, size_t size);
