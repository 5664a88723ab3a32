// Labels: stability
// Multi-velocity contact of meshes with material points, on the grid of the points: what is kept, what does not get
// through, what is left alone, friction, sheets with bodies on either side. Cells and elements are 1 m.
#include "tests/support/hard_world.h"

static const double RADIUS = 3, HEIGHT = 3.33, SPEED = 3, THICKNESS = 0.1;

// ------------------------------------------------------------------------------------------ worlds

static brunt_world_def begin(double friction) {
    brunt_world_def def = def_begin(3, 1);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
    def.contact.friction = friction;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_material(&def, "st-venant-kirchhoff", 750, 3e7, 0.3);
    return def;
}

static void hold(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", group);
}

static brunt_body_def *ball(brunt_world_def *def, const char *name, double side) {
    brunt_body_def *b = def_ball(def, name, XYZ(0.13, 0.21, HEIGHT * side), RADIUS);
    def_velocity(b, 0, 0, -SPEED * side);
    return b;
}

static brunt_body_def *block(brunt_world_def *def, const char *held) {
    brunt_body_def *b = def_box(def, "mesh", XYZ(-5, -5, -3), XYZ(5, 5, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = 1;
    if (held) hold(def, "mesh", held);
    return b;
}

static brunt_body_def *sheet(brunt_world_def *def, bool held) {
    brunt_body_def *b = def_box(def, "mesh", XYZ(-8, -8, 0), XYZ(8, 8, 1));
    b->method = BRUNT_MEMBRANE, b->element = BRUNT_MEMBRANE_QUAD4, b->size = 1;
    b->thickness = THICKNESS, b->material = 1;
    b->faces = brunt_alloc(sizeof *b->faces), b->face_count = 1;
    snprintf(b->faces[0], sizeof b->faces[0], "zmin");
    if (held) hold(def, "mesh", "border");
    return b;
}

static double stored(const brunt_energy *e) { return e->kinetic + e->internal + e->hourglass; }

// Least height of particle centres of `body` over the mesh's node that is nearest in the plane, the highest of several;
// `side` 1 or -1: upwards or downwards.
static double least_height(brunt_world *world, int body, int mesh, double side) {
    double *x = world_field(world, body, "position"), *y = world_field(world, mesh, "position"), least = INFINITY;
    for (int64_t i = 0; i < brunt_body_size(world, body, BRUNT_AT_PARTICLES); i++) {
        double near = INFINITY, z = 0;
        for (int64_t k = 0; k < brunt_body_size(world, mesh, BRUNT_AT_NODES); k++) {
            double dx = x[3 * i] - y[3 * k], dy = x[3 * i + 1] - y[3 * k + 1];
            const double d = dx * dx + dy * dy;
            if (d > near + 1e-6 || (d > near - 1e-6 && side * y[3 * k + 2] < side * z)) continue;
            near = d, z = y[3 * k + 2];
        }
        least = fmin(least, side * (x[3 * i + 2] - z));
    }
    free(x);
    free(y);
    return least;
}

// ------------------------------------------------------------------------------------------ what is kept

typedef struct kept {
    double linear, angular, energy_error, most, impulse;
} kept;

static kept watch(brunt_world *world, double end) {
    const brunt_energy start = world_energy(world);
    kept k = {0};
    while (brunt_world_time(world) < end) {
        world_until(world, fmin(end, brunt_world_time(world) + 0.05));
        const brunt_energy e = world_energy(world);
        const brunt_momentum p = world_momentum(world);
        k.linear = fmax(k.linear, p.linear_drift), k.angular = fmax(k.angular, p.angular_drift);
        k.energy_error = fmax(k.energy_error, fabs(e.error_relative));
        k.most = fmax(k.most, stored(&e) / start.initial);
    }
    const brunt_reaction f = world_pair(world, 0);
    k.impulse = fabs(f.impulse[2]);
    return k;
}

// Linear momentum to rounding, with friction, held or free, block or sheet. Angular momentum to a share of the
// kernel's width: printed. Energy balance: the ledger's own error at steps of this size.
START_TEST(momentum_is_kept_and_no_energy_made) {
    for (int k = 0; k < 4; k++) {
        const bool held = k % 2, thin = k / 2;
        brunt_world_def def = begin(0.3);
        ball(&def, "ball", 1)->velocity[0] = 0.7;
        if (thin)
            sheet(&def, held);
        else
            block(&def, held ? "zmin" : NULL);
        brunt_world *world = world_take(&def);
        const kept got = watch(world, 0.6);
        printf("%s %s: linear %.1e, angular %.1e, energy %.1e, most stored %.6f\n", held ? "held" : "free",
               thin ? "sheet" : "block", got.linear, got.angular, got.energy_error, got.most);
        ck_assert_double_gt(got.impulse, 1e4);
        ck_assert_double_lt(got.linear, ROUNDING);
        ck_assert_double_lt(got.angular, 0.05);
        ck_assert_double_lt(got.energy_error, 5e-4);
        ck_assert_double_lt(got.most, 1 + 1e-4);
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(the_same_bits_for_any_number_of_threads) {
    double *first = NULL;
    for (int threads = 1; threads <= 3; threads++) {
        brunt_world_def def = begin(0.3);
        ball(&def, "ball", 1), ball(&def, "drop", -1);
        sheet(&def, true);
        def.threads = threads;
        brunt_world *world = world_take(&def);
        world_steps(world, 90);
        ck_assert_double_gt(fabs(world_pair(world, 1).impulse[2]), 1e4);
        double *v = world_field(world, 2, "velocity");
        const size_t bytes = 3 * sizeof *v * (size_t)brunt_body_size(world, 2, BRUNT_AT_NODES);
        if (first) ck_assert_mem_eq(first, v, bytes);
        if (first)
            free(v);
        else
            first = v;
        brunt_world_destroy(world);
    }
    free(first);
}
END_TEST

START_TEST(no_memory_is_asked_for_in_a_step) {
    brunt_world_def def = begin(0.3);
    ball(&def, "ball", 1), sheet(&def, true);
    brunt_world *world = world_take(&def);
    world_until(world, 0.4);
    const int64_t before = brunt_memory_calls();
    world_steps(world, 50);
    ck_assert_int_le(brunt_memory_calls() - before, 2);
    brunt_world_destroy(world);
}
END_TEST

// A quarter with mirrors is the whole, but that the normal near a mirror is the mean of the particles on one side of
// it.
START_TEST(symmetry_planes_stand_for_the_rest) {
    double centre[2], speed[2];
    for (int quarter = 0; quarter <= 1; quarter++) {
        brunt_world_def def = begin(0);
        const double low = quarter ? 0 : -3;
        def_velocity(def_box(&def, "ball", XYZ(low, low, 0.1), XYZ(3, 3, 2.1)), 0, 0, -SPEED);
        brunt_body_def *mesh = def_box(&def, "mesh", XYZ(5 / 3.0 * low, 5 / 3.0 * low, -2), XYZ(5, 5, 0));
        mesh->method = BRUNT_FEM, mesh->element = BRUNT_HEX8, mesh->size = 1;
        hold(&def, "mesh", "zmin");
        for (int a = 0; a < 2 && quarter; a++) def_plane(&def, XYZ(0, 0, 0), XYZ(a == 0, a == 1, 0), BRUNT_SYMMETRY, 0);
        brunt_world *world = world_take(&def);
        world_until(world, 0.25);
        const brunt_body_sums sums = world_sums(world, 0);
        centre[quarter] = sums.centre[2], speed[quarter] = sums.velocity[2];
        const double drift = world_momentum(world).linear_drift;
        printf("%s: centre %.9f m, speed %.9f m/s, momentum %.1e\n", quarter ? "quarter" : "whole", sums.centre[2],
               sums.velocity[2], drift);
        ck_assert_double_lt(drift, ROUNDING);
        brunt_world_destroy(world);
    }
    ck_assert_double_lt(fabs(centre[1] - centre[0]), 1e-5);
    ck_assert_double_lt(fabs(speed[1] - speed[0]), 1e-4 * SPEED);
}
END_TEST

// ------------------------------------------------------------------------------------------ touch

// Contact begins when the ball is there, within a step or two, and not when its kernel is: a cell and a half earlier.
START_TEST(contact_begins_at_touch) {
    for (int thin = 0; thin <= 1; thin++) {
        brunt_world_def def = begin(0);
        ball(&def, "ball", 1);
        if (thin)
            sheet(&def, true);
        else
            block(&def, "surface");
        def.step = 2e-3;
        brunt_world *world = world_take(&def);
        const double due = (HEIGHT - RADIUS - (thin ? THICKNESS / 2 : 0)) / SPEED;
        while (world_pair(world, 0).impulse[2] == 0) {
            world_steps(world, 1);
            ck_assert_double_lt(brunt_world_time(world), 1);
        }
        // The lowest particles' balls touch the sphere from inside, half a spacing from its lowest point.
        const double late = (brunt_world_time(world) - due) * SPEED;
        printf("%s: first contact %.3f cells after touch\n", thin ? "sheet" : "block", late);
        ck_assert_double_gt(late, -0.01);
        ck_assert_double_lt(late, 0.05);
        brunt_world_destroy(world);
    }
}
END_TEST

// Passing by at a twentieth of a cell: nothing happens, to the bit.
START_TEST(what_does_not_touch_is_left_alone) {
    brunt_world_def def = begin(0.5);
    def_velocity(def_box(&def, "box", XYZ(-1, -1, 0.05), XYZ(1, 1, 2.05)), 1, 0.5, 0);
    block(&def, NULL);
    brunt_world *world = world_take(&def);
    world_until(world, 0.5);
    double *v = world_field(world, 1, "velocity");
    for (int64_t i = 0; i < 3 * brunt_body_size(world, 1, BRUNT_AT_NODES); i++) ck_assert(v[i] == 0);
    const brunt_reaction f = world_pair(world, 0);
    for (int a = 0; a < 3; a++) ck_assert(f.impulse[a] == 0);
    free(v);
    brunt_world_destroy(world);
}
END_TEST

// From above and from below the same, mirrored; all particles stay on their side by what they reach.
START_TEST(membranes_have_two_sides) {
    double height[2], speed[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = begin(0);
        const double side = k ? -1 : 1;
        ball(&def, "ball", side), sheet(&def, true);
        brunt_world *world = world_take(&def);
        double least = INFINITY;
        for (int i = 1; i <= 20; i++) {
            world_until(world, 0.1 * i);
            least = fmin(least, least_height(world, 0, 1, side));
        }
        const brunt_body_sums sums = world_sums(world, 0);
        height[k] = side * sums.centre[2], speed[k] = side * sums.velocity[2];
        printf("side %+.0f: least height of a particle %.3f m, back at %.4f of the speed\n", side, least,
               speed[k] / SPEED);
        ck_assert_double_gt(least, THICKNESS / 2);
        ck_assert_double_gt(speed[k], 0.8 * SPEED);
        ck_assert_double_lt(speed[k], SPEED);
        brunt_world_destroy(world);
    }
    ck_assert_double_lt(fabs(height[1] - height[0]), 1e6 * ROUNDING);
    ck_assert_double_lt(fabs(speed[1] - speed[0]), 1e6 * ROUNDING);
}
END_TEST

// Two balls squeeze a sheet of 1/40 of their mass: neither gets through, and it does not matter which is first.
START_TEST(a_membrane_keeps_two_bodies_apart) {
    brunt_world_def def = begin(0);
    ball(&def, "ball", 1), ball(&def, "drop", -1), sheet(&def, true);
    brunt_world *world = world_take(&def);
    double least = INFINITY, shift = 0;
    for (int i = 1; i <= 13; i++) {
        world_until(world, 0.05 * i);
        for (int b = 0; b < 2; b++) least = fmin(least, least_height(world, b, 2, b ? -1 : 1));
        shift = fmax(shift, fabs(world_sums(world, 0).centre[2] + world_sums(world, 1).centre[2]));
    }
    const brunt_energy e = world_energy(world);
    printf("least height of a particle %.3f m, difference of the two %.1e m, back at %.3f and %.3f m/s, energy %.1e\n",
           least, shift, world_sums(world, 0).velocity[2], world_sums(world, 1).velocity[2], e.error_relative);
    ck_assert_double_gt(least, 0.16);
    ck_assert_double_lt(shift, 3e-5);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    ck_assert_double_gt(world_sums(world, 0).velocity[2], 0.4 * SPEED);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ friction

static brunt_world *sliding_block(double friction) {
    brunt_world_def def = begin(friction);
    def_velocity(def_box(&def, "box", XYZ(-2, -1.5, 0), XYZ(1, 1.5, 2)), 2, 0, 0);
    brunt_body_def *slab = def_box(&def, "mesh", XYZ(-4.3, -3.3, -2), XYZ(6.7, 3.7, 0));
    slab->method = BRUNT_FEM, slab->element = BRUNT_HEX8, slab->size = 1;
    hold(&def, "mesh", "surface");
    def.gravity[2] = -10, def.gravity_ramp = 0.2;
    return world_take(&def);
}

// A block slides over a held slab: it slows down by mu g, it does not sink, and weight and support are one.
START_TEST(friction_slows_by_its_coefficient) {
    brunt_world *world = sliding_block(0.3);
    world_until(world, 0.25);
    const double from = world_sums(world, 0).velocity[0];
    const brunt_reaction before = world_pair(world, 0);
    world_until(world, 0.55);
    const brunt_body_sums sums = world_sums(world, 0);
    const brunt_reaction after = world_pair(world, 0);
    const double slowing = (from - sums.velocity[0]) / 0.3, *force = after.impulse, *start = before.impulse,
                 ratio = (force[0] - start[0]) / (force[2] - start[2]),
                 weight = -(force[2] - start[2]) / (3 * sums.mass);
    const double low = least_height(world, 0, 1, 1);
    printf("slows by %.4f m/s^2, tangential over normal impulse %.6f, support over weight %.4f, lowest %.4f m\n",
           slowing, ratio, weight, low);
    ck_assert_double_lt(fabs(slowing - 3), 0.06);
    ck_assert_double_lt(fabs(fabs(ratio) - 0.3), 1e-4);
    ck_assert_double_lt(fabs(weight - 1), 0.02);
    // A quarter of a cell, less 2 % that the weight strains it by: stands neither off nor in it, to 1 % of a cell.
    ck_assert_double_lt(fabs(low - 0.245), 0.01);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(without_friction_nothing_slows) {
    brunt_world *world = sliding_block(0);
    world_until(world, 0.5);
    const brunt_reaction f = world_pair(world, 0);
    ck_assert_double_gt(fabs(f.impulse[2]), 1e4);
    ck_assert_double_lt(fabs(f.impulse[0]), ROUNDING * fabs(f.impulse[2]));
    ck_assert(f.friction_work == 0);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ scenes

START_TEST(two_meshes_have_no_grid) {
    brunt_world_def def = begin(0);
    ball(&def, "ball", 1), block(&def, NULL);
    brunt_body_def *other = def_box(&def, "other", XYZ(-5, -5, -7), XYZ(5, 5, -4));
    other->method = BRUNT_FEM, other->element = BRUNT_HEX8, other->size = 1;
    brunt_error error = {0};
    ck_assert(!brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "mesh") && strstr(error.message, "other"), "%s", error.message);
    brunt_world_def_free(&def);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("grid_contact");
    const TTest *const tests[] = {momentum_is_kept_and_no_energy_made,
                                  the_same_bits_for_any_number_of_threads,
                                  no_memory_is_asked_for_in_a_step,
                                  symmetry_planes_stand_for_the_rest,
                                  contact_begins_at_touch,
                                  what_does_not_touch_is_left_alone,
                                  membranes_have_two_sides,
                                  a_membrane_keeps_two_bodies_apart,
                                  friction_slows_by_its_coefficient,
                                  without_friction_nothing_slows,
                                  two_meshes_have_no_grid};
    TCase *all = tcase_create("grid_contact");
    for (size_t k = 0; k < sizeof tests / sizeof tests[0]; k++) tcase_add_test(all, tests[k]);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
