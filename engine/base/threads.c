#include "threads.h"

#include <omp.h>
#include <time.h>

enum { LEAST_PIECES = 4 };

double brunt_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int brunt_threads_available(void) { return omp_get_num_procs(); }

void brunt_parallel(int threads, int64_t count, int64_t grain, brunt_task_fn *task, void *context, double *seconds) {
    if (count <= 0) return;
    int64_t pieces = (count + grain - 1) / grain;
    // A thread that gets less than a few pieces costs more to wake and wait for than it saves.
    if (threads > pieces / LEAST_PIECES) threads = (int)(pieces / LEAST_PIECES);
    if (threads <= 1) {
        double start = seconds ? brunt_clock() : 0;
        task(context, 0, count, 0);
        if (seconds) seconds[0] += brunt_clock() - start;
        return;
    }
#pragma omp parallel num_threads(threads)
    {
        int worker = omp_get_thread_num();
        double start = seconds ? brunt_clock() : 0;
#pragma omp for schedule(dynamic, 1) nowait
        for (int64_t piece = 0; piece < pieces; piece++) {
            int64_t begin = piece * grain, end = begin + grain < count ? begin + grain : count;
            task(context, begin, end, worker);
        }
        if (seconds) seconds[worker] += brunt_clock() - start;
    }
}
