#include "contact/search/node_to_facet_parts.h"

#include "contact/distance/point_facet.h"
#include "mpm/particles.h"
#include "base/parallel.h"
#include "mpm/mpm_body.h"

enum { GRAIN = 64 };
static const double SHALLOW = 0.02; // mean edges: depths that may be pushed out against a load
static const double PUSH = 0.2;     // share of a penetration that is pushed out in a step ...
static const double BOUNCE = 0.5;   // ... but no faster than this share of the approach, so that it adds no energy

// ------------------------------------------------------------------------------------------ boundary nodes

typedef struct job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_constraint_set *points;
    int32_t entry_base, point_base;
} job;

// Least velocity along the normal: to arrive at the surface, not past it. What is behind it is pushed out, but no
// faster than half as fast as it came, by which no impact gains energy. What rests comes anew each step, as the load
// brings it: pushing that out does work, and is only done over the small depths that unfinished sweeps leave; deeper
// ones wait until they part by themselves.
double brunt_node_to_facet_target(const brunt_contact_surface *s, double gap, double approach, double before,
                                  double dt) {
    if (gap >= 0) return -gap / dt;
    double came = gap > -SHALLOW * s->mean_edge ? approach : before;
    return fmin(PUSH * -gap / dt, BOUNCE * fmax(0, -came));
}

// Velocity of x relative to the facet under it, along n.
double brunt_node_to_facet_approach(const brunt_contact_surface *s, const hit *h, const double x[3], const double v[3],
                                    double (*of)[3]) {
    double weight[4], along = dot(v, h->n);
    if (h->feature.triangles) {
        brunt_master m;
        brunt_node_to_facet_master(s, h, x, &m);
        for (int c = 0; c < m.count; c++) along -= m.weight[c] * dot(of[m.node[c]], h->n);
        return along;
    }
    const int32_t *node = h->feature.any ? h->feature.end : s->face[h->face];
    const int count = h->feature.any ? 2 : face_corners(s, h->face);
    if (h->feature.any)
        brunt_feature_values(s, &h->feature, x, weight);
    else
        brunt_face_values(s, h->face, h->triangle, x, weight);
    for (int c = 0; c < count; c++) along -= weight[c] * dot(of[node[c]], h->n);
    return along;
}

// What a node needs to look at sheets, or as one.
static void look_at_sheets(const brunt_contact_surface *s, int32_t n, looker *l) {
    const brunt_side *side = &s->side[s->body[n]];
    l->sheet = side->faces > 0, l->half = side->half, l->shallow = side->shallow;
    if (!s->ring_first) return;
    const int32_t first = s->ring_first[s->front[n]];
    l->ring = s->ring_face + first, l->ring_count = s->ring_first[s->front[n] + 1] - first;
}

// Keeps what a feature bears with, which is made once.
static void keep_master(brunt_node_to_facet *f, const brunt_contact_surface *s, hit *h, const double x[3], int worker) {
    struct masters *of = &f->masters[worker];
    const size_t used = (size_t)of->count;
    of->failed = of->failed || BRUNT_RESERVE_IN(of->master, of->capacity, used + 1, used);
    if (of->failed) return;
    h->worker = worker, h->master = of->count;
    brunt_node_to_facet_master(s, h, x, &of->master[of->count++]);
}

static void find_node(const job *j, int k, int32_t n, int worker) {
    const brunt_contact_context *m = j->m;
    brunt_node_to_facet *f = j->f;
    brunt_contact_surface *s = m->skin;
    slave_hits seen, *found = &seen;
    const double *normal = s->normal[n];
    bool faces = normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
    struct quiet *quiet = &f->quiet[n];
    const double since = f->travelled - quiet->travelled;
    if (quiet->distance - since > f->reach) return;
    if (s->front && s->front[n] != n && s->face_first[n + 1] == s->face_first[n]) return; // a loose node has one side
    if (!(since < quiet->second &&
          brunt_node_to_facet_still_nearest(m, f, n, faces ? normal : NULL, quiet->second - since, found))) {
        looker l = {.box = f->box_of[k], .body = s->body[n], .x = s->x[n], .normal = faces ? normal : NULL};
        if (s->side) look_at_sheets(s, n, &l);
        quiet->travelled = f->travelled, quiet->distance = f->range, quiet->second = 0;
        if (!brunt_node_to_facet_look(f, &l)) {
            if (l.touches) quiet->distance = 0; // near, but outside the cells
            return;
        }
        brunt_node_to_facet_look_around(m, f, &l, f->last[n], found, &quiet->distance, &quiet->second);
        if (l.touches == BRUNT_MAX_NEAR)
            quiet->distance = quiet->second = 0; // there may be more bodies than were looked at
        if (found->count) f->last[n] = found->hits[0].face;
    }
    int32_t kept = 0;
    for (int32_t q = 0; q < found->count; q++) {
        hit *h = &found->hits[q];
        if (h->gap > f->reach) continue;
        s->gap[n] = fmin(s->gap[n], h->gap);
        double approach = brunt_node_to_facet_approach(s, h, s->x[n], s->v[n], s->v);
        h->target = brunt_node_to_facet_target(
            s, h->gap, approach, h->gap < 0 ? brunt_node_to_facet_approach(s, h, s->x[n], s->old[n], s->old) : 0,
            m->dt);
        if (!(approach < h->target + 1e-6 * s->mean_edge / m->dt)) continue;
        if (h->feature.any) keep_master(f, s, h, s->x[n], worker);
        f->hits[BRUNT_MAX_HITS * n + kept++] = *h;
    }
    f->found[n] = (uint8_t)kept;
}

