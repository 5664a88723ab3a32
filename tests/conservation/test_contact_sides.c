// One-way contact: of two meshes one is the slave, whose nodes are held off the other's facets, and no others are. A
// pin that is narrower than a facet of the plate it falls on tells which: as the slave it is stopped, and where the
// plate is the slave it falls through, since no node of the plate is under it. Both orders of the bodies, both names,
// either one that moves, planes, space and membranes.
#include "tests/support/hard_world.h"

#include "contact/contact.h"
#include "world/world.h"

static const double SPEED = 0.5; // [m/s] a twentieth of the wave speed

typedef struct pin {
    int dim;
    bool pin_is_slave, plate_first, plate_moves, membrane;
} pin;

static void add_sides(brunt_world_def *def, const char *slave, const char *master) {
    def->contact.pairs =
        realloc(def->contact.pairs, (size_t)(def->contact.pair_count + 1) * sizeof *def->contact.pairs);
    brunt_pair_def *pair = &def->contact.pairs[def->contact.pair_count++];
    *pair =
        (brunt_pair_def){.method = BRUNT_CONTACT_AUGURY, .friction = def->contact.friction, .sides = BRUNT_SIDES_SLAVE};
    snprintf(pair->a, sizeof pair->a, "%s", slave), snprintf(pair->b, sizeof pair->b, "%s", master);
}

static brunt_body_def *add_mesh(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                                double size) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = def->dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, b->size = size;
    return b;
}

static brunt_body_def *add_pin(brunt_world_def *def, const char *name, double x, double speed) {
    const int up = def->dimension - 1;
    double low[3] = {x - 0.2, -0.2, 0}, high[3] = {x + 0.2, 0.2, 0};
    low[up] = 0.05, high[up] = 0.45;
    brunt_body_def *b = add_mesh(def, name, low, high, 0.2);
    b->velocity[up] = -speed;
    return b;
}

// Its facets are of length 1, about the origin.
static brunt_body_def *add_plate(brunt_world_def *def, const char *name, double long_, double speed, bool membrane) {
    const int up = def->dimension - 1;
    double low[3] = {-1.5, -1.5, 0}, high[3] = {long_ - 1.5, 1.5, 0};
    low[up] = -1, high[up] = 0;
    brunt_body_def *b = add_mesh(def, name, low, high, 1);
    b->velocity[up] = speed;
    if (!membrane) return b;
    b->method = BRUNT_MEMBRANE, b->element = BRUNT_MEMBRANE_QUAD4, b->thickness = 0.02;
    b->faces = brunt_alloc(sizeof *b->faces), b->face_count = 1;
    snprintf(*b->faces, sizeof *b->faces, "zmax");
    return b;
}

static brunt_world_def begin(int dimension) {
    brunt_world_def def = def_begin(dimension, 1);
    brunt_free(def.bodies);
    def.bodies = brunt_alloc(20 * sizeof *def.bodies);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    return def;
}

static brunt_world_def def_pin(const pin *p) {
    brunt_world_def def = begin(p->dim);
    const char *of_pin = p->plate_first ? "q" : "p", *of_plate = p->plate_first ? "p" : "q";
    add_pin(&def, of_pin, 0, p->plate_moves ? 0 : SPEED);
    add_plate(&def, of_plate, 3, p->plate_moves ? SPEED : 0, p->membrane);
    add_sides(&def, p->pin_is_slave ? of_pin : of_plate, p->pin_is_slave ? of_plate : of_pin);
    return def;
}

static void free_def(brunt_world_def *def) { // pairs are of realloc
    free(def->contact.pairs);
    def->contact.pairs = NULL, def->contact.pair_count = 0;
    brunt_world_def_free(def);
}

static void conserves(brunt_world *world, const brunt_momentum *start, double mass) {
    const brunt_momentum now = world_momentum(world);
    for (int a = 0; a < 3; a++) {
        ck_assert_double_eq_tol(now.linear[a], start->linear[a], 100 * ROUNDING * mass * SPEED);
        ck_assert_double_eq_tol(now.angular[a], start->angular[a], 100 * ROUNDING * mass * SPEED);
    }
}

// How far the underside of the pin has come above where the middle of the plate would be if nothing had met it.
static double way_of(brunt_world *world, int of_pin, int of_plate) {
    const brunt_body_sums a = world_sums(world, of_pin), b = world_sums(world, of_plate);
    const int up = brunt_world_dimension(world) - 1;
    return a.velocity[up] - b.velocity[up];
}

