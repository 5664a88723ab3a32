// Labels: double
// Newton's method on small sums of terms whose minimum is known: how fast, how it gets out of what is not positive
// definite, and what it says where there is no minimum.
#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "linear/newton.h"
#include "tests/support/suite.h"

static const brunt_team alone = {1, NULL};

// A term that is a function of each unknown by itself: value, slope and curvature of unknown i at x.
typedef struct lone {
    double (*value)(const struct lone *t, int64_t i, double x);
    double (*slope)(const struct lone *t, int64_t i, double x);
    double (*curvature)(const struct lone *t, int64_t i, double x);
    int64_t count;
    double a, b;
    double end;      // of the domain: x > end
    bool limits;     // tells the end by `limit`, else by an energy that is not finite
    int64_t outside; // how often it was asked there
} lone;

static brunt_energy_sum lone_energy(void *self, const brunt_team *team, const double *u) {
    (void)team;
    lone *t = self;
    brunt_energy_sum e = {0};
    for (int64_t i = 0; i < t->count; i++) {
        const double v = u[i] > t->end ? t->value(t, i, u[i]) : INFINITY;
        if (v == INFINITY) t->outside++;
        e.value += v, e.magnitude += fabs(v);
    }
    return e;
}

static void lone_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    (void)team;
    const lone *t = self;
    for (int64_t i = 0; i < t->count; i++) g[i] += t->slope(t, i, u[i]);
}

static void lone_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    (void)team;
    const lone *t = self;
    for (int64_t i = 0; i < t->count; i++) {
        const double k = t->curvature(t, i, u[i]);
        brunt_block_matrix_diagonal(h, (int32_t)(i / h->dim))[i % h->dim * (h->dim + 1)] += project && k < 0 ? 0 : k;
    }
}

static double lone_limit(void *self, const brunt_team *team, const double *u, const double *p, double largest) {
    (void)team;
    const lone *t = self;
    for (int64_t i = 0; t->limits && i < t->count; i++)
        if (u[i] + p[i] <= t->end) largest = fmin(largest, 0.9 * (t->end - u[i]) / p[i]);
    return largest;
}

static const brunt_term_ops lone_ops = {
    .name = "lone", .energy = lone_energy, .gradient = lone_gradient, .hessian = lone_hessian, .limit = lone_limit};

// a / 2 (x - b)^2
static double square(const lone *t, int64_t i, double x) { return (void)i, t->a / 2 * (x - t->b) * (x - t->b); }
static double square_1(const lone *t, int64_t i, double x) { return (void)i, t->a * (x - t->b); }
static double square_2(const lone *t, int64_t i, double x) { return (void)i, (void)x, t->a; }
// -a ln(x - end)
static double barrier(const lone *t, int64_t i, double x) { return (void)i, -t->a * log(x - t->end); }
static double barrier_1(const lone *t, int64_t i, double x) { return (void)i, -t->a / (x - t->end); }
static double barrier_2(const lone *t, int64_t i, double x) { return (void)i, t->a / (x - t->end) / (x - t->end); }
// Two wells: a / 4 (x^2 - 1)^2
static double wells(const lone *t, int64_t i, double x) { return (void)i, t->a / 4 * (x * x - 1) * (x * x - 1); }
static double wells_1(const lone *t, int64_t i, double x) { return (void)i, t->a * x * (x * x - 1); }
static double wells_2(const lone *t, int64_t i, double x) { return (void)i, t->a * (3 * x * x - 1); }
// a exp(-x): falls for ever
static double falling(const lone *t, int64_t i, double x) { return (void)i, t->a * exp(-x); }
static double falling_2(const lone *t, int64_t i, double x) { return (void)i, t->a * exp(-x); }
static double falling_1(const lone *t, int64_t i, double x) { return (void)i, -t->a * exp(-x); }

