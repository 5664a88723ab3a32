// What is near with room to spare: found once, it holds while no box leaves where it was by half of the room. What is
// near at a place, or along a way, is looked for among it, and is then what a search of all would find.
#include "contact/barrier/barrier_parts.h"

static const double SPARE = 0.1; // of the mean facet's box
static const double HALF = 0.49; // of the room: the rest is more than boxes are rounded by

static bool stay(const brunt_near_box *was, const brunt_near_box *is, int32_t count, double most) {
    bool within = true;
    for (int32_t i = 0; i < count && within; i++)
        for (int k = 0; k < 3; k++)
            within &= is[i].low[k] >= was[i].low[k] - most && is[i].high[k] <= was[i].high[k] + most;
    return within;
}

bool barrier_wide_holds(const brunt_barrier *b) {
    const barrier_wide *w = &b->wide;
    const double inside = (HALF - 1) * w->spare; // of those that are larger by all of it
    return w->known && stay(w->point, b->point_box, barrier_surface_points(b), HALF * w->spare) &&
           stay(w->facet, b->facet_box, b->facet_count, inside); // and edges with their ends
}

static double mean_box(const brunt_barrier *b) {
    double sum = 0;
    for (int32_t i = 0; i < b->facet_count; i++)
        for (int k = 0; k < b->dim; k++) sum += b->facet_box[i].high[k] - b->facet_box[i].low[k];
    return b->facet_count ? sum / b->facet_count / b->dim : 0;
}

static void widen(const brunt_near_box *from, int32_t count, double more, brunt_near_box *to) {
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) to[i].low[k] = from[i].low[k] - more, to[i].high[k] = from[i].high[k] + more;
}

int barrier_wide_make(brunt_barrier *b, const brunt_team *team, brunt_error *error) {
    barrier_wide *w = &b->wide;
    w->known = false;
    if (BRUNT_CAPACITY(w->point, (size_t)barrier_surface_points(b) + 1, 0, "boxes about points", error) ||
        BRUNT_CAPACITY(w->facet, (size_t)b->facet_count + 1, 0, "boxes about facets", error) ||
        BRUNT_CAPACITY(w->edge, (size_t)b->edge_count + 1, 0, "boxes about edges", error))
        return BRUNT_FAILED;
    w->spare = SPARE * mean_box(b);
    widen(b->point_box, barrier_surface_points(b), 0, w->point);
    widen(b->facet_box, b->facet_count, w->spare, w->facet);
    widen(b->edge_box, b->edge_count, w->spare, w->edge);
    return brunt_near_cells_make(&b->facet_cells, team, w->facet, b->facet_count, b->dim, error) ||
                   brunt_near_cells_make(&b->edge_cells, team, w->edge, b->edge_count, b->dim, error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

void barrier_wide_free(barrier_wide *w) {
    brunt_free(w->point), brunt_free(w->facet), brunt_free(w->edge);
    brunt_near_list_free(&w->facets), brunt_near_list_free(&w->edges);
    *w = (barrier_wide){0};
}
