// Room that passes work in: made, freed, looked over.
#include "world/scratch.h"

#include "base/array.h"

int brunt_scratch_make(brunt_scratch *scratch, int threads, brunt_error *error) {
    return BRUNT_NEW(scratch->points, threads, "threads with room to work", error)
               ? BRUNT_FAILED
               : BRUNT_NEW(scratch->meshes, threads, "threads with room to work", error);
}

void brunt_scratch_free(brunt_scratch *scratch, int threads) {
    for (int t = 0; t < threads; t++) {
        if (scratch->points) brunt_workspace_free(&scratch->points[t]);
        if (scratch->meshes) brunt_fem_workspace_free(&scratch->meshes[t]);
    }
    brunt_free(scratch->points);
    brunt_free(scratch->meshes);
    brunt_contact_workspace_free(scratch->grid_velocity);
    brunt_point_touches_free(scratch->point_touches);
    brunt_particle_dofs_free(&scratch->planes);
    brunt_free(scratch->node_sums);
    brunt_free(scratch->own_momenta);
}

void brunt_scratch_validate(const brunt_scratch *scratch, int threads) {
    const brunt_particle_dofs *planes = &scratch->planes;
    BRUNT_ASSERT(scratch->points && scratch->meshes);
    for (int t = 0; t < threads; t++) {
        BRUNT_ASSERT(!scratch->points[t].memory == !scratch->points[t].capacity);
        BRUNT_ASSERT(!scratch->meshes[t].memory == !scratch->meshes[t].capacity);
    }
    BRUNT_ASSERT(!scratch->node_sums == !scratch->node_sums_capacity);
    BRUNT_ASSERT(!scratch->own_momenta == !scratch->own_momenta_capacity);
    BRUNT_ASSERT(planes->dof_count >= 0 && (size_t)planes->dof_count <= planes->dof_capacity / sizeof *planes->dof);
    BRUNT_ASSERT(planes->symmetry_count >= 0 && planes->symmetry_count <= BRUNT_MAX_PLANES);
}
