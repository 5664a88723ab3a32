// Named groups of nodes that are held, moved or loaded.
#pragma once

#include "body/bodies.h"
#include "contact/contact.h"

typedef struct brunt_node_set {
    int wall, fem; // its place among the walls; its body among the finite-element bodies
    const int32_t *node;
    int32_t node_count;
    int32_t (*face)[4]; // traction and pressure: the surface's faces that are all in the group
    int32_t face_count;
    // Of bodies that erode, the faces at the start and the elements they are of, by their numbers in the mesh; else
    // NULL.
    int32_t (*whole)[4], *owner;
    int32_t whole_count;
    double *force;                             // node_count x 3 [N] of this step, for loads
    int32_t *place;                            // of each node of the body: its place in the group + 1; for loads
    double gas_energy, gas_volume, gas_inflow; // [J], [m^3], [J] so far: of enclosed gas
    double *area;                              // node_count x 3: room for the stable step of gas; NULL of others
} brunt_node_set;

typedef struct brunt_node_sets {
    brunt_node_set *set;
    brunt_group_def *def; // of each: a copy, with its curve
    int count;
    uint8_t (**holder)[3]; // of each body, node and component: the set that prescribes it + 1
    bool has_gas;
    const brunt_node_set *gas_lost; // gas whose volume is no longer positive
} brunt_node_sets;
