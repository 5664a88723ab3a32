#include "io/run/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "io/output/checkpoint.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/output/measures.h"
#include "base/array.h"
#include "base/memory.h"
#include "io/performance/observers.h"
#include "io/performance/progress.h"
#include "io/output/tractions.h"
#include "io/run/run_files.h"
#include "io/run/summary.h"
#include "base/parallel.h"
#include "io/performance/trace.h"

// An output time counts as reached within this relative distance: two series of times may differ by rounding where they
// meet.
static const double time_tolerance = 1e-12;

typedef struct run {
    const brunt_scene *scene;
    const brunt_run_options *options;
    brunt_output_folder output;
    const char *folder; // its path
    brunt_world *world;
    brunt_history *history;
    double *measure_initial;           // one a measure
    char *scene_text;                  // as resolved; from the C library
    brunt_run_state state;             // clocks hold what earlier legs spent, plus output and steps of this one
    size_t picture_capacity;           // [bytes]
    double next_picture, next_history; // [s] of the world
    double leg_start, leg_output;      // [s] of the clock, [s] written by this leg
    int64_t first_step;                // of this leg
    double checkpoint_wall, history_wall, history_cost; // [s] when last taken, [s] it took to write
    brunt_run_files files;
    brunt_console console;
    brunt_trace *trace; // NULL: none
    brunt_observers observers;
    brunt_counters counters;
    bool counting; // the processor's counters are open
    bool told;     // the mistakes have been printed
} run;

static int path_in(const run *r, const char *name, char out[BRUNT_PATH_LENGTH], brunt_error *error) {
    return brunt_output_path(&r->output, name, out, error);
}

