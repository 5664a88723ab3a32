// Private to the barrier: what it is made of. Points are vertices, then those on round rims, then material points;
// places are points, then planes.
#pragma once

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/barrier/barrier.h"
#include "contact/barrier/barrier_function.h"
#include "contact/barrier/closest.h"
#include "contact/barrier/near.h"
#include "linear/assembly.h"
#include "linear/project.h"

#include <math.h>
#include <string.h>

// Of four places in three dimensions, or of five in two.
enum { BARRIER_DOFS = 12, BARRIER_GRAIN = 64, BARRIER_TASK_GRAIN = 16 };

// Of a pair or plane: what a contact needs to know.
typedef struct barrier_law {
    double distance, stiffness, friction, slip_speed, reach;
    brunt_gap_energy *energy;
} barrier_law;

// Of a point within a corner of what may overlap: the other face, whose vertex beyond the corner is the last place.
typedef struct barrier_wedge {
    double size, gap, n[2], far; // [m], [m]; its normal, and the weight of that place in its gap
    double area;                 // [m] share of the surface
} barrier_wedge;

typedef struct barrier_contact {
    int32_t place[BRUNT_CLOSEST_PLACES];
    int32_t law;      // plane, or plane_count + pair
    int8_t side;      // 1: the first feature is of the law's body a (a plane's points), -1: of b
    int8_t within;    // a corner (barrier_corner.c), whose vertex is this place; 0: none
    double weight;    // [m^2] (2D [m]) share of the surface, times the multiplicity: negative in concave corners
    double threshold; // [m^4] |ea x eb|^2 from which two edges count in full; 0: not edges
    union {
        double edge[2][3]; // [m] of two edges
        barrier_wedge wedge;
    };
    brunt_closest at;
    double offset;       // [m] the gap is at.d less it
    double normal_force; // [N] when friction was updated; stays 0 where there is none
} barrier_contact;

// Of a contact that rubs, on the way to the minimum: the slip where that was looked at last, and the part of the
// greatest force that friction takes, as an unknown of its own (barrier_slip.c).
typedef struct barrier_rub {
    double kept[3]; // [m] that the surfaces had given before the step
    double turned;  // [m] of it along the normal, before it was turned along the surfaces
    double share;   // of the step's slip that counts: load steps, what came before they met does not
    double slip[3]; // [m] dt times its velocity, and that
    double part[3]; // at most of length 1
    double energy;  // [J] where it was asked for last
} barrier_rub;

// That of a contact where friction that follows what presses was looked at last, to be known by where contacts are
// found anew.
typedef struct barrier_felt {
    int32_t place[BRUNT_CLOSEST_PLACES], law;
    bool edges;
    double slip[3], part[3];
} barrier_felt;

// What a vertex keeps of a body or a plane (-2 - its number) that it touches; force 0: it touches nothing there.
enum { BARRIER_KEPT = 3 };
typedef struct barrier_kept {
    int32_t other;
    bool by_edges;         // it touches nothing there itself, but edges that end at it do; until the next step
    double force, slip[3]; // [N], [m]
} barrier_kept;

// What two edges that cross keep: places of the contact, and how far they have given.
typedef struct barrier_kept_edges {
    int32_t place[4];
    double slip[3]; // [m]
} barrier_kept_edges;

typedef struct barrier_contacts {
    barrier_contact *contact;
    int64_t count;
    size_t contact_capacity;
} barrier_contacts;

// Where a rim turns outwards by a lot: the facets that end and begin there, in their body's order.
typedef struct barrier_corner {
    int32_t vertex, facet[2];
    double part, sine; // of the reach, how far it goes; of half the angle between its faces
} barrier_corner;

// A feature that a point is near: vertices ascending, -1 where there are fewer.
typedef struct barrier_feature {
    int32_t vertex[3];
    int32_t law;
    int8_t side;
    double share;
    int32_t times;                // multiplicity
    int32_t facet;                // where it is the inside of one
    double along;                 // and where on its curve, of its parameter
    double gap;                   // [m] of what may overlap; else INFINITY
    const barrier_corner *corner; // that the point is within, of which this is a face; NULL: none
} barrier_feature;

