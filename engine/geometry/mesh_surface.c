// The surface of a structured mesh as a mesh of membranes: membranes wrapped around a shape, or one face of it.
//
// Quadrilaterals are the outer faces of the shape's hexahedra, triangles those of its tetrahedra: these are cut so that
// a mesh keeps the mirror symmetry of its shape (see mesh_shape_split.c), which one diagonal for all would not.
#include <stdio.h>
#include <string.h>

#include "brunt.h"
#include "base/error.h"
#include "base/memory.h"
#include "geometry/element_traits.h"

// What of the volume's mesh becomes membranes.
typedef struct surface {
    const brunt_element_traits *of; // the element of the volume
    const brunt_mesh *volume;
    int32_t (*face)[4]; // the first of->face_nodes are used
    int32_t count;
} surface;

// ---------------------------------------------------------------------------------------------------- outer faces

static void face_nodes(const surface *s, int64_t face, int32_t node[4]) {
    const int nodes = s->of->nodes;
    const int32_t *element = s->volume->elements + face / s->of->face_count * nodes;
    for (int c = 0; c < s->of->face_nodes; c++) node[c] = element[s->of->face[face % s->of->face_count][c]];
}

static int32_t least(const int32_t *node, int corners) {
    int32_t value = node[0];
    for (int c = 1; c < corners; c++)
        if (node[c] < value) value = node[c];
    return value;
}

static bool same(const int32_t *a, const int32_t *b, int corners) {
    int found = 0;
    for (int i = 0; i < corners; i++)
        for (int j = 0; j < corners; j++) found += a[i] == b[j];
    return found == corners;
}

// Numbers of all faces by their least node: those of node n are list[first[n]] to list[first[n + 1] - 1].
static bool sort_faces(const surface *s, int64_t **first, int64_t **list) {
    const int64_t faces = (int64_t)s->volume->element_count * s->of->face_count;
    *first = brunt_alloc(((size_t)s->volume->node_count + 2) * sizeof **first);
    *list = brunt_alloc((size_t)faces * sizeof **list);
    if (!*first || !*list) return false;
    int32_t node[4] = {0};
    for (int64_t f = 0; f < faces; f++) {
        face_nodes(s, f, node);
        (*first)[least(node, s->of->face_nodes) + 2]++;
    }
    for (int32_t n = 0; n < s->volume->node_count; n++) (*first)[n + 2] += (*first)[n + 1];
    for (int64_t f = 0; f < faces; f++) {
        face_nodes(s, f, node);
        (*list)[(*first)[least(node, s->of->face_nodes) + 1]++] = f;
    }
    return true;
}

// Whether only one element has the face.
static bool is_outer(const surface *s, int64_t face, const int64_t *first, const int64_t *list) {
    int32_t node[4] = {0}, other[4] = {0};
    face_nodes(s, face, node);
    const int32_t bin = least(node, s->of->face_nodes);
    for (int64_t k = first[bin]; k < first[bin + 1]; k++) {
        if (list[k] == face) continue;
        face_nodes(s, list[k], other);
        if (same(node, other, s->of->face_nodes)) return false;
    }
    return true;
}

static bool find_surface(surface *s) {
    const int64_t faces = (int64_t)s->volume->element_count * s->of->face_count;
    int64_t *first = NULL, *list = NULL;
    bool done = sort_faces(s, &first, &list);
    int32_t count = 0;
    for (int64_t f = 0; f < faces && done; f++) count += is_outer(s, f, first, list);
    s->face = brunt_alloc((size_t)count * sizeof *s->face);
    done = done && s->face;
    for (int64_t f = 0; f < faces && done; f++)
        if (is_outer(s, f, first, list)) face_nodes(s, f, s->face[s->count++]);
    brunt_free(first);
    brunt_free(list);
    return done;
}

// ---------------------------------------------------------------------------------------------------- named faces

static const brunt_group *find_group(const brunt_mesh *mesh, const char *name) {
    for (int32_t g = 0; g < mesh->group_count; g++)
        if (!strcmp(mesh->groups[g].name, name)) return &mesh->groups[g];
    return NULL;
}

static int refuse_name(const brunt_mesh *mesh, const char *name, brunt_error *error) {
    char names[512] = "";
    size_t at = 0;
    for (int32_t g = 0; g < mesh->group_count && at < sizeof names; g++)
        at += (size_t)snprintf(names + at, sizeof names - at, "%s%s", g ? ", " : "", mesh->groups[g].name);
    return brunt_fail(error, BRUNT_BAD_INPUT, "the shape has no face '%s'; there are: %s", name, names);
}

// Keeps the faces whose nodes are all in one of the named groups.
static int keep_faces(surface *s, const char (*names)[BRUNT_NAME_LENGTH], int32_t name_count, brunt_error *error) {
    uint8_t *marked = brunt_alloc((size_t)s->volume->node_count), *kept = brunt_alloc((size_t)s->count);
    int status = marked && kept ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "no memory for the faces of a shape");
    for (int32_t k = 0; k < name_count && !status; k++) {
        const brunt_group *group = find_group(s->volume, names[k]);
        if (!group) {
            status = refuse_name(s->volume, names[k], error);
            break;
        }
        memset(marked, 0, (size_t)s->volume->node_count);
        for (int32_t i = 0; i < group->count; i++) marked[group->nodes[i]] = 1;
        for (int32_t f = 0; f < s->count; f++) {
            int in = 0;
            for (int c = 0; c < s->of->face_nodes; c++) in += marked[s->face[f][c]];
            kept[f] |= in == s->of->face_nodes;
        }
    }
    int32_t count = 0;
    for (int32_t f = 0; f < s->count && !status; f++)
        if (kept[f]) memmove(s->face[count++], s->face[f], sizeof *s->face);
    s->count = count;
    brunt_free(marked);
    brunt_free(kept);
    return status;
}

