// What barriers and friction did in an implicit step: energy stored, heat, forces of pairs and planes, gaps.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "contact/barrier/barrier_function.h"
#include "scheme/implicit.h"

static double dot(const struct brunt_implicit *m, const double *a, const double *b) {
    double sum = 0;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) sum += a[k] * b[k];
    return sum;
}

// Energy of the terms at u, and their gradient in `field.step`.
static int evaluate(const struct brunt_implicit *m, int first, int end, const double *u, double *energy,
                    brunt_error *error) {
    *energy = 0;
    for (int t = first; t < end; t++) {
        const brunt_term *term = &m->term[t];
        if (term->ops->look && term->ops->look(term->self, &m->team, u, NULL, error)) return BRUNT_FAILED;
        if (term->ops->energy) *energy += term->ops->energy(term->self, &m->team, u).value;
    }
    brunt_implicit_gradient(m, first, end, u, m->field.step);
    return BRUNT_OK;
}

static void add_weighed(const struct brunt_implicit *m, double weight, double *total) {
    for (int64_t k = 0; total && k < brunt_implicit_components(m); k++) total[k] += weight * m->field.step[k];
}

int brunt_implicit_sums(const struct brunt_implicit *m, int first, int end, double *total, brunt_term_sums *sums,
                        brunt_error *error) {
    const brunt_fields *f = &m->field;
    const double gamma = m->weights.gamma, work = m->weights.work;
    *sums = (brunt_term_sums){.work = 0};
    memset(f->zero, 0, (size_t)brunt_implicit_components(m) * sizeof *f->zero);
    brunt_implicit_ask(m, BRUNT_TRIAL_START);
    if (evaluate(m, first, end, f->zero, &sums->before, error)) return BRUNT_FAILED;
    if (work < 1) {
        sums->work = (1 - work) * dot(m, f->step, f->u);
        add_weighed(m, 1 - gamma, total);
    }
    brunt_implicit_ask(m, BRUNT_TRIAL_ACCOUNT);
    if (evaluate(m, first, end, f->u, &sums->after, error)) return BRUNT_FAILED;
    sums->work += work * dot(m, f->step, f->u);
    add_weighed(m, gamma, total);
    return BRUNT_OK;
}

static void add_to_gradient(const struct brunt_implicit *m) {
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) m->field.gradient[k] += m->field.step[k];
}

// Energy that the barriers hold; what the integrator takes of it.
static int account_barrier(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    brunt_term_sums sums;
    if (brunt_implicit_sums(m, m->body_terms, m->body_terms + 1, m->field.contact, &sums, error)) return BRUNT_FAILED;
    if (world->clock.steps == 0) { // bodies that start near each other
        world->ledger.initial_energy += sums.before;
        world->ledger.barrier_initial = sums.before;
    }
    world->ledger.scheme += sums.work - (sums.after - sums.before);
    world->ledger.barrier = sums.after;
    add_to_gradient(m);
    return BRUNT_OK;
}

