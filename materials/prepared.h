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
    real rest_stress; // [Pa] what every normal stress is while undeformed: less the pressure of the equation of state
    bool sheet, slack; // in plane stress; bears no compression
} brunt_material;

// Checks the definition and prepares the constants. BRUNT_BAD_INPUT with the offending key.
int brunt_material_make(const brunt_material_def *def, brunt_material *material, brunt_error *error);
// The same of a sheet: of a model that has a plane-stress form, without equation of state and viscosity.
int brunt_material_make_sheet(const brunt_material_def *def, bool slack, brunt_material *material, brunt_error *error);
// Stored and dissipated energy of a range [J], of component k; as a sheet when the material is one.
void brunt_material_energy(const brunt_material *material, brunt_component k, const brunt_points *points,
                           brunt_point_energy *energy);

// One step of a material over a range: strength, viscosity and equation of state, in this order. points[k] is the range
// as component k sees it, with L, dt and its state; `plastic` and `viscous` have room for points->count reals each, for
// what one component leaves for the next. Gives the wave speed of all components together, and the first point that
// failed in the first component that did.
brunt_update_result brunt_material_update(const brunt_material *material, brunt_points points[BRUNT_COMPONENTS],
                                          real *plastic, real *viscous);
