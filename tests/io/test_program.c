// The program as a user meets it: commands, exit codes, files, signals, kills and full disks.
#include "tests/support/small_scene.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static char scene_path[160];
static const char *threads; // of runs that say nothing of theirs: with two, files are written beside the steps

static void set_up(void) {
    threads = "1";
    small_folder_make();
    snprintf(scene_path, sizeof scene_path, "%s", small_path("small.yaml"));
    small_write(scene_path, small_scene_text, sizeof small_scene_text - 1);
}

static const char *program(void) {
    const char *path = getenv("BRUNT");
    ck_assert_msg(path != NULL, "BRUNT must name the program");
    return path;
}

static double killed_after; // [s] of a processor: SIGPROF ends what is started then; 0: nothing does

// Starts the program with words split at blanks; %s in a word is the test's folder. `limit`: bytes a file may grow to,
// 0 none.
static pid_t start(const char *arguments, const char *output, rlim_t limit) {
    char *words[64] = {(char *)program()}, *text = strdup(arguments), expanded[64][256];
    int count = 1;
    for (char *word = strtok(text, " "); word; word = strtok(NULL, " "), count++) {
        char *mark = strstr(word, "%s");
        if (mark) {
            snprintf(expanded[count], sizeof expanded[count], "%.*s%s%s", (int)(mark - word), word, small_folder,
                     mark + 2);
            words[count] = expanded[count];
        } else {
            words[count] = word;
        }
    }
    // One thread unless a test asks for more: the scene is too small for two, and many tests run beside this one.
    if (!strncmp(arguments, "run ", 4) && strstr(arguments, ".yaml") && !strstr(arguments, " -t ")) {
        words[count++] = (char *)"-t";
        words[count++] = (char *)threads;
    }
    words[count] = NULL;
    pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        int out = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
        dup2(out, 1);
        dup2(out, 2);
        if (limit) {
            struct rlimit value = {limit, limit};
            setrlimit(RLIMIT_FSIZE, &value);
        }
        if (killed_after > 0) {
            struct itimerval timer = {.it_value = {(time_t)killed_after, (suseconds_t)(1e6 * fmod(killed_after, 1))}};
            setitimer(ITIMER_PROF, &timer, NULL);
        }
        // Signals are tested one by one; the suite's own process group must not matter.
        execv(words[0], words);
        _exit(127);
    }
    free(text);
    return child;
}

static int finish(pid_t child) {
    int status;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

static char *output_text(void) {
    long size;
    return small_read(small_path("output"), &size); // free()
}

static int run(const char *arguments) { return finish(start(arguments, small_path("output"), 0)); }

static void expect(const char *arguments, int code, const char *text) {
    int found = run(arguments);
    char *output = output_text();
    ck_assert_msg(found == code, "%s: %d instead of %d\n%s", arguments, found, code, output);
    ck_assert_msg(!text || strstr(output, text), "%s: '%s' is not in\n%s", arguments, text, output);
    free(output);
}

static json_t *summary_of(const char *folder) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s/summary.json", small_folder, folder);
    json_error_t error;
    json_t *object = json_load_file(path, 0, &error);
    ck_assert_msg(object != NULL, "%s: %s", path, error.text);
    return object;
}

static void hash_of(const char *folder, char hash[32]) {
    json_t *summary = summary_of(folder);
    snprintf(hash, 32, "%s", json_string_value(json_object_get(summary, "state_hash")));
    json_decref(summary);
}

