// Where the lines of two edges cross, or pass each other.
#pragma once

#include <stdbool.h>

typedef struct brunt_line_crossing {
    double s, t;          // share of the way along a's edge and b's, outside 0..1 beyond their ends
    double ea[3], eb[3];  // [m] the edges
    double n[3];          // [m^2] ea x eb
    double r[3];          // [m] from b's nearest point to a's: along n, but for rounding
    double aa, bb, sine2; // [m^2] squares of the edges' lengths and [m^4] of that of n
} brunt_line_crossing;

// Nearest points of two lines, each by two of its points. False: the square of the sine of their angle is no more than
// `least`, and nothing but the edges, their squares and n is told.
bool brunt_lines_cross(const double a[2][3], const double b[2][3], double least, brunt_line_crossing *crossing);
