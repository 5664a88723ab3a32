// Mass, momentum and energy: what every combination of dimension, kernel and transfer must keep, alone and in contact.
//
// What theory allows (Jiang, Schroeder, Teran, J. Comput. Phys. 338 (2017) 137): the kernels are a partition of unity,
// so linear momentum is kept by every transfer and kernel. Angular momentum, with the spin of the affine part, is kept
// by APIC where the second moment D of the kernel is one constant: quadratic and cubic B-splines. With the linear
// kernel D depends on where in the cell a particle is, and the spin of an affine matrix C = B D^-1 changes with the way
// through the cells, whatever the step. PIC throws the spin away each step, FLIP adds increments filtered by a lumped
// mass: neither keeps it.
#include "tests/support/def_world.h"
#include "tests/support/hard_case.h"

enum { PLAIN = 2 * 3 * 3, CASES = PLAIN + 4 }; // the last with APIC that keeps a share
typedef struct choice {
    int dimension;
    brunt_kernel kernel;
    brunt_transfer transfer;
    double apic; // share
} choice;

static choice choose(int i) {
    if (i >= PLAIN) return (choice){2 + i % 2, i - PLAIN < 2 ? BRUNT_QUADRATIC : BRUNT_CUBIC, BRUNT_APIC, 0.9};
    return (choice){2 + i % 2, (brunt_kernel)(BRUNT_LINEAR + i / 2 % 3), (brunt_transfer)(BRUNT_PIC + i / 6), 0};
}

// With the linear kernel the slope of a node's weight stays 1/h as its mass goes to 0 with the last particle that
// leaves it: forces over masses have no bound (the B-splines' do: slope^2 / weight tends to 2/h^2 or to 0), nor has the
// work that the ledger books for them. Its scenes are of stuff so soft (waves cross a tenth of a cell) that stress does
// not matter.
static bool soft(choice c) { return c.kernel == BRUNT_LINEAR; }

static brunt_world_def begin(choice c, double E) {
    brunt_world_def def = def_begin(c.dimension, 0.25);
    if (soft(c)) E = 10;
    def.kernel = c.kernel;
    def.transfer = c.transfer;
    def.apic = c.apic;
    def_material(&def, "neo-hookean", 1000, E, 0.3);
    return def;
}

static const char *name_of(choice c) {
    static const char *const kernels[] = {"", "linear", "quadratic", "cubic"}, *const transfers[] = {"pic", "flip",
                                                                                                     "apic"};
    static char text[64];
    snprintf(text, sizeof text, "%dD %-9s %-4s%s", c.dimension, kernels[c.kernel], transfers[c.transfer],
             c.apic > 0 ? " 0.9" : "");
    return text;
}

static bool keeps_angular(choice c) { return c.transfer == BRUNT_APIC && c.kernel != BRUNT_LINEAR; }

static void judge_momentum(const char *scene, choice c, brunt_world *world) {
    brunt_momentum m = world_momentum(world);
    brunt_energy e = world_energy(world);
    printf("  %-12s %s  linear %.1e  angular %.1e  energy error %9.2e  kinetic %.4f  transfer %.4f\n", scene,
           name_of(c), m.linear_drift, m.angular_drift, e.error_relative, e.kinetic / e.initial,
           e.transfer / e.initial);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    if (keeps_angular(c))
        ck_assert_double_le(m.angular_drift, ROUNDING);
    else
        ck_assert_double_le(m.angular_drift, 0.2); // the rest lose spin, they do not make it up
}

// ------------------------------------------------------------------------------------------ one body

static brunt_world *flying(choice c, double cfl) {
    brunt_world_def def = begin(c, 1e5);
    def.cfl = cfl;
    brunt_body_def *body = def_box(&def, "block", XYZ(-0.5, -0.375, -0.25), XYZ(0.5, 0.375, 0.25));
    body->place = brunt_placement_rotate(body->place, XYZ(0, 0, 1), 0.3, XYZ(0, 0, 0));
    if (c.dimension == 3) body->place = brunt_placement_rotate(body->place, XYZ(1, 0, 0), 0.2, XYZ(0, 0, 0));
    body->place = brunt_placement_translate(body->place, XYZ(0.07, 3.03, 0.11));
    def_velocity(body, 2, 0.7, -0.4);
    body->spin[2] = 3;
    body->spin_about[1] = 3;
    return world_take(&def);
}

