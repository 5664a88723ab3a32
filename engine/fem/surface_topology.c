#include "fem/surface_topology.h"

#include <string.h>

#include "base/array.h"
#include "base/memory.h"

void brunt_topology_free(brunt_surface_topology *topology) {
    void *owned[] = {topology->rank, topology->slot,   topology->open,   topology->across,
                     topology->key,  topology->before, topology->number, topology->number_before};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *topology = (brunt_surface_topology){0};
}

// ------------------------------------------------------------------------------------------ neighbours

typedef struct face_of {
    int32_t place, least, node[4];
    int face;
} face_of;

static face_of read_face(const brunt_surface_topology *topology, const brunt_fem_body *fem, int32_t place, int face) {
    const brunt_element_traits *type = fem->traits;
    const int32_t *corner = fem->element_node + (size_t)topology->slot[place] * (size_t)type->nodes;
    face_of out = {.place = place, .face = face, .least = INT32_MAX};
    for (int k = 0; k < type->face_nodes; k++) {
        out.node[k] = corner[type->face[face][k]];
        if (out.node[k] < out.least) out.least = out.node[k];
    }
    return out;
}

static bool same_nodes(const face_of *a, const face_of *b, int count) {
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int j = 0; j < count; j++) found = found || a->node[i] == b->node[j];
        if (!found) return false;
    }
    return true;
}

// Faces are put into a bin by their least node, where the few others that can be equal are.
static void pair_faces(brunt_surface_topology *topology, const brunt_fem_body *fem, int32_t *first, int32_t *list) {
    const int faces = fem->traits->face_count;
    const int32_t count = topology->elements * faces;
    for (int32_t k = 0; k < count; k++) first[read_face(topology, fem, k / faces, k % faces).least + 2]++;
    for (int32_t n = 0; n < fem->node_count; n++) first[n + 2] += first[n + 1];
    for (int32_t k = 0; k < count; k++) list[first[read_face(topology, fem, k / faces, k % faces).least + 1]++] = k;
    for (int32_t n = 0; n < fem->node_count; n++)
        for (int32_t i = first[n]; i < first[n + 1]; i++) {
            const face_of a = read_face(topology, fem, list[i] / faces, list[i] % faces);
            for (int32_t j = i + 1; j < first[n + 1] && topology->across[list[i]] < 0; j++) {
                const face_of b = read_face(topology, fem, list[j] / faces, list[j] % faces);
                if (!same_nodes(&a, &b, fem->traits->face_nodes)) continue;
                topology->across[list[i]] = b.place, topology->across[list[j]] = a.place;
            }
        }
}

static int find_neighbours(brunt_surface_topology *topology, const brunt_fem_body *fem, brunt_error *error) {
    const size_t faces = (size_t)topology->elements * (size_t)fem->traits->face_count;
    int32_t *first, *list = NULL;
    const bool made = !BRUNT_NEW(first, fem->node_count + 2, "nodes to find neighbours by", error) &&
                      !BRUNT_NEW(list, faces + 1, "faces to find neighbours by", error);
    for (size_t k = 0; k < faces; k++) topology->across[k] = -1;
    if (made && !fem->traits->membrane) pair_faces(topology, fem, first, list); // a membrane's element is its one face
    brunt_free(first);
    brunt_free(list);
    return made ? BRUNT_OK : BRUNT_FAILED;
}

// ------------------------------------------------------------------------------------------ the surface

static uint8_t open_faces(const brunt_surface_topology *topology, int32_t place, int faces) {
    const int32_t *across = topology->across + (size_t)place * (size_t)faces;
    int open = 0;
    for (int f = 0; f < faces; f++)
        if (across[f] < 0 || topology->slot[across[f]] < 0) open |= 1 << f;
    return (uint8_t)open;
}

// An element is eroded: what it covered lies open.
static void open_neighbours(brunt_surface_topology *topology, int32_t place, int faces) {
    topology->open[place] = 0;
    for (int f = 0; f < faces; f++) {
        const int32_t beside = topology->across[(size_t)place * (size_t)faces + (size_t)f];
        if (beside >= 0 && topology->slot[beside] >= 0) topology->open[beside] = open_faces(topology, beside, faces);
    }
}

// Where the elements are now, and which of their faces are open. Whether others are there than the last time.
static bool find_elements(brunt_surface_topology *topology, const brunt_fem_body *fem) {
    enum { WAS = -2 };
    const int faces = fem->traits->face_count;
    bool left = false, back = false;
    for (int32_t r = 0; r < topology->elements; r++) topology->slot[r] = topology->slot[r] >= 0 ? WAS : -1;
    for (int32_t s = 0; s < fem->slots; s++) {
        if (fem->element_id[s] < 0) continue;
        int32_t *slot = &topology->slot[topology->rank[fem->element_id[s]]];
        back = back || *slot == -1;
        *slot = s;
    }
    topology->live = fem->element_count;
    for (int32_t r = 0; r < topology->elements; r++) left = left || topology->slot[r] == WAS;
    if (back) {
        for (int32_t r = 0; r < topology->elements; r++)
            if (topology->slot[r] == WAS) topology->slot[r] = -1;
        for (int32_t r = 0; r < topology->elements; r++)
            topology->open[r] = topology->slot[r] < 0 ? 0 : open_faces(topology, r, faces);
    } else if (left) {
        for (int32_t r = 0; r < topology->elements; r++)
            if (topology->slot[r] == WAS) {
                topology->slot[r] = -1;
                open_neighbours(topology, r, faces);
            }
    }
    return left || back;
}

