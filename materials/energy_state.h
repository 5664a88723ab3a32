// What equations of state with an internal energy of their own share: the energy a point starts with, and its state.
#pragma once

#include "materials/tensor.h"

enum { INITIAL_ENERGY, ENERGY_CONSTANTS }; // the first constants: [J/m^3]; a model's own begin at ENERGY_CONSTANTS
enum { INTERNAL_ENERGY, COMPRESSION_WORK };

static inline real energy_at_start(const real *constants, int component) {
    (void)component;
    return constants[INITIAL_ENERGY];
}

// Per reference volume: e, with all heat in it, and the work done on the point by its pressure alone, -int p dJ.
static const brunt_state_field energy_state[] = {
    {"internal_energy", "J/m^3", 1, 1, energy_at_start},
    {"compression_work", "J/m^3", 1, 1, NULL},
};
