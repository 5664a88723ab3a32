// What particles meet near facets: bounds of distances and of velocities, and bins that are passed over, leave what is
// found as it is, to the bit, when each particle looks at each facet by itself.
#include "contact/distance/particle_extent.h"
#include "contact/search/node_to_facet_parts.h"
#include "mpm/particles.h"
#include "tests/support/def_world.h"
#include "world/world.h"

enum { SIDE = 5, LAYER = (SIDE + 1) * (SIDE + 1), NODES = 2 * LAYER, FACES = 2 * SIDE * SIDE, PLACES = 20000 };

// How high folds are (-: the slope of a single valley), and how far a second layer is above the first (0: there is
// none).
static const struct {
    bool membrane, triangles;
    double fold, above;
    int several; // times that several facets are met, at least
} cases[] = {{false, false, 0, 0, 0},    {true, false, 0, 0, 0},     {true, true, 0, 0, 0},
             {false, false, 0.9, 0, 9},  {false, true, 0.9, 0, 9},   {true, false, 0.9, 0, 999},
             {true, true, 0.9, 0, 999},  {true, false, 0.5, 0, 999}, {true, true, 0.5, 0, 999},
             {true, false, -0.5, 0, 99}, {true, false, 0, 0.8, 99},  {false, false, 0, 0.8, 0}};

// A surface in one cell, folded along lines, with its back behind the front where it is a membrane.
typedef struct folds {
    double x[NODES][3], normal[2 * FACES][3], centre[2 * FACES][3], box[2 * FACES][6], area[2 * FACES];
    int32_t face[2 * FACES][4], body[2 * FACES], front[NODES], first[2], list[FACES];
    brunt_side side[1];
    brunt_contact_surface surface;
    brunt_node_to_facet f;
} folds;

static double some(void) { return 2.0 * rand() / RAND_MAX - 1; }

static void finish_face(folds *o, int32_t face) {
    const int32_t *node = o->face[face];
    const int count = brunt_face_corners(node);
    double e[3], g[3], *n = o->normal[face], *box = o->box[face];
    for (int a = 0; a < 3; a++) {
        box[a] = INFINITY, box[3 + a] = -INFINITY, o->centre[face][a] = 0;
        for (int c = 0; c < count; c++) {
            const double x = o->x[node[c]][a];
            o->centre[face][a] += x / count, box[a] = fmin(box[a], x), box[3 + a] = fmax(box[3 + a], x);
        }
        e[a] = o->x[node[2]][a] - o->x[node[count == 4 ? 0 : 1]][a];
        g[a] = o->x[node[count == 4 ? 3 : 0]][a] - o->x[node[count == 4 ? 1 : 0]][a];
        if (count == 3) e[a] = o->x[node[1]][a] - o->x[node[0]][a], g[a] = o->x[node[2]][a] - o->x[node[0]][a];
    }
    n[0] = e[1] * g[2] - e[2] * g[1], n[1] = e[2] * g[0] - e[0] * g[2], n[2] = e[0] * g[1] - e[1] * g[0];
    o->area[face] = 0.5 * sqrt(dot(n, n));
    for (int a = 0; a < 3; a++) n[a] /= 2 * o->area[face];
}

static folds *make(int which) {
    const bool membrane = cases[which].membrane, triangles = cases[which].triangles;
    folds *o = calloc(1, sizeof *o);
    int32_t faces = 0;
    for (int layer = 0; layer < (cases[which].above > 0 ? 2 : 1); layer++)
        for (int i = 0; i <= SIDE; i++)
            for (int k = 0; k <= SIDE; k++) {
                const int32_t n = layer * LAYER + i * (SIDE + 1) + k;
                const int32_t all[3][4] = {{n, n + SIDE + 1, n + SIDE + 2, n + 1},
                                           {n, n + SIDE + 1, n + SIDE + 2, -1},
                                           {n, n + SIDE + 2, n + 1, -1}};
                const double fold = cases[which].fold, rough = fold > 0 ? 0.05 * some() : 0,
                             at[3] = {i, k,
                                      layer * cases[which].above +
                                          (fold < 0 ? -fold * abs(i - 2)
                                           : i % 2  ? fold
                                                    : 0) +
                                          rough};
                memcpy(o->x[n], at, sizeof at);
                for (int part = triangles; part <= 2 * triangles && i < SIDE && k < SIDE; part++)
                    memcpy(o->face[faces++], all[part], sizeof *all);
            }
    for (int32_t face = 0; face < faces; face++) {
        const int32_t *n = o->face[face],
                      back[4] = {n[0], n[3] < 0 ? n[2] : n[3], n[3] < 0 ? n[1] : n[2], n[3] < 0 ? -1 : n[1]};
        memcpy(o->face[faces + face], back, sizeof back);
        o->list[face] = face;
    }
    for (int32_t face = 0; face < 2 * faces; face++) finish_face(o, face);
    for (int32_t n = 0; n < NODES; n++) o->front[n] = n;
    o->side[0] = (brunt_side){.faces = membrane ? faces : 0, .half = 0.01};
    o->surface = (brunt_contact_surface){.dim = 3,
                                         .x = o->x,
                                         .face = o->face,
                                         .face_body = o->body,
                                         .face_normal = o->normal,
                                         .face_centre = o->centre,
                                         .face_area = o->area,
                                         .face_box = o->box,
                                         .mean_edge = 1};
    if (membrane) o->surface.membrane.side = o->side, o->surface.membrane.front = o->front;
    o->first[1] = faces;
    o->f.cells.first = o->first, o->f.cells.face = o->list, o->f.bodies.range = 0.85, o->f.bodies.travel = 0.6;
    return o;
}

