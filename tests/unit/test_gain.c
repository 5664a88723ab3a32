// Labels: double
// Whether threads pay (base/gain.h), on machines that are made up: no clock is read but where phases are really run.
#include "tests/support/suite.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/gain.h"

// What a phase takes on a machine [s]: work on one thread, and together; a thread more costs `wake` whenever it is
// asked.
typedef struct machine {
    double alone, together; // times the work
    double wake;            // [s]
} machine;

static const machine quiet = {1, 1 / 1.9, 8e-6}, busy = {4, 11, 4e-3}, loses = {1, 1.2, 0}, meagre = {1, 1 / 1.4, 0},
                     alike = {1, 1, 0};

static double phase_time(const machine *m, bool together, double work) {
    return together ? m->together * work + m->wake : m->alone * work;
}

static void task(void *context, int64_t begin, int64_t end, int worker) {
    (void)context, (void)begin, (void)end, (void)worker;
}

typedef struct stay {
    double now, taken, best, worst; // [s]
    int64_t phases, together;
} stay;

// Phases of one size on a machine, for so many seconds.
static void stay_on(brunt_gain *gain, const machine *m, double work, double seconds, stay *at) {
    const double end = at->now + seconds;
    while (at->now < end) {
        const brunt_gain_choice choice = brunt_gain_choose(gain, task, 100);
        const double alone = phase_time(m, false, work), shared = phase_time(m, true, work),
                     taken = choice.together ? shared : alone;
        at->now += taken, at->taken += taken, at->best += fmin(alone, shared), at->worst += fmax(alone, shared);
        at->phases++, at->together += choice.together;
        brunt_gain_learn(gain, &choice, task, 100, work, taken, at->now);
    }
}

static const double sizes[] = {0.5e-6, 2e-6, 9e-6, 20e-6, 70e-6, 300e-6, 2e-3, 11e-3, 60e-3};
enum { SIZES = sizeof sizes / sizeof *sizes };

// To a few per cent the time of the quicker way, on machines that do not change.
START_TEST(the_quicker_way_is_found) {
    static const machine *const machines[] = {&quiet, &busy, &loses, &alike};
    for (int m = 0; m < 4; m++)
        for (int k = 0; k < SIZES; k++) {
            brunt_gain gain = {0};
            stay begin = {0}, at = {0};
            const double seconds = fmin(10, 3e6 * sizes[k]); // of small phases as many as tell
            stay_on(&gain, machines[m], sizes[k], seconds, &begin);
            at.now = begin.now;
            stay_on(&gain, machines[m], sizes[k], 2 * seconds, &at);
            printf("  %d %.1e s: %.3f of the quicker way (%.3f at first), %.3f of the slower\n", m, sizes[k],
                   at.taken / at.best, begin.taken / begin.best, at.taken / at.worst);
            ck_assert_double_le(at.taken, 1.03 * at.best);
            ck_assert_double_le(begin.taken, 1.25 * begin.best);
        }
}
END_TEST

// A machine that others begin to use, and leave again: it is noticed in both directions.
START_TEST(machines_change) {
    static const double some[] = {70e-6, 2e-3, 2e-3};
    for (int k = 0; k < 3; k++) {
        brunt_gain gain = {0};
        stay at = {0};
        for (int turn = 0; turn < 6; turn++) {
            stay one = {.now = at.now};
            stay_on(&gain, turn % 2 ? &busy : k < 2 ? &quiet : &meagre, some[k], 20, &one);
            at.now = one.now;
            printf("  %.0e s, %s: %.3f of the quicker way\n", some[k], turn % 2 ? "busy" : "quiet",
                   one.taken / one.best);
            ck_assert_double_le(one.taken, 1.12 * one.best);
        }
    }
}
END_TEST

// Where threads share all but a rest of the work, the other way is not tried at all.
START_TEST(what_is_sure_is_not_tried) {
    brunt_gain gain = {0};
    stay at = {0};
    stay_on(&gain, &quiet, 2e-3, 20, &at);
    ck_assert_int_eq(at.together, at.phases);
}
END_TEST

