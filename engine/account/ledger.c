// Energy and momentum of a world, and what is known of bodies, pairs and boundaries.
#include <float.h>
#include <math.h>
#include <string.h>

#include "account/ledger.h"
#include "base/error.h"

static const double GROWTH_LIMIT = 10, STEP_ROUNDINGS = 10, STORED_ROUNDINGS = 100;
static const double REAL_EPSILON = sizeof(real) == sizeof(float) ? FLT_EPSILON : DBL_EPSILON;

// What the run has been given by now [J]: the energy at the start, with the work done on it, and that work itself, each
// cause by its amount, since what one boundary puts in another may take out.
static double given_energy(const brunt_ledger *ledger, const brunt_accounts *accounts) {
    double work = ledger->gravity_work, turned_over = fabs(work);
    for (int w = 0; w < accounts->boundary_count; w++) {
        work += accounts->boundaries[w].account.external_work;
        turned_over += fabs(accounts->boundaries[w].account.external_work);
    }
    const double initial = ledger->initial_energy;
    return fmax(fmax(fabs(initial), fabs(initial + work)), turned_over);
}

void brunt_ledger_validate(const brunt_ledger *ledger) {
    double number[sizeof *ledger / sizeof(double)];
    _Static_assert(sizeof number == sizeof *ledger, "the ledger has numbers only");
    memcpy(number, ledger, sizeof number);
    for (size_t i = 0; i < sizeof number / sizeof *number; i++) BRUNT_ASSERT(isfinite(number[i]));
    BRUNT_ASSERT(ledger->initial_kinetic >= 0 && ledger->rounding_energy >= 0 && ledger->rounding_stored >= 0);
    BRUNT_ASSERT(ledger->scale_linear >= 0 && ledger->scale_angular >= 0);
    BRUNT_ASSERT(ledger->energy_scale >= fabs(ledger->initial_energy));
}

void brunt_ledger_remember(brunt_ledger *ledger, const brunt_accounts *accounts) {
    ledger->energy_scale = fmax(ledger->energy_scale, given_energy(ledger, accounts));
}

// A density of energy is a difference of numbers as large as the moduli, whose roundings are m c^2 eps of a body: of
// one that is turned by load steps, and by nothing else, there is no other energy.
static double rounding_stored(const brunt_bodies *bodies) {
    double energy = 0;
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *body = &bodies->all[i];
        const double wave_speed = (double)body->ops->material(body)->wave_speed;
        energy += brunt_bodies_measure_of(bodies, body).sums.mass * wave_speed * wave_speed;
    }
    return STORED_ROUNDINGS * REAL_EPSILON * energy;
}

// Places x are known to eps |x|, strains of elements of size h to eps |x| / h, and rounded some ten times a step, now
// up now down: m c^2 (10 eps |x| / h)^2 for each step.
static double rounding_energy(const brunt_bodies *bodies) {
    double energy = 0;
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *body = &bodies->all[i];
        const brunt_body_measure m = brunt_bodies_measure_of(bodies, body);
        const int dim = body->ops->dim(body);
        double far = 0;
        for (int a = 0; a < dim; a++) far = fmax(far, fmax(fabs(m.low[a]), fabs(m.high[a])));
        const double mass = m.sums.mass, size = body->ops->fineness(body);
        const double wave_speed = (double)body->ops->material(body)->wave_speed;
        const double v = wave_speed * STEP_ROUNDINGS * REAL_EPSILON * far / size;
        energy += mass * v * v;
    }
    return energy;
}

void brunt_ledger_open(brunt_ledger *ledger, const brunt_accounts *accounts) {
    for (int i = 0; i < accounts->bodies->count; i++) {
        const brunt_body_ref *body = brunt_bodies_summed(accounts->bodies, i);
        const brunt_body_measure m = brunt_bodies_measure_of(accounts->bodies, body);
        const brunt_audit a = m.sums;
        *(body->mpm ? &ledger->kinetic : &ledger->fem_kinetic) += a.kinetic;
        ledger->initial_kinetic += a.kinetic;
        ledger->initial_energy += a.kinetic + m.energy.internal;
        ledger->scale_linear += a.scale_linear;
        ledger->scale_angular += a.scale_angular;
        for (int k = 0; k < 3; k++)
            ledger->linear_initial[k] += a.linear[k], ledger->angular_initial[k] += a.angular[k];
    }
    ledger->initial_energy += ledger->hourglass_stored;
    brunt_ledger_remember(ledger, accounts);
    ledger->rounding_energy = rounding_energy(accounts->bodies);
    ledger->rounding_stored = rounding_stored(accounts->bodies);
}

// Energy that bodies have and have dissipated.
static void add_bodies(const brunt_bodies *bodies, brunt_energy *energy) {
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *body = brunt_bodies_summed(bodies, i);
        const brunt_point_energy e = brunt_bodies_measure_of(bodies, body).energy;
        energy->internal += e.internal;
        energy->plastic += e.plastic;
        energy->viscosity += e.viscosity;
        energy->heat += e.heat;
    }
}

// What has acted between bodies and from outside.
static void add_accounts(const brunt_accounts *accounts, brunt_energy *energy) {
    for (int w = 0; w < accounts->boundary_count; w++) {
        energy->contact += accounts->boundaries[w].account.normal_loss;
        energy->friction += accounts->boundaries[w].account.friction_loss;
        energy->external_work += accounts->boundaries[w].account.external_work;
    }
    for (int p = 0; p < accounts->pair_count; p++) {
        energy->contact += accounts->pairs[p].account.normal_loss;
        energy->friction += accounts->pairs[p].account.friction_loss;
    }
}