// What facets that a point is near have in common: edges (b -1: vertices), how many facets (edges) hold them.
typedef struct barrier_shared {
    int32_t a, b, facets, law;
    int8_t side;
    double share;
    int32_t more; // of vertices: sum of (facets - 1) of the edges there
} barrier_shared;

// Room that a thread works in.
typedef struct barrier_workspace {
    barrier_feature *feature;
    barrier_shared *edge, *vertex;
    int64_t feature_count, edge_count, vertex_count;
    barrier_contact *contact; // that it has found
    int64_t contact_count;
    int32_t clear_of;      // the first body that the point is clear of, and by how much [m]
    double clear_by, lost; // [m] what clearances have lessened by; INFINITY: none are known
    size_t feature_capacity, edge_capacity, vertex_capacity, contact_capacity;
    brunt_error error;
} barrier_workspace;

// Where the contacts of a task begin among those that a thread has found.
typedef struct barrier_found {
    int64_t at;
    int worker;
} barrier_found;

// The curve of an edge (barrier_arcs.c): of a straight one the two ends alone.
typedef struct barrier_arc {
    brunt_cubic curve;
    int32_t place[BRUNT_CUBIC_PLACES]; // vertices: the ends as those of the facet, then what is beyond them
} barrier_arc;

// A point on a round rim, between the ends of a facet.
enum { BARRIER_RIM_POINTS = 3 };
typedef struct barrier_rim {
    int32_t facet, node[BRUNT_CUBIC_PLACES]; // block nodes of the places of its curve
    double weight[BRUNT_CUBIC_PLACES], area; // [m]
    double x[3];                             // [m] at the start of the step
} barrier_rim;

typedef struct barrier_sets {
    int64_t *first, count;
    int32_t *node;
    size_t first_capacity, node_capacity;
} barrier_sets;

// A pair's bodies, the lesser first, as one number.
typedef struct barrier_key {
    uint64_t bodies;
    int32_t pair;
} barrier_key;

// Of the material points of a step, which do not change while it is sought.
typedef struct barrier_extent {
    bool known;
    double size;       // [m] of |x| + |x - origin|, the most of any component
    double spread;     // of a point's weights, the most that their sizes add up to
    int32_t low, high; // the block nodes that move them are among low .. high - 1
} barrier_extent;

// What is near with room to spare, for as long as boxes stay about where they were then (barrier_wide.c).
typedef struct barrier_wide {
    bool known;                           // it is of this step
    double spare;                         // [m] that boxes of facets and edges are larger by than they were
    brunt_near_box *point, *facet, *edge; // as they were; the larger ones
    brunt_near_list facets, edges;        // of points, edges
    size_t point_capacity, facet_capacity, edge_capacity;
} barrier_wide;

// How far points are outside bodies that they may overlap, beyond what they push each other from, where contacts were
// listed last (barrier_clear.c).
typedef struct barrier_clear {
    double *at; // [m] the first `count` unknowns there; 0: it is not known
    int64_t count;
    int32_t *body; // of points: the first that it was clear of; BRUNT_NONE: it was of none
    double *by;    // [m]
    double touch;  // [m] of the barrier then
    double spread; // what those lessen by at most, over the greatest displacement of a node
    size_t at_capacity, body_capacity, by_capacity;
} barrier_clear;

