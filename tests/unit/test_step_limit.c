// Which body and which of its elements decide how long steps are, and how long they were without them.
#include "tests/support/def_world.h"

static brunt_body_def *add_block(brunt_world_def *def, const char *name, double x, double size) {
    brunt_body_def *b = def_box(def, name, XYZ(x, 0, 0), XYZ(x + 0.4, 0.4, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    return b;
}

static const double CFL = 0.8;

static brunt_step_limit limit_of(brunt_world_def *def, double *dt) {
    def->cfl = CFL, def->contact.method = BRUNT_CONTACT_AUGURY;
    brunt_world *world = world_take(def);
    brunt_step_limit limit;
    brunt_error error;
    ck_assert_int_eq(brunt_world_step_limit(world, &limit, &error), BRUNT_OK);
    *dt = brunt_world_dt(world);
    brunt_world_destroy(world);
    return limit;
}

#define SAME(a, b) ck_assert_double_lt(fabs((a) / (b)-1), 100 * ROUNDING)

// The finer of three blocks, wherever it stands among them; steps are those that the world takes, and those of worlds
// without it. One body has none to be left out.
START_TEST(the_body) {
    static const double size[] = {0.1, 0.05, 0.025};
    double dt, alone[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = def_begin(2, 0);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        add_block(&def, "only", 0, size[k]);
        const brunt_step_limit limit = limit_of(&def, &alone[k]);
        ck_assert(limit.body == 0 && isinf(limit.without_body));
        SAME(limit.step * CFL, alone[k]);
        SAME(limit.element_step, limit.step);
    }
    for (int turn = 0; turn < 3; turn++) {
        brunt_world_def def = def_begin(2, 0);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        for (int k = 0; k < 3; k++) add_block(&def, k == 0 ? "a" : k == 1 ? "b" : "c", k, size[(k + turn) % 3]);
        const brunt_step_limit limit = limit_of(&def, &dt);
        ck_assert_int_eq(limit.body, 2 - turn);
        SAME(dt, alone[2]);
        SAME(limit.step * CFL, alone[2]);
        SAME(limit.without_body * CFL, alone[1]);
    }
}
END_TEST

// A mesh of 15 x 15 squares, of which the one of id 100 has a material point less far to its neighbour: its number,
// what it allows, and what the rest does without one element in a hundred.
START_TEST(the_element) {
    enum { N = 15, SHORT = 100 };
    double dt;
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "linear-elastic", 1000, 1e6, 0);
    brunt_body_def *b = def_body(&def, "net");
    b->method = BRUNT_FEM;
    brunt_mesh *mesh = &b->mesh;
    *mesh = (brunt_mesh){.kind = BRUNT_QUAD4, .node_count = 4 * N * N, .element_count = N * N};
    mesh->nodes = brunt_alloc(4 * N * N * sizeof *mesh->nodes);
    mesh->elements = brunt_alloc(4 * N * N * sizeof *mesh->elements);
    for (int e = 0; e < N * N; e++) // apart from each other
        for (int c = 0; c < 4; c++) {
            const double width = e == SHORT ? 0.25 : e < 2 ? 0.5 : 1;
            mesh->nodes[4 * e + c][0] = 2 * (e % N) + width * (c == 1 || c == 2);
            mesh->nodes[4 * e + c][1] = 2 * (e / N) + width * (c > 1);
            mesh->elements[4 * e + c] = 4 * e + c;
        }
    const brunt_step_limit limit = limit_of(&def, &dt);
    ck_assert_int_eq(limit.element, SHORT);
    ck_assert_int_eq(limit.few, 3); // of 225
    SAME(limit.without_few, 4 * limit.element_step);
}
END_TEST

// Material points: a cell over the speed of waves and points, and of planes.
START_TEST(points) {
    double dt;
    for (int moves = 0; moves < 2; moves++) {
        brunt_world_def def = def_begin(2, 0.1);
        const brunt_material_def *m = def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        const double E = m->strength_parameters[0], c = sqrt(E * 0.7 / (1.3 * 0.4) / 1000);
        def_velocity(def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.4, 0)), 7, 0, 0);
        def_plane(&def, XYZ(0, -1, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0)->velocity[1] = moves ? -20 : 0;
        const brunt_step_limit limit = limit_of(&def, &dt);
        ck_assert(limit.body == 0 && limit.element < 0 && isinf(limit.without_body));
        ck_assert_double_lt(fabs(limit.step * (c + (moves ? 20 : 7)) / 0.1 - 1), 1e-6);
        SAME(limit.step * CFL, dt);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("step limit");
    ADD_LOOP(the_body, 1);
    ADD_LOOP(the_element, 1);
    ADD_LOOP(points, 1);
    return suite_main(suite);
}
