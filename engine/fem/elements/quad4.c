// Bilinear quadrilateral in plane strain with one point. Modes: xi, eta, and the hourglass xi eta, each the sum of the
// nodes' values times the mode's +-1 there.
#include "base/array.h"
#include "fem/plane_strain.h"

static const int8_t hourglass[][BRUNT_ELEMENT_NODES] = QUAD4_HOURGLASS;

// The area is a quarter of the cross product of the xi and eta modes; the hourglass mode has no share in it.
BRUNT_INLINE lanes quad4_gradient(const lanes m[3][2], lanes G[2][2]) {
    G[0][0] = (real)0.25 * m[1][1], G[0][1] = (real)-0.25 * m[1][0];
    G[1][0] = (real)-0.25 * m[0][1], G[1][1] = (real)0.25 * m[0][0];
    return dot(2, m[0], G[0]);
}

#define ELEMENT quad4
#define DIM 2
#define NODES 4
#define MODES 3
#define STRAIN_MODES 2
#define HOURGLASS_MODES 1
#define MODE_NORM 4
#include "fem/element.inc"

const brunt_element brunt_quad4 = {
    .traits = &brunt_element_table[BRUNT_QUAD4],
    .doc = "bilinear quadrilateral in plane strain, one point with hourglass control (Flanagan and Belytschko 1981)",
    .block = 1024,
    .flops = {.strain_modes = 2, .combine = 14, .spread = 12, .slope = 7},
    .hourglass_modes = BRUNT_COUNT(hourglass),
    .hourglass = hourglass,
    .volume = quad4_area,
    .gradient = quad4_mean_gradient,
    .forces = quad4_forces,
};
