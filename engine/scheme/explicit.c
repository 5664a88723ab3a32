// The explicit step.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/simd.h"
#include "base/array.h"
#include "mpm/sort.h"
#include "base/parallel.h"
#include "world/world.h"

enum { SLOT_GRAIN = 8, BLOCK_GRAIN = 2, ENERGY_CHECK = 32, SPREAD_CHECK = 32 };

void brunt_gravity_at(const brunt_world *world, double time, double gravity[3]) {
    double share = world->settings.gravity_ramp > 0 && time < world->settings.gravity_ramp
                       ? time / world->settings.gravity_ramp
                       : 1;
    for (int a = 0; a < 3; a++) gravity[a] = a < world->settings.dimension ? share * world->settings.gravity[a] : 0;
}

double brunt_stable_step(const brunt_world *world) {
    double inverse = 0, wall_speed = 0;
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        const double *v = world->boundaries.walls[w].region ? world->boundaries.walls[w].where.velocity
                                                            : world->boundaries.walls[w].plane.velocity;
        wall_speed = fmax(wall_speed, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    // Greatest over the whole body, so that the step does not depend on how blocks cut it.
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_body *body = &world->bodies.mpm[i];
        double wave = 0, speed = wall_speed;
        for (int32_t b = 0; b < body->grid.block_count; b++) {
            wave = fmax(wave, (double)body->report[b].wave_speed);
            speed = fmax(speed, (double)body->report[b].speed);
            if (isnan(body->report[b].wave_speed) || isnan(body->report[b].speed)) return NAN;
        }
        inverse = fmax(inverse, wave + speed);
    }
    double grid = inverse > 0 ? world->settings.cell / inverse : INFINITY,
           least = fmin(grid, brunt_fem_stable_step(world));
    if (isinf(least)) { // all has eroded: steps as of what there was
        for (int i = 0; i < world->bodies.mpm_count; i++)
            least = fmin(least, world->settings.cell / (double)world->bodies.mpm[i].material.wave_speed);
        for (int k = 0; k < world->bodies.fem_count; k++) least = fmin(least, world->bodies.fem[k].least_step);
    }
    return world->settings.cfl * least;
}

// The step that follows stable ones, of this state and of those before. A mesh that swings has a stable step that
// swings with it, and a step that follows it pumps: central differences gain energy by steps that vary (choose_step) at
// a share of the limit where equal ones gain none. Of one oscillator, omega = omega_0 (1 + a sin(omega t)), that is a
// share of order a (omega dt)^2 in each period. So a step is that of the stiffest shape of the last 128 to 256 steps:
// steps are equal over all periods that are shorter, and of those that are longer (omega dt)^2 is no more than 0.0024.
// One that has more than twice that again is not held: what has been crushed and springs back does not swing.
static double held_step(struct brunt_clock *now, double stable) {
    enum { STRETCH = 128 };
    if ((int64_t)now->steps % STRETCH == 0) now->earlier_step = now->recent_step, now->recent_step = INFINITY;
    now->recent_step = fmin(now->recent_step, stable);
    const double held = fmin(now->recent_step, now->earlier_step);
    return fmax(held, stable / 2);
}

static int fail(const brunt_world *world, const brunt_body *body, brunt_error *error, const char *reason) {
    if (!error) return BRUNT_FAILED;
    error->time = world->clock.time;
    if (body)
        memcpy(error->body, body->name,
               sizeof error->body < sizeof body->name ? sizeof error->body : sizeof body->name);
    char where[256] = "";
    if (body && error->id >= 0)
        snprintf(where, sizeof where, "body '%s', particle %lld at (%.6g, %.6g, %.6g) m, ", body->name,
                 (long long)error->id, error->place[0], error->place[1], error->place[2]);
    else if (body)
        snprintf(where, sizeof where, "body '%s', ", body->name);
    return brunt_fail(error, BRUNT_FAILED, "%stime %.9g s, step %.0f: %s", where, world->clock.time, world->clock.steps,
                      reason);
}

static int fail_particle(const brunt_world *world, brunt_body *body, int64_t slot, brunt_error *error,
                         const char *reason) {
    if (error) {
        real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
        error->id = body->particles.id[slot];
        for (int64_t s = slot; error->id < 0 && s >= 0; s--)
            error->id = body->particles.id[s]; // padding copies the last one
        for (int a = 0; a < 3; a++) error->place[a] = a < world->settings.dimension ? (double)x[a][slot] : 0;
    }
    return fail(world, body, error, reason);
}

