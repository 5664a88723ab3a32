// Labels: conservation
// What the accounts say of what acts on bodies: moments about the origin, and the area that touches.
#include "tests/support/def_world.h"

#include "world/world.h"

static brunt_body_def *mesh(brunt_body_def *body, int dimension, double size) {
    body->method = BRUNT_FEM, body->element = dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, body->size = size;
    return body;
}

// Of the nodes of a mesh that has thousands of them every one has its part in the moment: a body that falls freely from
// the centre c has m c x g t after the time t, as it falls along g. Its velocities are those of half a step before.
START_TEST(gravity_turns_a_mesh_of_many_nodes) {
    const int dimension = _i + 2;
    brunt_world_def def = def_begin(dimension, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "block", XYZ(2, -1, 1), XYZ(4, 0.5, 2.5)), dimension, _i ? 0.1 : 0.03);
    static const double fall[3] = {3, -9, 1};
    const double g[3] = {fall[0], fall[1], _i ? fall[2] : 0}, c[3] = {3, -0.25, _i ? 1.75 : 0}, step = 1e-5;
    memcpy(def.gravity, g, sizeof def.gravity);
    def.step = step;
    brunt_world *world = world_take(&def);
    ck_assert_int_gt(brunt_body_nodes(world, 0), 3000);
    const double mass = world_sums(world, 0).mass;
    world_steps(world, 20);
    const brunt_momentum m = world_momentum(world);
    const double t = brunt_world_time(world) - 0.5 * step, near = 100 * ROUNDING * mass * 10 * t;
    for (int a = 0; a < 3; a++) {
        const int k = (a + 1) % 3, l = (a + 2) % 3;
        const double moment = mass * (c[k] * g[l] - c[l] * g[k]) * t;
        ck_assert_double_eq_tol(m.linear_impulse[a], mass * g[a] * t, near);
        ck_assert_double_eq_tol(m.angular_impulse[a], moment, near);
        ck_assert_double_eq_tol(m.angular[a], moment, near);
    }
    brunt_world_destroy(world);
}
END_TEST

// A block that falls on a plane, far from the origin: what the wall gives it is a push where they touch.
START_TEST(a_wall_pushes_where_it_is_touched) {
    const int dimension = _i % 2 + 2;
    const bool points = _i / 2;
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    brunt_body_def *body = def_box(&def, "block", XYZ(5, 2, 3), XYZ(6, 3, 4));
    if (!points) mesh(body, dimension, 0.25);
    def_velocity(body, 0, -2, 0);
    def_plane(&def, XYZ(0, 1.99, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    const double mass = world_sums(world, 0).mass;
    world_until(world, 0.05);
    const brunt_momentum m = world_momentum(world);
    const double push = world_boundary(world, 0).impulse[1], near = 1e3 * ROUNDING * mass * 10;
    ck_assert_double_gt(push, 0.1 * mass);
    ck_assert_double_eq_tol(m.angular_impulse[2], 5.5 * push, near);
    ck_assert_double_eq_tol(m.angular_impulse[0], dimension == 3 ? -3.5 * push : 0, near);
    for (int a = 0; a < 3; a++) {
        ck_assert_double_eq_tol(m.linear[a] - m.linear_initial[a], a == 1 ? push : 0, near);
        ck_assert_double_eq_tol(m.angular[a] - m.angular_initial[a], m.angular_impulse[a], near);
    }
    brunt_world_destroy(world);
}
END_TEST

// A block that one plane pushes against another, which gives way: what the first puts in the second takes out, and the
// error of the balance is measured against both.
START_TEST(work_that_cancels_is_a_measure) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "block", XYZ(0.001, 0, 0), XYZ(0.999, 1, 0)), 2, 0.25);
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SEPARATE, 0)->velocity[0] = 2;
    def_plane(&def, XYZ(1, 0, 0), XYZ(-1, 0, 0), BRUNT_SEPARATE, 0)->velocity[0] = 1;
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    double work[2], given = 0;
    for (int w = 0; w < 2; w++) {
        work[w] = world->boundaries.boundary[w].account.external_work;
        given += fabs(work[w]);
    }
    ck_assert_double_gt(work[0], 100);
    ck_assert_double_lt(work[1], -100);
    ck_assert_double_ge(world_energy(world).reference, given * (1 - TOLERANCE(1e-12, 1e-6)));
    brunt_world_destroy(world);
}
END_TEST

