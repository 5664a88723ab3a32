// Which solver of implicit steps is cheapest where: matrices of splines and simplices in two and three dimensions, by
// size and length of step; CPU seconds of each part on one thread, as CSV.
//
//   bench_solvers              the rows that take seconds
//   bench_solvers long         larger ones too: minutes and gigabytes
#include <stdio.h>
#include <time.h>

#include "linear/linear.h"
#include "tests/support/elastic_matrix.h"

enum { REPEATS = 3 };
#define WORTH_REPEATING 0.3 // [s]

static const brunt_team team = {1, NULL};

typedef struct row {
    const char *model, *solver;
    int32_t nodes;
    double blocks, courant, accuracy;
    double pattern, colours, assemble, analyse, factor, solve; // [s]
    double residual, error;                                    // over b; over x in the norm of the matrix
    double *exact;                                             // x of the direct solver
    brunt_linear_report report;
    brunt_linear_status status;
} row;

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double least(double a, double b) { return a > 0 && a < b ? a : b; }

static void print(const row *r) {
    printf("%s,%d,%.1f,%g,%s,%g,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%d,%g,%.0f,%.2e,%.2e,%.2e,%s\n", r->model, r->nodes,
           r->blocks, r->courant, r->solver, r->accuracy, r->pattern, r->colours, r->assemble, r->analyse, r->factor,
           r->solve, r->report.iterations, r->report.shift, 1e-6 * (double)r->report.memory, r->report.flops,
           r->residual, r->error,
           r->status == BRUNT_LINEAR_DONE      ? "done"
           : r->status == BRUNT_LINEAR_STALLED ? "stalled"
                                               : "failed");
    fflush(stdout);
}

// The matrix, and how long it took.
static brunt_block_matrix assemble(const elastic *e, row *r) {
    brunt_block_matrix m = {0};
    brunt_colours colours = {0};
    const brunt_pattern pattern = elastic_pattern(e);
    for (int k = 0; k < REPEATS; k++) {
        double t = seconds();
        if (brunt_block_matrix_pattern(&m, &team, &pattern, NULL)) exit(1);
        r->pattern = least(r->pattern, seconds() - t), t = seconds();
        if (brunt_colours_make(&colours, &team, e->dim, e->nodes, &e->stencils, NULL)) exit(1);
        r->colours = least(r->colours, seconds() - t), t = seconds();
        brunt_assemble(&m, &team, &e->stencils, &colours, elastic_fill, (void *)e);
        r->assemble = least(r->assemble, seconds() - t);
        if (r->assemble > WORTH_REPEATING) break;
    }
    brunt_colours_free(&colours);
    elastic_inertia(e, &team, r->courant, &m);
    return m;
}

static double residual(const brunt_block_matrix *m, const double *b, const double *x, double *y) {
    double far = 0, size = 0;
    brunt_block_matrix_product(m, &team, x, y);
    for (int64_t i = 0; i < (int64_t)m->nodes * m->dim; i++) far += (y[i] - b[i]) * (y[i] - b[i]), size += b[i] * b[i];
    return sqrt(far / size);
}

// |x - exact| / |exact|, in the norm of the matrix; uses x and y.
static double error_of(const brunt_block_matrix *m, const double *exact, double *x, double *y) {
    double far = 0, size = 0;
    const int64_t n = (int64_t)m->nodes * m->dim;
    brunt_block_matrix_product(m, &team, exact, y);
    for (int64_t i = 0; i < n; i++) size += y[i] * exact[i], x[i] -= exact[i];
    brunt_block_matrix_product(m, &team, x, y);
    for (int64_t i = 0; i < n; i++) far += y[i] * x[i];
    return sqrt(far / size);
}

// What a step begins with: a push on all of the mass, and one on each of a hundredth of the nodes as by contact.
static double *load(const elastic *e) {
    double *b = calloc((size_t)(e->nodes * e->dim), sizeof *b);
    for (int32_t n = 0; n < e->nodes; n++)
        for (int c = 0; c < e->dim; c++)
            b[n * e->dim + c] = e->mass[n] * ((c ? 0.3 : 1) + (n % 100 == 7 ? 20 * sin(n + c) : 0));
    return b;
}

