// Edges that cross between their nodes: two bars that turn an edge to each other, one along z and one along y.
#include "tests/support/def_world.h"

static const double WIDTH = 1, SPEED = 0.05; // [m], [m/s] of each; waves run at 37 m/s
static const double APART = 0.01;            // [m] of each edge from x = 0
static const double LEDGER = 1e-4;           // of the energy: what explicit steps leave, with nodes at facets too

enum hold { FREE, RESTS, HELD, DRIVEN }; // the second bar: moves, is still, its surface is fixed, or goes on

typedef struct crossing {
    brunt_element_kind kind;
    int across[2];   // elements across the first bar, across the second ...
    int along[2];    // ... and along them: the middle is that of an element where they are odd
    double shift[3]; // [m] of the second bar
    double slide[2]; // [m/s] of the second bar along y and z
    double speed;    // [m/s] of each; 0: SPEED
    double friction;
    enum hold hold;
    bool swapped, mirrored; // the other bar first; y to the other side
    int threads;
} crossing;

static const crossing SQUARE = {.kind = BRUNT_HEX8, .across = {3, 3}, .along = {5, 5}, .threads = 1};
static const crossing ASKEW = {.kind = BRUNT_HEX8,
                               .across = {3, 3},
                               .along = {5, 5},
                               .shift = {0, 0.04, -0.07},
                               .slide = {0.011, 0.007},
                               .threads = 1};

static double speed_of(const crossing *c) { return c->speed > 0 ? c->speed : SPEED; }

// A bar along z (side -1) or y.
static void add_bar(brunt_world_def *def, const crossing *c, int side) {
    const int along = side < 0 ? 2 : 1, other = 3 - along;
    double half[3] = {0.5 * WIDTH, 0.5 * WIDTH, 0.5 * WIDTH};
    half[along] *= (double)c->along[side > 0] / c->across[side > 0];
    brunt_body_def *b = def_box(def, (side < 0) != c->swapped ? "a" : "b", XYZ(-half[0], -half[1], -half[2]), half);
    brunt_error error = {0};
    b->method = BRUNT_FEM;
    const double size = WIDTH / c->across[side > 0];
    ck_assert_int_eq(brunt_mesh_shape(&b->shape, 3, c->kind, size, &b->mesh, &error), BRUNT_OK);
    const double flip = c->mirrored ? -1 : 1, shift[3] = {0, flip * c->shift[1], c->shift[2]};
    for (int32_t n = 0; n < b->mesh.node_count; n++) {
        double *x = b->mesh.nodes[n], p = x[0], q = x[other], turn = along == 2 ? 1 : -1;
        x[0] = sqrt(0.5) * (p - turn * q) + side * (sqrt(0.5) * WIDTH + APART);
        x[other] = sqrt(0.5) * (q + turn * p);
        for (int a = 0; side > 0 && a < 3; a++) x[a] += shift[a];
    }
    if (side > 0 && c->hold == RESTS) return;
    b->velocity[0] = -side * speed_of(c) * (side > 0 && c->hold == HELD ? 0 : 1);
    if (side > 0 && c->hold == FREE) b->velocity[1] = flip * c->slide[0], b->velocity[2] = c->slide[1];
}

