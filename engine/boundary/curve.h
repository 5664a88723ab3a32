// A number that follows the time: straight between the points of a table.
#pragma once

#include "brunt.h"

// Before the first point and after the last it stays; 1 without points.
double brunt_curve_at(const brunt_curve *curve, double time);
// Its integral over [0, time] [s]; negative before 0.
double brunt_curve_integral(const brunt_curve *curve, double time);
// A curve with points of its own. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_curve_copy(brunt_curve *copy, const brunt_curve *curve, brunt_error *error);
