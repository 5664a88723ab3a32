#include "contact/surface/contact_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

enum { GRAIN = 256 };
static const double SHALLOW =
    0.25; // mean edges: how far a node may get behind a sheet, at most, and still be sent back
// Share of a node's faces, by area, that must be left of their sum for it to have a normal, where elements have left:
// that of a cube's corner is 0.58, of four faces of a wall and two at its end 0.33. Below, faces look every way, and
// the little that is left of them points anywhere.
static const double CLEAR = 0.3;

// ------------------------------------------------------------------------------------------ topology

static int corners(const int32_t face[4]) { return face[2] < 0 ? 2 : face[3] < 0 ? 3 : 4; }

// Nodes that have a face, ascending; `number` gets their skin numbers, from `first`. Their count, or -1: out of memory.
static int32_t number_nodes(const brunt_fem_body *fem, const brunt_faces *faces, int32_t first, int32_t *number) {
    for (int32_t n = 0; n < fem->node_count; n++) number[n] = -1;
    for (int32_t f = 0; f < faces->count; f++)
        for (int k = 0; k < corners(faces->node[f]); k++) number[faces->node[f][k]] = 0;
    int32_t next = first;
    for (int32_t n = 0; n < fem->node_count; n++)
        if (number[n] == 0) number[n] = next++;
    return next - first;
}

// What there is one of for each node, and for each face, beside the lists themselves.
// clang-format off
#define NODE_ARRAYS(X) \
    X(x, 1) X(v, 1) X(old, 1) X(mass, 1) X(inverse, 1) X(normal, 1) X(area, 1) X(gap, 1) X(impulse, 1) X(state, 1) \
    X(face_first, 1) X(affine, s->affine) X(front, s->front)
#define FACE_ARRAYS(X) X(face_normal) X(face_centre) X(face_area) X(face_box) X(face_body)
// clang-format on

static int enlarge(void *array, size_t keep, size_t bytes) {
    void *larger = brunt_alloc(bytes), *old;
    if (!larger) return -1;
    memcpy(&old, array, sizeof old);
    if (keep) memcpy(larger, old, keep);
    brunt_free(old);
    memcpy(array, &larger, sizeof larger);
    return 0;
}

// Room for so many nodes and faces, with what is there kept: exactly that at the start, later half as much again, so
// that surfaces that grow seldom ask for it.
static int make_room(brunt_contact_surface *s, int32_t node_count, int32_t face_count) {
    const size_t nodes = (size_t)node_count + 2, faces = (size_t)face_count + 1;
    if (nodes > s->node_room) {
        const size_t room = s->node_room ? nodes + nodes / 2 : nodes, had = s->node_room;
        int failed = enlarge(&s->chunk_moved, 0, (room / GRAIN + 1) * sizeof *s->chunk_moved);
#define ENLARGE(what, when)                                                                                            \
    if (!failed && (when)) failed = enlarge(&s->what, had * sizeof *s->what, room * sizeof *s->what);
        NODE_ARRAYS(ENLARGE)
#undef ENLARGE
        if (failed) return -1;
        s->node_room = room;
    }
    if (faces > s->face_room) {
        const size_t room = s->face_room ? faces + faces / 2 : faces, had = s->face_room;
        int failed = enlarge(&s->face_of, 0, 4 * room * sizeof *s->face_of);
#define ENLARGE(what)                                                                                                  \
    if (!failed) failed = enlarge(&s->what, had * sizeof *s->what, room * sizeof *s->what);
        FACE_ARRAYS(ENLARGE)
#undef ENLARGE
        if (failed) return -1;
        s->face_room = room;
    }
    return 0;
}

static void link_faces(brunt_contact_surface *s) {
    memset(s->face_first, 0, ((size_t)s->node_count + 2) * sizeof *s->face_first);
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < corners(s->face[f]); k++) s->face_first[s->face[f][k] + 2]++;
    for (int32_t n = 2; n <= s->node_count + 1; n++) s->face_first[n] += s->face_first[n - 1];
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < corners(s->face[f]); k++) s->face_of[s->face_first[s->face[f][k] + 1]++] = f;
}