// A quiet machine that stops now and then for some milliseconds, whatever runs: no reason to give up a thread for long.
START_TEST(pauses_of_the_machine_are_borne) {
    static const double some[] = {70e-6, 500e-6, 2e-3, 11e-3};
    for (int k = 0; k < 4; k++) {
        brunt_gain gain = {0};
        double now = 0, taken = 0, best = 0, stop = 0.1;
        uint64_t random = 1;
        while (now < 120) {
            const brunt_gain_choice choice = brunt_gain_choose(&gain, task, 100);
            const double shared = phase_time(&quiet, true, some[k]);
            double one = phase_time(&quiet, choice.together, some[k]);
            best += shared;
            taken += one;
            if (now >= stop) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                stop = now + 0.6 * (double)(random >> 40) / (1 << 24);
                one += 20e-3;
            }
            now += one;
            brunt_gain_learn(&gain, &choice, task, 100, some[k], one, now);
        }
        printf("  %.1e s: %.3f of two threads\n", some[k], taken / best);
        ck_assert_double_le(taken, 1.06 * best);
    }
}
END_TEST

// On a machine that is busy from the start a short run is not over before that is known: of the first phases that are
// shared a few, and no more. What costs more together by a little is looked at for a whole window.
START_TEST(first_phases_in_vain_are_few) {
    static const double some[] = {70e-6, 300e-6};
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++) {
            brunt_gain gain = {0};
            stay at = {0};
            stay_on(&gain, m ? &loses : &busy, some[k], 1e-9, &at);
            const int64_t first = at.together;
            int64_t together = first;
            while (at.together == together && together < 1000) {
                const int64_t before = at.together;
                stay_on(&gain, m ? &loses : &busy, some[k], 1e-9, &at);
                if (at.together == before) break;
                together = at.together;
            }
            printf("  %.0e s on a machine %s: %lld phases are shared before one is not\n", some[k],
                   m ? "that loses" : "in use", (long long)together);
            ck_assert_int_ge(together, m ? 16 : 2);
            ck_assert_int_le(together, m ? 200 : 4);
        }
}
END_TEST

// One phase in thirty waits ten milliseconds for a thread that was left out: the mean counts, not most.
START_TEST(rare_waits_count) {
    brunt_gain gain = {0};
    int64_t together = 0, phases = 0;
    double now = 0;
    for (; now < 60; phases++) {
        const brunt_gain_choice choice = brunt_gain_choose(&gain, task, 10);
        const double taken = choice.together ? 60e-6 + (phases % 30 == 0 ? 10e-3 : 0) : 100e-6;
        now += taken, together += choice.together;
        brunt_gain_learn(&gain, &choice, task, 10, 100e-6, taken, now);
    }
    ck_assert_double_lt((double)together, 0.02 * (double)phases);
}
END_TEST

// A thread that the machine left out for a second has not done a second's work: what a unit costs is known still.
START_TEST(costs_survive_a_pause) {
    brunt_gain gain = {0};
    for (int k = 0; k < 200; k++) {
        const brunt_gain_choice choice = brunt_gain_choose(&gain, task, 1000);
        if (k > 20) ck_assert_double_lt(fabs(choice.expected / 50e-6 - 1), k > 100 && k < 140 ? 0.2 : 0.01);
        brunt_gain_learn(&gain, &choice, task, 1000, k == 100 ? 1 : 50e-6, 30e-6, 1e-4 * k);
    }
    // And what has become dearer is known soon.
    for (int k = 0; k < 100; k++) {
        const brunt_gain_choice choice = brunt_gain_choose(&gain, task, 1000);
        brunt_gain_learn(&gain, &choice, task, 1000, 500e-6, 300e-6, 1);
    }
    ck_assert_double_lt(fabs(brunt_gain_choose(&gain, task, 1000).expected / 500e-6 - 1), 0.01);
}
END_TEST

