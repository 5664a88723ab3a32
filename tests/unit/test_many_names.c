// What scenes of many bodies cost in comparisons of names, which do not depend on what else the machine does: four
// times the bodies take some four times as many, while they are read, made into a world, and written about.
#include "body/bodies.h"
#include "io/output/checkpoint.h"
#include "io/output/history.h"
#include "io/output/measures.h"
#include "io/output/positions.h"
#include "io/run/run_folder.h"
#include "tests/support/small_scene.h"
#include "world/world.h"

#include <hdf5.h>
#include <libfyaml.h>
#include <sys/stat.h>
#include <unistd.h>

static int64_t comparisons;

// In the place of those of the C library, for all that this program is made of.
int strcmp(const char *a, const char *b) {
    comparisons++;
    for (; *a && *a == *b; a++) b++;
    return (unsigned char)*a - (unsigned char)*b;
}

int strncmp(const char *a, const char *b, size_t count) {
    comparisons++;
    for (; count && *a && *a == *b; a++, count--) b++;
    return count ? (unsigned char)*a - (unsigned char)*b : 0;
}

static int64_t opened; // datasets of HDF5 files, by their names: calls come here (tests/CMakeLists.txt)
hid_t __real_H5Dopen2(hid_t file, const char *name, hid_t access);
hid_t __wrap_H5Dopen2(hid_t file, const char *name, hid_t access);
hid_t __wrap_H5Dopen2(hid_t file, const char *name, hid_t access) {
    opened++;
    return __real_H5Dopen2(file, name, access);
}

// Of keys, by libfyaml.
bool fy_node_compare(struct fy_node *a, struct fy_node *b) {
    comparisons++;
    return fy_node_compare_user(a, b, NULL, NULL, NULL, NULL);
}

// Squares of points and of an element in turns, apart, each of a material of its own; those of points are held by
// boundaries of their own that name them and turned by others, and each body and boundary has a measure.
static char *text_of(int count) {
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fputs("brunt: 1\ntitle: Many\ndimension: 2\ntime: {end: 1 ms, step: 1 ms}\ngrid: {cell: 1 m}\n"
          "materials:\n",
          out);
    for (int i = 0; i < count; i++)
        fprintf(out, "  m%05d: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}\n", i);
    fputs("bodies:\n", out);
    for (int i = 0; i < count; i++) {
        const int x = 4 * (i % 50), y = 4 * (i / 50);
        fprintf(out, "  b%05d: {method: %s, material: m%05d, shape: {box: {min: [%d, %d], max: [%d, %d]}}}\n", i,
                i % 2 ? "fem, element: quad4, size: 1 m" : "mpm", i, x, y, x + 1, y + 1);
    }
    fputs("contact: {method: augury}\nboundaries:\n", out);
    for (int i = 0; i < count; i += 2)
        fprintf(out,
                "  - {name: w%05d, body: b%05d, region: {box: {min: [-1, -1], max: [1000, 1000]}}, "
                "velocity: [0, 0]}\n  - {body: b%05d, rotor: {point: [%d, 0], radius: 0.1 m, rate: 0 rad/s}}\n",
                i, i, i, 4 * (i % 50));
    fputs("output: {every: none, fields: [velocity]}\nmeasures:\n", out);
    for (int i = 0; i < count; i++)
        fprintf(out,
                "  m%05d: {history: body.b%05d.velocity_y, unit: m/s}\n  f%05d: {history: contact.b%05d-b%05d.area, "
                "unit: m}\n",
                i, i, i, i, (i + 1) % count);
    for (int i = 0; i < count; i += 2)
        fprintf(out,
                "  w%05d: {history: wall.w%05d.impulse_x, unit: N s}\n  r%05d: {history: wall.rotor%d.impulse_x, "
                "unit: N s}\n",
                i, i, i, i / 2 + 1);
    fclose(out);
    return text;
}

enum { READ, MADE, LISTED, SAMPLED, FETCHED, STATED, IDENTIFIED, FOUND, STAGES };
static const char *const stages[STAGES] = {"reading",           "making the world",  "listing columns",
                                           "lines of history",  "reading them back", "blocks of state",
                                           "identity of a run", "finding bodies"};

static void take(int64_t *cost) {
    *cost = comparisons;
    comparisons = 0;
}

static int64_t asked; // how often bodies were asked for the number of their blocks
static int count_blocks(const brunt_body_ref *body) {
    asked++;
    return body->mpm ? brunt_points_ops.block_count(body) : brunt_mesh_ops.block_count(body);
}

