// Stable steps of undeformed elements, the constants of the bound that the kernels use in each step (its derivation:
// element.inc), and mass scaling.
#include "fem/layout.h"

#include <math.h>
#include <string.h>

void brunt_fem_corners(const brunt_fem_body *body, int32_t slot, double (*x)[3]) {
    const int nodes = body->traits->nodes;
    for (int a = 0; a < nodes; a++)
        for (int i = 0; i < 3; i++)
            x[a][i] = (double)body->start[(size_t)body->element_node[(int64_t)slot * nodes + a] * 4 + (size_t)i];
}

static double product(int n, const double *a, const double *b) {
    double sum = 0;
    for (int k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

// Orthonormalises `count` vectors of n in place (modified Gram-Schmidt).
static void orthonormalise(int n, int count, double (*v)[BRUNT_ELEMENT_NODES]) {
    for (int k = 0; k < count; k++) {
        for (int j = 0; j < k; j++) {
            double share = product(n, v[k], v[j]);
            for (int a = 0; a < n; a++) v[k][a] -= share * v[j][a];
        }
        double norm = sqrt(product(n, v[k], v[k]));
        for (int a = 0; a < n; a++) v[k][a] /= norm > 0 ? norm : 1;
    }
}

// What the lumped masses of an element's nodes make of products of vectors over them: 1 / (n mu_a), with mu_a a node's
// share of the mass, for motions along any axis, and for radial ones, which nodes on the axis of rings do not make.
static void node_weights(const brunt_element *type, const double (*x)[3], double *weight, double *radial) {
    double share[BRUNT_ELEMENT_NODES], sum = 0;
    for (int a = 0; a < type->traits->nodes; a++) weight[a] = radial[a] = 1;
    if (!type->shares) return;
    type->shares(x, share);
    for (int a = 0; a < type->traits->nodes; a++) sum += share[a];
    for (int a = 0; a < type->traits->nodes; a++) {
        weight[a] = sum / (type->traits->nodes * share[a]);
        radial[a] = x[a][0] > 0 ? weight[a] : 0;
    }
}

// Squared cosine of the least angle between the span of `count` vectors of n and that of `modes` others, at most; in
// the product with `weight`. Both are orthonormalised.
static double greatest_cosine(int n, const double *weight, int count, double (*b)[BRUNT_ELEMENT_NODES], int modes,
                              double (*gamma)[BRUNT_ELEMENT_NODES]) {
    double sum = 0;
    for (int a = 0; a < n; a++) {
        for (int i = 0; i < count; i++) b[i][a] *= sqrt(weight[a]);
        for (int m = 0; m < modes; m++) gamma[m][a] *= sqrt(weight[a]);
    }
    orthonormalise(n, count, b);
    orthonormalise(n, modes, gamma);
    for (int i = 0; i < count; i++)
        for (int m = 0; m < modes; m++) sum += pow(product(n, b[i], gamma[m]), 2);
    return fmin(sum, 1);
}

// What distortion does to the hourglass vectors gamma of an element: the greatest eigenvalue of their Gram matrix, by
// Gershgorin's circles, over that of the undistorted element; and a bound of the squared cosine between them and b (of
// rings, in radial motion, b and the hoop).
static void hourglass_shape(const brunt_element *type, const double (*x)[3], double *norm, double *overlap) {
    const int n = type->traits->nodes, modes = type->hourglass_modes, dim = type->traits->span;
    real gradient[BRUNT_ELEMENT_NODES][3];
    double b[3][BRUNT_ELEMENT_NODES], gamma[4][BRUNT_ELEMENT_NODES] = {{0}}, other[4][BRUNT_ELEMENT_NODES];
    double weight[BRUNT_ELEMENT_NODES], radial[BRUNT_ELEMENT_NODES];
    type->gradient(x, gradient);
    node_weights(type, x, weight, radial);
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < n; a++) b[i][a] = (double)gradient[a][i];
    for (int m = 0; m < modes; m++) {
        for (int a = 0; a < n; a++) gamma[m][a] = type->hourglass[m][a];
        for (int i = 0; i < dim; i++) {
            double along = 0;
            for (int a = 0; a < n; a++) along += type->hourglass[m][a] * (x[a][i] - x[0][i]);
            for (int a = 0; a < n; a++) gamma[m][a] -= along * b[i][a];
        }
    }
    *norm = 0;
    for (int m = 0; m < modes; m++) {
        double row = 0;
        for (int k = 0; k < modes; k++) {
            double inner = 0;
            for (int a = 0; a < n; a++) inner += weight[a] * gamma[m][a] * gamma[k][a];
            row += fabs(inner);
        }
        *norm = fmax(*norm, row / n);
    }
    memcpy(other, gamma, sizeof other);
    *overlap = greatest_cosine(n, weight, dim, b, modes, gamma);
    if (!type->axisymmetric) return;
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < n; a++) b[i][a] = (double)gradient[a][i];
    *overlap = fmax(*overlap, greatest_cosine(n, radial, 3, b, modes, other));
}

