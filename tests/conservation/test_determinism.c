// The same bits, whatever the number of threads and however often the run was interrupted; and no memory that grows.
#include "tests/support/hard_world.h"
#include "base/parallel.h"

static brunt_material_def *copper(brunt_world_def *def) {
    static const double strength[] = {124e9, 0.34, 90e6, 292e6, 0.31, 0.025, 1.09, 1, 1356, 293.15, 383, 0.9};
    static const double eos[] = {3940, 1.49, 1.96, 0, INFINITY}, viscosity[] = {0.06, 1.5};
    brunt_material_def *m = def_material(def, "johnson-cook", 8960, 0, 0);
    memcpy(m->strength_parameters, strength, sizeof strength);
    snprintf(m->eos, sizeof m->eos, "mie-gruneisen");
    memcpy(m->eos_parameters, eos, sizeof eos);
    m->bulk_viscosity = true;
    memcpy(m->viscosity_parameters, viscosity, sizeof viscosity);
    return m;
}

// Two copper blocks run into each other, the lower into a wall with friction as well, cut by a mirror plane: every pass
// there is but gravity's. `cells`: edge of the blocks.
static brunt_world_def impact(int dimension, int cells, int threads) {
    brunt_world_def def = def_begin(dimension, 1e-3);
    double edge = 1e-3 * cells;
    def.threads = threads;
    copper(&def);
    def.contact.friction = 0.3;
    brunt_body_def *low = def_box(&def, "low", XYZ(0, 0, 0), XYZ(edge, edge, edge));
    brunt_body_def *high = def_box(&def, "high", XYZ(0, edge, 0), XYZ(edge, 2 * edge, edge));
    def_velocity(low, 0, -80, 10);
    def_velocity(high, 30, -300, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.2);
    return def;
}

static brunt_pass find_pass(const brunt_world *world, const char *name) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        if (!strcmp(brunt_world_pass(world, p).name, name)) return brunt_world_pass(world, p);
    ck_abort_msg("there is no pass %s", name);
}

// Everything the scene is there for does happen.
static void expect_eventful(brunt_world *world) {
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.plastic, 0);
    ck_assert_double_gt(e.viscosity, 0);
    ck_assert_double_gt(e.friction, 0);
    ck_assert_double_ne(world_pair(world, 0).impulse[1], 0);
    ck_assert_double_gt(world_boundary(world, 1).impulse[1], 0);
    ck_assert_double_ne(world_boundary(world, 1).impulse[0], 0);
    ck_assert_double_ne(world_boundary(world, 0).impulse[0], 0);
}

// Sizes at which seven threads are really woken: a pass needs four pieces of two blocks for each.
START_TEST(any_number_of_threads) {
    static const int threads[] = {1, 2, 3, 7};
    int dimension = 2 + _i % 2, cells = dimension == 3 ? 16 : 72;
    uint64_t hash[4] = {0};
    brunt_energy energy[4];
    brunt_momentum momentum[4];
    for (int k = 0; k < 4; k++) {
        brunt_world_def def = impact(dimension, cells, threads[k]);
        def.apic = _i / 2 ? 0.9 : 0;
        brunt_world *world = world_take(&def);
        ck_assert_int_eq(brunt_world_threads(world), threads[k]);
        world_steps(world, 12);
        expect_eventful(world);
        for (int t = 0; t < threads[k]; t++) {
            ck_assert_double_gt(find_pass(world, "p2g").thread_seconds[t], 0);
            ck_assert_double_gt(find_pass(world, "g2p").thread_seconds[t], 0);
        }
        hash[k] = brunt_world_hash(world);
        energy[k] = world_energy(world);
        momentum[k] = world_momentum(world);
        if (k == 0)
            printf("  %dD: %lld particles, hash %016llx\n", dimension, (long long)brunt_world_particles(world),
                   (unsigned long long)hash[0]);
        brunt_world_destroy(world);
        ck_assert_msg(hash[k] == hash[0], "%dD: %d threads give other bits than one", dimension, threads[k]);
        ck_assert_msg(!memcmp(&energy[k], &energy[0], sizeof energy[0]), "%d threads: another energy", threads[k]);
        ck_assert_msg(!memcmp(&momentum[k], &momentum[0], sizeof momentum[0]), "%d threads: another momentum",
                      threads[k]);
    }
}
END_TEST

