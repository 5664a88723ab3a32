// Nodes whose nearest facet is known see together, to the bit, what each sees alone: warped quadrilaterals, and places
// before, behind and beside them; which of them are known.
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "contact/search/candidates_parts.h"
#include "contact/search/node_lanes.h"
#include "tests/support/suite.h"

enum { PAIRS = 6400, NODES = 5 * PAIRS };

// Each with a facet of its own: corners 5 i to 5 i + 3, and a node beside it.
typedef struct scattered {
    brunt_contact_surface surface;
    // A row to spare, as arrays of a surface have.
    double x[NODES + 1][3], v[NODES + 1][3], old[NODES + 1][3], normal[NODES + 1][3];
    double face_centre[PAIRS + 1][3], face_normal[PAIRS + 1][3], face_area[PAIRS];
    int32_t face[PAIRS][4];
} scattered;
static scattered made;

static double number(void) { // in -1 .. 1
    static uint64_t state = 12345;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(state >> 11) / (double)(1ull << 52) - 1;
}

static void scatter_vectors(double (*of)[3], int count, double size) {
    for (int n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) of[n][a] = size * number();
}

static void make_face(scattered *p, int i) {
    static const double corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double across[2][3], n[3];
    for (int c = 0; c < 4; c++) {
        double *x = p->x[5 * i + c];
        p->face[i][c] = 5 * i + c;
        for (int a = 0; a < 3; a++) x[a] = (a < 2 ? corner[c][a] : 0) + 0.15 * number();
        for (int a = 0; a < 3; a++) p->face_centre[i][a] += 0.25 * x[a];
    }
    for (int a = 0; a < 3; a++)
        across[0][a] = p->x[5 * i + 2][a] - p->x[5 * i][a], across[1][a] = p->x[5 * i + 3][a] - p->x[5 * i + 1][a];
    for (int a = 0; a < 3; a++)
        n[a] = across[0][(a + 1) % 3] * across[1][(a + 2) % 3] - across[0][(a + 2) % 3] * across[1][(a + 1) % 3];
    const double size = sqrt(dot(n, n));
    for (int a = 0; a < 3; a++) p->face_normal[i][a] = n[a] / size;
    p->face_area[i] = 0.5 * size;
}

// Mostly over the facet and facing it, some beside it, some that face its plane's side, or away from it.
static void put_node(scattered *p, int i) {
    double *x = p->x[5 * i + 4], *normal = p->normal[5 * i + 4];
    for (int a = 0; a < 2; a++) x[a] = 0.5 + (i % 4 ? 0.5 : 0.9) * number();
    x[2] = (i % 8 ? 0.1 : 0.4) * number();
    for (int a = 0; a < 3; a++) normal[a] = (i % 3 ? 0.2 : 3) * number() - (a == 2);
    const double size = sqrt(dot(normal, normal));
    for (int a = 0; a < 3; a++) normal[a] /= size;
}

static scattered *make(void) {
    scattered *p = &made;
    memset(p, 0, sizeof *p);
    scatter_vectors(p->v, NODES, 3), scatter_vectors(p->old, NODES, 3);
    for (int i = 0; i < PAIRS; i++) make_face(p, i), put_node(p, i);
    p->surface = (brunt_contact_surface){.dim = 3,
                                         .node_count = NODES,
                                         .x = p->x,
                                         .v = p->v,
                                         .old = p->old,
                                         .normal = p->normal,
                                         .face_count = PAIRS,
                                         .face = p->face,
                                         .face_centre = p->face_centre,
                                         .face_normal = p->face_normal,
                                         .face_area = p->face_area,
                                         .mean_edge = 1};
    return p;
}