#define LONE(name, n, ...)                                                                                             \
    (lone) { .value = name, .slope = name##_1, .curvature = name##_2, .count = (n), .end = -INFINITY, __VA_ARGS__ }

// Springs between neighbours in a row of nodes: k / 2 |u_i - u_j|^2 + s / 4 |u_i - u_j|^4.
enum { CHAIN = 3000 };
typedef struct springs {
    double k, s;
    int dim, nodes;
    int64_t first[CHAIN];
    int32_t node[2 * CHAIN];
} springs;

static springs *new_springs(int dim, int nodes, double k, double s) {
    springs *t = malloc(sizeof *t);
    t->k = k, t->s = s, t->dim = dim, t->nodes = nodes;
    for (int i = 0; i < nodes; i++) t->first[i] = 2 * i, t->node[2 * i] = i, t->node[2 * i + 1] = i + 1;
    return t;
}

static double stretch(const springs *t, const double *u, int i) {
    double s = 0;
    for (int c = 0; c < t->dim; c++) s += pow(u[(i + 1) * t->dim + c] - u[i * t->dim + c], 2);
    return s;
}

static brunt_energy_sum springs_energy(void *self, const brunt_team *team, const double *u) {
    (void)team;
    const springs *t = self;
    double e = 0;
    for (int i = 0; i < t->nodes - 1; i++) {
        const double q = stretch(t, u, i);
        e += t->k / 2 * q + t->s / 4 * q * q;
    }
    return (brunt_energy_sum){.value = e, .magnitude = e};
}

static void springs_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    (void)team;
    const springs *t = self;
    for (int i = 0; i < t->nodes - 1; i++)
        for (int c = 0; c < t->dim; c++) {
            const int a = i * t->dim + c, b = a + t->dim;
            const double f = (t->k + t->s * stretch(t, u, i)) * (u[b] - u[a]);
            g[a] -= f, g[b] += f;
        }
}

static brunt_stencils springs_stencils(void *self) {
    const springs *t = self;
    return (brunt_stencils){.count = t->nodes - 1, .first = t->first, .node = t->node};
}

static void springs_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    (void)team, (void)project;
    const springs *t = self;
    const int d = t->dim;
    for (int i = 0; i < t->nodes - 1; i++) {
        double dense[36] = {0};
        const double q = stretch(t, u, i);
        for (int a = 0; a < 2 * d; a++)
            for (int b = 0; b < 2 * d; b++) {
                const double da = u[(i + 1) * d + a % d] - u[i * d + a % d],
                             db = u[(i + 1) * d + b % d] - u[i * d + b % d];
                const double v = (a % d == b % d ? t->k + t->s * q : 0) + 2 * t->s * da * db;
                dense[a * 2 * d + b] = a / d == b / d ? v : -v;
            }
        brunt_block_matrix_add(h, t->node + 2 * i, 2, dense);
    }
}

static const brunt_term_ops springs_ops = {.name = "springs",
                                           .energy = springs_energy,
                                           .gradient = springs_gradient,
                                           .stencils = springs_stencils,
                                           .hessian = springs_hessian};

// The same chain without its matrix: what is multiplied goes by the displacements that were linearised at.
static double linearised_at[3 * CHAIN];

static void springs_linearise(void *self, const brunt_team *team, const double *u, bool project,
                              brunt_block_matrix *blocks) {
    (void)team, (void)project;
    const springs *t = self;
    const int d = t->dim;
    memcpy(linearised_at, u, (size_t)(t->nodes * d) * sizeof *u);
    for (int i = 0; i < t->nodes - 1; i++)
        for (int c = 0; c < d * d; c++) {
            const double way[2] = {u[(i + 1) * d + c / d] - u[i * d + c / d],
                                   u[(i + 1) * d + c % d] - u[i * d + c % d]},
                         k = (c / d == c % d ? t->k + t->s * stretch(t, u, i) : 0) + 2 * t->s * way[0] * way[1];
            for (int end = 0; end < 2; end++) brunt_block_matrix_diagonal(blocks, i + end)[c] += k;
        }
}

