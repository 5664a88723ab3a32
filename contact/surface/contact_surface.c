// The surfaces of all meshes in one numbering: made, and freed.
#include "contact/surface/surface_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/array.h"
#include "base/memory.h"

enum { GRAIN = BRUNT_SURFACE_GRAIN };
static const double SHALLOW =
    0.25; // mean edges: how far a node may get behind a membrane, at most, and still be sent back

// Nodes that have a face, ascending; `number` gets their surface numbers, from `first`. Their count.
static int32_t number_nodes(const brunt_fem_body *fem, const brunt_faces *faces, int32_t first, int32_t *number) {
    for (int32_t n = 0; n < fem->node_count; n++) number[n] = -1;
    for (int32_t f = 0; f < faces->count; f++)
        for (int k = 0; k < brunt_face_corners(faces->node[f]); k++) number[faces->node[f][k]] = 0;
    int32_t next = first;
    for (int32_t n = 0; n < fem->node_count; n++)
        if (number[n] == 0) number[n] = next++;
    return next - first;
}

// What there is one of for each body, and for each node, and for each face, beside the lists themselves.
// clang-format off
#define BODY_ARRAYS(X) \
    X(fem) X(node_range) X(face_range) X(low) X(high) X(active) X(node_end) X(face_end) X(motion.mean) X(motion.speed) \
    X(motion.was_active) X(motion.anew) X(motion.kept) X(motion.travel) X(motion.zone)
#define NODE_ARRAYS(X) \
    X(x, 1) X(v, 1) X(old, 1) X(mass, 1) X(inverse, 1) X(normal, 1) X(area, 1) X(face_first, 1) X(output.gap, 1) \
    X(output.impulse, 1) X(output.state, 1) X(motion.near, 1) X(motion.was, 1) X(affine, s->affine) X(membrane.front, s->membrane.front)
#define FACE_ARRAYS(X) X(face_normal) X(face_centre) X(face_area) X(face_box) X(face_body) X(motion.made)
// clang-format on

static int enlarge(void *array, size_t keep, size_t bytes, brunt_error *error) {
    void *larger = brunt_alloc(bytes), *old;
    if (!larger) return brunt_fail_memory(error, "bytes of nodes and faces of surfaces", bytes, 1);
    memcpy(&old, array, sizeof old);
    if (keep) memcpy(larger, old, keep);
    brunt_free(old);
    memcpy(array, &larger, sizeof larger);
    return BRUNT_OK;
}

// Room for so many nodes and faces, with what is there kept: exactly that at the start, later half as much again, so
// that surfaces that grow seldom ask for it.
int brunt_surface_reserve(brunt_contact_surface *s, int32_t node_count, int32_t face_count, brunt_error *error) {
    const size_t nodes = (size_t)node_count + 2, faces = (size_t)face_count + 1;
    if (nodes > s->node_array_capacity) {
        const size_t room = s->node_array_capacity ? nodes + nodes / 2 : nodes, had = s->node_array_capacity;
        const size_t pieces = room / BRUNT_SURFACE_PIECE + (size_t)s->fem_count + 1,
                     chunks = room / GRAIN + (size_t)s->fem_count + 1;
        int failed = enlarge(&s->motion.chunk, 0, chunks * sizeof *s->motion.chunk, error) ||
                     enlarge(&s->motion.apart, 0, chunks * sizeof *s->motion.apart, error) ||
                     enlarge(&s->motion.piece, 0, pieces * sizeof *s->motion.piece, error);
#define ENLARGE(what, when)                                                                                            \
    if (!failed && (when)) failed = enlarge(&s->what, had * sizeof *s->what, room * sizeof *s->what, error);
        NODE_ARRAYS(ENLARGE)
#undef ENLARGE
        if (failed) return BRUNT_FAILED;
        s->node_array_capacity = room;
    }
    if (faces > s->face_array_capacity) {
        const size_t room = s->face_array_capacity ? faces + faces / 2 : faces, had = s->face_array_capacity;
        int failed = enlarge(&s->face_of, 0, 4 * room * sizeof *s->face_of, error) ||
                     enlarge(&s->motion.widest, 0, (room / GRAIN + 1) * sizeof *s->motion.widest, error);
#define ENLARGE(what)                                                                                                  \
    if (!failed) failed = enlarge(&s->what, had * sizeof *s->what, room * sizeof *s->what, error);
        FACE_ARRAYS(ENLARGE)
#undef ENLARGE
        if (failed) return BRUNT_FAILED;
        s->face_array_capacity = room;
    }
    return BRUNT_OK;
}

static void link_faces(brunt_contact_surface *s) {
    memset(s->face_first, 0, ((size_t)s->node_count + 2) * sizeof *s->face_first);
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < brunt_face_corners(s->face[f]); k++) s->face_first[s->face[f][k] + 2]++;
    for (int32_t n = 2; n <= s->node_count + 1; n++) s->face_first[n] += s->face_first[n - 1];
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < brunt_face_corners(s->face[f]); k++) s->face_of[s->face_first[s->face[f][k] + 1]++] = f;
}

