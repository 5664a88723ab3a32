// What each pass of a run took, and how far that is from what the machine can do at most (base/roofline.h).
//
// The least time a pass can take is max(bytes / bandwidth, flops / peak) by its counted work (engine/scheme/work.c);
// its share of the roofline is that over the time it took. Above 1: its arrays stay in the caches between passes, which
// the count of bytes does not assume.
#pragma once

#include "io/performance/counters.h"
#include "io/performance/progress.h"

enum { BRUNT_PROFILE_PASSES = 32 };

typedef struct brunt_profile_row {
    brunt_pass pass;
    double share;     // [-] of the steps' time
    double imbalance; // [-] >= 1: most busy thread over the mean of all; NAN: no phase of it is parallel
    double busy_least, busy_mean, busy_greatest;            // [s] of the threads
    double ns_per_unit, bytes_per_second, flops_per_second; // NAN: nothing is counted
    double roofline;                // [-] attainable over measured time; NAN: nothing is counted
    bool memory_bound;              // the bytes take longer than the flops
    double counted[BRUNT_COUNTERS]; // of one unit; cycles and instructions as they are; NAN: not counted
} brunt_profile_row;

typedef struct brunt_profile {
    brunt_profile_row rows[BRUNT_PROFILE_PASSES];
    int32_t row_count;
    int threads;
    int64_t steps;                // taken by this leg of the run
    double step_seconds;          // [s] in steps ...
    double pass_seconds;          // ... of them in passes
    double output_seconds;        // [s] that outputs held the steps up
    double bandwidth, peak;       // [B/s], [flop/s] of the machine with these threads; NAN: could not be measured
    bool counted[BRUNT_COUNTERS]; // kinds that the processor counted
} brunt_profile;

// Measures the roofline (0.3 s, 200 MB and more for that time) and takes all together. `counters`: NULL when there are
// none.
void brunt_profile_make(const brunt_world *world, const brunt_counters *counters, int64_t steps, double output_seconds,
                        brunt_profile *profile);
// At most 130 columns.
void brunt_profile_print(const brunt_profile *profile, brunt_console *console);
// The same numbers; a new reference to an object of jansson, NULL: out of memory.
struct json_t *brunt_profile_json(const brunt_profile *profile);
