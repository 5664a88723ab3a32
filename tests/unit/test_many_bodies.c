// Scenes of thousands of bodies: what is kept of their pairs grows with the bodies, not with their pairs, and those
// that lie in each other are found among them.
#include "../support/def_world.h"
#include "base/sweep.h"
#include "contact/contact.h"
#include "world/named_pairs.h"

// Bodies of a few points and of one element, in turns, side by side and apart.
static brunt_world_def many(int count) {
    brunt_world_def def = def_begin(2, 1);
    brunt_free(def.bodies);
    def.bodies = brunt_alloc((size_t)count * sizeof *def.bodies);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    for (int i = 0; i < count; i++) {
        const double x = 2 * (i % 50), y = 2 * (i / 50);
        char name[24];
        snprintf(name, sizeof name, "b%05d", i);
        brunt_body_def *b = def_box(&def, name, XYZ(x, y), XYZ(x + 1, y + 1));
        b->method = i % 2 ? BRUNT_FEM : BRUNT_MPM;
        b->element = BRUNT_QUAD4, b->size = 1;
    }
    return def;
}

// [bytes] that a world of so many bodies takes.
static double bytes_of(int count) {
    brunt_world_def def = many(count);
    const size_t before = brunt_memory_live();
    brunt_error error;
    brunt_world *world = brunt_world_create(&def, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    ck_assert_int_eq(brunt_body_count(world), count);
    ck_assert_int_eq(brunt_pair_count(world), 1); // all meet by one method
    const double bytes = (double)(brunt_memory_live() - before);
    brunt_world_destroy(world);
    ck_assert_uint_eq(brunt_memory_live(), before);
    brunt_world_def_free(&def);
    return bytes;
}

START_TEST(memory_grows_with_the_bodies) {
    const double small = bytes_of(500), middle = bytes_of(1000), large = bytes_of(2000);
    ck_assert_msg(large - middle <= 1.1 * 2 * (middle - small), "500: %g, 1000: %g, 2000: %g bytes", small, middle,
                  large);
}
END_TEST

// Two of two thousand lie in each other: points in a mesh, a mesh in points' shape, points in points, a mesh in a mesh.
START_TEST(two_that_overlap_are_found) {
    static const int pair[][2] = {{1230, 1271}, {1271, 1230}, {1230, 1702}, {331, 1801}};
    brunt_world_def def = many(2000);
    const int a = pair[_i][0], b = pair[_i][1];
    memcpy(def.bodies[a].shape.min, def.bodies[b].shape.min, sizeof def.bodies[a].shape.min);
    memcpy(def.bodies[a].shape.max, def.bodies[b].shape.max, sizeof def.bodies[a].shape.max);
    for (int k = 0; k < 2; k++) def.bodies[a].shape.min[k] += 0.5, def.bodies[a].shape.max[k] += 0.5;
    brunt_error error;
    brunt_world *world = brunt_world_create(&def, &error);
    ck_assert_ptr_null(world);
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, def.bodies[a].name) && strstr(error.message, def.bodies[b].name), "%s",
                  error.message);
    def.contact.allow_overlap = true;
    world = brunt_world_create(&def, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

static double random_number(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 33) / 2147483648.0;
}

// Whether the method of all is that of two bodies: the last pair that names them says no other.
static bool as_all(const brunt_world_def *def, int a, int b) {
    brunt_contact_method method = def->contact.method;
    for (int q = 0; q < def->contact.pair_count; q++) {
        const brunt_pair_def *p = &def->contact.pairs[q];
        const char *one = def->bodies[a].name, *other = def->bodies[b].name;
        if ((!strcmp(p->a, one) && !strcmp(p->b, other)) || (!strcmp(p->a, other) && !strcmp(p->b, one)))
            method = p->method;
    }
    return method == def->contact.method;
}

