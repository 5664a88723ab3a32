#include "base/parallel.h"

#include <omp.h>

enum { LEAST_PIECES = 4 };

int brunt_threads_available(void) { return omp_get_num_procs(); }

typedef struct span {
    double begin, end; // [s]
} span;

// By the thread that started the phase, after the others have joined it: observers need no locks.
static void account_times(brunt_timer *timer, const span *spans, int workers) {
    const brunt_observer *observer = timer->observer;
    for (int w = 0; w < workers; w++) {
        timer->seconds[w] += spans[w].end - spans[w].begin;
        if (observer) observer->thread(observer->context, timer->pass, w, spans[w].begin, spans[w].end);
    }
}

typedef struct phase {
    int64_t count, grain;
    brunt_task_fn *task;
    void *context;
} phase;

static void run(int threads, const phase *p, brunt_timer *timer) {
    const int64_t pieces = (p->count + p->grain - 1) / p->grain;
    int workers = 1; // may be fewer than asked for
    span spans[BRUNT_THREAD_LIMIT];
    if (threads <= 1) {
        if (timer) spans[0].begin = brunt_clock();
        p->task(p->context, 0, p->count, 0);
        if (timer) spans[0].end = brunt_clock();
    } else {
#pragma omp parallel num_threads(threads)
        {
            int worker = omp_get_thread_num();
            if (worker == 0) workers = omp_get_num_threads();
            if (timer) spans[worker].begin = brunt_clock();
#pragma omp for schedule(dynamic, 1) nowait
            for (int64_t piece = 0; piece < pieces; piece++) {
                int64_t begin = piece * p->grain, end = begin + p->grain < p->count ? begin + p->grain : p->count;
                p->task(p->context, begin, end, worker);
            }
            if (timer) spans[worker].end = brunt_clock();
        }
    }
    if (timer) account_times(timer, spans, workers);
}

void brunt_parallel(int threads, int64_t count, int64_t grain, brunt_task_fn *task, void *context, brunt_timer *timer) {
    if (count <= 0) return;
    const int64_t pieces = (count + grain - 1) / grain;
    const phase p = {count, grain, task, context};
    // A thread that gets less than a few pieces costs more to wake and wait for than it saves.
    run(threads > pieces / LEAST_PIECES ? (int)(pieces / LEAST_PIECES) : threads, &p, timer);
}

void brunt_parallel_each(int threads, int64_t count, brunt_task_fn *task, void *context, brunt_timer *timer) {
    if (count <= 0) return;
    const phase p = {count, 1, task, context};
    run(threads > count ? (int)count : threads, &p, timer);
}
