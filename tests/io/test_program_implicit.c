// Implicit steps through the program: what check, summary and history say of them, explicit steps of the same scene, a
// run in two legs, and a step that does not converge.
#include "tests/support/small_program.h"

#include <jansson.h>

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const char scene[] =
    "brunt: 1\n"
    "title: Points fall on a block of elements\n"
    "dimension: 2\n"
    "time: {end: 0.2 s, scheme: implicit, step: 2 ms}\n"
    "grid: {cell: 0.1 m}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
    "bodies:\n"
    "  lower: {method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [-0.5, -0.3], max: [1, 0]}}}\n"
    "  upper: {method: mpm, material: rubber, shape: {box: {min: [0, 0.05], max: [0.5, 0.55]}}, velocity: [1, -2]}\n"
    "contact: {friction: 0.2}\n"
    "boundaries:\n"
    "  - {name: ground, group: ymin, body: lower, fix: all}\n"
    "loads: {gravity: [0, -10]}\n"
    "output: {every: 20 ms, history: 2 ms, checkpoint: 0 s}\n";

static void set_up(void) {
    small_folder_make();
    small_put("small.yaml", scene);
}

static json_t *summary_of(const char *folder) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s/summary.json", small_folder, folder);
    json_t *object = json_load_file(path, 0, NULL);
    ck_assert_msg(object != NULL, "%s", path);
    return object;
}

static double number_at(const json_t *object, const char *group, const char *key) {
    const json_t *value = json_object_get(group ? json_object_get(object, group) : object, key);
    ck_assert_msg(json_is_number(value), "%s is no number", key);
    return json_number_value(value);
}

// [s] of the processor that a program has had.
static double seconds_of(pid_t child) {
    char path[64];
    unsigned long user = 0, system = 0;
    snprintf(path, sizeof path, "/proc/%d/stat", (int)child);
    FILE *file = fopen(path, "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(fscanf(file, "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &system),
                     2);
    fclose(file);
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

START_TEST(says_what_it_does) {
    small_expect("check small.yaml --quick", 0, "implicit steps\n  c dt / h 0.73");
    small_expect("check small.yaml --quick", 0, "solver pcg: ");
    small_expect("check small.yaml --quick --set time.step=0.1", 0, "warning: particles move 2.2 cells in a step");
    small_expect("run small.yaml -o out", 0, "newton: ");
    json_t *s = summary_of("out");
    ck_assert_double_eq(number_at(s, "newton", "steps"), 100);
    ck_assert_double_ge(number_at(s, "newton", "iterations"), 100);
    ck_assert_double_gt(number_at(s, "newton", "linear_iterations"), 0);
    ck_assert_double_gt(number_at(s, NULL, "least_gap"), 0);
    ck_assert_double_lt(fabs(number_at(s, "energy", "error_relative")), 1e-3);
    ck_assert_double_gt(number_at(s, "energy", "scheme"), 0);
    ck_assert_double_gt(number_at(s, "phases", "solve"), 0);
    json_decref(s);
    ck_assert_int_eq(small_shell("head -1 out/history.csv | grep -q newton.least_part"), 0);
}
END_TEST

// Values by default, and what a barrier stores where bodies begin within it.
START_TEST(says_how_contact_is) {
    small_expect("check small.yaml --quick", 0, "  contact.distance 0.005 m, contact.stiffness 1e+05 Pa\n");
    small_expect("check small.yaml --quick", 0,
                 "contact.slip_speed 0.0003669 m/s, 1e-05 of the slowest wave speed: what");
    ck_assert_int_eq(small_shell("grep -q 'barriers push' output"), 1);
    ck_assert_int_eq(small_shell("grep -q 'solver pcg: some' output"), 0);
    small_expect("check small.yaml --quick --set contact.friction=0 --set contact.distance='80 mm'", 0,
                 "m: within contact.distance, 0.08 m, barriers push; they store ");
    ck_assert_int_eq(small_shell("grep -q slip_speed output"), 1);
}
END_TEST

