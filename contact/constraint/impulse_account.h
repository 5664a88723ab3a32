// What a condition or a pair has done: impulse, work and dissipation, taken at the mean of the old and the new
// velocity, which makes the work of an impulse equal to the change of kinetic energy it causes. Everything is recorded
// here.
#pragma once

#include "contact/surface/contact_surface.h"

// A condition that is imposed from outside, and what it has done so far.
typedef struct brunt_impulse_account {
    double impulse[3];         // [N s] on the bodies (a pair: on its second body; of a body with itself 0)
    double angular[3];         // [N m s] about the origin, on the bodies
    double external_work;      // [J] done on the bodies by prescribed motion
    double normal_loss;        // [J] dissipated by the normal impulse
    double friction_loss;      // [J] dissipated by the tangential impulse
    double area;               // [m^2] that touched in the last step
    double spring;             // [J] of normal_loss: what springs held at the start of the last step
    double unspent, overspent; // [J] while a step gives back what touches took (release.c)
} brunt_impulse_account;

// Aborts where a number of it is none.
void brunt_impulse_account_validate(const brunt_impulse_account *account);
void brunt_impulse_account_add(brunt_impulse_account *sum, const brunt_impulse_account *part);
// Records impulse J acting at x while its material moves with `old` before and `now` after, against a carrier that
// moves with `carrier`. What it dissipates is added to `loss`: the account's normal_loss or its friction_loss.
void brunt_impulse_account_record(brunt_impulse_account *account, double *loss, const double J[3], const double x[3],
                                  const double old[3], const double now[3], const double carrier[3]);
// Records what a symmetry plane carries: an impulse [N s] and its moment about the origin [N m s] on the bodies.
// Nothing moves across the plane, so that it does no work and loses nothing.
void brunt_impulse_account_reaction(brunt_impulse_account *account, const double linear[3], const double angular[3]);

// An impulse on a node of the surface [N s]: on components with prescribed motion what their support takes.
typedef struct brunt_node_impulse {
    int32_t node;
    double J[3];
} brunt_node_impulse;

// Adds an impulse to a pair's account and to the surface's contact state, once velocities are final. `second`: the node
// belongs to the pair's second body, whose impulses are the pair's. Returns the loss [J], which the caller divides
// between normal_loss and friction_loss.
double brunt_impulse_account_node(brunt_contact_surface *surface, brunt_impulse_account *account,
                                  const brunt_node_impulse *impulse, bool second);
