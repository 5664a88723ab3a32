#include "io/performance/profile.h"

#include <jansson.h>
#include <math.h>

#include "base/array.h"
#include "base/real.h"
#include "io/performance/roofline.h"

enum { THREADS_SHOWN = 4 }; // one by one

static const char *const counter_names[] = {"cycles", "instructions", "cache_misses", "branch_misses"};
_Static_assert(BRUNT_COUNT(counter_names) == BRUNT_COUNTERS, "a name for each counter");

// Positive over positive, else no number.
static double ratio(double of, double per) { return of > 0 && per > 0 ? of / per : NAN; }

static void take_threads(brunt_profile_row *row, int threads) {
    double sum = 0;
    row->busy_least = INFINITY, row->busy_greatest = 0;
    for (int t = 0; t < threads; t++) {
        const double busy = row->pass.thread_seconds[t];
        sum += busy;
        row->busy_least = fmin(row->busy_least, busy);
        row->busy_greatest = fmax(row->busy_greatest, busy);
    }
    row->busy_mean = sum / threads;
    row->imbalance = ratio(row->busy_greatest, row->busy_mean);
}

static void take_work(brunt_profile_row *row, double bandwidth, double peak) {
    const brunt_pass *pass = &row->pass;
    row->ns_per_unit = 1e9 * ratio(pass->seconds, pass->units);
    row->bytes_per_second = ratio(pass->bytes_per_unit * pass->units, pass->seconds);
    row->flops_per_second = ratio(pass->flops_per_unit * pass->units, pass->seconds);
    // Of what is not counted, or could not be measured, the time is not known: fmax leaves NAN out.
    const double memory = row->bytes_per_second / bandwidth, compute = row->flops_per_second / peak;
    row->roofline = fmax(memory, compute);
    row->memory_bound = !(compute > memory);
}

void brunt_profile_make(const brunt_world *world, const brunt_counters *counters, int64_t steps, double output_seconds,
                        brunt_profile *profile) {
    *profile = (brunt_profile){.steps = steps, .output_seconds = output_seconds};
    profile->threads = brunt_world_threads(world);
    if (brunt_roofline_measure(profile->threads, &profile->bandwidth, &profile->peak, NULL))
        profile->bandwidth = profile->peak = NAN;
    profile->step_seconds = brunt_world_step_seconds(world);
    for (int k = 0; counters && k < BRUNT_COUNTERS; k++)
        profile->counted[k] = brunt_counted(counters, (brunt_counter)k);
    for (int32_t p = 0; p < brunt_pass_count(world) && p < BRUNT_PROFILE_PASSES; p++) {
        brunt_profile_row *row = &profile->rows[profile->row_count++];
        row->pass = brunt_world_pass(world, p);
        row->share = profile->step_seconds > 0 ? row->pass.seconds / profile->step_seconds : 0;
        profile->pass_seconds += row->pass.seconds;
        take_threads(row, profile->threads);
        take_work(row, profile->bandwidth, profile->peak);
        for (int k = 0; k < BRUNT_COUNTERS; k++)
            row->counted[k] = profile->counted[k] ? ratio(counters->total[k][p], row->pass.units) : NAN;
    }
}

// ------------------------------------------------------------------------------------------ as text

// A number, or a stroke where there is none, right-aligned.
static const char *cell(char text[24], int width, int digits, double value) {
    if (isfinite(value))
        snprintf(text, 24, "%*.*f", width, digits, value);
    else
        snprintf(text, 24, "%*s", width, "-");
    return text;
}

