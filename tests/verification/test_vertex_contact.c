// Corners and edges that meet corners and edges: the impulse is along the line of centres wherever both bodies are
// symmetric about it, and what is mirrored, swapped or turned does the same, mirrored, swapped or turned (C06).
#include "tests/support/def_world.h"
#include "tests/support/hard_case.h"

typedef enum feature { FACE, EDGE, CROSSED_EDGE, CORNER } feature; // what a body turns to the other one
typedef enum matter { COARSE, FINE, POINTS } matter;               // elements: two or three a side

typedef struct meeting {
    int dimension;
    feature a, b;
    matter of_a, of_b;
} meeting;

// How the scene lies: what would be along x is along the first column.
typedef struct frame {
    double turn[3][3], shift[3];
    bool swapped; // the second body comes first
    double friction;
    double aside[3]; // [m] of the second body, before all is turned
} frame;

static const double SIDE = 1, SPEED = 0.5; // [m], [m/s] of each body; waves run at 37 m/s

// ------------------------------------------------------------------------------------------ turns

static void product(const double (*A)[3], const double (*B)[3], double C[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) C[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j];
}

static void turned_by(const double axis[3], double angle, double R[3][3]) {
    const brunt_placement p = brunt_placement_rotate(brunt_placement_identity(), axis, angle, XYZ(0, 0, 0));
    memcpy(R, p.rotation, sizeof p.rotation);
}

static void unturned(double R[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) R[i][j] = i == j;
}

static double determinant(const double (*R)[3]) {
    double det = 0;
    for (int a = 0; a < 3; a++)
        det += R[0][a] * (R[1][(a + 1) % 3] * R[2][(a + 2) % 3] - R[1][(a + 2) % 3] * R[2][(a + 1) % 3]);
    return det;
}

// Brings what a box turns to the other one onto the x axis.
static void show(feature f, int dimension, double R[3][3]) {
    unturned(R);
    if (f == EDGE || (f == CORNER && dimension == 2)) turned_by(XYZ(0, 0, 1), PI / 4, R);
    if (f == CROSSED_EDGE) turned_by(XYZ(0, 1, 0), PI / 4, R);
    if (f != CORNER || dimension == 2) return;
    double first[3][3], second[3][3];
    turned_by(XYZ(0, 0, 1), -PI / 4, first); // (1, 1, 1) to (sqrt 2, 0, 1), and on
    turned_by(XYZ(0, 1, 0), atan(sqrt(0.5)), second);
    product(second, first, R);
}

static double reach(feature f, int dimension) {
    return 0.5 * SIDE * (f == FACE ? 1 : f == CORNER && dimension == 3 ? sqrt(3) : sqrt(2));
}

// ------------------------------------------------------------------------------------------ worlds

// Moves a mesh by x -> R x + shift; where R mirrors, its elements change their sense.
static void move_mesh(brunt_mesh *mesh, const double (*R)[3], const double shift[3]) {
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double x[3];
        for (int a = 0; a < 3; a++)
            x[a] = shift[a] + R[a][0] * mesh->nodes[n][0] + R[a][1] * mesh->nodes[n][1] + R[a][2] * mesh->nodes[n][2];
        memcpy(mesh->nodes[n], x, sizeof x);
    }
    const int nodes = brunt_element_nodes(mesh->kind);
    for (int32_t e = 0; e < mesh->element_count && determinant(R) < 0; e++)
        for (int first = 1; first < nodes; first += 4) {
            int32_t *node = mesh->elements + (size_t)e * (size_t)nodes + first, swap = node[0];
            node[0] = node[2], node[2] = swap;
        }
}

