// Derivatives of a whole term against differences, of a small contact problem.
#pragma once

#include "linear/block_matrix.h"
#include "tests/support/barrier_case.h"

// The Hessian of a term at u, as a whole matrix.
static inline double *take_dense(const barrier_case *c, brunt_term term, const double *u) {
    const int n = c->nodes * c->dim;
    const brunt_team team = {c->threads, NULL};
    const brunt_stencils stencils = term.ops->stencils(term.self);
    const brunt_pattern pattern = {c->dim, c->nodes, &stencils, 1, false, NULL};
    brunt_block_matrix m = {0};
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
    term.ops->hessian(term.self, &team, u, false, &m);
    double *dense = calloc((size_t)n * (size_t)n, sizeof *dense);
    for (int32_t r = 0; r < c->nodes; r++)
        for (int64_t k = m.first[r]; k < m.first[r + 1]; k++)
            for (int i = 0; i < c->dim; i++)
                for (int j = 0; j < c->dim; j++)
                    dense[(r * c->dim + i) * n + m.column[k] * c->dim + j] =
                        m.value[k * c->dim * c->dim + i * c->dim + j];
    brunt_block_matrix_free(&m);
    return dense;
}

// Of all unknowns: gradient of the energy, where it has one, Hessian of the gradient, by central differences, of their
// own size. How far the Hessian is from symmetric, of its size.
static inline double check_term(barrier_case *c, brunt_term term, double *u, double h, bool energy) {
    const int n = c->nodes * c->dim;
    const brunt_team team = {c->threads, NULL};
    double *g = case_unknowns(c), *up = case_unknowns(c), *down = case_unknowns(c), slope_size = 0, force_size = 0;
    case_look(c, u, NULL);
    // Friction's force is an unknown of its own on the way: where nothing moves any more, it is that of the slip.
    for (int k = 0; k < 2; k++) ck_assert_int_eq(term.ops->look(term.self, &team, u, NULL, NULL), BRUNT_OK);
    case_gradient(c, term, u, g);
    double *dense = take_dense(c, term, u);
    for (int i = 0; i < n; i++) force_size = fmax(force_size, fabs(g[i]));
    for (int i = 0; i < n * n; i++) slope_size = fmax(slope_size, fabs(dense[i]));
    ck_assert_msg(force_size > 0, "nothing touches");
    double worst = 0, worst_slope = 0, lean = 0;
    for (int i = 0; i < n; i++) {
        const double was = u[i];
        u[i] = was + h;
        const double more = energy ? case_energy(c, term, u) : 0;
        case_gradient(c, term, u, up);
        u[i] = was - h;
        const double less = energy ? case_energy(c, term, u) : 0;
        case_gradient(c, term, u, down);
        u[i] = was;
        if (energy) worst = fmax(worst, fabs((more - less) / (2 * h) - g[i]) / force_size);
        for (int j = 0; j < n; j++) {
            worst_slope = fmax(worst_slope, fabs((up[j] - down[j]) / (2 * h) - dense[j * n + i]) / slope_size);
            lean = fmax(lean, fabs(dense[j * n + i] - dense[i * n + j]) / slope_size);
        }
    }
    ck_assert_msg(worst < 1e-7 && worst_slope < 1e-7, "gradient off by %g, Hessian by %g", worst, worst_slope);
    free(dense), free(g), free(up), free(down);
    return lean;
}
