// Sorts a body's particles by block and bin, and brings the grid's set of blocks up to date.
#pragma once

#include "brunt.h"
#include "grid/grid.h"
#include "mpm/particles.h"
#include "base/parallel.h"

#define BRUNT_OUTSIDE_OF_MESH "the particle lies outside of the mesh of the grid (grid.cells.mesh)"

// Stable: particles of one bin keep their order, so the result does not depend on the number of threads. `timer` may
// be NULL. Errors: BRUNT_FAILED with id and place when a position is not finite, too far away or outside of the mesh;
// the particles are then untouched.
int brunt_sort(brunt_grid *grid, brunt_particles *particles, int threads, brunt_timer *timer, brunt_error *error);
void brunt_sort_workspace_free(brunt_sort_workspace *workspace);
