// What a place meets of each body near it: the facets in its cell, the nearest of them, and those beside that bear,
// too.
#include "base/quad.h"
#include "contact/search/candidates_parts.h"

enum { AHEAD = 6 };                   // facets that are fetched meanwhile
static const double ASKEW = -0.3;     // ... or, where nothing opposed is within ...
static const double SAME_SLOPE = 0.7; // cosine of normals from which on two facets of a membrane are one slope
static const double NEARLY = 2e-6;    // ... beyond that share of their squares
static const double BEHIND = 0.05; // mean edges: how far behind a facet of a eroded surface a place is still before it
static const double VALLEY = 0.05; // mean edges: how far before one slope the middle of the other is, in a valley

int32_t brunt_candidates_front(const brunt_contact_surface *s, int32_t face) {
    const int32_t node = s->face[face][0];
    const bool front = !s->membrane.front || s->membrane.front[node] == node;
    return front ? face : face - s->membrane.side[s->face_body[face]].faces;
}

int64_t brunt_candidates_cell(const brunt_node_to_facet *f, const double x[3]) {
    int64_t cell = 0;
    for (int a = 0; a < 3; a++) {
        double c = floor((x[a] - f->cells.shift[a] - f->cells.origin[a]) / f->cells.cell);
        if (!(c >= 0) || c >= f->cells.n[a]) return BRUNT_NONE;
        cell = cell * f->cells.n[a] + (int64_t)c;
    }
    return cell;
}

static bool within(const body_box *box, const double x[3], double by) {
    for (int a = 0; a < 3; a++)
        if (x[a] < box->low[a] - by || x[a] > box->high[a] + by) return false;
    return true;
}

bool brunt_candidates_bodies(const brunt_node_to_facet *f, search_query *l) {
    l->touches = l->enters = 0;
    const int32_t end = f->bodies.box[l->box].looks_end;
    for (int32_t q = f->bodies.first[l->box]; q < end && l->touches < BRUNT_MAX_NEAR; q++) {
        const body_box *other = &f->bodies.box[f->bodies.list[q]];
        if (other->fem < 0 || !within(other, l->x, f->bodies.range)) continue;
        l->touch[l->touches++] = other->body;
        if (!other->membrane && within(other, l->x, 0)) l->enter[l->enters++] = other->body;
    }
    return l->touches > 0;
}

static bool is_among(int32_t body, const int32_t *list, int32_t count) {
    for (int32_t k = 0; k < count; k++)
        if (list[k] == body) return true;
    return false;
}

// Notes a facet. Of those that are equally near, as at an edge or a corner, the one that most faces the place tells on
// which side of the surface that is, whatever their order.
static void add_nearest(two_nearest *two, const brunt_closest *at, int32_t face) {
    const double height = dot(at->normal, at->d), same = two->face < 0 ? 0 : 1e-9 * two->first;
    if (at->square >= two->first + same) {
        two->second = fmin(two->second, at->square);
        return;
    }
    const bool nearer = at->square < two->first - same;
    two->second = two->first > at->square ? two->first : at->square;
    two->first = two->first < at->square ? two->first : at->square;
    if (nearer || fabs(height) > fabs(two->height)) two->face = face, two->height = height, two->square = at->square;
}

static bool in_patch(const search_query *l, int32_t face) {
    int32_t low = 0, high = l->patch_count;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (l->patch[middle] < face)
            low = middle + 1;
        else
            high = middle;
    }
    return low < l->patch_count && l->patch[low] == face;
}

// What is looked for in a cell.
typedef struct facet_search {
    const double *normal; // that facets are to face by more than `least`; NULL: any
    double least;
    const int32_t *list;  // bodies, so many
    int32_t count, guess; // a face that may well be the nearest, -1; it saves looking closely at most others
    double margin;
    two_nearest *all; // notes the two nearest of any direction, as far as `margin` beyond the nearest; may be NULL
} facet_search;

static inline bool beyond(const brunt_contact_surface *s, const double box[6], const double x[3], double square) {
    return further(s, box_square(box, x), square);
}

// Squares of the ways along the axes from x, of which the last number is none, to the box of a facet.
static inline quad ways_to(const double box[6], quad x) {
    const quad low = quad_load(box), last = quad_load(box + 2), high = __builtin_shufflevector(last, last, 1, 2, 3, 3),
               way = quad_max(quad_max(low - x, x - high), (quad){0});
    return way * way;
}

