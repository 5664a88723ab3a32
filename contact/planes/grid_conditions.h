// Stick and slip planes at the nodes behind them, and prescribed velocities in regions.
#pragma once

#include "contact/planes/boundary.h"
#include "mpm/mpm_body.h"

// Each marks the components of nodes that it gives (brunt_grid.held); cleared before the first of them. 0, or -1: out
// of memory.
int brunt_condition_clear(brunt_body *body);
void brunt_condition_apply(brunt_body *body, brunt_boundary *wall, double time);