static double edge_sum(const brunt_contact_surface *s, int32_t *edges) {
    double sum = 0;
    int k = 0; // faces lie in the order of the bodies
    for (int32_t f = 0; f < s->face_count; f++) {
        int n = brunt_face_corners(s->face[f]);
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

static int add_body(brunt_contact_surface *s, int k, brunt_error *error) {
    brunt_fem_body *fem = s->fem[k];
    brunt_faces found;
    if (brunt_fem_faces(fem, &found, error)) return BRUNT_FAILED;
    const int32_t sides = fem->traits->membrane ? 2 : 1;
    int32_t *number;
    bool failed = BRUNT_NEW(number, fem->node_count + 1, "numbers of a mesh's nodes in its surface", error);
    const int32_t count = failed ? 0 : number_nodes(fem, &found, s->node_count, number);
    const int32_t had = s->node_count, faces = s->face_count, n = had + count * sides, f = faces + found.count * sides;
    failed = failed || BRUNT_CAPACITY(s->node, (size_t)n + 1, (size_t)had, "surface nodes", error) ||
             BRUNT_CAPACITY(s->face, (size_t)f + 1, (size_t)faces, "surface faces", error);
    for (int32_t i = 0; !failed && i < fem->node_count; i++)
        if (number[i] >= 0) s->node[number[i]] = i;
    for (int32_t i = 0; !failed && i < found.count; i++)
        for (int c = 0; c < 4; c++) s->face[faces + i][c] = found.node[i][c] < 0 ? -1 : number[found.node[i][c]];
    if (!failed && sides == 2) brunt_membrane_add_back(s->node + had, count, s->face + faces, found.count);
    s->node_end[k] = had + count, s->face_end[k] = faces + found.count;
    s->node_count = n, s->face_count = f;
    s->node_range[k + 1] = n, s->face_range[k + 1] = f;
    brunt_free(number);
    brunt_faces_free(&found);
    return failed ? BRUNT_FAILED : BRUNT_OK;
}

// Owners of nodes and faces, and what follows from the lists of them.
int brunt_surface_relate(brunt_contact_surface *s, brunt_error *error) {
    if (BRUNT_CAPACITY(s->body, (size_t)s->node_count + 1, 0, "bodies of surface nodes", error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) {
        const int32_t index = s->fem[k]->index, nodes = s->node_end[k] - s->node_range[k];
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) s->body[n] = index;
        for (int32_t f = s->face_range[k]; f < s->face_range[k + 1]; f++) s->face_body[f] = index;
        for (int32_t n = s->node_range[k]; s->membrane.front && n < s->node_range[k + 1]; n++)
            s->membrane.front[n] = n < s->node_end[k] ? n : n - nodes;
        if (s->membrane.side && s->fem[k]->traits->membrane)
            s->membrane.side[index].faces = s->face_end[k] - s->face_range[k];
    }
    link_faces(s);
    return BRUNT_OK;
}

static int add_topologies(brunt_contact_surface *s, brunt_error *error) {
    int32_t last = 0;
    for (int k = 0; k < s->fem_count; k++) last = s->fem[k]->index > last ? s->fem[k]->index : last;
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->fem[k]->bonds) continue;
        if (!s->renewal.topology && BRUNT_NEW(s->renewal.topology, s->fem_count + 1, "surfaces of meshes", error))
            return BRUNT_FAILED;
        if (!s->renewal.eroded && BRUNT_NEW(s->renewal.eroded, last + 1, "marks of bodies that erode", error))
            return BRUNT_FAILED;
        if (brunt_topology_make(&s->renewal.topology[k], s->fem[k], error)) return BRUNT_FAILED;
        s->renewal.eroded[s->fem[k]->index] = true;
    }
    return BRUNT_OK;
}

