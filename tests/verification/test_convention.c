// Labels: conservation
// Central differences for meshes, membranes and material points alike: places and stress are of the time that a world
// is at, velocities, momenta, kinetic energy and impulses of the middle of the last step. A body that is thrown is at
// v t + g t^2 / 2 exactly, with a velocity of v + g (t - dt / 2).
#include "tests/support/hard_world.h"

typedef enum kind { POINTS, TOTAL_POINTS, MESH, MEMBRANE } kind;

static const brunt_kernel kernels[] = {BRUNT_LINEAR, BRUNT_QUADRATIC, BRUNT_CUBIC};
static const brunt_transfer transfers[] = {BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC};
enum { CHOICES = 9 };

static void choose(brunt_world_def *def, int choice) {
    def->kernel = kernels[choice % 3], def->transfer = transfers[choice / 3];
}

static brunt_body_def *thrown(brunt_world_def *def, const char *name, kind k, double at) {
    const double deep = def->dimension == 3 ? 0.2 : 0;
    brunt_body_def *body = def_box(def, name, XYZ(at, 0.1, 0), XYZ(at + 0.2, 0.3, deep));
    if (k == TOTAL_POINTS) body->total_lagrangian = true;
    if (k == MESH || k == MEMBRANE) body->method = BRUNT_FEM, body->size = 0.1;
    if (k == MESH) body->element = def->dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4;
    if (k == MEMBRANE) body->method = BRUNT_MEMBRANE, body->element = BRUNT_MEMBRANE_QUAD4, body->thickness = 0.01;
    return body;
}

// Steps that change all the time.
static double uneven_step(brunt_world *world, int number) {
    brunt_error error = {0};
    const double limit = brunt_world_time(world) + (number % 3 ? 1 : 0.3) * 3e-3;
    ck_assert_msg(brunt_world_step(world, limit, &error) == BRUNT_OK, "%s", error.message);
    return brunt_world_dt(world);
}

// How far a body is off from its parabola, in places and velocities, after steps that change all the time.
static double off(kind k, int dimension, bool rings, int choice, double ramp) {
    brunt_world_def def = def_begin(dimension, 0.1);
    choose(&def, choice);
    def.axisymmetric = rings;
    def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
    def_velocity(thrown(&def, "body", k, 0.1), rings ? 0 : 1, 2, dimension == 3 ? -0.5 : 0);
    def.gravity[0] = rings ? 0 : 3, def.gravity[1] = -10;
    def.gravity_ramp = ramp;
    def.cfl = 0.3;
    brunt_world *world = world_take(&def);
    const brunt_body_sums start = world_sums(world, 0);
    double worst = 0, place[3], v[3], last = 0;
    memcpy(place, start.centre, sizeof place), memcpy(v, start.velocity, sizeof v);
    for (int s = 0; s < 40; s++) {
        const double t = brunt_world_time(world), share = ramp > 0 && t < ramp ? t / ramp : 1,
                     g[3] = {rings ? 0 : 3 * share, -10 * share, 0}, dt = uneven_step(world, s),
                     now = brunt_world_time(world);
        const brunt_body_sums sums = world_sums(world, 0);
        for (int a = 0; a < dimension; a++) {
            v[a] += 0.5 * (last + dt) * g[a], place[a] += dt * v[a];
            worst = fmax(worst, fabs(sums.centre[a] - place[a]));
            worst = fmax(worst, fabs(sums.velocity[a] - v[a]));
            if (ramp > 0) continue; // else these are the parabola itself
            ck_assert_double_eq_tol(v[a], start.velocity[a] + g[a] * (now - 0.5 * dt), 1e-12);
            ck_assert_double_eq_tol(place[a], start.centre[a] + now * (start.velocity[a] + 0.5 * g[a] * now), 1e-12);
        }
        last = dt;
    }
    const brunt_momentum m = world_momentum(world);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e4 * ROUNDING);
    brunt_world_destroy(world);
    return worst;
}

START_TEST(every_kind_is_on_its_parabola) {
    const double ramp = _i ? 0.02 : 0, bound = 10 * ROUNDING;
    for (int choice = 0; choice < CHOICES; choice++) {
        ck_assert_double_le(off(POINTS, 2, false, choice, ramp), bound);
        ck_assert_double_le(off(POINTS, 2, true, choice, ramp), bound);
        ck_assert_double_le(off(POINTS, 3, false, choice, ramp), bound);
    }
    ck_assert_double_le(off(TOTAL_POINTS, 2, false, 7, ramp), bound);
    ck_assert_double_le(off(TOTAL_POINTS, 3, false, 7, ramp), bound);
    ck_assert_double_le(off(MESH, 2, false, 0, ramp), bound);
    ck_assert_double_le(off(MESH, 2, true, 0, ramp), bound);
    ck_assert_double_le(off(MESH, 3, false, 0, ramp), bound);
    ck_assert_double_le(off(MEMBRANE, 3, false, 0, ramp), bound);
}
END_TEST

