// Where what touches have taken of nodes is kept from step to step (search/node_touches.h): it goes with the touch.
#include <check.h>
#include <string.h>

#include "base/array.h"
#include "contact/search/node_to_facet_parts.h"
#include "tests/support/suite.h"

enum { NODES = 6 };

typedef struct kept {
    node_touches touches;
    uint8_t constraints_of_node[NODES];
} kept;

static kept keep(void) {
    kept k = {.touches = {.edges_count = 0}};
    ck_assert_int_eq(BRUNT_NEW(k.touches.of, NODES, "touches", NULL), BRUNT_OK);
    return k;
}

static double *held(kept *k, int node, touched what) { return &k->touches.of[node][what].held; }

// A step in which some edges touch, `crossing` of them, by their nodes.
static void step(kept *k, int crossing, const touched_edges edges[]) {
    k->touches.edges_count = 0;
    for (int i = 0; i < crossing; i++)
        ck_assert_int_eq(brunt_node_touches_cross(&k->touches, &edges[i], NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_node_touches_hand_over(&k->touches, k->constraints_of_node, NULL), BRUNT_OK);
}

static double sum(kept *k) {
    double all = 0;
    for (int n = 0; n < NODES; n++)
        for (int what = 0; what < TOUCHED_COUNT; what++) all += *held(k, n, (touched)what);
    return all;
}

// A crossing slides along either edge: it is kept at the node that is nearest now, of whichever edge.
START_TEST(goes_along_an_edge) {
    kept k = keep();
    step(&k, 1, &(touched_edges){{0, 1, 2, 3}, {0, 1}});
    *held(&k, 0, TOUCHED_EDGE) = 8;
    static const touched_edges next[] = {{{1, 0, 2, 3}, {0, 1}}, {{3, 2, 0, 1}, {1, 0}}, {{0, 1, 2, 3}, {0, 1}}};
    step(&k, 1, &next[_i]);
    ck_assert_double_eq(*held(&k, next[_i].node[0], TOUCHED_EDGE), 8);
    ck_assert_double_eq(sum(&k), 8);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// Two crossings are where one was: each has half, whichever is first.
START_TEST(is_shared) {
    kept k = keep();
    *held(&k, 1, TOUCHED_EDGE) = 8, *held(&k, 1, TOUCHED_FACET) = 2;
    static const touched_edges both[2][2] = {{{{0, 1, 2, 3}, {0, 1}}, {{4, 1, 5, 3}, {0, 1}}},
                                             {{{4, 1, 5, 3}, {0, 1}}, {{0, 1, 2, 3}, {0, 1}}}};
    step(&k, 2, both[_i]);
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), 5);
    ck_assert_double_eq(*held(&k, 4, TOUCHED_EDGE), 5);
    ck_assert_double_eq(sum(&k), 10);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// What is held of other bodies stays where it is; what goes to the other body's node is of the first.
START_TEST(is_of_one_body) {
    kept k = keep();
    *held(&k, 1, TOUCHED_EDGE) = 8, k.touches.of[1][TOUCHED_EDGE].partner = _i == 0 ? 3 : 2;
    *held(&k, 2, TOUCHED_FACET) = 2, k.touches.of[2][TOUCHED_FACET].partner = _i == 0 ? 2 : 1;
    if (_i == 2) *held(&k, 0, TOUCHED_EDGE) = 1, k.touches.of[0][TOUCHED_EDGE].partner = 3;
    if (_i == 3) // several bodies are at the node
        step(&k, 2, (touched_edges[]){{{0, 1, 2, 3}, {0, 1}}, {{0, 4, 5, 3}, {0, 2}}});
    else
        step(&k, 1, &(touched_edges){{0, 1, 2, 3}, {0, 1}});
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), _i == 1 ? 10 : _i == 2);
    if (_i == 1) ck_assert_int_eq(k.touches.of[0][TOUCHED_EDGE].partner, 2);
    ck_assert_double_eq(sum(&k), 10 + (_i == 2));
    k.constraints_of_node[1] = 1, *held(&k, 1, TOUCHED_FACET) = 1, k.touches.of[1][TOUCHED_FACET].partner = 5;
    step(&k, 0, NULL);
    ck_assert_double_eq(*held(&k, 1, TOUCHED_FACET), 1);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// Another crossing is at the node where it was kept: it stays there. What is owed goes along as what is held.
