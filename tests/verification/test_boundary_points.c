// Lines and surfaces of facets that hold explicit material points: reactions, places, approach, release, friction,
// turns.
#include <math.h>

#include "boundary/facets.h"
#include "tests/support/surface_world.h"

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;
// What central differences leave open where steps follow a body that is crushed, the same with a plane.
static const double ENERGY = 1e-3;

static brunt_world_def explicit_def(int dimension) {
    brunt_world_def def = def_begin(dimension, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, 0.3);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    def.contact.method = BRUNT_CONTACT_NONE;
    return def;
}

// What lies turned by an angle about the origin.
typedef struct lie {
    double c, s;
} lie;
static lie lying(double angle) { return (lie){cos(angle), sin(angle)}; }
static double across(const lie *l, const double v[3]) { return l->c * v[1] - l->s * v[0]; }
static double along(const lie *l, const double v[3]) { return l->c * v[0] + l->s * v[1]; }

static brunt_body_def *turned_box(brunt_world_def *def, const lie *l, double x, double y, double width, double height) {
    brunt_body_def *b = def_box(def, "block", XYZ(x, y, 0), XYZ(x + width, y + height, 0));
    b->place.rotation[0] = l->c, b->place.rotation[1] = -l->s, b->place.rotation[3] = l->s;
    b->place.rotation[4] = l->c;
    return b;
}

static brunt_boundary_surface_def *turned_line(brunt_world_def *def, const lie *l, double from, double to, double at,
                                               brunt_condition condition) {
    return def_line(def, l->c * from - l->s * at, l->s * from + l->c * at, l->c * to - l->s * at, l->s * to + l->c * at,
                    condition);
}

static brunt_boundary_surface_report report_of(const brunt_world *world) {
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    return report;
}

// ------------------------------------------------------------------------------------------ along a line

// Along a line at any angle to the grid a block slides as if nothing were there, and presses with its weight: the same
// whichever way the line goes round, where it does not let go.
START_TEST(slides) {
    static const double angles[] = {0, -PI / 6, -PI / 3};
    const lie l = lying(angles[_i / 4]);
    const bool separates = _i / 2 % 2;
    brunt_world_def def = explicit_def(2);
    turned_box(&def, &l, 0, 0, 0.6, 0.6);
    brunt_boundary_surface_def *s = turned_line(&def, &l, -3, 8, 0, separates ? BRUNT_SEPARATE : BRUNT_SLIP);
    if (_i % 2 && !separates) memcpy(s->facet[0], (const int32_t[4]){1, 0, -1, -1}, sizeof s->facet[0]);
    if (_i % 2 && separates) def.cfl = 0.1;
    def.gravity[0] = 5 * l.c + 8 * l.s, def.gravity[1] = 5 * l.s - 8 * l.c; // 5 along it, 8 onto it
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.5);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double d[3] = {after.centre[0] - before.centre[0], after.centre[1] - before.centre[1]};
    const brunt_boundary_surface_report report = report_of(world);
    const double weight = 360 * 8 * 0.5, given = 360 * across(&l, after.velocity);
    printf("  %s, %3.0f degrees: slid off by %+.1e, across %+.1e cells, mean force off by %+.1e along %.1e, momentum "
           "%.1e, drift %.1e m/s, %d of %d pieces\n",
           separates ? "separate" : "slip", angles[_i / 4] * 180 / PI, along(&l, d) / (0.5 * 5 * 0.25) - 1,
           across(&l, d) / CELL, (across(&l, f.impulse) - given) / weight - 1, along(&l, f.impulse) / weight,
           world_momentum(world).linear_drift, report.drift, report.active, report.pieces);
    ck_assert_double_le(fabs(along(&l, d) / (0.5 * 5 * 0.25) - 1), 100 * ROUNDING);
    ck_assert_double_le(fabs(across(&l, d)), 0.04 * CELL);
    ck_assert_double_le(fabs((across(&l, f.impulse) - given) / weight - 1), 1e-2);
    ck_assert_double_le(fabs(along(&l, f.impulse)) / weight, 10 * ROUNDING);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-7 + 100 * ROUNDING);
    ck_assert_double_ge(f.normal_work, -1e-3 * weight);
    if (!separates) ck_assert_int_eq(report.active, 4);
    brunt_world_destroy(world);
}
END_TEST

