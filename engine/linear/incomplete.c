#include "linear/incomplete.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "linear/wide.h"

enum { JACOBI_GRAIN = 2048, ROW_GRAIN = 256, SIZE_GRAIN = 1024 };
// Solutions read V from numbers of half the length, four at a time, which reach beyond the last.
enum { BEYOND = 4 };

void brunt_incomplete_free(brunt_incomplete *f) {
    void *const all[] = {f->order, f->place, f->turn,    f->upper, f->lower, f->after, f->before, f->source, f->twin,
                         f->v,     f->d,     f->inverse, f->size,  f->right, f->left,  f->work,   f->slot};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    *f = (brunt_incomplete){0};
}

// ------------------------------------------------------------------------------------------ the pattern

static int reserve_arrays(brunt_incomplete *f, const brunt_team *team, brunt_error *error) {
    const size_t nodes = (size_t)f->a->nodes, dim = (size_t)f->a->dim, size = dim * dim,
                 half = ((size_t)brunt_block_matrix_blocks(f->a) - nodes) / 2;
    return BRUNT_CAPACITY(f->order, nodes, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->place, nodes, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->turn, nodes, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->upper, nodes + 1, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->lower, nodes + 1, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->after, half + 1, 0, "blocks of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->before, half + 1, 0, "blocks of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->source, half + 1, 0, "blocks of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->twin, half + 1, 0, "blocks of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->v, half * size + 1, 0, "values of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->d, nodes * size, 0, "values of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->size, nodes, 0, "rows of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->right, half * size + BEYOND, 0, "values of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->left, half * size + BEYOND, 0, "values of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->work, nodes * (dim == 2 ? 2 : 4), 0, "values of an incomplete factor", error) ||
           BRUNT_CAPACITY(f->slot, nodes * (size_t)team->threads, 0, "rows of an incomplete factor", error);
}

typedef struct pattern_work {
    brunt_incomplete *f;
    int parts; // of the places, a thread each
} pattern_work;

// How many columns of each place are right of the diagonal, and left of it.
static void count_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *w = context;
    brunt_incomplete *f = w->f;
    for (int64_t p = begin; p < end; p++) {
        const int32_t node = f->order[p];
        const int64_t from = f->a->first[node], to = f->a->first[node + 1];
        int64_t right = 0;
        for (int64_t k = from; k < to; k++) right += f->place[f->a->column[k]] > p;
        f->upper[p + 1] = right, f->lower[p + 1] = to - from - 1 - right;
    }
}

// Columns right of the diagonal: by level, and those of a piece in ascending places.
static void take_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *w = context;
    brunt_incomplete *f = w->f;
    const brunt_block_matrix *a = f->a;
    const int turns = f->slabs > 1 ? 1 : 2; // through one slab forwards only
    for (int64_t p = begin; p < end; p++) {
        const int32_t node = f->order[p];
        int64_t e = f->upper[p];
        for (int turn = f->turn[node]; turn < 2 * f->levels; turn += turns)
            for (int64_t k = 0; k < a->first[node + 1] - a->first[node] && e < f->upper[p + 1]; k++) {
                const int64_t at = turn % 2 ? a->first[node + 1] - 1 - k : a->first[node] + k;
                const int32_t q = f->place[a->column[at]];
                if (q <= p || f->turn[a->column[at]] != turn) continue;
                f->after[e] = q, f->source[e++] = (int32_t)(at - a->first[node]);
            }
    }
}

static int64_t part_begin(const pattern_work *w, int64_t part) { return w->f->a->nodes * part / w->parts; }

// What a part of the places brings to each column; then where in the column that begins, and at last all of it.
static void count_columns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *w = context;
    const brunt_incomplete *f = w->f;
    for (int64_t part = begin; part < end; part++) {
        int32_t *count = f->slot + part * f->a->nodes;
        for (int64_t e = f->upper[part_begin(w, part)]; e < f->upper[part_begin(w, part + 1)]; e++)
            count[f->after[e]]++;
    }
}

static void begin_columns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *w = context;
    const int64_t nodes = w->f->a->nodes;
    for (int64_t q = begin; q < end; q++)
        for (int32_t part = 0, sum = 0; part < w->parts; part++) {
            const int32_t count = w->f->slot[part * nodes + q];
            w->f->slot[part * nodes + q] = sum;
            sum += count;
        }
}