struct brunt_barrier {
    int dim;
    // Surface. Facets are simplices, vertices of each ascending (2D: the third -1).
    int32_t vertex_count, facet_count, edge_count;
    int32_t (*facet)[3], *body, (*edge)[2];
    bool *turned;                                   // of facets, in two dimensions: they were given the other way round
    double *vertex_area, *edge_area, *edge_length2; // [m^2] (2D [m]), [m^2], [m^2]
    size_t facet_capacity, turned_capacity, body_capacity, edge_capacity, vertex_area_capacity, edge_area_capacity,
        edge_length2_capacity;
    // Of round rims.
    bool round;
    barrier_arc *arc; // of facets
    int32_t *joint;   // of vertices: a facet whose curve goes on there into that of another; BRUNT_NONE: none
    barrier_rim *rim; // BARRIER_RIM_POINTS of each facet
    int32_t rim_count;
    size_t arc_capacity, joint_capacity, rim_capacity;
    bool overlaps; // surfaces may, as a mesh says
    // Corners, where something may overlap; of facets the one where they end.
    barrier_corner *corner;
    int32_t *corner_of, corner_count;
    size_t corner_capacity, corner_of_capacity;
    brunt_barrier_pair_source source;
    // Pairs that were near each other in this step, as they were found, and where each stands, by its bodies.
    brunt_barrier_pair *pair;
    barrier_key *key;
    int32_t pair_count, key_count; // keys that are being collected come behind those of the pairs
    size_t pair_capacity, key_capacity;
    brunt_barrier_step step;
    barrier_extent extent;
    // What was found last.
    double origin[3]; // boxes are measured from it
    brunt_near_box *point_box, *facet_box, *edge_box;
    bool *far;      // material points that come near nothing, and have no box
    int32_t *asked; // points that are not far
    int32_t asked_count;
    size_t point_box_capacity, facet_box_capacity, edge_box_capacity, far_capacity, asked_capacity;
    brunt_near_cells facet_cells, edge_cells;
    barrier_wide wide;
    barrier_clear clear;
    brunt_near_list facets, planes, edges; // of points, points, edges
    bool known;                            // they are of this step
    double part;                           // of a way that they are found along, no step goes farther
    bool swept, stale;                     // found along a way; `sets` are not those of `contacts`
    double *here;                          // [m] of the first `here_count` unknowns: where `contacts` are listed
    int64_t here_count;                    // as many as points have; 0: they are listed nowhere
    bool looked_here;                      // and what is near has been found
    size_t here_capacity;
    brunt_error unsaid; // memory ran out where no function could say so: the next look does
    int32_t *task;      // points that are near something; edges as -1 - edge
    int64_t task_count;
    double (*task_energy)[2];
    int64_t *task_first;
    barrier_found *task_place;
    size_t task_capacity, task_energy_capacity, task_first_capacity, task_place_capacity;
    barrier_workspace *workspace;
    int32_t workspace_count;
    size_t workspace_capacity;
    barrier_contacts contacts, lagged;
    barrier_rub *rub;               // of `lagged`
    barrier_kept *kept;             // BARRIER_KEPT of each vertex, where load steps keep slips
    barrier_kept_edges *kept_edges; // in three dimensions: of edges that crossed as the last step ended
    int64_t kept_edges_count;
    double touch; // [m] gaps below which surfaces are joined (barrier_join.c); 0: they are not
    bool keeps;
    bool live;          // friction follows normal forces and directions as they are, not as they were at the last lag
    bool tries;         // and what it is at a place that is tried is asked for
    const double *from; // meanwhile, where it has a potential: where the round began (barrier_cone.c)
    barrier_felt *felt, *felt_before; // meanwhile: of `lagged` where that was looked at last, and room
    int64_t felt_count;
    size_t rub_capacity, kept_capacity, kept_edges_capacity, felt_capacity, felt_before_capacity;
    barrier_sets sets, lagged_sets;
    brunt_colours colours, lagged_colours;
};

// --- places (barrier_place.c)
static inline int32_t barrier_surface_points(const brunt_barrier *b) { return b->vertex_count + b->rim_count; }
static inline int32_t barrier_points(const brunt_barrier *b) {
    return barrier_surface_points(b) + b->step.particles.count;
}
// NULL: not a point on a round rim.
static inline const barrier_rim *barrier_rim_of(const brunt_barrier *b, int32_t place) {
    return place >= b->vertex_count && place < barrier_surface_points(b) ? &b->rim[place - b->vertex_count] : NULL;
}
static inline int barrier_plane_of(const brunt_barrier *b, int32_t place) { return place - barrier_points(b); }
int32_t barrier_body_of(const brunt_barrier *b, int32_t point);
const double *barrier_start(const brunt_barrier *b, int32_t place);
double barrier_area_of(const brunt_barrier *b, int32_t point);
// What a place has moved by block vector u (NULL: nothing), in three components.
void barrier_move(const brunt_barrier *b, int32_t place, const double *u, double out[3]);
// Places as they are at u, measured from where `from` is then.
void barrier_relative(const brunt_barrier *b, const double *u, int32_t from, const int32_t *place, int count,
                      double (*out)[3]);
