// Contact by penalties as a user meets it: what is refused, overlaps at the start, what is said of the stiffness, and
// forces that are those of closed forms.
#include <math.h>
#include <stdio.h>

#include "tests/support/small_columns.h"

#include <jansson.h>

#ifndef BRUNT_FLOAT
// A block above a stiff one that is wider, a gap (or, below 0, an overlap) between them; its top is pressed down by
// 0.02 mm.
static void put_blocks(const char *name, double gap, const char *contact) {
    char text[2000];
    snprintf(
        text, sizeof text,
        "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 4}\nnewton: {tolerance: 1e-9}\nmaterials:\n"
        "  m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}\n"
        "  stiff: {model: linear-elastic, density: 1000 kg/m^3, E: 50 TPa, nu: 0.3}\nbodies:\n"
        "  lower: {method: fem, element: quad4, size: 2 mm, material: stiff, shape: {box: {min: [-9 mm, 0], max: [9 "
        "mm, 8 mm]}}}\n"
        "  upper: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [-8 mm, %.9g mm], max: [8 "
        "mm, %.9g mm]}}}\n"
        "boundaries:\n  - {name: base, body: lower, group: ymin, fix: [x, y]}\n"
        "  - {body: upper, group: xmin, fix: [x]}\n  - {body: upper, group: xmax, fix: [x]}\n"
        "  - {name: press, body: upper, group: ymax, displacement: [free, -0.02 mm], table: [[0 s, 0], [1 s, 1]]}\n"
        "contact: {method: penalty%s}\noutput: {every: none, history: 0 s}\n",
        8 + gap, 16 + gap, contact);
    small_put(name, text);
}

static json_t *summary_of(const char *folder) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s/summary.json", small_folder, folder);
    json_t *summary = json_load_file(path, 0, NULL);
    ck_assert_ptr_nonnull(summary);
    return summary;
}

static double number_of(const json_t *object, const char *key) {
    return json_number_value(json_object_get(object, key));
}

// Beside a soft spring both are rigid: what pushes is k times how deep it is, whatever of it was there at the start,
// over the mean of both surfaces, 16 mm of the wider one and 18 mm of the other, whose corners stand for two faces.
static void check_force(const char *folder, double deep) {
    json_t *summary = summary_of(folder);
    const double k = number_of(json_object_get(summary, "penalty"), "least"), expected = k * deep * 17e-3;
    ck_assert_double_gt(k, 0);
    ck_assert_double_eq_tol(number_of(json_object_get(summary, "links"), "mean"), expected, 5e-4 * expected);
    ck_assert_double_lt(fabs(number_of(json_object_get(summary, "energy"), "error_relative")), 1e-8);
    json_decref(summary);
}

static const char soft[] = ", penalty: 1 kPa/mm";

START_TEST(stiffness_is_said_and_is_by_the_length_of_contacts) {
    static const double gap[] = {0, 0.012}; // meeting in the first step, or later
    put_blocks("blocks.yaml", 0, "");
    small_expect("check blocks.yaml", 0, "20 E* / a, a of 0.002 m until contacts tell it");
    for (int i = 0; i < 2; i++) {
        put_blocks("blocks.yaml", gap[i], "");
        small_expect("run blocks.yaml -t 1 -o out --fresh", 0, "half the mean length of contacts");
        json_t *summary = summary_of("out"), *penalty = json_object_get(summary, "penalty");
        ck_assert_double_eq_tol(number_of(penalty, "a"), 8.5e-3, 1e-9);
        const double wanted = 20 * 50e6 / 0.91 / (1 + 1e-6) / 8.5e-3;
        ck_assert_double_eq_tol(number_of(penalty, "least"), wanted, 1e-9 * wanted);
        ck_assert_double_lt(fabs(number_of(json_object_get(summary, "energy"), "error_relative")), 1e-8);
        json_decref(summary);
    }
    put_blocks("blocks.yaml", 0, soft);
    small_expect("run blocks.yaml -t 1 -o given", 0, "contact.penalty 1e+06 to 1e+06 Pa/m\n");
    check_force("given", 0.02e-3);
    // Surfaces that push from a distance on: as if they were nearer by that.
    put_blocks("blocks.yaml", 0.012, ", penalty: 1 kPa/mm, distance: 5 um");
    small_expect("run blocks.yaml -t 1 -q -o standing", 0, NULL);
    check_force("standing", 0.013e-3);
}
END_TEST

