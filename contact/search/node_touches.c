#include "contact/search/node_touches.h"

#include "contact/search/node_to_facet_parts.h"

// Mean edges: beyond, a node has left what it touched. Where less is searched it keeps what it holds until the bodies
// part: lost at 0.2 edges it cost hexahedra 0.1 to 0.3 % of their energy, as nodes that leave come back.
static const double FAR = 0.5;

void brunt_node_touches_free(node_touches *t) {
    brunt_free(t->of);
    brunt_free(t->spare);
    brunt_free(t->edges);
    brunt_free(t->keeper);
}

int brunt_node_touches_make(brunt_node_to_facet *f, int32_t nodes, brunt_error *error) {
    node_touches *t = &f->touches;
    if (t->of) return BRUNT_OK;
    if (RESERVE(t, of, nodes + 1, "touches of nodes", error)) return BRUNT_FAILED;
    memset(t->of, 0, (size_t)nodes * sizeof *t->of);
    return BRUNT_OK;
}

// What slides past a rim is in no constraint for a while, and comes back.
void brunt_node_forgets(brunt_node_to_facet *f, const brunt_contact_surface *s, int k, int32_t n) {
    const node_distance *cached = &f->cache.node[n];
    brunt_touch_energy *of = f->touches.of[n];
    of[TOUCHED_PLANE].held = 0;
    if (!s->active[k] || cached->distance - cached->since > FAR * s->mean_edge)
        of[TOUCHED_FACET].held = of[TOUCHED_EDGE].held = 0;
}

int brunt_node_touches_cross(node_touches *t, const touched_edges *edges, brunt_error *error) {
    const size_t used = (size_t)t->edges_count;
    if (BRUNT_CAPACITY(t->edges, used + 1, used, "edges that touch", error)) return BRUNT_FAILED;
    t->edges[t->edges_count++] = *edges;
    return BRUNT_OK;
}

static int add_keeper(node_touches *t, int32_t n, brunt_error *error) {
    const size_t used = (size_t)t->keeper_count;
    if (BRUNT_CAPACITY(t->keeper, used + 1, used, "nodes of edges that touch", error)) return BRUNT_FAILED;
    t->keeper[t->keeper_count++] = n;
    return BRUNT_OK;
}

static void mark_edges(const node_touches *t) {
    const touched_edges *const end = t->edges + t->edges_count;
    for (int32_t q = 0; q < t->keeper_count; q++) t->of[t->keeper[q]][TOUCHED_EDGE].met = NONE_TOUCH;
    for (const touched_edges *p = t->edges; p < end; p++)
        for (int i = 0; i < 4; i++) {
            brunt_touch_energy *of = t->of[p->node[i]];
            of[TOUCHED_EDGE].met = NONE_TOUCH, of[TOUCHED_EDGE].claims = of[TOUCHED_FACET].claims = 0;
        }
    for (const touched_edges *p = t->edges; p < end; p++) {
        brunt_touch_energy *own = &t->of[p->node[0]][TOUCHED_EDGE];
        const int32_t partner = p->body[1] + 1;
        const bool first = own->met == NONE_TOUCH, ours = first ? is_of(own, partner) : own->partner == partner;
        if (first && own->held == 0) own->partner = partner;
        own->met = ours && own->met != CONTESTED ? TOUCHES : CONTESTED;
    }
}

// What node i of edges that touch holds of the other body, where neither edges of this step keep anything nor, of what
// is held of facets, it is on one. NULL: nothing that could go to where theirs is kept.
static brunt_touch_energy *left_at(const node_touches *t, const touched_edges *edges, int i, touched what,
                                   const uint8_t *constraints_of_node) {
    brunt_touch_energy *left = &t->of[edges->node[i]][what];
    const bool stays = what == TOUCHED_EDGE ? left->met != NONE_TOUCH : constraints_of_node[edges->node[i]] > 0;
    if (stays || left->held == 0 || !is_of(left, edges->body[i < 2] + 1)) return NULL;
    return t->of[edges->node[0]][TOUCHED_EDGE].met == TOUCHES ? left : NULL;
}

// What is left at the nodes of edges that touch goes to these, in equal shares whatever their order.
static void give_to_edges(const node_touches *t, const uint8_t *constraints_of_node) {
    for (touch_round round = TOUCH_CLAIM; round < TOUCH_ROUNDS; round++)
        for (int32_t p = 0; p < t->edges_count; p++)
            for (int k = 0; k < 8; k++) {
                const touched_edges *edges = &t->edges[p];
                brunt_touch_energy *own = &t->of[edges->node[0]][TOUCHED_EDGE];
                brunt_touch_energy *left =
                    left_at(t, edges, k / 2, k % 2 ? TOUCHED_FACET : TOUCHED_EDGE, constraints_of_node);
                if (!left) continue;
                if (round == TOUCH_CLAIM) left->claims++;
                if (round == TOUCH_TAKE) own->held += left->held / left->claims, own->partner = edges->body[1] + 1;
                if (round == TOUCH_CLEAR) left->held = 0, left->claims = 0;
            }
}

