// Linear membrane triangle. Modes: the edges from node 0.
#include "fem/kernel.h"

static const uint8_t faces[][4] = {{0, 1, 2, 0}};

BRUNT_INLINE void membrane_tri3_modes(const lanes x[3][3], lanes m[2][3]) {
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) m[k][i] = x[k + 1][i] - x[0][i];
}

BRUNT_INLINE void membrane_tri3_nodal(const lanes p[2][3], lanes f[3][3]) {
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 2; k++) f[k + 1][i] = p[k][i];
        f[0][i] = -(p[0][i] + p[1][i]);
    }
}

#define ELEMENT membrane_tri3
#define NODES 3
#define MODES 2
#define HOURGLASS_MODES 0
#define MODE_NORM 0
#define AREA_SHARE 0.5
#include "fem/membrane.inc"

const brunt_element brunt_membrane_tri3 = {
    .name = "membrane_tri3",
    .doc = "linear membrane triangle",
    .dim = 3,
    .sheet = true,
    .nodes = 3,
    .face_count = 1,
    .face_nodes = 3,
    .block = 512,
    .vtk_cell = 5,
    .face = faces,
    .volume = area,
    .gradient = mean_gradient,
    .forces = membrane_tri3_forces,
};
