// Lines and surfaces that hold material points.
#pragma once

#include <stdbool.h>
#include "brunt/boundary_group.h"
#include "brunt/boundary_plane.h"
#include "brunt/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// A line (two dimensions) or a surface (three) that lies anywhere in the grid of material points, and holds what of
// them it reaches. In implicit steps its conditions hold as means over pieces, whose tractions are unknowns of the
// step; in explicit ones for each material point that touches it, and the tractions of pieces are what that has taken.
// It may move as a whole, and turn.
typedef struct brunt_boundary_surface_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "surface1", ...
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all that are of material points
    double (*point)[3];           // [m] corners; owned by the definition
    int32_t point_count;          // >= 2
    int32_t (*facet)[4];       // corners of each part, -1 where it has none: 2 of a line, to whose left its normal is;
                               // 3 or 4 of a surface, that go round its normal; owned by the definition
    int32_t facet_count;       // >= 1
    brunt_condition condition; // stick, slip (in both directions, along the facets' normal) or separate
    double friction;           // [-] >= 0, Coulomb, of separate; default 0
    bool displacement;         // whether `value` is a displacement since the start [m], else a velocity [m/s]
    double value[3];           // times the table; default 0
    brunt_rotation_def rotation; // how it turns beside its displacement, times the table; default 0
    brunt_curve table;           // over time [s]; default 1 always; owned by the definition
    double piece;                // cells > 0, about: length of a piece, of a surface the edge of one; default 1.5
    int32_t particles;           // > 0, a cell's length: boundary particles, by which a piece sees the grid; default 4
    double about[3];             // [m] of the moments that are reported; default 0
    // Explicit steps: a rigid tool that is free, begins with `value` as its velocity and has neither table,
    // displacement nor rotation. In plane strain all is of a thickness of 1 m.
    double mass;       // [kg] >= 0; default 0: its motion is prescribed
    double inertia[3]; // [kg m^2] about axes through `center` along those of the scene, its principal ones, in two
                       // dimensions the third; default 0: it does not turn
    double center[3];  // [m] of mass, at the start; default 0
    double spin[3];    // [rad/s] at the start; default 0
} brunt_boundary_surface_def;

// With every default that is given above; what has none is not set.
brunt_boundary_surface_def brunt_boundary_surface_def_default(void);

#ifdef __cplusplus
}
#endif
