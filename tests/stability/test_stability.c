// Hard cases of a single body: free flight, empty nodes, spin, extreme strain, far places, time steps, threads.
//
// What is asserted is what holds; where a bound is wider than one would wish, the measured number stands beside it.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

static const brunt_kernel kernels[] = {BRUNT_LINEAR, BRUNT_QUADRATIC, BRUNT_CUBIC};
static const brunt_transfer transfers[] = {BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC};

// Of material so soft that stress does not matter, for the linear kernel: the slope of its weights stays 1/h as a
// node's mass goes to 0, so that the velocity that stress gives to the node has no bound and no step is stable at a
// moving surface.
static double stiffness(brunt_kernel kernel, double E) { return kernel == BRUNT_LINEAR ? 1e-8 * E : E; }

// ------------------------------------------------------------------------------------------ particles alone

// A lone particle, and another of a second body in the same cell, fall freely: nodes with a billionth of the mass, and
// contact between bodies that do not approach, must do nothing. Velocities are those of the middle of the step, to
// which the kick, the mean of the steps before and after, takes them exactly; places are g t^2 / 2.
START_TEST(lone_particles_fly_ballistically) {
    const double h = 0.1, offsets[] = {0, 1e-12, -1e-12, 0.31, 0.5 - 1e-12, 0.5 + 1e-12};
    const double g[3] = {0, -9.81, 0};
    double worst = 0, furthest = 0;
    for (int i = 0; i < 3 * 3 * 6; i++) {
        brunt_world_def def = def_begin(2 + i % 2, h);
        def.kernel = kernels[i % 3];
        def.transfer = transfers[i / 3 % 3];
        def.cfl = 0.4;
        memcpy(def.gravity, g, sizeof g);
        def.contact.friction = 0.5;
        def_material(&def, "neo-hookean", 1000, stiffness(def.kernel, 1e5), 0.3);
        const double offset = def.kernel == BRUNT_LINEAR ? 0.31 : offsets[i / 9]; // nor any at all so near a face
        const double at[3] = {offset * h, 0.2 * h, 0.3 * h}, beside[3] = {at[0] + 0.6 * h, at[1], at[2]};
        def_point(&def, "a", at, 0.25 * h, XYZ(0, -3, 0));
        def_point(&def, "b", beside, 0.25 * h, XYZ(0, -3, 0));
        brunt_world *world = world_take(&def);
        double before = -3, last = 0;
        for (int s = 0; s < 300; s++) {
            world_steps(world, 1);
            double v = world_sums(world, 0).velocity[1], dt = brunt_world_dt(world);
            worst = fmax(worst, fabs(v - before - g[1] * 0.5 * (last + dt)));
            before = v, last = dt;
        }
        brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
        worst = fmax(worst, fabs(a.velocity[1] + 3 - g[1] * (brunt_world_time(world) - 0.5 * last)));
        worst = fmax(worst, fmax(fabs(a.velocity[0]), fabs(b.velocity[0])));
        furthest = fmax(furthest, fabs(a.centre[0] - at[0]) + fabs(b.centre[0] - beside[0]));
        brunt_reaction pair = world_pair(world, 0);
        for (int k = 0; k < 3; k++)
            ck_assert_double_le(fabs(pair.impulse[k]), ROUNDING > 1e-8 ? 1e-15 : 1e-30); // of almost empty nodes
        brunt_world_destroy(world);
    }
    printf("  lone particles: velocity off by %.1e m/s, sideways %.1e m\n", worst, furthest);
    hard_case("C11", worst, 30 * ROUNDING, 30 * ROUNDING, "velocity of one alone in its cell that falls, off by [m/s]");
    hard_case("C11", furthest, ROUNDING, ROUNDING, "way sideways of it [m]");
}
END_TEST

// A wobbling block, moved bodily so that one surface particle sits at a distance d from where the next node begins to
// feel it: that node's mass goes as d^order. Particles must not feel whether it is 1e-12 or nothing.
typedef struct at_face {
    bool finished, located;
    double fastest, kinetic, internal, initial, drift;
} at_face;

