// The inside of a world: bodies, conditions, the plan, the ledgers.
#pragma once

#include "body.h"
#include "brunt.h"
#include "contact.h"
#include "transfer.h"

// The passes of a step, in their order. A pass nobody asked for is not in the plan and does not run.
#define BRUNT_PASSES(X)                                                                                                \
    X(sort, true)                                                                                                      \
    X(scatter, true)                                                                                                   \
    X(grid, true)                                                                                                      \
    X(mirror, world->mirror_count > 0)                                                                                 \
    X(update, true)                                                                                                    \
    X(conditions, world->has_conditions)                                                                               \
    X(contact, world->has_contact)                                                                                     \
    X(walls, world->has_walls)                                                                                         \
    X(ledger, true)                                                                                                    \
    X(remap, world->advance != NULL)                                                                                   \
    X(gather, true)

enum {
#define BRUNT_PASS_INDEX(name, when) BRUNT_PASS_##name,
    BRUNT_PASSES(BRUNT_PASS_INDEX)
#undef BRUNT_PASS_INDEX
        BRUNT_PASS_COUNT
};

typedef struct brunt_node_sums {
    double old_kinetic, new_kinetic, mass, first_moment[3], gravity_work, stress_work;
} brunt_node_sums;

struct brunt_world {
    int dimension, threads;
    brunt_kernel kernel;
    brunt_transfer transfer;
    double flip, cfl, fixed_step, end, energy_limit, gravity[3], gravity_ramp, cell;
    brunt_scatter_fn *scatter;
    brunt_gather_fn *gather, *advance;

    brunt_body *bodies;
    int body_count;
    brunt_wall *walls;
    int wall_count;
    brunt_mirror mirrors[16];
    int mirror_count;
    brunt_pair *pairs;
    int pair_count;
    int32_t *pair_of;
    bool has_conditions, has_contact, has_walls, has_friction, has_gravity;

    brunt_workspace work[256];
    brunt_wall_workspace **wall_work; // a body each
    brunt_contact_workspace *contact_work;
    brunt_node_sums *node_sums;
    size_t node_sums_capacity;

    // Everything a run needs to go on besides the particles, and nothing else: saved as one block of doubles.
    struct brunt_clock {
        double time, steps, dt, next_dt, dt_min, dt_max;
        double kinetic;                // of the particles [J]
        double stress_work; // [J] dt times the stress power at the end of the last step
        double transfer, gravity_work; // [J]
        double gravity_impulse[3], gravity_angular[3];
        double initial_energy, initial_kinetic; // [J]
        double linear_initial[3], angular_initial[3], scale_linear, scale_angular;
        double energy_scale; // [J] the largest energy the run has had to do with
    } now;

    struct brunt_pass_time {
        int64_t calls;
        double seconds, thread_seconds[256];
    } pass[BRUNT_PASS_COUNT];
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

// Acceleration of gravity at a time [m/s^2].
void brunt_gravity_at(const brunt_world *world, double time, double gravity[3]);
// Largest stable step from the bodies' reports times cfl [s].
double brunt_stable_step(const brunt_world *world);
bool brunt_pass_planned(const brunt_world *world, int pass);
