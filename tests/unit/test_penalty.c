// Labels: double
// Surfaces that may overlap: gaps with a sign, forces that go on through 0 and have a potential, how far a step may go.
#include "contact/barrier/barrier_function.h"
#include "contact/barrier/closest.h"
#include "contact/methods/gap_energy.h"
#include "tests/support/numbers.h"
#include "tests/support/suite.h"
#include "tests/support/term_check.h"

static const double K = 1e7, REACH = 0.06; // [Pa/m], [m]

static brunt_barrier_pair *overlapping(barrier_case *c, int32_t a, int32_t b, double distance) {
    brunt_barrier_pair *p = case_pair(c, a, b, distance, K);
    p->energy = brunt_penalty_at, p->reach = REACH;
    return p;
}

// Two polygons of n and m sides, the other 2 - deep above the one and `along` beside it.
static barrier_case *two_disks(int n, int m, double along, double deep, double distance, double place[2]) {
    static const double PI = 3.14159265358979323846;
    barrier_case *c = case_begin(2);
    double x[200][2];
    for (int i = 0; i < n; i++)
        x[i][0] = place[0] + cos(2 * PI * (i + 0.3) / n), x[i][1] = place[1] + sin(2 * PI * (i + 0.3) / n);
    case_polygon(c, 0, (const double(*)[2])x, n);
    for (int i = 0; i < m; i++)
        x[i][0] = place[0] + along + cos(2 * PI * i / m), x[i][1] = place[1] + 2 - deep + sin(2 * PI * i / m);
    case_polygon(c, 1, (const double(*)[2])x, m);
    overlapping(c, 0, 1, distance);
    return c;
}

// Curves are nearest where a search along them says so, and bend from their chords by no more than is told, and not by
// much less where they bend to one side.
START_TEST(curves_bend_from_their_chords) {
    uint64_t state = 7;
    double most = 0;
    for (int i = 0; i < 2000; i++) {
        const double t0[2] = {1, draw_between(&state, -0.5, 0.5)}, t1[2] = {1, draw_between(&state, -0.5, 0.5)};
        // Hermite's cubic with the tangents x1 - x2 and x3 - x0.
        const brunt_cubic curve = {4, {{1, 0, -2, 1}, {0, 1, 1, -1}, {0, -1, 2, -1}, {0, 0, -1, 1}}};
        const double at[4][3] = {{0, 0}, {1, 0}, {1 - t0[0], -t0[1]}, {t1[0], t1[1]}};
        const double q[3] = {3 * draw(&state) - 1, 2 * draw(&state) - 1, 0}, bends = brunt_cubic_bend(at, &curve);
        double s, d, least = INFINITY, off = 0;
        brunt_closest_of_cubic(q, at, &curve, &s, &d);
        for (int k = 0; k <= 1000; k++) {
            double w[BRUNT_CUBIC_PLACES], y[2] = {0};
            brunt_cubic_weights(&curve, k / 1000.0, w);
            for (int p = 0; p < 4; p++) y[0] += w[p] * at[p][0], y[1] += w[p] * at[p][1];
            least = fmin(least, hypot(y[0] - q[0], y[1] - q[1])), off = fmax(off, fabs(y[1]));
        }
        if (least < 0.2) ck_assert_double_le(d, least + 1e-9); // nearer than curves bend
        ck_assert_double_le(off, bends);
        most = fmax(most, off / bends);
    }
    ck_assert_double_gt(most, 0.9);
}
END_TEST

