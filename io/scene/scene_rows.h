// What rows of keys are written with, and where a file puts those of its own.
#pragma once

#include <math.h>

#include "io/scene/scene_keys.h"

#define ANY -INFINITY, INFINITY, true, true
#define POSITIVE 0, INFINITY, true, true
#define NOT_NEGATIVE 0, INFINITY, false, true
#define NONE ANY, NULL, 0, false
#define OPTIONAL ""
#define REQUIRED NULL

// Rows leave out the columns that most have no use for.
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

typedef struct scene_rows {
    const scene_key *row;
    int count;
} scene_rows;

// The rows of one kind, in its own file: of measure `extent` they are measure_extent_keys.
#define SCENE_ROWS(name, ...)                                                                                          \
    const scene_rows name = {(const scene_key[]){__VA_ARGS__},                                                         \
                             sizeof((const scene_key[]){__VA_ARGS__}) / sizeof(scene_key)}
// Where those of all kinds stand among the others; its path is no key's.
#define SCENE_OF_KINDS(path)                                                                                           \
    { path ".<kind>" }

// Rows that every measure of one body has: the kind's group and whose it is.
#define MEASURE_OF_BODY(kind, doc)                                                                                     \
    {"measures.*." kind, SCENE_GROUP, NULL, OPTIONAL, NONE, doc}, {                                                    \
        "measures.*." kind ".body", SCENE_NAME, NULL, REQUIRED, NONE, "the body"                                       \
    }

extern const scene_rows brunt_scene_own_rows; // scene_keys.c
