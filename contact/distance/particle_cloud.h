// The particles of a body near a node of its grid, as ellipsoids of material: gathered once, since contact asks for
// many directions.
#pragma once

#include "contact/distance/particle_extent.h"

typedef struct brunt_cloud {
    double *data;         // rows of `stride` numbers, see particle_cloud.c
    size_t stride, bytes; // [-], [bytes]
    int count;
} brunt_cloud;

// Refills a cloud, empty at first ({0}). BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_cloud_gather(brunt_body *body, int32_t slot, int node, brunt_cloud *cloud, brunt_error *error);
// Empties a cloud, and makes room in it for points without extent, `count` at most. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_cloud_points(brunt_cloud *cloud, int count, brunt_error *error);
void brunt_cloud_point(brunt_cloud *cloud, const double x[3]);
void brunt_cloud_free(brunt_cloud *cloud);

// Gradient of the body's volume fraction at the node [1/m], which points into the body, and the centre of the volume
// that the node feels, relative to the node [m]; of a cloud that was gathered from `grid`.
void brunt_cloud_gradient(const brunt_cloud *cloud, const brunt_grid *grid, double gradient[3], double centre[3]);
// Greatest distance along unit vector n, from the node, that one of them reaches [m], and which does first; -INFINITY
// when there is none. `reach`: as far as each reaches; else their centres alone.
double brunt_cloud_extent(const brunt_cloud *cloud, bool reach, const double n[3], int *which);
// Where particle i of the cloud ends along unit vector n, relative to the node [m].
void brunt_cloud_end(const brunt_cloud *cloud, int i, bool reach, const double n[3], double end[3]);
// Radius of a ball that rolls about inside each of the ellipsoids, or of the `count` in `some` [m].
double brunt_cloud_ball(const brunt_cloud *cloud);
double brunt_cloud_ball_of(const brunt_cloud *cloud, const int *some, int count);
