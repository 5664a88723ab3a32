// The passes over grid nodes, slot by slot.
#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "grid/node.h"
#include "world/world.h"

// Nodes of a mesh collect what the triangles around have for them, in their order.
static void sum_of_triangles(const brunt_grid *grid, int32_t slot) {
    real *to = brunt_slot_nodes(grid, slot);
    const int32_t *first = grid->source_first + (int64_t)slot * BRUNT_BLOCK_NODES;
    for (int k = 0; k < BRUNT_BLOCK_NODES; k++, to += BRUNT_NODE_REALS)
        for (int32_t q = first[k]; q < first[k + 1]; q++)
            node8_store(to, node8_load(to) + node8_load(grid->p2g_buffer + (size_t)grid->source[q] * BRUNT_NODE_REALS));
}

// Each slot collects what the blocks around it have for it, always in the order of the corners: no locks, and the same
// bits for any number of threads.
void brunt_grid_sum(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_grid_job *job = context;
    const brunt_grid *grid = &job->body->grid;
    real kick[3];
    for (int a = 0; a < 3; a++) kick[a] = (real)(a < grid->dim ? job->gravity[a] * job->dt : 0);
    const int dim = grid->dim, side = grid->side, span = grid->span, order = grid->order;
    for (int64_t s = begin; s < end; s++) {
        real *nodes = brunt_slot_nodes(grid, (int32_t)s);
        memset(nodes, 0, BRUNT_BLOCK_NODES * BRUNT_NODE_REALS * sizeof(real));
        if (grid->mesh) sum_of_triangles(grid, (int32_t)s);
        for (int c = 0; c < grid->corners; c++) {
            int32_t b = grid->slots[s].source[c];
            if (b < 0) continue;
            const real *buffer = grid->p2g_buffer + (size_t)b * (size_t)grid->span_nodes * 8;
            int step[3] = {0, 0, 0}, n[3] = {1, 1, 1};
            for (int a = 0; a < dim; a++) {
                bool beyond = c >> (dim - 1 - a) & 1;
                step[a] = beyond ? side : 0;
                n[a] = beyond ? order : side;
            }
            for (int x = 0; x < n[0]; x++)
                for (int y = 0; y < n[1]; y++) {
                    const real *from = buffer + (dim == 3 ? ((x + step[0]) * span + y + step[1]) * span + step[2]
                                                          : (x + step[0]) * span + y + step[1]) *
                                                    8;
                    real *to = nodes + brunt_node_index(grid, x, y, 0) * 8;
                    for (int z = 0; z < n[2]; z++)
                        node8_store(to + 8 * z, node8_load(to + 8 * z) + node8_load(from + 8 * z));
                }
        }
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, nodes += BRUNT_NODE_REALS) {
            nodes[BRUNT_NODE_SPARE] = nodes[BRUNT_NODE_MASS];
            for (int a = 0; job->has_gravity && a < 3; a++)
                nodes[BRUNT_NODE_OLD + a] += nodes[BRUNT_NODE_MASS] * kick[a];
        }
    }
}

// Nodes with less mass than this are as good as empty: dividing by it would leave the range of normal numbers.
#ifdef BRUNT_FLOAT
static const real LEAST_MASS = 1e-30f;
#else
static const real LEAST_MASS = 1e-280;
#endif

void brunt_grid_update(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_grid_job *job = context;
    const brunt_grid *grid = &job->body->grid;
    real kick[3];
    for (int a = 0; a < 3; a++) kick[a] = (real)(a < grid->dim && job->has_gravity ? job->gravity[a] * job->dt : 0);
    for (int64_t s = begin; s < end; s++) {
        real *n = brunt_slot_nodes(grid, (int32_t)s);
        double work = 0;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS) {
            if (!(n[BRUNT_NODE_MASS] > LEAST_MASS)) {
                for (int a = 0; a < BRUNT_NODE_REALS; a++) n[a] = 0;
                continue;
            }
            real inverse = 1 / n[BRUNT_NODE_MASS], own = n[BRUNT_NODE_SPARE] * inverse;
            for (int a = 0; a < 3; a++) {
                real old = n[BRUNT_NODE_VELOCITY + a] * inverse;
                work += (double)(old * (own * n[BRUNT_NODE_OLD + a] - n[BRUNT_NODE_SPARE] * kick[a]));
                n[BRUNT_NODE_VELOCITY + a] = old + n[BRUNT_NODE_OLD + a] * inverse;
                n[BRUNT_NODE_OLD + a] = old;
            }
        }
        job->sums[s].stress_work = work;
    }
}

void brunt_grid_ledger(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_grid_job *job = context;
    const brunt_grid *grid = &job->body->grid;
    for (int64_t s = begin; s < end; s++) {
        const real *n = brunt_slot_nodes(grid, (int32_t)s);
        brunt_node_sums sums = {0};
        double middle[3] = {0};
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS) {
            double m = (double)n[BRUNT_NODE_SPARE], old2 = 0, new2 = 0;
            for (int a = 0; a < 3; a++) {
                double old = (double)n[BRUNT_NODE_OLD + a], now = (double)n[BRUNT_NODE_VELOCITY + a];
                old2 += old * old, new2 += now * now;
                middle[a] += m * (old + now);
            }
            sums.old_kinetic += m * old2;
            sums.new_kinetic += m * new2;
            if (job->has_gravity) {
                double x[3];
                brunt_node_position(grid, grid->slots[s].coord, k, x);
                sums.mass += m;
                for (int a = 0; a < 3; a++) sums.first_moment[a] += m * x[a];
            }
        }
        sums.old_kinetic *= 0.5, sums.new_kinetic *= 0.5;
        for (int a = 0; a < 3; a++) sums.gravity_work += 0.5 * job->dt * job->gravity[a] * middle[a];
        job->sums[s] = sums;
    }
}
