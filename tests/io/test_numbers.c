// Numbers that are too large or too small to be computed with, in every place of a scene that takes one: each must be
// refused, at its own line and column, by a message that says what is wrong with it.
#include <ctype.h>
#include <math.h>

#include "brunt.h"
#include "io/scene/scene_keys.h"
#include "tests/support/small_scene.h"
#include "io/scene/units.h"

// The database of units is read once for some thousand scenes, where each would read it anew (tests/CMakeLists.txt).
struct ut_system *__real_ut_read_xml(const char *path);
struct ut_system *__wrap_ut_read_xml(const char *path);
void __wrap_ut_free_system(struct ut_system *system);
static struct ut_system *units;
struct ut_system *__wrap_ut_read_xml(const char *path) {
    return units = units ? units : __real_ut_read_xml(path);
}
void __wrap_ut_free_system(struct ut_system *system) { (void)system; }

// What the two small scenes lack of keys with numbers.
static const char rich_text[] =
    "brunt: 1\n"
    "dimension: 3\n"
    "time: {end: 1 ms, cfl: 0.4, least_step: 1e-20, energy_limit: 0.5}\n"
    "grid: {cell: 2 mm, origin: [0, 0, 0], transfer: {flip: 0.9}}\n"
    "materials:\n"
    "  steel: {model: johnson-cook, density: 7850, E: 200 GPa, nu: 0.3, A: 800 MPa, B: 500 MPa, n: 0.26, C: 0.014,\n"
    "    m: 1.03, melt: 1800, heat_capacity: 477, eos: {model: mie-gruneisen, c0: 4570, s: 1.49, gamma0: 1.93},\n"
    "    viscosity: {quadratic: 2, linear: 0.1}, failure: {model: johnson-cook-damage, d1: 0.05, d2: 3.44, d3: "
    "-2.12}}\n"
    "  tnt: {model: newtonian, density: 1630, dynamic_viscosity: 0, eos: {model: jwl, A: 371.2 GPa, B: 3.231 GPa, R1: "
    "4.15, R2: 0.95,\n"
    "    omega: 0.3, initial_energy: 7e9, detonation_speed: 6930, bulk_modulus: 2e9, front_width: 2}}\n"
    "  gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}\n"
    "bodies:\n"
    "  rod:\n"
    "    method: mpm\n"
    "    material: steel\n"
    "    shape: {cylinder: {center: [0, 0, 0.03], axis: [0, 0, 1], radius: 8 mm, length: 20 mm}}\n"
    "    particles_per_cell: 8\n"
    "    fill: jittered\n"
    "    jitter: 0.2\n"
    "    seed: 7\n"
    "    velocity: [0, 0, -1]\n"
    "    spin: {rate: [0, 0, 3], about: [0, 0, 1]}\n"
    "    wave: {velocity: [1, 0, 0], wave_vector: [0, 0, 2], phase: 1}\n"
    "    temperature: 300\n"
    "    erosion: {strain: 2, debris: keep}\n"
    "  charge:\n"
    "    method: mpm\n"
    "    material: tnt\n"
    "    spacing: 1 mm\n"
    "    shape: {union: [{tube: {center: [0.2, 0, 0], axis: [0, 0, 1], inner_radius: 2 mm, radius: 8 mm, length: 9 "
    "mm}},\n"
    "      {polygon: {points: [[0.3, 0], [0.32, 0], [0.32, 0.02]], min: 0, max: 0.01}}]}\n"
    "  cut:\n"
    "    method: mpm\n"
    "    material: gum\n"
    "    shape: {difference: [{sphere: {center: [0.4, 0, 0], radius: 8 mm}},\n"
    "      {half-space: {point: [0.4, 0, 0], normal: [0, 0, 1]}}]}\n"
    "  plate:\n"
    "    method: fem\n"
    "    material: steel\n"
    "    shape: {box: {min: [-0.02, -0.02, -0.01], max: [0.02, 0.02, 0]}}\n"
    "    size: 5 mm\n"
    "    grading: {x: [[-0.01, 1], [0.02, 2]], y: [[-0.01, 1], [0.02, 2]], z: [[-0.01, 1], [0, 2]]}\n"
    "    hourglass: {form: viscous, coefficient: 0.1}\n"
    "    mass_scaling: 1 ns\n"
    "    damping: 2\n"
    "    place: [{translate: [0, 0, -0.02]}, {rotate: {axis: [0, 0, 1], angle: 10 deg, about: [0, 0, 0]}}]\n"
    "    erosion: {strain: 2, step: 1e-12}\n"
    "  bag:\n"
    "    method: membrane\n"
    "    material: gum\n"
    "    shape: {box: {min: [1, 1, 1], max: [1.2, 1.2, 1.1]}}\n"
    "    size: 0.1\n"
    "    thickness: 1 mm\n"
    "    contact_thickness: 2 mm\n"
    "detonations: [{point: [0.2, 0.005, 0], normal: [0, 0, 1], time: 1 us, body: charge}]\n"
    "contact: {friction: 0.1, iterations: 20, tolerance: 0.01, cell: 3 mm, pairs: [{between: [rod, plate], friction: "
    "0.3}]}\n"
    "boundaries:\n"
    "  - {name: wall, plane: {point: [0, 0, -0.5], normal: [0, 0, 1]}, condition: separate, friction: 0.3, velocity: "
    "[0, 0, 1]}\n"
    "  - {name: held, region: {sphere: {center: [0.4, 0, 0], radius: 1 mm}}, velocity: [free, 0, 2], from: 1 us, "
    "until: 10 us,\n"
    "    place: [{translate: [0, 0, 0]}]}\n"
    "  - {rotor: {point: [0, 0, 0], axis: [0, 0, 1], radius: 0.1, rate: 3}}\n"
    "  - {name: grip, group: xmin, body: plate, velocity: [0, free, 1], table: [[0, 0], [1, 2]]}\n"
    "  - {name: shift, group: xmax, body: plate, displacement: [0.1, free, free], table: [[0, 0], [1, 2]]}\n"
    "  - {name: turn, group: zmax, body: plate, rotation: {angle: 1, axis: [0, 0, 1], about: [0, 0, 0]}}\n"
    "  - {name: pull, group: ymin, body: plate, traction: [0, 5, 0]}\n"
    "  - {name: push, group: ymax, body: plate, pressure: 5}\n"
    "  - {name: gas, group: surface, body: bag, gas: {pressure: 1e5, gamma: 1.3, outside: 1e5, volume: 0.1, inflow: "
    "3}, table: [[0, 0], [1, 2]]}\n"
    "loads: {gravity: [0, 0, -9.81], gravity_ramp: 1 ms}\n"
    "output: {every: 1 ms, history: 1 ms, force_window: 1 ms, checkpoint: 60, probes: {p: {body: rod, point: [0, 0, "
    "0.03], field: "
    "velocity}}}\n"
    "measures:\n"
    "  a: {history: energy.total, relative_to: initial, expect: 1, tolerance: 0.5, from: 1 us, to: 2 us}\n"
    "  b: {history: energy.kinetic, curve: [[0, 1], [1 us, 3]], expect: 0, tolerance: 2, minus: 1}\n"
    "  c: {radius: {body: rod, axis: [0, 0, 1], center: [0, 0, 0], from: 0.01, to: 0.05}, unit: m, expect: 5, "
    "tolerance: 2}\n"
    "  d: {field: {body: rod, name: velocity, component: z, axis: [0, 0, 1], from: 0.01, to: 0.05, center: [0, 0, 0]}, "
    "take: max}\n"
    "  e: {profile: {body: rod, name: velocity, component: z, axis: [0, 0, 1], center: [0, 0, 0], reference: [[0, 1], "
    "[1, 2]]}}\n"
    "  f: {extent: {body: rod, axis: [0, 0, 1]}}\n"
    "  g: {twist: {body: rod, axis: [0, 0, 1], center: [0, 0, 0], within: 0.01, from: 0.01, to: 0.05}}\n";