static void springs_product(void *self, const brunt_team *team, const double *x, double *y) {
    (void)team;
    const springs *t = self;
    const int d = t->dim;
    const double *u = linearised_at;
    for (int i = 0; i < t->nodes - 1; i++) {
        double along = 0;
        for (int c = 0; c < d; c++) along += (u[(i + 1) * d + c] - u[i * d + c]) * (x[(i + 1) * d + c] - x[i * d + c]);
        for (int a = i * d; a < (i + 1) * d; a++) {
            const double f =
                (t->k + t->s * stretch(t, u, i)) * (x[a + d] - x[a]) + 2 * t->s * along * (u[a + d] - u[a]);
            y[a] -= f, y[a + d] += f;
        }
    }
}

static const brunt_term_ops free_springs_ops = {.name = "springs",
                                                .energy = springs_energy,
                                                .gradient = springs_gradient,
                                                .stencils = springs_stencils,
                                                .hessian = springs_hessian,
                                                .linearise = springs_linearise,
                                                .product = springs_product};

static brunt_newton_options usual(double tolerance) {
    brunt_newton_options options = brunt_newton_defaults();
    options.tolerance = tolerance;
    return options;
}

static int minimise(const brunt_problem *problem, const brunt_newton_options *options, double *u,
                    brunt_newton_report *report, brunt_error *error) {
    brunt_newton newton = {0};
    const int code = brunt_newton_minimise(&newton, &alone, problem, options, u, report, error);
    ck_assert_int_eq(code == BRUNT_OK, report->result == BRUNT_NEWTON_CONVERGED);
    brunt_newton_free(&newton);
    return code;
}

// Sizes of steps, one after the other.
typedef struct steps {
    double size[100];
    int count;
    int64_t unknowns;
} steps;

static double note_step(void *context, const brunt_team *team, const double *p, int64_t *where) {
    (void)team;
    steps *s = context;
    double most = 0;
    for (int64_t i = 0; i < s->unknowns; i++)
        if (fabs(p[i]) > most) most = fabs(p[i]), *where = i;
    s->size[s->count++] = most;
    return most;
}

// a / 2 (x - b)^2 - k ln x, of a chain whose springs stay as they are: x = b / 2 + sqrt(b^2 / 4 + k / a). A wall that
// tells its limit is never asked beyond it; one that does not is left by halving.
START_TEST(barrier_in_closed_form) {
    enum { NODES = 20, N = 2 * NODES };
    lone inertia = LONE(square, N, .a = 2, .b = -1), wall = LONE(barrier, N, .a = 1e-3, .limits = _i != 0);
    wall.end = 0;
    springs *chain = new_springs(2, NODES, 50, 10);
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&springs_ops, chain}, {&lone_ops, &wall}};
    const brunt_problem problem = {2, NODES, terms, 3, NULL, NULL, NULL, false};
    const double x = -0.5 + sqrt(0.25 + 5e-4);
    double u[N];
    for (int i = 0; i < N; i++) u[i] = 1;
    brunt_newton_report report;
    brunt_newton_options options = usual(1e-12);
    ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
    for (int i = 0; i < N; i++) ck_assert_double_eq_tol(u[i], x, 1e-14);
    ck_assert_int_eq(wall.outside > 0, _i == 0);
    if (_i == 0) ck_assert_int_gt(report.halvings, 0);
    ck_assert_double_lt(report.least_share, 1);
    ck_assert_int_eq(report.projections + report.shifts, 0);
    ck_assert_int_le(report.iterations, 25);
    ck_assert_int_eq(report.factorisations, report.iterations);
    ck_assert_int_eq(report.analyses, 1);
    free(chain);
}
END_TEST

