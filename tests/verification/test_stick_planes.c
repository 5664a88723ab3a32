// Planes that stick, on lines of the grid, in explicit steps: material points are at rest just there, by images of
// opposite velocities; what pushes them there pushes the plane.
#include <math.h>

#include "contact/planes/followed.h"
#include "tests/support/implicit_world.h"
#include "world/world.h"

static const double H = 0.1, DENSITY = 1000, YOUNG = 1e7; // waves at 100 m/s

// Which way things lie: everything is given along x from 0 on, and is turned to an axis and a side of it.
typedef struct lie {
    int dimension, axis;
    double side;
} lie;
static const lie lies[] = {{2, 0, 1}, {2, 0, -1}, {2, 1, 1}, {2, 1, -1}, {3, 0, 1}, {3, 2, -1}};
enum { LIES = sizeof lies / sizeof *lies };

static void turn(const lie *l, const double from[3], double to[3]) {
    for (int a = 0; a < 3; a++) to[(l->axis + a) % 3] = l->side * from[a];
    if (l->dimension == 2)
        to[0] = l->axis ? l->side * from[1] : l->side * from[0],
        to[1] = l->axis ? l->side * from[0] : l->side * from[1], to[2] = 0;
}

static brunt_body_def *box(brunt_world_def *def, const lie *l, const char *name, const double low[3],
                           const double high[3]) {
    double a[3], b[3], min[3], max[3];
    turn(l, low, a), turn(l, high, b);
    for (int k = 0; k < 3; k++) min[k] = fmin(a[k], b[k]), max[k] = fmax(a[k], b[k]);
    return def_box(def, name, min, max);
}

static void go(const lie *l, brunt_body_def *body, const double v[3]) { turn(l, v, body->velocity); }

static brunt_plane_def *plane(brunt_world_def *def, const lie *l, double at, const double normal[3],
                              brunt_condition condition) {
    double point[3], n[3];
    const double x[3] = {normal[0] != 0 ? at : 0, normal[0] != 0 ? 0 : at, 0};
    turn(l, x, point), turn(l, normal, n);
    return def_plane(def, point, n, condition, 0);
}

static brunt_world_def begin(const lie *l, double cell) {
    brunt_world_def def = def_begin(l->dimension, cell);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, 0);
    def.cfl = 0.3;
    return def;
}

// ------------------------------------------------------------------------------------------ a bar that hangs

typedef struct hanging {
    brunt_kernel kernel;
    brunt_transfer transfer;
    bool total;
    double share; // that APIC keeps
} hanging;
static const hanging hangings[] = {
    {BRUNT_QUADRATIC, BRUNT_APIC, false, 0},   {BRUNT_QUADRATIC, BRUNT_FLIP, false, 0},
    {BRUNT_QUADRATIC, BRUNT_PIC, false, 0},    {BRUNT_CUBIC, BRUNT_APIC, false, 0},
    {BRUNT_CUBIC, BRUNT_FLIP, false, 0},       {BRUNT_QUADRATIC, BRUNT_APIC, true, 0},
    {BRUNT_QUADRATIC, BRUNT_APIC, false, 0.9}, {BRUNT_CUBIC, BRUNT_APIC, true, 0.9},
};
enum { HANGINGS = sizeof hangings / sizeof *hangings };

