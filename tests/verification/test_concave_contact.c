// What node-to-facet contact does not meet by itself: edges that cross between their nodes, and inside edges, where a
// node touches two walls at once.
#include "tests/support/def_world.h"

static const double SPEED = 0.5; // [m/s]; waves run at 37 m/s

static brunt_world_def soft(int dimension) {
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = 0;
    return def;
}

static void make_mesh(brunt_body_def *b, int dimension, brunt_element_kind kind, double size) {
    brunt_error error = {0};
    b->method = BRUNT_FEM;
    ck_assert_int_eq(brunt_mesh_shape(&b->shape, dimension, kind, size, &b->mesh, &error), BRUNT_OK);
}

// ------------------------------------------------------------------------------------------ edges that cross

static const double WIDTH = 1, SIZE = 1.0 / 3, LENGTH = 5.0 / 3, APART = 0.01;

// A bar along z or y that turns an edge to the other one, whose middle is the middle of an element.
static void add_bar(brunt_world_def *def, const char *name, brunt_element_kind kind, int along, double side) {
    double half[3] = {0.5 * WIDTH, 0.5 * WIDTH, 0.5 * WIDTH};
    half[along] = 0.5 * LENGTH;
    brunt_body_def *b = def_box(def, name, XYZ(-half[0], -half[1], -half[2]), half);
    make_mesh(b, 3, kind, SIZE);
    const int across = 3 - along;
    for (int32_t n = 0; n < b->mesh.node_count; n++) {
        double *x = b->mesh.nodes[n], p = x[0], q = x[across], turn = along == 2 ? 1 : -1;
        x[0] = sqrt(0.5) * (p - turn * q) + side * (sqrt(0.5) * WIDTH + APART);
        x[across] = sqrt(0.5) * (q + turn * p);
    }
    b->velocity[0] = -side * SPEED;
}

typedef struct world_edges {
    brunt_world *world;
    int32_t node[2][2];
} world_edges;

// Unit normal across both foremost edges, from the first bar to the second; how far they have passed each other along
// it.
static double passed(world_edges *at, double n[3]) {
    double x[2][2][3], size = 0, depth = 0;
    for (int body = 0; body < 2; body++) {
        double *all = world_field(at->world, body, "position");
        for (int i = 0; i < 2; i++) memcpy(x[body][i], all + 3 * at->node[body][i], sizeof x[body][i]);
        free(all);
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (x[0][1][i] - x[0][0][i]) * (x[1][1][j] - x[1][0][j]) -
               (x[0][1][j] - x[0][0][j]) * (x[1][1][i] - x[1][0][i]);
        size += n[k] * n[k];
    }
    const double turn = (n[0] < 0 ? -1 : 1) / sqrt(size);
    for (int k = 0; k < 3; k++) n[k] *= turn, depth += n[k] * (x[0][0][k] - x[1][0][k]);
    return depth;
}

static void find_front(brunt_world *world, int body, int along, double side, int32_t node[2]) {
    double *x = world_field(world, body, "position");
    int found = 0;
    for (int64_t n = 0; n < brunt_body_nodes(world, body) && found < 2; n++)
        if (fabs(x[3 * n] - side * APART) < 1e-9 && fabs(x[3 * n + along]) < 0.6 * SIZE) node[found++] = (int32_t)n;
    ck_assert_int_eq(found, 2);
    free(x);
}

typedef struct crossing {
    double depth;   // [m] that the edges have passed each other at most
    double across;  // [deg] of any step's impulse to the normal across both edges in that step, at most
    double turned;  // [deg] of the whole impulse to the normal at the start
    double rebound; // of the speed
    double linear, angular;
} crossing;

// Between the lines of two vectors.
static double degrees_between(const double a[3], const double b[3]) {
    double along = 0, across = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        along += a[k] * b[k], across += (a[i] * b[j] - a[j] * b[i]) * (a[i] * b[j] - a[j] * b[i]);
    }
    return atan2(sqrt(across), fabs(along)) * 180 / PI;
}

