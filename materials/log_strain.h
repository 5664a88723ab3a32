// Equivalent logarithmic strain of a deformation gradient: sqrt(2/3 e:e) with e the deviator of ln sqrt(F^T F).
//
// Its principal values e_i sum to 0, so that with F scaled to volume 1 tr C + tr C^-1 - 6 = sum 2 (cosh 2 e_i - 1),
// which is at least 4 e:e: (tr C + tr C^-1 - 6) / 6 is a bound of the square, close for small strains, that needs no
// eigenvalues. Only points past the bound are worth those.
//
// As tr C^-1 is at most (tr C)^2 / 3, with x = tr C at volume 1 the bound is at most (x + x^2 / 3 - 6) / 6. So the
// strain is below a limit where |F|^6 < X^3 J^2, X = 3/2 (sqrt(9 + 8 limit^2) - 1): no root, a fraction of the work of
// the bound, and nearly all points of nearly all steps are that far from their limit.
//
// Before that, where nothing has turned far: with g = |F - I| < 1 the principal stretches are within 1 - g and 1 + g,
// and the strain is at most 2/3 of the logarithm of their ratio: below a limit where g < tanh(3/4 limit), for a third
// of the work.
#pragma once

#include <math.h>
#include <stdbool.h>

#include "base/simd_math.h"

// X^3 of a limit, less what rounding may do.
static inline real log_strain_cube(double limit) {
    const double X = 1.5 * (sqrt(9 + 8 * limit * limit) - 1);
    return (real)(X * X * X * (1 - (sizeof(real) == 4 ? 1e-5 : 1e-13)));
}

// g^2 of a limit, less what rounding may do.
static inline real log_strain_near(double limit) {
    const double g = tanh(0.75 * limit);
    return (real)(g * g * (1 - (sizeof(real) == 4 ? 1e-5 : 1e-13)));
}

// A register's worth of reals: of vectors that take several, the compiler would spill all that nine components leave.
#define LOG_STRAIN_REGISTER (__BIGGEST_ALIGNMENT__ < BRUNT_LANE_BYTES ? __BIGGEST_ALIGNMENT__ : BRUNT_LANE_BYTES)
typedef real register_reals __attribute__((vector_size(LOG_STRAIN_REGISTER), aligned(sizeof(real)), may_alias));
typedef lane_int register_signs __attribute__((vector_size(LOG_STRAIN_REGISTER)));
enum { LOG_STRAIN_STEP = LOG_STRAIN_REGISTER / sizeof(real) };

// Whether all points from `begin` to `end` are that near to the identity, or are no numbers, which no limit holds for;
// F: an array for each component, rows one after the other. Signs are gathered: many machines compare vectors piece by
// piece.
BRUNT_INLINE bool log_strain_all_near_dim(int dim, real *const *F, int64_t begin, int64_t end, real near) {
    register_signs negative = ~(register_signs){0};
    for (int64_t s = begin; s < end; s += LOG_STRAIN_STEP) {
        register_reals excess = (register_reals){0} - near;
        for (int c = 0; c < dim * dim; c++) {
            const register_reals g = *(const register_reals *)(F[c] + s) - (real)(c % (dim + 1) == 0);
            excess += g * g;
        }
        negative &= (register_signs)excess;
    }
    bool all = true;
    for (int l = 0; l < LOG_STRAIN_STEP; l++) all = all && negative[l] < 0;
    return all;
}
// `near`: log_strain_near of a limit.
static inline bool log_strain_all_near(int dim, real *const *F, int64_t begin, int64_t end, real near) {
    return dim == 3 ? log_strain_all_near_dim(3, F, begin, end, near) : log_strain_all_near_dim(2, F, begin, end, near);
}

// F with rows one after the other, 3 x 3. Negative where the strain is below the limit that `cube` is of; not where it
// may not be.
BRUNT_INLINE lanes log_strain_excess(const lanes F[9], real cube) {
    const lanes J =
        F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
    lanes square = F[0] * F[0];
    for (int c = 1; c < 9; c++) square += F[c] * F[c];
    return square * square * square - J * J * cube;
}

// Upper bound of the square of the strain; J > 0 is wanted.
BRUNT_INLINE lanes log_strain_bound(const lanes F[9]) {
    lanes C[6], J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
                    F[2] * (F[3] * F[7] - F[4] * F[6]);
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++) {
        int r = row[k], c = column[k];
        C[k] = F[r] * F[c] + F[3 + r] * F[3 + c] + F[6 + r] * F[6 + c];
    }
    lanes first = C[0] + C[1] + C[2],
          second = C[0] * C[1] + C[1] * C[2] + C[2] * C[0] - C[3] * C[3] - C[4] * C[4] - C[5] * C[5];
    lanes scale = lanes_inverse_cbrt(J);
    scale *= scale;
    return (first * scale + second * scale * scale - 6) * (real)(1.0 / 6);
}

// The strain itself, by Jacobi's rotations of C (relative accuracy of the eigenvalues near rounding).
static inline double equivalent_log_strain(const double F[9]) {
    double C[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) C[r][c] = F[r] * F[c] + F[3 + r] * F[3 + c] + F[6 + r] * F[6 + c];
    for (int sweep = 0; sweep < 12; sweep++) {
        double off = 0, size = 0;
        for (int p = 0; p < 3; p++) size += C[p][p] * C[p][p], off += C[p][(p + 1) % 3] * C[p][(p + 1) % 3];
        if (!(off > 1e-30 * size)) break;
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++) {
                if (C[p][q] == 0) continue;
                double theta = (C[q][q] - C[p][p]) / (2 * C[p][q]);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1),
                       s = t * c;
                for (int k = 0; k < 3; k++) {
                    double a = C[p][k], b = C[q][k];
                    C[p][k] = c * a - s * b, C[q][k] = s * a + c * b;
                }
                for (int k = 0; k < 3; k++) {
                    double a = C[k][p], b = C[k][q];
                    C[k][p] = c * a - s * b, C[k][q] = s * a + c * b;
                }
            }
    }
    double e[3], mean = 0, square = 0;
    for (int k = 0; k < 3; k++) e[k] = 0.5 * log(C[k][k]), mean += e[k] / 3;
    for (int k = 0; k < 3; k++) square += (e[k] - mean) * (e[k] - mean);
    return sqrt(2.0 / 3 * square);
}
