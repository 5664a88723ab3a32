// Labels: double
// What the barrier is made of: its function, distances of points, edges and triangles with their derivatives, and the
// search for what is near.
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/barrier/barrier_function.h"
#include "contact/barrier/closest.h"
#include "contact/barrier/near.h"
#include "tests/support/numbers.h"
#include "tests/support/suite.h"

// ----------------------------------------------------------------------------------------------------- function

START_TEST(the_barrier_is_what_it_is_derived_from) {
    const double dhat = 2e-3, kappa = 3e7;
    for (double s = 1e-6; s < 1; s *= 1.3) {
        const double d = s * dhat, h = 1e-4 * fmin(d, dhat - d);
        const brunt_barrier_value v = brunt_barrier_at(d, dhat, kappa), more = brunt_barrier_at(d + h, dhat, kappa),
                                  less = brunt_barrier_at(d - h, dhat, kappa);
        ck_assert_double_eq_tol(v.b, -kappa * dhat * (s - 1) * (s - 1) * log(s), 1e-9 * v.b);
        ck_assert_double_eq_tol((more.b - less.b) / (2 * h), v.db, 2e-7 * fabs(v.db));
        ck_assert_double_eq_tol((more.db - less.db) / (2 * h), v.ddb, 2e-7 * fabs(v.ddb));
        ck_assert(v.b > 0 && v.db < 0 && v.ddb > 0);
    }
    ck_assert_double_eq(brunt_barrier_at(dhat, dhat, kappa).b, 0);
    ck_assert_double_eq(brunt_barrier_at(2 * dhat, dhat, kappa).ddb, 0);
    ck_assert(brunt_barrier_at(0, dhat, kappa).b == INFINITY);
    ck_assert(brunt_barrier_at(-1e-9, dhat, kappa).b == INFINITY);
    // Close to its end b is -kappa dhat y^2 ln(1 - y) = kappa dhat y^3 (1 + y / 2), to all digits.
    const double y = 1e-7, b = brunt_barrier_at(dhat - y * dhat, dhat, kappa).b;
    ck_assert_double_eq_tol(b / (kappa * dhat * y * y * y), 1 + y / 2, 1e-8);
}
END_TEST

START_TEST(defaults_and_warnings) {
    ck_assert_double_eq_tol(brunt_barrier_default_distance(0.02), 0.002, 1e-16);
    ck_assert_double_eq_tol(brunt_barrier_default_stiffness(1e9, 2e6), 2e5, 1e-9);
    ck_assert_double_eq_tol(brunt_barrier_default_stiffness(INFINITY, 2e6), 2e5, 1e-9);
    ck_assert_double_eq_tol(brunt_barrier_longest_step(0.5, 8e6, 1), 1e-3, 1e-15);
    ck_assert(brunt_barrier_gap_is_small(0.9e-6, 1e-3) && !brunt_barrier_gap_is_small(1.1e-6, 1e-3));
}
END_TEST

// ---------------------------------------------------------------------------------------------------- distances

typedef enum kind { POINTS, EDGE, TRIANGLE, EDGES } kind;

static int places_of(kind k) { return k == POINTS ? 2 : k == EDGE ? 3 : 4; }

// The features' distance; which region it is in.
static int closest_of(kind k, const double (*x)[3], brunt_closest *c) {
    double d;
    if (k == EDGES) return brunt_closest_edges(x, x + 2, c);
    const int region = k == POINTS ? 1
                       : k == EDGE ? brunt_closest_of_edge(x[0], x[1], x[2], &d)
                                   : brunt_closest_of_triangle(x[0], x + 1, &d);
    int v[3] = {0}, n = 0;
    for (int i = 0; i < 3; i++)
        if (region >> i & 1) v[n++] = 1 + i;
    brunt_closest part;
    if (n == 3)
        brunt_closest_plane(x[0], x + 1, &part);
    else if (n == 2)
        brunt_closest_line(x[0], x[v[0]], x[v[1]], &part);
    else
        brunt_closest_points(x[0], x[v[0]], &part);
    *c = part;
    if (n == 3) return region;
    c->places = places_of(k); // places that do not bear have no weight
    memset(c->w, 0, sizeof c->w), memset(c->g, 0, sizeof c->g);
    c->w[0] = 1;
    for (int i = 0; i < n; i++) c->w[v[i]] = part.w[1 + i], c->g[0][v[i]] = part.g[0][1 + i];
    return region;
}