static void print_heading(const brunt_profile *profile, brunt_console *console) {
    brunt_console_print(console,
                        "profile of this leg of the run: %lld steps in %.3f s, the passes are %.1f %% of them\n",
                        (long long)profile->steps, profile->step_seconds,
                        profile->step_seconds > 0 ? 100 * profile->pass_seconds / profile->step_seconds : 0.0);
    if (isfinite(profile->bandwidth))
        brunt_console_print(console, "roofline of %d thread%s, measured now: %.1f GB/s, %.1f GFLOP/s (%s)\n",
                            profile->threads, profile->threads == 1 ? "" : "s", 1e-9 * profile->bandwidth,
                            1e-9 * profile->peak, BRUNT_REAL_NAME " precision");
    brunt_console_print(console, "  %-10s %9s %6s %9s  %-8s %9s %6s %8s %5s %-7s %7s  %s\n", "pass", "seconds", "share",
                        "calls", "unit", "ns/unit", "GB/s", "GFLOP/s", "roof", "bound", "uneven",
                        profile->threads > THREADS_SHOWN ? "least, mean, most busy [s]" : "busy threads [s]");
}

static void print_threads(const brunt_profile *profile, const brunt_profile_row *row, brunt_console *console) {
    if (profile->threads > THREADS_SHOWN)
        brunt_console_print(console, " %.3f %.3f %.3f", row->busy_least, row->busy_mean, row->busy_greatest);
    for (int t = 0; t < profile->threads && profile->threads <= THREADS_SHOWN; t++)
        brunt_console_print(console, " %.3f", row->pass.thread_seconds[t]);
    brunt_console_print(console, "\n");
}

static void print_row(const brunt_profile *profile, const brunt_profile_row *row, brunt_console *console) {
    char text[5][24];
    brunt_console_print(console, "  %-10s %9.4f %5.1f%% %9lld  %-8s %s %s %s %s%s %-7s %s ", row->pass.name,
                        row->pass.seconds, 100 * row->share, (long long)row->pass.calls, row->pass.unit,
                        cell(text[0], 9, 2, row->ns_per_unit), cell(text[1], 6, 1, 1e-9 * row->bytes_per_second),
                        cell(text[2], 8, 2, 1e-9 * row->flops_per_second), cell(text[3], 4, 0, 100 * row->roofline),
                        isfinite(row->roofline) ? "%" : " ",
                        !isfinite(row->roofline) ? "-"
                        : row->memory_bound      ? "memory"
                                                 : "compute",
                        cell(text[4], 7, 2, row->imbalance));
    print_threads(profile, row, console);
}

// What the processor counted, by pass; cycles only as instructions a cycle.
static void print_counters(const brunt_profile *profile, brunt_console *console) {
    const bool *counted = profile->counted;
    bool any = false;
    for (int k = BRUNT_COUNT_INSTRUCTIONS; k < BRUNT_COUNTERS; k++) any = any || counted[k];
    if (!any) return;
    brunt_console_print(console, "  %-10s  %-8s", "counted", "unit");
    if (counted[BRUNT_COUNT_INSTRUCTIONS]) brunt_console_print(console, " %18s", "instructions/unit");
    if (counted[BRUNT_COUNT_INSTRUCTIONS] && counted[BRUNT_COUNT_CYCLES])
        brunt_console_print(console, " %18s", "instructions/cycle");
    if (counted[BRUNT_COUNT_CACHE_MISSES]) brunt_console_print(console, " %18s", "cache misses/unit");
    if (counted[BRUNT_COUNT_BRANCH_MISSES]) brunt_console_print(console, " %18s", "branch misses/unit");
    brunt_console_print(console, "\n");
    for (int32_t p = 0; p < profile->row_count; p++) {
        const brunt_profile_row *row = &profile->rows[p];
        const double *c = row->counted;
        char text[24];
        brunt_console_print(console, "  %-10s  %-8s", row->pass.name, row->pass.unit);
        if (counted[BRUNT_COUNT_INSTRUCTIONS])
            brunt_console_print(console, " %s", cell(text, 18, 1, c[BRUNT_COUNT_INSTRUCTIONS]));
        if (counted[BRUNT_COUNT_INSTRUCTIONS] && counted[BRUNT_COUNT_CYCLES])
            brunt_console_print(console, " %s", cell(text, 18, 2, c[BRUNT_COUNT_INSTRUCTIONS] / c[BRUNT_COUNT_CYCLES]));
        if (counted[BRUNT_COUNT_CACHE_MISSES])
            brunt_console_print(console, " %s", cell(text, 18, 3, c[BRUNT_COUNT_CACHE_MISSES]));
        if (counted[BRUNT_COUNT_BRANCH_MISSES])
            brunt_console_print(console, " %s", cell(text, 18, 3, c[BRUNT_COUNT_BRANCH_MISSES]));
        brunt_console_print(console, "\n");
    }
}

