// Release gives back what touch took. Contact stops the half element behind a node in one step, which dissipates its
// energy, an error of first order in the elements. Lumped elements at the stable step are exact (d'Alembert's solution
// of a bar on a wall): there half the mass of the end element stops in one step, and is thrown off in one step at
// release. So each slave keeps what its pushes have dissipated, and in the first step in which none of its constraints
// pushes gets it back, as an impulse at the same point, along the same normal and with the same transpose: momenta stay
// exact, and no more energy is given back than was taken.
#pragma once

#include "contact/constraint/constraint.h"

// Room for what touches do. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_release_begin(brunt_constraint_set *set, brunt_error *error);
// Notes what the push of constraint k has taken, after the sweeps and with its rates.
void brunt_release_note(brunt_constraint_set *set, int64_t k);
// When that of all is noted. `*gave`: something was given back, so that
// the rates are others now. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_constraints_release(brunt_constraint_set *set, bool *gave, int threads, brunt_timer *timer,
                              brunt_error *error);
