// What a place, of a node or of a particle, may touch in a step. Private to the search.
#pragma once

#include "contact/distance/feature.h"
#include "contact/search/particle_dof.h"

enum { BRUNT_MAX_CANDIDATES = 7, BRUNT_MAX_NEAR = 32 };

// The nearest facet of one other body, or the edge or corner of it (`feature`).
typedef struct facet_candidate {
    int32_t face, triangle, body;
    brunt_feature feature;
    bool valley; // another slope of it is as near
    bool inside; // the nearest point is no edge and no corner of the facet
    double gap, n[3], target;
    int32_t worker, master; // of a feature that is met: the worker that looked, and which of its masters
} facet_candidate;

typedef struct candidate_list {
    facet_candidate candidate[BRUNT_MAX_CANDIDATES];
    int32_t count;
    double distance, second; // [m] how far the nearest facet is, or how far was looked, and the nearest but the one hit
    double reach;            // [m] what is further away than this has no part in it
} candidate_list;

// Least distances from a place to the facets of its cell, as their boxes tell.
enum { BRUNT_BOUNDED = 64 };
typedef struct facet_bounds {
    double square[BRUNT_BOUNDED]; // [m^2]
    int32_t least;                // which facet of the cell has the least
} facet_bounds;

// A place that looks around: which bodies it may touch (their boxes are that near), and which it may have entered.
typedef struct search_query {
    int32_t box, body;
    const double *x, *normal; // outward; NULL when it has none
    bool particle; // nothing is remembered of what it sees: how far all but the nearest facet are is not asked for
    const facet_bounds *bounds; // of a particle that has one body near it; NULL: each facet is looked at by itself
    int64_t cell;
    const int32_t *beside; // facets to look through in place of those in its cell, so many; NULL: those
    int32_t besides;
    int32_t touch[BRUNT_MAX_NEAR], touches, enter[BRUNT_MAX_NEAR], enters;
    // Where there are membranes: half its own thickness, how far behind one it may be found, and the elements of its
    // own body that are no obstacle; without those the body does not meet itself.
    bool membrane;
    double half, shallow;
    const int32_t *patch;
    int32_t patch_count;
} search_query;

// What a slave meets: an edge or corner with the faces about it, or a facet.
typedef struct brunt_master {
    int32_t node[BRUNT_FEATURE_NODES];
    double weight[BRUNT_FEATURE_NODES], gradient[BRUNT_FEATURE_NODES][3], facet[3], height;
    int count;
} brunt_master;

// The corners of what a place is over, and their weights there.
typedef struct brunt_corners {
    int32_t node[BRUNT_FEATURE_NODES], count;
    double weight[BRUNT_FEATURE_NODES];
} brunt_corners;

// The edges and corners that are met, by the worker that looked; none where nothing meets one.
typedef struct master_list {
    brunt_master *master;
    size_t capacity;
    int32_t count;
    brunt_error error;
} master_list;

// Of the nodes of a surface.
typedef struct node_candidates {
    uint8_t *count;             // of each node ...
    facet_candidate *candidate; // ... of which the first of all nodes come first, then the second
    master_list *masters;
    int masters_count;
    int32_t *dof_of; // of each node: its degree-of-freedom node, -1
    int32_t *first;  // of each node: its first constraint and first entry
    uint8_t *meets;  // of each node: it is in some of the constraints
    size_t count_capacity, candidate_capacity, dof_of_capacity, first_capacity, meets_capacity;
} node_candidates;

typedef struct particle_candidate {
    int32_t block;
    int64_t particle;
    double x[3];
    facet_candidate h;
} particle_candidate;

typedef struct particle_list {
    particle_candidate *candidate;
    size_t capacity;
    int32_t count;
    brunt_error error;
} particle_list;

typedef struct particle_run {
    int worker;
    int32_t first, count;
} particle_run;

// Of particles, by the worker that looked; and of each block of a body where it is there.
typedef struct particle_candidates {
    particle_list *list;
    int list_count;
    particle_run *run;
    size_t run_capacity;
    brunt_particle_dofs *dofs; // of each mpm body
    int mpm_count;
} particle_candidates;
