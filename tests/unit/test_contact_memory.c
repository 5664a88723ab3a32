// What contact of surfaces says that it takes is what it has asked for: each block is counted as it is taken and freed.
#include "contact/search/node_to_facet_parts.h"
#include "tests/support/def_world.h"
#include "world/world.h"

enum { BLOCKS = 1 << 16 };

// Blocks that are taken, in the order of their taking: calls come here (tests/CMakeLists.txt).
static struct {
    void *block;
    size_t bytes;
} taken[BLOCKS];
static int taken_count;
static size_t freed_bytes;

void *__real_brunt_alloc(size_t bytes);
void *__wrap_brunt_alloc(size_t bytes);
void __real_brunt_free(void *block);
void __wrap_brunt_free(void *block);

void *__wrap_brunt_alloc(size_t bytes) {
    void *block = __real_brunt_alloc(bytes);
    ck_assert_int_lt(taken_count, BLOCKS);
    if (block) taken[taken_count].block = block, taken[taken_count++].bytes = bytes;
    return block;
}

void __wrap_brunt_free(void *block) {
    for (int k = taken_count - 1; k >= 0 && block; k--) {
        if (taken[k].block != block) continue;
        freed_bytes += taken[k].bytes;
        taken[k] = taken[--taken_count];
        break;
    }
    __real_brunt_free(block);
}

// Two blocks that meet aslant, edges upon edges, between them material points that are pressed onto one.
static brunt_world *make(void) {
    brunt_world_def def = def_begin(3, 0.5);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    static const double boxes[3][2][3] = {
        {{0, 0, 0}, {8, 2, 8}}, {{4.3, 2.02, 4.7}, {9.3, 5.02, 9.7}}, {{0.5, 2.1, 0.5}, {2.5, 3.1, 2.5}}};
    for (int b = 0; b < 3; b++) {
        brunt_body_def *body = def_box(&def, b == 0 ? "low" : b == 1 ? "high" : "sand", boxes[b][0], boxes[b][1]);
        if (b < 2)
            body->method = BRUNT_FEM, body->element = BRUNT_HEX8, body->size = b ? 0.7 : 1, body->erosion.strain = 1e6;
        if (b) def_velocity(body, 0.5, -20, 0.3);
    }
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = 0.2;
    return world_take(&def);
}

static void remove_an_element(brunt_world *world) {
    brunt_error error = {0};
    brunt_fem_body *fem = &world->bodies.fem[0];
    fem->mark[0] = BRUNT_MARK_STRAINED, fem->report[0].marked++;
    ck_assert_msg(brunt_erode_marked(world, world->clock.dt, &error) == BRUNT_OK, "%s", error.message);
}

// All that is kept for some scene is there: what is not would not be missed.
static void check_complete(const brunt_node_to_facet *f) {
    const void *all[] = {f->bodies.box,
                         f->bodies.pair,
                         f->bodies.box_of,
                         f->bodies.first,
                         f->bodies.list,
                         f->cells.first,
                         f->cells.face,
                         f->cells.x,
                         f->cells.box,
                         f->cells.moved,
                         f->cells.near,
                         f->cells.listed,
                         f->cells.run,
                         f->cache.node,
                         f->cache.nearest,
                         f->cache.spare,
                         f->cache.beside,
                         f->touches.of,
                         f->touches.spare,
                         f->nodes.count,
                         f->nodes.candidate,
                         f->nodes.dof_of,
                         f->nodes.first,
                         f->nodes.meets,
                         f->nodes.masters,
                         f->nodes.masters[0].master,
                         f->edges.near,
                         f->edges.beyond,
                         f->edges.first,
                         f->edges.feature,
                         f->edges.feature_first,
                         f->edges.span,
                         f->particles.list,
                         f->particles.run,
                         f->particles.dofs,
                         f->particles.list[0].candidate,
                         f->particles.dofs[0].of,
                         f->particles.dofs[0].dof};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) ck_assert_msg(all[k] != NULL, "array %zu", k);
}

START_TEST(all_is_counted) {
    brunt_world *world = make();
    brunt_contact *contact = &world->contact;
    world_steps(world, 40);
    remove_an_element(world);
    world_steps(world, 1);
    check_complete(contact->node_to_facet);
    const size_t said = brunt_node_to_facet_bytes(contact->node_to_facet);
    freed_bytes = 0;
    brunt_node_to_facet_free(contact->node_to_facet);
    contact->node_to_facet = NULL;
    ck_assert_uint_eq(said, freed_bytes);
    ck_assert_uint_eq(brunt_node_to_facet_bytes(NULL), 0);
    brunt_world_destroy(world);
    ck_assert_int_eq(taken_count, 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("contact_memory");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 0);
    tcase_add_test(tests, all_is_counted);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
