// Labels: stability
// Contact of finite-element bodies by the facing facets of each other (augury, all its forms), through the public
// interface: what is kept, what does not get through, what is left alone, and hard cases. tests/README.md has the
// table.
#include "../bench/studies/penetration.h"
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

typedef enum form { AFFINE, SMOOTH, SURFACE, PAPER, FORMS } form;
static const brunt_augury_form form_kind[] = {BRUNT_AUGURY_NODE_TO_FACET, BRUNT_AUGURY_AVERAGED_FACETS,
                                              BRUNT_AUGURY_AVERAGED_SURFACE, BRUNT_AUGURY_PUBLISHED};
static const char *const form_name[] = {"affine", "smooth", "surface", "paper"};

// ------------------------------------------------------------------------------------------ worlds

static brunt_world_def begin(int dimension, form f, double friction) {
    brunt_world_def def = def_begin(dimension, 1);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.form = form_kind[f];
    def.contact.friction = friction;
    return def;
}

static brunt_body_def *mesh_box(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                                brunt_element_kind kind, double size) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = kind, b->size = size;
    return b;
}

static brunt_group_def *hold(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", group);
    return g;
}

static double *node_field(brunt_world *world, int body, const char *name) { // free()
    int32_t field = brunt_body_find_field(world, body, name);
    ck_assert_msg(field >= 0, "there is no field %s", name);
    brunt_field_info info = brunt_body_field(world, body, field);
    double *values = malloc((size_t)(brunt_body_size(world, body, info.at) * info.components) * sizeof *values);
    brunt_body_read(world, body, field, values);
    return values;
}

static int body_named(const brunt_world *world, const char *name) {
    for (int b = 0; b < brunt_body_count(world); b++)
        if (!strcmp(brunt_body_name(world, b), name)) return b;
    ck_abort_msg("there is no body %s", name);
    return -1;
}

static double body_speed(brunt_world *world, int body) {
    double *v = node_field(world, body, "velocity"), most = 0;
    for (int64_t i = 0; i < 3 * brunt_body_nodes(world, body); i++) {
        ck_assert_msg(isfinite(v[i]), "velocity of node %d is not finite", (int)(i / 3));
        most = fmax(most, fabs(v[i]));
    }
    free(v);
    return most;
}

// Velocities are those of the middle of a step, stress of its end: `transfer` has what stress does to them between.
static double stored(const brunt_energy *e) { return e->kinetic + e->internal + e->hourglass + e->transfer; }

// Two cubes of 3 m that meet at 22 degrees (section 3.2 of the paper on contact by APIC transfers), at a third
// of their wave speed.
static brunt_world_def oblique_cubes(form f, brunt_element_kind kind, double friction) {
    brunt_world_def def = begin(3, f, friction);
    const double h = 0.5, low[3] = {-1.5, -1.5, -1.5}, high[3] = {1.5, 1.5, 1.5};
    def_material(&def, "neo-hookean", 2700, 1e8, 0.3);
    brunt_body_def *a = mesh_box(&def, "a", low, high, kind, h), *b = mesh_box(&def, "b", low, high, kind, h);
    def_velocity(a, 0, 35, 0), def_velocity(b, -15, -35, -15);
    b->place = brunt_placement_translate(b->place, XYZ(0, 3.8, 0));
    b->place = brunt_placement_rotate(b->place, XYZ(1, 0, 0), 22 * PI / 180, XYZ(0, 0, 0));
    def.step = 2e-4 * h;
    return def;
}

// A cube of 1 m on a held slab that is wider, under gravity that grows over 0.1 s to strain it by a hundredth or so.
static brunt_world_def block_on_slab(form f, brunt_element_kind kind, double friction, double along) {
    brunt_world_def def = begin(3, f, friction);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh_box(&def, "base", XYZ(-1, -0.5, -1), XYZ(2, 0, 2), kind, 0.5);
    mesh_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 1), kind, 1.0 / 3);
    hold(&def, "base", "ymin");
    def.gravity[0] = along, def.gravity[1] = -10;
    def.gravity_ramp = 0.1;
    return def;
}

// ------------------------------------------------------------------------------------------ impact of free bodies

