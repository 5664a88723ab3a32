// Contact of an implicit step: surfaces keep a gap by a barrier, and rub by Coulomb's law with what it was at the last
// update (lagged), so that both are energies that a step can minimise (Li et al. 2020; Li, Kaufman and Jiang 2021 for
// the limit of a step; Li et al. 2022 for material points against meshes).
//
// What meets: points (vertices of the surfaces of meshes, and material points) at facets and planes, and in three
// dimensions edges at edges. All facets within reach count, whichever way they look. Sums have the multiplicities that
// let a point feel a surface once: over a vertex or an edge that facets share, what each of them adds is taken back but
// for one. Nothing here knows of the world: it is made from arrays.
//
// Order: make; mesh (at the start, and when the surface has changed); pairs; step (of every step); then the terms.
// Pairs of bodies are made as their surfaces come near each other: there are as many as bodies that are near.
// `lag` before the first iteration, and whenever friction is to follow. Arrays that are given are read until they are
// given anew. Memory is kept from step to step: none is taken once it suffices.
#pragma once

#include "brunt/result.h"
#include "contact/methods/gap_energy.h"
#include "linear/term.h"

typedef struct brunt_barrier brunt_barrier;

// The surfaces of all meshes in one numbering. In two dimensions z is 0.
typedef struct brunt_barrier_mesh {
    int dim;
    int32_t vertex_count, facet_count;
    const double (*rest)[3]; // [m] of vertices in the reference configuration: areas and lengths of edges are from it
    const int32_t *body;     // of vertices
    // Vertices: 2, -1, -1 (2D: the body is to the left of the way from the first to the second); 3, -1; or 4: a
    // quadrilateral is the two triangles about its shorter diagonal in the reference configuration (the one with the
    // smallest vertex where both are as long).
    const int32_t (*facet)[4];
    bool overlaps; // 2D, some of what meets may: corners are looked for (barrier_corner.c)
    bool round; // 2D, where all that meets may overlap: rims are curves, with points between vertices (barrier_arcs.c)
} brunt_barrier_mesh;

// Two bodies that meet; a body meets itself by a pair (a, a).
typedef struct brunt_barrier_pair {
    int32_t a, b;      // a <= b
    int32_t account;   // what it is known by to whoever gave it
    double distance;   // [m] dhat
    double offset;     // [m] that surfaces stand off: their gap is the distance of features less it
    double stiffness;  // [Pa] kappa
    double friction;   // Coulomb's coefficient; INFINITY: it sticks where it touches
    double slip_speed; // [m/s] eps_v, below which it creeps instead of sticking; > 0 where there is friction
    // What part of the integral over the surface is taken by points of a at facets of b, points of b at facets of a,
    // edges at edges (3D). Of a pair (a, a) the first and third. brunt_barrier_shares has the usual ones.
    double share[3];
    brunt_gap_energy *energy; // NULL: brunt_barrier_at
    double reach;             // [m] 0: gaps stay above 0; else (2D) surfaces may overlap, by less than that
} brunt_barrier_pair;

// Both meshes: 1/2, 1/2, 1/2 (edges add where points are not); b a body of material points: 0, 1, 0; a: 1, 0, 0.
void brunt_barrier_shares(brunt_barrier_pair *pair, bool a_has_facets, bool b_has_facets);

// What bodies a <= b are to each other: false: nothing, and `pair` is left as it is. Asked by several threads at once,
// often, of bodies that are near each other alone; the answer does not change within a step.
typedef bool brunt_barrier_pair_between(const void *self, int32_t a, int32_t b, brunt_barrier_pair *pair);

typedef struct brunt_barrier_pair_source {
    brunt_barrier_pair_between *between;
    const void *self;
    double range;  // [m] at least distance + offset of all pairs, and 2 reach + offset
    bool friction; // some pair may have it
} brunt_barrier_pair_source;

// A half space that points of some bodies stay in front of.
typedef struct brunt_barrier_plane {
    double origin[3], normal[3]; // [m] at the start of the step; of unit length, towards the points
    int32_t node;                // block node whose displacement moves it (held unknowns); -1: it does not move
    const bool *meets;           // of each body; NULL: all
    const double *offset;        // [m] of each body, as of a pair; NULL: none
    double distance, stiffness, friction, slip_speed; // as of a pair; friction 0: slips, INFINITY: sticks
    brunt_gap_energy *energy;                         // as of a pair
    double reach;                                     // as of a pair
} brunt_barrier_plane;

