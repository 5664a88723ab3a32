// Contact between bodies of material points at the nodes of their grids: multi-velocity, and tied.
#pragma once

#include "contact/contact.h"

typedef struct brunt_contact_workspace brunt_contact_workspace;
// All bodies of material points that have pairs. 0, or -1: out of memory, -2: more than 16 bodies at a node.
int brunt_grid_velocity_apply(const brunt_contact_context *m, brunt_contact_workspace **workspace);
void brunt_contact_workspace_free(brunt_contact_workspace *workspace);