static int fail_element(const brunt_world *world, const brunt_fem_body *fem, int32_t slot, brunt_error *error,
                        const char *reason) {
    if (!error) return BRUNT_FAILED;
    const int nodes = fem->traits->nodes;
    error->time = world->clock.time;
    memcpy(error->body, fem->name, sizeof error->body < sizeof fem->name ? sizeof error->body : sizeof fem->name);
    for (int32_t s = slot; s >= 0 && (error->id = fem->element_id[s]) < 0; s--) {} // padding copies the last one
    for (int a = 0; a < 3; a++) {
        error->place[a] = 0;
        for (int c = 0; c < nodes; c++)
            error->place[a] +=
                (double)brunt_fem_node(fem, fem->element_node[(size_t)slot * (size_t)nodes + (size_t)c])[a] / nodes;
    }
    const char *hint = strstr(reason, "inside out") ? "; erosion.inverted takes such elements out instead" : "";
    return brunt_fail(error, BRUNT_FAILED,
                      "body '%s', element %lld at (%.6g, %.6g, %.6g) m, time %.9g s, step %.0f: %s%s", fem->name,
                      (long long)error->id + 1, error->place[0], error->place[1], error->place[2], world->clock.time,
                      world->clock.steps, reason, hint);
}

// ------------------------------------------------------------------------------------------ passes

typedef struct body_job {
    brunt_world *world;
    brunt_body *body;
    double dt;
} body_job;

static void scatter_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const body_job *job = context;
    brunt_p2g_fn *scatter = brunt_total_lagrangian(&job->body->particles) ? job->world->transfers.total_scatter
                                                                          : job->world->transfers.scatter;
    for (int64_t b = begin; b < end; b++) scatter(job->body, (int32_t)b, (real)job->dt);
}

static void gather_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const body_job *job = context;
    brunt_g2p_fn *gather = brunt_total_lagrangian(&job->body->particles) ? job->world->transfers.total_gather
                                                                         : job->world->transfers.gather;
    for (int64_t b = begin; b < end; b++)
        gather(job->body, (int32_t)b, (real)job->dt, (real)job->world->settings.flip,
               &job->world->scratch.points[worker]);
}

static int sort_bodies(brunt_world *world, brunt_error *error) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        if (error) error->id = -1;
        if (brunt_sort(&body->grid, &body->particles, world->settings.threads, &world->pass[BRUNT_PASS_sort].threads,
                       error)) {
            char reason[256];
            snprintf(reason, sizeof reason, "%.250s", error ? error->message : "");
            return fail(world, body, error, reason);
        }
        const brunt_grid *grid = &body->grid;
        int32_t most = 0;
        for (int32_t b = 0; b < grid->block_count; b++)
            if (grid->blocks[b].count > most) most = grid->blocks[b].count;
        if (BRUNT_RESERVE(body->report, (size_t)grid->block_count, 0) ||
            BRUNT_RESERVE(world->scratch.node_sums, (size_t)grid->slot_count, 0))
            return fail(world, body, error, "out of memory");
        for (int t = 0; t < world->settings.threads; t++)
            if (brunt_workspace_fit(&world->scratch.points[t], grid, most))
                return fail(world, body, error, "out of memory");
    }
    return BRUNT_OK;
}

static bool acts_on(const brunt_wall *wall, const brunt_body *body) {
    return wall->body < 0 || wall->body == body->index;
}

static bool mirrors(const brunt_world *world, const brunt_symmetry_plane *mirror, const brunt_body *body) {
    return mirror->wall < 0 || acts_on(&world->boundaries.walls[mirror->wall], body);
}

static double grid_nodes(const brunt_body *body) { return (double)body->grid.slot_count * BRUNT_BLOCK_NODES; }

static double all_particles(const brunt_world *world) { return (double)brunt_world_particles(world); }

static double all_grid_nodes(const brunt_world *world) {
    double nodes = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) nodes += grid_nodes(&world->bodies.mpm[i]);
    return nodes;
}

static double all_mesh_nodes(const brunt_world *world) {
    double nodes = 0;
    for (int k = 0; k < world->bodies.fem_count; k++) nodes += world->bodies.fem[k].node_count;
    return nodes;
}

