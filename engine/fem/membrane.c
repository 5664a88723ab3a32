// A membrane's element by itself, in plain numbers: its frame, its shape in it, its stress in space.
#include <math.h>

#include "fem/layout.h"

static double product(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void vector_product(const double *a, const double *b, double *out) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

// chi and psi of the kernels: sums of opposite sides, or the edges from node 0.
static void tangents(int nodes, const double (*x)[3], double chi[3], double psi[3]) {
    for (int i = 0; i < 3; i++) {
        chi[i] = nodes == 4 ? (x[2][i] - x[0][i]) + (x[1][i] - x[3][i]) : x[1][i] - x[0][i];
        psi[i] = nodes == 4 ? (x[2][i] - x[0][i]) - (x[1][i] - x[3][i]) : x[2][i] - x[0][i];
    }
}

void brunt_membrane_frame(int nodes, const double (*x)[3], double e[3][3]) {
    double chi[3], psi[3], alpha[3], beta[3];
    tangents(nodes, x, chi, psi);
    vector_product(chi, psi, e[2]);
    double size = sqrt(product(e[2], e[2])), a = 1 / sqrt(product(chi, chi)), b = 1 / sqrt(product(psi, psi));
    for (int i = 0; i < 3; i++) {
        e[2][i] /= size;
        alpha[i] = a * chi[i] + b * psi[i];
    }
    double half = sqrt(0.5 / product(alpha, alpha));
    for (int i = 0; i < 3; i++) alpha[i] *= half;
    vector_product(e[2], alpha, beta);
    for (int i = 0; i < 3; i++) e[0][i] = alpha[i] - beta[i], e[1][i] = alpha[i] + beta[i];
}

void brunt_fem_flatten(int nodes, double (*x)[3]) {
    double e[3][3], from[3] = {x[0][0], x[0][1], x[0][2]};
    brunt_membrane_frame(nodes, (const double(*)[3])x, e);
    for (int a = 0; a < nodes; a++) {
        double d[3] = {x[a][0] - from[0], x[a][1] - from[1], x[a][2] - from[2]};
        for (int i = 0; i < 3; i++) x[a][i] = product(d, e[i]);
    }
}

// F_alpha = dx/dX_alpha of the mean plane: the duals of the reference tangents times those of now.
static void tangent_map(const brunt_fem_body *body, int32_t slot, double F[2][3]) {
    const int nodes = body->traits->nodes;
    double X[BRUNT_ELEMENT_NODES][3], x[BRUNT_ELEMENT_NODES][3], e[3][3], start[2][3], now[2][3], m[2][2];
    brunt_fem_corners(body, slot, X);
    for (int a = 0; a < nodes; a++) {
        const real *node = brunt_fem_node(body, body->element_node[(int64_t)slot * nodes + a]);
        for (int i = 0; i < 3; i++) x[a][i] = (double)node[i];
    }
    tangents(nodes, (const double(*)[3])X, start[0], start[1]);
    tangents(nodes, (const double(*)[3])x, now[0], now[1]);
    brunt_membrane_frame(nodes, (const double(*)[3])X, e);
    for (int k = 0; k < 2; k++)
        for (int b = 0; b < 2; b++) m[k][b] = product(start[k], e[b]);
    double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    for (int i = 0; i < 3; i++) {
        F[0][i] = (m[1][1] * now[0][i] - m[0][1] * now[1][i]) / det;
        F[1][i] = (m[0][0] * now[1][i] - m[1][0] * now[0][i]) / det;
    }
}

void brunt_membrane_stress(const brunt_fem_body *body, int32_t slot, double sigma[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    real *const *U = body->scalar + body->field[BRUNT_ELEMENT_deformation_gradient].first,
                *const *tau = body->scalar + body->field[BRUNT_ELEMENT_kirchhoff_stress].first;
    const double u0 = (double)U[0][slot], u1 = (double)U[3][slot], u2 = (double)U[1][slot], det = u0 * u1 - u2 * u2;
    const double inverse[2][2] = {{u1 / det, -u2 / det}, {-u2 / det, u0 / det}};
    const double t[2][2] = {{(double)tau[0][slot], (double)tau[3][slot]}, {(double)tau[3][slot], (double)tau[1][slot]}};
    double F[2][3], S[2][2] = {{0}}, normal[3];
    tangent_map(body, slot, F);
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            for (int c = 0; c < 2; c++)
                for (int d = 0; d < 2; d++) S[a][b] += inverse[a][c] * t[c][d] * inverse[d][b];
    vector_product(F[0], F[1], normal);
    const double across = (double)body->scalar[body->field[BRUNT_ELEMENT_thickness_stretch].first][slot];
    const double J = sqrt(product(normal, normal)) * across;
    for (int k = 0; k < 6; k++) {
        sigma[k] = 0;
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++) sigma[k] += F[a][row[k]] * S[a][b] * F[b][column[k]] / J;
    }
}
