// Bodies of points that meet on the grid, each with a velocity of its own there.
#include "tests/support/def_world.h"

static brunt_world_def two(int dimension, double E, double friction) {
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, E, 0.3);
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY, def.contact.friction = friction;
    return def;
}

// What slides is held back by the friction coefficient times what it presses with. At the rim of its face normals are
// tilted, by which it is held a little more.
START_TEST(what_slides_is_held_by_coulombs_share) {
    static const double coefficients[] = {0.05, 0.2, 0.6};
    const double friction = coefficients[_i % 3], way = _i / 3 % 2 ? -1 : 1;
    brunt_world_def def = two(2 + _i / 6, 1e5, friction);
    def_box(&def, "low", XYZ(-2, -0.5, -0.5), XYZ(2, 0, 1));
    def_velocity(def_box(&def, "high", XYZ(-0.25, 0.01, 0), XYZ(0.25, 0.51, 0.5)), 4 * way, -1, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.06);
    const brunt_reaction pair = world_pair(world, 0);
    ck_assert_double_lt(pair.impulse[1], 0); // on the lower one
    ck_assert_double_eq_tol(-way * pair.impulse[0] / pair.impulse[1], friction, 0.012);
    brunt_world_destroy(world);
}
END_TEST

// A block that overlaps another by more than a spacing goes past its corner in one step: down by more than the gap, but
// sideways until it is clear. Seen along the line that is nearest now it would come too near; some other line parts the
// two before and after, so they never meet and nothing is felt. Mirrored, on its side, and with either name.
START_TEST(what_goes_round_a_corner_feels_nothing) {
    const double side = _i & 1 ? -1 : 1, step = 0.01, gap = 0.043, corner[2] = {0.205 * side, 0.05 + 0.03 * (_i / 8)};
    const bool swap = _i & 2;
    const double over = 0.17, right = (over + 0.01) / step, down = 1.5 * gap / step;
    double box[2][2][2] = {{{corner[0] - side, corner[1] - 1}, {corner[0], corner[1]}}}, v[2] = {side * right, -down};
    for (int i = 0; i < 2; i++) box[1][i][0] = box[0][i][0] + side * (1 - over), box[1][i][1] = box[0][i][1] + 1 + gap;
    brunt_world_def def = two(2, 1e-3, 0.5);
    for (int b = 0; b < 2; b++) {
        double low[3] = {0}, high[3] = {0};
        for (int a = 0; a < 2; a++) {
            const int to = swap ? 1 - a : a;
            low[to] = fmin(box[b][0][a], box[b][1][a]), high[to] = fmax(box[b][0][a], box[b][1][a]);
        }
        brunt_body_def *body = def_box(&def, b == (_i >> 2 & 1) ? "a" : "b", low, high);
        if (b) def_velocity(body, v[swap], v[!swap], 0);
    }
    def.step = step;
    brunt_world *world = world_take(&def);
    world_steps(world, 3);
    const brunt_reaction pair = world_pair(world, 0);
    for (int a = 0; a < 3; a++) ck_assert_double_eq(pair.impulse[a], 0);
    brunt_world_destroy(world);
}
END_TEST

// A thin body between two: the lower one does not feel it in the step in which the upper one first pushes it, for it is
// not there yet. Whether two that rest are apart is asked where a third one is at their node.
START_TEST(what_is_pushed_is_not_felt_before_it_is_there) {
    const double gap = 0.125; // nodes are in the middle of the thin one, where normals are those of the faces
    brunt_world_def def = two(2 + _i % 2, 1e4, 0);
    const int up = _i / 2; // along x or y
    double low[3][3] = {{0}}, high[3][3];
    for (int b = 0; b < 3; b++)
        for (int a = 0; a < 3; a++) high[b][a] = a == up ? 1 : 8;
    low[1][up] = 1 + gap, high[1][up] = low[1][up] + 0.25;
    low[2][up] = high[1][up], high[2][up] = low[2][up] + 1;
    for (int b = 0; b < 3; b++) def_box(&def, (const char *[]){"a", "b", "c"}[b], low[b], high[b]);
    def.bodies[2].velocity[up] = -1;
    def.step = 0.004;
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    brunt_body_sums sums[3];
    for (int b = 0; b < 3; b++) brunt_body_totals(world, b, &sums[b]);
    ck_assert_double_lt(sums[1].velocity[up], -0.1);
    ck_assert_double_lt(fabs(sums[0].velocity[up]), 1e-4); // at the rim, where normals are tilted
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("points_meet");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, what_slides_is_held_by_coulombs_share, 0, 12);
    tcase_add_loop_test(all, what_goes_round_a_corner_feels_nothing, 0, 32);
    tcase_add_loop_test(all, what_is_pushed_is_not_felt_before_it_is_there, 0, 4);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
