// Which bodies of a definition may meet, and how.
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/methods/method.h"
#include "world/create.h"

// Two bodies that a pair is made of: those that a definition names, all where there are few; of many the first two of
// each kind that none names, which stand for all others.
typedef struct candidate {
    int32_t a, b;  // a < b
    int32_t named; // pair of the definition, -1
    bool usual;    // stands for all of its kind
} candidate;

typedef struct maker {
    brunt_world *world;
    const brunt_world_def *def;
    const brunt_body_def **order;
    bool crowded; // all pairs of one method, friction and slaves are one
    bool *self;   // of each body: a pair with itself has been made
    int selves;   // how many
    candidate *list;
    int32_t count;
} maker;

// In a crowded scene all pairs that are alike are one, but those of a body with itself, which come first.
static int find_alike(const brunt_pairs *pairs, int selves, const brunt_pair *pair) {
    for (int p = selves; p < pairs->count; p++)
        if (pairs->pair[p].method == pair->method && pairs->pair[p].friction == pair->friction &&
            pairs->pair[p].slaves == pair->slaves)
            return p;
    return BRUNT_NONE;
}

// What the world has by the rows by which two bodies meet, and where they do.
static unsigned note_rows(const maker *m, brunt_contact_method method, bool mesh_a, bool mesh_b) {
    brunt_contact *contact = &m->world->contact;
    const unsigned rows = brunt_contact_rows_of(method, m->def->contact.form, mesh_a, mesh_b),
                   meets = brunt_contact_places_of(rows);
    if (brunt_contact_energy(method))
        contact->has_barrier = true;
    else
        contact->rows |= rows;
    contact->has_grid = contact->has_grid || meets & BRUNT_MEET_AT_NODES;
    contact->has_touches = contact->has_touches || meets & BRUNT_MEET_AT_PARTICLES;
    contact->has_grid_surfaces = contact->has_grid_surfaces || meets & BRUNT_MEET_ON_GRID;
    contact->facets = brunt_contact_row_at(contact->rows, BRUNT_MEET_AT_FACETS);
    return meets;
}

// Checks the names of a pair, and makes that of a membrane with itself.
static int make_self_pair(const maker *m, int q, brunt_error *error) {
    const brunt_pair_def *def = &m->def->contact.pairs[q];
    brunt_pairs *pairs = &m->world->pairs;
    const int n = m->def->body_count, a = brunt_find_ordered(m->order, n, def->a),
              b = brunt_find_ordered(m->order, n, def->b);
    if (a < 0 || b < 0) REFUSE("contact.pairs[%d].between: '%s' and '%s' are not two bodies", q, def->a, def->b);
    if (a != b) return BRUNT_OK;
    const brunt_contact_self self = brunt_contact_with_itself(def->method);
    if (def->method == BRUNT_CONTACT_NONE) return BRUNT_OK;
    if (self == BRUNT_SELF_MESHES && m->order[a]->method == BRUNT_MPM)
        REFUSE("contact.pairs[%d].between: '%s' has no mesh to be in contact with itself", q, def->a);
    if (self != BRUNT_SELF_MESHES && m->order[a]->method != BRUNT_MEMBRANE)
        REFUSE("contact.pairs[%d].between: '%s' is no membrane: no other body can be in contact with itself", q,
               def->a);
    if (self == BRUNT_SELF_NONE)
        REFUSE("contact.pairs[%d].method: contact of '%s' with itself is by %s", q, def->a,
               brunt_contact_word(brunt_contact_of_self(m->def->scheme)));
    if (!(def->friction >= 0)) REFUSE("contact.pairs[%d].friction: %g is negative", q, def->friction);
    if (def->sides != BRUNT_SIDES_BOTH)
        REFUSE("contact.pairs[%d].sides: '%s' is both sides of contact with itself", q, def->a);
    if (m->self[a]) REFUSE("contact.pairs[%d].between: '%s' is listed twice", q, def->a);
    m->self[a] = true;
    brunt_contact *contact = &m->world->contact;
    contact->has_self = true;
    const unsigned meets = note_rows(m, def->method, true, true);
    m->world->contact.has_friction = m->world->contact.has_friction || def->friction > 0;
    if (brunt_pair_map_add(&pairs->map, a, a, pairs->count, error)) return BRUNT_FAILED;
    pairs->pair[pairs->count++] =
        (brunt_pair){.a = a, .b = a, .method = def->method, .meets = meets, .friction = def->friction};
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ which pairs there are

static int compare_candidates(const void *left, const void *right) {
    const candidate *p = left, *q = right;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    if (p->b != q->b) return p->b < q->b ? -1 : 1;
    return (p->named > q->named) - (p->named < q->named);
}

static bool is_named(const maker *m, int32_t named, int32_t a, int32_t b) {
    int32_t low = 0, high = named;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const candidate *at = &m->list[middle];
        if (at->a < a || (at->a == a && at->b < b))
            low = middle + 1;
        else
            high = middle;
    }
    return low < named && m->list[low].a == a && m->list[low].b == b;
}

