// Lines and surfaces that turn in implicit and in load steps: what sticks goes with them as it is, what slips is not
// taken along, friction takes it along by what presses, and the work is force times way.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

static brunt_world_def begin(int dim, int steps, double step, double nu) {
    brunt_world_def def = def_begin(dim, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, nu);
    hold_by_surfaces(&def, 2, step);
    def.newton.tolerance = 1e-10; // of what turns the energy's rounding leaves no less
    if (steps)
        def.scheme = BRUNT_STATIC, def.load_steps = steps, def.step = 0, def.end = 0, def.newton.tolerance = 1e-10;
    return def;
}

// Turns about a place by `angle` for each 1 s, and goes by a displacement.
static void turn(brunt_boundary_surface_def *s, double angle, double x, double y, double until) {
    s->displacement = true, s->rotation.angle = angle * until;
    s->rotation.about[0] = x, s->rotation.about[1] = y;
    s->table.points = brunt_alloc(2 * sizeof *s->table.points), s->table.count = 2;
    s->table.points[0][0] = s->table.points[0][1] = 0, s->table.points[1][0] = until, s->table.points[1][1] = 1;
}

static brunt_boundary_surface_report report_of(const brunt_world *world, int32_t surface) {
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, surface, &report);
    return report;
}

// A circle of 48 parts with a boundary particle in the middle of each, and its normal outwards.
enum { PARTS = 48 };
static const double RADIUS = 0.5;
static brunt_boundary_surface_def *circle(brunt_world_def *def, double radius, brunt_condition condition) {
    brunt_boundary_surface_def *s = def_polyline(def, PARTS, true, condition);
    for (int k = 0; k < PARTS; k++) {
        const double at = -2 * PI * k / PARTS, r = radius / cos(PI / PARTS);
        s->point[k][0] = r * cos(at), s->point[k][1] = r * sin(at);
    }
    s->piece = 1.3 * radius / RADIUS, s->particles = 1; // 24 pieces of 2 particles
    return s;
}

// A square facet in space, in the plane z = `at`.
static brunt_boundary_surface_def *facet(brunt_world_def *def, double half, double at, brunt_condition condition) {
    brunt_boundary_surface_def *s = def_polyline(def, 4, true, condition);
    for (int k = 0; k < 4; k++)
        s->point[k][0] = (k == 1 || k == 2) ? half : -half, s->point[k][1] = k / 2 ? half : -half, s->point[k][2] = at;
    s->facet_count = 1, memcpy(s->facet[0], (const int32_t[4]){0, 1, 2, 3}, sizeof s->facet[0]);
    return s;
}

// ------------------------------------------------------------------------------------------ what sticks

static const double MIDDLE[2] = {-0.4, 0.3}, RATE = 2; // [m], [rad/s]

// A block that is stuck to a line, or to a facet, which turns.
static brunt_world_def stuck(int dim, int steps, double step) {
    brunt_world_def def = begin(dim, steps, step, 0.3);
    if (dim == 2) {
        def_box(&def, "block", XYZ(0.13, 0.02, 0), XYZ(0.53, 0.42, 0));
        turn(def_line(&def, 0.13, 0.02, 0.53, 0.02, BRUNT_STICK), RATE, MIDDLE[0], MIDDLE[1], 1);
        return def;
    }
    def_box(&def, "block", XYZ(-0.13, -0.03, 0.02), XYZ(0.07, 0.17, 0.22));
    brunt_boundary_surface_def *s = facet(&def, 0.2, 0.02, BRUNT_STICK);
    turn(s, RATE, MIDDLE[0], MIDDLE[1], 1);
    s->rotation.axis[0] = 0.6, s->rotation.axis[1] = 0, s->rotation.axis[2] = 0.8;
    return def;
}