// How many unknowns there are, at least: up to the last of a point.
int64_t barrier_unknowns(const brunt_barrier *b);
// Block nodes of a place and their weights: how many; 0: a plane that does not move.
int64_t barrier_nodes(const brunt_barrier *b, int32_t place, const int32_t **node, const double **weight);

// --- pairs (barrier_pairs.c)
// Whether features of two bodies meet: points of `own` at facets of `other`, or edges.
bool barrier_bodies_meet(const brunt_barrier *b, int32_t own, int32_t other, bool edges);
// Makes the pairs of what is near. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_find_pairs(brunt_barrier *b, brunt_error *error);
// The law between two bodies whose features are near. `side`: 1 where `own` is the pair's a.
int32_t barrier_law_between(const brunt_barrier *b, int32_t own, int32_t other, int8_t *side);
barrier_law barrier_law_of(const brunt_barrier *b, int32_t law);
static inline bool barrier_law_is_plane(const brunt_barrier *b, int32_t law) { return law < b->step.plane_count; }
static inline const brunt_barrier_pair *barrier_pair_of(const brunt_barrier *b, int32_t law) {
    return &b->pair[law - b->step.plane_count];
}
double barrier_share_of(const brunt_barrier *b, int32_t law, int8_t side, bool edges);
// [m] what a point's surface stands off a plane.
double barrier_plane_offset(const brunt_barrier *b, const brunt_barrier_plane *plane, int32_t point);

// --- candidates (barrier_near.c, barrier_reach.c)
typedef struct barrier_way {
    brunt_barrier *b;
    const double *u, *p;
    double part;     // of p that is looked along
    double reach[3]; // [m] that no material point goes farther, from the start of the step
    double margin;   // [m] more than the distances: rounding of boxes
    bool *bad;       // of each worker: something is not a number
} barrier_way;
// Takes `reach`; how large the numbers are that boxes of material points are differences of.
double barrier_take_reach(barrier_way *way, const brunt_team *team);
// What may come near from u to u + part p; p NULL: what is near at u.
int barrier_find_near(brunt_barrier *b, const brunt_team *team, const double *u, const double *p, double part,
                      brunt_error *error);

// --- what is near with room to spare (barrier_wide.c): where there are no material points
// Whether it has all that is near by the boxes as they are.
bool barrier_wide_holds(const brunt_barrier *b);
// Keeps the boxes as they are, and makes cells of larger ones. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_wide_make(brunt_barrier *b, const brunt_team *team, brunt_error *error);
void barrier_wide_free(barrier_wide *wide);

// --- contacts (barrier_contacts.c)
// The contacts of a task at u, in the order of what it is near, handed to `take`.
typedef void barrier_take(void *context, const barrier_contact *contact);
void barrier_each_contact(const brunt_barrier *b, int64_t task, const double *u, int worker, barrier_take *take,
                          void *context);
barrier_contact barrier_contact_with(const brunt_barrier *b, int32_t point, const barrier_feature *f, const double *u);
// All of them into a list. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_list_contacts(brunt_barrier *b, const brunt_team *team, const double *u, barrier_contacts *list,
                          brunt_error *error);
brunt_energy_sum barrier_sum_energy(brunt_barrier *b, const brunt_team *team, const double *u);

// --- round rims (barrier_arcs.c)
// Makes curves and points of the mesh, whose vertices are at x. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_make_arcs(brunt_barrier *b, const double (*x)[3], brunt_error *error);
// Where their points are as the step begins, and which block nodes move them.
void barrier_place_rims(brunt_barrier *b);
// The curve of a facet; NULL: it is straight.
const barrier_arc *barrier_arc_of(const brunt_barrier *b, int32_t facet);
// Four points that hold the curve between them, by the places x of its vertices; or their displacements, by those.
void barrier_arc_hull(const barrier_arc *arc, const double (*x)[3], double hull[4][3]);
// The facet whose curve a feature is of; BRUNT_NONE: none.
int32_t barrier_arc_met(const brunt_barrier *b, const barrier_feature *f);
// Places, gap and normal of a contact, whose first place is known, with the curve of a facet.
void barrier_meet_arc(const brunt_barrier *b, const barrier_feature *f, int32_t facet, const double *u,
                      barrier_contact *c);

