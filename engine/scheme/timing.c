// What the step and its passes take, and what is told of it.
//
// The clock is read where a pass ends; the next begins there. With a reading at either side of each pass, what lies
// between two of them is lost: for a hundred particles that is as much as a short pass.
#include <stddef.h>

#include "base/error.h"
#include "base/parallel.h"
#include "scheme/scheme.h"

void brunt_world_observe(brunt_world *world, const brunt_observer *observer) {
    brunt_timing *timing = &world->timing;
    timing->observed = observer != NULL;
    timing->observer = observer ? *observer : (brunt_observer){.context = NULL};
    for (int p = 0; p < world->plan.pass_count; p++) {
        world->timing.passes[p].threads.observer = timing->observer.thread ? &timing->observer : NULL;
        world->timing.passes[p].threads.pass = p;
    }
}

void brunt_world_heed(brunt_world *world, const brunt_stop *stop) {
    world->timing.stop = stop ? *stop : (brunt_stop){.asked = NULL};
}

double brunt_world_step_seconds(const brunt_world *world) { return world->timing.seconds; }

// What the observer takes is no time of the step: both its marks move on by as much.
static void leave_out(brunt_timing *timing) {
    double now = brunt_clock();
    timing->begin += now - timing->mark;
    timing->mark = now;
}

static void tell_begin(brunt_timing *timing) {
    if (timing->observer.begin) timing->observer.begin(timing->observer.context, timing->pass, timing->mark);
    leave_out(timing);
}

static void tell_end(brunt_timing *timing, double begin) {
    if (timing->observer.end) timing->observer.end(timing->observer.context, timing->pass, begin, timing->mark);
    leave_out(timing);
}

void brunt_timing_make(brunt_timing *timing) { timing->pass = -1; }

void brunt_timing_validate(const brunt_timing *timing, int passes) {
    BRUNT_ASSERT(timing->pass >= -1 && timing->pass < passes && timing->seconds >= 0);
    for (int p = 0; p < passes; p++)
        BRUNT_ASSERT(timing->passes[p].calls >= 0 && timing->passes[p].seconds >= 0 && timing->passes[p].units >= 0);
}

void brunt_pass_begin(brunt_timing *timing, int pass) {
    BRUNT_ASSERT(timing->pass < 0); // passes do not nest
    timing->pass = pass;
    timing->passes[pass].calls++;
    if (timing->observed) tell_begin(timing);
}

void brunt_pass_end(brunt_timing *timing, double units) {
    brunt_pass_time *pass = &timing->passes[timing->pass];
    double begin = timing->mark;
    timing->mark = brunt_clock();
    pass->seconds += timing->mark - begin;
    pass->units += units;
    if (timing->observed) tell_end(timing, begin);
    timing->pass = -1;
}

void brunt_step_begin(brunt_timing *timing) {
    timing->begin = timing->mark = brunt_clock();
    timing->pass = -1;
}

void brunt_step_end(brunt_timing *timing) {
    if (timing->pass >= 0) brunt_pass_end(timing, 0);
    timing->seconds += timing->mark - timing->begin;
}
