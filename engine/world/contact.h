// Contact of a world: surfaces of its meshes, and what the methods keep from step to step.
#pragma once

#include "contact/contact.h"
#include "contact/methods/augury.h"
#include "contact/methods/surface_on_grid.h"
#include "contact/search/node_to_facet.h"

typedef struct brunt_contact {
    brunt_contact_def def; // without its pairs
    double cell;           // [m]
    int grid_sweeps;
    bool has_grid;          // bodies of material points meet at the nodes of their grids
    bool has_grid_surfaces; // multi-velocity contact of meshes with material points
    bool has_augury;        // meshes meet each other, or particles, by their facets
    bool has_barrier;       // bodies, or bodies and planes, are kept apart by an energy
    bool has_surfaces;      // surfaces of meshes meet something: each other, particles, planes
    bool has_self;          // a membrane meets itself
    bool has_friction;
    brunt_contact_surface surface;
    brunt_constraint_set constraints;
    brunt_node_to_facet *node_to_facet;
    brunt_augury_workspace *augury;
    brunt_surface_on_grid *grid_surfaces;
    double frame[3]; // [m/s] what contact measures motion against; of the state
} brunt_contact;