// Whether a cell has so few facets that their distances may be bounded first, and the nearest is of the body that is
// near.
static bool bound_distances(const brunt_contact_surface *s, const brunt_node_to_facet *f, const search_query *l,
                            facet_bounds *out) {
    const int32_t *face = f->cells.face + f->cells.first[l->cell];
    const int32_t count = f->cells.first[l->cell + 1] - f->cells.first[l->cell], last = count - 1;
    if (l->touches != 1 || count == 0 || count > BRUNT_BOUNDED) return false;
    const quad x = {l->x[0], l->x[1], l->x[2], NAN};
    const double(*const box)[6] = (const double(*)[6])s->face_box;
    quad least = quad_set(INFINITY);
    quad_mask which = {0}, number = {0, 1, 2, 3};
    for (int32_t q = 0; q < count; q += 4) {
        const int32_t *four = face + q;
        int32_t rest[4]; // beyond the last there is the last
        for (int i = 0; i < 4 && q + 4 > count; i++) rest[i] = face[q + i < last ? q + i : last];
        if (q + 4 > count) four = rest;
        const quad square = quad_sums(ways_to(box[four[0]], x), ways_to(box[four[1]], x), ways_to(box[four[2]], x),
                                      ways_to(box[four[3]], x));
        const quad_mask less = square < least;
        which = (number & less) | (which & ~less);
        least = quad_select(less, square, least);
        quad_store(&out->square[q], square);
        number += 4;
    }
    int at = 0;
    for (int i = 1; i < 4; i++) at = least[i] < least[at] ? i : at;
    out->least = which[at] < last ? (int32_t)which[at] : last;
    return s->face_body[face[out->least]] == l->touch[0];
}

// As find_nearest, of a particle that has one body near it: which facets may be as near as the nearest, and no others,
// are looked at in the order of the cell, so that what is found is the same to the bit.
static inline __attribute__((always_inline)) int find_nearest_of_one(const brunt_contact_surface *s,
                                                                     const brunt_node_to_facet *f,
                                                                     const search_query *l, bool membranes,
                                                                     two_nearest *all, nearest *best) {
    const int32_t *list = f->cells.face + f->cells.first[l->cell], other = l->touch[0];
    const int32_t count = f->cells.first[l->cell + 1] - f->cells.first[l->cell], least = l->bounds->least;
    const double range = f->bodies.range, range2 = range * range, clear = CLEAR * s->mean_edge;
    const bool membrane = membranes && s->membrane.side[other].faces;
    const brunt_closest first = brunt_closest_on_face(s, list[least], l->x);
    const double reach = tie(s, first.square), root = reach < range ? reach : range, far2 = root * root * (1 + NEARLY);
    const quad within = quad_set(far2 > clear * clear ? far2 : clear * clear);
    *all = (two_nearest){-1, range2, range2, 0, range2};
    best->body = other, best->count = 0, best->square = range2, best->root = range;
    for (int32_t four = 0; four < count; four += 4)
        for (unsigned near = quad_bits(quad_load(&l->bounds->square[four]) <= within); near; near &= near - 1) {
            const int32_t q = four + __builtin_ctz(near);
            int32_t face = q < count ? list[q] : list[least];
            if (q >= count || s->face_body[face] != other) continue;
            brunt_closest at = q == least ? first : brunt_closest_on_face(s, face, l->x);
            if (at.square > range2) continue;
            const bool behind = membrane && dot(at.normal, at.d) < 0;
            add_nearest(all, &at, behind ? face + s->membrane.side[other].faces : face);
            if (behind) turn_over(s, &face, &at);
            if (!membrane || on_side(l, &at)) keep(s, best, &at, face);
        }
    return best->count > 0;
}

