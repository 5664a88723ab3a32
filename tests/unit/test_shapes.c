// Shapes by signed distance, placements, and filling with particles.
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "geometry/fill.h"
#include "base/memory.h"
#include "tests/support/suite.h"

static const double pi = 3.14159265358979323846;

static double distance3(const brunt_shape *shape, double x, double y, double z) {
    return brunt_shape_distance(shape, 3, (double[3]){x, y, z});
}
static double distance2(const brunt_shape *shape, double x, double y) {
    return brunt_shape_distance(shape, 2, (double[3]){x, y, 0});
}
static brunt_shape box(double x0, double y0, double z0, double x1, double y1, double z1) {
    return (brunt_shape){.kind = BRUNT_BOX, .min = {x0, y0, z0}, .max = {x1, y1, z1}};
}
static brunt_shape sphere(double x, double y, double z, double radius) {
    return (brunt_shape){.kind = BRUNT_SPHERE, .center = {x, y, z}, .radius = radius};
}
static brunt_shape half_space(double x, double y, double z, double nx, double ny, double nz) {
    return (brunt_shape){.kind = BRUNT_HALF_SPACE, .center = {x, y, z}, .axis = {nx, ny, nz}};
}
// A combination owns its parts; brunt_shape_free gives them back.
static brunt_shape combine(brunt_shape_kind kind, int count, const brunt_shape *parts) {
    brunt_shape shape = {.kind = kind, .child_count = count};
    shape.children = brunt_alloc((size_t)count * sizeof *parts);
    memcpy(shape.children, parts, (size_t)count * sizeof *parts);
    return shape;
}
static brunt_shape polygon(int count, const double (*points)[2], double z0, double z1) {
    brunt_shape shape = {.kind = BRUNT_PRISM, .min = {0, 0, z0}, .max = {0, 0, z1}, .point_count = count};
    shape.points = brunt_alloc((size_t)count * sizeof *points);
    memcpy(shape.points, points, (size_t)count * sizeof *points);
    return shape;
}
static void expect_bounds(const brunt_shape *shape, int dimension, const double *min, const double *max) {
    double lower[3], upper[3];
    ck_assert(brunt_shape_bounds(shape, dimension, lower, upper));
    for (int i = 0; i < dimension; i++) {
        ck_assert_double_eq_tol(lower[i], min[i], 1e-14);
        ck_assert_double_eq_tol(upper[i], max[i], 1e-14);
    }
}

START_TEST(distance_of_primitives) {
    brunt_shape shape = box(0, 0, 0, 2, 4, 6);
    ck_assert_double_eq_tol(distance3(&shape, 1, 2, 3), -1, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 1.75, 2, 3), -0.25, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 5, 2, 3), 3, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 4, 7, 12), 7, 1e-15); // corner: 2, 3, 6
    ck_assert_double_eq_tol(distance2(&shape, 5, 8), 5, 1e-15);     // corner in the plane: 3, 4

    shape = sphere(1, 2, 3, 5);
    ck_assert_double_eq_tol(distance3(&shape, 1, 2, 3), -5, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 1, 2, 11), 3, 1e-15);
    ck_assert_double_eq_tol(distance2(&shape, 4, 6), 0, 1e-15);

    // Along (1, 1, 0), of a length other than 1, from the origin.
    shape = (brunt_shape){.kind = BRUNT_CYLINDER, .axis = {3, 3, 0}, .radius = 1, .length = 2 * sqrt(2)};
    ck_assert_double_eq_tol(distance3(&shape, 1, 1, 0), -1, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 1, 1, 3), 2, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, -3, -3, 0), sqrt(18), 1e-14);
    ck_assert_double_eq_tol(distance3(&shape, 4, 4, 1 + sqrt(2)), sqrt(8 + 2), 1e-14); // past the rim

    shape = (brunt_shape){
        .kind = BRUNT_TUBE, .center = {0, 0, 1}, .axis = {0, 0, -2}, .radius = 3, .inner_radius = 1, .length = 2};
    ck_assert_double_eq_tol(distance3(&shape, 0, 0, 0), 1, 1e-15); // in the bore
    ck_assert_double_eq_tol(distance3(&shape, 2, 0, 0), -1, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 0, 1.25, 0), -0.25, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 6, 0, 5), 5, 1e-15); // rim: 3, 4
    ck_assert_double_eq_tol(distance2(&shape, 0, 0), 1, 1e-15);
    ck_assert_double_eq_tol(distance2(&shape, 0, 2.75), -0.25, 1e-15);

    shape = half_space(0, 0, 1, 0, 0, 4);
    ck_assert_double_eq_tol(distance3(&shape, 7, 8, -1), -2, 1e-15);
    ck_assert_double_eq_tol(distance3(&shape, 7, 8, 2.5), 1.5, 1e-15);
}
END_TEST

