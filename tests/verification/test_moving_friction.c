// Friction of planes and lines that move and press: a belt that takes a block along, a belt that starts and stops by a
// table, a plane that pushes a block up a slope. Of explicit and implicit steps the same closed forms, of a rigid
// block.
#include <math.h>

#include "base/array.h"
#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 4e6, G = 10;

// What a loop goes over: implicit, a line in place of a plane, to the left.
enum { CASES = 8 };
static bool implicit_of(int i) { return i & 1; }
static bool line_of(int i) { return i >> 1 & 1; }
static double side_of(int i) { return i >> 2 & 1 ? -1 : 1; }

static brunt_world_def begin(int i) {
    brunt_world_def def = def_begin(2, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, 0);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    if (implicit_of(i)) go_implicit(&def, BRUNT_EULER, 2e-3), def.newton.tolerance = 1e-9;
    def.gravity[1] = -G;
    return def;
}

static void report(int i, const char *what, double is, double wanted) {
    printf("  %s %s, side %+g: %s %.5f, %.5f wanted, %+.1e\n", implicit_of(i) ? "implicit" : "explicit",
           line_of(i) ? "line" : "plane", side_of(i), what, is, wanted, is / wanted - 1);
}

// What stands on y = 0, or beside x = 0: material that a plane pushes in implicit steps is pushed at the centres of its
// points, half a spacing within, and rests at some part of contact.distance, a tenth of a spacing.
static double within(int i) { return implicit_of(i) && !line_of(i) ? 0.25 * CELL - 0.045 * CELL : 0; }

// A floor that goes along x, or stands.
static void lay_floor(brunt_world_def *def, int i, double mu, double speed) {
    if (line_of(i)) {
        brunt_boundary_surface_def *s = def_line(def, -4, 0.02, 4, 0.02, BRUNT_SEPARATE);
        s->friction = mu, s->value[0] = speed;
    } else {
        def_plane(def, XYZ(0, 0.02 + within(i), 0), XYZ(0, 1, 0), BRUNT_SEPARATE, mu)->velocity[0] = speed;
    }
}

