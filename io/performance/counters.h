// What the processor counts while passes run, where the system lets a program ask: cycles, instructions and misses in
// user mode, of all threads that are started after the counters are opened.
//
// Linux (perf_event_open). Elsewhere, or where it is not permitted (perf_event_paranoid, containers), nothing is
// counted; of a machine that counts nothing of a kind, as virtual ones do, that kind is left out.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "brunt.h"

typedef enum brunt_counter {
    BRUNT_COUNT_CYCLES,
    BRUNT_COUNT_INSTRUCTIONS,
    BRUNT_COUNT_CACHE_MISSES, // of the last level, as the processor defines it
    BRUNT_COUNT_BRANCH_MISSES,
    BRUNT_COUNTERS
} brunt_counter;

enum { BRUNT_COUNTED_PASSES = 64 };

typedef struct brunt_counters {
    int file[BRUNT_COUNTERS]; // -1: not permitted, or not there
    uint64_t begin[BRUNT_COUNTERS];
    double total[BRUNT_COUNTERS][BRUNT_COUNTED_PASSES]; // by pass, as brunt_world_pass counts them
} brunt_counters;

// Before the first parallel phase of the process. False: nothing can be counted.
bool brunt_counters_open(brunt_counters *counters);
void brunt_counters_close(brunt_counters *counters);
// Reads before and after each pass, which takes some microseconds. `counters` must stay where they are.
brunt_observer brunt_counters_observer(brunt_counters *counters);
// Whether the machine has counted any of this kind.
bool brunt_counted(const brunt_counters *counters, brunt_counter kind);
