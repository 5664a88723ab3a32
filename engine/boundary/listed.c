// What kinds of boundaries have in common that list their keys: how they are found in a definition, checked, made, and
// how the grid of material points gets the velocities of their hold_at.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundaries.h"
#include "boundary/kinds.h"
#include "contact/planes/grid_conditions.h"
#include "geometry/shape_check.h"

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

static bool is_of(const brunt_boundary_def *entry, const brunt_boundary_kind *kind) {
    return strncmp(entry->kind, kind->word, BRUNT_NAME_LENGTH) == 0;
}

int32_t brunt_listed_count(const brunt_boundary_kind *kind, const brunt_world_def *def) {
    int32_t count = 0;
    for (int32_t i = 0; i < def->boundary_count; i++) count += is_of(&def->boundaries[i], kind);
    return count;
}

const void *brunt_listed_next(const brunt_boundary_kind *kind, const brunt_world_def *def, int32_t *at) {
    while (*at < def->boundary_count)
        if (is_of(&def->boundaries[(*at)++], kind)) return &def->boundaries[*at - 1];
    return NULL;
}

const char *brunt_listed_name(const void *one) { return ((const brunt_boundary_def *)one)->name; }
const char *brunt_listed_body(const void *one) { return ((const brunt_boundary_def *)one)->body; }

// Called for each kind; all of them are in one array.
void brunt_listed_free(brunt_world_def *def) {
    for (int32_t i = 0; def->boundaries && i < def->boundary_count; i++) {
        brunt_shape_free(&def->boundaries[i].shape);
        brunt_free(def->boundaries[i].table.points);
    }
    brunt_free(def->boundaries);
    def->boundaries = NULL;
}

static const brunt_boundary_kind *kind_of(const brunt_boundary_def *entry) {
    for (int k = 0; k < brunt_boundary_kind_count; k++)
        if (brunt_boundary_kinds[k]->keys && is_of(entry, brunt_boundary_kinds[k])) return brunt_boundary_kinds[k];
    return NULL;
}

int brunt_listed_kinds_check(const brunt_world_def *def, brunt_error *error) {
    for (int32_t i = 0; i < def->boundary_count; i++)
        if (!kind_of(&def->boundaries[i]))
            REFUSE("boundaries: '%.*s' is no kind that lists its keys", BRUNT_NAME_LENGTH - 1, def->boundaries[i].kind);
    return BRUNT_OK;
}

// A number in its range, a vector, or the place of a word.
static int check_numbers(const char *owner, const brunt_boundary_key *row, const double *value, brunt_error *error) {
    const brunt_parameter *range = &row->in_scene;
    char key[64];
    snprintf(key, sizeof key, ".%s", range->key);
    BRUNT_CHECK_NUMBERS(owner, {key, value, row->is == BRUNT_VALUE_VECTOR ? 3 : 1, BRUNT_ANY_NUMBER});
    if (row->is == BRUNT_VALUE_WORD) {
        unsigned words = 1;
        for (const char *c = row->words; *c; c++) words += *c == '|';
        const bool place = *value >= 0 && *value < words && *value == floor(*value);
        return brunt_check_choice(owner, key, place ? (unsigned)*value : words, words, error);
    }
    const bool low = range->min_open ? !(*value > range->min) : !(*value >= range->min),
               high = range->max_open ? !(*value < range->max) : !(*value <= range->max);
    if (row->is == BRUNT_VALUE_NUMBER && ((isfinite(range->min) && low) || (isfinite(range->max) && high)))
        REFUSE("%s%s: %g is out of its range", owner, key, *value);
    return BRUNT_OK;
}

int brunt_listed_check(const brunt_world_def *def, const void *one, int32_t w, brunt_error *error) {
    const brunt_boundary_def *entry = one;
    const brunt_boundary_kind *kind = kind_of(entry);
    char owner[80], key[64];
    snprintf(owner, sizeof owner, "boundaries[%d].%s", w, kind->word);
    for (int k = 0; k < kind->key_count; k++) {
        const brunt_boundary_key *row = &kind->keys[k];
        if (row->dimension && row->dimension != def->dimension) continue;
        snprintf(key, sizeof key, ".%s", row->in_scene.key);
        switch (row->is) {
        case BRUNT_VALUE_NUMBER:
        case BRUNT_VALUE_VECTOR:
        case BRUNT_VALUE_WORD: BRUNT_TRY(check_numbers(owner, row, entry->number + row->at, error)); break;
        case BRUNT_VALUE_SHAPE: BRUNT_TRY(brunt_check_shape(owner, &entry->shape, def->dimension, 0, error)); break;
        case BRUNT_VALUE_TABLE: BRUNT_TRY(brunt_check_curve(owner, key, &entry->table, error)); break;
        }
    }
    if (!(def->cell > 0)) REFUSE("%s: it acts on material points, and there are none", owner);
    return BRUNT_OK;
}

int brunt_listed_make(const brunt_boundary_making *m, const void *one, int w, brunt_error *error) {
    (void)error;
    m->all->boundary[w].given = *(const brunt_boundary_def *)one;
    m->all->has_conditions = true;
    return BRUNT_OK;
}

void brunt_listed_hold_grid(const brunt_held_grid *g, brunt_boundary *boundary, double time) {
    brunt_body *body = g->body;
    const bool axisymmetric = brunt_axisymmetric(&body->particles);
    const brunt_grid *grid = &body->grid;
    for (int64_t q = 0; q < (int64_t)grid->slot_count * BRUNT_BLOCK_NODES; q++) {
        const brunt_slot *slot = &grid->slots[q / BRUNT_BLOCK_NODES];
        const int node = (int)(q % BRUNT_BLOCK_NODES);
        const real *n = brunt_slot_nodes(grid, (int32_t)(q / BRUNT_BLOCK_NODES)) + node * BRUNT_NODE_REALS;
        if (!(n[0] > 0)) continue;
        double place[3] = {0}, x[3], v[3] = {0}, now[3] = {0}, rest[3] = {0};
        brunt_node_position(grid, slot->coord, node, place);
        memcpy(x, place, sizeof x);
        if (axisymmetric) x[0] = fabs(x[0]);
        const unsigned held =
            boundary->kind->hold_at(boundary, grid->dim, time, x, BRUNT_ON_BOUNDARY * (double)grid->h, v);
        for (int a = 0; a < grid->dim; a++) {
            rest[a] = held >> a & 1 ? v[a] : 0;
            now[a] = held >> a & 1 ? v[a] : (double)n[BRUNT_NODE_VELOCITY + a];
        }
        if (held & 1) brunt_condition_reflect(axisymmetric, place, (double)grid->h, now);
        if (held) brunt_condition_hold(g, slot, node, now, rest, held, &boundary->last);
    }
}
