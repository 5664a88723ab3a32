// B-splines of the background grids: weights, slopes and second moments (Steffen, Kirby and Berzins 2008).
//
// Order 1 linear, 2 quadratic, 3 cubic: order + 1 nodes along each axis, from the base node on. u: cells from the base
// node to the point, in [0,1) linear, [1/2,3/2) quadratic, [1,2) cubic.
#pragma once

#include <math.h>

#include "base/simd.h"

BRUNT_INLINE void bspline_weights(int order, lanes u, lanes *w) {
    if (order == 1) {
        w[0] = 1 - u, w[1] = u;
    } else if (order == 2) {
        lanes a = (real)1.5 - u, b = u - 1, c = u - (real)0.5;
        w[0] = (real)0.5 * a * a, w[1] = (real)0.75 - b * b, w[2] = (real)0.5 * c * c;
    } else {
        lanes f = u - 1, e = 1 - f;
        w[0] = e * e * e * (real)(1.0 / 6);
        w[1] = (real)(2.0 / 3) + f * f * ((real)0.5 * f - 1);
        w[2] = (real)(2.0 / 3) + e * e * ((real)0.5 * e - 1);
        w[3] = f * f * f * (real)(1.0 / 6);
    }
}

// Their derivatives [1/m].
BRUNT_INLINE void bspline_slopes(int order, lanes u, real inv_h, lanes *g) {
    if (order == 1) {
        g[0] = lanes_set(-inv_h), g[1] = lanes_set(inv_h);
    } else if (order == 2) {
        g[0] = inv_h * (u - (real)1.5), g[1] = inv_h * -2 * (u - 1), g[2] = inv_h * (u - (real)0.5);
    } else {
        lanes f = u - 1, e = 1 - f;
        g[0] = inv_h * (real)-0.5 * e * e;
        g[1] = inv_h * f * ((real)1.5 * f - 2);
        g[2] = inv_h * -e * ((real)1.5 * e - 2);
        g[3] = inv_h * (real)0.5 * f * f;
    }
}

// Second moment D = sum w (x_i - x)^2 along one axis [m^2]; x relative to a node. The linear one depends on x.
BRUNT_INLINE lanes bspline_moment(int order, lanes x, real h, real inv_h) {
    if (order == 2) return lanes_set(h * h * (real)0.25);
    if (order == 3) return lanes_set(h * h * (real)(1.0 / 3));
    lanes u = x * inv_h;
    for (int l = 0; l < BRUNT_LANES; l++) u[l] -= (real)floor((double)u[l]);
    return u * (1 - u) * h * h;
}

// --- point by point
// Weights of the order + 1 nodes for a point u cells past the base node; 0 beyond them.
void brunt_bspline_weights(int order, double u, double weight[4]);
// Their derivatives [1/cell].
void brunt_bspline_slopes(int order, double u, double slope[4]);
// What the gradient of the affine field is made of, w (x_i - x) / D [1/cell]: the nodes' velocities summed with weight
// + arm * lever are the velocity at an arm's length [cells], exactly so where that field is affine, and an impulse
// given to them by the same numbers acts there.
void brunt_bspline_levers(int order, double u, const double weight[4], double lever[4]);

// --- of `width` nodes about a point
// Their weights, for a point at xi [cells], and the number of the first of them: 3, the quadratic B-spline; 4, the mean
// of two quadratic B-splines half a cell to either side.
static inline void brunt_bspline_about(int width, double xi, double *first, double w[4]) {
    if (width == 3) {
        double centre = floor(xi + 0.5), t = xi - centre;
        *first = centre - 1;
        w[0] = 0.5 * (0.5 - t) * (0.5 - t), w[1] = 0.75 - t * t, w[2] = 0.5 * (0.5 + t) * (0.5 + t), w[3] = 0;
        return;
    }
    double below = floor(xi), t = xi - below, a = (1 - t) * (1 - t), b = 1 + 2 * t - 2 * t * t, c = t * t;
    *first = below - 1;
    w[0] = a / 4, w[1] = (a + b) / 4, w[2] = (b + c) / 4, w[3] = c / 4;
}
// Their second moment, the same wherever the point lies [cell^2].
static inline double brunt_bspline_about_moment(int width) { return width == 3 ? 0.25 : 0.5; }