static crossing cross_bars(brunt_element_kind kind) {
    brunt_world_def def = soft(3);
    add_bar(&def, "a", kind, 2, -1);
    add_bar(&def, "b", kind, 1, 1);
    brunt_world *world = world_take(&def);
    world_edges at = {world, {{0}}};
    find_front(world, 0, 2, -1, at.node[0]), find_front(world, 1, 1, 1, at.node[1]);
    crossing c = {0};
    brunt_reaction f = {0};
    while (brunt_world_time(world) < 0.8) {
        double n[3], J[3];
        c.depth = fmax(c.depth, passed(&at, n));
        world_steps(world, 1);
        const brunt_reaction now = world_pair(world, 0);
        for (int k = 0; k < 3; k++) J[k] = now.impulse[k] - f.impulse[k];
        f = now;
        if (J[0] != 0) c.across = fmax(c.across, degrees_between(J, n));
    }
    const brunt_momentum p = world_momentum(world);
    const brunt_body_sums s = world_sums(world, 0);
    c.turned = degrees_between(f.impulse, XYZ(1, 0, 0));
    c.rebound = -s.momentum[0] / (s.mass * SPEED);
    c.linear = p.linear_drift, c.angular = p.angular_drift;
    brunt_world_destroy(world);
    return c;
}

// C06. Edges meet edges at no gap, the impulse of each step along the normal across both as they then are. Hexahedra
// keep that normal; tetrahedra are not symmetric about the line, so that edges turn as they bend, by a degree here, and
// the whole impulse with them.
START_TEST(edges_cross_between_their_nodes) {
    const crossing c = cross_bars(_i ? BRUNT_TET4 : BRUNT_HEX8);
    printf("%s: depth %.1e h, impulse of a step off by %.1e degrees, whole by %.1e, rebound %.4f, drift %.1e %.1e\n",
           _i ? "tet4" : "hex8", c.depth / SIZE, c.across, c.turned, c.rebound, c.linear, c.angular);
    ck_assert_double_lt(c.linear, 1e-12);
    ck_assert_double_lt(c.angular, 1e-12);
    ck_assert_double_lt(c.depth, 1e-5 * SIZE);
    ck_assert_double_lt(c.across, 1e-8);
    if (!_i) ck_assert_double_lt(c.turned, 1e-8);
    ck_assert_double_gt(c.rebound, 0.9);
}
END_TEST

// ------------------------------------------------------------------------------------------ inside edges

// A mesh without the elements whose middle is beyond 1 along both x and y, and without what nodes they leave.
static void cut_corner(brunt_mesh *mesh) {
    const int nodes = brunt_element_nodes(mesh->kind);
    int32_t *now = malloc((size_t)mesh->node_count * sizeof *now), kept = 0, count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) now[n] = -1;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const int32_t *from = mesh->elements + (size_t)e * (size_t)nodes;
        double x = 0, y = 0;
        for (int k = 0; k < nodes; k++) x += mesh->nodes[from[k]][0] / nodes, y += mesh->nodes[from[k]][1] / nodes;
        if (x > 1 && y > 1) continue;
        memmove(mesh->elements + (size_t)kept++ * (size_t)nodes, from, (size_t)nodes * sizeof *from);
    }
    mesh->element_count = kept;
    for (int32_t k = 0; k < kept * nodes; k++) now[mesh->elements[k]] = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (now[n] < 0) continue;
        memmove(mesh->nodes[count], mesh->nodes[n], sizeof mesh->nodes[n]);
        now[n] = count++;
    }
    mesh->node_count = count, mesh->group_count = 0; // walls have no names
    for (int32_t k = 0; k < kept * nodes; k++) mesh->elements[k] = now[mesh->elements[k]];
    free(now);
}

// x and y in each other's place; elements change their sense.
static void mirror(brunt_mesh *mesh) {
    const int nodes = brunt_element_nodes(mesh->kind);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        const double x = mesh->nodes[n][0];
        mesh->nodes[n][0] = mesh->nodes[n][1], mesh->nodes[n][1] = x;
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int first = 1; first < nodes; first += 4) {
            int32_t *node = mesh->elements + (size_t)e * (size_t)nodes + first, swap = node[0];
            node[0] = node[2], node[2] = swap;
        }
}

typedef struct trough {
    int dimension;
    double size;     // [m] of the cube's elements, 0: of points; the trough's are 0.5 m
    double vx, vy;   // [m/s] of the cube
    bool cube_first; // by its name, which is the order of the bodies
} trough;