// An L, in both senses of turning: the reentrant corner at (1, 1) is where a wrong sign shows.
START_TEST(distance_of_polygon) {
    static const double turns[2][6][2] = {{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},
                                          {{0, 3}, {1, 3}, {1, 1}, {3, 1}, {3, 0}, {0, 0}}};
    for (int turn = 0; turn < 2; turn++) {
        brunt_shape shape = polygon(6, turns[turn], 0, 10);
        ck_assert_double_eq_tol(distance2(&shape, 0.5, 2), -0.5, 1e-15);
        ck_assert_double_eq_tol(distance2(&shape, 2, 2), 1, 1e-15);
        ck_assert_double_eq_tol(distance2(&shape, 0.5, 0.5), -0.5, 1e-15);
        ck_assert_double_eq_tol(distance2(&shape, 6, -4), 5, 1e-15);
        ck_assert_double_eq_tol(distance2(&shape, -1, 1), 1, 1e-15); // level with the corner: the ray meets it
        ck_assert_double_eq_tol(distance2(&shape, -1, 3), 1, 1e-15);
        ck_assert_double_eq_tol(distance3(&shape, 0.5, 0.5, 9.75), -0.25, 1e-15);
        ck_assert_double_eq_tol(distance3(&shape, 6, 0.5, 14), 5, 1e-15);
        expect_bounds(&shape, 3, (double[]){0, 0, 0}, (double[]){3, 3, 10});
        brunt_shape_free(&shape);
    }
}
END_TEST

