// A line or surface with a mass of its own: a rigid tool that is free in explicit steps.
//
// Its velocity and angular velocity are degrees of freedom of the constraints of the points that touch it: what they
// get, it gets the other way at the same places, so that momenta are those of both to rounding, and how light it is
// does not matter. An angular velocity has a degree of freedom for each principal axis, as these stand at the start of
// the step. Over the step the momentum about its centre stays in space and turns in the body by the implicit midpoint
// rule, which keeps the energy of a top; its frame follows by Cayley's map of the same mean velocity, which keeps the
// momentum in space.
#pragma once

#include "brunt/boundary_line.h"
#include "brunt/mesh.h"
#include "contact/constraint/constraint.h"

enum { BRUNT_TOOL_STATE = 14 };

typedef struct brunt_tool {
    bool free, turns, axial; // axial: of an axisymmetric world, along the axis only
    int dim;
    double mass, inertia[3]; // [kg], [kg m^2] about the scene's axes through the centre at the start
    double centre[3];        // [m] at the start
    // What lasts: way of the centre, frame (a quaternion), velocity, momentum about the centre [kg m^2/s] in space,
    // work of gravity so far.
    double way[3], frame[4], v[3], momentum[3], gravity_work;
    // Of a step: velocities before it, impulses and their moments so far, work by the velocities after each solution.
    double old[3], old_spin[3], impulse[3], moment[3], gravity[3], told;
    int32_t node; // first of its degrees of freedom in the constraints under way, BRUNT_NONE: it has none
} brunt_tool;

void brunt_tool_make(brunt_tool *tool, const brunt_boundary_surface_def *def, int dim, bool axial);
// Where it is, of places as they were at the start; and where it will be after a step of `dt` if nothing touches it.
brunt_placement brunt_tool_place(const brunt_tool *tool);
brunt_placement brunt_tool_place_after(const brunt_tool *tool, double dt);
void brunt_tool_spin(const brunt_tool *tool, double spin[3]); // [rad/s]
double brunt_tool_kinetic(const brunt_tool *tool);            // [J]
// A step: gravity over `kick`; entries of the last constraint of a set, for what acts at x, and of its friction point,
// which begins at entry `first` and acts at `at`; what a solution gave; the way over `dt`, and the accounts.
void brunt_tool_begin(brunt_tool *tool, const double gravity[3], double kick);
int brunt_tool_enter(brunt_tool *tool, const double x[3], brunt_constraint_set *set, brunt_error *error);
void brunt_tool_rub(const brunt_tool *tool, const double at[3], brunt_constraint_set *set);
void brunt_tool_take(brunt_tool *tool, const brunt_constraint_set *set);
void brunt_tool_end(brunt_tool *tool, double dt, brunt_impulse_account *last);
double *brunt_tool_state_get(const brunt_tool *tool, double *out);
const double *brunt_tool_state_set(brunt_tool *tool, const double *in);
