// Where contact by an energy begins and how stiff it is where a scene does not say, and what is too stiff or too soft.
#pragma once

#include <stdbool.h>

#include "contact/methods/gap_energy.h"

// Distance [m] below which surfaces repel each other, and stiffness [Pa], where a scene gives none: a tenth of the
// smallest edge or spacing of particles, and of Young's modulus of the softer body (INFINITY: one that does not
// deform).
double brunt_barrier_default_distance(double smallest_spacing);
double brunt_barrier_default_stiffness(double young_a, double young_b);

// [Pa/m] The stiffness by which surfaces that may overlap push each other, for contacts of half the length a [m]: a
// twentieth of what the bodies give, E* / a. E* by their moduli E / (1 - nu^2).
double brunt_penalty_default_stiffness(double modulus_a, double modulus_b, double a);

// [s] The longest step by which Newmark's rule follows contact of stiffness `ddb` [Pa/m], b'' at its gap, over `area`
// [m^2] on a mass [kg]: dt^2 area ddb = 4 m. By longer ones gaps chatter; backward Euler damps them.
double brunt_barrier_longest_step(double area, double ddb, double mass);
// Whether a gap at the end of a step is so small a part of `distance` that the stiffness should be raised.
bool brunt_barrier_gap_is_small(double gap, double distance);
