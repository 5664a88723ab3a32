// A body of material points: its particles, its grid, its material with the constants prepared.
#pragma once

#include "brunt.h"
#include "grid/grid.h"
#include "mpm/particles.h"
#include "materials/prepared.h"

// What a block reports of a step; summed or compared over the blocks in their order.
typedef struct brunt_block_report {
    double kinetic;      // [J]
    double stress_power; // [W] new stress times velocity gradient, over the particles
    double musl_power;   // [W] linear kernel: old stress times what the velocities' second way to the grid does to the
                         // gradient
    double old_power;    // [W] where the step changes: old stress times the grid's new velocity gradient; else 0
    real speed, wave_speed;  // [m/s] greatest
    bool failed;             // the material of one has failed
    int32_t turned, leaving; // of bodies that erode: how many would have turned inside out; how many are to leave
    int32_t bad;             // slot of a particle whose update failed, -1
    const char *reason;
} brunt_block_report;

typedef struct brunt_body {
    bool uneven; // of this step: forces act over another time than bodies move
    real speed;  // [m/s] of its fastest particle after the last step; reports are of the blocks that there were then
    char name[BRUNT_NAME_LENGTH];
    int index;
    brunt_material material;
    brunt_particles particles;
    brunt_grid grid;
    brunt_block_report *report;
    size_t report_capacity; // a block each
    double spacing;         // [m] of the undeformed lattice
    real time;              // [s] at the end of the step, for materials that burn
    real particle_mass;     // [kg]; of rings per metre of their radius [kg/m]
    bool spread_told;       // that its particles no longer cover every cell

    // Of bodies that erode, else false and NULL.
    bool erodes, fails;   // particles may leave; they do when their material has failed
    bool erodes_inverted; // a particle that would turn inside out keeps its deformation gradient, and is marked
    bool keeps;           // what leaves stays as mass: particles of volume 0, without stress, whose F stands still
    int32_t *rank;        // of each id there was at the start: its place among those alive (made by readers)
} brunt_body;

void brunt_body_free(brunt_body *body);
// --- validate.c: aborts where particles, blocks and bins do not belong together. Every step in debug builds.
void brunt_body_validate(brunt_body *body);

// p2g_triangles.c: marks the nodes at which particles have a weight or a slope, by their numbers; of cells that are cut
// in two not the one across the diagonal.
void brunt_body_mark_reached(const brunt_body *body, uint8_t *mark);

// Views particles `first` .. `first + count - 1` (count a multiple of BRUNT_LANES) as the points of a component.
brunt_material_points brunt_body_points(brunt_body *body, brunt_component component, int64_t first, int32_t count);
// Stored and dissipated energy of the particles of blocks [begin, end) [J].
brunt_point_energy brunt_body_energy(brunt_body *body, int32_t begin, int32_t end);
// Bounds of the particles of block b [m]; of total-Lagrangian bodies they are not where the block is.
void brunt_body_block_bounds(const brunt_body *body, int32_t b, double low[3], double high[3]);
// How many cells wide what a particle stands for has become at most: (J V0)^(1/dim) / h.
double brunt_body_spread(brunt_body *body);
