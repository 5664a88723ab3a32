// Planes that push particles and let go, with Coulomb friction, at zero gap.
#pragma once

#include "contact/search/particle_dof.h"

// The particles of a body at planes that push: makes their constraints in `set`, solves them, and gives the velocities
// back to the grid. 0, or -1: out of memory.
int brunt_planes_apply(const brunt_contact_context *m, brunt_body *body, brunt_particle_dofs *dofs,
                       brunt_constraint_set *set);
