// Distance of two bodies of material points near a node (Gilbert, Johnson and Keerthi).
#pragma once

#include "contact/distance/particle_cloud.h"

// Distance between what two bodies have near a node [m], 0 when that overlaps, and its direction from a to b (unit;
// left alone when 0). `start`: where to look first, any length but 0. `h`: edge of a cell [m]. `reach`: as in
// brunt_cloud_extent.
double brunt_gjk_distance(const brunt_cloud *a, const brunt_cloud *b, double h, bool reach, const double start[3],
                          double n[3]);
