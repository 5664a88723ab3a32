#include "contact/search/node_to_facet_parts.h"

#include "contact/distance/point_facet.h"
#include "contact/search/nearest.h"
#include "mpm/particles.h"
#include "base/parallel.h"
#include "mpm/mpm_body.h"

enum { GRAIN = 64, AHEAD = 8 };        // AHEAD: nodes whose facets are fetched meanwhile
static const double CORRECTION = 0.2;  // share of a penetration that is pushed out in a step ...
static const double RESTITUTION = 0.5; // ... but no faster than this share of the approach, so that it adds no energy

// ------------------------------------------------------------------------------------------ boundary nodes

typedef struct search_job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_constraint_set *constraints;
    int32_t dofs_before; // degree-of-freedom nodes that there were before those of the nodes
} search_job;

// Least velocity along the normal: to arrive at the surface, not past it. What is behind it is pushed out, but no
// faster than half as fast as it came, by which no impact gains energy. What rests comes anew each step, as the load
// brings it: pushing that out does work, and is only done over the small depths that unfinished sweeps leave, beyond
// what it may lie there; deeper ones wait until they part by themselves.
double brunt_node_to_facet_target(const brunt_contact_surface *s, const double gap[2], double approach, double before,
                                  double dt) {
    if (gap[0] >= 0) return -gap[0] / dt;
    const bool loaded = gap[0] > -BRUNT_SHALLOW * s->mean_edge;
    return fmin(CORRECTION * -gap[loaded] / dt, RESTITUTION * fmax(0, loaded ? -approach : -before));
}

void brunt_node_to_facet_corners(const brunt_contact_surface *s, const facet_candidate *h, const double x[3],
                                 brunt_corners *under) {
    if (h->feature.triangles) {
        brunt_master m;
        under->count = brunt_node_to_facet_master(s, h, x, &m);
        memcpy(under->node, m.node, sizeof m.node), memcpy(under->weight, m.weight, sizeof m.weight);
        return;
    }
    under->count = h->feature.any ? 2 : brunt_face_corners(s->face[h->face]);
    memcpy(under->node, h->feature.any ? h->feature.end : s->face[h->face], (size_t)under->count * sizeof *under->node);
    if (h->feature.any)
        brunt_feature_values(s, &h->feature, x, under->weight);
    else
        brunt_face_values(s, h->face, h->triangle, x, under->weight);
}

double brunt_node_to_facet_approach(const brunt_corners *under, const double n[3], const double v[3], double (*of)[3]) {
    double along = dot(v, n);
    for (int c = 0; c < under->count; c++) along -= under->weight[c] * dot(of[under->node[c]], n);
    return along;
}

const brunt_pair *brunt_node_to_facet_constraint(const brunt_contact_context *m, const facet_candidate *h,
                                                 const double x[3], int body, brunt_constraint *constraint) {
    brunt_pair *pair = &m->pairs[brunt_pair_of(m->pair_map, body, h->body)];
    memcpy(constraint->x, x, sizeof constraint->x);
    memcpy(constraint->n, h->n, sizeof constraint->n);
    constraint->gap = h->gap;
    constraint->friction = pair->friction;
    constraint->account = &pair->last, constraint->partner = h->body + 1;
    constraint->sign = (body > h->body) - (body < h->body);
    return pair;
}

int brunt_node_to_facet_master(const brunt_contact_surface *s, const facet_candidate *h, const double x[3],
                               brunt_master *m) {
    if (h->feature.any) {
        memcpy(m->facet, h->n, sizeof m->facet);
        const brunt_feature_position place = {&h->feature, h->n, x};
        return m->count = brunt_feature_weights(s, &place, m->node, m->weight, m->gradient, &m->height);
    }
    memcpy(m->node, s->face[h->face], sizeof s->face[h->face]);
    const brunt_facet_position place = {h->face, h->triangle, x};
    brunt_face_weights(s, &place, m->weight, m->gradient, m->facet, &m->height);
    return m->count = brunt_face_corners(s->face[h->face]);
}

