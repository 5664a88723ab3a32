// Cells of facets: each lists all facets whose bounds reach into it, and no others, in their order, however many
// threads have made them; and so are the edges of those facets.
#include "contact/search/node_to_facet_parts.h"
#include "tests/support/def_world.h"
#include "world/world.h"

// A wide block above another one, its lower side finer; a third one hangs over their edge.
static brunt_world *make(int threads) {
    static const double boxes[3][2][3] = {
        {{0, 0, 0}, {8, 1, 8}}, {{0.3, 1.02, 0.2}, {8.1, 2.02, 8}}, {{7.5, 1.03, -1}, {9.5, 2.03, 0.1}}};
    brunt_world_def def = def_begin(3, 0.5);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    for (int b = 0; b < 3; b++) {
        brunt_body_def *body = def_box(&def, (const char *[]){"low", "high", "aside"}[b], boxes[b][0], boxes[b][1]);
        body->method = BRUNT_FEM, body->element = BRUNT_HEX8, body->size = b == 1 ? 0.2 : 0.25;
        body->erosion.strain = 1e6;
        if (b) def_velocity(body, 0.5, -20, 0.3);
    }
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.threads = threads;
    return world_take(&def);
}

// Whether a facet is within so much of the cell along all axes.
static bool reaches(const facet_cells *c, const double box[6], const int32_t at[3], double by) {
    for (int a = 0; a < 3; a++) {
        const double low = c->origin[a] + at[a] * c->cell, high = low + c->cell;
        if ((box[3 + a] + by < low && at[a] > 0) || (box[a] - by > high && at[a] < c->n[a] - 1)) return false;
    }
    return true;
}

// A facet of body k that is as near to the box of another body as facets in cells are.
static bool is_wanted(const brunt_node_to_facet *f, const brunt_contact_surface *s, int k, int32_t face, double by) {
    return brunt_broad_phase_in_range(f, f->bodies.box_of[k], s->face_box[face], s->face_box[face] + 3, 2 * by);
}

static void check_cells(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    const facet_cells *c = &f->cells;
    const double by = c->range + 0.125 * s->mean_edge;
    int64_t found = 0;
    int32_t at[3], cell = 0;
    for (at[0] = 0; at[0] < c->n[0]; at[0]++)
        for (at[1] = 0; at[1] < c->n[1]; at[1]++)
            for (at[2] = 0; at[2] < c->n[2]; at[2]++, cell++) {
                int32_t q = c->first[cell];
                for (int k = 0; k < s->fem_count; k++)
                    for (int32_t face = s->face_range[k]; face < s->face_end[k]; face++) {
                        if (!reaches(c, s->face_box[face], at, by) || !is_wanted(f, s, k, face, by)) continue;
                        ck_assert_msg(q < c->first[cell + 1] && c->face[q] == face, "cell %d, facet %d", cell, face);
                        q++;
                    }
                ck_assert_int_eq(q, c->first[cell + 1]);
                found += q - c->first[cell];
            }
    printf("%d cells with %lld facets\n", cell, (long long)found);
    ck_assert_int_gt(found, 10000);
}

static int32_t face_with(const brunt_contact_surface *s, int32_t p, int32_t q) {
    for (int32_t face = 0; face < s->face_count; face++)
        for (int c = 0; c < 4; c++)
            if (s->face[face][c] == p && s->face[face][(c + 1) % 4] == q) return face;
    return -1;
}

static void check_edges(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    const double by = f->cells.range + 0.125 * s->mean_edge;
    int32_t at = 0;
    for (int k = 0; k < s->fem_count; k++) {
        ck_assert_int_eq(f->edges.first[2 * k], at);
        for (int32_t face = s->face_range[k]; face < s->face_end[k]; face++)
            for (int c = 0; c < 4 && is_wanted(f, s, k, face, by); c++) {
                const int32_t p = s->face[face][c], q = s->face[face][(c + 1) % 4];
                if (p > q) continue;
                const near_edge *edge = &f->edges.near[at++];
                ck_assert_msg(edge->node[0] == p && edge->node[1] == q && edge->face[0] == face &&
                                  edge->face[1] == face_with(s, q, p),
                              "edge %d", at - 1);
            }
        ck_assert_int_eq(f->edges.first[2 * k + 1], at);
    }
    ck_assert_int_eq(f->edges.near_count, at);
    ck_assert_int_gt(at, 2000);
}

// Made anew in the first step, or as elements have left and nothing has moved yet.
static void step_anew(brunt_world *world, bool erode) {
    if (erode) {
        brunt_error error = {0};
        brunt_fem_body *fem = &world->bodies.fem[1];
        for (int k = 0; k < 5; k++) fem->mark[k] = BRUNT_MARK_STRAINED, fem->report[k].marked++;
        ck_assert_msg(brunt_erode_marked(world, world->clock.dt, &error) == BRUNT_OK, "%s", error.message);
    }
    world_steps(world, 1);
}

START_TEST(list_what_reaches) {
    brunt_world *world = make((const int[]){1, 2, 5}[_i]);
    for (int anew = 0; anew < 2; anew++) {
        step_anew(world, anew);
        check_cells(world->contact.node_to_facet, &world->contact.surface);
        check_edges(world->contact.node_to_facet, &world->contact.surface);
    }
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("facet_cells");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 0);
    tcase_add_loop_test(tests, list_what_reaches, 0, 3);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
