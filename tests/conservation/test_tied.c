// Bodies of material points that are tied to each other: at the nodes that both reach they have one velocity, that of
// one body of both their masses. With APIC, whose particles know nothing of the velocities a node had before, tied
// parts of a bar are the bar, to rounding.
#include "tests/support/def_world.h"

enum { PARTS = 3, SHAPES = 3 };
static const char *const shapes[SHAPES] = {"2D", "3D", "rings"};
static const double spacing = 0.03125;

typedef struct choice {
    int shape;
    brunt_kernel kernel;
    brunt_transfer transfer;
} choice;

static choice choose(int i) {
    return (choice){i % 3, (brunt_kernel)(BRUNT_QUADRATIC + i / 3 % 2), (brunt_transfer)(i / 6)};
}

static const char *name_of(choice c) {
    static const char *const transfers[] = {"pic", "flip", "apic"};
    static char text[32];
    snprintf(text, sizeof text, "%-5s %-9s %-4s", shapes[c.shape], c.kernel == BRUNT_CUBIC ? "cubic" : "quadratic",
             transfers[c.transfer]);
    return text;
}

static brunt_world_def begin(choice c) {
    brunt_world_def def = def_begin(c.shape == 1 ? 3 : 2, 3 * spacing);
    def.kernel = c.kernel;
    def.transfer = c.transfer;
    def.axisymmetric = c.shape == 2;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def.contact.method = BRUNT_CONTACT_TIED;
    def.step = 1e-3; // a third of the stable one
    return def;
}

// Turned, moved off the grid's lines, flying and turning; rings stand upright and only fly.
static void throw_it(brunt_body_def *body, int shape) {
    body->particles_per_cell = 0;
    body->spacing = spacing;
    if (shape == 2) {
        body->place = brunt_placement_translate(body->place, XYZ(0, 1.03, 0));
        def_velocity(body, 0, 0.7, 0);
    } else {
        body->place = brunt_placement_rotate(body->place, XYZ(0, 0, 1), 0.4, XYZ(0, 0, 0));
        if (shape == 1) body->place = brunt_placement_rotate(body->place, XYZ(1, 0, 0), 0.2, XYZ(0, 0, 0));
        body->place = brunt_placement_translate(body->place, XYZ(0.07, 1.03, 0.11));
        def_velocity(body, 2, 0.7, shape == 1 ? -0.4 : 0);
        body->spin[2] = 3;
        body->spin_about[1] = 1;
    }
    // So that parts push and pull each other, along the bar and across.
    body->wave_velocity[0] = shape == 2 ? 0 : 0.8, body->wave_velocity[1] = 0.5;
    body->wave_vector[0] = 2 * PI, body->wave_vector[1] = 5;
}

// A bar cut across into `parts`. The lattices of the parts are that of the whole.
static brunt_world_def bar(choice c, int parts) {
    static const double cut[PARTS + 1] = {-0.5, -0.125, 0.125, 0.5};
    static const char *const names[PARTS] = {"a", "b", "c"};
    brunt_world_def def = begin(c);
    for (int p = 0; p < parts; p++) {
        const double from = cut[p], to = p + 1 == parts ? cut[PARTS] : cut[p + 1];
        throw_it(c.shape == 2 ? def_box(&def, names[p], XYZ(0, from, 0), XYZ(0.25, to, 0))
                              : def_box(&def, names[p], XYZ(from, -0.125, -0.125), XYZ(to, 0.125, 0.125)),
                 c.shape);
    }
    return def;
}

typedef struct point {
    double x[3], v[3], F[9];
} point;

