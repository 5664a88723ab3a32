// Matrices of particles, a vector of them at a time.
#pragma once

#include "base/simd.h"

// Where a component of a symmetric matrix is kept: XX, YY, (ZZ,) XY, YZ, XZ.
#define SYMMETRIC_INDEX(dim, r, c) ((r) == (c) ? (r) : (dim) == 2 ? 3 : (r) + (c) == 1 ? 3 : (r) + (c) == 3 ? 4 : 5)

// The inverse of a matrix with rows one after the other.
BRUNT_INLINE void inverse_matrix(int dim, const lanes *F, lanes *inverse) {
    if (dim == 2) {
        const lanes over = 1 / (F[0] * F[3] - F[1] * F[2]);
        inverse[0] = over * F[3], inverse[1] = -over * F[1], inverse[2] = -over * F[2], inverse[3] = over * F[0];
        return;
    }
    lanes cofactor[9];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            cofactor[3 * r + c] = F[3 * r1 + c1] * F[3 * r2 + c2] - F[3 * r1 + c2] * F[3 * r2 + c1];
        }
    const lanes over = 1 / (F[0] * cofactor[0] + F[1] * cofactor[1] + F[2] * cofactor[2]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) inverse[3 * r + c] = over * cofactor[3 * c + r];
}

// Bound of the square of the greatest 1 / principal stretch of the particles at s: Gershgorin's circles of F^-T F^-1,
// exact along the axes.
BRUNT_INLINE lanes inverse_stretch(int dim, real *const *F, int64_t s) {
    lanes A[9], inverse[9], bound = (lanes){0};
    for (int c = 0; c < dim * dim; c++) A[c] = lanes_load(F[c] + s);
    inverse_matrix(dim, A, inverse);
    for (int r = 0; r < dim; r++) {
        lanes row = (lanes){0};
        for (int c = 0; c < dim; c++) {
            lanes product = (lanes){0};
            for (int k = 0; k < dim; k++) product += inverse[r * dim + k] * inverse[c * dim + k];
            row += c == r ? product : lanes_abs(product);
        }
        bound = lanes_max(bound, row);
    }
    return bound;
}
