// Unknowns of an implicit step: displacements of the nodes of meshes, then of the grid nodes that particles reach, then
// of planes that move and push, which are given.
//
// Numbers are made anew for each step, since the nodes that particles reach change. They follow the order of bodies,
// nodes and slots, so that they do not depend on threads.
#pragma once

#include "linear/fold.h"
#include "world/world.h"

// Nodes of grids that have images: by symmetry planes, and slip planes on a line of the grid. What is at a node
// is what the body's own points bring there; a node that is another's image follows it.
typedef struct brunt_images {
    bool any;                   // there are symmetry planes of material points; else no arrays
    brunt_fold fold;            // of `leader`, `follower`, `sign`
    int32_t *leader, *follower; // by node; `fold.count` of them
    int32_t *front;             // of each node: its image before the planes, where there is none its leader
    double *sign, *mass; // of each component: 0 on its symmetry plane; [kg] with all images, 0 on its symmetry plane
    uint32_t *bearers;   // of each component: the symmetry planes (bits) that carry what images take, in equal parts
    size_t leader_capacity, follower_capacity, front_capacity, sign_capacity, mass_capacity, bearers_capacity;
} brunt_images;

// What the nodes bring into a step, `count` of them with `dim` components each.
typedef struct brunt_unknowns {
    int dim;
    int32_t count, mesh_count; // nodes; those of meshes
    int32_t *plane;            // of each boundary: its node if it is a plane that moves and pushes, else -1
    int32_t *base;             // of each finite-element body: its node 0
    int32_t *grid_base; // of each body of points: its first node that no earlier one has; then the end of the last
    int32_t **number;   // of each body of points: node of slot * BRUNT_BLOCK_NODES + place, -1: without weight, at rest
    size_t *number_capacity;
    int32_t *tie; // of each body of points: the first one that it is tied to, itself else; ties of ties hold too
    brunt_images images;
    uint8_t *sloped; // of the nodes of a grid of linear functions: whether a point has a slope there
    size_t sloped_capacity;
    double *mass; // [kg]
    size_t mass_capacity;
    double *position, *velocity; // [m], [m/s] at the start of the step
    size_t position_capacity, velocity_capacity;
    uint8_t *held; // of each component: whether it is given
    size_t held_capacity;
    int32_t *holder; // of each component: the boundary that holds it, + 1; 0: none
    size_t holder_capacity;
    double *target, *end; // [m], [m/s] displacement of held components over the step, velocity at its end
    size_t target_capacity, end_capacity;
} brunt_unknowns;

// Arrays by body. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_unknowns_make(brunt_unknowns *u, const brunt_world *world, brunt_error *error);
void brunt_unknowns_free(brunt_unknowns *u, const brunt_bodies *bodies);
// Aborts where nodes are not in the order of bodies, `boundaries` boundaries, symmetry planes and grids as of the step
// that they were numbered for.
void brunt_unknowns_validate(const brunt_unknowns *u, const brunt_bodies *bodies, int boundaries);
size_t brunt_unknowns_bytes(const brunt_unknowns *u, const brunt_bodies *bodies);
// Numbers, masses, places and velocities, once masses and momenta are on the grids. BRUNT_OK, or BRUNT_FAILED: out
// of memory, or more nodes than there are numbers.
int brunt_unknowns_number(brunt_unknowns *u, brunt_world *world, brunt_error *error);
// --- unknowns_images.c
// Which nodes are images of which, once they have numbers. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_unknowns_symmetry(brunt_unknowns *u, const brunt_world *world, brunt_error *error);
// What followers follow; NULL: nothing follows.
const brunt_fold *brunt_unknowns_fold(const brunt_unknowns *u);
// Velocities of grids from momenta, those of images together; what symmetry planes bear by that is recorded.
void brunt_unknowns_divide(brunt_unknowns *u, brunt_world *world);
// [m/s^2] of all components that are not held, by forces [N] on the nodes.
void brunt_unknowns_accelerate(const brunt_unknowns *u, const double *force, double *acceleration);
// The part of what acts along component k that each of its bearers takes.
double brunt_unknowns_bearers(const brunt_unknowns *u, int64_t k);
// [-] What component k is of that of its node's front: 1, -1, or 0 on a plane.
double brunt_unknowns_image_sign(const brunt_unknowns *u, int64_t k);
// What is held of a node is held of its images.
void brunt_unknowns_hold_images(brunt_unknowns *u);
// --- unknowns_hold.c
// What boundaries and groups hold over a step of `dt`: components and where they go. Clears what was held.
void brunt_unknowns_hold(brunt_unknowns *u, const brunt_world *world, double dt);
// The first node of a mesh that displacements `way` [m] over `dt` take behind a plane that holds what lies on it, and
// that plane; BRUNT_NONE: none.
int32_t brunt_unknowns_passed(const brunt_unknowns *u, const brunt_world *world, const double *way, double dt,
                              const brunt_boundary **boundary);
// The node at grid coordinates `at` of body of points i, or of one that it is tied to; BRUNT_NONE: none.
int32_t brunt_unknowns_node_at(const brunt_unknowns *u, const brunt_bodies *bodies, int i, const int32_t at[3]);
// What node `n` is of: a body, and its node or the slot's, for messages.
typedef struct brunt_unknown_location {
    int body; // among all, in order of name
    int64_t node;
    double x[3]; // [m]
} brunt_unknown_location;
brunt_unknown_location brunt_unknowns_location(const brunt_unknowns *u, const brunt_bodies *bodies, int32_t n);