// A point above and below a floor: nothing above the distance, k times how deep it is below, without a step at 0; lost
// below the reach. What it is near to beside and does not touch, a ceiling, changes nothing.
START_TEST(pressure_is_by_depth) {
    static const double floor[][2] = {{5, 0}, {-5, 0}, {0, -5}}, area = 0.02;
    static const double ceiling[][2] = {{-5, 0.08}, {5, 0.08}, {0, 5}}, distance[] = {0, 0.01};
    for (int k = 0; k < 6; k++) {
        const int d = k % 2; // with a ceiling from 2 on, before the floor from 4 on
        barrier_case *c = case_begin(2);
        uint64_t state = 1;
        if (k >= 4) case_polygon(c, 2, ceiling, 3);
        case_polygon(c, 0, floor, 3);
        if (k == 2 || k == 3) case_polygon(c, 2, ceiling, 3);
        if (k >= 2) overlapping(c, 1, 2, distance[d]);
        case_particle(c, (double[3]){0.3, 0, 0}, area, 1, 1, &state);
        overlapping(c, 0, 1, distance[d]);
        case_ready(c);
        double *u = case_unknowns(c), *g = case_unknowns(c);
        static const double at[] = {0.02, 0.005, 1e-18, 0, -1e-18, -0.005, -0.059, -0.061};
        for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
            const brunt_term term = brunt_barrier_term(c->barrier);
            const double deep = fmax(distance[d] - at[i], 0);
            u[c->particle_node[0] * 2 + 1] = at[i];
            case_look(c, u, NULL);
            const double energy = case_energy(c, term, u);
            if (at[i] < -REACH) {
                ck_assert_double_infinite(energy);
                continue;
            }
            ck_assert_double_le(fabs(energy - area * K / 2 * deep * deep), 1e-11 * energy);
            case_gradient(c, term, u, g);
            ck_assert_double_le(fabs(g[c->particle_node[0] * 2 + 1] + area * K * deep), 1e-11 * area * K * deep);
            ck_assert_double_eq(g[c->particle_node[0] * 2], 0);
        }
        free(u), free(g), case_end(c);
    }
}
END_TEST

// A block with a notch and a wedge that fills it, a little more than it is wide: nodes within both its slopes and at
// its foot, beside disks that overlap; from 4 on the same with round rims.
static barrier_case *derivative_case(int which) {
    double place[2] = {0.1, 0.2};
    if (which >= 4) {
        barrier_case *c = derivative_case(which - 4);
        c->round = true;
        return c;
    }
    if (which < 2) return two_disks(24, 32, 0.2, 0.06, which ? 0.01 : 0, place);
    static const double notched[][2] = {{-1, -1}, {1, -1}, {1, 0}, {0.4, 0.01}, {0, -0.5}, {-0.4, 0}, {-1, 0}};
    static const double wedge[][2] = {{-0.012, -0.52}, {0.01, -0.51},  {0.25, -0.2},
                                      {0.42, -0.03},   {-0.41, -0.02}, {-0.2, -0.26}};
    barrier_case *c = case_begin(2);
    case_polygon(c, 0, notched, 7), case_polygon(c, 1, wedge, 6);
    overlapping(c, 0, 1, which == 3 ? 0.015 : 0);
    return c;
}

START_TEST(derivatives_are_those_of_differences) {
    for (int which = 0; which < 8; which++) {
        barrier_case *c = derivative_case(which);
        double *u = case_unknowns(c);
        uint64_t state = 12;
        c->pair[0].friction = 0.4, c->pair[0].slip_speed = 5;
        case_ready(c);
        for (int i = 0; i < c->nodes * 2; i++) u[i] = draw_between(&state, -1e-3, 1e-3);
        check_term(c, brunt_barrier_term(c->barrier), u, 2e-8, true);
        case_lag(c, u);
        for (int i = 0; i < c->nodes * 2; i++) u[i] += draw_between(&state, -4e-4, 4e-4);
        check_term(c, brunt_barrier_friction_term(c->barrier), u, 2e-8, true);
        ck_assert_int_eq(brunt_barrier_keep_slips(c->barrier, NULL), BRUNT_OK);
        brunt_barrier_follow(c->barrier, true);
        check_term(c, brunt_barrier_friction_term(c->barrier), u, 2e-8, false);
        free(u), case_end(c);
    }
}
END_TEST

