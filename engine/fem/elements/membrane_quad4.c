// Bilinear membrane quadrilateral with one point. Modes: the tangents chi (along xi) and psi (along eta), and the
// hourglass xi eta, each the sum of the nodes' values times the mode's +-1 there.
#include "base/array.h"
#include "fem/kernel.h"

static const int8_t hourglass_mode[][BRUNT_ELEMENT_NODES] = {{1, -1, 1, -1}};

BRUNT_INLINE void membrane_quad4_modes(const lanes x[4][3], lanes m[3][3]) {
    for (int i = 0; i < 3; i++) {
        lanes rising = x[2][i] - x[0][i], falling = x[1][i] - x[3][i];
        m[0][i] = rising + falling;
        m[1][i] = rising - falling;
        m[2][i] = (x[0][i] + x[2][i]) - (x[1][i] + x[3][i]);
    }
}

BRUNT_INLINE void membrane_quad4_nodal(const lanes p[3][3], lanes f[4][3]) {
    for (int i = 0; i < 3; i++) {
        lanes rising = p[0][i] + p[1][i], falling = p[0][i] - p[1][i];
        f[0][i] = p[2][i] - rising;
        f[2][i] = p[2][i] + rising;
        f[1][i] = falling - p[2][i];
        f[3][i] = -falling - p[2][i];
    }
}

#define ELEMENT membrane_quad4
#define NODES 4
#define MODES 3
#define HOURGLASS_MODES 1
#define MODE_NORM 4
#define AREA_SHARE 0.25
#include "fem/membrane.inc"

const brunt_element brunt_membrane_quad4 = {
    .traits = &brunt_element_table[BRUNT_MEMBRANE_QUAD4],
    .doc =
        "bilinear membrane quadrilateral, one point with hourglass control of in-plane and warping modes (Belytschko; "
        "Flanagan and Belytschko 1981)",
    .block = 1024,
    .flops = {.whole = {636, 636}},
    .hourglass_modes = BRUNT_COUNT(hourglass_mode),
    .hourglass = hourglass_mode,
    .volume = area,
    .gradient = membrane_quad4_mean_gradient,
    .forces = membrane_quad4_forces,
};
