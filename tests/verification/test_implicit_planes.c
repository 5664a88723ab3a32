// Planes in implicit and load steps hold material points as lines of the same condition do, wherever they lie in the
// grid, and push them on any slope.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"
#include "world/world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

static brunt_world_def begin(int dim, int steps, double step) {
    brunt_world_def def = def_begin(dim, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, 0);
    hold_by_surfaces(&def, 2, step);
    def.newton.tolerance = 1e-10;
    if (steps) def.scheme = BRUNT_STATIC, def.load_steps = steps, def.step = 0, def.end = 0;
    return def;
}

static brunt_body_def *turned_box(brunt_world_def *def, double angle, const double min[3], const double max[3]) {
    brunt_body_def *b = def_box(def, "block", min, max);
    const double c = cos(angle), s = sin(angle);
    b->place.rotation[0] = c, b->place.rotation[1] = -s, b->place.rotation[3] = s, b->place.rotation[4] = c;
    return b;
}

static brunt_boundary_surface_report report_of(const brunt_world *world) {
    brunt_boundary_surface_report report;
    ck_assert_int_eq(brunt_boundary_surface_count(world), 1);
    brunt_boundary_surface_read(world, 0, &report);
    return report;
}

// A bar that a plane holds at its face sinks by what its weight makes of it, with its weight as reaction and no more of
// a moment than that has; off the lines of the grid and across its cells. Nodes behind it held it 1.3 to 2 times as
// long.
START_TEST(hangs) {
    static const double angles[] = {0, PI / 6, 1.1};
    const int dim = 2 + _i % 2;
    const double angle = angles[_i / 2], c = cos(angle), s = sin(angle), at = 0.03;
    brunt_world_def def = begin(dim, 1, 1);
    turned_box(&def, angle, XYZ(at, 0, 0), XYZ(at + 1, 0.4, dim == 3 ? 0.2 : 0))->particles_per_cell =
        dim == 2 ? 16 : 8;
    def_plane(&def, XYZ(at * c, at * s, 0), XYZ(2 * c, 2 * s, 0), BRUNT_STICK, 0);
    def.gravity[0] = 10 * c, def.gravity[1] = 10 * s;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_boundary_surface_report f = report_of(world);
    const double way = (after.centre[0] - before.centre[0]) * c + (after.centre[1] - before.centre[1]) * s,
                 exact = DENSITY * 10 / 3 / YOUNG, weight = after.mass * 10, x = after.centre[0] - at * c,
                 y = after.centre[1] - at * s;
    printf("  %dD, %.0f degrees: way off by %+.1e, force %+.1e\n", dim, angle * 180 / PI, way / exact - 1,
           hypot(f.force[0], f.force[1]) / weight - 1);
    ck_assert_double_le(fabs(way / exact - 1), dim == 2 ? 1e-2 : 2e-2);
    ck_assert_double_le(fabs(f.force[0] / (-weight * c) - 1), 1e-8);
    ck_assert_double_le(fabs(f.force[1] + weight * s), 1e-8 * weight);
    ck_assert_double_le(fabs(f.moment[2] + x * weight * s - y * weight * c), 1e-7 * weight);
    brunt_world_destroy(world);
}
END_TEST

// Down a slope it slides as if nothing were there, farther than the pieces of the start reach, and presses with its
// weight's part; as along a line.
static brunt_world_def sloping(int dim, bool line) {
    const double angle = PI / 3, c = cos(angle), s = sin(angle);
    brunt_world_def def = begin(dim, 0, 0.01);
    turned_box(&def, -angle, XYZ(0, 0, 0), XYZ(0.4, 0.4, dim == 3 ? 0.2 : 0));
    if (line)
        def_line(&def, -c, s, 8 * c, -8 * s, BRUNT_SLIP);
    else
        def_plane(&def, XYZ(0, 0, 0), XYZ(s, c, 0), BRUNT_SLIP, 0);
    def.integrator = BRUNT_NEWMARK;
    def.gravity[1] = -9.81;
    return def;
}

