// A file of its own, so that tests may have a clock of theirs instead (tests/support/fake_clock.h).
#include <time.h>

#include "base/parallel.h"

double brunt_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
