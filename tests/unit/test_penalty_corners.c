// Labels: double
// Corners of surfaces that may overlap: what points within them store, that it goes on without a step or a kink where
// they pass around one, and that forces and their slopes are those of it.
#include "contact/barrier/closest.h"
#include "contact/methods/gap_energy.h"
#include "tests/support/numbers.h"
#include "tests/support/suite.h"
#include "tests/support/term_check.h"

static const double K = 1e7, REACH = 0.06, AREA = 0.02; // [Pa/m], [m], [m]
static const double PI = 3.14159265358979323846;

static brunt_barrier_pair *overlapping(barrier_case *c, int32_t a, int32_t b, double distance) {
    brunt_barrier_pair *p = case_pair(c, a, b, distance, K);
    p->energy = brunt_penalty_at, p->reach = REACH;
    return p;
}

// A triangle with a corner of `angle` at (2, 3), one face along x, all turned by `turn`; a point at the corner.
static barrier_case *triangle_case(double angle, double turn, double distance) {
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    const double x[3][2] = {{2, 3}, {2 + cos(turn), 3 + sin(turn)}, {2 + cos(angle + turn), 3 + sin(angle + turn)}};
    case_polygon(c, 0, x, 3);
    case_particle(c, (double[3]){2, 3, 0}, AREA, 1, 1, &state);
    overlapping(c, 0, 1, distance);
    c->pair[0].friction = 0.4, c->pair[0].slip_speed = 1;
    case_ready(c);
    return c;
}

// [J] With the point so far from the corner, and [N] its gradient.
static double energy_at(barrier_case *c, const double at[2], double g[2]) {
    double *u = case_unknowns(c), *all = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    const int32_t node = c->particle_node[0];
    u[node * 2] = at[0], u[node * 2 + 1] = at[1];
    case_look(c, u, NULL);
    const double energy = case_energy(c, term, u);
    if (g) case_gradient(c, term, u, all), g[0] = all[node * 2], g[1] = all[node * 2 + 1];
    free(u), free(all);
    return energy;
}

// What a point x and y deep within both faces stores, of k l^2 / 2 times its area (barrier_corner.c).
static double shape(double x, double y) {
    return x >= 1 || y >= 1 ? pow(fmin(x, y), 2) : x * x * y * y * (1 + 2 * (1 - x) * (1 - y) / (1 - x * y));
}

// Behind both faces by the closed form, of sharp corners with less of a size; beside either nothing.
START_TEST(energy_within_a_corner_is_that_of_both_faces) {
    static const double angle[] = {PI / 2, PI / 3, 2 * PI / 3}, distance[] = {0, 0.01};
    for (int k = 0; k < 6; k++) {
        const double a = angle[k % 3], d = distance[k / 3], size = 0.75 * REACH * fmin(1, tan(a / 2));
        barrier_case *c = triangle_case(a, 0.2, d);
        for (double x = -0.15; x < 1.15; x += 0.1)
            for (double y = -0.15; y < 1.15; y += 0.1) {
                // Gaps d - l x below face 1, d - l y beside face 2, whose normal is (-sin a, cos a).
                const double down = size * x - d, across = (down * cos(a) - (d - size * y)) / sin(a);
                const double at[2] = {across * cos(0.2) - down * sin(0.2), across * sin(0.2) + down * cos(0.2)};
                const double scale = AREA * K / 2 * size * size, wanted = x > 0 && y > 0 ? scale * shape(x, y) : 0;
                ck_assert_double_eq_tol(energy_at(c, at, NULL), wanted, 1e-10 * scale);
            }
        case_end(c);
    }
}
END_TEST

// Around a corner, from beside one face to beside the other, near it and farther within, on circles about where the
// faces that push meet: energies are those of forces along the way, and forces go on without a step.
START_TEST(energy_goes_on_around_a_corner) {
    static const double angle[] = {PI / 2, PI / 3, 2 * PI / 3, 2.2}, deep[] = {0.2, 0.5, 0.8, 1.2};
    enum { STEPS = 4000 };
    for (int k = 0; k < 32; k++) {
        const double a = angle[k % 4], d = k / 16 ? 0.01 : 0, size = 0.75 * REACH * fmin(1, tan(a / 2)),
                     radius = deep[k / 4 % 4] * size / sin(a / 2), step = 2 * PI / STEPS;
        const bool beyond = deep[k / 4 % 4] > 1; // the nearer face alone has it where both are as deep
        barrier_case *c = triangle_case(a, 0, d);
        const double tip[2] = {-d / sin(a / 2) * cos(a / 2), -d};
        double before = 0, now = 0, size_of_force = AREA * K * radius, worst = 0, most = 0;
        for (int i = 0; i <= STEPS + 1; i++) {
            const double t = a / 2 + PI + i * step; // from outside
            const double at[2] = {tip[0] + radius * cos(t), tip[1] + radius * sin(t)};
            double g[2];
            const double energy = energy_at(c, at, g), force = g[1] * cos(t) - g[0] * sin(t);
            const bool kink = beyond && fabs(sin((t - a / 2) / 2)) < 0.02;
            // Simpson's rule is not needed: the mean of both ends is off by the third derivative.
            if (i > 0 && !kink) {
                worst = fmax(worst, fabs(energy - before - (force + now) / 2 * radius * step));
                most = fmax(most, fabs(force - now));
            }
            before = energy, now = force;
        }
        ck_assert_double_lt(worst, 1e-6 * size_of_force * radius);
        ck_assert_double_lt(most, 40 * step * size_of_force);
        case_end(c);
    }
}
END_TEST