// Particles and forces to the grid, and the velocities there before anything else acts.
static void make_grid_velocities(brunt_world *world, brunt_body *body, const double gravity[3], double kick) {
    const double nodes = grid_nodes(body);
    body_job job = {world, body, kick};
    brunt_grid_job grid_job = {.body = body,
                               .gravity = gravity,
                               .dt = kick,
                               .has_gravity = world->settings.has_gravity,
                               .sums = world->scratch.node_sums};
    brunt_pass_begin(world, BRUNT_PASS_scatter);
    brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, scatter_blocks, &job,
                   &world->pass[BRUNT_PASS_scatter].threads);
    brunt_pass_end(world, (double)body->particles.count);

    brunt_pass_begin(world, BRUNT_PASS_grid);
    brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_sum, &grid_job,
                   &world->pass[BRUNT_PASS_grid].threads);
    brunt_pass_end(world, nodes);

    if (world->boundaries.mirror_count) {
        brunt_pass_begin(world, BRUNT_PASS_mirror);
        brunt_impulse_account unbooked = {.external_work = 0}; // of the axis: its impulses cancel around the circle
        for (int m = 0; m < world->boundaries.mirror_count; m++) {
            const brunt_symmetry_plane *mirror = &world->boundaries.mirrors[m];
            if (mirrors(world, mirror, body))
                brunt_symmetry_fold(body, mirror, world->settings.transfer == BRUNT_FLIP ? 1 - world->settings.flip : 1,
                                    mirror->wall < 0 ? &unbooked : &world->boundaries.walls[mirror->wall].last);
        }
        brunt_pass_end(world, nodes);
    }

    brunt_pass_begin(world, BRUNT_PASS_update);
    brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_update, &grid_job,
                   &world->pass[BRUNT_PASS_update].threads);
    // Between two steps the transfers change the velocities that the stress works on, without any change of strain: the
    // work at the new velocities less that at the last ones is theirs.
    for (int32_t n = 0; n < body->grid.slot_count; n++)
        world->ledger.transfer -= 0.5 * world->scratch.node_sums[n].stress_work;
    brunt_pass_end(world, nodes);
}

// Planes that stick or slip and regions, at the nodes of the grids.
static int apply_conditions(brunt_world *world, brunt_error *error) {
    brunt_pass_begin(world, BRUNT_PASS_conditions);
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (brunt_condition_clear(&world->bodies.mpm[i]))
            return fail(world, &world->bodies.mpm[i], error, "out of memory at a condition");
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        brunt_wall *wall = &world->boundaries.walls[w];
        bool at_nodes = wall->region || (wall->mirror < 0 && wall->plane.condition != BRUNT_SEPARATE);
        for (int i = 0; at_nodes && i < world->bodies.mpm_count; i++)
            if (acts_on(wall, &world->bodies.mpm[i]))
                brunt_condition_apply(&world->bodies.mpm[i], wall, world->clock.time);
    }
    brunt_pass_end(world, all_grid_nodes(world));
    return BRUNT_OK;
}

static int constrain_velocities(brunt_world *world, const double gravity[3], double kick, double dt,
                                brunt_error *error) {
    const bool conditions = world->boundaries.has_conditions && world->bodies.mpm_count;
    int status = conditions ? apply_conditions(world, error) : BRUNT_OK;
    if (status) return status;
    if (world->contact.has_grid) {
        brunt_pass_begin(world, BRUNT_PASS_contact);
        int failed = brunt_grid_velocity_apply(world->bodies.mpm, world->bodies.mpm_count, world->pairs.pair,
                                               world->pairs.count, world->pairs.of_mpm, world->boundaries.mirrors,
                                               world->boundaries.mirror_count, dt, world->settings.threads,
                                               &world->pass[BRUNT_PASS_contact].threads, &world->scratch.grid_velocity);
        if (failed)
            return fail(world, NULL, error,
                        failed == -1 ? "out of memory in the contact search"
                                     : "more than 16 bodies meet at one grid node");
        brunt_pass_end(world, all_grid_nodes(world));
        // What contact gave to nodes that are held.
        if (conditions && (status = apply_conditions(world, error))) return status;
    }
    if (world->contact.has_surfaces) {
        brunt_pass_begin(world, BRUNT_PASS_surfaces);
        status = brunt_surfaces_meet(world, gravity, kick, dt, error);
        brunt_pass_end(world, world->contact.surface.node_count);
        if (status) {
            char reason[256];
            snprintf(reason, sizeof reason, "%.250s", error ? error->message : "");
            return fail(world, NULL, error, reason);
        }
    }
    if (conditions && world->contact.has_surfaces && (status = apply_conditions(world, error))) return status;
    if (world->boundaries.has_walls && world->bodies.mpm_count) {
        brunt_pass_begin(world, BRUNT_PASS_walls);
        for (int i = 0; i < world->bodies.mpm_count; i++)
            if (brunt_planes_apply(&world->bodies.mpm[i], world->boundaries.walls, world->boundaries.wall_count,
                                   world->boundaries.mirrors, world->boundaries.mirror_count, world->clock.time, dt,
                                   &world->scratch.planes[i]))
                return fail(world, &world->bodies.mpm[i], error, "out of memory at a wall");
        brunt_pass_end(world, all_grid_nodes(world));
    }
    return BRUNT_OK;
}

