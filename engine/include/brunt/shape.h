// Shapes: what bodies are filled with, regions are made of and meshes are made from. Their own coordinates are those of
// the scene before the placement.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum brunt_shape_kind {
    BRUNT_BOX,        // min, max
    BRUNT_SPHERE,     // center, radius (a disk in two dimensions)
    BRUNT_CYLINDER,   // center of one end, axis, radius, length
    BRUNT_TUBE,       // like cylinder with inner_radius; in two dimensions an annulus (center, inner_radius, radius)
    BRUNT_PRISM,      // polygon (counter-clockwise or clockwise, in the x-y plane) between min[2] and max[2]; 2D: the
                      // polygon
    BRUNT_HALF_SPACE, // center: a point of the plane; axis: normal pointing out of the material
    BRUNT_UNION,
    BRUNT_DIFFERENCE,
    BRUNT_INTERSECTION // of the children; difference: the first less all others
} brunt_shape_kind;

typedef struct brunt_shape {
    brunt_shape_kind kind;               // which of the numbers below it reads
    double min[3], max[3];               // [m] max > min; two dimensions: the first two
    double center[3], axis[3];           // [m], [-] (any length but 0)
    double radius, inner_radius, length; // [m] > 0, inner_radius < radius
    double (*points)[2];                 // [m] corners of the polygon, at least 3; owned (brunt_def_alloc)
    int32_t point_count;                 // of the polygon
    struct brunt_shape *children;        // at least 1 of unions, differences and intersections; at most 64 deep; owned
    int32_t child_count;                 // at least 1
} brunt_shape;

// A rigid motion x -> rotation x + translation. Filled with the identity by brunt_placement_identity.
typedef struct brunt_placement {
    double rotation[9];    // [-] row major, orthogonal to 1e-6
    double translation[3]; // [m]
} brunt_placement;

brunt_placement brunt_placement_identity(void);
// Follow `first` by a shift [m], or by a turn of `angle` [rad] about the line through `about` along `axis`;
// an axis without direction gives NANs, which brunt_world_create refuses.
brunt_placement brunt_placement_translate(brunt_placement first, const double by[3]);
brunt_placement brunt_placement_rotate(brunt_placement first, const double axis[3], double angle,
                                       const double about[3]);

// Signed distance [m] of a point to the shape's surface, negative inside. Exact for primitives and outside corners of
// unions; a lower bound of its size inside differences and intersections.
double brunt_shape_distance(const brunt_shape *shape, int dimension, const double point[3]);
// Axis-aligned bounds [m]; false when the shape is unbounded (a half-space not cut by anything) or empty.
bool brunt_shape_bounds(const brunt_shape *shape, int dimension, double min[3], double max[3]);
void brunt_shape_free(brunt_shape *shape); // frees what the shape owns, not the shape itself

#ifdef __cplusplus
}
#endif