static at_face run_at_face(int dimension, brunt_kernel kernel, brunt_transfer transfer, double d) {
    const double h = 0.125;
    brunt_world_def def = def_begin(dimension, h);
    def.kernel = kernel;
    def.transfer = transfer;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.5, 0.5, 0.25));
    b->wave_velocity[0] = 1;
    b->wave_vector[0] = PI / 0.5, b->wave_phase = PI / 2;
    brunt_world *world = world_take(&def);
    world_steps(world, 12); // a sixth of a period: the block is squeezed, and its faces are loaded by their neighbours
    double *position = world_field(world, 0, "position"), face = kernel == BRUNT_QUADRATIC ? 0.5 * h : 0,
           x = position[0];
    free(position);
    shift_body(world, "block", 0, round((x - face) / h) * h + face + d * h - x);
    at_face out = {.finished = true};
    brunt_error error = {0};
    for (int s = 0; s < 100 && out.finished; s++) {
        out.finished = brunt_world_step(world, INFINITY, &error) == BRUNT_OK;
        out.fastest = fmax(out.fastest, fastest_particle(world, 0));
    }
    out.located = !out.finished && error.id >= 0 && error.body[0] && strstr(error.message, "inside out");
    brunt_energy e = world_energy(world);
    out.kinetic = e.kinetic, out.internal = e.internal, out.initial = e.initial,
    out.drift = world_momentum(world).linear_drift;
    brunt_world_destroy(world);
    return out;
}

START_TEST(nodes_with_almost_no_mass_do_no_harm) {
    static const double d[] = {1e-12, 1e-8, 1e-5, -1e-12, -1e-8, -1e-5};
    int finished = 0, runs = 0;
    double fastest = 0, inside = 0, drift[2] = {0};
    for (int i = 0; i < 2 * 2 * 3 * 6; i++) {
        int dimension = 2 + i % 2, k = 1 + i / 2 % 2, t = i / 4 % 3, n = i / 12;
        at_face r = run_at_face(dimension, kernels[k], transfers[t], d[n]);
        at_face reference = run_at_face(dimension, kernels[k], transfers[t], n < 3 ? 1e-12 : -1e-5);
        ck_assert(r.finished);
        fastest = fmax(fastest, r.fastest);
        drift[n == 3] = fmax(drift[n == 3], r.drift);
        // On one side of the face, energy depends on the distance as on any other place. Of all at the start: PIC
        // leaves less than a thousandth of it, which differs by 4e-3 of itself.
        double change = fabs(r.kinetic + r.internal - reference.kinetic - reference.internal) / r.initial;
        inside = fmax(inside, change);
    }
    printf("  almost empty nodes: fastest %.3f m/s of 1 at the start, energy differs by %.1e, momentum by %.1e, at "
           "-1e-12 h by %.1e\n",
           fastest, inside, drift[0], drift[1]);
    hard_case("C12", fastest, 1.1, 1.1, "fastest particle, of the fastest at the start");
    hard_case("C12", inside, 1e-5, 1e-5, "energy, by distance from the face of a cell, of all at the start");
    hard_case("C12", fmax(drift[0], drift[1]), 100 * ROUNDING, 100 * ROUNDING,
              "drift of momentum"); // though such a node may move at 1e11 m/s

    // With the linear kernel the force on such a node does not vanish with its mass: no step is stable for sure. All 36
    // runs come to their end; what is asked is that one that does not says where.
    for (int i = 0; i < 2 * 3 * 6; i++, runs++) {
        at_face r = run_at_face(2 + i % 2, BRUNT_LINEAR, transfers[i / 2 % 3], d[i / 6]);
        ck_assert_msg(r.finished || r.located, "case %d", i);
        finished += r.finished;
    }
    printf("  linear kernel: %d of %d runs came to their end\n", finished, runs);
}
END_TEST

// ------------------------------------------------------------------------------------------ far away

