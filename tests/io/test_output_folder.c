// What is in an output folder and not of brunt's own stays as it is, and one run at a time has the folder.
#include "tests/support/small_program.h"

#include <sys/stat.h>

static void set_up(void) {
    small_folder_make();
    small_put("small.yaml", small_scene_text);
}

// A run that would take minutes, with pictures and checkpoints from its beginning.
static const char *const endless[] = {"--set", "time.end=1000 s", "--set", "output.every=1 ms"};
static pid_t begin(const char *folder) {
    char sign[64];
    snprintf(sign, sizeof sign, "%s/vtu/left_000003.vtu", folder);
    return small_begin(folder, sign, endless, 4);
}

static void expect_text(const char *name, const char *text) {
    long size;
    char *found = small_read(small_path(name), &size);
    ck_assert_msg(!strcmp(found, text), "%s is now\n%s", name, found);
    free(found);
}

static void make_folder(const char *name) { ck_assert_int_eq(mkdir(small_path(name), 0777), 0); }

// A scene of the user's own is not replaced by the resolved one; nothing is made beside it.
START_TEST(the_users_scene_stays) {
    make_folder("mine");
    char *text = malloc(sizeof small_scene_text + 32);
    sprintf(text, "# why it is so\n%s", small_scene_text);
    small_put("mine/scene.yaml", text);
    small_expect("run mine/scene.yaml -q -t 1 -o mine", 65, "mine/scene.yaml: the scene itself would be replaced");
    small_expect("run small.yaml -q -t 1 -o mine", 65, "does not list it): scene.yaml;");
    ck_assert_int_eq(small_shell("cd mine && $B run scene.yaml -q -t 1 -o ."), 65);
    ck_assert_int_eq(small_shell("cd mine && $B run scene.yaml -q -t 1 -o . --fresh"), 65);
    expect_text("mine/scene.yaml", text);
    ck_assert_int_eq(small_shell("test \"$(ls mine)\" = scene.yaml"), 0);
    // Also one that brunt had put there, once it is what is run: its comments would go.
    small_expect("run small.yaml -q -t 1 -o out", 0, NULL);
    small_expect("run out/scene.yaml -q -t 1 -o out", 65, "the scene itself");
    small_expect("run out/scene.yaml -q -t 1 -o out --resume", 65, "the scene itself");
    free(text);
}
END_TEST

// All that is in the way is said at once; links and folders are in it too, whatever they lead to.
START_TEST(all_that_is_in_the_way_is_said) {
    static const char *const names[] = {"log.txt",
                                        "summary.json",
                                        "brunt.pvd",
                                        "checkpoint.previous.h5",
                                        "history.csv.part",
                                        "vtu/left_000007.vtu",
                                        "vtu/right_000000.vtu.part"};
    make_folder("mine"), make_folder("mine/vtu"), make_folder("mine/history.h5");
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char name[64];
        snprintf(name, sizeof name, "mine/%s", names[n]);
        small_put(name, "mine\n");
    }
    ck_assert_int_eq(symlink("nowhere", small_path("mine/checkpoint.h5")), 0);
    ck_assert_int_eq(small_shell("ls -lR mine > before"), 0);
    small_expect("run small.yaml -q -t 1 -o mine", 65, "history.h5");
    small_expect("run small.yaml -q -t 1 -o mine", 65, "checkpoint.h5");
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        small_expect("run small.yaml -q -t 1 -o mine", 65, names[n]);
    small_expect("run small.yaml -q -t 1 -o mine --resume", 65, "log.txt");
    ck_assert_int_eq(small_shell("ls -lR mine | cmp - before"), 0);
}
END_TEST

