// Labels: double
// Friction of surfaces that may overlap, on the way to where it is Coulomb's: how deep they may come where slips press
// them together, slopes of that, what a vertex keeps of more than it has room for; and pushes of what is as near to
// two sides.
#include "contact/methods/gap_energy.h"
#include "tests/support/numbers.h"
#include "tests/support/suite.h"
#include "tests/support/term_check.h"

static const double K = 1e7, REACH = 0.06, AREA = 0.02; // [Pa/m], [m], [m]

// A point on a floor, with friction 0.4.
static barrier_case *floor_case(void) {
    static const double floor[][2] = {{5, 0}, {-5, 0}, {0, -5}};
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    case_polygon(c, 0, floor, 3);
    case_particle(c, (double[3]){0.3, 0, 0}, AREA, 1, 1, &state);
    brunt_barrier_pair *p = case_pair(c, 0, 1, 0, K);
    p->energy = brunt_penalty_at, p->reach = REACH, p->friction = 0.4, p->slip_speed = 1;
    case_ready(c);
    return c;
}

// Surfaces that slip on are pressed by 0.4 of it more: a point that is 0.05 deep is lost once it has slipped by more
// than 0.025, less what is rounded off of slips of 0.001.
START_TEST(slips_press_nothing_too_deep) {
    barrier_case *c = floor_case();
    double *u = case_unknowns(c), *from = case_unknowns(c);
    const brunt_term term = brunt_barrier_friction_term(c->barrier);
    const brunt_team team = {1, NULL};
    double *own = &u[c->particle_node[0] * 2], *began = &from[c->particle_node[0] * 2];
    own[1] = began[1] = -0.05;
    brunt_barrier_associate(c->barrier, from);
    for (int k = 0; k <= 20; k++) {
        own[0] = 0.005 * k;
        ck_assert_int_eq(term.ops->look(term.self, &team, u, NULL, NULL), BRUNT_OK);
        const double energy = case_energy(c, term, u), nearer = 0.4 * own[0];
        if (nearer > 0.0104)
            ck_assert_double_infinite(energy);
        else if (nearer < 0.0096)
            ck_assert_double_lt(fabs(energy), INFINITY);
    }
    free(u), free(from), case_end(c);
}
END_TEST

// The slope of that potential's forces by the point's place, however far it slips back.
START_TEST(slopes_are_those_of_forces) {
    static const double back[] = {0.003, 0.06, 0.1};
    for (int k = 0; k < 3; k++) {
        barrier_case *c = floor_case();
        double *u = case_unknowns(c), *from = case_unknowns(c), *up = case_unknowns(c), *down = case_unknowns(c);
        const brunt_term term = brunt_barrier_friction_term(c->barrier);
        const brunt_team team = {1, NULL};
        const int32_t dof = c->particle_node[0] * 2;
        const int n = c->nodes * 2;
        u[dof + 1] = from[dof + 1] = -0.02, from[dof] = 0.2, u[dof] = 0.2 - back[k];
        brunt_barrier_associate(c->barrier, from);
        for (int look = 0; look < 4; look++) {
            case_look(c, u, NULL);
            ck_assert_int_eq(term.ops->look(term.self, &team, u, NULL, NULL), BRUNT_OK);
        }
        double *dense = take_dense(c, term, u), size = 0;
        for (int i = 0; i < 4; i++) size = fmax(size, fabs(dense[(dof + i / 2) * n + dof + i % 2]));
        for (int i = 0; i < 2; i++) {
            const double h = 1e-7, was = u[dof + i];
            u[dof + i] = was + h, case_gradient(c, term, u, up);
            u[dof + i] = was - h, case_gradient(c, term, u, down);
            u[dof + i] = was;
            for (int j = 0; j < 2; j++)
                ck_assert_double_eq_tol((up[dof + j] - down[dof + j]) / (2 * h), dense[(dof + j) * n + dof + i],
                                        1e-5 * size);
        }
        free(u), free(from), free(up), free(down), free(dense), case_end(c);
    }
}
END_TEST

