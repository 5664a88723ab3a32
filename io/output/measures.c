#include "io/output/measures.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "io/output/places.h"
#include "io/scene/units.h"

// ---------------------------------------------------------------------------------------------------- history

// Mean time between the rises through the middle between least and most. A rise counts once the quarter of the range
// below the middle was left since the last one: higher modes may make the middle be passed several times.
static double period(const double *time, const double *value, int64_t count, double least, double most) {
    const double middle = 0.5 * (least + most), low = middle - 0.25 * (most - least);
    double first = NAN, last = NAN;
    int64_t rises = 0;
    bool was_low = false;
    for (int64_t r = 1; r < count; r++) {
        was_low = was_low || value[r - 1] < low;
        if (!was_low || !(value[r] >= middle)) continue;
        double share = (middle - value[r - 1]) / (value[r] - value[r - 1]);
        last = time[r - 1] + share * (time[r] - time[r - 1]);
        if (!rises++) first = last;
        was_low = false;
    }
    return rises > 1 ? (last - first) / (double)(rises - 1) : NAN;
}

// Reduces the samples of a column within [from, to]. Times at the ends of the window count: output times carry
// rounding.
static double reduce_history(const brunt_measure *m, const double *time, const double *value, int64_t rows) {
    double slack = 1e-9 * fmax(isfinite(m->from) ? fabs(m->from) : 0, isfinite(m->to) ? fabs(m->to) : 0);
    int64_t first = 0, last = rows - 1;
    while (first < rows && time[first] < m->from - slack) first++;
    while (last >= 0 && time[last] > m->to + slack) last--;
    if (first > last) return NAN;
    int64_t count = last - first + 1;
    double least = value[first], most = value[first];
    for (int64_t r = first; r <= last; r++) {
        if (isnan(value[r])) return NAN;
        least = fmin(least, value[r]);
        most = fmax(most, value[r]);
    }
    switch (m->take) {
    case BRUNT_TAKE_END: return value[last];
    case BRUNT_TAKE_INITIAL: return value[first];
    case BRUNT_TAKE_MIN: return least;
    case BRUNT_TAKE_MAX: return most;
    case BRUNT_TAKE_MAX_ABS: return fmax(fabs(least), fabs(most));
    case BRUNT_TAKE_MEAN: {
        // Over time, by trapezoids: lines need not be evenly spaced.
        if (time[last] == time[first]) return value[first];
        double area = 0;
        for (int64_t r = first; r < last; r++) area += 0.5 * (value[r] + value[r + 1]) * (time[r + 1] - time[r]);
        return area / (time[last] - time[first]);
    }
    case BRUNT_TAKE_SLOPE: {
        double t0 = 0, v0 = 0, tt = 0, tv = 0;
        for (int64_t r = first; r <= last; r++) t0 += time[r] / (double)count, v0 += value[r] / (double)count;
        for (int64_t r = first; r <= last; r++) {
            tt += (time[r] - t0) * (time[r] - t0);
            tv += (time[r] - t0) * (value[r] - v0);
        }
        return count > 1 ? tv / tt : NAN;
    }
    case BRUNT_TAKE_FIRST_NONZERO:
        for (int64_t r = first; r <= last; r++)
            if (value[r] != 0) return time[r];
        return NAN;
    case BRUNT_TAKE_LAST_NONZERO:
        for (int64_t r = last; r >= first; r--)
            if (value[r] != 0) return time[r];
        return NAN;
    case BRUNT_TAKE_RISE:
        for (int64_t r = first; most > 0 && r <= last; r++) {
            if (!(value[r] >= 0.5 * most)) continue;
            double share = r > first ? (0.5 * most - value[r - 1]) / (value[r] - value[r - 1]) : 1;
            return r > first ? time[r - 1] + share * (time[r] - time[r - 1]) : time[r];
        }
        return NAN;
    case BRUNT_TAKE_PERIOD: return period(time + first, value + first, count, least, most);
    }
    return NAN;
}

