// What the nodes of a slot feel of a body: its particles as ellipsoids of material. Each is made once, when a node
// first asks for its bin, not for each of the 27 nodes that feel it.
#pragma once

#include "contact/distance/particle_cloud.h"
#include "mpm/mpm_body.h"

enum { BRUNT_VICINITY_COLUMNS = 49, BRUNT_VICINITY_BINS = 7 };

typedef struct brunt_vicinity {
    brunt_body *body; // NULL: none
    int32_t slot;
    int from, to;         // bins along the last axis that are asked for, from `order` before the slot
    double *data;         // rows of `stride` numbers
    size_t stride, bytes; // [-], [bytes]
    // Of each column of bins along the last axis, which lies together: where each bin begins in the rows.
    int32_t start[BRUNT_VICINITY_COLUMNS * (BRUNT_VICINITY_BINS + 1)];
    bool made[BRUNT_VICINITY_COLUMNS];
} brunt_vicinity;

// Turns to a slot of a body; a vicinity is empty at first ({0}). `nodes`: the first and the last along the last axis
// that is to look. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_vicinity_turn(brunt_vicinity *vicinity, brunt_body *body, int32_t slot, const int nodes[2],
                        brunt_error *error);
// Refills a cloud with the particles of the bins whose kernel covers a node of the slot. BRUNT_OK, or BRUNT_FAILED: out
// of memory.
int brunt_vicinity_look(brunt_vicinity *vicinity, int node, brunt_cloud *cloud, brunt_error *error);
void brunt_vicinity_free(brunt_vicinity *vicinity);
