// Small symmetric matrices without their negative eigenvalues: of a stencil, of an element.
#include "linear/project.h"

#include <math.h>

#include "base/error.h"

enum { PROJECTED_LIMIT = 12 };

// Sets h[p][q] to 0 by a turn of rows and columns p and q; eigenvectors in v turn along.
static void turn(int n, double *h, double *v, int p, int q) {
    const double off = h[p * n + q];
    if (off == 0) return;
    const double theta = (h[q * n + q] - h[p * n + p]) / (2 * off);
    const double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < n; k++) {
        const double x = h[k * n + p], y = h[k * n + q];
        h[k * n + p] = c * x - s * y, h[k * n + q] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        const double x = h[p * n + k], y = h[q * n + k], a = v[k * n + p], b = v[k * n + q];
        h[p * n + k] = c * x - s * y, h[q * n + k] = s * x + c * y;
        v[k * n + p] = c * a - s * b, v[k * n + q] = s * a + c * b;
    }
}

// Jacobi's method: it takes small eigenvalues beside large ones as they are.
void brunt_project_positive(int n, double *h) {
    enum { SWEEPS = 30 };
    double d[PROJECTED_LIMIT * PROJECTED_LIMIT], v[PROJECTED_LIMIT * PROJECTED_LIMIT] = {0}, all = 0;
    BRUNT_ASSERT(n <= PROJECTED_LIMIT);
    for (int i = 0; i < n * n; i++) d[i] = h[i], all += h[i] * h[i];
    for (int i = 0; i < n; i++) v[i * n + i] = 1;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double off = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) off += d[p * n + q] * d[p * n + q];
        if (!(off > 1e-32 * all)) break;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) turn(n, d, v, p, q);
    }
    for (int k = 0; k < n; k++) {
        const double negative = d[k * n + k];
        if (negative >= 0) continue;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) h[i * n + j] -= negative * v[i * n + k] * v[j * n + k];
    }
}