// A place over a facet, a spoke, an edge or a corner.
static void put(const folds *o, int k, double x[3]) {
    const int32_t face = rand() % o->first[1], *node = o->face[face];
    const double *from = o->centre[face], *to = o->x[node[k % brunt_face_corners(node)]],
                 *on = k % 3 ? from : o->x[node[1]];
    const double share = k % 7 ? fabs(some()) : 1, height = 0.9 * some();
    for (int a = 0; a < 3; a++) {
        x[a] = on[a] + share * (to[a] - on[a]) + height * o->normal[face][a];
        if (k % 5 == 0) x[a] += 0.6 * some();
    }
}

static void check_same(const candidate_list *one, const candidate_list *other) {
    ck_assert_int_eq(one->count, other->count);
    for (int32_t q = 0; q < one->count; q++) {
        const facet_candidate *a = &one->candidate[q], *b = &other->candidate[q];
        ck_assert(a->face == b->face && a->triangle == b->triangle && a->body == b->body && a->valley == b->valley);
        ck_assert(a->inside == b->inside && a->feature.any == b->feature.any && a->gap == b->gap);
        ck_assert(!memcmp(a->n, b->n, sizeof a->n));
        if (!a->feature.any) continue;
        ck_assert(!memcmp(a->feature.end, b->feature.end, sizeof a->feature.end));
        ck_assert(a->feature.face == b->feature.face && a->feature.triangles == b->feature.triangles);
    }
}

START_TEST(bounds_change_nothing) {
    folds *o = make(_i);
    const brunt_contact_context m = {.surface = &o->surface};
    int met = 0, several = 0, free_of = 0, features = 0;
    for (int k = 0; k < PLACES; k++) {
        double x[3];
        put(o, k, x);
        search_query l = {.body = 1, .x = x, .particle = true, .touch = {0}, .touches = 1};
        candidate_list alone, bounded;
        brunt_candidates_find(&m, &o->f, &l, -1, &alone);
        brunt_candidates_find_of_particle(&m, &o->f, &l, &bounded);
        check_same(&alone, &bounded);
        met += alone.count == 1, several += alone.count > 1, free_of += alone.count == 0;
        features += alone.count && alone.candidate[0].feature.any;
    }
    printf("  case %d: %d met one, %d several, %d none; %d an edge or a corner\n", _i, met, several, free_of, features);
    ck_assert_int_gt(met, PLACES / 4);
    ck_assert_int_gt(free_of, 100);
    ck_assert_int_ge(several, cases[_i].several);
    free(o);
}
END_TEST

// ------------------------------------------------------------------------------------------ a block that looks

enum { WORLDS = 6 };

