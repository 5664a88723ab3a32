#include "io/run/run_folder.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "io/output/checkpoint.h"
#include "base/error.h"
#include "io/run/summary.h"
#include "io/performance/trace.h"

static const char *const files[] = {"scene.yaml",    "log.txt",    "summary.json",  "brunt.pvd",
                                    "history.csv",   "history.h5", "checkpoint.h5", "checkpoint.previous.h5",
                                    "tractions.csv", "vtu/"};
enum { FILES = sizeof files / sizeof *files };

// ---------------------------------------------------------------------------------------------------- what stays

static bool same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

static int refuse_scene_itself(const brunt_output_folder *folder, const brunt_scene *scene, brunt_error *error) {
    struct stat own, there;
    if (folder->folder < 0 || stat(scene->source, &own)) return BRUNT_OK;
    for (int f = 0; f < FILES; f++)
        if (fstatat(folder->folder, files[f], &there, AT_SYMLINK_NOFOLLOW) == 0 && same_file(&own, &there))
            return brunt_fail(
                error, BRUNT_BAD_INPUT,
                "%s: the scene itself would be replaced by the output; copy it, or choose another folder (-o)",
                scene->source);
    return BRUNT_OK;
}

// A run that has ended has said so in its summary; one that failed may be resumed when its checkpoint is not of the
// failure. Where a file can have one name only, a kill may have left the checkpoint before alone.
static int refuse_unfinished(const brunt_output_folder *folder, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH], status_name[16];
    if (!brunt_output_has(folder, "checkpoint.h5") && !brunt_output_has(folder, "checkpoint.previous.h5"))
        return BRUNT_OK;
    int status = brunt_join_path(path, folder->path, "summary.json", error);
    if (status) return status;
    brunt_summary_status(path, status_name);
    if (!strcmp(status_name, "done")) return BRUNT_OK;
    status = brunt_join_path(path, folder->path, "checkpoint.h5", error);
    if (status) return status;
    if (!strcmp(status_name, "failed") && brunt_checkpoint_failed(path)) return BRUNT_OK;
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "%s: holds the checkpoint of an unfinished run: --resume goes on with it, --fresh begins anew and "
        "removes it",
        folder->path);
}

// A trace may lie in the folder, but not as one of the files there.
static int refuse_trace(const brunt_output_folder *folder, const char *trace, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH], part[BRUNT_PATH_LENGTH];
    const char *slash = strrchr(trace, '/'), *leaf = slash ? slash + 1 : trace;
    struct stat of_trace, of_folder;
    int length = slash ? (int)(slash - trace) : 0;
    snprintf(path, sizeof path, "%.*s", slash == trace ? 1 : slash ? length : 1, slash ? trace : ".");
    if (folder->folder < 0 || stat(path, &of_trace) || fstat(folder->folder, &of_folder)) return BRUNT_OK;
    bool taken = !strcmp(leaf, BRUNT_OUTPUT_LIST);
    for (int f = 0; f < FILES; f++) {
        snprintf(part, sizeof part, "%s.part", files[f]);
        taken |= !strcmp(leaf, files[f]) || !strcmp(leaf, part);
    }
    taken &= same_file(&of_trace, &of_folder);
    if (fstatat(folder->folder, "vtu", &of_folder, AT_SYMLINK_NOFOLLOW) == 0) taken |= same_file(&of_trace, &of_folder);
    return taken ? brunt_fail(error, BRUNT_BAD_INPUT,
                              "%s: the run itself writes there; another name for the trace is wanted", trace)
                 : BRUNT_OK;
}

static int refuse_foreign(const brunt_output_folder *folder, const brunt_scene *scene, brunt_error *error) {
    brunt_obstacles found = {0};
    for (int f = 0; f < FILES; f++) brunt_output_obstacle(folder, files[f], &found);
    const brunt_body_def *bodies = scene->world.bodies;
    brunt_names names;
    if (bodies && brunt_names_sort(&names, bodies[0].name, sizeof *bodies, scene->world.body_count, error))
        return BRUNT_FAILED;
    if (bodies) brunt_output_numbered_obstacles(folder, "vtu", &names, ".vtu", &found);
    if (bodies) brunt_names_free(&names);
    return brunt_output_refuse(folder, &found, error);
}

int brunt_run_folder_open(brunt_output_folder *folder, const brunt_scene *scene, const brunt_run_options *options,
                          const char *path, brunt_error *error) {
    int status = brunt_output_open(folder, path, error);
    if (!status) status = refuse_scene_itself(folder, scene, error);
    if (!status) status = refuse_foreign(folder, scene, error);
    if (!status && !options->resume && !options->fresh) status = refuse_unfinished(folder, error);
    if (!status && options->trace) status = brunt_trace_refuse(options->trace, error);
    if (!status && options->trace) status = refuse_trace(folder, options->trace, error);
    return status;
}

// ---------------------------------------------------------------------------------------------------- ready

static int write_scene(const brunt_output_folder *folder, const char *text, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH];
    brunt_atomic_file file;
    int status = brunt_join_path(path, folder->path, "scene.yaml", error);
    if (!status) status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    fputs(text, file.stream);
    return brunt_atomic_commit(&file, error);
}

// A folder that takes the new scene will take the rest: only then the run before goes.
int brunt_run_folder_prepare(brunt_output_folder *folder, const brunt_run_options *options, const char *scene_text,
                             brunt_error *error) {
    static const char *const stays[] = {"scene.yaml"};
    int status = brunt_output_make(folder, error);
    if (!status && options->trace) status = refuse_trace(folder, options->trace, error);
    if (!status && options->trace) status = brunt_trace_check(options->trace, error);
    if (!status) status = brunt_output_list(folder, files, FILES, error);
    if (!status) status = write_scene(folder, scene_text, error);
    if (!status && options->resume) {
        brunt_output_remove_leftovers(folder);
        unlinkat(folder->folder, "summary.json", 0); // it is of the leg before, which had come to an end
    } else if (!status && folder->count) {           // of a run before
        status = brunt_output_clear(folder, stays, BRUNT_COUNT(stays), error);
        if (!status) status = brunt_output_list(folder, files, FILES, error);
    }
    if (!status && mkdirat(folder->folder, "vtu", 0777) && !brunt_output_has(folder, "vtu/"))
        status = brunt_fail(error, BRUNT_IO_ERROR, "%s/vtu: cannot make the folder", folder->path);
    return status;
}

int brunt_run_folder_list_picture(brunt_output_folder *folder, const brunt_picture_parts *parts, int64_t number,
                                  brunt_error *error) {
    enum { AT_ONCE = 256 };
    char names[AT_ONCE][128];
    const char *pointers[AT_ONCE];
    int status = BRUNT_OK;
    for (int32_t p = 0; p < parts->count && !status;) {
        int32_t count = 0;
        brunt_obstacles found = {0};
        brunt_output_obstacle(folder, "vtu/", &found);
        for (; count < AT_ONCE && p < parts->count; count++, p++) {
            brunt_picture_name(names[count], &parts->part[p], number);
            pointers[count] = names[count];
            brunt_output_obstacle(folder, names[count], &found);
        }
        if (found.count)
            return brunt_fail(error, BRUNT_IO_ERROR, "%s: came here while brunt was at work, and is not its own: %s",
                              folder->path, found.names);
        status = brunt_output_list(folder, pointers, count, error);
    }
    return status;
}
