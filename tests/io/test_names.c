// Text and names: byte order marks, NUL characters, and names that make one column of the history of two things.
#include "io/mesh/gmsh.h"
#include "io/output/history.h"
#include "tests/support/small_scene.h"
#include "io/study/study.h"

#define MARK "\xEF\xBB\xBF"

static int parse(const char *text, const char *set, char **messages) {
    size_t size;
    brunt_scene scene;
    FILE *out = open_memstream(messages, &size);
    const int status = brunt_scene_parse(text, strlen(text), "n.yaml", &set, set != NULL, &scene, out);
    fclose(out);
    brunt_scene_free(&scene);
    return status;
}

static void expect(const char *text, const char *set, const char *message) {
    char *messages;
    const int status = parse(text, set, &messages);
    ck_assert_msg(status == (message ? BRUNT_BAD_INPUT : BRUNT_OK) && (!message || strstr(messages, message)),
                  "%d, wanted '%s':\n%s", status, message ? message : "", messages);
    free(messages);
}

START_TEST(a_mark_may_stand_first) {
    char *text;
    ck_assert_int_gt(asprintf(&text, MARK "%s", small_scene_text), 0);
    expect(text, NULL, NULL);
    free(text);
    expect(MARK "brunt: 2\n", NULL, "n.yaml:1:8: brunt: '2' is out of range");
    expect(MARK "brunt: 2\n", NULL, "\n    brunt: 2\n           ^\n"); // and the caret is under it
    expect(MARK, NULL, "n.yaml:1:1: the file is empty");
    expect(MARK MARK "brunt: 1\n", NULL, "n.yaml:1:1: byte 0xEF is not text");
    expect("brunt: 1\n" MARK "title: x\n", NULL, "n.yaml:2:1: byte 0xEF is not text");
}
END_TEST

// A study, its scene and the scene's mesh, each with a mark.
START_TEST(a_mark_may_stand_first_in_every_file) {
    small_folder_make();
    long size;
    char *mesh = small_read("tests/meshes/brick_22_text.msh", &size), *marked = malloc((size_t)size + 3);
    memcpy(marked, MARK, 3), memcpy(marked + 3, mesh, (size_t)size);
    small_write(small_path("cube.msh"), marked, size + 3);
    free(marked), free(mesh);
    static const char scene[] = MARK "brunt: 1\n"
                                     "time: {end: 1 ms}\n"
                                     "materials: {rubber: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
                                     "bodies: {cube: {method: fem, material: rubber, mesh: cube.msh}}\n"
                                     "measures: {kept: {energy: total, at: end}}\n";
    small_write(small_path("cube.yaml"), scene, (long)strlen(scene));
    static const char study[] = MARK "brunt_study: 1\n"
                                     "scene: cube.yaml\n"
                                     "axes: {cfl: {key: time.cfl, values: [0.5, 0.6], role: resolution}}\n"
                                     "measures: {kept: {reference: 1}}\n";
    small_write(small_path("study.yaml"), study, (long)strlen(study));
    char *messages;
    size_t length;
    FILE *out = open_memstream(&messages, &length);
    brunt_study read;
    const int status = brunt_study_read(small_path("study.yaml"), &read, out);
    fclose(out);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
    brunt_study_free(&read);
    free(messages);
    small_folder_remove();
}
END_TEST

START_TEST(nul_characters_are_refused) {
    static const char *const escapes[] = {"\\0", "\\x00", "\\u0000", "\\U00000000"};
    for (int i = 0; i < 4; i++) {
        char set[64];
        snprintf(set, sizeof set, "title=\"a%sx\"", escapes[i]);
        expect(small_scene_text, set, "a NUL character (\\0) in text");
        snprintf(set, sizeof set, "bodies={\"a%sx\": {}}", escapes[i]);
        expect(small_scene_text, set, "a NUL character (\\0) in text");
    }
    expect(small_scene_text, "title=\"a\\\\0x\"", NULL); // a backslash, and no escape
    expect(small_scene_text, "title='a\\0x'", NULL);
}
END_TEST