void brunt_ledger_energy(const brunt_ledger *now, const brunt_accounts *accounts, brunt_energy *energy) {
    // Velocities are those of the middle of the last step, stress that of its end: what it does to them in that half
    // step is recorded with the transfer.
    *energy = (brunt_energy){.kinetic = now->kinetic + now->fem_kinetic,
                             .initial = now->initial_energy,
                             .transfer = now->transfer - 0.5 * (now->stress_work + now->fem_stress_work),
                             .scheme = now->scheme,
                             .contact = now->barrier,
                             .external_work = now->gravity_work};
    add_bodies(accounts->bodies, energy);
    energy->mechanical = energy->kinetic + energy->internal - 0.5 * (now->stress_work + now->fem_stress_work);
    energy->hourglass = now->hourglass_stored + now->hourglass_lost;
    energy->viscosity += now->damping.loss + now->eroded_viscosity;
    energy->plastic += now->eroded_plastic;
    energy->heat += now->eroded_heat;
    for (int i = 0; i < accounts->bodies->count && accounts->eroded; i++) energy->eroded += accounts->eroded[i].energy;
    add_accounts(accounts, energy);
    energy->total = energy->kinetic + energy->internal + energy->plastic + energy->hourglass + energy->contact +
                    energy->friction + energy->viscosity + energy->transfer + energy->eroded + energy->scheme;
    energy->error = energy->total - energy->initial - energy->external_work;
    // Relative to the most that the run has been given so far, so that energy that comes and goes does not make the
    // error large where there is little. What it has may be more, when heat of an equation of state that counts from 0
    // becomes motion; but beyond ten times that it is energy out of nothing, which must not measure itself. Where next
    // to nothing happens, it is rounding that does.
    const double given = fmax(now->energy_scale, given_energy(now, accounts));
    const double has = energy->kinetic + fabs(energy->internal);
    const double scale = fmax(given, given > 0 ? fmin(has, GROWTH_LIMIT * given) : has);
    energy->reference = fmax(fmax(scale, now->rounding_stored), now->rounding_energy * fmax(accounts->steps, 1));
    energy->error_relative = energy->reference > 0 ? energy->error / energy->reference : 0;
}

// The paper's form of augury parks angular momentum in the affine velocity of boundary nodes.
static void add_contact_spin(const brunt_contact_surface *s, double angular[3]) {
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

// Magnitudes of what has acted: impulses that cancel, such as weight and support, still set the scale of what rounding
// may do.
typedef struct magnitudes {
    double linear, angular;
} magnitudes;

// Component k of the impulses that the bodies have been given.
static void add_impulses(const brunt_ledger *now, const brunt_accounts *accounts, int k, brunt_momentum *momentum,
                         magnitudes *size) {
    momentum->linear_impulse[k] = now->gravity_impulse[k] + now->damping.impulse[k];
    momentum->angular_impulse[k] = now->gravity_angular[k] + now->damping.angular[k];
    size->linear += fabs(now->gravity_impulse[k]) + fabs(now->damping.impulse[k]);
    size->angular += fabs(now->gravity_angular[k]) + fabs(now->damping.angular[k]);
    for (int w = 0; w < accounts->boundary_count; w++) {
        const brunt_impulse_account *account = &accounts->boundaries[w].account;
        momentum->linear_impulse[k] += account->impulse[k];
        momentum->angular_impulse[k] += account->angular[k];
        size->linear += fabs(account->impulse[k]);
        size->angular += fabs(account->angular[k]);
    }
    if (accounts->axisymmetric) keep_axial(k, momentum);
    for (int i = 0; i < accounts->bodies->count && accounts->eroded; i++) {
        const brunt_eroded *eroded = &accounts->eroded[i];
        momentum->linear_impulse[k] -= eroded->momentum[k];
        momentum->angular_impulse[k] -= eroded->angular[k];
        size->linear += fabs(eroded->momentum[k]);
        size->angular += fabs(eroded->angular[k]);
    }
}

void brunt_ledger_momentum(const brunt_ledger *now, const brunt_accounts *accounts, brunt_momentum *momentum) {
    memset(momentum, 0, sizeof *momentum);
    double linear_here = 0, angular_here = 0, linear = 0, angular = 0;
    for (int i = 0; i < accounts->bodies->count; i++) {
        const brunt_body_ref *body = brunt_bodies_summed(accounts->bodies, i);
        const brunt_audit a = brunt_bodies_measure_of(accounts->bodies, body).sums;
        for (int k = 0; k < 3; k++) momentum->linear[k] += a.linear[k], momentum->angular[k] += a.angular[k];
        linear_here += a.scale_linear;
        angular_here += a.scale_angular;
    }
    add_contact_spin(accounts->surface, momentum->angular);
    magnitudes size = {0};
    for (int k = 0; k < 3; k++) {
        momentum->linear_initial[k] = now->linear_initial[k];
        momentum->angular_initial[k] = now->angular_initial[k];
        add_impulses(now, accounts, k, momentum, &size);
        double d = momentum->linear[k] - momentum->linear_initial[k] - momentum->linear_impulse[k];
        double e = momentum->angular[k] - momentum->angular_initial[k] - momentum->angular_impulse[k];
        linear += d * d, angular += e * e;
    }
    const double linear_scale = fmax(fmax(now->scale_linear, linear_here), size.linear);
    const double angular_scale = fmax(fmax(now->scale_angular, angular_here), size.angular);
    momentum->linear_drift = linear_scale > 0 ? sqrt(linear) / linear_scale : 0;
    momentum->angular_drift = angular_scale > 0 ? sqrt(angular) / angular_scale : 0;
}
