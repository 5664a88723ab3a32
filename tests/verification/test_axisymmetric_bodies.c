//
// Axisymmetric elements in worlds: closed forms, loads, contact of rings.
#include "tests/support/def_world.h"

static brunt_world_def rings_begin(const char *model, double density, double E, double nu) {
    brunt_world_def def = def_begin(2, 1e-3);
    def.axisymmetric = true;
    def.cfl = 0.9;
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, model, density, E, nu);
    return def;
}

static brunt_body_def *of_elements(brunt_body_def *body, brunt_element_kind kind, double size) {
    body->method = BRUNT_FEM;
    body->element = kind;
    body->size = size;
    return body;
}

// The section of a ball or a shell about a point of the axis: what is right of it.
static brunt_body_def *cut_at_axis(brunt_body_def *body) {
    brunt_shape *children = brunt_def_alloc(2 * sizeof *children);
    children[0] = body->shape;
    children[1] = (brunt_shape){.kind = BRUNT_BOX, .min = {0, -1}, .max = {1, 1}};
    body->shape = (brunt_shape){.kind = BRUNT_INTERSECTION, .children = children, .child_count = 2};
    return body;
}

static brunt_body_def *half_ball(brunt_world_def *def, const char *name, const double center[3], double radius) {
    return cut_at_axis(def_ball(def, name, center, radius));
}

static brunt_group_def *add_group(brunt_world_def *def, const char *body, const char *group,
                                  brunt_group_action action) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body);
    snprintf(g->group, sizeof g->group, "%s", group);
    g->action = action;
    return g;
}

static void hold_axially(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = add_group(def, body, group, BRUNT_GROUP_VELOCITY);
    g->component[0] = g->component[2] = false;
    g->component[1] = true;
}

// Greatest distance of radial displacements from a closed form, relative to its greatest value. Lame: a tube in plane
// strain with inner pressure p, u = (1 + nu)/E p a^2/(b^2 - a^2) ((1 - 2 nu) r + b^2/r) (Timoshenko and Goodier, Theory
// of Elasticity, art. 28).
static double lame_error(brunt_element_kind kind, int cells) {
    const double a = 0.01, b = 0.02, E = 1e9, nu = 0.3, p = 1e3, size = (b - a) / cells;
    brunt_world_def def = rings_begin("linear-elastic", 1000, E, nu);
    of_elements(def_box(&def, "tube", XYZ(a, 0, 0), XYZ(b, size, 0)), kind, size)->damping = 1.5e5;
    add_group(&def, "tube", "xmin", BRUNT_GROUP_PRESSURE)->value[0] = p;
    hold_axially(&def, "tube", "ymin");
    hold_axially(&def, "tube", "ymax");
    brunt_world *world = world_take(&def);
    world_until(world, 4e-4);
    double *x = world_field(world, 0, "position"), *u = world_field(world, 0, "displacement"), worst = 0;
    const double factor = (1 + nu) / E * p * a * a / (b * b - a * a), most = factor * ((1 - 2 * nu) * a + b * b / a);
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double r = x[3 * n] - u[3 * n];
        worst = fmax(worst, fabs(u[3 * n] - factor * ((1 - 2 * nu) * r + b * b / r)) / most);
    }
    free(x), free(u);
    brunt_world_destroy(world);
    return worst;
}

START_TEST(thick_tube_under_pressure) {
    if (sizeof(real) == 4) return; // displacements of 1e-6 of the radius
    const double coarse = lame_error(BRUNT_TRI3, 4), fine = lame_error(BRUNT_TRI3, 8),
                 finest = lame_error(BRUNT_TRI3, 16), exact = lame_error(BRUNT_QUAD4, 4);
    ck_assert_msg(coarse < 0.03 && log2(coarse / fine) > 1.7 && log2(fine / finest) > 1.7, "triangles: %g %g %g",
                  coarse, fine, finest);
    // Nodes of rectangles are where they ought to be, whatever their number, but for strains of 1e-6 not being small.
    ck_assert_double_lt(exact, 1e-5);
}
END_TEST