// Where a place is once all has turned by an angle.
static void turned(const brunt_boundary_surface_def *s, double angle, const double x[3], double out[3]) {
    const brunt_placement p =
        brunt_placement_rotate(brunt_placement_identity(), s->rotation.axis, angle, s->rotation.about);
    for (int a = 0; a < 3; a++) {
        out[a] = p.translation[a];
        for (int b = 0; b < 3; b++) out[a] += p.rotation[3 * a + b] * x[b];
    }
}

// In load steps it is turned without stress, force or moment, each point goes to where it belongs, by whatever steps.
START_TEST(turns_at_rest) {
    const int dim = 2 + _i % 2;
    brunt_world_def def = stuck(dim, _i / 2 ? 10 : 3, 1);
    const brunt_boundary_surface_def line = def.surfaces[0];
    brunt_world *world = world_take(&def);
    double *before = world_field(world, 0, "position"), most = 0, moment = 0;
    while (brunt_world_time(world) < 1) {
        world_steps(world, 1);
        const brunt_boundary_surface_report f = report_of(world, 0);
        for (int a = 0; a < 3; a++) moment = fmax(moment, fmax(fabs(f.moment[a]), fabs(f.force[a])));
    }
    ck_assert_double_eq_tol(brunt_world_time(world), 1, 1e-12);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    double *after = world_field(world, 0, "position");
    for (int64_t k = 0; k < brunt_body_particles(world, 0); k++) {
        double wanted[3];
        turned(&line, RATE, before + 3 * k, wanted);
        for (int a = 0; a < dim; a++) most = fmax(most, fabs(after[3 * k + a] - wanted[a]));
    }
    printf("  %dD: points off by %.1e m, forces and moments %.1e, stored %.1e J, work %.1e J\n", dim, most, moment,
           world_energy(world).internal, world_energy(world).external_work);
    ck_assert_double_le(n.iterations, 12 * n.steps); // what rounding leaves is known for that
    ck_assert_double_eq(n.cuts, 0);
    ck_assert_double_le(most, 1e-9);
    ck_assert_double_le(moment, 1e-7 * YOUNG * 0.01);
    ck_assert_double_le(fabs(world_energy(world).internal), 1e-10 * YOUNG * 0.01);
    ck_assert_double_le(fabs(world_energy(world).external_work), 1e-9 * YOUNG * 0.01);
    free(before), free(after);
    brunt_world_destroy(world);
}
END_TEST

// The sum of tractions as pictures have them, off the force of the line [N].
static double picture_off(const brunt_world *world, const double force[3]) {
    const int64_t count = brunt_boundary_surface_size(world, 0);
    double *values = malloc((size_t)count * 10 * sizeof *values), sum[3] = {0}, most = 0;
    int64_t *piece = malloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count, values + 9 * count,
                                                  piece};
    brunt_boundary_surface_particles(world, 0, &arrays);
    for (int64_t b = 0; b < count; b++)
        for (int a = 0; a < 3; a++) sum[a] += arrays.weight[b] * arrays.traction[3 * b + a];
    for (int a = 0; a < 3; a++) most = fmax(most, fabs(sum[a] - force[a]));
    free(values), free(piece);
    return most;
}

