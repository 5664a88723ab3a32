// Which edges of the surfaces are features.
#include "base/parallel.h"
#include "contact/search/node_to_facet_parts.h"

enum { GRAIN = 512, KNOWN = 3 }; // KNOWN: added to what is beyond an edge where that is known, which is never 0 then

// Cosine of 0.4 rad, the least turn of a feature: what is left unmet between edges that turn less is under a tenth of
// an edge (0.5 tan 0.2), and surfaces of 16 facets a circle and more have none.
static const double LEAST_TURN = 0.92106099400288508;
// Of the way from an edge to the middle of a facet: how deep is still from this side. Nothing is thinner than the way.
static const double DEPTH = 0.5;

void brunt_feature_edges_free(near_edges *edges) {
    brunt_free(edges->near), brunt_free(edges->first), brunt_free(edges->span), brunt_free(edges->turns);
    brunt_free(edges->feature), brunt_free(edges->feature_first), brunt_free(edges->beyond);
}

int brunt_feature_edges_begin(brunt_node_to_facet *f, const brunt_contact_surface *s, brunt_error *error) {
    near_edges *edges = &f->edges;
    if (RESERVE(edges, first, 2 * (size_t)s->fem_count + 1, "bodies with edges near others", error))
        return BRUNT_FAILED;
    if (s->dim != 3 || edges->beyond_known) return BRUNT_OK;
    if (RESERVE(edges, beyond, s->face_count + 1, "facets beside facets", error)) return BRUNT_FAILED;
    memset(edges->beyond, 0, (size_t)s->face_count * sizeof *edges->beyond);
    edges->beyond_known = true;
    return BRUNT_OK;
}

// The face beyond the edge of a face from node p to q; -1: none, -2: several, where elements touch along an edge.
static int32_t face_beyond(const brunt_contact_surface *s, int32_t p, int32_t q) {
    int32_t found = -1;
    for (int32_t i = s->face_first[p]; i < s->face_first[p + 1]; i++) {
        const int32_t *node = s->face[s->face_of[i]];
        const int n = brunt_face_corners(node);
        for (int c = 0; c < n; c++)
            if (node[c] == q && node[c + 1 < n ? c + 1 : 0] == p) found = found == -1 ? s->face_of[i] : -2;
    }
    return found;
}

// Of a solid each edge once, from the face in which it ascends; of a membrane its rims, which one face has. What is
// beyond them is found once, as the order of the nodes tells.
int brunt_feature_edges_of(const near_edges *edges, const brunt_contact_surface *s, int k, int32_t face,
                           near_edge *out) {
    const int32_t *node = s->face[face];
    const int n = brunt_face_corners(node);
    const bool membrane = s->fem[k]->traits->membrane;
    int count = 0;
    for (int c = 0; c < n; c++) {
        const int32_t p = node[c], q = node[c + 1 < n ? c + 1 : 0];
        if (!membrane && p > q) continue;
        int32_t *kept = &edges->beyond[face][c];
        if (!*kept) *kept = face_beyond(s, p, q) + KNOWN;
        const int32_t other = *kept - KNOWN;
        if (membrane ? other != -1 : other < 0) continue;
        if (out) out[count] = (near_edge){{p, q}, {face, other}};
        count++;
    }
    return count;
}

// Whether an edge is convex and turns enough: of quadrilaterals that are not flat, whichever of its faces and nodes is
// the first.
static inline bool is_feature(const brunt_contact_surface *s, const near_edge *edge) {
    if (edge->face[1] < 0) return true;
    const double *n[2] = {s->face_normal[edge->face[0]], s->face_normal[edge->face[1]]};
    if (dot(n[0], n[1]) > LEAST_TURN) return false;
    const double *a = s->x[edge->node[0]], *b = s->x[edge->node[1]],
                 *centre[2] = {s->face_centre[edge->face[0]], s->face_centre[edge->face[1]]};
    double before = 0; // of each face the other's centre
    for (int k = 0; k < 3; k++) {
        const double middle = 0.5 * (a[k] + b[k]);
        before += n[0][k] * (centre[1][k] - middle) + n[1][k] * (centre[0][k] - middle);
    }
    return before < 0;
}

static feature_edge feature_of(const brunt_contact_surface *s, const near_edge *edge) {
    feature_edge out = {.node = {edge->node[0], edge->node[1]}, .rim = edge->face[1] < 0, .depth = INFINITY};
    const double *a = s->x[edge->node[0]], *b = s->x[edge->node[1]];
    double e[3];
    for (int k = 0; k < 3; k++) {
        e[k] = b[k] - a[k];
        out.low[k] = fmin(a[k], b[k]), out.high[k] = fmax(a[k], b[k]);
    }
    const double square = dot(e, e);
    for (int i = 0; i < 2; i++) {
        const int32_t face = edge->face[out.rim ? 0 : i];
        double *into = out.into[i];
        for (int k = 0; k < 3; k++) into[k] = s->face_centre[face][k] - 0.5 * (a[k] + b[k]);
        const double along = square > 0 ? dot(into, e) / square : 0;
        for (int k = 0; k < 3; k++) into[k] -= along * e[k];
        const double length = sqrt(dot(into, into));
        out.depth = fmin(out.depth, DEPTH * length);
        for (int k = 0; k < 3; k++) {
            into[k] = length > 0 ? into[k] / length : 0;
            out.out[k] += out.rim ? -into[k] : s->face_normal[face][k];
        }
    }
    return out;
}

typedef struct turn_job {
    const brunt_contact_surface *surface;
    const near_edges *edges;
    int32_t first;
} turn_job;

static void find_turns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const turn_job *j = context;
    for (int64_t i = begin; i < end; i++) j->edges->turns[i] = is_feature(j->surface, &j->edges->near[j->first + i]);
}

int brunt_feature_edges_list(const brunt_contact_context *m, brunt_node_to_facet *f, int k, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    near_edges *edges = &f->edges;
    if (edges->feature_first[2 * k] >= 0) return BRUNT_OK;
    edges->feature_first[2 * k] = edges->feature_count;
    const int32_t first = edges->first[2 * k], count = edges->first[2 * k + 1] - first;
    if (RESERVE(edges, turns, count + 1, "edges near other bodies", error)) return BRUNT_FAILED;
    brunt_parallel(m->threads, count, GRAIN, find_turns, &(turn_job){s, edges, first}, m->timer);
    for (int32_t i = 0; i < count; i++) {
        if (!edges->turns[i]) continue;
        const size_t used = (size_t)edges->feature_count;
        if (BRUNT_CAPACITY(edges->feature, used + 1, used, "edges that meet", error)) return BRUNT_FAILED;
        edges->feature[edges->feature_count++] = feature_of(s, &edges->near[first + i]);
    }
    edges->feature_first[2 * k + 1] = edges->feature_count;
    return BRUNT_OK;
}
