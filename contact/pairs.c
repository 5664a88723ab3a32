#include "contact/pairs.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "contact/contact.h"

static int compare(const brunt_pair_entry *p, int32_t a, int32_t b) {
    if (p->a != a) return p->a < a ? -1 : 1;
    return (p->b > b) - (p->b < b);
}

int32_t brunt_pair_of(const brunt_pair_map *map, int32_t a, int32_t b) {
    const int32_t first = a < b ? a : b, second = a < b ? b : a;
    int32_t low = 0, high = map->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const int order = compare(&map->entry[middle], first, second);
        if (order == 0) return map->entry[middle].pair;
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return a == b || !map->mesh ? BRUNT_NONE : map->usual[map->mesh[a] + map->mesh[b]];
}

static bool is_wanted(int32_t pair, const bool *wanted) { return pair >= 0 && wanted[pair]; }

// Those whose pairs are entries; how many entries each body has with bodies of points and of meshes in `named`.
static void note_entries(const brunt_pair_map *map, const bool *wanted, bool *met, int32_t (*named)[2]) {
    for (int32_t i = 0; i < map->count; i++) {
        const brunt_pair_entry *e = &map->entry[i];
        if (is_wanted(e->pair, wanted)) met[e->a] = met[e->b] = true;
        if (e->a != e->b && map->mesh) named[e->a][map->mesh[e->b]]++, named[e->b][map->mesh[e->a]]++;
    }
}

int brunt_pair_map_met(const brunt_pair_map *map, int32_t bodies, const bool *wanted, bool *met, brunt_error *error) {
    int32_t(*named)[2], all[2] = {0, 0};
    if (BRUNT_NEW(named, bodies + 1, "pairs of bodies", error)) return BRUNT_FAILED;
    memset(met, 0, (size_t)bodies * sizeof *met);
    note_entries(map, wanted, met, named);
    for (int32_t b = 0; map->mesh && b < bodies; b++) all[map->mesh[b]]++;
    for (int32_t b = 0; map->mesh && b < bodies; b++)
        for (int mesh = 0; mesh < 2; mesh++) {
            const int32_t others = all[mesh] - (map->mesh[b] == mesh) - named[b][mesh];
            met[b] = met[b] || (others > 0 && is_wanted(map->usual[map->mesh[b] + mesh], wanted));
        }
    brunt_free(named);
    return BRUNT_OK;
}

int brunt_pair_map_add(brunt_pair_map *map, int32_t a, int32_t b, int32_t pair, brunt_error *error) {
    const size_t count = (size_t)map->count;
    if (BRUNT_CAPACITY(map->entry, count + 1, count, "pairs of bodies", error)) return BRUNT_FAILED;
    const bool turned = a > b;
    map->entry[count] = (brunt_pair_entry){turned ? b : a, turned ? a : b, pair, map->count};
    map->count++;
    return BRUNT_OK;
}

static int compare_entries(const void *left, const void *right) {
    const brunt_pair_entry *p = left, *q = right;
    const int order = compare(p, q->a, q->b);
    return order ? order : (p->added > q->added) - (p->added < q->added);
}

void brunt_pair_map_sort(brunt_pair_map *map) {
    if (!map->count) return;
    qsort(map->entry, (size_t)map->count, sizeof *map->entry, compare_entries);
    int32_t kept = 0;
    for (int32_t i = 0; i < map->count; i++) {
        const bool last = i + 1 == map->count || compare(&map->entry[i], map->entry[i + 1].a, map->entry[i + 1].b);
        if (last) map->entry[kept++] = map->entry[i];
    }
    map->count = kept;
}

void brunt_pairs_validate(const brunt_pairs *pairs, int bodies) {
    const brunt_pair_map *map = &pairs->map;
    for (int k = 0; k < 3; k++) BRUNT_ASSERT(map->usual[k] >= -1 && map->usual[k] < pairs->count);
    for (int32_t i = 0; i < map->count; i++) {
        const brunt_pair_entry *e = &map->entry[i];
        BRUNT_ASSERT(e->a >= 0 && e->a <= e->b && e->b < bodies && e->pair >= -1 && e->pair < pairs->count);
        BRUNT_ASSERT(!i || e[-1].a < e->a || (e[-1].a == e->a && e[-1].b < e->b));
    }
    for (int p = 0; p < pairs->count; p++) {
        brunt_impulse_account_validate(&pairs->pair[p].account);
        brunt_impulse_account_validate(&pairs->pair[p].last);
    }
}

void brunt_pairs_free(brunt_pairs *pairs) {
    brunt_free(pairs->pair);
    brunt_free(pairs->mesh);
    brunt_free(pairs->map.entry);
}
