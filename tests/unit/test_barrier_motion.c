// Labels: double
// How far a step may go, planes, and friction by closed forms.
#include "contact/barrier/barrier_function.h"
#include "tests/support/barrier_case.h"
#include "tests/support/suite.h"

// -------------------------------------------------------------------------------------------------------- limit

static double gap_at(barrier_case *c, const double *u, const double *p, double t, double *at) {
    for (int i = 0; i < c->nodes * c->dim; i++) at[i] = u[i] + t * p[i];
    return case_report(c, at, NULL).least_gap;
}

// Two edges (2D) or triangles (3D) anywhere, of bodies that may meet; all gaps are within the distance.
static barrier_case *two_features(int dim, uint64_t *state) {
    barrier_case *c = case_begin(dim);
    for (int body = 0; body < 2; body++) {
        const int32_t first = c->vertices;
        for (int i = 0; i < dim; i++)
            case_vertex(c, draw(state), draw(state), dim == 3 ? draw(state) + body * 0.7 : 0, body);
        case_facet(c, first, first + 1, dim == 3 ? first + 2 : -1, -1);
    }
    case_pair(c, 0, 1, 20, 1);
    return c;
}

// A point and an edge or triangle: one pair, so that one gap says when the step has to end.
static barrier_case *one_pair(int dim, uint64_t *state) {
    barrier_case *c = case_begin(dim);
    for (int i = 0; i < dim; i++) case_vertex(c, draw(state), draw(state), dim == 3 ? draw(state) : 0, 0);
    case_facet(c, 0, 1, dim == 3 ? 2 : -1, -1);
    case_particle(c, (double[3]){draw(state), draw(state), dim == 3 ? draw(state) : 0}, 1, 1, 1, state);
    case_pair(c, 0, 1, 20, 1);
    return c;
}

// Against a fine scan of the way: no gap is less than what is to be left, and where it stops early that is reached.
START_TEST(limits_are_those_of_a_scan) {
    enum { SAMPLES = 800 };
    uint64_t state = 5;
    int stopped = 0;
    for (int n = 0; n < 240; n++) {
        const int dim = 2 + n % 2, single = n % 4 < 2;
        barrier_case *c = single ? one_pair(dim, &state) : two_features(dim, &state);
        case_ready(c);
        double *u = case_unknowns(c), *p = case_unknowns(c), *at = case_unknowns(c);
        const double speed = n % 3 == 0 ? 1 : n % 3 == 1 ? 30 : 1000;
        for (int i = 0; i < c->nodes * dim; i++) p[i] = draw_between(&state, -speed, speed);
        const double start = gap_at(c, u, p, 0, at), left = 0.1 * start;
        case_look(c, u, p);
        const double limit = case_limit(c, u, p, 1);
        ck_assert(limit > 0 && limit <= 1);
        for (int i = 1; i <= SAMPLES; i++) {
            const double t = limit * i / SAMPLES, gap = gap_at(c, u, p, t, at);
            ck_assert_msg(gap >= left * (1 - 1e-9), "%d: gap %g of %g at %g, limit %g", n, gap, start, t, limit);
        }
        // It is not shorter than it must be (of several pairs each keeps a tenth of its own).
        stopped += limit < 1 && single;
        if (limit < 1 && single) ck_assert_msg(gap_at(c, u, p, limit, at) <= 1.06 * left, "%d stops early", n);
        free(u), free(p), free(at), case_end(c);
    }
    ck_assert_int_ge(stopped, 10);
}
END_TEST

// Whether a place is within a box.
static bool inside(const double x[3], const double low[3], const double high[3], int dim) {
    for (int k = 0; k < dim; k++)
        if (x[k] < low[k] || x[k] > high[k]) return false;
    return true;
}

