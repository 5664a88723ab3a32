// What the files that look for candidates share. Private to them.
#pragma once

#include "contact/search/nearest.h"

static const double CLOSE = 0.25;   // ... so many mean edges, the least one with the normal of a facet
static const double MARGIN = 0.125; // mean edges: facets so much further than the nearest are looked at closely, too
static const double CLEAR = 1e-4;   // mean edges: distances of boxes that tell of those of the facets in them

// Of either side of a membrane: the same numbers for both.
static inline brunt_closest closest_on(const brunt_contact_surface *s, int32_t face, const double x[3]) {
    int32_t front = brunt_candidates_front(s, face);
    brunt_closest at = brunt_closest_on_face(s, front, x);
    if (front != face) turn_over(s, &front, &at);
    return at;
}

static inline bool near_box(const double box[6], const double x[3], double by) {
    return x[0] >= box[0] - by && x[0] <= box[3] + by && x[1] >= box[1] - by && x[1] <= box[4] + by &&
           x[2] >= box[2] - by && x[2] <= box[5] + by;
}

// What is looked through: the facets in the cell, or those listed when it last looked there.
static inline const int32_t *facets_of(const brunt_node_to_facet *f, const search_query *l, int32_t *count) {
    *count = l->beside ? l->besides : f->cells.first[l->cell + 1] - f->cells.first[l->cell];
    return l->beside ? l->beside : f->cells.face + f->cells.first[l->cell];
}

// The two nearest facets of all, whichever way they face.
typedef struct two_nearest {
    int32_t face;
    double first, second;  // squares of their distances
    double height, square; // [m] of the place above the nearest one; square of the distance to that
} two_nearest;

// Square of the distance from x to a box.
static inline double box_square(const double box[6], const double x[3]) {
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        const double below = box[a] - x[a], above = x[a] - box[3 + a], way = below > above ? below : above;
        if (way > 0) sum += way * way;
    }
    return sum;
}

// Whether all in a box whose distance has the square `bound` is further than the root of `square`, and so far that
// rounding does not matter.
static inline bool further(const brunt_contact_surface *s, double bound, double square) {
    const double clear = CLEAR * s->mean_edge;
    return bound * (1 - 1e-6) > square && bound > clear * clear;
}

// Middle surfaces of membranes stay half their thickness away from what they meet.
static inline void thicken(const brunt_contact_surface *s, double half, candidate_list *out) {
    for (int32_t q = 0; q < out->count; q++)
        out->candidate[q].gap -= half + s->membrane.side[out->candidate[q].body].half;
}

// Whether a place is clearly before the nearest facet of all.
static inline bool is_before(const brunt_contact_surface *s, const two_nearest *two) {
    return two->height > 1e-6 * s->mean_edge && two->height > 0.1 * sqrt(two->square);
}

// How far all facets but the nearest are, looked for as far as `to`.
static inline double second_of(const brunt_contact_surface *s, const brunt_node_to_facet *f, const two_nearest *two,
                               double to) {
    const double second = sqrt(two->second), range = f->bodies.range < to ? f->bodies.range : to;
    return (second < range ? second : range) * (1 - 1e-8) - TOUCH * s->mean_edge;
}

// --- remembered.c
// A place, one facet, of which two.face, first and height are set, and those listed about it (-1 after the last, or
// BRUNT_BESIDE): how near they are.
typedef struct beside_one {
    two_nearest two;
    double root;                // [m] what is no further is as near as the one
    double bound[BRUNT_BESIDE]; // [m^2] least squares of the distances to the others
    int32_t count, least;       // how many there are; which of them is to be looked at first, -1: none has to be
} beside_one;
// Begins. Whether the one is near enough.
bool brunt_beside_begin(const brunt_contact_surface *surface, const brunt_node_to_facet *f, const double x[3],
                        const int32_t *list, beside_one *beside);
// With the square of the distance to the one that is looked at first. Whether none of them is as near.
bool brunt_beside_settle(const brunt_contact_surface *surface, const double x[3], const int32_t *list, double square,
                         beside_one *beside);
// What is then found, of whose candidate, the one, there is all: whether it is met, and how far all are.
void brunt_beside_end(const brunt_contact_surface *surface, const brunt_node_to_facet *f, const beside_one *beside,
                      bool opposed, candidate_list *out);
