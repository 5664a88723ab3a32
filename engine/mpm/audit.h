// What a body of material points has in all: mass, energy, momentum.
#pragma once

#include "mpm/mpm_body.h"

// Kinetic energy of a body's particles with the affine part [J], its momentum, and angular momentum about the origin
// with spin; of total-Lagrangian bodies as if their motion were affine within a kernel. Of rings what the whole circle
// has: no radial momentum, no angular momentum, a centre on the axis.
typedef struct brunt_audit {
    double mass, kinetic, linear[3], angular[3], centre[3], scale_linear, scale_angular;
} brunt_audit;
brunt_audit brunt_body_audit(brunt_body *body);
// The same of the particles in `count` slots.
brunt_audit brunt_slots_audit(brunt_body *body, const int64_t *slots, int64_t count);
