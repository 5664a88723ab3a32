// Crowds: what is drawn is even or normal and of each member alone, members are where their lattice says, and a scene
// of thousands is read and made at once.
#include <math.h>

#include "base/memory.h"
#include "io/scene/crowd.h"
#include "io/scene/scene.h"
#include "tests/support/small_program.h"

// ------------------------------------------------------------------------------------------ draws

enum { MEMBERS = 100000, BINS = 100 };

// Sum of squares of what bins are off by, over what is wanted in each: BINS - 1 on the mean, of a variance twice that.
static double chi_square(const int64_t *count, int64_t all) {
    const double wanted = (double)all / BINS;
    double sum = 0;
    for (int b = 0; b < BINS; b++) sum += ((double)count[b] - wanted) * ((double)count[b] - wanted) / wanted;
    return sum;
}

static const double PI = 3.14159265358979323846;
static const double FIVE_SIGMA = 5;

START_TEST(draws_are_even) {
    const brunt_crowd crowd = {.dimension = 2, .seed = (uint64_t)_i};
    int64_t count[BINS] = {0}, pairs[BINS] = {0};
    double product = 0, before = 0;
    for (int64_t i = 0; i < MEMBERS; i++) {
        const double u = brunt_crowd_draw(&crowd, i, BRUNT_DRAWN_YOUNG, 0);
        ck_assert(u >= 0 && u < 1);
        count[(int)(BINS * u)]++;
        if (i) pairs[10 * (int)(10 * before) + (int)(10 * u)]++, product += (u - 0.5) * (before - 0.5);
        before = u;
    }
    const double off = FIVE_SIGMA * sqrt(2.0 * (BINS - 1));
    ck_assert_double_lt(fabs(chi_square(count, MEMBERS) - (BINS - 1)), off);
    ck_assert_double_lt(fabs(chi_square(pairs, MEMBERS - 1) - (BINS - 1)),
                        off); // neighbours know nothing of each other
    ck_assert_double_lt(fabs(product) * 12, FIVE_SIGMA * sqrt(MEMBERS));
}
END_TEST

// Of one member: seeds, what is drawn, and how often, are as far apart as members are.
START_TEST(draws_are_apart) {
    double product[4] = {0};
    for (uint64_t s = 0; s < MEMBERS; s++) {
        const brunt_crowd crowd = {.dimension = 2, .seed = s}, next = {.dimension = 2, .seed = s + 1};
        const double u = brunt_crowd_draw(&crowd, 7, BRUNT_DRAWN_YOUNG, 0) - 0.5;
        product[0] += u * (brunt_crowd_draw(&next, 7, BRUNT_DRAWN_YOUNG, 0) - 0.5);
        product[1] += u * (brunt_crowd_draw(&crowd, 7, BRUNT_DRAWN_RADIUS, 0) - 0.5);
        product[2] += u * (brunt_crowd_draw(&crowd, 7, BRUNT_DRAWN_YOUNG, 1) - 0.5);
        product[3] += u * (brunt_crowd_draw(&crowd, 7, BRUNT_DRAWN_RADIUS, 1) - 0.5);
    }
    for (int k = 0; k < 4; k++) ck_assert_double_lt(fabs(product[k]) * 12, FIVE_SIGMA * sqrt(MEMBERS));
}
END_TEST

// Normal between a and b: its distribution function is (F(x) - F(a)) / (F(b) - F(a)), whichever way it is drawn.
static double normal_below(double x) { return 0.5 * erfc(-x / sqrt(2)); }

START_TEST(moduli_are_normal_between) {
    static const double sd[] = {0.125e6, 1e6, 4e6, 32e6}, mean[] = {2.75e6, 0.6e6, 2.75e6, 5e6};
    const brunt_crowd crowd = {
        .dimension = 2, .seed = 11, .draws_young = true, .mean = mean[_i], .sd = sd[_i], .low = 0.5e6, .high = 5e6};
    int64_t count[BINS] = {0};
    const double first = normal_below((crowd.low - crowd.mean) / crowd.sd),
                 last = normal_below((crowd.high - crowd.mean) / crowd.sd);
    for (int64_t i = 0; i < MEMBERS; i++) {
        const double E = brunt_crowd_young(&crowd, i);
        ck_assert(E >= crowd.low && E <= crowd.high);
        const double part = (normal_below((E - crowd.mean) / crowd.sd) - first) / (last - first);
        count[(int)fmin(BINS * part, BINS - 1)]++;
    }
    ck_assert_double_lt(fabs(chi_square(count, MEMBERS) - (BINS - 1)), FIVE_SIGMA * sqrt(2.0 * (BINS - 1)));
}
END_TEST

