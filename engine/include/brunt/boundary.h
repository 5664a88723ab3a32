// What acts on bodies from outside: planes, regions of the grid, groups of mesh nodes, gas, detonations. The names of
// planes, regions and groups differ.
#pragma once

#include <stdbool.h>
#include "brunt/boundary_group.h"
#include "brunt/boundary_line.h"
#include "brunt/boundary_plane.h"
#include "brunt/boundary_region.h"

#ifdef __cplusplus
extern "C" {
#endif

// Kinds of boundaries: of what name their entries and of what type their definition is, their key in scenes, and what
// an entry is called. A definition of a world has an array of each.
#define BRUNT_BOUNDARY_KINDS(X)                                                                                        \
    X(PLANE, plane, brunt_plane, "plane", "a plane")                                                                   \
    X(REGION, region, brunt_region, "region", "a region")                                                              \
    X(GROUP, group, brunt_group, "group", "a group of nodes")                                                          \
    X(LINE, surface, brunt_boundary_surface, "line", "a line or mesh")

enum { BRUNT_BOUNDARY_NUMBERS = 16 };
// A boundary of a kind whose keys a row in engine/boundary/KIND.c lists: numbers and vectors, in which places of
// `number`, words there by their place in their list, a shape and a table where the kind has one.
typedef struct brunt_boundary_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "rotor1", ...
    char kind[BRUNT_NAME_LENGTH]; // "rotor"
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all
    double number[BRUNT_BOUNDARY_NUMBERS];
    brunt_shape shape; // owned by the definition
    brunt_curve table; // [-] a factor over time [s], on what the kind says; default 1 always; owned by the definition
} brunt_boundary_def;

// Where and when explosives are lit: at a point, or on a plane. Material at distance d burns from time + d / detonation
// speed on.
typedef struct brunt_detonation_def {
    double point[3], normal[3];   // [m]; [-] of a plane, 0: a point
    double time;                  // [s] any, when it is lit; there is no default but that of zeroed memory, 0
    char body[BRUNT_NAME_LENGTH]; // "" = all explosives
} brunt_detonation_def;

#ifdef __cplusplus
}
#endif
