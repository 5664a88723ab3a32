// Named groups of nodes that are held, moved or loaded.
#pragma once

#include "body/bodies.h"
#include "base/messages.h"
#include "boundary/group_actions.h"
#include "contact/contact.h"
#include "contact/planes/boundary.h"
#include "contact/surface/contact_surface.h"

typedef struct brunt_node_set {
    brunt_group_def def;         // a copy, with its curve
    const brunt_group_row *does; // of its action
    brunt_boundary *boundary;    // its name, and where its impulses are recorded
    brunt_fem_body *fem;
    int fem_index; // of the body, among those of elements
    int next;      // set of the same body; BRUNT_NONE: it is the last
    const int32_t *node;
    int32_t node_count;
    uint8_t *holds;     // of each node the components that it prescribes, as bits; NULL of loads
    real *internal;     // node_count x 3 [N] of this step, for what prescribes
    int32_t (*face)[4]; // traction and pressure: the surface's faces that are all in the group
    int32_t face_count;
    // Of bodies that erode, the faces at the start and the elements they are of, by their numbers in the mesh; else
    // NULL.
    int32_t (*whole)[4], *owner;
    int32_t whole_count;
    double *force;                             // node_count x 3 [N] of this step, for loads
    int32_t *place;                            // of each node of the body: its place in the group + 1; for loads
    double gas_energy, gas_volume, gas_inflow; // [J], [m^3], [J] so far: of enclosed gas
    bool gas_halved[3];                        // its faces are closed by the plane of symmetry across this axis
    double *area;                              // node_count x 3: room for the stable step of gas; NULL of others
} brunt_node_set;

typedef struct brunt_node_sets {
    brunt_node_set *set;
    int count, fem_count;
    const brunt_fem_body *fem;      // the bodies
    int *first;                     // of each of them its first set, BRUNT_NONE: it has none
    int *gas, gas_count;            // sets with gas
    uint8_t **taken;                // of each body and node: components that some set prescribes, as bits
    double **load_rate;             // of each body with loads that follow its surface: node_count, see load_step.c
    bool has_gas, act;              // act: one of them does something
    const brunt_node_set *gas_lost; // gas whose volume is no longer positive
} brunt_node_sets;

// After the bodies are made. `boundaries`: those of the sets.
int brunt_node_sets_make(brunt_node_sets *sets, const brunt_world_def *def, const brunt_bodies *bodies,
                         brunt_boundary *boundaries, brunt_messages *messages, brunt_error *error);
void brunt_node_sets_free(brunt_node_sets *sets);
void brunt_node_sets_validate(const brunt_node_sets *sets);
// Loads of a body's sets from now on act on the faces of those elements alone that it still has. The set whose faces
// enclose gas and one of its elements (by number in the mesh) that has left, or NULL.
const brunt_node_set *brunt_node_sets_follow(brunt_node_sets *sets, brunt_fem_body *fem, int32_t *element);

// Loads of this step, made before the kick of `dt` and with half their work recorded; the other half once velocities
// are final.
void brunt_loads_begin(brunt_node_sets *sets, const brunt_bodies *bodies, double time, double dt);
void brunt_loads_end(const brunt_node_sets *sets, double dt);
// Of a set that prescribes displacements, by its table at that time: where the whole body would go from the start.
brunt_placement brunt_node_set_goal(const brunt_node_set *set, double time);
// What a node (by its number in the body) has of that to go along axis a [m].
double brunt_node_set_way(const brunt_node_set *set, const brunt_placement *goal, int32_t node, int a);
// Prescribed motion after a kick, and its account; the nodes then move for `step`.
void brunt_node_sets_prescribe(const brunt_node_sets *sets, const brunt_kick *kick, double time, double step);
// Reaction of what contact gave to held nodes.
void brunt_node_sets_account_contact(const brunt_node_sets *sets, const brunt_contact_surface *surface);
// Vectors of the shares that the corners of a face have of its area [m^2], outward: int N_a n dA.
void brunt_face_shares(const double (*x)[3], int corners, double (*share)[3]);
