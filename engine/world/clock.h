// The time of a world and its steps.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "brunt.h"

struct brunt_clock {
    double time, steps, dt, kick, next_dt, dt_min, dt_max; // kick: what the last forces acted over
    double longest;                                        // [s] of the steps that were not cut short
    double recent_step, earlier_step;        // [s] least stable one of this stretch of steps, and of the one before
    brunt_newton_counts newton, newton_last; // so far, of the last step
    bool creep_told;                         // that steps have become short; not of the state
    bool withdrawn;                          // the last step failed and changed nothing; not of the state
    int64_t gap_told, chatter_told;          // implicit: 1 once a gap has become small, a step too long for a barrier
    int64_t rubs_late;                       // ... once friction goes by the pressures of the step before
};

// The start: the first step is `stable` [s], or `fixed` where that is not 0. Nothing to free; all of it is saved by
// world/state.c, but for `creep_told`.
void brunt_clock_make(struct brunt_clock *clock, double stable, double fixed);
// Aborts where time, steps or their bounds are no such numbers.
void brunt_clock_validate(const struct brunt_clock *clock);