__attribute__((format(printf, 1, 2))) static int shell(const char *format, ...) {
    char command[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool exists(const char *name) { return access(small_path(name), F_OK) == 0; }

static void wait_seconds(double seconds) {
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&time, NULL);
}

// Both folders hold the same history, pictures and state.
static void same_results(const char *a, const char *b) {
    char hash_a[32], hash_b[32];
    hash_of(a, hash_a);
    hash_of(b, hash_b);
    ck_assert_str_eq(hash_a, hash_b);
    ck_assert_int_eq(shell("cmp %s/%s/history.csv %s/%s/history.csv", small_folder, a, small_folder, b), 0);
    ck_assert_int_eq(shell("cmp %s/%s/history.h5 %s/%s/history.h5", small_folder, a, small_folder, b), 0);
    ck_assert_int_eq(shell("cmp %s/%s/brunt.pvd %s/%s/brunt.pvd", small_folder, a, small_folder, b), 0);
    ck_assert_int_eq(shell("diff -r %s/%s/vtu %s/%s/vtu", small_folder, a, small_folder, b), 0);
}

// A run that takes a second or so and writes a checkpoint with each of ten pictures.
#ifdef __SANITIZE_ADDRESS__ // is slow as it is
#define SLOW "--set grid.cell=0.025 --set time.cfl=0.25 "
#else
#define SLOW "--set grid.cell=0.0125 --set time.cfl=0.25 "
#endif

// What runs that are broken off are compared with, made once: whole_1 and whole_2, of one thread and of two.
static char whole_folder[sizeof small_folder];

static void make_whole_runs(void) {
    set_up();
    expect("run %s/small.yaml -o %s/whole_1 -q -t 1 " SLOW, 0, NULL);
    expect("run %s/small.yaml -o %s/whole_2 -q -t 2 " SLOW, 0, NULL);
    strcpy(whole_folder, small_folder);
}

static void remove_whole_runs(void) {
    strcpy(small_folder, whole_folder);
    small_folder_remove();
}

// The one with as many threads as the test's runs have, in the test's folder as "whole".
static void take_whole_run(void) {
    char path[sizeof whole_folder + 16];
    snprintf(path, sizeof path, "%s/whole_%s", whole_folder, threads);
    ck_assert_int_eq(symlink(path, small_path("whole")), 0);
}

START_TEST(bad_usage_is_64) {
    static const char *const cases[] = {"",
                                        "walk",
                                        "run",
                                        "run a b",
                                        "run a --fast",
                                        "run a -t none",
                                        "run a -t 0",
                                        "run a --set x",
                                        "run a -o",
                                        "check",
                                        "check a -o b",
                                        "info",
                                        "keys --set a=b",
                                        "keys nothing"};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        expect(cases[c], 64, "brunt: ");
        char *output = output_text();
        ck_assert_msg(strchr(output, '\n') == output + strlen(output) - 1, "%s: one line is wanted:\n%s", cases[c],
                      output);
        free(output);
    }
    expect("--help", 0, "brunt run SCENE");
    expect("run --help", 0, "usage: brunt run");
    expect("--version", 0, "brunt " BRUNT_VERSION);
}
END_TEST

START_TEST(bad_input_is_65_and_touches_nothing) {
    expect("run %s/small.yaml -o %s/out --set materials.rubber.density=-1", 65, "density");
    expect("run %s/small.yaml -o %s/out --set bodies.left.colour=red", 65, "colour");
    expect("run %s/small.yaml -o %s/out --set output.fields=[velocitee]", 65, "velocitee");
    // What only the made world can tell, all at once.
    expect("run %s/small.yaml -o %s/out --set output.fields=[velocitee,presure] --set measures.m.field.body=left "
           "--set measures.m.field.name=energie --set measures.m.take=max",
           65, "body 'left' has no field 'energie'");
    char *output = output_text();
    ck_assert_ptr_nonnull(strstr(output, "no body has a field 'velocitee'"));
    ck_assert_ptr_nonnull(strstr(output, "no body has a field 'presure'"));
    free(output);
    expect("run %s/small.yaml -o %s/out --set measures.length.extent.body=middle", 65, "middle");
    expect("check %s/small.yaml --set materials.rubber.nu=0.5", 65, "nu");
    expect("run %s/small.yaml -o %s/out --resume", 74, "checkpoint.h5");
    ck_assert(!exists("out"));
    expect("run %s/none.yaml -o %s/out", 74, "none.yaml");
    ck_assert(!exists("out"));
    expect("info %s/small.yaml", 65, "small.yaml");
    expect("info %s/none", 74, "none");
    expect("run %s/small.yaml -o %s/small.yaml/out", 74, "small.yaml");
}
END_TEST

