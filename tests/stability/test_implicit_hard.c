// Labels: stability
// Hard cases of implicit steps and barriers: steps up to 1000 times those of explicit ones, stiffness of contact and
// moduli over many powers of ten, a single particle, bodies that nothing holds. Each step converges or ends with a
// reason.
#include <math.h>

#include "tests/support/def_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double cell = 0.1, modulus = 1e6;

static brunt_world_def begin(double step) {
    brunt_world_def def = def_begin(2, cell);
    def_material(&def, "neo-hookean", 1000, modulus, 0.3);
    def.scheme = BRUNT_IMPLICIT, def.integrator = BRUNT_EULER, def.step = step;
    def.contact.method = BRUNT_CONTACT_BARRIER;
    def.groups = brunt_def_alloc(DEF_ROOM * sizeof *def.groups);
    return def;
}

static brunt_body_def *mesh(brunt_body_def *b, double size) {
    b->method = BRUNT_FEM, b->element = BRUNT_TRI3, b->size = size;
    return b;
}

static void hold(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", group);
}

static brunt_newton_counts counts_of(const brunt_world *world) {
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    return counts;
}

// ------------------------------------------------------------------------------------------ any step

enum { COLUMNS = 24 }; // of the sheet

// Particles below the upper side of the sheet, whose nodes are `upper` from left to right, or below the floor.
static int wrong_sides(brunt_world *world, const int *upper) {
    double *x = world_field(world, 0, "position"), *sheet = world_field(world, 2, "position");
    int wrong = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) {
        double highest = -INFINITY;
        for (int k = 0; k < COLUMNS; k++) {
            const double *a = sheet + 3 * upper[k], *b = sheet + 3 * upper[k + 1], at = x[3 * i];
            if ((a[0] - at) * (b[0] - at) <= 0 && a[0] != b[0])
                highest = fmax(highest, a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0]));
        }
        wrong += x[3 * i + 1] <= highest || x[3 * i + 1] <= 0;
    }
    free(x), free(sheet);
    return wrong;
}

// A heavy block of points is thrown at a thin sheet, held at its ends over a held floor, by steps of 1 to 1000 times
// h/c, in which it could go 8 cells: it stays above, no step fails, and no gap closes.
START_TEST(nothing_passes_a_sheet) {
    const double courant = pow(10, _i % 4), speed = _i / 4 ? 3 : 0.3;
    brunt_world_def def = begin(courant * cell / sqrt(modulus * 1.35 / 1000));
    snprintf(def_material(&def, "neo-hookean", 3000, modulus, 0.3)->name, 8, "heavy");
    brunt_body_def *block = def_box(&def, "block", XYZ(-0.3, 0.6, 0), XYZ(0.3, 1.2, 0));
    block->material = 1, block->spacing = 0.05;
    def_velocity(block, 0, -speed, 0);
    mesh(def_box(&def, "sheet", XYZ(-2, 0.5, 0), XYZ(2, 0.55, 0)), 4.0 / COLUMNS);
    mesh(def_box(&def, "floor", XYZ(-3, -0.3, 0), XYZ(3, 0, 0)), 0.3);
    hold(&def, "floor", "surface"), hold(&def, "sheet", "xmin"), hold(&def, "sheet", "xmax");
    def.contact.distance = 0.01, def.newton.cut = 0;
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    double *at = world_field(world, 2, "position");
    int upper[COLUMNS + 1], found = 0;
    for (int n = 0; n < brunt_body_size(world, 2, BRUNT_AT_NODES); n++)
        if (at[3 * n + 1] > 0.54) {
            const int k = (int)lround((at[3 * n] + 2) / 4 * COLUMNS);
            ck_assert_int_le(k, COLUMNS);
            upper[k] = n, found++;
        }
    free(at);
    ck_assert_int_eq(found, COLUMNS + 1);
    const int steps = _i % 4 ? 40 : 120;
    int wrong = 0;
    for (int s = 0; s < steps; s++) {
        world_steps(world, 1);
        wrong += wrong_sides(world, upper);
    }
    const brunt_newton_counts c = counts_of(world);
    printf("  %g h/c, %.3g m/s: %.1f iterations a step, worst %g, least gap %.3g of the distance, drift %.1e\n",
           courant, speed, (double)c.iterations / steps, (double)c.iterations_worst, c.least_part,
           world_momentum(world).linear_drift);
    ck_assert_int_eq(wrong, 0);
    if (isfinite(c.least_part)) ck_assert_double_gt(c.least_part, 1e-3);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ converge or say why

// Steps until one fails. What failed says why; what did not has finite energies, open gaps and an account that closes.
static void take_steps(brunt_world *world, int count, const char *what) {
    brunt_error error = {0};
    int status = BRUNT_OK, s = 0;
    for (; s < count && !status; s++) status = brunt_world_step(world, INFINITY, &error);
    const brunt_newton_counts c = counts_of(world);
    const brunt_energy e = world_energy(world);
    printf("  %s: %s, %d steps, %.1f iterations each, least gap %.3g, energy error %.1e, drift %.1e\n", what,
           status ? error.message : "converges", s, (double)c.iterations / s, c.least_part, e.error_relative,
           world_momentum(world).linear_drift);
    if (status) {
        ck_assert_int_eq(status, BRUNT_FAILED);
        ck_assert_int_gt((int)strlen(error.message), 20);
        return;
    }
    ck_assert(isfinite(e.kinetic) && isfinite(e.internal));
    ck_assert_double_le(fabs(e.error_relative), 1e-3);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-6);
    ck_assert_double_gt(c.least_part, 0);
}