// Momenta to rounding, an energy account that closes, no energy made, separation, and nothing inside anything.
START_TEST(oblique_impact) {
    // Measured, tet4: 0.008 h, 0.13 h, 0.17 h, 0. Of the forms that average over a cell, corners and edges go in.
    // Hexahedra: 0.41 h, 0.29 h, 0.09 h, 0: one node slides in behind an edge before it faces anything.
    static const double deepest[2][FORMS] = {{0.1, 0.2, 0.2, 0.1}, {0.5, 0.4, 0.2, 0.1}};
    const form f = (form)(_i % FORMS);
    const brunt_element_kind kind = _i / FORMS ? BRUNT_HEX8 : BRUNT_TET4;
    brunt_world_def def = oblique_cubes(f, kind, 0.3);
    brunt_world *world = world_take(&def);
    brunt_gap_probe *probe = brunt_gap_probe_make(world);
    double depth = 0, most = 0, last = 0;
    for (int k = 1; k <= 30; k++) {
        double deep, near;
        world_until(world, 0.003 * k);
        brunt_gap_measure(probe, &deep, &near);
        brunt_energy e = world_energy(world);
        depth = fmax(depth, deep), most = fmax(most, stored(&e) / e.initial);
    }
    brunt_energy e = world_energy(world);
    brunt_momentum p = world_momentum(world);
    brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
    brunt_reaction force = world_pair(world, 0);
    last = stored(&e) / e.initial;
    printf("%s %s: E/E0 %.4f, most %.6f, depth %.4f h, apart at %.1f m/s, drift %.1e %.1e, error %.1e\n", form_name[f],
           brunt_element_name(kind), last, most, depth / 0.5, b.velocity[1] - a.velocity[1], p.linear_drift,
           p.angular_drift, e.error_relative);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    ck_assert_double_lt(most, 1 + 1e-4);
    ck_assert_double_gt(last, f == PAPER ? 0.2 : 0.85);
    ck_assert_double_lt(depth / 0.5, deepest[_i / FORMS][f]);
    ck_assert_double_gt(b.velocity[1] - a.velocity[1], 10);
    // What the account says went from a to b did.
    const double before[3] = {-15, -35, -15};
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(force.impulse[k], b.mass * (b.velocity[k] - before[k]), 100 * ROUNDING * 35 * b.mass);
    ck_assert_double_gt(force.impulse[1], 1e6);
    brunt_gap_probe_free(probe);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is not touched

// Nodes of a body that vibrates beside two that collide, with contact or without it.
static double *bystander(form f, bool contact, int64_t *count) {
    brunt_world_def def = oblique_cubes(f, BRUNT_TET4, 0.3);
    if (!contact) def.contact.method = BRUNT_CONTACT_NONE;
    brunt_body_def *c = mesh_box(&def, "c", XYZ(2.75, 0, -1), XYZ(4.25, 1.5, 0.5), BRUNT_TET4, 0.5);
    c->wave_velocity[1] = 5, c->wave_vector[0] = 2;
    def_velocity(c, 10, 5, -3);
    brunt_world *world = world_take(&def);
    world_steps(world, 300);
    double *v = node_field(world, 2, "velocity"), *x = node_field(world, 2, "position");
    *count = 3 * brunt_body_nodes(world, 2);
    double *both = malloc((size_t)(2 * *count) * sizeof *both);
    memcpy(both, v, (size_t)*count * sizeof *v), memcpy(both + *count, x, (size_t)*count * sizeof *x);
    *count *= 2;
    free(v), free(x);
    brunt_world_destroy(world);
    return both;
}

START_TEST(untouched_bodies_keep_every_bit) {
    const form f = (form)_i;
    int64_t n;
    double *with = bystander(f, true, &n), *without = bystander(f, false, &n);
    bool same = !memcmp(with, without, (size_t)n * sizeof *with);
    ck_assert_int_eq(same, f != PAPER); // the paper's transfers filter every surface, touched or not
    free(with), free(without);
}
END_TEST

// ------------------------------------------------------------------------------------------ threads, restart, order

static uint64_t run_threads(form f, int kind, int threads, bool restart) {
    brunt_world_def def = kind ? oblique_cubes(f, BRUNT_TET4, 0.3) : block_on_slab(f, BRUNT_HEX8, 0.5, 2);
    if (kind)
        for (int b = 0; b < 2; b++) def.bodies[b].place.translation[1] *= 0.92;
    def.threads = threads;
    brunt_world *world = world_from(&def);
    world_steps(world, 150);
    if (restart) {
        brunt_world *other = world_take(&def);
        world_copy_state(world, other);
        brunt_world_destroy(world);
        world = other;
    } else {
        brunt_world_def_free(&def);
    }
    world_steps(world, 150);
    double touched = 0;
    for (int k = 0; k < 3; k++) touched = fmax(touched, fabs(world_pair(world, 0).impulse[k]));
    ck_assert_double_gt(touched, 0);
    uint64_t hash = brunt_world_hash(world);
    brunt_world_destroy(world);
    return hash;
}

START_TEST(same_bits_for_threads_and_restart) {
    const form f = (form)(_i % FORMS);
    const int kind = _i / FORMS;
    const uint64_t one = run_threads(f, kind, 1, false);
    ck_assert_uint_eq(run_threads(f, kind, 2, false), one);
    ck_assert_uint_eq(run_threads(f, kind, 3, false), one);
    ck_assert_uint_eq(run_threads(f, kind, 1, true), one);
    ck_assert_uint_eq(run_threads(f, kind, 2, true), one);
}
END_TEST

// `count` cubes about a corner or an edge that all share, each thrown at it, named in the order given; the velocity and
// centre of the cube at each place, and the momentum drift.
static double cubes_about(form f, brunt_touch_kind touch, int count, bool backwards, double (*out)[6]) {
    brunt_world_def def = begin(3, f, 0.2);
    def.contact.touch = touch;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int k = 0; k < count; k++) {
        int i = k & 1, j = k >> 1 & 1, l = k >> 2;
        double low[3] = {i ? 0.01 : -1.01, j ? 0.013 : -1.013, l ? 0.007 : count > 4 ? -1.007 : -0.5}, high[3];
        for (int a = 0; a < 3; a++) high[a] = low[a] + 1;
        char name[16];
        snprintf(name, sizeof name, "b%d", backwards ? count - 1 - k : k);
        brunt_body_def *b = mesh_box(&def, name, low, high, BRUNT_TET4, 0.5);
        def_velocity(b, i ? -2 : 2, j ? -1.5 : 1.5, count > 4 ? (l ? -1 : 1) : 0);
        b->place = brunt_placement_rotate(b->place, XYZ(1, 2, 3), 0.03 * (k - 1), XYZ(0, 0, 0));
    }
    def.step = 1e-3;
    brunt_world *world = world_take(&def);
    world_steps(world, 60);
    for (int k = 0; k < count; k++) {
        char name[16];
        snprintf(name, sizeof name, "b%d", backwards ? count - 1 - k : k);
        brunt_body_sums s = world_sums(world, body_named(world, name));
        memcpy(out[k], s.velocity, sizeof s.velocity), memcpy(out[k] + 3, s.centre, sizeof s.centre);
    }
    brunt_momentum p = world_momentum(world);
    double scale = 0, drift = 0; // the total is near zero: relative to one cube's
    for (int a = 0; a < 3; a++) {
        scale = fmax(scale, 1000 * 2.0);
        drift = fmax(drift, fabs(p.linear[a] - p.linear_initial[a]) / scale);
        drift = fmax(drift, fabs(p.angular[a] - p.angular_initial[a]) / scale);
    }
    brunt_energy e = world_energy(world);
    ck_assert_double_lt(stored(&e), e.initial * (1 + 1e-6));
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(world);
    return drift;
}

