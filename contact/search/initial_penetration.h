// How deep nodes and edges lie in other bodies since they met: as overlap at the start left them, or as they came in
// from beside. They are pushed out no further than that, since the load would pay for nothing of it; it ends where they
// part by themselves. Kept while something overlaps since the start. Private to the search.
#pragma once

#include "contact/surface/contact_surface.h"

typedef struct initial_penetration {
    double *allowed; // [m] of each node, INFINITY: it meets nothing; NULL: nothing has overlapped since the start
    double *deepest; // [m] of each node in this step, -1: it meets nothing
    bool begun;
    size_t allowed_capacity, deepest_capacity;
} initial_penetration;

// Before the first search. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_initial_penetration_begin(initial_penetration *penetration, int32_t nodes, brunt_error *error);
// Notes that some nodes, `count`, meet something at a gap [m]; and the gap beyond what the deepest of them may lie in
// it. Where nothing has overlapped since the start, which is asked of all that touch: that gap.
double brunt_initial_penetration_note(initial_penetration *penetration, const int32_t *node, int count, double gap);
static inline double brunt_initial_penetration_meet(initial_penetration *penetration, const int32_t *node, int count,
                                                    double gap) {
    return penetration->allowed ? brunt_initial_penetration_note(penetration, node, count, gap) : gap;
}
// At the end of a step, of a surface of mean edge [m]: what has come out stays out. Frees all when nothing overlaps.
void brunt_initial_penetration_end(initial_penetration *penetration, const brunt_contact_surface *surface);
// After the surface was renewed. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_initial_penetration_renew(initial_penetration *penetration, const brunt_contact_surface *surface,
                                    brunt_error *error);
// Aborts where a depth is none.
void brunt_initial_penetration_validate(const initial_penetration *penetration, int32_t nodes);
void brunt_initial_penetration_free(initial_penetration *penetration);
