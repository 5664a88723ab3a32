// Which boundaries act on a body, so that none of thousands looks at those of the others.
#pragma once

#include "contact/planes/boundary.h"

struct brunt_boundary_lists {
    int32_t *first; // of each body: list[first[i]] .. list[first[i + 1]] act on it alone, ascending; behind those of
                    // the last one they act on all
    int32_t *list;
    int bodies;
};

// After each boundary has its body. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_boundary_lists_make(brunt_boundary_lists *lists, const brunt_boundary *boundary, int count, int bodies,
                              brunt_error *error);
void brunt_boundary_lists_free(brunt_boundary_lists *lists);
// Aborts where they are not those of the boundaries.
void brunt_boundary_lists_validate(const brunt_boundary_lists *lists, const brunt_boundary *boundary, int count);

// Boundaries that act on a body, ascending:
// for (brunt_boundary_walk walk = brunt_boundaries_of(lists, body); (w = brunt_boundary_next(&walk)) != BRUNT_NONE;)
typedef struct brunt_boundary_walk {
    const int32_t *own, *own_end, *common, *common_end;
} brunt_boundary_walk;
brunt_boundary_walk brunt_boundaries_of(const brunt_boundary_lists *lists, int body); // `lists` NULL: there are none
int brunt_boundary_next(brunt_boundary_walk *walk);                                   // BRUNT_NONE: no more
