// What an element does: the kernel that makes forces of motion for one block of elements, and what it says of itself.
// Its name, nodes and faces are its row of geometry/element_traits.h.
//
// Adding one: a new file with its kinematics, which instantiates element.inc, one line in list.c, the kind and its row.
#pragma once

#include "base/real.h"
#include "geometry/element_traits.h"

typedef struct brunt_fem_body brunt_fem_body;
typedef struct brunt_fem_workspace brunt_fem_workspace;
typedef struct brunt_fem_report brunt_fem_report;

// Floating-point operations of an element's own part of element.inc; of other kernels all there are, counted once.
typedef struct brunt_element_flops {
    int strain_modes;              // modes that strain
    double combine, spread, slope; // of the nodes' modes, their transpose, the slope of the volume
    double whole[2];               // of a kernel that is not element.inc: stiffness and viscous hourglass control
} brunt_element_flops;

typedef struct brunt_element {
    const brunt_element_traits *traits;
    const char *doc;
    bool axisymmetric; // a ring about the axis x = 0: dim is 2, its material points are of dimension 3 (r, z, hoop)
    int block;         // elements of a block of a large body: 8^3 hexahedra, 4^3 cubes of 6 tetrahedra, ...
    brunt_element_flops flops;
    int hourglass_modes;                            // zero-energy modes per direction ...
    const int8_t (*hourglass)[BRUNT_ELEMENT_NODES]; // ... and each node's share in them
    double (*volume)(
        const double (*x)[3]); // [m^3] exact, of corners x; 2D [m^2]; negative when inside out; membranes: area [m^2]
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
