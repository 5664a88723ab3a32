// What is watched from step to step: energy, fluids that spread, steps that shorten without end.
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "scheme/implicit.h"
#include "scheme/scheme.h"

enum { ENERGY_CHECK = 32, SPREAD_CHECK = 32, FOLD_CHECK = 16 * ENERGY_CHECK }; // steps

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

// An element that is folded at a corner goes on, and its faces there are turned over: contact holds nothing off from
// behind. With the corner of a cube in another, hexahedra of an eighth, all nodes that were deeper than a fifth of an
// edge were of such elements (bench/studies); that was 1.4 m in the end, and the run said nothing.
static void watch_folds(brunt_world *world) {
    for (int i = 0; i < world->bodies.fem_count; i++) {
        brunt_fem_body *body = &world->bodies.fem[i];
        const int32_t folded = body->fold_told ? 0 : brunt_fem_folded(body);
        if (!folded) continue;
        body->fold_told = true;
        brunt_warn(&world->messages,
                   "bodies.%s: at t = %.4g s %d of %d elements are turned inside out at a corner, not at their middle, "
                   "which is all they see: what is in contact can go through there (hourglass.coefficient, here %.3g, "
                   "up to 1, or other elements help)",
                   body->name, world->clock.time, folded, body->element_count, (double)body->hourglass_coefficient);
    }
}

// The share of all energy that has been made, of a sum that should have been lost.
static double made_share(const brunt_energy *energy, double lost) {
    return energy->reference > 0 ? fmax(-lost / energy->reference, 0) : 0;
}

// Lines and surfaces store nothing that they could give back. Newmark's rule pushes by their tractions at both ends of
// a step, and so once more what has let go by then: a body that comes and goes within two steps leaves with up to three
// times its speed. What comes in slow steps gives as much as it takes, and one that is without end has less than none.
static double made_by_surfaces(const brunt_world *world) {
    double lost = 0;
    for (int k = 0; world->settings.scheme == BRUNT_IMPLICIT && k < world->boundaries.surfaces.count; k++)
        lost += fmin(world->boundaries.surfaces.surface[k].boundary->account.normal_loss, 0);
    return lost;
}

// Newmark's rule keeps the energy of linear springs: barriers are the least linear that there is.
static const char *what_makes(const brunt_world *world) {
    if (world->settings.scheme == BRUNT_STATIC)
        return ", and load steps have made %.3g %% (more of them make less, but where bodies jump)";
    if (world->plan.implicit->contact.barrier)
        return ", and the integrator has made %.3g %% (shorter steps, less contact.stiffness, or euler, make less)";
    return ", and the integrator has made %.3g %% (shorter steps, or euler, make less)";
}

static int check_energy(brunt_world *world, brunt_error *error) {
    brunt_energy energy;
    brunt_bodies_measure(&world->bodies, world->settings.threads);
    brunt_world_energy(world, &energy);
    brunt_bodies_forget(&world->bodies);
    // Energy that transfers or an integrator make is as wrong as energy that is not accounted for.
    const double limit = world->settings.given.energy_limit;
    const double transfers = made_share(&energy, world->ledger.transfer),
                 scheme = made_share(&energy, energy.scheme) + made_share(&energy, made_by_surfaces(world));
    if (!(fabs(energy.error_relative) > limit || transfers > limit || scheme > limit)) return BRUNT_OK;
    char reason[320], makers[160] = "";
    int length = 0;
    if (world->bodies.mpm_count)
        length = snprintf(makers, sizeof makers, ", and the transfers have made %.3g %%", 100 * transfers);
    if (world->plan.implicit)
        snprintf(makers + length, sizeof makers - (size_t)length, what_makes(world), 100 * scheme);
    snprintf(reason, sizeof reason, "the energy error is %.3g %% of %.3g J%s; time.energy_limit allows %.3g %%",
             100 * energy.error_relative, energy.reference, makers, 100 * limit);
    return brunt_fail_step(&world->clock, NULL, error, reason);
}

// Steps that shorten without end never get there: told at a thousandth of the longest so far that was not cut short,
// and the end at a millionth, unless the scene says where. It is looked at while it is known what was fast in the step.
static int watch_creep(brunt_world *world, brunt_error *error) {
    const struct brunt_clock *now = &world->clock;
    const double share = now->next_dt / now->longest;
    if (world->settings.fixed_step > 0 || now->time >= world->settings.end || !(share < 1e-3)) return BRUNT_OK;
    const bool ends = share < 1e-6 && !(world->settings.given.least_step > 0);
    if (world->clock.creep_told && !ends) return BRUNT_OK;
    char why[160];
    snprintf(why, sizeof why, "the step has become %.4g s, %s of the longest so far%s", now->next_dt,
             ends ? "less than a millionth" : "less than a thousandth", ends ? " (time.least_step allows less)" : "");
    brunt_error told = {.id = -1};
    brunt_fail_short(world, now->next_dt / world->settings.cfl, ends ? error : &told, why);
    if (!ends) brunt_warn(&world->messages, "%s", told.message);
    world->clock.creep_told = true;
    return ends ? BRUNT_FAILED : BRUNT_OK;
}

static int watch_energy(brunt_world *world, int every, brunt_error *error) {
    const struct brunt_clock *now = &world->clock;
    if (!isfinite(world->ledger.kinetic) || !isfinite(world->ledger.fem_kinetic) || !isfinite(now->next_dt))
        return brunt_fail_step(&world->clock, NULL, error, "the kinetic energy is not a finite number");
    if (world->bodies.has_fluid && (int64_t)now->steps % SPREAD_CHECK == 0) watch_spread(world);
    const bool ends = now->time >= world->settings.end; // with less than that many steps behind the last look
    if ((int64_t)now->steps % (every * FOLD_CHECK / ENERGY_CHECK) == 0 || ends) watch_folds(world);
    if (((int64_t)now->steps % every != 0 && !ends) || !isfinite(world->settings.given.energy_limit)) return BRUNT_OK;
    return check_energy(world, error);
}

// The stable step that follows, and whether all is as it should be.
int brunt_pass_watch(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)step;
    struct brunt_clock *now = &world->clock;
    now->next_dt = brunt_stable_step(world);
    if (world->bodies.fem_count && isfinite(now->next_dt)) now->next_dt = brunt_held_step(now, now->next_dt);
    const int status = watch_energy(world, ENERGY_CHECK, error);
    return status ? status : watch_creep(world, error);
}

// A step that was cut is followed by longer ones again, up to what is asked for.
int brunt_pass_watch_implicit(brunt_world *world, brunt_step *step, brunt_error *error) {
    struct brunt_clock *now = &world->clock;
    const bool cut = now->newton_last.cuts > 0, still = world->settings.scheme == BRUNT_STATIC;
    const double last = cut ? step->dt : now->next_dt;
    now->next_dt = fmin(world->settings.fixed_step, cut && still ? last : 2 * last);
    brunt_implicit_tell_turns(world);
    return watch_energy(world, 1, error); // there may be few steps
}
