// Where a place is before a line or surface: the parts of it that are nearest around.
//
// Parts are segments or triangles. The nearest point of a part is within it, on an edge of it or at a corner. Edges and
// corners count once, where all parts that share them have their nearest point there, and are met along the way to
// them: what goes round an edge is pushed as by a tube about it, and two parts that go on into each other are one.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "brunt/boundary_line.h"

enum { BRUNT_TOUCH_LIMIT = 16 };

// A place that is nearest to what is around it.
typedef struct brunt_touch {
    double normal[3], at[3]; // [-] out of the surface, of length 1; [m] the nearest point
    double distance;         // [m] along the normal, negative behind the surface
    bool rim;                // where the surface ends
} brunt_touch;

// The parts, with a tree of boxes around halves of them.
typedef struct brunt_facets {
    int dim;
    double (*point)[3];   // [m]
    int32_t (*corner)[3]; // of each part; in two dimensions the last is -1
    double (*normal)[3];
    int32_t point_count, count;
    struct brunt_facets_box {
        double low[3], high[3];
        int32_t first, end, other; // parts in it; the second of its halves, the first is behind it; 0: it has none
    } * box;
    int32_t box_count;
    double low[3], high[3]; // of all
} brunt_facets;

// BRUNT_OK, or BRUNT_FAILED: out of memory, or one that has no extent.
int brunt_facets_make(brunt_facets *facets, const brunt_boundary_surface_def *def, int dim, brunt_error *error);
void brunt_facets_free(brunt_facets *facets);
size_t brunt_facets_bytes(const brunt_facets *facets);
// Aborts where boxes do not hold their parts.
void brunt_facets_validate(const brunt_facets *facets);
// Whether no part is as near to x as `range` [m].
bool brunt_facets_are_far(const brunt_facets *facets, const double x[3], double range);
// The places around x that are not farther than `range` [m], in no more than BRUNT_TOUCH_LIMIT entries. How many.
int brunt_facets_near(const brunt_facets *facets, const double x[3], double range, brunt_touch *out);