// There is no box around the world; the grid's numbering ends some million cells away. Up to there memory follows the
// particles, past it the particle is named.
START_TEST(leaving_the_grid_is_reported) {
    brunt_world_def def = def_begin(3, 0.5);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def_point(&def, "here", XYZ(0.1, 0.1, 0.1), 0.2, XYZ(0, 0, 0));
    def_point(&def, "runaway", XYZ(0.1, 0.1, 0.1), 0.2, XYZ(10, 0, 0));
    def.contact.method = BRUNT_CONTACT_NONE;
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            brunt_world *world = world_from(&def);
            shift_body(world, "runaway", axis, side * 0.5 * 1e6);
            world_steps(world, 3);
            ck_assert_int_le(brunt_world_nodes(world), 2 * 8 * 64);
            double there = world_sums(world, 1).centre[axis];
            shift_body(world, "runaway", axis, side * 0.5 * 1e7);
            brunt_error error = {0};
            ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
            ck_assert_str_eq(error.body, "runaway");
            ck_assert_int_eq(error.id, 0);
            ck_assert_double_eq_tol(error.position[axis], there + side * 0.5 * 1e7, 1);
            ck_assert_ptr_nonnull(strstr(error.message, "cells away"));
            brunt_world_destroy(world);
        }
    brunt_world_def_free(&def);
}
END_TEST

// Particles thrown at every face, edge and corner of a room stay in it, whatever the kernel; mass and momentum are
// accounted.
START_TEST(walls_hold_every_way_out) {
    const double h = 0.25;
    int stopped = 0;
    double lost = 0, lost_linear = 0;
    for (int k = 0; k < 3; k++)
        for (int t = 0; t < 3; t++)
            for (int way = 0; way < 27; way++) {
                if (way == 13) continue;
                const double v[3] = {4.0 * (way % 3 - 1), 4.0 * (way / 3 % 3 - 1), 4.0 * (way / 9 - 1)};
                brunt_world_def def = def_begin(3, h);
                def.kernel = kernels[k];
                def.transfer = transfers[t];
                def.cfl = 0.4;
                def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
                brunt_body_def *b = def_box(&def, "block", XYZ(-0.2, -0.2, -0.2), XYZ(0.2, 0.2, 0.2));
                b->spacing = way % 2 ? 0.4 : 0.2; // one particle, or eight
                def_velocity(b, v[0], v[1], v[2]);
                for (int w = 0; w < 6; w++) {
                    double point[3] = {0}, normal[3] = {0};
                    point[w / 2] = w % 2 ? 0.93 : -1.01;
                    normal[w / 2] = w % 2 ? -1 : 1;
                    def_plane(&def, point, normal, BRUNT_SEPARATE, 0);
                }
                brunt_world *world = world_take(&def);
                double mass = world_sums(world, 0).mass;
                bool broken = false;
                brunt_error error = {0};
                for (int s = 0; s < 100; s++) {
                    int status = brunt_world_step(world, INFINITY, &error);
                    ck_assert_msg(status == BRUNT_OK || (k == 0 && strstr(error.message, "step")), "%s", error.message);
                    broken = status != BRUNT_OK;
                    stopped += broken;
                    if (broken) break;
                    double *x = world_field(world, 0, "position");
                    for (int i = 0; i < 3 * (int)brunt_body_particles(world, 0); i++) {
                        ck_assert_double_gt(x[i], -1.01);
                        ck_assert_double_lt(x[i], 0.93);
                    }
                    free(x);
                }
                ck_assert_double_eq(world_sums(world, 0).mass, mass);
                double drift = world_momentum(world).linear_drift;
                if (k > 0)
                    lost = fmax(lost, drift);
                else if (!broken)
                    lost_linear = fmax(lost_linear, drift); // rounding at nodes with almost no mass
                brunt_world_destroy(world);
            }
    printf("  thrown at walls: %d of 78 runs with the linear kernel stopped; momentum lost %.1e, the others %.1e\n",
           stopped, lost_linear, lost);
    hard_case("C13", lost, 100 * ROUNDING, 100 * ROUNDING,
              "momentum lost to walls, beside what they report; quadratic and cubic kernel");
    hard_case("C13", stopped / 78.0, 0, 0.2, "share of runs that stop with the linear kernel");
}
END_TEST

// ------------------------------------------------------------------------------------------ free flight