static void add(brunt_world_def *def, const char *name, feature f, matter of, const frame *g, double side) {
    const double half = 0.5 * SIDE;
    const double offset = side * (reach(f, def->dimension) + 0.01);
    double own[3][3], around[3][3], R[3][3], all[3][3], shift[3];
    brunt_body_def *b = def_box(def, name, XYZ(-half, -half, -half), XYZ(half, half, half));
    show(f, def->dimension, own);
    turned_by(XYZ(0, 0, 1), side > 0 ? PI : 0, around);
    product(around, own, R);
    product(g->turn, R, all);
    for (int a = 0; a < 3; a++) {
        shift[a] = g->shift[a] + g->turn[a][0] * offset;
        for (int c = 0; c < 3 && side > 0; c++) shift[a] += g->turn[a][c] * g->aside[c];
        b->velocity[a] = -side * SPEED * g->turn[a][0];
    }
    if (of == POINTS) {
        memcpy(b->place.rotation, all, sizeof all);
        memcpy(b->place.translation, shift, sizeof shift);
        return;
    }
    brunt_error error = {0};
    const brunt_element_kind kind = def->dimension == 2 ? BRUNT_QUAD4 : BRUNT_HEX8;
    b->method = BRUNT_FEM;
    ck_assert_int_eq(brunt_mesh_shape(&b->shape, def->dimension, kind, SIDE / (of == COARSE ? 2 : 3), &b->mesh, &error),
                     BRUNT_OK);
    move_mesh(&b->mesh, all, shift);
}

static brunt_world *meet(const meeting *m, const frame *g) {
    brunt_world_def def = def_begin(m->dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = g->friction;
    add(&def, g->swapped ? "b" : "a", m->a, m->of_a, g, -1);
    add(&def, g->swapped ? "a" : "b", m->b, m->of_b, g, 1);
    return world_take(&def);
}

// ------------------------------------------------------------------------------------------ line of centres

typedef struct outcome {
    double across[2]; // [deg] of the impulse to the line of centres, along what would be y and z
    double kept;      // of the energy, against what contact took
    double linear, angular;
} outcome;

static outcome measure(const meeting *m, const frame *g) {
    brunt_world *world = meet(m, g);
    world_until(world, 0.4);
    const brunt_reaction f = world_pair(world, 0);
    double J[3] = {0};
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++) J[a] += f.impulse[k] * g->turn[k][a];
    const brunt_momentum p = world_momentum(world);
    const brunt_energy e = world_energy(world);
    brunt_world_destroy(world);
    ck_assert_double_gt(fabs(J[0]), 100); // each has 500 kg m/s, or 500 a metre
    return (outcome){{atan2(fabs(J[1]), fabs(J[0])) * 180 / PI, atan2(fabs(J[2]), fabs(J[0])) * 180 / PI},
                     1 - e.contact / e.initial,
                     p.linear_drift,
                     p.angular_drift};
}

// Elements of both, or of one and points of the other: then the grid must be symmetric about the line, too, which it is
// across y in any case, and across both unless a corner is on the line.
static const meeting meetings[] = {
    {2, CORNER, CORNER, COARSE, COARSE},   {2, CORNER, CORNER, COARSE, FINE},
    {2, CORNER, FACE, COARSE, COARSE},     {2, CORNER, FACE, COARSE, FINE},
    {3, CORNER, CORNER, COARSE, COARSE},   {3, CORNER, CORNER, COARSE, FINE},
    {3, CORNER, EDGE, COARSE, COARSE},     {3, CORNER, EDGE, COARSE, FINE},
    {3, CORNER, FACE, COARSE, COARSE},     {3, CORNER, FACE, COARSE, FINE},
    {3, EDGE, EDGE, COARSE, COARSE},       {3, EDGE, EDGE, COARSE, FINE},
    {3, EDGE, EDGE, FINE, COARSE},         {3, EDGE, CROSSED_EDGE, COARSE, COARSE},
    {3, EDGE, CROSSED_EDGE, COARSE, FINE}, {3, EDGE, FACE, COARSE, COARSE},
    {3, EDGE, FACE, COARSE, FINE},         {3, FACE, FACE, COARSE, COARSE},
    {3, FACE, FACE, COARSE, FINE},         {2, FACE, FACE, COARSE, FINE},
    {2, CORNER, CORNER, COARSE, POINTS},   {2, CORNER, FACE, COARSE, POINTS},
    {2, CORNER, FACE, POINTS, COARSE},     {3, CORNER, CORNER, COARSE, POINTS},
    {3, CORNER, EDGE, COARSE, POINTS},     {3, CORNER, EDGE, POINTS, COARSE},
    {3, CORNER, FACE, COARSE, POINTS},     {3, CORNER, FACE, POINTS, COARSE},
    {3, EDGE, EDGE, COARSE, POINTS},       {3, EDGE, CROSSED_EDGE, COARSE, POINTS},
    {3, EDGE, FACE, COARSE, POINTS},       {3, EDGE, FACE, POINTS, COARSE},
};
enum { MEETINGS = sizeof meetings / sizeof meetings[0], FRAMES = 4 };

