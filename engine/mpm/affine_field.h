// The affine velocity field C = D^-1 sum w v (x_i - x_p)^T of APIC particles (Jiang et al. 2015): how it is read off
// the polynomials of a bin, and how it goes along with the particle.
#pragma once

#include "base/simd.h"

// C is the gradient plus one term per axis, this times the highest coefficient along it (h = 1; derived from the
// splines' moments): quadratic xi (1 - 4 xi^2), cubic -3 xi^2 (1 - xi)^2, linear none.
BRUNT_INLINE lanes affine_correction(int order, lanes xi) {
    return order == 2 ? xi * (1 - 4 * xi * xi) : -3 * xi * xi * (1 - xi) * (1 - xi);
}

// The particle moves after its affine field A has been read off the grid. Seen from its new place the same motion has
// the gradient A (I + dt A)^-1 = A - dt A A + O(dt^2); without the change a turning body gains energy of order dt from
// the stress, 10 % in 20 turns of a stiff cube. Only the symmetric part is taken: spin is exact as it is. Fluids are
// left as they are: their stress does not work on turning, and where particles turn and spread at once the half of the
// change that is taken makes energy (a drop that spreads on a membrane: 3 %). In undeformed coordinates the particle
// does not move. So `turning` is dt / 2, or 0.
BRUNT_INLINE void turn_affine_field(int dim, const lanes *A, real turning, lanes *C) {
    for (int c = 0; c < dim * dim; c++) C[c] = A[c];
    for (int r = 0; r < dim; r++)
        for (int a = r; a < dim; a++) {
            lanes ra = (lanes){0}, ar = (lanes){0};
            for (int k = 0; k < dim; k++) {
                ra += A[r * dim + k] * A[k * dim + a];
                ar += A[a * dim + k] * A[k * dim + r];
            }
            lanes change = turning * (ra + ar);
            C[r * dim + a] -= change;
            if (a != r) C[a * dim + r] -= change;
        }
}
