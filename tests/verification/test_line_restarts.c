// Lines, meshes and planes that hold points, where steps are cut: what goes on from the end of any step, between the
// parts of one that was cut too, is the run that went through, to every bit.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // load steps want double
#else

static const double CELL = 0.1;

static brunt_world_def begin(int dim, int load_steps, const char *model) {
    brunt_world_def def = def_begin(dim, CELL);
    def_material(&def, model, 1000, 1e6, 0.3);
    hold_by_surfaces(&def, 2, 0.25);
    def.end = 1;
    if (load_steps) def.scheme = BRUNT_STATIC, def.load_steps = load_steps, def.step = 0, def.end = 0;
    def.newton.tolerance = load_steps ? 1e-10 : 1e-12;
    def.newton.cut = 8;
    return def;
}

// Goes there until the end.
static void goes(brunt_boundary_surface_def *s, double x, double y, double angle) {
    static const double there[2][2] = {{0, 0}, {1, 1}};
    s->displacement = true, s->value[0] = x, s->value[1] = y, s->rotation.angle = angle;
    s->table.points = brunt_alloc(sizeof there), s->table.count = 2;
    memcpy(s->table.points, there, sizeof there);
}

// A line, that rubs, comes onto a block from afar.
static void from_above(brunt_world_def *def, double gap) {
    brunt_boundary_surface_def *q = def_line(def, 2, 0.52 + gap, -1, 0.52 + gap, BRUNT_SEPARATE);
    q->friction = 0.3;
    goes(q, 0.01, -gap - 0.02, 0);
}

static brunt_world_def pressed(void) {
    brunt_world_def def = begin(2, 2, "neo-hookean");
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.53, 0.52, 0));
    def_line(&def, -1, 0.02, 2, 0.02, BRUNT_SEPARATE)->friction = 0.3;
    from_above(&def, 0.7);
    return def;
}

static brunt_world_def before_planes(void) {
    brunt_world_def def = begin(2, 2, "neo-hookean");
    def_box(&def, "block", XYZ(0.03, 0.02, 0), XYZ(0.53, 0.52, 0));
    def_plane(&def, XYZ(0, 0.02, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    def_plane(&def, XYZ(0.03, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    from_above(&def, 0.7);
    return def;
}

// A block is turned by the line that it sticks to, by more in a step than one may.
static brunt_world_def turned(void) {
    brunt_world_def def = begin(2, 2, "neo-hookean");
    def_box(&def, "block", XYZ(0.13, 0.02, 0), XYZ(0.53, 0.42, 0));
    goes(def_line(&def, 0.13, 0.02, 0.53, 0.02, BRUNT_STICK), 0.1, 0, 4);
    def.gravity[1] = -1;
    return def;
}

static brunt_world_def in_space(void) {
    brunt_world_def def = begin(3, 1, "neo-hookean");
    def_box(&def, "block", XYZ(0.03, 0.03, 0.02), XYZ(0.23, 0.23, 0.22));
    for (int k = 0; k < 2; k++) {
        brunt_boundary_surface_def *s = def_polyline(&def, 4, true, BRUNT_SEPARATE);
        for (int i = 0; i < 4; i++)
            s->point[i][0] = i % 3 ? 0.5 : -0.3, s->point[i][1] = (i < 2) != k ? -0.3 : 0.5,
            s->point[i][2] = k ? 1.02 : 0.02;
        s->facet_count = 1, memcpy(s->facet[0], (const int32_t[4]){0, 1, 2, 3}, sizeof s->facet[0]);
        s->friction = 0.3;
        if (k) goes(s, 0, 0, 0), s->value[2] = -0.81;
    }
    return def;
}

// Falls onto a line within a step, or is thrown at it.
static brunt_world_def falls(brunt_integrator integrator, const char *model) {
    brunt_world_def def = begin(2, 0, model);
    def_velocity(def_box(&def, "block", XYZ(0.03, 0.32, 0), XYZ(0.43, 0.72, 0)), 1, -2, 0);
    def_line(&def, -1, 0.02, 4, 0.02, BRUNT_SEPARATE)->friction = 0.3;
    def.gravity[1] = -9.81;
    def.integrator = integrator;
    return def;
}

static brunt_world_def any(int k) {
    static brunt_world_def (*const still[])(void) = {pressed, before_planes, turned, in_space};
    if (k < 4) return still[k]();
    brunt_world_def def = falls(k % 2 ? BRUNT_NEWMARK : BRUNT_EULER, k < 6 ? "neo-hookean" : "mohr-coulomb");
    if (k == 6) {
        def.materials[0].strength_parameters[2] = 1e3, def.materials[0].strength_parameters[3] = 0.4;
        def_velocity(&def.bodies[0], 1, -3, 0);
        def.step = 0.1, def.end = 0.2;
    }
    return def;
}
enum { CASES = 7 };

static brunt_world *make(int k, int threads) {
    brunt_world_def def = any(k);
    def.threads = threads;
    return world_take(&def);
}

static void check_same(brunt_world *a, brunt_world *b) {
    brunt_newton_counts n[2];
    const brunt_energy e = world_energy(a), f = world_energy(b);
    ck_assert_uint_eq(brunt_world_hash(a), brunt_world_hash(b));
    brunt_world_newton(a, &n[0], NULL), brunt_world_newton(b, &n[1], NULL);
    ck_assert_mem_eq(&n[0], &n[1], sizeof n[0]);
    ck_assert_mem_eq(&e, &f, sizeof e);
    for (int w = 0; w < brunt_boundary_count(a); w++) {
        const brunt_reaction r = world_boundary(a, w), s = world_boundary(b, w);
        ck_assert_mem_eq(&r, &s, sizeof r);
    }
    for (int k = 0; k < brunt_boundary_surface_count(a); k++) {
        brunt_boundary_surface_report r[2];
        memset(r, 0, sizeof r);
        brunt_boundary_surface_read(a, k, &r[0]), brunt_boundary_surface_read(b, k, &r[1]);
        ck_assert_mem_eq(&r[0], &r[1], sizeof r[0]);
    }
}

START_TEST(from_any_step) {
    enum { LIMIT = 400 };
    brunt_world *world = make(_i, 1), *fresh[LIMIT];
    brunt_newton_counts n;
    const double end = _i == 6 ? 0.2 : 1;
    int steps = 0;
    for (; brunt_world_time(world) < end && steps < LIMIT; steps++) {
        if (steps) fresh[steps] = make(_i, 1 + steps % 2), world_copy_state(world, fresh[steps]);
        world_steps(world, 1);
        for (int s = 1; s <= steps; s++) world_steps(fresh[s], 1);
    }
    brunt_world_newton(world, &n, NULL);
    printf("  case %d: %d steps, %g cuts\n", _i, steps, n.cuts);
    ck_assert_double_gt(n.cuts, 0);
    ck_assert_double_eq(brunt_world_time(world), end);
    for (int s = 1; s < steps; s++) check_same(world, fresh[s]), brunt_world_destroy(fresh[s]);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("line_restarts");
    ADD_LOOP(from_any_step, CASES);
    return suite_main(suite);
}
#endif
