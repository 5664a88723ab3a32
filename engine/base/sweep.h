// Which boxes share something, by sorting them along an axis and sweeping over it.
#pragma once

#include <stdint.h>

#include "base/error.h"

typedef struct brunt_box {
    double low[3], high[3]; // closed; infinite where there is no end
} brunt_box;

typedef struct brunt_box_pair {
    int32_t a, b; // a < b
} brunt_box_pair;

// Along which axis things are spread out most, so that the fewest are at one place of it.
typedef struct brunt_spread {
    double from[3], sum[3], square[3];
    int64_t count;
} brunt_spread;
// Adds a place; what is infinite does not count. And the axis, by the variance of the places: one that is far off does
// not decide for all; of equal ones the first.
void brunt_spread_add(brunt_spread *spread, const double x[3]);
int brunt_spread_axis(const brunt_spread *spread);

// Pairs of boxes that share a point, of which at least one is among the first `first`, ascending. `pairs`, so
// many as `found`, is the caller's to free, also when it fails. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_sweep(const brunt_box *boxes, int32_t first, int32_t count, brunt_box_pair **pairs, int64_t *found,
                brunt_error *error);
