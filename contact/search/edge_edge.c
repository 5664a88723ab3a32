// Edges that cross between their nodes: constraints at the nearest points of their lines.
//
// The normal is across both edges, and out of the one body into the other where it is among the normals that both have
// there: between those of the faces at the one edge, and against those at the other. So the edges are where the bodies
// meet, and not a facet or a node beside them.
//
// As n is across both edges however they turn, its rate is that of the two: with E the dual basis of the edges across
// n, dn/dt = -sum (n . de/dt) E, and the velocity that is constrained is
//   u = v_a(s) - v_b(t) - height dn/dt
// which is 0 in every rigid motion of both, whatever the height; along n it is the rate of the lines' distance. Each
// edge's share of the last term stands in its own entries as the gradient of a height.
#include "contact/search/nearest.h"

#include <stdlib.h>

#include "contact/distance/line_crossing.h"

// Square of the sine of the least angle: where edges cross at less, nodes on facets leave less than TOUCH unmet, as
// those at the ends are over the other body's facets but for half an edge times the sine.
static const double LEAST_SINE2 = 4 * 1e-6 * 1e-6;
// Of the sine of the angle: how far a face may rise beyond the plane of both edges. Faces that are flush bend a little
// as they press, and normals of edges that cross at a small angle turn by what they bend over its sine.
static const double FLUSH = 0.05;
static const double BEYOND = 1; // edges: how far beyond its end an edge may be met that comes in within a step

typedef struct edge_pair {
    const feature_edge *edge[2]; // slave, master
    int body[2];
    brunt_line_crossing at;
    double n[3], height, gap, target;
} edge_pair;

// Places of an edge's nodes after `time`.
static void ends_at(const brunt_contact_surface *s, const feature_edge *edge, double time, double out[2][3]) {
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) out[i][a] = s->x[edge->node[i]][a] + time * s->v[edge->node[i]][a];
}

// Whether a share of an edge is between its nodes: what is at one of them is that node's.
static bool between_nodes(double share, double square, double touch) {
    const double length = sqrt(square);
    return share * length > touch && (1 - share) * length > touch;
}

// The unit normal out of the second edge's body; false: the two do not meet as edges.
static bool find_normal(edge_pair *p) {
    const feature_edge *a = p->edge[0], *b = p->edge[1];
    const double sine = sqrt(p->at.sine2), rise = FLUSH * sine / sqrt(p->at.aa * p->at.bb);
    double side = 0;
    for (int k = 0; k < 3; k++) p->n[k] = p->at.n[k] / sine;
    // Rims have no inside: between two of them the side is where they are.
    if (a->rim && b->rim)
        side = dot(p->at.r, p->n);
    else
        side = (b->rim ? 0 : dot(b->out, p->n)) - (a->rim ? 0 : dot(a->out, p->n));
    if (side < 0)
        for (int k = 0; k < 3; k++) p->n[k] = -p->n[k];
    for (int i = 0; i < 2; i++)
        if (dot(a->into[i], p->n) < -rise || dot(b->into[i], p->n) > rise) return false;
    return true;
}

// How far the end of an edge that is further off the other's line is from it [m]: edges that are deeper than either of
// theirs do not cross there but lie side by side, and their nodes are as deep, on facets. Along n they would be parted
// the long way, with a lever on what slips of depth over this way.
static double way_across(const edge_pair *p) {
    const double s = fmax(p->at.s, 1 - p->at.s) / sqrt(p->at.bb), t = fmax(p->at.t, 1 - p->at.t) / sqrt(p->at.aa);
    return fmin(s, t) * sqrt(p->at.sine2);
}

// Velocity along n of the one line's nearest point against the other's.
static double rate(const edge_pair *p, double (*of)[3]) {
    const int32_t *a = p->edge[0]->node, *b = p->edge[1]->node;
    const double s = p->at.s, t = p->at.t;
    return (1 - s) * dot(of[a[0]], p->n) + s * dot(of[a[1]], p->n) - (1 - t) * dot(of[b[0]], p->n) -
           t * dot(of[b[1]], p->n);
}

