// Hard cases of meshes in contact, and of points with meshes: unequal cells, bodies that differ by many powers of ten,
// pressures of what hardly changes its volume, time steps, the threshold of sliding, tilted meshes.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

static brunt_world_def begin(int dimension, double cell, double friction) {
    brunt_world_def def = def_begin(dimension, cell);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = friction;
    return def;
}

static brunt_body_def *mesh(brunt_body_def *b, brunt_element_kind kind, double size) {
    b->method = BRUNT_FEM, b->element = kind, b->size = size;
    return b;
}

static brunt_group_def *group(brunt_world_def *def, const char *body, const char *name) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", name);
    return g;
}

static void set(brunt_material_def *m, const char *key, double value) {
    brunt_error error;
    ck_assert_int_eq(brunt_material_set(m, key, value, NULL, &error), BRUNT_OK);
}

// ------------------------------------------------------------------------------------------ cells and edges

// C01. A block of points thrown at a held slab whose edges are 1/8 to 8 cells: impulse, and how deep a centre comes.
static double bounce_on(double edge, double *depth) {
    const double cell = 0.1;
    brunt_world_def def = begin(2, cell, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "base", XYZ(-0.8, -0.8, 0), XYZ(1.6, 0, 0)), BRUNT_QUAD4, edge);
    group(&def, "base", "surface");
    def_velocity(def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.83, 0.82, 0)), 0, -1, 0);
    brunt_world *world = world_take(&def);
    *depth = 0;
    while (brunt_world_time(world) < 0.12) {
        world_steps(world, 1);
        double *x = world_field(world, 1, "position");
        for (int64_t i = 0; i < brunt_body_particles(world, 1); i++) *depth = fmax(*depth, -x[3 * i + 1]);
        free(x);
    }
    const double impulse = world_pair(world, 0).impulse[1];
    brunt_world_destroy(world);
    return impulse;
}

START_TEST(cells_and_edges) {
    double least = INFINITY, most = 0, deepest = 0;
    for (int k = -3; k <= 3; k++) {
        double depth, impulse = bounce_on(0.1 * pow(2, k), &depth);
        printf("  edge of %g cells: impulse %.5f N s, depth %.2e m\n", pow(2, k), impulse, depth);
        least = fmin(least, impulse), most = fmax(most, impulse), deepest = fmax(deepest, depth / (0.1 * pow(2, k)));
    }
    hard_case("C01", most / least - 1, 0.05, 0.05, "points on edges of 1/8 to 8 cells: spread of the impulse");
    hard_case("C01", deepest, 0.25, 0.25, "points on edges of 1/8 to 8 cells: depth of a centre [edges]");
}
END_TEST

// ------------------------------------------------------------------------------------------ stiff and soft, heavy and
// light

// C02. A light soft cube thrown at a heavy stiff one that is free: stiffness 1e6 apart, density 1e4. It rebounds from
// what is as good as rigid: twice its momentum, less what stays in its own waves; the rigid plane tells how much.
START_TEST(far_apart) {
    const double v = 0.1;
    double impulse[2], drift = 0;
    for (int rigid = 0; rigid < 2; rigid++) {
        brunt_world_def def = begin(2, 1, 0);
        def_material(&def, "neo-hookean", 10, 1e3, 0.3);
        def_material(&def, "neo-hookean", 1e5, 1e9, 0.3);
        def_velocity(mesh(def_box(&def, "a", XYZ(0, 0.01, 0), XYZ(1, 1.01, 0)), BRUNT_QUAD4, 0.125), 0, -v, 0);
        if (rigid)
            def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        else
            mesh(def_box(&def, "b", XYZ(-0.5, -1, 0), XYZ(1.5, 0, 0)), BRUNT_QUAD4, 0.25)->material = 1;
        brunt_world *world = world_take(&def);
        world_until(world, 0.5);
        impulse[rigid] = fabs(rigid ? world_boundary(world, 0).impulse[1] : world_pair(world, 0).impulse[1]);
        const brunt_energy e = world_energy(world);
        printf("  soft and light on %s: impulse %.5f of m v, error %.1e\n", rigid ? "a plane" : "stiff and heavy",
               impulse[rigid] / (10 * v), e.error_relative);
        ck_assert_double_le(fabs(e.error_relative), 0.02);
        if (!rigid) drift = world_momentum(world).linear_drift;
        brunt_world_destroy(world);
    }
    ck_assert_double_gt(impulse[1], 1.5 * 10 * v);
    hard_case("C02", fabs(impulse[0] / impulse[1] - 1), 0.03, 0.03, "meshes: impulse beside that of a rigid plane");
    hard_case("C02", drift, ROUNDING, ROUNDING, "meshes: drift of momentum");
}
END_TEST

