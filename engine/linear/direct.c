// The direct solvers: MUMPS, sequential, in the order of METIS. Cholesky's factors of symmetric matrices: it goes on
// past negative pivots and counts them; that count says whether the matrix is positive definite. LU factors of any
// other, with rows exchanged within fronts: pivots in which no digit is left are counted, and the matrix is singular.
#include <dlfcn.h>
#include <dmumps_c.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "linear/linear.h"
#include "linear/order.h"

enum { JOB_BEGIN = -1, JOB_END = -2, JOB_ANALYSE = 1, JOB_FACTOR = 2, JOB_SOLVE = 3 };
enum { COMM_WORLD = -987654, UNSYMMETRIC = 0, SYMMETRIC_DEFINITE = 1 };
// INFOG(1)
enum { NO_INTEGERS = -8, NO_REALS = -9, SINGULAR = -10, NO_MEMORY = -13, OVER_LIMIT = -19, SINGULAR_PATTERN = -6 };
enum { RELAXED = 30, RELAXED_LIMIT = 1000 }; // ICNTL(14) [%]: room beyond what the analysis asks for
enum { ROWS_AND_COLUMNS = 7 };               // ICNTL(8): each is scaled to a greatest entry of about 1
#define NO_DIGITS 1e-13                      // of a scaled pivot: what is left of the 1 that it was is rounding

typedef struct direct {
    DMUMPS_STRUC_C id;
    const brunt_block_matrix *a;
    int *row, *column, *order;   // of the entries that it is given, from 1; when each unknown is eliminated, from 1
    int32_t *position, *number;  // of each node; among those that couple with others, -1: it is alone
    int32_t coupled, alone;      // how many: MUMPS sees the coupled ones
    int32_t negative;            // pivots of the last factor
    double *value, *inverse, *x; // inverse blocks of nodes that are alone; x of the coupled ones
    size_t row_capacity, column_capacity, order_capacity, position_capacity, value_capacity, number_capacity,
        inverse_capacity, x_capacity;
    bool begun;
} direct;

// MUMPS numbers its arrays from 1 in what is written of it.
#define ICNTL(d, i) ((d)->id.icntl[(i)-1])
#define INFOG(d, i) ((d)->id.infog[(i)-1])
#define RINFOG(d, i) ((d)->id.rinfog[(i)-1])
#define CNTL(d, i) ((d)->id.cntl[(i)-1])

// The library, loaded for the first matrix. It has global variables: one call at a time.
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static void (*mumps)(DMUMPS_STRUC_C *); // dmumps_c

static void call(direct *d, int job) {
    d->id.job = job;
    pthread_mutex_lock(&one_at_a_time);
    mumps(&d->id);
    pthread_mutex_unlock(&one_at_a_time);
}

// OpenBLAS with threads of its own changes sums with their number, and is slower on the small blocks that are most.
static void one_thread_for_blas(void *library) {
    void (*set_threads)(int);
    void *found = dlsym(library, "openblas_set_num_threads");
    if (!found) return;
    memcpy(&set_threads, &found, sizeof found);
    set_threads(1);
}

static int load(brunt_error *error) {
    pthread_mutex_lock(&one_at_a_time);
    void *library = mumps ? NULL : dlopen(BRUNT_MUMPS, RTLD_NOW), *found = library ? dlsym(library, "dmumps_c") : NULL;
    if (found) {
        one_thread_for_blas(library);
        memcpy(&mumps, &found, sizeof found);
    }
    const int status = mumps ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "MUMPS cannot be loaded: %s.", dlerror());
    pthread_mutex_unlock(&one_at_a_time);
    return status;
}