// Time between the first two turns of the mean radial motion of a body.
static double period_of(brunt_world *world, double guess) {
    double last = 0, turns[2] = {0}, before = 0;
    int seen = 0;
    brunt_error error = {0};
    while (seen < 2) {
        ck_assert_double_lt(brunt_world_time(world), 5 * guess);
        ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_OK);
        double *v = world_field(world, 0, "velocity"), *x = world_field(world, 0, "position"), mean = 0;
        for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++)
            mean += (v[3 * n] * x[3 * n] + v[3 * n + 1] * x[3 * n + 1]) / hypot(x[3 * n], x[3 * n + 1]);
        free(v), free(x);
        const double now = brunt_world_time(world);
        if (before * mean < 0) turns[seen++] = last + (now - last) * before / (before - mean);
        before = mean, last = now;
    }
    brunt_world_destroy(world);
    return 2 * (turns[1] - turns[0]);
}

// A thin ring: omega = sqrt(E / rho) / R (Love, Mathematical Theory of Elasticity, art. 293).
START_TEST(ring_breathes) {
    if (sizeof(real) == 4) return; // displacements of 1e-5 of the radius
    const double R = 0.1, w = 1e-3, E = 2e9, nu = 0.3, density = 1000, period = 2 * PI * R / sqrt(E / density);
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = rings_begin("neo-hookean", density, E, nu);
        brunt_body_def *body = def_box(&def, "ring", XYZ(R - w / 2, 0, 0), XYZ(R + w / 2, w, 0));
        of_elements(body, k ? BRUNT_TRI3 : BRUNT_QUAD4, w / 2);
        def_velocity(body, 0.1, 0, 0);
        const double found = period_of(world_take(&def), period);
        ck_assert_double_eq_tol(found, period, 1e-3 * period);
    }
}
END_TEST

// A thin spherical shell: omega = sqrt(2 E / (rho (1 - nu))) / R (Love, art. 335), set off by inner pressure; its
// section ends on the axis, where nothing may stand out.
START_TEST(shell_breathes) {
    if (sizeof(real) == 4) return; // likewise
    const double R = 0.1, h = 2e-3, E = 2e9, nu = 0.3, density = 1000, p = 1e3,
                 period = 2 * PI * R / sqrt(2 * E / (density * (1 - nu)));
    brunt_world_def def = rings_begin("neo-hookean", density, E, nu);
    brunt_body_def *body = of_elements(def_body(&def, "shell"), BRUNT_QUAD4, h / 1.5);
    body->shape.kind = BRUNT_TUBE;
    body->shape.inner_radius = R - h / 2, body->shape.radius = R + h / 2;
    cut_at_axis(body);
    add_group(&def, "shell", "inner", BRUNT_GROUP_PRESSURE)->value[0] = p;
    brunt_world *world = world_take(&def);
    const double mass = world_sums(world, 0).mass,
                 exact = density * 4 * PI / 3 * (pow(R + h / 2, 3) - pow(R - h / 2, 3));
    ck_assert_double_eq_tol(mass, exact, 1e-3 * exact);
    world_until(world, period / 2); // twice the static displacement p R^2 (1 - nu) / (2 E h), nearly everywhere
    const double twice = p * R * R * (1 - nu) / (E * h);
    double *x = world_field(world, 0, "position"), *u = world_field(world, 0, "displacement"), low = INFINITY, high = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
        const double out = (u[3 * n] * x[3 * n] + u[3 * n + 1] * x[3 * n + 1]) / hypot(x[3 * n], x[3 * n + 1]);
        low = fmin(low, out), high = fmax(high, out);
    }
    ck_assert_double_gt(low, 0.95 * twice);
    ck_assert_double_lt(high, 1.05 * twice);
    free(x), free(u);
    const brunt_energy e = world_energy(world);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A uniform pressure on a ball: its work is that of the volume it takes, and it makes no stress but -p.
