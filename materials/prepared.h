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