// Twice as much of the same is known beforehand; tasks do not know of one another; more tasks than there is room for
// are run as asked.
START_TEST(tasks_are_told_apart) {
    static brunt_gain gain;
    for (int k = 1; k <= BRUNT_GAIN_TASKS + 50; k++) {
        brunt_task_fn *one = (brunt_task_fn *)(uintptr_t)(16 * k);
        const brunt_gain_choice choice = brunt_gain_choose(&gain, one, 10);
        ck_assert(choice.together && !(choice.expected > 0));
        ck_assert_int_eq(choice.task<0, k> BRUNT_GAIN_TASKS);
        brunt_gain_learn(&gain, &choice, one, 10, 1e-6 * k, 1e-6 * k, 1);
    }
    for (int k = 1; k <= BRUNT_GAIN_TASKS; k++) {
        const double expected = brunt_gain_choose(&gain, (brunt_task_fn *)(uintptr_t)(16 * k), 20).expected;
        ck_assert_double_lt(fabs(expected - 2e-6 * k), 1e-12);
    }
}
END_TEST

// Steps of one long phase and ten short ones, which begin on one core: where the long one is shared, half of what it
// wrote is with the other core, and the short ones take `far` times as long.
typedef struct mixture {
    double shared; // of its work, that the long phase takes on two threads
    double far;
    double size; // of all phases
} mixture;

static const mixture drags = {0.75, 1.6, 1}, pays = {0.52, 1.02, 1};
enum { SHORT_PHASES = 10 };
static const double LONG = 100e-6, SHORT = 10e-6;

static void short_task(void *context, int64_t begin, int64_t end, int worker) { task(context, begin, end, worker); }

static double run_phase(brunt_gain *gain, brunt_task_fn *of, double work, const double takes[2], double *now) {
    const brunt_gain_choice choice = brunt_gain_choose(gain, of, 100);
    *now += takes[choice.together];
    brunt_gain_learn(gain, &choice, of, 100, work, takes[choice.together], *now);
    return choice.together;
}

// Steps for so many seconds, `marked` or not. What they took of those on one thread; `*share`: of those that shared.
static double take_steps(brunt_gain *gain, const mixture *m, bool marked, double seconds, double *now, double *share) {
    const double begin = *now, work = m->size * LONG, both[2] = {work, m->shared * work};
    int64_t steps = 0, shared = 0;
    for (; *now < begin + seconds; steps++) {
        if (marked) brunt_gain_begin_step(gain, *now);
        const bool long_one = run_phase(gain, task, work, both, now) > 0;
        const double alone = (long_one ? m->far : 1) * m->size * SHORT, either[2] = {alone, 2 * alone};
        for (int k = 0; k < SHORT_PHASES; k++) run_phase(gain, short_task, alone, either, now);
        if (marked) brunt_gain_end_step(gain, *now, true);
        shared += long_one;
    }
    *share = (double)shared / (double)steps;
    return (*now - begin) / ((double)steps * m->size * (LONG + SHORT_PHASES * SHORT));
}

// What a phase gains and the others lose by it is seen of whole steps alone.
START_TEST(steps_count_as_a_whole) {
    brunt_gain apart = {0}, whole = {0};
    double now = 1, share, then = 1;
    const double phases = take_steps(&apart, &drags, false, 20, &now, &share);
    const double first = take_steps(&whole, &drags, true, 2, &then, &share);
    const double steps = take_steps(&whole, &drags, true, 20, &then, &share);
    printf("  phases by themselves %.3f of one thread, steps %.3f (%.3f at first)\n", phases, steps, first);
    ck_assert_double_gt(phases, 1.1);
    ck_assert_double_lt(steps, 1.01);
    ck_assert_double_lt(first, 1.02);
    // Outside of steps a phase is measured by itself.
    ck_assert_int_ge(brunt_gain_choose(&whole, task, 100).size, 0);
    brunt_gain_begin_step(&whole, then);
    ck_assert_int_lt(brunt_gain_choose(&whole, task, 100).size, 0);
}
END_TEST

