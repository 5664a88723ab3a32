// What the program does before it does anything: libraries that it loads, how long threads are to spin, its plan.
#include "tests/support/small_program.h"

// The loader's list, without a run. MUMPS, and the BLAS that starts threads, are loaded where matrices are factored;
// of HDF5 nothing is taken that fetches files from elsewhere.
START_TEST(few_libraries) {
    ck_assert_int_eq(small_shell("LD_TRACE_LOADED_OBJECTS=1 $B > list && grep -q libc.so list"), 0);
    ck_assert_msg(small_shell("grep -iE 'mumps|blas|lapack|curl|crypto' list") == 1, "see above");
}
END_TEST

static int spins(const char *set, const char *wanted) {
    return small_shell("env -u OMP_WAIT_POLICY %s OMP_DISPLAY_ENV=verbose KMP_SETTINGS=1 $B check small.yaml --quick "
                       "-t 2 2>&1 | grep -iE 'SPINCOUNT|BLOCKTIME' > list; grep -qE \"%s\" list",
                       set, wanted);
}

// The program says it unless the user has.
START_TEST(short_spins) {
    small_put("small.yaml", small_scene_text);
    ck_assert_int_eq(spins("", "GOMP_SPINCOUNT = '10000'|KMP_BLOCKTIME=1$"), 0);
    ck_assert_int_eq(spins("GOMP_SPINCOUNT=77 KMP_BLOCKTIME=7", "GOMP_SPINCOUNT = '77'|KMP_BLOCKTIME=7$"), 0);
    ck_assert_int_eq(spins("OMP_WAIT_POLICY=passive", "GOMP_SPINCOUNT = '0'|KMP_BLOCKTIME=0$"), 0);
}
END_TEST

// Each effect is on, with what asked for it, or among those that are off: as in the summary of the run.
START_TEST(plans_have_each_effect_once) {
    small_put("small.yaml", small_scene_text);
    ck_assert_int_eq(small_shell("$B check small.yaml --quick -t 1 | awk '/^passes/ {exit}\n"
                                 "in_list {if ($2 == \"on\") print $1, \"true\"; else\n"
                                 "  for (i = 1; i <= NF; i++) if ($i != \"off:\") print $i, \"false\"}\n"
                                 "/^effects/ {in_list = 1}' | sort > plan; test -s plan"),
                     0);
    ck_assert_int_eq(small_shell("$B run small.yaml -o out -q -t 1 && sed -n '/\"effects\"/,/}/p' out/summary.json | "
                                 "grep -oE '\"[a-z_]+\": (true|false)' | tr -d '\":' | sort > list && cmp plan list"),
                     0);
    ck_assert_int_eq(small_shell("grep -q true plan && grep -q false plan"), 0);
    ck_assert_int_eq(
        small_shell("$B check small.yaml --quick -t 1 | awk 'length > 100 && /^  off|^      [a-z_]+ [a-z_]+ /"
                    " {exit 1}'"),
        0);
}
END_TEST

// Started without standard streams the program prints into no file: the list of the folder's files has names alone, and
// the exit code says that what was to be printed is not.
START_TEST(no_streams) {
    small_put("small.yaml", small_scene_text);
    ck_assert_int_eq(small_shell("$B run small.yaml -q -o usual"), 0);
    static const char *const closed[] = {"<&- >said", ">&-", "<&- >&-", "<&- >&- 2>&-"};
    for (int c = 0; c < (int)(sizeof closed / sizeof *closed); c++) {
        ck_assert_int_eq(small_shell("$B run small.yaml --fresh -o run %s", closed[c]), c ? 74 : 0);
        ck_assert_msg(
            small_shell("cmp usual/brunt.files run/brunt.files && ls usual usual/vtu | sed s/usual/run/ > a && "
                        "ls run run/vtu | cmp - a") == 0,
            "%s: see above", closed[c]);
    }
    ck_assert_int_eq(small_shell("$B run small.yaml -q --fresh -o run <&- 2>&-"), 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_start");
    TCase *tests = tcase_create("start");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, few_libraries);
    tcase_add_test(tests, short_spins);
    tcase_add_test(tests, plans_have_each_effect_once);
    tcase_add_test(tests, no_streams);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