static const char implicit_text[] =
    "brunt: 1\n"
    "dimension: 3\n"
    "time: {scheme: implicit, end: 1 ms, step: 1 us}\n"
    "newton: {tolerance: 1e-7, iterations: 50, cut: 3, accuracy: 1e-4}\n"
    "materials: {gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}}\n"
    "bodies:\n"
    "  low: {method: fem, material: gum, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, size: 1}\n"
    "  high: {method: fem, material: gum, shape: {box: {min: [0, 0, 1.1], max: [1, 1, 2.1]}}, size: 1}\n"
    "contact: {method: barrier, friction: 0.2, distance: 1 mm, stiffness: 1 MPa, slip_speed: 1e-4, "
    "friction_iterations: "
    "2}\n";

static const char flat_text[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {scheme: implicit, end: 1 ms, step: 1 us}\n"
    "grid: {cell: 0.1}\n"
    "materials: {gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}}\n"
    "bodies:\n"
    "  block: {method: mpm, material: gum, shape: {box: {min: [0, 0], max: [1, 1]}}}\n"
    "boundaries:\n"
    "  - {name: line, line: {points: [[0, 0], [1, 0], [1, 1]]}, condition: separate, friction: 0.2, piece: 2,\n"
    "    particles_per_cell: 5, about: [1, 2], displacement: [0.1, 0.2], table: [[0, 0], [1, 2]]}\n";

static const char tool_text[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 1 ms}\n"
    "grid: {cell: 0.1, transfer: {apic: 0.5}}\n"
    "materials: {gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}}\n"
    "bodies:\n"
    "  block: {method: mpm, material: gum, shape: {box: {min: [0, 0], max: [1, 1]}}}\n"
    "boundaries:\n"
    "  - {name: tool, line: {points: [[5, 0], [6, 0], [6, 1]], closed: true}, condition: separate, mass: 3,\n"
    "    inertia: 0.7, center: [5.5, 0.5], velocity: [0.3, 0.4], spin: 0.6}\n";

static const char static_text[] =
    "brunt: 1\n"
    "dimension: 3\n"
    "time: {scheme: static, steps: 3}\n"
    "newton: {tolerance: 1e-7, cut: 3}\n"
    "materials: {gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}}\n"
    "bodies:\n"
    "  low: {method: fem, material: gum, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, size: 1}\n"
    "loads: {gravity: [1, 2, 3]}\n"
    "boundaries: [{name: foot, body: low, group: zmin, fix: all}]\n";

static const char crowd_text[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {scheme: static, steps: 3}\n"
    "materials: {gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}}\n"
    "bodies:\n"
    "  grains: {method: fem, material: gum, size: 1 mm, crowd: {lattice: square, count: [2, 2], radius: 5 mm,\n"
    "    radius_spread: 0.1, gap: 1 mm}, random: {E: {normal: [1e6, 2e5], between: [5e5, 2e6]}, seed: 3}}\n"
    "contact: {method: penalty, friction: 0.2, slip_length: 1 um, penalty: 1e9}\n";

static const char *const texts[] = {small_scene_text, small_elements_text, rich_text,   implicit_text,
                                    flat_text,        tool_text,           static_text, crowd_text};
enum { TEXTS = sizeof texts / sizeof *texts };

static int parse(const char *text, char **messages) {
    size_t size;
    brunt_scene scene;
    FILE *out = open_memstream(messages, &size);
    const int status = brunt_scene_parse(text, strlen(text), "n.yaml", NULL, 0, &scene, out);
    fclose(out);
    brunt_scene_free(&scene);
    return status;
}

// The next number with its unit from `at` on, as [begin, end); false: there is none.
static bool next_number(const char *text, size_t at, size_t *begin, size_t *end) {
    for (; text[at]; at++) {
        const bool starts = at > 0 && strchr(" [", text[at - 1]);
        const char *digit = text + at + (text[at] == '-');
        if (!starts || !isdigit((unsigned char)*digit)) continue;
        *begin = at;
        *end = at + strcspn(text + at, ",]}\n");
        return true;
    }
    return false;
}

// Everywhere but in what says which format the file is of, and of how many dimensions. Returns how many there were.
static int swap_each(const char *text, const char *bad) {
    size_t begin, end = 0;
    int count = 0;
    while (next_number(text, end, &begin, &end)) {
        if (begin >= 7 && !memcmp(text + begin - 7, "brunt: ", 7)) continue;
        if (begin >= 11 && !memcmp(text + begin - 11, "dimension: ", 11)) continue;
        int line = 1, column = 1;
        for (size_t i = 0; i < begin; i++) text[i] == '\n' ? line++, column = 1 : column++;
        char *changed, *messages, place[64];
        ck_assert_int_gt(asprintf(&changed, "%.*s%s%s", (int)begin, text, bad, text + end), 0);
        snprintf(place, sizeof place, "n.yaml:%d:%d: ", line, column);
        const int status = parse(changed, &messages);
        ck_assert_msg(status == BRUNT_BAD_INPUT, "%s in place of '%.*s' on line %d is accepted", bad,
                      (int)(end - begin), text + begin, line);
        const char *said = strstr(messages, place);
        ck_assert_msg(said && strstr(said, bad), "%s at %s is not what the message is about:\n%s", bad, place,
                      messages);
        free(messages);
        free(changed);
        count++;
    }
    return count;
}

START_TEST(scenes_are_good_as_they_are) {
    for (int t = 0; t < TEXTS; t++) {
        char *messages;
        ck_assert_msg(parse(texts[t], &messages) == BRUNT_OK, "%s", messages);
        free(messages);
    }
}
END_TEST

// Every key that takes a number is in one of the scenes, so that the sweeps below are over all.
START_TEST(every_key_with_a_number_is_swept) {
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        const bool number = row->type == SCENE_REAL || row->type == SCENE_ANY_UNIT || row->type == SCENE_INTEGER ||
                            row->type == SCENE_VECTOR || row->type == SCENE_PARTIAL || row->type == SCENE_TURN ||
                            row->type == SCENE_POLYGON || row->type == SCENE_TABLE || row->type == SCENE_PROFILE ||
                            row->type == SCENE_CURVE || row->type == SCENE_REALS;
        if (!number || row->dimension == 2 || !strcmp(row->path, "grid.transfer.flip") ||
            !strcmp(row->path, "grid.transfer.flip_per_step"))
            continue;
        char key[64];
        const char *dot = strrchr(row->path, '.');
        snprintf(key, sizeof key, "%s: ", dot ? dot + 1 : row->path);
        bool found = false;
        for (int t = 0; t < TEXTS; t++) found = found || strstr(texts[t], key);
        // Not beside what the scenes have in its place.
        static const char *const others[] = {"time.step", "bodies.*.spin.axis", "bodies.*.mesh_unit"};
        for (int o = 0; o < 3; o++) found = found || !strcmp(row->path, others[o]);
        ck_assert_msg(found, "no number is tried at %s", row->path);
    }
}
END_TEST

START_TEST(what_is_too_large_or_no_number_is_refused_everywhere) {
    static const char *const bad[] = {"1e155", "-1e300", "inf", ".nan", "1.1e30", "-2e30", "1e400"};
    for (int t = 0; t < TEXTS; t++)
        for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) ck_assert_int_gt(swap_each(texts[t], bad[b]), 12);
}
END_TEST

