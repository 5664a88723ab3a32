// How lines and surfaces are cut into pieces. Private to their making (boundary_surface.c).
#pragma once

#include "boundary/boundary_surface.h"

// Particles, pieces and directions of a surface that has nothing but its boundary and the cell. BRUNT_OK, or what is
// wrong.
int brunt_boundary_cut_line(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error);