static void check_same_state(const char *one, const char *other) {
    json_t *a = summary_of(one), *b = summary_of(other);
    ck_assert_str_eq(json_string_value(json_object_get(a, "state_hash")),
                     json_string_value(json_object_get(b, "state_hash")));
    json_decref(a), json_decref(b);
}

static const char three[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {scheme: implicit, end: 4 ms, step: 2 ms}\n"
    "materials:\n"
    "  soft: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}\n"
    "  hard: {model: neo-hookean, density: 1000, E: 2e6, nu: 0.3}\n"
    "bodies:\n"
    "  a: {method: fem, material: soft, size: 0.1, shape: {box: {min: [0, 0], max: [1, 0.2]}}}\n"
    "  b: {method: fem, material: hard, size: 0.1, shape: {box: {min: [0, 0.3], max: [1, 0.5]}}}\n"
    "  c: {method: fem, material: hard, size: 0.1, shape: {box: {min: [0, 0.6], max: [1, 0.8]}}}\n"
    "contact: {friction: 0.2}\n";

// What bodies decide by default stands in the resolved scene, from which the same steps follow, also where a finer mesh
// would have another default; stiffnesses that differ from pair to pair have no place there.
START_TEST(has_its_defaults_in_the_scene) {
    small_expect("run small.yaml -o out --set time.end=20ms", 0, "done");
    ck_assert_int_eq(small_shell("grep -q '^  distance: 0.00[45]' out/scene.yaml"), 0);
    ck_assert_int_eq(small_shell("grep -q '^  stiffness: 100000$' out/scene.yaml"), 0);
    ck_assert_int_eq(small_shell("grep -q '^  slip_speed: 0.00036' out/scene.yaml"), 0);
    ck_assert_int_eq(small_shell("grep -q '^  friction_iterations: 1$' out/scene.yaml"), 0);
    small_expect("run out/scene.yaml -o again", 0, "done");
    check_same_state("out", "again");
    ck_assert_int_eq(small_shell("cmp out/scene.yaml again/scene.yaml"), 0);
    small_expect("run small.yaml -o set --set time.end=20ms --set contact.friction=0 --set contact.stiffness=2e5", 0,
                 "done");
    ck_assert_int_eq(small_shell("grep -q '^  stiffness: 200000$' set/scene.yaml"), 0);
    ck_assert_int_eq(small_shell("grep -q slip_speed set/scene.yaml"), 1); // nothing rubs
    small_expect("run small.yaml -o explicit --set time.end=1ms --set time.scheme=explicit --set time.step=0.2ms", 0,
                 "done");
    ck_assert_int_eq(small_shell("grep -q 'distance:' explicit/scene.yaml"), 1);
    small_put("three.yaml", three);
    small_expect("check three.yaml --quick", 0, "contact.stiffness 1e+05 to 2e+05 Pa");
    small_expect("run three.yaml -o three --set time.end=4ms", 0, "done");
    ck_assert_int_eq(small_shell("grep -q '^  distance: 0.0[01]' three/scene.yaml"), 0);
    ck_assert_int_eq(small_shell("grep -q '^  stiffness' three/scene.yaml"), 1);
}
END_TEST

// Planes push by barriers whichever way bodies meet each other, by none as well: the keys of barriers are theirs too,
// and what follows by default stands in the resolved scene, from which the same steps follow.
START_TEST(planes_push_where_bodies_pass_through_each_other) {
    small_put("floor.yaml", "brunt: 1\ndimension: 2\ntime: {scheme: implicit, end: 4 ms, step: 2 ms}\n"
                            "grid: {cell: 0.1}\n"
                            "materials: {soft: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
                            "bodies:\n"
                            "  a: {method: mpm, material: soft, shape: {box: {min: [0, 0.005], max: [0.2, 0.2]}}}\n"
                            "  b: {method: mpm, material: soft, shape: {box: {min: [0.3, 0.005], max: [0.5, 0.2]}}}\n"
                            "boundaries:\n"
                            "  - {plane: {point: [0, 0], normal: [0, 1]}, condition: separate, friction: 0.2}\n"
                            "loads: {gravity: [1, -10]}\ncontact: {method: none}\noutput: {every: none}\n");
    small_expect("run floor.yaml -o out", 0, "done");
    ck_assert_int_eq(small_shell("grep -q '^  distance: 0.00[45]' out/scene.yaml"), 0);
    small_expect("run out/scene.yaml -o again", 0, "done");
    check_same_state("out", "again");
    small_expect("check floor.yaml --quick --set contact.distance='4 mm' --set contact.stiffness='2 MPa'", 0,
                 "  contact.distance 0.004 m, contact.stiffness 2e+06 Pa\n");
    small_expect("check floor.yaml --quick --set contact.slip_speed='1 mm/s' --set contact.friction_iterations=2", 0,
                 "contact.slip_speed 0.001 m/s");
    small_expect("check floor.yaml --set contact.distance='4 mm' --set 'boundaries=[]'", 65,
                 "contact.distance: this belongs to method: barrier");
}
END_TEST

// Before bodies are near each other there is no gap: a least one, a mean and the first are of the lines that have one.
START_TEST(has_a_least_gap_from_where_there_is_one) {
    ck_assert_int_eq(
        small_shell("printf 'measures:\\n  least: {history: newton.least_gap, take: min}\\n"
                    "  first: {history: newton.least_gap, take: initial}\\n"
                    "  greatest: {history: newton.least_gap, take: max}\\n"
                    "  mean: {history: newton.least_gap, take: mean}\\n"
                    "  begins: {history: newton.least_gap, take: first_nonzero}\\n"
                    "  before: {history: newton.least_gap, take: min, to: 2 ms, expect: 1 m, tolerance: 1}\\n'"
                    " >> small.yaml"),
        0);
    small_expect("run small.yaml -o out", 0,
                 "before                         no value, there is nothing to take it from  FAIL");
    json_t *s = summary_of("out"), *m = json_object_get(s, "measures");
    ck_assert_double_eq(number_at(json_object_get(m, "least"), NULL, "value"), number_at(s, NULL, "least_gap"));
    ck_assert_double_gt(number_at(m, "mean", "value"), number_at(m, "least", "value"));
    ck_assert_double_lt(number_at(m, "mean", "value"), number_at(m, "greatest", "value"));
    ck_assert_double_gt(number_at(m, "begins", "value"), 2e-3);
    ck_assert(json_is_null(json_object_get(json_object_get(m, "first"), "value")));
    ck_assert(json_is_null(json_object_get(json_object_get(m, "before"), "value")));
    ck_assert(json_is_false(json_object_get(json_object_get(m, "before"), "ok")));
    json_decref(s);
}
END_TEST

START_TEST(is_the_scheme_that_is_set) {
    small_expect("run small.yaml -o out --set time.scheme=explicit --set time.step=0.2ms", 0, "done");
    json_t *s = summary_of("out");
    ck_assert_ptr_null(json_object_get(s, "newton"));
    json_decref(s);
}
END_TEST

// Friction acts at both sides of a gap, and backward Euler loses what turns (contact/barrier/README.md).
START_TEST(keeps_momentum) {
    static const char blocks[] = "brunt: 1\n"
                                 "dimension: 2\n"
                                 "time: {scheme: implicit, end: 40 ms, step: 0.2 ms, energy_limit: none}\n"
                                 "newton: {tolerance: 1e-9, solver: direct}\n"
                                 "materials: {soft: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
                                 "bodies:\n"
                                 "  a: {method: fem, element: quad4, size: 25 mm, material: soft, shape: {box: {min: "
                                 "[0, 0.07], max: [0.1, 0.17]}}, "
                                 "velocity: [3, -3]}\n"
                                 "  b: {method: fem, element: tri3, size: 25 mm, material: soft, shape: {box: {min: "
                                 "[0, -0.04], max: [0.2, 0.06]}}}\n"
                                 "contact: {distance: 5 mm}\n"
                                 "output: {every: none, history: 0}\n";
    static const struct {
        const char *how;
        double drift;
    } cases[] = {{"time.integrator=euler", 1.93e-3},
                 {"time.integrator=newmark", 4.7e-6},
                 {"time.integrator=newmark --set contact.friction=0.5", 5.75e-3},
                 {"time.integrator=euler --set contact.friction=0.5", 5.1e-3},
                 {"time.integrator=euler --set time.step=0.1ms", 0.88e-3},
                 {"time.integrator=newmark --set contact.friction=0.5 --set contact.distance=2.5mm", 2.5e-3}};
    char words[200];
    small_put("blocks.yaml", blocks);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        snprintf(words, sizeof words, "run blocks.yaml -o out -q --fresh --set %s", cases[k].how);
        small_expect(words, 0, NULL);
        json_t *s = summary_of("out");
        const double angular = number_at(s, "momentum", "angular_drift");
        printf("  %s: %.3g\n", cases[k].how, angular);
        ck_assert_double_lt(number_at(s, "momentum", "linear_drift"), 1e-14);
        ck_assert_double_lt(angular, 1.1 * cases[k].drift);
        ck_assert_double_gt(angular, 0.5 * cases[k].drift); // the document tells of it
        json_decref(s);
    }
}
END_TEST

