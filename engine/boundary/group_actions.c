#include "boundary/group_actions.h"

#include "base/array.h"
#include "boundary/curve.h"
#include "boundary/gas.h"
#include "boundary/kinds.h"

static brunt_placement displace(const brunt_group_def *def, double factor) {
    brunt_placement goal = brunt_placement_identity();
    for (int a = 0; a < 3; a++) goal.translation[a] = factor * def->value[a];
    return goal;
}

static brunt_placement turn(const brunt_group_def *def, double factor) {
    const brunt_rotation_def *by = &def->rotation;
    return brunt_placement_rotate(brunt_placement_identity(), by->axis, factor * by->angle, by->about);
}

static double press(brunt_node_set *set, double time, double dt) {
    (void)dt;
    return -set->def.value[0] * brunt_curve_at(&set->def.table, time);
}

const brunt_group_row brunt_group_rows[] = {
    [BRUNT_GROUP_VELOCITY] = {.moves = true},
    [BRUNT_GROUP_DISPLACEMENT] = {.moves = true, .goal = displace},
    [BRUNT_GROUP_ROTATION] = {.moves = true, .goal = turn, .turns = true},
    [BRUNT_GROUP_TRACTION] = {.values = 3},
    [BRUNT_GROUP_PRESSURE] = {.push = press,
                              .values = 1,
                              .refusal = BRUNT_EXPLICIT_ONLY ": it follows the surface, traction does not",
                              .key = ".pressure"},
    [BRUNT_GROUP_GAS] =
        {.push = brunt_gas_push, .start = brunt_gas_start, .gas = true, .refusal = BRUNT_EXPLICIT_ONLY, .key = ".gas"},
};
const int brunt_group_row_count = BRUNT_COUNT(brunt_group_rows);

#define ONE(name) +1
_Static_assert(BRUNT_COUNT(brunt_group_rows) == BRUNT_GROUP_ACTIONS(ONE), "a row for each action");
