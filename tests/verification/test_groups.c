// Labels: conservation
// Named groups of nodes: prescribed motion, traction, pressure, and the planes that hold meshes. Closed forms and the
// ledger.
#include "tests/support/def_world.h"

static const double E = 1e6, NU = 0.3, DENSITY = 1000;

// A bar of 1 x 0.2 x 0.2 m along x; in two dimensions 1 x 0.2.
static brunt_world_def bar(int dimension, brunt_element_kind kind) {
    brunt_world_def def = def_begin(dimension, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    brunt_body_def *body = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(1, 0.2, 0.2));
    body->method = BRUNT_FEM, body->element = kind, body->size = 0.1;
    def.groups = brunt_alloc(4 * sizeof *def.groups);
    def.cfl = 0.9;
    return def;
}

static brunt_group_def *group(brunt_world_def *def, const char *name, brunt_group_action action, double x, double y,
                              double z) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "bar");
    snprintf(g->group, sizeof g->group, "%s", name);
    g->action = action;
    g->value[0] = x, g->value[1] = y, g->value[2] = z;
    return g;
}

static void check_ledger(brunt_world *world, double tolerance) {
    brunt_energy e = world_energy(world);
    brunt_momentum m = world_momentum(world);
    ck_assert_double_lt(fabs(e.error_relative), tolerance);
    ck_assert_double_lt(m.linear_drift, ROUNDING);
    ck_assert_double_lt(m.angular_drift, ROUNDING);
}

static const struct {
    int dimension;
    brunt_element_kind kind;
} kinds[] = {{3, BRUNT_TET4}, {3, BRUNT_HEX8}, {2, BRUNT_TRI3}, {2, BRUNT_QUAD4}};

// A traction on one end and its opposite on the other: equal acceleration of nothing, the bar swings about its static
// length u = sigma L / E' (plane strain: E' = E / (1 - nu^2)), to which its mean over a period comes.
START_TEST(traction_stretches) {
    brunt_world_def def = bar(kinds[_i].dimension, kinds[_i].kind);
    const double sigma = 1000;
    group(&def, "xmin", BRUNT_GROUP_TRACTION, -sigma, 0, 0);
    group(&def, "xmax", BRUNT_GROUP_TRACTION, sigma, 0, 0);
    brunt_world *world = world_take(&def);
    double *x0 = world_field(world, 0, "position"), sum = 0, period = 2 / sqrt(E / DENSITY);
    int64_t n = brunt_body_nodes(world, 0), samples = 0;
    while (brunt_world_time(world) < 4 * period) {
        world_until(world, brunt_world_time(world) + period / 50);
        double *x = world_field(world, 0, "position"), low = 0, high = 0;
        int64_t count = 0;
        for (int64_t k = 0; k < n; k++) {
            if (x0[3 * k] > 1 - 1e-9) high += x[3 * k] - x0[3 * k], count++;
            if (x0[3 * k] < 1e-9) low += x[3 * k] - x0[3 * k];
        }
        sum += (high - low) / (double)count, samples++;
        free(x);
    }
    double stiffness = kinds[_i].dimension == 2 ? E / (1 - NU * NU) : E;
    printf("traction, %s: stretch %.5f of sigma L / E\n", brunt_element_name(kinds[_i].kind),
           sum / (double)samples * stiffness / sigma);
    ck_assert_double_eq_tol(sum / (double)samples * stiffness / sigma, 1, 0.03);
    check_ledger(world, 1e-4);
    free(x0);
    brunt_world_destroy(world);
}
END_TEST

