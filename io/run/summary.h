// What came out of a run: summary.json for programs, a page of text for people.
#pragma once

#include "io/output/measures.h"
#include "io/performance/profile.h"
#include "io/performance/progress.h"
#include "io/scene/scene.h"

typedef struct brunt_summary {
    const char *status;                  // "done", "failed", "stopped"
    const char *reason;                  // why it ended
    double wall_seconds, cpu_seconds;    // [s] over all legs of the run
    double step_seconds;                 // [s] wall time inside time steps: what the rates are made of
    double output_seconds;               // [s] wall time that outputs held the steps up
    double peak_bytes;                   // [bytes] the most memory that the process has had: brunt_summary_peak
    uint64_t state_hash;                 // of the world: brunt_world_hash
    const brunt_profile *profile;        // of this leg; NULL: none
    const brunt_measure_result *results; // one a measure of the scene; NULL: not evaluated
} brunt_summary;

int brunt_summary_write(const char *path, const brunt_summary *summary, const brunt_scene *scene, brunt_world *world,
                        brunt_error *error);
void brunt_summary_print(const brunt_summary *summary, const brunt_scene *scene, brunt_world *world,
                         brunt_console *console);
// [bytes] the most memory that the process has had so far. Before a profile is made, which needs some of its own.
double brunt_summary_peak(void);
// The status in a summary.json; "" when there is none.
void brunt_summary_status(const char *path, char status[16]);
