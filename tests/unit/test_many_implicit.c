// Implicit steps of hundreds of bodies: those that are near each other are pairs, and no others; more bodies than a
// byte counts; bodies of points that are tied, all, some, and all but some.
#include "contact/barrier/barrier.h"
#include "contact/contact.h"
#include "scheme/implicit.h"
#include "tests/support/implicit_world.h"
#include "tests/support/numbers.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

enum { SIDE = 18, COUNT = SIDE * SIDE };

// Bodies in rows, `pitch` apart, of one element or of points; the name of each as the world orders them.
static brunt_world_def rows_of(int side, double pitch, brunt_method method) {
    brunt_world_def def = def_begin(2, 0.5);
    brunt_free(def.bodies);
    def.bodies = brunt_alloc((size_t)(side * side) * sizeof *def.bodies);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int i = 0; i < side * side; i++) {
        const double x = pitch * (i % side), y = pitch * (i / side);
        char name[24];
        snprintf(name, sizeof name, "b%05d", i);
        brunt_body_def *b = def_box(&def, name, XYZ(x, y), XYZ(x + 1, y + 1));
        b->method = method;
        b->element = BRUNT_QUAD4, b->size = 1;
    }
    go_implicit(&def, BRUNT_EULER, 1e-3);
    return def;
}

static struct brunt_implicit *of(const brunt_world *w) { return w->plan.implicit; }

// A square meets its eight neighbours, one of the diagonal too; all push, and nothing is gained of momentum.
START_TEST(pairs_are_those_that_are_near) {
    uint64_t hash[2];
    for (int threads = 1; threads <= 2; threads++) {
        brunt_world_def def = rows_of(SIDE, 1.01, BRUNT_FEM);
        def.threads = threads;
        def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.friction = 0.3, def.contact.distance = 0.02;
        for (int i = 0; i < COUNT; i++) def_velocity(&def.bodies[i], i % 7 - 3, i % 5 - 2, 0);
        brunt_world *world = world_take(&def);
        ck_assert_int_eq(brunt_pair_count(world), 1); // an account for all
        const double before = world_energy(world).kinetic;
        world_steps(world, 1);
        int32_t count;
        const brunt_barrier_pair *pair = brunt_barrier_pairs(of(world)->contact.barrier, &count);
        ck_assert_int_eq(count, 2 * SIDE * (SIDE - 1) + 2 * (SIDE - 1) * (SIDE - 1));
        for (int32_t p = 0; p < count; p++) {
            const int across = abs(pair[p].a % SIDE - pair[p].b % SIDE),
                      along = abs(pair[p].a / SIDE - pair[p].b / SIDE);
            ck_assert(pair[p].a < pair[p].b && across <= 1 && along <= 1);
        }
        ck_assert(brunt_barrier_least_gap(of(world)->contact.barrier) < 0.02 && before > 0);
        world_steps(world, 3);
        hash[threads - 1] = brunt_world_hash(world);
        brunt_world_destroy(world);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
}
END_TEST

// Far apart nothing is a pair.
START_TEST(there_are_none_where_nothing_is_near) {
    brunt_world_def def = rows_of(SIDE, 2, BRUNT_FEM);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.02;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    int32_t count;
    brunt_barrier_pairs(of(world)->contact.barrier, &count);
    ck_assert_int_eq(count, 0);
    brunt_world_destroy(world);
}
END_TEST

// Two that lie in each other are found among all, whichever is the first.
START_TEST(two_that_touch_are_refused) {
    static const int two[2][2] = {{100, 317}, {317, 100}};
    brunt_world_def def = rows_of(SIDE, 2, BRUNT_FEM);
    def.contact.method = BRUNT_CONTACT_BARRIER;
    const brunt_shape *to = &def.bodies[two[_i][1]].shape;
    brunt_shape *from = &def.bodies[two[_i][0]].shape;
    for (int k = 0; k < 2; k++) from->min[k] = to->min[k] + 0.5, from->max[k] = to->max[k] + 0.5;
    brunt_error error;
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "b00100") && strstr(error.message, "b00317"), "%s", error.message);
    brunt_world_def_free(&def);
}
END_TEST

// ------------------------------------------------------------------------------------------ ties

enum { TIED = 12, BODIES = TIED * TIED };

static void name_pair(brunt_world_def *def, int a, int b, brunt_contact_method method) {
    brunt_pair_def *pair = &def->contact.pairs[def->contact.pair_count++];
    *pair = (brunt_pair_def){.method = method};
    memcpy(pair->a, def->bodies[a].name, sizeof pair->a);
    memcpy(pair->b, def->bodies[b].name, sizeof pair->b);
}