// The grid of a total-Lagrangian body is not where its weight acts.
static void book_gravity_moment(brunt_world *world, brunt_body *body, const double gravity[3], double dt) {
    const brunt_audit audit = brunt_body_audit(body);
    for (int a = 0; a < 3; a++) {
        const int k = (a + 1) % 3, l = (a + 2) % 3;
        world->ledger.gravity_angular[a] +=
            dt * audit.mass * (audit.centre[k] * gravity[l] - audit.centre[l] * gravity[k]);
    }
}

// Kinetic energy that the grid has before and after the forces, and what gravity did.
static void keep_ledger(brunt_world *world, const double gravity[3], double dt, double *old_kinetic,
                        double *new_kinetic) {
    brunt_pass_begin(world, BRUNT_PASS_ledger);
    *old_kinetic = *new_kinetic = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        const bool total = brunt_total_lagrangian(&body->particles);
        brunt_grid_job job = {body, gravity, dt, world->settings.has_gravity, world->scratch.node_sums};
        brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_ledger, &job,
                       &world->pass[BRUNT_PASS_ledger].threads);
        for (int32_t s = 0; s < body->grid.slot_count; s++) {
            const brunt_node_sums *n = &world->scratch.node_sums[s];
            *old_kinetic += n->old_kinetic;
            *new_kinetic += n->new_kinetic;
            world->ledger.gravity_work += n->gravity_work;
            for (int a = 0; a < 3; a++) {
                int k = (a + 1) % 3, l = (a + 2) % 3;
                world->ledger.gravity_impulse[a] += dt * n->mass * gravity[a];
                if (total) continue;
                world->ledger.gravity_angular[a] +=
                    dt * (n->first_moment[k] * gravity[l] - n->first_moment[l] * gravity[k]);
            }
        }
        if (total && world->settings.has_gravity) book_gravity_moment(world, body, gravity, dt);
    }
    brunt_pass_end(world, all_grid_nodes(world));
}

static void advance_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const body_job *job = context;
    for (int64_t b = begin; b < end; b++)
        job->world->transfers.advance(job->body, (int32_t)b, (real)job->dt, (real)job->world->settings.flip,
                                      &job->world->scratch.points[worker]);
}

// Linear kernel: the particles' new velocities once more to the grid, without forces, for the gradient. What conditions
// do to that field is no impulse: it is not booked.
static void remap_velocities(brunt_world *world, double dt) {
    brunt_timer *timer = &world->pass[BRUNT_PASS_remap].threads;
    brunt_pass_begin(world, BRUNT_PASS_remap);
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        static const double weightless[3] = {0, 0, 0};
        body_job job = {world, body, dt}, still = {world, body, 0};
        brunt_grid_job grid_job = {.body = body, .gravity = weightless, .sums = world->scratch.node_sums};
        brunt_impulse_account unbooked = {.external_work = 0};
        brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, advance_blocks, &job, timer);
        brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, scatter_blocks, &still, timer);
        brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_sum, &grid_job, timer);
        for (int m = 0; m < world->boundaries.mirror_count; m++)
            if (mirrors(world, &world->boundaries.mirrors[m], body))
                brunt_symmetry_fold(body, &world->boundaries.mirrors[m], 1, &unbooked);
        brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_update, &grid_job, timer);
        for (int w = 0; w < world->boundaries.wall_count; w++) {
            brunt_wall wall = world->boundaries.walls[w];
            bool at_nodes = wall.region || (wall.mirror < 0 && wall.plane.condition != BRUNT_SEPARATE);
            if (at_nodes && acts_on(&wall, body)) brunt_condition_apply(body, &wall, world->clock.time);
        }
    }
    brunt_pass_end(world, all_particles(world));
}

