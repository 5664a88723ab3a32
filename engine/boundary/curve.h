// A number that follows the time: straight between the points of a table.
#pragma once

#include "brunt.h"

// Before the first point and after the last it stays; 1 without points.
double brunt_curve_at(const brunt_curve *curve, double time);