// ------------------------------------------------------------------------------------------ places

// The published packing of 711 disks: 29 rows, 252.487 mm high.
START_TEST(hex_has_the_rows_of_the_packing) {
    const brunt_crowd crowd = {.dimension = 2, .lattice = BRUNT_LATTICE_HEX, .count = {25, 29}, .radius = 5e-3};
    double high = 0, least = INFINITY;
    ck_assert_int_eq(brunt_crowd_size(&crowd), 711);
    for (int64_t i = 0; i < 711; i++) {
        double x[3], y[3];
        brunt_crowd_centre(&crowd, i, x);
        high = fmax(high, x[1] + crowd.radius);
        ck_assert(x[0] >= 5e-3 - 1e-15 && x[0] <= 0.245 + 1e-15);
        for (int64_t k = 0; k < i; k++) {
            brunt_crowd_centre(&crowd, k, y);
            least = fmin(least, hypot(x[0] - y[0], x[1] - y[1]));
        }
    }
    ck_assert_double_eq_tol(high, 0.01 + 28 * 5e-3 * sqrt(3), 1e-15);
    ck_assert_double_eq_tol(least, 0.01, 1e-15);
}
END_TEST

// Members shifted at random stay apart and in the box; some come nearer than the lattice has them, or farther.
START_TEST(shifted_members_stay_apart) {
    const brunt_crowd crowd = {.dimension = 3,
                               .lattice = BRUNT_LATTICE_RANDOM,
                               .count = {4, 5, 6},
                               .radius = 1,
                               .spread = 0.3,
                               .gap = 0.5,
                               .seed = 3};
    const double pitch = brunt_crowd_pitch(&crowd);
    double least = INFINITY, shift = 0;
    ck_assert_double_eq_tol(pitch, 3.1, 1e-14);
    ck_assert_int_eq(brunt_crowd_size(&crowd), 120);
    for (int64_t i = 0; i < 120; i++) {
        double x[3], y[3];
        const double r = brunt_crowd_radius(&crowd, i);
        brunt_crowd_centre(&crowd, i, x);
        ck_assert(r >= 0.7 && r <= 1.3);
        for (int a = 0; a < 3; a++) ck_assert(x[a] >= r && x[a] <= pitch * crowd.count[a] - r);
        shift = fmax(shift, fabs(x[0] - pitch * (0.5 + (double)(i % 4))));
        for (int64_t k = 0; k < i; k++) {
            brunt_crowd_centre(&crowd, k, y);
            least = fmin(least, sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                                     (x[2] - y[2]) * (x[2] - y[2])) -
                                    r - brunt_crowd_radius(&crowd, k));
        }
    }
    ck_assert(least >= 0 && least < 0.3 && shift > 0.5);
}
END_TEST

// ------------------------------------------------------------------------------------------ scenes

#define HEAD                                                                                                           \
    "brunt: 1\ndimension: 2\ntime: {end: 1 ms}\n"                                                                      \
    "materials: {m: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\nbodies:\n"
#define GRAINS(COUNT, MORE)                                                                                            \
    "  grains: {method: fem, element: tri3, size: 4 mm, material: m,\n"                                                \
    "    crowd: {lattice: square, count: " COUNT ", radius: 5 mm, radius_spread: 0.1}, " MORE                          \
    "    random: {E: {normal: [2.75 MPa, 32 MPa], between: [0.5 MPa, 5 MPa]}, seed: 5}}\n"
#define FLOOR(NAME)                                                                                                    \
    "  " NAME ": {method: fem, size: 5 mm, material: m, shape: {box: {min: [0, -20 mm], max: [50 mm, -5 mm]}}}\n"