static double edge_sum(const brunt_contact_surface *s, int32_t *edges) {
    double sum = 0;
    for (int32_t f = 0; f < s->face_count; f++) {
        int n = corners(s->face[f]);
        int k = 0;
        while (s->face_range[k + 1] <= f) k++;
        if (f >= s->face_end[k]) continue;
        for (int e = 0; e < (n == 2 ? 1 : n); e++) {
            const real *a = brunt_fem_node(s->fem[k], s->node[s->face[f][e]]),
                       *b = brunt_fem_node(s->fem[k], s->node[s->face[f][(e + 1) % n]]);
            double square = 0;
            for (int c = 0; c < 3; c++) square += (double)((a[c] - b[c]) * (a[c] - b[c]));
            sum += sqrt(square);
            ++*edges;
        }
    }
    return sum;
}

// The other side of a sheet: `nodes` nodes and `faces` faces once more, behind them, facing the other way.
static void add_back(int32_t *node, int32_t nodes, int32_t (*face)[4], int32_t faces) {
    for (int32_t n = 0; n < nodes; n++) node[n + nodes] = node[n];
    for (int32_t f = 0; f < faces; f++) {
        const int n = corners(face[f]);
        int32_t *back = face[f + faces];
        back[3] = -1;
        for (int c = 0; c < n; c++) back[c] = face[f][n - 1 - c] + nodes;
    }
}

static int add_body(brunt_contact_surface *s, int k) {
    brunt_fem_body *fem = s->fem[k];
    brunt_faces found;
    if (brunt_fem_faces(fem, &found)) return -1;
    const int32_t sides = fem->element->sheet ? 2 : 1;
    int32_t *number = brunt_alloc((size_t)(fem->node_count + 1) * sizeof *number);
    int32_t count = number ? number_nodes(fem, &found, s->node_count, number) : -1;
    const int32_t had = s->node_count, faces = s->face_count, n = had + (count > 0 ? count : 0) * sides,
                  f = faces + found.count * sides;
    bool failed = count < 0 ||
                  brunt_reserve((void **)&s->node, &s->node_capacity, ((size_t)n + 1) * sizeof *s->node,
                                (size_t)had * sizeof *s->node) ||
                  brunt_reserve((void **)&s->face, &s->face_capacity, ((size_t)f + 1) * sizeof *s->face,
                                (size_t)faces * sizeof *s->face);
    for (int32_t i = 0; !failed && i < fem->node_count; i++)
        if (number[i] >= 0) s->node[number[i]] = i;
    for (int32_t i = 0; !failed && i < found.count; i++)
        for (int c = 0; c < 4; c++) s->face[faces + i][c] = found.node[i][c] < 0 ? -1 : number[found.node[i][c]];
    if (!failed && sides == 2) add_back(s->node + had, count, s->face + faces, found.count);
    s->node_end[k] = had + (count > 0 ? count : 0), s->face_end[k] = faces + found.count;
    s->node_count = n, s->face_count = f;
    s->node_range[k + 1] = n, s->face_range[k + 1] = f;
    brunt_free(number);
    brunt_faces_free(&found);
    return failed ? -1 : 0;
}

// Least height of the elements behind a body's surface [m], as volume over area of the face: what it may have been
// entered by, and still be told from what is behind it.
static int least_height(const brunt_fem_body *fem, double *least) {
    brunt_faces found;
    if (brunt_fem_faces(fem, &found)) return -1;
    *least = INFINITY;
    for (int32_t f = 0; f < found.count; f++) {
        double x[BRUNT_ELEMENT_NODES][3], e[3], g[3], square = 0;
        const int32_t *node = found.node[f];
        for (int c = 0; c < fem->element->nodes; c++) {
            const real *at = brunt_fem_node(
                fem, fem->element_node[(size_t)found.element[f] * (size_t)fem->element->nodes + (size_t)c]);
            for (int a = 0; a < 3; a++) x[c][a] = (double)at[a];
        }
        const bool quad = corners(node) == 4;
        const real *p = brunt_fem_node(fem, node[0]), *q = brunt_fem_node(fem, node[1]),
                   *r = brunt_fem_node(fem, node[2]), *t = quad ? brunt_fem_node(fem, node[3]) : r;
        for (int a = 0; a < 3; a++)
            e[a] = (double)(quad ? r[a] - p[a] : q[a] - p[a]), g[a] = (double)(quad ? t[a] - q[a] : r[a] - p[a]);
        for (int a = 0; a < 3; a++) {
            double n = 0.5 * (e[(a + 1) % 3] * g[(a + 2) % 3] - e[(a + 2) % 3] * g[(a + 1) % 3]);
            square += n * n;
        }
        if (square > 0) *least = fmin(*least, fem->element->volume((const double(*)[3])x) / sqrt(square));
    }
    brunt_faces_free(&found);
    return 0;
}

