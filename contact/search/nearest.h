// The nearest facets of a place, of one body, and what of them is met: facet, edge, corner, or the slopes of a valley.
// Private to the search.
#pragma once

#include "contact/distance/point_facet.h"
#include "contact/search/node_to_facet_parts.h"

enum { MAX_TIED = 16 };
static const double TOUCH = 1e-6;  // mean edges: facets that are nearer by less than this are equally near
static const double OPPOSED = 0.1; // least cosine between a slave's outward normal and the one into the master

typedef struct tied {
    brunt_closest at;
    int32_t face;
} tied;

// Keeps `found` among the nearest of its body; nearest points that are equally near belong to facets that share an edge
// or a corner there, and the one that most faces the place decides on which side of the surface it is.
typedef struct nearest {
    int32_t body, count;
    double square, root; // of the distance; what is no further than its root is as near
    tied tied[MAX_TIED];
} nearest;

static inline bool is_membrane(const brunt_contact_surface *s, int32_t body) {
    return s->membrane.side && s->membrane.side[body].faces > 0;
}

// The nearest point of the front of a membrane as one of its back: nodes there are in reversed order.
static inline void turn_over(const brunt_contact_surface *s, int32_t *face, brunt_closest *at) {
    if (s->face[*face][3] >= 0) {
        at->triangle = (6 - at->triangle) % 4;
        at->triangles = (at->triangles & 10) | (at->triangles & 1) << 2 | (at->triangles & 4) >> 2;
    }
    *face += s->membrane.side[s->face_body[*face]].faces;
    for (int a = 0; a < 3; a++) at->normal[a] = -at->normal[a];
}

// Whether a place is on the side of a membrane that facet is of, and not beyond its edge when a little behind it. There
// is no inside that it could have entered: what is further behind belongs to the other side, or to the far side of a
// body that is on this one.
static inline bool on_side(const search_query *l, const brunt_closest *at) {
    const double height = dot(at->normal, at->d);
    if (height > 0) return true;
    if (!l->normal) return height == 0;
    return height > -l->shallow && height * height >= 0.5 * at->square;
}

// What counts as near as the nearest, whose distance has this square.
static inline double tie(const brunt_contact_surface *s, double square) {
    return sqrt(square) * (1 + 1e-8) + TOUCH * s->mean_edge;
}

static inline void keep(const brunt_contact_surface *s, nearest *best, const brunt_closest *at, int32_t face) {
    if (at->square > best->root * best->root) return;
    if (at->square < best->square) {
        const double root = tie(s, at->square);
        if (best->square > root * root) best->count = 0;
        best->square = at->square, best->root = root;
    }
    if (best->count < MAX_TIED) best->tied[best->count++] = (tied){*at, face};
}

// A hit on facets that face the slave; beside an edge or a corner it must also face the way to them.
bool brunt_nearest_opposed(const brunt_contact_surface *s, const nearest *best, const double *normal,
                           facet_candidate *out);
// The other slopes of a valley, in which all bear: with the first of two, an inside corner and its mirror image bore
// differently.
void brunt_nearest_valley(const brunt_contact_surface *s, nearest *best, const double *normal, candidate_list *out);
// A hit on whatever facet is nearest, when the slave is behind it; `least`: the least cosine with its normal.
bool brunt_nearest_behind(const brunt_contact_surface *s, const nearest *best, const double *normal, double least,
                          facet_candidate *out);