START_TEST(what_is_not_normal_is_refused_everywhere) {
    for (int t = 0; t < TEXTS; t++) {
        swap_each(texts[t], "1e-320");
        swap_each(texts[t], "-3e-310");
    }
}
END_TEST

// A unit may make it so.
START_TEST(what_counts_is_the_number_in_si) {
    char *messages, *text;
    static const struct {
        const char *value;
        int status;
    } tries[] = {{"1e29", BRUNT_OK},      {"1e22 MPa", BRUNT_OK},        {"1e25 MPa", BRUNT_BAD_INPUT},
                 {"2e30 uPa", BRUNT_OK},  {"1e-29", BRUNT_OK},           {"1e-31", BRUNT_BAD_INPUT},
                 {"1e-31 GPa", BRUNT_OK}, {"1e-25 uPa", BRUNT_BAD_INPUT}};
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++) {
        const char *at = strstr(small_scene_text, "1 MPa");
        ck_assert_int_gt(
            asprintf(&text, "%.*s%s%s", (int)(at - small_scene_text), small_scene_text, tries[i].value, at + 5), 0);
        const bool coarse = BRUNT_GREATEST_NUMBER < 1e30; // single precision holds less
        const int status = parse(text, &messages);
        if (!coarse || tries[i].status)
            ck_assert_msg(status == tries[i].status, "%s: %d, %s", tries[i].value, status, messages);
        if (status) ck_assert_msg(strstr(messages, "is wanted in SI units"), "%s", messages);
        free(messages);
        free(text);
    }
}
END_TEST

