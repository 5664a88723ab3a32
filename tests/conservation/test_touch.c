// What touches take comes back at release (contact.touch elastic), through the public interface: bars, walls that stand
// and move, friction, oblique cubes, a restart in the middle, a body that leaves past a rim, and none of it where a
// scene does not want it.
#include "contact/search/node_to_facet_parts.h"
#include "world/world.h"
#include "tests/support/hard_world.h"

static brunt_body_def *mesh(brunt_body_def *b, brunt_element_kind kind, double size) {
    b->method = BRUNT_FEM, b->element = kind, b->size = size;
    return b;
}

// Of one time: velocities are those of the middle of the last step.
static double stored(brunt_world *world) {
    const brunt_energy e = world_energy(world);
    return e.kinetic + e.internal + e.hourglass + e.transfer;
}

static brunt_world_def begin(int dimension, double friction, brunt_touch_kind touch) {
    brunt_world_def def = def_begin(dimension, 1);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = friction;
    def.contact.touch = touch;
    return def;
}

// ------------------------------------------------------------------------------------------ bars

typedef struct bars {
    int elements;    // of the first, along its length of 1
    int along;       // axis
    double length;   // of the second
    double speed[2]; // of each along the axis
    bool swapped;    // the second comes first among bodies
} bars;

typedef struct parted {
    double speed[2], kept, most, held, drift;
} parted;

static parted collide(const bars *c, brunt_touch_kind touch) {
    const double h = 1.0 / c->elements, gap = 0.3 * h, ends[2][2] = {{-1 - gap, -gap}, {0, c->length}};
    brunt_world_def def = begin(3, 0, touch);
    def.cfl = 0.9;
    def_material(&def, "linear-elastic", 1, 1, 0);
    for (int k = 0; k < 2; k++) {
        const int bar = c->swapped ? 1 - k : k;
        double low[3] = {0, 0, 0}, high[3] = {h, h, h}, v[3] = {0};
        low[c->along] = ends[bar][0], high[c->along] = ends[bar][1], v[c->along] = c->speed[bar];
        def_velocity(mesh(def_box(&def, k ? "b" : "a", low, high), BRUNT_HEX8, h), v[0], v[1], v[2]);
    }
    brunt_world *world = world_take(&def);
    const double until = gap / fabs(c->speed[0] - c->speed[1]) + 2 * fmax(1, c->length) + 6 * h;
    parted out = {.most = 0};
    while (brunt_world_time(world) < until) {
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        out.most = fmax(out.most, stored(world) / e.initial);
        out.held = fmax(out.held, e.contact_held / e.initial);
        if (touch == BRUNT_TOUCH_ELASTIC) ck_assert_double_eq_tol(e.contact_held, e.contact, 1e-9 * e.initial);
    }
    for (int k = 0; k < 2; k++) out.speed[k] = world_sums(world, c->swapped ? 1 - k : k).velocity[c->along];
    out.kept = stored(world) / world_energy(world).initial, out.drift = world_momentum(world).linear_drift;
    brunt_world_destroy(world);
    return out;
}

// One stands, the other, both move; along each axis; made in either order; against one twice as long.
START_TEST(bars_give_on_what_they_have) {
    static const bars cases[] = {
        {20, 0, 1, {1e-3, 0}, false}, {20, 0, 1, {0, -1e-3}, false}, {20, 0, 1, {5e-4, -5e-4}, false},
        {20, 2, 1, {1e-3, 0}, false}, {20, 1, 1, {1e-3, 0}, true},   {10, 0, 1, {1e-3, 0}, false},
        {20, 0, 2, {1e-3, 0}, false},
    };
    const bars *c = &cases[_i];
    const parted elastic = collide(c, BRUNT_TOUCH_ELASTIC), inelastic = collide(c, BRUNT_TOUCH_INELASTIC);
    const double V = c->speed[0] - c->speed[1], share = c->length > 1 ? 0.5 : 1,
                 got = (elastic.speed[1] - c->speed[1]) / (V * share),
                 got_without = (inelastic.speed[1] - c->speed[1]) / (V * share);
    printf("  bars %d: kept %.6f, %.4f without; speed given %.4f, %.4f; most %.6f, held %.4f, drift %.1e\n", _i,
           elastic.kept, inelastic.kept, got, got_without, elastic.most, elastic.held, elastic.drift);
    ck_assert_double_ge(elastic.kept, 1 - 1e-5);
    ck_assert_double_le(elastic.most, 1 + 1e-5);
    ck_assert_double_le(elastic.drift, ROUNDING);
    ck_assert_double_gt(elastic.held, 0.1 / c->elements);
    ck_assert_double_lt(fabs(got - 1), 0.02);
    // A shorter one that stands is to be at rest: touches took a half node's energy, and give it back in a kick of m V
    // / 4.
    if (c->length > 1) ck_assert_double_eq_tol(elastic.speed[0] / V, -0.25 / c->elements, 0.1 / c->elements);
    ck_assert_double_lt(inelastic.kept, 1 - 0.2 / c->elements);
    ck_assert_double_lt(got_without, got - 0.005);
    ck_assert(inelastic.held == 0);
}
END_TEST