// How far off the mean way of its middle is from what its weight makes of it, rho g L^2 / 3 E: gravity grows over five
// times the period 4 L / c of its slowest swing, over two of which the mean is taken.
static double hang(const lie *l, const hanging *how, double cell) {
    const double size = 1, period = 4 / sqrt(YOUNG / DENSITY), down[3] = {size, 0, 0};
    brunt_world_def def = begin(l, cell);
    def.kernel = how->kernel, def.transfer = how->transfer, def.apic = how->share;
    def.gravity_ramp = 5 * period, def.step = period / 160 * cell / H;
    box(&def, l, "bar", XYZ(0, 0, 0), XYZ(1, 4 * H, 2 * H))->total_lagrangian = how->total;
    plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
    turn(l, down, def.gravity);
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).centre[l->axis];
    double mean = 0, last = 5 * period;
    while (brunt_world_time(world) < last * (1 + 1e-9)) world_steps(world, 1); // a step over, all of the same length
    const double begun = brunt_world_time(world), J = world_boundary(world, 0).impulse[l->axis],
                 P = world_sums(world, 0).momentum[l->axis];
    for (last = begun; last < begun + 2 * period;) {
        world_steps(world, 1);
        const double now = brunt_world_time(world);
        mean += fmin(now - last, begun + 2 * period - last) * (world_sums(world, 0).centre[l->axis] - before);
        last = now;
    }
    const brunt_momentum m = world_momentum(world);
    const double weight = world_sums(world, 0).mass * size, had = world_boundary(world, 0).impulse[l->axis] - J,
                 wants = world_sums(world, 0).momentum[l->axis] - P - l->side * weight * (last - begun);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    ck_assert_double_le(fabs(had / wants - 1), 100 * ROUNDING);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 5e-3);
    brunt_world_destroy(world);
    return l->side * mean / (2 * period) / (DENSITY * size / 3 / YOUNG) - 1;
}

// Nodes that hold behind the plane made it 9 % too long at this cell.
START_TEST(hangs) {
    const hanging *how = &hangings[_i % HANGINGS];
    const lie *l = &lies[_i / HANGINGS];
    const double off = hang(l, how, H);
    printf("  %dD along %d, side %+g, kernel %d, transfer %d, keeps %g%s: off by %+.1e\n", l->dimension, l->axis,
           l->side, (int)how->kernel, (int)how->transfer, how->share, how->total ? ", total" : "", off);
    ck_assert_double_le(fabs(off), 4e-3);
}
END_TEST

// Half a cell, half of what is left of it to a quarter.
START_TEST(hangs_better_by_finer_cells) {
    const hanging *how = &hangings[_i];
    const double coarse = hang(&lies[0], how, H), fine = hang(&lies[0], how, H / 2);
    printf("  kernel %d, transfer %d, keeps %g%s: off by %+.1e, by half the cell %+.1e\n", (int)how->kernel,
           (int)how->transfer, how->share, how->total ? ", total" : "", coarse, fine);
    ck_assert_double_le(fabs(fine), 0.45 * fabs(coarse));
}
END_TEST

// ------------------------------------------------------------------------------------------ half of a whole

// Greatest distance of the particles of a body from those of another world's that began where they did [cells].
static double apart(brunt_world *world, const double *from, int body, brunt_world *whole, const double *whole_from,
                    int of, int dim) {
    double *to = world_field(world, body, "position"), *whole_to = world_field(whole, of, "position"), worst = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, body); i++) {
        int64_t best = 0;
        double least = INFINITY;
        for (int64_t k = 0; k < brunt_body_particles(whole, of); k++) {
            double square = 0;
            for (int a = 0; a < dim; a++) square += pow(from[3 * i + a] - whole_from[3 * k + a], 2);
            if (square < least) least = square, best = k;
        }
        for (int a = 0; a < dim; a++) worst = fmax(worst, fabs(to[3 * i + a] - whole_to[3 * best + a]) / H);
    }
    free(to), free(whole_to);
    return worst;
}

// A block on the plane, which another plane may press; cut in halves by a plane of symmetry.
static brunt_world *cut(const lie *l, bool half, double high, bool pressed) {
    brunt_world_def def = begin(l, H);
    def.step = 1e-4;
    go(l, box(&def, l, "block", XYZ(0, half ? 0 : -3 * H, 0), XYZ(high, 3 * H, H)), XYZ(-1, 0, 0));
    plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
    if (pressed) {
        double v[3];
        brunt_plane_def *p = plane(&def, l, high, XYZ(-1, 0, 0), BRUNT_SEPARATE);
        turn(l, XYZ(-2, 0, 0), v), memcpy(p->velocity, v, sizeof v), p->friction = 0.3;
    }
    if (half) plane(&def, l, 0, XYZ(0, 1, 0), BRUNT_SYMMETRY);
    return world_take(&def);
}

