// The material of one block's particles, and what their stress does.
#pragma once

#include "mpm/transfer.h"

// What the stress of the block's particles does over the rates `gradient` and, of rings, `hoop` (else NULL) [W].
double brunt_stress_power(brunt_body *body, const brunt_block *block, real dt, real *const *gradient, const real *hoop);
// The nine components of a ring's velocity gradient, of `padded` particles, from what g2p has left in work->out.
void brunt_hoop_rates(const brunt_workspace *work, int32_t padded, real *rates[9]);
// Stress and state of the block's particles over a step `dt` at the velocity gradient given; fills what the report says
// of the material.
void brunt_update_points(brunt_body *body, const brunt_block *block, real dt, brunt_workspace *work,
                         real *const *gradient, brunt_block_report *report);
