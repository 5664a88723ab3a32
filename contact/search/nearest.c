// Facets by cell, and the nearest ones of a place.
#include "contact/search/node_to_facet_parts.h"

#include "contact/distance/point_facet.h"

enum { MAX_TIED = 16 };
static const double MARGIN = 0.125;   // mean edges: how far facets may move before the cells are made anew
static const double CELL = 0.5;       // mean edges: of the cells that facets are found in ...
static const double COARSE = 0.25;    // ... of how far they are looked for, where all is fast
static const double OPPOSED = 0.1;    // least cosine between a slave's outward normal and the one into the master
static const double ASKEW = -0.3;     // ... or, where nothing opposed is within ...
static const double CLOSE = 0.25;     // ... so many mean edges, the least one with the normal of a facet
static const double SAME_SLOPE = 0.7; // cosine of normals from which on two facets of a sheet are one slope
static const double SLACK = 0.125;    // mean edges: facets so much further than the nearest are looked at closely, too
static const double BEHIND = 0.05; // mean edges: how far behind a facet of a ragged surface someone is still before it
static const double STRAIGHT = 0.01; // [rad] within it of their mean normal, ways to edges and corners are along it
static const double TOUCH = 1e-6;    // mean edges: facets that are nearer by less than this are equally near
static const double VALLEY = 0.05;   // mean edges: how far before one slope the middle of the other is, in a valley

// ------------------------------------------------------------------------------------------ cells of facets

bool brunt_node_to_facet_in_reach(const brunt_node_to_facet *f, int32_t box, const double low[3], const double high[3],
                                  double by) {
    for (int32_t q = f->near_first[box]; q < f->near_first[box + 1]; q++) {
        const bounds *other = &f->box[f->near_list[q]];
        bool apart = false;
        for (int a = 0; a < 3; a++) apart = apart || low[a] - by > other->high[a] || other->low[a] - by > high[a];
        if (!apart) return true;
    }
    return false;
}

static void face_bounds(const brunt_contact_surface *s, int32_t face, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (int c = 0; c < 4 && s->face[face][c] >= 0; c++)
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], s->x[s->face[face][c]][a]);
            high[a] = fmax(high[a], s->x[s->face[face][c]][a]);
        }
}

static void cell_range(const brunt_node_to_facet *f, const double low[3], const double high[3], double by,
                       int32_t from[3], int32_t to[3]) {
    for (int a = 0; a < 3; a++) {
        double l = floor((low[a] - by - f->origin[a]) / f->cell), h = floor((high[a] + by - f->origin[a]) / f->cell);
        from[a] = (int32_t)fmax(0, fmin(l, f->n[a] - 1.0));
        to[a] = (int32_t)fmax(0, fmin(h, f->n[a] - 1.0));
    }
}

// Counts, or lists, the facets of every cell.
static void visit_cells(const brunt_contact_context *m, brunt_node_to_facet *f, bool list) {
    const brunt_contact_surface *s = m->skin;
    const double by = f->made_range + MARGIN * s->mean_edge;
    for (int k = 0; k < s->fem_count; k++) {
        if (f->near_first[f->box_of[k] + 1] == f->near_first[f->box_of[k]]) continue;
        for (int32_t face = s->face_range[k]; face < s->face_end[k]; face++) { // of a sheet, for both its sides
            double low[3], high[3];
            int32_t from[3], to[3];
            face_bounds(s, face, low, high);
            if (!brunt_node_to_facet_in_reach(f, f->box_of[k], low, high, 2 * by)) continue;
            cell_range(f, low, high, by, from, to);
            for (int32_t x = from[0]; x <= to[0]; x++)
                for (int32_t y = from[1]; y <= to[1]; y++)
                    for (int32_t z = from[2]; z <= to[2]; z++) {
                        size_t cell = ((size_t)x * (size_t)f->n[1] + (size_t)y) * (size_t)f->n[2] + (size_t)z;
                        if (list)
                            f->cell_face[f->cell_first[cell + 1]++] = face;
                        else
                            f->cell_first[cell + 2]++;
                    }
        }
    }
}