// Material points of all bodies. Nodes that count for point i, with weights: node[first[i]] .. node[first[i + 1] - 1],
// each once.
typedef struct brunt_barrier_particles {
    int32_t count;
    const double (*x)[3]; // [m] at the start of the step
    const double *area;   // [m^2] (2D [m]) that it stands for, brunt_barrier_particle_area; 0: it meets nothing
    const int32_t *body;
    const int64_t *first;
    const int32_t *node; // block nodes
    const double *weight;
} brunt_barrier_particles;

typedef struct brunt_barrier_step {
    const double (*x)[3]; // [m] of vertices at the start of the step
    const int32_t *node;  // their block nodes
    brunt_barrier_particles particles;
    const brunt_barrier_plane *planes;
    int32_t plane_count;
    double dt; // [s]; of load steps 1, slip speeds are the lengths [m] that friction gives by
    // What friction takes for the slip: dt v = factor u + (1 - factor) before, of all unknowns, before = dt v_n [m].
    // Backward Euler and static steps: 1 and NULL; Newmark: 2.
    double factor;
    const double *before;
    const double *inverse_mass; // [1/kg] of block nodes, 0: given; NULL: it is not asked how long steps may be
} brunt_barrier_step;

// The disc or sphere of a volume's greatest section: 2 sqrt(V / pi) [m], pi (3 V / 4 pi)^(2/3) [m^2].
double brunt_barrier_particle_area(int dim, double volume);

brunt_barrier *brunt_barrier_make(brunt_error *error); // NULL: out of memory
void brunt_barrier_free(brunt_barrier *barrier);
// Aborts where surfaces, pairs and what was in contact last do not belong to each other.
void brunt_barrier_validate(const brunt_barrier *barrier);
// BRUNT_OK, or BRUNT_FAILED: out of memory; a facet without area, of two bodies or with one vertex twice.
int brunt_barrier_set_mesh(brunt_barrier *barrier, const brunt_barrier_mesh *mesh, brunt_error *error);
void brunt_barrier_set_pairs(brunt_barrier *barrier, const brunt_barrier_pair_source *source);
// Those that were near each other in this step: `count` of them, new ones behind those that were there.
const brunt_barrier_pair *brunt_barrier_pairs(const brunt_barrier *barrier, int32_t *count);
int brunt_barrier_set_step(brunt_barrier *barrier, const brunt_barrier_step *step, brunt_error *error);
// [m^2] (2D [m]) of the surface in the reference configuration that is a vertex's.
double brunt_barrier_vertex_area(const brunt_barrier *barrier, int32_t vertex);

// What the step minimises: the barrier, and the potential of friction with normal forces and directions of the last
// lag.
brunt_term brunt_barrier_term(brunt_barrier *barrier);
brunt_term brunt_barrier_friction_term(brunt_barrier *barrier);
// Of surfaces that may overlap: those that touch, or overlap, are joined as springs would be, until they are told not
// to be: from the next look on gradient and Hessian are those of both sides of the gap, and across it where there is
// friction. Energy is as ever.
void brunt_barrier_join(brunt_barrier *barrier, bool joined);
// Takes normal forces and directions of friction at u.
int brunt_barrier_lag(brunt_barrier *barrier, const brunt_team *team, const double *u, brunt_error *error);
// Sum of the greatest friction by those, where it has an end [N].
double brunt_barrier_bound(const brunt_barrier *barrier);
// Friction is that of the normal forces and directions at u, wherever it is asked for: it has no potential then, only
// forces, whose derivative is not symmetric. Until it is told to go by the last lag again.
void brunt_barrier_follow(brunt_barrier *barrier, bool live);
// The same, but with a potential: surfaces that slip come apart by the coefficient times the slip, and are given back
// what it is at `from` [m, of all unknowns, which stays where it is]. Where they slip as there, its force is that of
// `follow`. NULL: until here.
void brunt_barrier_associate(brunt_barrier *barrier, const double *from);
// Load steps: from now on friction keeps, from step to step, how far surfaces have given along each other; of vertices
// of meshes at bodies and planes, as the mesh is now. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_barrier_keep_slips(brunt_barrier *barrier, brunt_error *error);
// The step has ended at u: takes what is kept of it, and friction as it is there.
int brunt_barrier_keep(brunt_barrier *barrier, const brunt_team *team, const double *u, brunt_error *error);
// That as numbers, for checkpoints: how many there are now, which steps change in three dimensions, and whether so many
// may be set. BRUNT_OK, or BRUNT_FAILED: out of memory.
int64_t brunt_barrier_kept_count(const brunt_barrier *barrier); // of NULL 0
bool brunt_barrier_kept_fits(const brunt_barrier *barrier, int64_t count);
void brunt_barrier_kept_get(const brunt_barrier *barrier, double *out);
int brunt_barrier_kept_set(brunt_barrier *barrier, const double *in, int64_t count, brunt_error *error);
// [m] of all that is in contact where the barrier was last looked at; INFINITY: nothing is.
double brunt_barrier_least_gap(const brunt_barrier *barrier);
bool brunt_barrier_has_friction(const brunt_barrier *barrier); // some pair or plane has

