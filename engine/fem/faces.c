// The surface of a mesh, and elements folded in at a corner.
#include <string.h>

#include "fem/layout.h"
#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

static int32_t face_node(const brunt_fem_body *body, int64_t face, int k) {
    const brunt_element_traits *type = body->traits;
    const int64_t slot = face / type->face_count;
    return body->element_node[slot * type->nodes + type->face[face % type->face_count][k]];
}

static int32_t least_node(const brunt_fem_body *body, int64_t face) {
    int32_t least = face_node(body, face, 0);
    for (int k = 1; k < body->traits->face_nodes; k++) {
        int32_t node = face_node(body, face, k);
        if (node < least) least = node;
    }
    return least;
}

static bool same_nodes(const brunt_fem_body *body, int64_t a, int64_t b) {
    const int count = body->traits->face_nodes;
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int j = 0; j < count; j++) found = found || face_node(body, a, i) == face_node(body, b, j);
        if (!found) return false;
    }
    return true;
}

// Of rings, the axis is no surface.
static bool on_axis(const brunt_fem_body *body, int64_t face) {
    return body->element->axisymmetric && body->start[4 * (size_t)face_node(body, face, 0)] == 0 &&
           body->start[4 * (size_t)face_node(body, face, 1)] == 0;
}

// The nodes of a face in their order, by which most faces are compared: those of different nodes each.
typedef struct sorted_face {
    int32_t node[4];
    bool distinct;
} sorted_face;

static sorted_face sort_face(const brunt_fem_body *body, int64_t face) {
    sorted_face sorted = {{-1, -1, -1, -1}, true};
    for (int k = 0; k < body->traits->face_nodes; k++) {
        const int32_t node = face_node(body, face, k);
        int at = k;
        for (; at > 0 && sorted.node[at - 1] > node; at--) sorted.node[at] = sorted.node[at - 1];
        sorted.node[at] = node;
    }
    for (int k = 1; k < body->traits->face_nodes; k++)
        sorted.distinct = sorted.distinct && sorted.node[k] != sorted.node[k - 1];
    return sorted;
}

// Marks the faces of a bin that no other one is equal to, but for those on the axis. How many.
static int32_t find_alone(const brunt_fem_body *body, const int64_t *list, int64_t count, sorted_face *sorted,
                          uint8_t *outside) {
    int32_t found = 0;
    for (int64_t i = 0; i < count; i++) sorted[i] = sort_face(body, list[i]);
    for (int64_t i = 0; i < count; i++) {
        bool alone = !on_axis(body, list[i]);
        for (int64_t j = 0; alone && j < count && !body->traits->membrane;
             j++) { // a membrane's element is its one face
            if (i == j) continue;
            const bool same = !memcmp(sorted[i].node, sorted[j].node, sizeof sorted[i].node);
            alone = !same && ((sorted[i].distinct && sorted[j].distinct) || !same_nodes(body, list[i], list[j]));
        }
        outside[list[i]] = alone;
        found += alone;
    }
    return found;
}

// Marks which faces of the elements are the surface's. How many; BRUNT_NONE: out of memory. Faces are put into a bin by
// their least node, where the few others that can be equal are.
static int32_t mark_outside(const brunt_fem_body *body, int64_t count, uint8_t *outside, brunt_error *error) {
    const int each = body->traits->face_count;
    int64_t *first, *list = NULL, most = 0;
    int32_t *least = NULL, found = BRUNT_NONE;
    sorted_face *sorted = NULL;
    bool made = !BRUNT_NEW(first, body->node_count + 2, "nodes of a mesh", error) &&
                !BRUNT_NEW(list, count, "faces of elements of a mesh", error) &&
                !BRUNT_NEW(least, count, "faces of elements of a mesh", error);
    for (int64_t f = 0; f < count && made; f++) {
        least[f] = body->element_id[f / each] >= 0 ? least_node(body, f) : -1;
        if (least[f] >= 0) first[least[f] + 2]++;
    }
    for (int32_t n = 0; n < body->node_count && made; n++) {
        most = first[n + 2] > most ? first[n + 2] : most;
        first[n + 2] += first[n + 1];
    }
    made = made && !BRUNT_NEW(sorted, most, "faces of elements of a mesh", error);
    for (int64_t f = 0; f < count && made; f++)
        if (least[f] >= 0) list[first[least[f] + 1]++] = f;
    if (made) found = 0;
    for (int32_t n = 0; n < body->node_count && made; n++)
        found += find_alone(body, list + first[n], first[n + 1] - first[n], sorted, outside);
    brunt_free(first), brunt_free(list), brunt_free(least), brunt_free(sorted);
    return found;
}

int brunt_fem_faces(const brunt_fem_body *body, brunt_faces *faces, brunt_error *error) {
    const brunt_element_traits *type = body->traits;
    *faces = (brunt_faces){0};
    const int64_t count = (int64_t)body->slots * type->face_count;
    uint8_t *outside;
    if (BRUNT_NEW(outside, count, "faces of elements of a mesh", error)) return BRUNT_FAILED;
    const int32_t found = mark_outside(body, count, outside, error);
    const bool made = found >= 0 && !BRUNT_NEW(faces->node, found, "faces of a surface", error) &&
                      !BRUNT_NEW(faces->element, found, "faces of a surface", error);
    for (int64_t f = 0; f < count && made; f++) {
        if (!outside[f]) continue;
        for (int k = 0; k < 4; k++) faces->node[faces->count][k] = k < type->face_nodes ? face_node(body, f, k) : -1;
        faces->element[faces->count++] = (int32_t)(f / type->face_count);
    }
    if (!made) brunt_faces_free(faces);
    brunt_free(outside);
    return made ? BRUNT_OK : BRUNT_FAILED;
}

void brunt_faces_free(brunt_faces *faces) {
    brunt_free(faces->node);
    brunt_free(faces->element);
    *faces = (brunt_faces){0};
}

static bool corner_folded(const brunt_element_traits *type, const double (*x)[3], int corner) {
    double e[3][3] = {{0}};
    for (int k = 0; k < type->span; k++)
        for (int i = 0; i < 3; i++) e[k][i] = x[type->corner[corner][k]][i] - x[corner][i];
    double in_plane = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    if (type->span == 2) return in_plane <= 0;
    return in_plane * e[2][2] + (e[0][1] * e[1][2] - e[0][2] * e[1][1]) * e[2][0] +
               (e[0][2] * e[1][0] - e[0][0] * e[1][2]) * e[2][1] <=
           0;
}

int32_t brunt_fem_folded(const brunt_fem_body *body) {
    const brunt_element_traits *type = body->traits;
    int32_t folded = 0;
    for (int32_t s = 0; s < body->slots && body->element->hourglass_modes; s++) {
        if (body->element_id[s] < 0) continue;
        double x[BRUNT_ELEMENT_NODES][3];
        for (int a = 0; a < type->nodes; a++) {
            const real *node = brunt_fem_node(body, body->element_node[(int64_t)s * type->nodes + a]);
            for (int i = 0; i < 3; i++) x[a][i] = (double)node[i];
        }
        bool any = false;
        if (type->membrane) brunt_fem_flatten(type->nodes, x);
        for (int a = 0; a < type->nodes; a++) any = any || corner_folded(type, (const double(*)[3])x, a);
        folded += any;
    }
    return folded;
}
