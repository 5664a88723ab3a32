// One implicit step: how it would go on, Newton's method, and shorter steps where that does not converge.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "scheme/implicit.h"

static const double ROUGHLY = 1e-2; // of the forces that act: what a solution leaves that is looked at alone

// ------------------------------------------------------------------------------------------ the aim

void brunt_implicit_ask(const struct brunt_implicit *m, brunt_trial_part part) {
    const brunt_trial_rule rule = {.part = part, .start = (real)(1 - m->weights.gamma)};
    for (int k = 0; k < m->world->bodies.fem_count; k++) brunt_fem_potential_ask(m->fem[k], rule);
    for (int i = 0; i < m->world->bodies.mpm_count; i++) brunt_mpm_potential_ask(m->mpm[i], rule);
}

// Forces at the start, of the grid and the loads there.
static void take_forces(brunt_world *world) {
    struct brunt_implicit *m = world->plan.implicit;
    brunt_fields *f = &m->field;
    brunt_implicit_loads(world, world->clock.time, f->force_before);
    brunt_implicit_drag_before(m, f->force_before);
    const int friction = m->term_count - m->rubs; // of the velocities at the start: see barrier.h
    brunt_implicit_ask(m, BRUNT_TRIAL_START);
    brunt_implicit_gradient(m, m->fixed_terms, friction, f->u, f->gradient);
    brunt_implicit_ask(m, BRUNT_TRIAL_END);
    brunt_implicit_gradient(m, friction, m->term_count, m->still ? f->u : m->contact.before, f->step);
    if (m->holds) brunt_implicit_surfaces_before(m, 1, f->force_before);
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) f->force_before[k] -= f->gradient[k] + f->step[k];
}

// Accelerations at the start, by the forces there. Those of components that are held are their holder's: 0 here.
static void take_acceleration(struct brunt_implicit *m) {
    brunt_fields *f = &m->field;
    memset(f->acceleration, 0, (size_t)brunt_implicit_components(m) * sizeof *f->acceleration);
    if (m->weights.gamma == 1) return; // backward Euler asks for none
    brunt_unknowns_accelerate(&m->unknowns, f->force_before, f->acceleration);
}

static void take_aim(struct brunt_implicit *m) {
    const brunt_weights *w = &m->weights;
    const double dt = m->dt, drift = w->alpha * (1 - 2 * w->beta) * dt * dt;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        m->field.aim[k] = dt * m->unknowns.velocity[k] + drift * m->field.acceleration[k];
    m->inertia.c = 2 * w->alpha * w->beta * dt * dt;
    brunt_implicit_drag_aim(m);
}

