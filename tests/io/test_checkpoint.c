#include "tests/support/small_scene.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "io/output/checkpoint.h"
#include "io/output/history.h"
#include "base/memory.h"

static brunt_scene scene;
static brunt_world *world;
static char *text;
static double times[] = {0, 0.25, 0.5};
static brunt_run_state state = {.picture_times = times, .picture_count = 3, .wall_seconds = 12.5, .step_seconds = 3};

static void set_up(void) {
    small_folder_make();
    const char *sets[] = {"time.end=10 s"}; // longer than any test
    small_scene(&scene, sets, 1);
    world = small_world(&scene);
    text = small_scene_resolved(&scene);
}

static void tear_down(void) {
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    free(text);
    small_folder_remove();
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

static int write_checkpoint(const char *path, brunt_error *error) {
    brunt_checkpoint *taken = brunt_checkpoint_take(world, &state, error);
    ck_assert_ptr_nonnull(taken);
    int status = brunt_checkpoint_put(taken, path, small_path("previous.h5"), text, error);
    brunt_checkpoint_release(taken);
    return status;
}

static const char *write_one(void) {
    brunt_error error = {0};
    const char *path = small_path("checkpoint.h5");
    int status = write_checkpoint(path, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    return path;
}

START_TEST(restored_world_goes_on_with_the_same_bits) {
    small_steps(world, 25 + 40 * _i);
    const char *path = write_one();
    brunt_world *other = small_world(&scene);
    ck_assert(brunt_world_hash(other) != brunt_world_hash(world));
    brunt_run_state found;
    brunt_error error = {0};
    ck_assert_msg(brunt_checkpoint_read(path, other, text, &found, &error) == BRUNT_OK, "%s", error.message);
    ck_assert_int_eq((int)found.picture_count, 3);
    ck_assert_double_eq(found.picture_times[1], 0.25);
    ck_assert_double_eq(found.wall_seconds, 12.5);
    ck_assert_int_eq((int)found.step, 25 + 40 * _i);
    brunt_run_state_free(&found);
    for (int i = 0; i < 3; i++) {
        brunt_energy a, b;
        brunt_momentum m, n;
        brunt_reaction f = {0}, g = {0};
        ck_assert(brunt_world_hash(other) == brunt_world_hash(world));
        ck_assert_double_eq(brunt_world_time(other), brunt_world_time(world));
        ck_assert_double_eq(brunt_world_dt(other), brunt_world_dt(world));
        ck_assert_double_eq(brunt_world_dt_min(other), brunt_world_dt_min(world));
        brunt_world_energy(other, &a);
        brunt_world_energy(world, &b);
        ck_assert_double_eq(a.kinetic, b.kinetic);
        ck_assert_double_eq(a.external_work, b.external_work);
        // The stored energy is summed in the order in memory, padding included, which is the same again after the next
        // sort.
        ck_assert_double_eq_tol(a.total, b.total, 1e-6 * b.total);
        if (i > 0) ck_assert_double_eq(a.total, b.total);
        if (i > 0) ck_assert_double_eq(a.error_relative, b.error_relative);
        brunt_world_momentum(other, &m);
        brunt_world_momentum(world, &n);
        ck_assert_double_eq(m.linear_drift, n.linear_drift);
        ck_assert_double_eq(m.angular_drift, n.angular_drift);
        brunt_pair_force(other, 0, &f);
        brunt_pair_force(world, 0, &g);
        ck_assert_double_eq(f.impulse[0], g.impulse[0]);
        small_steps(world, 30);
        small_steps(other, 30);
    }
    brunt_world_destroy(other);
}
END_TEST

START_TEST(the_one_before_is_kept) {
    write_one();
    long first_size, second_size, size;
    char *first = small_read(small_path("checkpoint.h5"), &first_size);
    small_steps(world, 5);
    write_one();
    char *second = small_read(small_path("checkpoint.h5"), &second_size),
         *kept = small_read(small_path("previous.h5"), &size);
    ck_assert_int_eq((int)size, (int)first_size);
    ck_assert_int_eq(memcmp(kept, first, (size_t)size), 0);
    ck_assert(second_size != first_size || memcmp(first, second, (size_t)size));
    free(first);
    free(second);
    free(kept);
    // A third time: the second takes the place of the first.
    small_steps(world, 5);
    write_one();
    brunt_world *other = small_world(&scene);
    brunt_run_state found;
    ck_assert_int_eq(brunt_checkpoint_read(small_path("previous.h5"), other, text, &found, NULL), BRUNT_OK);
    ck_assert_int_eq((int)brunt_world_steps(other), 5);
    brunt_run_state_free(&found);
    brunt_world_destroy(other);
}
END_TEST

START_TEST(another_scene_is_refused) {
    static const struct {
        const char *set, *message;
    } cases[] = {{"materials.rubber.E=2 MPa", "another scene"},
                 {"bodies.left.velocity=[4, 0]", "another scene"},
                 {"grid.cell=0.05 m", "another scene"},
                 {"loads.gravity=[0, -9]", "another scene"},
                 {"time.cfl=0.3", "another scene"},
                 // What may change.
                 {"time.end=0.2 s", NULL},
                 {"output.every=1 ms", NULL},
                 {"output.fields=[stress]", NULL},
                 {"title=Other", NULL},
                 {"measures.kept.expect=2", NULL}};
    small_steps(world, 10);
    const char *path = write_one();
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        brunt_scene changed;
        const char *sets[] = {"time.end=10 s", cases[c].set};
        small_scene(&changed, sets, 2);
        char *changed_text = small_scene_resolved(&changed);
        brunt_world *other = small_world(&changed);
        brunt_run_state found;
        brunt_error error = {0};
        int status = brunt_checkpoint_read(path, other, changed_text, &found, &error);
        ck_assert_msg(status == (cases[c].message ? BRUNT_BAD_INPUT : BRUNT_OK), "%s: %d %s", cases[c].set, status,
                      error.message);
        if (cases[c].message)
            ck_assert_msg(strstr(error.message, cases[c].message) != NULL, "%s: %s", cases[c].set, error.message);
        brunt_run_state_free(&found);
        brunt_world_destroy(other);
        brunt_scene_free(&changed);
        free(changed_text);
    }
}
END_TEST

START_TEST(a_failed_state_is_not_resumed) {
    state.failed = true;
    strcpy(state.reason, "the bar is broken");
    const char *path = write_one();
    state.failed = false;
    state.reason[0] = 0;
    brunt_run_state found;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_checkpoint_read(path, world, text, &found, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "the bar is broken"));
}
END_TEST

