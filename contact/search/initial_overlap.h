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

// The first overlap of a mesh or membrane with another body that it has a pair with, or of any body with a plane of
// condition separate, if there is `any`. Call with the surface of all bodies taken. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_overlap_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, int boundary_count,
                       brunt_overlap *found, brunt_error *error);