// Points that fly at a box a thousand edges a step, again and again, as Newton's method would have them: none gets in.
START_TEST(no_step_is_too_long) {
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    for (int dim = 2; dim <= 3; dim++) {
        barrier_case *c = case_begin(dim);
        uint64_t state = 17;
        if (dim == 2)
            case_rectangle(c, 0, low, high, 4);
        else
            case_box(c, 0, low, high, 3, true);
        for (int i = 0; i < 60; i++) {
            double x[3] = {draw_between(&state, -1, 2), draw_between(&state, -1, 2), draw_between(&state, -1, 2)};
            if (dim == 2) x[2] = 0;
            if (!inside(x, low, high, dim)) case_particle(c, x, 0.01, 1, 1, &state);
        }
        case_pair(c, 0, 1, 0.03, 1);
        case_ready(c);
        double *u = case_unknowns(c), *p = case_unknowns(c);
        for (int step = 0; step < 60; step++) {
            for (int32_t i = 0; i < c->particles; i++)
                for (int k = 0; k < dim; k++) {
                    double *move = &p[c->particle_node[i] * dim + k];
                    const double at = c->particle_x[i][k] + u[c->particle_node[i] * dim + k];
                    // Most aim at the box; some fly anywhere, 300 widths of the box or a thousand edges.
                    *move = step % 3 ? draw_between(&state, -300, 300) : 600 * (draw(&state) - at);
                }
            case_look(c, u, p);
            const double limit = case_limit(c, u, p, 1);
            ck_assert(limit > 0);
            for (int i = 0; i < c->nodes * dim; i++) u[i] += limit * p[i];
            ck_assert(case_report(c, u, NULL).least_gap > 0);
            for (int32_t i = 0; i < c->particles; i++) {
                double at[3];
                for (int k = 0; k < dim; k++) at[k] = c->particle_x[i][k] + u[c->particle_node[i] * dim + k];
                ck_assert_msg(!inside(at, low, high, dim), "point %d is inside after step %d", i, step);
            }
        }
        free(u), free(p), case_end(c);
    }
}
END_TEST

// Head on the gap shrinks to a tenth each time and never gets to 0, until rounding is as large: then nothing moves.
START_TEST(gaps_never_close) {
    for (int far = 0; far < 2; far++) {
        barrier_case *c = case_begin(2);
        uint64_t state = 1;
        const double o = far ? 1e6 : 0;
        static const double x[][2] = {{-1, 0}, {1.3, 0.1}, {0, -1}};
        double moved[3][2];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 2; k++) moved[i][k] = x[i][k] + o;
        case_polygon(c, 0, (const double(*)[2])moved, 3);
        case_particle(c, (double[3]){0.2 + o, 0.2 + o, 0}, 0.01, 1, 1, &state);
        case_pair(c, 0, 1, 0.5, 1);
        case_ready(c);
        double *u = case_unknowns(c), *p = case_unknowns(c), least = INFINITY;
        for (int step = 0; step < 60; step++) {
            p[c->particle_node[0] * 2 + 1] = -1;
            case_look(c, u, p);
            const double limit = case_limit(c, u, p, 1);
            for (int i = 0; i < c->nodes * 2; i++) u[i] += limit * p[i];
            // The step is done: places as they are stored.
            c->particle_x[0][0] += u[c->particle_node[0] * 2], c->particle_x[0][1] += u[c->particle_node[0] * 2 + 1];
            memset(u, 0, (size_t)c->nodes * 2 * sizeof *u);
            case_step(c);
            least = case_report(c, u, NULL).least_gap;
            ck_assert_double_gt(least, 0);
            const double t = (c->particle_x[0][0] - o + 1) / 2.3;
            ck_assert_double_gt(c->particle_x[0][1] - o, 0.1 * t);
        }
        ck_assert_double_lt(least, far ? 1e-7 : 1e-13);
        free(u), free(p), case_end(c);
    }
}
END_TEST

