// What the search remembers of nodes from step to step: the nearest facet, and how far all others are.
#include "contact/search/node_to_facet_parts.h"

// Room for what is remembered of so many nodes.
int brunt_distance_cache_fit(brunt_node_to_facet *f, int32_t nodes, int32_t kept, brunt_error *error) {
    return RESERVE(&f->nodes, count, nodes + 1, "nodes that look for facets", error) ||
                   RESERVE(&f->nodes, candidate, BRUNT_MAX_CANDIDATES * (nodes + 1), "facets near nodes", error) ||
                   BRUNT_CAPACITY(f->cache.nearest, (size_t)nodes + 1, (size_t)kept, "nearest facets of nodes",
                                  error) ||
                   RESERVE(&f->cache, node, nodes + 1, "distances of nodes", error) ||
                   RESERVE(&f->cache, beside, nodes + 1, "facets beside nodes", error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// Distances are to facets that may be gone, so that all look anew. A face that was the nearest and is still there
// is looked at first as before.
int brunt_node_to_facet_renew(brunt_node_to_facet *f, const brunt_contact_surface *s, brunt_error *error) {
    const brunt_surface_change *c = &s->renewal.change;
    if (!f || !c->any) return BRUNT_OK;
    if (brunt_distance_cache_fit(f, s->node_count, c->node_count, error) ||
        brunt_node_touches_renew(&f->touches, s, error) || brunt_initial_penetration_renew(&f->penetration, s, error) ||
        RESERVE(&f->cache, spare, s->node_count + 1, "nearest facets of nodes", error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < s->node_count; n++) {
        const int32_t face = c->node_was[n] < 0 ? -1 : f->cache.nearest[c->node_was[n]];
        f->cache.spare[n] = face < 0 ? -1 : c->face_now[face];
        f->cache.node[n] = (node_distance){0};
    }
    memcpy(f->cache.nearest, f->cache.spare, (size_t)s->node_count * sizeof *f->cache.nearest);
    f->cells.made = f->edges.beyond_known = false;
    return BRUNT_OK;
}

int64_t brunt_node_to_facet_state_count(const brunt_contact_surface *s) {
    return 7 * brunt_surface_slots(s) + s->fem_count + 1;
}

void brunt_node_to_facet_state_get(const brunt_node_to_facet *f, const brunt_contact_surface *s, double *out) {
    memset(out, 0, (size_t)brunt_node_to_facet_state_count(s) * sizeof *out);
    out++; // as once was saved: how far everything had moved, and of each node how far when it was looked at
    for (int k = 0; k < s->fem_count; k++) *out++ = s->motion.was_active[k];
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            double *to = out + 7 * brunt_surface_slot(s, k, n);
            to[0] = f ? f->cache.nearest[n] : -1;
            to[1] = f ? f->cache.node[n].distance : 0, to[2] = f ? -f->cache.node[n].since : 0;
            to[3] = f ? f->cache.node[n].second : 0;
            for (int a = 0; a < 3; a++) to[4 + a] = s->x[n][a];
        }
}

int brunt_node_to_facet_state_set(brunt_node_to_facet **node_to_facet, brunt_contact_surface *s, int mpm_count,
                                  const double *in, brunt_error *error) {
    if (brunt_surface_renew(s, true, error) || brunt_node_to_facet_make(node_to_facet, mpm_count, s->node_count, error))
        return BRUNT_FAILED;
    brunt_node_to_facet *f = *node_to_facet;
    if (brunt_distance_cache_fit(f, s->node_count, 0, error)) return BRUNT_FAILED;
    f->cells.made = f->cells.made && !s->renewal.change.any;
    f->edges.beyond_known = f->edges.beyond_known && !s->renewal.change.any;
    const double moved = *in++;
    for (int k = 0; k < s->fem_count; k++) s->motion.was_active[k] = *in++ != 0;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            const double *from = in + 7 * brunt_surface_slot(s, k, n);
            f->cache.nearest[n] = (int32_t)from[0];
            f->cache.node[n] = (node_distance){from[1], moved - from[2], from[3], 0};
            for (int a = 0; a < 3; a++) s->x[n][a] = from[4 + a];
        }
    return BRUNT_OK;
}

void brunt_distance_cache_validate(const distance_cache *c, int32_t nodes, int32_t faces) {
    BRUNT_ASSERT(brunt_array_holds(c->node, c->node_capacity, sizeof *c->node, (size_t)nodes));
    BRUNT_ASSERT(brunt_array_holds(c->nearest, c->nearest_capacity, sizeof *c->nearest, (size_t)nodes));
    for (int32_t n = 0; n < nodes; n++) {
        BRUNT_ASSERT(c->nearest[n] >= -1 && c->nearest[n] < faces);
        BRUNT_ASSERT(c->node[n].since >= 0);
        BRUNT_ASSERT(!isnan(c->node[n].distance) && !isnan(c->node[n].second));
    }
}