// Whatever is accepted has columns of different names.
static bool columns_differ(const char *text) {
    brunt_scene scene;
    char *messages;
    size_t size;
    FILE *out = open_memstream(&messages, &size);
    const int status = brunt_scene_parse(text, strlen(text), "n.yaml", NULL, 0, &scene, out);
    fclose(out);
    ck_assert_msg(status == BRUNT_OK || strstr(messages, "in the history, contact."), "%s", messages);
    free(messages);
    if (status) return false;
    brunt_world *world = small_world(&scene);
    brunt_error error = {0};
    brunt_history *history = brunt_history_create(world, &scene, &error);
    ck_assert_msg(history != NULL, "%s", error.message);
    const int32_t n = brunt_history_column_count(history);
    for (int32_t c = 0; c < n; c++)
        for (int32_t d = 0; d < c; d++)
            ck_assert_msg(strcmp(brunt_history_column_name(history, c), brunt_history_column_name(history, d)),
                          "the column %s is there twice", brunt_history_column_name(history, c));
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    return true;
}

static bool bodies_differ(const char *const names[4], const char *contact) {
    char text[2000];
    int used = snprintf(text, sizeof text,
                        "brunt: 1\ndimension: 2\ntime: {end: 1 ms}\n"
                        "materials: {rubber: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\nbodies:\n");
    for (int i = 0; i < 4 && names[i]; i++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "  %s: {method: fem, material: rubber, size: 1, shape: {box: {min: [%d, 0], max: [%d, 1]}}}\n",
                         names[i], 2 * i, 2 * i + 1);
    snprintf(text + used, sizeof text - (size_t)used, "%s", contact);
    return columns_differ(text);
}

START_TEST(pairs_of_one_name_are_refused) {
    ck_assert(!bodies_differ((const char *[4]){"a-b", "c", "a", "b-c"}, ""));
    ck_assert(!bodies_differ((const char *[4]){"c", "a", "b-c", "a-b"}, ""));
    ck_assert(bodies_differ((const char *[4]){"a-b", "c", "a", "b-d"}, ""));
    ck_assert(bodies_differ((const char *[4]){"a-b", "c", "a", "bc"}, ""));
    ck_assert(bodies_differ((const char *[4]){"force", "a", "force_x", "a-force"}, ""));
    // Only of pairs in contact are there columns.
    ck_assert(bodies_differ((const char *[4]){"a-b", "c", "a", "b-c"}, "contact: {method: none}\n"));
    ck_assert(bodies_differ((const char *[4]){"a-b", "c", "a", "b-c"},
                            "contact: {pairs: [{between: [c, a-b], method: none}]}\n"));
    ck_assert(!bodies_differ((const char *[4]){"a-b", "c", "a", "b-c"},
                             "contact: {method: none, pairs: [{between: [c, a-b], method: augury}, {between: [a, b-c], "
                             "method: augury}]}\n"));
}
END_TEST

// Names that a boundary, a probe and a measure get of themselves or of the user.
START_TEST(other_columns_differ) {
    static const char *const ends[] = {
        "boundaries: [{name: plane2, plane: {point: [0, -1], normal: [0, 1]}, condition: slip}, {group: xmin, body: a, "
        "fix: [x]}]\n",
        "boundaries: [{name: a, group: xmin, body: a, fix: [x]}, {name: a-b, group: xmax, body: a, fix: [x]}]\n",
        "output: {probes: {a: {body: a, point: [0, 0], field: velocity}, a-x: {body: a, point: [0, 0], field: "
        "pressure}}}\n"};
    for (int i = 0; i < 3; i++) ck_assert(bodies_differ((const char *[4]){"a", "b"}, ends[i]));
    expect(small_scene_text,
           "boundaries=[{name: plane2, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}, "
           "{plane: {point: [0, 0], normal: [0, 1]}, condition: separate}]",
           "the name 'plane2' is there twice");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("names");
    TCase *tests = tcase_create("names");
    tcase_add_test(tests, a_mark_may_stand_first);
    tcase_add_test(tests, a_mark_may_stand_first_in_every_file);
    tcase_add_test(tests, nul_characters_are_refused);
    tcase_add_test(tests, pairs_of_one_name_are_refused);
    tcase_add_test(tests, other_columns_differ);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
