// What a new world takes up goes on to the bit, of bodies whose elements may leave: they are looked at anew, without a
// step.
#include "tests/support/def_world.h"

#include "geometry/element_traits.h"
#include "world/world.h"

static const struct kind {
    brunt_element_kind kind;
    int dimension;
    bool rings;
} kinds[] = {{BRUNT_TRI3, 2, false},          {BRUNT_QUAD4, 2, false},         {BRUNT_TRI3, 2, true},
             {BRUNT_QUAD4, 2, true},          {BRUNT_TET4, 3, false},          {BRUNT_HEX8, 3, false},
             {BRUNT_MEMBRANE_TRI3, 3, false}, {BRUNT_MEMBRANE_QUAD4, 3, false}};
enum { KINDS = sizeof kinds / sizeof *kinds };

// A ball or disk, whose elements are none of them cubes, or the upper face of a block, that turns, flies and swings.
static brunt_world *thrown(const struct kind *k, brunt_hourglass hourglass) {
    const bool sheet = brunt_element_traits_of(k->kind)->membrane;
    brunt_world_def def = def_begin(k->dimension, 0);
    def.axisymmetric = k->rings;
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    brunt_body_def *b = sheet ? def_box(&def, "sheet", XYZ(1.013, 2.007, 3.011), XYZ(2.034, 3.019, 3.05))
                              : def_ball(&def, "ball", XYZ(1.513, 2.507, 3.511), 0.5);
    b->method = sheet ? BRUNT_MEMBRANE : BRUNT_FEM, b->element = k->kind, b->size = k->dimension == 2 ? 0.06 : 0.13;
    b->hourglass = hourglass;
    if (sheet) {
        b->thickness = 0.01, b->face_count = 1, b->faces = brunt_alloc(sizeof *b->faces);
        snprintf(b->faces[0], sizeof b->faces[0], "zmax");
    }
    def_velocity(b, k->rings ? 0 : 3, -2, k->dimension == 3 ? 1 : 0);
    if (!k->rings) b->spin[2] = 5;
    if (k->dimension == 3) b->spin[0] = -3;
    for (int a = 0; a < k->dimension; a++) b->wave_velocity[a] = 2 - 0.7 * a, b->wave_vector[a] = a == 1 ? -7 : 5;
    b->erosion.inverted = true;
    return world_take(&def);
}

START_TEST(what_may_erode_goes_on_to_the_bit) {
    const struct kind *k = &kinds[_i / 2];
    const brunt_hourglass hourglass = _i % 2 ? BRUNT_HOURGLASS_VISCOUS : BRUNT_HOURGLASS_STIFFNESS;
    if (_i % 2 && brunt_element_traits_of(k->kind)->membrane) return; // those have springs alone
    brunt_world *one = thrown(k, hourglass), *other = thrown(k, hourglass);
    for (int s = 0; s < 10; s++) {
        world_steps(one, 3);
        world_copy_state(one, other);
        world_steps(one, 1), world_steps(other, 1);
        ck_assert_msg(brunt_world_hash(one) == brunt_world_hash(other), "other bits after %d restarts", s + 1);
    }
    brunt_world_destroy(one);
    brunt_world_destroy(other);
}
END_TEST

// A block of elements may be left without any: it has no stable step of its own.
START_TEST(empty_blocks_do_not_stop_a_restart) {
    brunt_world_def def = def_begin(3, 0);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 1));
    b->method = BRUNT_FEM, b->element = BRUNT_TET4, b->size = 0.15;
    b->wave_velocity[0] = 3, b->wave_vector[1] = 5;
    b->erosion.inverted = true;
    brunt_world *one = world_from(&def), *other = world_take(&def);
    brunt_fem_body *fem = &one->bodies.fem[0];
    ck_assert_int_gt(fem->block_count, 2);
    world_steps(one, 2);
    for (int32_t s = 0; s < fem->block[0].count; s++) fem->mark[s] = BRUNT_MARK_FAILED, fem->report[0].marked++;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_erode_marked(one, brunt_world_dt(one), &error), BRUNT_OK);
    ck_assert_int_eq(fem->block[0].count, 0);
    world_copy_state(one, other);
    for (int s = 0; s < 5; s++) {
        world_steps(one, 1), world_steps(other, 1);
        ck_assert(brunt_world_hash(one) == brunt_world_hash(other));
        ck_assert_double_eq(brunt_world_dt(one), brunt_world_dt(other));
    }
    brunt_world_destroy(one);
    brunt_world_destroy(other);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("restarts");
    ADD_LOOP(what_may_erode_goes_on_to_the_bit, 2 * KINDS);
    ADD_LOOP(empty_blocks_do_not_stop_a_restart, 1);
    return suite_main(suite);
}
