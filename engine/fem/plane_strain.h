// What quadrilaterals and triangles in the plane and those revolved about the axis share: topology, area, and the
// nodes' combinations. Of a quadrilateral xi, eta and the hourglass xi eta, each the sum of the nodes' values times the
// mode's +-1 there; of a triangle its edges from node 0.
#pragma once

#include "fem/kernel.h"

#define QUAD4_HOURGLASS                                                                                                \
    {                                                                                                                  \
        { 1, -1, 1, -1 }                                                                                               \
    }

static inline double quad4_area(const double (*x)[3]) {
    return 0.5 * ((x[2][0] - x[0][0]) * (x[3][1] - x[1][1]) - (x[2][1] - x[0][1]) * (x[3][0] - x[1][0]));
}

static inline double tri3_area(const double (*x)[3]) {
    return 0.5 * ((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]));
}

BRUNT_INLINE void quad4_modes(const lanes x[4][2], lanes m[3][2]) {
    for (int i = 0; i < 2; i++) {
        lanes rising = x[2][i] - x[0][i], falling = x[1][i] - x[3][i];
        m[0][i] = rising + falling;
        m[1][i] = rising - falling;
        m[2][i] = (x[0][i] + x[2][i]) - (x[1][i] + x[3][i]);
    }
}

BRUNT_INLINE void quad4_nodal(const lanes p[3][2], lanes f[4][2]) {
    for (int i = 0; i < 2; i++) {
        lanes rising = p[0][i] + p[1][i], falling = p[0][i] - p[1][i];
        f[0][i] = p[2][i] - rising;
        f[2][i] = p[2][i] + rising;
        f[1][i] = falling - p[2][i];
        f[3][i] = -falling - p[2][i];
    }
}

BRUNT_INLINE void tri3_modes(const lanes x[3][2], lanes m[2][2]) {
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 2; i++) m[k][i] = x[k + 1][i] - x[0][i];
}

BRUNT_INLINE void tri3_nodal(const lanes p[2][2], lanes f[3][2]) {
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) f[k + 1][i] = p[k][i];
        f[0][i] = -(p[0][i] + p[1][i]);
    }
}
