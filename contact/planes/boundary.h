// What acts from outside: a plane, a region, or a group of nodes of meshes, and what it has done.
#pragma once

#include "brunt.h"
#include "contact/constraint/impulse_account.h"

typedef struct brunt_boundary {
    char name[BRUNT_NAME_LENGTH];
    bool region;                         // else a plane; a group counts as a region without grid nodes
    const struct brunt_group_def *group; // of finite-element bodies, NULL for the others
    brunt_plane_def plane;               // normal of unit length
    brunt_region_def where;              // of a region; shares the world's definition
    int body;                            // the one it acts on, -1: all
    int mirror;                          // index of the mirror plane it has become, -1
    brunt_impulse_account action;        // since the start
    brunt_impulse_account last;          // of the last step
} brunt_boundary;
