// Bound of the stable step of rings, in plain numbers.
#include "fem/axisymmetric.h"

#include <math.h>

#include "fem/layout.h"

double brunt_fem_axisymmetric_bound(const brunt_element *type, const double (*x)[3], double r) {
    const lanes one[4] = {lanes_set(1), lanes_set(0), lanes_set(0), lanes_set(1)};
    double share[BRUNT_ELEMENT_NODES], volume = 0;
    real b[BRUNT_ELEMENT_NODES][3];
    axisymmetric_sums sums = {.hoop = lanes_set(0)};
    lanes divergence, greatest;
    type->gradient(x, b);
    type->shares(x, share);
    for (int a = 0; a < type->traits->nodes; a++) volume += share[a];
    for (int a = 0; a < type->traits->nodes; a++) {
        const lanes B[2] = {lanes_set(b[a][0]), lanes_set(b[a][1])}, axial = lanes_set((real)(volume / share[a]));
        add_axisymmetric_sums(B, lanes_set(b[a][2]), axial, x[a][0] > 0 ? axial : lanes_set(0), &sums);
    }
    axisymmetric_bounds(&sums, one, lanes_set(1), &divergence, &greatest);
    return fmax(r, 0) * (double)divergence[0] + (1 - r) * (double)greatest[0];
}
