// The time of a world: set at the start, looked over.
#include "world/clock.h"

#include <math.h>

#include "base/error.h"

void brunt_clock_make(struct brunt_clock *clock, double stable, double fixed) {
    clock->next_dt = clock->dt = clock->recent_step = clock->earlier_step = stable;
    if (fixed > 0) clock->dt = fixed;
    clock->dt_min = INFINITY;
}

void brunt_clock_validate(const struct brunt_clock *clock) {
    BRUNT_ASSERT(clock->time >= 0 && clock->steps >= 0 && clock->steps == floor(clock->steps));
    BRUNT_ASSERT(clock->dt > 0 && clock->kick >= 0 && clock->longest >= 0 && clock->dt_min > 0 && clock->dt_max >= 0);
    BRUNT_ASSERT(!(clock->next_dt < 0)); // no number: the step that would be so long fails, and says of what body
}