// The distance by another way: the least over a fine net of both features, refined about the best.
static double slow_distance(kind k, const double (*x)[3]) {
    double at[3] = {0.5, 0.5, 0}, width = 0.5, best = INFINITY;
    for (int round = 0; round < 60; round++, width *= 0.6) {
        double centre[2] = {at[0], at[1]};
        for (int i = -6; i <= 6; i++)
            for (int j = -6; j <= 6; j++) {
                double s = fmin(1, fmax(0, centre[0] + width * i / 6)), t = fmin(1, fmax(0, centre[1] + width * j / 6));
                double r[3], sum = 0;
                if (k == TRIANGLE && s + t > 1) {
                    const double over = (s + t - 1) / 2;
                    s = fmin(1, fmax(0, s - over)), t = 1 - s;
                }
                for (int c = 0; c < 3; c++) {
                    if (k == POINTS) r[c] = x[0][c] - x[1][c];
                    if (k == EDGE) r[c] = x[0][c] - (1 - s) * x[1][c] - s * x[2][c];
                    if (k == TRIANGLE) r[c] = x[0][c] - (1 - s - t) * x[1][c] - s * x[2][c] - t * x[3][c];
                    if (k == EDGES) r[c] = (1 - s) * x[0][c] + s * x[1][c] - (1 - t) * x[2][c] - t * x[3][c];
                    sum += r[c] * r[c];
                }
                if (sum < best) best = sum, at[0] = s, at[1] = t;
            }
    }
    return sqrt(best);
}

static void draw_places(uint64_t *state, int dim, double (*x)[3]) {
    memset(x, 0, 12 * sizeof(double));
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < dim; k++) x[i][k] = draw_between(state, -1, 1);
}

// Gradient and Hessian at x against central differences, of the size 1 / d that the Hessian has.
static void check_derivatives(kind k, int dim, double (*x)[3]) {
    const int places = places_of(k), rows = places * dim;
    double hessian[144] = {0};
    brunt_closest c, more, less;
    closest_of(k, (const double(*)[3])x, &c);
    brunt_closest_hessian(&c, dim, 0, 1, hessian);
    const double h = 2e-5 * c.d, size = fmax(1, 1 / c.d);
    for (int i = 0; i < places; i++)
        for (int a = 0; a < dim; a++) {
            const double was = x[i][a];
            x[i][a] = was + h, closest_of(k, (const double(*)[3])x, &more);
            x[i][a] = was - h, closest_of(k, (const double(*)[3])x, &less);
            x[i][a] = was;
            ck_assert_double_eq_tol((more.d - less.d) / (2 * h), c.w[i] * c.n[a], 1e-7);
            for (int j = 0; j < places; j++)
                for (int b = 0; b < dim; b++) {
                    const double slope = (more.w[j] * more.n[b] - less.w[j] * less.n[b]) / (2 * h);
                    ck_assert_double_eq_tol(slope, hessian[(i * dim + a) * rows + j * dim + b], 1e-7 * size);
                    ck_assert_double_eq_tol(hessian[(i * dim + a) * rows + j * dim + b],
                                            hessian[(j * dim + b) * rows + i * dim + a], 1e-13 * size);
                }
        }
}

// Far enough from the borders of regions for differences.
static bool well_inside(kind k, const double (*x)[3], int region) {
    for (int i = 0; i < 40; i++) {
        double y[4][3];
        brunt_closest c;
        uint64_t state = (uint64_t)i + 7;
        memcpy(y, x, sizeof y);
        for (int p = 0; p < 4; p++)
            for (int a = 0; a < 3; a++) y[p][a] += x[p][a] == 0 ? 0 : draw_between(&state, -0.02, 0.02);
        if (closest_of(k, (const double(*)[3])y, &c) != region) return false;
    }
    return true;
}

