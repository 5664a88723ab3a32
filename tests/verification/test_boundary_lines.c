// Lines anywhere in the grid that hold implicit material points: reactions, places, approach, release, friction.
#include <math.h>

#include "scheme/implicit.h"
#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

// A definition with room for a few lines.
static brunt_world_def lines(int order, double step, double nu) {
    brunt_world_def def = def_begin(2, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, nu);
    hold_by_surfaces(&def, order, step);
    return def;
}

// A bar of length 2 and thickness 0.5 that hangs from its face, in a grid that is turned by an angle and shifted; the
// load acts along it, in one step as long as one likes.
static brunt_world *bar(int order, double angle, double shift) {
    brunt_world_def def = lines(order, 1e5, 0);
    const double c = cos(angle), s = sin(angle);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(2, 0.5, 0));
    b->particles_per_cell = 16;
    b->place.rotation[0] = c, b->place.rotation[1] = -s, b->place.rotation[3] = s, b->place.rotation[4] = c;
    b->place.translation[0] = shift, b->place.translation[1] = 0.7 * shift;
    def_line(&def, shift - 0.0 * c, 0.7 * shift, shift - 0.5 * s, 0.7 * shift + 0.5 * c, BRUNT_STICK);
    def.gravity[0] = 0.1 * c, def.gravity[1] = 0.1 * s;
    return world_take(&def);
}

// What the line says of itself: its moment holds the weight where it is, and tractions along the bar are even.
static void check_report(const brunt_world *world, const brunt_body_sums *bar, const double load[2], int order) {
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    const double turn = bar->centre[0] * load[1] - bar->centre[1] * load[0];
    ck_assert_int_eq(report.pieces, 3);
    ck_assert_int_eq(report.active, 3);
    ck_assert_double_le(fabs(report.moment[2] + turn), 1e-8 * hypot(load[0], load[1]));
    const int64_t count = brunt_boundary_surface_size(world, 0);
    double *values = malloc((size_t)count * 10 * sizeof *values), low = INFINITY, high = 0;
    int64_t *piece = malloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count, values + 9 * count,
                                                  piece};
    brunt_boundary_surface_particles(world, 0, &arrays);
    for (int64_t b = 0; b < count; b++) {
        const double size = hypot(arrays.traction[3 * b], arrays.traction[3 * b + 1]);
        low = fmin(low, size), high = fmax(high, size);
        ck_assert_double_lt(arrays.traction[3 * b] * load[0] + arrays.traction[3 * b + 1] * load[1], 0);
    }
    printf("  tractions %.4f to %.4f of their mean\n", 2 * low / (low + high), 2 * high / (low + high));
    if (order == 2) ck_assert_double_le(high / low, 1.06);
    free(values), free(piece);
}

START_TEST(hangs) {
    const int order = 1 + _i % 2;
    const double angle = _i / 2 % 2 ? PI / 6 : 0, shift = 0.0125 * (_i / 4) + (_i / 4 == 4 ? 1e-9 : 0);
    brunt_world *world = bar(order, angle, shift);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double c = cos(angle), s = sin(angle), weight = 1 * DENSITY * 0.1;
    const double along = f.force[0] * c + f.force[1] * s, across = f.force[1] * c - f.force[0] * s;
    const double went = (after.centre[0] - before.centre[0]) * c + (after.centre[1] - before.centre[1]) * s,
                 exact = DENSITY * 0.1 * 4 / 3 / YOUNG;
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  order %d, %2.0f degrees, shift %.4f: force %+.1e across %.1e, centre off by %+.1e, %g iterations\n",
           order, angle * 180 / PI, shift, along / weight + 1, across / weight, went / exact - 1, n.iterations);
    check_report(world, &after, (const double[2]){weight * c, weight * s}, order);
    ck_assert_double_le(fabs(along / weight + 1), 1e-8);
    ck_assert_double_le(fabs(across / weight), 1e-8);
    ck_assert_double_le(fabs(went / exact - 1), order == 2 ? 5e-3 : 4e-2);
    brunt_world_destroy(world);
}
END_TEST

// A block on a line, or hung from one.
static brunt_world_def block(brunt_condition condition, double step, double at) {
    brunt_world_def def = lines(2, step, 0.3);
    def_box(&def, "block", XYZ(0.13, at, 0), XYZ(0.73, at + 0.6, 0));
    def_line(&def, -2, at, 3, at, condition);
    return def;
}