// A block that comes to a line meets it where its own particles end, wherever lines of the grid are; it leaves no
// faster than it came, and is not pulled.
START_TEST(meets) {
    const double at = 0.0125 * (_i % 8) + (_i % 8 == 7 ? 0.0125 : 0), speed = _i / 8 ? 15 : 1;
    const lie l = lying(0);
    brunt_world_def def = explicit_def(2);
    def_velocity(turned_box(&def, &l, 0.13, at, 0.6, 0.6), 0, -speed, 0);
    turned_line(&def, &l, -2, 3, at - 0.1, BRUNT_SEPARATE);
    brunt_world *world = world_take(&def);
    double first = -1, least = INFINITY, dt = 0;
    while (brunt_world_time(world) < 0.1 / speed + 0.3) {
        world_steps(world, 1);
        const brunt_reaction f = world_boundary(world, 0);
        least = fmin(least, f.force[1]);
        if (first < 0 && f.force[1] != 0) first = brunt_world_time(world), dt = brunt_world_dt(world);
    }
    const brunt_body_sums after = world_sums(world, 0);
    printf("  %g m/s, cut at %.3f: first force %.4f cells early (a step is %.4f), left with %.3f of its speed, energy "
           "%.1e\n",
           speed, at / CELL, (0.1 / speed - first) * speed / CELL, dt * speed / CELL, after.velocity[1] / speed,
           world_energy(world).error_relative);
    ck_assert_double_ge(least, 0);
    ck_assert_double_le(fabs(0.1 / speed - first), 0.05 * CELL / speed + dt);
    ck_assert_double_gt(after.velocity[1], 0.3 * speed);
    ck_assert_double_le(after.velocity[1], speed);
    ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
    ck_assert_double_ge(world_boundary(world, 0).normal_work, 0);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A line that stands before a body that comes, and one that comes to a body at rest, do the same; so do those that are
// turned by 30 degrees.
START_TEST(moves) {
    double way[3] = {0}, impulse[3] = {0};
    for (int k = 0; k < 3; k++) {
        const lie l = lying(k == 2 ? PI / 6 : 0);
        brunt_world_def def = explicit_def(2);
        brunt_body_def *b = turned_box(&def, &l, 0.13, 0.02, 0.6, 0.6);
        brunt_boundary_surface_def *s = turned_line(&def, &l, -2, 3, 0.01, BRUNT_SEPARATE);
        s->friction = 0.3;
        def.step = 5e-4;
        if (k == 1)
            s->value[1] = 2, s->value[0] = -0.5;
        else
            def_velocity(b, 0.5 * l.c + 2 * l.s, 0.5 * l.s - 2 * l.c, 0);
        brunt_world *world = world_take(&def);
        const brunt_body_sums before = world_sums(world, 0);
        world_until(world, 0.1);
        const brunt_body_sums after = world_sums(world, 0);
        const double d[3] = {after.centre[0] - before.centre[0], after.centre[1] - before.centre[1]};
        way[k] = across(&l, d) - (k == 1 ? 0.2 : 0), impulse[k] = across(&l, world_boundary(world, 0).impulse);
        ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
        brunt_world_destroy(world);
    }
    printf("  impulses %.6f, %.6f of a line that comes, %.6f turned; ways %.6f %.6f %.6f\n", impulse[0], impulse[1],
           impulse[2], way[0], way[1], way[2]);
    ck_assert_double_eq_tol(impulse[0], impulse[1], 2e-2 * impulse[0]); // the grid stands
    ck_assert_double_eq_tol(impulse[0], impulse[2], 2e-2 * impulse[0]);
    ck_assert_double_eq_tol(way[0], way[1], 5e-2 * CELL);
    ck_assert_double_eq_tol(way[0], way[2], 5e-2 * CELL);
}
END_TEST

// Coulomb's law: below the angle of friction a block stays, above it slides with what is left.
START_TEST(rubs) {
    static const double friction[] = {0.7, 0.4, 0.1};
    const lie l = lying(0);
    const double g[2] = {9.81 * 0.5, -9.81 * 0.75}, mu = friction[_i];
    brunt_world_def def = explicit_def(2);
    turned_box(&def, &l, 0.13, 0.02, 0.9, 0.3);
    turned_line(&def, &l, -2, 5, 0.02, BRUNT_SEPARATE)->friction = mu;
    def.materials[0].strength_parameters[0] = 10 * YOUNG;
    def.gravity[0] = g[0], def.gravity[1] = g[1];
    brunt_world *world = world_take(&def);
    world_until(world, 0.5);
    const brunt_body_sums s = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double wanted = fmax(0, g[0] + mu * g[1]) * 0.5;
    printf("  friction %.1f: speed %.5f, %.5f wanted; impulse %.4f of the normal one\n", mu, s.velocity[0], wanted,
           -f.impulse[0] / f.impulse[1]);
    ck_assert_double_le(fabs(s.velocity[0] - wanted), 2e-2 * g[0] * 0.5);
    if (mu < 0.6) ck_assert_double_le(fabs(-f.impulse[0] / f.impulse[1] / mu - 1), 1e-2);
    ck_assert_double_ge(f.friction_work, 0);
    ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
    brunt_world_destroy(world);
}
END_TEST

// A disk that does not slip rolls down with 2/3 of what it would slide with.
START_TEST(rolls) {
    const lie l = lying(-PI / 4);
    brunt_world_def def = explicit_def(2);
    def_ball(&def, "disk", XYZ(l.s * -0.4, l.c * 0.4, 0), 0.4);
    def.bodies[0].fill = BRUNT_FILL_RINGS;
    def.materials[0].strength_parameters[0] = 10 * YOUNG;
    turned_line(&def, &l, -2, 5, 0, BRUNT_SEPARATE)->friction = 1;
    def.gravity[0] = 3 * l.c + 5 * l.s, def.gravity[1] = 3 * l.s - 5 * l.c; // 3 along it, 5 onto it
    def.gravity_ramp = 0.05;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.6);
    const brunt_body_sums after = world_sums(world, 0);
    const double d[3] = {after.centre[0] - before.centre[0], after.centre[1] - before.centre[1]};
    const double way = 3 * (0.5 * 0.55 * 0.55 + 0.5 * 0.05 * 0.55 + 0.05 * 0.05 / 6);
    // The mean of what presses is the weight across the line, but for what speed the disk has across it at the end.
    const brunt_reaction f = world_boundary(world, 0);
    const double weight = 5 * after.mass * (0.6 - 0.5 * 0.05), pressed = across(&l, f.impulse) / weight,
                 left = across(&l, after.momentum) / weight;
    printf("  rolls %.4f of what slides, across %+.1e cells; pressed by %.5f of its weight, momentum %+.5f\n",
           along(&l, d) / way, across(&l, d) / CELL, pressed, left);
    ck_assert_double_eq_tol(pressed - left, 1, 1e-3);
    const double turns =
        0.5 * CELL / (2 * 0.4); // of its way from point to point of its rim, half each side of a corner
    ck_assert_double_le(fabs(left), turns * 3 * 2 / 3 / 5);
    ck_assert_double_eq_tol(along(&l, d) / way, 2.0 / 3, 0.035); // its lattice and kernels turn harder
    ck_assert_double_le(fabs(across(&l, d)), 0.03 * CELL);
    ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// What lies there stays where it is, and what lies a little behind the line is not thrown out of it.
START_TEST(rests) {
    const lie l = lying(0.3);
    brunt_world_def def = explicit_def(2);
    turned_box(&def, &l, 0.03, _i ? -0.005 : 0, 0.4, 0.4)->total_lagrangian = _i == 2;
    turned_line(&def, &l, -2, 3, 0, BRUNT_SEPARATE)->friction = 0.5;
    if (!_i) def.gravity[0] = 9.81 * l.s, def.gravity[1] = -9.81 * l.c;
    brunt_world *world = world_take(&def);
    const double start = across(&l, world_sums(world, 0).centre);
    world_until(world, 3);
    const double settled = across(&l, world_sums(world, 0).centre);
    world_until(world, 6);
    const brunt_body_sums after = world_sums(world, 0);
    printf("  went %.1e cells, then %.1e, energy %.1e J\n", (settled - start) / CELL,
           (across(&l, after.centre) - settled) / CELL, world_energy(world).kinetic);
    ck_assert_double_le(fabs(settled - start), 0.01 * CELL);
    ck_assert_double_le(fabs(across(&l, after.centre) - settled), 1e-3 * CELL);
    ck_assert_double_le(world_energy(world).kinetic, 1e-4);
    if (!_i) ck_assert_double_eq_tol(across(&l, world_boundary(world, 0).force), 160 * 9.81, 1);
    brunt_world_destroy(world);
}
END_TEST

// What comes while it is behind the line is pushed out with no more than it came with.
START_TEST(pushed_out) {
    const lie l = lying(0);
    brunt_world_def def = explicit_def(2);
    def_velocity(turned_box(&def, &l, 0.03, -0.01, 0.4, 0.4), 0, -0.1, 0);
    turned_line(&def, &l, -2, 3, 0, BRUNT_SEPARATE);
    brunt_world *world = world_take(&def);
    const double start = world_energy(world).kinetic;
    world_until(world, 0.5);
    const brunt_energy e = world_energy(world);
    printf("  leaves with %.3f of its speed\n", world_sums(world, 0).velocity[1] / 0.1);
    ck_assert_double_le(e.kinetic + e.internal, start);
    ck_assert_double_gt(world_sums(world, 0).velocity[1], 0);
    brunt_world_destroy(world);
}
END_TEST

// What a line lets go is not behind it at the start; one that holds has no sides.
START_TEST(behind) {
    for (int k = 0; k < 2; k++) {
        const lie l = lying(0);
        brunt_world_def def = explicit_def(2);
        turned_box(&def, &l, 0.03, 0, 0.4, 0.4);
        turned_line(&def, &l, 3, -2, 0, k ? BRUNT_SEPARATE : BRUNT_SLIP);
        brunt_error error = {0};
        brunt_world *world = brunt_world_create(&def, &error);
        ck_assert_int_eq(world != NULL, !k);
        if (k) ck_assert_ptr_nonnull(strstr(error.message, "body 'block' is behind it"));
        if (world) brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
}
END_TEST

// A line that sticks carries a block along as it goes, and holds its weight; one that stops gives it back.
START_TEST(carries) {
    static const double table[3][2] = {{0, 0}, {0.2, 1}, {1, 1}};
    const lie l = lying(0);
    brunt_world_def def = explicit_def(2);
    turned_box(&def, &l, 0.13, 0.02, 0.6, 0.3);
    brunt_boundary_surface_def *s = turned_line(&def, &l, -2, 5, 0.02, BRUNT_STICK);
    s->value[0] = 0.5, s->value[1] = 0.3;
    s->table.count = 3, s->table.points = brunt_alloc(sizeof table);
    memcpy(s->table.points, table, sizeof table);
    def.gravity[1] = -1, def.gravity_ramp = 0.2;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    const double x = after.centre[0] - before.centre[0] - 0.45, y = after.centre[1] - before.centre[1] - 0.27;
    printf("  block off by %+.1e %+.1e cells, work %.4f J of %.4f, momentum %.1e, energy %.1e\n", x / CELL, y / CELL,
           report_of(world).work, 180 * 0.5 * (0.25 + 0.09) + 180 * 0.27, world_momentum(world).linear_drift,
           e.error_relative);
    ck_assert_double_le(fabs(x), 0.05 * CELL);
    ck_assert_double_le(fabs(y), 0.05 * CELL);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
    ck_assert_double_le(fabs(e.error_relative), ENERGY);
    ck_assert_int_eq(report_of(world).active, 4);
    brunt_world_destroy(world);
}
END_TEST

// Beside r^2 / 2 the spin of the kernels turns, h^2 / 2. A round line that turns takes a disk with it that it sticks
// to, by the moment that this takes.
START_TEST(turns) {
    static const double table[2][2] = {{0, 0}, {1, 1}};
    enum { SIDES = 48 };
    brunt_world_def def = explicit_def(2);
    def_ball(&def, "disk", XYZ(0.3, 0.2, 0), 0.4);
    brunt_boundary_surface_def *s = def_polyline(&def, SIDES, true, _i ? BRUNT_SEPARATE : BRUNT_STICK);
    for (int k = 0; k < SIDES; k++) {
        s->point[k][0] = 0.3 + 0.4 * cos(2 * PI * k / SIDES), s->point[k][1] = 0.2 + 0.4 * sin(2 * PI * k / SIDES);
        s->about[0] = 0.3, s->about[1] = 0.2;
    }
    s->displacement = true, s->rotation.angle = 3;
    s->rotation.about[0] = 0.3, s->rotation.about[1] = 0.2;
    s->table.count = 2, s->table.points = brunt_alloc(sizeof table);
    memcpy(s->table.points, table, sizeof table);
    if (_i) s->value[0] = 0.5; // it lets go, and goes as well
    brunt_world *world = world_take(&def);
    world_until(world, 0.8);
    const brunt_body_sums sums = world_sums(world, 0);
    const double spin = world_momentum(world).angular[2] -
                        sums.mass * (sums.centre[0] * sums.velocity[1] - sums.centre[1] * sums.velocity[0]);
    const double rate = spin / (sums.mass * 0.085);
    printf("  turns at %.4f rad/s, goes at %.4f m/s, momentum %.1e, moment of momentum %.1e, energy %.1e\n", rate,
           sums.velocity[0], world_momentum(world).linear_drift, world_momentum(world).angular_drift,
           world_energy(world).error_relative);
    ck_assert_double_le(world_momentum(world).linear_drift, 10 * ROUNDING);
    ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
    if (!_i) ck_assert_double_eq_tol(rate, 3, 0.15);
    if (_i) ck_assert_double_eq_tol(sums.centre[0], 0.3 + 0.4, 0.3 * CELL);
    ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ corners and thin walls

// A block thrown into a corner, and one that falls on an edge: neither gets into the line, or out with more energy.
START_TEST(corners) {
    const bool inside = _i % 2 == 0;
    const double speed = _i / 2 ? 12 : 1;
    brunt_world_def def = explicit_def(2);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.05, 0.05, 0), XYZ(0.65, 0.65, 0));
    brunt_boundary_surface_def *s = def_polyline(&def, 3, false, BRUNT_SEPARATE);
    const double points[2][3][2] = {{{0, 3}, {0, 0}, {3, 0}}, {{1.35, -1}, {0.35, 0}, {-0.65, -1}}};
    for (int k = 0; k < 3; k++) s->point[k][0] = points[!inside][k][0], s->point[k][1] = points[!inside][k][1];
    if (!inside) // from the right to the left over the top is behind what falls on it
        for (int f = 0; f < 2; f++) memcpy(s->facet[f], (const int32_t[4]){f + 1, f, -1, -1}, sizeof s->facet[f]);
    def_velocity(b, inside ? -speed : 0, -speed, 0);
    brunt_world *world = world_take(&def);
    const double kinetic = world_energy(world).kinetic;
    double deepest = 0;
    while (brunt_world_time(world) < 0.3) {
        world_steps(world, 1);
        double *x = world_field(world, 0, "position");
        for (int64_t p = 0; p < brunt_body_particles(world, 0); p++) {
            const double *at = x + 2 * p;
            const double in = inside ? fmax(-at[0], -at[1]) : -at[1] - fabs(at[0] - 0.35);
            deepest = fmax(deepest, in);
        }
        free(x);
    }
    const brunt_energy e = world_energy(world);
    printf("  %s corner at %g m/s: centres at most %.3f cells behind, %.3f of the energy is left, error %.1e\n",
           inside ? "inner" : "outer", speed, deepest / CELL, (e.kinetic + e.internal) / kinetic, e.error_relative);
    ck_assert_double_le(deepest, 0);
    ck_assert_double_le(e.kinetic + e.internal, kinetic * (1 + 1e-9 + ROUNDING));
    ck_assert_double_ge(world_boundary(world, 0).normal_work, 0);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A thin wall has two sides: what comes to one of them is not seen by the other, nor gets through.
START_TEST(thin) {
    static const double thickness[] = {0.01, 0.06};
    const double speed = _i / 2 ? 10 : 1;
    brunt_world_def def = explicit_def(2);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.03, 0.01, 0), XYZ(0.63, 0.41, 0));
    brunt_boundary_surface_def *s = def_polyline(&def, 4, true, BRUNT_SEPARATE);
    for (int k = 0; k < 4; k++)
        s->point[k][0] = k == 0 || k == 3 ? -0.5 : 1, s->point[k][1] = k < 2 ? 0 : -thickness[_i % 2];
    def_velocity(b, 0, -speed, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    const brunt_body_sums after = world_sums(world, 0);
    printf("  %.2f cells thick, %g m/s: leaves with %.3f of its speed\n", thickness[_i % 2] / CELL, speed,
           after.velocity[1] / speed);
    ck_assert_double_ge(after.velocity[1], 0.3 * speed);
    ck_assert_double_le(fabs(after.velocity[0]), 1e-2 * speed);
    ck_assert_double_le(after.velocity[1], speed);
    brunt_world_destroy(world);
}
END_TEST

// A point exactly on a line of the grid, with a boundary there: nothing that is not finite comes of it.
START_TEST(on_a_node) {
    brunt_world_def def = explicit_def(2);
    brunt_body_def *b = def_box(&def, "block", XYZ(-0.05, -0.05, 0), XYZ(0.05, 0.05, 0));
    b->particles_per_cell = 1;
    def_line(&def, -1, 0, 1, 0, _i ? BRUNT_SLIP : BRUNT_STICK);
    def.gravity[0] = 1, def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    world_steps(world, 200);
    const brunt_body_sums s = world_sums(world, 0);
    ck_assert_double_le(fabs(s.velocity[1]), 1e-6);
    if (!_i) ck_assert_double_le(fabs(s.velocity[0]), 1e-6);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// What is far away changes nothing, and takes nothing.
START_TEST(far_away) {
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        const lie l = lying(0.3);
        brunt_world_def def = explicit_def(2);
        turned_box(&def, &l, 0, 0, 0.6, 0.6);
        def_plane(&def, XYZ(0, -0.1, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        if (k) turned_line(&def, &l, -3, 8, -1.5, BRUNT_SLIP)->friction = 0;
        def.gravity[1] = -10;
        brunt_world *world = world_take(&def);
        world_steps(world, 150);
        hash[k] = brunt_world_hash(world);
        if (k) ck_assert_double_eq(world_boundary(world, 1).impulse[1], 0);
        if (k) ck_assert_int_eq(report_of(world).active, 0);
        brunt_world_destroy(world);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
}
END_TEST

// Symmetry: the half of a block beside its plane does as the whole does.
START_TEST(half) {
    double place[2], impulse[2];
    for (int k = 0; k < 2; k++) {
        const lie l = lying(0);
        brunt_world_def def = explicit_def(2);
        def_velocity(turned_box(&def, &l, k ? 0 : -0.4, 0.03, k ? 0.4 : 0.8, 0.4), 0, -2, 0);
        turned_line(&def, &l, -2, 2, 0.01, BRUNT_SEPARATE)->friction = 0.2;
        if (k) def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
        def.step = 5e-4;
        brunt_world *world = world_take(&def);
        world_until(world, 0.1);
        place[k] = world_sums(world, 0).centre[1], impulse[k] = world_boundary(world, k).impulse[1] * (k + 1);
        brunt_world_destroy(world);
    }
    printf("  %.9f and %.9f m, impulses %.6f and %.6f\n", place[0], place[1], impulse[0], impulse[1]);
    ck_assert_double_eq_tol(place[0], place[1], 1e-3 * CELL);
    ck_assert_double_eq_tol(impulse[0], impulse[1], 1e-3 * impulse[0]);
}
END_TEST

// ------------------------------------------------------------------------------------------ surfaces

// A square of `parts` x `parts` times two triangles in the plane z = `at`, up.
static brunt_boundary_surface_def *def_floor(brunt_world_def *def, double at, int parts, brunt_condition condition) {
    brunt_boundary_surface_def *s = &def->surfaces[def->surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->condition = condition;
    s->point = brunt_alloc((size_t)((parts + 1) * (parts + 1)) * sizeof *s->point);
    s->facet = brunt_alloc((size_t)(2 * parts * parts) * sizeof *s->facet);
    for (int k = 0; k < (parts + 1) * (parts + 1); k++) {
        double *x = s->point[s->point_count++];
        x[0] = -1 + 2.0 * (k / (parts + 1)) / parts, x[1] = -1 + 2.0 * (k % (parts + 1)) / parts, x[2] = at;
    }
    for (int k = 0; k < parts * parts; k++) {
        const int32_t a = k / parts * (parts + 1) + k % parts, b = a + parts + 1;
        memcpy(s->facet[s->facet_count++], (const int32_t[4]){a, b, b + 1, -1}, sizeof *s->facet);
        memcpy(s->facet[s->facet_count++], (const int32_t[4]){a, b + 1, a + 1, -1}, sizeof *s->facet);
    }
    return s;
}

// A ball that falls on a floor does the same however that is cut into triangles, and slides and turns as friction has
// it.
START_TEST(cut) {
    double place[3][3], impulse[3];
    static const int parts[] = {1, 7, 24};
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = explicit_def(3);
        def_velocity(def_ball(&def, "ball", XYZ(0.03, 0.02, 0.26), 0.22), 1, 0.5, -2);
        def_floor(&def, 0.02, parts[k], BRUNT_SEPARATE)->friction = 0.3;
        def.step = 5e-4;
        brunt_world *world = world_take(&def);
        world_until(world, 0.08);
        const brunt_body_sums s = world_sums(world, 0);
        memcpy(place[k], s.centre, sizeof place[k]);
        impulse[k] = world_boundary(world, 0).impulse[2];
        ck_assert_double_le(world_momentum(world).linear_drift, 10 * ROUNDING);
        ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
        ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
        printf("  %4d triangles: at %.6f %.6f %.6f, impulse %.5f\n", 2 * parts[k] * parts[k], s.centre[0], s.centre[1],
               s.centre[2], impulse[k]);
        brunt_world_destroy(world);
    }
    for (int k = 1; k < 3; k++) {
        for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(place[k][a], place[0][a], 1e-4 * CELL);
        ck_assert_double_eq_tol(impulse[k], impulse[0], 1e-4 * impulse[0]);
    }
}
END_TEST

// A ball in a box of six sides, of quadrangles, that is shaken: it stays within.
START_TEST(box) {
    static const double table[4][2] = {{0, 0}, {0.05, 1}, {0.15, -1}, {0.2, 0}};
    static const int32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    brunt_world_def def = explicit_def(3);
    def_ball(&def, "ball", XYZ(0.3, 0.3, 0.3), 0.2);
    brunt_boundary_surface_def *s = &def.surfaces[def.surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->condition = BRUNT_SEPARATE, s->displacement = true, s->value[0] = 0.4, s->value[2] = 0.1,
    s->rotation.angle = 0.3;
    s->rotation.axis[0] = 1;
    s->point = brunt_alloc(8 * sizeof *s->point), s->facet = brunt_alloc(6 * sizeof *s->facet);
    for (int k = 0; k < 8; k++, s->point_count++)
        for (int a = 0; a < 3; a++) s->point[k][a] = k >> a & 1 ? 0.57 : 0.03;
    for (int f = 0; f < 6; f++, s->facet_count++)
        for (int c = 0; c < 4; c++) s->facet[f][c] = sides[f][c]; // inwards
    s->table.count = 4, s->table.points = brunt_alloc(sizeof table);
    memcpy(s->table.points, table, sizeof table);
    brunt_world *world = world_take(&def);
    world_until(world, 0.25);
    double *x = world_field(world, 0, "position");
    for (int64_t k = 0; k < 3 * brunt_body_particles(world, 0); k++) ck_assert(x[k] > 0.03 && x[k] < 0.57);
    free(x);
    printf("  work %.3f J, energy %.1e, momentum %.1e\n", report_of(world).work, world_energy(world).error_relative,
           world_momentum(world).linear_drift);
    ck_assert_double_gt(report_of(world).work, 1);
    ck_assert_double_le(fabs(world_energy(world).error_relative), ENERGY);
    ck_assert_double_le(world_momentum(world).angular_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ the same bits

static brunt_world *tossed(int threads) {
    const lie l = lying(0.2);
    brunt_world_def def = explicit_def(2);
    def_velocity(turned_box(&def, &l, 0.03, 0.02, 0.6, 0.6), 0.5, -1, 0);
    def_ball(&def, "disk", XYZ(1.2, 0.62, 0), 0.3);
    turned_line(&def, &l, -2, 3, 0.01, BRUNT_SEPARATE)->friction = 0.3;
    turned_line(&def, &l, -2, 3, 0.3, BRUNT_STICK)->value[0] = 0.1;
    snprintf(def.surfaces[1].body, sizeof def.surfaces[1].body, "disk");
    def.gravity[1] = -10;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(same_bits) {
    brunt_world *world[] = {tossed(1), tossed(2), tossed(5), tossed(1)};
    for (int k = 0; k < 3; k++) world_steps(world[k], 40);
    world_copy_state(world[0], world[3]);
    for (int k = 0; k < 4; k++) {
        world_steps(world[k], 40);
        ck_assert_uint_eq(brunt_world_hash(world[k]), brunt_world_hash(world[0]));
        const brunt_boundary_surface_report one = report_of(world[0]), other = report_of(world[k]);
        ck_assert_int_eq(memcmp(&one, &other, sizeof one), 0);
    }
    ck_assert_double_gt(report_of(world[0]).impulse[1], 0);
    for (int k = 0; k < 4; k++) brunt_world_destroy(world[k]);
}
END_TEST

// Tractions of pieces are what the bodies get.
START_TEST(tractions) {
    brunt_world *world = tossed(1);
    world_steps(world, 60);
    for (int32_t k = 0; k < 2; k++) {
        const int64_t count = brunt_boundary_surface_size(world, k);
        double *values = malloc((size_t)count * 10 * sizeof *values), sum[3] = {0};
        int64_t *piece = malloc((size_t)count * sizeof *piece);
        const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count,
                                                      values + 9 * count, piece};
        brunt_boundary_surface_particles(world, k, &arrays);
        for (int64_t b = 0; b < 3 * count; b++) sum[b % 3] += arrays.weight[b / 3] * arrays.traction[b];
        const brunt_reaction f = world_boundary(world, k);
        for (int a = 0; a < 2; a++)
            ck_assert_double_eq_tol(sum[a], f.force[a], 1e-3 * hypot(f.force[0], f.force[1]) + 1e-9);
        free(values), free(piece);
    }
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ nearest places

// Of a bent strip of triangles: the nearest place is the nearest of all samples, its normal is along the way to it.
START_TEST(nearest) {
    brunt_boundary_surface_def s = brunt_boundary_surface_def_default();
    double point[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0.7}, {1, 2, 0.7}};
    int32_t facet[4][4] = {{0, 1, 3, -1}, {0, 3, 2, -1}, {2, 3, 5, 4}, {0, 0, 0, 0}};
    s.point = point, s.point_count = 6, s.facet = facet, s.facet_count = 3;
    brunt_facets f;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_facets_make(&f, &s, 3, &error), BRUNT_OK);
    ck_assert_int_eq(f.count, 4);
    for (int k = 0; k < 200; k++) {
        const double x[3] = {-0.3 + 0.017 * (k % 97), -0.4 + 0.0131 * (k * 7 % 211), -0.6 + 0.01 * (k * 13 % 130)};
        double least = INFINITY;
        for (int i = 0; i <= 200; i++)
            for (int j = 0; j <= 400; j++) {
                const double y = j / 200.0, at[3] = {i / 200.0, y, 0.7 * fmax(0, y - 1)};
                least = fmin(least, hypot(hypot(x[0] - at[0], x[1] - at[1]), x[2] - at[2]));
            }
        brunt_touch touch[BRUNT_TOUCH_LIMIT];
        const int count = brunt_facets_near(&f, x, 3, touch);
        double found = INFINITY;
        for (int t = 0; t < count; t++) {
            found = fmin(found, fabs(touch[t].distance));
            for (int a = 0; a < 3; a++)
                ck_assert_double_eq_tol(touch[t].at[a] + touch[t].distance * touch[t].normal[a], x[a], 1e-9);
        }
        ck_assert_double_le(fabs(found - least), 6e-3);
        ck_assert(brunt_facets_are_far(&f, x, found - 1e-9) && !brunt_facets_are_far(&f, x, found + 1e-9));
        ck_assert_int_le(count, 2); // in the valley both slopes
    }
    brunt_facets_free(&f);
}
END_TEST

// In two dimensions: within a part, right at a corner, beyond an end.
START_TEST(nearest_of_line) {
    brunt_boundary_surface_def s = brunt_boundary_surface_def_default();
    double point[3][3] = {{0, 0}, {1, 0}, {1, -1}};
    int32_t facet[2][4] = {{0, 1, -1, -1}, {1, 2, -1, -1}};
    s.point = point, s.point_count = 3, s.facet = facet, s.facet_count = 2;
    brunt_facets f;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_facets_make(&f, &s, 2, &error), BRUNT_OK);
    static const struct {
        double x[3], distance, normal[2];
        int count;
        bool rim;
    } wanted[] = {{{0.4, 0.2}, 0.2, {0, 1}, 1, false},
                  {{1.3, 0.4}, 0.5, {0.6, 0.8}, 1, false},
                  {{1, 0}, 0, {0.7071067811865476, 0.7071067811865476}, 1, false},
                  {{-0.3, 0.4}, 0.5, {-0.6, 0.8}, 1, true},
                  {{0.9, -0.2}, -0.1, {1, 0}, 2, false}};
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        brunt_touch touch[BRUNT_TOUCH_LIMIT];
        int least = 0;
        const int count = brunt_facets_near(&f, wanted[k].x, 0.6, touch);
        ck_assert_int_eq(count, wanted[k].count);
        for (int t = 0; t < count; t++)
            if (fabs(touch[t].distance) < fabs(touch[least].distance)) least = t;
        ck_assert_double_eq_tol(touch[least].distance, wanted[k].distance, 1e-12);
        for (int a = 0; a < 2; a++) ck_assert_double_eq_tol(touch[least].normal[a], wanted[k].normal[a], 1e-12);
        ck_assert_int_eq(touch[least].rim, wanted[k].rim);
    }
    brunt_facets_free(&f);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("boundary_points");
    ADD_LOOP(slides, 12);
    ADD_LOOP(meets, 16);
    ADD_LOOP(moves, 1);
    ADD_LOOP(rubs, 3);
    ADD_LOOP(rolls, 1);
    ADD_LOOP(rests, 3);
    ADD_LOOP(pushed_out, 1);
    ADD_LOOP(behind, 1);
    ADD_LOOP(carries, 1);
    ADD_LOOP(turns, 2);
    ADD_LOOP(corners, 4);
    ADD_LOOP(thin, 4);
    ADD_LOOP(on_a_node, 2);
    ADD_LOOP(far_away, 1);
    ADD_LOOP(half, 1);
    ADD_LOOP(cut, 1);
    ADD_LOOP(box, 1);
    ADD_LOOP(same_bits, 1);
    ADD_LOOP(tractions, 1);
    ADD_LOOP(nearest, 1);
    ADD_LOOP(nearest_of_line, 1);
    return suite_main(suite);
}
