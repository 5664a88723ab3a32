// Free rigid tools.
#include "boundary/tool.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/vector.h"

static const double ROUNDING = 1e-16; // of the momentum: what iterations for its mean may leave
enum { ITERATION_LIMIT = 100 };

void brunt_tool_make(brunt_tool *t, const brunt_boundary_surface_def *def, int dim, bool axial) {
    *t = (brunt_tool){.free = def->mass > 0, .dim = dim, .axial = axial, .mass = def->mass, .node = BRUNT_NONE};
    t->frame[0] = 1;
    if (!t->free) return;
    for (int a = 0; a < 3; a++) {
        t->inertia[a] = def->inertia[a], t->centre[a] = def->center[a], t->v[a] = def->value[a];
        t->turns = t->turns || def->inertia[a] > 0;
    }
    for (int a = 0; a < 3; a++) t->momentum[a] = t->turns ? def->inertia[a] * def->spin[a] : 0;
}

// ------------------------------------------------------------------------------------------ turning

// Principal axes, as rows: the columns of the frame's matrix.
static void axes_of(const brunt_tool *t, double axis[3][3]) {
    const double *q = t->frame, w = q[0], x = q[1], y = q[2], z = q[3];
    const double matrix[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                 {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                 {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) axis[k][a] = matrix[a][k];
}

static bool turns_about(const brunt_tool *t, int k) { return t->turns && (t->dim == 3 || k == 2); }

void brunt_tool_spin(const brunt_tool *t, double spin[3]) {
    double axis[3][3];
    axes_of(t, axis);
    for (int a = 0; a < 3; a++) spin[a] = 0;
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3 && turns_about(t, k); a++)
            spin[a] += axis[k][a] * dot(axis[k], t->momentum) / t->inertia[k];
}

double brunt_tool_kinetic(const brunt_tool *t) {
    double spin[3];
    brunt_tool_spin(t, spin);
    return 0.5 * t->mass * dot(t->v, t->v) + 0.5 * dot(spin, t->momentum);
}

// The mean angular velocity over a step in the body's own frame: w = I^-1 (P + P') / 2 with P' - P = dt (P + P') / 2 x
// w.
static void mean_spin(const brunt_tool *t, const double P[3], double dt, double w[3]) {
    double mean[3] = {P[0], P[1], P[2]};
    for (int k = 0; k < ITERATION_LIMIT; k++) {
        double across[3], change = 0;
        for (int a = 0; a < 3; a++) w[a] = turns_about(t, a) ? mean[a] / t->inertia[a] : 0;
        cross(mean, w, across);
        for (int a = 0; a < 3; a++) {
            const double next = P[a] + 0.5 * dt * across[a];
            change = fmax(change, fabs(next - mean[a]));
            mean[a] = next;
        }
        if (change <= ROUNDING * sqrt(dot(P, P))) return;
    }
}

// By Cayley's map of dt w, which turns about w by 2 atan(dt |w| / 2).
static void turn(brunt_tool *t, double dt) {
    double axis[3][3], P[3], w[3], size = 0, next[4];
    const double *q = t->frame;
    axes_of(t, axis);
    for (int k = 0; k < 3; k++) P[k] = dot(axis[k], t->momentum);
    mean_spin(t, P, dt, w);
    const double p[4] = {1, 0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2]};
    next[0] = q[0] * p[0] - q[1] * p[1] - q[2] * p[2] - q[3] * p[3];
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        next[1 + a] = q[0] * p[1 + a] + p[0] * q[1 + a] + q[1 + i] * p[1 + j] - q[1 + j] * p[1 + i];
    }
    for (int k = 0; k < 4; k++) size += next[k] * next[k];
    for (int k = 0; k < 4; k++) t->frame[k] = next[k] / sqrt(size);
}

static void move(brunt_tool *t, double dt) {
    for (int a = 0; a < 3; a++) t->way[a] += dt * t->v[a];
    if (t->turns) turn(t, dt);
}

// ------------------------------------------------------------------------------------------ where it is

brunt_placement brunt_tool_place(const brunt_tool *t) {
    double axis[3][3];
    brunt_placement place;
    axes_of(t, axis);
    for (int a = 0; a < 3; a++) {
        place.translation[a] = t->centre[a] + t->way[a];
        for (int b = 0; b < 3; b++) {
            place.rotation[3 * a + b] = axis[b][a];
            place.translation[a] -= axis[b][a] * t->centre[b];
        }
    }
    return place;
}

brunt_placement brunt_tool_place_after(const brunt_tool *t, double dt) {
    brunt_tool then = *t;
    move(&then, dt);
    return brunt_tool_place(&then);
}

// ------------------------------------------------------------------------------------------ a step

void brunt_tool_begin(brunt_tool *t, const double gravity[3], double kick) {
    memcpy(t->old, t->v, sizeof t->old);
    brunt_tool_spin(t, t->old_spin);
    t->told = 0;
    for (int a = 0; a < 3; a++) {
        t->impulse[a] = t->moment[a] = 0;
        t->gravity[a] = a < t->dim && !(t->axial && a == 0) ? t->mass * gravity[a] * kick : 0;
        t->v[a] += t->gravity[a] / t->mass;
    }
}

