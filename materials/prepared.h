// A material as a body uses it: its models with their constants prepared.
#pragma once

#include "brunt.h"
#include "materials/material.h"

typedef enum brunt_component {
    BRUNT_STRENGTH,
    BRUNT_VISCOSITY,
    BRUNT_EOS,
    BRUNT_FAILURE,
    BRUNT_COMPONENTS
} brunt_component;

typedef struct brunt_material {
    char name[BRUNT_NAME_LENGTH];
    real density;                               // [kg/m^3]
    const brunt_model *model[BRUNT_COMPONENTS]; // NULL where there is none
    real constants[BRUNT_COMPONENTS][BRUNT_MAX_CONSTANTS];
    real wave_speed;  // [m/s] undeformed
    real rest_stress; // [Pa] what every normal stress is while undeformed: less the pressure of the equation of state
    bool membrane, tension_only; // in plane stress; carries no compression
    bool implicit;    // its steps are implicit: energies are those of the potentials; set by whom makes the world
    bool differences; // no potential, but implicit steps have it by differences of its update; the tangent is whole
    bool erodes;      // points of it may fail, and leave when they do
    brunt_failure_action failure_action;
    // Of models in 2D and 3D: the first of their state arrays that holds this, -1 where there is none. `integrity` is
    // followed by `integrity_before`.
    int8_t temperature[2], integrity[2];
} brunt_material;

// Checks the definition and prepares the constants, leaving out what its parameters switch off. BRUNT_BAD_INPUT with
// the offending key.
int brunt_material_make(const brunt_material_def *def, brunt_material *material, brunt_error *error);
// The same of a membrane: of a model that has a plane-stress form, without equation of state, viscosity and failure.
int brunt_material_make_membrane(const brunt_material_def *def, bool tension_only, brunt_material *material,
                                 brunt_error *error);
// Of a body at `temperature` [K] at the start; 0: that of the models. For those that keep none of their own.
void brunt_material_set_temperature(brunt_material *material, double temperature);
// Stored and dissipated energy of a range [J], of component k; as a membrane when the material is one.
void brunt_material_energy(const brunt_material *material, brunt_component k, const brunt_material_points *points,
                           brunt_point_energy *energy);

// One step of a material over a range: strength, viscosity, equation of state and failure, in this order. points[k] is
// the range as component k sees it, with L, dt, time and its state; `plastic`, `viscous` and `strain` have room for
// points->count reals each, for what one component leaves for the next (strain: [-] plastic, for failure; may be NULL
// without). Gives the wave speed of all components together, the first point whose update is bad in the first component
// that has one, and whether points have failed.
brunt_update_result brunt_material_update(const brunt_material *material,
                                          brunt_material_points points[BRUNT_COMPONENTS], real *plastic, real *viscous,
                                          real *strain);

// --- implicit steps
// NULL when implicit steps can have the material, else why not, in one line.
const char *brunt_material_implicit(const brunt_material *material);
// Place of row m, column n of dim * dim among them.
static inline int brunt_tangent_place(bool whole, int dim, int m, int n) {
    const int low = m < n ? m : n, high = m + n - low, rows = dim * dim;
    return whole ? m * rows + n : low * (2 * rows - low - 1) / 2 + high;
}
// Why a model has no potential with these constants, NULL: it has.
const char *brunt_model_no_potential(const brunt_model *model, const real *constants);
// Components of its tangent in 2D or 3D: of the symmetric half, or of all.
static inline int brunt_material_tangents(const brunt_material *material, int dim) {
    return material->differences ? BRUNT_WHOLE_TANGENT(dim) : BRUNT_TANGENT(dim);
}
// Potential, stress and tangent of all components together, as far as they are wanted (material.h). trial[k] is the
// range as component k sees it; they differ in state alone.
void brunt_material_respond(const brunt_material *material, const brunt_trial_points trial[BRUNT_COMPONENTS]);
// Takes the negative eigenvalues out of the tangents of a trial that has them: those of a as a symmetric matrix, made
// 0. Tangents that are whole stay as they are.
void brunt_material_project(const brunt_material *material, const brunt_trial_points *trial);
// The trial becomes the step: stress and state of points[k], which has F as in the trial. Result as of
// brunt_material_update, as is `plastic`.
brunt_update_result brunt_material_commit(const brunt_material *material,
                                          const brunt_trial_points trial[BRUNT_COMPONENTS],
                                          brunt_material_points points[BRUNT_COMPONENTS], real *plastic);

// --- differences.c: of materials without a potential, as the two above.
void brunt_material_respond_by_differences(const brunt_material *material,
                                           const brunt_trial_points trial[BRUNT_COMPONENTS]);
brunt_update_result brunt_material_commit_by_differences(const brunt_material *material,
                                                         const brunt_trial_points trial[BRUNT_COMPONENTS],
                                                         brunt_material_points points[BRUNT_COMPONENTS], real *plastic);
