// bench/scenes/moving_cone.yaml in coarse cells: grains stay inside of the cone that is lifted, or fall out below it.
#include <math.h>

#include "tests/support/def_world.h"
#include "tests/support/small_scene.h"

#define CORNERS 4

static const char *const cell_set[] = {"grid.cell=6 cm"};
static const char *const round_set[] = {
    "grid.cell=6 cm", "axisymmetric=true",
    "boundaries[1]={name: far, plane: {point: [9, 0], normal: [-1, 0]}, condition: slip}"};
static const char *const mirrored_set[] = {
    "grid.cell=6 cm", "bodies.grains.shape={polygon: {points: [[0, 0], [-0.15, 0], [-0.495, 0.6], [0, 0.6]]}}",
    "boundaries[1]={name: middle, plane: {point: [0, 0], normal: [-1, 0]}, condition: symmetry}",
    ("boundaries[2]={name: cone, line: {closed: true, points: [[-0.15, 0], [-0.25, 0.01], [-0.665, 0.72], [-0.565, "
     "0.72]]}, condition: separate, displacement: [0, 1.2 m], table: [[0 s, 0], [6 s, 1]]}")};
static const char *const implicit_set[] = {"grid.cell=6 cm", "time={scheme: implicit, end: 6 s, step: 4 ms}"};

static const double corner[CORNERS][2] = {{0.565, 0.72}, {0.665, 0.72}, {0.25, 0.01}, {0.15, 0}}, SPEED = 0.2;

// How deep a place is in the wall of the cone that has been lifted by `up` [m]; negative: outside of it.
static double depth_in_wall(double r, double y, double up) {
    double depth = INFINITY;
    for (int k = 0; k < CORNERS; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % CORNERS], e[2] = {b[0] - a[0], b[1] - a[1]};
        depth = fmin(depth, (e[1] * (r - a[0]) - e[0] * (y - up - a[1])) / hypot(e[0], e[1]));
    }
    return depth;
}

typedef struct grains {
    double deepest;     // [m] in the wall
    int64_t kept, lost; // above the lip; of those, neither within the cone nor in its wall
} grains;

static grains look(brunt_world *world) {
    const double up = SPEED * brunt_world_time(world);
    double *x = world_field(world, 0, "position");
    grains g = {.deepest = -INFINITY};
    for (int64_t p = 0; p < brunt_body_size(world, 0, BRUNT_AT_PARTICLES); p++) {
        const double r = fabs(x[3 * p]), y = x[3 * p + 1], depth = depth_in_wall(r, y, up);
        g.deepest = fmax(g.deepest, depth);
        if (y <= up) continue;
        g.kept++;
        if (depth < 0 && r > 0.2 + (y - up) * 0.415 / 0.72) g.lost++;
    }
    free(x);
    return g;
}

static const struct variant {
    const char *name, *const *sets;
    int count;
    double deep, until; // [cells] allowed: explicit steps hold each grain, implicit ones the mean of a piece; [s]
} variants[] = {
    {"plane", cell_set, 1, 0.01, 3.5},
    {"about the axis", round_set, 3, 0.01, 6},
    {"mirrored", mirrored_set, 4, 0.01, 3.5},
#ifndef BRUNT_FLOAT
    {"implicit", implicit_set, 2, 0.3, 3.5},
#endif
};

START_TEST(holds_what_it_lets_out) {
    const struct variant *v = &variants[_i];
    char path[512];
    long size;
    snprintf(path, sizeof path, "%s/bench/scenes/moving_cone.yaml", getenv("BRUNT_SOURCE"));
    char *text = small_read(path, &size);
    brunt_scene scene = {0};
    small_scene_of(text, &scene, v->sets, v->count);
    brunt_world *world = small_world(&scene);
    const double mass = world_sums(world, 0).mass;
    const grains first = look(world);
    double deepest = -INFINITY;
    int64_t lost = 0, before = first.kept;
    for (int k = 1; k <= 14; k++) {
        world_until(world, v->until * k / 14);
        const grains g = look(world);
        deepest = fmax(deepest, g.deepest), lost += g.lost;
        ck_assert_int_le(g.kept, before);
        before = g.kept;
    }
    printf("  %s: %lld grains, %lld still in the cone after %g s, deepest in its wall %.3f cells, beside it %lld\n",
           v->name, (long long)first.kept, (long long)before, v->until, deepest / 0.06, (long long)lost);
    ck_assert_double_le(deepest, v->deep * 0.06);
    ck_assert_int_eq(lost, 0);
    ck_assert_int_eq(before, 0);
    ck_assert_double_eq(world_sums(world, 0).mass, mass);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 1e-3);
    brunt_world_destroy(world), brunt_scene_free(&scene), free(text);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("moving cone");
    TCase *tcase = tcase_create("lifted");
    tcase_add_loop_test(tcase, holds_what_it_lets_out, 0, (int)(sizeof variants / sizeof *variants));
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
