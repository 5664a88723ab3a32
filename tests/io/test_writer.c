// Files that are written beside the steps: in order, all of them, no more in line than there is room for, and by one of
// the run's threads.
#include "tests/support/small_scene.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/parallel.h"
#include "io/file/writer.h"
#include "io/run/run.h"

enum { JOBS = 100 };

// What a job does: note its number; before that, wait until somebody writes a byte to `gate`; fail.
typedef struct noted {
    int number, gate; // gate: a pipe's end, 0: none
    bool fails;
} noted;

static int written[JOBS], released[JOBS], gate[2];
static atomic_int write_count, release_count;

static int write_noted(void *job, brunt_error *error) {
    const noted *j = job;
    char byte;
    if (j->gate && read(j->gate, &byte, 1) != 1) return brunt_fail(error, BRUNT_FAILED, "no gate");
    written[write_count++] = j->number;
    return j->fails ? brunt_fail(error, BRUNT_IO_ERROR, "job %d fails", j->number) : BRUNT_OK;
}

static void release_noted(void *job) {
    released[release_count++] = ((noted *)job)->number;
    brunt_free(job);
}

static int give(brunt_writer *writer, noted what, brunt_error *error) {
    noted *job = brunt_alloc(sizeof *job);
    *job = what;
    return brunt_writer_give(writer, (brunt_job){write_noted, release_noted, job}, error);
}

static void set_up(void) {
    write_count = release_count = 0;
    ck_assert_int_eq(pipe(gate), 0);
    alarm(60); // of a job that is written where it is given, or a lock that is never left, nothing else would tell
}

