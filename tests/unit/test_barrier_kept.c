// Labels: double
// What a barrier remembers from one look to the next: lists of what is near, and how far points are from bodies that
// they are clear of. One that is asked along a way of long and short steps says the same, to the last digit, as one
// that has just begun.
#include "contact/barrier/barrier_parts.h"
#include "contact/methods/gap_energy.h"
#include "tests/support/barrier_case.h"
#include "tests/support/numbers.h"
#include "tests/support/suite.h"

static const double PI = 3.14159265358979323846;
enum { STEPS = 300 };

typedef struct kind {
    int dim;
    bool overlap, round;
    int threads;
    double distance;
} kind;

static void add_disk(barrier_case *c, int32_t body, double x, double y, double radius, int n) {
    double rim[100][2];
    for (int i = 0; i < n; i++)
        rim[i][0] = x + radius * cos(2 * PI * i / n), rim[i][1] = y + radius * sin(2 * PI * i / n);
    case_polygon(c, body, (const double(*)[2])rim, n);
}

static void add_bodies(barrier_case *c) {
    if (c->dim == 2) {
        add_disk(c, 0, 0, 0, 1, 40), add_disk(c, 1, 2.02, 0, 1, 36), add_disk(c, 2, 1.01, 0.36, 0.06, 12);
        case_rectangle(c, 3, (double[2]){-0.5, -1.63}, (double[2]){2.5, -1.02}, 8);
        return;
    }
    case_box(c, 0, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 3, true);
    case_box(c, 1, (double[3]){0.2, 0.3, 1.01}, (double[3]){1.2, 1.3, 1.7}, 2, false);
    case_box(c, 2, (double[3]){1.03, -0.2, 0.1}, (double[3]){1.9, 0.9, 0.9}, 2, true);
}

static barrier_case *make_case(kind k) {
    barrier_case *c = case_begin(k.dim);
    c->round = k.round, c->threads = k.threads;
    add_bodies(c);
    for (int32_t i = 0; i < c->bodies; i++)
        for (int32_t j = i + 1; j < c->bodies; j++) {
            brunt_barrier_pair *p = case_pair(c, i, j, k.distance, 1e6);
            if (k.overlap) p->energy = brunt_penalty_at, p->reach = 0.05 + 0.01 * j;
        }
    c->plane[c->planes++] = (brunt_barrier_plane){
        .origin = {-1.03}, .normal = {1}, .node = -1, .distance = fmax(k.distance, 0.01), .stiffness = 1e6};
    case_ready(c);
    return c;
}

// A way of all bodies, or of one of them: moved, turned, and each vertex by itself.
static void draw_way(const barrier_case *c, uint64_t *state, double *p) {
    const double size = pow(10, draw_between(state, -6, -0.3));
    const int32_t only = draw_whole(state, c->bodies + 2);
    double by[8][4];
    for (int32_t b = 0; b < c->bodies; b++)
        for (int k = 0; k < 4; k++) by[b][k] = draw_between(state, -size, size);
    memset(p, 0, (size_t)(c->nodes * c->dim) * sizeof *p);
    for (int32_t v = 0; v < c->vertices; v++) {
        const double *of = by[c->body[v]], *x = c->x[v];
        double *at = p + c->node[v] * c->dim;
        if (only < c->bodies && c->body[v] != only) continue;
        for (int k = 0; k < c->dim; k++) at[k] = of[k] + 0.05 * draw_between(state, -size, size);
        at[0] -= of[3] * x[1], at[1] += of[3] * x[0];
    }
}

typedef struct pair_of_cases {
    barrier_case *kept, *anew;
    double *g, *h;
} pair_of_cases;

static void same_forces(pair_of_cases *t, const double *u) {
    const brunt_term term = brunt_barrier_term(t->kept->barrier), other = brunt_barrier_term(t->anew->barrier);
    const double e = case_energy(t->kept, term, u), f = case_energy(t->anew, other, u);
    ck_assert_msg(!memcmp(&e, &f, sizeof e), "energies %.17g and %.17g", e, f);
    case_gradient(t->kept, term, u, t->g), case_gradient(t->anew, other, u, t->h);
    ck_assert(!memcmp(t->g, t->h, (size_t)(t->kept->nodes * t->kept->dim) * sizeof *t->g));
}

// A step from u by a share of as much of p as may be gone, to `at`.
static void walk(pair_of_cases *t, const double *u, const double *p, double *at, double share) {
    const int n = t->kept->nodes * t->kept->dim;
    case_step(t->anew);
    case_look(t->anew, u, NULL), case_look(t->kept, u, NULL);
    same_forces(t, u);
    case_look(t->anew, u, p), case_look(t->kept, u, p);
    const double limit = case_limit(t->kept, u, p, 1), other = case_limit(t->anew, u, p, 1);
    ck_assert_msg(!memcmp(&limit, &other, sizeof limit), "limits %.17g and %.17g", limit, other);
    ck_assert_double_gt(limit, 0);
    for (double part = limit * share; part > 0.2 * limit * share; part /= 2) { // places that are tried
        for (int i = 0; i < n; i++) at[i] = u[i] + part * p[i];
        same_forces(t, at);
    }
    for (int i = 0; i < n; i++) at[i] = u[i] + limit * share * p[i];
}