START_TEST(order_of_bodies_does_not_matter) {
    static const int counts[] = {3, 4, 8};
    const form f = (form)(_i % FORMS);
    const int count = counts[_i / FORMS % 3];
    const brunt_touch_kind touch = _i / FORMS < 3 ? BRUNT_TOUCH_ELASTIC : BRUNT_TOUCH_INELASTIC;
    double one[8][6], two[8][6], far = 0;
    double drift = cubes_about(f, touch, count, false, one);
    drift = fmax(drift, cubes_about(f, touch, count, true, two));
    for (int k = 0; k < count; k++)
        for (int a = 0; a < 6; a++) far = fmax(far, fabs(one[k][a] - two[k][a]));
    printf("%s, %d cubes about a point: other order %.1e, drift %.1e\n", form_name[f], count, far, drift);
    ck_assert_double_lt(drift, 100 * ROUNDING);
    ck_assert_double_gt(fabs(one[0][0] - 2), 0.1);     // they met
    const bool in_order = f == SMOOTH || f == SURFACE; // they take pair after pair
    ck_assert_double_lt(far, in_order ? 0.2 : 1e3 * ROUNDING);
}
END_TEST

// ------------------------------------------------------------------------------------------ friction

// Slip of the middle of the block's base over the slab, per the way a free block would go.
START_TEST(friction_at_its_limits) {
    const form f = (form)(_i % PAPER);
    const bool sticks = _i >= PAPER;
    const double along = 2, end = 0.4;
    brunt_world_def def = block_on_slab(f, BRUNT_HEX8, sticks ? 1e6 : 0, along);
    brunt_world *world = world_take(&def);
    brunt_body_sums start = world_sums(world, 1);
    world_until(world, end);
    brunt_body_sums now = world_sums(world, 1);
    brunt_reaction force = world_pair(world, 0);
    // Gravity that grows over T: way of a body that slides freely.
    double T = 0.1, after = end - T, way = along * (T * T / 6 + T / 2 * after + after * after / 2);
    double went = now.centre[0] - start.centre[0];
    printf("%s, friction %s: went %.5f of %.5f m, tangential over normal impulse %.1e, friction work %.1e\n",
           form_name[f], sticks ? "1e6" : "0", went, way, fabs(force.impulse[0] / force.impulse[1]),
           force.friction_work);
    if (sticks) {
        ck_assert_double_lt(fabs(went), 0.02); // its own shear
    } else {
        ck_assert_double_eq(force.friction_work, 0);
        ck_assert_double_eq_tol(went / way, 1, 0.03); // normals of the deformed surfaces are not quite upright
    }
    brunt_world_destroy(world);
}
END_TEST

