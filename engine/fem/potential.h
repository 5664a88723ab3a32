// What a finite-element body adds to what an implicit step minimises: the incremental potential of its material at the
// elements' points, and of elements with one point the energy of their hourglass modes,
//   V0 W(F) + sum_m k/2 |gamma_m . x|^2   (stiffness form, element.inc).
// Nothing of the body changes before brunt_fem_commit.
#pragma once

#include "fem/fem_body.h"
#include "linear/term.h"

// NULL when implicit steps can have the body, else why not, in one line.
const char *brunt_fem_implicit(const brunt_fem_body *body);

typedef struct brunt_fem_potential brunt_fem_potential;
// Node i of the body is block node `base + i` of the unknowns; no more threads than `team` has are used on it. NULL
// with the reason.
brunt_fem_potential *brunt_fem_potential_make(brunt_fem_body *body, int32_t base, const brunt_team *team,
                                              brunt_error *error);
void brunt_fem_potential_free(brunt_fem_potential *potential);
size_t brunt_fem_potential_bytes(const brunt_fem_potential *potential);
// What is asked of the body from here on; at first the end of a step of backward Euler.
void brunt_fem_potential_ask(brunt_fem_potential *potential, brunt_trial_rule rule);
// Begins a step of `dt` [s]; INFINITY: static, nothing is viscous.
void brunt_fem_potential_step(brunt_fem_potential *potential, double dt);
// The term; valid as long as the potential. Its `limit` leaves an element a tenth of the way to J = 0.
brunt_term brunt_fem_potential_term(brunt_fem_potential *potential);
// The step is that of displacements u [m], and nodes have velocities v [m/s] at its end (v NULL: those they have), both
// of all unknowns; with room to work for each thread, as large as the body wants: places, velocities, deformation
// gradients, stress, state, partial forces and the blocks' reports follow. BRUNT_OK, or BRUNT_FAILED with body,
// element, place and reason.
int brunt_fem_commit(brunt_fem_potential *potential, const brunt_team *team, const double *u, const double *v,
                     brunt_fem_workspace *work, brunt_error *error);
// Whether the Hessian is the same wherever the body goes: of triangles of linear elasticity that nothing else is said
// of, none of whose nodes are held.
bool brunt_fem_hessian_stays(const brunt_fem_potential *potential);
// Takes the Hessian at rest, for the two below.
void brunt_fem_hessian_rest(brunt_fem_potential *potential, const brunt_team *team);
// All of it, row by row of components, both triangles: adds to K, which is of all nodes of the body.
void brunt_fem_hessian_dense(const brunt_fem_potential *potential, double *K);
// How many times that of `other` the Hessian is, element by element; 0: it is another one.
double brunt_fem_hessian_over(const brunt_fem_potential *potential, const brunt_fem_potential *other);