static void find_nodes(void *context, int64_t begin, int64_t end, int worker) {
    const job *j = context;
    const brunt_contact_surface *s = j->m->skin;
    const brunt_node_to_facet *f = j->f;
    int k = 0;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        while (s->node_range[k + 1] <= n) k++;
        j->f->found[n] = 0;
        if (s->active[k] && f->near_first[f->box_of[k] + 1] > f->near_first[f->box_of[k]]) find_node(j, k, n, worker);
    }
}

void brunt_node_to_facet_point(const brunt_contact_context *m, const hit *h, const double x[3], int body,
                               brunt_constraint *point) {
    brunt_pair *pair = &m->pairs[m->pair_of[body * m->body_count + h->body]];
    memcpy(point->x, x, sizeof point->x);
    memcpy(point->n, h->n, sizeof point->n);
    point->gap = h->gap;
    point->friction = pair->friction;
    point->action = &pair->last;
    point->sign = body > h->body ? 1 : -1;
}

int brunt_node_to_facet_master(const brunt_contact_surface *s, const hit *h, const double x[3], brunt_master *m) {
    if (h->feature.any) {
        memcpy(m->facet, h->n, sizeof m->facet);
        return m->count = brunt_feature_weights(s, &h->feature, h->n, x, m->node, m->weight, m->gradient, &m->height);
    }
    memcpy(m->node, s->face[h->face], sizeof s->face[h->face]);
    brunt_face_weights(s, h->face, h->triangle, x, m->weight, m->gradient, m->facet, &m->height);
    return m->count = face_corners(s, h->face);
}

void brunt_node_to_facet_entries(const brunt_node_to_facet *f, const brunt_master *m, brunt_constraint *point,
                                 brunt_constraint_entry *entry) {
    memcpy(point->facet, m->facet, sizeof point->facet);
    for (int c = 0; c < m->count; c++) {
        entry[c].support = f->support_of[m->node[c]];
        for (int a = 0; a < 3; a++)
            entry[c].weight[a] = -m->weight[c], entry[c].turn[a] = m->height * m->gradient[c][a];
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

static const brunt_master *kept_master(const brunt_node_to_facet *f, const hit *h) {
    return &f->masters[h->worker].master[h->master];
}

static void fill_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_context *m = j->m;
    const brunt_contact_surface *s = m->skin;
    brunt_node_to_facet *f = j->f;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        int32_t at = f->first_point[2 * n], entry = f->first_point[2 * n + 1];
        for (int32_t q = 0; q < f->found[n]; q++, at++) {
            const hit *h = &f->hits[BRUNT_MAX_HITS * n + q];
            brunt_constraint *point = &j->points->point[at];
            brunt_master plain;
            const brunt_master *master = h->feature.any ? kept_master(f, h) : &plain;
            if (!h->feature.any) brunt_node_to_facet_master(s, h, s->x[n], &plain);
            *point = (brunt_constraint){.first = entry, .count = 1 + master->count, .tag = n};
            brunt_node_to_facet_point(m, h, s->x[n], s->body[n], point);
            point->area = 0.5 * brunt_node_to_facet_area(s, n, h->n); // the other half is counted on the other side
            j->points->entry[entry] = (brunt_constraint_entry){.support = f->support_of[n], .weight = {1, 1, 1}};
            brunt_node_to_facet_entries(f, master, point, j->points->entry + entry + 1);
            point->target = h->target;
            entry += point->count;
        }
    }
}

// The support of a skin node, made when it is first asked for. -1: out of memory.
int32_t brunt_node_to_facet_support(brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n,
                                    brunt_constraint_set *points) {
    if (f->support_of[n] >= 0) return f->support_of[n];
    if (s->front && s->front[n] != n) return f->support_of[n] = brunt_node_to_facet_support(f, s, s->front[n], points);
    int32_t at = brunt_constraints_dof_node(points);
    if (at < 0) return -1;
    brunt_dof_node *support = &points->support[at];
    memcpy(support->v, s->v[n], sizeof support->v);
    memcpy(support->old, s->old[n], sizeof support->old);
    memcpy(support->inverse, s->inverse[n], sizeof support->inverse);
    return f->support_of[n] = at;
}

