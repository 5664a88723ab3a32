// What a body of material points has in all (mpm/audit.h): beside plain sums of its particles, with any kernel and
// transfer, padding and holes; what is left of large numbers that cancel; bounds.
#include "mpm/audit.h"
#include "tests/support/def_world.h"
#include "tests/support/material_point.h"
#include "tests/support/numbers.h"
#include "world/world.h"

typedef struct form {
    int dim;
    brunt_kernel kernel;
    brunt_transfer transfer;
    bool rings, total;
} form;
static const form forms[] = {
    {2, BRUNT_QUADRATIC, BRUNT_APIC, false, false}, {3, BRUNT_QUADRATIC, BRUNT_APIC, false, false},
    {3, BRUNT_CUBIC, BRUNT_APIC, false, false},     {3, BRUNT_QUADRATIC, BRUNT_FLIP, false, false},
    {2, BRUNT_LINEAR, BRUNT_APIC, false, false},    {3, BRUNT_LINEAR, BRUNT_APIC, false, false},
    {2, BRUNT_QUADRATIC, BRUNT_APIC, true, false},  {3, BRUNT_QUADRATIC, BRUNT_APIC, false, true},
    {2, BRUNT_QUADRATIC, BRUNT_APIC, false, true}};
enum { FORMS = sizeof forms / sizeof forms[0] };
static const double h = 0.1;

// A block of points that move as they like, each in its own way, off the origin of the grid. Padding has what it should
// not count.
static brunt_world *make_block(form is, uint64_t *state) {
    brunt_world_def def = def_begin(is.dim, h);
    def.kernel = is.kernel, def.transfer = is.transfer, def.axisymmetric = is.rings;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *body = def_box(&def, "block", XYZ(0.03, 0.12, -0.11), XYZ(0.58, 0.57, is.dim == 3 ? 0.24 : 0));
    body->spacing = 0.5 * h;
    body->total_lagrangian = is.total;
    brunt_world *world = world_take(&def);
    brunt_particles *p = &world->bodies.mpm[0].particles;
    ck_assert_int_gt(p->slots, p->count);
    static const int fields[] = {BRUNT_FIELD_position, BRUNT_FIELD_velocity, BRUNT_FIELD_affine,
                                 BRUNT_FIELD_deformation_gradient};
    for (int q = 0; q < 4; q++)
        for (int c = 0; c < p->field[fields[q]].components; c++)
            for (int64_t s = 0; s < p->slots; s++)
                brunt_field(p, fields[q])[c][s] += (real)draw_between(state, -0.3, 0.3);
    for (int64_t s = 0; s < p->slots; s++)
        if (p->id[s] < 0) brunt_field(p, BRUNT_FIELD_mass)[0][s] = 7;
    return world;
}

typedef struct plain_sums {
    long double mass, kinetic, linear[3], angular[3], moment[3], scale_linear, scale_angular;
} plain_sums;

static double moment(const brunt_grid *grid, double at) {
    const double u = (at - grid->origin[0]) / h - floor((at - grid->origin[0]) / h);
    return grid->order == 1 ? u * (1 - u) * h * h : grid->order == 2 ? h * h / 4 : h * h / 3;
}

// One particle, by definition: what APIC keeps moves it as C (x - x_p), with the kernel's second moment.
static void add_particle(plain_sums *to, brunt_body *body, int64_t s, double sign) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim, edge = p->point_dim;
    const bool affine = p->field[BRUNT_FIELD_affine].components > 0, total = brunt_total_lagrangian(p);
    const double m = sign * (double)brunt_field(p, BRUNT_FIELD_mass)[0][s];
    double x[3] = {0}, v[3] = {0}, B[3][3] = {{0}}, square = 0, far = 0;
    for (int a = 0; a < dim; a++) {
        x[a] = (double)brunt_field(p, BRUNT_FIELD_position)[a][s],
        v[a] = (double)brunt_field(p, BRUNT_FIELD_velocity)[a][s];
        square += v[a] * v[a], far += x[a] * x[a];
    }
    for (int r = 0; affine && r < dim; r++)
        for (int c = 0; c < dim; c++) {
            const double C = (double)brunt_field(p, BRUNT_FIELD_affine)[r * dim + c][s],
                         D = moment(&body->grid, (double)brunt_kernel_position(p)[c][s]);
            square += C * C * D;
            for (int k = 0; k < dim; k++)
                B[r][k] += C * D *
                           (total ? (double)brunt_field(p, BRUNT_FIELD_deformation_gradient)[k * edge + c][s] : k == c);
        }
    to->mass += m, to->kinetic += 0.5 * m * square, to->scale_linear += m * sqrt(square);
    if (brunt_axisymmetric(p)) {
        to->linear[1] += m * v[1], to->moment[1] += m * x[1];
        return;
    }
    to->scale_angular += m * sqrt(square * far);
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        to->linear[a] += m * v[a], to->moment[a] += m * x[a];
        to->angular[a] += m * (x[i] * v[j] - x[j] * v[i] + B[j][i] - B[i][j]);
    }
}