static void add_trough(brunt_world_def *def, const trough *t, bool mirrored) {
    brunt_body_def *b = def_box(def, "t", XYZ(0, 0, 0), XYZ(3, 3, 1));
    make_mesh(b, t->dimension, t->dimension == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, 0.5);
    cut_corner(&b->mesh);
    if (mirrored) mirror(&b->mesh);
}

static void add_cube(brunt_world_def *def, const trough *t, bool mirrored) {
    brunt_body_def *b = def_box(def, t->cube_first ? "c" : "u", XYZ(1.01, 1.01, 0), XYZ(2.01, 2.01, 1));
    if (t->size > 0) make_mesh(b, t->dimension, t->dimension == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, t->size);
    if (mirrored && t->size > 0) mirror(&b->mesh);
    b->velocity[0] = mirrored ? t->vy : t->vx, b->velocity[1] = mirrored ? t->vx : t->vy;
}

static brunt_world *press(const trough *t, bool mirrored) {
    brunt_world_def def = soft(t->dimension);
    add_trough(&def, t, mirrored);
    add_cube(&def, t, mirrored);
    brunt_world *world = world_take(&def);
    world_until(world, 0.1);
    return world;
}

// How far the mirrored scene's nodes move otherwise than the mirror images of the scene's nodes [m/s].
static double mirror_error(const trough *t) {
    brunt_world *thing = press(t, false), *image = press(t, true);
    double worst = 0;
    for (int body = 0; body < 2; body++) {
        double *v = world_field(thing, body, "velocity"), *w = world_field(image, body, "velocity");
        for (int64_t n = 0; n < brunt_body_nodes(thing, body); n++)
            for (int a = 0; a < 3; a++) worst = fmax(worst, fabs(v[3 * n + a] - w[3 * n + (a < 2 ? 1 - a : a)]));
        free(v), free(w);
    }
    brunt_world_destroy(thing), brunt_world_destroy(image);
    return worst;
}

// C06. Pressed in along the diagonal both walls bear the same, and all of what the cube loses. The node in the inside
// corner is as near to both: with the first alone they differed by 8 %, and mirror images by 0.5 m/s.
START_TEST(cube_in_the_corner_of_a_trough) {
    for (int k = 0; k < 6; k++) {
        const double sizes[] = {1.0 / 3, 0.5, 0};
        const trough even = {_i ? 3 : 2, sizes[k % 3], -SPEED, -SPEED, k > 2};
        trough odd = even;
        odd.vy *= 0.4;
        brunt_world *world = press(&even, false);
        const brunt_reaction f = world_pair(world, 0);
        const brunt_momentum p = world_momentum(world);
        const brunt_energy e = world_energy(world);
        const brunt_body_sums s = world_sums(world, even.cube_first ? 0 : 1);
        brunt_world_destroy(world);
        const double lost = s.momentum[0] + s.mass * SPEED, J = fabs(f.impulse[0]);
        ck_assert_double_gt(lost, 0.5 * s.mass * SPEED);
        const double balance = fabs(f.impulse[0] - f.impulse[1]) / J, all = fabs(J - lost) / lost;
        const double mirrored = even.size > 0 ? mirror_error(&even) : 0, askew = even.size > 0 ? mirror_error(&odd) : 0;
        printf("%dD, elements of %.2f m: walls differ by %.1e, impulse from what was lost by %.1e; mirror images by "
               "%.1e, %.1e m/s; contact took %.1e, drift %.1e %.1e\n",
               even.dimension, even.size, balance, all, mirrored, askew, e.contact / e.initial, p.linear_drift,
               p.angular_drift);
        ck_assert_double_lt(p.linear_drift, 1e-12);
        ck_assert_double_lt(p.angular_drift, 1e-12);
        ck_assert_double_lt(all, 1e-10);
        ck_assert_double_lt(balance, 1e-10);
        ck_assert_double_lt(mirrored, 1e-10);
        ck_assert_double_lt(askew, 1e-10);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("concave contact");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, edges_cross_between_their_nodes, 0, 2);
    tcase_add_loop_test(all, cube_in_the_corner_of_a_trough, 0, 2);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
