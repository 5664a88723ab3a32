// The format: "Trace Event Format" (Google, docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU),
// JSON object form: complete events "X", counters "C", metadata "M".
//
// Events of a step are kept as numbers and written once it is over and so known to be kept: within a step nothing is
// formatted and nothing goes to the disk.
#include "io/performance/trace.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/array.h"
#include "base/memory.h"

enum { FIRST_EVENTS = 300000, MORE_EVENTS = 10000, EVENT_LIMIT = 400000 };
static const double counter_every = 0.1; // [s] of the clock: reading the energy goes over all bodies

typedef enum kind { PASS, THREAD, OUTPUT } kind;

typedef struct record {
    kind kind;
    int32_t pass, thread;
    const char *name;
    double begin, end, units; // [s] of the clock, [s], [-]
} record;

struct brunt_trace {
    brunt_atomic_file file;
    brunt_world *world;
    char *scene;                 // as a JSON string, with its quotes; from the C library
    double origin, last_counter; // [s] of the clock
    int32_t pass_count;
    const char **pass_name;
    double *units;   // of each pass, at the end of the last one
    record *records; // since the last step was written
    size_t record_capacity;
    int64_t record_count, lost; // lost: there was no memory for them
    int64_t stride;             // steps of which one is kept
    int64_t next_stride_at;     // [events]
    brunt_trace_count count;
};

// ---------------------------------------------------------------------------------------------------- what happens

static void keep(brunt_trace *trace, record r) {
    const size_t used = (size_t)trace->record_count;
    if (BRUNT_RESERVE_IN(trace->records, trace->record_capacity, used + 1, used)) {
        trace->lost++;
        return;
    }
    trace->records[trace->record_count++] = r;
}

static void end_pass(void *context, int32_t pass, double begin, double end) {
    brunt_trace *trace = context;
    double units = brunt_world_pass(trace->world, pass).units;
    keep(trace, (record){PASS, pass, 0, trace->pass_name[pass], begin, end, units - trace->units[pass]});
    trace->units[pass] = units;
}

static void end_thread(void *context, int32_t pass, int32_t thread, double begin, double end) {
    brunt_trace *trace = context;
    keep(trace, (record){THREAD, pass, thread, trace->pass_name[pass], begin, end, 0});
}

brunt_observer brunt_trace_observer(brunt_trace *trace) {
    return (brunt_observer){.context = trace, .thread = end_thread, .end = end_pass};
}

void brunt_trace_output(brunt_trace *trace, const char *name, double begin, double end) {
    keep(trace, (record){.kind = OUTPUT, .name = name, .begin = begin, .end = end});
}

// ---------------------------------------------------------------------------------------------------- the file

// Whole nanoseconds since the origin: begin and end are rounded, not lengths, so that what lies within stays within.
static int64_t nanoseconds(const brunt_trace *trace, double time) {
    return time > trace->origin ? llround(1e9 * (time - trace->origin)) : 0;
}

// The comma stands before all events but the first.
static void begin_event(brunt_trace *trace, const char *name, const char *category, char phase, int32_t line,
                        double time) {
    const int64_t at = nanoseconds(trace, time);
    fprintf(
        trace->file.stream, "%s\n{\"name\":\"%s\",\"cat\":\"%s\",\"ph\":\"%c\",\"pid\":1,\"tid\":%d,\"ts\":%lld.%03d",
        trace->count.events++ ? "," : "", name, category, phase, (int)line, (long long)(at / 1000), (int)(at % 1000));
}

static void complete_event(brunt_trace *trace, const char *name, const char *category, int32_t line, double begin,
                           double end) {
    begin_event(trace, name, category, 'X', line, begin);
    const int64_t length = nanoseconds(trace, end) - nanoseconds(trace, begin);
    fprintf(trace->file.stream, ",\"dur\":%lld.%03d", (long long)(length / 1000), (int)(length % 1000));
}

