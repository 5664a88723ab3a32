// Most nodes are over the inside of the facet that they were over a step ago. What they see there is found for as many
// at once as a vector holds, by the arithmetic of point_facet.c: the same sums of the same products, in the same order.
#include "contact/search/node_lanes.h"

#include "base/transpose.h"
#include "contact/search/candidates_parts.h"

enum { LANES = BRUNT_DOUBLES };
static const double NEAR_SPOKE = 1e-3; // of a quadrilateral's area: as in point_facet.c

// Four numbers are read of each, as registers go: the arrays of a surface have a row to spare behind the last.
BRUNT_INLINE void three_of(double (*of)[3], const int32_t at[LANES], doubles out[3]) {
    const double *place[LANES];
    doubles all[4];
    for (int l = 0; l < LANES; l++) place[l] = of[at[l]];
    doubles_take(place, all);
    for (int a = 0; a < 3; a++) out[a] = all[a];
}

BRUNT_INLINE doubles dots(const doubles a[3], const doubles b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
BRUNT_INLINE doubles dots_turned(const doubles a[3], const doubles b[3]) {
    return a[1] * b[1] + a[0] * b[0] + a[2] * b[2];
}
BRUNT_INLINE void crosses(const doubles a[3], const doubles b[3], doubles c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
BRUNT_INLINE doubles size_of(doubles a) { return doubles_select(a < doubles_set(0), -a, a); }

// Of each lane: the facet's corners and centre, and the triangle about that which the node is over.
typedef struct lane_facets {
    int32_t corner[4][LANES];
    doubles x[4][3], centre[3], normal[3], area;
    doubles_mask over[4]; // which of the four triangles; of none where that is not clear
    doubles n[3];         // across that triangle, twice its area
} lane_facets;

BRUNT_INLINE void take_facets(const brunt_contact_surface *s, const node_lanes *at, lane_facets *f) {
    for (int l = 0; l < LANES; l++) {
        for (int c = 0; c < 4; c++) f->corner[c][l] = s->face[at->face[l]][c];
        f->area[l] = s->face_area[at->face[l]];
    }
    for (int c = 0; c < 4; c++) three_of(s->x, f->corner[c], f->x[c]);
    three_of(s->face_centre, at->face, f->centre), three_of(s->face_normal, at->face, f->normal);
}

// As clear_sector in point_facet.c.
BRUNT_INLINE void find_sectors(const doubles x[3], lane_facets *f) {
    const doubles near = doubles_set((1 + 1e-6) * NEAR_SPOKE) * f->area, zero = {0};
    doubles r[3], m[3], turn[5];
    doubles_mask clear = doubles_set_mask(-1);
    for (int k = 0; k < 3; k++) r[k] = x[k] - f->centre[k];
    crosses(r, f->normal, m);
    for (int t = 0; t < 4; t++) {
        doubles arm[3];
        for (int k = 0; k < 3; k++) arm[k] = f->x[t][k] - f->centre[k];
        turn[t] = dots(arm, m);
        clear &= size_of(turn[t]) > near;
    }
    turn[4] = turn[0];
    doubles_mask any = zero != zero, two = any;
    for (int t = 0; t < 4; t++) {
        f->over[t] = clear & (turn[t] > zero) & (turn[t + 1] < zero);
        two |= any & f->over[t], any |= f->over[t];
    }
    for (int t = 0; t < 4; t++) f->over[t] &= ~two;
}

// Of the four the one that counts.
BRUNT_INLINE doubles chosen(const doubles_mask over[4], doubles a, doubles b, doubles c, doubles d) {
    return doubles_select(over[0], a, doubles_select(over[1], b, doubles_select(over[2], c, d)));
}

// A triangle of each lane, its edges from the first corner, and what tells where on it the nearest point is, as of
// on_triangles there.
typedef struct lane_triangles {
    doubles ab[3], ac[3], ap[3]; // to the second corner, to the third, to the node
    doubles d1, d2, d3, d4, d5, d6, va, vb, vc, sum;
    doubles_mask at_a, at_b, at_c, on_ab, on_ac, on_bc, inside;
    doubles d[3], square; // from the nearest point to the node
} lane_triangles;

BRUNT_INLINE void find_regions(const doubles a[3], const doubles b[3], const doubles c[3], const doubles x[3],
                               lane_triangles *t) {
    const doubles zero = {0};
    doubles bp[3], cp[3];
    for (int k = 0; k < 3; k++)
        t->ab[k] = b[k] - a[k], t->ac[k] = c[k] - a[k], t->ap[k] = x[k] - a[k], bp[k] = x[k] - b[k],
        cp[k] = x[k] - c[k];
    const doubles d1 = dots(t->ab, t->ap), d2 = dots(t->ac, t->ap), d3 = dots_turned(t->ab, bp),
                  d4 = dots_turned(t->ac, bp), d5 = dots_turned(t->ab, cp), d6 = dots_turned(t->ac, cp);
    const doubles va = -(d5 * d4 - d3 * d6), vb = -(d1 * d6 - d5 * d2), vc = -(d3 * d2 - d1 * d4);
    t->d1 = d1, t->d2 = d2, t->d3 = d3, t->d4 = d4, t->d5 = d5, t->d6 = d6;
    t->va = va, t->vb = vb, t->vc = vc, t->sum = va + vb + vc;
    t->at_a = (d1 <= zero) & (d2 <= zero), t->at_b = (d3 >= zero) & (d4 <= d3), t->at_c = (d6 >= zero) & (d5 <= d6);
    t->on_ab = (vc <= zero) & (d1 >= zero) & (d3 <= zero), t->on_ac = (vb <= zero) & (d2 >= zero) & (d6 <= zero);
    t->on_bc = (va <= zero) & (d4 >= d3) & (d5 >= d6);
    t->inside = ~(t->at_a | t->at_b | t->at_c | t->on_ab | t->on_ac | t->on_bc);
}

// With the weights of the second and the third corner there.
BRUNT_INLINE void find_way(doubles v, doubles w, lane_triangles *t) {
    for (int k = 0; k < 3; k++) t->d[k] = t->ap[k] - v * t->ab[k] - w * t->ac[k];
    t->square = dots(t->d, t->d);
}

// Weights of the four corners, as brunt_face_values has them.
BRUNT_INLINE void find_weights(const lane_facets *f, const lane_triangles *t, doubles weight[4]) {
    const doubles zero = {0}, one = doubles_set(1), inverse = one / dots(f->n, f->n);
    doubles rg[3], er[3];
    crosses(t->ap, t->ac, rg), crosses(t->ab, t->ap, er);
    const doubles w1 = dots(rg, f->n) * inverse, w2 = dots(er, f->n) * inverse, w0 = one - w1 - w2;
    const doubles each = doubles_set(0.25) * w2;
    for (int c = 0; c < 4; c++) {
        const doubles own =
            doubles_select(f->over[c], w0, doubles_select(f->over[(c + 3) % 4], w1, zero)); // its first, its second
        weight[c] = each + own;
    }
}

// As brunt_node_to_facet_approach.
BRUNT_INLINE doubles find_approach(double (*of)[3], const node_lanes *at, const lane_facets *f, const doubles weight[4],
                                   const doubles n[3]) {
    doubles v[3];
    three_of(of, at->node, v);
    doubles along = dots(v, n);
    for (int c = 0; c < 4; c++) {
        three_of(of, f->corner[c], v);
        along -= weight[c] * dots(v, n);
    }
    return along;
}

static void tell_motion(const brunt_contact_surface *s, const lane_facets *f, const lane_triangles *t,
                        const doubles n[3], doubles gap, node_lanes *out) {
    const doubles zero = {0};
    doubles weight[4];
    find_weights(f, t, weight);
    doubles_store(out->approach, find_approach(s->v, out, f, weight, n));
    const doubles_mask behind = gap < zero;
    int64_t any = 0;
    for (int l = 0; l < LANES; l++) any |= behind[l];
    if (any) doubles_store(out->came, find_approach(s->old, out, f, weight, n));
}

void brunt_node_lanes_look(const brunt_contact_surface *s, double range, node_lanes *out) {
    const doubles zero = {0}, opposed = doubles_set(OPPOSED);
    const double close = CLOSE * s->mean_edge;
    lane_facets f;
    lane_triangles t;
    doubles x[3], a[3], b[3], normal[3], n[3];
    take_facets(s, out, &f);
    three_of(s->x, out->node, x), three_of(s->normal, out->node, normal);
    find_sectors(x, &f);
    for (int k = 0; k < 3; k++) {
        a[k] = chosen(f.over, f.x[0][k], f.x[1][k], f.x[2][k], f.x[3][k]);
        b[k] = chosen(f.over, f.x[1][k], f.x[2][k], f.x[3][k], f.x[0][k]);
    }
    find_regions(a, b, f.centre, x, &t);
    find_way(t.vb / t.sum, t.vc / t.sum, &t);
    crosses(t.ab, t.ac, f.n);
    const doubles square_of_n = dots(f.n, f.n);
    const doubles_mask known = (f.over[0] | f.over[1] | f.over[2] | f.over[3]) & t.inside & (square_of_n > zero) &
                               (-dots(f.normal, normal) > opposed) & (t.square <= doubles_set(close * close)) &
                               (t.square <= doubles_set(range * range));
    const doubles size = doubles_sqrt(square_of_n);
    for (int k = 0; k < 3; k++) n[k] = f.n[k] / size + zero, t.d[k] += zero;
    const doubles gap = dots(n, t.d);
    const doubles_mask faces = -dots(n, normal) > opposed;
    for (int l = 0; l < LANES; l++) {
        out->known[l] = known[l], out->opposed[l] = faces[l];
        out->triangle[l] = f.over[0][l] ? 0 : f.over[1][l] ? 1 : f.over[2][l] ? 2 : 3;
        for (int k = 0; k < 3; k++) out->n[l][k] = n[k][l];
    }
    doubles_store(out->gap, gap), doubles_store(out->square, t.square);
    tell_motion(s, &f, &t, n, gap, out);
}

// Square of the distance to a triangle.
BRUNT_INLINE doubles square_to(const doubles a[3], const doubles b[3], const doubles c[3], const doubles x[3],
                               doubles_mask *inside) {
    const doubles zero = {0}, one = doubles_set(1);
    lane_triangles t;
    find_regions(a, b, c, x, &t);
    const doubles way = (t.d4 - t.d3) / ((t.d4 - t.d3) + (t.d5 - t.d6));
    doubles v = doubles_select(t.on_bc, one - way, t.vb / t.sum), w = doubles_select(t.on_bc, way, t.vc / t.sum);
    v = doubles_select(t.on_ac, zero, v), w = doubles_select(t.on_ac, t.d2 / (t.d2 - t.d6), w);
    v = doubles_select(t.on_ab, t.d1 / (t.d1 - t.d3), v), w = doubles_select(t.on_ab, zero, w);
    v = doubles_select(t.at_c, zero, v), w = doubles_select(t.at_c, one, w);
    v = doubles_select(t.at_b, one, v), w = doubles_select(t.at_b, zero, w);
    v = doubles_select(t.at_a, zero, v), w = doubles_select(t.at_a, zero, w);
    *inside |= t.inside;
    find_way(v, w, &t);
    return t.square;
}

void brunt_node_lanes_squares(const brunt_contact_surface *s, const int32_t node[LANES], const int32_t face[LANES],
                              double square[LANES]) {
    const doubles least_yet = doubles_set(INFINITY);
    doubles x[3], corner[4][3], centre[3], least = least_yet;
    doubles_mask inside = {0};
    three_of(s->x, node, x), three_of(s->face_centre, face, centre);
    for (int c = 0; c < 4; c++) {
        int32_t at[LANES];
        for (int l = 0; l < LANES; l++) at[l] = s->face[face[l]][c];
        three_of(s->x, at, corner[c]);
    }
    for (int t = 0; t < 4; t++) {
        const doubles one = square_to(corner[t], corner[(t + 1) % 4], centre, x, &inside);
        least = doubles_select(one < least, one, least);
    }
    doubles_store(square, doubles_select(inside, doubles_set(-1), least));
}
