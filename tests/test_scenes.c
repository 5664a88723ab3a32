// Labels: verification
// The short ones of bench/scenes, run by the program as a user would: every measure with an expected value must hold.
#include "small_scene.h"

#include <jansson.h>
#include <sys/wait.h>

#include "real.h"

static const struct {
    const char *name, *options;
} scenes[] = {
    {"oblique_blocks", ""},
    {"oblique_blocks_mpm", ""},
    {"ramp", ""},
    {"ramp", "--set bodies.cube.size=0.5"},
    {"resting_stack", ""},
    {"rod_on_wall", "--set 'bodies.rod.size=0.1 in'"}, // in the scene half as long
    {"dam_break", ""},
    {"hencky_membrane", "--set 'bodies.membrane.size=10 mm'"},
    {"sphere_on_membrane",
     "--set 'grid.cell=2 mm' --set 'bodies.membrane.size=2 mm' --set 'bodies.sphere.spacing=1 mm'"},
    {"gas_in_soft_membrane", "--set bodies.gas.spacing=0.05"},
    {"tensile_bar", "--set 'grid.cell=0.5 mm'"},
    {"whipple_shield", "--set 'grid.cell=1 mm'"},
    {"shock_tube", ""},
    {"shock_tube_mpm", ""},
    {"plate_impact_copper", ""},
    {"plate_impact_copper_mpm", ""},
    {"taylor_bar_wilkins", ""},
    {"tnt_slab", "--set 'bodies.slab.size=0.1 mm'"},
    {"taylor_bar_axisymmetric", ""},
    {"ceramic_impact", ""},
    {"ogive_6061", "--set 'grid.cell=1 mm'"},
    {"plate_weldox_blunt", "--set 'bodies.plate.size=0.4 mm'"},
};
enum { SCENES = sizeof scenes / sizeof scenes[0] };

// What the scenes judge to more digits than single precision has.
static bool asks_for_double(const char *key) {
    return strstr(key, "_drift") || !strcmp(key, "free_flight") || !strcmp(key, "energy_error");
}

START_TEST(measures_hold) {
    const char *program = getenv("BRUNT"), *source = getenv("BRUNT_SOURCE");
    ck_assert_msg(program && source, "BRUNT must name the program, BRUNT_SOURCE the source folder");
    char command[1024], path[256];
    snprintf(command, sizeof command, "'%s' run '%s/bench/scenes/%s.yaml' %s --set output.every=none -t 1 -q -o '%s'",
             program, source, scenes[_i].name, scenes[_i].options, small_path("out"));
    int status = system(command);
    ck_assert_msg(WIFEXITED(status) && WEXITSTATUS(status) == 0, "%s: %d", command, status);
    snprintf(path, sizeof path, "%s/out/summary.json", small_folder);
    json_t *summary = json_load_file(path, 0, NULL), *measures = json_object_get(summary, "measures"), *measure;
    ck_assert_ptr_nonnull(measures);
    const char *key;
    int judged = 0;
    json_object_foreach(measures, key, measure) {
        json_t *ok = json_object_get(measure, "ok");
        if (!json_is_boolean(ok)) continue;
        if (sizeof(real) == 4 && asks_for_double(key)) continue;
        ck_assert_msg(json_is_true(ok), "%s %s: %s is %g", scenes[_i].name, scenes[_i].options, key,
                      json_number_value(json_object_get(measure, "value")));
        judged++;
    }
    ck_assert_int_ge(judged, 3);
    json_decref(summary);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("scenes");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_checked_fixture(all, small_folder_make, small_folder_remove);
    tcase_add_loop_test(all, measures_hold, 0, SCENES);
    suite_add_tcase(suite, all);
    return small_main(suite);
}
