// Load steps with lines and surfaces: as implicit steps without end, what they press, let go, hold and do not hold.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // load steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

static brunt_world_def begin(int dim, int order, int steps, double nu) {
    brunt_world_def def = def_begin(dim, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, nu);
    hold_by_surfaces(&def, order, 1e5);
    if (steps)
        def.scheme = BRUNT_STATIC, def.load_steps = steps, def.step = 0, def.end = 0, def.newton.tolerance = 1e-10;
    return def;
}

static void turn(brunt_body_def *b, double c, double s) {
    b->place.rotation[0] = c, b->place.rotation[1] = -s, b->place.rotation[3] = s, b->place.rotation[4] = c;
}

static void set_table(brunt_boundary_surface_def *s, int count, const double (*points)[2]) {
    s->table.points = brunt_alloc((size_t)count * sizeof *s->table.points), s->table.count = count;
    memcpy(s->table.points, points, (size_t)count * sizeof *points);
}

static double angle_of(int k) { return k % 3 * PI / 6; }

// A bar that hangs from its face, in space or in the plane, turned in the grid.
static brunt_world *bar(int dim, int order, double angle, int steps) {
    brunt_world_def def = begin(dim, order, steps, 0);
    const double c = cos(angle), s = sin(angle);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1, 0.5, 0.3));
    turn(b, c, s);
    if (dim == 2) {
        b->particles_per_cell = 16;
        def_line(&def, 0, 0, -0.5 * s, 0.5 * c, BRUNT_STICK);
    } else {
        brunt_boundary_surface_def *q = def_polyline(&def, 4, true, BRUNT_STICK);
        for (int k = 0; k < 4; k++) {
            const double across = k % 3 ? 0.5 : 0;
            q->point[k][0] = -across * s, q->point[k][1] = across * c, q->point[k][2] = k < 2 ? 0 : 0.3;
        }
        q->facet_count = 1, memcpy(q->facet[0], (const int32_t[4]){0, 1, 2, 3}, sizeof q->facet[0]);
    }
    def.gravity[0] = 10 * c, def.gravity[1] = 10 * s;
    return world_take(&def);
}

// It is where implicit steps of any length end, held by its weight.
START_TEST(hangs) {
    const int dim = 2 + _i % 2, order = 1 + _i / 2 % 2;
    const double angle = angle_of(_i / 4), c = cos(angle), s = sin(angle);
    double place[2][2];
    for (int k = 0; k < 2; k++) {
        brunt_world *world = bar(dim, order, angle, k);
        world_steps(world, 1);
        const brunt_body_sums sums = world_sums(world, 0);
        const brunt_reaction f = world_boundary(world, 0);
        const double weight = sums.mass * 10;
        memcpy(place[k], sums.centre, sizeof place[k]);
        ck_assert_double_le(fabs(f.force[0] + weight * c), 1e-8 * weight);
        ck_assert_double_le(fabs(f.force[1] + weight * s), 1e-8 * weight);
        ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-8);
        ck_assert(!k || world_energy(world).kinetic == 0);
        brunt_world_destroy(world);
    }
    const double way = hypot(place[0][0] - (0.5 * c - 0.25 * s), place[0][1] - (0.5 * s + 0.25 * c));
    printf("  %dD, order %d, %.0f degrees: way %.6g m, %.1e of it off\n", dim, order, angle * 180 / PI, way,
           hypot(place[1][0] - place[0][0], place[1][1] - place[0][1]) / way);
    ck_assert_double_le(fabs(place[1][0] - place[0][0]), 1e-7 * way);
    ck_assert_double_le(fabs(place[1][1] - place[0][1]), 1e-7 * way);
}
END_TEST

