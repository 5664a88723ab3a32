// A material as a body uses it: its models with their constants prepared.
#pragma once

#include "brunt.h"
#include "material.h"

typedef enum brunt_component { BRUNT_STRENGTH, BRUNT_VISCOSITY, BRUNT_EOS, BRUNT_COMPONENTS } brunt_component;

typedef struct brunt_material {
    char name[BRUNT_NAME_LENGTH];
    real density;                               // [kg/m^3]
    const brunt_model *model[BRUNT_COMPONENTS]; // NULL where there is none
    real constants[BRUNT_COMPONENTS][BRUNT_MAX_CONSTANTS];
    real wave_speed; // [m/s] undeformed
} brunt_material;

// Checks the definition and prepares the constants. BRUNT_BAD_INPUT with the offending key.
int brunt_material_make(const brunt_material_def *def, brunt_material *material, brunt_error *error);

// One step of a material over a range: strength, viscosity and equation of state, in this order. points[k] is the range
// as component k sees it, with L, dt and its state; `plastic` and `viscous` have room for points->count reals each, for
// what one component leaves for the next. Gives the wave speed of all components together, and the first point that
// failed in the first component that did.
brunt_update_result brunt_material_update(const brunt_material *material, brunt_points points[BRUNT_COMPONENTS],
                                          real *plastic, real *viscous);
