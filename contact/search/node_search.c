// What every boundary node of a mesh meets: most look where they looked a step ago, as many at once as a vector holds;
// the others by themselves.
#include "contact/search/candidates_parts.h"
#include "contact/search/node_lanes.h"

#include "base/parallel.h"

enum { GRAIN = 64, AHEAD = 8 };    // AHEAD: nodes whose facets are fetched meanwhile, in two steps
static const double BESIDE = 0.05; // mean edges: where the second facet is as near, those about are listed

typedef struct search_job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
} search_job;

// What a node needs to look at membranes, or as one.
static void look_at_membranes(const brunt_contact_surface *s, int32_t n, search_query *l) {
    const brunt_side *side = &s->membrane.side[s->body[n]];
    l->membrane = side->faces > 0, l->half = side->half, l->shallow = side->shallow;
    if (!s->membrane.patch_first) return;
    const int32_t first = s->membrane.patch_first[s->membrane.front[n]];
    l->patch = s->membrane.patch_face + first,
    l->patch_count = s->membrane.patch_first[s->membrane.front[n] + 1] - first;
}

// Keeps the master that a feature makes, which is made once.
static void keep_master(brunt_node_to_facet *f, const brunt_contact_surface *s, facet_candidate *h, const double x[3],
                        int worker) {
    master_list *of = &f->nodes.masters[worker];
    const size_t used = (size_t)of->count;
    if (BRUNT_CAPACITY_IN(of->master, of->capacity, used + 1, used, "edges and corners near nodes", &of->error)) return;
    h->worker = worker, h->master = of->count;
    brunt_node_to_facet_master(s, h, x, &of->master[of->count++]);
}

static inline double least_of(double a, double b) { return b < a ? b : a; }

// A query from a node; its lists of bodies, which are long, stay as they are until they are made.
static inline void begin_query(search_query *l, int32_t box, int32_t body, const double *x, const double *normal) {
    l->box = box, l->body = body, l->x = x, l->normal = normal;
    l->particle = l->membrane = false;
    l->bounds = NULL, l->beside = l->patch = NULL;
    l->cell = BRUNT_NONE;
    l->besides = l->touches = l->enters = l->patch_count = 0;
    l->half = l->shallow = 0;
}

// What is known of node n of body k as it and what is near it have moved. Whether it is to look for facets.
static inline bool ages(const search_job *j, int k, int32_t n) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    node_distance *cached = &f->cache.node[n];
    const double apart = s->motion.apart[brunt_surface_chunk(s, k, n) / s->motion.group];
    cached->since += apart, cached->beyond -= apart;
    if (cached->distance - cached->since > f->bodies.travel) return false;
    if (!s->motion.near[n]) {
        *cached = (node_distance){.distance = least_of(f->bodies.range, s->motion.seen)};
        return false;
    }
    // a detached node has one side
    return !(s->membrane.front && s->membrane.front[n] != n && s->face_first[n + 1] == s->face_first[n]);
}

// Looks through the facets about node n of body k, for what it meets. Whether it may meet any.
static bool look_about(const search_job *j, int k, int32_t n, const double *normal, candidate_list *found) {
    const brunt_contact_context *m = j->m;
    brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = m->surface;
    node_distance *cached = &f->cache.node[n];
    const double far = least_of(f->bodies.range, s->motion.seen);
    search_query l;
    begin_query(&l, f->bodies.box_of[k], s->body[n], s->x[n], normal);
    if (s->membrane.side) look_at_membranes(s, n, &l);
    cached->since = 0, cached->distance = far, cached->second = 0;
    if (!brunt_candidates_bodies(f, &l) || (l.cell = brunt_candidates_cell(f, l.x)) < 0) {
        if (l.touches) cached->distance = 0; // near, but outside the cells
        return false;
    }
    if (!brunt_candidates_among(m, f, &l, n, found)) {
        brunt_candidates_find(m, f, &l, f->cache.nearest[n], found);
        if (found->second < BESIDE * s->mean_edge) brunt_candidates_remember(m, f, &l, n);
    }
    cached->distance = least_of(found->distance, far), cached->second = least_of(found->second, far);
    if (l.touches == BRUNT_MAX_NEAR)
        cached->distance = cached->second = 0; // there may be more bodies than were looked at
    if (found->count) f->cache.nearest[n] = found->candidate[0].face;
    return true;
}