// The room that pairs share, cut into cells; few enough that making them costs no more than the facets do.
static void lay_cells(const brunt_contact_context *m, brunt_node_to_facet *f) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t p = 0; p < f->near_count; p++) {
        const bounds *a = &f->box[f->near[p].a], *b = &f->box[f->near[p].b];
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], fmax(a->low[k], b->low[k]) - 3 * f->made_range);
            high[k] = fmax(high[k], fmin(a->high[k], b->high[k]) + 3 * f->made_range);
        }
    }
    const double most = 32.0 * m->skin->face_count + 4096;
    f->cell = fmax(CELL * m->skin->mean_edge, COARSE * f->made_range);
    for (;; f->cell *= 1.25) {
        double cells = 1;
        for (int k = 0; k < 3; k++) cells *= floor((high[k] - low[k]) / f->cell) + 1;
        if (cells <= most) break;
    }
    for (int k = 0; k < 3; k++) {
        f->origin[k] = low[k];
        f->n[k] = (int32_t)(floor((high[k] - low[k]) / f->cell) + 1);
    }
}

// Where a body's box is kept: bodies with facets, then bodies of material points.
static int32_t box_number(const brunt_contact_surface *s, const bounds *box) {
    return box->fem >= 0 ? box->fem : s->fem_count + box->mpm;
}

static int make_cells(const brunt_contact_context *m, brunt_node_to_facet *f) {
    const brunt_contact_surface *s = m->skin;
    f->made_range = 1.25 * f->range;
    lay_cells(m, f);
    size_t cells = (size_t)f->n[0] * (size_t)f->n[1] * (size_t)f->n[2];
    if (RESERVE(f, cell_first, cells + 3) || RESERVE(f, made_x, s->node_count + 1) ||
        RESERVE(f, made_box, f->box_count + 1))
        return -1;
    memset(f->cell_first, 0, (cells + 3) * sizeof *f->cell_first);
    visit_cells(m, f, false);
    for (size_t c = 2; c <= cells + 1; c++) f->cell_first[c] += f->cell_first[c - 1];
    if (RESERVE(f, cell_face, f->cell_first[cells + 1] + 1)) return -1;
    visit_cells(m, f, true);
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k]) continue;
        memcpy(f->made_x + s->node_range[k], s->x + s->node_range[k],
               (size_t)(s->node_range[k + 1] - s->node_range[k]) * sizeof *s->x);
    }
    for (int32_t b = 0; b < f->box_count; b++) f->made_box[box_number(s, &f->box[b])] = f->box[b];
    f->made = true;
    return 0;
}

// Whether all that look in are where the cells were made for: what they share then is within the room (three ranges, of
// which looking takes one), and the facets in their range are listed (two ranges from where they were).
static bool boxes_hold(const brunt_contact_context *m, const brunt_node_to_facet *f) {
    for (int32_t b = 0; b < f->box_count; b++) {
        const bounds *now = &f->box[b], *then = &f->made_box[box_number(m->skin, now)];
        if (f->near_first[b + 1] == f->near_first[b]) continue;
        for (int a = 0; a < 3; a++)
            if (now->low[a] < then->low[a] - f->made_range || now->high[a] > then->high[a] + f->made_range)
                return false;
    }
    return true;
}

// Whether the cells still hold all that may be near: nothing has moved further than they allow, and the same bodies are
// near.
static bool cells_hold(const brunt_contact_context *m, const brunt_node_to_facet *f, uint64_t pairs) {
    const brunt_contact_surface *s = m->skin;
    if (!f->made || f->made_near != f->near_count || f->made_pairs != pairs || f->range > f->made_range) return false;
    const double most = MARGIN * s->mean_edge, square = most * most;
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k]) continue;
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            double d2 = 0;
            for (int a = 0; a < 3; a++) d2 += (s->x[n][a] - f->made_x[n][a]) * (s->x[n][a] - f->made_x[n][a]);
            if (d2 > square) return false;
        }
    }
    return boxes_hold(m, f);
}

