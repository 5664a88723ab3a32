// Groups of nodes of meshes, as kinds of boundaries: what they do is in node_sets.c, load_step.c and gas.c, a pass of
// its own.
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/group_actions.h"
#include "boundary/kinds.h"

#include <stdio.h>

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

BRUNT_BOUNDARY_ENTRIES(group, brunt_group)

brunt_group_def brunt_group_def_default(void) {
    return (brunt_group_def){.component = {true, true, true}, .rotation = {.axis = {0, 0, 1}}, .gas = {.gamma = 1.4}};
}

static void free_all(brunt_world_def *def) {
    for (int32_t i = 0; i < def->group_count; i++) brunt_free(def->groups[i].table.points);
    brunt_free(def->groups);
}

static int check(const brunt_world_def *def, const void *entry, int32_t w, brunt_error *error) {
    const brunt_group_def *group = entry;
    BRUNT_TRY(brunt_check_name_ends("boundaries", w, group->body, error));
    BRUNT_TRY(brunt_check_name_ends("boundaries", w, group->group, error));
    char owner[80];
    snprintf(owner, sizeof owner, "boundaries[%d].group", w);
    BRUNT_TRY(brunt_check_choice(owner, ".action", (unsigned)group->action, (unsigned)brunt_group_row_count, error));
    BRUNT_TRY(brunt_check_curve(owner, ".table", &group->table, error));
    const brunt_gas_def *gas = &group->gas;
    const int filled = brunt_group_rows[group->action].gas, turned = brunt_group_rows[group->action].turns;
    const brunt_rotation_def *turn = &group->rotation;
    BRUNT_CHECK_NUMBERS(owner, {".rotation.angle", &turn->angle, turned, BRUNT_ANY_NUMBER},
                        {".rotation.axis", turn->axis, 3 * turned, BRUNT_ANY_NUMBER},
                        {".rotation.about", turn->about, 3 * turned, BRUNT_ANY_NUMBER});
    if (turned && !(turn->axis[0] || turn->axis[1] || turn->axis[2]))
        REFUSE("boundaries[%d].rotation.axis: the axis has zero length", w);
    if (turned && def->dimension == 2 && (turn->axis[0] || turn->axis[1]))
        REFUSE("boundaries[%d].rotation.axis: in two dimensions what turns does so about z", w);
    BRUNT_CHECK_NUMBERS(owner, {".value", group->value, filled ? 0 : 3, BRUNT_ANY_NUMBER},
                        {".gas.gamma", &gas->gamma, filled, BRUNT_ANY_NUMBER},
                        {".gas.pressure", &gas->pressure, filled, BRUNT_ANY_NUMBER},
                        {".gas.outside", &gas->outside, filled, BRUNT_ANY_NUMBER},
                        {".gas.volume", &gas->volume, filled, BRUNT_ANY_NUMBER},
                        {".gas.inflow", &gas->inflow, filled, BRUNT_ANY_NUMBER});
    return BRUNT_OK;
}

static const char *refusal(const brunt_world_def *def, const void *one, const char **key) {
    if (!brunt_scheme_minimises(def->scheme)) return NULL;
    const brunt_group_row *does = &brunt_group_rows[((const brunt_group_def *)one)->action];
    *key = does->key;
    return does->refusal;
}

// The rest follows with the bodies (node_sets.c).
static int make(const brunt_boundary_making *m, const void *one, int w, brunt_error *error) {
    (void)m, (void)one, (void)w, (void)error;
    return BRUNT_OK;
}

const brunt_boundary_kind brunt_kind_group = {
    BRUNT_BOUNDARY_ROW("group"),
    .refusal = refusal,
};