// ------------------------------------------------------------------------------------------ walls

typedef struct thrown {
    double speed[3], contact, friction, friction_share;
} thrown;

// A block of 2D elements and a plane with normal n: the block comes at `v`, the plane moves at `wall` along n.
static thrown throw_at(const double n[2], double v, double slide, double wall, double friction) {
    const double turn = atan2(n[1], n[0]) - PI / 2;
    brunt_world_def def = begin(2, 0, BRUNT_TOUCH_ELASTIC);
    def_material(&def, "linear-elastic", 1, 1, 0);
    brunt_body_def *block = mesh(def_box(&def, "block", XYZ(-0.5, 0.01, 0), XYZ(0.5, 1.01, 0)), BRUNT_QUAD4, 0.1);
    block->place = brunt_placement_rotate(block->place, XYZ(0, 0, 1), turn, XYZ(0, 0, 0));
    const double t[2] = {n[1], -n[0]};
    def_velocity(block, -v * n[0] + slide * t[0], -v * n[1] + slide * t[1], 0);
    brunt_plane_def *plane = def_plane(&def, XYZ(0, 0, 0), XYZ(n[0], n[1], 0), BRUNT_SEPARATE, friction);
    for (int a = 0; a < 2; a++) plane->velocity[a] = wall * n[a];
    brunt_world *world = world_take(&def);
    world_until(world, 0.01 / (v + wall) + 4);
    const brunt_body_sums b = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    const brunt_reaction f = world_boundary(world, 0);
    const double push = f.impulse[0] * n[0] + f.impulse[1] * n[1], rub = f.impulse[0] * t[0] + f.impulse[1] * t[1];
    thrown out = {.contact = e.contact / (0.5 * (v + wall) * (v + wall)), .friction_share = -rub / push};
    for (int a = 0; a < 2; a++) out.speed[0] += b.velocity[a] * n[a], out.speed[1] += b.velocity[a] * t[a];
    ck_assert_double_lt(fabs(e.error_relative), 1e-4);
    brunt_world_destroy(world);
    return out;
}

// What is held of a plane says which: the second of two.
START_TEST(walls_are_told_apart) {
    brunt_world_def def = begin(2, 0, BRUNT_TOUCH_ELASTIC);
    def_material(&def, "linear-elastic", 1, 1, 0);
    def_velocity(mesh(def_box(&def, "block", XYZ(-0.5, 0.01, 0), XYZ(0.5, 1.01, 0)), BRUNT_QUAD4, 0.1), 0, -0.01, 0);
    def_plane(&def, XYZ(0, 9, 0), XYZ(0, -1, 0), BRUNT_SEPARATE, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 2);
    const node_touches *touches = &world->contact.node_to_facet->touches;
    int holding = 0;
    for (int32_t n = 0; n < world->contact.surface.node_count; n++) {
        const brunt_touch_energy *touch = &touches->of[n][TOUCHED_PLANE];
        if (touch->held == 0) continue;
        holding++;
        ck_assert_int_eq(touch->partner, -2);
    }
    ck_assert_int_eq(holding, 11);
    brunt_world_destroy(world);
}
END_TEST