// Each block of the state once, as checkpoints do.
static void look_at_state(brunt_world *world) {
    static brunt_body_ops counted[2];
    counted[0] = brunt_points_ops, counted[1] = brunt_mesh_ops;
    asked = 0;
    for (int i = 0; i < world->bodies.count; i++) {
        brunt_body_ref *body = &world->bodies.all[i];
        brunt_body_ops *ops = &counted[body->mpm ? 0 : 1];
        ops->block_count = count_blocks, body->ops = ops;
    }
    int blocks = 0;
    for (int32_t b = 0; b < brunt_state_count(world); b++) blocks += brunt_state_info(world, b).name[0] != 0;
    ck_assert_int_eq(blocks, brunt_state_count(world));
    ck_assert_int_le(asked, 2 * (int64_t)world->bodies.count);
    for (int i = 0; i < world->bodies.count; i++)
        world->bodies.all[i].ops = world->bodies.all[i].mpm ? &brunt_points_ops : &brunt_mesh_ops;
}

static void cost_of(int count, int64_t cost[STAGES]) {
    char *text = text_of(count), csv[] = "/tmp/brunt_names_XXXXXX";
    brunt_scene scene;
    brunt_error error;
    comparisons = 0;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
    ck_assert_int_eq(scene.world.body_count, count);
    take(&cost[READ]);
    brunt_world *world = brunt_world_create(&scene.world, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    take(&cost[MADE]);
    brunt_history *history = brunt_history_create(world, &scene, &error);
    ck_assert_ptr_nonnull(history);
    take(&cost[LISTED]);
    close(mkstemp(csv));
    ck_assert_int_eq(brunt_history_open_csv(history, csv, &error), BRUNT_OK);
    for (int k = 0; k < 2; k++) ck_assert_int_eq(brunt_history_sample(history, world, &error), BRUNT_OK);
    take(&cost[SAMPLED]);
    char h5[sizeof csv + 8];
    snprintf(h5, sizeof h5, "%s.h5", csv);
    opened = 0;
    ck_assert_int_eq(brunt_history_write(history, h5, &error), BRUNT_OK);
    ck_assert_int_eq(opened, 0); // columns are filled where they are made
    unlink(h5);
    comparisons = 0;
    ck_assert_int_eq(brunt_measures_fetch(scene.measures, scene.measure_count, history, &error), BRUNT_OK);
    for (int m = 0; m < scene.measure_count; m++) {
        const double *values;
        const int status = brunt_history_read(history, scene.measures[m].column, &values, &error);
        ck_assert_int_eq(status, strstr(scene.measures[m].column, "contact") ? BRUNT_BAD_INPUT : BRUNT_OK);
    }
    take(&cost[FETCHED]);
    look_at_state(world);
    take(&cost[STATED]);
    ck_assert_uint_ne(brunt_checkpoint_identity(text, 0), brunt_checkpoint_identity("brunt: 1\n", 0));
    take(&cost[IDENTIFIED]);
    for (int i = 0; i < count; i++) ck_assert_int_eq(brunt_find_body(world, scene.world.bodies[i].name), i);
    ck_assert_int_eq(brunt_find_body(world, "b"), BRUNT_NONE);
    take(&cost[FOUND]);
    unlink(csv);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    free(text);
}

START_TEST(comparisons_grow_with_the_bodies) {
    int64_t few[STAGES], many[STAGES];
    cost_of(250, few);
    cost_of(1000, many);
    for (int s = 0; s < STAGES; s++) {
        printf("%-20s %10lld %10lld\n", stages[s], (long long)few[s], (long long)many[s]);
        ck_assert_msg(many[s] <= 5 * few[s] + 1000, "%s: 250 bodies %lld, 1000 bodies %lld", stages[s],
                      (long long)few[s], (long long)many[s]);
    }
}
END_TEST

// Values have no number that a file must not reach; only aliases must not make more of them than it has bytes for.
START_TEST(ten_thousand_bodies_are_read) {
    char *text = text_of(10000);
    brunt_scene scene;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
    ck_assert_int_eq(scene.world.body_count, 10000);
    ck_assert_int_eq(scene.measure_count, 30000);
    brunt_scene_free(&scene);
    free(text);
}
END_TEST

// Comparisons of names that reading bodies takes of which the second half have the velocities of the first, by aliases
// or typed.
static int64_t bodies_cost(int count, bool aliases) {
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fputs("brunt: 1\ndimension: 2\ntime: {end: 1 ms}\n"
          "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\nbodies:\n",
          out);
    for (int i = 0; i < count; i++) {
        fprintf(out, "  b%05d: {method: fem, material: rubber, size: 1, shape: {box: {min: [%d, 0], max: [%d, 1]}}, ",
                i, 2 * i, 2 * i + 1);
        if (!aliases)
            fputs("velocity: [0, 0]}\n", out);
        else
            fprintf(out, i < count / 2 ? "velocity: &v%05d [0, 0]}\n" : "velocity: *v%05d}\n", i % (count / 2));
    }
    fclose(out);
    brunt_scene scene;
    comparisons = 0;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
    brunt_scene_free(&scene);
    free(text);
    return comparisons;
}

START_TEST(comparisons_grow_with_the_anchors) {
    const int64_t few = bodies_cost(250, true) - bodies_cost(250, false),
                  many = bodies_cost(1000, true) - bodies_cost(1000, false);
    ck_assert_msg(many <= 5 * few + 1000, "250 anchors %lld, 1000 anchors %lld", (long long)few, (long long)many);
}
END_TEST

// Comparisons of names that reading takes of bodies of which each is named with the next by a pair of its own: meshes,
// or points of implicit steps.
static int64_t pairs_cost(int count, bool points) {
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fprintf(out,
            "brunt: 1\ndimension: 2\ntime: {end: 1 ms, step: 1 ms, scheme: %s}\n%s"
            "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\nbodies:\n",
            points ? "implicit" : "explicit", points ? "grid: {cell: 1 m}\n" : "");
    for (int i = 0; i < count; i++)
        fprintf(out, "  b%05d: {method: %s, material: rubber, shape: {box: {min: [%d, 0], max: [%d, 1]}}}\n", i,
                points ? "mpm" : "fem, size: 1 m", 2 * i, 2 * i + 1);
    fprintf(out, "contact:\n  method: none\n  pairs:\n");
    for (int i = 0; i + 1 < count; i++)
        fprintf(out, "    - {between: [b%05d, b%05d], method: %s}\n", i + 1, i, points ? "tied" : "augury");
    fclose(out);
    brunt_scene scene;
    comparisons = 0;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
    const int64_t cost = comparisons;
    ck_assert_int_eq(scene.world.contact.pair_count, count - 1);
    brunt_scene_free(&scene);
    free(text);
    return cost;
}

START_TEST(comparisons_grow_with_the_pairs) {
    const int64_t few = pairs_cost(100, _i), many = pairs_cost(400, _i);
    ck_assert_msg(many <= 5 * few, "100 pairs %lld, 400 pairs %lld", (long long)few, (long long)many);
}
END_TEST

#ifndef BRUNT_FLOAT
// Comparisons of names that a scene takes of which every boundary is refused, or none; its messages.
static int64_t refusals_cost(int count, bool refused, char **messages) {
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fputs("brunt: 1\ndimension: 2\ntime: {end: 1 ms, step: 1 ms, scheme: implicit}\n"
          "materials: {rubber: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\nbodies:\n",
          out);
    for (int i = 0; i < count; i++)
        fprintf(out, "  b%05d: {method: fem, material: rubber, size: 1, shape: {box: {min: [%d, 0], max: [%d, 1]}}}\n",
                i, 2 * i, 2 * i + 1);
    fputs("boundaries:\n", out);
    for (int i = 0; i < count; i++)
        fprintf(out, "  - {name: g%05d, body: b%05d, group: xmin, %s: %s}\n", i, i, refused ? "pressure" : "fix",
                refused ? "1 Pa" : "[x]");
    fclose(out);
    brunt_scene scene;
    out = open_memstream(messages, &length);
    comparisons = 0;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, out),
                     refused ? BRUNT_BAD_INPUT : BRUNT_OK);
    const int64_t cost = comparisons;
    fclose(out);
    free(text);
    brunt_scene_free(&scene);
    return cost;
}

