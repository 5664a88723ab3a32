// Contact between bodies of material points at the nodes of their grids: multi-velocity, and what has a law of its own
// there.
#pragma once

#include "contact/contact.h"

// What a method does of its own to two bodies at a node: from the velocity v of the second relative to the first [m/s],
// of which an impulse takes `inverse` [1/kg] by component (0: a condition gives it), the impulse J on the second [N s],
// 0 before. It is asked again until nothing changes. Gives the change of velocity [m/s].
typedef double brunt_node_law(const double v[3], const double inverse[3], double J[3]);

typedef struct brunt_contact_workspace brunt_contact_workspace;
// All bodies of material points that have pairs. BRUNT_OK, or BRUNT_FAILED: out of memory, or more than 16 bodies at
// a node.
int brunt_grid_velocity_apply(const brunt_contact_context *m, brunt_contact_workspace **workspace, brunt_error *error);
void brunt_contact_workspace_free(brunt_contact_workspace *workspace);
