// How long a step may be for material points that have lost their neighbours.
#pragma once

#include "brunt.h"

// The greatest share of the stable step, h / (c + |v|), at which a point alone (APIC) or two beside each other (PIC and
// FLIP, where one alone keeps nothing to breathe with) gain no energy. 0: the linear kernel with APIC, which makes
// energy at every step.
double brunt_lone_points_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer);

// Of the stable step, where APIC keeps a share: a cube that spins (spinning_cube, share 0.98) holds twenty turns at
// 0.95 and bursts within 26 steps at 1.
#define BRUNT_SHARE_CFL 0.9
// What a step `dt` [s] leaves of a share, 0..1, that is what h / 2c leaves: share^(2 c dt / h), c of the undeformed
// material `speed` [m/s], which is the same at all times, h the cell. The product over steps goes by their time alone.
double brunt_share_left(double share, double speed, double cell, double dt);
