// The order of material points (mpm/sort.h): by block and bin, those of a bin as they came, whatever part of them is
// moved; beside a sort of all by comparison, with points that stay, go a little, go far, and leave.
#include "mpm/sort.h"
#include "base/simd.h"
#include "tests/support/def_world.h"
#include "tests/support/numbers.h"
#include "world/world.h"

typedef struct form {
    int dim;
    brunt_kernel kernel;
    int threads;
    double edge[3];
} form;
static const form forms[] = {{2, BRUNT_QUADRATIC, 1, {3.3, 2.1}},      {3, BRUNT_QUADRATIC, 1, {1.7, 1.3, 0.9}},
                             {3, BRUNT_QUADRATIC, 2, {1.7, 1.3, 0.9}}, {3, BRUNT_CUBIC, 3, {1.7, 1.3, 0.9}},
                             {2, BRUNT_LINEAR, 2, {3.3, 2.1}},         {3, BRUNT_QUADRATIC, 2, {0.17, 0.13, 0.09}}};
enum { FORMS = sizeof forms / sizeof forms[0] };
static const double h = 0.1;

// What a particle is to have, known from its id; its place is kept apart.
static real mark(int64_t id, int k) { return (real)(1 + (double)id + 0.001 * k); }

typedef struct entry {
    uint64_t block;
    int bin;
    int64_t rank, id; // of the order before
} entry;

static int compare(const void *a, const void *b) {
    const entry *x = a, *y = b;
    if (x->block != y->block) return x->block < y->block ? -1 : 1;
    if (x->bin != y->bin) return x->bin - y->bin;
    return (x->rank > y->rank) - (x->rank < y->rank);
}

// The lowest node that a particle's kernel reaches, along an axis.
static int32_t base(const brunt_grid *grid, double x, int a) {
    return (int32_t)floor((double)(((real)x - (real)grid->origin[a]) * grid->inv_h) - 0.5 * (grid->order - 1));
}

static entry entry_of(const brunt_grid *grid, real *const *x, int64_t slot) {
    const int side = grid->dim == 3 ? 4 : 8;
    int32_t block[3] = {0};
    entry e = {0};
    for (int a = 0; a < grid->dim; a++) {
        const int32_t b = base(grid, (double)x[a][slot], a), cell = ((b % side) + side) % side;
        block[a] = (b - cell) / side;
        e.bin = e.bin * side + cell;
    }
    e.block = brunt_key(block);
    return e;
}

// All as they are to be, in the order that they have before the sort. How many.
static int64_t list_entries(brunt_body *body, entry *list) {
    const brunt_particles *p = &body->particles;
    int64_t n = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        list[n] = entry_of(&body->grid, brunt_kernel_position(p), s);
        list[n].rank = n, list[n].id = p->id[s], n++;
    }
    qsort(list, (size_t)n, sizeof *list, compare);
    return n;
}

// `moved`: all were since they were marked, so that padding is, too.
static void check_order(brunt_body *body, const entry *list, int64_t count, real (*place)[3], bool moved) {
    brunt_particles *p = &body->particles;
    const brunt_grid *grid = &body->grid;
    const real *mass = brunt_field(p, BRUNT_FIELD_mass)[0], *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    const real *F = brunt_field(p, BRUNT_FIELD_deformation_gradient)[0];
    const int first = p->field[BRUNT_FIELD_position].first;
    int64_t n = 0, next = 0;
    brunt_body_validate(body);
    for (int32_t b = 0; b < grid->block_count; b++) {
        const brunt_block *block = &grid->blocks[b];
        ck_assert_int_eq(block->first, next);
        ck_assert_int_ge(block->room, block->count);
        next += block->room;
        for (int32_t i = 0; i < block->count; i++, n++) {
            const int64_t s = block->first + i;
            ck_assert(list[n].block == grid->block_key[b] && list[n].bin == p->bin[s] && list[n].id == p->id[s]);
            for (int k = 0; k < p->scalar_count; k++) {
                const bool at = k >= first && k < first + p->dim;
                ck_assert(p->scalar[k][s] == (at ? place[p->id[s]][k - first] : mark(p->id[s], k)));
            }
        }
        for (int32_t i = block->count; i < block->room; i++)
            ck_assert(p->id[block->first + i] < 0 && mass[block->first + i] == 0 && volume[block->first + i] == 0);
        const int64_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
        for (int64_t s = block->first + block->count; s < block->first + padded; s++) {
            ck_assert_int_eq(p->bin[s], p->bin[block->first + block->count - 1]);
            ck_assert(!moved || F[s] == F[block->first + block->count - 1]);
        }
    }
    ck_assert_int_eq(next, p->slots);
    ck_assert_int_eq(n, count);
}