START_TEST(in_a_corner_as_the_whole) {
    const lie *l = &lies[_i % LIES];
    const bool pressed = _i / LIES;
    const double high = pressed ? H : 3 * H;
    brunt_world *half = cut(l, true, high, pressed), *whole = cut(l, false, high, pressed);
    double *from = world_field(half, 0, "position"), *whole_from = world_field(whole, 0, "position");
    world_steps(half, 150), world_steps(whole, 150);
    const double off = apart(half, from, 0, whole, whole_from, 0, l->dimension),
                 J = world_boundary(half, 0).impulse[l->axis], whole_J = world_boundary(whole, 0).impulse[l->axis];
    printf("  %dD along %d, side %+g%s: %.1e cells apart, impulse off by %.1e, drift %.1e\n", l->dimension, l->axis,
           l->side, pressed ? ", pressed" : "", off, 2 * J / whole_J - 1, world_momentum(half).linear_drift);
    ck_assert_double_le(off, 1000 * ROUNDING);
    ck_assert_double_le(fabs(2 * J / whole_J - 1), 1000 * ROUNDING);
    ck_assert_double_gt(l->side * J, 0);
    ck_assert_double_le(world_momentum(half).linear_drift, 10 * ROUNDING);
    ck_assert_double_le(world_momentum(whole).linear_drift, 10 * ROUNDING);
    ck_assert_double_le(fabs(world_energy(half).error_relative), 1e-2);
    free(from), free(whole_from);
    brunt_world_destroy(half), brunt_world_destroy(whole);
}
END_TEST

// A strip two to four cells wide between two planes that stick, or one and one that slips, along which gravity pulls
// it: its shear alone has rho g w^2 / 12 G in the mean, or rho g w^2 / 3 G.
START_TEST(between_planes) {
    const int width = 2 + _i % 3;
    const bool slips = _i / 3;
    const lie *l = &lies[_i % 4];
    const double w = width * H, G = YOUNG / 2, size = 10, period = 4 * w / sqrt(G / DENSITY),
                 exact = DENSITY * size * w * w / (slips ? 3 : 12) / G;
    brunt_world_def def = begin(l, H);
    def.gravity_ramp = 10 * period;
    box(&def, l, "strip", XYZ(0, -20 * H, 0), XYZ(w, 20 * H, H));
    plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
    plane(&def, l, w, XYZ(-1, 0, 0), slips ? BRUNT_SLIP : BRUNT_STICK);
    turn(l, XYZ(0, size, 0), def.gravity);
    brunt_world *world = world_take(&def);
    const int along = 1 - l->axis;
    double *from = world_field(world, 0, "position");
    world_until(world, 12 * period);
    double *to = world_field(world, 0, "position"), mean = 0;
    int64_t count = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) // away from the ends
        if (fabs(from[3 * i + along]) < 5 * H) mean += l->side * (to[3 * i + along] - from[3 * i + along]), count++;
    printf("  %d cells, %s: mean way off by %+.1e, drift %.1e\n", width, slips ? "slips" : "sticks",
           mean / (double)count / exact - 1, world_momentum(world).linear_drift);
    ck_assert_double_le(fabs(mean / (double)count / exact - 1), 0.1);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    free(from), free(to);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what meets at the plane

typedef enum meeting { SIDE_BY_SIDE, ONE_STICKS, ON_A_THIN_ONE, MESH_BESIDE, MEETINGS } meeting;
static const char *const meeting_names[] = {"side by side", "one sticks", "on a thin one", "a mesh beside"};