START_TEST(derivatives_in_all_regions) {
    uint64_t state = 1;
    for (int dim = 2; dim <= 3; dim++)
        for (kind k = POINTS; k <= EDGES; k++) {
            if (dim == 2 && k > EDGE) continue;
            int seen[16] = {0}, regions = 0;
            for (int n = 0; n < 4000; n++) {
                double x[4][3];
                brunt_closest c;
                draw_places(&state, dim, x);
                const int region = closest_of(k, (const double(*)[3])x, &c);
                if (c.d < 0.1 || seen[region] >= 25 || !well_inside(k, (const double(*)[3])x, region)) continue;
                if (seen[region]++ == 0) regions++;
                check_derivatives(k, dim, x);
            }
            // Of edges: four pairs of ends, four of an end and an edge, and both.
            static const int all[] = {1, 3, 7, 9};
            ck_assert_msg(regions == all[k], "%d regions of kind %d in %dD", regions, k, dim);
        }
}
END_TEST

START_TEST(distances_are_the_least) {
    uint64_t state = 2;
    for (kind k = POINTS; k <= EDGES; k++)
        for (int n = 0; n < 60; n++) {
            double x[4][3];
            brunt_closest c;
            draw_places(&state, 3, x);
            closest_of(k, (const double(*)[3])x, &c);
            const double slow = slow_distance(k, (const double(*)[3])x);
            ck_assert_msg(c.d <= slow + 1e-9 && c.d > slow - 1e-6, "kind %d: %.12g, by search %.12g", k, c.d, slow);
            double sum = 0, r[3] = {0};
            for (int i = 0; i < c.places; i++) {
                sum += c.w[i];
                for (int a = 0; a < 3; a++) r[a] += c.w[i] * x[i][a];
            }
            ck_assert_double_eq_tol(sum, 0, 1e-15);
            for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(r[a], c.d * c.n[a], 1e-13);
        }
}
END_TEST

// Across the border of two regions distance and gradient go on as they were.
START_TEST(regions_join) {
    uint64_t state = 3;
    int crossed[4] = {0};
    for (kind k = EDGE; k <= EDGES; k++)
        for (int n = 0; n < 3000 && crossed[k] < 200; n++) {
            double from[4][3], to[4][3];
            brunt_closest a, b;
            draw_places(&state, 3, from);
            memcpy(to, from, sizeof to);
            for (int c = 0; c < 3; c++) to[0][c] += draw_between(&state, -1, 1);
            const int first = closest_of(k, (const double(*)[3])from, &a);
            if (closest_of(k, (const double(*)[3])to, &b) == first) continue;
            for (int halve = 0; halve < 60; halve++) {
                double middle[4][3];
                memcpy(middle, from, sizeof middle);
                for (int c = 0; c < 3; c++) middle[0][c] = (from[0][c] + to[0][c]) / 2;
                memcpy(closest_of(k, (const double(*)[3])middle, &b) == first ? from : to, middle, sizeof middle);
            }
            closest_of(k, (const double(*)[3])from, &a), closest_of(k, (const double(*)[3])to, &b);
            if (a.d < 0.05) continue;
            crossed[k]++;
            ck_assert_double_eq_tol(a.d, b.d, 1e-14);
            // The plane of symmetry between two ends that are as far is no border of regions that join smoothly, and
            // two edges may be as near at two places.
            double difference = 0;
            for (int i = 0; i < places_of(k); i++)
                for (int c = 0; c < 3; c++) difference = fmax(difference, fabs(a.w[i] * a.n[c] - b.w[i] * b.n[c]));
            ck_assert_msg(difference < 1e-6, "kind %d: the gradient jumps by %g", k, difference);
        }
    for (kind k = EDGE; k <= EDGES; k++) ck_assert_int_ge(crossed[k], 100);
}
END_TEST

