// Measure `history`: a column reduced over time, or its distance from a curve.
#include "io/output/measure.h"
#include "io/scene/scene_rows.h"
#include "io/scene/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

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

// The lines within [from, to] that have a value: a gap of what is near nothing and a probe of what has eroded have
// none. Times at the ends of the window count: output times carry rounding.
static int64_t keep_lines(const brunt_measure *m, double *time, double *value, int64_t rows) {
    const double tolerance = 1e-9 * fmax(isfinite(m->from) ? fabs(m->from) : 0, isfinite(m->to) ? fabs(m->to) : 0);
    const bool of_a_line = m->take == BRUNT_TAKE_END || m->take == BRUNT_TAKE_INITIAL; // whether it has one or not
    int64_t kept = 0;
    for (int64_t r = 0; r < rows; r++) {
        if (time[r] < m->from - tolerance || time[r] > m->to + tolerance || (isnan(value[r]) && !of_a_line)) continue;
        time[kept] = time[r], value[kept++] = value[r];
    }
    return kept;
}

// Reduces the samples of a column, which all have a value.
static double reduce_history(const brunt_measure *m, const double *time, const double *value, int64_t count) {
    const int64_t first = 0, last = count - 1;
    if (!count) return NAN;
    double least = value[first], most = value[first];
    for (int64_t r = first; r <= last; r++) {
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
// has none: a run that ended before the window did, a line within it without a value.
static int reduce_distance(const brunt_measure *m, const double *time, const double *value, int64_t rows,
                           double divisor, double *out, brunt_error *error) {
    const double(*points)[2] = (const double(*)[2])m->curve.points;
    const int64_t count = m->curve.count;
    const double tolerance = 1e-9 * fmax(fabs(m->from), fabs(m->to));
    *out = NAN;
    if (!rows || time[0] > m->from + tolerance || time[rows - 1] < m->to - tolerance) return BRUNT_OK;
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
    bool whole = true;
    for (int64_t i = 0; i < used; i++) {
        double h = (between(time, value, 1, rows, at[i], &row) - m->minus) / divisor;
        distance[i] = (h - between(points[0], points[0] + 1, 2, count, at[i], &point)) / (most - least);
        whole = whole && !isnan(distance[i]);
    }
    if (whole) *out = reduce_history(m, at, distance, used);
    brunt_free(at);
    return BRUNT_OK;
}

static int reduce_lines(const brunt_measure *m, const double *time, const double *value, int64_t rows, double *out,
                        brunt_error *error) {
    double *lines;
    if (BRUNT_NEW(lines, 2 * rows + 1, "lines of a measure", error)) return BRUNT_FAILED;
    memcpy(lines, time, sizeof *lines * (size_t)rows), memcpy(lines + rows, value, sizeof *lines * (size_t)rows);
    *out = reduce_history(m, lines, lines + rows, keep_lines(m, lines, lines + rows, rows));
    brunt_free(lines);
    return BRUNT_OK;
}

static int take(const brunt_measure *m, measure_source *from, double *value, brunt_error *error) {
    const double *column, *time;
    int status = brunt_history_read(from->history, m->column, &column, error);
    if (!status) status = brunt_history_read(from->history, "time", &time, error);
    if (status) return status;
    const int64_t rows = brunt_history_rows(from->history);
    from->initial = rows ? column[0] : NAN;
    if (!m->curve.count) return reduce_lines(m, time, column, rows, value, error);
    const double divisor = (m->relative_to_initial ? from->initial : 1) * (isnan(m->relative_to) ? 1 : m->relative_to);
    return reduce_distance(m, time, column, rows, divisor, value, error);
}

static const char *unit(const brunt_measure *m, const measure_source *from) {
    const int32_t column = brunt_history_find(from->history, m->column);
    return column >= 0 ? brunt_history_column_unit(from->history, column) : NULL;
}

static int check_curve(const brunt_measure *m, const measure_source *from, const char *of, brunt_error *error) {
    if (!*m->curve_unit || measure_same_unit(from->units, of, m->curve_unit)) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the curve is in %s, the history's column '%s' in %s",
                      m->name, m->curve_unit, m->column, of);
}

static int check(const brunt_measure *m, const measure_source *from, brunt_error *error) {
    const brunt_history *history = from->history;
    const int32_t column = brunt_history_find(history, m->column);
    if (column >= 0) return check_curve(m, from, brunt_history_column_unit(history, column), error);
    // Name the columns that begin alike ("body."), or the beginnings there are.
    char names[700] = "";
    size_t used = 0, group = strcspn(m->column, ".");
    for (int pass = 0; pass < 2 && used == 0; pass++)
        for (int32_t c = 0; c < brunt_history_column_count(history); c++) {
            const char *name = brunt_history_column_name(history, c);
            int length = (int)strcspn(name, ".");
            bool alike = (size_t)length == group && !strncmp(name, m->column, group);
            if (pass == 0 ? !alike
                          : c > 0 && !strncmp(name, brunt_history_column_name(history, c - 1), (size_t)length + 1))
                continue;
            int wrote = snprintf(names + used, sizeof names - used, " %.*s", pass == 0 ? 200 : length, name);
            if ((size_t)wrote >= sizeof names - used) break;
            used += (size_t)wrote;
        }
    return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: the history has no column '%s'; there are:%s", m->name,
                      m->column, names);
}

const measure_kind measure_history = {.check = check, .unit = unit, .take = take};

// clang-format off
SCENE_ROWS(measure_history_keys,
    {"measures.*.history", SCENE_TEXT, NULL, OPTIONAL, NONE, "a column of the history, as energy.kinetic, body.rod.velocity_x, contact.rod-plate.force or gas.bag.pressure (forces of a pair are on its second body; of a body with itself 0, what its sides do to each other: its contact shows in contact.bag-bag.area; velocities and kinetic energy are of the middle of the step that ends at its time)"},
    {"measures.*.energy", SCENE_NAME, NULL, OPTIONAL, NONE, "short for history: energy.NAME"});
// clang-format on
