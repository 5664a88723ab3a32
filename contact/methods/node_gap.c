// Normal and gap of two bodies at a node. The mean normal is right in the middle of a contact, and tilted at its rim:
// there it finds bodies touching that graze a third of a cell apart, and a block sliding over another is held by its
// edges. So where the mean normal finds contact, the direction that keeps the bodies farthest apart decides: the one of
// their true distance, or, when they touch, that between the hulls of the particles' centres, which are apart still.
// The search between centres comes first and tells the other one where to look (gjk.c).
#include "contact/methods/node_gap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "contact/planes/followed.h"
#include "contact/planes/symmetry.h"

void brunt_node_gap_free(brunt_node_gap *g) {
    for (int k = 0; k < 2; k++) brunt_cloud_free(&g->cloud[k]);
    for (int32_t i = 0; i < g->vicinity_count; i++) brunt_vicinity_free(&g->vicinity[i]);
    brunt_free(g->vicinity);
}

int brunt_node_gap_begin(brunt_node_gap *g, int32_t count, const int nodes[2]) {
    if (BRUNT_CAPACITY(g->vicinity, (size_t)count, (size_t)g->vicinity_count, "bodies that share a block", &g->error))
        return BRUNT_FAILED;
    if (g->vicinity_count < count) g->vicinity_count = count;
    for (int32_t i = 0; i < count; i++) g->vicinity[i].body = NULL;
    memcpy(g->nodes, nodes, sizeof g->nodes);
    g->corners.count = 0; // what is found must not depend on which blocks a thread has had before
    return BRUNT_OK;
}

// Takes out of n what a body cut by symmetry planes cannot know: its image has no particles. Behind planes that stick
// the nodes follow, and what is on them rests.
static void forget_across(const brunt_contact_context *m, const brunt_node_side *a, const brunt_body *body, int node,
                          double n[3]) {
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    const int count = brunt_symmetry_of(m, body, plane);
    int32_t at[3];
    brunt_node_coordinates(&a->body->grid, a->slot, node, at);
    for (int k = 0; k < count; k++)
        if (!plane[k].sticks && abs(at[plane[k].axis] - plane[k].node) <= 1) n[plane[k].axis] = 0;
}

// Unit vector along n, but for that.
static bool make_unit(const brunt_contact_context *m, const brunt_node_side sides[2], int node, double n[3]) {
    for (int k = 0; k < 2 && m->symmetry_count; k++) forget_across(m, sides, sides[k].body, node, n);
    double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(size > 0) || !isfinite(size)) return false;
    for (int k = 0; k < 3; k++) n[k] /= size;
    return true;
}

static double gap_along(const brunt_cloud *a, const brunt_cloud *b, const double n[3]) {
    const double back[3] = {-n[0], -n[1], -n[2]};
    int which;
    return -brunt_cloud_extent(b, true, back, &which) - brunt_cloud_extent(a, true, n, &which);
}

// What both bodies have near the node.
static int look(brunt_node_gap *g, const brunt_node_side sides[2], int node) {
    for (int k = 0; k < 2; k++) {
        brunt_vicinity *vicinity = &g->vicinity[sides[k].entry];
        if (!vicinity->body && brunt_vicinity_turn(vicinity, sides[k].body, sides[k].slot, g->nodes, &g->error))
            return BRUNT_FAILED;
        if (brunt_vicinity_look(vicinity, node, &g->cloud[k], &g->error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

// Of the particles between which the two were nearest at the node before, those that are near this one, too.
static void recall(const brunt_node_gap *g, const brunt_node_side sides[2], brunt_corners *corners) {
    const brunt_corners *old = &g->corners;
    corners->count = 0;
    if (g->before[0] != sides[0].entry || g->before[1] != sides[1].entry) return;
    for (int i = 0; i < old->count; i++) {
        const int a = brunt_cloud_find(&g->cloud[0], old->a[i]), b = brunt_cloud_find(&g->cloud[1], old->b[i]);
        if (a == BRUNT_NONE || b == BRUNT_NONE) continue;
        corners->a[corners->count] = a, corners->b[corners->count++] = b;
    }
}

static void remember(brunt_node_gap *g, const brunt_node_side sides[2], const brunt_corners *corners) {
    for (int k = 0; k < 2; k++) g->before[k] = sides[k].entry;
    g->corners.count = corners->count;
    for (int i = 0; i < corners->count; i++) {
        g->corners.a[i] = brunt_cloud_source(&g->cloud[0], corners->a[i]);
        g->corners.b[i] = brunt_cloud_source(&g->cloud[1], corners->b[i]);
    }
}

// Takes a direction for the normal when it keeps the bodies farther apart. Whether it does.
static bool take_farther(const brunt_node_gap *g, const brunt_contact_context *m, const brunt_node_side *a, int node,
                         double direct[3], double n[3], double *gap) {
    if (!make_unit(m, a, node, direct)) return false;
    const double found = gap_along(&g->cloud[0], &g->cloud[1], direct);
    if (!(found > *gap)) return false;
    *gap = found;
    memcpy(n, direct, 3 * sizeof *n);
    return true;
}

bool brunt_node_gap_find(brunt_node_gap *g, const brunt_contact_context *m, const brunt_node_side sides[2], int node,
                         double n[3], double *gap) {
    const brunt_cloud *a = &g->cloud[0], *b = &g->cloud[1];
    double gradient[2][3], approach = 0;
    if (look(g, sides, node)) return false;
    for (int k = 0; k < 2; k++) brunt_cloud_gradient(&g->cloud[k], &sides[k].body->grid, gradient[k]);
    for (int k = 0; k < 3; k++) n[k] = gradient[1][k] - gradient[0][k];
    if (!make_unit(m, sides, node, n)) return false;
    for (int k = 0; k < 3; k++) approach += (sides[1].v[k] - sides[0].v[k]) * n[k];
    *gap = 0;
    if (g->alone && approach >= 0) return true; // they part, and no third body pushes them together
    *gap = gap_along(a, b, n);
    if (approach * m->dt >= -fmax(*gap, 0)) return true;
    const double h = (double)sides[0].body->grid.h;
    double centres[3], reaches[3];
    brunt_corners corners;
    recall(g, sides, &corners);
    const bool apart = brunt_gjk_centres(a, b, h, n, centres, &corners) > 0;
    remember(g, sides, &corners);
    if (!apart) return true;
    if (!(brunt_gjk_reaches(a, b, h, centres, reaches, &corners) > 0 &&
          take_farther(g, m, sides, node, reaches, n, gap)))
        take_farther(g, m, sides, node, centres, n, gap);
    return true;
}