// The block comes, or the wall does, from any side: what is lost is nothing, and the block is as fast to the wall.
START_TEST(walls_that_stand_and_move) {
    const double turns[] = {90, 0, 37, 180, -90}, angle = turns[_i] * PI / 180, n[2] = {cos(angle), sin(angle)};
    const thrown stands = throw_at(n, 1e-3, 0, 0, 0), moves = throw_at(n, 0, 0, 1e-3, 0),
                 both = throw_at(n, 3e-3, 0, -2e-3, 0);
    printf("  wall turned by %g: leaves at %.4f, %.4f, %.4f of what it came with; lost %.1e %.1e %.1e\n", turns[_i],
           stands.speed[0] / 1e-3, (moves.speed[0] - 1e-3) / 1e-3, (both.speed[0] + 2e-3) / 1e-3, stands.contact,
           moves.contact, both.contact);
    ck_assert_double_ge(stands.speed[0], 0.95e-3);
    ck_assert_double_lt(fabs(stands.contact), 1e-6);
    ck_assert_double_lt(fabs(moves.contact), 1e-6);
    ck_assert_double_lt(fabs(both.contact), 1e-6);
    ck_assert_double_lt(fabs(moves.speed[0] - 1e-3 - stands.speed[0]), 2e-3 * 1e-3);
    ck_assert_double_lt(fabs(both.speed[0] + 2e-3 - stands.speed[0]), 2e-3 * 1e-3);
}
END_TEST

typedef enum ground { ON_PLANE, ON_HELD, ON_HEAVY, UNDER_HEAVY } ground;

// A block of 2D elements that comes down, or up, at 1e-3: what comes back of its speed, and what contact takes.
static double bounce_on(ground what, double *lost) {
    const double side = what == UNDER_HEAVY ? -1 : 1;
    brunt_world_def def = begin(2, 0, BRUNT_TOUCH_ELASTIC);
    def_material(&def, "linear-elastic", 1, 1, 0);
    const double low = side > 0 ? 0.01 : -1.01;
    def_velocity(mesh(def_box(&def, "block", XYZ(-0.5, low, 0), XYZ(0.5, low + 1, 0)), BRUNT_QUAD4, 0.1), 0,
                 -side * 1e-3, 0);
    if (what == ON_PLANE) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    } else {
        def_material(&def, "linear-elastic", what == ON_HELD ? 1 : 1e9, what == ON_HELD ? 1 : 1e9, 0);
        brunt_body_def *floor = mesh(
            def_box(&def, "floor", XYZ(-1, side > 0 ? -0.1 : 0, 0), XYZ(1, side > 0 ? 0 : 0.1, 0)), BRUNT_QUAD4, 0.1);
        floor->material = 1;
    }
    if (what == ON_HELD) {
        def.groups = brunt_alloc(sizeof *def.groups), def.group_count = 1;
        def.groups[0] = brunt_group_def_default();
        snprintf(def.groups[0].body, sizeof def.groups[0].body, "floor");
        snprintf(def.groups[0].group, sizeof def.groups[0].group, "surface");
    }
    brunt_world *world = world_take(&def);
    world_until(world, 10 + 3);
    const double back = side * world_sums(world, 0).velocity[1] / 1e-3;
    const brunt_energy e = world_energy(world);
    *lost = e.contact / e.initial;
    brunt_world_destroy(world);
    return back;
}

// What is held all over, or a thousand million times as heavy, is a wall: from above and from below, at 0 degrees.
START_TEST(held_and_heavy_are_walls) {
    double lost[4], back[4];
    for (int k = 0; k < 4; k++) back[k] = bounce_on((ground)k, &lost[k]);
    for (int k = 0; k < 4; k++) {
        printf("  ground %d: %.6f of the speed comes back, contact takes %.1e\n", k, back[k], lost[k]);
        ck_assert_double_eq_tol(back[k], back[0], 1e-6);
        ck_assert_double_eq_tol(lost[k], 0, 1e-6);
        if (k > 1) ck_assert_double_eq_tol(back[k], back[1], 1e-7);
    }
    ck_assert_double_gt(back[0], 0.95); // the rest is viscosity and vibration
}
END_TEST

// What slides all the time rubs with the coefficient times all of its normal impulse, that of release among it.
START_TEST(release_rubs) {
    const double n[2] = {0, 1};
    const thrown b = throw_at(n, 1e-3, 5e-3, 0, 0.3);
    printf("  slides at %.3f of the way in: friction over pushes %.9f\n", b.speed[1] / 5e-3, b.friction_share);
    ck_assert_double_gt(b.speed[1], 2e-3);
    ck_assert_double_eq_tol(b.friction_share, 0.3, 1e-9);
}
END_TEST

// ------------------------------------------------------------------------------------------ cubes