// The last steps before rounding: each is the one before to the power of two.
START_TEST(quadratic) {
    enum { NODES = 12, N = 3 * NODES };
    lone inertia = LONE(square, N, .a = 1, .b = 0.3), wall = LONE(barrier, N, .a = 0.2, .limits = true);
    wall.end = -0.1;
    springs *chain = new_springs(3, NODES, 3, 40);
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&springs_ops, chain}, {&lone_ops, &wall}};
    const brunt_problem problem = {3, NODES, terms, 3, NULL, NULL, NULL, false};
    double u[N];
    for (int i = 0; i < N; i++) u[i] = 0.4 + 0.4 * sin(i * i);
    steps noted = {.unknowns = N};
    brunt_newton_options options = usual(1e-13);
    options.measure = note_step, options.context = &noted, options.early = false;
    brunt_newton_report report;
    ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
    int orders = 0;
    for (int i = 2; i < noted.count; i++)
        if (noted.size[i - 2] < 0.01 && noted.size[i] > 1e-14) {
            ck_assert_double_gt(log(noted.size[i] / noted.size[i - 1]) / log(noted.size[i - 1] / noted.size[i - 2]),
                                1.9);
            orders++;
        }
    ck_assert_int_ge(orders, 1);
    for (int i = 0; i < N; i++) ck_assert_double_gt(u[i], -0.1);
    free(chain);
}
END_TEST

// A step after which the next is known to be small is the last: one fewer, the same minimum to the tolerance. By pcg as
// well, whose steps are as inexact as they are asked to be.
START_TEST(an_early_end) {
    enum { NODES = 12, N = 3 * NODES };
    double u[3][N];
    brunt_newton_report report[3];
    springs *chain = new_springs(3, NODES, 3, 40);
    lone inertia = LONE(square, N, .a = 1, .b = 0.3), wall = LONE(barrier, N, .a = 0.2, .limits = true);
    wall.end = -0.1;
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&springs_ops, chain}, {&lone_ops, &wall}};
    const brunt_problem problem = {3, NODES, terms, 3, NULL, NULL, NULL, false};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < N; i++) u[k][i] = 0.4 + 0.4 * sin(i * i);
        brunt_newton_options options = usual(1e-6);
        options.early = k > 0, options.solver = k == 2 ? &brunt_linear_pcg : &brunt_linear_direct;
        options.preconditioner = BRUNT_BLOCK_JACOBI;
        ck_assert_int_eq(minimise(&problem, &options, u[k], report + k, NULL), BRUNT_OK);
        for (int i = 0; i < N; i++) ck_assert_double_eq_tol(u[k][i], u[0][i], 1e-7);
    }
    ck_assert_int_eq(report[1].iterations, report[0].iterations - 1);
    ck_assert_double_gt(report[1].step, 1e-6);
    ck_assert_int_gt(report[2].linear_iterations, report[2].iterations);
    free(chain);
}
END_TEST

// Newton's method goes on while forces do not balance, however small a correction is, and says so where they never do.
static double greatest_force(void *context, const brunt_team *team, const double *u) {
    (void)team;
    const double stiffness = *(const double *)context;
    return stiffness * fabs(log(u[0])) / 1e-6;
}

START_TEST(until_forces_balance) {
    double stiffness = 1e9, u[2] = {1.001, 1}, v[2] = {1.001, 1};
    brunt_newton_report report;
    brunt_error error = {0};
    lone stiff = LONE(square, 2, .a = stiffness, .b = 0), wall = LONE(barrier, 2, .a = stiffness, .limits = true);
    wall.end = 0; // a minimum at 1, where x - 1 / x is 0
    const brunt_term terms[] = {{&lone_ops, &stiff}, {&lone_ops, &wall}};
    const brunt_problem problem = {2, 1, terms, 2, NULL, NULL, NULL, false};
    brunt_newton_options options = usual(1e-2);
    ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
    ck_assert_int_eq(report.iterations, 1);
    ck_assert_double_gt(fabs(u[0] - 1), 1e-8);
    options.balance = greatest_force, options.context = &stiffness;
    ck_assert_int_eq(minimise(&problem, &options, v, &report, NULL), BRUNT_OK);
    ck_assert_double_le(report.balance, 1);
    ck_assert_double_le(fabs(v[0] - 1), 1e-15);
    stiffness = INFINITY, v[0] = 1.001, options.iterations = 7;
    ck_assert_int_eq(minimise(&problem, &options, v, &report, &error), BRUNT_FAILED);
    ck_assert_int_eq(report.result, BRUNT_NEWTON_ITERATIONS);
    ck_assert_int_eq(report.iterations, 7);
    ck_assert_ptr_nonnull(strstr(error.message, "forces do not balance"));
}
END_TEST

