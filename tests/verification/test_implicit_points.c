// Implicit steps of material points: free fall, momentum, energy, rest under gravity, threads, all kernels and
// transfers; ties; against explicit steps.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const struct {
    brunt_kernel kernel;
    brunt_transfer transfer;
    const char *name;
} ways[] = {{BRUNT_QUADRATIC, BRUNT_APIC, "quadratic apic"}, {BRUNT_QUADRATIC, BRUNT_FLIP, "quadratic flip"},
            {BRUNT_QUADRATIC, BRUNT_PIC, "quadratic pic"},   {BRUNT_CUBIC, BRUNT_APIC, "cubic apic"},
            {BRUNT_CUBIC, BRUNT_FLIP, "cubic flip"},         {BRUNT_LINEAR, BRUNT_FLIP, "linear flip"},
            {BRUNT_LINEAR, BRUNT_PIC, "linear pic"}};
enum { WAYS = sizeof ways / sizeof *ways };

static brunt_world_def points(int dim, int way, brunt_integrator integrator, double step) {
    brunt_world_def def = def_begin(dim, 0.125);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.kernel = ways[way].kernel, def.transfer = ways[way].transfer;
    go_implicit(&def, integrator, step);
    return def;
}

// ------------------------------------------------------------------------------------------ moving as a whole

START_TEST(free_fall) {
    const int way = _i / 2;
    const bool newmark = _i % 2;
    brunt_world_def def = points(2, way, newmark ? BRUNT_NEWMARK : BRUNT_EULER, 0.0625);
    def_velocity(def_box(&def, "block", XYZ(0.01, 0.02, 0), XYZ(0.51, 0.52, 0)), 3, 1, 0);
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[1];
    world_steps(world, 8);
    const brunt_body_sums s = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    printf("  %s: fall off by %.1e, drift %.1e, energy error %.1e\n", ways[way].name,
           s.centre[1] - before - 0.5 + (newmark ? 10 * 0.125 : 10 * 0.5 * 0.5625 / 2),
           world_momentum(world).linear_drift, e.error_relative);
    ck_assert_double_eq_tol(s.velocity[1], 1 - 5, 1e-8);
    ck_assert_double_eq_tol(s.velocity[0], 3, 1e-8);
    ck_assert_double_eq_tol(s.centre[1] - before, 0.5 - (newmark ? 10 * 0.125 : 10 * 0.5 * 0.5625 / 2), 1e-8);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-7);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ momentum and energy

START_TEST(turns) {
    const int way = _i / 2;
    brunt_world_def def = points(2, way, _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER, 0.01);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.01, 0.02, 0), XYZ(0.51, 0.52, 0));
    def_velocity(b, 1, 2, 0);
    b->spin[2] = 2, b->spin_about[0] = 0.26, b->spin_about[1] = 0.27;
    brunt_world *world = world_take(&def);
    world_steps(world, 50);
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    printf("  %s %s: linear %.1e, angular %.1e, energy error %.1e, transfer %.2e, scheme %.2e\n",
           _i % 2 ? "newmark" : "euler", ways[way].name, m.linear_drift, m.angular_drift, e.error_relative,
           e.transfer / e.initial, e.scheme / e.initial);
    ck_assert_double_le(m.linear_drift, 1e-10);
    if (ways[way].transfer == BRUNT_APIC) ck_assert_double_le(m.angular_drift, 2e-2);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// A block that rings: every way that energy goes is booked.
START_TEST(rings) {
    const int way = _i / 2;
    brunt_world_def def = points(2, way, _i % 2 ? BRUNT_NEWMARK : BRUNT_EULER, 2e-3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.01, 0.02, 0), XYZ(1.01, 0.52, 0));
    b->wave_velocity[0] = 2, b->wave_vector[0] = PI, b->wave_phase = PI / 2 - 0.01 * PI;
    brunt_world *world = world_take(&def);
    world_steps(world, 60);
    const brunt_energy e = world_energy(world);
    printf("  %s %s: error %.1e, kinetic %.3f, internal %.3f, transfer %.3f, scheme %.3f of %.4g J\n",
           _i % 2 ? "newmark" : "euler", ways[way].name, e.error_relative, e.kinetic / e.initial,
           e.internal / e.initial, e.transfer / e.initial, e.scheme / e.initial, e.initial);
    ck_assert_double_le(fabs(e.error_relative), 1e-5);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    if (!(_i % 2)) ck_assert_double_ge(e.scheme, 0);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ ties

