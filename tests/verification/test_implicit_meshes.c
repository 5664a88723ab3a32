// Implicit steps of meshes: order in time and space, free fall, hanging, momentum, energy, threads, restart.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static brunt_group_def *def_group(brunt_world_def *def, const char *body, const char *group,
                                  brunt_group_action action) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    g->action = action;
    snprintf(g->body, sizeof g->body, "%s", body);
    snprintf(g->group, sizeof g->group, "%s", group);
    return g;
}

// ------------------------------------------------------------------------------------------ a bar that swings

enum { LENGTH = 1 };

// A bar of length 1 in uniaxial strain, free at both ends, that starts with v = v0 cos(pi x): after a period 2 L / c it
// is as at the start, and at a quarter of it its ends are displaced by v0 L / (pi c), with c^2 = (lambda + 2 mu) / rho.
static brunt_world *swinging_bar(brunt_integrator integrator, double size, double step, double v0) {
    brunt_world_def def = def_begin(2, 1);
    def_material(&def, "linear-elastic", 1, 1, 0);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(LENGTH, size, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    b->wave_velocity[0] = v0, b->wave_vector[0] = PI, b->wave_phase = PI / 2;
    go_implicit(&def, integrator, step);
    def.newton.tolerance = 1e-12;
    return world_take(&def);
}

// Greatest difference of the nodes' displacements along the bar from those of the closed form at a time, over the
// greatest of them.
static double bar_error(brunt_world *world, double v0) {
    double *x = world_field(world, 0, "position"), *u = world_field(world, 0, "displacement"), worst = 0;
    const double t = brunt_world_time(world);
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double X = x[3 * n] - u[3 * n], exact = v0 / PI * cos(PI * X) * sin(PI * t);
        worst = fmax(worst, fabs(u[3 * n] - exact));
    }
    free(x), free(u);
    return worst / (v0 / PI);
}

static double bar_after(brunt_integrator integrator, double size, int steps) {
    const double v0 = 1e-6, time = 1.25;
    brunt_world *world = swinging_bar(integrator, size, time / steps, v0);
    world_until(world, time);
    ck_assert_int_eq(brunt_world_steps(world), steps);
    const double error = bar_error(world, v0);
    brunt_world_destroy(world);
    return error;
}

START_TEST(order_in_time) {
    const brunt_integrator integrator = _i ? BRUNT_NEWMARK : BRUNT_EULER;
    const double size = 1.0 / 256, coarse = bar_after(integrator, size, _i ? 20 : 80),
                 fine = bar_after(integrator, size, _i ? 40 : 160), order = log2(coarse / fine);
    printf("  %s: error %.3e, %.3e, order in time %.3f\n", _i ? "newmark" : "euler", coarse, fine, order);
    ck_assert_double_eq_tol(order, (_i ? 2 : 1), 0.05);
    ck_assert_double_lt(fine, 0.05);
}
END_TEST

START_TEST(order_in_space) {
    const double coarse = bar_after(BRUNT_NEWMARK, 1.0 / 8, 2000), fine = bar_after(BRUNT_NEWMARK, 1.0 / 16, 2000),
                 order = log2(coarse / fine);
    printf("  error %.3e, %.3e, order in space %.3f\n", coarse, fine, order);
    ck_assert_double_eq_tol(order, 2, 0.05);
}
END_TEST

// ------------------------------------------------------------------------------------------ falling, hanging

static brunt_body_def *cube(brunt_world_def *def, brunt_element_kind element, double size) {
    brunt_body_def *b = def_box(def, "cube", XYZ(0, 0, 0), XYZ(1, 1, 1));
    b->method = BRUNT_FEM, b->element = element, b->size = size;
    return b;
}

