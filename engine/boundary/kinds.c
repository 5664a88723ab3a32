#include "boundary/kinds.h"

#include <stdio.h>
#include <string.h>

#define DECLARE(NAME, kind, type, word, what) extern const brunt_boundary_kind brunt_kind_##kind;
BRUNT_BOUNDARY_KINDS(DECLARE)

#define ROW(NAME, kind, type, word, what) &brunt_kind_##kind,
const brunt_boundary_kind *const brunt_boundary_kinds[] = {BRUNT_BOUNDARY_KINDS(ROW)};

int32_t brunt_boundary_count(const brunt_world_def *def) {
    int32_t count = 0;
    for (int k = 0; k < BRUNT_BOUNDARY_KIND_COUNT; k++) count += brunt_boundary_kinds[k]->count(def);
    return count;
}

int32_t brunt_boundary_first(const brunt_world_def *def, const char *word) {
    int32_t first = 0;
    for (int k = 0; strcmp(brunt_boundary_kinds[k]->word, word); k++) first += brunt_boundary_kinds[k]->count(def);
    return first;
}

const void *brunt_boundary_entry(const brunt_world_def *def, int32_t w, const brunt_boundary_kind **kind) {
    int k = 0;
    for (; w >= brunt_boundary_kinds[k]->count(def); k++) w -= brunt_boundary_kinds[k]->count(def);
    *kind = brunt_boundary_kinds[k];
    return (*kind)->entry(def, w);
}

void brunt_boundary_name(const brunt_world_def *def, int32_t w, char out[BRUNT_NAME_LENGTH]) {
    const brunt_boundary_kind *kind;
    const void *entry = brunt_boundary_entry(def, w, &kind);
    const char *given = kind->name(entry);
    if (given[0])
        memcpy(out, given, BRUNT_NAME_LENGTH);
    else
        snprintf(out, BRUNT_NAME_LENGTH, "%s%d", kind->word, w + 1);
}