static brunt_world_def meeting_of(const lie *l, meeting which, double friction, bool augury) {
    brunt_world_def def = begin(l, H);
    def.contact.method = augury ? BRUNT_CONTACT_AUGURY : BRUNT_CONTACT_MULTI_VELOCITY;
    def.contact.friction = friction;
    if (which == ON_A_THIN_ONE) {
        box(&def, l, "a", XYZ(0, -3 * H, 0), XYZ(H, 3 * H, H));
        go(l, box(&def, l, "b", XYZ(H, -2 * H, 0), XYZ(4 * H, 2 * H, H)), XYZ(-1, 0.5, 0));
    } else {
        brunt_body_def *b = box(&def, l, "a", XYZ(0, -4 * H, 0), XYZ(4 * H, 0, H));
        if (which == MESH_BESIDE)
            b->method = BRUNT_FEM, b->element = l->dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, b->size = H;
        go(l, b, XYZ(0, 1, 0));
        go(l, box(&def, l, "b", XYZ(0, 0, 0), XYZ(3.5 * H, 4 * H, H)), XYZ(which == ONE_STICKS ? -1 : 0, -1, 0));
    }
    brunt_plane_def *p = plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
    if (which == ONE_STICKS) snprintf(p->body, sizeof p->body, "a");
    return def;
}

// Momentum is that of the plane to rounding, energy is accounted for, and none is in the other.
START_TEST(meets) {
    const lie *l = &lies[_i % LIES];
    const meeting which = (meeting)(_i / LIES % MEETINGS);
    const bool augury = which == MESH_BESIDE && _i / LIES / MEETINGS;
    const double friction = _i / LIES / MEETINGS ? 0.3 : 0;
    brunt_world_def def = meeting_of(l, which, friction, augury);
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    const brunt_momentum m = world_momentum(world);
    const brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
    const int across = which == ON_A_THIN_ONE ? l->axis : l->dimension == 2 ? 1 - l->axis : (l->axis + 1) % 3;
    const double gap = l->side > 0 ? b.low[across] - a.high[across] : a.low[across] - b.high[across];
    printf("  %dD along %d, side %+g, %s, friction %g%s: drift %.1e %.1e, gap %.2f cells, pair %.3g, energy %+.1e\n",
           l->dimension, l->axis, l->side, meeting_names[which], friction, augury ? ", augury" : "", m.linear_drift,
           m.angular_drift, gap / H, l->side * world_pair(world, 0).impulse[across],
           world_energy(world).error_relative);
    ck_assert_double_le(m.linear_drift, 10 * ROUNDING);
    if (which != MESH_BESIDE || augury) ck_assert_double_le(m.angular_drift, 10 * ROUNDING);
    ck_assert_double_gt(l->side * world_pair(world, 0).impulse[across], 0);
    ck_assert_double_gt(gap, which == MESH_BESIDE ? 0 : 0.2 * H);
    if (which == ON_A_THIN_ONE) // more than what stops it
        ck_assert_double_gt(l->side * world_pair(world, 0).impulse[across], 1.2 * b.mass);
    ck_assert_double_le(fabs(world_energy(world).error_relative), sizeof(real) == 4 ? 1e-3 : 1e-4);
    brunt_world_destroy(world);
}
END_TEST

// Turned by half a turn it is the same: what meets at nodes before the plane is all there is, whichever nodes come
// first. Nodes behind it that met as well moved what their images before it had been given.
START_TEST(meets_the_other_way_round) {
    const meeting which = (meeting)(_i % ON_A_THIN_ONE);
    const int axis = _i / ON_A_THIN_ONE % 2;
    double impulse[2], energy[2];
    for (int k = 0; k < 2; k++) {
        const lie *l = &lies[2 * axis + k];
        brunt_world_def def = meeting_of(l, which, _i / ON_A_THIN_ONE / 2 ? 0.3 : 0, false);
        brunt_world *world = world_take(&def);
        world_steps(world, 100);
        impulse[k] = l->side * world_pair(world, 0).impulse[1 - axis];
        energy[k] = world_energy(world).error_relative;
        brunt_world_destroy(world);
    }
    printf("  %s along %d: impulses differ by %.1e of %.4g, errors of energy %.2e by %.1e\n", meeting_names[which],
           axis, fabs(impulse[1] - impulse[0]), impulse[0], energy[0], fabs(energy[1] - energy[0]));
    ck_assert_double_le(fabs(impulse[1] - impulse[0]), 1e-10 * impulse[0]);
    ck_assert_double_le(fabs(energy[1] - energy[0]), 1e-10);
}
END_TEST

