// The transfers of points to and from their grids that a scene has chosen. Nothing to free, no state: they follow from
// the definition.
#pragma once

#include "mpm/transfer.h"

typedef struct brunt_transfers {   // NULL: there is none
    brunt_p2g_fn *p2g, *total_p2g; // total: of total-Lagrangian bodies
    brunt_g2p_fn *g2p, *musl_velocity, *total_g2p;
    int outs; // arrays of a workspace
} brunt_transfers;

void brunt_transfers_make(brunt_transfers *transfers, const brunt_world_def *def);
// Aborts where there is a way to the grid and none back.
void brunt_transfers_validate(const brunt_transfers *transfers);
