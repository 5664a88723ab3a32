// Time lines of runs (--trace): the format, that they say what the timers say, their bounds, and runs that end
// otherwise.
#include "tests/support/small_scene.h"

#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "io/performance/observers.h"
#include "io/run/run.h"
#include "base/parallel.h"
#include "io/performance/trace.h"

// ---------------------------------------------------------------------------------------------------- reading

typedef struct event {
    const char *name, *category; // of the document
    long long begin, end, step;  // [ns]; step: -1 none
    double units;
    int line;
} event;

typedef struct trace_file {
    json_t *document;
    event *events; // complete ones
    int count, counters, described;
} trace_file;

static const char *text_of(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    ck_assert_msg(text != NULL && *text, "an event without '%s': %s", key, json_dumps(object, 0));
    return text;
}

static long long integer_of(const json_t *object, const char *key) {
    json_t *value = json_object_get(object, key);
    ck_assert_msg(json_is_integer(value), "'%s' is no whole number: %s", key, json_dumps(object, 0));
    return json_integer_value(value);
}

static long long nanoseconds_of(const json_t *object, const char *key) {
    json_t *value = json_object_get(object, key);
    ck_assert_msg(json_is_number(value) && json_number_value(value) >= 0, "'%s' is no time: %s", key,
                  json_dumps(object, 0));
    return llround(1000 * json_number_value(value));
}

static void read_event(trace_file *trace, const json_t *object) {
    const char *phase = text_of(object, "ph"), *name = text_of(object, "name");
    json_t *arguments = json_object_get(object, "args");
    ck_assert_int_eq(integer_of(object, "pid"), 1);
    const int line = (int)integer_of(object, "tid");
    ck_assert_msg(json_is_object(arguments), "%s", name);
    if (!strcmp(phase, "M")) {
        ck_assert(json_is_string(json_object_get(arguments, "name")) ||
                  json_is_integer(json_object_get(arguments, "sort_index")));
        trace->described += !strcmp(name, "thread_name");
    } else if (!strcmp(phase, "C")) {
        const char *key;
        json_t *value;
        nanoseconds_of(object, "ts");
        ck_assert_int_ge((int)json_object_size(arguments), 1);
        json_object_foreach(arguments, key, value) ck_assert_msg(json_is_number(value), "%s", key);
        trace->counters++;
    } else {
        ck_assert_str_eq(phase, "X");
        event e = {.name = name, .category = text_of(object, "cat"), .line = line};
        e.begin = nanoseconds_of(object, "ts");
        e.end = e.begin + nanoseconds_of(object, "dur");
        e.step = integer_of(arguments, "step");
        ck_assert_int_ge(e.step, 0);
        e.units = json_number_value(json_object_get(arguments, "units"));
        ck_assert_int_eq(json_is_number(json_object_get(arguments, "units")), !strcmp(e.category, "pass"));
        ck_assert_int_eq(line > 0, !strcmp(e.category, "thread"));
        trace->events[trace->count++] = e;
    }
}

// By line, then time, the longer first.
static int compare(const void *left, const void *right) {
    const event *a = left, *b = right;
    if (a->line != b->line) return a->line < b->line ? -1 : 1;
    if (a->begin != b->begin) return a->begin < b->begin ? -1 : 1;
    return a->end > b->end ? -1 : a->end < b->end;
}

static trace_file read_trace(const char *path) {
    json_error_t error;
    trace_file trace = {.document = json_load_file(path, JSON_REJECT_DUPLICATES, &error)};
    ck_assert_msg(trace.document != NULL, "%s: line %d: %s", path, error.line, error.text);
    json_t *events = json_object_get(trace.document, "traceEvents"), *other;
    ck_assert(json_is_array(events));
    ck_assert_str_eq(text_of(trace.document, "displayTimeUnit"), "ms");
    other = json_object_get(trace.document, "otherData");
    ck_assert_int_eq(integer_of(other, "events"), (long long)json_array_size(events));
    trace.events = malloc((json_array_size(events) + 1) * sizeof *trace.events);
    for (size_t i = 0; i < json_array_size(events); i++) read_event(&trace, json_array_get(events, i));
    ck_assert_int_eq(trace.described, 1 + integer_of(other, "threads"));
    qsort(trace.events, (size_t)trace.count, sizeof *trace.events, compare);
    return trace;
}

