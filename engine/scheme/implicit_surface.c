// Lines and surfaces in an implicit step: its rows, and what they did.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scheme/implicit.h"

int brunt_implicit_surfaces_begin(brunt_world *world, double dt, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    return brunt_boundary_rows_step(&m->rows, world, &m->unknowns, dt, error);
}

static const double *ways_of(void *context, int body) {
    struct brunt_implicit *m = context;
    brunt_mpm_interpolate(m->mpm[body], &m->team, m->field.u, m->moved);
    return m->moved;
}

// Adds the forces of tractions to `sum`, with a sign.
static void add_forces(const struct brunt_implicit *m, int32_t patch, const double t[3], double sign, double *sum) {
    const int dim = m->unknowns.dim;
    double F[3];
    for (int64_t k = m->rows.first[patch]; k < m->rows.first[patch + 1]; k++) {
        brunt_boundary_patch_force(&m->rows, patch, k, t, F);
        for (int a = 0; a < dim; a++) sum[m->rows.node[k] * (int64_t)dim + a] += sign * F[a];
    }
}

void brunt_implicit_surfaces_before(const struct brunt_implicit *m, double sign, double *force) {
    for (int32_t p = 0; p < m->rows.patch_count; p++) add_forces(m, p, m->rows.patch[p].before, sign, force);
}

// Forces at the start of the step are those of all patches that there are, as the account of the step has them too:
// where a piece has just let go its traction is still that of the end of the last step.
static int grow(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const bool before = m->weights.work < 1;
    if (before) brunt_implicit_surfaces_before(m, -1, m->field.force_before);
    if (brunt_boundary_rows_grow(&m->rows, world, error)) return BRUNT_FAILED;
    if (before) brunt_implicit_surfaces_before(m, 1, m->field.force_before);
    return BRUNT_OK;
}

int brunt_implicit_surfaces_meet(brunt_world *world, bool *grown, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    if (brunt_boundary_rows_look(&m->rows, world, ways_of, m, grown, error)) return BRUNT_FAILED;
    if (*grown && grow(world, error)) return BRUNT_FAILED;
    if (!*grown && m->rows.passed)
        return brunt_fail(error, BRUNT_FAILED, "material goes through boundary '%s'.", m->rows.passed->boundary->name);
    if (!m->rows.unseen) return BRUNT_OK;
    return brunt_fail(error, BRUNT_FAILED,
                      "material comes to boundary '%s' from farther than the nodes of its grid reach.",
                      m->rows.unseen->boundary->name);
}

// ------------------------------------------------------------------------------------------ the account

// Impulses, and their moments about the origin.
static void account_impulses(const struct brunt_implicit *m, int32_t patch, const double t[3],
                             brunt_impulse_account *last) {
    brunt_impulse_account part = {.area = 0};
    brunt_weighed_force F = {.work = {0}}; // told beside, by rows
    for (int64_t k = m->rows.first[patch]; k < m->rows.first[patch + 1]; k++) {
        brunt_boundary_patch_force(&m->rows, patch, k, t, F.impulse);
        brunt_implicit_account_force(m, &part, m->rows.node[k], &F);
    }
    for (int a = 0; a < 3; a++) last->impulse[a] += part.impulse[a], last->angular[a] += part.angular[a];
}

// The greatest rate at which a row's material leaves what holds it; in load steps, of the pseudo-time. Of what turns
// the mean rate of the step: velocities at its end have turned on.
static double rate_of(const struct brunt_implicit *m, int32_t patch) {
    const brunt_boundary_patch *p = &m->rows.patch[patch];
    const int dim = m->unknowns.dim;
    const bool mean = m->still || p->surface->turned.particle;
    const double *v = mean ? m->field.u : m->field.v, each = mean ? 1 / m->dt : 1;
    double most = 0;
    for (int row = 0; row < (p->leaves ? 0 : p->rows); row++) {
        double rate = -p->prescribed[row] / m->dt;
        for (int64_t k = m->rows.first[patch]; k < m->rows.first[patch + 1]; k++)
            for (int a = 0; a < dim; a++)
                rate += each * m->rows.weight[k][3 * row + a] * v[m->rows.node[k] * (int64_t)dim + a];
        most = fmax(most, fabs(rate) / p->size);
    }
    return most;
}

