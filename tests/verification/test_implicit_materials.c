// Implicit steps of materials that have no potential: a slow press comes to what explicit steps come to, to first order
// in the step; Newton's method converges as its square; threads and restart.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/triangle_mesh.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

typedef struct pressed {
    const char *name, *strength, *eos;
    const char *key[10];
    double value[10];
    double iterations; // of Newton's method a step, at most
} pressed;

// Without dilatancy and hardening shear bands form somewhere or other: there is nothing to compare.
static const pressed materials[] = {
    {"soil",
     "drucker-prager",
     "",
     {"cohesion", "friction_angle", "dilatancy_angle", "hardening"},
     {1, 0.5, 0.1, 10},
     8},
    {"dense soil",
     "drucker-prager",
     "",
     {"cohesion", "friction_angle", "dilatancy_angle", "hardening"},
     {1, 0.5, 0.3, 2},
     8},
    {"rock", "mohr-coulomb", "", {"cohesion", "friction_angle", "dilatancy_angle", "hardening"}, {1, 0.5, 0.1, 10}, 8},
    {"dense rock",
     "mohr-coulomb",
     "",
     {"cohesion", "friction_angle", "dilatancy_angle", "hardening"},
     {1, 0.5, 0.3, 2},
     8},
    {"metal",
     "johnson-cook",
     "",
     {"A", "B", "n", "C", "rate0", "melt", "m", "heat_capacity"},
     {1, 3, 0.5, 0.05, 1e-5, 1000, 1, 1000},
     8},
    {"hot metal",
     "johnson-cook",
     "mie-gruneisen",
     {"A", "B", "n", "eos.c0", "eos.s", "eos.gamma0", "melt", "m", "heat_capacity"},
     {1, 3, 0.5, 9, 1.5, 2, 1000, 1, 1000},
     8},
};
enum { MATERIALS = sizeof materials / sizeof *materials };

static brunt_group_def *add_group(brunt_world_def *def, const char *group, int axis, double velocity) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "block");
    snprintf(g->group, sizeof g->group, "%s", group);
    for (int a = 0; a < 3; a++) g->component[a] = a == axis;
    g->value[axis] = velocity;
    return g;
}

// A block 1 m wide and high, pressed by 10 % in plane strain over TIME, on a floor that holds it in part, so that
// strains differ from place to place.
static const double TIME = 200;
static brunt_world_def press(const pressed *from) {
    brunt_error error;
    brunt_world_def def = def_begin(2, 0.25);
    brunt_material_def *m = &def.materials[def.material_count++];
    *m = brunt_material_def_default("it", from->strength);
    if (from->eos[0]) ck_assert_int_eq(brunt_material_set(m, "eos", 0, from->eos, &error), BRUNT_OK);
    brunt_material_set(m, "density", 1, NULL, &error);
    brunt_material_set(m, "E", 100, NULL, &error), brunt_material_set(m, "nu", 0.25, NULL, &error);
    for (int k = 0; k < 10 && from->key[k]; k++)
        ck_assert_msg(!brunt_material_set(m, from->key[k], from->value[k], NULL, &error), "%s", error.message);
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.25;
    brunt_group_def *floor = add_group(&def, "ymin", 1, 0);
    floor->component[0] = true;
    add_group(&def, "ymax", 1, -0.1 / TIME);
    return def;
}

static brunt_energy press_implicit(const pressed *from, brunt_integrator integrator, int steps,
                                   brunt_newton_counts *counts) {
    brunt_world_def def = press(from);
    go_implicit(&def, integrator, TIME / steps);
    brunt_world *world = world_take(&def);
    world_until(world, TIME);
    ck_assert(brunt_world_newton(world, counts, NULL));
    const brunt_energy e = world_energy(world);
    brunt_world_destroy(world);
    return e;
}

