// What a kind of element is apart from its mechanics: one row a kind, which meshes, their checks, scenes, mesh files,
// pictures and finite elements read.
//
// To add an element: its kind in brunt/mesh.h, its row here, its file in fem/elements and a line in that folder's list.
#pragma once

#include "brunt.h"

//    kind, name, shape, nodes, dimension of the shape, nodes of a face of the solid
#define BRUNT_SOLID_ELEMENTS(X)                                                                                        \
    X(BRUNT_TET4, "tet4", tetrahedron, 4, 3, 3)                                                                        \
    X(BRUNT_HEX8, "hex8", hexahedron, 8, 3, 4)                                                                         \
    X(BRUNT_TRI3, "tri3", triangle, 3, 2, 2)                                                                           \
    X(BRUNT_QUAD4, "quad4", quadrilateral, 4, 2, 2)
// Surfaces in three dimensions: an element is its own one face.
#define BRUNT_MEMBRANE_ELEMENTS(X)                                                                                     \
    X(BRUNT_MEMBRANE_QUAD4, "membrane_quad4", quadrilateral, 4, 2, 4)                                                  \
    X(BRUNT_MEMBRANE_TRI3, "membrane_tri3", triangle, 3, 2, 3)

// Names of the solid kinds as the word list of a scene's key: "tet4|hex8|...".
#define BRUNT_ELEMENT_WORD(kind, name, shape, nodes, dimension, face_nodes) "|" name
#define BRUNT_ELEMENT_WORDS (&(BRUNT_SOLID_ELEMENTS(BRUNT_ELEMENT_WORD))[1])

// A shape in its own coordinates, nodes in the order of VTK. What several kinds have in common: that of a membrane is
// the shape of an element in the plane.
typedef struct brunt_element_shape {
    const char *plural; // "triangles"
    int pieces;         // that a cell of a structured mesh is cut into: a quadrilateral or hexahedron
    int vtk_cell, gmsh_type;
    double regular;    // [-] factor that makes the scaled Jacobian of the regular element 1
    int8_t swap[2][2]; // pairs of nodes which, exchanged, turn the element over
} brunt_element_shape;

typedef struct brunt_element_traits {
    const char *name;
    const brunt_element_shape *shape;
    int nodes, dimension; // dimension of the room its nodes are in
    int span;             // dimension of the element itself: 2 for membranes
    bool membrane;
    int face_count, face_nodes;
    const uint8_t (*face)[4];  // nodes of each face, counter-clockwise seen from outside (2D: outside on the right)
    const int8_t (*corner)[3]; // of each node, where its `span` edges lead, in the order of a right-handed system
} brunt_element_traits;

extern const brunt_element_traits brunt_element_table[BRUNT_ELEMENT_KINDS]; // by kind
// Of a number that is no kind: a row named "unknown", of no nodes and no dimension.
const brunt_element_traits *brunt_element_traits_of(brunt_element_kind kind);
// The first kind that fits, BRUNT_ELEMENT_KINDS when there is none: the membrane of a plane element's shape, the solid
// whose faces have a membrane's shape, the solid of a name, and of gmsh's type.
brunt_element_kind brunt_element_as_membrane(brunt_element_kind plane);
brunt_element_kind brunt_element_below_membrane(brunt_element_kind membrane);
brunt_element_kind brunt_element_named(const char *name);
brunt_element_kind brunt_element_of_gmsh(int type);
// "tet4 or hex8": the names of all solids of a dimension.
void brunt_element_choice(int dimension, char *out, size_t size);
// Has no modes of deformation that a point in its middle does not see.
bool brunt_element_is_simplex(brunt_element_kind kind);
// [m^3], in two dimensions and of membranes seen in their plane [m^2]; negative when inside out. Exact: faces of four
// nodes are bilinear, the mean of both ways to cut them in two.
double brunt_element_volume(const brunt_element_traits *element, const double (*x)[3]);