// --- surfaces that may overlap (barrier_overlap.c)
// The gap of a contact with a feature gets its sign: inside the other body it is negative, and n points out of it.
void barrier_sign(const brunt_barrier *b, int32_t point, const barrier_feature *f, const double *u, brunt_closest *at);
// [m] How far a point is certainly outside a body of the pair, beyond what they push each other from: by the nearest
// chord of its rim, within what curves bend from theirs. 0 or less: it may not be.
double barrier_clearance(const brunt_barrier *b, int32_t point, int32_t body, const brunt_barrier_pair *pair,
                         const double *u);
// Of a point's features that it is within, the nearest alone of each law counts, once, if nothing is nearer that it is
// before; none that is beyond the distance.
void barrier_settle_overlaps(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r);
// How much of a way a pair may go that may overlap: the way of the first place along the others [m].
double barrier_overlap_limit(double gap, double reach, double way, double largest);
// Whether a gap is so far below 0 that it is not known which way is out.
static inline bool barrier_is_lost(const barrier_law *law, double gap) { return law->reach > 0 && gap < -law->reach; }

// --- points clear of bodies that they may overlap (barrier_clear.c)
// As a mesh is set.
void barrier_clear_begin(brunt_barrier *b);
// [m] What clearances have lessened by at u, at most.
double barrier_clear_lost(const brunt_barrier *b, const double *u);
// [m] How far points and curves go along each other by p, at most.
double barrier_clear_way(const brunt_barrier *b, const double *p);
// Whether a point is clear of a body at u, by what was kept of it or anew; the first such body is noted.
bool barrier_is_clear_of(const brunt_barrier *b, int32_t point, int32_t body, const double *u, barrier_workspace *r);
// Room for all points. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_clear_reserve(brunt_barrier *b, brunt_error *error);
// Takes over what was noted of a task's point; keeps all of that as what is so at u. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
void barrier_clear_note(brunt_barrier *b, int32_t point, const barrier_workspace *r);
int barrier_clear_keep(brunt_barrier *b, const double *u, int64_t unknowns, brunt_error *error);
void barrier_clear_free(barrier_clear *clear);

// --- corners of those (barrier_corner.c)
// Finds the corners of the mesh, whose vertices are at x. BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_make_corners(brunt_barrier *b, const double (*x)[3], brunt_error *error);
// The vertex of a corner's second face that its first has not.
int32_t barrier_beyond_corner(const brunt_barrier *b, const barrier_corner *corner);
// Where a point is within a corner both faces of that come to its features, in the place of what there is of them.
void barrier_find_corners(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r);
// The contact with such a face.
barrier_contact barrier_contact_within(const brunt_barrier *b, int32_t point, const barrier_feature *f,
                                       const double *u);
// Of a contact within a corner, by its own gap and by that of the other face: of its weight [m], and of what it is
// pushed by over the stiffness of the law [m]; the gradient of the other gap by its places.
typedef struct barrier_within {
    double weight[2], slope[2], other[8];
} barrier_within;
barrier_within barrier_within_of(const brunt_barrier *b, const barrier_contact *c);
// [J] Half of what both faces store; stiffness [Pa/m].
double barrier_within_energy(const brunt_barrier *b, const barrier_contact *c, double stiffness);

// --- one contact (barrier_contact.c)
double barrier_contact_energy(const brunt_barrier *b, const barrier_contact *c);
void barrier_contact_gradient(const brunt_barrier *b, const barrier_contact *c, double *gradient);
void barrier_contact_hessian(const brunt_barrier *b, const barrier_contact *c, bool project, double *hessian);
// [N] with which the features push each other apart; of contacts of negative weight negative.
double barrier_contact_force(const brunt_barrier *b, const barrier_contact *c);
// [N/m] Its gradient by places, `scale` times.
void barrier_contact_force_gradient(const brunt_barrier *b, const barrier_contact *c, double scale, double *gradient);
// Whether a contact that pushes is stiffer for what it moves than `step` [s] follows: then `step` is what does.
bool barrier_contact_is_stiffer(const brunt_barrier *b, const barrier_contact *c, double *step);