// Two lines draw a bar, nothing else loads it; by one of both, or one each half way the other way: the work is stored,
// and goes back.
START_TEST(drawn) {
    static const double table[3][2] = {{0, 0}, {0.5, 1}, {1, 0}};
    brunt_world_def def = begin(2, 2, 8, 0);
    const double angle = angle_of(_i), c = cos(angle), s = sin(angle), L = 1, H = 0.4, way = 0.02;
    const double share = 0.5 * (_i / 3); // of the first line
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(L, H, 0));
    b->particles_per_cell = 16;
    turn(b, c, s);
    for (int k = 0; k < 2; k++) {
        const double x = k ? L * c : 0, y = k ? L * s : 0, goes = way * (k ? 1 - share : -share);
        brunt_boundary_surface_def *q = def_line(&def, x, y, x - H * s, y + H * c, BRUNT_STICK);
        q->displacement = true, q->value[0] = goes * c, q->value[1] = goes * s;
        set_table(q, 3, table);
    }
    brunt_world *world = world_take(&def);
    world_until(world, 0.5);
    const brunt_reaction f = world_boundary(world, 1), o = world_boundary(world, 0);
    const brunt_energy e = world_energy(world);
    const double F = 1 + way / L, force = 0.5 * YOUNG * (F - 1 / F) * H; // nu = 0: mu (F - 1/F), lambda = 0
    printf("  %.0f degrees, %g of the way by the first: force %.6g, %.6g N wanted, work %.6g of %.6g J stored\n",
           angle * 180 / PI, share, f.force[0] * c + f.force[1] * s, force, e.external_work, e.internal);
    ck_assert_double_le(fabs((f.force[0] * c + f.force[1] * s) / force - 1), 1e-2);
    ck_assert_double_le(fabs(f.force[1] * c - f.force[0] * s) / force, 1e-3);
    for (int a = 0; a < 2; a++) ck_assert_double_le(fabs(f.force[a] + o.force[a]), 1e-8 * force);
    ck_assert_double_le(fabs(e.external_work / e.internal - 1), 1e-2);
    world_until(world, 1);
    const brunt_energy end = world_energy(world);
    ck_assert_double_le(fabs(end.internal), 1e-2 * e.internal);
    ck_assert_double_le(fabs(end.external_work), 2e-2 * e.internal);
    ck_assert_double_le(fabs(end.error), 1e-8 * e.internal);
    brunt_world_destroy(world);
}
END_TEST

// Nothing acts: nothing moves.
START_TEST(rests) {
    brunt_world_def def = begin(2, 2, 3, 0.3);
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.53, 0.52, 0));
    def_line(&def, -1, 0.02, 2, 0.02, (brunt_condition)(_i % 2 ? BRUNT_STICK : BRUNT_SEPARATE));
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    ck_assert(before.centre[0] == after.centre[0] && before.centre[1] == after.centre[1]);
    ck_assert(world_boundary(world, 0).force[1] == 0);
    brunt_world_destroy(world);
}
END_TEST

// A block between two lines that it may leave, the upper one comes from some way off, presses and goes again.
static brunt_world_def press(double gap, double way, int steps) {
    static const double table[3][2] = {{0, 0}, {0.5, 1}, {1, -0.5}};
    brunt_world_def def = begin(2, 2, steps, 0);
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.53, 0.52, 0))->particles_per_cell = 16;
    def_line(&def, -1, 0.02, 2, 0.02, BRUNT_SEPARATE);
    brunt_boundary_surface_def *q = def_line(&def, 2, 0.52 + gap, -1, 0.52 + gap, BRUNT_SEPARATE);
    q->displacement = true, q->value[1] = -way;
    set_table(q, 3, table);
    return def;
}

START_TEST(presses) {
    static const double gaps[] = {0, 0.004, 0.03, 0.12};
    const double gap = gaps[_i], way = gap + 0.02;
    brunt_world_def def = press(gap, way, _i < 3 ? 4 : 12);
    brunt_world *world = world_take(&def);
    world_until(world, 0.5);
    const brunt_reaction f = world_boundary(world, 1), o = world_boundary(world, 0);
    const brunt_energy e = world_energy(world);
    const double F = 1 - 0.02 / 0.5, force = -0.5 * YOUNG * (F - 1 / F) * 0.5;
    printf("  from %.3f m: force %.6g N, %.6g wanted; stored %.6g J\n", gap, o.force[1], force, e.internal);
    ck_assert_double_le(fabs(o.force[1] / force - 1), 3e-2);
    ck_assert_double_le(fabs(f.force[1] + o.force[1]), 1e-8 * force);
    world_until(world, 1);
    ck_assert_double_eq(world_boundary(world, 1).force[1], 0);
    ck_assert_double_le(world_energy(world).internal, 2e-2 * e.internal);
    brunt_world_destroy(world);
}
END_TEST

// What would go through a line in one load step, from where its grid does not reach it, is cut to parts of one; if
// those are too long still the line is named.
START_TEST(comes_from_afar) {
    brunt_error error = {0};
    brunt_world_def def = press(0.7, 0.72, 2);
    def.newton.cut = _i ? 1 : 8;
    brunt_world *world = world_take(&def);
    int status = BRUNT_OK;
    while (!status && brunt_world_time(world) < 0.5) status = brunt_world_step(world, INFINITY, &error);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  %g cuts; %s\n", n.cuts, status ? error.message : "pressed");
    ck_assert_int_eq(status, _i ? BRUNT_FAILED : BRUNT_OK);
    if (_i) ck_assert_ptr_nonnull(strstr(error.message, "material comes to boundary 'surface2' from farther"));
    if (!_i) ck_assert_double_gt(n.cuts, 0);
    if (!_i) ck_assert_double_gt(world_boundary(world, 0).force[1], 1e3);
    brunt_world_destroy(world);
}
END_TEST