START_TEST(free_flight) {
    choice c = choose(_i);
    brunt_world *world = flying(c, 0.5);
    brunt_body_sums before = world_sums(world, 0);
    world_until(world, soft(c) ? 0.15 : 1);
    ck_assert_int_gt(brunt_world_steps(world), soft(c) ? 3 : 100);
    brunt_body_sums after = world_sums(world, 0);
    judge_momentum("free flight", c, world);
    ck_assert_double_le(fabs(after.mass / before.mass - 1), 1e-15);
    // Where nothing acts the centre of mass goes straight.
    for (int a = 0; a < c.dimension; a++) {
        double expect = before.centre[a] + before.velocity[a] * brunt_world_time(world);
        ck_assert_double_le(fabs(after.centre[a] - expect), 10 * ROUNDING);
    }
    // A transfer may take energy out, and the ledger knows how much; it may not add any.
    brunt_energy e = world_energy(world);
    ck_assert_double_le(fabs(e.error_relative), c.transfer == BRUNT_FLIP ? 0.05 : 5e-3);
    ck_assert_double_ge(e.transfer / e.initial, soft(c) ? -0.02 : -1e-3); // the affine part's D changes with the place
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ contact

// Oblique and off centre, so that the bodies turn, with friction.
static brunt_world_def colliding(choice c, double friction) {
    brunt_world_def def = begin(c, 1e6);
    def.contact.friction = friction;
    brunt_body_def *left = def_box(&def, "left", XYZ(-1.05, -0.5, -0.5), XYZ(-0.05, 0.5, 0.25));
    brunt_body_def *right = def_box(&def, "right", XYZ(0.05, -0.1, -0.25), XYZ(1.05, 0.65, 0.5));
    left->place = brunt_placement_rotate(left->place, XYZ(0, 0, 1), 0.05, XYZ(-0.5, 0, 0));
    right->place = brunt_placement_rotate(right->place, XYZ(0, 0.2, 1), -0.04, XYZ(0.5, 0.3, 0));
    def_velocity(left, 3, 0.8, 0.3);
    def_velocity(right, -3, -1.1, -0.4);
    def.cfl = 0.25;
    return def;
}

START_TEST(oblique_collision) {
    choice c = choose(_i);
    brunt_world_def def = colliding(c, 0.3);
    brunt_world *world = world_take(&def);
    world_until(world, soft(c) ? 0.04 : 0.12);
    judge_momentum("collision", c, world);
    brunt_reaction pair = world_pair(world, 0);
    brunt_body_sums right = world_sums(world, 1);
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(pair.impulse[0], (soft(c) ? 0.02 : 0.5) * right.mass * 3); // they did collide
    ck_assert_double_gt(e.friction, 0);
    ck_assert_double_ge(e.contact, 0);
    // In proportion to the step (ledger_closes_in_contact); FLIP has more noise to be wrong about.
    ck_assert_double_le(fabs(e.error_relative), c.transfer == BRUNT_FLIP ? 0.15 : 0.04);
    // The impulse that the pair reports is the momentum that the body has gained.
    const double start[3] = {-3, -1.1, -0.4};
    for (int a = 0; a < c.dimension; a++) {
        double gained = right.momentum[a] - right.mass * start[a];
        ck_assert_double_le(fabs(gained - pair.impulse[a]), 10 * ROUNDING * right.mass * 3);
    }
    brunt_world_destroy(world);
}
END_TEST

// Blocks that fill the quadrants around one node and run into each other there.
static brunt_world_def meeting(choice c, int count) {
    static const char *const names[] = {"north-east", "north-west", "south-west", "south-east"};
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    brunt_world_def def = begin(c, 1e6);
    def.contact.friction = 0.2;
    def.cfl = 0.25;
    for (int q = 0; q < count; q++) {
        double near = 0.02, far = 0.77, x = sign[q][0], y = sign[q][1];
        brunt_body_def *body = def_box(&def, names[q], XYZ(x > 0 ? near : -far, y > 0 ? near : -far, -0.25),
                                       XYZ(x > 0 ? far : -near, y > 0 ? far : -near, 0.25));
        def_velocity(body, -2 * x + 0.3 * q, -2 * y + 0.1, 0.1 * q);
    }
    return def;
}

static void run_meeting(int i, int count) {
    choice c = choose(i);
    brunt_world_def def = meeting(c, count);
    brunt_world *world = world_take(&def);
    world_until(world, soft(c) ? 0.03 : 0.08);
    judge_momentum(count == 3 ? "three bodies" : "four bodies", c, world);
    hard_case("C09", world_momentum(world).linear_drift, ROUNDING, ROUNDING,
              "%d bodies at a node, %s: drift of momentum", count, name_of(c));
    if (keeps_angular(c))
        hard_case("C09", world_momentum(world).angular_drift, ROUNDING, ROUNDING,
                  "%d bodies at a node, %s: drift of angular momentum", count, name_of(c));
    double pushed = 0;
    for (int p = 0; p < brunt_pair_count(world); p++)
        pushed += fabs(world_pair(world, p).impulse[0]) + fabs(world_pair(world, p).impulse[1]);
    ck_assert_double_gt(pushed, (soft(c) ? 0.05 : 1) * world_sums(world, 0).mass);
    ck_assert_double_le(fabs(world_energy(world).error_relative), c.transfer == BRUNT_FLIP ? 0.2 : 0.08);
    brunt_world_destroy(world);
}

START_TEST(three_bodies) { run_meeting(_i, 3); }
END_TEST
START_TEST(four_bodies) { run_meeting(_i, 4); }
END_TEST

// Bodies are ordered by name: any order in the definition gives the same bits.
START_TEST(order_of_bodies) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    choice c = {2 + _i, BRUNT_QUADRATIC, BRUNT_APIC, 0};
    uint64_t first = 0;
    int others = 0;
    for (int o = 0; o < 6; o++) {
        brunt_world_def def = meeting(c, 3);
        brunt_body_def bodies[3];
        memcpy(bodies, def.bodies, sizeof bodies);
        for (int b = 0; b < 3; b++) def.bodies[b] = bodies[orders[o][b]];
        brunt_world *world = world_take(&def);
        uint64_t start = brunt_world_hash(world);
        world_until(world, 0.03);
        ck_assert_double_ne(world_pair(world, 0).impulse[0], 0);
        ck_assert_uint_ne(brunt_world_hash(world), start);
        if (o == 0) first = brunt_world_hash(world);
        others += brunt_world_hash(world) != first;
        brunt_world_destroy(world);
    }
    hard_case("C09", others, 0, 0, "orders of three bodies, %dD, of six, that give other bits", c.dimension);
}
END_TEST

