#include "fem/surface_topology.h"

#include <string.h>

#include "base/array.h"
#include "base/memory.h"

void brunt_topology_free(brunt_surface_topology *shell) {
    void *owned[] = {shell->rank, shell->slot,   shell->open,   shell->across,
                     shell->key,  shell->before, shell->number, shell->number_before};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *shell = (brunt_surface_topology){0};
}

// ------------------------------------------------------------------------------------------ neighbours

typedef struct face_of {
    int32_t place, least, node[4];
    int face;
} face_of;

static face_of read_face(const brunt_surface_topology *shell, const brunt_fem_body *fem, int32_t place, int face) {
    const brunt_element_traits *type = fem->traits;
    const int32_t *corner = fem->element_node + (size_t)shell->slot[place] * (size_t)type->nodes;
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
static void pair_faces(brunt_surface_topology *shell, const brunt_fem_body *fem, int32_t *first, int32_t *list) {
    const int faces = fem->traits->face_count;
    const int32_t count = shell->elements * faces;
    for (int32_t k = 0; k < count; k++) first[read_face(shell, fem, k / faces, k % faces).least + 2]++;
    for (int32_t n = 0; n < fem->node_count; n++) first[n + 2] += first[n + 1];
    for (int32_t k = 0; k < count; k++) list[first[read_face(shell, fem, k / faces, k % faces).least + 1]++] = k;
    for (int32_t n = 0; n < fem->node_count; n++)
        for (int32_t i = first[n]; i < first[n + 1]; i++) {
            const face_of a = read_face(shell, fem, list[i] / faces, list[i] % faces);
            for (int32_t j = i + 1; j < first[n + 1] && shell->across[list[i]] < 0; j++) {
                const face_of b = read_face(shell, fem, list[j] / faces, list[j] % faces);
                if (!same_nodes(&a, &b, fem->traits->face_nodes)) continue;
                shell->across[list[i]] = b.place, shell->across[list[j]] = a.place;
            }
        }
}

static int find_neighbours(brunt_surface_topology *shell, const brunt_fem_body *fem) {
    const size_t faces = (size_t)shell->elements * (size_t)fem->traits->face_count;
    int32_t *first = brunt_alloc(((size_t)fem->node_count + 2) * sizeof *first);
    int32_t *list = brunt_alloc((faces + 1) * sizeof *list);
    const bool made = first && list;
    for (size_t k = 0; k < faces; k++) shell->across[k] = -1;
    if (made && !fem->traits->membrane) pair_faces(shell, fem, first, list); // a sheet's element is its one face
    brunt_free(first);
    brunt_free(list);
    return made ? 0 : -1;
}

// ------------------------------------------------------------------------------------------ the surface

static uint8_t open_faces(const brunt_surface_topology *shell, int32_t place, int faces) {
    const int32_t *across = shell->across + (size_t)place * (size_t)faces;
    int open = 0;
    for (int f = 0; f < faces; f++)
        if (across[f] < 0 || shell->slot[across[f]] < 0) open |= 1 << f;
    return (uint8_t)open;
}

// An element is gone: what it covered lies open.
static void open_neighbours(brunt_surface_topology *shell, int32_t place, int faces) {
    shell->open[place] = 0;
    for (int f = 0; f < faces; f++) {
        const int32_t beside = shell->across[(size_t)place * (size_t)faces + (size_t)f];
        if (beside >= 0 && shell->slot[beside] >= 0) shell->open[beside] = open_faces(shell, beside, faces);
    }
}

// Where the elements are now, and which of their faces are open. Whether others are there than the last time.
static bool find_elements(brunt_surface_topology *shell, const brunt_fem_body *fem) {
    enum { WAS = -2 };
    const int faces = fem->traits->face_count;
    bool left = false, back = false;
    for (int32_t r = 0; r < shell->elements; r++) shell->slot[r] = shell->slot[r] >= 0 ? WAS : -1;
    for (int32_t s = 0; s < fem->slots; s++) {
        if (fem->element_id[s] < 0) continue;
        int32_t *slot = &shell->slot[shell->rank[fem->element_id[s]]];
        back = back || *slot == -1;
        *slot = s;
    }
    shell->live = fem->element_count;
    for (int32_t r = 0; r < shell->elements; r++) left = left || shell->slot[r] == WAS;
    if (back) {
        for (int32_t r = 0; r < shell->elements; r++)
            if (shell->slot[r] == WAS) shell->slot[r] = -1;
        for (int32_t r = 0; r < shell->elements; r++)
            shell->open[r] = shell->slot[r] < 0 ? 0 : open_faces(shell, r, faces);
    } else if (left) {
        for (int32_t r = 0; r < shell->elements; r++)
            if (shell->slot[r] == WAS) {
                shell->slot[r] = -1;
                open_neighbours(shell, r, faces);
            }
    }
    return left || back;
}

static int list_faces(brunt_surface_topology *shell, const brunt_fem_body *fem) {
    const int faces = fem->traits->face_count;
    int32_t count = 0;
    for (int32_t r = 0; r < shell->elements; r++) {
        if (!shell->open[r]) continue;
        if (BRUNT_RESERVE(shell->key, (size_t)count + (size_t)faces, (size_t)count)) return -1;
        for (int f = 0; f < faces; f++)
            if (shell->open[r] >> f & 1) shell->key[count++] = r * faces + f;
    }
    shell->key_count = count;
    return 0;
}

static bool flies_on(const brunt_fem_body *fem, int32_t n) {
    return fem->bonds && !fem->bonds[n] && !brunt_fem_removed(fem, n);
}

static void number_nodes(brunt_surface_topology *shell, const brunt_fem_body *fem) {
    for (int32_t n = 0; n < fem->node_count; n++) shell->number[n] = flies_on(fem, n) ? 0 : -1;
    for (int32_t k = 0; k < shell->key_count; k++) {
        int32_t node[4];
        brunt_topology_face(shell, fem, k, node);
        for (int c = 0; c < 4 && node[c] >= 0; c++) shell->number[node[c]] = 0;
    }
    shell->number_count = 0;
    for (int32_t n = 0; n < fem->node_count; n++)
        if (shell->number[n] == 0) shell->number[n] = shell->number_count++;
}

void brunt_topology_face(const brunt_surface_topology *shell, const brunt_fem_body *fem, int32_t k, int32_t node[4]) {
    const brunt_element_traits *type = fem->traits;
    const int32_t place = shell->key[k] / type->face_count;
    const int32_t *corner = fem->element_node + (size_t)shell->slot[place] * (size_t)type->nodes;
    const uint8_t *face = type->face[shell->key[k] % type->face_count];
    for (int c = 0; c < 4; c++) node[c] = c < type->face_nodes ? corner[face[c]] : -1;
}

int brunt_topology_renew(brunt_surface_topology *shell, const brunt_fem_body *fem, bool restored) {
    if (!restored && fem->element_count == shell->live) return 0;
    if (!find_elements(shell, fem) && !restored) return 0;
    int32_t *const key = shell->key, *const number = shell->number;
    const size_t capacity = shell->key_capacity;
    shell->key = shell->before, shell->key_capacity = shell->before_capacity;
    shell->before = key, shell->before_capacity = capacity, shell->before_count = shell->key_count;
    shell->number = shell->number_before, shell->number_before = number;
    if (list_faces(shell, fem)) return -1;
    number_nodes(shell, fem);
    return 1;
}

int brunt_topology_make(brunt_surface_topology *shell, const brunt_fem_body *fem) {
    *shell = (brunt_surface_topology){.elements = fem->element_count, .live = fem->element_count};
    const size_t n = (size_t)fem->element_count + 1, nodes = (size_t)fem->node_count + 1;
    shell->rank = brunt_alloc(n * sizeof *shell->rank), shell->slot = brunt_alloc(n * sizeof *shell->slot);
    shell->open = brunt_alloc(n);
    shell->across = brunt_alloc(n * (size_t)fem->traits->face_count * sizeof *shell->across);
    shell->number = brunt_alloc(nodes * sizeof *shell->number);
    shell->number_before = brunt_alloc(nodes * sizeof *shell->number_before);
    if (!shell->rank || !shell->slot || !shell->open || !shell->across || !shell->number || !shell->number_before)
        return -1;
    int32_t place = 0;
    for (int32_t s = 0; s < fem->slots; s++)
        if (fem->element_id[s] >= 0) shell->rank[fem->element_id[s]] = place, shell->slot[place++] = s;
    if (find_neighbours(shell, fem)) return -1;
    for (int32_t r = 0; r < shell->elements; r++) shell->open[r] = open_faces(shell, r, fem->traits->face_count);
    if (list_faces(shell, fem)) return -1;
    number_nodes(shell, fem);
    return 0;
}
