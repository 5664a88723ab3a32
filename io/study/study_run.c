// The runs of a study, one at a time, each in a folder of its own that says whether it is finished and of what.
//
// FOLDER/brunt.files lists what a study wrote, its runs' files as well; only that is replaced or removed
// (output_folder.h). FOLDER/runs/CASE.rREPEAT/ keeps summary.json, log.txt, scene.yaml and run.json; the last, written
// when all else is, holds the key of the run: a hash over the program, the scene as resolved, its mesh files, the
// number of threads and the kind of machine. A folder whose key is the same is taken over, failed runs too; all others
// are run again.
#include "base/array.h"
#include "io/study/study_reader.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file/atomic_file.h"
#include "io/study/child.h"
#include "io/study/run_record.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/performance/machine.h"
#include "base/memory.h"
#include "io/file/output_folder.h"
#include "io/performance/progress.h"
#include "io/scene/scene_reader.h"
#include "io/study/study_hash.h"
#include "io/study/study_view.h"

typedef struct case_state {
    uint64_t key;
    char name[160];      // of its folders, without the repeat
    char state_hash[24]; // of the first repeat; "": none yet
    double elapsed;      // [s] of one run, with start and output; NAN: not known
} case_state;

typedef struct runner {
    brunt_study *study;
    const brunt_study_options *options;
    brunt_output_folder output;
    char folder[BRUNT_PATH_LENGTH], program[BRUNT_PATH_LENGTH];
    case_state *cases;
    char hashed[BRUNT_PATH_LENGTH]; // file whose hash was taken last
    uint64_t hashed_value;
    int32_t dimension;
    int32_t finished, total; // runs
    bool broken_promise;     // repeats that ended in different bits
} runner;

__attribute__((format(printf, 2, 3))) static void say(const runner *r, const char *format, ...) {
    if (!r->options->console) return;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(r->options->console, format, arguments);
    va_end(arguments);
    fflush(r->options->console);
}

static bool stop_asked(const runner *r) { return r->options->stop && *r->options->stop; }

// ---------------------------------------------------------------------------------------------------- keys

// Programs are large and mostly the same one.
static int hash_program(runner *r, const char *path, uint64_t *hash, brunt_error *error) {
    if (strcmp(r->hashed, path) != 0) {
        r->hashed_value = 0;
        int status = study_hash_file(path, &r->hashed_value, error);
        if (status) return status;
        snprintf(r->hashed, sizeof r->hashed, "%s", path);
    }
    *hash = brunt_hash_add(*hash, r->hashed_value);
    return BRUNT_OK;
}

static const char *program_of(const runner *r, const study_job *job) {
    return *job->program ? job->program : r->program;
}

static int hash_scene(runner *r, const study_job *job, uint64_t *hash, brunt_error *error) {
    brunt_scene scene;
    char *text = NULL;
    size_t length = 0;
    if (brunt_scene_read(job->scene, (const char *const *)job->sets, job->set_count, &scene, NULL))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s has changed while the study was read", job->scene);
    FILE *out = open_memstream(&text, &length);
    int status = out ? brunt_scene_write(&scene, out) : BRUNT_IO_ERROR;
    if (out) fclose(out);
    if (!status) *hash = study_hash_bytes(*hash, text, length);
    status = status ? brunt_fail(error, status, "out of memory") : study_hash_meshes(&scene, hash, error);
    r->dimension = scene.world.dimension;
    free(text);
    brunt_scene_free(&scene);
    return status;
}

// "APIC,quadratic,2_mm": what is no good in the name of a folder becomes _, and a hash then keeps it apart.
static void name_case(const brunt_study *study, const brunt_study_case *c, char out[160]) {
    char all[BRUNT_STUDY_AXES * 66 + 1] = "";
    uint64_t hash = 0;
    bool changed = false;
    for (int32_t a = 0; a < study->axis_count; a++) {
        const char *label = study->axes[a].values[c->value[a]].label;
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", a ? "," : "", label);
        hash = study_hash_bytes(hash, label, strlen(label));
        changed |= strchr(label, ',') || strchr(label, '_');
    }
    for (char *p = all; *p; p++) {
        if (isalnum((unsigned char)*p) || strchr(",.-+_", *p)) continue;
        changed |= *p != ' ';
        *p = '_';
    }
    if (all[0] == '.') all[0] = '_', changed = true;
    if (changed || strlen(all) > 120)
        snprintf(out, 160, "%.100s-%08x", all, (unsigned)(hash & 0xffffffffu));
    else
        snprintf(out, 160, "%.120s", all);
}

