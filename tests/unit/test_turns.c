// Bodies of small strain that have turned are told at the end of implicit steps and load steps. A square of one element
// whose corners are turned by t is strained by cos t - 1 both ways: its corners push along the diagonals where these
// were, at places that are off those by t, so that sin t of the moments that they might have is there.
#include "tests/support/small_scene.h"

#include <math.h>

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // load steps want double
#else

#define HEAD(dim, more)                                                                                                \
    "brunt: 1\ntitle: turned\ndimension: " dim "\ntime: {scheme: static, steps: 4}\n" more                             \
    "materials: {soft: {model: linear-elastic, density: 1000, E: 1 MPa, nu: 0.3}}\n"
static const char squares[] =
    HEAD("2", "contact: {method: none}\n") "bodies:\n  one: {method: fem, element: quad4, size: 1, material: soft, "
                                           "shape: {box: {min: [0, 0], max: [1, 1]}}}\n"
                                           "  two: {method: fem, element: quad4, size: 1, material: soft, shape: {box: "
                                           "{min: [3, 0], max: [4, 1]}}}\n"
                                           "boundaries:\n"
                                           "  - {name: a, body: one, group: surface, rotation: {angle: 1.2 deg, about: "
                                           "[0, 0]}, table: [[0 s, 0], [1 s, 1]]}\n"
                                           "  - {name: b, body: two, group: surface, rotation: {angle: 0.6 deg, about: "
                                           "[9, 0]}, table: [[0 s, 0], [1 s, 1]]}\n";
static const char cube[] = HEAD(
    "3", "") "bodies: {one: {method: fem, size: 1, material: soft, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}}}\n"
             "boundaries: [{name: a, body: one, group: surface, rotation: {angle: 2 deg, axis: [0, 0, 1], about: [0, "
             "0, 0]}, "
             "table: [[0 s, 0], [1 s, 1]]}]\n";
static const char points[] = HEAD(
    "2",
    "grid: {cell: 0.2}\n") "bodies: {one: {method: mpm, material: soft, shape: {box: {min: [0, 0], max: [1, 1]}}}}\n"
                           "boundaries: [{name: a, line: {points: [[-0.5, 0], [1.5, 0]]}, condition: stick, rotation: "
                           "{angle: 2 deg, about: [0, "
                           "0]}, table: [[0 s, 0], [1 s, 1]]}]\nloads: {gravity: [0, -20]}\n";
static const char sheet[] =
    "brunt: 1\ntitle: turned\ndimension: 3\ntime: {scheme: implicit, end: 1, step: 0.25}\n"
    "materials: {soft: {model: linear-elastic, density: 1000, E: 1 MPa, nu: 0.3}}\n"
    "bodies: {one: {method: membrane, size: 1, thickness: 10 mm, material: soft, faces: [zmax], shape: {box: {min: [0, "
    "0, "
    "0], max: [1, 1, 1]}}}}\n"
    "boundaries: [{name: a, body: one, group: border, rotation: {angle: 2 deg, axis: [0, 0, 1], about: [0, 0, 0]}, "
    "table: [[0 s, 0], [1 s, 1]]}]\n";

// Sheared by 0.05 it turns by half of that; P F^T, symmetric in simple shear, has no moment.
static const char sheared[] =
    HEAD("2", "") "bodies: {one: {method: fem, element: quad4, size: 1, material: soft, shape: {box: {min: [0, 0], "
                  "max: [1, 1]}}}}\n"
                  "boundaries:\n  - {name: a, body: one, group: ymin, fix: all}\n"
                  "  - {name: b, body: one, group: ymax, displacement: [50 mm, 0], table: [[0 s, 0], [1 s, 1]]}\n";

// What is told of turns by then; 0 bodies: nothing.
typedef struct told {
    char body[8];
    double degrees, share;
    int count;
} told;

