// Worlds built from definitions, through the public interface alone: what the tests of the physics have in common.
#pragma once

#include "tests/support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "base/memory.h"
#include "base/real.h"
#include "tests/support/suite.h"

// What rounding may leave of a conserved quantity after some hundred steps, relative.
#ifdef BRUNT_FLOAT
#define ROUNDING 1e-5
#else
#define ROUNDING 1e-12
#endif
#define PI 3.14159265358979323846
#define XYZ(...) ((const double[3]){__VA_ARGS__})

// Adds to `suite` a test, once for each number below `count`, as a case of its name: CK_RUN_CASE picks it.
#define ADD_LOOP(test, count)                                                                                          \
    do {                                                                                                               \
        TCase *tests = tcase_create(#test);                                                                            \
        tcase_add_loop_test(tests, test, 0, count);                                                                    \
        suite_add_tcase(suite, tests);                                                                                 \
    } while (0)

enum { DEF_CAPACITY = 12 };

// A definition with room for a dozen bodies, planes and materials, one thread and no limit on the time.
static inline brunt_world_def def_begin(int dimension, double cell) {
    brunt_world_def def = brunt_world_def_default();
    def.dimension = dimension;
    def.cell = cell;
    def.end = 1e6;
    def.threads = 1;
    def.energy_limit = INFINITY;
    def.materials = brunt_alloc(DEF_CAPACITY * sizeof *def.materials);
    def.bodies = brunt_alloc(DEF_CAPACITY * sizeof *def.bodies);
    def.planes = brunt_alloc(DEF_CAPACITY * sizeof *def.planes);
    return def;
}

static inline brunt_material_def *def_material(brunt_world_def *def, const char *model, double density, double E,
                                               double nu) {
    brunt_material_def *m = &def->materials[def->material_count++];
    snprintf(m->name, sizeof m->name, "material%d", def->material_count);
    snprintf(m->strength, sizeof m->strength, "%s", model);
    m->density = density;
    m->strength_parameters[0] = E;
    m->strength_parameters[1] = nu;
    return m;
}

static inline brunt_body_def *def_body(brunt_world_def *def, const char *name) {
    brunt_body_def *b = &def->bodies[def->body_count++];
    *b = brunt_body_def_default();
    snprintf(b->name, sizeof b->name, "%s", name);
    b->material = 0;
    return b;
}

// Made of the first material; in two dimensions the third components are not looked at.
static inline brunt_body_def *def_box(brunt_world_def *def, const char *name, const double min[3],
                                      const double max[3]) {
    brunt_body_def *b = def_body(def, name);
    b->shape.kind = BRUNT_BOX;
    memcpy(b->shape.min, min, sizeof b->shape.min);
    memcpy(b->shape.max, max, sizeof b->shape.max);
    return b;
}

static inline brunt_body_def *def_ball(brunt_world_def *def, const char *name, const double center[3], double radius) {
    brunt_body_def *b = def_body(def, name);
    b->shape.kind = BRUNT_SPHERE;
    memcpy(b->shape.center, center, sizeof b->shape.center);
    b->shape.radius = radius;
    return b;
}

static inline void def_velocity(brunt_body_def *body, double x, double y, double z) {
    body->velocity[0] = x, body->velocity[1] = y, body->velocity[2] = z;
}

static inline brunt_plane_def *def_plane(brunt_world_def *def, const double point[3], const double normal[3],
                                         brunt_condition condition, double friction) {
    brunt_plane_def *p = &def->planes[def->plane_count++];
    *p = brunt_plane_def_default();
    memcpy(p->point, point, sizeof p->point);
    memcpy(p->normal, normal, sizeof p->normal);
    p->condition = condition;
    p->friction = friction;
    return p;
}

static inline brunt_world *world_from(const brunt_world_def *def) {
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    return world;
}

// For a definition that is not needed any more.
static inline brunt_world *world_take(brunt_world_def *def) {
    brunt_world *world = world_from(def);
    if (def->region_count) return world; // a world shares its regions' shapes with the definition
    brunt_world_def_free(def);
    return world;
}

static inline void world_steps(brunt_world *world, int count) {
    brunt_error error = {0};
    for (int s = 0; s < count; s++) {
        int status = brunt_world_step(world, INFINITY, &error);
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    }
}

static inline void world_until(brunt_world *world, double time) {
    brunt_error error = {0};
    while (brunt_world_time(world) < time) {
        int status = brunt_world_step(world, time, &error);
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    }
}

static inline double *world_field(brunt_world *world, int body, const char *name) { // free()
    int32_t field = brunt_body_find_field(world, body, name);
    ck_assert_msg(field >= 0, "there is no field %s", name);
    brunt_field_info info = brunt_body_field(world, body, field);
    size_t n = (size_t)brunt_body_size(world, body, info.at) * (size_t)info.components;
    double *values = malloc(n * sizeof *values);
    brunt_body_read(world, body, field, values);
    return values;
}

static inline brunt_energy world_energy(brunt_world *world) {
    brunt_energy e;
    brunt_world_energy(world, &e);
    return e;
}
static inline brunt_momentum world_momentum(brunt_world *world) {
    brunt_momentum m;
    brunt_world_momentum(world, &m);
    return m;
}
static inline brunt_body_sums world_sums(brunt_world *world, int body) {
    brunt_body_sums s;
    brunt_body_totals(world, body, &s);
    return s;
}
static inline brunt_reaction world_pair(const brunt_world *world, int pair) {
    brunt_reaction f;
    brunt_pair_force(world, pair, &f);
    return f;
}
static inline brunt_reaction world_boundary(const brunt_world *world, int wall) {
    brunt_reaction f;
    brunt_boundary_reaction(world, wall, &f);
    return f;
}

// The state of a world into another of the same definition.
static inline void world_copy_state(brunt_world *from, brunt_world *to) {
    brunt_error error = {0};
    ck_assert_int_eq(brunt_state_count(from), brunt_state_count(to));
    for (int32_t b = 0; b < brunt_state_count(from); b++) {
        const brunt_state_block block = brunt_state_info(from, b);
        void *bytes = malloc((size_t)block.count * 8 + 8);
        brunt_state_get(from, b, bytes);
        ck_assert_msg(brunt_state_set(to, b, bytes, block.count, &error) == BRUNT_OK, "%s", error.message);
        free(bytes);
    }
    ck_assert_msg(brunt_state_done(to, &error) == BRUNT_OK, "%s", error.message);
}

// Whether the last body of a definition, thrown at (1, 2), falls as gravity (3, -10) makes it.
static inline void def_falls_freely(brunt_world_def *def) {
    def->gravity[0] = 3, def->gravity[1] = -10;
    def_velocity(&def->bodies[def->body_count - 1], 1, 2, 0);
    brunt_world *w = world_take(def);
    world_steps(w, 20);
    const double t = brunt_world_time(w) - 0.5 * brunt_world_dt(w); // velocities are of the middle of the step
    const brunt_body_sums s = world_sums(w, 0);
    ck_assert_double_eq_tol(s.velocity[0], 1 + 3 * t, 10 * ROUNDING);
    ck_assert_double_eq_tol(s.velocity[1], 2 - 10 * t, 10 * ROUNDING);
    brunt_world_destroy(w);
}
