// Meshes that overlap a little as they begin (less than what is pushed out against a load): they meet without gain, are
// pushed out no further than they lay in each other, part by themselves, slide on each other; a restart in the middle.
#include "contact/search/node_to_facet_parts.h"
#include "world/world.h"
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

typedef enum arrangement { SHIFTED, TURNED, CROSSED, SLIDING, FINER, ARRANGEMENTS } arrangement;
static const char *const arranged[] = {"shifted", "turned", "crossed beams", "that slide", "one finer"};

typedef struct meeting {
    arrangement how;
    brunt_element_kind kind;
    double overlap;  // [m]
    double speed[2]; // [m/s] of the lower, upward, and of the upper, downward
} meeting;

static void mesh(brunt_body_def *b, const meeting *c, double size) {
    b->method = BRUNT_FEM, b->element = c->kind, b->size = size;
}

// Two blocks of 1 m, or beams across each other, one on the other.
static brunt_world_def def_meeting(const meeting *c) {
    const bool beams = c->how == CROSSED;
    const double top = beams ? 0.4 : 1, base = top - c->overlap, shift = beams ? 0.3 : c->how == SHIFTED ? 0.13 : 0.01;
    brunt_world_def def = def_begin(3, 1);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.touch = BRUNT_TOUCH_ELASTIC;
    def.contact.allow_overlap = true;
    def.cfl = 0.5;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *a = def_box(&def, "a", XYZ(0, 0, beams ? 0.3 : 0), XYZ(1, top, beams ? 0.7 : 1));
    mesh(a, c, 0.5), def_velocity(a, c->how == SLIDING ? 3 : 0, c->speed[0], 0);
    brunt_body_def *b = def_box(&def, "b", XYZ(shift, base, 0), XYZ(beams ? 0.7 : 1 + shift, base + top, 1));
    mesh(b, c, c->how == FINER ? 0.25 : 0.5), def_velocity(b, 0, -c->speed[1], 0);
    if (c->how == TURNED) b->place = brunt_placement_rotate(b->place, XYZ(0, 1, 0), 20 * PI / 180, XYZ(0.5, 0, 0.5));
    return def;
}

// Both move, or one stands. Where it was pushed out against the load overlap made 2 to 30 % of the energy.
START_TEST(overlap_makes_no_energy_as_meshes_meet) {
    const meeting c = {.how = (arrangement)(_i % ARRANGEMENTS),
                       .kind = _i / ARRANGEMENTS % 2 ? BRUNT_HEX8 : BRUNT_TET4,
                       .overlap = 0.008,
                       .speed = {_i / ARRANGEMENTS / 2 == 2 ? 0 : 0.5, _i / ARRANGEMENTS / 2 == 1 ? 0 : 0.5}};
    brunt_world_def def = def_meeting(&c);
    brunt_world *world = world_take(&def);
    double least = 0;
    while (brunt_world_time(world) < 0.3) {
        world_steps(world, 4);
        least = fmin(least, world_energy(world).contact);
    }
    const brunt_energy e = world_energy(world);
    const brunt_momentum p = world_momentum(world);
    if (c.speed[0] == c.speed[1])
        hard_case("C17", fabs(least) / e.initial, 3e-3, 3e-3, "meshes (%s), %s, overlap 0.016 h: energy made",
                  c.kind == BRUNT_HEX8 ? "hex8" : "tet4", arranged[c.how]);
    ck_assert_double_le(-least, 3e-3 * e.initial);
    ck_assert_double_le(e.contact, 0.01 * e.initial);
    ck_assert_double_le(p.linear_drift, ROUNDING);
    ck_assert_double_le(p.angular_drift, 100 * ROUNDING);
    ck_assert_ptr_null(world->contact.node_to_facet->penetration.allowed); // they parted, or lie free of each other
    brunt_world_destroy(world);
}
END_TEST

// Pressed on each other they lie as deep as they began, whichever is pressed, and whatever waves do.
START_TEST(what_rests_lies_as_deep_as_it_began) {
    const meeting c = {.how = TURNED, .kind = _i ? BRUNT_HEX8 : BRUNT_TET4, .overlap = 0.008};
    brunt_world_def def = def_meeting(&c);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    def.gravity[1] = -10, def.gravity_ramp = 0.2;
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    const initial_penetration *p = &world->contact.node_to_facet->penetration;
    double deepest = 0;
    ck_assert_ptr_nonnull(p->allowed);
    for (int32_t n = 0; n < world->contact.surface.node_count; n++)
        if (p->allowed[n] < INFINITY) deepest = fmax(deepest, p->allowed[n]);
    printf("  at rest: %.2e m of 8e-3 deep, contact %.1e J\n", deepest, world_energy(world).contact);
    ck_assert_double_gt(deepest, 0.007);
    ck_assert_double_le(deepest, 0.008 * (1 + 1e-6));
    brunt_world_destroy(world);
}
END_TEST

