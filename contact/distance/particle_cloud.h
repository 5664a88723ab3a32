// Particles of a body near a place, as ellipsoids of material, or as points. Contact asks for many directions.
#pragma once

#include "grid/grid.h"

// Rows of numbers of particles: place, B = reach^2 F F^T (xx yy zz yz xz xy), volume.
enum { BRUNT_ROW_X = 0, BRUNT_ROW_B = 3, BRUNT_ROW_VOLUME = 9, BRUNT_ROWS = 10 };
enum {
    BRUNT_SPARE = 16,     // numbers behind a row's last that may be read and written
    BRUNT_CLOUD_RUNS = 17 // and one that ends the last
};

// Particles that lie together where a cloud's come from: from number `from` on in the cloud, `first` there, which is
// where their B stays.
typedef struct brunt_run {
    int32_t first, from;
} brunt_run;

typedef struct brunt_cloud {
    double *data;         // rows of `stride` numbers; places are relative to where the cloud is looked at from
    size_t stride, bytes; // [-], [bytes]
    const double *b;      // the six rows of B, of `b_stride` numbers, by the numbers where the cloud is from
    size_t b_stride;
    int count, runs;
    brunt_run run[BRUNT_CLOUD_RUNS];
    bool flat; // in two dimensions
} brunt_cloud;

// Empties a cloud, {0} at first, and makes it hold `count` particles. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_cloud_reserve(brunt_cloud *cloud, int count, brunt_error *error);
// Adds a point without extent.
void brunt_cloud_point(brunt_cloud *cloud, const double x[3]);
void brunt_cloud_free(brunt_cloud *cloud);

// The number of particle i where the cloud is from, and back; BRUNT_NONE: it is not in the cloud.
int brunt_cloud_source(const brunt_cloud *cloud, int i);
int brunt_cloud_find(const brunt_cloud *cloud, int source);

// Gradient of the body's volume fraction at a node of `grid` [1/m], which points into the body.
void brunt_cloud_gradient(const brunt_cloud *cloud, const brunt_grid *grid, double gradient[3]);
// Greatest distance along unit vector n that one of them reaches [m], and which does first;
// -INFINITY when there is none. `reach`: as far as each reaches; else their centres alone.
double brunt_cloud_extent(const brunt_cloud *cloud, bool reach, const double n[3], int *which);
// Where particle i ends along unit vector n [m].
void brunt_cloud_end(const brunt_cloud *cloud, int i, bool reach, const double n[3], double end[3]);
// Radius of a ball that rolls about inside each of the ellipsoids, or of the `count` in `some` [m].
double brunt_cloud_ball(const brunt_cloud *cloud);
double brunt_cloud_ball_of(const brunt_cloud *cloud, const int *some, int count);