// A node of a flat floor that comes to be under a block's corner, as deep as penalties are: what pushes it sideways is
// little of what presses it where it is well within, and never draws it in.
START_TEST(a_corner_is_no_tooth) {
    barrier_case *c = triangle_case(PI / 2, 0, 0);
    const double size = 0.75 * REACH, deep = 0.03 * size;
    double most = 0, g[2];
    for (double along = -size; along < 2 * size; along += size / 50) {
        energy_at(c, (double[2]){along, deep}, g);
        ck_assert_double_ge(g[0], 0);
        ck_assert_double_ge(g[1], 0);
        most = fmax(most, g[0]);
    }
    ck_assert_double_eq_tol(g[1], AREA * K * deep, 1e-9 * g[1]);
    ck_assert_double_lt(most, 0.03 * g[1]);
    ck_assert_double_gt(most, 0.015 * g[1]);
    case_end(c);
}
END_TEST

// Of a polygon of n sides: what a point stores that is a little within one of its corners, of what it does by its
// nearest side alone.
static double part_within(int n) {
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    double x[12][2];
    for (int i = 0; i < n; i++) x[i][0] = cos(2 * PI * i / n), x[i][1] = sin(2 * PI * i / n);
    case_polygon(c, 0, (const double(*)[2])x, n);
    case_particle(c, (double[3]){0.99, 1e-4, 0}, AREA, 1, 1, &state);
    overlapping(c, 0, 1, 0);
    case_ready(c);
    const double side[2] = {cos(PI / n), sin(PI / n)}, deep = (1 - 0.99) * side[0] - 1e-4 * side[1];
    const double part = energy_at(c, (double[2]){0, 0}, NULL) / (AREA * K / 2 * deep * deep);
    case_end(c);
    return part;
}

// Turns of 45 degrees and less are none: rims are what they were, by their nearest side.
START_TEST(smooth_rims_have_no_corners) {
    for (int n = 8; n <= 12; n++) ck_assert_double_eq_tol(part_within(n), 1, 1e-10);
    for (int n = 3; n <= 7; n++) ck_assert_double_lt(part_within(n), 0.5);
}
END_TEST

// A block on another, both with corners beside nodes of the other, turned; which: 1 pushes from a distance on.
static barrier_case *blocks_case(int which) {
    barrier_case *c = case_begin(2);
    case_rectangle(c, 0, (double[2]){-1, -1}, (double[2]){1, 0}, 4);
    case_rectangle(c, 1, (double[2]){-0.52, -0.012}, (double[2]){0.98, 1.488}, 3);
    for (int32_t v = 0; v < c->vertices; v++) {
        const double x = c->x[v][0], y = c->x[v][1];
        c->x[v][0] = 3 + x * cos(0.4) - y * sin(0.4), c->x[v][1] = 5 + x * sin(0.4) + y * cos(0.4);
    }
    overlapping(c, 0, 1, which ? 0.01 : 0);
    c->pair[0].friction = 0.4, c->pair[0].slip_speed = 5;
    case_ready(c);
    return c;
}