static void solve(row r, const elastic *e, const brunt_block_matrix *m, const brunt_linear_ops *ops,
                  brunt_preconditioner preconditioner) {
    const int64_t n = (int64_t)m->nodes * m->dim;
    const brunt_linear_options options = {.accuracy = r.accuracy, .iterations = 5000, .preconditioner = preconditioner};
    double *b = load(e), *x = malloc((size_t)n * sizeof *x), *y = malloc((size_t)n * sizeof *y);
    brunt_linear s = {0};
    if (brunt_linear_open(&s, ops, &options, NULL)) exit(1);
    for (int k = 0; k < REPEATS; k++) {
        double t = seconds();
        r.status = brunt_linear_analyse(&s, &team, m, NULL);
        r.analyse = least(r.analyse, seconds() - t), t = seconds();
        if (r.status == BRUNT_LINEAR_DONE) r.status = brunt_linear_factor(&s, &team, m, NULL);
        r.factor = least(r.factor, seconds() - t), t = seconds();
        if (r.status == BRUNT_LINEAR_DONE) r.status = brunt_linear_solve(&s, &team, b, x, NULL);
        r.solve = least(r.solve, seconds() - t);
        if (r.status != BRUNT_LINEAR_DONE || r.factor + r.solve > WORTH_REPEATING) break;
    }
    r.residual = r.status == BRUNT_LINEAR_DONE ? residual(m, b, x, y) : 0;
    r.report = s.report;
    if (r.status == BRUNT_LINEAR_DONE && r.exact && ops == &brunt_linear_direct)
        memcpy(r.exact, x, (size_t)n * sizeof *x);
    if (r.status == BRUNT_LINEAR_DONE && r.exact) r.error = error_of(m, r.exact, x, y);
    print(&r);
    brunt_linear_close(&s);
    free(b), free(x), free(y);
}

static void study(const char *model, elastic e, const double *courants, int count, bool direct) {
    for (int k = 0; k < count; k++) {
        row r = {.model = model, .nodes = e.nodes, .courant = courants[k]};
        brunt_block_matrix m = assemble(&e, &r);
        r.blocks = (double)brunt_block_matrix_blocks(&m) / e.nodes;
        r.solver = "direct";
        r.exact = direct ? malloc((size_t)(e.nodes * e.dim) * sizeof(double)) : NULL;
        if (direct) solve(r, &e, &m, &brunt_linear_direct, 0);
        for (int a = 0; a < 2; a++) {
            r.accuracy = a ? 1e-8 : 1e-3;
            r.solver = "pcg-incomplete", solve(r, &e, &m, &brunt_linear_pcg, BRUNT_INCOMPLETE_CHOLESKY);
            r.solver = "pcg-jacobi", solve(r, &e, &m, &brunt_linear_pcg, BRUNT_BLOCK_JACOBI);
        }
        brunt_block_matrix_free(&m);
        free(r.exact);
    }
    elastic_free(&e);
}

int main(int argc, char **argv) {
    const bool all = argc > 1 && !strcmp(argv[1], "long");
    const double steps[] = {10, 100, INFINITY};
    printf("# %s\n", BRUNT_BENCH_FLAGS);
    printf("model,nodes,blocks,courant,solver,accuracy,pattern_s,colours_s,assemble_s,analyse_s,factor_s,solve_s,"
           "iterations,shift,memory_MB,flops,residual,error,status\n");
    const int disks[] = {30, 110, 250, 500}, balls[] = {8, 12, 20, 28, 42}, boxes[] = {8, 12, 16, 20, 27},
              sheets[] = {30, 100, 220, 450};
    for (int i = 0; i < (all ? 4 : 2); i++) study("spline-2d", elastic_splines(2, disks[i]), steps, 2, true);
    for (int i = 0; i < (all ? 4 : 2); i++) study("tri", elastic_simplices(2, sheets[i]), steps, 3, true);
    for (int i = 0; i < (all ? 5 : 2); i++) study("spline-3d", elastic_splines(3, balls[i]), steps, 2, i < 4);
    for (int i = 0; i < (all ? 5 : 3); i++) study("tet", elastic_simplices(3, boxes[i]), steps, 3, true);
    return 0;
}
