// The grid's fields at the particles of one block: velocity and its gradient and, where asked, the affine field, the
// old velocity, or both and the affine field of the old velocity.
//
// On one bin a spline field is a polynomial in the local coordinates xi. Its coefficients are made by sweeps over the
// axes, shared by the bins of a plane; all particles of the bin then evaluate it together. Value and gradient follow by
// Horner's rule, the affine field from the gradient (affine_field.h).
#pragma once

#include "mpm/affine_field.h"
#include "mpm/node_window.h"
#include "mpm/transfer.h"

// Literals, as of transfer_kind.h. Nodes have 8 reals with the old velocity, else 4.
typedef struct fields_kind {
    int dim, order;
    bool old, affine;
} fields_kind;

typedef void fields_fn(brunt_body *body, const brunt_block *block, const int32_t *start, brunt_workspace *work);

BRUNT_INLINE int reals_of(fields_kind kind) { return kind.old ? 8 : 4; }
BRUNT_INLINE int side_of(fields_kind kind) { return kind.dim == 3 ? 4 : 8; }
// Coefficients of a bin that differ in the powers of all axes but x.
BRUNT_INLINE int per_bin(fields_kind kind) {
    const int n = kind.order + 1;
    return kind.dim == 3 ? n * n : n;
}
// Bins of a plane of constant x.
BRUNT_INLINE int bins_of_plane(fields_kind kind) { return kind.dim == 3 ? 16 : 8; }

// Component r of a bin's coefficient of x^a y^b z^c.
BRUNT_INLINE lanes coefficient(const real *cf, int a, int b, int c, int r, fields_kind kind) {
    const int n = kind.order + 1;
    return lanes_set(cf[(kind.dim == 3 ? (a * n + b) * n + c : a * n + b) * reals_of(kind) + r]);
}

// Of a polynomial with coefficients that are polynomials in z: those in x and y, at xi[2].
BRUNT_INLINE lanes along_z(const real *cf, int a, int b, int r, lanes z, fields_kind kind) {
    if (kind.dim == 2) return coefficient(cf, a, b, 0, r, kind);
    lanes q = coefficient(cf, a, b, kind.order, r, kind);
    for (int c = kind.order - 1; c >= 0; c--) q = q * z + coefficient(cf, a, b, c, r, kind);
    return q;
}

// Slope along z of component r, and its highest coefficient there.
BRUNT_INLINE lanes slope_along_z(const real *cf, const lanes xi[3], int r, lanes *highest, fields_kind kind) {
    const int order = kind.order;
    lanes pz[4];
    for (int c = 1; c <= order; c++) {
        lanes t[4];
        for (int a = 0; a <= order; a++) {
            t[a] = coefficient(cf, a, order, c, r, kind);
            for (int b = order - 1; b >= 0; b--) t[a] = t[a] * xi[1] + coefficient(cf, a, b, c, r, kind);
        }
        pz[c] = t[order];
        for (int a = order - 1; a >= 0; a--) pz[c] = pz[c] * xi[0] + t[a];
    }
    *highest = pz[order];
    lanes slope = (real)order * pz[order];
    for (int c = order - 1; c >= 1; c--) slope = slope * xi[2] + (real)c * pz[c];
    return slope;
}

// Value of component r, its slopes along the axes and its highest coefficients along them.
BRUNT_INLINE lanes evaluate_component(const real *cf, const lanes xi[3], int r, lanes slope[3], lanes highest[3],
                                      fields_kind kind) {
    const int order = kind.order;
    lanes q[4][4], px[4], py[4]; // after the last axis: coefficients in x and y; in x; in y
    for (int a = 0; a <= order; a++)
        for (int b = 0; b <= order; b++) q[a][b] = along_z(cf, a, b, r, xi[2], kind);
    for (int a = 0; a <= order; a++) {
        px[a] = q[a][order];
        for (int b = order - 1; b >= 0; b--) px[a] = px[a] * xi[1] + q[a][b];
    }
    for (int b = 1; b <= order; b++) {
        py[b] = q[order][b];
        for (int a = order - 1; a >= 0; a--) py[b] = py[b] * xi[0] + q[a][b];
    }
    lanes value = px[order];
    for (int a = order - 1; a >= 0; a--) value = value * xi[0] + px[a];
    highest[0] = px[order], highest[1] = py[order];
    slope[0] = (real)order * px[order], slope[1] = (real)order * py[order];
    for (int a = order - 1; a >= 1; a--) {
        slope[0] = slope[0] * xi[0] + (real)a * px[a];
        slope[1] = slope[1] * xi[1] + (real)a * py[a];
    }
    if (kind.dim == 3) slope[2] = slope_along_z(cf, xi, r, &highest[2], kind);
    return value;
}

