// Two small rubber blocks that meet above a floor, of particles or of elements: enough of a world for the tests of what
// is written about one.
#pragma once

#include "tests/support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/scene/scene.h"
#include "tests/support/suite.h"

static const char small_scene_text[] =
    "brunt: 1\n"
    "title: Two small blocks\n"
    "dimension: 2\n"
    "time: {end: 0.1 s, cfl: 0.4}\n"
    "grid: {cell: 0.1 m}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
    "bodies:\n"
    "  left: {method: mpm, material: rubber, shape: {box: {min: [0, 0.1], max: [0.5, 0.6]}}, velocity: [5, 0]}\n"
    "  right: {method: mpm, material: rubber, shape: {box: {min: [0.6, 0.1], max: [1.1, 0.4]}}, velocity: [-5, -1]}\n"
    "contact: {method: multi-velocity, friction: 0.2}\n"
    "boundaries:\n"
    "  - {name: floor, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}\n"
    "loads: {gravity: [0, -10]}\n"
    "output:\n"
    "  every: 10 ms\n"
    "  history: 1 ms\n"
    "  checkpoint: 0 s\n"
    "  fields: [velocity, stress]\n"
    "  probes: {corner: {body: left, point: [0, 0.1], field: velocity}}\n"
    "measures:\n"
    "  kept: {history: energy.total, relative_to: initial, expect: 1, tolerance: 0.5}\n"
    "  length: {extent: {body: left, axis: [1, 0]}, unit: m}\n";

// The same of finite elements, in three dimensions: a block falls onto one that stands on a floor and is held on one
// side.
static const char small_elements_text[] =
    "brunt: 1\n"
    "title: Two small blocks of elements\n"
    "dimension: 3\n"
    "time: {end: 0.04 s, cfl: 0.5}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
    "bodies:\n"
    "  lower: {method: fem, material: rubber, size: 0.1 m, shape: {box: {min: [0, 0, 0], max: [0.4, 0.4, 0.2]}}}\n"
    "  upper: {method: fem, material: rubber, size: 0.1 m, element: tet4, velocity: [0, 0, -4],\n"
    "    shape: {box: {min: [0.1, 0.1, 0.22], max: [0.3, 0.3, 0.42]}}}\n"
    "contact: {friction: 0.2}\n"
    "boundaries:\n"
    "  - {name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate}\n"
    "  - {name: grip, group: xmin, body: lower, fix: [x]}\n"
    "loads: {gravity: [0, 0, -10]}\n"
    "output:\n"
    "  every: 10 ms\n"
    "  history: 1 ms\n"
    "  checkpoint: 0 s\n"
    "  probes:\n"
    "    corner: {body: upper, point: [0.1, 0.1, 0.22], field: velocity}\n"
    "    middle: {body: lower, point: [0.26, 0.26, 0.17], field: stress}\n"
    "measures:\n"
    "  kept: {history: energy.total, relative_to: initial, expect: 1, tolerance: 0.5}\n"
    "  height: {extent: {body: upper, axis: [0, 0, 1]}, unit: m}\n";

static inline void small_scene_of(const char *text, brunt_scene *scene, const char *const *sets, int set_count) {
    char *messages = NULL;
    size_t size;
    FILE *out = open_memstream(&messages, &size);
    int status = brunt_scene_parse(text, strlen(text), "small.yaml", sets, set_count, scene, out);
    fclose(out);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
    free(messages);
}

static inline void small_scene(brunt_scene *scene, const char *const *sets, int set_count) {
    small_scene_of(small_scene_text, scene, sets, set_count);
}

static inline char *small_scene_resolved(const brunt_scene *scene) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    ck_assert_int_eq(brunt_scene_write(scene, out), 0);
    fclose(out);
    return text; // free()
}

static inline brunt_world *small_world(const brunt_scene *scene) {
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(&scene->world, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    return world;
}

static inline void small_steps(brunt_world *world, int count) {
    brunt_error error = {0};
    for (int s = 0; s < count; s++) {
        int status = brunt_world_step(world, 1e30, &error);
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    }
}

// A folder of the test's own, removed by small_folder_remove.
static char small_folder[64];
static inline void small_folder_make(void) {
    strcpy(small_folder, "/tmp/brunt_test_XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(small_folder));
}
static inline void small_folder_remove(void) {
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", small_folder);
    ck_assert_int_eq(system(command), 0);
}
static inline const char *small_path(const char *name) {
    static char path[4][160];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", small_folder, name);
    return path[next];
}

// Whole files in memory, to be damaged.
static inline char *small_read(const char *path, long *size) {
    FILE *file = fopen(path, "rb");
    ck_assert_msg(file != NULL, "%s", path);
    fseek(file, 0, SEEK_END);
    *size = ftell(file);
    rewind(file);
    char *bytes = malloc((size_t)*size + 1);
    ck_assert_int_eq((int)(fread(bytes, 1, (size_t)*size, file) == (size_t)*size), 1);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}
static inline void small_write(const char *path, const char *bytes, long size) {
    FILE *file = fopen(path, "wb");
    ck_assert_msg(file != NULL, "%s", path);
    ck_assert_int_eq((int)(fwrite(bytes, 1, (size_t)size, file) == (size_t)size), 1);
    fclose(file);
}

// A file that must be refused begins with lines "# expect: LINE:COLUMN: SUBSTRING", one for each mistake in order; no
// other mistake may be among the messages, which name the file `path`, and nothing may be left in memory.
static inline void small_expect_mistakes(const char *name, const char *path, const char *text, const char *messages) {
    const char *message = messages, *expect = text;
    int wanted = 0;
    for (; strncmp(expect, "# expect: ", 10) == 0; expect += strcspn(expect, "\n") + 1, wanted++) {
        int line, column, used = 0;
        ck_assert_msg(sscanf(expect, "# expect: %d:%d: %n", &line, &column, &used) == 2 && used > 0,
                      "%s: bad expect line", name);
        char place[1200], *substring = strndup(expect + used, strcspn(expect + used, "\n"));
        snprintf(place, sizeof place, "%s:%d:%d: ", path, line, column);
        while (*message == ' ') message += strcspn(message, "\n") + 1; // lines of excerpts are indented
        char *first = strndup(message, strcspn(message, "\n"));
        bool as_expected = strncmp(first, place, strlen(place)) == 0 && strstr(first, substring);
        ck_assert_msg(as_expected, "%s: expected %d:%d: %s, got:\n%s", name, line, column, substring, messages);
        message += strcspn(message, "\n");
        if (*message) message++;
        free(first);
        free(substring);
    }
    ck_assert_msg(wanted > 0, "%s expects nothing", name);
    while (*message == ' ') message += strcspn(message, "\n") + 1;
    ck_assert_msg(*message == 0, "%s: one mistake too many:\n%s", name, message);
    ck_assert_msg(brunt_memory_live() == 0, "%s leaks", name);
}