static double cpu_clock(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// ---------------------------------------------------------------------------------------------------- output times

static bool reached(double time, double due) { return time >= due - time_tolerance * fabs(due); }

// The first multiple of `every` after `time`. From the multiples, not by adding up, so that a resumed run meets the
// same times.
static double next_time(double time, double every) {
    if (every == 0 || isinf(every)) return INFINITY;
    double number = floor(time / every * (1 + time_tolerance) + 1e-9) + 1;
    return number * every;
}

static void schedule(run *r) {
    double time = brunt_world_time(r->world);
    r->next_picture = next_time(time, r->scene->output.every);
    r->next_history = next_time(time, r->scene->output.history);
}

// ---------------------------------------------------------------------------------------------------- writing

static void trace_output(const run *r, const char *what, double start) {
    if (r->trace) brunt_trace_output(r->trace, what, start, brunt_clock());
}

static int sample_history(run *r, brunt_error *error) {
    double start = brunt_clock();
    int status = brunt_history_sample(r->history, r->world, error);
    trace_output(r, "history", start);
    return status;
}

// All that was given is on the disk, or has failed. Pictures that are not whole do not count.
static int settle(run *r, brunt_error *error) {
    const int status = brunt_run_files_wait(&r->files, error);
    r->state.picture_count = r->files.pictures;
    r->history_cost = r->files.history_seconds;
    return status;
}

// The same after something was given, unless that has failed already.
static int settled(run *r, int status, brunt_error *error) {
    brunt_error late = {0};
    const int failed = settle(r, &late);
    return status || !failed ? status : brunt_hand_on(error, &late);
}

static int write_picture(run *r, brunt_error *error) {
    const double start = brunt_clock();
    const int64_t number = r->state.picture_count;
    if (BRUNT_RESERVE_IN(r->state.picture_times, r->picture_capacity, (size_t)(number + 1), (size_t)number))
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld pictures", (long long)number);
    r->state.picture_times[r->state.picture_count++] = brunt_world_time(r->world);
    int status = brunt_run_files_picture(&r->files, number, r->state.picture_times, error);
    trace_output(r, "picture", start);
    return status;
}

static int write_history(run *r, brunt_error *error) {
    const double start = r->history_wall = brunt_clock();
    int status = brunt_run_files_history(&r->files, error);
    trace_output(r, "history file", start);
    return status;
}

// The state with the clocks as of now.
static brunt_run_state state_now(const run *r) {
    brunt_run_state state = r->state;
    state.history_lines = brunt_history_rows(r->history);
    state.history_hash = brunt_history_hash(r->history);
    state.wall_seconds += brunt_clock() - r->leg_start;
    state.cpu_seconds += cpu_clock();
    return state;
}

static int write_checkpoint(run *r, const char *failure, brunt_error *error) {
    const double start = r->checkpoint_wall = brunt_clock();
    brunt_run_state state = state_now(r);
    if (failure) {
        state.failed = true;
        state.withdrawn = brunt_world_step_withdrawn(r->world);
        snprintf(state.reason, sizeof state.reason, "%s", failure);
    }
    int status = brunt_run_files_checkpoint(&r->files, &state, error);
    trace_output(r, "checkpoint", start);
    return status;
}

static bool picture_is_here(const run *r) {
    int64_t n = r->state.picture_count;
    return n > 0 && r->state.picture_times[n - 1] == brunt_world_time(r->world);
}

static bool history_is_here(const run *r) { return brunt_history_time(r->history) == brunt_world_time(r->world); }

// What is due after a step (or, with `last`, at the end). History first, then pictures, then the checkpoint that counts
// them: those of one time at most are being written beside the steps, so that memory is bounded.
static int write_outputs(run *r, bool last, brunt_error *error) {
    const brunt_output_def *output = &r->scene->output;
    double time = brunt_world_time(r->world), start = brunt_clock();
    bool picture = reached(time, r->next_picture) || (last && !isinf(output->every));
    bool history = output->history == 0 || reached(time, r->next_history) || last;
    bool checkpoint = last || (output->checkpoint == 0 ? picture : start - r->checkpoint_wall >= output->checkpoint);
    // The HDF5 history is made anew as a whole: every half minute, or more rarely once that takes over a twentieth of
    // the time.
    bool save_history = last || start - r->history_wall >= fmax(30, 20 * r->history_cost);
    int status = BRUNT_OK;
    if (history && !history_is_here(r)) status = sample_history(r, error);
    const bool shown = !picture || picture_is_here(r);
    if (!status && (!shown || checkpoint || save_history || brunt_run_files_failed(&r->files)))
        status = settle(r, error);
    if (!status && !shown) status = write_picture(r, error);
    if (!status && checkpoint) status = write_checkpoint(r, NULL, error);
    if (!status && save_history) status = write_history(r, error);
    if (!status && last) status = settle(r, error);
    if (!status && r->console.log_failed)
        status = brunt_fail(error, BRUNT_IO_ERROR, "%s/log.txt: cannot write the file", r->folder);
    if (picture || history) schedule(r);
    double spent = brunt_clock() - start;
    r->state.output_seconds += spent;
    r->leg_output += spent;
    return status;
}

// ---------------------------------------------------------------------------------------------------- before the first
// step

static int make_scene_text(run *r, brunt_error *error) {
    size_t length;
    FILE *stream = open_memstream(&r->scene_text, &length);
    if (!stream) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    int status = brunt_scene_write(r->scene, stream);
    if (fclose(stream) || status) return brunt_fail(error, BRUNT_FAILED, "the resolved scene could not be written");
    return BRUNT_OK;
}

static uint64_t hash_places(uint64_t hash, const double (*place)[3], int32_t count) {
    for (int64_t i = 0; i < 3 * (int64_t)count; i++) {
        uint64_t word;
        memcpy(&word, &place[i / 3][i % 3], sizeof word);
        hash = brunt_hash_add(hash, word);
    }
    return hash;
}

static uint64_t hash_mesh(uint64_t hash, const brunt_mesh *mesh) {
    hash = hash_places(hash, (const double(*)[3])mesh->nodes, mesh->node_count);
    int64_t corners = mesh->element_count ? (int64_t)mesh->element_count * brunt_element_nodes(mesh->kind) : 0;
    for (int64_t i = 0; i < corners; i++) hash = brunt_hash_add(hash, (uint64_t)mesh->elements[i]);
    for (int32_t g = 0; g < mesh->group_count; g++)
        for (int32_t n = 0; n < mesh->groups[g].count; n++)
            hash = brunt_hash_add(hash, (uint64_t)mesh->groups[g].nodes[n]);
    return hash;
}

// Of the meshes that were read from files, of bodies, boundaries and the grid: a run must not go on with another mesh
// that happens to be of the same size.
static uint64_t hash_meshes(const brunt_scene *scene) {
    const brunt_world_def *world = &scene->world;
    uint64_t hash = 0;
    for (int32_t b = 0; b < world->body_count; b++) hash = hash_mesh(hash, &world->bodies[b].mesh);
    for (int32_t k = 0; k < world->surface_count && world->dimension == 3; k++) { // lines stand in the scene
        const brunt_boundary_surface_def *s = &world->surfaces[k];
        hash = hash_places(hash, (const double(*)[3])s->point, s->point_count);
        for (int64_t i = 0; i < 4 * (int64_t)s->facet_count; i++)
            hash = brunt_hash_add(hash, (uint64_t)s->facet[i / 4][i % 4]);
    }
    return hash_mesh(hash, &world->background);
}

// Makes world, history and measures. Nothing on disk is touched.
static int make_world(run *r, brunt_error *error) {
    const brunt_scene *scene = r->scene;
    brunt_error local = {0};
    brunt_error *found = error ? error : &local;
    r->world = brunt_world_create(&scene->world, found);
    if (r->world) r->history = brunt_history_create(r->world, scene, found);
    if (!r->world || !r->history) {
        r->told = r->options->messages && found->code == BRUNT_BAD_INPUT;
        if (r->told) brunt_scene_complain(scene, found->message, r->options->messages);
        return found->code;
    }
    int status = brunt_run_check(scene, r->world, r->history, r->options->messages, found);
    r->told = status != BRUNT_OK;
    r->measure_initial = brunt_alloc(sizeof *r->measure_initial * (size_t)scene->measure_count);
    if (!status && !r->measure_initial) status = brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int32_t m = 0; m < scene->measure_count && !status; m++)
        status = brunt_measure_initial(&scene->measures[m], r->world, &r->measure_initial[m], error);
    r->state.mesh_hash = hash_meshes(scene);
    if (!status) status = brunt_scene_take_values(scene, r->world, error);
    if (!status) status = make_scene_text(r, error);
    if (status) return status;
    r->state.identity = brunt_checkpoint_identity(r->scene_text, r->state.mesh_hash);
    brunt_history_identify(r->history, r->state.identity);
    return BRUNT_OK;
}