START_TEST(comparisons_grow_with_the_mistakes) {
    char *few_messages, *messages, *none[2];
    const int64_t few = refusals_cost(250, true, &few_messages) - refusals_cost(250, false, &none[0]),
                  many = refusals_cost(1000, true, &messages) - refusals_cost(1000, false, &none[1]);
    ck_assert_msg(many <= 5 * few + 1000, "250 mistakes %lld, 1000 mistakes %lld", (long long)few, (long long)many);
    ck_assert_ptr_nonnull(strstr(messages, "many.yaml:1007:57: boundaries[0].pressure: this belongs to time.scheme"));
    ck_assert_ptr_nonnull(strstr(messages, "many.yaml:1206:57: boundaries[199].pressure"));
    ck_assert_ptr_nonnull(strstr(messages, "\n      - {name: g00199, body: b00199, group: xmin, pressure: 1 Pa}\n"));
    ck_assert_ptr_nonnull(strstr(messages, "many.yaml: and 800 more mistakes\n"));
    free(few_messages), free(messages), free(none[0]), free(none[1]);
}
END_TEST
#endif

// Comparisons of names for a folder that has a picture of each body, which brunt lists or not.
static int64_t folder_cost(int count, bool listed) {
    char path[] = "/tmp/brunt_names_XXXXXX", name[200];
    ck_assert_ptr_nonnull(mkdtemp(path));
    snprintf(name, sizeof name, "%s/vtu", path);
    ck_assert_int_eq(mkdir(name, 0777), 0);
    snprintf(name, sizeof name, "%s/brunt.files", path);
    FILE *list = fopen(name, "w");
    fputs("# What brunt wrote into this folder, and may replace or remove; anything else stays.\nvtu/\n", list);
    brunt_scene scene = {.world = brunt_world_def_default()};
    scene.world.body_count = count, scene.world.bodies = brunt_alloc((size_t)count * sizeof *scene.world.bodies);
    for (int i = 0; i < count; i++) {
        snprintf(scene.world.bodies[i].name, sizeof scene.world.bodies[i].name, "b%05d", i);
        snprintf(name, sizeof name, "%s/vtu/b%05d_000000.vtu", path, i);
        fclose(fopen(name, "w"));
        if (listed || i != count / 2) fprintf(list, "vtu/b%05d_000000.vtu\n", i);
    }
    fclose(list);
    brunt_output_folder folder = {.folder = -1, .index = -1};
    const brunt_run_options options = {.fresh = true};
    brunt_error error = {0};
    comparisons = 0;
    const int status = brunt_run_folder_open(&folder, &scene, &options, path, &error);
    const int64_t cost = comparisons;
    ck_assert_int_eq(status, listed ? BRUNT_OK : BRUNT_BAD_INPUT);
    snprintf(name, sizeof name, "vtu/b%05d_000000.vtu;", count / 2);
    ck_assert_msg(listed || strstr(error.message, name), "%s", error.message);
    brunt_output_close(&folder);
    brunt_world_def_free(&scene.world);
    for (int i = 0; i < count; i++) {
        snprintf(name, sizeof name, "%s/vtu/b%05d_000000.vtu", path, i);
        unlink(name);
    }
    snprintf(name, sizeof name, "%s/vtu", path), rmdir(name);
    snprintf(name, sizeof name, "%s/brunt.files", path), unlink(name);
    rmdir(path);
    return cost;
}

