// What a node meets, by what is remembered of it: among the facets that were about it, or of the one that was nearest.
#include "contact/search/candidates_parts.h"

// Lists the facets that a node with one body near it may come to before anything has moved by much, for what they are
// among to be found without the cells; none where they are too many. Cells hold all that is within their range.
void brunt_candidates_remember(const brunt_contact_context *m, brunt_node_to_facet *f, const search_query *l,
                               int32_t n) {
    const brunt_contact_surface *s = m->surface;
    int32_t *beside = f->cache.beside[n], count = 0, all;
    const int32_t *list = facets_of(f, l, &all);
    f->cache.node[n].beyond = 0;
    if (l->touches != 1 || s->membrane.side || s->renewal.eroded) return;
    const double beyond = fmin(f->cells.range, s->motion.seen) * (1 - 1e-8);
    for (int32_t q = 0; q < all; q++) {
        if (s->face_body[list[q]] != l->touch[0] || !near_box(s->face_box[list[q]], l->x, beyond)) continue;
        if (count == BRUNT_BESIDE) return;
        beside[count++] = list[q];
    }
    if (count < BRUNT_BESIDE) beside[count] = -1;
    if (count > 0) f->cache.node[n].beyond = beyond;
}

// One facet alone as the nearest of its body; there is room for many, which is not filled. Its nearest point.
static inline const brunt_closest *take_one(nearest *one, int32_t face, int32_t body, brunt_closest at) {
    one->body = body, one->count = 1;
    one->square = at.square, one->root = INFINITY;
    one->tied[0] = (tied){at, face};
    return &one->tied[0].at;
}

bool brunt_beside_begin(const brunt_contact_surface *s, const brunt_node_to_facet *f, const double x[3],
                        const int32_t *list, beside_one *b) {
    const double range = f->bodies.range, margin = MARGIN * s->mean_edge, close = CLOSE * s->mean_edge;
    b->root = tie(s, b->two.first), b->least = -1, b->count = 0;
    if (b->two.first > close * close || b->two.first > range * range) return false;
    b->two.second = range * range, b->two.square = b->two.first;
    for (int32_t q = 0; q < BRUNT_BESIDE && list[q] >= 0; q++, b->count++) {
        const double *box = s->face_box[list[q]];
        const bool other = list[q] != b->two.face && near_box(box, x, b->root + margin);
        b->bound[q] = other ? box_square(box, x) : INFINITY;
        if (other && (b->least < 0 || b->bound[q] < b->bound[b->least])) b->least = q;
    }
    return true;
}

// The one that may be the nearest is looked at first: most others are then known to be further.
bool brunt_beside_settle(const brunt_contact_surface *s, const double x[3], const int32_t *list, double square,
                         beside_one *b) {
    const double as_near = b->root * b->root;
    for (int32_t q = 0; b->least >= 0 && q <= b->count; q++) {
        if (!(square > as_near)) return false;
        b->two.second = square < b->two.second ? square : b->two.second;
        const double known = b->two.second > as_near ? b->two.second : as_near;
        while (q < b->count && (q == b->least || b->bound[q] == INFINITY || further(s, b->bound[q], known))) q++;
        if (q < b->count) square = brunt_closest_on_face_within(s, list[q], x, 0).square;
    }
    return true;
}

void brunt_beside_end(const brunt_contact_surface *s, const brunt_node_to_facet *f, const beside_one *b, bool opposed,
                      candidate_list *out) {
    const double margin = MARGIN * s->mean_edge;
    const bool outside = is_before(s, &b->two);
    out->count = opposed && !(out->candidate[0].gap < 0 && outside);
    out->distance = outside ? fmin(f->bodies.range, sqrt(b->two.first)) : 0;
    out->second = out->count ? second_of(s, f, &b->two, out->distance + margin) : 0;
    out->reach = b->root + margin;
}

// Where the facet that was the nearest still is, and none of those listed is as near: what find_candidates comes to.
static bool find_one_among(const brunt_contact_surface *s, const brunt_node_to_facet *f, const search_query *l,
                           int32_t face, candidate_list *out) {
    if (face < 0 || s->face_body[face] != l->touch[0] || !s->motion.made[face] ||
        (l->normal && -dot(s->face_normal[face], l->normal) <= OPPOSED))
        return false;
    nearest one;
    const brunt_closest *at = take_one(&one, face, l->touch[0], brunt_closest_on_face(s, face, l->x));
    beside_one b = {.two = {.face = face, .first = at->square, .height = dot(at->normal, at->d)}};
    if (!brunt_beside_begin(s, f, l->x, l->beside, &b)) return false;
    const double square = b.least < 0 ? INFINITY : brunt_closest_on_face_within(s, l->beside[b.least], l->x, 0).square;
    if (!brunt_beside_settle(s, l->x, l->beside, square, &b)) return false;
    brunt_beside_end(s, f, &b, brunt_nearest_opposed(s, &one, l->normal, &out->candidate[0]), out);
    return true;
}

// What is found among the facets that were listed, where no others can have come so near as to change it: then it is
// what the cells would give, to the last bit.
bool brunt_candidates_among(const brunt_contact_context *m, const brunt_node_to_facet *f, search_query *l, int32_t n,
                            candidate_list *out) {
    const brunt_contact_surface *s = m->surface;
    const double beyond = f->cache.node[n].beyond;
    if (!(beyond > 0) || l->touches != 1 || s->face_body[f->cache.beside[n][0]] != l->touch[0]) return false;
    l->beside = f->cache.beside[n], l->besides = 0;
    while (l->besides < BRUNT_BESIDE && l->beside[l->besides] >= 0) l->besides++;
    if (!find_one_among(s, f, l, f->cache.nearest[n], out)) brunt_candidates_find(m, f, l, f->cache.nearest[n], out);
    l->beside = NULL;
    return out->reach < beyond;
}

// The facet that was the nearest, when it is certain that it still is: it is nearer than `least`, which no other one
// is.
bool brunt_candidates_still_nearest(const brunt_contact_context *m, const brunt_node_to_facet *f, int32_t n,
                                    const double *normal, double least, candidate_list *out) {
    const brunt_contact_surface *s = m->surface;
    const int32_t face = f->cache.nearest[n];
    if (face < 0 || !s->motion.made[face] || (normal && -dot(s->face_normal[face], normal) <= OPPOSED)) return false;
    nearest one;
    const brunt_closest *at = take_one(&one, face, s->face_body[face], closest_on(s, face, s->x[n]));
    if (is_membrane(s, one.body) && !(dot(at->normal, at->d) > 0)) return false;
    const double square = at->square, close = CLOSE * s->mean_edge;
    if (square >= least * least || square > close * close || square > f->bodies.range * f->bodies.range) return false;
    out->count = brunt_nearest_opposed(s, &one, normal, &out->candidate[0]) ? 1 : 0;
    if (s->membrane.side) thicken(s, s->membrane.side[s->body[n]].half, out);
    return true;
}
