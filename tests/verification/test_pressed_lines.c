// Lines that press on explicit material points, or are pressed on: no push gives energy beside the work of the line.
#include <math.h>

#include "tests/support/hard_world.h"
#include "tests/support/surface_world.h"

// A closed triangle: its tip and two corners beside each other, `side` of the tip (1: above it), for what is around it.
static brunt_boundary_surface_def *def_wedge(brunt_world_def *def, double tip, double half, double height, int side) {
    brunt_boundary_surface_def *s = def_polyline(def, 3, true, BRUNT_SEPARATE);
    s->point[0][1] = tip;
    for (int k = 1; k < 3; k++) s->point[k][0] = (k == 1 ? -1 : 1) * side * half, s->point[k][1] = tip + side * height;
    return s;
}

// What is pressed onto a line, a tip or the flank beside it, and lies behind it by a tenth of its extent, stays where
// it is: one point under gravity has no other energy than what the line would give it.
START_TEST(pressed_point_stays) {
    static const double rise[] = {0, -1, -3}; // of the line beside x = 0
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    const double slope = rise[_i], lean = _i == 2 ? slope : 0, foot = _i == 2 ? 0.05 : 0, away = 0.045 / hypot(1, lean),
                 pull = 10 * hypot(1, lean);
    def_point(&def, "point", XYZ(foot - away * lean, foot * lean + away, 0), 0.1, XYZ(0, 0, 0));
    if (_i == 0)
        def_line(&def, -2, 0, 3, 0, BRUNT_SEPARATE);
    else
        def_wedge(&def, 0, 1, -slope, -1);
    def.gravity[0] = 10 * lean, def.gravity[1] = -10; // onto it
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double pressed = hypot(f.impulse[0], f.impulse[1]) / (after.mass * pull * 0.1);
    printf("  pressed by %.12f of its weight, went %+.1e %+.1e m, energy %.1e J, contact took %+.1e J\n", pressed,
           after.centre[0] - before.centre[0], after.centre[1] - before.centre[1], world_energy(world).kinetic,
           f.normal_work);
    ck_assert_double_eq_tol(pressed, 1, 0.01); // half of the first kick of gravity is not there
    for (int a = 0; a < 2; a++) ck_assert_double_eq_tol(after.centre[a], before.centre[a], ROUNDING);
    ck_assert_double_le(world_energy(world).kinetic, ROUNDING);
    ck_assert_double_ge(world_energy(world).contact, -ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A wedge goes into a block, whose points turn and flow past it.
START_TEST(wedge_gives_no_more_than_its_work) {
    brunt_world_def def = def_begin(2, 0.5e-3);
    def_material(&def, "neo-hookean", 1100, 1e6, 0.4);
    def.surfaces = brunt_alloc(DEF_CAPACITY * sizeof *def.surfaces);
    def_box(&def, "block", XYZ(-0.03, -0.02, 0), XYZ(0.03, 0, 0));
    brunt_boundary_surface_def *s = def_wedge(&def, 0, 0.02, 0.04, 1);
    s->value[1] = -3, s->friction = 0.2;
    brunt_world *world = world_take(&def);
    world_until(world, 1.5e-3);
    const brunt_energy e = world_energy(world);
    printf("  of its work of %.4f J: contact %+.4f, friction %+.4f, transfer %+.4f, error %.1e\n", e.external_work,
           e.contact / e.external_work, e.friction / e.external_work, e.transfer / e.external_work, e.error_relative);
    ck_assert_double_gt(e.external_work, 4);
    ck_assert_double_ge(e.contact, 0);
    ck_assert_double_le(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("pressed_lines");
    ADD_LOOP(pressed_point_stays, 3);
    ADD_LOOP(wedge_gives_no_more_than_its_work, 1);
    return suite_main(suite);
}
