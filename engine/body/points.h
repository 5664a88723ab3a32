// What the restoring of bodies of points shares.
#pragma once

#include "mpm/particles.h"

// Particles without gaps between them, in their order; new ones up to `count` are all 0. Their grid is out of date
// then.
void brunt_points_close_ranks(brunt_particles *particles, int64_t count);
