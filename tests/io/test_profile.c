// The profile of a run: its parts are the steps, its figures follow from each other, and nothing of it needs what a
// machine may not have.
#include <jansson.h>
#include <math.h>

#include "io/performance/counters.h"
#include "tests/support/fake_clock.h"
#include "io/performance/profile.h"
#include "io/performance/roofline.h"
#include "io/run/run.h"
#include "tests/support/small_scene.h"

static void set_up(void) { small_folder_make(); }
static void tear_down(void) { small_folder_remove(); }

// `profile` of the summary; json_decref.
static json_t *profile_of(const char *text, int threads, bool asked) {
    brunt_scene scene;
    small_scene_of(text, &scene, NULL, 0);
    scene.world.threads = threads;
    const brunt_run_options options = {.folder = small_folder, .profile = asked};
    brunt_error error;
    ck_assert_msg(brunt_run(&scene, &options, &error) == BRUNT_OK, "%s", error.message);
    brunt_scene_free(&scene);
    json_t *summary = json_load_file(small_path("summary.json"), 0, NULL);
    ck_assert_ptr_nonnull(summary);
    json_t *profile = json_incref(json_object_get(summary, "profile"));
    json_decref(summary);
    return profile;
}

static double number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    ck_assert_msg(json_is_number(value), "%s is no number", key);
    return json_number_value(value);
}

static const json_t *row_of(const json_t *profile, const char *name) {
    const json_t *passes = json_object_get(profile, "passes");
    for (size_t p = 0; p < json_array_size(passes); p++)
        if (strcmp(json_string_value(json_object_get(json_array_get(passes, p), "name")), name) == 0)
            return json_array_get(passes, p);
    return NULL;
}

// What holds of any profile.
static void check(const json_t *profile, int threads) {
    const double steps = number(profile, "step_s"), bandwidth = number(profile, "bandwidth_bytes_per_s"),
                 peak = number(profile, "peak_flops_per_s");
    const json_t *passes = json_object_get(profile, "passes");
    double seconds = 0, shares = 0;
    ck_assert_double_gt(steps, 0);
    ck_assert_int_eq((int)number(profile, "threads"), threads);
    for (size_t p = 0; p < json_array_size(passes); p++) {
        const json_t *row = json_array_get(passes, p);
        const double time = number(row, "seconds"), units = number(row, "units");
        seconds += time, shares += number(row, "share");
        ck_assert_double_ge(number(row, "calls"), 1);
        ck_assert_int_eq((int)json_array_size(json_object_get(row, "thread_s")), threads);
        if (!json_is_null(json_object_get(row, "imbalance"))) {
            ck_assert_double_ge(number(row, "imbalance"), 1 - 1e-12);
            ck_assert_double_le(number(row, "imbalance"), threads + 1e-12);
        }
        if (json_is_null(json_object_get(row, "roofline"))) {
            ck_assert(json_is_null(json_object_get(row, "bytes_per_unit")));
            ck_assert(json_is_null(json_object_get(row, "bound")));
            continue;
        }
        ck_assert_double_eq_tol(number(row, "ns_per_unit") * units, 1e9 * time, 1e-6 * 1e9 * time);
        const double memory = number(row, "bytes_per_unit") * units / bandwidth / time;
        const double compute = number(row, "flops_per_unit") * units / peak / time;
        const bool bytes = strcmp(json_string_value(json_object_get(row, "bound")), "memory") == 0;
        ck_assert_double_eq_tol(number(row, "roofline"), fmax(memory, compute), 1e-6);
        ck_assert_int_eq(bytes, memory >= compute);
        ck_assert_double_gt(number(row, "roofline"), 0);
    }
    ck_assert_double_eq(seconds, number(profile, "pass_s"));
    ck_assert_double_eq(seconds, steps);
    ck_assert_double_eq_tol(shares, 1, 1e-12);
}

// Of the two small scenes on one thread, made once.
static json_t *points, *elements;