// Where the step changes, the two halves of the kick are not alike: velocities are further behind the stress, or less,
// by which central differences gain or lose (dt_old^2 - dt^2) / 8 f^2 / m. That is booked with the transfers, too.
static int gather_bodies(brunt_world *world, double kick, double dt, double *kinetic, brunt_error *error) {
    brunt_pass_begin(world, BRUNT_PASS_gather);
    double power = 0, remap = 0, before = 0;
    *kinetic = 0;
    brunt_body *bad_body = NULL;
    int64_t bad = -1;
    const char *reason = NULL;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        body_job job = {world, body, dt};
        body->uneven = kick != dt;
        body->speed = 0;
        brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, gather_blocks, &job,
                       &world->pass[BRUNT_PASS_gather].threads);
        for (int32_t b = 0; b < body->grid.block_count; b++) {
            body->speed = body->report[b].speed > body->speed ? body->report[b].speed : body->speed;
            *kinetic += body->report[b].kinetic;
            power += body->report[b].stress_power;
            remap += body->report[b].remap_power;
            before += body->report[b].old_power;
            if (body->report[b].bad >= 0 && !bad_body)
                bad_body = body, bad = body->report[b].bad, reason = body->report[b].reason;
        }
    }
    world->ledger.transfer -= 0.5 * (world->ledger.stress_work + dt * remap + (dt - kick) * before);
    world->ledger.stress_work = dt * power;
    brunt_pass_end(world, all_particles(world));
    return bad_body ? fail_particle(world, bad_body, bad, error, reason) : BRUNT_OK;
}

static brunt_kick kick_of(brunt_world *world, const double gravity[3], double dt) {
    return (brunt_kick){.dt = dt,
                        .gravity = {gravity[0], gravity[1], gravity[2]},
                        .threads = world->settings.threads,
                        .timer = &world->pass[BRUNT_PASS_kick].threads};
}

static void kick_meshes(brunt_world *world, const double gravity[3], double kick, double dt) {
    brunt_pass_begin(world, BRUNT_PASS_kick);
    if (world->boundaries.sets.count || world->boundaries.damping.active)
        brunt_loads_begin(&world->boundaries.sets, &world->bodies, world->clock.time, kick);
    if (world->boundaries.damping.active) {
        const brunt_kick drag = kick_of(world, gravity, kick);
        brunt_damping_begin(&world->boundaries.damping, &world->bodies, &drag);
    }
    brunt_fem_kick_all(world, gravity, kick);
    brunt_pass_end(world, all_mesh_nodes(world));
    if (!world->boundaries.sets.count) return;
    double held = 0;
    brunt_pass_begin(world, BRUNT_PASS_groups);
    brunt_node_sets_prescribe(&world->boundaries.sets, gravity, world->clock.time, kick, dt);
    for (int h = 0; h < world->boundaries.sets.count; h++) held += world->boundaries.sets.set[h].node_count;
    brunt_pass_end(world, held);
}

// The other half of what loads and drag do: velocities are final now.
static void finish_kick(brunt_world *world, double kick) {
    static const double none[3] = {0};
    brunt_pass_begin(world, BRUNT_PASS_kick);
    if (world->boundaries.sets.count) brunt_loads_end(&world->boundaries.sets, kick);
    if (world->boundaries.damping.active) {
        const brunt_kick drag = kick_of(world, none, kick);
        brunt_damping_end(&world->boundaries.damping, &world->bodies, &drag, &world->ledger.damping);
    }
    brunt_pass_end(world, 0);
}

static int move_meshes(brunt_world *world, const double gravity[3], double kick, double dt, brunt_error *error) {
    int32_t bad = -1;
    const char *reason = "";
    brunt_pass_begin(world, BRUNT_PASS_drift);
    brunt_fem_drift_all(world, gravity, kick, dt);
    brunt_pass_end(world, all_mesh_nodes(world));
    brunt_pass_begin(world, BRUNT_PASS_elements);
    const brunt_fem_body *failed = brunt_fem_elements_all(world, dt, &bad, &reason);
    brunt_pass_end(world, (double)brunt_world_elements(world));
    return failed ? fail_element(world, failed, bad, error, reason) : BRUNT_OK;
}

// The step that is due: stable, not past the end, and exactly on `limit` when that comes first. The way to such a time
// is cut in equal steps. Whole ones and two halves at the last excite what swings fastest each time anew: central
// differences with steps that vary are stable for no share of the limit in general (R. D. Skeel, BIT 33 (1993) 172). At
// cfl 0.9 and 18 steps between outputs, a rod without viscosity gained 10^5 times its energy within 500 steps.
static double choose_step(const brunt_world *world, double limit) {
    double dt = world->settings.fixed_step > 0 ? world->settings.fixed_step : world->clock.next_dt;
    double stop = fmin(limit > world->clock.time ? limit : INFINITY, world->settings.end),
           left = stop - world->clock.time;
    if (dt >= left * (1 - 1e-9)) return left;
    if (world->settings.fixed_step > 0 || !(left < 1e6 * dt)) return dt;
    return left / ceil(left / dt * (1 - 1e-9));
}