// What is not in the way stays, from run to run; what brunt wrote goes.
START_TEST(what_is_listed_goes_and_the_rest_stays) {
    static const char *const names[] = {"out/note.txt", "out/history.h5.old", "out/vtu/view.pvsm",
                                        "out/vtu/left_1.vtu.gz", "out/vtu/lefty_000001.vtu"};
    make_folder("out"), make_folder("out/vtu");
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) small_put(names[n], "mine\n");
    small_expect("run small.yaml -q -t 1 -o out --set output.every='2 ms'", 0, NULL);
    ck_assert_int_eq(small_shell("test $(ls out/vtu/left_0*.vtu | wc -l) = 51"), 0);
    ck_assert_int_eq(small_shell("grep -qx vtu/left_000050.vtu out/brunt.files"), 0);
    for (int pass = 0; pass < 2; pass++) {
        small_expect("run small.yaml -q -t 1 -o out", 0, NULL);
        ck_assert_int_eq(small_shell("test $(ls out/vtu/left_0*.vtu | wc -l) = 11"), 0);
        ck_assert_int_eq(small_shell("test $(grep -c vtu/left out/brunt.files) = 11"), 0);
    }
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) expect_text(names[n], "mine\n");
    // Everything there is listed, but what is the user's, and the list.
    ck_assert_int_eq(
        small_shell(
            "cd out && find . -type f | sed 's,^./,,' | grep -vxF -f brunt.files | sort | tr '\\n' ' ' > ../left"),
        0);
    expect_text("left", "brunt.files history.h5.old note.txt vtu/left_1.vtu.gz vtu/lefty_000001.vtu vtu/view.pvsm ");
}
END_TEST

START_TEST(an_unfinished_run_is_not_begun_anew) {
    for (int killed = 0; killed < 2; killed++) {
        int code = small_end(begin("out"), killed ? SIGKILL : SIGTERM);
        ck_assert_int_eq(code, killed ? -SIGKILL : 75);
        ck_assert_int_eq(small_shell("cp -r out before"), 0);
        small_expect("run small.yaml -q -t 1 -o out", 65, "--resume goes on with it, --fresh begins anew");
        ck_assert_int_eq(small_shell("diff -r out before && rm -r before"), 0);
        small_expect("run small.yaml -q -t 1 -o out --resume", 0, NULL);
        small_expect("run small.yaml -q -t 1 -o out", 0, NULL); // done
        // On with the finished one, and killed in that: it is unfinished again.
        ck_assert_int_eq(small_shell("cp out/checkpoint.h5 kept"), 0);
        static const char *const on[] = {"--set", "time.end=1000 s", "--set", "output.every=1 ms", "--resume"};
        ck_assert_int_eq(small_end(small_begin("out", "out/vtu/left_000013.vtu", on, 5), SIGKILL), -SIGKILL);
        small_expect("run small.yaml -q -t 1 -o out", 65, "--fresh");
        small_expect("run small.yaml -q -t 1 -o out --fresh", 0, NULL);
        ck_assert(!small_exists("out/vtu/left_000011.vtu"));
        ck_assert_int_eq(small_shell("rm -r out"), 0);
    }
    // One that has failed for good has nothing to go on with.
    small_expect("run small.yaml -q -t 1 -o out --set time.energy_limit=1e-9", 70, NULL);
    small_expect("run small.yaml -q -t 1 -o out", 0, NULL);
    small_expect("run small.yaml --resume --fresh", 64, "one of them");
}
END_TEST

// What has ended is replaced, whichever scene it was of; to go on with, it must be of this one.
START_TEST(a_run_that_ended_is_replaced) {
    small_put("other.yaml", small_elements_text);
    small_expect("run small.yaml -q -t 1 -o out --set time.end='20 ms'", 0, NULL);
    small_expect("run small.yaml -q -t 1 -o out --set time.end='20 ms' --resume", 0, NULL); // nothing is left to do
    small_expect("run small.yaml -q -t 1 -o out --set time.end='40 ms' --resume", 0, NULL);
    ck_assert_int_eq(small_shell("grep -q '\"time\": 0.04' out/summary.json"), 0);
    small_expect("run other.yaml -q -t 1 -o out --resume", 65, "made from another scene");
    ck_assert_int_eq(small_shell("grep -q '\"scene\": \"small\"' out/summary.json"), 0);
    small_expect("run other.yaml -q -t 1 -o out", 0, NULL);
    ck_assert_int_eq(small_shell("grep -q '\"scene\": \"other\"' out/summary.json"), 0);
    ck_assert(!small_exists("out/vtu/left_000000.vtu"));
}
END_TEST

