// Checkpoints: all a run needs to go on with the same bits, in one HDF5 file that is whole or not there.
//
// Contents: the world's state blocks under /state, the scene as resolved in /scene, the times of the pictures in
// /picture_times, and version, precision, time, step and clocks as attributes. The checkpoint before is kept beside it.
#pragma once

#include <stdio.h>

#include "brunt.h"

// What the run adds to the world's state.
typedef struct brunt_run_state {
    double *picture_times; // [s] of the pictures so far; owned
    int64_t picture_count;
    double wall_seconds, cpu_seconds, step_seconds, output_seconds; // [s] spent so far, over all legs of the run
    bool failed;    // written where the computation failed, to be looked at,
    bool withdrawn; // by a step that has changed nothing: only such can be resumed
    char reason[1024];
    double time; // [s] of the world
    int64_t step;
    int64_t history_lines; // of the history up to here, and
    uint64_t history_hash; // what they are: brunt_history_hash
    uint64_t mesh_hash;    // of the mesh files' contents, which are no part of the scene's text
    uint64_t identity;     // of what is computed: brunt_checkpoint_identity
} brunt_run_state;

void brunt_run_state_free(brunt_run_state *state);

// The state of a world and its run, taken: written later, it is what was there then, but for the times of pictures,
// which stay the run's. NULL and BRUNT_FAILED: there is no memory for it.
typedef struct brunt_checkpoint brunt_checkpoint;
brunt_checkpoint *brunt_checkpoint_take(brunt_world *world, const brunt_run_state *state, brunt_error *error);
// Writes it to `path`, once; a file already there is kept as `backup`. Looks at no world.
int brunt_checkpoint_put(brunt_checkpoint *checkpoint, const char *path, const char *backup, const char *scene_text,
                         brunt_error *error);
void brunt_checkpoint_release(brunt_checkpoint *checkpoint); // may be NULL

// A number for what a run computes: the scene less what may change between its legs, and its meshes. In the checkpoint
// and the history.
uint64_t brunt_checkpoint_identity(const char *scene_text, uint64_t mesh_hash);

// Restores a world made from the same scene: everything but time.end, output, measures and title must agree, and how
// the equations of implicit steps are solved (the number of threads is no part of a scene). Fills `state`, to be freed.
// BRUNT_BAD_INPUT, with what differs, when it cannot be resumed.
int brunt_checkpoint_read(const char *path, brunt_world *world, const char *scene_text, brunt_run_state *state,
                          brunt_error *error);

// True for one that was written where the computation failed; false for any other, and where it cannot be told.
bool brunt_checkpoint_failed(const char *path);
// Says what a checkpoint holds.
int brunt_checkpoint_describe(const char *path, FILE *out, brunt_error *error);
