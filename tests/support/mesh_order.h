// How well a mesh of a shape has its measure, at two lengths of edges.
#pragma once

#include "tests/support/suite.h"
#include <math.h>

// `error`: share of the measure that is missing, at an edge and at half of it. Straight shapes are met exactly; of
// curved ones the chords miss a share of (h/r)^2: a quarter at half the edge, to `within` of the order.
static inline void expect_second_order(const char *name, bool curved, const double error[2], double within) {
    if (!curved) {
        ck_assert_double_le(fabs(error[0]), 1e-13);
        return;
    }
    ck_assert_msg(error[1] > 0 && error[0] < 0.1, "%s: %g, %g", name, error[0], error[1]);
    const double order = log2(error[0] / error[1]);
    ck_assert_msg(fabs(order - 2) < within, "%s: order %g", name, order);
}
