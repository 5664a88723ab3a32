// Labels: stability
// Meshes that swing after an impact: steps that followed their shape have pumped energy into them, until elements of a
// block whose material has no lateral strain turned inside out.
#include "tests/support/hard_world.h"

enum { QUAD4, TRI3, RINGS, HEX8, TET4 };

// A block of 4 x 2 (x 2) elements that a plane meets at a share of the wave speed, as a scene without material points
// computes it; the plane goes on, the block flies ahead of it.
static brunt_world_def struck_block(int kind, const char *model, double nu, double share) {
    static const brunt_element_kind element[] = {BRUNT_QUAD4, BRUNT_TRI3, BRUNT_QUAD4, BRUNT_HEX8, BRUNT_TET4};
    const int dim = kind >= HEX8 ? 3 : 2;
    brunt_world_def def = def_begin(dim, 0);
    const brunt_material_def *m = def_material(&def, model, 1000, 1e6, nu);
    const double E = m->strength_parameters[0], c = sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / m->density);
    def.cfl = 0.9;
    def.axisymmetric = kind == RINGS;
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), dim == 3 ? XYZ(0.4, 0.2, 0.2) : XYZ(0.4, 0.2, 0));
    b->method = BRUNT_FEM, b->element = element[kind], b->size = 0.1;
    brunt_plane_def *p = def_plane(&def, XYZ(0, 0, 0), dim == 3 ? XYZ(0, 0, 1) : XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    p->velocity[dim - 1] = share * c;
    return def;
}

// The greatest energy error of the second half of some 300 periods of the fastest swing.
static double swing_error(int kind, const char *model, double nu, double share) {
    brunt_world_def def = struck_block(kind, model, nu, share);
    brunt_world *world = world_take(&def);
    double worst = 0;
    for (int s = 0; s < 1000; s++) {
        world_steps(world, 1);
        if (s >= 500) worst = fmax(worst, fabs(world_energy(world).error_relative));
    }
    brunt_world_destroy(world);
    return worst;
}

// C18 (0.9 of the stable step).
START_TEST(swings_keep_their_energy) {
    static const char *const name[] = {"quad4", "tri3", "rings", "hex8", "tet4"};
    static const double nu[] = {0, 0.3, 0.49};
    for (int kind = QUAD4; kind <= TET4; kind++)
        for (int k = 0; k < 3; k++)
            for (int fast = 0; fast < 2; fast++) {
                const double error = swing_error(kind, "neo-hookean", nu[k], fast ? 0.1 : 0.06);
                printf("  %s, nu %g, %g c: energy error %.2g\n", name[kind], nu[k], fast ? 0.1 : 0.06, error);
                ck_assert_double_lt(error, 0.01);
            }
    ck_assert_double_lt(swing_error(QUAD4, "linear-elastic", 0, 0.06), 0.01);
}
END_TEST

// A change at the end of a stretch and one more in it, once the stiffest shape of the impact has been seen; before,
// every step was another.
START_TEST(steps_are_equal_while_it_swings) {
    brunt_world_def def = struck_block(QUAD4, "neo-hookean", 0, 0.06);
    brunt_world *world = world_take(&def);
    world_steps(world, 256);
    int changes = 0;
    double before = brunt_world_dt(world);
    for (int s = 0; s < 640; s++) {
        world_steps(world, 1);
        changes += brunt_world_dt(world) != before;
        before = brunt_world_dt(world);
    }
    printf("  %d changes of the step in 640\n", changes);
    ck_assert_int_le(changes, 10);
    brunt_world_destroy(world);
}
END_TEST

// What is held is part of the state.
START_TEST(restart) {
    brunt_world_def def = struck_block(QUAD4, "neo-hookean", 0, 0.1);
    brunt_world *world = world_from(&def), *again = world_take(&def);
    world_steps(world, 100);
    world_copy_state(world, again);
    for (int s = 0; s < 100; s++) {
        world_steps(world, 1), world_steps(again, 1);
        ck_assert(brunt_world_time(world) == brunt_world_time(again));
    }
    ck_assert(world_energy(world).kinetic == world_energy(again).kinetic);
    brunt_world_destroy(world), brunt_world_destroy(again);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("held step");
    ADD(swings_keep_their_energy);
    ADD(steps_are_equal_while_it_swings);
    ADD(restart);
    return suite_main(suite);
}