// What sheets need besides, when there are any.
static int add_sheets(brunt_contact_surface *s) {
    int32_t last = 0;
    bool any = false;
    for (int k = 0; k < s->fem_count; k++) {
        any = any || s->fem[k]->element->sheet;
        last = s->fem[k]->index > last ? s->fem[k]->index : last;
    }
    if (!any) return 0;
    s->front = brunt_alloc(s->node_room * sizeof *s->front);
    s->side = brunt_alloc(((size_t)last + 1) * sizeof *s->side);
    if (!s->front || !s->side) return -1;
    for (int k = 0; k < s->fem_count; k++) {
        const brunt_fem_body *fem = s->fem[k];
        brunt_side *side = &s->side[fem->index];
        if (!fem->element->sheet) {
            if (least_height(fem, &side->shallow)) return -1;
            side->shallow *= 0.5;
            continue;
        }
        side->half = 0.5 * (double)fem->contact_thickness;
        s->thickest = fmax(s->thickest, (double)fem->contact_thickness);
    }
    return 0;
}

// Owners of nodes and faces, and what follows from the lists of them.
static int relate(brunt_contact_surface *s) {
    if (brunt_reserve((void **)&s->body, &s->body_capacity, ((size_t)s->node_count + 1) * sizeof *s->body, 0))
        return -1;
    for (int k = 0; k < s->fem_count; k++) {
        const int32_t index = s->fem[k]->index, nodes = s->node_end[k] - s->node_range[k];
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) s->body[n] = index;
        for (int32_t f = s->face_range[k]; f < s->face_range[k + 1]; f++) s->face_body[f] = index;
        for (int32_t n = s->node_range[k]; s->front && n < s->node_range[k + 1]; n++)
            s->front[n] = n < s->node_end[k] ? n : n - nodes;
        if (s->side && s->fem[k]->element->sheet) s->side[index].faces = s->face_end[k] - s->face_range[k];
    }
    link_faces(s);
    return 0;
}

static int add_shells(brunt_contact_surface *s) {
    int32_t last = 0;
    for (int k = 0; k < s->fem_count; k++) last = s->fem[k]->index > last ? s->fem[k]->index : last;
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->fem[k]->bonds) continue;
        if (!s->shell && !(s->shell = brunt_alloc(((size_t)s->fem_count + 1) * sizeof *s->shell))) return -1;
        if (!s->ragged && !(s->ragged = brunt_alloc((size_t)last + 1))) return -1;
        if (brunt_topology_make(&s->shell[k], s->fem[k])) return -1;
        s->ragged[s->fem[k]->index] = true;
    }
    return 0;
}

int brunt_surface_make(brunt_contact_surface *s, brunt_fem_body **fem, int count, bool affine) {
    *s = (brunt_contact_surface){
        .fem_count = count, .dim = count ? fem[0]->dim : 3, .axisymmetric = count && fem[0]->element->axisymmetric};
    size_t k1 = (size_t)count + 1;
    s->fem = brunt_alloc(k1 * sizeof *s->fem);
    s->node_range = brunt_alloc(k1 * sizeof *s->node_range), s->face_range = brunt_alloc(k1 * sizeof *s->face_range);
    s->low = brunt_alloc(k1 * sizeof *s->low), s->high = brunt_alloc(k1 * sizeof *s->high);
    s->mean = brunt_alloc(k1 * sizeof *s->mean), s->speed = brunt_alloc(k1 * sizeof *s->speed);
    s->active = brunt_alloc(k1), s->was_active = brunt_alloc(k1);
    s->node_end = brunt_alloc(k1 * sizeof *s->node_end), s->face_end = brunt_alloc(k1 * sizeof *s->face_end);
    if (!s->node_end || !s->face_end || !s->fem || !s->node_range || !s->face_range || !s->low || !s->high ||
        !s->active || !s->was_active || !s->mean || !s->speed)
        return -1;
    for (int k = 0; k < count; k++) {
        s->fem[k] = fem[k];
        if (add_body(s, k)) return -1;
    }
    if (make_room(s, s->node_count, s->face_count) || add_sheets(s) || relate(s) || add_shells(s)) return -1;
    for (int32_t n = 0; n < s->node_count; n++) s->gap[n] = INFINITY;
    int32_t edges = 0;
    double sum = edge_sum(s, &edges);
    s->mean_edge = edges ? sum / edges : 0;
    for (int k = 0; s->side && k < count; k++)
        s->side[fem[k]->index].shallow = fmin(s->side[fem[k]->index].shallow, SHALLOW * s->mean_edge);
    if (affine && !(s->affine = brunt_alloc(s->node_room * sizeof *s->affine))) return -1;
    return 0;
}

