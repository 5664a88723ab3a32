// Matrices of implicit steps in small: K + 4 / dt^2 M of an isotropic elastic body (E 1, nu 0.3, density 1, h 1), dt =
// c h / wave speed. Balls (disks) of particles, two a cell side, on quadratic splines; boxes of simplices. For the
// suites of solvers, and for the benchmark of where each of them is cheapest.
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linear/assembly.h"

enum { ELASTIC_NODES = 27 };

typedef struct elastic {
    int dim;
    int32_t nodes;
    brunt_stencils stencils;
    int64_t *first; // of stencils
    int32_t *node;
    int64_t *point_first; // of each stencil
    double *point;        // of spline particles: place in cells from the stencil's first node, 0.5 .. 1.5
    double *gradient;     // of simplices: (dim + 1) * dim
    double *place;        // of nodes, 3
    double *mass;
    bool spline;
} elastic;

#define ELASTIC_LAMBDA (0.3 / 1.3 / 0.4)
#define ELASTIC_MU (1 / 2.6)

static inline void elastic_free(elastic *e) {
    free(e->first), free(e->node), free(e->point_first), free(e->point), free(e->gradient), free(e->place),
        free(e->mass);
    *e = (elastic){0};
}

// Values and slopes of the three quadratic splines of an axis.
static inline void elastic_weights(double x, double w[3], double d[3]) {
    w[0] = 0.5 * (1.5 - x) * (1.5 - x), w[1] = 0.75 - (x - 1) * (x - 1), w[2] = 0.5 * (x - 0.5) * (x - 0.5);
    d[0] = x - 1.5, d[1] = -2 * (x - 1), d[2] = x - 0.5;
}

// Weights and gradients of a particle at all nodes of its stencil.
static inline void elastic_shape(int dim, const double *point, double *weight, double (*g)[3]) {
    double w[3][3], d[3][3];
    for (int c = 0; c < dim; c++) elastic_weights(point[c], w[c], d[c]);
    for (int a = 0; a < (dim == 3 ? 27 : 9); a++) {
        const int at[3] = {dim == 3 ? a / 9 : a / 3, dim == 3 ? a / 3 % 3 : a % 3, a % 3};
        weight[a] = 1;
        for (int c = 0; c < dim; c++) weight[a] *= w[c][at[c]], g[a][c] = d[c][at[c]];
        for (int c = 0; c < dim; c++)
            for (int o = 0; o < dim; o++)
                if (o != c) g[a][c] *= w[o][at[o]];
    }
}

// The cells of a ball of `cells` across whose particles are within it: for each, their places. Pass 0 counts, pass 1
// fills.
static inline int64_t elastic_cell(const elastic *e, int cells, const int base[3], double *point) {
    const double centre = (cells + 6) / 2. + 0.137, r = cells / 2., shift[3] = {0.11, 0.23, 0.31};
    int64_t count = 0;
    int from[3] = {0}, to[3] = {0};
    for (int c = 0; c < e->dim; c++) {
        // particles i at centre - r + i / 2 + shift whose base is floor(x - 1/2)
        from[c] = (int)ceil(2 * (base[c] + 0.5 - centre + r - shift[c]));
        to[c] = (int)ceil(2 * (base[c] + 1.5 - centre + r - shift[c])) - 1;
    }
    for (int i = from[0]; i <= to[0]; i++)
        for (int j = from[1]; j <= to[1]; j++)
            for (int k = from[2]; k <= to[2]; k++) {
                const int at[3] = {i, j, k};
                double x[3], s = 0;
                for (int c = 0; c < e->dim; c++) {
                    x[c] = centre - r + 0.5 * at[c] + shift[c];
                    s += (x[c] - centre) * (x[c] - centre);
                }
                if (s > r * r) continue;
                for (int c = 0; point && c < e->dim; c++) point[count * e->dim + c] = x[c] - base[c];
                count++;
            }
    return count;
}

