// How far a deformation may go before a volume is zero: det(F + t D) is a polynomial in t, of degree 2 or 3.
#pragma once

#include "base/simd.h"

// Smallest root in (0, end] of c[0] + c[1] t + c[2] t^2 + c[3] t^3, c[0] > 0; INFINITY when there is none.
double brunt_smallest_root(const double c[4], double end);

// `least`, or less where one of the lanes would come to det(F + t D) = 0 before: nine tenths of the way there, so that
// a tenth is left for the step after. F and D with rows one after the other, det F > 0.
BRUNT_INLINE double least_step_to_volume(int dim, const lanes F[9], const lanes D[9], double least) {
    lanes c[4] = {{0}, {0}, {0}, {0}};
    if (dim == 2) {
        c[0] = F[0] * F[3] - F[1] * F[2];
        c[1] = (F[0] * D[3] + D[0] * F[3]) - (F[1] * D[2] + D[1] * F[2]);
        c[2] = D[0] * D[3] - D[1] * D[2];
    } else {
        for (int k = 0; k < 3; k++) { // sum over the first row of entries times minors
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            const lanes *A = F + 3, *B = F + 6, *X = D + 3, *Y = D + 6;
            lanes m0 = A[p] * B[q] - A[q] * B[p], m2 = X[p] * Y[q] - X[q] * Y[p];
            lanes m1 = (A[p] * Y[q] + X[p] * B[q]) - (A[q] * Y[p] + X[q] * B[p]);
            c[0] += F[k] * m0;
            c[1] += F[k] * m1 + D[k] * m0;
            c[2] += F[k] * m2 + D[k] * m1;
            c[3] += D[k] * m2;
        }
    }
    const real end = (real)(least / 0.9);
    lanes loss = end * (lanes_abs(c[1]) + end * (lanes_abs(c[2]) + end * lanes_abs(c[3])));
    if (!lanes_any(~(c[0] > loss))) return least;
    for (int l = 0; l < BRUNT_LANES; l++) {
        const double own[4] = {(double)c[0][l], (double)c[1][l], (double)c[2][l], (double)c[3][l]};
        const double root = 0.9 * brunt_smallest_root(own, least / 0.9);
        if (root < least) least = root;
    }
    return least;
}
