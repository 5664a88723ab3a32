// The Hessian, bin by bin: its particles share their kernels' nodes, so that the blocks of pairs of nodes are sums over
// the particles before they go to the matrix,
//   K_ij = sum_p sum_ab g_a (x) (a_iajb g_b) = G^T S_ij,
// G the slopes of all nodes by particle and direction (padded to whole vectors), S_ij = a_ij G, for i <= j. With P
// particles a product of N x dim P by dim P x N: 2 dim N^2 dim (dim + 1) / 2 operations a particle, 26,000 of the
// quadratic kernel in 3D, from registers of 3 or 4 rows by 4 vectors. Of K_ii, which is symmetric, the vectors from the
// diagonal on.
//
// Blocks of the grid whose coordinates are all of the same parity share no node, since kernels reach less far than a
// block: these 2^dim colours follow one another, the blocks of one side by side, the bins of a block in their order.
// What an entry is the sum of does not depend on the number of threads, and a block's rows stay in the cache. Blocks of
// a mesh may all share nodes: they follow one another, one thread adds them.
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "mpm/instances.h"
#include "mpm/potential_kernel.h"

enum { CHUNK = 8, COLUMNS = 4 }; // particles at a time; vectors of a row in registers

// Nodes of a kernel in whole vectors.
BRUNT_INLINE int padded_nodes(int dim, int kernel) {
    return (kernel_nodes(dim, kernel) + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
}

// Pairs of components: K_ij, i <= j where the tangent is symmetric.
static inline int block_pairs(const brunt_mpm_potential *p, int dim) {
    return p->whole ? dim * dim : dim * (dim + 1) / 2;
}

// Nodes within reach of a node.
BRUNT_INLINE int stencil_width(int dim, int kernel) {
    const int wide = 2 * kernel_order(kernel) + 1;
    return dim == 3 ? wide * wide * wide : wide * wide;
}

int brunt_mpm_matrix_reserve(brunt_mpm_potential *p, brunt_error *error) {
    const brunt_grid *grid = &p->body->grid;
    const int dim = grid->dim, kernel = grid->kernel;
    const int64_t n = padded_nodes(dim, kernel), pairs = block_pairs(p, dim),
                  chunk = CHUNK > BRUNT_LANES ? CHUNK : BRUNT_LANES;
    p->matrix_size = (pairs * n + 2 * chunk * dim) * n + BRUNT_LANES * n;
    p->place_size = (int64_t)grid->span_nodes * stencil_width(dim, kernel);
    if (BRUNT_CAPACITY(p->matrix, (size_t)(p->threads * p->matrix_size), 0, "values of matrices of blocks of particles",
                       error) ||
        BRUNT_CAPACITY(p->place, (size_t)(p->threads * p->place_size), 0, "places of nodes in a matrix", error) ||
        BRUNT_CAPACITY(p->coloured, (size_t)grid->block_count, 0, "blocks of particles", error))
        return BRUNT_FAILED;
    int32_t count = 0;
    for (int colour = 0; colour < grid->corners; colour++) {
        p->colour_first[colour] = count;
        for (int32_t b = 0; b < grid->block_count; b++) {
            int parity = 0;
            for (int a = 0; a < dim && !grid->mesh; a++) parity = 2 * parity + (grid->blocks[b].coord[a] & 1);
            if (parity == colour) p->coloured[count++] = b;
        }
    }
    p->colour_first[grid->corners] = count;
    return BRUNT_OK;
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

// `symmetric`: not what lies before the diagonal.
BRUNT_INLINE void product(int dim, int kernel, bool symmetric, int count, const real *G, const real *S, real *K) {
    const int n = kernel_nodes(dim, kernel), stride = padded_nodes(dim, kernel), vectors = stride / BRUNT_LANES;
    const int rows = n % 4 == 0 ? 4 : 3;
    for (int A = 0; A < n; A += rows)
        for (int v = symmetric ? A / BRUNT_LANES : 0; v < vectors; v += COLUMNS) {
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
BRUNT_INLINE void slopes(int dim, int kernel, const brunt_mpm_potential *p, const brunt_block *block, int64_t slot,
                         int some, real *G) {
    const int stride = padded_nodes(dim, kernel);
    kernel_lanes k;
    kernel_at(dim, kernel, p->body, block, slot, &k);
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, &k, n);
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
            factor[b] = p->tangent[brunt_tangent_place(p->whole, dim, i * dim + a, j * dim + b)][slot];
        }
        for (int v = 0; v < stride; v += BRUNT_LANES) {
            lanes sum = factor[0] * lanes_load(G + v);
            for (int b = 1; b < dim; b++) sum += factor[b] * lanes_load(G + b * stride + v);
            lanes_store(S + a * stride + v, sum);
        }
    }
}

// The sums K_ij, i <= j where the tangent is symmetric, of the particles first .. end - 1 of a block.
BRUNT_INLINE void bin_sums(int dim, int kernel, const brunt_mpm_potential *p, const brunt_block *block,
                           const int32_t particles[2], real *K) {
    enum { CHUNK_LIMIT = CHUNK > BRUNT_LANES ? CHUNK : BRUNT_LANES };
    const int n = kernel_nodes(dim, kernel), stride = padded_nodes(dim, kernel), pairs = block_pairs(p, dim);
    real *G = K + (size_t)pairs * (size_t)n * (size_t)stride, *S = G + CHUNK_LIMIT * dim * stride;
    memset(K, 0, (size_t)pairs * (size_t)n * (size_t)stride * sizeof *K);
    for (int32_t first = particles[0]; first < particles[1]; first += CHUNK_LIMIT) {
        const int32_t some = particles[1] - first < CHUNK_LIMIT ? particles[1] - first : CHUNK_LIMIT;
        const int64_t slot = (int64_t)block->first + first;
        for (int32_t q = 0; q < some; q += BRUNT_LANES)
            slopes(dim, kernel, p, block, slot + q, some - q < BRUNT_LANES ? some - q : BRUNT_LANES,
                   G + q * dim * stride);
        for (int i = 0, pair = 0; i < dim; i++)
            for (int j = p->whole ? 0 : i; j < dim; j++, pair++) {
                for (int32_t q = 0; q < some; q++)
                    stretch(dim, stride, p, slot + q, i * dim + j, G + q * dim * stride, S + q * dim * stride);
                product(dim, kernel, i == j && !p->whole, some * dim, G, S,
                        K + (size_t)pair * (size_t)n * (size_t)stride);
            }
    }
}

// A block's nodes in the matrix.
typedef struct block_rows {
    int32_t number[WINDOW_LIMIT]; // of the window's nodes; -1: no unknown
    double *row[WINDOW_LIMIT];    // where their rows begin
    int32_t *place;               // of each node: how many blocks along its row the nodes within reach are
} block_rows;

// `mark`: a number for each node, of no value before and after. Places of nodes that no bin couples say nothing.
BRUNT_INLINE void find_rows(int dim, int kernel, const brunt_mpm_potential *p, const brunt_block *block,
                            const brunt_block_matrix *m, int32_t *mark, block_rows *rows) {
    const brunt_grid *grid = &p->body->grid;
    const int order = kernel_order(kernel), span = window_span(dim, kernel), wide = 2 * order + 1,
              deep = dim == 3 ? span : 1;
    for (int w = 0; w < span * span * deep; w++)
        rows->number[w] = p->number[window_node(grid, block, w / (span * deep), w / deep % span, w % deep)];
    for (int w = 0; w < span * span * deep; w++) {
        if (rows->number[w] < 0) continue;
        const int at[3] = {w / (span * deep), w / deep % span, w % deep};
        const int64_t from = m->first[rows->number[w]], to = m->first[rows->number[w] + 1];
        int low[3], high[3];
        for (int a = 0; a < 3; a++) {
            const int last = a < dim ? span - 1 : 0;
            low[a] = at[a] < order ? 0 : at[a] - order, high[a] = at[a] + order < last ? at[a] + order : last;
        }
        rows->row[w] = m->value + from * dim * dim;
        for (int64_t k = from; k < to; k++) mark[m->column[k]] = (int32_t)(k - from);
        for (int x = low[0]; x <= high[0]; x++)
            for (int y = low[1]; y <= high[1]; y++)
                for (int z = low[2]; z <= high[2]; z++) {
                    const int32_t other = rows->number[(x * span + y) * deep + z];
                    int off = (x - at[0] + order) * wide + y - at[1] + order;
                    if (dim == 3) off = off * wide + z - at[2] + order;
                    if (other >= 0) rows->place[w * stencil_width(dim, kernel) + off] = mark[other];
                }
    }
}

// Adds K_ij of nodes A and B: of a symmetric tangent, A <= B and i <= j, to four places; of another, to its own.
BRUNT_INLINE void add_pair(bool whole, int dim, int plane, const real *AB, const real *BA, double *there,
                           double *back) {
    const bool same = AB == BA;
    for (int i = 0, pair = 0; i < dim; i++)
        for (int j = whole ? 0 : i; j < dim; j++, pair++) {
            const double ij = (double)AB[pair * plane];
            there[i * dim + j] += ij;
            if (whole) {
                if (!same) back[i * dim + j] += (double)BA[pair * plane];
                continue;
            }
            const double ji = i == j ? ij : (double)BA[pair * plane];
            if (i != j) there[j * dim + i] += ji;
            if (same) continue;
            back[j * dim + i] += ij;
            if (i != j) back[i * dim + j] += ji;
        }
}

typedef double four __attribute__((vector_size(32)));

BRUNT_INLINE void add_four(double *to, four more) {
    four sum;
    memcpy(&sum, to, sizeof sum);
    sum += more;
    memcpy(to, &sum, sizeof sum);
}

// The same in 2D, of a symmetric tangent: a block is a vector.
BRUNT_INLINE void add_flat_pair(int plane, const real *AB, const real *BA, double *there, double *back) {
    const double xx = (double)AB[0], xy = (double)AB[plane], yx = (double)BA[plane], yy = (double)AB[2 * plane];
    add_four(there, (four){xx, xy, yx, yy});
    if (AB != BA) add_four(back, (four){xx, yx, xy, yy});
}

// Adds the sums of the bin whose kernels begin at node `base` of the window.
BRUNT_INLINE void add_bin(bool whole, int dim, int kernel, const block_rows *rows, int base, const real *K) {
    const int order = kernel_order(kernel), N = order + 1, wide = 2 * order + 1, size = dim * dim,
              all = stencil_width(dim, kernel);
    const int n = kernel_nodes(dim, kernel), stride = padded_nodes(dim, kernel), plane = n * stride;
    int window[KERNEL_LIMIT], off[KERNEL_LIMIT];
    for (int k = 0; k < n; k++) {
        const int x = dim == 3 ? k / (N * N) : k / N, y = dim == 3 ? k / N % N : k % N, z = k % N;
        window[k] = base + place_in_window(dim, kernel, k);
        off[k] = dim == 3 ? (x * wide + y) * wide + z : x * wide + y;
    }
    for (int A = 0; A < n; A++) {
        const int w = window[A];
        if (rows->number[w] < 0) continue;
        for (int B = A; B < n; B++) {
            const int v = window[B], way = off[B] - off[A];
            if (rows->number[v] < 0) continue;
            double *there = rows->row[w] + rows->place[w * all + all / 2 + way] * size,
                   *back = rows->row[v] + rows->place[v * all + all / 2 - way] * size;
            if (dim == 2 && !whole)
                add_flat_pair(plane, K + A * stride + B, K + B * stride + A, there, back);
            else
                add_pair(whole, dim, plane, K + A * stride + B, K + B * stride + A, there, back);
        }
    }
}

// Adds the sums of a triangle of a mesh, whose corners are these places in `number`.
static void add_triangle(const brunt_mpm_potential *p, const int32_t *corner, const real *K, brunt_block_matrix *m) {
    const int stride = padded_nodes(2, BRUNT_GRID_MESH), plane = 3 * stride;
    int32_t node[3];
    int which[3], count = 0;
    double dense[6 * 6];
    for (int A = 0; A < 3; A++)
        if (p->number[corner[A]] >= 0) which[count] = A, node[count++] = p->number[corner[A]];
    for (int r = 0; r < 2 * count; r++)
        for (int c = 0; c < 2 * count; c++) {
            const int A = which[r / 2], B = which[c / 2], i = r % 2, j = c % 2;
            // Of symmetric tangents there are K_ij for i <= j, and of i = j not all before the diagonal.
            const bool turned = !p->whole && (i > j || (i == j && A > B));
            const int pair = p->whole ? 2 * i + j : i + j;
            dense[r * 2 * count + c] = (double)K[pair * plane + (turned ? B * stride + A : A * stride + B)];
        }
    brunt_block_matrix_add(m, node, count, dense);
}

typedef struct matrix_work {
    brunt_mpm_potential *p;
    brunt_block_matrix *m;
    const int32_t *block; // of the colour
} matrix_work;

BRUNT_INLINE void add_block(int dim, int kernel, const matrix_work *work, int32_t b, int worker) {
    const brunt_mpm_potential *p = work->p;
    const brunt_grid *grid = &p->body->grid;
    const brunt_block *block = &grid->blocks[b];
    real *K = (real *)(p->matrix + worker * p->matrix_size);
    block_rows rows;
    rows.place = p->place + worker * p->place_size;
    if (kernel != BRUNT_GRID_MESH)
        find_rows(dim, kernel, p, block, work->m, brunt_block_matrix_marks(work->m, worker), &rows);
    for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++) {
        const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS + bin;
        if (start[0] == start[1]) continue;
        bin_sums(dim, kernel, p, block, start, K);
        if (kernel == BRUNT_GRID_MESH)
            add_triangle(p, corners_of(grid, block) + 3 * bin, K, work->m);
        else
            add_bin(p->whole, dim, kernel, &rows, bin_base(dim, kernel, bin), K);
    }
}

