// The particles of one body: structure of arrays, made from one list of fields.
//
// One array per scalar component. Particles are sorted by grid block and, inside it, by bin. Every block starts at a
// multiple of BRUNT_LANES; what is behind its last particle has no mass, no volume and id -1, and is a copy of it up to
// the next multiple, so that every loop runs over whole vectors. `count` is the number of real particles, `slots` of
// places with gaps, which have room for some that come.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "materials/material.h"
#include "base/real.h"

// name, unit, components as a function of the dimension, which one: that of space or that of the material points, kept
// only when
#define BRUNT_PARTICLE_FIELDS(X)                                                                                       \
    X(position, "m", BRUNT_VECTOR, dim, true)                                                                          \
    X(velocity, "m/s", BRUNT_VECTOR, dim, true)                                                                        \
    X(affine, "1/s", BRUNT_MATRIX, dim, needs->affine) /* C = B D^-1 of APIC (Jiang et al. 2015) */                    \
    X(deformation_gradient, "1", BRUNT_MATRIX, point_dim, true)                                                        \
    X(kirchhoff_stress, "Pa", BRUNT_SYMMETRIC, point_dim, true)                                                        \
    X(mass, "kg", BRUNT_SCALAR, dim, true)                                                                             \
    X(reference_volume, "m^3", BRUNT_SCALAR, dim, true)                                                                \
    X(reach, "m", BRUNT_SCALAR, dim, needs->reach)                   /* distance to the body's surface, undeformed */  \
    X(undeformed_position, "m", BRUNT_VECTOR, dim, needs->total)     /* total Lagrangian: where kernels see it */      \
    X(grid_velocity, "m/s", BRUNT_VECTOR, dim, needs->grid_velocity) /* linear FLIP: what the particle moves with */

#define BRUNT_SCALAR(dim) 1

enum {
#define BRUNT_FIELD_INDEX(name, unit, components, which, when) BRUNT_FIELD_##name,
    BRUNT_PARTICLE_FIELDS(BRUNT_FIELD_INDEX)
#undef BRUNT_FIELD_INDEX
        BRUNT_BASE_FIELDS,
    BRUNT_MAX_FIELDS = BRUNT_BASE_FIELDS + 4 * 8,
    BRUNT_MAX_SCALARS = 96,
    BRUNT_SORT_GROUP = 4 // arrays moved together by the sort, and spare arrays kept for it
};

typedef struct brunt_particle_needs {
    bool affine, reach, grid_velocity, total;
    const brunt_model *models[4]; // strength, viscosity, equation of state, failure; NULL where there is none
} brunt_particle_needs;

typedef struct brunt_particle_field {
    const char *name, *unit;
    int first, components;    // scalars first .. first+components-1; components 0: not kept
    const brunt_model *model; // NULL for base fields
    int state;                // index in the model's state table
} brunt_particle_field;

typedef struct brunt_sort_workspace brunt_sort_workspace;

// Why a particle is to leave its body.
typedef enum brunt_leaving {
    BRUNT_STAYS,
    BRUNT_LEAVES_FAILED,
    BRUNT_LEAVES_STRAINED,
    BRUNT_LEAVES_INVERTED
} brunt_leaving;

typedef struct brunt_particles {
    int dim;       // of space: 2 or 3
    int point_dim; // of the material points; 3 with dim 2: rings about the axis x = 0, whose third direction is the
                   // hoop's. Their masses and volumes are those of the full circle
    int64_t count, slots, capacity;
    int64_t made;         // how many there were at the start: ids are below it
    int64_t sorts, moves; // sorts so far in this process, and those in which all arrays moved
    int64_t moved;        // particles of the blocks that were sorted where they are in the others
    bool holes;           // some have left since the last sort: their slots have id -1, no mass and no volume
    int field_count;
    brunt_particle_field field[BRUNT_MAX_FIELDS];
    int scalar_count;
    real *scalar[BRUNT_MAX_SCALARS + BRUNT_SORT_GROUP]; // the last ones in use are the spare arrays of the sort
    int64_t *id, *spare_id;                             // spare: between sorts a list of slots, of whoever needs one
    uint8_t *bin;                                       // of each slot, inside its block
    int32_t *order; // sort: where each slot's particle was before; between sorts why it is to leave (brunt_leaving)
    uint64_t *key;  // sort: block key of each slot
    void *slab;
    size_t slab_bytes;
    brunt_sort_workspace *sort_workspace; // see sort.c
} brunt_particles;

// Lays out the fields for a body; no particles yet. `point_dim` as in brunt_particles.
void brunt_particles_init(brunt_particles *particles, int dim, int point_dim, const brunt_particle_needs *needs);
// Makes room for `slots`; keeps what is there. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_particles_reserve(brunt_particles *particles, int64_t slots, brunt_error *error);
void brunt_particles_free(brunt_particles *particles);

// Whether the particles are rings.
static inline bool brunt_axisymmetric(const brunt_particles *particles) {
    return particles->point_dim > particles->dim;
}
static inline real **brunt_field(brunt_particles *particles, int field) {
    return particles->scalar + particles->field[field].first;
}
// The place by which particles are sorted and kernels weigh them: the undeformed one of total-Lagrangian bodies, whose
// grids live there.
static inline real *const *brunt_kernel_position(const brunt_particles *particles) {
    bool total = particles->field[BRUNT_FIELD_undeformed_position].components > 0;
    return particles->scalar + particles->field[total ? BRUNT_FIELD_undeformed_position : BRUNT_FIELD_position].first;
}
static inline bool brunt_total_lagrangian(const brunt_particles *particles) {
    return particles->field[BRUNT_FIELD_undeformed_position].components > 0;
}
// Volume that particle `s` stands for in the present configuration [m^3]; in 2D, of rings too, its area in the plane
// [m^2].
real brunt_plane_volume(brunt_particles *particles, int64_t s);
// First scalar of state `state` of `model`, NULL when there is none.
real **brunt_state_arrays(brunt_particles *particles, const brunt_model *model, int state);
