// Labels: stability
// What the energy error is relative to: energy that comes and goes, or next to none, stops no run; energy out of
// nothing does at once. The two spheres have stopped with 207 % and -17 %.
#include "tests/support/hard_world.h"

enum { CHECK = 32 }; // steps from one look at the error to the next

// A closed membrane away from the origin; with gas at 101 bar in 100 bar when it is asked for, which makes it breathe.
static brunt_world_def bag(bool gas) {
    brunt_world_def def = def_begin(3, 0);
    def_material(&def, "neo-hookean", 1000, gas ? 1e9 : 1e6, 0.4);
    brunt_body_def *b = def_ball(&def, "bag", gas ? XYZ(0, 0, 0) : XYZ(0.1, 0.2, 0.3), 0.1);
    b->method = BRUNT_MEMBRANE, b->element = BRUNT_MEMBRANE_QUAD4, b->size = 0.02, b->thickness = gas ? 5e-3 : 1e-3;
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    if (!gas) return def;
    brunt_group_def *g = &def.groups[def.group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "bag"), snprintf(g->group, sizeof g->group, "surface");
    g->action = BRUNT_GROUP_GAS;
    g->gas = (brunt_gas_def){.gamma = 1.4, .pressure = 101e5, .outside = 100e5};
    def.cfl = 0.9;
    return def;
}

START_TEST(at_rest) {
    brunt_world_def def = bag(false);
    def.energy_limit = 0.1;
    brunt_world *world = world_take(&def);
    world_steps(world, 20 * CHECK);
    const brunt_energy e = world_energy(world);
    printf("  at rest: %.2g J, error %.2g of %.2g J\n", e.kinetic + e.internal, e.error_relative, e.reference);
    ck_assert_double_lt(fabs(e.error_relative), 1e-2);
    brunt_world_destroy(world);
}
END_TEST

// Gas and sheet turn round again and again where they have next to no energy.
START_TEST(comes_and_goes) {
    brunt_world_def def = bag(true);
    def.energy_limit = 0.02;
    brunt_world *world = world_take(&def);
    double least = INFINITY, most = 0;
    for (int k = 0; k < 4000; k++) {
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        most = fmax(most, e.external_work);
        if (k > 100) least = fmin(least, e.external_work);
        ck_assert_double_ge(e.reference, most * (1 - 1e-12));
    }
    printf("  comes and goes: %.3g to %.3g J\n", least, most);
    ck_assert_double_lt(least, 0.05 * most);
    brunt_world_destroy(world);
}
END_TEST

// A world that goes on from a state remembers what it is relative to.
START_TEST(restart) {
    brunt_world_def def = bag(true);
    brunt_world *world = world_from(&def), *again = world_take(&def);
    double most = 0;
    world_steps(world, 10);
    while (world_energy(world).external_work > 0.1 * most) {
        most = fmax(most, world_energy(world).external_work);
        world_steps(world, 1);
    }
    world_copy_state(world, again);
    for (int k = 0; k < 3; k++) {
        const brunt_energy a = world_energy(world), b = world_energy(again);
        ck_assert_msg(a.reference == b.reference && a.error_relative == b.error_relative, "%.17g, %.17g", a.reference,
                      b.reference);
        ck_assert_double_ge(b.reference, most * (1 - 1e-12));
        world_steps(world, 1), world_steps(again, 1);
    }
    brunt_world_destroy(world);
    brunt_world_destroy(again);
}
END_TEST

// Velocities of a body times a factor, by no work.
static void hasten(brunt_world *world, const char *block_name, real factor) {
    brunt_error error = {0};
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        const brunt_state_block block = brunt_state_info(world, b);
        if (strcmp(block.name, block_name)) continue;
        const bool nodes = strstr(block_name, "/nodes") != NULL;
        real *x = malloc((size_t)block.count * sizeof *x);
        brunt_state_get(world, b, x);
        for (int64_t i = 0; i < block.count; i++)
            if (!nodes || (i % 8 >= 4 && i % 8 < 7)) x[i] *= factor;
        ck_assert_int_eq(brunt_state_set(world, b, x, block.count, &error), BRUNT_OK);
        free(x);
    }
}

// Two boxes that fly, of elements and of points; their energy doubles.
START_TEST(out_of_nothing) {
    for (int points = 0; points < 2; points++) {
        brunt_world_def def = def_begin(2, 0.05);
        def.energy_limit = 0.1;
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        brunt_body_def *b = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.2, 0.2, 0));
        if (!points) b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.05;
        def_velocity(b, 3, 1, 0);
        brunt_world *world = world_take(&def);
        brunt_error error = {0};
        world_steps(world, 2 * CHECK);
        hasten(world, points ? "bodies/box/velocity" : "bodies/box/nodes", (real)1.4142);
        int steps = 0, status = BRUNT_OK;
        for (; steps < CHECK && !status; steps++) status = brunt_world_step(world, INFINITY, &error);
        printf("  out of nothing: %s\n", error.message);
        ck_assert_int_eq(status, BRUNT_FAILED);
        ck_assert_ptr_nonnull(strstr(error.message, "the energy error is"));
        ck_assert_int_eq(strstr(error.message, "the transfers have made") != NULL, points); // only where there are any
        brunt_world_destroy(world);
    }
}
END_TEST

// A run that ends with fewer steps than that behind the last look is looked at as it ends.
START_TEST(at_the_end) {
    brunt_world_def def = def_begin(2, 0);
    def.energy_limit = 0.1, def.step = 1e-4, def.end = 10.5 * def.step;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *b = def_box(&def, "box", XYZ(0, 0, 0), XYZ(0.2, 0.2, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.05;
    def_velocity(b, 3, 1, 0);
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    world_steps(world, 5);
    hasten(world, "bodies/box/nodes", (real)1.4142);
    world_steps(world, 5);
    ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
    ck_assert_ptr_nonnull(strstr(error.message, "the energy error is"));
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("energy_limit");
    ADD(at_rest);
    ADD(comes_and_goes);
    ADD(restart);
    ADD(out_of_nothing);
    ADD(at_the_end);
    return suite_main(suite);
}