START_TEST(combinations) {
    size_t before = brunt_memory_live();
    brunt_shape both = combine(BRUNT_UNION, 2, (brunt_shape[]){sphere(0, 0, 0, 1), sphere(3, 0, 0, 1)});
    ck_assert_double_eq_tol(distance3(&both, 1.5, 0, 0), 0.5, 1e-15);
    ck_assert_double_eq_tol(distance3(&both, 3, 0, 0), -1, 1e-15);
    expect_bounds(&both, 3, (double[]){-1, -1, -1}, (double[]){4, 1, 1});
    brunt_shape_free(&both);

    // A cube with a hole at its centre, less everything below z = -1.
    brunt_shape parts[3] = {box(-2, -2, -2, 2, 2, 2), sphere(0, 0, 0, 1), half_space(0, 0, -1, 0, 0, 1)};
    brunt_shape drilled = combine(BRUNT_DIFFERENCE, 3, parts);
    ck_assert_double_eq_tol(distance3(&drilled, 0, 0, 0), 1, 1e-15);
    ck_assert_double_eq_tol(distance3(&drilled, 1.75, 0, 0), -0.25, 1e-15);
    ck_assert_double_eq_tol(distance3(&drilled, 0, 1.125, 0), -0.125, 1e-15);
    ck_assert_double_eq_tol(distance3(&drilled, 0, 1.9, -1.5), 0.5, 1e-15);
    expect_bounds(&drilled, 3, (double[]){-2, -2, -1}, (double[]){2, 2, 2});
    brunt_shape_free(&drilled);

    // A quarter of a disk: the half-spaces cut its bounds too.
    brunt_shape cuts[3] = {sphere(0, 0, 0, 2), half_space(0, 0, 0, -1, 0, 0), half_space(0, 0, 0, 0, -3, 0)};
    brunt_shape quarter = combine(BRUNT_INTERSECTION, 3, cuts);
    ck_assert_double_eq_tol(distance2(&quarter, 0.25, 1), -0.25, 1e-15);
    ck_assert_double_eq_tol(distance2(&quarter, -1, 1), 1, 1e-15);
    expect_bounds(&quarter, 2, (double[]){0, 0}, (double[]){2, 2});
    brunt_shape_free(&quarter);
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

START_TEST(bounds) {
    brunt_shape shape = {
        .kind = BRUNT_CYLINDER, .center = {1, 0, 0}, .axis = {1, 0, 1}, .radius = 1, .length = sqrt(2)};
    double h = sqrt(0.5);
    expect_bounds(&shape, 3, (double[]){1 - h, -1, -h}, (double[]){2 + h, 1, 1 + h});
    shape = (brunt_shape){.kind = BRUNT_TUBE, .center = {1, 2, 0}, .radius = 3, .inner_radius = 2};
    expect_bounds(&shape, 2, (double[]){-2, -1}, (double[]){4, 5});

    double min[3], max[3];
    shape = half_space(0, 0, 0, 0, 0, 1);
    ck_assert(!brunt_shape_bounds(&shape, 3, min, max));
    brunt_shape nothing = combine(BRUNT_INTERSECTION, 2, (brunt_shape[]){sphere(0, 0, 0, 1), sphere(9, 0, 0, 1)});
    ck_assert(!brunt_shape_bounds(&nothing, 3, min, max));
    brunt_shape_free(&nothing);
}
END_TEST

START_TEST(placement_round_trip) {
    const double about[3] = {1, -2, 0.5}, axis[3] = {1, 2, -2}, x[3] = {0.3, 0.7, -1.1};
    brunt_placement place = brunt_placement_rotate(brunt_placement_identity(), (double[3]){0, 0, 5}, pi / 2, about);
    const double *R = place.rotation, *t = place.translation;
    // A quarter turn about (1, -2): (x, y) -> (1 - (y + 2), -2 + (x - 1))
    ck_assert_double_eq_tol(R[0] * x[0] + R[1] * x[1] + R[2] * x[2] + t[0], 1 - 2.7, 1e-14);
    ck_assert_double_eq_tol(R[3] * x[0] + R[4] * x[1] + R[5] * x[2] + t[1], -2 - 0.7, 1e-14);
    ck_assert_double_eq_tol(R[6] * x[0] + R[7] * x[1] + R[8] * x[2] + t[2], -1.1, 1e-14);

    place = brunt_placement_translate(brunt_placement_rotate(place, axis, 0.7, about), x);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double dot = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j];
            ck_assert_double_eq_tol(dot, i == j, 1e-14);
        }
    place = brunt_placement_translate(place, (double[3]){-x[0], -x[1], -x[2]});
    place = brunt_placement_rotate(place, axis, -0.7, about);
    place = brunt_placement_rotate(place, (double[3]){0, 0, 1}, -pi / 2, about);
    for (int i = 0; i < 9; i++) ck_assert_double_eq_tol(place.rotation[i], i % 4 == 0, 1e-14);
    for (int i = 0; i < 3; i++) ck_assert_double_eq_tol(place.translation[i], 0, 1e-14);
}
END_TEST

static brunt_filled fill(const brunt_shape *shape, int dimension, double spacing, double jitter, uint64_t seed) {
    brunt_body_def body = brunt_body_def_default();
    strcpy(body.name, "test");
    body.shape = *shape;
    body.fill = jitter > 0 ? BRUNT_FILL_JITTERED : BRUNT_FILL_REGULAR;
    body.jitter = jitter;
    body.seed = seed;
    brunt_filled filled;
    brunt_error error = {0};
    ck_assert_msg(brunt_fill_shape(&body, dimension, spacing, &filled, &error) == BRUNT_OK, "%s", error.message);
    return filled;
}