// A number that differs when other bodies are near or active.
static uint64_t pairs_key(const brunt_contact_context *m, const brunt_node_to_facet *f) {
    uint64_t key = 1469598103934665603ull;
    for (int32_t p = 0; p < f->near_count; p++) {
        uint64_t a = (uint64_t)f->box[f->near[p].a].body, b = (uint64_t)f->box[f->near[p].b].body;
        uint64_t low = a < b ? a : b, high = a < b ? b : a;
        key += (low * 1000003u + high + 1) * 0x9E3779B97F4A7C15ull;
    }
    for (int k = 0; k < m->skin->fem_count; k++) key += m->skin->active[k] ? (uint64_t)(k + 1) * 1099511628211ull : 0;
    return key;
}

// ------------------------------------------------------------------------------------------ the nearest facet

typedef struct tied {
    brunt_closest at;
    int32_t face;
} tied;

static bool is_sheet(const brunt_contact_surface *s, int32_t body) { return s->side && s->side[body].faces > 0; }

// The nearest point of the front of a sheet as one of its back: nodes there are in reversed order.
static void turn_over(const brunt_contact_surface *s, int32_t *face, brunt_closest *at) {
    if (s->face[*face][3] >= 0) {
        at->triangle = (6 - at->triangle) % 4;
        at->triangles = (at->triangles & 10) | (at->triangles & 1) << 2 | (at->triangles & 4) >> 2;
    }
    *face += s->side[s->face_body[*face]].faces;
    for (int a = 0; a < 3; a++) at->normal[a] = -at->normal[a];
}

// Of either side of a sheet: the same numbers for both.
static brunt_closest closest_on(const brunt_contact_surface *s, int32_t face, const double x[3]) {
    const int32_t node = s->face[face][0];
    if (!s->front || s->front[node] == node) return brunt_closest_on_face(s, face, x);
    int32_t front = face - s->side[s->face_body[face]].faces;
    brunt_closest at = brunt_closest_on_face(s, front, x);
    turn_over(s, &front, &at);
    return at;
}

// Whether someone is on the side of a sheet that facet is of, and not beyond its edge when a little behind it. There is
// no inside that it could have entered: who is further behind belongs to the other side, or to the far side of a body
// that is on this one.
static bool on_side(const looker *l, const brunt_closest *at) {
    const double height = dot(at->normal, at->d);
    if (height > 0) return true;
    if (!l->normal) return height == 0;
    return height > -l->shallow && height * height >= 0.5 * at->square;
}

// Keeps `found` among the nearest of its body; nearest points that are equally near belong to facets that share an edge
// or a corner there, and the one that most faces the place decides on which side of the surface it is.
typedef struct nearest {
    int32_t body, count;
    double square, root; // of the distance; what is no further than its root is as near
    tied tied[MAX_TIED];
} nearest;

// What counts as near as the nearest, whose distance has this square.
static double tie(const brunt_contact_surface *s, double square) {
    return sqrt(square) * (1 + 1e-8) + TOUCH * s->mean_edge;
}

static void keep(const brunt_contact_surface *s, nearest *best, const brunt_closest *at, int32_t face) {
    if (at->square > best->root * best->root) return;
    if (at->square < best->square) {
        const double root = tie(s, at->square);
        if (best->square > root * root) best->count = 0;
        best->square = at->square, best->root = root;
    }
    if (best->count < MAX_TIED) best->tied[best->count++] = (tied){*at, face};
}

static const tied *most_facing(const nearest *best) {
    const tied *chosen = NULL;
    double most = -1;
    for (int32_t k = 0; k < best->count; k++) {
        if (best->tied[k].at.square > best->root * best->root) continue;
        double facing = best->tied[k].at.inside ? INFINITY : fabs(dot(best->tied[k].at.normal, best->tied[k].at.d));
        if (facing > most || (facing == most && best->tied[k].face < chosen->face))
            most = facing, chosen = &best->tied[k];
    }
    return chosen;
}

// Whether two facets that tie are of one slope, or of a ridge; of a valley each bears for itself.
static bool bear_together(const brunt_contact_surface *s, const tied *a, const tied *b) {
    if (dot(a->at.normal, b->at.normal) > SAME_SLOPE) return true;
    double to[3];
    for (int k = 0; k < 3; k++) to[k] = s->face_centre[b->face][k] - s->face_centre[a->face][k];
    return dot(a->at.normal, to) < 0 && dot(b->at.normal, to) > 0;
}

