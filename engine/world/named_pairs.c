#include "world/named_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/names.h"

static int compare(const void *left, const void *right) {
    const brunt_named_pair *p = left, *q = right;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    if (p->b != q->b) return p->b < q->b ? -1 : 1;
    return (p->at > q->at) - (p->at < q->at);
}

int brunt_named_pairs_make(brunt_named_pairs *named, const brunt_world_def *def, brunt_error *error) {
    const brunt_contact_def *contact = &def->contact;
    *named = (brunt_named_pairs){.count = 0};
    if (!contact->pair_count || !def->body_count) return BRUNT_OK;
    brunt_names bodies;
    if (brunt_names_sort(&bodies, def->bodies[0].name, sizeof *def->bodies, def->body_count, error) ||
        BRUNT_NEW(named->pair, contact->pair_count, "pairs of bodies", error)) {
        brunt_names_free(&bodies);
        return BRUNT_FAILED;
    }
    for (int32_t q = 0; q < contact->pair_count; q++) {
        const brunt_pair_def *pair = &contact->pairs[q];
        const int32_t a = brunt_names_find(&bodies, pair->a, strlen(pair->a)),
                      b = brunt_names_find(&bodies, pair->b, strlen(pair->b));
        if (a == BRUNT_NONE || b == BRUNT_NONE) continue;
        named->pair[named->count++] = (brunt_named_pair){a < b ? a : b, a < b ? b : a, q};
    }
    brunt_names_free(&bodies);
    qsort(named->pair, (size_t)named->count, sizeof *named->pair, compare);
    return BRUNT_OK;
}

void brunt_named_pairs_free(brunt_named_pairs *named) {
    brunt_free(named->pair);
    *named = (brunt_named_pairs){.count = 0};
}

// The place in the definition of what names two bodies last, BRUNT_NONE: nothing does.
static int32_t last_of(const brunt_named_pairs *named, int32_t a, int32_t b) {
    const brunt_named_pair behind = {a, b, INT32_MAX};
    int32_t low = 0, high = named->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (compare(&named->pair[middle], &behind) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    const brunt_named_pair *last = low ? &named->pair[low - 1] : NULL;
    return last && last->a == a && last->b == b ? last->at : BRUNT_NONE;
}

static bool is_usual(const brunt_world_def *def, const brunt_named_pairs *named, int32_t a, int32_t b) {
    const int32_t at = last_of(named, a, b);
    return at == BRUNT_NONE || def->contact.pairs[at].method == def->contact.method;
}

// Bodies of points, and meshes, each in their order.
typedef struct sorted_bodies {
    int32_t *body[2], count[2], next[2]; // next: the first behind the body that is looked at
} sorted_bodies;

// The first behind `a` of one kind that meets it as usual, or `best` if that is before.
static int32_t first_behind(const brunt_world_def *def, const brunt_named_pairs *named, sorted_bodies *s, int kind,
                            int32_t a, int32_t best) {
    while (s->next[kind] < s->count[kind] && s->body[kind][s->next[kind]] <= a) s->next[kind]++;
    for (int32_t k = s->next[kind]; k < s->count[kind]; k++) {
        const int32_t b = s->body[kind][k];
        if (best != BRUNT_NONE && b > best) break;
        if (is_usual(def, named, a, b)) return b;
    }
    return best;
}

int brunt_first_usual_pair(const brunt_world_def *def, const brunt_named_pairs *named, unsigned kinds,
                           brunt_named_pair *first, brunt_error *error) {
    sorted_bodies s = {.count = {0, 0}};
    *first = (brunt_named_pair){BRUNT_NONE, BRUNT_NONE, BRUNT_NONE};
    if (!kinds) return BRUNT_OK;
    int status = BRUNT_NEW(s.body[0], def->body_count + 1, "bodies by kind", error) ||
                 BRUNT_NEW(s.body[1], def->body_count + 1, "bodies by kind", error);
    for (int32_t i = 0; !status && i < def->body_count; i++) {
        const int kind = def->bodies[i].method != BRUNT_MPM;
        s.body[kind][s.count[kind]++] = i;
    }
    for (int32_t a = 0; !status && a < def->body_count && first->a == BRUNT_NONE; a++) {
        const int meshes = def->bodies[a].method != BRUNT_MPM;
        int32_t b = BRUNT_NONE;
        for (int kind = 0; kind < 2; kind++)
            if (kinds >> (meshes + kind) & 1) b = first_behind(def, named, &s, kind, a, b);
        if (b != BRUNT_NONE) *first = (brunt_named_pair){a, b, BRUNT_NONE};
    }
    for (int kind = 0; kind < 2; kind++) brunt_free(s.body[kind]);
    return status ? BRUNT_FAILED : BRUNT_OK;
}