// The same on a plane, which does not deform: nothing tangential at all.
START_TEST(plane_without_friction) {
    brunt_world_def def = begin(3, AFFINE, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 1), BRUNT_HEX8, 1.0 / 3);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    def.gravity[1] = -10, def.gravity[0] = 2;
    brunt_world *world = world_take(&def);
    world_until(world, 0.2);
    brunt_reaction force = world_boundary(world, 0);
    ck_assert_double_gt(force.impulse[1], 0);
    ck_assert_double_eq(force.impulse[0], 0);
    ck_assert_double_eq(force.impulse[2], 0);
    ck_assert_double_eq(force.friction_work, 0);
    brunt_world_destroy(world);
}
END_TEST

// The threshold of sliding on a slope of 30 degrees, as far as an elastic block that rings lets it be seen: a
// hundredth.
START_TEST(threshold_of_sliding) {
    const bool slides = !_i;
    const double slope = PI / 6, mu = tan(slope) * (slides ? 0.99 : 1.01), g = 10, T = 1, end = 2;
    brunt_world_def def = begin(3, AFFINE, mu);
    brunt_material_def *m = def_material(&def, "neo-hookean", 1000, 1e8, 0.3);
    brunt_error error;
    ck_assert_int_eq(brunt_material_set(m, "viscosity", 0, NULL, &error), BRUNT_OK);
    mesh_box(&def, "base", XYZ(-0.5, -0.25, -0.75), XYZ(2, 0, 0.75), BRUNT_HEX8, 0.5);
    mesh_box(&def, "block", XYZ(0, 0, -0.5), XYZ(1, 1, 0.5), BRUNT_HEX8, 0.5);
    hold(&def, "base", "ymin");
    def.gravity[0] = g * sin(slope), def.gravity[1] = -g * cos(slope), def.gravity_ramp = T;
    brunt_world *world = world_take(&def);
    world_until(world, T);
    brunt_body_sums start = world_sums(world, 1);
    world_until(world, end);
    brunt_body_sums now = world_sums(world, 1);
    double t = end - T, a = g * fmax(0, sin(slope) - mu * cos(slope)), way = a * (T / 2 * t + t * t / 2);
    double went = now.centre[0] - start.centre[0];
    printf("friction %s the threshold by a hundredth: went %.4f m, %.4f by Coulomb's law\n", slides ? "below" : "above",
           went, way);
    if (slides)
        ck_assert_double_eq_tol(went / way, 1, 0.2);
    else
        ck_assert_double_lt(fabs(went), 0.15 * g * 0.01 * sin(slope) * (T / 2 * t + t * t / 2));
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ touching, overlapping,
// fast

// Two equal meshes of cubes, one on the other: nodes coincide, or lie in each other by `overlap` [m].
static brunt_world_def touching(form f, brunt_element_kind kind, double overlap) {
    brunt_world_def def = begin(3, f, 0.3);
    def.contact.allow_overlap = true;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, 1), kind, 0.5);
    mesh_box(&def, "b", XYZ(0, 1 - overlap, 0), XYZ(1, 2 - overlap, 1), kind, 0.5);
    return def;
}

START_TEST(touching_at_the_start_stays_quiet) {
    brunt_world_def def = touching((form)(_i % FORMS), _i / FORMS ? BRUNT_HEX8 : BRUNT_TET4, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, 200);
    double most = 0;
    for (int b = 0; b < 2; b++) most = fmax(most, body_speed(world, b));
    for (int k = 0; k < 3; k++) most = fmax(most, fabs(world_pair(world, 0).impulse[k]));
    hard_case("C07", most, 0, 0, "nodes on nodes, %s, %s: speed [m/s] or impulse [N s]", form_name[_i % FORMS],
              _i / FORMS ? "hex8" : "tet4");
    brunt_world_destroy(world);
}
END_TEST

