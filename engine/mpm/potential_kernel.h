// What the passes of an implicit step over material points share: a block's window of nodal values, and the weights of
// a vector of particles there.
//
// A window holds the nodes that a block's bins touch, z fastest, `width` doubles each; nodes that are no unknowns are
// 0.
#pragma once

#include "base/simd_math.h"
#include "grid/background.h"
#include "grid/bspline.h"
#include "grid/triangles.h"
#include "linear/block_matrix.h"
#include "mpm/potential.h"

enum { WINDOW_LIMIT = 7 * 7 * 7, TILE_LIMIT = 64, KERNEL_LIMIT = 64 };

typedef struct mpm_block_result {
    double kinetic, grid_kinetic;
} mpm_block_result;

struct brunt_mpm_potential {
    brunt_body *body;
    const int32_t *number; // of the step
    bool history;          // the material looks at what the step did
    real dt;
    brunt_trial_rule rule;
    int threads;
    bool whole; // the tangent is not symmetric
    // Of the last Hessian: V0 a, pulled back to the configuration of the grid; a slot each.
    real *tangent[BRUNT_TANGENT_LIMIT];
    real *slab;
    size_t slab_capacity;
    double *force; // block_count x span_nodes x dim
    size_t force_capacity;
    double moduli;            // [J] m c^2
    brunt_energy_sum *energy; // a block each, as the two below
    double *limit;
    mpm_block_result *result;
    size_t energy_capacity, limit_capacity, result_capacity;
    // Stencils of step number `step`: bins with particles, in the order of blocks.
    int64_t step, stencil_count, *first;
    int32_t *node;
    size_t first_capacity, node_capacity;
    // Assembly (potential_matrix.c): blocks by colour; room for the sums of a bin, places in rows, a thread each.
    int32_t *coloured, colour_first[9], *place;
    double *matrix;
    int64_t matrix_size, place_size;
    size_t coloured_capacity, place_capacity, matrix_capacity;
};

// Kernels have the numbers of grid.h: those of triangles are linear.
BRUNT_INLINE int kernel_order(int kernel) { return kernel > BRUNT_CUBIC ? BRUNT_LINEAR : kernel; }

// Nodes of a kernel.
BRUNT_INLINE int kernel_nodes(int dim, int kernel) {
    const int N = kernel_order(kernel) + 1;
    if (kernel == BRUNT_GRID_MESH) return 3;
    return dim == 3 ? N * N * N : N * N;
}

// Of a window of a lattice: nodes along an edge. Of a mesh a window is the corners of its triangles, three a bin.
BRUNT_INLINE int window_span(int dim, int kernel) { return (dim == 3 ? 4 : 8) + kernel_order(kernel); }
BRUNT_INLINE int window_nodes(int dim, int kernel) {
    const int span = window_span(dim, kernel);
    if (kernel == BRUNT_GRID_MESH) return BRUNT_MESH_CORNERS;
    return dim == 3 ? span * span * span : span * span;
}

// How far node n of a kernel is from its first in the window.
BRUNT_INLINE int place_in_window(int dim, int kernel, int n) {
    const int N = kernel_order(kernel) + 1, span = window_span(dim, kernel);
    if (kernel == BRUNT_GRID_MESH) return n;
    return dim == 3 ? (n / (N * N) * span + n / N % N) * span + n % N : n / N * span + n % N;
}

// The corners of a block's triangles, as places in `number`; -1: there is no triangle.
static inline const int32_t *corners_of(const brunt_grid *grid, const brunt_block *block) {
    return grid->corner + (block - grid->blocks) * BRUNT_MESH_CORNERS;
}