// Whether the edges cross between their nodes when they come together.
static bool cross_between(const brunt_contact_surface *s, const edge_pair *p, double time) {
    double a[2][3], b[2][3];
    brunt_line_crossing at = p->at;
    const double touch = TOUCH * s->mean_edge;
    if (time > 0) {
        ends_at(s, p->edge[0], time, a), ends_at(s, p->edge[1], time, b);
        if (!brunt_lines_cross(a, b, LEAST_SINE2, &at)) return false;
    }
    return between_nodes(at.s, at.aa, touch) && between_nodes(at.t, at.bb, touch);
}

// The nodes of both edges; first the one that has most of the crossing: what touches take is kept there.
static touched_edges touch_of(const edge_pair *p) {
    const bool second = fabs(p->at.s - 0.5) < fabs(p->at.t - 0.5);
    const int32_t *own = p->edge[second]->node, *other = p->edge[!second]->node;
    const int at = (second ? p->at.t : p->at.s) < 0.5 ? 0 : 1;
    return (touched_edges){{own[at], own[!at], other[0], other[1]}, {p->body[second], p->body[!second]}};
}

// Whether a touch of edges about here has something to be given back.
static bool holds(const brunt_node_to_facet *f, const edge_pair *p) {
    const touched_edges touch = touch_of(p);
    bool any = false;
    for (int i = 0; i < 4; i++) {
        any = any || brunt_node_holds(&f->touches, touch.node[i], TOUCHED_EDGE);
        any = any || brunt_node_holds(&f->touches, touch.node[i], TOUCHED_FACET);
    }
    return any;
}

// The gap beyond what edges that cross since they met may lie in each other.
static double gap_beyond(const brunt_contact_surface *s, brunt_node_to_facet *f, const edge_pair *p) {
    const int32_t *a = p->edge[0]->node, *b = p->edge[1]->node, node[4] = {a[0], a[1], b[0], b[1]};
    if (!f->penetration.allowed || !(p->gap > 0 || cross_between(s, p, 0))) return p->gap;
    return brunt_initial_penetration_meet(&f->penetration, node, 4, p->gap);
}

// Whether two edges meet within the step, and how.
static bool edges_meet(const brunt_contact_context *m, brunt_node_to_facet *f, edge_pair *p) {
    const double travel = f->bodies.travel;
    const brunt_contact_surface *s = m->surface;
    double a[2][3], b[2][3];
    ends_at(s, p->edge[0], 0, a), ends_at(s, p->edge[1], 0, b);
    if (!brunt_lines_cross(a, b, LEAST_SINE2, &p->at)) return false;
    if (fabs(p->at.s - 0.5) > 0.5 + BEYOND || fabs(p->at.t - 0.5) > 0.5 + BEYOND || !find_normal(p)) return false;
    p->gap = p->height = dot(p->at.r, p->n);
    for (int i = 0; s->membrane.side && i < 2; i++) p->gap -= s->membrane.side[p->body[i]].half;
    if (p->gap > travel || p->gap < -fmin(p->edge[0]->depth, p->edge[1]->depth)) return false;
    if (p->gap < -way_across(p)) return false;
    const double approach = rate(p, s->v);
    const double gap[2] = {p->gap, gap_beyond(s, f, p)};
    p->target = brunt_node_to_facet_target(s, gap, approach, p->gap < 0 ? rate(p, s->old) : 0, m->dt);
    if (!(approach < p->target + TOUCH * s->mean_edge / m->dt) && !holds(f, p)) return false;
    return cross_between(s, p, p->gap > 0 && approach < 0 ? fmin(p->gap / -approach, m->dt) : 0);
}