void brunt_node_to_facet_entries(const brunt_node_to_facet *f, const brunt_master *m, brunt_constraint *constraint,
                                 brunt_constraint_entry *entry) {
    memcpy(constraint->facet, m->facet, sizeof constraint->facet);
    constraint->turns = true;
    for (int c = 0; c < m->count; c++) {
        entry[c].dof_node = f->nodes.dof_of[m->node[c]];
        for (int a = 0; a < 3; a++)
            entry[c].weight[a] = -m->weight[c], entry[c].height_gradient[a] = m->height * m->gradient[c][a];
    }
}

// What is a node's of the surface that faces against n [m^2].
double brunt_node_to_facet_area(const brunt_contact_surface *s, int32_t n, const double direction[3]) {
    double area = 0;
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
        int32_t f = s->face_of[q];
        double cosine = -dot(s->face_normal[f], direction);
        if (cosine > 0.5) area += cosine * brunt_surface_nodal_area(s, f, n);
    }
    return area;
}

// What a node's constraint is made of.
static inline void fetch_constraint(const brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n) {
    const int32_t *corner = s->face[node_candidate_of(f, s, n, 0)->face];
    for (int c = 0; c < brunt_face_corners(corner); c++)
        __builtin_prefetch(s->x[corner[c]]), __builtin_prefetch(&f->nodes.dof_of[corner[c]]);
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++)
        __builtin_prefetch(s->face_normal[s->face_of[q]]), __builtin_prefetch(&s->face_area[s->face_of[q]]);
}

static void fill_constraints(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const search_job *j = context;
    const brunt_contact_context *m = j->m;
    const brunt_contact_surface *s = m->surface;
    brunt_node_to_facet *f = j->f;
    int32_t filled = f->nodes.first[2 * begin];
    for (int32_t n = (int32_t)begin; n < end; n++) {
        int32_t at = f->nodes.first[2 * n], entry = f->nodes.first[2 * n + 1];
        if (n + AHEAD < end && f->nodes.count[n + AHEAD]) fetch_constraint(f, s, n + AHEAD);
        for (int32_t q = 0; q < f->nodes.count[n]; q++, at++) {
            const facet_candidate *h = node_candidate_of(f, s, n, q);
            brunt_constraint *constraint = &j->constraints->constraint[at];
            brunt_master plain;
            const brunt_master *master = h->feature.any ? kept_master(f, h) : &plain;
            if (!h->feature.any) brunt_node_to_facet_master(s, h, s->x[n], &plain);
            *constraint = (brunt_constraint){.first = entry, .count = 1 + master->count, .tag = n};
            const brunt_pair *pair = brunt_node_to_facet_constraint(m, h, s->x[n], s->body[n], constraint);
            // where both look half of it is counted on the other side
            constraint->area = (pair->slaves ? 1 : 0.5) * brunt_node_to_facet_area(s, n, h->n);
            brunt_constraint_entry lane[BRUNT_LANE_ENTRIES],
                *to = constraint->count <= BRUNT_LANE_ENTRIES ? lane : &j->constraints->entry[entry];
            to[0] = (brunt_constraint_entry){.dof_node = f->nodes.dof_of[n], .weight = {1, 1, 1}};
            brunt_node_to_facet_entries(f, master, constraint, to + 1);
            constraint->target = h->target;
            // Not of membranes: what is light between heavy ones is thrown through.
            if (!is_membrane(s, s->body[n]) && !is_membrane(s, h->body))
                constraint->touch = brunt_node_touch(&f->touches, n, TOUCHED_FACET);
            if (to == lane) brunt_constraints_lane(j->constraints, at, lane);
            entry += constraint->count;
        }
        filled = brunt_constraints_fill_blocks(j->constraints, filled, at);
    }
}

static void begin_dof_node(const brunt_contact_surface *s, int32_t n, brunt_dof_node *dof_node) {
    *dof_node = (brunt_dof_node){.crossed = false};
    memcpy(dof_node->v, s->v[n], sizeof dof_node->v);
    memcpy(dof_node->old, s->old[n], sizeof dof_node->old);
    memcpy(dof_node->inverse, s->inverse[n], sizeof dof_node->inverse);
}

int32_t brunt_node_to_facet_dof_node(brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n,
                                     brunt_constraint_set *constraints, brunt_error *error) {
    if (f->nodes.dof_of[n] >= 0) return f->nodes.dof_of[n];
    if (s->membrane.front && s->membrane.front[n] != n)
        return f->nodes.dof_of[n] = brunt_node_to_facet_dof_node(f, s, s->membrane.front[n], constraints, error);
    int32_t at = brunt_constraints_dof_node(constraints, error);
    if (at < 0) return BRUNT_NONE;
    begin_dof_node(s, n, &constraints->dof_node[at]);
    return f->nodes.dof_of[n] = at;
}

