// Planes that push particles and let go, with Coulomb friction, at zero gap.
#pragma once

#include "contact/planes/boundary.h"
#include "contact/search/particle_dof.h"

// Constraints of the particles of a body that a plane would catch. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_plane_meet_points(const brunt_contact_context *m, brunt_boundary *boundary, brunt_body *body,
                            brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error);
// The particles of a body at boundaries that push: makes their constraints in `set`, solves them, and gives the
// velocities back to the grid. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_boundaries_meet_points(const brunt_contact_context *m, brunt_body *body, brunt_particle_dofs *dofs,
                                 brunt_constraint_set *set, brunt_error *error);