#define INSTANCE(name, dim, kernel)                                                                                    \
    static void potential_matrix_##name(const matrix_work *work, int32_t block, int worker) {                          \
        add_block(dim, kernel, work, block, worker);                                                                   \
    }
MPM_INSTANCES(INSTANCE)
#define FOUND(name, dim, kernel) [kernel][dim] = potential_matrix_##name,
typedef void block_instance(const matrix_work *work, int32_t block, int worker);
static block_instance *const instances[][4] = {MPM_INSTANCES(FOUND)};

static void add_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const matrix_work *work = context;
    const brunt_grid *grid = &work->p->body->grid;
    block_instance *instance = instances[grid->kernel][grid->dim];
    for (int64_t k = begin; k < end; k++) instance(work, work->block[k], worker);
}

void brunt_mpm_add_matrix(brunt_mpm_potential *p, const brunt_team *team, brunt_block_matrix *m) {
    const brunt_grid *grid = &p->body->grid;
    BRUNT_ASSERT(team->threads <= p->threads);
    for (int colour = 0; colour < grid->corners; colour++) {
        matrix_work work = {p, m, p->coloured + p->colour_first[colour]};
        brunt_parallel(grid->mesh ? 1 : team->threads, p->colour_first[colour + 1] - p->colour_first[colour], 1,
                       add_blocks, &work, team->timer);
    }
}
