// Grid to the particles of one block, then their update: velocity, deformation, affine field, report.
//
// WHOLE does all. The linear kernel does it in two: its slope does not vanish where its weight does, so a node that
// feels a particle's corner only is thrown far by the particle's stress (1/weight), and the gradient of such a field is
// useless. MUSL_VELOCITY updates the velocities; these go to the grid once more, without forces; AFTER_MUSL takes the
// gradient of that field (the modified update of Sulsky, Zhou and Schreyer 1995).
//
// AXISYMMETRIC: rings have a hoop rate too, v_r / r with the velocity the particle moves with and r before it moves:
// where the forces took it (p2g.h), and then hoop stretch and radius grow by the same factor 1 + dt v_r / r, so that
// the stretch is r / R for good. What gathers velocities is the same for rings and for plane strain.
//
// KEEPS: APIC that keeps a share a of what the grid does not see. With V and C_grid gathered from the new velocities,
// and V_old and C_old likewise from those that the particles have given to the grid,
//   v <- V + a (v - V_old),   C <- C_grid + a (C - C_old),   x <- x + dt V.
// What is kept has no momentum and no angular momentum where it is made: the scatter of APIC, and its gather, keep
// both. But the particle moves by V while its momentum is that of V + off, off = a (v - V_old), and so dt sum m V x off
// of the angular momentum is lost. With sum_p m w (v + C d - v_old) = 0 at each node, taken times v_old, that is
//   dt sum m ((V - V_old) x off - D (C_old off_C^T - off_C C_old^T)),   off_C = a (C - C_old),
// D the kernel's second moment: no velocity of the body as a whole is in it (dt V x off itself tears a body that flies
// as fast as its waves). Each particle gets its part as spin of C; with undeformed kernels, which see what F undoes,
// of C F^T.
//
// TOTAL: the kernels live in the undeformed configuration. The gradient that is gathered is that of v over the
// undeformed coordinates, Fdot; the material sees L = Fdot F^-1 of the F at the start, for which F = (I + dt L) F_old
// is the same update.
#pragma once

#include <math.h>

#include "grid/bspline.h"
#include "mpm/g2p_fields.h"
#include "mpm/points_update.h"
#include "mpm/tensors.h"
#include "mpm/transfer_kind.h"

// What the tiles of a block have in common, and their sums.
typedef struct g2p_pass {
    const brunt_grid *grid;
    real *out[BRUNT_OUT_KEEPING];               // of the block, as of a workspace; from its first particle on
    real *x[3], *v[3], *F[9], *C[9], *moves[3]; // from slot 0 on
    const real *mass;
    real *hoop;
    real dt, kept, turning, lag;      // lag: dt / (2 D)
    lanes kinetic, fastest, shortest; // sum m |v|^2; greatest |v|^2; greatest 1 / (principal stretch)^2
} g2p_pass;

BRUNT_INLINE bool with_old(transfer_kind kind) {
    return kind.keeps || (kind.transfer == BRUNT_FLIP && kind.stage != AFTER_MUSL);
}
BRUNT_INLINE bool with_affine(transfer_kind kind) { return kind.transfer == BRUNT_APIC && kind.stage != MUSL_VELOCITY; }
BRUNT_INLINE int outputs_of(transfer_kind kind) {
    const int dim = kind.dim, at = old_place(dim, with_affine(kind));
    return at + (with_old(kind) ? dim : 0) + (kind.keeps ? dim * dim : 0);
}

