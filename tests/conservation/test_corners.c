// Planes that hold material points and meet in a corner: what each of them takes, explicit and implicit, on lines of
// the grid, where images hold, and off them. All of it is the rate of momentum; a plane that slips takes nothing along
// it; and whichever is given first, each takes the same.
#include <math.h>

#include "tests/support/implicit_world.h"
#include "world/world.h"

static const double H = 0.1; // [m]

typedef struct corner {
    const char *name;
    int dim, planes;
    brunt_condition condition[4];
    int axis[4]; // each is normal to
    int far;     // bits: those on the far side of the block
    double off;  // [cells] off lines of the grid
} corner;
enum { X, Y, Z };
static const corner corners[] = {
    {"symmetry, symmetry", 2, 2, {BRUNT_SYMMETRY, BRUNT_SYMMETRY}, {X, Y}, 0, 0},
    {"slip, symmetry", 2, 2, {BRUNT_SLIP, BRUNT_SYMMETRY}, {X, Y}, 0, 0},
    {"stick, symmetry", 2, 2, {BRUNT_STICK, BRUNT_SYMMETRY}, {X, Y}, 0, 0},
    {"stick, slip", 2, 2, {BRUNT_STICK, BRUNT_SLIP}, {Y, X}, 0, 0},
    {"stick, stick", 2, 2, {BRUNT_STICK, BRUNT_STICK}, {X, Y}, 0, 0},
    {"slip, twice", 2, 2, {BRUNT_SLIP, BRUNT_SLIP}, {X, X}, 0, 0},
    {"stick, twice", 2, 2, {BRUNT_STICK, BRUNT_STICK}, {X, X}, 0, 0},
    {"stick, slip there", 2, 2, {BRUNT_STICK, BRUNT_SLIP}, {X, X}, 0, 0},
    {"stick, stick, off", 2, 2, {BRUNT_STICK, BRUNT_STICK}, {X, Y}, 0, 0.3},
    {"stick, slip, off", 2, 2, {BRUNT_STICK, BRUNT_SLIP}, {X, Y}, 0, 0.3},
    {"slip, slip, off", 2, 2, {BRUNT_SLIP, BRUNT_SLIP}, {X, Y}, 0, 0.3},
    {"between two, symmetry", 2, 3, {BRUNT_SYMMETRY, BRUNT_SLIP, BRUNT_SYMMETRY}, {X, X, Y}, 2, 0},
    {"between two, stick", 2, 3, {BRUNT_STICK, BRUNT_STICK, BRUNT_SYMMETRY}, {X, X, Y}, 2, 0},
    {"symmetry, thrice", 3, 3, {BRUNT_SYMMETRY, BRUNT_SLIP, BRUNT_SYMMETRY}, {X, Y, Z}, 0, 0},
    {"stick, symmetry, slip", 3, 3, {BRUNT_STICK, BRUNT_SYMMETRY, BRUNT_SLIP}, {X, Y, Z}, 0, 0},
    {"stick, stick, symmetry", 3, 3, {BRUNT_STICK, BRUNT_STICK, BRUNT_SYMMETRY}, {X, Y, Z}, 0, 0},
    {"stick, thrice", 3, 3, {BRUNT_STICK, BRUNT_STICK, BRUNT_STICK}, {X, Y, Z}, 0, 0},
    {"stick, slip, in space", 3, 2, {BRUNT_STICK, BRUNT_SLIP}, {Z, Y}, 0, 0},
    {"stick, stick, in space", 3, 2, {BRUNT_STICK, BRUNT_STICK}, {Z, Y}, 0, 0},
    {"stick, slip, slip, off", 3, 3, {BRUNT_STICK, BRUNT_SLIP, BRUNT_SLIP}, {X, Y, Z}, 0, 0.3},
    {"stick, stick, stick, off", 3, 3, {BRUNT_STICK, BRUNT_STICK, BRUNT_STICK}, {X, Y, Z}, 0, 0.3},
};
enum { CORNERS = sizeof corners / sizeof *corners };

typedef enum how { EXPLICIT, KEEPS, FLIP, EULER, NEWMARK, HOWS } how;
static const char *const how_names[] = {"explicit", "explicit, keeps", "explicit, flip", "euler", "newmark"};

static bool steps_implicitly(how h) { return h == EULER || h == NEWMARK; }