// What a plane gives a block is the sum of tractions over the block's sides: in the plane each node has an edge's
// length of them, the corners half of that below and half beside.
START_TEST(tractions_add_up_to_the_force) {
    const double size = 0.25;
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_velocity(mesh(def_box(&def, "block", XYZ(0, 1e-4, 0), XYZ(1, 1, 0)), 2, size), 0, -1, 0);
    def.bodies[0].shape.max[1] = 1 + 1e-4;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.step = 4e-4;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    const double force = world_boundary(world, 0).force[1];
    double *x = world_field(world, 0, "position"), *traction = world_field(world, 0, "contact_traction"), sum = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        if (x[3 * n + 1] > 0.1) ck_assert_double_eq(traction[3 * n + 1], 0);
        sum += size * traction[3 * n + 1];
    }
    ck_assert_double_gt(force, 1e3);
    ck_assert_double_eq_tol(sum, force, TOLERANCE(1e-10, 1e-4) * force);
    free(x), free(traction);
    brunt_world_destroy(world);
}
END_TEST

// A block that rests on a plane under its weight loses nothing to it, whatever each step's gravity is borne by.
START_TEST(what_rests_loses_nothing_in_contact) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0)), 2, 0.5);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.gravity[1] = -10;
    def.step = 1e-3;
    brunt_world *world = world_take(&def);
    world_steps(world, 50);
    ck_assert_double_lt(fabs(world_energy(world).contact), TOLERANCE(1e-9, 1e-2));
    brunt_world_destroy(world);
}
END_TEST

// A disk that comes upon a plane touches it with its face, a whole circle; tractions over what nodes have of it, and
// the outermost of the side, are the force.
START_TEST(a_disk_touches_with_its_face) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.axisymmetric = true;
    brunt_body_def *body = mesh(def_box(&def, "disk", XYZ(0, 1e-4, 0), XYZ(0.8, 0.4001, 0)), 2, 0.1);
    if (_i) body->element = BRUNT_TRI3;
    def_velocity(body, 0, -1, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.step = 2e-4;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    ck_assert_double_gt(world_boundary(world, 0).impulse[1], 0);
    ck_assert_double_eq_tol(world_boundary(world, 0).area, PI * 0.64, TOLERANCE(1e-10, 1e-4));
    const double h = 0.1, force = world_boundary(world, 0).force[1];
    double *x = world_field(world, 0, "position"), *way = world_field(world, 0, "displacement"),
           *traction = world_field(world, 0, "contact_traction"), sum = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double r = x[3 * n] - way[3 * n];                          // as it was when it was pushed
        if (r > 0.01) sum += PI * h * (r - h / 3) * traction[3 * n + 1]; // inward, outward, or up the side
        sum += PI * h * (r > 0.79 ? r : r + h / 3) * traction[3 * n + 1];
    }
    ck_assert_double_eq_tol(sum, force, TOLERANCE(1e-6, 1e-3) * force);
    free(x), free(way), free(traction);
    brunt_world_destroy(world);
}
END_TEST

