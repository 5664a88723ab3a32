#include "mpm/particles.h"

#include <string.h>

#include "base/simd.h"
#include "base/memory.h"

void brunt_particles_init(brunt_particles *particles, int dim, int point_dim, const brunt_particle_needs *needs) {
    *particles = (brunt_particles){.dim = dim, .point_dim = point_dim};
    int scalars = 0;
#define ADD_FIELD(name_, unit_, components_, which_, when)                                                             \
    particles->field[BRUNT_FIELD_##name_] =                                                                            \
        (brunt_particle_field){#name_, unit_, scalars, (when) ? components_(which_) : 0, NULL, 0};                     \
    scalars += particles->field[BRUNT_FIELD_##name_].components;
    BRUNT_PARTICLE_FIELDS(ADD_FIELD)
#undef ADD_FIELD
    particles->field_count = BRUNT_BASE_FIELDS;
    for (int m = 0; m < 4; m++) {
        const brunt_model *model = needs->models[m];
        for (int s = 0; model && s < model->state_count; s++) {
            const brunt_state_field *state = &model->state[s];
            int components = point_dim == 3 ? state->components3 : state->components2;
            particles->field[particles->field_count++] =
                (brunt_particle_field){state->name, state->unit, scalars, components, model, s};
            scalars += components;
        }
    }
    particles->scalar_count = scalars;
}

// All arrays lie in one slab. Their distance is 9 cache lines past a multiple of a page: streams read together must not
// fall into the same sets of the cache.
int brunt_particles_reserve(brunt_particles *particles, int64_t slots, brunt_error *error) {
    if (slots <= particles->capacity) return BRUNT_OK;
    int64_t capacity = (slots + slots / 8 + 2 * BRUNT_LANES + 511) / 512 * 512;
    int arrays = particles->scalar_count + BRUNT_SORT_GROUP;
    size_t stride = ((size_t)capacity * sizeof(real) + 4095) / 4096 * 4096 + (size_t)9 * 64;
    size_t wide = (size_t)capacity * sizeof(int64_t);
    size_t bytes = stride * (size_t)arrays + 3 * wide + (size_t)capacity * (sizeof(int32_t) + 1) + 64;
    char *slab = brunt_alloc(bytes);
    if (!slab) return brunt_fail_memory(error, "bytes of particles", bytes, 1);
    char *at = slab;
    for (int k = 0; k < arrays; k++, at += stride) {
        if (k < particles->scalar_count && particles->slots)
            memcpy(at, particles->scalar[k], (size_t)particles->slots * sizeof(real));
        particles->scalar[k] = (real *)at;
    }
    int64_t *ids = (int64_t *)at;
    if (particles->slots) memcpy(ids, particles->id, (size_t)particles->slots * sizeof *ids);
    particles->id = ids;
    particles->spare_id = (int64_t *)(at + wide);
    particles->key = (uint64_t *)(at + 2 * wide);
    particles->order = (int32_t *)(at + 3 * wide);
    particles->bin = (uint8_t *)(at + 3 * wide + (size_t)capacity * sizeof(int32_t));
    brunt_free(particles->slab);
    particles->slab = slab;
    particles->slab_bytes = bytes;
    particles->capacity = capacity;
    return BRUNT_OK;
}

void brunt_particles_free(brunt_particles *particles) {
    brunt_free(particles->slab);
    *particles = (brunt_particles){0};
}

real brunt_plane_volume(brunt_particles *particles, int64_t s) {
    real *const *F = brunt_field(particles, BRUNT_FIELD_deformation_gradient);
    const real volume = brunt_field(particles, BRUNT_FIELD_reference_volume)[0][s];
    const real *x = brunt_field(particles, BRUNT_FIELD_position)[0];
    if (particles->dim == 3)
        return volume *
               (F[0][s] * (F[4][s] * F[8][s] - F[5][s] * F[7][s]) - F[1][s] * (F[3][s] * F[8][s] - F[5][s] * F[6][s]) +
                F[2][s] * (F[3][s] * F[7][s] - F[4][s] * F[6][s]));
    if (brunt_axisymmetric(particles)) // the ring's volume over its circumference; the hoop stretch is r / R
        return volume * F[8][s] * (F[0][s] * F[4][s] - F[1][s] * F[3][s]) / ((real)6.283185307179586 * x[s]);
    return volume * (F[0][s] * F[3][s] - F[1][s] * F[2][s]);
}

real **brunt_state_arrays(brunt_particles *particles, const brunt_model *model, int state) {
    for (int f = BRUNT_BASE_FIELDS; f < particles->field_count; f++)
        if (particles->field[f].model == model && particles->field[f].state == state) return brunt_field(particles, f);
    return NULL;
}