// 0: some are tied; 1: all but some; 2: all but those of one body, which stays alone.
START_TEST(ties_are_those_of_all_pairs) {
    brunt_world_def def = rows_of(TIED, 4, BRUNT_MPM);
    uint64_t state = 5;
    static int method[BODIES][BODIES], root[BODIES];
    def.contact.method = _i ? BRUNT_CONTACT_TIED : BRUNT_CONTACT_NONE;
    def.contact.pairs = brunt_alloc(BODIES * sizeof *def.contact.pairs);
    for (int a = 0; a < BODIES; a++)
        for (int b = 0; b < BODIES; b++) method[a][b] = _i > 0;
    for (int q = 0; q < BODIES - 1; q++) {
        const int a = _i == 2 ? 77 : (int)(draw(&state) * BODIES),
                  b = _i == 2 ? q + (q >= 77) : (int)(draw(&state) * BODIES);
        if (a == b || (_i == 0 && q > BODIES / 2)) continue;
        name_pair(&def, a, b, _i ? BRUNT_CONTACT_NONE : BRUNT_CONTACT_TIED);
        method[a][b] = method[b][a] = !_i;
    }
    brunt_world *world = world_take(&def);
    for (int a = 0; a < BODIES; a++) root[a] = a;
    for (int pass = 0; pass < BODIES; pass++) // the lowest of all that can be reached
        for (int a = 0; a < BODIES; a++)
            for (int b = 0; b < BODIES; b++)
                if (a != b && method[a][b] && root[b] < root[a]) root[a] = root[b];
    int groups = 0;
    for (int a = 0; a < BODIES; a++) {
        ck_assert_msg(of(world)->unknowns.tie[a] == root[a], "%d: %d, expected %d", a, of(world)->unknowns.tie[a],
                      root[a]);
        groups += root[a] == a;
    }
    ck_assert_msg(_i == 1 ? groups == 1 : _i == 2 ? groups == 2 : groups > 20 && groups < 110, "%d", groups);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what meets anything

// Against all pairs, of bodies of points and meshes by chance, with pairs of their own and what is usual.
START_TEST(bodies_that_meet_are_those_of_all_pairs) {
    enum { SOME = 14, PAIRS = 5 };
    uint64_t state = 3 + (uint64_t)_i;
    uint8_t mesh[SOME];
    bool wanted[PAIRS], met[SOME];
    brunt_pair_map map = {.mesh = _i % 4 ? mesh : NULL};
    const int kinds = 1 + _i % 3;
    for (int b = 0; b < SOME; b++) mesh[b] = (kinds & 1 && draw(&state) < 0.5) || kinds == 2;
    for (int p = 0; p < PAIRS; p++) wanted[p] = draw(&state) < 0.3;
    for (int k = 0; k < 3; k++) map.usual[k] = (int)(draw(&state) * (PAIRS + 1)) - 1;
    for (int q = 0; q < 5 * (_i % 7); q++)
        ck_assert_int_eq(brunt_pair_map_add(&map, (int)(draw(&state) * SOME), (int)(draw(&state) * SOME),
                                            (int)(draw(&state) * (PAIRS + 1)) - 1, NULL),
                         BRUNT_OK);
    for (int b = 1; b < SOME && _i >= 100; b++) // the first body meets none, whatever is usual
        ck_assert_int_eq(brunt_pair_map_add(&map, b, 0, -1, NULL), BRUNT_OK);
    brunt_pair_map_sort(&map);
    ck_assert_int_eq(brunt_pair_map_met(&map, SOME, wanted, met, NULL), BRUNT_OK);
    for (int a = 0; a < SOME; a++) {
        bool any = false;
        for (int b = 0; b < SOME; b++) {
            const int32_t p = brunt_pair_of(&map, a, b);
            any = any || (p >= 0 && wanted[p]);
        }
        ck_assert_msg(met[a] == any, "body %d of map %d: %d", a, _i, met[a]);
    }
    brunt_free(map.entry);
}
END_TEST

// [bytes] that a world of so many rows takes once it has made a step.
static double bytes_of(int side) {
    brunt_world_def def = rows_of(side, 1.5, BRUNT_FEM);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.02;
    def.threads = 2;
    const size_t before = brunt_memory_live();
    brunt_world *world = world_from(&def);
    world_steps(world, 1);
    const double bytes = (double)(brunt_memory_live() - before);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
    return bytes;
}

// What each keeps of the nodes of all others, were it but a bit, would be more; and rooms of its own to work in, 27 kB
// for each of two threads.
START_TEST(memory_grows_with_the_bodies) {
    const double small = bytes_of(20), middle = bytes_of(30), large = bytes_of(40);
    const double first = (middle - small) / (30 * 30 - 20 * 20), second = (large - middle) / (40 * 40 - 30 * 30);
    printf("%.0f and %.0f bytes a body\n", first, second);
    ck_assert_double_le(second, 1.05 * first);
    ck_assert_double_le(first, 90e3);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("many implicit bodies");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, memory_grows_with_the_bodies);
    tcase_add_test(all, pairs_are_those_that_are_near);
    tcase_add_test(all, there_are_none_where_nothing_is_near);
    tcase_add_loop_test(all, two_that_touch_are_refused, 0, 2);
    tcase_add_loop_test(all, ties_are_those_of_all_pairs, 0, 3);
    tcase_add_loop_test(all, bodies_that_meet_are_those_of_all_pairs, 0, 200);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
#endif
