// Entries of contact points by the degree-of-freedom node they move. Private to the solution.
#pragma once

#include "contact/constraint/constraint.h"

// Makes set->column: entries by node, in the order of the points, each with that of its friction point beside it; and
// room for the impulses in set->applied, with the facets they turn. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_constraints_make_columns(brunt_constraint_set *set, int threads, brunt_timer *timer, brunt_error *error);