// Place in `number` of the node at x, y, z of a block's window.
static inline int64_t window_node(const brunt_grid *grid, const brunt_block *block, int x, int y, int z) {
    const int side = grid->side;
    if (grid->dim == 2) {
        const int corner = (x >= side) * 2 + (y >= side);
        return (int64_t)block->slot[corner] * BRUNT_BLOCK_NODES + (x % side) * 8 + y % side;
    }
    const int corner = (x >= side) * 4 + (y >= side) * 2 + (z >= side);
    return (int64_t)block->slot[corner] * BRUNT_BLOCK_NODES + ((x % side) * 4 + y % side) * 4 + z % side;
}

static inline void fill_corners(const brunt_mpm_potential *p, const brunt_block *block, const double *values,
                                double *window) {
    const int32_t *corner = corners_of(&p->body->grid, block);
    for (int c = 0; c < BRUNT_MESH_CORNERS; c++, window += 2) {
        const int32_t n = corner[c] >= 0 ? p->number[corner[c]] : BRUNT_NONE;
        for (int i = 0; i < 2; i++) window[i] = n >= 0 ? values[(int64_t)n * 2 + i] : 0;
    }
}

static inline void fill_window(const brunt_mpm_potential *p, const brunt_block *block, const double *values,
                               double *window) {
    const brunt_grid *grid = &p->body->grid;
    if (grid->mesh) {
        fill_corners(p, block, values, window);
        return;
    }
    const int dim = grid->dim, span = grid->span;
    for (int x = 0; x < span; x++)
        for (int y = 0; y < span; y++)
            for (int z = 0; z < (dim == 3 ? span : 1); z++, window += dim) {
                const int32_t n = p->number[window_node(grid, block, x, y, z)];
                for (int i = 0; i < dim; i++) window[i] = n >= 0 ? values[(int64_t)n * dim + i] : 0;
            }
}

// A vector of particles: local coordinates, weights and slopes along each axis, and where their kernels begin in the
// window. Of triangles w[0] are the weights of the nodes themselves, g[0] and g[1] their slopes along x and y.
typedef struct kernel_lanes {
    lanes local[3], w[3][4], g[3][4];
    int base[BRUNT_LANES];
    bool same; // all of one bin: nodes are read and written once for all
} kernel_lanes;

BRUNT_INLINE void see_if_same(kernel_lanes *k) {
    k->same = true;
    for (int l = 1; l < BRUNT_LANES; l++) k->same &= k->base[l] == k->base[0];
}

// Of the triangles of a mesh that the particles were found in.
static inline void mesh_kernel_at(const brunt_body *body, const brunt_block *block, int64_t slot, kernel_lanes *k) {
    const brunt_particles *particles = &body->particles;
    real *const *x = brunt_kernel_position(particles);
    for (int l = 0; l < BRUNT_LANES; l++) {
        const int bin = particles->bin[slot + l];
        const double at[2] = {(double)x[0][slot + l], (double)x[1][slot + l]};
        double w[3], slope[3][2];
        k->base[l] = 3 * bin;
        brunt_background_weights(body->grid.mesh, block->coord[0] * BRUNT_BLOCK_NODES + bin, at, w, slope);
        for (int n = 0; n < 3; n++) {
            k->w[0][n][l] = (real)w[n];
            for (int a = 0; a < 2; a++) k->g[a][n][l] = (real)slope[n][a];
        }
    }
    see_if_same(k);
}