// A block of points falls on a held one of elements, with `stiffness` times the default, which is 0.1 E.
START_TEST(stiffness) {
    const double factor = pow(10, 2 * _i - 4);
    char what[64];
    snprintf(what, sizeof what, "stiffness %g times the default", factor);
    brunt_world_def def = begin(2e-2);
    mesh(def_box(&def, "floor", XYZ(-0.4, -0.4, 0), XYZ(0.8, 0, 0)), 0.2);
    hold(&def, "floor", "ymin");
    def_velocity(def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0)), 0, -1, 0);
    def.contact.distance = 0.01, def.contact.stiffness = 0.1 * modulus * factor;
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    take_steps(world, 40, what);
    brunt_world_destroy(world);
}
END_TEST

// Two blocks, one a million times as stiff as the other, of elements and of points.
START_TEST(moduli) {
    brunt_world_def def = begin(1e-2);
    snprintf(def_material(&def, "neo-hookean", 1000, 1e6 * modulus, 0.3)->name, 8, "hard");
    brunt_body_def *below = mesh(def_box(&def, "below", XYZ(-0.4, -0.4, 0), XYZ(0.8, 0, 0)), 0.2),
                   *block = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0));
    hold(&def, "below", "ymin");
    (_i ? below : block)->material = 1;
    def_velocity(block, 0, -1, 0);
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    take_steps(world, 40, _i ? "hard below soft" : "hard on soft");
    brunt_world_destroy(world);
}
END_TEST

// One particle falls on a held block, by steps of 1 and of 1000 times h/c.
START_TEST(single_particle) {
    brunt_world_def def = begin((_i ? 1000 : 1) * cell / 36);
    def.newton.tolerance = 1e-9; // steps of seconds: a millionth of the wave speed is a hundredth of the barrier
    mesh(def_box(&def, "floor", XYZ(-0.4, -0.4, 0), XYZ(0.8, 0, 0)), 0.2);
    hold(&def, "floor", "surface");
    def_box(&def, "grain", XYZ(0.1, 0.1, 0), XYZ(0.2, 0.2, 0))->spacing = 0.1;
    def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    ck_assert_int_eq((int)brunt_body_particles(world, 1), 1);
    take_steps(world, 60, "a single particle");
    brunt_world_destroy(world);
}
END_TEST

// Two bodies that nothing holds meet, by steps of 1000 times h/c and of a millionth of that.
START_TEST(nothing_holds) {
    brunt_world_def def = begin((_i ? 1e-3 : 1000) * cell / 36);
    def_velocity(mesh(def_box(&def, "left", XYZ(-0.5, 0, 0), XYZ(-0.01, 0.5, 0)), 0.25), 1, 0, 0);
    def_velocity(mesh(def_box(&def, "right", XYZ(0.01, 0.1, 0), XYZ(0.5, 0.6, 0)), 0.25), -1, 0, 0);
    brunt_world *world = world_take(&def);
    take_steps(world, 20, "bodies that nothing holds");
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_hard");
    ADD_LOOP(nothing_passes_a_sheet, 8);
    ADD_LOOP(stiffness, 5);
    ADD_LOOP(moduli, 2);
    ADD_LOOP(single_particle, 2);
    ADD_LOOP(nothing_holds, 2);
    return suite_main(suite);
}
#endif
