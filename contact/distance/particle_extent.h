// Where a body of material points really ends, as its particles extend.
#pragma once

#include "mpm/mpm_body.h"

// Gradient of the body's volume fraction at a node [1/m], which points into the body, and the centre of the volume that
// the node feels, relative to the node [m].
void brunt_extent_gradient(brunt_body *body, int32_t slot, int node, double gradient[3], double centre[3]);
// The particles near a node, as ellipsoids of material: gathered once, since contact asks for many directions.
typedef struct brunt_extent_cloud {
    double
        *data; // rows of `stride` numbers: place relative to the node, deformation gradient, reach, and one to work in
    size_t stride, bytes;
    int count;
} brunt_extent_cloud;
// Refills a cloud, empty at first ({0}). BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_extent_gather(brunt_body *body, int32_t slot, int node, brunt_extent_cloud *cloud, brunt_error *error);
// Empties a cloud, and makes room in it for points without extent, `count` at most. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_extent_cloud_points(brunt_extent_cloud *cloud, int count, brunt_error *error);
void brunt_extent_cloud_point(brunt_extent_cloud *cloud, const double x[3]);
void brunt_extent_cloud_free(brunt_extent_cloud *cloud);
// Greatest distance along unit vector n, from the node, that one of them reaches [m], and the point that does, relative
// to the node; -INFINITY when there is none. `share` of their reach counts: 1, or 0 for their centres alone.
double brunt_extent_of(const brunt_extent_cloud *cloud, double share, const double n[3], double farthest[3]);

// Where a node of a total-Lagrangian body is now, as its particles see it: mean of x_p + F (X_i - X_p) [m]; `x` its
// undeformed place, replaced when it has any particles.
void brunt_extent_deformed(brunt_body *body, int32_t slot, int node, double x[3]);

// The particles of the bins whose kernel covers a node, slot by slot. `base`: the node's number among the bin's nodes.
typedef void brunt_extent_visit_fn(void *context, brunt_body *body, int64_t slot, const int base[3]);
void brunt_extent_visit(brunt_body *body, int32_t slot, int node, brunt_extent_visit_fn *visit, void *context);
// How far the particle in a slot reaches from its centre along unit vector n [m].
double brunt_extent_along(brunt_body *body, int64_t slot, const double n[3]);
// Where what the particle in a slot has around it meets something `distance` [m] away against unit vector n, once they
// touch: from its centre, and the same where its kernel lives. Friction acts there.
void brunt_extent_arm(brunt_body *body, int64_t slot, const double n[3], double distance, double arm[3],
                      double kernel_arm[3]);
