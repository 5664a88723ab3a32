// Contact between the surfaces of finite-element bodies by transfers to a background grid and back ("augury").
//
// Bodies that share grid nodes find each other there: no search among faces. Three forms:
//   paper    the boundary nodes' velocities to the grid and back, by PIC or APIC, as what bodies are to have that meet;
//            then iterations that take back what pulls surfaces together
//   surface  boundary nodes against the other body's surface as the grid averages it: impulses along its normal
//   smooth   the same with velocities extended affinely from the faces, and reactions by the transpose
//
// All of them change the velocities of the surface, fill its contact state (gap, impulse, state), and add what they did
// to `last` of the pairs, impulses being those on the second body. The change of kinetic energy that the velocities of
// the nodes mean, from `old` to what they are now, is external_work - normal_loss - friction_loss plus what the forces
// did.
#pragma once

#include "contact/contact.h"
#include "contact/surface/contact_surface.h"

typedef struct brunt_augury_workspace brunt_augury_workspace;

// The published form: spline over four nodes a direction, time scale tau = dt, N = m->iterations. It acts on all
// boundary nodes of active bodies that have a pair, in contact or not. `transfer`: BRUNT_PIC, or BRUNT_APIC, which
// keeps B in surface->affine (0 at the start of a run). BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_augury_paper(const brunt_contact_context *m, brunt_transfer transfer, brunt_augury_workspace **work,
                       brunt_error *error);

// Nodes against averaged surfaces, m->iterations sweeps, each with one of the two bodies as the one whose nodes are
// held back; m->step says which begins. Linear momentum is exact; so is angular momentum, with `affine` always, else
// for pairs without prescribed nodes. Bodies that do not approach are not touched. `affine` false: form "surface";
// true: form "smooth". BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_augury_surface(const brunt_contact_context *m, bool affine, brunt_augury_workspace **work,
                         brunt_error *error);

void brunt_augury_workspace_free(brunt_augury_workspace *work);
