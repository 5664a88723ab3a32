#include "boundary/curve.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"

double brunt_curve_at(const brunt_curve *curve, double time) {
    if (!curve->count) return 1;
    const double(*p)[2] = (const double(*)[2])curve->points;
    if (time <= p[0][0]) return p[0][1];
    for (int32_t k = 1; k < curve->count; k++)
        if (time < p[k][0])
            return p[k - 1][1] + (p[k][1] - p[k - 1][1]) * (time - p[k - 1][0]) / (p[k][0] - p[k - 1][0]);
    return p[curve->count - 1][1];
}

// From its first point to `time`, which is not before that.
static double from_start(const brunt_curve *curve, double time) {
    const double(*p)[2] = (const double(*)[2])curve->points;
    double sum = 0;
    for (int32_t k = 1; k < curve->count; k++) {
        const double end = fmin(time, p[k][0]);
        sum += (end - p[k - 1][0]) * 0.5 * (p[k - 1][1] + brunt_curve_at(curve, end));
        if (end == time) return sum;
    }
    return sum + (time - p[curve->count - 1][0]) * p[curve->count - 1][1];
}

static double since_first(const brunt_curve *curve, double time) {
    if (!curve->count) return time;
    const double *first = curve->points[0];
    return time <= first[0] ? (time - first[0]) * first[1] : from_start(curve, time);
}

double brunt_curve_integral(const brunt_curve *curve, double time) {
    return since_first(curve, time) - since_first(curve, 0);
}

int brunt_curve_copy(brunt_curve *copy, const brunt_curve *curve, brunt_error *error) {
    *copy = (brunt_curve){.count = curve->count};
    if (!curve->count) return BRUNT_OK;
    const size_t bytes = (size_t)curve->count * sizeof *curve->points;
    if (BRUNT_NEW(copy->points, curve->count, "points of a curve", error)) return BRUNT_FAILED;
    memcpy(copy->points, curve->points, bytes);
    return BRUNT_OK;
}