static int add_nodes(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_constraint_set *points) {
    const brunt_contact_surface *s = m->skin;
    int32_t point = points->point_count, entry = points->entry_count;
    if (RESERVE(f, first_point, 2 * (size_t)s->node_count + 2)) return -1;
    for (int32_t n = 0; n < s->node_count; n++) {
        f->first_point[2 * n] = point, f->first_point[2 * n + 1] = entry;
        for (int32_t q = 0; q < f->found[n]; q++) {
            const hit *h = &f->hits[BRUNT_MAX_HITS * n + q];
            const brunt_master *feature = h->feature.any ? kept_master(f, h) : NULL;
            const int32_t *node = feature ? feature->node : s->face[h->face];
            const int count = feature ? feature->count : face_corners(s, h->face);
            if (brunt_node_to_facet_support(f, s, n, points) < 0) return -1;
            for (int c = 0; c < count; c++)
                if (brunt_node_to_facet_support(f, s, node[c], points) < 0) return -1;
            point++, entry += 1 + count;
        }
    }
    if (brunt_constraints_reserve(points, point, entry)) return -1;
    points->point_count = point, points->entry_count = entry;
    job j = {.m = m, .f = f, .points = points};
    brunt_parallel(m->threads, s->node_count, GRAIN, fill_nodes, &j, m->timer);
    return 0;
}

static int look_from_nodes(job *j) {
    const brunt_contact_context *m = j->m;
    brunt_node_to_facet *f = j->f;
    if (!f->masters && !(f->masters = brunt_alloc((size_t)m->threads * sizeof *f->masters))) return -1;
    f->masters_count = m->threads;
    for (int t = 0; t < m->threads; t++) f->masters[t].count = 0;
    brunt_parallel(m->threads, m->skin->node_count, GRAIN, find_nodes, j, m->timer);
    for (int t = 0; t < m->threads; t++)
        if (f->masters[t].failed) return -1;
    return 0;
}

int brunt_node_to_facet_find(const brunt_contact_context *m, brunt_body *mpm, int mpm_count, brunt_node_to_facet *f,
                             brunt_constraint_set *points) {
    const brunt_contact_surface *s = m->skin;
    f->travelled += 2 * s->moved;
    if (!(f->travelled < 1e300)) { // somebody new: nothing is known of distances
        f->travelled = 0;
        for (int32_t n = 0; f->quiet && n < s->node_count; n++) f->quiet[n] = (struct quiet){0};
    }
    if (!f->near_count) return 0;
    if (brunt_search_cells(m, f)) return -1;
    job j = {.m = m, .f = f, .points = points};
    if (look_from_nodes(&j) || add_nodes(m, f, points)) return -1;
    for (int k = 0; k < mpm_count; k++) {
        int32_t box = 0;
        while (f->box[box].mpm != k) box++;
        if (f->near_first[box + 1] > f->near_first[box] && brunt_node_to_facet_particles(m, f, &mpm[k], k, box, points))
            return -1;
    }
    return 0;
}

// ------------------------------------------------------------------------------------------ the way back

static void note_state(brunt_contact_surface *s, const brunt_constraint_set *points) {
    for (int32_t k = 0; k < points->point_count; k++) {
        const brunt_constraint *p = &points->point[k];
        if (p->tag < 0 || !(p->push > 0)) continue;
        uint8_t *state = &s->state[s->front ? s->front[p->tag] : p->tag];
        bool slips = p->slips || !(p->friction > 0);
        if (slips)
            *state = 2;
        else if (!*state)
            *state = 1;
    }
}

// The front of a sheet tells what is nearest to either side.
static void note_gaps(brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_end[k]; s->active[k] && n < s->node_range[k + 1]; n++)
            s->gap[s->front[n]] = fmin(s->gap[s->front[n]], s->gap[n]);
}

void brunt_node_to_facet_finish(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                const brunt_constraint_set *points) {
    brunt_contact_surface *s = m->skin;
    for (int32_t n = 0; n < s->node_count; n++) {
        int32_t at = f->support_of[n];
        if (at < 0 || (s->front && s->front[n] != n)) continue;
        for (int a = 0; a < 3; a++) {
            s->impulse[n][a] += points->support[at].impulse[a];
            if (s->inverse[n][a] > 0) s->v[n][a] = points->support[at].v[a];
        }
    }
    brunt_node_to_facet_give_grids(m, mpm, f, points);
    note_state(s, points);
    if (s->front) note_gaps(s);
}
