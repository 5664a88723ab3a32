// Bodies of material points that meet where their surfaces touch: conserved quantities, mirror images, the order of the
// two, bodies that are held, light, soft or no more than a point.
#include "tests/support/def_world.h"

static brunt_world_def touching(int dimension, double cell, double friction) {
    brunt_world_def def = def_begin(dimension, cell);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = friction;
    return def;
}

// ------------------------------------------------------------------------------------------ mirrors

// A block comes down on a lower one, off its middle along x and turning: all of it, half or a quarter.
static brunt_world *cut(int halves, double friction) {
    brunt_world_def def = touching(3, 0.25, friction);
    const double low[3] = {-1, -0.5, -1}, top[3] = {-0.5, 0.02, -0.5};
    def_box(&def, "low", XYZ(halves > 0 ? 0 : low[0], -0.5, halves > 1 ? 0 : low[2]), XYZ(1, 0, 1));
    def_velocity(
        def_box(&def, "top", XYZ(halves > 0 ? 0 : top[0], top[1], halves > 1 ? 0 : top[2]), XYZ(0.5, 0.52, 0.5)), 0, -2,
        0);
    if (halves > 0) def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
    if (halves > 1) def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SYMMETRY, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.05);
    return world;
}

START_TEST(symmetry_planes_stand_for_the_rest) {
    double speed[3], centre[3];
    for (int halves = 0; halves < 3; halves++) {
        brunt_world *world = cut(halves, 0.5);
        const brunt_momentum m = world_momentum(world);
        const brunt_body_sums s = world_sums(world, 1);
        printf("  %d cuts: speed %.12f m/s, drift %.1e and %.1e\n", halves, s.velocity[1], m.linear_drift,
               m.angular_drift);
        speed[halves] = s.velocity[1], centre[halves] = s.centre[1];
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        ck_assert_double_lt(m.angular_drift, ROUNDING);
        brunt_world_destroy(world);
    }
    ck_assert_double_gt(speed[0], -1.5);
    for (int halves = 1; halves < 3; halves++) {
        ck_assert_double_eq_tol(speed[halves], speed[0], 5e-4); // directions beside a plane are those of half a surface
        ck_assert_double_eq_tol(centre[halves], centre[0], 1e-5);
    }
}
END_TEST

// Between two planes three cells apart a node has images by both, the same at times.
START_TEST(strips_between_symmetry_planes_keep_momentum) {
    brunt_world_def def = touching(2, 0.25, 0.3);
    def_velocity(def_box(&def, "left", XYZ(-1, 0, 0), XYZ(0, 0.75, 0)), 3, 0, 0);
    def_box(&def, "right", XYZ(0, 0, 0), XYZ(1, 0.75, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, 0.75, 0), XYZ(0, -1, 0), BRUNT_SYMMETRY, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.05);
    const brunt_momentum m = world_momentum(world);
    ck_assert_double_gt(fabs(world_pair(world, 0).impulse[0]), 100);
    ck_assert_double_lt(m.linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ bodies and names

// A disk meets a block obliquely; seen in a mirror, and with the two in the other order. Its velocity and spin about
// the centre.
static void oblique(double side, bool swap, double out[3]) {
    brunt_world_def def = touching(2, 0.125, 0.4);
    def_velocity(def_ball(&def, swap ? "b" : "a", XYZ(0.01 * side, 0.51, 0), 0.5), 1.5 * side, -3, 0);
    def_box(&def, swap ? "a" : "b", XYZ(-0.75, -0.5, 0), XYZ(0.75, 0, 0));
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    const brunt_momentum m = world_momentum(world);
    const brunt_body_sums s = world_sums(world, swap);
    double *x = world_field(world, swap, "position"), *v = world_field(world, swap, "velocity");
    out[0] = s.velocity[0] * side, out[1] = s.velocity[1], out[2] = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, swap); i++)
        out[2] += side * ((x[3 * i] - s.centre[0]) * v[3 * i + 1] - (x[3 * i + 1] - s.centre[1]) * v[3 * i]);
    ck_assert_double_lt(m.linear_drift, ROUNDING);
    ck_assert_double_lt(m.angular_drift, ROUNDING);
    free(x), free(v);
    brunt_world_destroy(world);
}

START_TEST(mirrored_and_swapped_it_is_the_same) {
    double plain[3], other[3];
    oblique(1, false, plain);
    printf("  after a blow: %.6f and %.6f m/s, %.6f m^2/s\n", plain[0], plain[1], plain[2]);
    ck_assert_double_gt(plain[1], -1.4); // -1.5 if they stayed together
    ck_assert_double_lt(plain[2], -1);
    for (int i = 1; i < 4; i++) {
        oblique(i & 1 ? -1 : 1, i & 2, other);
        printf("  differs by %.1e, %.1e, %.1e\n", other[0] - plain[0], other[1] - plain[1], other[2] - plain[2]);
        for (int a = 0; a < 3; a++)
            ck_assert_double_eq_tol(other[a], plain[a], sizeof(real) == sizeof(double) ? 1e-10 : 2e-2);
    }
}
END_TEST