static void *make(int symmetry, brunt_error *error) {
    direct *d;
    if (load(error) || BRUNT_NEW(d, 1, "the direct solver", error)) return NULL;
    d->id.par = 1, d->id.sym = symmetry, d->id.comm_fortran = COMM_WORLD;
    call(d, JOB_BEGIN);
    d->begun = INFOG(d, 1) >= 0;
    if (!d->begun) {
        brunt_fail(error, BRUNT_FAILED, "MUMPS could not be set up: INFOG(1) = %d.", INFOG(d, 1));
        brunt_free(d);
        return NULL;
    }
    for (int i = 1; i <= 4; i++) ICNTL(d, i) = i == 4 ? 0 : -1;   // prints nothing
    ICNTL(d, 6) = 0;                                              // no permutation of columns
    ICNTL(d, 7) = 1;                                              // the order is given
    ICNTL(d, 8) = symmetry == UNSYMMETRIC ? ROWS_AND_COLUMNS : 0; // Cholesky's factors scale with the matrix
    ICNTL(d, 10) = 0; // no refinement: residuals are 1e-14 of b without (Newton's next iteration is one)
    ICNTL(d, 13) = 1; // the last front as the others: its negative pivots count
    ICNTL(d, 14) = RELAXED;
    ICNTL(d, 28) = 1;                                                      // the analysis by one process
    if (symmetry == UNSYMMETRIC) ICNTL(d, 24) = 1, CNTL(d, 3) = NO_DIGITS; // pivots that vanish are counted
    return d;
}

static void *direct_make(brunt_error *error) { return make(SYMMETRIC_DEFINITE, error); }
static void *unsymmetric_make(brunt_error *error) { return make(UNSYMMETRIC, error); }

static void direct_free(void *self) {
    direct *d = self;
    if (d->begun) call(d, JOB_END);
    brunt_free(d->row), brunt_free(d->column), brunt_free(d->order), brunt_free(d->position), brunt_free(d->value);
    brunt_free(d->number), brunt_free(d->inverse), brunt_free(d->x);
    brunt_free(d);
}

static bool is_symmetric(const direct *d) { return d->id.sym == SYMMETRIC_DEFINITE; }

static brunt_linear_status out_of_memory(const brunt_block_matrix *a, brunt_error *error) {
    brunt_fail(error, BRUNT_FAILED, "Out of memory for the factors of a matrix of %lld unknowns.",
               (long long)a->nodes * a->dim);
    return BRUNT_LINEAR_FAILED;
}

// `rank`: of the nodes that couple, less what those that are alone have lost.
static brunt_linear_status singular(const direct *d, int rank, brunt_error *error) {
    const bool symmetric = is_symmetric(d);
    const int dim = d->a->dim;
    brunt_fail(error, BRUNT_FAILED, "The matrix is %ssingular, of rank %d of %d.",
               symmetric ? "not positive definite: it is " : "", rank + d->alone * dim, d->a->nodes * dim);
    return symmetric ? BRUNT_LINEAR_INDEFINITE : BRUNT_LINEAR_SINGULAR;
}

// What INFOG says went wrong in `job`.
static brunt_linear_status explain(const direct *d, const char *job, brunt_error *error) {
    const int code = INFOG(d, 1), more = INFOG(d, 2);
    if (code == SINGULAR || code == SINGULAR_PATTERN) return singular(d, more, error);
    if (code == NO_MEMORY || code == OVER_LIMIT || code == NO_REALS || code == NO_INTEGERS)
        return out_of_memory(d->a, error);
    brunt_fail(error, BRUNT_FAILED, "MUMPS failed to %s a matrix of %d unknowns: INFOG(1) = %d, INFOG(2) = %d.", job,
               d->id.n, code, more);
    return BRUNT_LINEAR_FAILED;
}

