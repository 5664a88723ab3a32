// What is remembered of the nodes of a surface from step to step. Private to the search.
#pragma once

#include <stddef.h>
#include <stdint.h>

// How far from everything a node was when it was looked at, and how far it and what is near it have moved
// against each other since: until that is as far, it touches nothing and need not be looked at (Verlet).
typedef struct node_distance {
    double distance, since;
    double second; // of the nearest facet but `nearest`: until then that one stays the nearest
    double beyond; // how far all facets are, at least, but those `beside` it; 0: none are listed. It follows motion
} node_distance;

enum { BRUNT_BESIDE = 8 }; // as many about a corner: beside one a node has several as near again and again

typedef struct distance_cache {
    node_distance *node;             // of each
    int32_t *nearest;                // of each: the face it was nearest to, to look at first; -1
    int32_t *spare;                  // while they are put in a new order
    int32_t (*beside)[BRUNT_BESIDE]; // of each: facets about it in ascending order, -1 after the last
    size_t node_capacity, nearest_capacity, spare_capacity, beside_capacity;
} distance_cache;

// Aborts where what is remembered of `nodes` nodes names faces that there are not, or a way below 0.
void brunt_distance_cache_validate(const distance_cache *cache, int32_t nodes, int32_t faces);