static brunt_world_def oblique_cubes(brunt_element_kind kind, double h, double speed, brunt_touch_kind touch) {
    brunt_world_def def = begin(3, 0, touch);
    def.step = 1e-4 * h;
    def_material(&def, "neo-hookean", 2700, 1e8, 0.3);
    def_velocity(mesh(def_box(&def, "a", XYZ(-1.5, -1.5, -1.5), XYZ(1.5, 1.5, 1.5)), kind, h), 0, 35 * speed, 0);
    brunt_body_def *b = mesh(def_box(&def, "b", XYZ(-1.5, -1.5, -1.5), XYZ(1.5, 1.5, 1.5)), kind, h);
    def_velocity(b, -15 * speed, -35 * speed, -15 * speed);
    b->place = brunt_placement_translate(b->place, XYZ(0, 3.8, 0));
    b->place = brunt_placement_rotate(b->place, XYZ(1, 0, 0), 22 * PI / 180, XYZ(0, 0, 0));
    return def;
}

// Edges cross and slide over nodes, nodes meet facets and leave over rims, what was an edge is bent flat at three times
// the speed, when elements go by a tenth of the waves' speed: at least 0.999 comes back, and never more than there was.
START_TEST(cubes_keep_their_energy) {
    const double speed = _i < 2 ? 1 : 3;
    brunt_world_def def = oblique_cubes(_i % 2 ? BRUNT_HEX8 : BRUNT_TET4, 0.6, speed, BRUNT_TOUCH_ELASTIC);
    brunt_world *world = world_take(&def);
    double most = 0;
    while (brunt_world_time(world) < 0.15 / speed) {
        world_steps(world, 4);
        const brunt_energy now = world_energy(world);
        most = fmax(most, (stored(world) - fmax(now.error, 0)) / now.initial); // the integrator's own error aside
    }
    const brunt_energy e = world_energy(world);
    const brunt_momentum p = world_momentum(world);
    printf("  cubes: kept %.4f, most %.6f, still held %.1e, drift %.1e %.1e\n", stored(world) / e.initial, most,
           e.contact_held / e.initial, p.linear_drift, p.angular_drift);
    ck_assert_double_ge(stored(world) / e.initial, 0.999);
    ck_assert_double_le(most, 1 + 1e-4);
    ck_assert_double_le(p.linear_drift, ROUNDING);
    ck_assert_double_le(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(e.contact_held), 1e-3 * e.initial);
    brunt_world_destroy(world);
}
END_TEST

// Nodes slide off past a rim, where nodes of the other body go on on their facets, or edges cross: what they hold goes
// on, too. Where it stayed with them 0.17 % was lost.
START_TEST(what_leaves_past_a_rim_goes_on) {
    const double speed = _i ? 1.5 : 1.01;
    brunt_world_def def = oblique_cubes(BRUNT_HEX8, _i ? 0.75 : 0.6, speed, BRUNT_TOUCH_ELASTIC);
    brunt_world *world = world_take(&def);
    world_until(world, 0.15 / speed);
    const brunt_energy e = world_energy(world);
    printf("  past a rim: contact took %.1e of the energy\n", e.contact / e.initial);
    ck_assert_double_lt(e.contact, 2e-4 * e.initial);
    brunt_world_destroy(world);
}
END_TEST

// A block of half as large hexahedra on another, a hundredth of it beyond: nodes over rims leave while those beside
// them stay. What they held was lost with them, 1 %; whichever is first among the bodies, and moves.
START_TEST(what_leaves_beside_others_goes_on) {
    brunt_world_def def = begin(3, 0, BRUNT_TOUCH_ELASTIC);
    def.cfl = 0.5;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int k = 0; k < 2; k++) {
        const bool fine = k == (_i & 1);
        const double base = fine ? 1.0005 : 0, beyond = fine ? 0.01 : 0;
        brunt_body_def *b =
            mesh(def_box(&def, fine ? "fine" : "coarse", XYZ(beyond, base, 0), XYZ(1 + beyond, base + 1, 1)),
                 BRUNT_HEX8, fine ? 0.25 : 0.5);
        const bool moves = _i < 2 || fine == (_i < 4);
        def_velocity(b, 0, (moves ? _i < 2 ? 0.5 : 1 : 0) * (fine ? -1 : 1), 0);
    }
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    const brunt_energy e = world_energy(world);
    printf("  beside others: contact took %.1e of the energy, %.1e is held\n", e.contact / 250, e.contact_held / 250);
    ck_assert_double_lt(fabs(e.contact), 2e-4 * 250);
    brunt_world_destroy(world);
}
END_TEST

