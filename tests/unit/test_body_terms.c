// What bodies add to an implicit step: gradient and Hessian against differences of the energy, motions that cost
// nothing, the same bits with any number of threads, what the volume allows, and the commit.
#include "linear/assembly.h"
#include "fem/potential.h"
#include "mpm/potential.h"
#include "mpm/sort.h"
#include "tests/support/def_world.h"
#define random_state fem_random_state
#define uniform fem_uniform
#define density fem_density
#define E fem_E
#define nu fem_nu
#include "tests/support/membrane_bodies.h"
#include "tests/support/triangle_mesh.h"
#include "world/world.h"

static double between(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

static const brunt_team one = {.threads = 1}, two = {.threads = 2}, three = {.threads = 3};

// A term, its unknowns, and where they are at u = 0.
typedef struct subject {
    const char *name;
    brunt_term term;
    int dim;
    int64_t nodes;
    double *place, size; // size: of displacements that bend but do not turn anything over ...
    double mean[3];      // ... about a stretch along the axes less 1
} subject;

static double *numbers(const subject *s) { return brunt_alloc((size_t)(s->nodes * s->dim) * sizeof(double)); }
static double inner(const subject *s, const double *a, const double *b) {
    double sum = 0;
    for (int64_t k = 0; k < s->nodes * s->dim; k++) sum += a[k] * b[k];
    return sum;
}

static void hessian_of(const subject *s, const brunt_team *team, const double *u, bool project, brunt_block_matrix *m) {
    brunt_error error;
    const brunt_stencils list = s->term.ops->stencils(s->term.self);
    const brunt_pattern pattern = {.dim = s->dim, .nodes = (int32_t)s->nodes, .stencils = &list, .lists = 1};
    ck_assert_msg(!brunt_block_matrix_pattern(m, team, &pattern, &error), "%s", error.message);
    s->term.ops->hessian(s->term.self, team, u, project, m);
}

// Without a matrix: products and the blocks on the diagonal are the matrix's, projected or not, added to what is there,
// and have the same bits with any number of threads.
static void without_a_matrix(const subject *s, const double *u, bool project) {
    uint64_t seed = 21;
    const int64_t n = s->nodes * s->dim;
    const int size = s->dim * s->dim;
    double *x = numbers(s), *y = numbers(s), *same = numbers(s), *exact = numbers(s), largest = 0;
    brunt_block_matrix m = {0}, blocks = {0};
    const brunt_team *teams[] = {&one, &two, &three};
    hessian_of(s, &one, u, project, &m);
    for (int64_t i = 0; i < n; i++) x[i] = between(&seed);
    brunt_block_matrix_product(&m, &one, x, exact);
    for (int64_t i = 0; i < n; i++) largest = fmax(largest, fabs(exact[i]));
    for (int t = 0; t < 3; t++) {
        const brunt_pattern alone = {.dim = s->dim, .nodes = (int32_t)s->nodes};
        ck_assert_int_eq(brunt_block_matrix_pattern(&blocks, teams[t], &alone, NULL), BRUNT_OK);
        s->term.ops->linearise(s->term.self, teams[t], u, project, &blocks);
        for (int64_t i = 0; i < n; i++) y[i] = largest;
        s->term.ops->product(s->term.self, teams[t], x, y);
        if (t == 0) memcpy(same, y, (size_t)n * sizeof *y);
        ck_assert(!memcmp(same, y, (size_t)n * sizeof *y));
        for (int64_t i = 0; i < n; i++) ck_assert_double_le(fabs(y[i] - largest - exact[i]), 1e-13 * largest);
        for (int32_t k = 0; k < s->nodes; k++)
            for (int c = 0; c < size; c++)
                ck_assert_double_le(fabs(blocks.value[k * size + c] - m.value[m.diagonal[k] * size + c]),
                                    1e-13 * largest);
    }
    brunt_block_matrix_free(&m), brunt_block_matrix_free(&blocks);
    brunt_free(x), brunt_free(y), brunt_free(same), brunt_free(exact);
}

// Derivatives of the energy along p, at u + t p, by Richardson's extrapolation.
static void derivatives(const subject *s) {
    uint64_t seed = 9;
    double *u = numbers(s), *p = numbers(s), *q = numbers(s), *at = numbers(s), *g = numbers(s), *hp = numbers(s);
    double *side[4] = {numbers(s), numbers(s), numbers(s), numbers(s)}, E4[4];
    const int64_t n = s->nodes * s->dim;
    const double step[4] = {1e-3, -1e-3, 2e-3, -2e-3};
    for (int64_t k = 0; k < n; k++)
        u[k] = s->mean[k % s->dim] * (s->place ? s->place[k] : 0) + s->size * between(&seed),
        p[k] = s->size * between(&seed), q[k] = between(&seed);
    s->term.ops->gradient(s->term.self, &one, u, g);
    brunt_block_matrix m = {0};
    hessian_of(s, &one, u, false, &m);
    brunt_block_matrix_product(&m, &one, p, hp);
    for (int k = 0; k < 4; k++) {
        for (int64_t i = 0; i < n; i++) at[i] = u[i] + step[k] * p[i];
        E4[k] = s->term.ops->energy(s->term.self, &one, at).value;
        s->term.ops->gradient(s->term.self, &one, at, side[k]);
    }
    const double slope = (4 * (E4[0] - E4[1]) / 2e-3 - (E4[2] - E4[3]) / 4e-3) / 3, exact = inner(s, g, p);
    double error = 0, size = 0;
    for (int64_t i = 0; i < n; i++) {
        const double d = (4 * (side[0][i] - side[1][i]) / 2e-3 - (side[2][i] - side[3][i]) / 4e-3) / 3;
        error = fmax(error, fabs(d - hp[i])), size = fmax(size, fabs(hp[i]));
    }
    printf("%s: gradient %.1e, Hessian %.1e\n", s->name, fabs(slope - exact) / fabs(exact), error / size);
    ck_assert_double_le(fabs(slope - exact), 1e-7 * fabs(exact));
    ck_assert_double_le(error, 1e-7 * size);
    double *hq = side[0];
    brunt_block_matrix_product(&m, &one, q, hq);
    ck_assert_double_le(fabs(inner(s, q, hp) - inner(s, p, hq)), 1e-12 * size * (double)n);
    // Bits of other numbers of threads.
    const brunt_team *team[2] = {&two, &three};
    for (int k = 0; k < 2; k++) {
        brunt_block_matrix other = {0};
        double *h = numbers(s);
        hessian_of(s, team[k], u, false, &other);
        ck_assert(!memcmp(other.value, m.value, (size_t)(brunt_block_matrix_blocks(&m) * s->dim * s->dim) * 8));
        s->term.ops->gradient(s->term.self, team[k], u, h);
        ck_assert(!memcmp(h, g, (size_t)n * 8));
        const brunt_energy_sum a = s->term.ops->energy(s->term.self, &one, u),
                               b = s->term.ops->energy(s->term.self, team[k], u);
        ck_assert(a.value == b.value && a.magnitude == b.magnitude && a.value > 0 && a.magnitude >= a.value);
        brunt_block_matrix_free(&other);
        brunt_free(h);
    }
    without_a_matrix(s, u, false);
    // Projected: what is less is not there.
    for (int64_t k = 0; k < n; k++) u[k] *= 2;
    without_a_matrix(s, u, true);
    hessian_of(s, &one, u, true, &m);
    for (int k = 0; k < 20; k++) {
        for (int64_t i = 0; i < n; i++) p[i] = between(&seed);
        brunt_block_matrix_product(&m, &one, p, hp);
        ck_assert_double_ge(inner(s, p, hp), 0);
    }
    brunt_block_matrix_free(&m);
    brunt_free(u), brunt_free(p), brunt_free(q), brunt_free(at), brunt_free(g), brunt_free(hp);
    for (int k = 0; k < 4; k++) brunt_free(side[k]);
}

// Translations and turns of a body at rest cost nothing, and no forces.
static void free_motions(const subject *s) {
    double *u = numbers(s), *g = numbers(s), big = 0, stiff = 0;
    uint64_t seed = 4;
    for (int64_t k = 0; k < s->nodes * s->dim; k++) u[k] = s->size * between(&seed);
    s->term.ops->gradient(s->term.self, &one, u, g);
    for (int64_t k = 0; k < s->nodes * s->dim; k++) stiff = fmax(stiff, fabs(g[k])), g[k] = 0;
    const double energy = s->term.ops->energy(s->term.self, &one, u).value;
    for (int motion = 0; motion < 2; motion++) {
        const double c = cos(1.3), sn = sin(1.3);
        for (int64_t n = 0; n < s->nodes; n++) {
            const double *x = s->place + n * s->dim;
            for (int i = 0; i < s->dim; i++) u[n * s->dim + i] = motion ? 0 : 0.3 + 0.1 * i;
            if (motion) u[n * s->dim] = c * x[0] - sn * x[1] - x[0], u[n * s->dim + 1] = sn * x[0] + c * x[1] - x[1];
        }
        ck_assert_double_le(fabs(s->term.ops->energy(s->term.self, &one, u).value), 1e-12 * energy);
        memset(g, 0, (size_t)(s->nodes * s->dim) * 8);
        s->term.ops->gradient(s->term.self, &one, u, g);
        for (int64_t k = 0; k < s->nodes * s->dim; k++) big = fmax(big, fabs(g[k]));
        ck_assert_double_le(big, 1e-10 * stiff);
    }
    brunt_free(u), brunt_free(g);
}

// Squeezed along x by t: J = 1 - t is 0 at t = 1; a tenth is left. The energy is infinite past it.
static void volume_limit(const subject *s) {
    double *u = numbers(s), *p = numbers(s);
    for (int64_t n = 0; n < s->nodes; n++) p[n * s->dim] = -s->place[n * s->dim];
    ck_assert_double_eq_tol(s->term.ops->limit(s->term.self, &one, u, p, 10), 0.9, 1e-12);
    ck_assert(s->term.ops->limit(s->term.self, &three, u, p, 0.5) == 0.5);
    for (int64_t n = 0; n < s->nodes; n++) u[n * s->dim] = -1.1 * s->place[n * s->dim];
    ck_assert(isinf(s->term.ops->energy(s->term.self, &one, u).value));
    brunt_free(u), brunt_free(p);
}

// Body, potential and term, with `base` nodes of others before its own.
enum { BASE = 3 };

static subject subject_of(brunt_fem_body *body, brunt_fem_potential **p) {
    brunt_error error;
    *p = brunt_fem_potential_make(body, BASE, &three, &error);
    ck_assert_msg(*p, "%s", error.message);
    brunt_fem_potential_step(*p, 1e-3);
    subject s = {.name = body->traits->name,
                 .term = brunt_fem_potential_term(*p),
                 .dim = body->dim,
                 .nodes = BASE + body->node_count,
                 .size = 0.03};
    s.place = numbers(&s);
    for (int32_t n = 0; n < body->node_count; n++)
        for (int i = 0; i < s.dim; i++) s.place[(BASE + n) * s.dim + i] = (double)brunt_fem_node(body, n)[i];
    return s;
}

// Nothing moves with nothing; and after a step by `mean` x and a little of all ways the forces are the gradient's, the
// energy the same. Gives the energies.
static brunt_point_energy commit_of(const subject *s, brunt_fem_potential *p, brunt_fem_body *body) {
    double *u = numbers(s), *v = numbers(s), *g = numbers(s);
    uint64_t seed = 2;
    real before[3];
    brunt_error error;
    brunt_fem_workspace work[3] = {{NULL, 0}};
    for (int t = 0; t < 3; t++) ck_assert_int_eq(brunt_fem_workspace_fit(&work[t], body, &error), BRUNT_OK);
    memcpy(before, brunt_fem_node(body, 5), sizeof before);
    ck_assert_int_eq(brunt_fem_commit(p, &three, u, v, work, &error), BRUNT_OK);
    ck_assert(!memcmp(before, brunt_fem_node(body, 5), sizeof before));
    for (int64_t k = 0; k < s->nodes * s->dim; k++)
        u[k] = s->mean[k % s->dim] * s->place[k] + s->size * between(&seed), v[k] = between(&seed);
    const double tried = s->term.ops->energy(s->term.self, &one, u).value;
    s->term.ops->gradient(s->term.self, &one, u, g);
    ck_assert_msg(brunt_fem_commit(p, &three, u, v, work, &error) == BRUNT_OK, "%s", error.message);
    for (int t = 0; t < 3; t++) brunt_fem_workspace_free(&work[t]);
    body->material.implicit = true;
    const brunt_point_energy stored = brunt_fem_energy(body, 0, body->block_count);
    double hourglass = 0, worst = 0, size = 0;
    for (int32_t b = 0; b < body->block_count; b++) hourglass += body->report[b].hourglass_stored;
    ck_assert_double_le(fabs(stored.internal + stored.plastic + hourglass - tried), 1e-10 * tried);
    for (int32_t n = 0; n < body->node_count; n++) {
        real f[3];
        brunt_fem_internal_force(body, n, f);
        for (int i = 0; i < s->dim; i++) {
            worst = fmax(worst, fabs((double)f[i] + g[(BASE + n) * s->dim + i])), size = fmax(size, fabs((double)f[i]));
            ck_assert((double)brunt_fem_node(body, n)[BRUNT_FEM_V + i] == v[(BASE + n) * s->dim + i]);
        }
    }
    ck_assert_double_le(worst, 1e-10 * size);
    // What a step does is seen from its start: to turn the body as it now is costs nothing, and flows nowhere.
    memset(u, 0, (size_t)(s->nodes * s->dim) * 8);
    const double rest = s->term.ops->energy(s->term.self, &one, u).value, c = cos(1.3), sn = sin(1.3);
    for (int32_t n = 0; n < body->node_count; n++) {
        const real *x = brunt_fem_node(body, n);
        u[(BASE + n) * s->dim] = c * (double)x[0] - sn * (double)x[1] - (double)x[0];
        u[(BASE + n) * s->dim + 1] = sn * (double)x[0] + c * (double)x[1] - (double)x[1];
    }
    ck_assert_double_eq_tol(s->term.ops->energy(s->term.self, &one, u).value, rest, 1e-11 * rest);
    ck_assert_double_eq_tol(rest, tried, tried); // some of what was tried may have been dissipated
    brunt_free(u), brunt_free(v), brunt_free(g);
    return (brunt_point_energy){.internal = stored.internal / tried, .plastic = stored.plastic / tried};
}

static const brunt_element_kind kinds[] = {BRUNT_TRI3, BRUNT_QUAD4, BRUNT_TET4, BRUNT_HEX8};

START_TEST(elements) {
    const brunt_element_kind kind = kinds[_i % 4];
    brunt_mesh mesh = box_mesh(kind, 4, 1, 0.2, true);
    brunt_fem_body body = body_of(
        &mesh, (options){.model = _i < 4 ? "neo-hookean" : "von-mises", .hourglass = BRUNT_HOURGLASS_STIFFNESS});
    brunt_fem_potential *p;
    subject s = subject_of(&body, &p);
    derivatives(&s);
    free_motions(&s);
    volume_limit(&s);
    const brunt_point_energy share = commit_of(&s, p, &body);
    if (_i >= 4) ck_assert_double_gt(share.plastic, 0.01);
    brunt_free(s.place);
    brunt_fem_potential_free(p);
    brunt_fem_free(&body);
}
END_TEST

// Membranes, warped and oblique: as they come, taut all over, and wrinkled all over (pulled along x, gathered along y).
START_TEST(membranes) {
    static const char *const models[] = {"neo-hookean", "st-venant-kirchhoff", "linear-elastic"};
    static const double stretch[3][3] = {{0, 0, 0}, {0.15, 0.1, 0}, {0.3, -0.35, 0}};
    const int state = _i / 6;
    brunt_mesh mesh =
        membrane_mesh(_i % 2 ? BRUNT_MEMBRANE_TRI3 : BRUNT_MEMBRANE_QUAD4, 5, 4, 0.3, 0.15, state ? 0.03 : 0.2, true);
    brunt_fem_body body =
        membrane_of(&mesh, (membrane_options){.model = models[_i / 2 % 3], .tension_only = state > 0});
    brunt_fem_potential *p;
    subject s = subject_of(&body, &p);
    s.size = state ? 0.003 : 0.02;
    memcpy(s.mean, stretch[state], sizeof s.mean);
    derivatives(&s);
    if (!state) free_motions(&s);
    double *u = numbers(&s);
    ck_assert(s.term.ops->limit(s.term.self, &one, u, u, 3) == 3);
    commit_of(&s, p, &body);
    brunt_free(u), brunt_free(s.place);
    brunt_fem_potential_free(p);
    brunt_fem_free(&body);
}
END_TEST

// Bodies of one mesh have one Hessian times a number where they are as large and of one shape, and of one material but
// for its stiffness; in two dimensions as well where they are not as large. That of a body that is held is not its own.
START_TEST(hessians_of_bodies_alike) {
    static const double across[] = {1, 1, 3, 1.2};
    static const double tall[] = {1, 1, 3, 1};
    static const double wanted[] = {1, 2.5, 1, 0};
    brunt_fem_body body[4];
    brunt_fem_potential *p[4];
    brunt_error error;
    for (int k = 0; k < 4; k++) {
        brunt_mesh mesh = box_mesh(BRUNT_TRI3, 2, 1, 0, false);
        for (int32_t n = 0; n < mesh.node_count; n++) mesh.nodes[n][0] *= across[k], mesh.nodes[n][1] *= tall[k];
        brunt_material_def law = brunt_material_def_default("m", "linear-elastic");
        brunt_material_set(&law, "density", fem_density, NULL, &error);
        brunt_material_set(&law, "E", k == 1 ? 2.5 * fem_E : fem_E, NULL, &error);
        brunt_material_set(&law, "nu", fem_nu, NULL, &error);
        brunt_material material;
        ck_assert_int_eq(brunt_material_make(&law, &material, &error), BRUNT_OK);
        brunt_body_def def = brunt_body_def_default();
        snprintf(def.name, sizeof def.name, "b");
        def.hourglass_coefficient = NAN;
        ck_assert_int_eq(brunt_fem_make(&def, &material, 2, &mesh, &body[k], &error), BRUNT_OK);
        brunt_mesh_free(&mesh);
        p[k] = brunt_fem_potential_make(&body[k], 0, &one, &error);
        ck_assert_ptr_nonnull(p[k]);
        ck_assert(brunt_fem_hessian_stays(p[k]));
        brunt_fem_hessian_rest(p[k], &one);
        ck_assert_double_eq_tol(brunt_fem_hessian_over(p[k], p[0]), wanted[k], 1e-9);
    }
    uint8_t held[9] = {1};
    body[0].held = held;
    ck_assert(!brunt_fem_hessian_stays(p[0]));
    body[0].held = NULL;
    for (int k = 0; k < 4; k++) brunt_fem_potential_free(p[k]), brunt_fem_free(&body[k]);
}
END_TEST

// A box of points that has been cut by no lattice: sorted, on its grid.
static brunt_world *points_world(int dim, int kernel, brunt_transfer transfer) {
    brunt_world_def def = def_begin(dim, 0.1);
    use_kernel(&def, kernel, triangle_mesh(-0.1, -0.1, 8, 7, 0.1));
    if (kernel > BRUNT_CUBIC) def.scheme = BRUNT_IMPLICIT;
    def.transfer = transfer;
    def.step = 1e-5;
    def_material(&def, "neo-hookean", 1000, 2e6, 0.3);
    def_box(&def, "a", XYZ(0.013, 0.027, 0.031), XYZ(0.53, 0.41, 0.27));
    brunt_world *w = world_take(&def);
    brunt_body *body = &w->bodies.mpm[0];
    brunt_error error;
    uint64_t seed = 6; // off the lattice
    for (int i = 0; i < dim; i++)
        for (int64_t k = 0; k < body->particles.slots; k++)
            brunt_field(&body->particles, BRUNT_FIELD_position)[i][k] += (real)(0.01 * between(&seed));
    ck_assert_msg(!brunt_sort(&body->grid, &body->particles, 1, NULL, &error), "%s", error.message);
    return w;
}

static const double *block_of(const brunt_block_matrix *m, int64_t row, int64_t column) {
    for (int64_t k = m->first[row]; k < m->first[row + 1]; k++)
        if (m->column[k] == column) return m->value + k * m->dim * m->dim;
    ck_abort_msg("no block (%ld, %ld)", (long)row, (long)column);
}

// The Hessian is symmetric to the last bit, and the same to the last bit with numbers of nodes that descend.
static void any_numbers(const subject *s, brunt_mpm_potential *p, int32_t *number, int64_t slots) {
    const int dim = s->dim;
    const int64_t last = s->nodes + 1;
    double *u = numbers(s), *turned = numbers(s);
    uint64_t seed = 5;
    brunt_block_matrix m = {0}, other = {0};
    for (int64_t k = 0; k < s->nodes * dim; k++) u[k] = s->size * between(&seed);
    hessian_of(s, &one, u, false, &m);
    for (int64_t k = 0; k < slots; k++) number[k] = (int32_t)(last - number[k]);
    for (int64_t n = 2; n < s->nodes; n++) memcpy(turned + (last - n) * dim, u + n * dim, (size_t)dim * sizeof *u);
    ck_assert_int_eq(brunt_mpm_potential_step(p, &three, number, 1e-3, NULL), BRUNT_OK);
    hessian_of(s, &three, turned, false, &other);
    ck_assert_int_eq(brunt_block_matrix_blocks(&m), brunt_block_matrix_blocks(&other));
    for (int64_t n = 2; n < s->nodes; n++)
        for (int64_t k = m.first[n]; k < m.first[n + 1]; k++) {
            const double *here = m.value + k * dim * dim, *there = block_of(&other, last - n, last - m.column[k]),
                         *across = block_of(&m, m.column[k], n);
            for (int i = 0; i < dim * dim; i++)
                ck_assert(here[i] == there[i] && here[i] == across[i % dim * dim + i / dim]);
        }
    for (int64_t k = 0; k < slots; k++) number[k] = (int32_t)(last - number[k]);
    ck_assert_int_eq(brunt_mpm_potential_step(p, &three, number, 1e-3, NULL), BRUNT_OK);
    brunt_block_matrix_free(&m), brunt_block_matrix_free(&other), brunt_free(u), brunt_free(turned);
}

START_TEST(points) {
    const bool triangles = _i >= 18; // of cells, of a mesh
    const int dim = triangles ? 2 : _i % 2 + 2, kernel = triangles ? BRUNT_GRID_CUT + _i % 2 : _i / 2 % 3 + 1,
              order = triangles ? 1 : kernel;
    const brunt_transfer transfers[] = {BRUNT_APIC, BRUNT_FLIP, BRUNT_PIC};
    const brunt_transfer transfer = transfers[triangles ? 1 + (_i - 18) / 2 : _i / 6];
    brunt_world *w = points_world(dim, kernel, transfer);
    brunt_body *body = &w->bodies.mpm[0];
    const brunt_grid *grid = &body->grid;
    brunt_error error;
    brunt_mpm_potential *p = brunt_mpm_potential_make(body, &error);
    ck_assert_msg(p, "%s", error.message);
    int32_t *number = brunt_alloc((size_t)(8 * grid->slot_count) * BRUNT_BLOCK_NODES * sizeof *number), count = 2;
    for (int32_t k = 0; k < grid->slot_count * BRUNT_BLOCK_NODES; k++) number[k] = count++;
    ck_assert_int_eq(brunt_mpm_potential_step(p, &three, number, 1e-3, &error), BRUNT_OK);
    char name[40];
    snprintf(name, sizeof name, "points %dD kernel %d", dim, kernel);
    subject s = {.name = name, .term = brunt_mpm_potential_term(p), .dim = dim, .nodes = count, .size = 0.01};
    s.place = numbers(&s);
    for (int32_t slot = 0; slot < grid->slot_count; slot++)
        for (int n = 0; n < BRUNT_BLOCK_NODES; n++) {
            double x[3];
            brunt_grid_node_place(grid, slot, n, x);
            for (int i = 0; i < dim; i++) s.place[(int64_t)number[slot * BRUNT_BLOCK_NODES + n] * dim + i] = x[i];
        }
    if (_i < 6 || (triangles && _i < 20)) {
        derivatives(&s);
        free_motions(&s);
        volume_limit(&s);
        any_numbers(&s, p, number, (int64_t)grid->slot_count * BRUNT_BLOCK_NODES);
        // Some nodes that are no unknowns.
        for (int32_t k = 0; k < grid->slot_count * BRUNT_BLOCK_NODES; k += 7) number[k] = -1;
        ck_assert_int_eq(brunt_mpm_potential_step(p, &three, number, 1e-3, &error), BRUNT_OK);
        derivatives(&s);
        for (int32_t k = 0, n = 2; k < grid->slot_count * BRUNT_BLOCK_NODES; k++) number[k] = n++;
        ck_assert_int_eq(brunt_mpm_potential_step(p, &three, number, 1e-3, &error), BRUNT_OK);
    }

    const int64_t room = 4 * body->particles.slots * dim;
    // A step, of velocities that are not u / dt: momenta of the particles are the grid's, energy as it was tried,
    // places by the interpolation.
    double *u = numbers(&s), *v = numbers(&s), *zero = numbers(&s), *at = brunt_alloc((size_t)room * 8);
    uint64_t seed = 12;
    for (int64_t k = 0; k < s.nodes * dim; k++) u[k] = s.size * between(&seed), v[k] = 10 * between(&seed);
    brunt_mpm_interpolate(p, &one, u, at);
    const double tried = s.term.ops->energy(s.term.self, &one, u).value;
    double turn = 0, linear[3] = {0}, grid_turn = 0, grid_linear[3] = {0}, scale = 0;
    brunt_particles *q = &body->particles;
    const real *mass = brunt_field(q, BRUNT_FIELD_mass)[0];
    double *moments =
        numbers(&s); // of the grid, from the particles' weights: m_i v_i by the transpose of the interpolation
    double *probe = numbers(&s), *probed = brunt_alloc((size_t)room * 8);
    for (int64_t n = 2; n < s.nodes; n++) { // m_i = sum w m, node by node
        double m = 0;
        probe[n * dim] = 1;
        brunt_mpm_interpolate(p, &one, probe, probed);
        for (int64_t k = 0; k < q->slots; k++) m += (double)mass[k] * probed[k * dim];
        probe[n * dim] = 0;
        const double *x = s.place + n * dim, *d = u + n * dim, *vn = v + n * dim;
        grid_turn += m * ((x[0] + d[0]) * vn[1] - (x[1] + d[1]) * vn[0]);
        for (int i = 0; i < dim; i++) grid_linear[i] += m * vn[i], scale += m * fabs(vn[i]);
    }
    const real x0 = brunt_field(q, BRUNT_FIELD_position)[0][3];
    const brunt_mpm_motion motion = {.u = u, .v = v, .v_old = zero, .transfer = transfer, .flip = 1};
    brunt_mpm_result result;
    ck_assert_msg(!brunt_mpm_commit(p, &two, &motion, &result, &error), "%s", error.message);
    ck_assert(brunt_field(q, BRUNT_FIELD_position)[0][3] == (real)(x0 + (real)at[3 * dim]));
    ck_assert_double_le(fabs(brunt_body_energy(body, 0, body->grid.block_count).internal - tried), 1e-11 * tried);
    const brunt_audit audit = brunt_body_audit(body);
    for (int i = 0; i < dim; i++) linear[i] = audit.linear[i];
    turn = audit.angular[2];
    for (int i = 0; i < dim; i++) ck_assert_double_le(fabs(linear[i] - grid_linear[i]), 1e-12 * scale);
    if (transfer == BRUNT_APIC && order > 1) ck_assert_double_le(fabs(turn - grid_turn), 1e-12 * scale);
    // The linear kernel's second moment follows the place: what APIC keeps of its field may grow as a particle moves.
    if (transfer != BRUNT_APIC || order > 1) ck_assert_double_ge(result.transfer, -1e-12 * result.kinetic);
    ck_assert_double_eq_tol(result.kinetic, audit.kinetic, 1e-10 * audit.kinetic);
    // FLIP's share of the change, of a second step, whose sort may have more padding; slots that are new to the grid
    // have no unknowns.
    for (int32_t k = count - 2; transfer == BRUNT_FLIP && k < 8 * (count - 2); k++) number[k] = -1;
    for (int64_t k = 0; transfer == BRUNT_FLIP && k < s.nodes * dim; k++) u[k] = 0, zero[k] = between(&seed);
    if (transfer == BRUNT_FLIP) {
        const brunt_mpm_motion again = {.u = u, .v = v, .v_old = zero, .transfer = transfer, .flip = 0.7};
        ck_assert_msg(!brunt_sort(&body->grid, q, 1, NULL, &error), "%s", error.message);
        ck_assert_int_eq(brunt_mpm_potential_step(p, &one, number, 1e-3, &error), BRUNT_OK);
        ck_assert_int_le(q->slots * dim, room);
        int64_t k = 3; // the next that is no padding
        while (q->id[k] < 0) k++;
        const double had = (double)brunt_field(q, BRUNT_FIELD_velocity)[1][k];
        brunt_mpm_interpolate(p, &one, v, at), brunt_mpm_interpolate(p, &one, zero, probed);
        ck_assert_int_eq(brunt_mpm_commit(p, &one, &again, &result, &error), BRUNT_OK);
        const double now = 0.7 * (had + at[k * dim + 1] - probed[k * dim + 1]) + 0.3 * at[k * dim + 1];
        ck_assert_double_eq_tol((double)brunt_field(q, BRUNT_FIELD_velocity)[1][k], now, 1e-12);
    }
    brunt_free(u), brunt_free(v), brunt_free(zero), brunt_free(at), brunt_free(moments), brunt_free(probe),
        brunt_free(probed);
    brunt_free(s.place), brunt_free(number);
    brunt_mpm_potential_free(p);
    brunt_world_destroy(w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("body terms");
    if (sizeof(real) == sizeof(double)) { // what implicit steps are of
        ADD_LOOP(elements, 8);
        ADD_LOOP(membranes, 18);
        ADD_LOOP(points, 22);
        ADD_LOOP(hessians_of_bodies_alike, 1);
    }
    return suite_main(suite);
}