// In steps with inertia it is held on its circle by the force that this takes, the moment is what its angular momentum
// gains, and all work is told.
START_TEST(turns_with_inertia) {
    const int dim = 2 + _i / 2;
    const bool newmark = _i % 2;
    brunt_world_def def = stuck(dim, 0, 2e-3);
    if (dim == 3) def.surfaces[0].rotation.axis[0] = 0, def.newton.tolerance = 1e-9;
    def.integrator = newmark ? BRUNT_NEWMARK : BRUNT_EULER;
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    def.bodies[0].spin[2] = RATE, def.bodies[0].spin_about[0] = MIDDLE[0], def.bodies[0].spin_about[1] = MIDDLE[1];
    const brunt_boundary_surface_def line = def.surfaces[0];
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    const int steps = dim == 2 ? 200 : 50;
    double force = 0, wanted[3];
    for (int s = 0; s < steps; s++) {
        world_steps(world, 1);
        const brunt_reaction f = world_boundary(world, 0);
        const brunt_body_sums now = world_sums(world, 0);
        const double x = now.centre[0] - MIDDLE[0], y = now.centre[1] - MIDDLE[1];
        force -= (f.force[0] * x + f.force[1] * y) / hypot(x, y) / steps;
    }
    const brunt_body_sums after = world_sums(world, 0);
    const double far = hypot(before.centre[0] - MIDDLE[0], before.centre[1] - MIDDLE[1]);
    turned(&line, RATE * steps * 2e-3, before.centre, wanted);
    const double off = hypot(after.centre[0] - wanted[0], after.centre[1] - wanted[1]);
    const brunt_energy e = world_energy(world);
    ck_assert_double_eq_tol(brunt_world_time(world), steps * 2e-3, 1e-9);
    printf("  %dD %s: off by %.1e m, force %+.1e of what is wanted, momentum %.1e %.1e, energy %.1e, drift %.1e, "
           "picture %.1e\n",
           dim, newmark ? "newmark" : "euler", off, force / (before.mass * RATE * RATE * far) - 1,
           world_momentum(world).linear_drift, world_momentum(world).angular_drift, e.error_relative,
           report_of(world, 0).drift, picture_off(world, world_boundary(world, 0).force) / force);
    ck_assert_double_le(off, 1e-3 * CELL);
    ck_assert_double_le(report_of(world, 0).drift, 1e-6);
    if (dim == 2 && !newmark) ck_assert_double_le(picture_off(world, world_boundary(world, 0).force), 1e-9 * force);
    ck_assert_double_le(fabs(force / (before.mass * RATE * RATE * far) - 1), newmark ? 5e-3 : 2e-2);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    // Backward Euler loses as much of a rotation as this, whatever makes it.
    ck_assert_double_le(world_momentum(world).angular_drift, newmark ? 2e-5 : 3 * RATE * RATE * 2e-3 * steps * 2e-3);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Objectivity: a bar that is clamped and turned by a right angle while its load grows, which is turned too, bends as
// one that is not turned.
START_TEST(bends_as_ever) {
    double centre[2][2], moment[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = begin(2, 10, 1, 0.3);
        def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1.6, 0.4, 0))->particles_per_cell = 16;
        brunt_boundary_surface_def *s = def_line(&def, 0, 0, 0, 0.4, BRUNT_STICK);
        s->piece = 1;
        if (k) turn(s, PI / 2, 0.3, -0.2, 1);
        s->about[0] = k ? -0.1 : 0, s->about[1] = k ? -0.5 : 0.2; // the middle of its clamp at the end
        def.gravity[k ? 0 : 1] = k ? 1 : -1;
        brunt_world *world = world_take(&def);
        world_until(world, 1);
        const brunt_body_sums sums = world_sums(world, 0);
        const double x = sums.centre[0] - 0.3, y = sums.centre[1] + 0.2;
        centre[k][0] = k ? y : x, centre[k][1] = k ? -x : y;
        moment[k] = report_of(world, 0).moment[2];
        ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
        brunt_world_destroy(world);
    }
    const double way = centre[0][1] - 0.4;
    printf("  sinks by %.6g m, %+.1e of it otherwise when turned, moment %.6g and %.6g N m\n", way,
           (centre[1][1] - centre[0][1]) / way, moment[0], moment[1]);
    ck_assert_double_le(fabs(centre[1][1] - centre[0][1]), 1e-2 * fabs(way));
    ck_assert_double_le(fabs(centre[1][0] - centre[0][0]), 1e-2 * fabs(way));
    ck_assert_double_le(fabs(moment[1] / moment[0] - 1), 1e-3);
}
END_TEST