// Overlapping meshes make no more energy than it would take to press them that far into each other, at rest and when
// they meet.
START_TEST(overlap_makes_no_energy) {
    static const double overlaps[] = {0.01, 0.1};
    const form f = (form)(_i % FORMS);
    const double h = 0.5, overlap = overlaps[_i / FORMS % 2] * h, speed = _i / FORMS / 2 ? 1 : 0;
    brunt_world_def def = touching(f, BRUNT_TET4, overlap);
    def_velocity(&def.bodies[0], 0, speed / 2, 0), def_velocity(&def.bodies[1], 0, -speed / 2, 0);
    brunt_world *world = world_take(&def);
    double most = 0, pressed = 1e6 * overlap * overlap / (2 * 2), fastest = 0; // E A d^2 / (2 L)
    for (int k = 0; k < 60; k++) {
        world_steps(world, 10);
        brunt_energy e = world_energy(world);
        most = fmax(most, stored(&e) - e.initial - fmax(e.error, 0)); // the integrator's own error is asserted below
        fastest = fmax(fastest, fmax(body_speed(world, 0), body_speed(world, 1)));
    }
    brunt_energy e = world_energy(world);
    printf("%s, overlap %g h, %g m/s: made %.2e J, pressing them would take %.2e J, fastest %.2f m/s\n", form_name[f],
           overlap / h, speed, most, pressed, fastest);
    if (f == AFFINE) {
        hard_case("C17", fmax(0, most) / pressed, 1, 1,
                  "meshes, overlap %g h, %g m/s: energy made [of what pressing takes]", overlap / h, speed);
    }
    ck_assert_double_lt(most, ROUNDING * (e.initial + pressed)); // far below what pressing them would take
    ck_assert_double_lt(fabs(e.error), 1e-3 * fmax(e.initial, pressed));
    brunt_world_destroy(world);
}
END_TEST

// A block thrown at another so fast that it covers half an edge, 0.9 or 2.5 edges in a step: wherever it is when the
// step that meets begins, its nodes do not come through. From one edge on its own elements cannot follow, which must be
// said.
START_TEST(fast_bodies_do_not_pass) {
    static const double ways[] = {0.5, 0.9, 2.5};
    const form f = (form)(_i % PAPER);
    const double h = 0.5, dt = 1e-3, way = ways[_i / PAPER];
    double deepest = 0, least = INFINITY, most = 0;
    for (int k = 0; k < 8; k++) {
        brunt_world_def def = begin(3, f, 0.3);
        def_material(&def, "neo-hookean", 1000, 1e4, 0.3);
        mesh_box(&def, "a", XYZ(0, 0, 0), XYZ(1.5, 1.5, 1.5), BRUNT_TET4, h);
        double gap = (k + 0.01) / 8 * way * h;
        brunt_body_def *b = mesh_box(&def, "b", XYZ(0.21, 1.5 + gap, 0.13), XYZ(1.21, 2.5 + gap, 1.13), BRUNT_TET4, h);
        def_velocity(b, 0, -way * h / dt, 0);
        def.step = dt;
        brunt_world *world = world_take(&def);
        brunt_gap_probe *probe = brunt_gap_probe_make(world);
        brunt_error error = {0};
        double depth, near;
        int status = brunt_world_step(world, INFINITY, &error);
        if (status) ck_assert_ptr_nonnull(strstr(error.message, "inside out"));
        brunt_gap_measure(probe, &depth, &near);
        deepest = fmax(deepest, depth);
        // What would have gone in is stopped: the momentum of the nodes that meet, by their share of the way.
        double stopped = world_pair(world, 0).impulse[1] * dt / ((way - gap / h) * h);
        least = fmin(least, stopped), most = fmax(most, stopped);
        brunt_gap_probe_free(probe);
        brunt_world_destroy(world);
    }
    printf("%s, %g edges a step: stopped %.1f to %.1f kg, depth %.4f h\n", form_name[f], way, least, most, deepest / h);
    if (way < 1 && f == AFFINE) {
        hard_case("C03", deepest / h, 0.1, 0.1, "meshes, %g of an edge in a step: depth [edges]", way);
    } else if (way < 1) {
        ck_assert_double_lt(deepest, 0.2 * h);
    }
    if (f == AFFINE) ck_assert_double_lt(most / least, 1.2); // the others look no further than their cells
    if (way < 1) ck_assert_double_gt(least, 0.3 * most);
}
END_TEST

