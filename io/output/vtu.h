// Pictures for ParaView: one VTK XML unstructured grid per body and time; particles as one vertex cell each, finite
// elements as cells of their own type.
//
// Format: VTK XML version 1.0, little endian, 64-bit headers, zlib blocks, raw appended data. No VTK library is used.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "brunt.h"

// What values stand at: points, and cells between them.
typedef struct brunt_vtu_grid {
    int64_t point_count, cell_count;
    const double *points; // point_count x 3 [m]
    const int32_t
        *cells; // cell_count x cell_nodes point numbers; NULL: one vertex cell a point, cell_count then unused
    int cell_nodes, cell_type; // type: VTK's number
} brunt_vtu_grid;

// One array of values at the points or the cells. `values`: count x `components` doubles, or int64 when `integers` is
// set.
typedef struct brunt_vtu_array {
    const char *name; // characters outside [A-Za-z0-9_] become _
    const char *unit; // SI, as vtkDataArray::UNITS_LABEL(); NULL: none, or a number
    int components;   // 1, 3 (vector), 6 (symmetric XX YY ZZ XY YZ XZ) or 9 (matrix, row major)
    const double *values;
    const int64_t *integers; // NULL unless the array is of integers
    bool at_cells;           // needs cells of the grid's own
} brunt_vtu_array;

// Writes one file (aside, then renamed). Of points and of cells, the first array of 1 and the first of 3 components
// become active.
int brunt_vtu_write(const char *path, double time, const brunt_vtu_grid *grid, const brunt_vtu_array *arrays,
                    int array_count, bool float32, brunt_error *error);

// A picture of a part of a world, taken: written later, it shows what was there then. NULL and BRUNT_FAILED: there is
// no memory for it.
typedef struct brunt_vtu_picture brunt_vtu_picture;

// One body: its ids and the named fields it has; a name it has not is left out. "default" stands for what the body's
// method always shows. Of the first member of a crowd all of them, with their numbers as `member`.
brunt_vtu_picture *brunt_vtu_take_body(brunt_world *world, int32_t body, const char (*fields)[64], int field_count,
                                       brunt_error *error);

// The boundary particles of a line or surface that holds material points: traction, normal, weight, piece.
brunt_vtu_picture *brunt_vtu_take_boundary(const brunt_world *world, int32_t surface, brunt_error *error);

// Bodies that push each other, as the last step has left them: a line from centre to centre each (to a plate, to
// where the other ends), with the size of the normal force, the
// force on the first, friction, its share of the bound, and both bodies by number.
brunt_vtu_picture *brunt_vtu_take_links(brunt_world *world, brunt_error *error);

// Writes it (brunt_vtu_write). Looks at no world.
int brunt_vtu_put(const char *path, const brunt_vtu_picture *picture, bool float32, brunt_error *error);
void brunt_vtu_release(brunt_vtu_picture *picture); // may be NULL

// Says what a .vtu or .pvd file holds.
int brunt_vtu_describe(const char *path, FILE *out, brunt_error *error);
