// Pairs of bodies, and what a method of contact is given of a step: it gets the bodies after the forces (old and new
// velocities) and changes the new ones.
#pragma once

#include "contact/constraint/impulse_account.h"
#include "contact/surface/contact_surface.h"
#include "mpm/mpm_body.h"
#include "contact/pairs.h"

typedef struct brunt_symmetry_plane brunt_symmetry_plane; // planes/symmetry.h
typedef struct brunt_boundary brunt_boundary;             // planes/boundary.h

enum { BRUNT_CONTACT_ROW_LIMIT = 16 }; // methods, methods/list.c

// Where two bodies meet, as the rows of methods say by which they do.
typedef enum brunt_contact_place {
    BRUNT_MEET_AT_FACETS = 1,    // facets of a mesh, which it meets others and particles by
    BRUNT_MEET_AT_PARTICLES = 2, // surfaces of particles of two bodies
    BRUNT_MEET_AT_NODES = 4,     // nodes of the grids of two bodies of material points
    BRUNT_MEET_ON_GRID = 8       // ... of one of them, which a mesh comes to
} brunt_contact_place;

// Of two bodies by their numbers, whose nodes are held off the facets of the other.
typedef enum brunt_pair_slaves { BRUNT_SLAVES_BOTH, BRUNT_SLAVES_LOWER, BRUNT_SLAVES_HIGHER } brunt_pair_slaves;

typedef struct brunt_pair {
    int a, b; // bodies, a < b; -1: all pairs of a crowded scene together
    brunt_contact_method method;
    unsigned meets; // bits of brunt_contact_place
    double friction;
    brunt_pair_slaves slaves;
    brunt_impulse_account account, last;
} brunt_pair;

// Whether nodes of one body of a pair are held off the facets of the other.
static inline bool brunt_pair_looks(const brunt_pair *pair, int from, int at) {
    return pair->slaves == BRUNT_SLAVES_BOTH || (pair->slaves == BRUNT_SLAVES_LOWER) == (from < at);
}

// What every method is given of a step.
typedef struct brunt_contact_context {
    brunt_contact_surface *surface;
    brunt_pair *pairs;
    const brunt_pair_map *pair_map;
    int body_count;
    double dt, cell; // [s], [m] of the contact grid
    double kick;     // [s] what forces act over
    int iterations;  // sweeps, or augury iterations of the paper's form
    bool springs;    // material points that overlap walls and facets are pushed out by springs
    double look;     // [m] bodies are near from twice this distance on, at least
    int64_t step;
    const brunt_symmetry_plane *symmetry; // of the grids
    int symmetry_count;
    brunt_boundary *boundaries; // what the symmetry planes are, and all others
    int boundary_count;
    const struct brunt_boundary_lists *acting; // ... by the bodies they act on, planes/boundary_lists.h
    double time;                               // [s] at the start of the step
    brunt_body *mpm;                           // the bodies of material points
    int mpm_count;
    int threads;
    brunt_timer *timer; // of the pass
} brunt_contact_context;
