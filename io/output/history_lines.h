// What a history is made of, and its lines as they were sampled: from memory or from history.csv. Private to
// history*.c.
#pragma once

#include "base/names.h"
#include "io/file/atomic_file.h"
#include "io/output/history.h"

enum { COLUMN_NAME = 200 };

typedef struct column {
    char name[COLUMN_NAME], unit[16];
    double now, last; // of the line that is being made, of the one before
    double *values;   // all lines, when they have been asked for
} column;

typedef struct probe {
    char name[64];
    int32_t body, field;
    int64_t id;    // particle, node or element
    int64_t count; // how many of them there were at the start
    brunt_field_info info;
} probe;

// What has a force: the column of the impulse along x, and the time over which its force is a mean [s].
typedef struct force_of {
    int32_t impulse;
    double window;
} force_of;

// What forces look back at: lines of a time and three impulses of each, the oldest first, of which `old` are no longer
// needed.
typedef struct past {
    double *line, longest; // [s] of all windows
    size_t line_capacity;  // [bytes]
    int64_t count, old;
} past;

struct brunt_history {
    column *columns;
    size_t columns_capacity; // [bytes]
    int32_t column_count, cursor;
    brunt_names names; // of the columns, once they are all there
    bool declaring;    // the first traversal names the columns, later ones fill them
    bool out_of_memory;
    int32_t unknown; // the last column that no table explains, and 1; 0: none
    int64_t rows;
    uint64_t hash; // of all lines but their probes, which may change from leg to leg
    double *lines; // one after the other, as long as they go to no file
    size_t lines_capacity;
    bool resumed; // lines are in a file that is to be gone on with
    force_of *forces;
    int32_t force_count;
    past past;
    probe *probes;
    int32_t probe_count;
    int32_t *members; // of crowds, that measures ask for: bodies in their order, each once
    int32_t member_count;
    double *scratch; // a field of a probe's body
    size_t scratch_capacity;
    FILE *csv;
    char csv_path[BRUNT_PATH_LENGTH];
    char title[256];
    uint64_t run; // brunt_checkpoint_identity
};

// 17 digits give every bit of a double back.
typedef struct line_reader {
    const brunt_history *history;
    const char *path; // NULL: from memory
    FILE *file;
    char *text; // of the C library, as the next one
    size_t capacity;
    int32_t *column; // of each of the file's: the history's, -1: it has no such
    bool *counted;
    int32_t column_count; // of the file
    int64_t row;
    uint64_t hash; // of the lines so far
} line_reader;

// False: of a probe or a member of a crowd, which may change between the legs of a run.
bool brunt_history_counts(const char *column_name);
uint64_t brunt_history_hash_value(uint64_t hash, double value);
void brunt_history_print_line(const brunt_history *h, const double *values, FILE *out);

// What there is a force of, and over which time each is a mean. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_history_find_forces(brunt_history *h, const brunt_world *world, const brunt_scene *scene, brunt_error *error);
// Keeps the impulses of the line in `now`, and those before it as long as they are needed.
int brunt_history_keep_past(brunt_history *h, brunt_error *error);
// Force number k of the line that is being made, over its window, or since the line before where that is longer, from
// its impulse by now.
void brunt_history_mean_force(const brunt_history *h, int32_t k, const double impulse[3], double mean[3]);

// Starts with the first line; `path` NULL: from memory. To be closed in any case.
int brunt_history_open_lines(line_reader *r, const brunt_history *h, const char *path, brunt_error *error);
// The next line into `values`, one a column of the history, NAN where the file has none; of the columns that are
// `wanted` alone, the others being left, unless that is NULL.
int brunt_history_next_line(line_reader *r, const bool *wanted, double *values, brunt_error *error);
void brunt_history_close_lines(line_reader *r);
// Of history.csv; NULL: lines are in memory.
const char *brunt_history_lines_path(const brunt_history *h);