// Backward Euler: v = g t exactly, x = g t (t + dt) / 2; Newmark x = g t^2 / 2. Whatever the step.
START_TEST(free_fall) {
    const brunt_integrator integrator = _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_velocity(cube(&def, _i / 2 ? BRUNT_HEX8 : BRUNT_TET4, 0.5), 3, 0, 1);
    def.gravity[2] = -10;
    go_implicit(&def, integrator, 0.125);
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[2];
    world_steps(world, 8);
    const brunt_body_sums s = world_sums(world, 0);
    const double fall = integrator == BRUNT_NEWMARK ? 5 : 10 * 1 * (1 + 0.125) / 2;
    ck_assert_double_eq_tol(s.velocity[2], 1 - 10, 1e-9);
    ck_assert_double_eq_tol(s.velocity[0], 3, 1e-9);
    ck_assert_double_eq_tol(s.centre[2] - before, 1 - fall, 1e-9);
    const brunt_energy e = world_energy(world);
    printf("  %d: drift %.1e, energy error %.1e, scheme %.3g J\n", _i, world_momentum(world).linear_drift,
           e.error_relative, e.scheme);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-9);
    // What backward Euler takes of a fall: m g^2 dt^2 / 2 a step.
    ck_assert_double_eq_tol(e.scheme, integrator == BRUNT_NEWMARK ? 0 : 8 * 1000 * 0.5 * 100 * 0.125 * 0.125, 1e-4);
    brunt_world_destroy(world);
}
END_TEST

