// Contact between bodies of material points at the nodes of their grids: multi-velocity, and tied.
#pragma once

#include "contact/contact.h"

typedef struct brunt_contact_workspace brunt_contact_workspace;
// All bodies of material points that have pairs. BRUNT_OK, or BRUNT_FAILED: out of memory, or more than 16 bodies at
// a node.
int brunt_grid_velocity_apply(const brunt_contact_context *m, brunt_contact_workspace **workspace, brunt_error *error);
void brunt_contact_workspace_free(brunt_contact_workspace *workspace);