static char *hash_of(const char *folder) {
    json_t *summary = summary_of(folder);
    char *hash = strdup(json_string_value(json_object_get(summary, "state_hash")));
    json_decref(summary);
    return hash;
}

// A first step that fails leaves nothing of what contacts have told on its way: what goes on from there, of more
// iterations, is the same as what begins with them.
START_TEST(a_step_that_fails_tells_nothing) {
    put_blocks("blocks.yaml", 0.004, "");
    small_expect("run blocks.yaml -t 1 -q -o whole", 0, NULL);
    small_expect("run blocks.yaml -t 1 -o legs --set newton.cut=0 --set newton.iterations=1", 70, NULL);
    small_expect("run blocks.yaml -t 1 -q -o legs --resume", 0, NULL);
    char *whole = hash_of("whole"), *legs = hash_of("legs");
    ck_assert_str_eq(whole, legs);
    free(whole), free(legs);
}
END_TEST

// What overlaps is pushed apart, and that is said; so deep that the way out is not known, it is refused.
START_TEST(overlaps_push_apart_or_are_refused) {
    put_blocks("blocks.yaml", -0.01, soft);
    small_expect("run blocks.yaml -t 1 -o out", 0, "penalties push them apart in the first load step");
    check_force("out", 0.03e-3);
    put_blocks("blocks.yaml", -0.01, "");
    small_expect("run blocks.yaml -t 1 -o out --fresh", 0, "half the mean length of contacts");
    put_blocks("blocks.yaml", -1.1, "");
    small_expect("run blocks.yaml -t 1 -o deep", 65, "more than half the shortest edge in contact, 0.001 m");
    put_blocks("blocks.yaml", -5, "");
    small_expect("run blocks.yaml -t 1 -o deep", 65, "surfaces do not know which way is out from there");
}
END_TEST

// A block of points, 8 mm wide and much stiffer than soft ground, whose lowest row is a gap (or, below 0, an overlap)
// above a plane.
static void put_points(const char *name, double gap, const char *plane, const char *contact) {
    char text[1200];
    snprintf(text, sizeof text,
             "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 2, energy_limit: 0.9}\nnewton: {tolerance: "
             "1e-9}\ngrid: {cell: 2 mm}\n"
             "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
             "  block: {method: mpm, material: m, shape: {box: {min: [0, %.9g mm], max: [8 mm, %.9g mm]}}}\n"
             "loads: {gravity: [0, -10]}\noutput: {every: none, history: 0 s}\nboundaries:\n"
             "  - {name: ground, plane: {point: [0, 0], normal: [0, 1]}, condition: separate%s}\n"
             "contact: {method: penalty%s}\n",
             gap - 0.5, gap + 7.5, plane, contact);
    small_put(name, text);
}

