// A run: the loop around the time step that writes what the scene asks for, and leaves a folder a later leg can go
// on from.
//
// In the folder: summary.json, history.h5 and history.csv, brunt.pvd with vtu/, checkpoint.h5 and
// checkpoint.previous.h5, scene.yaml as resolved, log.txt, and brunt.files, which lists them: what it does not list is
// neither replaced nor removed (output_folder.h), and one run at a time has the folder. Pictures are of exactly their
// times, lines of the history of the first step at or after theirs; a run stopped and resumed takes the same steps.
#pragma once

#include <signal.h>
#include <stdio.h>

#include "io/output/history.h"
#include "io/performance/progress.h"
#include "io/scene/scene.h"

typedef struct brunt_run_options {
    const char *folder;                // NULL: out/<scene name>
    bool resume;                       // go on from the folder's checkpoint
    bool fresh;                        // begin anew though the folder has the checkpoint of an unfinished run
    bool profile;                      // print what each pass cost
    const char *trace;                 // file for a time line of the run (trace.h), of this leg alone; NULL: none
    FILE *console;                     // NULL: all is kept in log.txt alone
    FILE *messages;                    // mistakes found before the run, one a line; NULL: only the first is in `error`
    const volatile sig_atomic_t *stop; // checkpoint and stop as soon as it is not 0; may be NULL
    volatile sig_atomic_t *save;       // checkpoint as soon as it is not 0, then set to 0; may be NULL
} brunt_run_options;

// BRUNT_OK, BRUNT_BAD_INPUT (nothing was touched), BRUNT_FAILED (the picture, checkpoint and summary say where),
// BRUNT_IO_ERROR, or BRUNT_STOPPED. Whatever is not BRUNT_OK is explained in `error`.
int brunt_run(const brunt_scene *scene, const brunt_run_options *options, brunt_error *error);

// Checks what only the made world can tell: that fields, probes and measures name something. Prints every mistake to
// `messages` (may be NULL), the first is in `error`.
int brunt_run_check(const brunt_scene *scene, brunt_world *world, const brunt_history *history, FILE *messages,
                    brunt_error *error);
// What is doubtful about a scene and the world made of it, each line after "warning: ".
void brunt_run_warn(const brunt_scene *scene, const brunt_world *world, brunt_console *console);
// Warnings of the world from number `from` on.
void brunt_run_warn_from(const brunt_world *world, int32_t from, brunt_console *console);
