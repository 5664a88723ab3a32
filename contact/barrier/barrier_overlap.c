// Surfaces that may overlap, in two dimensions: gaps with a sign, told by the side of the rim that a point is on.
//
// From outside gaps are as those of barriers: all facets within reach count. From inside the way out is over the
// nearest feature alone: with others that surround it, a point below a corner would be pushed twice. Where two are as
// near but for rounding, each has its share, so that mirror images do the same. As it is with the nearest of several,
// what leaves one facet for the next below a vertex turns its force by the rim's angle there; the energy goes on
// without a step. Where that angle is more than 50 degrees, faces push as barrier_corner.c says.
#include "contact/barrier/barrier_parts.h"

static const double TIE = 1e-9; // of the reach

// [m] The normal of a facet at u, out of its body, as long as the facet.
static void outward(const brunt_barrier *b, int32_t facet, const double *u, double n[3]) {
    const int32_t *f = b->facet[facet];
    const double sign = b->turned[facet] ? -1 : 1;
    double x[1][3];
    barrier_relative(b, u, f[0], f + 1, 1, x);
    n[0] = sign * x[0][1], n[1] = -sign * x[0][0], n[2] = 0;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Adds the unit normals of the facets about a vertex that the point is near: on the side that their sum looks to it is
// outside.
static void outward_at(const brunt_barrier *b, int32_t point, int32_t vertex, const double *u, double sum[3]) {
    for (int64_t i = b->facets.first[point]; i < b->facets.first[point + 1]; i++) {
        const int32_t facet = b->facets.item[i];
        double n[3];
        if (b->facet[facet][0] != vertex && b->facet[facet][1] != vertex) continue;
        outward(b, facet, u, n);
        for (int k = 0; k < 3; k++) sum[k] += n[k] / sqrt(dot(n, n));
    }
}

void barrier_sign(const brunt_barrier *b, int32_t point, const barrier_feature *f, const double *u, brunt_closest *at) {
    double n[3] = {0};
    const bool corner = f->vertex[1] < 0;
    if (corner)
        outward_at(b, point, f->vertex[0], u, n);
    else
        outward(b, f->facet, u, n);
    if (dot(n, at->n) < 0) at->d = -at->d;
    // Of a facet the normal is its own: between the point and its foot there may be rounding alone.
    for (int k = 0; k < 3; k++) at->n[k] = corner ? (at->d < 0 ? -at->n[k] : at->n[k]) : n[k] / sqrt(dot(n, n));
}

// The chord of a body's that a point is nearest to, and the most that a curve of these bends from its own.
typedef struct chord {
    int32_t facet;
    int ends; // bits of those it is nearest to
    double d, bend;
    double from[3]; // its first vertex, from the point
} chord;

static chord nearest_chord(const brunt_barrier *b, int32_t point, int32_t body, const double *u) {
    static const double here[3] = {0};
    chord c = {.facet = BRUNT_NONE, .d = INFINITY};
    for (int64_t i = b->facets.first[point]; i < b->facets.first[point + 1]; i++) {
        const int32_t facet = b->facets.item[i];
        const barrier_arc *arc = barrier_arc_of(b, facet);
        double x[BRUNT_CUBIC_PLACES][3], d;
        if (b->body[b->facet[facet][0]] != body) continue;
        barrier_relative(b, u, point, arc ? arc->place : b->facet[facet], arc ? arc->curve.places : 2, x);
        if (arc) c.bend = fmax(c.bend, brunt_cubic_bend((const double(*)[3])x, &arc->curve));
        const int ends = brunt_closest_of_edge(here, x[0], x[1], &d);
        if (d >= c.d) continue;
        c.facet = facet, c.ends = ends, c.d = d;
        memcpy(c.from, x[ends == BRUNT_AT_B], sizeof c.from);
    }
    return c;
}

double barrier_clearance(const brunt_barrier *b, int32_t point, int32_t body, const brunt_barrier_pair *pair,
                         const double *u) {
    static const double MORE = 1 + 1e-9; // rounding
    const chord c = nearest_chord(b, point, body, u);
    const double by = c.d - MORE * (pair->distance + b->touch + pair->offset + 2 * c.bend);
    double n[3] = {0};
    if (!(by > 0) || c.facet < 0) return 0;
    if (c.ends == (BRUNT_AT_A | BRUNT_AT_B))
        outward(b, c.facet, u, n);
    else
        outward_at(b, point, b->facet[c.facet][c.ends == BRUNT_AT_B], u, n);
    return dot(n, c.from) < 0 ? by : 0;
}

// The gap of feature i at u, by its offset.
static double gap_of(const brunt_barrier *b, int32_t point, const barrier_feature *f, const double *u) {
    const barrier_contact c = barrier_contact_with(b, point, f, u);
    return c.at.d - c.offset;
}

void barrier_settle_overlaps(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r) {
    barrier_find_corners(b, point, u, r);
    for (int64_t i = 0; i < r->feature_count; i++) {
        barrier_feature *f = &r->feature[i];
        f->gap = INFINITY;
        if (!f->times || !(barrier_pair_of(b, f->law)->reach > 0)) continue;
        f->gap = gap_of(b, point, f, u);
        if (!(f->gap < barrier_pair_of(b, f->law)->distance + b->touch)) f->times = 0;
    }
    for (int64_t i = 0; i < r->feature_count; i++) {
        barrier_feature *f = &r->feature[i];
        if (!f->times || f->corner || !(f->gap < 0)) continue;
        const double tie = TIE * barrier_pair_of(b, f->law)->reach;
        int nearest = 1;
        for (int64_t k = 0; k < r->feature_count && nearest; k++) {
            const barrier_feature *other = &r->feature[k];
            if (k == i || other->law != f->law) continue;
            if (other->gap >= 0 ? other->gap <= -f->gap : other->gap > f->gap + tie)
                nearest = 0;
            else
                nearest += other->gap < 0 && other->gap >= f->gap - tie;
        }
        f->times = nearest > 0;
        if (nearest) f->share /= nearest;
    }
}

double barrier_overlap_limit(double gap, double reach, double way, double largest) {
    const double room = reach / 2 + fmax(gap - reach, 0);
    return way * largest > room ? room / way : largest;
}