START_TEST(check_and_keys_explain) {
    expect("check %s/small.yaml", 0, "ns per particle-step");
    char *output = output_text();
    ck_assert_ptr_nonnull(strstr(output, "left "));
    ck_assert_ptr_nonnull(strstr(output, "contact"));
    ck_assert_ptr_nonnull(strstr(output, "all arrays"));
    ck_assert_ptr_nonnull(strstr(output, "passes of a step"));
    free(output);
    ck_assert(!exists("out"));
    expect("keys", 0, "bodies");
    expect("keys grid", 0, "cell");
    expect("keys history", 0, "body.*.position_x                  m        centre of mass");
    expect("keys", 0, "energy.contact_held");
    expect("keys --schema", 0, "$schema");
    json_error_t error;
    output = output_text();
    json_t *schema = json_loads(output, 0, &error);
    ck_assert_msg(schema != NULL, "%s", error.text);
    json_decref(schema);
    free(output);
}
END_TEST

// How often a line is written moves no bit of what happens: lines are of steps that are taken anyway.
START_TEST(history_does_not_cut_steps) {
    char often[32], rarely[32];
    expect("run %s/small.yaml -o %s/often -q --set output.history=0", 0, NULL);
    expect("run %s/small.yaml -o %s/rarely -q --set output.history=3.3e-3", 0, NULL);
    hash_of("often", often);
    hash_of("rarely", rarely);
    ck_assert_str_eq(often, rarely);
    // The first, those of the first step at or after each of 30 multiples, the last.
    ck_assert_int_eq(shell("test $(grep -c . %s/rarely/history.csv) = 33", small_folder), 0);
    ck_assert_int_eq(
        shell("awk -F, 'NR > 2 && $1 < 0.1 { due = 3.3e-3 * (NR - 2); if ($1 < due || $1 > due + 1e-3) exit 1 }' "
              "%s/rarely/history.csv",
              small_folder),
        0);
}
END_TEST

START_TEST(a_run_writes_what_it_promises) {
    expect("run %s/small.yaml -o %s/out --profile", 0, "done: reached t = 0.1 s");
    char *output = output_text();
    ck_assert_ptr_nonnull(strstr(output, "profile"));
    ck_assert_ptr_nonnull(strstr(output, "kept "));
    free(output);
    static const char *const files[] = {"out/summary.json", "out/history.h5",    "out/history.csv",
                                        "out/brunt.pvd",    "out/checkpoint.h5", "out/checkpoint.previous.h5",
                                        "out/scene.yaml",   "out/log.txt"};
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) ck_assert_msg(exists(files[f]), "%s", files[f]);
    ck_assert_int_eq(shell("find %s/out -name '*.part' | grep .", small_folder), 1);
    // 11 pictures of 2 bodies at the very times, 101 lines of history.
    ck_assert_int_eq(shell("test $(ls %s/out/vtu | wc -l) = 22", small_folder), 0);
    ck_assert_int_eq(shell("test $(grep -c . %s/out/history.csv) = 102", small_folder), 0);
    ck_assert_int_eq(shell("tail -n 1 %s/out/history.csv | grep -q '^0.1,\\|^0.10000000000000001,'", small_folder), 0);
    ck_assert_int_eq(shell("/usr/bin/python3 tests/support/read_vtu.py --collection %s/out/brunt.pvd > %s/pictures",
                           small_folder, small_folder),
                     0);
    ck_assert_int_eq(shell("test $(grep -c . %s/pictures) = 22", small_folder), 0);
    ck_assert_int_eq(shell("grep -q 'left 0.03 ' %s/pictures", small_folder), 0);
    expect("info %s/out/checkpoint.h5", 0, "time       0.1");
    expect("info %s/out/history.h5", 0, "101 lines");
    expect("info %s/out/brunt.pvd", 0, "vtu/right_000010.vtu");
    expect("info %s/out/vtu/left_000001.vtu", 0, "velocity");
    // The resolved scene is the same scene.
    expect("run %s/out/scene.yaml -o %s/again -q", 0, NULL);
    same_results("out", "again");
}
END_TEST

