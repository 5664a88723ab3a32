// Lines and surfaces with a mass in explicit steps: free flight, tops, drop weights, momenta and energy with what they
// hit.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

static brunt_world_def begin(int dim, double nu) {
    brunt_world_def def = def_begin(dim, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, nu);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    return def;
}

// A closed box from low to high, outwards: 4 edges or 12 triangles.
static brunt_boundary_surface_def *def_tool(brunt_world_def *def, const double low[3], const double high[3],
                                            double mass) {
    static const int32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const bool flat = def->dimension == 2;
    brunt_boundary_surface_def *s = def_polyline(def, 12, true, BRUNT_SEPARATE);
    s->point_count = flat ? 4 : 8, s->facet_count = flat ? 4 : 12;
    for (int k = 0; k < s->point_count; k++) {
        const int turned = k ^ (k >> 1); // around the rectangle, clockwise from above by the order below
        const int corner[3] = {flat ? (turned >> 1) & 1 : k & 1, flat ? turned & 1 : (k >> 1) & 1, (k >> 2) & 1};
        for (int a = 0; a < def->dimension; a++) s->point[k][a] = corner[a] ? high[a] : low[a];
    }
    for (int f = 0; f < s->facet_count; f++) {
        if (flat)
            memcpy(s->facet[f], (const int32_t[4]){f, (f + 1) % 4, -1, -1}, sizeof s->facet[f]);
        else
            memcpy(s->facet[f], (const int32_t[4]){faces[f][0], faces[f][1], faces[f][2], -1}, sizeof s->facet[f]);
    }
    s->mass = mass;
    for (int a = 0; a < def->dimension; a++) s->center[a] = 0.5 * (low[a] + high[a]);
    return s;
}

// As a box of even density.
static void let_turn(const brunt_world_def *def, brunt_boundary_surface_def *s, const double size[3]) {
    for (int a = 0; a < 3; a++)
        if (def->dimension == 3 || a == 2)
            s->inertia[a] =
                s->mass / 12 * (size[(a + 1) % 3] * size[(a + 1) % 3] + size[(a + 2) % 3] * size[(a + 2) % 3]);
}

static brunt_boundary_surface_report tool_of(const brunt_world *world, int k) {
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, k, &report);
    return report;
}

static double size_of(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// Nothing touches it: a parabola, and a top whose momentum and energy stay; about an axis of symmetry it precesses.
START_TEST(flies) {
    const int dim = 2 + (_i > 0);
    brunt_world_def def = begin(dim, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.3, 0.3, 0.3));
    brunt_boundary_surface_def *s = def_tool(&def, XYZ(5, 5, 5), XYZ(5.6, 5.4, 5.3), 7);
    let_turn(&def, s, XYZ(0.6, 0.4, 0.3));
    if (_i == 2) s->inertia[0] = s->inertia[1] = 0.5, s->inertia[2] = 0.8;
    s->value[0] = 1, s->value[1] = -2, s->value[2] = dim == 3 ? 0.5 : 0;
    s->spin[2] = 9;
    if (dim == 3) s->spin[0] = 4, s->spin[1] = 0.1;
    def.gravity[1] = -9.81, def.gravity[0] = 1;
    brunt_world *world = world_take(&def);
    const brunt_boundary_surface_report b = tool_of(world, 0);
    world_until(world, 0.5);
    const brunt_boundary_surface_report e = tool_of(world, 0);
    const double t = brunt_world_time(world), x = 5.3 + t + 0.5 * t * t, y = 5.2 - 2 * t - 0.5 * 9.81 * t * t;
    const double own = e.kinetic - e.gravity_work;
    double turned = 0;
    for (int a = 0; a < 3; a++) turned = fmax(turned, fabs(e.angular_momentum[a] - b.angular_momentum[a]));
    printf(
        "  %dD: off its parabola by %.1e %.1e m, momentum turned by %.1e, energy off by %.1e, spins %.4f %.4f %.4f\n",
        dim, e.position[0] - x, e.position[1] - y, turned / size_of(b.angular_momentum), own / b.kinetic - 1, e.spin[0],
        e.spin[1], e.spin[2]);
    ck_assert_double_le(fabs(e.position[0] - x), 1e-6); // the last step is cut, and its kick is the mean of two
    ck_assert_double_le(fabs(e.position[1] - y), 1e-5);
    ck_assert_double_le(turned, ROUNDING * size_of(b.angular_momentum));
    ck_assert_double_le(fabs(own / b.kinetic - 1), ROUNDING);
    if (_i == 2) { // about the momentum by |L| / I, as its own axis does
        const double L[3] = {2, 0.05, 7.2}, rate = size_of(L) / 0.5, tilt = 7.2 / size_of(L);
        double along = 0, side[3];
        for (int a = 0; a < 3; a++) along += e.spin[a] * L[a] / size_of(L);
        for (int a = 0; a < 3; a++) side[a] = e.spin[a] - along * L[a] / size_of(L);
        double first = 0, now[3], start[3] = {4, 0.1, 9}, cosine = 0;
        for (int a = 0; a < 3; a++) first += start[a] * L[a] / size_of(L);
        for (int a = 0; a < 3; a++) now[a] = start[a] - first * L[a] / size_of(L);
        for (int a = 0; a < 3; a++) cosine += now[a] * side[a] / (size_of(now) * size_of(side));
        printf("  precesses by cos %.6f, %.6f wanted\n", cosine, cos(rate * t));
        ck_assert_double_le(fabs(cosine - cos(rate * t)), 1e-3);
        ck_assert_double_le(fabs(along - first), 1e-9 * first);
        ck_assert_double_gt(tilt, 0.9);
    }
    brunt_world_destroy(world);
}
END_TEST

