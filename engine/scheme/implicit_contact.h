// Contact of implicit steps: which surfaces, particles and planes a barrier keeps apart, and what it has done.
#pragma once

#include "contact/barrier/barrier.h"
#include "scheme/unknowns.h"

// Surfaces of all meshes in one numbering, and points of all bodies that meet something.
typedef struct brunt_implicit_contact {
    brunt_barrier *barrier; // NULL: nothing meets
    // Surfaces, by the bodies of elements in their order: made once.
    int32_t vertex_count, facet_count;
    double (*rest)[3], (*position)[3]; // [m] at the start of the run, of the step
    int32_t *body, *node;              // of each vertex: the body among all, its block node
    int32_t (*facet)[4];
    // Points, made for each step.
    bool *has_points; // of each body of points: whether it meets something
    double (*x)[3], *area, *weight;
    int32_t *owner, *point_node, point_count;
    int64_t *first;
    size_t x_capacity, area_capacity, weight_capacity, owner_capacity, point_node_capacity, first_capacity;
    // What bodies are to each other.
    const brunt_pairs *pairs; // of the world: accounts
    bool *met;                // of each body: another meets it, or itself does, by a barrier
    double *young;            // [Pa] of each body
    double *modulus;          // [Pa] of each body, E / (1 - nu^2): with its sides held
    double *half;             // [m] of each body: half its thickness in contact, of membranes; else 0
    double distance;          // [m]
    double overlap_distance;  // [m] of what may overlap, 0 unless the definition says
    double stiffness;         // [Pa] of all; 0: of each pair and plane by what is softer
    double penalty;           // [Pa/m] of all that may overlap; 0: 20 E* / width of each pair and plane
    double width;             // [m] half the length of contacts
    bool seen;                // the width is that of contacts, no longer a guess
    bool opens;               // some gaps stay open
    double reach;             // [m] that surfaces overlap less than, where they may: half the shortest edge; 0: none do
    double slip_speed;        // [m/s]; of load steps the slip length [m]
    // Planes in their order.
    brunt_barrier_plane *plane;
    int32_t *plane_boundary;
    bool **meets;          // of each plane: the bodies it is for
    double *plane_modulus; // [Pa] of each plane: of the softest body that meets it
    int32_t plane_count;
    brunt_barrier_forces forces, forces_before;
    bool tells; // tractions
    brunt_barrier_tractions tractions;
    double *before;       // [m] dt times velocities at the start; of Newmark
    double *inverse_mass; // [1/kg] of nodes, 0: given; of Newmark, until a step was too long
    size_t before_capacity, inverse_mass_capacity;
} brunt_implicit_contact;

// Pairs, planes and surfaces of a world whose bodies are made. BRUNT_OK, or the code of what is wrong.
int brunt_implicit_contact_make(brunt_implicit_contact *c, brunt_world *world, const brunt_world_def *def,
                                brunt_error *error);
void brunt_implicit_contact_free(brunt_implicit_contact *c);
// What bodies a <= b are to each other (brunt_barrier_pair_between), by the brunt_implicit_contact that `self` is.
bool brunt_implicit_contact_pair(const void *self, int32_t a, int32_t b, brunt_barrier_pair *pair);
// Room for the material points that may meet something: `count` of them, with at most `nodes` nodes in all.
int brunt_implicit_contact_reserve(brunt_implicit_contact *c, const brunt_bodies *bodies, int32_t *count,
                                   int64_t *nodes, brunt_error *error);
// Refuses bodies that touch at the start, and warns of those within the distance. `given`: the scene says the distance.
int brunt_implicit_contact_check(brunt_implicit_contact *c, brunt_world *world, const brunt_body_def **order,
                                 bool given, brunt_error *error);
// Aborts where surfaces, pairs and planes are not of what there is: so many bodies, boundaries and pairs of the world.
void brunt_implicit_contact_validate(const brunt_implicit_contact *c, int bodies, int boundaries, int pairs);
// [m] Half the mean length of contacts by their forces, no less than the shortest edge; 0: nothing is in contact. What
// may overlap is as stiff from then on as goes with it, once it is told so; 0: a guess again.
double brunt_implicit_contact_width(const brunt_implicit_contact *c, const brunt_barrier_forces *forces);
void brunt_implicit_contact_widen(brunt_implicit_contact *c, double width);
size_t brunt_implicit_contact_bytes(const brunt_implicit_contact *c);
// Places and weights of a step, whose unknowns have numbers. BRUNT_OK, or BRUNT_FAILED.
int brunt_implicit_contact_points(brunt_implicit_contact *c, const brunt_bodies *bodies, const brunt_unknowns *u,
                                  brunt_error *error);
// How a step is integrated, as far as friction asks.
typedef struct brunt_contact_rule {
    double dt, factor;  // [s]; 1 of backward Euler, 2 of Newmark (contact/barrier/barrier.h)
    const double *rest; // no displacement, of all unknowns
} brunt_contact_rule;
// The step begins. Friction is by what presses at its start.
int brunt_implicit_contact_begin(brunt_implicit_contact *c, const brunt_world *world, const brunt_unknowns *u,
                                 const brunt_team *team, const brunt_contact_rule *rule, brunt_error *error);