// Entries in the order of blocks, of symmetric matrices those of the upper triangle: where they are, or (places false)
// their values.
static int64_t take_entries(direct *d, const brunt_block_matrix *a, bool places) {
    const int dim = a->dim;
    const bool upper = is_symmetric(d);
    int64_t e = 0;
    for (int32_t r = 0; r < a->nodes; r++)
        for (int64_t k = upper ? a->diagonal[r] : a->first[r]; d->number[r] >= 0 && k < a->first[r + 1]; k++)
            for (int i = 0; i < dim; i++)
                for (int j = upper && k == a->diagonal[r] ? i : 0; j < dim; j++, e++) {
                    if (places)
                        d->row[e] = d->number[r] * dim + i + 1, d->column[e] = d->number[a->column[k]] * dim + j + 1;
                    else
                        d->value[e] = a->value[(k * dim + i) * dim + j];
                }
    return e;
}

static int64_t count_entries(const direct *d, const brunt_block_matrix *a) {
    const int64_t blocks = brunt_block_matrix_blocks(a) - d->alone, size = a->dim * a->dim;
    return is_symmetric(d) ? (blocks - d->coupled) / 2 * size + d->coupled * (size + a->dim) / 2 : blocks * size;
}

static brunt_linear_status number_nodes(direct *d, const brunt_block_matrix *a, brunt_error *error) {
    if (BRUNT_CAPACITY(d->position, (size_t)a->nodes, 0, "nodes in order", error) ||
        BRUNT_CAPACITY(d->number, (size_t)a->nodes, 0, "nodes in order", error) ||
        brunt_elimination_order(a, d->position, &d->coupled, error))
        return BRUNT_LINEAR_FAILED;
    if (!is_symmetric(d)) d->coupled = a->nodes; // a block may need its rows exchanged
    d->alone = a->nodes - d->coupled;
    for (int32_t n = 0, count = 0; n < a->nodes; n++) d->number[n] = d->position[n] < d->coupled ? count++ : -1;
    return BRUNT_CAPACITY(d->inverse, (size_t)(d->alone * a->dim * a->dim) + 1, 0, "nodes in order", error)
               ? BRUNT_LINEAR_FAILED
               : BRUNT_LINEAR_DONE;
}

// A symmetric block becomes its inverse, by Gauss and Jordan; pivots below zero are counted. How many were 0.
static int invert(int dim, double *a, int *negative) {
    int vanished = 0;
    for (int k = 0; k < dim; k++) {
        const double pivot = a[k * dim + k];
        if (pivot == 0 || !isfinite(pivot)) {
            vanished++;
            continue;
        }
        *negative += pivot < 0;
        a[k * dim + k] = 1;
        for (int j = 0; j < dim; j++) a[k * dim + j] /= pivot;
        for (int i = 0; i < dim; i++) {
            const double f = a[i * dim + k];
            if (i == k) continue;
            a[i * dim + k] = 0;
            for (int j = 0; j < dim; j++) a[i * dim + j] -= f * a[k * dim + j];
        }
    }
    return vanished;
}

// The same of all nodes that are alone.
static int invert_alone(direct *d, const brunt_block_matrix *a) {
    const int size = a->dim * a->dim;
    int vanished = 0;
    double *to = d->inverse;
    d->negative = 0;
    for (int32_t n = 0; d->alone && n < a->nodes; n++) {
        if (d->number[n] >= 0) continue;
        memcpy(to, a->value + a->diagonal[n] * size, (size_t)size * sizeof *to);
        vanished += invert(a->dim, to, &d->negative);
        to += size;
    }
    return vanished;
}

// Solutions of nodes that are alone, in place.
static void solve_alone(const direct *d, const brunt_block_matrix *a, double *x) {
    const double *block = d->inverse;
    for (int32_t n = 0; n < a->nodes; n++) {
        double b[3];
        if (d->number[n] >= 0) continue;
        memcpy(b, x + n * (int64_t)a->dim, (size_t)a->dim * sizeof *b);
        for (int i = 0; i < a->dim; i++) {
            double sum = 0;
            for (int j = 0; j < a->dim; j++) sum += block[i * a->dim + j] * b[j];
            x[n * (int64_t)a->dim + i] = sum;
        }
        block += a->dim * a->dim;
    }
}

