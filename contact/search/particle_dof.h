// Particles as slaves of constraints: the nodes of their grid under each, and those nodes as degrees of freedom.
//
// A particle's velocity is that of the grid at its centre, sum_i N_i(x_p) v_i, and an impulse on it goes to the nodes
// by the same weights. Friction acts at its surface, half a spacing off: slip is that of the velocity extended affinely
// to there,
//   N_i(x_p) (1 + (x_i - x_p) . D^-1 d),  D the kernel's second moment, d from the particle to the point
// whose transpose gives the nodes force and moment of an impulse there exactly. A cylinder rolls on its radius, not on
// that of its outermost particles.
//
// Where a symmetry plane is near, a node and its images have one velocity, turned over: they are one degree of freedom,
// and what a particle gives it is the sum of the weights of all of them, each turned over, since the image of the
// particle presses too. A node on the plane moves along it only. Tangentially the body then gets all of the impulse;
// what is missing across the plane is what the plane carries.
#pragma once

#include "contact/constraint/constraint.h"
#include "contact/contact.h"
#include "contact/planes/symmetry.h"

enum { BRUNT_PARTICLE_NODES = 64, BRUNT_PARTICLES_TOGETHER = 4 };

// Under a particle, or under a few together.
typedef struct brunt_particle_nodes {
    int count;
    real *node[BRUNT_PARTICLES_TOGETHER * BRUNT_PARTICLE_NODES]; // of the grid, with mass
    int32_t at[BRUNT_PARTICLES_TOGETHER * BRUNT_PARTICLE_NODES][3];
    double weight[BRUNT_PARTICLES_TOGETHER * BRUNT_PARTICLE_NODES];
} brunt_particle_nodes;

// Nodes and weights under particle `s` of block `b`, or at an arm's length from it, where its kernel lives [m]; NULL:
// none.
void brunt_particle_nodes_find(const brunt_body *body, int32_t b, int64_t s, const double *arm,
                               brunt_particle_nodes *out);
// Adds the nodes under one particle more, with `factor` times its weights, to those of the others.
void brunt_particle_nodes_add(const brunt_particle_nodes *more, double factor, brunt_particle_nodes *sum);
// The velocity there, of the reals BRUNT_NODE_VELOCITY or BRUNT_NODE_OLD [m/s].
void brunt_particle_nodes_velocity(const brunt_particle_nodes *under, int dim, int which, double v[3]);

// The same velocity of a particle, for which its nodes need not be listed.
void brunt_particle_velocity(const brunt_body *body, int32_t b, int64_t s, int which, double v[3]);
// Bounds of its components, but for rounding, of any particle in the bins from..end along each axis of a block [m/s].
typedef struct brunt_node_range {
    int32_t block;
    const int32_t *from, *end;
} brunt_node_range;
void brunt_particle_velocity_bounds(const brunt_body *body, const brunt_node_range *of, int which, double low[3],
                                    double high[3]);

// A grid node by its degree-of-freedom node.
typedef struct brunt_grid_dof {
    int64_t node;
    int32_t dof_node;
    double sign[3]; // v of the node is that of the degree-of-freedom node, turned over by symmetry planes; 0 across one
                    // it lies on
    unsigned on_plane; // the axes (bits) of symmetry planes that it lies on
} brunt_grid_dof;

// Of the grid of one body, in one set of constraints.
typedef struct brunt_particle_dofs {
    int32_t tag; // of the body's constraints
    int32_t *of; // of each grid node its place in `dof` + 1; 0: none
    size_t of_capacity;
    brunt_grid_dof *dof;
    size_t dof_capacity;
    int32_t dof_count;
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES]; // that act on the body
    int symmetry_count;
} brunt_particle_dofs;

void brunt_particle_dofs_free(brunt_particle_dofs *dofs);
// Room for the nodes of a body's grid, of which none is in use. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_particle_dofs_begin(const brunt_contact_context *m, const brunt_body *body, brunt_particle_dofs *dofs,
                              brunt_error *error);
// Entries of the set's last constraint for a particle, its slave (`factor` 1), or for what carries it (-1). BRUNT_OK,
// or BRUNT_FAILED: out of memory.
int brunt_particle_dofs_enter(const brunt_body *body, const brunt_particle_nodes *under, double factor,
                              brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error);
// Gives the last constraint, when its entries are complete, a friction point to x [m], with the weights of the particle
// at an arm's length. The index of its first entry, or BRUNT_NONE: out of memory.
int32_t brunt_particle_dofs_friction_point(const brunt_body *body, const brunt_particle_nodes *at_arm,
                                           const double x[3], const brunt_particle_dofs *dofs,
                                           brunt_constraint_set *set, brunt_error *error);
// Adds `factor` times weights to the entries of a friction point, from `first` on, which there are.
void brunt_particle_dofs_rub(const brunt_body *body, const brunt_particle_nodes *at_arm, double factor,
                             const brunt_particle_dofs *dofs, int32_t first, brunt_constraint_set *set);
// After the solution: velocities back to the grid's nodes, and to the symmetry planes what they bear. None is in use
// then.
void brunt_particle_dofs_scatter(const brunt_contact_context *m, brunt_body *body, brunt_particle_dofs *dofs,
                                 const brunt_constraint_set *set);