static int prepare_case(runner *r, int32_t index, brunt_error *error) {
    const brunt_study_case *c = &r->study->cases[index];
    case_state *state = &r->cases[index];
    study_job job;
    study_origin culprit;
    state->elapsed = NAN;
    name_case(r->study, c, state->name);
    int status = brunt_study_job(r->study, c, &job, &culprit, error);
    if (!status) status = hash_program(r, program_of(r, &job), &state->key, error);
    if (!status) status = hash_scene(r, &job, &state->key, error);
    state->key = brunt_hash_add(state->key, (uint64_t)job.threads);
    char machine[128]; // times of another one do not go with those of this
    brunt_machine_name(machine);
    state->key = study_hash_bytes(state->key, machine, strlen(machine));
    brunt_study_job_free(&job);
    return status;
}

// ---------------------------------------------------------------------------------------------------- folders

// What is in the folder of a run, from the study itself and from any program; what else a program of ours wrote there
// its own list says.
static const char *const kept[] = {"run.json", "summary.json", "log.txt", "scene.yaml", "messages.txt"},
                         *const passing[] = {"brunt.pvd", "history.h5", "history.csv", "checkpoint.h5",
                                             "checkpoint.previous.h5"};
enum { KEPT = sizeof kept / sizeof *kept, PASSING = sizeof passing / sizeof *passing };

static void remove_in(const char *folder, const char *const *names, size_t count) {
    char path[BRUNT_PATH_LENGTH];
    for (size_t n = 0; n < count; n++)
        if (brunt_join_path(path, folder, names[n], NULL) == BRUNT_OK) unlink(path);
}

// Histories, pictures and checkpoints of all the runs of a study would fill disks.
static int remove_outputs(const char *folder, bool all, brunt_error *error) {
    brunt_output_folder output;
    int status = brunt_output_open(&output, folder, error);
    if (!status) status = all ? brunt_output_remove(&output, error) : brunt_output_clear(&output, kept, KEPT, error);
    brunt_output_close(&output);
    if (!status) remove_in(folder, passing, PASSING);
    return status;
}

// run.json goes first: a folder that is half emptied must not count as finished.
static int remove_run(const char *folder, brunt_error *error) {
    remove_in(folder, kept, 1);
    int status = remove_outputs(folder, true, error);
    if (!status) remove_in(folder, kept, KEPT);
    if (!status) rmdir(folder); // stays with what else is in it
    return status;
}

// Those that are listed. Folders that hold something else as well stay, with that in them.
static int remove_all_runs(const runner *r, brunt_error *error) {
    static const char record[] = "/run.json";
    char path[BRUNT_PATH_LENGTH];
    int status = BRUNT_OK;
    for (int32_t n = 0; n < r->output.count && !status; n++) {
        const char *name = r->output.names[n];
        size_t length = strlen(name), end = sizeof record - 1;
        if (strncmp(name, "runs/", 5) != 0 || length <= end || strcmp(name + length - end, record) != 0) continue;
        status = brunt_join_path(path, r->folder, name, error);
        if (status) return status;
        path[strlen(path) - end] = 0;
        struct stat info;
        if (lstat(path, &info) == 0 && S_ISDIR(info.st_mode)) status = remove_run(path, error);
    }
    return status;
}

static void run_name(const runner *r, int32_t index, int32_t repeat, char out[200]) {
    snprintf(out, 200, "runs/%s.r%d", r->cases[index].name, (int)repeat + 1);
}

static int run_folder(const runner *r, int32_t index, int32_t repeat, char out[BRUNT_PATH_LENGTH], brunt_error *error) {
    char name[200];
    run_name(r, index, repeat, name);
    return brunt_join_path(out, r->folder, name, error);
}

// ---------------------------------------------------------------------------------------------------- one run