START_TEST(ball_under_pressure) {
    // In float places 0.3 m from the origin are rounded by 2e-5 of an edge: strains by that, 2 % of p a node.
    const double R = 0.01, E = 1e9, nu = 0.25, p = 1e6, K = E / (3 * (1 - 2 * nu)),
                 rounding = sizeof(real) == 4 ? 0.1 : 1e-3;
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = rings_begin("neo-hookean", 1000, E, nu);
        of_elements(half_ball(&def, "ball", XYZ(0, 0.3, 0), R), k ? BRUNT_TRI3 : BRUNT_QUAD4, R / 6)->damping = 2e5;
        add_group(&def, "ball", "surface", BRUNT_GROUP_PRESSURE)->value[0] = p;
        brunt_world *world = world_take(&def);
        world_until(world, 5e-4);
        double *stress = world_field(world, 0, "stress");
        for (int64_t e = 0; e < brunt_body_elements(world, 0); e++)
            for (int c = 0; c < 6; c++) ck_assert_double_eq_tol(stress[6 * e + c], c < 3 ? -p : 0, rounding * p);
        free(stress);
        const brunt_body_sums sums = world_sums(world, 0);
        ck_assert_double_eq_tol(sums.high[1] - sums.low[1], 2 * R * (1 - p / (3 * K)),
                                2e-3 * R * p / K + (sizeof(real) == 4 ? 2e-7 : 0));
        ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
        brunt_world_destroy(world);
    }
}
END_TEST