// Steps in which some particles are elsewhere about where they began, a share of them, so far; in some all go a way, in
// some a few for good.
static void displace(brunt_body *body, int step, uint64_t *state, real (*home)[3], real (*place)[3]) {
    static const double share[] = {0, 0.01, 1, 0.3, 0.02, 0.002, 0.1, 0.1}, far[] = {0, 0.5, 0.02, 0.4, 6, 1, 0.3, 0.3};
    brunt_particles *p = &body->particles;
    real **x = brunt_field(p, BRUNT_FIELD_position);
    for (int64_t s = 0; s < p->slots; s++) {
        const int64_t id = p->id[s];
        if (id < 0) continue;
        const bool goes = draw_between(state, 0, 1) < share[step % 8];
        for (int a = 0; a < p->dim; a++) {
            if (step % 24 == 23 && a == 0) home[id][a] += (real)(0.5 * h), x[a][s] += (real)(0.5 * h);
            if (goes) x[a][s] = home[id][a] + (real)(h * far[step % 8] * draw_between(state, -1, 1));
            place[id][a] = x[a][s];
        }
        if (step % 11 == 9 && draw_between(state, 0, 1) < 0.01 && p->count > 8) {
            p->id[s] = -1, p->holes = true, p->count--;
            brunt_field(p, BRUNT_FIELD_mass)[0][s] = brunt_field(p, BRUNT_FIELD_reference_volume)[0][s] = 0;
        }
    }
}

START_TEST(order_is_that_of_a_sort_of_all) {
    const form is = forms[_i];
    uint64_t state = 5 + (uint64_t)_i;
    brunt_world_def def = def_begin(is.dim, h);
    def.kernel = is.kernel, def.threads = is.threads;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "block", XYZ(0.03, 0.12, -0.11),
            XYZ(0.03 + is.edge[0], 0.12 + is.edge[1], is.dim == 3 ? is.edge[2] : 0))
        ->spacing = 0.5 * h;
    brunt_world *world = world_take(&def);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_particles *p = &body->particles;
    real(*place)[3] = brunt_alloc((size_t)p->made * sizeof *place),
    (*home)[3] = brunt_alloc((size_t)p->made * sizeof *home);
    entry *list = brunt_alloc((size_t)p->made * sizeof *list);
    const int first = p->field[BRUNT_FIELD_position].first;
    for (int64_t s = 0; s < p->slots; s++)
        for (int k = 0; k < p->scalar_count; k++)
            if (p->id[s] < 0)
                continue;
            else if (k < first || k >= first + p->dim)
                p->scalar[k][s] = mark(p->id[s], k);
            else
                home[p->id[s]][k - first] = p->scalar[k][s];
    int64_t rested = 0, whole = 0, parts = 0;
    const int64_t start = p->moves;
    for (int step = 0; step < 200; step++) {
        brunt_error error;
        displace(body, step, &state, home, place);
        const int64_t count = list_entries(body, list), moves = p->moves, moved = p->moved;
        ck_assert_msg(!brunt_sort(&body->grid, p, is.threads, NULL, &error), "%s", error.message);
        check_order(body, list, count, place, p->moves > start);
        whole += p->moves > moves, parts += p->moved > moved, rested += p->moves == moves && p->moved == moved;
    }
    printf("  %lld points: all moved in %lld sorts, %.3g a sort in %lld, none in %lld\n", (long long)p->count,
           (long long)whole, parts ? (double)p->moved / (double)parts : 0, (long long)parts, (long long)rested);
    ck_assert_int_gt(whole, 10);
    ck_assert_int_gt(rested, 10);
    if (p->made > 1000) ck_assert_int_gt(parts, 10);
    brunt_free(place), brunt_free(home), brunt_free(list);
    brunt_world_destroy(world);
}
END_TEST

