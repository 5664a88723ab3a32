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

#define ENERGY_EOS .eos = true, .state = energy_state, .state_count = BRUNT_COUNT(energy_state)

// That of the start counts: a gas begins with some, a solid has 0.
static inline void add_internal_energy(const real *constants, const brunt_material_points *points,
                                       brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES)
        total_add(&stored, lanes_load(points->volume + i) *
                               (constants[INITIAL_ENERGY] + lanes_load(points->state[COMPRESSION_WORK] + i)));
    energy->internal += total_end(&stored);
}

// J at the end of a step and its change in it, of J_old = J / (1 + v): dJ = J v / (1 + v).
typedef struct volume_step {
    lanes change, J, dJ, growth; // J - 1; J; of J in the step; v
} volume_step;

BRUNT_INLINE volume_step load_volume_step(int dim, const brunt_material_points *points, int32_t i,
                                          update_record *record) {
    lanes H[9];
    load_displacement_gradient(dim, points, i, H);
    volume_step s = {.change = volume_change(dim, H)};
    load_step_gradient(dim, points, i, H);
    s.growth = volume_change(dim, H);
    s.J = 1 + s.change, s.dJ = s.J * (s.growth / (1 + s.growth));
    note_deformation(record, lanes_select(1 + s.growth > 0, s.J, lanes_set(0)), i);
    return s;
}

// What a step begins with, per reference volume: energy and pressure, the change of J, the heat of flow and viscosity.
typedef struct energy_step {
    lanes energy, pressure, change, heat;
} energy_step;

BRUNT_INLINE lanes step_heat(const brunt_material_points *points, int32_t i, lanes change) {
    lanes heat = lanes_set(0);
    if (points->plastic_increment) heat += lanes_load(points->plastic_increment + i);
    if (points->viscous_pressure) heat -= lanes_load(points->viscous_pressure + i) * change;
    return heat;
}

// Pressure at which a point tears that carries `tension` [Pa] while it is whole.
BRUNT_INLINE lanes tear_pressure(real tension, const real *integrity, int32_t i) {
    lanes sound = lanes_set(-tension);
    return integrity ? lanes_select(lanes_load(integrity + i) > 0, sound, lanes_set(0)) : sound;
}

// Keeps the pressure at a step's end at `least`, with the energy that this leaves; gives where that is.
BRUNT_INLINE lane_mask tear_at(const energy_step *step, lanes least, lanes *energy, lanes *pressure) {
    lane_mask torn = *pressure < least;
    lanes left = step->energy - (real)0.5 * (step->pressure + least) * step->change + step->heat;
    *energy = lanes_select(torn, left, *energy);
    *pressure = lanes_max(*pressure, least);
    return torn;
}

// The end of a step: the energy, the work of the pressure in it, and J p, which adds to the stress.
BRUNT_INLINE void store_energy_step(const brunt_material_points *points, int32_t i, lanes energy, lanes work,
                                    lanes Jp) {
    real *sum = points->state[COMPRESSION_WORK] + i;
    lanes_store(points->state[INTERNAL_ENERGY] + i, energy);
    lanes_store(sum, lanes_load(sum) + work);
    for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) - Jp);
}
