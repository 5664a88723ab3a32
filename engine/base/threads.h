// The one wrapper around OpenMP. A parallel phase is a function over a range of tasks; a task writes only its own
// slots, so results do not depend on which thread runs it. Sums over tasks are taken afterwards, in task order.
#pragma once

#include <stdint.h>

// Work on tasks [begin, end) as `worker` (0 .. threads-1).
typedef void brunt_task_fn(void *context, int64_t begin, int64_t end, int worker);

// Runs all tasks [0, count) in pieces of `grain`, on `threads` threads. If `seconds` is not NULL, adds each worker's
// time to seconds[worker].
void brunt_parallel(int threads, int64_t count, int64_t grain, brunt_task_fn *task, void *context, double *seconds);

int brunt_threads_available(void);

// Monotonic time [s].
double brunt_clock(void);