// A scene with keys of both schemes: nothing but time.scheme is changed, in the file and in what it was resolved to.
static const char both[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 40 ms, scheme: implicit, step: 0.2 ms, integrator: newmark, least_step: 1 ns}\n"
    "newton: {tolerance: 1e-8}\n"
    "materials: {rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}\n"
    "bodies:\n"
    "  lower: {method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [0, -0.5], max: [0.5, 0]}}}\n"
    "  upper: {method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [0, 0.01], max: [0.5, 0.51]}}, "
    "velocity: [0, -1]}\n"
    "contact: {friction: 0.1, distance: 5 mm, slip_speed: 1 mm/s, friction_iterations: 2, iterations: 8}\n"
    "measures: {up: {history: body.upper.velocity_y}, work: {history: newton.iterations, expect: 3, tolerance: 1}}\n"
    "output: {every: none, checkpoint: none}\n";

static const char *const of_implicit[] = {
    "3:52: time.integrator: of implicit", "4:1: newton: of implicit", "9:26: contact.distance: of implicit",
    "9:42: contact.slip_speed: of implicit", "9:62: contact.friction_iterations: of implicit"};
static const char *const of_explicit[] = {"3:73: time.least_step: of explicit",
                                          "9:86: contact.iterations: of explicit"};

// What a command says of keys of the other scheme: all of them, and no more.
static void check_notes(const char *words, const char *const *notes, int count) {
    char text[160];
    for (int i = 0; i < count; i++) {
        snprintf(text, sizeof text, "warning: both.yaml:%s steps, not used by %s ones", notes[i],
                 strstr(notes[i], "implicit") ? "explicit" : "implicit");
        small_expect(words, 0, text);
    }
    ck_assert_int_eq(small_shell("test `grep -c 'steps, not used by' output` = %d", count), 0);
}

