// Labels: double
// Bodies without the nodes that nothing touches: Newton's method goes where it goes with all of them, step by step,
// whatever is touched, and to the same bits for any number of threads; nodes that are left out are alone in the matrix.
#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "linear/newton.h"
#include "tests/support/suite.h"

enum {
    DIM = 2,
    SIDE = 4,
    NODES = SIDE * SIDE,
    SIZE = NODES * DIM,
    BODIES = 20,
    ALL = BODIES * SIZE,
    LINKS = 4 * BODIES
};

// Lattices of springs between nodes up to a diagonal apart, stiffer here than there: three motions leave them as they
// are.
static double K[SIZE][SIZE], place[SIZE];
static const double times[3] = {1, 2.5, 0.3};

static bool on_edge(int n) { return n % SIDE == 0 || n % SIDE == SIDE - 1 || n < SIDE || n >= NODES - SIDE; }

static void make_lattice(void) {
    memset(K, 0, sizeof K);
    for (int k = 0; k < SIZE; k++) place[k] = k % DIM ? k / DIM / SIDE : k / DIM % SIDE;
    for (int a = 0; a < NODES; a++)
        for (int b = 0; b < a; b++) {
            const double x[2] = {a % SIDE - b % SIDE, a / SIDE - b / SIDE}, l = hypot(x[0], x[1]);
            for (int i = 0; i < DIM && l < 1.5; i++)
                for (int j = 0; j < DIM; j++) {
                    const double k = (1 + 0.5 * sin(a + 7 * b)) * x[i] * x[j] / (l * l);
                    K[a * DIM + i][a * DIM + j] += k, K[b * DIM + i][b * DIM + j] += k;
                    K[a * DIM + i][b * DIM + j] -= k, K[b * DIM + i][a * DIM + j] -= k;
                }
        }
}

typedef struct lattice {
    int base;
    double scale;
    int32_t node[NODES];
    int64_t first[2];
} lattice;

static brunt_energy_sum lattice_energy(void *self, const brunt_team *team, const double *u) {
    const lattice *b = self;
    const double *x = u + b->base * DIM;
    brunt_energy_sum e = {0};
    (void)team;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) e.value += 0.5 * b->scale * x[i] * K[i][j] * x[j];
    e.magnitude = fabs(e.value);
    return e;
}

static void lattice_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    const lattice *b = self;
    (void)team;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) g[b->base * DIM + i] += b->scale * K[i][j] * u[b->base * DIM + j];
}

static brunt_stencils lattice_stencils(void *self) {
    const lattice *b = self;
    return (brunt_stencils){.count = 1, .first = b->first, .node = b->node, .version = 1};
}

static void lattice_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    const lattice *b = self;
    double dense[SIZE][SIZE];
    (void)team, (void)u, (void)project;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) dense[i][j] = b->scale * K[i][j];
    brunt_block_matrix_add(h, b->node, NODES, dense[0]);
}

static const brunt_term_ops lattice_ops = {.name = "lattice",
                                           .energy = lattice_energy,
                                           .gradient = lattice_gradient,
                                           .stencils = lattice_stencils,
                                           .hessian = lattice_hessian};

// |d|^2 / 2 + |d|^4 / 4 of edge nodes of neighbours, d = u_a - u_b - shift; and loads on every node, inner ones too.
// From the third look on more nodes are listed, which do nothing.
typedef struct links {
    int64_t first[2 * LINKS + 1], count;
    int32_t node[4 * LINKS];
    int looks;
} links;

static void make_links(links *l) {
    static const int of[] = {1, 7, 14, 8, 0, 13, 4, 11};
    *l = (links){.count = 0};
    for (int b = 0; b < BODIES; b++)
        for (int k = 0; k < 8; k++) {
            const int64_t at = l->first[l->count];
            const int other = (b + 1) % BODIES;
            if (k % 2) continue;
            l->node[at] = b * NODES + of[k], l->node[at + 1] = other * NODES + of[(k + 3 + b) % 8];
            l->first[++l->count] = at + 2;
        }
}

static int links_look(void *self, const brunt_team *team, const double *u, const double *p, brunt_error *error) {
    (void)team, (void)u, (void)error;
    ((links *)self)->looks += !p;
    return BRUNT_OK;
}

static bool is_in(int64_t s) { return s % 4 < 2; } // which links pull

static void stretch(const links *l, const double *u, int64_t s, double d[DIM]) {
    for (int a = 0; a < DIM; a++)
        d[a] = u[l->node[2 * s] * DIM + a] - u[l->node[2 * s + 1] * DIM + a] - 0.4 * sin(3.0 * (double)s + a);
}

static double load(int k) { return 0.2 * cos(5 * k + 1); }

