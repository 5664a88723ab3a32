// Implicit contact looked at otherwise: the same collision mirrored, turned, moved far away, seen from a frame that
// moves, its bodies in another order or named the other way round; the other body thrown; what stands still while
// something else moves; gaps of exactly the barrier's distance; a closed box; friction 0 and no friction, turns by 0.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double cell = 0.125;

// How it is looked at: x mirrored, then turned, then moved; and how the frame moves.
typedef struct look {
    const char *how;
    double angle;
    double shift[2], boost[2];
    bool mirrored, reversed, renamed, points;
    brunt_integrator integrator;
} look;

static void seen(const look *l, const double v[2], double out[3]) {
    const double x = l->mirrored ? -v[0] : v[0], c = cos(l->angle), s = sin(l->angle);
    out[0] = c * x - s * v[1], out[1] = s * x + c * v[1], out[2] = 0;
}

// As it would be seen without.
static void unseen(const look *l, const double v[2], double out[2]) {
    const double c = cos(l->angle), s = sin(l->angle), x = c * v[0] + s * v[1];
    out[0] = l->mirrored ? -x : x, out[1] = c * v[1] - s * v[0];
}

static void place(const look *l, brunt_body_def *b, double low, double high, const double velocity[2]) {
    double v[3];
    const double along[2] = {velocity[0] + l->boost[0], velocity[1] + l->boost[1]};
    if (l->mirrored) b->shape.min[0] = -high, b->shape.max[0] = -low;
    b->place = brunt_placement_rotate(b->place, XYZ(0, 0, 1), l->angle, XYZ(0, 0, 0));
    b->place = brunt_placement_translate(b->place, XYZ(l->shift[0], l->shift[1], 0));
    seen(l, along, v);
    def_velocity(b, v[0], v[1], 0);
}

static brunt_body_def *upper(brunt_world_def *def, const look *l) {
    brunt_body_def *b = def_box(def, l->renamed ? "z" : "b", XYZ(0, 0.03, 0), XYZ(0.5, 0.53, 0));
    if (!l->points) b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.125;
    place(l, b, 0, 0.5, (const double[2]){1, -2});
    return b;
}

