// The barrier of contact: an energy per area that is 0 from the distance dhat on and grows without bound as a gap
// closes, b(d) = kappa dhat g(d / dhat), g(s) = -(s - 1)^2 ln s for s < 1 (Li et al. 2020; Li, Kaufman and Jiang 2023
// for the weights). kappa is a pressure [Pa]: b is in J/m^2, -b' is the pressure across the gap.
#pragma once

#include <stdbool.h>

typedef struct brunt_barrier_value {
    double b, db, ddb; // [J/m^2, Pa, Pa/m]; INFINITY at d <= 0
} brunt_barrier_value;

brunt_barrier_value brunt_barrier_at(double d, double distance, double stiffness);

// Distance [m] below which surfaces repel each other, and stiffness [Pa], where a scene gives none: a tenth of the
// smallest edge or spacing of particles, and of Young's modulus of the softer body (INFINITY: one that does not
// deform).
double brunt_barrier_default_distance(double smallest_spacing);
double brunt_barrier_default_stiffness(double young_a, double young_b);

// Whether gaps chatter: contact of stiffness `ddb` [Pa/m] over `area` [m^2] on a mass [kg] that a step `dt` [s] of
// Newmark's rule does not resolve, dt^2 area ddb > 4 m. Backward Euler damps it.
bool brunt_barrier_chatters(double dt, double area, double ddb, double mass);
// Whether a gap at the end of a step is so small a part of `distance` that the stiffness should be raised.
bool brunt_barrier_gap_is_small(double gap, double distance);
