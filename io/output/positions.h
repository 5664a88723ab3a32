// Where the values of a field stand: particles, nodes, or the centres of elements.
#pragma once

#include "brunt.h"

// The places [m] of a body's particles, nodes or elements as they are now, 3 numbers each, in new memory (brunt_free).
int brunt_positions_read(brunt_world *world, int32_t body, brunt_location at, double **positions, brunt_error *error);
// Index of a body, BRUNT_NONE when there is none of that name.
int32_t brunt_find_body(const brunt_world *world, const char *name);
// Where positions and velocities of a body are: its particles or its nodes.
brunt_location brunt_location_of_motion(const brunt_world *world, int32_t body);
// The field with the numbers, ascending, of a body's particles or elements as they were at the start: of what erodes
// some are missing. -1 at nodes, which keep theirs.
int32_t brunt_location_ids(const brunt_world *world, int32_t body, brunt_location at);
