// OpenMP is used here directly: each thread works on the memory that it touched first (on machines with several
// memories that is its own), which the pieces of brunt_parallel, taken by whoever is free, do not promise.
#include "io/performance/roofline.h"

#include <omp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/error.h"
#include "base/real.h"
#include "base/parallel.h"

// The widest vectors of the build's target, whatever the kernels use (BRUNT_LANES).
#if defined __AVX512F__
enum { VECTOR_BYTES = 64 };
#elif defined __AVX__
enum { VECTOR_BYTES = 32 };
#else
enum { VECTOR_BYTES = 16 };
#endif
typedef real vector __attribute__((vector_size(VECTOR_BYTES)));
enum { VECTOR_REALS = VECTOR_BYTES / sizeof(real) };

enum {
    REPEATS = 8,
    // Two multiply-adds a cycle that take four each want eight chains; with the two constants twelve still fit the
    // sixteen registers of AVX2.
    CHAINS = 12,
    LINKS = 400000 // of a chain in one repeat: about a millisecond
};
static const size_t least_array = (size_t)64 << 20, greatest_array = (size_t)256 << 20; // [bytes]

typedef struct roofline {
    vector *a, *b, *c;
    size_t count; // vectors of each
    int threads;
    double triad, chains;      // [s] best of the repeats
    volatile real one, little; // read at run time, or the compiler would do the sums itself
    volatile real sink;
} roofline;

static void least(double *best, double seconds) {
    if (!(*best > 0) || seconds < *best) *best = seconds;
}

// a = b + s c on vectors begin .. end-1.
static void triad(vector *restrict a, const vector *restrict b, const vector *restrict c, real s, size_t begin,
                  size_t end) {
    for (size_t i = begin; i < end; i++) a[i] = b[i] + s * c[i];
}

// Chains x = x s + t, which tend to t / (1 - s): neither large nor subnormal.
static real chains(real s, real t) {
    vector x[CHAINS];
    for (int k = 0; k < CHAINS; k++) x[k] = (real)k - (vector){0};
    for (int n = 0; n < LINKS; n++)
        for (int k = 0; k < CHAINS; k++) x[k] = x[k] * s + t;
    real sum = 0;
    for (int k = 0; k < CHAINS; k++)
        for (int l = 0; l < VECTOR_REALS; l++) sum += x[k][l];
    return sum;
}

static void measure(roofline *r) {
#pragma omp parallel num_threads(r->threads)
    {
        const size_t thread = (size_t)omp_get_thread_num(), threads = (size_t)omp_get_num_threads();
        const size_t begin = r->count * thread / threads, end = r->count * (thread + 1) / threads;
        const real s = r->one - r->little, t = r->little;
        for (size_t i = begin; i < end; i++) r->a[i] = r->b[i] = r->c[i] = t - (vector){0};
        for (int n = 0; n < REPEATS; n++) {
#pragma omp barrier
            double start = brunt_clock();
            triad(r->a, r->b, r->c, s, begin, end);
#pragma omp barrier
            double middle = brunt_clock();
            real sum = chains(s, t);
#pragma omp barrier
            double stop = brunt_clock();
#pragma omp critical
            r->sink = sum + r->a[begin][0];
            if (thread) continue;
            least(&r->triad, middle - start);
            least(&r->chains, stop - middle);
        }
    }
}

static size_t array_bytes(void) {
    long cache = sysconf(_SC_LEVEL3_CACHE_SIZE);
    size_t bytes = cache > 0 ? 2 * (size_t)cache : 0; // three of them: six times the cache
    return bytes < least_array ? least_array : bytes > greatest_array ? greatest_array : bytes;
}

int brunt_roofline_measure(int threads, double *bytes_per_second, double *flops_per_second, brunt_error *error) {
    const size_t bytes = array_bytes();
    // Not of brunt_alloc, which zeroes: the thread that does so would have touched all of it first.
    void *memory = mmap(NULL, 3 * bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) return brunt_fail_memory(error, "bytes to measure the machine with", 3 * bytes, 1);
    madvise(memory, 3 * bytes, MADV_HUGEPAGE);
    vector *first = memory;
    roofline r = {
        .count = bytes / sizeof(vector), .threads = threads > 0 ? threads : 1, .one = 1, .little = (real)1e-3};
    r.a = first, r.b = first + r.count, r.c = first + 2 * r.count;
    measure(&r);
    munmap(memory, 3 * bytes);
    *bytes_per_second = 4.0 * (double)bytes / r.triad;
    *flops_per_second = 2.0 * CHAINS * LINKS * VECTOR_REALS * (double)r.threads / r.chains;
    return BRUNT_OK;
}
