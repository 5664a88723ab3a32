// Implicit steps of viscous fluids: a shear wave decays as in closed form, of both integrators to their order; a film
// between plates flows as Couette and Poiseuille say; what viscosity takes is in the ledger; as in explicit steps.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double VISCOSITY = 2; // [Pa s], and [m^2/s] at a density of 1

// Of these the last has no potential: its viscosity acts by differences.
static const char *const equations[] = {"tait", "polynomial", "mie-gruneisen"};
enum { EQUATIONS = sizeof equations / sizeof *equations };

static void fluid(brunt_world_def *def, const char *eos, double c0) {
    brunt_error error;
    brunt_material_def *m = &def->materials[def->material_count++];
    *m = brunt_material_def_default("fluid", "newtonian");
    ck_assert_int_eq(brunt_material_set(m, "eos", 0, eos, &error), BRUNT_OK);
    brunt_material_set(m, "density", 1, NULL, &error);
    brunt_material_set(m, "dynamic_viscosity", VISCOSITY, NULL, &error);
    if (!strcmp(eos, "polynomial"))
        brunt_material_set(m, "eos.C1", c0 * c0, NULL, &error);
    else
        brunt_material_set(m, "eos.c0", c0, NULL, &error);
    if (!strcmp(eos, "mie-gruneisen"))
        brunt_material_set(m, "eos.s", 1, NULL, &error), brunt_material_set(m, "eos.gamma0", 0, NULL, &error);
}

static brunt_group_def *hold(brunt_world_def *def, const char *group, int axis, double velocity) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "film");
    snprintf(g->group, sizeof g->group, "%s", group);
    for (int a = 0; a < 3; a++) g->component[a] = a == axis;
    g->value[axis] = velocity;
    return g;
}

enum { CELLS = 16 };