START_TEST(free_flight_changes_nothing) {
    flight worst = {0};
    for (int i = 0; i < 9; i++) {
        if (sizeof(real) == 4 && i % 3 == 0) continue; // the linear kernel makes too much of what floats round
        flight f = fly(kernels[i % 3], transfers[i / 3], 3000, 0);
        worst.place = fmax(worst.place, f.place), worst.velocity = fmax(worst.velocity, f.velocity);
        worst.contact = fmax(worst.contact, f.contact), worst.stress = fmax(worst.stress, f.stress);
    }
    printf("  flight, 3000 steps: place %.1e, velocity %.1e, contact %.1e N s, stress %.1e of E\n", worst.place,
           worst.velocity, worst.contact, worst.stress);
    ck_assert_double_le(worst.place, 100 * ROUNDING);
    ck_assert_double_le(worst.velocity, 100 * ROUNDING);
    ck_assert_double_eq(worst.contact, 0);
    ck_assert_double_le(worst.stress, 1e4 * ROUNDING);

    // Turning bodies too, by the transfer that keeps their spin.
    flight f = fly(BRUNT_QUADRATIC, BRUNT_APIC, 3000, 3);
    printf("  flight, turning: place %.1e, velocity %.1e, angular momentum %.1e, growth %.1e\n", f.place, f.velocity,
           f.angular, f.growth);
    ck_assert_double_le(f.place, 100 * ROUNDING);
    ck_assert_double_le(f.velocity, 100 * ROUNDING);
    ck_assert_double_le(f.angular, 1e4 * ROUNDING);
    ck_assert_double_le(f.growth, 0.12); // in 20 turns: places creep outward, though no strain is felt
}
END_TEST

START_TEST(turning_body_keeps_its_spin) {
    spinning s = spin_ring(0.2, 100);
    printf("  ring, 100 turns: angular %.1e, radius %.1e, energy lost %.2e, most gained in 1/8 turn %.1e\n", s.angular,
           s.radius, s.lost, s.gained);
    ck_assert_double_le(s.angular, 1e3 * ROUNDING);
    // Two cells of rim. It starts unstretched, and the breathing that follows dies out: 0.9 % of the energy in 3 turns.
    // Later it creeps outward, 0.05 % and 0.1 % of the energy a turn (half of that with cells half as wide).
    ck_assert_double_le(s.radius, 0.06);
    ck_assert_double_le(s.lost, 0.11);
    ck_assert_double_ge(s.lost, 0);
    ck_assert_double_le(s.gained, 5e-4);
}
END_TEST

// ------------------------------------------------------------------------------------------ time step

typedef struct outcome {
    double velocity, kinetic, impulse;
} outcome; // of the lighter block; both, over the initial; of contact

static outcome bounce(brunt_world_def *def, int axis) {
    brunt_world *world = world_take(def);
    world_until(world, 0.1);
    brunt_energy e = world_energy(world);
    outcome o = {world_sums(world, 1).velocity[axis], e.kinetic / e.initial, world_pair(world, 0).impulse[axis]};
    brunt_world_destroy(world);
    return o;
}

// The largest differences met: velocity and impulse relative, the energy of the initial.
static void compare(const char *what, double value, const outcome *a, const outcome *b, outcome *worst) {
    outcome d = {fabs(b->velocity / a->velocity - 1), fabs(b->kinetic - a->kinetic), fabs(b->impulse / a->impulse - 1)};
    printf("  %s %g: velocity %.1e, kinetic energy %.1e, impulse %.1e\n", what, value, d.velocity, d.kinetic,
           d.impulse);
    worst->velocity = fmax(worst->velocity, d.velocity);
    worst->kinetic = fmax(worst->kinetic, d.kinetic);
    worst->impulse = fmax(worst->impulse, d.impulse);
}