START_TEST(slides) {
    const int dim = _i < 2 ? 2 : 3;
    const double c = cos(PI / 3), s = sin(PI / 3), time = dim == 2 ? 1 : 0.7, wanted = 0.5 * 9.81 * s * time * time;
    brunt_world_def def = sloping(dim, _i == 1);
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, time);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_boundary_surface_report f = report_of(world);
    const double x = after.centre[0] - before.centre[0], y = after.centre[1] - before.centre[1],
                 weight = after.mass * 9.81 * c * time;
    printf("  %dD %s: slid %.4f m, off by %+.1e, across %+.1e cells, force off by %+.1e, %d pieces\n", dim,
           _i == 1 ? "line" : "plane", c * x - s * y, (c * x - s * y) / wanted - 1, (s * x + c * y) / CELL,
           (s * f.impulse[0] + c * f.impulse[1]) / weight - 1, f.pieces);
    if (_i != 1) ck_assert_double_gt(wanted, 0.5 * f.pieces * 0.15 / (dim == 3 ? 10 : 1)); // the half that is ahead
    ck_assert_double_le(fabs((c * x - s * y) / wanted - 1), 1e-8);
    ck_assert_double_le(fabs(s * x + c * y), 2e-2 * CELL);
    ck_assert_double_le(fabs((s * f.impulse[0] + c * f.impulse[1]) / weight - 1), 2e-2);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// A plane that moves carries a block along: its work is what the block gains.
START_TEST(carries) {
    brunt_world_def def = begin(2, 0, 0.01);
    def_velocity(turned_box(&def, 0.4, XYZ(0, 0.02, 0), XYZ(0.4, 0.42, 0)), 0.5, 0.2, 0);
    brunt_plane_def *p =
        def_plane(&def, XYZ(-0.02 * sin(0.4), 0.02 * cos(0.4), 0), XYZ(-sin(0.4), cos(0.4), 0), BRUNT_STICK, 0);
    p->velocity[0] = 0.5, p->velocity[1] = 0.2;
    def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 2);
    const brunt_body_sums after = world_sums(world, 0);
    const double x = after.centre[0] - before.centre[0] - 1, y = after.centre[1] - before.centre[1] - 0.4;
    const double work = report_of(world).work, wanted = after.mass * 1 * 0.4;
    printf("  off by %+.1e %+.1e cells, work off by %+.1e\n", x / CELL, y / CELL, work / wanted - 1);
    ck_assert_double_le(fabs(x), 1e-2 * CELL);
    ck_assert_double_le(fabs(y), 1e-2 * CELL);
    ck_assert_double_le(fabs(work / wanted - 1), 1e-2);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Planes that push do so by their barrier, on a slope too: what they carry is the weight across it, and friction its
// part of that.
START_TEST(pushes) {
    const double angle = PI / 6, c = cos(angle), s = sin(angle), mu = _i ? 0.3 : 0;
    brunt_world_def def = begin(2, 0, 5e-3);
    turned_box(&def, -angle, XYZ(0, 0, 0), XYZ(0.6, 0.4, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(s, c, 0), BRUNT_SEPARATE, mu);
    def.newton.tolerance = 1e-9;
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.4);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double across = f.impulse[0] * s + f.impulse[1] * c, along = f.impulse[1] * s - f.impulse[0] * c,
                 way = (after.centre[0] - before.centre[0]) * c - (after.centre[1] - before.centre[1]) * s;
    printf("  friction %.1f: slides %.4f m, %.4f wanted; across %+.1e, along %.4f of it\n", mu, way, 0.8 * (s - mu * c),
           across / (after.mass * 4 * c) - 1, along / across);
    ck_assert_int_eq(brunt_boundary_surface_count(world), 0);
    ck_assert_double_le(fabs(across / (after.mass * 4 * c) - 1), 1e-2);
    ck_assert_double_le(fabs(along / across - mu), 2e-2 * mu + 1e-6);
    ck_assert_double_le(fabs(way - 0.8 * (s - mu * c)), 0.2 * CELL);
    brunt_world_destroy(world);
}
END_TEST

