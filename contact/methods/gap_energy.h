// Energies that keep gaps open in implicit steps: what a method by energy brings.
#pragma once

typedef struct brunt_barrier_value {
    double b, db, ddb; // [J/m^2, Pa, Pa/m]; INFINITY at d <= 0, where gaps stay open
} brunt_barrier_value;

// The energy of a gap d [m] per area, and its slopes: 0 from `distance` [m] on, with two continuous slopes, falling
// below it, and without bound at 0 where gaps stay open; in proportion to `stiffness` [Pa, or Pa/m].
typedef brunt_barrier_value brunt_gap_energy(double d, double distance, double stiffness);

// Those of methods `barrier`, and `penalty`, which goes on at d <= 0.
brunt_gap_energy brunt_barrier_at, brunt_penalty_at;