START_TEST(step_size_hardly_matters) {
    static const double cfl[] = {0.1, 0.3, 0.7, 0.9};
    brunt_world_def def = def_bounce(0.1, XYZ(0, 0, 0));
    outcome middle = bounce(&def, 0), worst = {0}, extreme = {0};
    for (int i = 0; i < 4; i++) {
        def = def_bounce(0.1, XYZ(0, 0, 0));
        def.cfl = cfl[i];
        outcome o = bounce(&def, 0);
        compare("cfl", cfl[i], &middle, &o, &worst);
    }
    hard_case("C18", worst.impulse, 0.01, 0.01, "points, cfl 0.1 to 0.9: impulse, relative");
    hard_case("C18", worst.velocity, 0.01, 0.02, "points, cfl 0.1 to 0.9: speed, relative");
    // Each transfer takes some energy of what the grid does not resolve, the more steps the more: 5.5 % of it more at
    // 0.1 than at 0.5.
    hard_case("C18", worst.kinetic, 0.01, 0.08, "points, cfl 0.1 to 0.9: kinetic energy, of all at the start");
    def = def_bounce(0.1, XYZ(0, 0, 0));
    def.cfl = 1;
    outcome o = bounce(&def, 0);
    compare("cfl", 1, &middle, &o, &extreme);
    def = def_bounce(0.1, XYZ(0, 0, 0));
    def.cfl = 0.01;
    o = bounce(&def, 0);
    compare("cfl", 0.01, &middle, &o, &extreme);
    ck_assert_double_le(extreme.impulse, 0.03);
    ck_assert_double_le(extreme.kinetic, 0.15);
}
END_TEST

START_TEST(steps_above_the_stable_one_are_refused) {
    brunt_error error = {0};
    brunt_world_def def = def_bounce(0.1, XYZ(0, 0, 0));
    static const double bad[] = {1.2, -1, NAN};
    for (int i = 0; i < 3; i++) {
        def.cfl = bad[i];
        ck_assert_ptr_null(brunt_world_create(&def, &error));
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_ptr_nonnull(strstr(error.message, "cfl"));
    }
    def.cfl = 1;
    brunt_world *world = world_from(&def);
    double stable = brunt_world_dt(world);
    brunt_world_destroy(world);

    def.step = 0.99 * stable;
    world = world_from(&def);
    world_steps(world, 1);
    brunt_world_destroy(world);

    def.step = 1.2 * stable;
    world = brunt_world_create(&def, &error);
    int status = world ? brunt_world_step(world, INFINITY, &error) : error.code;
    ck_assert_int_ne(status, BRUNT_OK);
    char here[64], most[64];
    snprintf(here, sizeof here, "%.6g s", 1.2 * stable);
    snprintf(most, sizeof most, "%.6g s", stable);
    ck_assert_msg(strstr(error.message, here) && strstr(error.message, most), "%s", error.message);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// ------------------------------------------------------------------------------------------ places and directions

static outcome bounce_turned(const double shift[3], bool turn, double step) {
    brunt_world_def def = def_bounce(0.1, shift);
    def.step = step;
    for (int i = 0; i < 2 && turn; i++) {
        brunt_body_def *b = &def.bodies[i];
        b->place = brunt_placement_rotate(b->place, XYZ(0, 0, 1), PI / 2, XYZ(0, 0, 0));
        def_velocity(b, 0, b->velocity[0], 0);
    }
    return bounce(&def, turn);
}

static double largest(const outcome *o) { return fmax(o->velocity, fmax(o->kinetic, o->impulse)); }

START_TEST(grid_place_and_direction_hardly_matter) {
    const double h = 0.05, base[3] = {0.013, 0.027, 0}; // no surface on a grid line, where rounding would decide
    const double whole[3] = {base[0] + 0.7, base[1] - 1.3, 0}, distant[3] = {base[0] + 1e6, base[1] - 1e6, 0};
    outcome here = bounce_turned(base, false, 0), part = {0}, own = {0}, fixed = {0};
    for (int i = 1; i < 8; i++) {
        outcome o = bounce_turned(XYZ(base[0] + h * i / 8.0, base[1] + h * (5 * i % 8) / 8.0, 0), false, 0);
        compare("shifted by 1/8 cell times", i, &here, &o, &part);
    }
    // Asked were 1e-3; found 1.6e-3 of the impulse, 2.9e-3 of the speed, 3.6e-3 of the energy, with 20 particles a
    // side.
    hard_case("C23", part.impulse, 1e-3, 0.004, "shift by eighths of a cell: impulse, relative");
    hard_case("C23", part.velocity, 1e-3, 0.006, "shift by eighths of a cell: speed, relative");
    hard_case("C23", part.kinetic, 1e-3, 0.008, "shift by eighths of a cell: kinetic energy, of all at the start");

    // A quarter turn, and a shift by whole cells, change where the blocks of cells cut the bodies. The time step is
    // found block by block, and shows it: 3e-4.
    outcome turned = bounce_turned(base, true, 0), cells = bounce_turned(whole, false, 0);
    compare("turned by degrees", 90, &here, &turned, &own);
    compare("shifted by cells", 14, &here, &cells, &own);
    ck_assert_double_le(largest(&own), ROUNDING > 1e-8 ? 0.02 : 1e-3);

    // With a step that is given, rounding is left.
    const double step = 4e-4;
    here = bounce_turned(base, false, step), turned = bounce_turned(base, true, step),
    cells = bounce_turned(whole, false, step);
    compare("step given, turned by degrees", 90, &here, &turned, &fixed);
    compare("step given, shifted by cells", 14, &here, &cells, &fixed);
    hard_case("C23", largest(&fixed), ROUNDING > 1e-8 ? 0.02 : 1e-12, ROUNDING > 1e-8 ? 0.02 : 1e-10,
              "quarter turn, whole cells; step given");
    if (sizeof(real) == 8) { // floats are 6 cm apart there
        outcome far = {0}, o = bounce_turned(distant, false, step);
        compare("step given, shifted by m", 1e6, &here, &o, &far);
        hard_case("C23", largest(&far), 1e-6, 1e-6, "a million metres away");
    }
}
END_TEST

// Without contact, turned and distant bodies differ by rounding alone.
static double wobble(const double shift[3], bool turn) {
    brunt_world_def def = def_begin(2, 0.1);
    def.step = 1e-3;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0.013, 0.027, 0), XYZ(0.513, 0.327, 0));
    b->place = brunt_placement_translate(b->place, shift);
    if (turn) b->place = brunt_placement_rotate(b->place, XYZ(0, 0, 1), PI / 2, XYZ(0, 0, 0));
    double k = PI / 0.5;
    b->wave_velocity[turn] = 3;
    b->wave_vector[turn] = k, b->wave_phase = PI / 2 - k * (0.013 + shift[0]);
    brunt_world *world = world_take(&def);
    world_until(world, 0.05);
    double kinetic = world_energy(world).kinetic / world_energy(world).initial;
    brunt_world_destroy(world);
    return kinetic;
}

