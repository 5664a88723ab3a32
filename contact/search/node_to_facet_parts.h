// What node-to-facet contact keeps, and what the files of its search share. Private to them.
#pragma once

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "contact/search/broad_phase.h"
#include "contact/search/candidates.h"
#include "contact/search/distance_cache.h"
#include "contact/search/edge_edge.h"
#include "contact/search/facet_cells.h"
#include "contact/search/initial_penetration.h"
#include "contact/search/node_touches.h"

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct brunt_node_to_facet {
    near_bodies bodies;
    facet_cells cells;
    distance_cache cache;
    node_touches touches;
    initial_penetration penetration;
    node_candidates nodes;
    near_edges edges;
    particle_candidates particles;
};

// Place `q` of node n: the first places of all nodes, then the second ones, which few nodes need.
static inline facet_candidate *node_candidate_of(const brunt_node_to_facet *f, const brunt_contact_surface *s,
                                                 int32_t n, int32_t q) {
    return &f->nodes.candidate[(int64_t)q * s->node_count + n];
}

static inline const brunt_master *kept_master(const brunt_node_to_facet *f, const facet_candidate *h) {
    return &f->nodes.masters[h->worker].master[h->master];
}

// The nodes of what a node is on.
static inline const int32_t *node_corners_under(const brunt_node_to_facet *f, const brunt_contact_surface *s,
                                                const facet_candidate *h, int *count) {
    const brunt_master *feature = h->feature.any ? kept_master(f, h) : NULL;
    *count = feature ? feature->count : brunt_face_corners(s->face[h->face]);
    return feature ? feature->node : s->face[h->face];
}

#define RESERVE(f, array, count, what, error) BRUNT_CAPACITY((f)->array, (size_t)(count), 0, what, error)

// --- node_to_facet.c
// Makes what is kept between steps, when there is none. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_to_facet_make(brunt_node_to_facet **node_to_facet, int mpm_count, int32_t nodes, brunt_error *error);

// --- distance_cache.c
// Room for what is remembered of so many nodes. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_distance_cache_fit(brunt_node_to_facet *f, int32_t nodes, int32_t kept, brunt_error *error);

// --- node_touches.c
// BRUNT_OK, or BRUNT_FAILED: out of memory. After the surface was renewed: what is held follows its nodes.
int brunt_node_touches_renew(node_touches *touches, const brunt_contact_surface *surface, brunt_error *error);

// A node of body k that is in no constraint of the step: what it holds is lost, of facets where none is near any more.
void brunt_node_forgets(brunt_node_to_facet *f, const brunt_contact_surface *surface, int k, int32_t n);

// Notes that two edges touch in this step. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_touches_cross(node_touches *touches, const touched_edges *edges, brunt_error *error);

// After all constraints of the step are found, of nodes `constraints_of_node`: what touches have taken goes where they
// go on. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_touches_hand_over(node_touches *touches, const uint8_t *constraints_of_node, brunt_error *error);

// --- touches_left.c
// After that: what nodes hold that touch nothing any more goes to those that touch the same body beside them, and to
// those of that body that are on their facets.
void brunt_touches_go_on(const brunt_contact_context *m, brunt_node_to_facet *f);

// --- facet_cells.c
// Makes the cells anew when they no longer hold all that may be near. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_facet_cells_make(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error);
// Whether anything reaches, within `by`, a box near box `box`.
bool brunt_broad_phase_in_range(const brunt_node_to_facet *f, int32_t box, const double low[3], const double high[3],
                                double by);
// --- candidates.c
// Fills the bodies a query may touch or have entered. Whether there are any.
bool brunt_candidates_bodies(const brunt_node_to_facet *f, search_query *l);
// The cell of a place, whose facets it is to look at; BRUNT_NONE: none is near.
int64_t brunt_candidates_cell(const brunt_node_to_facet *f, const double x[3]);
void brunt_candidates_find(const brunt_contact_context *m, const brunt_node_to_facet *f, const search_query *l,
                           int32_t guess, candidate_list *out);