// Two blocks meet head on, the first ten thousand times as heavy or as stiff, or the second: none passes into the
// other, and contact makes no energy.
START_TEST(heavy_meets_light_and_stiff_soft) {
    static const double density[] = {1000, 1e7, 1000, 1000, 1000}, other[] = {1000, 1000, 1e7, 1000, 1000},
                        E[] = {1e6, 1e6, 1e6, 1e8, 1e6}, other_E[] = {1e6, 1e6, 1e6, 1e6, 1e8};
    brunt_world_def def = touching(2, 0.25, 0.2);
    def.materials[0].density = density[_i], def.materials[0].strength_parameters[0] = E[_i];
    def_material(&def, "neo-hookean", other[_i], other_E[_i], 0.3);
    def_velocity(def_box(&def, "a", XYZ(-1, 0, 0), XYZ(0, 1, 0)), 2, 0, 0);
    def_box(&def, "b", XYZ(0.01, 0, 0), XYZ(1.01, 1, 0))->material = 1;
    brunt_world *world = world_take(&def);
    double deepest = -INFINITY;
    while (brunt_world_time(world) < 0.1) {
        world_steps(world, 1);
        double *a = world_field(world, 0, "position"), *b = world_field(world, 1, "position"), right = -9, left = 9;
        for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) right = fmax(right, a[3 * i]);
        for (int64_t i = 0; i < brunt_body_particles(world, 1); i++) left = fmin(left, b[3 * i]);
        deepest = fmax(deepest, right - left);
        free(a), free(b);
    }
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    printf("  %d: centres at their nearest %.4f spacings apart; contact %.2e J, error %.1e\n", _i, -deepest / 0.125,
           e.contact, e.error_relative);
    ck_assert_double_lt(deepest, 0);
    ck_assert_double_lt(m.linear_drift, ROUNDING);
    ck_assert_double_lt(m.angular_drift, ROUNDING);
    ck_assert_double_ge(e.contact, 0);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

// Bodies of one point each. What they were to do when they touched is done, and no more: they part no faster.
START_TEST(points_alone_meet) {
    for (int dimension = 2; dimension <= 3; dimension++) {
        brunt_world_def def = touching(dimension, 0.25, 0.3);
        for (int i = 0; i < 2; i++) {
            const double at = i ? 0.4 : 0;
            brunt_body_def *body = def_box(&def, i ? "b" : "a", XYZ(at, 0, 0), XYZ(at + 0.25, 0.25, 0.25));
            body->particles_per_cell = 1;
            def_velocity(body, i ? -1 : 2, 0.3 * i, 0);
        }
        brunt_world *world = world_take(&def);
        ck_assert_int_eq((int)brunt_body_particles(world, 0), 1);
        world_until(world, 0.3);
        const brunt_momentum m = world_momentum(world);
        ck_assert_double_lt(world_sums(world, 0).centre[0], world_sums(world, 1).centre[0] - 0.2);
        ck_assert_double_eq_tol(world_sums(world, 0).velocity[0], 0.5, 0.02);
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        ck_assert_double_lt(m.angular_drift, ROUNDING);
        brunt_world_destroy(world);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ the same bits

static brunt_world_def falling(int dimension, int threads) {
    brunt_world_def def = touching(dimension, 0.25, 0.3);
    def.threads = threads;
    def_velocity(def_ball(&def, "ball", XYZ(0, 0.75, 0), 0.7), 3, -20, 1);
    def_box(&def, "bed", XYZ(-1, -0.5, -1), XYZ(1, 0, 1));
    def_plane(&def, XYZ(0, -0.5, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.3);
    return def;
}

START_TEST(any_number_of_threads_and_restarts) {
    brunt_world_def one = falling(2 + _i, 1), many = falling(2 + _i, 3);
    brunt_world *a = world_take(&one), *b = world_take(&many);
    for (int s = 0; s < 12; s++) {
        brunt_world_def def = falling(2 + _i, 1);
        brunt_world *restored = world_take(&def);
        world_copy_state(a, restored);
        world_steps(a, 4), world_steps(b, 4), world_steps(restored, 4);
        ck_assert_uint_eq(brunt_world_hash(a), brunt_world_hash(b));
        ck_assert_uint_eq(brunt_world_hash(a), brunt_world_hash(restored));
        brunt_world_destroy(restored);
    }
    ck_assert_double_gt(fabs(world_pair(a, 0).impulse[1]), 0);
    brunt_world_destroy(a);
    brunt_world_destroy(b);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("points_touch");
    ADD_LOOP(symmetry_planes_stand_for_the_rest, 1);
    ADD_LOOP(strips_between_symmetry_planes_keep_momentum, 1);
    ADD_LOOP(mirrored_and_swapped_it_is_the_same, 1);
    ADD_LOOP(heavy_meets_light_and_stiff_soft, 5);
    ADD_LOOP(points_alone_meet, 1);
    ADD_LOOP(any_number_of_threads_and_restarts, 2);
    return suite_main(suite);
}
