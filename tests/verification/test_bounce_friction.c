// Blocks thrown on planes and lines at a slant, and such that press from the start, in implicit steps by default: what
// rubs is mu times what presses, over all of a bounce.
#include <math.h>

#include "base/array.h"
#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 4e6;

typedef enum ground { PLANE, LINE, MESH_ON_PLANE, GROUNDS } ground;
static const char *const ground_names[] = {"plane", "line", "mesh on a plane"};

typedef struct throwing {
    ground on;
    double side, belt, mu, step; // belt: how fast the ground goes [m/s]
    double across, high;         // [m/s] beside it; [m] above it
} throwing;

static brunt_world_def thrown(const throwing *t) {
    brunt_world_def def = def_begin(2, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, 0);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    go_implicit(&def, BRUNT_EULER, t->step), def.newton.tolerance = 1e-9;
    brunt_body_def *b = def_box(&def, "block", XYZ(-0.3, t->high, 0), XYZ(0.3, t->high + 0.4, 0));
    if (t->on == MESH_ON_PLANE) b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = CELL;
    def_velocity(b, t->across * t->side + t->belt, t->high > 0 ? -1 : 0, 0);
    if (t->on == LINE) {
        brunt_boundary_surface_def *s = def_line(&def, -4, 0, 4, 0, BRUNT_SEPARATE);
        s->friction = t->mu, s->value[0] = t->belt;
    } else {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, t->mu)->velocity[0] = t->belt;
    }
    return def;
}

static throwing throwing_of(int i) {
    return (throwing){.on = (ground)(i % GROUNDS),
                      .side = i / GROUNDS % 2 ? -1 : 1,
                      .belt = i / GROUNDS / 2 % 2 ? 0.7 : 0,
                      .mu = 0.3,
                      .step = (const double[]){2e-3, 5e-4, 1e-2}[i / GROUNDS / 4],
                      .across = 2,
                      .high = 0.05};
}

START_TEST(rubs_as_it_presses) {
    const throwing t = throwing_of(_i);
    brunt_world_def def = thrown(&t);
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    const brunt_reaction f = world_boundary(world, 0);
    const double mass = world_sums(world, 0).mass;
    printf("  %s, side %+g, belt %g, step %g: impulse %.4f, friction over pressure %.4f\n", ground_names[t.on], t.side,
           t.belt, t.step, f.impulse[1] / mass, -t.side * f.impulse[0] / f.impulse[1]);
    ck_assert_double_gt(f.impulse[1], 0.95 * mass); // it has been stopped
    ck_assert_double_le(fabs(-t.side * f.impulse[0] / f.impulse[1] / t.mu - 1), 2e-3);
    brunt_world_destroy(world);
}
END_TEST

// With much friction it sticks: next to nothing of its way across is rubbed away, with less than friction could
// be.
START_TEST(sticks) {
    throwing t = throwing_of(_i);
    t.mu = 5, t.across = 0.1;
    brunt_world_def def = thrown(&t);
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    const brunt_reaction f = world_boundary(world, 0);
    const double mass = world_sums(world, 0).mass;
    printf("  %s, side %+g, belt %g: friction over pressure %.3f, rubbed away %.1e of what it had across\n",
           ground_names[t.on], t.side, t.belt, -t.side * f.impulse[0] / f.impulse[1],
           f.friction_work / (0.5 * mass * t.across * t.across));
    ck_assert_double_gt(-t.side * f.impulse[0], 0.02 * f.impulse[1]);
    ck_assert_double_lt(-t.side * f.impulse[0], 0.2 * f.impulse[1]);
    ck_assert_double_le(fabs(f.friction_work), 1e-2 * 0.5 * mass * t.across * t.across);
    brunt_world_destroy(world);
}
END_TEST

// Points that are given to a plane nearer than they rest are thrown off; friction went by what they pressed at the
// start once more than they did: 0.41 in place of 0.3 where they are nearest.
static brunt_world_def pressing(int i, double deep) {
    const throwing t = {
        .on = PLANE, .side = i % 2 ? -1 : 1, .belt = i / 2 % 2 ? 0.7 : 0, .mu = 0.3, .step = 2e-3, .across = 2};
    brunt_world_def def = thrown(&t);
    def.planes[0].point[1] = 0.25 * CELL - deep * CELL;
    def.gravity[1] = -10;
    return def;
}

START_TEST(pressed_at_the_start) {
    static const double deep[] = {0.045, 0.03, 0.02, 0.01};
    brunt_world_def def = pressing(_i, deep[_i / 4]);
    brunt_world *world = world_take(&def);
    world_until(world, 0.3);
    const brunt_reaction f = world_boundary(world, 0);
    const double side = _i % 2 ? -1 : 1;
    printf("  side %+g, %g cells from the plane: friction over pressure %.4f\n", side, deep[_i / 4],
           -side * f.impulse[0] / f.impulse[1]);
    ck_assert_double_le(fabs(-side * f.impulse[0] / f.impulse[1] / 0.3 - 1), 2e-2);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Which pressures friction goes by is of the state.
START_TEST(restarts) {
    const throwing t = throwing_of(0);
    brunt_world_def def = _i ? thrown(&t) : pressing(0, 0.03);
    brunt_world *world = world_from(&def), *fresh = world_take(&def);
    world_steps(world, 1 + 4 * _i);
    world_copy_state(world, fresh);
    for (int k = 0; k < 30; k++) {
        world_steps(world, 1), world_steps(fresh, 1);
        ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(fresh));
    }
    brunt_world_destroy(world), brunt_world_destroy(fresh);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("bounce_friction");
    ADD_LOOP(rubs_as_it_presses, 12 * GROUNDS);
    ADD_LOOP(sticks, 4 * GROUNDS);
    ADD_LOOP(pressed_at_the_start, 16);
    ADD_LOOP(restarts, 16);
    return suite_main(suite);
}
#endif
