// Nodes that couple with no other, of which factorisations see nothing: solved by their own blocks, with pivots that
// count like all others.
#include "tests/support/suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "linear/block_matrix.h"
#include "linear/linear.h"

enum { NODES = 6, MOST = 3 * NODES };

static const brunt_team team = {1, NULL};
static const brunt_linear_options exact = {.accuracy = 1e-12, .iterations = 5000};

#define ADD(test)                                                                                                      \
    do {                                                                                                               \
        TCase *one = tcase_create(#test);                                                                              \
        tcase_add_test(one, test);                                                                                     \
        suite_add_tcase(suite, one);                                                                                   \
    } while (0)

// 0 - 2, 2 - 3 couple unless `all_alone`; 1, 4 and 5 do not. Blocks of nodes are full.
static brunt_block_matrix some_alone(int dim, bool all_alone) {
    static const int64_t pairs[] = {0, 2, 4, 5, 6, 7}, single[] = {0, 1, 2, 3, 4, 5, 6};
    static const int32_t of_pairs[] = {0, 2, 2, 3, 1, 4, 5}, of_single[] = {0, 1, 2, 3, 4, 5};
    const brunt_stencils list =
        all_alone ? (brunt_stencils){6, single, of_single, 0} : (brunt_stencils){5, pairs, of_pairs, 0};
    const brunt_pattern pattern = {dim, NODES, &list, 1, false, NULL};
    brunt_block_matrix m = {0};
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
    for (int64_t s = 0; s < list.count; s++) {
        const int count = (int)(list.first[s + 1] - list.first[s]), size = count * dim;
        double dense[36];
        for (int i = 0; i < size; i++)
            for (int j = 0; j < size; j++)
                dense[i * size + j] = i == j ? 3 + (double)s : 0.4 / (1 + abs(i - j)) + 0.01 * (double)s;
        brunt_block_matrix_add(&m, list.node + list.first[s], count, dense);
    }
    return m;
}

static brunt_linear_status solve(const brunt_linear_ops *ops, const brunt_block_matrix *m, const double *b, double *x,
                                 int *negative, brunt_error *error) {
    brunt_linear s = {0};
    ck_assert_int_eq(brunt_linear_open(&s, ops, &exact, error), BRUNT_OK);
    brunt_linear_status status = brunt_linear_analyse(&s, &team, m, error);
    if (status == BRUNT_LINEAR_DONE) status = brunt_linear_factor(&s, &team, m, error);
    *negative = s.report.negative;
    if (status == BRUNT_LINEAR_DONE) status = brunt_linear_solve(&s, &team, b, x, error);
    brunt_linear_close(&s);
    return status;
}

static void check_solution(const brunt_linear_ops *ops, int dim, bool all_alone) {
    brunt_block_matrix m = some_alone(dim, all_alone);
    double b[MOST], x[MOST], product[MOST];
    int negative;
    brunt_error error = {0};
    for (int i = 0; i < NODES * dim; i++) b[i] = sin(0.7 * i) + 0.2;
    ck_assert_int_eq(solve(ops, &m, b, x, &negative, &error), BRUNT_LINEAR_DONE);
    brunt_block_matrix_product(&m, &team, x, product);
    for (int i = 0; i < NODES * dim; i++) ck_assert_double_eq_tol(product[i], b[i], 1e-13);
    brunt_block_matrix_free(&m);
}

START_TEST(solutions_are_of_the_whole_matrix) {
    for (const brunt_linear_ops *const *ops = brunt_linear_list(); *ops; ops++)
        for (int dim = 2; dim <= 3; dim++)
            for (int all_alone = 0; all_alone < 2; all_alone++) check_solution(*ops, dim, all_alone);
}
END_TEST

// -1 on the diagonal of a node that is alone is one negative pivot; 0 leaves none.
static void check_pivot(int dim, bool all_alone, double pivot, int expected) {
    brunt_block_matrix m = some_alone(dim, all_alone);
    double b[MOST] = {1}, x[MOST], *block = brunt_block_matrix_diagonal(&m, 4);
    int negative;
    brunt_error error = {0};
    memset(block, 0, (size_t)(dim * dim) * sizeof *block);
    for (int c = 0; c < dim; c++) block[c * dim + c] = c == dim - 1 ? pivot : 1;
    ck_assert_int_eq(solve(&brunt_linear_direct, &m, b, x, &negative, &error), BRUNT_LINEAR_INDEFINITE);
    ck_assert_ptr_nonnull(strstr(error.message, "not positive definite"));
    char told[64];
    if (expected)
        snprintf(told, sizeof told, "%d of %d pivots are negative", expected, NODES * dim);
    else
        snprintf(told, sizeof told, "of rank %d of %d", NODES * dim - 1, NODES * dim);
    ck_assert_msg(strstr(error.message, told), "%s", error.message);
    ck_assert_int_eq(negative, expected);
    brunt_block_matrix_free(&m);
}

START_TEST(their_pivots_count) {
    for (int dim = 2; dim <= 3; dim++)
        for (int all_alone = 0; all_alone < 2; all_alone++) {
            check_pivot(dim, all_alone, -1, 1);
            check_pivot(dim, all_alone, 0, 0);
        }
}
END_TEST

// Nothing on the diagonal, and yet not singular: where matrices need not be symmetric, rows are exchanged.
START_TEST(blocks_may_need_rows_exchanged) {
    brunt_block_matrix m = some_alone(2, false);
    double b[MOST] = {0}, x[MOST], *block = brunt_block_matrix_diagonal(&m, 4);
    int negative;
    brunt_error error = {0};
    block[0] = block[3] = 0, block[1] = 2, block[2] = 4;
    b[8] = 6, b[9] = 20;
    ck_assert_int_eq(solve(&brunt_linear_unsymmetric, &m, b, x, &negative, &error), BRUNT_LINEAR_DONE);
    ck_assert_double_eq_tol(x[8], 5, 1e-14);
    ck_assert_double_eq_tol(x[9], 3, 1e-14);
    brunt_block_matrix_free(&m);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("uncoupled nodes");
    ADD(solutions_are_of_the_whole_matrix);
    ADD(their_pivots_count);
    ADD(blocks_may_need_rows_exchanged);
    return suite_main(suite);
}
