// Bytes and flops of the passes as counted: against the arrays there are, against instructions counted by valgrind, and
// by what they depend on.
#include "tests/support/def_world.h"
#include "world/world.h"

enum { STEPS = 4 };

typedef struct body_of {
    int dimension;
    brunt_kernel kernel;
    brunt_transfer transfer;
    const char *model;
    bool total, rings, gravity;
    double speed; // [m/s] along each axis
    double apic;  // share that it keeps
} body_of;

// A box of whole cells: 12^3 with 8 particles each, or 32^2 with 4.
static brunt_world *points_of(body_of b) {
    brunt_world_def def = def_begin(b.dimension, 1e-3);
    def.kernel = b.kernel, def.transfer = b.transfer, def.apic = b.apic, def.axisymmetric = b.rings;
    brunt_material_def *material = def_material(&def, b.model ? b.model : "neo-hookean", 8000, 1e11, 0.3);
    if (b.model && strcmp(b.model, "von-mises") == 0) material->strength_parameters[2] = 1e9;
    const double side = b.dimension == 3 ? 12e-3 : 32e-3, from = b.rings ? side : 0;
    brunt_body_def *body = def_box(&def, "block", XYZ(from, 0, 0), XYZ(from + side, side, side));
    body->total_lagrangian = b.total;
    def_velocity(body, b.rings ? 0 : b.speed, b.speed, b.speed);
    if (b.gravity) def.gravity[1] = -10;
    brunt_world *world = world_take(&def);
    world_steps(world, STEPS);
    return world;
}

static const body_of usual = {3, BRUNT_QUADRATIC, BRUNT_APIC, NULL, false, false, false, 3, 0};

static brunt_world *mesh_of(int dimension, brunt_element_kind element, brunt_hourglass hourglass, bool rings) {
    brunt_world_def def = def_begin(dimension, 1e-3);
    def.axisymmetric = rings;
    def_material(&def, "neo-hookean", 8000, 1e11, 0.3);
    const double side = dimension == 3 ? 8e-3 : 24e-3, from = rings ? side : 0;
    brunt_body_def *body = def_box(&def, "block", XYZ(from, 0, 0), XYZ(from + side, side, side));
    body->method = BRUNT_FEM, body->element = element, body->hourglass = hourglass, body->size = 1e-3;
    brunt_world *world = world_take(&def);
    world_steps(world, STEPS);
    return world;
}

static brunt_pass pass_of(const brunt_world *world, const char *name) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        if (strcmp(brunt_world_pass(world, p).name, name) == 0) return brunt_world_pass(world, p);
    ck_abort_msg("there is no pass %s", name);
    return (brunt_pass){.name = ""};
}

static brunt_pass once(body_of b, const char *name) {
    brunt_world *world = points_of(b);
    brunt_pass pass = pass_of(world, name);
    brunt_world_destroy(world);
    return pass;
}

// Components of the array of the only body that is called so; 0: there is none.
static int components(const brunt_world *world, const char *field) {
    char name[128];
    snprintf(name, sizeof name, "block.%s", field);
    for (int32_t a = 0; a < brunt_array_count(world); a++)
        if (strcmp(brunt_world_array(world, a).name, name) == 0) return brunt_world_array(world, a).components;
    return 0;
}

static bool about(double a, double b, double tolerance) { return fabs(a - b) <= tolerance * fabs(b); }

// ---------------------------------------------------------------------------------------------------- bytes

// Each array that the scatter reads, once, and what it gives to the blocks' buffers; by the gather what it writes
// twice.
START_TEST(bytes_are_those_of_the_arrays) {
    for (int transfer = BRUNT_PIC; transfer <= BRUNT_APIC; transfer++) {
        body_of b = usual;
        b.transfer = (brunt_transfer)transfer, b.model = "von-mises";
        brunt_world *world = points_of(b);
        const brunt_grid *grid = &world->bodies.mpm[0].grid;
        const double particles = (double)brunt_world_particles(world), node = 8 * sizeof(real);
        double read_once = 0, updated = 0, state = 0;
        static const char *const moving[] = {"position", "velocity", "affine", "kirchhoff_stress"};
        for (int f = 0; f < 4; f++) updated += components(world, moving[f]);
        read_once = updated + components(world, "mass") + components(world, "reference_volume");
        updated += components(world, "deformation_gradient");
        for (int32_t a = 0; a < brunt_array_count(world); a++) state += brunt_world_array(world, a).components;
        state -= updated + 2 + 2; // mass and volume; ids and grid
        ck_assert_double_gt(state, 0);
        const double buffers = 2.0 * grid->block_count * grid->span_nodes * node / particles;
        const double nodes = (double)grid->slot_count * BRUNT_BLOCK_NODES * node / particles;
        brunt_pass scatter = pass_of(world, "p2g"), gather = pass_of(world, "g2p");
        ck_assert_double_eq_tol(scatter.bytes_per_unit, read_once * sizeof(real) + 1 + buffers, 1e-9);
        ck_assert_double_eq_tol(gather.bytes_per_unit, (2 * updated + 2 * state + 2) * sizeof(real) + nodes, 1e-9);
        ck_assert_double_eq(pass_of(world, "ledger").bytes_per_unit, node);
        ck_assert_double_eq(pass_of(world, "update").bytes_per_unit, 2 * node);
        brunt_world_destroy(world);
    }
}
END_TEST

