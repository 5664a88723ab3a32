// Bodies of a definition: material points, finite elements, membranes. brunt_body_def_default fills one first.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include "brunt/mesh.h"
#include "brunt/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum brunt_method {
    BRUNT_MPM,     // material points (Sulsky, Chen and Schreyer 1994)
    BRUNT_FEM,     // linear finite elements of one point
    BRUNT_MEMBRANE // sheets without stiffness in bending, three dimensions
} brunt_method;
// Control of the zero-energy modes of one-point elements (Flanagan and Belytschko 1981), by a spring or a damper.
typedef enum brunt_hourglass { BRUNT_HOURGLASS_STIFFNESS, BRUNT_HOURGLASS_VISCOUS } brunt_hourglass;

// What takes elements or material points out of a body besides failure of its material, and what becomes of their mass.
typedef struct brunt_erosion_def {
    double strain; // [-] > 0: those whose equivalent total strain reaches it go (LS-DYNA's effective strain: sqrt(2/3
                   // e:e) of the deviator of the logarithmic strain); default INFINITY
    double step;   // [s] elements whose stable step falls below it go; default 0
    bool inverted; // those that turn inside out go; default false: an error that stops the run
    bool keep;     // what they were made of stays: nodes that no element has left go on as free particles in contact,
                   // material points as points without stress; default false: mass and momentum leave the world
} brunt_erosion_def;

// Particles on the lattice, or moved off it at random (by `seed`, the same on every machine).
typedef enum brunt_fill { BRUNT_FILL_REGULAR, BRUNT_FILL_JITTERED, BRUNT_FILL_RINGS } brunt_fill;

typedef struct brunt_body_def {
    char name[BRUNT_NAME_LENGTH]; // unique; bodies are ordered by name, so the order in a file changes nothing
    int32_t material;             // index into the world's materials
    brunt_shape shape;            // owned by the definition
    brunt_placement place;        // default: the identity
    brunt_method method;          // default BRUNT_MPM
    // BRUNT_FEM and BRUNT_MEMBRANE: a given mesh, or one made of the shape (of its surface).
    brunt_mesh mesh;              // owned by the definition; node_count 0: made of the shape
    brunt_element_kind element;   // of a mesh made of the shape; default BRUNT_HEX8
    double size;                  // [m] > 0, edge length of a mesh made of the shape; else not used. No default
    brunt_curve grading[3];       // of a box: factor on it along x, y, z, over the coordinate; owned by the definition
    brunt_hourglass hourglass;    // default stiffness
    double hourglass_coefficient; // [-] >= 0; default 0.05 (stiffness) / 0.1 (viscous) as NAN; of lambda + 2 mu, but at
                                  // most of 7 mu
    brunt_erosion_def erosion;
    bool total_lagrangian; // BRUNT_MPM: kernels live in the undeformed configuration: no numerical fracture, however
                           // far it is stretched; contact with meshes and planes only; default false
    double mass_scaling; // [s] >= 0: elements whose stable step is less get density until it is not; 0 (default) = none
    double damping;      // [1/s] >= 0: a force of -damping m v on each node; default 0
    // BRUNT_MEMBRANE
    double thickness;         // [m] > 0, of the undeformed sheet
    double contact_thickness; // [m] >= 0: contact keeps its middle surface half of it from others; NAN (default):
                              // thickness
    bool tension_only;        // carries no compression (tension field) instead of what its material says
    char (*faces)[BRUNT_NAME_LENGTH];
    int32_t face_count; // owned; groups of the shape's boundary to take, 0: all of it
    // Particles sit on a lattice fixed to the unplaced shape's bounding box, then move with the placement.
    int32_t particles_per_cell; // 2D: a square number, 3D: a cube; default 4 / 8
    double spacing;             // [m] >= 0, lattice spacing; 0 (default) = cell / (particles_per_cell)^(1/dimension)
    brunt_fill fill;            // default BRUNT_FILL_REGULAR
    double jitter;              // [-] >= 0 of the spacing (scenes: to 0.5), of BRUNT_FILL_JITTERED; default 0
    uint64_t seed;              // default 1
    double velocity[3];         // [m/s] at the start, as all below; default 0
    double spin[3];             // [rad/s] any: angular velocity about spin_about; of rings 0; default 0
    double spin_about[3];       // [m] any; default 0
    double wave_velocity[3];    // [m/s] added as wave_velocity * sin(wave_vector . x + wave_phase)
    double wave_vector[3], wave_phase; // [1/m], [rad]
    double temperature;                // [K] >= 0, for thermal materials; default 293.15
} brunt_body_def;

// With every default that is given above; what has none is not set.
brunt_body_def brunt_body_def_default(void);

#ifdef __cplusplus
}
#endif