// The edge or corner that the chosen facet has in common with those that tie with it, their mean normal and the mean
// height above them; `way`: the sum of their ways to the slave.
static void find_feature(const brunt_contact_surface *s, const nearest *best, const tied *chosen, hit *out,
                         double way[3]) {
    int32_t face[MAX_TIED];
    int count = 1;
    double height = out->gap;
    brunt_shared shared = {.count = 0};
    brunt_feature_share(s, face[0] = chosen->face, &shared);
    for (int32_t k = 0; k < best->count; k++) {
        const tied *other = &best->tied[k];
        if (other == chosen || other->at.square > best->root * best->root) continue;
        if (!bear_together(s, chosen, other)) {
            out->valley = true;
            continue;
        }
        if (!brunt_feature_share(s, other->face, &shared)) continue;
        face[count++] = other->face;
        height += dot(other->at.normal, other->at.d);
        for (int a = 0; a < 3; a++) way[a] += other->at.d[a];
    }
    if (count == 1) return;
    out->gap = height / count;
    out->feature = (brunt_feature){true, {shared.node[0], shared.node[shared.count > 1]}, 0, 0};
    if (brunt_feature_normal(s, &out->feature, face, count, out->n)) return;
    out->feature.any = false;
    memcpy(out->n, chosen->at.normal, sizeof out->n);
}

static const tied *take_nearest(const brunt_contact_surface *s, const nearest *best, hit *out, double way[3]) {
    const tied *chosen = most_facing(best);
    const brunt_closest *at = &chosen->at;
    *out = (hit){.face = chosen->face, .triangle = at->triangle, .body = best->body, .gap = dot(at->normal, at->d)};
    memcpy(out->n, at->normal, sizeof out->n);
    memcpy(way, at->d, sizeof at->d);
    if (is_sheet(s, best->body)) return chosen; // faces of a crumpled sheet have no turn in common at a node
    if (at->triangles) out->feature = (brunt_feature){true, {-1, -1}, chosen->face, at->triangles};
    if (best->count > 1) find_feature(s, best, chosen, out, way);
    return chosen;
}

// Whether the nearest point is so far from straight below, as n says, that the way to it tells a direction of its own.
// Over small gaps that way is made of the places' rounding, which the push along it would enlarge from step to step.
static bool aside(const double n[3], const double d[3]) {
    const double height = dot(n, d);
    double square = 0;
    for (int a = 0; a < 3; a++) square += (d[a] - height * n[a]) * (d[a] - height * n[a]);
    return square > STRAIGHT * STRAIGHT * dot(d, d);
}

// A hit on facets that face the slave; beside an edge or a corner it must also face the way to them.
static bool hit_facing(const brunt_contact_surface *s, const nearest *best, const double *normal, hit *out) {
    double way[3];
    const brunt_closest *at = &take_nearest(s, best, out, way)->at;
    const double distance = sqrt(best->square), length = sqrt(dot(way, way));
    const bool tilted = !out->feature.any || aside(out->n, way);
    if ((out->feature.any || !at->inside) && out->gap >= 0 && distance > TOUCH * s->mean_edge) {
        out->gap = distance;
        for (int a = 0; a < 3 && tilted; a++) out->n[a] = way[a] / length;
    }
    return !normal || -dot(out->n, normal) > OPPOSED;
}

// Leaves the facets that tie with the chosen one and are of another slope. Whether there are any.
static bool next_slope(const brunt_contact_surface *s, nearest *best) {
    const tied chosen = *most_facing(best);
    int32_t left = 0;
    double square = INFINITY;
    for (int32_t k = 0; k < best->count; k++) {
        const tied *other = &best->tied[k];
        if (other->face == chosen.face || other->at.square > best->root * best->root) continue;
        if (bear_together(s, &chosen, other)) continue;
        square = fmin(square, other->at.square);
        best->tied[left++] = *other;
    }
    best->count = left, best->square = square;
    return left > 0;
}

// The other slopes of a valley, in which all bear: with the first of two, an inside corner and its mirror image bore
// differently.
static void add_valley(const brunt_contact_surface *s, nearest *best, const double *normal, slave_hits *out) {
    bool more = out->hits[out->count - 1].valley;
    while (more && out->count < BRUNT_MAX_HITS && next_slope(s, best)) {
        hit *h = &out->hits[out->count];
        if (hit_facing(s, best, normal, h)) out->count++;
        more = h->valley;
    }
}