START_TEST(summary_has_exactly_the_promised_names) {
    static const char *const names[] = {"scene",
                                        "version",
                                        "status",
                                        "reason",
                                        "dimension",
                                        "threads",
                                        "steps",
                                        "time",
                                        "wall_s",
                                        "cpu_s",
                                        "step_s",
                                        "peak_rss_bytes",
                                        "particles",
                                        "nodes",
                                        "elements",
                                        "particle_steps_per_s",
                                        "element_steps_per_s",
                                        "ns_per_particle_step",
                                        "ns_per_element_step",
                                        "dt_min",
                                        "dt_max",
                                        "state_hash",
                                        "phases",
                                        "effects",
                                        "energy",
                                        "momentum",
                                        "eroded",
                                        "added_mass",
                                        "measures"};
    static const char *const energy[] = {"initial",   "final",   "kinetic",       "internal",  "plastic",
                                         "hourglass", "contact", "friction",      "viscosity", "transfer",
                                         "eroded",    "heat",    "external_work", "reference", "error_relative"};
    static const char *const momentum[] = {"linear_initial",  "linear_final",  "linear_drift",
                                           "angular_initial", "angular_final", "angular_drift"};
    static const char *const measure[] = {"value", "unit", "expect", "error", "ok"};
    expect("run %s/small.yaml -o %s/out -q -t 1", 0, NULL);
    json_t *summary = summary_of("out");
    const struct {
        json_t *object;
        const char *const *names;
        size_t count;
    } groups[] = {{summary, names, sizeof names / sizeof *names},
                  {json_object_get(summary, "energy"), energy, sizeof energy / sizeof *energy},
                  {json_object_get(summary, "momentum"), momentum, sizeof momentum / sizeof *momentum},
                  {json_object_get(json_object_get(summary, "measures"), "kept"), measure, 5}};
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        ck_assert_int_eq((int)json_object_size(groups[g].object), (int)groups[g].count);
        for (size_t n = 0; n < groups[g].count; n++)
            ck_assert_msg(json_object_get(groups[g].object, groups[g].names[n]) != NULL, "%s", groups[g].names[n]);
    }
    ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "done");
    ck_assert_double_eq(json_number_value(json_object_get(summary, "time")), 0.1);
    ck_assert(json_is_true(json_object_get(groups[3].object, "ok")));
    ck_assert(json_is_null(json_object_get(json_object_get(json_object_get(summary, "measures"), "length"), "ok")));
    double length =
        json_number_value(json_object_get(json_object_get(json_object_get(summary, "measures"), "length"), "value"));
    ck_assert_double_gt(length, 0.2);
    ck_assert_double_lt(length, 1);
    ck_assert_int_gt((int)json_integer_value(json_object_get(summary, "steps")), 50);
    ck_assert_int_eq(strncmp(json_string_value(json_object_get(summary, "state_hash")), "0x", 2), 0);
    ck_assert(json_is_true(json_object_get(json_object_get(summary, "effects"), "contact")));
    json_decref(summary);
}
END_TEST

START_TEST(quiet_is_quiet_and_the_log_keeps_all) {
    expect("run %s/small.yaml -o %s/out -q -t 1", 0, NULL);
    char *output = output_text();
    ck_assert_str_eq(output, "");
    free(output);
    ck_assert_int_eq(shell("grep -q 'state hash' %s/out/log.txt", small_folder), 0);
    expect("run %s/small.yaml -o %s/loud", 0, "state hash");
    ck_assert_int_eq(shell("cmp %s/output %s/loud/log.txt", small_folder, small_folder), 0);
    // A reader that goes away does not end the run.
    ck_assert_int_eq(shell("(%s run %s -o %s/pipe; echo $? > %s/code) | true; test \"$(cat %s/code)\" = 0", program(),
                           scene_path, small_folder, small_folder, small_folder),
                     0);
}
END_TEST

START_TEST(a_fresh_run_replaces_the_old_one) {
    expect("run %s/small.yaml -o %s/out -q --set output.every=2ms", 0, NULL);
    ck_assert_int_eq(shell("test $(ls %s/out/vtu | wc -l) = 102", small_folder), 0);
    expect("run %s/small.yaml -o %s/out -q --set materials.rubber.E=-5", 65, NULL);
    ck_assert_int_eq(shell("test $(ls %s/out/vtu | wc -l) = 102", small_folder), 0);
    expect("run %s/small.yaml -o %s/out -q -t 1", 0, NULL);
    ck_assert_int_eq(shell("test $(ls %s/out/vtu | wc -l) = 22", small_folder), 0);
    ck_assert_int_eq(shell("cd %s && %s run small.yaml -q", small_folder, program()), 0);
    ck_assert(exists("out/small/summary.json"));
}
END_TEST

