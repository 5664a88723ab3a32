// Erosion in a world: what has left takes surfaces along.
#include "world/world.h"

static brunt_erosion_step step_of(brunt_world *world, double dt) {
    return (brunt_erosion_step){.bodies = &world->bodies,
                                .sets = &world->boundaries.sets,
                                .ledger = &world->ledger,
                                .workspace = world->scratch.meshes,
                                .dt = dt,
                                .time = world->clock.time,
                                .steps = world->clock.steps,
                                .threads = world->settings.threads,
                                .timer = brunt_pass_timer(&world->timing)};
}

int brunt_erode_marked(brunt_world *world, double dt, brunt_error *error) {
    const brunt_erosion_step step = step_of(world, dt);
    bool any;
    int status = brunt_erosion_take_elements(&world->erosion, &step, &any, error);
    return status || !any ? status : brunt_surfaces_renew(&world->contact, error);
}

int brunt_erode_meshes(brunt_world *world, double dt, brunt_error *error) {
    const brunt_erosion_step step = step_of(world, dt);
    brunt_erosion_mark_elements(&world->erosion, &step);
    return brunt_erode_marked(world, dt, error);
}

void brunt_erode_particles(brunt_world *world) {
    const brunt_erosion_step step = step_of(world, 0);
    brunt_erosion_take_points(&world->erosion, &step);
}

void brunt_body_eroded(const brunt_world *world, int32_t body, brunt_eroded *eroded) {
    *eroded = world->erosion.active ? world->erosion.account[body] : (brunt_eroded){0};
}