// As it is, by a quarter turn, by an odd angle and far away, mirrored; in either order, with friction and without.
static frame frame_of(int k, const meeting *m) {
    frame g = {.swapped = k % 2, .friction = k > 1 ? 0.3 : 0};
    const bool points = m->of_a == POINTS || m->of_b == POINTS;
    unturned(g.turn);
    if (k == 1) turned_by(XYZ(0, 0, 1), PI / 2, g.turn);
    if (k == 2 && !points) {
        turned_by(m->dimension == 2 ? XYZ(0, 0, 1) : XYZ(2, 3, 6), 0.7, g.turn);
        g.shift[0] = 30, g.shift[1] = -20, g.shift[2] = m->dimension == 2 ? 0 : 10;
    }
    if (k == 3 && !points) g.turn[0][0] = -1;
    g.shift[k == 1] += 0.01 * k; // along the line
    return g;
}

START_TEST(impulse_is_along_the_line_of_centres) {
    static const char *const name[] = {"face", "edge", "crossed edge", "corner"}, *const of[] = {"coarse", "fine",
                                                                                                 "points"};
    const meeting *m = &meetings[_i];
    const bool points = m->of_a == POINTS || m->of_b == POINTS;
    const bool even = !points || m->dimension == 2 || (m->a != CORNER && m->b != CORNER);
    double worst = 0;
    for (int k = 0; k < FRAMES; k++) {
        const frame g = frame_of(k, m);
        const outcome o = measure(m, &g);
        printf("%dD, %s of %s on %s of %s, %d: off by %.1e, %.1e degrees, contact keeps %.4f, drift %.1e %.1e\n",
               m->dimension, name[m->a], of[m->of_a], name[m->b], of[m->of_b], k, o.across[0], o.across[1], o.kept,
               o.linear, o.angular);
        worst = fmax(worst, fmax(o.across[0], even ? o.across[1] : 0));
        ck_assert_double_lt(o.linear, 1e-12);
        ck_assert_double_lt(o.angular, 1e-12);
        ck_assert_double_gt(o.kept, 0.7);
    }
    hard_case("C06", worst, 1e-8, 1e-8, "%dD, %s of %s on %s of %s: impulse off the line of centres [deg]",
              m->dimension, name[m->a], of[m->of_a], name[m->b], of[m->of_b]);
}
END_TEST

// ------------------------------------------------------------------------------------------ mirror images

// Velocities of all nodes, as if the scene had not been turned. free()
static double *velocities(const meeting *m, const frame *g, int64_t *count) {
    brunt_world *world = meet(m, g);
    world_until(world, 0.15);
    *count = brunt_body_nodes(world, 0) + brunt_body_nodes(world, 1);
    double *all = malloc((size_t)(3 * *count) * sizeof *all), *out = all;
    for (int k = 0; k < 2; k++) {
        const int body = g->swapped ? 1 - k : k;
        double *v = world_field(world, body, "velocity");
        for (int64_t n = 0; n < brunt_body_nodes(world, body); n++, out += 3)
            for (int a = 0; a < 3; a++)
                out[a] = g->turn[0][a] * v[3 * n] + g->turn[1][a] * v[3 * n + 1] + g->turn[2][a] * v[3 * n + 2];
        free(v);
    }
    brunt_world_destroy(world);
    return all;
}

