// What can be done to a group of nodes, a row each: all that an action answers. In the order of brunt_group_action.
#pragma once

#include "base/error.h"
#include "brunt/definition.h"

struct brunt_node_set;

typedef struct brunt_group_row {
    bool moves; // it prescribes components of its nodes; else it loads the faces of the group
    // Of what moves: where the whole body would go from the start, `factor` being that of the table; NULL: value times
    // the factor is a velocity.
    brunt_placement (*goal)(const brunt_group_def *def, double factor);
    // Of loads: pressure [Pa] along the normals of the faces for the step from `time` on; NULL: `value` times the table
    // acts on the undeformed area.
    double (*push)(struct brunt_node_set *set, double time, double dt);
    int (*start)(struct brunt_node_set *set, brunt_error *error); // once its faces are there; NULL: nothing
    int values;          // numbers of `value` of which a load is made, and without which there is none
    bool turns, gas;     // `rotation` says how; `gas` does, and what the faces enclose is kept from step to step
    const char *refusal; // why steps that minimise an energy do not have it; NULL: they do
    const char *key;     // in a scene, of what is refused
} brunt_group_row;

extern const brunt_group_row brunt_group_rows[];
extern const int brunt_group_row_count;