// Component r of the old velocity.
BRUNT_INLINE lanes evaluate_old(const real *cf, const lanes xi[3], int r, fields_kind kind) {
    lanes old = (lanes){0};
    for (int a = kind.order; a >= 0; a--) {
        lanes y = (lanes){0};
        for (int b = kind.order; b >= 0; b--) y = y * xi[1] + along_z(cf, a, b, 3 + r, xi[2], kind);
        old = old * xi[0] + y;
    }
    return old;
}

// Where in `out` the old velocity is, and behind it its affine field.
BRUNT_INLINE int old_place(int dim, bool affine) { return dim + dim * dim + (affine ? dim * dim : 0); }

// The old velocity and its affine field.
BRUNT_INLINE void evaluate_old_affine(const real *cf, const lanes xi[3], const lanes correction[3], real inv_h,
                                      real *const *out, int64_t s, fields_kind kind) {
    const int dim = kind.dim, at = old_place(dim, true);
    for (int r = 0; r < dim; r++) {
        lanes slope[3], highest[3];
        lanes_store(out[at + r] + s, evaluate_component(cf, xi, 3 + r, slope, highest, kind));
        for (int a = 0; a < dim; a++)
            lanes_store(out[at + dim + r * dim + a] + s, (slope[a] + correction[a] * highest[a]) * inv_h);
    }
}

// A tile of particles at local coordinates xi, in the bin with coefficients cf (power of x slowest), to `s` of `out`.
BRUNT_INLINE void evaluate_tile(const real *cf, const lanes xi[3], real inv_h, real *const *out, int64_t s,
                                fields_kind kind) {
    const int dim = kind.dim;
    lanes correction[3];
    for (int a = 0; a < dim; a++) correction[a] = affine_correction(kind.order, xi[a]);
    for (int r = 0; r < dim; r++) {
        lanes slope[3], highest[3];
        lanes_store(out[r] + s, evaluate_component(cf, xi, r, slope, highest, kind));
        for (int a = 0; a < dim; a++) {
            lanes_store(out[dim + r * dim + a] + s, slope[a] * inv_h);
            if (kind.affine)
                lanes_store(out[dim + dim * dim + r * dim + a] + s,
                            (kind.order == 1 ? slope[a] : slope[a] + correction[a] * highest[a]) * inv_h);
        }
        if (kind.old && !kind.affine) lanes_store(out[old_place(dim, false) + r] + s, evaluate_old(cf, xi, r, kind));
    }
    if (kind.old && kind.affine) evaluate_old_affine(cf, xi, correction, inv_h, out, s, kind);
}

// Coefficients p, `step` nodes apart, of order + 1 nodal values along an axis, in powers of the local coordinate.
#define POLYNOMIAL(name, node)                                                                                         \
    BRUNT_INLINE void name(int order, const real *const v[4], real *p, int step) {                                     \
        const node a = *(const node *)v[0], b = *(const node *)v[1], c = *(const node *)v[order < 2 ? 1 : 2],          \
                   d = *(const node *)v[order < 3 ? 1 : 3];                                                            \
        node *to = (node *)p, mean = (real)0.5 * (a + c), bend = mean - b;                                             \
        if (order == 1) {                                                                                              \
            to[0] = a, to[step] = b - a;                                                                               \
        } else if (order == 2) {                                                                                       \
            to[2 * step] = bend;                                                                                       \
            to[step] = (real)0.5 * (c - a);                                                                            \
            to[0] = mean - (real)0.75 * bend;                                                                          \
        } else {                                                                                                       \
            to[0] = (a + (real)4 * b + c) * (real)(1.0 / 6);                                                           \
            to[step] = (c - a) * (real)0.5;                                                                            \
            to[2 * step] = (a - (real)2 * b + c) * (real)0.5;                                                          \
            to[3 * step] = (d - a + (real)3 * (b - c)) * (real)(1.0 / 6);                                              \
        }                                                                                                              \
    }
POLYNOMIAL(polynomial_of_four, node4)
POLYNOMIAL(polynomial_of_eight, node8)
#undef POLYNOMIAL

BRUNT_INLINE void polynomial(const real *const v[4], real *p, int step, fields_kind kind) {
    if (kind.old)
        polynomial_of_eight(kind.order, v, p, step);
    else
        polynomial_of_four(kind.order, v, p, step);
}

// Nodal values that are `stride` nodes apart.
BRUNT_INLINE void polynomial_along(const real *v, int stride, real *p, int step, fields_kind kind) {
    const int n = reals_of(kind);
    polynomial((const real *const[4]){v, v + stride * n, v + 2 * stride * n, v + 3 * stride * n}, p, step, kind);
}

