// What must hold between two steps, part by part.
#include "base/error.h"
#include "world/world.h"

void brunt_world_validate(const brunt_world *world) {
    const brunt_bodies *bodies = &world->bodies;
    brunt_settings_validate(&world->settings);
    brunt_messages_validate(&world->messages);
    brunt_clock_validate(&world->clock);
    brunt_bodies_validate(bodies);
    brunt_boundaries_validate(&world->boundaries, bodies);
    brunt_erosion_validate(&world->erosion);
    brunt_pairs_validate(&world->pairs, bodies->count);
    brunt_contact_validate(&world->contact);
    brunt_ledger_validate(&world->ledger);
    brunt_scratch_validate(&world->scratch, world->settings.threads);
    brunt_transfers_validate(&world->transfers);
    brunt_plan_validate(&world->plan);
    brunt_timing_validate(&world->timing, world->plan.pass_count);
    if (world->plan.implicit)
        brunt_implicit_validate(world->plan.implicit, bodies, &world->boundaries, world->pairs.count);
}