int brunt_surface_make(brunt_contact_surface *s, brunt_fem_body **fem, int count, bool affine, brunt_error *error) {
    *s = (brunt_contact_surface){
        .fem_count = count, .dim = count ? fem[0]->dim : 3, .axisymmetric = count && fem[0]->element->axisymmetric};
#define MAKE(what)                                                                                                     \
    if (BRUNT_NEW(s->what, count + 1, "meshes with surfaces", error)) return BRUNT_FAILED;
    BODY_ARRAYS(MAKE)
#undef MAKE
    for (int k = 0; k < count; k++) {
        s->fem[k] = fem[k];
        if (add_body(s, k, error)) return BRUNT_FAILED;
    }
    if (brunt_surface_reserve(s, s->node_count, s->face_count, error) || brunt_membrane_sides_make(s, error) ||
        brunt_surface_relate(s, error) || add_topologies(s, error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < s->node_count; n++) s->output.gap[n] = INFINITY;
    brunt_surface_all_near(s);
    int32_t edges = 0;
    double sum = edge_sum(s, &edges);
    s->mean_edge = edges ? sum / edges : 0;
    for (int k = 0; s->membrane.side && k < count; k++)
        s->membrane.side[fem[k]->index].shallow = fmin(s->membrane.side[fem[k]->index].shallow, SHALLOW * s->mean_edge);
    return affine ? BRUNT_NEW(s->affine, s->node_array_capacity, "affine velocities of nodes", error) : BRUNT_OK;
}

size_t brunt_surface_bytes(const brunt_contact_surface *s) {
    const size_t nodes = s->node_array_capacity, faces = s->face_array_capacity;
    size_t of_body = sizeof *s->motion.piece + sizeof *s->motion.chunk + sizeof *s->motion.apart,
           of_face = 4 * sizeof *s->face_of + sizeof *s->motion.widest / GRAIN,
           of_node = (sizeof *s->motion.chunk + sizeof *s->motion.apart) / GRAIN +
                     sizeof *s->motion.piece / BRUNT_SURFACE_PIECE;
#define ADD(what) of_body += sizeof *s->what;
    BODY_ARRAYS(ADD)
#undef ADD
#define ADD(what, when) of_node += (when) ? sizeof *s->what : 0;
    NODE_ARRAYS(ADD)
#undef ADD
#define ADD(what) of_face += sizeof *s->what;
    FACE_ARRAYS(ADD)
#undef ADD
    return (size_t)(s->fem_count + 1) * of_body + nodes * of_node + faces * of_face + s->node_capacity +
           s->body_capacity + s->face_capacity + s->membrane.patch_first_capacity + s->membrane.patch_face_capacity +
           s->renewal.next_node_capacity + s->renewal.next_face_capacity + s->renewal.spare_capacity;
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
                     s->output.gap,
                     s->output.impulse,
                     s->output.state,
                     s->face_normal,
                     s->face_centre,
                     s->face_area,
                     s->face_box,
                     s->motion.was_active,
                     s->motion.anew,
                     s->motion.kept,
                     s->motion.travel,
                     s->motion.zone,
                     s->motion.near,
                     s->motion.was,
                     s->motion.chunk,
                     s->motion.apart,
                     s->motion.widest,
                     s->motion.made,
                     s->motion.piece,
                     s->motion.mean,
                     s->motion.speed,
                     s->face_first,
                     s->face_of,
                     s->affine,
                     s->node_end,
                     s->face_end,
                     s->membrane.front,
                     s->membrane.side,
                     s->membrane.patch_first,
                     s->membrane.patch_face,
                     s->membrane.self,
                     s->renewal.next_node,
                     s->renewal.next_face,
                     s->renewal.spare,
                     s->renewal.change.node_was,
                     s->renewal.change.face_now,
                     s->renewal.eroded};
    for (int k = 0; s->renewal.topology && k < s->fem_count; k++) brunt_topology_free(&s->renewal.topology[k]);
    brunt_free(s->renewal.topology);
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *s = (brunt_contact_surface){0};
}

void brunt_surface_all_near(brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++)
        for (int a = 0; a < 6; a++) s->motion.zone[k][a] = a < 3 ? -INFINITY : INFINITY;
}

void brunt_surface_meshes(const brunt_contact_surface *s, int body, int *first, int *end) {
    int low = 0, high = s->fem_count;
    *first = 0, *end = s->fem_count;
    if (body < 0) return;
    while (low < high) { // in the order of the bodies
        const int middle = low + (high - low) / 2;
        *(s->fem[middle]->index < body ? &low : &high) = s->fem[middle]->index < body ? middle + 1 : middle;
    }
    *first = low, *end = low + (low < s->fem_count && s->fem[low]->index == body);
}

void brunt_surface_validate(const brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++) {
        BRUNT_ASSERT(s->node_range[k] <= s->node_end[k] && s->node_end[k] <= s->node_range[k + 1]);
        BRUNT_ASSERT(s->face_range[k] <= s->face_end[k] && s->face_end[k] <= s->face_range[k + 1]);
        for (int32_t f = s->face_range[k]; f < s->face_range[k + 1]; f++)
            for (int c = 0; c < 4 && s->face[f][c] >= 0; c++)
                BRUNT_ASSERT(s->face[f][c] >= s->node_range[k] && s->face[f][c] < s->node_range[k + 1]);
    }
    BRUNT_ASSERT(!s->fem_count || s->node_range[s->fem_count] <= s->node_count);
    for (int32_t n = 0; n < s->node_count; n++)
        BRUNT_ASSERT(s->face_first[n] <= s->face_first[n + 1] && s->mass[n] >= 0);
}