// To x of the coupled nodes, or back from it.
static void move_coupled(const direct *d, const brunt_block_matrix *a, bool back, double *x, double *coupled) {
    for (int32_t n = 0; n < a->nodes; n++)
        for (int i = 0; d->number[n] >= 0 && i < a->dim; i++) {
            double *all = &x[n * (int64_t)a->dim + i], *own = &coupled[d->number[n] * (int64_t)a->dim + i];
            *(back ? all : own) = back ? *own : *all;
        }
}

static int64_t memory_of_machine(void) {
    const int64_t bytes = (int64_t)sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE) - (int64_t)brunt_memory_live();
    return bytes > 0 ? bytes : 0;
}

static brunt_linear_status check_memory(brunt_linear *s, brunt_error *error) {
    const direct *d = s->self;
    const int64_t limit = s->options.memory ? s->options.memory : memory_of_machine();
    const double entries = INFOG(d, 20);
    s->report.entries = entries < 0 ? -1e6 * entries : entries;
    s->report.memory = (int64_t)fmax(1e6 * INFOG(d, 17), 8 * s->report.entries); // it counts whole megabytes
    s->report.flops = RINFOG(d, 1);
    if (s->report.memory <= limit) return BRUNT_LINEAR_DONE;
    brunt_fail(error, BRUNT_FAILED,
               "The direct solver would take %.3g GB for %d unknowns, and there are %.3g GB: pcg takes less.",
               (double)s->report.memory * 1e-9, d->id.n, (double)limit * 1e-9);
    return BRUNT_LINEAR_FAILED;
}

static brunt_linear_status direct_analyse(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                          brunt_error *error) {
    (void)team;
    direct *d = s->self;
    d->a = a;
    if ((int64_t)a->nodes * a->dim > INT32_MAX) {
        brunt_fail(error, BRUNT_FAILED, "The direct solver takes up to %d unknowns; these are %lld.", INT32_MAX,
                   (long long)a->nodes * a->dim);
        return BRUNT_LINEAR_FAILED;
    }
    static const char values[] = "entries of a matrix to factor";
    if (number_nodes(d, a, error) != BRUNT_LINEAR_DONE) return BRUNT_LINEAR_FAILED;
    const int64_t unknowns = (int64_t)d->coupled * a->dim, entries = count_entries(d, a);
    if (BRUNT_CAPACITY(d->row, (size_t)entries, 0, values, error) ||
        BRUNT_CAPACITY(d->column, (size_t)entries, 0, values, error) ||
        BRUNT_CAPACITY(d->value, (size_t)entries, 0, values, error) ||
        BRUNT_CAPACITY(d->order, (size_t)unknowns, 0, "unknowns in order", error) ||
        BRUNT_CAPACITY(d->x, d->alone ? (size_t)unknowns : 1, 0, "unknowns in order", error))
        return BRUNT_LINEAR_FAILED;
    for (int32_t n = 0; n < a->nodes; n++)
        for (int c = 0; d->number[n] >= 0 && c < a->dim; c++)
            d->order[d->number[n] * a->dim + c] = d->position[n] * a->dim + c + 1;
    if (d->coupled == 0) return BRUNT_LINEAR_DONE;
    d->id.n = (int)unknowns, d->id.nnz = take_entries(d, a, true);
    BRUNT_ASSERT(d->id.nnz == entries);
    d->id.irn = d->row, d->id.jcn = d->column, d->id.a = d->value, d->id.perm_in = d->order;
    ICNTL(d, 14) = RELAXED;
    call(d, JOB_ANALYSE);
    return INFOG(d, 1) < 0 ? explain(d, "analyse", error) : check_memory(s, error);
}