// Without friction nothing is rubbed away, and not only nearly.
START_TEST(no_friction_no_friction_work) {
    choice c = {2 + _i, BRUNT_QUADRATIC, BRUNT_APIC, 0};
    brunt_world_def def = colliding(c, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 0.12);
    brunt_energy e = world_energy(world);
    printf("  mu = 0, %dD: friction work %g J, contact work %g J\n", c.dimension, e.friction, e.contact);
    ck_assert_double_gt(world_pair(world, 0).impulse[0], 0);
    ck_assert_double_eq(world_pair(world, 0).friction_work, 0);
    ck_assert_double_eq(e.friction, 0);
    brunt_world_destroy(world);
}
END_TEST

// One block on another that is held, under gravity at 45 degrees to their face: with mu = 1e6 it stays, with 0.1 it
// goes. Shear and pressure of the blocks alone move the upper one's centre by rho g h / G times a length, 2e-3 m here.
START_TEST(sticks_with_much_friction) {
    double way[2];
    for (int k = 0; k < 2; k++) {
        choice c = {2 + _i, BRUNT_QUADRATIC, BRUNT_APIC, 0};
        brunt_world_def def = begin(c, 1e7);
        def.contact.friction = k ? 0.1 : 1e6;
        def.gravity[0] = def.gravity[1] = -7;
        def.gravity_ramp = 0.05;
        def_box(&def, "lower", XYZ(-1, 0, 0), XYZ(1, 0.5, 0.5));
        def_box(&def, "upper", XYZ(-0.25, 0.5, 0), XYZ(0.25, 1, 0.5));
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
        brunt_world *world = world_take(&def);
        double before = world_sums(world, 1).centre[0];
        world_until(world, 0.25);
        way[k] = before - world_sums(world, 1).centre[0];
        brunt_world_destroy(world);
    }
    double slides = 0.5 * 7 * (1 - 0.1) * 0.225 * 0.225; // the ramp costs half its length
    printf("  %dD: way with mu = 1e6 %.2e m, with mu = 0.1 %.4f m (rigid: %.4f m)\n", 2 + _i, way[0], way[1], slides);
    ck_assert_double_le(fabs(way[0]), 4e-3);
    ck_assert_double_ge(way[1], 0.8 * slides);
}
END_TEST

