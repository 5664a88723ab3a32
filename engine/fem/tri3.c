// Linear triangle in plane strain. Modes: the edges from node 0.
#include "kernel.h"

static const uint8_t faces[][4] = {{0, 1, 0, 0}, {1, 2, 0, 0}, {2, 0, 0, 0}};

static double volume(const double (*x)[3]) {
    return 0.5 * ((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]));
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

BRUNT_INLINE lanes tri3_gradient(const lanes m[2][2], lanes G[2][2]) {
    G[0][0] = (real)0.5 * m[1][1], G[0][1] = (real)-0.5 * m[1][0];
    G[1][0] = (real)-0.5 * m[0][1], G[1][1] = (real)0.5 * m[0][0];
    return dot(2, m[0], G[0]);
}

#define ELEMENT tri3
#define DIM 2
#define NODES 3
#define MODES 2
#define STRAIN_MODES 2
#define HOURGLASS_MODES 0
#define MODE_NORM 0
#include "element.inc"

const brunt_element brunt_tri3 = {
    .name = "tri3",
    .doc = "linear triangle in plane strain: constant strain, no zero-energy modes; stiff where volume is kept",
    .dim = 2,
    .nodes = 3,
    .face_count = 3,
    .face_nodes = 2,
    .block = 512,
    .vtk_cell = 5,
    .face = faces,
    .volume = volume,
    .gradient = tri3_mean_gradient,
    .forces = tri3_forces,
};
