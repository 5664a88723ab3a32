// A place in a file of gmsh, and reading numbers from there, in text or binary. For gmsh_read.c only.
//
// The first thing that is wrong sets the error, and every call after it returns 0 and goes nowhere: callers look at
// `status` once in a while, not after every number.
#pragma once

#include "io/mesh/gmsh_file.h"

typedef struct gmsh_cursor {
    gmsh_file *file;
    const char *at, *end;
    const char *section; // that it is in, for messages: "$Nodes"
    bool binary;         // numbers are in binary here
    int status;
    brunt_error *error;
} gmsh_cursor;

// Sets BRUNT_BAD_INPUT at the place `at`: "mesh.msh:12: ..." or, in binary files, "mesh.msh, byte 120: ...".
void gmsh_complain(gmsh_cursor *c, const char *at, const char *format, ...) __attribute__((format(printf, 3, 4)));
void gmsh_out_of_memory(gmsh_cursor *c);

// Over spaces, tabs and ends of line.
void gmsh_skip_blank(gmsh_cursor *c);
// A word up to the next blank, within the line; an empty one at its end.
typedef struct gmsh_word {
    const char *at;
    int length;
} gmsh_word;
gmsh_word gmsh_next_word(gmsh_cursor *c);

// A number; `what` names it in messages. Text: the next on the line. Binary: of 4 or 8 bytes.
int64_t gmsh_integer(gmsh_cursor *c, int bytes, const char *what);
int32_t gmsh_tag(gmsh_cursor *c, const char *what); // of 4 bytes; in text of the range of an int32_t
double gmsh_real(gmsh_cursor *c, const char *what); // finite
// A count that the rest of the file can hold when each of what is counted takes at least so many bytes.
int64_t gmsh_count(gmsh_cursor *c, int bytes, size_t least_text, size_t least_binary, const char *what);
// Text: nothing but blanks is left of the line. Binary: nothing.
void gmsh_end_line(gmsh_cursor *c);
// Text: over blank lines to the next record.
void gmsh_begin_line(gmsh_cursor *c);