START_TEST(box_is_exact) {
    brunt_shape shape = box(-0.1, 0.3, 0, 0.2, 0.8, 0.7);
    brunt_filled filled = fill(&shape, 3, 0.1, 0, 1);
    ck_assert_int_eq(filled.count, 3 * 5 * 7);
    ck_assert_double_eq_tol(filled.count * filled.volume, 0.105, 1e-15);
    int n = 0; // x slowest, z fastest
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 5; j++)
            for (int k = 0; k < 7; k++, n++) {
                ck_assert_double_eq_tol(filled.position[0][n], -0.1 + (i + 0.5) * 0.1, 1e-15);
                ck_assert_double_eq_tol(filled.position[1][n], 0.3 + (j + 0.5) * 0.1, 1e-15);
                ck_assert_double_eq_tol(filled.position[2][n], (k + 0.5) * 0.1, 1e-15);
            }
    brunt_filled_free(&filled);

    // Not a whole number of spacings: as many as fit best, in the middle.
    shape = box(0, 0, 0, 1.04, 0.98, 0);
    filled = fill(&shape, 2, 0.1, 0, 1);
    ck_assert_int_eq(filled.count, 100);
    ck_assert_ptr_null(filled.position[2]);
    ck_assert_double_eq_tol(filled.position[0][0], 0.07, 1e-15);
    ck_assert_double_eq_tol(filled.position[1][0], 0.04, 1e-15);
    brunt_filled_free(&filled);
}
END_TEST

START_TEST(round_shapes_keep_their_volume) {
    brunt_shape shape = sphere(0.3, 0.2, 0.1, 1);
    brunt_filled filled = fill(&shape, 3, 1.0 / 20, 0, 1);
    ck_assert_double_eq_tol(filled.count * filled.volume, 4 * pi / 3, 0.01 * 4 * pi / 3);
    double sum[3] = {0, 0, 0};
    for (int32_t p = 0; p < filled.count; p++)
        for (int i = 0; i < 3; i++) sum[i] += filled.position[i][p] - shape.center[i];
    for (int i = 0; i < 3; i++) ck_assert_double_eq_tol(sum[i] / filled.count, 0, 1e-12); // symmetric
    brunt_filled_free(&filled);

    filled = fill(&shape, 2, 1.0 / 20, 0, 1);
    ck_assert_double_eq_tol(filled.count * filled.volume, pi, 0.01 * pi);
    brunt_filled_free(&filled);

    // 316 sites of a square lattice have their centres in a circle of ten spacings, by (2 i + 1)^2 + (2 j + 1)^2 < 400.
    shape = (brunt_shape){.kind = BRUNT_CYLINDER, .axis = {0, 0, 1}, .radius = 3.8e-3, .length = 25.4e-3};
    filled = fill(&shape, 3, 0.38e-3, 0, 1);
    ck_assert_int_eq(filled.count, 316 * 67);
    brunt_filled_free(&filled);

    shape = (brunt_shape){.kind = BRUNT_TUBE, .center = {0, 0, 0}, .radius = 1, .inner_radius = 0.5};
    filled = fill(&shape, 2, 1.0 / 40, 0, 1);
    ck_assert_double_eq_tol(filled.count * filled.volume, 0.75 * pi, 0.01 * 0.75 * pi);
    brunt_filled_free(&filled);
}
END_TEST