static int64_t all_points(brunt_world *world, point **out) { // free()
    int64_t count = 0, at = 0;
    for (int b = 0; b < brunt_body_count(world); b++) count += brunt_body_particles(world, b);
    *out = calloc((size_t)count, sizeof **out);
    for (int b = 0; b < brunt_body_count(world); b++) {
        double *x = world_field(world, b, "position"), *v = world_field(world, b, "velocity"),
               *F = world_field(world, b, "deformation_gradient");
        for (int64_t i = 0; i < brunt_body_particles(world, b); i++, at++) {
            memcpy((*out)[at].x, x + 3 * i, sizeof(*out)[at].x);
            memcpy((*out)[at].v, v + 3 * i, sizeof(*out)[at].v);
            memcpy((*out)[at].F, F + 9 * i, sizeof(*out)[at].F);
        }
        free(x), free(v), free(F);
    }
    return count;
}

static double apart(const double *a, const double *b, int n) {
    double square = 0;
    for (int i = 0; i < n; i++) square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square);
}

// Of each point of one world the one of the other that lies where it lies.
static int64_t *partners(const point *of, const point *among, int64_t count) {
    int64_t *found = malloc((size_t)count * sizeof *found);
    for (int64_t i = 0; i < count; i++) {
        found[i] = 0;
        for (int64_t k = 1; k < count; k++)
            if (apart(of[i].x, among[k].x, 3) < apart(of[i].x, among[found[i]].x, 3)) found[i] = k;
        ck_assert_double_le(apart(of[i].x, among[found[i]].x, 3), 1e-3 * spacing);
    }
    return found;
}

// ------------------------------------------------------------------------------------------ tied parts of a bar

// Kinetic and stored energy are those of the whole; what the whole books as lost in the transfer, the parts book as
// lost in the transfer and in their contact: a common velocity has less energy than two.
static void judge_energy(choice c, const brunt_energy *whole, const brunt_energy *parts) {
    const double close = (sizeof(real) == 4 ? 1e-3 : 1e-10) * whole->initial;
    printf(
        "  %s energy of the whole (of the parts less that): kinetic %.5f (%.0e) stored %.5f (%.0e); lost in transfer "
        "%.2e, of the parts %.2e + contact %.2e; ledger %.1e, %.1e\n",
        name_of(c), whole->kinetic / whole->initial, (parts->kinetic - whole->kinetic) / whole->initial,
        whole->internal / whole->initial, (parts->internal - whole->internal) / whole->initial,
        whole->transfer / whole->initial, parts->transfer / whole->initial, parts->contact / whole->initial,
        whole->error_relative, parts->error_relative);
    ck_assert_double_eq_tol(parts->kinetic, whole->kinetic, close);
    ck_assert_double_eq_tol(parts->internal, whole->internal, close);
    ck_assert_double_eq_tol(parts->error, whole->error, close);
    ck_assert_double_gt(parts->contact, 0);
    ck_assert(whole->contact == 0 && parts->friction == 0);
}

START_TEST(tied_parts_are_the_whole) {
    choice c = choose(_i);
    if (c.transfer == BRUNT_FLIP) return; // its points get the change of their own body's nodes, not of the common ones
    brunt_world_def one = bar(c, 1), three = bar(c, PARTS);
    brunt_world *whole = world_take(&one), *parts = world_take(&three);
    point *a, *b;
    const int64_t count = all_points(whole, &a);
    ck_assert_int_eq(all_points(parts, &b), count);
    int64_t *partner = partners(b, a, count);
    free(a), free(b);
    world_steps(whole, 40);
    world_steps(parts, 40);
    all_points(whole, &a);
    all_points(parts, &b);
    double x = 0, v = 0, F = 0, strain = 0;
    static const double still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int64_t i = 0; i < count; i++) {
        const point *w = &a[partner[i]];
        x = fmax(x, apart(b[i].x, w->x, 3)), v = fmax(v, apart(b[i].v, w->v, 3)), F = fmax(F, apart(b[i].F, w->F, 9));
        strain = fmax(strain, apart(w->F, still, 9));
    }
    const brunt_momentum m = world_momentum(parts);
    printf("  %s of %lld points differ at most: place %.1e m, velocity %.1e m/s, F %.1e; F to %.2f of unity; drift "
           "%.1e %.1e\n",
           name_of(c), (long long)count, x, v, F, strain, m.linear_drift, m.angular_drift);
    const double close = sizeof(real) == 4 ? 1e-3 : 1e-10;
    ck_assert_double_gt(strain, 0.005);
    ck_assert(x < close && v < 10 * close && F < close);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    if (c.transfer == BRUNT_APIC && c.shape != 2) ck_assert_double_le(m.angular_drift, ROUNDING);
    const brunt_energy energy = world_energy(whole), tied = world_energy(parts);
    judge_energy(c, &energy, &tied);
    free(a), free(b), free(partner);
    brunt_world_destroy(whole);
    brunt_world_destroy(parts);
}
END_TEST