// Between two wells the matrix is not positive definite: projected there, and only there. x^2 = 1 - m / a of
// a / 4 (x^2 - 1)^2 + m / 2 x^2.
START_TEST(out_of_what_is_not_convex) {
    enum { N = 8 };
    lone mass = LONE(square, N, .a = 0.1), two = LONE(wells, N, .a = 1);
    const brunt_term terms[] = {{&lone_ops, &mass}, {&lone_ops, &two}};
    const brunt_problem problem = {2, N / 2, terms, 2, NULL, NULL, NULL, false};
    double u[N];
    for (int i = 0; i < N; i++) u[i] = i % 2 ? 0.05 : -0.3;
    brunt_newton_options options = usual(1e-12);
    options.solver = _i ? &brunt_linear_pcg : &brunt_linear_direct;
    options.accuracy = 1e-10;
    brunt_newton_report report;
    ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
    for (int i = 0; i < N; i++) ck_assert_double_eq_tol(u[i], i % 2 ? sqrt(0.9) : -sqrt(0.9), 1e-12);
    ck_assert_int_gt(report.projections, 0);
    ck_assert_int_lt(report.projections, report.iterations);
    ck_assert_int_gt(report.halvings, 0);
    ck_assert_int_eq(report.shifts, 0);
    ck_assert_double_eq_tol(report.energy.value, N * (0.25 * 0.01 + 0.05 * 0.9), 1e-14);
}
END_TEST

// A matrix that is singular though projected, of a chain that nothing holds, has its diagonal raised.
START_TEST(raised_where_singular) {
    springs *chain = new_springs(2, 2, 1, 0);
    const brunt_term terms[] = {{&springs_ops, chain}};
    const brunt_problem problem = {2, 2, terms, 1, NULL, NULL, NULL, false};
    double u[4] = {0, 0, 1, 0.5};
    brunt_newton_options options = usual(1e-9);
    brunt_newton_report report;
    ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
    ck_assert_int_gt(report.shifts, 0);
    ck_assert_double_eq_tol(u[0], u[2], 1e-9);
    ck_assert_double_eq_tol(u[1], u[3], 1e-9);
    free(chain);
}
END_TEST

