// Which surfaces are near to each other, and which of their points: boxes of bodies, then boxes of runs of points.
#pragma once

#include "contact/contact.h"

// Two bodies with a pair whose boxes come close: numbers in the surface, a's index among all bodies below b's.
typedef struct brunt_augury_neighbours {
    int32_t pair, a, b;
} brunt_augury_neighbours;

typedef struct brunt_augury_box {
    double low[3], high[3]; // [m]
} brunt_augury_box;

typedef struct brunt_augury_near {
    brunt_augury_neighbours *found; // by pair
    int32_t count;
    int32_t *order; // bodies by low end along the sweep's axis
    int32_t order_count;
    // Boxes of runs of 32 points: numbering of a body runs along a curve, so that a run is a patch.
    brunt_augury_box *node_run, *face_run;
    size_t found_capacity, order_capacity, node_run_capacity, face_run_capacity;
} brunt_augury_near;

// Index among all bodies of the surface's body k, which has nodes.
static inline int brunt_augury_body(const brunt_contact_surface *surface, int k) {
    return surface->body[surface->node_range[k]];
}

// Active bodies with a pair of method augury that come closer than `margin` [m] by their boxes. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_augury_near_find(brunt_augury_near *near, const brunt_contact_context *m, double margin, brunt_error *error);
// Boxes of runs, once a step, before the next.
int brunt_augury_near_runs(brunt_augury_near *near, const brunt_contact_surface *surface, int threads,
                           brunt_timer *timer, brunt_error *error);

// Called with each point of a body's surface inside a box; returns 0 to go on.
typedef int brunt_augury_visit_fn(void *context, int32_t item, const double x[3]);
// Nodes (faces: their centres) of the surface's body k in the box, in order. What `visit` returned.
int brunt_augury_near_visit(const brunt_augury_near *near, const brunt_contact_surface *surface, int k, bool faces,
                            const brunt_augury_box *box, brunt_augury_visit_fn *visit, void *context);

void brunt_augury_near_free(brunt_augury_near *near);
