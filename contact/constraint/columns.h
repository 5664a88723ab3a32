// Entries of contact points by the degree-of-freedom node they move. Private to the solution.
#pragma once

#include "contact/constraint/constraint.h"

// Makes set->column: entries by node that is shared, in the order of the points, each with that of its friction point
// behind it; and room for what they give. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_constraints_make_columns(brunt_constraint_set *set, int threads, brunt_timer *timer, brunt_error *error);