static void take_columns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *w = context;
    brunt_incomplete *f = w->f;
    for (int64_t part = begin; part < end; part++) {
        int32_t *next = f->slot + part * f->a->nodes;
        for (int64_t p = part_begin(w, part); p < part_begin(w, part + 1); p++)
            for (int64_t e = f->upper[p]; e < f->upper[p + 1]; e++) {
                const int64_t at = f->lower[f->after[e]] + next[f->after[e]]++;
                f->before[at] = (int32_t)p, f->twin[at] = (int32_t)(e - f->upper[p]);
            }
    }
}

static void take_pattern(brunt_incomplete *f, const brunt_team *team) {
    const int64_t nodes = f->a->nodes;
    const size_t slots = (size_t)nodes * (size_t)team->threads;
    pattern_work work = {f, team->threads};
    brunt_parallel(team->threads, nodes, ROW_GRAIN, count_rows, &work, team->timer);
    f->upper[0] = f->lower[0] = 0;
    for (int64_t p = 0; p < nodes; p++) f->upper[p + 1] += f->upper[p], f->lower[p + 1] += f->lower[p];
    brunt_parallel(team->threads, nodes, ROW_GRAIN, take_rows, &work, team->timer);
    memset(f->slot, 0, slots * sizeof *f->slot);
    if (work.parts > 1) {
        brunt_parallel_each(team->threads, work.parts, count_columns, &work, team->timer);
        brunt_parallel(team->threads, nodes, SIZE_GRAIN, begin_columns, &work, team->timer);
    }
    brunt_parallel_each(team->threads, work.parts, take_columns, &work, team->timer);
    memset(f->slot, 0, slots * sizeof *f->slot);
}

int brunt_incomplete_analyse(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a, bool whole,
                             int slabs, brunt_error *error) {
    f->a = a;
    if (BRUNT_CAPACITY(f->inverse, (size_t)a->nodes * (size_t)(a->dim * a->dim) + 1, 0,
                       "values of the diagonal of a matrix", error))
        return BRUNT_FAILED;
    if (!whole) return BRUNT_OK;
    if (reserve_arrays(f, team, error)) return BRUNT_FAILED;
    brunt_incomplete_order(f, slabs);
    take_pattern(f, team);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ the factor

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

// c = a b or (transposed) a' b of blocks; dim and transposed are literals where it is called.
BRUNT_INLINE void multiply(int dim, bool transposed, const double *restrict a, const double *restrict b,
                           double *restrict c) {
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            c[i * dim + j] = 0;
            for (int k = 0; k < dim; k++) c[i * dim + j] += a[transposed ? k * dim + i : i * dim + k] * b[k * dim + j];
        }
}

// A block as it multiplies many others from the left: its column k beside the numbers of a product, four of them at a
// time, where row k of the other block is; in 3D the ninth is alone.
typedef struct left_block {
    four first[3], second[3];
    double last[3];
} left_block;

BRUNT_INLINE left_block take_left(int dim, const double *t) {
    left_block l;
    for (int k = 0; k < dim; k++) {
        if (dim == 2) {
            l.first[k] = (four){t[k], t[k], t[2 + k], t[2 + k]};
            continue;
        }
        l.first[k] = (four){t[k], t[k], t[k], t[3 + k]};
        l.second[k] = (four){t[3 + k], t[3 + k], t[6 + k], t[6 + k]};
        l.last[k] = t[6 + k];
    }
    return l;
}

// c -= l v
BRUNT_INLINE void subtract_2(const left_block *l, const double *v, double *c) {
    four s = l->first[0] * (four){v[0], v[1], v[0], v[1]};
    s += l->first[1] * (four){v[2], v[3], v[2], v[3]};
    four_store(c, four_load(c) - s);
}

