// What a material is: a table of functions over a range of points, described by tables of parameters and state.
//
// A material knows no body, grid or element: it sees parameters, the deformation gradient and its rate, dt and state;
// it writes Kirchhoff stress tau = J sigma and state. Points come in whole vectors of BRUNT_LANES (padding points
// repeat a real point with mass and volume 0), so no function here needs a tail loop.
//
// A body's material is up to four components applied in this order over the same range:
//   strength   (required)  deviatoric stress; also the pressure when there is no equation of state
//   viscosity  (optional)  artificial bulk viscosity: adds q to the pressure while the material is being compressed
//   eos        (optional)  pressure from density and internal energy
//   failure    (optional)  damage from stress, plastic strain, rate and temperature of the strength model
// What damage does to strength and tension acts from the next step on, by `integrity`; whether a failed point then
// leaves its body is not the material's business. Each update gets brunt_material_points with its own state arrays.
// With an eos the strength writes the deviatoric stress alone.
//
// Work and dissipation are trapezoidal in time: the mean of the stresses at both ends of a step, times its rate. That
// is what central differences do (summed over a run, force at t_n times the mean of the velocities about it is the same
// sum, each stress with the rate as seen from its own configuration), so the energies here close with the kinetic
// energy of the leap-frog.
//
// Adding one: a new file with its table, and one line in materials/list.c.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/real.h"

enum { BRUNT_MAX_PARAMETERS = 24, BRUNT_MAX_CONSTANTS = 48, BRUNT_MAX_STATE = 24 };

// A range of `count` points (a multiple of BRUNT_LANES). Arrays are one per scalar component, aligned to a vector.
typedef struct brunt_material_points {
    int32_t count;
    int dim;          // 2 (plane strain) or 3
    real dt;          // [s]
    real time;        // [s] at the end of the step
    real cell;        // [m] length scale of the discretisation (for the artificial viscosity)
    real wave_speed;  // [m/s] of the undeformed body (for the artificial viscosity)
    const real *L[9]; // velocity gradient over the step [1/s], BRUNT_MATRIX(dim) components
    bool finite;      // an implicit step: dt L = f - I may be of any size, a turn by radians among them
    real *F[9];       // deformation gradient at the end of the step [-] (already updated: F = (I + dt L) F_old)
    real *stress[6];  // Kirchhoff stress [Pa]; in: of the last step, out: of this step; BRUNT_SYMMETRIC(dim) components
    bool may_reshape; // F is the points' own memory (material points): a fluid may replace it by one of the same J
    bool tension_only;            // of a membrane: it carries no compression
    real *thickness;              // of a membrane: stretch across it at the end of the step [-], written; else NULL
    const real *volume;           // reference volume [m^3]; 0 for padding
    real *state[BRUNT_MAX_STATE]; // this component's own state arrays, in the order of its state table
    // What one component leaves for the next, within one update (never stored): dissipation and viscous pressure.
    real *plastic_increment; // [J/m^3 of reference volume] what the strength model dissipated in this step; NULL when
                             // it is not read (no eos), or when it is neither plastic nor viscous
    real *strain_increment;  // [-] equivalent plastic strain of this step, from the strength model; NULL when it is
                             // not read
    // What failure says to the others, and they to it.
    const real *integrity; // [-] 1 sound .. 0 failed, as the last step left it: a factor on the flow stress; at 0 there
                           // is no tension either. NULL when nothing softens
    const real
        *integrity_before;   // [-] the same as the step before left it: that of the stress at the start of this step
    const real *temperature; // [K] of the strength model at the end of the step, for failure; NULL when it has none
    real *viscous_pressure;  // [Pa] q > 0 in compression, mean of the last step's and this one's: its work in the step
                             // is -viscous_pressure dJ per reference volume; NULL when it is not read
} brunt_material_points;

// What an update tells its caller.
typedef struct brunt_update_result {
    real wave_speed;    // [m/s] greatest among the points; of a body: brunt_wave_speed of its components' results
    int32_t bad;        // index of the first point that failed, -1 when none did
    const char *reason; // why, e.g. "the deformation gradient has turned inside out (J <= 0)"
    real viscosity;     // [m/s] of a strength model with shear_viscous: what it adds to Q of brunt_wave_speed
    bool failed;        // a point with volume has failed: its first state component named "damage" is at least 1
} brunt_update_result;

// Energies of a range, per kind [J]. A component adds its own share.
typedef struct brunt_point_energy {
    double internal;  // stored (recoverable) energy, and heat of an equation of state
    double plastic;   // dissipated by plastic flow
    double viscosity; // dissipated by the artificial viscosity
    double heat;      // of `plastic`, what has warmed the points adiabatically: part of it, no term of the sum
} brunt_point_energy;