// What lines cannot bear is said with the body: along a line it slips on, off one it may leave, or by one piece alone.
START_TEST(not_held) {
    brunt_error error = {0};
    brunt_world_def def = begin(2, 2, 1, 0.3);
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.53, 0.52, 0));
    if (_i < 3) def_line(&def, -1, 0.02, 2, 0.02, _i ? BRUNT_SEPARATE : BRUNT_SLIP);
    if (_i == 2) def.surfaces[0].friction = 0.3;
    if (_i == 3) def_line(&def, 0.03, 0.52, 0.03, 0.52 - 0.02, BRUNT_SLIP);
    def.gravity[0] = _i == 1 ? 0 : 1, def.gravity[1] = _i == 1 ? 1 : -1;
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    printf("  %s\n", error.message);
    ck_assert_str_eq(error.body, "block");
    brunt_world_destroy(world);
}
END_TEST

// Friction carries what is below its cone, and no more: a block under its weight and a load along the floor.
START_TEST(rubs) {
    brunt_world_def def = begin(2, 2, 4, 0.3);
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.83, 0.42, 0));
    def_line(&def, -1, 0.02, 2, 0.02, BRUNT_SEPARATE)->friction = 0.3;
    def.gravity[0] = _i ? -0.27 : 0.27, def.gravity[1] = -1; // either way
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    const brunt_reaction f = world_boundary(world, 0);
    const double mass = world_sums(world, 0).mass;
    ck_assert_double_le(fabs(f.force[0] + mass * (_i ? -0.27 : 0.27)), 1e-8 * mass);
    ck_assert_double_le(fabs(f.force[1] - mass), 1e-8 * mass);
    brunt_world_destroy(world);
}
END_TEST

// A column that is shortened between a foot that holds it and a line that it may leave buckles: it carries Euler's
// load, with ends that do not turn, and no more.
START_TEST(buckles) {
    brunt_world_def def = begin(2, 2, 30, 0);
    const double L = 2, H = 0.2, I = H * H * H / 12, wanted = PI * PI * YOUNG * I / (L * L);
    def_box(&def, "column", XYZ(0.03, 0.02, 0), XYZ(0.03 + H, 0.02 + L, 0))->particles_per_cell = 16;
    def_line(&def, 0.03, 0.02, 0.03 + H, 0.02, BRUNT_STICK)->piece = 1;
    brunt_boundary_surface_def *top = def_line(&def, 1, 0.02 + L, -1, 0.02 + L, BRUNT_SEPARATE);
    top->piece = 1;
    top->displacement = true, top->value[1] = -0.03; // straight it would carry 3 kN
    set_table(top, 2, (const double[2][2]){{0, 0}, {1, 1}});
    brunt_world *world = world_take(&def);
    double most = 0, last = 0;
    while (brunt_world_time(world) < 1)
        world_steps(world, 1), most = fmax(most, last = world_boundary(world, 0).force[1]);
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    printf("  carries %.1f N at most, %.1f N at the end, Euler %.1f N; %g cuts\n", most, last, wanted, n.cuts);
    ck_assert_double_le(fabs(most / wanted - 1), 0.1);
    ck_assert_double_gt(last, 0);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *pressed(int threads) {
    brunt_world_def def = press(0.004, 0.024, 6);
    def.surfaces[0].friction = 0.3;
    def.gravity[0] = 0.1, def.gravity[1] = -1;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {pressed(1), pressed(2), pressed(5)};
    check_threads(world, 3, 4);
}
END_TEST

START_TEST(restart) { check_restart(pressed(1), pressed(1)); }
END_TEST

int main(void) {
    Suite *suite = suite_create("static_lines");
    ADD_LOOP(hangs, 12);
    ADD_LOOP(drawn, 6);
    ADD_LOOP(rests, 2);
    ADD_LOOP(presses, 4);
    ADD_LOOP(comes_from_afar, 2);
    ADD_LOOP(not_held, 4);
    ADD_LOOP(rubs, 2);
    ADD_LOOP(buckles, 1);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    return suite_main(suite);
}
#endif
