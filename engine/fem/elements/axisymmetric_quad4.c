// Bilinear quadrilateral revolved about the axis, with one point. Modes as in quad4.c: xi, eta, and the hourglass xi
// eta.
#include "base/array.h"
#include "fem/plane_strain.h"
#include "fem/axisymmetric.h"

static const int8_t hourglass_mode[][BRUNT_ELEMENT_NODES] = QUAD4_HOURGLASS;

#define axisymmetric_quad4_modes quad4_modes
#define axisymmetric_quad4_nodal quad4_nodal

// Nodes' values c + m0 + m1 + m2 of combinations of 1, xi, eta, xi eta.
BRUNT_INLINE void spread(lanes c, lanes xi, lanes eta, lanes both, lanes out[4]) {
    out[0] = (c - xi) - (eta - both);
    out[1] = (c + xi) - (eta + both);
    out[2] = (c + xi) + (eta + both);
    out[3] = (c - xi) + (eta - both);
}

// With R = R0 + (R1 xi + R2 eta + R3 xi eta) / 4 and the Jacobian j = (j0 + j1 xi + j2 eta) / 16, N_a = (1 + xi_a xi +
// eta_a eta + xi_a eta_a xi eta) / 4: integrals of products over [-1, 1]^2, where xi^2 has the mean 1/3. For G,
// int R dX/deta = R0 m1 + R1 m2 / 12, int R dX/dxi = R0 m0 + R2 m2 / 12, and their difference with weights eta and xi
// (R2 m1 - R1 m0) / 12, turned by 90 degrees.
BRUNT_INLINE void axisymmetric_quad4_section(const lanes X[4][2], const lanes m[3][2], axisymmetric_section *out) {
    const real third = (real)(1.0 / 3), twelfth = (real)(1.0 / 12);
    lanes R0 = (real)0.25 * ((X[0][0] + X[2][0]) + (X[1][0] + X[3][0]));
    lanes R1 = m[0][0], R2 = m[1][0], R3 = m[2][0];
    lanes j0 = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    lanes j1 = m[0][0] * m[2][1] - m[0][1] * m[2][0];
    lanes j2 = m[2][0] * m[1][1] - m[2][1] * m[1][0];
    out->area = (real)0.25 * j0;
    lanes c = (real)0.25 * (R0 * j0 + twelfth * (R1 * j1 + R2 * j2));
    lanes xi = third * (real)0.25 * (R0 * j1 + (real)0.25 * (R1 * j0 + third * R3 * j2));
    lanes eta = third * (real)0.25 * (R0 * j2 + (real)0.25 * (R2 * j0 + third * R3 * j1));
    lanes both = third * third * (real)0.0625 * (R1 * j2 + R2 * j1 + R3 * j0);
    out->volume = c;
    spread((real)0.25 * c, (real)0.25 * xi, (real)0.25 * eta, (real)0.25 * both, out->share);
    spread((real)0.0625 * j0, (real)0.0625 * third * j1, (real)0.0625 * third * j2, lanes_set(0), out->hoop);
    lanes along[2], across[2], rest[2];
    for (int i = 0; i < 2; i++) {
        across[i] = R0 * m[1][i] + twelfth * R1 * m[2][i];
        along[i] = R0 * m[0][i] + twelfth * R2 * m[2][i];
        rest[i] = twelfth * (R2 * m[1][i] - R1 * m[0][i]);
    }
    out->G[0][0] = (real)0.25 * across[1], out->G[0][1] = (real)-0.25 * across[0];
    out->G[1][0] = (real)-0.25 * along[1], out->G[1][1] = (real)0.25 * along[0];
    out->G[2][0] = (real)0.25 * rest[1], out->G[2][1] = (real)-0.25 * rest[0];
    for (int a = 0; a < 4; a++) out->off_axis[a] = X[a][0];
}

#define ELEMENT axisymmetric_quad4
#define NODES 4
#define MODES 3
#define HOURGLASS_MODES 1
#define MODE_NORM 4
#include "fem/axisymmetric.inc"

const brunt_element brunt_axisymmetric_quad4 = {
    .traits = &brunt_element_table[BRUNT_QUAD4],
    .doc = "bilinear quadrilateral about an axis, one point with hourglass control (Flanagan and Belytschko 1981)",
    .axisymmetric = true,
    .block = 1024,
    .flops = {.whole = {524, 579}},
    .hourglass_modes = BRUNT_COUNT(hourglass_mode),
    .hourglass = hourglass_mode,
    .volume = quad4_area,
    .shares = shares,
    .gradient = axisymmetric_quad4_mean_gradient,
    .forces = axisymmetric_quad4_forces,
};