START_TEST(one_run_a_folder) {
    pid_t first = begin("out");
    small_expect("run small.yaml -q -t 1 -o out", 65, "another run is writing into this folder");
    small_expect("run small.yaml -q -t 1 -o out --fresh", 65, "another run");
    small_expect("run small.yaml -q -t 1 -o out/ --resume", 65, "another run");
    small_expect("run small.yaml -q -t 1 -o other", 0, NULL);
    ck_assert_int_eq(small_end(first, SIGKILL), -SIGKILL); // the lock goes with it
    small_expect("run small.yaml -q -t 1 -o out --fresh", 0, NULL);
}
END_TEST

// A trace takes the place of a trace only.
// A folder that is moved away takes its run with it: what has its name then is another's. Pictures alone are written,
// which are opened as soon as the folder has been looked at.
START_TEST(a_folder_is_moved) {
    static const char *const pictures[] = {"--set", "time.end=1000 s",       "--set", "output.every=1 ms",
                                           "--set", "output.checkpoint=none"};
    for (int again = 0; again < 2; again++) {
        const pid_t child = small_begin("out", "out/vtu/left_000003.vtu", pictures, 6);
        ck_assert_int_eq(small_shell("mv out moved && if [ %d = 1 ]; then mkdir -p out/vtu && echo mine > "
                                     "out/checkpoint.h5; fi",
                                     again),
                         0);
        ck_assert_int_eq(small_end(child, 0), 74);
        ck_assert_int_eq(small_shell("grep -q 'out: was moved or removed' moved/log.txt"), 0);
        if (again) expect_text("out/checkpoint.h5", "mine\n");
        ck_assert_int_eq(small_shell("test $(find . -path './out/*' | wc -l) = %d", again ? 2 : 0), 0);
        ck_assert_int_eq(small_shell("rm -r moved"), 0);
    }
}
END_TEST

START_TEST(a_trace_replaces_traces_only) {
    small_expect("run small.yaml -q -t 1 -o out --trace t.json", 0, NULL);
    small_expect("run small.yaml -q -t 1 -o out --trace t.json", 0, NULL);
    small_put("mine.json", "{\"traceEvents\":[]}\n");
    small_put("taken.json.part", "mine\n");
    small_put("empty", "");
    ck_assert_int_eq(symlink("t.json", small_path("link.json")), 0);
    ck_assert_int_eq(symlink("nowhere", small_path("lost.json")), 0);
    ck_assert_int_eq(mkfifo(small_path("pipe"), 0666), 0);
    ck_assert_int_eq(small_shell("cp -r out before && > list && ls -1 | sort > list"), 0);
    static const char *const names[] = {"small.yaml",      "mine.json",      "taken.json", "link.json",
                                        "lost.json",       "pipe",           "empty",      "out/checkpoint.h5",
                                        "out/history.csv", "out/brunt.files"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char arguments[128];
        snprintf(arguments, sizeof arguments, "run small.yaml -q -t 1 -o out --trace %s", names[n]);
        small_expect(arguments, 65, "no trace of brunt's");
    }
    expect_text("small.yaml", small_scene_text);
    // Names that the run is going to take.
    small_expect("run small.yaml -q -t 1 -o out --trace out/summary.json.part", 65, "the run itself writes there");
    small_expect("run small.yaml -q -t 1 -o out --trace out/vtu/left_000099.vtu", 65, "the run itself writes there");
    small_expect("run small.yaml -q -t 1 -o out --trace ./out//history.h5.part", 65, "the run itself writes there");
    small_expect("run small.yaml -q -t 1 -o new --trace new/scene.yaml", 65, "the run itself writes there");
    ck_assert_int_eq(small_shell("diff -r out before && rm -rf new && ls -1 | sort | diff - list"), 0);
    ck_assert_int_eq(small_shell("test -p pipe && test -L link.json && cat mine.json taken.json.part > now"), 0);
    expect_text("now", "{\"traceEvents\":[]}\nmine\n");
    small_expect("run small.yaml -q -t 1 -o out --trace out/t.json", 0, NULL);
}
END_TEST