START_TEST(damage_is_an_error) {
    small_steps(world, 10);
    const char *path = write_one();
    long size;
    char *bytes = small_read(path, &size), broken[160];
    snprintf(broken, sizeof broken, "%s", small_path("broken.h5"));
    brunt_run_state found;
    brunt_error error;
    srand(2);
    for (int i = 0; i < 200; i++) {
        long at = i < 100 ? rand() % size : rand() % 4096;
        char kept = bytes[at];
        bytes[at] = (char)(kept ^ (1 << rand() % 8));
        bool matters = at >= 512 || kept;
        small_write(broken, bytes, size);
        bytes[at] = kept;
        memset(&error, 0, sizeof error);
        if (matters) {
            ck_assert_msg(brunt_checkpoint_read(broken, world, text, &found, &error) == BRUNT_BAD_INPUT, "byte %ld",
                          at);
            ck_assert_msg(strstr(error.message, "broken.h5") != NULL, "%s", error.message);
        }
    }
    for (int i = 0; i < 100; i++) {
        small_write(broken, bytes, i == 0 ? 0 : i == 1 ? 511 : i == 2 ? 512 : i == 3 ? size - 1 : rand() % size);
        ck_assert_int_eq(brunt_checkpoint_read(broken, world, text, &found, &error), BRUNT_BAD_INPUT);
    }
    free(bytes);
    ck_assert_int_eq(brunt_checkpoint_read(small_path("none.h5"), world, text, &found, &error), BRUNT_IO_ERROR);
    // A history is no checkpoint.
    brunt_history *history = brunt_history_create(world, &scene, NULL);
    ck_assert_int_eq(brunt_history_write(history, broken, NULL), BRUNT_OK);
    brunt_history_destroy(history);
    ck_assert_int_eq(brunt_checkpoint_read(broken, world, text, &found, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "history"));
}
END_TEST

// A file that may not grow stands for a full disk: both checkpoints stay, nothing is left beside them.
START_TEST(a_write_that_fails_loses_nothing) {
    write_one();
    small_steps(world, 5);
    write_one();
    long size, size_after;
    char *before = small_read(small_path("checkpoint.h5"), &size);
    struct rlimit old, small;
    getrlimit(RLIMIT_FSIZE, &old);
    small = old;
    small.rlim_cur = 8192;
    signal(SIGXFSZ, SIG_IGN);
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &small), 0);
    brunt_error error = {0};
    int status = write_checkpoint(small_path("checkpoint.h5"), &error);
    setrlimit(RLIMIT_FSIZE, &old);
    ck_assert_int_eq(status, BRUNT_IO_ERROR);
    ck_assert_ptr_nonnull(strstr(error.message, "File too large"));
    char *after = small_read(small_path("checkpoint.h5"), &size_after), command[160];
    ck_assert_int_eq((int)size, (int)size_after);
    ck_assert_int_eq(memcmp(before, after, (size_t)size), 0);
    free(before);
    free(after);
    snprintf(command, sizeof command, "test \"$(ls -A %s | tr '\\n' ' ')\" = 'checkpoint.h5 previous.h5 '",
             small_folder);
    ck_assert_int_eq(system(command), 0);
}
END_TEST

START_TEST(describes_what_it_wrote) {
    small_steps(world, 10);
    const char *path = write_one();
    char *description = NULL;
    size_t size;
    FILE *out = open_memstream(&description, &size);
    ck_assert_int_eq(brunt_checkpoint_describe(path, out, NULL), BRUNT_OK);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(description, "step       10\n"));
    ck_assert_ptr_nonnull(strstr(description, "state/bodies/left/id"));
    ck_assert_ptr_null(strstr(description, "no data that brunt reads"));
    free(description);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("checkpoint");
    TCase *files = tcase_create("files");
    tcase_add_checked_fixture(files, set_up, tear_down);
    tcase_add_loop_test(files, restored_world_goes_on_with_the_same_bits, 0, 8);
    tcase_add_test(files, the_one_before_is_kept);
    tcase_add_test(files, another_scene_is_refused);
    tcase_add_test(files, a_failed_state_is_not_resumed);
    tcase_add_test(files, damage_is_an_error);
    tcase_add_test(files, a_write_that_fails_loses_nothing);
    tcase_add_test(files, describes_what_it_wrote);
    suite_add_tcase(suite, files);
    return suite_main(suite);
}