// A line that carries a block along takes as much as the block is given, at every step, and the block keeps its place
// on it.
START_TEST(carries) {
    brunt_world_def def = block(BRUNT_STICK, 0.01, 0.02);
    def.integrator = _i ? BRUNT_NEWMARK : BRUNT_EULER;
    def_velocity(&def.bodies[0], 0.06, 0.2, 0);
    def.surfaces[0].value[0] = 0.06, def.surfaces[0].value[1] = 0.2;
    def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    double mean = 0;
    for (int s = 0; s < 200; s++) {
        world_steps(world, 1);
        mean += world_boundary(world, 0).force[1] / (200 * 360);
    }
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    printf("  %s: mean force off by %+.1e, block by %+.1e %+.1e cells, momentum %.1e, energy %.1e of the work\n",
           _i ? "newmark" : "euler", mean - 1, (after.centre[0] - before.centre[0] - 0.12) / CELL,
           (after.centre[1] - before.centre[1] - 0.4) / CELL, world_momentum(world).linear_drift,
           e.error / e.external_work);
    ck_assert_double_le(fabs(mean - 1), 2e-3);
    ck_assert_double_le(fabs(after.centre[0] - before.centre[0] - 0.12), 1e-3 * CELL);
    ck_assert_double_le(fabs(after.centre[1] - before.centre[1] - 0.4), 5e-3 * CELL);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Along a line that is at an angle to the grid a block slides as if nothing were there, and presses with its weight.
START_TEST(slides) {
    brunt_world_def def = lines(2, 0.01, 0.3);
    const double angle = PI / 3, c = cos(angle), s = sin(angle);
    const bool leaves = _i / 2;
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.6, 0.6, 0));
    b->place.rotation[0] = c, b->place.rotation[1] = s, b->place.rotation[3] = -s, b->place.rotation[4] = c;
    def_line(&def, -3 * c, 3 * s, 8 * c, -8 * s, leaves ? BRUNT_SEPARATE : BRUNT_SLIP);
    def.integrator = _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 100);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double g = 9.81 * s, wanted = 0.5 * g * (_i % 2 ? 1 : 1.01), weight = 360 * 9.81 * c;
    const double x = after.centre[0] - before.centre[0], y = after.centre[1] - before.centre[1];
    printf("  %s %s: slid off by %+.1e, across %+.1e cells, mean force off by %+.1e along %.1e, momentum %.1e\n",
           leaves ? "separate" : "slip", _i % 2 ? "newmark" : "euler", (c * x - s * y) / wanted - 1,
           (s * x + c * y) / CELL, (s * f.impulse[0] + c * f.impulse[1]) / weight - 1,
           (c * f.impulse[0] - s * f.impulse[1]) / weight, world_momentum(world).linear_drift);
    ck_assert_double_le(fabs((c * x - s * y) / wanted - 1), 1e-8);
    ck_assert_double_le(fabs(s * x + c * y), 2e-2 * CELL);
    ck_assert_double_le(fabs((s * f.impulse[0] + c * f.impulse[1]) / weight - 1), 1e-2);
    ck_assert_double_le(fabs(c * f.impulse[0] - s * f.impulse[1]) / weight, 1e-10);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// A block that comes to a line meets it where its own particles end, wherever lines of the grid are.
START_TEST(meets) {
    const brunt_condition condition = _i % 2 ? BRUNT_SLIP : BRUNT_SEPARATE;
    const double at = 0.0125 * (_i / 2);
    brunt_world_def def = block(condition, 2e-3, at);
    for (int k = 0; k < 2; k++) def.surfaces[0].point[k][1] = at - 0.1;
    def_velocity(&def.bodies[0], 0, -1, 0);
    brunt_world *world = world_take(&def);
    double first = -1;
    for (int s = 0; s < 100 && first < 0; s++) {
        world_steps(world, 1);
        if (world_boundary(world, 0).force[1] != 0) first = brunt_world_time(world);
    }
    printf("  %s, cut at %.3f: first force %.4f cells early\n", _i % 2 ? "slip" : "separate", at / CELL,
           (0.1 - first) / CELL);
    ck_assert_double_ge(first, 0);
    ck_assert_double_le(fabs(0.1 - first), 0.05 * CELL);
    brunt_world_destroy(world);
}
END_TEST

