// What acts on bodies from outside: planes, regions, named groups of nodes, damping.
#pragma once

#include "boundary/boundary_surface.h"
#include "boundary/damping.h"
#include "boundary/gas.h"
#include "boundary/load_step.h"
#include "boundary/node_sets.h"
#include "contact/planes/boundary_lists.h"
#include "contact/planes/symmetry.h"

typedef struct brunt_boundaries {
    brunt_boundary *boundary; // by kind, in their order
    int boundary_count;
    brunt_boundary_lists acting; // of them, on each body
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES];
    int symmetry_count;
    bool meets_points, has_conditions, has_friction; // planes that push, lines and meshes; conditions at grid nodes
    bool has_detonations;                            // explosives are lit
    brunt_node_sets sets;
    brunt_boundary_surfaces surfaces;
    brunt_damping damping;
} brunt_boundaries;

// Made of a definition in world/boundaries.c, beside the bodies that they name. What lasts of them is saved by
// world/state.c: accounts of walls, tractions of surfaces, gas of groups.
void brunt_boundaries_free(brunt_boundaries *boundaries);
// Aborts where walls, symmetry planes, bodies and groups do not belong to each other, or an account is no number.
void brunt_boundaries_validate(const brunt_boundaries *boundaries, const brunt_bodies *bodies);
