// The surface of a barrier: facets as simplices, their edges, and what of the surface vertices and edges stand for.
#include "contact/barrier/barrier_parts.h"

#include <stdlib.h>

static const double PI = 3.14159265358979323846;

double brunt_barrier_particle_area(int dim, double volume) {
    return dim == 2 ? 2 * sqrt(volume / PI) : PI * pow(3 * volume / (4 * PI), 2.0 / 3);
}

brunt_barrier *brunt_barrier_make(brunt_error *error) {
    brunt_barrier *b;
    return BRUNT_NEW(b, 1, "room for contact by a barrier", error) ? NULL : b;
}

static void sets_free(barrier_sets *s) { brunt_free(s->first), brunt_free(s->node); }

void brunt_barrier_free(brunt_barrier *b) {
    if (!b) return;
    brunt_free(b->facet), brunt_free(b->turned), brunt_free(b->body), brunt_free(b->edge), brunt_free(b->vertex_area);
    brunt_free(b->arc), brunt_free(b->joint), brunt_free(b->rim), brunt_free(b->corner), brunt_free(b->corner_of);
    brunt_free(b->edge_area), brunt_free(b->edge_length2), brunt_free(b->pair), brunt_free(b->key);
    brunt_free(b->point_box), brunt_free(b->facet_box), brunt_free(b->edge_box);
    brunt_free(b->far), brunt_free(b->asked);
    brunt_near_cells_free(&b->facet_cells), brunt_near_cells_free(&b->edge_cells);
    barrier_wide_free(&b->wide), barrier_clear_free(&b->clear);
    brunt_near_list_free(&b->facets), brunt_near_list_free(&b->planes), brunt_near_list_free(&b->edges);
    brunt_free(b->task), brunt_free(b->task_energy), brunt_free(b->task_first), brunt_free(b->task_place);
    for (size_t i = 0; i < b->workspace_capacity / sizeof *b->workspace; i++) {
        barrier_workspace *r = &b->workspace[i];
        brunt_free(r->feature), brunt_free(r->edge), brunt_free(r->vertex), brunt_free(r->contact);
    }
    brunt_free(b->workspace), brunt_free(b->contacts.contact), brunt_free(b->lagged.contact), brunt_free(b->rub);
    brunt_free(b->felt), brunt_free(b->felt_before), brunt_free(b->here);
    brunt_free(b->kept), brunt_free(b->kept_edges);
    sets_free(&b->sets), sets_free(&b->lagged_sets);
    brunt_colours_free(&b->colours), brunt_colours_free(&b->lagged_colours);
    brunt_free(b);
}

double brunt_barrier_vertex_area(const brunt_barrier *b, int32_t vertex) { return b->vertex_area[vertex]; }

