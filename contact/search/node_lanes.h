// Nodes whose nearest facet is known, as many at once as a vector holds. Private to the search.
#pragma once

#include "base/simd.h"
#include "contact/contact.h"

// Nodes, each with the quadrilateral that it was nearest to; and what it sees there, to the bit as if it was looked at
// alone.
typedef struct node_lanes {
    int32_t node[BRUNT_DOUBLES], face[BRUNT_DOUBLES];
    bool known[BRUNT_DOUBLES];       // the nearest point is inside of one of its four triangles, and near; else nothing
                                     // is told of it
    bool opposed[BRUNT_DOUBLES];     // what is there faces the node
    int32_t triangle[BRUNT_DOUBLES]; // of the facet
    double square[BRUNT_DOUBLES], gap[BRUNT_DOUBLES], n[BRUNT_DOUBLES][3];
    double approach[BRUNT_DOUBLES], came[BRUNT_DOUBLES]; // [m/s] along n, now and, where the gap is below 0, before
} node_lanes;

// `range`: [m] how far is looked.
void brunt_node_lanes_look(const brunt_contact_surface *surface, double range, node_lanes *lanes);
// Squares of the distances of nodes to quadrilaterals that they are beside; -1 where that is not clear.
void brunt_node_lanes_squares(const brunt_contact_surface *surface, const int32_t node[BRUNT_DOUBLES],
                              const int32_t face[BRUNT_DOUBLES], double square[BRUNT_DOUBLES]);
