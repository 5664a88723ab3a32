// Load steps: a bar that hangs, a beam that bends, columns that buckle, what nothing holds, contact, work, bits.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // load steps want double
#else

static const double E = 90e6, density = 1000, g = 9.81, LENGTH = 8;

static brunt_world_def begin(double cell, int steps) {
    brunt_world_def def = def_begin(2, cell);
    def.scheme = BRUNT_STATIC, def.load_steps = steps, def.end = 0;
    def.contact.method = BRUNT_CONTACT_NONE;
    def.newton.tolerance = 1e-10;
    return def;
}

static brunt_group_def *group(brunt_world_def *def, const char *body, const char *name, brunt_group_action action) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *q = &def->groups[def->group_count++];
    *q = brunt_group_def_default();
    q->action = action;
    snprintf(q->body, sizeof q->body, "%s", body);
    snprintf(q->group, sizeof q->group, "%s", name);
    return q;
}

static void table(brunt_group_def *q, int count, const double (*points)[2]) {
    q->table.points = brunt_def_alloc((size_t)count * sizeof *q->table.points);
    q->table.count = count;
    memcpy(q->table.points, points, (size_t)count * sizeof *points);
}

// A box of elements.
static brunt_body_def *mesh(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                            double size) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    return b;
}

static brunt_newton_counts counts_of(const brunt_world *world) {
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    return counts;
}

// The node that started nearest to a place: its displacement.
static double node_way(brunt_world *world, int body, double X, double Y, int component) {
    double *x = world_field(world, body, "position"), *u = world_field(world, body, "displacement"), best = INFINITY;
    double way = NAN;
    for (int64_t n = 0; n < brunt_body_nodes(world, body); n++) {
        const double off = hypot(x[3 * n] - u[3 * n] - X, x[3 * n + 1] - u[3 * n + 1] - Y);
        if (off < best) best = off, way = u[3 * n + component];
    }
    free(x), free(u);
    return way;
}

// ------------------------------------------------------------------------------------------ a bar that hangs

// St Venant-Kirchhoff, nu = 0: F E (F^2 - 1) / 2 = rho g (L - X). Stretch less 1 at X, by Newton's method.
static double strain_at(double X) {
    double F = 1;
    const double load = density * g * (LENGTH - X) / E;
    for (int k = 0; k < 30; k++) F -= (F * (F * F - 1) / 2 - load) / (1.5 * F * F - 0.5);
    return F - 1;
}

// Displacement of the end, or the mean of the bar's: int e, or int e (1 - X/L), by the midpoints of many pieces.
static double bar_way(bool mean) {
    enum { PIECES = 100000 };
    double sum = 0;
    for (int k = 0; k < PIECES; k++) {
        const double X = LENGTH * (k + 0.5) / PIECES;
        sum += strain_at(X) * (mean ? 1 - X / LENGTH : 1) * LENGTH / PIECES;
    }
    return sum;
}

static brunt_world_def bar_of(bool points, double size, int steps, double far) {
    brunt_world_def def = begin(size, steps);
    def_material(&def, "st-venant-kirchhoff", density, E, 0);
    const double low[3] = {far, 2 * far, 0}, high[3] = {LENGTH + far, 1 + 2 * far, 0};
    def.gravity[0] = g;
    if (points) {
        def_box(&def, "bar", low, high);
        def.kernel = BRUNT_LINEAR;
        def_plane(&def, low, XYZ(1, 0, 0), BRUNT_STICK, 0);
        return def;
    }
    mesh(&def, "bar", low, high, size);
    group(&def, "bar", "xmin", BRUNT_GROUP_DISPLACEMENT);
    return def;
}

static brunt_world *bar(bool points, double size, int steps, double far) {
    brunt_world_def def = bar_of(points, size, steps, far);
    return world_take(&def);
}