// Second moments of all material points about their centre [m^2]: xx, yy, xy. What parts, or turns otherwise, has
// others.
static void second_moments(brunt_world *world, double moment[3]) {
    double n = 0, sum[2] = {0}, square[3] = {0};
    for (int b = 0; b < brunt_body_count(world); b++) {
        double *x = world_field(world, b, "position");
        for (int64_t i = 0; i < brunt_body_particles(world, b); i++) {
            const double *at = x + 3 * i;
            n++, sum[0] += at[0], sum[1] += at[1];
            square[0] += at[0] * at[0], square[1] += at[1] * at[1], square[2] += at[0] * at[1];
        }
        free(x);
    }
    for (int a = 0; a < 3; a++) moment[a] = square[a] / n - sum[a == 1] / n * sum[a != 0] / n;
}

// A block that turns, cut in two that are tied, moves as the whole does; the halves alone would fly apart. With a
// matrix and without.
START_TEST(tied) {
    double moment[2][3];
    for (int cut = 0; cut < 2; cut++) {
        brunt_world_def def = points(2, 0, BRUNT_NEWMARK, 5e-3);
        if (cut) {
            def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.5, 0.5, 0))->spin[2] = 5;
            def_box(&def, "b", XYZ(0.5, 0, 0), XYZ(1, 0.5, 0))->spin[2] = 5;
            def.contact.method = BRUNT_CONTACT_TIED;
        } else {
            def_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 0.5, 0))->spin[2] = 5;
        }
        def.gravity[0] = 20;
        if (_i) def.newton.solver = BRUNT_SOLVER_MATRIX_FREE, def.newton.accuracy = 1e-9;
        brunt_world *world = world_take(&def);
        world_steps(world, 30);
        second_moments(world, moment[cut]);
        ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
        brunt_world_destroy(world);
    }
    printf("  second moments (%.9g, %.9g, %.9g), of two parts (%.9g, %.9g, %.9g) m^2\n", moment[0][0], moment[0][1],
           moment[0][2], moment[1][0], moment[1][1], moment[1][2]);
    for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(moment[0][a], moment[1][a], 1e-7);
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

static brunt_world *shaken(int which, int threads) {
    brunt_world_def def = points(3, which % 2, BRUNT_NEWMARK, 2e-3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.01, 0.02, 0.03), XYZ(0.51, 0.52, 0.53));
    b->spin[0] = 5;
    def.gravity[2] = -50;
    def.newton.solver = which / 2 ? BRUNT_SOLVER_MATRIX_FREE : BRUNT_SOLVER_PCG;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {shaken(_i, 1), shaken(_i, 2), shaken(_i, 3)};
    check_threads(world, 3, 3);
}
END_TEST

START_TEST(restart) { check_restart(shaken(_i, 1), shaken(_i, 2)); }
END_TEST

// ------------------------------------------------------------------------------------------ beside explicit steps

// At small steps both schemes are the same motion: a block that rings for half a period.
START_TEST(as_explicit) {
    double internal[2], width[2];
    for (int implicit = 0; implicit < 2; implicit++) {
        brunt_world_def def = points(2, 0, BRUNT_NEWMARK, 2e-5);
        if (!implicit) def.scheme = BRUNT_EXPLICIT;
        brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.5, 0));
        b->wave_velocity[0] = 2, b->wave_vector[0] = PI, b->wave_phase = PI / 2;
        brunt_world *world = world_take(&def);
        world_until(world, 0.01);
        internal[implicit] = world_energy(world).internal / world_energy(world).initial;
        width[implicit] = world_sums(world, 0).high[0] - world_sums(world, 0).low[0];
        brunt_world_destroy(world);
    }
    printf("  explicit %.6f of the energy stored, %.8g m wide; implicit %.6f, %.8g m\n", internal[0], width[0],
           internal[1], width[1]);
    ck_assert_double_eq_tol(internal[0], internal[1], 3e-3);
    ck_assert_double_eq_tol(width[0], width[1], 1e-3 * (1 - width[0]));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_points");
    ADD_LOOP(free_fall, 2 * WAYS);
    ADD_LOOP(turns, 2 * WAYS);
    ADD_LOOP(rings, 2 * WAYS);
    ADD_LOOP(tied, 2);
    ADD_LOOP(threads, 4);
    ADD_LOOP(restart, 4);
    ADD_LOOP(as_explicit, 1);
    return suite_main(suite);
}
#endif