// A gap of 1e-9 of the size keeps six digits and more, wherever along the feature it is.
START_TEST(small_gaps_keep_their_digits) {
    for (double u = 0.001; u < 1; u += 0.0511) {
        const double gap = 1e-9, q[3] = {u, gap, 0}, a[3] = {0, 0, 0}, b[3] = {1, 0, 0};
        brunt_closest c;
        double d;
        ck_assert_int_eq(brunt_closest_of_edge(q, a, b, &d), 3);
        ck_assert_double_eq_tol(d, gap, 1e-7 * gap);
        brunt_closest_line(q, a, b, &c);
        ck_assert_double_eq_tol(c.n[1], 1, 1e-14);
        // Leaning edge, where no component is exact.
        const double s = sqrt(0.5), l[3] = {s * u - s * gap, s * u + s * gap, 0.1}, la[3] = {0, 0, 0.1},
                     lb[3] = {s, s, 0.1};
        brunt_closest_line(l, la, lb, &c);
        ck_assert_double_eq_tol(c.d, gap, 3e-7 * gap);
        ck_assert_double_eq_tol(c.n[0] + c.n[1], 0, 1e-14);
        const double t[3][3] = {{0, 0, 0}, {s, s, 0.2}, {-0.3, 0.5, 0.7}}, v = 0.4 * (1 - u);
        double n[3] = {s * 0.7 - 0.2 * 0.5, -(s * 0.7 + 0.2 * 0.3), s * 0.5 + s * 0.3}, size = 0, p[3];
        for (int k = 0; k < 3; k++) size += n[k] * n[k];
        for (int k = 0; k < 3; k++) p[k] = u * t[1][k] + v * t[2][k] + gap * n[k] / sqrt(size);
        ck_assert_int_eq(brunt_closest_of_triangle(p, t, &d), 7);
        ck_assert_double_eq_tol(d, gap, 1e-6 * gap);
    }
}
END_TEST

// Edges that are nearly, or wholly, parallel: the distance stays what it is.
START_TEST(parallel_edges_have_a_distance) {
    for (double angle = 1; angle > 1e-18; angle *= 0.1) {
        const double a[2][3] = {{-1, 0, 0}, {1, 0, 0}}, dx = cos(angle), dy = sin(angle),
                     b[2][3] = {{-dx, -dy, 0.01}, {dx, dy, 0.01}}, apart[2][3] = {{2, 0, 0.01}, {2 + dx, dy, 0.01}};
        brunt_closest c;
        brunt_closest_edges(a, b, &c);
        ck_assert_double_eq_tol(c.d, 0.01, 1e-9);
        ck_assert_double_eq_tol(fabs(c.n[2]), 1, 1e-9);
        brunt_closest_edges(a, apart, &c);
        ck_assert_double_eq_tol(c.d, hypot(1, 0.01), 1e-12);
    }
}
END_TEST

// Triangles of almost no height, and of none: never nearer than they are, never further than their edges.
START_TEST(slivers_have_a_distance) {
    uint64_t state = 5;
    for (double height = 1e-2; height > 1e-20; height *= 0.1)
        for (int n = 0; n < 20; n++) {
            const double q[3] = {draw_between(&state, -0.5, 1.5), draw_between(&state, -0.5, 0.5), 0.3},
                         t[3][3] = {{0, 0, 0}, {1, 0, 0}, {draw(&state), height, 0}};
            double d, edges = INFINITY, at;
            brunt_closest_of_triangle(q, t, &d);
            for (int i = 0; i < 3; i++) {
                brunt_closest_of_edge(q, t[i], t[(i + 1) % 3], &at);
                edges = fmin(edges, at);
            }
            // The plane of one of height 1e-8 is known to 1e-8; flatter ones have edges only.
            ck_assert_double_ge(d, 0.3 * (1 - 1e-7));
            ck_assert_double_le(d, edges * (1 + 1e-7));
            ck_assert_double_eq_tol(d, edges, 2 * height * height + 1e-7 * edges);
        }
}
END_TEST

