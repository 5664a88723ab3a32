// Private to the potentials of finite-element bodies: what they are made of, and what kinds of elements there are.
#pragma once

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "fem/kernel.h"
#include "fem/potential.h"
#include "linear/assembly.h"

#include <math.h>
#include <string.h>

enum { NODE_LIMIT = 8, MODE_LIMIT = 4, SHAPES = NODE_LIMIT * 3, SHARES = NODE_LIMIT * MODE_LIMIT };

typedef struct fem_potential_kind fem_potential_kind;

struct brunt_fem_potential {
    const fem_potential_kind *kind;
    brunt_fem_body *body;
    int32_t base;
    int dim, nodes, modes, tangents; // of an element
    bool history;                    // the material looks at what the step did
    real dt;
    brunt_trial_rule rule;
    // Of each slot: mean gradients b of the shape functions, gamma and k of its hourglass modes.
    real *b[SHAPES], *gamma[SHARES], *spring;
    // Of the last Hessian: spatial gradients and tangents.
    real *g[SHAPES], *tangent[BRUNT_TANGENT_LIMIT];
    real *slab;
    size_t slab_bytes;
    struct fem_membrane *membrane; // of a membrane: its elements at the start, a slot each
    double *displacement, *way;    // of each node, dim each: where it is tried to be, less where it was at the start; p
    real *force;                   // partial_count x 4, as body->partial
    brunt_energy_sum *energy;      // a block each
    double moduli;                 // [J] m c^2
    double *limit;                 // a block each
    int64_t *first;                // stencils: the elements in order of slots
    int32_t *node, *slot;
    brunt_colours colours;
};

typedef enum fem_wanted { FEM_ENERGY, FEM_GRADIENT, FEM_TANGENT, FEM_LIMIT, FEM_PRODUCT } fem_wanted;

typedef struct fem_call {
    brunt_fem_potential *p;
    fem_wanted wanted;
    bool project;
    const double *u, *way;
    double *out, largest;
} fem_call;

// What the elements of a kind do: potential.c goes over blocks and nodes, and knows no shapes.
struct fem_potential_kind {
    // Takes the slab and cuts its arrays, as long as the body has slots, and fills what stays. BRUNT_OK, or
    // BRUNT_FAILED: out of memory.
    int (*make)(brunt_fem_potential *p, brunt_error *error);
    void (*evaluate)(const fem_call *call, int32_t block); // energy, gradient into `force`, or what `hessian` reads
    void (*limit)(const fem_call *call, int32_t block);    // NULL: elements bear any step
    void (*hessian)(const brunt_fem_potential *p, int64_t slot, double *dense); // of one element, row by row
    // The Hessian that stands times `way` (of the body's nodes, dim each) into `force`, of a block.
    void (*product)(const fem_call *call, int32_t block);
    // Elements of a block to where their nodes are now: material, partial forces and report.
    void (*commit)(brunt_fem_potential *p, int32_t block, brunt_fem_workspace *work);
};

extern const fem_potential_kind brunt_fem_solid_potential, brunt_fem_membrane_potential;