static brunt_energy_sum links_energy(void *self, const brunt_team *team, const double *u) {
    const links *l = self;
    brunt_energy_sum e = {0};
    (void)team;
    for (int64_t s = 0; s < l->count; s++) {
        double d[DIM];
        stretch(l, u, s, d);
        const double square = d[0] * d[0] + d[1] * d[1];
        if (is_in(s)) e.value += 0.5 * square + 0.25 * square * square;
    }
    e.magnitude = e.value;
    for (int k = 0; k < ALL; k++) {
        const int n = k / DIM % NODES;
        e.value -= load(k) * u[k] - (n == 3 || n == 12 ? 0.5 * u[k] * u[k] : 0);
        e.magnitude += fabs(load(k) * u[k]);
    }
    return e;
}

static void links_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    const links *l = self;
    (void)team;
    for (int64_t s = 0; s < l->count; s++) {
        double d[DIM];
        stretch(l, u, s, d);
        for (int a = 0; a < DIM && is_in(s); a++) {
            const double f = d[a] * (1 + d[0] * d[0] + d[1] * d[1]);
            g[l->node[2 * s] * DIM + a] += f, g[l->node[2 * s + 1] * DIM + a] -= f;
        }
    }
    for (int k = 0; k < ALL; k++) g[k] += (k / DIM % NODES == 3 || k / DIM % NODES == 12 ? u[k] : 0) - load(k);
}

// What is anchored is listed after the links.
static brunt_stencils links_stencils(void *self) {
    links *l = self;
    int64_t count = l->count;
    for (int b = 0; b < BODIES; b++)
        for (int n = 3; n <= 12; n += 9) {
            l->node[l->first[count]] = b * NODES + n;
            l->first[count + 1] = l->first[count] + 1, count++;
        }
    for (int b = 0; b < BODIES && l->looks > 2; b++)
        l->node[l->first[count]] = b * NODES + 2, l->first[count + 1] = l->first[count] + 1, count++;
    return (brunt_stencils){.count = count, .first = l->first, .node = l->node};
}

static void links_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    const links *l = self;
    (void)team, (void)project;
    for (int64_t s = 0; s < l->count; s++) {
        double d[DIM], dense[16];
        stretch(l, u, s, d);
        for (int e = 0; e < 16; e++) {
            const int i = e / 4 % DIM, j = e % DIM;
            const double k = (i == j) * (1 + d[0] * d[0] + d[1] * d[1]) + 2 * d[i] * d[j];
            dense[e] = is_in(s) ? (e / 8 == e % 4 / 2 ? k : -k) : 0;
        }
        brunt_block_matrix_add(h, l->node + 2 * s, 2, dense);
    }
    for (int k = 0; k < ALL; k++)
        if (k / DIM % NODES == 3 || k / DIM % NODES == 12)
            brunt_block_matrix_diagonal(h, k / DIM)[k % DIM * (DIM + 1)] += 1;
}

static const brunt_term_ops links_ops = {.name = "links",
                                         .look = links_look,
                                         .energy = links_energy,
                                         .gradient = links_gradient,
                                         .stencils = links_stencils,
                                         .hessian = links_hessian};

static lattice body[BODIES];
static links all_links;
static brunt_term terms[BODIES + 1];

// Nodes that are alone in the matrix go to *alone.
static void solve(int threads, brunt_condensation *c, const brunt_linear_ops *solver, double *u, int *iterations,
                  int *alone) {
    const brunt_team team = {.threads = threads};
    brunt_newton_options options = brunt_newton_defaults();
    brunt_newton newton = {0};
    brunt_newton_report report;
    options.tolerance = 1e-12, options.solver = solver;
    make_links(&all_links);
    for (int b = 0; b < BODIES; b++) {
        body[b] = (lattice){.base = b * NODES, .scale = times[b % 3], .first = {0, NODES}};
        for (int n = 0; n < NODES; n++) body[b].node[n] = b * NODES + n;
        terms[b] = (brunt_term){&lattice_ops, &body[b]};
    }
    terms[BODIES] = (brunt_term){&links_ops, &all_links};
    const brunt_problem problem = {
        .dim = DIM, .nodes = BODIES * NODES, .terms = terms, .count = BODIES + 1, .condensed = c};
    memset(u, 0, ALL * sizeof *u);
    ck_assert_int_eq(brunt_newton_minimise(&newton, &team, &problem, &options, u, &report, NULL), BRUNT_OK);
    *iterations = report.iterations, *alone = 0;
    for (int n = 0; n < BODIES * NODES; n++) *alone += newton.matrix.first[n + 1] - newton.matrix.first[n] == 1;
    for (int n = 2; c && n < BODIES * NODES; n += NODES) // listed late
        ck_assert_int_gt(newton.matrix.first[n + 1] - newton.matrix.first[n], 1);
    brunt_newton_free(&newton);
}