// Rows are walked by leaps over what is outside: nothing may be lost to a leap, so every site is tried here.
START_TEST(no_site_is_lost) {
    brunt_shape parts[3] = {sphere(0, 0, 0, 1), sphere(0.1, 0.2, 0, 0.95), half_space(0.0123, 0, 0, 1, 2, 3)};
    brunt_shape shape = combine(BRUNT_DIFFERENCE, 3, parts);
    const int n = 50;
    double spacing = 2.0 / n;
    brunt_filled filled = fill(&shape, 3, spacing, 0, 1);
    int32_t found = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++) {
                double x[3] = {-1 + (i + 0.5) * spacing, -1 + (j + 0.5) * spacing, -1 + (k + 0.5) * spacing};
                if (brunt_shape_distance(&shape, 3, x) >= 0) continue;
                ck_assert_int_lt(found, filled.count);
                for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(filled.position[a][found], x[a], 1e-14);
                found++;
            }
    ck_assert_int_gt(found, 100);
    ck_assert_int_eq(found, filled.count);
    brunt_filled_free(&filled);
    brunt_shape_free(&shape);
}
END_TEST

// The seam of two boxes that touch is not a surface: the sites on it belong to the body.
START_TEST(seam_of_a_union_is_filled) {
    brunt_shape shape = combine(BRUNT_UNION, 2, (brunt_shape[]){box(0, 0, 0, 0.5, 1, 0), box(0.5, 0, 0, 1, 1, 0)});
    brunt_filled filled = fill(&shape, 2, 0.2, 0, 1);
    ck_assert_int_eq(filled.count, 25);
    brunt_filled_free(&filled);
    brunt_shape_free(&shape);
}
END_TEST

static void check_reach(const brunt_shape *shape, int dimension, double jitter) {
    const double spacing = 0.05;
    brunt_filled filled = fill(shape, dimension, spacing, jitter, 7);
    int32_t limited = 0;
    for (int32_t p = 0; p < filled.count; p++) {
        double x[3] = {0, 0, 0};
        for (int i = 0; i < dimension; i++) x[i] = filled.position[i][p];
        double depth = -brunt_shape_distance(shape, dimension, x), limit = 0.5 * sqrt(dimension) * spacing;
        ck_assert_double_ge(depth, 0);
        ck_assert_double_le(filled.reach[p], depth + 1e-15);
        ck_assert_double_eq_tol(filled.reach[p], fmin(depth, limit), 1e-14);
        limited += filled.reach[p] < depth;
    }
    ck_assert_int_gt(limited, 0);
    ck_assert_int_lt(limited, filled.count);
    brunt_filled_free(&filled);
}

START_TEST(reach_never_exceeds_the_distance) {
    brunt_shape round = sphere(0.5, 0.5, 0.5, 0.5), square = box(0, 0, 0, 1, 1, 1);
    brunt_shape ring = {.kind = BRUNT_TUBE, .axis = {0, 0, 1}, .radius = 1, .inner_radius = 0.4, .length = 1};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int jittered = 0; jittered < 2; jittered++) {
            check_reach(&round, dimension, jittered * 0.5);
            check_reach(&square, dimension, jittered * 0.5);
            check_reach(&ring, dimension, jittered * 0.5);
        }
}
END_TEST

START_TEST(jitter_is_deterministic) {
    brunt_shape shape = sphere(0, 0, 0, 1);
    brunt_filled regular = fill(&shape, 3, 0.1, 0, 3), first = fill(&shape, 3, 0.1, 0.4, 3);
    brunt_filled again = fill(&shape, 3, 0.1, 0.4, 3), other = fill(&shape, 3, 0.1, 0.4, 4);
    ck_assert_int_eq(regular.count, first.count);
    ck_assert_int_eq(first.count, other.count);
    double square = 0, mean = 0;
    int32_t differing = 0, moved = 0;
    for (int i = 0; i < 3; i++) {
        ck_assert_mem_eq(first.position[i], again.position[i], (size_t)first.count * sizeof(double));
        for (int32_t p = 0; p < first.count; p++) {
            double shift = (first.position[i][p] - regular.position[i][p]) / 0.1;
            ck_assert_double_le(fabs(shift), 0.4 + 1e-12);
            mean += shift;
            square += shift * shift;
            differing += first.position[i][p] != other.position[i][p];
            moved += shift != 0;
        }
    }
    int32_t samples = 3 * first.count;
    ck_assert_int_gt(differing, samples * 9 / 10);
    ck_assert_int_gt(moved, samples * 99 / 100); // beside the surface by less
    // Uniform in +-0.4: variance 0.4^2/3 less what the surface takes; the mean of 12,000 is within five standard
    // errors.
    ck_assert_double_eq_tol(square / samples, 0.16 / 3, 0.15 * 0.16 / 3);
    ck_assert_double_eq_tol(mean / samples, 0, 5 * 0.4 / sqrt(3.0 * samples));
    brunt_filled_free(&regular);
    brunt_filled_free(&first);
    brunt_filled_free(&again);
    brunt_filled_free(&other);
}
END_TEST