// `value`: a JSON string with its quotes.
static void describe(brunt_trace *trace, const char *what, int32_t line, const char *key, const char *value) {
    fprintf(trace->file.stream, "%s\n{\"name\":\"%s\",\"ph\":\"M\",\"pid\":1,\"tid\":%d,\"args\":{\"%s\":%s}}",
            trace->count.events++ ? "," : "", what, (int)line, key, value);
}

static void describe_lines(brunt_trace *trace) {
    char text[32];
    describe(trace, "process_name", 0, "name", trace->scene);
    for (int32_t line = 0; line <= brunt_world_threads(trace->world); line++) {
        if (line)
            snprintf(text, sizeof text, "\"thread %d\"", (int)line - 1);
        else
            snprintf(text, sizeof text, "\"step\"");
        describe(trace, "thread_name", line, "name", text);
        snprintf(text, sizeof text, "%d", (int)line);
        describe(trace, "thread_sort_index", line, "sort_index", text);
    }
}

static void write_record(brunt_trace *trace, const record *r, long long step) {
    static const char *const category[] = {[PASS] = "pass", [THREAD] = "thread", [OUTPUT] = "output"};
    _Static_assert(BRUNT_COUNT(category) == OUTPUT + 1, "a word for each kind of event");
    complete_event(trace, r->name, category[r->kind], r->kind == THREAD ? r->thread + 1 : 0, r->begin, r->end);
    fprintf(trace->file.stream, ",\"args\":{\"step\":%lld", step - (r->kind == OUTPUT)); // output is of the step before
    if (r->kind == PASS) fprintf(trace->file.stream, ",\"units\":%.0f", r->units);
    fputs("}}", trace->file.stream);
}

static void write_records(brunt_trace *trace, long long step) {
    for (int64_t i = 0; i < trace->record_count; i++) write_record(trace, &trace->records[i], step);
    trace->record_count = 0;
}

static void write_counter(brunt_trace *trace, const char *name, const char *unit, double time, double value) {
    if (!isfinite(value)) return; // JSON knows no other numbers
    begin_event(trace, name, "counter", 'C', 0, time);
    fprintf(trace->file.stream, ",\"args\":{\"%s\":%.9g}}", unit, value);
}

static void write_counters(brunt_trace *trace, double time) {
    if (time - trace->last_counter < counter_every) return;
    trace->last_counter = time;
    brunt_energy energy;
    brunt_world_energy(trace->world, &energy);
    write_counter(trace, "dt", "s", time, brunt_world_dt(trace->world));
    write_counter(trace, "energy error", "relative", time, energy.error_relative);
}

static bool step_is_kept(const brunt_trace *trace) {
    enum { BESIDES = 3 }; // the step itself and the counters
    if (trace->count.events + trace->record_count + BESIDES > EVENT_LIMIT) return false;
    return trace->count.steps % trace->stride == 0;
}

void brunt_trace_step(brunt_trace *trace, double begin, double end) {
    const long long step = brunt_world_steps(trace->world);
    trace->count.steps++;
    if (!step_is_kept(trace)) {
        trace->count.steps_left_out++;
        trace->count.left_out += trace->record_count + 1;
        trace->record_count = 0;
        return;
    }
    char name[32];
    snprintf(name, sizeof name, "step %lld", step);
    complete_event(trace, name, "step", 0, begin, end);
    fprintf(trace->file.stream, ",\"args\":{\"step\":%lld,\"time\":%.9g}}", step, brunt_world_time(trace->world));
    write_records(trace, step);
    write_counters(trace, end);
    while (trace->count.events >= trace->next_stride_at) {
        trace->stride *= 10;
        trace->next_stride_at += MORE_EVENTS;
    }
}

// ---------------------------------------------------------------------------------------------------- open and close

static const char beginning[] = "{\"program\":\"brunt ";

