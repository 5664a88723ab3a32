// What is read of a world: energy and momentum, bodies and their fields, forces, gas. Indices want to be there: 0 <=
// index < count.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include "brunt/world.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brunt_energy { // [J]; in 2D per metre of thickness
    double kinetic;           // with the affine part of APIC; as velocities, of the middle of the last step
    double internal;          // stored
    double mechanical; // kinetic + internal, both at the end of the last step: with what stress does to velocities from
                       // its middle on
    double plastic, hourglass, contact, friction, viscosity, transfer,
        eroded;           // taken out, each by its cause; damping is viscosity;
                          // eroded: kinetic and stored energy that left with elements, nodes and material points;
                          // contact of implicit steps: what barriers have stored, which comes back
    double contact_held;  // of contact: what release will give back, contact.touch elastic; a part, no term of the sum
    double scheme;        // taken out by the integrator of implicit steps: backward Euler damps what is fast
    double heat;          // of plastic: what has warmed the material; a part, no term of the sum
    double external_work; // done on the bodies by gravity, boundaries and prescribed motion
    double initial;       // kinetic + internal at the start
    double total;         // kinetic + internal + all that was taken out
    double error;         // total - initial - external_work
    double reference; // the most by now of: initial; initial + external_work; the work of each cause, summed by amount.
                      // What the run has (kinetic + internal) where that is more, up to ten times it. At least what
                      // rounding does
    double error_relative; // error / reference
} brunt_energy;

typedef struct brunt_momentum {
    double linear[3];  // [kg m/s]
    double angular[3]; // [kg m^2/s] about the origin, with the spin of APIC; 2D: the third component
    double linear_impulse[3], angular_impulse[3]; // external, so far, with what erosion took away (negative)
    double linear_drift, angular_drift;           // relative change since the start, external impulses taken off
    double linear_initial[3], angular_initial[3]; // at the start, as the first two
} brunt_momentum;

// Filled from the state as it stands; sums are the same for any number of threads.
void brunt_world_energy(brunt_world *world, brunt_energy *energy);
void brunt_world_momentum(brunt_world *world, brunt_momentum *momentum);
// Hash of every state bit of every particle, independent of the order they lie in memory.
uint64_t brunt_world_hash(const brunt_world *world);

// Bodies, in order of name.
int32_t brunt_body_count(const brunt_world *world);
const char *brunt_body_name(const brunt_world *world, int32_t body);
const char *brunt_body_material(const brunt_world *world, int32_t body);
brunt_method brunt_body_method(const brunt_world *world, int32_t body);
int64_t brunt_body_particles(const brunt_world *world, int32_t body); // 0 of a finite-element body
int64_t brunt_body_nodes(const brunt_world *world, int32_t body);     // 0 of material points
int64_t brunt_body_elements(const brunt_world *world, int32_t body);
brunt_element_kind brunt_body_element(const brunt_world *world, int32_t body);
// brunt_element_nodes(kind) node numbers of every element, nodes numbered as in the mesh, elements in its order. Of a
// body that erodes, of the elements that are left: the field "element" says which those are. Nodes stay, with those
// that have left.
void brunt_body_connectivity(const brunt_world *world, int32_t body, int32_t *out);
typedef struct brunt_mesh_report {
    brunt_mesh_quality quality;
    double least_step, added_mass; // [s] stable step of its elements; [kg] that mass scaling added
    int32_t scaled_elements;
} brunt_mesh_report;
// How good the mesh of a finite-element body is, and what mass scaling added [kg].
void brunt_body_mesh(const brunt_world *world, int32_t body, brunt_mesh_report *report);
// What decides how long an explicit step is, of the state that there is: stable steps, before time.cfl.
typedef struct brunt_step_limit {
    int32_t body;        // that has the shortest; -1: nothing limits the step, or steps are implicit
    double step;         // [s]
    double without_body; // [s] the shortest of the other bodies; INFINITY: there is none
    int64_t element;     // id of that body's element that has the shortest; -1: it is of material points
    double element_step; // [s] of that alone; with loads that follow the surface `step` is shorter
    int64_t few;         // its shortest elements, one in a hundred ...
    double without_few;  // [s] ... and the shortest of the others; INFINITY: there are none
} brunt_step_limit;
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_world_step_limit(brunt_world *world, brunt_step_limit *limit, brunt_error *error);
typedef struct brunt_body_sums {
    double mass, momentum[3], centre[3], velocity[3]; // [kg], [kg m/s], [m], [m/s] of the centre of mass
    double kinetic, internal, plastic;                // [J]
    double low[3], high[3];                           // [m] bounds of its nodes, or of its particles' centres
} brunt_body_sums;
// Of what is left of body 0 <= `body` < brunt_body_count. Where nothing is: sums and velocity 0, centre NAN,
// low INFINITY and high -INFINITY (third components of two dimensions: bounds 0).
void brunt_body_totals(brunt_world *world, int32_t body, brunt_body_sums *sums);
// Where energy, momentum and totals of many bodies are asked for: sums all of them up once, by all threads, and answers
// from that until it is told to forget. In between the world must not change. The numbers are the same.
void brunt_world_measure(brunt_world *world);
void brunt_world_forget_measure(brunt_world *world);

