#include "linear/block_matrix.h"

#include <string.h>

#include "base/error.h"
#include "linear/wide.h"

enum { PIECE = 40000 }; // entries that a thread reads at a time: some 20 us

typedef struct row_work {
    brunt_block_matrix *m;
    const double *x;
    double *y;
    const uint8_t *held;
    double diagonal;
} row_work;

// Rows of a piece.
static int64_t row_grain(const brunt_block_matrix *m) {
    const double entries = (double)brunt_block_matrix_blocks(m) * m->dim * m->dim / (double)(m->nodes + 1);
    return 1 + (int64_t)(PIECE / (1 + entries));
}

static void zero_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const row_work *w = context;
    const int64_t *first = w->m->first, size = w->m->dim * w->m->dim;
    memset(w->m->value + first[begin] * size, 0, (size_t)((first[end] - first[begin]) * size) * sizeof(double));
}

void brunt_block_matrix_zero(brunt_block_matrix *m, const brunt_team *team) {
    row_work work = {.m = m};
    brunt_parallel(team->threads, m->nodes, row_grain(m), zero_rows, &work, team->timer);
}

// The order of a stencil's nodes; almost always they ascend as they are.
static void ascending(const int32_t *node, int count, int *order) {
    for (int i = 0; i < count; i++) {
        int k = i;
        for (; k > 0 && node[order[k - 1]] > node[i]; k--) order[k] = order[k - 1];
        order[k] = i;
    }
}

BRUNT_INLINE void add_rows(brunt_block_matrix *m, const int32_t *node, const int *order, int count, const double *dense,
                           int dim) {
    for (int a = 0; a < count; a++) {
        const int64_t end = m->first[node[a] + 1];
        int64_t k = m->first[node[a]];
        for (int o = 0; o < count; o++, k++) {
            const int b = order[o];
            while (k < end && m->column[k] < node[b]) k++;
            BRUNT_ASSERT(k < end && m->column[k] == node[b]);
            double *to = m->value + k * dim * dim;
            for (int i = 0; i < dim; i++)
                for (int j = 0; j < dim; j++) to[i * dim + j] += dense[((a * dim + i) * count + b) * dim + j];
        }
    }
}

void brunt_block_matrix_add(brunt_block_matrix *m, const int32_t *node, int count, const double *dense) {
    int order[BRUNT_STENCIL_LIMIT];
    BRUNT_ASSERT(count <= BRUNT_STENCIL_LIMIT);
    ascending(node, count, order);
    if (m->dim == 2)
        add_rows(m, node, order, count, dense, 2);
    else
        add_rows(m, node, order, count, dense, 3);
}

BRUNT_INLINE four times_2(const double *v, const double *p) { return four_load(v) * (four){p[0], p[1], p[0], p[1]}; }

static void multiply_2(const brunt_block_matrix *m, const double *x, double *y, int64_t row) {
    four even = {0}, odd = {0};
    const int64_t end = m->first[row + 1];
    int64_t k = m->first[row];
    for (; k + 2 <= end; k += 2) {
        even += times_2(m->value + 4 * k, x + 2 * (int64_t)m->column[k]);
        odd += times_2(m->value + 4 * (k + 1), x + 2 * (int64_t)m->column[k + 1]);
    }
    if (k < end) even += times_2(m->value + 4 * k, x + 2 * (int64_t)m->column[k]);
    even += odd;
    y[2 * row] = even[0] + even[1], y[2 * row + 1] = even[2] + even[3];
}

// Rows of a block side by side: the first two with a number beyond, the last with one before.
BRUNT_INLINE void add_times_3(four s[3], const double *v, const double *p) {
    const four high = {p[0], p[1], p[2], 0}, low = {0, p[0], p[1], p[2]};
    s[0] += four_load(v) * high;
    s[1] += four_load(v + 3) * high;
    s[2] += four_load(v + 5) * low;
}