static void forget(trace_file *trace) {
    free(trace->events);
    json_decref(trace->document);
}

static bool is(const event *e, const char *category) { return !strcmp(e->category, category); }

// ---------------------------------------------------------------------------------------------------- what must hold

// Of two events on a line one is within the other, or they are apart; passes do not even nest in each other.
static void expect_nesting(const trace_file *trace) {
    enum { DEPTH = 8 };
    const event *open[DEPTH];
    int depth = 0;
    for (int i = 0; i < trace->count; i++) {
        const event *e = &trace->events[i];
        while (depth && (open[depth - 1]->line != e->line || open[depth - 1]->end <= e->begin)) depth--;
        if (depth) {
            const event *outer = open[depth - 1];
            ck_assert_msg(e->end <= outer->end, "%s overlaps %s in part", e->name, outer->name);
            ck_assert_msg(!is(outer, "pass"), "%s lies in the pass %s", e->name, outer->name);
            ck_assert_msg(!is(e, "step"), "%s lies in %s", e->name, outer->name);
        }
        if (is(e, "pass")) {
            ck_assert_msg(depth == 1 && is(open[0], "step"), "the pass %s is outside of steps", e->name);
            ck_assert_int_eq(open[0]->step, e->step);
        }
        ck_assert_int_lt(depth, DEPTH);
        open[depth++] = e;
    }
}

// Threads work within the pass that they work for. Passes come first in the list, in the order of time.
static void expect_threads_in_passes(const trace_file *trace) {
    const event *pass = trace->events;
    int line = 0;
    for (int i = 0; i < trace->count; i++) {
        const event *e = &trace->events[i];
        if (!is(e, "thread")) continue;
        if (e->line != line) pass = trace->events, line = e->line;
        for (; !is(pass, "pass") || pass->end < e->end; pass++) ck_assert_int_eq(pass->line, 0);
        ck_assert_msg(pass->begin <= e->begin && !strcmp(pass->name, e->name), "%s of thread %d is not within it",
                      e->name, e->line - 1);
    }
}

static int count_of(const trace_file *trace, const char *category) {
    int n = 0;
    for (int i = 0; i < trace->count; i++) n += is(&trace->events[i], category);
    return n;
}

static void expect_sums(const trace_file *trace, const brunt_world *world) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++) {
        const brunt_pass pass = brunt_world_pass(world, p);
        double seconds = 0, units = 0, busy[BRUNT_THREAD_LIMIT] = {0};
        int64_t calls = 0;
        for (int i = 0; i < trace->count; i++) {
            const event *e = &trace->events[i];
            if (strcmp(e->name, pass.name) != 0) continue;
            const double length = 1e-9 * (double)(e->end - e->begin);
            if (is(e, "pass")) seconds += length, units += e->units, calls++;
            if (is(e, "thread")) busy[e->line - 1] += length;
        }
        ck_assert_int_eq(calls, pass.calls);
        ck_assert_double_eq_tol(seconds, pass.seconds, 0.02 * pass.seconds + 1e-9);
        ck_assert_double_eq_tol(units, pass.units, 1e-9 * pass.units + 1e-9);
        for (int t = 0; t < BRUNT_THREAD_LIMIT; t++)
            ck_assert_double_eq_tol(busy[t], pass.thread_seconds[t], 0.02 * pass.thread_seconds[t] + 1e-9);
    }
}

// ---------------------------------------------------------------------------------------------------- the tests

static const char *const texts[] = {small_scene_text, small_elements_text};