// One bit of one particle, in any component, changes the hash: what the other tests rely on.
START_TEST(hash_sees_every_field) {
    brunt_world_def def = impact(3, 4, 1);
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    brunt_error error;
    uint64_t before = brunt_world_hash(world);
    int32_t count = brunt_state_count(world), judged = 0;
    unsigned char **bytes = malloc((size_t)count * sizeof *bytes);
    for (int32_t b = 0; b < count; b++) {
        bytes[b] = malloc((size_t)brunt_state_info(world, b).count * 8 + 1);
        brunt_state_get(world, b, bytes[b]);
    }
    enum { PLACES = 12 }; // spread over a block so that each of at most nine components has one
    for (int32_t k = -PLACES; k < count * PLACES; k++) {
        int32_t changed = k < 0 ? -1 : k / PLACES;
        brunt_state_block block = brunt_state_info(world, changed < 0 ? 0 : changed);
        bool particles = changed >= 0 && !strncmp(block.name, "bodies/", 7) && block.type != 'i';
        if (changed >= 0 && !particles) continue;
        size_t at = particles ? (size_t)((k % PLACES) * block.count / PLACES + block.count / 24) * sizeof(real) : 0;
        if (particles) bytes[changed][at] ^= 1;
        for (int32_t b = 0; b < count; b++)
            ck_assert_int_eq(brunt_state_set(world, b, bytes[b], brunt_state_info(world, b).count, &error), BRUNT_OK);
        ck_assert_int_eq(brunt_state_done(world, &error), BRUNT_OK);
        if (particles)
            ck_assert_msg(brunt_world_hash(world) != before, "%s is not in the hash", block.name);
        else
            ck_assert_msg(brunt_world_hash(world) == before, "the state does not come back");
        if (particles) bytes[changed][at] ^= 1, judged++;
    }
    ck_assert_int_ge(judged, 2 * 12 * PLACES);
    for (int32_t b = 0; b < count; b++) free(bytes[b]);
    free(bytes);
    brunt_world_destroy(world);
}
END_TEST

// Stopped twice on the way, once into a world that had gone another way, and once with more threads.
START_TEST(restored_is_as_good_as_continuous) {
    int dimension = 2 + _i % 2, cells = dimension == 3 ? 10 : 24;
    brunt_world_def def = impact(dimension, cells, 1), more = impact(dimension, cells, 3);
    def.apic = more.apic = _i / 2 ? 0.9 : 0;
    brunt_world *whole = world_from(&def), *first = world_from(&def), *second = world_from(&def),
                *third = world_from(&more);
    world_steps(whole, 60);
    expect_eventful(whole);
    world_steps(first, 17);
    world_steps(second, 5);
    world_copy_state(first, second);
    ck_assert_uint_eq(brunt_world_hash(first), brunt_world_hash(second));
    world_steps(second, 20);
    world_copy_state(second, third);
    world_steps(third, 23);
    ck_assert_int_eq(brunt_world_steps(third), 60);
    ck_assert_double_eq(brunt_world_time(third), brunt_world_time(whole));
    ck_assert_double_eq(brunt_world_dt_min(third), brunt_world_dt_min(whole));
    ck_assert_msg(brunt_world_hash(third) == brunt_world_hash(whole), "%dD: a restored run has other bits", dimension);
    brunt_energy a = world_energy(whole), b = world_energy(third);
    brunt_momentum p = world_momentum(whole), q = world_momentum(third);
    ck_assert(memcmp(&a, &b, sizeof a) == 0);
    ck_assert(memcmp(&p, &q, sizeof p) == 0);
    for (int a_boundary = 0; a_boundary < 2; a_boundary++)
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq(world_boundary(whole, a_boundary).impulse[k],
                                world_boundary(third, a_boundary).impulse[k]);
    brunt_world *const all[] = {whole, first, second, third};
    for (int w = 0; w < 4; w++) brunt_world_destroy(all[w]);
    brunt_world_def_free(&def);
    brunt_world_def_free(&more);
}
END_TEST

// Two worlds side by side, stepped in turns, do not know of each other.
START_TEST(worlds_do_not_meet) {
    brunt_world_def def = impact(2, 24, 1), other = impact(3, 6, 2);
    brunt_world *alone = world_from(&def);
    world_steps(alone, 20);
    brunt_world *a = world_from(&def), *b = world_from(&other);
    for (int s = 0; s < 20; s++) {
        world_steps(a, 1);
        world_steps(b, 1);
    }
    ck_assert_uint_eq(brunt_world_hash(a), brunt_world_hash(alone));
    brunt_world_destroy(alone);
    brunt_world_destroy(a);
    brunt_world_destroy(b);
    brunt_world_def_free(&def);
    brunt_world_def_free(&other);
}
END_TEST

// ------------------------------------------------------------------------------------------ speed

// A soft block that comes down much faster than its waves run, by nearly a cell a step, on a plane or a mesh; `gap`
// [cells] above it. Without a speed it is left to gravity.
typedef enum floor_kind { PLANE, MESH_AT_FACETS, MESH_AT_NODES, FLOORS } floor_kind;

