// Velocities that are imposed at nodes of the grid of material points.
#pragma once

#include "contact/planes/boundary.h"
#include "mpm/mpm_body.h"

// Of a cell: what a node may stand off a plane or a shape that it is meant to lie in. Places of nodes are rounded by as
// much as they are cells away from the origin, in float that of the cell's edge itself.
#define BRUNT_ON_BOUNDARY (sizeof(real) == 4 ? 1e-4 : 1e-9)

// What is imposed marks the components of nodes that it gives (brunt_grid.held); cleared before the first of it.
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_condition_clear(brunt_body *body, brunt_error *error);
// Nodes beyond the axis of rings are the images of those before it: they get what those get, mirrored. On the axis
// there is no radial velocity.
void brunt_condition_reflect(bool axisymmetric, const double position[3], double h, double now[3]);
// Gives a node its velocity, holds components of it (bits), and records what moves at `rest`.
void brunt_condition_hold(brunt_body *body, const brunt_slot *slot, int node, const double now[3], const double rest[3],
                          unsigned held, brunt_impulse_account *account);