// A step that would take it far beyond the line takes it to the line.
START_TEST(stops) {
    brunt_world_def def = block(BRUNT_SEPARATE, 0.035, 0.02);
    for (int k = 0; k < 2; k++) def.surfaces[0].point[k][1] = 0.02 - 0.1;
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    def_velocity(&def.bodies[0], 0, -1, 0);
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[1];
    world_steps(world, 3);
    const double way = before - world_sums(world, 0).centre[1];
    printf("  came %.4f cells short of the line\n", (0.1 - way) / CELL);
    ck_assert_double_le(fabs(way - 0.1), 0.05 * CELL);
    brunt_world_destroy(world);
}
END_TEST

// What is at rest and falls within a step, however long, is stopped by the line: by more steps where it begins farther
// off than the grid reaches.
START_TEST(falls) {
    const double gap = _i % 2 ? 0.4 : 0.03, step = _i / 2 ? 10 : 0.5;
    brunt_world_def def = block(BRUNT_SEPARATE, step, 0.02);
    for (int k = 0; k < 2; k++) def.surfaces[0].point[k][1] = 0.02 - gap;
    def.gravity[1] = -1;
    def.newton.cut = 12;
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[1];
    for (int s = 0; s < 400 && brunt_world_time(world) < 3; s++) world_steps(world, 1);
    const double way = before - world_sums(world, 0).centre[1];
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  from %.2f m, dt %g: came %.4f cells short of the line, %g cuts\n", gap, step, (gap - way) / CELL, n.cuts);
    ck_assert_double_le(fabs(way - gap), 0.1 * CELL);
    brunt_world_destroy(world);
}
END_TEST

// What may leave a line does so without being pulled, and what may not stays; a body that is moved away from it by the
// line's own motion likewise.
START_TEST(leaves) {
    brunt_world_def def = block(BRUNT_SEPARATE, 5e-3, 0.02);
    if (_i)
        def.surfaces[0].value[1] = -1; // the line goes
    else
        def.gravity[1] = 5; // the block does
    brunt_world *world = world_take(&def);
    world_steps(world, 40);
    const brunt_reaction f = world_boundary(world, 0);
    printf("  impulse %.1e N s\n", f.impulse[1]);
    ck_assert_double_ge(f.impulse[1], 0);
    ck_assert_double_le(f.impulse[1], 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// Friction: a block on a slope stays below the angle of friction, and above it slides as Coulomb says.
START_TEST(rubs) {
    static const double friction[] = {0.7, 0.4, 0.1};
    brunt_world_def def = block(BRUNT_SEPARATE, 5e-3, 0.02);
    const double g[2] = {9.81 * 0.5, -9.81 * 0.75}, mu = friction[_i];
    def.surfaces[0].friction = mu;
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    def.gravity[0] = g[0], def.gravity[1] = g[1];
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    const brunt_body_sums s = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double wanted = fmax(0, g[0] + mu * g[1]) * 0.5;
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  friction %.1f: speed %.5f, %.5f wanted; force %.4f of the normal one; %.1f iterations a step\n", mu,
           s.velocity[0], wanted, -f.impulse[0] / f.impulse[1], n.iterations / n.steps);
    ck_assert_double_le(fabs(s.velocity[0] - wanted), 1e-2 * g[0] * 0.5);
    if (mu < 0.6) ck_assert_double_le(fabs(-f.impulse[0] / f.impulse[1] / mu - 1), 1e-2);
    ck_assert_double_ge(f.friction_work, 0);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

// Grains without cohesion collapse beside a wall and run out on a rough floor, where some of them begin or cease to
// touch, to slip or to stick in each step: a material without a potential. The wall, on either side, gives what they
// gain along x with what the floor takes; they go as far as in explicit steps.
static brunt_world *column(double side, double mu, double cell, bool implicit) {
    brunt_world_def def = def_begin(2, cell);
    brunt_material_def *m = def_material(&def, "mohr-coulomb", 2040, 5.84e6, 0.3);
    m->strength_parameters[3] = atan(mu);
    if (implicit)
        hold_by_surfaces(&def, 2, 1e-3), def.newton = brunt_world_def_default().newton;
    else
        def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    def.gravity[1] = -9.81;
    def_box(&def, "column", XYZ(side > 0 ? 0 : -0.2, 0, 0), XYZ(side > 0 ? 0.2 : 0, 0.1, 0));
    def_line(&def, -0.5, 0, 0.5, 0, BRUNT_SEPARATE)->friction = mu;
    def_line(&def, 0, side > 0 ? 0.3 : -0.1, 0, side > 0 ? -0.1 : 0.3, BRUNT_SEPARATE);
    return world_take(&def);
}

START_TEST(collapses) {
    const double side = _i ? -1 : 1, mu = 0.402;
    brunt_world *world = column(side, mu, 0.02, true), *explicit = column(side, mu, 0.02, false);
    world_until(world, 0.15), world_until(explicit, 0.15);
    const brunt_body_sums s = world_sums(world, 0), other = world_sums(explicit, 0);
    const brunt_reaction floor = world_boundary(world, 0), wall = world_boundary(world, 1);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  %.0f steps, %.0f cuts, %.1f iterations a step; centre at %.4f, %.4f m, explicit %.4f, %.4f m; floor %.4f "
           "of the weight, friction "
           "%.3f of it\n",
           (double)n.steps, (double)n.cuts, (double)n.iterations / (double)n.steps, s.centre[0], s.centre[1],
           other.centre[0], other.centre[1], floor.impulse[1] / (s.mass * 9.81 * 0.15),
           -side * floor.impulse[0] / floor.impulse[1]);
    ck_assert_double_le(n.cuts, 0);
    ck_assert_double_le(n.iterations, 5 * n.steps); // 3.7; guesses of what pushes, sticks and slips took 10 and 20
    ck_assert_double_le(fabs(s.centre[0] - other.centre[0]), 2e-3);
    ck_assert_double_le(fabs(s.centre[1] - other.centre[1]), 4e-3); // pieces hold their mean: the lowest row is lower
    ck_assert_double_gt(side * wall.impulse[0], 0);
    ck_assert_double_le(fabs(wall.impulse[0] + floor.impulse[0] - s.mass * s.velocity[0]), 1e-9 * floor.impulse[1]);
    ck_assert_double_le(-side * floor.impulse[0], mu * floor.impulse[1]);
    ck_assert_double_ge(floor.friction_work, 0);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world), brunt_world_destroy(explicit);
}
END_TEST

