// Lines that hold material points are cut into pieces of equal length, with boundary particles on them.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "boundary/boundary_pieces.h"

// Parts of a line that follow each other without a corner, but for short ones.
typedef struct chain {
    const brunt_boundary_surface_def *def;
    int32_t first, end; // facets
    double length;      // [m]
} chain;

static const double *corner_of(const brunt_boundary_surface_def *def, int32_t facet, int corner) {
    return def->point[def->facet[facet][corner]];
}

// Length [m] and direction of a part.
static double direction(const brunt_boundary_surface_def *def, int32_t facet, double t[3]) {
    const double *a = corner_of(def, facet, 0), *b = corner_of(def, facet, 1);
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    for (int k = 0; k < 3; k++) t[k] = k < 2 ? (b[k] - a[k]) / length : 0;
    return length;
}

// Whether a part goes on where the one before it ends, without a corner; of a closed line the last is before the first.
static bool follows(const brunt_boundary_surface_def *def, int32_t facet) {
    const int32_t before = facet > 0 ? facet - 1 : def->facet_count - 1;
    double a[3], b[3];
    if (def->facet[facet][0] != def->facet[before][1]) return false;
    direction(def, before, a);
    direction(def, facet, b);
    return a[0] * b[0] + a[1] * b[1] > BRUNT_BOUNDARY_CORNER;
}

// From a part to the next corner.
static chain run_from(const brunt_boundary_surface_def *def, int32_t first) {
    chain c = {.def = def, .first = first, .end = first};
    double t[3];
    do c.length += direction(def, c.end++, t);
    while (c.end < def->facet_count && follows(def, c.end));
    return c;
}

// From a part to the next corner that ends pieces.
static chain next_chain(const brunt_boundary_surface_def *def, int32_t first, double cell) {
    chain c = run_from(def, first);
    while (c.end < def->facet_count && def->facet[c.end][0] == def->facet[c.end - 1][1]) {
        const chain next = run_from(def, c.end);
        if (fmin(c.length, next.length) >= BRUNT_BOUNDARY_SHORT * def->piece * cell) break;
        c.end = next.end, c.length += next.length;
    }
    return c;
}

// Pieces and particles of a chain: as many as the wanted lengths go into it, at least one.
static int32_t chain_pieces(const chain *c, double cell) {
    return (int32_t)fmax(1, floor(c->length / (c->def->piece * cell) + 1e-9));
}
static int32_t piece_particles(const chain *c, double cell) {
    return (int32_t)fmax(1, ceil(c->length / chain_pieces(c, cell) / cell * c->def->particles - 1e-9));
}

// The direction of a part at a distance from its beginning [m]: where it goes on without a corner, the turn is spread
// over the half of each part, or of a piece if that is less.
static void direction_at(const brunt_boundary_surface *s, const chain *c, int32_t facet, double at, double t[3]) {
    const brunt_boundary_surface_def *def = c->def;
    const int32_t next = facet + 1 < def->facet_count ? facet + 1 : 0;
    const double length = direction(def, facet, t), reach = 0.5 * fmin(length, def->piece * s->cell);
    double own[3], other[3];
    memcpy(own, t, sizeof own);
    for (int end = 0; end < 2; end++) {
        const double near = fmax(0, 1 - (end ? length - at : at) / reach);
        if (near == 0 || !follows(def, end ? next : facet)) continue;
        direction(def, end ? next : facet > 0 ? facet - 1 : def->facet_count - 1, other);
        const double size = hypot(own[0] + other[0], own[1] + other[1]);
        for (int a = 0; a < 2; a++) t[a] += near * ((own[a] + other[a]) / size - own[a]);
    }
    const double size = hypot(t[0], t[1]);
    if (t[0] != own[0] || t[1] != own[1])
        for (int a = 0; a < 2; a++) t[a] /= size;
}

static void fill_chain(brunt_boundary_surface *s, const chain *c) {
    const int32_t pieces = chain_pieces(c, s->cell), each = piece_particles(c, s->cell);
    const double step = c->length / pieces / each;
    int32_t facet = c->first;
    double t[3], from = 0, length = direction(c->def, facet, t);
    for (int32_t k = 0; k < pieces * each; k++) {
        const double at = (k + 0.5) * step;
        while (at > from + length && facet + 1 < c->end) from += length, length = direction(c->def, ++facet, t);
        const double *a = corner_of(c->def, facet, 0);
        double along[3];
        direction_at(s, c, facet, at - from, along);
        brunt_boundary_particle *p = &s->particle[s->particle_count++];
        *p = (brunt_boundary_particle){.x = {a[0] + (at - from) * t[0], a[1] + (at - from) * t[1]},
                                       .normal = {-along[1], along[0]},
                                       .tangent = {{along[0], along[1]}},
                                       .weight = step,
                                       .piece = s->pieces + k / each};
        if (k % each == 0) s->first[p->piece] = s->particle_count - 1;
    }
    s->pieces += pieces;
    s->first[s->pieces] = s->particle_count;
}

static int check_line(const brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error) {
    double length = 0, t[3];
    for (int32_t f = 0; f < def->facet_count; f++) {
        const double part = direction(def, f, t);
        if (!(part > 0))
            return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).line.points: two that follow each other are one",
                              s->boundary->name);
        length += part;
    }
    if (!(length / s->cell / def->piece < BRUNT_BOUNDARY_PARTICLE_LIMIT))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "boundaries (%s).piece: pieces of %g cells would be %.3g on a line %.3g cells long: that is "
                          "too many",
                          s->boundary->name, def->piece, length / s->cell / def->piece, length / s->cell);
    if (!(length / s->cell * def->particles < BRUNT_BOUNDARY_PARTICLE_LIMIT))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "boundaries (%s).line: %.3g cells long, with %d boundary particles in each: that is too many",
                          s->boundary->name, length / s->cell, def->particles);
    return BRUNT_OK;
}

int brunt_boundary_cut_line(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error) {
    size_t pieces = 1, particles = 1;
    BRUNT_TRY(check_line(s, def, error));
    for (chain c = {0}; c.end < def->facet_count;) {
        c = next_chain(def, c.end, s->cell);
        pieces += (size_t)chain_pieces(&c, s->cell);
        particles += (size_t)chain_pieces(&c, s->cell) * (size_t)piece_particles(&c, s->cell);
    }
    if (BRUNT_NEW(s->particle, particles, "particles of a boundary", error) ||
        BRUNT_NEW(s->first, pieces + 1, "pieces of a boundary", error))
        return BRUNT_FAILED;
    for (chain c = {0}; c.end < def->facet_count;) {
        c = next_chain(def, c.end, s->cell);
        fill_chain(s, &c);
    }
    return BRUNT_OK;
}
