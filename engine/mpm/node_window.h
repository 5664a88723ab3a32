// The nodes that the bins of a block touch, as its particles see them.
#pragma once

#include <math.h>

#include "grid/node.h"
#include "mpm/mpm_body.h"

// The bin's coordinate along an axis, as reals.
BRUNT_INLINE lanes bin_coordinate(const uint8_t *bin, int dim, int axis) {
    lanes r;
    int shift = dim == 3 ? 4 - 2 * axis : 3 - 3 * axis, mask = dim == 3 ? 3 : 7;
    for (int l = 0; l < BRUNT_LANES; l++) r[l] = (real)(bin[l] >> shift & mask);
    return r;
}

// Cells from the base node. One expression for both ways: near the end of a kernel's reach its last bit decides the
// weight.
BRUNT_INLINE lanes local_coordinate(lanes x, real corner, real inv_h, lanes bin) { return (x - corner) * inv_h - bin; }

// A light node feels particles only with the last 1/1000 of their kernels. Their stress throws it far, as force over
// mass grows without bound there; the weights make up for it, but the polynomials of the gather would lose the digits.
// So the window holds its old velocity, and what it changed by is added with the exact weights (add_light_nodes).
typedef struct light_node {
    int16_t at[3];
    real change[3];
} light_node;
enum { MAX_WINDOW = 11 * 11 > 7 * 7 * 7 ? 11 * 11 : 7 * 7 * 7 };

static real light_mass(const brunt_body *body) {
    const real shares[] = {0, (real)1e-3, (real)1e-6, (real)1e-9};
    return shares[body->grid.order] * body->particle_mass;
}

// Of rings a particle's mass grows with the distance from the axis; at the axis half a cell counts.
static real axisymmetric_light_mass(const brunt_body *body, int32_t node) {
    const brunt_grid *grid = &body->grid;
    const double r = fabs(grid->origin[0] + (double)grid->h * node);
    return light_mass(body) * (real)fmax(r, 0.5 * (double)grid->h);
}

// Velocities of the nodes that a block's bins touch: `width` reals a node, the new velocity first and, for a width of
// 8, the old one from the fourth on.
// Returns the number of light nodes.
BRUNT_INLINE int load_window(const brunt_body *body, const brunt_block *block, real *window, light_node *light,
                             int width, int dim, int order) {
    const brunt_grid *grid = &body->grid;
    const int side = dim == 3 ? 4 : 8, span = side + order;
    const bool axisymmetric = dim == 2 && brunt_axisymmetric(&body->particles);
    real least = light_mass(body);
    int lights = 0;
    for (int x = 0; x < span; x++) {
        if (axisymmetric) least = axisymmetric_light_mass(body, block->coord[0] * side + x);
        for (int y = 0; y < span; y++) {
            int corner = (x >= side) * 2 + (y >= side), cx = x % side, cy = y % side;
            for (int half = 0; half < (dim == 3 ? 2 : 1); half++) {
                int slot = dim == 3 ? block->slot[corner * 2 + half] : block->slot[corner];
                int n = dim == 2 ? 1 : half ? order : side;
                const real *from = brunt_slot_nodes(grid, slot) + (dim == 3 ? (cx * 4 + cy) * 4 : cx * 8 + cy) * 8;
                real *to = window + (dim == 3 ? (x * span + y) * span + half * side : x * span + y) * width;
                for (int z = 0; z < n; z++, from += 8, to += width) {
                    node4_store(to, node4_load(from + BRUNT_NODE_VELOCITY));
                    if (width == 8) node4_store(to + 3, node4_load(from + BRUNT_NODE_OLD));
                    if (!(from[BRUNT_NODE_MASS] < least) || !(from[BRUNT_NODE_MASS] > 0)) continue;
                    light_node *node = &light[lights++];
                    *node = (light_node){.at = {(int16_t)x, (int16_t)y, (int16_t)(half * side + z)}};
                    for (int r = 0; r < dim; r++) {
                        node->change[r] = from[BRUNT_NODE_VELOCITY + r] - from[BRUNT_NODE_OLD + r];
                        to[r] = from[BRUNT_NODE_OLD + r];
                    }
                }
            }
        }
    }
    return lights;
}

// Adds what the light nodes changed by to the fields at the block's particles; `start` are its bins, `out` is as g2p
// fills it: velocity, gradient, affine field (if `affine`).
void brunt_add_light_nodes(const brunt_body *body, const brunt_block *block, const int32_t *start,
                           const light_node *light, int lights, real *const *out, bool affine);
