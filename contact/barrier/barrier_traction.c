// Tractions along the rims of meshes, in two dimensions, as the step has left them: forces on vertices over the part of
// the surface that each stands for, in the reference configuration, so that they add up to the forces on bodies.
#include "contact/barrier/barrier_parts.h"

#include <stdlib.h>

typedef struct rims {
    const brunt_barrier *b;
    const double (*rest)[3]; // [m]
    int32_t (*next)[2];      // vertices beside each, BRUNT_NONE
    double *along;           // [m] of each; NAN: not yet walked
} rims;

// From a vertex of a rim to the next one; BRUNT_NONE where it ends or closes.
static int32_t step_on(const rims *r, int32_t from, int32_t at, int32_t first) {
    const int32_t to = r->next[at][r->next[at][0] == from];
    return to == first ? BRUNT_NONE : to;
}

// Twice the area that a rim encloses on its way by this neighbour of its first vertex; and how far each vertex is along
// it, where that is asked for.
static double walk(const rims *r, int32_t first, int32_t second, bool note) {
    const double *start = r->rest[first], *before = start;
    double area = 0, along = 0;
    for (int32_t from = first, at = second; at >= 0;) {
        const double *here = r->rest[at];
        area += (before[0] - start[0]) * (here[1] - start[1]) - (before[1] - start[1]) * (here[0] - start[0]);
        along += hypot(here[0] - before[0], here[1] - before[1]);
        if (note) r->along[at] = along;
        before = here;
        const int32_t to = step_on(r, from, at, first);
        from = at, at = to;
    }
    return area;
}

static int make_rims(rims *r, brunt_error *error) {
    const brunt_barrier *b = r->b;
    const size_t n = (size_t)b->vertex_count + 1;
    if (BRUNT_NEW(r->next, n, "rims of bodies", error) || BRUNT_NEW(r->along, n, "rims of bodies", error))
        return BRUNT_FAILED;
    for (int32_t v = 0; v < b->vertex_count; v++) r->next[v][0] = r->next[v][1] = BRUNT_NONE, r->along[v] = NAN;
    for (int32_t f = 0; f < b->facet_count; f++)
        for (int end = 0; end < 2; end++) {
            int32_t *next = r->next[b->facet[f][end]];
            next[next[0] >= 0] = b->facet[f][!end];
        }
    for (int32_t v = 0; v < b->vertex_count; v++) {
        if (!isnan(r->along[v]) || r->next[v][0] < 0) continue;
        r->along[v] = 0;
        const bool turned = r->next[v][1] >= 0 && walk(r, v, r->next[v][0], false) < 0;
        walk(r, v, r->next[v][turned], true);
    }
    return BRUNT_OK;
}

static int by_place(const void *left, const void *right) {
    const brunt_traction *a = left, *b = right;
    if (a->body != b->body) return a->body < b->body ? -1 : 1;
    if (a->along != b->along) return a->along < b->along ? -1 : 1;
    if (a->other != b->other) return a->other < b->other ? -1 : 1;
    return (a->boundary > b->boundary) - (a->boundary < b->boundary);
}

typedef struct tellers {
    rims rims;
    const double *u;
    brunt_barrier_tractions *to;
    int32_t *last, *before; // entry of each vertex, and of each entry the one of its vertex before it
} tellers;

// What a vertex has of another body, or a plane; a new one where there is nothing yet.
static brunt_traction *entry_of(tellers *t, int32_t v, int32_t other, int32_t plane) {
    for (int32_t at = t->last[v]; at >= 0; at = t->before[at]) {
        brunt_traction *one = &t->to->traction[at];
        if (one->other == other && one->boundary == plane) return one;
    }
    const int32_t at = t->to->count++;
    brunt_traction *one = &t->to->traction[at];
    t->before[at] = t->last[v], t->last[v] = at;
    *one = (brunt_traction){.body = t->rims.b->body[v], .other = other, .boundary = plane, .along = t->rims.along[v]};
    barrier_move(t->rims.b, v, t->u, one->position);
    for (int k = 0; k < 3; k++) one->position[k] += t->rims.b->step.x[v][k];
    return one;
}

