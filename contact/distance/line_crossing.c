#include "contact/distance/line_crossing.h"

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool brunt_lines_cross(const double a[2][3], const double b[2][3], double least, brunt_line_crossing *c) {
    for (int k = 0; k < 3; k++) c->ea[k] = a[1][k] - a[0][k], c->eb[k] = b[1][k] - b[0][k];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, l = (k + 2) % 3;
        c->n[k] = c->ea[i] * c->eb[l] - c->ea[l] * c->eb[i];
    }
    c->aa = dot(c->ea, c->ea), c->bb = dot(c->eb, c->eb), c->sine2 = dot(c->n, c->n);
    if (!(c->sine2 > least * c->aa * c->bb)) return false;
    const double ab = dot(c->ea, c->eb);
    c->s = c->t = 0;
    for (int k = 0; k < 3; k++) c->r[k] = a[0][k] - b[0][k];
    for (int twice = 0; twice < 2; twice++) { // the second time from near the place
        const double ra = dot(c->r, c->ea), rb = dot(c->r, c->eb);
        c->s += (ab * rb - c->bb * ra) / c->sine2, c->t += (c->aa * rb - ab * ra) / c->sine2;
        for (int k = 0; k < 3; k++) c->r[k] = a[0][k] - b[0][k] + c->s * c->ea[k] - c->t * c->eb[k];
    }
    return true;
}