// --- friction of one contact (barrier_slip.c)
// How far the features slip along each other by block vector u [m].
void barrier_slip_of(const brunt_barrier *b, const barrier_contact *c, const double *u, double slip[3]);
// What the law says of a slip: part r(|y|) y of the greatest force.
typedef struct barrier_slip {
    double y[3], size; // [m] dt times the velocity of the slip, and its length
    double ratio;      // [1/m] r
    double bend;       // slope of 1 / r by |y|
    double potential;  // f0 [m]
} barrier_slip;
barrier_slip barrier_slip_at(const brunt_barrier *b, const barrier_contact *c, const double *u);
double barrier_slip_rate(const brunt_barrier *b, const barrier_contact *c); // how the slip that counts follows u
// [m] How far the features have come to each other in the step, along where they push now.
double barrier_approach(const brunt_barrier *b, const barrier_contact *c, const double *u);
double barrier_slip_energy(const brunt_barrier *b, const barrier_contact *c, const double *u);
// [N] on the first feature; the other gets the opposite.
void barrier_slip_force(const brunt_barrier *b, const barrier_contact *c, const double *u, double force[3]);
void barrier_slip_gradient(const brunt_barrier *b, const barrier_contact *c, const double *u, double *gradient);
// What there is of a contact that begins to be minimised at u; what it becomes where that goes on to another u.
void barrier_slip_begin(const brunt_barrier *b, const barrier_contact *c, const double *u, barrier_rub *rub);
void barrier_slip_follow(const brunt_barrier *b, const barrier_contact *c, const double *u, barrier_rub *rub);
// The Hessian where `rub` has the force at u, as it has at the minimum and where the slip stays as it is.
void barrier_slip_hessian(const brunt_barrier *b, const barrier_contact *c, const barrier_rub *rub, const double *u,
                          double *hessian);

// The derivative of the force that friction has where normal forces and directions follow u, by places: not symmetric.
// `part`: that of the greatest force, as of `barrier_slip_hessian`.
void barrier_slip_tangent(const brunt_barrier *b, const barrier_contact *c, const double part[3], const double *u,
                          double *tangent);

// --- its potential where surfaces that slip come apart (barrier_cone.c), less that of the barrier alone
double barrier_cone_energy(const brunt_barrier *b, const barrier_contact *c, const double *u);
void barrier_cone_gradient(const brunt_barrier *b, const barrier_contact *c, const double *u, double *gradient);
// With that of the barrier alone it is positive. `part`: that of the greatest force, as of `barrier_slip_hessian`.
void barrier_cone_hessian(const brunt_barrier *b, const barrier_contact *c, const double part[3], const double *u,
                          double *hessian);

// --- one contact, joined (barrier_join.c)
void barrier_join_gradient(const brunt_barrier *b, const barrier_contact *c, double *gradient);
void barrier_join_hessian(const brunt_barrier *b, const barrier_contact *c, double *hessian);

// --- from load step to load step (barrier_memory.c)
// How far the surfaces of a contact had given before the step [m], turned to be along them; 0: nothing is kept. How far
// along the normal that was before it was turned.
double barrier_kept_slip(const brunt_barrier *b, const barrier_contact *c, double slip[3]);

// --- into the unknowns (barrier_sum.c)
void barrier_add_gradient(const brunt_barrier *b, const barrier_contact *c, const double *local, double *g);
int barrier_make_sets(const brunt_barrier *b, const barrier_contacts *contacts, barrier_sets *sets, brunt_error *error);
// What a Hessian is made of: contacts, their sets of nodes, and the colours of those.
typedef struct barrier_assembly {
    const brunt_barrier *b;
    const barrier_contacts *contacts;
    const barrier_sets *sets;
    brunt_colours *colours;
    bool friction;
} barrier_assembly;
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int barrier_add_hessian(const barrier_assembly *a, const brunt_team *team, const double *u, bool project,
                        brunt_block_matrix *m, brunt_error *error);

// --- limit (barrier_limit.c)
double barrier_limit(const brunt_barrier *b, const brunt_team *team, const double *u, const double *p, double largest);
