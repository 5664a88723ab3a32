// Which bodies are near each other, by boxes about them. Private to the search.
#pragma once

#include "contact/search/node_to_facet.h"

typedef struct body_box {
    double low[3], high[3];
    double start; // [m] its low end along the axis that boxes are sorted by
    int body;     // of the world
    int fem;      // index in the surface, -1: material points
    int mpm;
    bool membrane;
    bool seen;         // nodes or particles of some that is near look at its facets
    int32_t looks_end; // of those near it in the list: its nodes look at the facets of the ones before
} body_box;

typedef struct near_pair {
    int32_t a, b;          // of the boxes
    bool a_looks, b_looks; // nodes of one look at facets of the other
} near_pair;

typedef struct near_bodies {
    double range;        // [m] how far a body looks for others in this step ...
    double travel;       // ... and how far anything moves towards anything ...
    double plane_travel; // ... and towards a plane
    body_box *box;       // by low end along `axis`, the one along which they are spread out most
    int axis;
    size_t box_capacity;
    int32_t box_count;
    near_pair *pair;
    size_t pair_capacity;
    int32_t pair_count;
    int32_t *box_of; // body of the surface -> box
    size_t box_of_capacity;
    int32_t *first, *list; // boxes near box b: list[first[b] .. first[b + 1]), those that it looks at before the others
    size_t first_capacity, list_capacity;
} near_bodies;

static inline bool has_near_bodies(const near_bodies *bodies, int32_t box) {
    return bodies->first[box + 1] > bodies->first[box];
}
