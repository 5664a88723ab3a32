// What must hold of a barrier between two steps; looked at in debug builds (world/validate.c).
#include "contact/barrier/barrier_parts.h"

// Vertices ascend within facets and edges, and are of one body.
static void validate_surface(const brunt_barrier *b) {
    for (int32_t i = 0; i < b->facet_count; i++) {
        const int32_t *f = b->facet[i];
        BRUNT_ASSERT(f[0] >= 0 && f[b->dim - 1] < b->vertex_count);
        for (int k = 1; k < b->dim; k++) BRUNT_ASSERT(f[k - 1] < f[k] && b->body[f[k - 1]] == b->body[f[k]]);
    }
    for (int32_t i = 0; i < b->edge_count; i++) {
        const int32_t *e = b->edge[i];
        BRUNT_ASSERT(e[0] >= 0 && e[0] < e[1] && e[1] < b->vertex_count && b->edge_length2[i] > 0);
    }
    for (int32_t v = 0; v < b->vertex_count; v++) BRUNT_ASSERT(b->body[v] >= 0 && b->vertex_area[v] >= 0);
}

// The weights of a point on a rim are those of a place.
static void validate_rims(const brunt_barrier *b) {
    BRUNT_ASSERT(b->rim_count == (b->round ? b->facet_count * BARRIER_RIM_POINTS : 0));
    for (int32_t i = 0; i < b->rim_count; i++) {
        const barrier_rim *rim = &b->rim[i];
        const barrier_arc *arc = &b->arc[rim->facet];
        double sum = 0;
        for (int k = 0; k < arc->curve.places; k++) {
            BRUNT_ASSERT(arc->place[k] >= 0 && arc->place[k] < b->vertex_count);
            BRUNT_ASSERT(k > 1 || arc->place[k] == b->facet[rim->facet][k]);
            sum += rim->weight[k];
        }
        BRUNT_ASSERT(fabs(sum - 1) < 1e-12 && rim->area > 0);
    }
}

static void validate_pairs(const brunt_barrier *b) {
    for (int32_t i = 0; i < b->pair_count; i++) {
        const brunt_barrier_pair *p = &b->pair[i];
        BRUNT_ASSERT(p->a >= 0 && p->a <= p->b && p->stiffness > 0 && p->friction >= 0);
        BRUNT_ASSERT(p->distance >= 0 && p->reach >= 0 && p->distance + p->reach > 0);
        BRUNT_ASSERT(p->friction == 0 || (b->source.friction && p->slip_speed > 0));
        BRUNT_ASSERT(fmax(p->distance, 2 * p->reach) + p->offset <= b->source.range);
        BRUNT_ASSERT(b->key[i].pair >= 0 && b->key[i].pair < b->pair_count);
        BRUNT_ASSERT(!i || b->key[i - 1].bodies < b->key[i].bodies);
    }
}

static void validate_contacts(const brunt_barrier *b, const barrier_contacts *list) {
    const int32_t places = barrier_points(b) + b->step.plane_count, laws = b->pair_count + b->step.plane_count;
    for (int64_t i = 0; i < list->count; i++) {
        const barrier_contact *c = &list->contact[i];
        BRUNT_ASSERT(c->law >= 0 && c->law < laws && isfinite(c->weight));
        BRUNT_ASSERT(c->at.places >= 2 && c->at.places <= BRUNT_CLOSEST_PLACES);
        for (int k = 0; k < c->at.places; k++) BRUNT_ASSERT(c->place[k] >= 0 && c->place[k] < places);
    }
}

static void validate_sets(const barrier_sets *sets) {
    for (int64_t s = 0; s < sets->count; s++) {
        BRUNT_ASSERT(sets->first[s] <= sets->first[s + 1]);
        for (int64_t k = sets->first[s]; k < sets->first[s + 1]; k++) BRUNT_ASSERT(sets->node[k] >= 0);
    }
}

void brunt_barrier_validate(const brunt_barrier *b) {
    BRUNT_ASSERT(!b->unsaid.code);
    validate_surface(b);
    validate_rims(b);
    validate_pairs(b);
    validate_contacts(b, &b->contacts);
    validate_contacts(b, &b->lagged);
    validate_sets(&b->sets);
    validate_sets(&b->lagged_sets);
    for (int64_t i = 0; b->keeps && i < (int64_t)barrier_surface_points(b) * BARRIER_KEPT; i++)
        BRUNT_ASSERT(b->kept[i].force >= 0 && isfinite(b->kept[i].slip[0] + b->kept[i].slip[1] + b->kept[i].slip[2]));
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const double *part = b->rub[i].part;
        BRUNT_ASSERT(b->lagged.contact[i].normal_force > 0);
        BRUNT_ASSERT(part[0] * part[0] + part[1] * part[1] + part[2] * part[2] <= 1 + 1e-9);
    }
}
