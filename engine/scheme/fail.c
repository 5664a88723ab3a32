// Computations that fail: which body, where, when and why.
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "scheme/scheme.h"

int brunt_fail_step(const struct brunt_clock *clock, const brunt_body *body, brunt_error *error, const char *reason) {
    if (!error) return BRUNT_FAILED;
    error->time = clock->time;
    if (body)
        memcpy(error->body, body->name,
               sizeof error->body < sizeof body->name ? sizeof error->body : sizeof body->name);
    char where[256] = "";
    if (body && error->id >= 0)
        snprintf(where, sizeof where, "body '%s', particle %lld at (%.6g, %.6g, %.6g) m, ", body->name,
                 (long long)error->id, error->position[0], error->position[1], error->position[2]);
    else if (body)
        snprintf(where, sizeof where, "body '%s', ", body->name);
    return brunt_fail(error, BRUNT_FAILED, "%stime %.9g s, step %.0f: %s", where, clock->time, clock->steps, reason);
}

int brunt_fail_inner(const struct brunt_clock *clock, const brunt_body *body, brunt_error *error) {
    char reason[256];
    snprintf(reason, sizeof reason, "%.250s", error ? error->message : "");
    return brunt_fail_step(clock, body, error, reason);
}

int brunt_fail_particle(const brunt_world *world, brunt_body *body, int64_t slot, brunt_error *error,
                        const char *reason) {
    if (error) {
        real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
        error->id = body->particles.id[slot];
        for (int64_t s = slot; error->id < 0 && s >= 0; s--)
            error->id = body->particles.id[s]; // padding copies the last one
        for (int a = 0; a < 3; a++) error->position[a] = a < world->settings.dimension ? (double)x[a][slot] : 0;
    }
    return brunt_fail_step(&world->clock, body, error, reason);
}

int brunt_fail_position(const brunt_world *world, int index, const double x[3], brunt_error *error,
                        const char *reason) {
    if (!error) return BRUNT_FAILED;
    const char *name = index < 0 ? "" : brunt_bodies_name(&world->bodies, index);
    error->time = world->clock.time;
    memcpy(error->position, x, sizeof error->position);
    snprintf(error->body, sizeof error->body, "%s", name);
    return brunt_fail(error, BRUNT_FAILED, "body '%s' at (%.6g, %.6g, %.6g) m, time %.9g s, step %.0f: %s", name, x[0],
                      x[1], x[2], world->clock.time, world->clock.steps, reason);
}

int brunt_fail_element(const struct brunt_clock *clock, const brunt_fem_body *fem, int32_t slot, brunt_error *error,
                       const char *reason) {
    if (!error) return BRUNT_FAILED;
    const int nodes = fem->traits->nodes;
    error->time = clock->time;
    memcpy(error->body, fem->name, sizeof error->body < sizeof fem->name ? sizeof error->body : sizeof fem->name);
    for (int32_t s = slot; s >= 0 && (error->id = fem->element_id[s]) < 0; s--) {} // padding copies the last one
    for (int a = 0; a < 3; a++) {
        error->position[a] = 0;
        for (int c = 0; c < nodes; c++)
            error->position[a] +=
                (double)brunt_fem_node(fem, fem->element_node[(size_t)slot * (size_t)nodes + (size_t)c])[a] / nodes;
    }
    const char *hint = strstr(reason, "inside out") ? "; erosion.inverted takes such elements out instead" : "";
    return brunt_fail(error, BRUNT_FAILED,
                      "body '%s', element %lld at (%.6g, %.6g, %.6g) m, time %.9g s, step %.0f: %s%s", fem->name,
                      (long long)error->id + 1, error->position[0], error->position[1], error->position[2], clock->time,
                      clock->steps, reason, hint);
}

static double element_size(const brunt_fem_body *fem, int32_t slot) {
    double x[8][3] = {{0}};
    for (int c = 0; c < fem->traits->nodes; c++)
        for (int a = 0; a < fem->dim; a++)
            x[c][a] = (double)brunt_fem_node(
                fem, fem->element_node[(size_t)slot * (size_t)fem->traits->nodes + (size_t)c])[a];
    return brunt_element_volume(fem->traits, (const double(*)[3])x);
}

static double point_size(brunt_body *body, int64_t slot) {
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    double f[9];
    for (int c = 0; c < body->grid.dim * body->grid.dim; c++) f[c] = (double)F[c][slot];
    if (body->grid.dim == 2) return f[0] * f[3] - f[1] * f[2];
    return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

int brunt_fail_turned(const brunt_world *world, brunt_error *error, const char *reason) {
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        for (int32_t s = 0; s < fem->slots; s++)
            if (fem->element_id[s] >= 0 && element_size(fem, s) <= 0)
                return brunt_fail_element(&world->clock, fem, s, error, reason);
    }
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        for (int64_t s = 0; s < body->particles.slots; s++)
            if (body->particles.id[s] >= 0 && point_size(body, s) <= 0)
                return brunt_fail_particle(world, body, s, error, reason);
    }
    return BRUNT_OK;
}
