// Linear triangle in plane strain. Modes: the edges from node 0.
#include "fem/plane_strain.h"

static const uint8_t faces[][4] = TRI3_FACES;

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
    .name = "tri3",
    .doc = "linear triangle in plane strain: constant strain, no zero-energy modes; stiff where volume is kept",
    .dim = 2,
    .nodes = 3,
    .face_count = 3,
    .face_nodes = 2,
    .block = 512,
    .vtk_cell = 5,
    .face = faces,
    .volume = tri3_area,
    .gradient = tri3_mean_gradient,
    .forces = tri3_forces,
};
