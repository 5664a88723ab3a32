// Images at planes of symmetry, at such that slip or stick on lines of the grid, and at the axis of rings: nodes behind
// them see less of the bodies than those before, or nothing, and contacts of their own would give two bodies, or the
// two sides, different impulses. So bodies meet at the nodes before them, and the images follow.
#pragma once

#include "contact/planes/symmetry.h"

// Coordinates of a node of a slot.
void brunt_node_coordinates(const brunt_grid *grid, int32_t slot, int node, int32_t at[3]);
// How many nodes before a plane a node is, negative behind it.
int32_t brunt_symmetry_before(const brunt_symmetry_plane *plane, const int32_t at[3]);
// Whether a body's node is behind one of the planes that act on the body; whether it rests on one that sticks.
bool brunt_followed_behind(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node);
bool brunt_followed_rests(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node);

// Nodes that follow a node of a body: the images of it that have mass, with the signs of their velocities.
typedef struct brunt_followers {
    int count;
    int32_t at[BRUNT_MAX_IMAGES][3];
    real *node[BRUNT_MAX_IMAGES], sign[BRUNT_MAX_IMAGES][3];
} brunt_followers;
void brunt_followers_find(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node,
                          brunt_followers *out);
