// Contact of bodies of material points where their surfaces touch.
//
// Every particle of either body looks along a normal for the surface of the other, as its particles extend, and becomes
// a contact point (constraint.h) where it would pass it within the step. Its slave is the particle; its master is the
// particle of the other body beside which it would pass, extended affinely to the line of the push, so that push and
// reaction act along one line. Friction acts at the surface, where both bodies' affine fields are seen, and goes back
// by the transpose: no rigid motion of two bodies feels contact, nor does a rolling one, and momenta are exact.
#pragma once

#include "contact/search/particle_dof.h"

typedef struct brunt_point_touches brunt_point_touches;

// Meets all pairs of bodies of material points whose method is augury. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_point_touches_apply(const brunt_contact_context *m, int sweeps, double tolerance,
                              brunt_point_touches **touches, brunt_error *error);
void brunt_point_touches_free(brunt_point_touches *touches);