// And where they gain by it they stay shared, or become so again.
START_TEST(steps_that_gain_are_shared) {
    brunt_gain gain = {0};
    double now = 1, share;
    for (int turn = 0; turn < 4; turn++) {
        const mixture *m = turn % 2 ? &drags : &pays;
        const double taken = take_steps(&gain, m, true, 20, &now, &share);
        printf("  %.3f of one thread, %.3f shared\n", taken, share);
        if (turn % 2)
            ck_assert_double_lt(taken, 1.02);
        else
            ck_assert_double_gt(share, turn ? 0.85 : 0.98);
    }
}
END_TEST

// A machine whose second thread is late while a run begins, and then is there: what has been learnt of phases meanwhile
// is not held against them when steps are tried again.
START_TEST(a_bad_begin_is_forgotten) {
    static const mixture lates[] = {{1.6, 1, 4}, {3, 1, 4}, {12, 1, 4}}, then = {0.52, 1.02, 4};
    double least = 1;
    for (int m = 0; m < 3; m++)
        for (int k = 1; k <= 20; k++) {
            brunt_gain gain = {0};
            double now = 1, share;
            take_steps(&gain, &lates[m], true, 0.01 * k, &now, &share);
            take_steps(&gain, &then, true, 2, &now, &share);
            least = fmin(least, share);
            take_steps(&gain, &then, true, 4, &now, &share);
            ck_assert_double_gt(share, 0.98);
        }
    printf("  of the two seconds after a bad begin %.3f are shared\n", least);
    ck_assert_double_gt(least, 0.8);
}
END_TEST

// While a file is written a thread is at work on that, and steps that are shared take longer than on one that has been
// left alone: they tell nothing of those that follow, and the work in them does not, either.
START_TEST(steps_beside_other_work_do_not_count) {
    static const mixture lent = {1.05, 1, 4}, then = {0.52, 1.02, 4};
    const double both[2] = {4 * LONG, lent.shared * 4 * LONG};
    for (int k = 0; k < 20; k++) {
        brunt_gain gain = {0};
        double now = 1, share;
        take_steps(&gain, &then, true, 0.01 * k, &now, &share);
        brunt_gain before = gain;
        for (int i = 0; i < 1000; i++) {
            brunt_gain_begin_step(&gain, now);
            run_phase(&gain, task, 4 * LONG, both, &now);
            brunt_gain_end_step(&gain, now, false);
        }
        ck_assert_mem_eq(&gain.steps, &before.steps, sizeof before.steps);
        ck_assert_double_eq(gain.undecided, before.undecided);
        memcpy(gain.sizes, before.sizes, sizeof before.sizes);
        memcpy(gain.tasks, before.tasks, sizeof before.tasks);
        double others, then_now = now;
        const double taken = take_steps(&gain, &then, true, 1, &now, &share),
                     without = take_steps(&before, &then, true, 1, &then_now, &others);
        ck_assert_double_eq_tol(taken, without, 1e-3);
    }
}
END_TEST

// Which steps those are: one that began so, one during which it began, or began and ended.
START_TEST(work_beside_steps_is_noticed) {
    brunt_parallel_begin_step(2);
    ck_assert(!brunt_parallel_end_step(2)); // nothing is measured
    brunt_parallel_adapt(true);
    for (int k = 0; k < 32; k++) {
        if (k & 1) brunt_parallel_beside(true);
        brunt_parallel_begin_step(2);
        if (k & 2) brunt_parallel_beside(!(k & 1));
        if (k & 4) brunt_parallel_beside(false);
        const bool others = k & 1 || k & 2, counts = brunt_parallel_end_step(2);
        brunt_parallel_beside(false);
        ck_assert(counts == !others);
        brunt_parallel_begin_step(1);
        ck_assert(!brunt_parallel_end_step(1));
    }
    // One that waits for the disk leaves its thread to them.
    brunt_parallel_beside(true);
    brunt_parallel_idle(true);
    brunt_parallel_begin_step(2);
    ck_assert(brunt_parallel_end_step(2));
    brunt_parallel_begin_step(2);
    brunt_parallel_idle(false);
    ck_assert(!brunt_parallel_end_step(2));
    brunt_parallel_beside(false);
    brunt_parallel_adapt(false);
}
END_TEST