void brunt_profile_print(const brunt_profile *profile, brunt_console *console) {
    print_heading(profile, console);
    for (int32_t p = 0; p < profile->row_count; p++) print_row(profile, &profile->rows[p], console);
    const double rest = profile->step_seconds - profile->pass_seconds;
    brunt_console_print(console, "  %-10s %9.4f %5.1f%%\n", "rest", rest,
                        profile->step_seconds > 0 ? 100 * rest / profile->step_seconds : 0.0);
    brunt_console_print(console, "  %-10s %9.4f  besides the steps\n", "output", profile->output_seconds);
    print_counters(profile, console);
}

// ------------------------------------------------------------------------------------------ as JSON

static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *row_object(const brunt_profile *profile, const brunt_profile_row *row) {
    const brunt_pass *pass = &row->pass;
    const bool bound = isfinite(row->roofline);
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"seconds", pass->seconds},
                   {"share", row->share},
                   {"units", pass->units},
                   {"ns_per_unit", row->ns_per_unit},
                   {"bytes_per_unit", pass->bytes_per_unit > 0 ? pass->bytes_per_unit : NAN},
                   {"flops_per_unit", pass->flops_per_unit > 0 ? pass->flops_per_unit : NAN},
                   {"bytes_per_s", row->bytes_per_second},
                   {"flops_per_s", row->flops_per_second},
                   {"roofline", row->roofline},
                   {"imbalance", row->imbalance}};
    json_t *o = json_object(), *threads = json_array();
    json_object_set_new(o, "name", json_string(pass->name));
    json_object_set_new(o, "calls", json_integer(pass->calls));
    json_object_set_new(o, "unit", json_string(pass->unit));
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
        json_object_set_new(o, numbers[n].name, number(numbers[n].value));
    json_object_set_new(o, "bound", !bound ? json_null() : json_string(row->memory_bound ? "memory" : "compute"));
    for (int t = 0; t < profile->threads; t++) json_array_append_new(threads, number(pass->thread_seconds[t]));
    json_object_set_new(o, "thread_s", threads);
    for (int k = 0; k < BRUNT_COUNTERS; k++) {
        char name[64];
        snprintf(name, sizeof name, "%s_per_unit", counter_names[k]);
        if (profile->counted[k]) json_object_set_new(o, name, number(row->counted[k]));
    }
    return o;
}

json_t *brunt_profile_json(const brunt_profile *profile) {
    json_t *o = json_object(), *passes = json_array();
    json_object_set_new(o, "threads", json_integer(profile->threads));
    json_object_set_new(o, "steps", json_integer(profile->steps));
    json_object_set_new(o, "step_s", number(profile->step_seconds));
    json_object_set_new(o, "pass_s", number(profile->pass_seconds));
    json_object_set_new(o, "output_s", number(profile->output_seconds));
    json_object_set_new(o, "bandwidth_bytes_per_s", number(profile->bandwidth));
    json_object_set_new(o, "peak_flops_per_s", number(profile->peak));
    for (int32_t p = 0; p < profile->row_count; p++)
        json_array_append_new(passes, row_object(profile, &profile->rows[p]));
    json_object_set_new(o, "passes", passes);
    return o;
}
