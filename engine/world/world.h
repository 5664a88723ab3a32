// The inside of a world: bodies, conditions, the plan, the ledgers.
#pragma once

#include "account/erosion.h"
#include "account/ledger.h"
#include "base/messages.h"
#include "body/bodies.h"
#include "body/settings.h"
#include "boundary/boundaries.h"
#include "brunt.h"
#include "mpm/transfers.h"
#include "contact/pairs.h"
#include "world/clock.h"
#include "world/contact.h"
#include "world/plan.h"
#include "world/scratch.h"
#include "world/timing.h"

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
    brunt_timing timing;
};

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
int brunt_surfaces_renew(brunt_contact *contact, brunt_error *error);

// --- erosion.c: elements and material points that leave their bodies, at the end of a step
// Takes out what has failed, is strained, short of step or inside out, and records it. BRUNT_OK, or BRUNT_FAILED with
// the reason.
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
brunt_accounts brunt_accounts_of(const brunt_world *world);

// Largest stable step from the bodies' reports times cfl [s].
double brunt_stable_step(const brunt_world *world);
// A step of explicit steps that is given, at the start: BRUNT_OK, or BRUNT_BAD_INPUT: it is longer than the stable one.
int brunt_check_fixed_step(brunt_world *world, brunt_error *error);
