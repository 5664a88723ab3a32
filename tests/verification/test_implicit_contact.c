// Barriers in implicit steps: weight at rest, sliding, impacts, planes that move, prescribed motion, bits.
#include <math.h>

#include "tests/support/def_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static brunt_world_def begin(int dim, brunt_integrator integrator, double step) {
    brunt_world_def def = def_begin(dim, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.scheme = BRUNT_IMPLICIT, def.integrator = integrator, def.step = step;
    def.contact.method = BRUNT_CONTACT_BARRIER;
    def.newton.tolerance = 1e-11;
    return def;
}

static brunt_body_def *mesh(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                            double size) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = def->dimension == 3 ? BRUNT_TET4 : BRUNT_TRI3, b->size = size;
    return b;
}

static brunt_group_def *hold(brunt_world_def *def, const char *body, const char *group) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body);
    snprintf(g->group, sizeof g->group, "%s", group);
    return g;
}

static double least_part(const brunt_world *world) {
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    return counts.least_part;
}

// ------------------------------------------------------------------------------------------ at rest

// A block on a held one, of elements (0) or points (1), and on a plane (2, 3): at rest it is borne by its weight.
START_TEST(rests) {
    const bool points = _i % 2, plane = _i / 2;
    brunt_world_def def = begin(2, BRUNT_EULER, 0.05);
    if (plane) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    } else {
        mesh(&def, "floor", XYZ(-1, -0.5, 0), XYZ(2, 0, 0), 0.25);
        hold(&def, "floor", "ymin");
    }
    const double up = points ? -0.03 : 0.02;
    if (points)
        def_box(&def, "upper", XYZ(0, up, 0), XYZ(1, 0.5 + up, 0));
    else
        mesh(&def, "upper", XYZ(0, up, 0), XYZ(1, 0.5 + up, 0), 0.25);
    def.gravity[1] = -10;
    def.contact.distance = 0.025;
    def.newton.tolerance = 1e-10;
    brunt_world *world = world_take(&def);
    world_steps(world, 160);
    const brunt_reaction f = plane ? world_boundary(world, 0) : world_pair(world, 0);
    const brunt_energy e = world_energy(world);
    printf("  %s on %s: %.9g N of 5000, least gap %.3f of the distance, energy error %.1e, drift %.1e\n",
           points ? "points" : "elements", plane ? "a plane" : "elements", f.force[1], least_part(world),
           e.error_relative, world_momentum(world).linear_drift);
    ck_assert_double_eq_tol(f.force[1], 5000, 5e-3);
    // 1 m; corners stand for half an edge beside it, points for the disc of their volume.
    ck_assert_msg(f.area > 0.95 && f.area < 1.3, "%g m touch", f.area);
    ck_assert_double_gt(least_part(world), 0.1);
    ck_assert_double_le(fabs(e.error_relative), 1e-4);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ sliding

// A block on a plane that is tilted, by turning gravity: g (sin - mu cos), or none when friction is enough. (Under
// Newmark's rule what sticks goes on ringing.)
START_TEST(slides) {
    const double mu = (const double[]){0, 0.1, 0.3}[_i % 3], tilt = 0.2, exact = mu < tilt ? 10 * (tilt - mu) : 0;
    const bool newmark = _i / 3;
    brunt_world_def def = begin(2, newmark ? BRUNT_NEWMARK : BRUNT_EULER, 0.01);
    mesh(&def, "block", XYZ(0, 0.0245, 0), XYZ(1, 0.5245, 0), 0.25);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, mu);
    def.gravity[0] = 10 * tilt, def.gravity[1] = -10;
    def.contact.distance = 0.025, def.contact.slip_speed = 1e-4;
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    const double v0 = world_sums(world, 0).velocity[0];
    world_until(world, 0.8);
    const double a = (world_sums(world, 0).velocity[0] - v0) / 0.6;
    const brunt_energy e = world_energy(world);
    printf("  mu %.1f: %.6f of %.6f m/s^2, v %.3e, friction %.4g J, energy error %.1e\n", mu, a, exact,
           world_sums(world, 0).velocity[0], e.friction, e.error_relative);
    ck_assert_double_eq_tol(a, exact, 0.02);
    if (mu > tilt) ck_assert_double_le(fabs(world_sums(world, 0).velocity[0]), 2e-4);
    ck_assert_double_ge(e.friction, 0);
    ck_assert_double_le(fabs(e.error_relative), 1e-4);
    ck_assert_double_eq_tol(world_boundary(world, 0).friction_work, e.friction, 1e-12 * e.friction + 1e-300);
    brunt_world_destroy(world);
}
END_TEST

