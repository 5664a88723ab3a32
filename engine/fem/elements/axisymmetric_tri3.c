// Linear triangle revolved about the axis, with one point. Modes as in tri3.c: the edges from node 0.
#include "fem/plane_strain.h"
#include "fem/axisymmetric.h"

#define axisymmetric_tri3_modes tri3_modes
#define axisymmetric_tri3_nodal tri3_nodal

// Gradients are constant: int R grad N = mean R times that of tri3.c; int N_a = A / 3, int N_a N_b = A (1 + [a = b])
// / 12.
BRUNT_INLINE void axisymmetric_tri3_section(const lanes X[3][2], const lanes m[2][2], axisymmetric_section *out) {
    lanes sum = X[0][0] + X[1][0] + X[2][0], R = (real)(1.0 / 3) * sum;
    lanes A = out->area = (real)0.5 * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    out->volume = R * A;
    lanes half = (real)0.5 * R;
    out->G[0][0] = half * m[1][1], out->G[0][1] = -half * m[1][0];
    out->G[1][0] = -half * m[0][1], out->G[1][1] = half * m[0][0];
    for (int a = 0; a < 3; a++) {
        out->hoop[a] = (real)(1.0 / 3) * A;
        out->share[a] = (real)(1.0 / 12) * A * (sum + X[a][0]);
        out->off_axis[a] = X[a][0];
    }
}

#define ELEMENT axisymmetric_tri3
#define NODES 3
#define MODES 2
#define HOURGLASS_MODES 0
#define MODE_NORM 0
#include "fem/axisymmetric.inc"

const brunt_element brunt_axisymmetric_tri3 = {
    .traits = &brunt_element_table[BRUNT_TRI3],
    .doc = "linear triangle about an axis: constant gradient, mean hoop strain, no zero-energy modes",
    .axisymmetric = true,
    .block = 512,
    .flops = {.whole = {309, 309}},
    .volume = tri3_area,
    .shares = shares,
    .gradient = axisymmetric_tri3_mean_gradient,
    .forces = axisymmetric_tri3_forces,
};