// What pushes and rubs adds up to nothing; of what pushes, moments as well. A rigid motion of both stores nothing.
START_TEST(forces_are_opposite) {
    for (int which = 0; which < 8; which++) {
        barrier_case *c = derivative_case(which);
        double *u = case_unknowns(c), *g = case_unknowns(c), *moved = case_unknowns(c);
        uint64_t state = 5;
        c->pair[0].friction = 0.4, c->pair[0].slip_speed = 1e-3;
        case_ready(c);
        const brunt_term term = brunt_barrier_term(c->barrier), rubs = brunt_barrier_friction_term(c->barrier);
        for (int friction = 0; friction < 2; friction++) {
            double sum[3] = {0}, size = 0;
            for (int i = 0; i < c->nodes * 2; i++) u[i] = draw_between(&state, -1e-3, 1e-3);
            if (friction)
                case_lag(c, u);
            else
                case_look(c, u, NULL);
            case_gradient(c, friction ? rubs : term, u, g);
            for (int32_t v = 0; v < c->vertices; v++) {
                const double *f = &g[c->node[v] * 2], *d = &u[c->node[v] * 2];
                sum[0] += f[0], sum[1] += f[1], size += fabs(f[0]) + fabs(f[1]);
                sum[2] += (c->x[v][0] + d[0]) * f[1] - (c->x[v][1] + d[1]) * f[0];
            }
            ck_assert_double_gt(size, 0);
            ck_assert_double_lt(hypot(sum[0], sum[1]), 1e-12 * size);
            if (!friction) ck_assert_double_lt(fabs(sum[2]), 1e-12 * size);
        }
        case_look(c, u, NULL);
        const double energy = case_energy(c, term, u), co = cos(0.3), si = sin(0.3);
        for (int32_t v = 0; v < c->vertices; v++) {
            const double *d = &u[c->node[v] * 2], x = c->x[v][0] + d[0], y = c->x[v][1] + d[1];
            moved[c->node[v] * 2] = co * x - si * y + 0.7 - c->x[v][0];
            moved[c->node[v] * 2 + 1] = si * x + co * y - 0.4 - c->x[v][1];
        }
        case_look(c, moved, NULL);
        ck_assert_double_eq_tol(case_energy(c, term, moved), energy, 1e-11 * energy);
        free(u), free(g), free(moved), case_end(c);
    }
}
END_TEST

// The same as its mirror image, with the bodies the other way round, and with rims numbered from another vertex on.
START_TEST(order_and_mirror_do_not_matter) {
    double energy[8];
    for (int k = 0; k < 8; k++) {
        const int which = k % 4, mirrored = which == 1, swapped = which == 2, from = which == 3 ? 5 : 0;
        barrier_case *of = derivative_case(0), *c = case_begin(2);
        c->round = k >= 4;
        const double sign = mirrored ? -1 : 1;
        for (int body = 0; body < 2; body++) {
            double x[64][2];
            int n = 0, own = swapped ? 1 - body : body;
            for (int32_t v = 0; v < of->vertices; v++)
                if (of->body[v] == own) x[n][0] = sign * of->x[v][0], x[n++][1] = of->x[v][1];
            double y[64][2];
            for (int i = 0; i < n; i++) memcpy(y[i], x[((mirrored ? n - i : i) + from) % n], sizeof y[i]);
            case_polygon(c, body, (const double(*)[2])y, n);
        }
        overlapping(c, 0, 1, 0);
        case_ready(c);
        double *u = case_unknowns(c);
        case_look(c, u, NULL);
        energy[k] = case_energy(c, brunt_barrier_term(c->barrier), u);
        ck_assert_double_gt(energy[k], 0);
        ck_assert_double_eq_tol(energy[k], energy[k - which], 1e-12 * energy[k]);
        free(u), case_end(c), case_end(of);
    }
    ck_assert_double_gt(fabs(energy[4] - energy[0]), 0.01 * energy[0]);
}
END_TEST

