// The run as a time line: steps, passes, what each thread did, output. Chrome's trace event format, which Perfetto
// (ui.perfetto.dev) and chrome://tracing show.
//
//   {"program": "brunt VERSION", "traceEvents": [ ... ], "displayTimeUnit": "ms", "otherData": {...}}
//
// Line "step" (tid 0): an event for each step, within it one for each pass, between steps the output. Line "thread N"
// (tid N + 1): when the thread was at work, by pass. Counters: dt, energy error. Times are in microseconds since the
// run began.
//
// Long runs: all of the first steps, up to 300,000 events; then every 10th step, and ten times more rarely after each
// 10,000 events more; steps are kept or left out as a whole. A file has at most 400,000 events, some 50 MB.
#pragma once

#include "brunt.h"

typedef struct brunt_trace brunt_trace;

typedef struct brunt_trace_count {
    int64_t events, left_out; // written; not, of steps that were left out
    int64_t steps, steps_left_out;
} brunt_trace_count;

// Whether what is there already may be replaced: nothing, or an earlier trace of brunt's. BRUNT_OK; BRUNT_BAD_INPUT:
// another file, a device or a link; BRUNT_IO_ERROR: a folder.
int brunt_trace_refuse(const char *path, brunt_error *error);
// Whether a file can be written there; what is there stays. BRUNT_OK, BRUNT_IO_ERROR.
int brunt_trace_check(const char *path, brunt_error *error);
// Times count from `origin` [s of brunt_clock]. `scene`: its name; the world outlives the trace. NULL: cannot be
// written, or no memory.
brunt_trace *brunt_trace_open(const char *path, const char *scene, brunt_world *world, double origin,
                              brunt_error *error);
brunt_observer brunt_trace_observer(brunt_trace *trace);
// What was written from `begin` to `end` [s of brunt_clock], by its name: "history", "picture", "checkpoint".
void brunt_trace_output(brunt_trace *trace, const char *name, double begin, double end);
// A step that has been taken, or has failed, from `begin` to `end` [s of brunt_clock]. Closes the account of the one
// before with its output.
void brunt_trace_step(brunt_trace *trace, double begin, double end);
// Ends the file and gives it its name. Frees the trace whatever the outcome: BRUNT_OK, or BRUNT_IO_ERROR.
int brunt_trace_close(brunt_trace *trace, brunt_trace_count *count, brunt_error *error);