// In finer cells what tractions want of each other goes to and fro for ever, now and then, as slopes are not symmetric:
// then they go half the way (by whole ones 77 steps are cut, with 18 iterations each).
START_TEST(goes_to_and_fro) {
    brunt_world *world = column(_i ? -1 : 1, 0.402, 0.01, true);
    brunt_newton_counts n;
    world_until(world, 0.28);
    brunt_world_newton(world, &n, NULL);
    printf("  %.0f steps, %.0f cuts, %.1f iterations a step\n", (double)n.steps, (double)n.cuts,
           (double)n.iterations / (double)n.steps);
    ck_assert_double_eq(n.cuts, 0);
    ck_assert_double_le(n.iterations, 5.5 * n.steps);
    brunt_world_destroy(world);
}
END_TEST

// More rows than there is an answer of the factor for follow Newton's method as they were guessed, in more iterations,
// to the same end.
START_TEST(collapses_by_guesses) {
    const double side = _i ? -1 : 1, mu = 0.402, end = 0.04;
    brunt_world *world[2];
    brunt_newton_counts n[2];
    for (int k = 0; k < 2; k++) {
        world[k] = column(side, mu, 0.02, true);
        if (k) world[k]->plan.implicit->rows.answer_limit = 0;
        world_until(world[k], end);
        ck_assert(world[k]->plan.implicit->rows.exact == !k);
        brunt_world_newton(world[k], &n[k], NULL);
    }
    double *x = world_field(world[0], 0, "position"), *y = world_field(world[1], 0, "position"), off = 0;
    for (int64_t i = 0; i < 3 * brunt_body_particles(world[0], 0); i++) off = fmax(off, fabs(x[i] - y[i]));
    const double P = world_boundary(world[0], 0).impulse[1], Q = world_boundary(world[1], 0).impulse[1];
    printf("  %.0f and %.0f steps, %.1f and %.1f iterations a step, %.0f and %.0f cuts: %.1e m apart, floor %.2e of "
           "its impulse\n",
           (double)n[0].steps, (double)n[1].steps, (double)n[0].iterations / (double)n[0].steps,
           (double)n[1].iterations / (double)n[1].steps, (double)n[0].cuts, (double)n[1].cuts, off, Q / P - 1);
    ck_assert_double_gt(n[1].iterations, 2 * n[0].iterations);
    ck_assert_double_le(n[1].iterations, 20 * n[1].steps); // 22 where gradients may grow while they do not halve
    ck_assert_double_le(off, 1e-8);
    ck_assert_double_le(fabs(Q / P - 1), 1e-6);
    free(x), free(y);
    brunt_world_destroy(world[0]), brunt_world_destroy(world[1]);
}
END_TEST