// Pure bending: the end of a bar is turned by an angle and taken where a circle has it. Its moment is E I angle / L,
// and half of that times the angle is the work, all of which is stored.
START_TEST(bends_by_a_moment) {
    brunt_world_def def = begin(2, 10, 1, 0);
    const double L = 1.6, H = 0.4, angle = 0.2, wanted = YOUNG * H * H * H / 12 * angle / L;
    def_box(&def, "bar", XYZ(0, 0, 0), XYZ(L, H, 0))->particles_per_cell = 16;
    def_line(&def, 0, 0, 0, H, BRUNT_STICK)->piece = 1;
    brunt_boundary_surface_def *s = def_line(&def, L, 0, L, H, BRUNT_STICK);
    s->piece = 1;
    turn(s, angle, L, H / 2, 1);
    s->value[0] = L / angle * sin(angle) - L, s->value[1] = L / angle * (1 - cos(angle));
    s->about[0] = L + s->value[0], s->about[1] = H / 2 + s->value[1];
    if (_i) brunt_free(s->table.points), s->table = (brunt_curve){.count = 0}; // load steps grow without one
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    const brunt_boundary_surface_report report = report_of(world, 1);
    const brunt_energy e = world_energy(world);
    printf("  moment %.5g, %.5g N m wanted; work %.5g, stored %.5g J, %.5g wanted\n", report.moment[2], wanted,
           report.work, e.internal, wanted * angle / 2);
    ck_assert_double_le(fabs(report.moment[2] / wanted - 1), 2e-2);
    ck_assert_double_le(fabs(report.work / (wanted * angle / 2) - 1), 2e-2);
    ck_assert_double_le(fabs(e.internal / report.work - 1), 1e-2);
    ck_assert_double_le(fabs(e.error_relative), 1e-8);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what slips and rubs

// A block that lies on a circle between two walls, along which it slips; in steps that are long beside its waves, so
// that it is at rest after some. By one piece a step the circle is in each step where it was in the one before.
static const double PIECE_ANGLE = 4 * PI / PARTS, LYING = 0.5 * 0.9914448613738104; // cos(PIECE_ANGLE / 2)
static brunt_world_def lying(brunt_condition condition, double angle, double friction) {
    brunt_world_def def = begin(2, 0, 20, 0.3);
    def_box(&def, "block", XYZ(-0.3, LYING, 0), XYZ(0.3, LYING + 0.4, 0))->particles_per_cell = 16;
    brunt_boundary_surface_def *s = circle(&def, angle == 0 ? LYING : RADIUS, condition);
    if (angle != 0) turn(s, angle / 20, 0, 0, 1e4);
    s->friction = friction;
    def_line(&def, -0.3, 0.3, -0.3, 1.2, BRUNT_SLIP), def_line(&def, 0.3, 1.2, 0.3, 0.3, BRUNT_SLIP);
    def.gravity[1] = -5;
    return def;
}

// What presses along the circle, friction along it [N].
static void pressures(const brunt_world *world, double *normal, double *rubs) {
    const int64_t count = brunt_boundary_surface_size(world, 0);
    double *values = malloc((size_t)count * 10 * sizeof *values);
    int64_t *piece = malloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count, values + 9 * count,
                                                  piece};
    brunt_boundary_surface_particles(world, 0, &arrays);
    *normal = *rubs = 0;
    for (int64_t b = 0; b < count; b++) {
        const double *t = arrays.traction + 3 * b, *n = arrays.normal + 3 * b;
        *normal += arrays.weight[b] * (t[0] * n[0] + t[1] * n[1]);
        *rubs += arrays.weight[b] * (t[1] * n[0] - t[0] * n[1]);
    }
    free(values), free(piece);
}