START_TEST(comparisons_grow_with_the_pictures) {
    folder_cost(20, false);
    const int64_t few = folder_cost(250, true), many = folder_cost(1000, true);
    ck_assert_msg(many <= 6 * few, "250 pictures %lld, 1000 pictures %lld", (long long)few, (long long)many);
}
END_TEST

// Arrays of all bodies, one after the other, then those of the world.
START_TEST(arrays_are_those_of_their_bodies) {
    char *text = text_of(20);
    brunt_scene scene;
    ck_assert_int_eq(brunt_scene_parse(text, strlen(text), "many.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
    brunt_world *world = brunt_world_create(&scene.world, NULL);
    ck_assert_ptr_nonnull(world);
    const int32_t count = brunt_array_count(world);
    int body = 0;
    for (int32_t a = 0; a + 1 < count; a++) {
        const brunt_array array = brunt_world_array(world, a);
        if (strncmp(array.name, scene.world.bodies[body].name, 6)) body++;
        ck_assert_int_eq(strncmp(array.name, scene.world.bodies[body].name, 6), 0);
    }
    ck_assert_int_eq(body, 19);
    const brunt_array last = brunt_world_array(world, count - 1);
    ck_assert_str_eq(last.name, "contact of surfaces");
    ck_assert_uint_eq(last.bytes > 40 * sizeof(double), true); // four nodes of ten squares
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    free(text);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("many names");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, comparisons_grow_with_the_bodies);
    tcase_add_test(all, ten_thousand_bodies_are_read);
    tcase_add_test(all, comparisons_grow_with_the_anchors);
    tcase_add_test(all, comparisons_grow_with_the_pictures);
    tcase_add_test(all, arrays_are_those_of_their_bodies);
#ifdef BRUNT_FLOAT
    tcase_add_loop_test(all, comparisons_grow_with_the_pairs, 0, 1); // implicit steps want double
#else
    tcase_add_loop_test(all, comparisons_grow_with_the_pairs, 0, 2);
    tcase_add_test(all, comparisons_grow_with_the_mistakes);
#endif
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
