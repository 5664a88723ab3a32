// The table of keys: fields hold what their rows store in them. Keys and words in their spelling of one version ago
// mean the same scene, with a warning at the place that names the new one; both spellings at once are a mistake.
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/scene/scene.h"
#include "io/scene/scene_keys.h"
#include "tests/support/suite.h"

#define HEAD                                                                                                           \
    "brunt: 1\ntime: {end: 1 ms}\nmaterials: {m: {model: neo-hookean, density: 1, E: 1 MPa, nu: 0.3}}\nbodies:\n"
#define BODY "method: membrane, material: m, size: 1 m, thickness: 1 mm"

static const char former[] = HEAD "  a: {" BODY ", slack: true,\n"
                                  "    shape: {sphere: {center: [0, 0, 0], radius: 2}}}\n"
                                  "  b: {method: fem, material: m, size: 1 m, shape: {ring: {center: [9, 0, 0],\n"
                                  "    axis: [0, 0, 1], inner_radius: 1 m, radius: 2 m, length: 1 m}}}\n"
                                  "contact: {form: affine}\n";
static const char now[] = HEAD "  a: {" BODY ", tension_only: true,\n"
                               "    shape: {sphere: {center: [0, 0, 0], radius: 2}}}\n"
                               "  b: {method: fem, material: m, size: 1 m, shape: {tube: {center: [9, 0, 0],\n"
                               "    axis: [0, 0, 1], inner_radius: 1 m, radius: 2 m, length: 1 m}}}\n"
                               "contact: {form: node_to_facet}\n";

// The resolved scene, its warnings behind it when asked for. NULL, with what was said: it is no scene.
static char *read_scene(const char *text, const char *set, char **said) {
    char *resolved = NULL;
    size_t size, length;
    FILE *messages = open_memstream(said, &size);
    brunt_scene scene;
    const int status = brunt_scene_parse(text, strlen(text), "f.yaml", &set, set != NULL, &scene, messages);
    fclose(messages);
    if (status) return NULL;
    FILE *out = open_memstream(&resolved, &length);
    ck_assert_int_eq(brunt_scene_write(&scene, out), BRUNT_OK);
    fclose(out);
    free(*said);
    *said = strdup(scene.warnings ? scene.warnings : "");
    brunt_scene_free(&scene);
    return resolved;
}

START_TEST(old_files_mean_the_same) {
    char *warnings, *none, *old = read_scene(former, NULL, &warnings), *new = read_scene(now, NULL, &none);
    ck_assert_msg(old && new, "%s%s", warnings, none);
    ck_assert_str_eq(old, new);
    ck_assert_str_eq(none, "");
    static const char *const wanted[] = {
        "f.yaml:5:66: bodies.a.slack: the name is now 'tension_only', this one goes with the next version\n",
        "f.yaml:7:52: bodies.b.shape.ring: the name is now 'tube', this one goes with the next version\n",
        "f.yaml:9:17: contact.form: 'affine' is now 'node_to_facet', this name goes with the next version\n"};
    for (int i = 0; i < 3; i++) ck_assert_msg(strstr(warnings, wanted[i]) != NULL, "%s", warnings);
    // A resolved scene has the new names alone.
    free(warnings);
    char *again = read_scene(old, NULL, &warnings);
    ck_assert_str_eq(again, new);
    ck_assert_str_eq(warnings, "");
    free(again), free(old), free(new), free(warnings), free(none);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(every_word_has_its_own) {
    static const char *const words[][2] = {{"affine", "node_to_facet"},
                                           {"smooth", "averaged_facets"},
                                           {"surface", "averaged_surface"},
                                           {"paper", "published"}};
    for (int i = 0; i < 4; i++) {
        char set[2][64], *said[2];
        for (int k = 0; k < 2; k++) snprintf(set[k], sizeof set[k], "contact.form=%s", words[i][k]);
        char *a = read_scene(now, set[0], &said[0]), *b = read_scene(now, set[1], &said[1]);
        ck_assert_msg(a && b, "%s%s", said[0], said[1]);
        ck_assert_str_eq(a, b);
        ck_assert_msg(strstr(said[0], set[0]) && strstr(said[0], words[i][1]), "%s", said[0]); // the override is named
        ck_assert_str_eq(said[1], "");
        free(a), free(b), free(said[0]), free(said[1]);
    }
}
END_TEST

START_TEST(both_at_once_are_a_mistake) {
    char *said, *none = read_scene(HEAD "  a: {" BODY ", tension_only: true, slack: true,\n"
                                        "    shape: {sphere: {center: [0, 0, 0], radius: 2}}}\n",
                                   NULL, &said);
    ck_assert(none == NULL);
    ck_assert_msg(strstr(said, "f.yaml:5:86: bodies.a.slack: this is the former name of 'tension_only', one of them is "
                               "wanted") != NULL,
                  "%s", said);
    free(said);
    none = read_scene(now, "bodies.a.slack=false", &said); // a file and an override
    ck_assert(none == NULL && strstr(said, "former name of 'tension_only'"));
    free(said);
    // What is wrong with a value is said at its place, beside the warning.
    none = read_scene(former, "bodies.a.slack=maybe", &said);
    ck_assert(none == NULL && strstr(said, "'maybe' is not available"));
    free(said);
}
END_TEST

// A value is stored in a field that can hold it.
START_TEST(fields_hold_their_values) {
    int fields = 0;
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        const int words = row->type == SCENE_WORD ? brunt_scene_word_count(row->words) : 0;
        bool fits = true;
        switch (row->field.store) {
        case STORE_NOT: continue;
        case STORE_REAL: fits = row->type == SCENE_REAL; break;
        case STORE_INTEGER: fits = row->type == SCENE_INTEGER && row->min >= INT32_MIN && row->max <= INT32_MAX; break;
        case STORE_CHOICE: fits = words > 1; break;
        case STORE_FLAG: fits = words == 2; break;
        case STORE_VECTOR: fits = row->type == SCENE_VECTOR; break;
        }
        ck_assert_msg(fits && !strchr(row->path, '<'), "%s", row->path);
        fields++;
    }
    ck_assert_int_gt(fields, 30);
}
END_TEST

// Former words stand in for those of today one by one, and no former key is one of today's beside it.
START_TEST(the_table_keeps_its_promises) {
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        if (row->former_words)
            ck_assert_msg(brunt_scene_word_count(row->former_words) == brunt_scene_word_count(row->words), "%s",
                          row->path);
        if (!row->former) continue;
        char path[128];
        const char *key = strrchr(row->path, '.');
        snprintf(path, sizeof path, "%.*s%s", key ? (int)(key + 1 - row->path) : 0, row->path, row->former);
        ck_assert_msg(brunt_scene_row(path) == NULL, "%s", path);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("scene_keys");
    TCase *tcase = tcase_create("names");
    tcase_add_test(tcase, old_files_mean_the_same);
    tcase_add_test(tcase, every_word_has_its_own);
    tcase_add_test(tcase, both_at_once_are_a_mistake);
    tcase_add_test(tcase, fields_hold_their_values);
    tcase_add_test(tcase, the_table_keeps_its_promises);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
