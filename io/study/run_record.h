// What a run of a study left in its folder: its summary, and run.json, which says of what key it is.
#pragma once

#include "io/study/child.h"
#include "io/study/study.h"

// What a run left.
typedef struct run_result {
    brunt_study_status status;
    char reason[256], state_hash[24];
    double elapsed, limit; // [s]; limit: that it was killed at, NAN: it was not
    double wall, peak, steps, units;
    double value[BRUNT_STUDY_MEASURES], expect[BRUNT_STUDY_MEASURES];
    char unit[BRUNT_STUDY_MEASURES][32];
} run_result;

// What became of a run that has ended just now.
void run_record_judge(const brunt_study *study, const char *folder, const brunt_child_end *end, run_result *result);
int run_record_write(const char *folder, uint64_t key, const run_result *result, brunt_error *error);
// True when the folder holds a finished run of this very key.
bool run_record_take_over(const brunt_study *study, uint64_t run_key, const char *folder, run_result *result);
