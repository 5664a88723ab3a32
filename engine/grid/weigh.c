#include "grid/weigh.h"

#include <math.h>

#include "grid/background.h"
#include "grid/bspline.h"
#include "grid/triangles.h"

// Cells from the base node along each axis, and that node.
static void find_base(const brunt_grid *grid, const double x[3], int32_t base[3], double u[3]) {
    for (int a = 0; a < grid->dim; a++) {
        const double at = (x[a] - grid->origin[a]) / (double)grid->h;
        base[a] = (int32_t)floor(at - 0.5 * (grid->order - 1));
        u[a] = at - base[a];
    }
}

static void weigh_spline(const brunt_grid *grid, const double x[3], double scale, brunt_grid_weights *out) {
    double w[3][4] = {{1}, {1}, {1}}, u[3];
    int32_t base[3] = {0, 0, 0};
    find_base(grid, x, base, u);
    for (int a = 0; a < grid->dim; a++) brunt_bspline_weights(grid->order, u[a], w[a]);
    const int deep = grid->dim == 3 ? grid->order : 0;
    out->count = 0;
    for (int i = 0; i <= grid->order; i++)
        for (int j = 0; j <= grid->order; j++)
            for (int k = 0; k <= deep; k++) {
                int32_t *at = out->at[out->count];
                at[0] = base[0] + i, at[1] = base[1] + j, at[2] = base[2] + k;
                out->weight[out->count++] = scale * w[0][i] * w[1][j] * w[2][k];
            }
}

static void weigh_cut_cell(const brunt_grid *grid, const double x[3], double scale, brunt_grid_weights *out) {
    double u[3];
    int32_t base[3] = {0, 0, 0};
    lanes w[4];
    find_base(grid, x, base, u);
    cut_cell_weights(lanes_set((real)u[0]), lanes_set((real)u[1]), w);
    out->count = 4;
    for (int n = 0; n < 4; n++) {
        out->at[n][0] = base[0] + n / 2, out->at[n][1] = base[1] + n % 2, out->at[n][2] = 0;
        out->weight[n] = scale * (double)w[n][0];
    }
}

static void weigh_triangle(const brunt_grid *grid, const double x[3], double scale, brunt_grid_weights *out) {
    const int32_t triangle = brunt_background_find(grid->mesh, x);
    double w[3];
    out->count = triangle < 0 ? 0 : 3;
    if (triangle < 0) return;
    brunt_background_weights(grid->mesh, triangle, x, w, NULL);
    for (int k = 0; k < 3; k++) {
        brunt_grid_mesh_node(grid->mesh->corner[triangle][k], out->at[k]);
        out->weight[k] = scale * w[k];
    }
}

void brunt_grid_weigh(const brunt_grid *grid, const double x[3], double scale, brunt_grid_weights *weights) {
    if (grid->kernel == BRUNT_GRID_MESH)
        weigh_triangle(grid, x, scale, weights);
    else if (grid->kernel == BRUNT_GRID_CUT)
        weigh_cut_cell(grid, x, scale, weights);
    else
        weigh_spline(grid, x, scale, weights);
}

static void slopes_of_spline(const brunt_grid *grid, const double x[3], double slope[BRUNT_KERNEL_NODES][3]) {
    double w[3][4] = {{1}, {1}, {1}}, g[3][4] = {{0}}, u[3];
    int32_t base[3] = {0, 0, 0};
    find_base(grid, x, base, u);
    for (int a = 0; a < grid->dim; a++)
        brunt_bspline_weights(grid->order, u[a], w[a]), brunt_bspline_slopes(grid->order, u[a], g[a]);
    const int N = grid->order + 1, deep = grid->dim == 3 ? N : 1;
    for (int n = 0; n < N * N * deep; n++) {
        const int i = n / (N * deep), j = n / deep % N, k = n % deep;
        slope[n][0] = g[0][i] * w[1][j] * w[2][k] / (double)grid->h;
        slope[n][1] = w[0][i] * g[1][j] * w[2][k] / (double)grid->h;
        slope[n][2] = w[0][i] * w[1][j] * g[2][k] / (double)grid->h;
    }
}

static void slopes_of_triangle(const brunt_grid *grid, const double x[3], double slope[BRUNT_KERNEL_NODES][3]) {
    const int32_t triangle = brunt_background_find(grid->mesh, x);
    double w[3], g[3][2];
    if (triangle < 0) return;
    brunt_background_weights(grid->mesh, triangle, x, w, g);
    for (int k = 0; k < 3; k++) slope[k][0] = g[k][0], slope[k][1] = g[k][1], slope[k][2] = 0;
}

void brunt_grid_slopes(const brunt_grid *grid, const double x[3], double slope[BRUNT_KERNEL_NODES][3]) {
    if (grid->kernel == BRUNT_GRID_MESH) {
        slopes_of_triangle(grid, x, slope);
    } else if (grid->kernel == BRUNT_GRID_CUT) {
        double u[3];
        int32_t base[3];
        lanes gx[4], gy[4];
        find_base(grid, x, base, u);
        cut_cell_slopes(lanes_set((real)u[0]), lanes_set((real)u[1]), grid->inv_h, gx, gy);
        for (int n = 0; n < 4; n++) slope[n][0] = (double)gx[n][0], slope[n][1] = (double)gy[n][0], slope[n][2] = 0;
    } else {
        slopes_of_spline(grid, x, slope);
    }
}
