// Labels: double
// The terms `barrier` and `friction` whole: derivatives, sums over vertices and edges, momenta, same bits.
#include "base/memory.h"
#include "contact/barrier/barrier_function.h"
#include "tests/support/barrier_case.h"
#include "tests/support/suite.h"
#include "tests/support/term_check.h"

// ------------------------------------------------------------------------------------------------- derivatives

// Two rectangles that nearly touch, leaning, their vertices moved at random.
static barrier_case *two_in_2d(bool self) {
    barrier_case *c = case_begin(2);
    uint64_t state = 11;
    case_rectangle(c, 0, (double[2]){0, 0}, (double[2]){1, 0.5}, 3);
    case_rectangle(c, self ? 0 : 1, (double[2]){0.2, 0.52}, (double[2]){0.9, 1}, 4);
    for (int32_t i = 0; i < c->vertices; i++)
        for (int k = 0; k < 2; k++) c->x[i][k] += draw_between(&state, -0.004, 0.004);
    case_pair(c, 0, self ? 0 : 1, 0.05, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = 0.5;
    return c;
}

static barrier_case *two_in_3d(bool triangles) {
    barrier_case *c = case_begin(3);
    uint64_t state = 12;
    case_box(c, 0, (double[3]){0, 0, 0}, (double[3]){1, 1, 0.5}, 2, triangles);
    case_box(c, 1, (double[3]){0.2, 0.3, 0.53}, (double[3]){0.9, 1.2, 1}, 2, triangles);
    for (int32_t i = 0; i < c->vertices; i++)
        for (int k = 0; k < 3; k++) c->x[i][k] += draw_between(&state, -0.006, 0.006);
    case_pair(c, 0, 1, 0.06, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = 0.5;
    return c;
}

// Material points above, and beside, a body.
static barrier_case *points_at(int dim, int weights) {
    barrier_case *c = case_begin(dim);
    uint64_t state = 13;
    if (dim == 2)
        case_rectangle(c, 0, (double[2]){0, 0}, (double[2]){1, 1}, 2);
    else
        case_box(c, 0, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 2, true);
    for (int i = 0; i < 8; i++) {
        const double away = draw_between(&state, 0.01, 0.03), z = dim == 3 ? draw(&state) : 0;
        const double x[3] = {i < 4 ? 1 + away : draw(&state), i < 4 ? draw(&state) : 1 + away, z};
        case_particle(c, x, 0.02, 1, weights, &state);
    }
    case_pair(c, 0, 1, 0.05, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = 0.5;
    return c;
}

static void draw_unknowns(const barrier_case *c, double *u, double size, uint64_t seed) {
    for (int i = 0; i < c->nodes * c->dim; i++) u[i] = draw_between(&seed, -size, size);
}

static barrier_case *make_case(int which) {
    switch (which) {
    case 0: return two_in_2d(false);
    case 1: return two_in_2d(true);
    case 2: return two_in_3d(true);
    case 3: return two_in_3d(false);
    case 4: return points_at(2, 9);
    case 5: return points_at(3, 8);
    default: return points_at(3, 1);
    }
}

START_TEST(derivatives_of_whole_terms) {
    for (int which = 0; which < 7; which++)
        for (int newmark = 0; newmark < 2; newmark++) {
            barrier_case *c = make_case(which);
            double *u = case_unknowns(c);
            if (newmark) c->factor = 2, draw_unknowns(c, c->before, 4e-4, 5);
            case_ready(c);
            draw_unknowns(c, u, 1e-3, 21);
            if (!newmark) check_term(c, brunt_barrier_term(c->barrier), u, 2e-8, true);
            case_lag(c, u);
            draw_unknowns(c, u, 4e-4, 22);
            check_term(c, brunt_barrier_friction_term(c->barrier), u, 2e-8, true);
            free(u), case_end(c);
        }
}
END_TEST

// Friction that follows what presses, and what has been kept of the step before: forces without an energy, whose
// derivative is not symmetric. Of points at facets, at vertices and at planes, and edges that cross, that creep and
// that slip; of what has met the surface in this step, most of which was beyond the distance before it.
START_TEST(friction_that_follows_has_its_derivative) {
    static const int cases[] = {0, 1, 4, 5, 6, 2, 3, 4, 5, 6, 2, 3};
    enum { MEETING = 7 };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int slips = 0; slips < 2; slips++) {
            barrier_case *c = make_case(cases[k]);
            const brunt_team team = {c->threads, NULL};
            double *u = case_unknowns(c);
            const double size = k < MEETING ? 1e-3 : 4e-3;
            c->pair[0].slip_speed = slips ? 1e-3 : k < MEETING ? 0.5 : 10;
            if (k >= MEETING) c->pair[0].distance = cases[k] == 2 || cases[k] == 3 ? 0.03 : 0.014;
            case_ready(c);
            ck_assert_int_eq(brunt_barrier_keep_slips(c->barrier, NULL), BRUNT_OK);
            draw_unknowns(c, u, size, 23);
            ck_assert_int_eq(brunt_barrier_keep(c->barrier, &team, u, NULL), BRUNT_OK);
            draw_unknowns(c, u, size, 24);
            brunt_barrier_follow(c->barrier, true);
            const double lean = check_term(c, brunt_barrier_friction_term(c->barrier), u, 2e-8, false);
            ck_assert_msg(lean > 1e-2, "case %d: symmetric to %g", cases[k], lean);
            free(u), case_end(c);
        }
}
END_TEST

// The gradient of friction's potential where surfaces that slip come apart, at u, and its energy.
static double associated(const barrier_case *c, const double *from, const double *u, double *g) {
    const brunt_team team = {c->threads, NULL};
    const brunt_term rub = brunt_barrier_friction_term(c->barrier);
    brunt_barrier_associate(c->barrier, from);
    ck_assert_int_eq(rub.ops->look(rub.self, &team, u, NULL, NULL), BRUNT_OK);
    memset(g, 0, (size_t)c->nodes * 2 * sizeof *g);
    rub.ops->gradient(rub.self, &team, u, g);
    return rub.ops->energy(rub.self, &team, u).value;
}

// A point is pressed onto a flat surface and slides. The potential's forces are Coulomb's where the round began, of
// what presses there, and its energy is 0; farther on they are its slopes, by which it is pushed off more than the
// barrier does by what it has slid on; where it slides back, less. Its Hessian with the barrier's is symmetric and
// positive.
START_TEST(associated_friction_is_coulombs_where_it_began) {
    barrier_case *c = case_begin(2);
    const brunt_team team = {c->threads, NULL};
    const double distance = 0.01, creep = 1e-4, mu = 0.4, way = 5e-4, h = 1e-8;
    case_polygon(c, 0, (double[][2]){{-1, 0}, {1, 0}, {0, -1}}, 3);
    case_polygon(c, 1, (double[][2]){{0.1, 0.4 * distance}, {0.3, 1}, {-0.1, 1}}, 3);
    case_pair(c, 0, 1, distance, 1e5)->friction = mu;
    c->pair[0].slip_speed = creep / c->dt;
    case_ready(c);
    double *u = case_unknowns(c), *from = case_unknowns(c), *g = case_unknowns(c), *other = case_unknowns(c);
    const brunt_term push = brunt_barrier_term(c->barrier), rub = brunt_barrier_friction_term(c->barrier);
    const int32_t x = 2 * c->node[3], y = x + 1;
    for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = from[2 * c->node[v]] = way;
    case_look(c, u, NULL);
    push.ops->gradient(push.self, &team, u, other);
    const double pressed = -other[y], before = associated(c, from, u, g);
    ck_assert_double_eq(before, 0);
    ck_assert_double_eq_tol(g[x], mu * pressed, 1e-12 * pressed);
    ck_assert_double_eq_tol(g[y], 0, 1e-12 * pressed);
    const brunt_barrier_value at = brunt_barrier_at(0.4 * distance, distance, 1e5);
    for (int back = 0; back < 2; back++) {
        const double more = (back ? -1 : 1) * 2e-4;
        for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = way + more;
        associated(c, from, u, g);
        const double presses = pressed * brunt_barrier_at(0.4 * distance - mu * more, distance, 1e5).db / at.db;
        ck_assert_double_eq_tol(g[x], mu * presses, 1e-12 * presses);
        ck_assert_double_eq_tol(g[y], pressed - presses, 1e-12 * presses);
        ck_assert(back ? presses < pressed : presses > pressed);
        for (int k = 0; k < 2; k++) { // its slopes, as far as what it comes nearer by is not bounded
            const int32_t dof = k ? y : x;
            double value[2];
            for (int side = 0; side < 2; side++) {
                for (int32_t v = 3; v < 6; v++) u[2 * c->node[v] + k] += (side ? -1 : 1) * h;
                value[side] = rub.ops->energy(rub.self, &team, u).value; // wherever it was looked at
                for (int32_t v = 3; v < 6; v++) u[2 * c->node[v] + k] -= (side ? -1 : 1) * h;
            }
            ck_assert_double_eq_tol((value[0] - value[1]) / (2 * h), g[dof], 1e-6 * pressed);
        }
    }
    // Bounded: far back it presses no less than a part, where what is given back would leave it nothing.
    for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = way, from[2 * c->node[v]] = 40 * way;
    associated(c, from, u, g);
    const double least = brunt_barrier_at(0.4 * distance - at.db / at.ddb, distance, 1e5).db / at.db;
    ck_assert_double_eq_tol(g[y], pressed * (1 - least), 1e-3 * pressed);
    ck_assert(g[x] > 0 && g[x] < 1e-2 * mu * pressed); // and rubs with next to nothing
    brunt_barrier_associate(c->barrier, NULL);
    free(u), free(from), free(g), free(other), case_end(c);
}
END_TEST

// A point slides on a flat surface; friction that follows what presses was looked at where it had slid one way, and is
// tried where it has slid the other. The force, an unknown of its own, stays what it was, by w + dw of the smooth form,
// and leaps once that place is looked at: its slope there is twice that of what has slipped on, which would be none.
START_TEST(friction_that_turns_round_is_tried_with_its_force) {
    barrier_case *c = case_begin(2);
    const brunt_team team = {c->threads, NULL};
    const double distance = 0.01, creep = 1e-3, way = 3 * creep, more = 1e-6;
    case_polygon(c, 0, (double[][2]){{-1, 0}, {1, 0}, {0, -1}}, 3);
    case_polygon(c, 1, (double[][2]){{0.1, 0.5 * distance}, {0.3, 1}, {-0.1, 1}}, 3);
    case_pair(c, 0, 1, distance, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = creep / c->dt;
    case_ready(c);
    double *u = case_unknowns(c), *g = case_unknowns(c), force[4], pressed;
    const brunt_term rub = brunt_barrier_friction_term(c->barrier), push = brunt_barrier_term(c->barrier);
    const int32_t x = 2 * c->node[3];
    case_look(c, u, NULL);
    push.ops->gradient(push.self, &team, u, g);
    pressed = -g[x + 1];
    brunt_barrier_follow(c->barrier, true);
    for (int k = 0; k < 4; k++) { // looked at on one side, tried on the other, looked at there, tried a little on
        for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = k == 0 ? -way : k < 3 ? way : way + more;
        if (k % 2)
            rub.ops->follow(rub.self, 1);
        else
            ck_assert_int_eq(rub.ops->look(rub.self, &team, u, NULL, NULL), BRUNT_OK);
        memset(g, 0, (size_t)c->nodes * 2 * sizeof *g);
        rub.ops->gradient(rub.self, &team, u, g);
        force[k] = g[x] / (0.3 * pressed);
    }
    ck_assert_double_gt(pressed, 0);
    ck_assert_double_eq_tol(force[0], -1, 1e-12);
    ck_assert_double_eq_tol(force[1], -1, 1e-12);
    ck_assert_double_eq_tol(force[2], 1, 1e-12);
    ck_assert_double_eq_tol(force[3], 1, 1e-12); // w + dw = 1 + 2 more / way, and no more than all of it
    for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = way - more;
    memset(g, 0, (size_t)c->nodes * 2 * sizeof *g);
    rub.ops->gradient(rub.self, &team, u, g);
    ck_assert_double_eq_tol(g[x] / (0.3 * pressed), 1 - 2 * more / way, 1e-3 * more / way);
    free(u), free(g), case_end(c);
}
END_TEST

// A point comes to a flat surface from three distances away to half of one, and moves along it on its way: in load
// steps it rubs from where it met the surface, a fifth of that; in steps of time all of it is its speed.
START_TEST(load_steps_rub_from_where_surfaces_meet) {
    for (int keeps = 0; keeps < 2; keeps++) {
        barrier_case *c = case_begin(2);
        const brunt_team team = {c->threads, NULL};
        const double distance = 0.01, slip = 4e-3, give = 5e-3, x = (keeps ? 0.2 : 1) * slip / give;
        case_polygon(c, 0, (double[][2]){{-1, 0}, {1, 0}, {0, -1}}, 3);
        case_polygon(c, 1, (double[][2]){{0.1, 3 * distance}, {0.3, 1}, {-0.1, 1}}, 3);
        case_pair(c, 0, 1, distance, 1e5)->friction = 0.3;
        c->pair[0].slip_speed = give / c->dt;
        case_ready(c);
        if (keeps) ck_assert_int_eq(brunt_barrier_keep_slips(c->barrier, NULL), BRUNT_OK);
        double *u = case_unknowns(c), *g = case_unknowns(c);
        for (int32_t v = 3; v < 6; v++) u[2 * c->node[v]] = slip, u[2 * c->node[v] + 1] = -2.5 * distance;
        case_lag(c, u);
        const brunt_term rub = brunt_barrier_friction_term(c->barrier), push = brunt_barrier_term(c->barrier);
        case_look(c, u, NULL);
        push.ops->gradient(push.self, &team, u, g);
        const double pressed = -g[2 * c->node[3] + 1];
        rub.ops->gradient(rub.self, &team, u, g);
        ck_assert_double_gt(pressed, 0);
        ck_assert_double_eq_tol(g[2 * c->node[3]], 0.3 * pressed * (2 * x - x * x), 1e-12 * pressed);
        free(u), free(g), case_end(c);
    }
}
END_TEST

// The force of friction on a block whose surface has given by `given` along x, and is pushed on to where other edges
// cross than did; what presses it.
static double rubs_at(double given, int block, double *pressed) {
    barrier_case *c = case_begin(3);
    const brunt_team team = {c->threads, NULL};
    for (int body = 0; body < 2; body++)
        if (body == block)
            case_box(c, body, (double[3]){0.3, 0.3, 0.51}, (double[3]){0.7, 0.7, 1}, 4, true);
        else
            case_box(c, body, (double[3]){0, 0, 0}, (double[3]){1, 1, 0.5}, 2, true);
    case_pair(c, 0, 1, 0.02, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = 1e4 / c->dt; // gives in proportion to what is asked
    case_ready(c);
    ck_assert_int_eq(brunt_barrier_keep_slips(c->barrier, NULL), BRUNT_OK);
    double *u = case_unknowns(c), *g = case_unknowns(c), force = 0;
    for (int32_t v = 0; v < c->vertices; v++)
        if (c->body[v] == block) u[3 * c->node[v]] = given;
    ck_assert_int_eq(brunt_barrier_keep(c->barrier, &team, u, NULL), BRUNT_OK);
    for (int32_t v = 0; v < c->vertices; v++)
        if (c->body[v] == block) u[3 * c->node[v]] = 0.13;
    case_lag(c, u);
    const brunt_term rub = brunt_barrier_friction_term(c->barrier), push = brunt_barrier_term(c->barrier);
    case_look(c, u, NULL);
    push.ops->gradient(push.self, &team, u, g);
    *pressed = 0;
    for (int32_t v = 0; v < c->vertices; v++)
        if (c->body[v] == block) *pressed -= g[3 * c->node[v] + 2];
    memset(g, 0, (size_t)c->nodes * 3 * sizeof *g);
    rub.ops->gradient(rub.self, &team, u, g);
    for (int32_t v = 0; v < c->vertices; v++)
        if (c->body[v] == block) force += g[3 * c->node[v]];
    free(u), free(g), case_end(c);
    return force;
}

// What points have kept goes to edges that cross anew, the same way for both bodies: the force is that of all that has
// been given by all that presses.
START_TEST(edges_that_meet_anew_have_given_what_their_ends_have) {
    for (int block = 0; block < 2; block++) {
        double pressed, other;
        const double given = 2e-3, more = rubs_at(given, block, &pressed) - rubs_at(0, block, &other);
        ck_assert_double_eq(pressed, other);
        ck_assert_double_eq_tol(more / (0.3 * pressed * 2 * given / 1e4), 1, 0.02); // normals lean at its border
    }
}
END_TEST

// A point that slides along a surface feels the same everywhere: above faces, edges and vertices, and exactly there.
static void slide(barrier_case *c, const double (*at)[3], int count, double expected) {
    double *u = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < c->dim; k++) u[c->particle_node[0] * c->dim + k] = at[i][k] - c->particle_x[0][k];
        case_look(c, u, NULL);
        const double energy = case_energy(c, term, u);
        ck_assert_msg(fabs(energy - expected) < 1e-11 * expected, "%.15g at (%g, %g), not %.15g", energy, at[i][0],
                      at[i][1], expected);
    }
    free(u);
}

START_TEST(sums_are_constant_along_a_polygon) {
    enum { PLACES = 400 };
    barrier_case *c = case_begin(2);
    // Uneven edges, some shorter than the distance; the ends are far.
    static const double x[][2] = {{-9, 0}, {0, 0}, {0.1, 0}, {0.13, 0}, {0.4, 0}, {1, 0}, {9, 0}, {0, -9}};
    case_polygon(c, 0, x, 8);
    uint64_t state = 1;
    const double gap = 0.02, dhat = 0.05, kappa = 1e5;
    case_particle(c, (double[3]){0.3, gap, 0}, 0.02, 1, 1, &state);
    case_pair(c, 0, 1, dhat, kappa);
    case_ready(c);
    static double at[PLACES][3];
    for (int i = 0; i < PLACES; i++) at[i][0] = i < 5 ? x[1 + i][0] : draw_between(&state, -1, 2), at[i][1] = gap;
    slide(c, (const double(*)[3])at, PLACES, 0.02 * brunt_barrier_at(gap, dhat, kappa).b);
    case_end(c);
}
END_TEST

START_TEST(sums_are_constant_along_a_triangulation) {
    enum { N = 7, PLACES = 2000 };
    static double at[PLACES][3];
    for (int quadrilaterals = 0; quadrilaterals < 2; quadrilaterals++) {
        barrier_case *c = case_begin(3);
        uint64_t state = 3;
        const double gap = 0.05, dhat = 0.2, kappa = 1e5; // some edges are shorter
        for (int j = 0; j <= N; j++)
            for (int i = 0; i <= N; i++)
                case_vertex(c, i * 0.2 + draw_between(&state, -0.08, 0.08), j * 0.2 + draw_between(&state, -0.08, 0.08),
                            0, 0);
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++) {
                const int32_t v = j * (N + 1) + i, q[4] = {v, v + 1, v + N + 2, v + N + 1};
                if (quadrilaterals)
                    case_facet(c, q[0], q[1], q[2], q[3]);
                else if (draw(&state) < 0.5)
                    case_facet(c, q[0], q[1], q[2], -1), case_facet(c, q[0], q[2], q[3], -1);
                else
                    case_facet(c, q[0], q[1], q[3], -1), case_facet(c, q[1], q[2], q[3], -1);
            }
        case_particle(c, (double[3]){0.7, 0.7, gap}, 0.02, 1, 1, &state);
        case_pair(c, 0, 1, dhat, kappa);
        case_ready(c);
        for (int i = 0; i < PLACES; i++) {
            const int vertex = (2 + draw_whole(&state, N - 4)) * (N + 1) + 2 + draw_whole(&state, N - 4);
            const int other = vertex + (i % 3 == 0 ? 1 : i % 3 == 1 ? N + 1 : N + 2);
            const double t = i % 4 == 0 ? 0 : i % 4 == 1 ? draw(&state) : 0.5, *a = c->x[vertex], *b = c->x[other];
            for (int k = 0; k < 2; k++) at[i][k] = i % 4 == 3 ? draw_between(&state, 0.4, 1) : a[k] + t * (b[k] - a[k]);
            at[i][2] = gap;
        }
        slide(c, (const double(*)[3])at, PLACES, 0.02 * brunt_barrier_at(gap, dhat, kappa).b);
        case_end(c);
    }
}
END_TEST

// Of the energies of two pairs each is taken at its own gaps.
static brunt_barrier_value square(double d, double distance, double stiffness) {
    const double y = distance - d;
    return d < distance ? (brunt_barrier_value){stiffness * y * y, -2 * stiffness * y, 2 * stiffness}
                        : (brunt_barrier_value){0};
}

START_TEST(a_pair_has_the_energy_of_its_method) {
    const double dhat = 0.1, kappa = 1e5, gap[2] = {0.04, 0.07}, area = 0.02;
    barrier_case *c = case_begin(2);
    uint64_t state = 1;
    static const double x[][2] = {{-5, 0}, {5, 0}, {0, -5}};
    case_polygon(c, 0, x, 3);
    for (int i = 0; i < 2; i++) case_particle(c, (double[3]){0.3 + i, gap[i], 0}, area, 1 + i, 1, &state);
    case_pair(c, 0, 1, dhat, kappa);
    case_pair(c, 0, 2, dhat, kappa)->energy = square;
    case_ready(c);
    double *u = case_unknowns(c), *g = case_unknowns(c);
    case_look(c, u, NULL);
    case_gradient(c, brunt_barrier_term(c->barrier), u, g);
    const double own = area * brunt_barrier_at(gap[0], dhat, kappa).db, other = area * square(gap[1], dhat, kappa).db;
    ck_assert_double_eq_tol(g[c->particle_node[0] * 2 + 1], own, 1e-12 * -own);
    ck_assert_double_eq_tol(g[c->particle_node[1] * 2 + 1], other, 1e-12 * -other);
    free(u), free(g), case_end(c);
}
END_TEST

// What a surface's border, corner and valley add up to.
START_TEST(sums_at_borders_corners_and_valleys) {
    const double dhat = 0.1, kappa = 1e5, area = 0.02;
    uint64_t state = 1;
    barrier_case *c = case_begin(3);
    // An open sheet of two triangles that rises at x = 0, along y.
    const double h = 0.5;
    case_vertex(c, 0, 0, 0, 0), case_vertex(c, 0, 1, 0, 0), case_vertex(c, 1, 0.5, h, 0), case_vertex(c, -1, 0.5, h, 0);
    case_facet(c, 0, 1, 2, -1), case_facet(c, 0, 1, 3, -1);
    case_particle(c, (double[3]){0, 0.5, 0.05}, area, 1, 1, &state);
    case_pair(c, 0, 1, dhat, kappa)->friction = 1;
    c->pair[0].slip_speed = 1;
    case_ready(c);
    double *u = case_unknowns(c);
    const brunt_term term = brunt_barrier_term(c->barrier);
    case_look(c, u, NULL);
    // In the valley both slopes, at cos(slope) of the height, but for one edge.
    const double slope = 0.05 / sqrt(1 + h * h), both = 2 * brunt_barrier_at(slope, dhat, kappa).b;
    const double expected = area * (both - brunt_barrier_at(0.05, dhat, kappa).b);
    ck_assert_double_eq_tol(case_energy(c, term, u), expected, 1e-12 * expected);
    brunt_barrier_force force;
    brunt_barrier_report report = case_report(c, u, &force);
    ck_assert_int_eq(report.contacts, 3);
    case_lag(c, u);
    // Friction is of the slopes alone.
    u[c->particle_node[0] * 3 + 1] = 1e9 * c->dt;
    double *g = case_unknowns(c);
    case_gradient(c, brunt_barrier_friction_term(c->barrier), u, g);
    const double pressed = -2 * area * brunt_barrier_at(slope, dhat, kappa).db;
    ck_assert_double_eq_tol(g[c->particle_node[0] * 3 + 1], pressed, 1e-9 * pressed);
    // Beyond an end of the crease, and below it, one contact.
    const double places[][3] = {{0, -0.05, 0}, {0, 0.5, -0.05}, {0, -0.03, -0.04}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) u[c->particle_node[0] * 3 + k] = places[i][k] - c->particle_x[0][k];
        case_look(c, u, NULL);
        const double one = area * brunt_barrier_at(0.05, dhat, kappa).b;
        ck_assert_double_eq_tol(case_energy(c, term, u), one, 1e-11 * one);
        ck_assert_int_eq(case_report(c, u, NULL).contacts, 1);
    }
    free(u), free(g), case_end(c);
}
END_TEST

