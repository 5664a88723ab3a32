// Structured meshes on their way to a brunt_mesh: quadrilaterals or hexahedra, with a mark of groups on every node.
#pragma once

#include "brunt.h"

enum { BRUNT_GRID_CORNERS = 8 };

typedef struct brunt_mesh_grid {
    int dimension;  // 2: quadrilaterals, 3: hexahedra
    int32_t layers; // set it before a grid is made that will be extruded: how often
    int32_t node_count, cell_count;
    double (*x)[3];   // [m] of the shape's own frame
    uint8_t *rank;    // how many of a node's lattice indices are odd: where cells are cut (see the split)
    uint16_t *groups; // bit g set: the node is in group g of `names`
    int32_t (*cell)[BRUNT_GRID_CORNERS]; // nodes in the order of VTK; 4 of them in two dimensions
} brunt_mesh_grid;

enum { BRUNT_GRID_MEMORY = 1, BRUNT_GRID_TOO_MANY }; // what the makers of grids return besides 0

// Group bits the makers set. Sides of a quadrilateral: bit 0..3 for the edges from corner 0 to 1, 1 to 2, 2 to 3, 3 to
// 0. Ball: bit 0 for its surface. Annulus: bit 0 inner, bit 1 outer. Extrusion: bits 4 and 5 for its start and end.
// Cuts: from bit 6 on the planes at the least x, at the greatest x, the least y, ...
enum { BRUNT_GRID_START = 4, BRUNT_GRID_END = 5, BRUNT_GRID_CUT = 6, BRUNT_GRID_GROUPS = 12 };

// A quadrilateral with the given corners (counter-clockwise), count[0] cells along edges 0-1 and 3-2, count[1] along
// 1-2 and 0-3.
int brunt_mesh_grid_quadrilateral(const double corner[4][2], const int32_t count[2], brunt_mesh_grid *grid);
// A disk (dimension 2) or ball (3) about the origin: a core of `core` cells along each side and `shells` layers around
// it.
int brunt_mesh_grid_ball(int dimension, double radius, int32_t core, int32_t shells, brunt_mesh_grid *grid);
// An annulus about the origin: `around` cells (a multiple of 4), the first node on +x, and `layers` outwards.
int brunt_mesh_grid_annulus(double inner, double outer, int32_t around, int32_t layers, brunt_mesh_grid *grid);
// Replaces a two-dimensional grid by its extrusion from z = `from` to `to` in `layers`.
int brunt_mesh_grid_extrude(double from, double to, int32_t layers, brunt_mesh_grid *grid);
void brunt_mesh_grid_free(brunt_mesh_grid *grid);
// Takes out the cells with a node beyond a plane across `axis`, and the nodes that are left without one: beyond is
// below `at` when the upper side is kept, else above. 0, or BRUNT_GRID_MEMORY.
int brunt_mesh_grid_keep(int axis, bool upper, double at, brunt_mesh_grid *grid);

// What is meshed of a shape: a shape that has a grid, and the planes it is cut at.
typedef struct brunt_mesh_cut {
    brunt_shape whole;      // shares what it owns with the shape
    double low[3], high[3]; // [m] -INFINITY, INFINITY: not cut there
} brunt_mesh_cut;
// BRUNT_BAD_INPUT of an intersection that has no such mesh; every other shape is its own whole.
int brunt_mesh_cutting(const brunt_shape *shape, int dimension, brunt_mesh_cut *cut, brunt_error *error);
bool brunt_mesh_is_cut(const brunt_mesh_cut *cut);
// Cuts the grid of the whole, and names the groups of the faces that are found. 0, or BRUNT_GRID_MEMORY.
int brunt_mesh_grid_cut(const brunt_mesh_cut *cut, const char *names[BRUNT_GRID_GROUPS], brunt_mesh_grid *grid);

// Cuts quadrilaterals into 2 triangles each, hexahedra into 6 tetrahedra each: `elements` takes 6 resp. 24 numbers a
// cell.
void brunt_mesh_grid_split(const brunt_mesh_grid *grid, int32_t *elements);