// Planes in the order that is given.
static brunt_world *make(const corner *c, how h, const int *order, int threads) {
    brunt_world_def def = def_begin(c->dim, H);
    const double wide = (c->dim == 2 ? 4 : 3) * H, at = c->off * H;
    def.threads = threads;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    if (steps_implicitly(h))
        go_implicit(&def, h == NEWMARK ? BRUNT_NEWMARK : BRUNT_EULER, 2e-3), def.newton.tolerance = 1e-13;
    else
        def.step = 1e-3;
    if (h == FLIP) def.transfer = BRUNT_FLIP, def.flip = 0.9;
    if (h == KEEPS) def.apic = 0.9;
    for (int a = 0; a < c->dim; a++) def.gravity[a] = -20 - 7 * a;
    brunt_body_def *b = def_box(&def, "block", XYZ(at, at, at), XYZ(at + wide, at + wide, at + wide));
    b->wave_velocity[0] = 1, b->wave_velocity[1] = 0.7, b->wave_velocity[2] = c->dim == 3 ? 0.4 : 0;
    b->wave_vector[0] = 5, b->wave_vector[1] = 3, b->wave_vector[2] = c->dim == 3 ? 4 : 0, b->wave_phase = 1;
    for (int i = 0; i < c->planes; i++) {
        const int k = order[i];
        double normal[3] = {0}, point[3] = {at, at, at};
        normal[c->axis[k]] = c->far >> k & 1 ? -1 : 1;
        if (c->far >> k & 1) point[c->axis[k]] += wide;
        brunt_plane_def *p = def_plane(&def, point, normal, c->condition[k], 0);
        snprintf(p->name, sizeof p->name, "plane%d", k);
    }
    return world_take(&def);
}

typedef struct borne {
    double J[4][3], L[4][3], *x; // of each plane, as in the table: impulse, moment; where the points are
    brunt_momentum m;
} borne;

static borne run(brunt_world *world, int steps, int planes, const int *order, int body) {
    borne b = {.x = NULL};
    world_steps(world, steps);
    b.m = world_momentum(world);
    b.x = world_field(world, body, "position");
    for (int i = 0; i < planes; i++)
        for (int a = 0; a < 3; a++) {
            b.J[order[i]][a] = world_boundary(world, i).impulse[a];
            b.L[order[i]][a] = world->boundaries.boundary[i].account.angular[a];
        }
    return b;
}

static const int orders[2][4] = {{0, 1, 2}, {2, 1, 0}}, turned[4] = {1, 0};

// Greatest difference of what planes bear, of the most that one does.
static double differ(const borne b[2], int planes) {
    double off = 0, most = 0;
    for (int i = 0; i < planes; i++)
        for (int a = 0; a < 3; a++) {
            most = fmax(most, fabs(b[0].J[i][a]));
            off = fmax(off, fmax(fabs(b[0].J[i][a] - b[1].J[i][a]), fabs(b[0].L[i][a] - b[1].L[i][a])));
        }
    return most > 0 ? off / most : INFINITY;
}

START_TEST(by_each) {
    const corner *c = &corners[_i % CORNERS];
    const how h = (how)(_i / CORNERS);
    double along = 0, moved = 0;
    borne b[2];
    for (int k = 0; k < 2; k++) {
        const int *order = k && c->planes == 2 ? turned : orders[c->planes > 2 && k];
        brunt_world *world = make(c, h, order, 1);
        b[k] = run(world, 40, c->planes, order, 0);
        for (int64_t i = 0; k && i < 3 * brunt_body_particles(world, 0); i++)
            moved = fmax(moved, fabs(b[1].x[i] - b[0].x[i]) / H);
        brunt_world_destroy(world);
    }
    for (int i = 0; i < c->planes; i++)
        for (int a = 0; a < 3; a++)
            if (c->condition[i] != BRUNT_STICK && a != c->axis[i]) along = fmax(along, fabs(b[0].J[i][a]));
    const double order = differ(b, c->planes);
    printf("  %dD %s, %s: drift %.1e %.1e, the other way %.1e, %.1e cells, along %.1e N s\n", c->dim, c->name,
           how_names[h], b[0].m.linear_drift, b[0].m.angular_drift, order, moved, along);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_le(b[k].m.linear_drift, 10 * ROUNDING);
        if (h == EXPLICIT || h == KEEPS) ck_assert_double_le(b[k].m.angular_drift, 10 * ROUNDING);
        free(b[k].x);
    }
    ck_assert_double_le(along, 100 * ROUNDING);
    ck_assert_double_le(moved, 1000 * ROUNDING);
    if (c->off == 0 || steps_implicitly(h)) ck_assert_double_le(order, 100 * ROUNDING);
}
END_TEST