// --- implicit steps

// Upper half of the matrix of a tangent, row by row; its rows and columns are pairs (component i of the displacement,
// direction a of its gradient), in the order of BRUNT_MATRIX.
#define BRUNT_TANGENT(dim) ((dim) == 3 ? 45 : 10)
// All of it, row by row, of materials whose tangent is not symmetric (brunt_material.differences).
#define BRUNT_WHOLE_TANGENT(dim) ((dim) == 3 ? 81 : 16)
enum { BRUNT_TANGENT_LIMIT = BRUNT_WHOLE_TANGENT(3) };

// What of a step is asked for.
typedef enum brunt_trial_part {
    BRUNT_TRIAL_END,     // what is minimised
    BRUNT_TRIAL_START,   // f = I: the stress that the start holds. It is that of the last step, and of its rate
    BRUNT_TRIAL_ACCOUNT, // density: what is stored at the end and what the step has dissipated, the minimum reached
} brunt_trial_part;

typedef struct brunt_trial_rule {
    brunt_trial_part part;
    // Share that the integrator gives to forces at the start of the step, [0, 1). Stresses that follow a fluid's rate
    // are of the mean rate of the step and act at its end alone, 1 / (1 - start) times: over the step, whole.
    real start;
} brunt_trial_rule;

// The end of a step as it is tried: nothing of it is kept. F and f are of the end; state is that of the start of the
// step, as the others' arrays are. Of `density`, `stress`, `tangent` those are written that are not NULL: by a strength
// model, and an equation of state adds its own.
typedef struct brunt_trial_points {
    int32_t count;                      // a multiple of BRUNT_LANES
    int dim;                            // 2 (plane strain) or 3
    real dt;                            // [s]; INFINITY when there is no time: nothing is viscous
    brunt_trial_rule rule;              // 0: the end of a step of backward Euler
    const real *F[9];                   // deformation gradient [-]
    const real *f[9];                   // of the step [-]: F = f F_old
    const real *state[BRUNT_MAX_STATE]; // this component's own
    // Of materials by differences: reference volume [m^3], NULL: all alike; stress at the start [Pa], NULL: none.
    const real *volume, *old_stress[6];
    // Incremental potential W per reference volume [J/m^3]: what is stored at the end, and what the step dissipates.
    // INFINITY where J is not positive.
    real *density;
    // tau = P F^T, P = dW/dF [Pa], BRUNT_MATRIX(dim) components (not symmetric where the model is not objective).
    real *stress[9];
    // a = F F d2W/dFdF [Pa], BRUNT_TANGENT(dim) components: with spatial gradients g_A, g_B of two shape functions, the
    // reference volume V0 and component i at A, j at B: d2(V0 W)/du_Ai du_Bj = V0 sum_ab g_Aa a_iajb g_Bb.
    real *tangent[BRUNT_TANGENT_LIMIT];
} brunt_trial_points;

// What a model gives to implicit steps.
typedef struct brunt_model_potential {
    // Why there is no potential with these constants, in a few words, NULL: there is. NULL: always.
    const char *(*refuses)(const real *constants);
    void (*respond)(const real *constants, const brunt_trial_points *trial);
    // The trial becomes the step: writes state; a strength model overwrites the stress, an equation of state adds to
    // it. points->L is not given. NULL: the model's `update` does it, which then reads neither L nor dt.
    brunt_update_result (*commit)(const real *constants, const brunt_trial_points *trial,
                                  const brunt_material_points *points);
    // As the model's own, NULL: that.
    void (*energy)(const real *constants, const brunt_material_points *points, brunt_point_energy *energy);
    // Of a membrane; NULL: it has none. Points have dim 2, F is the symmetric stretch U in their plane, not a number
    // where there is none. With C = U^2 and pairs of the plane in the order 11, 22, 12:
    //   density W(C), stress[0..2] S = 2 dW/dC, tangent[0..5] 4 d2W/dCdC: 11 11, 11 22, 11 12, 22 22, 22 12, 12 12.
    void (*respond_membrane)(const real *constants, bool tension_only, const brunt_trial_points *trial);
} brunt_model_potential;

typedef struct brunt_parameter {
    const char *key;         // as typed in a scene
    const char *unit;        // "Pa", "1", "K", "J/kg/K"
    double initial;          // the default; NAN when it must be given
    double min, max;         // allowed range ...
    bool min_open, max_open; // ... without its ends
    const char *doc;         // one line
} brunt_parameter;

typedef struct brunt_state_field {
    const char *name; // the field's standard term: "plastic_strain"
    const char *unit;
    int components3, components2; // scalars in 3D, in 2D
    // Value a new point starts with: NULL for 0, else computed from the prepared constants, per component.
    real (*initial)(const real *constants, int component);
} brunt_state_field;