static int begin_try(brunt_world *world, double dt, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const size_t bytes = (size_t)brunt_implicit_components(m) * sizeof(double);
    m->dt = dt;
    brunt_implicit_ask(m, BRUNT_TRIAL_END);
    brunt_unknowns_hold(&m->unknowns, world, dt);
    for (int k = 0; k < world->bodies.fem_count; k++) brunt_fem_potential_step(m->fem[k], dt);
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (brunt_mpm_potential_step(m->mpm[i], &m->team, m->unknowns.number[i], dt, error)) return BRUNT_FAILED;
    memset(m->field.u, 0, bytes);
    if (m->holds && brunt_implicit_surfaces_begin(world, dt, error)) return BRUNT_FAILED;
    const double gamma = m->weights.gamma;
    const brunt_contact_rule rule = {
        .dt = m->still ? 1 : dt, .factor = gamma / (2 * m->weights.alpha * m->weights.beta), .rest = m->field.u};
    if (brunt_implicit_contact_begin(&m->contact, world, &m->unknowns, &m->team, &rule, error)) return BRUNT_FAILED;
    for (int t = 0; t < m->term_count; t++)
        if (m->term[t].ops->look && m->term[t].ops->look(m->term[t].self, &m->team, m->field.u, NULL, error))
            return BRUNT_FAILED;
    if (m->weights.work < 1) take_forces(world);
    brunt_implicit_loads(world, world->clock.time + dt, m->field.load);
    if (m->still) return brunt_static_begin(world, error);
    take_acceleration(m);
    take_aim(m);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ Newton's method

static void count(struct brunt_implicit *m, const brunt_newton_report *report) {
    brunt_newton_counts *c = &m->tried;
    c->iterations += report->iterations;
    c->halvings += report->halvings;
    c->projections += report->projections;
    c->linear_iterations += report->linear_iterations;
    c->factorisations += report->factorisations;
    c->residual = m->still ? report->unbalance : report->step;
}

static brunt_problem problem_of(struct brunt_implicit *m) {
    const bool condensed = m->condensation.count > 0 && !brunt_unknowns_fold(&m->unknowns);
    return (brunt_problem){.dim = m->unknowns.dim,
                           .nodes = m->unknowns.count,
                           .terms = m->term,
                           .count = m->term_count,
                           .held = m->unknowns.held,
                           .fold = brunt_unknowns_fold(&m->unknowns),
                           .condensed = condensed ? &m->condensation : NULL,
                           .forces = m->forces};
}

// From u to a minimum near it, with what is held where it is.
static int minimise(struct brunt_implicit *m, brunt_newton_report *report, brunt_error *error) {
    const brunt_problem problem = problem_of(m);
    const int status = brunt_newton_minimise(&m->newton, &m->team, &problem, &m->options, m->field.u, report, error);
    count(m, report);
    return status;
}

// The way of held components to where they are to be in field.step, nothing of all others; its greatest component.
static double way_left(const struct brunt_implicit *m) {
    const brunt_unknowns *unknowns = &m->unknowns;
    const brunt_fields *f = &m->field;
    double most = 0;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) {
        f->step[k] = unknowns->held[k] ? unknowns->target[k] - f->u[k] : 0;
        most = fmax(most, fabs(f->step[k]));
    }
    return most;
}

// How much of field.step can be gone without that something is turned inside out or touched.
static int free_part(const struct brunt_implicit *m, double *part, brunt_error *error) {
    const brunt_fields *f = &m->field;
    double way = 1;
    for (int t = 0; t < m->term_count; t++) {
        const brunt_term *term = &m->term[t];
        if (term->ops->look && term->ops->look(term->self, &m->team, f->u, f->step, error)) return BRUNT_FAILED;
    }
    for (int t = 0; t < m->term_count; t++)
        if (m->term[t].ops->limit)
            way = fmin(way, m->term[t].ops->limit(m->term[t].self, &m->team, f->u, f->step, way));
    *part = way;
    return BRUNT_OK;
}

// How far of the way to where they are to be the held components can go while all others stay.
static int free_way(const struct brunt_implicit *m, double *way, brunt_error *error) {
    *way = 1;
    return way_left(m) == 0 ? BRUNT_OK : free_part(m, way, error);
}

static double energy_of(const struct brunt_implicit *m, const double *u) {
    double sum = 0;
    for (int t = 0; t < m->term_count; t++) sum += m->term[t].ops->energy(m->term[t].self, &m->team, u).value;
    return sum;
}

