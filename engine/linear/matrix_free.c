#include "linear/matrix_free.h"

#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

static int64_t unknowns(const brunt_matrix_free *f) { return (int64_t)f->rest->nodes * f->rest->dim; }

int brunt_matrix_free_take(brunt_matrix_free *f, const brunt_team *team, const double *u, bool project,
                           brunt_error *error) {
    brunt_block_matrix *blocks = &f->blocks;
    const int size = f->rest->dim * f->rest->dim;
    const brunt_pattern alone = {.dim = f->rest->dim, .nodes = f->rest->nodes, .keep = true};
    if (brunt_block_matrix_pattern(blocks, team, &alone, error)) return BRUNT_FAILED;
    if (BRUNT_CAPACITY(f->x, (size_t)unknowns(f), 0, "unknowns of products", error)) return BRUNT_FAILED;
    f->raise = 0;
    for (int32_t n = 0; n < f->rest->nodes; n++)
        memcpy(blocks->value + (int64_t)n * size, f->rest->value + f->rest->diagonal[n] * size,
               (size_t)size * sizeof(double));
    for (int t = 0; t < f->count; t++)
        if (f->terms[t].ops->linearise) f->terms[t].ops->linearise(f->terms[t].self, team, u, project, blocks);
    if (f->fold) brunt_fold_diagonal(f->fold, blocks);
    return BRUNT_OK;
}

void brunt_matrix_free_hold(brunt_matrix_free *f, const brunt_team *team) {
    if (f->held) brunt_block_matrix_hold(&f->blocks, team, f->held, 1);
}

void brunt_matrix_free_raise(brunt_matrix_free *f, double raise) {
    brunt_block_matrix_scale_diagonal(&f->blocks, (1 + raise) / (1 + f->raise));
    f->raise = raise;
}

void brunt_matrix_free_hessian(const brunt_matrix_free *f, const brunt_team *team, const double *x, double *y) {
    brunt_block_matrix_product(f->rest, team, x, y);
    for (int t = 0; t < f->count; t++)
        if (f->terms[t].ops->product) f->terms[t].ops->product(f->terms[t].self, team, x, y);
    if (f->fold) brunt_fold_gather(f->fold, f->rest->dim, y);
}

typedef struct masks {
    const brunt_matrix_free *f;
    const double *x;
    double *y;
} masks;

enum { GRAIN = 4096 }; // unknowns

static void leave_out_held(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const masks *m = context;
    for (int64_t i = begin; i < end; i++) m->f->x[i] = m->f->held && m->f->held[i] ? 0 : m->x[i];
}

static void add_held(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const masks *m = context;
    for (int64_t i = begin; i < end; i++)
        if (m->f->held[i]) m->y[i] = m->x[i];
}

static void add_raise(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const masks *m = context;
    const int dim = m->f->rest->dim;
    const double share = m->f->raise / (1 + m->f->raise); // of a raised entry, that is more than it was
    for (int64_t i = begin; i < end; i++) m->y[i] += share * m->f->blocks.value[i * dim + i % dim] * m->x[i];
}

void brunt_matrix_free_product(void *matrix_free, const brunt_team *team, const double *x, double *y) {
    const brunt_matrix_free *f = matrix_free;
    masks m = {f, x, y};
    const bool masked = f->held || f->fold;
    if (masked) brunt_parallel(team->threads, unknowns(f), GRAIN, leave_out_held, &m, team->timer);
    if (f->fold) brunt_fold_spread(f->fold, f->rest->dim, f->x);
    brunt_matrix_free_hessian(f, team, masked ? f->x : x, y);
    if (f->held) brunt_parallel(team->threads, unknowns(f), GRAIN, add_held, &m, team->timer);
    if (f->raise > 0) brunt_parallel(team->threads, unknowns(f), GRAIN, add_raise, &m, team->timer);
}

size_t brunt_matrix_free_bytes(const brunt_matrix_free *f) {
    const brunt_block_matrix *a = &f->blocks;
    return a->first_capacity + a->column_capacity + a->diagonal_capacity + a->value_capacity + f->x_capacity;
}

void brunt_matrix_free_free(brunt_matrix_free *f) {
    brunt_block_matrix_free(&f->blocks);
    brunt_free(f->x);
    *f = (brunt_matrix_free){0};
}