// Right below a corner both sides are as near: each has half of it, and nothing pushes to one of them.
START_TEST(corner_on_corner_is_straight) {
    static const double roof[][2] = {{1, -0.25}, {0, 0}, {-1, -0.25}, {0, -2}},
                        floor[][2] = {{0, -0.02}, {1, 0.23}, {0, 2}, {-1, 0.23}};
    barrier_case *c = case_begin(2);
    case_polygon(c, 0, roof, 4), case_polygon(c, 1, floor, 4);
    overlapping(c, 0, 1, 0);
    case_ready(c);
    double *u = case_unknowns(c), *g = case_unknowns(c);
    case_look(c, u, NULL);
    case_gradient(c, brunt_barrier_term(c->barrier), u, g);
    const double cosine = 1 / sqrt(1 + 0.0625), depth = 0.02 * cosine;
    double area = 0;
    for (int v = 0; v < c->vertices; v++)
        if (v == 1 || v == 4) area += brunt_barrier_vertex_area(c->barrier, v) / 2;
    double push = 0;
    for (int v = 4; v < 8; v++) push += g[2 * v + 1];
    for (int v = 0; v < 8; v++)
        ck_assert_double_eq_tol(g[2 * v],
                                -g[2 * (v == 0   ? 2
                                        : v == 2 ? 0
                                        : v == 5 ? 7
                                        : v == 7 ? 5
                                                 : v)],
                                1e-12 * fabs(push));
    ck_assert_double_eq_tol(-push, area * K * depth * cosine, 1e-12 * fabs(push));
    free(u), free(g), case_end(c);
}
END_TEST

// Beside a sharp corner, right before one face and behind the other's: outside. Within, the way out is over the nearer
// face. Right on one, flush, nothing pushes.
START_TEST(sharp_corners_have_an_outside) {
    static const double wedge[][2] = {{0, 0}, {3, -0.4}, {3, 0.4}},
                        place[][2] = {{0.2, 0.032}, {0.2, 0.02}, {0.2, -0.02}, {0.3, 0.04}};
    const double slope = 0.4 / 3, cosine = 1 / sqrt(1 + slope * slope), area = 0.02;
    for (int i = 0; i < 4; i++) {
        barrier_case *c = case_begin(2);
        uint64_t state = 1;
        case_polygon(c, 0, wedge, 3);
        case_particle(c, (double[3]){place[i][0], place[i][1], 0}, area, 1, 1, &state);
        overlapping(c, 0, 1, 0);
        case_ready(c);
        double *u = case_unknowns(c), *g = case_unknowns(c);
        const brunt_term term = brunt_barrier_term(c->barrier);
        const double deep = fmax((slope * place[i][0] - fabs(place[i][1])) * cosine, 0);
        case_look(c, u, NULL);
        case_gradient(c, term, u, g);
        ck_assert_double_le(fabs(case_energy(c, term, u) - area * K / 2 * deep * deep), 1e-12);
        const double up = g[2 * c->particle_node[0] + 1];
        ck_assert(i == 1 ? up < 0 : i == 2 ? up > 0 : fabs(up) < 1e-9);
        free(u), free(g), case_end(c);
    }
}
END_TEST

