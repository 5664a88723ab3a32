// Velocities that are imposed at nodes of the grid of material points.
#pragma once

#include "contact/planes/boundary.h"
#include "contact/planes/symmetry.h"
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
// The grid of a body that conditions hold, and the planes that it has images by. Conditions hold what is before those:
// nodes on one keep no velocity across it, none at all where it sticks, and images follow. What moves a node moves its
// images, and all their momentum as if it were there; the planes bear what it is more or less of, each in its account.
struct brunt_held_grid {
    brunt_body *body;
    const brunt_symmetry_plane *symmetry; // without the axis of rings
    int symmetry_count;
    brunt_impulse_account *const *account; // of each
    const brunt_boundary *later;           // that come after what holds it now
    int later_count;
    double time; // [s]
};
// Gives a node its velocity, holds components of it (bits), and records what moves at `rest`. Components that something
// later gives another velocity are that one's alone: what would bring them to a velocity that they do not keep would
// bear an impulse that nothing feels, and the work of it.
void brunt_condition_hold(const brunt_held_grid *g, const brunt_slot *slot, int node, const double velocity[3],
                          const double rest[3], unsigned held, brunt_impulse_account *account);