// Greatest velocity, beside that which its image by the plane makes it, of a node of body a; *most: of any node.
static double off_images(const brunt_world *world, double *most) {
    const brunt_symmetry_plane *p = &world->boundaries.symmetry[0];
    const brunt_grid *grid = &world->bodies.mpm[0].grid;
    double off = 0;
    *most = 0;
    for (int32_t s = 0; s < grid->slot_count; s++)
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            int32_t at[3] = {0};
            brunt_node_local(grid, node, local);
            for (int a = 0; a < grid->dim; a++) at[a] = grid->slots[s].coord[a] * grid->side + local[a];
            const real *n = brunt_grid_node(grid, at);
            at[p->axis] = 2 * p->node - at[p->axis];
            const real *image = brunt_grid_node(grid, at);
            for (int a = 0; a < grid->dim; a++) {
                const double v = (double)n[BRUNT_NODE_VELOCITY + a];
                *most = fmax(*most, fabs(v));
                const double sign = a == p->axis || p->sticks ? -1 : 1;
                if (image && image[0] > 0 && n[0] > 0)
                    off = fmax(off, fabs(v - sign * (double)image[BRUNT_NODE_VELOCITY + a]));
            }
        }
    return off;
}

// Whatever pushes them, nodes behind the plane have opposite velocities, and those on it none.
START_TEST(images_follow) {
    const lie *l = &lies[_i / 2 % LIES];
    const meeting which = (meeting)(_i / 2 / LIES);
    brunt_world_def def = meeting_of(l, which, 0.3, _i % 2);
    brunt_world *world = world_take(&def);
    double worst = 0, most = 0;
    for (int k = 0; k < 20; k++) {
        world_steps(world, 3);
        worst = fmax(worst, off_images(world, &most));
    }
    printf("  %dD along %d, side %+g, %s%s: off by %.1e of %.1e m/s\n", l->dimension, l->axis, l->side,
           meeting_names[which], _i % 2 ? ", augury" : "", worst, most);
    ck_assert_double_gt(most, 0.1);
    ck_assert_double_le(worst, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// Two alike that are driven together part in the middle: each moves as against a plane of symmetry there.
START_TEST(as_against_symmetry) {
    const lie *l = &lies[_i];
    brunt_world *world[2];
    double *from[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = begin(l, H);
        def.step = 1e-4;
        def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
        go(l, box(&def, l, "b", XYZ(0, 0, 0), XYZ(4 * H, 4 * H, H)), XYZ(0, -1, 0));
        if (!k) go(l, box(&def, l, "a", XYZ(0, -4 * H, 0), XYZ(4 * H, 0, H)), XYZ(0, 1, 0));
        plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
        if (k) plane(&def, l, 0, XYZ(0, 1, 0), BRUNT_SYMMETRY);
        world[k] = world_take(&def);
        from[k] = world_field(world[k], k ? 0 : 1, "position");
        world_steps(world[k], 100);
    }
    const double off = apart(world[1], from[1], 0, world[0], from[0], 1, l->dimension);
    printf("  %dD along %d, side %+g: %.2e cells apart\n", l->dimension, l->axis, l->side, off);
    ck_assert_double_le(off, 0.02); // of 0.1 that they were driven
    for (int k = 0; k < 2; k++) free(from[k]), brunt_world_destroy(world[k]);
}
END_TEST

// ------------------------------------------------------------------------------------------ what else holds there

// A region that moves a block on a plane whose nodes have images: where it begins and ends along the normal [cells],
// and which of its components it gives.
typedef struct grip {
    double low, high;
    bool across, along;
} grip;
static const grip grips[] = {
    {0.5, 1.5, true, true},  // the first nodes before the plane, whose images follow
    {-0.5, 1.5, true, true}, // those on it as well, which rest
    {-9, 1.5, true, true},   // and what is behind it, which is images
    {-0.5, 0.5, true, true}, // what is on it alone
    {0, 2, true, true},      // from it on, to a line of the grid
    {-9, -0.5, true, true},  // what is behind it alone: nothing of the block is there
    {-0.5, 1.5, true, false}, {-0.5, 1.5, false, true}, {1.5, 9, true, true}, // far from it
};
enum { GRIPS = sizeof grips / sizeof *grips };
static const brunt_condition mirrors[] = {BRUNT_STICK, BRUNT_SLIP, BRUNT_SYMMETRY};
enum { MIRRORS = sizeof mirrors / sizeof *mirrors };

static brunt_region_def *region(brunt_world_def *def, const lie *l, const grip *g, const double v[3]) {
    const double from[3] = {g->low * H, -10 * H, -10 * H}, to[3] = {g->high * H, 10 * H, 10 * H},
                 which[3] = {g->across, g->along, g->along};
    double a[3], b[3], c[3];
    if (!def->regions) def->regions = brunt_alloc(4 * sizeof *def->regions);
    brunt_region_def *r = &def->regions[def->region_count++];
    *r = brunt_region_def_default();
    r->shape.kind = BRUNT_BOX;
    turn(l, from, a), turn(l, to, b), turn(l, which, c), turn(l, v, r->velocity);
    for (int k = 0; k < 3; k++) {
        r->shape.min[k] = fmin(a[k], b[k]), r->shape.max[k] = fmax(a[k], b[k]);
        r->component[k] = c[k] != 0;
    }
    return r;
}

// Whatever the region gives, images are exactly those of what is before the plane, its work is what its impulse does on
// its way, and with the plane's impulse it is that of the momentum.
START_TEST(held_before_it) {
    const lie *l = &lies[_i % LIES];
    const grip *g = &grips[_i / LIES % GRIPS];
    const brunt_condition mirror = mirrors[_i / LIES / GRIPS % MIRRORS];
    const int scheme = _i / LIES / GRIPS / MIRRORS; // explicit steps, backward Euler, Newmark
    const double v[3] = {0.3, 0.5, 0.2};
    brunt_world_def def = begin(l, H);
    def.kernel = l == &lies[1] ? BRUNT_CUBIC : BRUNT_QUADRATIC;
    def.transfer = l == &lies[2] ? BRUNT_FLIP : BRUNT_APIC;
    if (scheme) go_implicit(&def, scheme == 1 ? BRUNT_EULER : BRUNT_NEWMARK, 1e-3), def.cfl = 0;
    box(&def, l, "a", XYZ(0, -3 * H, 0), XYZ(3 * H, 3 * H, H))->total_lagrangian = !scheme && l == &lies[3];
    plane(&def, l, 0, XYZ(1, 0, 0), mirror);
    brunt_region_def *r = region(&def, l, g, v);
    brunt_world *world = world_from(&def);
    ck_assert_int_eq(world->boundaries.symmetry_count, 1);
    double worst = 0, most = 0;
    for (int k = 0; k < 20; k++) {
        world_steps(world, scheme ? 1 : 2);
        if (!scheme) worst = fmax(worst, off_images(world, &most));
    }
    const brunt_reaction hold = world_boundary(world, 1);
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    double work = 0, size = 0;
    for (int a = 0; a < 3; a++)
        work += r->component[a] ? r->velocity[a] * hold.impulse[a] : 0, size += fabs(hold.impulse[a]);
    printf("  %dD along %d, side %+g, plane %d, %g to %g%s: images off by %.1e of %.1e m/s, drift %.1e %.1e, "
           "energy %+.1e, work %.4g J off by %.1e\n",
           l->dimension, l->axis, l->side, (int)mirror, g->low, g->high,
           scheme ? scheme == 1 ? ", Euler" : ", Newmark" : "", worst, most, m.linear_drift, m.angular_drift,
           e.error_relative, work, e.external_work - work);
    const bool nothing = g->high < 0 || (g->high < 1 && mirror == BRUNT_STICK);
    if (nothing)
        ck_assert_double_eq(size, 0);
    else
        ck_assert_double_gt(size, 1);
    ck_assert(nothing || scheme || most > 0.1);
    ck_assert_double_le(worst, ROUNDING);
    ck_assert_double_le(m.linear_drift, 100 * ROUNDING);
    if (!scheme && l != &lies[2] && l != &lies[3]) // FLIP keeps no moment, total-Lagrangian grids where they began
        ck_assert_double_le(m.angular_drift, 100 * ROUNDING);
    ck_assert_double_le(fabs(e.error_relative), sizeof(real) == 4 ? 1e-4 : 1e-5);
    ck_assert_double_le(fabs(e.external_work - work), 100 * ROUNDING * work);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// Of two regions that give a node something else the later one has it, images with it, in each scheme.
START_TEST(later_ones_hold) {
    const lie *l = &lies[_i % LIES];
    const bool implicit = _i / LIES / 2;
    const bool swapped = _i / LIES % 2;
    brunt_world_def def = begin(l, H);
    if (implicit) go_implicit(&def, BRUNT_EULER, 1e-3), def.cfl = 0;
    box(&def, l, "a", XYZ(0, -3 * H, 0), XYZ(3 * H, 3 * H, H));
    plane(&def, l, 0, XYZ(1, 0, 0), BRUNT_STICK);
    for (int k = 0; k < 2; k++) region(&def, l, &grips[0], XYZ(0, k == swapped ? 0.3 : 0.1, 0));
    brunt_world *world = world_from(&def);
    world_steps(world, 5);
    const int along = l->dimension == 2 ? 1 - l->axis : (l->axis + 1) % 3;
    const double first = world_boundary(world, 1).impulse[along], second = world_boundary(world, 2).impulse[along];
    printf("  %dD along %d, side %+g%s%s: %.3g and %.3g N s\n", l->dimension, l->axis, l->side,
           implicit ? ", implicit" : "", swapped ? ", swapped" : "", first, second);
    const brunt_symmetry_plane *p = &world->boundaries.symmetry[0];
    for (int32_t s = 0; s < world->bodies.mpm[0].grid.slot_count && !implicit; s++)
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            const brunt_grid *grid = &world->bodies.mpm[0].grid;
            const real *n = grid->nodes + (s * (int64_t)BRUNT_BLOCK_NODES + node) * BRUNT_NODE_REALS;
            int32_t at[3];
            brunt_node_coordinates(grid, s, node, at);
            if (brunt_symmetry_before(p, at) == 1 && n[0] > 0)
                ck_assert_double_eq((double)n[BRUNT_NODE_VELOCITY + along],
                                    (double)(real)(l->side * (swapped ? 0.3 : 0.1)));
        }
    if (implicit) ck_assert_double_eq(first, 0);
    ck_assert_double_gt(l->side * (first + second), 0);
    ck_assert_double_le(world_momentum(world).linear_drift, 100 * ROUNDING);
    if (implicit) ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-10);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// ------------------------------------------------------------------------------------------ what has images

// What is behind it from the start is held whole; off the lines of the grid, with a linear kernel and where it moves,
// nodes hold as well.
START_TEST(nodes_hold) {
    brunt_world_def def = begin(&lies[0], H);
    box(&def, &lies[0], "bar", XYZ(_i == 0 ? -4 * H : _i == 1 ? 0.3 * H : 0, 0, 0), XYZ(1, 4 * H, 0));
    brunt_plane_def *p = plane(&def, &lies[0], _i == 1 ? 0.3 * H : 0, XYZ(1, 0, 0), BRUNT_STICK);
    if (_i == 2) def.kernel = BRUNT_LINEAR, def.transfer = BRUNT_PIC;
    if (_i == 3) p->velocity[1] = 1e-9;
    def.gravity[0] = 10;
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(world->boundaries.symmetry_count, 0);
    ck_assert(world->boundaries.has_conditions);
    double *from = world_field(world, 0, "position");
    world_steps(world, 50);
    double *to = world_field(world, 0, "position");
    for (int64_t i = 0; _i == 0 && i < brunt_body_particles(world, 0); i++)
        if (from[3 * i] < -H) ck_assert_double_eq(to[3 * i], from[3 * i]);
    ck_assert_double_gt(world_sums(world, 0).momentum[0], 0);
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    free(from), free(to);
    brunt_world_destroy(world);
}
END_TEST

// A plane that something lies behind takes none of the images of others, wherever it stands among them.
START_TEST(others_keep_images) {
    brunt_world_def def = begin(&lies[0], H);
    box(&def, &lies[0], "bar", XYZ(-4 * H, 0, 0), XYZ(4 * H, 4 * H, 0));
    for (int k = 0; k < 3; k++)
        plane(&def, &lies[0], 0, k == _i ? XYZ(1, 0, 0) : XYZ(0, 1, 0), k == _i ? BRUNT_STICK : BRUNT_SLIP);
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(world->boundaries.symmetry_count, 2);
    for (int k = 0; k < 3; k++) {
        const int at = world->boundaries.boundary[k].symmetry_plane;
        ck_assert_int_eq(at, k == _i ? -1 : k > _i ? k - 1 : k);
        if (at >= 0) ck_assert_int_eq(world->boundaries.symmetry[at].boundary, k);
    }
    world_steps(world, 3);
    brunt_world_destroy(world);
}
END_TEST

// The same bits for any number of threads, and taken up in between.
START_TEST(same_bits) {
    uint64_t first = 0;
    for (int threads = 1; threads <= 4; threads++) {
        brunt_world_def def = meeting_of(&lies[_i / MEETINGS], (meeting)(_i % MEETINGS), 0.3, false);
        def.threads = threads < 4 ? threads : 2;
        brunt_world *world = world_from(&def), *fresh = world_take(&def);
        if (threads == 4) { // restarted
            world_steps(world, 23);
            world_copy_state(world, fresh);
            brunt_world *other = world;
            world = fresh, fresh = other;
            world_steps(world, 17);
        } else {
            world_steps(world, 40);
        }
        const uint64_t hash = brunt_world_hash(world);
        if (threads == 1) first = hash;
        ck_assert_uint_eq(hash, first);
        brunt_world_destroy(world), brunt_world_destroy(fresh);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("stick_planes");
    if (sizeof(real) == 8) { // the way is 3e-5 m; of places of 1 m single precision loses 6e-8 m in each step
        ADD_LOOP(hangs, HANGINGS * LIES);
        ADD_LOOP(hangs_better_by_finer_cells, HANGINGS);
    }
    ADD_LOOP(in_a_corner_as_the_whole, 2 * LIES);
    ADD_LOOP(between_planes, 6);
    ADD_LOOP(meets, 2 * MEETINGS * LIES);
    if (sizeof(real) == 8) ADD_LOOP(meets_the_other_way_round, 4 * ON_A_THIN_ONE);
    ADD_LOOP(images_follow, 2 * MEETINGS * LIES);
    ADD_LOOP(as_against_symmetry, LIES);
    ADD_LOOP(held_before_it, (sizeof(real) == 8 ? 3 : 1) * MIRRORS * GRIPS * LIES);
    ADD_LOOP(later_ones_hold, (sizeof(real) == 8 ? 4 : 2) * LIES);
    ADD_LOOP(nodes_hold, 4);
    ADD_LOOP(others_keep_images, 3);
    ADD_LOOP(same_bits, 2 * MEETINGS);
    return suite_main(suite);
}