// Whoever is given first, one that sticks is more than one that slips there.
START_TEST(sticks_where_it_slips) {
    const how h = (how)(_i / 2);
    static const corner both = {"", 2, 2, {BRUNT_STICK, BRUNT_SLIP}, {X, X}, 0, 0};
    const corner alone = {"", 2, 1, {BRUNT_STICK}, {X}, 0, 0};
    brunt_world *world[2] = {make(&both, h, _i % 2 ? turned : orders[0], 1), make(&alone, h, orders[0], 1)};
    borne b[2] = {run(world[0], 40, 2, _i % 2 ? turned : orders[0], 0), run(world[1], 40, 1, orders[0], 0)};
    for (int a = 0; a < 2; a++) {
        ck_assert_double_eq(b[0].J[0][a], b[1].J[0][a]);
        ck_assert_double_eq(b[0].J[1][a], 0);
    }
    for (int k = 0; k < 2; k++) free(b[k].x), brunt_world_destroy(world[k]);
}
END_TEST

// What one that sticks takes, of all that takes a block in a corner, along itself: the shear of the block.
static double shear(double cell) {
    brunt_world_def def = def_begin(2, cell);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    go_implicit(&def, BRUNT_EULER, 0), def.scheme = BRUNT_STATIC, def.load_steps = 1, def.end = 1;
    def.gravity[0] = def.gravity[1] = -2;
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(4 * H, 4 * H, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_STICK, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    const double sticks = world_boundary(world, 0).force[1], other = world_boundary(world, 1).force[1];
    brunt_world_destroy(world);
    return sticks / (sticks + other);
}

// The share is that of the block and not of the cell: a few hundredths of it with four cells.
START_TEST(is_the_shear) {
    const double coarse = shear(H), fine = shear(H / 8);
    printf("  the plane that sticks takes %.4f along it, with an eighth of the cell %.4f\n", coarse, fine);
    ck_assert_double_le(fabs(coarse / fine - 1), 0.03);
}
END_TEST

// Two bodies that meet in the corner.
START_TEST(meets_there) {
    static const brunt_condition of[][2] = {
        {BRUNT_STICK, BRUNT_STICK}, {BRUNT_STICK, BRUNT_SYMMETRY}, {BRUNT_SLIP, BRUNT_SYMMETRY}};
    const brunt_condition *condition = of[_i % 3];
    const bool mesh = _i / 3;
    borne b[2];
    for (int k = 0; k < 2; k++) {
        const int *order = k ? turned : orders[0];
        brunt_world_def def = def_begin(2, H);
        def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
        def.step = 1e-3;
        def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY, def.contact.friction = 0.3;
        def_box(&def, "a", XYZ(0, 0, 0), XYZ(2 * H, 4 * H, 0));
        brunt_body_def *body = def_box(&def, "b", XYZ(2 * H, 0, 0), XYZ(5 * H, 3 * H, 0));
        if (mesh) body->method = BRUNT_FEM, body->element = BRUNT_QUAD4, body->size = H;
        def_velocity(body, -2, 0.5, 0);
        for (int i = 0; i < 2; i++)
            def_plane(&def, XYZ(0, 0, 0), order[i] ? XYZ(0, 1, 0) : XYZ(1, 0, 0), condition[order[i]], 0);
        brunt_world *world = world_take(&def);
        b[k] = run(world, 60, 2, order, 0);
        ck_assert_double_gt(fabs(world_pair(world, 0).impulse[0]), 1);
        brunt_world_destroy(world);
    }
    printf("  %s, %d and %d: drift %.1e, the other way %.1e\n", mesh ? "mesh" : "points", condition[0], condition[1],
           b[0].m.linear_drift, differ(b, 2));
    for (int k = 0; k < 2; k++) {
        ck_assert_double_le(b[k].m.linear_drift, 10 * ROUNDING);
        free(b[k].x);
    }
    ck_assert_double_le(differ(b, 2), 1000 * ROUNDING);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("corners");
    const int hows = sizeof(real) == 8 ? HOWS : EULER; // implicit steps want double
    ADD_LOOP(by_each, hows * CORNERS);
    ADD_LOOP(sticks_where_it_slips, hows * 2);
    if (sizeof(real) == 8) ADD_LOOP(is_the_shear, 1);
    ADD_LOOP(meets_there, 6);
    return suite_main(suite);
}