static int32_t padded_count(const brunt_block *block) {
    return (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
}

// The fields at the particles; in the gap behind the last one as at it.
BRUNT_INLINE void g2p_fields(brunt_body *body, int32_t b, brunt_workspace *work, fields_fn *fields_of,
                             transfer_kind kind) {
    const brunt_block *block = &body->grid.blocks[b];
    const int outputs = outputs_of(kind);
    fields_of(body, block, body->grid.bin_start + (size_t)b * BRUNT_BIN_STARTS, work);
    const int32_t count = block->count, padded = padded_count(block);
    for (int o = 0; o < outputs; o++)
        for (int32_t s = count; s < padded; s++) work->out[o][s] = work->out[o][count - 1];
}

// What the velocity component v, at s, becomes where the grid has grid_v.
BRUNT_INLINE lanes new_velocity(const g2p_pass *pass, int64_t i, int r, lanes v, lanes grid_v, transfer_kind kind) {
    if (!with_old(kind)) return grid_v;
    const lanes old = lanes_load(pass->out[old_place(kind.dim, with_affine(kind)) + r] + i);
    if (kind.keeps) return grid_v + pass->kept * (v - old);
    const lanes change = grid_v - old;
    return pass->kept * (v + change) + (1 - pass->kept) * grid_v;
}

// Velocity and place of the particles at s, number i of their block; |v|^2. Rings: hoop rate and stretch as well.
BRUNT_INLINE lanes update_velocity(const g2p_pass *pass, int64_t i, int64_t s, transfer_kind kind) {
    lanes speed2 = (lanes){0};
    for (int r = 0; r < kind.dim; r++) {
        lanes grid_v, new_v;
        if (kind.stage == AFTER_MUSL) {
            grid_v = lanes_load(pass->moves[r] + s), new_v = lanes_load(pass->v[r] + s);
        } else {
            grid_v = lanes_load(pass->out[r] + i);
            new_v = new_velocity(pass, i, r, lanes_load(pass->v[r] + s), grid_v, kind);
            lanes_store(pass->v[r] + s, new_v);
        }
        if (kind.form == AXISYMMETRIC && r == 0) {
            const lanes rate = grid_v / lanes_load(pass->x[0] + s), stretch = lanes_load(pass->F[8] + s);
            lanes_store(pass->hoop + i, rate);
            lanes_store(pass->F[8] + s, stretch + pass->dt * rate * stretch);
        }
        lanes_store(pass->x[r] + s, lanes_load(pass->x[r] + s) + pass->dt * grid_v);
        speed2 += new_v * new_v;
    }
    return speed2;
}

// F of total-Lagrangian particles grows by dt times the gathered Fdot; leaves L in its place.
BRUNT_INLINE void update_total_deformation(g2p_pass *pass, int64_t i, int64_t s, const lanes *old_F, int dim) {
    lanes inverse[9], rate[9];
    for (int c = 0; c < dim * dim; c++) {
        rate[c] = lanes_load(pass->out[dim + c] + i);
        lanes_store(pass->F[c] + s, old_F[c] + pass->dt * rate[c]);
    }
    inverse_matrix(dim, old_F, inverse);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) {
            lanes L = rate[r * dim] * inverse[c];
            for (int k = 1; k < dim; k++) L += rate[r * dim + k] * inverse[k * dim + c];
            lanes_store(pass->out[dim + r * dim + c] + i, L);
        }
    pass->shortest = lanes_max(pass->shortest, inverse_stretch(dim, pass->F, s));
}

// F = (I + dt L) F_old, in the plane or in space.
BRUNT_INLINE void update_deformation(g2p_pass *pass, int64_t i, int64_t s, transfer_kind kind) {
    const int dim = kind.dim, point_dim = kind.form == AXISYMMETRIC ? 3 : dim;
    lanes old_F[9], L[9];
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) old_F[r * dim + c] = lanes_load(pass->F[r * point_dim + c] + s);
    if (kind.form == TOTAL) {
        update_total_deformation(pass, i, s, old_F, dim);
        return;
    }
    for (int c = 0; c < dim * dim; c++) L[c] = lanes_load(pass->out[dim + c] + i);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) {
            lanes change = L[r * dim] * old_F[c];
            for (int k = 1; k < dim; k++) change += L[r * dim + k] * old_F[k * dim + c];
            lanes_store(pass->F[r * point_dim + c] + s, old_F[r * dim + c] + pass->dt * change);
        }
}

// What a point keeps: changes of the velocity about it, what of it is kept, the affine field before, what of that is.
typedef struct kept_motion {
    lanes change[3], off[3], old[9], off_C[9];
} kept_motion;

// dt / 2 times the angular momentum per D that what is kept would lose, r and c of it.
BRUNT_INLINE lanes lost_spin(const g2p_pass *pass, const kept_motion *m, int r, int c, int dim) {
    lanes bends = (lanes){0};
    for (int k = 0; k < dim; k++)
        bends += m->old[r * dim + k] * m->off_C[c * dim + k] - m->old[c * dim + k] * m->off_C[r * dim + k];
    return pass->lag * (m->change[r] * m->off[c] - m->change[c] * m->off[r]) - (real)0.5 * pass->dt * bends;
}

// Adds a spin to the affine field.
BRUNT_INLINE void add_spin(const g2p_pass *pass, int64_t s, const lanes *spin, lanes *C, transfer_kind kind) {
    const int dim = kind.dim;
    if (kind.form != TOTAL) {
        for (int c = 0; c < dim * dim; c++) C[c] += spin[c];
        return;
    }
    lanes F[9], inverse[9];
    for (int c = 0; c < dim * dim; c++) F[c] = lanes_load(pass->F[c] + s);
    inverse_matrix(dim, F, inverse);
    for (int r = 0; r < dim; r++)
        for (int a = 0; a < dim; a++)
            for (int k = 0; k < dim; k++) C[r * dim + a] += spin[r * dim + k] * inverse[a * dim + k];
}