// A hit on whatever facet is nearest, when the slave is behind it; `least`: the least cosine with its normal.
static bool hit_behind(const brunt_contact_surface *s, const nearest *best, const double *normal, double least,
                       hit *out) {
    double way[3];
    take_nearest(s, best, out, way);
    return out->gap < 0 && -dot(out->n, normal) > least;
}

static int64_t cell_of(const brunt_node_to_facet *f, const double x[3]) {
    int64_t cell = 0;
    for (int a = 0; a < 3; a++) {
        double c = floor((x[a] - f->origin[a]) / f->cell);
        if (!(c >= 0) || c >= f->n[a]) return -1;
        cell = cell * f->n[a] + (int64_t)c;
    }
    return cell;
}

static bool near_box(const double box[6], const double x[3], double by) {
    return x[0] >= box[0] - by && x[0] <= box[3] + by && x[1] >= box[1] - by && x[1] <= box[4] + by &&
           x[2] >= box[2] - by && x[2] <= box[5] + by;
}

static bool within(const bounds *box, const double x[3], double by) {
    for (int a = 0; a < 3; a++)
        if (x[a] < box->low[a] - by || x[a] > box->high[a] + by) return false;
    return true;
}

bool brunt_node_to_facet_look(const brunt_node_to_facet *f, looker *l) {
    l->touches = l->enters = 0;
    for (int32_t q = f->near_first[l->box]; q < f->near_first[l->box + 1] && l->touches < BRUNT_MAX_NEAR; q++) {
        const bounds *other = &f->box[f->near_list[q]];
        if (other->fem < 0 || !within(other, l->x, f->range)) continue;
        l->touch[l->touches++] = other->body;
        if (!other->sheet && within(other, l->x, 0)) l->enter[l->enters++] = other->body;
    }
    l->cell = l->touches ? cell_of(f, l->x) : -1;
    return l->cell >= 0;
}

static bool is_among(int32_t body, const int32_t *list, int32_t count) {
    for (int32_t k = 0; k < count; k++)
        if (list[k] == body) return true;
    return false;
}

// The two nearest facets of all, whichever way they face.
typedef struct two_nearest {
    int32_t face;
    double first, second; // squares of their distances
    double facing;        // [m] how far the place is before or behind the nearest one
} two_nearest;

// Notes a facet. Of those that are equally near, as at an edge or a corner, the one that most faces the place tells on
// which side of the surface that is, whatever their order.
static void note(two_nearest *two, const brunt_closest *at, int32_t face) {
    const double facing = fabs(dot(at->normal, at->d)), same = two->face < 0 ? 0 : 1e-9 * two->first;
    if (at->square >= two->first + same) {
        two->second = fmin(two->second, at->square);
        return;
    }
    const bool nearer = at->square < two->first - same;
    two->second = fmax(two->first, at->square);
    two->first = fmin(two->first, at->square);
    if (nearer || facing > two->facing) two->face = face, two->facing = facing;
}

static bool in_ring(const looker *l, int32_t face) {
    int32_t low = 0, high = l->ring_count;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (l->ring[middle] < face)
            low = middle + 1;
        else
            high = middle;
    }
    return low < l->ring_count && l->ring[low] == face;
}