// The first two bodies, in their order, of which `meshes` are meshes and that no pair of the definition names.
static bool find_usual(const maker *m, int32_t named, int meshes, candidate *found) {
    const int32_t n = m->def->body_count;
    const uint8_t *mesh = m->world->pairs.mesh;
    int32_t last[2] = {-1, -1};
    for (int32_t i = 0; i < n; i++) last[mesh[i]] = i;
    for (int32_t i = 0; i < n; i++) {
        const int other = meshes - mesh[i];
        if (other < 0 || other > 1) continue;
        for (int32_t k = i + 1; k <= last[other]; k++) {
            if (mesh[k] != other || is_named(m, named, i, k)) continue;
            *found = (candidate){i, k, -1, true};
            return true;
        }
    }
    return false;
}

// Pairs that the definition names, the last that does where several name two bodies.
static int32_t list_named(maker *m) {
    const int n = m->def->body_count;
    int32_t kept = 0;
    for (int32_t q = 0; q < m->def->contact.pair_count; q++) {
        const int32_t a = brunt_find_ordered(m->order, n, m->def->contact.pairs[q].a),
                      b = brunt_find_ordered(m->order, n, m->def->contact.pairs[q].b);
        if (a != b) m->list[m->count++] = (candidate){a < b ? a : b, a < b ? b : a, q, false};
    }
    qsort(m->list, (size_t)m->count, sizeof *m->list, compare_candidates);
    for (int32_t i = 0; i < m->count; i++)
        if (i + 1 == m->count || m->list[i].a != m->list[i + 1].a || m->list[i].b != m->list[i + 1].b)
            m->list[kept++] = m->list[i];
    return m->count = kept;
}

static void list_candidates(maker *m) {
    const int32_t named = list_named(m), n = m->def->body_count;
    if (m->crowded)
        for (int meshes = 0; meshes <= 2; meshes++) m->count += find_usual(m, named, meshes, &m->list[m->count]);
    for (int32_t i = 0; !m->crowded && i < n; i++)
        for (int32_t k = i + 1; k < n; k++)
            if (!is_named(m, named, i, k)) m->list[m->count++] = (candidate){i, k, -1, false};
    qsort(m->list, (size_t)m->count, sizeof *m->list, compare_candidates);
}

// ------------------------------------------------------------------------------------------ what they are

// Whose nodes are slaves of two bodies, as a pair of the definition says.
static int settle_sides(const maker *m, const candidate *c, brunt_pair *pair, brunt_error *error) {
    const brunt_pair_def *def = &m->def->contact.pairs[c->named];
    const bool meshes = m->world->pairs.mesh[c->a] && m->world->pairs.mesh[c->b];
    if (def->sides == BRUNT_SIDES_BOTH) return BRUNT_OK;
    if (!brunt_contact_has_sides(pair->method, m->def->contact.form) || !meshes)
        REFUSE("contact.pairs[%d].sides: only two meshes in contact by %s have slaves", (int)c->named,
               BRUNT_CONTACT_WITH_SIDES);
    const bool turned = brunt_find_ordered(m->order, m->def->body_count, def->a) > c->a;
    pair->slaves = turned ? BRUNT_SLAVES_HIGHER : BRUNT_SLAVES_LOWER;
    return BRUNT_OK;
}