// Lists the facets about node n, whose query looked through its cell; and what it meets among them: false where that
// hangs on others, too.
void brunt_candidates_remember(const brunt_contact_context *m, brunt_node_to_facet *f, const search_query *l,
                               int32_t n);
bool brunt_candidates_among(const brunt_contact_context *m, const brunt_node_to_facet *f, search_query *l, int32_t n,
                            candidate_list *out);
// The same of a particle, for which l->bounds are made.
void brunt_candidates_find_of_particle(const brunt_contact_context *m, const brunt_node_to_facet *f, search_query *l,
                                       candidate_list *out);
// A facet on the front of a membrane in place of that on its back; any other as it is: what cells list.
int32_t brunt_candidates_front(const brunt_contact_surface *s, int32_t face);
bool brunt_candidates_still_nearest(const brunt_contact_context *m, const brunt_node_to_facet *f, int32_t n,
                                    const double *normal, double least, candidate_list *out);

// --- node_search.c
// What every node meets, and its target. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_search(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error);

// --- node_facet.c
// gap [m]: all of it, and beyond what a place may lie in the other body (initial_penetration.h).
double brunt_node_to_facet_target(const brunt_contact_surface *s, const double gap[2], double approach, double before,
                                  double dt);
double brunt_node_to_facet_area(const brunt_contact_surface *s, int32_t n, const double direction[3]);
// The support of a surface node, made when it is first asked for. BRUNT_NONE: out of memory.
int32_t brunt_node_to_facet_dof_node(brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n,
                                     brunt_constraint_set *constraints, brunt_error *error);
// What of a facet is under x, or of a feature; and the velocity of x relative to that, along n.
void brunt_node_to_facet_corners(const brunt_contact_surface *s, const facet_candidate *h, const double x[3],
                                 brunt_corners *under);
double brunt_node_to_facet_approach(const brunt_corners *under, const double n[3], const double v[3], double (*of)[3]);
// Fills what a place meets; how the two bodies meet.
const brunt_pair *brunt_node_to_facet_constraint(const brunt_contact_context *m, const facet_candidate *h,
                                                 const double x[3], int body, brunt_constraint *constraint);
int brunt_node_to_facet_master(const brunt_contact_surface *s, const facet_candidate *h, const double x[3],
                               brunt_master *master);
// The master's entries, whose supports there are; sets the point's facet.
void brunt_node_to_facet_entries(const brunt_node_to_facet *f, const brunt_master *master, brunt_constraint *constraint,
                                 brunt_constraint_entry *entry);

// --- feature_edges.c
// The edges near other bodies, in the order of the surface's facets: freed; room for what is asked of them (BRUNT_OK,
// or BRUNT_FAILED: out of memory); and how many a facet of body k has, which go to `out` (NULL: they are counted).
// Several threads may ask, each of other facets.
void brunt_feature_edges_free(near_edges *edges);
int brunt_feature_edges_begin(brunt_node_to_facet *f, const brunt_contact_surface *s, brunt_error *error);
int brunt_feature_edges_of(const near_edges *edges, const brunt_contact_surface *s, int k, int32_t face,
                           near_edge *out);
// Lists the features among the edges of body k, as they are in this step, unless that is done. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_feature_edges_list(const brunt_contact_context *m, brunt_node_to_facet *f, int k, brunt_error *error);

// --- edge_edge.c
// Contact points where edges cross. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_edge_edge_find(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_constraint_set *constraints,
                         brunt_error *error);

// --- particle_facet.c
// Contact points of the particles of body k of the mpm bodies. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *constraints, brunt_error *error);
// After the solution: velocities back to the grids' nodes.
void brunt_node_to_facet_scatter_grids(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                       const brunt_constraint_set *constraints);