// Material points and a plane: soft ground carries the weight, 0.64 N/m, by how deep the lowest row of eight is below
// it, each point as wide as a circle of its area (whose weight is there at once: half its work is not stored); from
// wherever it began, and whichever of both moves. Where nothing is said the stiffness is by the length of that row.
START_TEST(points_lie_on_planes) {
    static const double gap[] = {0.02, 0, -0.03};
    static const char ground[] = ", penalty: 0.8 kPa/mm";
    const double wide = 8 * 2e-3 / sqrt(acos(-1)), deep = 0.64 / (0.8e6 * wide);
    double y[ROWS], force[ROWS];
    for (int i = 0; i < 3; i++) {
        put_points("points.yaml", gap[i], "", ground);
        small_expect("run points.yaml -t 1 -o out --fresh", 0,
                     gap[i] < 0 ? "penalties push them apart in the first load step" : NULL);
        const int last = read_column("out", "body.block.position_y", y) - 1;
        read_column("out", "wall.ground.force_y", force);
        ck_assert_double_eq_tol(force[last], 0.64, 1e-9);
        ck_assert_double_eq_tol(y[last] - y[0], -(gap[i] * 1e-3 + deep), 2e-8);
    }
    put_points("points.yaml", 0.02, ", velocity: [0, 0.5 mm/s]", ground);
    small_expect("run points.yaml -t 1 -q -o moved", 0, NULL);
    const int last = read_column("moved", "body.block.position_y", y) - 1;
    ck_assert_double_eq_tol(y[last] - y[0], 0.5e-3 - 0.02e-3 - deep, 2e-8);
    small_expect("run points.yaml -t 2 -q -o two", 0, NULL);
    char *one = hash_of("moved"), *two = hash_of("two");
    ck_assert_str_eq(one, two);
    free(one), free(two);
    put_points("points.yaml", 0.02, "", "");
    small_expect("run points.yaml -t 1 -o stiff", 0, "half the mean length of contacts");
    json_t *summary = summary_of("stiff"), *penalty = json_object_get(summary, "penalty");
    ck_assert_double_eq_tol(number_of(penalty, "a"), wide / 2, 1e-9);
    ck_assert_double_eq_tol(number_of(penalty, "least"), 20 * 50e6 / 0.91 / (wide / 2), 1e3);
    json_decref(summary);
    put_points("points.yaml", -0.6, "", ground);
    small_expect("run points.yaml -t 1 -o deep", 65, "more than half the shortest edge in contact");
}
END_TEST

// Softer than what presses asks: it is said while there is half of the way left, and surfaces never pass each other.
START_TEST(too_soft_is_said) {
    put_blocks("blocks.yaml", 0, ", penalty: 50 Pa/mm");
    small_expect("run blocks.yaml -t 1 -o out --set 'boundaries[3].displacement=[free, -0.7 mm]'", 0,
                 "contact.penalty is low for what presses there");
    put_blocks("blocks.yaml", 0, ", penalty: 50 Pa/mm");
    small_expect("run blocks.yaml -t 1 -o far --set 'boundaries[3].displacement=[free, -3 mm]'", 70, NULL);
}
END_TEST

// A cube above a floor, in three dimensions.
static void put_cube(const char *contact) {
    char text[800];
    snprintf(text, sizeof text,
             "brunt: 1\ndimension: 3\ntime: {scheme: static, steps: 1}\n"
             "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\n"
             "bodies: {cube: {method: fem, element: hex8, size: 1 mm, material: m, shape: {box: {min: [0, 0, 1 mm], "
             "max: [2 mm, 2 mm, 2 mm]}}}}\n"
             "boundaries: [{name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate}]\n"
             "contact: {%s}\n",
             contact);
    small_put("deep.yaml", text);
}

START_TEST(what_has_no_penalties_is_refused) {
    put_blocks("blocks.yaml", 0.01, "");
    small_expect("check blocks.yaml --set 'time={scheme: implicit, step: 1 ms, end: 1 s}'", 65,
                 "penalty: this belongs to time.scheme: static, barrier, tied or none is wanted");
    small_expect("check blocks.yaml --set 'time={end: 1 ms}'", 65, "penalty: this belongs to time.scheme: static");
    small_expect("check blocks.yaml --set 'bodies.upper.method=mpm' --set 'grid.cell=2 mm'", 65,
                 "penalty wants two bodies of method fem");
    small_expect("check blocks.yaml --set contact.method=barrier --set 'contact.penalty=1 MPa/mm'", 65,
                 "this belongs to method: penalty");
    small_expect("check blocks.yaml --set 'contact.stiffness=1 MPa'", 65, "this belongs to method: barrier");
    small_expect("check blocks.yaml --set 'contact.pairs=[{between: [lower, lower]}]'", 65,
                 "contact of a body with itself is by barrier");
    put_cube("method: penalty");
    small_expect("check deep.yaml", 65, "penalty: of two dimensions alone; in three barrier is wanted");
}
END_TEST