BRUNT_INLINE void subtract_3(const left_block *l, const double *v, double *c) {
    const four a = four_load(v), b = four_load(v + 3), d = four_load(v + 5);
    four s = l->first[0] * __builtin_shufflevector(a, a, 0, 1, 2, 0);
    four t = l->second[0] * __builtin_shufflevector(a, a, 1, 2, 0, 1);
    s += l->first[1] * __builtin_shufflevector(b, b, 0, 1, 2, 0);
    t += l->second[1] * __builtin_shufflevector(b, b, 1, 2, 0, 1);
    s += l->first[2] * __builtin_shufflevector(d, d, 1, 2, 3, 1);
    t += l->second[2] * __builtin_shufflevector(d, d, 2, 3, 1, 2);
    four_store(c, four_load(c) - s);
    four_store(c + 4, four_load(c + 4) - t);
    c[8] -= l->last[0] * v[2] + l->last[1] * v[5] + l->last[2] * v[8];
}

BRUNT_INLINE void subtract(int dim, const left_block *l, const double *v, double *c) {
    dim == 2 ? subtract_2(l, v, c) : subtract_3(l, v, c);
}

// Blocks of V as a solution reads them: in 2D row by row, in 3D column by column.
BRUNT_INLINE void shorten(int dim, bool transposed, const double *v, float *to) {
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++)
            to[i * dim + j] = (float)(transposed == (dim == 2) ? v[j * dim + i] : v[i * dim + j]);
}

// The row of place p: from the matrix less what earlier rows bring to it.
BRUNT_INLINE bool factor_row(brunt_incomplete *f, const brunt_block_matrix *a, int32_t p, double raise, int32_t *slot,
                             int dim) {
    const int size = dim * dim;
    const int32_t node = f->order[p], *after = f->after + f->upper[p];
    const int64_t columns = f->upper[p + 1] - f->upper[p];
    double *row = f->v + f->upper[p] * size, *pivot = f->d + (int64_t)p * size,
           *inverse = f->inverse + (int64_t)p * size;
    for (int64_t c = 0; c < columns; c++) {
        const double *from = a->value + (a->first[node] + f->source[f->upper[p] + c]) * size,
                     both = f->size[p] * f->size[after[c]];
        for (int e = 0; e < size; e++) row[c * size + e] = both * from[e];
        slot[after[c]] = (int32_t)c + 1;
    }
    for (int e = 0; e < size; e++) pivot[e] = raise * f->size[p] * f->size[p] * a->value[a->diagonal[node] * size + e];
    for (int64_t k = f->lower[p]; k < f->lower[p + 1]; k++) {
        const int64_t above = f->before[k], end = f->upper[above + 1] - f->upper[above];
        const int32_t *column = f->after + f->upper[above];
        const double *v = f->v + f->upper[above] * size;
        int64_t c = f->twin[k];
        double t[9];
        multiply(dim, true, v + c * size, f->d + above * size, t);
        const left_block left = take_left(dim, t);
        subtract(dim, &left, v + c * size, pivot);
        shorten(dim, true, v + c * size, f->left + k * size);
        for (c++; c < end; c++) {
            const int32_t at = slot[column[c]];
            if (at) subtract(dim, &left, v + c * size, row + (int64_t)(at - 1) * size);
        }
    }
    for (int64_t c = 0; c < columns; c++) slot[after[c]] = 0;
    if (!invert(dim, pivot, inverse)) return false;
    for (int64_t c = 0; c < columns; c++) {
        double w[9];
        memcpy(w, row + c * size, (size_t)size * sizeof *w);
        multiply(dim, false, inverse, w, row + c * size);
        shorten(dim, false, row + c * size, f->right + (f->upper[p] + c) * size);
    }
    return true;
}

typedef struct factor_work {
    brunt_incomplete *f;
    const brunt_block_matrix *a;
    double raise;
    int piece;                // the first of the level
    int32_t bad[BRUNT_SLABS]; // the place that broke down, -1: none
} factor_work;

static void factor_pieces(void *context, int64_t begin, int64_t end, int worker) {
    factor_work *w = context;
    brunt_incomplete *f = w->f;
    int32_t *slot = f->slot + (int64_t)worker * w->a->nodes;
    for (int64_t s = begin; s < end; s++) {
        const int32_t last = f->first[w->piece + s + 1];
        w->bad[s] = -1;
        for (int32_t p = f->first[w->piece + s]; p < last && w->bad[s] < 0; p++)
            if (!(w->a->dim == 2 ? factor_row(f, w->a, p, w->raise, slot, 2)
                                 : factor_row(f, w->a, p, w->raise, slot, 3)))
                w->bad[s] = p;
    }
}

