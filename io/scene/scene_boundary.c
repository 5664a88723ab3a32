// Boundaries of a scene: walls, regions of the grid with prescribed motion, groups of nodes that are held, moved or
// loaded. Lines are in scene_boundary_line.c.
#include "contact/planes/condition.h"
#include "io/scene/scene_reader.h"

#include <math.h>
#include <string.h>

static const char *const methods[] = {"mpm", "fem", "membrane"}; // by brunt_method
_Static_assert(sizeof methods / sizeof *methods == BRUNT_MEMBRANE + 1, "a name for each method");

void brunt_fill_body_of(scene_reader *reader, const scene_node *node, char name[BRUNT_NAME_LENGTH]) {
    const scene_node *body = brunt_tree_child(node, "body");
    brunt_check_body_name(reader, body);
    brunt_copy_text(reader, body, name, BRUNT_NAME_LENGTH);
}

// Whether there are material points among the bodies a boundary acts on; a name that is wrong is another mistake.
bool brunt_acts_on_particles(const scene_reader *reader, const char *name) {
    const brunt_world_def *world = &reader->scene->world;
    const brunt_body_def *body = brunt_body_named(reader, name);
    if (*name) return !body || body->method == BRUNT_MPM;
    bool any = world->body_count == 0;
    for (int i = 0; i < world->body_count; i++) any |= world->bodies[i].method == BRUNT_MPM;
    return any;
}

// A vector of which some components may be free.
static void fill_partial(scene_reader *reader, const scene_node *node, bool component[3], double value[3]) {
    bool any = false;
    for (int c = 0; c < 3; c++) {
        component[c] = c < reader->dimension && node && node->good && !node->free[c];
        value[c] = component[c] ? node->value[c] : 0;
        any |= component[c];
    }
    if (node && node->good && !any && reader->dimension)
        brunt_tree_complain(reader->tree, node, "all components are free: nothing would be prescribed");
}

// ---------------------------------------------------------------------------------------------------- planes

// ", stick, slip, ...", less what stands before the first of them.
#define AFTER_COMMA(name, word) ", " word
#define CONDITIONS (&(BRUNT_CONDITIONS(AFTER_COMMA))[2])

static void check_image(scene_reader *reader, const scene_node *node, const brunt_plane_def *plane) {
    const brunt_world_def *world = &reader->scene->world;
    const scene_node *where = brunt_tree_child(node, "plane");
    int axis = -1, nonzeros = 0;
    for (int c = 0; c < 3; c++)
        if (plane->normal[c] != 0) axis = c, nonzeros++;
    if (nonzeros > 1) {
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "normal"),
                            "a symmetry plane stands across x, y or z");
        return;
    }
    if (nonzeros == 0 || !(world->cell > 0) || !brunt_acts_on_particles(reader, plane->body)) return;
    double lines = (plane->point[axis] - world->origin[axis]) / world->cell;
    if (!(fabs(lines - round(lines)) < 1e-9 * fmax(1, fabs(lines)))) {
        char a[32], b[32];
        brunt_format_number(world->origin[axis] + floor(lines) * world->cell, a);
        brunt_format_number(world->origin[axis] + ceil(lines) * world->cell, b);
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "point"),
                            "a symmetry plane lies on a grid line: %c = %s or %s is wanted (or move grid.origin)",
                            "xyz"[axis], a, b);
    }
}

static void fill_plane(scene_reader *reader, scene_node *node, brunt_plane_def *plane) {
    const scene_node *where = brunt_tree_child(node, "plane"), *condition = brunt_tree_child(node, "condition");
    brunt_vector_of(where, "point", plane->point);
    bool normal = brunt_vector_of(where, "normal", plane->normal);
    if (normal && !brunt_nonzero(plane->normal))
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "normal"), "the normal has zero length");
    if (!condition) brunt_tree_complain(reader->tree, node, "'condition' is missing: one of %s", CONDITIONS);
    plane->condition = (brunt_condition)(int)brunt_real_of(node, "condition", BRUNT_SEPARATE);
    const brunt_condition_row *row = &brunt_conditions[plane->condition];
    if (condition && condition->good && !row->pushes)
        brunt_refuse_key(reader, node, "friction", "friction acts only with condition: separate");
    else if (!brunt_tree_child(node, "friction"))
        brunt_add_default(reader, node, "friction", "0");
    plane->friction = brunt_real_of(node, "friction", 0);
    scene_node *velocity = brunt_tree_child(node, "velocity");
    if (row->images)
        brunt_refuse_key(reader, node, "velocity", "a symmetry plane does not move");
    else if (!velocity)
        brunt_add_default(reader, node, "velocity", "0");
    if (velocity && (velocity->free[0] || velocity->free[1] || velocity->free[2]))
        brunt_tree_complain(reader->tree, velocity, "`free` is for regions and groups; a wall has a velocity");
    else
        brunt_vector_of(node, "velocity", plane->velocity);
    brunt_fill_body_of(reader, node, plane->body);
    if (row->images && normal) check_image(reader, node, plane);
}

