// The passes are all of the step, observers see them as they are booked, and timing costs next to nothing.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fake_clock.h"
#include "tests/support/small_scene.h"

// ---------------------------------------------------------------------------------------------------- scenes

// About a hundred particles: where what lies between passes would show.
static const char tiny_text[] = "brunt: 1\n"
                                "dimension: 2\n"
                                "time: {end: 1 s}\n"
                                "grid: {cell: 0.1 m, kernel: linear}\n"
                                "materials:\n"
                                "  rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}\n"
                                "bodies:\n"
                                "  block: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [0.5, 0.5]}},"
                                " velocity: [1, 0]}\n"
                                "output: {every: none}\n";

typedef struct place {
    const char *name, *text, *file; // text or file
    const char *sets[4];
    const char *passes; // that the scene is here for
} place;

static const place places[] = {
    {"tiny, linear with remap", tiny_text, NULL, {NULL}, "musl_velocity"},
    {"contact and wall of particles", small_scene_text, NULL, {NULL}, "contact boundaries"},
    {"elements, contact, groups", small_elements_text, NULL, {NULL}, "surfaces groups kick drift elements"},
    {"membrane with gas", NULL, "bench/scenes/gas_in_membrane.yaml", {NULL}, "groups elements"},
    {"falling water", NULL, "bench/scenes/dam_break.yaml", {"grid.cell=20 mm", "output.every=none"}, "p2g g2p"},
    {"erosion", NULL, "bench/scenes/plate_weldox_blunt.yaml", {NULL}, "erosion surfaces"},
    {"many small bodies",
     tiny_text,
     NULL,
     {"bodies.a={method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [2, 0], max: [2.3, 0.3]}}}",
      "bodies.b={method: fem, material: rubber, size: 0.1 m, damping: 3 Hz, shape: {box: {min: [3, 0], max: [3.3, "
      "0.3]}}}",
      "boundaries=[{name: left, plane: {point: [-1, 0], normal: [1, 0]}, condition: symmetry},"
      " {name: low, plane: {point: [0, -1], normal: [0, 1]}, condition: stick}]"},
     "symmetry conditions kick drift"},
};
enum { PLACES = sizeof places / sizeof *places, STEPS = 20, PAUSE = 200 };

static brunt_world *make(const place *p, brunt_scene *scene, int threads) {
    int sets = 0;
    while (sets < 4 && p->sets[sets]) sets++;
    if (p->text)
        small_scene_of(p->text, scene, p->sets, sets);
    else
        ck_assert_int_eq(brunt_scene_read(p->file, (const char **)(void *)p->sets, sets, scene, stderr), BRUNT_OK);
    scene->world.threads = threads;
    return small_world(scene);
}

static brunt_pass find(const brunt_world *world, const char *name, size_t length) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++) {
        brunt_pass pass = brunt_world_pass(world, p);
        if (strlen(pass.name) == length && !strncmp(pass.name, name, length)) return pass;
    }
    ck_abort_msg("there is no pass %.*s", (int)length, name);
}

static double sum_of_passes(const brunt_world *world) {
    double sum = 0;
    for (int32_t p = 0; p < brunt_pass_count(world); p++) sum += brunt_world_pass(world, p).seconds;
    return sum;
}

// 20 steps; the time by a clock outside of them [s].
static double take_steps(brunt_world *world) {
    brunt_error error = {0};
    double inside = 0;
    for (int s = 0; s < STEPS; s++) {
        double start = brunt_clock();
        int status = brunt_world_step(world, INFINITY, &error);
        inside += brunt_clock() - start;
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    }
    return inside;
}

// ---------------------------------------------------------------------------------------------------- the sum

// To the tick: a step is its passes, and the clock outside is read once before it begins and once after it ended.
START_TEST(passes_are_all_of_the_step) {
    const place *p = &places[_i / 2];
    const int threads = 1 + _i % 2;
    brunt_scene scene;
    brunt_world *world = make(p, &scene, threads);
    ck_assert_double_eq(brunt_world_step_seconds(world), 0);
    double clock = take_steps(world), seconds = brunt_world_step_seconds(world);
    ck_assert_double_gt(seconds, STEPS * fake_tick);
    ck_assert_double_eq(sum_of_passes(world), seconds);
    ck_assert_double_eq(clock - seconds, 2 * STEPS * fake_tick);
    for (const char *word = p->passes; *word; word += strcspn(word, " ") + (word[strcspn(word, " ")] == ' ')) {
        brunt_pass pass = find(world, word, strcspn(word, " "));
        ck_assert_int_ge(pass.calls, STEPS);
        ck_assert_double_gt(pass.seconds, 0);
    }
    for (int32_t k = 0; k < brunt_pass_count(world); k++) { // no thread works longer than its pass
        brunt_pass pass = brunt_world_pass(world, k);
        for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) ck_assert_double_le(pass.thread_seconds[t], pass.seconds);
    }
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- observers

typedef struct watch {
    const brunt_world *world;
    int32_t pass; // that runs; -1: none
    int64_t calls[32], threads;
    double begin, last, seconds[32], busy[32];
} watch;