static brunt_linear_status factorise(brunt_linear *s, const brunt_block_matrix *a, brunt_error *error) {
    direct *d = s->self;
    d->a = a;
    const int lost = invert_alone(d, a);
    if (lost) return singular(d, d->coupled * a->dim - lost, error);
    if (d->coupled == 0) return BRUNT_LINEAR_DONE;
    take_entries(d, a, false);
    call(d, JOB_FACTOR);
    while ((INFOG(d, 1) == NO_REALS || INFOG(d, 1) == NO_INTEGERS) && ICNTL(d, 14) < RELAXED_LIMIT) {
        ICNTL(d, 14) *= 2; // its estimate was short
        call(d, JOB_FACTOR);
    }
    d->negative += INFOG(d, 12);
    return INFOG(d, 1) < 0 ? explain(d, "factorise", error) : BRUNT_LINEAR_DONE;
}

static brunt_linear_status direct_factor(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                         brunt_error *error) {
    (void)team;
    const direct *d = s->self;
    const brunt_linear_status status = factorise(s, a, error);
    if (status != BRUNT_LINEAR_DONE) return status;
    s->report.negative = d->negative;
    if (s->report.negative == 0) return BRUNT_LINEAR_DONE;
    brunt_fail(error, BRUNT_FAILED, "The matrix is not positive definite: %d of %d pivots are negative.",
               s->report.negative, a->nodes * a->dim);
    return BRUNT_LINEAR_INDEFINITE;
}

static brunt_linear_status unsymmetric_factor(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                              brunt_error *error) {
    (void)team;
    const direct *d = s->self;
    const brunt_linear_status status = factorise(s, a, error);
    if (status != BRUNT_LINEAR_DONE) return status;
    const int vanished = d->coupled ? INFOG(d, 28) : 0;
    return vanished ? singular(d, d->id.n - vanished, error) : BRUNT_LINEAR_DONE;
}

// Right sides of the coupled nodes, and then their solutions.
static brunt_linear_status solve_coupled(direct *d, int count, double *x, brunt_error *error) {
    d->id.rhs = x, d->id.nrhs = count, d->id.lrhs = d->id.n;
    call(d, JOB_SOLVE);
    if (INFOG(d, 1) < 0) return explain(d, "solve with", error);
    for (int64_t i = 0; i < (int64_t)count * d->id.n; i++)
        if (!isfinite(x[i])) {
            brunt_fail(error, BRUNT_FAILED, "The matrix is %s: unknown %d has no finite solution.",
                       is_symmetric(d) ? "not positive definite" : "singular", (int)(i % d->id.n));
            return is_symmetric(d) ? BRUNT_LINEAR_INDEFINITE : BRUNT_LINEAR_SINGULAR;
        }
    return BRUNT_LINEAR_DONE;
}

static brunt_linear_status direct_many(brunt_linear *s, const brunt_team *team, int count, double *x,
                                       brunt_error *error) {
    (void)team;
    direct *d = s->self;
    const brunt_block_matrix *a = d->a;
    if (!d->alone) return solve_coupled(d, count, x, error);
    for (int k = 0; k < count; k++, x += (int64_t)a->nodes * a->dim) {
        solve_alone(d, a, x);
        if (d->coupled == 0) continue;
        move_coupled(d, a, false, x, d->x);
        const brunt_linear_status status = solve_coupled(d, 1, d->x, error);
        if (status != BRUNT_LINEAR_DONE) return status;
        move_coupled(d, a, true, x, d->x);
    }
    return BRUNT_LINEAR_DONE;
}

static brunt_linear_status direct_solve(brunt_linear *s, const brunt_team *team, const double *b, double *x,
                                        brunt_error *error) {
    const direct *d = s->self;
    memcpy(x, b, (size_t)d->a->nodes * (size_t)d->a->dim * sizeof *x);
    return direct_many(s, team, 1, x, error);
}

const brunt_linear_ops brunt_linear_direct = {"direct",     direct_make, direct_analyse, direct_factor,
                                              direct_solve, direct_free, direct_many};
const brunt_linear_ops brunt_linear_unsymmetric = {"unsymmetric", unsymmetric_make, direct_analyse, unsymmetric_factor,
                                                   direct_solve,  direct_free,      direct_many};