// At a third of the speed of waves and the longest steps nodes come by a tenth of an edge and more in one.
START_TEST(longest_steps_give_back_as_much) {
    brunt_world_def def = oblique_cubes(_i ? BRUNT_HEX8 : BRUNT_TET4, 0.5, 1, BRUNT_TOUCH_ELASTIC);
    def.step = 0, def.cfl = 0.9;
    brunt_world *world = world_take(&def);
    world_until(world, 0.15);
    const brunt_energy e = world_energy(world);
    printf("  %lld steps: contact took %.1e of the energy\n", (long long)brunt_world_steps(world),
           e.contact / e.initial);
    ck_assert_int_lt(brunt_world_steps(world), 300);
    ck_assert_double_ge(e.contact, 0);
    ck_assert_double_lt(e.contact, 1e-3 * e.initial);
    brunt_world_destroy(world);
}
END_TEST

// In the middle of it, where something is held: from a saved state the same bits. Without what is held they are others.
// Later some is held at nodes of edges that touch no more.
START_TEST(restart_while_something_is_held) {
    const double speed = _i ? 3 : 1;
    brunt_world_def def = oblique_cubes(_i ? BRUNT_HEX8 : BRUNT_TET4, 0.75, speed, BRUNT_TOUCH_ELASTIC);
    brunt_world *world = world_from(&def), *other = world_take(&def);
    world_until(world, (0.0207 + 0.005 * _i) / speed);
    const brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.contact_held, _i ? 0 : 1e-3 * e.initial);
    world_copy_state(world, other);
    ck_assert_double_eq(world_energy(other).contact_held, e.contact_held);
    const node_touches *one = &world->contact.node_to_facet->touches, *two = &other->contact.node_to_facet->touches;
    for (int32_t n = 0; n < world->contact.surface.node_count; n++)
        for (int what = 0; what < TOUCHED_COUNT; what++) {
            ck_assert_double_eq(one->of[n][what].held, two->of[n][what].held);
            if (one->of[n][what].held != 0) ck_assert_int_eq(one->of[n][what].partner, two->of[n][what].partner);
            if (one->of[n][what].held != 0) ck_assert_int_gt(one->of[n][what].partner, 0);
        }
    world_steps(world, 100), world_steps(other, 100);
    ck_assert_uint_eq(brunt_world_hash(world), brunt_world_hash(other));
    brunt_world_destroy(world), brunt_world_destroy(other);
}
END_TEST

// States that do not say of whom what is held is: of anyone.
START_TEST(states_of_before) {
    brunt_world_def def = oblique_cubes(BRUNT_TET4, 0.75, 1, BRUNT_TOUCH_ELASTIC);
    brunt_world *world = world_from(&def), *other = world_take(&def);
    world_until(world, 0.02);
    int32_t index = 0;
    while (strcmp(brunt_state_info(world, index).name, "world/contact_search")) index++;
    const int64_t count = brunt_state_info(world, index).count,
                  said = brunt_node_touches_state_count(&world->contact.surface) / 2;
    double *state = brunt_alloc((size_t)count * sizeof *state);
    brunt_error error;
    brunt_state_get(world, index, state);
    ck_assert_int_eq(brunt_state_set(other, index, state, count - said - 1, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_state_set(other, index, state, count - said, &error), BRUNT_OK);
    other->contact.surface.motion.was_active[0] = other->contact.surface.motion.was_active[1] = true;
    ck_assert_double_eq(brunt_node_to_facet_held(other->contact.node_to_facet, &other->contact.surface),
                        world_energy(world).contact_held);
    for (int32_t n = 0; n < other->contact.surface.node_count; n++)
        for (int what = 0; what < TOUCHED_COUNT; what++)
            ck_assert_int_eq(other->contact.node_to_facet->touches.of[n][what].partner, 0);
    brunt_free(state);
    brunt_world_destroy(world), brunt_world_destroy(other);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("touch");
    ADD_LOOP(bars_give_on_what_they_have, 7);
    ADD_LOOP(walls_that_stand_and_move, 5);
    ADD(walls_are_told_apart);
    ADD(held_and_heavy_are_walls);
    ADD(release_rubs);
    ADD_LOOP(cubes_keep_their_energy, 4);
    ADD_LOOP(what_leaves_past_a_rim_goes_on, 2);
    ADD_LOOP(what_leaves_beside_others_goes_on, 6);
    ADD_LOOP(longest_steps_give_back_as_much, 2);
    ADD_LOOP(restart_while_something_is_held, 8);
    ADD(states_of_before);
    return suite_main(suite);
}
