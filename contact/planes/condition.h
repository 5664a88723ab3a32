// What the conditions of planes do: a row each, in condition.c. Everything that treats planes asks here.
#pragma once

#include "contact/planes/boundary.h"

typedef struct brunt_condition_row {
    bool pushes; // keeps bodies in front of the plane and lets them go, with friction; else it holds nodes at the plane
    bool sticks; // of those that hold: all components, else the one across the plane alone
    bool symmetry; // on a line of the grid it is computed as a symmetry plane of the grid's nodes
    bool images;   // stands for the image of the bodies: it must be a symmetry plane, does not move, and nothing lies
                   // behind it
    const char *of_fluids; // what fluids suffer by one that is not computed as a symmetry plane; NULL: nothing
} brunt_condition_row;

extern const brunt_condition_row brunt_conditions[]; // by brunt_condition
extern const int brunt_condition_count;

// Of a boundary: whether it is a plane that pushes, one that holds.
static inline bool brunt_boundary_pushes(const brunt_boundary *boundary) {
    return boundary->kind->is_plane && brunt_conditions[boundary->plane.condition].pushes;
}
static inline bool brunt_boundary_holds(const brunt_boundary *boundary) {
    return boundary->kind->is_plane && !brunt_conditions[boundary->plane.condition].pushes;
}
// The components (bits) of a node that a plane which holds it takes: of an oblique one that slips, none.
unsigned brunt_condition_components(const brunt_plane_def *plane, int dim);
