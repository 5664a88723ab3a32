// Implicit and load steps of material points beside planes of symmetry: a part of a body moves as it does in the whole,
// by each kernel and transfer, solver, dimension, up to three planes across each other, on either side of them.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double H = 0.125;     // [m]
static const double SAME = 1e-10;  // of what moves, and of energies
static const double KEPT = 1e-9;   // of momenta, of energies
static const double SPACING = 0.5; // of particles, cells

typedef enum scheme { EULER, NEWMARK, LOADS } scheme;

typedef struct part {
    int dim, planes; // normal to the first axes
    scheme scheme;
    const char *name;
    bool behind, slips;  // on the other side of the planes, against their axes; planes of slip
    double at;           // [m] of the planes; the grid's origin is on them
    brunt_kernel kernel; // 0: quadratic
    brunt_transfer transfer;
    brunt_solver solver;
} part;

static const part parts[] = {
    {2, 1, EULER, "half, euler", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, NEWMARK, "half, newmark", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, NEWMARK, "half, other side", .behind = true, .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, NEWMARK, "half, elsewhere", .at = 0.7321, .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, NEWMARK, "half, slip", .slips = true, .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, NEWMARK, "half, flip", .transfer = BRUNT_FLIP, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, EULER, "half, cubic pic", .transfer = BRUNT_PIC, .kernel = BRUNT_CUBIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, EULER, "half, linear flip", .transfer = BRUNT_FLIP, .kernel = BRUNT_LINEAR, .solver = BRUNT_SOLVER_DIRECT},
    {2, 1, LOADS, "half, loads", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 2, NEWMARK, "quarter", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 2, NEWMARK, "quarter, cubic, other side", .behind = true, .kernel = BRUNT_CUBIC, .at = -3.07,
     .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {2, 2, NEWMARK, "quarter, pcg", .solver = BRUNT_SOLVER_PCG, .transfer = BRUNT_APIC},
    {2, 2, NEWMARK, "quarter, matrix-free", .solver = BRUNT_SOLVER_MATRIX_FREE, .transfer = BRUNT_APIC},
    {3, 2, EULER, "quarter in space", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {3, 2, LOADS, "quarter in space, loads", .behind = true, .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {3, 3, NEWMARK, "eighth", .transfer = BRUNT_APIC, .solver = BRUNT_SOLVER_DIRECT},
    {3, 3, EULER, "eighth, matrix-free, other side", .behind = true, .solver = BRUNT_SOLVER_MATRIX_FREE,
     .transfer = BRUNT_APIC},
};
enum { PARTS = sizeof parts / sizeof *parts };

static brunt_world *make(const part *p, bool whole, int threads) {
    brunt_world_def def = def_begin(p->dim, H);
    const int last = p->dim - 1;
    const double side = p->behind ? -1 : 1;
    double low[3] = {0}, high[3] = {0};
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def.kernel = p->kernel ? p->kernel : BRUNT_QUADRATIC, def.transfer = p->transfer, def.threads = threads;
    go_implicit(&def, p->scheme == NEWMARK ? BRUNT_NEWMARK : BRUNT_EULER, 5e-3);
    def.newton.tolerance = 1e-13, def.newton.solver = p->solver, def.newton.accuracy = 1e-12;
    if (p->scheme == LOADS) def.scheme = BRUNT_STATIC, def.load_steps = 4, def.step = 0, def.end = 1;
    for (int a = 0; a < p->dim; a++) {
        const double wide = (p->dim == 2 ? 4 : 2) * H * (a ? 1 : 1.5), other = a < p->planes ? whole ? -wide : 0 : 0;
        def.origin[a] = p->at;
        low[a] = p->at + fmin(side * wide, side * other), high[a] = p->at + fmax(side * wide, side * other);
    }
    brunt_body_def *b = def_box(&def, "block", low, high);
    b->spacing = SPACING * H;
    for (int a = 0; a < p->planes; a++) {
        double normal[3] = {0};
        normal[a] = side;
        if (!whole) def_plane(&def, XYZ(p->at, p->at, p->at), normal, p->slips ? BRUNT_SLIP : BRUNT_SYMMETRY, 0);
    }
    if (p->planes < p->dim) { // on a floor
        double normal[3] = {0};
        normal[last] = side;
        def_plane(&def, XYZ(p->at, p->at, p->at), normal, BRUNT_STICK, 0);
        def.gravity[last] = -side * (p->scheme == LOADS ? 20 : 50);
    }
    b->wave_velocity[0] = p->scheme == LOADS ? 0 : 2;
    b->wave_vector[0] = PI, b->wave_phase = -PI * p->at;
    return world_take(&def);
}

// The particle that is nearest to a place.
static int64_t find_particle(const double *x, int64_t count, const double at[3]) {
    int64_t best = 0;
    double least = INFINITY;
    for (int64_t i = 0; i < count; i++) {
        const double *y = x + 3 * i;
        const double square = pow(y[0] - at[0], 2) + pow(y[1] - at[1], 2) + pow(y[2] - at[2], 2);
        if (square < least) least = square, best = i;
    }
    return best;
}

// Greatest difference of a field of three components between a part's particles and those of the whole that began where
// they did, of the greatest of all.
static double differ(brunt_world *some, brunt_world *whole, const double *from, const double *whole_from,
                     const char *field) {
    double *a = world_field(some, 0, field), *b = world_field(whole, 0, field), worst = 0, most = 0;
    for (int64_t i = 0; i < brunt_body_particles(some, 0); i++) {
        const int64_t k = find_particle(whole_from, brunt_body_particles(whole, 0), &from[3 * i]);
        for (int c = 0; c < 3; c++) {
            worst = fmax(worst, fabs(a[3 * i + c] - b[3 * k + c]));
            most = fmax(most, fabs(b[3 * k + c]));
        }
    }
    free(a), free(b);
    return most > 0 ? worst / most : worst;
}

static double off(double one, double whole, double share) {
    return whole == 0 ? fabs(one) : fabs(one - share * whole) / fabs(share * whole);
}

START_TEST(as_whole) {
    const part *p = &parts[_i];
    brunt_world *some = make(p, false, 1), *whole = make(p, true, 1);
    double *from = world_field(some, 0, "position"), *whole_from = world_field(whole, 0, "position");
    const int steps = p->scheme == LOADS ? 4 : p->dim == 3 ? 6 : 15;
    world_steps(some, steps), world_steps(whole, steps);
    const brunt_energy e = world_energy(some), all = world_energy(whole);
    const double share = pow(0.5, p->planes), place = differ(some, whole, from, whole_from, "position"),
                 velocity = differ(some, whole, from, whole_from, "velocity"),
                 kinetic = off(e.kinetic, all.kinetic, share), internal = off(e.internal, all.internal, share),
                 taken = off(e.scheme, all.scheme, share) * fabs(all.scheme) / all.internal;
    const brunt_momentum m = world_momentum(some);
    printf("  %s: %lld of %lld particles; place %.1e, velocity %.1e, kinetic %.1e, internal %.1e, scheme %.1e; "
           "momentum %.1e, angular %.1e (whole %.1e), energy %.1e\n",
           p->name, (long long)brunt_body_particles(some, 0), (long long)brunt_body_particles(whole, 0), place,
           velocity, kinetic, internal, taken, m.linear_drift, m.angular_drift, world_momentum(whole).angular_drift,
           e.error_relative);
    ck_assert_int_eq(brunt_body_particles(some, 0) << p->planes, brunt_body_particles(whole, 0));
    ck_assert_double_gt(all.internal, 1e-3);
    ck_assert_double_le(place, SAME);
    ck_assert_double_le(velocity, SAME);
    ck_assert_double_le(kinetic, SAME);
    ck_assert_double_le(internal, SAME);
    ck_assert_double_le(taken, SAME);
    if (p->scheme != LOADS) ck_assert_double_le(m.linear_drift, KEPT);
    ck_assert_double_eq_tol(e.error_relative, all.error_relative, KEPT);
    if (p->scheme != LOADS) ck_assert_double_le(fabs(e.error_relative), KEPT); // of load steps it is by the trapezium
    free(from), free(whole_from);
    brunt_world_destroy(some), brunt_world_destroy(whole);
}
END_TEST

// ------------------------------------------------------------------------------------------ on a mesh

// Points that fall on a mesh and are kept from it by a barrier, beside the plane too.
static brunt_world *make_on_mesh(bool whole, double friction, int threads) {
    brunt_world_def def = def_begin(2, H);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    go_implicit(&def, BRUNT_NEWMARK, 2.5e-3);
    def.newton.tolerance = 1e-13, def.newton.solver = BRUNT_SOLVER_DIRECT, def.threads = threads;
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.friction = friction, def.contact.distance = 0.02;
    brunt_body_def *b = def_box(&def, "block", XYZ(whole ? -4 * H : 0, 0.01, 0), XYZ(4 * H, 0.01 + 4 * H, 0));
    b->spacing = SPACING * H;
    def_velocity(b, 0, -1, 0);
    b->wave_velocity[0] = 2, b->wave_vector[0] = PI;
    brunt_body_def *mesh = def_box(&def, "mesh", XYZ(whole ? -8 * H : 0, -2 * H, 0), XYZ(8 * H, 0, 0));
    mesh->method = BRUNT_FEM, mesh->element = BRUNT_QUAD4, mesh->size = H;
    if (!whole) def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, -2 * H, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    def.gravity[1] = -50;
    return world_take(&def);
}

START_TEST(on_mesh) {
    brunt_world *some = make_on_mesh(false, _i * 0.3, 1), *whole = make_on_mesh(true, _i * 0.3, 1);
    double *from = world_field(some, 0, "position"), *whole_from = world_field(whole, 0, "position");
    world_steps(some, 20), world_steps(whole, 20);
    const brunt_energy e = world_energy(some), all = world_energy(whole);
    const double place = differ(some, whole, from, whole_from, "position"),
                 velocity = differ(some, whole, from, whole_from, "velocity"),
                 kinetic = off(e.kinetic, all.kinetic, 0.5), internal = off(e.internal, all.internal, 0.5);
    printf(
        "  friction %.1f: place %.1e, velocity %.1e, kinetic %.1e, internal %.1e, heat %.4g of %.4g J; pressed by %.4g "
        "N s; momentum %.1e, energy %.1e\n",
        _i * 0.3, place, velocity, kinetic, internal, e.friction, all.friction, world_pair(some, 0).impulse[1],
        world_momentum(some).linear_drift, e.error_relative);
    ck_assert_double_gt(fabs(world_pair(some, 0).impulse[1]), 1);
    ck_assert_double_le(place, SAME);
    ck_assert_double_le(velocity, SAME);
    ck_assert_double_le(kinetic, SAME);
    ck_assert_double_le(internal, SAME);
    ck_assert_double_le(off(e.friction, all.friction, 0.5), _i ? SAME : 0);
    ck_assert_double_le(world_momentum(some).linear_drift, KEPT);
    free(from), free(whole_from);
    brunt_world_destroy(some), brunt_world_destroy(whole);
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

static brunt_world *any(int which, int threads) {
    return which < PARTS ? make(&parts[which], false, threads) : make_on_mesh(false, 0.3, threads);
}

START_TEST(threads) {
    brunt_world *world[] = {any(_i, 1), any(_i, 2), any(_i, 3)};
    check_threads(world, 3, 4);
}
END_TEST

START_TEST(restart) {
    if (_i >= PARTS || parts[_i].scheme != LOADS) check_restart(any(_i, 1), any(_i, 2));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_symmetry");
    ADD_LOOP(as_whole, PARTS);
    ADD_LOOP(on_mesh, 2);
    ADD_LOOP(threads, PARTS + 1);
    ADD_LOOP(restart, PARTS + 1);
    return suite_main(suite);
}
#endif
