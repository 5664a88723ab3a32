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
    brunt_free(all->walls);
}

void brunt_boundaries_validate(const brunt_boundaries *all, const brunt_bodies *bodies) {
    BRUNT_ASSERT(all->wall_count >= 0 && all->walls);
    BRUNT_ASSERT(all->mirror_count >= 0 && all->mirror_count <= BRUNT_MAX_PLANES);
    for (int w = 0; w < all->wall_count; w++) {
        const brunt_boundary *b = &all->walls[w];
        const double *n = b->plane.normal;
        BRUNT_ASSERT(b->kind && b->body >= -1 && b->body < bodies->count);
        BRUNT_ASSERT(b->mirror >= -1 && b->mirror < all->mirror_count);
        BRUNT_ASSERT(b->mirror < 0 || all->mirrors[b->mirror].wall == w);
        BRUNT_ASSERT(!b->kind->is_plane || fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9);
        brunt_impulse_account_validate(&b->action);
        brunt_impulse_account_validate(&b->last);
    }
    for (int k = 0; k < all->mirror_count; k++) {
        const brunt_symmetry_plane *mirror = &all->mirrors[k];
        BRUNT_ASSERT(mirror->axis >= 0 && mirror->axis < 3 && mirror->wall >= -1 && mirror->wall < all->wall_count);
        BRUNT_ASSERT(mirror->wall < 0 || all->walls[mirror->wall].mirror == k);
    }
    brunt_node_sets_validate(&all->sets);
    brunt_boundary_surfaces_validate(&all->surfaces, bodies);
    brunt_damping_validate(&all->damping, bodies);
}
