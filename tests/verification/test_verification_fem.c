// Finite elements, and contact between them, against closed forms, and against material points.
#include "tests/support/def_world.h"

// ------------------------------------------------------------------------------------------ bodies of elements

enum { SOLID_KINDS = BRUNT_MEMBRANE_QUAD4 }; // those that fill their room; membranes follow in the list

static brunt_body_def *mesh_of(brunt_body_def *body, brunt_element_kind kind, double size) {
    body->method = BRUNT_FEM;
    body->element = kind;
    body->size = size;
    return body;
}

// Holds components of a group of a body's nodes.
static void fix(brunt_world_def *def, const char *body, const char *group, bool x, bool y, bool z) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body);
    snprintf(g->group, sizeof g->group, "%s", group);
    g->component[0] = x, g->component[1] = y, g->component[2] = z;
}

static double *field_at_nodes(brunt_world *world, const char *name) { // free()
    int32_t field = brunt_body_find_field(world, 0, name);
    ck_assert_msg(field >= 0, "there is no field %s", name);
    brunt_field_info info = brunt_body_field(world, 0, field);
    double *values = malloc((size_t)brunt_body_size(world, 0, info.at) * (size_t)info.components * sizeof *values);
    brunt_body_read(world, 0, field, values);
    return values;
}

// ------------------------------------------------------------------------------------------ standing waves

// A box held at x = 0 and free at x = L swings in a plane wave: u = v0/omega sin(omega t) sin(beta x), beta = pi / 2L,
// omega = beta c, along x with c = sqrt((lambda + 2 mu) / rho) or across with c = sqrt(mu / rho). Where the box ends
// beside the wave, what the wave leaves still is held: the displacement along the face's normal of the one along x, and
// along x of the one across. Root mean square error of the nodes' displacement relative to the amplitude, after 0.3
// periods.
static double wave_error(brunt_element_kind kind, bool across, int cells) {
    const int dim = brunt_element_dimension(kind);
    // A displacement of a millionth of the box has no digits left in a float; one of a thousandth is not quite small.
    const double L = 1, nu = 0.3, v0 = sizeof(real) == 4 ? 1e-3 : 1e-6, beta = PI / (2 * L), side = 0.25;
    const double modulus = across ? 1 / (2 * (1 + nu)) : (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double omega = beta * sqrt(modulus), end = 0.3 * 2 * PI / omega;
    brunt_world_def def = def_begin(dim, 1);
    def.cfl = 0.9;
    def_material(&def, "linear-elastic", 1, 1, nu);
    brunt_body_def *box = mesh_of(def_box(&def, "box", XYZ(0, 0, 0), XYZ(L, side, side)), kind, L / cells);
    box->wave_velocity[across ? dim - 1 : 0] = v0;
    box->wave_vector[0] = beta;
    fix(&def, "box", "xmin", true, true, dim == 3);
    const char *beside[] = {"ymin", "ymax", "zmin", "zmax"};
    for (int k = 0; k < 2 * (dim - 1); k++) {
        bool wave_face = across && k / 2 == dim - 2; // its normal is along the motion
        fix(&def, "box", beside[k], wave_face, !wave_face && k < 2, !wave_face && k >= 2);
    }
    brunt_world *world = world_take(&def);
    double *start = field_at_nodes(world, "position"), sum = 0;
    world_until(world, end);
    double *u = field_at_nodes(world, "displacement");
    const int64_t n = brunt_body_nodes(world, 0);
    for (int64_t i = 0; i < n; i++)
        for (int a = 0; a < dim; a++) {
            bool along = a == (across ? dim - 1 : 0);
            double off = u[3 * i + a] - (along ? v0 / omega * sin(omega * end) * sin(beta * start[3 * i]) : 0);
            sum += off * off;
        }
    free(start);
    free(u);
    brunt_world_destroy(world);
    return sqrt(sum / (double)n) / (v0 / omega);
}

// Linear elements, lumped masses and central differences are of second order in the displacement.
START_TEST(standing_waves_converge) {
    const brunt_element_kind kind = (brunt_element_kind)(_i / 2);
    const bool across = _i % 2;
    const int dim = brunt_element_dimension(kind), coarse = dim == 3 ? 8 : 16;
    double error[3];
    for (int k = 0; k < 3; k++) error[k] = wave_error(kind, across, coarse << k);
    double order = log2(error[0] / error[2]) / 2;
    printf("  standing wave %s, %s: error %.2e %.2e %.2e (%d to %d elements), order %.2f\n",
           across ? "across" : "along", brunt_element_name(kind), error[0], error[1], error[2], coarse, 4 * coarse,
           order);
    ck_assert_double_le(error[2], sizeof(real) == 4 ? 3e-3 : 1e-3);
    if (sizeof(real) == 8) ck_assert_double_ge(order, 1.85);
}
END_TEST

// ------------------------------------------------------------------------------------------ elements and material
// points

// The bar of the axial vibration (tests of material points), by both methods on cells of the same size: way of the
// centre, and share of kinetic energy, after 1.15 periods; exact: v0 / (beta L omega) sin(omega t) and cos^2(omega t).
static void bar(bool elements, double *way, double *kinetic) {
    const double L = 25, v0 = 0.01, beta = PI / (2 * L), omega = beta * 10, h = L / 40;
    brunt_world_def def = def_begin(2, h);
    def_material(&def, "linear-elastic", 1, 100, 0);
    brunt_body_def *body = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(L, 2 * h, 0));
    if (elements) mesh_of(body, BRUNT_QUAD4, h);
    body->wave_velocity[0] = v0;
    body->wave_vector[0] = beta;
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SLIP, 0);
    def_plane(&def, XYZ(0, 2 * h, 0), XYZ(0, -1, 0), BRUNT_SLIP, 0);
    brunt_world *world = world_take(&def);
    const double from = world_sums(world, 0).centre[0], initial = world_energy(world).kinetic,
                 end = 1.15 * 2 * PI / omega;
    world_until(world, end);
    *way = (world_sums(world, 0).centre[0] - from) / (v0 / (beta * L * omega) * sin(omega * end)) - 1;
    *kinetic = world_energy(world).kinetic / initial - cos(omega * end) * cos(omega * end);
    brunt_world_destroy(world);
}