START_TEST(runs_by_both) {
    small_put("both.yaml", both);
    check_notes("check both.yaml --quick", of_explicit, 2);
    check_notes("check both.yaml --quick --set time.scheme=explicit", of_implicit, 5);
    // What the other scheme does not have is not measured, and no reason to go without the rest.
    small_expect("check both.yaml --quick --set time.scheme=explicit", 0,
                 "warning: both.yaml:10:66: measures.work.history: not measured");
    small_expect("check both.yaml --quick --set time.scheme=explicit --set measures.work.history=newton.work", 65,
                 "'newton.work' is no column of the history");
    check_notes("run both.yaml --fresh -o implicit", of_explicit, 2);
    check_notes("run both.yaml --fresh -o explicit --set time.scheme=explicit", of_implicit, 5);
    ck_assert_int_eq(small_shell("grep -q 'work  *not measured' output"), 0);
    const char *const folders[] = {"implicit", "explicit"};
    for (int i = 0; i < 2; i++) {
        json_t *s = summary_of(folders[i]);
        ck_assert((json_object_get(s, "newton") != NULL) == !i); // no part of the other scheme is there
        const json_t *work = json_object_get(json_object_get(s, "measures"), "work");
        ck_assert(json_is_number(json_object_get(work, "value")) == !i);
        ck_assert(json_is_boolean(json_object_get(work, "ok")) == !i);
        // Two blocks that are alike exchange their velocities, less what goes on swinging in them.
        const double up = number_at(json_object_get(json_object_get(s, "measures"), "up"), NULL, "value");
        ck_assert_msg(up > -0.25 && up < 0.05, "%s: %g m/s", folders[i], up);
        json_decref(s);
    }
    // What was resolved has the keys of both, and goes on being of both.
    small_expect("run explicit/scene.yaml -o again -q --set time.scheme=implicit", 0, NULL);
    small_expect("run implicit/scene.yaml -o back -q --set time.scheme=explicit", 0, NULL);
    const char *const pairs[][2] = {{"implicit", "again"}, {"explicit", "back"}};
    for (int i = 0; i < 2; i++) {
        json_t *a = summary_of(pairs[i][0]), *b = summary_of(pairs[i][1]);
        ck_assert_str_eq(json_string_value(json_object_get(a, "state_hash")),
                         json_string_value(json_object_get(b, "state_hash")));
        json_decref(a), json_decref(b);
    }
    // What is given by name is kept to.
    small_expect("check both.yaml --set contact.method=barrier --set time.scheme=explicit", 65,
                 "where no method is given each scheme takes its own");
    small_expect("check both.yaml --set contact.method=augury", 65,
                 "where no method is given each scheme takes its own");
}
END_TEST

