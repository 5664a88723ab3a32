// What an element is: a table of its topology and the kernel that makes forces of motion for one block of elements.
//
// Adding one: a new file with its kinematics, which instantiates element.inc, and one line in list.c.
#pragma once

#include "brunt.h"
#include "base/real.h"

typedef struct brunt_fem_body brunt_fem_body;
typedef struct brunt_fem_workspace brunt_fem_workspace;
typedef struct brunt_fem_report brunt_fem_report;

typedef struct brunt_element {
    const char *name, *doc;
    int dim, nodes, face_count, face_nodes;
    bool sheet;          // of a membrane: dim is 3, its material points are of dimension 2
    bool axisymmetric;   // a ring about the axis x = 0: dim is 2, its material points are of dimension 3 (r, z, hoop)
    int vtk_cell;        // cell type of the VTK formats
    int block;           // elements of a block of a large body: 8^3 hexahedra, 4^3 cubes of 6 tetrahedra, ...
    int hourglass_modes; // zero-energy modes per direction ...
    const int8_t (*hourglass)[BRUNT_ELEMENT_NODES]; // ... and each node's share in them
    const uint8_t (*face)[4]; // nodes of each face, counter-clockwise seen from outside (2D: outside on the right)
    double (*volume)(
        const double (*x)[3]); // [m^3] exact, of corners x; 2D [m^2]; negative when inside out; sheets: area [m^2]
    // Of an axisymmetric element, the share int N_a dV of its volume that each node has [m^3], of corners x; NULL:
    // equal shares.
    void (*shares)(const double (*x)[3], double *share);
    // Mean material gradients b_a = 1/V int dN_a/dX dV [1/m] of all nodes, of corners x. Of an axisymmetric element the
    // third component is the hoop's, 1/V int N_a / R dV.
    void (*gradient)(const double (*x)[3], real (*b)[3]);
    // Moves the elements of `block` to where their nodes are now, updates the material over a step `dt` (or, with dt 0,
    // leaves stress and state as they are), and writes the block's share of the internal forces on its nodes.
    void (*forces)(brunt_fem_body *body, int32_t block, real dt, brunt_fem_workspace *work, brunt_fem_report *report);
} brunt_element;

extern const brunt_element *const brunt_elements[BRUNT_ELEMENT_KINDS]; // by brunt_element_kind
// Those about an axis, by the kind that a mesh's section is of; NULL where there is none.
extern const brunt_element *const brunt_axisymmetric_elements[BRUNT_ELEMENT_KINDS];