BRUNT_INLINE void kernel_at(int dim, int kernel, const brunt_body *body, const brunt_block *block, int64_t slot,
                            kernel_lanes *k) {
    const brunt_grid *grid = &body->grid;
    const brunt_particles *particles = &body->particles;
    const int side = dim == 3 ? 4 : 8, span = window_span(dim, kernel);
    real *const *x = brunt_kernel_position(particles);
    int bins[3][BRUNT_LANES];
    if (kernel == BRUNT_GRID_MESH) {
        mesh_kernel_at(body, block, slot, k);
        return;
    }
    for (int l = 0; l < BRUNT_LANES; l++) {
        const int bin = particles->bin[slot + l];
        bins[0][l] = dim == 3 ? bin >> 4 : bin >> 3;
        bins[1][l] = dim == 3 ? bin >> 2 & 3 : bin & 7;
        bins[2][l] = dim == 3 ? bin & 3 : 0;
        k->base[l] = bins[0][l] * span + bins[1][l];
        if (dim == 3) k->base[l] = k->base[l] * span + bins[2][l];
    }
    see_if_same(k);
    for (int a = 0; a < dim; a++) {
        const real corner = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * side));
        lanes bin;
        for (int l = 0; l < BRUNT_LANES; l++) bin[l] = (real)bins[a][l];
        k->local[a] = (lanes_load(x[a] + slot) - corner) * grid->inv_h - bin;
        if (kernel == BRUNT_GRID_CUT) continue;
        bspline_weights(kernel, k->local[a], k->w[a]);
        bspline_slopes(kernel, k->local[a], grid->inv_h, k->g[a]);
    }
    if (kernel != BRUNT_GRID_CUT) return;
    cut_cell_weights(k->local[0], k->local[1], k->w[0]);
    cut_cell_slopes(k->local[0], k->local[1], grid->inv_h, k->g[0], k->g[1]);
}

// Weight and slopes of node n of the kernels, z fastest; and how far it is from their first in the window.
typedef struct kernel_node {
    lanes weight, slope[3];
    int at, index[3];
} kernel_node;

BRUNT_INLINE kernel_node node_of(int dim, int kernel, const kernel_lanes *k, int n) {
    const int N = kernel_order(kernel) + 1, span = window_span(dim, kernel);
    kernel_node out;
    if (kernel > BRUNT_CUBIC) {
        out.weight = k->w[0][n];
        out.slope[0] = k->g[0][n], out.slope[1] = k->g[1][n];
        out.at = place_in_window(dim, kernel, n);
        return out;
    }
    if (dim == 2) {
        const int i = n / N, j = n % N;
        out.weight = k->w[0][i] * k->w[1][j];
        out.slope[0] = k->g[0][i] * k->w[1][j], out.slope[1] = k->w[0][i] * k->g[1][j];
        out.at = i * span + j;
        out.index[0] = i, out.index[1] = j;
        return out;
    }
    const int i = n / (N * N), j = n / N % N, m = n % N;
    const lanes xy = k->w[0][i] * k->w[1][j];
    out.weight = xy * k->w[2][m];
    out.slope[0] = k->g[0][i] * k->w[1][j] * k->w[2][m];
    out.slope[1] = k->w[0][i] * k->g[1][j] * k->w[2][m];
    out.slope[2] = xy * k->g[2][m];
    out.at = (i * span + j) * span + m;
    out.index[0] = i, out.index[1] = j, out.index[2] = m;
    return out;
}

// The window's values at a node of the kernels; `same` is k->same, or false.
BRUNT_INLINE void window_values(int dim, bool same, const double *window, const kernel_lanes *k, int at, lanes out[3]) {
    if (same) {
        for (int i = 0; i < dim; i++) out[i] = lanes_set((real)window[(k->base[0] + at) * dim + i]);
        return;
    }
    for (int l = 0; l < BRUNT_LANES; l++)
        for (int i = 0; i < dim; i++) out[i][l] = (real)window[(k->base[l] + at) * dim + i];
}

BRUNT_INLINE void field_of(int dim, int kernel, bool same, const double *window, const kernel_lanes *k, lanes *mean,
                           lanes H[9]) {
    for (int c = 0; c < dim * dim; c++) H[c] = lanes_set(0);
    for (int i = 0; i < dim && mean; i++) mean[i] = lanes_set(0);
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, k, n);
        lanes u[3] = {lanes_set(0), lanes_set(0), lanes_set(0)};
        window_values(dim, same, window, k, node.at, u);
        for (int i = 0; i < dim; i++) {
            if (mean) mean[i] += node.weight * u[i];
            for (int j = 0; j < dim; j++) H[i * dim + j] += u[i] * node.slope[j];
        }
    }
}

