#include "linear/fold.h"

#include <string.h>

void brunt_fold_spread(const brunt_fold *fold, int dim, double *x) {
    for (int32_t i = 0; i < fold->count; i++) {
        const int64_t to = fold->follower[i] * (int64_t)dim, from = fold->leader[fold->follower[i]] * (int64_t)dim;
        for (int a = 0; a < dim; a++) x[to + a] = fold->sign[to + a] * x[from + a];
    }
}

void brunt_fold_gather(const brunt_fold *fold, int dim, double *g) {
    for (int32_t i = 0; i < fold->count; i++) {
        const int64_t from = fold->follower[i] * (int64_t)dim, to = fold->leader[fold->follower[i]] * (int64_t)dim;
        for (int a = 0; a < dim; a++) g[to + a] += fold->sign[from + a] * g[from + a], g[from + a] = 0;
    }
}

// ------------------------------------------------------------------------------------------ the matrix

typedef struct column_work {
    const brunt_fold *fold;
    brunt_block_matrix *m;
} column_work;

enum { GRAIN = 64 };

// H P, row by row.
static void fold_columns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const column_work *w = context;
    const brunt_block_matrix *m = w->m;
    const int dim = m->dim, size = dim * dim;
    for (int64_t row = begin; row < end; row++)
        for (int64_t k = m->first[row]; k < m->first[row + 1]; k++) {
            const int32_t column = m->column[k], leader = w->fold->leader[column];
            const double *sign = w->fold->sign + column * (int64_t)dim;
            if (leader == column) continue;
            double *from = m->value + k * size, *to = m->value + brunt_block_matrix_place(m, row, leader) * size;
            for (int e = 0; e < size; e++) to[e] += from[e] * sign[e % dim], from[e] = 0;
        }
}

// P^T of what has been folded by columns: followers in their order.
static void fold_row(const brunt_fold *fold, brunt_block_matrix *m, int32_t row) {
    const int dim = m->dim, size = dim * dim;
    const int32_t leader = fold->leader[row];
    const double *sign = fold->sign + row * (int64_t)dim;
    int64_t to = m->first[leader];
    for (int64_t k = m->first[row]; k < m->first[row + 1]; k++) {
        if (fold->leader[m->column[k]] != m->column[k]) continue; // nothing any more
        while (m->column[to] < m->column[k]) to++;
        for (int e = 0; e < size; e++) m->value[to * size + e] += sign[e / dim] * m->value[k * size + e];
    }
    memset(m->value + m->first[row] * size, 0, (size_t)((m->first[row + 1] - m->first[row]) * size) * sizeof *m->value);
}

void brunt_fold_matrix(const brunt_fold *fold, const brunt_team *team, brunt_block_matrix *m) {
    column_work work = {fold, m};
    brunt_parallel(team->threads, m->nodes, GRAIN, fold_columns, &work, team->timer);
    for (int32_t i = 0; i < fold->count; i++) fold_row(fold, m, fold->follower[i]);
}

void brunt_fold_diagonal(const brunt_fold *fold, brunt_block_matrix *m) {
    const int dim = m->dim, size = dim * dim;
    for (int32_t i = 0; i < fold->count; i++) {
        const int32_t n = fold->follower[i];
        const double *sign = fold->sign + n * (int64_t)dim;
        double *from = brunt_block_matrix_diagonal(m, n), *to = brunt_block_matrix_diagonal(m, fold->leader[n]);
        for (int e = 0; e < size; e++) to[e] += sign[e / dim] * sign[e % dim] * from[e], from[e] = 0;
    }
}

void brunt_fold_hold(const brunt_fold *fold, brunt_block_matrix *m) {
    for (int32_t i = 0; i < fold->count; i++)
        for (int a = 0; a < m->dim; a++) brunt_block_matrix_diagonal(m, fold->follower[i])[a * (m->dim + 1)] = 1;
}
