// Which bodies are near each other, and near planes: boxes by their low ends.
#include "contact/search/node_to_facet_parts.h"

#include <stdlib.h>

#include "base/sweep.h"
#include "contact/planes/boundary_lists.h"
#include "mpm/particles.h"
#include "mpm/mpm_body.h"

static const double RANGE = 0.25; // mean edges: how far a body looks for others, if nothing moves faster
static const double WAKE = 8;     // times the way of a step: what is no further apart wakes along with what is reached
static const double FARTHEST = 1e150; // [m] squares of distances are still numbers

static void bound_grid(const brunt_body *body, body_box *box) {
    const brunt_grid *grid = &body->grid;
    for (int a = 0; a < 3; a++)
        box->low[a] = a < grid->dim ? INFINITY : 0, box->high[a] = a < grid->dim ? -INFINITY : 0;
    const bool total = brunt_total_lagrangian(&body->particles);
    for (int32_t b = 0; b < grid->block_count && total; b++) {
        double low[3], high[3];
        brunt_body_block_bounds(body, b, low, high);
        for (int a = 0; a < grid->dim; a++) {
            box->low[a] = fmin(box->low[a], low[a] - (double)grid->h * grid->order);
            box->high[a] = fmax(box->high[a], high[a] + (double)grid->h * grid->order);
        }
    }
    for (int32_t b = 0; b < grid->block_count && !total; b++)
        for (int a = 0; a < grid->dim; a++) {
            double low = grid->origin[a] + (double)grid->h * grid->blocks[b].coord[a] * grid->side;
            box->low[a] = fmin(box->low[a], low);
            box->high[a] = fmax(box->high[a], low + (double)grid->h * (grid->side + grid->order));
        }
}

static int by_low(const void *a, const void *b) {
    const body_box *p = a, *q = b;
    return p->start < q->start ? -1 : p->start > q->start ? 1 : p->body - q->body;
}

static bool overlap(const body_box *a, const body_box *b, double by) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] - by > b->high[k] || b->low[k] - by > a->high[k]) return false;
    return true;
}

// How two bodies meet at facets; NULL: they do not.
static const brunt_pair *pair_between(const brunt_contact_context *m, const body_box *a, const body_box *b) {
    if (a->fem < 0 && b->fem < 0) return NULL; // particles have no facets: those meet at grid nodes
    const int32_t pair = brunt_pair_of(m->pair_map, a->body, b->body);
    return pair >= 0 && m->pairs[pair].meets & BRUNT_MEET_AT_FACETS ? &m->pairs[pair] : NULL;
}

static int find_boxes(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, brunt_node_to_facet *f,
                      brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    f->bodies.box_count = s->fem_count + mpm_count;
    if (RESERVE(&f->bodies, box, f->bodies.box_count + 1, "boxes about bodies", error) ||
        RESERVE(&f->bodies, box_of, s->fem_count + 1, "boxes of meshes", error))
        return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) {
        body_box *box = &f->bodies.box[k];
        *box = (body_box){.body = s->fem[k]->index, .fem = k, .mpm = -1, .membrane = s->fem[k]->traits->membrane};
        memcpy(box->low, s->low[k], sizeof box->low), memcpy(box->high, s->high[k], sizeof box->high);
    }
    for (int k = 0; k < mpm_count; k++) {
        body_box *box = &f->bodies.box[s->fem_count + k];
        *box = (body_box){.body = mpm[k].index, .fem = -1, .mpm = k};
        bound_grid(&mpm[k], box);
    }
    brunt_spread spread = {.count = 0};
    for (int32_t k = 0; k < f->bodies.box_count; k++) brunt_spread_add(&spread, f->bodies.box[k].low);
    f->bodies.axis = brunt_spread_axis(&spread);
    for (int32_t k = 0; k < f->bodies.box_count; k++) f->bodies.box[k].start = f->bodies.box[k].low[f->bodies.axis];
    qsort(f->bodies.box, (size_t)f->bodies.box_count, sizeof *f->bodies.box, by_low);
    for (int32_t k = 0; k < f->bodies.box_count; k++)
        if (f->bodies.box[k].fem >= 0) f->bodies.box_of[f->bodies.box[k].fem] = k;
    return BRUNT_OK;
}

// Whether a body is in the search: one that was in it, as long as anything is near, and material points.
static inline bool is_awake(const brunt_contact_surface *s, const body_box *box) {
    return box->fem < 0 || s->active[box->fem];
}