// All of them at once.
START_TEST(all_are_said_in_one_go) {
    char *messages, *text = strdup(small_elements_text);
    size_t begin, end = 0;
    int changed = 0;
    while (next_number(text, end, &begin, &end)) {
        if (strstr(text, "dimension") > text + begin || !memcmp(text + begin - 11, "dimension: ", 11)) continue;
        char *now;
        ck_assert_int_gt(asprintf(&now, "%.*s1e155%s", (int)begin, text, text + end), 0);
        free(text);
        text = now;
        end = begin + 5;
        changed++;
    }
    ck_assert_int_eq(parse(text, &messages), BRUNT_BAD_INPUT);
    int said = 0;
    for (const char *m = messages; (m = strstr(m, "'1e155' is ")); m++) said++;
    ck_assert_msg(said == changed, "%d of %d are said:\n%s", said, changed, messages);
    free(messages);
    free(text);
}
END_TEST

// What the numbers were said to be before.
START_TEST(a_speed_and_a_wave_are_not_mistaken) {
    static const struct {
        const char *set, *says, *not_said;
    } tries[] = {{"bodies.left.velocity=[1e155, 0]", "'1e155' is too large a number", "end has been reached"},
                 {"bodies.left.wave={velocity: [1, 0], wave_vector: [1e300, 0]}", "'1e300' is too large a number",
                  "zero length"},
                 {"bodies.left.wave={velocity: [1, 0], wave_vector: [1e-200, 0]}", "", "zero length"}};
    for (int i = 0; i < 3; i++) {
        char *messages;
        size_t size;
        brunt_scene scene;
        FILE *out = open_memstream(&messages, &size);
        const int status =
            brunt_scene_parse(small_scene_text, strlen(small_scene_text), "n.yaml", &tries[i].set, 1, &scene, out);
        fclose(out);
        brunt_scene_free(&scene);
        ck_assert_int_eq(status, *tries[i].says ? BRUNT_BAD_INPUT : BRUNT_OK);
        ck_assert_msg(strstr(messages, tries[i].says) && !strstr(messages, tries[i].not_said), "%s", messages);
        free(messages);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("numbers");
    TCase *tests = tcase_create("numbers");
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, scenes_are_good_as_they_are);
    tcase_add_test(tests, every_key_with_a_number_is_swept);
    tcase_add_test(tests, what_is_too_large_or_no_number_is_refused_everywhere);
    tcase_add_test(tests, what_is_not_normal_is_refused_everywhere);
    tcase_add_test(tests, what_counts_is_the_number_in_si);
    tcase_add_test(tests, all_are_said_in_one_go);
    tcase_add_test(tests, a_speed_and_a_wave_are_not_mistaken);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