// Edges that cross at any angle down to parallel: none passes the other.
START_TEST(edges_do_not_pass) {
    for (double angle = 1; angle > 1e-9; angle *= 0.1) {
        barrier_case *c = case_begin(3);
        case_vertex(c, -1, 0, 0, 0), case_vertex(c, 1, 0, 0, 0), case_vertex(c, 0, 0, -1, 0);
        case_vertex(c, -cos(angle), -sin(angle), 0.1, 1), case_vertex(c, cos(angle), sin(angle), 0.1, 1);
        case_vertex(c, 0, 0, 1.1, 1);
        case_facet(c, 0, 1, 2, -1), case_facet(c, 3, 4, 5, -1);
        case_pair(c, 0, 1, 0.2, 1);
        case_ready(c);
        double *u = case_unknowns(c), *p = case_unknowns(c);
        for (int i = 3; i < 6; i++) p[i * 3 + 2] = -50;
        case_look(c, u, p);
        // Nothing but the two edges is near at first; a third of each triangle's area, 1, is theirs.
        const double alone = 0.5 * (1 / 3.0 + 1 / 3.0) / 2 * brunt_barrier_at(0.1, 0.2, 1).b;
        if (angle == 1) ck_assert_double_eq_tol(case_energy(c, brunt_barrier_term(c->barrier), u), alone, 1e-12);
        const double limit = case_limit(c, u, p, 1);
        ck_assert_double_eq_tol(limit * 50, 0.09, 0.005 * 0.1 + 1e-9);
        free(u), free(p), case_end(c);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------------------- planes

START_TEST(planes_push_and_rub) {
    const double dhat = 0.05, kappa = 2e5, gap = 0.02, area = 0.03, mu = 0.4, eps = 0.1;
    for (int dim = 2; dim <= 3; dim++)
        for (int way = 0; way < 3; way++) { // slides, rubs, sticks
            barrier_case *c = case_begin(dim);
            uint64_t state = 1;
            const double n[3] = {0.6, 0.8, 0};
            case_particle(c, (double[3]){1 + gap * n[0], 2 + gap * n[1], 0}, area, 0, 4, &state);
            c->planes = 1;
            c->plane[0] = (brunt_barrier_plane){.origin = {1, 2, 0},
                                                .normal = {n[0], n[1], 0},
                                                .node = c->nodes++,
                                                .distance = dhat,
                                                .stiffness = kappa,
                                                .slip_speed = eps,
                                                .friction = way == 0   ? 0
                                                            : way == 1 ? mu
                                                                       : INFINITY};
            case_ready(c);
            double *u = case_unknowns(c), *g = case_unknowns(c), sum[3] = {0};
            const brunt_term terms[2] = {brunt_barrier_term(c->barrier), brunt_barrier_friction_term(c->barrier)};
            const double force = -area * brunt_barrier_at(gap, dhat, kappa).db;
            case_look(c, u, NULL), case_gradient(c, terms[0], u, g);
            for (int i = 0; i < 4; i++)
                for (int k = 0; k < dim; k++) sum[k] -= g[c->particle_node[i] * dim + k];
            for (int k = 0; k < dim; k++) {
                ck_assert_double_eq_tol(sum[k], force * n[k], 1e-11 * force);
                ck_assert_double_eq_tol(g[c->plane[0].node * dim + k], force * n[k], 1e-11 * force);
            }
            // The plane moves along itself: half the speed below which friction is rounded off, then ten times it.
            case_lag(c, u);
            for (int fast = 0; fast < 2; fast++) {
                const double slip = (fast ? 10 : 0.5) * eps * c->dt, t[3] = {-0.8, 0.6, 0};
                for (int k = 0; k < dim; k++) u[c->plane[0].node * dim + k] = slip * t[k];
                case_gradient(c, terms[1], u, g);
                const double share = way == 0 ? 0 : way == 1 ? mu * (fast ? 1 : 0.75) : fast ? 20 : 1;
                double along = 0, across = 0;
                for (int k = 0; k < dim; k++)
                    along += g[c->plane[0].node * dim + k] * t[k], across += g[c->plane[0].node * dim + k] * n[k];
                ck_assert_double_eq_tol(along, share * force, 1e-10 * force);
                ck_assert_double_eq_tol(across, 0, 1e-12 * force);
                brunt_barrier_force told;
                const brunt_barrier_report report = case_report(c, u, &told);
                ck_assert_double_eq_tol(told.heat, share * force * slip, 1e-10 * force * slip);
                ck_assert_int_eq(report.plane, 0);
                for (int k = 0; k < dim; k++) {
                    ck_assert_double_eq_tol(told.normal[k], force * n[k], 1e-11 * force);
                    ck_assert_double_eq_tol(told.friction[k], share * force * t[k], 1e-10 * force);
                }
            }
            free(u), free(g), case_end(c);
        }
}
END_TEST

// Surfaces that stand off: a tenth of their gap is left, or of the distance where that is less.
START_TEST(offsets_limit_a_step) {
    const double offset = 0.04, distance = _i ? 0.02 : 0.2, gap = 0.1 - offset;
    barrier_case *c = case_begin(2);
    case_vertex(c, -1, 0, 0, 0), case_vertex(c, 1, 0, 0, 0), case_vertex(c, 0, -1, 0, 0);
    case_vertex(c, 0, 0.1, 0, 1), case_vertex(c, 0.5, 1, 0, 1), case_vertex(c, -0.5, 1, 0, 1);
    for (int b = 0; b < 2; b++)
        for (int i = 0; i < 3; i++) case_facet(c, 3 * b + i, 3 * b + (i + 1) % 3, -1, -1);
    case_pair(c, 0, 1, distance, 1)->offset = offset;
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c);
    for (int i = 3; i < 6; i++) p[i * 2 + 1] = -50; // the upper one comes
    case_look(c, u, p);
    ck_assert_double_eq_tol(case_limit(c, u, p, 1) * 50, gap - 0.1 * fmin(gap, distance), 1e-9);
    free(u), free(p), case_end(c);
}
END_TEST

// The longest step of Newmark's rule: a corner of mass m on an edge whose ends have 2 m each, sqrt(4 M / (A b'')) with
// 1 / M = 1 / m + (1/4 + 1/4) / (2 m); on a node that is given, and above a plane, M = m.
START_TEST(longest_step) {
    const double m = 3, gap = 0.01, distance = 0.05, stiffness = 2e4;
    const bool plane = _i == 2, given = _i == 1;
    double inverse[CASE_VERTICES];
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    if (!plane) {
        case_vertex(c, -1, 0, 0, 1), case_vertex(c, 1, 0, 0, 1), case_vertex(c, 0, -1, 0, 1);
        for (int i = 0; i < 3; i++) case_facet(c, i, (i + 1) % 3, -1, -1);
    }
    case_particle(c, (double[3]){0, gap, 0}, 0.3, 0, 1, &state);
    c->planes = plane;
    if (plane)
        c->plane[0] =
            (brunt_barrier_plane){.normal = {0, 1, 0}, .node = -1, .distance = distance, .stiffness = stiffness};
    else
        case_pair(c, 0, 1, distance, stiffness);
    for (int i = 0; i < c->nodes; i++) inverse[i] = given ? 0 : 1 / (2 * m);
    inverse[c->particle_node[0]] = 1 / m;
    c->inverse_mass = inverse;
    case_ready(c);
    double *u = case_unknowns(c);
    const brunt_barrier_stiffest s = case_report(c, u, NULL).stiffest;
    const double mass = plane || given ? m : 1 / (1 / m + 0.5 / (2 * m)),
                 step = sqrt(4 * mass / (0.3 * brunt_barrier_at(gap, distance, stiffness).ddb));
    ck_assert_double_eq_tol(s.step, step, 1e-12 * step);
    ck_assert_int_eq(s.body, 0);
    ck_assert_int_eq(s.other, plane ? -1 : 1);
    ck_assert_double_eq_tol(s.position[1], gap, 1e-15);
    for (int i = 0; i < c->nodes; i++) inverse[i] = 0;
    ck_assert(case_report(c, u, NULL).stiffest.step == INFINITY);
    c->inverse_mass = NULL;
    case_step(c);
    ck_assert(case_report(c, u, NULL).stiffest.step == INFINITY);
    free(u), case_end(c);
}
END_TEST

START_TEST(planes_limit_a_step) {
    barrier_case *c = case_begin(3);
    uint64_t state = 1;
    case_particle(c, (double[3]){0, 0, 0.02}, 1, 0, 1, &state);
    c->planes = 1;
    c->plane[0] = (brunt_barrier_plane){.normal = {0, 0, 1}, .node = c->nodes++, .distance = 0.05, .stiffness = 1};
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c);
    p[c->particle_node[0] * 3 + 2] = -1, p[c->plane[0].node * 3 + 2] = 2;
    case_look(c, u, p);
    ck_assert_double_eq_tol(case_limit(c, u, p, 1), 0.9 * 0.02 / 3, 1e-12);
    p[c->plane[0].node * 3 + 2] = -2; // it goes away faster
    case_look(c, u, p);
    ck_assert_double_eq(case_limit(c, u, p, 1), 1);
    free(u), free(p), case_end(c);
}
END_TEST

