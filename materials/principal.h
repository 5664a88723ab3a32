// Isotropic potentials of logarithmic strains, e_i = ln(x_i) / 2 of the eigenvalues x_i of a tensor b that a further
// deformation carries to (I + t G) b (I + t G)^T: Hencky's elasticity and what follows from it.
//
// In the axes of b, with tau_i = dW/de_i and c_ij = d2W/de_i de_j, the tangent of trial.h is
//   a_iijj = c_ij - tau_i delta_ij,
//   a_ijij = x_j D,  a_jiji = x_i D,  a_ijji = x_j D - tau_j,   D = (tau_i - tau_j) / (x_i - x_j)   for i != j
// (Ogden, Non-linear Elastic Deformations, section 6.1.4). Laws whose deviator is parallel to that of e have
// D = s (e_i - e_j) / (x_i - x_j), of which nothing is lost where two eigenvalues meet.
#pragma once

#include "materials/trial.h"

// b - I has the eigenvalues `strain`, and the vectors axis[i] (rows). In 2D the third axis is z, without strain unless
// given.
typedef struct principal_axes {
    lanes strain[3], axis[3][3];
} principal_axes;

// One rotation of Jacobi's method, of lanes in `active`: rows and columns p and q.
BRUNT_INLINE void principal_rotate(lanes A[3][3], lanes axis[3][3], int p, int q, lane_mask active) {
    const lanes zero = lanes_set(0), one = lanes_set(1);
    const lane_mask turn = active & (A[p][q] != 0);
    lanes half = (real)0.5 * (A[q][q] - A[p][p]), off = lanes_select(turn, A[p][q], one);
    // tan of the lesser angle: off / (half +- sqrt(half^2 + off^2))
    lanes root = lanes_sqrt(half * half + off * off);
    lanes t = off / (half + lanes_select(half < 0, -root, root));
    t = lanes_select(turn, t, zero);
    lanes c = 1 / lanes_sqrt(1 + t * t), s = t * c;
    lanes shift = t * A[p][q];
    A[p][p] -= shift, A[q][q] += shift;
    A[p][q] = A[q][p] = lanes_select(turn, zero, A[p][q]);
    const int r = 3 - p - q;
    lanes rp = A[r][p], rq = A[r][q];
    A[r][p] = A[p][r] = c * rp - s * rq;
    A[r][q] = A[q][r] = s * rp + c * rq;
    for (int k = 0; k < 3; k++) {
        lanes a = axis[p][k], b = axis[q][k];
        axis[p][k] = c * a - s * b, axis[q][k] = s * a + c * b;
    }
}

// Of B = b - I. Lanes stop one by one, so that a point's bits do not depend on its neighbours.
BRUNT_INLINE principal_axes principal_of(int dim, const lanes B[6]) {
    principal_axes out;
    lanes A[3][3] = {{B[XX], B[XY], lanes_set(0)}, {B[XY], B[YY], lanes_set(0)}, {lanes_set(0), lanes_set(0), B[ZZ]}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) out.axis[i][k] = lanes_set(i == k ? 1 : 0);
    if (dim == 3) {
        enum { SWEEPS = 12 };
        A[0][2] = A[2][0] = B[XZ], A[1][2] = A[2][1] = B[YZ];
        for (int sweep = 0; sweep < SWEEPS; sweep++) {
            lanes off = A[0][1] * A[0][1] + A[0][2] * A[0][2] + A[1][2] * A[1][2];
            lanes size = A[0][0] * A[0][0] + A[1][1] * A[1][1] + A[2][2] * A[2][2];
            lane_mask active = off > LANES_REAL_EPSILON * LANES_REAL_EPSILON / 64 * size;
            if (!lanes_any(active)) break;
            principal_rotate(A, out.axis, 0, 1, active);
            principal_rotate(A, out.axis, 0, 2, active);
            principal_rotate(A, out.axis, 1, 2, active);
        }
    } else {
        principal_rotate(A, out.axis, 0, 1, (lane_mask){0} - 1);
    }
    for (int i = 0; i < 3; i++) out.strain[i] = A[i][i];
    return out;
}

// Sum of value[i] axis[i] (x) axis[i].
BRUNT_INLINE void principal_tensor(int dim, const principal_axes *p, const lanes value[3], lanes out[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < BRUNT_SYMMETRIC(dim); k++) {
        out[k] = value[0] * p->axis[0][row[k]] * p->axis[0][column[k]];
        for (int i = 1; i < 3; i++) out[k] += value[i] * p->axis[i][row[k]] * p->axis[i][column[k]];
    }
}

// (ln x_i - ln x_j) / (2 (x_i - x_j)) with x = 1 + strain. With r = (x_i - x_j) / (x_i + x_j) it is
// artanh(r) / (r (x_i + x_j)); the series of artanh serves while r is small.
BRUNT_INLINE lanes principal_slope(lanes strain_i, lanes strain_j, lanes e_i, lanes e_j) {
    lanes difference = strain_i - strain_j, sum = 2 + strain_i + strain_j, r = difference / sum, z = r * r;
    lanes series = lanes_set((real)(1.0 / 19));
    for (int n = 8; n >= 0; n--) series = series * z + (real)(1.0 / (2 * n + 1));
    lane_mask near = z < (real)0.01;
    lanes apart = (e_i - e_j) / lanes_select(near, lanes_set(1), difference);
    return lanes_select(near, series / sum, apart);
}

// What the tangent is made of: tau_i, c_ij, and (tau_i - tau_j) / (x_i - x_j) of the pairs 01, 02, 12.
typedef struct principal_moduli {
    lanes tau[3], c[3][3], slope[3];
} principal_moduli;

// Adds the tangent in the axes of space.
BRUNT_INLINE void principal_tangent(int dim, const principal_axes *p, const principal_moduli *m, lanes a[45]) {
    enum { PAIR_LIMIT = 9 };
    const int rows = dim * dim;
    lanes R[PAIR_LIMIT][PAIR_LIMIT],
        Z[PAIR_LIMIT][PAIR_LIMIT]; // n_I (x) n_A by pair (I, A); what the tangent in principal axes makes of them
    for (int I = 0; I < dim; I++)
        for (int A = 0; A < dim; A++)
            for (int i = 0; i < dim; i++)
                for (int k = 0; k < dim; k++) R[I * dim + A][i * dim + k] = p->axis[I][i] * p->axis[A][k];
    for (int I = 0; I < dim; I++)
        for (int k = 0; k < rows; k++) {
            lanes sum = -m->tau[I] * R[I * (dim + 1)][k];
            for (int J = 0; J < dim; J++) sum += m->c[I][J] * R[J * (dim + 1)][k];
            Z[I * (dim + 1)][k] = sum;
        }
    for (int I = 0, pair = 0; I < dim; I++)
        for (int J = I + 1; J < dim; J++, pair++) {
            const int ij = I * dim + J, ji = J * dim + I;
            lanes first = (1 + p->strain[J]) * m->slope[pair], second = (1 + p->strain[I]) * m->slope[pair];
            lanes cross = (real)0.5 * ((first - m->tau[J]) + (second - m->tau[I]));
            for (int k = 0; k < rows; k++) {
                Z[ij][k] = first * R[ij][k] + cross * R[ji][k];
                Z[ji][k] = cross * R[ij][k] + second * R[ji][k];
            }
        }
    for (int r = 0; r < rows; r++)
        for (int c = r; c < rows; c++) {
            lanes sum = R[0][r] * Z[0][c];
            for (int k = 1; k < rows; k++) sum += R[k][r] * Z[k][c];
            a[tangent_place(dim, r, c)] += sum;
        }
}