START_TEST(grid_direction_and_distance_do_not_matter_without_contact) {
    double here = wobble(XYZ(0, 0, 0), false), turned = wobble(XYZ(0, 0, 0), true),
           cells = wobble(XYZ(0.7, -1.3, 0), false);
    double far = wobble(XYZ(1e6, -1e6, 0), false);
    printf("  wobble, %.4f of the energy kinetic: turned %.1e, shifted by cells %.1e, by 1e6 m %.1e\n", here,
           turned - here, cells - here, far - here);
    ck_assert_double_le(fabs(turned - here), 100 * ROUNDING);
    ck_assert_double_le(fabs(cells - here), 100 * ROUNDING);
    if (sizeof(real) == 8) ck_assert_double_le(fabs(far - here), 1e-6); // places are rounded to 1e-10 m there
}
END_TEST

// ------------------------------------------------------------------------------------------ extreme strain

typedef struct extreme {
    int status;
    bool sound;
    double low, high, internal, error, dt;
    int64_t steps;
    char message[200];
} extreme;

// Runs to a time, for some steps at most. Sound: it got there with finite values, or stopped and named a particle.
static extreme run_extreme(brunt_world_def *def, double end, int most) {
    brunt_world *world = world_take(def);
    extreme x = {.low = INFINITY, .sound = true};
    brunt_error error = {.id = -1};
    while (x.status == BRUNT_OK && brunt_world_time(world) < end && brunt_world_steps(world) < most)
        x.status = brunt_world_step(world, end, &error);
    double *J = world_field(world, 0, "J"), *s = world_field(world, 0, "stress"),
           *at = world_field(world, 0, "position");
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) {
        x.low = fmin(x.low, J[i]), x.high = fmax(x.high, J[i]);
        for (int k = 0; k < 6; k++) x.sound = x.sound && isfinite(s[6 * i + k]) && isfinite(at[3 * i + k % 3]);
    }
    free(J), free(s), free(at);
    brunt_energy e = world_energy(world);
    x.internal = e.internal, x.error = e.error_relative, x.dt = brunt_world_dt(world),
    x.steps = brunt_world_steps(world);
    x.sound = x.sound && isfinite(x.error) && x.low > 0;
    if (x.status)
        x.sound = error.id >= 0 && error.body[0] && isfinite(error.position[0]) && error.time > 0 && error.message[0];
    snprintf(x.message, sizeof x.message, "%.190s", error.message);
    brunt_world_destroy(world);
    return x;
}

