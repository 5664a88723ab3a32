// The surface of a body whose elements may leave it, as it is now.
//
// What is whose neighbour is found once, among the elements the body has at the start; after that a face is of the
// surface when the element on its other side is eroded. Faces are in the order that brunt_fem_faces gave them at the
// start, whatever has left meanwhile and wherever elements lie now: the surface follows from which elements there are,
// and from nothing else.
#pragma once

#include "fem/fem_body.h"

typedef struct brunt_surface_topology {
    int32_t elements; // at the start
    int32_t *rank;    // of each element by its number in the mesh: its place then
    int32_t *slot;    // of each place: where the element is now, -1: gone
    uint8_t *open;    // of each place: bit f set when face f is of the surface; 0 of eroded elements
    int32_t live;     // elements now
    int32_t *across;  // of each place and face: the place of the element on the other side, -1: none
    int32_t *key,
        *before; // faces of the surface as place * faces of an element + face, ascending: now, and of the last time
    int32_t key_count, before_count;
    size_t key_capacity, before_capacity;
    // Of each node of the body: its place among those that contact sees, -1; now, and of the last time. Those have
    // faces of the surface, or are detached and go on as free particles.
    int32_t *number, *number_before;
    int32_t number_count;
    bool changed; // by the last renewal
} brunt_surface_topology;

// Of a body that has all its elements. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_topology_make(brunt_surface_topology *topology, const brunt_fem_body *fem, brunt_error *error);
// The surface as it is now; what it was becomes `before`. `changed` tells whether it was made anew. BRUNT_OK, or
// BRUNT_FAILED: out of memory. `restored`: others may be there than before, of a saved state, and other nodes may be
// detached; else as many as before are the same.
int brunt_topology_renew(brunt_surface_topology *topology, const brunt_fem_body *fem, bool restored,
                         brunt_error *error);
// Nodes (of the body) of face `k` of the surface; the 4th is -1 for triangles, 3rd and 4th for segments.
void brunt_topology_face(const brunt_surface_topology *topology, const brunt_fem_body *fem, int32_t k, int32_t node[4]);
void brunt_topology_free(brunt_surface_topology *topology);