// A run goes on as if the step that has changed nothing had not been tried: its picture is none of those that were due.
static void forget_failure(run *r) {
    const double time = brunt_world_time(r->world), every = r->scene->output.every;
    int64_t *count = &r->state.picture_count;
    const bool due = *count > 1 ? reached(time, next_time(r->state.picture_times[*count - 2], every)) : time == 0;
    if (picture_is_here(r) && !due) --*count;
    r->state.failed = r->state.withdrawn = false, r->state.reason[0] = 0;
}

static int restore(run *r, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH];
    const uint64_t mesh_hash = r->state.mesh_hash, identity = r->state.identity;
    int status = path_in(r, "checkpoint.h5", path, error);
    if (!status && !brunt_output_has(&r->output, "checkpoint.h5") &&
        brunt_output_has(&r->output, "checkpoint.previous.h5"))
        status = brunt_fail(error, BRUNT_BAD_INPUT,
                            "%s: is not there; put checkpoint.previous.h5, the one before it, in its place", path);
    if (!status) status = brunt_checkpoint_read(path, r->world, r->scene_text, &r->state, error);
    if (status) return status;
    r->state.identity = identity;
    if (r->state.mesh_hash != mesh_hash)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: a mesh file has changed since the checkpoint was written", path);
    r->picture_capacity = sizeof(double) * (size_t)r->state.picture_count;
    if (r->state.failed) forget_failure(r);
    // The clocks of this process start now; those in the checkpoint are of the legs before.
    r->state.cpu_seconds -= cpu_clock();
    status = path_in(r, "history.h5", path, error);
    if (!status && brunt_file_exists(path)) status = brunt_history_check_file(r->history, path, error);
    if (!status) status = path_in(r, "history.csv", path, error);
    if (!status) status = brunt_history_resume(r->history, path, r->state.history_lines, r->state.history_hash, error);
    if (status) return status;
    double time = brunt_world_time(r->world), end = brunt_world_end(r->world);
    if (!reached(end, time))
        return brunt_fail(error, BRUNT_BAD_INPUT, "time.end is %g s, but the checkpoint in %s is of t = %g s", end,
                          r->folder, time);
    return BRUNT_OK;
}