typedef struct node_work {
    brunt_incomplete *f;
    const brunt_block_matrix *a;
    int32_t *bad; // of each worker: the first node that it found fault with, or BRUNT_NONE
} node_work;

// Runs a task over nodes: BRUNT_NONE, or the first node that it found fault with.
static int32_t over_nodes(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a,
                          brunt_task_fn *task) {
    int32_t bad[BRUNT_THREAD_LIMIT], first = BRUNT_NONE;
    node_work work = {f, a, bad};
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) bad[t] = BRUNT_NONE;
    brunt_parallel(team->threads, a->nodes, SIZE_GRAIN, task, &work, team->timer);
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++)
        if (bad[t] >= 0 && (first < 0 || bad[t] < first)) first = bad[t];
    return first;
}

static void blame(const node_work *w, int worker, int64_t node) {
    if (w->bad[worker] < 0 || node < w->bad[worker]) w->bad[worker] = (int32_t)node;
}

// Sizes of nodes: 1 over the root of the greatest diagonal entry. At fault: those that have none above 0.
static void take_sizes(void *context, int64_t begin, int64_t end, int worker) {
    const node_work *w = context;
    const int dim = w->a->dim;
    for (int64_t n = begin; n < end; n++) {
        const double *block = w->a->value + w->a->diagonal[n] * dim * dim;
        double most = 0;
        for (int i = 0; i < dim; i++) most = fmax(most, block[i * (dim + 1)]);
        if (most > 0 && isfinite(most))
            w->f->size[w->f->place[n]] = 1 / sqrt(most);
        else
            blame(w, worker, n);
    }
}

int32_t brunt_incomplete_factor(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a,
                                double raise) {
    factor_work work = {.f = f, .a = a, .raise = raise};
    const int32_t without = over_nodes(f, team, a, take_sizes);
    if (without >= 0) return without;
    for (int l = 0; l < f->levels; l++) {
        work.piece = l * f->slabs;
        brunt_parallel_each(team->threads, f->slabs, factor_pieces, &work, team->timer);
        for (int s = 0; s < f->slabs; s++)
            if (work.bad[s] >= 0) return f->order[work.bad[s]];
    }
    return BRUNT_NONE;
}

// ------------------------------------------------------------------------------------------ solutions

static void take_inverses(void *context, int64_t begin, int64_t end, int worker) {
    const node_work *w = context;
    const int dim = w->a->dim, size = dim * dim;
    for (int64_t n = begin; n < end; n++)
        if (!invert(dim, w->a->value + w->a->diagonal[n] * size, w->f->inverse + n * size)) blame(w, worker, n);
}

int32_t brunt_incomplete_jacobi(brunt_incomplete *f, const brunt_team *team, const brunt_block_matrix *a) {
    return over_nodes(f, team, a, take_inverses);
}