static int list_faces(brunt_surface_topology *topology, const brunt_fem_body *fem, brunt_error *error) {
    const int faces = fem->traits->face_count;
    int32_t count = 0;
    for (int32_t r = 0; r < topology->elements; r++) {
        if (!topology->open[r]) continue;
        if (BRUNT_CAPACITY(topology->key, (size_t)count + (size_t)faces, (size_t)count, "faces of a mesh that erodes",
                           error))
            return BRUNT_FAILED;
        for (int f = 0; f < faces; f++)
            if (topology->open[r] >> f & 1) topology->key[count++] = r * faces + f;
    }
    topology->key_count = count;
    return BRUNT_OK;
}

static bool flies_on(const brunt_fem_body *fem, int32_t n) {
    return fem->bonds && !fem->bonds[n] && !brunt_fem_removed(fem, n);
}

static void number_nodes(brunt_surface_topology *topology, const brunt_fem_body *fem) {
    for (int32_t n = 0; n < fem->node_count; n++) topology->number[n] = flies_on(fem, n) ? 0 : -1;
    for (int32_t k = 0; k < topology->key_count; k++) {
        int32_t node[4];
        brunt_topology_face(topology, fem, k, node);
        for (int c = 0; c < 4 && node[c] >= 0; c++) topology->number[node[c]] = 0;
    }
    topology->number_count = 0;
    for (int32_t n = 0; n < fem->node_count; n++)
        if (topology->number[n] == 0) topology->number[n] = topology->number_count++;
}

void brunt_topology_face(const brunt_surface_topology *topology, const brunt_fem_body *fem, int32_t k,
                         int32_t node[4]) {
    const brunt_element_traits *type = fem->traits;
    const int32_t place = topology->key[k] / type->face_count;
    const int32_t *corner = fem->element_node + (size_t)topology->slot[place] * (size_t)type->nodes;
    const uint8_t *face = type->face[topology->key[k] % type->face_count];
    for (int c = 0; c < 4; c++) node[c] = c < type->face_nodes ? corner[face[c]] : -1;
}

int brunt_topology_renew(brunt_surface_topology *topology, const brunt_fem_body *fem, bool restored,
                         brunt_error *error) {
    topology->changed = false;
    if (!restored && fem->element_count == topology->live) return BRUNT_OK;
    if (!find_elements(topology, fem) && !restored) return BRUNT_OK;
    int32_t *const key = topology->key, *const number = topology->number;
    const size_t capacity = topology->key_capacity;
    topology->key = topology->before, topology->key_capacity = topology->before_capacity;
    topology->before = key, topology->before_capacity = capacity, topology->before_count = topology->key_count;
    topology->number = topology->number_before, topology->number_before = number;
    if (list_faces(topology, fem, error)) return BRUNT_FAILED;
    number_nodes(topology, fem);
    topology->changed = true;
    return BRUNT_OK;
}

int brunt_topology_make(brunt_surface_topology *topology, const brunt_fem_body *fem, brunt_error *error) {
    *topology = (brunt_surface_topology){.elements = fem->element_count, .live = fem->element_count};
    const size_t n = (size_t)fem->element_count + 1, nodes = (size_t)fem->node_count + 1;
    static const char places[] = "elements of a mesh that erodes", of_nodes[] = "nodes of a mesh that erodes";
    if (BRUNT_NEW(topology->rank, n, places, error) || BRUNT_NEW(topology->slot, n, places, error) ||
        BRUNT_NEW(topology->open, n, places, error) || BRUNT_NEW(topology->number, nodes, of_nodes, error) ||
        BRUNT_NEW(topology->across, n * (size_t)fem->traits->face_count, "neighbours in a mesh that erodes", error) ||
        BRUNT_NEW(topology->number_before, nodes, of_nodes, error))
        return BRUNT_FAILED;
    int32_t place = 0;
    for (int32_t s = 0; s < fem->slots; s++)
        if (fem->element_id[s] >= 0) topology->rank[fem->element_id[s]] = place, topology->slot[place++] = s;
    if (find_neighbours(topology, fem, error)) return BRUNT_FAILED;
    for (int32_t r = 0; r < topology->elements; r++)
        topology->open[r] = open_faces(topology, r, fem->traits->face_count);
    if (list_faces(topology, fem, error)) return BRUNT_FAILED;
    number_nodes(topology, fem);
    return BRUNT_OK;
}
