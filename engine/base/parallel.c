#include "base/parallel.h"

#include <omp.h>
#include <stdatomic.h>

#include "base/gain.h"

enum { LEAST_PIECES = 2 };

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
    int64_t first, count, grain; // tasks first .. first + count - 1
    brunt_task_fn *task;
    void *context;
} phase;

static bool adapts;                    // see brunt_parallel_adapt
static _Thread_local brunt_gain gains; // of what this thread starts

void brunt_parallel_adapt(bool on) { adapts = on; }

static atomic_int lent;           // threads at work beside the phases
static atomic_llong lends;        // how often that has changed
static _Thread_local bool beside; // this one is such a thread

static void lend(int threads) {
    atomic_fetch_add_explicit(&lent, threads, memory_order_relaxed);
    atomic_fetch_add_explicit(&lends, 1, memory_order_relaxed);
}

void brunt_parallel_beside(bool on) {
    if (on != beside) lend(on ? 1 : -1);
    beside = on;
}

void brunt_parallel_idle(bool on) {
    if (beside) lend(on ? -1 : 1);
}

// What `lends` was when the step began with all its threads; -1: with fewer.
static _Thread_local long long lends_at_begin;

void brunt_parallel_begin_step(int threads) {
    if (!adapts || threads == 1) return;
    const long long now = atomic_load_explicit(&lends, memory_order_relaxed);
    lends_at_begin = atomic_load_explicit(&lent, memory_order_relaxed) ? -1 : now;
    brunt_gain_begin_step(&gains, brunt_clock());
}

// With a thread fewer, steps that are shared take longer than they will when it is back.
bool brunt_parallel_end_step(int threads) {
    if (!adapts || threads == 1) return false;
    const bool counts = atomic_load_explicit(&lends, memory_order_relaxed) == lends_at_begin;
    brunt_gain_end_step(&gains, brunt_clock(), counts);
    return counts;
}

// Of so many as are asked for, those that are not lent.
static int threads_left(int threads) {
    const int left = threads - atomic_load_explicit(&lent, memory_order_relaxed);
    return left > 1 ? left : 1;
}

static void run_alone(const phase *p, span *spans) {
    spans[0].begin = brunt_clock();
    p->task(p->context, p->first, p->first + p->count, 0);
    spans[0].end = brunt_clock();
}

// Pieces that a worker takes before it helps the others: the same of each phase, so that what it wrote in one phase is
// near its core in the next. A cache line each.
typedef struct share {
    _Alignas(64) atomic_llong next;
    int64_t end;
} share;

static void take_pieces(const phase *p, share *s, int worker) {
    for (int64_t piece; (piece = atomic_fetch_add_explicit(&s->next, 1, memory_order_relaxed)) < s->end;) {
        const int64_t begin = piece * p->grain, end = begin + p->grain < p->count ? begin + p->grain : p->count;
        p->task(p->context, p->first + begin, p->first + end, worker);
    }
}

// Returns how many threads there were, which may be fewer than asked for.
static int run_together(int threads, const phase *p, bool timed, span *spans) {
    const int64_t pieces = (p->count + p->grain - 1) / p->grain;
    share shares[BRUNT_THREAD_LIMIT];
    for (int t = 0; t < threads; t++) {
        atomic_init(&shares[t].next, pieces * t / threads);
        shares[t].end = pieces * (t + 1) / threads;
    }
    int workers = 1;
#pragma omp parallel num_threads(threads)
    {
        int worker = omp_get_thread_num();
        if (worker == 0) workers = omp_get_num_threads();
        if (timed) spans[worker].begin = brunt_clock();
        for (int t = 0; t < threads; t++) take_pieces(p, &shares[(worker + t) % threads], worker);
        if (timed) spans[worker].end = brunt_clock();
    }
    return workers;
}

// Of a phase that has not been met its first piece, on this thread: what the rest will take is known by it, where there
// is room to remember it.
static void run_first_piece(phase *p) {
    const brunt_gain_choice choice = brunt_gain_choose(&gains, p->task, p->count);
    if (choice.task < 0 || choice.expected > 0 || p->count <= p->grain) return;
    const double begin = brunt_clock();
    p->task(p->context, p->first, p->first + p->grain, 0);
    const double end = brunt_clock();
    brunt_gain_learn(&gains, &choice, p->task, p->grain, end - begin, end - begin, end);
    p->first += p->grain, p->count -= p->grain;
}

// On one thread or on all, as has been the quicker way.
static int run_adapted(int threads, const phase *all, span *spans) {
    phase p = *all;
    int workers = 1;
    const double begun = brunt_clock();
    run_first_piece(&p);
    const brunt_gain_choice choice = brunt_gain_choose(&gains, p.task, p.count);
    const double begin = brunt_clock();
    if (choice.together)
        workers = run_together(threads, &p, true, spans);
    else
        run_alone(&p, spans);
    const double end = brunt_clock();
    double work = 0;
    for (int w = 0; w < workers; w++) work += spans[w].end - spans[w].begin;
    brunt_gain_learn(&gains, &choice, p.task, p.count, work, end - begin, end);
    if (p.first > all->first) spans[0].begin = begun;
    return workers;
}

static void run(int threads, const phase *p, brunt_timer *timer) {
    int workers = 1;
    span spans[BRUNT_THREAD_LIMIT];
    if (threads > 1)
        workers = adapts ? run_adapted(threads, p, spans) : run_together(threads, p, timer != NULL, spans);
    else if (timer)
        run_alone(p, spans);
    else
        p->task(p->context, p->first, p->first + p->count, 0);
    if (timer) account_times(timer, spans, workers);
}

void brunt_parallel(int threads, int64_t count, int64_t grain, brunt_task_fn *task, void *context, brunt_timer *timer) {
    if (count <= 0) return;
    threads = threads_left(threads);
    const int64_t pieces = (count + grain - 1) / grain;
    const phase p = {0, count, grain, task, context};
    // A thread that gets less than a few pieces costs more to wake and wait for than it saves.
    run(threads > pieces / LEAST_PIECES ? (int)(pieces / LEAST_PIECES) : threads, &p, timer);
}

void brunt_parallel_each(int threads, int64_t count, brunt_task_fn *task, void *context, brunt_timer *timer) {
    if (count <= 0) return;
    threads = threads_left(threads);
    const phase p = {0, count, 1, task, context};
    run(threads > count ? (int)count : threads, &p, timer);
}