// The same line twice shares what one takes alone.
START_TEST(twice) {
    double force[2] = {0, 0}, place[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = block(BRUNT_STICK, 10, 0.02);
        if (k) def_line(&def, -2, 0.02, 3, 0.02, BRUNT_STICK);
        def.gravity[1] = -1;
        brunt_world *world = world_take(&def);
        world_steps(world, 1);
        for (int w = 0; w < brunt_boundary_count(world); w++) force[k] += world_boundary(world, w).force[1];
        place[k] = world_sums(world, 0).centre[1];
        brunt_world_destroy(world);
    }
    ck_assert_double_eq_tol(force[0], force[1], 1e-9 * force[0]);
    ck_assert_double_eq_tol(place[0], place[1], 1e-12);
}
END_TEST

// Any step, and lines that begin to move at once: each converges.
START_TEST(hard) {
    static const double steps[] = {1e-4, 1e-2, 1, 1e3};
    brunt_world_def def = block(_i % 2 ? BRUNT_STICK : BRUNT_SEPARATE, steps[_i / 2], 0.02);
    static double table[2][2];
    table[0][0] = 3 * def.step, table[1][0] = 3.5 * def.step, table[1][1] = 1;
    def.surfaces[0].table.points = brunt_alloc(sizeof table), def.surfaces[0].table.count = 2;
    memcpy(def.surfaces[0].table.points, table, sizeof table);
    def.surfaces[0].value[1] = fmin(5, 0.3 * CELL / def.step);
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    world_steps(world, 8);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  dt %g s %s: %.1f iterations a step, %g cuts\n", steps[_i / 2], _i % 2 ? "stick" : "separate",
           n.iterations / n.steps, n.cuts);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-9);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *carried(int threads) {
    brunt_world_def def = block(BRUNT_SEPARATE, 5e-3, 0.02);
    def.surfaces[0].friction = 0.3, def.surfaces[0].value[0] = 0.5;
    def.gravity[1] = -9.81;
    def.integrator = BRUNT_NEWMARK;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {carried(1), carried(2), carried(5)};
    check_threads(world, 3, 6);
}
END_TEST

START_TEST(restart) { check_restart(carried(1), carried(1)); }
END_TEST

// A disk in a round hole that is as large, or a hexagon in one with corners: it rests in it, whatever the line lets go.
START_TEST(hole) {
    static const brunt_condition conditions[] = {BRUNT_STICK, BRUNT_SLIP, BRUNT_SEPARATE};
    const int count = _i / 3 ? 64 : 6; // corners of 60 degrees
    brunt_world_def def = lines(2, 0.1, 0.3);
    brunt_body_def *b = def_body(&def, "disk");
    brunt_boundary_surface_def *s = def_polyline(&def, count, true, conditions[_i % 3]);
    if (count == 6) { // a hexagon
        b->shape.kind = BRUNT_PRISM;
        b->shape.points = brunt_alloc(6 * sizeof *b->shape.points), b->shape.point_count = 6;
    } else {
        b->shape.kind = BRUNT_SPHERE, b->shape.radius = 0.5;
    }
    for (int k = 0; k < count; k++) {
        s->point[k][0] = 0.5 * cos(2 * PI * k / count), s->point[k][1] = 0.5 * sin(2 * PI * k / count);
        if (count == 6) b->shape.points[k][0] = s->point[k][0], b->shape.points[k][1] = s->point[k][1];
    }
    b->particles_per_cell = 16;
    def.gravity[0] = 0.3, def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double mass = before.mass;
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    const double sinks = before.centre[1] - after.centre[1], drift = world_momentum(world).linear_drift;
    printf("  %d sides, %s: force %+.1e %+.1e, moment %.1e, sinks by %.1e, %d of %d pieces, momentum %.1e\n", count,
           _i % 3 == 0   ? "stick"
           : _i % 3 == 1 ? "slip"
                         : "separate",
           f.force[0] / mass + 0.3, f.force[1] / mass - 1, report.moment[2] / mass, sinks, report.active, report.pieces,
           drift);
    ck_assert_double_le(drift, 1e-10);
    ck_assert_double_le(fabs(f.force[1] / mass - 1 + sinks / 0.01), 1e-10); // less what it is given
    ck_assert_double_ge(sinks, 0);
    ck_assert_double_le(sinks, 1e-2 * CELL);
    ck_assert_double_le(fabs(report.moment[2]) / mass, 5e-3);
    ck_assert_int_eq(report.pieces, count == 6 ? 18 : 20);
    if (_i % 3 < 2) ck_assert_int_eq(report.active, report.pieces);
    brunt_world_destroy(world);
}
END_TEST

