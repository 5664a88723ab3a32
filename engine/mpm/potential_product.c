// Products with the Hessian without its matrix, from the tangents that stand at the particles:
//   (K x)_A = sum_p a_p : (sum_B x_B (x) g_B) . g_A
// and the blocks on the diagonal, g_A . a . g_A. A bin's particles have their kernels' nodes in common: those values
// are read once, particles are taken by vectors, and what they bring to a node is added up before it is written. A
// block writes its own window; the windows are added at the nodes in the order of blocks.
#include <string.h>

#include "mpm/instances.h"
#include "mpm/potential_kernel.h"

typedef struct bin_vector {
    kernel_lanes kernel;
    lanes a[BRUNT_TANGENT(3)]; // tangents, 0 of lanes beyond the bin
} bin_vector;

// A block's particles first .. end - 1, all of a bin, or as many as a vector has. It begins early where it would leave
// the block, beyond whose padding there may be no numbers.
BRUNT_INLINE void take_vector(int dim, int kernel, const brunt_mpm_potential *p, const brunt_block *block,
                              int32_t first, int32_t end, bin_vector *v) {
    const int32_t last = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES - BRUNT_LANES,
                  begin = first < last ? first : last;
    const int64_t slot = (int64_t)block->first + begin;
    lane_mask there = {0};
    for (int l = 0; l < BRUNT_LANES; l++) there[l] = begin + l >= first && begin + l < end ? -1 : 0;
    kernel_at(dim, kernel, p->body, block, slot, &v->kernel);
    for (int c = 0; c < BRUNT_TANGENT(dim); c++)
        v->a[c] = lanes_select(there, lanes_load(p->tangent[c] + slot), lanes_set(0));
}

// T = a : H
BRUNT_INLINE void contract(int dim, const lanes a[], const lanes H[9], lanes T[9]) {
    for (int m = 0; m < dim * dim; m++) {
        T[m] = lanes_set(0);
        for (int n = 0; n < dim * dim; n++) T[m] += a[brunt_tangent_place(false, dim, m, n)] * H[n];
    }
}

// Adds a : (x (x) g) . g of a vector to the sums of the bin's nodes.
BRUNT_INLINE void add_vector(int dim, int kernel, const bin_vector *v, const double *window,
                             lanes sum[KERNEL_LIMIT][3]) {
    lanes H[9], T[9];
    for (int c = 0; c < dim * dim; c++) H[c] = lanes_set(0);
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, &v->kernel, n);
        const double *x = window + (size_t)node.at * (size_t)dim;
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) H[i * dim + j] += (real)x[i] * node.slope[j];
    }
    contract(dim, v->a, H, T);
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, &v->kernel, n);
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) sum[n][i] += T[i * dim + j] * node.slope[j];
    }
}

// Adds row i of g . a . g of a vector to the sums of the bin's nodes.
BRUNT_INLINE void add_diagonal(int dim, int kernel, const bin_vector *v, int i, lanes sum[KERNEL_LIMIT][3]) {
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, &v->kernel, n);
        for (int j = 0; j < dim; j++)
            for (int A = 0; A < dim; A++)
                for (int B = 0; B < dim; B++)
                    sum[n][j] +=
                        node.slope[A] * node.slope[B] * v->a[brunt_tangent_place(false, dim, i * dim + A, j * dim + B)];
    }
}

typedef struct product_work {
    brunt_mpm_potential *p;
    const double *x; // NULL: row `row` of the diagonal blocks instead
    int row;
} product_work;

BRUNT_INLINE void bin_of(int dim, int kernel, const product_work *work, const brunt_block *block,
                         const int32_t particles[2], const double *window, double *force) {
    lanes sum[KERNEL_LIMIT][3];
    for (int n = 0; n < kernel_nodes(dim, kernel); n++)
        for (int i = 0; i < dim; i++) sum[n][i] = lanes_set(0);
    for (int32_t first = particles[0]; first < particles[1]; first += BRUNT_LANES) {
        bin_vector v;
        take_vector(dim, kernel, work->p, block, first, particles[1], &v);
        if (work->x)
            add_vector(dim, kernel, &v, window, sum);
        else
            add_diagonal(dim, kernel, &v, work->row, sum);
    }
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const int at = place_in_window(dim, kernel, n);
        for (int i = 0; i < dim; i++) force[(size_t)at * (size_t)dim + (size_t)i] += (double)lanes_sum(sum[n][i]);
    }
}

BRUNT_INLINE void block_of(int dim, int kernel, const product_work *work, int32_t b) {
    const brunt_mpm_potential *p = work->p;
    const brunt_grid *grid = &p->body->grid;
    const brunt_block *block = &grid->blocks[b];
    const size_t size = (size_t)grid->span_nodes * (size_t)dim;
    double window[WINDOW_LIMIT * 3], *force = p->force + (size_t)b * size;
    if (work->x) fill_window(p, block, work->x, window);
    memset(force, 0, size * sizeof *force);
    for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++) {
        const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS + bin;
        const size_t base = (size_t)bin_base(dim, kernel, bin) * (size_t)dim;
        if (start[0] < start[1]) bin_of(dim, kernel, work, block, start, window + base, force + base);
    }
}

#define INSTANCE(name, dim, kernel)                                                                                    \
    static void potential_product_##name(const product_work *work, int32_t block) {                                    \
        block_of(dim, kernel, work, block);                                                                            \
    }
MPM_INSTANCES(INSTANCE)
#define FOUND(name, dim, kernel) [kernel][dim] = potential_product_##name,
typedef void block_instance(const product_work *work, int32_t block);
static block_instance *const instances[][4] = {MPM_INSTANCES(FOUND)};

static void run_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const product_work *work = context;
    const brunt_grid *grid = &work->p->body->grid;
    block_instance *instance = instances[grid->kernel][grid->dim];
    (void)worker;
    for (int64_t b = begin; b < end; b++) instance(work, (int32_t)b);
}

static void run(product_work *work, const brunt_team *team, double *out, int stride) {
    brunt_parallel(team->threads, work->p->body->grid.block_count, 1, run_blocks, work, team->timer);
    brunt_mpm_gather(&(mpm_gather){work->p, out, stride}, team);
}

void brunt_mpm_add_product(brunt_mpm_potential *p, const brunt_team *team, const double *x, double *y) {
    product_work work = {.p = p, .x = x};
    run(&work, team, y, p->body->grid.dim);
}

void brunt_mpm_add_diagonal(brunt_mpm_potential *p, const brunt_team *team, brunt_block_matrix *blocks) {
    const int dim = p->body->grid.dim;
    for (int i = 0; i < dim; i++) {
        product_work work = {.p = p, .row = i};
        run(&work, team, blocks->value + i * dim, dim * dim);
    }
}
