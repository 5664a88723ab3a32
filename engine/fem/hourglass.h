// Hourglass control of solid elements with one point (Flanagan and Belytschko 1981): what resists the modes that their
// mean gradient does not see. gamma_a = M_a - sum_i (M X)_i b_ia of a zero-energy mode M is orthogonal to every affine
// motion.
//   stiffness  q = gamma . x = M u - H (M X);  potential k/2 |q|^2, f_a = -k q gamma_a. No history, the norm of q does
//              not change with rotations, and q x (k q) = 0: no torque.
//   viscous    rate = g . v with g_a = M_a - sum_i (M x)_i (F^-T b_a)_i: of the present shape, or the forces
//              f_a = -c rate g_a would have a torque.
//              Made from the velocities before, it acts over their change: the work of a step, by mean force times
//              displacement, is c/2 (rate_old . (g_old . v) + rate . rate) dt, exactly.
// In both the part of gamma with b joins the stress: f_a += sum Q (x) (carried M X) F^-T V b_a / V, Q = k q or c rate.
// What k and c are is said where they are made (element.inc, axisymmetric.inc). Membranes have their own
// (membrane.inc).
#pragma once

#include "fem/kernel.h"

// Of a vector of elements; dim and count, the number of modes, are literals where this is made.
typedef struct hourglass_modes {
    int dim, count;
    const lanes *X, *u;    // each mode of the places at the start and of the displacements, dim components
    const lanes *H, *L;    // F - I at the end of the step; its velocity gradient, seen from the start
    lanes *Q, *couple;     // results: force on each mode; sum Q (x) carried mode, which joins the stress
    const lane_mask *kept; // elements that keep their rates and take no part in the accounts; NULL: none can
} hourglass_modes;

// 1 for elements that there are, 0 for padding and those that are kept.
BRUNT_INLINE lanes hourglass_real(const fem_pass *pass, int64_t slot, const lane_mask *kept) {
    lanes real_one = lanes_select(lanes_load(pass->volume + slot) > 0, lanes_set(1), lanes_set(0));
    return kept ? lanes_select(*kept, lanes_set(0), real_one) : real_one;
}

// Springs of stiffness k [N/m].
BRUNT_INLINE void hourglass_springs(fem_pass *pass, const hourglass_modes *at, lanes k) {
    const int dim = at->dim;
    for (int m = 0; m < at->count; m++) {
        const lanes *hX = at->X + m * dim;
        lanes carried[3], q[3];
        for (int i = 0; i < dim; i++) {
            lanes bend = dot(dim, at->H + i * dim, hX);
            q[i] = at->u[m * dim + i] - bend;
            carried[i] = hX[i] + bend;
            at->Q[m * dim + i] = k * q[i];
        }
        pass->stored += (real)0.5 * k * dot(dim, q, q);
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) {
                if (m == 0) at->couple[i * dim + j] = at->Q[i] * carried[j];
                if (m > 0) at->couple[i * dim + j] += at->Q[m * dim + i] * carried[j];
            }
    }
}

// The velocity gradient seen from the end of the step from that seen from its start:
// dF/dt F^-1 = L F_old F^-1 = L (I + dt L)^-1 = L - dt L (dF/dt F^-1).
BRUNT_INLINE void hourglass_turn(int dim, real dt, const lanes *L, lanes *turn) {
    lanes inverse[9], back[9];
    for (int i = 0; i < dim * dim; i++) back[i] = dt * L[i] + (real)(i % (dim + 1) == 0);
    inverse_matrix(dim, back, inverse);
    multiply(dim, L, inverse, turn);
}

// Dampers c [N s/m] of the elements from `slot` on; v: each mode of the velocities (unused with dt 0).
BRUNT_INLINE void hourglass_dampers(fem_pass *pass, const hourglass_modes *at, lanes c, int64_t slot, const lanes *v) {
    const int dim = at->dim;
    lanes turn[9];
    for (int i = 0; i < dim * dim; i++) turn[i] = (lanes){0};
    if (pass->dt > 0) hourglass_turn(dim, pass->dt, at->L, turn);
    for (int m = 0; m < at->count; m++) {
        lanes h[3], rate[3], work = lanes_set(0);
        for (int i = 0; i < dim; i++) h[i] = at->X[m * dim + i] + at->u[m * dim + i];
        for (int i = 0; i < dim; i++) {
            real *kept = pass->rate[m * dim + i] + slot;
            rate[i] = lanes_load(kept);
            if (pass->dt > 0) {
                lanes old = rate[i], middle = v[m * dim + i];
                for (int j = 0; j < dim; j++) middle -= at->L[i * dim + j] * (h[j] - pass->dt * v[m * dim + j]);
                rate[i] = v[m * dim + i] - dot(dim, turn + i * dim, h);
                work += old * middle + rate[i] * rate[i];
                lanes_store(kept, at->kept ? lanes_select(*at->kept, old, rate[i]) : rate[i]);
            }
            at->Q[m * dim + i] = c * rate[i];
        }
        pass->lost += (real)0.5 * pass->dt * c * work;
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) {
                if (m == 0) at->couple[i * dim + j] = at->Q[i] * h[j];
                if (m > 0) at->couple[i * dim + j] += at->Q[m * dim + i] * h[j];
            }
    }
}
