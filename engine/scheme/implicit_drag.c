// Mass-proportional damping of meshes in implicit steps: a force of -w v, w = damping m, at both ends of a step as the
// integrator weighs them. The velocity at the end is linear in the displacement, v = slope (u - rest), so that the
// force there has a potential. Free motion is slowed by 1 / (1 + d dt) of backward Euler, (1 - d dt / 2) / (1 + d dt /
// 2) of Newmark, whatever the step.
#include "base/array.h"
#include "scheme/implicit.h"

int brunt_implicit_drag_number(struct brunt_implicit *m, const brunt_world *world, brunt_error *error) {
    const brunt_unknowns *u = &m->unknowns;
    if (!world->boundaries.damping.active) return BRUNT_OK;
    if (BRUNT_CAPACITY(m->drag_weight, (size_t)u->count + 1, 0, "damped unknowns", error) ||
        BRUNT_CAPACITY(m->drag_rest, (size_t)brunt_implicit_components(m) + 1, 0, "damped unknowns", error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < u->count; n++) m->drag_weight[n] = 0;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        for (int32_t n = u->base[k]; n < u->base[k] + fem->node_count; n++)
            m->drag_weight[n] = (double)fem->damping * u->mass[n];
    }
    m->drag.weight = m->drag_weight, m->drag.rest = m->drag_rest;
    return BRUNT_OK;
}

void brunt_implicit_drag_before(const struct brunt_implicit *m, double *force) {
    const int dim = m->unknowns.dim;
    for (int64_t k = 0; m->drag.weight && k < brunt_implicit_components(m); k++)
        force[k] -= m->drag.weight[k / dim] * m->unknowns.velocity[k];
}

void brunt_implicit_drag_aim(struct brunt_implicit *m) {
    const double gamma = m->weights.gamma;
    m->drag.slope = gamma * m->dt / m->inertia.c;
    for (int64_t k = 0; m->drag.weight && k < brunt_implicit_components(m); k++) {
        const double still = m->unknowns.velocity[k] + m->dt * (1 - gamma) * m->field.acceleration[k];
        m->drag_rest[k] = m->field.aim[k] - still / m->drag.slope;
    }
}

void brunt_implicit_account_drag(brunt_world *world) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    const double gamma = m->weights.gamma;
    brunt_damping_sums *done = &world->ledger.damping;
    for (int32_t n = 0; m->drag.weight && n < u->mesh_count; n++) {
        double x[3], F[3] = {0};
        brunt_implicit_moment_arm(m, n, x);
        for (int a = 0; a < u->dim; a++) {
            const int64_t k = n * (int64_t)u->dim + a;
            const double after = -m->drag.weight[n] * m->field.v[k];
            F[a] = gamma * after - (1 - gamma) * m->drag.weight[n] * u->velocity[k];
            m->field.load[k] += after; // what holders give is what is missing: see account_holders
            done->loss -= F[a] * m->field.u[k];
            done->impulse[a] += m->dt * F[a];
        }
        for (int a = 0; a < 3; a++)
            done->angular[a] += m->dt * (x[(a + 1) % 3] * F[(a + 2) % 3] - x[(a + 2) % 3] * F[(a + 1) % 3]);
    }
}