// sum w u (NULL: not wanted) and sum u (x) slope.
BRUNT_INLINE void field_at(int dim, int kernel, const double *window, const kernel_lanes *k, lanes *mean, lanes H[9]) {
    if (k->same)
        field_of(dim, kernel, true, window, k, mean, H);
    else
        field_of(dim, kernel, false, window, k, mean, H);
}

// The nodes of bins with particles follow one another in a window: the first one's place.
BRUNT_INLINE int bin_base(int dim, int kernel, int bin) {
    const int span = window_span(dim, kernel);
    if (kernel == BRUNT_GRID_MESH) return 3 * bin;
    return dim == 3 ? ((bin >> 4) * span + (bin >> 2 & 3)) * span + (bin & 3) : (bin >> 3) * span + (bin & 7);
}

// A tile of particles of a block: what they would be.
typedef struct mpm_tile {
    real F[9][TILE_LIMIT], f[9][TILE_LIMIT], density[TILE_LIMIT], stress[9][TILE_LIMIT];
    double *force; // of the block's nodes, for the gradient
} __attribute__((aligned(64))) mpm_tile;

// f = I + H and F = f F_old of a vector, number `at` of the tile.
BRUNT_INLINE void deform_points(int dim, brunt_body *body, int64_t slot, const lanes H[9], mpm_tile *tile, int32_t at) {
    real *const *was = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            lanes old = lanes_load(was[i * dim + j] + slot), change = lanes_set(0);
            for (int k = 0; k < dim; k++) change += H[i * dim + k] * lanes_load(was[k * dim + j] + slot);
            lanes_store(tile->F[i * dim + j] + at, old + change);
            lanes_store(tile->f[i * dim + j] + at, H[i * dim + j] + (real)(i == j));
        }
}

// The tile's trial of each component.
static inline void trial_tile(brunt_mpm_potential *p, int64_t slot, int32_t count, mpm_tile *tile,
                              brunt_trial_points trial[BRUNT_COMPONENTS]) {
    const int dim = p->body->particles.dim;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        trial[k] = (brunt_trial_points){.count = count, .dim = dim, .dt = p->dt, .rule = p->rule};
        if (!p->body->material.model[k]) continue;
        const brunt_material_points points = brunt_body_points(p->body, (brunt_component)k, slot, count);
        for (int c = 0; c < dim * dim; c++) trial[k].F[c] = tile->F[c], trial[k].f[c] = tile->f[c];
        for (int s = 0; s < BRUNT_MAX_STATE; s++) trial[k].state[s] = points.state[s];
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) trial[k].old_stress[c] = points.stress[c];
        trial[k].volume = points.volume;
    }
}

// What a sum over the windows of blocks goes to.
typedef struct mpm_gather {
    const brunt_mpm_potential *p;
    double *out; // of each unknown `stride` numbers, the first `dim` of which are added to
    int stride;
} mpm_gather;
// potential.c: adds what the blocks' windows have in `force`, at each node in the order of blocks.
void brunt_mpm_gather(mpm_gather *gather, const brunt_team *team);
// potential_product.c: once tangents are there, as those of the term (term.h).
void brunt_mpm_add_diagonal(brunt_mpm_potential *p, const brunt_team *team, brunt_block_matrix *blocks);
void brunt_mpm_add_product(brunt_mpm_potential *p, const brunt_team *team, const double *x, double *y);

// potential_matrix.c: room and colours of a step (BRUNT_OK, or BRUNT_FAILED: out of memory); and the Hessian, once
// tangents are there.
int brunt_mpm_matrix_reserve(brunt_mpm_potential *p, brunt_error *error);
void brunt_mpm_add_matrix(brunt_mpm_potential *p, const brunt_team *team, brunt_block_matrix *m);