static int make_grids(brunt_world *world, const double gravity[3], double kick, brunt_error *error) {
    brunt_pass_begin(world, BRUNT_PASS_sort);
    int status = sort_bodies(world, error);
    brunt_pass_end(world, all_particles(world));
    if (status) return status;
    for (int i = 0; i < world->bodies.mpm_count; i++) make_grid_velocities(world, &world->bodies.mpm[i], gravity, kick);
    return BRUNT_OK;
}

// A fluid spreads until there are cells between its particles that none of them reaches: there pressure and contact act
// on single particles.
static void watch_spread(brunt_world *world) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        if (!body->material.model[BRUNT_STRENGTH]->fluid || body->spread_told) continue;
        double spread = brunt_body_spread(body);
        if (!(spread > 1)) continue;
        body->spread_told = true;
        brunt_warn(
            &world->messages,
            "bodies.%s: at t = %.4g s the fluid has spread: particles stand for volumes %.2g cells wide, so that "
            "there are cells with none; pressure there is as coarse as that (more particles_per_cell, or a "
            "coarser grid, helps)",
            body->name, world->clock.time, spread);
    }
}

static int64_t all_eroded(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->bodies.count; i++)
        n += world->erosion.account[i].elements + world->erosion.account[i].particles;
    return n;
}

static int erode(brunt_world *world, double dt, brunt_error *error) {
    const int64_t before = all_eroded(world);
    const double looked_at = (double)brunt_world_elements(world) + all_particles(world);
    brunt_pass_begin(world, BRUNT_PASS_erosion);
    int status = world->bodies.fem_count ? brunt_erode_meshes(world, dt, error) : BRUNT_OK;
    if (!status && world->bodies.mpm_count) status = brunt_erode_particles(world, dt, error);
    if (all_eroded(world) > before)
        world->clock.recent_step = world->clock.earlier_step = INFINITY; // what left swings no more
    brunt_pass_end(world, looked_at);
    return status;
}

// The body of material points that has the shortest stable step, and of the block where its waves or its points are
// fastest the densest or the fastest point. NULL: there is none.
static brunt_body *shortest_points(brunt_world *world, int64_t *slot, double *wave) {
    brunt_body *shortest = NULL;
    int32_t block = 0;
    double most = 0, speed = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_block_report *report = world->bodies.mpm[i].report;
        int32_t w = 0, v = 0;
        for (int32_t b = 1; b < world->bodies.mpm[i].grid.block_count; b++) {
            if (report[b].wave_speed > report[w].wave_speed) w = b;
            if (report[b].speed > report[v].speed) v = b;
        }
        if (!world->bodies.mpm[i].grid.block_count || !((double)report[w].wave_speed + (double)report[v].speed > most))
            continue;
        *wave = (double)report[w].wave_speed, speed = (double)report[v].speed, most = *wave + speed;
        shortest = &world->bodies.mpm[i], block = *wave > speed ? w : v;
    }
    if (!shortest) return NULL;
    brunt_particles *p = &shortest->particles;
    real *const *v = brunt_field(p, BRUNT_FIELD_velocity);
    const brunt_block *at = &shortest->grid.blocks[block];
    double greatest = -1;
    *slot = at->first;
    for (int64_t s = at->first; s < at->first + at->count; s++) {
        double is = 1 / (double)brunt_plane_volume(p, s);
        if (*wave <= speed) is = 0;
        for (int a = 0; a < p->dim && *wave <= speed; a++) is += (double)v[a][s] * (double)v[a][s];
        if (p->id[s] >= 0 && isfinite(is) && is > greatest) greatest = is, *slot = s;
    }
    return shortest;
}

static int fail_short_points(brunt_world *world, brunt_error *error, const char *why) {
    char reason[240];
    int64_t slot;
    double wave;
    brunt_body *body = shortest_points(world, &slot, &wave);
    if (!body) return fail(world, NULL, error, why);
    snprintf(reason, sizeof reason, "%s: waves run at %.4g m/s in cells of %.4g m", why, wave, world->settings.cell);
    return fail_particle(world, body, slot, error, reason);
}

// For what has the stable step that is too short: an element, with the loads on its body, or a body of material points.
static int fail_short(brunt_world *world, double stable, brunt_error *error, const char *why) {
    int32_t slot;
    const bool by_element = !world->bodies.mpm_count || brunt_fem_stable_step(world) <= stable * (1 + 1e-9);
    brunt_fem_body *fem = by_element ? brunt_fem_shortest(world, &slot) : NULL;
    if (!fem) return fail_short_points(world, error, why);
    char reason[240];
    const bool by_load = brunt_load_frequency(&world->boundaries.sets, &world->bodies, (int)(fem - world->bodies.fem),
                                              world->clock.time) *
                             stable * stable >
                         2; // half of 4
    snprintf(reason, sizeof reason, "%s%s", why,
             by_load ? ", most of it by gas or pressure on the body's surface" : "");
    return fail_element(world, fem, slot, error, reason);
}