static int ascending(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) - (*(const int32_t *)a < *(const int32_t *)b);
}

// Faces of the front within two rings of node n, each once, into `list`, which has room for them. Their count.
static int32_t list_rings(const brunt_contact_surface *s, int32_t n, int32_t *list) {
    int32_t count = 0, kept = 0;
    for (int32_t p = s->face_first[n]; p < s->face_first[n + 1]; p++)
        for (int c = 0; c < corners(s->face[s->face_of[p]]); c++) {
            const int32_t other = s->face[s->face_of[p]][c];
            for (int32_t q = s->face_first[other]; q < s->face_first[other + 1]; q++) list[count++] = s->face_of[q];
        }
    qsort(list, (size_t)count, sizeof *list, ascending);
    for (int32_t i = 0; i < count; i++)
        if (!i || list[i] != list[i - 1]) list[kept++] = list[i];
    return kept;
}

static int make_rings(brunt_contact_surface *s) {
    size_t most = 0, used = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        const size_t at = (size_t)(s->face_first[n + 1] - s->face_first[n]);
        most = at > most ? at : most;
    }
    if (brunt_reserve(&s->spare, &s->spare_capacity, (4 * most * most + 1) * sizeof(int32_t), 0) ||
        brunt_reserve((void **)&s->ring_first, &s->ring_first_capacity,
                      ((size_t)s->node_count + 2) * sizeof *s->ring_first, 0))
        return -1;
    int32_t *list = s->spare;
    s->ring_first[0] = 0;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            const int32_t count = s->self[k] && n < s->node_end[k] ? list_rings(s, n, list) : 0;
            if (brunt_reserve((void **)&s->ring_face, &s->ring_face_capacity, (used + (size_t)count + 1) * sizeof *list,
                              used * sizeof *list))
                return -1;
            memcpy(s->ring_face + used, list, (size_t)count * sizeof *list);
            used += (size_t)count;
            s->ring_first[n + 1] = (int32_t)used;
        }
    return 0;
}

int brunt_surface_patches(brunt_contact_surface *s, const bool *self) {
    if (!(s->self = brunt_alloc((size_t)s->fem_count + 1))) return -1;
    memcpy(s->self, self, (size_t)s->fem_count);
    return make_rings(s);
}

void brunt_surface_free(brunt_contact_surface *s) {
    void *owned[] = {s->fem,
                     s->node_range,
                     s->face_range,
                     s->low,
                     s->high,
                     s->active,
                     s->node,
                     s->body,
                     s->face,
                     s->face_body,
                     s->x,
                     s->v,
                     s->old,
                     s->mass,
                     s->inverse,
                     s->normal,
                     s->area,
                     s->gap,
                     s->impulse,
                     s->state,
                     s->face_normal,
                     s->face_centre,
                     s->face_area,
                     s->face_box,
                     s->was_active,
                     s->chunk_moved,
                     s->mean,
                     s->speed,
                     s->face_first,
                     s->face_of,
                     s->affine,
                     s->node_end,
                     s->face_end,
                     s->front,
                     s->side,
                     s->ring_first,
                     s->ring_face,
                     s->self,
                     s->next_node,
                     s->next_face,
                     s->spare,
                     s->change.node_was,
                     s->change.face_now,
                     s->ragged};
    for (int k = 0; s->shell && k < s->fem_count; k++) brunt_topology_free(&s->shell[k]);
    brunt_free(s->shell);
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *s = (brunt_contact_surface){0};
}

