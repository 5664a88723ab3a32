// Corners of surfaces that may overlap: what is within a corner is pushed out over both its faces at once, by less the
// nearer it is to the other of them.
//
// Over the nearest face alone a node of a flat floor that has come d deep into a block, less than d beside its corner,
// would leave by the block's side, where it never came in: a tooth of the whole normal force that holds what Coulomb's
// law lets slide. Surfaces without thickness do not say where a point came in. But what there is of a tooth is what
// energy there is to be climbed, so that it has to rise slowly from nothing at both faces. With x and y how deep a
// point is behind the two, of a length l much longer than that,
//   E = k l^2 F / 2 of its area, F = x^2 y^2 (1 + 2 H), H = (1 - x) (1 - y) / (1 - x y),
// is 0 at both faces with its slope, and for y = 1 it is x^2 with a slope of 0 by y, as it is behind one face alone: F
// is that from there on. It pushes out of both faces, never back: F_x = 2 x A, A = y^2 (1 + 2 H - x p^2) >= 0, p = (1 -
// y) / (1 - x y), where F_y is the same with x and y exchanged. To what presses a node by k l x the tooth is 3 x / 4 at
// most (x small: F = x^2 (3 y^2 - 2 y^3)), and as one end of a block climbs it the other descends.
//
// Both pushes are contacts with faces, of weights A, so that friction, moments, tractions and what is summed of
// contacts are those of any other; what they have together is the energy, and each force's slope by the other gap. x =
// (dhat - d) / l, so that what pushes before it touches does so within a mitred corner, and gets no farther than there.
//
// A corner is where a rim turns by more than 50 degrees, outwards, in the reference configuration. l is three quarters
// of the reach, which is half the shortest edge, so that two ends of an edge do not meet; less in corners below 90
// degrees, where a point that is l behind both faces is farther along them.
#include "contact/barrier/barrier_parts.h"

static const double CORNER = 0.8726646259971648, PI = 3.14159265358979323846; // 50 degrees
static const double OF_REACH = 0.75;

// What a point that is x and y within a corner is pushed by, and the slopes of that.
typedef struct fade {
    double energy, a, by_x, by_y; // F, A, and A by x and y
} fade;

static fade fade_at(double x, double y) {
    const double q = 1 - x * y, p = (1 - y) / q, s = (1 - x) / q, g = 1 + 2 * (1 - x) * p;
    return (fade){.energy = x * x * y * y * g,
                  .a = y * y * (g - x * p * p),
                  .by_x = -y * y * p * p * (3 + 2 * x * y / q),
                  .by_y = 2 * y * (g - x * p * p) - 2 * y * y * s * (s - x * p / q)};
}

// ------------------------------------------------------------------------------------------------- of the mesh

typedef struct corner_maker {
    brunt_barrier *b;
    const double (*x)[3];
    int32_t (*at)[2]; // of vertices: the facets that end and begin there, in the order in which the body is to the left
    int8_t *facets;
} corner_maker;

static void along(const corner_maker *m, int32_t facet, double e[2]) {
    const int32_t *f = m->b->facet[facet];
    const double sign = m->b->turned[facet] ? -1 : 1;
    for (int k = 0; k < 2; k++) e[k] = sign * (m->x[f[1]][k] - m->x[f[0]][k]);
}

static void note_corner(corner_maker *m, int32_t v) {
    const int32_t *f = m->at[v];
    double e[2], o[2];
    if (m->facets[v] != 2 || f[0] < 0 || f[1] < 0) return;
    along(m, f[0], e), along(m, f[1], o);
    const double turn = atan2(e[0] * o[1] - e[1] * o[0], e[0] * o[0] + e[1] * o[1]), half = (PI - turn) / 2;
    if (!(turn > CORNER)) return;
    m->b->corner[m->b->corner_count++] =
        (barrier_corner){.vertex = v, .facet = {f[0], f[1]}, .part = OF_REACH * fmin(1, tan(half)), .sine = sin(half)};
}

static int list_ends(corner_maker *m, brunt_error *error) {
    const brunt_barrier *b = m->b;
    const size_t n = (size_t)b->vertex_count + 1;
    if (BRUNT_NEW(m->at, n, "corners of bodies", error) || BRUNT_NEW(m->facets, n, "corners of bodies", error))
        return BRUNT_FAILED;
    for (int32_t v = 0; v < b->vertex_count; v++) m->at[v][0] = m->at[v][1] = BRUNT_NONE;
    for (int32_t f = 0; f < b->facet_count; f++)
        for (int end = 0; end < 2; end++) {
            const int32_t v = b->facet[f][end];
            m->at[v][(end == 0) != b->turned[f]] = f;
            if (m->facets[v] < 3) m->facets[v]++;
        }
    return BRUNT_OK;
}

int barrier_make_corners(brunt_barrier *b, const double (*x)[3], brunt_error *error) {
    corner_maker m = {.b = b, .x = x};
    int status = list_ends(&m, error);
    if (!status) status = BRUNT_CAPACITY(b->corner, (size_t)b->vertex_count + 1, 0, "corners of bodies", error);
    if (!status) status = BRUNT_CAPACITY(b->corner_of, (size_t)b->facet_count + 1, 0, "corners of bodies", error);
    for (int32_t v = 0; v < b->vertex_count && !status; v++) note_corner(&m, v);
    for (int32_t f = 0; f < b->facet_count && !status; f++) b->corner_of[f] = BRUNT_NONE;
    // Of the two facets that is asked for whose way ends there: a facet has one such end.
    for (int32_t i = 0; i < b->corner_count && !status; i++) b->corner_of[b->corner[i].facet[0]] = i;
    brunt_free(m.at), brunt_free(m.facets);
    return status;
}