// A bar in uniaxial strain that hangs comes to rest under its weight: its end sinks by rho g L^2 / (2 (lambda + 2 mu)),
// which linear elements have exactly at their nodes; the force of the support is the weight.
START_TEST(hangs) {
    brunt_world_def def = def_begin(2, 1);
    const double g = 1e-3, L = 1, size = 0.125;
    def_material(&def, "linear-elastic", 1, 1, 0);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(size, L, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    def.gravity[1] = -g;
    def_group(&def, "bar", "ymax", BRUNT_GROUP_VELOCITY);
    go_implicit(&def, BRUNT_EULER, 100);
    def.newton.tolerance = 1e-12;
    brunt_world *world = world_take(&def);
    world_steps(world, 12);
    const double low = world_sums(world, 0).low[1];
    const brunt_reaction force = world_boundary(world, 0);
    printf("  end at %.9g of %.9g, support %.12g of %.12g N\n", low, -g * L * L / 2, force.force[1], g * L * size);
    ck_assert_double_eq_tol(low, -g * L * L / 2, 1e-9 * g);
    ck_assert_double_eq_tol(force.force[1], g * L * size, 1e-9 * g * L * size);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ rigid motion

// A block that turns and flies keeps its momentum; Newmark its energy as well, but for what turning in chords costs.
START_TEST(turns) {
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = cube(&def, BRUNT_TET4, 0.5);
    def_velocity(b, 1, 2, 3);
    b->spin[2] = 2;
    for (int a = 0; a < 3; a++) b->spin_about[a] = 0.5;
    go_implicit(&def, _i ? BRUNT_NEWMARK : BRUNT_EULER, 0.01);
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    printf("  linear %.1e, angular %.1e, energy error %.1e, scheme %.2e of the energy\n", m.linear_drift,
           m.angular_drift, e.error_relative, e.scheme / e.initial);
    ck_assert_double_le(m.linear_drift, 1e-10);
    ck_assert_double_le(m.angular_drift, _i ? 1e-3 : 1e-2);
    ck_assert_double_le(fabs(e.error_relative), 1e-7);
    if (_i) ck_assert_double_le(fabs(e.scheme), 1e-3 * e.initial);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ prescribed motion, loads

// The end of a bar is pulled out by a tenth over one long step, in a thousand times its stable one, while the other is
// held: uniaxial strain, the stress of the closed form, and the work that is stored.
START_TEST(pulled) {
    brunt_world_def def = def_begin(2, 1);
    const double size = 0.125;
    def_material(&def, "linear-elastic", 1, 1, 0);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1, size, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    def_group(&def, "bar", "xmin", BRUNT_GROUP_VELOCITY);
    brunt_group_def *pull = def_group(&def, "bar", "xmax", BRUNT_GROUP_DISPLACEMENT);
    pull->value[0] = 0.1;
    pull->component[1] = pull->component[2] = false;
    go_implicit(&def, BRUNT_EULER, 1000);
    def.newton.tolerance = 1e-12;
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    const brunt_reaction force = world_boundary(world, 1);
    const brunt_energy e = world_energy(world);
    printf("  force %.9g of %.9g N, stored %.9g of %.9g J\n", force.force[0], 0.1 * size, e.internal,
           0.5 * 0.01 * size);
    ck_assert_double_eq_tol(force.force[0], 0.1 * size, 1e-6 * size);
    ck_assert_double_eq_tol(e.internal, 0.5 * 0.01 * size, 1e-6 * size);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// The surface of a cube is turned by 144 degrees in four steps about an oblique axis: at the end it and what is inside
// are where a turn takes them, and nothing is stored.
START_TEST(turned_round) {
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    cube(&def, BRUNT_TET4, 0.25);
    brunt_group_def *turn = def_group(&def, "cube", "surface", BRUNT_GROUP_ROTATION);
    const double angle = 0.8 * 3.14159265358979323846, about[3] = {0.3, -1, 2};
    turn->rotation = (brunt_rotation_def){.angle = angle, .axis = {1, 1, 1}, .about = {0.3, -1, 2}};
    turn->table.points = brunt_alloc(2 * sizeof *turn->table.points), turn->table.count = 2;
    turn->table.points[1][0] = 4, turn->table.points[1][1] = 1;
    go_implicit(&def, BRUNT_EULER, 1);
    def.step = 1, def.newton.tolerance = 1e-10;
    brunt_world *world = world_take(&def);
    double *x0 = world_field(world, 0, "position"), worst = 0;
    world_steps(world, 8);
    double *x = world_field(world, 0, "position");
    for (int64_t k = 0; k < brunt_body_nodes(world, 0); k++) {
        double p[3], sum = 0;
        for (int a = 0; a < 3; a++) p[a] = x0[3 * k + a] - about[a], sum += p[a];
        for (int a = 0; a < 3; a++) {
            const double cross = (p[(a + 2) % 3] - p[(a + 1) % 3]) / sqrt(3);
            const double to = about[a] + cos(angle) * p[a] + sin(angle) * cross + (1 - cos(angle)) * sum / 3;
            worst = fmax(worst, fabs(x[3 * k + a] - to));
        }
    }
    const brunt_energy e = world_energy(world);
    printf("  turned: %.2e m off, %.2e J stored, energy error %.1e\n", worst, e.internal, e.error_relative);
    ck_assert_double_le(worst, 1e-9);
    ck_assert_double_le(e.internal, 1e-9 * 1e6);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    free(x0), free(x);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ damping

// A damped cube flies on, slowed in each step by 1 / (1 + d dt) of backward Euler, (1 - d dt / 2) / (1 + d dt / 2) of
// Newmark; another, all of whose nodes are drawn at a speed, costs its holders d m v. Both are accounted for.
START_TEST(damped) {
    const bool newmark = _i % 2, drawn = _i / 2;
    const double d = 3, dt = 0.05, mass = 1000;
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", mass, 1e6, 0.3);
    brunt_body_def *b = cube(&def, BRUNT_HEX8, drawn ? 1 : 0.5);
    b->damping = d;
    def_velocity(b, 2, drawn ? 0 : -1, 0);
    if (drawn) def_group(&def, "cube", "surface", BRUNT_GROUP_VELOCITY)->value[0] = 2;
    go_implicit(&def, newmark ? BRUNT_NEWMARK : BRUNT_EULER, dt);
    def.newton.solver = BRUNT_SOLVER_DIRECT;
    brunt_world *world = world_take(&def);
    world_steps(world, 10);
    const double left = pow(newmark ? (1 - d * dt / 2) / (1 + d * dt / 2) : 1 / (1 + d * dt), 10);
    const brunt_body_sums s = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    printf("  %d: v %.12g, %.12g m/s, lost %.6g J, drift %.1e, %.1e, energy error %.1e, %g iterations\n", _i,
           s.velocity[0], s.velocity[1], e.viscosity, world_momentum(world).linear_drift,
           world_momentum(world).angular_drift, e.error_relative, counts.iterations);
    ck_assert_double_eq_tol(s.velocity[0], drawn ? 2 : 2 * left, 1e-9);
    ck_assert_double_eq_tol(s.velocity[1], drawn ? 0 : -left, 1e-9);
    if (drawn) ck_assert_double_eq_tol(world_boundary(world, 0).force[0], d * mass * 2, 1e-6 * d * mass);
    if (drawn) ck_assert_double_eq_tol(e.viscosity, d * mass * 4 * 10 * dt, 1e-6);
    ck_assert_double_gt(e.viscosity, 100);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-10);
    ck_assert_double_le(counts.iterations, 20); // two a step: the Hessian is the slope of the force
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

static brunt_world *shaken(int threads, brunt_solver solver) {
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = cube(&def, BRUNT_TET4, 0.125);
    b->spin[0] = 3, b->damping = 20;
    def_group(&def, "cube", "zmin", BRUNT_GROUP_VELOCITY);
    def.gravity[2] = -100;
    go_implicit(&def, BRUNT_NEWMARK, 2e-3);
    def.newton.solver = solver;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    const brunt_solver solver = _i ? BRUNT_SOLVER_MATRIX_FREE : BRUNT_SOLVER_PCG;
    brunt_world *world[] = {shaken(1, solver), shaken(2, solver), shaken(3, solver)};
    check_threads(world, 3, 5);
}
END_TEST

START_TEST(restart) {
    const brunt_solver solver = _i ? BRUNT_SOLVER_MATRIX_FREE : BRUNT_SOLVER_PCG;
    check_restart(shaken(1, solver), shaken(2, solver));
}
END_TEST

// A bar of 1 m in 8 x 2 squares that is held at its left end and bends far within its first step.
static brunt_world_def drooping_bar(void) {
    brunt_world_def def = def_begin(2, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1, 0.25, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_TRI3, b->size = 0.125;
    def_group(&def, "bar", "xmin", BRUNT_GROUP_VELOCITY);
    def.gravity[1] = -500;
    go_implicit(&def, BRUNT_EULER, 0.1);
    return def;
}

// A step that does not converge is no step: with one iteration of Newton's method, and no halvings.
START_TEST(does_not_converge) {
    brunt_world_def def = drooping_bar();
    def.newton.iterations = 1, def.newton.cut = _i;
    brunt_world *world = world_take(&def);
    const uint64_t before = brunt_world_hash(world);
    brunt_error error = {0};
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    printf("  %s\n", error.message);
    ck_assert_ptr_nonnull(strstr(error.message, "body 'bar' at ("));
    ck_assert_ptr_nonnull(strstr(error.message, "does not converge"));
    ck_assert_uint_eq(before, brunt_world_hash(world));
    brunt_world_destroy(world);
}
END_TEST

// Steps that do not converge are taken in shorter ones: what comes of it is told.
START_TEST(is_cut) {
    brunt_world_def def = drooping_bar();
    def.newton.iterations = 4, def.newton.cut = 12;
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    brunt_newton_counts counts;
    ck_assert(brunt_world_newton(world, &counts, NULL));
    printf("  %.0f steps, %.0f cuts, %.0f iterations\n", counts.steps, counts.cuts, counts.iterations);
    ck_assert_double_gt(counts.cuts, 0);
    ck_assert_double_eq(counts.steps, (double)brunt_world_steps(world));
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-4);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_meshes");
    ADD_LOOP(order_in_time, 2);
    ADD_LOOP(order_in_space, 1);
    ADD_LOOP(free_fall, 4);
    ADD_LOOP(hangs, 1);
    ADD_LOOP(turns, 2);
    ADD_LOOP(pulled, 1);
    ADD_LOOP(turned_round, 1);
    ADD_LOOP(damped, 4);
    ADD_LOOP(threads, 2);
    ADD_LOOP(restart, 2);
    ADD_LOOP(does_not_converge, 2);
    ADD_LOOP(is_cut, 1);
    return suite_main(suite);
}
#endif
