// Augury, affine form: what faces what. Every boundary node of a finite-element body, and every particle near one,
// looks into the cell of the contact grid it is in, finds the nearest point of the facets opposite, and becomes a
// contact point there when it would pass it within the step. Gap, velocity and reaction come from the same facet
// (constraint.h), so nothing is smeared over a cell: contact closes at zero gap, edges and corners keep their place,
// and nothing acts on what does not touch.
//
// The grid only finds: cells hold the facets within reach of them. It is made anew when the facets, or the
// bodies that look for them, have moved by the margin it was made with; what is found does not depend on it, so its
// cell size, and a restart, change no bit.
#pragma once

#include "contact/constraint/constraint.h"
#include "contact/contact.h"
#include "contact/planes/boundary.h"
#include "contact/planes/symmetry.h"

#define BRUNT_LEAP 0.25    // mean edges: how far a node may come in a step and be thrown back: as far as is searched
#define BRUNT_SHALLOW 0.02 // mean edges: depths that may be pushed out against a load

// Mean edges a step: approaches of rounding.
#ifdef BRUNT_FLOAT
#define BRUNT_NEGLIGIBLE 1e-7
#else
#define BRUNT_NEGLIGIBLE 1e-13
#endif

// Marks in surface->active which bodies have another one, or a boundary (planes with condition separate and
// others), near; call after brunt_surface_bounds, before brunt_surface_gather_state. BRUNT_OK, or BRUNT_FAILED: out of
// memory, or (`far`) a place or a way of a step is not a number that can be worked with.
int brunt_broad_phase(const brunt_contact_context *m, brunt_node_to_facet **node_to_facet, bool *far,
                      brunt_error *error);
// Where something is near: no node has a degree of freedom of the step yet. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_to_facet_begin(brunt_node_to_facet *node_to_facet, int32_t nodes, brunt_error *error);
// Adds the contact points of this step. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_to_facet_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count,
                             brunt_node_to_facet *node_to_facet, brunt_constraint_set *constraints, brunt_error *error);
// After the solution: what contact gave to nodes that planes hold is those planes' reaction.
void brunt_node_to_facet_account_fixed(const brunt_contact_context *m, const brunt_node_to_facet *node_to_facet,
                                       const brunt_constraint_set *constraints);
// After brunt_surface_renew: what is remembered follows its nodes, and all look anew. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_node_to_facet_renew(brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                              brunt_error *error);
// After the solution: velocities back to the surface and to the grids' nodes, contact state to the surface.
void brunt_node_to_facet_finish(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *node_to_facet,
                                const brunt_constraint_set *constraints);
// What is remembered from step to step only saves work; but where two facets are equally near it may settle which one
// is taken, so that a run that goes on needs it. So many doubles, however many elements have left; copied out; and in,
// before the first step and after the bodies, from which the surface is renewed (BRUNT_OK, or BRUNT_FAILED: out of
// memory).
int64_t brunt_node_to_facet_state_count(const brunt_contact_surface *surface);
void brunt_node_to_facet_state_get(const brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                                   double *out);
int brunt_node_to_facet_state_set(brunt_node_to_facet **node_to_facet, brunt_contact_surface *surface, int mpm_count,
                                  const double *in, brunt_error *error);
// What touches have taken of nodes and their release gives back [J] (constraint/release.h): room for it where a scene
// wants that (BRUNT_OK, or BRUNT_FAILED: out of memory), the sum, and as it is saved, after the state above.
int brunt_node_touches_make(brunt_node_to_facet *node_to_facet, int32_t nodes, brunt_error *error);
double brunt_node_to_facet_held(const brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface);
int64_t brunt_node_touches_state_count(const brunt_contact_surface *surface);
void brunt_node_touches_state_get(const brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                                  double *out);
int brunt_node_touches_state_set(brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                                 const double *in, int64_t count, brunt_error *error);
// How deep nodes lie in other bodies since they met, as it is saved after the states above; nothing where nothing has
// overlapped since the start.
int64_t brunt_initial_penetration_state_count(const brunt_node_to_facet *node_to_facet,
                                              const brunt_contact_surface *surface);
void brunt_initial_penetration_state_get(const brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                                         double *out);
int brunt_initial_penetration_state_set(brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface,
                                        const double *in, int64_t count, brunt_error *error);
void brunt_node_to_facet_free(brunt_node_to_facet *node_to_facet);
// Aborts where what is remembered is not of this surface. NULL: nothing is.
void brunt_node_to_facet_validate(const brunt_node_to_facet *node_to_facet, const brunt_contact_surface *surface);
size_t brunt_node_to_facet_bytes(const brunt_node_to_facet *node_to_facet);
