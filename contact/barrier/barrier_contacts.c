// Which features points and edges touch at u, and how often each counts.
//
// Of facets that a point is near, the sum of b(distance) has what they share several times. It is taken back: an edge
// that k facets hold counts 1 - k, and a vertex 1 - facets + sum over its edges of (k - 1) (2D: facets are edges, a
// vertex counts 1 - facets), so that a point above the inside of a surface feels it once, wherever it is (inclusion and
// exclusion; Li, Kaufman and Jiang 2023, written so that it holds at borders and where several sheets meet). What ends
// at the same feature is one contact, with the sum as its multiplicity; 0 is dropped.
#include "contact/barrier/barrier_parts.h"

static barrier_feature *feature_at(barrier_workspace *r, const int32_t v[3], const barrier_feature *of) {
    for (int64_t i = 0; i < r->feature_count; i++) {
        barrier_feature *f = &r->feature[i];
        if (f->vertex[0] == v[0] && f->vertex[1] == v[1] && f->vertex[2] == v[2]) return f;
    }
    barrier_feature *f = &r->feature[r->feature_count++];
    *f = *of;
    memcpy(f->vertex, v, sizeof f->vertex);
    f->times = 0;
    return f;
}

// Vertices of a region given by bits; `v` ascends.
static void vertices_of(const int32_t *v, int bits, int32_t out[3]) {
    int count = 0;
    out[0] = out[1] = out[2] = -1;
    for (int i = 0; i < 3; i++)
        if (bits >> i & 1) out[count++] = v[i];
}

static barrier_shared *shared_at(barrier_shared *list, int64_t *count, int32_t a, int32_t second,
                                 const barrier_feature *of) {
    for (int64_t i = 0; i < *count; i++)
        if (list[i].a == a && list[i].b == second) return &list[i];
    list[*count] = (barrier_shared){.a = a, .b = second, .law = of->law, .side = of->side, .share = of->share};
    return &list[(*count)++];
}

static void count_shared(const brunt_barrier *b, barrier_workspace *r, const int32_t *f, const barrier_feature *of) {
    for (int i = 0; i < b->dim; i++) shared_at(r->vertex, &r->vertex_count, f[i], -1, of)->facets++;
    if (b->dim == 3)
        for (int i = 0; i < 3; i++) shared_at(r->edge, &r->edge_count, f[i == 2], f[i == 0 ? 1 : 2], of)->facets++;
}

// From inside, what may overlap is seen a way further than it may be deep.
static bool in_range(const brunt_barrier *b, int32_t law, double d) {
    const brunt_barrier_pair *pair = barrier_pair_of(b, law);
    return d - pair->offset < fmax(pair->distance, 2 * pair->reach);
}

// The part of a facet that a point is nearest to, where along a curve, and its distance.
static int region_of(const brunt_barrier *b, int32_t point, const barrier_feature *of, const double *u, double *along,
                     double *d) {
    static const double here[3] = {0};
    const int32_t facet = of->facet;
    const barrier_arc *arc = barrier_arc_of(b, facet);
    double x[BRUNT_CUBIC_PLACES][3];
    const double(*at)[3] = (const double(*)[3])x;
    barrier_relative(b, u, point, arc ? arc->place : b->facet[facet], arc ? arc->curve.places : b->dim, x);
    if (arc) return brunt_closest_of_cubic(here, at, &arc->curve, along, d);
    return b->dim == 3 ? brunt_closest_of_triangle(here, at, d) : brunt_closest_of_edge(here, x[0], x[1], d);
}