// Head on: at no step does the one draw the other to it, also while they part. Bulging faces tip a little: what is left
// along x may be off by the roundness of the faces, not more.
START_TEST(contact_never_pulls) {
    choice c = choose(_i);
    brunt_world_def def = begin(c, 1e5);
    brunt_body_def *left = def_box(&def, "left", XYZ(-1.05, 0, 0), XYZ(-0.05, 0.5, 0.5));
    brunt_body_def *right = def_box(&def, "right", XYZ(0.05, 0, 0), XYZ(0.55, 0.5, 0.5));
    def_velocity(left, 1, 0, 0);
    def_velocity(right, -1, 0, 0);
    brunt_world *world = world_take(&def);
    double last = 0, least = 0, most = 0, time_of_last = 0;
    while (brunt_world_time(world) < (soft(c) ? 0.12 : 0.5)) {
        world_steps(world, 1);
        brunt_reaction pair = world_pair(world, 0);
        least = fmin(least, pair.force[0]);
        most = fmax(most, pair.force[0]);
        if (pair.impulse[0] != last) time_of_last = brunt_world_time(world);
        last = pair.impulse[0];
    }
    double possible = world_sums(world, 1).mass * 4 / 3; // inelastic: the reduced mass times the approach
    printf("  %s: impulse %.3f of an inelastic one, least force %.1e of the greatest, last push at %.3f s\n",
           name_of(c), last / possible, least / most, time_of_last);
    ck_assert_double_gt(most, 0);
    hard_case("C25", -least / most, 1e-3, 1e-3, "two blocks that bounce, %s: greatest pull, of the push", name_of(c));
    if (!soft(c)) {
        ck_assert_double_ge(last, 0.98 * possible);
        ck_assert_double_lt(time_of_last, 0.45); // and they have let go of each other
    }
    brunt_world_destroy(world);
}
END_TEST

static void expect_same_bits(brunt_world *a, brunt_world *b) {
    static const char *const names[] = {"position", "velocity", "deformation_gradient", "stress"};
    for (int i = 0; i < brunt_body_count(a); i++)
        for (int f = 0; f < 4; f++) {
            double *x = world_field(a, i, names[f]), *y = world_field(b, i, names[f]);
            int components = brunt_body_field(a, i, brunt_body_find_field(a, i, names[f])).components;
            size_t bytes = (size_t)brunt_body_particles(a, i) * (size_t)components * sizeof *x;
            ck_assert_msg(memcmp(x, y, bytes) == 0, "%s of body %d", names[f], i);
            free(x);
            free(y);
        }
}

// Two that pass each other a tenth of a cell apart share nodes all the way and touch never; two that touch and part
// neither: not a bit may differ from a run without contact. Along the grid and turned out of it.
static const char *const ways[] = {"passing", "parting", "passing, turned", "parting, turned"};

START_TEST(untouched_bodies_feel_nothing) {
    choice c = choose(_i % CASES);
    bool part = _i / CASES % 2;
    double turn = _i / CASES >= 2 ? 0.5 : 0, gap = part ? 0 : 0.025;
    brunt_world *world[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = begin(c, 1e7);
        def.contact.friction = 0.5;
        if (soft(c)) def.step = 2e-3;
        if (k) def.contact.method = BRUNT_CONTACT_NONE;
        brunt_body_def *low = def_box(&def, "low", XYZ(-1, -0.5, 0), XYZ(0, 0, 0.5));
        brunt_body_def *high = def_box(&def, "high", XYZ(0, gap, 0), XYZ(0.75, gap + 0.5, 0.5));
        low->place = brunt_placement_rotate(low->place, XYZ(0, 0, 1), turn, XYZ(0, 0, 0));
        high->place = brunt_placement_rotate(high->place, XYZ(0, 0, 1), turn, XYZ(0, 0, 0));
        double x = 1.5, y = part ? -0.5 : 0, cosine = cos(turn), sine = sin(turn);
        def_velocity(low, cosine * x - sine * y, sine * x + cosine * y, 0);
        def_velocity(high, sine * y - cosine * x, -sine * x - cosine * y, 0.2);
        world[k] = world_take(&def);
        world_until(world[k], 0.15);
    }
    brunt_reaction force = world_pair(world[0], 0);
    printf("  %s %s: impulse %.2g of the momentum\n", ways[_i / CASES], name_of(c),
           (fabs(force.impulse[0]) + fabs(force.impulse[1])) / (1.5 * world_sums(world[0], 0).mass));
    for (int a = 0; a < 3; a++) ck_assert_double_eq(force.impulse[a], 0);
    expect_same_bits(world[0], world[1]);
    brunt_world_destroy(world[0]);
    brunt_world_destroy(world[1]);
}
END_TEST