// C25. A block that falls on a held slab, leaves it further than contact looks, and comes back, again and again: what
// was known of the distances of its nodes before they parted is forgotten. In either order of the bodies.
START_TEST(bodies_that_part_meet_again) {
    brunt_world_def def = begin(2, AFFINE, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh_box(&def, _i ? "a" : "b", XYZ(-0.1, 0.02, 0), XYZ(0.1, 0.22, 0), BRUNT_QUAD4, 0.02);
    mesh_box(&def, _i ? "b" : "a", XYZ(-0.5, -0.1, 0), XYZ(0.5, 0, 0), BRUNT_QUAD4, 0.025);
    hold(&def, _i ? "b" : "a", "ymin");
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    const int block = _i ? 0 : 1;
    double lowest = 1, highest = 0, speed = -1;
    int rebounds = 0;
    while (brunt_world_time(world) < 1) {
        world_steps(world, 1);
        const brunt_body_sums s = world_sums(world, block);
        lowest = fmin(lowest, s.low[1]);
        if (rebounds) highest = fmax(highest, s.low[1]);
        rebounds += speed < -0.1 && s.velocity[1] > 0;
        if (fabs(s.velocity[1]) > 0.1 || s.velocity[1] > 0) speed = s.velocity[1];
    }
    printf("block %d: %d rebounds, as high as %.4f m, as low as %.4f m\n", block, rebounds, highest, lowest);
    ck_assert_int_ge(rebounds, 3);
    ck_assert_double_gt(highest, 0.01); // past half an edge
    hard_case("C25", -lowest / 0.025, 0.1, 0.1, "block that comes back, body %d: depth [edges]", block);
    brunt_world_destroy(world);
}
END_TEST

// A long slanted plate whose box holds two blocks that meet, without being near them, must not keep contact from seeing
// them.
START_TEST(a_box_around_changes_nothing) {
    double depth[2] = {0};
    for (int with = 0; with < 2; with++) {
        brunt_world_def def = begin(3, AFFINE, 0);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        mesh_box(&def, "b", XYZ(0, 0, 0), XYZ(1, 1, 1), BRUNT_TET4, 0.5);
        brunt_body_def *c = mesh_box(&def, "c", XYZ(0.1, 1.05, 0.1), XYZ(1.1, 2.05, 1.1), BRUNT_TET4, 0.5);
        def_velocity(c, 0, -1, 0);
        if (with) {
            brunt_body_def *a = mesh_box(&def, "a", XYZ(-0.1, -3, -1), XYZ(0.1, 3, 2), BRUNT_TET4, 0.5);
            a->place = brunt_placement_rotate(a->place, XYZ(0, 0, 1), PI / 4, XYZ(0, 0, 0));
            a->place = brunt_placement_translate(a->place, XYZ(-0.75, -0.75, 0));
        }
        def.step = 1e-3;
        brunt_world *world = world_take(&def);
        brunt_gap_probe *probe = brunt_gap_probe_make(world);
        for (int k = 0; k < 60; k++) {
            double deep, near;
            world_steps(world, 5);
            brunt_gap_measure(probe, &deep, &near);
            depth[with] = fmax(depth[with], deep / 0.5);
        }
        brunt_gap_probe_free(probe);
        brunt_world_destroy(world);
    }
    printf("depth %.4f h, within the box of a third body %.4f h\n", depth[0], depth[1]);
    ck_assert_double_lt(depth[0], 0.01);
    ck_assert_double_lt(depth[1], 0.01);
}
END_TEST

// ------------------------------------------------------------------------------------------ loads through contact

// A uniform pressure through an interface with edges of 0.5 m on one side and 0.05 m on the other (quadrilaterals,
// Poisson's ratio 0, so that the exact stress is uniform): greatest error of the mean stress of a row of elements, and
// of one element.
static void press(form f, bool fine_below, double *row, double *one, double *force_error) {
    const double p = 1e4;
    brunt_world_def def = begin(2, f, 0);
    brunt_material_def *m = def_material(&def, "neo-hookean", 1000, 1e6, 0);
    brunt_error error;
    ck_assert_int_eq(brunt_material_set(m, "viscosity", 0, NULL, &error), BRUNT_OK);
    mesh_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 0.5, 0), BRUNT_QUAD4, fine_below ? 0.05 : 0.5);
    mesh_box(&def, "b", XYZ(0, 0.5, 0), XYZ(1, 1, 0), BRUNT_QUAD4, fine_below ? 0.5 : 0.05);
    hold(&def, "a", "ymin");
    brunt_group_def *top = hold(&def, "b", "ymax");
    top->action = BRUNT_GROUP_PRESSURE, top->value[0] = p;
    top->table.points = brunt_def_alloc(2 * sizeof *top->table.points), top->table.count = 2;
    top->table.points[1][0] = 1.0, top->table.points[1][1] = 1; // 30 periods
    brunt_world *world = world_take(&def);
    const int fine = fine_below ? 0 : 1;
    const int64_t count = brunt_body_elements(world, fine), coarse = brunt_body_elements(world, 1 - fine);
    double *mean = calloc((size_t)count, sizeof *mean), other = 0, force = 0;
    enum { SAMPLES = 40 };
    world_until(world, 1.2);
    for (int k = 0; k < SAMPLES; k++) {
        world_until(world, 1.2 + 0.0093 * k);
        double *s = node_field(world, fine, "stress"), *t = node_field(world, 1 - fine, "stress");
        for (int64_t e = 0; e < count; e++) mean[e] += s[6 * e + 1] / SAMPLES;
        for (int64_t e = 0; e < coarse; e++) other += t[6 * e + 1] / SAMPLES / (double)coarse;
        force += world_pair(world, 0).force[1] / SAMPLES;
        free(s), free(t);
    }
    // Rows of 20 of the fine mesh along x, in the order of the elements.
    *one = 0, *row = fabs(other / p + 1), *force_error = fabs(force / p - 1);
    for (int64_t r = 0; r < count; r += 20) {
        double sum = 0;
        for (int64_t e = r; e < r + 20; e++) sum += mean[e] / 20, *one = fmax(*one, fabs(mean[e] / p + 1));
        *row = fmax(*row, fabs(sum / p + 1));
    }
    free(mean);
    brunt_world_destroy(world);
}

