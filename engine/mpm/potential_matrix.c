// The Hessian of a bin: its particles share their kernels' nodes, so that the blocks of pairs of nodes are sums over
// the particles before they go to the matrix,
//   K_ij = sum_p sum_ab g_a (x) (a_iajb g_b) = G^T S_ij,
// G the slopes of all nodes by particle and direction (padded to whole vectors), S_ij = a_ij G, for i <= j. With P
// particles a product of N x dim P by dim P x N: 2 dim N^2 dim (dim + 1) / 2 operations a particle, 26,000 of the
// quadratic kernel in 3D, from registers of 3 or 4 rows by 4 vectors.
#include <string.h>

#include "mpm/potential_kernel.h"

enum { CHUNK = 8, COLUMNS = 4 }; // particles at a time; vectors of a row in registers

// Nodes of a kernel in whole vectors.
BRUNT_INLINE int padded_nodes(int dim, int order) {
    return (kernel_nodes(dim, order) + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
}

int64_t brunt_mpm_matrix_room(int dim, int order) {
    const int64_t n = padded_nodes(dim, order), pairs = dim * (dim + 1) / 2,
                  chunk = CHUNK > BRUNT_LANES ? CHUNK : BRUNT_LANES;
    return (pairs * n + 2 * chunk * dim) * n + BRUNT_LANES * n;
}

// K += G^T S of `rows` rows from A on and `columns` vectors from B on; `count` rows of G and S.
BRUNT_INLINE void tile_product(int rows, int columns, int stride, int count, const real *G, const real *S, real *K) {
    lanes sum[4][COLUMNS];
    for (int r = 0; r < rows; r++)
        for (int c = 0; c < columns; c++) sum[r][c] = lanes_load(K + r * stride + c * BRUNT_LANES);
    for (int k = 0; k < count; k++, G += stride, S += stride)
        for (int r = 0; r < rows; r++)
            for (int c = 0; c < columns; c++) sum[r][c] += G[r] * lanes_load(S + c * BRUNT_LANES);
    for (int r = 0; r < rows; r++)
        for (int c = 0; c < columns; c++) lanes_store(K + r * stride + c * BRUNT_LANES, sum[r][c]);
}

BRUNT_INLINE void product(int dim, int order, int count, const real *G, const real *S, real *K) {
    const int n = kernel_nodes(dim, order), stride = padded_nodes(dim, order), vectors = stride / BRUNT_LANES;
    const int rows = n % 4 == 0 ? 4 : 3;
    for (int A = 0; A < n; A += rows)
        for (int v = 0; v < vectors; v += COLUMNS) {
            const real *s = S + v * BRUNT_LANES;
            real *to = K + A * stride + v * BRUNT_LANES;
            if (vectors - v >= 4)
                tile_product(rows, 4, stride, count, G + A, s, to);
            else if (vectors - v == 3)
                tile_product(rows, 3, stride, count, G + A, s, to);
            else if (vectors - v == 2)
                tile_product(rows, 2, stride, count, G + A, s, to);
            else
                tile_product(rows, 1, stride, count, G + A, s, to);
        }
}

// Slopes of particles slot .. slot + BRUNT_LANES - 1, the first `some` of them, into rows of G.
BRUNT_INLINE void slopes(int dim, int order, const brunt_mpm_potential *p, const brunt_block *block, int64_t slot,
                         int some, real *G) {
    const int stride = padded_nodes(dim, order);
    kernel_lanes k;
    kernel_at(dim, order, p->body, block, slot, &k);
    for (int n = 0; n < kernel_nodes(dim, order); n++) {
        const kernel_node node = node_of(dim, order, &k, n);
        for (int l = 0; l < some; l++)
            for (int a = 0; a < dim; a++) G[(l * dim + a) * stride + n] = node.slope[a][l];
    }
}

// S_ij = a_ij G of one particle, `pair` = i dim + j.
BRUNT_INLINE void stretch(int dim, int stride, const brunt_mpm_potential *p, int64_t slot, int pair, const real *G,
                          real *S) {
    const int i = pair / dim, j = pair % dim;
    for (int a = 0; a < dim; a++) {
        real factor[3];
        for (int b = 0; b < dim; b++) {
            const int row = i * dim + a, column = j * dim + b, m = row < column ? row : column, n = row + column - m;
            factor[b] = p->tangent[m * (2 * dim * dim - m - 1) / 2 + n][slot];
        }
        for (int v = 0; v < stride; v += BRUNT_LANES) {
            lanes sum = factor[0] * lanes_load(G + v);
            for (int b = 1; b < dim; b++) sum += factor[b] * lanes_load(G + b * stride + v);
            lanes_store(S + a * stride + v, sum);
        }
    }
}

// K_ij of i <= j into the dense matrix of those nodes that are unknowns.
BRUNT_INLINE void spread(int dim, int order, const int *place, int count, const real *K, double *dense) {
    const int stride = padded_nodes(dim, order), n = kernel_nodes(dim, order), size = count * dim;
    for (int i = 0, pair = 0; i < dim; i++)
        for (int j = i; j < dim; j++, pair++) {
            const real *from = K + (size_t)pair * (size_t)n * (size_t)stride;
            for (int A = 0; A < count; A++)
                for (int B = i == j ? A : 0; B < count; B++) {
                    const double value = (double)from[place[A] * stride + place[B]];
                    dense[(A * dim + i) * size + B * dim + j] = value;
                    dense[(B * dim + j) * size + A * dim + i] = value;
                }
        }
}

BRUNT_INLINE void bin_matrix(int dim, int order, brunt_mpm_potential *p, int64_t s, double *dense, int worker) {
    const brunt_grid *grid = &p->body->grid;
    const int32_t b = p->bin[s] / BRUNT_BLOCK_NODES, bin = p->bin[s] % BRUNT_BLOCK_NODES;
    const brunt_block *block = &grid->blocks[b];
    const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS + bin;
    const int n = kernel_nodes(dim, order), stride = padded_nodes(dim, order), pairs = dim * (dim + 1) / 2;
    enum { MOST = CHUNK > BRUNT_LANES ? CHUNK : BRUNT_LANES };
    real *K = (real *)(p->matrix + (size_t)worker * (size_t)brunt_mpm_matrix_room(dim, order));
    real *G = K + (size_t)pairs * (size_t)n * (size_t)stride, *S = G + MOST * dim * stride;
    memset(K, 0, (size_t)pairs * (size_t)n * (size_t)stride * sizeof *K);
    memset(G, 0, (size_t)(MOST * dim * stride) * sizeof *G);
    for (int32_t first = start[0]; first < start[1]; first += MOST) {
        const int32_t some = start[1] - first < MOST ? start[1] - first : MOST;
        const int64_t slot = (int64_t)block->first + first;
        for (int32_t q = 0; q < some; q += BRUNT_LANES)
            slopes(dim, order, p, block, slot + q, some - q < BRUNT_LANES ? some - q : BRUNT_LANES,
                   G + q * dim * stride);
        for (int i = 0, pair = 0; i < dim; i++)
            for (int j = i; j < dim; j++, pair++) {
                for (int32_t q = 0; q < some; q++)
                    stretch(dim, stride, p, slot + q, i * dim + j, G + q * dim * stride, S + q * dim * stride);
                product(dim, order, some * dim, G, S, K + (size_t)pair * (size_t)n * (size_t)stride);
            }
    }
    int place[MOST_KERNEL], count = 0;
    const int x = dim == 3 ? bin >> 4 : bin >> 3, y = dim == 3 ? bin >> 2 & 3 : bin & 7, z = dim == 3 ? bin & 3 : 0;
    for (int k = 0; k < n; k++) {
        const int N = order + 1, i = dim == 3 ? k / (N * N) : k / N, j = dim == 3 ? k / N % N : k % N;
        if (p->number[window_node(grid, block, x + i, y + j, dim == 3 ? z + k % N : 0)] >= 0) place[count++] = k;
    }
    spread(dim, order, place, count, K, dense);
}

void brunt_mpm_bin_matrix(void *potential, int64_t stencil, double *dense, int worker) {
    brunt_mpm_potential *p = potential;
    switch (p->body->grid.dim * 10 + p->body->grid.order) {
    case 21: bin_matrix(2, 1, p, stencil, dense, worker); break;
    case 22: bin_matrix(2, 2, p, stencil, dense, worker); break;
    case 23: bin_matrix(2, 3, p, stencil, dense, worker); break;
    case 31: bin_matrix(3, 1, p, stencil, dense, worker); break;
    case 32: bin_matrix(3, 2, p, stencil, dense, worker); break;
    default: bin_matrix(3, 3, p, stencil, dense, worker); break;
    }
}
