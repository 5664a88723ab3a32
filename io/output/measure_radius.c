// Measure `radius`: greatest distance of a body's surface from an axis.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"

#include <math.h>

static double radius(const brunt_measure *m, const point_set *set) {
    double axis[3], most = NAN;
    bool has_axis = measure_unit_axis(m, axis);
    // In two dimensions an axis line may be out of the plane: a disk about its centre.
    if (!has_axis) axis[2] = 1;
    for (int64_t p = 0; p < set->count; p++) {
        double r[3], along = 0, distance = 0;
        for (int c = 0; c < 3; c++) {
            r[c] = set->position[3 * p + c] - m->center[c];
            along += r[c] * axis[c];
        }
        if (along < m->slab_min || along > m->slab_max) continue;
        for (int c = 0; c < 3; c++) {
            r[c] -= along * axis[c];
            distance += r[c] * r[c];
        }
        distance = sqrt(distance);
        for (int c = 0; c < 3; c++) r[c] = distance > 0 ? r[c] / distance : 0;
        most = fmax(most, distance + measure_half_size(set, p, r)); // fmax ignores the NAN it starts with
    }
    return most;
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    (void)m, (void)from;
    return "m";
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    return measure_take_points(m, from->world, radius, value, error);
}

const measure_kind measure_radius = {.unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_radius_keys,
    MEASURE_OF_BODY("radius", "greatest distance of a body's surface from an axis, at the end"),
    {"measures.*.radius.axis", SCENE_VECTOR, "1", OPTIONAL, NONE, "direction of the axis (2D: may be left out, then it is out of the plane)"},
    {"measures.*.radius.center", SCENE_VECTOR, "m", "0", NONE, "a point of the axis"},
    {"measures.*.radius.from", SCENE_REAL, "m", OPTIONAL, NONE, "only what has a coordinate along the axis above ..."},
    {"measures.*.radius.to", SCENE_REAL, "m", OPTIONAL, NONE, "... and below this"});
// clang-format on
