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
    int64_t gap_told, chatter_told;          // implicit: 1 once a gap has become small, a step too long for a barrier
};
