// Augury, affine form: who faces whom. Every boundary node of a finite-element body, and every particle near one, looks
// into the cell of the contact grid it is in, finds the nearest point of the facets opposite, and becomes a contact
// point there when it would pass it within the step. Gap, velocity and reaction come from the same facet (points.h), so
// nothing is smeared over a cell: contact closes at zero gap, edges and corners keep their place, and nothing acts on
// what does not touch.
//
// The grid only finds: cells hold the facets within reach of them. It is made anew when the facets, or the
// bodies that look for them, have moved by the margin it was made with; what is found does not depend on it, so its
// cell size, and a restart, change no bit.
#pragma once

#include "contact/constraint/constraint.h"
#include "contact/surface/contact_surface.h"

typedef struct brunt_facing brunt_facing;

// Marks in skin->active which bodies have another one, or a wall (planes of brunt_walls with condition separate and
// others), near; call after brunt_skin_bounds, before brunt_skin_take. 0, or -1: out of memory, -2: a place or a way of
// a step is not a number that can be worked with.
int brunt_facing_near(const brunt_meeting *m, brunt_body *mpm, int mpm_count, const brunt_wall *walls, int wall_count,
                      double time, brunt_facing **facing);
// Adds the contact points of this step.
int brunt_facing_find(const brunt_meeting *m, brunt_body *mpm, int mpm_count, brunt_facing *facing,
                      brunt_contact_points *points);
// Adds what walls that push (condition separate) do to boundary nodes, and applies those that hold (stick, slip,
// symmetry).
int brunt_facing_walls(const brunt_meeting *m, brunt_wall *walls, int wall_count, double time, brunt_facing *facing,
                       brunt_contact_points *points);
// After the solution: what contact gave to nodes that planes hold is those planes' reaction.
void brunt_facing_book_holds(const brunt_meeting *m, brunt_wall *walls, int wall_count, double time,
                             const brunt_facing *facing, const brunt_contact_points *points);
// After brunt_skin_renew: what is remembered follows its nodes, and all look anew. 0, or -1: out of memory.
int brunt_facing_renew(brunt_facing *facing, const brunt_skin *skin);
// After the solution: velocities back to the skin and to the grids' nodes, contact state to the skin.
void brunt_facing_finish(const brunt_meeting *m, brunt_body *mpm, brunt_facing *facing,
                         const brunt_contact_points *points);
// What is remembered from step to step only saves work; but where two facets are equally near it may settle which one
// is taken, so that a run that goes on needs it. So many doubles, however many elements have left; copied out; and in,
// before the first step and after the bodies, from which the skin is renewed (0, or -1: out of memory).
int64_t brunt_facing_state_count(const brunt_skin *skin);
void brunt_facing_state_get(const brunt_facing *facing, const brunt_skin *skin, double *out);
int brunt_facing_state_set(brunt_facing **facing, brunt_skin *skin, int mpm_count, const double *in);
void brunt_facing_free(brunt_facing *facing);
size_t brunt_facing_bytes(const brunt_facing *facing);