START_TEST(in_two_legs) {
    small_expect("run small.yaml -o whole -q -t 2", 0, NULL);
    pid_t child = small_begin("legs", "legs/vtu/upper_000002.vtu", NULL, 0);
    ck_assert_int_eq(small_end(child, SIGTERM), 75);
    small_expect("run small.yaml -o legs -q --resume", 0, NULL);
    json_t *whole = summary_of("whole"), *legs = summary_of("legs");
    ck_assert_str_eq(json_string_value(json_object_get(whole, "state_hash")),
                     json_string_value(json_object_get(legs, "state_hash")));
    ck_assert_double_eq(number_at(whole, "newton", "iterations"), number_at(legs, "newton", "iterations"));
    ck_assert_double_eq(number_at(whole, NULL, "least_gap"), number_at(legs, NULL, "least_gap"));
    json_decref(whole), json_decref(legs);
}
END_TEST

// Its second step has no end: tolerance and iterations are beyond reach. What the first has left is what it is stopped
// with, once it has been at the second for a while by the processor's time.
START_TEST(stops_within_a_step) {
    static const int signals[] = {SIGTERM, SIGINT};
    static const char *const more[] = {"--set", "newton.tolerance=1e-30", "--set", "newton.iterations=100000"};
    small_put(
        "small.yaml",
        "brunt: 1\ntitle: pressed from the second step on\ndimension: 2\n"
        "time: {end: 10 ms, scheme: implicit, step: 1 ms}\n"
        "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\n"
        "bodies: {low: {method: fem, material: rubber, size: 0.05, shape: {box: {min: [0, 0], max: [0.4, 0.2]}}}}\n"
        "boundaries:\n  - {name: ground, body: low, group: ymin, fix: all}\n"
        "  - {name: press, body: low, group: ymax, traction: [0, -1 kPa], table: [[1 ms, 0], [2 ms, 1]]}\n"
        "output: {every: 1 ms, history: 1 ms, checkpoint: 10 min}\n");
    pid_t child = small_begin("out", "out/vtu/low_000001.vtu", more, 4);
    const double begin = seconds_of(child);
    while (seconds_of(child) < begin + 0.3) small_wait(0.002);
    ck_assert_int_eq(small_end(child, signals[_i]), 75);
    json_t *s = summary_of("out");
    ck_assert_str_eq(json_string_value(json_object_get(s, "status")), "stopped");
    const char *reason = json_string_value(json_object_get(s, "reason"));
    ck_assert_str_eq(reason, "stopped by a signal at t = 0.001 s; go on with --resume");
    ck_assert_double_eq(number_at(s, NULL, "time"), 1e-3);
    ck_assert_double_eq(number_at(s, NULL, "steps"), 1);
    ck_assert_double_lt(number_at(s, "newton", "iterations"), 2); // those of the second do not count
    json_decref(s);
    small_expect("info out/checkpoint.h5", 0, "time       0.001 s\nstep       1\n");
    ck_assert_int_eq(small_shell("grep -q 'checkpoint at t = 0.001 s, step 1' out/log.txt"), 0);
    ck_assert_int_eq(small_shell("test $(grep -c . out/history.csv) = 3"), 0);
}
END_TEST

