// What lines and surfaces ask of an implicit step's unknowns, and the tractions that see to it.
//
// A patch is a piece of a surface before one body (or bodies that are tied), with one row for each of its directions:
//   C u = sum w_b N(x_b) . u over its active boundary particles and the nodes with mass,   D = sum w_b N(x_b)
//   gap = C u - D (way of the surface in the step) [+ D (distance that is left), of what may leave],   along the row
// The condition gap = 0 (stick, slip) or gap >= 0 (separate) is that of an augmented Lagrangian,
//   D/(2 b) (t^2 - l^2),   t = l + b/D gap  (separate: no more than 0; friction: within the cone of the pressure),
// whose gradient is C t: t [Pa] is minus the traction on the body. The multiplier l follows within each step of
// Newton's method, with the factor at hand, until t - l is nothing beside b h: b does not change what comes out.
#pragma once

#include "linear/term.h"
#include "scheme/unknowns.h"

typedef struct brunt_boundary_patch {
    brunt_boundary_surface *surface;
    int32_t piece, body; // body: the first of those that are tied, among bodies of points
    int rows;
    bool leaves, rubs;             // row 0 only pushes; the others have friction
    double size, stiffness;        // D [m^2], b [Pa/m]
    double prescribed[3], goal[3]; // [m^3] D (way of the surface); less the distance that is left: what C u is to be
    double multiplier[3];          // l [Pa]
    double before[3];              // [Pa] of the end of the last step
    double bound;                  // [Pa] most friction
    double before_bound;           // [Pa] ... at the start of the iteration
    double from[3], to[3];         // [Pa] l before the step of Newton's method that is made, and after the whole of it
    bool stiff[2];                 // whether the matrix has row 0, the others
    int row;                       // of its first, among those of all patches
} brunt_boundary_patch;

typedef struct brunt_boundary_rows {
    const brunt_unknowns *unknowns;
    const brunt_bodies *bodies;
    brunt_boundary_surfaces *surfaces;
    brunt_boundary_patch *patch;
    int64_t *first; // patch_count + 1: of its nodes
    int32_t *node;
    double (*weight)[9]; // of each node: its vector in each row, [m^2]
    int64_t version;
    int32_t patch_count;
    int32_t *mark; // of each unknown: its place in the patch under way + 1
    double *gap;   // [m] how far boundary particles are from what reaches them: of each surface and body
    double *here;  // those of the surface and body under way
    brunt_boundary_bounds *bounds; // of each body of points
    double *dense;
    double cell, dt; // [m], [s]
    double known;    // [m/s] of gaps: what the last step of Newton's method may leave of them; 0: they close
    bool still;      // load steps: no inertia
    bool forces;     // there is no energy
    bool exact;      // ... and all tractions follow within Newton's method, each by what it moves (boundary_answer.c)
    int row_count;
    int answer_limit; // rows up to which they do
    double *answer;   // room for that
    int64_t reached;  // boundary particles with a distance
    bool any_leave;   // surfaces that material may leave
    // One that material comes to from where no node of it is, one that it went through, NULL: none.
    const brunt_boundary_surface *unseen, *passed;
    const brunt_boundary_surface *too_far; // turns by too much within the step
    int64_t sweeps;                        // of the run
    int swept;                             // in the iteration under way
    size_t patch_capacity, first_capacity, node_capacity, weight_capacity, mark_capacity, gap_capacity, bounds_capacity,
        dense_capacity, answer_capacity;
} brunt_boundary_rows;

extern const brunt_term_ops brunt_boundary_rows_ops;

void brunt_boundary_rows_free(brunt_boundary_rows *rows);
size_t brunt_boundary_rows_bytes(const brunt_boundary_rows *rows);
// The patches of a step of `dt`, with the multipliers that the surfaces have kept. BRUNT_OK, or BRUNT_FAILED.
int brunt_boundary_rows_step(brunt_boundary_rows *rows, brunt_world *world, const brunt_unknowns *unknowns, double dt,
                             brunt_error *error);
// How far the material points of a body go within the step, all components of each slot [m].
typedef const double *brunt_boundary_ways(void *context, int body);
// Looks for what comes by these ways to surfaces that it may leave. *more: whether there is some that the patches have
// not. BRUNT_OK, or BRUNT_FAILED.
int brunt_boundary_rows_look(brunt_boundary_rows *rows, brunt_world *world, brunt_boundary_ways *ways, void *context,
                             bool *more, brunt_error *error);
// The same patches anew, with what was found. BRUNT_OK, or BRUNT_FAILED.
int brunt_boundary_rows_grow(brunt_boundary_rows *rows, brunt_world *world, brunt_error *error);
// Sum of the sizes of all forces at u [N].
double brunt_boundary_rows_forces(const brunt_boundary_rows *rows, const double *u);
// What it would take to go the way of the step against b alone [N]: rounding leaves some roundings of that.
double brunt_boundary_rows_effort(const brunt_boundary_rows *rows);
// Once u is a minimum: multipliers and bounds of friction as they are there. Whether that changed them.
bool brunt_boundary_rows_settle(brunt_boundary_rows *rows, const double *u);
// t at u [Pa], C u - prescribed [m^3], of a patch.
void brunt_boundary_patch_traction(const brunt_boundary_rows *rows, int32_t patch, const double *u, double t[3],
                                   double moved[3]);
// C u along each row of a patch [m^3]. Adds C t.
void brunt_boundary_patch_rows(const brunt_boundary_rows *rows, int32_t patch, const double *u, double out[3]);
void brunt_boundary_patch_add(const brunt_boundary_rows *rows, int32_t patch, const double t[3], double *g);
// t of what would be without cone or sign, taken to where it may be.
void brunt_boundary_patch_admit(const brunt_boundary_patch *patch, double t[3]);
// --- boundary_answer.c
// Multipliers as they are to be after the step p from u. Adds what that changes of the forces at u to g. BRUNT_OK, or
// BRUNT_FAILED: *worst finds no end, or (BRUNT_NONE) there is no answer of the factor, or no memory.
enum { BRUNT_BOUNDARY_ANSWER_LIMIT = 2048 }; // rows, of a scene; of more the matrix has those that hold, and follows
int brunt_boundary_rows_answer(brunt_boundary_rows *rows, const double *u, const double *p, double *g,
                               const brunt_response *response, int32_t *worst);
// The forces of tractions t on the bodies, on node k of all [N].
void brunt_boundary_patch_force(const brunt_boundary_rows *rows, int32_t patch, int64_t k, const double t[3],
                                double F[3]);
