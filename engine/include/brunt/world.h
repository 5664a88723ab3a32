// A world: made from a definition, stepped, asked for its time and size, destroyed. Two may live side by side.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include "brunt/definition.h"
#include "brunt/error.h"

#ifdef __cplusplus
extern "C" {
#endif

// The engine is built for double or for float; the symbols differ, so that a mismatch fails to link.
#ifdef BRUNT_FLOAT
#define brunt_world_create brunt_world_create_float
#define brunt_world_step brunt_world_step_float
#endif

// Time is integrated by central differences, for all bodies: places, stress and stored energy are those of the world's
// time, velocities, momenta, kinetic energy, work and impulses those of the middle of the last step, up to which forces
// have acted; a force is an impulse over the time it acted, the mean of the steps before and after. Thrown bodies are
// at g t^2 / 2 exactly, with velocities g (t - dt / 2).
typedef struct brunt_world brunt_world;

// Fills the bodies and makes the plan. NULL and an error (BRUNT_BAD_INPUT) when the definition cannot be run, whatever
// is wrong with it: numbers, enumerators, counts and names in it are looked at first. The functions below want a world
// that has been made, and indices that are there.
brunt_world *brunt_world_create(const brunt_world_def *def, brunt_error *error);
void brunt_world_destroy(brunt_world *world); // frees all of it; NULL: nothing

// One time step. BRUNT_OK, or BRUNT_FAILED with where and why; the world then is as the failing step left it, to be
// looked at; or BRUNT_STOPPED, see below. `limit` [s]: a time that must be hit exactly (an output time), INFINITY for
// none.
int brunt_world_step(brunt_world *world, double limit, brunt_error *error);

// Asks the world to leave a step that is long, as implicit ones and load steps may be: `asked` is called by the thread
// that takes the step before each factorisation and in each iteration of conjugate gradients. Once it says true the
// step ends with BRUNT_STOPPED, and the state is that of the step before, to the bit.
typedef struct brunt_stop {
    bool (*asked)(void *context); // NULL: never
    void *context;
} brunt_stop;
void brunt_world_heed(brunt_world *world, const brunt_stop *stop); // copied; NULL: nothing (default)

// Whether the last step failed and has changed nothing, as implicit ones do whose equations were not solved: the state
// is that of the step before, which others may go on from.
bool brunt_world_step_withdrawn(const brunt_world *world);

double brunt_world_time(const brunt_world *world);       // [s]
double brunt_world_end(const brunt_world *world);        // [s]
int64_t brunt_world_steps(const brunt_world *world);     // taken so far
double brunt_world_dt(const brunt_world *world);         // [s] of the last step, or the first one to come
double brunt_world_dt_min(const brunt_world *world);     // [s] of the steps so far
double brunt_world_dt_max(const brunt_world *world);     // likewise
int brunt_world_dimension(const brunt_world *world);     // 2 (axisymmetric ones, too) or 3
int brunt_world_threads(const brunt_world *world);       // that its passes run on
int64_t brunt_world_particles(const brunt_world *world); // material points there are now: less those eroded
int64_t brunt_world_nodes(const brunt_world *world);     // grid nodes alive in the last step, and nodes of meshes
int64_t brunt_world_elements(const brunt_world *world);  // of meshes, less those eroded

// Warnings about the scene: found when the world was made (contact grids too fine or too coarse, doubtful meshes), or
// in a step (fluids that have spread until cells are empty between their particles).
int32_t brunt_warning_count(const brunt_world *world);
const char *brunt_world_warning(const brunt_world *world, int32_t warning); // a sentence, owned by the world

#ifdef __cplusplus
}
#endif