// ------------------------------------------------------------------------------------------ after erosion

// Numbers of nodes and faces of a body, of one side: first and count.
typedef struct extent {
    int32_t node, nodes, face, faces;
} extent;

static void keep_body(brunt_contact_surface *s, int32_t sides, const extent *was, const extent *is) {
    for (int32_t n = 0; n < sides * was->nodes; n++) {
        s->next_node[is->node + n] = s->node[was->node + n];
        s->change.node_was[is->node + n] = was->node + n;
    }
    for (int32_t f = 0; f < sides * was->faces; f++) {
        for (int c = 0; c < 4; c++) {
            const int32_t node = s->face[was->face + f][c];
            s->next_face[is->face + f][c] = node < 0 ? -1 : node - was->node + is->node;
        }
        s->change.face_now[was->face + f] = is->face + f;
    }
}

static void renew_body(brunt_contact_surface *s, int k, int32_t sides, const extent *was, const extent *is) {
    const brunt_surface_topology *shell = &s->shell[k];
    const brunt_fem_body *fem = s->fem[k];
    for (int32_t n = 0; n < fem->node_count; n++) {
        if (shell->number[n] < 0) continue;
        const int32_t at = shell->number[n], before = shell->number_before[n];
        s->next_node[is->node + at] = n;
        for (int32_t side = 0; side < sides; side++)
            s->change.node_was[is->node + side * is->nodes + at] =
                before < 0 ? -1 : was->node + side * was->nodes + before;
    }
    for (int32_t f = 0; f < is->faces; f++) {
        int32_t node[4];
        brunt_topology_face(shell, fem, f, node);
        for (int c = 0; c < 4; c++)
            s->next_face[is->face + f][c] = node[c] < 0 ? -1 : is->node + shell->number[node[c]];
    }
    if (sides == 2) add_back(s->next_node + is->node, is->nodes, s->next_face + is->face, is->faces);
    for (int32_t f = 0, now = 0; f < was->faces; f++) { // both lists ascend
        while (now < is->faces && shell->key[now] < shell->before[f]) now++;
        const bool stays = now < is->faces && shell->key[now] == shell->before[f];
        for (int32_t side = 0; side < sides; side++)
            s->change.face_now[was->face + side * was->faces + f] = stays ? is->face + side * is->faces + now : -1;
    }
}

// An array by nodes in their new order; those that are new get zeros.
static int reorder(brunt_contact_surface *s, void *array, size_t bytes) {
    if (!array) return 0;
    if (brunt_reserve(&s->spare, &s->spare_capacity, (size_t)s->node_count * bytes + 1, 0)) return -1;
    for (int32_t n = 0; n < s->node_count; n++) {
        char *to = (char *)s->spare + (size_t)n * bytes;
        if (s->change.node_was[n] < 0)
            memset(to, 0, bytes);
        else
            memcpy(to, (char *)array + (size_t)s->change.node_was[n] * bytes, bytes);
    }
    memcpy(array, s->spare, (size_t)s->node_count * bytes);
    return 0;
}

// What is known of nodes from step to step, or told to others until the next one. A new node has not moved by more than
// the frame since the step began.
static int keep_nodes(brunt_contact_surface *s) {
    if (reorder(s, s->x, sizeof *s->x) || reorder(s, s->affine, sizeof *s->affine) ||
        reorder(s, s->gap, sizeof *s->gap) || reorder(s, s->impulse, sizeof *s->impulse) ||
        reorder(s, s->state, sizeof *s->state) || reorder(s, s->area, sizeof *s->area) ||
        reorder(s, s->mass, sizeof *s->mass))
        return -1;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            if (s->change.node_was[n] >= 0) continue;
            s->gap[n] = INFINITY;
            for (int a = 0; a < 3; a++)
                s->x[n][a] = (double)brunt_fem_node(s->fem[k], s->node[n])[a] - s->frame_step[a];
        }
    return 0;
}

static extent extent_of(const brunt_contact_surface *s, int k) {
    return (extent){s->node_range[k], s->node_end[k] - s->node_range[k], s->face_range[k],
                    s->face_end[k] - s->face_range[k]};
}