// The nearest facets in a cell of each body in `list`, among those that face `normal` by more than `least`. How many
// bodies. `guess`: a face that may well be the nearest, -1; it saves looking closely at most others. `all`: also notes
// the two nearest facets of any direction, as far as `slack` beyond the nearest; may be NULL. `sheets`: whether
// there are any; the cells have their fronts, for both sides.
static inline __attribute__((always_inline)) int
find_nearest(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l, const double *normal,
             double least, const int32_t *list, int32_t count, int32_t guess, double slack, two_nearest *all,
             bool sheets, nearest best[BRUNT_MAX_HITS]) {
    const brunt_contact_surface *s = m->skin;
    const double range2 = f->range * f->range;
    double bound = INFINITY; // of the one body that the guess belongs to
    brunt_closest guessed;
    if (guess >= 0) guessed = brunt_closest_on_face(s, guess, l->x), bound = tie(s, guessed.square);
    int bodies = 0;
    if (all) *all = (two_nearest){-1, range2, range2, 0};
    for (int32_t q = f->cell_first[l->cell]; q < f->cell_first[l->cell + 1]; q++) {
        int32_t face = f->cell_face[q];
        const int32_t other = s->face_body[face];
        if (other == l->body && !(sheets && l->ring_count)) continue;
        const bool sheet = sheets && s->side[other].faces;
        int b = 0;
        while (b < bodies && best[b].body != other) b++;
        double reach = b < bodies ? best[b].root : f->range;
        if (guess >= 0 && bound < reach && s->face_body[guess] == other) reach = bound;
        if (!near_box(s->face_box[face], l->x, reach + slack)) continue;
        const double cosine = normal ? -dot(s->face_normal[face], normal) : 1;
        bool faces = !normal || cosine > least || (sheet && -cosine > least);
        if ((!faces && !all) || !is_among(other, list, count)) continue;
        if (sheets && other == l->body && in_ring(l, face)) continue;
        brunt_closest at = face == guess ? guessed : brunt_closest_on_face(s, face, l->x);
        if (at.square > range2) continue;
        const bool behind = sheet && dot(at.normal, at.d) < 0;
        if (all) note(all, &at, behind ? face + s->side[other].faces : face);
        if (!faces) continue;
        if (sheet) {
            if (normal ? cosine < 0 : behind) turn_over(s, &face, &at);
            if (!on_side(l, &at)) continue;
        }
        if (b == bodies) {
            if (b == BRUNT_MAX_HITS) continue;
            best[b].body = other, best[b].count = 0, best[b].square = range2, best[b].root = f->range;
            bodies++;
        }
        keep(s, &best[b], &at, face);
    }
    return bodies;
}

// Whether a body, behind whose facet someone with a normal is, has one that he would sooner leave it through the other
// way: then he is before that one, or on the far side of a body thinner than the range, or the other side of a sheet.
static bool other_way_out(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l, int32_t body,
                          double square) {
    const brunt_contact_surface *s = m->skin;
    for (int32_t q = f->cell_first[l->cell]; q < f->cell_first[l->cell + 1]; q++) {
        const int32_t face = f->cell_face[q];
        if (s->face_body[face] != body || dot(s->face_normal[face], l->normal) <= OPPOSED) continue;
        if (near_box(s->face_box[face], l->x, sqrt(square)) && brunt_closest_on_face(s, face, l->x).square < square)
            return true;
    }
    return false;
}

// Facets of sheets that someone is right above, beside the nearest one and on another slope: in a valley all of them
// bear. Else what moves along one wall of a corner would be let through the other in the steps in which that is the
// further one.
static void add_slopes(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l, slave_hits *out) {
    const brunt_contact_surface *s = m->skin;
    bool any = false;
    for (int32_t k = 0; k < out->count; k++) any = any || is_sheet(s, out->hits[k].body);
    for (int32_t q = f->cell_first[l->cell]; any && q < f->cell_first[l->cell + 1]; q++) {
        int32_t face = f->cell_face[q];
        const int32_t body = s->face_body[face];
        if (!is_sheet(s, body) || !near_box(s->face_box[face], l->x, f->range)) continue;
        const double *normal = s->face_normal[face], *centre = s->face_centre[face];
        double towards = 0;
        for (int a = 0; a < 3; a++) towards += normal[a] * (l->normal ? -l->normal[a] : l->x[a] - centre[a]);
        if (l->normal && fabs(towards) <= OPPOSED) continue;
        bool met = false, same = false;
        for (int32_t k = 0; k < out->count; k++) {
            if (out->hits[k].body != body) continue;
            met = true;
            same = same || (towards < 0 ? -1 : 1) * dot(out->hits[k].n, normal) > SAME_SLOPE;
        }
        if (!met || same || (body == l->body && in_ring(l, face)) || out->count == BRUNT_MAX_HITS) continue;
        brunt_closest at = brunt_closest_on_face(s, face, l->x);
        if (towards < 0) turn_over(s, &face, &at);
        if (!at.inside || at.square > f->range * f->range || !on_side(l, &at)) continue;
        hit *h = &out->hits[out->count++];
        *h = (hit){.face = face, .triangle = at.triangle, .body = body, .gap = dot(at.normal, at.d)};
        memcpy(h->n, at.normal, sizeof h->n);
    }
}

