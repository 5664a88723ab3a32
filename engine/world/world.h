// The inside of a world: bodies, conditions, the plan, the ledgers.
#pragma once

#include "account/erosion.h"
#include "account/ledger.h"
#include "base/messages.h"
#include "base/parallel.h"
#include "body/bodies.h"
#include "body/settings.h"
#include "boundary/boundaries.h"
#include "brunt.h"
#include "mpm/transfer.h"
#include "world/clock.h"
#include "world/contact.h"
#include "contact/pairs.h"
#include "world/scratch.h"

// The rows of the scheme's table that the scene calls for, in their order (scheme/scheme.h), and the passes that they
// are parts of, as they are listed: pass_of[i] is that of row[i].
enum { BRUNT_PASS_LIMIT = 32 };
typedef struct brunt_plan {
    const struct brunt_pass_row *row[BRUNT_PASS_LIMIT], *pass[BRUNT_PASS_LIMIT];
    int pass_of[BRUNT_PASS_LIMIT], row_count, pass_count;
    struct brunt_implicit *implicit; // what implicit steps keep, NULL of explicit ones (scheme/implicit.h)
} brunt_plan;

typedef struct brunt_transfers {   // of points to and from their grids, as the scene chose them; NULL: there is none
    brunt_p2g_fn *p2g, *total_p2g; // total: of total-Lagrangian bodies
    brunt_g2p_fn *g2p, *musl_velocity, *total_g2p;
} brunt_transfers;

struct brunt_pass_time {
    int64_t calls;
    double seconds, units; // units: particles, nodes or elements gone over
    brunt_timer threads;
};

struct brunt_timing {
    double seconds;     // [s] of all steps, without what the observer took
    double begin, mark; // [s] of the clock: where the step began (later by what the observer took), and the pass
    int pass;           // that runs; -1: none
    bool observed;
    brunt_observer observer;
};

struct brunt_world {
    brunt_settings settings;
    brunt_bodies bodies;
    brunt_boundaries boundaries;
    brunt_pairs pairs;
    brunt_contact contact;
    brunt_erosion erosion;
    brunt_ledger ledger;
    struct brunt_clock clock;
    brunt_transfers transfers;
    brunt_scratch scratch;
    brunt_messages messages;
    brunt_plan plan;
    struct brunt_pass_time pass[BRUNT_PASS_LIMIT];
    struct brunt_timing timing;
};

// Where the time of parallel phases goes: to the pass that runs. NULL outside a step.
static inline brunt_timer *brunt_pass_timer(brunt_world *world) {
    return world->timing.pass < 0 ? NULL : &world->pass[world->timing.pass].threads;
}

// --- grid_update.c
typedef struct brunt_grid_job {
    brunt_body *body;
    const double *gravity;
    double dt;
    bool has_gravity;
    brunt_node_sums *sums;
} brunt_grid_job;
void brunt_grid_sum(void *job, int64_t begin, int64_t end,
                    int worker); // scatter buffers to nodes: mass, momentum, impulse of all forces
void brunt_grid_update(void *job, int64_t begin, int64_t end, int worker); // momenta to velocities
void brunt_grid_ledger(void *job, int64_t begin, int64_t end, int worker); // node_sums of each slot

// --- mesh_passes.c
// Blocks and runs of nodes of all bodies, as tasks. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_fem_tasks_make(brunt_world *world, brunt_error *error);
// Strain, stress and forces there. The failed body and slot when the update of an element failed.
brunt_fem_body *brunt_fem_elements_all(brunt_world *world, double dt, int32_t *bad, const char **reason);
// Stable step of a body [s] beside what moves at `around` [m/s], by the reports of its blocks and of the loads that
// follow its surface. And least of the meshes.
double brunt_body_step(const brunt_world *world, int body, double around);
double brunt_fem_stable_step(const brunt_world *world);
// The body and slot of the element that has it; NULL without elements, or without memory to look.
brunt_fem_body *brunt_fem_shortest(brunt_world *world, int32_t *slot);

// --- definition.c
// Whether a world can be made of it. BRUNT_OK, or BRUNT_BAD_INPUT and what is wrong.
int brunt_definition_check(const brunt_world_def *def, brunt_error *error);

// --- world.c
// Reports of the blocks that there are, when none has been through a step: with the speeds of their particles. 0, or
// BRUNT_FAILED.
int brunt_reports_make(brunt_world *world, brunt_error *error);

// --- surfaces.c: the meshes' surfaces and what they meet
// What contact is given of a world for a step of `dt`; `timer`: of the pass.
brunt_contact_context brunt_contact_context_of(brunt_world *world, double dt, brunt_timer *timer);
// 0, or BRUNT_FAILED with the reason in `error`.
int brunt_surfaces_meet(brunt_world *world, const double gravity[3], double kick, double dt, brunt_error *error);
int brunt_surfaces_make(brunt_world *world, const brunt_world_def *def, brunt_error *error);
// After the start: refuses bodies that lie in each other, or behind a plane that pushes.
int brunt_surfaces_overlap(brunt_world *world, brunt_error *error);
// The surfaces anew, after elements have left meshes.
int brunt_surfaces_renew(brunt_world *world, brunt_error *error);

// --- erosion.c: elements and material points that leave their bodies, at the end of a step
// Takes out what has failed, is strained, short of step or inside out, and books it. BRUNT_OK, or BRUNT_FAILED with the
// reason.
int brunt_erode_meshes(brunt_world *world, double dt, brunt_error *error);
void brunt_erode_particles(brunt_world *world);
// Of brunt_erode_meshes, the taking out of elements that have a mark, counted in the reports of their blocks.
int brunt_erode_marked(brunt_world *world, double dt, brunt_error *error);

// --- validate.c
// Aborts where a part of the world is not as it must be between two steps.
void brunt_world_validate(const brunt_world *world);
#ifdef NDEBUG
#define BRUNT_VALIDATE(world) ((void)0)
#else
#define BRUNT_VALIDATE(world) brunt_world_validate(world)
#endif

// --- read.c
const brunt_material *brunt_world_material(const brunt_world *world, int body);
brunt_books brunt_books_of(const brunt_world *world);

// Largest stable step from the bodies' reports times cfl [s].
double brunt_stable_step(const brunt_world *world);
// The plan of a world that is made: which rows of its scheme's table run.
void brunt_plan_make(brunt_world *world);
// Aborts where rows, passes and the pass that runs do not belong together.
void brunt_plan_validate(const brunt_world *world);
// What implicit steps keep beside the world, once its bodies are sorted. BRUNT_OK, or the code of what is wrong.
int brunt_implicit_make(brunt_world *world, const brunt_world_def *def, brunt_error *error);
void brunt_implicit_free(brunt_world *world);
// Aborts where unknowns, terms, contact or matrices do not belong to each other and to what there is in the world.
void brunt_implicit_validate(const struct brunt_implicit *implicit, const brunt_bodies *bodies,
                             const brunt_boundaries *boundaries, int pairs);