static int list_anew(brunt_contact_surface *s) {
    int64_t nodes = 0, faces = 0;
    for (int k = 0; k < s->fem_count; k++) {
        const extent was = extent_of(s, k);
        const int sides = s->fem[k]->element->sheet ? 2 : 1;
        nodes += sides * (int64_t)(s->shell[k].changed ? s->shell[k].number_count : was.nodes);
        faces += sides * (int64_t)(s->shell[k].changed ? s->shell[k].key_count : was.faces);
    }
    brunt_surface_change *c = &s->change;
    if (brunt_reserve((void **)&s->next_node, &s->next_node_capacity, ((size_t)nodes + 1) * sizeof *s->node, 0) ||
        brunt_reserve((void **)&s->next_face, &s->next_face_capacity, ((size_t)faces + 1) * sizeof *s->face, 0) ||
        brunt_reserve((void **)&c->node_was, &c->node_was_capacity, ((size_t)nodes + 1) * sizeof(int32_t), 0) ||
        brunt_reserve((void **)&c->face_now, &c->face_now_capacity, ((size_t)s->face_count + 1) * sizeof(int32_t), 0) ||
        make_room(s, (int32_t)nodes, (int32_t)faces))
        return -1;
    c->node_count = s->node_count, c->face_count = s->face_count;
    extent is = {0}, was = s->fem_count ? extent_of(s, 0) : is;
    for (int k = 0; k < s->fem_count; k++) {
        const int32_t sides = s->fem[k]->element->sheet ? 2 : 1;
        is.nodes = s->shell[k].changed ? s->shell[k].number_count : was.nodes;
        is.faces = s->shell[k].changed ? s->shell[k].key_count : was.faces;
        if (s->shell[k].changed)
            renew_body(s, k, sides, &was, &is);
        else
            keep_body(s, sides, &was, &is);
        if (k + 1 < s->fem_count) was = extent_of(s, k + 1);
        s->node_range[k] = is.node, s->node_end[k] = is.node + is.nodes;
        s->face_range[k] = is.face, s->face_end[k] = is.face + is.faces;
        is.node += sides * is.nodes, is.face += sides * is.faces;
    }
    s->node_range[s->fem_count] = is.node, s->face_range[s->fem_count] = is.face;
    s->node_count = is.node, s->face_count = is.face;
    return 0;
}

static void swap_lists(brunt_contact_surface *s) {
    int32_t *const node = s->node, (*const face)[4] = s->face;
    const size_t nodes = s->node_capacity, faces = s->face_capacity;
    s->node = s->next_node, s->node_capacity = s->next_node_capacity;
    s->face = s->next_face, s->face_capacity = s->next_face_capacity;
    s->next_node = node, s->next_node_capacity = nodes;
    s->next_face = face, s->next_face_capacity = faces;
}

int brunt_surface_renew(brunt_contact_surface *s, bool restored) {
    s->change.any = false;
    if (!s->shell) return 0;
    int failed = 0;
    for (int k = 0; !failed && k < s->fem_count; k++) {
        const int renewed = s->shell[k].elements ? brunt_topology_renew(&s->shell[k], s->fem[k], restored) : 0;
        if (renewed < 0) failed = -1;
        s->shell[k].changed = renewed > 0;
        s->change.any = s->change.any || renewed > 0;
    }
    if (failed || !s->change.any) return failed;
    if (list_anew(s)) return -1;
    swap_lists(s);
    return keep_nodes(s) || relate(s) || (s->self && make_rings(s)) ? -1 : 0;
}

int64_t brunt_surface_slots(const brunt_contact_surface *s) {
    if (!s->shell) return s->node_count;
    int64_t sum = 0;
    for (int k = 0; k < s->fem_count; k++) sum += (s->fem[k]->element->sheet ? 2 : 1) * (int64_t)s->fem[k]->node_count;
    return sum;
}

int64_t brunt_surface_slot(const brunt_contact_surface *s, int k, int32_t n) {
    if (!s->shell) return n;
    int64_t first = n < s->node_end[k] ? 0 : s->fem[k]->node_count;
    for (int i = 0; i < k; i++) first += (s->fem[i]->element->sheet ? 2 : 1) * (int64_t)s->fem[i]->node_count;
    return first + s->node[n];
}

int64_t brunt_surface_affine_count(const brunt_contact_surface *s) { return 9 * brunt_surface_slots(s); }