static int prepare_folder(run *r, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH];
    int status = brunt_run_folder_prepare(&r->output, r->options, r->scene_text, error);
    if (status) return status;
    r->console.log = brunt_output_stream(&r->output, "log.txt", !r->options->resume, error);
    if (!r->console.log) return BRUNT_IO_ERROR;
    status = path_in(r, "history.csv", path, error);
    return status ? status : brunt_history_open_csv(r->history, path, error);
}

static int write_first(run *r, brunt_error *error) {
    double start = brunt_clock();
    int status = sample_history(r, error);
    if (!status && !isinf(r->scene->output.every)) status = write_picture(r, error);
    // A first checkpoint: a run killed before the second can be resumed, and a disk too small for one is found now.
    if (!status && !isinf(r->scene->output.checkpoint)) status = write_checkpoint(r, NULL, error);
    if (!status) status = write_history(r, error);
    double spent = brunt_clock() - start;
    r->state.output_seconds += spent;
    r->leg_output += spent;
    return status;
}

// ---------------------------------------------------------------------------------------------------- the end

static int finish(run *r, const char *status_name, const char *reason, bool evaluate, brunt_error *error) {
    const brunt_scene *scene = r->scene;
    brunt_measure_result *results = NULL;
    int status = BRUNT_OK;
    if (evaluate) {
        results = brunt_alloc(sizeof *results * (size_t)scene->measure_count);
        if (!results) status = brunt_fail(error, BRUNT_FAILED, "out of memory");
        if (!status) status = brunt_measures_fetch(scene->measures, scene->measure_count, r->history, error);
        for (int32_t m = 0; m < scene->measure_count && !status; m++)
            status = brunt_measure_evaluate(&scene->measures[m], r->history, r->world, r->measure_initial[m],
                                            &results[m], error);
    }
    brunt_run_state now = state_now(r);
    brunt_summary summary = {.status = status_name,
                             .reason = reason,
                             .wall_seconds = now.wall_seconds,
                             .cpu_seconds = now.cpu_seconds,
                             .step_seconds = now.step_seconds,
                             .output_seconds = now.output_seconds,
                             .peak_bytes = brunt_summary_peak(),
                             .state_hash = brunt_world_hash(r->world),
                             .results = status ? NULL : results};
    brunt_summary_print(&summary, scene, r->world, &r->console);
    brunt_profile profile;
    if (r->options->profile) {
        brunt_profile_make(r->world, r->counting ? &r->counters : NULL, brunt_world_steps(r->world) - r->first_step,
                           r->leg_output, &profile);
        brunt_profile_print(&profile, &r->console);
        summary.profile = &profile;
    }
    char path[BRUNT_PATH_LENGTH];
    if (!status) status = path_in(r, "summary.json", path, error);
    if (!status) status = brunt_summary_write(path, &summary, scene, r->world, error);
    // They are of a step, which one that goes on from its end has not taken: what is there stays.
    const bool tells = scene->output.tractions && brunt_world_steps(r->world) > r->first_step;
    if (!status && tells) status = path_in(r, "tractions.csv", path, error);
    if (!status && tells) status = brunt_tractions_write(path, r->world, error);
    if (!status) brunt_console_print(&r->console, "results are in %s (open brunt.pvd in ParaView)\n", r->folder);
    brunt_free(results);
    return status;
}