// Traction on the end of a rod: the force is that on its circle, wherever the nodes are.
START_TEST(traction_acts_on_the_circle) {
    const double R = 0.01, L = 0.02;
    brunt_world_def def = rings_begin("neo-hookean", 1000, 1e9, 0.3);
    of_elements(def_box(&def, "rod", XYZ(0, 0, 0), XYZ(R, L, 0)), BRUNT_QUAD4, R / 5);
    brunt_group_def *g = add_group(&def, "rod", "ymax", BRUNT_GROUP_TRACTION);
    g->value[1] = 1e4;
    brunt_world *world = world_take(&def);
    world_steps(world, 50);
    const double force = PI * R * R * 1e4, time = brunt_world_time(world) - 0.5 * brunt_world_dt(world);
    ck_assert_double_eq_tol(world_sums(world, 0).momentum[1], force * time, 1e-6 * force * time);
    ck_assert_double_eq_tol(world_boundary(world, 0).force[1], force, 1e-6 * force);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// B05. A rod without lateral contraction hits a wall: the time in contact is 2 L / c, the force rho c v A, and it
// leaves as it came.
START_TEST(rod_on_a_wall) {
    const double R = 0.01, L = 0.1, E = 1e9, density = 1000, c = sqrt(E / density), v = 1;
    brunt_world_def def = rings_begin("neo-hookean", density, E, 0);
    def_velocity(of_elements(def_box(&def, "rod", XYZ(0, 0, 0), XYZ(R, L, 0)), BRUNT_QUAD4, R / 5), 0, -v, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    const double A = PI * R * R;
    world_until(world, L / c);
    ck_assert_double_eq_tol(world_boundary(world, 0).impulse[1], density * c * v * A * L / c,
                            0.01 * density * v * A * L);
    ck_assert_double_eq_tol(world_boundary(world, 0).area, A, 1e-6 * A);
    world_until(world, 2.2 * L / c);
    ck_assert_double_eq(world_boundary(world, 0).force[1], 0);
    ck_assert_double_eq_tol(world_sums(world, 0).momentum[1], density * A * L * v, 0.03 * density * A * L * v);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 0.01);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *rod_on_plate(int threads, int nose) {
    brunt_world_def def = rings_begin("neo-hookean", 1000, 1e8, 0.3);
    const double R = 0.01;
    def.threads = threads;
    def.contact.friction = 0.2;
    brunt_body_def *rod = nose ? half_ball(&def, "rod", XYZ(0, 1.001 * R, 0), R)
                               : def_box(&def, "rod", XYZ(0, 0.001 * R, 0), XYZ(R, 3 * R, 0));
    def_velocity(of_elements(rod, nose == 2 ? BRUNT_TRI3 : BRUNT_QUAD4, R / 8), 0, -10, 0);
    of_elements(def_box(&def, "plate", XYZ(0, -R, 0), XYZ(4 * R, 0, 0)), BRUNT_QUAD4, R / 5);
    return world_take(&def);
}

// Rods with flat and round noses on a plate, with friction: axial momentum exact, the energy closed, the axis kept.
START_TEST(rod_on_a_plate) {
    for (int nose = 0; nose < 3; nose++) {
        brunt_world *world = rod_on_plate(1, nose);
        const double before = world_sums(world, 1).momentum[1];
        world_steps(world, 800);
        const brunt_momentum m = world_momentum(world);
        const brunt_energy e = world_energy(world);
        if (getenv("RING_PRINT"))
            printf(
                "nose %d: t %g rod %g of %g plate %g; drift %g energy %g contact %g friction %g hourglass %g area %g\n",
                nose, brunt_world_time(world), world_sums(world, 1).momentum[1], before,
                world_sums(world, 0).momentum[1], m.linear_drift, e.error_relative, e.contact / e.initial,
                e.friction / e.initial, e.hourglass / e.initial, world_pair(world, 0).area);
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        ck_assert_double_lt(fabs(e.error_relative), 0.01);
        ck_assert_double_ge(e.contact, -1e-3 * e.initial);
        ck_assert_double_ge(e.friction, 0);
        ck_assert_double_gt(fabs(world_sums(world, 0).momentum[1]), 0.2 * fabs(before));
        ck_assert_double_eq_tol(world_pair(world, 0).impulse[1] + world_sums(world, 0).momentum[1], 0,
                                2 * fabs(world_pair(world, 0).impulse[1] + world_sums(world, 1).momentum[1] - before) +
                                    1e-2 * fabs(before));
        for (int b = 0; b < 2; b++) {
            double *u = world_field(world, b, "displacement"), *x = world_field(world, b, "position");
            for (int64_t n = 0; n < brunt_body_nodes(world, b); n++) {
                ck_assert_double_ge(x[3 * n], 0);
                if (x[3 * n] == u[3 * n]) ck_assert_double_eq(u[3 * n], 0);
            }
            free(u), free(x);
        }
        brunt_world_destroy(world);
    }
}
END_TEST

// Elements and material points as rings: a rod of points on a plate of elements, and a ball of elements on a plate of
// points.
START_TEST(elements_meet_material_points) {
    for (int swap = 0; swap < 2; swap++) {
        const double R = 0.01, h = 1e-3;
        brunt_world_def def = rings_begin("neo-hookean", 1000, 1e8, 0.3);
        def.cfl = 0.5;
        def.contact.friction = 0.1;
        brunt_body_def *rod = swap ? half_ball(&def, "rod", XYZ(0, 1.02 * R, 0), R)
                                   : def_box(&def, "rod", XYZ(0, 0.02 * R, 0), XYZ(R, 2 * R, 0));
        def_velocity(rod, 0, -10, 0);
        brunt_body_def *plate = def_box(&def, "plate", XYZ(0, -R, 0), XYZ(4 * R, 0, 0));
        of_elements(swap ? rod : plate, BRUNT_QUAD4, h);
        brunt_world *world = world_take(&def);
        const double before = world_sums(world, 1).momentum[1];
        world_until(world, 3e-4);
        const brunt_energy e = world_energy(world);
        ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
        ck_assert_double_lt(fabs(e.error_relative), 1e-3);
        ck_assert_double_ge(e.contact, 0);
        ck_assert_double_lt(world_sums(world, 0).momentum[1], 0.2 * before);
        brunt_world_destroy(world);
    }
}
END_TEST

// Plastic bodies that erode and keep their nodes: rings that close on the axis open again, nothing is lost.
START_TEST(debris_passes_the_axis) {
    brunt_error error = {0};
    brunt_world_def def = rings_begin("von-mises", 8930, 0, 0);
    static const char *const keys[] = {"density", "E", "nu", "yield"};
    static const double values[] = {8930, 117e9, 0.35, 157e6};
    def.materials[0] = brunt_material_def_default("copper", "von-mises");
    for (int k = 0; k < 4; k++) brunt_material_set(&def.materials[0], keys[k], values[k], NULL, &error);
    brunt_body_def *plate = def_box(&def, "plate", XYZ(0, -0.006, 0), XYZ(0.04, 0, 0));
    brunt_body_def *ball = half_ball(&def, "ball", XYZ(0, 0.0101, 0), 0.01);
    of_elements(plate, BRUNT_TRI3, 1e-3)->erosion = (brunt_erosion_def){.strain = 0.8, .inverted = true, .keep = true};
    of_elements(ball, BRUNT_TRI3, 1e-3)->erosion = plate->erosion;
    def_velocity(ball, 0, -800, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 50e-6);
    brunt_eroded gone;
    brunt_body_eroded(world, 1, &gone);
    ck_assert_int_gt(gone.elements, 20);
    for (int b = 0; b < 2; b++) ck_assert_double_ge(world_sums(world, b).low[0], 0);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 0.02);
    brunt_world_destroy(world);
}
END_TEST

// An expanding ring hits one around it: radially there is no momentum to keep, but energy is.
START_TEST(ring_in_a_ring) {
    const double R = 0.05, w = 2e-3;
    brunt_world_def def = rings_begin("neo-hookean", 1000, 1e8, 0.3);
    def_velocity(of_elements(def_box(&def, "inner", XYZ(R, 0, 0), XYZ(R + w, 2 * w, 0)), BRUNT_QUAD4, w / 4), 5, 0, 0);
    of_elements(def_box(&def, "outer", XYZ(R + 1.01 * w, -w, 0), XYZ(R + 2 * w, 3 * w, 0)), BRUNT_QUAD4, w / 4);
    brunt_world *world = world_take(&def);
    world_steps(world, 1500);
    const brunt_energy e = world_energy(world);
    ck_assert_double_gt(world_sums(world, 1).kinetic, 0.1 * e.initial);
    ck_assert_double_lt(fabs(e.error_relative), 0.01);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(threads_and_restart_change_no_bit) {
    brunt_error error = {0};
    brunt_world *world = rod_on_plate(1, 1), *twin = rod_on_plate(2, 1), *again = rod_on_plate(1, 1);
    world_steps(world, 200), world_steps(twin, 200);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(twin));
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        const brunt_state_block block = brunt_state_info(world, b);
        void *bytes = malloc((size_t)block.count * 8 + 1);
        brunt_state_get(world, b, bytes);
        ck_assert_msg(brunt_state_set(again, b, bytes, block.count, &error) == BRUNT_OK, "%s", error.message);
        free(bytes);
    }
    ck_assert_int_eq(brunt_state_done(again, &error), BRUNT_OK);
    world_steps(world, 100), world_steps(again, 100);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(again));
    brunt_world_destroy(world), brunt_world_destroy(twin), brunt_world_destroy(again);
}
END_TEST