// A system without its matrix is the one with it: unknowns that are held, a term that has no products, a raised
// diagonal.
START_TEST(the_system_without_its_matrix) {
    enum { NODES = 40, N = 3 * NODES };
    springs *chain = new_springs(3, NODES, 3, 40);
    lone inertia = LONE(square, N, .a = 0.7, .b = 0.3);
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&free_springs_ops, chain}};
    uint8_t held[N] = {0};
    double u[N], x[N], y[N], exact[N];
    for (int i = 0; i < N; i++) u[i] = sin(i * i), x[i] = cos(7 * i), held[i] = i % 5 == 2;
    brunt_block_matrix m = {0}, rest = {0};
    const brunt_stencils list = springs_stencils(chain);
    const brunt_pattern whole = {3, NODES, &list, 1, false, NULL}, alone_each = {3, NODES, NULL, 0, false, NULL};
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &alone, &whole, NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_block_matrix_pattern(&rest, &alone, &alone_each, NULL), BRUNT_OK);
    for (int k = 0; k < 2; k++) terms[k].ops->hessian(terms[k].self, &alone, u, false, &m);
    lone_hessian(&inertia, &alone, u, false, &rest);
    brunt_matrix_free f = {.rest = &rest, .terms = terms, .count = 2, .held = held};
    ck_assert_int_eq(brunt_matrix_free_take(&f, &alone, u, false, NULL), BRUNT_OK);
    for (int turn = 0; turn < 4; turn++) {
        if (turn == 1) brunt_block_matrix_hold(&m, &alone, held, 1), brunt_matrix_free_hold(&f, &alone);
        if (turn == 2) brunt_block_matrix_scale_diagonal(&m, 1.5), brunt_matrix_free_raise(&f, 0.5);
        if (turn == 3) brunt_block_matrix_scale_diagonal(&m, 4 / 1.5), brunt_matrix_free_raise(&f, 3);
        brunt_block_matrix_product(&m, &alone, x, exact);
        if (turn)
            brunt_matrix_free_product(&f, &alone, x, y);
        else
            brunt_matrix_free_hessian(&f, &alone, x, y);
        for (int i = 0; i < N; i++) ck_assert_double_eq_tol(y[i], exact[i], 1e-11);
        for (int i = 0; i < 9 * NODES; i++)
            ck_assert_double_eq_tol(f.blocks.value[i], m.value[m.diagonal[i / 9] * 9 + i % 9], 1e-11);
    }
    brunt_block_matrix_free(&m), brunt_block_matrix_free(&rest), brunt_matrix_free_free(&f), free(chain);
}
END_TEST

// A tensioned chain under a push, with its matrix and without: the same minimum; and it is said when the linear system
// is not solved, for there is nothing to fall back on.
START_TEST(matrix_free) {
    enum { NODES = 60, N = 2 * NODES };
    springs *chain = new_springs(2, NODES, 3, 40);
    lone inertia = LONE(square, N, .a = 0.01, .b = 0.3);
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&free_springs_ops, chain}};
    uint8_t held[N] = {1, 1};
    const brunt_problem problem = {2, NODES, terms, 2, held, NULL, NULL, false};
    double u[2][N];
    brunt_newton_report report;
    brunt_error error = {0};
    brunt_newton_options options = usual(1e-11);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < N; i++) u[k][i] = i < 2 ? 2 : sin(i);
        options.solver = k ? &brunt_linear_pcg : &brunt_linear_direct, options.matrix_free = k == 1;
        ck_assert_int_eq(minimise(&problem, &options, u[k], &report, &error), BRUNT_OK);
    }
    ck_assert_int_gt(report.linear_iterations, NODES);
    for (int i = 0; i < N; i++) ck_assert_double_eq_tol(u[0][i], u[1][i], 1e-9);
    options.linear_iterations = 2;
    u[1][10] += 1;
    ck_assert_int_eq(minimise(&problem, &options, u[1], &report, &error), BRUNT_FAILED);
    ck_assert_int_eq(report.result, BRUNT_NEWTON_BROKEN);
    ck_assert_ptr_nonnull(strstr(error.message, "2 iterations brought the residual"));
    free(chain);
}
END_TEST

static int told_not_to(void *self, const brunt_team *team, const double *u, const double *p, brunt_error *error) {
    (void)self, (void)team, (void)u;
    return p ? brunt_fail(error, BRUNT_FAILED, "No place for candidates.") : BRUNT_OK;
}
static double no_step(void *self, const brunt_team *team, const double *u, const double *p, double largest) {
    (void)self, (void)team, (void)u, (void)p, (void)largest;
    return 0;
}
static double hill_1(const lone *t, int64_t i, double x) { return -square_1(t, i, x); }

