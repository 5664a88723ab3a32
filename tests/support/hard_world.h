// What the hard cases have in common: lone particles, bodily shifts, free flight, a spinning ring, two blocks that
// bounce.
#pragma once

#include "tests/support/def_world.h"

// A case of its own for each test, so that CK_RUN_CASE=name runs one alone.
#define ADD(test)                                                                                                      \
    do {                                                                                                               \
        TCase *tests = tcase_create(#test);                                                                            \
        tcase_add_test(tests, test);                                                                                   \
        suite_add_tcase(suite, tests);                                                                                 \
    } while (0)

// One particle of the given size at a place.
static inline brunt_body_def *def_point(brunt_world_def *def, const char *name, const double at[3], double size,
                                        const double v[3]) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) low[a] = at[a] - size / 2, high[a] = at[a] + size / 2;
    brunt_body_def *b = def_box(def, name, low, high);
    b->spacing = size;
    def_velocity(b, v[0], v[1], v[2]);
    return b;
}

// Two rubber blocks of 10 x 10 and 10 x 6 cells, `gap` apart, that meet at 2 m/s.
static inline brunt_world_def def_bounce(double gap, const double shift[3]) {
    brunt_world_def def = def_begin(2, 0.05);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_velocity(def_box(&def, "a", XYZ(-0.5, 0, 0), XYZ(0, 0.5, 0)), 1, 0, 0);
    def_velocity(def_box(&def, "b", XYZ(gap, 0.1, 0), XYZ(gap + 0.5, 0.4, 0)), -1, 0, 0);
    for (int i = 0; i < 2; i++) def.bodies[i].place = brunt_placement_translate(def.bodies[i].place, shift);
    return def;
}

static inline double fastest_particle(brunt_world *world, int body) {
    double *v = world_field(world, body, "velocity"), most = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, body); i++) {
        double speed = sqrt(v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
        ck_assert_msg(isfinite(speed), "particle %d has no finite velocity", (int)i);
        most = fmax(most, speed);
    }
    free(v);
    return most;
}

// Moves a body bodily along an axis; nothing but the grid can tell.
static inline void shift_body(brunt_world *world, const char *body, int axis, double by) {
    char name[96];
    snprintf(name, sizeof name, "bodies/%s/position", body);
    brunt_error error = {0};
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        brunt_state_block block = brunt_state_info(world, b);
        if (strcmp(block.name, name)) continue;
        real *x = malloc((size_t)block.count * sizeof *x);
        brunt_state_get(world, b, x);
        int64_t n = block.count / brunt_world_dimension(world);
        for (int64_t i = 0; i < n; i++) x[axis * n + i] += (real)by;
        ck_assert_int_eq(brunt_state_set(world, b, x, block.count, &error), BRUNT_OK);
        free(x);
        return;
    }
    ck_abort_msg("there is no %s", name);
}

// ------------------------------------------------------------------------------------------ free flight

typedef struct flight {
    double place, velocity, contact, stress, angular, growth;
} flight;

// Root mean square distance of a body's particles from its centre.
static inline double body_size(brunt_world *world, int body) {
    brunt_body_sums s = world_sums(world, body);
    double *x = world_field(world, body, "position"), sum = 0;
    int64_t n = brunt_body_particles(world, body);
    for (int64_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) sum += (x[3 * i + a] - s.centre[a]) * (x[3 * i + a] - s.centre[a]);
    free(x);
    return sqrt(sum / (double)n);
}

// Two small bodies side by side, a third of a cell apart, or one that turns, fly through the grid; errors relative to
// the way and the speed.
static inline flight fly(brunt_kernel kernel, brunt_transfer transfer, int steps, double spin) {
    const double h = 0.1, v[2] = {2, 1.3};
    brunt_world_def def = def_begin(2, h);
    def.kernel = kernel;
    def.transfer = transfer;
    def.cfl = 0.9;
    def.contact.friction = 0.3;
    const double E = kernel == BRUNT_LINEAR ? 1 : 1e4; // no step is stable for the linear kernel where stress matters
    def_material(&def, "neo-hookean", 1000, E, 0.3);
    def_velocity(def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.2, 0.2, 0)), v[0], v[1], 0);
    def_velocity(def_box(&def, "b", XYZ(0.2 + h / 3, 0.03, 0), XYZ(0.4 + h / 3, 0.23, 0)), v[0], v[1], 0);
    const int bodies = spin != 0 ? 1 : 2; // turning bodies grow, and would meet
    def.body_count = bodies;
    def.bodies[0].spin[2] = spin;
    def.bodies[0].spin_about[0] = def.bodies[0].spin_about[1] = 0.1;
    brunt_world *world = world_take(&def);
    brunt_body_sums start[2] = {world_sums(world, 0), world_sums(world, bodies - 1)};
    double size = body_size(world, 0);
    world_steps(world, steps);
    flight f = {0};
    double t = brunt_world_time(world), way = t * hypot(v[0], v[1]);
    for (int i = 0; i < bodies; i++) {
        brunt_body_sums now = world_sums(world, i);
        for (int a = 0; a < 2; a++) {
            f.place = fmax(f.place, fabs(now.centre[a] - start[i].centre[a] - v[a] * t) / way);
            f.velocity = fmax(f.velocity, fabs(now.velocity[a] - v[a]) / hypot(v[0], v[1]));
        }
        double *s = world_field(world, i, "stress");
        for (int64_t k = 0; k < 6 * brunt_body_particles(world, i); k++) f.stress = fmax(f.stress, fabs(s[k]) / E);
        free(s);
    }
    for (int a = 0; a < 3 && bodies == 2; a++) f.contact = fmax(f.contact, fabs(world_pair(world, 0).impulse[a]));
    f.growth = body_size(world, 0) / size - 1;
    f.angular = world_momentum(world).angular_drift;
    brunt_world_destroy(world);
    return f;
}

// ------------------------------------------------------------------------------------------ spin

typedef struct spinning {
    double angular, radius, lost, gained;
} spinning;

static inline double mean_radius(brunt_world *world) {
    double *x = world_field(world, 0, "position"), sum = 0;
    int64_t n = brunt_body_particles(world, 0);
    for (int64_t i = 0; i < n; i++) sum += hypot(x[3 * i], x[3 * i + 1]);
    free(x);
    return sum / (double)n;
}

// A ring of 0.6 to 1 m, its rim at a tenth of the wave speed. Drift of angular momentum, of the mean radius from the
// first turn to the last (averaged over each: the ring breathes), of the energy, and the most it gained in an eighth of
// a turn.
static inline spinning spin_ring(double cell, int turns) {
    brunt_world_def def = def_begin(2, cell);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *b = def_body(&def, "ring");
    b->shape.kind = BRUNT_TUBE;
    b->shape.radius = 1, b->shape.inner_radius = 0.6;
    b->spin[2] = 1;
    brunt_world *world = world_take(&def);
    double first = 0, last = 0, turn = 2 * PI, before = 0;
    spinning s = {0};
    brunt_energy e = world_energy(world);
    before = e.kinetic + e.internal;
    for (int k = 1; k <= 8 * turns; k++) {
        world_until(world, turn * k / 8);
        double r = mean_radius(world);
        if (k <= 8) first += r / 8;
        if (k > 8 * (turns - 1)) last += r / 8;
        e = world_energy(world);
        s.gained = fmax(s.gained, (e.kinetic + e.internal - before) / e.initial);
        before = e.kinetic + e.internal;
    }
    s.lost = 1 - before / e.initial;
    s.radius = fabs(last / first - 1);
    s.angular = world_momentum(world).angular_drift;
    brunt_world_destroy(world);
    return s;
}