typedef struct brunt_model {
    const char *name; // as typed in a scene: "neo-hookean"
    const char *doc;  // one line, with its source
    // The effects it brings: the plan and the summary list them. A model whose parameters switch one off has a reduced
    // form that does not bring it.
    bool plastic, rate_dependent, thermal, eos, viscous, damage;
    bool explosive;     // burns: has a state "ignition_time" [s], set from the detonators when a body is made, and
                        // its first parameter "detonation_speed" [m/s]
    bool fluid;         // remembers no shape: the history of F but for J is nothing to it
    bool shear_viscous; // a strength model whose stress follows the rate of shear, and dissipates
    bool needs_eos;     // has no pressure of its own
    bool accepts_eos;   // a strength model whose pressure an equation of state may replace
    bool small_strain;  // by definition not rotation invariant: exempt from what holds for finite rotations
    const brunt_parameter *parameters;
    int parameter_count; // density is common to all and not listed here
    const brunt_state_field *state;
    int state_count;
    int flops[3]; // arithmetic of an update of a point that does not flow, in 2D, in 3D, of a membrane, as executed
                  // (divisions and roots 1); 0: not counted
    // Fills `constants` (at most BRUNT_MAX_CONSTANTS reals, laid out as the model likes) from the parameters.
    // `density` [kg/m^3]; `with_eos`: the pressure comes from an equation of state. Returns NULL, or what is wrong, in
    // a few words.
    const char *(*prepare)(const double *parameters, double density, bool with_eos, real *constants);
    // What is left of the model when `parameters` switch effects off, with less state to keep; NULL: the model itself.
    // NULL where there is no such form. Constants are the same.
    const struct brunt_model *(*reduced)(const double *parameters);
    // Whether nothing at all is left of a model that is optional; NULL: something always is.
    bool (*off)(const double *parameters);
    // Of a form whose points keep no temperature: what its constants are at `temperature` [K], which stays. NULL: they
    // do not depend on it.
    void (*set_temperature)(real *constants, double temperature);
    // One step for a range. Writes stress and state; a strength model overwrites the stress, the others add to it.
    brunt_update_result (*update)(const real *constants, const brunt_material_points *points);
    // Adds the range's energies to `energy`.
    void (*energy)(const real *constants, const brunt_material_points *points, brunt_point_energy *energy);
    // The same measure as the update's wave_speed, of the undeformed material at rest [m/s]: the first time step, and
    // the plan.
    real (*wave_speed)(const real *constants);
    // The same of a membrane (plane stress), NULL when there is no such form. Points then have dim 2; F is the
    // symmetric stretch U in the plane (F^T F = U U), L is not given; stress is the Kirchhoff stress R^T tau R in the
    // same axes, its ZZ 0; `thickness` is written. With `tension_only` the stress is that of the relaxed energy
    // (tension field theory): 0 when both principal stresses would be compressive, uniaxial tension when one would.
    brunt_update_result (*update_plane_stress)(const real *constants, const brunt_material_points *points);
    void (*energy_plane_stress)(const real *constants, const brunt_material_points *points, brunt_point_energy *energy);
    real (*wave_speed_plane_stress)(const real *constants);
    const brunt_model_potential *potential; // for implicit steps; NULL: it has none ...
    const char *no_potential;               // ... because, after "the model's name ": "depends on the rate of strain"
    // Without a potential: implicit steps take the stress of `update` and a tangent of its differences.
    bool differences;
} brunt_model;

// The lists. Order is the order of `brunt keys`.
extern const brunt_model *const brunt_strength_models[];
extern const int brunt_strength_model_count;
extern const brunt_model *const brunt_eos_models[];
extern const int brunt_eos_model_count;
extern const brunt_model *const brunt_failure_models[];
extern const int brunt_failure_model_count;
extern const brunt_model brunt_bulk_viscosity; // there is one

// Wave speed that limits the time step [m/s]. A strength model gives the longitudinal speed, or with an eos its shear
// share sqrt(4/3 mu / rho); an eos the bulk sound speed; their squares add. A viscosity gives Q = linear c + quadratic
// l |tr L|: an explicit step of length l is stable up to l / (Q + sqrt(Q^2 + c^2)) (Hallquist, LS-DYNA theory manual,
// time step control). What a body does not have is 0.
real brunt_wave_speed(real strength, real eos, real viscosity);

// Finds a model by name, NULL when there is none.
const brunt_model *brunt_find_strength(const char *name);
const brunt_model *brunt_find_eos(const char *name);
const brunt_model *brunt_find_failure(const char *name);