// However far a way goes, no point gets deeper than it may be within one part of it; beyond that energies are infinite.
static void check_steps(bool round) {
    double place[2] = {0, 0};
    barrier_case *c = two_disks(24, 32, 0.1, -0.03, 0, place);
    c->round = round;
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    for (int32_t v = 0; v < c->vertices; v++)
        if (c->body[v] == 1) p[2 * c->node[v] + 1] = -1;
    case_look(c, u, p);
    const double part = case_limit(c, u, p, 1);
    ck_assert_double_ge(part, REACH / 2 * (1 - 1e-12));
    ck_assert_double_lt(part, 0.03 + REACH);
    for (double way = 0; way < 0.4; way += 0.01) { // from touching on ever more, then infinite
        for (int32_t i = 0; i < c->nodes * 2; i++) u[i] = way * p[i];
        case_look(c, u, NULL);
        const double energy = case_energy(c, term, u);
        ck_assert(way < 0.03 ? energy == 0 : way > 0.04 && way < 0.08 ? energy > 0 && energy < INFINITY : true);
        if (way > 0.1 && way < 0.14) ck_assert_double_infinite(energy);
    }
    free(u), free(p), case_end(c);
}

START_TEST(steps_are_short_beside_the_reach) { check_steps(false), check_steps(true); }
END_TEST

static void check_threads(bool round) {
    double *first = NULL;
    for (int threads = 1; threads <= 5; threads++) {
        double place[2] = {3, -7};
        barrier_case *c = two_disks(96, 120, 0.02, 0.02, 0.004, place);
        c->threads = threads, c->round = round;
        case_ready(c);
        double *u = case_unknowns(c), *g = case_unknowns(c);
        case_look(c, u, NULL);
        case_gradient(c, brunt_barrier_term(c->barrier), u, g);
        if (!first) first = case_unknowns(c), memcpy(first, g, (size_t)c->nodes * 2 * sizeof *g);
        ck_assert_mem_eq(first, g, (size_t)c->nodes * 2 * sizeof *g);
        free(u), free(g), case_end(c);
    }
    free(first);
}

START_TEST(threads_give_the_same_bits) { check_threads(false), check_threads(true); }
END_TEST

// ------------------------------------------------------------------------------------------------- round rims

static const double PI = 3.14159265358979323846;

// Of a disk of radius 1 about (0.3, -0.2): evenly spaced, or with edges up to 1.6 times as long as others.
static void circle(int n, bool even, double (*x)[2]) {
    for (int i = 0; i < n; i++) {
        const double angle = 2 * PI * (i + (even ? 0.3 : 0.12 * sin(2 * i))) / n;
        x[i][0] = 0.3 + cos(angle), x[i][1] = -0.2 + sin(angle);
    }
}

// [m] The least gap that a body has beside a point of another, at a distance from the middle of the disk.
static double gap_within(const double (*rim)[2], int n, bool round, double reach, double distance, double angle) {
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    c->round = round;
    case_polygon(c, 0, rim, n);
    case_particle(c, (double[3]){0.3 + distance * cos(angle), -0.2 + distance * sin(angle), 0}, 0.01, 1, 1, &state);
    overlapping(c, 0, 1, reach / 3)->reach = reach;
    case_ready(c);
    double *u = case_unknowns(c);
    const double gap = case_report(c, u, NULL).least_gap;
    free(u), case_end(c);
    return gap;
}

static double gap_beside(const double (*rim)[2], int n, bool round, double distance, double angle) {
    return gap_within(rim, n, round, REACH, distance, angle);
}

// Beside a disk of n edges the gap is that of a circle to 1.5e-3 (pi / n)^6, wherever it is asked for; edges alone are
// up to 1 - cos(pi / n) inside of it.
START_TEST(rims_of_disks_are_circles) {
    static const int edges[] = {12, 24, 32, 64};
    for (int k = 0; k < 8; k++) {
        const int n = k == 1 ? 16 : edges[k / 2]; // 12 uneven ones have corners of more than 30 degrees
        double x[64][2], off[2] = {0};
        circle(n, k % 2 == 0, x);
        const double longest = (k % 2 ? 1.25 : 1) * PI / n;
        for (int i = 0; i < 60; i++)
            for (int round = 0; round < 2; round++)
                for (int side = -1; side < 2; side++) {
                    const double gap = gap_beside((const double(*)[2])x, n, round, 1 + 0.01 * side, 0.1234 * i);
                    if (round || gap < 0.02) off[round] = fmax(off[round], fabs(gap - 0.01 * side));
                }
        ck_assert_double_gt(off[0], 0.3 * (1 - cos(longest)));
        ck_assert_double_lt(off[1], 1.5e-3 * pow(longest, 6) + 1e-14);
    }
    // Over the middle of an edge, which is much farther away than what pushes is looked for.
    double x[12][2];
    for (int i = 0; i < 12; i++)
        x[i][0] = 0.3 + cos(2 * PI * (i + 0.5) / 12), x[i][1] = -0.2 + sin(2 * PI * (i + 0.5) / 12);
    const double gap = gap_within((const double(*)[2])x, 12, true, 0.006, 0.998, 0);
    ck_assert_double_eq_tol(gap, -0.002, 1e-6);
}
END_TEST