static bool is_ragged(const brunt_contact_surface *s, int32_t body) { return s->ragged && s->ragged[body]; }

// Where elements have left, surfaces have steps, pits and spikes of the size of an element, and edges cut into edges: a
// node has its own body on the very side of a facet that it comes through, so that its normal tells nothing of it. All
// facets that someone is right before bear, whichever way they look, but for those beyond a ridge: who slides in under
// a block, a little too high, meets its underside and not the wall it came past.
static void add_ragged(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l, slave_hits *out) {
    const brunt_contact_surface *s = m->skin;
    const double edge = s->mean_edge;
    for (int32_t q = f->cell_first[l->cell]; q < f->cell_first[l->cell + 1]; q++) {
        const int32_t face = f->cell_face[q], body = s->face_body[face];
        if (body == l->body || is_sheet(s, body) || !(is_ragged(s, body) || is_ragged(s, l->body))) continue;
        if (out->count == BRUNT_MAX_HITS || !near_box(s->face_box[face], l->x, fmin(f->range, f->reach))) continue;
        if (!is_among(body, l->touch, l->touches)) continue;
        const double *centre = s->face_centre[face];
        const double to[3] = {centre[0] - l->x[0], centre[1] - l->x[1], centre[2] - l->x[2]};
        bool known = false;
        for (int32_t k = 0; k < out->count; k++) {
            const hit *h = &out->hits[k];
            known = known || (h->body == body &&
                              (dot(h->n, s->face_normal[face]) > SAME_SLOPE || dot(h->n, to) + h->gap < VALLEY * edge));
        }
        if (known) continue;
        const brunt_closest at = brunt_closest_on_face(s, face, l->x);
        const double height = dot(at.normal, at.d);
        if (!at.inside || height < -BEHIND * edge) continue;
        hit *h = &out->hits[out->count++];
        *h = (hit){.face = face, .triangle = at.triangle, .body = body, .gap = height};
        memcpy(h->n, at.normal, sizeof h->n);
    }
}

// Middle surfaces of sheets stay half their thickness away from what they meet.
static void thicken(const brunt_contact_surface *s, double half, slave_hits *out) {
    for (int32_t q = 0; q < out->count; q++) out->hits[q].gap -= half + s->side[out->hits[q].body].half;
}