START_TEST(derivatives_are_those_of_differences) {
    for (int which = 0; which < 2; which++) {
        barrier_case *c = blocks_case(which);
        double *u = case_unknowns(c);
        uint64_t state = 12;
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

// Where surfaces that slip come apart the weights of a corner follow both gaps: of a point beside faces that stay
// forces are those of the energy.
START_TEST(associated_forces_are_those_of_differences) {
    static const double angle[] = {PI / 2, PI / 3, 2 * PI / 3};
    for (int k = 0; k < 6; k++) {
        barrier_case *c = triangle_case(angle[k % 3], 0.2, k < 3 ? 0 : 0.01);
        double *from = case_unknowns(c), *u = case_unknowns(c), *g = case_unknowns(c);
        const brunt_term term = brunt_barrier_friction_term(c->barrier);
        const double middle = angle[k % 3] / 2 + 0.2, h = 1e-8;
        double *own = &u[c->particle_node[0] * 2], *began = &from[c->particle_node[0] * 2];
        began[0] = 0.020 * cos(middle - 0.3), began[1] = 0.020 * sin(middle - 0.3);
        own[0] = 0.021 * cos(middle - 0.2), own[1] = 0.021 * sin(middle - 0.2);
        brunt_barrier_associate(c->barrier, from);
        case_look(c, u, NULL);
        case_gradient(c, term, u, g);
        for (int i = 0; i < 2; i++) {
            const double was = own[i], force = g[c->particle_node[0] * 2 + i];
            own[i] = was + h;
            const double more = case_energy(c, term, u);
            own[i] = was - h;
            const double less = case_energy(c, term, u);
            own[i] = was;
            ck_assert_double_gt(fabs(force), 0);
            ck_assert_double_eq_tol((more - less) / (2 * h), force, 1e-6 * fabs(force));
        }
        free(from), free(u), free(g), case_end(c);
    }
}
END_TEST

// What pushes adds up to nothing, and its moments; a rigid motion of both stores nothing.
START_TEST(forces_are_opposite) {
    for (int which = 0; which < 2; which++) {
        barrier_case *c = blocks_case(which);
        double *u = case_unknowns(c), *g = case_unknowns(c), *moved = case_unknowns(c), sum[3] = {0}, size = 0;
        const brunt_term term = brunt_barrier_term(c->barrier);
        case_look(c, u, NULL);
        case_gradient(c, term, u, g);
        for (int32_t v = 0; v < c->vertices; v++) {
            const double *f = &g[c->node[v] * 2], x = c->x[v][0], y = c->x[v][1];
            sum[0] += f[0], sum[1] += f[1], sum[2] += x * f[1] - y * f[0], size += fabs(f[0]) + fabs(f[1]);
            moved[c->node[v] * 2] = cos(0.3) * x - sin(0.3) * y + 0.7 - x;
            moved[c->node[v] * 2 + 1] = sin(0.3) * x + cos(0.3) * y - 0.4 - y;
        }
        ck_assert_double_gt(size, 0);
        for (int k = 0; k < 3; k++) ck_assert_double_lt(fabs(sum[k]), 1e-12 * size);
        const double energy = case_energy(c, term, u);
        case_look(c, moved, NULL);
        ck_assert_double_eq_tol(case_energy(c, term, moved), energy, 1e-11 * energy);
        free(u), free(g), free(moved), case_end(c);
    }
}
END_TEST

// What may couple on a way has room for what faces of a corner that is met there couple.
START_TEST(couplings_on_a_way_have_room) {
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    case_rectangle(c, 0, (double[2]){0, 0}, (double[2]){1, 1}, 1);
    case_particle(c, (double[3]){0, 0, 0}, AREA, 1, 1, &state);
    overlapping(c, 0, 1, 0);
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    const brunt_team team = {1, NULL};
    const int32_t node = c->particle_node[0];
    u[node * 2] = -0.01, u[node * 2 + 1] = 0.004, p[node * 2] = 0.03;
    case_look(c, u, p);
    const brunt_stencils stencils = term.ops->stencils(term.self);
    const brunt_pattern pattern = {2, c->nodes, &stencils, 1, false, NULL};
    brunt_block_matrix m = {0};
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
    for (int i = 0; i < c->nodes * 2; i++) u[i] += 0.9 * p[i];
    term.ops->hessian(term.self, &team, u, false, &m);
    double size = 0;
    for (int64_t k = 0; k < m.first[m.nodes] * 4; k++) size = fmax(size, fabs(m.value[k]));
    ck_assert_double_gt(size, 0);
    brunt_block_matrix_free(&m);
    free(u), free(p), case_end(c);
}
END_TEST

// What is told of the least gap is that of the nearer face, however deep a point is behind the other.
START_TEST(gaps_are_told_of_the_nearer_face) {
    barrier_case *c = triangle_case(PI / 2, 0, 0);
    double *u = case_unknowns(c);
    const int32_t node = c->particle_node[0];
    u[node * 2] = 0.04, u[node * 2 + 1] = 0.004;
    ck_assert_double_eq_tol(case_report(c, u, NULL).least_gap, -0.004, 1e-12);
    ck_assert_double_eq_tol(brunt_barrier_least_gap(c->barrier), -0.004, 1e-12);
    free(u), case_end(c);
}
END_TEST

// Joined surfaces touch where they are, within corners as elsewhere: springs of the whole area.
START_TEST(joined_corners_are_whole) {
    barrier_case *c = triangle_case(PI / 2, 0, 0);
    double g[2];
    brunt_barrier_join(c->barrier, true);
    energy_at(c, (double[2]){0.01, 0.004}, g);
    ck_assert_double_eq_tol(g[1], AREA * K * 0.004, 1e-9 * AREA * K * 0.004);
    case_end(c);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("penalty corners");
    TCase *tests = tcase_create("corners");
    tcase_add_test(tests, energy_within_a_corner_is_that_of_both_faces);
    tcase_add_test(tests, energy_goes_on_around_a_corner);
    tcase_add_test(tests, a_corner_is_no_tooth);
    tcase_add_test(tests, smooth_rims_have_no_corners);
    tcase_add_test(tests, derivatives_are_those_of_differences);
    tcase_add_test(tests, associated_forces_are_those_of_differences);
    tcase_add_test(tests, forces_are_opposite);
    tcase_add_test(tests, couplings_on_a_way_have_room);
    tcase_add_test(tests, gaps_are_told_of_the_nearer_face);
    tcase_add_test(tests, joined_corners_are_whole);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
