// The surface of a body of material points about a place, as its particles extend: what is near, which way is out, how
// far it reaches.
#pragma once

#include "contact/distance/particle_cloud.h"
#include "mpm/mpm_body.h"

// Particles of a body about a place.
typedef struct brunt_neighbour {
    int32_t block;
    int64_t particle;
    double d[3]; // [m] from the place
} brunt_neighbour;

typedef struct brunt_neighbours {
    brunt_neighbour *near;
    size_t near_capacity;
    int32_t near_count;
    brunt_cloud centres; // of the nearest of them, as brunt_neighbours_centres fills it
} brunt_neighbours;

void brunt_neighbours_free(brunt_neighbours *list);
// Those within `range` of x, in the order of the body's blocks. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_neighbours_find(brunt_body *body, double range, const double x[3], brunt_neighbours *list,
                          brunt_error *error);
// Fills the cloud with the centres of those within `range` of the place. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_neighbours_centres(brunt_neighbours *list, double range, brunt_error *error);

// How far a particle reaches along n [m]: its ball, but not past the particles next to it, so that the outermost speak
// for the surface.
double brunt_point_extent(brunt_body *body, int64_t s, const double n[3]);
// How much a particle's surroundings are stretched at most, about [-].
double brunt_point_stretch(brunt_body *body, int64_t s);
// How far particles of a body reach along n, from the place [m].
double brunt_point_support(brunt_body *body, const brunt_neighbours *list, const double n[3]);
// The direction out of a body at x, as its mass on the nodes falls. Whether there is one.
bool brunt_point_outward(const brunt_grid *grid, const double x[3], double n[3]);