// Linear between the points x[i * stride], y[i * stride], which ascend and reach over `at`. `*near` is where the last
// search ended: calls with ascending `at` walk through the points once.
static double between(const double *x, const double *y, int stride, int64_t count, double at, int64_t *near) {
    while (*near + 2 < count && x[(*near + 1) * stride] < at) ++*near;
    const double *a = x + *near * stride, *b = a + stride, *ya = y + *near * stride;
    if (count < 2 || at <= a[0]) return ya[0];
    return at >= b[0] ? ya[stride] : ya[0] + (ya[stride] - ya[0]) * ((at - a[0]) / (b[0] - a[0]));
}

// The distance of the history, less `minus` over `divisor`, from the curve, over the curve's range. Both are linear
// between their points, so that the greatest is at a point of either or at an end of the window. NAN where the history
// has none: a run that ended before the window did.
static int reduce_distance(const brunt_measure *m, const double *time, const double *value, int64_t rows,
                           double divisor, double *out, brunt_error *error) {
    const double(*points)[2] = (const double(*)[2])m->curve.points;
    const int64_t count = m->curve.count;
    const double slack = 1e-9 * fmax(fabs(m->from), fabs(m->to));
    *out = NAN;
    if (!rows || time[0] > m->from + slack || time[rows - 1] < m->to - slack) return BRUNT_OK;
    double *at = brunt_alloc(2 * sizeof(double) * (size_t)(rows + count + 2)), least = INFINITY, most = -INFINITY;
    if (!at) return brunt_fail(error, BRUNT_FAILED, "out of memory for measure '%s'", m->name);
    double *distance = at + rows + count + 2;
    int64_t used = 0, r = 0, c = 0;
    at[used++] = m->from;
    while (r < rows || c < count) {
        double t = c >= count || (r < rows && time[r] <= points[c][0]) ? time[r++] : points[c++][0];
        if (t > at[used - 1] && t < m->to) at[used++] = t;
    }
    at[used++] = m->to;
    for (c = 0; c < count; c++) least = fmin(least, points[c][1]), most = fmax(most, points[c][1]);
    int64_t row = 0, point = 0;
    for (int64_t i = 0; i < used; i++) {
        double h = (between(time, value, 1, rows, at[i], &row) - m->minus) / divisor;
        distance[i] = (h - between(points[0], points[0] + 1, 2, count, at[i], &point)) / (most - least);
    }
    *out = reduce_history(m, at, distance, used);
    brunt_free(at);
    return BRUNT_OK;
}

// ---------------------------------------------------------------------------------------------------- bodies

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

// What a measure looks at: particles, nodes or elements.
typedef struct point_set {
    int64_t count;
    int dimension;
    double *position, *values;
    double *gradient, *volume; // of particles, for their size; nodes have none
    bool rings;                // about the axis x = 0, as long as they are there
    double *integrity;         // of particles that may fail and stay; else NULL
    int components;
} point_set;

static void free_points(point_set *set) {
    brunt_free(set->position);
    brunt_free(set->gradient);
    brunt_free(set->volume);
    brunt_free(set->integrity);
    brunt_free(set->values);
}

static bool is_axisymmetric(const brunt_world *world) {
    for (int32_t e = 0; e < brunt_effect_count(world); e++)
        if (!strcmp(brunt_world_effect(world, e).name, "axisymmetric")) return brunt_world_effect(world, e).on;
    return false;
}

static int read_points(const brunt_measure *m, brunt_world *world, int32_t body, point_set *set, brunt_error *error) {
    memset(set, 0, sizeof *set);
    brunt_field_info info = {.at = brunt_place_of_motion(world, body)};
    const bool of_field = m->kind == BRUNT_MEASURE_FIELD || m->kind == BRUNT_MEASURE_PROFILE;
    bool sized = !of_field && info.at == BRUNT_AT_PARTICLES;
    int status = BRUNT_OK;
    set->dimension = brunt_world_dimension(world);
    set->rings = is_axisymmetric(world);
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
    set->count = brunt_body_size(world, body, info.at);
    if (!status) status = brunt_places_read(world, body, info.at, &set->position, error);
    if (status) free_points(set);
    return status;
}

