// When explosives are lit: at the start each material point and element centre gets the time at which the detonation
// front reaches it, the least of time + distance / D over the detonators (programmed burn, see materials/jwl.c). The
// front runs straight from a point or a plane; corners that it would have to turn about are not seen.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/names.h"
#include "boundary/ignition.h"

static bool ignites(const brunt_detonation_def *d, const char *body) { return !d->body[0] || !strcmp(d->body, body); }

static double distance(const brunt_detonation_def *d, int dim, const double x[3]) {
    double apart = 0, along = 0, size = 0;
    for (int a = 0; a < dim; a++) {
        const double r = x[a] - d->point[a];
        apart += r * r;
        along += r * d->normal[a];
        size += d->normal[a] * d->normal[a];
    }
    return size > 0 ? fabs(along) / sqrt(size) : sqrt(apart);
}

static real ignition_time(const brunt_world_def *def, const char *body, double speed, const double x[3]) {
    double first = INFINITY;
    for (int32_t k = 0; k < def->detonation_count; k++) {
        const brunt_detonation_def *d = &def->detonations[k];
        if (ignites(d, body)) first = fmin(first, d->time + distance(d, def->dimension, x) / speed);
    }
    return (real)first;
}

static int state_index(const brunt_model *model) {
    int s = 0;
    while (strcmp(model->state[s].name, "ignition_time") != 0) s++;
    return s;
}

// First time at which something of the body burns [s].
static double ignite_particles(const brunt_world_def *def, brunt_body *body, double speed) {
    brunt_particles *p = &body->particles;
    double first = INFINITY;
    const brunt_model *model = body->material.model[BRUNT_EOS];
    real *time = brunt_state_arrays(p, model, state_index(model))[0], *const *x = brunt_field(p, BRUNT_FIELD_position);
    for (int64_t s = 0; s < p->slots; s++) {
        const double at[3] = {(double)x[0][s], (double)x[1][s], p->dim == 3 ? (double)x[2][s] : 0};
        time[s] = ignition_time(def, body->name, speed, at);
        first = fmin(first, (double)time[s]);
    }
    return first;
}

// Padding repeats real elements, so it is treated like them.
static double ignite_elements(const brunt_world_def *def, brunt_fem_body *fem, double speed) {
    const brunt_model *model = fem->material.model[BRUNT_EOS];
    const int nodes = fem->traits->nodes;
    double first = INFINITY;
    int f = BRUNT_ELEMENT_BASE_FIELDS;
    while (fem->field[f].model != model || fem->field[f].state != state_index(model)) f++;
    real *time = brunt_element_scalars(fem, f)[0];
    for (int32_t s = 0; s < fem->slots; s++) {
        double centre[3] = {0};
        for (int c = 0; c < nodes; c++) {
            const real *node = brunt_fem_node(fem, fem->element_node[(int64_t)s * nodes + c]);
            for (int a = 0; a < fem->dim; a++) centre[a] += (double)node[a] / nodes;
        }
        time[s] = ignition_time(def, fem->name, speed, centre);
        first = fmin(first, (double)time[s]);
    }
    return first;
}

static bool is_explosive(const brunt_body_ref *ref) {
    const brunt_model *eos = ref->ops->material(ref)->model[BRUNT_EOS];
    return eos && eos->explosive;
}

// D [m/s]: the first parameter of all that burns.
static double detonation_speed(const brunt_world_def *def, const brunt_names *names, const char *body) {
    const int32_t i = brunt_names_find(names, body, strlen(body));
    return def->materials[def->bodies[i].material].eos_parameters[0];
}

// A detonator lights something, somewhere, at some time.
static int check(const brunt_bodies *bodies, const brunt_detonation_def *d, int index, brunt_error *error) {
    bool finite = isfinite(d->time), something = false, known = !d->body[0];
    for (int a = 0; a < 3; a++) finite = finite && isfinite(d->point[a]) && isfinite(d->normal[a]);
    if (!finite)
        return brunt_fail(error, BRUNT_BAD_INPUT, "detonations[%d]: point, normal or time is not a finite number",
                          index);
    for (int i = 0; i < bodies->count; i++) {
        if (!ignites(d, brunt_bodies_name(bodies, i))) continue;
        known = true;
        something = something || is_explosive(&bodies->all[i]);
    }
    if (!known)
        return brunt_fail(error, BRUNT_BAD_INPUT, "detonations[%d].body: there is no body '%s'", index, d->body);
    if (!something)
        return brunt_fail(error, BRUNT_BAD_INPUT, "detonations[%d]: it lights nothing, %s%s is an explosive", index,
                          d->body[0] ? "no material of body " : "no body", d->body);
    return BRUNT_OK;
}

// What is odd about an explosive that first burns at `first` [s].
static void warn(brunt_messages *messages, const brunt_world_def *def, const brunt_body_ref *ref, const char *name,
                 double speed, double first) {
    double earliest = INFINITY;
    for (int32_t k = 0; k < def->detonation_count; k++)
        if (ignites(&def->detonations[k], name)) earliest = fmin(earliest, def->detonations[k].time);
    if (!(earliest < INFINITY)) {
        brunt_warn(messages, "bodies.%s: this explosive is never lit, no detonation reaches it", name);
        return;
    }
    const double gap = (first - earliest) * speed, near = ref->ops->fineness(ref);
    if (gap > 2 * near)
        brunt_warn(messages,
                   "bodies.%s: the first detonation is %.3g m outside of this explosive, its front runs through "
                   "what is between as through explosive",
                   name, gap);
    if (!ref->ops->material(ref)->model[BRUNT_VISCOSITY])
        brunt_warn(messages,
                   "bodies.%s: an explosive without bulk viscosity rings behind its front (materials: viscosity: {})",
                   name);
}

int brunt_ignition_make(const brunt_bodies *bodies, const brunt_world_def *def, brunt_messages *messages,
                        brunt_error *error) {
    for (int32_t k = 0; k < def->detonation_count; k++) {
        int status = check(bodies, &def->detonations[k], k, error);
        if (status) return status;
    }
    brunt_names names;
    if (brunt_names_sort(&names, def->bodies[0].name, sizeof *def->bodies, def->body_count, error)) return BRUNT_FAILED;
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *ref = &bodies->all[i];
        if (!is_explosive(ref)) continue;
        const char *name = brunt_bodies_name(bodies, i);
        const double speed = detonation_speed(def, &names, name);
        const double first = ref->mpm ? ignite_particles(def, ref->mpm, speed) : ignite_elements(def, ref->fem, speed);
        warn(messages, def, ref, name, speed, first);
    }
    brunt_names_free(&names);
    return BRUNT_OK;
}
