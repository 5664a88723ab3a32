// What the search for contact remembers of nodes from step to step saves work and changes nothing: a world that forgets
// it before every step comes to the same bits, and so does one that leaves nothing out of the search. Nor
// does what is not made of faces that are near nothing.
#include "contact/distance/point_facet.h"
#include "contact/search/node_to_facet_parts.h"
#include "world/world.h"
#include "tests/support/hard_world.h"

enum { STEPS = 120, CASES = 8 };

// In either order of the bodies: a plate that slides over one that is held, under a pressure that bends both out at
// their rims; a fine block that hits a coarse one and leaves it again; the plates on a floor; and a plate that slides
// from one onto another, node on node, beside whose edges facets are as near for long: four about a corner, or more
// than are listed.
static void add_plate(brunt_world_def *def, const char *name, brunt_element_kind element, const double low[3],
                      const double high[3]) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = element, b->size = element == BRUNT_TET4 ? 0.7 : 1;
    brunt_group_def *held = &def->groups[def->group_count++];
    *held = brunt_group_def_default();
    snprintf(held->body, sizeof held->body, "%s", name), snprintf(held->group, sizeof held->group, "ymin");
}

static brunt_world *make_over(int first) {
    const brunt_element_kind element = first ? BRUNT_TET4 : BRUNT_HEX8;
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e9, 0.3);
    def.groups = brunt_alloc(2 * sizeof *def.groups);
    if (first) add_plate(&def, "near", element, XYZ(0, 0, 0), XYZ(8, 2, 12));
    brunt_body_def *b = def_box(&def, "over", XYZ(4, 2, 1), XYZ(8, 4, 11));
    b->method = BRUNT_FEM, b->element = element, b->size = 1;
    def_velocity(b, 90, -5, 3);
    if (!first) add_plate(&def, "near", element, XYZ(0, 0, 0), XYZ(8, 2, 12));
    add_plate(&def, "next", element, XYZ(8.02, 0, 0), XYZ(18, 2, 12));
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.gravity[1] = -2e4;
    return world_take(&def);
}

static brunt_world *make(int which) {
    if (which / 2 == 3) return make_over(which % 2);
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e9, 0.3);
    const int first = which % 2;
    const bool blocks = which / 2 == 1, floor = which / 2 == 2;
    for (int i = 0; i < 2; i++) {
        const bool lower = i == first;
        brunt_body_def *b =
            blocks ? def_box(&def, lower ? "low" : "high", XYZ(lower ? 0 : 2.3, lower ? 0 : 4.9, lower ? 0 : 1.7),
                             XYZ(lower ? 12 : 6.3, lower ? 4 : 8.9, lower ? 12 : 5.7))
                   : def_box(&def, lower ? "low" : "high", XYZ(0, lower ? 0 : 2, 0), XYZ(26, lower ? 2 : 4, 26));
        b->method = BRUNT_FEM, b->element = BRUNT_HEX8;
        b->size = blocks && lower ? 2 : blocks ? 0.5 : lower ? 1 : 1.3;
        if (!lower) def_velocity(b, 40, blocks ? -120 : -5, 13);
        if (lower) def_velocity(b, floor ? 2 : 0, floor ? -1 : 0, 0);
    }
    if (!blocks && !floor) {
        def.groups = brunt_alloc(sizeof *def.groups);
        brunt_group_def *held = &def.groups[def.group_count++];
        *held = brunt_group_def_default();
        snprintf(held->body, sizeof held->body, "low"), snprintf(held->group, sizeof held->group, "ymin");
    }
    if (floor) def_plane(&def, XYZ(0, -0.01, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.2);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = 0.1;
    def.gravity[1] = blocks ? 0 : -2e4;
    return world_take(&def);
}

static void forget(brunt_world *world) {
    brunt_node_to_facet *f = world->contact.node_to_facet;
    for (int32_t n = 0; f && n < world->contact.surface.node_count; n++)
        f->cache.node[n] = (node_distance){0}, f->cache.nearest[n] = -1;
}