START_TEST(format_and_sums) {
    const int steps = 60;
    small_folder_make();
    brunt_scene scene;
    small_scene_of(texts[_i / 2], &scene, NULL, 0);
    scene.world.threads = 1 + _i % 2 * 2;
    brunt_world *world = small_world(&scene), *alone = small_world(&scene);
    brunt_error error = {0};
    brunt_trace *trace = brunt_trace_open(small_path("t.json"), "a \"name\"\\\n", world, brunt_clock(), &error);
    ck_assert_msg(trace != NULL, "%s", error.message);
    brunt_observers observers = {.count = 0};
    brunt_observers_add(&observers, brunt_trace_observer(trace));
    brunt_observers_watch(&observers, world);
    double in_output = 0;
    for (int s = 0; s < steps; s++) {
        double start = brunt_clock();
        small_steps(world, 1);
        double stop = brunt_clock();
        brunt_trace_step(trace, start, stop);
        brunt_trace_output(trace, "history", stop, brunt_clock());
        in_output++;
    }
    small_steps(alone, steps);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(alone)); // being watched changes no step
    brunt_trace_count count;
    ck_assert_int_eq(brunt_trace_close(trace, &count, &error), BRUNT_OK);
    ck_assert_int_eq(count.steps, steps);
    ck_assert_int_eq(count.left_out + count.steps_left_out, 0);

    trace_file file = read_trace(small_path("t.json"));
    expect_nesting(&file);
    expect_threads_in_passes(&file);
    expect_sums(&file, world);
    ck_assert_int_eq(count_of(&file, "step"), steps);
    ck_assert_int_eq(count_of(&file, "output"), (int)in_output);
    ck_assert_int_ge(file.counters, 2);
    ck_assert_str_eq(text_of(json_object_get(file.document, "otherData"), "scene"), "a \"name\"\\\n");
    forget(&file);
    brunt_world_destroy(world);
    brunt_world_destroy(alone);
    brunt_scene_free(&scene);
    small_folder_remove();
}
END_TEST

// A long run, by what it would tell the trace: 12,000 steps of 40 passes, and one of a million.
START_TEST(long_runs_are_bounded) {
    enum { STEPS = 12000, PASSES = 40, MANY = 1000000 };
    small_folder_make();
    brunt_scene scene;
    small_scene(&scene, NULL, 0);
    brunt_world *world = small_world(&scene);
    brunt_error error = {0};
    const double start = brunt_clock();
    brunt_trace *trace = brunt_trace_open(small_path("t.json"), "long", world, start, &error);
    ck_assert_ptr_nonnull(trace);
    brunt_observer observer = brunt_trace_observer(trace);
    double time = start;
    for (int s = 0; s < STEPS; s++) {
        const double begin = time;
        const int passes = s == STEPS / 2 ? MANY : PASSES;
        for (int p = 0; p < passes; p++, time += 1e-6) observer.end(observer.context, p % 4, time, time + 1e-6);
        brunt_trace_step(trace, begin, time);
    }
    brunt_trace_count count;
    ck_assert_int_eq(brunt_trace_close(trace, &count, &error), BRUNT_OK);
    ck_assert_int_le(count.events, 400000);
    ck_assert_int_ge(count.events, 300000);
    ck_assert_int_eq(count.steps, STEPS);
    struct stat info;
    ck_assert_int_eq(stat(small_path("t.json"), &info), 0);
    printf("  %lld of %lld steps, %lld events, %.1f MB\n", (long long)(count.steps - count.steps_left_out),
           (long long)count.steps, (long long)count.events, 1e-6 * (double)info.st_size);
    ck_assert_int_lt(info.st_size, 60000000);

    trace_file file = read_trace(small_path("t.json"));
    expect_nesting(&file);
    ck_assert_int_eq(count_of(&file, "step") + count.steps_left_out, STEPS);
    ck_assert_int_eq(count_of(&file, "pass"), count_of(&file, "step") * PASSES); // steps are kept as a whole
    ck_assert_int_eq(count_of(&file, "pass") + count_of(&file, "step") + count.left_out,
                     (STEPS - 1) * (PASSES + 1) + MANY + 1);
    ck_assert_int_eq(integer_of(json_object_get(file.document, "otherData"), "events_left_out"), count.left_out);
    // All of the first, and of the last tenth still some.
    long long late = 0;
    for (int i = 0; i < file.count; i++)
        if (is(&file.events[i], "step")) late += file.events[i].begin > llround(0.9e9 * (time - start));
    ck_assert_int_gt(late, 0);
    forget(&file);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    small_folder_remove();
}
END_TEST

// What the run loop adds: output, and files however a run ends.
static int run_traced(const char *trace, const char *const *sets, int set_count, bool resume,
                      const volatile sig_atomic_t *stop) {
    brunt_scene scene;
    small_scene(&scene, sets, set_count);
    scene.world.threads = 1;
    char folder[160], path[160];
    snprintf(folder, sizeof folder, "%s", small_path("out"));
    snprintf(path, sizeof path, "%s", small_path(trace));
    const brunt_run_options options = {.folder = folder, .trace = path, .resume = resume, .stop = stop};
    brunt_error error;
    int status = brunt_run(&scene, &options, &error);
    brunt_scene_free(&scene);
    return status;
}

