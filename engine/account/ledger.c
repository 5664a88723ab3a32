// Energy and momentum of a world, and what is known of bodies, pairs and walls.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "world/world.h"

static const double MOST_GROWTH = 10, STEP_ROUNDINGS = 10;
static const double REAL_EPSILON = sizeof(real) == sizeof(float) ? FLT_EPSILON : DBL_EPSILON;

// What the run has been given by now [J]: the energy at the start, with the work done on it, and that work itself, each
// cause by its amount, since what one wall puts in another may take out.
static double given_energy(const brunt_world *world) {
    double work = world->ledger.gravity_work, turned_over = fabs(work);
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        work += world->boundaries.walls[w].action.external_work;
        turned_over += fabs(world->boundaries.walls[w].action.external_work);
    }
    const double initial = world->ledger.initial_energy;
    return fmax(fmax(fabs(initial), fabs(initial + work)), turned_over);
}

void brunt_ledger_remember(brunt_world *world) {
    world->ledger.energy_scale = fmax(world->ledger.energy_scale, given_energy(world));
}

static void bound_body(const brunt_world *world, const brunt_body_ref *body, brunt_body_sums *sums);

// Places x are known to eps |x|, strains of elements of size h to eps |x| / h, and rounded some ten times a step, now
// up now down: m c^2 (10 eps |x| / h)^2 for each step.
double brunt_rounding_energy(brunt_world *world) {
    double energy = 0;
    for (int i = 0; i < world->bodies.count; i++) {
        const brunt_body_ref *body = &world->bodies.all[i];
        brunt_body_sums sums;
        double far = 0;
        bound_body(world, body, &sums);
        for (int a = 0; a < world->settings.dimension; a++)
            far = fmax(far, fmax(fabs(sums.low[a]), fabs(sums.high[a])));
        const double mass = body->fem ? brunt_fem_audit(body->fem).mass : brunt_body_audit(body->mpm).mass;
        const double size = body->fem ? body->fem->mean_edge : body->mpm->spacing;
        const brunt_material *material = body->fem ? &body->fem->material : &body->mpm->material;
        const double v = (double)material->wave_speed * STEP_ROUNDINGS * REAL_EPSILON * far / size;
        energy += mass * v * v;
    }
    return energy;
}

void brunt_world_energy(brunt_world *world, brunt_energy *energy) {
    const brunt_ledger *now = &world->ledger;
    // Velocities are those of the middle of the last step, stress that of its end: what it does to them in that half
    // step is booked with the transfer.
    *energy = (brunt_energy){.kinetic = now->kinetic + now->fem_kinetic,
                             .initial = now->initial_energy,
                             .transfer = now->transfer - 0.5 * (now->stress_work + now->fem_stress_work),
                             .external_work = now->gravity_work};
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_point_energy e = brunt_body_energy(&world->bodies.mpm[i]);
        energy->internal += e.internal;
        energy->plastic += e.plastic;
        energy->viscosity += e.viscosity;
        energy->heat += e.heat;
    }
    energy->hourglass = now->hourglass_stored + now->hourglass_lost;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        brunt_point_energy e = brunt_fem_energy(&world->bodies.fem[k]);
        energy->internal += e.internal;
        energy->plastic += e.plastic;
        energy->viscosity += e.viscosity;
        energy->heat += e.heat;
    }
    energy->viscosity += now->damping.loss + now->eroded_viscosity;
    energy->plastic += now->eroded_plastic;
    energy->heat += now->eroded_heat;
    for (int i = 0; i < world->bodies.count && world->erosion.active; i++)
        energy->eroded += world->erosion.account[i].energy;
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        energy->contact += world->boundaries.walls[w].action.normal_loss;
        energy->friction += world->boundaries.walls[w].action.friction_loss;
        energy->external_work += world->boundaries.walls[w].action.external_work;
    }
    for (int p = 0; p < world->pairs.count; p++) {
        energy->contact += world->pairs.pair[p].action.normal_loss;
        energy->friction += world->pairs.pair[p].action.friction_loss;
    }
    energy->total = energy->kinetic + energy->internal + energy->plastic + energy->hourglass + energy->contact +
                    energy->friction + energy->viscosity + energy->transfer + energy->eroded;
    energy->error = energy->total - energy->initial - energy->external_work;
    // Relative to the most that the run has been given so far, so that energy that comes and goes does not make the
    // error large where there is little. What it has may be more, when heat of an equation of state that counts from 0
    // becomes motion; but beyond ten times that it is energy out of nothing, which must not measure itself. Where next
    // to nothing happens, it is rounding that does.
    const double given = fmax(now->energy_scale, given_energy(world));
    const double has = energy->kinetic + fabs(energy->internal);
    const double scale = fmax(given, given > 0 ? fmin(has, MOST_GROWTH * given) : has);
    energy->reference = fmax(scale, world->ledger.rounding_energy * fmax(world->clock.steps, 1));
    energy->error_relative = energy->reference > 0 ? energy->error / energy->reference : 0;
}

// The paper's form of augury parks angular momentum in the affine velocity of boundary nodes.
static void add_contact_spin(const brunt_world *world, double angular[3]) {
    const brunt_contact_surface *s = &world->contact.surface;
    for (int32_t n = 0; s->affine && n < s->node_count; n++)
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            angular[k] += s->mass[n] * (s->affine[n][3 * j + i] - s->affine[n][3 * i + j]);
        }
}

