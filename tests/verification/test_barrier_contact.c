// Contact by a barrier in steps that are minimised: gaps under a load, a body on a slope, a fast impact.
#include <stdio.h>

#include "contact/barrier/barrier_function.h"
#include "linear/newton.h"
#include "tests/support/barrier_case.h"
#include "tests/support/suite.h"

// Inertia and load of each unknown: m / (2 c) (u - start)^2 - f u.
typedef struct masses {
    int dim;
    int32_t nodes;
    const double *mass, *start, *force;
    double c;
} masses;

static brunt_energy_sum masses_energy(void *self, const brunt_team *team, const double *u) {
    const masses *t = self;
    brunt_energy_sum sum = {0};
    (void)team;
    for (int i = 0; i < t->nodes * t->dim; i++) {
        const double d = u[i] - t->start[i], kinetic = t->mass[i / t->dim] / (2 * t->c) * d * d;
        sum.value += kinetic - t->force[i] * u[i], sum.magnitude += kinetic + fabs(t->force[i] * u[i]);
    }
    return sum;
}

static void masses_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    const masses *t = self;
    (void)team;
    for (int i = 0; i < t->nodes * t->dim; i++) g[i] += t->mass[i / t->dim] / t->c * (u[i] - t->start[i]) - t->force[i];
}

static void masses_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *m) {
    const masses *t = self;
    (void)team, (void)u, (void)project;
    for (int32_t n = 0; n < t->nodes; n++)
        for (int k = 0; k < t->dim; k++) brunt_block_matrix_diagonal(m, n)[k * t->dim + k] += t->mass[n] / t->c;
}

static const brunt_term_ops masses_ops = {
    .name = "masses", .energy = masses_energy, .gradient = masses_gradient, .hessian = masses_hessian};

// One particle of mass m above a triangle (edge) of held vertices that is turned by `angle`, in steps of backward
// Euler.
typedef struct slope {
    barrier_case *c;
    double *u, *start, *force, mass[8], v[3];
    uint8_t held[24];
    brunt_newton newton;
    brunt_newton_options options;
    int32_t node;
} slope;

static const double AREA = 0.02, DHAT = 1e-3, KAPPA = 1e6;

static slope *slope_make(int dim, double angle, double gap, double mu, double eps) {
    slope *s = calloc(1, sizeof *s);
    uint64_t state = 1;
    barrier_case *c = s->c = case_begin(dim);
    const double x = cos(angle), y = sin(angle);
    case_vertex(c, -50 * x, -50 * y, -50, 0), case_vertex(c, 50 * x, 50 * y, dim == 3 ? -50 : 0, 0);
    if (dim == 3)
        case_vertex(c, 0, 0, 80, 0);
    else
        c->x[0][2] = 0;
    case_facet(c, 0, 1, dim == 3 ? 2 : -1, -1);
    case_particle(c, (double[3]){-y * gap, x * gap, 0}, AREA, 1, 1, &state);
    *case_pair(c, 0, 1, DHAT, KAPPA) = (brunt_barrier_pair){
        .a = 0, .b = 1, .distance = DHAT, .stiffness = KAPPA, .friction = mu, .slip_speed = eps, .share = {0, 1, 0}};
    case_ready(c);
    s->u = case_unknowns(c), s->start = case_unknowns(c), s->force = case_unknowns(c);
    s->node = c->particle_node[0];
    for (int i = 0; i < c->nodes * dim; i++) s->held[i] = i / dim != s->node;
    for (int i = 0; i < c->nodes; i++) s->mass[i] = 2;
    s->options = brunt_newton_defaults();
    s->options.tolerance = 1e-11; // [m]: places are known to 1e-14 of 50 m
    return s;
}

static brunt_newton_report slope_step(slope *s, double dt) {
    barrier_case *c = s->c;
    const int dim = c->dim;
    const brunt_team team = {1, NULL};
    masses inertia = {dim, c->nodes, s->mass, s->start, s->force, dt * dt};
    for (int k = 0; k < dim; k++) s->start[s->node * dim + k] = dt * s->v[k];
    memset(s->u, 0, (size_t)(c->nodes * dim) * sizeof *s->u);
    c->dt = dt;
    case_step(c), case_lag(c, s->u);
    const brunt_term terms[3] = {
        {&masses_ops, &inertia}, brunt_barrier_term(c->barrier), brunt_barrier_friction_term(c->barrier)};
    const brunt_problem problem = {dim, c->nodes, terms, 3, s->held, NULL, NULL, false};
    brunt_newton_report report;
    brunt_error error = {0};
    const int code = brunt_newton_minimise(&s->newton, &team, &problem, &s->options, s->u, &report, &error);
    ck_assert_msg(code == BRUNT_OK, "%s", error.message);
    for (int k = 0; k < dim; k++) {
        const double move = s->u[s->node * dim + k];
        s->v[k] = move / dt, c->particle_x[0][k] += move;
    }
    return report;
}

