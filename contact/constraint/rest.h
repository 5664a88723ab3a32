// Constraints that rest. Private to the solution.
#pragma once

#include <math.h>

#include "contact/constraint/constraint.h"

// Room for what constraints and nodes do; none rests yet. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_rest_begin(brunt_constraint_set *set, brunt_error *error);
// Whether a sweep leaves out constraint k, which is in no block.
bool brunt_constraint_rests(const brunt_constraint_set *set, int64_t k);
// Constraint k, which falls asleep, gives shared nodes nothing from now on.
void brunt_constraint_gives_nothing(const brunt_constraint_set *set, int64_t k);
// Notes that a sweep has changed node s by `by` [m/s], which what rests beside it has not seen.
static inline void brunt_node_stirs(const brunt_constraint_set *set, int64_t s, double by) {
    const double drift = set->drift[s] + by;
    set->stirred[s] = drift > set->still;
    set->drift[s] = drift > set->still ? 0 : drift;
}