START_TEST(lattice_moves_with_the_placement) {
    brunt_body_def body = brunt_body_def_default();
    body.shape = box(0, 0, 0, 0.4, 0.2, 0);
    const double about[3] = {0, 0, 0};
    body.place = brunt_placement_rotate(body.place, (double[3]){0, 0, 1}, pi / 2, about);
    body.place = brunt_placement_translate(body.place, (double[3]){10, 0, 0});
    brunt_filled filled;
    ck_assert_int_eq(brunt_fill_shape(&body, 2, 0.1, &filled, NULL), BRUNT_OK);
    ck_assert_int_eq(filled.count, 8);
    ck_assert_double_eq_tol(filled.position[0][1], 10 - 0.15, 1e-14); // site (0, 1): (0.05, 0.15) -> (-0.15, 0.05)
    ck_assert_double_eq_tol(filled.position[1][1], 0.05, 1e-14);
    brunt_filled_free(&filled);
}
END_TEST

// As many particles below the centre as rings, all as large, and together the disk; in nothing else there are rings.
START_TEST(rings_fill_a_disk) {
    brunt_body_def body = brunt_body_def_default();
    body.shape = (brunt_shape){.kind = BRUNT_SPHERE, .center = {3, 2, 0}, .radius = 1};
    body.fill = BRUNT_FILL_RINGS;
    brunt_filled filled;
    ck_assert_int_eq(brunt_fill_shape(&body, 2, 0.1, &filled, NULL), BRUNT_OK);
    ck_assert_int_eq(filled.count, 4 * 9 * 9);
    ck_assert_double_eq_tol(filled.count * filled.volume, pi, 1e-14);
    double farthest = 0, middle[2] = {0, 0};
    int below = 0;
    for (int n = 0; n < filled.count; n++) {
        const double x = filled.position[0][n] - 3, y = filled.position[1][n] - 2;
        middle[0] += x, middle[1] += y;
        farthest = fmax(farthest, hypot(x, y));
        below += fabs(x) < 1e-12 && y < 0;
        ck_assert_double_eq_tol(filled.reach[n], fmin(1 - hypot(x, y), 0.05 * sqrt(2)), 1e-14);
    }
    ck_assert_int_eq(below, 9);
    ck_assert_double_eq_tol(farthest, 1 - 0.5 / 9, 1e-14);
    for (int a = 0; a < 2; a++) ck_assert_double_eq_tol(middle[a], 0, 1e-11);
    brunt_filled_free(&filled);
    body.shape = box(0, 0, 0, 1, 1, 1);
    ck_assert_int_eq(brunt_fill_shape(&body, 2, 0.1, &filled, NULL), BRUNT_BAD_INPUT);
}
END_TEST

