// What a body of material points has in all: mass, energy, momentum.
#pragma once

#include "mpm/mpm_body.h"

// Kinetic energy of a body's particles with the affine part [J], its momentum, and angular momentum about the origin
// with spin; of total-Lagrangian bodies as if their motion were affine within a kernel. Of rings what the whole circle
// has: no radial momentum, no angular momentum, a centre on the axis.
typedef struct brunt_audit {
    double mass, kinetic, linear[3], angular[3], scale_linear, scale_angular;
    double moment[3]; // [kg m] sum m x
} brunt_audit;
brunt_audit brunt_body_audit(brunt_body *body);
// The same of the particles in slots `slots[begin]` to `slots[end - 1]`; NULL: in slots begin to end - 1.
brunt_audit brunt_slots_audit(brunt_body *body, const int64_t *slots, int64_t begin, int64_t end);
void brunt_audit_add(brunt_audit *to, const brunt_audit *part);
