// A scheme of time stepping is a table of passes. The plan of a world keeps the rows that are wanted, and the step runs
// those, in their order: what is not in the table does not run.
#pragma once

#include "world/world.h"

// The step that is taken, and what its passes hand on.
typedef struct brunt_step {
    double limit, dt, kick, gravity[3]; // [s], [s], [s], [m/s^2]; kick: what the forces act over
    double old_kinetic, new_kinetic;    // [J] of the grids, before and after what acts on them
    double kinetic;                     // [J] of the particles, after the step
    int status;                         // what failed in a pass that the others of the step still follow
    brunt_body *body;                   // the one it is about in passes that go body by body, else NULL
} brunt_step;

typedef struct brunt_amount {
    double bytes, flops; // for one unit
} brunt_amount;

typedef enum brunt_pass_kind {
    BRUNT_PASS_WHOLE,
    BRUNT_PASS_BODY,  // goes body by body of material points, with those of this kind beside it: all of one, then the
                      // next, while its grid is in the cache
    BRUNT_PASS_PART,  // a further part of the pass of this name, whose time and units it adds to
    BRUNT_PASS_INNER, // runs within the one before it, which tells when
} brunt_pass_kind;

typedef struct brunt_pass_row {
    brunt_pass_kind kind;
    const char *name;
    const char *unit; // what it goes over: "particle", "node", "element", "body"; "point": particles and elements
    bool (*wanted)(const brunt_world *world); // whether the plan keeps it; does not change after the start
    int (*run)(brunt_world *world, brunt_step *step, brunt_error *error); // BRUNT_OK, or the code of a failure
    double (*units)(const brunt_world *world, const brunt_body *body);    // how many it goes over; NULL: none
    // What it moves and computes for a unit of a body, as it is now; NULL: not counted, it depends on what meets what.
    brunt_amount (*work)(const brunt_world *world, brunt_body_ref body);
} brunt_pass_row;

// Defines how many rows the table of a scheme's passes has; no more than a plan has room for.
#define BRUNT_COUNT_PASSES(table, count)                                                                               \
    const int count = sizeof(table) / sizeof *(table);                                                                 \
    _Static_assert(sizeof(table) / sizeof *(table) <= (size_t)BRUNT_PASS_LIMIT, "more passes than a plan has room "    \
                                                                                "for")

// --- explicit.c
extern const brunt_pass_row brunt_explicit_passes[];
extern const int brunt_explicit_pass_count;

int brunt_pass_account(brunt_world *world, brunt_step *step, brunt_error *error);

// --- implicit.c
extern const brunt_pass_row brunt_implicit_passes[];
extern const int brunt_implicit_pass_count;

// --- implicit_world.c, implicit_step.c: steps that minimise an energy
size_t brunt_implicit_bytes(const brunt_world *world);      // of unknowns, fields and terms
size_t brunt_implicit_matrix_bytes(const brunt_plan *plan); // of Newton's matrix, without factors
int brunt_pass_number(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_newton(brunt_world *world, brunt_step *step, brunt_error *error);

// --- particle_passes.c: material points and their grids
int brunt_pass_sort(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_p2g(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_grid(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_symmetry(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_update(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_conditions(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_contact(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_boundaries(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_ledger(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_musl_velocity(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_g2p(brunt_world *world, brunt_step *step, brunt_error *error);

// --- mesh_passes.c: finite-element bodies
int brunt_pass_kick(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_groups(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_finish_kick(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_drift(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_elements(brunt_world *world, brunt_step *step, brunt_error *error);

// --- stable_step.c: how long the step is
// The step that is due and what acts in it. BRUNT_FAILED when there is none to take.
int brunt_pass_choose(brunt_world *world, brunt_step *step, brunt_error *error);
// The greatest speed of planes [m/s].
double brunt_boundary_speed(const brunt_boundaries *set);
// The step that follows stable ones, of this state and of those before.
double brunt_held_step(struct brunt_clock *clock, double stable);
// Gives the bodies the time, gravity to the step, and empties the accounts of the last one.
void brunt_step_open(brunt_world *world, brunt_step *step);
// For what has the stable step that is too short: an element, with the loads on its body, or a body of material points.
int brunt_fail_short(brunt_world *world, double stable, brunt_error *error, const char *why);

// --- watch.c: whether all is as it should be
int brunt_pass_watch(brunt_world *world, brunt_step *step, brunt_error *error);
int brunt_pass_watch_implicit(brunt_world *world, brunt_step *step, brunt_error *error);

// --- fail.c: computations that fail. All give BRUNT_FAILED and say body, place and time in front of the reason.
int brunt_fail_step(const struct brunt_clock *clock, const brunt_body *body, brunt_error *error, const char *reason);
// With the reason that `error` has.
int brunt_fail_inner(const struct brunt_clock *clock, const brunt_body *body, brunt_error *error);
int brunt_fail_particle(const brunt_world *world, brunt_body *body, int64_t slot, brunt_error *error,
                        const char *reason);
// At a place [m] of body `index` (-1: of none).
int brunt_fail_position(const brunt_world *world, int index, const double x[3], brunt_error *error, const char *reason);
int brunt_fail_element(const struct brunt_clock *clock, const brunt_fem_body *fem, int32_t slot, brunt_error *error,
                       const char *reason);
// At the first element or particle without a positive volume. BRUNT_OK: there is none, nothing has been said.
int brunt_fail_turned(const brunt_world *world, brunt_error *error, const char *reason);

// --- work.c: what a pass moves and computes, counted
brunt_amount brunt_work_sort(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_p2g(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_grid(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_update(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_ledger(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_musl_velocity(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_g2p(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_kick(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_drift(const brunt_world *world, brunt_body_ref body);
brunt_amount brunt_work_elements(const brunt_world *world, brunt_body_ref body);
// Mean over all bodies for a unit of the pass; 0: not counted.
brunt_amount brunt_pass_work(const brunt_world *world, const brunt_pass_row *row);