// They meet beside the middle, so that all turn; faces and elements are in another order in the mirror.
START_TEST(mirror_image_does_as_the_thing) {
    const meeting *m = &meetings[_i];
    if (m->of_a == POINTS || m->of_b == POINTS) return;
    const bool lie[] = {true, true, m->dimension == 3};
    frame g = {.friction = 0.3, .aside = {0, 0.0625, 0}};
    unturned(g.turn);
    int64_t n;
    double *thing = velocities(m, &g, &n), worst = 0;
    for (int k = 0; k < 6; k++) {
        if (!lie[k % 3]) continue;
        unturned(g.turn);
        g.turn[k % 3][k % 3] = -1, g.swapped = k > 2;
        double *image = velocities(m, &g, &n), most = 0;
        for (int64_t i = 0; i < 3 * n; i++) most = fmax(most, fabs(image[i] - thing[i]));
        worst = fmax(worst, most);
        free(image);
    }
    // What the crossing rims of faces hold is kept at one of their nodes, by chance which where they cross in the
    // middle.
    hard_case("C06", worst, 1e-10, m->a == FACE && m->dimension == 3 ? 3e-3 : 1e-10,
              "meeting %d and its mirror images: velocities of nodes off by [m/s]", _i);
    free(thing);
}
END_TEST

// B04. A copper rod on its mirror image, each at the speed of a Taylor test.
START_TEST(rod_on_mirror_rod) {
    const double length = 32.4e-3, radius = 3.2e-3, size = 1.1e-3, speed = 190;
    brunt_world_def def = def_begin(3, size);
    brunt_error error = {0};
    def.materials[0] = brunt_material_def_default("copper", "von-mises");
    def.material_count = 1;
    brunt_material_set(&def.materials[0], "density", 8930, NULL, &error);
    brunt_material_set(&def.materials[0], "E", 117e9, NULL, &error);
    brunt_material_set(&def.materials[0], "nu", 0.35, NULL, &error);
    brunt_material_set(&def.materials[0], "yield", 400e6, NULL, &error);
    brunt_material_set(&def.materials[0], "hardening", 100e6, NULL, &error);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    const double friction = def.contact.friction = _i ? 0.2 : 0;
    for (int k = 0; k < 2; k++) {
        brunt_body_def *b = def_body(&def, k ? "lower" : "upper");
        b->shape = (brunt_shape){.kind = BRUNT_CYLINDER, .axis = {0, 0, 1}, .radius = radius, .length = length};
        b->method = BRUNT_FEM, b->velocity[2] = k ? speed : -speed;
        ck_assert_int_eq(brunt_mesh_shape(&b->shape, 3, BRUNT_HEX8, size, &b->mesh, &error), BRUNT_OK);
        const double R[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, k ? -1 : 1}};
        move_mesh(&b->mesh, R, XYZ(0, 0, 0));
    }
    brunt_world *world = world_take(&def);
    world_until(world, 40e-6);
    double *x = world_field(world, 0, "position"), *y = world_field(world, 1, "position"), most = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++)
        for (int a = 0; a < 3; a++) most = fmax(most, fabs(x[3 * n + a] - (a == 2 ? -1 : 1) * y[3 * n + a]));
    const brunt_body_sums lower = world_sums(world, 0), upper = world_sums(world, 1);
    const double plane = 0.5 * (lower.high[2] + upper.low[2]),
                 lengths = (upper.high[2] - upper.low[2]) - (lower.high[2] - lower.low[2]);
    const brunt_momentum p = world_momentum(world);
    printf("rod on its mirror image, friction %g: interface off by %.1e m, lengths by %.1e m, nodes by %.1e m; length "
           "%.2f mm, "
           "drift %.1e %.1e\n",
           friction, plane, lengths, most, 1e3 * (upper.high[2] - upper.low[2]), p.linear_drift, p.angular_drift);
    ck_assert_double_lt(upper.high[2] - upper.low[2], 0.9 * length); // it has been flattened
    ck_assert_double_lt(fabs(plane), 1e-10);
    ck_assert_double_lt(fabs(lengths), 1e-10);
    hard_case("C06", most, 1e-10, 1e-10, "rod on its mirror image, friction %g: nodes off by [m]", friction);
    ck_assert_double_lt(p.angular_drift, 1e-12);
    free(x), free(y);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("vertex contact");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, impulse_is_along_the_line_of_centres, 0, MEETINGS);
    tcase_add_loop_test(all, mirror_image_does_as_the_thing, 0, MEETINGS);
    tcase_add_loop_test(all, rod_on_mirror_rod, 0, 2);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