static double determinant(const double F[9]) {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

// Half the size of particle p along a unit direction n: a lattice cell of edge s deforms with F, and |F^T n| is the
// stretch of what now lies along n. s from the reference volume (volume / det F); of a ring from that of its section,
// which F stretches in its plane alone. What has failed has a volume and no shape: it resists no shear, so that F is as
// the motion about it has happened to draw it out. A node lies on the surface itself.
static double half_size(const point_set *set, int64_t p, const double n[3]) {
    if (!set->gradient) return 0;
    const double volume = set->volume[p] / (set->rings ? 2 * acos(-1) * set->position[3 * p] : 1);
    if (set->integrity && !(set->integrity[p] > 0)) return 0.5 * (set->dimension == 3 ? cbrt(volume) : sqrt(volume));
    const double *F = set->gradient + 9 * p;
    double reference = volume / (set->rings ? F[0] * F[4] - F[1] * F[3] : determinant(F));
    double spacing = set->dimension == 3 ? cbrt(reference) : sqrt(reference), square = 0;
    for (int j = 0; j < 3; j++) {
        double component = F[j] * n[0] + F[3 + j] * n[1] + F[6 + j] * n[2];
        square += component * component;
    }
    return 0.5 * spacing * sqrt(square);
}

static bool unit_axis(const brunt_measure *m, double axis[3]) {
    double length = sqrt(m->axis[0] * m->axis[0] + m->axis[1] * m->axis[1] + m->axis[2] * m->axis[2]);
    for (int c = 0; c < 3; c++) axis[c] = length > 0 ? m->axis[c] / length : 0;
    return length > 0;
}

static double extent(const brunt_measure *m, const point_set *set) {
    double axis[3], least = INFINITY, most = -INFINITY;
    if (!unit_axis(m, axis)) return NAN;
    for (int64_t p = 0; p < set->count; p++) {
        const double *x = set->position + 3 * p;
        double along = x[0] * axis[0] + x[1] * axis[1] + x[2] * axis[2], half = half_size(set, p, axis);
        least = fmin(least, along - half);
        most = fmax(most, along + half);
    }
    return set->count ? most - least : NAN;
}

static double radius(const brunt_measure *m, const point_set *set) {
    double axis[3], most = NAN;
    bool has_axis = unit_axis(m, axis);
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
        most = fmax(most, distance + half_size(set, p, r)); // fmax ignores the NAN it starts with
    }
    return most;
}

// The component of a field that a measure asks for, or its magnitude.
static double value_of(const brunt_measure *m, const point_set *set, int64_t p) {
    const double *v = set->values + set->components * p;
    if (m->component >= 0) return v[m->component];
    if (set->components == 1) return v[0];
    double square = 0;
    for (int c = 0; c < set->components; c++) square += v[c] * v[c] * (set->components == 6 && c >= 3 ? 2 : 1);
    return sqrt(square);
}