static void make_profiles(void) {
    set_up();
    points = profile_of(small_scene_text, 1, true);
    tear_down();
    set_up();
    elements = profile_of(small_elements_text, 1, true);
    tear_down();
}

static void free_profiles(void) { json_decref(points), json_decref(elements); }

START_TEST(parts_are_the_steps) {
    check(points, 1), check(elements, 1);
    const char *const texts[] = {small_scene_text, small_elements_text};
    for (int t = 0; t < 2; t++) {
        json_t *profile = profile_of(texts[t], 2, true);
        ck_assert_ptr_nonnull(profile);
        check(profile, 2);
        json_decref(profile);
    }
}
END_TEST

// More threads than a machine has cores: each has its time, those of one pass are as many as there are threads, and the
// imbalance is over all of them.
START_TEST(each_of_many_threads_is_told) {
    json_t *profile = profile_of(small_scene_text, 100, true);
    check(profile, 100);
    const json_t *row = row_of(profile, "g2p"), *threads = json_object_get(row, "thread_s");
    double sum = 0, most = 0;
    for (size_t t = 0; t < json_array_size(threads); t++) {
        const double busy = json_number_value(json_array_get(threads, t));
        sum += busy, most = fmax(most, busy);
    }
    ck_assert_double_eq_tol(number(row, "imbalance"), most / (sum / 100), 1e-9 * 100);
    json_decref(profile);
}
END_TEST

// Every pass there is has a row, and what a scene does not ask for has none.
START_TEST(rows_are_those_of_the_scene) {
    static const char *const of_points[] = {"sort", "p2g", "grid", "update", "contact", "boundaries", "ledger", "g2p"};
    static const char *const of_elements[] = {"kick", "groups", "surfaces", "drift", "elements"};
    for (size_t k = 0; k < sizeof of_points / sizeof *of_points; k++) {
        ck_assert_ptr_nonnull(row_of(points, of_points[k]));
        ck_assert_ptr_null(row_of(elements, of_points[k]));
    }
    for (size_t k = 0; k < sizeof of_elements / sizeof *of_elements; k++) {
        ck_assert_ptr_nonnull(row_of(elements, of_elements[k]));
        ck_assert_ptr_null(row_of(points, of_elements[k]));
    }
    ck_assert_ptr_null(row_of(points, "erosion"));
    ck_assert_ptr_null(row_of(points, "musl_velocity"));
    // Counted where the work is fixed.
    ck_assert(json_is_number(json_object_get(row_of(points, "g2p"), "roofline")));
    ck_assert(json_is_number(json_object_get(row_of(elements, "elements"), "roofline")));
    ck_assert(json_is_null(json_object_get(row_of(points, "contact"), "roofline")));
    ck_assert(json_is_null(json_object_get(row_of(elements, "surfaces"), "roofline")));
}
END_TEST

START_TEST(without_the_option_there_is_none) {
    json_t *profile = profile_of(small_scene_text, 1, false);
    ck_assert_ptr_null(profile);
}
END_TEST

// The page: a line for each pass, none of more than 130 columns, with one thread and with many.
START_TEST(page_fits) {
    static brunt_profile profile;
    brunt_scene scene;
    small_scene(&scene, NULL, 0);
    brunt_world *world = small_world(&scene);
    small_steps(world, 5);
    brunt_profile_make(world, NULL, 5, 0.1, &profile);
    for (int k = 0; k < BRUNT_COUNTERS; k++) profile.counted[k] = true;
    static const int threads[] = {1, 4, BRUNT_THREAD_LIMIT};
    for (int t = 0; t < 3; t++) {
        char *text = NULL;
        size_t size;
        FILE *out = open_memstream(&text, &size);
        brunt_console console = brunt_console_open(out);
        profile.threads = threads[t];
        for (int32_t p = 0; p < profile.row_count; p++) {
            profile.rows[p].pass.seconds = 1234.5678, profile.rows[p].ns_per_unit = 12345.67;
            for (int n = 0; n < BRUNT_THREAD_LIMIT; n++) profile.rows[p].pass.thread_seconds[n] = 123.456;
            profile.rows[p].busy_least = profile.rows[p].busy_mean = profile.rows[p].busy_greatest = 1234.567;
        }
        brunt_profile_print(&profile, &console);
        fclose(out);
        for (int32_t p = 0; p < profile.row_count; p++) ck_assert_ptr_nonnull(strstr(text, profile.rows[p].pass.name));
        for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
            ck_assert_msg(strlen(line) <= 130, "%zu columns: %s", strlen(line), line);
        free(text);
    }
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
}
END_TEST

