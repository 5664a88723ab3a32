// Where a body of material points really ends, as its particles extend.
#pragma once

#include "mpm/mpm_body.h"

// Particles of a body in neighbouring slots.
typedef struct brunt_slot_run {
    int64_t first;
    int32_t count;
} brunt_slot_run;
enum { BRUNT_MAX_SLOT_RUNS = 64 };
// Those of the bins whose kernel covers a node, in no more runs than there are bins; how many runs.
int brunt_extent_runs(const brunt_body *body, int32_t slot, int node, brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS]);

// Where a node of a total-Lagrangian body is now, as its particles see it: mean of x_p + F (X_i - X_p) [m]; `x` its
// undeformed place, replaced when it has any particles.
void brunt_extent_deformed(brunt_body *body, int32_t slot, int node, double x[3]);

// How far the particle in a slot reaches from its centre along unit vector n [m].
double brunt_extent_along(brunt_body *body, int64_t slot, const double n[3]);
// Asks for the numbers that this will need.
void brunt_extent_fetch(brunt_body *body, int64_t slot);
// Where what the particle in a slot has around it meets something `distance` [m] away against unit vector n, once they
// touch: from its centre, and the same where its kernel lives. Friction acts there.
void brunt_extent_arm(brunt_body *body, int64_t slot, const double n[3], double distance, double arm[3],
                      double kernel_arm[3]);
