// Field `von_mises`: the equivalent stress, sqrt(3/2 s : s) of the deviator s.
#include "body/derived.h"

#include <math.h>

static void read(const brunt_point_values *at, double *out) {
    const double *t = at->stress;
    double a = t[0] - t[1], b = t[1] - t[2], c = t[2] - t[0];
    *out = sqrt(0.5 * (a * a + b * b + c * c) + 3 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
}

const brunt_derived_field brunt_field_von_mises = {"von_mises", "Pa", 1, false, read};