static inline elastic elastic_splines(int dim, int cells) {
    const int g = cells + 8;
    const int64_t all = dim == 3 ? (int64_t)g * g * g : (int64_t)g * g, each = dim == 3 ? 27 : 9;
    elastic e = {.dim = dim, .spline = true};
    int32_t *id = malloc((size_t)all * sizeof *id);
    for (int64_t n = 0; n < all; n++) id[n] = -1;
    for (int pass = 0; pass < 2; pass++) {
        int64_t bins = 0, points = 0;
        for (int64_t q = 0; q < all; q++) {
            const int base[3] = {(int)(dim == 3 ? q / g / g : q / g), (int)(dim == 3 ? q / g % g : q % g),
                                 (int)(q % g)};
            if (base[0] > g - 3 || base[1] > g - 3 || (dim == 3 && base[2] > g - 3)) continue;
            const int64_t count = elastic_cell(&e, cells, base, pass ? e.point + points * dim : NULL);
            if (!count) continue;
            for (int a = 0; a < each; a++) {
                const int64_t n =
                    dim == 3 ? q + (int64_t)(a / 9) * g * g + a / 3 % 3 * g + a % 3 : q + a / 3 * g + a % 3;
                if (pass)
                    e.node[bins * each + a] = id[n];
                else
                    id[n] = 0;
            }
            if (pass) e.first[bins + 1] = (bins + 1) * each, e.point_first[bins + 1] = points + count;
            bins++, points += count;
        }
        if (pass) break;
        for (int64_t n = 0; n < all; n++)
            if (id[n] >= 0) id[n] = e.nodes++;
        e.first = calloc((size_t)bins + 1, sizeof *e.first), e.point_first = calloc((size_t)bins + 1, sizeof *e.first);
        e.node = malloc((size_t)(bins * each) * sizeof *e.node),
        e.point = malloc((size_t)(points * dim) * sizeof(double));
        e.place = malloc((size_t)e.nodes * 3 * sizeof(double)), e.mass = calloc((size_t)e.nodes, sizeof(double));
        for (int64_t n = 0; n < all; n++)
            if (id[n] >= 0)
                for (int c = 0; c < 3; c++)
                    e.place[3 * id[n] + c] = (double)(c == 2     ? (dim == 3 ? n % g : 0)
                                                      : c == 1   ? (dim == 3 ? n / g % g : n % g)
                                                      : dim == 3 ? n / g / g
                                                                 : n / g);
        e.stencils.count = bins;
    }
    free(id);
    e.stencils.first = e.first, e.stencils.node = e.node;
    for (int64_t s = 0; s < e.stencils.count; s++)
        for (int64_t p = e.point_first[s]; p < e.point_first[s + 1]; p++) {
            double w[ELASTIC_NODES], d[ELASTIC_NODES][3];
            elastic_shape(dim, e.point + p * dim, w, d);
            for (int a = 0; a < each; a++) e.mass[e.node[s * each + a]] += w[a] * (dim == 3 ? 0.125 : 0.25);
        }
    return e;
}

