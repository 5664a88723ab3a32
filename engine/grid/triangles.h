// Linear functions over the two triangles that the diagonal from its lowest corner to its highest makes of a cell.
//
// The nodes of a cell in the order of its kernel, y fastest: (0,0), (0,1), (1,0), (1,1). Of a point the
// one across the diagonal has no weight. u, v: cells from the lowest corner. On the diagonal, where lattices of
// particles like to lie, slopes are the mean of both triangles': with those of one of them it would have more of their
// stress.
#pragma once

#include "base/simd.h"

BRUNT_INLINE void cut_cell_weights(lanes u, lanes v, lanes w[4]) {
    w[0] = 1 - lanes_max(u, v), w[3] = lanes_min(u, v);
    w[1] = lanes_max(v - u, lanes_set(0)), w[2] = lanes_max(u - v, lanes_set(0));
}

#define ON_DIAGONAL ((real)1e-9) // cells: rounding does not take a point off it

// Their derivatives along x and y [1/m].
BRUNT_INLINE void cut_cell_slopes(lanes u, lanes v, real inv_h, lanes gx[4], lanes gy[4]) {
    const lanes half = lanes_set((real)0.5 * inv_h), side = lanes_select(u > v, half, -half);
    const lanes turn = lanes_select(lanes_abs(u - v) < ON_DIAGONAL, lanes_set(0), side);
    const lanes below = half + turn, above = half - turn;
    gx[0] = -below, gy[0] = -above;
    gx[1] = -above, gy[1] = above;
    gx[2] = below, gy[2] = -below;
    gx[3] = above, gy[3] = below;
}
