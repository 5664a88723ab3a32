// What the files that make a world of its definition share. Private to them.
#pragma once

#include "world/definitions.h"
#include "world/world.h"

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

// Why bodies of material points overlap that do not in implicit steps.
#define BRUNT_POINTS_REACH                                                                                             \
    " (in explicit steps material points meet others half their spacing out from their centres, in implicit ones at "  \
    "the centres)"

// The body of a name among those in order of name, BRUNT_NONE: there is none.
int brunt_find_ordered(const brunt_body_def **order, int count, const char *name);
int brunt_pairs_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order, brunt_error *error);
// All but the nodes of groups, before the bodies.
int brunt_boundaries_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                          brunt_error *error);
int brunt_bodies_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order, brunt_error *error);
int brunt_make_elements(brunt_world *world, const brunt_world_def *def, const brunt_body_def *from, int index,
                        brunt_error *error);
// Velocity at x at the start, and its gradient.
void brunt_start_motion(const brunt_body_def *def, int dim, const double x[3], double v[3], double gradient[3][3]);
