// Measure `profile`: distance of a field from a reference along an axis, by volume.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "io/output/positions.h"

// The reference at a coordinate. Of a jump, its upper end at the coordinate itself.
static double reference_at(const brunt_curve *reference, double at) {
    const double(*p)[2] = (const double(*)[2])reference->points;
    int32_t k = 0;
    if (at < p[0][0]) return p[0][1];
    while (k + 1 < reference->count && p[k + 1][0] <= at) k++;
    if (k + 1 == reference->count) return p[k][1];
    return p[k][1] + (p[k + 1][1] - p[k][1]) * ((at - p[k][0]) / (p[k + 1][0] - p[k][0]));
}

// Adds a body's share of the volume integrals of |field - reference| and |reference|.
static void add_profile(const brunt_measure *m, const point_set *set, double *difference, double *whole) {
    double axis[3];
    measure_unit_axis(m, axis);
    for (int64_t p = 0; p < set->count; p++) {
        double along = 0;
        for (int c = 0; c < 3; c++) along += (set->position[3 * p + c] - m->center[c]) * axis[c];
        const double wanted = reference_at(&m->curve, along);
        *difference += set->volume[p] * fabs(measure_value(m, set, p) - wanted);
        *whole += set->volume[p] * fabs(wanted);
    }
}

// Bodies first .. end are looked at: the one that is named, or all.
static void bodies_of(const brunt_measure *m, const brunt_world *world, int32_t *first, int32_t *end) {
    const int32_t only = *m->body ? brunt_find_body(world, m->body) : BRUNT_NONE;
    *first = only < 0 ? 0 : only;
    *end = only >= 0 ? only + 1 : *m->body ? 0 : brunt_body_count(world);
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    (void)m, (void)from;
    return "1";
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    brunt_world *world = from->world;
    double difference = 0, whole = 0;
    int found = 0;
    int32_t body, end;
    bodies_of(m, world, &body, &end);
    for (; body < end; body++) {
        if (!*m->body && brunt_body_find_field(world, body, m->field) < 0) continue;
        point_set set;
        int status = measure_read_points(m, world, body, &set, error);
        if (status) return status;
        add_profile(m, &set, &difference, &whole);
        measure_free_points(&set);
        found++;
    }
    if (!found) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: no body has a field '%s'", m->name, m->field);
    *value = difference / whole;
    return BRUNT_OK;
}

static int check(const brunt_measure *m, const measure_source *from, brunt_error *error) {
    brunt_world *world = from->world;
    if (m->take != BRUNT_TAKE_END)
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: a profile is measured at the end only", m->name);
    if (!m->curve.count) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: a profile wants a reference", m->name);
    if (*m->body && brunt_find_body(world, m->body) < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: there is no body '%s'", m->name, m->body);
    int32_t body, end;
    bodies_of(m, world, &body, &end);
    for (; *m->curve_unit && body < end; body++) {
        const int32_t field = brunt_body_find_field(world, body, m->field);
        if (field < 0) continue;
        const char *unit = brunt_body_field(world, body, field).unit;
        if (!measure_same_unit(from->units, unit, m->curve_unit))
            return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the reference is in %s, the field '%s' in %s",
                              m->name, m->curve_unit, m->field, unit);
    }
    return BRUNT_OK;
}

const measure_kind measure_profile = {.check = check, .unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_profile_keys,
    {"measures.*.profile", SCENE_GROUP, NULL, OPTIONAL, NONE, "distance of a field at the end from a reference along an axis: sum of volume |field - reference| over sum of volume |reference|"},
    {"measures.*.profile.body", SCENE_NAME, NULL, OPTIONAL, NONE, "the body (default: all that have the field)"},
    {"measures.*.profile.name", SCENE_NAME, NULL, REQUIRED, NONE, "the field"},
    {"measures.*.profile.component", SCENE_WORD, NULL, "magnitude", ANY, "magnitude|x|y|z|xx|yy|zz|xy|yz|xz", 0, false, "of a vector or symmetric tensor; magnitude: also a scalar's value"},
    {"measures.*.profile.axis", SCENE_VECTOR, "1", REQUIRED, NONE, "direction of the coordinate"},
    {"measures.*.profile.center", SCENE_VECTOR, "m", "0", NONE, "where it is 0"},
    {"measures.*.profile.reference", SCENE_PROFILE, "any", REQUIRED, NONE, "[[-1 m, 3 Pa], [0 m, 4 Pa]]: linear between, held beyond its ends; the same coordinate twice is a jump"});
// clang-format on