// ------------------------------------------------------------------------------------------------------ momenta

static void place_now(const barrier_case *c, const double *u, int32_t node, double x[3]) {
    for (int32_t i = 0; i < c->vertices; i++)
        if (c->node[i] == node)
            for (int k = 0; k < 3; k++) x[k] = c->x[i][k] + (k < c->dim ? u[node * c->dim + k] : 0);
}

START_TEST(forces_are_opposite) {
    for (int which = 0; which < 4; which++) {
        barrier_case *c = make_case(which);
        case_ready(c);
        double *u = case_unknowns(c), *g = case_unknowns(c), *slip = case_unknowns(c);
        draw_unknowns(c, u, 1e-3, 31);
        case_look(c, u, NULL);
        case_gradient(c, brunt_barrier_term(c->barrier), u, g);
        double sum[3] = {0}, turn[3] = {0}, on_a[3] = {0}, size = 0;
        for (int32_t n = 0; n < c->nodes; n++) {
            double x[3] = {0}, f[3] = {0};
            place_now(c, u, n, x);
            for (int k = 0; k < c->dim; k++) f[k] = g[n * c->dim + k], sum[k] += f[k], size += fabs(f[k]);
            for (int k = 0; k < c->dim && c->body[n] == 0; k++) on_a[k] -= f[k];
            for (int k = 0; k < 3; k++) turn[k] += x[(k + 1) % 3] * f[(k + 2) % 3] - x[(k + 2) % 3] * f[(k + 1) % 3];
        }
        for (int k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(sum[k], 0, 1e-13 * size);
            ck_assert_double_eq_tol(turn[k], 0, 1e-12 * size);
        }
        case_lag(c, u);
        draw_unknowns(c, u, 1e-3, 32);
        case_gradient(c, brunt_barrier_friction_term(c->barrier), u, slip);
        double rub[3] = {0}, rub_size = 0, rub_a[3] = {0};
        for (int32_t n = 0; n < c->nodes; n++)
            for (int k = 0; k < c->dim; k++) {
                rub[k] += slip[n * c->dim + k], rub_size += fabs(slip[n * c->dim + k]);
                if (c->body[n] == 0) rub_a[k] -= slip[n * c->dim + k];
            }
        for (int k = 0; k < c->dim; k++) ck_assert_double_eq_tol(rub[k], 0, 1e-13 * rub_size);
        brunt_barrier_force force;
        const brunt_barrier_report report = case_report(c, u, &force);
        ck_assert(force.heat > 0 && report.energy > 0);
        // Of a body with itself (1) both are what all its nodes get: nothing.
        for (int k = 0; k < c->dim; k++) ck_assert_double_eq_tol(force.friction[k], rub_a[k], 1e-12 * rub_size);
        draw_unknowns(c, u, 1e-3, 31);
        case_report(c, u, &force);
        // What is not along the normal comes from the mollifier: it only turns.
        ck_assert_double_gt(force.area, 0);
        for (int k = 0; k < c->dim; k++) ck_assert_double_eq_tol(force.normal[k], on_a[k], 1e-12 * size);
        free(u), free(g), free(slip), case_end(c);
    }
}
END_TEST