typedef struct apply_work {
    const brunt_incomplete *f;
    const double *r;
    double *z;
    int piece; // the first of the level
    bool up;
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

BRUNT_INLINE four times_2(const float *v, const double *y) {
    return four_of_floats(v) * (four){y[0], y[1], y[0], y[1]};
}

// The `count` blocks of a row from block k on, or (by -1) down from it, times what their columns have. Each row waits
// for the one before it: the nearest column comes last, and sums are in two chains and in registers.
BRUNT_INLINE two gather_2(const float *v, const int32_t *column, int64_t k, int64_t count, int by, const double *x) {
    four even = {0}, odd = {0};
    for (; count > 1; k += 2 * by, count -= 2) {
        even += times_2(v + 4 * k, x + 2 * (int64_t)column[k]);
        odd += times_2(v + 4 * (k + by), x + 2 * (int64_t)column[k + by]);
    }
    if (count > 0) even += times_2(v + 4 * k, x + 2 * (int64_t)column[k]);
    even += odd;
    return (two){even[0], even[2]} + (two){even[1], even[3]};
}

BRUNT_INLINE void add_times_3(four s[3], const float *v, const double *y) {
    for (int j = 0; j < 3; j++) s[j] += four_of_floats(v + 3 * j) * y[j];
}

BRUNT_INLINE four gather_3(const float *v, const int32_t *column, int64_t k, int64_t count, int by, const double *x) {
    four even[3] = {{0}, {0}, {0}}, odd[3] = {{0}, {0}, {0}};
    for (; count > 1; k += 2 * by, count -= 2) {
        add_times_3(even, v + 9 * k, x + 4 * (int64_t)column[k]);
        add_times_3(odd, v + 9 * (k + by), x + 4 * (int64_t)column[k + by]);
    }
    if (count > 0) add_times_3(even, v + 9 * k, x + 4 * (int64_t)column[k]);
    return (even[0] + odd[0]) + (even[1] + odd[1]) + (even[2] + odd[2]);
}

// (I + V)' y = r from the first place of a piece to its last. A row is written as wide as it is read, or wider: what a
// load has to put together of two stores costs more than the row.
static void substitute_down_2(const apply_work *w, int32_t begin, int32_t end) {
    const brunt_incomplete *f = w->f;
    for (int64_t p = begin; p < end; p++) {
        const int64_t from = f->lower[p];
        const two r = f->size[p] * two_load(w->r + 2 * (int64_t)f->order[p]);
        two_store(f->work + 2 * p, r - gather_2(f->left, f->before, from, f->lower[p + 1] - from, 1, f->work));
    }
}

static void substitute_down_3(const apply_work *w, int32_t begin, int32_t end) {
    const brunt_incomplete *f = w->f;
    for (int64_t p = begin; p < end; p++) {
        const int64_t from = f->lower[p];
        const double *r = w->r + 3 * (int64_t)f->order[p];
        const four scaled = f->size[p] * (four){r[0], r[1], r[2], 0};
        four_store(f->work + 4 * p, scaled - gather_3(f->left, f->before, from, f->lower[p + 1] - from, 1, f->work));
    }
}

// D (I + V) z = y from the last to the first; blocks of D are symmetric.
static void substitute_up_2(const apply_work *w, int32_t begin, int32_t end) {
    const brunt_incomplete *f = w->f;
    for (int64_t p = end - 1; p >= begin; p--) {
        const int64_t to = f->upper[p + 1];
        const double *inverse = f->inverse + 4 * p, *y = f->work + 2 * p;
        two x = two_load(inverse) * y[0] + two_load(inverse + 2) * y[1];
        x -= gather_2(f->right, f->after, to - 1, to - f->upper[p], -1, f->work);
        two_store(f->work + 2 * p, x);
        two_store(w->z + 2 * (int64_t)f->order[p], f->size[p] * x);
    }
}

static void substitute_up_3(const apply_work *w, int32_t begin, int32_t end) {
    const brunt_incomplete *f = w->f;
    for (int64_t p = end - 1; p >= begin; p--) {
        const int64_t to = f->upper[p + 1];
        const double *inverse = f->inverse + 9 * p, *y = f->work + 4 * p;
        double *z = w->z + 3 * (int64_t)f->order[p];
        four x = four_load(inverse) * y[0] + four_load(inverse + 3) * y[1] + four_load(inverse + 6) * y[2];
        x -= gather_3(f->right, f->after, to - 1, to - f->upper[p], -1, f->work);
        four_store(f->work + 4 * p, x);
        x *= f->size[p];
        z[0] = x[0], z[1] = x[1], z[2] = x[2];
    }
}

static void substitute_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const apply_work *w = context;
    const bool flat = w->f->a->dim == 2;
    for (int64_t s = begin; s < end; s++) {
        const int32_t *first = w->f->first + w->piece + s;
        if (w->up)
            flat ? substitute_up_2(w, first[0], first[1]) : substitute_up_3(w, first[0], first[1]);
        else
            flat ? substitute_down_2(w, first[0], first[1]) : substitute_down_3(w, first[0], first[1]);
    }
}

void brunt_incomplete_apply(const brunt_incomplete *f, const brunt_team *team, bool whole, const double *r, double *z) {
    apply_work work = {.f = f, .r = r, .z = z};
    if (!whole) {
        brunt_parallel(team->threads, f->a->nodes, JACOBI_GRAIN, apply_jacobi, &work, team->timer);
        return;
    }
    for (int step = 0; step < 2 * f->levels; step++) {
        work.up = step >= f->levels;
        work.piece = (work.up ? 2 * f->levels - 1 - step : step) * f->slabs;
        brunt_parallel_each(team->threads, f->slabs, substitute_pieces, &work, team->timer);
    }
}