// Leaves out the pairs with a mesh that nothing can reach in this step, and that nothing was near to before: one
// comparison of boxes is all it costs. When anything is reached, what will be soon wakes, too, so that what is known of
// distances is seldom made anew.
static void leave_sleeping(brunt_contact_surface *s, brunt_node_to_facet *f) {
    const double travel = f->bodies.travel + 1e-6 * s->mean_edge;
    memcpy(s->active, s->motion.was_active, (size_t)s->fem_count * sizeof *s->active);
    for (int wake = 0; wake < 2; wake++) {
        bool reached = false;
        for (int32_t p = 0; p < f->bodies.pair_count; p++) {
            const body_box *a = &f->bodies.box[f->bodies.pair[p].a], *b = &f->bodies.box[f->bodies.pair[p].b];
            if ((is_awake(s, a) && is_awake(s, b)) || !overlap(a, b, wake ? WAKE * travel : travel)) continue;
            reached = true;
            if (wake && a->fem >= 0) s->active[a->fem] = true;
            if (wake && b->fem >= 0) s->active[b->fem] = true;
        }
        if (!reached) break;
    }
    int32_t kept = 0;
    for (int32_t p = 0; p < f->bodies.pair_count; p++) {
        const near_pair *pair = &f->bodies.pair[p];
        if (is_awake(s, &f->bodies.box[pair->a]) && is_awake(s, &f->bodies.box[pair->b]))
            f->bodies.pair[kept++] = *pair;
    }
    f->bodies.pair_count = kept;
}

// Boxes near boxes, by their pairs.
static int list_near(near_bodies *bodies, brunt_error *error) {
    const size_t boxes = (size_t)bodies->box_count, pairs = (size_t)bodies->pair_count;
    if (BRUNT_CAPACITY(bodies->first, boxes + 2, 0, "boxes near boxes", error) ||
        BRUNT_CAPACITY(bodies->list, 2 * pairs + 1, 0, "boxes near boxes", error))
        return BRUNT_FAILED;
    int32_t *first = bodies->first; // of box b at b + 1, until all are listed
    memset(first, 0, (boxes + 2) * sizeof *first);
    for (const near_pair *pair = bodies->pair; pair < bodies->pair + pairs; pair++) {
        first[pair->a + 2]++;
        if (pair->b != pair->a) first[pair->b + 2]++;
    }
    for (int32_t k = 2; k <= bodies->box_count + 1; k++) first[k] += first[k - 1];
    for (int looks = 1; looks >= 0; looks--) {
        for (const near_pair *pair = bodies->pair; pair < bodies->pair + pairs; pair++) {
            if (pair->a_looks == looks) bodies->list[first[pair->a + 1]++] = pair->b;
            if (pair->b != pair->a && pair->b_looks == looks) bodies->list[first[pair->b + 1]++] = pair->a;
        }
        for (int32_t k = 0; k < bodies->box_count && looks; k++) bodies->box[k].looks_end = first[k + 1];
    }
    for (const near_pair *pair = bodies->pair; pair < bodies->pair + pairs; pair++) {
        bodies->box[pair->a].seen = bodies->box[pair->a].seen || pair->b_looks;
        bodies->box[pair->b].seen = bodies->box[pair->b].seen || pair->a_looks;
    }
    return BRUNT_OK;
}

static int find_pairs(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error) {
    const int axis = f->bodies.axis;
    f->bodies.pair_count = 0;
    for (int32_t i = 0; i < f->bodies.box_count; i++)
        // A membrane may be near itself.
        for (int32_t k = f->bodies.box[i].membrane ? i : i + 1;
             k < f->bodies.box_count && f->bodies.box[k].start - 2 * f->bodies.range <= f->bodies.box[i].high[axis];
             k++) {
            const body_box *a = &f->bodies.box[i], *b = &f->bodies.box[k];
            const brunt_pair *pair = overlap(a, b, 2 * f->bodies.range) ? pair_between(m, a, b) : NULL;
            if (!pair) continue;
            if (BRUNT_CAPACITY(f->bodies.pair, (size_t)f->bodies.pair_count + 1, (size_t)f->bodies.pair_count,
                               "pairs of bodies that are near each other", error))
                return BRUNT_FAILED;
            f->bodies.pair[f->bodies.pair_count++] =
                (near_pair){i, k, brunt_pair_looks(pair, a->body, b->body), brunt_pair_looks(pair, b->body, a->body)};
        }
    if (!(m->look > 0)) leave_sleeping(m->surface, f);
    return list_near(&f->bodies, error);
}

