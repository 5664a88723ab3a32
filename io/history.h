// The history of a run: one line per output time, one column per quantity, in history.h5 and history.csv.
//
// Columns are named with dots ("body.rod.velocity_x"); in the HDF5 file the dots are folders. All are doubles with a
// unit. Forces are the mean over the interval since the line before: change of impulse over change of time, so that a
// contact between two lines is not missed, and force x interval summed up is the impulse. The area that touches is that
// of the step before the line.
//
// Lines are kept in memory. The CSV file grows line by line, one write each, so that it can be watched and a kill
// leaves whole lines. The HDF5 file, which a killed writer could leave unreadable, is written anew aside and renamed:
// before each checkpoint, now and then, and at the end.
#pragma once

#include "brunt.h"
#include "scene.h"

typedef struct brunt_history brunt_history;

// Lists the columns and finds the probes' particles, nodes and elements; to be called before the world has moved or
// been restored. NULL and an error (BRUNT_BAD_INPUT) when a probe names what its body has not.
brunt_history *brunt_history_create(brunt_world *world, const brunt_scene *scene, brunt_error *error);
void brunt_history_destroy(brunt_history *history);

// What the history is of (brunt_checkpoint_identity): goes to its file, and a file of another run is not taken over.
void brunt_history_identify(brunt_history *history, uint64_t run);

// Adds a line for the world as it is.
int brunt_history_sample(brunt_history *history, brunt_world *world, brunt_error *error);

int64_t brunt_history_rows(const brunt_history *history);
int32_t brunt_history_column_count(const brunt_history *history);
const char *brunt_history_column_name(const brunt_history *history, int32_t column);
const char *brunt_history_column_unit(const brunt_history *history, int32_t column);
// The values of a column, one a line, or NULL when there is none of that name. Valid until the next sample.
const double *brunt_history_column(const brunt_history *history, const char *name);

// Writes history.h5.
int brunt_history_write(const brunt_history *history, const char *path, brunt_error *error);
// Starts history.csv with all lines so far, aside and renamed; lines sampled later are appended at once.
int brunt_history_open_csv(brunt_history *history, const char *path, brunt_error *error);
// Takes over the lines of a file up to `last_step`; later ones are dropped. Columns the file has not are NAN there.
int brunt_history_load(brunt_history *history, const char *path, int64_t last_step, brunt_error *error);
// Says what a file holds.
int brunt_history_describe(const char *path, FILE *out, brunt_error *error);