static brunt_body_def *lower(brunt_world_def *def, const look *l) {
    brunt_body_def *b = def_box(def, "c", XYZ(-0.25, -0.5, 0), XYZ(1, 0, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.25;
    place(l, b, -0.25, 1, (const double[2]){0, 0});
    return b;
}

typedef struct outcome {
    double velocity[2][2], centre[2][2]; // of the upper and of the lower body
    double impulse[2], lost, drift;
} outcome;

// Two blocks, one thrown obliquely at the other, with friction and gravity: while they meet, and after.
static outcome collide(const look *l) {
    brunt_world_def def = def_begin(2, cell);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    go_implicit(&def, l->integrator, 2e-3);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.friction = 0.3, def.contact.distance = 0.02;
    if (l->reversed)
        lower(&def, l), upper(&def, l);
    else
        upper(&def, l), lower(&def, l);
    double g[3];
    seen(l, (const double[2]){0, -10}, g);
    memcpy(def.gravity, g, sizeof g);
    brunt_world *world = world_take(&def);
    world_steps(world, 60);
    outcome o = {.drift = world_momentum(world).linear_drift};
    const double time = brunt_world_time(world);
    for (int k = 0; k < 2; k++) {
        const int body = l->renamed ? 1 - k : k;
        const brunt_body_sums s = world_sums(world, body);
        unseen(l, s.velocity, o.velocity[k]);
        const double from[2] = {s.centre[0] - l->shift[0], s.centre[1] - l->shift[1]};
        unseen(l, from, o.centre[k]);
        for (int a = 0; a < 2; a++) o.velocity[k][a] -= l->boost[a], o.centre[k][a] -= l->boost[a] * time;
    }
    const brunt_reaction f = world_pair(world, 0);
    unseen(l, f.impulse, o.impulse);
    for (int a = 0; a < 2 && l->renamed; a++) o.impulse[a] = -o.impulse[a];
    const brunt_energy e = world_energy(world);
    o.lost = e.friction;
    brunt_world_destroy(world);
    return o;
}

static double apart(const outcome *a, const outcome *b) {
    double most = 0;
    for (int k = 0; k < 2; k++)
        for (int c = 0; c < 2; c++) {
            most = fmax(most, fabs(a->velocity[k][c] - b->velocity[k][c]));
            most = fmax(most, fabs(a->centre[k][c] - b->centre[k][c]));
        }
    for (int c = 0; c < 2; c++) most = fmax(most, fabs(a->impulse[c] - b->impulse[c]) / 250);
    return fmax(most, fabs(a->lost - b->lost) / 500); // masses are 250 and 625 kg, some 600 J of the first's
}

static const look looks[] = {
    {.how = "mirrored", .mirrored = true},
    {.how = "turned by 90 degrees", .angle = PI / 2},
    {.how = "turned by 180 degrees", .angle = PI},
    {.how = "turned by 37 degrees", .angle = 37 * PI / 180},
    {.how = "mirrored and turned by 37 degrees", .angle = 37 * PI / 180, .mirrored = true},
    {.how = "moved by 1000 m", .shift = {1000, -1000}},
    {.how = "in another order", .reversed = true},
    {.how = "named the other way round", .renamed = true},
    {.how = "from a frame that moves", .boost = {-1, 2}}, // the other one is thrown
    {.how = "from one that moves fast", .boost = {50, 30}},
};
enum { LOOKS = sizeof looks / sizeof *looks };

// What rounding and Newton's method leave; points that go another way through their grid have its errors.
START_TEST(looks_the_same) {
    look l = looks[_i % LOOKS];
    l.points = _i / LOOKS % 2, l.integrator = _i / LOOKS / 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    const bool grid = l.points && (l.boost[0] != 0 || fmod(l.angle, PI / 2) != 0);
    const look plain = {.points = l.points, .integrator = l.integrator};
    const outcome a = collide(&plain), b = collide(&l);
    const double off = apart(&a, &b);
    printf("  %s on elements, %s, %s: off by %.1e m/s and m; velocities %.4f %.4f, friction %.1f J\n",
           l.points ? "points" : "elements", l.integrator == BRUNT_NEWMARK ? "newmark" : "euler", l.how, off,
           a.velocity[0][0], a.velocity[0][1], a.lost);
    ck_assert_double_gt(a.lost, 1);
    ck_assert_double_le(off, grid ? 0.03 : 1e-10);
}
END_TEST

// ------------------------------------------------------------------------------------------ in space

// Two blocks of tetrahedra, turned about an oblique axis and moved, everything with them.
static outcome collide_in_space(double angle, double far) {
    brunt_world_def def = def_begin(3, cell);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    go_implicit(&def, BRUNT_EULER, 2e-3);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.friction = 0.3, def.contact.distance = 0.02;
    const double axis[3] = {1, 2, 3}, zero[3] = {0, 0, 0}, by[3] = {far, -far, far};
    const brunt_placement turn = brunt_placement_rotate(brunt_placement_identity(), axis, angle, zero);
    const double low[2][3] = {{0, 0, 0.03}, {-0.25, -0.25, -0.5}}, high[2][3] = {{0.5, 0.5, 0.53}, {0.75, 0.75, 0}},
                 v[2][3] = {{1, 0.5, -2}, {0, 0, 0}};
    for (int k = 0; k < 2; k++) {
        brunt_body_def *b = def_box(&def, k ? "c" : "b", low[k], high[k]);
        b->method = BRUNT_FEM, b->element = BRUNT_TET4, b->size = 0.25;
        b->place = brunt_placement_translate(turn, by);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) b->velocity[i] += turn.rotation[3 * i + j] * v[k][j];
    }
    brunt_world *world = world_take(&def);
    world_steps(world, 30);
    outcome o = {.lost = world_energy(world).friction};
    for (int k = 0; k < 2; k++) {
        const brunt_body_sums s = world_sums(world, k);
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < 3; i++) {
                o.velocity[k][j] += turn.rotation[3 * i + j] * s.velocity[i];
                o.centre[k][j] += turn.rotation[3 * i + j] * (s.centre[i] - by[i]);
            }
    }
    brunt_world_destroy(world);
    return o;
}