START_TEST(stays_where_others_are) {
    kept k = keep();
    *held(&k, 0, TOUCHED_EDGE) = 8, *held(&k, 1, TOUCHED_EDGE) = -2;
    step(&k, 2, (touched_edges[]){{{2, 3, 0, 1}, {1, 0}}, {{0, 4, 5, 3}, {0, 1}}});
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), 8);
    ck_assert_double_eq(*held(&k, 2, TOUCHED_EDGE), -2);
    ck_assert_double_eq(sum(&k), 6);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// Edges that flatten are features no more: what they hold waits until its node is on a facet, and goes there.
START_TEST(goes_to_facets) {
    kept k = keep();
    step(&k, 1, &(touched_edges){{0, 1, 2, 3}, {0, 1}});
    *held(&k, 0, TOUCHED_EDGE) = 8, *held(&k, 0, TOUCHED_FACET) = 1;
    step(&k, 0, NULL), step(&k, 0, NULL);
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), 8);
    k.constraints_of_node[0] = 1;
    if (_i) step(&k, 1, &(touched_edges){{0, 1, 2, 3}, {0, 1}}); // or is met again
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), 8);
    step(&k, 0, NULL);
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), 0);
    ck_assert_double_eq(*held(&k, 0, TOUCHED_FACET), 9);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// A node leaves its facet over the rim, where edges cross; or stays on it.
START_TEST(goes_to_edges) {
    kept k = keep();
    *held(&k, 3, TOUCHED_FACET) = 8, *held(&k, 3, TOUCHED_PLANE) = 1;
    k.constraints_of_node[3] = (uint8_t)_i;
    step(&k, 1, &(touched_edges){{0, 1, 2, 3}, {0, 1}});
    ck_assert_double_eq(*held(&k, 0, TOUCHED_EDGE), _i ? 0 : 8);
    ck_assert_double_eq(*held(&k, 3, TOUCHED_FACET), _i ? 8 : 0);
    ck_assert_double_eq(*held(&k, 3, TOUCHED_PLANE), 1);
    brunt_node_touches_free(&k.touches);
}
END_TEST

// A node has left past a rim, and others are on its facets: those of the body that it touched, which hold nothing of
// another, get equal shares, whichever is first.
START_TEST(goes_to_what_is_on_its_facets) {
    kept k = keep();
    k.touches.of[0][TOUCHED_FACET] = (brunt_touch_energy){.held = 6, .partner = 2};
    k.touches.of[2][TOUCHED_FACET] = (brunt_touch_energy){.held = 1, .partner = 1};
    k.touches.of[4][TOUCHED_FACET] = (brunt_touch_energy){.held = 1, .partner = 3};
    static const int32_t node[] = {2, 3, 4, 5}, body[] = {1, 1, 1, 2};
    for (touch_round round = TOUCH_CLAIM; round < TOUCH_ROUNDS; round++)
        for (int i = 0; i < 4; i++) {
            const int on = _i ? 3 - i : i;
            brunt_node_takes(&k.touches, (int32_t[]){node[on], 0}, (int32_t[]){body[on], 0}, round);
        }
    static const double expected[NODES] = {0, 0, 4, 3, 1, 0};
    for (int n = 0; n < NODES; n++) ck_assert_double_eq(*held(&k, n, TOUCHED_FACET), expected[n]);
    ck_assert_int_eq(k.touches.of[3][TOUCHED_FACET].partner, 1);
    ck_assert_int_eq(k.touches.of[0][TOUCHED_FACET].claims, 0);
    brunt_node_touches_free(&k.touches);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("node_touches");
    TCase *tests = tcase_create("hand_over");
    tcase_add_loop_test(tests, goes_along_an_edge, 0, 3);
    tcase_add_loop_test(tests, is_shared, 0, 2);
    tcase_add_loop_test(tests, is_of_one_body, 0, 4);
    tcase_add_test(tests, stays_where_others_are);
    tcase_add_loop_test(tests, goes_to_facets, 0, 2);
    tcase_add_loop_test(tests, goes_to_edges, 0, 2);
    tcase_add_loop_test(tests, goes_to_what_is_on_its_facets, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