// Mirrored, with the lower one moved in place of the upper, and not turned but by 0 degrees: the same forces.
START_TEST(it_does_not_matter_which_body_moves) {
    static const char *const surface[] = {"facets", "arcs"};
    double sheared[3];
    static const char *const how[] = {
        "",
        "--set 'boundaries[0]={name: base, body: upper, group: ymax, fix: [x, y]}' --set 'boundaries[1]={name: press, "
        "body: lower, group: ymin, displacement: [free, 0.04 mm], table: [[0 s, 0], [0.5 s, 1]]}' --set "
        "'boundaries[2]={name: shear, body: lower, group: ymin, displacement: [-0.02 mm, free], table: [[0.5 s, 0], [1 "
        "s, 1]]}'",
        "--set 'boundaries[2].displacement=[-0.02 mm, free]' --set 'bodies.upper.place=[{rotate: {angle: 0 deg}}]'"};
    small_put(
        "sheared.yaml",
        "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 10}\nnewton: {tolerance: 1e-10}\n"
        "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
        "  lower: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [-8 mm, 0], max: [8 mm, 6 "
        "mm]}}}\n"
        "  upper: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [-5 mm, 6 mm], max: [5 mm, "
        "12 mm]}}}\n"
        "boundaries:\n  - {name: base, body: lower, group: ymin, fix: [x, y]}\n"
        "  - {name: press, body: upper, group: ymax, displacement: [free, -0.04 mm], table: [[0 s, 0], [0.5 s, 1]]}\n"
        "  - {name: shear, body: upper, group: ymax, displacement: [0.02 mm, free], table: [[0.5 s, 0], [1 s, 1]]}\n"
        "contact: {method: penalty, friction: 0.4}\noutput: {every: none, history: 0 s}\n"
        "measures: {shear: {history: contact.lower-upper.force_x}, press: {history: contact.lower-upper.force_y}}\n");
    for (int i = 0; i < 3; i++) {
        char words[900];
        snprintf(words, sizeof words, "run sheared.yaml -t 1 -q -o out%d --set contact.surface=%s %s", i, surface[_i],
                 how[i]);
        small_expect(words, 0, NULL);
        char folder[16];
        snprintf(folder, sizeof folder, "out%d", i);
        json_t *summary = summary_of(folder), *m = json_object_get(summary, "measures");
        sheared[i] = number_of(json_object_get(m, "shear"), "value");
        ck_assert_double_lt(fabs(sheared[i]), 0.4 * number_of(json_object_get(m, "press"), "value"));
        json_decref(summary);
    }
    ck_assert_double_gt(fabs(sheared[0]), 100);
    ck_assert_double_eq_tol(sheared[1], sheared[0], 1e-7 * fabs(sheared[0]));
    ck_assert_double_eq_tol(sheared[2], -sheared[0], 1e-7 * fabs(sheared[0]));
}
END_TEST

// ------------------------------------------------------------------------------------------ round rims

enum { SIDE = 3 };