// The facets within reach, each at its nearest feature.
static void count_facets(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r) {
    r->feature_count = r->edge_count = r->vertex_count = 0;
    r->clear_of = BRUNT_NONE;
    const int32_t body = barrier_body_of(b, point);
    int32_t other = BRUNT_NONE;
    bool clear = false; // of the other body
    for (int64_t i = b->facets.first[point]; i < b->facets.first[point + 1]; i++) {
        const int32_t *f = b->facet[b->facets.item[i]];
        barrier_feature of = {.facet = b->facets.item[i]};
        double d;
        int32_t v[3];
        if (b->body[f[0]] != other) {
            other = b->body[f[0]];
            clear = b->overlaps && barrier_is_clear_of(b, point, other, u, r);
        }
        if (clear) continue;
        of.law = barrier_law_between(b, body, other, &of.side);
        const int region = region_of(b, point, &of, u, &of.along, &d);
        if (!in_range(b, of.law, d)) continue;
        of.share = barrier_share_of(b, of.law, of.side, false);
        vertices_of(f, region, v);
        feature_at(r, v, &of)->times++;
        count_shared(b, r, f, &of);
    }
}

static double vertex_distance(const brunt_barrier *b, int32_t point, int32_t vertex, const double *u) {
    double x[1][3];
    barrier_relative(b, u, point, &vertex, 1, x);
    return sqrt(x[0][0] * x[0][0] + x[0][1] * x[0][1] + x[0][2] * x[0][2]);
}

// Edges of triangles and what they take back.
static void take_back_edges(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r) {
    static const double here[3] = {0};
    for (int64_t i = 0; i < r->edge_count; i++) {
        const barrier_shared *e = &r->edge[i];
        const int32_t ends[3] = {e->a, e->b, -1};
        const barrier_feature of = {.law = e->law, .side = e->side, .share = e->share};
        double x[2][3], d;
        int32_t v[3];
        shared_at(r->vertex, &r->vertex_count, e->a, -1, &of)->more += e->facets - 1;
        shared_at(r->vertex, &r->vertex_count, e->b, -1, &of)->more += e->facets - 1;
        if (e->facets == 1) continue;
        barrier_relative(b, u, point, ends, 2, x);
        const int region = brunt_closest_of_edge(here, x[0], x[1], &d);
        if (!in_range(b, e->law, d)) continue;
        vertices_of(ends, region, v);
        feature_at(r, v, &of)->times -= e->facets - 1;
    }
}

static void take_back_vertices(const brunt_barrier *b, int32_t point, const double *u, barrier_workspace *r) {
    for (int64_t i = 0; i < r->vertex_count; i++) {
        const barrier_shared *s = &r->vertex[i];
        const int32_t v[3] = {s->a, -1, -1}, times = 1 - s->facets + s->more;
        const barrier_feature of = {.law = s->law, .side = s->side, .share = s->share};
        if (times == 0 || !in_range(b, s->law, vertex_distance(b, point, s->a, u))) continue;
        feature_at(r, v, &of)->times += times;
    }
}

barrier_contact barrier_contact_with(const brunt_barrier *b, int32_t point, const barrier_feature *f, const double *u) {
    static const double here[3] = {0};
    barrier_contact c = {.place = {point, f->vertex[0], f->vertex[1], f->vertex[2]}, .law = f->law, .side = f->side};
    c.offset = barrier_pair_of(b, f->law)->offset;
    c.weight = f->times * f->share * barrier_area_of(b, point);
    const int32_t facet = barrier_arc_met(b, f);
    if (facet >= 0) return barrier_meet_arc(b, f, facet, u, &c), c;
    double x[3][3];
    int count = 1;
    while (count < 3 && f->vertex[count] >= 0) count++;
    barrier_relative(b, u, point, f->vertex, count, x);
    if (count == 1)
        brunt_closest_points(here, x[0], &c.at);
    else if (count == 2)
        brunt_closest_line(here, x[0], x[1], &c.at);
    else
        brunt_closest_plane(here, (const double(*)[3])x, &c.at);
    if (barrier_pair_of(b, f->law)->reach > 0) barrier_sign(b, point, f, u, &c.at);
    return c;
}

