// Trilinear hexahedron with one point. Modes: xi, eta, zeta, and the hourglasses eta zeta, xi zeta, xi eta, xi eta
// zeta; each the sum of the nodes' values times the mode's +-1 there. With the places' modes a1 a2 a3 h1 h2 h3 h4 the
// volume of any trilinear hexahedron is
//   64 V = a1.(a2 x a3) + (h1.(a3 x h2) + h2.(a1 x h3) + h3.(a2 x h1)) / 3,
// from integrating det dx/dxi over the cube: all other products are odd, or have a vector twice. So dV/dX_a, the mean
// gradient times V (Flanagan and Belytschko, Int. J. Numer. Meth. Eng. 17 (1981) 679, there with 24 sums of products),
// follows from six vectors dV/dmode, and 18 numbers do the work of 24.
#include "base/array.h"
#include "fem/kernel.h"

// By mode and node, in the order of the modes.
static const int8_t hourglass[][BRUNT_ELEMENT_NODES] = {{1, 1, -1, -1, -1, -1, 1, 1},
                                                        {1, -1, -1, 1, -1, 1, 1, -1},
                                                        {1, -1, 1, -1, 1, -1, 1, -1},
                                                        {-1, 1, -1, 1, 1, -1, 1, -1}};

static double volume(const double (*x)[3]) {
    double m[7][3] = {{0}};
    for (int a = 0; a < 8; a++) {
        int xi = a % 4 == 1 || a % 4 == 2 ? 1 : -1, eta = a % 4 >= 2 ? 1 : -1, zeta = a >= 4 ? 1 : -1;
        int sign[6] = {xi, eta, zeta, eta * zeta, xi * zeta, xi * eta};
        for (int k = 0; k < 6; k++)
            for (int i = 0; i < 3; i++) m[k][i] += sign[k] * (x[a][i] - x[0][i]);
    }
    double bent = triple(m[3], m[2], m[4]) + triple(m[4], m[0], m[5]) + triple(m[5], m[1], m[3]);
    return (triple(m[0], m[1], m[2]) + bent / 3) / 64;
}

BRUNT_INLINE void hex8_modes(const lanes x[8][3], lanes m[7][3]) {
    for (int i = 0; i < 3; i++) {
        lanes rising[2], falling[2], cross_sum[2]; // of the bottom and the top
        for (int z = 0; z < 2; z++) {
            const lanes(*f)[3] = x + 4 * z;
            rising[z] = f[2][i] - f[0][i], falling[z] = f[1][i] - f[3][i];
            cross_sum[z] = f[0][i] + f[2][i];
        }
        lanes odd[2] = {x[1][i] + x[3][i], x[5][i] + x[7][i]};
        lanes xi[2], eta[2], bent[2], sum[2];
        for (int z = 0; z < 2; z++) {
            xi[z] = rising[z] + falling[z], eta[z] = rising[z] - falling[z];
            bent[z] = cross_sum[z] - odd[z], sum[z] = cross_sum[z] + odd[z];
        }
        m[0][i] = xi[0] + xi[1], m[1][i] = eta[0] + eta[1], m[2][i] = sum[1] - sum[0];
        m[3][i] = eta[1] - eta[0], m[4][i] = xi[1] - xi[0], m[5][i] = bent[0] + bent[1], m[6][i] = bent[1] - bent[0];
    }
}

BRUNT_INLINE void hex8_nodal(const lanes p[7][3], lanes f[8][3]) {
    for (int i = 0; i < 3; i++)
        for (int z = 0; z < 2; z++) {
            lanes xi = z ? p[0][i] + p[4][i] : p[0][i] - p[4][i], eta = z ? p[1][i] + p[3][i] : p[1][i] - p[3][i];
            lanes bent = z ? p[5][i] + p[6][i] : p[5][i] - p[6][i], level = z ? p[2][i] : -p[2][i];
            lanes rising = xi + eta, falling = xi - eta, even = level + bent, odd = level - bent;
            f[4 * z][i] = even - rising;
            f[4 * z + 2][i] = even + rising;
            f[4 * z + 1][i] = odd + falling;
            f[4 * z + 3][i] = odd - falling;
        }
}

// G = s (a x b + c x d)
BRUNT_INLINE void two_products(real s, const lanes a[3], const lanes b[3], const lanes c[3], const lanes d[3],
                               real share, lanes G[3]) {
    lanes first[3], second[3];
    cross(a, b, first);
    cross(c, d, second);
    for (int i = 0; i < 3; i++) G[i] = s * (first[i] + share * second[i]);
}

BRUNT_INLINE lanes hex8_gradient(const lanes m[7][3], lanes G[6][3]) {
    const real s = (real)(1.0 / 64), third = (real)(1.0 / 3);
    two_products(s, m[1], m[2], m[5], m[4], third, G[0]);
    two_products(s, m[2], m[0], m[3], m[5], third, G[1]);
    two_products(s, m[0], m[1], m[4], m[3], third, G[2]);
    two_products(s * third, m[2], m[4], m[5], m[1], 1, G[3]);
    two_products(s * third, m[3], m[2], m[0], m[5], 1, G[4]);
    two_products(s * third, m[1], m[3], m[4], m[0], 1, G[5]);
    return dot(3, m[0], G[0]) + dot(3, m[3], G[3]);
}

#define ELEMENT hex8
#define DIM 3
#define NODES 8
#define MODES 7
#define STRAIN_MODES 6
#define HOURGLASS_MODES 4
#define MODE_NORM 8
#include "fem/element.inc"

const brunt_element brunt_hex8 = {
    .traits = &brunt_element_table[BRUNT_HEX8],
    .doc = "trilinear hexahedron, one point with hourglass control (Flanagan and Belytschko 1981)",
    .block = 512,
    // modes by sums of pairs; six products of two crosses: three of 27, three of 24
    .flops = {.strain_modes = 6, .combine = 69, .spread = 66, .slope = 164},
    .hourglass_modes = BRUNT_COUNT(hourglass),
    .hourglass = hourglass,
    .volume = volume,
    .gradient = hex8_mean_gradient,
    .forces = hex8_forces,
};