// Whether node n touches what it sees, with the velocities along its normal now and before: sets the target.
static inline bool touches(const search_job *j, int32_t n, double approach, double came, facet_candidate *h) {
    const brunt_contact_surface *s = j->m->surface;
    const node_touches *held = &j->f->touches;
    const double gap[2] = {h->gap, brunt_initial_penetration_meet(&j->f->penetration, &n, 1, h->gap)};
    h->target = brunt_node_to_facet_target(s, gap, approach, came, j->m->dt);
    return approach < h->target + 1e-6 * s->mean_edge / j->m->dt || brunt_node_holds(held, n, TOUCHED_FACET) ||
           brunt_node_holds(held, n, TOUCHED_EDGE);
}

static void find_node_candidates(const search_job *j, int k, int32_t n, int worker) {
    const brunt_contact_context *m = j->m;
    brunt_node_to_facet *f = j->f;
    brunt_contact_surface *s = m->surface;
    candidate_list list, *found = &list;
    const bool faces = s->normal[n][0] != 0 || s->normal[n][1] != 0 || s->normal[n][2] != 0;
    const double *normal = faces ? s->normal[n] : NULL, since = f->cache.node[n].since,
                 second = f->cache.node[n].second;
    if (!(since < second && brunt_candidates_still_nearest(m, f, n, normal, second - since, found)) &&
        !look_about(j, k, n, normal, found))
        return;
    int32_t kept = 0;
    for (int32_t q = 0; q < found->count; q++) {
        facet_candidate *h = &found->candidate[q];
        if (h->gap > f->bodies.travel) continue;
        s->output.gap[n] = least_of(s->output.gap[n], h->gap);
        brunt_corners under;
        brunt_node_to_facet_corners(s, h, s->x[n], &under);
        const double approach = brunt_node_to_facet_approach(&under, h->n, s->v[n], s->v),
                     came = h->gap < 0 ? brunt_node_to_facet_approach(&under, h->n, s->old[n], s->old) : 0;
        if (!touches(j, n, approach, came, h)) continue;
        if (h->feature.any) keep_master(f, s, h, s->x[n], worker);
        *node_candidate_of(f, s, n, kept++) = *h;
    }
    f->nodes.count[n] = (uint8_t)kept;
}

// What is looked at of the nearest facet.
static inline void fetch_facet(const brunt_contact_surface *s, int32_t face) {
    for (int c = 0; c < brunt_face_corners(s->face[face]); c++)
        __builtin_prefetch(s->x[s->face[face][c]]), __builtin_prefetch(s->v[s->face[face][c]]);
}

static inline void fetch_nearest(const brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n, int32_t end) {
    const int32_t far = n + 2 * AHEAD < end ? f->cache.nearest[n + 2 * AHEAD] : -1,
                  close = n + AHEAD < end ? f->cache.nearest[n + AHEAD] : -1;
    if (far >= 0) __builtin_prefetch(s->face[far]), __builtin_prefetch(s->face_normal[far]);
    if (close >= 0) fetch_facet(s, close);
}

// Nodes that are looked at together, so many.
typedef struct node_batch {
    int32_t count, node[GRAIN], body[GRAIN];
} node_batch;

// What lane i of a batch meets.
static void meet_in_lane(const search_job *j, const node_lanes *at, int i) {
    const int32_t n = at->node[i];
    brunt_contact_surface *s = j->m->surface;
    if (at->gap[i] > j->f->bodies.travel) return;
    facet_candidate *h = node_candidate_of(j->f, s, n, 0);
    *h = (facet_candidate){.face = at->face[i],
                           .triangle = at->triangle[i],
                           .body = s->face_body[at->face[i]],
                           .inside = true,
                           .gap = at->gap[i]};
    memcpy(h->n, at->n[i], sizeof h->n);
    s->output.gap[n] = least_of(s->output.gap[n], h->gap);
    j->f->nodes.count[n] = touches(j, n, at->approach[i], h->gap < 0 ? at->came[i] : 0, h);
}

