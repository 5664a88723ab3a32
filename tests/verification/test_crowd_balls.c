// Crowds of balls, in explicit steps and in load steps: each is the ball that it would be by itself, they stay apart
// and within their box, and what presses them goes through them.
#include "tests/support/def_world.h"
#include "tests/support/small_scene.h"

static const char falling[] =
    "brunt: 1\ntitle: balls fall into a box\ndimension: 3\ntime: {end: 10 s, cfl: 0.5}\n"
    "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\n"
    "bodies:\n"
    "  grains: {method: fem, element: tet4, size: 25 mm, material: rubber, velocity: [0.5, 0.2, -1],\n"
    "    crowd: {lattice: square, count: [2, 3, 2], radius: 40 mm, radius_spread: 0.1, gap: 4 mm}, place: [{translate: "
    "[0, 0, 5 mm]}]}\n"
    "contact: {friction: 0.3}\n"
    "boundaries:\n"
    "  - {name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate, friction: 0.3}\n"
    "  - {name: west, plane: {point: [-10 mm, 0, 0], normal: [1, 0, 0]}, condition: separate}\n"
    "  - {name: east, plane: {point: [200 mm, 0, 0], normal: [-1, 0, 0]}, condition: separate}\n"
    "  - {name: south, plane: {point: [0, -10 mm, 0], normal: [0, 1, 0]}, condition: separate}\n"
    "  - {name: north, plane: {point: [0, 292 mm, 0], normal: [0, -1, 0]}, condition: separate}\n"
    "loads: {gravity: [0, 0, -9.81]}\n";
enum { BALLS = 12, STEPS = 2500 };
static const double RADIUS = 0.04;

static brunt_world *falling_world(int threads) {
    brunt_scene scene;
    small_scene_of(falling, &scene, NULL, 0);
    scene.world.threads = threads;
    brunt_world *world = small_world(&scene);
    ck_assert_int_eq(brunt_body_count(world), BALLS);
    brunt_scene_free(&scene);
    return world;
}

// Nothing is nearer to another ball, or to a wall, than a fifth of a radius less than round ones would be:
// meshes are coarse, and give.
static void check_apart(brunt_world *world) {
    const double give = 0.2 * RADIUS, least = 0.9 * RADIUS;
    for (int a = 0; a < BALLS; a++) {
        const brunt_body_sums one = world_sums(world, a);
        ck_assert_double_gt(one.centre[2], least - give);
        for (int i = 0; i < 2; i++) {
            ck_assert_double_gt(one.centre[i], -0.01 + least - give);
            ck_assert_double_lt(one.centre[i], (i ? 0.292 : 0.2) - least + give);
        }
        for (int b = 0; b < a; b++) {
            const brunt_body_sums two = world_sums(world, b);
            double square = 0;
            for (int i = 0; i < 3; i++) square += (one.centre[i] - two.centre[i]) * (one.centre[i] - two.centre[i]);
            ck_assert_double_gt(sqrt(square), 2 * least - give);
        }
    }
}

START_TEST(fall_into_a_box) {
    brunt_world *one = falling_world(1), *two = falling_world(2), *later = falling_world(2);
    for (int s = 0; s < STEPS; s++) {
        small_steps(one, 1);
        if (s % 50 == 0) check_apart(one);
        if (s == STEPS / 2) world_copy_state(one, later);
    }
    small_steps(two, STEPS), small_steps(later, STEPS - STEPS / 2 - 1);
    ck_assert_uint_eq(brunt_world_hash(one), brunt_world_hash(two));
    ck_assert_uint_eq(brunt_world_hash(one), brunt_world_hash(later));
    const brunt_energy e = world_energy(one);
    const brunt_momentum p = world_momentum(one);
    printf("t = %.3g s: error of the energy %.1e, friction %.3g J, drift %.1e and %.1e\n", brunt_world_time(one),
           e.error_relative, e.friction, p.linear_drift, p.angular_drift);
    ck_assert_double_lt(fabs(e.error_relative), 5e-3);
    ck_assert_double_gt(e.friction, 0);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, ROUNDING);
    brunt_world_destroy(one), brunt_world_destroy(two), brunt_world_destroy(later);
}
END_TEST