START_TEST(only_nodes_of_the_slave_are_held_off) {
    const pin p = {.dim = _i & 1 ? 3 : 2,
                   .pin_is_slave = _i >> 1 & 1,
                   .plate_first = _i >> 2 & 1,
                   .plate_moves = _i >> 3 & 1,
                   .membrane = _i >= 16};
    if (p.membrane && p.dim == 2) return;
    brunt_world_def def = def_pin(&p);
    brunt_world *world = world_from(&def);
    const brunt_momentum start = world_momentum(world);
    world_until(world, 0.6);
    const int of_pin = p.plate_first, of_plate = !of_pin;
    const double apart = way_of(world, of_pin, of_plate), impulse = world_pair(world, 0).impulse[p.dim - 1];
    conserves(world, &start, world_sums(world, of_pin).mass);
    const brunt_energy e = world_energy(world);
    ck_assert_double_le(e.mechanical, (1 + 1e-6) * e.initial);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    if (p.pin_is_slave) {
        // where there are membranes nothing is given back
        ck_assert_msg(apart > (p.membrane ? 0.1 : 0.6) * SPEED, "case %d: they part by %g of %g m/s", _i, apart, SPEED);
        ck_assert_double_ne(impulse, 0);
    } else { // straight on
        ck_assert_double_eq_tol(apart, -SPEED, 10 * ROUNDING);
        ck_assert_double_eq(impulse, 0);
    }
    brunt_world_destroy(world);
    free_def(&def);
}
END_TEST

// Nodes of the master look at nothing, so that nothing is told of them.
START_TEST(the_master_does_not_look) {
    const pin p = {.dim = 3, .pin_is_slave = true};
    brunt_world_def def = def_pin(&p);
    brunt_world *world = world_from(&def);
    world_until(world, 0.11);
    ck_assert_double_gt(world_pair(world, 0).area, 0);
    const brunt_contact_surface *s = &world->contact.surface;
    bool told[2] = {false, false};
    for (int32_t n = 0; n < s->node_count; n++)
        told[s->body[n]] = told[s->body[n]] || s->output.gap[n] < INFINITY || s->output.state[n];
    ck_assert(told[0] && !told[1]);
    brunt_world_destroy(world);
    free_def(&def);
}
END_TEST

// Blocks of one mesh on each other: what one side carries is what both did, on the area that both had. Not every node
// pushes in every step.
START_TEST(area_and_force_are_those_of_both) {
    enum { STEPS = 200 };
    double area[3] = {0}, impulse[3];
    for (int slave = 0; slave < 3; slave++) {
        brunt_world_def def = begin(3);
        def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
        add_mesh(&def, "upper", XYZ(0, 0, 0), XYZ(1, 1, 1), 0.25);
        add_mesh(&def, "lower", XYZ(0, 0, -1), XYZ(1, 1, 0), 0.25);
        brunt_group_def *g = &def.groups[def.group_count++];
        *g = brunt_group_def_default();
        strcpy(g->body, "lower"), strcpy(g->group, "zmin");
        for (int a = 0; a < 3; a++) g->component[a] = true;
        def.gravity[2] = -5, def.gravity_ramp = 0.5;
        if (slave) add_sides(&def, slave == 1 ? "upper" : "lower", slave == 1 ? "lower" : "upper");
        brunt_world *world = world_from(&def);
        world_until(world, 1.5);
        impulse[slave] = world_pair(world, 0).impulse[2];
        for (int k = 0; k < STEPS; k++) {
            world_steps(world, 1);
            area[slave] += world_pair(world, 0).area / STEPS;
        }
        brunt_world_destroy(world);
        free_def(&def);
    }
    printf("area %.3f, %.3f, %.3f; impulse %.1f, %.1f, %.1f\n", area[0], area[1], area[2], impulse[0], impulse[1],
           impulse[2]);
    for (int slave = 0; slave < 3; slave++) {
        ck_assert(area[slave] > 0.65 && area[slave] < 1.05);
        ck_assert_double_eq_tol(impulse[slave], impulse[0], 0.01 * fabs(impulse[0]));
    }
}
END_TEST

// A cube that hits a slab askew, either of them the slave: momenta, energy and the ledger as with both; no node of the
// cube, which is all over the slab, is deep in it where it is held off.
static brunt_world_def def_askew(int slave, int threads) {
    brunt_world_def def = begin(3);
    add_mesh(&def, "cube", XYZ(-0.5, -0.5, -0.5), XYZ(0.5, 0.5, 0.5), 0.2);
    add_mesh(&def, "slab", XYZ(-1.5, -1.5, -0.75), XYZ(1.5, 1.5, 0), 0.25);
    for (int k = 0; k < 2; k++) def.bodies[k].hourglass_coefficient = 0.3;
    brunt_body_def *cube = &def.bodies[0];
    cube->place = brunt_placement_rotate(cube->place, XYZ(1, 2, 0), 20 * PI / 180, XYZ(0, 0, 0));
    cube->place = brunt_placement_translate(cube->place, XYZ(0.03, 0.05, 0.8));
    def_velocity(cube, 0.3, 0.1, -1);
    def.threads = threads, def.contact.friction = 0.2;
    if (slave) add_sides(&def, slave == 1 ? "cube" : "slab", slave == 1 ? "slab" : "cube");
    return def;
}