int32_t barrier_beyond_corner(const brunt_barrier *b, const barrier_corner *corner) {
    const int32_t *other = b->facet[corner->facet[1]];
    return other[other[0] == corner->vertex];
}

// ------------------------------------------------------------------------------------------------- of a point

static fade fade_of(const brunt_barrier *b, const barrier_contact *c, double *x) {
    const double distance = barrier_law_of(b, c->law).distance, size = c->wedge.size;
    *x = (distance - (c->at.d - c->offset)) / size;
    return fade_at(*x, (distance - c->wedge.gap) / size);
}

static barrier_feature face_of(const brunt_barrier *b, const barrier_feature *of, int which) {
    barrier_feature f = *of;
    f.facet = of->corner->facet[which], f.times = 1;
    memcpy(f.vertex, b->facet[f.facet], sizeof f.vertex);
    return f;
}

barrier_contact barrier_contact_within(const brunt_barrier *b, int32_t point, const barrier_feature *f,
                                       const double *u) {
    const barrier_corner *corner = f->corner;
    const barrier_feature beside = face_of(b, f, f->facet == corner->facet[0]);
    const barrier_contact other = barrier_contact_with(b, point, &beside, u);
    const int far = other.place[1] == corner->vertex ? 2 : 1;
    double x;
    barrier_contact c = barrier_contact_with(b, point, f, u);
    c.place[3] = other.place[far], c.at.places = 4;
    c.within = c.place[1] == corner->vertex ? 1 : 2;
    c.wedge = (barrier_wedge){.size = corner->part * barrier_law_of(b, c.law).reach,
                              .gap = other.at.d - other.offset,
                              .n = {other.at.n[0], other.at.n[1]},
                              .far = other.at.w[far],
                              .area = c.weight};
    c.weight *= fade_of(b, &c, &x).a;
    return c;
}

// Whether a point is within a corner at one of the facets that it is near, and the first face of that; what there is
// of F.
static double look_within(const brunt_barrier *b, int32_t point, int64_t item, const double *u, barrier_feature *face) {
    const int32_t facet = b->facets.item[item];
    const barrier_corner *corner = b->corner_of[facet] >= 0 ? &b->corner[b->corner_of[facet]] : NULL;
    double x;
    if (!corner || barrier_arc_of(b, corner->facet[0]) || barrier_arc_of(b, corner->facet[1])) return INFINITY;
    *face = (barrier_feature){.corner = corner};
    face->law = barrier_law_between(b, barrier_body_of(b, point), b->body[corner->vertex], &face->side);
    face->share = barrier_share_of(b, face->law, face->side, false);
    *face = face_of(b, face, 0);
    const brunt_barrier_pair *pair = barrier_pair_of(b, face->law);
    // Of more the mitre would be farther away than what is near.
    if (!(pair->reach > 0) || pair->distance > corner->sine * pair->reach) return INFINITY;
    const barrier_contact c = barrier_contact_within(b, point, face, u);
    const fade f = fade_of(b, &c, &x);
    const double y = (pair->distance - c.wedge.gap) / c.wedge.size;
    return x > 0 && x < 1 && y > 0 && y < 1 ? f.energy : INFINITY;
}

static barrier_feature *known_feature(barrier_workspace *r, int32_t first, int32_t second) {
    for (int64_t i = 0; i < r->feature_count; i++) {
        barrier_feature *f = &r->feature[i];
        if (f->vertex[0] == first && f->vertex[1] == second && !f->corner) return f;
    }
    return NULL;
}

// What both faces and their vertex have counted is taken back, and the faces of the corner come in its place.
static void put_within(const brunt_barrier *b, const barrier_feature *of, barrier_workspace *r) {
    barrier_feature *tip = known_feature(r, of->corner->vertex, -1);
    if (tip) tip->times++;
    for (int k = 0; k < 2; k++) {
        const barrier_feature face = face_of(b, of, k);
        barrier_feature *known = known_feature(r, face.vertex[0], face.vertex[1]);
        if (known) known->times--;
        if (!known && tip) tip->times--;
        r->feature[r->feature_count++] = face;
    }
}

// Of a body one corner alone: the one that pushes less, where edges have become so short that it is within two.
void barrier_find_corners(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r) {
    const int64_t first = b->facets.first[point], end = b->facets.first[point + 1];
    if (!b->corner_count || b->touch > 0) return;
    for (int64_t i = first; i < end; i++) {
        barrier_feature face, other;
        const double energy = look_within(b, point, i, u, &face);
        bool least = energy < INFINITY;
        for (int64_t k = first; k < end && least; k++) {
            const double beside = k == i ? INFINITY : look_within(b, point, k, u, &other);
            if (beside < INFINITY && other.law == face.law) least = energy < beside || (energy == beside && i < k);
        }
        if (least) put_within(b, &face, r);
    }
}

// ------------------------------------------------------------------------------------------------- of a contact

double barrier_within_energy(const brunt_barrier *b, const barrier_contact *c, double stiffness) {
    double x;
    return c->wedge.area * stiffness * c->wedge.size * c->wedge.size / 4 * fade_of(b, c, &x).energy;
}

barrier_within barrier_within_of(const brunt_barrier *b, const barrier_contact *c) {
    const barrier_wedge *w = &c->wedge;
    double x;
    const fade f = fade_of(b, c, &x);
    barrier_within of = {.weight = {-w->area * f.by_x / w->size, -w->area * f.by_y / w->size},
                         .slope = {w->area * (f.a + x * f.by_x), w->area * x * f.by_y}};
    const double own[4] = {1, c->within == 1 ? -1 - w->far : 0, c->within == 2 ? -1 - w->far : 0, w->far};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++) of.other[i * 2 + k] = own[i] * w->n[k];
    return of;
}