START_TEST(elements_and_material_points_agree) {
    double way[2], kinetic[2];
    for (int k = 0; k < 2; k++) bar(k, &way[k], &kinetic[k]);
    printf("  bar: way off by %.2e (points) %.2e (elements), kinetic energy by %.2e and %.2e of the initial\n", way[0],
           way[1], kinetic[0], kinetic[1]);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_le(fabs(way[k]), 5e-3);
        ck_assert_double_le(fabs(kinetic[k]), 2e-2);
    }
}
END_TEST

// A free block under a weight that grows with time: way g t^3 / 6T, which central differences miss by (step / t)^2.
static double fall_error(bool elements, double step) {
    const double g = 10, T = 0.2, end = 0.1;
    brunt_world_def def = def_begin(2, 0.5);
    def_material(&def, "linear-elastic", 1000, 1e6, 0.3);
    brunt_body_def *body = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0));
    if (elements) mesh_of(body, BRUNT_QUAD4, 0.5);
    def.gravity[1] = -g, def.gravity_ramp = T;
    def.step = step;
    brunt_world *world = world_take(&def);
    const double from = world_sums(world, 0).centre[1];
    world_until(world, end);
    double error = (from - world_sums(world, 0).centre[1]) / (g * end * end * end / (6 * T)) - 1;
    printf("  growing weight, %s, step %g s: way off by %.2e\n", elements ? "elements" : "points", step, error);
    brunt_world_destroy(world);
    return error;
}

START_TEST(growing_weight_acts_in_time) {
    for (double step = 2e-3; step > 9e-4; step /= 2)
        ck_assert_double_le(fabs(fall_error(_i, step)), 1.01 * (step / 0.1) * (step / 0.1) + 10 * ROUNDING);
}
END_TEST

// ------------------------------------------------------------------------------------------ bending

// Period of a cantilever of ten times its height, between two falls of its centre through the middle.
static double bending_period(int over_height) {
    const double L = 1, h = 0.1;
    brunt_world_def def = def_begin(2, 1);
    def.cfl = 0.9;
    def_material(&def, "neo-hookean", 1000, 1e7, 0);
    brunt_body_def *beam = mesh_of(def_box(&def, "beam", XYZ(0, 0, 0), XYZ(L, h, 0)), BRUNT_QUAD4, h / over_height);
    beam->wave_velocity[1] = 0.05;
    beam->wave_vector[0] = PI / (2 * L);
    fix(&def, "beam", "xmin", true, true, false);
    brunt_world *world = world_take(&def);
    double fall[2] = {0}, before = 0;
    for (int falls = 0; falls < 2 && brunt_world_time(world) < 2;) {
        world_until(world, brunt_world_time(world) + 2e-3);
        double now = world_sums(world, 0).centre[1] - h / 2;
        if (before > 0 && now <= 0) fall[falls++] = brunt_world_time(world) - 2e-3 * now / (now - before);
        before = now;
    }
    brunt_world_destroy(world);
    return fall[1] - fall[0];
}

