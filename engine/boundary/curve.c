#include "boundary/curve.h"

double brunt_curve_at(const brunt_curve *curve, double time) {
    if (!curve->count) return 1;
    const double(*p)[2] = (const double(*)[2])curve->points;
    if (time <= p[0][0]) return p[0][1];
    for (int32_t k = 1; k < curve->count; k++)
        if (time < p[k][0])
            return p[k - 1][1] + (p[k][1] - p[k - 1][1]) * (time - p[k - 1][0]) / (p[k][0] - p[k - 1][0]);
    return p[curve->count - 1][1];
}