static void hold_bar(brunt_world_def *def, const crossing *c) {
    def->groups = brunt_alloc(sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", c->swapped ? "a" : "b");
    snprintf(g->group, sizeof g->group, "surface");
    g->action = BRUNT_GROUP_VELOCITY;
    g->value[0] = c->hold == DRIVEN ? -speed_of(c) : 0;
}

static brunt_world *world_of(const crossing *c) {
    brunt_world_def def = def_begin(3, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = c->friction;
    def.threads = c->threads;
    add_bar(&def, c, c->swapped ? 1 : -1);
    add_bar(&def, c, c->swapped ? -1 : 1);
    if (c->hold >= HELD) hold_bar(&def, c);
    return world_take(&def);
}

// The two nodes of a bar's foremost edge that another edge crosses at `at` along it.
static void find_edge(brunt_world *world, int body, int along, double side, double at, int32_t node[2]) {
    double *x = world_field(world, body, "position"), below = -INFINITY, above = INFINITY;
    node[0] = node[1] = -1;
    for (int64_t n = 0; n < brunt_body_nodes(world, body); n++) {
        if (!(fabs(x[3 * n] - side * APART) < 1e-9)) continue;
        const double z = x[3 * n + along];
        if (z <= at && z > below) below = z, node[0] = (int32_t)n;
        if (z > at && z < above) above = z, node[1] = (int32_t)n;
    }
    ck_assert(node[0] >= 0 && node[1] >= 0);
    free(x);
}

static void edge_of(brunt_world *world, int body, const int32_t node[2], double at[3], double e[3]) {
    double *x = world_field(world, body, "position");
    for (int k = 0; k < 3; k++) at[k] = x[3 * node[0] + k], e[k] = x[3 * node[1] + k] - at[k];
    free(x);
}

// Unit normal across both edges, out of the second bar, and how far the first's is before the second's.
static double gap_of(brunt_world *world, const crossing *c, int32_t node[2][2], double n[3]) {
    double at[2][3], e[2][3], gap = 0, size = 0;
    for (int i = 0; i < 2; i++) edge_of(world, c->swapped ? 1 - i : i, node[i], at[i], e[i]);
    for (int k = 0; k < 3; k++) {
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
        size += n[k] * n[k];
    }
    const double turn = (n[0] > 0 ? -1 : 1) / sqrt(size);
    for (int k = 0; k < 3; k++) n[k] *= turn, gap += n[k] * (at[0][k] - at[1][k]);
    return gap;
}

typedef struct outcome {
    double depth; // [m] that the edges have passed each other at most
    double angle; // [deg] of the impulse of any step to the normal, at most
    double cone;  // of any step: greatest difference of its tangential impulse over its normal one from mu
    double impulse[3], back[3]; // [N s] on the second bar; [m/s] of the first bar in the end
    brunt_momentum momentum;
    brunt_energy energy;
} outcome;

static void look_at_step(const crossing *c, const double n[3], const double J[3], outcome *o) {
    double along = 0, across = 0, whole = 0;
    for (int k = 0; k < 3; k++) along += J[k] * n[k], whole += J[k] * J[k];
    for (int k = 0; k < 3; k++) across += (J[k] - along * n[k]) * (J[k] - along * n[k]);
    if (!(whole > 0)) return;
    o->angle = fmax(o->angle, atan2(sqrt(across), fabs(along)) * 180 / PI);
    o->cone = fmax(o->cone, fabs(sqrt(across) / fabs(along) - c->friction));
}

static outcome meet(const crossing *c, double end) {
    brunt_world *world = world_of(c);
    int32_t node[2][2];
    find_edge(world, c->swapped ? 1 : 0, 2, -1, c->shift[2], node[0]);
    find_edge(world, c->swapped ? 0 : 1, 1, 1, 0, node[1]);
    outcome o = {0};
    double before[3] = {0};
    while (brunt_world_time(world) < end) {
        double n[3], J[3];
        const double gap = gap_of(world, c, node, n);
        o.depth = fmax(o.depth, -gap);
        world_steps(world, 1);
        const brunt_reaction f = world_pair(world, 0);
        for (int k = 0; k < 3; k++) J[k] = f.impulse[k] - before[k], before[k] = f.impulse[k];
        look_at_step(c, n, J, &o);
    }
    const brunt_body_sums s = world_sums(world, c->swapped ? 1 : 0);
    memcpy(o.impulse, before, sizeof before), memcpy(o.back, s.velocity, sizeof o.back);
    o.momentum = world_momentum(world), o.energy = world_energy(world);
    brunt_world_destroy(world);
    return o;
}

static void check_account(const outcome *o) {
    ck_assert_double_lt(o->momentum.linear_drift, 1e-14);
    ck_assert_double_lt(o->momentum.angular_drift, 1e-12);
    ck_assert_double_lt(fabs(o->energy.error_relative), LEDGER);
    ck_assert_double_ge(o->energy.contact, -1e-12 * o->energy.initial);
}

static void show(const char *what, const outcome *o) {
    printf("%s: depth %.1e m, impulse off by %.1e degrees, rebound %.4f, drift %.1e %.1e, energy error %.1e, contact "
           "took %.4f\n",
           what, o->depth, o->angle, -o->back[0] / SPEED, o->momentum.linear_drift, o->momentum.angular_drift,
           o->energy.error_relative, o->energy.contact / o->energy.initial);
}

// In the middle of elements, beside it, and of elements of other sizes: along the common normal, at no gap.
START_TEST(met_along_the_common_normal) {
    crossing c = SQUARE;
    if (_i == 1) c.shift[1] = 0.05, c.shift[2] = -0.08;
    if (_i == 2) c.across[1] = 5, c.along[1] = 9;
    if (_i == 3) c.kind = BRUNT_TET4;
    if (_i == 4) c = ASKEW;
    if (_i == 5) c.speed = 0.5;
    const outcome o = meet(&c, 0.7);
    show("met", &o);
    check_account(&o);
    ck_assert_double_gt(fabs(o.impulse[0]), 500 * SPEED);
    ck_assert_double_lt(o.depth, 1e-4 * WIDTH);
    ck_assert_double_lt(o.angle, 1e-8);
    if (_i == 0) ck_assert_double_lt(hypot(o.impulse[1], o.impulse[2]), 1e-10 * fabs(o.impulse[0]));
}
END_TEST

// Nodes that meet nodes (an even number of elements along) rebound as edges between nodes, of bars a little shorter and
// longer.
START_TEST(rebounds_as_nodes_do) {
    double back[3];
    for (int k = 0; k < 3; k++) {
        crossing c = SQUARE;
        c.along[0] = c.along[1] = 5 + k;
        const outcome o = meet(&c, 0.8);
        show(k % 2 ? "nodes" : "edges", &o);
        check_account(&o);
        if (k != 1) ck_assert_double_lt(o.angle, 1e-8);
        back[k] = -o.back[0] / SPEED;
    }
    ck_assert_double_lt(fabs(back[1] - 0.5 * (back[0] + back[2])), 0.02);
}
END_TEST

START_TEST(mirrored_and_swapped) {
    crossing c = ASKEW;
    c.friction = 0.3;
    const outcome plain = meet(&c, 0.5);
    c.mirrored = true;
    const outcome image = meet(&c, 0.5);
    c.mirrored = false, c.swapped = true;
    const outcome other = meet(&c, 0.5);
    const double size = fabs(plain.impulse[0]);
    double mirror = 0, swap = 0;
    for (int k = 0; k < 3; k++) {
        mirror = fmax(mirror, fabs(plain.impulse[k] - (k == 1 ? -1 : 1) * image.impulse[k]) / size);
        mirror = fmax(mirror, fabs(plain.back[k] - (k == 1 ? -1 : 1) * image.back[k]) / SPEED);
        swap = fmax(swap, fabs(plain.impulse[k] + other.impulse[k]) / size);
        swap = fmax(swap, fabs(plain.back[k] - other.back[k]) / SPEED);
    }
    printf("mirror image off by %.1e, other order by %.1e\n", mirror, swap);
    ck_assert_double_gt(size, 0);
    ck_assert_double_lt(mirror, 1e-10);
    ck_assert_double_lt(swap, 1e-10);
}
END_TEST

// What is still, what is fixed, and what goes on whatever meets it.
START_TEST(one_rests_is_held_or_driven) {
    const enum hold hold[] = {RESTS, HELD, DRIVEN};
    crossing c = ASKEW;
    c.hold = hold[_i];
    const outcome o = meet(&c, 0.7);
    show("held", &o);
    if (c.hold == RESTS) check_account(&o);
    ck_assert_double_lt(fabs(o.energy.error_relative), LEDGER);
    ck_assert_double_lt(o.depth, 1e-4 * WIDTH);
    ck_assert_double_lt(o.angle, 1e-8);
    const double mass = 1000 * WIDTH * WIDTH * WIDTH * 5 / 3, given = mass * (o.back[0] - SPEED);
    ck_assert_double_gt(fabs(o.impulse[0]), 0.3 * mass * SPEED);
    ck_assert_double_lt(fabs(given + o.impulse[0]), 1e-10 * fabs(given));
}
END_TEST

START_TEST(slides_with_friction) {
    crossing c = SQUARE;
    c.friction = 0.2, c.slide[0] = _i ? 0 : 0.2, c.slide[1] = _i ? 0.2 : 0.1, c.shift[1] = -0.05;
    const outcome o = meet(&c, 0.4);
    show("slides", &o);
    printf("tangential over normal impulse of any step: off by %.1e\n", o.cone);
    check_account(&o);
    ck_assert_double_gt(o.energy.friction, 0);
    ck_assert_double_gt(fabs(o.impulse[0]), 0);
    ck_assert_double_lt(o.cone, 1e-9);
}
END_TEST

// The first bar's edge leaves the second's over its end: no energy comes or goes but what contact takes.
START_TEST(leaves_over_the_end) {
    crossing c = SQUARE;
    const double end = 0.5 * 5.0 / 3 * WIDTH - 0.05;
    c.shift[1] = _i ? 0.03 : -end, c.shift[2] = _i ? end : 0.03, c.slide[_i] = _i ? 0.33 : -0.33, c.speed = 0.1;
    brunt_world *world = world_of(&c);
    double greatest = 0;
    while (brunt_world_time(world) < 0.6) {
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        greatest = fmax(greatest, (e.kinetic + e.internal) / e.initial);
    }
    const brunt_energy e = world_energy(world);
    const brunt_momentum p = world_momentum(world);
    const brunt_reaction f = world_pair(world, 0);
    printf("greatest energy %.12f of the first, ledger error %.1e, impulse %.3g %.3g %.3g, drift %.1e %.1e\n", greatest,
           e.error_relative, f.impulse[0], f.impulse[1], f.impulse[2], p.linear_drift, p.angular_drift);
    brunt_world_destroy(world);
    ck_assert_double_gt(fabs(f.impulse[0]), 0);
    ck_assert_double_lt(greatest, 1 + 1e-6);
    ck_assert_double_lt(fabs(e.error_relative), LEDGER);
    ck_assert_double_lt(p.linear_drift, 1e-14);
    ck_assert_double_lt(p.angular_drift, 1e-12);
}
END_TEST

// Half as fast as waves run, each: a fifth of an element in a step. They stop where they meet.
START_TEST(nothing_passes_in_a_step) {
    crossing c = SQUARE;
    c.speed = 18, c.shift[1] = _i ? 0.04 : 0, c.shift[2] = _i ? -0.07 : 0;
    brunt_world *world = world_of(&c);
    int32_t node[2][2];
    double n[3];
    find_edge(world, 0, 2, -1, c.shift[2], node[0]), find_edge(world, 1, 1, 1, 0, node[1]);
    for (int k = 0; k < 4; k++) {
        world_steps(world, 1);
        ck_assert_double_gt(gap_of(world, &c, node, n), -1e-3 * WIDTH);
    }
    ck_assert_double_gt(brunt_world_time(world) * 2 * c.speed, 20 * APART);
    const brunt_momentum p = world_momentum(world);
    ck_assert_double_lt(p.linear_drift, 1e-14);
    ck_assert_double_lt(p.angular_drift, 1e-12);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ membranes

static const double THICK = 0.02; // [m]

// A square of 3 x 3 in a plane that has the x axis, its rim along `along` towards the other one.
static void add_membrane(brunt_world_def *def, int along, double side) {
    enum { N = 3 };
    brunt_body_def *b = def_body(def, side < 0 ? "a" : "b");
    brunt_mesh *mesh = &b->mesh;
    b->method = BRUNT_MEMBRANE, b->thickness = THICK, b->element = BRUNT_MEMBRANE_QUAD4;
    *mesh = (brunt_mesh){.kind = BRUNT_MEMBRANE_QUAD4, .node_count = (N + 1) * (N + 1), .element_count = N * N};
    mesh->nodes = brunt_alloc((size_t)mesh->node_count * sizeof *mesh->nodes);
    mesh->elements = brunt_alloc((size_t)mesh->element_count * 4 * sizeof *mesh->elements);
    int32_t *element = mesh->elements;
    for (int32_t i = 0, k = 0; i <= N; i++)
        for (int32_t j = 0; j <= N; j++, k++) {
            mesh->nodes[k][0] = side * (APART + 0.5 * THICK + i * WIDTH / N);
            mesh->nodes[k][along] = (j - 0.5 * N) * WIDTH / N, mesh->nodes[k][3 - along] = 0;
            const int32_t corner[4] = {k, k + N + 1, k + N + 2, k + 1};
            for (int c = 0; c < 4 && i < N && j < N; c++) *element++ = corner[c];
        }
    b->velocity[0] = -side * SPEED;
}

// Two sheets that meet each other in their own planes, crosswise: half a thickness of each stays between.
START_TEST(rims_of_membranes_cross) {
    brunt_world_def def = def_begin(3, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    add_membrane(&def, 2, -1), add_membrane(&def, 1, 1);
    brunt_world *world = world_take(&def);
    double least = INFINITY;
    while (brunt_world_time(world) < 0.7) {
        world_steps(world, 1);
        double *a = world_field(world, 0, "position"), *b = world_field(world, 1, "position");
        least = fmin(least, 0.5 * (b[3] + b[6] - a[3] - a[6])); // the middle ones of each rim
        free(a), free(b);
    }
    const brunt_body_sums s = world_sums(world, 0);
    const brunt_momentum p = world_momentum(world);
    printf("rims: %.6f thicknesses apart at least, rebound %.4f, drift %.1e %.1e\n", least / THICK,
           -s.velocity[0] / SPEED, p.linear_drift, p.angular_drift);
    brunt_world_destroy(world);
    ck_assert_double_gt(least, THICK - 1e-4 * WIDTH);
    ck_assert_double_lt(least, THICK + 1e-4 * WIDTH);
    ck_assert_double_lt(s.velocity[0], -0.5 * SPEED);
    ck_assert_double_lt(fabs(s.velocity[1]) + fabs(s.velocity[2]), 1e-10 * SPEED);
    ck_assert_double_lt(p.linear_drift, 1e-14);
    ck_assert_double_lt(p.angular_drift, 1e-12);
}
END_TEST

static void check_same(brunt_world *a, brunt_world *b) { ck_assert(brunt_world_hash(a) == brunt_world_hash(b)); }

START_TEST(same_bits_for_threads_and_restart) {
    crossing c = ASKEW;
    c.friction = 0.3;
    brunt_world *one = world_of(&c), *restored = world_of(&c);
    c.threads = 2;
    brunt_world *two = world_of(&c);
    for (int k = 1; k <= 6; k++) {
        world_until(one, 0.05 * k), world_until(two, 0.05 * k);
        check_same(one, two);
        brunt_world_destroy(restored);
        c.threads = 1, restored = world_of(&c);
        world_copy_state(two, restored);
        world_until(one, 0.05 * k + 0.03), world_until(two, 0.05 * k + 0.03), world_until(restored, 0.05 * k + 0.03);
        check_same(one, restored), check_same(one, two);
    }
    ck_assert_double_gt(fabs(world_pair(one, 0).impulse[0]), 0);
    brunt_world_destroy(one), brunt_world_destroy(two), brunt_world_destroy(restored);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("edges cross");
    ADD_LOOP(met_along_the_common_normal, 6);
    ADD_LOOP(rebounds_as_nodes_do, 1);
    ADD_LOOP(mirrored_and_swapped, 1);
    ADD_LOOP(one_rests_is_held_or_driven, 3);
    ADD_LOOP(slides_with_friction, 2);
    ADD_LOOP(leaves_over_the_end, 2);
    ADD_LOOP(nothing_passes_in_a_step, 2);
    ADD_LOOP(rims_of_membranes_cross, 1);
    ADD_LOOP(same_bits_for_threads_and_restart, 1);
    return suite_main(suite);
}