// What has left a body, or been freed of stress, since the start.
typedef struct brunt_eroded {
    int64_t elements, particles,
        nodes; // eroded elements and material points, nodes that left (or went on free, with `keep`)
    double mass, momentum[3], angular[3],
        energy; // that left the world [kg], [kg m/s], [kg m^2/s] about the origin, [J]
    int64_t failed, strained, short_step, inverted; // elements and points by cause
} brunt_eroded;
void brunt_body_eroded(const brunt_world *world, int32_t body, brunt_eroded *eroded);

// What can be read of a body, at its particles, or at its nodes and its elements: stored and derived fields alike
// ("velocity", "stress" = Cauchy, "pressure", "von_mises", "density", "plastic_strain", "temperature", "J", "volume",
// "id", ...).
typedef enum brunt_location { BRUNT_AT_PARTICLES, BRUNT_AT_NODES, BRUNT_AT_ELEMENTS } brunt_location;
typedef struct brunt_field_info {
    const char *name, *unit;
    int components; // 1, 3, 6 (symmetric) or 9
    bool symmetric;
    brunt_location at;
} brunt_field_info;
int32_t brunt_body_field_count(const brunt_world *world, int32_t body);
brunt_field_info brunt_body_field(const brunt_world *world, int32_t body, int32_t field);
// -1 when the body has no such field.
int32_t brunt_body_find_field(const brunt_world *world, int32_t body, const char *name);
int64_t brunt_body_size(const brunt_world *world, int32_t body, brunt_location at); // particles, nodes or elements
// Writes brunt_body_size(at) x components doubles in the order of the ids (0 .. count-1 within the body). Vectors
// always have 3 components, symmetric tensors 6 (XX YY ZZ XY YZ XZ), matrices 9, whatever the dimension.
void brunt_body_read(brunt_world *world, int32_t body, int32_t field, double *out);

// Contact pairs and boundaries: what they do to `b` / to the bodies. What a body does to itself adds up to nothing: of
// a pair of one body force and impulse are 0. Before the first step all is 0.
typedef struct brunt_reaction {
    char name[2 * BRUNT_NAME_LENGTH + 2];
    double force[3];                   // [N] averaged over the last step
    double impulse[3];                 // [N s] since the start
    double normal_work, friction_work; // [J] so far
    double area; // [m^2] that touched in the last step; in plane strain [m]; of implicit steps what is nearer than
                 // contact.distance
} brunt_reaction;
// Scenes with more than 64 pairs have them all in one, named "all".
int32_t brunt_pair_count(const brunt_world *world);
void brunt_pair_force(const brunt_world *world, int32_t pair, brunt_reaction *force); // name "a-b", force on b
int32_t brunt_boundary_count(const brunt_world *world); // planes, regions, groups, then surfaces
void brunt_boundary_reaction(const brunt_world *world, int32_t boundary, brunt_reaction *force); // force on the bodies
// What a wave takes [s] through an element or a cell of the bodies they act between, of the slowest: how fine in time a
// force is of explicit steps. 0 of implicit ones, which have no waves to resolve.
double brunt_pair_transit(const brunt_world *world, int32_t pair);
double brunt_boundary_transit(const brunt_world *world, int32_t boundary);

// A line or surface that holds material points, as of the last step; tractions, forces and moments are on the bodies.
typedef struct brunt_boundary_surface_report {
    char name[BRUNT_NAME_LENGTH];
    double force[3], moment[3]; // [N], [N m] about the point that its definition gives
    double impulse[3];          // [N s] since the start
    double work;                // [J] that its motion has done on the bodies since the start
    double drift;               // [m/s] >= 0 greatest rate at which a piece's material leaves what holds it
    int32_t pieces, active;     // >= 1; >= 0, those that hold something
    double mass;                // [kg] of a free tool; 0: it is none, and all that follows is 0
    double position[3], velocity[3], spin[3]; // [m], [m/s] of its centre of mass, [rad/s]
    double angular_momentum[3];               // [kg m^2/s] about that
    double kinetic, gravity_work;             // [J], the latter since the start
} brunt_boundary_surface_report;
int32_t brunt_boundary_surface_count(const brunt_world *world); // 0: there are none
// The next three: 0 <= index < brunt_boundary_surface_count, which is not looked at.
void brunt_boundary_surface_read(const brunt_world *world, int32_t index, brunt_boundary_surface_report *report);
int64_t brunt_boundary_surface_size(const brunt_world *world, int32_t index); // boundary particles, >= 1
// Arrays of the caller, with room for that many. Of each boundary particle: place [m], normal, traction of its piece on
// the bodies [Pa], 3 numbers each; its part of the boundary [m^2] (of plane strain [m]); its piece.
typedef struct brunt_boundary_surface_arrays {
    double *position, *normal, *traction, *weight;
    int64_t *piece;
} brunt_boundary_surface_arrays;
void brunt_boundary_surface_particles(const brunt_world *world, int32_t index,
                                      const brunt_boundary_surface_arrays *out);