// Steps all of whose work is shared are not tried on one thread.
START_TEST(steps_are_sure) {
    brunt_gain gain = {0};
    double now = 1;
    const double both[2] = {LONG, 0.55 * LONG};
    for (int k = 0; k < 100000; k++) {
        brunt_gain_begin_step(&gain, now);
        ck_assert(run_phase(&gain, task, LONG, both, &now) > 0);
        brunt_gain_end_step(&gain, now, true);
    }
}
END_TEST

static void mark(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    int32_t *marks = context;
    for (int64_t i = begin; i < end; i++) {
        volatile double x = 1; // some work
        for (int k = 0; k < 20; k++) x = x * 1.0000001;
        marks[i] += x > 0;
    }
}

typedef struct shares {
    int8_t owner[64]; // the worker that a unit was run by, -1: none
    int times[64];
    int64_t first[8]; // unit of each worker
} shares;

static void note(void *context, int64_t begin, int64_t end, int worker) {
    shares *s = context;
    if (s->first[worker] < 0) s->first[worker] = begin;
    for (int64_t i = begin; i < end; i++) s->owner[i] = (int8_t)worker, s->times[i]++;
}

static void phase_of(shares *s, int threads, int count, int grain) {
    memset(s, 0, sizeof *s);
    memset(s->owner, -1, sizeof s->owner), memset(s->first, -1, sizeof s->first);
    if (grain)
        brunt_parallel(threads, count, grain, note, s, NULL);
    else
        brunt_parallel_each(threads, count, note, s, NULL);
}

// Whatever there is of threads, units and grain: each unit once. A worker begins with its own share, the same in each
// phase, unless others have done all of that.
START_TEST(workers_begin_with_their_share) {
    for (int threads = 1; threads <= 8; threads++)
        for (int count = 1; count <= 64; count++)
            for (int grain = 0; grain <= 3; grain++) {
                shares s;
                phase_of(&s, threads, count, grain);
                const int unit = grain ? grain : 1, pieces = (count + unit - 1) / unit,
                          most = grain ? pieces / 2 : count,
                          workers = most < 1         ? 1
                                    : most < threads ? most
                                                     : threads;
                for (int i = 0; i < count; i++) ck_assert_int_eq(s.times[i], 1);
                for (int w = 0; w < workers; w++) {
                    const int from = pieces * w / workers * unit, to = pieces * (w + 1) / workers * unit;
                    bool others = true;
                    for (int i = from; i < to && i < count; i++) others = others && s.owner[i] != w;
                    ck_assert(others || (s.first[w] >= from && s.first[w] < to));
                }
            }
}
END_TEST

static atomic_bool last_of_share_done;

static void wait_for_help(void *context, int64_t begin, int64_t end, int worker) {
    (void)context, (void)end, (void)worker;
    const double give_up = brunt_clock() + 60;
    if (begin == 3) atomic_store(&last_of_share_done, true);
    while (begin == 0 && !atomic_load(&last_of_share_done) && brunt_clock() < give_up) {}
}

// A worker that has done its share helps the others: the first unit does not end before the last one of its share has.
START_TEST(workers_help_each_other) {
    atomic_store(&last_of_share_done, false);
    const double begin = brunt_clock();
    brunt_parallel(2, 8, 1, wait_for_help, NULL, NULL);
    ck_assert_double_lt(brunt_clock() - begin, 60);
}
END_TEST