// Where u has led the next step begins; looked at where it goes on by as much.
static void next_step(pair_of_cases *t, double *u) {
    const int dim = t->kept->dim;
    case_look(t->kept, u, NULL);
    for (int32_t v = 0; v < t->kept->vertices; v++)
        for (int k = 0; k < dim; k++) {
            t->kept->x[v][k] += u[t->kept->node[v] * dim + k];
            t->anew->x[v][k] = t->kept->x[v][k];
        }
    case_step(t->kept), case_step(t->anew);
    if (t->kept->pair[0].reach > 0) {
        case_look(t->kept, u, NULL), case_look(t->anew, u, NULL);
        same_forces(t, u);
    }
    memset(u, 0, (size_t)(t->kept->nodes * dim) * sizeof *u);
}

static double walk_along(kind k, uint64_t seed) {
    pair_of_cases t = {.kept = make_case(k), .anew = make_case(k)};
    double *u = case_unknowns(t.kept), *p = case_unknowns(t.kept), *at = case_unknowns(t.kept), most = 0;
    t.g = case_unknowns(t.kept), t.h = case_unknowns(t.kept);
    for (int i = 0; i < STEPS; i++) {
        if (k.overlap && i % 7 == 0)
            brunt_barrier_join(t.kept->barrier, i % 2), brunt_barrier_join(t.anew->barrier, i % 2);
        if (i % 50 == 49) next_step(&t, u);
        draw_way(t.kept, &seed, p);
        for (int n = 0; n < t.kept->nodes * t.kept->dim; n++) p[n] -= 0.1 * draw(&seed) * u[n]; // stays near
        walk(&t, u, p, at, 0.9);
        memcpy(u, at, (size_t)(t.kept->nodes * t.kept->dim) * sizeof *u);
        for (int n = 0; n < t.kept->nodes * t.kept->dim; n++) most = fmax(most, fabs(t.g[n]));
    }
    free(u), free(p), free(at), free(t.g), free(t.h);
    case_end(t.kept), case_end(t.anew);
    return most;
}

START_TEST(what_is_remembered_is_as_if_looked_for_anew) {
    static const kind of[] = {{2, true, true, 1, 0},
                              {2, true, false, 2, 0},
                              {2, true, true, 2, 0.01},
                              {2, false, false, 1, 0.02},
                              {3, false, false, 2, 0.02}};
    for (int k = 0; k < 5; k++)
        for (uint64_t seed = 1; seed <= 3; seed++) ck_assert_double_gt(walk_along(of[k], seed), 0);
}
END_TEST

// Joined, what is a little apart touches, and not before: though it was clear.
START_TEST(what_is_joined_is_found_where_it_was_clear) {
    for (int seed = 0; seed < 40; seed++) {
        const kind of = {2, true, seed < 20, 1, 0};
        pair_of_cases t = {.kept = make_case(of), .anew = make_case(of)};
        double *u = case_unknowns(t.kept), size = 0;
        t.g = case_unknowns(t.kept), t.h = case_unknowns(t.kept);
        for (int32_t v = 0; v < t.kept->vertices; v++) // gaps of curves, and of corners
            if (t.kept->body[v] == 1) u[t.kept->node[v] * 2] = -0.02 + (of.round ? 1e-5 * seed : 1e-8);
        case_look(t.kept, u, NULL);
        if (seed % 2) case_look(t.kept, NULL, NULL), case_look(t.kept, u, NULL);
        brunt_barrier_join(t.kept->barrier, true), brunt_barrier_join(t.anew->barrier, true);
        case_look(t.kept, u, NULL), case_look(t.anew, u, NULL);
        same_forces(&t, u);
        for (int n = 0; n < t.kept->nodes * 2; n++) size += fabs(t.g[n]);
        ck_assert_double_gt(size, 0);
        free(u), free(t.g), free(t.h), case_end(t.kept), case_end(t.anew);
    }
}
END_TEST

// Boxes with room are made anew where something has left theirs, and at no other time: whichever body it is.
START_TEST(lists_are_made_anew_where_something_moved_far) {
    for (int body = 0; body < 4; body++) {
        barrier_case *c = make_case((kind){2, true, true, 1, 0});
        const brunt_barrier *b = c->barrier;
        double *u = case_unknowns(c), worst = 0;
        case_look(c, u, NULL);
        const double spare = b->wide.spare;
        int made = 0;
        for (int step = 1; step <= 30; step++) {
            c->barrier->wide.facets.count = -1; // a mark
            for (int32_t v = 0; v < c->vertices; v++)
                if (c->body[v] == body) u[c->node[v] * 2] = -0.1 * step * spare;
            case_look(c, u, NULL);
            made += b->wide.facets.count >= 0;
            ck_assert(step >= 5 || made == 0);
            for (int32_t v = 0; v < b->vertex_count; v++)
                worst = fmax(worst, fabs(b->wide.point[v].low[0] - b->point_box[v].low[0]));
        }
        ck_assert_double_lt(worst, 0.5 * spare);
        ck_assert_int_eq(made, 6); // every fifth
        free(u), case_end(c);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("barrier kept");
    TCase *tests = tcase_create("kept");
    tcase_add_test(tests, what_is_remembered_is_as_if_looked_for_anew);
    tcase_add_test(tests, what_is_joined_is_found_where_it_was_clear);
    tcase_add_test(tests, lists_are_made_anew_where_something_moved_far);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
