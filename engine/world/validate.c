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

void brunt_world_validate(const brunt_world *world) {
    const struct brunt_clock *clock = &world->clock;
    BRUNT_ASSERT(clock->time >= 0 && clock->steps >= 0 && clock->steps == floor(clock->steps));
    BRUNT_ASSERT(world->settings.threads >= 1 && world->settings.threads <= BRUNT_THREAD_LIMIT);
    BRUNT_ASSERT(world->messages.count == 0 || world->messages.text);
    brunt_bodies_validate(&world->bodies);
    brunt_node_sets_validate(&world->boundaries.sets);
    brunt_erosion_validate(&world->erosion);
    validate_pairs(&world->pairs, world->bodies.count);
    validate_contact(&world->contact);
}
