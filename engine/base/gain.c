#include "base/gain.h"

#include <math.h>
#include <string.h>

#include "base/error.h"

enum { WINDOW_PHASES = 32, VAIN_PHASES = 3, FIRST_SHARED = 4 };
static const double WINDOW = 5e-3, WHOLE_WINDOW = 50e-3; // [s] of so many phases at least; of how many ever
static const double VAIN = 2e-3, VAIN_SHARE = 4;         // [s] of first phases that took so many times their work
static const double MEMORY = 0.1;                        // [s] that the way in use is known by
// Of the work in phases, that they take: threads that get below it are not left for a trial. One thread takes 1, or
// somewhat less where threads that share a memory make work of waiting for it.
static const double SURE = 0.6;
static const double FIRST_PAUSE = 12, PAUSE = 100; // until the other way is tried, over what a trial took

// Open addressing: where a task is, or is to be; -1 when the table is full.
static int32_t place_of(const brunt_gain *gain, brunt_task_fn *task) {
    const uint64_t hash = (uint64_t)(uintptr_t)task * 0x9e3779b97f4a7c15u >> 32;
    for (int32_t k = 0; k < BRUNT_GAIN_TASKS; k++) {
        const int32_t at = (int32_t)((hash + (uint64_t)k) % BRUNT_GAIN_TASKS);
        if (!gain->tasks[at].task || gain->tasks[at].task == task) return at;
    }
    return BRUNT_NONE;
}

brunt_gain_choice brunt_gain_choose(const brunt_gain *gain, brunt_task_fn *task, int64_t count) {
    const int32_t at = place_of(gain, task);
    brunt_gain_choice choice = {true, at, -1, at < 0 ? 0 : gain->tasks[at].cost * (double)count};
    if (gain->begun > 0 && gain->steps.known && !gain->steps.together) {
        choice.together = false;
        return choice;
    }
    if (!(choice.expected > 0)) return choice;
    const int size = choice.expected < 1e-6 ? 0 : ilogb(choice.expected * 1e6);
    choice.size = size < BRUNT_GAIN_SIZES ? size : BRUNT_GAIN_SIZES - 1;
    const brunt_gain_size *s = &gain->sizes[choice.size];
    choice.together = s->known ? s->together : choice.size >= FIRST_SHARED;
    return choice;
}

static double rate(const brunt_gain_way *way) { return way->taken / way->expected; }

static bool fills_window(const brunt_gain_size *s) {
    return s->taken >= WHOLE_WINDOW || (s->phases >= WINDOW_PHASES && s->taken >= WINDOW);
}

// Of the first phases that are shared, before anything is known of them: on a machine with other work each waits for
// whichever thread was left out, many times what it is worth, and a window of those would be most of a short run.
static bool is_in_vain(const brunt_gain_size *s) {
    return s->together && !(s->ways[true].expected > 0) && s->phases >= VAIN_PHASES && s->taken >= VAIN &&
           s->taken > VAIN_SHARE * s->expected;
}

static void open_window(brunt_gain_size *s) { s->phases = 0, s->expected = 0, s->taken = 0; }

// One window may have met a stop of the machine: the way in use is known by the last of them together, and one that has
// just been taken is soon asked again.
static void add_window(brunt_gain_size *s) {
    brunt_gain_way *own = &s->ways[s->together];
    const double fades = s->trial ? 0 : MEMORY / (MEMORY + s->taken);
    own->expected = fades * own->expected + s->expected;
    own->taken = fades * own->taken + s->taken;
}

// After a window of phases run one way: how the next are run. `sure`: the other way is not tried.
static void decide(brunt_gain_size *s, double now, bool sure) {
    const brunt_gain_way *own = &s->ways[s->together], *other = &s->ways[!s->together];
    if (s->trial) {
        const bool stays = rate(own) >= rate(other);
        s->pause = stays && s->pause > 0 ? fmin(2 * s->pause, PAUSE) : FIRST_PAUSE;
        s->next = now + s->pause * s->taken;
        s->together ^= stays;
        s->trial = false;
    } else if (!sure && (now >= s->next || (other->expected > 0 && rate(own) > rate(other)))) { // time, or reason to
        s->together = !s->together;
        s->trial = true;
    }
    open_window(s);
}

void brunt_gain_begin_step(brunt_gain *gain, double now) { gain->begun = now, gain->work = 0; }

// The first window, in which arrays grow and all is looked at anew, tells nothing of the steps that follow.
void brunt_gain_end_step(brunt_gain *gain, double now, bool counts) {
    brunt_gain_size *s = &gain->steps;
    const double taken = now - gain->begun;
    gain->begun = 0;
    if (!counts) return;
    s->phases++, s->expected += 1, s->taken += taken, gain->undecided += gain->work;
    if (!fills_window(s)) return;
    const bool sure = s->together && s->taken < SURE * gain->undecided;
    gain->undecided = 0;
    if (s->known) {
        add_window(s);
        decide(s, now, sure);
        // When they are tried together again, phases begin anew: what was learnt of them, they are not all to answer
        // for.
        if (!s->together && !s->trial) memset(gain->sizes, 0, sizeof gain->sizes);
        return;
    }
    s->known = s->together = true;
    open_window(s);
}

void brunt_gain_learn(brunt_gain *gain, const brunt_gain_choice *choice, brunt_task_fn *task, int64_t count,
                      double work, double taken, double now) {
    if (gain->begun > 0) gain->work += work;
    if (choice->task < 0) return;
    double *cost = &gain->tasks[choice->task].cost;
    gain->tasks[choice->task].task = task;
    const double measured = work / (double)count;
    // A thread that the machine left out has worked no longer than others, it only looks so.
    *cost += *cost > 0 ? (fmin(measured, 2 * *cost) - *cost) / 8 : measured;
    if (choice->size < 0) return;
    brunt_gain_size *s = &gain->sizes[choice->size];
    if (!s->known) s->together = choice->together, s->known = true;
    s->phases++, s->expected += choice->expected, s->taken += taken;
    if (!fills_window(s) && !is_in_vain(s)) return;
    add_window(s);
    decide(s, now, s->together && rate(&s->ways[true]) < SURE);
}