static void give_eos(brunt_material_def *m, double c0, double s, double initial_energy) {
    snprintf(m->eos, sizeof m->eos, "mie-gruneisen");
    m->eos_parameters[0] = c0, m->eos_parameters[1] = s, m->eos_parameters[2] = 1.5,
    m->eos_parameters[3] = initial_energy, m->eos_parameters[4] = INFINITY;
    m->strength_parameters[2] = 1e4; // yield stress
}

// Between mirror planes, one wall pressed towards another.
static extreme press(double nu, double slope, double speed, double to, int most) {
    brunt_world_def def = def_begin(2, 0.125);
    if (nu > 0)
        def_material(&def, "neo-hookean", 1000, 1e6, nu);
    else
        give_eos(def_material(&def, "von-mises", 1000, 1e5, 0.3), 30, slope, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SEPARATE, 0);
    def_plane(&def, XYZ(1, 0, 0), XYZ(-1, 0, 0), BRUNT_SEPARATE, 0)->velocity[0] = -speed;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, 0.5, 0), XYZ(0, -1, 0), BRUNT_SYMMETRY, 0);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.5, 0));
    return run_extreme(&def, (1 - to) / speed, most);
}

START_TEST(compression_to_a_twentieth) {
    const extreme runs[] = {press(0.3, 0, 1, 0.05, 5000), press(0.45, 0, 1, 0.05, 5000), press(0, 0.9, 1, 0.05, 5000),
                            press(0, 1.5, 1, 0.05, 3000), press(0, 1.5, 100, 0.05, 3000)};
    for (int i = 0; i < 5; i++)
        printf("  compression %d: status %d, J from %.4f, internal %.3e J, energy error %.1e, %d steps, dt %.1e s %s\n",
               i, runs[i].status, runs[i].low, runs[i].internal, runs[i].error, (int)runs[i].steps, runs[i].dt,
               runs[i].message);
    for (int i = 0; i < 3; i++) { // the mean is 0.05; the last block of cells is compressed the least
        ck_assert_int_eq(runs[i].status, BRUNT_OK);
        ck_assert(runs[i].sound);
        ck_assert_double_le(runs[i].low, 0.08);
        ck_assert_double_gt(runs[i].internal, 0);
        hard_case("C26", fabs(runs[i].error), 0.02, 0.06, "pressed to a twentieth, %s: error of the energy",
                  i < 2 ? "rubber" : "solid with Mie-Gruneisen");
    }
    // This equation of state ends at J = 1 - 1/s = 1/3. It hardens without bound before, and the step follows: the run
    // creeps towards the end of its time, with sound values, and does not get there (test_point_steps: it is told, and
    // ends at a millionth of the longest step).
    ck_assert(runs[3].sound);
    ck_assert_double_gt(runs[3].low, 1 / 3.0);
    ck_assert_double_lt(runs[3].low, 0.36);
    ck_assert_double_lt(runs[3].dt, 1e-5);
    ck_assert(runs[4].sound);
}
END_TEST