// Those from `first` on, as many as there are lanes; where there are fewer the first again. How many.
static int fill_lanes(const brunt_node_to_facet *f, const node_batch *batch, int32_t first, node_lanes *at) {
    const int count = batch->count - first < BRUNT_DOUBLES ? batch->count - first : BRUNT_DOUBLES;
    for (int i = 0; i < BRUNT_DOUBLES; i++) {
        const int32_t n = batch->node[first + (i < count ? i : 0)];
        at->node[i] = n, at->face[i] = f->cache.nearest[n];
    }
    return count;
}

static inline void fetch_lanes(const brunt_node_to_facet *f, const brunt_contact_surface *s, const node_batch *batch,
                               int32_t first) {
    for (int32_t i = first; i < first + BRUNT_DOUBLES && i < batch->count; i++)
        fetch_facet(s, f->cache.nearest[batch->node[i]]);
}

// Whether node n, which looks, may be at the facet that was the nearest still, since no other has come as near.
static inline bool may_stay(const brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n) {
    const node_distance *cached = &f->cache.node[n];
    const int32_t face = f->cache.nearest[n];
    return cached->since < cached->second && face >= 0 && !s->membrane.side && s->motion.made[face] &&
           s->face[face][3] >= 0;
}

// Nodes that may stay.
static void stay_together(const search_job *j, const node_batch *batch, int worker) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    for (int32_t first = 0; first < batch->count; first += BRUNT_DOUBLES) {
        node_lanes at;
        const int count = fill_lanes(f, batch, first, &at);
        fetch_lanes(f, s, batch, first + BRUNT_DOUBLES);
        brunt_node_lanes_look(s, f->bodies.range, &at);
        for (int i = 0; i < count; i++) {
            const node_distance *cached = &f->cache.node[at.node[i]];
            const double least = cached->second - cached->since;
            if (!at.known[i] || at.square[i] >= least * least)
                find_node_candidates(j, batch->body[first + i], at.node[i], worker);
            else if (at.opposed[i])
                meet_in_lane(j, &at, i);
        }
    }
}

// Whether node n of body k, which looks, may be looked at among the facets that are listed.
static inline bool may_be_among(const search_job *j, int k, int32_t n) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    const int32_t face = f->cache.nearest[n];
    if (!(f->cache.node[n].beyond > 0) || face < 0 || !s->motion.made[face] || s->face[face][3] < 0) return false;
    search_query l;
    begin_query(&l, f->bodies.box_of[k], s->body[n], s->x[n], NULL);
    return brunt_candidates_bodies(f, &l) && l.touches == 1 && brunt_candidates_cell(f, l.x) >= 0 &&
           s->face_body[face] == l.touch[0] && s->face_body[f->cache.beside[n][0]] == l.touch[0];
}

// Of each lane the facet that is looked at first beside its own; of those that have none, or are not known, their own.
static void begin_besides(const search_job *j, node_lanes *at, beside_one beside[BRUNT_DOUBLES],
                          int32_t face[BRUNT_DOUBLES]) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    for (int i = 0; i < BRUNT_DOUBLES; i++) {
        const int32_t n = at->node[i], *list = f->cache.beside[n];
        beside_one *b = &beside[i];
        face[i] = at->face[i];
        if (!at->known[i]) continue;
        b->two.face = at->face[i], b->two.first = at->square[i], b->two.height = at->gap[i];
        at->known[i] = brunt_beside_begin(s, f, s->x[n], list, b);
        if (!at->known[i] || b->least < 0) continue;
        if (s->face[list[b->least]][3] < 0)
            at->known[i] = false;
        else
            face[i] = list[b->least];
    }
}

