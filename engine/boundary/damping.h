// Drag on the nodes of bodies with damping.
#pragma once

#include "body/bodies.h"

typedef struct brunt_damping_sums {
    double work, impulse[3], angular[3]; // [J], [N s], [N m s] of a node task
} brunt_damping_sums;

typedef struct brunt_damping {
    bool active;
    real **drag;              // of each body with damping: node_count x 4 [m/s], velocities before the kick
    brunt_damping_sums *sums; // a node task each
} brunt_damping;
