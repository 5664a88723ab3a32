// What an implicit step did: velocities at its end, work and impulses of all that acts, what the integrator takes.
//
// With M dv = dt F + J (F: forces as the integrator weighs them, J: what holders gave) and the mean velocity
// v_m = (v + v_end) / 2 the kinetic energy grows by M dv . v_m, exactly. Places move by u = dt v_m + w, where Newmark's
// w is 0 and backward Euler's is dt dv / 2. Hence, exactly,
//   kinetic energy + stored energies + [ M dv . w / dt + F_stored . u - (change of stored) ] = loads . u + J . u / dt
// and the bracket is what the integrator has taken: of backward Euler never negative where energies are convex.
#include <math.h>
#include <string.h>

#include "boundary/gravity.h"
#include "scheme/implicit.h"

// ------------------------------------------------------------------------------------------ velocities

static void end_velocities(const struct brunt_implicit *m) {
    const brunt_unknowns *unknowns = &m->unknowns;
    const brunt_fields *f = &m->field;
    const double dt = m->dt, gamma = m->weights.gamma, inverse = 1 / m->inertia.c;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) {
        const double before = (1 - gamma) * f->acceleration[k], after = gamma * inverse * (f->u[k] - f->aim[k]);
        f->v[k] = unknowns->held[k] ? unknowns->end[k] : unknowns->velocity[k] + dt * (before + after);
    }
}

// Kinetic energies of the grids, and what backward Euler takes of all.
static double account_kinetic(const struct brunt_implicit *m, brunt_step *step) {
    const brunt_unknowns *u = &m->unknowns;
    double taken = 0;
    step->old_kinetic = step->new_kinetic = 0;
    for (int32_t n = 0; n < u->count; n++)
        for (int64_t k = n * (int64_t)u->dim; k < (n + 1) * (int64_t)u->dim; k++) {
            const double v = u->velocity[k], end = m->field.v[k];
            taken += u->mass[n] * (end - v) * (m->field.u[k] / m->dt - 0.5 * (v + end));
            if (n < u->mesh_count) continue;
            step->old_kinetic += 0.5 * u->mass[n] * v * v;
            step->new_kinetic += 0.5 * u->mass[n] * end * end;
        }
    return taken;
}

// ------------------------------------------------------------------------------------------ loads

void brunt_implicit_moment_arm(const struct brunt_implicit *m, int32_t n, double x[3]) {
    const int dim = m->unknowns.dim;
    for (int a = 0; a < 3; a++)
        x[a] = a < dim
                   ? m->unknowns.position[n * (int64_t)dim + a] + m->weights.moment * m->field.u[n * (int64_t)dim + a]
                   : 0;
}

static void account_gravity(brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    const double gamma = m->weights.gamma, work = m->weights.work;
    double before[3], after[3], gravity[3], working[3], x[3];
    brunt_gravity_at(&world->settings, world->clock.time, before);
    brunt_gravity_at(&world->settings, world->clock.time + m->dt, after);
    for (int a = 0; a < 3; a++) {
        gravity[a] = (1 - gamma) * before[a] + gamma * after[a];
        working[a] = (1 - work) * before[a] + work * after[a];
    }
    for (int32_t n = 0; n < u->count; n++) {
        brunt_implicit_moment_arm(m, n, x);
        for (int a = 0; a < 3; a++) {
            const int i = (a + 1) % 3, j = (a + 2) % 3;
            if (a < u->dim) world->ledger.gravity_work += u->mass[n] * working[a] * m->field.u[n * (int64_t)u->dim + a];
            world->ledger.gravity_impulse[a] += m->dt * u->mass[n] * gravity[a];
            world->ledger.gravity_angular[a] += m->dt * u->mass[n] * (x[i] * gravity[j] - x[j] * gravity[i]);
        }
    }
}

// A force on a node over the step, of a boundary's account.
void brunt_implicit_account_force(const struct brunt_implicit *m, brunt_impulse_account *last, int32_t n,
                                  const brunt_weighed_force *weighed) {
    const double *F = weighed->impulse;
    double x[3];
    brunt_implicit_moment_arm(m, n, x);
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        last->impulse[a] += m->dt * F[a];
        last->angular[a] += m->dt * (x[i] * F[j] - x[j] * F[i]);
        if (a < m->unknowns.dim) last->external_work += weighed->work[a] * m->field.u[n * (int64_t)m->unknowns.dim + a];
    }
}

