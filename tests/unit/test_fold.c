// Labels: double
// Nodes that follow others: the matrix of what is left is that of differences of its gradient, with and without its
// entries; Newton's method goes to the same minimum as without them.
#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "linear/newton.h"
#include "tests/support/suite.h"

enum { DIM = 2, NODES = 7, ALL = DIM * NODES, SETS = 5 };

// k / 4 |q . u + s|^4 + c / 2 |q . u|^2 of sets of three nodes: u of a set is a bend, with a shift for each component.
static const int64_t first[SETS + 1] = {0, 3, 6, 9, 12, 15};
static const int32_t node[3 * SETS] = {0, 1, 4, 1, 4, 5, 2, 5, 6, 3, 0, 6, 2, 3, 4};
static const double weight[3] = {1, -2.3, 0.7}, shift[DIM] = {0.4, -0.3};

static double bend(const double *u, int s, int a) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += weight[k] * u[node[3 * s + k] * DIM + a];
    return sum;
}

// Slope and curvature by the bends of a set.
static void slopes(const double *u, int s, double slope[DIM], double curvature[DIM][DIM]) {
    double b[DIM], square = 0;
    for (int a = 0; a < DIM; a++) b[a] = bend(u, s, a) + shift[a], square += b[a] * b[a];
    for (int a = 0; a < DIM; a++) {
        slope[a] = square * b[a] + 0.5 * (b[a] - shift[a]);
        for (int c = 0; c < DIM; c++) curvature[a][c] = 2 * b[a] * b[c] + (a == c ? square + 0.5 : 0);
    }
}

static brunt_energy_sum energy(void *self, const brunt_team *team, const double *u) {
    (void)self, (void)team;
    brunt_energy_sum e = {0};
    for (int s = 0; s < SETS; s++) {
        double square = 0;
        for (int a = 0; a < DIM; a++) {
            const double b = bend(u, s, a);
            square += (b + shift[a]) * (b + shift[a]), e.value += 0.25 * b * b;
        }
        e.value += 0.25 * square * square;
    }
    for (int k = 0; k < ALL; k++) e.value += 0.05 * u[k] * u[k];
    e.magnitude = e.value;
    return e;
}

static void gradient(void *self, const brunt_team *team, const double *u, double *g) {
    (void)self, (void)team;
    for (int s = 0; s < SETS; s++) {
        double slope[DIM], curvature[DIM][DIM];
        slopes(u, s, slope, curvature);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < DIM; a++) g[node[3 * s + k] * DIM + a] += weight[k] * slope[a];
    }
    for (int k = 0; k < ALL; k++) g[k] += 0.1 * u[k];
}

static brunt_stencils stencils(void *self) {
    (void)self;
    return (brunt_stencils){.count = SETS, .first = first, .node = node, .version = 1};
}

static void hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    (void)self, (void)team, (void)project;
    for (int s = 0; s < SETS; s++) {
        double slope[DIM], curvature[DIM][DIM], dense[9 * DIM * DIM];
        slopes(u, s, slope, curvature);
        for (int k = 0; k < 3 * DIM; k++)
            for (int q = 0; q < 3 * DIM; q++)
                dense[k * 3 * DIM + q] = weight[k / DIM] * weight[q / DIM] * curvature[k % DIM][q % DIM];
        brunt_block_matrix_add(h, node + 3 * s, 3, dense);
    }
    for (int k = 0; k < ALL; k++) brunt_block_matrix_diagonal(h, k / DIM)[k % DIM * (DIM + 1)] += 0.1;
}

static double at[ALL]; // of the last linearise

static void linearise(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *blocks) {
    (void)self, (void)team, (void)project;
    memcpy(at, u, sizeof at);
    for (int s = 0; s < SETS; s++) {
        double slope[DIM], curvature[DIM][DIM];
        slopes(u, s, slope, curvature);
        for (int k = 0; k < 3; k++)
            for (int e = 0; e < DIM * DIM; e++)
                brunt_block_matrix_diagonal(blocks, node[3 * s + k])[e] +=
                    weight[k] * weight[k] * curvature[e / DIM][e % DIM];
    }
    for (int k = 0; k < ALL; k++) brunt_block_matrix_diagonal(blocks, k / DIM)[k % DIM * (DIM + 1)] += 0.1;
}

static void product(void *self, const brunt_team *team, const double *x, double *y) {
    (void)self, (void)team;
    for (int s = 0; s < SETS; s++) {
        double slope[DIM], curvature[DIM][DIM];
        slopes(at, s, slope, curvature);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < DIM; a++)
                for (int c = 0; c < DIM; c++)
                    y[node[3 * s + k] * DIM + a] += weight[k] * curvature[a][c] * bend(x, s, c);
    }
    for (int k = 0; k < ALL; k++) y[k] += 0.1 * x[k];
}

static const brunt_term_ops with_matrix = {
    .name = "bends", .energy = energy, .gradient = gradient, .stencils = stencils, .hessian = hessian};
static const brunt_term_ops with_products = {.name = "bends",
                                             .energy = energy,
                                             .gradient = gradient,
                                             .stencils = stencils,
                                             .hessian = hessian,
                                             .linearise = linearise,
                                             .product = product};

