// What holds nodes that hardly any material reaches: differences of the step's displacement along runs of nodes that
// have such a one among them, 1/2 c E h^(dim - 2) sum (q . u)^2 with q = (1, -2, 1), (1, -3, 3, -1), (1, -4, 6, -4, 1)
// by the order of the kernel; of a mesh of triangles of what the displacement of the node across an edge is beside that
// which the triangle on the other side has there. They vanish for polynomials of that order, so that they have no force
// and no moment.
// Where a line holds what is there, splines want it: with inertia or stiffness alone a node can be without either.
#pragma once

#include "linear/term.h"
#include "scheme/unknowns.h"

typedef struct brunt_ghost {
    const brunt_unknowns *unknowns;
    int64_t *first; // runs + 1
    int32_t *node;
    double *share;     // q of each of them
    double *stiffness; // [N/m] of each run
    uint8_t *seen;     // of each node
    int64_t runs, version;
    size_t first_capacity, node_capacity, share_capacity, stiffness_capacity, seen_capacity;
} brunt_ghost;

extern const brunt_term_ops brunt_ghost_ops;

// The runs of a step, of bodies of points that surfaces act on. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_ghost_step(brunt_ghost *ghost, const brunt_world *world, const brunt_unknowns *unknowns, brunt_error *error);
void brunt_ghost_free(brunt_ghost *ghost);
size_t brunt_ghost_bytes(const brunt_ghost *ghost);
