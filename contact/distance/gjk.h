// Distance of two bodies of material points near a node (Gilbert, Johnson and Keerthi).
#pragma once

#include "contact/distance/particle_cloud.h"

enum { BRUNT_CORNERS = 4 };
// What a search ends with: particles a[i] and b[i] of the two clouds, between which the nearest points are.
typedef struct brunt_corners {
    int count, a[BRUNT_CORNERS], b[BRUNT_CORNERS];
} brunt_corners;

// Distance between the centres of what two bodies have near a node [m], 0 when their hulls overlap, and its direction
// from a to b (unit; left alone when 0). `start`: where to look first, any length but 0; `corners`: those to begin
// with, where there are any, and those that the search ends with. `h`: edge of a cell [m].
double brunt_gjk_centres(const brunt_cloud *a, const brunt_cloud *b, double h, const double start[3], double n[3],
                         brunt_corners *corners);
// The same between as far as they reach, from what the search between their centres along `start` has ended with.
double brunt_gjk_reaches(const brunt_cloud *a, const brunt_cloud *b, double h, const double start[3], double n[3],
                         const brunt_corners *corners);
