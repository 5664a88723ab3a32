// The nearest point of a quadrilateral: that of its four triangles about the centre, each of which is a facet, too.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contact/distance/point_facet.h"
#include "tests/support/suite.h"

static double some(void) { return 2.0 * rand() / RAND_MAX - 1; }

// Corners 0 to 3 and the centre, 4: the quadrilateral is face 0, its triangles the next four.
typedef struct facets {
    double x[5][3], normal[5][3], centre[5][3], area[5];
    int32_t face[5][4];
    brunt_contact_surface surface;
} facets;

static void make(facets *f, double warp) {
    static const double flat[4][2] = {{0, 0}, {1, 0}, {1.2, 0.9}, {-0.1, 1}};
    memset(f, 0, sizeof *f);
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++)
            f->x[k][a] = (a < 2 ? flat[k][a] + 0.1 * some() : warp * some()), f->x[4][a] += f->x[k][a] / 4;
    double e[3], g[3];
    for (int a = 0; a < 3; a++) {
        f->centre[0][a] = f->x[4][a];
        e[a] = f->x[2][a] - f->x[0][a], g[a] = f->x[3][a] - f->x[1][a];
    }
    const double n[3] = {e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]};
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int a = 0; a < 3; a++) f->normal[0][a] = n[a] / size;
    f->area[0] = size / 2;
    for (int32_t t = 0; t < 4; t++) {
        const int32_t quadrilateral = t, triangle[4] = {t, (t + 1) % 4, 4, -1};
        f->face[0][t] = quadrilateral;
        memcpy(f->face[1 + t], triangle, sizeof triangle);
    }
    f->surface = (brunt_contact_surface){
        .x = f->x, .face_normal = f->normal, .face_centre = f->centre, .face_area = f->area, .face = f->face};
}

// A place about a corner, on a spoke, above it all or far off.
static void put(const facets *f, int k, double x[3]) {
    const double share = some(), wide = k % 4 == 3 ? 3 : 1;
    for (int a = 0; a < 3; a++) {
        const double corner = f->x[k % 5][a], centre = f->x[4][a];
        x[a] = k % 4 == 0   ? corner + 0.01 * some()
               : k % 4 == 1 ? centre + share * (corner - centre) + (a == 2 ? (k % 8 == 1 ? 1e-6 : 0.1) * some() : 0)
                            : centre + wide * some() * (a < 2 ? 0.6 : 0.2);
    }
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Of several triangles that are as near: the mean of their ways and of their normals, and the one that most faces x.
static void check_means(const facets *f, const double x[3], const brunt_closest *at) {
    double way[3] = {0}, normal[3] = {0}, most = 0;
    int count = 0;
    for (int t = 0; t < 4; t++) {
        if (!(at->triangles >> t & 1)) continue;
        const brunt_closest one = brunt_closest_on_face(&f->surface, 1 + t, x);
        for (int a = 0; a < 3; a++) way[a] += one.d[a], normal[a] += one.normal[a];
        most = fmax(most, one.inside ? INFINITY : fabs(dot(one.normal, one.d)));
        count++;
    }
    const brunt_closest own = brunt_closest_on_face(&f->surface, 1 + at->triangle, x);
    ck_assert(at->triangles >> at->triangle & 1 && count > 1);
    if (!own.inside) ck_assert_double_le(most - fabs(dot(own.normal, own.d)), 1e-9);
    const double size = sqrt(dot(normal, normal));
    for (int a = 0; a < 3; a++) {
        ck_assert_double_le(fabs(at->d[a] - way[a] / count), 1e-14);
        ck_assert_double_le(fabs(at->normal[a] - normal[a] / size), 1e-14);
    }
}

START_TEST(quadrilaterals_are_four_triangles) {
    int alone = 0, several = 0, over = 0;
    for (int k = 0; k < 20000; k++) {
        facets f;
        double x[3], least = INFINITY;
        const bool flat = k % 3 == 0;
        make(&f, flat ? 0 : 0.1);
        put(&f, k, x);
        const brunt_closest at = brunt_closest_on_face(&f.surface, 0, x);
        for (int t = 0; t < 4; t++) least = fmin(least, brunt_closest_on_face(&f.surface, 1 + t, x).square);
        const brunt_closest own = brunt_closest_on_face(&f.surface, 1 + at.triangle, x);
        // Of those that are as near the least distance: by it what two facets are nearer than each other is told.
        ck_assert_double_le(fabs(at.square - (at.triangles ? least : own.square)), 1e-14);
        if (!at.triangles)
            for (int a = 0; a < 3; a++) {
                ck_assert_double_le(fabs(at.d[a] - own.d[a]), 1e-14);
                ck_assert_double_le(fabs(at.normal[a] - own.normal[a]), 1e-14);
            }
        if (at.triangles) check_means(&f, x, &at);
        // Spokes are no edges: right above them, on a flat one, is inside, as far as numbers tell.
        if (flat && at.square < 1e-11 && at.d[0] * at.d[0] + at.d[1] * at.d[1] < 1e-30) ck_assert(at.inside), over++;
        // What is right above one of its triangles may be a little nearer to another, where it is warped.
        const bool settled = own.inside && !at.triangles;
        if (flat || !settled)
            ck_assert_msg(sqrt(at.square) <= sqrt(least) + 2e-6, "%g away, not %g", sqrt(at.square), sqrt(least));
        alone += settled, several += at.triangles != 0;
    }
    printf("  %d above one triangle, %d as near to several\n", alone, several);
    ck_assert(alone > 1000 && several > 1000 && over > 100);
}
END_TEST

// Where spokes are near, all triangles are looked at: on a ridge the one beside is nearer than that whose sector a
// place is in.
START_TEST(spokes_ask_both_sides) {
    facets f;
    make(&f, 0);
    for (int k = 0; k < 4; k++) f.x[k][2] = k % 2 ? 0.2 : -0.2;
    int asked = 0;
    for (int k = 0; k < 2000; k++) {
        double x[3], least = INFINITY;
        const double share = 0.2 + 0.3 * (some() + 1);
        for (int a = 0; a < 3; a++)
            x[a] = f.x[4][a] + share * (f.x[k % 4][a] - f.x[4][a]) + (a < 2 ? 2e-4 * some() : k % 4 % 2 ? -0.1 : 0.1);
        const brunt_closest at = brunt_closest_on_face(&f.surface, 0, x);
        for (int t = 0; t < 4; t++) least = fmin(least, brunt_closest_on_face(&f.surface, 1 + t, x).square);
        ck_assert_msg(sqrt(at.square) <= sqrt(least) + 2e-6, "%.9g away, not %.9g", sqrt(at.square), sqrt(least));
        asked += at.triangles != 0;
    }
    printf("  %d of 2000 as near to several\n", asked);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("nearest points of facets");
    TCase *tests = tcase_create("facets");
    tcase_add_test(tests, quadrilaterals_are_four_triangles);
    tcase_add_test(tests, spokes_ask_both_sides);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
