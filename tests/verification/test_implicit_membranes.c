// Implicit steps of membranes: order in time, hanging, what they carry, contact by barriers at half their thickness,
// momentum, energy, threads, restart.
#include <math.h>

#include "contact/barrier/barrier_function.h"
#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static brunt_group_def *def_group(brunt_world_def *def, const char *body, const char *group,
                                  brunt_group_action action) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    g->action = action;
    snprintf(g->body, sizeof g->body, "%s", body);
    snprintf(g->group, sizeof g->group, "%s", group);
    return g;
}

// The upper face of a box that ends at height z.
static brunt_body_def *def_membrane(brunt_world_def *def, const char *name, const double size[2], double z,
                                    double edge) {
    brunt_body_def *b = def_box(def, name, XYZ(0, 0, z - edge), XYZ(size[0], size[1], z));
    b->method = BRUNT_MEMBRANE, b->element = BRUNT_MEMBRANE_QUAD4, b->size = edge;
    b->faces = brunt_def_alloc(sizeof *b->faces), b->face_count = 1;
    snprintf(b->faces[0], sizeof b->faces[0], "zmax");
    return b;
}

// ------------------------------------------------------------------------------------------ in its plane

// A strip of length 1 that starts with v = v0 cos(pi x) swings as a bar of Young's modulus E = 1 does (nu = 0):
// displacements v0 / pi cos(pi x) sin(pi t). It lies aslant in space.
static double strip_after(brunt_integrator integrator, int steps) {
    const double size = 1.0 / 256, v0 = 1e-6, time = 1.25;
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "st-venant-kirchhoff", 1, 1, 0);
    brunt_body_def *b = def_membrane(&def, "strip", (const double[2]){1, size}, 0, size);
    b->thickness = 0.1;
    b->wave_velocity[0] = v0, b->wave_vector[0] = PI, b->wave_phase = PI / 2;
    go_implicit(&def, integrator, time / steps);
    def.newton.tolerance = 1e-12;
    brunt_world *world = world_take(&def);
    world_until(world, time);
    double *x = world_field(world, 0, "position"), *u = world_field(world, 0, "displacement"), worst = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double exact = v0 / PI * cos(PI * (x[3 * n] - u[3 * n])) * sin(PI * time);
        worst = fmax(worst, fabs(u[3 * n] - exact));
    }
    free(x), free(u);
    brunt_world_destroy(world);
    return worst / (v0 / PI);
}

START_TEST(order_in_time) {
    const brunt_integrator integrator = _i ? BRUNT_NEWMARK : BRUNT_EULER;
    const double coarse = strip_after(integrator, _i ? 20 : 80), fine = strip_after(integrator, _i ? 40 : 160),
                 order = log2(coarse / fine);
    printf("  %s: error %.3e, %.3e, order in time %.3f\n", _i ? "newmark" : "euler", coarse, fine, order);
    ck_assert_double_eq_tol(order, (_i ? 2 : 1), 0.05);
    ck_assert_double_lt(fine, 0.05);
}
END_TEST

// A strip hangs from its end and comes to rest in steps of many periods: the other end sinks by rho g L^2 / (2 E), the
// support carries its weight.
START_TEST(hangs) {
    brunt_world_def def = def_begin(3, 1);
    const double g = 1e-5, size = 0.125, thickness = 0.02;
    def_material(&def, "linear-elastic", 1, 1, 0.3);
    brunt_body_def *b = def_membrane(&def, "strip", (const double[2]){1, size}, 0, size);
    b->thickness = thickness;
    brunt_group_def *top = def_group(&def, "strip", "xmin", BRUNT_GROUP_VELOCITY);
    top->component[1] = false;
    def.gravity[0] = g;
    go_implicit(&def, BRUNT_EULER, 1000);
    def.newton.tolerance = 1e-13;
    brunt_world *world = world_take(&def);
    world_steps(world, 20);
    double *u = world_field(world, 0, "displacement"), lowest = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) lowest = fmax(lowest, u[3 * n]);
    const double weight = g * size * thickness;
    printf("  sinks %.9g of %.9g m, force %.9g of %.9g N\n", lowest, g / 2, world_boundary(world, 0).force[0], -weight);
    ck_assert_double_eq_tol(lowest, g / 2, 1e-8 * g / 2);
    ck_assert_double_eq_tol(world_boundary(world, 0).force[0], -weight, 1e-6 * weight);
    free(u);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ contact

static void heights(brunt_world *world, int body, double *low, double *high) {
    double *x = world_field(world, body, "position");
    *low = INFINITY, *high = -INFINITY;
    for (int64_t n = 0; n < brunt_body_nodes(world, body); n++)
        *low = fmin(*low, x[3 * n + 2]), *high = fmax(*high, x[3 * n + 2]);
    free(x);
}