// A piece of a ring that slides in a round trough swings about its centre as a pendulum does.
START_TEST(swings) {
    enum { COUNT = 121 };
    const brunt_condition condition = _i % 2 ? BRUNT_SEPARATE : BRUNT_SLIP;
    brunt_world_def def = lines(2, 5e-3, 0.3);
    const double R = 2, inner = 1.6, from = 0.4, half = 0.25;
    brunt_body_def *b = def_body(&def, "sector");
    b->shape.kind = BRUNT_INTERSECTION, b->shape.child_count = 2;
    b->shape.children = brunt_alloc(2 * sizeof *b->shape.children);
    b->shape.children[0] = (brunt_shape){.kind = BRUNT_TUBE, .radius = R, .inner_radius = inner};
    b->shape.children[1] = (brunt_shape){.kind = BRUNT_PRISM, .point_count = 3};
    b->shape.children[1].points = brunt_alloc(3 * sizeof *b->shape.points);
    for (int k = 1; k < 3; k++) {
        const double at = from + (k == 1 ? -half : half);
        b->shape.children[1].points[k][0] = 3 * sin(at), b->shape.children[1].points[k][1] = -3 * cos(at);
    }
    b->particles_per_cell = 16;
    brunt_boundary_surface_def *s = def_polyline(&def, COUNT, false, condition);
    for (int k = 0; k < COUNT; k++) {
        const double at = -1.2 + 2.4 * k / (COUNT - 1);
        s->point[k][0] = R * sin(at), s->point[k][1] = -R * cos(at);
    }
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    def.integrator = BRUNT_NEWMARK;
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    const double arm = hypot(before.centre[0], before.centre[1]), square = (R * R + inner * inner) / 2;
    const int steps = 160;
    double angle = atan2(before.centre[0], -before.centre[1]), speed = 0;
    for (int k = 0; k < steps * 100; k++) { // midpoint
        const double dt = 5e-5, middle = angle + 0.5 * dt * speed;
        speed -= dt * 9.81 * arm / square * sin(middle), angle = middle + 0.5 * dt * speed;
    }
    world_steps(world, steps);
    const brunt_body_sums after = world_sums(world, 0);
    const double found = atan2(after.centre[0], -after.centre[1]), away = hypot(after.centre[0], after.centre[1]);
    printf("  %s: from angle %.5f to %.5f, %.5f wanted; off its circle by %+.1e cells; momentum %.1e, energy %.1e\n",
           _i % 2 ? "separate" : "slip", from, found, angle, (away - arm) / CELL, world_momentum(world).linear_drift,
           world_energy(world).error_relative);
    ck_assert_double_le(fabs(found - angle), 1e-2 * (from - angle));
    ck_assert_double_le(fabs(away - arm), 0.2 * CELL);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Friction of a piece that bends is across its pressure at each place: tractions of its particles are of one size.
START_TEST(rubs_round) {
    enum { COUNT = 31 };
    brunt_world_def def = lines(2, 5e-3, 0.3);
    def_ball(&def, "disk", XYZ(0, 0, 0), 0.4);
    brunt_boundary_surface_def *s = def_polyline(&def, COUNT, false, BRUNT_SEPARATE);
    for (int k = 0; k < COUNT; k++)
        s->point[k][0] = 0.4 * sin(PI * k / 30 - PI / 2), s->point[k][1] = -0.4 * cos(PI * k / 30 - PI / 2);
    s->friction = 0.3;
    def.gravity[0] = 2, def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    const int64_t count = brunt_boundary_surface_size(world, 0);
    double *values = malloc((size_t)count * 10 * sizeof *values), worst = 0, rubbing = 0;
    int64_t *piece = malloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count, values + 9 * count,
                                                  piece};
    brunt_boundary_surface_particles(world, 0, &arrays);
    for (int64_t b = 1; b < count; b++) {
        const double *t = arrays.traction + 3 * b, *n = arrays.normal + 3 * b, size = hypot(t[0], t[1]);
        rubbing = fmax(rubbing, fabs(t[0] * n[1] - t[1] * n[0]));
        if (piece[b] == piece[b - 1] && size > 0) worst = fmax(worst, fabs(hypot(t[-3], t[-2]) / size - 1));
    }
    printf("  sizes within pieces differ by %.1e, most friction %.3g Pa\n", worst, rubbing);
    ck_assert_double_gt(rubbing, 1);
    ck_assert_double_le(worst, 1e-12);
    free(values), free(piece);
    brunt_world_destroy(world);
}
END_TEST

