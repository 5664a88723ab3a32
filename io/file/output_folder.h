// A folder that is written into: whose files are whose, and one writer at a time.
//
// The file `brunt.files` in it lists what brunt wrote there, a name a line, relative to the folder. Only what is listed
// is replaced or removed; a name is listed before its file is made. What stands in the way without being listed, also a
// link or something that is no file, is refused before anything is touched. Links within the folder are not followed.
// The list is locked while the folder is written into; the lock ends with its process, however that ends.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/names.h"
#include "io/file/atomic_file.h"

#define BRUNT_OUTPUT_LIST "brunt.files"

typedef struct brunt_output_folder {
    char path[BRUNT_PATH_LENGTH]; // as the user named it, without a slash at its end
    int folder, index;            // descriptors; -1: none
    char *text;                   // of the list as it was when opened; names end with 0
    char **names;                 // into `text`, sorted
    int32_t count;
} brunt_output_folder;

// Opens a folder that may not be there yet, locks its list if there is one and reads it. Makes nothing.
// BRUNT_BAD_INPUT: another process writes into it, or a file of that name is no list of ours.
int brunt_output_open(brunt_output_folder *out, const char *path, brunt_error *error);
void brunt_output_close(brunt_output_folder *out);

// The path of `name` below the folder. BRUNT_IO_ERROR: what it leads to is not what was opened, but gone or another's.
int brunt_output_path(const brunt_output_folder *out, const char *name, char path[BRUNT_PATH_LENGTH],
                      brunt_error *error);

bool brunt_output_listed(const brunt_output_folder *out, const char *name);
bool brunt_output_has(const brunt_output_folder *out, const char *name); // anything of that name, also a broken link

// What is in the way, for a message that says all of it at once.
typedef struct brunt_obstacles {
    int32_t count;
    char names[600]; // ", "-separated, as far as there is room
} brunt_obstacles;
// Looks at `name`, and at what it is written aside as. A name that ends with a slash is a folder: it must be one, and
// no link.
void brunt_output_obstacle(const brunt_output_folder *out, const char *name, brunt_obstacles *found);
// Likewise at all in the folder `name` that begins with one of `names`, goes on with _ and digits and ends with
// `ending`.
void brunt_output_numbered_obstacles(const brunt_output_folder *out, const char *name, const brunt_names *names,
                                     const char *ending, brunt_obstacles *found);
// BRUNT_OK when nothing is in the way; BRUNT_BAD_INPUT says what is.
int brunt_output_refuse(const brunt_output_folder *out, const brunt_obstacles *found, brunt_error *error);

// Makes the folder and its list, as far as there is none, and takes the lock.
int brunt_output_make(brunt_output_folder *out, brunt_error *error);
// Lists names that are going to be written; those listed already are passed over. They last when it returns.
int brunt_output_list(brunt_output_folder *out, const char *const *names, int32_t count, brunt_error *error);
// Removes all that is listed but the names `keep`, and what was written aside; afterwards the list has those alone.
int brunt_output_clear(brunt_output_folder *out, const char *const *keep, int32_t count, brunt_error *error);
// Removes all that is listed, the list, and the folder unless there is something else in it.
int brunt_output_remove(brunt_output_folder *out, brunt_error *error);
// Removes what a killed writer left aside.
void brunt_output_remove_leftovers(const brunt_output_folder *out);
// Opens a file of the folder itself to write on at its end, or anew. NULL and BRUNT_IO_ERROR when that fails.
FILE *brunt_output_stream(const brunt_output_folder *out, const char *name, bool anew, brunt_error *error);
