// Planes that act on bodies.
#pragma once

#include <stdbool.h>
#include "brunt/mesh.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a plane does to nodes and particles, with the words of scenes. Stick: all components follow the plane. Slip: the
// normal component follows it, the tangential ones are free, and it never lets go. Separate: like slip in compression,
// lets go in tension; with friction > 0 it rubs by Coulomb's law. Symmetry: axis-aligned and on a grid line.
#define BRUNT_CONDITIONS(X)                                                                                            \
    X(STICK, "stick")                                                                                                  \
    X(SLIP, "slip")                                                                                                    \
    X(SEPARATE, "separate")                                                                                            \
    X(SYMMETRY, "symmetry")
#define BRUNT_CONDITION_VALUE(name, word) BRUNT_##name,
typedef enum brunt_condition { BRUNT_CONDITIONS(BRUNT_CONDITION_VALUE) } brunt_condition;
#undef BRUNT_CONDITION_VALUE

typedef struct brunt_plane_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "plane1", ...
    double point[3], normal[3];   // [m], [-] pointing into the room the bodies are in
    brunt_condition condition;    // default BRUNT_SEPARATE
    double friction;              // [-] Coulomb coefficient >= 0, for BRUNT_SEPARATE; default 0
    double velocity[3];           // [m/s] of a moving plane; default 0
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all
} brunt_plane_def;

// With every default that is given above; what has none is not set.
brunt_plane_def brunt_plane_def_default(void);

#ifdef __cplusplus
}
#endif
