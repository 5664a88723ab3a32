// What a scene says once for all of a run: read everywhere, written only while the world is made.
#pragma once

#include "brunt.h"

typedef struct brunt_settings {
    brunt_world_def given; // all of the definition but its lists; below: what is asked in many places, and what follows
    int dimension, threads;
    bool axisymmetric, has_gravity;
    brunt_transfer transfer;
    brunt_scheme scheme;
    brunt_newton_def newton;     // of implicit steps
    double flip, apic, cell;     // [-] shares that FLIP and APIC keep, [m] of the grids
    bool flip_per_step;          // FLIP's is of an explicit step; else, as APIC's, of the time h / 2c
    double cfl, fixed_step, end; // [-], [s] 0: the stable one, [s]
} brunt_settings;

// Of a definition that has been looked over; `particles`: there are material points. Nothing to free, and no state:
// they do not change.
void brunt_settings_make(brunt_settings *settings, const brunt_world_def *def, bool particles);
void brunt_settings_validate(const brunt_settings *settings); // aborts where one is out of its range
