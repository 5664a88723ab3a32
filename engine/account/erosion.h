// What has left bodies, and what lets it.
#pragma once

#include "brunt.h"

struct brunt_erosion_work;

typedef struct brunt_erosion {
    bool active;                     // elements or material points may leave their bodies
    brunt_eroded *account;           // of each body; NULL without erosion. Saved with the state
    brunt_erosion_def *rule;         // of each body; NULL without erosion
    struct brunt_erosion_work *work; // of meshes that erode; NULL without erosion
} brunt_erosion;
