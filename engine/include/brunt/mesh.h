// Meshes of finite elements: given, or made of shapes; their kinds of element, groups and quality.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include "brunt/error.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

// Linear elements with one integration point, nodes in the order of VTK. Two-dimensional ones are in plane strain;
// those of membranes are sheets in three dimensions, in plane stress.
typedef enum brunt_element_kind {
    BRUNT_TET4,
    BRUNT_HEX8,
    BRUNT_TRI3,
    BRUNT_QUAD4,
    BRUNT_MEMBRANE_QUAD4,
    BRUNT_MEMBRANE_TRI3,
    BRUNT_ELEMENT_KINDS // how many
} brunt_element_kind;
enum { BRUNT_ELEMENT_NODES = 8 };                        // that an element has at most
const char *brunt_element_name(brunt_element_kind kind); // "tet4", "membrane_quad4", ...; "unknown"
int brunt_element_nodes(brunt_element_kind kind);        // this and the next are 0 of what is no kind
int brunt_element_dimension(brunt_element_kind kind);    // of the room its nodes are in: 3 for membranes
bool brunt_element_is_membrane(brunt_element_kind kind); // of membranes

// Nodes with a name: a boundary acts on them, and on the faces whose nodes are all among them.
typedef struct brunt_group {
    char name[BRUNT_NAME_LENGTH];
    int32_t *nodes, count; // node numbers from 0, ascending, each once; owned by the mesh
} brunt_group;

typedef struct brunt_mesh {
    brunt_element_kind kind;          // all elements are of one kind
    int32_t node_count;               // at least those of one element
    double (*nodes)[3];               // [m]; the third is 0 in two dimensions
    int32_t element_count, *elements; // brunt_element_nodes(kind) node numbers each, from 0
    brunt_group *groups;              // in any order, names unique
    int32_t group_count;              // 0: none
} brunt_mesh;                         // arrays owned by the mesh (brunt_def_alloc, brunt_mesh_free)

// A function of time (or place): linear between points, held constant before the first and after the last; no points: 1
// always.
typedef struct brunt_curve {
    double (*points)[2]; // [s] (or [m]), ascending; [-]
    int32_t count;
} brunt_curve;

// A structured mesh of a shape (not placed) with edges of about `size` [m], finite and > 0: box, sphere, cylinder,
// ring, prism with four corners; in two dimensions box, disk, annulus, quadrilateral. Boundary groups by shape: box
// xmin xmax ymin ymax zmin zmax; cylinder and ring start end side (ring: inner outer); prism side1 ... side4 (from
// corner i to the next) zmin zmax; sphere none; and `surface` for all. Intersections of one sphere (disk), cylinder or
// ring with boxes, or half-spaces along the axes, are its halves, quarters and eighths: cut through its centre along x,
// y, z, or across its axis (cuts may miss it, too); nodes lie exactly on the cuts, which are the groups xmin xmax ymin
// ymax zmin zmax. Intersections of boxes are boxes. Balls and disks are a cube bulged towards the surface, with layers
// of cells about it, by the equiangular projection of Ronchi, Iacono and Paolucci 1996, "The cubed sphere". BRUNT_OK;
// BRUNT_BAD_INPUT for shapes that have no such mesh (union, difference, ...) or another size; BRUNT_FAILED: out of
// memory.
int brunt_mesh_shape(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size, brunt_mesh *mesh,
                     brunt_error *error);
// The same, with the same errors, of a box whose elements grow along the axes: grading[a] is the factor on `size` along
// axis a, over the coordinate [m].
int brunt_mesh_graded(const brunt_shape *box, int dimension, brunt_element_kind kind, double size,
                      const brunt_curve grading[3], brunt_mesh *mesh, brunt_error *error);
// The surface of such a mesh in three dimensions, as sheets (a membrane kind), seen counter-clockwise from outside: all
// of it, or the faces in the named boundary groups. Groups are kept, with the nodes that are left; `border` is added
// where the surface is open: the nodes of edges that only one element has. A flat sheet is one face of a box, a disk
// the start of a cylinder. `size` and errors as of brunt_mesh_shape, and BRUNT_BAD_INPUT too for a kind that is no
// membrane's or a face that the shape has not; the message lists those that it has.
int brunt_mesh_surface(const brunt_shape *shape, brunt_element_kind kind, double size,
                       const char (*faces)[BRUNT_NAME_LENGTH], int32_t face_count, brunt_mesh *mesh,
                       brunt_error *error);

typedef struct brunt_mesh_quality {
    int32_t inverted, degenerate, duplicate_elements, duplicate_nodes, unreferenced; // how many ...
    int32_t first[5];                   // ... and the first of each (element or node number from 0), -1
    double volume, smallest, largest;   // [m^3] in all, of an element; 2D [m^2]
    double shortest_edge, longest_edge; // [m]
    double worst_shape;                 // [-] 1 for the regular element, 0 for a flat one (the least scaled Jacobian)
    int32_t worst;                      // element with it
} brunt_mesh_quality;
// Looks a mesh over. BRUNT_BAD_INPUT and a message with element numbers (from 1) when it cannot be computed with:
// inverted or flat elements, elements given twice. Duplicate (same place) and unreferenced nodes are only counted.
int brunt_mesh_check(const brunt_mesh *mesh, brunt_mesh_quality *quality, brunt_error *error);
void brunt_mesh_free(brunt_mesh *mesh); // what the mesh owns, not the mesh itself

#ifdef __cplusplus
}
#endif