// Links put where brunt wrote earlier lead it nowhere.
START_TEST(links_are_not_followed) {
    static const char *const names[] = {"scene.yaml",         "log.txt",      "history.csv", "history.h5",
                                        "brunt.pvd",          "summary.json", "brunt.files", "checkpoint.h5.part",
                                        "vtu/left_000000.vtu"};
    char arguments[64];
    small_expect("run small.yaml -q -t 1 -o whole", 0, NULL);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        small_put("precious", "mine\n");
        ck_assert_int_eq(small_shell("rm -rf out && cp -r whole out && ln -sf $PWD/precious out/%s", names[n]), 0);
        for (int resume = 0; resume < 2; resume++) {
            snprintf(arguments, sizeof arguments, "run small.yaml -q -t 1 -o out%s", resume ? " --resume" : "");
            small_expect(arguments, 65, names[n]);
            expect_text("precious", "mine\n");
        }
    }
    make_folder("pictures");
    small_put("pictures/left_000000.vtu", "mine\n");
    ck_assert_int_eq(small_shell("rm -rf out && cp -r whole out && rm -r out/vtu && ln -s ../pictures out/vtu"), 0);
    small_expect("run small.yaml -q -t 1 -o out", 65, "vtu/");
    ck_assert_int_eq(small_shell("test \"$(ls pictures)\" = left_000000.vtu"), 0);
    expect_text("pictures/left_000000.vtu", "mine\n");
    // The folder itself may be reached by one.
    ck_assert_int_eq(symlink("whole", small_path("here")), 0);
    small_expect("run small.yaml -q -t 1 -o here", 0, NULL);
}
END_TEST

// A list cannot make brunt remove anything elsewhere, nor is a file of that name taken for one.
START_TEST(a_list_that_lies) {
    static const char *const lines[] = {"../precious", "vtu/../../precious", "/etc/passwd", "..", "vtu/..", "./x"};
    char arguments[128];
    small_put("precious", "mine\n");
    for (size_t n = 0; n < sizeof lines / sizeof *lines; n++) {
        small_expect("run small.yaml -q -t 1 -o out", 0, NULL);
        ck_assert_int_eq(small_shell("echo '%s' >> out/brunt.files", lines[n]), 0);
        snprintf(arguments, sizeof arguments, "'%s' is no name within the folder", lines[n]);
        small_expect("run small.yaml -q -t 1 -o out", 65, arguments);
        expect_text("precious", "mine\n");
        ck_assert_int_eq(small_shell("rm -r out"), 0);
    }
    make_folder("out");
    small_put("out/brunt.files", "mine\n");
    small_expect("run small.yaml -q -t 1 -o out", 65, "no list of brunt's");
    expect_text("out/brunt.files", "mine\n");
    // Cut off by a kill within a line, or before the first: the rest counts.
    small_expect("run small.yaml -q -t 1 -o cut", 0, NULL);
    ck_assert_int_eq(small_shell("printf 'vtu/left_0' >> cut/brunt.files && $B run small.yaml -q -t 1 -o cut"), 0);
    make_folder("none");
    small_put("none/brunt.files", "");
    small_expect("run small.yaml -q -t 1 -o none", 0, NULL);
}
END_TEST