START_TEST(pressure_through_unequal_meshes) {
    const form f = (form)(_i % FORMS);
    const bool fine_below = _i / FORMS;
    double row, one, force;
    press(f, fine_below, &row, &one, &force);
    printf("%s, edges 10:1, fine mesh %s: rows %.2f %%, element %.1f %%, force %.2f %%\n", form_name[f],
           fine_below ? "below" : "above", 100 * row, 100 * one, 100 * force);
    if (f == AFFINE)
        hard_case("C22", one, 0.02, 0.02, "%s",
                  fine_below ? "edges 10:1, the fine mesh below: stress of one element, relative"
                             : "edges 10:1, the fine mesh above: stress of one element, relative");
    ck_assert_double_lt(force, 0.05);
}
END_TEST

// Weight of what stands on a slab in the mean force of the pair.
START_TEST(weight_of_a_block) {
    brunt_world_def def = block_on_slab((form)_i, BRUNT_HEX8, 0.5, 0);
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    double from = world_pair(world, 0).impulse[1], begun = brunt_world_time(world);
    brunt_body_sums before = world_sums(world, 1);
    world_until(world, 3);
    brunt_body_sums after = world_sums(world, 1);
    double impulse = world_pair(world, 0).impulse[1] - from, time = brunt_world_time(world) - begun;
    printf("%s: mean force %.2f N of 10000 N\n", form_name[_i], impulse / time);
    ck_assert_double_eq_tol(impulse / time, 1e4, 100); // it swings
    ck_assert_double_eq_tol(impulse, 1e4 * time + after.momentum[1] - before.momentum[1], 2);
    brunt_world_destroy(world);
}
END_TEST

// A plate moved by a prescribed velocity pushes a block: it does not slow down, and its work is the energy the block
// has.
START_TEST(a_plate_pushes) {
    const form f = (form)_i;
    brunt_world_def def = begin(3, f, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    mesh_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 1), BRUNT_TET4, 0.5);
    mesh_box(&def, "plate", XYZ(-0.3, -0.6, -0.3), XYZ(1.3, -0.1, 1.3), BRUNT_HEX8, 0.5);
    def_velocity(&def.bodies[1], 0, 2, 0);
    brunt_group_def *push = hold(&def, "plate", "surface");
    push->value[1] = 2;
    brunt_world *world = world_take(&def);
    brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.3);
    brunt_body_sums after = world_sums(world, 0);
    brunt_reaction work = world_boundary(world, 0), pair = world_pair(world, 0);
    brunt_energy e = world_energy(world);
    double gained =
        e.kinetic + e.internal + e.hourglass - e.initial + e.contact + e.friction + e.transfer + e.viscosity;
    double *v = node_field(world, 1, "velocity");
    for (int64_t n = 0; n < brunt_body_nodes(world, 1); n++) ck_assert_double_eq_tol(v[3 * n + 1], 2, 4e-7);
    free(v);
    printf("%s: work of the plate %.4f J, gained %.4f J, block at %.3f m/s\n", form_name[f], e.external_work, gained,
           after.velocity[1]);
    ck_assert_double_gt(after.velocity[1], 1.9);
    ck_assert_double_eq_tol(e.external_work, gained, 2e-3 * e.external_work);
    ck_assert_double_eq_tol(fabs(pair.impulse[1]), before.mass * after.velocity[1], 1e3 * ROUNDING * before.mass);
    ck_assert_double_eq_tol(work.impulse[1], before.mass * after.velocity[1], 1e3 * ROUNDING * before.mass);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ particles, crowds

