#include "linear/incomplete.h"

#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/simd.h"

enum { JACOBI_GRAIN = 2048 };

int brunt_incomplete_analyse(brunt_incomplete *f, const brunt_block_matrix *a, bool whole) {
    const size_t nodes = (size_t)a->nodes, size = (size_t)(a->dim * a->dim);
    f->a = a;
    if (BRUNT_RESERVE(f->inverse, nodes * size, 0)) return -1;
    if (!whole) return 0;
    if (BRUNT_RESERVE(f->upper, nodes + 1, 0) || BRUNT_RESERVE(f->d, nodes * size, 0) ||
        BRUNT_RESERVE(f->next, nodes, 0) || BRUNT_RESERVE(f->slot, nodes, 0))
        return -1;
    f->upper[0] = 0;
    for (int32_t r = 0; r < a->nodes; r++) f->upper[r + 1] = f->upper[r] + a->first[r + 1] - a->diagonal[r] - 1;
    return BRUNT_RESERVE(f->v, (size_t)f->upper[nodes] * size, 0);
}

void brunt_incomplete_free(brunt_incomplete *f) {
    brunt_free(f->upper), brunt_free(f->v), brunt_free(f->d), brunt_free(f->inverse), brunt_free(f->next);
    brunt_free(f->slot);
    *f = (brunt_incomplete){0};
}

// The inverse of a symmetric block; false when the block is not positive definite.
static bool invert_2(const double *a, double *b) {
    const double determinant = a[0] * a[3] - a[1] * a[2];
    if (!(a[0] > 0 && determinant > 0)) return false;
    b[0] = a[3] / determinant, b[1] = -a[1] / determinant, b[2] = -a[2] / determinant, b[3] = a[0] / determinant;
    return true;
}

static bool invert_3(const double *a, double *b) {
    const double p = a[0] * a[4] - a[1] * a[3], x = a[4] * a[8] - a[5] * a[7], y = a[5] * a[6] - a[3] * a[8],
                 z = a[3] * a[7] - a[4] * a[6], determinant = a[0] * x + a[1] * y + a[2] * z;
    if (!(a[0] > 0 && p > 0 && determinant > 0)) return false;
    b[0] = x / determinant, b[1] = b[3] = y / determinant, b[2] = b[6] = z / determinant;
    b[4] = (a[0] * a[8] - a[2] * a[6]) / determinant, b[5] = b[7] = (a[2] * a[3] - a[0] * a[5]) / determinant;
    b[8] = p / determinant;
    return true;
}

static bool invert(int dim, const double *a, double *b) { return dim == 2 ? invert_2(a, b) : invert_3(a, b); }

typedef enum product_form { TIMES, TRANSPOSED_TIMES, MINUS_TIMES } product_form;

// c = a b, c = a' b or c -= a b of blocks; dim and form are literals where it is called.
BRUNT_INLINE void multiply(int dim, product_form form, const double *restrict a, const double *restrict b,
                           double *restrict c) {
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            double s = 0;
            for (int k = 0; k < dim; k++) s += a[form == TRANSPOSED_TIMES ? k * dim + i : i * dim + k] * b[k * dim + j];
            c[i * dim + j] = form == MINUS_TIMES ? c[i * dim + j] - s : s;
        }
}

// Row i of D (I + V), from the matrix less what earlier rows bring to it: V of the row is there instead of D V until
// the end. Columns of earlier rows come in their order, so that each row needs to remember the next one only.
BRUNT_INLINE bool factor_row(brunt_incomplete *f, const brunt_block_matrix *a, int32_t i, double raise, int dim) {
    const int size = dim * dim;
    const int64_t diagonal = a->diagonal[i], after = diagonal + 1, columns = a->first[i + 1] - after;
    double *row = f->v + f->upper[i] * size, *pivot = f->d + (int64_t)i * size,
           *inverse = f->inverse + (int64_t)i * size;
    memcpy(row, a->value + after * size, (size_t)(columns * size) * sizeof *row);
    for (int e = 0; e < size; e++) pivot[e] = raise * a->value[diagonal * size + e];
    for (int64_t c = 0; c < columns; c++) f->slot[a->column[after + c]] = (int32_t)c;
    for (int64_t k = a->first[i]; k < diagonal; k++) {
        const int32_t above = a->column[k];
        const int32_t *column = a->column + a->diagonal[above] + 1;
        const int64_t end = f->upper[above + 1] - f->upper[above];
        const double *v = f->v + f->upper[above] * size;
        int64_t c = f->next[above]++;
        BRUNT_ASSERT(column[c] == i);
        double t[9];
        multiply(dim, TRANSPOSED_TIMES, v + c * size, f->d + (int64_t)above * size, t);
        multiply(dim, MINUS_TIMES, t, v + c * size, pivot);
        for (c++; c < end; c++) {
            const int32_t slot = f->slot[column[c]];
            if (slot >= 0) multiply(dim, MINUS_TIMES, t, v + c * size, row + (int64_t)slot * size);
        }
    }
    for (int64_t c = 0; c < columns; c++) f->slot[a->column[after + c]] = -1;
    if (!invert(dim, pivot, inverse)) return false;
    for (int64_t c = 0; c < columns; c++) {
        double w[9];
        memcpy(w, row + c * size, (size_t)size * sizeof *w);
        multiply(dim, TIMES, inverse, w, row + c * size);
    }
    return true;
}