// Teeth that the grid cannot tell apart hold as the line would that they are on; larger ones hold by themselves.
START_TEST(teeth) {
    static const double widths[] = {0.025, 0.05, 0.06, 0.068, 0.075, 0.085, 0.1};
    enum { COUNT = 60 };
    const double width = widths[_i / 2];
    brunt_world_def def = lines(2, 0.1, 0.3);
    def_box(&def, "block", XYZ(0.03, -0.25 * width, 0), XYZ(0.63, 0.6 - 0.25 * width, 0))->particles_per_cell = 16;
    brunt_boundary_surface_def *s = def_polyline(&def, COUNT, false, _i % 2 ? BRUNT_SLIP : BRUNT_STICK);
    for (int k = 0; k < COUNT; k++) s->point[k][0] = -0.2 + k * width, s->point[k][1] = -0.5 * width * (k % 2);
    def.gravity[0] = 0.3, def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    const brunt_reaction f = world_boundary(world, 0);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  teeth of %.2f cells, %s: force %.3f %.3f of the weight, momentum %.1e, %.1f iterations\n", width / CELL,
           _i % 2 ? "slip" : "stick", f.force[0] / 360, f.force[1] / 360, world_momentum(world).linear_drift,
           n.iterations / n.steps);
    ck_assert_double_le(fabs(f.force[1] / 360 - 1), 1e-2);
    if (_i % 2 == 0) ck_assert_double_le(fabs(f.force[0] / 360 + 0.3), 1e-2);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(n.iterations / n.steps, 4);
    brunt_world_destroy(world);
}
END_TEST

