// What a run's output will cost: bytes over rates, and two things that are measured since they differ by far between
// scenes and between disks: a line of history, and a file that is kept.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file/atomic_file.h"
#include "io/performance/predict.h"
#include "base/parallel.h"

// From the summaries of bench/scenes: bytes that are compressed, and what a file
// costs that is empty; then HDF5 with checksums.
static const double picture_rate = 70e6, file_seconds = 0.3e-3, checkpoint_rate = 400e6, cell_seconds = 0.4e-6,
                    column_seconds = 150e-6, block_bytes = 3e6;

// What the disk takes to keep a file, written aside, flushed and renamed: where none was, and in the place of one,
// which may take ten times as long. In a folder of its own in the working folder, removed again; 0 where none can be
// made.
static void commit_seconds(double *fresh, double *replaced) {
    static const char content[1 << 14];
    enum { TIMES = 4 };
    char folder[] = ".brunt-check-XXXXXX", path[2 * TIMES][32];
    double at[2 * TIMES + 1];
    int kept = 0;
    brunt_error error;
    *fresh = *replaced = 0;
    if (!mkdtemp(folder)) return;
    for (; kept < 2 * TIMES; kept++) {
        brunt_atomic_file file;
        snprintf(path[kept], sizeof path[kept], "%s/%d", folder, kept < TIMES ? kept : TIMES - 1);
        at[kept] = brunt_clock();
        if (brunt_atomic_open(&file, path[kept], &error) ||
            brunt_atomic_write(&file, content, sizeof content, &error) || brunt_atomic_commit(&file, &error))
            break;
    }
    at[kept] = brunt_clock();
    if (kept == 2 * TIMES) {
        *fresh = (at[TIMES] - at[0]) / TIMES;
        *replaced = (at[2 * TIMES] - at[TIMES]) / TIMES;
    }
    for (int i = 0; i < TIMES && i < kept; i++) unlink(path[i]);
    rmdir(folder);
}

static double numbers_of(brunt_world *world, int32_t body, const char *field) {
    int32_t f = brunt_body_find_field(world, body, field);
    if (f < 0) return 0;
    brunt_field_info info = brunt_body_field(world, body, f);
    return (double)brunt_body_size(world, body, info.at) * info.components;
}

// Bytes of one body's picture before they are compressed.
static double picture_bytes(const brunt_scene *scene, brunt_world *world, int32_t body) {
    static const char *const of_elements[] = {"displacement", "velocity",         "stress",       "plastic_strain",
                                              "contact_gap",  "contact_traction", "contact_state"};
    const brunt_output_def *o = &scene->output;
    const bool mesh = brunt_body_method(world, body) != BRUNT_MPM;
    double width = o->float32 ? 4 : 8,
           points = (double)brunt_body_size(world, body, mesh ? BRUNT_AT_NODES : BRUNT_AT_PARTICLES);
    double bytes = points * (3 * width + 8);
    if (mesh)
        bytes +=
            (double)brunt_body_elements(world, body) * (8 + 4 * brunt_element_nodes(brunt_body_element(world, body)));
    for (int32_t f = 0; f < o->field_count; f++) {
        if (strcmp(o->fields[f], "default")) {
            bytes += width * numbers_of(world, body, o->fields[f]);
        } else if (mesh) {
            for (size_t d = 0; d < sizeof of_elements / sizeof *of_elements; d++)
                bytes += width * numbers_of(world, body, of_elements[d]);
        } else {
            bytes += width * numbers_of(world, body, "velocity");
        }
    }
    return bytes;
}

static double state_bytes(brunt_world *world) {
    double bytes = 0;
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        brunt_state_block block = brunt_state_info(world, b);
        bytes += (double)block.count * (block.type == 'd' || block.type == 'i' ? 8 : block.type == 'f' ? 4 : 1);
    }
    return bytes;
}

// Multiples of `every` in the run and its start; with 0 what `each` says.
static double count_of(double every, double end, double each) {
    return isinf(every) ? 0 : every > 0 ? floor(end / every * (1 + 1e-9)) + 1 : each;
}

int brunt_predict_output(const brunt_scene *scene, brunt_world *world, brunt_history *history, brunt_prediction *out,
                         double *buffer_bytes, brunt_error *error) {
    const brunt_output_def *o = &scene->output;
    double end = scene->world.end, pictures = count_of(o->every, end, 2),
           steps = fmax(out->steps, pictures) + 1,             // no step goes beyond a picture
        lines = fmin(count_of(o->history, end, steps), steps); // one a step at most
    double line = INFINITY, bytes = 0, most = 0;
    for (int s = 0; s < 3; s++) {
        double start = brunt_clock();
        int status = brunt_history_sample(history, world, error);
        if (status) return status;
        line = fmin(line, brunt_clock() - start);
    }
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        double one = picture_bytes(scene, world, b);
        bytes += one;
        most = fmax(most, one);
    }
    const int threads = brunt_world_threads(world);
    double columns = brunt_history_column_count(history), checkpoints = isinf(o->checkpoint) ? 1 : 2;
    if (o->checkpoint == 0) checkpoints = fmax(pictures, 1);
    double state = state_bytes(world), fresh, replaced;
    commit_seconds(&fresh, &replaced);
    const double work = pictures * bytes / picture_rate + checkpoints * state / checkpoint_rate,
                 disk = pictures * (brunt_body_count(world) * (file_seconds + fresh) + file_seconds + replaced) +
                        checkpoints * 2 * (file_seconds + replaced) + 2 * columns * column_seconds;
    out->output_seconds = lines * (line + columns * cell_seconds);
    // Beside the steps files take a thread from them while they are made, and time of their own where steps are through
    // before them.
    if (threads > 1)
        out->output_seconds += work / threads + fmax(0, work + disk - out->step_seconds);
    else
        out->output_seconds += work + disk;
    // Of a picture, one body at a time, or all where steps go on, the values are doubles before they are written,
    // whatever its width; HDF5 builds a checkpoint in memory, which it lets grow by doubling.
    // Of the history a block of lines, and the columns that measures ask for with that of time.
    if (threads > 1) most = bytes;
    *buffer_bytes = (o->float32 ? 2 : 1) * most * (pictures > 0) + 2 * state + block_bytes +
                    8 * lines * (1 + (double)scene->measure_count);
    out->pictures = pictures;
    out->picture_bytes = pictures * bytes;
    out->lines = lines;
    out->line_bytes = lines * brunt_history_line_bytes(history);
    out->checkpoint_bytes = isinf(o->checkpoint) ? 0 : 2 * state;
    return BRUNT_OK;
}
