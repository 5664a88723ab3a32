// The surfaces anew after elements have left, and the order in which what is remembered of nodes is saved.
#include "contact/surface/surface_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"

// Numbers of nodes and faces of a body, of one side: first and count.
typedef struct body_range {
    int32_t node, nodes, face, faces;
} body_range;

static void keep_body(brunt_contact_surface *s, int32_t sides, const body_range *was, const body_range *is) {
    for (int32_t n = 0; n < sides * was->nodes; n++) {
        s->renewal.next_node[is->node + n] = s->node[was->node + n];
        s->renewal.change.node_was[is->node + n] = was->node + n;
    }
    for (int32_t f = 0; f < sides * was->faces; f++) {
        for (int c = 0; c < 4; c++) {
            const int32_t node = s->face[was->face + f][c];
            s->renewal.next_face[is->face + f][c] = node < 0 ? -1 : node - was->node + is->node;
        }
        s->renewal.change.face_now[was->face + f] = is->face + f;
    }
}

static void renew_body(brunt_contact_surface *s, int k, int32_t sides, const body_range *was, const body_range *is) {
    const brunt_surface_topology *topology = &s->renewal.topology[k];
    const brunt_fem_body *fem = s->fem[k];
    for (int32_t n = 0; n < fem->node_count; n++) {
        if (topology->number[n] < 0) continue;
        const int32_t at = topology->number[n], before = topology->number_before[n];
        s->renewal.next_node[is->node + at] = n;
        for (int32_t side = 0; side < sides; side++)
            s->renewal.change.node_was[is->node + side * is->nodes + at] =
                before < 0 ? -1 : was->node + side * was->nodes + before;
    }
    for (int32_t f = 0; f < is->faces; f++) {
        int32_t node[4];
        brunt_topology_face(topology, fem, f, node);
        for (int c = 0; c < 4; c++)
            s->renewal.next_face[is->face + f][c] = node[c] < 0 ? -1 : is->node + topology->number[node[c]];
    }
    if (sides == 2)
        brunt_membrane_add_back(s->renewal.next_node + is->node, is->nodes, s->renewal.next_face + is->face, is->faces);
    for (int32_t f = 0, now = 0; f < was->faces; f++) { // both lists ascend
        while (now < is->faces && topology->key[now] < topology->before[f]) now++;
        const bool stays = now < is->faces && topology->key[now] == topology->before[f];
        for (int32_t side = 0; side < sides; side++)
            s->renewal.change.face_now[was->face + side * was->faces + f] =
                stays ? is->face + side * is->faces + now : -1;
    }
}

// An array by nodes in their new order; those that are new get zeros.
static int reorder(brunt_contact_surface *s, void *array, size_t bytes, brunt_error *error) {
    if (!array) return BRUNT_OK;
    if (BRUNT_CAPACITY(s->renewal.spare, (size_t)s->node_count * bytes + 1, 0, "bytes to put surface nodes in order",
                       error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < s->node_count; n++) {
        char *to = s->renewal.spare + (size_t)n * bytes;
        if (s->renewal.change.node_was[n] < 0)
            memset(to, 0, bytes);
        else
            memcpy(to, (char *)array + (size_t)s->renewal.change.node_was[n] * bytes, bytes);
    }
    memcpy(array, s->renewal.spare, (size_t)s->node_count * bytes);
    return BRUNT_OK;
}

// What is known of nodes from step to step, or told to others until the next one. A new node has not moved by more than
// the frame since the step began.
static int keep_nodes(brunt_contact_surface *s, brunt_error *error) {
    if (reorder(s, s->x, sizeof *s->x, error) || reorder(s, s->affine, sizeof *s->affine, error) ||
        reorder(s, s->output.gap, sizeof *s->output.gap, error) ||
        reorder(s, s->output.impulse, sizeof *s->output.impulse, error) ||
        reorder(s, s->output.state, sizeof *s->output.state, error) ||
        reorder(s, s->motion.near, sizeof *s->motion.near, error) || reorder(s, s->area, sizeof *s->area, error) ||
        reorder(s, s->mass, sizeof *s->mass, error))
        return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            if (s->renewal.change.node_was[n] >= 0) continue;
            s->output.gap[n] = INFINITY;
            for (int a = 0; a < 3; a++)
                s->x[n][a] = (double)brunt_fem_node(s->fem[k], s->node[n])[a] - s->motion.frame_step[a];
        }
    return BRUNT_OK;
}

static body_range range_of_body(const brunt_contact_surface *s, int k) {
    return (body_range){s->node_range[k], s->node_end[k] - s->node_range[k], s->face_range[k],
                        s->face_end[k] - s->face_range[k]};
}

