// Contact of a world: surfaces of its meshes, and what the methods keep from step to step.
#pragma once

#include "contact/contact.h"
#include "contact/search/node_to_facet.h"

typedef struct brunt_contact {
    brunt_contact_def def; // without its pairs
    double cell;           // [m]
    int grid_sweeps, touch_sweeps;
    bool has_grid;                          // bodies of material points meet at the nodes of their grids
    bool has_touches;                       // ... where their surfaces touch
    bool has_grid_surfaces;                 // meshes meet material points at the nodes of their grids
    const struct brunt_contact_row *facets; // by which meshes meet each other, or particles, at facets; NULL: none
    bool has_barrier;                       // bodies, or bodies and planes, are kept apart by an energy
    bool has_surfaces;                      // surfaces of meshes meet something: each other, particles, planes
    bool has_self;                          // a membrane meets itself
    bool has_friction;
    brunt_contact_surface surface;
    brunt_constraint_set constraints;
    brunt_node_to_facet *node_to_facet;
    unsigned rows;                         // bits of the methods that some pair meets by, but the barrier
    void *memory[BRUNT_CONTACT_ROW_LIMIT]; // what each of them keeps
    double frame[3];                       // [m/s] what contact measures motion against; of the state
} brunt_contact;

// Made with the pairs (world/pairs.c: by which methods) and the surfaces (world/surfaces.c). What lasts, `frame` and
// what search and surfaces remember, is saved by world/state.c.
void brunt_contact_free(brunt_contact *contact);
// Aborts where a method, the search or the surfaces keep what does not belong to them.
void brunt_contact_validate(const brunt_contact *contact);
