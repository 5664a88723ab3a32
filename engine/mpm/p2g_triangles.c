// Masses and momenta of a block to its nodes where the grid is of triangles: what implicit steps begin with; and which
// nodes those are.
#include <string.h>

#include "mpm/potential_kernel.h"
#include "mpm/transfer.h"

BRUNT_INLINE void give_to_nodes(int kernel, brunt_body *body, int32_t b) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[b];
    const size_t size = (size_t)grid->span_nodes * BRUNT_NODE_REALS;
    real *buffer = grid->p2g_buffer + (size_t)b * size, *const *v = brunt_field(&body->particles, BRUNT_FIELD_velocity);
    const real *mass = brunt_field(&body->particles, BRUNT_FIELD_mass)[0];
    memset(buffer, 0, size * sizeof *buffer);
    for (int64_t s = block->first; s < block->first + block->count; s += BRUNT_LANES) {
        kernel_lanes k;
        kernel_at(2, kernel, body, block, s, &k);
        for (int n = 0; n < kernel_nodes(2, kernel); n++) {
            const kernel_node node = node_of(2, kernel, &k, n);
            for (int l = 0; l < BRUNT_LANES; l++) { // copies behind the last particle have no mass
                real *to = buffer + (size_t)(k.base[l] + node.at) * BRUNT_NODE_REALS;
                const real m = node.weight[l] * mass[s + l];
                to[BRUNT_NODE_MASS] += m;
                for (int a = 0; a < 2; a++) to[BRUNT_NODE_VELOCITY + a] += m * v[a][s + l];
            }
        }
    }
}

void brunt_p2g_triangles(brunt_body *body, int32_t block, real dt) {
    BRUNT_ASSERT(dt == 0);
    if (body->grid.kernel == BRUNT_GRID_MESH)
        give_to_nodes(BRUNT_GRID_MESH, body, block);
    else
        give_to_nodes(BRUNT_GRID_CUT, body, block);
}

void brunt_body_mark_reached(const brunt_body *body, uint8_t *mark) {
    const brunt_grid *grid = &body->grid;
    if (grid->kernel != BRUNT_GRID_CUT) {
        brunt_grid_mark_reached(grid, mark);
        return;
    }
    for (int32_t b = 0; b < grid->block_count; b++) {
        const brunt_block *block = &grid->blocks[b];
        for (int64_t s = block->first; s < block->first + block->count; s += BRUNT_LANES) {
            kernel_lanes k;
            kernel_at(2, BRUNT_GRID_CUT, body, block, s, &k);
            for (int n = 0; n < 4; n++)
                for (int l = 0; l < BRUNT_LANES && s + l < block->first + block->count; l++) {
                    const int bin = body->particles.bin[s + l];
                    if (k.g[0][n][l] != 0 || k.g[1][n][l] != 0)
                        mark[window_node(grid, block, (bin >> 3) + n / 2, (bin & 7) + n % 2, 0)] = 1;
                }
        }
    }
}
