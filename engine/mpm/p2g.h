// Particles of one block to its nodes.
//
// What a particle gives to node (i,j,k) is a sum of three rank-one terms: with weights w, offsets d = node - x, slopes
// g,
//   X_i = wx_i (a + Bx dx_i) + gx_i Tx,  Y_j = wy_j dy_j By + gy_j Ty,  Z_k = wz_k dz_k Bz + gz_k Tz
//   node += wz_k (wy_j X_i + wx_i Y_j) + wx_i wy_j Z_k
// where a = (m, m v), B = m C column by column, and T = -dt V0 tau column by column; momentum and force impulse travel
// in one vector of eight reals. A tile of particles is staged lane by lane, transposed, and then given to the nodes
// particle by particle: those of a tile that follow each other in one bin are summed in registers, as many rows of
// nodes at a time as these hold, from where the nodes stand.
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
    real corner[3]; // [m] of the block
    const real *all[32];
    int count; // for the prefetches
} p2g_arrays;

// Particles, staged a vector at a time: each one's terms and weights along each axis, and its first node in the block's
// buffer. As many as two bins have, so that most of those of a bin are in one tile.
enum { TILE = 16 };
_Static_assert(TILE % BRUNT_LANES == 0, "a tile is whole vectors");
typedef struct p2g_tile {
    real term[3][4][TILE][8];
    real weight[3][4][TILE], row[4][4][TILE]; // `row`: products of those along the first two axes
    int32_t node[TILE];
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

// Stages the particles at s, from place `to` of the tile on.
BRUNT_INLINE void stage_tile(p2g_tile *tile, int to, const p2g_arrays *f, int64_t s, const brunt_grid *grid, real dt,
                             transfer_kind kind) {
    const int dim = kind.dim, n = kind.order + 1;
    const real h = grid->h, inv_h = grid->inv_h;
    lanes m = lanes_load(f->mass + s), impulse = -dt * lanes_load(f->volume + s);
    lanes T[3], hoop = (lanes){0};
    for (int r = 0; r < dim; r++) tile->momentum[0][r] = m * lanes_load(f->v[r] + s);
    if (kind.form == AXISYMMETRIC) hoop = impulse * lanes_load(f->tau[2] + s) / lanes_load(f->x[0] + s);
    for (int l = 0; l < BRUNT_LANES; l++) tile->node[to + l] = node_of_bin(f->bin[s + l], kind);
    for (int a = 0; a < dim; a++) {
        lanes u = local_coordinate(lanes_load(f->x[a] + s), f->corner[a], inv_h, bin_coordinate(f->bin + s, dim, a));
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
            node8_transpose(column, tile->term[a][i] + to);
            lanes_store(tile->weight[a][i] + to, w[i]);
        }
    }
    for (int i = 0; dim == 3 && i < n; i++)
        for (int j = 0; j < n; j++)
            lanes_store(tile->row[i][j] + to,
                        lanes_load(tile->weight[0][i] + to) * lanes_load(tile->weight[1][j] + to));
}

// Rows of nodes along the last axis, of one place along x (2D: of several), whose sums the registers hold at once, a
// part of the nodes at a time.
BRUNT_INLINE int rows_at_once(transfer_kind kind) { return NODE_PARTS == 1 || kind.order < 3 ? kind.order + 1 : 2; }

// Part h of rows (i, j) to (i, j + rows) of particle `p` to their sums; 2D: of rows j to j + rows.
BRUNT_INLINE void add_rows(const p2g_tile *tile, int p, int i, int j, int h, node_part (*sum)[4], transfer_kind kind) {
    const int last = kind.dim - 1;
    for (int r = 0; r < rows_at_once(kind); r++) {
        node_part U = node_part_load(tile->term[0][kind.dim == 3 ? i : j + r][p], h);
        if (kind.dim == 3)
            U = tile->weight[1][j + r][p] * U + tile->weight[0][i][p] * node_part_load(tile->term[1][j + r][p], h);
        const real across = kind.dim == 3 ? tile->row[i][j + r][p] : tile->weight[0][j + r][p];
        for (int k = 0; k <= kind.order; k++) {
            sum[r][k] += tile->weight[last][k][p] * U;
            sum[r][k] += across * node_part_load(tile->term[last][k][p], h);
        }
    }
}

// Particles [from, to) of the tile, all of one bin, to its nodes, the first of which is `at`.
BRUNT_INLINE void add_run(const p2g_tile *tile, int from, int to, real *at, transfer_kind kind) {
    const int n = kind.order + 1, row = ((kind.dim == 3 ? 4 : 8) + kind.order) * 8, rows = rows_at_once(kind);
    for (int h = 0; h < NODE_PARTS; h++)
        for (int i = 0; i < (kind.dim == 3 ? n : 1); i++)
            for (int j = 0; j < n; j += rows) {
                real *first = at + i * (4 + kind.order) * row + j * row;
                node_part sum[4][4];
                for (int r = 0; r < rows; r++)
                    for (int k = 0; k < n; k++) sum[r][k] = node_part_load(first + r * row + k * 8, h);
                for (int p = from; p < to; p++) add_rows(tile, p, i, j, h, sum, kind);
                for (int r = 0; r < rows; r++)
                    for (int k = 0; k < n; k++) node_part_store(first + r * row + k * 8, h, sum[r][k]);
            }
}

BRUNT_INLINE void p2g(brunt_body *body, int32_t b, real dt, transfer_kind kind) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[b];
    p2g_arrays f;
    p2g_arrays_of(body, &f);
    for (int a = 0; a < kind.dim; a++)
        f.corner[a] = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * (kind.dim == 3 ? 4 : 8)));
    real *buffer = grid->p2g_buffer + (size_t)b * (size_t)grid->span_nodes * 8;
    memset(buffer, 0, (size_t)grid->span_nodes * 8 * sizeof(real));

    p2g_tile tile;
    memset(tile.momentum, 0, sizeof tile.momentum);
    const int64_t end = block->first + block->count;
    for (int64_t s = block->first; s < end; s += TILE) {
        int staged = 0;
        for (; staged < TILE && s + staged < end; staged += BRUNT_LANES) {
            stage_tile(&tile, staged, &f, s + staged, grid, dt, kind);
            prefetch_particles(&f, s + staged);
        }
        for (int from = 0, to; from < staged; from = to) {
            for (to = from + 1; to < staged && tile.node[to] == tile.node[from];) to++;
            add_run(&tile, from, to, buffer + (size_t)tile.node[from] * 8, kind);
        }
    }
}