// Before anything is known of it, a phase of some microseconds is not shared and a longer one is.
START_TEST(guesses_go_by_the_work) {
    for (int k = 0; k < SIZES; k++) {
        brunt_gain gain = {0};
        const brunt_gain_choice unknown = brunt_gain_choose(&gain, task, 100);
        brunt_gain_learn(&gain, &unknown, task, 100, sizes[k], sizes[k], 0);
        ck_assert_int_eq(brunt_gain_choose(&gain, task, 100).together, sizes[k] > 15e-6);
    }
}
END_TEST

// Phases that are really run, as the choice changes: each unit once.
START_TEST(each_unit_is_run_once) {
    enum { UNITS = 5000, PHASES = 4000 };
    static int32_t marks[UNITS];
    brunt_timer timer = {0};
    brunt_parallel_adapt(true);
    for (int k = 0; k < PHASES; k++) brunt_parallel(2, UNITS >> k % 8, 16, mark, marks, k % 2 ? &timer : NULL);
    brunt_parallel_adapt(false);
    for (int i = 0; i < UNITS; i++) {
        int runs = 0;
        for (int k = 0; k < 8; k++) runs += i < UNITS >> k;
        ck_assert_int_eq(marks[i], PHASES / 8 * runs);
    }
    ck_assert_double_gt(timer.seconds[0] + timer.seconds[1], 0);
}
END_TEST

// What has not been met is met by its first piece, while no other thread is at it; a long one is then shared.
typedef struct opening {
    shares shares;
    double first_ended, others_began; // [s] of the first piece; of worker 1, INFINITY: it had nothing to do
} opening;

static void open_slowly(void *context, int64_t begin, int64_t end, int worker) {
    opening *o = context;
    const double began = brunt_clock();
    note(&o->shares, begin, end, worker);
    if (worker == 1) o->others_began = fmin(o->others_began, began);
    while (brunt_clock() < began + 1e-3 * (double)(end - begin)) {}
    if (begin == 0) o->first_ended = brunt_clock();
}

START_TEST(what_is_new_begins_alone) {
    enum { UNITS = 50, GRAIN = 4 };
    opening o = {.others_began = INFINITY};
    memset(o.shares.owner, -1, sizeof o.shares.owner), memset(o.shares.first, -1, sizeof o.shares.first);
    brunt_timer timer = {0};
    brunt_parallel_adapt(true);
    brunt_parallel(2, UNITS, GRAIN, open_slowly, &o, &timer);
    brunt_parallel_adapt(false);
    for (int i = 0; i < 64; i++) ck_assert_int_eq(o.shares.times[i], i < UNITS);
    for (int i = 0; i < GRAIN; i++) ck_assert_int_eq(o.shares.owner[i], 0);
    ck_assert_double_ge(o.others_began, o.first_ended);
    ck_assert_double_gt(timer.seconds[0], GRAIN * 1e-3);
    ck_assert(timer.seconds[1] > 0);
    printf("  the second begins %.1e s after the first piece\n", o.others_began - o.first_ended);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("gain");
    TCase *tests = tcase_create("gain");
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, the_quicker_way_is_found);
    tcase_add_test(tests, machines_change);
    tcase_add_test(tests, what_is_sure_is_not_tried);
    tcase_add_test(tests, pauses_of_the_machine_are_borne);
    tcase_add_test(tests, first_phases_in_vain_are_few);
    tcase_add_test(tests, what_is_new_begins_alone);
    tcase_add_test(tests, rare_waits_count);
    tcase_add_test(tests, costs_survive_a_pause);
    tcase_add_test(tests, tasks_are_told_apart);
    tcase_add_test(tests, steps_count_as_a_whole);
    tcase_add_test(tests, steps_that_gain_are_shared);
    tcase_add_test(tests, steps_are_sure);
    tcase_add_test(tests, steps_beside_other_work_do_not_count);
    tcase_add_test(tests, work_beside_steps_is_noticed);
    tcase_add_test(tests, a_bad_begin_is_forgotten);
    tcase_add_test(tests, workers_begin_with_their_share);
    tcase_add_test(tests, workers_help_each_other);
    tcase_add_test(tests, guesses_go_by_the_work);
    tcase_add_test(tests, each_unit_is_run_once);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