static brunt_world_def dropped(floor_kind floor, double gap, double speed) {
    brunt_world_def def = def_begin(2, 1);
    def_material(&def, "neo-hookean", 1000, 1000, 0.3);
    def_velocity(def_box(&def, "block", XYZ(0.25, gap, 0), XYZ(2.25, gap + 2, 0)), 0, -speed, 0);
    def.cfl = 0.9;
    def.gravity[1] = speed > 0 ? 0 : -100;
    if (floor == PLANE) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.2);
        return def;
    }
    brunt_body_def *mesh = def_box(&def, "mesh", XYZ(-2, -1, 0), XYZ(4, 0, 0));
    mesh->method = BRUNT_FEM, mesh->element = BRUNT_QUAD4, mesh->size = 1;
    def.groups = brunt_alloc(sizeof *def.groups);
    def.groups[0] = brunt_group_def_default(), def.group_count = 1; // which holds all of its nodes
    snprintf(def.groups[0].body, sizeof def.groups[0].body, "mesh");
    snprintf(def.groups[0].group, sizeof def.groups[0].group, "surface");
    def.contact.method = floor == MESH_AT_NODES ? BRUNT_CONTACT_MULTI_VELOCITY : BRUNT_CONTACT_AUGURY;
    return def;
}

static double pushed(const brunt_world *world, floor_kind floor) {
    return fabs(floor == PLANE ? world_boundary(world, 0).impulse[1] : world_pair(world, 0).impulse[1]);
}

// Contact looks as far as the fastest particle goes. A world that is restored starts from rest, and must look no less
// far: restored before any of the steps in which the block comes down.
START_TEST(restored_knows_how_fast_bodies_are) {
    for (double gap = 40; gap < 41; gap += 0.25) {
        brunt_world_def def = dropped((floor_kind)_i, gap, 0);
        brunt_world *whole = world_from(&def);
        while (pushed(whole, (floor_kind)_i) == 0) {
            ck_assert_int_lt(brunt_world_steps(whole), 1000);
            brunt_world *restored = world_from(&def);
            world_copy_state(whole, restored);
            world_steps(whole, 1), world_steps(restored, 1);
            ck_assert_msg(brunt_world_hash(whole) == brunt_world_hash(restored),
                          "restored after step %lld, another one than that from %g cells above",
                          (long long)brunt_world_steps(whole) - 1, gap);
            brunt_world_destroy(restored);
        }
        brunt_world_destroy(whole);
        brunt_world_def_free(&def);
    }
}
END_TEST