// A block of points, slow and still apart, over one that is held and a second one, of elements or a membrane; in two
// dimensions; total-Lagrangian points.
static brunt_world *make_world(int which) {
    const int dim = which == 4 ? 2 : 3;
    brunt_world_def def = def_begin(dim, 1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = 0;
    brunt_body_def *points = def_box(&def, "points", XYZ(0.3, 0.2, 0.002), XYZ(9.3, 7.2, 6.002));
    if (dim == 2) points->shape.min[1] = 0.002, points->shape.max[1] = 6.002;
    def_velocity(points, 0.01, dim == 2 ? -0.02 : 0.005, dim == 2 ? 0 : -0.02);
    points->total_lagrangian = which == 5;
    points->spin[dim == 2 ? 2 : 1] = 0.004, points->spin_about[0] = 5;
    for (int k = 0; k < (which == 1 ? 2 : 1); k++) {
        const double low[3] = {k ? 4.9 : -3, dim == 2 ? -2 : -3, -2},
                     high[3] = {k || which != 1 ? 12 : 4.7, dim == 2 ? 0 : 9, 0};
        brunt_body_def *b = def_box(&def, k ? "other" : "plate", low, high);
        b->method = which == 2 ? BRUNT_MEMBRANE : BRUNT_FEM, b->size = which == 3 ? 2.3 : 1.1;
        b->element = which == 2 ? BRUNT_MEMBRANE_QUAD4 : dim == 2 ? BRUNT_QUAD4 : which == 3 ? BRUNT_TET4 : BRUNT_HEX8;
        if (which == 2) {
            b->shape.min[2] = -0.01, b->thickness = 0.02;
            b->faces = brunt_alloc(sizeof *b->faces), b->face_count = 1;
            snprintf(*b->faces, sizeof *b->faces, "zmin");
        }
        def_velocity(b, 0, 0, dim == 2 ? 0 : 0.003);
        b->spin[dim == 2 ? 2 : 1] = -0.01, b->spin_about[0] = 3;
    }
    return world_take(&def);
}

// Whether what a particle has found is a facet that it would pass, and what its target is: by its own velocity.
static bool passes(const brunt_contact_context *m, brunt_body *body, int32_t b, int64_t s, const double x[3],
                   facet_candidate *h) {
    double v[3], old[3], before = 0;
    brunt_corners under;
    brunt_node_to_facet_corners(m->surface, h, x, &under);
    brunt_particle_velocity(body, b, s, BRUNT_NODE_VELOCITY, v);
    brunt_particle_velocity(body, b, s, BRUNT_NODE_OLD, old);
    const double approach = brunt_node_to_facet_approach(&under, h->n, v, m->surface->v);
    if (h->gap < 0) before = brunt_node_to_facet_approach(&under, h->n, old, m->surface->old);
    h->target = brunt_node_to_facet_target(m->surface, (double[]){h->gap, h->gap}, fmin(before, 0.02 * approach),
                                           before, m->dt);
    return approach < h->target + 1e-6 * m->surface->mean_edge / m->dt;
}

// The velocity of a particle is within the bounds that its own bin alone gives.
static void check_bounds(const brunt_body *body, int32_t b, int64_t s) {
    int local[3];
    double low[3], high[3], v[3];
    brunt_node_local(&body->grid, body->particles.bin[s], local);
    const int32_t from[3] = {local[0], local[1], local[2]}, end[3] = {local[0] + 1, local[1] + 1, local[2] + 1};
    const brunt_node_range bin = {.block = b, .from = from, .end = end};
    brunt_particle_velocity(body, b, s, BRUNT_NODE_VELOCITY, v);
    brunt_particle_velocity_bounds(body, &bin, BRUNT_NODE_VELOCITY, low, high);
    for (int a = 0; a < 3; a++) ck_assert(v[a] >= low[a] - 1e-9 && v[a] <= high[a] + 1e-9);
}

// Of all particles of a block, each by itself: the same as were found. How many.
static int32_t check_block(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int32_t b,
                           int32_t box) {
    const brunt_block *block = &body->grid.blocks[b];
    const particle_run *run = &f->particles.run[b];
    const particle_candidate *found = f->particles.list[run->worker].candidate + run->first;
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    int32_t count = 0;
    for (int64_t s = block->first; s < block->first + block->count; s++) {
        double x[3] = {0};
        for (int a = 0; a < body->grid.dim; a++) x[a] = (double)place[a][s];
        check_bounds(body, b, s);
        search_query l = {.box = box, .body = body->index, .x = x, .particle = true};
        candidate_list list;
        if (!brunt_candidates_bodies(f, &l) || (l.cell = brunt_candidates_cell(f, x)) < 0) continue;
        brunt_candidates_find(m, f, &l, -1, &list);
        for (int32_t q = 0; q < list.count; q++) {
            facet_candidate *h = &list.candidate[q];
            h->gap -= brunt_extent_along(body, s, h->n);
            if (!(h->gap <= f->bodies.travel) || !passes(m, body, b, s, x, h)) continue;
            ck_assert_int_lt(count, run->count);
            ck_assert(found[count].particle == s && found[count].h.face == h->face && found[count].h.gap == h->gap);
            ck_assert(found[count].h.target == h->target);
            count++;
        }
    }
    ck_assert_int_eq(count, run->count);
    return count;
}

START_TEST(blocks_find_what_their_particles_do) {
    brunt_world *world = make_world(_i);
    int64_t all = 0, near = 0;
    for (int step = 0; step < 24; step++) {
        world_steps(world, 1);
        brunt_contact_context m = brunt_contact_context_of(world, (1 + 20 * (step % 4)) * 0.01, NULL);
        brunt_node_to_facet *f = world->contact.node_to_facet;
        brunt_body *body = &world->bodies.mpm[0];
        brunt_constraint_set set = {0};
        brunt_error error = {0};
        int32_t box = 0;
        while (f->bodies.box[box].mpm != 0) box++;
        if (step % 2) f->bodies.range = 0.32; // which ends within bins of which some are near
        ck_assert_int_eq(brunt_node_to_facet_begin(f, m.surface->node_count, &error), BRUNT_OK);
        ck_assert_int_eq(brunt_node_to_facet_particles(&m, f, body, 0, box, &set, &error), BRUNT_OK);
        for (int32_t b = 0; b < body->grid.block_count; b++) near += check_block(&m, f, body, b, box);
        all += body->particles.count;
        brunt_constraints_free(&set);
    }
    printf("  world %d: %lld facets found, particles %lld times\n", _i, (long long)near, (long long)all);
    ck_assert_int_gt(near, 100);
    ck_assert_int_lt(near, all / 4);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("particles near facets");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, bounds_change_nothing, 0, BRUNT_COUNT(cases));
    tcase_add_loop_test(all, blocks_find_what_their_particles_do, 0, WORLDS);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