// What a disk of 32 edges pushes with, as deep in a plane as its edges lie within its circle (half an edge to either
// side touches then), or two of them in each other, however they are turned: least and greatest.
static void turned_pushes(bool plane, bool round, double range[2]) {
    const double deep = 1 - cos(PI / 32);
    range[0] = INFINITY, range[1] = 0;
    for (int turn = 0; turn < 25; turn++) {
        barrier_case *c = case_begin(2);
        double x[32][2];
        c->round = round;
        for (int body = 0; body < (plane ? 1 : 2); body++) {
            for (int i = 0; i < 32; i++) {
                const double angle = 2 * PI * (i + (body ? 0.2 * (turn % 5) : 0.04 * turn)) / 32;
                x[i][0] = cos(angle), x[i][1] = (2 - deep) * body + sin(angle);
            }
            case_polygon(c, body, (const double(*)[2])x, 32);
        }
        if (plane)
            c->plane[c->planes++] = (brunt_barrier_plane){.origin = {0, 1 - deep},
                                                          .normal = {0, -1},
                                                          .node = -1,
                                                          .stiffness = K,
                                                          .energy = brunt_penalty_at,
                                                          .reach = REACH};
        else
            overlapping(c, 0, 1, 0);
        case_ready(c);
        double *u = case_unknowns(c);
        brunt_barrier_force force;
        case_report(c, u, &force);
        const double push = fabs(force.normal[1]);
        range[0] = fmin(range[0], push), range[1] = fmax(range[1], push);
        free(u), case_end(c);
    }
}

// The integral of k (deep - s^2 / 2) over a plane, of k (deep - s^2) between two disks.
START_TEST(round_disks_push_as_they_do_however_they_are_turned) {
    const double deep = 1 - cos(PI / 32), whole = K * 4 / 3.0 * deep * sqrt(deep);
    for (int plane = 0; plane < 2; plane++) {
        const double wanted = plane ? whole * sqrt(2) : whole;
        double range[2];
        turned_pushes(plane, false, range);
        ck_assert_double_gt(range[1] - range[0], 0.5 * wanted);
        turned_pushes(plane, true, range);
        ck_assert_double_gt(range[0], 0.9 * wanted);
        ck_assert_double_lt(range[1], 1.1 * wanted);
    }
}
END_TEST

// Straight sides and corners are what they are without: the same bits of gaps beside them. A polygon of 12 edges, whose
// corners are of 30 degrees, is round, one of 11 is not; nor is a side beside others of less than half its length.
START_TEST(sides_and_corners_stay) {
    static const double box[][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {-0.2, 1}, {-1, 1}, {-1, 0.5}};
    static const double long_side[][2] = {{-1, 0},      {-1.1, -0.02}, {-1.2, -0.06}, {0, -1},
                                          {1.2, -0.06}, {1.1, -0.02},  {1, 0}};
    double x[12][2];
    for (int i = 0; i < 40; i++) {
        const double angle = 2 * PI * i / 40;
        ck_assert_double_eq(gap_beside(box, 8, true, 0.9, angle), gap_beside(box, 8, false, 0.9, angle));
        for (int n = 11; n < 13; n++) {
            circle(n, true, x);
            const double gap[2] = {gap_beside((const double(*)[2])x, n, false, 0.99, angle),
                                   gap_beside((const double(*)[2])x, n, true, 0.99, angle)};
            ck_assert(n == 11 ? gap[0] == gap[1] : gap[1] < gap[0] + 1e-15);
        }
    }
    for (int i = 0; i < 7; i++) // middles of the long side, -0.3 .. 0.3 of it
        ck_assert_double_eq(gap_beside(long_side, 7, true, 0.21, PI / 2 + 0.2 * (i - 3)),
                            gap_beside(long_side, 7, false, 0.21, PI / 2 + 0.2 * (i - 3)));
}
END_TEST