// The plane of nodes that begins at `row`: for each bin of it, coefficients in the powers of y and z.
BRUNT_INLINE void plane_coefficients(const real *row, real *plane, fields_kind kind) {
    const int n = kind.order + 1, side = side_of(kind), span = side + kind.order, reals = reals_of(kind);
    if (kind.dim == 2) {
        for (int j = 0; j < side; j++) polynomial_along(row + j * reals, 1, plane + j * per_bin(kind) * reals, 1, kind);
        return;
    }
    for (int k = 0; k < side; k++) {
        real in_z[7 * 4 * 8] __attribute__((aligned(64)));
        for (int j = 0; j < span; j++) polynomial_along(row + (j * span + k) * reals, 1, in_z + j * n * reals, 1, kind);
        for (int j = 0; j < side; j++)
            for (int c = 0; c < n; c++)
                polynomial_along(in_z + (j * n + c) * reals, n, plane + ((j * side + k) * per_bin(kind) + c) * reals, n,
                                 kind);
    }
}

// The coefficients of bin t of a plane of bins in the powers of all axes, from those of the order + 1 planes of nodes
// that it touches.
BRUNT_INLINE void bin_coefficients(const real *const plane[4], int t, real *cf, fields_kind kind) {
    const int reals = reals_of(kind);
    for (int q = 0; q < per_bin(kind); q++) {
        const int at = (t * per_bin(kind) + q) * reals;
        polynomial((const real *const[4]){plane[0] + at, plane[1] + at, plane[2] + at, plane[3] + at}, cf + q * reals,
                   per_bin(kind), kind);
    }
}

// What the bins of a block have in common.
typedef struct fields_block {
    const brunt_block *block;
    real *const *x; // kernel places, from slot 0 on
    real *const *out;
    real origin[3], inv_h; // [m] of the block; [1/m] of the grid
} fields_block;

// The particles of a bin, range[0] .. range[1] - 1 of the block.
BRUNT_INLINE void evaluate_bin(const fields_block *of, const int32_t *range, const int bin[3], const real *cf,
                               fields_kind kind) {
    const real centre = kind.order == 1 ? 0 : 1; // xi is measured from the base node or, for the higher orders, the
                                                 // next one
    // Tiles start where the bin does; what a last tile writes past it, the next bin overwrites.
    for (int32_t s = range[0]; s < range[1]; s += BRUNT_LANES) {
        lanes xi[3];
        for (int a = 0; a < kind.dim; a++)
            xi[a] = (lanes_load(of->x[a] + of->block->first + s) - of->origin[a]) * of->inv_h - ((real)bin[a] + centre);
        evaluate_tile(cf, xi, of->inv_h, of->out, s, kind);
    }
}

BRUNT_INLINE void fields(brunt_body *body, const brunt_block *block, const int32_t *start, brunt_workspace *work,
                         fields_kind kind) {
    const int n = kind.order + 1, side = side_of(kind), span = side + kind.order, bins = bins_of_plane(kind);
    light_node light[MAX_WINDOW];
    int lights = load_window(body, block, work->window, light, reals_of(kind), kind.dim, kind.order);
    const brunt_grid *grid = &body->grid;
    fields_block of = {block, brunt_kernel_position(&body->particles), work->out, {0}, grid->inv_h};
    for (int a = 0; a < kind.dim; a++)
        of.origin[a] = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * side));
    for (int ix = 0; ix < span; ix++) { // order + 1 planes in turn
        const real *row = work->window + (size_t)(ix * (kind.dim == 3 ? span * span : span) * reals_of(kind));
        plane_coefficients(row, work->planes + (ix % n) * bins * per_bin(kind) * reals_of(kind), kind);
        int bx = ix - kind.order;
        if (bx < 0) continue;
        const real *plane[4] = {work->planes, work->planes, work->planes, work->planes};
        for (int i = 0; i < n; i++) plane[i] += (bx + i) % n * bins * per_bin(kind) * reals_of(kind);
        for (int t = 0; t < bins; t++) {
            const int32_t *range = start + bx * bins + t;
            if (range[0] == range[1]) continue;
            real cf[64 * 8] __attribute__((aligned(64)));
            bin_coefficients(plane, t, cf, kind);
            const int bin[3] = {bx, kind.dim == 3 ? t / side : t, kind.dim == 3 ? t % side : 0};
            evaluate_bin(&of, range, bin, cf, kind);
        }
    }
    if (lights) brunt_add_light_nodes(body, block, start, light, lights, work->out, kind.affine);
}