// Adds to the affine field what is kept of it, and the angular momentum of what is kept.
BRUNT_INLINE void keep_affine_field(const g2p_pass *pass, int64_t i, int64_t s, lanes *C, transfer_kind kind) {
    const int dim = kind.dim, at = old_place(dim, true);
    kept_motion m;
    lanes spin[9];
    for (int r = 0; r < dim; r++) {
        const lanes V = lanes_load(pass->out[r] + i);
        m.change[r] = V - lanes_load(pass->out[at + r] + i);
        m.off[r] = lanes_load(pass->v[r] + s) - V;
    }
    for (int c = 0; c < dim * dim; c++) {
        m.old[c] = lanes_load(pass->out[at + dim + c] + i);
        m.off_C[c] = pass->kept * (lanes_load(pass->C[c] + s) - m.old[c]);
        C[c] += m.off_C[c];
    }
    for (int r = 0; r < dim; r++) {
        spin[r * dim + r] = (lanes){0};
        for (int c = r + 1; c < dim; c++) {
            spin[r * dim + c] = lost_spin(pass, &m, r, c, dim);
            spin[c * dim + r] = -spin[r * dim + c];
        }
    }
    add_spin(pass, s, spin, C, kind);
}

// The affine field of the particles where they are now; sum C:C D, twice its kinetic energy per mass.
BRUNT_INLINE lanes update_affine_field(const g2p_pass *pass, int64_t i, int64_t s, transfer_kind kind) {
    const int dim = kind.dim;
    lanes A[9], C[9], affine2 = (lanes){0};
    for (int c = 0; c < dim * dim; c++) A[c] = lanes_load(pass->out[dim + dim * dim + c] + i);
    turn_affine_field(dim, A, pass->turning, C);
    if (kind.keeps) keep_affine_field(pass, i, s, C, kind);
    for (int a = 0; a < dim; a++) {
        lanes square = (lanes){0};
        for (int r = 0; r < dim; r++) {
            lanes_store(pass->C[r * dim + a] + s, C[r * dim + a]);
            square += C[r * dim + a] * C[r * dim + a];
        }
        affine2 += square * bspline_moment(kind.order, lanes_load(pass->x[a] + s) - (real)pass->grid->origin[a],
                                           pass->grid->h, pass->grid->inv_h);
    }
    return affine2;
}

BRUNT_INLINE void copy_arrays(real **to, real *const *from, int count) {
    for (int c = 0; c < count; c++) to[c] = from[c];
}

// The arrays are copied, as what is stored in them might, for all the compiler knows, be their own addresses.
BRUNT_INLINE g2p_pass g2p_begin(brunt_body *body, real dt, real kept, brunt_workspace *work, transfer_kind kind) {
    brunt_particles *p = &body->particles;
    const int dim = kind.dim, matrix = dim * dim;
    const bool still = kind.form == TOTAL || body->material.model[BRUNT_STRENGTH]->fluid;
    g2p_pass pass; // not of all instances has it everything, and what is not there is not set to 0 for nothing
    pass.grid = &body->grid;
    pass.mass = brunt_field(p, BRUNT_FIELD_mass)[0];
    pass.hoop = work->out[BRUNT_OUT_HOOP];
    pass.dt = dt, pass.kept = kept, pass.turning = still ? 0 : (real)0.5 * dt;
    pass.kinetic = pass.fastest = pass.shortest = (lanes){0};
    copy_arrays(pass.out, work->out, outputs_of(kind));
    if (kind.keeps)
        pass.lag = (real)0.5 * dt / bspline_moment(kind.order, lanes_set(0), body->grid.h, body->grid.inv_h)[0];
    copy_arrays(pass.x, brunt_field(p, BRUNT_FIELD_position), dim);
    copy_arrays(pass.v, brunt_field(p, BRUNT_FIELD_velocity), dim);
    copy_arrays(pass.F, brunt_field(p, BRUNT_FIELD_deformation_gradient), kind.form == AXISYMMETRIC ? 9 : matrix);
    if (with_affine(kind)) copy_arrays(pass.C, brunt_field(p, BRUNT_FIELD_affine), matrix);
    if (kind.stage != WHOLE) // what particles move with after the first stage: their own velocity, but for FLIP
        copy_arrays(pass.moves,
                    brunt_field(p, kind.transfer == BRUNT_FLIP ? BRUNT_FIELD_grid_velocity : BRUNT_FIELD_velocity),
                    dim);
    return pass;
}