// One of each kind, thrown alike: they never part. Turned round (other order of names and places) and without weight.
START_TEST(thrown_bodies_of_each_kind_agree) {
    for (int turned = 0; turned < 2; turned++) {
        brunt_world_def def = def_begin(3, 0.1);
        def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
        static const char *const names[] = {"a", "b", "c"};
        static const kind kinds[] = {POINTS, MESH, MEMBRANE};
        for (int k = 0; k < 3; k++)
            def_velocity(thrown(&def, names[turned ? 2 - k : k], kinds[k], (turned ? -1 : 1) * (0.1 + k)), 1, 2, 3);
        def.gravity[1] = _i ? 0 : turned ? 10 : -10;
        def.cfl = 0.4;
        def.contact.method = BRUNT_CONTACT_NONE;
        brunt_world *world = world_take(&def);
        brunt_body_sums start[3];
        for (int k = 0; k < 3; k++) start[k] = world_sums(world, k);
        for (int s = 0; s < 60; s++) {
            world_steps(world, 1);
            for (int k = 1; k < 3; k++)
                for (int a = 0; a < 3; a++) {
                    const brunt_body_sums one = world_sums(world, 0), other = world_sums(world, k);
                    ck_assert_double_eq_tol(one.centre[a] - start[0].centre[a], other.centre[a] - start[k].centre[a],
                                            10 * ROUNDING);
                    ck_assert_double_eq_tol(one.velocity[a], other.velocity[a], 30 * ROUNDING);
                }
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// Weight on a plane is all of the weight in each step, the first one and those that are cut short too: force is impulse
// over what it acted in.
START_TEST(force_is_that_of_the_kick) {
    for (int k = POINTS; k <= MESH; k += MESH) {
        brunt_world_def def = def_begin(2, 0.1);
        def_material(&def, "neo-hookean", 1000, 1e4, 0);
        brunt_body_def *body = thrown(&def, "body", (kind)k, 0);
        body->shape.min[1] = 0, body->shape.max[1] = k == POINTS ? 0.05 : 0.1;
        if (k == POINTS) body->shape.max[0] = 0.05, body->particles_per_cell = 4;
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
        def.gravity[1] = -10;
        def.cfl = 0.3;
        brunt_world *world = world_take(&def);
        for (int s = 0; s < 3; s++) {
            brunt_error error = {0};
            ck_assert_int_eq(brunt_world_step(world, brunt_world_time(world) + (s % 2 ? 1e-3 : 2e-3), &error),
                             BRUNT_OK);
            const brunt_body_sums sums = world_sums(world, 0);
            const brunt_reaction f = world_boundary(world, 0);
            ck_assert_double_eq_tol(sums.momentum[1],
                                    f.impulse[1] -
                                        10 * sums.mass * (brunt_world_time(world) - 0.5 * brunt_world_dt(world)),
                                    10 * ROUNDING * sums.mass);
            if (s == 0) ck_assert_double_eq_tol(f.force[1] * 0.5 * brunt_world_dt(world), f.impulse[1], ROUNDING);
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// A body that breathes, with steps that take turns: where a mesh is after a time is of second order in the step, and
// the account of its energy and of that of points. Points are on a grid that stays with the body, with FLIP: else each
// step's transfers take some of the motion, so that there is no limit for small steps.
static double breath(kind k, double step, double *error_of_energy) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e5, 0);
    brunt_body_def *body = thrown(&def, "body", k, 0.1);
    def.transfer = BRUNT_FLIP, def.flip = 1;
    body->wave_velocity[0] = 0.5, body->wave_vector[0] = PI / 0.2, body->wave_phase = -PI / 0.2 * 0.2;
    def.cfl = 0.5;
    brunt_world *world = world_take(&def);
    for (int s = 0; brunt_world_time(world) < 0.012 - 1e-9; s++) {
        brunt_error error = {0};
        const double limit = brunt_world_time(world) + (s % 2 ? 0.7 : 1.3) * step;
        ck_assert_int_eq(brunt_world_step(world, fmin(limit, 0.012), &error), BRUNT_OK);
    }
    double *x = world_field(world, 0, "position");
    const double place = x[0];
    *error_of_energy = fabs(world_energy(world).error_relative);
    free(x);
    brunt_world_destroy(world);
    return place;
}

START_TEST(oscillator_is_of_second_order) {
    double place[4], energy[4];
    const kind k = _i ? MESH : TOTAL_POINTS;
    for (int r = 0; r < 4; r++) place[r] = breath(k, 1.2e-3 / (1 << r) / 2, &energy[r]);
    const double first = fabs(place[1] - place[0]), second = fabs(place[2] - place[1]),
                 third = fabs(place[3] - place[2]);
    printf("%s: %.3e %.3e %.3e, energy %.1e %.1e %.1e %.1e\n", _i ? "mesh" : "points", first, second, third, energy[0],
           energy[1], energy[2], energy[3]);
    // What the last kick gave moves points before it has been to the particles and back: of first order, though small.
    ck_assert_double_lt(third, (_i ? 0.35 : 0.6) * second);
    ck_assert_double_lt(energy[3], fmax(0.1 * energy[1], 1e4 * ROUNDING));
}
END_TEST

// All nodes of a body are told how to go: by a velocity that grows, or the way of one. Places are those of the time of
// a line of the history, velocities those of the middle of the step; the force that holds them is mass times
// acceleration in each step, and its work the kinetic energy.
START_TEST(prescribed_nodes_go_as_they_are_told) {
    const kind k = _i % 2 ? MEMBRANE : MESH;
    const brunt_group_action action = _i < 2 ? BRUNT_GROUP_VELOCITY : BRUNT_GROUP_DISPLACEMENT;
    static const double a[3] = {4, -3, 2}, end = 0.06;
    enum { POINTS_OF_WAY = 2000 };
    brunt_world_def def = def_begin(3, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
    brunt_body_def *body = thrown(&def, "body", k, 0.1);
    body->size = 0.2;
    def.cfl = 0.3;
    def.groups = brunt_alloc(sizeof *def.groups), def.group_count = 1;
    brunt_group_def *group = &def.groups[0];
    *group = brunt_group_def_default();
    snprintf(group->body, sizeof group->body, "body"), snprintf(group->group, sizeof group->group, "surface");
    group->action = action;
    const bool way = action == BRUNT_GROUP_DISPLACEMENT;
    group->table.points = brunt_alloc((POINTS_OF_WAY + 1) * sizeof *group->table.points);
    group->table.count = way ? POINTS_OF_WAY + 1 : 2;
    for (int c = 0; c < 3; c++) group->component[c] = true, group->value[c] = a[c];
    for (int q = 0; q < group->table.count; q++) {
        const double t = end * q / (group->table.count - 1);
        group->table.points[q][0] = t, group->table.points[q][1] = way ? 0.5 * t * t : t;
    }
    // Between its points a way is cut straight: off by an eighth of their distance squared, at most.
    const double off = way ? end * end / POINTS_OF_WAY / POINTS_OF_WAY : 0;
    brunt_world *world = world_take(&def);
    const brunt_body_sums start = world_sums(world, 0);
    double last = 0;
    for (int s = 0; brunt_world_time(world) < end - 4e-3; s++) {
        const double dt = uneven_step(world, s), kick = 0.5 * (last + dt), now = brunt_world_time(world);
        const brunt_body_sums sums = world_sums(world, 0);
        const brunt_reaction f = world_boundary(world, 0);
        for (int c = 0; c < 3; c++) {
            const double v = a[c] * (now - 0.5 * dt);
            ck_assert_double_eq_tol(sums.centre[c], start.centre[c] + 0.5 * a[c] * now * now, off + 10 * ROUNDING);
            ck_assert_double_eq_tol(sums.velocity[c], v, 2 * off / dt + 1e3 * ROUNDING);
            ck_assert_double_eq_tol(f.impulse[c], sums.mass * v, sums.mass * (2 * off / dt + 1e3 * ROUNDING));
            ck_assert_double_eq_tol(f.force[c], sums.mass * a[c], sums.mass * (4 * off / dt + 1e3 * ROUNDING) / kick);
        }
        last = dt;
    }
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e4 * ROUNDING);
    ck_assert_double_le(world_momentum(world).linear_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A rigid plane that moves takes along what sticks to it, to where it is itself at the time of the line; what it pushes
// is never behind it. A body that goes with it from the start feels nothing.
START_TEST(planes_take_nodes_to_where_they_are) {
    static const double V[3] = {0.4, -0.7, 0.5};
    for (int with = 0; with < 2; with++) {
        const brunt_condition condition = _i ? BRUNT_SEPARATE : BRUNT_STICK;
        brunt_world_def def = def_begin(3, 0.1);
        def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
        brunt_body_def *body = thrown(&def, "body", MESH, 0);
        if (with) def_velocity(body, V[0], V[1], V[2]);
        brunt_plane_def *plane = def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), condition, 0);
        memcpy(plane->velocity, V, sizeof V);
        def.cfl = 0.3;
        brunt_world *world = world_take(&def);
        for (int s = 0; s < 30; s++) {
            const double dt = uneven_step(world, s), now = brunt_world_time(world);
            const brunt_body_sums sums = world_sums(world, 0);
            ck_assert_double_ge(sums.low[2], V[2] * now - 10 * ROUNDING);
            if (condition == BRUNT_STICK || with || s == 0)
                ck_assert_double_eq_tol(sums.low[2], V[2] * now, 10 * ROUNDING);
            const brunt_reaction f = world_boundary(world, 0);
            for (int a = 0; a < 3; a++)
                ck_assert_double_eq_tol(sums.momentum[a], f.impulse[a] + (with ? sums.mass * V[a] : 0),
                                        100 * ROUNDING * sums.mass);
            if (with)
                ck_assert_double_eq_tol(f.impulse[2], 0, 10 * ROUNDING);
            else if (s == 0)
                ck_assert_double_eq_tol(f.force[2] * 0.5 * dt, sums.momentum[2], 10 * ROUNDING);
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// A region prescribes the velocity of all of a body of material points, from a time on that is between two steps.
START_TEST(regions_move_points_from_their_start_on) {
    for (int dimension = 2; dimension <= 3; dimension++) {
        static const double V[3] = {0.4, -0.7, 0.5};
        brunt_world_def def = def_begin(dimension, 0.1);
        def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
        thrown(&def, "body", POINTS, 0.1);
        def.regions = brunt_alloc(sizeof *def.regions), def.region_count = 1;
        brunt_region_def *region = &def.regions[0];
        *region = brunt_region_def_default();
        region->shape.kind = BRUNT_BOX;
        for (int a = 0; a < 3; a++) {
            region->shape.min[a] = -9, region->shape.max[a] = 9;
            region->component[a] = a < dimension, region->velocity[a] = V[a];
        }
        region->start = _i ? 0.01 : 0;
        def.cfl = 0.3;
        brunt_world *world = world_take(&def);
        double place[3];
        memcpy(place, world_sums(world, 0).centre, sizeof place);
        for (int s = 0; s < 20; s++) {
            const bool active = brunt_world_time(world) >= (_i ? 0.01 : 0);
            const double dt = uneven_step(world, s);
            const brunt_body_sums sums = world_sums(world, 0);
            for (int a = 0; a < dimension; a++) {
                place[a] += active ? dt * V[a] : 0;
                ck_assert_double_eq_tol(sums.velocity[a], active ? V[a] : 0, 10 * ROUNDING);
                ck_assert_double_eq_tol(sums.centre[a], place[a], 10 * ROUNDING);
                ck_assert_double_eq_tol(world_boundary(world, 0).impulse[a], sums.momentum[a],
                                        10 * ROUNDING * sums.mass);
            }
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// A restart after the first step, whose kick is half of one, and later.
START_TEST(restart_keeps_bits_and_forces) {
    for (int before = 1; before < 8; before += 6) {
        brunt_world_def def = def_begin(2, 0.1);
        def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
        thrown(&def, "a", POINTS, 0.1), thrown(&def, "b", MESH, 0.6);
        def_plane(&def, XYZ(0, 0.1, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        def.gravity[1] = -10;
        brunt_world *whole = world_from(&def), *first = world_from(&def), *second = world_from(&def);
        brunt_world_def_free(&def);
        world_steps(whole, 20), world_steps(first, before);
        world_copy_state(first, second);
        world_steps(second, 20 - before);
        ck_assert_uint_eq(brunt_world_hash(whole), brunt_world_hash(second));
        ck_assert_double_eq(world_boundary(whole, 0).force[1], world_boundary(second, 0).force[1]);
        ck_assert_double_eq(world_energy(whole).error, world_energy(second).error);
        brunt_world_destroy(whole), brunt_world_destroy(first), brunt_world_destroy(second);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("convention");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, every_kind_is_on_its_parabola, 0, 2);
    tcase_add_loop_test(all, thrown_bodies_of_each_kind_agree, 0, 2);
    tcase_add_test(all, force_is_that_of_the_kick);
    tcase_add_loop_test(all, oscillator_is_of_second_order, 0, 2);
    tcase_add_loop_test(all, prescribed_nodes_go_as_they_are_told, 0, 4);
    tcase_add_loop_test(all, planes_take_nodes_to_where_they_are, 0, 2);
    tcase_add_loop_test(all, regions_move_points_from_their_start_on, 0, 2);
    tcase_add_test(all, restart_keeps_bits_and_forces);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