// A thin wall has two sides: what lies on one leaves it without being pulled by the other.
START_TEST(wall) {
    static const double thickness[] = {0.01, 0.03, 0.06, 0.2};
    brunt_world_def def = block(BRUNT_SEPARATE, 5e-3, 0);
    def.surface_count = 0;
    brunt_free(def.surfaces[0].point), brunt_free(def.surfaces[0].facet);
    brunt_boundary_surface_def *s = def_polyline(&def, 4, true, BRUNT_SEPARATE);
    for (int k = 0; k < 4; k++)
        s->point[k][0] = k == 0 || k == 3 ? -0.5 : 1, s->point[k][1] = k < 2 ? 0 : -thickness[_i / 2];
    def.gravity[1] = _i % 2 ? -5 : 5;
    brunt_world *world = world_take(&def);
    world_steps(world, 20);
    const brunt_reaction f = world_boundary(world, 0);
    printf("  %.2f cells thick: impulse %.4f of the weight's\n", thickness[_i / 2] / CELL, f.impulse[1] / 180);
    ck_assert_double_le(fabs(f.impulse[1] / 180 - _i % 2), _i % 2 ? 5e-2 : 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// What a line lets go is not behind it.
START_TEST(behind) {
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = block(k ? BRUNT_SEPARATE : BRUNT_SLIP, 1e-2, 0.02);
        memcpy(def.surfaces[0].facet[0], (const int32_t[4]){1, 0, -1, -1}, sizeof def.surfaces[0].facet[0]);
        brunt_error error = {0};
        brunt_world *world = brunt_world_create(&def, &error);
        ck_assert_int_eq(world != NULL, !k); // a line that does not let go has no sides
        if (k) printf("  %s\n", error.message);
        if (k) ck_assert_ptr_nonnull(strstr(error.message, "body 'block' is behind it"));
        if (world) brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
}
END_TEST

// A line that lets go does not go through a body: what would be behind it is said with its place, but for less
// than is pushed out. Explicit steps may be told to begin so.
START_TEST(through) {
    static const struct {
        double up; // of the line, from the block's foot
        brunt_condition condition;
        bool explicit, allowed, wrong;
    } cases[] = {{-0.01, BRUNT_SEPARATE, false, false, false}, {0.03, BRUNT_SEPARATE, false, false, false},
                 {0.3, BRUNT_SEPARATE, false, false, true},    {0.57, BRUNT_SEPARATE, false, false, true},
                 {0.3, BRUNT_SLIP, false, false, false},       {0.3, BRUNT_STICK, false, false, false},
                 {-0.01, BRUNT_SEPARATE, true, false, false},  {0.01, BRUNT_SEPARATE, true, false, false},
                 {0.09, BRUNT_SEPARATE, true, false, true},    {0.3, BRUNT_SEPARATE, true, false, true},
                 {0.3, BRUNT_SEPARATE, true, true, false},     {0.3, BRUNT_SLIP, true, false, false}};
    brunt_world_def def = block(cases[_i].condition, 1e-2, 0.02);
    brunt_error error = {0};
    for (int c = 0; c < 2; c++) def.surfaces[0].point[c][1] = 0.02 + cases[_i].up;
    if (cases[_i].explicit)
        def.scheme = BRUNT_EXPLICIT, def.step = 0, def.contact.method = brunt_world_def_default().contact.method;
    def.contact.allow_overlap = cases[_i].allowed;
    brunt_world *world = brunt_world_create(&def, &error);
    printf("  %s, %.2f m up: %s\n", cases[_i].explicit ? "explicit" : "implicit", cases[_i].up,
           world ? "taken" : error.message);
    ck_assert_int_eq(world == NULL, cases[_i].wrong);
    if (!world) ck_assert_ptr_nonnull(strstr(error.message, "it goes through body 'block' near ("));
    if (world) brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// Two lines in one place that go different ways: said with a name, the body's too. Pieces that would be too many: said
// of them, not of the line.
START_TEST(refuses) {
    brunt_world_def def = block(BRUNT_STICK, 1e-2, 0.02);
    def_line(&def, -2, 0.02, 3, 0.02, BRUNT_STICK)->value[1] = 1;
    def.newton.cut = 1;
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    printf("  %s\n", error.message);
    ck_assert_ptr_nonnull(strstr(error.message, "find no end"));
    ck_assert_ptr_nonnull(strstr(error.message, "surface"));
    brunt_world_destroy(world);
    def = block(BRUNT_STICK, 1e-2, 0.02);
    def.surfaces[0].piece = 1e-20;
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_ptr_nonnull(strstr(error.message, ").piece: pieces of 1e-20 cells would be"));
    brunt_world_def_free(&def);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("boundary_lines");
    ADD_LOOP(hangs, 32);
    ADD_LOOP(carries, 2);
    ADD_LOOP(slides, 4);
    ADD_LOOP(meets, 16);
    ADD_LOOP(stops, 1);
    ADD_LOOP(falls, 4);
    ADD_LOOP(leaves, 2);
    ADD_LOOP(rubs, 3);
    ADD_LOOP(collapses, 2);
    ADD_LOOP(goes_to_and_fro, 1);
    ADD_LOOP(collapses_by_guesses, 2);
    ADD_LOOP(twice, 1);
    ADD_LOOP(hard, 8);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    ADD_LOOP(hole, 6);
    ADD_LOOP(swings, 2);
    ADD_LOOP(rubs_round, 1);
    ADD_LOOP(teeth, 14);
    ADD_LOOP(wall, 8);
    ADD_LOOP(behind, 1);
    ADD_LOOP(through, 12);
    ADD_LOOP(refuses, 1);
    return suite_main(suite);
}
#endif