// Motion of the block's particles and, of its sums, what the grid's forces did before the material is updated.
BRUNT_INLINE void report_motion(brunt_body *body, int32_t b, const g2p_pass *pass, brunt_workspace *work,
                                transfer_kind kind) {
    const brunt_block *block = &body->grid.blocks[b];
    const real *hoop = kind.form == AXISYMMETRIC ? pass->hoop : NULL;
    double musl_power = 0, old_power = 0;
    if (kind.stage == AFTER_MUSL) { // the forces worked at the gradient of the first stage
        old_power = -body->report[b].musl_power;
        musl_power = brunt_stress_power(body, block, 0, work->out + kind.dim, hoop) - old_power;
    } else if (body->uneven) {
        old_power = brunt_stress_power(body, block, 0, work->out + kind.dim, hoop);
    }
    body->report[b] = (brunt_block_report){.kinetic = 0.5 * (double)lanes_sum(pass->kinetic),
                                           .musl_power = musl_power,
                                           .old_power = old_power,
                                           .speed = (real)sqrt((double)lanes_max_of(pass->fastest)),
                                           .bad = -1};
}

// The material of the block's particles, and what it and its stress report.
BRUNT_INLINE void report_material(brunt_body *body, int32_t b, const g2p_pass *pass, brunt_workspace *work,
                                  transfer_kind kind) {
    const brunt_block *block = &body->grid.blocks[b];
    brunt_block_report *report = &body->report[b];
    real *rates[9];
    if (kind.form == AXISYMMETRIC) brunt_hoop_rates(work, padded_count(block), rates);
    brunt_update_points(body, block, pass->dt, work, kind.form == AXISYMMETRIC ? rates : work->out + kind.dim, report);
    if (kind.form == TOTAL) // waves run through undeformed cells, by as much faster as lengths have shrunk
        report->wave_speed *= (real)sqrt((double)lanes_max_of(pass->shortest));
    if (body->keeps) brunt_still_stress(body, block);
    report->stress_power =
        brunt_stress_power(body, block, pass->dt, work->out + kind.dim, kind.form == AXISYMMETRIC ? pass->hoop : NULL);
}

BRUNT_INLINE void g2p(brunt_body *body, int32_t b, real dt, real kept, brunt_workspace *work, fields_fn *fields_of,
                      transfer_kind kind) {
    g2p_fields(body, b, work, fields_of, kind);
    const brunt_block *block = &body->grid.blocks[b];
    const int32_t padded = padded_count(block);
    g2p_pass pass = g2p_begin(body, dt, kept, work, kind);
    const bool keeps = body->erodes_inverted || body->keeps;
    int32_t turned =
        keeps ? brunt_keep_inverted(body, block, dt, work->out + kind.dim, work->out[BRUNT_OUT_STRETCH]) : 0;
    for (int64_t i = 0; i < padded; i += BRUNT_LANES) {
        const int64_t s = block->first + i;
        const lanes speed2 = update_velocity(&pass, i, s, kind);
        update_deformation(&pass, i, s, kind);
        const lanes affine2 = with_affine(kind) ? update_affine_field(&pass, i, s, kind) : (lanes){0};
        pass.kinetic += lanes_load(pass.mass + s) * (speed2 + affine2);
        pass.fastest = lanes_max(pass.fastest, speed2);
    }
    report_motion(body, b, &pass, work, kind);
    if (kind.form == AXISYMMETRIC && keeps)
        turned += brunt_keep_inverted_hoops(body, block, dt, pass.hoop, work->out[BRUNT_OUT_STRETCH]);
    report_material(body, b, &pass, work, kind);
    body->report[b].turned = turned;
}

// The linear kernel's first stage: velocities, and what the stress did before they go to the grid once more.
BRUNT_INLINE void musl_velocity(brunt_body *body, int32_t b, real kept, brunt_workspace *work, fields_fn *fields_of,
                                transfer_kind kind) {
    g2p_fields(body, b, work, fields_of, kind);
    const brunt_block *block = &body->grid.blocks[b];
    const int32_t padded = padded_count(block);
    const g2p_pass pass = g2p_begin(body, 0, kept, work, kind);
    for (int64_t i = 0; i < padded; i += BRUNT_LANES)
        for (int r = 0; r < kind.dim; r++) {
            const int64_t s = block->first + i;
            lanes grid_v = lanes_load(pass.out[r] + i);
            lanes new_v = new_velocity(&pass, i, r, lanes_load(pass.v[r] + s), grid_v, kind);
            if (with_old(kind)) lanes_store(pass.moves[r] + s, grid_v);
            lanes_store(pass.v[r] + s, new_v);
        }
    if (kind.form == AXISYMMETRIC)
        for (int64_t i = 0; i < padded; i += BRUNT_LANES)
            lanes_store(pass.hoop + i, lanes_load(pass.out[0] + i) / lanes_load(pass.x[0] + block->first + i));
    body->report[b].musl_power =
        -brunt_stress_power(body, block, 0, work->out + kind.dim, kind.form == AXISYMMETRIC ? pass.hoop : NULL);
}