static int start_run(const runner *r, const study_job *job, const char *folder, brunt_child_end *end,
                     brunt_error *error) {
    char threads[16], messages[BRUNT_PATH_LENGTH];
    const char **words = brunt_alloc((size_t)(2 * job->set_count + 9) * sizeof *words);
    int count = 0, status = words ? brunt_join_path(messages, folder, "messages.txt", error)
                                  : brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (status) return status;
    snprintf(threads, sizeof threads, "%d", (int)job->threads);
    words[count++] = program_of(r, job);
    words[count++] = "run";
    words[count++] = job->scene;
    for (int32_t s = 0; s < job->set_count; s++) {
        words[count++] = "--set";
        words[count++] = job->sets[s];
    }
    words[count++] = "-o";
    words[count++] = folder;
    words[count++] = "-q";
    words[count++] = "-t";
    words[count++] = threads;
    words[count] = NULL;
    status = brunt_child_run((char *const *)words, messages, r->study->time_limit, r->options->stop, end, error);
    struct stat info;
    if (!status && stat(messages, &info) == 0 && info.st_size == 0) unlink(messages);
    brunt_free(words);
    return status;
}

static int run_anew(const runner *r, int32_t index, const char *folder, run_result *result, brunt_error *error) {
    study_job job;
    study_origin culprit;
    brunt_child_end end;
    *result = (run_result){.limit = NAN};
    int status = remove_run(folder, error);
    if (!status) status = brunt_make_folder(folder, error);
    if (status) return status;
    status = brunt_study_job(r->study, &r->study->cases[index], &job, &culprit, error);
    if (!status) status = start_run(r, &job, folder, &end, error);
    brunt_study_job_free(&job);
    if (status) return status;
    if (end.fate == BRUNT_CHILD_STOPPED) {
        status = remove_run(folder, error);
        return status ? status : brunt_fail(error, BRUNT_STOPPED, "stopped; go on with the same command");
    }
    run_record_judge(r->study, folder, &end, result);
    status = remove_outputs(folder, false, error);
    return status ? status : run_record_write(folder, r->cases[index].key, result, error);
}

// ---------------------------------------------------------------------------------------------------- results

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void take_times(brunt_study_case *c) {
    double sorted[1000];
    int32_t n = c->runs;
    memcpy(sorted, c->wall, (size_t)n * sizeof *sorted);
    qsort(sorted, (size_t)n, sizeof *sorted, by_size);
    c->wall_median = n % 2 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
    c->wall_least = sorted[0];
    c->wall_greatest = sorted[n - 1];
}

static void take_result(runner *r, int32_t index, const run_result *result) {
    brunt_study_case *c = &r->study->cases[index];
    case_state *state = &r->cases[index];
    state->elapsed = result->elapsed;
    if (result->status == BRUNT_STUDY_FAILED) {
        c->status = BRUNT_STUDY_FAILED;
        snprintf(c->reason, sizeof c->reason, "%s", result->reason);
        r->finished += r->study->repeats - c->runs; // its other repeats are not run
        return;
    }
    c->wall[c->runs++] = result->wall;
    r->finished++;
    take_times(c);
    c->peak_bytes = fmax(c->peak_bytes, result->peak);
    if (!*state->state_hash) {
        snprintf(state->state_hash, sizeof state->state_hash, "%s", result->state_hash);
        c->steps = result->steps;
        c->units = result->units;
        memcpy(c->result, result->value, sizeof c->result);
        memcpy(c->expect, result->expect, sizeof c->expect);
        memcpy(c->unit, result->unit, sizeof c->unit);
    } else if (strcmp(state->state_hash, result->state_hash) != 0) {
        c->status = BRUNT_STUDY_FAILED;
        r->broken_promise = true;
        r->finished += r->study->repeats - c->runs;
        snprintf(c->reason, sizeof c->reason,
                 "repeat %d ended in another state (%s) than repeat 1 (%s): the same bits are promised", (int)c->runs,
                 result->state_hash, state->state_hash);
        return;
    }
    if (c->runs == r->study->repeats) c->status = BRUNT_STUDY_DONE;
}

