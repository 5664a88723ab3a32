// The one wrapper around OpenMP. A parallel phase is a function over a range of tasks; a task writes only its own
// slots, so results do not depend on which thread runs it. Sums over tasks are taken afterwards, in task order.
#pragma once

#include <stdint.h>

#include "brunt.h"

// Work on tasks [begin, end) as `worker` (0 .. threads-1).
typedef void brunt_task_fn(void *context, int64_t begin, int64_t end, int worker);

// Where the time of parallel phases goes. Nothing is kept of the single phase: a listener is told after it.
typedef struct brunt_timer {
    double seconds[BRUNT_THREAD_LIMIT]; // [s] that each worker was at work
    const brunt_observer *observer;     // told when each worker began and ended; NULL: none is
    int32_t pass;                       // what the observer knows the phases by
} brunt_timer;

// Runs all tasks [0, count) in pieces of `grain`, on at most `threads` threads (1 .. BRUNT_THREAD_LIMIT). `timer`: NULL
// when the time is not wanted; else two readings of the clock a worker.
void brunt_parallel(int threads, int64_t count, int64_t grain, brunt_task_fn *task, void *context, brunt_timer *timer);

// The same for tasks each of which is worth a thread.
void brunt_parallel_each(int threads, int64_t count, brunt_task_fn *task, void *context, brunt_timer *timer);

int brunt_threads_available(void);

// Whether threads are left out of phases that take no shorter with them, as measured (base/gain.h): of all that is run
// from now on, by whichever thread. Off at first: what is asked for is what is used.
void brunt_parallel_adapt(bool on);

// Begin and end of a step of a run on so many threads, all of whose steps do about the same: whether threads are left
// out of all of its phases is measured, too. Of phases that are all used as they are asked for it does nothing. Whether
// the step was measured: one that other threads were at work beside is not.
void brunt_parallel_begin_step(int threads);
bool brunt_parallel_end_step(int threads);

// This thread is at work beside the phases that others start, until it says off: they take one thread fewer each, one
// at least, so that with it there are no more at work than were asked for.
void brunt_parallel_beside(bool on);
// Such a thread waits for the disk, and the phases have all their threads meanwhile. Of any other thread it does
// nothing.
void brunt_parallel_idle(bool on);

// Monotonic time [s].
double brunt_clock(void);
