// time.scheme alone changes a scene between explicit and implicit steps: keys of both beside each other, and all
// implicit scenes of bench/scenes, which explicit steps take, or say why not.
#include "tests/support/small_program.h"

#include <dirent.h>

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const char scene[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 40 ms, scheme: implicit, step: 10 ms, cfl: 0.5}\n"
    "materials: {rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}\n"
    "bodies: {block: {method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [0, 0], max: [0.5, 0.5]}}}}\n"
    "output: {every: none, checkpoint: none}\n";

// Each takes its own and says what it leaves; a step that is longer than the run is no matter where it is left.
START_TEST(step_and_cfl) {
    small_put("small.yaml", scene);
    small_expect("check small.yaml --quick", 0,
                 "warning: small.yaml:3:51: time.cfl: of explicit steps, not used by implicit ones");
    ck_assert_int_eq(small_shell("grep -q 'first step 0.01 s' output && ! grep 'step is that of body' output"), 0);
    small_expect("check small.yaml --quick --set time.scheme=explicit --set time.step=1", 0,
                 "warning: --set time.step=1: of implicit steps where cfl is beside it, not used by explicit ones");
    ck_assert_int_eq(small_shell("grep -q '  cfl 0.5, first step 0.00' output"), 0);
    small_expect("run small.yaml -o out -q --set time.scheme=explicit", 0, NULL);
    small_expect("run out/scene.yaml -o back -q --set time.scheme=implicit", 0, NULL);
    small_expect("run small.yaml -o implicit -q", 0, NULL);
    ck_assert_int_eq(small_shell("grep state_hash back/summary.json > a; grep state_hash implicit/summary.json | cmp "
                                 "- a"),
                     0);
}
END_TEST

// What longer steps would gain where points hold together: where the scene leaves something to gain.
START_TEST(longer_steps_of_points) {
    small_put("small.yaml",
              "brunt: 1\n"
              "dimension: 2\n"
              "time: {end: 10 ms}\n"
              "grid: {cell: 0.1 m}\n"
              "materials: {rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}\n"
              "bodies: {block: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [1, 1]}}}}\n"
              "output: {every: none, checkpoint: none}\n");
    const char said[] = "grep -q 'block (stable up to [0-9.]* s); points that hold together are stable up to time.cfl "
                        "0.6: 1.2 times as "
                        "long (steps ' output",
               nothing[] = "grep -q 'block (stable up to [0-9.]* s)$' output";
    small_expect("check small.yaml --quick", 0, NULL);
    ck_assert_int_eq(small_shell("%s", said), 0);
    for (int k = 0; k < 3; k++) {
        static const char *const sets[] = {"time.cfl=0.6", "grid.kernel=linear --set grid.transfer=flip",
                                           "time.step=1e-4"};
        char line[128];
        snprintf(line, sizeof line, "check small.yaml --quick --set %s", sets[k]);
        small_expect(line, 0, NULL);
        ck_assert_msg(small_shell("%s", nothing) == 0, "%s", sets[k]);
    }
}
END_TEST

// What a step that is too long for explicit steps wants beside it.
START_TEST(step_too_long) {
    small_put("small.yaml", scene);
    ck_assert_int_eq(small_shell("sed 's/, cfl: 0.5//' small.yaml > long.yaml"), 0);
    small_expect(
        "check long.yaml --quick --set time.scheme=explicit", 65,
        "time.cfl, a share of the stable one, is what explicit steps go by where it is given beside time.step");
    // It is told as it was asked for, though a picture cuts the first step, and where, before anything is written.
    small_expect("check long.yaml --quick --set time.scheme=explicit --set output.every='9 ms'", 65,
                 "the fixed step of 0.01 s is larger");
    small_expect("run long.yaml -o none -q --set time.scheme=explicit", 65, "long.yaml:3:");
    ck_assert_int_eq(small_shell("test -e none"), 1);
}
END_TEST

// Scenes that are of implicit steps alone, and what says why.
static const char *const of_one[][2] = {
    {"brazilian_disk", "half their spacing out from their centres, in implicit ones at the centres"},
    {"cube_twist", "half their spacing out from their centres, in implicit ones at the centres"},
    {"friction_slope", "half their spacing out from their centres, in implicit ones at the centres"},
    {"tube_press", "contact of a body with itself is for membranes in explicit steps"}};

static bool is_implicit(const char *name) {
    return small_shell("grep -q 'scheme: implicit' \"$BRUNT_SOURCE\"/bench/scenes/'%s'", name) == 0;
}

START_TEST(scenes_of_both) {
    char path[1024], command[2048];
    int count = 0, told = 0;
    ck_assert_ptr_nonnull(getenv("BRUNT_SOURCE"));
    snprintf(path, sizeof path, "%s/bench/scenes", getenv("BRUNT_SOURCE"));
    DIR *folder = opendir(path);
    ck_assert_msg(folder != NULL, "%s", path);
    for (struct dirent *entry; (entry = readdir(folder));) {
        const char *why = NULL, *end = strstr(entry->d_name, ".yaml");
        if (!end || !is_implicit(entry->d_name)) continue;
        for (size_t k = 0; k < sizeof of_one / sizeof *of_one; k++)
            if (!strncmp(entry->d_name, of_one[k][0], (size_t)(end - entry->d_name))) why = of_one[k][1];
        snprintf(command, sizeof command, "check %s/%s --quick --set time.scheme=explicit --set time.cfl=0.4", path,
                 entry->d_name);
        small_expect(command, why ? 65 : 0, why);
        count++, told += why != NULL;
    }
    closedir(folder);
    ck_assert_int_gt(count, told);
    ck_assert_int_eq(told, sizeof of_one / sizeof *of_one);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_schemes");
    TCase *tests = tcase_create("program_schemes");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, step_and_cfl);
    tcase_add_test(tests, longer_steps_of_points);
    tcase_add_test(tests, step_too_long);
    tcase_add_test(tests, scenes_of_both);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#endif
