#include "contact/search/point_surface.h"

#include <math.h>

#include "base/array.h"
#include "base/memory.h"
#include "contact/distance/particle_extent.h"
#include "grid/bspline.h"

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void brunt_neighbours_free(brunt_neighbours *list) {
    brunt_free(list->near);
    brunt_cloud_free(&list->centres);
}

double brunt_point_extent(brunt_body *body, int64_t s, const double n[3]) {
    const double reach = (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s],
                 along = brunt_extent_along(body, s, n);
    return reach > body->spacing ? along * body->spacing / reach : along;
}

double brunt_point_stretch(brunt_body *body, int64_t s) {
    const int dim = body->grid.dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    double square = 0;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++)
            square += (double)F[r * body->particles.point_dim + c][s] * (double)F[r * body->particles.point_dim + c][s];
    return fmax(1, sqrt(square / dim));
}

double brunt_point_support(brunt_body *body, const brunt_neighbours *list, const double n[3]) {
    double most = -INFINITY;
    for (int32_t i = 0; i < list->near_count; i++)
        most = fmax(most, dot(list->near[i].d, n) + brunt_point_extent(body, list->near[i].particle, n));
    return most;
}

// ------------------------------------------------------------------------------------------ what is near

// Where a search looks: within `range` of x, in the bins `low` to `high`.
typedef struct ball {
    double x[3], range;
    int32_t low[3], high[3];
} ball;

// Adds the particles of slots `from` to `to` (not included) that are in the ball. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
static int add_near(brunt_body *body, const ball *in, int32_t block, const int64_t slots[2], brunt_neighbours *list,
                    brunt_error *error) {
    const int dim = body->grid.dim;
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    const real *mass = brunt_field(&body->particles, BRUNT_FIELD_mass)[0];
    for (int64_t s = slots[0]; s < slots[1]; s++) {
        brunt_neighbour n = {.block = block, .particle = s};
        for (int a = 0; a < dim; a++) n.d[a] = (double)place[a][s] - in->x[a];
        if (!(dot(n.d, n.d) < in->range * in->range) || !(mass[s] > 0)) continue;
        if (BRUNT_CAPACITY_MORE(list->near, "particles about a place", error)) return BRUNT_FAILED;
        list->near[list->near_count++] = n;
    }
    return BRUNT_OK;
}

static int add_block(brunt_body *body, const ball *in, int32_t b, brunt_neighbours *list, brunt_error *error) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, last = dim - 1;
    int from[3] = {0}, to[3] = {0};
    for (int a = 0; a < dim; a++) {
        const int32_t base = grid->blocks[b].coord[a] * grid->side;
        from[a] = in->low[a] > base ? in->low[a] - base : 0;
        to[a] = in->high[a] < base + grid->side - 1 ? in->high[a] - base : grid->side - 1;
    }
    const int32_t *start = grid->bin_start + (int64_t)b * BRUNT_BIN_STARTS;
    const int64_t first = grid->blocks[b].first;
    for (int i = from[0]; i <= to[0]; i++)
        for (int k = dim == 3 ? from[1] : 0; k <= (dim == 3 ? to[1] : 0); k++) {
            int bin[3] = {i, k, 0}, end[3] = {i, k, 0};
            bin[last] = from[last], end[last] = to[last];
            const int64_t slots[2] = {first + start[brunt_node_index(grid, bin[0], bin[1], bin[2])],
                                      first + start[brunt_node_index(grid, end[0], end[1], end[2]) + 1]};
            if (add_near(body, in, b, slots, list, error)) return BRUNT_FAILED;
        }
    return BRUNT_OK;
}

int brunt_neighbours_find(brunt_body *body, double range, const double x[3], brunt_neighbours *list,
                          brunt_error *error) {
    const brunt_grid *grid = &body->grid;
    ball in = {.range = range};
    int32_t first[3] = {0}, last[3] = {0}, c[3];
    for (int a = 0; a < grid->dim; a++) {
        const double at = (x[a] - grid->origin[a]) / (double)grid->h - 0.5 * (grid->order - 1),
                     by = range / (double)grid->h;
        in.x[a] = x[a];
        in.low[a] = (int32_t)floor(at - by), in.high[a] = (int32_t)floor(at + by);
        first[a] = (int32_t)floor((double)in.low[a] / grid->side);
        last[a] = (int32_t)floor((double)in.high[a] / grid->side);
    }
    list->near_count = 0;
    for (c[0] = first[0]; c[0] <= last[0]; c[0]++)
        for (c[1] = first[1]; c[1] <= last[1]; c[1]++)
            for (c[2] = first[2]; c[2] <= last[2]; c[2]++) {
                const int32_t b = brunt_grid_block(grid, brunt_key(c));
                if (b >= 0 && add_block(body, &in, b, list, error)) return BRUNT_FAILED;
            }
    return BRUNT_OK;
}

int brunt_neighbours_centres(brunt_neighbours *list, double range, brunt_error *error) {
    if (brunt_cloud_reserve(&list->centres, list->near_count, error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < list->near_count; i++)
        if (dot(list->near[i].d, list->near[i].d) < range * range) brunt_cloud_point(&list->centres, list->near[i].d);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ which way is out

bool brunt_point_outward(const brunt_grid *grid, const double x[3], double n[3]) {
    const int dim = grid->dim, count = grid->order + 1;
    int32_t base[3] = {0};
    double w[3][4] = {{1}, {1}, {1}}, g[3][4] = {{0}};
    for (int a = 0; a < dim; a++) {
        const double u = (x[a] - grid->origin[a]) / (double)grid->h;
        base[a] = (int32_t)floor(u - 0.5 * (grid->order - 1));
        brunt_bspline_weights(grid->order, u - base[a], w[a]);
        brunt_bspline_slopes(grid->order, u - base[a], g[a]);
    }
    for (int a = 0; a < 3; a++) n[a] = 0;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            for (int k = 0; k < (dim == 3 ? count : 1); k++) {
                const int32_t at[3] = {base[0] + i, base[1] + j, base[2] + k};
                const real *node = brunt_grid_node(grid, at);
                if (!node) continue;
                const double mass = (double)node[BRUNT_NODE_MASS];
                n[0] -= mass * g[0][i] * w[1][j] * w[2][k];
                n[1] -= mass * w[0][i] * g[1][j] * w[2][k];
                if (dim == 3) n[2] -= mass * w[0][i] * w[1][j] * g[2][k];
            }
    const double size = sqrt(dot(n, n));
    if (!(size > 0) || !isfinite(size)) return false;
    for (int a = 0; a < 3; a++) n[a] /= size;
    return true;
}