// The failing state is kept to be looked at; what goes wrong here must not hide why the run failed.
static void finish_failed(run *r, brunt_error *error) {
    char reason[sizeof error->message];
    memcpy(reason, error->message, sizeof reason);
    brunt_error second = {0};
    if (error->code == BRUNT_FAILED) {
        if (!picture_is_here(r) && settled(r, write_picture(r, &second), &second))
            brunt_console_print(&r->console, "no picture of the failure: %s\n", second.message);
        if (settled(r, write_checkpoint(r, reason, &second), &second))
            brunt_console_print(&r->console, "no checkpoint of the failure: %s\n", second.message);
        if (settled(r, write_history(r, &second), &second))
            brunt_console_print(&r->console, "no history.h5 of the failure: %s\n", second.message);
    }
    if (brunt_world_step_withdrawn(r->world))
        brunt_console_print(
            &r->console,
            "the step has changed nothing: --resume goes on from t = %.9g s, also by other keys of newton, "
            "time.step, contact.slip_speed, contact.friction_iterations\n",
            brunt_world_time(r->world));
    if (finish(r, "failed", reason, false, &second))
        brunt_console_print(&r->console, "no summary: %s\n", second.message);
    memcpy(error->message, reason, sizeof reason);
}

// ---------------------------------------------------------------------------------------------------- the loop

static int serve_signals(run *r, brunt_error *error) {
    const brunt_run_options *options = r->options;
    bool stop = options->stop && *options->stop, save = options->save && *options->save;
    if (!stop && !save) return BRUNT_OK;
    if (save) *options->save = 0;
    int status = settle(r, error);
    if (!status) status = write_checkpoint(r, NULL, error);
    if (!status) status = write_history(r, error);
    status = settled(r, status, error);
    if (status) return status;
    brunt_console_print(&r->console, "checkpoint at t = %.9g s, step %lld\n", brunt_world_time(r->world),
                        (long long)brunt_world_steps(r->world));
    return stop ? brunt_fail(error, BRUNT_STOPPED, "stopped by a signal at t = %.9g s; go on with --resume",
                             brunt_world_time(r->world))
                : BRUNT_OK;
}

static bool is_asked_to_stop(void *context) {
    const brunt_run_options *options = context;
    return *options->stop;
}

static int loop(run *r, brunt_error *error) {
    brunt_progress progress = brunt_progress_start(&r->console, r->world);
    double end = brunt_world_end(r->world);
    int32_t warned = brunt_warning_count(r->world);
    const brunt_stop stop = {is_asked_to_stop, (void *)(uintptr_t)r->options};
    if (r->options->stop) brunt_world_heed(r->world, &stop);
    int status = BRUNT_OK;
    while (!status && !reached(brunt_world_time(r->world), end)) {
        status = serve_signals(r, error);
        if (status) break;
        double start = brunt_clock(), before = brunt_world_step_seconds(r->world);
        status = brunt_world_step(r->world, r->next_picture, error);
        if (status == BRUNT_STOPPED) status = serve_signals(r, error);
        r->state.step_seconds += brunt_world_step_seconds(r->world) - before; // without what observers took
        if (r->trace) brunt_trace_step(r->trace, start, brunt_clock());
        if (warned < brunt_warning_count(r->world)) {
            brunt_run_warn_from(r->world, warned, &r->console);
            warned = brunt_warning_count(r->world);
        }
        if (!status) status = write_outputs(r, false, error);
        if (!status) brunt_progress_update(&progress, r->world);
    }
    brunt_progress_end(&progress);
    return status ? status : write_outputs(r, true, error);
}

static int start_observers(run *r, brunt_error *error) {
    if (r->options->trace) {
        r->trace = brunt_trace_open(r->options->trace, r->scene->name, r->world, r->leg_start, error);
        if (!r->trace) return error->code;
        brunt_observers_add(&r->observers, brunt_trace_observer(r->trace));
    }
    if (r->counting) brunt_observers_add(&r->observers, brunt_counters_observer(&r->counters));
    brunt_observers_watch(&r->observers, r->world);
    return BRUNT_OK;
}

// After the last file has been written; also when the run has failed, which comes before what goes wrong here.
static int end_trace(run *r, int status, brunt_error *error) {
    if (!r->trace) return status;
    brunt_trace_count count;
    brunt_error second = {0};
    brunt_world_observe(r->world, NULL);
    int failed = brunt_trace_close(r->trace, &count, &second);
    r->trace = NULL;
    if (failed)
        brunt_console_print(&r->console, "no trace: %s\n", second.message);
    else
        brunt_console_print(&r->console, "trace: %lld events in %s (open in ui.perfetto.dev)\n",
                            (long long)count.events, r->options->trace);
    if (!failed && count.left_out)
        brunt_console_print(&r->console, "trace: %lld of %lld steps are left out, with %lld events\n",
                            (long long)count.steps_left_out, (long long)count.steps, (long long)count.left_out);
    if (status || !failed) return status;
    *error = second;
    return failed;
}