// What lane i meets, and how far all facets are of its node, with the square of the distance to the one beside; false:
// it is to be looked at alone.
static bool settle_lane(const search_job *j, const node_lanes *at, int i, double square, beside_one *b) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    const int32_t n = at->node[i], *list = f->cache.beside[n];
    const double far = least_of(f->bodies.range, s->motion.seen);
    candidate_list found;
    if (!at->known[i] || !brunt_beside_settle(s, s->x[n], list, square, b)) return false;
    found.candidate[0].gap = at->gap[i];
    brunt_beside_end(s, f, b, at->opposed[i], &found);
    node_distance *cached = &f->cache.node[n];
    if (!(found.reach < cached->beyond)) return false;
    cached->since = 0;
    cached->distance = least_of(found.distance, far), cached->second = least_of(found.second, far);
    if (found.count) meet_in_lane(j, at, i);
    return true;
}

// Nodes that may be among what is listed.
static void settle_together(const search_job *j, const node_batch *batch, int worker) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    for (int32_t first = 0; first < batch->count; first += BRUNT_DOUBLES) {
        node_lanes at;
        beside_one beside[BRUNT_DOUBLES];
        int32_t face[BRUNT_DOUBLES];
        double square[BRUNT_DOUBLES];
        const int count = fill_lanes(f, batch, first, &at);
        fetch_lanes(f, s, batch, first + BRUNT_DOUBLES);
        brunt_node_lanes_look(s, f->bodies.range, &at);
        begin_besides(j, &at, beside, face);
        brunt_node_lanes_squares(s, at.node, face, square);
        for (int i = 0; i < count; i++) {
            const bool again = face[i] != at.face[i] && square[i] < 0; // it is to be looked at by itself
            if (again) square[i] = brunt_closest_on_face_within(s, face[i], s->x[at.node[i]], 0).square;
            if (!settle_lane(j, &at, i, square[i], &beside[i]))
                find_node_candidates(j, batch->body[first + i], at.node[i], worker);
        }
    }
}

// A batch of nodes for each of the two ways.
typedef struct node_batches {
    node_batch stay, among;
} node_batches;

static void add_to_batch(node_batch *batch, int k, int32_t n) {
    batch->body[batch->count] = k, batch->node[batch->count++] = n;
}

// What node n of body k meets, or into a batch with it.
static void look_from(const search_job *j, node_batches *batches, int k, int32_t n, int worker) {
    const brunt_node_to_facet *f = j->f;
    const brunt_contact_surface *s = j->m->surface;
    const node_distance *cached = &f->cache.node[n];
    if (may_stay(f, s, n))
        add_to_batch(&batches->stay, k, n);
    else if (!(cached->since < cached->second) && may_be_among(j, k, n))
        add_to_batch(&batches->among, k, n);
    else
        find_node_candidates(j, k, n, worker);
    if (batches->stay.count == GRAIN) stay_together(j, &batches->stay, worker), batches->stay.count = 0;
    if (batches->among.count == GRAIN) settle_together(j, &batches->among, worker), batches->among.count = 0;
}

static void find_nodes(void *context, int64_t begin, int64_t end, int worker) {
    const search_job *j = context;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_node_to_facet *f = j->f;
    node_batches batches;
    batches.stay.count = batches.among.count = 0;
    int k = 0;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        while (s->node_range[k + 1] <= n) k++;
        f->nodes.count[n] = 0;
        if (!s->active[k]) continue;
        fetch_nearest(f, s, n, (int32_t)end);
        if (!has_near_bodies(&f->bodies, f->bodies.box_of[k]))
            f->cache.node[n] = (node_distance){0}; // how far it goes meanwhile is not counted
        else if (ages(j, k, n))
            look_from(j, &batches, k, n, worker);
    }
    stay_together(j, &batches.stay, worker);
    settle_together(j, &batches.among, worker);
}

int brunt_node_search(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_error *error) {
    search_job j = {m, f};
    if (!f->nodes.masters && BRUNT_NEW(f->nodes.masters, m->threads, "threads that look from nodes", error))
        return BRUNT_FAILED;
    f->nodes.masters_count = m->threads;
    for (int t = 0; t < m->threads; t++) f->nodes.masters[t].count = 0, f->nodes.masters[t].error.code = BRUNT_OK;
    brunt_parallel(m->threads, m->surface->node_count, GRAIN, find_nodes, &j, m->timer);
    for (int t = 0; t < m->threads; t++)
        if (brunt_hand_on(error, &f->nodes.masters[t].error)) return BRUNT_FAILED;
    return BRUNT_OK;
}
