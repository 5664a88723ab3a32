// What the step and its passes take, and what is told of it.
//
// The clock is read where a pass ends; the next begins there. With a reading at either side of each pass, what lies
// between two of them is lost: for a hundred particles that is as much as a short pass.
#include <stddef.h>

#include "base/error.h"
#include "base/parallel.h"
#include "scheme/scheme.h"

void brunt_world_observe(brunt_world *world, const brunt_observer *observer) {
    struct brunt_timing *timing = &world->timing;
    timing->observed = observer != NULL;
    timing->observer = observer ? *observer : (brunt_observer){.context = NULL};
    for (int p = 0; p < world->plan.pass_count; p++) {
        world->pass[p].threads.observer = timing->observer.thread ? &timing->observer : NULL;
        world->pass[p].threads.pass = p;
    }
}

double brunt_world_step_seconds(const brunt_world *world) { return world->timing.seconds; }

// What the observer takes is no time of the step: both its marks move on by as much.
static void leave_out(struct brunt_timing *timing) {
    double now = brunt_clock();
    timing->begin += now - timing->mark;
    timing->mark = now;
}

static void tell_begin(brunt_world *world) {
    struct brunt_timing *timing = &world->timing;
    if (timing->observer.begin) timing->observer.begin(timing->observer.context, timing->pass, timing->mark);
    leave_out(timing);
}

static void tell_end(brunt_world *world, double begin) {
    struct brunt_timing *timing = &world->timing;
    if (timing->observer.end) timing->observer.end(timing->observer.context, timing->pass, begin, timing->mark);
    leave_out(timing);
}

void brunt_pass_begin(brunt_world *world, int pass) {
    BRUNT_ASSERT(world->timing.pass < 0); // passes do not nest
    world->timing.pass = pass;
    world->pass[pass].calls++;
    if (world->timing.observed) tell_begin(world);
}

void brunt_pass_end(brunt_world *world, double units) {
    struct brunt_timing *timing = &world->timing;
    struct brunt_pass_time *pass = &world->pass[timing->pass];
    double begin = timing->mark;
    timing->mark = brunt_clock();
    pass->seconds += timing->mark - begin;
    pass->units += units;
    if (timing->observed) tell_end(world, begin);
    timing->pass = -1;
}

void brunt_step_begin(brunt_world *world) {
    world->timing.begin = world->timing.mark = brunt_clock();
    world->timing.pass = -1;
}

void brunt_step_end(brunt_world *world) {
    if (world->timing.pass >= 0) brunt_pass_end(world, 0);
    world->timing.seconds += world->timing.mark - world->timing.begin;
}
