// What links a point to the nodes of a grid, whichever it is: B-splines, cells cut into triangles, a mesh of them.
// Particles are linked by the same functions in vectors (mpm/potential_kernel.h).
#pragma once

#include "grid/grid.h"

enum { BRUNT_KERNEL_NODES = 64 };

typedef struct brunt_grid_weights {
    int count;                         // 0: outside of a mesh
    int32_t at[BRUNT_KERNEL_NODES][3]; // coordinates of the node, as of brunt_grid_node
    double weight[BRUNT_KERNEL_NODES]; // times `scale`
} brunt_grid_weights;

void brunt_grid_weigh(const brunt_grid *grid, const double x[3], double scale, brunt_grid_weights *weights);
// The slopes of the same nodes [1/m].
void brunt_grid_slopes(const brunt_grid *grid, const double x[3], double slope[BRUNT_KERNEL_NODES][3]);