// A drop weight on the end of a bar: until the wave is back it is braked by rho c A v, so that its speed decays.
START_TEST(drop_weight) {
    const double turn = _i % 2 ? PI / 6 : 0, c = cos(turn), s = sin(turn), H = 0.4, L = 4, m = _i / 2 ? 100 : 400,
                 v = 0.1;
    brunt_world_def def = begin(2, 0);
    snprintf(def.materials[0].strength, sizeof def.materials[0].strength, "linear-elastic");
    brunt_body_def *bar = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(L, H, 0));
    bar->place.rotation[0] = c, bar->place.rotation[1] = -s, bar->place.rotation[3] = s, bar->place.rotation[4] = c;
    brunt_boundary_surface_def *q = def_tool(&def, XYZ(-0.5, -0.5, 0), XYZ(0, 1, 0), m);
    for (int k = 0; k < 4; k++) {
        const double x = q->point[k][0], y = q->point[k][1];
        q->point[k][0] = c * x - s * y, q->point[k][1] = s * x + c * y;
    }
    q->value[0] = v * c, q->value[1] = v * s;
    brunt_world *world = world_take(&def);
    const double speed = sqrt(YOUNG / DENSITY), rate = DENSITY * speed * H / m;
    double worst = 0;
    for (int k = 1; k <= 20; k++) {
        world_until(world, k * 0.9 * 2 * L / speed / 20);
        const brunt_boundary_surface_report now = tool_of(world, 0);
        const double along = now.velocity[0] * c + now.velocity[1] * s,
                     wanted = v * exp(-rate * (brunt_world_time(world) - 0.5 * brunt_world_dt(world)));
        worst = fmax(worst, fabs(along - wanted) / v);
    }
    const brunt_boundary_surface_report e = tool_of(world, 0);
    const brunt_momentum p = world_momentum(world);
    const double off = hypot(p.linear[0] + m * e.velocity[0] - m * v * c, p.linear[1] + m * e.velocity[1] - m * v * s);
    printf("  %g kg, %.0f degrees: speed off by %.4f of it at most, momentum %.1e, energy %.1e\n", m, turn * 180 / PI,
           worst, off / (m * v), (e.kinetic + e.work) / (0.5 * m * v * v) - 1);
    ck_assert_double_le(worst, m > 200 ? 0.01 : 0.05); // the lighter is braked within two and a half cells of the bar
    ck_assert_double_le(off, ROUNDING * m * v);
    ck_assert_double_le(fabs((e.kinetic + e.work) / (0.5 * m * v * v) - 1), ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// The same about an axis: a plate on the end of a rod, with the area of the whole circle.
START_TEST(axial) {
    const double R = 0.4, L = 4, m = 400, v = 0.1, speed = sqrt(YOUNG / DENSITY),
                 rate = DENSITY * speed * PI * R * R / m;
    brunt_world_def def = begin(2, 0);
    def.axisymmetric = true;
    snprintf(def.materials[0].strength, sizeof def.materials[0].strength, "linear-elastic");
    def_box(&def, "rod", XYZ(0, 0, 0), XYZ(R, L, 0));
    brunt_boundary_surface_def *q = def_line(&def, 0, 0, 0.6, 0, BRUNT_SEPARATE);
    q->mass = m, q->value[1] = v, q->friction = 0.3;
    brunt_world *world = world_take(&def);
    double worst = 0;
    for (int k = 1; k <= 20; k++) {
        world_until(world, k * 0.9 * 2 * L / speed / 20);
        const double wanted = v * exp(-rate * (brunt_world_time(world) - 0.5 * brunt_world_dt(world)));
        worst = fmax(worst, fabs(tool_of(world, 0).velocity[1] - wanted) / v);
    }
    const brunt_boundary_surface_report e = tool_of(world, 0);
    const double off = world_momentum(world).linear[1] + m * e.velocity[1] - m * v;
    printf("  speed off by %.4f of it at most, momentum %.1e, energy %.1e\n", worst, off / (m * v),
           (e.kinetic + e.work) / (0.5 * m * v * v) - 1);
    ck_assert_double_le(worst, 0.03);
    ck_assert_double_le(fabs(off), ROUNDING * m * v);
    ck_assert_double_le(fabs((e.kinetic + e.work) / (0.5 * m * v * v) - 1), ROUNDING);
    ck_assert(e.velocity[0] == 0 && e.position[0] == 0);
    brunt_world_destroy(world);
}
END_TEST

// A tool that spins and flies hits one block, or two that lie side by side, off its middle and with friction; of any
// mass.
static brunt_world_def hit(int dim, double mass, bool two, brunt_condition condition) {
    brunt_world_def def = begin(dim, 0.3);
    def.contact.method = BRUNT_CONTACT_NONE;
    def_box(&def, "block", XYZ(0.02, 0, 0), XYZ(0.32, 0.4, 0.3));
    if (two) def_box(&def, "second", XYZ(0.33, 0, 0), XYZ(0.63, 0.4, 0.3));
    brunt_boundary_surface_def *s = def_tool(&def, XYZ(0.12, 0.42, 0.03), XYZ(0.52, 0.62, 0.23), mass);
    let_turn(&def, s, XYZ(0.4, 0.2, 0.2));
    s->condition = condition;
    s->friction = condition == BRUNT_SEPARATE ? 0.4 : 0;
    s->value[0] = 0.4, s->value[1] = -1, s->value[2] = dim == 3 ? 0.2 : 0;
    s->spin[2] = -1;
    if (dim == 3) s->spin[0] = 0.6;
    if (condition != BRUNT_SEPARATE) // it holds what it has from the start on
        for (int k = 0; k < s->point_count; k++) s->point[k][1] -= 0.02;
    return def;
}

START_TEST(hits) {
    static const double masses[] = {1e-3, 1, 100, 1e6};
    const int dim = 2 + _i % 2;
    const double mass = masses[_i / 2 % 4];
    const bool two = _i / 8 % 2;
    const brunt_condition condition = _i / 16 == 1 ? BRUNT_STICK : _i / 16 == 2 ? BRUNT_SLIP : BRUNT_SEPARATE;
    brunt_world_def def = hit(dim, mass, two, condition);
    brunt_world *world = world_take(&def);
    double start[6], now[6], scale = 0, off = 0;
    const brunt_boundary_surface_report b = tool_of(world, 0);
    for (int s = 0; s <= 60; s++) {
        if (s) world_steps(world, 2);
        const brunt_boundary_surface_report t = tool_of(world, 0);
        const brunt_momentum p = world_momentum(world);
        for (int a = 0; a < 3; a++) {
            const int i = (a + 1) % 3, j = (a + 2) % 3;
            now[a] = p.linear[a] + t.mass * t.velocity[a];
            now[3 + a] = p.angular[a] + t.angular_momentum[a] +
                         t.mass * (t.position[i] * t.velocity[j] - t.position[j] * t.velocity[i]);
            if (!s) start[a] = now[a], start[3 + a] = now[3 + a], scale = fmax(scale, fabs(now[a]));
            off = fmax(off, fmax(fabs(now[a] - start[a]), fabs(now[3 + a] - start[3 + a])));
        }
    }
    const brunt_boundary_surface_report t = tool_of(world, 0);
    const brunt_energy e = world_energy(world);
    const double own = (t.kinetic + t.work) / b.kinetic - 1;
    printf("  %dD, %g kg, %s%s: speed %.3f -> %.3f, spin %.3f -> %.3f; momenta off by %.1e, its energy by %.1e, error "
           "%.1e\n",
           dim, mass,
           condition == BRUNT_SEPARATE ? "separate"
           : condition == BRUNT_STICK  ? "stick"
                                       : "slip",
           two ? ", two" : "", size_of(b.velocity), size_of(t.velocity), size_of(b.spin), size_of(t.spin), off / scale,
           own, e.error_relative);
    ck_assert_double_gt(t.impulse[1] * t.impulse[1], 0);
    ck_assert_double_le(off, 5 * ROUNDING * fmax(scale, 1));
    ck_assert_double_le(fabs(own), ROUNDING);
    ck_assert_double_le(t.kinetic + e.kinetic + e.internal, b.kinetic * 1.001);
    ck_assert_double_le(fabs(e.error), 2e-2 * b.kinetic);
    brunt_world_destroy(world);
}
END_TEST

// A tool that lies on a block, which lies on the floor: its weight goes through.
START_TEST(lies) {
    brunt_world_def def = begin(2, 0.3);
    brunt_body_def *block = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.6, 0.4, 0));
    block->damping = 20;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.5);
    brunt_boundary_surface_def *s = def_tool(&def, XYZ(0.1, 0.4, 0), XYZ(0.5, 0.6, 0), 300);
    if (_i) let_turn(&def, s, XYZ(0.4, 0.2, 0));
    s->friction = 0.3;
    def.gravity[1] = -1;
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    double floor = 0, tool = 0;
    const double from = brunt_world_time(world);
    const brunt_reaction f = world_boundary(world, 0);
    const brunt_boundary_surface_report t = tool_of(world, 0);
    world_until(world, 2);
    floor = (world_boundary(world, 0).impulse[1] - f.impulse[1]) / (brunt_world_time(world) - from);
    tool = (tool_of(world, 0).impulse[1] - t.impulse[1]) / (brunt_world_time(world) - from);
    const brunt_boundary_surface_report e = tool_of(world, 0);
    printf("  floor %.3f N, %.3f N wanted, tool %.3f N; moves by %.1e m/s, turns by %.1e rad/s\n", floor, 540.0, tool,
           size_of(e.velocity), size_of(e.spin));
    ck_assert_double_le(fabs(tool + 300), 1);
    ck_assert_double_le(fabs(floor - 540), 2);
    ck_assert_double_le(size_of(e.velocity), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *struck(int threads) {
    brunt_world_def def = hit(2, 3, true, BRUNT_SEPARATE);
    def.threads = threads;
    def.gravity[1] = -9.81;
    return world_take(&def);
}

START_TEST(threads) {
    double place[3][3];
    for (int k = 0; k < 3; k++) {
        brunt_world *world = struck(1 + 2 * k);
        world_steps(world, 40);
        memcpy(place[k], tool_of(world, 0).position, sizeof *place);
        ck_assert(!memcmp(place[k], place[0], sizeof *place));
        ck_assert_double_ne(tool_of(world, 0).impulse[1], 0);
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(restart) {
    brunt_world *world = struck(1), *fresh = struck(1);
    world_steps(world, 25);
    world_copy_state(world, fresh);
    world_steps(world, 25), world_steps(fresh, 25);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(fresh));
    const brunt_boundary_surface_report a = tool_of(world, 0), b = tool_of(fresh, 0);
    ck_assert(!memcmp(a.position, b.position, sizeof a.position) && !memcmp(a.spin, b.spin, sizeof a.spin));
    ck_assert_double_eq(a.gravity_work, b.gravity_work);
    brunt_world_destroy(world), brunt_world_destroy(fresh);
}
END_TEST

// What a free tool cannot be.
START_TEST(refuses) {
    static const char *const said[] = {".mass",
                                       ".inertia: it goes with a mass",
                                       ".spin: it goes with an inertia",
                                       "displacement, rotation and table prescribe",
                                       "turns about z alone",
                                       "no more than the sum",
                                       "moves along its axis",
                                       "its image"};
    for (int k = 0; k < 8; k++) {
        brunt_world_def def = hit(k == 5 ? 3 : 2, 2, false, BRUNT_SEPARATE);
        brunt_boundary_surface_def *s = def.surfaces;
        brunt_error error = {0};
        if (k == 0) s->mass = -1;
        if (k == 1) s->mass = 0;
        if (k == 2) s->inertia[2] = 0;
        if (k == 3) s->displacement = true;
        if (k == 4) s->inertia[0] = 1;
        if (k == 5) s->inertia[0] = 100 * s->inertia[1];
        if (k == 6) def.axisymmetric = true;
        if (k == 7) def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
        brunt_world *world = brunt_world_create(&def, &error);
        printf("  %s\n", error.message);
        ck_assert_ptr_null(world);
        ck_assert_ptr_nonnull(strstr(error.message, said[k]));
        brunt_world_def_free(&def);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("free_tools");
    ADD_LOOP(flies, 3);
    ADD_LOOP(drop_weight, 4);
    ADD_LOOP(axial, 1);
    ADD_LOOP(hits, 48);
    ADD_LOOP(lies, 2);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    ADD_LOOP(refuses, 1);
    return suite_main(suite);
}