// Parts thrown apart, or along each other: tied they stay, in contact they go.
START_TEST(they_neither_part_nor_slide) {
    choice c = choose(_i);
    if (c.shape == 1) return; // the sums are the same
    double way[2], energy[2];
    for (int method = 0; method < 2; method++) {
        brunt_world_def def = begin(c);
        if (!method) def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
        for (int p = 0; p < 2; p++) {
            brunt_body_def *part =
                c.shape == 2 ? def_box(&def, p ? "b" : "a", XYZ(0, p ? 0 : -0.25, 0), XYZ(0.25, p ? 0.25 : 0, 0))
                             : def_box(&def, p ? "b" : "a", XYZ(p ? 0 : -0.25, 0, 0), XYZ(p ? 0.25 : 0, 0.25, 0.25));
            part->particles_per_cell = 0;
            part->spacing = spacing;
            def_velocity(part, c.shape == 2 ? 0 : 0.3 * p, 0.3 * p, 0);
        }
        brunt_world *world = world_take(&def);
        const brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
        world_until(world, 0.2);
        const brunt_body_sums a1 = world_sums(world, 0), b1 = world_sums(world, 1);
        way[method] = hypot(b1.centre[0] - a1.centre[0] - b.centre[0] + a.centre[0],
                            b1.centre[1] - a1.centre[1] - b.centre[1] + a.centre[1]);
        const brunt_momentum m = world_momentum(world);
        const brunt_energy e = world_energy(world);
        energy[method] = fabs(e.error_relative);
        ck_assert_double_le(m.linear_drift, 3 * ROUNDING); // some hundred steps, cubic in float 1.4
        if (c.transfer == BRUNT_APIC && c.shape != 2) ck_assert_double_le(m.angular_drift, 3 * ROUNDING);
        brunt_world_destroy(world);
    }
    printf("  %s thrown apart: %.3f m in contact, %.3f m tied; ledger %.1e, %.1e\n", name_of(c), way[0], way[1],
           energy[0], energy[1]);
    ck_assert_double_ge(way[0], 0.3 * 0.19);
    ck_assert_double_le(way[1], 0.5 * way[0]);
    ck_assert_double_le(energy[1], 2e-2);
}
END_TEST

