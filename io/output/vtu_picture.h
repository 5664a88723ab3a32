// A picture before it is written: what was read of the world, and the memory that it stands in. Private to vtu*.c.
#pragma once

#include "io/output/vtu.h"

enum { PICTURE_FIELDS = 256, PICTURE_BLOCKS = PICTURE_FIELDS + 7 };

struct brunt_vtu_picture {
    double time; // [s]
    brunt_vtu_grid grid;
    brunt_vtu_array arrays[PICTURE_FIELDS]; // names are of the program, or of the world and as long as it
    int array_count;
    void *memory[PICTURE_BLOCKS];
    int memory_count;
};

// Of the world as it is, with nothing in it; NULL and BRUNT_FAILED: out of memory. `what` it is of is for messages.
brunt_vtu_picture *brunt_vtu_start(const brunt_world *world, const char *what, brunt_error *error);
// Memory of the picture, zeroed; NULL and BRUNT_FAILED: there is none.
void *brunt_vtu_alloc(brunt_vtu_picture *picture, size_t bytes, const char *what, brunt_error *error);
void brunt_vtu_add(brunt_vtu_picture *picture, brunt_vtu_array array);