// v = rate x, without walls, until the ends are 20 times as far apart: more than cells are wide between any two
// particles.
START_TEST(expansion_to_the_twentyfold) {
    const double rate = 100;
    for (int i = 0; i < 9; i++) {
        brunt_world_def def = def_begin(2, 0.125);
        def.kernel = kernels[i % 3];
        if (i < 6)
            def_material(&def, "neo-hookean", 1000, i < 3 ? 1e2 : 1e5, 0.3);
        else
            give_eos(def_material(&def, "von-mises", 1000, 1e5, 0.3), 10, 1.5, 1e7);
        if (i > 6)
            def.materials[0].eos_parameters[4] = 0; // a gas carries no tension; what does pulls lone particles shut
        brunt_body_def *b = def_box(&def, "block", XYZ(-0.5, -0.25, 0), XYZ(0.5, 0.25, 0));
        b->wave_vector[0] = 1e-3;
        b->wave_velocity[0] = rate * 1e3;
        extreme x = run_extreme(&def, 19 / rate, 5000);
        printf("  expansion %d: status %d, J %.3g .. %.3g, energy error %.1e, %d steps %s\n", i, x.status, x.low,
               x.high, x.error, (int)x.steps, x.message);
        ck_assert(x.sound);
        if (i > 6) { // a gas gets there; a particle of rubber left alone by the others swings back and is reported when
                     // it collapses
            ck_assert_int_eq(x.status, BRUNT_OK);
            ck_assert_double_gt(x.low, 20);
            hard_case("C26", fabs(x.error), 0.02, 0.06, "gas drawn out twentyfold, kernel %d: error of the energy",
                      i % 3);
        }
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ threads and restart

static brunt_world_def def_balls(int threads) {
    brunt_world_def def = def_begin(3, 0.1);
    def.threads = threads;
    def.contact.friction = 0.3;
    def.gravity[2] = -9.81;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_velocity(def_ball(&def, "a", XYZ(-0.45, 0.013, 0.46), 0.4), 8, 1, -5);
    def_velocity(def_ball(&def, "b", XYZ(0.45, -0.11, 0.5), 0.4), -8, 0, -2);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0.1, 0, 1), BRUNT_SEPARATE, 0.4);
    return def;
}

START_TEST(threads_and_restart_keep_every_bit) {
    enum { STEPS = 60 };
    static const int threads[] = {1, 2, 3, 7};
    uint64_t hash = 0;
    double impulse[3] = {0};
    int others = 0;
    for (int i = 0; i < 8; i++) {
        brunt_world_def def = def_balls(threads[i % 4]);
        brunt_world *world = world_from(&def);
        ck_assert_int_gt(brunt_world_particles(world), 3000);
        world_steps(world, STEPS / 2);
        if (i >= 4) { // the other half in another world, with other threads
            def.threads = threads[(i + 1) % 4];
            brunt_world *other = world_from(&def);
            world_copy_state(world, other);
            brunt_world_destroy(world);
            world = other;
        }
        world_steps(world, STEPS / 2);
        brunt_reaction f = world_pair(world, 0);
        if (i == 0) hash = brunt_world_hash(world), memcpy(impulse, f.impulse, sizeof impulse);
        ck_assert_double_gt(fabs(f.impulse[0]), 0);
        others += brunt_world_hash(world) != hash;
        for (int k = 0; k < 3; k++) ck_assert_double_eq(f.impulse[k], impulse[k]);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
    hard_case("C28", others, 0, 0, "1, 2, 3, 7 threads, with a restart and without: runs of eight with other bits");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("stability");
    ADD(lone_particles_fly_ballistically);
    ADD(nodes_with_almost_no_mass_do_no_harm);
    ADD(leaving_the_grid_is_reported);
    ADD(walls_hold_every_way_out);
    ADD(free_flight_changes_nothing);
    ADD(turning_body_keeps_its_spin);
    ADD(step_size_hardly_matters);
    ADD(steps_above_the_stable_one_are_refused);
    ADD(grid_place_and_direction_hardly_matter);
    ADD(grid_direction_and_distance_do_not_matter_without_contact);
    ADD(compression_to_a_twentieth);
    ADD(expansion_to_the_twentyfold);
    ADD(threads_and_restart_keep_every_bit);
    return suite_main(suite);
}