// Two bodies in one place have no normal to each other, and need none: those that fly through each other stop.
START_TEST(no_normal_is_wanted) {
    choice c = {_i, BRUNT_QUADRATIC, BRUNT_APIC};
    brunt_world_def def = begin(c);
    def.contact.allow_overlap = true;
    for (int p = 0; p < 2; p++) {
        brunt_body_def *body = def_box(&def, p ? "b" : "a", XYZ(0, 0, 0), XYZ(0.25, 0.25, 0.25));
        body->particles_per_cell = 0;
        body->spacing = spacing;
        def_velocity(body, c.shape == 2 ? 0 : p ? 1 : -1, p ? 1 : -1, 0);
    }
    brunt_world *world = world_take(&def);
    const double before = world_energy(world).kinetic;
    world_steps(world, 3);
    const brunt_energy e = world_energy(world);
    for (int b = 0; b < 2; b++)
        for (int a = 0; a < 2; a++) ck_assert_double_le(fabs(world_sums(world, b).velocity[a]), 1e3 * ROUNDING);
    ck_assert_double_eq_tol(e.contact + e.transfer, before, 1e-6 * before);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ beside contact

// A bar of two tied parts, cut where a third body hits it: all three meet at the nodes there. `whole`: the bar uncut.
static brunt_world *hit(int dimension, bool whole, double friction, int threads) {
    static const brunt_pair_def tied = {.a = "a", .b = "b", .method = BRUNT_CONTACT_TIED, .friction = 0.5};
    brunt_world_def def = begin((choice){dimension == 3, BRUNT_QUADRATIC, BRUNT_APIC});
    def.threads = threads;
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
    def.contact.friction = friction;
    if (!whole) {
        def.contact.pairs = brunt_alloc(sizeof tied);
        def.contact.pairs[def.contact.pair_count++] = tied;
    }
    def_box(&def, "a", XYZ(-0.5, 0, 0), XYZ(whole ? 0.5 : 0, 0.25, 0.25));
    if (!whole) def_box(&def, "b", XYZ(0, 0, 0), XYZ(0.5, 0.25, 0.25));
    brunt_body_def *hammer = def_box(&def, "c", XYZ(-0.125, 0.28125, 0), XYZ(0.125, 0.53125, 0.25));
    def_velocity(hammer, 1, -2, 0);
    for (int b = 0; b < def.body_count; b++) def.bodies[b].particles_per_cell = 0, def.bodies[b].spacing = spacing;
    return world_take(&def);
}

START_TEST(three_bodies_one_pair_tied) {
    const int dimension = 2 + _i;
    brunt_world *whole = hit(dimension, true, 0.3, 1), *parts = hit(dimension, false, 0.3, 1);
    world_until(whole, 0.1);
    world_until(parts, 0.1);
    const brunt_momentum m = world_momentum(parts);
    const brunt_energy e = world_energy(parts), one = world_energy(whole);
    const brunt_body_sums c = world_sums(parts, 2), alone = world_sums(whole, 1);
    brunt_body_sums a = world_sums(parts, 0), b = world_sums(parts, 1);
    printf("  %dD hammer on the seam: leaves at %.4f %.4f m/s, of the whole bar %.4f %.4f; drift %.1e %.1e; ledger "
           "%.1e, %.1e; friction %.4f, %.4f of the energy\n",
           dimension, c.velocity[0], c.velocity[1], alone.velocity[0], alone.velocity[1], m.linear_drift,
           m.angular_drift, e.error_relative, one.error_relative, e.friction / e.initial, one.friction / one.initial);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    ck_assert_double_le(m.angular_drift, ROUNDING);
    ck_assert_double_eq_tol(c.velocity[0], alone.velocity[0], 0.05);
    ck_assert_double_eq_tol(c.velocity[1], alone.velocity[1], 0.05);
    ck_assert_double_le(fabs(e.error_relative), 1e-2);
    ck_assert_double_gt(e.friction, 0);
    ck_assert_double_eq_tol(e.friction, one.friction, 0.3 * one.friction);
    // Pairs are in the order of names: ab, ac, bc. The tied one rubs nothing away; the blow goes through both halves.
    ck_assert_double_eq(world_pair(parts, 0).friction_work, 0);
    ck_assert_double_gt(world_pair(parts, 1).friction_work, 0);
    ck_assert_double_gt(world_pair(parts, 2).friction_work, 0);
    const double left = world_pair(parts, 1).impulse[1], right = world_pair(parts, 2).impulse[1],
                 blow = world_pair(whole, 0).impulse[1];
    printf("  of a blow of %.4f N s %.4f and %.4f go through the halves\n", blow, left, right);
    ck_assert(left > 0.05 * blow && right > 0.05 * blow);
    ck_assert_double_eq_tol(left + right, blow, 0.02 * blow);
    // The seam holds: the halves are as far from each other as they were, to the bending.
    ck_assert_double_eq_tol(b.centre[0] - a.centre[0], 0.5, 0.02);
    brunt_world_destroy(whole);
    brunt_world_destroy(parts);
}
END_TEST

// What meets elsewhere feels nothing of a tied pair: every bit of two bodies that rub on each other.
START_TEST(contact_elsewhere_is_unaffected) {
    double *state[2][2];
    int64_t count = 0;
    for (int with = 0; with < 2; with++) {
        brunt_world_def def = begin((choice){_i, BRUNT_QUADRATIC, BRUNT_APIC});
        def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
        def.contact.friction = 0.4;
        if (with) {
            def.contact.pairs = brunt_alloc(sizeof *def.contact.pairs);
            def.contact.pairs[def.contact.pair_count++] =
                (brunt_pair_def){.a = "y", .b = "z", .method = BRUNT_CONTACT_TIED};
            def_box(&def, "y", XYZ(5, 0, 0), XYZ(5.25, 0.25, 0.25));
            def_velocity(def_box(&def, "z", XYZ(5.25, 0, 0), XYZ(5.5, 0.25, 0.25)), 1, 1, 0);
        }
        def_velocity(def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.5, 0.25, 0.25)), 0, 1, 0);
        def_velocity(def_box(&def, "b", XYZ(0.1, 0.25, 0), XYZ(0.4, 0.5, 0.25)), 1, -1, 0);
        for (int b = 0; b < def.body_count; b++) def.bodies[b].particles_per_cell = 0, def.bodies[b].spacing = spacing;
        brunt_world *world = world_take(&def);
        world_steps(world, 40);
        ck_assert_double_gt(world_pair(world, 0).friction_work, 0);
        count = brunt_body_particles(world, 1);
        state[with][0] = world_field(world, 1, "velocity");
        state[with][1] = world_field(world, 1, "position");
        brunt_world_destroy(world);
    }
    for (int f = 0; f < 2; f++) {
        ck_assert_mem_eq(state[0][f], state[1][f], (size_t)(3 * count) * sizeof(double));
        free(state[0][f]), free(state[1][f]);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

START_TEST(threads_and_order_change_no_bit) {
    uint64_t first = 0;
    for (int threads = 1; threads <= 3; threads++) {
        brunt_world *world = hit(2 + _i, false, 0.3, threads);
        world_steps(world, 40);
        ck_assert_double_ne(world_pair(world, 0).impulse[0], 0);
        if (threads == 1) first = brunt_world_hash(world);
        ck_assert_msg(brunt_world_hash(world) == first, "%d threads", threads);
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(restarts_change_no_bit) {
    brunt_error error = {0};
    brunt_world *straight = hit(2 + _i, false, 0.3, 1), *resumed = hit(2 + _i, false, 0.3, 1);
    world_steps(straight, 25);
    for (int32_t b = 0; b < brunt_state_count(straight); b++) {
        const brunt_state_block block = brunt_state_info(straight, b);
        void *values = malloc((size_t)block.count * 8 + 8);
        brunt_state_get(straight, b, values);
        ck_assert_msg(!brunt_state_set(resumed, b, values, block.count, &error), "%s", error.message);
        free(values);
    }
    ck_assert_msg(!brunt_state_done(resumed, &error), "%s", error.message);
    world_steps(straight, 25);
    world_steps(resumed, 25);
    ck_assert(brunt_world_hash(straight) == brunt_world_hash(resumed));
    const brunt_energy e = world_energy(straight), r = world_energy(resumed);
    ck_assert(e.contact == r.contact && e.error == r.error && e.contact > 0);
    brunt_world_destroy(straight);
    brunt_world_destroy(resumed);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("tied");
    TCase *tests = tcase_create("tied");
    tcase_add_loop_test(tests, tied_parts_are_the_whole, 0, 18);
    tcase_add_loop_test(tests, they_neither_part_nor_slide, 0, 18);
    tcase_add_loop_test(tests, no_normal_is_wanted, 0, SHAPES);
    tcase_add_loop_test(tests, three_bodies_one_pair_tied, 0, 2);
    tcase_add_loop_test(tests, contact_elsewhere_is_unaffected, 0, 2);
    tcase_add_loop_test(tests, threads_and_order_change_no_bit, 0, 2);
    tcase_add_loop_test(tests, restarts_change_no_bit, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
