// Steps of making a body, in the order they are taken. For the files of this folder.
#pragma once

#include "fem/fem_body.h"

// Orders elements and nodes, cuts blocks, and numbers what each node sums. Sets element_*, node_*, block_*, partial_*
// and local of a body whose element and dim are set. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_fem_layout(brunt_fem_body *body, const brunt_mesh *mesh, brunt_error *error);
// A key that grows along a curve of Hilbert through `dim` coordinates of `bits` bits; dim * bits <= 63.
uint64_t brunt_hilbert_key(int dim, int bits, const uint32_t *coordinate);

// Norm and overlap of the hourglass modes, mass scaling to steps of `mass_scaling` (0: none), least_step; needs start,
// the fields and lateral_ratio.
void brunt_fem_stable_steps(brunt_fem_body *body, double mass_scaling);
// Places of an element's nodes at the start.
void brunt_fem_corners(const brunt_fem_body *body, int32_t slot, double (*x)[3]);
// Of a membrane: its frame (see membrane.inc) from the places x of its nodes; and x in that frame, from node 0.
void brunt_membrane_frame(int nodes, const double (*x)[3], double e[3][3]);
void brunt_fem_flatten(int nodes, double (*x)[3]);
// Of a ring undeformed, with places x of its nodes: bound of omega^2 over the square of the wave speed [1/m^2], springs
// not counted; r is lambda / (lambda + 2 mu). See axisymmetric.inc.
double brunt_fem_axisymmetric_bound(const brunt_element *type, const double (*x)[3], double r);