static void slope_free(slope *s) {
    brunt_newton_free(&s->newton);
    free(s->u), free(s->start), free(s->force), case_end(s->c), free(s);
}

// The gap at which the barrier carries a force [N].
static double gap_of(double force) {
    double low = 0, high = DHAT;
    for (int i = 0; i < 200; i++) {
        const double d = (low + high) / 2;
        *(-AREA * brunt_barrier_at(d, DHAT, KAPPA).db > force ? &low : &high) = d;
    }
    return low;
}

START_TEST(a_load_has_its_gap) {
    for (int dim = 2; dim <= 3; dim++)
        for (double force = 1e-3; force < 1e7; force *= 31) {
            slope *s = slope_make(dim, 0, 0.5 * DHAT, 0, 0);
            s->force[s->node * dim + 1] = -force;
            for (int k = 0; k < dim; k += 2) s->held[s->node * dim + k] = 1; // nothing else holds it along the surface
            slope_step(s, 1e3);                                              // so long that inertia is nothing
            const double expected = gap_of(force);
            brunt_barrier_force told;
            memset(s->u, 0, (size_t)(s->c->nodes * dim) * sizeof *s->u);
            case_step(s->c);
            const brunt_barrier_report report = case_report(s->c, s->u, &told);
            ck_assert_double_eq_tol(report.least_gap, expected, 1e-6 * expected);
            slope_free(s);
        }
}
END_TEST

// Down a slope of tan 0.2 with Coulomb's law: g (sin - mu cos), or creep below eps_v where mu is more than tan.
START_TEST(a_body_on_a_slope) {
    const double angle = atan(0.2), g = 5.1, dt = 1e-3, eps = 1e-5, mass = 2;
    static const double mus[] = {0, 0.1, 0.19, 0.21, INFINITY};
    for (int dim = 2; dim <= 3; dim++)
        for (int i = 0; i < 5; i++) {
            slope *s = slope_make(dim, angle, gap_of(mass * g * cos(angle)), mus[i], eps);
            s->force[s->node * dim + 1] = -mass * g;
            for (int n = 0; n < 100; n++) slope_step(s, dt);
            const double along = -(s->v[0] * cos(angle) + s->v[1] * sin(angle)),
                         across = s->v[1] * cos(angle) - s->v[0] * sin(angle);
            const double expected = g * (sin(angle) - mus[i] * cos(angle)) * 100 * dt;
            printf("%dD, mu %g: %.9g m/s\n", dim, mus[i], along);
            // It takes some steps to come to slide; eps_v is what it is then too fast or slow by, at most.
            if (expected > 0)
                ck_assert_double_eq_tol(along, expected, 2 * eps);
            else
                ck_assert_msg(along > 0 && along < eps, "creeps by %g m/s", along);
            ck_assert_double_eq_tol(across, 0, 1e-7);
            slope_free(s);
        }
}
END_TEST

// At 2e4 times the distance dhat a step it does not get through, nor far in.
START_TEST(an_impact_stops_at_the_surface) {
    for (int dim = 2; dim <= 3; dim++) {
        slope *s = slope_make(dim, 0.1, 3, 0, 0);
        s->v[0] = 100, s->v[1] = -2000;
        for (int n = 0; n < 5; n++) {
            slope_step(s, 1e-2);
            const double *x = s->c->particle_x[0], height = x[1] * cos(0.1) - x[0] * sin(0.1);
            ck_assert_msg(height > 1e-3 * DHAT, "%g m above after step %d", height, n);
        }
        slope_free(s);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("barrier contact");
    TCase *contact = tcase_create("contact");
    tcase_add_test(contact, a_load_has_its_gap);
    tcase_add_test(contact, a_body_on_a_slope);
    tcase_add_test(contact, an_impact_stops_at_the_surface);
    suite_add_tcase(suite, contact);
    return suite_main(suite);
}
