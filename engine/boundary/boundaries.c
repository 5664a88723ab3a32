// What acts on bodies from outside, as a whole: freed, looked over.
#include "boundary/boundaries.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"

void brunt_boundaries_free(brunt_boundaries *all) {
    brunt_load_step_free(&all->sets);
    brunt_node_sets_free(&all->sets);
    brunt_boundary_surfaces_free(&all->surfaces);
    brunt_damping_free(&all->damping);
    brunt_boundary_lists_free(&all->acting);
    brunt_free(all->boundary);
}

void brunt_boundaries_validate(const brunt_boundaries *all, const brunt_bodies *bodies) {
    BRUNT_ASSERT(all->boundary_count >= 0 && all->boundary);
    BRUNT_ASSERT(all->symmetry_count >= 0 && all->symmetry_count <= BRUNT_MAX_PLANES);
    for (int w = 0; w < all->boundary_count; w++) {
        const brunt_boundary *b = &all->boundary[w];
        const double *n = b->plane.normal;
        BRUNT_ASSERT(b->kind && b->body >= -1 && b->body < bodies->count);
        BRUNT_ASSERT(b->symmetry_plane >= -1 && b->symmetry_plane < all->symmetry_count);
        BRUNT_ASSERT(b->symmetry_plane < 0 || all->symmetry[b->symmetry_plane].boundary == w);
        BRUNT_ASSERT(!b->kind->is_plane || fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9);
        brunt_impulse_account_validate(&b->account);
        brunt_impulse_account_validate(&b->last);
    }
    for (int k = 0; k < all->symmetry_count; k++) {
        const brunt_symmetry_plane *symmetry_plane = &all->symmetry[k];
        BRUNT_ASSERT(symmetry_plane->axis >= 0 && symmetry_plane->axis < 3 && symmetry_plane->boundary >= -1 &&
                     symmetry_plane->boundary < all->boundary_count);
        BRUNT_ASSERT(symmetry_plane->boundary < 0 || all->boundary[symmetry_plane->boundary].symmetry_plane == k);
    }
    brunt_boundary_lists_validate(&all->acting, all->boundary, all->boundary_count);
    brunt_node_sets_validate(&all->sets);
    brunt_boundary_surfaces_validate(&all->surfaces, bodies);
    brunt_damping_validate(&all->damping, bodies);
}
