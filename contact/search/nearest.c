// Of the facets that are nearest, the one that is met, or the edge or corner where several are as near.
#include "contact/search/nearest.h"

static const double SAME_SLOPE = 0.7; // cosine of normals from which on two facets of a membrane are one slope
static const double STRAIGHT = 0.01;  // [rad] within it of their mean normal, ways to edges and corners are along it

// Of two that tie, the one that the place is right above, and of two of those the nearer one, be it by less than what
// ties: their numbers settle only what rounding does.
static bool is_more_opposed(const tied *a, const tied *b) {
    if (a->at.inside != b->at.inside) return a->at.inside;
    const double of_a = a->at.inside ? -a->at.square : fabs(dot(a->at.normal, a->at.d)),
                 of_b = b->at.inside ? -b->at.square : fabs(dot(b->at.normal, b->at.d));
    return of_a > of_b || (of_a == of_b && a->face < b->face);
}

static const tied *most_opposed(const nearest *best) {
    const tied *chosen = NULL;
    for (int32_t k = 0; k < best->count; k++) {
        const tied *one = &best->tied[k];
        if (one->at.square > best->root * best->root) continue;
        if (!chosen || is_more_opposed(one, chosen)) chosen = one;
    }
    return chosen;
}

// Whether two facets that tie are of one slope, or of a ridge; of a valley each carries for itself.
static bool bear_together(const brunt_contact_surface *s, const tied *a, const tied *b) {
    if (dot(a->at.normal, b->at.normal) > SAME_SLOPE) return true;
    double to[3];
    for (int k = 0; k < 3; k++) to[k] = s->face_centre[b->face][k] - s->face_centre[a->face][k];
    return dot(a->at.normal, to) < 0 && dot(b->at.normal, to) > 0;
}

// The edge or corner that the chosen facet has in common with those that tie with it, their mean normal and the mean
// height above them; `way`: the sum of their ways to the slave.
static void find_feature(const brunt_contact_surface *s, const nearest *best, const tied *chosen, facet_candidate *out,
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

static const tied *take_nearest(const brunt_contact_surface *s, const nearest *best, facet_candidate *out,
                                double way[3]) {
    const tied *chosen = most_opposed(best);
    const brunt_closest *at = &chosen->at;
    *out = (facet_candidate){.face = chosen->face,
                             .triangle = at->triangle,
                             .body = best->body,
                             .inside = at->inside,
                             .gap = dot(at->normal, at->d)};
    memcpy(out->n, at->normal, sizeof out->n);
    memcpy(way, at->d, sizeof at->d);
    if (is_membrane(s, best->body)) return chosen; // faces of a crumpled membrane have no turn in common at a node
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
bool brunt_nearest_opposed(const brunt_contact_surface *s, const nearest *best, const double *normal,
                           facet_candidate *out) {
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
    const tied chosen = *most_opposed(best);
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
void brunt_nearest_valley(const brunt_contact_surface *s, nearest *best, const double *normal, candidate_list *out) {
    bool more = out->candidate[out->count - 1].valley;
    while (more && out->count < BRUNT_MAX_CANDIDATES && next_slope(s, best)) {
        facet_candidate *h = &out->candidate[out->count];
        if (brunt_nearest_opposed(s, best, normal, h)) out->count++;
        more = h->valley;
    }
}

// A hit on whatever facet is nearest, when the slave is behind it; `least`: the least cosine with its normal.
bool brunt_nearest_behind(const brunt_contact_surface *s, const nearest *best, const double *normal, double least,
                          facet_candidate *out) {
    double way[3];
    take_nearest(s, best, out, way);
    return out->gap < 0 && -dot(out->n, normal) > least;
}
