// What only the world of a scene can tell is said with the place in the file, as all else; and lengths in decimals are
// as long as they are written.
#include "tests/support/small_program.h"

static void set_up(void) {
    small_folder_make();
    small_put("small.yaml", small_scene_text);
}

START_TEST(fields_have_places) {
    const char *fields = "  fields: [velocity, stress]\n";
    char *text = strdup(small_scene_text), *at = strstr(text, fields);
    memcpy(at, "  fields: [velocity, strass]\n", strlen(fields));
    small_put("fields.yaml", text);
    free(text);
    small_expect("run fields.yaml", 65, "fields.yaml:19:22: output.fields[1]: no body has a field 'strass'");
    small_expect("check fields.yaml", 65, "fields.yaml:19:22: output.fields[1]: no body has a field 'strass'");
    small_expect("run small.yaml --set output.fields=[velocity,stres]", 65,
                 "--set output.fields=[velocity,stres]: output.fields[1]: no body has a field 'stres'");
    small_expect("run small.yaml --set output.probes.corner.field=heat", 65,
                 "small.yaml:20:12: output.probes.corner: ");
}
END_TEST

// Of bodies in each other, and behind a plane: the body that is named first.
START_TEST(overlaps_have_places) {
    small_put("other.yaml", small_elements_text);
    small_expect("run other.yaml --set loads.gravity=[0,0,-9]", 0, NULL);
    small_expect("run other.yaml --set bodies.upper.place=[{translate:[0,0,-0.1]}]", 65,
                 "other.yaml:9:3: bodies.upper");
    small_expect("run other.yaml --set boundaries[0].plane.point=[0,0,0.1]", 65,
                 "other.yaml:8:3: bodies.lower is 0.1 m");
}
END_TEST

// 0.3 - 0.2 is less than 0.1; an element or a cell of 0.1 is as wide as that all the same, and one of 0.1001 is not.
START_TEST(decimals_are_taken_as_written) {
    static const char text[] =
        "brunt: 1\n"
        "dimension: 2\n"
        "time: {end: 1 ms}\n"
        "grid: {cell: 0.1}\n"
        "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\n"
        "bodies:\n"
        "  a: {method: fem, material: rubber, size: 0.1, shape: {box: {min: [0.2, 0.7], max: "
        "[0.3, 0.8]}}}\n"
        "  b: {method: mpm, material: rubber, shape: {box: {min: [0.2, 0.2], max: [0.3, 0.3]}}}\n"
        "output: {every: none}\n";
    small_put("decimals.yaml", text);
    small_expect("run decimals.yaml", 0, "4 particles, 1 elements");
    small_expect("run decimals.yaml --set bodies.a.size=0.1001", 65, "are larger than the body");
    small_expect("run decimals.yaml --set grid.cell=0.1001", 65, "smallest extent");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("places");
    TCase *tests = tcase_create("places");
    tcase_add_checked_fixture(tests, set_up, small_folder_remove);
    tcase_add_test(tests, fields_have_places);
    tcase_add_test(tests, overlaps_have_places);
    tcase_add_test(tests, decimals_are_taken_as_written);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