static void plane_contacts(const brunt_barrier *b, int32_t point, const double *u, barrier_take *take, void *context) {
    for (int64_t i = b->planes.first[point]; i < b->planes.first[point + 1]; i++) {
        const int32_t k = b->planes.item[i], place = barrier_points(b) + k;
        const brunt_barrier_plane *plane = &b->step.planes[k];
        barrier_contact c = {.place = {point, place, -1, -1}, .law = k, .side = 1};
        double x[1][3];
        barrier_relative(b, u, point, &place, 1, x);
        c.at = (brunt_closest){.places = 2, .flat = true, .w = {1, -1}};
        for (int j = 0; j < b->dim; j++) c.at.d -= plane->normal[j] * x[0][j], c.at.n[j] = plane->normal[j];
        c.weight = barrier_area_of(b, point);
        c.offset = barrier_plane_offset(b, plane, point);
        if (c.at.d - c.offset < plane->distance + b->touch) take(context, &c);
    }
}

// Nearly parallel edges count less, and parallel ones not at all, since their direction jumps; the points at their ends
// see to those (Li et al. 2020): from a thousandth of |ea|^2 |eb|^2, in the reference configuration, on in full.
static const double PARALLEL = 1e-3;

static void edge_contacts(const brunt_barrier *b, int32_t edge, const double *u, barrier_take *take, void *context) {
    const int32_t *e = b->edge[edge];
    for (int64_t i = b->edges.first[edge]; i < b->edges.first[edge + 1]; i++) {
        const int32_t other = b->edges.item[i], *f = b->edge[other];
        barrier_contact c = {.place = {e[0], e[1], f[0], f[1]}};
        double x[4][3];
        c.law = barrier_law_between(b, b->body[e[0]], b->body[f[0]], &c.side);
        barrier_relative(b, u, e[0], c.place, 4, x);
        brunt_closest_edges((const double(*)[3])x, (const double(*)[3])(x + 2), &c.at);
        if (!in_range(b, c.law, c.at.d)) continue;
        c.offset = barrier_pair_of(b, c.law)->offset;
        for (int k = 0; k < 3; k++) c.edge[0][k] = x[1][k] - x[0][k], c.edge[1][k] = x[3][k] - x[2][k];
        c.threshold = PARALLEL * b->edge_length2[edge] * b->edge_length2[other];
        c.weight = barrier_share_of(b, c.law, c.side, true) * (b->edge_area[edge] + b->edge_area[other]) / 2;
        take(context, &c);
    }
}

void barrier_each_contact(const brunt_barrier *b, int64_t task, const double *u, int worker, barrier_take *take,
                          void *context) {
    const int32_t point = b->task[task];
    if (point < 0) {
        edge_contacts(b, -1 - point, u, take, context);
        return;
    }
    barrier_workspace *r = &b->workspace[worker];
    count_facets(b, point, u, r);
    if (b->dim == 3) take_back_edges(b, point, u, r);
    take_back_vertices(b, point, u, r);
    barrier_settle_overlaps(b, point, u, r);
    for (int64_t i = 0; i < r->feature_count; i++) {
        if (r->feature[i].times == 0) continue;
        const barrier_feature *f = &r->feature[i];
        const barrier_contact c = (f->corner ? barrier_contact_within : barrier_contact_with)(b, point, f, u);
        take(context, &c);
    }
    plane_contacts(b, point, u, take, context);
}

typedef struct contacts_work {
    brunt_barrier *b;
    const double *u;
    barrier_contact *list;
} contacts_work;

static void take_contact(void *context, const barrier_contact *c) {
    barrier_workspace *r = context;
    if (BRUNT_CAPACITY_MORE(r->contact, "places of contact", &r->error)) return;
    r->contact[r->contact_count++] = *c;
}