// --------------------------------------------------------------------------------------------------------- same

static double *whole_of(barrier_case *c, const double *u, const double *p, double *energy, double *limit) {
    double *g = case_unknowns(c);
    case_look(c, u, p);
    *energy = case_energy(c, brunt_barrier_term(c->barrier), u);
    *limit = p ? case_limit(c, u, p, 1) : 0;
    case_gradient(c, brunt_barrier_term(c->barrier), u, g);
    return g;
}

START_TEST(threads_give_the_same_bits) {
    barrier_case *c = case_begin(3);
    case_box(c, 0, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 8, true);
    case_box(c, 1, (double[3]){0.05, 0.02, 1.01}, (double[3]){1.1, 0.9, 2}, 8, true);
    case_pair(c, 0, 1, 0.02, 1e5)->friction = 0.3;
    c->pair[0].slip_speed = 0.1;
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c), energy[3], limit[3], *g[3];
    draw_unknowns(c, u, 2e-3, 41), draw_unknowns(c, p, 0.2, 42);
    brunt_block_matrix m[3] = {{0}, {0}, {0}};
    for (int i = 0; i < 3; i++) {
        c->threads = 1 + i;
        const brunt_term term = brunt_barrier_term(c->barrier);
        const brunt_team team = {c->threads, NULL};
        g[i] = whole_of(c, u, p, &energy[i], &limit[i]);
        case_look(c, u, NULL);
        const brunt_stencils stencils = term.ops->stencils(term.self);
        const brunt_pattern pattern = {c->dim, c->nodes, &stencils, 1, false, NULL};
        ck_assert_int_eq(brunt_block_matrix_pattern(&m[i], &team, &pattern, NULL), BRUNT_OK);
        term.ops->hessian(term.self, &team, u, true, &m[i]);
        const int64_t blocks = brunt_block_matrix_blocks(&m[0]);
        ck_assert(energy[i] == energy[0] && limit[i] == limit[0] && energy[0] > 0 && limit[0] > 0 && limit[0] < 1);
        ck_assert_int_eq(memcmp(g[i], g[0], (size_t)c->nodes * 3 * sizeof(double)), 0);
        ck_assert_int_eq(brunt_block_matrix_blocks(&m[i]), blocks);
        ck_assert_int_eq(memcmp(m[i].value, m[0].value, (size_t)blocks * 9 * sizeof(double)), 0);
    }
    for (int i = 0; i < 3; i++) free(g[i]), brunt_block_matrix_free(&m[i]);
    free(u), free(p), case_end(c);
}
END_TEST