// Its degrees of freedom: the velocity of its centre, and about each axis it turns about an angular velocity in the
// first component.
static int make_nodes(brunt_tool *t, brunt_constraint_set *set, brunt_error *error) {
    double axis[3][3], spin[3];
    t->node = brunt_constraints_dof_node(set, error);
    if (t->node < 0) return BRUNT_FAILED;
    brunt_dof_node *centre = &set->dof_node[t->node];
    for (int a = 0; a < t->dim; a++) {
        centre->v[a] = t->v[a], centre->old[a] = t->old[a];
        centre->inverse[a] = t->axial && a == 0 ? 0 : 1 / t->mass;
    }
    axes_of(t, axis);
    brunt_tool_spin(t, spin);
    for (int k = 0; k < 3; k++) {
        if (!turns_about(t, k)) continue;
        const int32_t at = brunt_constraints_dof_node(set, error);
        if (at < 0) return BRUNT_FAILED;
        brunt_dof_node *about = &set->dof_node[at];
        about->angular = true;
        about->v[0] = dot(axis[k], spin), about->old[0] = dot(axis[k], t->old_spin);
        about->inverse[0] = 1 / t->inertia[k];
    }
    return BRUNT_OK;
}

// What an entry has of the velocity at x that an axis gives, with its sign: -(axis x arm).
static void set_lever(const brunt_tool *t, int k, const double x[3], brunt_constraint_entry *entry) {
    double axis[3][3], arm[3], lever[3];
    axes_of(t, axis);
    for (int a = 0; a < 3; a++) arm[a] = x[a] - t->centre[a] - t->way[a];
    cross(axis[k], arm, lever);
    for (int a = 0; a < 3; a++) entry->height_gradient[a] = -lever[a];
}

int brunt_tool_enter(brunt_tool *t, const double x[3], brunt_constraint_set *set, brunt_error *error) {
    if (t->node < 0 && make_nodes(t, set, error)) return BRUNT_FAILED;
    if (brunt_constraints_entry(set, t->node, -1, error) < 0) return BRUNT_FAILED;
    brunt_constraint *c = &set->constraint[set->constraint_count - 1];
    for (int k = 0, about = t->node; k < 3; k++) {
        if (!turns_about(t, k)) continue;
        const int32_t at = brunt_constraints_entry(set, ++about, 0, error);
        if (at < 0) return BRUNT_FAILED;
        set_lever(t, k, x, &set->entry[at]);
        c->turns = true;
        c->facet[0] = 1, c->facet[1] = c->facet[2] = 0;
    }
    return BRUNT_OK;
}

void brunt_tool_rub(const brunt_tool *t, const double at[3], brunt_constraint_set *set) {
    brunt_constraint_entry *end = &set->entry[set->entry_count];
    int turning = 0;
    for (int k = 2; k >= 0; k--)
        if (turns_about(t, k)) set_lever(t, k, at, end - ++turning);
    for (int a = 0; a < 3; a++) end[-1 - turning].weight[a] = -1;
}

void brunt_tool_take(brunt_tool *t, const brunt_constraint_set *set) {
    double axis[3][3], spin[3], gain[3], moment[3] = {0, 0, 0};
    if (t->node < 0) return;
    axes_of(t, axis);
    const brunt_dof_node *node = &set->dof_node[t->node];
    for (int a = 0; a < 3; a++) {
        gain[a] = node->inverse[a] > 0 ? node->impulse[a] : 0;
        t->v[a] += gain[a] * node->inverse[a];
    }
    for (int k = 0; k < 3; k++) {
        if (!turns_about(t, k)) continue;
        node++;
        for (int a = 0; a < 3; a++) moment[a] += axis[k][a] * node->impulse[0];
    }
    for (int a = 0; a < 3; a++) t->impulse[a] += gain[a], t->moment[a] += moment[a], t->momentum[a] += moment[a];
    brunt_tool_spin(t, spin);
    for (int a = 0; a < 3; a++)
        t->told -= 0.5 * (gain[a] * (t->old[a] + t->v[a]) + moment[a] * (t->old_spin[a] + spin[a]));
    t->node = BRUNT_NONE;
}

// What it does to bodies is what they do to it, by its mean velocity over the step: that is the work which its own
// energy lacks. Solutions of several bodies are one after the other, each with the velocity of its own end.
void brunt_tool_end(brunt_tool *t, double dt, brunt_impulse_account *last) {
    double spin[3], work = 0;
    brunt_tool_spin(t, spin);
    for (int a = 0; a < 3; a++) {
        work -= 0.5 * (t->impulse[a] * (t->old[a] + t->v[a]) + t->moment[a] * (t->old_spin[a] + spin[a]));
        t->gravity_work += 0.5 * t->gravity[a] * (t->old[a] + t->v[a]);
    }
    last->external_work += work;
    last->normal_loss += work - t->told;
    move(t, dt);
}

// ------------------------------------------------------------------------------------------ state

double *brunt_tool_state_get(const brunt_tool *t, double *out) {
    memcpy(out, t->way, sizeof t->way), memcpy(out + 3, t->frame, sizeof t->frame);
    memcpy(out + 7, t->v, sizeof t->v), memcpy(out + 10, t->momentum, sizeof t->momentum);
    out[13] = t->gravity_work;
    return out + BRUNT_TOOL_STATE;
}

const double *brunt_tool_state_set(brunt_tool *t, const double *in) {
    memcpy(t->way, in, sizeof t->way), memcpy(t->frame, in + 3, sizeof t->frame);
    memcpy(t->v, in + 7, sizeof t->v), memcpy(t->momentum, in + 10, sizeof t->momentum);
    t->gravity_work = in[13];
    return in + BRUNT_TOOL_STATE;
}
