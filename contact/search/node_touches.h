// What touches have taken of the nodes of a surface (constraint/release.h), kept from step to step, by what they touch:
// a node may leave one while another pushes. That of crossing edges is kept at one of their nodes. Private to the
// search.
#pragma once

#include "contact/constraint/constraint.h"

typedef enum touched { TOUCHED_FACET, TOUCHED_EDGE, TOUCHED_PLANE, TOUCHED_COUNT } touched;

// Two edges that touch, of body[0] and of body[1]: what that takes is kept at node[0], which has most of the crossing.
typedef struct touched_edges {
    int32_t node[4], body[2];
} touched_edges;

// What is left goes to several in equal shares: all claim it first.
typedef enum touch_round { TOUCH_CLAIM, TOUCH_TAKE, TOUCH_CLEAR, TOUCH_ROUNDS } touch_round;

typedef struct node_touches {
    brunt_touch_energy (*of)[TOUCHED_COUNT];    // each node's; NULL: nothing is given back
    brunt_touch_energy (*spare)[TOUCHED_COUNT]; // while they are put in a new order
    touched_edges *edges;                       // of this step
    int32_t *keeper;                            // all nodes that hold something of edges, and others
    int32_t edges_count, keeper_count;
    bool left; // some node that touches nothing any more holds something
    size_t of_capacity, spare_capacity, edges_capacity, keeper_capacity;
} node_touches;

// `met`, of what is kept for edges, in this step: nothing touches there; edges of one other body do; of several, or of
// another than those that what is held is of; they are listed.
enum { NONE_TOUCH, TOUCHES, CONTESTED, LISTED };

// Whether what is held is of a partner; what is of 0 is of anyone.
static inline bool is_of(const brunt_touch_energy *touch, int32_t partner) {
    return touch->held == 0 || !touch->partner || touch->partner == partner;
}

// The touch of a node; NULL: none is kept.
static inline brunt_touch_energy *brunt_node_touch(const node_touches *touches, int32_t n, touched what) {
    return touches->of ? &touches->of[n][what] : NULL;
}
// Whether a node has something to be given back.
static inline bool brunt_node_holds(const node_touches *touches, int32_t n, touched what) {
    return touches->of && touches->of[n][what].held > 0;
}
void brunt_node_touches_free(node_touches *touches);
void brunt_node_touches_validate(const node_touches *touches, int32_t nodes);