// The nearest facets among those listed of each body that is looked for. How many bodies. `membranes`: whether there
// are any; the cells have their fronts, for both sides.
static inline __attribute__((always_inline)) int find_nearest(const brunt_contact_surface *s,
                                                              const brunt_node_to_facet *f, const search_query *l,
                                                              const facet_search what, bool membranes,
                                                              nearest best[BRUNT_MAX_CANDIDATES]) {
    const double *const normal = what.normal;
    const double least = what.least, margin = what.margin;
    const int32_t guess = what.guess;
    two_nearest *const all = what.all;
    const double range2 = f->bodies.range * f->bodies.range;
    double bound = INFINITY; // of the one body that the guess belongs to
    brunt_closest guessed;
    if (guess >= 0) guessed = brunt_closest_on_face(s, guess, l->x), bound = tie(s, guessed.square);
    int bodies = 0;
    if (all) *all = (two_nearest){-1, range2, range2, 0, range2};
    int32_t count;
    const int32_t *list = facets_of(f, l, &count);
    for (int32_t q = 0; q < count; q++) {
        int32_t face = list[q];
        if (q + AHEAD < count) // the list is of facets that are anywhere
            __builtin_prefetch(&s->face_body[list[q + AHEAD]]), __builtin_prefetch(s->face_box[list[q + AHEAD]]);
        const int32_t other = s->face_body[face];
        if (other == l->body && !(membranes && l->patch_count)) continue;
        const bool membrane = membranes && s->membrane.side[other].faces;
        int b = 0;
        while (b < bodies && best[b].body != other) b++;
        double extent = b < bodies ? best[b].root : f->bodies.range, known = extent;
        if (guess >= 0 && bound < extent && s->face_body[guess] == other) extent = bound;
        if (l->particle) known = extent;
        if (!near_box(s->face_box[face], l->x, extent + margin)) continue;
        const double cosine = normal ? -dot(s->face_normal[face], normal) : 1;
        bool faces = !normal || cosine > least || (membrane && -cosine > least);
        if ((!faces && !all) || !is_among(other, what.list, what.count)) continue;
        if (membranes && other == l->body && in_patch(l, face)) continue;
        // What is further than two of any direction, and than the nearest of its body, changes neither. Of a particle,
        // which all facets face, the nearest of any direction is no further than that of its body.
        if (face != guess && (!all || l->particle || beyond(s, s->face_box[face], l->x, all->second)) &&
            (!faces || (known < f->bodies.range && beyond(s, s->face_box[face], l->x, known * known))))
            continue;
        // What is further than the guess, of its body, is neither the nearest nor as near: its square is enough.
        const double settled = guess >= 0 && other == s->face_body[guess] ? bound * bound : INFINITY;
        brunt_closest at = face == guess ? guessed : brunt_closest_on_face_within(s, face, l->x, settled);
        if (at.square > range2) continue;
        const bool behind = membrane && dot(at.normal, at.d) < 0;
        if (all) add_nearest(all, &at, behind ? face + s->membrane.side[other].faces : face);
        if (!faces || at.square > settled) continue;
        if (membrane) {
            if (normal ? cosine < 0 : behind) turn_over(s, &face, &at);
            if (!on_side(l, &at)) continue;
        }
        if (b == bodies) {
            if (b == BRUNT_MAX_CANDIDATES) continue;
            best[b].body = other, best[b].count = 0, best[b].square = range2, best[b].root = f->bodies.range;
            bodies++;
        }
        keep(s, &best[b], &at, face);
    }
    return bodies;
}

// Whether a body, behind whose facet a node with a normal is, has one that it would rather leave through the other
// way: then it is before that one, or on the far side of a body thinner than the range, or the other side of a
// membrane.
static bool other_way_out(const brunt_contact_context *m, const brunt_node_to_facet *f, const search_query *l,
                          int32_t body, double square) {
    const brunt_contact_surface *s = m->surface;
    for (int32_t q = f->cells.first[l->cell]; q < f->cells.first[l->cell + 1]; q++) {
        const int32_t face = f->cells.face[q];
        if (s->face_body[face] != body || dot(s->face_normal[face], l->normal) <= OPPOSED) continue;
        if (near_box(s->face_box[face], l->x, sqrt(square)) && brunt_closest_on_face(s, face, l->x).square < square)
            return true;
    }
    return false;
}