// The first two that meet as all do, of random bodies in no order and random pairs, some of them twice, against all by
// all.
START_TEST(the_first_usual_pair_is_found) {
    enum { BODIES = 6, PAIRS = 40 };
    uint64_t seed = 5 + (uint64_t)_i;
    brunt_world_def def = many(BODIES);
    def.contact.pairs = brunt_alloc(PAIRS * sizeof *def.contact.pairs);
    for (int i = 0; i < BODIES; i++) {
        snprintf(def.bodies[i].name, sizeof def.bodies[i].name, "b%d", (5 * i + 3) % BODIES);
        def.bodies[i].method = random_number(&seed) < 0.5 ? BRUNT_FEM : BRUNT_MPM;
    }
    def.contact.pair_count = (int32_t)(PAIRS * random_number(&seed));
    for (int q = 0; q < def.contact.pair_count; q++) {
        brunt_pair_def *p = &def.contact.pairs[q];
        snprintf(p->a, sizeof p->a, "b%d", (int)((BODIES + 1) * random_number(&seed))); // one is no body
        snprintf(p->b, sizeof p->b, "b%d", (int)(BODIES * random_number(&seed)));
        p->method = random_number(&seed) < 0.3 ? BRUNT_CONTACT_AUGURY : BRUNT_CONTACT_NONE;
    }
    brunt_named_pairs named;
    ck_assert_int_eq(brunt_named_pairs_make(&named, &def, NULL), BRUNT_OK);
    for (unsigned kinds = 0; kinds < 8; kinds++) {
        int first[2] = {BRUNT_NONE, BRUNT_NONE};
        for (int a = 0; a < BODIES && first[0] < 0; a++)
            for (int b = a + 1; b < BODIES && first[0] < 0; b++) {
                const int meshes = (def.bodies[a].method != BRUNT_MPM) + (def.bodies[b].method != BRUNT_MPM);
                if (kinds >> meshes & 1 && as_all(&def, a, b)) first[0] = a, first[1] = b;
            }
        brunt_named_pair found;
        ck_assert_int_eq(brunt_first_usual_pair(&def, &named, kinds, &found, NULL), BRUNT_OK);
        ck_assert_int_eq(found.a, first[0]);
        ck_assert_int_eq(found.b, first[1]);
    }
    brunt_named_pairs_free(&named);
    brunt_world_def_free(&def);
}
END_TEST

// A membrane that meets itself by the method of all has a pair of its own beside the one of all others.
START_TEST(a_membrane_and_itself_are_not_all) {
    brunt_world_def def = def_begin(3, 0);
    brunt_free(def.bodies);
    def.bodies = brunt_alloc(20 * sizeof *def.bodies);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    for (int i = 0; i < 14; i++) {
        char name[24];
        snprintf(name, sizeof name, "b%02d", i);
        brunt_body_def *b = def_box(&def, name, XYZ(3 * i, 0, 0), XYZ(3 * i + 1, 1, 1));
        b->method = i ? BRUNT_FEM : BRUNT_MEMBRANE, b->size = 1;
        b->element = i ? BRUNT_HEX8 : BRUNT_MEMBRANE_QUAD4;
        if (!i) b->thickness = 0.01;
    }
    def.contact.pairs = brunt_alloc(sizeof *def.contact.pairs);
    def.contact.pair_count = 1;
    def.contact.pairs[0] = (brunt_pair_def){.a = "b00", .b = "b00", .method = BRUNT_CONTACT_AUGURY};
    brunt_world *world = world_take(&def);
    brunt_reaction self, all;
    ck_assert_int_eq(brunt_pair_count(world), 2);
    brunt_pair_force(world, 0, &self);
    brunt_pair_force(world, 1, &all);
    ck_assert_str_eq(self.name, "b00-b00");
    ck_assert_str_eq(all.name, "all");
    brunt_world_destroy(world);
}
END_TEST

START_TEST(pairs_are_those_of_their_kind_or_their_own) {
    const uint8_t mesh[] = {0, 1, 0, 1, 1};
    brunt_pair_map map = {.mesh = mesh, .usual = {7, 8, -1}};
    ck_assert_int_eq(brunt_pair_map_add(&map, 3, 1, 5, NULL), 0);
    ck_assert_int_eq(brunt_pair_map_add(&map, 0, 2, 4, NULL), 0);
    ck_assert_int_eq(brunt_pair_map_add(&map, 2, 0, -1, NULL), 0); // the last counts
    ck_assert_int_eq(brunt_pair_map_add(&map, 4, 4, 6, NULL), 0);
    brunt_pair_map_sort(&map);
    static const int32_t expected[5][5] = {
        {-1, 8, -1, 8, 8}, {8, -1, 8, 5, -1}, {-1, 8, -1, 8, 8}, {8, 5, 8, -1, -1}, {8, -1, 8, -1, 6}};
    for (int a = 0; a < 5; a++)
        for (int b = 0; b < 5; b++)
            ck_assert_msg(brunt_pair_of(&map, a, b) == expected[a][b], "%d, %d: %d", a, b, brunt_pair_of(&map, a, b));
    brunt_free(map.entry);
}
END_TEST

