// Gas in the volume that a set's faces enclose.
#pragma once

#include "boundary/node_sets.h"

// Volume that the faces enclose, with that beside it [m^3].
double brunt_gas_volume(const brunt_node_set *set);
// Energy of the gas at the start. BRUNT_BAD_INPUT when the faces enclose nothing.
int brunt_gas_start(brunt_node_set *set, brunt_error *error);
// Pressure [Pa] above that outside for the step from `time` on, over `dt`, by the volume as it is now; 0 when that is
// no longer positive.
double brunt_gas_push(brunt_node_set *set, double time, double dt);
// What is there now.
brunt_gas brunt_gas_now(const brunt_node_set *set);
// The set of gas `index`, NULL: there are not so many.
const brunt_node_set *brunt_gas_number(const brunt_node_sets *sets, int32_t index);
int32_t brunt_gas_sets(const brunt_node_sets *sets);
int64_t brunt_gas_state_count(const brunt_node_sets *sets);
void brunt_gas_state_get(const brunt_node_sets *sets, double *out);
void brunt_gas_state_set(brunt_node_sets *sets, const double *in);