// The method of two bodies as they are made, and what the world has by it.
static int settle_method(const maker *m, const candidate *c, brunt_pair *pair, brunt_error *error) {
    const brunt_body_def *a = m->order[c->a], *b = m->order[c->b];
    brunt_contact *contact = &m->world->contact;
    const bool mesh_a = a->method != BRUNT_MPM, mesh_b = b->method != BRUNT_MPM;
    const brunt_contact_method asked = pair->method;
    char forms[96];
    if (!mesh_a && !mesh_b && !brunt_contact_energy(asked))
        pair->method = brunt_contact_between_points(asked, m->def->contact.form, m->def->axisymmetric);
    if (c->named >= 0 && pair->method != asked)
        REFUSE("contact of '%s' and '%s': %s of two bodies of material points wants form %s, and no rings", a->name,
               b->name, brunt_contact_word(asked),
               (brunt_augury_words_of(brunt_augury_forms_of_points(asked), forms, sizeof forms), forms));
    if (!brunt_contact_accepts(pair->method, mesh_a, mesh_b))
        REFUSE("contact of '%s' and '%s': %s wants %s", a->name, b->name, brunt_contact_word(pair->method),
               brunt_contact_wants(pair->method));
    pair->meets = note_rows(m, pair->method, mesh_a, mesh_b);
    if (!(pair->friction >= 0)) REFUSE("contact.friction: %g is negative", pair->friction);
    contact->has_friction = contact->has_friction || pair->friction > 0;
    return BRUNT_OK;
}

static int make_pair(const maker *m, const candidate *c, brunt_error *error) {
    const brunt_contact_def *def = &m->def->contact;
    brunt_pairs *pairs = &m->world->pairs;
    brunt_pair pair = {.a = c->a, .b = c->b, .method = def->method, .friction = def->friction};
    if (c->named >= 0) pair.method = def->pairs[c->named].method, pair.friction = def->pairs[c->named].friction;
    int index = -1;
    if (pair.method != BRUNT_CONTACT_NONE) {
        int status = settle_method(m, c, &pair, error);
        if (!status && c->named >= 0) status = settle_sides(m, c, &pair, error);
        if (status) return status;
        if (m->crowded) pair.a = pair.b = -1;
        index = m->crowded ? find_alike(pairs, m->selves, &pair) : -1;
        if (index < 0) pairs->pair[index = pairs->count++] = pair;
        pairs->pair[index].meets |= pair.meets;
    }
    if (c->usual)
        pairs->map.usual[pairs->mesh[c->a] + pairs->mesh[c->b]] = index;
    else
        return brunt_pair_map_add(&pairs->map, c->a, c->b, index, error);
    return BRUNT_OK;
}

int brunt_pairs_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order, brunt_error *error) {
    const int64_t n = def->body_count, named = def->contact.pair_count;
    maker m = {.world = world, .def = def, .order = order, .crowded = n * (n - 1) / 2 > BRUNT_PAIR_LIMIT};
    const size_t most = (size_t)(named + (m.crowded ? 3 : n * (n - 1) / 2) + 1);
    if (BRUNT_NEW(world->pairs.mesh, n, "bodies with pairs", error) ||
        BRUNT_NEW(world->pairs.pair, most + (size_t)named, "pairs of bodies", error))
        return BRUNT_FAILED;
    int status = BRUNT_NEW(m.list, most, "pairs of bodies", error) || BRUNT_NEW(m.self, n, "pairs of bodies", error)
                     ? BRUNT_FAILED
                     : BRUNT_OK;
    for (int i = 0; !status && i < n; i++) world->pairs.mesh[i] = order[i]->method != BRUNT_MPM;
    world->pairs.map.mesh = world->pairs.mesh;
    for (int k = 0; k < 3; k++) world->pairs.map.usual[k] = -1;
    for (int q = 0; !status && q < named; q++) status = make_self_pair(&m, q, error);
    m.selves = world->pairs.count;
    if (!status) list_candidates(&m);
    for (int32_t c = 0; !status && c < m.count; c++) status = make_pair(&m, &m.list[c], error);
    brunt_pair_map_sort(&world->pairs.map);
    brunt_free(m.list);
    brunt_free(m.self);
    return status;
}