// What of lane l is as what its node sees alone.
static void compare(const scattered *p, const node_lanes *at, int l, const brunt_closest *alone) {
    const int32_t n = at->node[l], face = at->face[l];
    const double gap = dot(alone->normal, alone->d);
    const facet_candidate h = {.face = face, .triangle = alone->triangle};
    brunt_corners under;
    brunt_node_to_facet_corners(&p->surface, &h, p->x[n], &under);
    ck_assert_int_eq(at->triangle[l], alone->triangle);
    ck_assert_double_eq(at->square[l], alone->square);
    ck_assert_double_eq(at->gap[l], gap);
    for (int a = 0; a < 3; a++) ck_assert_double_eq(at->n[l][a], alone->normal[a]);
    ck_assert_int_eq(at->opposed[l], -dot(alone->normal, p->normal[n]) > OPPOSED);
    ck_assert_double_eq(at->approach[l], brunt_node_to_facet_approach(&under, at->n[l], p->v[n], p->surface.v));
    if (gap < 0)
        ck_assert_double_eq(at->came[l], brunt_node_to_facet_approach(&under, at->n[l], p->old[n], p->surface.old));
}

START_TEST(see_together_what_each_sees) {
    const double range = _i ? 0.05 : 1;
    scattered *p = make();
    int known = 0, faced = 0, missed = 0;
    for (int i = 0; i < PAIRS; i += BRUNT_DOUBLES) {
        node_lanes at = {.node = {0}};
        for (int l = 0; l < BRUNT_DOUBLES; l++) at.node[l] = 5 * (i + l) + 4, at.face[l] = i + l;
        brunt_node_lanes_look(&p->surface, range, &at);
        for (int l = 0; l < BRUNT_DOUBLES; l++) {
            const brunt_closest alone = brunt_closest_on_face(&p->surface, i + l, p->x[at.node[l]]);
            const double near = fmin(range, CLOSE);
            const bool may = alone.inside && alone.square <= near * near &&
                             -dot(p->face_normal[i + l], p->normal[at.node[l]]) > OPPOSED;
            ck_assert(may || !at.known[l]);
            missed += may && !at.known[l], known += at.known[l], faced += at.known[l] && at.opposed[l];
            if (at.known[l]) compare(p, &at, l, &alone);
        }
    }
    printf("  within %g: %d of %d known, %d of them opposed; %d are to be looked at alone\n", range, known, PAIRS,
           faced, missed);
    ck_assert_int_gt(known, PAIRS / 5);
    ck_assert_int_lt(faced, known);
    ck_assert_int_lt(missed, known / 10);
}
END_TEST

// Distances to what nodes are beside; of those over the inside of a triangle it is not told.
START_TEST(distances_to_what_is_beside) {
    scattered *p = make();
    int told = 0, beside = 0;
    for (int i = 0; i < PAIRS; i += BRUNT_DOUBLES) {
        int32_t node[BRUNT_DOUBLES], face[BRUNT_DOUBLES];
        double square[BRUNT_DOUBLES];
        for (int l = 0; l < BRUNT_DOUBLES; l++) {
            node[l] = 5 * (i + l) + 4, face[l] = i + l;
            p->x[node[l]][0] += i % 3 - 1, p->x[node[l]][1] += i / 3 % 3 - 1;
        }
        brunt_node_lanes_squares(&p->surface, node, face, square);
        for (int l = 0; l < BRUNT_DOUBLES; l++) {
            const brunt_closest alone = brunt_closest_on_face_within(&p->surface, i + l, p->x[node[l]], 0);
            const bool inside = brunt_closest_on_face(&p->surface, i + l, p->x[node[l]]).inside;
            told += square[l] >= 0, beside += !inside;
            ck_assert(!inside || square[l] == -1);
            if (square[l] >= 0) ck_assert_double_eq(square[l], alone.square);
        }
    }
    printf("  beside: %d, of %d the distance is told\n", beside, told);
    ck_assert_int_gt(told, beside / 2);
    ck_assert_int_gt(beside, PAIRS / 2);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("node_lanes");
    TCase *tests = tcase_create("together");
    tcase_add_loop_test(tests, see_together_what_each_sees, 0, 2);
    tcase_add_test(tests, distances_to_what_is_beside);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