static void condense(brunt_condensation *c, brunt_condensed_mesh *mesh) {
    uint8_t rim[NODES];
    for (int n = 0; n < NODES; n++) rim[n] = on_edge(n);
    ck_assert_int_eq(brunt_condensed_mesh_make(mesh, DIM, NODES, K[0], place, rim, NULL), BRUNT_OK);
    *c = (brunt_condensation){.count = BODIES, .body = brunt_alloc(BODIES * sizeof *c->body)};
    for (int b = 0; b < BODIES; b++)
        c->body[b] = (brunt_condensed_body){.mesh = mesh, .base = b * NODES, .scale = times[b % 3]};
    ck_assert_int_eq(brunt_condensation_make(c, BODIES * NODES, BODIES + 1, NULL), BRUNT_OK);
    for (int b = 0; b < BODIES; b++) c->left_out[b] = true;
}

START_TEST(same_as_with_all_nodes) {
    const brunt_linear_ops *solver = _i ? &brunt_linear_unsymmetric : &brunt_linear_direct;
    brunt_condensation c;
    brunt_condensed_mesh mesh;
    double whole[ALL], one[ALL], two[ALL], worst = 0, most = 0;
    int iterations[3], alone[3];
    make_lattice();
    condense(&c, &mesh);
    solve(1, NULL, solver, whole, &iterations[0], &alone[0]);
    solve(1, &c, solver, one, &iterations[1], &alone[1]);
    solve(2, &c, solver, two, &iterations[2], &alone[2]);
    for (int k = 0; k < ALL; k++) worst = fmax(worst, fabs(one[k] - whole[k])), most = fmax(most, fabs(whole[k]));
    printf("  off by %.1e of %.3g, %d and %d iterations, %d nodes of %d alone\n", worst, most, iterations[0],
           iterations[1], alone[1], BODIES * NODES);
    ck_assert_double_gt(most, 0.1);
    ck_assert_double_le(worst, 1e-12 * most);
    ck_assert_int_eq(iterations[0], iterations[1]);
    ck_assert_int_gt(iterations[0], 3);
    ck_assert_int_eq(alone[0], 0);
    ck_assert_int_gt(alone[1], 4 * BODIES); // inner ones, and some of the rim
    ck_assert_mem_eq(one, two, sizeof one);
    brunt_condensation_free(&c);
    brunt_condensed_mesh_free(&mesh);
}
END_TEST

// A lattice of springs in two or three dimensions, SIDE nodes a side: what holds each node by some of its own goes, of
// those that are left out, to the kept ones, so that each rigid motion has all of it; what they give by is as of all
// nodes.
enum { MOST = SIDE * SIDE * SIDE * 3 };

static int make_springs(int dim, double *A, double *x, uint8_t *rim) {
    const int nodes = dim == 2 ? SIDE * SIDE : SIDE * SIDE * SIDE, size = nodes * dim;
    memset(A, 0, (size_t)(size * size) * sizeof *A);
    for (int n = 0; n < nodes; n++) {
        const int at[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        rim[n] = 0;
        for (int i = 0; i < dim; i++) x[n * dim + i] = at[i], rim[n] |= at[i] == 0 || at[i] == SIDE - 1;
    }
    for (int a = 0; a < nodes; a++)
        for (int b = 0; b < a; b++) {
            double d[3] = {0}, square = 0;
            for (int i = 0; i < dim; i++) d[i] = x[a * dim + i] - x[b * dim + i], square += d[i] * d[i];
            for (int e = 0; e < dim * dim && square < 3.5; e++) {
                const int i = e / dim, j = e % dim;
                const double k = (1 + 0.5 * sin(a + 7 * b)) * d[i] * d[j] / square;
                A[(a * dim + i) * size + a * dim + j] += k, A[(b * dim + i) * size + b * dim + j] += k;
                A[(a * dim + i) * size + b * dim + j] -= k, A[(b * dim + i) * size + a * dim + j] -= k;
            }
        }
    return nodes;
}

static double own(int k) { return 1 + 0.4 * sin(2 * k); }

// A rigid motion, 0 .. 5, of the nodes: along x, y, z, about z, y, x.
static void move_rigidly(int dim, int nodes, const double *x, int motion, double *u) {
    static const int planes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int k = 0; k < nodes * dim; k++) {
        const int n = k / dim, a = k % dim;
        if (motion < dim) {
            u[k] = a == motion;
            continue;
        }
        const int one = planes[motion - dim][0], other = planes[motion - dim][1];
        u[k] = a == one ? -x[n * dim + other] : a == other ? x[n * dim + one] : 0;
    }
}