static void tear_down(void) {
    alarm(0);
    close(gate[0]), close(gate[1]);
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

static brunt_writer *begin(bool beside) {
    brunt_error error = {0};
    brunt_writer *writer = brunt_writer_start(beside, &error);
    ck_assert_msg(writer != NULL, "%s", error.message);
    return writer;
}

static void all_in_order(int count) {
    ck_assert_int_eq(write_count, count);
    ck_assert_int_eq(release_count, count);
    for (int n = 0; n < count; n++) ck_assert(written[n] == n && released[n] == n);
}

// With a thread and without.
START_TEST(jobs_are_done_in_order_and_before_the_end) {
    brunt_writer *writer = begin(_i);
    brunt_error error = {0};
    for (int n = 0; n < JOBS / 2; n++) ck_assert_int_eq(give(writer, (noted){.number = n}, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_writer_wait(writer, &error), BRUNT_OK);
    all_in_order(JOBS / 2);
    for (int n = JOBS / 2; n < JOBS; n++) ck_assert_int_eq(give(writer, (noted){.number = n}, &error), BRUNT_OK);
    brunt_writer_end(writer);
    all_in_order(JOBS);
}
END_TEST

static void *open_later(void *context) {
    usleep(50000);
    ck_assert_int_eq(write(*(int *)context, "x", 1), 1);
    return NULL;
}

// The first waits at its gate: those behind it are taken without waiting, as far as there is room.
START_TEST(what_gives_goes_on_until_the_line_is_full) {
    brunt_writer *writer = begin(true);
    pthread_t opener;
    brunt_error error = {0};
    ck_assert_int_eq(give(writer, (noted){.number = 0, .gate = gate[0]}, &error), BRUNT_OK);
    for (int n = 1; n < 10; n++) ck_assert_int_eq(give(writer, (noted){.number = n}, &error), BRUNT_OK);
    ck_assert_int_eq(write_count, 0);
    ck_assert_int_eq(pthread_create(&opener, NULL, open_later, &gate[1]), 0);
    for (int n = 10; n < JOBS; n++) ck_assert_int_eq(give(writer, (noted){.number = n}, &error), BRUNT_OK);
    ck_assert_int_ge(write_count, 1);
    brunt_writer_end(writer);
    pthread_join(opener, NULL);
    all_in_order(JOBS);
}
END_TEST

// The first waits at its gate until the end has begun: those behind it are written all the same.
START_TEST(the_end_waits_for_what_is_in_line) {
    brunt_writer *writer = begin(true);
    pthread_t opener;
    brunt_error error = {0};
    ck_assert_int_eq(give(writer, (noted){.number = 0, .gate = gate[0]}, &error), BRUNT_OK);
    for (int n = 1; n < 10; n++) ck_assert_int_eq(give(writer, (noted){.number = n}, &error), BRUNT_OK);
    ck_assert_int_eq(pthread_create(&opener, NULL, open_later, &gate[1]), 0);
    brunt_writer_end(writer);
    pthread_join(opener, NULL);
    all_in_order(10);
}
END_TEST

START_TEST(after_a_failure_nothing_is_written_until_it_is_told) {
    brunt_writer *writer = begin(_i);
    brunt_error error = {0};
    if (_i) give(writer, (noted){.number = 0, .gate = gate[0]}, &error);
    give(writer, (noted){.number = 1, .fails = true}, &error);
    for (int n = 2; n < 6; n++) give(writer, (noted){.number = n, .fails = true}, &error);
    ck_assert_int_eq(write(gate[1], "x", 1), 1);
    while (!brunt_writer_failed(writer)) usleep(1000);
    ck_assert_int_eq(give(writer, (noted){.number = 6}, &error), BRUNT_IO_ERROR);
    ck_assert_str_eq(error.message, "job 1 fails");
    error.message[0] = 0;
    ck_assert_int_eq(brunt_writer_wait(writer, &error), BRUNT_IO_ERROR);
    ck_assert_str_eq(error.message, "job 1 fails");
    ck_assert_int_eq(write_count, 1 + _i);
    ck_assert_int_eq(release_count, 6 + _i);
    ck_assert(!brunt_writer_failed(writer));
    ck_assert_int_eq(give(writer, (noted){.number = 7}, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_writer_wait(writer, &error), BRUNT_OK);
    ck_assert_int_eq(written[1 + _i], 7);
    brunt_writer_end(writer);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- threads

static void count_worker(void *context, int32_t pass, int32_t thread, double begin, double end) {
    (void)pass, (void)thread, (void)begin, (void)end;
    ++*(int *)context;
}

static void nothing(void *context, int64_t begin, int64_t end, int worker) {
    (void)context, (void)begin, (void)end, (void)worker;
}

// How many threads are at work in a phase that asks for so many; of many small tasks as of few large ones.
static int workers_of(int threads) {
    int workers[2] = {0, 0};
    for (int each = 0; each < 2; each++) {
        const brunt_observer observer = {.context = &workers[each], .thread = count_worker};
        brunt_timer timer = {.observer = &observer};
        if (each)
            brunt_parallel_each(threads, threads, nothing, NULL, &timer);
        else
            brunt_parallel(threads, 1000, 1, nothing, NULL, &timer);
    }
    ck_assert_int_eq(workers[0], workers[1]);
    return workers[0];
}

static atomic_int stage; // of the job: at work, waiting for the disk, at work again

static void at_stage(int number) {
    char byte;
    stage = number;
    ck_assert_int_eq(read(gate[0], &byte, 1), 1);
}

static int write_by_stages(void *job, brunt_error *error) {
    (void)job, (void)error;
    at_stage(1);
    brunt_parallel_idle(true);
    at_stage(2);
    brunt_parallel_idle(false);
    at_stage(3);
    return BRUNT_OK;
}

static void release_nothing(void *job) { (void)job; }

START_TEST(it_is_one_of_the_threads_while_it_is_at_work) {
    brunt_writer *writer = begin(true);
    brunt_error error = {0};
    ck_assert_int_eq(workers_of(3), 3);
    stage = 0;
    brunt_writer_give(writer, (brunt_job){write_by_stages, release_nothing, NULL}, &error);
    for (int now = 1; now <= 3; now++) {
        while (stage != now) usleep(1000);
        ck_assert_int_eq(workers_of(3), now == 2 ? 3 : 2);
        ck_assert_int_eq(workers_of(2), now == 2 ? 2 : 1);
        ck_assert_int_eq(workers_of(1), 1);
        brunt_parallel_idle(true); // of a thread that is none beside others
        ck_assert_int_eq(workers_of(3), now == 2 ? 3 : 2);
        brunt_parallel_idle(false);
        ck_assert_int_eq(write(gate[1], "x", 1), 1);
    }
    brunt_writer_end(writer);
    ck_assert_int_eq(workers_of(3), 3);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- a run

// Names as they come to stand in the folder and in vtu/.
static void follow_names(int watch) {
    char events[1 << 16] __attribute__((aligned(8)));
    int left = 0, right = 0, collections = 0, checkpoints = 0;
    for (ssize_t got; (got = read(watch, events, sizeof events)) > 0;)
        for (char *at = events; at < events + got;) {
            const struct inotify_event *event = (const struct inotify_event *)(void *)at;
            char name[64];
            at += sizeof *event + event->len;
            snprintf(name, sizeof name, "left_%06d.vtu", left);
            left += !strcmp(event->name, name);
            snprintf(name, sizeof name, "right_%06d.vtu", right);
            right += !strcmp(event->name, name);
            if (!strcmp(event->name, "brunt.pvd")) ck_assert(left == ++collections && right == collections);
            if (!strcmp(event->name, "checkpoint.h5"))
                ck_assert_int_eq(collections, ++checkpoints < 12 ? checkpoints : 11);
        }
    ck_assert(left == 11 && right == 11 && collections == 11 && checkpoints == 12); // one more at the end
}

// A picture is whole before the collection names it, and both before a checkpoint counts it; one after the other.
START_TEST(a_run_writes_its_files_in_order) {
    small_folder_make();
    char folder[160];
    brunt_scene scene;
    brunt_error error = {0};
    snprintf(folder, sizeof folder, "%s", small_path("out"));
    mkdir(folder, 0777), mkdir(small_path("out/vtu"), 0777);
    int watch = inotify_init1(IN_NONBLOCK);
    ck_assert_int_ge(watch, 0);
    ck_assert_int_ge(inotify_add_watch(watch, folder, IN_MOVED_TO), 0);
    ck_assert_int_ge(inotify_add_watch(watch, small_path("out/vtu"), IN_MOVED_TO), 0);
    small_scene(&scene, NULL, 0);
    scene.world.threads = 1 + _i;
    const brunt_run_options options = {.folder = folder};
    ck_assert_msg(brunt_run(&scene, &options, &error) == BRUNT_OK, "%s", error.message);
    brunt_scene_free(&scene);
    follow_names(watch);
    close(watch);
    small_folder_remove();
}
END_TEST

int main(void) {
    Suite *suite = suite_create("writer");
    TCase *all = tcase_create("writer");
    tcase_add_checked_fixture(all, set_up, tear_down);
    tcase_add_loop_test(all, jobs_are_done_in_order_and_before_the_end, 0, 2);
    tcase_add_test(all, what_gives_goes_on_until_the_line_is_full);
    tcase_add_test(all, the_end_waits_for_what_is_in_line);
    tcase_add_loop_test(all, after_a_failure_nothing_is_written_until_it_is_told, 0, 2);
    tcase_add_test(all, it_is_one_of_the_threads_while_it_is_at_work);
    tcase_add_loop_test(all, a_run_writes_its_files_in_order, 0, 2);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