// A box of side^dim nodes; each cell is cut into the simplices of all ways along its edges from corner to corner.
static inline elastic elastic_simplices(int dim, int side) {
    static const int ways[2][6][3] = {{{0, 1}, {1, 0}},
                                      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    const int cells = side - 1, corners = dim + 1, parts = dim == 3 ? 6 : 2;
    const int64_t all = (dim == 3 ? (int64_t)cells * cells * cells : (int64_t)cells * cells) * parts;
    elastic e = {.dim = dim, .nodes = dim == 3 ? side * side * side : side * side};
    e.first = calloc((size_t)all + 1, sizeof *e.first), e.point_first = calloc((size_t)all + 1, sizeof *e.first);
    e.node = malloc((size_t)(all * corners) * sizeof *e.node),
    e.gradient = calloc((size_t)(all * corners * dim), sizeof(double));
    e.place = malloc((size_t)e.nodes * 3 * sizeof(double)), e.mass = calloc((size_t)e.nodes, sizeof(double));
    for (int32_t n = 0; n < e.nodes; n++) {
        e.place[3 * n] = dim == 3 ? n / side / side : n / side,
                    e.place[3 * n + 1] = dim == 3 ? n / side % side : n % side;
        e.place[3 * n + 2] = dim == 3 ? n % side : 0;
    }
    for (int64_t s = 0; s < all; s++) {
        const int64_t cell = s / parts;
        int at[3] = {(int)(dim == 3 ? cell / cells / cells : cell / cells),
                     (int)(dim == 3 ? cell / cells % cells : cell % cells), (int)(cell % cells)};
        double *g = e.gradient + s * corners * dim;
        for (int a = 0; a < corners; a++) {
            const int32_t n = dim == 3 ? (at[0] * side + at[1]) * side + at[2] : at[0] * side + at[1];
            e.node[s * corners + a] = n, e.mass[n] += 1. / parts / corners;
            if (a == dim) break;
            const int axis =
                ways[dim - 2][s % parts][a]; // the barycentric coordinate of corner a falls along it, of a + 1 rises
            at[axis]++, g[a * dim + axis] -= 1, g[(a + 1) * dim + axis] += 1;
        }
        e.first[s + 1] = (s + 1) * corners, e.point_first[s + 1] = s + 1;
    }
    e.stencils = (brunt_stencils){.count = all, .first = e.first, .node = e.node};
    return e;
}

static inline void elastic_add_point(int dim, int nodes, double (*g)[3], double volume, double *dense) {
    const int64_t width = (int64_t)nodes * dim;
    for (int a = 0; a < nodes; a++)
        for (int b = 0; b < nodes; b++) {
            double s = 0;
            for (int i = 0; i < dim; i++) s += g[a][i] * g[b][i];
            for (int i = 0; i < dim; i++)
                for (int j = 0; j < dim; j++)
                    dense[(a * dim + i) * width + b * dim + j] +=
                        volume * (ELASTIC_LAMBDA * g[a][i] * g[b][j] + ELASTIC_MU * g[a][j] * g[b][i] +
                                  (i == j ? ELASTIC_MU * s : 0));
        }
}

static inline void elastic_fill(void *context, int64_t s, double *dense, int worker) {
    (void)worker;
    const elastic *e = context;
    const int nodes = (int)(e->first[s + 1] - e->first[s]);
    double w[ELASTIC_NODES], g[ELASTIC_NODES][3];
    if (!e->spline) {
        for (int a = 0; a < nodes; a++)
            memcpy(g[a], e->gradient + (s * nodes + a) * e->dim, (size_t)e->dim * sizeof(double));
        elastic_add_point(e->dim, nodes, g, 1. / (e->dim == 3 ? 6 : 2), dense);
        return;
    }
    for (int64_t p = e->point_first[s]; p < e->point_first[s + 1]; p++) {
        elastic_shape(e->dim, e->point + p * e->dim, w, g);
        elastic_add_point(e->dim, nodes, g, e->dim == 3 ? 0.125 : 0.25, dense);
    }
}

static inline brunt_pattern elastic_pattern(const elastic *e) {
    return (brunt_pattern){e->dim, e->nodes, &e->stencils, 1, false, NULL};
}

// Adds 4 / dt^2 M for a step of `courant`; INFINITY: nothing, and the nodes of least x are held.
static inline void elastic_inertia(const elastic *e, const brunt_team *team, double courant, brunt_block_matrix *m) {
    const double dt = courant / sqrt(ELASTIC_LAMBDA + 2 * ELASTIC_MU);
    if (isfinite(courant)) {
        for (int32_t n = 0; n < e->nodes; n++)
            for (int c = 0; c < e->dim; c++)
                brunt_block_matrix_diagonal(m, n)[c * (e->dim + 1)] += 4 / (dt * dt) * e->mass[n];
        return;
    }
    double least = e->place[0];
    uint8_t *held = calloc((size_t)(e->nodes * e->dim), 1);
    for (int32_t n = 0; n < e->nodes; n++) least = fmin(least, e->place[3 * n]);
    for (int64_t i = 0; i < (int64_t)e->nodes * e->dim; i++) held[i] = e->place[3 * (i / e->dim)] <= least + 2;
    brunt_block_matrix_hold(m, team, held, 1);
    free(held);
}
