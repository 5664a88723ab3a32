// The particles of one body: structure of arrays, made from one list of fields.
//
// One array per scalar component. Particles are sorted by grid block and, inside it, by bin. Every block starts at a
// multiple of BRUNT_LANES; the gap behind its last particle is filled with copies of it that have no mass, no volume
// and id -1, so that every loop runs over whole vectors. `count` is the number of real particles, `slots` of places
// with gaps.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "material.h"
#include "real.h"

// name, unit, components as a function of the dimension, kept only when
#define BRUNT_PARTICLE_FIELDS(X)                                                                                       \
    X(position, "m", BRUNT_VECTOR, true)                                                                               \
    X(velocity, "m/s", BRUNT_VECTOR, true)                                                                             \
    X(affine, "1/s", BRUNT_MATRIX, needs->affine) /* C = B D^-1 of APIC (Jiang et al. 2015) */                         \
    X(deformation_gradient, "1", BRUNT_MATRIX, true)                                                                   \
    X(kirchhoff_stress, "Pa", BRUNT_SYMMETRIC, true)                                                                   \
    X(mass, "kg", BRUNT_SCALAR, true)                                                                                  \
    X(reference_volume, "m^3", BRUNT_SCALAR, true)                                                                     \
    X(reach, "m", BRUNT_SCALAR, needs->reach)                   /* distance to the body's surface, undeformed */       \
    X(grid_velocity, "m/s", BRUNT_VECTOR, needs->grid_velocity) /* linear FLIP: what the particle moves with */

#define BRUNT_SCALAR(dim) 1

enum {
#define BRUNT_FIELD_INDEX(name, unit, components, when) BRUNT_FIELD_##name,
    BRUNT_PARTICLE_FIELDS(BRUNT_FIELD_INDEX)
#undef BRUNT_FIELD_INDEX
        BRUNT_BASE_FIELDS,
    BRUNT_MAX_FIELDS = BRUNT_BASE_FIELDS + 3 * 8,
    BRUNT_MAX_SCALARS = 96,
    BRUNT_SORT_GROUP = 4 // arrays moved together by the sort, and spare arrays kept for it
};

typedef struct brunt_particle_needs {
    bool affine, reach, grid_velocity;
    const brunt_model *models[3]; // strength, viscosity, equation of state; NULL where there is none
} brunt_particle_needs;

typedef struct brunt_particle_field {
    const char *name, *unit;
    int first, components;    // scalars first .. first+components-1; components 0: not kept
    const brunt_model *model; // NULL for base fields
    int state;                // index in the model's state table
} brunt_particle_field;

typedef struct brunt_sort_room brunt_sort_room;

typedef struct brunt_particles {
    int dim;
    int64_t count, slots, capacity;
    int field_count;
    brunt_particle_field field[BRUNT_MAX_FIELDS];
    int scalar_count;
    real *scalar[BRUNT_MAX_SCALARS + BRUNT_SORT_GROUP]; // the last ones in use are the spare arrays of the sort
    int64_t *id, *spare_id;
    uint8_t *bin;   // of each slot, inside its block
    int32_t *order; // sort: where each slot's particle was before
    uint64_t *key;  // sort: block key of each slot
    void *slab;
    size_t slab_bytes;
    brunt_sort_room *sort_room; // see sort.c
} brunt_particles;

// Lays out the fields for a body; no particles yet.
void brunt_particles_init(brunt_particles *particles, int dim, const brunt_particle_needs *needs);
// Makes room for `slots`; keeps what is there. 0, or -1: out of memory.
int brunt_particles_reserve(brunt_particles *particles, int64_t slots);
void brunt_particles_free(brunt_particles *particles);

static inline real **brunt_field(brunt_particles *particles, int field) {
    return particles->scalar + particles->field[field].first;
}
// First scalar of state `state` of `model`, NULL when there is none.
real **brunt_state_arrays(brunt_particles *particles, const brunt_model *model, int state);
