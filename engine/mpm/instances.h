// The kernels that implicit steps of material points are made for, by dimension: names say what an instance is of. A
// file makes its instances of this list, and finds them by it.
#pragma once

#include "mpm/mpm_body.h"

#define MPM_INSTANCES(X)                                                                                               \
    X(2d_linear, 2, BRUNT_LINEAR)                                                                                      \
    X(2d_quadratic, 2, BRUNT_QUADRATIC)                                                                                \
    X(2d_cubic, 2, BRUNT_CUBIC)                                                                                        \
    X(2d_cut, 2, BRUNT_GRID_CUT)                                                                                       \
    X(2d_mesh, 2, BRUNT_GRID_MESH)                                                                                     \
    X(3d_linear, 3, BRUNT_LINEAR)                                                                                      \
    X(3d_quadratic, 3, BRUNT_QUADRATIC)                                                                                \
    X(3d_cubic, 3, BRUNT_CUBIC)
