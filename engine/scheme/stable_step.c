// How long a step is: stable, not past the end, exactly on the times that are asked for.
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "boundary/gravity.h"
#include "scheme/scheme.h"

double brunt_body_step(const brunt_world *world, int body, double around) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    const double load = brunt_load_frequency(&world->boundaries.sets, &world->bodies, body, world->clock.time);
    return ref->ops->stable_step(ref, world->settings.cell, around, load);
}

double brunt_boundary_speed(const brunt_boundaries *set) {
    double most = 0;
    for (int w = 0; w < set->boundary_count; w++) {
        const brunt_boundary *boundary = &set->boundary[w];
        const double *v = boundary->kind->velocity ? boundary->kind->velocity(boundary) : (const double[3]){0};
        most = fmax(most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return most;
}

double brunt_stable_step(const brunt_world *world) {
    const double boundary_speed = brunt_boundary_speed(&world->boundaries);
    double least = INFINITY, first = INFINITY;
    for (int i = 0; i < world->bodies.count; i++) {
        const double step = brunt_body_step(world, i, boundary_speed);
        if (isnan(step)) return NAN;
        least = fmin(least, step);
    }
    for (int i = 0; isinf(least) && i < world->bodies.count; i++) // all has eroded: steps as of what there was
        first = fmin(first, world->bodies.all[i].ops->first_step(&world->bodies.all[i], world->settings.cell));
    if (isinf(least)) least = first;
    return world->settings.cfl * least;
}

// The step that follows stable ones, of this state and of those before. A mesh that swings has a stable step that
// swings with it, and a step that follows it pumps: central differences gain energy by steps that vary (choose_step) at
// a share of the limit where equal ones gain none. Of one oscillator, omega = omega_0 (1 + a sin(omega t)), that is a
// share of order a (omega dt)^2 in each period. So a step is that of the stiffest shape of the last 128 to 256 steps:
// steps are equal over all periods that are shorter, and of those that are longer (omega dt)^2 is no more than 0.0024.
// One that has more than twice that again is not held: what has been crushed and springs back does not swing.
double brunt_held_step(struct brunt_clock *now, double stable) {
    enum { STRETCH = 128 };
    if ((int64_t)now->steps % STRETCH == 0) now->earlier_step = now->recent_step, now->recent_step = INFINITY;
    now->recent_step = fmin(now->recent_step, stable);
    const double held = fmin(now->recent_step, now->earlier_step);
    return fmax(held, stable / 2);
}

// The body of material points that has the shortest stable step, and of the block where its waves or its points are
// fastest the densest or the fastest point. NULL: there is none.
static brunt_body *shortest_points(brunt_bodies *bodies, int64_t *slot, double *wave) {
    brunt_body *shortest = NULL;
    int32_t block = 0;
    double most = 0, speed = 0;
    for (int i = 0; i < bodies->mpm_count; i++) {
        const brunt_block_report *report = bodies->mpm[i].report;
        int32_t w = 0, v = 0;
        for (int32_t b = 1; b < bodies->mpm[i].grid.block_count; b++) {
            if (report[b].wave_speed > report[w].wave_speed) w = b;
            if (report[b].speed > report[v].speed) v = b;
        }
        if (!bodies->mpm[i].grid.block_count || !((double)report[w].wave_speed + (double)report[v].speed > most))
            continue;
        *wave = (double)report[w].wave_speed, speed = (double)report[v].speed, most = *wave + speed;
        shortest = &bodies->mpm[i], block = *wave > speed ? w : v;
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
    brunt_body *body = shortest_points(&world->bodies, &slot, &wave);
    if (!body) return brunt_fail_step(&world->clock, NULL, error, why);
    snprintf(reason, sizeof reason, "%s: waves run at %.4g m/s in cells of %.4g m", why, wave, world->settings.cell);
    return brunt_fail_particle(world, body, slot, error, reason);
}

int brunt_fail_short(brunt_world *world, double stable, brunt_error *error, const char *why) {
    int32_t slot;
    const bool by_element = !world->bodies.mpm_count || brunt_fem_stable_step(world) <= stable * (1 + 1e-9);
    brunt_fem_body *fem = by_element ? brunt_fem_shortest(world, &slot) : NULL;
    if (!fem) return fail_short_points(world, error, why);
    char reason[240];
    const double frequency =
        brunt_load_frequency(&world->boundaries.sets, &world->bodies, fem->index, world->clock.time);
    const bool by_load = frequency * stable * stable > 2; // half of 4
    snprintf(reason, sizeof reason, "%s%s", why,
             by_load ? ", most of it by gas or pressure on the body's surface" : "");
    return brunt_fail_element(&world->clock, fem, slot, error, reason);
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

static int refuse_fixed(brunt_world *world, double stable, brunt_error *error) {
    char reason[240];
    snprintf(reason, sizeof reason,
             "the fixed step of %.6g s is larger than the stable one, %.6g s; time.cfl, a share of the stable one, "
             "is what explicit steps go by where it is given beside time.step",
             world->settings.fixed_step, stable);
    return brunt_fail_short(world, stable, error, reason);
}

int brunt_check_fixed_step(brunt_world *world, brunt_error *error) {
    const double stable = world->clock.next_dt / world->settings.cfl;
    if (!(world->settings.fixed_step > stable)) return BRUNT_OK;
    brunt_error told = {.id = -1};
    refuse_fixed(world, stable, &told);
    return brunt_fail(error, BRUNT_BAD_INPUT, "time.step: %s", told.message);
}

static int refuse_step(brunt_world *world, double dt, brunt_error *error) {
    const double stable = world->clock.next_dt / world->settings.cfl;
    if (world->clock.time >= world->settings.end)
        return brunt_fail_step(&world->clock, NULL, error, "the end has been reached, there is no step to take");
    char reason[240];
    if (!(dt > 0)) {
        snprintf(reason, sizeof reason,
                 "the stable step is %.4g s: something moves, or its waves run, too fast to be computed with", stable);
        return brunt_fail_step(&world->clock, NULL, error, reason);
    }
    if (stable < world->settings.given.least_step) {
        snprintf(reason, sizeof reason, "the stable step has become %.4g s, time.least_step is %.4g s", stable,
                 world->settings.given.least_step);
        return brunt_fail_short(world, stable, error, reason);
    }
    if (world->settings.fixed_step > 0 && dt > stable) return refuse_fixed(world, stable, error);
    if (world->clock.time + dt == world->clock.time)
        return brunt_fail_step(&world->clock, NULL, error, "the stable step has become too small to advance the time");
    return BRUNT_OK;
}

int brunt_pass_choose(brunt_world *world, brunt_step *s, brunt_error *error) {
    const double dt = s->dt = choose_step(world, s->limit);
    if (error) *error = (brunt_error){.id = -1};
    int status = refuse_step(world, dt, error);
    if (status) return status;
    // Central differences: velocities are those of the middle of a step, so that forces act over the mean of the steps
    // before and after, and over half a step at the start.
    s->kick = world->clock.steps > 0 ? 0.5 * (world->clock.dt + dt) : 0.5 * dt;
    brunt_step_open(world, s); // gravity as the forces: of the middle of the kick
    return BRUNT_OK;
}

void brunt_step_open(brunt_world *world, brunt_step *s) {
    const double dt = s->dt;
    brunt_gravity_at(&world->settings, world->clock.time, s->gravity);
    for (int i = 0; i < world->bodies.mpm_count; i++) world->bodies.mpm[i].time = (real)(world->clock.time + dt);
    for (int k = 0; k < world->bodies.fem_count; k++) world->bodies.fem[k].time = (real)(world->clock.time + dt);
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        world->boundaries.boundary[w].last = (brunt_impulse_account){.external_work = 0};
    for (int p = 0; p < world->pairs.count; p++)
        world->pairs.pair[p].last = (brunt_impulse_account){.external_work = 0};
    s->old_kinetic = s->new_kinetic = world->ledger.kinetic;
}