static void read_crowd(const char *text, brunt_scene *scene) {
    char *said;
    size_t size;
    FILE *messages = open_memstream(&said, &size);
    const int status = brunt_scene_parse(text, strlen(text), "f.yaml", NULL, 0, scene, messages);
    fclose(messages);
    ck_assert_msg(status == BRUNT_OK, "%s", said);
    free(said);
}

static const brunt_body_def *named(const brunt_scene *scene, const char *name) {
    for (int32_t b = 0; b < scene->world.body_count; b++)
        if (!strcmp(scene->world.bodies[b].name, name)) return &scene->world.bodies[b];
    ck_abort_msg("no body %s", name);
}

// Members are one mesh, larger or smaller, each with a modulus of its own, whatever else there is in the scene; place
// turns and shifts the lattice as a whole; a pair with the crowd is one with each.
START_TEST(members_are_of_their_number_alone) {
    static const char turned[] = "place: [{rotate: {angle: 90 deg}}, {translate: [1 m, 2 m]}], ";
    char first[2000], second[2000];
    brunt_scene a, b;
    snprintf(first, sizeof first, "%s",
             HEAD GRAINS("[4, 3]", "")
                 FLOOR("zfloor") "contact: {friction: 0.5, pairs: [{between: [zfloor, grains], friction: 0.1}]}\n");
    snprintf(second, sizeof second, "%s%s%s%s", HEAD FLOOR("a"),
             "  grains: {method: fem, element: tri3, size: 4 mm, "
             "material: m, crowd: {lattice: square, count: [4, 30], radius: 5 mm, radius_spread: 0.1}, ",
             turned, "random: {E: {normal: [2.75 MPa, 32 MPa], between: [0.5 MPa, 5 MPa]}, seed: 5}}\n");
    read_crowd(first, &a), read_crowd(second, &b);
    ck_assert_int_eq(a.world.body_count, 13);
    ck_assert_int_eq(b.world.body_count, 121);
    ck_assert_int_eq(a.world.contact.pair_count, 12);
    for (int i = 1; i <= 12; i++) {
        char name[32];
        snprintf(name, sizeof name, "grains.%d", i);
        const brunt_body_def *p = named(&a, name), *q = named(&b, name);
        const double E = a.world.materials[p->material].strength_parameters[0];
        ck_assert_double_eq(p->shape.radius, q->shape.radius);
        ck_assert_double_eq(p->size, 4e-3 * (p->shape.radius / 5e-3));
        ck_assert_double_eq(E, b.world.materials[q->material].strength_parameters[0]);
        ck_assert(E >= 0.5e6 && E <= 5e6 && fabs(p->shape.radius - 5e-3) < 0.5e-3 && p->shape.radius != 5e-3);
        const double x = 11e-3 * (0.5 + (i - 1) % 4), y = 11e-3 * (0.5 + (i - 1) / 4); // NOLINT: whole rows
        ck_assert_double_eq_tol(p->place.translation[0], x, 1e-15);
        ck_assert_double_eq_tol(p->place.translation[1], y, 1e-15);
        ck_assert_double_eq_tol(q->place.translation[0], 1 - y, 1e-14);
        ck_assert_double_eq_tol(q->place.translation[1], 2 + x, 1e-14);
        int pairs = 0;
        for (int k = 0; k < 12; k++) {
            const brunt_pair_def *pair = &a.world.contact.pairs[k];
            if (strcmp(pair->b, name) != 0) continue;
            ck_assert_str_eq(pair->a, "zfloor");
            ck_assert_double_eq(pair->friction, 0.1);
            pairs++;
        }
        ck_assert_int_eq(pairs, 1);
    }
    brunt_scene_free(&a), brunt_scene_free(&b);
}
END_TEST

