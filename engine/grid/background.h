// A mesh of triangles that lies behind material points in place of the cells of a lattice.
//
// Its nodes and triangles stand in the blocks of a grid (grid.h) by their numbers, 64 a block: node n is node n % 64 of
// slot (n / 64, 0), triangle t bin t % 64 of block (t / 64, 0). What goes over nodes and particles goes over them as it
// does over those of a lattice; only where a point lies, and what links it to nodes, is asked here.
#pragma once

#include <stdint.h>

#include "brunt.h"
#include "base/error.h"

typedef struct brunt_background {
    int32_t node_count, triangle_count;
    double (*node)[2];    // [m]
    int32_t (*corner)[3]; // of each triangle, counter-clockwise
    double *area;         // [m^2] of each node: a third of the triangles about it
    int32_t (*edge)[4];   // between two triangles: its ends, and the nodes across it; ascending by its first end
    int32_t *edge_first;  // of each block of nodes: the first edge that begins there; then all
    int32_t edge_count;
    // Squares that all triangles are listed in whose bounds reach them, in ascending order.
    double low[2], square;
    int32_t squares[2], *first, *listed;
} brunt_background;

// Of a mesh of BRUNT_TRI3 that brunt_mesh_check has nothing against. BRUNT_OK, BRUNT_BAD_INPUT: triangles that overlap
// at an edge, or BRUNT_FAILED: out of memory.
int brunt_background_make(brunt_background *background, const brunt_mesh *mesh, brunt_error *error);
void brunt_background_free(brunt_background *background);
// The triangle that a point lies in, of two that share it the one in which it is deeper, else the first; BRUNT_NONE: it
// is outside of all.
int32_t brunt_background_find(const brunt_background *background, const double x[2]);
// Weights of a triangle's corners at a point, and their slopes [1/m] (NULL: not wanted).
void brunt_background_weights(const brunt_background *background, int32_t triangle, const double x[2], double weight[3],
                              double slope[3][2]);
