// Bilinear quadrilateral in plane strain with one point. Modes: xi, eta, and the hourglass xi eta, each the sum of the
// nodes' values times the mode's +-1 there.
#include "kernel.h"

static const uint8_t faces[][4] = {{0, 1, 0, 0}, {1, 2, 0, 0}, {2, 3, 0, 0}, {3, 0, 0, 0}};

static const int8_t hourglass[][BRUNT_ELEMENT_NODES] = {{1, -1, 1, -1}};

static double volume(const double (*x)[3]) {
    return 0.5 * ((x[2][0] - x[0][0]) * (x[3][1] - x[1][1]) - (x[2][1] - x[0][1]) * (x[3][0] - x[1][0]));
}

BRUNT_INLINE void quad4_modes(const lanes x[4][2], lanes m[3][2]) {
    for (int i = 0; i < 2; i++) {
        lanes rising = x[2][i] - x[0][i], falling = x[1][i] - x[3][i];
        m[0][i] = rising + falling;
        m[1][i] = rising - falling;
        m[2][i] = (x[0][i] + x[2][i]) - (x[1][i] + x[3][i]);
    }
}

BRUNT_INLINE void quad4_nodal(const lanes p[3][2], lanes f[4][2]) {
    for (int i = 0; i < 2; i++) {
        lanes rising = p[0][i] + p[1][i], falling = p[0][i] - p[1][i];
        f[0][i] = p[2][i] - rising;
        f[2][i] = p[2][i] + rising;
        f[1][i] = falling - p[2][i];
        f[3][i] = -falling - p[2][i];
    }
}

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
#include "element.inc"

const brunt_element brunt_quad4 = {
    .name = "quad4",
    .doc = "bilinear quadrilateral in plane strain, one point with hourglass control (Flanagan and Belytschko 1981)",
    .dim = 2,
    .nodes = 4,
    .face_count = 4,
    .face_nodes = 2,
    .block = 1024,
    .vtk_cell = 9,
    .hourglass_modes = 1,
    .hourglass = hourglass,
    .face = faces,
    .volume = volume,
    .gradient = quad4_mean_gradient,
    .forces = quad4_forces,
};