// ---------------------------------------------------------------------------------------------------- regions

static void fill_region(scene_reader *reader, scene_node *node, brunt_region_def *region) {
    const scene_node *velocity = brunt_tree_child(node, "velocity"), *until = brunt_tree_child(node, "until");
    brunt_fill_shape_def(reader, brunt_tree_child(node, "region"), &region->shape);
    region->place = brunt_fill_place(reader, brunt_tree_child(node, "place"));
    if (!velocity)
        brunt_tree_complain(reader->tree, node, "'velocity' is missing: a list of numbers or `free`, in m/s");
    fill_partial(reader, velocity, region->component, region->velocity);
    if (!brunt_tree_child(node, "from")) brunt_add_default(reader, node, "from", "0");
    region->start = brunt_real_of(node, "from", 0);
    if (!until) until = brunt_add_default(reader, node, "until", "none");
    region->end = brunt_real_of(node, "until", INFINITY);
    if (until && until->good && !(region->start < region->end))
        brunt_tree_complain(reader->tree, until, "until must be after from");
    brunt_fill_body_of(reader, node, region->body);
    const scene_node *body = brunt_tree_child(node, "body"), *where = body ? body : brunt_tree_child(node, "region");
    const brunt_body_def *def = brunt_body_named(reader, region->body);
    if (!brunt_acts_on_particles(reader, region->body))
        brunt_tree_complain_key(reader->tree, where,
                                "a region acts on the grid, %s is of method %s: `group` names nodes of finite elements",
                                body ? "this body" : "no body", body && def ? methods[def->method] : "mpm");
}

// ---------------------------------------------------------------------------------------------------- groups

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
    fill_partial(reader, motion, group->component, group->value);
}

// In three dimensions the axis must be given; in two there is but one.
static void fill_rotation(scene_reader *reader, const scene_node *turn, brunt_group_def *group) {
    brunt_rotation_def *rotation = &group->rotation;
    if (turn->kind != SCENE_MAP) return;
    const scene_node *axis = brunt_tree_child(turn, "axis");
    rotation->angle = brunt_real_of(turn, "angle", 0);
    brunt_vector_of(turn, "about", rotation->about);
    if (!axis && reader->dimension == 3)
        brunt_tree_complain(reader->tree, turn, "'axis' is missing: the direction about which the group turns");
    if (!axis || !brunt_vector_of(turn, "axis", rotation->axis)) return;
    if (!brunt_nonzero(rotation->axis)) brunt_tree_complain(reader->tree, axis, "the axis has zero length");
}

static void fill_fixed(scene_reader *reader, const scene_node *axes, brunt_group_def *group) {
    brunt_refuse_key(reader, axes->parent, "table", "what is fixed does not change with time");
    for (int c = 0; c < 3 && axes->good; c++) group->component[c] = axes->value[c] != 0;
}

static void fill_value(scene_reader *reader, const scene_node *value, brunt_group_def *group) {
    (void)reader;
    for (int c = 0; c < (value->components ? 3 : 1); c++) group->value[c] = value->value[c];
}

// What can be done to a group of nodes: the key that says so, and what it means.
static const struct group_action {
    const char *key;
    brunt_group_action action;
    void (*fill)(scene_reader *reader, const scene_node *value, brunt_group_def *group);
} actions[] = {{"fix", BRUNT_GROUP_VELOCITY, fill_fixed},
               {"velocity", BRUNT_GROUP_VELOCITY, fill_motion},
               {"displacement", BRUNT_GROUP_DISPLACEMENT, fill_motion},
               {"rotation", BRUNT_GROUP_ROTATION, fill_rotation},
               {"traction", BRUNT_GROUP_TRACTION, fill_value},
               {"pressure", BRUNT_GROUP_PRESSURE, fill_value},
               {"gas", BRUNT_GROUP_GAS, check_gas}};
enum { ACTIONS = sizeof actions / sizeof *actions };
_Static_assert(ACTIONS > (int)BRUNT_GROUP_GAS, "a key for each action");