// Elements: nodes are where they are to be; points: the mean way is, to second order in the cell in one step; in ten,
// of which each has a new grid, what has gone over the edge of a cell counts. Here and far away.
START_TEST(hangs) {
    const bool points = _i % 2;
    const int steps = _i / 4 ? 1 : 10;
    const double far = _i / 2 % 2 ? 1024 : 0, exact = bar_way(points);
    ck_assert_double_eq_tol(bar_way(false), 3.484964e-3, 1e-9);
    double error[2];
    for (int k = 0; k < 2; k++) {
        brunt_world *world = bar(points, 0.25 / (k + 1), steps, far);
        const double start = world_sums(world, 0).centre[0];
        world_until(world, 1);
        const double way =
            points ? world_sums(world, 0).centre[0] - start : node_way(world, 0, far + LENGTH, 2 * far + 0.5, 0);
        const brunt_energy e = world_energy(world);
        error[k] = fabs(way / exact - 1);
        printf("  %s, %g: %.9g of %.9g m (%.1e), held by %.9g N, energy error %.1e, kinetic %g\n",
               points ? "points" : "elements", 0.25 / (k + 1), way, exact, error[k], world_boundary(world, 0).force[0],
               e.error_relative, e.kinetic);
        ck_assert_double_eq_tol(world_boundary(world, 0).force[0], -78480, 78480e-8);
        ck_assert_double_le(fabs(e.error_relative), 1e-8);
        ck_assert(e.kinetic == 0 && brunt_world_steps(world) == steps);
        ck_assert_double_le(counts_of(world).residual, 1e-10);
        brunt_world_destroy(world);
    }
    ck_assert_double_le(error[0], points ? 1e-3 : 1e-6);
    if (points && steps == 1) ck_assert_double_ge(error[0] / error[1], 3.5);
}
END_TEST

// What is elastic ends where it ends, however many load steps: work by the trapezium rule misses what is stored by the
// square of their length.
START_TEST(steps_alike) {
    const int steps[] = {1, 4, 8};
    double tip[3], taken[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = bar_of(false, 0.25, steps[k], 0);
        def.gravity[0] = 0, def.gravity[1] = -g;
        brunt_world *world = world_take(&def);
        world_until(world, 1);
        tip[k] = node_way(world, 0, LENGTH, 0.5, 1), taken[k] = world_energy(world).scheme;
        ck_assert_double_eq_tol(world_boundary(world, 0).force[1], 78480, 78480e-7);
        ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-7);
        printf("  %d steps: tip %.10g m, %.4g J taken, %.0f iterations\n", steps[k], tip[k], taken[k],
               counts_of(world).iterations);
        brunt_world_destroy(world);
    }
    ck_assert_double_eq_tol(tip[1], tip[0], 1e-7);
    ck_assert_double_eq_tol(tip[2], tip[0], 1e-7);
    ck_assert_double_ge(taken[1] / taken[2], 3.5);
    ck_assert_double_le(taken[1] / taken[2], 4.5);
}
END_TEST

// A beam under its weight, held at one end: tip .67443 m down and .032441 m back (conforming elements, extrapolated).
START_TEST(bends) {
    double error[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = bar_of(false, 0.25 / (k + 1), 10, 0);
        def.gravity[0] = 0, def.gravity[1] = -g;
        brunt_world *world = world_take(&def);
        world_until(world, 1);
        error[k] = -node_way(world, 0, LENGTH, 0.5, 1) / 0.67443 - 1;
        printf("  size %g: tip off by %.4f, back %.6g m\n", 0.25 / (k + 1), error[k],
               node_way(world, 0, LENGTH, 0.5, 0));
        brunt_world_destroy(world);
    }
    const double order = log2(error[0] / error[1]);
    printf("  order %.3f\n", order);
    ck_assert_double_le(error[1], 0.015);
    ck_assert_double_ge(order, 1.8);
    ck_assert_double_le(order, 2.2);
}
END_TEST

// ------------------------------------------------------------------------------------------ loads that come and go

