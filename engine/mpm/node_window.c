#include "mpm/node_window.h"

#include "grid/bspline.h"

void brunt_add_light_nodes(const brunt_body *body, const brunt_block *block, const int32_t *start,
                           const light_node *light, int lights, real *const *out, bool affine) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, order = grid->order;
    real *const *x = brunt_kernel_position(&body->particles);
    for (const light_node *node = light; node < light + lights; node++)
        for (int k = 0; k < (dim == 3 ? (order + 1) * (order + 1) * (order + 1) : (order + 1) * (order + 1)); k++) {
            int number[3] = {0, 0, 0}, bin[3] = {0, 0, 0}; // the node's number in the bin's kernel; the bin
            bool inside = true;
            for (int a = dim - 1, rest = k; a >= 0; a--, rest /= order + 1) {
                number[a] = rest % (order + 1);
                bin[a] = node->at[a] - number[a];
                inside = inside && bin[a] >= 0 && bin[a] < grid->side;
            }
            if (!inside) continue;
            const int32_t *range = start + brunt_node_index(grid, bin[0], bin[1], bin[2]);
            for (int32_t s = range[0]; s < range[1]; s++) {
                real w[3] = {1, 1, 1}, g[3] = {0, 0, 0}, spread[3] = {1, 1, 1}, d[3] = {0, 0, 0};
                for (int a = 0; a < dim; a++) {
                    const real corner = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * grid->side));
                    lanes at = lanes_set(x[a][block->first + s]);
                    lanes u = local_coordinate(at, corner, grid->inv_h, lanes_set((real)bin[a])), weight[4], slope[4];
                    bspline_weights(order, u, weight);
                    bspline_slopes(order, u, grid->inv_h, slope);
                    w[a] = weight[number[a]][0], g[a] = slope[number[a]][0];
                    d[a] = ((real)number[a] - u[0]) * grid->h;
                    spread[a] = bspline_moment(order, at - (real)grid->origin[a], grid->h, grid->inv_h)[0];
                }
                real weight = w[0] * w[1] * w[2];
                const real slope[3] = {g[0] * w[1] * w[2], w[0] * g[1] * w[2], w[0] * w[1] * g[2]};
                for (int r = 0; r < dim; r++) {
                    out[r][s] += weight * node->change[r];
                    for (int a = 0; a < dim; a++) {
                        out[dim + r * dim + a][s] += slope[a] * node->change[r];
                        if (!affine) continue;
                        real share = order == 1 ? slope[a] : weight * d[a] / spread[a];
                        out[dim + dim * dim + r * dim + a][s] += share * node->change[r];
                    }
                }
            }
        }
}