// Nothing is kept where nothing overlaps: bodies that touch, and such as are apart and meet.
START_TEST(nothing_is_kept_without_overlap) {
    const meeting c = {.how = SHIFTED, .kind = BRUNT_TET4, .overlap = _i ? -0.004 : 0, .speed = {0.5, 0.5}};
    brunt_world_def def = def_meeting(&c);
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    ck_assert_ptr_null(world->contact.node_to_facet->penetration.allowed);
    brunt_world_destroy(world);
}
END_TEST

// From a saved state the same bits: before the first step, in the middle, after they have parted, and in a touch
// without overlap; in the middle they are others without what is allowed.
START_TEST(restart_in_overlap) {
    static const double times[] = {0, 0.03, 0.25, 0.03};
    const meeting c = {.how = SHIFTED, .kind = BRUNT_TET4, .overlap = _i == 3 ? -0.004 : 0.008, .speed = {0.5, 0.5}};
    brunt_world_def def = def_meeting(&c);
    brunt_world *world = world_from(&def), *other = world_from(&def), *without = world_take(&def);
    if (_i) world_until(world, times[_i]), world_steps(without, 1);
    world_copy_state(world, other), world_copy_state(world, without);
    if (_i == 1) {
        ck_assert_ptr_nonnull(world->contact.node_to_facet->penetration.allowed);
        brunt_initial_penetration_free(&without->contact.node_to_facet->penetration);
    }
    world_steps(world, 60), world_steps(other, 60), world_steps(without, 60);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(other));
    if (_i == 1)
        ck_assert_uint_ne(brunt_world_hash(world), brunt_world_hash(without));
    else
        ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(without));
    brunt_world_destroy(world), brunt_world_destroy(other), brunt_world_destroy(without);
}
END_TEST

// ------------------------------------------------------------------------------------------ by itself

static initial_penetration made(int32_t nodes) {
    initial_penetration p = {0};
    brunt_error error;
    ck_assert_int_eq(brunt_initial_penetration_begin(&p, nodes, &error), BRUNT_OK);
    return p;
}

static double meet(initial_penetration *p, int32_t n, double gap) {
    return brunt_initial_penetration_meet(p, &n, 1, gap);
}

// A node may lie as deep as it was found, then as deep as it was last; what parts begins anew; several may lie as deep
// as one of them.
START_TEST(depths_only_lessen) {
    brunt_contact_surface s = {.node_count = 3, .mean_edge = 1};
    initial_penetration p = made(3);
    ck_assert_double_eq(meet(&p, 0, -0.01), 0);
    ck_assert_double_eq(meet(&p, 1, 0.25), 0.25);
    brunt_initial_penetration_end(&p, &s);
    ck_assert_double_eq(meet(&p, 0, -0.015), -0.015 + 0.01);
    ck_assert_double_eq(meet(&p, 1, -0.003), -0.003);
    ck_assert_double_eq(meet(&p, 2, -0.02), 0);
    ck_assert_double_eq(brunt_initial_penetration_meet(&p, (int32_t[]){0, 1}, 2, -0.012), -0.012 + 0.01);
    brunt_initial_penetration_end(&p, &s);
    ck_assert_double_eq(meet(&p, 0, -0.004), 0);
    brunt_initial_penetration_end(&p, &s); // the others have parted
    ck_assert_double_eq(meet(&p, 0, -0.006), -0.006 + 0.004);
    ck_assert_double_eq(meet(&p, 1, -0.006), 0);
    ck_assert_double_eq(meet(&p, 2, -5e-7), 0);
    brunt_initial_penetration_end(&p, &s);
    ck_assert_double_eq(p.allowed[2], 0); // it touches
    brunt_initial_penetration_end(&p, &s);
    ck_assert_ptr_null(p.allowed);
    ck_assert_double_eq(meet(&p, 0, -0.006), -0.006); // as of all that did not overlap at the start
}
END_TEST

// Elements have left: nodes have other numbers, and new ones have met nothing.
START_TEST(depths_follow_their_nodes) {
    brunt_contact_surface s = {.node_count = 2, .mean_edge = 1};
    int32_t was[] = {1, -1, 0, 0};
    brunt_error error;
    initial_penetration p = made(2);
    meet(&p, 0, -0.01), meet(&p, 1, -0.02);
    brunt_initial_penetration_end(&p, &s);
    s.node_count = 3, s.renewal.change = (brunt_surface_change){.any = true, .node_count = 2, .node_was = was};
    ck_assert_int_eq(brunt_initial_penetration_renew(&p, &s, &error), BRUNT_OK);
    ck_assert_double_eq(p.allowed[0], 0.02);
    ck_assert(isinf(p.allowed[1]));
    ck_assert_double_eq(p.allowed[2], 0.01);
    brunt_initial_penetration_validate(&p, 3);
    brunt_initial_penetration_free(&p);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("initial_penetration");
    ADD_LOOP(overlap_makes_no_energy_as_meshes_meet, 6 * ARRANGEMENTS);
    ADD_LOOP(what_rests_lies_as_deep_as_it_began, 2);
    ADD_LOOP(nothing_is_kept_without_overlap, 2);
    ADD_LOOP(restart_in_overlap, 4);
    ADD(depths_only_lessen);
    ADD(depths_follow_their_nodes);
    return suite_main(suite);
}
