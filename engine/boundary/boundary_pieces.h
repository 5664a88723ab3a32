// How lines and surfaces are cut into pieces. Private to their making (boundary_surface.c).
#pragma once

#include "boundary/boundary_surface.h"

// Cosine of the turn between parts where pieces end: 30 degrees.
#define BRUNT_BOUNDARY_CORNER 0.866
// Of a piece: parts between corners that are shorter do not end one, since the grid could not tell such pieces apart.
#define BRUNT_BOUNDARY_SHORT (2.0 / 3)
#define BRUNT_BOUNDARY_PARTICLE_LIMIT 1e6

// Particles, pieces and directions of a surface that has nothing but its boundary and the cell. BRUNT_OK, or what is
// wrong.
int brunt_boundary_cut_line(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error);
int brunt_boundary_cut_facets(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error);