// One-way contact of each member with the floor, whichever of them is the slave, in a scene and as it is written again.
START_TEST(sides_are_those_of_each_pair) {
    static const char *const between[] = {"[grains, zfloor], sides: slave", "[zfloor, grains], sides: slave",
                                          "[zfloor, grains], sides: both", "[zfloor, grains]"};
    char text[2048];
    snprintf(text, sizeof text,
             HEAD GRAINS("[4, 3]", "") FLOOR("zfloor") "contact: {method: augury, pairs: [{between: %s}]}\n",
             between[_i]);
    for (int again = 0; again < 2; again++) {
        brunt_scene scene;
        char *written;
        size_t size;
        read_crowd(text, &scene);
        const brunt_contact_def *contact = &scene.world.contact;
        ck_assert_int_eq(contact->pair_count, 12);
        for (int k = 0; k < 12; k++) {
            ck_assert_int_eq(contact->pairs[k].sides, _i < 2 ? BRUNT_SIDES_SLAVE : BRUNT_SIDES_BOTH);
            ck_assert_int_eq(strcmp(contact->pairs[k].a, "zfloor") == 0, _i > 0);
        }
        FILE *out = open_memstream(&written, &size);
        ck_assert_int_eq(brunt_scene_write(&scene, out), BRUNT_OK);
        fclose(out);
        ck_assert(strlen(written) < sizeof text);
        strcpy(text, written);
        free(written);
        brunt_scene_free(&scene);
    }
}
END_TEST

START_TEST(resolved_scene_is_the_same) {
    brunt_scene scene, again;
    char *text[2];
    size_t size;
    read_crowd(HEAD GRAINS("[4, 3]", "") FLOOR("floor"), &scene);
    FILE *out = open_memstream(&text[0], &size);
    ck_assert_int_eq(brunt_scene_write(&scene, out), BRUNT_OK);
    fclose(out);
    read_crowd(text[0], &again);
    out = open_memstream(&text[1], &size);
    ck_assert_int_eq(brunt_scene_write(&again, out), BRUNT_OK);
    fclose(out);
    ck_assert_str_eq(text[0], text[1]);
    ck_assert(strstr(text[0], "radius_spread: 0.1") && strstr(text[0], "gap: 0") && strstr(text[0], "seed: 5"));
    ck_assert_int_eq(scene.world.body_count, again.world.body_count);
    for (int32_t b = 0; b < scene.world.body_count; b++) {
        const brunt_body_def *p = &scene.world.bodies[b], *q = &again.world.bodies[b];
        ck_assert_str_eq(p->name, q->name);
        ck_assert_double_eq(p->shape.radius, q->shape.radius);
        ck_assert_double_eq(p->place.translation[0], q->place.translation[0]);
    }
    free(text[0]), free(text[1]);
    brunt_scene_free(&scene), brunt_scene_free(&again);
}
END_TEST