// A touch that slides along an edge comes to be nearest to another node, edges that flatten are edges no more, and a
// node that leaves a facet may be on its rim: what was taken goes with the touch, unless another one is where it is
// kept.
int brunt_node_touches_hand_over(node_touches *t, const uint8_t *constraints_of_node, brunt_error *error) {
    mark_edges(t);
    give_to_edges(t, constraints_of_node);
    int32_t kept = 0;
    for (int32_t q = 0; q < t->keeper_count; q++) {
        const int32_t n = t->keeper[q];
        brunt_touch_energy *edge = &t->of[n][TOUCHED_EDGE], *facet = &t->of[n][TOUCHED_FACET];
        if (edge->met != NONE_TOUCH) continue;
        if (constraints_of_node[n] && is_of(facet, edge->partner))
            facet->held += edge->held, facet->partner = edge->partner, edge->held = 0;
        if (edge->held != 0) t->keeper[kept++] = n;
    }
    t->keeper_count = kept;
    for (int32_t p = 0; p < t->edges_count; p++) {
        brunt_touch_energy *own = &t->of[t->edges[p].node[0]][TOUCHED_EDGE];
        if (own->met != LISTED && add_keeper(t, t->edges[p].node[0], error)) return BRUNT_FAILED;
        own->met = LISTED;
    }
    return BRUNT_OK;
}

// Anew, from what all nodes hold.
static int list_keepers(node_touches *t, int32_t nodes, brunt_error *error) {
    t->keeper_count = 0;
    for (int32_t n = 0; n < nodes; n++)
        if (t->of[n][TOUCHED_EDGE].held != 0 && add_keeper(t, n, error)) return BRUNT_FAILED;
    return BRUNT_OK;
}

// Those of a surface that was renewed, in its order; nodes that are new have taken nothing.
int brunt_node_touches_renew(node_touches *t, const brunt_contact_surface *s, brunt_error *error) {
    const brunt_surface_change *change = &s->renewal.change;
    const size_t nodes = (size_t)s->node_count;
    if (!t->of) return BRUNT_OK;
    if (BRUNT_CAPACITY(t->of, nodes + 1, (size_t)change->node_count, "touches of nodes", error) ||
        BRUNT_CAPACITY(t->spare, nodes + 1, 0, "touches of nodes", error))
        return BRUNT_FAILED;
    memset(t->spare, 0, nodes * sizeof *t->spare);
    for (size_t n = 0; n < nodes; n++)
        if (change->node_was[n] >= 0) memcpy(t->spare[n], t->of[change->node_was[n]], sizeof *t->of);
    memcpy(t->of, t->spare, nodes * sizeof *t->of);
    return list_keepers(t, s->node_count, error);
}

double brunt_node_to_facet_held(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    double sum = 0;
    for (int k = 0; f && f->touches.of && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; s->motion.was_active[k] && n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++) sum += f->touches.of[n][what].held;
    return sum;
}

// What is held of each, and then of whom it is. Checkpoints of before have the first half alone: it is of anyone.
int64_t brunt_node_touches_state_count(const brunt_contact_surface *s) {
    return 2 * TOUCHED_COUNT * brunt_surface_slots(s);
}

void brunt_node_touches_state_get(const brunt_node_to_facet *f, const brunt_contact_surface *s, double *out) {
    const int64_t held = TOUCHED_COUNT * brunt_surface_slots(s);
    memset(out, 0, (size_t)brunt_node_touches_state_count(s) * sizeof *out);
    for (int k = 0; f && f->touches.of && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++) {
                const brunt_touch_energy *touch = &f->touches.of[n][what];
                const int64_t at = TOUCHED_COUNT * brunt_surface_slot(s, k, n) + what;
                out[at] = touch->held, out[held + at] = touch->held != 0 ? touch->partner : 0;
            }
}

int brunt_node_touches_state_set(brunt_node_to_facet *f, const brunt_contact_surface *s, const double *in,
                                 int64_t count, brunt_error *error) {
    const int64_t held = TOUCHED_COUNT * brunt_surface_slots(s);
    if (brunt_node_touches_make(f, s->node_count, error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++) {
                const int64_t at = TOUCHED_COUNT * brunt_surface_slot(s, k, n) + what;
                f->touches.of[n][what] =
                    (brunt_touch_energy){.held = in[at], .partner = count > held ? (int32_t)in[held + at] : 0};
            }
    return list_keepers(&f->touches, s->node_count, error);
}

void brunt_node_touches_validate(const node_touches *t, int32_t nodes) {
    if (!t->of) return;
    BRUNT_ASSERT(brunt_array_holds(t->of, t->of_capacity, sizeof *t->of, (size_t)nodes));
    for (int32_t n = 0; n < nodes; n++)
        for (int what = 0; what < TOUCHED_COUNT; what++) BRUNT_ASSERT(isfinite(t->of[n][what].held));
}