START_TEST(looks_the_same_in_space) {
    const outcome a = collide_in_space(0, 0), b = collide_in_space(37 * PI / 180, 0),
                  c = collide_in_space(37 * PI / 180, 500);
    printf("  turned: off by %.1e, far away %.1e m/s and m; friction %.2f J\n", apart(&a, &b), apart(&a, &c), a.lost);
    ck_assert_double_gt(a.lost, 1);
    ck_assert_double_le(apart(&a, &b), 1e-10);
    ck_assert_double_le(apart(&a, &c), 1e-9);
}
END_TEST

// ------------------------------------------------------------------------------------------ what stands still

static brunt_body_def *block(brunt_world_def *def, const char *name, bool points, const double low[3],
                             const double high[3]) {
    brunt_body_def *b = def_box(def, name, low, high);
    if (!points) b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.125;
    return b;
}

static brunt_group_def *hold(brunt_world_def *def, const char *body, brunt_group_action action) {
    if (!def->groups) def->groups = brunt_def_alloc(DEF_CAPACITY * sizeof *def->groups);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "surface");
    g->action = action;
    return g;
}

static brunt_world_def begin(brunt_integrator integrator, double step) {
    brunt_world_def def = def_begin(2, cell);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    go_implicit(&def, integrator, step);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.02, def.contact.friction = 0.3;
    return def;
}

static double greatest(brunt_world *world, int body, const char *field) {
    double *v = world_field(world, body, field), most = 0;
    const int32_t at = brunt_body_find_field(world, body, field);
    const brunt_field_info info = brunt_body_field(world, body, at);
    for (int64_t i = 0; i < brunt_body_size(world, body, info.at) * info.components; i++) most = fmax(most, fabs(v[i]));
    free(v);
    return most;
}

// A mesh that meets itself, and points, rest in free space while another body flies by at 10 m/s: they do not move.
// They are 0.03 m apart, more than the barrier's distance (0), or that exactly (1), where it has no force yet.
START_TEST(what_nothing_touches_stays) {
    const double gap = _i % 2 ? 0.02 : 0.03;
    brunt_world_def def = begin(_i / 2 ? BRUNT_NEWMARK : BRUNT_EULER, 5e-3);
    block(&def, "a", true, XYZ(0, 0, 0), XYZ(0.5, 0.5, 0));
    block(&def, "b", false, XYZ(0, -0.5 - gap + 0.03125, 0), XYZ(0.5, -gap + 0.03125, 0)); // points are 1/32 m inside
    def_velocity(block(&def, "c", false, XYZ(-2, 1, 0), XYZ(-1.5, 1.5, 0)), 10, 0, 0);
    def.contact.pairs = brunt_def_alloc(sizeof *def.contact.pairs), def.contact.pair_count = 1;
    def.contact.pairs[0] = (brunt_pair_def){.a = "b", .b = "b", .method = BRUNT_CONTACT_BARRIER, .friction = 0.3};
    brunt_world *world = world_take(&def);
    world_steps(world, 60);
    for (int b = 0; b < 2; b++) {
        printf("  velocities up to %.1e, strains %.1e\n", greatest(world, b, "velocity"), greatest(world, b, "stress"));
        ck_assert_double_le(greatest(world, b, "velocity"), 1e-13); // rounding, of 37 m/s of their waves
    }
    brunt_world_destroy(world);
}
END_TEST