// Of a mesh: elements' fields, and of its nodes a record and the place at the start; partial forces by block.
START_TEST(bytes_of_elements_are_those_of_the_arrays) {
    for (int hourglass = 0; hourglass < 2; hourglass++) {
        brunt_world *world = mesh_of(3, BRUNT_HEX8, (brunt_hourglass)hourglass, false);
        const brunt_fem_body *body = &world->bodies.fem[0];
        const double updated = components(world, "deformation_gradient") + components(world, "kirchhoff_stress") +
                               components(world, "hourglass_rate");
        ck_assert_double_eq(updated, hourglass ? 27 : 15);
        const double fields = (2 * updated + 1) * sizeof(real), local = 8 * sizeof(uint16_t);
        const double nodes = 12.0 * sizeof(real) * body->node_count / body->element_count;
        const double partial = (8.0 * sizeof(real) + 4) * body->partial_count / body->element_count;
        ck_assert_double_eq_tol(pass_of(world, "elements").bytes_per_unit, fields + local + nodes + partial, 1e-9);
        ck_assert_double_eq(pass_of(world, "drift").bytes_per_unit, 16 * sizeof(real));
        brunt_world_destroy(world);
    }
}
END_TEST

// Particles that stay in their bins are looked at; the arrays move with those that do not.
START_TEST(sort_moves_what_changes_its_bin) {
    body_of still = usual, fast = usual;
    still.total = true, still.speed = 0, fast.speed = 3000;
    brunt_pass pass[2];
    for (int k = 0; k < 2; k++) {
        brunt_world *world = points_of(k ? fast : still);
        const brunt_particles *p = &world->bodies.mpm[0].particles;
        world_steps(world, 30);
        pass[k] = pass_of(world, "sort");
        if (k) ck_assert_int_gt(p->moved + p->moves * p->count, 5 * p->count);
        if (!k) ck_assert_int_eq(p->moves, 1); // the first finds all
        if (!k) ck_assert_int_eq(p->moved, 0);
        ck_assert_int_ge(p->sorts, STEPS + 30);
        const double sorts = (double)p->sorts, all = (double)p->moves / sorts,
                     some = (double)p->moved / (sorts * (double)p->count),
                     array = (double)p->scalar_count * sizeof(real);
        const double look = 3 * sizeof(real) + 3 * 8;
        ck_assert_double_gt(pass[k].bytes_per_unit, look + (3 * all + 2 * some) * array);
        ck_assert_double_lt(pass[k].bytes_per_unit, look + (3 * all + 2 * some) * array + 250 * (all + some));
        brunt_world_destroy(world);
    }
    ck_assert_double_gt(pass[1].bytes_per_unit, 2 * pass[0].bytes_per_unit);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- flops

// Floating-point instructions of the kernels with one lane, times their lanes, as valgrind counts them (callgrind,
// --dump-instr, with the weights of the disassembly; gcc 12 -O2 -march=x86-64-v3), for these very worlds. Compilers
// share subexpressions as they like: 5 %, and 10 % in the gather of two dimensions.
START_TEST(flops_are_those_that_run) {
    const struct {
        body_of body;
        double scatter, gather;
    } points[] = {
        {{3, BRUNT_QUADRATIC, BRUNT_APIC, NULL, false, false, false, 3, 0}, 1320.4, 732.4},
        {{3, BRUNT_QUADRATIC, BRUNT_FLIP, NULL, false, false, false, 3, 0}, 1227.4, 872.4},
        {{3, BRUNT_QUADRATIC, BRUNT_PIC, NULL, false, false, false, 3, 0}, 1227.4, 591.4},
        {{3, BRUNT_CUBIC, BRUNT_PIC, NULL, false, false, false, 3, 0}, 2624.0, 1246.9},
        {{3, BRUNT_QUADRATIC, BRUNT_APIC, NULL, true, false, false, 0, 0}, 1416.4, 861.4},
        {{2, BRUNT_QUADRATIC, BRUNT_APIC, NULL, false, false, false, 3, 0}, 413.2, 220.2},
        {{2, BRUNT_CUBIC, BRUNT_FLIP, NULL, false, false, false, 3, 0}, 645.0, 460.8},
        {{2, BRUNT_QUADRATIC, BRUNT_APIC, NULL, false, true, false, 3, 0}, 421.2, 230.6},
    };
    for (size_t k = 0; k < sizeof points / sizeof *points; k++) {
        const body_of *b = &points[k].body;
        const double model = brunt_find_strength("neo-hookean")->flops[b->dimension == 3 || b->rings];
        brunt_world *world = points_of(*b);
        const double scatter = pass_of(world, "p2g").flops_per_unit;
        const double gather = pass_of(world, "g2p").flops_per_unit - model;
        printf("  %dD order %d transfer %d: p2g %.0f of %.0f, g2p %.0f of %.0f\n", b->dimension, (int)b->kernel,
               (int)b->transfer, scatter, points[k].scatter, gather, points[k].gather);
        ck_assert(about(scatter, points[k].scatter, 0.05));
        ck_assert(about(gather, points[k].gather, b->dimension == 3 ? 0.05 : 0.1));
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(flops_of_elements_are_those_that_run) {
    const struct {
        int dimension;
        brunt_element_kind kind;
        brunt_hourglass hourglass;
        bool rings;
        double flops, kick, drift; // of an element
    } meshes[] = {
        {3, BRUNT_HEX8, BRUNT_HOURGLASS_STIFFNESS, false, 1283.8, 37.72, 96.83},
        {3, BRUNT_HEX8, BRUNT_HOURGLASS_VISCOUS, false, 1593.8, 37.72, 96.83},
        {3, BRUNT_TET4, BRUNT_HOURGLASS_STIFFNESS, false, 545.9, 7.2, 16.1},
        {2, BRUNT_QUAD4, BRUNT_HOURGLASS_STIFFNESS, false, 274.6, 27.9, 73.8},
        {2, BRUNT_QUAD4, BRUNT_HOURGLASS_VISCOUS, false, 323.6, 27.9, 73.8},
        {2, BRUNT_TRI3, BRUNT_HOURGLASS_STIFFNESS, false, 180.7, 14.5, 36.9},
        {2, BRUNT_TRI3, BRUNT_HOURGLASS_STIFFNESS, true, 318.6, 14.5, 36.9},
        {2, BRUNT_QUAD4, BRUNT_HOURGLASS_STIFFNESS, true, 539.5, 27.9, 73.8},
        {2, BRUNT_QUAD4, BRUNT_HOURGLASS_VISCOUS, true, 594.5, 27.9, 73.8},
    };
    for (size_t k = 0; k < sizeof meshes / sizeof *meshes; k++) {
        brunt_world *world = mesh_of(meshes[k].dimension, meshes[k].kind, meshes[k].hourglass, meshes[k].rings);
        const double model = brunt_find_strength("neo-hookean")->flops[meshes[k].dimension == 3 || meshes[k].rings];
        const double nodes = (double)brunt_world_nodes(world) / (double)brunt_world_elements(world);
        const double flops = pass_of(world, "elements").flops_per_unit - model;
        printf("  %s%s, form %d: %.0f of %.0f\n", brunt_element_name(meshes[k].kind), meshes[k].rings ? ", rings" : "",
               (int)meshes[k].hourglass, flops, meshes[k].flops);
        ck_assert(about(flops, meshes[k].flops, 0.05));
        ck_assert(about(nodes * pass_of(world, "kick").flops_per_unit, meshes[k].kick, 0.01));
        ck_assert(about(nodes * pass_of(world, "drift").flops_per_unit, meshes[k].drift, 0.01));
        brunt_world_destroy(world);
    }
}
END_TEST

START_TEST(work_follows_what_it_is_of) {
    body_of plane = usual, cubic = usual, linear = usual, pic = usual, flip = usual, total = usual, heavy = usual,
            metal = usual, keeping = usual;
    plane.dimension = 2, cubic.kernel = BRUNT_CUBIC, linear.kernel = BRUNT_LINEAR, pic.transfer = BRUNT_PIC;
    flip.transfer = BRUNT_FLIP, total.total = true, heavy.gravity = true, keeping.apic = 0.9, metal.model = "von-mises";
    static const char *const passes[] = {"p2g", "g2p"};
    for (int p = 0; p < 2; p++) {
        const brunt_pass of = once(usual, passes[p]);
        const body_of *less[] = {&plane, &linear, &pic}, *more[] = {&cubic, &total};
        ck_assert_double_gt(of.bytes_per_unit, 0);
        for (int k = 0; k < 3; k++) ck_assert_double_lt(once(*less[k], passes[p]).flops_per_unit, of.flops_per_unit);
        for (int k = 0; k < 2; k++) ck_assert_double_gt(once(*more[k], passes[p]).flops_per_unit, of.flops_per_unit);
    }
    ck_assert_double_gt(once(flip, "g2p").flops_per_unit, once(pic, "g2p").flops_per_unit);
    ck_assert_double_gt(once(keeping, "g2p").flops_per_unit, once(usual, "g2p").flops_per_unit);
    ck_assert_double_eq(once(keeping, "p2g").flops_per_unit, once(usual, "p2g").flops_per_unit);
    ck_assert_double_gt(once(heavy, "ledger").flops_per_unit, once(usual, "ledger").flops_per_unit);
    ck_assert_double_gt(once(heavy, "grid").flops_per_unit, once(usual, "grid").flops_per_unit);
    const double models =
        brunt_find_strength("von-mises")->flops[1] - (double)brunt_find_strength("neo-hookean")->flops[1];
    ck_assert_double_gt(models, 0);
    ck_assert_double_eq_tol(once(metal, "g2p").flops_per_unit - once(usual, "g2p").flops_per_unit, models, 1e-9);
    // The linear kernel's second way to the grid has all of a scatter in it.
    ck_assert_double_gt(once(linear, "musl_velocity").flops_per_unit, once(linear, "p2g").flops_per_unit);
    ck_assert_double_gt(once(linear, "musl_velocity").bytes_per_unit, once(linear, "p2g").bytes_per_unit);
}
END_TEST

static void check_model(const brunt_model *model) {
    ck_assert_msg(model->flops[1] >= model->flops[0] && model->flops[0] >= 0, "%s", model->name);
    ck_assert_msg((model->flops[0] > 0) == (model->flops[1] > 0), "%s", model->name);
    ck_assert_msg(model->flops[2] == 0 || model->update_plane_stress, "%s", model->name);
    if (!model->flops[0]) printf("  %s is not counted\n", model->name);
}

START_TEST(models_are_counted) {
    for (int m = 0; m < brunt_strength_model_count; m++) check_model(brunt_strength_models[m]);
    for (int m = 0; m < brunt_eos_model_count; m++) check_model(brunt_eos_models[m]);
    ck_assert_int_gt(brunt_bulk_viscosity.flops[0], 0);
    ck_assert_int_gt(brunt_find_eos("tait")->flops[0], 0);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- units

START_TEST(units_are_those_gone_over) {
    brunt_world *world = points_of(usual);
    static const char *const of_particles[] = {"sort", "p2g", "g2p"}, *const of_nodes[] = {"grid", "update", "ledger"};
    for (int k = 0; k < 3; k++) {
        const brunt_pass points = pass_of(world, of_particles[k]), nodes = pass_of(world, of_nodes[k]);
        ck_assert_str_eq(points.unit, "particle");
        ck_assert_double_eq(points.units, STEPS * (double)brunt_world_particles(world));
        ck_assert_str_eq(nodes.unit, "node");
        ck_assert_double_gt(nodes.units, STEPS * 13.0 * 13 * 13);
    }
    brunt_world_destroy(world);
}
END_TEST

// What contact and planes cost depends on what meets what.
START_TEST(what_is_not_fixed_is_not_counted) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0));
    def_box(&def, "other", XYZ(2, 0, 0), XYZ(3, 1, 0));
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
    def_plane(&def, XYZ(0, -0.01, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, STEPS);
    static const char *const passes[] = {"contact", "boundaries"};
    for (int k = 0; k < 2; k++) {
        const brunt_pass pass = pass_of(world, passes[k]);
        ck_assert_double_eq(pass.bytes_per_unit, 0);
        ck_assert_double_eq(pass.flops_per_unit, 0);
    }
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("work");
    TCase *tests = tcase_create("work");
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, bytes_are_those_of_the_arrays);
    tcase_add_test(tests, bytes_of_elements_are_those_of_the_arrays);
    tcase_add_test(tests, sort_moves_what_changes_its_bin);
    tcase_add_test(tests, flops_are_those_that_run);
    tcase_add_test(tests, flops_of_elements_are_those_that_run);
    tcase_add_test(tests, work_follows_what_it_is_of);
    tcase_add_test(tests, models_are_counted);
    tcase_add_test(tests, units_are_those_gone_over);
    tcase_add_test(tests, what_is_not_fixed_is_not_counted);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