static void check(double sum, long double plain, double scale) {
    ck_assert_double_le(fabs(sum - (double)plain), (sizeof(real) == sizeof(float) ? 1e-6 : 1e-14) * scale);
}

static void check_sums(const brunt_audit *a, const plain_sums *plain) {
    check(a->mass, plain->mass, a->mass);
    check(a->kinetic, plain->kinetic, a->kinetic);
    check(a->scale_linear, plain->scale_linear, a->scale_linear);
    check(a->scale_angular, plain->scale_angular, a->scale_angular);
    for (int k = 0; k < 3; k++) {
        check(a->linear[k], plain->linear[k], a->scale_linear);
        check(a->angular[k], plain->angular[k], a->scale_angular + a->scale_linear);
        check(a->moment[k], plain->moment[k], plain->mass);
    }
}

START_TEST(sums_are_those_of_the_particles) {
    uint64_t state = 3 + (uint64_t)_i;
    brunt_world *world = make_block(forms[_i], &state);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_particles *p = &body->particles;
    plain_sums plain = {0}, some = {0};
    for (int64_t s = 0; s < p->slots; s++)
        if (p->id[s] >= 0) add_particle(&plain, body, s, 1);
    brunt_audit a = brunt_body_audit(body);
    check_sums(&a, &plain);
    ck_assert_double_gt(a.mass, 0);
    // Some of them, fewer and more than a vector has, one of them padding.
    int64_t slots[40];
    for (int count = 1; count < 40; count++) {
        slots[count - 1] = (17 * count) % p->slots;
        if (p->id[slots[count - 1]] >= 0) add_particle(&some, body, slots[count - 1], 1);
        a = brunt_slots_audit(body, slots, 0, count);
        check_sums(&a, &some);
    }
    // As many places as are no whole vector; bounds, with a hole in it that was the lowest of all.
    const brunt_body_ref *ref = &world->bodies.all[0];
    while (p->id[p->slots - 1] < 0) p->slots--;
    p->slots--, add_particle(&plain, body, p->slots, -1);
    a = brunt_body_audit(body);
    check_sums(&a, &plain);
    brunt_field(p, BRUNT_FIELD_position)[0][5] = -9, brunt_field(p, BRUNT_FIELD_position)[1][p->slots - 1] = 7;
    brunt_body_measure m = brunt_body_measure_of(ref);
    ck_assert_double_eq(m.low[0], -9);
    ck_assert_double_eq(m.high[1], 7);
    p->id[5] = -1, p->holes = true;
    m = brunt_body_measure_of(ref);
    ck_assert_double_gt(m.low[0], -1);
    ck_assert_double_eq(m.high[1], 7);
    brunt_world_destroy(world);
}
END_TEST

// Pairs that go apart with 1e10 m/s leave the one that does not, and nothing of their rounding.
START_TEST(nothing_is_left_of_what_cancels) {
    uint64_t state = 11;
    brunt_world *world = make_block(forms[_i], &state);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_particles *p = &body->particles;
    real *mass = brunt_field(p, BRUNT_FIELD_mass)[0], *v = brunt_field(p, BRUNT_FIELD_velocity)[1];
    int64_t low = 0, high = p->slots - 1, last = 0;
    for (int64_t s = 0; s < p->slots; s++) v[s] = 0, mass[s] = p->id[s] >= 0;
    while (low < high) {
        if (p->id[low] < 0) {
            low++;
        } else if (p->id[high] < 0) {
            high--;
        } else {
            v[low] = (real)(1e10 * draw_between(&state, -1, 1)), v[high] = -v[low];
            last = low++, high--;
        }
    }
    ck_assert_double_eq(brunt_body_audit(body).linear[1], 0);
    const double before = (double)v[last];
    v[last] += (real)4096;
    ck_assert_double_eq(brunt_body_audit(body).linear[1], (double)v[last] - before);
    brunt_world_destroy(world);
}
END_TEST

