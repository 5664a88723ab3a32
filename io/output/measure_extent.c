// Measure `extent`: size of a body along an axis.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"

#include <math.h>

static double extent(const brunt_measure *m, const point_set *set) {
    double axis[3], least = INFINITY, most = -INFINITY;
    if (!measure_unit_axis(m, axis)) return NAN;
    for (int64_t p = 0; p < set->count; p++) {
        const double *x = set->position + 3 * p;
        double along = x[0] * axis[0] + x[1] * axis[1] + x[2] * axis[2], half = measure_half_size(set, p, axis);
        least = fmin(least, along - half);
        most = fmax(most, along + half);
    }
    return set->count ? most - least : NAN;
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    (void)m, (void)from;
    return "m";
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    return measure_take_points(m, from->world, extent, value, error);
}

const measure_kind measure_extent = {.unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_extent_keys,
    MEASURE_OF_BODY("extent", "size of a body along an axis, at the end"),
    {"measures.*.extent.axis", SCENE_VECTOR, "1", REQUIRED, NONE, "direction"});
// clang-format on
