// What axisymmetric elements have in common: integrals over their section, and sums for the bound of their stable step.
#pragma once

#include "fem/kernel.h"

enum { AXISYMMETRIC_NODES = 4 };

// Where the components of a matrix in the plane are in one of three dimensions.
static const int axisymmetric_place[4] = {0, 1, 3, 4};

// Of a vector of elements at the start; without the factor 2 pi of the circle.
typedef struct axisymmetric_section {
    lanes volume, area;                 // int R dA, int dA
    lanes G[3][2];                      // of each mode: int R grad N_a dA is sum_k M_ka G_k
    lanes hoop[AXISYMMETRIC_NODES];     // int N_a dA
    lanes share[AXISYMMETRIC_NODES];    // int N_a R dA
    lanes off_axis[AXISYMMETRIC_NODES]; // R_a: 0 on the axis
} axisymmetric_section;

// Sums over the nodes, B = int R grad N_a dA, H = int N_a dA, each with its 1/share: of radial motion B B, B H, H H (rr
// rz zz, r z), of axial motion B B.
typedef struct axisymmetric_sums {
    lanes radial[3], cross[2], hoop, axial[3];
} axisymmetric_sums;

BRUNT_INLINE void add_axisymmetric_sums(const lanes B[2], lanes H, lanes axial, lanes radial, axisymmetric_sums *sums) {
    lanes rr = B[0] * B[0], rz = B[0] * B[1], zz = B[1] * B[1], h = H * radial;
    sums->radial[0] += radial * rr, sums->radial[1] += radial * rz, sums->radial[2] += radial * zz;
    sums->axial[0] += axial * rr, sums->axial[1] += axial * rz, sums->axial[2] += axial * zz;
    sums->cross[0] += h * B[0], sums->cross[1] += h * B[1];
    sums->hoop += h * H;
}

// S = F^-T S0 F^-1
BRUNT_INLINE void axisymmetric_carry(const lanes S0[3], const lanes inverse[4], lanes S[3]) {
    lanes a = inverse[0] * S0[0] + inverse[2] * S0[1], b = inverse[0] * S0[1] + inverse[2] * S0[2];
    lanes c = inverse[1] * S0[0] + inverse[3] * S0[1], d = inverse[1] * S0[1] + inverse[3] * S0[2];
    S[0] = a * inverse[0] + b * inverse[2];
    S[1] = a * inverse[1] + b * inverse[3];
    S[2] = c * inverse[1] + d * inverse[3];
}

// Greatest eigenvalue of a symmetric matrix.
BRUNT_INLINE lanes axisymmetric_greatest(lanes a, lanes b, lanes off_squared) {
    lanes half = (real)0.5 * (a - b);
    return (real)0.5 * (a + b) + lanes_sqrt(half * half + off_squared);
}

// D and the greater of the eigenvalues of radial and axial motion (axisymmetric.inc), of what the sums are of.
BRUNT_INLINE void axisymmetric_bounds(const axisymmetric_sums *sums, const lanes inverse[4], lanes inverse_hoop,
                                      lanes *divergence, lanes *greatest) {
    lanes S[3], A[3], s[2], t = sums->hoop * inverse_hoop * inverse_hoop;
    axisymmetric_carry(sums->radial, inverse, S);
    axisymmetric_carry(sums->axial, inverse, A);
    for (int i = 0; i < 2; i++) s[i] = (inverse[i] * sums->cross[0] + inverse[2 + i] * sums->cross[1]) * inverse_hoop;
    *divergence = S[0] + 2 * s[0] + t + A[2];
    lanes radial = axisymmetric_greatest(axisymmetric_greatest(S[0], S[2], S[1] * S[1]), t, dot(2, s, s));
    *greatest = lanes_max(radial, axisymmetric_greatest(A[0], A[2], A[1] * A[1]));
}