// What is listed beside a node is all that is nearer than is said of that body, as it was before the step.
static int32_t count_unlisted(const brunt_contact *contact) {
    const brunt_contact_surface *s = &contact->surface;
    int32_t unlisted = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        const double beyond = contact->node_to_facet->cache.node[n].beyond;
        const int32_t *beside = contact->node_to_facet->cache.beside[n];
        for (int32_t face = 0; face < s->face_count && beyond > 0; face++) {
            bool listed = s->face_body[face] != s->face_body[beside[0]], near = true;
            for (int k = 0; k < BRUNT_BESIDE && beside[k] >= 0; k++) listed = listed || beside[k] == face;
            for (int a = 0; a < 3; a++)
                near = near && s->x[n][a] > s->face_box[face][a] - beyond &&
                       s->x[n][a] < s->face_box[face][3 + a] + beyond;
            unlisted += !listed && near && sqrt(brunt_closest_on_face(s, face, s->x[n]).square) < beyond;
        }
    }
    return unlisted;
}

static void compare_velocities(brunt_world *one, brunt_world *other, int step) {
    for (int b = 0; b < brunt_body_count(one); b++) {
        double *p = world_field(one, b, "velocity"), *q = world_field(other, b, "velocity");
        const int64_t count = brunt_body_size(one, b, BRUNT_AT_NODES);
        for (int64_t i = 0; i < 3 * count; i++)
            ck_assert_msg(p[i] == q[i], "step %d, node %d of body %d: %.17g, not %.17g", step, (int)(i / 3), b, p[i],
                          q[i]);
        free(p), free(q);
    }
}

START_TEST(what_is_remembered_changes_nothing) {
    brunt_world *one = make(_i), *other = make(_i);
    int64_t remembered = 0, listed = 0, met = 0;
    for (int s = 0; s < STEPS; s++) {
        forget(other);
        world_steps(one, 1), world_steps(other, 1);
        const brunt_contact *contact = &one->contact;
        for (int32_t n = 0; n < contact->surface.node_count && contact->constraints.constraint_count; n++)
            remembered += contact->node_to_facet->cache.node[n].since > 0,
                listed += contact->node_to_facet->cache.node[n].beyond > 0;
        met += contact->constraints.constraint_count;
        if (s % 8 == 7 && contact->node_to_facet) ck_assert_int_eq(count_unlisted(contact), 0);
        compare_velocities(one, other, s);
    }
    printf("  case %d: %lld times a node was remembered, %lld times facets beside it, %lld constraints\n", _i,
           (long long)remembered, (long long)listed, (long long)met);
    ck_assert_int_gt(met, 1000);
    ck_assert_int_gt(remembered, met / 4);
    ck_assert_int_gt(listed, met / 16);
    brunt_world_destroy(one), brunt_world_destroy(other);
}
END_TEST

// Faces that are near nothing, and none of whose nodes is, have bounds alone: what else there was of them is of no use
// to anything, be it ever so wrong.
START_TEST(faces_near_nothing_are_not_made) {
    brunt_world *one = make(_i), *other = make(_i);
    int64_t made = 0, faces = 0, met = 0;
    for (int s = 0; s < STEPS; s++) {
        const brunt_contact_surface *wrong = &other->contact.surface;
        for (int32_t f = 0; f < wrong->face_count; f++) {
            wrong->face_area[f] = NAN;
            for (int a = 0; a < 3; a++) wrong->face_normal[f][a] = wrong->face_centre[f][a] = NAN;
        }
        world_steps(one, 1), world_steps(other, 1);
        compare_velocities(one, other, s);
        met += one->contact.constraints.constraint_count;
        for (int32_t f = 0; f < wrong->face_count && one->contact.constraints.constraint_count; f++)
            faces++, made += !isnan(wrong->face_area[f]);
        for (int32_t n = 0; n < wrong->node_count && one->contact.constraints.constraint_count; n++)
            ck_assert(!wrong->motion.near[n] || wrong->area[n] == one->contact.surface.area[n]);
    }
    printf("  case %d: %lld of %lld faces made, %lld constraints\n", _i, (long long)made, (long long)faces,
           (long long)met);
    ck_assert_int_gt(met, 1000);
    // Of a body near a plane all are.
    ck_assert_int_lt(made, (_i / 2 == 2 ? 9 : 6) * faces / 10);
    brunt_world_destroy(one), brunt_world_destroy(other);
}
END_TEST