// A copy with bodies numbered the other way round, mirrored along x, or shifted.
static barrier_case *changed(const barrier_case *c, bool swap, bool mirror, double shift) {
    barrier_case *d = malloc(sizeof *d);
    memcpy(d, c, sizeof *d);
    d->barrier = NULL;
    for (int32_t i = 0; i < c->vertices; i++) {
        const int32_t from = swap ? c->vertices - 1 - i : i;
        d->body[i] = swap ? 1 - c->body[from] : c->body[i], d->node[i] = c->node[from];
        for (int k = 0; k < 3; k++)
            d->x[i][k] = (mirror && k == 0 ? -c->x[from][k] : c->x[from][k]) + (k < c->dim ? shift : 0);
    }
    for (int32_t i = 0; i < c->facets; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t v = c->facet[swap ? c->facets - 1 - i : i][k];
            d->facet[i][k] = v < 0 || !swap ? v : c->vertices - 1 - v;
        }
    for (int32_t i = 0; i < c->particles; i++)
        for (int k = 0; k < c->dim; k++)
            d->particle_x[i][k] = (mirror && k == 0 ? -1 : 1) * c->particle_x[i][k] + shift;
    return d;
}

START_TEST(order_mirror_and_place_do_not_matter) {
    for (int which = 0; which < 4; which++)
        for (int way = 0; way < 3; way++) {
            barrier_case *c = make_case(which);
            // Places in 2^-30: shifted by 2^20 they are exact.
            for (int32_t i = 0; i < c->vertices; i++)
                for (int k = 0; k < 3; k++) c->x[i][k] = round(c->x[i][k] * 0x1p30) * 0x1p-30;
            barrier_case *d = changed(c, way == 0 && which != 1, way == 1, way == 2 ? 0x1p20 : 0);
            case_ready(c), case_ready(d);
            double *u = case_unknowns(c), *p = case_unknowns(c), energy[2], limit[2], size = 0;
            draw_unknowns(c, u, 1e-3, 51), draw_unknowns(c, p, 0.1, 52);
            double *g = whole_of(c, u, p, &energy[0], &limit[0]);
            if (way == 1)
                for (int i = 0; i < c->nodes; i++) u[i * c->dim] *= -1, p[i * c->dim] *= -1;
            double *h = whole_of(d, u, p, &energy[1], &limit[1]);
            for (int i = 0; i < c->nodes * c->dim; i++) size = fmax(size, fabs(g[i]));
            ck_assert_double_eq_tol(energy[0], energy[1], 1e-12 * energy[0]);
            // Far away rounding costs more of the gap, which the limit counts as taken.
            ck_assert_double_eq_tol(limit[0], limit[1], way == 2 ? 1e-6 : 1e-9);
            for (int i = 0; i < c->nodes * c->dim; i++)
                ck_assert_double_eq_tol(g[i], way == 1 && i % c->dim == 0 ? -h[i] : h[i], 1e-11 * size);
            free(u), free(p), free(g), free(h), case_end(c), case_end(d);
        }
}
END_TEST