// Marks a node, and its twin of the front; several threads may.
static void mark_node(const brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n) {
    __atomic_store_n(&f->nodes.meets[n], 1, __ATOMIC_RELAXED);
    if (s->membrane.front) __atomic_store_n(&f->nodes.meets[s->membrane.front[n]], 1, __ATOMIC_RELAXED);
}

// How many constraints and entries each node makes, and which nodes are in them.
static void count_node_constraints(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const search_job *j = context;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_node_to_facet *f = j->f;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        int32_t entries = 0;
        if (n + AHEAD < end && f->nodes.count[n + AHEAD])
            __builtin_prefetch(s->face[node_candidate_of(f, s, n + AHEAD, 0)->face]);
        for (int32_t q = 0; q < f->nodes.count[n]; q++) {
            const facet_candidate *h = node_candidate_of(f, s, n, q);
            int count;
            const int32_t *node = node_corners_under(f, s, h, &count);
            if (q == 0) mark_node(f, s, n);
            for (int c = 0; c < count; c++) mark_node(f, s, node[c]);
            entries += 1 + count;
        }
        f->nodes.first[2 * n] = f->nodes.count[n], f->nodes.first[2 * n + 1] = entries;
    }
}

// From numbers of constraints and entries of nodes to their firsts; numbers for the nodes in them, in their order: a
// twin of the front comes first. How many there are then of each goes to `total`.
static void number_node_constraints(const brunt_contact_surface *s, brunt_node_to_facet *f, int32_t total[3]) {
    for (int32_t n = 0; n < s->node_count; n++) {
        for (int i = 0; i < 2; i++) {
            const int32_t count = f->nodes.first[2 * n + i];
            f->nodes.first[2 * n + i] = total[i], total[i] += count;
        }
        if (!f->nodes.meets[n] || f->nodes.dof_of[n] >= 0) continue;
        const int32_t front = s->membrane.front ? s->membrane.front[n] : n;
        f->nodes.dof_of[n] = front == n ? total[2]++ : f->nodes.dof_of[front];
    }
}

static void begin_dof_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const search_job *j = context;
    const brunt_contact_surface *s = j->m->surface;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        const int32_t at = j->f->nodes.dof_of[n];
        if (at >= j->dofs_before && !(s->membrane.front && s->membrane.front[n] != n))
            begin_dof_node(s, n, &j->constraints->dof_node[at]);
    }
}

static int add_node_constraints(const brunt_contact_context *m, brunt_node_to_facet *f,
                                brunt_constraint_set *constraints, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    const size_t nodes = (size_t)s->node_count;
    int32_t total[3] = {constraints->constraint_count, constraints->entry_count, constraints->dof_node_count};
    search_job j = {.m = m, .f = f, .constraints = constraints, .dofs_before = total[2]};
    if (RESERVE(&f->nodes, first, 2 * nodes + 2, "contact points of nodes", error) ||
        RESERVE(&f->nodes, meets, nodes + 1, "marks of nodes that meet facets", error))
        return BRUNT_FAILED;
    memset(f->nodes.meets, 0, nodes * sizeof *f->nodes.meets);
    brunt_parallel(m->threads, s->node_count, GRAIN, count_node_constraints, &j, m->timer);
    number_node_constraints(s, f, total);
    if (total[0] == constraints->constraint_count) return BRUNT_OK;
    if (brunt_constraints_reserve(constraints, total[0], total[1], total[2], error)) return BRUNT_FAILED;
    constraints->constraint_count = total[0], constraints->entry_count = total[1];
    constraints->dof_node_count = total[2];
    if (brunt_constraints_open_blocks(constraints, error)) return BRUNT_FAILED;
    brunt_parallel(m->threads, s->node_count, GRAIN, begin_dof_nodes, &j, m->timer);
    brunt_parallel(m->threads, s->node_count, GRAIN, fill_constraints, &j, m->timer);
    return BRUNT_OK;
}