// ------------------------------------------------------------------------------------------------- what it was

typedef struct brunt_barrier_force {
    // [N] on body a; on b the same with the other sign. Of a plane: on the points. Of a body with itself 0: what its
    // sides do to each other adds up to nothing.
    double normal[3], friction[3];
    double area; // [m^2] (2D [m]) of the surfaces that is nearer than dhat, in the reference
                 // configuration: what points stand for; of two meshes the mean of both
    double heat; // [J] of friction along the way that was given
    int64_t contacts;
} brunt_barrier_force;

// Planes in their order, then the pairs of the step (brunt_barrier_pairs).
typedef struct brunt_barrier_forces {
    brunt_barrier_force *force;
    int32_t count;
    size_t force_capacity;
} brunt_barrier_forces;

// At least `count` of them, new ones 0. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_barrier_forces_extend(brunt_barrier_forces *forces, int32_t count, brunt_error *error);
void brunt_barrier_forces_free(brunt_barrier_forces *forces);

// What Newmark's rule follows by the shortest steps: one contact, with the mass that its gap moves, 1 / sum w^2 / m.
typedef struct brunt_barrier_stiffest {
    double step; // [s] brunt_barrier_longest_step; INFINITY: nothing that moves is in contact, or it is not asked for
    int32_t body, other; // other -1: a plane
    double position[3];  // [m]
} brunt_barrier_stiffest;

typedef struct brunt_barrier_report {
    double least_gap;    // [m] of all that is near; INFINITY: nothing is
    double least_part;   // of its distance dhat; of what may overlap, of its reach: 1 where it begins to push
    int32_t body, other; // that are that near; other -1: a plane
    int32_t point;       // vertex (below vertex_count), point of a round rim or material point (behind); -1: two edges
    int32_t plane;       // -1: none
    double position[3];  // [m] of the point, or on the edge
    bool overlaps;       // what is that near may overlap
    int64_t contacts;    // places with a force
    double energy;       // [J] in the barrier
    brunt_barrier_stiffest stiffest;
} brunt_barrier_report;

// In two dimensions, at u, after brunt_barrier_look_back there: tractions along the rims of meshes, whose vertices were
// at `rest`, by bodies and along them; `boundary` is the number of a plane. BRUNT_OK, or BRUNT_FAILED: out of memory.
typedef struct brunt_barrier_tractions {
    brunt_traction *traction;
    int32_t count;
    size_t traction_capacity;
} brunt_barrier_tractions;
int brunt_barrier_tell(const brunt_barrier *barrier, const double (*rest)[3], const double *u,
                       brunt_barrier_tractions *to, brunt_error *error);
void brunt_barrier_tractions_free(brunt_barrier_tractions *tractions);

// At u, the end of the step; friction there works along the displacements `way` [m]. `forces` NULL: not wanted.
int brunt_barrier_look_back(brunt_barrier *barrier, const brunt_team *team, const double *u, const double *way,
                            brunt_barrier_report *report, brunt_barrier_forces *forces, brunt_error *error);
