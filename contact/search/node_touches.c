#include "contact/search/node_touches.h"

#include "contact/search/node_to_facet_parts.h"

static const double FAR = 0.5; // mean edges: beyond, a node has left what it touched

void brunt_node_touches_free(node_touches *t) {
    brunt_free(t->of);
    brunt_free(t->spare);
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
    return BRUNT_OK;
}

double brunt_node_to_facet_held(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    double sum = 0;
    for (int k = 0; f && f->touches.of && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; s->motion.was_active[k] && n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++) sum += f->touches.of[n][what].held;
    return sum;
}

int64_t brunt_node_touches_state_count(const brunt_contact_surface *s) {
    return TOUCHED_COUNT * brunt_surface_slots(s);
}

void brunt_node_touches_state_get(const brunt_node_to_facet *f, const brunt_contact_surface *s, double *out) {
    memset(out, 0, (size_t)brunt_node_touches_state_count(s) * sizeof *out);
    for (int k = 0; f && f->touches.of && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++)
                out[TOUCHED_COUNT * brunt_surface_slot(s, k, n) + what] = f->touches.of[n][what].held;
}

int brunt_node_touches_state_set(brunt_node_to_facet *f, const brunt_contact_surface *s, const double *in,
                                 brunt_error *error) {
    if (brunt_node_touches_make(f, s->node_count, error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int what = 0; what < TOUCHED_COUNT; what++)
                f->touches.of[n][what].held = in[TOUCHED_COUNT * brunt_surface_slot(s, k, n) + what];
    return BRUNT_OK;
}

void brunt_node_touches_validate(const node_touches *t, int32_t nodes) {
    if (!t->of) return;
    BRUNT_ASSERT(brunt_array_holds(t->of, t->of_capacity, sizeof *t->of, (size_t)nodes));
    for (int32_t n = 0; n < nodes; n++)
        for (int what = 0; what < TOUCHED_COUNT; what++) BRUNT_ASSERT(isfinite(t->of[n][what].held));
}