int32_t brunt_incomplete_factor(brunt_incomplete *f, const brunt_block_matrix *a, double raise) {
    memset(f->next, 0, (size_t)a->nodes * sizeof *f->next);
    for (int32_t i = 0; i < a->nodes; i++) f->slot[i] = -1;
    for (int32_t i = 0; i < a->nodes; i++)
        if (!(a->dim == 2 ? factor_row(f, a, i, raise, 2) : factor_row(f, a, i, raise, 3))) return i;
    return -1;
}

int32_t brunt_incomplete_jacobi(brunt_incomplete *f, const brunt_block_matrix *a) {
    const int size = a->dim * a->dim;
    for (int32_t i = 0; i < a->nodes; i++)
        if (!invert(a->dim, a->value + a->diagonal[i] * size, f->inverse + (int64_t)i * size)) return i;
    return -1;
}

typedef struct apply_work {
    const brunt_incomplete *f;
    const double *r;
    double *z;
} apply_work;

static void apply_jacobi(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const apply_work *w = context;
    const int dim = w->f->a->dim;
    for (int64_t n = begin; n < end; n++)
        for (int i = 0; i < dim; i++) {
            double s = 0;
            for (int j = 0; j < dim; j++) s += w->f->inverse[(n * dim + i) * dim + j] * w->r[n * dim + j];
            w->z[n * dim + i] = s;
        }
}

// (I + V)' y = r downwards, D y, and (I + V) z = D^-1 y upwards, all in z.
BRUNT_INLINE void substitute(const brunt_incomplete *f, double *z, int dim) {
    const brunt_block_matrix *a = f->a;
    for (int64_t r = 0; r < a->nodes; r++) {
        const int32_t *column = a->column + a->diagonal[r] + 1;
        const double *v = f->v + f->upper[r] * dim * dim, *y = z + r * dim;
        for (int64_t c = 0; c < f->upper[r + 1] - f->upper[r]; c++, v += dim * dim) {
            double *to = z + (int64_t)column[c] * dim;
            for (int j = 0; j < dim; j++) {
                double s = 0;
                for (int i = 0; i < dim; i++) s += v[i * dim + j] * y[i];
                to[j] -= s;
            }
        }
    }
    for (int64_t r = a->nodes - 1; r >= 0; r--) {
        const int32_t *column = a->column + a->diagonal[r] + 1;
        const double *v = f->v + f->upper[r] * dim * dim, *inverse = f->inverse + r * dim * dim;
        double s[3] = {0};
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) s[i] += inverse[i * dim + j] * z[r * dim + j];
        for (int64_t c = 0; c < f->upper[r + 1] - f->upper[r]; c++, v += dim * dim) {
            const double *from = z + (int64_t)column[c] * dim;
            for (int i = 0; i < dim; i++)
                for (int j = 0; j < dim; j++) s[i] -= v[i * dim + j] * from[j];
        }
        for (int i = 0; i < dim; i++) z[r * dim + i] = s[i];
    }
}

void brunt_incomplete_apply(const brunt_incomplete *f, const brunt_team *team, bool whole, const double *r, double *z) {
    const brunt_block_matrix *a = f->a;
    if (whole) {
        memcpy(z, r, (size_t)a->nodes * (size_t)a->dim * sizeof *z);
        if (a->dim == 2)
            substitute(f, z, 2);
        else
            substitute(f, z, 3);
        return;
    }
    apply_work work = {f, r, z};
    brunt_parallel(team->threads, a->nodes, JACOBI_GRAIN, apply_jacobi, &work, team->timer);
}