// ------------------------------------------------------------------------------------------ nearly incompressible

// C05. A block of quadrilaterals of Poisson's ratio nu, pressed by a punch of half its width at rest at the end: mean
// of the pressures under the punch, and how far neighbours alternate about it, a checkerboard. The step is that of the
// wave speed of pressure.
typedef struct punched {
    double mean, alternating, depth, step;
} punched;

static punched punch(double nu, double size) {
    const double E = 1e6;
    brunt_world_def def = begin(2, 1, 0);
    brunt_material_def *m = def_material(&def, "neo-hookean", 1000, E, nu);
    set(m, "viscosity", 0);
    brunt_body_def *b = mesh(def_box(&def, "block", XYZ(-1, 0, 0), XYZ(1, 1, 0)), BRUNT_QUAD4, size);
    b->damping = 30;
    group(&def, "block", "ymin");
    brunt_body_def *p = mesh(def_box(&def, "punch", XYZ(-0.5, 1, 0), XYZ(0.5, 1.25, 0)), BRUNT_QUAD4, size);
    p->damping = 30;
    brunt_group_def *load = group(&def, "punch", "ymax");
    load->action = BRUNT_GROUP_PRESSURE, load->value[0] = 2e4;
    load->table.points = brunt_def_alloc(2 * sizeof *load->table.points), load->table.count = 2;
    load->table.points[1][0] = 0.2, load->table.points[1][1] = 1;
    brunt_world *world = world_take(&def);
    punched out = {.step = brunt_world_dt(world)};
    world_until(world, 0.5);
    double *s = world_field(world, 0, "stress"), weight = 0;
    const int columns = (int)lround(2 / size), rows = (int)lround(1 / size);
    for (int i = 1; i < columns - 1; i++)
        for (int j = 1; j < rows - 1; j++) {
            const double x = (i + 0.5) * size - 1, y = (j + 0.5) * size;
            if (fabs(x) > 0.5) continue;                      // beside the punch there is hardly any pressure
            if (hypot(fabs(x) - 0.5, y - 1) < 0.25) continue; // by its corners it has no bound
            double pressure = 0, around = 0;
            for (int c = 0; c < 3; c++) pressure -= s[6 * (j * columns + i) + c] / 3;
            for (int k = 0; k < 4; k++) {
                const int at = (j + (k == 0) - (k == 1)) * columns + i + (k == 2) - (k == 3);
                for (int c = 0; c < 3; c++) around -= s[6 * at + c] / 12;
            }
            out.mean += pressure, weight++;
            out.alternating = fmax(out.alternating, fabs(pressure - around) / 2);
        }
    out.mean /= weight, out.alternating /= out.mean;
    out.depth = 1 - world_sums(world, 1).low[1];
    free(s);
    brunt_world_destroy(world);
    return out;
}

START_TEST(hardly_compressible) {
    const punched soft = punch(0.3, 0.125), stiff = punch(0.499, 0.125), fine = punch(0.499, 0.0625);
    printf("  nu 0.499: pressure %.0f Pa, alternating %.3f, finer %.3f; depth %.5f and %.5f m\n", stiff.mean,
           stiff.alternating, fine.alternating, stiff.depth, fine.depth);
    // The highest mode of a square swells both ways, with 2 (lambda + mu) = E / ((1 + nu) (1 - 2 nu)): 13 times
    // shorter.
    const double ratio = sqrt(1.3 * 0.4 / (1.499 * 0.002));
    hard_case("C05", fabs(soft.step / stiff.step / ratio - 1), 0.01, 0.01, "step beside that of the pressure wave");
    hard_case("C05", fabs(stiff.depth / fine.depth - 1), 0.03, 0.03, "depth of a punch beside that with half the edge");
    hard_case("C05", stiff.alternating, 0.1, 0.3, "pressures that alternate from element to element, of the mean");
}
END_TEST

// ------------------------------------------------------------------------------------------ friction

// C14. A cube on a held slab, without friction and with more than enough, pulled along by a fifth of its weight.
typedef struct pulled {
    double tangential, slip, way;
} pulled;