// Whether body k, or one near it, is new: nothing is known of distances then.
static bool is_anew(const brunt_contact_surface *s, const brunt_node_to_facet *f, int k) {
    bool anew = s->motion.anew[k];
    const int32_t box = f->bodies.box_of[k];
    for (int32_t q = f->bodies.first[box]; q < f->bodies.first[box + 1]; q++) {
        const int other = f->bodies.box[f->bodies.list[q]].fem;
        anew = anew || (other >= 0 && s->motion.anew[other]);
    }
    return anew;
}

// Where bodies are near each other.
static int find_between(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, brunt_node_to_facet *f,
                        brunt_constraint_set *constraints, brunt_error *error) {
    if (brunt_facet_cells_make(m, f, error)) return BRUNT_FAILED;
    if (brunt_node_search(m, f, error) || add_node_constraints(m, f, constraints, error) ||
        brunt_edge_edge_find(m, f, constraints, error))
        return BRUNT_FAILED;
    if (f->touches.of) brunt_touches_go_on(m, f);
    for (int k = 0; k < mpm_count; k++) {
        int32_t box = 0;
        while (f->bodies.box[box].mpm != k) box++;
        if (f->bodies.first[box + 1] > f->bodies.first[box] &&
            brunt_node_to_facet_particles(m, f, &mpm[k], k, box, constraints, error))
            return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

int brunt_node_to_facet_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, brunt_node_to_facet *f,
                             brunt_constraint_set *constraints, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    for (int k = 0; k < s->fem_count && f->cache.node; k++)
        if (is_anew(s, f, k))
            for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) f->cache.node[n] = (node_distance){0};
    if (!f->penetration.begun && brunt_initial_penetration_begin(&f->penetration, s->node_count, error))
        return BRUNT_FAILED;
    if (f->bodies.pair_count && find_between(m, mpm, mpm_count, f, constraints, error)) return BRUNT_FAILED;
    if (f->penetration.allowed) brunt_initial_penetration_end(&f->penetration, s);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ the way back

typedef struct finish_job {
    brunt_contact_surface *surface;
    brunt_node_to_facet *f;
    const brunt_constraint_set *constraints;
} finish_job;

// What slips anywhere does; several threads may tell it of a node.
static void mark_state(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const finish_job *j = context;
    const brunt_contact_surface *s = j->surface;
    for (int64_t k = begin; k < end; k++) {
        const brunt_constraint *p = &j->constraints->constraint[k];
        if (p->tag < 0 || !(p->normal_impulse > 0)) continue;
        uint8_t *state = &s->output.state[s->membrane.front ? s->membrane.front[p->tag] : p->tag], none = 0;
        if (p->slips || !(p->friction > 0))
            __atomic_store_n(state, 2, __ATOMIC_RELAXED);
        else if (!__atomic_load_n(state, __ATOMIC_RELAXED))
            __atomic_compare_exchange_n(state, &none, 1, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
    }
}

// The front of a membrane tells what is nearest to either side.
static void mark_gaps(brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_end[k]; s->active[k] && n < s->node_range[k + 1]; n++)
            s->output.gap[s->membrane.front[n]] = fmin(s->output.gap[s->membrane.front[n]], s->output.gap[n]);
}

static void finish_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const finish_job *j = context;
    brunt_contact_surface *s = j->surface;
    int k = 0;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        int32_t at = j->f->nodes.dof_of[n];
        while (s->node_range[k + 1] <= n) k++;
        if (at < 0 && j->f->touches.of) brunt_node_forgets(j->f, s, k, n);
        if (at < 0 || (s->membrane.front && s->membrane.front[n] != n)) continue;
        for (int a = 0; a < 3; a++) {
            s->output.impulse[n][a] += j->constraints->dof_node[at].impulse[a];
            if (s->inverse[n][a] > 0) s->v[n][a] = j->constraints->dof_node[at].v[a];
        }
    }
}

void brunt_node_to_facet_finish(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                const brunt_constraint_set *constraints) {
    brunt_contact_surface *s = m->surface;
    finish_job j = {s, f, constraints};
    brunt_parallel(m->threads, s->node_count, GRAIN, finish_nodes, &j, m->timer);
    brunt_node_to_facet_scatter_grids(m, mpm, f, constraints);
    brunt_parallel(m->threads, constraints->constraint_count, GRAIN, mark_state, &j, m->timer);
    if (s->membrane.front) mark_gaps(s);
}
