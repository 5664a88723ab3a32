// What node-to-facet contact keeps between steps: made, freed, counted.
#include "contact/search/node_to_facet_parts.h"

void brunt_node_to_facet_free(brunt_node_to_facet *f) {
    if (!f) return;
    for (int k = 0; k < f->particles.mpm_count && f->particles.dofs; k++)
        brunt_particle_dofs_free(&f->particles.dofs[k]);
    for (int t = 0; t < f->particles.list_count; t++) brunt_free(f->particles.list[t].candidate);
    for (int t = 0; t < f->nodes.masters_count; t++) brunt_free(f->nodes.masters[t].master);
    brunt_feature_edges_free(&f->edges);
    brunt_node_touches_free(&f->touches);
    brunt_initial_penetration_free(&f->penetration);
    void *owned[] = {f->bodies.box,     f->bodies.pair,     f->bodies.box_of,
                     f->bodies.first,   f->bodies.list,     f->cells.first,
                     f->cells.face,     f->cells.x,         f->cells.box,
                     f->nodes.count,    f->nodes.candidate, f->cache.nearest,
                     f->cache.node,     f->nodes.dof_of,    f->nodes.first,
                     f->nodes.meets,    f->cells.moved,     f->cells.near,
                     f->particles.dofs, f->particles.list,  f->nodes.masters,
                     f->particles.run,  f->cache.spare,     f->cache.beside,
                     f->cells.listed,   f->cells.run,       f};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
}

// All that brunt_node_to_facet_free frees.
size_t brunt_node_to_facet_bytes(const brunt_node_to_facet *f) {
    if (!f) return 0;
    const near_bodies *b = &f->bodies;
    const facet_cells *c = &f->cells;
    const distance_cache *d = &f->cache;
    const node_candidates *n = &f->nodes;
    const near_edges *e = &f->edges;
    const particle_candidates *p = &f->particles;
    size_t bytes = sizeof *f + b->box_capacity + b->pair_capacity + b->box_of_capacity + b->first_capacity +
                   b->list_capacity + c->first_capacity + c->face_capacity + c->x_capacity + c->box_capacity +
                   c->moved_capacity + c->near_capacity + c->listed_capacity + c->run_capacity + d->node_capacity +
                   d->nearest_capacity + d->spare_capacity + d->beside_capacity + f->touches.of_capacity +
                   f->touches.spare_capacity + f->touches.edges_capacity + f->touches.keeper_capacity +
                   f->penetration.allowed_capacity + f->penetration.deepest_capacity + n->count_capacity +
                   n->candidate_capacity + n->dof_of_capacity + n->first_capacity + n->meets_capacity +
                   e->near_capacity + e->first_capacity + e->feature_capacity + e->feature_first_capacity +
                   e->span_capacity + e->turns_capacity + e->beyond_capacity + p->run_capacity;
    bytes += (size_t)n->masters_count * sizeof *n->masters + (size_t)p->list_count * sizeof *p->list;
    for (int t = 0; t < n->masters_count; t++) bytes += n->masters[t].capacity;
    for (int t = 0; t < p->list_count; t++) bytes += p->list[t].capacity;
    for (int k = 0; k <= p->mpm_count && p->dofs; k++)
        bytes += sizeof *p->dofs + p->dofs[k].of_capacity + p->dofs[k].dof_capacity;
    return bytes;
}

int brunt_node_to_facet_begin(brunt_node_to_facet *f, int32_t nodes, brunt_error *error) {
    if (RESERVE(&f->nodes, dof_of, nodes + 1, "nodes that contact moves", error)) return BRUNT_FAILED;
    memset(f->nodes.dof_of, 0xff, (size_t)nodes * sizeof *f->nodes.dof_of); // -1: none
    return BRUNT_OK;
}

int brunt_node_to_facet_make(brunt_node_to_facet **node_to_facet, int mpm_count, int32_t nodes, brunt_error *error) {
    if (*node_to_facet) return BRUNT_OK;
    if (BRUNT_NEW(*node_to_facet, 1, "search for contact", error)) return BRUNT_FAILED;
    brunt_node_to_facet *f = *node_to_facet;
    f->particles.mpm_count = mpm_count;
    if (BRUNT_NEW(f->particles.dofs, mpm_count + 1, "bodies of particles near facets", error) ||
        brunt_distance_cache_fit(f, nodes, 0, error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < nodes; n++) f->cache.nearest[n] = -1;
    return BRUNT_OK;
}

void brunt_node_to_facet_validate(const brunt_node_to_facet *f, const brunt_contact_surface *s) {
    if (!f) return;
    brunt_distance_cache_validate(&f->cache, s->node_count, s->face_count);
    brunt_node_touches_validate(&f->touches, s->node_count);
    brunt_initial_penetration_validate(&f->penetration, s->node_count);
    brunt_facet_cells_validate(&f->cells, s->face_count);
}
