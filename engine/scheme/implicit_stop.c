// Implicit steps that are left before they have an end: nothing is then other than before them.
#include "base/array.h"
#include "base/error.h"
#include "scheme/implicit.h"

// What has said so once says so again, whatever has been made of it: no end is then that of the step.
static bool ask(void *context) {
    struct brunt_implicit *m = context;
    const brunt_stop *stop = &m->world->timing.stop;
    m->stopped = m->stopped || stop->asked(stop->context);
    return m->stopped;
}

int brunt_implicit_heed(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const int boundaries = world->boundaries.boundary_count, pairs = world->pairs.count;
    m->stopped = false;
    m->options.stop = (brunt_stop){.asked = NULL};
    if (!world->timing.stop.asked) return BRUNT_OK;
    m->options.stop = (brunt_stop){ask, m};
    if (BRUNT_CAPACITY(m->last, (size_t)boundaries + (size_t)pairs + 1, 0, "accounts of the last step", error))
        return BRUNT_FAILED;
    for (int w = 0; w < boundaries; w++) m->last[w] = world->boundaries.boundary[w].last;
    for (int p = 0; p < pairs; p++) m->last[boundaries + p] = world->pairs.pair[p].last;
    return BRUNT_OK;
}

int brunt_implicit_leave(brunt_world *world, brunt_error *error) {
    const struct brunt_implicit *m = world->plan.implicit;
    const int boundaries = world->boundaries.boundary_count;
    for (int w = 0; w < boundaries; w++) world->boundaries.boundary[w].last = m->last[w];
    for (int p = 0; p < world->pairs.count; p++) world->pairs.pair[p].last = m->last[boundaries + p];
    return brunt_fail(error, BRUNT_STOPPED, "the step was left, as it was asked to be");
}
