// Drag on the nodes of bodies with damping.
#pragma once

#include "base/parallel.h"
#include "body/bodies.h"

typedef struct brunt_damping_sums {
    double loss, impulse[3], angular[3]; // [J] it took, [N s], [N m s] it gave
} brunt_damping_sums;

typedef struct brunt_damping {
    bool active;
    int fem_count;
    real **drag;              // of each body with damping: node_count x 4 [m/s], velocities before the kick
    brunt_damping_sums *sums; // a node task each
} brunt_damping;

// After the node tasks are made.
int brunt_damping_make(brunt_damping *damping, const brunt_bodies *bodies, brunt_error *error);
// Aborts where bodies with damping and their arrays do not belong together.
void brunt_damping_validate(const brunt_damping *damping, const brunt_bodies *bodies);
void brunt_damping_free(brunt_damping *damping);
// A kick of the meshes: over `dt`, by so many threads.
typedef struct brunt_kick {
    double dt, gravity[3]; // [s], [m/s^2]
    int threads;
    brunt_timer *timer;
} brunt_kick;
// Adds the drag to the loads of this step; what it did is added to `done` once velocities are final.
void brunt_damping_begin(const brunt_damping *damping, const brunt_bodies *bodies, const brunt_kick *kick);
void brunt_damping_end(const brunt_damping *damping, const brunt_bodies *bodies, const brunt_kick *kick,
                       brunt_damping_sums *done);