START_TEST(impact_conserves) {
    brunt_world_def def = def_askew(_i, 1);
    brunt_world *world = world_from(&def);
    const brunt_momentum start = world_momentum(world);
    const double mass = world_sums(world, 0).mass;
    double deepest = 0, most = 0;
    for (int k = 1; k <= 60; k++) {
        world_until(world, 0.01 * k);
        const brunt_contact_surface *s = &world->contact.surface;
        for (int32_t n = s->node_range[0]; n < s->node_range[1]; n++) deepest = fmax(deepest, -s->output.gap[n]);
        const brunt_energy e = world_energy(world);
        most = fmax(most, e.mechanical);
        ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    }
    const brunt_energy e = world_energy(world);
    conserves(world, &start, mass);
    ck_assert_double_gt(fabs(world_pair(world, 0).impulse[2]), mass);
    ck_assert_double_le(most, (1 + 1e-3) * e.initial);
    ck_assert_double_gt(e.contact, -1e-3 * e.initial);
    ck_assert_double_lt(e.contact, (_i == 2 ? 2e-2 : 1e-3) * e.initial); // few nodes of the slab are under the cube
    printf("slave %d: deepest %.5f edges, contact lost %.2e, made %.1e, ledger %.1e of the energy\n", _i, deepest / 0.2,
           e.contact / e.initial, most / e.initial - 1, e.error_relative);
    if (_i < 2) ck_assert_double_lt(deepest, 0.05 * 0.2);
    brunt_world_destroy(world);
    free_def(&def);
}
END_TEST

START_TEST(threads_and_restarts_keep_the_bits) {
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) { // the third goes on from the middle of the contact
        brunt_world_def def = def_askew(2, 1 + k % 2);
        brunt_world *world = world_from(&def);
        world_steps(world, 150);
        if (k == 2) {
            brunt_world *on = world_from(&def);
            world_copy_state(world, on);
            brunt_world_destroy(world);
            world = on;
        }
        world_steps(world, 150);
        ck_assert_double_ne(world_pair(world, 0).impulse[0], 0);
        hash[k] = brunt_world_hash(world);
        brunt_world_destroy(world);
        free_def(&def);
    }
    ck_assert_uint_eq(hash[1], hash[0]);
    ck_assert_uint_eq(hash[2], hash[0]);
}
END_TEST

// So many bodies that pairs which are alike share an account: which is the slave is not shared.
START_TEST(many_bodies_keep_their_sides) {
    enum { PINS = 12 };
    brunt_world_def def = begin(2);
    add_plate(&def, "m", PINS + 2, 0, false);
    for (int k = 0; k < PINS; k++) {
        char name[16];
        snprintf(name, sizeof name, "%c%d", k < PINS / 2 ? 'a' : 'z', k);
        add_pin(&def, name, k, SPEED);
        add_sides(&def, k % 2 ? "m" : name, k % 2 ? name : "m");
    }
    brunt_world *world = world_from(&def);
    ck_assert_int_eq(brunt_pair_count(world), 3); // either slave, and those of pins with each other
    world_until(world, 0.4);
    for (int b = 0; b < brunt_body_count(world); b++) {
        const char *name = brunt_body_name(world, b);
        if (name[0] == 'm') continue;
        const double speed = world_sums(world, b).velocity[1];
        if (atoi(name + 1) % 2)
            ck_assert_double_eq_tol(speed, -SPEED, 10 * ROUNDING);
        else
            ck_assert_msg(speed > -0.5 * SPEED, "%s falls on at %g m/s", name, speed);
    }
    brunt_world_destroy(world);
    free_def(&def);
}
END_TEST

static void refuses(brunt_world_def *def, const char *words) {
    brunt_error error;
    ck_assert_ptr_null(brunt_world_create(def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, words) != NULL, "%s", error.message);
}

START_TEST(what_has_no_facets_has_no_sides) {
    const pin p = {.dim = 3};
    brunt_world_def def = def_pin(&p);
    brunt_pair_def *pair = &def.contact.pairs[0];
    pair->sides = (brunt_contact_sides)2;
    refuses(&def, "sides");
    pair->sides = BRUNT_SIDES_SLAVE;
    def.contact.form = BRUNT_AUGURY_PUBLISHED;
    refuses(&def, "only two meshes");
    def.contact.form = BRUNT_AUGURY_NODE_TO_FACET;
    def.bodies[0].method = BRUNT_MPM;
    refuses(&def, "only two meshes");
    def.bodies[0].method = BRUNT_FEM;
    free_def(&def);
    const pin sheet = {.dim = 3, .membrane = true};
    def = def_pin(&sheet);
    memcpy(def.contact.pairs[0].a, def.contact.pairs[0].b, sizeof def.contact.pairs[0].a);
    refuses(&def, "is no membrane");
    strcpy(def.contact.pairs[0].a, "q"), strcpy(def.contact.pairs[0].b, "q");
    def.bodies[1].contact_thickness = 0.02;
    refuses(&def, "both sides");
    free_def(&def);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("contact sides");
    ADD_LOOP(only_nodes_of_the_slave_are_held_off, 32);
    ADD(the_master_does_not_look);
    ADD(area_and_force_are_those_of_both);
    ADD_LOOP(impact_conserves, 3);
    ADD(threads_and_restarts_keep_the_bits);
    ADD(many_bodies_keep_their_sides);
    ADD(what_has_no_facets_has_no_sides);
    return suite_main(suite);
}