// A block is laid on a belt: it is taken along with mu g until it goes as the belt does. The belt does m V^2 of work,
// half of which rubs away.
START_TEST(belt) {
    const double mu = 0.3, V = 0.9 * side_of(_i);
    brunt_world_def def = begin(_i);
    def_box(&def, "block", XYZ(-0.3, 0.02, 0), XYZ(0.3, 0.42, 0));
    lay_floor(&def, _i, mu, V);
    brunt_world *world = world_take(&def);
    const double m = world_sums(world, 0).mass;
    world_until(world, 0.2);
    brunt_reaction f = world_boundary(world, 0);
    const double speed = world_sums(world, 0).velocity[0];
    report(_i, "slides at", speed, mu * G * 0.2 * side_of(_i));
    report(_i, "friction over pressure", side_of(_i) * f.impulse[0] / f.impulse[1], mu);
    ck_assert_double_le(fabs(speed / (mu * G * 0.2 * side_of(_i)) - 1), 2e-2);
    ck_assert_double_le(fabs(side_of(_i) * f.impulse[0] / f.impulse[1] / mu - 1), 5e-3);
    world_until(world, 0.6);
    f = world_boundary(world, 0);
    report(_i, "goes at", world_sums(world, 0).velocity[0], V);
    report(_i, "rubbed away", f.friction_work, 0.5 * m * V * V);
    report(_i, "impulse", f.impulse[0], m * V);
    ck_assert_double_le(fabs(world_sums(world, 0).velocity[0] / V - 1), 5e-3);
    ck_assert_double_le(fabs(f.friction_work / (0.5 * m * V * V) - 1), 2e-2);
    ck_assert_double_le(fabs(f.impulse[0] / (m * V) - 1), 5e-3);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// A belt that starts slowly enough takes the block along as it goes; it stops at once, and the block slides on over
// V^2 / (2 mu g).
START_TEST(stops) {
    static const double table[][2] = {{0, 0}, {0.5, 1}, {0.5001, 0}, {2, 0}};
    const int i = 2 + _i % 2 + _i / 2 * 4;
    const double mu = 0.4, V = 0.8 * side_of(i);
    brunt_world_def def = begin(i);
    def_box(&def, "block", XYZ(-0.3, 0.02, 0), XYZ(0.3, 0.42, 0));
    lay_floor(&def, i, mu, V);
    brunt_curve *curve = &def.surfaces[0].table;
    curve->points = brunt_alloc(sizeof table), curve->count = BRUNT_COUNT(table);
    memcpy(curve->points, table, sizeof table);
    brunt_world *world = world_take(&def);
    world_until(world, 0.5);
    const double at = world_sums(world, 0).centre[0];
    report(i, "has gone", at, 0.25 * V);
    world_until(world, 0.9);
    const double on = world_sums(world, 0).centre[0] - at;
    report(i, "slides on by", on, side_of(i) * V * V / (2 * mu * G));
    ck_assert_double_le(fabs(at / (0.25 * V) - 1), 5e-3);
    ck_assert_double_le(fabs(on / (side_of(i) * V * V / (2 * mu * G)) - 1), 3e-2);
    ck_assert_double_le(fabs(world_sums(world, 0).velocity[0]), 1e-2 * fabs(V));
    brunt_world_destroy(world);
}
END_TEST

// A plane pushes a block up a slope of 20 degrees at a speed that it has: by its weight's part along the slope and by
// friction, which is down it. Gravity is turned in place of the slope.
START_TEST(pushed) {
    const double mu = 0.3, V = 0.5 * side_of(_i), angle = PI / 9, wanted = sin(angle) + mu * cos(angle);
    brunt_world_def def = begin(_i);
    def_velocity(def_box(&def, "block", XYZ(-0.3, 0.02, 0), XYZ(0.3, 0.42, 0)), V, 0, 0);
    lay_floor(&def, _i, mu, 0);
    if (line_of(_i)) {
        const double at = -0.3 * side_of(_i), up = side_of(_i);
        def_line(&def, at, 0.5 + up, at, 0.5 - up, BRUNT_SEPARATE)->value[0] = V; // the block is to its left
    } else {
        def_plane(&def, XYZ(side_of(_i) * (within(_i) - 0.3), 0, 0), XYZ(side_of(_i), 0, 0), BRUNT_SEPARATE, 0)
            ->velocity[0] = V;
    }
    def.gravity[0] = -G * sin(angle) * side_of(_i), def.gravity[1] = -G * cos(angle);
    brunt_world *world = world_take(&def);
    const double weight = world_sums(world, 0).mass * G;
    world_until(world, 0.2);
    const brunt_reaction first = world_boundary(world, 1);
    world_until(world, 0.8);
    const brunt_reaction last = world_boundary(world, 1), floor = world_boundary(world, 0);
    report(_i, "pushed by", side_of(_i) * (last.impulse[0] - first.impulse[0]) / (0.6 * weight), wanted);
    report(_i, "friction over pressure", -side_of(_i) * floor.impulse[0] / floor.impulse[1], mu);
    report(_i, "goes at", world_sums(world, 0).velocity[0], V);
    ck_assert_double_le(fabs(side_of(_i) * (last.impulse[0] - first.impulse[0]) / (0.6 * weight * wanted) - 1), 2e-2);
    ck_assert_double_le(fabs(-side_of(_i) * floor.impulse[0] / floor.impulse[1] / mu - 1), 2e-2);
    ck_assert_double_le(fabs(world_sums(world, 0).velocity[0] / V - 1), 2e-2);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("moving_friction");
    ADD_LOOP(belt, CASES);
    ADD_LOOP(stops, 4);
    ADD_LOOP(pushed, CASES);
    return suite_main(suite);
}
#endif
