// The order in which nodes are eliminated so that factors stay sparse: nested dissection by METIS.
#pragma once

#include "linear/block_matrix.h"

// position[n]: when node n is eliminated, 0 .. nodes - 1; the `coupled` nodes that others couple with come first.
// BRUNT_OK, or BRUNT_FAILED with the reason.
int brunt_elimination_order(const brunt_block_matrix *a, int32_t *position, int32_t *coupled, brunt_error *error);