START_TEST(later_steps_take_no_memory) {
    barrier_case *c = make_case(2);
    case_ready(c);
    double *u = case_unknowns(c), *p = case_unknowns(c), *g = case_unknowns(c);
    const brunt_term terms[2] = {brunt_barrier_term(c->barrier), brunt_barrier_friction_term(c->barrier)};
    const brunt_team team = {1, NULL};
    brunt_block_matrix m = {0};
    int64_t calls = 0;
    for (int step = 0; step < 6; step++) {
        if (step == 2) calls = brunt_memory_calls();
        draw_unknowns(c, u, 1e-3, 61), draw_unknowns(c, p, 0.1, 62);
        case_step(c), case_lag(c, u), case_look(c, u, NULL);
        brunt_stencils stencils[2];
        for (int i = 0; i < 2; i++) stencils[i] = terms[i].ops->stencils(terms[i].self);
        const brunt_pattern pattern = {c->dim, c->nodes, stencils, 2, false, NULL};
        if (step == 0) ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
        for (int i = 0; i < 2; i++) {
            case_gradient(c, terms[i], u, g);
            terms[i].ops->hessian(terms[i].self, &team, u, true, &m);
        }
        case_look(c, u, p), case_limit(c, u, p, 1), case_energy(c, terms[0], p), case_report(c, u, NULL);
    }
    ck_assert_int_eq(brunt_memory_calls(), calls);
    brunt_block_matrix_free(&m);
    free(u), free(p), free(g), case_end(c);
}
END_TEST