static void check_alike(const brunt_body_measure *a, const brunt_body_measure *b, double rounding) {
    const double number[][2] = {{a->sums.mass, b->sums.mass},
                                {a->sums.kinetic, b->sums.kinetic},
                                {a->sums.scale_linear, b->sums.scale_linear},
                                {a->sums.scale_angular, b->sums.scale_angular},
                                {a->energy.internal, b->energy.internal}};
    for (size_t k = 0; k < sizeof number / sizeof *number; k++)
        ck_assert_double_eq_tol(number[k][0], number[k][1], rounding * number[k][1]);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(a->sums.linear[k], b->sums.linear[k], rounding * b->sums.scale_linear);
        ck_assert_double_eq_tol(a->sums.angular[k], b->sums.angular[k], rounding * b->sums.scale_linear);
        ck_assert_double_eq_tol(a->sums.moment[k], b->sums.moment[k], rounding * b->sums.mass);
        ck_assert_double_eq(a->low[k], b->low[k]);
        ck_assert_double_eq(a->high[k], b->high[k]);
    }
}

// A large body is summed up in parts, none of them empty, which have it all between them; by any number of threads to
// the same bits as without.
START_TEST(large_bodies_are_summed_in_parts) {
    const bool points = _i == 0;
    brunt_world_def def = def_begin(3, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *one = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1.2, 1.1, 0.6));
    if (!points) one->method = BRUNT_FEM, one->element = BRUNT_HEX8, one->size = 0.05;
    one->spacing = 0.05;
    brunt_body_def *other = def_box(&def, "other", XYZ(2, 0, 0), XYZ(2.2, 0.2, 0.2));
    other->spacing = 0.05;
    def_velocity(one, 1, -0.5, 0.25);
    brunt_world *world = world_take(&def);
    brunt_bodies *bodies = &world->bodies;
    const brunt_body_ref *ref = &bodies->all[0];
    world_steps(world, 3);
    if (points)
        for (int64_t s = 0; s < bodies->mpm[0].particles.slots; s++)
            brunt_field(&bodies->mpm[0].particles, BRUNT_FIELD_deformation_gradient)[0][s] += (real)0.01;
    const int32_t count = ref->ops->parts(ref);
    ck_assert_int_ge(count, 3);
    brunt_body_measure whole = {.low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}},
                       alone = brunt_body_measure_of(ref);
    double mass = 0;
    for (int32_t p = 0; p < count; p++) {
        brunt_body_measure part = {.low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}};
        ref->ops->measure(ref, p, &part);
        ck_assert_double_gt(part.sums.mass, 0);
        ck_assert_double_lt(part.sums.mass, 2.0 / count * alone.sums.mass);
        if (points) ck_assert_double_gt(part.energy.internal, 0);
        mass += part.sums.mass;
        for (int a = 0; a < 3; a++)
            whole.low[a] = fmin(whole.low[a], part.low[a]), whole.high[a] = fmax(whole.high[a], part.high[a]);
    }
    ck_assert_double_eq_tol(mass, 1000 * 1.2 * 1.1 * 0.6, TOLERANCE(1e-9, 1e-2));
    if (points) {
        whole.sums = brunt_body_audit(ref->mpm);
        whole.energy = brunt_body_energy(ref->mpm, 0, ref->mpm->grid.block_count);
    } else {
        const brunt_fem_sums f = brunt_fem_audit(ref->fem, 0, ref->fem->node_count);
        whole.energy = brunt_fem_energy(ref->fem, 0, ref->fem->block_count);
        whole.sums = (brunt_audit){
            .mass = f.mass, .kinetic = f.kinetic, .scale_linear = f.scale_linear, .scale_angular = f.scale_angular};
        memcpy(whole.sums.linear, f.momentum, sizeof f.momentum),
            memcpy(whole.sums.angular, f.angular, sizeof f.angular);
        memcpy(whole.sums.moment, f.first_moment, sizeof f.first_moment);
    }
    check_alike(&alone, &whole, 1e-13);
    const brunt_body_measure second = brunt_body_measure_of(&bodies->all[1]);
    for (int threads = 1; threads <= 4; threads++) {
        brunt_bodies_measure(bodies, threads);
        const brunt_body_measure m = brunt_bodies_measure_of(bodies, ref),
                                 n = brunt_bodies_measure_of(bodies, &bodies->all[1]);
        ck_assert_mem_eq(&m, &alone, sizeof m);
        ck_assert_mem_eq(&n, &second, sizeof n);
        brunt_bodies_forget(bodies);
    }
    // What they were asked for before is forgotten.
    world_steps(world, 1);
    const brunt_body_measure later = brunt_bodies_measure_of(bodies, ref);
    ck_assert(later.sums.moment[0] != alone.sums.moment[0]);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("audit");
    TCase *tests = tcase_create("audit");
    tcase_add_loop_test(tests, sums_are_those_of_the_particles, 0, FORMS);
    tcase_add_loop_test(tests, nothing_is_left_of_what_cancels, 0, 2);
    tcase_add_loop_test(tests, large_bodies_are_summed_in_parts, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
