// Particles of one block to its nodes.
//
// What a particle gives to node (i,j,k) is a sum of three rank-one terms: with weights w, offsets d = node - x, slopes
// g,
//   X_i = wx_i (a + Bx dx_i) + gx_i Tx,  Y_j = wy_j dy_j By + gy_j Ty,  Z_k = wz_k dz_k Bz + gz_k Tz
//   node += wz_k (wy_j X_i + wx_i Y_j) + wx_i wy_j Z_k
// where a = (m, m v), B = m C column by column, and T = -dt V0 tau column by column; momentum and force impulse travel
// in one vector of eight reals. A tile of particles is staged lane by lane, transposed, and then given to the nodes
// particle by particle. Particles of one bin follow each other, so sums stay in registers until the bin changes.
//
// AXISYMMETRIC: particles are rings about x = 0, with the masses and volumes of full circles. Their stress works on the
// hoop rate v_r / r as well, v_r = sum w v_i at the particle and r its distance from the axis, both at the start of the
// step: by virtual power, sum_i f_i . v_i = -sum_p V tau : L for any nodal velocities, each node gets -w V tau_hoop / r
// more (Nairn and Guilkey 2015, with points for their particles' domains). It goes with `a`, along r.
//
// TOTAL: the kernels live in the undeformed configuration: x is the place there, C the affine velocity in its
// coordinates, and P = tau F^-T takes the place of tau (de Vaucorbeil, Nguyen and Hutchinson 2020, eq. 20).
#pragma once

#include <string.h>

#include "grid/bspline.h"
#include "mpm/node_window.h"
#include "mpm/tensors.h"
#include "mpm/transfer_kind.h"

typedef struct p2g_arrays {
    const real *x[3], *v[3], *C[9], *tau[6], *F[9], *mass, *volume;
    const uint8_t *bin;
    const real *all[32];
    int count; // for the prefetches
} p2g_arrays;

// A vector of particles, staged: each one's terms and weights along each axis, and its first node in the block's
// buffer.
typedef struct p2g_tile {
    real term[3][4][BRUNT_LANES][8];
    real weight[3][4][BRUNT_LANES];
    int32_t node[BRUNT_LANES];
    lanes momentum[3][3]; // along each axis: what does not grow with an offset goes along the first, others have 0
} __attribute__((aligned(64))) p2g_tile;

