// What a node comes to among the facets that were listed beside it is what it comes to among all: at a fan of so many
// triangles, under a plate of the same body, from places as far as what is said of the others lets it go.
#include "contact/search/node_to_facet_parts.h"
#include "tests/support/def_world.h"
#include "tests/support/numbers.h"

enum { FAN = 12, PLATE = 4, FACES = FAN + PLATE, NODES = 1 + FAN + 3 * PLATE, FANS = 4000, PLACES = 20 };

typedef struct fan {
    double x[NODES][3], normal[FACES][3], centre[FACES][3], box[FACES][6], area[FACES];
    int32_t face[FACES][4], body[FACES], list[FACES], first[2], nearest[1], beside[1][BRUNT_BESIDE], triangles;
    node_distance node[1];
    uint8_t made[FACES];
    brunt_contact_surface surface;
    brunt_node_to_facet f;
} fan;

static void add_triangle(fan *o, int32_t a, int32_t b, int32_t c) {
    const int32_t k = o->first[1]++, corner[] = {a, b, c};
    double *n = o->normal[k], way[2][3];
    o->list[k] = k, o->face[k][3] = -1;
    for (int i = 0; i < 3; i++) o->box[k][i] = INFINITY, o->box[k][3 + i] = -INFINITY, o->centre[k][i] = 0;
    for (int q = 0; q < 3; q++) {
        const double *x = o->x[o->face[k][q] = corner[q]];
        for (int i = 0; i < 3; i++)
            o->centre[k][i] += x[i] / 3, o->box[k][i] = fmin(o->box[k][i], x[i]),
                                         o->box[k][3 + i] = fmax(o->box[k][3 + i], x[i]);
    }
    for (int i = 0; i < 3; i++) way[0][i] = o->x[b][i] - o->x[a][i], way[1][i] = o->x[c][i] - o->x[a][i];
    for (int i = 0; i < 3; i++)
        n[i] = way[0][(i + 1) % 3] * way[1][(i + 2) % 3] - way[0][(i + 2) % 3] * way[1][(i + 1) % 3];
    o->area[k] = 0.5 * sqrt(dot(n, n));
    for (int i = 0; i < 3; i++) n[i] /= 2 * o->area[k];
}

// About the origin, up and down; the plate is some way above, and looks down.
static void make(fan *o, uint64_t *some) {
    *o = (fan){.triangles = 3 + draw_whole(some, FAN - 2)};
    memset(o->made, 1, sizeof o->made);
    const double turn = draw(some), height = draw_between(some, 0.55, 0.9);
    for (int k = 0; k < o->triangles; k++) {
        const double angle = 2 * PI * (k + turn) / o->triangles;
        memcpy(o->x[1 + k], XYZ(cos(angle), sin(angle), draw_between(some, -0.4, 0.4)), sizeof *o->x);
    }
    for (int k = 0; k < o->triangles; k++) add_triangle(o, 0, 1 + k, 1 + (k + 1) % o->triangles);
    for (int k = 0; k < PLATE; k++) {
        const int32_t at = 1 + FAN + 3 * k;
        for (int c = 0; c < 3; c++)
            memcpy(o->x[at + c],
                   XYZ(0.6 * (k & 1) + (c == 1) - 0.8, 0.6 * (k >> 1) + (c == 2) - 0.8, height + 0.1 * draw(some)),
                   sizeof *o->x);
        add_triangle(o, at, at + 2, at + 1);
    }
    o->surface = (brunt_contact_surface){.dim = 3,
                                         .x = o->x,
                                         .face = o->face,
                                         .face_body = o->body,
                                         .face_normal = o->normal,
                                         .face_centre = o->centre,
                                         .face_area = o->area,
                                         .face_box = o->box,
                                         .mean_edge = 1,
                                         .motion = {.seen = 0.5, .made = o->made}};
    o->f.cells.first = o->first, o->f.cells.face = o->list, o->f.cells.range = 0.5, o->f.bodies.range = 0.4;
    o->f.cache.node = o->node, o->f.cache.nearest = o->nearest, o->f.cache.beside = o->beside;
}