// Without friction a circle that turns about its own middle does nothing that it would not do at rest.
START_TEST(slips) {
    const brunt_condition condition = _i ? BRUNT_SEPARATE : BRUNT_SLIP;
    double place[2][2], force[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = lying(condition, k ? PIECE_ANGLE : 0, 0);
        brunt_world *world = world_take(&def);
        double moment = 0;
        for (int s = 0; s < 30; s++) {
            world_steps(world, 1);
            if (s > 10) moment = fmax(moment, fabs(report_of(world, 0).moment[2]));
        }
        const brunt_body_sums sums = world_sums(world, 0);
        const double work = report_of(world, 0).work;
        memcpy(place[k], sums.centre, sizeof place[k]);
        force[k] = world_boundary(world, 0).force[1];
        printf("  %s, %s: centre %.8f %.8f, force %.6g N, moment %.1e, work %.1e\n", _i ? "separate" : "slip",
               k ? "turns" : "stands", place[k][0], place[k][1], force[k], moment, work);
        ck_assert_double_le(moment, 1e-9 * force[k] * RADIUS);
        ck_assert_double_le(fabs(work), 1e-10 * force[k] * RADIUS);
        ck_assert_double_le(fabs(force[k] / (5 * sums.mass) - 1), 1e-8);
        brunt_world_destroy(world);
    }
    // Half way on its particles are on chords, as those of the one that stands.
    if (!_i) ck_assert_double_le(fabs(place[1][1] - place[0][1]), 1e-8 * CELL);
}
END_TEST