static void multiply_3(const brunt_block_matrix *m, const double *x, double *y, int64_t row) {
    four even[3] = {{0}, {0}, {0}}, odd[3] = {{0}, {0}, {0}};
    const int64_t end = m->first[row + 1];
    int64_t k = m->first[row];
    for (; k + 2 <= end; k += 2) {
        add_times_3(even, m->value + 9 * k, x + 3 * (int64_t)m->column[k]);
        add_times_3(odd, m->value + 9 * (k + 1), x + 3 * (int64_t)m->column[k + 1]);
    }
    if (k < end) add_times_3(even, m->value + 9 * k, x + 3 * (int64_t)m->column[k]);
    for (int i = 0; i < 3; i++) {
        const four s = even[i] + odd[i];
        y[3 * row + i] = i < 2 ? s[0] + s[1] + s[2] : s[1] + s[2] + s[3];
    }
}

static void multiply_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const row_work *w = context;
    if (w->m->dim == 2)
        for (int64_t r = begin; r < end; r++) multiply_2(w->m, w->x, w->y, r);
    else
        for (int64_t r = begin; r < end; r++) multiply_3(w->m, w->x, w->y, r);
}

void brunt_block_matrix_product(const brunt_block_matrix *m, const brunt_team *team, const double *x, double *y) {
    row_work work = {.m = (brunt_block_matrix *)m, .x = x, .y = y};
    brunt_parallel(team->threads, m->nodes, row_grain(m), multiply_rows, &work, team->timer);
}

BRUNT_INLINE bool any_held(const uint8_t *held, int dim) {
    return dim == 2 ? held[0] | held[1] : held[0] | held[1] | held[2];
}

BRUNT_INLINE void hold_row(const row_work *w, int64_t r, int dim) {
    const uint8_t *row = w->held + r * dim;
    const bool whole = any_held(row, dim);
    for (int64_t k = w->m->first[r]; k < w->m->first[r + 1]; k++) {
        const uint8_t *column = w->held + (int64_t)w->m->column[k] * dim;
        if (!whole && !any_held(column, dim)) continue;
        double *v = w->m->value + k * dim * dim;
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++)
                if (row[i] || column[j]) v[i * dim + j] = w->m->column[k] == r && i == j ? w->diagonal : 0;
    }
}

static void hold_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const row_work *w = context;
    for (int64_t r = begin; r < end; r++) w->m->dim == 2 ? hold_row(w, r, 2) : hold_row(w, r, 3);
}

void brunt_block_matrix_hold(brunt_block_matrix *m, const brunt_team *team, const uint8_t *held, double diagonal) {
    row_work work = {.m = m, .held = held, .diagonal = diagonal};
    if (!memchr(held, 1, (size_t)m->nodes * (size_t)m->dim)) return;
    brunt_parallel(team->threads, m->nodes, row_grain(m), hold_rows, &work, team->timer);
}

double brunt_block_matrix_mean_diagonal(const brunt_block_matrix *m, const uint8_t *held) {
    const int dim = m->dim;
    double sum = 0;
    int64_t count = 0;
    for (int64_t n = 0; n < m->nodes; n++)
        for (int c = 0; c < dim; c++)
            if (!held || !held[n * dim + c]) sum += m->value[(m->diagonal[n] * dim + c) * dim + c], count++;
    return count && sum > 0 ? sum / (double)count : 1;
}

void brunt_block_matrix_scale_diagonal(brunt_block_matrix *m, double factor) {
    const int dim = m->dim;
    for (int64_t n = 0; n < m->nodes; n++)
        for (int c = 0; c < dim; c++) m->value[(m->diagonal[n] * dim + c) * dim + c] *= factor;
}

void brunt_block_matrix_validate(const brunt_block_matrix *m) {
    if (!m->pattern) return; // never made
    BRUNT_ASSERT((m->dim == 2 || m->dim == 3) && m->nodes >= 0 && m->first[0] == 0);
    for (int32_t r = 0; r < m->nodes; r++) {
        const int64_t low = m->first[r], high = m->first[r + 1], own = m->diagonal[r];
        BRUNT_ASSERT(low <= own && own < high && m->column[own] == r);
        for (int64_t k = low; k < high; k++)
            BRUNT_ASSERT(m->column[k] >= 0 && m->column[k] < m->nodes && (k == low || m->column[k - 1] < m->column[k]));
    }
    BRUNT_ASSERT((size_t)m->first[m->nodes] <= m->value_capacity / sizeof *m->value / (size_t)(m->dim * m->dim));
}