// Whether there is a place for everything: else no cells could be laid.
static bool all_finite(const brunt_node_to_facet *f) {
    if (!(f->bodies.range < FARTHEST) || !(f->bodies.plane_travel < FARTHEST)) return false;
    for (int32_t b = 0; b < f->bodies.box_count; b++)
        for (int a = 0; a < 3; a++) {
            const double low = f->bodies.box[b].low[a], high = f->bodies.box[b].high[a];
            if (low == INFINITY && high == -INFINITY) continue; // of nothing
            if (!(fabs(low) < FARTHEST) || !(fabs(high) < FARTHEST)) return false;
        }
    return true;
}

static bool near_boundary(const brunt_contact_context *m, const brunt_node_to_facet *f, int k) {
    const brunt_contact_surface *s = m->surface;
    brunt_boundary_walk acting = brunt_boundaries_of(m->acting, s->fem[k]->index);
    int w;
    while ((w = brunt_boundary_next(&acting)) != BRUNT_NONE)
        if (m->boundaries[w].kind->near_surface &&
            m->boundaries[w].kind->near_surface(s, k, &m->boundaries[w], m->time,
                                                f->bodies.plane_travel + 1e-6 * s->mean_edge))
            return true;
    return false;
}

// The room about all bodies near body k, twice as wide as is looked: what of k reaches not into it is further than that
// from all of them. `all`: whatever is of k is in it.
static void find_zone(brunt_contact_surface *s, const brunt_node_to_facet *f, int k, bool all) {
    double *zone = s->motion.zone[k];
    for (int a = 0; a < 3; a++) zone[a] = all ? -INFINITY : INFINITY, zone[3 + a] = -zone[a];
    const int32_t box = f->bodies.box_of[k];
    for (int32_t q = f->bodies.first[box]; q < f->bodies.first[box + 1]; q++) {
        const body_box *other = &f->bodies.box[f->bodies.list[q]];
        for (int a = 0; a < 3; a++) {
            zone[a] = fmin(zone[a], other->low[a] - 2 * f->bodies.range);
            zone[3 + a] = fmax(zone[3 + a], other->high[a] + 2 * f->bodies.range);
        }
    }
}

int brunt_broad_phase(const brunt_contact_context *m, brunt_node_to_facet **node_to_facet, bool *far,
                      brunt_error *error) {
    brunt_contact_surface *s = m->surface;
    brunt_body *mpm = m->mpm;
    const brunt_boundary *boundaries = m->boundaries;
    const int mpm_count = m->mpm_count, boundary_count = m->boundary_count;
    *far = false;
    if (brunt_node_to_facet_make(node_to_facet, mpm_count, s->node_count, error)) return BRUNT_FAILED;
    brunt_node_to_facet *f = *node_to_facet;
    // Nothing may pass anything unseen: the reach covers twice the fastest motion of a step, against the frame of all.
    double fastest = 0, spacing = 0;
    for (int k = 0; k < s->fem_count; k++) fastest = fmax(fastest, s->motion.speed[k]);
    const double frame = sqrt(dot(s->motion.frame, s->motion.frame));
    for (int k = 0; k < mpm_count; k++) {
        spacing = fmax(spacing, mpm[k].spacing);
        fastest = fmax(fastest, (double)mpm[k].speed + frame);
    }
    double boundaries_speed = 0;
    for (int w = 0; w < boundary_count; w++)
        if (boundaries[w].kind->near_surface) {
            const double *v = boundaries[w].kind->velocity(&boundaries[w]);
            boundaries_speed = fmax(boundaries_speed, sqrt(dot(v, v)));
        }
    f->bodies.plane_travel = (fastest + frame + boundaries_speed) * m->dt + 0.5 * s->membrane.thickest;
    f->bodies.travel = 2 * fastest * m->dt + spacing + s->membrane.thickest;
    const double least = RANGE * s->mean_edge + spacing + s->membrane.thickest;
    f->bodies.range = fmax(fmax(least, f->bodies.travel), m->look);
    s->motion.seen = 2 * least;
    if (find_boxes(m, mpm, mpm_count, f, error)) return BRUNT_FAILED;
    if ((*far = !all_finite(f))) return brunt_fail(error, BRUNT_FAILED, "a body or a plane goes too far in a step");
    if (find_pairs(m, f, error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) {
        const bool by_boundary = near_boundary(m, f, k);
        s->active[k] = by_boundary || has_near_bodies(&f->bodies, f->bodies.box_of[k]);
        find_zone(s, f, k, by_boundary || s->membrane.side);
    }
    return BRUNT_OK;
}
