#include "base/volume_root.h"

#include <math.h>

static double value(const double c[4], double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }

// Places where the slope c1 + 2 c2 t + 3 c3 t^2 vanishes, ascending; how many.
static int turning_points(const double c[4], double at[2]) {
    const double a = 3 * c[3], b = 2 * c[2], d = b * b - 4 * a * c[1];
    if (!(d > 0)) return 0;
    const double q = -0.5 * (b + (b < 0 ? -sqrt(d) : sqrt(d)));
    int n = 0;
    if (a != 0) at[n++] = q / a;
    if (q != 0) at[n++] = c[1] / q;
    if (n == 2 && at[0] > at[1]) {
        const double first = at[0];
        at[0] = at[1], at[1] = first;
    }
    return n;
}

// Between turning points the polynomial is monotonous: bisection in the first stretch at whose end it is not positive.
double brunt_smallest_root(const double c[4], double end) {
    double turn[2], low = 0;
    const int turns = turning_points(c, turn);
    for (int k = 0; k <= turns; k++) {
        double high = k < turns ? turn[k] : end;
        if (!(high > low)) continue;
        if (high > end) high = end;
        if (value(c, high) > 0) {
            low = high;
            continue;
        }
        for (;;) {
            const double middle = 0.5 * (low + high);
            if (!(middle > low && middle < high)) return low;
            if (value(c, middle) > 0)
                low = middle;
            else
                high = middle;
        }
    }
    return INFINITY;
}
