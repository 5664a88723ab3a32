// Linear tetrahedron. Modes: the edges from node 0.
#include "fem/kernel.h"

static double volume(const double (*x)[3]) {
    double e[3][3];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) e[k][i] = x[k + 1][i] - x[0][i];
    return triple(e[0], e[1], e[2]) / 6;
}

BRUNT_INLINE void tet4_modes(const lanes x[4][3], lanes m[3][3]) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) m[k][i] = x[k + 1][i] - x[0][i];
}

BRUNT_INLINE void tet4_nodal(const lanes p[3][3], lanes f[4][3]) {
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) f[k + 1][i] = p[k][i];
        f[0][i] = -(p[0][i] + p[1][i] + p[2][i]);
    }
}

BRUNT_INLINE lanes tet4_gradient(const lanes m[3][3], lanes G[3][3]) {
    const real sixth = (real)(1.0 / 6);
    for (int k = 0; k < 3; k++) {
        cross(m[(k + 1) % 3], m[(k + 2) % 3], G[k]);
        for (int i = 0; i < 3; i++) G[k][i] *= sixth;
    }
    return dot(3, m[0], G[0]);
}

#define ELEMENT tet4
#define DIM 3
#define NODES 4
#define MODES 3
#define STRAIN_MODES 3
#define HOURGLASS_MODES 0
#define MODE_NORM 0
#include "fem/element.inc"

const brunt_element brunt_tet4 = {
    .traits = &brunt_element_table[BRUNT_TET4],
    .doc = "linear tetrahedron: constant strain, no zero-energy modes; stiff where volume is kept",
    .block = 384,
    .flops = {.strain_modes = 3, .combine = 9, .spread = 6, .slope = 41},
    .volume = volume,
    .gradient = tet4_mean_gradient,
    .forces = tet4_forces,
};