// With friction it drags by its coefficient times what presses, at its radius; what it does so is heat.
START_TEST(drags) {
    const double mu = 0.3, angle = _i ? -PIECE_ANGLE : PIECE_ANGLE, r = RADIUS * cos(angle / 2);
    brunt_world_def def = lying(BRUNT_SEPARATE, angle, mu);
    brunt_world *world = world_take(&def);
    world_steps(world, 50);
    const double heat = world_boundary(world, 0).friction_work, work = report_of(world, 0).work;
    world_steps(world, 1);
    const brunt_boundary_surface_report report = report_of(world, 0);
    const brunt_reaction f = world_boundary(world, 0), left = world_boundary(world, 1),
                         right = world_boundary(world, 2);
    double normal, rubs;
    pressures(world, &normal, &rubs);
    printf("  presses %.6g N: moment %+.1e, drags %+.1e, heat %+.1e of what is wanted\n", normal,
           report.moment[2] / ((_i ? -1 : 1) * mu * normal * r) - 1, fabs(rubs) / (mu * normal) - 1,
           (f.friction_work - heat) / (2 * sin(PIECE_ANGLE / 2) * RADIUS * mu * normal) - 1);
    ck_assert_double_gt(normal, 500);
    ck_assert_double_le(fabs(fabs(rubs) / (mu * normal) - 1), 1e-6);
    ck_assert_double_le(fabs(report.moment[2] / ((_i ? -1 : 1) * mu * normal * r) - 1), 1e-6);
    ck_assert_double_le(fabs(f.force[0] + left.force[0] + right.force[0]), 1e-6 * normal);
    ck_assert_double_le(fabs((f.friction_work - heat) / (2 * sin(PIECE_ANGLE / 2) * RADIUS * mu * normal) - 1), 1e-5);
    ck_assert_double_le(fabs((report.work - work) / (f.friction_work - heat) - 1), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

// A floor that is tilted carries a block along until it is steeper than friction holds, and no farther.
START_TEST(tilts) {
    const double mu = 0.3, angle = atan(mu) * (_i ? 1.8 : 0.9);
    brunt_world_def def = begin(2, 0, 5e-3, 0.3);
    def.materials[0].strength_parameters[0] = 10 * YOUNG;
    def_box(&def, "block", XYZ(-0.3, 0.02, 0), XYZ(0.3, 0.32, 0));
    brunt_boundary_surface_def *s = def_line(&def, -1.2, 0.02, 1.2, 0.02, BRUNT_SEPARATE);
    turn(s, angle, 0, 0.02, 1);
    s->friction = mu;
    def.gravity[1] = -5;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.95); // it would slide on where the floor stops
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double x = after.centre[0], y = after.centre[1] - 0.02, c = cos(0.95 * angle), sn = sin(0.95 * angle);
    const double share = (f.force[0] * c + f.force[1] * sn) / (f.force[1] * c - f.force[0] * sn);
    const double slid = before.centre[0] - (x * c + y * sn), high = y * c - x * sn - (before.centre[1] - 0.02);
    printf("  tilted to %.3f of the angle of friction: friction %.4f, slides %.5f m, %.1e cells off the floor\n",
           angle / atan(mu), share, slid, high / CELL);
    if (_i) ck_assert_double_gt(slid, 0.01);
    if (!_i) ck_assert_double_le(fabs(slid), 0.01 * CELL);
    ck_assert_double_le(fabs(share / (_i ? mu : tan(0.95 * angle)) - 1), 1e-2);
    ck_assert_double_le(fabs(high), 0.03 * CELL);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

// How deep the deepest of a block's points is behind a line through the origin [m], negative: behind.
static double deepest_of(brunt_world *world, double angle) {
    double *x = world_field(world, 0, "position"), deepest = INFINITY;
    for (int64_t k = 0; k < brunt_body_particles(world, 0); k++)
        deepest = fmin(deepest, x[3 * k + 1] * cos(angle) - x[3 * k] * sin(angle));
    free(x);
    return deepest - 0.5 * CELL / 4;
}

// A paddle comes round to a block and takes it along, with no overlap: what it has not reached it does not push, and
// what it comes to within a step, by a tenth of a cell or two, it does.
START_TEST(sweeps) {
    brunt_world_def def = begin(2, 0, _i ? 0.0075 : 2e-3, 0.3);
    const double gap = 0.1; // [rad]
    def_box(&def, "block", XYZ(0.5, 0, 0), XYZ(0.8, 0.2, 0))->particles_per_cell = 16;
    turn(def_line(&def, 0, 0, 1.2 * cos(-gap), 1.2 * sin(-gap), BRUNT_SEPARATE), 1, 0, 0, 1);
    def.materials[0].strength_parameters[0] = 10 * YOUNG;
    brunt_world *world = world_take(&def);
    double first = -1, deepest = INFINITY;
    while (brunt_world_time(world) < 0.39) {
        world_steps(world, 1);
        if (first < 0 && world_boundary(world, 0).force[1] != 0) first = brunt_world_time(world);
        deepest = fmin(deepest, deepest_of(world, brunt_world_time(world) - gap));
    }
    printf("  first force %.4f rad early, deepest point %.1e cells, speed %.3f\n", gap - first, deepest / CELL,
           world_sums(world, 0).velocity[1]);
    ck_assert_double_le(fabs(gap - first), 0.05 * CELL / 0.5 + _i * 0.03);
    ck_assert_double_ge(deepest, -0.02 * CELL);
    ck_assert_double_gt(world_sums(world, 0).velocity[1], 0.6);
    printf("  linear drift %.1e\n", world_momentum(world).linear_drift);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(world_momentum(world).angular_drift, _i ? 1e-2 : 1e-4); // of backward Euler
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

// A turntable in space drags a block that walls hold by its friction, at a right angle to the radius.
START_TEST(turntable) {
    const double mu = 0.2;
    brunt_world_def def = begin(3, 0, 20, 0.3);
    def_box(&def, "block", XYZ(0.3, -0.1, 0.02), XYZ(0.5, 0.1, 0.22));
    brunt_boundary_surface_def *s = facet(&def, 0.6, 0.02, BRUNT_SEPARATE), *top = facet(&def, 0.6, 0.22, BRUNT_STICK);
    turn(s, 1e-4, 0, 0, 1e5);
    s->friction = mu;
    top->displacement = true, top->value[2] = -0.002; // pressed by what holds it
    top->table.points = brunt_alloc(2 * sizeof *top->table.points), top->table.count = 2;
    memcpy(top->table.points, (const double[2][2]){{0, 0}, {40, 1}}, 2 * sizeof *top->table.points);
    brunt_world *world = world_take(&def);
    world_steps(world, 12);
    const brunt_reaction f = world_boundary(world, 0), held = world_boundary(world, 1);
    const brunt_boundary_surface_report report = report_of(world, 0);
    printf("  presses %.5g N, drags %.5g of it, across %.1e; moment %.5g m of it\n", f.force[2],
           f.force[1] / f.force[2], f.force[0] / f.force[2], report.moment[2] / f.force[2]);
    ck_assert_double_gt(f.force[2], 100);
    ck_assert_double_le(fabs(f.force[1] / f.force[2] / mu - 1), 1e-2); // directions spread by the block's width
    ck_assert_double_le(fabs(report.moment[2] / f.force[2] / (mu * 0.4) - 1), 5e-2);
    for (int a = 0; a < 3; a++) ck_assert_double_le(fabs(f.force[a] + held.force[a]), 1e-6 * f.force[2]);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what must not change

// What is turned by nothing is what is not turned, bit for bit.
START_TEST(by_nothing) {
    static const brunt_condition conditions[] = {BRUNT_STICK, BRUNT_SLIP, BRUNT_SEPARATE};
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = begin(2, 0, 5e-3, 0.3);
        def_box(&def, "block", XYZ(0.13, 0.02, 0), XYZ(0.53, 0.42, 0));
        brunt_boundary_surface_def *s = def_line(&def, -1, -0.28, 2, 0.32, conditions[_i]);
        if (_i == 2) s->friction = 0.2;
        if (k) turn(s, 0, 0.3, 0.2, 1), s->rotation.angle = 1, s->table.points[1][1] = 0;
        def.gravity[0] = 1, def.gravity[1] = -3;
        brunt_world *world = world_take(&def);
        world_steps(world, 5);
        hash[k] = brunt_world_hash(world);
        brunt_world_destroy(world);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
}
END_TEST

// More than a quarter of a turn within a step is refused, with the line's name.
START_TEST(too_far) {
    brunt_error error = {0};
    brunt_world_def def = stuck(2, 1, 1);
    def.newton.cut = 0;
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    printf("  %s\n", error.message);
    ck_assert_ptr_nonnull(strstr(error.message, "boundary 'surface1' turns by 2 rad within a step"));
    brunt_world_destroy(world);
}
END_TEST

// In the plane there is but one axis.
START_TEST(about_x) {
    brunt_error error = {0};
    brunt_world_def def = stuck(2, 1, 1);
    def.surfaces[0].rotation.axis[0] = 1;
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_ptr_nonnull(strstr(error.message, "rotation.axis: in two dimensions"));
    brunt_world_def_free(&def);
}
END_TEST

static brunt_world *dragged(int threads) {
    brunt_world_def def = lying(BRUNT_SEPARATE, 0.02, 0.3);
    turn(def_line(&def, -0.3, RADIUS + 0.4, 0.3, RADIUS + 0.4, BRUNT_STICK), 1e-4, 0, RADIUS + 0.4, 1e4);
    def.integrator = BRUNT_NEWMARK, def.step = 2e-3;
    for (int k = 0; k < 4; k += 3) def.surfaces[k].rotation.angle *= 1e4;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {dragged(1), dragged(2), dragged(5)};
    check_threads(world, 3, 4);
}
END_TEST

START_TEST(restart) { check_restart(dragged(1), dragged(1)); }
END_TEST

int main(void) {
    Suite *suite = suite_create("turning_lines");
    ADD_LOOP(turns_at_rest, 4);
    ADD_LOOP(turns_with_inertia, 4);
    ADD_LOOP(bends_as_ever, 1);
    ADD_LOOP(bends_by_a_moment, 2);
    ADD_LOOP(slips, 2);
    ADD_LOOP(drags, 2);
    ADD_LOOP(tilts, 2);
    ADD_LOOP(sweeps, 2);
    ADD_LOOP(turntable, 1);
    ADD_LOOP(by_nothing, 3);
    ADD_LOOP(too_far, 1);
    ADD_LOOP(about_x, 1);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    return suite_main(suite);
}
#endif