// The step that is due and what acts in it; everything else is of the passes.
typedef struct step {
    double limit, dt, kick, gravity[3]; // [s], [s], [s], [m/s^2]
} step;

static int refuse_step(brunt_world *world, double dt, brunt_error *error) {
    const double stable = world->clock.next_dt / world->settings.cfl;
    if (world->clock.time >= world->settings.end)
        return fail(world, NULL, error, "the end has been reached, there is no step to take");
    char reason[160];
    snprintf(reason, sizeof reason,
             "the stable step is %.4g s: something moves, or its waves run, too fast to be computed with", stable);
    if (!(dt > 0)) return fail(world, NULL, error, reason);
    snprintf(reason, sizeof reason, "the stable step has become %.4g s, time.least_step is %.4g s", stable,
             world->settings.least_step);
    if (stable < world->settings.least_step) return fail_short(world, stable, error, reason);
    snprintf(reason, sizeof reason, "the fixed step of %.6g s is larger than the stable one, %.6g s", dt, stable);
    if (world->settings.fixed_step > 0 && dt > stable) return fail_short(world, stable, error, reason);
    if (world->clock.time + dt == world->clock.time)
        return fail(world, NULL, error, "the stable step has become too small to advance the time");
    return BRUNT_OK;
}

static int begin_step(brunt_world *world, step *s, brunt_error *error) {
    brunt_pass_begin(world, BRUNT_PASS_advance);
    const double dt = s->dt = choose_step(world, s->limit);
    if (error) *error = (brunt_error){.id = -1};
    int status = refuse_step(world, dt, error);
    if (status) return status;
    // Central differences: velocities are those of the middle of a step, so that forces act over the mean of the steps
    // before and after, and over half a step at the start.
    s->kick = world->clock.steps > 0 ? 0.5 * (world->clock.dt + dt) : 0.5 * dt;
    brunt_gravity_at(world, world->clock.time, s->gravity); // as the forces: of the middle of the kick
    for (int i = 0; i < world->bodies.mpm_count; i++) world->bodies.mpm[i].time = (real)(world->clock.time + dt);
    for (int k = 0; k < world->bodies.fem_count; k++) world->bodies.fem[k].time = (real)(world->clock.time + dt);
    for (int w = 0; w < world->boundaries.wall_count; w++)
        world->boundaries.walls[w].last = (brunt_impulse_account){.external_work = 0};
    for (int p = 0; p < world->pairs.count; p++)
        world->pairs.pair[p].last = (brunt_impulse_account){.external_work = 0};
    brunt_pass_end(world, world->bodies.count);
    return BRUNT_OK;
}

static int fail_gas(const brunt_world *world, brunt_error *error) {
    char reason[200];
    snprintf(reason, sizeof reason, "boundaries (%s): the gas's volume has become %.4g m^3",
             world->boundaries.sets.gas_lost->wall->name, world->boundaries.sets.gas_lost->gas_volume);
    return fail(world, NULL, error, reason);
}

// The clock, and the accounts of what acts from outside and between bodies.
static void advance(brunt_world *world, const step *s) {
    struct brunt_clock *now = &world->clock;
    brunt_pass_begin(world, BRUNT_PASS_advance);
    for (int w = 0; w < world->boundaries.wall_count; w++)
        brunt_impulse_account_add(&world->boundaries.walls[w].action, &world->boundaries.walls[w].last);
    for (int p = 0; p < world->pairs.count; p++)
        brunt_impulse_account_add(&world->pairs.pair[p].action, &world->pairs.pair[p].last);
    brunt_ledger_remember(world);
    double stop = fmin(s->limit > now->time ? s->limit : INFINITY, world->settings.end);
    now->time = s->dt == stop - now->time ? stop : now->time + s->dt;
    now->steps += 1;
    now->dt = s->dt;
    now->kick = s->kick;
    if (2 * s->dt >= now->next_dt) now->longest = fmax(now->longest, s->dt); // else it was cut to end on a time
    now->dt_min = fmin(now->dt_min, s->dt);
    now->dt_max = fmax(now->dt_max, s->dt);
    brunt_pass_end(world, 0);
}