static void account_patch(struct brunt_implicit *m, int32_t patch) {
    const brunt_boundary_patch *p = &m->rows.patch[patch];
    brunt_boundary_surface *s = p->surface;
    brunt_impulse_account *last = &s->boundary->last;
    const double gamma = m->weights.gamma, work = m->weights.work;
    double t[3], moved[3], mean[3] = {0, 0, 0};
    brunt_boundary_patch_traction(&m->rows, patch, m->field.u, t, moved);
    add_forces(m, patch, t, -1, m->field.gradient);
    for (int k = 0; k < p->rows; k++) {
        const double working = work * t[k] + (1 - work) * p->before[k];
        mean[k] = gamma * t[k] + (1 - gamma) * p->before[k];
        last->external_work -= working * p->prescribed[k];
        *(k == 0 || !p->rubs ? &last->normal_loss : &last->friction_loss) += working * moved[k];
    }
    account_impulses(m, patch, mean, last);
    if (!(p->leaves && t[0] == 0)) last->area += p->size, s->active++;
    s->drift = fmax(s->drift, rate_of(m, patch));
}

// What holds nodes without material stores nothing.
static void account_ghost(brunt_world *world) {
    struct brunt_implicit *m = world->plan.implicit;
    const int64_t all = brunt_implicit_components(m);
    memset(m->field.step, 0, (size_t)all * sizeof *m->field.step);
    brunt_ghost_ops.gradient(&m->ghost, &m->team, m->field.u, m->field.step);
    for (int64_t k = 0; k < all; k++) {
        world->ledger.scheme += m->weights.work * m->field.step[k] * m->field.u[k];
        m->field.gradient[k] += m->field.step[k];
    }
}

void brunt_implicit_surfaces_forget(brunt_boundary_surfaces *surfaces) {
    for (int k = 0; k < surfaces->count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        memset(s->traction, 0, (size_t)s->bodies * (size_t)s->pieces * 3 * sizeof *s->traction);
    }
}

void brunt_implicit_surfaces_keep(brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    brunt_implicit_surfaces_forget(&world->boundaries.surfaces);
    for (int32_t patch = 0; patch < m->rows.patch_count; patch++) {
        const brunt_boundary_patch *p = &m->rows.patch[patch];
        brunt_boundary_surface *s = p->surface;
        double t[3], moved[3];
        brunt_boundary_patch_traction(&m->rows, patch, m->field.u, t, moved);
        brunt_boundary_surface_keep(s, t, s->traction + 3 * ((size_t)p->body * (size_t)s->pieces + (size_t)p->piece));
    }
}

void brunt_implicit_account_surfaces(brunt_world *world) {
    struct brunt_implicit *m = world->plan.implicit;
    for (int k = 0; k < world->boundaries.surfaces.count; k++)
        world->boundaries.surfaces.surface[k].active = 0, world->boundaries.surfaces.surface[k].drift = 0;
    for (int32_t p = 0; p < m->rows.patch_count; p++) account_patch(m, p);
    brunt_implicit_surfaces_keep(world);
    account_ghost(world);
}

// ------------------------------------------------------------------------------------------ what is missing

void brunt_implicit_surfaces_lack(const brunt_world *world, char *reason, size_t size) {
    const struct brunt_implicit *m = world->plan.implicit;
    const int wanted = m->unknowns.dim == 2 ? 3 : 6;
    for (int i = 0; m->holds && i < world->bodies.mpm_count; i++) {
        int rows = 0;
        if (m->unknowns.tie[i] != i) continue;
        for (int32_t p = 0; p < m->rows.patch_count; p++)
            if (m->rows.patch[p].body == i) rows += m->rows.patch[p].rows;
        const size_t used = strlen(reason);
        if (rows < wanted)
            snprintf(reason + used, size - used,
                     ". Boundaries hold body '%s' by %d rows of pieces, at least %d keep it from moving as a whole",
                     world->bodies.mpm[i].name, rows, wanted);
    }
}