// [s] of a run that has not been made: that of the most alike case, its steps scaled by the cells and steps that the
// resolutions let expect, start and output as they are.
static double expected_time(const runner *r, int32_t index) {
    const brunt_study *study = r->study;
    if (isfinite(r->cases[index].elapsed)) return r->cases[index].elapsed;
    double best = INFINITY, time = NAN, h = brunt_study_resolution(study, &study->cases[index]);
    for (int32_t k = 0; k < study->case_count; k++) {
        if (!isfinite(r->cases[k].elapsed) || study->cases[k].status == BRUNT_STUDY_FAILED) continue;
        double ratio = brunt_study_resolution(study, &study->cases[k]) / h;
        if (!isfinite(ratio)) ratio = 1;
        double distance = 10 * fabs(log(ratio)) + (study->cases[k].line != study->cases[index].line);
        if (distance >= best) continue;
        best = distance;
        double steps = study->cases[k].wall_median;
        time = r->cases[k].elapsed + steps * (pow(ratio, r->dimension + 1) - 1);
    }
    return isfinite(time) ? fmin(time, study->time_limit) : 0;
}

// "; about 3 min left", or nothing when nothing is known.
static void write_left(const runner *r, char out[64]) {
    double left = 0;
    bool known = false;
    for (int32_t k = 0; k < r->study->case_count; k++) {
        const brunt_study_case *c = &r->study->cases[k];
        known |= isfinite(r->cases[k].elapsed) && c->status != BRUNT_STUDY_FAILED;
        if (c->status == BRUNT_STUDY_WAITING) left += (r->study->repeats - c->runs) * expected_time(r, k);
    }
    char duration[32];
    out[0] = 0;
    if (!known || !isfinite(left) || r->finished == r->total) return;
    brunt_duration(left, duration);
    snprintf(out, 64, "; about %s left", duration);
}

// "error 1.2 %", or the value where the reference is still to come.
static void write_outcome(const runner *r, const brunt_study_case *c, char out[128]) {
    const brunt_study_measure *measure = &r->study->measures[0];
    bool known = measure->reference == BRUNT_REFERENCE_NUMBER || measure->reference == BRUNT_REFERENCE_TABLE;
    double error =
        known ? fabs(c->result[0] - brunt_study_truth_of(r->study, c, 0).value) / brunt_study_scale_of(r->study, c, 0)
              : NAN;
    char percent[32];
    brunt_study_format_percent(error, percent);
    if (isfinite(error))
        snprintf(out, 128, "error %s", percent);
    else
        snprintf(out, 128, "%.60s %.6g %s", measure->name, c->result[0], c->unit[0]);
}

static void say_run(const runner *r, int32_t index, int32_t repeat, double wall) {
    const brunt_study_case *c = &r->study->cases[index];
    char label[320], again[48] = "", outcome[128], seconds[32], left[64];
    brunt_study_case_label(r->study, c, label);
    if (r->study->repeats > 1)
        snprintf(again, sizeof again, ", repeat %d of %d", (int)repeat + 1, (int)r->study->repeats);
    write_left(r, left);
    write_outcome(r, c, outcome);
    brunt_study_format_seconds(wall, seconds);
    if (c->status == BRUNT_STUDY_FAILED)
        say(r, "[%d of %d] %s%s: failed: %s%s\n", r->finished, r->total, label, again, c->reason, left);
    else
        say(r, "[%d of %d] %s%s: %s, %s%s\n", r->finished, r->total, label, again, outcome, seconds, left);
}

static int one_run(runner *r, int32_t index, int32_t repeat, brunt_error *error) {
    char folder[BRUNT_PATH_LENGTH];
    run_result result;
    int status = run_folder(r, index, repeat, folder, error);
    if (status) return status;
    bool there = run_record_take_over(r->study, r->cases[index].key, folder, &result);
    if (!there && stop_asked(r)) return brunt_fail(error, BRUNT_STOPPED, "stopped; go on with the same command");
    if (!there) status = run_anew(r, index, folder, &result, error);
    if (status) return status;
    take_result(r, index, &result);
    if (!there) say_run(r, index, repeat, result.wall);
    return BRUNT_OK;
}

// The first repeat of all cases, then the second: when the machine grows slower in between, it does so for all alike.
static int run_all(runner *r, brunt_error *error) {
    int status = BRUNT_OK;
    for (int32_t repeat = 0; repeat < r->study->repeats && !status; repeat++)
        for (int32_t c = 0; c < r->study->case_count && !status; c++)
            if (r->study->cases[c].status == BRUNT_STUDY_WAITING) status = one_run(r, c, repeat, error);
    return status;
}