static int add_entry(const brunt_contact_surface *s, brunt_node_to_facet *f, int32_t node, double weight,
                     const double gradient[3], brunt_constraint_set *constraints, brunt_error *error) {
    const int32_t dof_node = brunt_node_to_facet_dof_node(f, s, node, constraints, error);
    const int32_t entry = dof_node < 0 ? BRUNT_NONE : brunt_constraints_entry(constraints, dof_node, weight, error);
    if (entry < 0) return BRUNT_FAILED;
    memcpy(constraints->entry[entry].height_gradient, gradient, sizeof constraints->entry[entry].height_gradient);
    return BRUNT_OK;
}

static int add_constraint(const brunt_contact_context *m, brunt_node_to_facet *f, const edge_pair *p,
                          brunt_constraint_set *constraints, brunt_error *error) {
    brunt_contact_surface *s = m->surface;
    const int32_t at = brunt_constraints_add(constraints, error);
    if (at < 0) return BRUNT_FAILED;
    brunt_constraint *constraint = &constraints->constraint[at];
    const int32_t *a = p->edge[0]->node, *b = p->edge[1]->node;
    const facet_candidate master = {.body = p->body[1], .gap = p->gap, .n = {p->n[0], p->n[1], p->n[2]}};
    double x[3], dual[2][3];
    const double ab = dot(p->at.ea, p->at.eb);
    for (int k = 0; k < 3; k++) {
        x[k] = (1 - p->at.s) * s->x[a[0]][k] + p->at.s * s->x[a[1]][k];
        dual[0][k] = (p->at.bb * p->at.ea[k] - ab * p->at.eb[k]) / p->at.sine2;
        dual[1][k] = (p->at.aa * p->at.eb[k] - ab * p->at.ea[k]) / p->at.sine2;
    }
    brunt_node_to_facet_constraint(m, &master, x, p->body[0], constraint);
    constraint->turns = true;
    memcpy(constraint->facet, p->n, sizeof constraint->facet);
    constraint->target = p->target;
    constraint->tag = p->at.s < 0.5 ? a[0] : a[1];
    if (!s->membrane.side || !(s->membrane.side[p->body[0]].faces || s->membrane.side[p->body[1]].faces)) {
        const touched_edges touch = touch_of(p);
        constraint->partner = touch.body[1] + 1;
        constraint->touch = brunt_node_touch(&f->touches, touch.node[0], TOUCHED_EDGE);
        if (constraint->touch && brunt_node_touches_cross(&f->touches, &touch, error)) return BRUNT_FAILED;
    }
    for (int i = 0; i < 4; i++) {
        const int32_t node = i < 2 ? a[i] : b[i - 2];
        const double share = i < 2 ? p->at.s : p->at.t, weight = i % 2 ? share : 1 - share,
                     height = i % 2 ? p->height : -p->height, *way = dual[i / 2],
                     gradient[3] = {height * way[0], height * way[1], height * way[2]};
        if (add_entry(s, f, node, i < 2 ? weight : -weight, gradient, constraints, error)) return BRUNT_FAILED;
        s->output.gap[node] = fmin(s->output.gap[node], p->gap);
    }
    return BRUNT_OK;
}

static int by_low(const void *a, const void *b) {
    const edge_span *p = a, *q = b;
    return p->low < q->low ? -1 : p->low > q->low ? 1 : p->feature - q->feature;
}

// What two bodies share, and its longest axis.
typedef struct shared_box {
    double low[3], high[3];
    int axis;
} shared_box;

// The room that two bodies share within `travel`. Whether there is any.
static bool find_shared_box(const body_box *a, const body_box *b, double travel, shared_box *shared) {
    double *low = shared->low, *high = shared->high;
    shared->axis = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = fmax(a->low[k], b->low[k]) - travel, high[k] = fmin(a->high[k], b->high[k]) + travel;
        if (low[k] > high[k]) return false;
        if (high[k] - low[k] > high[shared->axis] - low[shared->axis]) shared->axis = k;
    }
    return true;
}