START_TEST(cross_products_of_edges) {
    uint64_t state = 6;
    double x[6], g[6], second[36], more[6], less[6], unused[36];
    for (int i = 0; i < 6; i++) x[i] = draw_between(&state, -1, 1);
    brunt_edge_cross(x, x + 3, g, second);
    for (int i = 0; i < 6; i++) {
        const double was = x[i], h = 1e-5;
        x[i] = was + h;
        const double up = brunt_edge_cross(x, x + 3, more, unused);
        x[i] = was - h;
        const double down = brunt_edge_cross(x, x + 3, less, unused);
        x[i] = was;
        ck_assert_double_eq_tol((up - down) / (2 * h), g[i], 1e-8);
        for (int j = 0; j < 6; j++) ck_assert_double_eq_tol((more[j] - less[j]) / (2 * h), second[i * 6 + j], 1e-8);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------------------- search

typedef struct queries {
    const brunt_near_cells *cells;
    const brunt_near_box *box;
} queries;

static bool not_of_three(const void *context, int32_t query, int32_t item) {
    (void)context;
    return (query + item) % 3 != 0;
}

static int64_t found_by(const void *context, int32_t query, int32_t *out) {
    const queries *q = context;
    return brunt_near_find(q->cells, &q->box[query], not_of_three, NULL, query, out);
}

static void draw_boxes(uint64_t *state, int dim, int count, double large, brunt_near_box *box) {
    for (int i = 0; i < count; i++) {
        const double size = draw(state) < 0.05 ? large : 0.05;
        for (int k = 0; k < 3; k++) {
            box[i].low[k] = k < dim ? draw_between(state, -1, 1) : 0;
            box[i].high[k] = k < dim ? box[i].low[k] + size * draw(state) : 0;
        }
        if (i % 7 == 0) box[i].high[0] = box[i].low[0]; // flat ones
    }
}

START_TEST(search_finds_what_all_pairs_show) {
    enum { ITEM_LIMIT = 400 };
    static brunt_near_box item[ITEM_LIMIT], query[ITEM_LIMIT];
    static int32_t asked[ITEM_LIMIT];
    brunt_near_cells cells = {0};
    brunt_near_list list = {0};
    uint64_t state = 9;
    for (int round = 0; round < 60; round++) {
        const int dim = 2 + round % 2, items = draw_whole(&state, ITEM_LIMIT), count = draw_whole(&state, ITEM_LIMIT);
        draw_boxes(&state, dim, items, round % 4 == 0 ? 1e3 : 0.5, item);
        draw_boxes(&state, dim, count, 2, query);
        const brunt_team team = {1 + round % 3, NULL};
        ck_assert_int_eq(brunt_near_cells_make(&cells, &team, item, items, dim, NULL), 0);
        const queries q = {&cells, query};
        brunt_near_queries all = {.count = count, .find = found_by, .context = &q};
        if (round % 2) all.asked = asked;
        for (int i = 0; i < count; i++)
            if (i % 4 != 1) asked[all.asked_count++] = i;
        ck_assert_int_eq(brunt_near_list_make(&list, &team, &all, NULL), 0);
        for (int i = 0; i < count; i++) {
            int64_t at = list.first[i];
            for (int j = 0; j < items; j++) {
                bool meet = (i + j) % 3 != 0 && (i % 4 != 1 || !all.asked);
                for (int k = 0; k < dim; k++)
                    meet &= query[i].low[k] <= item[j].high[k] && item[j].low[k] <= query[i].high[k];
                if (!meet) continue;
                ck_assert(brunt_near_any(&cells, &query[i]));
                ck_assert_msg(at < list.first[i + 1] && list.item[at] == j, "round %d: %d does not find %d", round, i,
                              j);
                at++;
            }
            ck_assert_int_eq(at, list.first[i + 1]);
        }
    }
    brunt_near_cells_free(&cells), brunt_near_list_free(&list);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("barrier");
    TCase *parts = tcase_create("parts");
    tcase_add_test(parts, the_barrier_is_what_it_is_derived_from);
    tcase_add_test(parts, defaults_and_warnings);
    tcase_add_test(parts, derivatives_in_all_regions);
    tcase_add_test(parts, distances_are_the_least);
    tcase_add_test(parts, regions_join);
    tcase_add_test(parts, small_gaps_keep_their_digits);
    tcase_add_test(parts, parallel_edges_have_a_distance);
    tcase_add_test(parts, slivers_have_a_distance);
    tcase_add_test(parts, cross_products_of_edges);
    tcase_add_test(parts, search_finds_what_all_pairs_show);
    suite_add_tcase(suite, parts);
    return suite_main(suite);
}
