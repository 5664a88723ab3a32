// Linear membrane triangle. Modes: the edges from node 0.
#include "fem/kernel.h"

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
    .traits = &brunt_element_table[BRUNT_MEMBRANE_TRI3],
    .doc = "linear membrane triangle",
    .block = 512,
    .flops = {.whole = {338, 338}},
    .volume = area,
    .gradient = membrane_tri3_mean_gradient,
    .forces = membrane_tri3_forces,
};
