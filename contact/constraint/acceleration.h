// Accelerated sweeps. Private to the solution.
#pragma once

#include "contact/constraint/constraint.h"

// Room for what constraints and nodes had, from where they are. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_acceleration_begin(brunt_constraint_set *set, brunt_error *error);
// With how much of its correction the next sweep begins: none where the last one went back. The weight that follows.
double brunt_acceleration_next(brunt_constraint_set *set, int64_t chunks, double weight);
