// How long a step may be for material points that have lost their neighbours.
#pragma once

#include "brunt.h"

// The greatest share of the stable step, h / (c + |v|), at which a point alone (APIC) or two beside each other (PIC and
// FLIP, where one alone keeps nothing to breathe with) gain no energy. 0: the linear kernel with APIC, which makes
// energy at every step.
double brunt_lone_points_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer);