// Nor less far in a step in which the body comes to lie in more blocks than before.
START_TEST(nothing_passes_a_plane_in_a_step_that_finds_new_blocks) {
    for (int k = 0; k < 80; k++) {
        const double at = 5 + 0.05 * k;
        brunt_world_def def = dropped(PLANE, 9.2, 50); // in one block
        def.planes[0].point[1] = at;
        brunt_world *world = world_take(&def);
        for (int n = 0; n < 100 && pushed(world, PLANE) == 0; n++) world_steps(world, 1);
        double *x = world_field(world, 0, "position"), lowest = INFINITY;
        for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) lowest = fmin(lowest, x[3 * i + 1]);
        ck_assert_msg(lowest > at, "a plane at %g m: a centre is %g m behind it", at, at - lowest);
        free(x);
        brunt_world_destroy(world);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ memory

// Two blocks pressed together and on a wall by gravity: what happens in their blocks changes, the blocks do not.
static brunt_world_def resting(int dimension) {
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.gravity[1] = -10;
    def.contact.friction = 0.3;
    def_box(&def, "low", XYZ(-1, 0.0625, -0.5), XYZ(1, 1, 0.5));
    def_box(&def, "high", XYZ(-0.5, 1, -0.25), XYZ(0.5, 1.75, 0.25));
    def_plane(&def, XYZ(0, 0.0625, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.3);
    return def;
}

static double allocations_per_step(brunt_world *world, int warm_up, int steps) {
    world_steps(world, warm_up);
    int64_t before = brunt_memory_calls();
    world_steps(world, steps);
    return (double)(brunt_memory_calls() - before) / steps;
}

START_TEST(no_allocation_in_a_step) {
    brunt_world_def def = resting(2 + _i);
    brunt_world *world = world_take(&def);
    double calls = allocations_per_step(world, 50, 200);
    printf("  at rest, %dD: %g allocations a step\n", 2 + _i, calls);
    ck_assert_double_gt(world_boundary(world, 0).impulse[1], 0);
    ck_assert_double_ne(world_pair(world, 0).impulse[1], 0);
    ck_assert_double_eq(calls, 0);
    brunt_world_destroy(world);
}
END_TEST

// The same of meshes, which meet by augury, or by barriers in implicit steps.
static brunt_world_def resting_meshes(int dimension, bool implicit) {
    brunt_world_def def = resting(dimension);
    def.cell = 0;
    def.contact.method = implicit ? BRUNT_CONTACT_BARRIER : BRUNT_CONTACT_AUGURY;
    for (int k = 0; k < 2; k++) {
        brunt_body_def *b = &def.bodies[k];
        b->method = BRUNT_FEM, b->element = dimension == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, b->size = 0.25;
        if (implicit) b->shape.min[1] += 0.005;
    }
    if (implicit) def.scheme = BRUNT_IMPLICIT, def.step = 1e-2, def.contact.distance = 0.01;
    return def;
}

START_TEST(no_allocation_in_a_step_of_meshes) {
    const bool implicit = _i / 2;
    brunt_world_def def = resting_meshes(2 + _i % 2, implicit);
    if (sizeof(real) != sizeof(double) && implicit) return;
    brunt_world *world = world_take(&def);
    double calls = allocations_per_step(world, implicit ? 50 : 400, implicit ? 50 : 200);
    printf("  meshes at rest, %dD, %s: %g allocations a step\n", 2 + _i % 2, implicit ? "implicit" : "explicit", calls);
    ck_assert_double_ne(world_pair(world, 0).impulse[1], 0);
    ck_assert_double_eq(calls, 0);
    brunt_world_destroy(world);
}
END_TEST

// A body that goes through many blocks: arrays may grow, but by half of their size each time, so seldom; and what is
// live stays within what one place needs.
START_TEST(few_allocations_on_the_move) {
    brunt_world_def def = def_begin(2 + _i, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *body = def_box(&def, "body", XYZ(-1, -0.5, -0.5), XYZ(1, 0.5, 0.5));
    def_velocity(body, 30, 21, 13);
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    size_t live = brunt_memory_live();
    double calls = allocations_per_step(world, 0, 400);
    printf("  on the move, %dD: %g allocations a step, live memory %.3f times what it was\n", 2 + _i, calls,
           (double)brunt_memory_live() / (double)live);
    ck_assert_double_le(calls, 0.1);
    ck_assert_double_le((double)brunt_memory_live(), 1.6 * (double)live);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(nothing_is_left) {
    size_t live = brunt_memory_live();
    brunt_world_def def = impact(2 + _i, 8, 3);
    brunt_world *world = world_take(&def);
    ck_assert_uint_gt(brunt_memory_live(), live);
    world_steps(world, 10);
    brunt_world_destroy(world);
    ck_assert_uint_eq(brunt_memory_live(), live);
    // Nor by a world that could not be made, or that failed on the way.
    def = impact(2 + _i, 8, 1);
    def.bodies[1].place = brunt_placement_translate(def.bodies[1].place, XYZ(0, -2e-3, 0));
    brunt_error error = {0};
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    brunt_world_def_free(&def);
    ck_assert_uint_eq(brunt_memory_live(), live);
    def = impact(2 + _i, 8, 1);
    def.step = 1e-3; // far above the stable one
    const size_t defined = brunt_memory_live();
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_uint_eq(brunt_memory_live(), defined);
    def.step = 0, def.least_step = 1e-3;
    world = world_take(&def);
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    brunt_world_destroy(world);
    ck_assert_uint_eq(brunt_memory_live(), live);
}
END_TEST

int main(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    Suite *suite = suite_create("determinism");
    TCase *bits = tcase_create("bits"), *memory = tcase_create("memory");
    tcase_set_timeout(bits, 0);
    tcase_set_timeout(memory, 0);
    suite_add_tcase(suite, bits);
    suite_add_tcase(suite, memory);
    tcase_add_loop_test(bits, any_number_of_threads, 0, 4);
    tcase_add_test(bits, hash_sees_every_field);
    tcase_add_loop_test(bits, restored_is_as_good_as_continuous, 0, 4);
    tcase_add_test(bits, worlds_do_not_meet);
    tcase_add_loop_test(bits, restored_knows_how_fast_bodies_are, 0, FLOORS);
    tcase_add_test(bits, nothing_passes_a_plane_in_a_step_that_finds_new_blocks);
    tcase_add_loop_test(memory, no_allocation_in_a_step, 0, 2);
    tcase_add_loop_test(memory, no_allocation_in_a_step_of_meshes, 0, 4);
    tcase_add_loop_test(memory, few_allocations_on_the_move, 0, 2);
    tcase_add_loop_test(memory, nothing_is_left, 0, 2);
    return suite_main(suite);
}