START_TEST(rigid_motions_have_all_of_what_holds) {
    static double A[MOST * MOST], x[MOST], u[MOST], f[MOST], g[MOST];
    const brunt_team team = {.threads = 1};
    uint8_t rim[SIDE * SIDE * SIDE];
    const int dim = _i, nodes = make_springs(dim, A, x, rim), size = nodes * dim;
    brunt_condensed_mesh mesh;
    brunt_condensation c = {.count = 1, .body = brunt_alloc(sizeof *c.body)};
    brunt_block_matrix m = {0};
    ck_assert_int_eq(brunt_condensed_mesh_make(&mesh, dim, nodes, A, x, rim, NULL), BRUNT_OK);
    c.body[0] = (brunt_condensed_body){.mesh = &mesh, .scale = 2};
    ck_assert_int_eq(brunt_condensation_make(&c, nodes, 1, NULL), BRUNT_OK);
    const int64_t first[] = {0, 2};
    const int32_t touched[] = {1, nodes - 2};
    brunt_stencils lists[2] = {{.count = 1, .first = first, .node = touched}};
    int count = 1;
    ck_assert_int_eq(brunt_condensation_touch(&c, &team, lists, &count, false, NULL), BRUNT_OK);
    const brunt_pattern pattern = {.dim = dim, .nodes = nodes, .stencils = lists, .lists = count};
    ck_assert_int_eq(brunt_block_matrix_pattern(&m, &team, &pattern, NULL), BRUNT_OK);
    for (int k = 0; k < size; k++) brunt_block_matrix_diagonal(&m, k / dim)[k % dim * (dim + 1)] = own(k);
    brunt_condensation_fill(&c, &team, &m);
    for (int motion = 0; motion < dim * (dim + 1) / 2; motion++) {
        double of_all = 0, has = 0;
        move_rigidly(dim, nodes, x, motion, u);
        for (int k = 0; k < size; k++) of_all += own(k) * u[k] * u[k];
        brunt_condensation_clear(&c, u);
        brunt_block_matrix_product(&m, &team, u, f);
        for (int k = 0; k < size; k++) has += u[k] * f[k];
        ck_assert_msg(fabs(has - of_all) < 1e-12 * of_all, "motion %d has %.15g of %.15g", motion, has, of_all);
    }
    // Forces that hold a given shape of all nodes, gathered, are those that S wants of the kept ones; spread they are
    // that shape again.
    double shape[MOST], worst = 0;
    for (int k = 0; k < size; k++) shape[k] = sin(3.0 * k);
    for (int k = 0; k < size; k++) {
        f[k] = 0;
        for (int j = 0; j < size; j++) f[k] += 2 * A[k * size + j] * shape[j];
    }
    brunt_block_matrix_zero(&m, &team);
    brunt_condensation_fill(&c, &team, &m);
    memcpy(u, shape, sizeof u), memcpy(g, f, sizeof g);
    brunt_condensation_clear(&c, u);
    brunt_condensation_gather(&c, &team, g);
    brunt_block_matrix_product(&m, &team, u, f);
    for (int k = 0; k < size; k++) worst = fmax(worst, u[k] != 0 ? fabs(f[k] - g[k]) : 0);
    brunt_condensation_spread(&c, &team, u);
    for (int k = 0; k < size; k++) worst = fmax(worst, fabs(u[k] - shape[k]));
    ck_assert_double_lt(worst, 1e-11);
    brunt_condensation_free(&c), brunt_condensed_mesh_free(&mesh), brunt_block_matrix_free(&m);
}
END_TEST

// A mesh whose rim does not hold its inner nodes has no factor.
START_TEST(loose_nodes_are_told) {
    brunt_condensed_mesh mesh;
    brunt_error error = {0};
    uint8_t rim[NODES];
    make_lattice();
    for (int n = 0; n < NODES; n++) rim[n] = on_edge(n);
    for (int k = 0; k < SIZE; k++)
        for (int a = 0; a < DIM; a++) K[5 * DIM + a][k] = K[k][5 * DIM + a] = 0;
    ck_assert_int_ne(brunt_condensed_mesh_make(&mesh, DIM, NODES, K[0], place, rim, &error), BRUNT_OK);
    ck_assert_ptr_nonnull(strstr(error.message, "not positive definite"));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("condense");
    TCase *test = tcase_create("condense");
    tcase_add_loop_test(test, same_as_with_all_nodes, 0, 2);
    tcase_add_loop_test(test, rigid_motions_have_all_of_what_holds, 2, 4);
    tcase_add_test(test, loose_nodes_are_told);
    suite_add_tcase(suite, test);
    return suite_main(suite);
}