// A traction goes up, back and beyond: what it does is undone, and then mirrored.
START_TEST(reversed) {
    static const double there_and_back[][2] = {{0, 0}, {0.25, 1}, {0.5, 0}, {0.75, -1}, {1, 0}};
    brunt_world_def def = begin(1, 8);
    def_material(&def, "linear-elastic", density, E, 0.3);
    mesh(&def, "bar", XYZ(0, 0, 0), XYZ(2, 1, 0), 0.25);
    group(&def, "bar", "xmin", BRUNT_GROUP_DISPLACEMENT);
    brunt_group_def *load = group(&def, "bar", "xmax", BRUNT_GROUP_TRACTION);
    load->value[1] = 1e3;
    table(load, 5, there_and_back);
    brunt_world *world = world_take(&def);
    double tip[5];
    for (int k = 0; k < 5; k++) {
        world_until(world, 0.25 * k);
        tip[k] = node_way(world, 0, 2, 0.5, 1);
    }
    printf("  tip %.4g, %.4g, %.4g, %.4g, %.4g m; %.3g J left\n", tip[0], tip[1], tip[2], tip[3], tip[4],
           world_energy(world).internal);
    ck_assert(tip[0] == 0 && tip[1] > 1e-4);
    ck_assert_double_eq_tol(tip[2], 0, 1e-8 * tip[1]);
    ck_assert_double_eq_tol(tip[3], -tip[1], 1e-3 * tip[1]);
    ck_assert_double_eq_tol(tip[4], 0, 1e-8 * tip[1]);
    brunt_world_destroy(world);
}
END_TEST

// No load at all: nothing is done.
START_TEST(no_load) {
    brunt_world_def def = bar_of(_i, 0.25, 3, 1024);
    def.gravity[0] = 0;
    brunt_world *world = world_take(&def);
    double *before = world_field(world, 0, "position");
    world_until(world, 1);
    double *after = world_field(world, 0, "position");
    const int64_t n = _i ? brunt_body_particles(world, 0) : brunt_body_nodes(world, 0);
    ck_assert_int_eq(memcmp(before, after, (size_t)n * 3 * sizeof *before), 0);
    ck_assert_double_eq(counts_of(world).iterations, 0);
    free(before), free(after);
    brunt_world_destroy(world);
}
END_TEST

// Prescribed motion grows in proportion where no table says otherwise: a bar is drawn, and turned as a whole. With the
// direct solver, and without a matrix, from the tangent's prediction too.
START_TEST(drawn_and_turned) {
    const bool turned = _i % 2;
    brunt_world_def def = begin(1, 4);
    def_material(&def, "neo-hookean", density, E, 0);
    mesh(&def, "bar", XYZ(0, 0, 0), XYZ(2, 1, 0), 0.5);
    brunt_group_def *left = group(&def, "bar", "xmin", turned ? BRUNT_GROUP_ROTATION : BRUNT_GROUP_DISPLACEMENT);
    left->rotation.angle = PI / 3;
    if (!turned) group(&def, "bar", "xmax", BRUNT_GROUP_DISPLACEMENT)->value[0] = 0.5;
    if (!turned) def.groups[1].component[1] = left->component[1] = false;
    if (!turned) group(&def, "bar", "ymin", BRUNT_GROUP_DISPLACEMENT)->component[0] = false;
    if (_i / 2) def.newton.solver = BRUNT_SOLVER_MATRIX_FREE, def.newton.accuracy = 1e-9;
    def.energy_limit = 0.1;
    brunt_world *world = world_take(&def);
    double before = 0, work = 0;
    for (int s = 1; s <= 4; s++) {
        world_until(world, 0.25 * s);
        const double way = node_way(world, 0, 2, 0, 0), force = world_boundary(world, 0).force[0], F = 1 + s * 0.0625;
        work += 0.125 * (before - force) / 2, before = -force;
        const double exact = turned ? 2 * cos(PI / 3 * s / 4) - 2 : 0.125 * s;
        ck_assert_double_eq_tol(way, exact, 1e-6);
        // Neo-Hookean with lambda = 0, mu = E / 2: P = mu (F - 1 / F), of a face of 1 m.
        if (!turned) ck_assert_double_eq_tol(-force, 0.5 * E * (F - 1 / F), 1e-6 * E);
        if (turned) ck_assert_double_eq_tol(force, 0, 1e-3);
    }
    ck_assert_int_eq(brunt_world_steps(world), 4);
    printf("  %.6g N, %.6g J stored, %.6g J of work\n", world_boundary(world, 0).force[0], world_energy(world).internal,
           world_energy(world).external_work);
    // What is turned has the roundings of its moduli alone.
    if (turned) ck_assert_double_le(fabs(world_energy(world).error), 1e-15 * 2 * E);
    ck_assert_double_le(fabs(world_energy(world).error_relative), turned ? 0.1 : 0.01);
    // Of what moves nodes: the mean force of each load step along its way.
    if (!turned) ck_assert_double_eq_tol(world_energy(world).external_work, work, 1e-6 * work);
    brunt_world_destroy(world);
}
END_TEST