START_TEST(slow_press) {
    const pressed *from = &materials[_i];
    brunt_world_def def = press(from);
    brunt_world *world = world_take(&def);
    world_until(world, TIME);
    const brunt_energy reference = world_energy(world);
    brunt_world_destroy(world);
    ck_assert_double_gt(reference.plastic, 0.3 * (reference.plastic + reference.internal));
    double error[2];
    brunt_newton_counts counts;
    for (int k = 0; k < 2; k++) {
        const brunt_energy e = press_implicit(from, BRUNT_EULER, k ? 80 : 40, &counts);
        error[k] = fabs(e.external_work - reference.external_work) / reference.external_work;
        ck_assert_double_eq_tol(e.total, e.initial + e.external_work, 1e-9 * e.external_work);
    }
    printf("%s: work off by %.2e, %.2e; %.1f iterations a step, at most %.0f\n", from->name, error[0], error[1],
           counts.iterations / counts.steps, counts.iterations_worst);
    // Backward Euler: the force of the end of a step over all of it.
    ck_assert_double_lt(error[1], 2.0 / 80);
    ck_assert_double_eq_tol(error[1] / error[0], 0.5, 0.2);
    ck_assert_double_le(counts.iterations, from->iterations * counts.steps);
    ck_assert_double_eq(counts.cuts, 0);
}
END_TEST

// Newmark's steps begin with the stress that the last one ended with, which is of its rate: at the rate of no step at
// all what carries more when it is fast would creep, and half of the work with it.
START_TEST(rates_last) {
    const pressed fast = {"fast metal",
                          "johnson-cook",
                          "",
                          {"A", "B", "n", "C", "rate0", "melt", "m", "heat_capacity"},
                          {1, 0, 1, 0.3, 1e-5, 1000, 1, 1000},
                          8};
    brunt_newton_counts counts;
    double plastic[2];
    for (int k = 0; k < 2; k++) {
        const brunt_energy e = press_implicit(&fast, k ? BRUNT_NEWMARK : BRUNT_EULER, k ? 80 : 640, &counts);
        plastic[k] = e.plastic;
        printf("fast metal: work %.6f, of it plastic %.6f, scheme %.2e\n", e.external_work, e.plastic, e.scheme);
        ck_assert_double_eq_tol(e.total, e.initial + e.external_work, 1e-9 * e.external_work);
        if (k) ck_assert_double_le(fabs(e.scheme), 2e-3 * e.external_work);
    }
    ck_assert_double_eq_tol(plastic[1], plastic[0], 5e-3 * plastic[0]);
}
END_TEST

// Points under their own weight, on a floor and along a wall that hold them, flow by a few per cent: the matrix of
// points is right where Newton's method takes few iterations.
START_TEST(points_settle) {
    const bool triangles = _i >= 4; // of cells, of a mesh
    const int dim = triangles ? 2 : _i % 2 + 2;
    const pressed *from = &materials[_i % 4 / 2 ? 3 : 1];
    brunt_world_def def = press(from);
    def.group_count = 0, def.dimension = dim, def.cell = 0.25;
    if (triangles)
        use_kernel(&def, BRUNT_GRID_CUT + _i % 2, triangle_mesh(-0.5, -0.5, 8, 8, 0.25)), def.transfer = BRUNT_FLIP;
    brunt_body_def *b = &def.bodies[0];
    b->method = BRUNT_MPM, b->size = 0, b->element = 0;
    b->shape.max[2] = 0.5;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    if (!triangles) def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    def.gravity[1] = -20;
    go_implicit(&def, BRUNT_EULER, 0.02);
    brunt_world *world = world_take(&def);
    world_steps(world, 10);
    brunt_newton_counts counts;
    ck_assert(brunt_world_newton(world, &counts, NULL));
    const brunt_energy e = world_energy(world);
    printf("points, %s %dD: dissipated %.3g of %.3g, %.1f iterations a step, at most %.0f\n", from->name, dim,
           e.plastic, e.external_work, counts.iterations / counts.steps, counts.iterations_worst);
    ck_assert_double_gt(e.plastic, 0.05 * e.external_work);
    ck_assert_double_eq_tol(e.total, e.initial + e.external_work, 1e-9 * e.external_work);
    ck_assert_double_le(counts.iterations, 8 * counts.steps);
    ck_assert_double_eq(counts.cuts, 0);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *pressed_world(int threads) {
    brunt_world_def def = press(&materials[3]);
    go_implicit(&def, BRUNT_NEWMARK, TIME / 40);
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads_and_restart) {
    brunt_world *world[2] = {pressed_world(1), pressed_world(2)};
    check_threads(world, 2, 8);
    check_restart(pressed_world(1), pressed_world(2));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_materials");
    ADD_LOOP(slow_press, MATERIALS);
    ADD_LOOP(rates_last, 1);
    ADD_LOOP(points_settle, 8);
    ADD_LOOP(threads_and_restart, 1);
    return suite_main(suite);
}
#endif
