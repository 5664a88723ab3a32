// Groups of nodes of meshes that are held, moved or loaded.
#pragma once

#include <stdbool.h>
#include "brunt/mesh.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

// Nodes of a finite-element body that are held, moved or loaded. Velocity: components of `value` times the table are
// the velocity [m/s]; fixed: value 0. Displacement: they are the displacement since the start [m]. Rotation: the
// displacement since the start is that of a turn by `rotation` times the table. Traction: value [Pa] times the table
// acts on the undeformed area of the group's faces. Pressure: value[0] [Pa] times the table acts against the outward
// normal of the deformed faces. Gas: the pressure of gas that the group's faces enclose, less that outside, acts along
// their normal.
#define BRUNT_GROUP_ACTIONS(X)                                                                                         \
    X(VELOCITY)                                                                                                        \
    X(DISPLACEMENT)                                                                                                    \
    X(ROTATION)                                                                                                        \
    X(TRACTION)                                                                                                        \
    X(PRESSURE)                                                                                                        \
    X(GAS)
#define BRUNT_GROUP_VALUE(name) BRUNT_GROUP_##name,
typedef enum brunt_group_action { BRUNT_GROUP_ACTIONS(BRUNT_GROUP_VALUE) } brunt_group_action;
#undef BRUNT_GROUP_VALUE
// A turn about an axis, right-handed.
typedef struct brunt_rotation_def {
    double angle;             // [rad]
    double axis[3], about[3]; // its direction, in two dimensions +-z, default z; [m] a point of it, default 0
} brunt_rotation_def;
// Ideal gas of one pressure and temperature in an enclosed volume V, the control volume of airbags (Wang and Nefske
// 1988, SAE paper 880654): p = (gamma - 1) E / V, dE = -p dV + inflow dt.
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

// With every default that is given above; what has none is not set.
brunt_group_def brunt_group_def_default(void);

#ifdef __cplusplus
}
#endif
