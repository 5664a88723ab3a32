// An effect that a scene does not ask for costs nothing: instructions of a step, counted by valgrind (cost.sh,
// cost_scene.c).
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/support/suite.h"

typedef struct cost {
    char dress[16];
    double instructions;
} cost;

static cost costs[32];
static int cost_count;

static double of(const char *dress) {
    for (int i = 0; i < cost_count; i++)
        if (!strcmp(costs[i].dress, dress)) return costs[i].instructions;
    ck_abort_msg("cost.sh says nothing of '%s'", dress);
    return 0;
}

START_TEST(effects_that_are_off_cost_nothing) {
    char folder[] = "/tmp/brunt_cost_XXXXXX", command[256];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(command, sizeof command, "sh tests/support/cost.sh %s", folder);
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    cost c;
    while (cost_count < 32 && fscanf(pipe, "%15s %lf", c.dress, &c.instructions) == 2) {
        printf("  %-8s %.0f instructions a step\n", c.dress, c.instructions);
        costs[cost_count++] = c;
    }
    int status = pclose(pipe);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
    ck_assert_int_eq(status, 0);

    double plain = of("plain");
    ck_assert_double_gt(plain, 1e6); // 4096 particles
    // Contact and friction for a body that is alone; an equation of state's, viscosity's, heat's, FLIP's and a gravity
    // ramp's numbers without the effects, and a material of no body.
    ck_assert_double_le(of("contact") / plain, 1.005);
    ck_assert_double_ge(of("contact") / plain, 0.995);
    ck_assert_double_le(of("options") / plain, 1.005);
    ck_assert_double_ge(of("options") / plain, 0.995);
    // A wall out of reach is asked about once a block.
    ck_assert_double_le(of("wall") / plain, 1.005);
    // Bodies that are too far away to meet: points, and points and a mesh.
    ck_assert_double_le(of("far") / of("apart"), 1.005);
    ck_assert_double_le(of("hex8_mixed_far") / of("hex8_mixed"), 1.005);
    // Of meshes, whose step is a seventh of that of points: where nothing is near only speeds are looked at.
    ck_assert_double_le(of("hex8_wall") / of("hex8"), 1.005);
    ck_assert_double_le(of("hex8_far") / of("hex8_apart"), 1.005);
    // An erosion limit that is never reached: nine numbers a point.
    ck_assert_double_le(of("erode") / plain, 1.006);
    ck_assert_double_le(of("hex8_erode") / of("hex8"), 1.01);
    // A coefficient of 0: no dampers of hourglass modes.
    ck_assert_double_le(of("hex8_soft") / of("hex8"), 1.002);
    ck_assert_double_le(of("hex8_inviscid") / of("hex8"), 1.002);
    ck_assert_double_ge(of("hex8_viscous") / of("hex8"), 1.1);
    // What touches give back costs a twentieth of a step at most where meshes meet (0.5 %), and nothing where none do.
    // Springs that stop points a fifth at most (they need fewer sweeps: 0.80), and nothing away from what they meet.
    ck_assert_double_le(of("hex8_met") / of("hex8_met_lossy"), 1.05);
    ck_assert_double_ge(of("hex8_met") / of("hex8_far"), 1.1);
    ck_assert_double_le(of("hex8_far") / of("hex8_far_lossy"), 1.001);
    ck_assert_double_le(of("floor_spring") / of("floor_hard"), 1.2);
    ck_assert_double_ge(of("floor_spring") / of("wall"), 1.1);
    ck_assert_double_le(of("wall_spring") / of("wall"), 1.001);
    // What is on is seen: or else the counts would show nothing.
    ck_assert_double_ge(of("gravity") / plain, 1.005);
    ck_assert_double_ge(of("plastic") / plain, 1.01);
    ck_assert_double_ge(of("met") / of("two"), 1.01);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("cost");
    TCase *tests = tcase_create("cost");
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, effects_that_are_off_cost_nothing);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