// ------------------------------------------------------------------------------------------------------- search

// Candidates of a short way find what those of a way so long that all meet all find. Where something is known to be
// near, those of a way are of the part that it may be gone: the same as far as that, and the same limit.
START_TEST(candidates_are_all_there_is) {
    for (int which = 0; which < 7; which++) {
        barrier_case *c = make_case(which);
        case_ready(c);
        double *u = case_unknowns(c), *p = case_unknowns(c), *at = case_unknowns(c), *all = case_unknowns(c);
        const brunt_term term = brunt_barrier_term(c->barrier);
        int touched = 0;
        for (int n = 0; n < 30; n++) {
            draw_unknowns(c, u, 0.02, 71 + (uint64_t)n), draw_unknowns(c, p, 0.2, 171 + (uint64_t)n);
            for (int i = 0; i < c->nodes * c->dim; i++) all[i] = i % 2 ? 50 : -50;
            const double t = n / 29.0;
            for (int i = 0; i < c->nodes * c->dim; i++) at[i] = u[i] + t * p[i];
            case_step(c), case_look(c, u, p);
            const double along = case_energy(c, term, at), limit = case_limit(c, u, p, 1);
            case_look(c, at, NULL);
            const double here = case_energy(c, term, at);
            draw_unknowns(c, all, 100, 7);
            case_step(c), case_look(c, at, all);
            const double every = case_energy(c, term, at);
            ck_assert_msg(along == every && here == every, "case %d: %.17g and %.17g, of all %.17g", which, along, here,
                          every);
            touched += every > 0;
            case_look(c, u, NULL), case_look(c, u, p);
            ck_assert_double_eq(case_limit(c, u, p, 1), limit);
            for (int i = 0; i < c->nodes * c->dim; i++) at[i] = u[i] + t * limit * p[i];
            const double within = case_energy(c, term, at);
            case_look(c, at, NULL);
            ck_assert_double_eq(within, case_energy(c, term, at));
        }
        ck_assert_int_ge(touched, 15);
        free(u), free(p), free(at), free(all), case_end(c);
    }
}
END_TEST