// Towards field.gradient, of which `part` can be gone at once, as near as nothing is lost inside of another, and as it
// leads down: what slides far along a surface is looked for anew on its way, and what was apart, so that nothing joined
// it, flies into what is there.
static int go_in_parts(struct brunt_implicit *m, double part, brunt_error *error) {
    enum { PARTS = 16 };
    const brunt_fields *f = &m->field;
    const int64_t count = brunt_implicit_components(m);
    double least = energy_of(m, f->u);
    for (int i = 0; i < PARTS; i++) {
        memcpy(f->pull, f->u, (size_t)count * sizeof *f->u);
        for (int64_t k = 0; k < count; k++) f->u[k] += part * f->step[k];
        const double energy = energy_of(m, f->u);
        if (!(energy <= least)) {
            memcpy(f->u, f->pull, (size_t)count * sizeof *f->u);
            break;
        }
        least = energy;
        if (part == 1) break;
        for (int64_t k = 0; k < count; k++) f->step[k] = f->gradient[k] - f->u[k];
        if (free_part(m, &part, error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

// Begins where held components are at their places and all others where the matrix at the start takes them, if that can
// be gone to: what is drawn or turned by its end follows, instead of being torn first. In the first load step with what
// touches joined: nothing presses yet that would hold it.
static int lead(struct brunt_implicit *m, bool joined, brunt_error *error) {
    const brunt_fields *f = &m->field;
    const bool drawn = way_left(m) > 0;
    brunt_problem problem = problem_of(m);
    if (drawn) problem.condensed = NULL; // ways of what is held are of the whole matrix
    brunt_newton_way way = {.way = f->step, .p = f->gradient};
    brunt_error vain = {.id = -1};
    if (!joined && !(m->leads && drawn)) return BRUNT_OK;
    if (joined) brunt_barrier_join(m->contact.barrier, true);
    const int status = brunt_newton_lead(&m->newton, &m->team, &problem, &m->options, f->u, &way, &vain);
    if (joined) brunt_barrier_join(m->contact.barrier, false);
    m->tried.factorisations += way.factorisations;
    if (status) return BRUNT_OK;
    double part;
    memcpy(f->step, f->gradient, (size_t)brunt_implicit_components(m) * sizeof *f->step);
    if (free_part(m, &part, error)) return BRUNT_FAILED;
    if (drawn && part < 1) return BRUNT_OK; // held components go all the way
    if (!drawn) return go_in_parts(m, part, error);
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        f->u[k] = m->unknowns.held[k] ? m->unknowns.target[k] : f->step[k];
    return BRUNT_OK;
}

// Square of the length of the gradient, of what is free; by the room of `pull`, which is not under way.
static double gradient_square(const struct brunt_implicit *m, const double *u) {
    const brunt_fold *fold = brunt_unknowns_fold(&m->unknowns);
    double *g = m->field.pull, square = 0;
    brunt_implicit_gradient(m, 0, m->term_count, u, g);
    if (fold) brunt_fold_gather(fold, m->unknowns.dim, g);
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) square += m->unknowns.held[k] ? 0 : g[k] * g[k];
    return square;
}

// Whether a place is nearer to the end of the step than another: by energy, or by forces where there is none.
static bool is_nearer(const struct brunt_implicit *m, const double *u, const double *other) {
    return m->forces ? gradient_square(m, u) < gradient_square(m, other) : energy_of(m, u) < energy_of(m, other);
}

// Begins where held components are at their places and all others where their velocities take them, if nothing is in
// the way and that is nearer to the end than with those others at rest, or held components cannot go there alone. What
// slides on, or sticks to what is moved, then begins with its slip, not with that of all bodies at once.
static int coast(struct brunt_implicit *m, brunt_error *error) {
    const brunt_fields *f = &m->field;
    const int64_t count = brunt_implicit_components(m);
    double way, part;
    // Load steps have no velocities; tractions that are searched for have no energy.
    if (m->still || (m->holds && !m->forces)) return BRUNT_OK;
    if (free_way(m, &way, error)) return BRUNT_FAILED;
    for (int64_t k = 0; k < count; k++)
        f->step[k] = m->unknowns.held[k] ? m->unknowns.target[k] : m->dt * m->unknowns.velocity[k];
    if (free_part(m, &part, error)) return BRUNT_FAILED;
    if (part < 1) return BRUNT_OK;
    for (int64_t k = 0; k < count; k++) f->gradient[k] = m->unknowns.held[k] ? m->unknowns.target[k] : 0;
    if (way == 1 && !is_nearer(m, f->step, f->gradient)) return BRUNT_OK;
    memcpy(f->u, f->step, (size_t)count * sizeof *f->u);
    return BRUNT_OK;
}

// Weights of held components that are not where they are to be: `heavy` times their inertia, or of what has no mass
// that of the heaviest node; in load steps times the stiffness of nodes. Those are free until they are let go.
static void pull(struct brunt_implicit *m, double heavy) {
    const brunt_unknowns *unknowns = &m->unknowns;
    double heaviest = 0;
    for (int32_t n = 0; n < unknowns->count; n++) heaviest = fmax(heaviest, unknowns->mass[n]);
    for (int64_t k = 0; k < brunt_implicit_components(m); k++) {
        const double mass = unknowns->mass[k / unknowns->dim];
        const bool on_its_way = unknowns->held[k] && unknowns->target[k] != m->field.u[k];
        const double weight =
            m->still ? m->field.stiffness[k / unknowns->dim] : (mass > 0 ? mass : heaviest) / m->inertia.c;
        m->field.pull[k] = on_its_way ? heavy * weight : 0;
        if (on_its_way) unknowns->held[k] = 0;
    }
    m->pull.weight = m->field.pull;
}

static void let_go(struct brunt_implicit *m) {
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        if (m->field.pull[k] > 0) m->unknowns.held[k] = 1;
    m->pull.weight = NULL;
}

// Held components go to their places if nothing is in the way. Otherwise heavy weights draw them there, together with
// what they push, so that the energy of all that moves can be compared; what little is left is lost then.
static int go_and_minimise(struct brunt_implicit *m, brunt_newton_report *report, brunt_error *error) {
    enum { ROUND_LIMIT = 6 };
    double heavy = 1e7;
    for (int k = 0; k < ROUND_LIMIT; k++, heavy *= 10) {
        double way;
        if (free_way(m, &way, error)) return BRUNT_FAILED;
        if (way == 1) {
            for (int64_t q = 0; q < brunt_implicit_components(m); q++)
                if (m->unknowns.held[q]) m->field.u[q] = m->unknowns.target[q];
            return minimise(m, report, error);
        }
        pull(m, heavy);
        const int status = minimise(m, report, error);
        let_go(m);
        if (status) return status;
    }
    report->result = BRUNT_NEWTON_BLOCKED;
    return brunt_fail(error, BRUNT_FAILED, "prescribed motion finds no way");
}

// The passes of Newton's phases take over from one another.
static void follow_phase(void *context, brunt_newton_phase phase) {
    struct brunt_implicit *m = context;
    if (m->world->timing.pass == m->phase[phase]) return;
    brunt_pass_end(&m->world->timing, 0);
    brunt_pass_begin(&m->world->timing, m->phase[phase]);
    m->team.timer = brunt_pass_timer(&m->world->timing);
}

void brunt_implicit_follow(brunt_plan *plan) {
    static const char *const names[] = {"evaluate", "matrix", "factor", "solve", "sweeps", "limit", "search"};
    _Static_assert(BRUNT_COUNT(names) == BRUNT_NEWTON_PHASES, "a pass for each phase");
    struct brunt_implicit *m = plan->implicit;
    for (int p = 0; p < plan->pass_count; p++)
        for (int k = 0; k < BRUNT_NEWTON_PHASES; k++)
            if (!strcmp(plan->pass[p]->name, names[k])) m->phase[k] = p;
    m->options.phase = follow_phase;
    m->options.context = m;
}

// ------------------------------------------------------------------------------------------ the step

// What gives way first, where an equilibrium is none that lasts.
static int fail_unstable(brunt_world *world, const brunt_newton_report *report, const char *why, brunt_error *error) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    char reason[600];
    const bool known = report->weakest_dof >= 0;
    snprintf(
        reason, sizeof reason,
        "the equilibrium of the loads at %.6g is unstable, it buckles, snaps through or turns over%s; that at %.6g "
        "is stable (down to a part %.3g of a load step, newton.cut). Of the forces that act %.3g are left. %s",
        world->clock.time + m->dt, known ? ", here most" : "", world->clock.time, m->dt / world->settings.fixed_step,
        report->unbalance, why);
    if (!known) return brunt_fail_step(&world->clock, NULL, error, reason);
    const brunt_unknown_location at =
        brunt_unknowns_location(u, &world->bodies, (int32_t)(report->weakest_dof / u->dim));
    return brunt_fail_position(world, at.body, at.x, error, reason);
}

// Body, place and reason of a step that did not converge, the last of those that were tried in place of `wanted`.
static int fail_try(brunt_world *world, double wanted, const brunt_newton_report *report, brunt_error *error) {
    const struct brunt_implicit *m = world->plan.implicit;
    const int halved = (int)lround(log2(wanted / m->dt));
    char why[256], tried[64], reason[600];
    if (error && error->body[0]) return BRUNT_FAILED; // it has been said
    snprintf(why, sizeof why, "%.250s", error ? error->message : "");
    const int64_t dof = report->residual_dof;
    if (report->result == BRUNT_NEWTON_BAD_START) {
        snprintf(reason, sizeof reason, "it is flat or turned over where the step begins: %s", why);
        if (brunt_fail_turned(world, error, reason)) return BRUNT_FAILED;
    }
    if (report->result == BRUNT_NEWTON_UNSTABLE) return fail_unstable(world, report, why, error);
    if (dof < 0) return brunt_fail_step(&world->clock, NULL, error, why);
    if (m->still)
        snprintf(tried, sizeof tried, "a part %.4g of a load step", m->dt / world->settings.fixed_step);
    else
        snprintf(tried, sizeof tried, "a step of %.4g s", m->dt);
    const bool off = report->result == BRUNT_NEWTON_ITERATIONS && report->balance > 1;
    const int32_t n = off ? m->off.node : (int32_t)(dof / m->unknowns.dim);
    const brunt_unknown_location at = brunt_unknowns_location(&m->unknowns, &world->bodies, n);
    if (off)
        snprintf(
            reason, sizeof reason,
            "%s, halved %d times (newton.cut), does not converge: %s %.3g N are left of forces that add up to %.3g N "
            "(less contact.stiffness or contact.friction, or more contact.slip_speed, leaves less)",
            tried, halved, why, m->off.left, m->off.all);
    else
        snprintf(reason, sizeof reason,
                 "%s, halved %d times (newton.cut), does not converge: %s The greatest force left is %.3g N", tried,
                 halved, why, report->residual);
    brunt_implicit_surfaces_lack(world, reason, sizeof reason);
    return brunt_fail_position(world, at.body, at.x, error, reason);
}

// What may leave a surface, and friction there, settles over several minima: each is with the multipliers of the last.
static int settle(struct brunt_implicit *m, brunt_newton_report *report, brunt_error *error) {
    enum { ROUND_LIMIT = 60 };
    for (int k = 0; k < ROUND_LIMIT; k++) {
        if (!brunt_boundary_rows_settle(&m->rows, m->field.u)) return BRUNT_OK;
        if (minimise(m, report, error)) return BRUNT_FAILED;
    }
    report->result = BRUNT_NEWTON_ITERATIONS;
    return brunt_fail(error, BRUNT_FAILED, "friction at boundaries does not settle within %d solutions.", ROUND_LIMIT);
}

// What comes to a surface within a step is known once it has an end, and that is found anew with what the surface
// holds.
static int meet(brunt_world *world, brunt_newton_report *report, brunt_error *error) {
    enum { ROUND_LIMIT = 60 };
    struct brunt_implicit *m = world->plan.implicit;
    for (int k = 0; k < ROUND_LIMIT; k++) {
        bool grown;
        if (brunt_implicit_surfaces_meet(world, &grown, error)) {
            report->result = BRUNT_NEWTON_BLOCKED;
            return BRUNT_FAILED;
        }
        if (!grown) return BRUNT_OK;
        if (!m->still) take_acceleration(m), take_aim(m);
        if (minimise(m, report, error) || settle(m, report, error)) return BRUNT_FAILED;
    }
    report->result = BRUNT_NEWTON_ITERATIONS;
    return brunt_fail(error, BRUNT_FAILED, "what comes to boundaries finds no end within %d solutions.", ROUND_LIMIT);
}

// Of load steps with friction: once held components are at their places, where something is in the way by a potential
// with the normal forces of the start.
static int go_and_rub(struct brunt_implicit *m, brunt_newton_report *report, brunt_error *error) {
    double way;
    if (free_way(m, &way, error)) return BRUNT_FAILED;
    if (way < 1 && go_and_minimise(m, report, error)) return BRUNT_FAILED;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        if (m->unknowns.held[k]) m->field.u[k] = m->unknowns.target[k];
    return brunt_static_rub(m, minimise, report, error);
}

// `guess`: where bodies may end, like u; NULL: not known.
static int solve_step(brunt_world *world, double dt, const double *guess, brunt_newton_report *report,
                      brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    int status = begin_try(world, dt, error);
    if (status && m->holds && m->rows.too_far) report->result = BRUNT_NEWTON_BLOCKED; // a shorter step may do
    if (!status && guess) memcpy(m->field.u, guess, (size_t)brunt_implicit_components(m) * sizeof *guess);
    const bool joined = m->still && m->contact.reach > 0 && world->clock.steps == 0;
    if (!status && !guess) status = lead(m, joined, error);
    if (!status && !guess) status = coast(m, error);
    if (!status) status = m->still && m->rubs ? go_and_rub(m, report, error) : go_and_minimise(m, report, error);
    if (!status && m->holds) status = settle(m, report, error);
    if (!status && m->holds && m->rows.any_leave) status = meet(world, report, error);
    return status;
}

// Newmark's method wants the forces at the start of each step: tractions of surfaces are those at the end of the one
// before. Before the first step they are found by one of backward Euler, which is then forgotten: with none at the
// start they would swing between nothing and twice what they are, for ever.
static int find_tractions(brunt_world *world, double dt, brunt_newton_report *report, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_weights own = m->weights;
    if (!m->holds || world->clock.steps > 0 || own.gamma == 1) return BRUNT_OK;
    m->weights = (brunt_weights){1, 0.5, 1, 1, 1};
    const int status = solve_step(world, dt, NULL, report, error);
    if (!status) brunt_implicit_surfaces_keep(world);
    m->weights = own;
    return status;
}

// How long contacts are, roughly, by a solution with the stiffness that is guessed, from where the step is then solved;
// where that fails, the guess is kept.
static int solve_first(brunt_world *world, double dt, brunt_newton_report *report, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const double asked = m->options.tolerance;
    const size_t bytes = (size_t)brunt_implicit_components(m) * sizeof(double);
    double *rough;
    brunt_error vain = {.id = -1};
    if (BRUNT_NEW(rough, bytes / sizeof *rough + 1, "unknowns", error)) return BRUNT_FAILED;
    m->options.tolerance = fmax(asked, ROUGHLY);
    const bool found = !solve_step(world, dt, NULL, report, &vain) && !brunt_static_see(m, &vain);
    m->options.tolerance = asked;
    memcpy(rough, m->field.u, bytes);
    const int status = solve_step(world, dt, found ? rough : NULL, report, error);
    brunt_free(rough);
    return status;
}

// Friction goes by the pressures of the step before: over a touch each rubs once, and all of it comes to Coulomb's law.
// What gaps that bodies are given at the start would press need not be what does: friction is by the pressures of the
// step itself from there, until these change little from step to step, or nothing presses.
static int rub(brunt_world *world, brunt_newton_report *report, brunt_error *error) {
    enum { OWN = 8 };
    static const double LITTLE = 0.1, SAME = 0.01;
    struct brunt_implicit *m = world->plan.implicit;
    const bool own = world->clock.rubs_late == 0;
    const double before = own ? brunt_barrier_bound(m->contact.barrier) : 0;
    const int solutions = own && m->friction_iterations < OWN ? OWN : m->friction_iterations;
    bool settled = false; // pressures are those that friction went by: a first correction is below the tolerance
    for (int k = 1; !settled && k < solutions; k++) {
        const double last = brunt_barrier_bound(m->contact.barrier);
        if (brunt_barrier_lag(m->contact.barrier, &m->team, m->field.u, error) || minimise(m, report, error))
            return BRUNT_FAILED;
        const double bound = brunt_barrier_bound(m->contact.barrier);
        settled = report->iterations <= 1 || (k >= m->friction_iterations && fabs(bound - last) <= SAME * bound);
    }
    const double now = own ? brunt_barrier_bound(m->contact.barrier) : 0;
    m->rubs_late = fabs(now - before) <= LITTLE * now;
    return BRUNT_OK;
}

static int try_step(brunt_world *world, double dt, brunt_newton_report *report, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    *report = (brunt_newton_report){.result = BRUNT_NEWTON_BROKEN, .residual_dof = -1};
    m->tried = (brunt_newton_counts){.least_gap = INFINITY, .least_part = INFINITY};
    int status = find_tractions(world, dt, report, error);
    if (!status) {
        status = brunt_static_guesses(m) ? solve_first(world, dt, report, error)
                                         : solve_step(world, dt, NULL, report, error);
    }
    return status || !m->rubs || m->still ? status : rub(world, report, error);
}

// Whether nothing outside the bodies acts along an axis but loads: no node is held, no plane pushes or mirrors.
static bool is_free(const struct brunt_implicit *m, int axis) {
    const brunt_unknowns *u = &m->unknowns;
    if (m->still || m->holds || m->drag.weight || m->contact.plane_count || u->images.any) return false;
    bool held = false;
    for (int64_t k = axis; k < brunt_implicit_components(m); k += u->dim) held = held || u->held[k];
    return !held;
}

// A translation of everything changes no force but inertia's: what Newton's method has left of their sum is taken away
// by one, and momentum is kept to rounding whatever its tolerance and that of its linear systems.
static void balance_sums(struct brunt_implicit *m) {
    const brunt_unknowns *unknowns = &m->unknowns;
    const brunt_fields *f = &m->field;
    for (int a = 0; a < unknowns->dim; a++) {
        double left = 0, mass = 0;
        if (!is_free(m, a)) continue;
        for (int32_t n = 0; n < unknowns->count; n++) {
            const int64_t k = (int64_t)n * unknowns->dim + a;
            left += unknowns->mass[n] * (f->u[k] - f->aim[k]) - m->inertia.c * f->load[k];
            mass += unknowns->mass[n];
        }
        for (int32_t n = 0; mass > 0 && n < unknowns->count; n++) f->u[(int64_t)n * unknowns->dim + a] -= left / mass;
    }
}

// Planes that hold what lies on them do not push what comes to them.
static int check_planes(const brunt_world *world, brunt_error *error) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_boundary *boundary;
    char reason[160];
    const int32_t n = brunt_unknowns_passed(&m->unknowns, world, m->field.u, m->dt, &boundary);
    if (n < 0) return BRUNT_OK;
    const brunt_unknown_location at = brunt_unknowns_location(&m->unknowns, &world->bodies, n);
    snprintf(reason, sizeof reason,
             "a node comes to the plane '%s' from afar, which holds what lies on it: condition separate is wanted",
             boundary->name);
    return brunt_fail_position(world, at.body, at.x, error, reason);
}

// Nothing of the step is kept but, of one that failed, how often was tried.
static int withdraw(brunt_world *world, double wanted, const brunt_newton_counts *tried,
                    const brunt_newton_report *report, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    if (m->holds && world->clock.steps == 0) // Newmark's first one has found some
        brunt_implicit_surfaces_forget(&world->boundaries.surfaces);
    if (m->stopped) return brunt_implicit_leave(world, error);
    brunt_newton_counts_add(&world->clock.newton, tried);
    world->clock.withdrawn = true;
    return fail_try(world, wanted, report, error);
}

int brunt_pass_newton(brunt_world *world, brunt_step *step, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    brunt_newton_counts sum = {.least_gap = INFINITY, .least_part = INFINITY};
    brunt_newton_report report;
    const int own = world->timing.pass;
    const bool guesses = brunt_static_guesses(m);
    int status = BRUNT_OK;
    double dt = step->dt;
    m->team = (brunt_team){.threads = world->settings.threads, .timer = brunt_pass_timer(&world->timing)};
    const double least = m->still ? brunt_static_least(&world->settings) : ldexp(dt, -world->settings.newton.cut);
    for (int cut = 0; cut == 0 || dt >= least; cut++, dt *= 0.5) {
        brunt_error tried = {.id = -1};
        sum.cuts = cut;
        status = try_step(world, dt, &report, &tried);
        brunt_newton_counts_add(&sum, &m->tried);
        if (error && status) *error = tried;
        if (m->stopped) status = BRUNT_STOPPED;
        if (!status || m->stopped || report.result == BRUNT_NEWTON_BROKEN) break;
    }
    if (world->timing.pass != own) {
        brunt_pass_end(&world->timing, 0);
        brunt_pass_begin(&world->timing, own);
    }
    sum.iterations_worst = sum.iterations;
    if (status && guesses) brunt_implicit_contact_widen(&m->contact, 0);
    if (status) return withdraw(world, step->dt, &sum, &report, error);
    balance_sums(m);
    sum.steps = 1, sum.residual = m->tried.residual; // not that of a try that was given up
    m->tried = sum;
    if (m->rubs && m->rubs_late) world->clock.rubs_late = 1;
    step->dt = step->kick = m->dt;
    return check_planes(world, error);
}
