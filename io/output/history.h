// The history of a run: one line per output time, one column per quantity, in history.h5 and history.csv.
//
// Columns are named with dots ("body.rod.velocity_x"); in the HDF5 file the dots are folders. All are doubles with a
// unit. Forces are means: change of impulse over change of time since the line before, so that a contact between two
// lines is not missed, and force x interval summed up is the impulse; where lines are closer than output.force_window,
// over that time before the line (history_past.c). The area that touches is that of the step before the line.
//
// Lines are written as they come, one write each, to the CSV file, from which they are read back: none is kept in
// memory, and a kill leaves whole lines. The checkpoint holds their number and a hash of them. The HDF5 file, which a
// killed writer could leave unreadable, is made of them aside and renamed: now and then, and at the end. Without a CSV
// file lines are in memory.
#pragma once

#include "brunt.h"
#include "io/scene/scene.h"

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
// [s] of the last line; NAN without one.
double brunt_history_time(const brunt_history *history);
// Of the numbers in all lines but those of probes, which may change between the legs of a run.
uint64_t brunt_history_hash(const brunt_history *history);
// [B] that a line takes in both files.
double brunt_history_line_bytes(const brunt_history *history);
// The column of a name; BRUNT_NONE: there is none.
int32_t brunt_history_find(const brunt_history *history, const char *name);
// Reads the lines back once for all the columns named; names of none are passed over.
int brunt_history_fetch(const brunt_history *history, const char *const *names, int32_t count, brunt_error *error);
// The values of a column, one a line, read back; valid until the next sample. BRUNT_BAD_INPUT when there is none of
// that name.
int brunt_history_read(const brunt_history *history, const char *name, const double **values, brunt_error *error);
// The same, or NULL.
const double *brunt_history_column(const brunt_history *history, const char *name);

// The history with the lines there are now, to be written while others come; it stands on `history`, whose lines go to
// history.csv. Freed with brunt_free. NULL and BRUNT_FAILED: out of memory.
brunt_history *brunt_history_still(const brunt_history *history, brunt_error *error);
// Writes history.h5.
int brunt_history_write(const brunt_history *history, const char *path, brunt_error *error);
// Starts history.csv with all lines so far, aside and renamed; lines sampled later are appended at once.
int brunt_history_open_csv(brunt_history *history, const char *path, brunt_error *error);
// The lines so far are on the disk when it returns.
int brunt_history_sync(const brunt_history *history, brunt_error *error);
// Takes over the first `lines` lines of a CSV file, whose hash is known; brunt_history_open_csv of the same file then
// drops what is after them. Columns the file has not are NAN there. BRUNT_BAD_INPUT, with nothing changed: they are
// others.
int brunt_history_resume(brunt_history *history, const char *path, int64_t lines, uint64_t hash, brunt_error *error);
// BRUNT_OK when an HDF5 file is a history of the same run.
int brunt_history_check_file(const brunt_history *history, const char *path, brunt_error *error);
// Says what a file holds.
int brunt_history_describe(const char *path, FILE *out, brunt_error *error);