// omega^2 of strain, and of the hourglass springs [1/s^2] or dampers [1/s], of an undeformed element. `warp`: what the
// warp of a membrane adds to their joint bound (membrane.inc), inside its root and after it.
static void element_frequencies(const brunt_fem_body *body, const double (*x)[3], double *strain, double *hourglass,
                                double warp[2]) {
    const brunt_element *type = body->element;
    const int n = type->traits->nodes, dim = type->traits->span;
    const double c0 = (double)body->material.wave_speed, r = (double)body->lateral_ratio;
    real b[BRUNT_ELEMENT_NODES][3];
    double S[3][3] = {{0}}, trace = 0, deviator = 0;
    type->gradient(x, b);
    for (int a = 0; a < n; a++)
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) S[i][j] += (double)b[a][i] * (double)b[a][j];
    for (int i = 0; i < dim; i++) trace += S[i][i];
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) deviator += pow(S[i][j] - (i == j ? trace / dim : 0), 2);
    double greatest = trace / dim + sqrt((dim - 1.0) / dim * deviator);
    *strain = n * c0 * c0 * (fmax(r, 0) * trace + (1 - r) * greatest);
    if (type->axisymmetric) *strain = c0 * c0 * brunt_fem_axisymmetric_bound(type, x, r);
    *hourglass = warp[0] = warp[1] = 0;
    if (!type->hourglass_modes) return;
    double share = (double)body->hourglass_coefficient * (double)body->hourglass_norm;
    if (body->hourglass == BRUNT_HOURGLASS_STIFFNESS)
        *hourglass = share * c0 * c0 * n * trace / dim;
    else
        *hourglass = 16 * share * c0 / pow(type->volume(x), 1.0 / dim);
    if (!type->traits->membrane) return;
    double w = 0, cosine = sqrt((double)body->hourglass_overlap);
    for (int a = 0; a < n; a++) w += type->hourglass[0][a] * (x[a][2] - x[0][2]);
    double D = (double)body->hourglass_norm * *strain * w * w * trace / 36;
    warp[0] = D + 2 * cosine * sqrt(*strain * D);
    warp[1] = (1 + cosine) * *hourglass * (0.289 * w * w * greatest + 0.5 * fabs(w) * sqrt(greatest));
}

// (step / stable step)^2 of an element, so that it is also the factor its density needs for `step`.
static double step_ratio(const brunt_fem_body *body, const double (*x)[3], double step) {
    double strain, hourglass, warp[2], overlap = (double)body->hourglass_overlap;
    element_frequencies(body, x, &strain, &hourglass, warp);
    double a = strain * step * step / 4;
    if (body->hourglass == BRUNT_HOURGLASS_VISCOUS) {
        double b = hourglass * step / 2, s = sqrt(overlap);
        return fmax(a + s * b, b + s * a);
    }
    double b = hourglass * step * step / 4;
    double more = warp[0] * step * step / 4, after = warp[1] * step * step / 4;
    return 0.5 * (a + b + more + sqrt((a - b) * (a - b) + 4 * overlap * a * b + more * (2 * (a + b) + more))) + after;
}

// Of ratio(step) = 1: that of springs alone is quadratic in the step; with dampers it is found by halving.
static double stable_step(const brunt_fem_body *body, const double (*x)[3], double density) {
    double guess = body->mean_edge / (double)body->material.wave_speed;
    double step = guess * sqrt(density / step_ratio(body, x, guess));
    if (body->hourglass != BRUNT_HOURGLASS_VISCOUS || !body->element->hourglass_modes) return step;
    double low = 0, high = 2 * step;
    while (high > 0 && isfinite(high) && step_ratio(body, x, high) < density) high *= 2;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (step_ratio(body, x, middle) < density)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// An element's corners as its bounds see them: of a membrane, in its own frame.
static void own_corners(const brunt_fem_body *body, int32_t slot, double (*x)[3]) {
    brunt_fem_corners(body, slot, x);
    if (body->traits->membrane) brunt_fem_flatten(body->traits->nodes, x);
}

// Mean of the edges of an element [m].
static double own_edge(const brunt_element_traits *traits, const double (*x)[3]) {
    double sum = 0;
    for (int n = 0; n < traits->nodes; n++)
        for (int k = 0; k < traits->span; k++) {
            const double *a = x[n], *b = x[traits->corner[n][k]];
            sum += sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) + (b[2] - a[2]) * (b[2] - a[2]));
        }
    return sum / (traits->nodes * traits->span);
}

void brunt_fem_stable_steps(brunt_fem_body *body, double mass_scaling) {
    const real *volume = brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0];
    double x[BRUNT_ELEMENT_NODES][3], norm = 1, overlap = 0;
    for (int32_t s = 0; s < body->slots && body->element->hourglass_modes; s++) {
        double element_norm, element_overlap;
        own_corners(body, s, x);
        hourglass_shape(body->element, (const double(*)[3])x, &element_norm, &element_overlap);
        norm = fmax(norm, element_norm);
        overlap = fmax(overlap, element_overlap);
    }
    body->hourglass_norm = (real)norm;
    body->hourglass_overlap = (real)overlap;
    const brunt_element_field *field = &body->field[BRUNT_ELEMENT_density_scale];
    body->least_step = INFINITY;
    for (int32_t s = 0; s < body->slots; s++) {
        double density = 1;
        own_corners(body, s, x);
        if (field->components) {
            // A little more, for the rounding of the kernels.
            double wanted =
                step_ratio(body, (const double(*)[3])x, mass_scaling) * (1 + (sizeof(real) == 4 ? 1e-5 : 1e-12));
            if (wanted > 1) density = wanted;
            body->scalar[field->first][s] = (real)density;
            if (body->element_id[s] >= 0 && density > 1) {
                const double edge = own_edge(body->traits, (const double(*)[3])x) * sqrt(density);
                body->scaled_edge = fmax(body->scaled_edge, edge);
                body->scaled_elements++;
                body->added_mass += (density - 1) * (double)volume[s] * (double)body->material.density;
            }
        }
        body->least_step = fmin(body->least_step, stable_step(body, (const double(*)[3])x, density));
    }
}

double brunt_fem_blocks_step(const brunt_fem_body *fem) {
    double least = INFINITY;
    for (int32_t b = 0; b < fem->block_count; b++) {
        if (isnan(fem->report[b].stable_step)) return NAN;
        least = fmin(least, fem->report[b].stable_step);
    }
    return least;
}
