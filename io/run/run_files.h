// The files of a run: taken from the world at once, written beside the steps that follow (io/file/writer.h), in the
// order in which they are given. So a picture is whole before the collection names it, and both before a checkpoint
// counts it.
//
// Where steps have one thread there is none beside them, and files are written before these functions return. What they
// return is the first failure of those up to then; nothing is written after it until brunt_run_files_wait has told it.
#pragma once

#include "io/file/writer.h"
#include "io/output/checkpoint.h"
#include "io/run/run_folder.h"

typedef struct brunt_run_files {
    const brunt_scene *scene;
    brunt_world *world;
    const brunt_history *history;
    brunt_output_folder *folder;
    const char *scene_text; // as resolved
    brunt_picture_parts parts;
    brunt_writer *writer;
    int64_t pictures;       // that are whole and in the collection, and
    double history_seconds; // [s] that history.h5 took: valid after brunt_run_files_wait
} brunt_run_files;

// With the members before `parts` set. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_run_files_start(brunt_run_files *files, int64_t pictures, brunt_error *error);
// Writes what was given. Of one that has not been started: nothing.
void brunt_run_files_end(brunt_run_files *files);

// Picture `number` of the world as it is; `times` [s] of all up to it, which stay as they are until it is written.
int brunt_run_files_picture(brunt_run_files *files, int64_t number, const double *times, brunt_error *error);
// The collection alone, of `count` pictures.
int brunt_run_files_collection(brunt_run_files *files, int64_t count, const double *times, brunt_error *error);
// The times of pictures in `state` stay as they are until it is written. The lines of the history that it counts are on
// the disk before it is.
int brunt_run_files_checkpoint(brunt_run_files *files, const brunt_run_state *state, brunt_error *error);
// history.h5 with the lines there are.
int brunt_run_files_history(brunt_run_files *files, brunt_error *error);

int brunt_run_files_wait(brunt_run_files *files, brunt_error *error);
bool brunt_run_files_failed(brunt_run_files *files);