// Forces of friction at u, `weight` of them.
static int add_friction(struct brunt_implicit *m, const double *u, double weight, brunt_error *error) {
    const int at = m->body_terms + 1;
    double energy;
    if (evaluate(m, at, at + 1, u, &energy, error)) return BRUNT_FAILED;
    add_weighed(m, weight, m->field.contact);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ forces

// At the start of the step, by what pressed there, whatever friction has followed since: normal forces and friction at
// the velocities there. `before` is the displacement at which friction takes the velocities at the start for those at
// the end.
static int weigh_start(struct brunt_implicit *m, brunt_error *error) {
    brunt_implicit_contact *c = &m->contact;
    const double start = 1 - m->weights.gamma;
    brunt_barrier_report unused;
    if (m->rubs &&
        (brunt_barrier_lag(c->barrier, &m->team, m->field.zero, error) || add_friction(m, c->before, start, error)))
        return BRUNT_FAILED;
    for (int friction = 0; friction < 2; friction++) {
        const double *u = friction ? c->before : m->field.zero;
        if (brunt_barrier_look_back(c->barrier, &m->team, u, m->field.u, &unused, &c->forces_before, error) ||
            brunt_barrier_forces_extend(&c->forces, c->forces_before.count, error))
            return BRUNT_FAILED;
        brunt_barrier_force *force = c->forces.force;
        for (int32_t k = 0; k < c->forces_before.count; k++) {
            const brunt_barrier_force *before = &c->forces_before.force[k];
            for (int a = 0; a < 3; a++)
                *(friction ? &force[k].friction[a] : &force[k].normal[a]) +=
                    start * (friction ? before->friction[a] : before->normal[a]);
            if (friction) force[k].heat += start * before->heat;
        }
    }
    return BRUNT_OK;
}

// Of load steps, whose work is by the trapezium: what planes do work with, in forces_before, and the heat of friction.
// Then what friction keeps for the next step.
static int weigh_work(struct brunt_implicit *m, brunt_error *error) {
    brunt_implicit_contact *c = &m->contact;
    const double work = m->weights.work;
    brunt_barrier_report unused;
    if (m->rubs && brunt_barrier_lag(c->barrier, &m->team, m->field.zero, error)) return BRUNT_FAILED;
    if (brunt_barrier_look_back(c->barrier, &m->team, m->field.zero, m->field.u, &unused, &c->forces_before, error) ||
        brunt_barrier_forces_extend(&c->forces, c->forces_before.count, error))
        return BRUNT_FAILED;
    for (int32_t k = 0; k < c->forces_before.count; k++) {
        brunt_barrier_force *before = &c->forces_before.force[k], *after = &c->forces.force[k];
        after->heat = (1 - work) * before->heat + work * after->heat;
        for (int a = 0; a < 3; a++) {
            before->normal[a] = (1 - work) * before->normal[a] + work * after->normal[a];
            before->friction[a] = (1 - work) * before->friction[a] + work * after->friction[a];
        }
    }
    return brunt_barrier_keep(c->barrier, &m->team, m->field.u, error);
}

static int tell_tractions(struct brunt_implicit *m, brunt_error *error) {
    brunt_implicit_contact *c = &m->contact;
    if (brunt_barrier_tell(c->barrier, (const double(*)[3])c->rest, m->field.u, &c->tractions, error))
        return BRUNT_FAILED;
    for (int32_t i = 0; i < c->tractions.count; i++) {
        brunt_traction *one = &c->tractions.traction[i];
        if (one->boundary >= 0) one->boundary = c->plane_boundary[one->boundary];
    }
    return BRUNT_OK;
}

// Of pairs and planes, and the heat of friction over the step's way, weighed as the integrator does. What is at the end
// comes first, since the start wants friction as it was there.
static int weigh_forces(struct brunt_implicit *m, brunt_barrier_report *report, brunt_error *error) {
    brunt_implicit_contact *c = &m->contact;
    const double gamma = m->weights.gamma;
    if (m->rubs) {
        if (add_friction(m, m->field.u, gamma, error)) return BRUNT_FAILED;
        add_to_gradient(m);
    }
    if (brunt_barrier_look_back(c->barrier, &m->team, m->field.u, m->field.u, report, &c->forces, error))
        return BRUNT_FAILED;
    if (c->tells && tell_tractions(m, error)) return BRUNT_FAILED;
    if (m->still) return weigh_work(m, error);
    if (gamma == 1) return BRUNT_OK;
    for (int32_t k = 0; k < c->forces.count; k++) {
        brunt_barrier_force *force = &c->forces.force[k];
        force->heat *= gamma;
        for (int a = 0; a < 3; a++) force->normal[a] *= gamma, force->friction[a] *= gamma;
    }
    return weigh_start(m, error);
}

// Moments of all planes together: pairs have none.
static void account_moments(const struct brunt_implicit *m, brunt_impulse_account *last) {
    const brunt_unknowns *u = &m->unknowns;
    brunt_impulse_account moments = {.area = 0};
    for (int32_t n = 0; n < u->count; n++) {
        brunt_weighed_force F = {.work = {0}};
        for (int a = 0; a < u->dim; a++) F.impulse[a] = -m->field.contact[n * (int64_t)u->dim + a];
        if (u->mass[n] > 0) brunt_implicit_account_force(m, &moments, n, &F);
    }
    for (int a = 0; a < 3; a++) last->angular[a] += moments.angular[a];
}

static void account_forces(brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_implicit_contact *c = &m->contact;
    int32_t pairs;
    const brunt_barrier_pair *pair = brunt_barrier_pairs(c->barrier, &pairs);
    for (int32_t p = 0; p < pairs; p++) {
        brunt_impulse_account *last = &world->pairs.pair[pair[p].account].last;
        const brunt_barrier_force *force = &c->forces.force[c->plane_count + p];
        for (int a = 0; a < 3; a++) last->impulse[a] -= m->dt * (force->normal[a] + force->friction[a]);
        last->friction_loss += force->heat;
        last->area += force->area;
    }
    for (int32_t q = 0; q < c->plane_count; q++) {
        brunt_boundary *boundary = &world->boundaries.boundary[c->plane_boundary[q]];
        const brunt_barrier_force *force = &c->forces.force[q],
                                  *working = m->still ? &c->forces_before.force[q] : force;
        boundary->last.friction_loss += force->heat;
        boundary->last.area = force->area;
        for (int a = 0; a < 3; a++) {
            const double F = force->normal[a] + force->friction[a];
            boundary->last.impulse[a] += m->dt * F;
            boundary->last.external_work +=
                m->dt * (working->normal[a] + working->friction[a]) * boundary->plane.velocity[a];
        }
    }
    if (c->plane_count) account_moments(m, &world->boundaries.boundary[c->plane_boundary[0]].last);
}

static const double DEEP = 0.5; // what is left of the way that surfaces may overlap by

// A gap that is next to nothing says that the barrier is too soft for what presses.
static void warn_of_gap(brunt_world *world, const brunt_barrier_report *report) {
    if (world->clock.gap_told || !(report->least_part < INFINITY) || report->body < 0) return;
    if (!(report->overlaps ? report->least_part < DEEP : brunt_barrier_gap_is_small(report->least_part, 1))) return;
    world->clock.gap_told = 1;
    if (report->overlaps) {
        brunt_warn(
            &world->messages,
            "bodies.%s: at t = %.4g s %s is %.3g m deep in it, at (%.4g, %.4g, %.4g) m, %.2g of the half edge that "
            "it may be: contact.penalty is low for what presses there",
            brunt_body_name(world, report->body), world->clock.time,
            report->other < 0 ? "a plane" : brunt_body_name(world, report->other), -report->least_gap,
            report->position[0], report->position[1], report->position[2], 1 - report->least_part);
        return;
    }
    brunt_warn(&world->messages,
               "bodies.%s: at t = %.4g s the gap to %s has become %.2g of contact.distance, at (%.4g, %.4g, %.4g) m: "
               "contact.stiffness is low for what presses there",
               brunt_body_name(world, report->body), world->clock.time,
               report->other < 0 ? "a plane" : brunt_body_name(world, report->other), report->least_part,
               report->position[0], report->position[1], report->position[2]);
}

// Newmark's rule keeps what swings faster than its steps follow: gaps chatter, and pressures with them.
static void warn_of_chatter(brunt_world *world, const brunt_barrier_stiffest *stiff) {
    const struct brunt_implicit *m = world->plan.implicit;
    if (world->clock.chatter_told || !(m->dt > stiff->step)) return;
    world->clock.chatter_told = 1;
    brunt_warn(&world->messages,
               "bodies.%s: at t = %.4g s Newmark's step of %.3g s is too long to follow the barrier to %s, at (%.4g, "
               "%.4g, %.4g) m: gaps and pressures there swing from step to step; below %.2g s, less contact.stiffness "
               "or time.integrator: euler is wanted",
               brunt_body_name(world, stiff->body), world->clock.time, m->dt,
               stiff->other < 0 ? "a plane" : brunt_body_name(world, stiff->other), stiff->position[0],
               stiff->position[1], stiff->position[2], stiff->step);
}

int brunt_implicit_account_contact(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    brunt_barrier_report report;
    memset(m->field.contact, 0, (size_t)brunt_implicit_components(m) * sizeof *m->field.contact);
    if (account_barrier(world, error) || weigh_forces(m, &report, error)) return BRUNT_FAILED;
    account_forces(world);
    m->tried.least_gap = report.least_gap, m->tried.least_part = report.least_part;
    warn_of_gap(world, &report);
    warn_of_chatter(world, &report.stiffest);
    return BRUNT_OK;
}
