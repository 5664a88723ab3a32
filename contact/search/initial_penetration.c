#include "contact/search/initial_penetration.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "contact/search/node_to_facet_parts.h"

static const double TOUCHING = 1e-6; // mean edges: what is no deeper touches
static const double UNMET = -1;

void brunt_initial_penetration_free(initial_penetration *p) {
    brunt_free(p->allowed);
    brunt_free(p->deepest);
    *p = (initial_penetration){.begun = p->begun};
}

int brunt_initial_penetration_begin(initial_penetration *p, int32_t nodes, brunt_error *error) {
    if (RESERVE(p, allowed, nodes + 1, "overlaps of nodes", error) ||
        RESERVE(p, deepest, nodes + 1, "overlaps of nodes", error))
        return BRUNT_FAILED;
    p->begun = true;
    for (int32_t n = 0; n < nodes; n++) p->allowed[n] = INFINITY, p->deepest[n] = UNMET;
    return BRUNT_OK;
}

double brunt_initial_penetration_note(initial_penetration *p, const int32_t *node, int count, double gap) {
    double allowed = 0;
    for (int i = 0; i < count; i++) {
        p->deepest[node[i]] = fmax(p->deepest[node[i]], fmax(0, -gap));
        allowed = fmax(allowed, p->allowed[node[i]]);
    }
    return gap < 0 ? fmin(0, gap + allowed) : gap;
}

void brunt_initial_penetration_end(initial_penetration *p, const brunt_contact_surface *s) {
    const double touching = TOUCHING * s->mean_edge;
    bool any = false;
    for (int32_t n = 0; n < s->node_count; n++) {
        const double deepest = p->deepest[n] > touching ? p->deepest[n] : 0;
        p->allowed[n] = p->deepest[n] == UNMET ? INFINITY : fmin(p->allowed[n], deepest);
        p->deepest[n] = UNMET;
        any = any || (p->allowed[n] > 0 && p->allowed[n] < INFINITY);
    }
    if (!any) brunt_initial_penetration_free(p);
}

// Nodes that are new meet nothing yet.
int brunt_initial_penetration_renew(initial_penetration *p, const brunt_contact_surface *s, brunt_error *error) {
    const brunt_surface_change *change = &s->renewal.change;
    if (!p->allowed) return BRUNT_OK;
    if (BRUNT_CAPACITY(p->allowed, (size_t)s->node_count + 1, (size_t)change->node_count, "overlaps of nodes", error) ||
        RESERVE(p, deepest, s->node_count + 1, "overlaps of nodes", error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < s->node_count; n++)
        p->deepest[n] = change->node_was[n] < 0 ? INFINITY : p->allowed[change->node_was[n]];
    memcpy(p->allowed, p->deepest, (size_t)s->node_count * sizeof *p->allowed);
    for (int32_t n = 0; n < s->node_count; n++) p->deepest[n] = UNMET;
    return BRUNT_OK;
}

// One of each node, where there are any or may be: -1 of those that meet nothing.
int64_t brunt_initial_penetration_state_count(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    return !f || f->penetration.allowed ? brunt_surface_slots(s) : 0;
}

void brunt_initial_penetration_state_get(const brunt_node_to_facet *f, const brunt_contact_surface *s, double *out) {
    for (int64_t k = 0; k < brunt_initial_penetration_state_count(f, s); k++) out[k] = UNMET;
    for (int k = 0; f && f->penetration.allowed && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            if (f->penetration.allowed[n] < INFINITY) out[brunt_surface_slot(s, k, n)] = f->penetration.allowed[n];
}

int brunt_initial_penetration_state_set(brunt_node_to_facet *f, const brunt_contact_surface *s, const double *in,
                                        int64_t count, brunt_error *error) {
    brunt_initial_penetration_free(&f->penetration);
    f->penetration.begun = true;
    if (!count) return BRUNT_OK;
    if (brunt_initial_penetration_begin(&f->penetration, s->node_count, error)) return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            const double allowed = in[brunt_surface_slot(s, k, n)];
            if (allowed >= 0) f->penetration.allowed[n] = allowed;
        }
    return BRUNT_OK;
}

void brunt_initial_penetration_validate(const initial_penetration *p, int32_t nodes) {
    for (int32_t n = 0; p->allowed && n < nodes; n++) BRUNT_ASSERT(p->allowed[n] >= 0 && p->deepest[n] == UNMET);
}
