// What a run will cost, found by rehearsing it.
//
// Time. A few steps of the world itself say what each pass costs at its size, on its threads. They say nothing of what
// comes later: contact, plastic flow, steps that shrink as material is pressed together, bodies that spread. All of
// that shows in the same world made of larger cells and elements, by a factor f: its whole run costs 1 / f^(d+1) of
// the time. What a pass costs there later, beyond its first steps, is scaled up by the points it goes over and added.
// A run that is short is rehearsed as it is.
#pragma once

#include "io/output/history.h"
#include "io/scene/scene.h"

enum { BRUNT_PREDICTION_PASSES = 32 };

typedef struct brunt_prediction_pass {
    char name[32];
    double seconds; // [s] of the clock, all steps together
} brunt_prediction_pass;

typedef struct brunt_prediction {
    double first_step;      // [s] of the world's time
    double steps;           // of the whole run
    double step_seconds;    // [s] of the clock in them
    double output_seconds;  // [s] that pictures, history, checkpoints hold the steps up
    double pictures, lines; // of bodies together, and of the history
    double picture_bytes, line_bytes,
        checkpoint_bytes; // [B] of all of them on the disk; pictures before they are compressed
    double array_bytes;   // [B] of the world's arrays at the start
    double peak_bytes;    // [B] of the process: program, arrays as they grow, history, buffers of a picture
    brunt_prediction_pass passes[BRUNT_PREDICTION_PASSES]; // the plan's, in its order, then "other" between them
    int32_t pass_count;
    double sampled_steps, sampled_seconds; // taken of the world itself, and [s] of the clock in them
    double factor;                         // how much coarser the rehearsal was; 1: the run itself, 0: there was none
    double rehearsed;                      // [-] share of the run's time that was seen so
    double growth;                         // [-] of the arrays, from the start to the end
    double rehearsal_seconds;              // [s] of the clock, sampling included
    char note[512];                        // what the prediction does not see, or ""; one sentence
} brunt_prediction;

// Predicts the run of a scene. `world` and `history` are as made of it, and are stepped and written to; nothing goes to
// a file. Takes some 3 s at most. `quick`: no rehearsal, steps and passes as at the start.
// BRUNT_FAILED when the world cannot take its first steps; a run or a rehearsal that fails later is a note.
int brunt_predict(const brunt_scene *scene, brunt_world *world, brunt_history *history, bool quick,
                  brunt_prediction *prediction, brunt_error *error);

// --- predict_output.c: fills output_seconds, for `steps` as predicted. `buffer_bytes`: [B] that output takes at most.
int brunt_predict_output(const brunt_scene *scene, brunt_world *world, brunt_history *history,
                         brunt_prediction *prediction, double *buffer_bytes, brunt_error *error);