static void p2g_arrays_of(brunt_body *body, p2g_arrays *f) {
    brunt_particles *p = &body->particles;
    f->count = 0;
#define TAKE(to, field, n)                                                                                             \
    for (int c = 0; c < (n); c++) f->all[f->count++] = (to)[c] = brunt_field(p, BRUNT_FIELD_##field)[c]
    for (int a = 0; a < p->dim; a++) f->all[f->count++] = f->x[a] = brunt_kernel_position(p)[a];
    if (brunt_total_lagrangian(p)) TAKE(f->F, deformation_gradient, BRUNT_MATRIX(p->dim));
    TAKE(f->v, velocity, p->dim);
    TAKE(f->C, affine, p->field[BRUNT_FIELD_affine].components);
    TAKE(f->tau, kirchhoff_stress, BRUNT_SYMMETRIC(p->dim)); // of rings, those that are not zero
    TAKE(&f->mass, mass, 1);
    TAKE(&f->volume, reference_volume, 1);
#undef TAKE
    f->bin = p->bin;
}

// Bins ahead of the hardware's own prefetching, which follows fewer streams than there are arrays.
BRUNT_INLINE void prefetch_particles(const p2g_arrays *f, int64_t s) {
    for (int k = 0; k < f->count; k++) __builtin_prefetch(f->all[k] + s + 6 * BRUNT_LANES, 0, 2);
}

// The bin's first node in a buffer of span^dim nodes.
BRUNT_INLINE int32_t node_of_bin(int bin, transfer_kind kind) {
    const int span = (kind.dim == 3 ? 4 : 8) + kind.order;
    return kind.dim == 3 ? ((bin >> 4) * span + (bin >> 2 & 3)) * span + (bin & 3) : (bin >> 3) * span + (bin & 7);
}

// T = `impulse` times column `a` of P = tau F^-T, of the total-Lagrangian particles at s.
BRUNT_INLINE void total_stress(const p2g_arrays *f, int64_t s, int a, const lanes *impulse, lanes T[3], int dim) {
    lanes F[9], inverse[9];
    for (int c = 0; c < dim * dim; c++) F[c] = lanes_load(f->F[c] + s);
    inverse_matrix(dim, F, inverse);
    for (int r = 0; r < dim; r++) {
        T[r] = (lanes){0};
        for (int k = 0; k < dim; k++)
            T[r] += *impulse * lanes_load(f->tau[SYMMETRIC_INDEX(dim, r, k)] + s) * inverse[a * dim + k];
    }
}

// Stages the particles at s; `corner` is the block's, h the cell.
BRUNT_INLINE void stage_tile(p2g_tile *tile, const p2g_arrays *f, int64_t s, const real corner[3],
                             const brunt_grid *grid, real dt, transfer_kind kind) {
    const int dim = kind.dim, n = kind.order + 1;
    const real h = grid->h, inv_h = grid->inv_h;
    lanes m = lanes_load(f->mass + s), impulse = -dt * lanes_load(f->volume + s);
    lanes T[3], hoop = (lanes){0};
    for (int r = 0; r < dim; r++) tile->momentum[0][r] = m * lanes_load(f->v[r] + s);
    if (kind.form == AXISYMMETRIC) hoop = impulse * lanes_load(f->tau[2] + s) / lanes_load(f->x[0] + s);
    for (int l = 0; l < BRUNT_LANES; l++) tile->node[l] = node_of_bin(f->bin[s + l], kind);
    for (int a = 0; a < dim; a++) {
        lanes u = local_coordinate(lanes_load(f->x[a] + s), corner[a], inv_h, bin_coordinate(f->bin + s, dim, a));
        lanes w[4], g[4], mC[3];
        for (int r = 0; r < dim; r++) T[r] = impulse * lanes_load(f->tau[SYMMETRIC_INDEX(dim, r, a)] + s);
        if (kind.form == TOTAL) total_stress(f, s, a, &impulse, T, dim);
        bspline_weights(kind.order, u, w);
        bspline_slopes(kind.order, u, inv_h, g);
        for (int r = 0; kind.transfer == BRUNT_APIC && r < dim; r++) mC[r] = m * lanes_load(f->C[r * dim + a] + s);
        for (int i = 0; i < n; i++) {
            lanes column[8] = {0}, d = ((real)i - u) * h;
            if (a == 0) column[0] = w[i] * m;
            for (int r = 0; r < dim; r++) {
                lanes q = tile->momentum[a][r];
                if (kind.transfer == BRUNT_APIC) q += mC[r] * d;
                column[BRUNT_NODE_VELOCITY + r] = w[i] * q;
                column[BRUNT_NODE_OLD + r] = g[i] * T[r];
            }
            if (kind.form == AXISYMMETRIC && a == 0) column[BRUNT_NODE_OLD] += w[i] * hoop;
            node8_transpose(column, tile->term[a][i]);
            lanes_store(tile->weight[a][i], w[i]);
        }
    }
}

// Rows of 64 cubic nodes do not fit the registers; those go straight to the buffer.
BRUNT_INLINE bool sums_in_registers(transfer_kind kind) { return kind.dim == 2 || kind.order < 3; }

// Nodes that a bin touches.
BRUNT_INLINE int nodes_of_bin(transfer_kind kind) {
    const int n = kind.order + 1;
    return kind.dim == 3 ? n * n * n : n * n;
}

// The sums of a bin's particles to its nodes, the first of which is `at`; the sums begin anew.
BRUNT_INLINE void flush_sums(real *at, node_part (*sum)[NODE_PARTS], transfer_kind kind) {
    const int n = kind.order + 1, span = (kind.dim == 3 ? 4 : 8) + kind.order;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < (kind.dim == 3 ? n : 1); k++) {
                real *node = at + (kind.dim == 3 ? (i * span + j) * span + k : i * span + j) * 8;
                node_part *of = sum[kind.dim == 3 ? (i * n + j) * n + k : i * n + j];
                for (int h = 0; h < NODE_PARTS; h++) {
                    node_part_store(node, h, node_part_load(node, h) + of[h]);
                    of[h] = (node_part){0};
                }
            }
}

