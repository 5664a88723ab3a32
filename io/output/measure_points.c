// Points of a body that measures look at: particles, nodes or elements.
#include "io/output/measure.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "io/output/positions.h"

// A field of a body in new memory.
static int read_field(brunt_world *world, int32_t body, const char *name, const brunt_measure *m, double **out,
                      brunt_field_info *info, brunt_error *error) {
    int32_t field = brunt_body_find_field(world, body, name);
    if (field < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: body '%s' has no field '%s'", m->name, m->body, name);
    *info = brunt_body_field(world, body, field);
    *out = brunt_alloc(sizeof(double) * (size_t)info->components * (size_t)brunt_body_size(world, body, info->at));
    if (!*out) return brunt_fail(error, BRUNT_FAILED, "out of memory for measure '%s'", m->name);
    brunt_body_read(world, body, field, *out);
    return BRUNT_OK;
}

void measure_free_points(point_set *set) {
    brunt_free(set->position);
    brunt_free(set->gradient);
    brunt_free(set->volume);
    brunt_free(set->integrity);
    brunt_free(set->change);
    brunt_free(set->values);
}

// Rings are as large as their circumference: a mean counts each by its material, as one over equal cells does.
static int read_weights(const brunt_measure *m, brunt_world *world, int32_t body, point_set *set, brunt_error *error) {
    brunt_field_info unused;
    if (read_field(world, body, "volume", m, &set->volume, &unused, error)) return BRUNT_FAILED;
    return read_field(world, body, "J", m, &set->change, &unused, error);
}

int measure_read_points(const brunt_measure *m, brunt_world *world, int32_t body, point_set *set, brunt_error *error) {
    memset(set, 0, sizeof *set);
    brunt_field_info info = {.at = brunt_location_of_motion(world, body)};
    const bool of_field = m->kind == BRUNT_MEASURE_FIELD || m->kind == BRUNT_MEASURE_PROFILE;
    bool sized = !of_field && info.at == BRUNT_AT_PARTICLES;
    int status = BRUNT_OK;
    set->dimension = brunt_world_dimension(world);
    set->axisymmetric = brunt_effect_on(world, "axisymmetric");
    if (of_field) {
        status = read_field(world, body, m->field, m, &set->values, &info, error);
        set->components = info.components;
        if (!status && m->component >= set->components)
            status = brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: component %d of '%s', which has %d", m->name,
                                m->component, m->field, set->components);
    }
    brunt_field_info unused;
    if (sized) status = read_field(world, body, "deformation_gradient", m, &set->gradient, &unused, error);
    if (!status && sized && brunt_body_find_field(world, body, "integrity") >= 0)
        status = read_field(world, body, "integrity", m, &set->integrity, &unused, error);
    if (!status && m->kind == BRUNT_MEASURE_PROFILE && info.at == BRUNT_AT_NODES)
        status = brunt_fail(error, BRUNT_BAD_INPUT,
                            "measures.%s: '%s' of body '%s' is at nodes, a profile wants particles or elements",
                            m->name, m->field, brunt_body_name(world, body));
    if (!status && (sized || m->kind == BRUNT_MEASURE_PROFILE))
        status = read_field(world, body, "volume", m, &set->volume, &unused, error);
    const bool weighed = set->axisymmetric && m->kind == BRUNT_MEASURE_FIELD && m->take == BRUNT_TAKE_MEAN;
    if (!status && weighed && info.at == BRUNT_AT_PARTICLES) status = read_weights(m, world, body, set, error);
    set->count = brunt_body_size(world, body, info.at);
    if (!status) status = brunt_positions_read(world, body, info.at, &set->position, error);
    if (status) measure_free_points(set);
    return status;
}

static double determinant(const double F[9]) {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

double measure_half_size(const point_set *set, int64_t p, const double n[3]) {
    if (!set->gradient) return 0;
    const double volume = set->volume[p] / (set->axisymmetric ? 2 * acos(-1) * set->position[3 * p] : 1);
    if (set->integrity && !(set->integrity[p] > 0)) return 0.5 * (set->dimension == 3 ? cbrt(volume) : sqrt(volume));
    const double *F = set->gradient + 9 * p;
    double reference = volume / (set->axisymmetric ? F[0] * F[4] - F[1] * F[3] : determinant(F));
    double spacing = set->dimension == 3 ? cbrt(reference) : sqrt(reference), square = 0;
    for (int j = 0; j < 3; j++) {
        double component = F[j] * n[0] + F[3 + j] * n[1] + F[6 + j] * n[2];
        square += component * component;
    }
    return 0.5 * spacing * sqrt(square);
}

bool measure_unit_axis(const brunt_measure *m, double axis[3]) {
    double length = sqrt(m->axis[0] * m->axis[0] + m->axis[1] * m->axis[1] + m->axis[2] * m->axis[2]);
    for (int c = 0; c < 3; c++) axis[c] = length > 0 ? m->axis[c] / length : 0;
    return length > 0;
}

double measure_value(const brunt_measure *m, const point_set *set, int64_t p) {
    const double *v = set->values + set->components * p;
    if (m->component >= 0) return v[m->component];
    if (set->components == 1) return v[0];
    double square = 0;
    for (int c = 0; c < set->components; c++) square += v[c] * v[c] * (set->components == 6 && c >= 3 ? 2 : 1);
    return sqrt(square);
}

int measure_take_points(const brunt_measure *m, brunt_world *world,
                        double (*reduce)(const brunt_measure *, const point_set *), double *value, brunt_error *error) {
    point_set set;
    const int32_t body = brunt_find_body(world, m->body);
    if (body < 0) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: there is no body '%s'", m->name, m->body);
    int status = measure_read_points(m, world, body, &set, error);
    if (status) return status;
    *value = reduce(m, &set);
    measure_free_points(&set);
    return BRUNT_OK;
}