// 4 and 5 are images of 1 and 0, 6 of 0 too, with nothing of it along the first axis; 5 shares a set with its leader's.
static const int32_t followers[] = {4, 5, 6}, leader[NODES] = {0, 1, 2, 3, 1, 0, 0};
static const double sign[ALL] = {1, 1, 1, 1, 1, 1, 1, 1, -1, 1, -1, -1, 0, 1};
static const brunt_fold fold = {3, followers, leader, sign};

static void folded_gradient(const double *u, double *g) {
    memset(g, 0, ALL * sizeof *g);
    gradient(NULL, NULL, u, g);
    brunt_fold_gather(&fold, DIM, g);
}

static void some_place(double *u) {
    for (int k = 0; k < ALL; k++) u[k] = 0.3 * sin(3 * k + 1);
    brunt_fold_spread(&fold, DIM, u);
}

START_TEST(matrix_is_of_differences) {
    const brunt_team team = {.threads = 1 + _i};
    const brunt_stencils list = stencils(NULL);
    const brunt_pattern pattern = {.dim = DIM, .nodes = NODES, .stencils = &list, .lists = 1, .fold = &fold};
    brunt_block_matrix m = {0};
    brunt_matrix_free f = {.rest = NULL};
    double u[ALL], x[ALL], y[ALL], z[ALL], before[ALL], after[ALL], worst = 0, most = 0;
    some_place(u);
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
    for (int k = 0; k < ALL; k++) { // column k
        const double step = 1e-5;
        for (int side = -1; side <= 1; side += 2) {
            memcpy(x, u, sizeof x);
            x[k] += side * step;
            brunt_fold_spread(&fold, DIM, x);
            folded_gradient(x, side < 0 ? before : after);
        }
        memset(x, 0, sizeof x), x[k] = 1;
        brunt_block_matrix_zero(&m, &team);
        hessian(NULL, &team, u, false, &m);
        brunt_fold_matrix(&fold, &team, &m);
        brunt_block_matrix_product(&m, &team, x, y);
        const brunt_term term = {&with_products, NULL};
        brunt_block_matrix none = {0};
        const brunt_pattern alone = {.dim = DIM, .nodes = NODES};
        ck_assert_int_eq(brunt_block_matrix_pattern(&none, &team, &alone, NULL), BRUNT_OK);
        f.rest = &none, f.terms = &term, f.count = 1, f.fold = &fold;
        ck_assert_int_eq(brunt_matrix_free_take(&f, &team, u, false, NULL), BRUNT_OK);
        if (leader[k / DIM] == k / DIM) brunt_matrix_free_product(&f, &team, x, z);
        brunt_block_matrix_free(&none);
        for (int q = 0; q < ALL; q++) {
            const double slope = (after[q] - before[q]) / (2 * step);
            most = fmax(most, fabs(slope));
            worst = fmax(worst, fabs(y[q] - slope));
            if (leader[k / DIM] == k / DIM) worst = fmax(worst, fabs(z[q] - slope));
        }
    }
    printf("  off by %.1e of %.3g\n", worst, most);
    ck_assert_double_gt(most, 1);
    ck_assert_double_le(worst, 1e-8 * most);
    brunt_block_matrix_free(&m);
    brunt_matrix_free_free(&f);
}
END_TEST

START_TEST(minimum) {
    const brunt_team team = {.threads = 1};
    const brunt_term term = {_i ? &with_products : &with_matrix, NULL};
    brunt_newton_options options = brunt_newton_defaults();
    options.tolerance = 1e-12, options.accuracy = 1e-13;
    if (_i) options.solver = &brunt_linear_pcg, options.matrix_free = true;
    if (_i) options.preconditioner = BRUNT_BLOCK_JACOBI;
    uint8_t held[ALL] = {0};
    held[0] = 1; // and all that follows it
    held[5 * DIM] = held[6 * DIM] = 1;
    const brunt_problem problem = {.dim = DIM, .nodes = NODES, .terms = &term, .count = 1, .held = held, .fold = &fold};
    brunt_newton newton = {0};
    brunt_newton_report report;
    double u[ALL], start[ALL], g[ALL];
    some_place(u);
    memcpy(start, u, sizeof u);
    ck_assert_int_eq(brunt_newton_minimise(&newton, &team, &problem, &options, u, &report, NULL), BRUNT_OK);
    folded_gradient(u, g);
    double left = 0, moved = 0;
    for (int k = 0; k < ALL; k++) {
        ck_assert_double_eq(u[k], sign[k] * u[leader[k / DIM] * DIM + k % DIM]);
        if (held[k])
            ck_assert_double_eq(u[k], start[k]);
        else
            left = fmax(left, fabs(g[k]));
        moved = fmax(moved, fabs(u[k] - start[k]));
    }
    printf("  %d iterations, moved %.3g, left %.1e\n", report.iterations, moved, left);
    ck_assert_int_le(report.iterations, 12);
    ck_assert_double_gt(moved, 0.1);
    ck_assert_double_le(left, 1e-11);
    brunt_newton_free(&newton);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("fold");
    TCase *tests = tcase_create("fold");
    tcase_add_loop_test(tests, matrix_is_of_differences, 0, 2);
    tcase_add_loop_test(tests, minimum, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
