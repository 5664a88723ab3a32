// What a run is predicted to cost, against the run itself.
#include "tests/support/small_scene.h"

#include <math.h>

#include "tests/support/fake_clock.h"
#include "io/output/history.h"
#include "io/performance/predict.h"
#include "tests/support/suite.h"

// Two soft blocks of material points that meet after an eighth of the time: contact costs nothing until then.
static const char touching[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 0.4 s, cfl: 0.5}\n"
    "grid: {cell: 10 mm}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 40 kPa, nu: 0.3}\n"
    "bodies:\n"
    "  left: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [0.5, 1]}}, velocity: [1, 0]}\n"
    "  right: {method: mpm, material: rubber, shape: {box: {min: [0.6, 0], max: [1.1, 1]}}, velocity: [-1, 0]}\n"
    "contact: {method: multi-velocity}\n"
    "output: {every: 20 ms, history: 2 ms}\n";

// Two blocks of elements that meet after half of the time.
static const char meeting[] = "brunt: 1\n"
                              "dimension: 2\n"
                              "time: {end: 0.4 s, cfl: 0.5}\n"
                              "grid: {cell: 12.5 mm}\n"
                              "materials:\n"
                              "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
                              "bodies:\n"
                              "  left: {method: fem, size: 8 mm, material: rubber, shape: {box: {min: [0, 0], max: "
                              "[0.5, 1]}}, velocity: [1, 0]}\n"
                              "  right: {method: fem, size: 8 mm, material: rubber, shape: {box: {min: [0.9, 0], "
                              "max: [1.4, 1]}}, velocity: [-1, 0]}\n"
                              "contact: {method: augury}\n"
                              "output: {every: 20 ms, history: 2 ms}\n";

// A rod that is pressed together on a wall until its step is a fraction of the first.
static const char pressed[] = "brunt: 1\n"
                              "dimension: 2\n"
                              "time: {end: 60 ms, cfl: 0.5}\n"
                              "grid: {cell: 5 mm}\n"
                              "materials:\n"
                              "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 0.1 MPa, nu: 0.45}\n"
                              "bodies:\n"
                              "  rod: {method: fem, size: 3 mm, material: rubber, shape: {box: {min: [0, 0], max: "
                              "[0.2, 0.6]}}, velocity: [0, -6]}\n"
                              "boundaries:\n"
                              "  - {name: foot, body: rod, group: ymin, fix: all}\n"
                              "output: {every: none}\n";

typedef struct made {
    brunt_scene scene;
    brunt_world *world;
    brunt_history *history;
} made;

static void make(made *m) {
    brunt_error error = {0};
    m->scene.world.threads = 1;
    m->world = brunt_world_create(&m->scene.world, &error);
    ck_assert_msg(m->world != NULL, "%s", error.message);
    m->history = brunt_history_create(m->world, &m->scene, &error);
    ck_assert_msg(m->history != NULL, "%s", error.message);
}

static made make_text(const char *text, const char *set) {
    made m;
    small_scene_of(text, &m.scene, &set, set ? 1 : 0);
    make(&m);
    return m;
}

static void destroy(made *m) {
    brunt_history_destroy(m->history);
    brunt_world_destroy(m->world);
    brunt_scene_free(&m->scene);
}