// Copper on a rigid wall at 190 m/s as bench/scenes/taylor_bar_fem.yaml, which gives 16.264 mm and 6.489 mm with
// hexahedra of 0.38 mm.
START_TEST(taylor_bar) {
    static const double strength[] = {117e9, 0.35, 157e6, 425e6}, eos[] = {3940, 1.49, 1.96}, viscosity[] = {0.06, 1.5};
    const double R = 3.8e-3, L = 25.4e-3;
    brunt_error error = {0};
    brunt_world_def def = rings_begin("von-mises", 8930, 0, 0);
    def.materials[0] = brunt_material_def_default("copper", "von-mises");
    static const char *const keys[] = {"E", "nu", "yield", "hardening", "eos.c0", "eos.s", "eos.gamma0"};
    brunt_material_set(&def.materials[0], "density", 8930, NULL, &error);
    for (int k = 0; k < 4; k++) brunt_material_set(&def.materials[0], keys[k], strength[k], NULL, &error);
    brunt_material_set(&def.materials[0], "eos", 0, "mie-gruneisen", &error);
    for (int k = 0; k < 3; k++) brunt_material_set(&def.materials[0], keys[4 + k], eos[k], NULL, &error);
    brunt_material_set(&def.materials[0], "viscosity", 0, NULL, &error);
    brunt_material_set(&def.materials[0], "viscosity.linear", viscosity[0], NULL, &error);
    brunt_material_set(&def.materials[0], "viscosity.quadratic", viscosity[1], NULL, &error);
    def_velocity(of_elements(def_box(&def, "rod", XYZ(0, 0, 0), XYZ(R, L, 0)), BRUNT_QUAD4, 0.38e-3), 0, -190, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 80e-6);
    const brunt_body_sums sums = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    ck_assert_double_eq_tol(e.initial, 0.5 * 8930 * PI * R * R * L * 190 * 190, 1e-6 * e.initial);
    ck_assert_double_eq_tol(sums.high[1] - sums.low[1], 16.264e-3, 0.01 * 16.264e-3);
    ck_assert_double_eq_tol(sums.high[0], 6.489e-3, 0.03 * 6.489e-3);
    ck_assert_double_lt(fabs(e.error_relative), 0.02);
    ck_assert_double_lt(e.hourglass, 0.05 * e.initial);
    brunt_world_destroy(world);
}
END_TEST

