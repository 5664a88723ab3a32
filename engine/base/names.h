// Names, sorted once, where many of them are looked up.
#pragma once

#include <stdint.h>
#include <stddef.h>

#include "base/error.h"

typedef struct brunt_name_entry {
    const char *name; // not its own
    int32_t index;    // in the array it came from
} brunt_name_entry;

typedef struct brunt_names {
    brunt_name_entry *entry; // in order of name, of one name in that of the array
    int32_t count;
} brunt_names;

// Of `count` names that lie `stride` bytes apart, the first of them at `first`; they must stay where they are.
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_names_sort(brunt_names *names, const char *first, size_t stride, int32_t count, brunt_error *error);
// Where in the array a name of `length` bytes was first; BRUNT_NONE: it is not there.
int32_t brunt_names_find(const brunt_names *names, const char *name, size_t length);
void brunt_names_free(brunt_names *names);
