// Planes that push particles and let go, with Coulomb friction, at zero gap.
#pragma once

#include "contact/contact.h"

typedef struct brunt_wall_workspace brunt_wall_workspace;
// The particles of a body at planes that push. 0, or -1: out of memory.
int brunt_planes_apply(const brunt_contact_context *m, brunt_body *body, brunt_wall_workspace **workspace);
void brunt_wall_workspace_free(brunt_wall_workspace *workspace);