static double reduce_field(const brunt_measure *m, const point_set *set) {
    double axis[3], least = INFINITY, most = -INFINITY, sum = 0;
    bool sliced = unit_axis(m, axis);
    int64_t count = 0;
    for (int64_t p = 0; p < set->count; p++) {
        double along = 0;
        for (int c = 0; c < 3; c++) along += (set->position[3 * p + c] - m->center[c]) * axis[c];
        if (sliced && (along < m->slab_min || along > m->slab_max)) continue;
        const double value = value_of(m, set, p);
        // A world that goes on holds no such values but where there is nothing to say: the gap to a body out of reach.
        if (isnan(value)) continue;
        least = fmin(least, value);
        most = fmax(most, value);
        sum += value;
        count++;
    }
    if (!count) return NAN;
    switch (m->take) {
    case BRUNT_TAKE_MIN: return least;
    case BRUNT_TAKE_MAX: return most;
    case BRUNT_TAKE_MAX_ABS: return fmax(fabs(least), fabs(most));
    case BRUNT_TAKE_MEAN: return sum / (double)count;
    default: return NAN; // brunt_measure_check refuses the rest
    }
}

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
    unit_axis(m, axis);
    for (int64_t p = 0; p < set->count; p++) {
        double along = 0;
        for (int c = 0; c < 3; c++) along += (set->position[3 * p + c] - m->center[c]) * axis[c];
        const double wanted = reference_at(&m->curve, along);
        *difference += set->volume[p] * fabs(value_of(m, set, p) - wanted);
        *whole += set->volume[p] * fabs(wanted);
    }
}

static int take_profile(const brunt_measure *m, brunt_world *world, double *value, brunt_error *error) {
    double difference = 0, whole = 0;
    int found = 0;
    for (int32_t body = 0; body < brunt_body_count(world); body++) {
        if (*m->body && strcmp(brunt_body_name(world, body), m->body) != 0) continue;
        if (!*m->body && brunt_body_find_field(world, body, m->field) < 0) continue;
        point_set set;
        int status = read_points(m, world, body, &set, error);
        if (status) return status;
        add_profile(m, &set, &difference, &whole);
        free_points(&set);
        found++;
    }
    if (!found) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: no body has a field '%s'", m->name, m->field);
    *value = difference / whole;
    return BRUNT_OK;
}

static int take_points(const brunt_measure *m, brunt_world *world, double *value, brunt_error *error) {
    point_set set;
    if (m->kind == BRUNT_MEASURE_PROFILE) return take_profile(m, world, value, error);
    const int32_t body = brunt_find_body(world, m->body);
    if (body < 0) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: there is no body '%s'", m->name, m->body);
    int status = read_points(m, world, body, &set, error);
    if (status) return status;
    *value = m->kind == BRUNT_MEASURE_EXTENT   ? extent(m, &set)
             : m->kind == BRUNT_MEASURE_RADIUS ? radius(m, &set)
                                               : reduce_field(m, &set);
    free_points(&set);
    return BRUNT_OK;
}

// ---------------------------------------------------------------------------------------------------- public

// Whether a column's unit is that of the curve, which came in SI base units: "m.s-1".
static bool same_unit(const char *column, const char *curve) {
    char base[BRUNT_UNIT_LENGTH] = "", why[256];
    double one = 1;
    brunt_units *units = brunt_units_open();
    bool same = units && brunt_units_to_si(units, column, &one, base, why, sizeof why) && strcmp(base, curve) == 0;
    brunt_units_close(units);
    return same;
}

static int check_profile(const brunt_measure *m, brunt_world *world, brunt_error *error) {
    if (m->take != BRUNT_TAKE_END)
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: a profile is measured at the end only", m->name);
    if (!m->curve.count) return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: a profile wants a reference", m->name);
    if (*m->body && brunt_find_body(world, m->body) < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: there is no body '%s'", m->name, m->body);
    for (int32_t body = 0; *m->curve_unit && body < brunt_body_count(world); body++) {
        const int32_t field = brunt_body_find_field(world, body, m->field);
        if (field < 0 || (*m->body && strcmp(brunt_body_name(world, body), m->body) != 0)) continue;
        const char *unit = brunt_body_field(world, body, field).unit;
        if (!same_unit(unit, m->curve_unit))
            return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the reference is in %s, the field '%s' in %s",
                              m->name, m->curve_unit, m->field, unit);
    }
    return BRUNT_OK;
}