START_TEST(threads_change_nothing) {
    expect("run %s/small.yaml -o %s/one -q -t 1", 0, NULL);
    expect("run %s/small.yaml -o %s/two -q -t 2", 0, NULL);
    expect("run %s/small.yaml -o %s/three -q -t 3", 0, NULL);
    same_results("one", "two");
    same_results("one", "three");
}
END_TEST

// Kills and resumes one run again and again at moments that differ from test to test, until it is through. Moments are
// of the run's own time on a processor, so that it comes as far on any machine: SIGPROF ends it as SIGKILL does.
START_TEST(killed_and_resumed_is_the_same_run) {
    threads = _i ? "2" : "1";
    take_whole_run();
    unsigned seed = (unsigned)time(NULL) ^ (unsigned)getpid();
    printf("kill times are drawn from seed %u\n", seed);
    json_t *summary = summary_of("whole");
    double cpu = json_number_value(json_object_get(summary, "cpu_s"));
    json_decref(summary);
    int kills = 0, code = -1;
    for (int i = 0; i < 12; i++) {
        // A leg killed before its first checkpoint has left none to resume from.
        bool resume = exists("broken/checkpoint.h5");
        seed = seed * 1664525u + 1013904223u;
        killed_after = i < 11 ? cpu * (0.02 + 0.3 * (seed >> 8) / (double)(1 << 24)) : 0;
        pid_t child = start(resume ? "run %s/small.yaml -o %s/broken -q --resume " SLOW
                                   : "run %s/small.yaml -o %s/broken -q " SLOW,
                            small_path("output"), 0);
        code = finish(child);
        if (code != -SIGPROF) break;
        kills++;
    }
    killed_after = 0;
    char *output = output_text();
    ck_assert_msg(code == 0, "%d: %s", code, output);
    free(output);
    ck_assert_int_gt(kills, 0);
    same_results("whole", "broken");
}
END_TEST

START_TEST(asked_to_stop_is_75_and_resumes) {
    static const int signals[] = {SIGTERM, SIGINT, SIGHUP, SIGTERM};
    threads = _i < 3 ? "1" : "2";
    take_whole_run();
    // At intervals of wall time only, so that the checkpoint is the signal's.
    pid_t child =
        start("run %s/small.yaml -o %s/stopped -q --set output.checkpoint=10min " SLOW, small_path("output"), 0);
    while (!exists("stopped/vtu/left_000002.vtu")) wait_seconds(0.002);
    kill(child, signals[_i]);
    ck_assert_int_eq(finish(child), 75);
    json_t *summary = summary_of("stopped");
    ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "stopped");
    double time = json_number_value(json_object_get(summary, "time"));
    ck_assert_double_ge(time, 0.02);
    ck_assert_double_lt(time, 0.1);
    json_decref(summary);
    expect("run %s/small.yaml -o %s/stopped --resume " SLOW, 0, "resumed at t = 0.0");
    same_results("whole", "stopped");
    // A finished run resumed has nothing left to do and says the same.
    expect("run %s/small.yaml -o %s/stopped --resume -q " SLOW, 0, NULL);
    same_results("whole", "stopped");
    expect("run %s/small.yaml -o %s/stopped --resume " SLOW "--set materials.rubber.nu=0.31", 65, "another scene");
    expect("run %s/small.yaml -o %s/stopped --resume -q --set time.end=0.12s " SLOW, 0, NULL);
    ck_assert_int_eq(shell("tail -n 1 %s/stopped/history.csv | grep -q '^0.12,\\|^0.11999'", small_folder), 0);
    expect("run %s/small.yaml -o %s/stopped --resume -q " SLOW, 65, "time.end");
}
END_TEST

START_TEST(usr1_saves_and_goes_on) {
    threads = _i ? "2" : "1";
    pid_t child = start("run %s/small.yaml -o %s/out --set output.checkpoint=none " SLOW, small_path("output"), 0);
    while (!exists("out/vtu/left_000001.vtu")) wait_seconds(0.002);
    ck_assert(!exists("out/checkpoint.h5"));
    kill(child, SIGUSR1);
    ck_assert_int_eq(finish(child), 0);
    char *output = output_text();
    ck_assert_ptr_nonnull(strstr(output, "checkpoint at t = "));
    ck_assert_ptr_nonnull(strstr(output, "done: "));
    free(output);
    ck_assert(exists("out/checkpoint.previous.h5"));
}
END_TEST