static pulled pull(bool points, double friction, double size) {
    const double end = 0.3, along = 2;
    brunt_world_def def = begin(2, 0.1, friction);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh(def_box(&def, "base", XYZ(-0.5, -0.5, 0), XYZ(1.5, 0, 0)), BRUNT_QUAD4, size);
    brunt_body_def *block = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.6, 0.6, 0));
    if (!points) mesh(block, BRUNT_QUAD4, 0.1);
    group(&def, "base", "surface");
    def.gravity[0] = along, def.gravity[1] = -10, def.gravity_ramp = 0.1;
    brunt_world *world = world_take(&def);
    double *start = world_field(world, 1, "position"), low = 1;
    world_until(world, end);
    double *now = world_field(world, 1, "position");
    const int64_t count = points ? brunt_body_particles(world, 1) : brunt_body_nodes(world, 1);
    pulled out = {.way = along * end * end / 2};
    for (int64_t i = 0; i < count; i++) low = fmin(low, start[3 * i + 1]);
    for (int64_t i = 0; i < count; i++)
        if (start[3 * i + 1] < low + 1e-9 && start[3 * i] > 0.2 && start[3 * i] < 0.4)
            out.slip = fmax(out.slip, fabs(now[3 * i] - start[3 * i]));
    free(start), free(now);
    const brunt_reaction f = world_pair(world, 0);
    out.tangential = fabs(f.impulse[0] / f.impulse[1]);
    brunt_world_destroy(world);
    return out;
}

START_TEST(no_friction_and_much) {
    for (int points = 0; points < 2; points++) {
        const char *what = points ? "points" : "mesh";
        hard_case("C14", pull(points, 0, 0.25).tangential, 1e-14, points ? 1e-14 : 1e-5,
                  "no friction, %s on held elements: tangential impulse of the normal one", what);
        const pulled stuck = pull(points, 1e6, 0.25);
        hard_case("C14", stuck.slip / stuck.way, 1e-6, points ? 5e-3 : 1e-3,
                  "friction 1e6, %s on held elements: slip of the way", what);
    }
}
END_TEST

// C20. A block on a plane or on held elements, at a slope a thousandth below and above the threshold, gravity rising
// over many periods: it slides as Coulomb says, or stays. Way in the second after that, of what it is a thousandth
// below. At a friction of a half the slowly sliding elastic block shakes itself loose: parts of it stick and slip in
// turn, as in the continuum, where elastic bodies that slide under Coulomb's law are unstable.
static double slid(bool points, bool plane, double mu, double share) {
    const double T = 2, t = 1, g = 10, slope = atan(mu);
    brunt_world_def def = begin(2, 0.1, mu * share);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    if (plane) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, mu * share);
    } else {
        mesh(def_box(&def, "base", XYZ(-0.5, -0.5, 0), XYZ(1.5, 0, 0)), BRUNT_QUAD4, 0.25);
        group(&def, "base", "surface");
    }
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.8, points ? 0.2 : 0.4, 0));
    if (!points) mesh(b, BRUNT_QUAD4, 0.4); // two elements: more of them shake themselves loose at 0.3 already
    def.gravity[0] = g * sin(slope), def.gravity[1] = -g * cos(slope), def.gravity_ramp = T;
    brunt_world *world = world_take(&def);
    const int block = plane ? 0 : 1;
    world_until(world, T);
    const double start = world_sums(world, block).centre[0];
    world_until(world, T + t);
    const double went = world_sums(world, block).centre[0] - start;
    brunt_world_destroy(world);
    return went / (g * sin(slope) * 1e-3 * (T / 2 * t + t * t / 2));
}

START_TEST(threshold) {
    for (int i = 0; i < 4; i++) {
        const bool points = i & 1, plane = i & 2;
        const char *what = points ? "points" : "mesh", *on = plane ? "a plane" : "held elements";
        hard_case("C20", fabs(slid(points, plane, 0.3, 1 - 1e-3) - 1), 0.1, 0.1,
                  "%s on %s, friction 0.3, a thousandth below: way beside Coulomb's", what, on);
        hard_case("C20", fabs(slid(points, plane, 0.3, 1 + 1e-3)), 0.1, 0.1,
                  "%s on %s, friction 0.3, a thousandth above: way of that below", what, on);
    }
    hard_case("C20", fabs(slid(true, true, 0.5, 1 - 1e-3) - 1), 0.1, 100,
              "points on a plane, friction 0.5, a thousandth below: way beside Coulomb's");
}
END_TEST

// ------------------------------------------------------------------------------------------ time steps

// C18. Two blocks of elements that bounce, at steps of a hundredth of the stable one up to it. Touches that give back
// keep 0.998 of the energy at each (0.957 without); when each node is released is chance, and the rebound is within 1 %
// of their mean, where without it is within 0.2 % of one that is 3.5 % too slow.
typedef struct bounced {
    double impulse, speed, kinetic;
} bounced;