// Two blocks with faces of 0.8 x 0.5 that come upon each other, with as many elements or more on one side.
START_TEST(faces_that_meet_have_their_area) {
    const int dimension = _i % 2 + 2;
    brunt_world_def def = def_begin(dimension, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    mesh(def_box(&def, "low", XYZ(0, -0.4, 0), XYZ(0.8, 0, 0.5)), dimension, 0.1);
    brunt_body_def *high = def_box(&def, "high", XYZ(0, 1e-4, 0), XYZ(0.8, 0.4, 0.5));
    mesh(high, dimension, _i / 2 ? 0.05 : 0.1);
    def_velocity(high, 0, -1, 0);
    def.step = 4e-4;
    brunt_world *world = world_take(&def);
    ck_assert_double_eq(world_pair(world, 0).area, 0);
    world_steps(world, 1);
    ck_assert_double_gt(fabs(world_pair(world, 0).impulse[1]), 0);
    ck_assert_double_eq_tol(world_pair(world, 0).area, dimension == 3 ? 0.4 : 0.8, 100 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A block turned by 20 degrees that meets a plane with an edge: what is next to the edge of the side that faces the
// plane counts, half an element, as the plane sees it. The side that rises at 70 degrees does not.
START_TEST(an_edge_has_what_is_beside_it) {
    const int dimension = _i % 2 + 2;
    const double turn = (_i / 2 ? -20 : 20) * PI / 180, size = 0.1;
    brunt_world_def def = def_begin(dimension, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *body = mesh(def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0.4)), dimension, size);
    body->place = brunt_placement_rotate(body->place, XYZ(0, 0, 1), turn, _i / 2 ? XYZ(0.4, 0, 0) : XYZ(0, 0, 0));
    def_velocity(body, 0, -1, 0);
    def_plane(&def, XYZ(0, -1e-4, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.step = 4e-4;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    ck_assert_double_gt(world_boundary(world, 0).impulse[1], 0);
    ck_assert_double_eq_tol(world_boundary(world, 0).area, cos(turn) * size / 2 * (dimension == 3 ? 0.4 : 1),
                            100 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// What the accounts say of two blocks, one of points and one of elements.
typedef struct told {
    brunt_energy energy;
    brunt_momentum momentum;
    brunt_body_sums sums[2];
} told;

static told ask(brunt_world *world) {
    told all;
    memset(&all, 0, sizeof all);
    brunt_world_energy(world, &all.energy);
    brunt_world_momentum(world, &all.momentum);
    for (int b = 0; b < 2; b++) brunt_body_totals(world, b, &all.sums[b]);
    return all;
}

// Summed up once, by one thread or more, they say the same, to the bit; and later what is so then.
START_TEST(bodies_that_are_summed_up_at_once_have_the_same_sums) {
    const int dimension = _i % 2 + 2;
    brunt_world_def def = def_begin(dimension, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0.4)), dimension, 0.1);
    def_velocity(def_box(&def, "b", XYZ(0.1, 0.41, 0.1), XYZ(0.3, 0.7, 0.3)), 0.5, -2, 0);
    memcpy(def.gravity, XYZ(0, -10, 0), sizeof def.gravity);
    def.threads = _i / 2 + 1;
    brunt_world *world = world_take(&def);
    for (int part = 0; part < 3; part++) {
        world_steps(world, 20);
        const told one_by_one = ask(world);
        brunt_world_measure(world);
        const told at_once = ask(world);
        brunt_world_forget_measure(world);
        ck_assert_int_eq(memcmp(&one_by_one, &at_once, sizeof one_by_one), 0);
    }
    brunt_world_destroy(world);
}
END_TEST

// A block that comes down into a corner of a plane that pushes and rubs and one that holds, in three dimensions, where
// what rubs along the one that holds would take from Coulomb's bound: which of them is given first is nothing to it.
START_TEST(what_is_held_is_not_rubbed) {
    static const brunt_condition conditions[] = {BRUNT_SLIP, BRUNT_SYMMETRY, BRUNT_STICK};
    brunt_energy energy[2];
    double impulse[2][2][3];
    for (int swap = 0; swap < 2; swap++) {
        brunt_world_def def = def_begin(3, 0);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        brunt_body_def *body = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 1));
        body->method = BRUNT_FEM, body->element = BRUNT_HEX8, body->size = 0.5;
        def_velocity(body, -1, 0.5, -3);
        for (int k = 0; k < 2; k++) {
            if (k == swap)
                def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0.3);
            else
                def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), conditions[_i], 0);
        }
        def.step = 5e-4;
        brunt_world *world = world_take(&def);
        world_steps(world, 40);
        energy[swap] = world_energy(world);
        for (int k = 0; k < 2; k++)
            memcpy(impulse[swap][k == swap], world_boundary(world, k).impulse, sizeof impulse[0][0]);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
    const double all = energy[0].initial, mass = 1000;
    ck_assert_double_gt(energy[0].friction, 1e-3 * all);
    for (int swap = 0; swap < 2; swap++) ck_assert_double_lt(fabs(energy[swap].error), 2e-4 * all);
    ck_assert_double_le(fabs(energy[1].friction - energy[0].friction), 100 * ROUNDING * all);
    ck_assert_double_le(fabs(energy[1].kinetic - energy[0].kinetic), 100 * ROUNDING * all);
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < 3; a++)
            ck_assert_double_le(fabs(impulse[1][k][a] - impulse[0][k][a]), 100 * ROUNDING * mass);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("accounts");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, gravity_turns_a_mesh_of_many_nodes, 0, 2);
    tcase_add_loop_test(all, a_wall_pushes_where_it_is_touched, 0, 4);
    tcase_add_test(all, work_that_cancels_is_a_measure);
    tcase_add_test(all, tractions_add_up_to_the_force);
    tcase_add_loop_test(all, a_disk_touches_with_its_face, 0, 2);
    tcase_add_test(all, what_rests_loses_nothing_in_contact);
    tcase_add_loop_test(all, faces_that_meet_have_their_area, 0, 4);
    tcase_add_loop_test(all, an_edge_has_what_is_beside_it, 0, 4);
    tcase_add_loop_test(all, bodies_that_are_summed_up_at_once_have_the_same_sums, 0, 4);
    tcase_add_loop_test(all, what_is_held_is_not_rubbed, 0, 3);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
