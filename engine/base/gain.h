// Whether threads pay: what phases take on one thread and on all is measured while a run goes on, by the work that is
// in them, and the quicker way is taken, and asked again from time to time. Sharing a small phase costs more than the
// phase; on a machine with other work any phase waits for whichever of its threads was left out. And what a phase gains
// may be lost by the next, which finds half of its data with another core: so whole steps are measured as well, with
// phases as they have each proved best and with all on one thread. No result depends on it.
#pragma once

#include <stdint.h>

#include "base/parallel.h"

enum { BRUNT_GAIN_TASKS = 512, BRUNT_GAIN_SIZES = 16 };

typedef struct brunt_gain_way {
    double expected, taken; // [s] as below, of the last phases run so
} brunt_gain_way;

// Phases of about the same work, sizes a factor of two apart from a microsecond on.
typedef struct brunt_gain_size {
    bool together, known;   // how they are run now; that this is not the guess that all begins with
    bool trial;             // that this is the way not chosen
    int32_t phases;         // since that was last decided
    double expected, taken; // [s] work in them, and wall clock
    brunt_gain_way ways[2]; // on one thread, together
    double pause, next;     // over what a trial took, until the other way is tried again; when that is [s]
} brunt_gain_size;

// Zeroed at first.
typedef struct brunt_gain {
    brunt_gain_size steps; // of which one is a unit of work; `together`: each phase as it has proved best
    double begun, work;    // [s] when the step began, 0: there is none; of its phases
    double undecided;      // [s] work of the steps that are not decided on
    struct {
        brunt_task_fn *task;
        double cost; // [s] of work a unit; 0: not known
    } tasks[BRUNT_GAIN_TASKS];
    brunt_gain_size sizes[BRUNT_GAIN_SIZES];
} brunt_gain;

typedef struct brunt_gain_choice {
    bool together;
    int32_t task, size; // where what is learnt of it goes; -1: nowhere
    double expected;    // [s] work; 0: not known
} brunt_gain_choice;

// A step begins, and ends; `counts`: its phases had all their threads. Phases outside of steps are measured by
// themselves.
void brunt_gain_begin_step(brunt_gain *gain, double now);
void brunt_gain_end_step(brunt_gain *gain, double now, bool counts);

brunt_gain_choice brunt_gain_choose(const brunt_gain *gain, brunt_task_fn *task, int64_t count);

// A phase that was run as chosen, and ended at `now`: `work` is the sum over its threads, `taken` from its begin to its
// end [s].
void brunt_gain_learn(brunt_gain *gain, const brunt_gain_choice *choice, brunt_task_fn *task, int64_t count,
                      double work, double taken, double now);