// An energy limit below what two hundred steps of contact and transfer leave open.
START_TEST(a_failing_run_is_70_and_leaves_what_to_look_at) {
    threads = _i ? "2" : "1";
    expect("run %s/small.yaml -o %s/out --set time.energy_limit=1e-9", 70, "failed: ");
    json_t *summary = summary_of("out");
    ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "failed");
    ck_assert_int_gt((int)strlen(json_string_value(json_object_get(summary, "reason"))), 20);
    json_decref(summary);
    expect("info %s/out/checkpoint.h5", 0, "FAILED");
    expect("run %s/small.yaml -o %s/out --set time.energy_limit=1e-9 --resume", 65, "failed");
    ck_assert(exists("out/checkpoint.previous.h5"));
    // The last picture is of the failing state, and readable.
    ck_assert_int_eq(shell("/usr/bin/python3 tests/support/read_vtu.py --collection %s/out/brunt.pvd > %s/pictures",
                           small_folder, small_folder),
                     0);
    ck_assert_int_eq(shell("test $(grep -c . %s/pictures) -ge 4", small_folder), 0);
}
END_TEST

// A file that may not grow beyond what a checkpoint needs: as a full disk, without needing one.
START_TEST(a_checkpoint_that_cannot_be_written_is_74) {
    threads = _i ? "2" : "1";
    take_whole_run();
    pid_t child = start("run %s/small.yaml -o %s/out -q " SLOW, small_path("output"), 0);
    while (!exists("out/vtu/left_000004.vtu")) wait_seconds(0.002);
    kill(child, SIGTERM);
    ck_assert_int_eq(finish(child), 75);
    ck_assert_int_eq(shell("cp %s/out/checkpoint.h5 %s/kept.h5", small_folder, small_folder), 0);
    long size;
    free(small_read(small_path("kept.h5"), &size));
    child = start("run %s/small.yaml -o %s/out -q --resume " SLOW, small_path("output"), (rlim_t)size - 1000);
    int code = finish(child);
    char *output = output_text();
    ck_assert_msg(code == 74, "%d: %s", code, output);
    ck_assert_msg(strstr(output, "File too large") != NULL, "%s", output);
    free(output);
    // It is told with the next picture at the latest: the run was stopped at the fourth, of ten.
    json_t *summary = summary_of("out");
    ck_assert_double_le(json_number_value(json_object_get(summary, "time")), 0.0601);
    json_decref(summary);
    ck_assert_int_eq(shell("cmp %s/out/checkpoint.h5 %s/kept.h5", small_folder, small_folder), 0);
    expect("run %s/small.yaml -o %s/out -q --resume " SLOW, 0, NULL);
    same_results("whole", "out");
}
END_TEST

// The first picture cannot be written, and the first step fails: what is of the earlier time is told, as if steps had
// waited.
START_TEST(a_picture_that_cannot_be_written_comes_before_a_step_that_fails) {
    threads = _i ? "2" : "1";
    // Without a first checkpoint, by which the picture would have failed.
    pid_t child = start("run %s/small.yaml -o %s/out -q --set time.least_step=1s --set output.checkpoint=none " SLOW,
                        small_path("output"), 5000);
    int code = finish(child);
    char *output = output_text();
    ck_assert_msg(code == 74 && strstr(output, "left_000000.vtu"), "%d: %s", code, output);
    free(output);
    expect("run %s/small.yaml -o %s/other -q --set time.least_step=1s " SLOW, 70, "least_step");
}
END_TEST