// Whether the system permits them or not; a kind that is counted nowhere is not said to be counted.
START_TEST(counters_may_be_absent) {
    brunt_counters counters;
    const bool any = brunt_counters_open(&counters);
    bool open = false;
    for (int k = 0; k < BRUNT_COUNTERS; k++) open = open || counters.file[k] >= 0;
    ck_assert_int_eq(any, open);
    for (int k = 0; k < BRUNT_COUNTERS; k++) ck_assert(!brunt_counted(&counters, (brunt_counter)k));
    brunt_observer observer = brunt_counters_observer(&counters);
    volatile double sum = 0;
    observer.begin(observer.context, 3, 0);
    for (int n = 0; n < 100000; n++) sum = sum + n;
    observer.end(observer.context, 3, 0, 0);
    if (brunt_counted(&counters, BRUNT_COUNT_INSTRUCTIONS)) {
        ck_assert_double_gt(counters.total[BRUNT_COUNT_INSTRUCTIONS][3], 200000);
        ck_assert_double_lt(counters.total[BRUNT_COUNT_INSTRUCTIONS][3], 5000000);
        ck_assert_double_eq(counters.total[BRUNT_COUNT_INSTRUCTIONS][2], 0);
    }
    brunt_counters_close(&counters);
    brunt_counters none = {.file = {-1, -1, -1, -1}};
    observer = brunt_counters_observer(&none);
    observer.begin(observer.context, 0, 0);
    observer.end(observer.context, 0, 0, 0);
    for (int k = 0; k < BRUNT_COUNTERS; k++) ck_assert(!brunt_counted(&none, (brunt_counter)k));
}
END_TEST

// Repeats of a tick each: what is left of bandwidth and peak is how much they move and compute, which goes with the
// threads in one only.
START_TEST(roofline_counts_what_it_does) {
    double bandwidth[2], peak[2];
    for (int t = 0; t < 2; t++) ck_assert_int_eq(brunt_roofline_measure(1 + t, &bandwidth[t], &peak[t], NULL), 0);
    const double bytes = bandwidth[0] * fake_tick, flops = peak[0] * fake_tick;
    printf("  %g bytes, %g flops\n", bytes, flops);
    ck_assert_double_gt(bytes, 4 * 16e6); // four arrays that no cache holds
    ck_assert_double_eq(fmod(bytes, 4 * sizeof(double)), 0);
    ck_assert_double_gt(flops, 1e5); // some ten microseconds
    ck_assert_double_eq(fmod(flops, 2), 0);
    // Two threads read the clock in turn, so that the least time is a tick or two.
    ck_assert(bandwidth[1] <= bandwidth[0] && bandwidth[1] >= 0.25 * bandwidth[0]);
    ck_assert(peak[1] <= 2 * peak[0] && peak[1] >= 0.25 * peak[0]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("profile");
    TCase *tests = tcase_create("profile");
    tcase_add_unchecked_fixture(tests, make_profiles, free_profiles);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, parts_are_the_steps);
    tcase_add_test(tests, each_of_many_threads_is_told);
    tcase_add_test(tests, rows_are_those_of_the_scene);
    tcase_add_test(tests, without_the_option_there_is_none);
    tcase_add_test(tests, page_fits);
    tcase_add_test(tests, counters_may_be_absent);
    tcase_add_test(tests, roofline_counts_what_it_does);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
