// Numbers of a struct that are saved as doubles: a table says which, where they are, and in which order they go out.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/array.h"

typedef struct brunt_saved {
    const char *name;
    size_t offset, count;
    bool whole; // int64_t, else double
} brunt_saved;

#define BRUNT_SAVED(type, member)                                                                                      \
    {                                                                                                                  \
#member, offsetof(type, member), sizeof(((type *)0)->member) / 8,                                                 \
     _Generic(((type *)0)->member, int64_t : true, double : false, double * : false)    \
    }

// Doubles that a table makes.
int64_t brunt_saved_count(const brunt_saved *table, int rows);
// Out of a struct, and into one; both give where the next one goes on.
double *brunt_saved_get(const brunt_saved *table, int rows, const void *from, double *out);
const double *brunt_saved_set(const brunt_saved *table, int rows, void *to, const double *in);