static void fill_action(scene_reader *reader, const scene_node *node, brunt_group_def *group) {
    const struct group_action *action = NULL;
    int count = 0;
    char names[200] = "";
    for (size_t i = 0, used = 0; i < ACTIONS && used < sizeof names; i++) {
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                 i == 0            ? ""
                                 : i + 1 < ACTIONS ? ", "
                                                   : " and ",
                                 actions[i].key);
        if (brunt_tree_child(node, actions[i].key)) action = &actions[i], count++;
    }
    if (count != 1) {
        brunt_tree_complain(reader->tree, node, "exactly one of %s is wanted, %d are given", names, count);
        return;
    }
    const scene_node *value = brunt_tree_child(node, action->key);
    group->action = action->action;
    if (value->good || action->fill == fill_fixed) action->fill(reader, value, group);
}

static void fill_group(scene_reader *reader, scene_node *node, brunt_group_def *group) {
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

// ---------------------------------------------------------------------------------------------------- boundaries

static void check_wall_names(scene_reader *reader, const scene_node *list) {
    for (const scene_node *a = list->first; a; a = a->next) {
        const char *name = brunt_text_of(a, "name", "");
        for (const scene_node *b = list->first; *name && b != a; b = b->next)
            if (strcmp(brunt_text_of(b, "name", ""), name) == 0)
                brunt_tree_complain(reader->tree, brunt_tree_child(a, "name"), "the name '%s' is there twice", name);
    }
}

static void fill_named(scene_reader *reader, scene_node *node, const char *kind, int number, char *name) {
    char automatic[32];
    snprintf(automatic, sizeof automatic, "%s%d", kind, number);
    if (!brunt_tree_child(node, "name")) brunt_add_default(reader, node, "name", automatic);
    brunt_copy_text(reader, brunt_tree_child(node, "name"), name, BRUNT_NAME_LENGTH);
}

static void fill_boundary(scene_reader *reader, scene_node *node) {
    brunt_world_def *world = &reader->scene->world;
    bool plane = brunt_tree_child(node, "plane"), region = brunt_tree_child(node, "region"),
         group = brunt_tree_child(node, "group"), line = brunt_tree_child(node, "line");
    if (plane + region + group + line != 1) {
        brunt_tree_complain(reader->tree, node, "exactly one of plane, region, group and line is wanted");
    } else if (plane) {
        brunt_plane_def *def = &world->planes[world->plane_count++];
        *def = brunt_plane_def_default();
        fill_named(reader, node, "plane", world->plane_count, def->name);
        brunt_fill_fields(reader, node, "boundaries[]", SCENE_PLANE, def);
        fill_plane(reader, node, def);
    } else if (region) {
        brunt_region_def *def = &world->regions[world->region_count++];
        *def = brunt_region_def_default();
        fill_named(reader, node, "region", world->region_count, def->name);
        brunt_fill_fields(reader, node, "boundaries[]", SCENE_REGION, def);
        fill_region(reader, node, def);
    } else if (line && reader->dimension == 3) {
        return; // there is none, as has been said
    } else if (line) {
        brunt_boundary_surface_def *def = &world->surfaces[world->surface_count++];
        *def = brunt_boundary_surface_def_default();
        fill_named(reader, node, "line", world->surface_count, def->name);
        brunt_fill_fields(reader, node, "boundaries[]", SCENE_LINE, def);
        brunt_fill_line(reader, node, def);
    } else {
        brunt_group_def *def = &world->groups[world->group_count++];
        *def = brunt_group_def_default();
        fill_named(reader, node, "group", world->group_count, def->name);
        brunt_fill_fields(reader, node, "boundaries[]", SCENE_GROUP_OF_NODES, def);
        fill_group(reader, node, def);
    }
}

void brunt_fill_boundaries(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *list = brunt_tree_child(reader->tree->root, "boundaries");
    int count = brunt_children_of(list, SCENE_LIST);
    world->planes = brunt_entries_for(reader, count, sizeof *world->planes);
    world->regions = brunt_entries_for(reader, count, sizeof *world->regions);
    world->groups = brunt_entries_for(reader, count, sizeof *world->groups);
    world->surfaces = brunt_entries_for(reader, count, sizeof *world->surfaces);
    if (!world->planes || !world->regions || !world->groups || !world->surfaces) return;
    for (scene_node *node = list->first; node; node = node->next)
        if (node->kind == SCENE_MAP) fill_boundary(reader, node);
    check_wall_names(reader, list);
}