START_TEST(impossible_fills_are_errors) {
    size_t before = brunt_memory_live();
    brunt_body_def body = brunt_body_def_default();
    strcpy(body.name, "rod");
    brunt_filled filled;
    const struct {
        brunt_shape shape;
        double spacing;
        const char *says;
    } cases[] = {
        {half_space(0, 0, 0, 0, 0, 1), 0.1, "no bounds"},
        {box(0, 0, 0, 1, 1, 1), 0, "positive length"},
        {box(0, 0, 0, 1, 1, 1), NAN, "positive length"},
        {box(0, 0, 0, 1, 1, 0.01), 0.1, "less than half"},
        {box(0, 0, 0, 1, 1, 1), 1e-4, "about 1e+12 particles"},
        {box(0, 0, 0, 1, 1, 1), 2e-5, "too many"},
        {box(0, 0, 0, 1, 1, 1), 1e-12, "at most 2^31"},
        // One lattice site in the middle of its bounds, and there is the hole.
        {{.kind = BRUNT_TUBE, .axis = {0, 0, 1}, .radius = 1, .inner_radius = 0.5, .length = 2}, 2, "no particle lies"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        brunt_error error = {0};
        body.shape = cases[i].shape;
        ck_assert_int_eq(brunt_fill_shape(&body, 3, cases[i].spacing, &filled, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, cases[i].says) && strstr(error.message, "rod"), "%zu: %s", i,
                      error.message);
        ck_assert_int_eq(filled.count, 0);
    }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

START_TEST(definitions_start_sensible_and_leave_nothing) {
    size_t before = brunt_memory_live();
    brunt_world_def world = brunt_world_def_default();
    ck_assert_int_eq(world.dimension, 3);
    ck_assert_int_eq(world.kernel, BRUNT_QUADRATIC);
    ck_assert_int_eq(world.transfer, BRUNT_APIC);
    ck_assert_int_eq(world.contact.method, BRUNT_CONTACT_MULTI_VELOCITY);
    ck_assert_double_eq(world.cfl, 0); // by kernel, transfer and dimension
    ck_assert_double_eq(world.energy_limit, 0.1);
    ck_assert_int_eq(brunt_plane_def_default().condition, BRUNT_SEPARATE);
    brunt_region_def region = brunt_region_def_default();
    ck_assert(region.component[0] && region.component[1] && region.component[2] && isinf(region.end));
    brunt_body_def body = brunt_body_def_default();
    ck_assert_double_eq(body.temperature, 293.15);
    for (int i = 0; i < 9; i++) ck_assert_double_eq(body.place.rotation[i], i % 4 == 0);

    brunt_shape nested[2] = {sphere(0, 0, 0, 1), polygon(3, (const double[3][2]){{0, 0}, {1, 0}, {0, 1}}, 0, 1)};
    world.bodies = brunt_alloc(sizeof *world.bodies);
    world.body_count = 1;
    world.bodies[0] = body;
    world.bodies[0].shape = combine(BRUNT_UNION, 2, nested);
    world.regions = brunt_alloc(sizeof *world.regions);
    world.region_count = 1;
    world.regions[0] = region;
    world.regions[0].shape = polygon(3, (const double[3][2]){{0, 0}, {1, 0}, {0, 1}}, 0, 1);
    world.materials = brunt_alloc(sizeof *world.materials);
    world.planes = brunt_alloc(sizeof *world.planes);
    world.contact.pairs = brunt_alloc(sizeof *world.contact.pairs);
    ck_assert_uint_gt(brunt_memory_live(), before);
    brunt_world_def_free(&world);
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("shapes");
    TCase *tests = tcase_create("shapes");
    tcase_add_test(tests, distance_of_primitives);
    tcase_add_test(tests, distance_of_polygon);
    tcase_add_test(tests, combinations);
    tcase_add_test(tests, bounds);
    tcase_add_test(tests, placement_round_trip);
    tcase_add_test(tests, box_is_exact);
    tcase_add_test(tests, round_shapes_keep_their_volume);
    tcase_add_test(tests, no_site_is_lost);
    tcase_add_test(tests, seam_of_a_union_is_filled);
    tcase_add_test(tests, reach_never_exceeds_the_distance);
    tcase_add_test(tests, jitter_is_deterministic);
    tcase_add_test(tests, lattice_moves_with_the_placement);
    tcase_add_test(tests, rings_fill_a_disk);
    tcase_add_test(tests, impossible_fills_are_errors);
    tcase_add_test(tests, definitions_start_sensible_and_leave_nothing);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
