// Bodies that lie in each other, or behind a plane that pushes, at the start. Contact ends an approach: it looks a
// quarter of an edge behind a facet, and what is deeper is never met.
#pragma once

#include "contact/contact.h"
#include "contact/planes/boundary.h"

typedef struct brunt_overlap {
    bool any;     // there is one
    int a, b;     // bodies by their index among all; b: -1 where it is a plane
    int boundary; // the plane, -1
    double depth; // [m] at least so much of `a` is in the other, or behind it
    double x[3];  // [m] there
} brunt_overlap;

// What may lie in each other, and how deep.
typedef struct brunt_overlap_rule {
    bool (*meets)(const void *self, int32_t a, int32_t b); // whether two bodies, by their index among all, may not
    const void *self;
    double least; // [-] shares of an edge, or spacing: what is no deeper is no overlap
    bool centres; // material points are their centres: they have no extent
} brunt_overlap_rule;

// The first overlap of a mesh or membrane with another body that it meets, or of any body with one of the first
// `boundary_count` boundaries that is a plane of condition separate, if there is `any`. Call with the bounds and faces
// of the surface of all bodies made. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_overlap_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, int boundary_count,
                       const brunt_overlap_rule *rule, brunt_overlap *found, brunt_error *error);
