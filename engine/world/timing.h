// What the step and its passes take. A pass begins where the one before ended, so that no moment of a step is left out
// and the clock is read once a pass. No state: a run that goes on counts anew; nothing to free.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "brunt.h"
#include "world/plan.h"

typedef struct brunt_pass_time {
    int64_t calls;
    double seconds, units; // units: particles, nodes or elements gone over
    brunt_timer threads;
} brunt_pass_time;

typedef struct brunt_timing {
    double seconds;     // [s] of all steps, without what the observer took
    double begin, mark; // [s] of the clock: where the step began (later by what the observer took), and the pass
    int pass;           // that runs; -1: none
    brunt_pass_time passes[BRUNT_PASS_LIMIT]; // of the plan
    bool observed;
    brunt_observer observer;
    brunt_stop stop; // of steps that are left; asked NULL: none are
} brunt_timing;

// Where the time of parallel phases goes: to the pass that runs. NULL outside a step.
static inline brunt_timer *brunt_pass_timer(brunt_timing *timing) {
    return timing->pass < 0 ? NULL : &timing->passes[timing->pass].threads;
}

// --- scheme/timing.c
void brunt_timing_make(brunt_timing *timing);
// Aborts where the pass that runs is none of `passes`, or a time is no number.
void brunt_timing_validate(const brunt_timing *timing, int passes);
void brunt_step_begin(brunt_timing *timing);
void brunt_step_end(brunt_timing *timing); // ends a pass that was left by an error as well
void brunt_pass_begin(brunt_timing *timing, int pass);
// `units`: how many particles, nodes or elements the pass has gone over.
void brunt_pass_end(brunt_timing *timing, double units);
