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

// ------------------------------------------------------------------------------------------ nodes that have left

// Two facets of two bodies, of four nodes each.
typedef struct facets {
    brunt_contact_surface surface;
    brunt_node_to_facet f;
    facet_candidate candidate[2 * 2 * 4];
    int32_t face[2][4], body[8], first[9], of[8];
    uint8_t count[8];
} facets;

static void make_facets(facets *t) {
    *t = (facets){
        .face = {{0, 1, 2, 3}, {4, 5, 6, 7}}, .body = {0, 0, 0, 0, 1, 1, 1, 1}, .of = {0, 0, 0, 0, 1, 1, 1, 1}};
    for (int n = 0; n < 9; n++) t->first[n] = n;
    t->surface = (brunt_contact_surface){
        .node_count = 8, .face = t->face, .body = t->body, .face_first = t->first, .face_of = t->of};
    t->f.nodes.count = t->count, t->f.nodes.candidate = t->candidate;
    ck_assert_int_eq(BRUNT_NEW(t->f.touches.of, 8, "touches", NULL), BRUNT_OK);
}

// Node n is on a facet, and a second time if it is on one already.
static void put_on(facets *t, int n, int body) {
    t->candidate[8 * t->count[n]++ + n] = (facet_candidate){.face = body, .body = body};
}

static brunt_touch_energy *touch(facets *t, int n, touched what) { return &t->f.touches.of[n][what]; }

static void go_on(facets *t) {
    const brunt_contact_context m = {.surface = &t->surface, .threads = 1};
    brunt_touches_go_on(&m, &t->f);
}

// A node has left past a rim, of a facet or of an edge: those beside it that are on the body that it touched, and the
// nodes of that one on its facets, get equal shares, unless they hold something of another body.
START_TEST(goes_on_beside_and_above) {
    facets t;
    make_facets(&t);
    *touch(&t, 0, TOUCHED_FACET) = (brunt_touch_energy){.held = 6, .partner = 2};
    *touch(&t, 0, TOUCHED_EDGE) = (brunt_touch_energy){.held = 3, .partner = 2};
    *touch(&t, 0, TOUCHED_PLANE) = (brunt_touch_energy){.held = 1, .partner = -1};
    *touch(&t, 2, TOUCHED_FACET) = (brunt_touch_energy){.held = 1, .partner = 2};
    *touch(&t, 5, TOUCHED_FACET) = (brunt_touch_energy){.held = 1, .partner = 3};
    put_on(&t, 1, 1), put_on(&t, 2, 1), put_on(&t, 4, 0), put_on(&t, 5, 0);
    go_on(&t);
    static const double expected[8] = {0, 3, 4, 0, 3, 1, 0, 0};
    for (int n = 0; n < 8; n++) ck_assert_double_eq(touch(&t, n, TOUCHED_FACET)->held, expected[n]);
    ck_assert_int_eq(touch(&t, 1, TOUCHED_FACET)->partner, 2);
    ck_assert_int_eq(touch(&t, 4, TOUCHED_FACET)->partner, 1);
    ck_assert_double_eq(touch(&t, 0, TOUCHED_EDGE)->held, 0);
    ck_assert_double_eq(touch(&t, 0, TOUCHED_PLANE)->held, 1);
    ck_assert_int_eq(touch(&t, 0, TOUCHED_FACET)->claims, 0);
    go_on(&t);
    for (int n = 0; n < 8; n++) ck_assert_double_eq(touch(&t, n, TOUCHED_FACET)->held, expected[n]);
    brunt_node_touches_free(&t.f.touches);
}
END_TEST

// It stays where none touches that body; with a node that is on a facet; and with edges that cross.
START_TEST(stays_with_what_touches) {
    facets t;
    make_facets(&t);
    *touch(&t, 0, _i == 3 ? TOUCHED_EDGE : TOUCHED_FACET) = (brunt_touch_energy){.held = 6, .partner = _i ? 2 : 3};
    if (_i != 1) put_on(&t, 1, 1), put_on(&t, 4, 0);
    if (_i == 2) put_on(&t, 0, 1);
    if (_i == 3) touch(&t, 0, TOUCHED_EDGE)->met = LISTED;
    go_on(&t);
    ck_assert_double_eq(touch(&t, 0, _i == 3 ? TOUCHED_EDGE : TOUCHED_FACET)->held, 6);
    brunt_node_touches_free(&t.f.touches);
}
END_TEST

// Between two bodies a node takes of one of them: what it holds something of, or the first.
START_TEST(takes_of_one_body) {
    facets t;
    make_facets(&t);
    *touch(&t, 0, TOUCHED_FACET) = (brunt_touch_energy){.held = 6, .partner = 2};
    *touch(&t, 3, TOUCHED_FACET) = (brunt_touch_energy){.held = 4, .partner = 3};
    if (_i) *touch(&t, 1, TOUCHED_FACET) = (brunt_touch_energy){.held = 1, .partner = 3};
    put_on(&t, 1, 1), put_on(&t, 1, 1), t.candidate[8 + 1].body = 2;
    go_on(&t);
    ck_assert_double_eq(touch(&t, 1, TOUCHED_FACET)->held, _i ? 5 : 6);
    ck_assert_double_eq(touch(&t, 0, TOUCHED_FACET)->held, _i ? 6 : 0);
    ck_assert_double_eq(touch(&t, 3, TOUCHED_FACET)->held, _i ? 0 : 4);
    brunt_node_touches_free(&t.f.touches);
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
    tcase_add_test(tests, goes_on_beside_and_above);
    tcase_add_loop_test(tests, stays_with_what_touches, 0, 4);
    tcase_add_loop_test(tests, takes_of_one_body, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