START_TEST(bad_surfaces_are_refused) {
    static const int32_t facets[3][4] = {{0, 1, 2, -1}, {0, 1, 1, -1}, {0, 1, 3, -1}};
    static const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    static const int32_t bodies[4] = {0, 0, 0, 1};
    static const char *const says[3] = {"no area", "no area", "two bodies"};
    for (int i = 0; i < 3; i++) {
        brunt_error error = {0};
        brunt_barrier *b = brunt_barrier_make(&error);
        const brunt_barrier_mesh mesh = {3, 4, 1, x, bodies, &facets[i], false, false};
        ck_assert_int_eq(brunt_barrier_set_mesh(b, &mesh, &error), BRUNT_FAILED);
        ck_assert_msg(strstr(error.message, says[i]), "%s", error.message);
        brunt_barrier_free(b);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("barrier terms");
    TCase *terms = tcase_create("terms");
    tcase_add_test(terms, derivatives_of_whole_terms);
    tcase_add_test(terms, friction_that_follows_has_its_derivative);
    tcase_add_test(terms, friction_that_turns_round_is_tried_with_its_force);
    tcase_add_test(terms, associated_friction_is_coulombs_where_it_began);
    tcase_add_test(terms, load_steps_rub_from_where_surfaces_meet);
    tcase_add_test(terms, edges_that_meet_anew_have_given_what_their_ends_have);
    tcase_add_test(terms, sums_are_constant_along_a_polygon);
    tcase_add_test(terms, sums_are_constant_along_a_triangulation);
    tcase_add_test(terms, a_pair_has_the_energy_of_its_method);
    tcase_add_test(terms, sums_at_borders_corners_and_valleys);
    tcase_add_test(terms, forces_are_opposite);
    tcase_add_test(terms, threads_give_the_same_bits);
    tcase_add_test(terms, order_mirror_and_place_do_not_matter);
    tcase_add_test(terms, later_steps_take_no_memory);
    tcase_add_test(terms, candidates_are_all_there_is);
    tcase_add_test(terms, bad_surfaces_are_refused);
    suite_add_tcase(suite, terms);
    return suite_main(suite);
}