// Each ends with what is the matter, and none as if it were a minimum.
START_TEST(what_has_no_minimum_is_said) {
    enum { N = 4 };
    static const brunt_term_ops blocking = {.name = "blocking",
                                            .energy = lone_energy,
                                            .gradient = lone_gradient,
                                            .hessian = lone_hessian,
                                            .limit = no_step};
    static const brunt_term_ops looking = {.name = "looking",
                                           .look = told_not_to,
                                           .energy = lone_energy,
                                           .gradient = lone_gradient,
                                           .hessian = lone_hessian};
    lone concave = LONE(square, N, .a = -1), endless = LONE(falling, N, .a = 1), convex = LONE(square, N, .a = 1),
         wall = LONE(barrier, N, .a = 1);
    wall.end = 2;
    lone liar = convex;
    liar.slope = hill_1;
    lone broken = convex;
    broken.b = NAN, broken.value = falling;
    const struct {
        brunt_term term;
        brunt_newton_result result;
        const char *words;
    } cases[] = {
        {{&lone_ops, &concave}, BRUNT_NEWTON_INDEFINITE, "not positive definite"},
        {{&lone_ops, &endless},
         BRUNT_NEWTON_ITERATIONS,
         "did not converge: after 30 iterations a step is 1 m/s, and 1e-09 m/s"},
        {{&blocking, &convex}, BRUNT_NEWTON_BLOCKED, "blocking lets no step be taken in iteration 1"},
        {{&looking, &convex}, BRUNT_NEWTON_BROKEN, "No place for candidates."},
        {{&lone_ops, &wall}, BRUNT_NEWTON_BAD_START, "the energy of lone is not finite where it begins"},
        {{&lone_ops, &liar}, BRUNT_NEWTON_UPHILL, "no part of the step of iteration 1"},
        {{&lone_ops, &broken}, BRUNT_NEWTON_BROKEN, "component 0 of the gradient at node 0 is nan"},
    };
    const brunt_problem problem = {2, N / 2, &cases[_i].term, 1, NULL, NULL, NULL, false};
    double u[N] = {1, 1, 1, 1};
    brunt_newton_options options = usual(1e-9);
    options.iterations = 30;
    brunt_newton_report report;
    brunt_error error = {0};
    ck_assert_int_eq(minimise(&problem, &options, u, &report, &error), BRUNT_FAILED);
    ck_assert_int_eq(report.result, cases[_i].result);
    ck_assert_msg(strstr(error.message, cases[_i].words) != NULL, "%s", error.message);
}
END_TEST

START_TEST(held_unknowns_stay) {
    enum { NODES = 5, N = 2 * NODES };
    springs *chain = new_springs(2, NODES, 4, 0);
    const brunt_term terms[] = {{&free_springs_ops, chain}};
    uint8_t held[N] = {1, 1, 0, 0, 0, 0, 0, 0, 1, 1};
    const brunt_problem problem = {2, NODES, terms, 1, held, NULL, NULL, false};
    for (int k = 0; k < 3; k++) {
        double u[N] = {0.25, -1, 7, 7, 7, 7, 7, 7, 1.25, 3};
        brunt_newton_options options = usual(1e-12);
        options.solver = k ? &brunt_linear_pcg : &brunt_linear_direct, options.matrix_free = k == 2;
        brunt_newton_report report;
        ck_assert_int_eq(minimise(&problem, &options, u, &report, NULL), BRUNT_OK);
        for (int i = 0; i < NODES; i++) {
            ck_assert_double_eq_tol(u[2 * i], 0.25 + 0.25 * i, 1e-12);
            ck_assert_double_eq_tol(u[2 * i + 1], -1 + i, 1e-12);
        }
        ck_assert_double_eq(u[0], 0.25);
        ck_assert_double_eq(u[9], 3);
    }
    free(chain);
}
END_TEST

static void note_phase(void *context, brunt_newton_phase phase) {
    char *seen = context;
    seen[strlen(seen)] = "emfswla"[phase];
}