int brunt_measure_check(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                        brunt_error *error) {
    if (measure->kind != BRUNT_MEASURE_HISTORY) {
        double unused;
        if (measure->kind == BRUNT_MEASURE_PROFILE && check_profile(measure, world, error)) return BRUNT_BAD_INPUT;
        if (measure->kind == BRUNT_MEASURE_FIELD && measure->take != BRUNT_TAKE_MIN &&
            measure->take != BRUNT_TAKE_MAX && measure->take != BRUNT_TAKE_MAX_ABS && measure->take != BRUNT_TAKE_MEAN)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "measures.%s: a field is reduced over the body by take: min, max, mean or max_abs",
                              measure->name);
        return brunt_measure_initial(measure, world, &unused, error);
    }
    for (int32_t c = 0; c < brunt_history_column_count(history); c++) {
        const char *unit = brunt_history_column_unit(history, c);
        if (strcmp(brunt_history_column_name(history, c), measure->column) != 0) continue;
        if (!*measure->curve_unit || same_unit(unit, measure->curve_unit)) return BRUNT_OK;
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the curve is in %s, the history's column '%s' in %s",
                          measure->name, measure->curve_unit, measure->column, unit);
    }
    // Name the columns that begin alike ("body."), or the beginnings there are.
    char names[700] = "";
    size_t used = 0, group = strcspn(measure->column, ".");
    for (int pass = 0; pass < 2 && used == 0; pass++)
        for (int32_t c = 0; c < brunt_history_column_count(history); c++) {
            const char *name = brunt_history_column_name(history, c);
            int length = (int)strcspn(name, ".");
            bool alike = (size_t)length == group && !strncmp(name, measure->column, group);
            if (pass == 0 ? !alike
                          : c > 0 && !strncmp(name, brunt_history_column_name(history, c - 1), (size_t)length + 1))
                continue;
            int wrote = snprintf(names + used, sizeof names - used, " %.*s", pass == 0 ? 200 : length, name);
            if ((size_t)wrote >= sizeof names - used) break;
            used += (size_t)wrote;
        }
    return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the history has no column '%s'; there are:%s",
                      measure->name, measure->column, names);
}

int brunt_measure_initial(const brunt_measure *measure, brunt_world *world, double *initial, brunt_error *error) {
    *initial = NAN;
    return measure->kind == BRUNT_MEASURE_HISTORY ? BRUNT_OK : take_points(measure, world, initial, error);
}

int brunt_measure_evaluate(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                           double initial, brunt_measure_result *result, brunt_error *error) {
    *result = (brunt_measure_result){.value = NAN, .error = NAN};
    double value = NAN;
    if (measure->kind == BRUNT_MEASURE_HISTORY) {
        const double *column, *time;
        int status = brunt_history_read(history, measure->column, &column, error);
        if (!status) status = brunt_history_read(history, "time", &time, error);
        if (status) return status;
        const int64_t rows = brunt_history_rows(history);
        initial = rows ? column[0] : NAN;
        if (!measure->curve.count) { // of a history
            value = reduce_history(measure, time, column, rows);
        } else {
            double divisor =
                (measure->relative_to_initial ? initial : 1) * (isnan(measure->relative_to) ? 1 : measure->relative_to);
            status = reduce_distance(measure, time, column, rows, divisor, &value, error);
            if (status) return status;
        }
    } else {
        int status = take_points(measure, world, &value, error);
        if (status) return status;
    }
    if (!measure->curve.count || measure->kind == BRUNT_MEASURE_PROFILE) {
        value -= measure->minus;
        if (measure->relative_to_initial) value /= initial;
        if (!isnan(measure->relative_to)) value /= measure->relative_to;
    }
    result->value = value;
    if (isnan(measure->expect)) return BRUNT_OK;
    double difference = fabs(value - measure->expect);
    // A relative error needs something to be relative to.
    result->error = measure->absolute || measure->expect == 0 ? difference : difference / fabs(measure->expect);
    result->judged = !isnan(measure->tolerance);
    result->ok = result->judged && result->error <= measure->tolerance;
    return BRUNT_OK;
}
