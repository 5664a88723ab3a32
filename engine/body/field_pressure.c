// Field `pressure`: a third of the trace of the stress, positive in compression.
#include "body/derived.h"

static void read(const brunt_point_values *at, double *out) {
    *out = -(at->stress[0] + at->stress[1] + at->stress[2]) / 3;
}

const brunt_derived_field brunt_field_pressure = {"pressure", "Pa", 1, false, read};