// ---------------------------------------------------------------------------------------------------- the study

static int32_t count_earlier(const runner *r) {
    int32_t count = 0;
    for (int32_t c = 0; c < r->study->case_count; c++)
        for (int32_t repeat = 0; repeat < r->study->repeats; repeat++) {
            char folder[BRUNT_PATH_LENGTH];
            run_result result;
            if (run_folder(r, c, repeat, folder, NULL) != BRUNT_OK ||
                !run_record_take_over(r->study, r->cases[c].key, folder, &result))
                break;
            count += result.status == BRUNT_STUDY_FAILED ? r->study->repeats - repeat : 1;
            if (result.status == BRUNT_STUDY_FAILED) break;
        }
    return count;
}

// Of a measure, and after them of the order and of the cost.
static void picture_name(const brunt_study *study, int32_t index, char out[160]) {
    if (index < study->measure_count)
        brunt_study_picture_name(study, index, out);
    else
        snprintf(out, 160, "%s", index == study->measure_count ? "study_order" : "study_cost");
}

// The names of the study's own files: report and tables, of each picture three files, then the runs' folders with
// theirs.
static char **own_names(const runner *r, int32_t *count) {
    static const char *const tables[] = {"report.md", "study.csv", "study.json"}, *const endings[] = {".gp", ".svg",
                                                                                                      ".png"};
    const int32_t pictures = r->study->measure_count + 2, runs = r->total;
    const size_t room = 256;
    const int32_t most = 4 + 3 * pictures + (KEPT + PASSING + 2) * runs;
    char **names = brunt_alloc((size_t)most * (sizeof *names + room)), *text = (char *)(names + most), picture[160],
         run[200];
    *count = 0;
    for (int32_t n = 0; names && n < most; n++) names[n] = text + room * (size_t)n;
    for (int t = 0; names && t < BRUNT_COUNT(tables); t++) snprintf(names[(*count)++], room, "%s", tables[t]);
    for (int32_t p = 0; names && p < pictures; p++) {
        picture_name(r->study, p, picture);
        for (int e = 0; e < BRUNT_COUNT(endings); e++) snprintf(names[(*count)++], room, "%s%s", picture, endings[e]);
    }
    if (names) snprintf(names[(*count)++], room, "runs/");
    for (int32_t n = 0; names && n < runs; n++) {
        run_name(r, n / r->study->repeats, n % r->study->repeats, run);
        snprintf(names[(*count)++], room, "%s/", run);
        for (int k = 0; k < KEPT; k++) snprintf(names[(*count)++], room, "%s/%s", run, kept[k]);
        for (int k = 0; k < PASSING; k++) snprintf(names[(*count)++], room, "%s/%s", run, passing[k]);
    }
    return names;
}

// What stands in the way of a run within its folder and is not listed there either.
static int look_at_run(const runner *r, int32_t index, int32_t repeat, brunt_obstacles *found, brunt_error *error) {
    brunt_output_folder own;
    char folder[BRUNT_PATH_LENGTH], name[200], whole[256];
    run_name(r, index, repeat, name);
    snprintf(whole, sizeof whole, "%s/", name);
    brunt_output_obstacle(&r->output, whole, found);
    int status = run_folder(r, index, repeat, folder, error);
    if (status || found->count) return status;
    status = brunt_output_open(&own, folder, error);
    for (int k = 0; k < KEPT + PASSING && !status; k++) {
        const char *file = k < KEPT ? kept[k] : passing[k - KEPT];
        snprintf(whole, sizeof whole, "%s/%s", name, file);
        if (!brunt_output_listed(&own, file)) brunt_output_obstacle(&r->output, whole, found);
    }
    brunt_output_close(&own);
    return status;
}

static int open_folder(runner *r, brunt_error *error) {
    brunt_obstacles found = {0};
    int32_t count;
    char **names = own_names(r, &count);
    int status = names ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int32_t n = 0; n < count && !strchr(names[n], '/'); n++) brunt_output_obstacle(&r->output, names[n], &found);
    brunt_output_obstacle(&r->output, "runs/", &found);
    for (int32_t n = 0; n < r->total && !status; n++)
        status = look_at_run(r, n / r->study->repeats, n % r->study->repeats, &found, error);
    if (!status) status = brunt_output_refuse(&r->output, &found, error);
    if (!status) status = brunt_output_make(&r->output, error);
    if (!status && r->options->fresh) status = remove_all_runs(r, error);
    if (!status) status = brunt_output_list(&r->output, (const char *const *)names, count, error);
    brunt_free(names);
    return status;
}