// Nine disks of 32 edges in a square lattice, whose rims are turned by parts of an edge, pressed by 30 N/m a row.
static void put_lattice(const char *name, const char *contact) {
    static const double turn[SIDE * SIDE] = {0, 0.5, 0.13, 0.71, 0.02, 0.5, 0.88, 0.37, 0.25};
    const double cell = 10.03, wide = SIDE * cell;
    char text[8000];
    int n = snprintf(text, sizeof text,
                     "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 2}\nnewton: {tolerance: 1e-9}\nmaterials:\n"
                     "  rubber: {model: linear-elastic, density: 1000 kg/m^3, E: 2.75 MPa, nu: 0.3333333}\n"
                     "  steel: {model: linear-elastic, density: 1000 kg/m^3, E: 200 MPa, nu: 0.3}\nbodies:\n");
    for (int i = 0; i < SIDE * SIDE; i++)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "  g%d: {method: fem, element: tri3, size: 1 mm, material: rubber, crowd: {lattice: square, "
                      "count: [1, 1], radius: 5 mm}, place: [{translate: [-5 mm, -5 mm]}, {rotate: {angle: %.9g deg}}, "
                      "{translate: [%.9g mm, %.9g mm]}]}\n",
                      i, turn[i] * 360 / 32, (i % SIDE + 0.5) * cell, (i / SIDE + 0.5) * cell);
    n += snprintf(
        text + n, sizeof text - (size_t)n,
        "  top: {method: fem, element: quad4, size: 24 mm, material: steel, shape: {box: {min: [0.1 mm, %.9g "
        "mm], max: [%.9g mm, %.9g mm]}}}\n"
        "  right: {method: fem, element: quad4, size: 24 mm, material: steel, shape: {box: {min: [%.9g mm, 0.1 "
        "mm], max: [%.9g mm, %.9g mm]}}}\n"
        "boundaries:\n  - {plane: {point: [0, 0], normal: [1, 0]}, condition: separate}\n"
        "  - {plane: {point: [0, 0], normal: [0, 1]}, condition: separate}\n"
        "  - {body: top, group: ymax, traction: [0, %.9g Pa], table: [[0 s, 0], [1 s, 1]]}\n"
        "  - {body: right, group: xmax, traction: [%.9g Pa, 0], table: [[0 s, 0], [1 s, 1]]}\n"
        "  - {body: top, group: surface, fix: [x]}\n  - {body: right, group: surface, fix: [y]}\n"
        "contact:\n  method: penalty\n  friction: 0.5\n%s  pairs:\n    - {between: [top, right], method: none}\n",
        wide, wide + 0.1, wide + 5, wide, wide + 5, wide + 0.1, -30e3 * SIDE / wide, -30e3 * SIDE / wide, contact);
    for (int i = 0; i < SIDE * SIDE; i++)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "    - {between: [g%d.1, top], friction: 0}\n    - {between: [g%d.1, right], friction: 0}\n", i,
                      i);
    n += snprintf(text + n, sizeof text - (size_t)n, "output: {every: none, history: 0 s}\n");
    ck_assert_int_lt(n, (int)sizeof text);
    small_put(name, text);
}

// Every contact carries 30 N/m, as all disks are alike: with edges they are not, by how their rims are turned, and
// forces differ by more than a tenth; round ones differ by what a mesh of that size gives at nodes and between them.
START_TEST(round_rims_do_not_feel_how_they_are_turned) {
    static const char *const surface[] = {"", "  surface: facets\n", "  surface: arcs\n"};
    double spread[3];
    char *hash[3];
    for (int i = 0; i < 3; i++) {
        put_lattice("lattice.yaml", surface[i]);
        small_expect("run lattice.yaml -t 1 -q -o out --fresh", 0, NULL);
        json_t *summary = summary_of("out"), *links = json_object_get(summary, "links");
        ck_assert_double_eq_tol(number_of(links, "mean"), 30, 0.05);
        ck_assert_double_lt(number_of(json_object_get(summary, "balance"), "body"), 1e-8);
        ck_assert_double_lt(fabs(number_of(json_object_get(summary, "energy"), "error_relative")), 1e-8);
        spread[i] = number_of(links, "sd") / 30, hash[i] = hash_of("out");
        json_decref(summary);
    }
    ck_assert_str_eq(hash[0], hash[1]); // facets are the default
    ck_assert_double_gt(spread[0], 0.1);
    ck_assert_double_lt(spread[2], 0.05);
    small_expect("run lattice.yaml -t 2 -q -o out --fresh", 0, NULL);
    char *two = hash_of("out");
    ck_assert_str_eq(two, hash[2]);
    for (int i = 0; i < 3; i++) free(hash[i]);
    free(two);
}
END_TEST