// What someone meets of each other body. Facets that face the slave come first: a node that slides in under a block
// meets its underside, not the wall it came through. Only a slave that has none of those close by, and is inside, is
// sent out through the nearest facet there is. Tells how far the nearest facet is, or how far was looked, and how far
// the nearest but the one hit.
static inline __attribute__((always_inline)) void look_around(const brunt_contact_context *m,
                                                              const brunt_node_to_facet *f, const looker *l,
                                                              int32_t guess, slave_hits *out, double *distance,
                                                              double *second, bool sheets) {
    const brunt_contact_surface *s = m->skin;
    nearest facing[BRUNT_MAX_HITS], any[BRUNT_MAX_HITS];
    two_nearest two;
    const double close = CLOSE * s->mean_edge, slack = SLACK * s->mean_edge;
    out->count = 0;
    if (guess >= 0 && (!is_among(s->face_body[guess], l->touch, l->touches) ||
                       (l->normal && -dot(s->face_normal[guess], l->normal) <= OPPOSED)))
        guess = -1;
    if (sheets && guess >= 0 && is_sheet(s, s->face_body[guess])) guess = -1; // it may be on the other side now
    int bodies = find_nearest(m, f, l, l->normal, OPPOSED, l->touch, l->touches, guess, slack, &two, sheets, facing),
        unresolved = 0;
    int32_t entered[BRUNT_MAX_NEAR];
    for (int32_t k = 0; l->normal && k < l->enters; k++) {
        bool resolved = false;
        for (int b = 0; b < bodies; b++)
            resolved =
                resolved || (facing[b].body == l->enter[k] && facing[b].count && facing[b].square <= close * close);
        if (!resolved) entered[unresolved++] = l->enter[k];
    }
    int all = unresolved ? find_nearest(m, f, l, NULL, 0, entered, unresolved, -1, 0, NULL, false, any) : 0;
    for (int b = 0; b < all; b++) {
        const double least = is_ragged(s, l->body) || is_ragged(s, any[b].body) ? -INFINITY : ASKEW;
        if (!any[b].count || !hit_behind(s, &any[b], l->normal, least, &out->hits[out->count])) continue;
        out->count++;
        for (int k = 0; k < bodies; k++)
            if (facing[k].body == any[b].body) facing[k].count = 0;
    }
    // Whoever is before the nearest facet of all is outside, even if the nearest facet that faces him is seen from
    // behind. A sheet has no inside: it tells nothing of the others.
    const bool by_sheet = sheets && two.face >= 0 && is_sheet(s, s->face_body[two.face]);
    bool outside = false;
    if (two.face >= 0 && !by_sheet) {
        brunt_closest at = brunt_closest_on_face(s, two.face, l->x);
        double height = dot(at.normal, at.d);
        outside = height > 1e-6 * s->mean_edge && height > 0.1 * sqrt(at.square);
    }
    const bool plain = out->count == 0 && l->enters <= 1;
    bool inside = out->count > 0;
    for (int b = 0; b < bodies && out->count < BRUNT_MAX_HITS; b++) {
        hit *h = &out->hits[out->count];
        if (!facing[b].count || !hit_facing(s, &facing[b], l->normal, h)) continue;
        if (h->gap < 0 && outside && h->body == s->face_body[two.face]) continue;
        if (sheets && h->gap < 0 && l->normal && (by_sheet || l->sheet) && !is_sheet(s, h->body) &&
            other_way_out(m, f, l, h->body, facing[b].square))
            continue;
        inside = inside || h->gap < 0;
        out->count++;
        if (!is_ragged(s, h->body)) add_valley(s, &facing[b], l->normal, out);
    }
    if (sheets) add_slopes(m, f, l, out);
    if (s->ragged) add_ragged(m, f, l, out);
    *distance = outside || two.face < 0 || (by_sheet && !inside) ? fmin(f->range, sqrt(two.first)) : 0;
    *second = 0;
    if (plain && out->count == 1 && two.face == out->hits[0].face && !s->ragged)
        *second = fmin(fmin(f->range, sqrt(two.second)), *distance + slack) * (1 - 1e-8) - TOUCH * s->mean_edge;
    if (sheets) thicken(s, l->half, out);
}

void brunt_node_to_facet_look_around(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l,
                                     int32_t guess, slave_hits *out, double *distance, double *second) {
    if (m->skin->side)
        look_around(m, f, l, guess, out, distance, second, true);
    else
        look_around(m, f, l, guess, out, distance, second, false);
}

// The facet that was the nearest, when it is certain that it still is: it is nearer than `least`, which no other one
// is.
bool brunt_node_to_facet_still_nearest(const brunt_contact_context *m, const brunt_node_to_facet *f, int32_t n,
                                       const double *normal, double least, slave_hits *out) {
    const brunt_contact_surface *s = m->skin;
    const int32_t face = f->last[n];
    if (face < 0 || (normal && -dot(s->face_normal[face], normal) <= OPPOSED)) return false;
    const brunt_closest at = closest_on(s, face, s->x[n]);
    nearest one = {.body = s->face_body[face], .count = 1, .square = at.square, .root = INFINITY, .tied = {{at, face}}};
    if (is_sheet(s, one.body) && !(dot(at.normal, at.d) > 0)) return false;
    const double square = at.square, close = CLOSE * s->mean_edge;
    if (square >= least * least || square > close * close || square > f->range * f->range) return false;
    out->count = hit_facing(s, &one, normal, &out->hits[0]) ? 1 : 0;
    if (s->side) thicken(s, s->side[s->body[n]].half, out);
    return true;
}

int brunt_search_cells(const brunt_contact_context *m, brunt_node_to_facet *f) {
    uint64_t key = pairs_key(m, f);
    if (cells_hold(m, f, key)) return 0;
    if (make_cells(m, f)) return -1;
    f->made_near = f->near_count, f->made_pairs = key;
    return 0;
}