// What could not be written is of a time before that of a step that failed: the run ends as if it had been waited for.
static int end_files(run *r, int status, brunt_error *error) {
    brunt_error late = {0};
    return settle(r, &late) ? brunt_hand_on(error, &late) : status;
}

static int start_files(run *r, brunt_error *error) {
    r->files = (brunt_run_files){
        .scene = r->scene, .world = r->world, .history = r->history, .folder = &r->output, .scene_text = r->scene_text};
    return brunt_run_files_start(&r->files, r->state.picture_count, error);
}

static int run_made(run *r, brunt_error *error) {
    int status = r->options->resume ? restore(r, error) : BRUNT_OK;
    if (!status) status = prepare_folder(r, error);
    if (!status) status = start_observers(r, error);
    if (!status) status = start_files(r, error);
    if (status) return status;
    r->checkpoint_wall = r->history_wall = brunt_clock();
    r->first_step = brunt_world_steps(r->world);
    if (r->options->resume) {
        brunt_console_print(&r->console, "resumed at t = %.9g s, step %lld\n", brunt_world_time(r->world),
                            (long long)brunt_world_steps(r->world));
        // Pictures later than the checkpoint are no part of the collection any more.
        if (r->state.picture_count)
            status = brunt_run_files_collection(&r->files, r->state.picture_count, r->state.picture_times, error);
    } else {
        char counts[64];
        brunt_counts(r->world, counts);
        brunt_console_print(&r->console, "%s: %s, to t = %g s, into %s\n", r->scene->name, counts,
                            brunt_world_end(r->world), r->folder);
        brunt_run_warn(r->scene, r->world, &r->console);
        status = write_first(r, error);
    }
    schedule(r);
    if (!status) status = loop(r, error);
    status = end_files(r, status, error);
    if (status == BRUNT_OK) {
        char reason[64];
        snprintf(reason, sizeof reason, "reached t = %.9g s", brunt_world_time(r->world));
        return finish(r, "done", reason, true, error);
    }
    if (status == BRUNT_STOPPED) {
        brunt_error second = {0};
        int written = finish(r, "stopped", error->message, false, &second);
        if (written) *error = second;
        return written ? written : status;
    }
    error->code = status;
    finish_failed(r, error);
    return status;
}

int brunt_run(const brunt_scene *scene, const brunt_run_options *options, brunt_error *error) {
    brunt_error local = {0};
    if (!error) error = &local;
    memset(error, 0, sizeof *error);
    error->id = -1;
    run *r = brunt_alloc(sizeof *r);
    if (!r) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    r->scene = scene;
    r->options = options;
    r->output = (brunt_output_folder){.folder = -1, .index = -1};
    r->folder = r->output.path;
    r->leg_start = brunt_clock();
    r->console = brunt_console_open(options->console);
    char path[BRUNT_PATH_LENGTH];
    int status = brunt_join_path(path, "out", scene->name, error);
    if (options->profile) r->counting = brunt_counters_open(&r->counters); // threads made from now on are counted
    if (!status) status = make_world(r, error);
    if (!status)
        status = brunt_run_folder_open(&r->output, scene, options, options->folder ? options->folder : path, error);
    if (!status) status = end_trace(r, run_made(r, error), error);
    if (status == BRUNT_BAD_INPUT && options->messages && !r->told) fprintf(options->messages, "%s\n", error->message);
    if (r->console.log) fclose(r->console.log);
    brunt_run_files_end(&r->files);
    brunt_output_close(&r->output);
    brunt_run_state_free(&r->state);
    brunt_history_destroy(r->history);
    brunt_world_destroy(r->world);
    if (r->counting) brunt_counters_close(&r->counters);
    brunt_free(r->measure_initial);
    free(r->scene_text);
    brunt_free(r);
    error->code = status;
    return status;
}
