// Measure `field`: a field reduced over the particles, nodes or elements of a body.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"

#include <math.h>

#include "base/error.h"
#include "io/output/positions.h"

static double reduce_field(const brunt_measure *m, const point_set *set) {
    double axis[3], least = INFINITY, most = -INFINITY, sum = 0, all = 0;
    bool sliced = measure_unit_axis(m, axis);
    for (int64_t p = 0; p < set->count; p++) {
        double along = 0;
        for (int c = 0; c < 3; c++) along += (set->position[3 * p + c] - m->center[c]) * axis[c];
        if (sliced && (along < m->slab_min || along > m->slab_max)) continue;
        const double value = measure_value(m, set, p);
        // A world that goes on holds no such values but where there is nothing to say: the gap to a body out of reach.
        if (isnan(value)) continue;
        least = fmin(least, value);
        most = fmax(most, value);
        const double weight = set->change ? set->volume[p] / set->change[p] : 1;
        sum += weight * value;
        all += weight;
    }
    if (!(all > 0)) return NAN;
    switch (m->take) {
    case BRUNT_TAKE_MIN: return least;
    case BRUNT_TAKE_MAX: return most;
    case BRUNT_TAKE_MAX_ABS: return fmax(fabs(least), fabs(most));
    case BRUNT_TAKE_MEAN: return sum / all;
    default: return NAN; // `check` refuses the rest
    }
}

static int check(const brunt_measure *m, const measure_source *from, brunt_error *error) {
    (void)from;
    if (m->take == BRUNT_TAKE_MIN || m->take == BRUNT_TAKE_MAX || m->take == BRUNT_TAKE_MAX_ABS ||
        m->take == BRUNT_TAKE_MEAN)
        return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "measures.%s: a field is reduced over the body by take: min, max, mean or max_abs", m->name);
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    const int32_t body = brunt_find_body(from->world, m->body),
                  field = body >= 0 ? brunt_body_find_field(from->world, body, m->field) : BRUNT_NONE;
    if (field < 0) return NULL;
    const char *of = brunt_body_field(from->world, body, field).unit;
    return *of ? of : "1";
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    return measure_take_points(m, from->world, reduce_field, value, error);
}

const measure_kind measure_field = {.check = check, .unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_field_keys,
    MEASURE_OF_BODY("field", "a field reduced over the particles, nodes or elements of a body, at the end"),
    {"measures.*.field.name", SCENE_NAME, NULL, REQUIRED, NONE, "the field"},
    {"measures.*.field.component", SCENE_WORD, NULL, "magnitude", ANY, "magnitude|x|y|z|xx|yy|zz|xy|yz|xz", 0, false, "of a vector or symmetric tensor; magnitude: also a scalar's value"},
    {"measures.*.field.axis", SCENE_VECTOR, "1", OPTIONAL, NONE, "direction of a slab, for from and to"},
    {"measures.*.field.center", SCENE_VECTOR, "m", "0", ANY, NULL, 0, true, "where the coordinate along the axis is 0"},
    {"measures.*.field.from", SCENE_REAL, "m", OPTIONAL, NONE, "only what has a coordinate along the axis above ..."},
    {"measures.*.field.to", SCENE_REAL, "m", OPTIONAL, NONE, "... and below this"});
// clang-format on
