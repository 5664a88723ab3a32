#include "contact/planes/followed.h"

#include <string.h>

void brunt_node_coordinates(const brunt_grid *grid, int32_t slot, int node, int32_t at[3]) {
    int local[3];
    brunt_node_local(grid, node, local);
    for (int a = 0; a < 3; a++) at[a] = a < grid->dim ? grid->slots[slot].coord[a] * grid->side + local[a] : 0;
}

int32_t brunt_symmetry_before(const brunt_symmetry_plane *plane, const int32_t at[3]) {
    return plane->side * (at[plane->axis] - plane->node);
}

// Whether a node is behind one of the planes (resting false), or on one that sticks.
static bool any_holds(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node, bool resting) {
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    const int count = brunt_symmetry_of(m, body, plane);
    int32_t at[3];
    brunt_node_coordinates(&body->grid, slot, node, at);
    for (int k = 0; k < count; k++) {
        const int32_t before = brunt_symmetry_before(&plane[k], at);
        if (resting ? plane[k].sticks && before == 0 : before < 0) return true;
    }
    return false;
}

bool brunt_followed_behind(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node) {
    return any_holds(m, body, slot, node, false);
}

bool brunt_followed_rests(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node) {
    return any_holds(m, body, slot, node, true);
}

void brunt_followers_find(const brunt_contact_context *m, const brunt_body *body, int32_t slot, int node,
                          brunt_followers *out) {
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    const int count = brunt_symmetry_of(m, body, plane);
    int32_t at[3], image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    out->count = 0;
    brunt_node_coordinates(&body->grid, slot, node, at);
    const int images = brunt_symmetry_images(plane, count, at, body->grid.order, image, sign);
    for (int i = 1; i < images; i++) {
        real *found = brunt_grid_node(&body->grid, image[i]);
        if (!found || !(found[BRUNT_NODE_MASS] > 0)) continue;
        memcpy(out->at[out->count], image[i], sizeof image[i]);
        memcpy(out->sign[out->count], sign[i], sizeof sign[i]);
        out->node[out->count++] = found;
    }
}