static brunt_prediction predict(made *m, bool quick) {
    brunt_prediction p;
    brunt_error error = {0};
    int status = brunt_predict(&m->scene, m->world, m->history, quick, &p, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    double sum = 0;
    for (int32_t i = 0; i < p.pass_count; i++) {
        ck_assert(p.passes[i].seconds >= 0);
        sum += p.passes[i].seconds;
    }
    ck_assert_double_eq_tol(sum, p.step_seconds, 1e-9 * sum);
    ck_assert(p.output_seconds > 0 && isfinite(p.output_seconds));
    ck_assert(p.peak_bytes > p.array_bytes);
    return p;
}

static double pass_seconds(const brunt_world *world, const char *name) {
    for (int32_t i = 0; i < brunt_pass_count(world); i++)
        if (!strcmp(brunt_world_pass(world, i).name, name)) return brunt_world_pass(world, i).seconds;
    ck_abort_msg("no pass %s", name);
    return 0;
}

static double predicted_seconds(const brunt_prediction *p, const char *name) {
    for (int32_t i = 0; i < p->pass_count; i++)
        if (!strcmp(p->passes[i].name, name)) return p->passes[i].seconds;
    ck_abort_msg("no pass %s", name);
    return 0;
}

// To the end of the run, its steps cut at multiples of `every`.
static void run(made *m, double every) {
    brunt_error error = {0};
    for (int64_t k = 1; brunt_world_time(m->world) < brunt_world_end(m->world);)
        if (brunt_world_time(m->world) >= (double)k * every * (1 - 1e-12))
            k++;
        else
            ck_assert_msg(brunt_world_step(m->world, (double)k * every, &error) == BRUNT_OK, "%s", error.message);
}

START_TEST(a_short_run_is_taken_as_it_is) {
    made m = make_text(small_scene_text, NULL);
    brunt_prediction p = predict(&m, false);
    ck_assert(p.factor == 1 && p.rehearsed == 1 && p.note[0] == 0);
    made again = make_text(small_scene_text, NULL);
    run(&again, 1e-2);
    ck_assert(p.steps == (double)brunt_world_steps(again.world));
    ck_assert(p.steps == (double)brunt_world_steps(m.world));
    destroy(&m);
    destroy(&again);
}
END_TEST

START_TEST(contact_that_comes_later_is_seen) {
    made m = make_text(touching, NULL), early = make_text(touching, NULL), again = make_text(touching, NULL);
    brunt_prediction p = predict(&m, false), at_start = predict(&early, true);
    ck_assert(p.factor >= 1 && p.rehearsed == 1); // 1 where the machine is so fast that the run itself is short
    run(&again, 2e-2);
    double steps = (double)brunt_world_steps(again.world);
    ck_assert_double_eq_tol(p.steps, steps, 0.05 * steps);
    const double predicted = predicted_seconds(&p, "contact"), seen = predicted_seconds(&at_start, "contact");
    printf("  contact %.3g s, predicted %.3g s, from the first steps alone %.3g s, of %.3g s\n",
           pass_seconds(again.world, "contact"), predicted, seen, p.step_seconds);
    destroy(&m);
    destroy(&early);
    destroy(&again);
}
END_TEST

START_TEST(steps_that_shrink_are_counted) {
    made m = make_text(pressed, NULL), again = make_text(pressed, NULL);
    brunt_prediction p = predict(&m, false);
    run(&again, INFINITY);
    double steps = (double)brunt_world_steps(again.world), as_first = brunt_world_end(again.world) / p.first_step;
    ck_assert_msg(steps > 1.3 * as_first, "%g steps, %g at the first one's length", steps, as_first);
    printf("  %g steps, predicted %g by one %g times coarser\n", steps, p.steps, p.factor);
    ck_assert_msg(fabs(p.steps / steps - 1) < 0.25 && p.steps > 1.05 * as_first, "%g steps, predicted %g", steps,
                  p.steps);
    destroy(&m);
    destroy(&again);
}
END_TEST

START_TEST(a_fixed_step_is_kept) {
    made m = make_text(meeting, "time={end: 0.4 s, step: 0.1 ms}");
    brunt_prediction p = predict(&m, false);
    ck_assert_double_eq_tol(p.steps, 4000, 1);
    destroy(&m);
}
END_TEST

START_TEST(quick_leaves_the_rehearsal_out) {
    made m = make_text(meeting, NULL);
    brunt_prediction p = predict(&m, true);
    ck_assert(p.factor == 0 && p.rehearsed < 1);
    ck_assert_ptr_nonnull(strstr(p.note, "not rehearsed"));
    destroy(&m);
}
END_TEST

START_TEST(given_meshes_stay_and_it_says_so) {
    made m;
    brunt_error error = {0};
    const char *set = "time.end=1 s";
    small_scene_of(meeting, &m.scene, &set, 1);
    for (int32_t b = 0; b < m.scene.world.body_count; b++) {
        brunt_body_def *body = &m.scene.world.bodies[b];
        ck_assert_int_eq(brunt_mesh_shape(&body->shape, 2, BRUNT_QUAD4, body->size, &body->mesh, &error), BRUNT_OK);
    }
    make(&m);
    brunt_prediction p = predict(&m, false);
    ck_assert(p.factor == 1 || (p.factor == 0 && p.rehearsed > 0 && p.rehearsed < 1));
    if (p.factor == 0) ck_assert_ptr_nonnull(strstr(p.note, "cannot be made coarser"));
    destroy(&m);
}
END_TEST

// Fails after some steps: the cost until then, and why, are known.
START_TEST(a_run_that_fails_is_no_failure) {
    made m = make_text(small_scene_text, "time.energy_limit=1e-9");
    brunt_prediction p = predict(&m, false);
    ck_assert_ptr_nonnull(strstr(p.note, "the run will fail"));
    ck_assert(p.steps > 3 && brunt_world_time(m.world) < brunt_world_end(m.world));
    destroy(&m);
}
END_TEST

// A plane of symmetry that is on a line of the grid, but on none of a coarser one.
START_TEST(worlds_that_cannot_be_made_are_passed_over) {
    const char *sets[] = {
        "boundaries=[{name: left, plane: {point: [12.5 mm, 0], normal: [1, 0]}, condition: symmetry}]",
        "bodies.left.shape.box.min=[12.5 mm, 0]",
        "bodies.left={method: mpm, material: rubber, shape: {box: {min: [12.5 mm, 0], max: [0.5, 1]}}}", "time.end=4 s",
        "contact.method=multi-velocity"};
    made m;
    small_scene_of(meeting, &m.scene, sets, 5);
    make(&m);
    brunt_prediction p = predict(&m, false);
    ck_assert(p.steps > 0 && p.step_seconds > 0);
    ck_assert(p.factor != 1);
    destroy(&m);
}
END_TEST

// The world itself is as good as before: what it was made of is still the scene's.
START_TEST(the_scene_is_left_as_it_was) {
    made m = make_text(meeting, NULL), again = make_text(meeting, NULL);
    predict(&m, false);
    char *before = small_scene_resolved(&again.scene), *after = small_scene_resolved(&m.scene);
    ck_assert_str_eq(before, after);
    free(before), free(after);
    made third = {.scene = m.scene};
    make(&third); // of the definition that was rehearsed
    for (int step = 0; step < 50; step++) {
        brunt_error error;
        ck_assert_int_eq(brunt_world_step(again.world, INFINITY, &error), BRUNT_OK);
        ck_assert_int_eq(brunt_world_step(third.world, INFINITY, &error), BRUNT_OK);
    }
    ck_assert(brunt_world_hash(again.world) == brunt_world_hash(third.world));
    brunt_history_destroy(third.history);
    brunt_world_destroy(third.world);
    destroy(&m);
    destroy(&again);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("predict");
    TCase *tests = tcase_create("predict");
    tcase_add_test(tests, a_short_run_is_taken_as_it_is);
    tcase_add_test(tests, contact_that_comes_later_is_seen);
    tcase_add_test(tests, steps_that_shrink_are_counted);
    tcase_add_test(tests, a_fixed_step_is_kept);
    tcase_add_test(tests, quick_leaves_the_rehearsal_out);
    tcase_add_test(tests, given_meshes_stay_and_it_says_so);
    tcase_add_test(tests, a_run_that_fails_is_no_failure);
    tcase_add_test(tests, worlds_that_cannot_be_made_are_passed_over);
    tcase_add_test(tests, the_scene_is_left_as_it_was);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
