// Membranes: the two sides of each, what others are to them, and the patches about the nodes of those that touch
// themselves.
#include "contact/surface/surface_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"

// The other side of a membrane: `nodes` nodes and `faces` faces once more, behind them, facing the other way.
void brunt_membrane_add_back(int32_t *node, int32_t nodes, int32_t (*face)[4], int32_t faces) {
    for (int32_t n = 0; n < nodes; n++) node[n + nodes] = node[n];
    for (int32_t f = 0; f < faces; f++) {
        const int n = brunt_face_corners(face[f]);
        int32_t *back = face[f + faces];
        back[3] = -1;
        for (int c = 0; c < n; c++) back[c] = face[f][n - 1 - c] + nodes;
    }
}

// Least height of the elements behind a body's surface [m], as volume over area of the face: what it may have been
// entered by, and still be told from what is behind it.
static int least_height(const brunt_fem_body *fem, double *least, brunt_error *error) {
    brunt_faces found;
    if (brunt_fem_faces(fem, &found, error)) return BRUNT_FAILED;
    *least = INFINITY;
    for (int32_t f = 0; f < found.count; f++) {
        double x[BRUNT_ELEMENT_NODES][3], e[3], g[3], square = 0;
        const int32_t *node = found.node[f];
        for (int c = 0; c < fem->traits->nodes; c++) {
            const real *at = brunt_fem_node(
                fem, fem->element_node[(size_t)found.element[f] * (size_t)fem->traits->nodes + (size_t)c]);
            for (int a = 0; a < 3; a++) x[c][a] = (double)at[a];
        }
        const bool quad = brunt_face_corners(node) == 4;
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
    return BRUNT_OK;
}

// What membranes need besides, when there are any.
int brunt_membrane_sides_make(brunt_contact_surface *s, brunt_error *error) {
    int32_t last = 0;
    bool any = false;
    for (int k = 0; k < s->fem_count; k++) {
        any = any || s->fem[k]->traits->membrane;
        last = s->fem[k]->index > last ? s->fem[k]->index : last;
    }
    if (!any) return BRUNT_OK;
    if (BRUNT_NEW(s->membrane.front, s->node_array_capacity, "nodes before those of a membrane's back", error) ||
        BRUNT_NEW(s->membrane.side, last + 1, "bodies as membranes meet them", error))
        return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) {
        const brunt_fem_body *fem = s->fem[k];
        brunt_side *side = &s->membrane.side[fem->index];
        if (!fem->traits->membrane) {
            if (least_height(fem, &side->shallow, error)) return BRUNT_FAILED;
            side->shallow *= 0.5;
            continue;
        }
        side->half = 0.5 * (double)fem->contact_thickness;
        s->membrane.thickest = fmax(s->membrane.thickest, (double)fem->contact_thickness);
    }
    return BRUNT_OK;
}

static int ascending(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) - (*(const int32_t *)a < *(const int32_t *)b);
}

// Faces of the front within two rings of node n, each once, into `list`, which has room for them. Their count.
static int32_t list_patch(const brunt_contact_surface *s, int32_t n, int32_t *list) {
    int32_t count = 0, kept = 0;
    for (int32_t p = s->face_first[n]; p < s->face_first[n + 1]; p++)
        for (int c = 0; c < brunt_face_corners(s->face[s->face_of[p]]); c++) {
            const int32_t other = s->face[s->face_of[p]][c];
            for (int32_t q = s->face_first[other]; q < s->face_first[other + 1]; q++) list[count++] = s->face_of[q];
        }
    qsort(list, (size_t)count, sizeof *list, ascending);
    for (int32_t i = 0; i < count; i++)
        if (!i || list[i] != list[i - 1]) list[kept++] = list[i];
    return kept;
}

int brunt_membrane_patches_make(brunt_contact_surface *s, brunt_error *error) {
    size_t most = 0, used = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        const size_t at = (size_t)(s->face_first[n + 1] - s->face_first[n]);
        most = at > most ? at : most;
    }
    if (BRUNT_CAPACITY(s->renewal.spare, (4 * most * most + 1) * sizeof(int32_t), 0,
                       "bytes to put surface nodes in order", error) ||
        BRUNT_CAPACITY(s->membrane.patch_first, (size_t)s->node_count + 2, 0, "first elements about nodes of membranes",
                       error))
        return BRUNT_FAILED;
    int32_t *list = (void *)s->renewal.spare;
    s->membrane.patch_first[0] = 0;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            const int32_t count = s->membrane.self[k] && n < s->node_end[k] ? list_patch(s, n, list) : 0;
            if (BRUNT_CAPACITY(s->membrane.patch_face, used + (size_t)count + 1, used,
                               "elements about nodes of membranes", error))
                return BRUNT_FAILED;
            memcpy(s->membrane.patch_face + used, list, (size_t)count * sizeof *list);
            used += (size_t)count;
            s->membrane.patch_first[n + 1] = (int32_t)used;
        }
    return BRUNT_OK;
}

int brunt_surface_patches(brunt_contact_surface *s, const bool *self, brunt_error *error) {
    if (BRUNT_NEW(s->membrane.self, s->fem_count + 1, "marks of membranes that meet themselves", error))
        return BRUNT_FAILED;
    memcpy(s->membrane.self, self, (size_t)s->fem_count);
    return brunt_membrane_patches_make(s, error);
}
