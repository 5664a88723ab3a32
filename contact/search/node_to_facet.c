// What node-to-facet contact keeps between steps: made, freed, counted.
#include "contact/search/node_to_facet_parts.h"

void brunt_node_to_facet_free(brunt_node_to_facet *f) {
    if (!f) return;
    for (int k = 0; k < f->mpm_count; k++) brunt_free(f->node_support[k]);
    for (int t = 0; t < f->sight_count; t++) brunt_free(f->sight[t].seen);
    for (int t = 0; t < f->masters_count; t++) brunt_free(f->masters[t].master);
    void *owned[] = {f->box,
                     f->near,
                     f->box_of,
                     f->near_first,
                     f->near_list,
                     f->cell_first,
                     f->cell_face,
                     f->made_x,
                     f->made_box,
                     f->found,
                     f->hits,
                     f->last,
                     f->quiet,
                     f->support_of,
                     f->first_point,
                     f->node_support,
                     f->node_support_capacity,
                     f->grid,
                     f->sight,
                     f->masters,
                     f->run,
                     f->last_spare,
                     f};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
}

size_t brunt_node_to_facet_bytes(const brunt_node_to_facet *f) {
    return f ? f->box_capacity + f->near_capacity + f->cell_first_capacity + f->cell_face_capacity +
                   f->made_x_capacity + f->quiet_capacity + f->found_capacity + f->support_of_capacity
             : 0;
}

int brunt_node_to_facet_make(brunt_node_to_facet **facing, int mpm_count, int32_t nodes) {
    if (*facing) return 0;
    brunt_node_to_facet *f = *facing = brunt_alloc(sizeof *f);
    if (!f) return -1;
    f->mpm_count = mpm_count;
    f->node_support = brunt_alloc(((size_t)mpm_count + 1) * sizeof(void *));
    f->node_support_capacity = brunt_alloc(((size_t)mpm_count + 1) * sizeof(size_t));
    if (!f->node_support || !f->node_support_capacity || brunt_distance_cache_fit(f, nodes, 0)) return -1;
    for (int32_t n = 0; n < nodes; n++) f->last[n] = -1;
    return 0;
}