START_TEST(that_does_not_converge_is_70) {
    small_expect("run small.yaml -o out --set newton.iterations=1 --set newton.cut=1", 70, "does not converge");
    small_expect("info out/checkpoint.h5", 0, "FAILED");
    ck_assert(small_exists("out/vtu/upper_000000.vtu"));
    // What was tried counts: two times one iteration, of a step that was cut once.
    json_t *s = summary_of("out");
    ck_assert_double_eq(number_at(s, "newton", "steps"), 0);
    ck_assert_double_eq(number_at(s, "newton", "iterations"), 2);
    ck_assert_double_eq(number_at(s, "newton", "iterations_worst"), 2);
    ck_assert_double_eq(number_at(s, "newton", "cuts"), 1);
    json_decref(s);
}
END_TEST

// A step that was not solved has changed nothing: a run goes on by other keys of its solution with the bits, pictures
// and lines of one that had them from there on.
START_TEST(goes_on_where_a_step_failed) {
    static const char failing[] = "--set newton.iterations=3 --set newton.cut=0",
                      going[] = "--set newton.iterations=50";
    char words[240];
    // Steps and times that are binary fractions: a run that ends at one of them is there to the bit.
    ck_assert_int_eq(small_shell("sed -i 's/step: 2 ms/step: 0.0078125/; s/every: 20 ms, history: 2 ms/every: "
                                 "0.0625, history: 0/' small.yaml"),
                     0);
    snprintf(words, sizeof words, "run small.yaml -o out %s", failing);
    small_expect(words, 70, "--resume goes on from t = 0.0");
    small_expect("info out/checkpoint.h5", 0, "the step has changed nothing");
    ck_assert_int_eq(small_shell("grep '^t = ' out/log.txt | cut -d' ' -f3 > end"), 0);
    snprintf(words, sizeof words, "run small.yaml -o out --resume %s", failing);
    small_expect(words, 70, "does not converge");
    small_expect("run small.yaml -o out --resume --set contact.friction=0.3", 65, "made from another scene: 'friction");
    snprintf(words, sizeof words, "run small.yaml -o out --resume %s --set time.step=0.00390625", going);
    small_expect(words, 0, "resumed at t = 0.0");
    ck_assert_int_eq(small_shell("$B run small.yaml -o two -q %s --set time.end=`cat end`", failing), 0);
    snprintf(words, sizeof words, "run small.yaml -o two --resume %s --set time.step=0.00390625", going);
    small_expect(words, 0, "resumed at t = 0.0");
    check_same_state("out", "two");
    ck_assert_int_eq(
        small_shell("cmp out/history.csv two/history.csv && ! grep -q 'timestep=\"0.03125\"' out/brunt.pvd"),
        0); // where it failed no picture was due
    json_t *s = summary_of("out");
    ck_assert_double_gt(number_at(s, "newton", "steps"), 45); // of half the length
    json_decref(s);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_implicit");
    TCase *tests = tcase_create("program_implicit");
    tcase_add_checked_fixture(tests, set_up, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, says_what_it_does);
    tcase_add_test(tests, says_how_contact_is);
    tcase_add_test(tests, has_its_defaults_in_the_scene);
    tcase_add_test(tests, planes_push_where_bodies_pass_through_each_other);
    tcase_add_test(tests, has_a_least_gap_from_where_there_is_one);
    tcase_add_test(tests, keeps_momentum);
    tcase_add_test(tests, is_the_scheme_that_is_set);
    tcase_add_test(tests, runs_by_both);
    tcase_add_test(tests, in_two_legs);
    tcase_add_loop_test(tests, stops_within_a_step, 0, 2);
    tcase_add_test(tests, that_does_not_converge_is_70);
    tcase_add_test(tests, goes_on_where_a_step_failed);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#endif
