// Regions of the grid of material points with a prescribed velocity.
#pragma once

#include <stdbool.h>
#include "brunt/mesh.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

// Grid nodes inside a region are given a velocity.
typedef struct brunt_region_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "region1", ...
    brunt_shape shape;            // owned by the definition
    brunt_placement place;        // default: the identity
    bool component[3];            // which components are prescribed; default all
    double velocity[3];           // [m/s] any; default 0
    double start, end;            // [s] active in start <= t < end; default 0, INFINITY
    char body[BRUNT_NAME_LENGTH]; // "" = all
} brunt_region_def;

// With every default that is given above; what has none is not set.
brunt_region_def brunt_region_def_default(void);

#ifdef __cplusplus
}
#endif
