// What the search for contact remembers of nodes from step to step saves work and changes nothing: a world that forgets
// it before every step comes to the same bits.
#include "contact/search/node_to_facet_parts.h"
#include "world/world.h"
#include "tests/support/hard_world.h"

enum { STEPS = 120, CASES = 6 };

// In either order of the bodies: a plate that slides over one that is held, under a pressure that bends both out at
// their rims; a fine block that hits a coarse one and leaves it again; and the plates on a floor.
static brunt_world *make(int which) {
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

START_TEST(what_is_remembered_changes_nothing) {
    brunt_world *one = make(_i), *other = make(_i);
    int64_t remembered = 0, met = 0;
    for (int s = 0; s < STEPS; s++) {
        forget(other);
        world_steps(one, 1), world_steps(other, 1);
        const brunt_contact *contact = &one->contact;
        for (int32_t n = 0; n < contact->surface.node_count && contact->constraints.constraint_count; n++)
            remembered += contact->node_to_facet->cache.node[n].since > 0;
        met += contact->constraints.constraint_count;
        for (int b = 0; b < 2; b++) {
            double *p = world_field(one, b, "velocity"), *q = world_field(other, b, "velocity");
            const int64_t count = brunt_body_size(one, b, BRUNT_AT_NODES);
            for (int64_t i = 0; i < 3 * count; i++)
                ck_assert_msg(p[i] == q[i], "step %d, node %d of body %d: %.17g, not %.17g", s, (int)(i / 3), b, p[i],
                              q[i]);
            free(p), free(q);
        }
    }
    printf("  case %d: %lld times a node was remembered, %lld constraints\n", _i, (long long)remembered,
           (long long)met);
    ck_assert_int_gt(met, 1000);
    ck_assert_int_gt(remembered, met / 4);
    brunt_world_destroy(one), brunt_world_destroy(other);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("remembered distances");
    ADD_LOOP(what_is_remembered_changes_nothing, CASES);
    return suite_main(suite);
}
