// How long a step may be for material points that have lost their neighbours.
//
// All the force of a lone point goes through its own weights. Squeezed by e, it gives node i the acceleration
// s_i/w_i (dim lambda + 2 G) e / rho and gets back the mean with weights s_i: an oscillator of
//   omega^2 = S (dim lambda + 2 G) / rho,  S = greatest of sum s_i^2 / w_i an axis (6/h^2 of the quadratic kernel),
// while the step is a share of h/c with rho c^2 = lambda + 2 G: omega dt < 2 is cfl < sqrt(2/3 (1 - nu) / (1 + nu)) in
// three dimensions, 0.60 for nu = 0.3, 0.47 for a fluid. The table is measured (tests/stability/test_point_steps.c), at
// nu = 0.3 and 11 places in a cell, to a tenth; for nu = 0.49 about a fifth less holds. Rings are no worse than plane
// strain down to 0.5. With the linear kernel s_i/w_i has no bound, so that no step is stable for sure; it is left at
// the 0.5 that pairs bear at any such place, and with APIC makes energy at every step.
#include "mpm/courant.h"

#include <math.h>

double brunt_lone_points_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer) {
    static const double limit[2][3][3] = {
        // PIC, FLIP, APIC
        {{0.5, 0.5, 0}, {0.5, 0.5, 0.6}, {0.7, 0.7, 0.8}}, // 2D: linear, quadratic, cubic
        {{0.5, 0.5, 0}, {0.4, 0.4, 0.5}, {0.6, 0.6, 0.7}}, // 3D
    };
    return limit[dimension == 3][kernel - BRUNT_LINEAR][transfer];
}

// Measured, too (tests/stability/test_point_steps.c): blocks of four cells, of one to three points a cell along each
// axis and Poisson's ratios up to 0.499, at seven places in a cell, rounded down. Points that hold together move each
// other's nodes, which are heavier than a point alone has them.
double brunt_together_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer) {
    static const double limit[2][3][3] = {
        // PIC, FLIP, APIC
        {{0, 0, 0}, {0.5, 0.5, 0.6}, {0.7, 0.7, 0.9}}, // 2D: linear, quadratic, cubic
        {{0, 0, 0}, {0.5, 0.5, 0.6}, {0.6, 0.6, 0.8}}, // 3D
    };
    return limit[dimension == 3][kernel - BRUNT_LINEAR][transfer];
}

double brunt_share_left(double share, double speed, double cell, double dt) {
    return pow(share, 2 * speed * dt / cell);
}

double brunt_default_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer) {
    const double limit = brunt_lone_points_cfl(dimension, kernel, transfer);
    return limit > 0 ? fmin(0.5, limit) : 0.5;
}
