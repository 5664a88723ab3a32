#include "boundary/kinds.h"

#include <stdio.h>
#include <string.h>

#include "materials/material.h"

#define DECLARE(NAME, kind, type, word, what) extern const brunt_boundary_kind brunt_kind_##kind;
BRUNT_BOUNDARY_KINDS(DECLARE)
// Those that list their keys, with their own file and nothing else.
// clang-format off
#define LISTED(X) \
    X(rotor)
// clang-format on
#define DECLARE_LISTED(kind) extern const brunt_boundary_kind brunt_kind_##kind;
LISTED(DECLARE_LISTED)

#define ROW(NAME, kind, type, word, what) &brunt_kind_##kind,
#define ROW_LISTED(kind) &brunt_kind_##kind,
const brunt_boundary_kind *const brunt_boundary_kinds[] = {BRUNT_BOUNDARY_KINDS(ROW) LISTED(ROW_LISTED)};
const int brunt_boundary_kind_count = sizeof brunt_boundary_kinds / sizeof *brunt_boundary_kinds;

static int32_t count_of(const brunt_world_def *def, int k) {
    return brunt_boundary_kinds[k]->count(brunt_boundary_kinds[k], def);
}

int32_t brunt_boundary_entry_count(const brunt_world_def *def) {
    int32_t count = 0;
    for (int k = 0; k < brunt_boundary_kind_count; k++) count += count_of(def, k);
    return count;
}

int32_t brunt_boundary_first(const brunt_world_def *def, const char *word) {
    int32_t first = 0;
    for (int k = 0; strcmp(brunt_boundary_kinds[k]->word, word); k++) first += count_of(def, k);
    return first;
}

bool brunt_boundary_entry_next(const brunt_world_def *def, brunt_boundary_entry *e) {
    for (e->w++; e->k < brunt_boundary_kind_count; e->k++, e->at = 0) {
        e->kind = brunt_boundary_kinds[e->k];
        if ((e->entry = e->kind->next(e->kind, def, &e->at))) return true;
    }
    return false;
}

void brunt_boundary_name(const brunt_boundary_entry *e, char out[BRUNT_NAME_LENGTH]) {
    const char *given = e->kind->name(e->entry);
    if (given[0])
        memcpy(out, given, BRUNT_NAME_LENGTH);
    else
        snprintf(out, BRUNT_NAME_LENGTH, "%s%d", e->kind->word, e->w + 1);
}

bool brunt_boundary_has_fluid(const brunt_world_def *def) {
    for (int i = 0; i < def->body_count; i++) {
        const brunt_model *model = brunt_find_strength(def->materials[def->bodies[i].material].strength);
        if (def->bodies[i].method == BRUNT_MPM && model && model->fluid) return true;
    }
    return false;
}