// Points on the borders of bins, and a few last digits to either side of them, near the origin and far from it; cells
// that are a power of 2, so that nothing of that is rounded.
START_TEST(borders_are_of_the_upper_bin) {
    static const double far[] = {0, -3, 500}, cell = 0.125;
    enum { NUDGES = 4 };
    brunt_world_def def = def_begin(2 + _i % 2, cell);
    const double at = far[_i / 2];
    def.kernel = _i % 4 < 2 ? BRUNT_QUADRATIC : BRUNT_CUBIC;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "block", XYZ(at, at, def.dimension == 3 ? at : 0),
            XYZ(at + 1.1, at + 0.9, def.dimension == 3 ? at + 0.7 : 0))
        ->spacing = 0.5 * cell;
    brunt_world *world = world_take(&def);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_particles *p = &body->particles;
    real **x = brunt_field(p, BRUNT_FIELD_position);
    uint64_t state = 3;
    for (int step = 0; step < 40; step++) {
        for (int64_t s = 0; s < p->slots; s++)
            for (int a = 0; a < p->dim && p->id[s] >= 0; a++) {
                const int nudge = (int)draw_between(&state, -NUDGES, NUDGES + 1);
                real to = (real)(0.5 * cell * round((double)x[a][s] / (0.5 * cell)));
                for (int k = 0; k < abs(nudge); k++)
                    to = (real)(sizeof(real) == 4 ? (double)nextafterf((float)to, nudge < 0 ? -1e9f : 1e9f)
                                                  : nextafter((double)to, nudge < 0 ? -1e9 : 1e9));
                x[a][s] = to;
            }
        ck_assert_int_eq(brunt_sort(&body->grid, p, 1, NULL, NULL), BRUNT_OK);
        for (int32_t b = 0; b < body->grid.block_count; b++)
            for (int32_t i = 0; i < body->grid.blocks[b].count; i++) {
                const int64_t s = body->grid.blocks[b].first + i;
                const entry e = entry_of(&body->grid, x, s);
                ck_assert(e.block == body->grid.block_key[b] && e.bin == p->bin[s]);
            }
    }
    ck_assert_int_gt(p->moved + p->moves, 40);
    brunt_world_destroy(world);
}
END_TEST

// A few points that go from block to block and back move those blocks alone.
START_TEST(the_rest_stays) {
    brunt_world_def def = def_begin(3, h);
    def.threads = 2;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(2, 2, 2))->spacing = 0.5 * h;
    brunt_world *world = world_take(&def);
    brunt_particles *p = &world->bodies.mpm[0].particles;
    const brunt_grid *grid = &world->bodies.mpm[0].grid;
    real *x = brunt_field(p, BRUNT_FIELD_position)[0];
    const int64_t moves = p->moves, id = p->id[grid->blocks[grid->block_count / 2].first];
    int32_t most = 0;
    for (int32_t b = 0; b < grid->block_count; b++) most = grid->blocks[b].count > most ? grid->blocks[b].count : most;
    for (int step = 0; step < 20; step++) {
        const int64_t moved = p->moved;
        for (int64_t s = 0; s < p->slots; s++)
            if (p->id[s] == id) x[s] += (real)(step % 2 ? 4 * h : -4 * h);
        ck_assert_int_eq(brunt_sort(&world->bodies.mpm[0].grid, p, 2, NULL, NULL), BRUNT_OK);
        ck_assert_int_le(p->moved - moved, 2 * most + 1);
        ck_assert_int_gt(p->moved, moved);
    }
    ck_assert_int_eq(p->moves, moves);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("sort");
    TCase *tests = tcase_create("sort");
    tcase_add_loop_test(tests, order_is_that_of_a_sort_of_all, 0, FORMS);
    tcase_add_loop_test(tests, borders_are_of_the_upper_bin, 0, 6);
    tcase_add_test(tests, the_rest_stays);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