// A sheet lies on the ground, by half its thickness above the gap whose barrier carries its weight: -b'(gap) = rho g t.
// Or two lie one on the other: their middle surfaces are apart by half of both thicknesses and a gap within reach of
// the barrier (how uneven it is depends on where edges cross), and forces are the weights of what is above.
START_TEST(stack) {
    brunt_world_def def = def_begin(3, 1);
    const double thickness[2] = {0.02, 0.05}, distance = 4e-3, stiffness = 1e4, g = 10, rho = 1000;
    def_material(&def, "neo-hookean", rho, 1e6, 0.3);
    for (int k = 0; k <= _i; k++) {
        const double z = k ? thickness[0] + 2 * distance + 0.5 * thickness[1] : 0.5 * thickness[0] + 0.5 * distance;
        brunt_body_def *b = def_membrane(&def, k ? "upper" : "lower", (const double[2]){1, 0.5}, z, 0.25);
        b->thickness = thickness[k];
        b->element = BRUNT_MEMBRANE_TRI3; // nodes have the same share of mass and of surface
    }
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0.5);
    def.gravity[2] = -g;
    go_implicit(&def, BRUNT_EULER, 0.02);
    def.contact.method = BRUNT_CONTACT_BARRIER;
    def.contact.distance = distance, def.contact.stiffness = stiffness;
    def.contact.friction = 0.5; // sheets of one outline slide off each other without
    def.newton.tolerance = 1e-9;
    brunt_world *world = world_take(&def);
    world_steps(world, 150);
    double low[2], high[2];
    for (int k = 0; k <= _i; k++) heights(world, k, &low[k], &high[k]);
    const double gap = low[0] - 0.5 * thickness[0], weight = rho * g * (thickness[0] + _i * thickness[1]);
    const double carried = -brunt_barrier_at(gap, distance, stiffness).db, force = world_boundary(world, 0).force[2];
    printf("  gap %.6g m carries %.6g of %.6g Pa; force %.6g N\n", gap, carried, weight, force);
    ck_assert_double_eq_tol(force, 0.5 * weight, 1e-6 * weight);
    if (!_i) ck_assert_double_eq_tol(carried, weight, 1e-6 * weight);
    if (!_i) ck_assert_double_le(high[0] - low[0], 1e-9);
    if (_i) {
        const double pair = fabs(world_pair(world, 0).force[2]), half = 0.5 * (thickness[0] + thickness[1]);
        printf("  layers %.6g to %.6g m apart, %.6g thick; force %.6g N\n", low[1] - high[0], high[1] - low[0], half,
               pair);
        ck_assert_double_gt(low[1] - high[0], half);
        ck_assert_double_lt(high[1] - low[0], half + 1.2 * distance);
        ck_assert_double_eq_tol(pair, 0.5 * rho * g * thickness[1], 1e-6 * weight);
    }
    brunt_world_destroy(world);
}
END_TEST

// A block, or a body of material points, strikes a free sheet.
static brunt_world *struck(int threads, bool points, brunt_integrator integrator) {
    brunt_world_def def = def_begin(3, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = def_membrane(&def, "sheet", (const double[2]){1, 1}, 0, 0.125);
    b->thickness = 0.02;
    b = def_box(&def, "block", XYZ(0.31, 0.27, 0.02), XYZ(0.72, 0.63, 0.31));
    def_velocity(b, 0.5, 0, -2);
    if (!points) b->method = BRUNT_FEM, b->element = BRUNT_TET4, b->size = 0.15;
    go_implicit(&def, integrator, 1e-3);
    def.contact.method = BRUNT_CONTACT_BARRIER;
    def.contact.friction = 0.3;
    def.newton.solver = BRUNT_SOLVER_DIRECT;
    def.threads = threads;
    return world_take(&def);
}

// Its momentum goes on in both, no surface comes nearer than half the thickness, energy is accounted for.
START_TEST(strikes) {
    brunt_world *world = struck(1, _i == 1, _i == 2 ? BRUNT_NEWMARK : BRUNT_EULER);
    for (int k = 0; k < 8; k++) world_steps(world, 5);
    const brunt_momentum p = world_momentum(world);
    const brunt_energy e = world_energy(world);
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    printf("  %d: drift %.1e, %.1e; energy error %.1e; gap %.3g m; sheet at %.3g m/s; %g iterations\n", _i,
           p.linear_drift, p.angular_drift, e.error_relative, counts.least_gap, world_sums(world, 1).velocity[2],
           counts.iterations);
    ck_assert_double_le(p.linear_drift, 1e-10);
    ck_assert_double_le(p.angular_drift, 2e-3); // which neither integrator keeps, but for the length of its steps
    ck_assert_double_le(fabs(e.error_relative), 1e-10);
    ck_assert_double_gt(counts.least_gap, 0);
    ck_assert_double_lt(world_sums(world, 1).velocity[2], -0.2);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(threads) {
    brunt_world *world[] = {struck(1, true, BRUNT_EULER), struck(2, true, BRUNT_EULER), struck(3, true, BRUNT_EULER)};
    check_threads(world, 3, 12);
}
END_TEST

START_TEST(restart) { check_restart(struck(1, false, BRUNT_NEWMARK), struck(2, false, BRUNT_NEWMARK)); }
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_membranes");
    ADD_LOOP(order_in_time, 2);
    ADD_LOOP(hangs, 1);
    ADD_LOOP(stack, 2);
    ADD_LOOP(strikes, 3);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    return suite_main(suite);
}
#endif