// A ball of particles on a block of elements: momentum to rounding, energy accounted for, apart in the end.
START_TEST(mesh_meets_particles) {
    const int dim = 2 + _i;
    brunt_world_def def = begin(dim, AFFINE, 0.3);
    def.cell = 0.1;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *ball = def_ball(&def, "ball", XYZ(0.43, 0.86, 0.38), 0.3);
    mesh_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 0.5, 0.8), dim == 2 ? BRUNT_QUAD4 : BRUNT_HEX8, 0.125);
    def_velocity(ball, 0.5, -4, 0);
    brunt_world *world = world_take(&def);
    double most = 0;
    for (int k = 1; k <= 20; k++) {
        world_until(world, 0.01 * k);
        brunt_energy e = world_energy(world);
        most = fmax(most, stored(&e) / e.initial);
    }
    brunt_momentum p = world_momentum(world);
    brunt_energy e = world_energy(world);
    brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
    printf("%dD particles on a mesh: drift %.1e %.1e, E/E0 %.3f, most %.6f, error %.1e, apart at %.2f m/s\n", dim,
           p.linear_drift, p.angular_drift, stored(&e) / e.initial, most, e.error_relative,
           a.velocity[1] - b.velocity[1]);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    ck_assert_double_lt(p.angular_drift, 1e-3);
    ck_assert_double_lt(fabs(e.error_relative), 2e-3);
    ck_assert_double_lt(most, 1 + 1e-4);
    ck_assert_double_gt(a.velocity[1] - b.velocity[1], 1);
    brunt_world_destroy(world);
}
END_TEST

// Twelve bodies have 66 pairs: one account has them all, and momentum is kept.
START_TEST(a_crowd_has_one_account) {
    brunt_world_def def = begin(3, (form)_i, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int k = 0; k < 12; k++) {
        char name[16];
        snprintf(name, sizeof name, "c%02d", k);
        double low[3] = {1.03 * (k % 3), 1.04 * (k / 6), 1.02 * (k / 3 % 2)}, high[3];
        for (int a = 0; a < 3; a++) high[a] = low[a] + 1;
        brunt_body_def *b = mesh_box(&def, name, low, high, BRUNT_HEX8, 0.5);
        def_velocity(b, 2 * (1.5 - low[0]) + 3, 3 * (1 - low[1]), 4 * (1 - low[2]));
    }
    brunt_world *world = world_take(&def);
    ck_assert_int_eq(brunt_pair_count(world), 1);
    ck_assert_str_eq(world_pair(world, 0).name, "all");
    world_steps(world, 200);
    brunt_momentum p = world_momentum(world);
    brunt_energy e = world_energy(world);
    printf("%s, 12 cubes: drift %.1e %.1e, E/E0 %.3f, error %.1e\n", form_name[_i], p.linear_drift, p.angular_drift,
           stored(&e) / e.initial, e.error_relative);
    ck_assert_double_gt(fabs(world_pair(world, 0).normal_work), 0);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("surfaces");
    ADD_LOOP(oblique_impact, 2 * FORMS);
    ADD_LOOP(untouched_bodies_keep_every_bit, FORMS);
    ADD_LOOP(same_bits_for_threads_and_restart, 2 * FORMS);
    ADD_LOOP(order_of_bodies_does_not_matter, 6 * FORMS);
    ADD_LOOP(friction_at_its_limits, 2 * PAPER);
    ADD(plane_without_friction);
    ADD_LOOP(threshold_of_sliding, 2);
    ADD_LOOP(touching_at_the_start_stays_quiet, 2 * FORMS);
    ADD_LOOP(overlap_makes_no_energy, 4 * FORMS);
    ADD_LOOP(fast_bodies_do_not_pass, 3 * PAPER);
    ADD_LOOP(bodies_that_part_meet_again, 2);
    ADD(a_box_around_changes_nothing);
    ADD_LOOP(pressure_through_unequal_meshes, 2 * FORMS);
    ADD_LOOP(weight_of_a_block, FORMS);
    ADD_LOOP(a_plate_pushes, FORMS);
    ADD_LOOP(mesh_meets_particles, 2);
    ADD_LOOP(a_crowd_has_one_account, FORMS);
    return suite_main(suite);
}