// True for an earlier trace, or, of one that was cut off, an empty file.
static bool begins_as_a_trace(const char *path, bool may_be_empty) {
    char start[sizeof beginning] = "";
    FILE *file = fopen(path, "rbe");
    if (!file) return false;
    size_t got = fread(start, 1, sizeof start - 1, file);
    fclose(file);
    return (may_be_empty && got == 0) || !strcmp(start, beginning);
}

static int refuse(const char *path, bool aside, brunt_error *error) {
    struct stat info;
    if (lstat(path, &info)) return BRUNT_OK;
    if (S_ISDIR(info.st_mode))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", path, strerror(EISDIR));
    if (S_ISREG(info.st_mode) && begins_as_a_trace(path, aside)) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "%s: is there already and no trace of brunt's; another name is wanted (--trace)", path);
}

int brunt_trace_refuse(const char *path, brunt_error *error) {
    char aside[BRUNT_PATH_LENGTH];
    int status = refuse(path, false, error);
    if ((size_t)snprintf(aside, sizeof aside, "%s.part", path) >= sizeof aside) return status;
    return status ? status : refuse(aside, true, error);
}

int brunt_trace_check(const char *path, brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (!status) brunt_atomic_abandon(&file);
    return status;
}

static void release(brunt_trace *trace) {
    free(trace->scene);
    brunt_free(trace->pass_name);
    brunt_free(trace->units);
    brunt_free(trace->records);
    brunt_free(trace);
}

static char *json_text(const char *text) {
    json_t *string = json_string(text); // NULL when it is not UTF-8
    char *out = json_dumps(string ? string : json_null(), JSON_ENCODE_ANY | JSON_ENSURE_ASCII);
    json_decref(string);
    return out;
}

brunt_trace *brunt_trace_open(const char *path, const char *scene, brunt_world *world, double origin,
                              brunt_error *error) {
    brunt_trace *trace = brunt_alloc(sizeof *trace);
    if (trace) {
        trace->pass_count = brunt_pass_count(world);
        trace->pass_name = brunt_alloc((size_t)trace->pass_count * sizeof *trace->pass_name);
        trace->units = brunt_alloc((size_t)trace->pass_count * sizeof *trace->units);
        trace->scene = json_text(scene);
    }
    if (!trace || !trace->pass_name || !trace->units || !trace->scene) {
        brunt_fail(error, BRUNT_FAILED, "out of memory for the trace");
        if (trace) release(trace);
        return NULL;
    }
    if (brunt_atomic_open(&trace->file, path, error)) {
        release(trace);
        return NULL;
    }
    trace->world = world;
    trace->origin = origin, trace->last_counter = -INFINITY;
    trace->stride = 1, trace->next_stride_at = FIRST_EVENTS;
    for (int32_t p = 0; p < trace->pass_count; p++) {
        brunt_pass pass = brunt_world_pass(world, p);
        trace->pass_name[p] = pass.name, trace->units[p] = pass.units;
    }
    fprintf(trace->file.stream, "%s%s\",\"traceEvents\":[", beginning, BRUNT_VERSION);
    describe_lines(trace);
    return trace;
}

int brunt_trace_close(brunt_trace *trace, brunt_trace_count *count, brunt_error *error) {
    write_records(trace, brunt_world_steps(trace->world) + 1); // the last output
    trace->count.left_out += trace->lost;
    *count = trace->count;
    fprintf(trace->file.stream,
            "\n],\"displayTimeUnit\":\"ms\",\"otherData\":{\"program\":\"brunt "
            "%s\",\"scene\":%s,\"threads\":%d,\"steps\":%lld,"
            "\"steps_left_out\":%lld,\"events\":%lld,\"events_left_out\":%lld}}\n",
            BRUNT_VERSION, trace->scene, brunt_world_threads(trace->world), (long long)count->steps,
            (long long)count->steps_left_out, (long long)count->events, (long long)count->left_out);
    int status = brunt_atomic_commit(&trace->file, error);
    release(trace);
    return status;
}