// A body that is drawn, by a velocity or a displacement, into one at rest that nothing holds, of points (even) or
// elements: what that gains is the impulse between them, and the other way round with the roles of "prescribed" and
// "thrown" changed the relative velocity at the end is the same, by the frame that moves. Of points within their grid's
// errors.
static double rebound(bool points, bool drawn, brunt_integrator integrator) {
    brunt_world_def def = begin(integrator, 2e-3);
    brunt_body_def *b = block(&def, "b", points, XYZ(0, 0.03, 0), XYZ(0.5, 0.53, 0));
    block(&def, "c", false, XYZ(-0.25, -0.5, 0), XYZ(0.75, 0, 0));
    brunt_group_def *held = hold(&def, "c", BRUNT_GROUP_VELOCITY);
    if (drawn)
        held->value[1] = 2;
    else
        def_velocity(b, 0, -2, 0);
    brunt_world *world = world_take(&def);
    const double before = world_sums(world, 0).velocity[1];
    world_steps(world, 150);
    const brunt_body_sums s = world_sums(world, 0);
    const double impulse = world_pair(world, 0).impulse[1];
    ck_assert_double_le(fabs(s.mass * (s.velocity[1] - before) + impulse), 1e-8 * s.mass);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
    return s.velocity[1] - (drawn ? 2 : 0);
}

START_TEST(either_may_be_moved) {
    const bool points = _i % 2 == 0;
    const brunt_integrator integrator = _i / 2 ? BRUNT_NEWMARK : BRUNT_EULER;
    const double drawn = rebound(points, true, integrator), thrown = rebound(points, false, integrator);
    printf("  %s, %s: %.9f m/s from what is drawn, %.9f from what stands\n", points ? "points" : "elements",
           integrator == BRUNT_NEWMARK ? "newmark" : "euler", drawn, thrown);
    ck_assert_double_gt(thrown, 0.5);
    ck_assert_double_le(fabs(drawn - thrown), points ? 0.05 : 1e-9);
}
END_TEST

// Bodies in a closed box of planes (0) or of a held mesh (1), without gravity, by steps in which they could leave it:
// they stay inside, and have no more energy than at the start.
START_TEST(in_a_closed_box) {
    brunt_world_def def = begin(BRUNT_EULER, _i / 2 ? 0.3 : 0.01);
    def.contact.friction = 0;
    def_velocity(block(&def, "a", true, XYZ(0, 0, 0), XYZ(0.5, 0.5, 0)), 3, 2, 0);
    def_velocity(block(&def, "b", false, XYZ(0.6, 0.6, 0), XYZ(0.85, 0.85, 0)), -2, 3, 0);
    for (int k = 0; k < 4; k++) {
        const double n[3] = {k == 0   ? 1
                             : k == 1 ? -1
                                      : 0,
                             k == 2   ? 1
                             : k == 3 ? -1
                                      : 0,
                             0},
                     at[3] = {k == 1 ? 1 : -0.1, k == 3 ? 1 : -0.1, 0},
                     low[3] = {k == 1 ? 1 : -0.35, k == 3 ? 1 : -0.35, 0},
                     high[3] = {k == 0 ? -0.1 : 1.25, k == 2 ? -0.1 : 1.25, 0};
        static const char *const names[] = {"w0", "w1", "w2", "w3"};
        if (_i % 2) {
            block(&def, names[k], false, low, high)->size = 0.25;
            hold(&def, names[k], BRUNT_GROUP_VELOCITY);
        } else {
            def_plane(&def, at, n, BRUNT_SEPARATE, 0);
        }
    }
    if (_i % 2) { // walls that overlap do not meet each other
        def.contact.pairs = brunt_def_alloc(6 * sizeof *def.contact.pairs);
        for (int k = 0; k < 4; k++)
            for (int l = k + 1; l < 4; l++) {
                brunt_pair_def *pair = &def.contact.pairs[def.contact.pair_count++];
                pair->method = BRUNT_CONTACT_NONE;
                snprintf(pair->a, sizeof pair->a, "w%d", k), snprintf(pair->b, sizeof pair->b, "w%d", l);
            }
    }
    brunt_world *world = world_take(&def);
    const double energy = world_energy(world).initial;
    double left = energy, most = 0;
    for (int s = 0; s < 100; s++) {
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        ck_assert_double_le(fabs(e.error_relative), 1e-6);
        left = e.kinetic + e.internal + e.contact;
        ck_assert_double_le(left, energy * (1 + 1e-12));
        for (int b = 0; b < 2; b++) {
            double *x = world_field(world, b, "position");
            for (int64_t n = 0; n < brunt_body_size(world, b, b ? BRUNT_AT_NODES : BRUNT_AT_PARTICLES); n++)
                for (int a = 0; a < 2; a++) most = fmax(most, fabs(x[3 * n + a] - 0.45));
            free(x);
        }
    }
    brunt_newton_counts counts;
    brunt_world_newton(world, &counts, NULL);
    printf("  %s, steps of %g s: %.3f of 0.55 m from the middle, %.4f of the energy is left, %g cuts\n",
           _i % 2 ? "meshes" : "planes", _i / 2 ? 0.3 : 0.01, most, left / energy, counts.cuts);
    ck_assert_double_lt(most, 0.55);
    brunt_world_destroy(world);
}
END_TEST

