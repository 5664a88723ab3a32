// Energy and momentum of a run, recorded as it goes. All but the last member is of the state.
#pragma once

#include "boundary/damping.h"
#include "contact/contact.h"
#include "contact/planes/boundary.h"
#include "contact/surface/contact_surface.h"

typedef struct brunt_ledger {
    double kinetic;                                                        // of the particles [J]
    double fem_kinetic, fem_stress_work, hourglass_stored, hourglass_lost; // [J] of the meshes
    double stress_work;            // [J] dt times the stress power at the end of the last step
    double transfer, gravity_work; // [J]
    double scheme;                 // [J] taken by the integrator of implicit steps
    double barrier;                // [J] stored in barriers
    double barrier_initial;        // [J] the same at the start
    double gravity_impulse[3], gravity_angular[3];
    brunt_damping_sums damping;
    double initial_energy, initial_kinetic; // [J]
    double linear_initial[3], angular_initial[3], scale_linear, scale_angular;
    double energy_scale; // [J] the most that the run has been given so far: what its energy error is relative to
    double eroded_plastic, eroded_viscosity, eroded_heat; // [J] dissipated by what has been eroded since
    double rounding_energy; // [J] a step: what rounding may do, follows from the bodies at the start
    double rounding_stored; // [J] to which stored energy is known at any time, likewise
} brunt_ledger;

// What the balance goes over besides the ledger.
typedef struct brunt_accounts {
    const brunt_bodies *bodies;
    const brunt_boundary *boundaries;
    int boundary_count;
    const brunt_pair *pairs;
    int pair_count;
    const brunt_eroded *eroded;           // a body each; NULL without erosion
    const brunt_contact_surface *surface; // of meshes
    double steps;                         // so far
    bool axisymmetric;
} brunt_accounts;

// Aborts where a number is not finite, or a scale less than what it is a scale of.
void brunt_ledger_validate(const brunt_ledger *ledger);
// Energy and momenta as the bodies are at the start. Takes `hourglass_stored` as it is.
void brunt_ledger_open(brunt_ledger *ledger, const brunt_accounts *accounts);
// Keeps the most that the run has been given so far; once a step.
void brunt_ledger_remember(brunt_ledger *ledger, const brunt_accounts *accounts);
void brunt_ledger_energy(const brunt_ledger *ledger, const brunt_accounts *accounts, brunt_energy *energy);
void brunt_ledger_momentum(const brunt_ledger *ledger, const brunt_accounts *accounts, brunt_momentum *momentum);