// Each ball of the crowd written down by itself, in the crowd's order.
START_TEST(are_the_balls_they_would_be) {
    brunt_scene scene;
    char text[8000];
    brunt_world *crowd = falling_world(1);
    const char *begin = strstr(falling, "  grains:"), *end = strstr(falling, "contact:");
    int used = snprintf(text, sizeof text, "%.*s", (int)(begin - falling), falling);
    for (int b = 0; b < BALLS; b++) {
        const brunt_body_sums s = world_sums(crowd, b);
        const int n = atoi(strchr(brunt_body_name(crowd, b), '.') + 1) - 1;
        const int at[] = {n % 2, n / 2 % 3, n / 6}; // a lattice of 92 mm, x first
        for (int i = 0; i < 3; i++)
            ck_assert_double_eq_tol(0.5 * (s.high[i] + s.low[i]), 0.092 * (at[i] + 0.5) + (i == 2 ? 0.005 : 0),
                                    10 * ROUNDING);
        used +=
            snprintf(text + used, sizeof text - (size_t)used,
                     "  grains%02d: {method: fem, element: tet4, size: %.17g, material: rubber, velocity: [0.5, 0.2, "
                     "-1], shape: {sphere: {center: [0, 0, 0], radius: %.17g}}, place: [{translate: [%.17g, %.17g, "
                     "%.17g]}]}\n",
                     b, 0.025 * 0.5 * (s.high[0] - s.low[0]) / RADIUS, 0.5 * (s.high[0] - s.low[0]),
                     0.5 * (s.high[0] + s.low[0]), 0.5 * (s.high[1] + s.low[1]), 0.5 * (s.high[2] + s.low[2]));
    }
    snprintf(text + used, sizeof text - (size_t)used, "%s", end);
    small_scene_of(text, &scene, NULL, 0);
    brunt_world *alone = small_world(&scene);
    ck_assert_int_eq(brunt_world_elements(alone), brunt_world_elements(crowd));
    world_until(alone, 0.05), world_until(crowd, 0.05); // some have met by then
    ck_assert_double_gt(world_energy(crowd).internal, 0);
    for (int b = 0; b < BALLS; b++) {
        const brunt_body_sums one = world_sums(alone, b), other = world_sums(crowd, b);
        for (int i = 0; i < 3; i++) ck_assert_double_eq_tol(one.centre[i], other.centre[i], 1e5 * ROUNDING * RADIUS);
    }
    brunt_world_destroy(alone), brunt_world_destroy(crowd);
    brunt_scene_free(&scene);
}
END_TEST

#ifndef BRUNT_FLOAT
// Four columns of three between a floor and a plate that cannot tilt: each carries a fourth of the load.
static const char pressed[] =
    "brunt: 1\ntitle: balls in columns\ndimension: 3\ntime: {scheme: static, steps: 2}\nnewton: {tolerance: 1e-9}\n"
    "materials:\n  rubber: {model: linear-elastic, density: 1000, E: 2.75 MPa, nu: 0.3}\n"
    "  steel: {model: linear-elastic, density: 1000, E: 200 MPa, nu: 0.3}\nbodies:\n"
    "  grains: {method: fem, element: tet4, size: 2.5 mm, material: rubber, crowd: {lattice: square, count: [2, 2, 3], "
    "radius: 5 mm, gap: 0.1 mm}}\n"
    "  top: {method: fem, element: hex8, size: 4 mm, material: steel, shape: {box: {min: [0.1 mm, 0.1 mm, 30.29 mm], "
    "max: [20.2 mm, 20.2 mm, 34 mm]}}}\n"
    "contact: {method: barrier, distance: 0.15 mm}\nboundaries:\n"
    "  - {name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate}\n"
    "  - {name: west, plane: {point: [0, 0, 0], normal: [1, 0, 0]}, condition: separate}\n"
    "  - {name: east, plane: {point: [20.3 mm, 0, 0], normal: [-1, 0, 0]}, condition: separate}\n"
    "  - {name: south, plane: {point: [0, 0, 0], normal: [0, 1, 0]}, condition: separate}\n"
    "  - {name: north, plane: {point: [0, 20.3 mm, 0], normal: [0, -1, 0]}, condition: separate}\n"
    "  - {name: down, body: top, group: zmax, traction: [0, 0, -3000 Pa], table: [[0 s, 0], [1 s, 1]]}\n"
    "  - {name: upright, body: top, group: surface, fix: [x, y]}\n";

START_TEST(bear_a_plate) {
    static const double LOAD = 3000 * 0.0201 * 0.0201;
    uint64_t hash[2];
    for (int threads = 1; threads <= 2; threads++) {
        brunt_scene scene;
        small_scene_of(pressed, &scene, NULL, 0);
        scene.world.threads = threads;
        brunt_world *world = small_world(&scene);
        small_steps(world, 2);
        hash[threads - 1] = brunt_world_hash(world);
        const brunt_reaction floor = world_boundary(world, 0);
        int32_t count;
        ck_assert(brunt_world_links(world, &count));
        double across[3] = {0}; // what balls below 10, 20 and 30 mm have from those above
        for (int32_t k = 0; k < count; k++) {
            const brunt_link link = brunt_world_link(world, k);
            double z[2] = {world_sums(world, link.a).centre[2], world_sums(world, link.b).centre[2]};
            for (int level = 0; level < 3; level++)
                if ((z[0] < 0.0101 * (level + 1)) != (z[1] < 0.0101 * (level + 1)))
                    across[level] += z[0] < z[1] ? link.force[2] : -link.force[2];
        }
        brunt_balance balance;
        ck_assert(brunt_world_balance(world, &balance));
        printf("floor %.10g of %.10g N, levels %.10g %.10g %.10g; balance %.1e\n", floor.force[2], LOAD, across[0],
               across[1], across[2], balance.body);
        for (int level = 0; level < 3; level++) ck_assert_double_eq_tol(across[level], -LOAD, 1e-8 * LOAD);
        ck_assert_double_eq_tol(fabs(floor.force[2]), LOAD, 1e-8 * LOAD);
        ck_assert_double_lt(balance.body, 1e-7);
        brunt_world_destroy(world);
        brunt_scene_free(&scene);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
}
END_TEST
#endif

int main(void) {
    Suite *suite = suite_create("crowds of balls");
    TCase *tests = tcase_create("balls");
    tcase_add_test(tests, fall_into_a_box);
    tcase_add_test(tests, are_the_balls_they_would_be);
#ifndef BRUNT_FLOAT
    tcase_add_test(tests, bear_a_plate);
#endif
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