static told told_of(brunt_world *world) {
    told t = {.count = 0};
    int found = 0;
    for (int32_t w = 0; w < brunt_warning_count(world); w++) {
        const char *text = brunt_world_warning(world, w), *off = strstr(text, "off by ");
        found +=
            sscanf(text, "bodies.%7s has turned by %lg degrees, the most of %d", t.body, &t.degrees, &t.count) == 3;
        if (found) ck_assert(off && sscanf(off, "off by %lg", &t.share) == 1 && strstr(text, "neo-hookean"));
    }
    ck_assert_int_le(found, 1);
    return t;
}

static told run(const char *text, const char *const *sets, int count) {
    brunt_scene scene;
    small_scene_of(text, &scene, sets, count);
    brunt_world *world = small_world(&scene);
    brunt_error error = {0};
    told t = {.count = 0};
    while (brunt_world_time(world) < brunt_world_end(world)) {
        ck_assert_int_eq(t.count, 0); // not before the end
        ck_assert_msg(brunt_world_step(world, INFINITY, &error) == BRUNT_OK, "%s", error.message);
        t = told_of(world);
    }
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    return t;
}

static const double DEGREE = 3.14159265358979323846 / 180;

START_TEST(of_squares) {
    told t = run(squares, NULL, 0);
    ck_assert_str_eq(t.body, "one");
    ck_assert_int_eq(t.count, 2);
    ck_assert_double_eq_tol(t.degrees, 1.2, 1e-6);
    ck_assert_double_eq_tol(t.share, sin(1.2 * DEGREE), 5e-4); // two digits are told
    // Less than a hundredth, or turned back, or of what turns along: nothing is said.
    const char *less[] = {"boundaries[0].rotation.angle=0.5 deg", "boundaries[1].rotation.angle=0.5 deg"};
    t = run(squares, less, 2);
    ck_assert_int_eq(t.count, 0);
    const char *one[] = {"boundaries[1].rotation.angle=0.5 deg"};
    t = run(squares, one, 1);
    ck_assert_int_eq(t.count, 1);
    const char *back[] = {"boundaries[0].table=[[0 s, 0], [0.5 s, 1], [1 s, 0]]",
                          "boundaries[1].table=[[0 s, 0], [0.5 s, 1], [1 s, 0]]"};
    t = run(squares, back, 2);
    ck_assert_int_eq(t.count, 0);
    const char *neo[] = {"materials.soft.model=neo-hookean"}, *saint[] = {"materials.soft.model=st-venant-kirchhoff"};
    ck_assert_int_eq(run(squares, neo, 1).count, 0);
    ck_assert_int_eq(run(squares, saint, 1).count, 0);
    ck_assert_int_eq(run(sheared, NULL, 0).count, 0);
    const char *implicit[] = {"time={scheme: implicit, end: 1, step: 0.25}"};
    t = run(squares, implicit, 1);
    ck_assert_double_eq_tol(t.degrees, 1.2, 1e-6);
}
END_TEST

// Across the axis a cube pushes by l + m, along it by l, Lame's moduli: its corners push along the diagonals of
// neither.
START_TEST(of_a_cube) {
    const double l = 0.3 / (1.3 * 0.4), m = 0.5 / 1.3, across = l + m;
    told t = run(cube, NULL, 0);
    ck_assert_double_eq_tol(t.degrees, 2, 1e-6);
    ck_assert_double_eq_tol(t.share, sin(2 * DEGREE) * 2 * across / sqrt(3 * (2 * across * across + l * l)), 5e-4);
    ck_assert_int_eq(run(sheet, NULL, 0).count, 0);
}
END_TEST

START_TEST(of_points) {
    told t = run(points, NULL, 0);
    ck_assert_double_eq_tol(t.degrees, 2, 0.05);
    ck_assert_double_gt(t.share, 0.01);
    const char *neo[] = {"materials.soft.model=neo-hookean"};
    ck_assert_int_eq(run(points, neo, 1).count, 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("turns");
    TCase *tests = tcase_create("turns");
    tcase_add_test(tests, of_squares);
    tcase_add_test(tests, of_a_cube);
    tcase_add_test(tests, of_points);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#endif
