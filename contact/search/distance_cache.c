// What the search remembers of nodes from step to step: the nearest facet, and how far all others are.
#include "contact/search/node_to_facet_parts.h"

// Room for what is remembered of so many nodes.
int brunt_distance_cache_fit(brunt_node_to_facet *f, int32_t nodes, int32_t kept) {
    return RESERVE(f, found, nodes + 1) || RESERVE(f, hits, BRUNT_MAX_HITS * (nodes + 1)) ||
                   BRUNT_RESERVE(f->last, (size_t)nodes + 1, (size_t)kept) || RESERVE(f, quiet, nodes + 1)
               ? -1
               : 0;
}

// Distances are to facets that may be gone, so that everyone looks anew. A face that was the nearest and is still there
// is looked at first as before.
int brunt_node_to_facet_renew(brunt_node_to_facet *f, const brunt_contact_surface *s) {
    const brunt_surface_change *c = &s->change;
    if (!f || !c->any) return 0;
    if (brunt_distance_cache_fit(f, s->node_count, c->node_count) || RESERVE(f, last_spare, s->node_count + 1))
        return -1;
    for (int32_t n = 0; n < s->node_count; n++) {
        const int32_t face = c->node_was[n] < 0 ? -1 : f->last[c->node_was[n]];
        f->last_spare[n] = face < 0 ? -1 : c->face_now[face];
        f->quiet[n] = (struct quiet){.travelled = f->travelled};
    }
    memcpy(f->last, f->last_spare, (size_t)s->node_count * sizeof *f->last);
    f->made = false;
    return 0;
}

int64_t brunt_node_to_facet_state_count(const brunt_contact_surface *s) {
    return 7 * brunt_surface_slots(s) + s->fem_count + 1;
}

void brunt_node_to_facet_state_get(const brunt_node_to_facet *f, const brunt_contact_surface *s, double *out) {
    memset(out, 0, (size_t)brunt_node_to_facet_state_count(s) * sizeof *out);
    *out++ = f ? f->travelled : 0;
    for (int k = 0; k < s->fem_count; k++) *out++ = s->was_active[k];
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            double *to = out + 7 * brunt_surface_slot(s, k, n);
            to[0] = f ? f->last[n] : -1;
            to[1] = f ? f->quiet[n].distance : 0, to[2] = f ? f->quiet[n].travelled : 0;
            to[3] = f ? f->quiet[n].second : 0;
            for (int a = 0; a < 3; a++) to[4 + a] = s->x[n][a];
        }
}

int brunt_node_to_facet_state_set(brunt_node_to_facet **facing, brunt_contact_surface *s, int mpm_count,
                                  const double *in) {
    if (brunt_surface_renew(s, true) || brunt_node_to_facet_make(facing, mpm_count, s->node_count)) return -1;
    brunt_node_to_facet *f = *facing;
    if (brunt_distance_cache_fit(f, s->node_count, 0)) return -1;
    f->made = f->made && !s->change.any;
    f->travelled = *in++;
    for (int k = 0; k < s->fem_count; k++) s->was_active[k] = *in++ != 0;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            const double *from = in + 7 * brunt_surface_slot(s, k, n);
            f->last[n] = (int32_t)from[0];
            f->quiet[n] = (struct quiet){from[1], from[2], from[3]};
            for (int a = 0; a < 3; a++) s->x[n][a] = from[4 + a];
        }
    return 0;
}