// A whole circle has momentum and gets impulses along its axis only.
static void keep_axial(int component, brunt_momentum *momentum) {
    double *const all[] = {momentum->linear, momentum->linear_initial, momentum->linear_impulse};
    for (int q = 0; q < 3 && component != 1; q++) all[q][component] = 0;
    momentum->angular[component] = momentum->angular_initial[component] = momentum->angular_impulse[component] = 0;
}

void brunt_world_momentum(brunt_world *world, brunt_momentum *momentum) {
    const brunt_ledger *now = &world->ledger;
    memset(momentum, 0, sizeof *momentum);
    double linear_scale = now->scale_linear, angular_scale = now->scale_angular, linear_here = 0, angular_here = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_audit a = brunt_body_audit(&world->bodies.mpm[i]);
        for (int k = 0; k < 3; k++) momentum->linear[k] += a.linear[k], momentum->angular[k] += a.angular[k];
        linear_here += a.scale_linear;
        angular_here += a.scale_angular;
    }
    for (int i = 0; i < world->bodies.fem_count; i++) {
        brunt_fem_sums a = brunt_fem_audit(&world->bodies.fem[i]);
        for (int k = 0; k < 3; k++) momentum->linear[k] += a.momentum[k], momentum->angular[k] += a.angular[k];
        linear_here += a.scale_linear;
        angular_here += a.scale_angular;
    }
    add_contact_spin(world, momentum->angular);
    // Impulses that cancel, such as weight and support, still set the scale of what rounding may do.
    double linear = 0, angular = 0, impulse = 0, turn = 0;
    for (int k = 0; k < 3; k++) {
        momentum->linear_initial[k] = now->linear_initial[k];
        momentum->angular_initial[k] = now->angular_initial[k];
        momentum->linear_impulse[k] = now->gravity_impulse[k] + now->damping.impulse[k];
        momentum->angular_impulse[k] = now->gravity_angular[k] + now->damping.angular[k];
        impulse += fabs(now->gravity_impulse[k]) + fabs(now->damping.impulse[k]);
        turn += fabs(now->gravity_angular[k]) + fabs(now->damping.angular[k]);
        for (int w = 0; w < world->boundaries.wall_count; w++) {
            const brunt_impulse_account *action = &world->boundaries.walls[w].action;
            momentum->linear_impulse[k] += action->impulse[k];
            momentum->angular_impulse[k] += action->angular[k];
            impulse += fabs(action->impulse[k]);
            turn += fabs(action->angular[k]);
        }
        if (world->settings.axisymmetric) keep_axial(k, momentum);
        for (int i = 0; i < world->bodies.count && world->erosion.active; i++) {
            const brunt_eroded *eroded = &world->erosion.account[i];
            momentum->linear_impulse[k] -= eroded->momentum[k];
            momentum->angular_impulse[k] -= eroded->angular[k];
            impulse += fabs(eroded->momentum[k]);
            turn += fabs(eroded->angular[k]);
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

static void bound(const double x[3], brunt_body_sums *sums) {
    for (int a = 0; a < 3; a++) sums->low[a] = fmin(sums->low[a], x[a]), sums->high[a] = fmax(sums->high[a], x[a]);
}

static void bound_body(const brunt_world *world, const brunt_body_ref *body, brunt_body_sums *sums) {
    for (int a = 0; a < 3; a++) {
        bool there = a < world->settings.dimension;
        sums->low[a] = there ? INFINITY : 0, sums->high[a] = there ? -INFINITY : 0;
    }
    for (int32_t n = 0; body->fem && n < body->fem->node_count; n++) {
        if (body->fem->element_count && brunt_fem_removed(body->fem, n)) continue;
        const real *node = brunt_fem_node(body->fem, n);
        bound((const double[3]){(double)node[0], (double)node[1], (double)node[2]}, sums);
    }
    for (int64_t s = 0; body->mpm && s < body->mpm->particles.slots; s++) {
        real *const *x = brunt_field(&body->mpm->particles, BRUNT_FIELD_position);
        if (body->mpm->particles.id[s] < 0) continue; // padding, or left in the last step
        bound((const double[3]){(double)x[0][s], (double)x[1][s], world->settings.dimension == 3 ? (double)x[2][s] : 0},
              sums);
    }
}

void brunt_body_totals(brunt_world *world, int32_t index, brunt_body_sums *sums) {
    const brunt_body_ref body = world->bodies.all[index];
    if (body.fem) {
        brunt_fem_sums a = brunt_fem_audit(body.fem);
        brunt_point_energy e = brunt_fem_energy(body.fem);
        *sums = (brunt_body_sums){.mass = a.mass, .kinetic = a.kinetic, .internal = e.internal, .plastic = e.plastic};
        for (int k = 0; k < 3; k++) {
            sums->momentum[k] = a.momentum[k];
            sums->centre[k] = a.first_moment[k] / a.mass;
            sums->velocity[k] = a.momentum[k] / a.mass;
        }
        bound_body(world, &world->bodies.all[index], sums);
        return;
    }
    brunt_audit a = brunt_body_audit(body.mpm);
    brunt_point_energy e = brunt_body_energy(body.mpm);
    *sums = (brunt_body_sums){.mass = a.mass, .kinetic = a.kinetic, .internal = e.internal, .plastic = e.plastic};
    for (int k = 0; k < 3; k++) {
        sums->momentum[k] = a.linear[k];
        sums->centre[k] = a.centre[k];
        sums->velocity[k] = a.mass > 0 ? a.linear[k] / a.mass : 0;
    }
    bound_body(world, &world->bodies.all[index], sums);
}