// [bytes] of a scene and its world.
static double bytes_of(const char *count) {
    char text[1000];
    brunt_scene scene;
    brunt_error error;
    snprintf(text, sizeof text, "%s" GRAINS("%s", ""), HEAD, count);
    const size_t before = brunt_memory_live();
    read_crowd(text, &scene);
    brunt_world *world = brunt_world_create(&scene.world, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    ck_assert_int_eq(brunt_pair_count(world), 1);
    const double bytes = (double)(brunt_memory_live() - before);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    ck_assert_uint_eq(brunt_memory_live(), before);
    return bytes;
}

START_TEST(memory_grows_with_the_members) {
    const double small = bytes_of("[25, 20]"), middle = bytes_of("[50, 20]"), large = bytes_of("[100, 20]");
    ck_assert_msg(large - middle <= 1.1 * 2 * (middle - small), "500: %g, 1000: %g, 2000: %g bytes", small, middle,
                  large);
}
END_TEST

// ------------------------------------------------------------------------------------------ the program

static const char falls[] =
    "brunt: 1\ntitle: a crowd falls\ndimension: 2\ntime: {end: 2 ms}\n"
    "materials: {m: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}\nbodies:\n"
    "  grains: {method: fem, element: tri3, size: 2 mm, material: m, velocity: [0, -1 m/s],\n"
    "    crowd: {lattice: random, count: [4, 3], radius: 5 mm, radius_spread: 0.2, gap: 1 mm},\n"
    "    random: {E: {between: [0.5 MPa, 5 MPa]}, seed: 5}}\n"
    "contact: {friction: 0.3}\n"
    "boundaries: [{name: floor, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}]\n"
    "output: {every: 1 ms, history: 0.1 ms}\n"
    "measures:\n"
    "  of_all: {history: body.grains.mass, expect: 0.942, tolerance: 0.05, unit: kg/m}\n"
    "  of_one: {history: body.grains.7.position_y, unit: m}\n"
    "  floor: {history: wall.floor.force_y, take: max, unit: N/m}\n";

// Elements of all members are in it, at their own nodes: their areas add up to those of the crowd.
static void check_picture(void) {
    const char *source = getenv("BRUNT_SOURCE");
    char facts[400], script[300];
    double area = 0, least, greatest;
    snprintf(script, sizeof script, "/usr/bin/python3 %s/tests/support/read_vtu.py", source ? source : ".");
    ck_assert_int_eq(small_shell("%s --facts one/vtu/grains_000000.vtu > facts", script), 0);
    FILE *file = fopen(small_path("facts"), "r");
    ck_assert(file && fgets(facts, sizeof facts, file));
    ck_assert_str_eq(facts, "points 204 cells 288 types 5\n");
    ck_assert_int_eq(fscanf(file, "area %lf", &area), 1);
    bool found = false;
    while (fgets(facts, sizeof facts, file))
        if (sscanf(facts, "cell member 1 %lf %lf", &least, &greatest) == 2) found = true;
    fclose(file);
    ck_assert(found && least == 1 && greatest == 12);
    double sum = 0;
    const brunt_crowd crowd = {.dimension = 2, .radius = 5e-3, .spread = 0.2, .seed = 5};
    for (int i = 0; i < 12; i++) sum += brunt_crowd_radius(&crowd, i) * brunt_crowd_radius(&crowd, i);
    // Of polygons with 8 corners.
    ck_assert_double_eq_tol(area, 4 * sin(PI / 4) * sum, 1e-6 * area);
}

// One file of a picture, columns of the crowd and of the member that is asked for, and the same bits by two threads.
START_TEST(a_crowd_is_one_part_of_the_output) {
    long size;
    small_put("falls.yaml", falls);
    small_expect("check falls.yaml", 0, "grains.1 to grains.12, radius 0.004");
    small_expect("run falls.yaml -t 1 -q -o one", 0, NULL);
    small_expect("run falls.yaml -t 2 -q -o two", 0, NULL);
    ck_assert(small_exists("one/vtu/grains_000002.vtu") && !small_exists("one/vtu/grains.1_000002.vtu"));
    char *one = small_read(small_path("one/history.csv"), &size),
         *two = small_read(small_path("two/history.csv"), &size);
    ck_assert_str_eq(one, two);
    ck_assert(strstr(one, "body.grains.position_y [m]") && strstr(one, "body.grains.7.position_y [m]"));
    ck_assert(!strstr(one, "body.grains.8."));
    free(one), free(two);
    check_picture();
    char *summary = small_read(small_path("one/summary.json"), &size);
    ck_assert_msg(strstr(summary, "\"status\": \"done\"") != NULL, "%s", summary);
    free(summary);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("crowd");
    TCase *draws = tcase_create("draws"), *program = tcase_create("program");
    tcase_add_loop_test(draws, draws_are_even, 0, 4);
    tcase_add_test(draws, draws_are_apart);
    tcase_add_loop_test(draws, moduli_are_normal_between, 0, 4);
    tcase_add_test(draws, hex_has_the_rows_of_the_packing);
    tcase_add_test(draws, shifted_members_stay_apart);
    tcase_add_test(draws, members_are_of_their_number_alone);
    tcase_add_loop_test(draws, sides_are_those_of_each_pair, 0, 4);
    tcase_add_test(draws, resolved_scene_is_the_same);
    tcase_add_test(draws, memory_grows_with_the_members);
    tcase_add_checked_fixture(program, small_folder_make, small_folder_remove);
    tcase_set_timeout(program, 0);
    tcase_add_test(program, a_crowd_is_one_part_of_the_output);
    suite_add_tcase(suite, draws);
    suite_add_tcase(suite, program);
    return suite_main(suite);
}