static void expect_refusal(brunt_world_def *def, const char *words) {
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    ck_assert_msg(!world && error.code == BRUNT_BAD_INPUT && strstr(error.message, words), "wanted '%s', got '%s'",
                  words, error.message);
    brunt_world_def_free(def);
}

START_TEST(what_is_not_round_is_refused) {
    brunt_world_def def = rings_begin("neo-hookean", 1000, 1e6, 0.3);
    of_elements(def_box(&def, "a", XYZ(-0.1, 0, 0), XYZ(1, 1, 0)), BRUNT_QUAD4, 0.1);
    expect_refusal(&def, "r >= 0");
    def = rings_begin("neo-hookean", 1000, 1e6, 0.3);
    of_elements(def_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, 0)), BRUNT_QUAD4, 0.1)->spin[2] = 1;
    expect_refusal(&def, "spin");
    def = rings_begin("neo-hookean", 1000, 1e6, 0.3);
    of_elements(def_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, 0)), BRUNT_QUAD4, 0.1);
    def.gravity[0] = 1;
    expect_refusal(&def, "gravity");
    def = rings_begin("neo-hookean", 1000, 1e6, 0.3);
    of_elements(def_box(&def, "a", XYZ(1, 0, 0), XYZ(2, 1, 0)), BRUNT_QUAD4, 0.1);
    add_group(&def, "a", "xmin", BRUNT_GROUP_GAS);
    expect_refusal(&def, "gas");
}
END_TEST

// Weight and momentum of a free fall: the mass is that of the full circle.
START_TEST(gravity_pulls_along_the_axis) {
    brunt_world_def def = rings_begin("neo-hookean", 1000, 1e6, 0.3);
    of_elements(half_ball(&def, "ball", XYZ(0, 0, 0), 0.1), BRUNT_QUAD4, 0.02);
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    const brunt_body_sums sums = world_sums(world, 0);
    const double time = brunt_world_time(world) - 0.5 * brunt_world_dt(world); // velocities are half a step behind
    ck_assert_double_eq_tol(sums.momentum[1], -9.81 * sums.mass * time, 1e-5 * fabs(sums.momentum[1]));
    ck_assert_double_eq_tol(sums.mass, 1000 * 4 * PI / 3 * 1e-3, 0.02 * sums.mass);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("axisymmetric bodies");
    TCase *tests = tcase_create("verification");
    const TTest *const list[] = {thick_tube_under_pressure,
                                 ring_breathes,
                                 shell_breathes,
                                 ball_under_pressure,
                                 traction_acts_on_the_circle,
                                 rod_on_a_wall,
                                 rod_on_a_plate,
                                 ring_in_a_ring,
                                 elements_meet_material_points,
                                 debris_passes_the_axis,
                                 threads_and_restart_change_no_bit,
                                 taylor_bar,
                                 what_is_not_round_is_refused,
                                 gravity_pulls_along_the_axis};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) tcase_add_test(tests, list[k]);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
