// The surface of a mesh: the faces that no other element has, against a search over all pairs of faces.
#include "tests/support/suite.h"
#include "fem/fem_body.h"

#include <stdio.h>

enum { ELEMENTS = 60, NODES = 14 };

static bool within(const int32_t *a, const int32_t *b, int count) {
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int j = 0; j < count; j++) found = found || a[i] == b[j];
        if (!found) return false;
    }
    return true;
}

static int32_t least_of(const int32_t *node, int count) {
    int32_t least = node[0];
    for (int k = 1; k < count; k++) least = node[k] < least ? node[k] : least;
    return least;
}

static void nodes_of(const brunt_fem_body *body, int64_t f, int32_t node[4]) {
    const brunt_element_traits *t = body->traits;
    for (int k = 0; k < t->face_nodes; k++)
        node[k] = body->element_node[f / t->face_count * t->nodes + t->face[f % t->face_count][k]];
}

// Equal: of the same nodes; one that has shrunk to an edge or a triangle is within another with the same least node.
static bool is_alone(const brunt_fem_body *body, int64_t f) {
    const int each = body->traits->face_count;
    int32_t own[4], other[4];
    nodes_of(body, f, own);
    for (int64_t g = 0; g < (int64_t)body->slots * each && !body->traits->membrane; g++) {
        if (g == f || body->element_id[g / each] < 0) continue;
        nodes_of(body, g, other);
        const int count = body->traits->face_nodes;
        if (within(own, other, count) && least_of(own, count) == least_of(other, count)) return false;
    }
    return true;
}

// Elements of few nodes, whichever these are, so that many faces meet at a node and many are the same; some elements
// have a node twice, as a brick that is a wedge has, and some slots are empty.
START_TEST(a_face_is_outside_that_no_other_is_equal_to) {
    const brunt_element_kind kind = (brunt_element_kind)_i;
    int outside = 0, inside = 0;
    uint32_t seed = 12345 + (uint32_t)_i;
    for (int round = 0; round < 40; round++) {
        int32_t node[ELEMENTS * BRUNT_ELEMENT_NODES], id[ELEMENTS];
        real start[4 * NODES] = {0};
        brunt_fem_body body = {.traits = brunt_element_traits_of(kind),
                               .element = brunt_elements[kind],
                               .node_count = NODES,
                               .slots = ELEMENTS,
                               .element_node = node,
                               .element_id = id,
                               .start = start};
        const int nodes = body.traits->nodes;
        for (int s = 0; s < ELEMENTS; s++) {
            id[s] = s % 7 == 3 ? -1 : s;
            for (int a = 0; a < nodes; a++) {
                seed = seed * 1664525u + 1013904223u;
                // Neighbours share most of their nodes.
                node[s * nodes + a] = s && seed >> 30 ? node[(s - 1) * nodes + a] : (int32_t)(seed >> 8) % NODES;
            }
            for (int a = 1; a < nodes && s % 5; a++) // four in five have no node twice
                for (int b = 0; b < a; b++)
                    if (node[s * nodes + a] == node[s * nodes + b])
                        node[s * nodes + a] = (node[s * nodes + a] + 1) % NODES, b = -1;
        }
        brunt_faces faces;
        ck_assert_int_eq(brunt_fem_faces(&body, &faces, NULL), BRUNT_OK);
        int32_t found = 0;
        for (int64_t f = 0; f < (int64_t)ELEMENTS * body.traits->face_count; f++) {
            if (id[f / body.traits->face_count] < 0) continue;
            if (!is_alone(&body, f)) {
                inside++;
                continue;
            }
            int32_t own[4] = {-1, -1, -1, -1};
            nodes_of(&body, f, own);
            ck_assert_int_lt(found, faces.count);
            ck_assert_mem_eq(own, faces.node[found], sizeof own);
            ck_assert_int_eq(faces.element[found++], f / body.traits->face_count);
        }
        ck_assert_int_eq(found, faces.count);
        outside += found;
        brunt_faces_free(&faces);
    }
    printf("  %s: %d outside, %d inside\n", brunt_element_traits_of(kind)->name, outside, inside);
    ck_assert(outside > 100 && (inside > 100 || brunt_element_traits_of(kind)->membrane));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("faces");
    TCase *tcase = tcase_create("case");
    tcase_add_loop_test(tcase, a_face_is_outside_that_no_other_is_equal_to, 0, BRUNT_ELEMENT_KINDS);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