// Whether facets are all of the slope that is met, as their sides that face the place are: clearly, so that rounding
// does not matter.
static bool all_met(const brunt_contact_surface *s, const int32_t *face, int32_t count, const double x[3],
                    const double n[3]) {
    double least = INFINITY, height = INFINITY;
    for (int32_t q = 0; q < count; q++) {
        const double *normal = s->face_normal[face[q]], *centre = s->face_centre[face[q]];
        const double to[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
        const double towards = dot(normal, to), along = dot(normal, n), cosine = towards < 0 ? -along : along;
        height = fabs(towards) < height ? fabs(towards) : height;
        least = cosine < least ? cosine : least;
    }
    return height > 1e-9 * s->mean_edge && least > SAME_SLOPE + 1e-9;
}

// Facets that a place is right above, so many, the nearest first: of those of one slope one carries, and which of them
// is not to hang on the order in which they are looked at.
enum { MAX_BEARING = 12 };
typedef struct bearing {
    struct bearing_facet {
        brunt_closest at;
        int32_t face;
        double side; // -1: it is turned over
    } of[MAX_BEARING];
    int32_t count;
} bearing;

static void add_bearing(bearing *list, int32_t face, const brunt_closest *at, double side) {
    const bool full = list->count == MAX_BEARING;
    if (full && !(at->square < list->of[MAX_BEARING - 1].at.square)) return;
    int32_t k = full ? MAX_BEARING - 1 : list->count++;
    for (; k > 0 && at->square < list->of[k - 1].at.square; k--) list->of[k] = list->of[k - 1];
    list->of[k] = (struct bearing_facet){*at, face, side};
}

static void add_candidate(const brunt_contact_surface *s, const struct bearing_facet *b, candidate_list *out) {
    facet_candidate *h = &out->candidate[out->count++];
    *h = (facet_candidate){
        .face = b->face, .triangle = b->at.triangle, .body = s->face_body[b->face], .gap = dot(b->at.normal, b->at.d)};
    memcpy(h->n, b->at.normal, sizeof h->n);
}

// Whether what is met of a membrane is another slope than that of a facet, of this side.
static bool is_other_slope(const brunt_contact_surface *s, int32_t face, double side, const candidate_list *out) {
    bool met = false, same = false;
    for (int32_t k = 0; k < out->count; k++) {
        if (out->candidate[k].body != s->face_body[face]) continue;
        met = true;
        same = same || side * dot(out->candidate[k].n, s->face_normal[face]) > SAME_SLOPE;
    }
    return met && !same;
}

// Notes a facet of a membrane, when the place is right above it and what is met is another slope.
static void note_slope(const brunt_contact_surface *s, double range, const search_query *l, int32_t face,
                       const candidate_list *out, bearing *list) {
    const int32_t body = s->face_body[face];
    if (!is_membrane(s, body) || !near_box(s->face_box[face], l->x, range)) return;
    const double *normal = s->face_normal[face], *centre = s->face_centre[face];
    double towards = 0;
    for (int a = 0; a < 3; a++) towards += normal[a] * (l->normal ? -l->normal[a] : l->x[a] - centre[a]);
    if (l->normal && fabs(towards) <= OPPOSED) return;
    const double side = towards < 0 ? -1 : 1;
    if (!is_other_slope(s, face, side, out) || (body == l->body && in_patch(l, face))) return;
    brunt_closest at = brunt_closest_on_face(s, face, l->x);
    if (towards < 0) turn_over(s, &face, &at);
    if (at.inside && !(at.square > range * range) && on_side(l, &at)) add_bearing(list, face, &at, side);
}

// Facets of membranes that the place is right above, beside the nearest one and on another slope: in a valley all of
// them bear. Else what moves along one wall of a corner would be let through the other in the steps in which that is
// the further one.
static void add_slopes(const brunt_contact_surface *s, const brunt_node_to_facet *f, const search_query *l,
                       candidate_list *out) {
    const int32_t begin = f->cells.first[l->cell], end = f->cells.first[l->cell + 1];
    bool any = false;
    for (int32_t k = 0; k < out->count; k++) any = any || is_membrane(s, out->candidate[k].body);
    if (!any || (l->bounds && all_met(s, f->cells.face + begin, end - begin, l->x, out->candidate[0].n))) return;
    bearing list;
    list.count = 0;
    for (int32_t q = begin; q < end; q++) note_slope(s, f->bodies.range, l, f->cells.face[q], out, &list);
    for (int32_t k = 0; k < list.count && out->count < BRUNT_MAX_CANDIDATES; k++) {
        const struct bearing_facet *b = &list.of[k];
        if (k == 0 || is_other_slope(s, brunt_candidates_front(s, b->face), b->side, out)) add_candidate(s, b, out);
    }
}

static bool is_eroded(const brunt_contact_surface *s, int32_t body) {
    return s->renewal.eroded && s->renewal.eroded[body];
}

// Whether a facet is of a slope that is met, or beyond it.
static bool is_borne(const brunt_contact_surface *s, const search_query *l, int32_t face, const candidate_list *out) {
    const double *centre = s->face_centre[face];
    const double to[3] = {centre[0] - l->x[0], centre[1] - l->x[1], centre[2] - l->x[2]};
    bool known = false;
    for (int32_t k = 0; k < out->count; k++) {
        const facet_candidate *h = &out->candidate[k];
        known = known || (h->body == s->face_body[face] && (dot(h->n, s->face_normal[face]) > SAME_SLOPE ||
                                                            dot(h->n, to) + h->gap < VALLEY * s->mean_edge));
    }
    return known;
}

// Where elements have left, surfaces have steps, pits and spikes of the size of an element, and edges cut into edges: a
// node has its own body on the very side of a facet that it comes through, so that its normal tells nothing of it. All
// facets that the place is right before bear, whichever way they look, but for those beyond a ridge: what slides in
// under a block, a little too high, meets its underside and not the wall it came past.
static void add_eroded(const brunt_contact_context *m, const brunt_node_to_facet *f, const search_query *l,
                       candidate_list *out) {
    const brunt_contact_surface *s = m->surface;
    bearing list;
    list.count = 0;
    for (int32_t q = f->cells.first[l->cell]; q < f->cells.first[l->cell + 1]; q++) {
        const int32_t face = f->cells.face[q], body = s->face_body[face];
        if (body == l->body || is_membrane(s, body) || !(is_eroded(s, body) || is_eroded(s, l->body))) continue;
        if (!near_box(s->face_box[face], l->x, fmin(f->bodies.range, f->bodies.travel))) continue;
        if (!is_among(body, l->touch, l->touches) || is_borne(s, l, face, out)) continue;
        const brunt_closest at = brunt_closest_on_face(s, face, l->x);
        if (at.inside && !(dot(at.normal, at.d) < -BEHIND * s->mean_edge)) add_bearing(&list, face, &at, 1);
    }
    for (int32_t k = 0; k < list.count && out->count < BRUNT_MAX_CANDIDATES; k++)
        if (k == 0 || !is_borne(s, l, list.of[k].face, out)) add_candidate(s, &list.of[k], out);
}

// Whether a place is clearly before the nearest facet of a body that is not the nearest of all. A membrane has no
// inside.
static bool is_outside(const brunt_contact_surface *s, const brunt_node_to_facet *f, const search_query *l,
                       int32_t body) {
    int32_t count;
    const int32_t *list = facets_of(f, l, &count);
    const double range = f->bodies.range * (1 + 1e-6), range2 = range * range; // something of it is within the range
    two_nearest two = {-1, range2, range2, 0, range2};
    if (is_membrane(s, body)) return false;
    for (int32_t q = 0; q < count; q++) {
        const int32_t face = list[q];
        if (s->face_body[face] != body || !near_box(s->face_box[face], l->x, sqrt(two.first) + TOUCH * s->mean_edge))
            continue;
        const brunt_closest at = brunt_closest_on_face(s, face, l->x);
        add_nearest(&two, &at, face);
    }
    return two.face >= 0 && is_before(s, &two);
}

// The bodies whose boxes it is in, and of which no facet that faces it is within the root of `square`. How many.
static inline int32_t list_unresolved(const search_query *l, const nearest *opposed, int bodies, double square,
                                      int32_t *entered) {
    int32_t unresolved = 0;
    for (int32_t k = 0; l->normal && k < l->enters; k++) {
        bool resolved = false;
        for (int b = 0; b < bodies; b++)
            resolved = resolved || (opposed[b].body == l->enter[k] && opposed[b].count && opposed[b].square <= square);
        if (!resolved) entered[unresolved++] = l->enter[k];
    }
    return unresolved;
}

// How far the nearest facet is of all, 0 where the place may not be `before` it, and, where it is the one that is met
// (`plain`: it may be), how far all others are.
static inline void tell_distances(const brunt_contact_surface *s, const brunt_node_to_facet *f, const two_nearest *two,
                                  bool before, bool plain, candidate_list *out) {
    out->distance = before || two->face < 0 ? fmin(f->bodies.range, sqrt(two->first)) : 0;
    out->second = 0;
    if (plain && out->count == 1 && two->face == out->candidate[0].face && !s->renewal.eroded)
        out->second = second_of(s, f, two, out->distance + MARGIN * s->mean_edge);
}

// What a query meets of each other body. Facets that face the slave come first: a node that slides in under a block
// meets its underside, not the wall it came through. Only a slave that has none of those close by, and is inside, is
// sent out through the nearest facet there is.
static inline __attribute__((always_inline)) void find_candidates(const brunt_contact_context *m,
                                                                  const brunt_node_to_facet *f, const search_query *l,
                                                                  int32_t guess, bool membranes, candidate_list *out) {
    const brunt_contact_surface *s = m->surface;
    nearest opposed[BRUNT_MAX_CANDIDATES], any[BRUNT_MAX_CANDIDATES];
    two_nearest two;
    const double close = CLOSE * s->mean_edge, margin = l->particle ? 0 : MARGIN * s->mean_edge;
    out->count = 0;
    if (guess >= 0 && (!is_among(s->face_body[guess], l->touch, l->touches) || !s->motion.made[guess] ||
                       (l->normal && -dot(s->face_normal[guess], l->normal) <= OPPOSED)))
        guess = -1;
    if (membranes && guess >= 0 && !l->particle && is_membrane(s, s->face_body[guess]))
        guess = -1; // it may be on the other side now
    const facet_search opposed_to_it = {l->normal, OPPOSED, l->touch, l->touches, guess, margin, &two};
    const int bodies = l->bounds ? find_nearest_of_one(s, f, l, membranes, &two, opposed)
                                 : find_nearest(s, f, l, opposed_to_it, membranes, opposed);
    int32_t entered[BRUNT_MAX_NEAR];
    const int32_t unresolved = list_unresolved(l, opposed, bodies, close * close, entered);
    int all = unresolved
                  ? find_nearest(s, f, l, (facet_search){.list = entered, .count = unresolved, .guess = -1}, false, any)
                  : 0;
    for (int b = 0; b < all; b++) {
        const double least = is_eroded(s, l->body) || is_eroded(s, any[b].body) ? -INFINITY : ASKEW;
        if (!any[b].count || !brunt_nearest_behind(s, &any[b], l->normal, least, &out->candidate[out->count])) continue;
        out->count++;
        for (int k = 0; k < bodies; k++)
            if (opposed[k].body == any[b].body) opposed[k].count = 0;
    }
    // What is before the nearest facet of all is outside, even if the nearest facet that faces it is seen from
    // behind. A membrane has no inside: it tells nothing of the others.
    const bool by_membrane = membranes && two.face >= 0 && is_membrane(s, s->face_body[two.face]);
    const bool outside = two.face >= 0 && !by_membrane && is_before(s, &two);
    const bool plain = out->count == 0 && l->enters <= 1;
    bool inside = out->count > 0;
    for (int b = 0; b < bodies && out->count < BRUNT_MAX_CANDIDATES; b++) {
        facet_candidate *h = &out->candidate[out->count];
        if (!opposed[b].count || !brunt_nearest_opposed(s, &opposed[b], l->normal, h)) continue;
        if (h->gap < 0 && two.face >= 0 && (h->body == s->face_body[two.face] ? outside : is_outside(s, f, l, h->body)))
            continue;
        if (membranes && h->gap < 0 && l->normal && (by_membrane || l->membrane) && !is_membrane(s, h->body) &&
            other_way_out(m, f, l, h->body, opposed[b].square))
            continue;
        inside = inside || h->gap < 0;
        out->count++;
        if (!is_eroded(s, h->body)) brunt_nearest_valley(s, &opposed[b], l->normal, out);
    }
    if (membranes) add_slopes(s, f, l, out);
    if (s->renewal.eroded) add_eroded(m, f, l, out);
    // Nothing further away than this changed what was found.
    out->reach = fmax(sqrt(two.first) + margin, bodies == 1 && opposed[0].count ? opposed[0].root : f->bodies.range);
    if (!l->particle) tell_distances(s, f, &two, outside || (by_membrane && !inside), plain, out);
    if (membranes) thicken(s, l->half, out);
}

void brunt_candidates_find_of_particle(const brunt_contact_context *m, const brunt_node_to_facet *f, search_query *l,
                                       candidate_list *out) {
    facet_bounds bounds;
    l->bounds = bound_distances(m->surface, f, l, &bounds) ? &bounds : NULL;
    brunt_candidates_find(m, f, l, -1, out);
    l->bounds = NULL;
}

void brunt_candidates_find(const brunt_contact_context *m, const brunt_node_to_facet *f, const search_query *l,
                           int32_t guess, candidate_list *out) {
    if (m->surface->membrane.side)
        find_candidates(m, f, l, guess, true, out);
    else
        find_candidates(m, f, l, guess, false, out);
}