START_TEST(a_full_disk_is_74_and_leaves_a_whole_checkpoint) {
    threads = _i ? "2" : "1";
    ck_assert_int_eq(mkdir(small_path("disk"), 0777), 0);
    if (geteuid() != 0 || mount("tmpfs", small_path("disk"), "tmpfs", 0, "size=6m")) {
        printf("a small disk cannot be mounted here (%s): the test of a full disk did not run\n",
               geteuid() ? "not root" : strerror(errno));
        return;
    }
    int code = run("run %s/small.yaml -o %s/disk/out -q --set output.every=1ms " SLOW);
    char *output = output_text();
    int info = run("info %s/disk/out/checkpoint.h5");
    int copied = shell("cp -r %s/disk/out %s/out", small_folder, small_folder);
    umount(small_path("disk"));
    ck_assert_msg(code == 74, "%d: %s", code, output);
    ck_assert_msg(strstr(output, "No space left on device") != NULL, "%s", output);
    free(output);
    ck_assert_int_eq(info, 0);
    ck_assert_int_eq(copied, 0);
    expect("run %s/small.yaml -o %s/out -q --resume --set output.every=1ms " SLOW, 0, NULL);
    expect("run %s/small.yaml -o %s/whole -q --set output.every=1ms " SLOW, 0, NULL);
    same_results("whole", "out");
}
END_TEST

START_TEST(a_damaged_checkpoint_is_65) {
    expect("run %s/small.yaml -o %s/out -q -t 1", 0, NULL);
    long size;
    char *bytes = small_read(small_path("out/checkpoint.h5"), &size);
    bytes[size / 2] ^= 4;
    small_write(small_path("out/checkpoint.h5"), bytes, size);
    expect("run %s/small.yaml -o %s/out --resume", 65, "damaged");
    expect("info %s/out/checkpoint.h5", 65, "damaged");
    small_write(small_path("out/checkpoint.h5"), bytes, size / 3);
    expect("run %s/small.yaml -o %s/out --resume", 65, "cut short");
    free(bytes);
    // Without it the one before is none that may be replaced; it takes its place.
    ck_assert_int_eq(shell("cd %s/out && rm checkpoint.h5 summary.json", small_folder), 0);
    expect("run %s/small.yaml -o %s/out", 65, "unfinished");
    expect("run %s/small.yaml -o %s/out --resume", 65, "put checkpoint.previous.h5");
    ck_assert_int_eq(rename(small_path("out/checkpoint.previous.h5"), small_path("out/checkpoint.h5")), 0);
    expect("run %s/small.yaml -o %s/out --resume -q", 0, NULL);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program");
    TCase *commands = tcase_create("commands");
    tcase_add_checked_fixture(commands, set_up, small_folder_remove);
    tcase_add_test(commands, bad_usage_is_64);
    tcase_add_test(commands, bad_input_is_65_and_touches_nothing);
    tcase_add_test(commands, check_and_keys_explain);
    tcase_add_test(commands, history_does_not_cut_steps);
    tcase_add_test(commands, a_run_writes_what_it_promises);
    tcase_add_test(commands, summary_has_exactly_the_promised_names);
    tcase_add_test(commands, quiet_is_quiet_and_the_log_keeps_all);
    tcase_add_test(commands, a_fresh_run_replaces_the_old_one);
    tcase_add_test(commands, threads_change_nothing);
    tcase_add_loop_test(commands, usr1_saves_and_goes_on, 0, 2);
    tcase_add_loop_test(commands, a_failing_run_is_70_and_leaves_what_to_look_at, 0, 2);
    tcase_add_loop_test(commands, a_picture_that_cannot_be_written_comes_before_a_step_that_fails, 0, 2);
    tcase_add_loop_test(commands, a_full_disk_is_74_and_leaves_a_whole_checkpoint, 0, 2);
    tcase_add_test(commands, a_damaged_checkpoint_is_65);
    suite_add_tcase(suite, commands);
    TCase *broken_off = tcase_create("broken off");
    tcase_add_unchecked_fixture(broken_off, make_whole_runs, remove_whole_runs);
    tcase_add_checked_fixture(broken_off, set_up, small_folder_remove);
    tcase_add_loop_test(broken_off, killed_and_resumed_is_the_same_run, 0, 2);
    tcase_add_loop_test(broken_off, asked_to_stop_is_75_and_resumes, SANITIZED ? 2 : 0, 4); // one handler for all
    tcase_add_loop_test(broken_off, a_checkpoint_that_cannot_be_written_is_74, 0, 2);
    suite_add_tcase(suite, broken_off);
    return suite_main(suite);
}
