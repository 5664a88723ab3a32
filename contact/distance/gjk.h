// Distance of two bodies of material points near a node (Gilbert, Johnson and Keerthi).
#pragma once

#include "contact/distance/particle_extent.h"

// Distance between what two bodies have near a node [m], 0 when that overlaps, and its direction from a to b (unit;
// left alone when 0). `start`: where to look first, any length but 0. `h`: edge of a cell.
double brunt_gjk_distance(const brunt_extent_cloud *a, const brunt_extent_cloud *b, double h, double share,
                          const double start[3], double n[3]);