// A shear traction on one end of a free bar, which turns it: what the boundary books is the momentum that the bar
// gains, about the origin, and its work the energy, while the load rises with a table. The force is known: the traction
// times the area.
START_TEST(a_load_off_the_centre_turns) {
    brunt_world_def def = bar(kinds[_i].dimension, kinds[_i].kind);
    const bool plane = kinds[_i].dimension == 2;
    const double area = plane ? 0.2 : 0.04, sigma = 500, rise = 0.05, end = 0.1;
    brunt_group_def *g = group(&def, "xmax", BRUNT_GROUP_TRACTION, 0, sigma, plane ? 0 : -0.5 * sigma);
    g->table.points = brunt_alloc(2 * sizeof *g->table.points), g->table.count = 2;
    g->table.points[1][0] = rise, g->table.points[1][1] = 1;
    brunt_world *world = world_take(&def);
    world_until(world, end);
    const brunt_body_sums body = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const brunt_energy e = world_energy(world);
    const brunt_momentum m = world_momentum(world);
    const double push =
        area * sigma * (end - rise / 2); // the table's integral, by rectangles at the start of each step
    ck_assert_double_eq_tol(f.impulse[1], push, 0.02 * push);
    for (int a = 0; a < 3; a++) {
        ck_assert_double_eq_tol(body.momentum[a], f.impulse[a], ROUNDING * push);
        ck_assert_double_eq_tol(m.angular[a], m.angular_impulse[a], 10 * ROUNDING * push);
    }
    ck_assert_double_gt(m.angular[2], 0.5 * push); // about the origin, nearly a metre from the end
    ck_assert_double_gt(e.external_work, 0.5 * push * push / body.mass);
    ck_assert_double_eq_tol(e.kinetic + e.internal + e.hourglass + e.transfer, e.external_work - e.viscosity,
                            2e-3 * e.external_work);
    ck_assert_double_lt(m.angular_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// Pressure on all of the surface: no resultant force or moment, and the volume falls by p / K in the mean.
START_TEST(pressure_squeezes) {
    brunt_world_def def = bar(3, kinds[_i].kind);
    const double p = 1000;
    group(&def, "surface", BRUNT_GROUP_PRESSURE, p, 0, 0);
    brunt_world *world = world_take(&def);
    double mean = 0, period = 2 / sqrt(E / DENSITY);
    int samples = 0;
    while (brunt_world_time(world) < 4 * period) {
        world_until(world, brunt_world_time(world) + period / 50);
        double *v = world_field(world, 0, "volume"), volume = 0;
        for (int64_t k = 0; k < brunt_body_elements(world, 0); k++) volume += v[k];
        mean += volume / 0.04 - 1, samples++;
        free(v);
    }
    mean /= samples;
    brunt_reaction f = world_boundary(world, 0);
    for (int a = 0; a < 3; a++) ck_assert_double_lt(fabs(f.impulse[a]), 1e-9);
    ck_assert_double_eq_tol(mean, -p / (E / (3 * (1 - 2 * NU))), 0.05 * p / E);
    check_ledger(world, 1e-4);
    brunt_world_destroy(world);
}
END_TEST

// One end is fixed, the other follows a table: it is there to the digit, and the work of the pull is the energy gained.
START_TEST(displacement_follows_its_table) {
    brunt_world_def def = bar(kinds[_i].dimension, kinds[_i].kind);
    group(&def, "xmin", BRUNT_GROUP_VELOCITY, 0, 0, 0);
    brunt_group_def *pull = group(&def, "xmax", BRUNT_GROUP_DISPLACEMENT, 0.1, 0, 0);
    pull->component[1] = pull->component[2] = false;
    pull->table.points = brunt_alloc(3 * sizeof *pull->table.points), pull->table.count = 3;
    static const double table[3][2] = {{0, 0}, {0.05, 1}, {0.1, 0.5}};
    memcpy(pull->table.points, table, sizeof table);
    brunt_world *world = world_take(&def);
    double *x0 = world_field(world, 0, "position");
    static const double when[] = {0.025, 0.05, 0.075, 0.12}, where[] = {0.05, 0.1, 0.075, 0.05};
    for (int t = 0; t < 4; t++) {
        world_until(world, when[t]);
        double *x = world_field(world, 0, "position");
        for (int64_t k = 0; k < brunt_body_nodes(world, 0); k++) {
            if (x0[3 * k] > 1 - 1e-9) ck_assert_double_eq_tol(x[3 * k] - x0[3 * k], where[t], 100 * ROUNDING);
            if (x0[3 * k] < 1e-9)
                for (int a = 0; a < 3; a++) ck_assert_double_eq(x[3 * k + a], x0[3 * k + a]);
        }
        free(x);
    }
    check_ledger(world, 2e-3);
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.external_work, 0);
    free(x0);
    brunt_world_destroy(world);
}
END_TEST

// One end is fixed, the other is turned about x (in two dimensions about z) and pulled along x by the boundary before,
// whose component that stays: it is there to the digit, and the work of both is the energy gained.
START_TEST(rotation_follows_its_table) {
    const int dim = kinds[_i].dimension;
    brunt_world_def def = bar(dim, kinds[_i].kind);
    group(&def, "xmin", BRUNT_GROUP_VELOCITY, 0, 0, 0);
    brunt_group_def *pull = group(&def, "xmax", BRUNT_GROUP_DISPLACEMENT, 0.05, 0, 0);
    pull->component[0] = dim == 3, pull->component[1] = pull->component[2] = false;
    brunt_group_def *turn = group(&def, "xmax", BRUNT_GROUP_ROTATION, 0, 0, 0);
    turn->rotation = (brunt_rotation_def){.angle = 0.6, .axis = {0, 0, 1}, .about = {0.9, 0.1, 0}};
    if (dim == 3) turn->rotation = (brunt_rotation_def){.angle = 0.6, .axis = {2, 0, 0}, .about = {7, 0.1, 0.05}};
    turn->table.points = brunt_alloc(2 * sizeof *turn->table.points), turn->table.count = 2;
    static const double table[2][2] = {{0, 0}, {0.1, 1}};
    memcpy(turn->table.points, table, sizeof table);
    pull->table.points = brunt_alloc(2 * sizeof *pull->table.points), pull->table.count = 2;
    memcpy(pull->table.points, table, sizeof table);
    double about[3];
    memcpy(about, turn->rotation.about, sizeof about);
    brunt_world *world = world_take(&def);
    double *x0 = world_field(world, 0, "position");
    for (int t = 1; t <= 3; t++) {
        const double angle = fmin(0.24 * t, 0.6);
        const int i = dim == 3 ? 1 : 0, j = i + 1;
        world_until(world, 0.04 * t);
        double *x = world_field(world, 0, "position");
        for (int64_t k = 0; k < brunt_body_nodes(world, 0); k++) {
            const double *from = x0 + 3 * k, p = from[i] - about[i], q = from[j] - about[j];
            if (from[0] < 1 - 1e-9) continue;
            ck_assert_double_eq_tol(x[3 * k + i], about[i] + cos(angle) * p - sin(angle) * q, 100 * ROUNDING);
            ck_assert_double_eq_tol(x[3 * k + j], about[j] + sin(angle) * p + cos(angle) * q, 100 * ROUNDING);
            if (dim == 3) ck_assert_double_eq_tol(x[3 * k], from[0] + 0.05 * fmin(0.4 * t, 1), 100 * ROUNDING);
        }
        free(x);
    }
    check_ledger(world, 2e-3);
    ck_assert_double_gt(world_energy(world).external_work, 0);
    free(x0);
    brunt_world_destroy(world);
}
END_TEST

// Half a bar with a mirror plane, and a bar that slides along an oblique one, move as the whole and as the free one.
START_TEST(planes_hold) {
    brunt_world_def half = bar(3, kinds[_i].kind), whole = bar(3, kinds[_i].kind);
    def_plane(&half, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
    whole.bodies[0].shape.min[0] = -1;
    for (int k = 0; k < 2; k++) {
        brunt_body_def *body = k ? &whole.bodies[0] : &half.bodies[0];
        body->wave_velocity[0] = 5, body->wave_vector[0] = PI / 2;
    }
    brunt_world *a = world_take(&half), *b = world_take(&whole);
    world_until(a, 0.05), world_until(b, 0.05);
    brunt_energy p = world_energy(a), q = world_energy(b);
    printf("half and whole, %s: kinetic %.9g %.9g\n", brunt_element_name(kinds[_i].kind), 2 * p.kinetic, q.kinetic);
    // The whole one's mesh is the half's and its mirror image; time steps differ where the half has no neighbour.
    ck_assert_double_eq_tol(2 * p.kinetic, q.kinetic, 2e-3 * q.initial);
    check_ledger(a, 1e-3);
    brunt_world_destroy(a);
    brunt_world_destroy(b);

    brunt_world_def def = bar(3, kinds[_i].kind);
    const double slope = 0.5, n[3] = {sin(slope), cos(slope), 0};
    def.bodies[0].place = brunt_placement_rotate(def.bodies[0].place, XYZ(0, 0, 1), -slope, XYZ(0, 0, 0));
    def_plane(&def, XYZ(0, 0, 0), n, BRUNT_SLIP, 0);
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    brunt_body_sums start = world_sums(world, 0);
    world_until(world, 0.2);
    brunt_body_sums now = world_sums(world, 0);
    double along = (now.centre[0] - start.centre[0]) * n[1] - (now.centre[1] - start.centre[1]) * n[0];
    ck_assert_double_eq_tol(along, 0.5 * 10 * sin(slope) * 0.04, 2e-4 * 0.1);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(mistakes_are_said) {
    static const struct {
        const char *body, *group, *says;
    } wrong[] = {
        {"bar", "nose", "body 'bar' has no group 'nose'; it has: xmin, xmax"},
        {"car", "xmin", "there is no finite-element body 'car'"},
    };
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = bar(3, BRUNT_HEX8);
        brunt_group_def *g = group(&def, wrong[k].group, BRUNT_GROUP_VELOCITY, 0, 0, 0);
        snprintf(g->body, sizeof g->body, "%s", wrong[k].body);
        brunt_error error = {0};
        ck_assert_ptr_null(brunt_world_create(&def, &error));
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, wrong[k].says) != NULL, "%s", error.message);
        brunt_world_def_free(&def);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("groups");
    TCase *tcase = tcase_create("groups");
    tcase_add_loop_test(tcase, traction_stretches, 0, 4);
    tcase_add_loop_test(tcase, a_load_off_the_centre_turns, 0, 4);
    tcase_add_loop_test(tcase, pressure_squeezes, 0, 2);
    tcase_add_loop_test(tcase, displacement_follows_its_table, 0, 4);
    tcase_add_loop_test(tcase, rotation_follows_its_table, 0, 4);
    tcase_add_loop_test(tcase, planes_hold, 0, 2);
    tcase_add_test(tcase, mistakes_are_said);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
