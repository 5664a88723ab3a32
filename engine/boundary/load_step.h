// The stable step of gas and of pressure that follows a surface.
#pragma once

#include "boundary/node_sets.h"

// After the sets are made.
int brunt_load_step_make(brunt_node_sets *sets, brunt_error *error);
void brunt_load_step_free(brunt_node_sets *sets);
// Bound of the squared frequency that they add to that of mesh `fem` [1/s^2], as everything is now; 0 without them.
double brunt_load_frequency(const brunt_node_sets *sets, const brunt_bodies *bodies, int index, double time);