// Each thread keeps what it finds until all have their places.
static void find_contacts(void *context, int64_t begin, int64_t end, int worker) {
    contacts_work *w = context;
    barrier_workspace *r = &w->b->workspace[worker];
    for (int64_t i = begin; i < end; i++) {
        w->b->task_place[i] = (barrier_found){r->contact_count, worker};
        barrier_each_contact(w->b, i, w->u, worker, take_contact, r);
        w->b->task_first[i + 1] = r->contact_count - w->b->task_place[i].at;
        if (w->b->overlaps && w->b->task[i] >= 0) barrier_clear_note(w->b, w->b->task[i], r);
    }
}

static void place_contacts(void *context, int64_t begin, int64_t end, int worker) {
    contacts_work *w = context;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const int64_t first = w->b->task_first[i], count = w->b->task_first[i + 1] - first;
        const barrier_found *from = &w->b->task_place[i];
        if (count)
            memcpy(w->list + first, w->b->workspace[from->worker].contact + from->at, (size_t)count * sizeof *w->list);
    }
}

// What all threads know of points that are clear of bodies.
static int begin_pass(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    if (b->overlaps && barrier_clear_reserve(b, error)) return BRUNT_FAILED;
    const double lost = b->overlaps ? barrier_clear_lost(b, u) : INFINITY;
    for (int t = 0; t < team->threads; t++) b->workspace[t].lost = lost;
    return BRUNT_OK;
}

int barrier_list_contacts(brunt_barrier *b, const brunt_team *team, const double *u, barrier_contacts *list,
                          brunt_error *error) {
    contacts_work work = {.b = b, .u = u};
    list->count = 0;
    if (begin_pass(b, team, u, error)) return BRUNT_FAILED;
    for (int t = 0; t < team->threads; t++) b->workspace[t].contact_count = 0, b->workspace[t].error.code = BRUNT_OK;
    brunt_parallel(team->threads, b->task_count, BARRIER_TASK_GRAIN, find_contacts, &work, team->timer);
    for (int t = 0; t < team->threads; t++)
        if (brunt_hand_on(error, &b->workspace[t].error)) return BRUNT_FAILED;
    b->task_first[0] = 0;
    for (int64_t i = 0; i < b->task_count; i++) b->task_first[i + 1] += b->task_first[i];
    const int64_t count = b->task_first[b->task_count];
    if (BRUNT_CAPACITY(list->contact, (size_t)count + 1, 0, "places of contact", error)) return BRUNT_FAILED;
    list->count = count, work.list = list->contact;
    brunt_parallel(team->threads, b->task_count, BARRIER_GRAIN, place_contacts, &work, team->timer);
    return BRUNT_OK;
}

typedef struct energy_taken {
    const brunt_barrier *b;
    double value, magnitude;
} energy_taken;

static void take_energy(void *context, const barrier_contact *c) {
    energy_taken *t = context;
    const double e = barrier_contact_energy(t->b, c);
    t->value += e, t->magnitude += fabs(e);
}

static void energy_task(void *context, int64_t begin, int64_t end, int worker) {
    contacts_work *w = context;
    for (int64_t i = begin; i < end; i++) {
        energy_taken taken = {.b = w->b};
        barrier_each_contact(w->b, i, w->u, worker, take_energy, &taken);
        w->b->task_energy[i][0] = taken.value, w->b->task_energy[i][1] = taken.magnitude;
    }
}

brunt_energy_sum barrier_sum_energy(brunt_barrier *b, const brunt_team *team, const double *u) {
    contacts_work work = {.b = b, .u = u};
    brunt_energy_sum sum = {0};
    if (begin_pass(b, team, u, &b->unsaid)) return sum;
    brunt_parallel(team->threads, b->task_count, BARRIER_TASK_GRAIN, energy_task, &work, team->timer);
    for (int64_t i = 0; i < b->task_count; i++)
        sum.value += b->task_energy[i][0], sum.magnitude += b->task_energy[i][1];
    if (!(sum.magnitude < INFINITY)) sum.value = INFINITY; // a gap of 0 in a corner: infinities of both signs
    return sum;
}
