// Worlds of implicit steps: what their tests of meshes and of points have in common.
#pragma once

#include "tests/support/def_world.h"

// A definition that is implicit from here on, without contact.
static inline void go_implicit(brunt_world_def *def, brunt_integrator integrator, double step) {
    def->scheme = BRUNT_IMPLICIT;
    def->integrator = integrator;
    def->step = step;
    def->contact.method = BRUNT_CONTACT_NONE;
    def->newton.tolerance = 1e-11; // momentum is kept as far as forces balance
}

// The same, with room for lines and surfaces that hold material points; solved to rounding.
static inline void hold_by_surfaces(brunt_world_def *def, int order, double step) {
    def->kernel = (brunt_kernel)order;
    if (order == 1) def->transfer = BRUNT_PIC;
    def->surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def->surfaces);
    go_implicit(def, BRUNT_EULER, step);
    def->newton.tolerance = 1e-15;
}

// Whether worlds that differ in their threads only have the same state after some steps; destroys them.
static inline void check_threads(brunt_world *const *world, int count, int steps) {
    uint64_t first = 0;
    for (int w = 0; w < count; w++) {
        world_steps(world[w], steps);
        if (!w) first = brunt_world_hash(world[w]);
        ck_assert_uint_eq(brunt_world_hash(world[w]), first);
        brunt_world_destroy(world[w]);
    }
}

// Whether a world that takes up the state of another after three steps is the same after two more; destroys both.
static inline void check_restart(brunt_world *world, brunt_world *fresh) {
    world_steps(world, 3);
    world_copy_state(world, fresh);
    world_steps(world, 2), world_steps(fresh, 2);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(fresh));
    brunt_newton_counts a, b;
    brunt_world_newton(world, &a, NULL), brunt_world_newton(fresh, &b, NULL);
    ck_assert_double_eq(a.iterations, b.iterations);
    ck_assert_double_eq(world_energy(world).scheme, world_energy(fresh).scheme);
    brunt_world_destroy(world), brunt_world_destroy(fresh);
}