static bool exists(const char *name) {
    struct stat info;
    return stat(small_path(name), &info) == 0;
}

START_TEST(runs_however_they_end) {
    small_folder_make();
    ck_assert_int_eq(run_traced("out/done.json", NULL, 0, false, NULL), BRUNT_OK);
    trace_file done = read_trace(small_path("out/done.json"));
    expect_nesting(&done);
    const int steps = count_of(&done, "step");
    int pictures = 0;
    for (int i = 0; i < done.count; i++)
        pictures += is(&done.events[i], "output") && !strcmp(done.events[i].name, "picture");
    ck_assert_int_eq(pictures, 11);
    ck_assert_int_eq(steps, (int)integer_of(json_object_get(done.document, "otherData"), "steps"));
    forget(&done);
    ck_assert(!exists("out/done.json.part"));

    // Stopped before its first step, then resumed with a trace of its own.
    static volatile sig_atomic_t stop = 1;
    ck_assert_int_eq(run_traced("stopped.json", NULL, 0, false, &stop), BRUNT_STOPPED);
    trace_file stopped = read_trace(small_path("stopped.json"));
    ck_assert_int_eq(count_of(&stopped, "step"), 0);
    ck_assert_int_gt(count_of(&stopped, "output"), 0);
    forget(&stopped);
    ck_assert_int_eq(run_traced("resumed.json", NULL, 0, true, NULL), BRUNT_OK);
    trace_file resumed = read_trace(small_path("resumed.json"));
    ck_assert_int_eq(count_of(&resumed, "step"), steps);
    expect_nesting(&resumed);
    forget(&resumed);

    // Failed in a step.
    static const char *const failing[] = {"time.energy_limit=1e-9"};
    ck_assert_int_eq(run_traced("failed.json", failing, 1, false, NULL), BRUNT_FAILED);
    trace_file failed = read_trace(small_path("failed.json"));
    ck_assert_int_gt(count_of(&failed, "step"), 0);
    expect_nesting(&failed);
    forget(&failed);
    small_folder_remove();
}
END_TEST

START_TEST(files_that_cannot_be_written) {
    small_folder_make();
    ck_assert_int_eq(run_traced("t.json", NULL, 0, false, NULL), BRUNT_OK);
    // Found before the first step, and before anything of the run before is touched.
    ck_assert_int_eq(run_traced("none/t.json", NULL, 0, false, NULL), BRUNT_IO_ERROR);
    ck_assert_int_eq(run_traced("out", NULL, 0, false, NULL), BRUNT_IO_ERROR); // a folder
    ck_assert(exists("out/summary.json") && exists("out/checkpoint.h5") && exists("t.json"));
    ck_assert(!exists("out.part"));

    small_write(small_path("small.yaml"), small_scene_text, sizeof small_scene_text - 1);
    char command[600];
    const char *program = getenv("BRUNT");
    ck_assert_msg(program != NULL, "BRUNT must name the program");
    snprintf(command, sizeof command, "'%s' run %s/small.yaml -t 1 -o %s/again --trace %s/none/t.json >%s/log 2>&1",
             program, small_folder, small_folder, small_folder, small_folder);
    ck_assert_int_eq(WEXITSTATUS(system(command)), 74);
    snprintf(command, sizeof command, "'%s' run %s/small.yaml -t 1 -o %s/again --trace %s/t2.json >%s/log 2>&1",
             program, small_folder, small_folder, small_folder, small_folder);
    ck_assert_int_eq(WEXITSTATUS(system(command)), 0);
    trace_file file = read_trace(small_path("t2.json"));
    ck_assert_int_gt(count_of(&file, "step"), 0);
    forget(&file);
    small_folder_remove();
}
END_TEST

int main(void) {
    Suite *suite = suite_create("trace");
    TCase *tests = tcase_create("trace");
    tcase_set_timeout(tests, 0);
    tcase_add_loop_test(tests, format_and_sums, 0, 4);
    tcase_add_test(tests, long_runs_are_bounded);
    tcase_add_test(tests, runs_however_they_end);
    tcase_add_test(tests, files_that_cannot_be_written);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