static int check_energy(brunt_world *world, brunt_error *error) {
    brunt_energy energy;
    brunt_world_energy(world, &energy);
    // Energy that the transfers make is as wrong as energy that is not accounted for.
    const double made =
        world->bodies.mpm_count && energy.reference > 0 ? -world->ledger.transfer / energy.reference : 0;
    if (!(fabs(energy.error_relative) > world->settings.energy_limit || made > world->settings.energy_limit))
        return BRUNT_OK;
    char reason[240], transfers[80] = "";
    if (world->bodies.mpm_count)
        snprintf(transfers, sizeof transfers, ", and the transfers have made %.3g %%", 100 * fmax(made, 0));
    snprintf(reason, sizeof reason, "the energy error is %.3g %% of %.3g J%s; time.energy_limit allows %.3g %%",
             100 * energy.error_relative, energy.reference, transfers, 100 * world->settings.energy_limit);
    return fail(world, NULL, error, reason);
}

// Steps that shorten without end never get there: told at a thousandth of the longest so far that was not cut short,
// and the end at a millionth, unless the scene says where. It is looked at while it is known what was fast in the step.
static int watch_creep(brunt_world *world, brunt_error *error) {
    const struct brunt_clock *now = &world->clock;
    const double share = now->next_dt / now->longest;
    if (world->settings.fixed_step > 0 || now->time >= world->settings.end || !(share < 1e-3)) return BRUNT_OK;
    const bool ends = share < 1e-6 && !(world->settings.least_step > 0);
    if (world->clock.creep_told && !ends) return BRUNT_OK;
    char why[160];
    snprintf(why, sizeof why, "the step has become %.4g s, %s of the longest so far%s", now->next_dt,
             ends ? "less than a millionth" : "less than a thousandth", ends ? " (time.least_step allows less)" : "");
    brunt_error told = {.id = -1};
    fail_short(world, now->next_dt / world->settings.cfl, ends ? error : &told, why);
    if (!ends) brunt_warn(&world->messages, "%s", told.message);
    world->clock.creep_told = true;
    return ends ? BRUNT_FAILED : BRUNT_OK;
}

// The stable step that follows, and whether all is as it should be.
static int look_over(brunt_world *world, brunt_error *error) {
    struct brunt_clock *now = &world->clock;
    brunt_pass_begin(world, BRUNT_PASS_advance);
    now->next_dt = brunt_stable_step(world);
    if (world->bodies.fem_count && isfinite(now->next_dt)) now->next_dt = held_step(now, now->next_dt);
    if (!isfinite(world->ledger.kinetic) || !isfinite(world->ledger.fem_kinetic) || !isfinite(now->next_dt))
        return fail(world, NULL, error, "the kinetic energy is not a finite number");
    if (world->bodies.has_fluid && (int64_t)now->steps % SPREAD_CHECK == 0) watch_spread(world);
    int status = (int64_t)now->steps % ENERGY_CHECK == 0 && isfinite(world->settings.energy_limit)
                     ? check_energy(world, error)
                     : BRUNT_OK;
    if (!status) status = watch_creep(world, error);
    brunt_pass_end(world, 0);
    return status;
}

static int take_step(brunt_world *world, double limit, brunt_error *error) {
    step s = {.limit = limit};
    double old_kinetic, new_kinetic, kinetic = 0;
    int status = begin_step(world, &s, error);
    if (status) return status;
    if (world->bodies.fem_count) kick_meshes(world, s.gravity, s.kick, s.dt);
    if (world->boundaries.sets.gas_lost) return fail_gas(world, error);
    if (world->bodies.mpm_count && (status = make_grids(world, s.gravity, s.kick, error))) return status;
    if ((status = constrain_velocities(world, s.gravity, s.kick, s.dt, error))) return status;
    old_kinetic = new_kinetic = world->ledger.kinetic;
    if (world->bodies.mpm_count) {
        keep_ledger(world, s.gravity, s.kick, &old_kinetic, &new_kinetic);
        if (world->transfers.advance) remap_velocities(world, s.dt);
        status = gather_bodies(world, s.kick, s.dt, &kinetic, error);
    }
    if (world->boundaries.sets.count || world->boundaries.damping.active) finish_kick(world, s.kick);
    if (world->bodies.fem_count) {
        int moved = move_meshes(world, s.gravity, s.kick, s.dt, status ? NULL : error);
        status = status ? status : moved;
    }
    world->ledger.transfer += world->ledger.kinetic - old_kinetic + new_kinetic - kinetic;
    world->ledger.kinetic = kinetic;
    advance(world, &s);
    if (!status && world->erosion.active) status = erode(world, s.dt, error);
    return status ? status : look_over(world, error);
}

int brunt_world_step(brunt_world *world, double limit, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world to take a step of");
    brunt_step_begin(world);
    int status = take_step(world, limit, error);
    brunt_step_end(world);
    return status;
}