// A soft block on a held floor is pressed and sheared by a plate with friction: at any time some of its surface slips
// and some sticks, on either side of a slip of 0.1 um in steps of millimetres. That takes 11 iterations a step, where 7
// are taken without friction (linearised by the slip alone 17, 133 in one step, and one is cut). What slips is heated
// by the pair in which it does.
START_TEST(pressed_and_sheared) {
    const double mu = _i ? 0.5 : 0;
    brunt_world_def def = begin(2, BRUNT_EULER, 0.01);
    mesh(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.4, 0), 0.05);
    mesh(&def, "plate", XYZ(-1, 0.4005, 0), XYZ(2, 0.6, 0), 3);
    def_plane(&def, XYZ(0, 1e-9, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    brunt_group_def *press = hold(&def, "plate", "surface");
    press->value[0] = 1, press->value[1] = -0.25;
    def.contact.distance = 1e-3, def.contact.stiffness = 1e5;
    def.contact.friction = mu, def.contact.slip_speed = 1e-5;
    def.newton.tolerance = 1e-7;
    brunt_world *world = world_take(&def);
    world_steps(world, 20);
    const brunt_energy e = world_energy(world);
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    const double share = world_pair(world, 0).force[0] / world_pair(world, 0).force[1];
    printf("  mu %.1f: %g iterations in %g steps, at most %g; friction %.4g J, share of the normal force %.3f\n", mu,
           counts.iterations, counts.steps, counts.iterations_worst, e.friction, share);
    ck_assert_double_eq(counts.cuts, 0);
    ck_assert_double_le(counts.iterations, (_i ? 12 : 8) * counts.steps);
    ck_assert_double_le(fabs(e.error_relative), 1e-4);
    if (_i) ck_assert_double_gt(e.friction, 1000);
    ck_assert_double_eq_tol(world_pair(world, 0).friction_work, e.friction, 1e-12 * e.friction + 1e-300);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ impact

// Two blocks, one of points, meet: momentum is kept, energy is booked, nothing passes, whatever the step.
START_TEST(collide) {
    const double step = (const double[]){1e-3, 1e-2, 0.1}[_i];
    brunt_world_def def = begin(2, BRUNT_EULER, step);
    def_velocity(def_box(&def, "points", XYZ(-1.1, 0, 0), XYZ(-0.1, 0.5, 0)), 2, 0, 0);
    def_velocity(mesh(&def, "solid", XYZ(0, 0.02, 0), XYZ(1, 0.52, 0), 0.25), -2, 0, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.3);
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    const double apart = world_sums(world, 1).low[0] - world_sums(world, 0).high[0];
    printf("  step %g: drift %.1e, energy error %.1e, %.4f m apart, least gap %.2g of the distance\n", step,
           m.linear_drift, e.error_relative, apart, least_part(world));
    ck_assert_double_le(m.linear_drift, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-4);
    ck_assert_double_gt(apart, 0);
    ck_assert_double_gt(least_part(world), 0);
    ck_assert_double_gt(world_pair(world, 0).impulse[0], 0);
    brunt_world_destroy(world);
}
END_TEST

// Steps that are solved roughly, with friction and gravity along one axis, keep momentum to rounding where nothing is
// held (0, 1); where a plane pushes, momentum and its impulse are as far off each other as forces are left (2).
START_TEST(rough_steps_keep_momentum) {
    brunt_world_def def = begin(2, _i == 1 ? BRUNT_NEWMARK : BRUNT_EULER, 2e-3);
    def_velocity(def_box(&def, "points", XYZ(-1.1, 0.5, 0), XYZ(-0.1, 1, 0)), 2, 1, 0);
    def_velocity(mesh(&def, "solid", XYZ(0, 0.52, 0), XYZ(1, 1.02, 0), 0.25), -3, 0.5, 0);
    if (_i == 2) def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.contact.friction = 0.3, def.gravity[1] = -10;
    def.newton.tolerance = 1e-4, def.newton.solver = BRUNT_SOLVER_PCG, def.newton.accuracy = 0.3;
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    const double drift = world_momentum(world).linear_drift, force = world_pair(world, 0).impulse[0];
    printf("  drift %.1e\n", drift);
    ck_assert_double_gt(fabs(force), 1);
    ck_assert_double_le(drift, _i == 2 ? 1e-2 : 1e-14);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is moved

// A plane (0) or a held mesh (1) pushes a block up by half a metre in two steps: it goes along, and the work done on it
// is what it has gained. What moves draws along what it pushes: it does not go from gap to gap.
START_TEST(pushed) {
    brunt_world_def def = begin(2, BRUNT_EULER, 0.25);
    mesh(&def, "block", XYZ(0, 0.03, 0), XYZ(1, 0.53, 0), 0.25);
    if (_i) {
        mesh(&def, "ram", XYZ(-0.5, -0.5, 0), XYZ(1.5, 0, 0), 0.5);
        hold(&def, "ram", "surface")->value[1] = 1;
    } else {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0)->velocity[1] = 1;
    }
    def.gravity[1] = -10;
    def.newton.tolerance = 1e-12;
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[1];
    world_steps(world, 2);
    const brunt_energy e = world_energy(world);
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    printf("  lifted %.4f m, energy error %.1e, least gap %.3f, %g iterations\n",
           world_sums(world, 0).centre[1] - before, e.error_relative, least_part(world), counts.iterations);
    ck_assert_double_le(counts.iterations, 60);
    ck_assert_double_eq_tol(world_sums(world, 0).centre[1] - before, 0.5, 0.05);
    ck_assert_double_le(fabs(e.error_relative), 1e-4);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// Where bodies coast to is where a step begins: points that go along with a plate that is drawn (0), or slide on one
// that stays (1), are at once nearly where they are to be.
START_TEST(coasts) {
    brunt_world_def def = begin(2, BRUNT_EULER, 0.01);
    mesh(&def, "plate", XYZ(-1, -0.25, 0), XYZ(3, 0, 0), 0.25);
    brunt_group_def *draw = hold(&def, "plate", "surface");
    draw->value[0] = _i == 0;
    def_velocity(def_box(&def, "points", XYZ(0, 0.02, 0), XYZ(0.5, 0.52, 0)), 1, 0, 0);
    def.contact.friction = _i ? 0.05 : 0.5, def.gravity[1] = -10;
    def.newton.tolerance = 1e-6;
    brunt_world *world = world_take(&def);
    brunt_newton_counts before, after;
    world_steps(world, 40);
    brunt_world_newton(world, &before, NULL);
    world_steps(world, 40);
    brunt_world_newton(world, &after, NULL);
    printf("  %g iterations in 40 steps, at %.3f m/s\n", after.iterations - before.iterations,
           world_sums(world, 1).velocity[0]);
    ck_assert_double_le(after.iterations - before.iterations, 100); // from where bodies were 200 and more
    ck_assert_double_eq_tol(world_sums(world, 1).velocity[0], _i ? 1 - 0.05 * 10 * 0.8 : 1, 0.02);
    brunt_world_destroy(world);
}
END_TEST

// However many solutions of a step friction may have, none is sought once pressures no longer change.
START_TEST(friction_settles) {
    double iterations[3], speed[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = begin(2, BRUNT_EULER, 0.01);
        mesh(&def, "floor", XYZ(-1, -0.25, 0), XYZ(3, 0, 0), 0.25);
        hold(&def, "floor", "surface");
        def_velocity(mesh(&def, "block", XYZ(0, 0.01, 0), XYZ(0.5, 0.51, 0), 0.25), 1, -1, 0);
        def.contact.friction = 0.3, def.gravity[1] = -10, def.newton.tolerance = 1e-8;
        def.contact.friction_iterations = k == 0 ? 1 : k == 1 ? 50 : 1000;
        brunt_world *world = world_take(&def);
        world_steps(world, 10);
        brunt_newton_counts counts;
        brunt_world_newton(world, &counts, NULL);
        iterations[k] = counts.iterations, speed[k] = world_sums(world, 0).velocity[0];
        brunt_world_destroy(world);
    }
    printf("  %g, %g, %g iterations, at %.6f, %.6f, %.6f m/s\n", iterations[0], iterations[1], iterations[2], speed[0],
           speed[1], speed[2]);
    ck_assert_double_lt(iterations[1], 10 * 50);
    ck_assert_double_eq(iterations[2], iterations[1]);
    ck_assert_double_eq(speed[2], speed[1]);
}
END_TEST

// ------------------------------------------------------------------------------------------ solvers

// Points on elements that are held, drawn along with friction: whichever solver, the same places.
// ------------------------------------------------------------------------------------------ what is said

static brunt_world *falling(brunt_integrator integrator, double step) {
    brunt_world_def def = begin(2, integrator, step);
    def_velocity(mesh(&def, "block", XYZ(0, 0.02, 0), XYZ(0.5, 0.52, 0), 0.125), 0, -2, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.contact.distance = 0.01, def.contact.stiffness = 1e6;
    return world_take(&def);
}

static int warned(const brunt_world *world) {
    int count = 0;
    for (int32_t w = 0; w < brunt_warning_count(world); w++)
        count += strstr(brunt_world_warning(world, w), "too long to follow the barrier") != NULL;
    return count;
}

// A step that Newmark's rule does not follow the barrier by is said once, by the step too that does; backward Euler
// damps. What has gone on from a checkpoint has nothing more to say.
START_TEST(chatters) {
    brunt_world *newmark = falling(BRUNT_NEWMARK, 2e-3), *euler = falling(BRUNT_EULER, 2e-3),
                *fine = falling(BRUNT_NEWMARK, 2e-5), *fresh = falling(BRUNT_NEWMARK, 2e-3);
    ck_assert_int_eq(warned(newmark), 0);
    while (!warned(newmark) && brunt_world_steps(newmark) < 50) world_steps(newmark, 1);
    ck_assert_int_eq(warned(newmark), 1);
    printf("  %s\n", brunt_world_warning(newmark, brunt_warning_count(newmark) - 1));
    ck_assert(strstr(brunt_world_warning(newmark, brunt_warning_count(newmark) - 1), "bodies.block: at t = "));
    world_copy_state(newmark, fresh);
    world_steps(newmark, 3), world_steps(fresh, 3);
    ck_assert_int_eq(warned(newmark), 1);
    ck_assert_int_eq(warned(fresh), 0);
    ck_assert_uint_eq(brunt_world_hash(newmark), brunt_world_hash(fresh));
    world_until(euler, 0.03), world_until(fine, 0.03);
    ck_assert_int_eq(warned(euler) + warned(fine), 0);
    ck_assert_double_lt(least_part(euler), 1);
    ck_assert_double_lt(least_part(fine), 1);
    brunt_world_destroy(newmark), brunt_world_destroy(euler), brunt_world_destroy(fine), brunt_world_destroy(fresh);
}
END_TEST

static brunt_world *rubbed(brunt_solver solver) {
    brunt_world_def def = begin(3, BRUNT_NEWMARK, 5e-3);
    mesh(&def, "floor", XYZ(-0.25, -0.25, -0.5), XYZ(0.75, 0.75, 0), 0.25);
    hold(&def, "floor", "zmin")->value[0] = 1;
    def_velocity(def_box(&def, "block", XYZ(0.01, 0.01, -0.04), XYZ(0.51, 0.51, 0.46)), 0, 0, -1);
    def.contact.friction = 0.3, def.contact.distance = 0.025;
    def.newton.solver = solver;
    if (brunt_solver_iterates(solver)) def.newton.accuracy = 1e-9;
    brunt_world *world = world_take(&def);
    world_steps(world, 8);
    return world;
}

START_TEST(whichever_solver) {
    static const brunt_solver solvers[] = {BRUNT_SOLVER_DIRECT, BRUNT_SOLVER_PCG, BRUNT_SOLVER_MATRIX_FREE};
    double *exact[2];
    for (int k = 0; k < 3; k++) {
        brunt_world *world = rubbed(solvers[k]);
        double worst = 0;
        for (int b = 0; b < 2; b++) {
            const int64_t count = brunt_body_particles(world, b) + brunt_body_nodes(world, b);
            ck_assert_int_gt(count, 0);
            double *u = world_field(world, b, "velocity");
            for (int64_t i = 0; k && i < 3 * count; i++) worst = fmax(worst, fabs(u[i] - exact[b][i]));
            if (k)
                free(u);
            else
                exact[b] = u;
        }
        brunt_newton_counts counts;
        brunt_world_newton(world, &counts, NULL);
        printf("  solver %d: velocities %.1e m/s apart, %g + %g iterations, impulses %.4g and %.4g N s\n",
               (int)solvers[k], worst, counts.iterations, counts.linear_iterations, world_pair(world, 0).impulse[0],
               world_pair(world, 0).impulse[2]);
        for (int a = 0; a < 3; a += 2) ck_assert_double_gt(fabs(world_pair(world, 0).impulse[a]), 1);
        ck_assert_double_le(worst, 1e-10);
        ck_assert((counts.linear_iterations > 0) == (k > 0));
        ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
        brunt_world_destroy(world);
    }
    free(exact[0]), free(exact[1]);
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

START_TEST(threads) {
    uint64_t hash[3];
    for (int t = 0; t < 3; t++) {
        brunt_world_def def = begin(3, BRUNT_NEWMARK, 5e-3);
        def_velocity(mesh(&def, "a", XYZ(0, 0, 0), XYZ(0.5, 0.5, 0.5), 0.25), 0, 0, 3);
        def_velocity(mesh(&def, "b", XYZ(0.1, 0.1, 0.53), XYZ(0.6, 0.6, 1.03), 0.25), 0, 0, -3);
        def.contact.friction = 0.3;
        def.threads = t + 1;
        brunt_world *world = world_take(&def);
        world_steps(world, 6);
        hash[t] = brunt_world_hash(world);
        ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
        brunt_world_destroy(world);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
    ck_assert_uint_eq(hash[0], hash[2]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_contact");
    ADD_LOOP(rests, 4);
    ADD_LOOP(slides, 5);
    ADD_LOOP(pressed_and_sheared, 2);
    ADD_LOOP(collide, 3);
    ADD_LOOP(rough_steps_keep_momentum, 3);
    ADD_LOOP(coasts, 2);
    ADD_LOOP(friction_settles, 1);
    ADD_LOOP(pushed, 2);
    ADD_LOOP(chatters, 1);
    ADD_LOOP(whichever_solver, 1);
    ADD_LOOP(threads, 1);
    return suite_main(suite);
}
#endif