// One column of elements, 1 m high, whose nodes move along x alone: what there is of fields changes along y.
static brunt_world_def column(const char *eos, brunt_integrator integrator, double step) {
    brunt_world_def def = def_begin(2, 1);
    fluid(&def, eos, 100);
    brunt_body_def *b = def_box(&def, "film", XYZ(0, 0, 0), XYZ(1.0 / CELLS, 1, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 1.0 / CELLS;
    hold(&def, "surface", 1, 0);
    go_implicit(&def, integrator, step);
    def.newton.tolerance = 1e-14;
    return def;
}

// ------------------------------------------------------------------------------------------ a wave that decays

// v = v0 cos(pi y) between sides that nothing holds decays by exp(-r t), of linear elements with lumped masses
// r = nu 4 / h^2 sin^2(pi h / 2); in n steps, with k = r dt, by (1 + k)^-n of backward Euler and by
// ((1 - k/2) / (1 + k/2))^n of Newmark, which takes the stress of the mean rate.
static double decay(const char *eos, brunt_integrator integrator, int steps) {
    const double v0 = 1e-5, rate = VISCOSITY * pow(2 * CELLS * sin(PI / CELLS / 2), 2), time = 1 / rate,
                 k = rate * time / steps;
    brunt_world_def def = column(eos, integrator, time / steps);
    brunt_body_def *b = &def.bodies[0];
    b->wave_velocity[0] = v0, b->wave_vector[1] = PI, b->wave_phase = PI / 2;
    brunt_world *world = world_take(&def);
    const double before = world_energy(world).initial;
    world_steps(world, steps);
    const brunt_energy e = world_energy(world);
    const double left = sqrt(e.kinetic / before),
                 closed = pow(integrator == BRUNT_NEWMARK ? (1 - k / 2) / (1 + k / 2) : 1 / (1 + k), steps);
    printf(
        "  %s, %s, %d steps: %.9f is left, %.9f in closed form; of the energy %.6f to viscosity, %.2e to the scheme\n",
        eos, integrator == BRUNT_NEWMARK ? "newmark" : "euler", steps, left, closed, e.viscosity / before,
        e.scheme / before);
    ck_assert_double_eq_tol(left, closed, 1e-8);
    ck_assert_double_le(fabs(e.error_relative), 1e-8);
    const double scheme = integrator == BRUNT_NEWMARK ? 0 : k * k / 2 * (1 - left * left) / (k + k * k / 2);
    ck_assert_double_eq_tol(e.scheme / before, scheme, 1e-7);
    ck_assert_double_eq_tol(e.viscosity / before, 1 - left * left - scheme, 1e-7);
    brunt_world_destroy(world);
    return fabs(left - exp(-1));
}

START_TEST(shear_wave) {
    const brunt_integrator integrator = _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    const char *eos = equations[_i / 2];
    const double order = log2(decay(eos, integrator, 20) / decay(eos, integrator, 40));
    printf("  order in time %.3f\n", order);
    ck_assert_double_eq_tol(order, integrator == BRUNT_NEWMARK ? 2 : 1, 0.05);
}
END_TEST

// ------------------------------------------------------------------------------------------ between plates

// Long after the start: below a plate that moves along x by V = v y (Couette), with gravity g along x by
// g y (1 - y) / 2 nu (Poiseuille), which linear elements have exactly at their nodes; forces on plates are mu V and
// half the weight each.
START_TEST(between_plates) {
    const brunt_integrator integrator = _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    const double speed = 1e-4, g = _i / 2 ? 1e-3 : 0, plate = _i / 2 ? 0 : speed, width = 1.0 / CELLS;
    brunt_world_def def = column("tait", integrator, 0.005);
    hold(&def, "ymin", 0, 0), hold(&def, "ymax", 0, plate);
    def.gravity[0] = g;
    brunt_world *world = world_take(&def);
    world_steps(world, 400);
    double *x = world_field(world, 0, "position"), *v = world_field(world, 0, "velocity"), worst = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double y = x[3 * n + 1], exact = plate * y + g / (2 * VISCOSITY) * y * (1 - y);
        worst = fmax(worst, fabs(v[3 * n] - exact));
    }
    const double force = world_boundary(world, 1).force[0], exact = (g / 2 - VISCOSITY * plate) * width;
    printf("  velocities off by %.1e, force of the plate below %.9g N, exactly %.9g\n", worst, force, exact);
    ck_assert_double_le(worst, 1e-5 * speed);
    ck_assert_double_le(fabs(fabs(force) - fabs(exact)), 1e-5 * fabs(exact) + 0.5 * g * width * width);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-8);
    free(x), free(v);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ beside explicit steps

// A block that slides on a floor that holds it: what is left of its speed.
static double slide(int dim, bool mesh, const char *eos, int scheme, brunt_energy *e) {
    brunt_world_def def = def_begin(dim, 0.25);
    fluid(&def, eos, 40);
    brunt_body_def *b = def_box(&def, "film", XYZ(0, 0, 0), XYZ(1, dim == 2 ? 1 : 0.5, 1));
    if (mesh) b->method = BRUNT_FEM, b->element = dim == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, b->size = 0.25;
    def_velocity(b, 1, 0, 0);
    def_plane(&def, XYZ(0, 0, 0), dim == 2 ? XYZ(0, 1, 0) : XYZ(0, 0, 1), BRUNT_STICK, 0);
    if (scheme) go_implicit(&def, scheme == 2 ? BRUNT_NEWMARK : BRUNT_EULER, 2.5e-3);
    brunt_world *world = world_take(&def);
    world_until(world, 0.04);
    const double speed = world_sums(world, 0).velocity[0];
    *e = world_energy(world);
    brunt_world_destroy(world);
    return speed;
}

START_TEST(as_explicit) {
    const int dim = _i % 2 + 2;
    const bool mesh = _i / 2 % 2;
    const char *eos = equations[_i / 4];
    brunt_energy e[3];
    double speed[3];
    for (int scheme = 0; scheme < 3; scheme++) speed[scheme] = slide(dim, mesh, eos, scheme, &e[scheme]);
    printf("  %s of %s, %dD: speed %.5f, euler %.5f, newmark %.5f; viscosity %.4f %.4f %.4f\n",
           mesh ? "mesh" : "points", eos, dim, speed[0], speed[1], speed[2], e[0].viscosity, e[1].viscosity,
           e[2].viscosity);
    for (int scheme = 1; scheme < 3; scheme++) {
        ck_assert_double_eq_tol(speed[scheme], speed[0], 0.02 * speed[0]);
        ck_assert_double_le(fabs(e[scheme].error_relative), 1e-7);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ a turn is no flow

// A block whose surface is turned by 70 degrees a step, three times: what is inside follows, there is no rate of shear,
// no stress of it and nothing that it takes.
START_TEST(turned) {
    const int dim = _i % 2 + 2;
    const brunt_integrator integrator = _i / 2 % 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    const char *eos = equations[_i / 4];
    brunt_world_def def = def_begin(dim, 1);
    fluid(&def, eos, 100);
    brunt_body_def *b = def_box(&def, "film", XYZ(0, 0, 0), XYZ(1, 1, 1));
    b->method = BRUNT_FEM, b->element = dim == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, b->size = 0.5;
    brunt_group_def *turn = hold(&def, "surface", 0, 0);
    turn->action = BRUNT_GROUP_ROTATION, turn->component[1] = turn->component[2] = true;
    turn->rotation = (brunt_rotation_def){.angle = 210 * PI / 180, .axis = {0, 0, 1}, .about = {0.5, 0.5, 0}};
    turn->table.points = brunt_alloc(2 * sizeof *turn->table.points), turn->table.count = 2;
    memcpy(turn->table.points, (const double[2][2]){{0, 0}, {0.3, 1}}, 2 * sizeof *turn->table.points);
    go_implicit(&def, integrator, 0.1);
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    double *stress = world_field(world, 0, "stress"), most = 0;
    for (int64_t k = 0; k < 6 * brunt_body_elements(world, 0); k++) most = fmax(most, fabs(stress[k]));
    const brunt_energy e = world_energy(world);
    printf("  %dD, %s, %s: stress up to %.1e Pa, viscosity took %.1e J\n", dim,
           integrator == BRUNT_NEWMARK ? "newmark" : "euler", eos, most, e.viscosity);
    ck_assert_double_le(most, 1e-9); // of 1e4 Pa of the fluid's bulk, and of 40 Pa that the turn would be as a shear
    ck_assert_double_le(fabs(e.viscosity), 1e-12);
    free(stress);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *sheared(int threads) {
    brunt_world_def def = column("tait", BRUNT_NEWMARK, 0.01);
    def.threads = threads;
    def.bodies[0].wave_velocity[0] = 0.1, def.bodies[0].wave_vector[1] = PI;
    return world_take(&def);
}

START_TEST(threads_and_restart) {
    brunt_world *world[2] = {sheared(1), sheared(2)};
    check_threads(world, 2, 4);
    check_restart(sheared(1), sheared(2));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_fluids");
    ADD_LOOP(shear_wave, 2 * EQUATIONS);
    ADD_LOOP(between_plates, 4);
    ADD_LOOP(as_explicit, 4 * EQUATIONS);
    ADD_LOOP(turned, 4 * EQUATIONS);
    ADD_LOOP(threads_and_restart, 1);
    return suite_main(suite);
}
#endif