// What Newton's method has done in implicit steps, steps that were cut included. Numbers of times are whole and >= 0; 0
// before the first step, as the residual, and the least of gaps INFINITY.
typedef struct brunt_newton_counts {
    double steps, iterations, iterations_worst; // worst: of one step
    double halvings;                            // of a Newton step, in its line search
    double projections;                         // matrices without their negative eigenvalues
    double linear_iterations, factorisations;
    double cuts;      // steps that were taken anew, half as long
    double residual;  // [m/s] greatest last correction of a step; static: [-] greatest share of forces left unbalanced;
                      // of steps that were taken, not of those that were given up
    double least_gap; // [m] at the end of a step; INFINITY: nothing has been near
    double least_part; // [-] of the distance at which surfaces know of each other, likewise
} brunt_newton_counts;
// So far, and of the last step (NULL: not wanted). False in explicit schemes, where all numbers are 0.
bool brunt_world_newton(const brunt_world *world, brunt_newton_counts *so_far, brunt_newton_counts *last);
// Whether its steps are load steps, whose residuals have no unit.
bool brunt_world_static(const brunt_world *world);
// The systems that implicit steps solve, as they are at the start.
typedef struct brunt_newton_systems {
    int64_t unknowns;   // components of displacements
    double courant;     // [-] greatest way of waves in a step, over edges and cells; INFINITY: static
    const char *solver; // "direct", "pcg", "matrix-free", "unsymmetric"
    const char *why;    // a sentence
    double tolerance;   // [m/s] of a correction; static: [-] of forces
    double bytes;       // that terms and fields take beside the bodies
} brunt_newton_systems;
bool brunt_world_newton_systems(const brunt_world *world, brunt_newton_systems *systems); // false: explicit
// Contact of implicit steps, as given or by default.
typedef struct brunt_barrier_values {
    double distance;          // [m]
    double stiffness[2];      // [Pa] least and greatest of pairs and planes; 0: no gap stays open
    double penalty[2], width; // [Pa/m] the same of what may overlap, INFINITY, 0: nothing may; [m] they go by, 0: given
    bool seen;                // the width is that of contacts; else it is a guess
    double slip_speed, slowest_wave; // [m/s]; slip_speed 0: nothing rubs
    double slip_length;              // [m] of load steps, in place of slip_speed
} brunt_barrier_values;
bool brunt_world_barrier(const brunt_world *world, brunt_barrier_values *values); // false: no barrier

// Two bodies that are near each other, of implicit and static steps with a barrier, as the last step has left them:
// what pushes and rubs body a, and b the other way. In two dimensions [N/m].
typedef struct brunt_link {
    int32_t a, b;
    double force[3], normal, friction; // [N] both; their sizes
    double share;                      // [-] friction of Coulomb's bound; 0 where there is none
} brunt_link;
bool brunt_world_links(const brunt_world *world, int32_t *count);     // false: no barrier
brunt_link brunt_world_link(const brunt_world *world, int32_t index); // 0 <= index < count
// Of the links with a force: how many, the mean of the normal forces, its standard deviation, the greatest [N]; those
// that have come to 0.99 of their bound.
typedef struct brunt_link_sums {
    double count, mean, sd, greatest, slipping;
} brunt_link_sums;
void brunt_world_link_sums(const brunt_world *world, brunt_link_sums *sums);

// In two dimensions, with a barrier: what a node of a mesh has from another body or a boundary, as the last step has
// left it, from when it has been asked to tell.
typedef struct brunt_traction {
    int32_t body, other, boundary; // numbers; other below 0: a boundary, else boundary below 0
    double along;                  // [m] the rim at the start, the body to the left, from its node of the least number
    double position[3];            // [m]
    double normal, tangential;     // [Pa] of pressure; along the rim
} brunt_traction;
int brunt_world_tell_tractions(brunt_world *world, brunt_error *error); // of the steps to come; not in space: BAD_INPUT
const brunt_traction *brunt_world_tractions(const brunt_world *world, int32_t *count); // until the next step

// Of the last load step: what the forces on bodies leave unbalanced, the sizes of sums over those on their nodes, of
// contact, loads and reactions: of the body that balances least, and of all together.
typedef struct brunt_balance {
    double body, all; // [-]; 0 before the first step of a run
    int32_t worst;    // which body; -1: none
} brunt_balance;
bool brunt_world_balance(const brunt_world *world, brunt_balance *balance); // false: no load steps

// Gas in enclosed volumes.
typedef struct brunt_gas {
    char name[BRUNT_NAME_LENGTH];    // of its boundary
    double volume, pressure, energy; // [m^3], [Pa] absolute, [J]
    double inflow;                   // [J] so far
} brunt_gas;
int32_t brunt_gas_count(const brunt_world *world); // 0: there is none
void brunt_world_gas(const brunt_world *world, int32_t index, brunt_gas *gas);

#ifdef __cplusplus
}
#endif