// A vertex between a body and three planes keeps what it has given along the three that press it most.
START_TEST(vertices_keep_the_slips_that_press_most) {
    static const double floor[][2] = {{5, 0}, {-5, 0}, {0, -5}}, wedge[][2] = {{0.3, -0.02}, {0.4, 2}, {0.2, 2}};
    static const double normal[3][2] = {{1, 0}, {-1, 0}, {0, 1}}, deep[] = {0.012, 0.011, 0.002};
    barrier_case *c = case_begin(2);
    case_polygon(c, 0, floor, 3), case_polygon(c, 1, wedge, 3);
    brunt_barrier_pair *p = case_pair(c, 0, 1, 0, 2 * K);
    p->energy = brunt_penalty_at, p->reach = REACH, p->friction = 0.4, p->slip_speed = 1;
    for (int k = 0; k < 3; k++)
        c->plane[c->planes++] =
            (brunt_barrier_plane){.origin = {0.3 + deep[k] * normal[k][0], -0.02 + deep[k] * normal[k][1]},
                                  .normal = {normal[k][0], normal[k][1]},
                                  .node = -1,
                                  .stiffness = K,
                                  .friction = 0.4,
                                  .slip_speed = 1,
                                  .energy = brunt_penalty_at,
                                  .reach = REACH};
    case_ready(c);
    const brunt_team team = {1, NULL};
    ck_assert_int_eq(brunt_barrier_keep_slips(c->barrier, NULL), BRUNT_OK);
    case_step(c);
    double *u = case_unknowns(c), kept[6 * 15];
    ck_assert_int_eq(brunt_barrier_keep(c->barrier, &team, u, NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_barrier_kept_count(c->barrier), 6 * 15);
    brunt_barrier_kept_get(c->barrier, kept);
    bool has[3] = {false, false, false};
    for (int s = 0; s < 3; s++) {
        const double other = kept[3 * 15 + s * 5], force = kept[3 * 15 + s * 5 + 1];
        ck_assert_double_gt(force, 0);
        for (int k = 0; k < 3; k++) has[k] |= other == (k == 0 ? 0 : -1 - k); // the floor, planes 0 and 1
    }
    ck_assert(has[0] && has[1] && has[2]);
    free(u), case_end(c);
}
END_TEST

// As near to two sides but for rounding: a shallow roof's ridge above its like, turned and far from the origin, pushes
// straight.
START_TEST(as_near_to_two_is_straight_wherever_it_is) {
    static const double roof[][2] = {{1, -0.25}, {0, 0}, {-1, -0.25}, {0, -2}},
                        other[][2] = {{0, -0.02}, {1, 0.23}, {0, 2}, {-1, 0.23}};
    for (int turn = 1; turn < 12; turn++) {
        barrier_case *c = case_begin(2);
        double x[8][2];
        const double co = cos(0.5 * turn), si = sin(0.5 * turn);
        for (int v = 0; v < 8; v++) {
            const double *from = v < 4 ? roof[v] : other[v - 4];
            x[v][0] = 7 + co * from[0] - si * from[1], x[v][1] = -3 + si * from[0] + co * from[1];
        }
        case_polygon(c, 0, (const double(*)[2])x, 4), case_polygon(c, 1, (const double(*)[2])(x + 4), 4);
        brunt_barrier_pair *p = case_pair(c, 0, 1, 0, K);
        p->energy = brunt_penalty_at, p->reach = REACH;
        case_ready(c);
        double *u = case_unknowns(c);
        brunt_barrier_force force;
        case_report(c, u, &force);
        const double along = -si * force.normal[0] + co * force.normal[1],
                     across = co * force.normal[0] + si * force.normal[1];
        ck_assert_double_gt(fabs(along), 0);
        ck_assert_double_lt(fabs(across), 1e-9 * fabs(along));
        free(u), case_end(c);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("penalty friction");
    TCase *tests = tcase_create("penalty friction");
    tcase_add_test(tests, slips_press_nothing_too_deep);
    tcase_add_test(tests, slopes_are_those_of_forces);
    tcase_add_test(tests, vertices_keep_the_slips_that_press_most);
    tcase_add_test(tests, as_near_to_two_is_straight_wherever_it_is);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
