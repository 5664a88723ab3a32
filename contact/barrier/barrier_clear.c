// Points clear of bodies that they may overlap: most of those that are near one are outside it, and go on to be so.
// Where contacts are listed it is noted how far they are from it; until nodes have moved by as much nothing is computed
// of them.
//
// A point and the facets of a rim come closer by no more than `spread` times the way of the node that goes farthest,
// along straight lines, and what a curve bends from its chord grows by no more. What was not near is farther than the
// range: no clearance is kept that is more, so that what is kept of points that were near no more holds as well. On the
// way from outside to inside there is a place at which the distance is 0, so that what is clear by more than was lost
// is on the outside still.
#include "contact/barrier/barrier_parts.h"

static const double TWICE_BEND = 1.5; // of what Bezier's points leave the chord's by: as chords are cleared by

static double sum_of_sizes(const barrier_arc *arc, double a, double b, double c, double d) {
    double sum = 0;
    for (int i = 0; i < arc->curve.places; i++) {
        const double *w = arc->curve.weight[i];
        sum += fabs(a * w[0] + b * w[1] + c * w[2] + d * w[3]);
    }
    return sum;
}

// The most that a place of a curve moves, and its chord with what it bends from that.
static double spread_of(const barrier_arc *arc) {
    const double first = sum_of_sizes(arc, 1, 1. / 3, 0, 0), second = sum_of_sizes(arc, 1, 2. / 3, 1. / 3, 0),
                 hull = fmax(1, fmax(first, second)), // of Bezier's points
        bend = fmax(sum_of_sizes(arc, 0, 0, 1. / 3, 1. / 3), sum_of_sizes(arc, 0, 0, 1. / 3, 2. / 3));
    return fmax(hull, 1 + TWICE_BEND * bend);
}

void barrier_clear_begin(brunt_barrier *b) {
    double point = 1, facet = 1;
    for (int32_t f = 0; b->round && f < b->facet_count; f++) facet = fmax(facet, spread_of(&b->arc[f]));
    for (int32_t i = 0; i < b->rim_count; i++) {
        double sum = 0;
        for (int k = 0; k < BRUNT_CUBIC_PLACES; k++) sum += fabs(b->rim[i].weight[k]);
        point = fmax(point, sum);
    }
    b->clear.spread = point + facet, b->clear.count = 0;
}

// [m] The greatest displacement of a node by p, less what it is by `from`, unless that is NULL.
static double greatest(int64_t count, int dim, const double *p, const double *from) {
    double most = 0;
    for (int64_t n = 0; n < count; n += dim) {
        double square = 0;
        for (int k = 0; k < dim; k++) {
            const double by = from ? p[n + k] - from[n + k] : p[n + k];
            square += by * by;
        }
        if (square > most || isnan(square)) most = square; // which nothing is greater than
    }
    return most >= 0 ? sqrt(most) : INFINITY;
}

double barrier_clear_lost(const brunt_barrier *b, const double *u) {
    const barrier_clear *c = &b->clear;
    if (!u || c->count == 0) return INFINITY;
    return c->spread * greatest(c->count, b->dim, u, c->at) + fmax(b->touch - c->touch, 0);
}

double barrier_clear_way(const brunt_barrier *b, const double *p) {
    return b->clear.spread * greatest(barrier_unknowns(b), b->dim, p, NULL);
}

bool barrier_is_clear_of(const brunt_barrier *b, int32_t point, int32_t body, const double *u, barrier_workspace *r) {
    const barrier_clear *c = &b->clear;
    double by = r->lost < INFINITY && c->body[point] == body ? c->by[point] - r->lost : 0;
    bool clear = by > 0;
    if (!clear) {
        int8_t side;
        const int32_t law = barrier_law_between(b, barrier_body_of(b, point), body, &side);
        const brunt_barrier_pair *pair = barrier_pair_of(b, law);
        const double beyond = b->source.range - (pair->distance + b->touch + pair->offset);
        by = pair->reach > 0 ? barrier_clearance(b, point, body, pair, u) : 0;
        clear = by > 0, by = fmin(by, beyond);
    }
    if (clear && r->clear_of == BRUNT_NONE) r->clear_of = body, r->clear_by = by;
    return clear;
}

int barrier_clear_reserve(brunt_barrier *b, brunt_error *error) {
    barrier_clear *c = &b->clear;
    const size_t points = (size_t)barrier_points(b);
    if (c->count > 0) return BRUNT_OK;
    if (BRUNT_CAPACITY(c->body, points + 1, 0, "points near bodies", error) ||
        BRUNT_CAPACITY(c->by, points + 1, 0, "points near bodies", error))
        return BRUNT_FAILED;
    for (size_t i = 0; i < points; i++) c->body[i] = BRUNT_NONE;
    return BRUNT_OK;
}

void barrier_clear_note(brunt_barrier *b, int32_t point, const barrier_workspace *r) {
    b->clear.body[point] = r->clear_of, b->clear.by[point] = r->clear_by;
}

int barrier_clear_keep(brunt_barrier *b, const double *u, int64_t unknowns, brunt_error *error) {
    barrier_clear *c = &b->clear;
    if (BRUNT_CAPACITY(c->at, (size_t)unknowns + 1, 0, "unknowns of contact", error)) return BRUNT_FAILED;
    if (unknowns) memcpy(c->at, u, (size_t)unknowns * sizeof *u);
    c->count = unknowns, c->touch = b->touch;
    return BRUNT_OK;
}

void barrier_clear_free(barrier_clear *c) {
    brunt_free(c->at), brunt_free(c->body), brunt_free(c->by);
    *c = (barrier_clear){0};
}
