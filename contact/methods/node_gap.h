// Where bodies of material points meet at a node that they share: the normal between them, and the gap.
#pragma once

#include "contact/contact.h"
#include "contact/distance/gjk.h"
#include "contact/distance/particle_vicinity.h"

// What a thread needs for it; {0} at first.
typedef struct brunt_node_gap {
    brunt_vicinity *vicinity; // of each body that shares the block
    size_t vicinity_capacity;
    int32_t vicinity_count;
    int nodes[2];         // first and last along the last axis that bodies share
    bool alone;           // no third body is at the node
    brunt_cloud cloud[2]; // two bodies near a node
    // Between which particles of a vicinity's the two were nearest at the node before: mostly at the next one, too.
    int before[2];
    brunt_corners corners;
    brunt_error error; // what went wrong
} brunt_node_gap;

// One of two bodies at a node: its number among those that share the block, and its velocity there [m/s].
typedef struct brunt_node_side {
    brunt_body *body;
    int32_t slot;
    int entry;
    const double *v;
} brunt_node_side;

// Begins a block of nodes that `count` bodies share; `nodes`: the first and the last of them along the last axis.
// BRUNT_OK, or BRUNT_FAILED: out of memory, in g->error.
int brunt_node_gap_begin(brunt_node_gap *g, int32_t count, const int nodes[2]);
// Normal from the first side to the second (unit), and the gap along it [m], 0 where no contact asks for it. Whether
// anything tells the bodies apart; not where there is no memory, in g->error.
bool brunt_node_gap_find(brunt_node_gap *g, const brunt_contact_context *m, const brunt_node_side sides[2], int node,
                         double n[3], double *gap);
void brunt_node_gap_free(brunt_node_gap *g);