static void on_begin(void *context, int32_t pass, double time) {
    watch *w = context;
    ck_assert_int_eq(w->pass, -1); // passes do not nest
    ck_assert_double_ge(time, w->last);
    w->pass = pass, w->begin = w->last = time;
}

static void on_thread(void *context, int32_t pass, int32_t thread, double begin, double end) {
    watch *w = context;
    ck_assert_int_eq(pass, w->pass);
    ck_assert(thread >= 0 && thread < brunt_world_threads(w->world) && begin >= w->begin && end >= begin);
    w->busy[pass] += end - begin, w->threads++;
}

static void on_end(void *context, int32_t pass, double begin, double end) {
    watch *w = context;
    ck_assert_int_eq(pass, w->pass);
    ck_assert(begin >= w->begin && end >= begin);
    atomic_fetch_add(&fake_ticks, PAUSE); // what an observer takes is no time of the step
    w->calls[pass]++, w->seconds[pass] += end - begin, w->pass = -1, w->last = end;
}

START_TEST(observers_see_what_is_accounted) {
    const place *p = &places[_i];
    brunt_scene scene;
    brunt_world *world = make(p, &scene, 2);
    watch w = {.world = world, .pass = -1};
    brunt_world_observe(world, &(brunt_observer){&w, on_begin, on_thread, on_end});
    double clock = take_steps(world), sum = sum_of_passes(world);
    for (int32_t k = 0; k < brunt_pass_count(world); k++) {
        brunt_pass pass = brunt_world_pass(world, k);
        double busy = 0;
        for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) busy += pass.thread_seconds[t];
        ck_assert_int_eq(w.calls[k], pass.calls);
        ck_assert_double_eq(w.seconds[k], pass.seconds);
        ck_assert_double_eq(w.busy[k], busy);
    }
    ck_assert_int_gt(w.threads, 0);
    int64_t calls = 0;
    for (int32_t k = 0; k < brunt_pass_count(world); k++) calls += w.calls[k];
    ck_assert_double_eq(sum, brunt_world_step_seconds(world));
    ck_assert_double_ge(clock - sum, PAUSE * fake_tick * (double)calls);
    const int64_t told = w.threads;
    brunt_world_observe(world, NULL);
    take_steps(world);
    ck_assert_int_eq(w.threads, told);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
}
END_TEST

// A step that fails leaves in the midst of a pass, which is ended all the same.
START_TEST(failed_steps_are_accounted) {
    static const place failing = {"failing", tiny_text, NULL, {"time.least_step=0.5 s"}, ""};
    brunt_scene scene;
    brunt_world *world = make(&failing, &scene, 1);
    watch w = {.world = world, .pass = -1};
    brunt_world_observe(world, &(brunt_observer){&w, on_begin, on_thread, on_end});
    brunt_error error = {0};
    int status = BRUNT_OK;
    for (int s = 0; s < 200 && !status; s++) status = brunt_world_step(world, INFINITY, &error);
    ck_assert_int_eq(status, BRUNT_FAILED);
    ck_assert_int_eq(w.pass, -1);
    ck_assert_double_eq(sum_of_passes(world), brunt_world_step_seconds(world));
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- their cost

START_TEST(timers_cost_next_to_nothing) {
    enum { UNSEEN = 100 }; // instructions of a reading of the clock in the kernel's page, which valgrind does not run
    char folder[] = "/tmp/brunt_timers_XXXXXX", command[256], dress[16];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(command, sizeof command, "sh tests/support/timers.sh %s", folder);
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    double step, timers, readings, share[4];
    int count = 0;
    while (count < 4 && fscanf(pipe, "%15s %lf %lf %lf", dress, &step, &timers, &readings) == 4) {
        share[count++] = (timers + UNSEEN * readings) / step;
        printf("  %-6s %.0f instructions a step, %.0f readings of the clock, timers %.4f %%\n", dress, step, readings,
               100 * share[count - 1]);
        ck_assert_double_gt(timers, 20 * readings); // they are seen
        ck_assert_double_ge(readings, 8);
    }
    int status = pclose(pipe);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
    ck_assert_int_eq(status, 0);
    ck_assert_int_eq(count, 3);
    ck_assert_double_le(share[0], 0.001); // 4096 particles
    ck_assert_double_le(share[1], 0.002); // 1000 hex8
    ck_assert_double_le(share[2], 0.005); // 125 particles
}
END_TEST

int main(void) {
    Suite *suite = suite_create("timers");
    TCase *sums = tcase_create("sums");
    tcase_set_timeout(sums, 0);
    tcase_add_loop_test(sums, passes_are_all_of_the_step, 0, 2 * PLACES);
    tcase_add_loop_test(sums, observers_see_what_is_accounted, 0, PLACES);
    tcase_add_test(sums, failed_steps_are_accounted);
    TCase *cost = tcase_create("cost");
    tcase_set_timeout(cost, 0);
    tcase_add_test(cost, timers_cost_next_to_nothing);
    suite_add_tcase(suite, sums);
    suite_add_tcase(suite, cost);
    return suite_main(suite);
}
