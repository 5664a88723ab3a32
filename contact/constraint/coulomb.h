// The law of contact: an impulse along the normal that only pushes, and Coulomb's friction cone, by which the one
// across it is at most the coefficient of friction times that. Whatever sweeps over contacts takes its steps from this
// file.
#pragma once

#include <math.h>
#include <stdbool.h>

// Adds `asked`, which would end the approach, to the normal impulse in all [N s], but leaves no less than `least` of
// it: 0 of what lets go, -INFINITY of what holds. What that changes it by.
static inline double brunt_coulomb_bound(double *normal_impulse, double least, double asked) {
    const double now = fmax(least, *normal_impulse + asked), added = now - *normal_impulse;
    *normal_impulse = now;
    return added;
}
static inline double brunt_coulomb_normal(double *normal_impulse, double asked) {
    return brunt_coulomb_bound(normal_impulse, 0, asked);
}

// The size of an impulse of `size` across the normal that the cone lets through [N s].
static inline double brunt_coulomb_size(double friction, double normal_impulse, double size) {
    return fmin(size, friction * normal_impulse);
}

// Takes the friction impulse in all to `wanted`, which would end the slip, or to the point of the cone that is nearest
// to it; `change` is what that adds. Whether it slips.
static inline bool brunt_coulomb_project(int dim, double friction, double normal_impulse, const double *wanted,
                                         double *friction_impulse, double *change) {
    double size = 0;
    for (int a = 0; a < dim; a++) size += wanted[a] * wanted[a];
    size = sqrt(size);
    const double limit = friction * normal_impulse;
    const bool slips = size > limit;
    const double share = slips ? limit / size : 1;
    for (int a = 0; a < dim; a++) {
        const double now = share * wanted[a];
        change[a] = now - friction_impulse[a];
        friction_impulse[a] = now;
    }
    return slips;
}

// Size of a change of impulse [N s].
static inline double brunt_coulomb_norm(int dim, const double *change) {
    double square = 0;
    for (int a = 0; a < dim; a++) square += change[a] * change[a];
    return sqrt(square);
}