// Friction of 0 is no friction, a turn by 0 and a way of 0 hold as what is held at a velocity of 0 does: the same bits.
START_TEST(nothing_is_nothing) {
    uint64_t hash[5];
    for (int k = 0; k < 5; k++) {
        brunt_world_def def = begin(_i ? BRUNT_NEWMARK : BRUNT_EULER, 2e-3);
        def.contact.friction = 0;
        if (k == 1) {
            def.contact.pairs = brunt_def_alloc(sizeof *def.contact.pairs), def.contact.pair_count = 1;
            def.contact.pairs[0] = (brunt_pair_def){.a = "b", .b = "c", .method = BRUNT_CONTACT_BARRIER, .friction = 0};
        }
        if (k == 2) def.contact.friction_iterations = 4, def.contact.slip_speed = 1;
        def_velocity(block(&def, "b", true, XYZ(0, 0.03, 0), XYZ(0.5, 0.53, 0)), 1, -2, 0);
        block(&def, "c", false, XYZ(-0.25, -0.5, 0), XYZ(0.75, 0, 0));
        brunt_group_def *held = hold(&def, "c",
                                     k == 3   ? BRUNT_GROUP_ROTATION
                                     : k == 4 ? BRUNT_GROUP_DISPLACEMENT
                                              : BRUNT_GROUP_VELOCITY);
        if (k == 3) held->rotation = (brunt_rotation_def){.angle = 0, .axis = {0, 0, 1}, .about = {0.2, 0.1, 0}};
        brunt_world *world = world_take(&def);
        world_steps(world, 40);
        ck_assert_double_gt(fabs(world_pair(world, 0).impulse[1]), 100);
        ck_assert_double_eq(world_energy(world).friction, 0);
        hash[k] = brunt_world_hash(world);
        brunt_world_destroy(world);
    }
    for (int k = 1; k < 5; k++) ck_assert_msg(hash[k] == hash[0], "variant %d", k);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("implicit_looks");
    ADD_LOOP(looks_the_same, 4 * LOOKS);
    ADD_LOOP(looks_the_same_in_space, 1);
    ADD_LOOP(what_nothing_touches_stays, 4);
    ADD_LOOP(either_may_be_moved, 4);
    ADD_LOOP(in_a_closed_box, 4);
    ADD_LOOP(nothing_is_nothing, 2);
    return suite_main(suite);
}
#endif
