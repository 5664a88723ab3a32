// What a world does and costs: the effects of its plan, the passes of a step and their time, the arrays it holds.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "brunt/error.h"
#include "brunt/world.h"

#ifdef __cplusplus
extern "C" {
#endif

// An effect that a scene can ask for, and whether this one does: the lines of `brunt check`.
typedef struct brunt_effect {
    const char *name;    // as in summary.json
    bool on;             // its passes run and its arrays are there
    const char *because; // the key or the material model that asked for it
} brunt_effect;
int32_t brunt_effect_count(const brunt_world *world);                      // those on and those off
brunt_effect brunt_world_effect(const brunt_world *world, int32_t effect); // 0 <= effect < brunt_effect_count

bool brunt_effect_on(const brunt_world *world, const char *name); // false: it is off, or there is none

// What a pass has cost so far. `units`: particles, nodes or elements it has gone over, all steps together; bytes and
// flops per unit are counted from the arrays and the arithmetic of its kernels (engine/scheme/work.c), 0 where they
// depend on what meets what.
typedef struct brunt_pass {
    const char *name;
    int64_t calls;
    double seconds;                            // [s] by the clock
    double thread_seconds[BRUNT_THREAD_LIMIT]; // [s] that each thread was at work; 0 of those that there are not
    const char *unit;                          // what it goes over
    double units, bytes_per_unit, flops_per_unit;
} brunt_pass;
int32_t brunt_pass_count(const brunt_world *world);                  // those of the plan
brunt_pass brunt_world_pass(const brunt_world *world, int32_t pass); // passes the plan runs each step, in order
double brunt_world_step_seconds(
    const brunt_world *world); // [s] of the clock in brunt_world_step so far; the passes are its parts

// Told when a pass begins and ends and which thread worked when, by the thread that takes the step. `pass` counts as in
// brunt_world_pass; times are of the monotonic clock [s]. Any of the functions may be NULL. They must not touch the
// world.
typedef struct brunt_observer {
    void *context;
    void (*begin)(void *context, int32_t pass, double time);
    void (*thread)(void *context, int32_t pass, int32_t thread, double begin,
                   double end); // one parallel phase of the pass, after it; before `end`
    void (*end)(void *context, int32_t pass, double begin, double end);
} brunt_observer;
void brunt_world_observe(brunt_world *world, const brunt_observer *observer); // copied; NULL: none (default)

// An array whose size grows with the scene: where the memory is.
typedef struct brunt_array {
    char name[96];    // body and what it holds
    const char *unit; // of its values
    int components;   // per particle, node or element
    size_t bytes;     // taken, with room to grow
} brunt_array;
int32_t brunt_array_count(const brunt_world *world);
brunt_array brunt_world_array(const brunt_world *world, int32_t array); // 0 <= array < brunt_array_count

#ifdef __cplusplus
}
#endif
