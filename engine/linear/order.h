// The order in which nodes are eliminated so that factors stay sparse: nested dissection by METIS.
#pragma once

#include "linear/block_matrix.h"

// position[n]: when node n is eliminated, 0 .. nodes - 1. BRUNT_OK, or BRUNT_FAILED with the reason.
int brunt_elimination_order(const brunt_block_matrix *a, int32_t *position, brunt_error *error);
