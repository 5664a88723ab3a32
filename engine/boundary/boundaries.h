// What acts on bodies from outside: planes, regions, named groups of nodes, drag.
#pragma once

#include "boundary/damping.h"
#include "boundary/node_sets.h"

typedef struct brunt_boundaries {
    brunt_wall *walls; // planes, then regions, then groups
    int wall_count;
    brunt_symmetry_plane mirrors[16];
    int mirror_count;
    bool has_walls, has_conditions, has_friction; // planes that push, conditions at grid nodes
    brunt_node_sets sets;
    brunt_damping damping;
    double **load_rate; // of each body with loads that follow its surface: node_count, room for its stable step
} brunt_boundaries;