void brunt_surface_affine_get(const brunt_contact_surface *s, double *out) {
    memset(out, 0, (size_t)brunt_surface_affine_count(s) * sizeof *out);
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            memcpy(out + 9 * brunt_surface_slot(s, k, n), s->affine[n], sizeof *s->affine);
}

void brunt_surface_affine_set(brunt_contact_surface *s, const double *in) {
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            memcpy(s->affine[n], in + 9 * brunt_surface_slot(s, k, n), sizeof *s->affine);
}

// ------------------------------------------------------------------------------------------ each step

typedef struct job {
    brunt_contact_surface *skin;
    double dt;
    const double *gravity;
} job;

static void bound_bodies(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->skin;
    for (int64_t k = begin; k < end; k++) {
        double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        double sum[3] = {0}, fastest = 0;
        const int32_t count = s->node_end[k] - s->node_range[k];
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            const real *at = brunt_fem_node(s->fem[k], s->node[n]);
            double square = 0;
            for (int a = 0; a < 3; a++) {
                double x = (double)at[a], v = (double)at[BRUNT_FEM_V + a], own = v - s->frame[a];
                low[a] = x < low[a] ? x : low[a], high[a] = x > high[a] ? x : high[a];
                sum[a] += v;
                square += own * own;
            }
            fastest = square > fastest ? square : fastest;
        }
        for (int a = 0; a < 3; a++)
            s->low[k][a] = low[a], s->high[k][a] = high[a], s->mean[k][a] = count ? sum[a] / count : 0;
        s->speed[k] = sqrt(fastest);
    }
}

void brunt_surface_bounds(brunt_contact_surface *s, int threads, brunt_timer *timer) {
    job j = {.skin = s};
    brunt_parallel(threads, s->fem_count, 1, bound_bodies, &j, timer);
}

// The first node or face from `item` on, by their `range`, that an active body has; `k` becomes that body.
static int32_t next_active(const brunt_contact_surface *s, const int32_t *range, int32_t item, int *k) {
    for (; *k < s->fem_count && (range[*k + 1] <= item || !s->active[*k]); ++*k)
        if (item < range[*k + 1]) item = range[*k + 1];
    return item;
}

static void take_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_contact_surface *s = j->skin;
    int k = 0;
    double furthest = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        const brunt_fem_body *fem = s->fem[k];
        const int32_t node = s->node[n];
        const real *at = brunt_fem_node(fem, node);
        real force[3];
        brunt_fem_internal_force(fem, node, force);
        double inverse = 1 / (double)at[BRUNT_FEM_MASS], moved = 0;
        s->mass[n] = fem->drag_mass * (double)at[BRUNT_FEM_MASS]; // drag takes its share of impulses
        for (int a = 0; a < 3; a++) {
            bool held = (fem->held && fem->held[node] >> a & 1) || a >= s->dim;
            double load = (double)force[a] + (fem->load ? (double)fem->load[4 * (size_t)node + (size_t)a] : 0);
            double step = (double)at[a] - s->x[n][a] - s->frame_step[a];
            moved += step * step;
            s->x[n][a] = (double)at[a];
            s->v[n][a] = (double)at[BRUNT_FEM_V + a];
            s->old[n][a] = held ? s->v[n][a] : s->v[n][a] - j->dt * (load * inverse + j->gravity[a]);
            s->inverse[n][a] = held ? 0 : inverse / fem->drag_mass;
            s->impulse[n][a] = 0;
        }
        s->gap[n] = INFINITY;
        s->state[n] = 0;
        furthest = moved > furthest ? moved : furthest;
    }
    s->chunk_moved[begin / GRAIN] = furthest;
}

static void take_chunks(void *context, int64_t begin, int64_t end, int worker) {
    const int32_t count = ((const job *)context)->skin->node_count;
    for (int64_t c = begin; c < end; c++)
        take_nodes(context, c * GRAIN, (c + 1) * GRAIN < count ? (c + 1) * GRAIN : count, worker);
}

