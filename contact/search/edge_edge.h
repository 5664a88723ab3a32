// Edges near other bodies, and those of them that are features. Private to the search.
//
// A feature is a convex edge where a surface turns by more than a mesh's facets of a curved one do, or the rim of a
// membrane. Only features meet: where two of them cross, nodes on facets leave up to half an edge times tan(turn / 2)
// unmet, whichever of the two turns less.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct near_edge {
    int32_t node[2], face[2]; // face[1] -1: a rim
} near_edge;

typedef struct feature_edge {
    int32_t node[2];
    bool rim;
    double low[3], high[3]; // [m] bounds
    double into[2][3];      // unit, across the edge along its faces; of a rim twice the same
    double out[3];          // outward: sum of the normals, of a rim away from its face
    double depth;           // [m] how far another one may be behind it and is still met from this side
} feature_edge;

// A feature's bounds along one axis.
typedef struct edge_span {
    double low, high;
    int32_t feature;
} edge_span;

typedef struct near_edges {
    near_edge *near; // of the facets in cells: of body k of the surface near[first[2 k] .. first[2 k + 1])
    int32_t near_count, *first;
    int32_t (*beyond)[4];  // of each facet, as long as the surface has the same: what is beyond its edges; 0: not known
    bool beyond_known;     // it is of the surface as it is
    uint8_t *turns;        // of each edge of the body that is looked at: it is a feature
    feature_edge *feature; // of this step
    int32_t feature_count;
    int32_t *feature_first; // of body k: feature[feature_first[2 k] .. feature_first[2 k + 1]); -1: not listed
    edge_span *span;
    size_t near_capacity, first_capacity, feature_capacity, feature_first_capacity, span_capacity, turns_capacity,
        beyond_capacity;
} near_edges;
