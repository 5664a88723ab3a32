// What must hold between two steps, part by part.
#include <math.h>

#include "base/error.h"
#include "contact/methods/method.h"
#include "world/world.h"

static void validate_pairs(const brunt_pairs *pairs, int body_count) {
    const brunt_pair_map *map = &pairs->map;
    for (int k = 0; k < 3; k++) BRUNT_ASSERT(map->usual[k] >= -1 && map->usual[k] < pairs->count);
    for (int32_t i = 0; i < map->count; i++) {
        const brunt_pair_entry *e = &map->entry[i];
        BRUNT_ASSERT(e->a >= 0 && e->a <= e->b && e->b < body_count && e->pair >= -1 && e->pair < pairs->count);
        BRUNT_ASSERT(!i || e[-1].a < e->a || (e[-1].a == e->a && e[-1].b < e->b));
    }
}

static void validate_contact(const brunt_contact *contact) {
    BRUNT_ASSERT(contact->rows >> brunt_contact_row_count == 0);
    for (int r = 0; r < brunt_contact_row_count; r++)
        BRUNT_ASSERT(!contact->memory[r] || (contact->rows >> r & 1 && brunt_contact_rows[r]->free));
    brunt_constraints_validate(&contact->constraints);
    if (contact->has_surfaces) brunt_surface_validate(&contact->surface);
}

static void validate_account(const brunt_impulse_account *a) {
    for (int k = 0; k < 3; k++) BRUNT_ASSERT(isfinite(a->impulse[k]) && isfinite(a->angular[k]));
    BRUNT_ASSERT(isfinite(a->external_work) && isfinite(a->normal_loss) && isfinite(a->friction_loss) && a->area >= 0);
}

static void validate_boundaries(const brunt_boundaries *all, const brunt_bodies *bodies) {
    BRUNT_ASSERT(all->wall_count >= 0 && all->walls);
    BRUNT_ASSERT(all->mirror_count >= 0 && all->mirror_count <= BRUNT_MAX_PLANES);
    for (int w = 0; w < all->wall_count; w++) {
        const brunt_boundary *b = &all->walls[w];
        const double *n = b->plane.normal;
        BRUNT_ASSERT(b->kind && b->body >= -1 && b->body < bodies->count);
        BRUNT_ASSERT(b->mirror >= -1 && b->mirror < all->mirror_count);
        BRUNT_ASSERT(b->mirror < 0 || all->mirrors[b->mirror].wall == w);
        BRUNT_ASSERT(!b->kind->is_plane || fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9);
        validate_account(&b->action);
        validate_account(&b->last);
    }
    for (int k = 0; k < all->mirror_count; k++) {
        const brunt_symmetry_plane *mirror = &all->mirrors[k];
        BRUNT_ASSERT(mirror->axis >= 0 && mirror->axis < 3 && mirror->wall >= -1 && mirror->wall < all->wall_count);
        BRUNT_ASSERT(mirror->wall < 0 || all->walls[mirror->wall].mirror == k);
    }
    brunt_node_sets_validate(&all->sets);
    brunt_damping_validate(&all->damping, bodies);
}

static void validate_scratch(const brunt_scratch *scratch, int threads) {
    const brunt_particle_dofs *planes = &scratch->planes;
    BRUNT_ASSERT(scratch->points && scratch->meshes);
    for (int t = 0; t < threads; t++) {
        BRUNT_ASSERT(!scratch->points[t].memory == !scratch->points[t].capacity);
        BRUNT_ASSERT(!scratch->meshes[t].memory == !scratch->meshes[t].capacity);
    }
    BRUNT_ASSERT(!scratch->node_sums == !scratch->node_sums_capacity);
    BRUNT_ASSERT(planes->dof_count >= 0 && (size_t)planes->dof_count <= planes->dof_capacity / sizeof *planes->dof);
    BRUNT_ASSERT(planes->symmetry_count >= 0 && planes->symmetry_count <= BRUNT_MAX_PLANES);
}

void brunt_world_validate(const brunt_world *world) {
    const struct brunt_clock *clock = &world->clock;
    BRUNT_ASSERT(clock->time >= 0 && clock->steps >= 0 && clock->steps == floor(clock->steps));
    BRUNT_ASSERT(world->settings.threads >= 1 && world->settings.threads <= BRUNT_THREAD_LIMIT);
    BRUNT_ASSERT(world->messages.count == 0 || world->messages.text);
    brunt_bodies_validate(&world->bodies);
    validate_boundaries(&world->boundaries, &world->bodies);
    brunt_erosion_validate(&world->erosion);
    validate_pairs(&world->pairs, world->bodies.count);
    validate_contact(&world->contact);
    brunt_ledger_validate(&world->ledger);
    validate_scratch(&world->scratch, world->settings.threads);
    brunt_plan_validate(world);
}
