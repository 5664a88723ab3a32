// Measure `twist`: how far the material about an axis has turned, from the deformation gradients of particles.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"

#include <math.h>

#include "base/error.h"
#include "io/output/positions.h"

// The turn R about the unit axis a that comes nearest to the sum of all F, by least squares, among those that leave a:
// tr (R^T F) = cos (tr F - a.F a) + sin (a_i e_ijk F_kj) + a.F a is greatest.
static double twist(const brunt_measure *m, const point_set *set) {
    double axis[3], even = 0, odd = 0;
    int64_t count = 0;
    if (!measure_unit_axis(m, axis)) axis[2] = 1;
    for (int64_t p = 0; p < set->count; p++) {
        const double *F = set->gradient + 9 * p;
        double r[3], along = 0, square = 0;
        for (int c = 0; c < 3; c++) r[c] = set->position[3 * p + c] - m->center[c], along += r[c] * axis[c];
        for (int c = 0; c < 3; c++) square += (r[c] - along * axis[c]) * (r[c] - along * axis[c]);
        if (along < m->slab_min || along > m->slab_max || square > m->within * m->within) continue;
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            even += F[4 * i], odd += axis[i] * (F[3 * k + j] - F[3 * j + k]);
            for (int c = 0; c < 3; c++) even -= axis[i] * F[3 * i + c] * axis[c];
        }
        count++;
    }
    return count ? atan2(odd, even) : NAN;
}

static int check(const brunt_measure *m, const measure_source *from, brunt_error *error) {
    const int32_t body = brunt_find_body(from->world, m->body);
    if (body < 0 || brunt_location_of_motion(from->world, body) == BRUNT_AT_PARTICLES) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: a twist is of a body of material points, '%s' has none",
                      m->name, m->body);
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    (void)m, (void)from;
    return "rad";
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    return measure_take_points(m, from->world, twist, value, error);
}

const measure_kind measure_twist = {.check = check, .unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_twist_keys,
    MEASURE_OF_BODY("twist", "angle by which the material of an mpm body about an axis has turned, at the end, between -pi and pi"),
    {"measures.*.twist.axis", SCENE_VECTOR, "1", OPTIONAL, NONE, "direction of the axis (2D: may be left out, then it is out of the plane)"},
    {"measures.*.twist.center", SCENE_VECTOR, "m", "0", NONE, "a point of the axis"},
    {"measures.*.twist.within", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "only what is no farther from the axis"},
    {"measures.*.twist.from", SCENE_REAL, "m", OPTIONAL, NONE, "only what has a coordinate along the axis above ..."},
    {"measures.*.twist.to", SCENE_REAL, "m", OPTIONAL, NONE, "... and below this"});
// clang-format on
