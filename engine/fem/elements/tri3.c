// Linear triangle in plane strain. Modes: the edges from node 0.
#include "fem/plane_strain.h"

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
#include "fem/element.inc"

const brunt_element brunt_tri3 = {
    .traits = &brunt_element_table[BRUNT_TRI3],
    .doc = "linear triangle in plane strain: constant strain, no zero-energy modes; stiff where volume is kept",
    .block = 512,
    .flops = {.strain_modes = 2, .combine = 4, .spread = 2, .slope = 7},
    .volume = tri3_area,
    .gradient = tri3_mean_gradient,
    .forces = tri3_forces,
};