// ---------------------------------------------------------------------------------------------------- the mesh

// A group of the marked nodes; none when there are none. False: out of memory.
static bool add_group(brunt_mesh *mesh, const char *name, const uint8_t *marked) {
    int32_t count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) count += marked[n];
    if (!count) return true;
    brunt_group *group = &mesh->groups[mesh->group_count];
    group->nodes = brunt_alloc((size_t)count * sizeof *group->nodes);
    if (!group->nodes) return false;
    mesh->group_count++;
    memcpy(group->name, name, strlen(name) + 1);
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (marked[n]) group->nodes[group->count++] = n;
    return true;
}

// Marks the nodes of edges that only one element has. Edges are sorted by their lesser node.
static bool mark_border(const brunt_mesh *mesh, uint8_t *marked) {
    const int nodes = brunt_element_nodes(mesh->kind);
    const int64_t edges = (int64_t)mesh->element_count * nodes;
    int64_t *first = brunt_alloc(((size_t)mesh->node_count + 2) * sizeof *first);
    int32_t *greater = brunt_alloc((size_t)edges * sizeof *greater);
    bool done = first && greater;
    for (int pass = 0; pass < 2 && done; pass++) {
        for (int64_t e = 0; e < edges; e++) {
            int32_t p = mesh->elements[e], q = mesh->elements[e / nodes * nodes + (e + 1) % nodes];
            if (pass)
                greater[first[(p < q ? p : q) + 1]++] = p < q ? q : p;
            else
                first[(p < q ? p : q) + 2]++;
        }
        for (int32_t n = 0; n < mesh->node_count && !pass; n++) first[n + 2] += first[n + 1];
    }
    for (int32_t n = 0; n < mesh->node_count && done; n++)
        for (int64_t k = first[n]; k < first[n + 1]; k++) {
            int times = 0;
            for (int64_t j = first[n]; j < first[n + 1]; j++) times += greater[j] == greater[k];
            if (times == 1) marked[n] = marked[greater[k]] = 1;
        }
    brunt_free(first);
    brunt_free(greater);
    return done;
}

// Those of the volume, with the nodes that are left, and the border.
static bool add_groups(const brunt_mesh *volume, const int32_t *number, brunt_mesh *mesh) {
    uint8_t *marked = brunt_alloc((size_t)mesh->node_count);
    mesh->groups = brunt_alloc(((size_t)volume->group_count + 1) * sizeof *mesh->groups);
    bool done = marked && mesh->groups;
    for (int32_t g = 0; g < volume->group_count && done; g++) {
        const brunt_group *group = &volume->groups[g];
        memset(marked, 0, (size_t)mesh->node_count);
        for (int32_t i = 0; i < group->count; i++)
            if (number[group->nodes[i]] >= 0) marked[number[group->nodes[i]]] = 1;
        done = add_group(mesh, group->name, marked);
    }
    if (done) {
        memset(marked, 0, (size_t)mesh->node_count);
        done = mark_border(mesh, marked) && add_group(mesh, "border", marked);
    }
    brunt_free(marked);
    return done;
}

// Nodes keep the order they have in the volume. False: out of memory.
static bool make_membranes(const surface *s, brunt_element_kind kind, brunt_mesh *mesh) {
    const brunt_mesh *volume = s->volume;
    const int corners = s->of->face_nodes;
    int32_t *number = brunt_alloc((size_t)volume->node_count * sizeof *number);
    mesh->kind = kind;
    mesh->elements = brunt_alloc((size_t)s->count * (size_t)corners * sizeof *mesh->elements);
    bool done = number && mesh->elements;
    for (int32_t f = 0; f < s->count && done; f++)
        for (int c = 0; c < corners; c++) number[s->face[f][c]] = 1;
    for (int32_t n = 0; n < volume->node_count && done; n++) number[n] = number[n] ? mesh->node_count++ : -1;
    mesh->nodes = brunt_alloc((size_t)mesh->node_count * sizeof *mesh->nodes);
    done = done && mesh->nodes;
    for (int32_t n = 0; n < volume->node_count && done; n++)
        if (number[n] >= 0) memcpy(mesh->nodes[number[n]], volume->nodes[n], sizeof *mesh->nodes);
    for (int32_t *out = mesh->elements; mesh->element_count < s->count && done; mesh->element_count++)
        for (int c = 0; c < corners; c++) *out++ = number[s->face[mesh->element_count][c]];
    done = done && add_groups(volume, number, mesh);
    brunt_free(number);
    return done;
}

int brunt_mesh_surface(const brunt_shape *shape, brunt_element_kind kind, double size,
                       const char (*faces)[BRUNT_NAME_LENGTH], int32_t face_count, brunt_mesh *mesh,
                       brunt_error *error) {
    *mesh = (brunt_mesh){0};
    if (!brunt_element_is_membrane(kind))
        return brunt_fail(error, BRUNT_BAD_INPUT, "elements of kind %s are not membranes", brunt_element_name(kind));
    brunt_mesh volume;
    const brunt_element_kind solid = brunt_element_below_membrane(kind);
    surface s = {.of = brunt_element_traits_of(solid), .volume = &volume};
    int status = brunt_mesh_shape(shape, 3, solid, size, &volume, error);
    if (status) return status;
    bool done = find_surface(&s);
    if (done && face_count) status = keep_faces(&s, faces, face_count, error);
    if (!status && (!done || !make_membranes(&s, kind, mesh)))
        status = brunt_fail(error, BRUNT_FAILED, "no memory for a surface with edges of %g m", size);
    if (status) brunt_mesh_free(mesh);
    brunt_free(s.face);
    brunt_mesh_free(&volume);
    return status;
}
