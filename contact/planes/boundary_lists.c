#include "contact/planes/boundary_lists.h"

#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

// Where boundaries that act on all are listed: behind those of each.
static int32_t place_of(const brunt_boundary_lists *lists, const brunt_boundary *b) {
    return b->body < 0 ? lists->bodies : b->body;
}

int brunt_boundary_lists_make(brunt_boundary_lists *lists, const brunt_boundary *boundary, int count, int bodies,
                              brunt_error *error) {
    lists->bodies = bodies;
    if (BRUNT_NEW(lists->first, bodies + 3, "boundaries of bodies", error) ||
        BRUNT_NEW(lists->list, count + 1, "boundaries of bodies", error))
        return BRUNT_FAILED;
    memset(lists->first, 0, ((size_t)bodies + 3) * sizeof *lists->first);
    // Counted two places on, so that filling them, which counts up, leaves the first of each in its place.
    for (int w = 0; w < count; w++) lists->first[place_of(lists, &boundary[w]) + 2]++;
    for (int i = 0; i <= bodies; i++) lists->first[i + 2] += lists->first[i + 1];
    for (int w = 0; w < count; w++) lists->list[lists->first[place_of(lists, &boundary[w]) + 1]++] = w;
    return BRUNT_OK;
}

void brunt_boundary_lists_free(brunt_boundary_lists *lists) {
    brunt_free(lists->first);
    brunt_free(lists->list);
}

void brunt_boundary_lists_validate(const brunt_boundary_lists *lists, const brunt_boundary *boundary, int count) {
    BRUNT_ASSERT(lists->first[0] == 0 && lists->first[lists->bodies + 1] == count);
    for (int32_t i = 0; i <= lists->bodies; i++)
        for (int32_t q = lists->first[i]; q < lists->first[i + 1]; q++) {
            const int32_t w = lists->list[q];
            BRUNT_ASSERT(w >= 0 && w < count && (q == lists->first[i] || lists->list[q - 1] < w));
            BRUNT_ASSERT(boundary[w].body == (i == lists->bodies ? -1 : i));
        }
}

brunt_boundary_walk brunt_boundaries_of(const brunt_boundary_lists *lists, int body) {
    if (!lists) return (brunt_boundary_walk){NULL, NULL, NULL, NULL};
    const int32_t *first = lists->first, all = lists->bodies;
    return (brunt_boundary_walk){lists->list + first[body], lists->list + first[body + 1], lists->list + first[all],
                                 lists->list + first[all + 1]};
}

int brunt_boundary_next(brunt_boundary_walk *walk) {
    const bool own = walk->own < walk->own_end, common = walk->common < walk->common_end;
    if (!own && !common) return BRUNT_NONE;
    return own && (!common || *walk->own < *walk->common) ? *walk->own++ : *walk->common++;
}