// Timoshenko's beam with shear factor 5/6 and rotary inertia (S. P. Timoshenko, Phil. Mag. 41 (1921) 744), its
// characteristic equation solved for these numbers: 0.62310 s; without shear and rotary inertia 0.61904 s. One point in
// the middle of each of n elements over the height sees 1 - 1/n^2 of the bending stiffness: the period is 1 / 2 n^2 too
// long.
START_TEST(beam_swings) {
    const double exact = 0.623095;
    double off[2];
    for (int k = 0; k < 2; k++) off[k] = bending_period(k ? 8 : 4) / exact - 1;
    printf("  cantilever: period off by %.4f (4 elements over the height), %.4f (8)\n", off[0], off[1]);
    ck_assert_double_ge(off[0], 0);
    ck_assert_double_le(off[0], 0.04);
    ck_assert_double_le(fabs(off[1]), 1e-2);
    ck_assert_double_ge(off[0] / off[1], 2.8);
}
END_TEST

// ------------------------------------------------------------------------------------------ impact on a wall

// B05. A rod of length 10 and section 1 hits a rigid wall: force rho c V A for 2 L / c, then it leaves as fast as it
// came. Units in which E, rho and c are 1. The half element at the wall stops at once, which takes 1 / 2N of the
// energy; with touches that give back it comes again as the rod leaves, and what the dispersed fronts keep is left.
START_TEST(rod_on_wall) {
    const bool elastic = _i == 0;
    const double L = 10, V = 1e-3, gap = 1e-3 * L;
    const int N = 50;
    brunt_world_def def = def_begin(3, 1);
    def.cfl = 0.9;
    def_material(&def, "linear-elastic", 1, 1, 0);
    def_velocity(mesh_of(def_box(&def, "rod", XYZ(0, 0, gap), XYZ(1, 1, gap + L)), BRUNT_HEX8, L / N), 0, 0, -V);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0);
    def.contact.touch = elastic ? BRUNT_TOUCH_ELASTIC : BRUNT_TOUCH_INELASTIC;
    brunt_world *world = world_take(&def);
    const double touch = gap / V, window[2] = {touch + 0.2 * L, touch + 1.8 * L};
    double first = 0, last = 0, impulse[2], held = 0;
    world_until(world, touch - 1);
    ck_assert(world_boundary(world, 0).impulse[2] == 0);
    while (brunt_world_time(world) < touch + 3 * L) {
        for (int k = 0; k < 2; k++)
            if (brunt_world_time(world) == window[k]) impulse[k] = world_boundary(world, 0).impulse[2];
        double next = touch + 3 * L;
        for (int k = 1; k >= 0; k--)
            if (brunt_world_time(world) < window[k]) next = window[k];
        brunt_error error;
        ck_assert_int_eq(brunt_world_step(world, next, &error), BRUNT_OK);
        const brunt_energy now = world_energy(world);
        if (brunt_world_time(world) < window[1]) held = fmax(held, now.contact_held / now.initial);
        if (elastic) ck_assert_double_eq_tol(now.contact_held, now.contact, 1e-9 * now.initial);
        if (world_boundary(world, 0).force[2] > 0) {
            if (!(first > 0)) first = brunt_world_time(world);
            last = brunt_world_time(world);
        }
    }
    const double force = (impulse[1] - impulse[0]) / (window[1] - window[0]) / V, lasted = (last - first) / (2 * L);
    const double speed = world_sums(world, 0).velocity[2] / V;
    const brunt_energy energy = world_energy(world);
    printf("  rod on a wall: touches at %.4f of the time, force %.5f, contact lasts %.4f, leaves at %.4f, held %.4f, "
           "lost at the wall %.2e\n",
           first / touch, force, lasted, speed, held, energy.contact / energy.initial);
    ck_assert_double_eq_tol(first, touch, 2.0 * L / N);
    ck_assert_double_eq_tol(force, 1, 2e-3);
    ck_assert_double_eq_tol(lasted, 1, 0.02);
    ck_assert_double_ge(speed, 0.98);
    ck_assert_double_le(speed, 1);
    ck_assert_double_eq_tol(energy.contact / energy.initial, elastic ? 0 : 0.5 / N, elastic ? 1e-9 : 0.3 / N);
    ck_assert_double_eq_tol(held, elastic ? 0.5 / N : 0, 0.3 / N);
    ck_assert_double_le(fabs(energy.error_relative), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ impact of a ball

// Hertz: force 4/3 E* sqrt(R) d^1.5 with d = (15 m v^2 / (16 sqrt(R) E*))^0.4, contact for 2.9433 d / v. The radius of
// the contact, 0.13 R, is that of two and a half elements here, so that nodes coming and going are seen in the force
// (10 % of it at 28 elements a diameter, 4 % at 56); Boussinesq's displacement of a half-space at the depth of the
// centre, which a ball does not have, is 9 % of the approach: up to 5 % of F and t.
// Almost incompressible (nu = 0.499) it is the same with its own E*, coarser as its steps are ten times shorter;
// springs against hourglass modes in proportion to the volume's stiffness would take over.
static const struct {
    double nu, size, force, lasts, hourglass;
} balls[] = {{0.3, 5e-3, 0.05, 0.03, 0.05}, {0.499, 7.1e-3, 0.15, 0.05, 0.05}};

// B14.
START_TEST(ball_on_plane) {
    const double R = 0.1, E = 1e6, nu = balls[_i].nu, rho = 1000, v = 0.1, gap = 2e-4, e_star = E / (1 - nu * nu);
    const double m = 4.0 / 3 * PI * R * R * R * rho, d = pow(15 * m * v * v / (16 * sqrt(R) * e_star), 0.4);
    const double force = 4.0 / 3 * e_star * sqrt(R) * pow(d, 1.5), lasts = 2.94328 * d / v, dt = 2e-4;
    brunt_world_def def = def_begin(3, 1);
    def.cfl = 0.9;
    def_material(&def, "neo-hookean", rho, E, nu);
    def_velocity(mesh_of(def_ball(&def, "ball", XYZ(0, 0, R + gap), R), BRUNT_HEX8, balls[_i].size), 0, 0, -v);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    double before = 0, most = 0, last = 0, springs = 0;
    for (int k = 1; k <= 275; k++) {
        world_until(world, k * dt);
        double now = world_boundary(world, 0).impulse[2], mean = (now - before) / dt;
        most = fmax(most, mean);
        if (mean > 0) last = k * dt;
        before = now;
        if (k % 5 == 0) springs = fmax(springs, world_energy(world).hourglass);
    }
    const double speed = world_sums(world, 0).velocity[2] / v;
    const brunt_energy energy = world_energy(world);
    printf(
        "  ball on a plane, nu %g: force %.4f and time %.4f of Hertz's, leaves at %.4f of its speed; at most %.1e of "
        "the energy in hourglass modes\n",
        nu, most / force, (last - gap / v) / lasts, speed, springs / energy.initial);
    ck_assert_double_eq_tol(most / force, 1, balls[_i].force);
    ck_assert_double_eq_tol((last - gap / v) / lasts, 1, balls[_i].lasts);
    ck_assert_double_lt(springs / energy.initial, balls[_i].hourglass);
    ck_assert_double_ge(speed, 0.99);
    ck_assert_double_le(speed, 1);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ suite

int main(void) {
    Suite *suite = suite_create("verification_fem");
    TCase *waves = tcase_create("waves"), *bending = tcase_create("bending"), *impact = tcase_create("impact");
    tcase_add_loop_test(waves, standing_waves_converge, 0, 2 * SOLID_KINDS);
    tcase_add_test(waves, elements_and_material_points_agree);
    tcase_add_loop_test(waves, growing_weight_acts_in_time, 0, 2);
    tcase_add_test(bending, beam_swings);
    tcase_add_loop_test(impact, rod_on_wall, 0, 2);
    tcase_add_loop_test(impact, ball_on_plane, 0, 2);
    TCase *cases[] = {waves, bending, impact};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        tcase_set_timeout(cases[k], 0);
        suite_add_tcase(suite, cases[k]);
    }
    return suite_main(suite);
}