// On a line of the grid a plane holds as well, from either side: in load steps, in implicit ones, in the plane and in
// space. Nodes at and behind it held half a cell before it.
START_TEST(hangs_on_a_line) {
    const int dim = 2 + _i % 2;
    const double side = _i / 2 % 2 ? -1 : 1;
    brunt_world_def def = begin(dim, _i < 4, _i < 4 ? 1 : 1e5);
    brunt_body_def *b = def_box(&def, "block", XYZ(side > 0 ? 0 : -1, 0, 0), XYZ(side > 0 ? 1 : 0, 0.4, 0.2));
    b->particles_per_cell = dim == 2 ? 16 : 8;
    def_plane(&def, XYZ(0, 0, 0), XYZ(side, 0, 0), BRUNT_STICK, 0);
    def.gravity[0] = 10 * side;
    if (_i >= 4) def.newton.tolerance = 1e-13;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double way = side * (after.centre[0] - before.centre[0]), exact = DENSITY * 10 / 3 / YOUNG,
                 weight = after.mass * 10;
    printf("  %dD, side %+g: way off by %+.1e, force %+.1e\n", dim, side, way / exact - 1,
           -side * f.force[0] / weight - 1);
    ck_assert_double_le(fabs(way / exact - 1), 7e-3); // by linear theory
    ck_assert_double_le(fabs(side * f.force[0] / weight + 1), 1e-8);
    for (int a = 1; a < 3; a++) ck_assert_double_le(fabs(f.force[a]), 1e-8 * weight);
    brunt_world_destroy(world);
}
END_TEST

// Images of opposite velocities are the same to every solver: the bar hangs from its plane as by the direct one, to
// what conjugate gradients and Newton's method leave, in load steps and in implicit ones.
static double hung(brunt_solver solver, bool still, brunt_newton_counts *counts) {
    brunt_world_def def = begin(2, still, 1e5);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.4, 0))->particles_per_cell = 16;
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_STICK, 0);
    def.gravity[0] = 10;
    def.newton.solver = solver, def.newton.accuracy = 1e-9;
    def.newton.tolerance = still ? 1e-10 : 1e-13;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    brunt_world_newton(world, counts, NULL);
    ck_assert_double_le(fabs(world_boundary(world, 0).force[0] / (after.mass * 10) + 1), 1e-8);
    brunt_world_destroy(world);
    return after.centre[0] - before.centre[0];
}

START_TEST(hangs_by_any_solver) {
    static const brunt_solver solvers[] = {BRUNT_SOLVER_PCG, BRUNT_SOLVER_MATRIX_FREE};
    brunt_newton_counts counts;
    const double direct = hung(BRUNT_SOLVER_DIRECT, _i, &counts);
    ck_assert_double_eq(counts.linear_iterations, 0);
    for (int k = 0; k < 2; k++) {
        const double way = hung(solvers[k], _i, &counts);
        printf("  %s, %s: off by %+.1e, %.0f iterations of the solver\n", _i ? "load step" : "implicit step",
               k ? "matrix-free" : "pcg", way / direct - 1, (double)counts.linear_iterations);
        ck_assert_double_gt(counts.linear_iterations, 0);
        ck_assert_double_le(fabs(way / direct - 1), 1e-9);
    }
}
END_TEST

// A block that sticks to a floor and slips on a wall, both on lines of the grid: the floor carries what is along it,
// but for what the wall presses.
START_TEST(in_a_corner) {
    brunt_world_def def = begin(2, 1, 1);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    def.gravity[0] = _i ? 1 : 0, def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    const brunt_reaction wall = world_boundary(world, 0), floor = world_boundary(world, 1);
    const double weight = world_sums(world, 0).mass;
    printf("  wall %.3g %.3g, floor %.3g %.3g of the weight\n", wall.force[0] / weight, wall.force[1] / weight,
           floor.force[0] / weight, floor.force[1] / weight);
    ck_assert_double_le(fabs(wall.force[1]), 1e-8 * weight);
    ck_assert_double_le(fabs(floor.force[1] / weight - 1), 1e-8);
    ck_assert_double_le(fabs((wall.force[0] + floor.force[0]) / weight + _i), 1e-8);
    if (!_i) ck_assert_double_le(fabs(wall.force[0]), 1e-2 * weight);
    if (_i) ck_assert(wall.force[0] < -0.1 * weight && floor.force[0] < -0.1 * weight);
    brunt_world_destroy(world);
}
END_TEST