// Row (i, j) of particle `p` to its nodes along z: to their sums or, where they do not fit the registers, from `at` on.
BRUNT_INLINE void add_along_z(const p2g_tile *tile, int p, const node_part *U, real wxy, node_part (*sum)[NODE_PARTS],
                              real *at, transfer_kind kind) {
    for (int k = 0; k <= kind.order; k++)
        for (int h = 0; h < NODE_PARTS; h++) {
            const node_part Z = node_part_load(tile->term[2][k][p], h);
            if (sums_in_registers(kind)) {
                sum[k][h] += tile->weight[2][k][p] * U[h];
                sum[k][h] += wxy * Z;
            } else {
                const node_part more = tile->weight[2][k][p] * U[h] + wxy * Z;
                node_part_store(at + k * 8, h, node_part_load(at + k * 8, h) + more);
            }
        }
}

// Particle `p` of the tile to the sums, or to the nodes from `at` on.
BRUNT_INLINE void add_particle(const p2g_tile *tile, int p, node_part (*sum)[NODE_PARTS], real *at,
                               transfer_kind kind) {
    const int n = kind.order + 1, span = (kind.dim == 3 ? 4 : 8) + kind.order;
    node_part Y[4][NODE_PARTS];
    for (int j = 0; j < n; j++)
        for (int h = 0; h < NODE_PARTS; h++) Y[j][h] = node_part_load(tile->term[1][j][p], h);
    for (int i = 0; i < n; i++) {
        const real wx = tile->weight[0][i][p];
        node_part X[NODE_PARTS];
        for (int h = 0; h < NODE_PARTS; h++) X[h] = node_part_load(tile->term[0][i][p], h);
        for (int j = 0; j < n; j++) {
            const real wy = tile->weight[1][j][p];
            node_part U[NODE_PARTS];
            for (int h = 0; h < NODE_PARTS; h++) U[h] = wy * X[h] + wx * Y[j][h];
            if (kind.dim == 3)
                add_along_z(tile, p, U, wx * wy, sums_in_registers(kind) ? sum + (i * n + j) * n : sum,
                            at + (i * span + j) * span * 8, kind);
            else
                for (int h = 0; h < NODE_PARTS; h++) sum[i * n + j][h] += U[h];
        }
    }
}

BRUNT_INLINE void p2g(brunt_body *body, int32_t b, real dt, transfer_kind kind) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[b];
    p2g_arrays f;
    p2g_arrays_of(body, &f);
    real corner[3] = {0};
    for (int a = 0; a < kind.dim; a++)
        corner[a] = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * (kind.dim == 3 ? 4 : 8)));
    real *buffer = grid->p2g_buffer + (size_t)b * (size_t)grid->span_nodes * 8;
    memset(buffer, 0, (size_t)grid->span_nodes * 8 * sizeof(real));

    p2g_tile tile;
    memset(tile.momentum, 0, sizeof tile.momentum);
    node_part sum[27][NODE_PARTS]; // of the bin's nodes, where they fit the registers
    for (int q = 0; sums_in_registers(kind) && q < nodes_of_bin(kind); q++)
        for (int h = 0; h < NODE_PARTS; h++) sum[q][h] = (node_part){0};
    int current = -1;
    for (int64_t s = block->first; s < block->first + block->count; s += BRUNT_LANES) {
        stage_tile(&tile, &f, s, corner, grid, dt, kind);
        prefetch_particles(&f, s);
#pragma GCC unroll 1 // eight times the code is no quicker
        for (int p = 0; p < BRUNT_LANES; p++) {
            if (sums_in_registers(kind) && tile.node[p] != current) {
                if (current >= 0) flush_sums(buffer + (size_t)current * 8, sum, kind);
                current = tile.node[p];
            }
            add_particle(&tile, p, sum, buffer + (size_t)tile.node[p] * 8, kind);
        }
    }
    if (sums_in_registers(kind) && current >= 0) flush_sums(buffer + (size_t)current * 8, sum, kind);
}