// Studies: their own folder, those of their runs, and one at a time.
START_TEST(studies_likewise) {
    make_folder("mine");
    small_put("study.yaml",
              "brunt_study: 1\nscene: small.yaml\nset: {time.end: 2 ms}\nrepeats: 1\n"
              "axes: {h: {key: grid.cell, values: [0.1 m, 0.05 m], role: resolution}}\nmeasures: {kept: {}}\n");
    static const char *const names[] = {"report.md", "study.csv",       "study.json",
                                        "study.gp",  "study_order.png", "study_cost.svg"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        ck_assert_int_eq(small_shell("echo mine > mine/%s", names[n]), 0);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) small_expect("study study.yaml -q -o mine", 65, names[n]);
    ck_assert_int_eq(small_shell("test $(ls mine | wc -l) = 6 && test $(cat mine/* | grep -cx mine) = 6"), 0);
    // Without gnuplot, which takes longer than these runs.
    ck_assert_int_eq(small_shell("PATH=/nonexistent $B study study.yaml -q -o out"), 0);
    ck_assert_int_eq(small_shell("PATH=/nonexistent $B study study.yaml -q -o out --fresh"), 0);
    ck_assert_int_eq(
        small_shell(
            "cd out && for f in $(find . -type f | sed 's,^./,,'); do grep -qxF $f brunt.files || echo $f; done "
            "> ../left"),
        0);
    expect_text("left", "brunt.files\nruns/0.1_m.r1/brunt.files\nruns/0.05_m.r1/brunt.files\n");
    ck_assert_int_eq(small_shell("echo mine > out/runs/0.1_m.r1/note.txt && rm out/brunt.files"), 0);
    small_expect("study study.yaml -q -o out", 65, "report.md");
    // A run's folder in the way, and a link in place of one.
    ck_assert_int_eq(
        small_shell("rm -r out && mkdir -p out/runs/0.1_m.r1 && echo mine > out/runs/0.1_m.r1/summary.json"), 0);
    small_expect("study study.yaml -q -o out", 65, "runs/0.1_m.r1/summary.json");
    small_expect("study study.yaml -q -o out --fresh", 65, "runs/0.1_m.r1/summary.json");
    expect_text("out/runs/0.1_m.r1/summary.json", "mine\n");
    ck_assert_int_eq(small_shell("mv out/runs/0.1_m.r1 elsewhere && ln -s ../../elsewhere out/runs/0.1_m.r1"), 0);
    small_expect("study study.yaml -q -o out", 65, "runs/0.1_m.r1/");
    expect_text("elsewhere/summary.json", "mine\n");
    ck_assert_int_eq(small_shell("test $(ls elsewhere | wc -l) = 1 && ! test -e out/brunt.files"), 0);
}
END_TEST

// `check` measures the disk with files of its own, whatever is there.
START_TEST(check_leaves_no_trace) {
    small_put(".brunt-check-0", "mine\n");
    small_expect("check small.yaml", 0, NULL);
    expect_text(".brunt-check-0", "mine\n");
    ck_assert_int_eq(small_shell("rm .brunt-check-0 output; test \"$(ls -A)\" = small.yaml"), 0);
}
END_TEST

// What a run will leave is said before, and warned of when it is too much for any disk.
START_TEST(check_says_what_the_disk_will_hold) {
    small_expect("check small.yaml --quick", 0, "\n  11 pictures, ");
    small_expect("check small.yaml --quick", 0, "before compression; 101 history lines, ");
    ck_assert_int_eq(small_shell("! grep -q 'warning: .*\\(pictures\\|room\\)' output"), 0);
    small_expect("check small.yaml --quick --set output.every='1 ns'", 0, "warning: 1e+08 pictures");
    small_expect("check small.yaml --quick --set output.every='1 ns'", 0, "warning: this disk has room for ");
    small_expect("check small.yaml --quick --set output.every=none", 0, "\n  0 pictures, 0 B before");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("output_folder");
    TCase *tcase = tcase_create("output folder");
    tcase_set_timeout(tcase, 0);
    tcase_add_checked_fixture(tcase, set_up, small_folder_remove);
    tcase_add_test(tcase, the_users_scene_stays);
    tcase_add_test(tcase, all_that_is_in_the_way_is_said);
    tcase_add_test(tcase, what_is_listed_goes_and_the_rest_stays);
    tcase_add_test(tcase, an_unfinished_run_is_not_begun_anew);
    tcase_add_test(tcase, a_run_that_ended_is_replaced);
    tcase_add_test(tcase, one_run_a_folder);
    tcase_add_test(tcase, a_folder_is_moved);
    tcase_add_test(tcase, a_trace_replaces_traces_only);
    tcase_add_test(tcase, links_are_not_followed);
    tcase_add_test(tcase, a_list_that_lies);
    tcase_add_test(tcase, studies_likewise);
    tcase_add_test(tcase, check_leaves_no_trace);
    tcase_add_test(tcase, check_says_what_the_disk_will_hold);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
