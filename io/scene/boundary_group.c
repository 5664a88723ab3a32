// Groups of nodes of a scene that are held, moved or loaded.
#include "base/array.h"
#include "io/scene/scene_boundary.h"

#include <math.h>

void brunt_fill_table(scene_reader *reader, const scene_node *node, brunt_curve *table) {
    if (!node || !node->good) return;
    table->points = brunt_entries_for(reader, node->count, sizeof *table->points);
    for (const scene_node *point = table->points ? node->first : NULL; point; point = point->next) {
        table->points[table->count][0] = point->first->value[0];
        table->points[table->count++][1] = point->last->value[0];
    }
}

// Gas is kept between the steps, and its pressure is what comes of it: only the inflow follows a table.
static void check_gas(scene_reader *reader, const scene_node *node, brunt_group_def *group) {
    const scene_node *inflow = brunt_tree_child(node, "inflow");
    if (node->kind != SCENE_MAP) return;
    if (inflow && inflow->good && group->gas.inflow == 0)
        brunt_refuse_key(reader, node->parent, "table", "a table is the factor of gas.inflow, there is none");
    if (reader->dimension == 2) brunt_tree_complain_key(reader->tree, node, "enclosed gas is for three dimensions");
}

static void fill_motion(scene_reader *reader, const scene_node *motion, brunt_group_def *group) {
    brunt_fill_partial(reader, motion, group->component, group->value);
}

// In three dimensions the axis must be given; in two there is but one.
void brunt_fill_rotation(scene_reader *reader, const scene_node *turn, brunt_rotation_def *rotation) {
    if (turn->kind != SCENE_MAP) return;
    const scene_node *axis = brunt_tree_child(turn, "axis");
    rotation->angle = brunt_real_of(turn, "angle", 0);
    brunt_vector_of(turn, "about", rotation->about);
    if (!axis && reader->dimension == 3)
        brunt_tree_complain(reader->tree, turn, "'axis' is missing: the direction about which it turns");
    if (!axis || !brunt_vector_of(turn, "axis", rotation->axis)) return;
    if (!brunt_nonzero(rotation->axis)) brunt_tree_complain(reader->tree, axis, "the axis has zero length");
}

static void fill_rotation(scene_reader *reader, const scene_node *turn, brunt_group_def *group) {
    brunt_fill_rotation(reader, turn, &group->rotation);
}

static void fill_fixed(scene_reader *reader, const scene_node *axes, brunt_group_def *group) {
    brunt_refuse_key(reader, axes->parent, "table", "what is fixed does not change with time");
    for (int c = 0; c < 3 && axes->good; c++) group->component[c] = axes->value[c] != 0;
}

static void fill_value(scene_reader *reader, const scene_node *value, brunt_group_def *group) {
    (void)reader;
    for (int c = 0; c < (value->components ? 3 : 1); c++) group->value[c] = value->value[c];
}

// What can be done to a group of nodes: the key that says so, the action, and what its value means.
// clang-format off
#define ACTIONS(X) \
    X("fix", VELOCITY, fill_fixed) \
    X("velocity", VELOCITY, fill_motion) \
    X("displacement", DISPLACEMENT, fill_motion) \
    X("rotation", ROTATION, fill_rotation) \
    X("traction", TRACTION, fill_value) \
    X("pressure", PRESSURE, fill_value) \
    X("gas", GAS, check_gas)
// clang-format on
#define ROW(key, action, fill) {key, BRUNT_GROUP_##action, fill},
static const struct group_action {
    const char *key;
    brunt_group_action action;
    void (*fill)(scene_reader *reader, const scene_node *value, brunt_group_def *group);
} actions[] = {ACTIONS(ROW)};

#define KEY_OF(key, action, fill) | 1u << BRUNT_GROUP_##action
#define BIT_OF(action) | 1u << BRUNT_GROUP_##action
_Static_assert((0u ACTIONS(KEY_OF)) == (0u BRUNT_GROUP_ACTIONS(BIT_OF)), "a key for each action");

static void fill_action(scene_reader *reader, const scene_node *node, brunt_group_def *group) {
    const struct group_action *action = NULL;
    int count = 0;
    char names[200] = "";
    BRUNT_LIST_NAMES(names, BRUNT_COUNT(actions), actions[i].key);
    for (size_t i = 0; i < BRUNT_COUNT(actions); i++)
        if (brunt_tree_child(node, actions[i].key)) action = &actions[i], count++;
    if (count != 1) {
        brunt_tree_complain(reader->tree, node, "exactly one of %s is wanted, %d are given", names, count);
        return;
    }
    const scene_node *value = brunt_tree_child(node, action->key);
    group->action = action->action;
    if (value->good || action->fill == fill_fixed) action->fill(reader, value, group);
}

void brunt_fill_group(scene_reader *reader, scene_node *node, brunt_group_def *group) {
    brunt_copy_text(reader, brunt_tree_child(node, "group"), group->group, sizeof group->group);
    const scene_node *body = brunt_tree_child(node, "body");
    if (!body) brunt_tree_complain(reader->tree, node, "'body' is missing: the body whose nodes they are");
    brunt_fill_body_of(reader, node, group->body);
    const brunt_body_def *def = brunt_body_named(reader, group->body);
    if (def && def->method == BRUNT_MPM)
        brunt_tree_complain(reader->tree, body, "groups are of bodies of method fem or membrane, '%s' is of method mpm",
                            def->name);
    fill_action(reader, node, group);
    brunt_fill_table(reader, brunt_tree_child(node, "table"), &group->table);
}
