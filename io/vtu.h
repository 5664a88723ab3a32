// Pictures for ParaView: one VTK XML unstructured grid per body and time, particles as one vertex cell each.
//
// Format: VTK XML version 1.0, little endian, 64-bit headers, zlib blocks, raw appended data. No VTK library is used.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "brunt.h"

// One array of values at the points. `values`: `count` x `components` doubles, or int64 when `integers` is set.
typedef struct brunt_vtu_array {
    const char *name; // characters outside [A-Za-z0-9_] become _
    int components;   // 1, 3 (vector), 6 (symmetric XX YY ZZ XY YZ XZ) or 9 (matrix, row major)
    const double *values;
    const int64_t *integers; // NULL unless the array is of integers
} brunt_vtu_array;

// Writes one file (aside, then renamed). `points`: count x 3 [m]; the first array of 1 and the first of 3 components
// become active.
int brunt_vtu_write(const char *path, double time, int64_t count, const double *points, const brunt_vtu_array *arrays,
                    int array_count, bool float32, brunt_error *error);

// One body of a world: its id and the named fields it has; a name it has not is left out.
int brunt_vtu_write_body(const char *path, brunt_world *world, int32_t body, const char (*fields)[64], int field_count,
                         bool float32, brunt_error *error);

// Says what a .vtu or .pvd file holds.
int brunt_vtu_describe(const char *path, FILE *out, brunt_error *error);
