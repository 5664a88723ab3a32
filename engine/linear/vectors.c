#include "linear/vectors.h"

enum { GRAIN = 1 }; // pieces that a thread takes at a time: some microseconds

typedef struct vector_work {
    int64_t count;
    double a, b;
    const double *x;
    double *y, *p;
    const double *z;
    double *sums;
} vector_work;

static void dot_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const vector_work *w = context;
    for (int64_t p = begin; p < end; p++) {
        const int64_t from = p * BRUNT_SUM_PIECE, rest = w->count - from,
                      n = rest < BRUNT_SUM_PIECE ? rest : BRUNT_SUM_PIECE;
        const double *x = w->x + from, *z = w->z + from;
        double s[4] = {0}; // side by side: adding is slower than multiplying is
        int64_t i = 0;
        for (; i + 4 <= n; i += 4)
            for (int l = 0; l < 4; l++) s[l] += x[i + l] * z[i + l];
        for (; i < n; i++) s[0] += x[i] * z[i];
        w->sums[p] = (s[0] + s[1]) + (s[2] + s[3]);
    }
}

double brunt_dot(const brunt_team *team, int64_t count, const double *a, const double *b, double *sums) {
    const int64_t pieces = brunt_sum_pieces(count);
    vector_work work = {.count = count, .x = a, .z = b, .sums = sums};
    brunt_parallel(team->threads, pieces, GRAIN, dot_pieces, &work, team->timer);
    double sum = 0;
    for (int64_t p = 0; p < pieces; p++) sum += sums[p];
    return sum;
}

static void add_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const vector_work *w = context;
    const int64_t to = end * BRUNT_SUM_PIECE < w->count ? end * BRUNT_SUM_PIECE : w->count;
    for (int64_t i = begin * BRUNT_SUM_PIECE; i < to; i++) w->y[i] += w->a * w->x[i];
}

void brunt_add_scaled(const brunt_team *team, int64_t count, double a, const double *x, double *y) {
    vector_work work = {.count = count, .a = a, .x = x, .y = y};
    brunt_parallel(team->threads, brunt_sum_pieces(count), GRAIN, add_pieces, &work, team->timer);
}

static void turn_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const vector_work *w = context;
    const int64_t to = end * BRUNT_SUM_PIECE < w->count ? end * BRUNT_SUM_PIECE : w->count;
    for (int64_t i = begin * BRUNT_SUM_PIECE; i < to; i++) {
        w->y[i] += w->a * w->p[i];
        w->p[i] = w->z[i] + w->b * w->p[i];
    }
}

void brunt_add_and_turn(const brunt_team *team, int64_t count, double a, double *p, double *y, double b,
                        const double *z) {
    vector_work work = {.count = count, .a = a, .b = b, .p = p, .y = y, .z = z};
    brunt_parallel(team->threads, brunt_sum_pieces(count), GRAIN, turn_pieces, &work, team->timer);
}
