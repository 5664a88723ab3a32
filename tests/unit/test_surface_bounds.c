// Bounds and speeds of surfaces, which threads look at by pieces of bodies: whatever their number, and wherever in a
// body its farthest and its fastest node are.
#include "tests/support/fem_bodies.h"
#include "contact/surface/contact_surface.h"

enum { BODIES = 4 };

// Cells along an edge: of one piece, of several, of few nodes again.
static const int cells[BODIES] = {2, 24, 1, 16};

static void make_bodies(brunt_fem_body *body, brunt_fem_body **list) {
    for (int k = 0; k < BODIES; k++) {
        brunt_mesh mesh = box_mesh(BRUNT_HEX8, cells[k], 1, 0, false);
        body[k] = body_of(&mesh, (options){0});
        body[k].index = k;
        list[k] = &body[k];
    }
}

// The node of a body that is `which` of its surface has gone far and is fast.
static void check_extremes(brunt_contact_surface *s, int k, int32_t which, int threads) {
    const int32_t n = s->node_range[k] + which;
    real *at = brunt_fem_node(s->fem[k], s->node[n]);
    const real x = at[0], y = at[1];
    at[0] = -7, at[1] = 9, at[BRUNT_FEM_V + 2] = 5;
    brunt_surface_bounds(s, threads, NULL);
    for (int b = 0; b < BODIES; b++) {
        const double count = s->node_range[b + 1] - s->node_range[b];
        ck_assert_msg(s->low[b][0] == (b == k ? -7 : 0), "body %d, node %d of %d: %g", b, which, k, s->low[b][0]);
        ck_assert_msg(s->high[b][1] == (b == k ? 9 : 1), "body %d, node %d of %d: %g", b, which, k, s->high[b][1]);
        ck_assert(s->low[b][2] == 0 && s->high[b][2] == 1);
        ck_assert_msg(s->motion.speed[b] == (b == k ? 5 : 0), "body %d, node %d of %d: %g", b, which, k,
                      s->motion.speed[b]);
        ck_assert(s->motion.mean[b][2] == (b == k ? 5 / count : 0));
    }
    at[0] = x, at[1] = y, at[BRUNT_FEM_V + 2] = 0;
}

START_TEST(any_node_counts) {
    brunt_fem_body body[BODIES], *list[BODIES];
    brunt_contact_surface s;
    make_bodies(body, list);
    ck_assert_int_eq(brunt_surface_make(&s, list, BODIES, false, NULL), BRUNT_OK);
    ck_assert_int_gt(s.node_range[2] - s.node_range[1], 3 * 1024);
    for (int k = 0; k < BODIES; k++) {
        const int32_t count = s.node_range[k + 1] - s.node_range[k];
        for (int32_t which = 0; which<count; which += count> 97 ? 97 : 1) check_extremes(&s, k, which, 1 + _i);
        check_extremes(&s, k, count - 1, 1 + _i);
    }
    brunt_surface_free(&s);
    for (int k = 0; k < BODIES; k++) brunt_fem_free(&body[k]);
}
END_TEST

// Mean velocities are sums in the order of the nodes' pieces: the same for any number of threads.
START_TEST(means_do_not_depend_on_threads) {
    brunt_fem_body body[BODIES], *list[BODIES];
    brunt_contact_surface s;
    make_bodies(body, list);
    ck_assert_int_eq(brunt_surface_make(&s, list, BODIES, false, NULL), BRUNT_OK);
    double mean[BODIES][3];
    for (int k = 0; k < BODIES; k++)
        for (int32_t n = 0; n < body[k].node_count; n++)
            for (int a = 0; a < 3; a++) brunt_fem_node(&body[k], n)[BRUNT_FEM_V + a] = (real)uniform(-1, 1);
    brunt_surface_bounds(&s, 1, NULL);
    memcpy(mean, s.motion.mean, sizeof mean);
    brunt_surface_bounds(&s, 5, NULL);
    ck_assert_mem_eq(mean, s.motion.mean, sizeof mean);
    brunt_surface_free(&s);
    for (int k = 0; k < BODIES; k++) brunt_fem_free(&body[k]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("surface bounds");
    TCase *tcase = tcase_create("case");
    tcase_add_loop_test(tcase, any_node_counts, 0, 3);
    tcase_add_test(tcase, means_do_not_depend_on_threads);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