// Features of body k in a room, by their low ends; `longest`: of their spans, and how deep they are met. Their count.
static int32_t list_spans(const near_edges *edges, int k, const shared_box *shared, edge_span *out, double *longest) {
    const int axis = shared->axis;
    int32_t count = 0;
    *longest = 0;
    for (int32_t i = edges->feature_first[2 * k]; i < edges->feature_first[2 * k + 1]; i++) {
        const feature_edge *edge = &edges->feature[i];
        bool outside = false;
        for (int a = 0; a < 3; a++)
            outside = outside || edge->low[a] > shared->high[a] || edge->high[a] < shared->low[a];
        if (outside) continue;
        *longest = fmax(*longest, edge->high[axis] - edge->low[axis] + edge->depth);
        out[count++] = (edge_span){edge->low[axis], edge->high[axis], i};
    }
    qsort(out, (size_t)count, sizeof *out, by_low);
    return count;
}

static bool edges_near(const feature_edge *a, const feature_edge *b, double travel) {
    const double by = travel + fmin(a->depth, b->depth);
    for (int k = 0; k < 3; k++)
        if (a->low[k] - by > b->high[k] || b->low[k] - by > a->high[k]) return false;
    return true;
}

// Meshes a and b of the surface, a before b, in the room that they share.
static int bodies_meet(const brunt_contact_context *m, brunt_node_to_facet *f, const int fem[2],
                       const shared_box *shared, brunt_constraint_set *constraints, brunt_error *error) {
    near_edges *edges = &f->edges;
    const double travel = f->bodies.travel;
    double longest, unused;
    if (RESERVE(edges, span, edges->feature_count + 1, "edges that meet", error)) return BRUNT_FAILED;
    edge_span *const a = edges->span;
    const int32_t a_count = list_spans(edges, fem[0], shared, a, &unused);
    if (!a_count) return BRUNT_OK;
    edge_span *const b = a + a_count;
    const int32_t b_count = list_spans(edges, fem[1], shared, b, &longest);
    for (int32_t i = 0, first = 0; i < a_count; i++) {
        const feature_edge *slave = &edges->feature[a[i].feature];
        while (first < b_count && b[first].low < a[i].low - longest - travel) first++;
        for (int32_t k = first; k < b_count && b[k].low <= a[i].high + travel + slave->depth; k++) {
            const feature_edge *master = &edges->feature[b[k].feature];
            edge_pair p = {.edge = {slave, master},
                           .body = {m->surface->fem[fem[0]]->index, m->surface->fem[fem[1]]->index}};
            if (!edges_near(slave, master, travel) || !edges_meet(m, f, &p)) continue;
            if (add_constraint(m, f, &p, constraints, error)) return BRUNT_FAILED;
        }
    }
    return BRUNT_OK;
}

static int find_crossings(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_constraint_set *constraints,
                          brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    if (RESERVE(&f->edges, feature_first, 2 * (size_t)s->fem_count, "bodies with edges that meet", error))
        return BRUNT_FAILED;
    memset(f->edges.feature_first, 0xff, 2 * (size_t)s->fem_count * sizeof *f->edges.feature_first); // -1
    f->edges.feature_count = 0;
    for (int32_t p = 0; p < f->bodies.pair_count; p++) {
        const body_box *a = &f->bodies.box[f->bodies.pair[p].a], *b = &f->bodies.box[f->bodies.pair[p].b];
        if (a->fem < 0 || b->fem < 0 || a == b) continue;
        shared_box shared;
        if (!find_shared_box(a, b, f->bodies.travel, &shared)) continue;
        const int fem[2] = {a->fem < b->fem ? a->fem : b->fem, a->fem < b->fem ? b->fem : a->fem};
        if (brunt_feature_edges_list(m, f, fem[0], error) || brunt_feature_edges_list(m, f, fem[1], error))
            return BRUNT_FAILED;
        if (bodies_meet(m, f, fem, &shared, constraints, error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

int brunt_edge_edge_find(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_constraint_set *constraints,
                         brunt_error *error) {
    f->touches.edges_count = 0;
    if (f->edges.near_count && find_crossings(m, f, constraints, error)) return BRUNT_FAILED;
    return brunt_node_touches_hand_over(&f->touches, f->nodes.count, error);
}