START_TEST(round_rims_are_of_penalties_in_two_dimensions) {
    put_blocks("blocks.yaml", 0.01, ", surface: arcs");
    small_expect("check blocks.yaml", 0, NULL);
    small_expect("check blocks.yaml --set contact.method=barrier", 65, "this belongs to method: penalty");
    small_expect("check blocks.yaml --set contact.surface=round", 65, "Available: facets, arcs");
    small_expect(
        "check blocks.yaml --set 'contact={surface: arcs, pairs: [{between: [lower, upper], method: penalty}]}'", 65,
        "arcs: method barrier of all other bodies is by facets");
    put_blocks("blocks.yaml", 0.01, ", surface: arcs, pairs: [{between: [lower, upper], method: barrier}]");
    small_expect("check blocks.yaml", 65, "blocks.yaml:16:");
    small_expect("check blocks.yaml", 65, "barrier is by facets, and contact.surface: arcs by penalty alone");
    put_cube("method: penalty, surface: arcs");
    small_expect("check deep.yaml", 65, "deep.yaml:7:37: contact.surface: arcs are rims of two dimensions");
}
END_TEST

// A tower of which two blocks overlap and two are kept apart. The distance is by default that of barriers; written down
// it would be that of penalties, too, which push where they overlap: the resolved scene leaves it to the bodies.
START_TEST(resolved_it_is_the_same_beside_barriers) {
    small_put("tower.yaml",
              "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 2}\n"
              "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
              "  a: {method: fem, size: 2 mm, material: m, shape: {box: {min: [0, 0], max: [8 mm, 8 mm]}}}\n"
              "  b: {method: fem, size: 2 mm, material: m, shape: {box: {min: [0, 8.1 mm], max: [8 mm, 16 mm]}}}\n"
              "  c: {method: fem, size: 2 mm, material: m, shape: {box: {min: [0, 16.01 mm], max: [8 mm, 24 mm]}}}\n"
              "boundaries:\n  - {body: a, group: ymin, fix: [x, y]}\n  - {body: b, group: xmin, fix: [x]}\n"
              "  - {body: c, group: ymax, displacement: [0, -0.2 mm]}\n"
              "contact: {method: barrier, pairs: [{between: [a, b], method: penalty}]}\n"
              "output: {every: none}\n");
    small_expect("run tower.yaml -t 1 -q -o out", 0, NULL);
    small_expect("run out/scene.yaml -t 1 -q -o again", 0, NULL);
    char *hash[2] = {hash_of("out"), hash_of("again")};
    ck_assert_str_eq(hash[0], hash[1]);
    for (int i = 0; i < 2; i++) free(hash[i]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_penalty");
    TCase *tests = tcase_create("program_penalty");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, stiffness_is_said_and_is_by_the_length_of_contacts);
    tcase_add_test(tests, a_step_that_fails_tells_nothing);
    tcase_add_test(tests, overlaps_push_apart_or_are_refused);
    tcase_add_test(tests, points_lie_on_planes);
    tcase_add_test(tests, too_soft_is_said);
    tcase_add_test(tests, what_has_no_penalties_is_refused);
    tcase_add_loop_test(tests, it_does_not_matter_which_body_moves, 0, 2);
    tcase_add_test(tests, round_rims_do_not_feel_how_they_are_turned);
    tcase_add_test(tests, round_rims_are_of_penalties_in_two_dimensions);
    tcase_add_test(tests, resolved_it_is_the_same_beside_barriers);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#else
int main(void) { return 0; }
#endif
