#include "io/run/run_files.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "io/output/history.h"
#include "io/output/vtu.h"

// What is to be written, of which each kind uses some.
typedef struct job {
    brunt_run_files *files;
    const brunt_picture_part *part; // NULL: the names of all parts, or the collection
    int64_t number;                 // of the picture
    const double *times;            // [s] of pictures
    brunt_vtu_picture *picture;
    brunt_checkpoint *checkpoint;
    brunt_history *history;
} job;

static int path_of(const job *j, const char *name, char path[BRUNT_PATH_LENGTH], brunt_error *error) {
    return brunt_output_path(j->files->folder, name, path, error);
}

static int list_parts(void *context, brunt_error *error) {
    const job *j = context;
    return brunt_run_folder_list_picture(j->files->folder, &j->files->parts, j->number, error);
}

static int write_part(void *context, brunt_error *error) {
    const job *j = context;
    char path[BRUNT_PATH_LENGTH], name[128];
    brunt_picture_name(name, j->part, j->number);
    int status = path_of(j, name, path, error);
    return status ? status : brunt_vtu_put(path, j->picture, j->files->scene->output.float32, error);
}

static int write_collection(void *context, brunt_error *error) {
    const job *j = context;
    char path[BRUNT_PATH_LENGTH];
    int status = path_of(j, "brunt.pvd", path, error);
    if (!status) status = brunt_pvd_write(path, &j->files->parts, j->times, j->number + 1, error);
    if (!status) j->files->pictures = j->number + 1;
    return status;
}

static int write_checkpoint(void *context, brunt_error *error) {
    const job *j = context;
    char path[BRUNT_PATH_LENGTH], backup[BRUNT_PATH_LENGTH];
    int status = brunt_history_sync(j->files->history, error);
    if (!status) status = path_of(j, "checkpoint.h5", path, error);
    if (!status) status = path_of(j, "checkpoint.previous.h5", backup, error);
    return status ? status : brunt_checkpoint_put(j->checkpoint, path, backup, j->files->scene_text, error);
}

static int write_history(void *context, brunt_error *error) {
    const job *j = context;
    char path[BRUNT_PATH_LENGTH];
    double start = brunt_clock();
    int status = path_of(j, "history.h5", path, error);
    if (!status) status = brunt_history_write(j->history, path, error);
    j->files->history_seconds = brunt_clock() - start;
    return status;
}

static void release(void *context) {
    job *j = context;
    brunt_vtu_release(j->picture);
    brunt_checkpoint_release(j->checkpoint);
    brunt_free(j->history);
    brunt_free(j);
}

// Takes over what the job has.
static int give(brunt_run_files *files, int (*write)(void *, brunt_error *), job what, brunt_error *error) {
    job *j = brunt_alloc(sizeof *j);
    what.files = files;
    if (j) {
        *j = what;
        return brunt_writer_give(files->writer, (brunt_job){write, release, j}, error);
    }
    brunt_vtu_release(what.picture);
    brunt_checkpoint_release(what.checkpoint);
    brunt_free(what.history);
    return brunt_fail(error, BRUNT_FAILED, "out of memory while writing files");
}

static brunt_vtu_picture *take(brunt_run_files *files, const brunt_picture_part *part, brunt_error *error) {
    const brunt_output_def *output = &files->scene->output;
    if (part->kind == BRUNT_PICTURE_BODY)
        return brunt_vtu_take_body(files->world, part->index, (const char(*)[64])output->fields, output->field_count,
                                   error);
    return part->kind == BRUNT_PICTURE_LINKS ? brunt_vtu_take_links(files->world, error)
                                             : brunt_vtu_take_boundary(files->world, part->index, error);
}

int brunt_run_files_picture(brunt_run_files *files, int64_t number, const double *times, brunt_error *error) {
    int status = give(files, list_parts, (job){.number = number}, error);
    for (int32_t p = 0; p < files->parts.count && !status; p++) {
        const brunt_picture_part *part = &files->parts.part[p];
        brunt_vtu_picture *picture = take(files, part, error);
        status = picture ? give(files, write_part, (job){.number = number, .part = part, .picture = picture}, error)
                         : BRUNT_FAILED;
    }
    return status ? status : brunt_run_files_collection(files, number + 1, times, error);
}

int brunt_run_files_collection(brunt_run_files *files, int64_t count, const double *times, brunt_error *error) {
    return give(files, write_collection, (job){.number = count - 1, .times = times}, error);
}

int brunt_run_files_checkpoint(brunt_run_files *files, const brunt_run_state *state, brunt_error *error) {
    brunt_checkpoint *checkpoint = brunt_checkpoint_take(files->world, state, error);
    return checkpoint ? give(files, write_checkpoint, (job){.checkpoint = checkpoint}, error) : BRUNT_FAILED;
}

int brunt_run_files_history(brunt_run_files *files, brunt_error *error) {
    brunt_history *still = brunt_history_still(files->history, error);
    return still ? give(files, write_history, (job){.history = still}, error) : BRUNT_FAILED;
}

int brunt_run_files_start(brunt_run_files *files, int64_t pictures, brunt_error *error) {
    files->pictures = pictures;
    int status = brunt_picture_parts_list(&files->parts, files->world, error);
    if (status) return status;
    files->writer = brunt_writer_start(brunt_world_threads(files->world) > 1, error);
    return files->writer ? BRUNT_OK : BRUNT_FAILED;
}

void brunt_run_files_end(brunt_run_files *files) {
    brunt_writer_end(files->writer);
    brunt_picture_parts_free(&files->parts);
}

int brunt_run_files_wait(brunt_run_files *files, brunt_error *error) { return brunt_writer_wait(files->writer, error); }

bool brunt_run_files_failed(brunt_run_files *files) { return brunt_writer_failed(files->writer); }
