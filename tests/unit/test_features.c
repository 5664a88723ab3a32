// Edges and corners of surfaces: their mean normal, known in closed form where all faces are at right angles.
#include <check.h>
#include <math.h>
#include <string.h>

#include "contact/distance/feature.h"
#include "tests/support/suite.h"

// A box of unequal sides at the origin, of quadrilaterals or of triangles.
typedef struct box {
    double x[8][3], normal[12][3], centre[12][3];
    int32_t face[12][4];
    brunt_contact_surface surface;
} box;

static void add_face(box *b, int f, const int32_t node[4]) {
    const int n = node[3] < 0 ? 3 : 4;
    double e[3], g[3], size = 0;
    memcpy(b->face[f], node, sizeof b->face[f]);
    for (int a = 0; a < 3; a++) {
        e[a] = b->x[node[1]][a] - b->x[node[0]][a], g[a] = b->x[node[n - 1]][a] - b->x[node[0]][a];
        b->centre[f][a] = 0;
        for (int c = 0; c < n; c++) b->centre[f][a] += b->x[node[c]][a] / n;
    }
    for (int a = 0; a < 3; a++) b->normal[f][a] = e[(a + 1) % 3] * g[(a + 2) % 3] - e[(a + 2) % 3] * g[(a + 1) % 3];
    for (int a = 0; a < 3; a++) size += b->normal[f][a] * b->normal[f][a];
    for (int a = 0; a < 3; a++) b->normal[f][a] /= sqrt(size);
}

// `cut`: 0 quadrilaterals; 1, 2: triangles, by either diagonal.
static int make_box(box *b, const double side[3], int cut) {
    static const int32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    int count = 0;
    memset(b, 0, sizeof *b);
    for (int n = 0; n < 8; n++)
        for (int a = 0; a < 3; a++) b->x[n][a] = n >> a & 1 ? side[a] : 0;
    for (int q = 0; q < 6; q++) {
        const int32_t *n = quads[q];
        if (!cut) {
            add_face(b, count++, n);
            continue;
        }
        const int o = cut - 1;
        add_face(b, count++, (const int32_t[4]){n[o], n[o + 1], n[o + 2], -1});
        add_face(b, count++, (const int32_t[4]){n[o], n[o + 2], n[(o + 3) % 4], -1});
    }
    b->surface = (brunt_contact_surface){
        .dim = 3, .x = b->x, .face = b->face, .face_normal = b->normal, .face_centre = b->centre, .face_count = count};
    return count;
}

// The faces that have both nodes.
static int faces_at(const box *b, int count, int32_t p, int32_t q, int32_t *face) {
    int found = 0;
    for (int f = 0; f < count; f++) {
        bool has[2] = {false, false};
        for (int c = 0; c < 4; c++) has[0] |= b->face[f][c] == p, has[1] |= b->face[f][c] == q;
        if (has[0] && has[1]) face[found++] = f;
    }
    return found;
}

// Each face counts by its angle at the corner: three right angles, however long the edges are and however faces are
// cut.
START_TEST(corner_of_unequal_faces) {
    const double side[3] = {1, 2.5, 7};
    box b;
    const int count = make_box(&b, side, _i);
    for (int32_t corner = 0; corner < 8; corner++) {
        int32_t face[12];
        double n[3];
        const brunt_feature f = {.any = true, .end = {corner, corner}};
        ck_assert(brunt_feature_normal(&b.surface, &f, face, faces_at(&b, count, corner, corner, face), n));
        for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(n[a], (corner >> a & 1 ? 1 : -1) / sqrt(3), 1e-14);
    }
}
END_TEST

// At an edge both sides count alike.
START_TEST(edge_of_unequal_faces) {
    const double side[3] = {1, 2.5, 7};
    box b;
    const int count = make_box(&b, side, _i);
    for (int32_t p = 0; p < 8; p++)
        for (int axis = 0; axis < 3; axis++) {
            const int32_t q = p ^ 1 << axis;
            int32_t face[12];
            double n[3];
            const brunt_feature f = {.any = true, .end = {p, q}};
            const int found = faces_at(&b, count, p, q, face);
            ck_assert_int_eq(found, 2);
            ck_assert(brunt_feature_normal(&b.surface, &f, face, found, n));
            for (int a = 0; a < 3; a++)
                ck_assert_double_eq_tol(n[a], a == axis ? 0 : (p >> a & 1 ? 1 : -1) / sqrt(2), 1e-14);
        }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("features");
    TCase *tests = tcase_create("features");
    tcase_add_loop_test(tests, corner_of_unequal_faces, 0, 3);
    tcase_add_loop_test(tests, edge_of_unequal_faces, 0, 3);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
