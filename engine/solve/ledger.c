// Energy and momentum of a world, and what is known of bodies, pairs and walls.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "world.h"

void brunt_world_energy(brunt_world *world, brunt_energy *energy) {
    const struct brunt_clock *now = &world->now;
    // Velocities are half a step behind the stress: what it does to them in that half step is booked with the transfer.
    *energy = (brunt_energy){.kinetic = now->kinetic,
                             .initial = now->initial_energy,
                             .transfer = now->transfer - 0.5 * now->stress_work,
                             .external_work = now->gravity_work};
    for (int i = 0; i < world->body_count; i++) {
        brunt_point_energy e = brunt_body_energy(&world->bodies[i]);
        energy->internal += e.internal;
        energy->plastic += e.plastic;
        energy->viscosity += e.viscosity;
    }
    for (int w = 0; w < world->wall_count; w++) {
        energy->contact += world->walls[w].action.normal_loss;
        energy->friction += world->walls[w].action.friction_loss;
        energy->external_work += world->walls[w].action.external_work;
    }
    for (int p = 0; p < world->pair_count; p++) {
        energy->contact += world->pairs[p].action.normal_loss;
        energy->friction += world->pairs[p].action.friction_loss;
    }
    energy->total = energy->kinetic + energy->internal + energy->plastic + energy->hourglass + energy->contact +
                    energy->friction + energy->viscosity + energy->transfer + energy->eroded;
    energy->error = energy->total - energy->initial - energy->external_work;
    double scale = fmax(fmax(fabs(energy->initial), fabs(energy->initial + energy->external_work)),
                        energy->kinetic + fabs(energy->internal));
    energy->error_relative = scale > 0 ? energy->error / scale : 0;
}

void brunt_world_momentum(brunt_world *world, brunt_momentum *momentum) {
    const struct brunt_clock *now = &world->now;
    memset(momentum, 0, sizeof *momentum);
    double linear_scale = now->scale_linear, angular_scale = now->scale_angular, linear_here = 0, angular_here = 0;
    for (int i = 0; i < world->body_count; i++) {
        brunt_audit a = brunt_body_audit(&world->bodies[i]);
        for (int k = 0; k < 3; k++) momentum->linear[k] += a.linear[k], momentum->angular[k] += a.angular[k];
        linear_here += a.scale_linear;
        angular_here += a.scale_angular;
    }
    // Impulses that cancel, such as weight and support, still set the scale of what rounding may do.
    double linear = 0, angular = 0, impulse = 0, turn = 0;
    for (int k = 0; k < 3; k++) {
        momentum->linear_initial[k] = now->linear_initial[k];
        momentum->angular_initial[k] = now->angular_initial[k];
        momentum->linear_impulse[k] = now->gravity_impulse[k];
        momentum->angular_impulse[k] = now->gravity_angular[k];
        impulse += fabs(now->gravity_impulse[k]);
        turn += fabs(now->gravity_angular[k]);
        for (int w = 0; w < world->wall_count; w++) {
            const brunt_action *action = &world->walls[w].action;
            momentum->linear_impulse[k] += action->impulse[k];
            momentum->angular_impulse[k] += action->angular[k];
            impulse += fabs(action->impulse[k]);
            turn += fabs(action->angular[k]);
        }
        double d = momentum->linear[k] - momentum->linear_initial[k] - momentum->linear_impulse[k];
        double e = momentum->angular[k] - momentum->angular_initial[k] - momentum->angular_impulse[k];
        linear += d * d, angular += e * e;
    }
    linear_scale = fmax(fmax(linear_scale, linear_here), impulse);
    angular_scale = fmax(fmax(angular_scale, angular_here), turn);
    momentum->linear_drift = linear_scale > 0 ? sqrt(linear) / linear_scale : 0;
    momentum->angular_drift = angular_scale > 0 ? sqrt(angular) / angular_scale : 0;
}

void brunt_body_totals(brunt_world *world, int32_t index, brunt_body_sums *sums) {
    brunt_audit a = brunt_body_audit(&world->bodies[index]);
    brunt_point_energy e = brunt_body_energy(&world->bodies[index]);
    *sums = (brunt_body_sums){.mass = a.mass, .kinetic = a.kinetic, .internal = e.internal, .plastic = e.plastic};
    for (int k = 0; k < 3; k++) {
        sums->momentum[k] = a.linear[k];
        sums->centre[k] = a.centre[k];
        sums->velocity[k] = a.mass > 0 ? a.linear[k] / a.mass : 0;
    }
}

static void fill_force(const brunt_action *last, const brunt_action *all, double dt, brunt_force *force) {
    for (int k = 0; k < 3; k++) {
        force->force[k] = dt > 0 ? last->impulse[k] / dt : 0;
        force->impulse[k] = all->impulse[k];
    }
    force->normal_work = all->normal_loss;
    force->friction_work = all->friction_loss;
}

int32_t brunt_pair_count(const brunt_world *world) { return world->pair_count; }
void brunt_pair_force(const brunt_world *world, int32_t index, brunt_force *force) {
    const brunt_pair *pair = &world->pairs[index];
    snprintf(force->name, sizeof force->name, "%s-%s", world->bodies[pair->a].name, world->bodies[pair->b].name);
    fill_force(&pair->last, &pair->action, world->now.dt, force);
}
int32_t brunt_wall_count(const brunt_world *world) { return world->wall_count; }
void brunt_wall_force(const brunt_world *world, int32_t index, brunt_force *force) {
    const brunt_wall *wall = &world->walls[index];
    snprintf(force->name, sizeof force->name, "%s", wall->name);
    fill_force(&wall->last, &wall->action, world->now.dt, force);
}

double brunt_world_time(const brunt_world *world) { return world->now.time; }
double brunt_world_end(const brunt_world *world) { return world->end; }
int64_t brunt_world_steps(const brunt_world *world) { return (int64_t)world->now.steps; }
double brunt_world_dt(const brunt_world *world) { return world->now.dt; }
double brunt_world_dt_min(const brunt_world *world) { return world->now.steps > 0 ? world->now.dt_min : world->now.dt; }
double brunt_world_dt_max(const brunt_world *world) { return world->now.steps > 0 ? world->now.dt_max : world->now.dt; }
int brunt_world_dimension(const brunt_world *world) { return world->dimension; }
int brunt_world_threads(const brunt_world *world) { return world->threads; }
int64_t brunt_world_particles(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->body_count; i++) n += world->bodies[i].particles.count;
    return n;
}
int64_t brunt_world_nodes(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->body_count; i++) n += (int64_t)world->bodies[i].grid.slot_count * BRUNT_BLOCK_NODES;
    return n;
}
int32_t brunt_body_count(const brunt_world *world) { return world->body_count; }
const char *brunt_body_name(const brunt_world *world, int32_t body) { return world->bodies[body].name; }
const char *brunt_body_material(const brunt_world *world, int32_t body) { return world->bodies[body].material.name; }
int64_t brunt_body_particles(const brunt_world *world, int32_t body) { return world->bodies[body].particles.count; }