// Boxes in a plane or in space, some without end, some that only touch, against all by all.
START_TEST(a_sweep_finds_what_all_by_all_finds) {
    enum { COUNT = 120 };
    uint64_t seed = 11 + (uint64_t)_i;
    brunt_box box[COUNT];
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++) {
            const double low = k == 2 && _i % 2 ? 0 : floor(20 * random_number(&seed));
            box[i].low[k] = low, box[i].high[k] = low + floor(3 * random_number(&seed));
            if (random_number(&seed) < 0.02) box[i].low[k] = -INFINITY;
            if (random_number(&seed) < 0.02) box[i].high[k] = INFINITY;
        }
    const int first = _i < 4 ? COUNT : COUNT / 3;
    brunt_box_pair *pairs;
    int64_t count;
    ck_assert_int_eq(brunt_sweep(box, first, COUNT, &pairs, &count, NULL), BRUNT_OK);
    int64_t found = 0;
    for (int a = 0; a < first; a++)
        for (int b = a + 1; b < COUNT; b++) {
            bool apart = false;
            for (int k = 0; k < 3; k++)
                apart = apart || box[a].low[k] > box[b].high[k] || box[b].low[k] > box[a].high[k];
            if (apart) continue;
            ck_assert_int_lt(found, count);
            ck_assert_int_eq(pairs[found].a, a);
            ck_assert_int_eq(pairs[found++].b, b);
        }
    ck_assert_int_eq(found, count);
    brunt_free(pairs);
}
END_TEST

// A row along one axis, far from the origin, with the first one off it; places without end do not count.
START_TEST(the_axis_is_the_one_of_the_row) {
    brunt_spread spread = {.count = 0};
    ck_assert_int_eq(brunt_spread_axis(&spread), 0);
    const int along = _i % 3, aside = (along + 1) % 3;
    for (int i = 0; i < 100; i++) {
        double x[3] = {1e9 + 0.3, 1e9 + 0.3, 1e9 + 0.3};
        x[along] += 0.01 * (i % 2 ? i : -i); // to both sides of the first
        x[aside] -= i == 0;
        brunt_spread_add(&spread, x);
    }
    ck_assert_int_eq(brunt_spread_axis(&spread), along);
    double endless[3] = {1e9 + 0.3, 1e9 + 0.3, 1e9 + 0.3};
    endless[along] = _i < 3 ? INFINITY : -INFINITY;
    brunt_spread_add(&spread, endless);
    ck_assert_int_eq(brunt_spread_axis(&spread), along);
}
END_TEST

// [m/s] by which cubes go up after they met a bar on which they stand in a row along an axis.
static void bounce(int along, bool mesh, double up[3]) {
    brunt_world_def def = def_begin(3, 0.5);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = mesh ? BRUNT_CONTACT_AUGURY : BRUNT_CONTACT_MULTI_VELOCITY;
    const int above = (along + 1) % 3;
    for (int k = 0; k < 4; k++) {
        double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
        if (k == 3) high[along] = 6;
        if (k < 3) low[above] = mesh ? 1.001 : 1, high[above] = low[above] + 1;
        if (k < 3) low[along] = 2.25 * k + 0.25, high[along] = low[along] + 1;
        const char *const names[] = {"b", "c", "d", "a"};
        brunt_body_def *b = def_box(&def, names[k], low, high);
        if (mesh) b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = 0.5;
        b->velocity[above] = k == 3 ? 0 : -1;
    }
    brunt_world *world = world_take(&def);
    world_until(world, 0.12);
    for (int k = 0; k < 3; k++) {
        brunt_body_sums sums;
        brunt_body_totals(world, k + 1, &sums);
        up[k] = sums.momentum[above] / sums.mass;
    }
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}

START_TEST(a_row_meets_along_any_axis) {
    const bool mesh = _i % 2;
    double first[3], turned[3];
    bounce(0, mesh, first), bounce(1 + _i / 2, mesh, turned);
    printf("%s go up by %.3f, %.3f, %.3f m/s\n", mesh ? "meshes" : "points", first[0], first[1], first[2]);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_gt(first[k], -0.2);
        ck_assert_double_eq_tol(turned[k], first[k], TOLERANCE(1e-9, 1e-3));
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("many bodies");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, memory_grows_with_the_bodies);
    tcase_add_loop_test(all, two_that_overlap_are_found, 0, 4);
    tcase_add_loop_test(all, the_first_usual_pair_is_found, 0, 60);
    tcase_add_test(all, a_membrane_and_itself_are_not_all);
    tcase_add_test(all, pairs_are_those_of_their_kind_or_their_own);
    tcase_add_loop_test(all, a_sweep_finds_what_all_by_all_finds, 0, 8);
    tcase_add_loop_test(all, the_axis_is_the_one_of_the_row, 0, 6);
    tcase_add_loop_test(all, a_row_meets_along_any_axis, 0, 4);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