// Cubes at all distances from each other that fall on a floor, hit and leave each other, in either order.
static brunt_world *make_crowd(bool reversed) {
    enum { CUBES = 9 }; // the last comes late to those that have met
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    for (int i = 0; i < CUBES; i++) {
        const int k = reversed ? CUBES - 1 - i : i, x = k & 1, y = k >> 1 & 1, z = k >> 2;
        const bool late = k == 8;
        const double at[3] = {late ? 0.4 : 1.02 * x + 0.3 * y, late ? 0.5 : 1.08 * y + 0.04 * x,
                              late ? -1.16 : 1.15 * z - 0.02 * x};
        char name[16];
        snprintf(name, sizeof name, "cube %d", k);
        brunt_body_def *b = def_box(&def, name, at, XYZ(at[0] + 1, at[1] + 1, at[2] + 1));
        b->method = BRUNT_FEM, b->element = k % 3 ? BRUNT_TET4 : BRUNT_HEX8, b->size = 0.25;
        def_velocity(b, x ? -0.5 : 0.5, y ? -2 : -0.25, late ? 2 : z ? -1.5 : 0.75);
    }
    def_plane(&def, XYZ(0, -0.05, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.2);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = 0.1;
    return world_take(&def);
}

START_TEST(who_is_left_out_is_reached_by_nothing) {
    brunt_world *one = make_crowd(_i), *other = make_crowd(_i);
    int left_out = 0, met = 0, most = 0;
    for (int s = 0; s < 4 * STEPS; s++) {
        const brunt_contact_surface *surface = &one->contact.surface;
        for (int k = 0; k < surface->fem_count; k++) other->contact.surface.motion.was_active[k] = true;
        world_steps(one, 1), world_steps(other, 1);
        for (int k = 0; k < surface->fem_count; k++)
            left_out += !surface->active[k] && other->contact.surface.active[k];
        met += one->contact.constraints.constraint_count;
        most = one->contact.constraints.constraint_count > most ? one->contact.constraints.constraint_count : most;
        compare_velocities(one, other, s);
    }
    printf("  cubes: %d times one was left out of the search, %d constraints, %d at once\n", left_out, met, most);
    ck_assert_int_gt(left_out, STEPS);
    ck_assert_int_gt(most, 100);
    brunt_world_destroy(one), brunt_world_destroy(other);
}
END_TEST

// A small block upon another, and a plate above it that is no part of the search until it can be there in a step,
// though it is as near as they look. All nodes of the plate are beside the block: those of the block alone see it, and
// they have looked before.
static brunt_world *make_late_plate(void) {
    static const double boxes[3][2][3] = {
        {{-1, 0, -1}, {1, 2, 1}}, {{-1, -2.03, -1}, {1, -0.03, 1}}, {{-4, 2.75, -4}, {4, 4.75, 4}}};
    static const char *const names[] = {"block", "below", "plate"};
    brunt_world_def def = def_begin(3, 1);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    for (int i = 0; i < 3; i++) {
        brunt_body_def *b = def_box(&def, names[i], boxes[i][0], boxes[i][1]);
        b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = i == 2 ? 8 : 2;
        def_velocity(b, 0, i == 2 ? -5 : 0, 0);
    }
    def.contact.method = BRUNT_CONTACT_AUGURY;
    return world_take(&def);
}

START_TEST(who_joins_is_looked_at) {
    brunt_world *one = make_late_plate(), *other = make_late_plate();
    const brunt_contact *contact = &one->contact;
    const int plate = 2; // by name
    int joined = 0, met = 0;
    for (int s = 0; s < 2 * STEPS; s++) {
        forget(other);
        world_steps(one, 1), world_steps(other, 1);
        if (!joined && contact->surface.active[plate]) joined = s;
        met += contact->constraints.constraint_count > 0;
        compare_velocities(one, other, s);
    }
    printf("  the plate joins in step %d, %d steps with constraints\n", joined, met);
    ck_assert_int_gt(joined, 5);
    ck_assert_int_gt(met, 10);
    brunt_world_destroy(one), brunt_world_destroy(other);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("remembered distances");
    ADD_LOOP(what_is_remembered_changes_nothing, CASES);
    if (!SANITIZED) ADD_LOOP(faces_near_nothing_are_not_made, CASES); // the same worlds
    ADD_LOOP(who_is_left_out_is_reached_by_nothing, SANITIZED ? 1 : 2);
    ADD_LOOP(who_joins_is_looked_at, 1);
    return suite_main(suite);
}