static void check_same(const candidate_list *one, const candidate_list *other) {
    ck_assert_int_eq(one->count, other->count);
    ck_assert_msg(one->distance == other->distance && one->second == other->second, "%.17g, %.17g; %.17g, %.17g",
                  one->distance, one->second, other->distance, other->second);
    for (int32_t q = 0; q < one->count; q++) {
        const facet_candidate *a = &one->candidate[q], *b = &other->candidate[q];
        ck_assert_msg(a->face == b->face && a->gap == b->gap && !memcmp(a->n, b->n, sizeof a->n),
                      "face %d at %.17g, %d at %.17g", (int)a->face, a->gap, (int)b->face, b->gap);
    }
}

// The facets that are near a place, by their boxes.
static int count_near(const fan *o, const double x[3], double by) {
    int near = 0;
    for (int32_t k = 0; k < o->first[1]; k++) {
        bool is = true;
        for (int a = 0; a < 3; a++) is = is && x[a] >= o->box[k][a] - by && x[a] <= o->box[k][3 + a] + by;
        near += is;
    }
    return near;
}

typedef struct counts {
    int listed, too_many, among, left;
} counts;

static void look(fan *o, uint64_t *some, counts *count) {
    const brunt_contact_context m = {.surface = &o->surface};
    double from[3], at[3], normal[3] = {draw_between(some, -0.5, 0.5), draw_between(some, -0.5, 0.5), -1};
    const double length = sqrt(dot(normal, normal));
    for (int a = 0; a < 3; a++)
        normal[a] /= length, at[a] = from[a] = a < 2 ? draw_between(some, -0.2, 0.2) : draw_between(some, -0.05, 0.2);
    search_query l = {.body = 1, .x = at, .normal = draw(some) < 0.5 ? normal : NULL, .touch = {0}, .touches = 1};
    l.enters = draw_whole(some, 2); // the body may be entered: what is behind its facets may leave by any
    candidate_list all, found;
    brunt_candidates_find(&m, &o->f, &l, -1, &all);
    o->nearest[0] = all.count ? all.candidate[0].face : -1;
    brunt_candidates_remember(&m, &o->f, &l, 0);
    const double beyond = o->node[0].beyond;
    const bool fits = count_near(o, from, 0.5 * (1 - 1e-8)) <= BRUNT_BESIDE;
    ck_assert_int_eq(beyond > 0, fits);
    count->listed += fits, count->too_many += !fits;
    for (int k = 0; k < PLACES; k++) {
        const double way = beyond * draw(some), up = draw_between(some, -1, 1), turn = 2 * PI * draw(some),
                     out = sqrt(1 - up * up), unit[3] = {out * cos(turn), out * sin(turn), up};
        for (int a = 0; a < 3; a++) at[a] = from[a] + way * unit[a];
        o->node[0].beyond = beyond - way;
        const bool done = brunt_candidates_among(&m, &o->f, &l, 0, &found);
        count->among += done, count->left += fits && !done;
        if (!done) continue;
        brunt_candidates_find(&m, &o->f, &l, o->nearest[0], &all);
        check_same(&found, &all);
    }
}

START_TEST(as_among_all) {
    uint64_t some = 7;
    counts count = {0};
    fan o;
    for (int k = 0; k < FANS; k++) make(&o, &some), look(&o, &some, &count);
    printf("  %d lists, %d times too many; among them %d times, %d not\n", count.listed, count.too_many, count.among,
           count.left);
    ck_assert_int_gt(count.listed, FANS / 4);
    ck_assert_int_gt(count.too_many, FANS / 4);
    ck_assert_int_gt(count.among, FANS);
    ck_assert_int_gt(count.left, FANS);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("facets beside");
    ADD_LOOP(as_among_all, 1);
    return suite_main(suite);
}