static void make_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t f = (int32_t)begin; (f = next_active(s, s->face_range, f, &k)) < end; f++) {
        const int32_t *node = s->face[f];
        const int n = corners(node);
        double normal[3] = {0}, size = 0;
        const double *p = s->x[node[0]], *q = s->x[node[1]], *r = n > 2 ? s->x[node[2]] : p,
                     *t = n > 3 ? s->x[node[3]] : p;
        double e[3], g[3];
        for (int a = 0; a < 3; a++) {
            e[a] = n > 3 ? r[a] - p[a] : q[a] - p[a];
            g[a] = n > 3 ? t[a] - q[a] : n > 2 ? r[a] - p[a] : 0;
            s->face_centre[f][a] = (p[a] + q[a] + (n > 2 ? r[a] : 0) + (n > 3 ? t[a] : 0)) / n;
        }
        if (n == 2) {
            normal[0] = e[1], normal[1] = -e[0];
        } else {
            for (int a = 0; a < 3; a++) {
                int i = (a + 1) % 3, l = (a + 2) % 3;
                normal[a] = 0.5 * (e[i] * g[l] - e[l] * g[i]);
            }
        }
        for (int a = 0; a < 3; a++) size += normal[a] * normal[a];
        size = sqrt(size);
        s->face_area[f] = size;
        for (int a = 0; a < 3; a++) {
            double low = p[a] < q[a] ? p[a] : q[a], high = p[a] < q[a] ? q[a] : p[a];
            if (n > 2) low = r[a] < low ? r[a] : low, high = r[a] > high ? r[a] : high;
            if (n > 3) low = t[a] < low ? t[a] : low, high = t[a] > high ? t[a] : high;
            s->face_box[f][a] = low, s->face_box[f][3 + a] = high;
        }
        for (int a = 0; a < 3; a++) s->face_normal[f][a] = size > 0 ? normal[a] / size : 0;
    }
}

static void make_normals(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        double sum[3] = {0}, area = 0, whole = 0, size = 0;
        for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
            int32_t f = s->face_of[q];
            double share = s->face_area[f] / corners(s->face[f]);
            area += share;
            whole += brunt_surface_nodal_area(s, f, n);
            for (int a = 0; a < 3; a++) sum[a] += share * s->face_normal[f][a];
        }
        if (s->axisymmetric && s->x[n][0] == 0) sum[0] = 0; // the other side of the axis
        for (int a = 0; a < 3; a++) size += sum[a] * sum[a];
        size = sqrt(size);
        s->area[n] = whole;
        const bool ragged = s->ragged && s->ragged[s->body[n]] && !s->fem[k]->element->sheet;
        for (int a = 0; a < 3; a++) s->normal[n][a] = size > (ragged ? CLEAR : 1e-9) * area ? sum[a] / size : 0;
    }
}

void brunt_surface_gather_state(brunt_contact_surface *s, double dt, const double gravity[3], int threads,
                                brunt_timer *timer) {
    job j = {s, dt, gravity};
    brunt_parallel(threads, (s->node_count + GRAIN - 1) / GRAIN, 1, take_chunks, &j, timer);
    s->moved = 0;
    for (int32_t c = 0; c < (s->node_count + GRAIN - 1) / GRAIN; c++) s->moved = fmax(s->moved, s->chunk_moved[c]);
    s->moved = sqrt(s->moved);
    for (int k = 0; k < s->fem_count; k++) {
        if (s->active[k] && !s->was_active[k]) s->moved = INFINITY; // where it was before is not known
        s->was_active[k] = s->active[k];
    }
    brunt_parallel(threads, s->face_count, GRAIN, make_faces, &j, timer);
    brunt_parallel(threads, s->node_count, GRAIN, make_normals, &j, timer);
}

static void give_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_contact_surface *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        if (n >= s->node_end[k]) continue;
        real *at = brunt_fem_node(s->fem[k], s->node[n]);
        for (int a = 0; a < 3; a++) at[BRUNT_FEM_V + a] = (real)s->v[n][a];
    }
}

void brunt_surface_scatter_velocity(brunt_contact_surface *s, double dt, int threads, brunt_timer *timer) {
    job j = {.skin = s};
    brunt_parallel(threads, s->node_count, GRAIN, give_nodes, &j, timer);
    for (int a = 0; a < 3; a++) {
        s->frame[a] = 0;
        for (int k = 0; k < s->fem_count; k++) s->frame[a] += s->mean[k][a] / s->fem_count;
        s->frame_step[a] = s->frame[a] * dt;
    }
}
