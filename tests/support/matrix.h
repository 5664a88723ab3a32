// Matrices of three rows, for what the tests derive by hand.
#pragma once

typedef struct mat {
    double a[3][3];
} mat;

static inline mat product(mat a, mat b) {
    mat c = {{{0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) c.a[i][j] += a.a[i][k] * b.a[k][j];
    return c;
}

static inline mat transpose(mat a) {
    mat t;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) t.a[i][j] = a.a[j][i];
    return t;
}