// Loads on groups of nodes, as they are made for one end of the step.
static void account_groups(brunt_world *world, double impulse, double work) {
    const struct brunt_implicit *m = world->plan.implicit;
    for (int k = 0; k < world->boundaries.sets.count; k++) {
        const brunt_node_set *set = &world->boundaries.sets.set[k];
        for (int32_t i = 0; set->force && i < set->node_count; i++) {
            const double *force = set->force + 3 * (size_t)i;
            const brunt_weighed_force F = {.impulse = {impulse * force[0], impulse * force[1], impulse * force[2]},
                                           .work = {work * force[0], work * force[1], work * force[2]}};
            brunt_implicit_account_force(m, &set->boundary->last, m->unknowns.base[set->fem_index] + set->node[i], &F);
        }
    }
}

// ------------------------------------------------------------------------------------------ holders

// Whether a component is held at rest by a plane of symmetry, or one that sticks and has images.
static bool rests(const brunt_boundaries *boundaries, const brunt_unknowns *u, int64_t k) {
    return boundaries->boundary[u->holder[k] - 1].symmetry_plane >= 0;
}

// A force of those planes on component k, which does no work, in equal parts.
static void bear(brunt_world *world, int64_t k, double force) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    const brunt_boundaries *all = &world->boundaries;
    brunt_weighed_force F = {.work = {0}};
    F.impulse[k % u->dim] = brunt_unknowns_bearers(u, k) * force;
    for (int p = 0; p < all->symmetry_count; p++)
        if (u->images.bearers[k] >> p & 1)
            brunt_implicit_account_force(m, &all->boundary[all->symmetry[p].boundary].last, (int32_t)(k / u->dim), &F);
}

// A force of what holds component k, F along that alone: of an image it acts where that is which it is an image of, and
// planes bear the rest.
static void hold(brunt_world *world, int64_t k, const brunt_weighed_force *F) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    const int a = (int)(k % u->dim);
    const int32_t n = (int32_t)(k / u->dim), front = u->images.any ? u->images.front[n] : n;
    brunt_weighed_force there = *F;
    if (front != n) {
        const double sign = brunt_unknowns_image_sign(u, k);
        there.impulse[a] *= sign, there.work[a] *= sign;
        bear(world, k, F->impulse[a]), bear(world, front * (int64_t)u->dim + a, -there.impulse[a]);
    }
    brunt_implicit_account_force(m, &world->boundaries.boundary[u->holder[k] - 1].last, front, &there);
}

// What holders and symmetry planes gave: what is missing of M dv = dt F. `field.gradient` holds that of all forces but
// loads at the end.
static void account_holders(brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    const brunt_fields *f = &m->field;
    const double gamma = m->weights.gamma, work = m->weights.work, *v = brunt_implicit_velocity(m);
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) {
        // What holds by images rests there.
        const bool borne = u->images.any && u->images.bearers[k] && (!u->held[k] || rests(&world->boundaries, u, k));
        if (!u->holder[k] && !borne) continue;
        const int a = (int)(k % u->dim);
        const double after = f->load[k] - f->gradient[k], before = work < 1 ? f->force_before[k] : 0;
        const double inertia = u->mass[k / u->dim] * (v[k] - u->velocity[k]) / m->dt;
        brunt_weighed_force F = {.work = {0}};
        F.impulse[a] = inertia - (1 - gamma) * before - gamma * after;
        if (borne) {
            bear(world, k, F.impulse[a]);
            continue;
        }
        F.work[a] = inertia - (1 - work) * before - work * after;
        hold(world, k, &F);
    }
}

// ------------------------------------------------------------------------------------------ the step

int brunt_implicit_account(brunt_world *world, brunt_step *step, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_fields *f = &m->field;
    const double gamma = m->weights.gamma, work = m->weights.work;
    brunt_term_sums bodies;
    if (!m->still) {
        end_velocities(m);
        world->ledger.scheme += account_kinetic(m, step);
    }
    if (brunt_implicit_sums(m, m->fixed_terms, m->body_terms, NULL, &bodies, error)) return BRUNT_FAILED;
    world->ledger.scheme += bodies.work - (bodies.after - bodies.before);
    if (brunt_implicit_take_turns(m, f->step, error)) return BRUNT_FAILED;
    memcpy(f->gradient, f->step, (size_t)brunt_implicit_components(m) * sizeof *f->gradient);
    if (m->contact.barrier && brunt_implicit_account_contact(world, error)) return BRUNT_FAILED;
    if (m->holds) brunt_implicit_account_surfaces(world);
    if (world->settings.has_gravity) account_gravity(world);
    account_groups(world, gamma, work);
    brunt_implicit_account_drag(world);
    account_holders(world);
    if (work < 1 && world->boundaries.sets.count) {
        brunt_loads_begin(&world->boundaries.sets, &world->bodies, world->clock.time, 0);
        account_groups(world, 1 - gamma, 1 - work);
    }
    if (!m->still) return BRUNT_OK;
    brunt_static_take_balance(m);
    brunt_static_settle(world);
    brunt_static_watch(world, bodies.work - (bodies.after - bodies.before), bodies.work);
    return BRUNT_OK;
}
