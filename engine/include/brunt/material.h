// Materials of a definition: a strength model, and where wanted an equation of state, bulk viscosity and a failure
// model. Which models there are, their parameters in order with unit, default, range and source: `brunt keys
// materials`.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include "brunt/error.h"

#ifdef __cplusplus
extern "C" {
#endif

// What becomes of material that a failure model has declared failed.
typedef enum brunt_failure_action {
    BRUNT_FAILURE_ERODE, // its element or material point leaves the body (default)
    BRUNT_FAILURE_SOFTEN // it stays, without strength and without tension; needs an equation of state
} brunt_failure_action;

typedef struct brunt_material_def {
    char name[BRUNT_NAME_LENGTH];                      // that bodies name it by
    double density;                                    // [kg/m^3] > 0
    char strength[BRUNT_NAME_LENGTH];                  // model name; `brunt keys materials` lists them
    double strength_parameters[BRUNT_PARAMETER_LIMIT]; // in the order of the model's parameter table
    char eos[BRUNT_NAME_LENGTH];                       // "" = none
    double eos_parameters[BRUNT_PARAMETER_LIMIT];      // as the strength model's; NAN: not set yet
    bool bulk_viscosity; // linear and quadratic (von Neumann and Richtmyer 1950, Landshoff 1955); default false
    double viscosity_parameters[BRUNT_PARAMETER_LIMIT]; // as the strength model's
    char failure[BRUNT_NAME_LENGTH];                    // "" = none
    double failure_parameters[BRUNT_PARAMETER_LIMIT];   // NAN: of the strength model's parameter of the same name
    brunt_failure_action failure_action;                // of what has failed
} brunt_material_def;

// An unknown model is refused by brunt_material_set and brunt_world_create.
brunt_material_def brunt_material_def_default(const char *name, const char *model);
// A material from the library, by name: `brunt keys presets` lists them with their sources. BRUNT_BAD_INPUT when there
// is none.
int brunt_material_preset(const char *preset, const char *name, brunt_material_def *def, brunt_error *error);
typedef struct brunt_preset_info {
    const char *name, *doc, *source; // source: the publication of its numbers
} brunt_preset_info;
int32_t brunt_preset_count(void);
brunt_preset_info brunt_preset(int32_t index); // 0 <= index < brunt_preset_count()
// Sets "density" or a parameter of the strength model by its key; "eos.<key>", "viscosity.<key>" and "failure.<key>"
// set those of the equation of state, the bulk viscosity and the failure model, and "eos", "failure" with the name as
// `text` (else NULL) and "viscosity" switch them on with their defaults; "failure.action" takes "erode" or "soften" as
// `text`. SI units. BRUNT_BAD_INPUT when there is no such key.
int brunt_material_set(brunt_material_def *def, const char *key, double value, const char *text, brunt_error *error);

#ifdef __cplusplus
}
#endif