// Where pcg may stop at one iteration the direct solver goes on, if it may; phases follow each other.
START_TEST(fallback_and_phases) {
    enum { NODES = 300, N = 2 * NODES };
    springs *chain = new_springs(2, NODES, 100, 0);
    lone inertia = LONE(square, N, .a = 1e-3, .b = 0.3);
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&springs_ops, chain}};
    const brunt_problem problem = {2, NODES, terms, 2, NULL, NULL, NULL, false};
    brunt_newton_options options = usual(1e-9);
    options.solver = &brunt_linear_pcg, options.preconditioner = BRUNT_BLOCK_JACOBI, options.linear_iterations = 1;
    options.phase = note_phase;
    for (int k = 0; k < 2; k++) {
        double u[N];
        char seen[1000] = {0};
        for (int i = 0; i < N; i++) u[i] = sin(i);
        options.fallback = k == 1, options.context = seen;
        brunt_newton_report report;
        brunt_error error = {0};
        ck_assert_int_eq(minimise(&problem, &options, u, &report, &error), k ? BRUNT_OK : BRUNT_FAILED);
        if (k == 0) ck_assert_int_eq(report.result, BRUNT_NEWTON_BROKEN);
        if (k == 0) ck_assert_ptr_nonnull(strstr(error.message, "1 iterations brought the residual"));
        ck_assert_str_eq(seen, k ? "eemfsfslaemfsla" : "eemfs");
        for (int i = 0; k && i < N; i++) ck_assert_double_eq_tol(u[i], 0.3, 1e-9);
    }
    free(chain);
}
END_TEST

START_TEST(any_number_of_threads) {
    enum { N = 3 * CHAIN };
    springs *chain = new_springs(3, CHAIN, 3, 40);
    lone inertia = LONE(square, N, .a = 1, .b = 0.3), wall = LONE(barrier, N, .a = 0.01, .limits = true);
    wall.end = -0.1;
    const brunt_term terms[] = {{&lone_ops, &inertia}, {&springs_ops, chain}, {&lone_ops, &wall}};
    const brunt_problem problem = {3, CHAIN, terms, 3, NULL, NULL, NULL, false};
    for (int k = 0; k < 2; k++) {
        double *u = malloc(sizeof *u * N), *one = malloc(sizeof *one * N);
        brunt_newton_options options = usual(1e-9);
        options.solver = k ? &brunt_linear_pcg : &brunt_linear_direct;
        brunt_newton newton = {0};
        for (int threads = 1; threads <= 3; threads++) {
            const brunt_team team = {threads, NULL};
            brunt_newton_report report;
            for (int i = 0; i < N; i++) u[i] = 0.4 + 0.4 * sin(i * i);
            ck_assert_int_eq(brunt_newton_minimise(&newton, &team, &problem, &options, u, &report, NULL), BRUNT_OK);
            ck_assert_int_eq(report.analyses, k == 0 && threads > 1 ? 0 : threads == 1); // the pattern is known by then
            if (threads == 1) memcpy(one, u, sizeof *u * N);
            ck_assert_int_eq(memcmp(one, u, sizeof *u * N), 0);
        }
        brunt_newton_free(&newton), free(u), free(one);
    }
    ck_assert_uint_eq(brunt_memory_live(), 0);
    free(chain);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("newton");
    TCase *c = tcase_create("newton");
    tcase_add_loop_test(c, barrier_in_closed_form, 0, 2);
    tcase_add_test(c, quadratic);
    tcase_add_test(c, an_early_end);
    tcase_add_test(c, until_forces_balance);
    tcase_add_loop_test(c, out_of_what_is_not_convex, 0, 2);
    tcase_add_test(c, raised_where_singular);
    tcase_add_test(c, the_system_without_its_matrix);
    tcase_add_test(c, matrix_free);
    tcase_add_loop_test(c, what_has_no_minimum_is_said, 0, 7);
    tcase_add_test(c, held_unknowns_stay);
    tcase_add_test(c, fallback_and_phases);
    tcase_add_test(c, any_number_of_threads);
    suite_add_tcase(suite, c);
    return suite_main(suite);
}
