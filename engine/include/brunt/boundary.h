// What acts on bodies from outside: planes, regions of the grid, groups of mesh nodes, lines and surfaces, gas,
// detonations. The names of planes, regions, groups and surfaces differ.
#pragma once

#include <stdbool.h>
#include "brunt/mesh.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a plane does to nodes and particles, with the words of scenes. Stick: all components follow the plane. Slip: the
// normal component follows it, the tangential ones are free, and it never lets go. Separate: like slip in compression,
// lets go in tension; with friction > 0 a Coulomb wall. Symmetry: mirror plane, axis-aligned and on a grid line.
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
    double velocity[3];           // [m/s] of a moving wall; default 0
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all
} brunt_plane_def;

// Grid nodes inside a region are given a velocity.
typedef struct brunt_region_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "region1", ...
    brunt_shape shape;            // owned by the definition
    brunt_placement place;        // default: the identity
    bool component[3];            // which components are prescribed; default all
    double velocity[3];           // [m/s]
    double start, end;            // [s] active in start <= t < end; default 0, INFINITY
    char body[BRUNT_NAME_LENGTH]; // "" = all
} brunt_region_def;

// Nodes of a finite-element body that are held, moved or loaded.
typedef enum brunt_group_action {
    BRUNT_GROUP_VELOCITY,     // components of `value` times the table are the velocity [m/s]; fixed: value 0
    BRUNT_GROUP_DISPLACEMENT, // ... are the displacement since the start [m]
    BRUNT_GROUP_ROTATION,     // the displacement since the start is that of a turn by `rotation` times the table
    BRUNT_GROUP_TRACTION,     // value [Pa] times the table acts on the undeformed area of the group's faces
    BRUNT_GROUP_PRESSURE,     // value[0] [Pa] times the table acts against the outward normal of the deformed faces
    BRUNT_GROUP_GAS // the pressure of gas that the group's faces enclose, less that outside, acts along their normal
} brunt_group_action;
// A turn about an axis, right-handed.
typedef struct brunt_rotation_def {
    double angle;             // [rad]
    double axis[3], about[3]; // its direction, in two dimensions +-z, default z; [m] a point of it, default 0
} brunt_rotation_def;
// Ideal gas of one pressure and temperature in an enclosed volume V: p = (gamma - 1) E / V, dE = -p dV + inflow dt.
typedef struct brunt_gas_def {
    double gamma;    // [-] > 1, ratio of specific heats; default 1.4
    double pressure; // [Pa] >= 0 at the start, absolute
    double outside;  // [Pa] >= 0, default 0
    double volume;   // [m^3] >= 0 of gas beside what the faces enclose (pipes, a vessel); default 0
    double inflow;   // [W] times the table: enthalpy that flows in; default 0
} brunt_gas_def;
typedef struct brunt_group_def {
    char name[BRUNT_NAME_LENGTH];                           // of its column in the history; "" = "group1", ...
    char body[BRUNT_NAME_LENGTH], group[BRUNT_NAME_LENGTH]; // both must be there
    brunt_group_action action;
    bool component[3];           // velocity, displacement, rotation: which are prescribed; default all
    double value[3];             // [m/s], [m] or [Pa], see the action; default 0
    brunt_curve table;           // over time [s]; default 1 always; owned by the definition
    brunt_rotation_def rotation; // of BRUNT_GROUP_ROTATION
    brunt_gas_def gas;           // of BRUNT_GROUP_GAS
} brunt_group_def;

// A line (two dimensions) or a surface (three) that lies anywhere in the grid of implicit material points, and holds
// what of them it reaches: its conditions hold as means over pieces, whose tractions are unknowns of the step. It may
// move as a whole.
typedef struct brunt_boundary_surface_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "surface1", ...
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all that are of material points
    double (*point)[3];           // [m] corners; owned by the definition
    int32_t point_count;          // >= 2
    int32_t (*facet)[4];          // corners of each part, -1 where it has none: 2 of a line; owned by the definition
    int32_t facet_count;          // >= 1
    brunt_condition condition;    // stick, slip (in both directions, along the facets' normal) or separate
    double friction;              // [-] >= 0, Coulomb, of separate; default 0
    bool displacement;            // whether `value` is a displacement since the start [m], else a velocity [m/s]
    double value[3];              // times the table; default 0
    brunt_curve table;            // over time [s]; default 1 always; owned by the definition
    double piece;                 // cells > 0, about: length of a piece; default 1.5
    int32_t particles;            // > 0, a cell: boundary particles, by which a piece sees the grid; default 4
    double about[3];              // [m] of the moments that are reported; default 0
} brunt_boundary_surface_def;

// Where and when explosives are lit: at a point, or on a plane. Material at distance d burns from time + d / detonation
// speed on.
typedef struct brunt_detonation_def {
    double point[3], normal[3];   // [m]; [-] of a plane, 0: a point
    double time;                  // [s] when it is lit
    char body[BRUNT_NAME_LENGTH]; // "" = all explosives
} brunt_detonation_def;

brunt_plane_def brunt_plane_def_default(void);
brunt_region_def brunt_region_def_default(void);
brunt_group_def brunt_group_def_default(void);
brunt_boundary_surface_def brunt_boundary_surface_def_default(void);

#ifdef __cplusplus
}
#endif