// ----------------------------------------------------------------------------------------------------- friction

// A point on an edge: mu N above the slip speed, of what Newmark's rule takes for the velocity.
START_TEST(friction_is_of_the_velocity) {
    const double dhat = 0.1, kappa = 1e5, gap = 0.04, mu = 0.25, eps = 0.2;
    for (int newmark = 0; newmark < 2; newmark++) {
        barrier_case *c = case_begin(2);
        uint64_t state = 1;
        static const double x[][2] = {{-5, 0}, {5, 0}, {0, -5}};
        case_polygon(c, 0, x, 3);
        case_particle(c, (double[3]){0.3, gap, 0}, 0.02, 1, 1, &state);
        *case_pair(c, 0, 1, dhat, kappa) = (brunt_barrier_pair){.a = 0,
                                                                .b = 1,
                                                                .distance = dhat,
                                                                .stiffness = kappa,
                                                                .friction = mu,
                                                                .slip_speed = eps,
                                                                .share = {0, 1, 0}};
        if (newmark) c->factor = 2, c->before[c->particle_node[0] * 2] = 0.3 * c->dt;
        case_ready(c);
        double *u = case_unknowns(c), *g = case_unknowns(c);
        const double force = -0.02 * brunt_barrier_at(gap, dhat, kappa).db;
        case_lag(c, u);
        for (double v = -0.5; v < 0.5; v += 0.037) {
            u[c->particle_node[0] * 2] = (newmark ? (v + 0.3) / 2 : v) * c->dt;
            case_gradient(c, brunt_barrier_friction_term(c->barrier), u, g);
            const double y = fabs(v) / eps, f1 = y < 1 ? 2 * y - y * y : 1;
            ck_assert_double_eq_tol(g[c->particle_node[0] * 2], copysign(mu * force * f1, v), 1e-10 * force);
        }
        free(u), free(g), case_end(c);
    }
}
END_TEST