static bounced bounce_elements(double cfl) {
    brunt_world_def def = begin(2, 1, 0);
    def.cfl = cfl;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_velocity(mesh(def_box(&def, "a", XYZ(-0.5, 0, 0), XYZ(0, 0.5, 0)), BRUNT_QUAD4, 0.05), 1, 0, 0);
    def_velocity(mesh(def_box(&def, "b", XYZ(0.1, 0.1, 0), XYZ(0.6, 0.4, 0)), BRUNT_QUAD4, 0.05), -1, 0, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    const brunt_energy e = world_energy(world);
    const bounced out = {world_pair(world, 0).impulse[0], world_sums(world, 1).velocity[0], e.kinetic / e.initial};
    brunt_world_destroy(world);
    return out;
}

START_TEST(step_of_elements) {
    static const double cfl[] = {0.01, 0.1, 0.3, 0.7, 0.9};
    const bounced middle = bounce_elements(0.5);
    double worst = 0;
    for (int i = 0; i < 5; i++) {
        const bounced b = bounce_elements(cfl[i]);
        worst = fmax(worst, fmax(fabs(b.impulse / middle.impulse - 1), fabs(b.speed / middle.speed - 1)));
        worst = fmax(worst, fabs(b.kinetic - middle.kinetic));
    }
    hard_case("C18", worst, 0.01, 0.02, "elements, cfl 0.01 to 0.9: impulse, speed, kinetic energy");
}
END_TEST

// ------------------------------------------------------------------------------------------ tilted meshes

// C22. A uniform pressure through nodes that lie anywhere in the facets of the other side: a block stands on a wider
// one whose mesh is turned against its own by 22 degrees. Poisson's ratio 0 and a base that hardly gives: the exact
// stress is uniform. Means over 25 periods after a slow rise.
START_TEST(turned_meshes) {
    const double p = 1e4, turn = 22 * PI / 180, rise = 1, end = 2;
    brunt_world_def def = begin(3, 1, 0);
    for (int k = 0; k < 2; k++) set(def_material(&def, "neo-hookean", 1000, k ? 1e8 : 1e6, 0), "viscosity", 0);
    brunt_body_def *a = mesh(def_box(&def, "a", XYZ(-1, -1, -0.5), XYZ(1, 1, 0)), BRUNT_HEX8, 0.5);
    a->material = 1;
    brunt_body_def *b = mesh(def_box(&def, "b", XYZ(-0.5, -0.5, 0), XYZ(0.5, 0.5, 0.5)), BRUNT_HEX8, 0.25);
    b->place = brunt_placement_rotate(b->place, XYZ(0, 0, 1), turn, XYZ(0, 0, 0));
    group(&def, "a", "zmin");
    brunt_group_def *top = group(&def, "b", "zmax");
    top->action = BRUNT_GROUP_PRESSURE, top->value[0] = p;
    top->table.points = brunt_def_alloc(2 * sizeof *top->table.points), top->table.count = 2;
    top->table.points[1][0] = rise, top->table.points[1][1] = 1;
    brunt_world *world = world_take(&def);
    enum { SAMPLES = 100, ELEMENTS = 32 };
    double mean[ELEMENTS] = {0}, worst = 0;
    ck_assert_int_eq(brunt_body_elements(world, 1), ELEMENTS);
    world_until(world, rise);
    const double from = world_pair(world, 0).impulse[2], begun = brunt_world_time(world);
    for (int k = 1; k <= SAMPLES; k++) {
        world_until(world, rise + (end - rise) * k / SAMPLES);
        double *s = world_field(world, 1, "stress");
        for (int e = 0; e < ELEMENTS; e++) mean[e] += s[6 * e + 2] / SAMPLES;
        free(s);
    }
    const double force = (world_pair(world, 0).impulse[2] - from) / (brunt_world_time(world) - begun);
    for (int e = 0; e < ELEMENTS; e++) worst = fmax(worst, fabs(mean[e] / p + 1));
    hard_case("C22", fabs(force / p - 1), 0.02, 0.02, "meshes turned by 22 degrees: mean force, relative");
    hard_case("C22", worst, 0.02, 0.02, "meshes turned by 22 degrees: stress of one element, relative");
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("hard contact");
    ADD(cells_and_edges);
    ADD(far_apart);
    ADD(hardly_compressible);
    ADD(no_friction_and_much);
    ADD(threshold);
    ADD(step_of_elements);
    ADD(turned_meshes);
    return suite_main(suite);
}