static int list_anew(brunt_contact_surface *s, brunt_error *error) {
    int64_t nodes = 0, faces = 0;
    for (int k = 0; k < s->fem_count; k++) {
        const body_range was = range_of_body(s, k);
        const int sides = s->fem[k]->traits->membrane ? 2 : 1;
        nodes += sides * (int64_t)(s->renewal.topology[k].changed ? s->renewal.topology[k].number_count : was.nodes);
        faces += sides * (int64_t)(s->renewal.topology[k].changed ? s->renewal.topology[k].key_count : was.faces);
    }
    brunt_surface_change *c = &s->renewal.change;
    if (BRUNT_CAPACITY(s->renewal.next_node, (size_t)nodes + 1, 0, "nodes of a surface made anew", error) ||
        BRUNT_CAPACITY(s->renewal.next_face, (size_t)faces + 1, 0, "faces of a surface made anew", error) ||
        BRUNT_CAPACITY(c->node_was, (size_t)nodes + 1, 0, "nodes of a surface made anew", error) ||
        BRUNT_CAPACITY(c->face_now, (size_t)s->face_count + 1, 0, "faces of a surface made anew", error) ||
        brunt_surface_reserve(s, (int32_t)nodes, (int32_t)faces, error))
        return BRUNT_FAILED;
    c->node_count = s->node_count, c->face_count = s->face_count;
    body_range is = {0}, was = s->fem_count ? range_of_body(s, 0) : is;
    for (int k = 0; k < s->fem_count; k++) {
        const int32_t sides = s->fem[k]->traits->membrane ? 2 : 1;
        is.nodes = s->renewal.topology[k].changed ? s->renewal.topology[k].number_count : was.nodes;
        is.faces = s->renewal.topology[k].changed ? s->renewal.topology[k].key_count : was.faces;
        if (s->renewal.topology[k].changed)
            renew_body(s, k, sides, &was, &is);
        else
            keep_body(s, sides, &was, &is);
        if (k + 1 < s->fem_count) was = range_of_body(s, k + 1);
        s->node_range[k] = is.node, s->node_end[k] = is.node + is.nodes;
        s->face_range[k] = is.face, s->face_end[k] = is.face + is.faces;
        is.node += sides * is.nodes, is.face += sides * is.faces;
    }
    s->node_range[s->fem_count] = is.node, s->face_range[s->fem_count] = is.face;
    s->node_count = is.node, s->face_count = is.face;
    return BRUNT_OK;
}

static void swap_lists(brunt_contact_surface *s) {
    int32_t *const node = s->node, (*const face)[4] = s->face;
    const size_t nodes = s->node_capacity, faces = s->face_capacity;
    s->node = s->renewal.next_node, s->node_capacity = s->renewal.next_node_capacity;
    s->face = s->renewal.next_face, s->face_capacity = s->renewal.next_face_capacity;
    s->renewal.next_node = node, s->renewal.next_node_capacity = nodes;
    s->renewal.next_face = face, s->renewal.next_face_capacity = faces;
}

int brunt_surface_renew(brunt_contact_surface *s, bool restored, brunt_error *error) {
    s->renewal.change.any = s->motion.rests = false;
    if (!s->renewal.topology) return BRUNT_OK;
    for (int k = 0; k < s->fem_count; k++) {
        brunt_surface_topology *topology = &s->renewal.topology[k];
        if (topology->elements && brunt_topology_renew(topology, s->fem[k], restored, error)) return BRUNT_FAILED;
        s->renewal.change.any = s->renewal.change.any || topology->changed;
    }
    if (!s->renewal.change.any) return BRUNT_OK;
    if (list_anew(s, error)) return BRUNT_FAILED;
    swap_lists(s);
    return keep_nodes(s, error) || brunt_surface_relate(s, error) ||
                   (s->membrane.self && brunt_membrane_patches_make(s, error))
               ? BRUNT_FAILED
               : BRUNT_OK;
}

int64_t brunt_surface_slots(const brunt_contact_surface *s) {
    if (!s->renewal.topology) return s->node_count;
    int64_t sum = 0;
    for (int k = 0; k < s->fem_count; k++)
        sum += (s->fem[k]->traits->membrane ? 2 : 1) * (int64_t)s->fem[k]->node_count;
    return sum;
}

int64_t brunt_surface_slot(const brunt_contact_surface *s, int k, int32_t n) {
    if (!s->renewal.topology) return n;
    int64_t first = n < s->node_end[k] ? 0 : s->fem[k]->node_count;
    for (int i = 0; i < k; i++) first += (s->fem[i]->traits->membrane ? 2 : 1) * (int64_t)s->fem[i]->node_count;
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
