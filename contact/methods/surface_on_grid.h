// Multi-velocity contact of meshes with material points, on the grid that moves the points (Y. P. Lian, Y. Liu and X.
// Zhang, "Coupling of membrane element with material point method for fluid-membrane interaction problems", section 5).
//
// The surface nodes K of a mesh r give mass and momentum to the nodes I of the grid of body s, by the body's own
// kernel:
//   m_I^r = sum_K N_I(x_K) m_K,   v_I^r = sum_K N_I(x_K) m_K v_K / m_I^r
// Where both have mass, impulses end the approach (grid_velocity.c): the grid velocity of s changes by J/m_I^s, and
// what the mesh gets goes back to its nodes by
//   v_K += sum_I N_I(x_K) J_I / m_I^r                                                                      (their eq.
//   59)
// which is the transpose of the way there: linear momentum is exact. Angular momentum is not: the mesh gets J_I where
// the mass is that it gave to the node, on the average, and s at the node, up to a kernel's half width away.
//
// Where this differs from the paper:
//   - eq. 55 there has the sign of the force on the other body, and in eq. 58 the friction's direction is f_tan/|f_tan|
//   - bodies touch where the reach of the particles (particle_extent.c) meets the facets, half a thickness in front of
//   a membrane,
//     and not where both are felt by one node: the approach is limited to gap/dt
//   - of a membrane the normal points to where the particles are, so that bodies may be on either side of it
//   - the normal is that of the facets nearest to the particles that touch, not of all that the node feels: it is not
//     tilted near edges
//   - a mesh follows what its nodes feel only in part at a time, since what it gets is averaged over the kernel: a few
//     sweeps take what is left of the approach, one is the paper
//   - prescribed components do not give way: what they get is the holder's
//
// No constraints of the common solver are made of it, which would be solved to its tolerance: what a prescribed mesh
// feels is a whole kernel wide, and grid nodes a cell away from it would be held fast. A sweep gives there the share
// that the surface has of the node (`relax`), and how many there are is part of the method. Each step of a sweep is one
// of the law of contact (coulomb.h).
//
// The way back averages over a kernel: motions of a mesh that is finer than the cells are felt only in their mean, and
// a mesh that is coarser leaves nodes between its own unseen. Elements about as large as the cells are what it is for.
#pragma once

#include "contact/contact.h"
#include "contact/planes/boundary.h"
#include "contact/planes/symmetry.h"
#include "contact/surface/contact_surface.h"

typedef struct brunt_surface_on_grid brunt_surface_on_grid;

// Marks in surface->active the meshes that the grid of a body they meet in this way reaches; call between
// brunt_surface_bounds and brunt_surface_gather_state, after what sets it.
void brunt_surface_on_grid_near(const brunt_contact_context *m);
// Changes the velocities of grid nodes and of the surface, with `sweeps` sweeps; four times as many where two bodies
// meet one place of a mesh. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_on_grid_meet(const brunt_contact_context *m, int sweeps, brunt_surface_on_grid **work,
                               brunt_error *error);
// Accounts and contact state, once all else has acted on the surface's velocities.
void brunt_surface_on_grid_finish(const brunt_contact_context *m, const brunt_surface_on_grid *work);
void brunt_surface_on_grid_free(brunt_surface_on_grid *work);
// Aborts where links, nodes of the surface and contacts of the last step do not belong to each other.
void brunt_surface_on_grid_validate(const brunt_surface_on_grid *work);
size_t brunt_surface_on_grid_bytes(const brunt_surface_on_grid *work);
