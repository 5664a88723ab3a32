#include "contact/barrier/barrier_function.h"

#include <math.h>

// Newmark's rule amplifies nothing, but does not damp what it does not resolve: its limit is (dt omega)^2 = 4.
static const double NEWMARK_LIMIT = 4, SMALL_GAP = 1e-3, DEFAULT_PART = 0.1, STIFFER = 20;

double brunt_barrier_default_distance(double smallest_spacing) { return DEFAULT_PART * smallest_spacing; }

double brunt_barrier_default_stiffness(double young_a, double young_b) { return DEFAULT_PART * fmin(young_a, young_b); }

double brunt_penalty_default_stiffness(double modulus_a, double modulus_b, double a) {
    return STIFFER / (1 / modulus_a + 1 / modulus_b) / a;
}

double brunt_barrier_longest_step(double area, double ddb, double mass) {
    return sqrt(NEWMARK_LIMIT * mass / (area * ddb));
}

bool brunt_barrier_gap_is_small(double gap, double distance) { return gap < SMALL_GAP * distance; }