// Two bodies pressed together flat: the force that the report has is that of the area, whichever nodes bear it.
START_TEST(the_pressure_is_that_of_the_barrier) {
    barrier_case *c = case_begin(2);
    const double gap = 0.01, dhat = 0.04, kappa = 1e6;
    case_rectangle(c, 0, (double[2]){0, 0}, (double[2]){1, 1}, 8);
    case_rectangle(c, 1, (double[2]){0, 1 + gap}, (double[2]){1, 2 + gap}, 8);
    case_pair(c, 0, 1, dhat, kappa);
    case_ready(c);
    double *u = case_unknowns(c);
    brunt_barrier_force force;
    const brunt_barrier_report report = case_report(c, u, &force);
    // Corners stand for the half edges around them as well: one edge more than the face has.
    const double expected = brunt_barrier_at(gap, dhat, kappa).db * (1 + 1 / 8.0);
    ck_assert_double_eq_tol(force.normal[1], expected, 1e-10 * fabs(expected));
    ck_assert_double_eq_tol(force.area, 1 + 1 / 8.0, 1e-12);
    ck_assert_double_eq_tol(report.least_gap, gap, 1e-13);
    ck_assert_double_eq_tol(report.least_part, gap / dhat, 1e-12);
    ck_assert(report.body != report.other && report.point >= 0 && report.plane == -1);
    free(u), case_end(c);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("barrier motion");
    TCase *motion = tcase_create("motion");
    tcase_add_test(motion, limits_are_those_of_a_scan);
    tcase_add_test(motion, no_step_is_too_long);
    tcase_add_test(motion, gaps_never_close);
    tcase_add_test(motion, edges_do_not_pass);
    tcase_add_test(motion, planes_push_and_rub);
    tcase_add_loop_test(motion, offsets_limit_a_step, 0, 2);
    tcase_add_loop_test(motion, longest_step, 0, 3);
    tcase_add_test(motion, planes_limit_a_step);
    tcase_add_test(motion, friction_is_of_the_velocity);
    tcase_add_test(motion, the_pressure_is_that_of_the_barrier);
    suite_add_tcase(suite, motion);
    return suite_main(suite);
}
