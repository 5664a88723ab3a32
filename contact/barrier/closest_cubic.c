// Points and curves in the plane.
#include "contact/barrier/closest.h"

#include <math.h>
#include <string.h>

static const double BORDER = 1e-13, TIE = 1e-14; // as of edges

void brunt_cubic_weights(const brunt_cubic *curve, double s, double weight[BRUNT_CUBIC_PLACES]) {
    for (int i = 0; i < curve->places; i++) {
        const double *w = curve->weight[i];
        weight[i] = w[0] + s * (w[1] + s * (w[2] + s * w[3]));
    }
}

// y(s) and its derivatives by s, from a point.
static void along_cubic(const double q[3], const double (*x)[3], const brunt_cubic *curve, double s, double y[3][2]) {
    memset(y, 0, 6 * sizeof(double));
    for (int i = 0; i < curve->places; i++) {
        const double *w = curve->weight[i];
        const double of[3] = {w[0] + s * (w[1] + s * (w[2] + s * w[3])), w[1] + s * (2 * w[2] + s * 3 * w[3]),
                              2 * w[2] + s * 6 * w[3]};
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 2; a++) y[k][a] += of[k] * (x[i][a] - q[a]);
    }
}

static double dot_2(const double a[2], const double b[2]) { return a[0] * b[0] + a[1] * b[1]; }

// y(s) from a point: y = c0 + c1 s + c2 s^2 + c3 s^3.
static void cubic_from(const double q[3], const double (*x)[3], const brunt_cubic *curve, double c[4][2]) {
    memset(c, 0, 8 * sizeof(double));
    for (int i = 0; i < curve->places; i++)
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 2; a++) c[k][a] += curve->weight[i][k] * (x[i][a] - q[a]);
}

// Where between its ends the distance is least, which falls at 0 and rises at 1: by Newton's method, with the middle of
// what holds the place where it would leave that.
static double least_along(const double q[3], const double (*x)[3], const brunt_cubic *curve) {
    double low = 0, high = 1, s = 0.5, c[4][2], y[3][2];
    cubic_from(q, x, curve, c);
    for (int i = 0; i < 100; i++) {
        for (int a = 0; a < 2; a++) {
            y[0][a] = c[0][a] + s * (c[1][a] + s * (c[2][a] + s * c[3][a]));
            y[1][a] = c[1][a] + s * (2 * c[2][a] + s * 3 * c[3][a]);
            y[2][a] = 2 * c[2][a] + s * 6 * c[3][a];
        }
        const double slope = dot_2(y[0], y[1]), second = dot_2(y[1], y[1]) + dot_2(y[0], y[2]), to = s - slope / second;
        *(slope < 0 ? &low : &high) = s;
        const double next = second > 0 && to >= low && to <= high ? to : low + (high - low) / 2, way = fabs(next - s);
        s = next;
        if (way <= TIE) break;
    }
    return s;
}

// The curve leaves its chord by 3 s (1 - s)^2 D1 + 3 s^2 (1 - s) D2, D1 and D2 being how far its inner points of Bezier
// leave the chord's: by no more than 3/4 of the greater.
double brunt_cubic_bend(const double (*x)[3], const brunt_cubic *curve) {
    double c[4][2], bend[2] = {0};
    cubic_from(x[0], x, curve, c);
    for (int a = 0; a < 2; a++) {
        const double first = (c[2][a] + c[3][a]) / 3, second = c[3][a] / 3;
        bend[0] += first * first, bend[1] += (first + second) * (first + second);
    }
    return 0.75 * sqrt(fmax(bend[0], bend[1]));
}

int brunt_closest_of_cubic(const double q[3], const double (*x)[3], const brunt_cubic *curve, double *s, double *d) {
    double y[2][3][2];
    along_cubic(q, x, curve, 0, y[0]), along_cubic(q, x, curve, 1, y[1]);
    const bool falls = dot_2(y[0][0], y[0][1])<0, rises = dot_2(y[1][0], y[1][1])> 0;
    *s = falls && rises ? least_along(q, x, curve) : falls;
    if (!falls && !rises) *s = dot_2(y[1][0], y[1][0]) < dot_2(y[0][0], y[0][0]);
    if (*s > BORDER && *s < 1 - BORDER) {
        along_cubic(q, x, curve, *s, y[0]);
        return *d = sqrt(dot_2(y[0][0], y[0][0])), BRUNT_AT_A | BRUNT_AT_B;
    }
    const int end = *s > 0.5;
    *s = end, *d = hypot(x[end][0] - q[0], x[end][1] - q[1]);
    return end ? BRUNT_AT_B : BRUNT_AT_A;
}

void brunt_closest_cubic(const double q[3], const double (*x)[3], const brunt_cubic *curve, double s, int side,
                         brunt_closest *c) {
    double y[3][2];
    *c = (brunt_closest){.places = 1 + curve->places, .curved = true, .free = 1, .w = {1}};
    along_cubic(q, x, curve, s, y);
    const double size = hypot(y[1][0], y[1][1]);
    c->n[0] = side * y[1][1] / size, c->n[1] = -side * y[1][0] / size;
    c->d = -dot_2(c->n, y[0]);
    for (int a = 0; a < 2; a++) c->tangent[0][a] = -y[1][a], c->tangent[1][a] = -y[2][a];
    brunt_cubic_weights(curve, s, c->w + 1);
    for (int i = 0; i < curve->places; i++) {
        const double *w = curve->weight[i];
        c->w[1 + i] = -c->w[1 + i], c->g[0][1 + i] = -(w[1] + s * (2 * w[2] + s * 3 * w[3]));
    }
}

// The free coordinate has of d^2 / 2 the second derivative |r'|^2 + d n . r''; n turns with the curve.
void brunt_cubic_hessian(const brunt_closest *c, double outer, double inner, double *h) {
    const double *t = c->tangent[0], a = dot_2(t, t), bend = dot_2(c->n, c->tangent[1]), second = a + bend * c->d;
    const int rows = c->places * 2;
    for (int i = 0; i < c->places; i++)
        for (int j = 0; j < c->places; j++) {
            const double ww = c->w[i] * c->w[j], gg = c->g[0][i] * c->g[0][j];
            for (int k = 0; k < 2; k++)
                for (int l = 0; l < 2; l++)
                    h[(i * 2 + k) * rows + j * 2 + l] +=
                        (outer * ww - inner * c->d * gg / second) * c->n[k] * c->n[l] +
                        inner / second *
                            (ww * bend / a * t[k] * t[l] - c->w[i] * c->g[0][j] * t[k] * c->n[l] -
                             c->g[0][i] * c->w[j] * c->n[k] * t[l]);
        }
}