// Between a plane that sticks and one that slips, both across the load, each carries half of it.
START_TEST(between) {
    brunt_world_def def = begin(2, 1, 1);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.4, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_STICK, 0);
    def_plane(&def, XYZ(1, 0, 0), XYZ(-1, 0, 0), BRUNT_SLIP, 0);
    def.gravity[0] = 1;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    const double weight = world_sums(world, 0).mass;
    for (int w = 0; w < 2; w++) ck_assert_double_le(fabs(world_boundary(world, w).force[0] / weight + 0.5), 1e-2);
    brunt_world_destroy(world);
}
END_TEST

// On a line of the grid there are no pieces, nor by conjugate gradients, whose nodes hold as ever.
START_TEST(on_lines) {
    brunt_world_def def = begin(2, 0, 0.01);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0));
    def_plane(&def, XYZ(0, _i ? 0.03 : 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    if (_i) def.newton.solver = BRUNT_SOLVER_PCG;
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(brunt_boundary_surface_count(world), 0);
    world_steps(world, 1);
    brunt_world_destroy(world);
}
END_TEST

// What spreads farther than pieces were made for is told, with the plane.
START_TEST(spreads) {
    brunt_error error = {0};
    brunt_world_def def = begin(2, 0, 0.01);
    for (int k = 0; k < 2; k++)
        def_velocity(def_box(&def, k ? "right" : "left", XYZ(k, 0.02, 0), XYZ(k + 0.3, 0.3, 0)), k ? 10 : -10, 0, 0);
    def_plane(&def, XYZ(0, 0.02, 0), XYZ(0, 1, 0), BRUNT_SLIP, 0);
    brunt_world *world = world_take(&def);
    int status = BRUNT_OK;
    for (int s = 0; s < 100 && !status; s++) status = brunt_world_step(world, INFINITY, &error);
    printf("  %s\n", error.message);
    ck_assert_int_eq(status, BRUNT_FAILED);
    ck_assert_ptr_nonnull(strstr(error.message, "material spreads along plane 'plane1'"));
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *down(int threads) {
    brunt_world_def def = sloping(2, false);
    def_velocity(&def.bodies[0], 20 * cos(PI / 3), -20 * sin(PI / 3), 0); // on by a piece in less than a step
    def.threads = threads;
    return world_take(&def);
}

// Where pieces go on, tractions stay where they are.
START_TEST(keeps) {
    brunt_error error = {0};
    brunt_world *world = down(1);
    world_steps(world, 3);
    brunt_boundary_surface *s = &world->boundaries.surfaces.surface[0];
    enum { PIECES = 17 };
    double before[PIECES];
    ck_assert_int_eq(s->pieces, PIECES);
    for (int p = 0; p < PIECES; p++) before[p] = s->traction[3 * p] = p + 1;
    const double at = s->window.at[0] -= 6;
    ck_assert_int_eq(brunt_boundary_window_follow(s, &world->bodies, 2, &error), BRUNT_OK);
    const int by = (int)(s->window.at[0] - at);
    printf("  on by %d pieces\n", by);
    ck_assert_int_gt(by, 2);
    for (int p = 0; p < PIECES; p++) ck_assert_double_eq(s->traction[3 * p], p + by < PIECES ? before[p + by] : 0);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(threads) {
    brunt_world *world[] = {down(1), down(2), down(5)};
    check_threads(world, 3, 12);
}
END_TEST

START_TEST(restart) {
    brunt_world *world = down(1), *fresh = down(2);
    world_steps(world, 9);
    check_restart(world, fresh);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_planes");
    ADD_LOOP(hangs, 6);
    ADD_LOOP(hangs_on_a_line, 8);
    ADD_LOOP(hangs_by_any_solver, 2);
    ADD_LOOP(in_a_corner, 2);
    ADD_LOOP(between, 1);
    ADD_LOOP(slides, 3);
    ADD_LOOP(carries, 1);
    ADD_LOOP(pushes, 2);
    ADD_LOOP(on_lines, 2);
    ADD_LOOP(spreads, 1);
    ADD_LOOP(keeps, 1);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    return suite_main(suite);
}
#endif