static double length2(const double a[3], const double b[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

static void sort_three(int32_t v[3], int count) {
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && v[j] < v[j - 1]; j--) {
            const int32_t swap = v[j];
            v[j] = v[j - 1], v[j - 1] = swap;
        }
}

// The diagonal of a quadrilateral from its first vertex, rather than from its second: the shorter, or the one that has
// the smallest vertex. Mirror images are cut alike.
static bool from_first(const double (*x)[3], const int32_t q[4]) {
    const double first = length2(x[q[0]], x[q[2]]), second = length2(x[q[1]], x[q[3]]);
    if (fabs(first - second) > 1e-9 * fmax(first, second)) return first < second;
    const int32_t a = q[0] < q[2] ? q[0] : q[2], b = q[1] < q[3] ? q[1] : q[3];
    return a < b;
}

static void take_facet(brunt_barrier *b, const int32_t corners[3]) {
    int32_t *f = b->facet[b->facet_count];
    b->turned[b->facet_count++] = corners[1] < corners[0];
    f[0] = corners[0], f[1] = corners[1], f[2] = b->dim == 3 ? corners[2] : -1;
    sort_three(f, b->dim);
}

static void take_facets(brunt_barrier *b, const brunt_barrier_mesh *mesh) {
    b->facet_count = 0;
    for (int32_t i = 0; i < mesh->facet_count; i++) {
        const int32_t *q = mesh->facet[i];
        if (mesh->dim == 2 || q[3] < 0) {
            take_facet(b, q);
            continue;
        }
        const bool first = from_first(mesh->rest, q);
        take_facet(b, first ? q : (int32_t[]){q[0], q[1], q[3]});
        take_facet(b, first ? (int32_t[]){q[0], q[2], q[3]} : q + 1);
    }
}

// [m^2] of a triangle, [m] of an edge; 0 where it has none.
static double facet_area(const brunt_barrier *b, const double (*x)[3], const int32_t f[3]) {
    const double a2 = length2(x[f[0]], x[f[1]]);
    if (b->dim == 2) return sqrt(a2);
    double e[2][3], unused[6], second[36];
    for (int k = 0; k < 3; k++) e[0][k] = x[f[1]][k] - x[f[0]][k], e[1][k] = x[f[2]][k] - x[f[0]][k];
    const double cross2 = brunt_edge_cross(e[0], e[1], unused, second);
    return cross2 > 1e-28 * a2 * length2(x[f[0]], x[f[2]]) ? sqrt(cross2) / 2 : 0;
}

static int check_facet(const brunt_barrier *b, double area, const int32_t f[3], brunt_error *error) {
    const int32_t last = f[b->dim - 1];
    if (b->body[f[0]] != b->body[f[1]] || b->body[f[0]] != b->body[last])
        return brunt_fail(error, BRUNT_FAILED, "a facet of contact has vertices of two bodies: %d, %d, %d", f[0], f[1],
                          last);
    if (f[0] == f[1] || f[1] == f[2] || !(area > 0))
        return brunt_fail(error, BRUNT_FAILED, "a facet of contact has no area: its vertices are %d, %d, %d", f[0],
                          f[1], last);
    return BRUNT_OK;
}

typedef struct edge_side {
    int32_t vertex[2];
    int32_t facet;
} edge_side;

static int by_vertices(const void *left, const void *right) {
    const edge_side *x = left, *y = right;
    for (int k = 0; k < 2; k++)
        if (x->vertex[k] != y->vertex[k]) return (x->vertex[k] > y->vertex[k]) - (x->vertex[k] < y->vertex[k]);
    return (x->facet > y->facet) - (x->facet < y->facet);
}

// Edges of triangles, each once, ascending; a third of the triangles about them is theirs.
static int make_edges(brunt_barrier *b, const double (*x)[3], brunt_error *error) {
    const size_t sides = (size_t)b->facet_count * 3;
    edge_side *side;
    const bool room = !BRUNT_NEW(side, sides + 1, "sides of facets", error) &&
                      !BRUNT_CAPACITY(b->edge, sides + 1, 0, "edges of surfaces", error) &&
                      !BRUNT_CAPACITY(b->edge_area, sides + 1, 0, "edges of surfaces", error) &&
                      !BRUNT_CAPACITY(b->edge_length2, sides + 1, 0, "edges of surfaces", error);
    b->edge_count = 0;
    if (room) {
        for (size_t i = 0; i < sides; i++) {
            const int32_t *f = b->facet[i / 3];
            side[i] = (edge_side){{f[i % 3 == 2], f[i % 3 == 0 ? 1 : 2]}, (int32_t)(i / 3)};
        }
        qsort(side, sides, sizeof *side, by_vertices);
        for (size_t i = 0; i < sides; i++) {
            const int32_t *v = side[i].vertex;
            const int32_t last = b->edge_count - 1;
            if (last < 0 || b->edge[last][0] != v[0] || b->edge[last][1] != v[1]) {
                b->edge[b->edge_count][0] = v[0], b->edge[b->edge_count][1] = v[1];
                b->edge_length2[b->edge_count] = length2(x[v[0]], x[v[1]]);
                b->edge_area[b->edge_count++] = 0;
            }
            b->edge_area[b->edge_count - 1] += facet_area(b, x, b->facet[side[i].facet]) / 3;
        }
    }
    brunt_free(side);
    return room ? BRUNT_OK : BRUNT_FAILED;
}

int brunt_barrier_set_mesh(brunt_barrier *b, const brunt_barrier_mesh *mesh, brunt_error *error) {
    BRUNT_ASSERT(mesh->dim == 2 || mesh->dim == 3);
    BRUNT_ASSERT(mesh->dim == 2 || !(mesh->round || mesh->overlaps));
    b->dim = mesh->dim, b->vertex_count = mesh->vertex_count, b->edge_count = b->rim_count = 0, b->round = false;
    b->corner_count = 0, b->overlaps = mesh->overlaps;
    const size_t vertices = (size_t)mesh->vertex_count + 1;
    if (BRUNT_CAPACITY(b->facet, (size_t)mesh->facet_count * 2 + 1, 0, "facets of surfaces", error) ||
        BRUNT_CAPACITY(b->turned, (size_t)mesh->facet_count * 2 + 1, 0, "facets of surfaces", error) ||
        BRUNT_CAPACITY(b->body, vertices, 0, "vertices of surfaces", error) ||
        BRUNT_CAPACITY(b->vertex_area, vertices, 0, "vertices of surfaces", error))
        return BRUNT_FAILED;
    if (mesh->vertex_count) memcpy(b->body, mesh->body, (size_t)mesh->vertex_count * sizeof *b->body);
    memset(b->vertex_area, 0, vertices * sizeof *b->vertex_area);
    take_facets(b, mesh);
    for (int32_t i = 0; i < b->facet_count; i++) {
        const int32_t *f = b->facet[i];
        const double area = facet_area(b, mesh->rest, f);
        const int code = check_facet(b, area, f, error);
        if (code) return code;
        for (int k = 0; k < b->dim; k++) b->vertex_area[f[k]] += area / b->dim;
    }
    if (mesh->overlaps && barrier_make_corners(b, mesh->rest, error)) return BRUNT_FAILED;
    if (mesh->round && barrier_make_arcs(b, mesh->rest, error)) return BRUNT_FAILED;
    if (mesh->overlaps) barrier_clear_begin(b);
    return b->dim == 3 ? make_edges(b, mesh->rest, error) : BRUNT_OK;
}

int brunt_barrier_set_step(brunt_barrier *b, const brunt_barrier_step *step, brunt_error *error) {
    BRUNT_ASSERT(b->dim && step->dt > 0 && step->factor > 0);
    BRUNT_ASSERT(step->before || step->factor == 1);
    (void)error;
    b->step = *step;
    b->extent.known = b->known = b->wide.known = false;
    barrier_place_rims(b);
    b->contacts.count = b->lagged.count = 0;
    b->pair_count = b->key_count = 0;
    b->here_count = b->clear.count = 0;
    return BRUNT_OK;
}