// Nodes that have been pressed onto a line have a straight rim between them.
START_TEST(a_rim_that_is_pressed_flat_is_flat) {
    double x[32][2];
    for (int i = 0; i < 9; i++) {
        barrier_case *c = case_begin(2);
        uint64_t state = 1;
        circle(32, true, x);
        case_polygon(c, 0, (const double(*)[2])x, 32);
        case_particle(c, (double[3]){0.3 + 0.04 * (i - 4), 0.585, 0}, 0.01, 1, 1, &state);
        overlapping(c, 0, 1, 0);
        c->round = true;
        case_ready(c);
        double *u = case_unknowns(c);
        for (int32_t v = 0; v < c->vertices; v++) u[2 * v + 1] = fmin(0.59 - c->x[v][1], 0);
        ck_assert_double_eq_tol(case_report(c, u, NULL).least_gap, -0.005, 1e-15);
        free(u), case_end(c);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------------- joined

// A point of area .02 above a floor, or a plane: joined it pushes and pulls by k times the gap, and along the surface
// as well where there is friction; from a millionth of the shortest edge on it does not, and never without.
static void check_joined(bool plane, double friction, double gap, bool joined) {
    static const double floor[][2] = {{5, 0}, {-5, 0}, {0, -5}}, area = 0.02;
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    case_polygon(c, 0, floor, 3);
    case_particle(c, (double[3]){0.3, 0, 0}, area, 1, 1, &state);
    if (plane)
        c->plane[c->planes++] = (brunt_barrier_plane){.normal = {0, 1},
                                                      .node = -1,
                                                      .stiffness = K,
                                                      .friction = friction,
                                                      .slip_speed = 1e-6,
                                                      .energy = brunt_penalty_at,
                                                      .reach = REACH};
    else
        overlapping(c, 0, 1, 0)->friction = friction;
    case_ready(c);
    double *u = case_unknowns(c), *g = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    const int64_t own = c->particle_node[0] * 2, all = c->nodes * 2;
    u[own + 1] = gap;
    if (joined) brunt_barrier_join(c->barrier, true);
    case_look(c, u, NULL);
    case_gradient(c, term, u, g);
    double *h = take_dense(c, term, u);
    const bool within = gap < 5e-6, both = joined && within;
    const double stiff = both || gap < 0 ? area * K : 0;
    ck_assert_double_eq_tol(g[own + 1], stiff * gap, 1e-9 * area * K * fabs(gap));
    ck_assert_double_eq(g[own], 0);
    ck_assert_double_eq_tol(h[(own + 1) * all + own + 1], stiff, 1e-9 * area * K);
    ck_assert_double_eq_tol(h[own * all + own], both && friction > 0 ? stiff : 0, 1e-9 * area * K);
    for (int64_t i = 0; i < all && !plane; i++) { // a translation of both does nothing
        double sum = 0;
        for (int64_t j = i % 2; j < all; j += 2) sum += h[i * all + j];
        ck_assert_double_eq_tol(sum, 0, 1e-9 * area * K);
    }
    // And nothing stays of it.
    if (joined) brunt_barrier_join(c->barrier, false);
    case_look(c, u, NULL);
    case_gradient(c, term, u, g);
    ck_assert_double_eq_tol(g[own + 1], gap < 0 ? area * K * gap : 0, 1e-9 * area * K * fabs(gap));
    free(u), free(g), free(h), case_end(c);
}

START_TEST(joined_surfaces_hold_both_ways) {
    static const double gap[] = {-1e-3, -1e-7, -1e-17, 1e-17, 1e-7, 9e-6, 1e-3}, friction[] = {0, 0.3};
    for (int plane = 0; plane < 2; plane++)
        for (int k = 0; k < 2; k++)
            for (size_t i = 0; i < sizeof gap / sizeof *gap; i++)
                for (int joined = 0; joined < 2; joined++) check_joined(plane, friction[k], gap[i], joined);
}
END_TEST

// Two circles that touch are joined wherever on their rims they do, by little more than one place of each.
START_TEST(circles_that_touch_are_joined) {
    for (int turn = 0; turn < 16; turn++) {
        barrier_case *c = case_begin(2);
        double x[32][2];
        c->round = true;
        for (int body = 0; body < 2; body++) {
            for (int i = 0; i < 32; i++) {
                const double angle = 2 * PI * (i + (body ? 0.11 : 1.0 / 16) * turn) / 32;
                x[i][0] = cos(angle), x[i][1] = 2 * body + sin(angle);
            }
            case_polygon(c, body, (const double(*)[2])x, 32);
        }
        overlapping(c, 0, 1, 0);
        case_ready(c);
        double *u = case_unknowns(c), sum = 0;
        brunt_barrier_join(c->barrier, true);
        case_look(c, u, NULL);
        const int64_t all = c->nodes * 2;
        double *h = take_dense(c, brunt_barrier_term(c->barrier), u);
        for (int64_t i = 0; i < 32; i++)
            for (int64_t j = 0; j < 32; j++) sum += h[(2 * i + 1) * all + 2 * j + 1];
        const double place = K * 2 * sin(PI / 32) / 4 / 2; // half of what a point between vertices stands for
        ck_assert_double_ge(sum, 0.99 * place);
        ck_assert_double_le(sum, 4.01 * place);
        free(u), free(h), case_end(c);
    }
}
END_TEST

// 1 / E* is the sum of those of both; a plane's is 0.
START_TEST(stiffness_is_twenty_of_what_gives) {
    ck_assert_double_eq_tol(brunt_penalty_default_stiffness(3e6, 6e6, 0.01), 20 * 2e6 / 0.01, 1);
    ck_assert_double_eq_tol(brunt_penalty_default_stiffness(3e6, INFINITY, 0.01), 20 * 3e6 / 0.01, 1);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("penalty");
    TCase *tests = tcase_create("penalty");
    tcase_add_test(tests, curves_bend_from_their_chords);
    tcase_add_test(tests, pressure_is_by_depth);
    tcase_add_test(tests, derivatives_are_those_of_differences);
    tcase_add_test(tests, forces_are_opposite);
    tcase_add_test(tests, order_and_mirror_do_not_matter);
    tcase_add_test(tests, corner_on_corner_is_straight);
    tcase_add_test(tests, sharp_corners_have_an_outside);
    tcase_add_test(tests, steps_are_short_beside_the_reach);
    tcase_add_test(tests, threads_give_the_same_bits);
    tcase_add_test(tests, rims_of_disks_are_circles);
    tcase_add_test(tests, round_disks_push_as_they_do_however_they_are_turned);
    tcase_add_test(tests, sides_and_corners_stay);
    tcase_add_test(tests, a_rim_that_is_pressed_flat_is_flat);
    tcase_add_test(tests, joined_surfaces_hold_both_ways);
    tcase_add_test(tests, circles_that_touch_are_joined);
    tcase_add_test(tests, stiffness_is_twenty_of_what_gives);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
