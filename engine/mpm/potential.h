// What a body of material points adds to what an implicit step minimises: the incremental potential of its material at
// the points, V0 W((I + grad u) F_old), grad u at the point's place at the start of the step. Nothing of the body
// changes before brunt_mpm_commit.
//
// Unknowns are displacements of the nodes of the body's own grid, which are at rest where the grid has them when the
// step begins. Particles have to be sorted for the step (mpm/sort.h).
#pragma once

#include "linear/term.h"
#include "mpm/mpm_body.h"

// NULL when implicit steps can have the body, else why not, in one line.
const char *brunt_mpm_implicit(const brunt_body *body);

typedef struct brunt_mpm_potential brunt_mpm_potential;
brunt_mpm_potential *brunt_mpm_potential_make(brunt_body *body, brunt_error *error); // NULL with the reason
void brunt_mpm_potential_free(brunt_mpm_potential *potential);
size_t brunt_mpm_potential_bytes(const brunt_mpm_potential *potential);
// What is asked of the body from here on; at first the end of a step of backward Euler.
void brunt_mpm_potential_ask(brunt_mpm_potential *potential, brunt_trial_rule rule);
// Begins a step of `dt` [s] (INFINITY: static, nothing is viscous), after the sort. Node n of slot s of the body's grid
// is block node number[s * BRUNT_BLOCK_NODES + n] of the unknowns, -1: not one of them, at rest; `number` has to last
// for the step; the term has no more threads than `team`. BRUNT_FAILED: out of memory.
int brunt_mpm_potential_step(brunt_mpm_potential *potential, const brunt_team *team, const int32_t *number, double dt,
                             brunt_error *error);
// The term of the step; valid as long as the potential. Its stencils are the nodes of bins that have particles. Its
// `limit` leaves a particle a tenth of the way to J = 0.
brunt_term brunt_mpm_potential_term(brunt_mpm_potential *potential);
// A field of the unknowns at the particles' places, sum w u: out[slot * dim + component], slots as particles have them
// (those of padding too).
void brunt_mpm_interpolate(brunt_mpm_potential *potential, const brunt_team *team, const double *u, double *out);

// How a step moved the grid, of all unknowns.
typedef struct brunt_mpm_motion {
    const double *u;     // [m] displacements of the step
    const double *v;     // [m/s] velocities at its end
    const double *v_old; // [m/s] at its start, from the particles; of FLIP only
    brunt_transfer transfer;
    double flip; // share of FLIP that this step keeps, the rest PIC
} brunt_mpm_motion;

typedef struct brunt_mpm_result {
    double kinetic;  // [J] of the particles afterwards, with the affine part
    double transfer; // [J] what the way from the grid to them took: kinetic energy of the grid's nodes less theirs
    real speed;      // [m/s] of the fastest
    real wave_speed; // [m/s] greatest
    bool failed;     // the material of one has failed
} brunt_mpm_result;

// The step is that: x += sum w u, velocities by the transfer, with APIC the affine field by
//   B = sum w (v (x_i - x_p)^T + (v du^T - du v^T) / 2),   du = u_i - u_p   (A000, table 1: angular momentum is kept),
// F = (I + grad u) F, stress, state; the blocks' reports follow. The grid is left alone. BRUNT_OK, or BRUNT_FAILED with
// body, particle, place and reason.
int brunt_mpm_commit(brunt_mpm_potential *potential, const brunt_team *team, const brunt_mpm_motion *motion,
                     brunt_mpm_result *result, brunt_error *error);