// Points of a soft and of a stiff material, 1 to 1e4, one upon the other: each is shortened as its own.
START_TEST(soft_on_stiff) {
    brunt_world_def def = begin(0.25, 2);
    def_material(&def, "linear-elastic", density, 1e6, 0);
    def_material(&def, "linear-elastic", density, 1e10, 0);
    def_box(&def, "lower", XYZ(0, 0, 0), XYZ(1, 1, 0))->material = _i;
    def_box(&def, "upper", XYZ(0, 1, 0), XYZ(1, 2, 0))->material = !_i;
    def.kernel = BRUNT_LINEAR, def.contact.method = BRUNT_CONTACT_TIED;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    const double start = world_sums(world, 0).centre[1], above = world_sums(world, 1).centre[1];
    world_until(world, 1);
    const double lower = start - world_sums(world, 0).centre[1], upper = above - world_sums(world, 1).centre[1];
    // Of a soft lower half: strain 1e-3 (2 - y), mean way 1e-3 int (2 - y)(1 - y) = 5/6e-3, upper 1.5e-3; above:
    // 1/3e-3.
    const double expect[2][2] = {{5e-3 / 6, 1.5e-3}, {0, 1e-3 / 3}};
    printf("  ways %.5g and %.5g m, %.8g N, %.0f iterations\n", lower, upper, world_boundary(world, 0).force[1],
           counts_of(world).iterations);
    ck_assert_double_eq_tol(lower, expect[_i][0], 2e-5);
    ck_assert_double_eq_tol(upper, expect[_i][1], 4e-5);
    ck_assert_double_eq_tol(world_boundary(world, 0).force[1], 2000, 1e-3);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is unstable

// A column of 1 m under a dead load that grows: Euler's, with shear (Timoshenko), to 1 %. What is beyond is refused.
START_TEST(buckles) {
    const double h = 0.025, plane = 10e6 / (1 - 0.09), shear = 5. / 6 * 10e6 / 2.6 * h, top = 1800;
    const double euler = PI * PI * plane * h * h * h / 12 / 4;
    double P = euler;
    for (int k = 0; k < 20; k++) P = euler / (1 + P / shear - P / (plane * h));
    brunt_world_def def = begin(1, 20);
    def_material(&def, "neo-hookean", density, 10e6, 0.3);
    brunt_body_def *b = mesh(&def, "column", XYZ(-h / 2, 0, 0), XYZ(h / 2, 1, 0), h / 8);
    b->grading[1].points = brunt_def_alloc(2 * sizeof *b->grading[1].points), b->grading[1].count = 2;
    b->grading[1].points[1][0] = 1, b->grading[1].points[0][1] = b->grading[1].points[1][1] = 4;
    group(&def, "column", "ymin", BRUNT_GROUP_DISPLACEMENT);
    brunt_group_def *push = group(&def, "column", "ymax", BRUNT_GROUP_TRACTION);
    push->value[1] = _i ? top : -top; // what draws it does not make it give way
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    int status = BRUNT_OK;
    while (!status && brunt_world_time(world) < 1) status = brunt_world_step(world, INFINITY, &error);
    printf("  stable up to %.6g N of %.6g (Euler %.6g): %s\n", brunt_world_time(world) * top * h, P, euler,
           error.message);
    if (_i) {
        ck_assert_int_eq(status, BRUNT_OK);
    } else {
        ck_assert_int_eq(status, BRUNT_FAILED);
        ck_assert(strstr(error.message, "is unstable") != NULL);
        ck_assert_str_eq(error.body, "column"); // which gives way most at its end
        ck_assert_double_eq_tol(error.position[1], 1, 0.01);
        ck_assert_double_eq_tol(brunt_world_time(world) * top * h, P, 0.01 * P);
        ck_assert_double_eq_tol(node_way(world, 0, 0, 1, 0), 0, 1e-6); // what is kept is the straight column
    }
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what nothing holds

// A block that nothing holds: under its weight (0) and turned (1) there is no equilibrium; drawn from both sides (2)
// there is one, where it was; pressed so (3) it turns over, by forces that keep their directions.
START_TEST(free_block) {
    static const char *const says[] = {"nothing holds it", "nothing holds it", NULL, "is unstable"};
    brunt_world_def def = begin(1, 2);
    def_material(&def, "neo-hookean", density, 10e6, 0.3);
    mesh(&def, "block", XYZ(3, 1, 0), XYZ(4, 2, 0), 0.25);
    if (_i == 0) def.gravity[0] = 10;
    if (_i == 3) def.newton.tolerance = 1e-6; // more would be by rounding: it turns over, and is drawn
    for (int side = 0; side < 2 && _i > 0; side++) {
        brunt_group_def *q = group(&def, "block", side ? "ymax" : "ymin", BRUNT_GROUP_TRACTION);
        q->value[_i == 1 ? 0 : 1] = (side ? 1 : -1) * (_i == 3 ? -1e4 : 1e4);
    }
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    int status = BRUNT_OK;
    while (!status && brunt_world_time(world) < 1) status = brunt_world_step(world, INFINITY, &error);
    ck_assert_int_eq(status, says[_i] ? BRUNT_FAILED : BRUNT_OK);
    if (says[_i]) ck_assert_msg(strstr(error.message, says[_i]) != NULL, "%s", error.message);
    if (_i < 2) ck_assert_str_eq(error.body, "block");
    if (_i == 2) {
        const brunt_body_sums s = world_sums(world, 0);
        const double E1 = 10e6 / 0.91, way = node_way(world, 0, 3.5, 2, 1) - node_way(world, 0, 3.5, 1, 1);
        ck_assert_double_eq_tol(s.centre[0], 3.5, 1e-9);
        ck_assert_double_eq_tol(s.centre[1], 1.5, 1e-9);
        ck_assert_double_eq_tol(way, 1e4 / E1, 5e-3 * 1e4 / E1);
    }
    brunt_world_destroy(world);
}
END_TEST

// A block begins above a plane and is borne by it: nothing else holds it.
START_TEST(lies_on_a_plane) {
    brunt_world_def def = begin(0.25, 2);
    def_material(&def, "neo-hookean", density, 1e6, 0.3);
    const double up = _i ? 0.05 : 0.01;
    if (_i)
        def_box(&def, "block", XYZ(0, up, 0), XYZ(1, 1 + up, 0));
    else
        mesh(&def, "block", XYZ(0, up, 0), XYZ(1, 1 + up, 0), 0.25);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.02;
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    const brunt_newton_counts counts = counts_of(world);
    printf("  %.9g of 10000 N, %.0f iterations, least gap %.3g, x %.12g, energy error %.1e\n",
           world_boundary(world, 0).force[1], counts.iterations, counts.least_part, world_sums(world, 0).centre[0],
           world_energy(world).error_relative);
    ck_assert_double_eq_tol(world_boundary(world, 0).force[1], 10000, 1e-4);
    ck_assert_double_gt(counts.least_part, 0.01);
    ck_assert_double_eq_tol(world_sums(world, 0).centre[0], 0.5, 1e-6);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// A light block beside a heavy one: of all forces those on it are next to nothing, and yet they balance where a step
// ends, however soft it is.
START_TEST(light_beside_heavy) {
    static const double soft[] = {6, 9, 12, 20, 40, 200};
    brunt_world_def def = begin(0.25, 2);
    def_material(&def, "linear-elastic", density, 1e8, 0.3);
    def_material(&def, "neo-hookean", 2e-4 * density, soft[_i], 0.3);
    mesh(&def, "heavy", XYZ(0, 1, 0), XYZ(1, 2, 0), 0.25);
    group(&def, "heavy", "ymin", BRUNT_GROUP_DISPLACEMENT);
    mesh(&def, "light", XYZ(2, 0.01, 0), XYZ(3, 1.01, 0), 0.25);
    def.bodies[1].material = 1;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.02;
    def.gravity[1] = -10;
    def.newton.tolerance = 1e-7;
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    brunt_balance balance;
    ck_assert(brunt_world_balance(world, &balance));
    printf("  light one of %.4g Pa: %.2e of the forces on body %d are left, %.2e of all\n", soft[_i], balance.body,
           balance.worst, balance.all);
    ck_assert_double_le(balance.body, 1e-5);
    ck_assert_double_le(balance.all, 1e-7);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ contact

// A disk between a held plate and one that comes down 2 R / 100: force over approach (Johnson 5.57), the same above and
// below.
START_TEST(disk_between_plates) {
    const double approach = 0.05, nu = 0.3, modulus = 10e6;
    brunt_world_def def = begin(1, 5);
    def_material(&def, "linear-elastic", density, modulus, nu);
    brunt_body_def *b = def_ball(&def, "disk", XYZ(0, 0, 0), 1);
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.02;
    def_plane(&def, XYZ(0, -1.0001, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def_plane(&def, XYZ(0, 1.0001, 0), XYZ(0, -1, 0), BRUNT_SEPARATE, 0)->velocity[1] = -approach;
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 1e-4, def.contact.stiffness = 1e5;
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    double low = 0, high = 1e6; // approach grows with the force up to here
    for (int k = 0; k < 100; k++) {
        const double F = 0.5 * (low + high), a = sqrt(4 * F * (1 - nu * nu) / (PI * modulus));
        const double d = 2 * F * (1 - nu * nu) / (PI * modulus) * (2 * log(4 / a) - 1);
        *(d < approach ? &low : &high) = F;
    }
    const double below = world_boundary(world, 0).force[1], above = -world_boundary(world, 1).force[1];
    const brunt_newton_counts counts = counts_of(world);
    const brunt_energy e = world_energy(world);
    printf("  %.7g below, %.7g above, %.7g N by Johnson; %.0f iterations, %.0f cuts, energy error %.1e of %.4g J\n",
           below, above, low, counts.iterations, counts.cuts, e.error_relative, e.reference);
    ck_assert_double_eq_tol(below, low, 0.015 * low);
    ck_assert_double_eq_tol(above, below, 1e-6 * below);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ cuts, bits

// Newton's method has 3 iterations: load steps are cut until those do, and no more than is allowed; then the run ends
// with the last equilibrium as it was.
START_TEST(cut_back) {
    brunt_world_def def = bar_of(false, 0.25, 2, 0);
    def.gravity[0] = 0, def.gravity[1] = -g;
    def.newton.iterations = 3, def.newton.cut = _i ? 1 : 8, def.newton.tolerance = 1e-7;
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    int status = BRUNT_OK;
    double shortest = 1, wanted = 0.5;
    while (!status && brunt_world_time(world) < 1) {
        const uint64_t before = brunt_world_hash(world);
        const double left = brunt_world_time(world) < 0.5 ? 0.5 - brunt_world_time(world) : 1 - brunt_world_time(world);
        status = brunt_world_step(world, INFINITY, &error);
        if (status) ck_assert_uint_eq(brunt_world_hash(world), before);
        if (status) break;
        // As long as the last one where that was cut, else twice as long, up to the next load step.
        brunt_newton_counts last;
        brunt_world_newton(world, NULL, &last);
        const double dt = brunt_world_dt(world);
        ck_assert_double_eq_tol(dt, ldexp(fmin(wanted, left), -(int)last.cuts), 1e-12);
        wanted = last.cuts > 0 ? dt : fmin(0.5, 2 * wanted);
        shortest = fmin(shortest, dt);
    }
    printf("  %lld steps, the shortest %g, %.0f cuts: %s\n", (long long)brunt_world_steps(world), shortest,
           counts_of(world).cuts, error.message);
    if (_i) {
        ck_assert_int_eq(status, BRUNT_FAILED);
        ck_assert(strstr(error.message, "body 'bar'") && strstr(error.message, "does not converge"));
        ck_assert(strstr(error.message, "a part 0.5 of a load step, halved 1 times"));
    } else {
        ck_assert_int_eq(status, BRUNT_OK);
        ck_assert_double_ge(counts_of(world).cuts, 1);
        ck_assert_double_le(counts_of(world).residual, 1e-7); // of what was tried in vain nothing is left in it
        ck_assert_double_ge(shortest, 0.5 / 256);
        ck_assert(brunt_world_time(world) == 1);
    }
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *pressed(int threads) {
    brunt_world_def def = begin(0.25, 6);
    def_material(&def, "neo-hookean", density, 1e6, 0.3);
    mesh(&def, "floor", XYZ(-1, -0.5, 0), XYZ(2, 0, 0), 0.25);
    group(&def, "floor", "ymin", BRUNT_GROUP_DISPLACEMENT);
    def_box(&def, "upper", XYZ(0, 0.02, 0), XYZ(1, 0.52, 0));
    def.gravity[1] = -10;
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.05;
    def.newton.iterations = 16; // by the rounding of some processors a step is cut, by 12 they do not converge
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {pressed(1), pressed(2), pressed(3)};
    check_threads(world, 3, 6);
}
END_TEST

START_TEST(restart) { check_restart(pressed(1), pressed(2)); }
END_TEST

// A disk that is pressed between planes by penalties, whose stiffness goes by the length that contacts had when they
// were first made: they are longer when the run goes on.
static brunt_world *by_penalties(int workers) {
    brunt_world_def def = begin(1, 6);
    def_material(&def, "linear-elastic", density, 10e6, 0.3);
    brunt_body_def *b = def_ball(&def, "disk", XYZ(0, 0, 0), 1);
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.1;
    def_plane(&def, XYZ(0, -1.0001, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def_plane(&def, XYZ(0, 1.0001, 0), XYZ(0, -1, 0), BRUNT_SEPARATE, 0)->velocity[1] = -0.1;
    def.contact.method = BRUNT_CONTACT_PENALTY;
    def.threads = workers;
    return world_take(&def);
}

START_TEST(restart_by_penalties) {
    brunt_world *world = by_penalties(1), *fresh = by_penalties(2);
    brunt_barrier_values first, later;
    world_steps(world, 1);
    ck_assert(brunt_world_barrier(world, &first) && first.seen);
    world_steps(world, 2);
    world_copy_state(world, fresh);
    ck_assert(brunt_world_barrier(fresh, &later) && later.seen);
    ck_assert_double_eq(later.width, first.width);
    world_steps(world, 2), world_steps(fresh, 2);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(fresh));
    brunt_world_destroy(world), brunt_world_destroy(fresh);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("static");
    ADD_LOOP(hangs, 8);
    ADD_LOOP(steps_alike, 1);
    ADD_LOOP(bends, 1);
    ADD_LOOP(reversed, 1);
    ADD_LOOP(no_load, 2);
    ADD_LOOP(drawn_and_turned, 4);
    ADD_LOOP(soft_on_stiff, 2);
    ADD_LOOP(buckles, 2);
    ADD_LOOP(free_block, 4);
    ADD_LOOP(lies_on_a_plane, 2);
    ADD_LOOP(light_beside_heavy, 6);
    ADD_LOOP(disk_between_plates, 1);
    ADD_LOOP(cut_back, 2);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    ADD_LOOP(restart_by_penalties, 1);
    return suite_main(suite);
}
#endif
