// Filling a shape with particles on a lattice.
#pragma once

#include "brunt.h"

typedef struct brunt_filled {
    int32_t count;
    double *position[3]; // [m] placed; as many arrays as there are dimensions, the rest NULL
    double volume;       // [m^3] of every particle (2D: [m^2])
    // [m] how far the shape's own surface is from the particle, at most half the lattice cell's diagonal: contact uses
    // it to know where the surface really is. Inside differences and intersections a lower bound.
    double *reach;
} brunt_filled;

// Lattice of `spacing` in the unplaced frame: centred in the shape's bounding box, which for a box of whole spacings
// puts the first centre half a spacing from its minimum. A site is kept when its centre is inside, or on the surface
// within rounding; jittered by the body's fill, never out of the shape; then placed. Ordered by lattice index, x
// slowest, z (2D: y) fastest. BRUNT_BAD_INPUT when the shape is unbounded, catches no site, or holds more than 2^31 - 1
// of them; BRUNT_FAILED when there is no memory. On an error `out` owns nothing.
int brunt_fill_shape(const brunt_body_def *body, int dimension, double spacing, brunt_filled *out, brunt_error *error);
void brunt_filled_free(brunt_filled *filled);