// A force at a place: to a vertex, or from a point of a round rim to those that carry it; of material points and planes
// nothing is told.
static void add_to_vertices(tellers *t, int32_t place, int32_t other, int32_t plane, double force, bool friction) {
    const brunt_barrier *b = t->rims.b;
    const barrier_rim *rim = barrier_rim_of(b, place);
    const barrier_arc *arc = rim ? &b->arc[rim->facet] : NULL;
    for (int i = 0; i < (arc ? arc->curve.places : place < b->vertex_count); i++) {
        const int32_t v = arc ? arc->place[i] : place;
        brunt_traction *one = entry_of(t, v, other, plane);
        *(friction ? &one->tangential : &one->normal) += (arc ? rim->weight[i] : 1) * force / b->vertex_area[v];
    }
}

// The part of a contact's force that place k has. Within a corner the place where a face is pushed may lie beyond its
// end: it is told at that.
static double part_of(const barrier_contact *c, int k) {
    const double w = k == 0 ? c->at.w[k] : -c->at.w[k];
    return c->within ? fmin(fmax(w, 0), 1) : w;
}

// Normal forces, or those of friction: to the vertices on both sides, by their weights. Along each rim friction has the
// same sign, as both go by their own body to the left: a quarter turn from where it looks, which is -n of the first.
static void add_contacts(tellers *t, const barrier_contacts *list, bool friction) {
    const brunt_barrier *b = t->rims.b;
    for (int64_t i = 0; i < list->count; i++) {
        const barrier_contact *c = &list->contact[i];
        const bool plane = barrier_law_is_plane(b, c->law);
        double f[3] = {0}, force;
        if (friction) barrier_slip_force(b, c, t->u, f);
        force = friction ? f[0] * c->at.n[1] - f[1] * c->at.n[0] : barrier_contact_force(b, c);
        for (int k = 0; k < c->at.places; k++) {
            const int32_t other = plane ? BRUNT_NONE : barrier_body_of(b, c->place[k == 0 ? 1 : 0]);
            add_to_vertices(t, c->place[k], other, plane ? c->law : BRUNT_NONE, part_of(c, k) * force, friction);
        }
    }
}

static int tell(tellers *t, brunt_error *error) {
    const brunt_barrier *b = t->rims.b;
    const size_t places = b->round ? 2 * BRUNT_CUBIC_PLACES : b->corner_count ? 4 : 3; // vertices of a contact, at most
    const size_t most = (size_t)(b->contacts.count + b->lagged.count) * places + 1, n = (size_t)b->vertex_count + 1;
    if (make_rims(&t->rims, error) || BRUNT_NEW(t->last, n, "tractions", error) ||
        BRUNT_NEW(t->before, most, "tractions", error) || BRUNT_CAPACITY(t->to->traction, most, 0, "tractions", error))
        return BRUNT_FAILED;
    for (int32_t v = 0; v < b->vertex_count; v++) t->last[v] = BRUNT_NONE;
    add_contacts(t, &b->contacts, false);
    add_contacts(t, &b->lagged, true);
    int32_t kept = 0;
    for (int32_t i = 0; i < t->to->count; i++)
        if (t->to->traction[i].normal != 0) t->to->traction[kept++] = t->to->traction[i];
    t->to->count = kept;
    if (kept) qsort(t->to->traction, (size_t)kept, sizeof *t->to->traction, by_place);
    return BRUNT_OK;
}

int brunt_barrier_tell(const brunt_barrier *b, const double (*rest)[3], const double *u, brunt_barrier_tractions *to,
                       brunt_error *error) {
    BRUNT_ASSERT(b->dim == 2);
    tellers t = {.rims = {.b = b, .rest = rest}, .u = u, .to = to};
    to->count = 0;
    const int status = tell(&t, error);
    brunt_free(t.rims.next), brunt_free(t.rims.along), brunt_free(t.last), brunt_free(t.before);
    return status;
}

void brunt_barrier_tractions_free(brunt_barrier_tractions *tractions) {
    brunt_free(tractions->traction);
    *tractions = (brunt_barrier_tractions){.traction = NULL};
}