static int prepare(runner *r, brunt_error *error) {
    const brunt_study_options *options = r->options;
    char runs[BRUNT_PATH_LENGTH], name[160];
    snprintf(name, sizeof name, "out/study/%.140s", r->study->name);
    int status = brunt_output_open(&r->output, options->folder ? options->folder : name, error);
    memcpy(r->folder, r->output.path, sizeof r->folder);
    if (!status) status = brunt_join_path(runs, r->folder, "runs", error);
    snprintf(r->program, sizeof r->program, "%s", options->program);
    r->total = r->study->case_count * r->study->repeats;
    r->cases = brunt_alloc((size_t)(r->study->case_count + 1) * sizeof *r->cases);
    if (!r->cases && !status) status = brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int32_t c = 0; c < r->study->case_count && !status; c++) status = prepare_case(r, c, error);
    if (!status) status = open_folder(r, error);
    if (!status) status = brunt_make_folder(runs, error);
    if (status) return status;
    int32_t earlier = count_earlier(r);
    say(r, "%s: %d runs of %d cases into %s", r->study->name, r->total, r->study->case_count, r->folder);
    if (earlier)
        say(r, "; %d of them are there from earlier\n", earlier);
    else
        say(r, "\n");
    return BRUNT_OK;
}

// ", NAME" when the file is there.
static bool say_file(const runner *r, const char *name, const char *before) {
    char path[BRUNT_PATH_LENGTH];
    if (brunt_join_path(path, r->folder, name, NULL) || !brunt_file_exists(path)) return false;
    say(r, "%s%s", before, name);
    return true;
}

static void say_files(const runner *r, bool drawn) {
    char script[176], picture[176], name[160];
    bool pictures = false, scripts = false;
    say(r, "results are in %s: ", r->folder);
    say_file(r, "report.md", ""), say_file(r, "study.csv", ", "), say_file(r, "study.json", ", ");
    const int32_t measures = r->study->measure_count;
    for (int32_t m = 0; m < measures + 2; m++) { // and the order, and the cost
        picture_name(r->study, m, name);
        snprintf(script, sizeof script, "%s.gp", name), snprintf(picture, sizeof picture, "%s.png", name);
        if (drawn)
            pictures |= say_file(r, picture, ", ");
        else
            scripts |= say_file(r, script, ", ");
    }
    say(r, "%s\n", pictures ? " (and .svg)" : scripts ? "; no gnuplot here, so no pictures" : "");
}

static int write_all(const runner *r, brunt_error *error) {
    bool drawn = false;
    brunt_study_analyse(r->study);
    int status = brunt_study_write_tables(r->study, r->folder, error);
    if (!status) status = brunt_study_write_plots(r->study, r->folder, &drawn, error);
    if (!status) status = brunt_study_write_report(r->study, r->folder, error);
    if (status) return status;
    if (r->options->console) brunt_study_print(r->study, r->options->console);
    say_files(r, drawn);
    return BRUNT_OK;
}

static int verdict(const runner *r, brunt_error *error) {
    int32_t done = 0;
    for (int32_t c = 0; c < r->study->case_count; c++) done += r->study->cases[c].status == BRUNT_STUDY_DONE;
    if (r->broken_promise) return brunt_fail(error, BRUNT_FAILED, "repeats of a case ended in different bits");
    return done ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "no case came to its end");
}

int brunt_study_run(brunt_study *study, const brunt_study_options *options, brunt_error *error) {
    brunt_error local = {0};
    if (!error) error = &local;
    memset(error, 0, sizeof *error);
    runner *r = brunt_alloc(sizeof *r);
    if (!r) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    r->study = study;
    r->options = options;
    r->output = (brunt_output_folder){.folder = -1, .index = -1};
    int status = prepare(r, error);
    if (!status) status = run_all(r, error);
    if (!status) status = write_all(r, error);
    if (!status) status = verdict(r, error);
    brunt_output_close(&r->output);
    brunt_free(r->cases);
    brunt_free(r);
    return status;
}