// ------------------------------------------------------------------------------------------ energy

// Everything is booked at the mean of the velocities before and after a step, and so is what the transfers do to the
// velocities that the stress works on. What is left is the trapezoidal rule's: of second order in the step, until it
// meets other small things (a remap's, rounding).
static void judge_order(const char *scene, choice c, const double error[3], double limit, double least) {
    double order = log2(error[0] / error[2]) / 2;
    printf("  %s %s: ledger error %.2e %.2e %.2e, order %.2f\n", scene, name_of(c), error[0], error[1], error[2],
           order);
    ck_assert_double_le(error[0], limit);
    ck_assert_double_gt(error[0], 0);
    if (error[2] > 3e-7) ck_assert_double_ge(order, least);
}

// An elastic body with a wave in it, so that there is work to be done.
START_TEST(ledger_closes_with_the_step) {
    choice c = choose(_i);
    double error[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = begin(c, 1e5);
        def.step = 2e-3 / (1 << k);
        brunt_body_def *body = def_box(&def, "block", XYZ(-1, -0.5, -0.25), XYZ(1, 0.5, 0.25));
        body->wave_velocity[0] = 1;
        body->wave_vector[0] = PI / 2;
        brunt_world *world = world_take(&def);
        world_until(world, 0.2);
        error[k] = fabs(world_energy(world).error_relative);
        brunt_world_destroy(world);
    }
    judge_order("wave", c, error, 1e-4, 1.7);
}
END_TEST

// With a contact in it: the same, over the whole collision. Its impacts are sharper than any step, and excite modes of
// the grid that no step resolves: the error falls more slowly than the step.
START_TEST(ledger_closes_in_contact) {
    choice c = {2 + _i % 2, BRUNT_QUADRATIC, _i < 2 ? BRUNT_FLIP : BRUNT_APIC, _i < 4 ? 0 : 0.9};
    double error[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = colliding(c, 0.3);
        def.flip = 1;
        def.step = 1e-3 / (1 << k);
        brunt_world *world = world_take(&def);
        world_until(world, 0.12);
        error[k] = fabs(world_energy(world).error_relative);
        brunt_world_destroy(world);
    }
    judge_order("contact", c, error, 1e-3, 1.7);
}
END_TEST

// That the spin of APIC with the linear kernel changes is not an error of the step: it does not go with it.
START_TEST(linear_kernel_spin_changes_with_the_way) {
    choice c = {2 + _i, BRUNT_LINEAR, BRUNT_APIC, 0};
    double drift[2];
    for (int k = 0; k < 2; k++) {
        brunt_world *world = flying(c, k ? 0.05 : 0.4);
        world_until(world, 0.1);
        drift[k] = world_momentum(world).angular_drift;
        brunt_world_destroy(world);
    }
    printf("  %s: angular drift %.2e at cfl 0.4, %.2e at cfl 0.05\n", name_of(c), drift[0], drift[1]);
    ck_assert_double_le(fmax(drift[0], drift[1]), 1e-3);
#ifndef BRUNT_FLOAT
    ck_assert_double_ge(drift[1], 1e4 * ROUNDING);
#endif
}
END_TEST

int main(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    Suite *suite = suite_create("conservation");
    TCase *alone = tcase_create("one body"), *contact = tcase_create("contact"), *energy = tcase_create("energy");
    TCase *const all[] = {alone, contact, energy};
    for (int t = 0; t < 3; t++) {
        tcase_set_timeout(all[t], 0);
        suite_add_tcase(suite, all[t]);
    }
    tcase_add_loop_test(alone, free_flight, 0, CASES);
    tcase_add_loop_test(alone, linear_kernel_spin_changes_with_the_way, 0, 2);
    tcase_add_loop_test(contact, oblique_collision, 0, CASES);
    tcase_add_loop_test(contact, three_bodies, 0, CASES);
    tcase_add_loop_test(contact, four_bodies, 0, CASES);
    tcase_add_loop_test(contact, order_of_bodies, 0, 2);
    tcase_add_loop_test(contact, no_friction_no_friction_work, 0, 2);
    tcase_add_loop_test(contact, sticks_with_much_friction, 0, 2);
    tcase_add_loop_test(contact, contact_never_pulls, 0, CASES);
    tcase_add_loop_test(contact, untouched_bodies_feel_nothing, 0, 4 * CASES);
    tcase_add_loop_test(energy, ledger_closes_with_the_step, 0, CASES);
    tcase_add_loop_test(energy, ledger_closes_in_contact, 0, 6);
    return suite_main(suite);
}
