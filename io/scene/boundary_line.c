// Lines and meshes of a scene that hold material points.
#include "contact/planes/condition.h"
#include "io/mesh/gmsh.h"
#include "io/scene/scene_boundary.h"

#include <string.h>

// Points in turn, and the parts between them.
static void fill_points(scene_reader *reader, const scene_node *line, brunt_boundary_surface_def *def) {
    const scene_node *points = brunt_tree_child(line, "points"), *before = NULL;
    const bool closed = brunt_real_of(line, "closed", 0) != 0;
    if (!points || !points->good) return;
    if (points->count < 2) {
        brunt_tree_complain(reader->tree, points, "%d points are given, two at least are wanted", points->count);
        return;
    }
    def->point = brunt_entries_for(reader, points->count, sizeof *def->point);
    def->facet = brunt_entries_for(reader, points->count, sizeof *def->facet);
    if (!def->point || !def->facet) return;
    for (const scene_node *p = points->first; p; before = p, p = p->next) {
        if (before && before->value[0] == p->value[0] && before->value[1] == p->value[1])
            brunt_tree_complain(reader->tree, p, "this is the point before it once more");
        for (int a = 0; a < 2; a++) def->point[def->point_count][a] = p->value[a];
        def->point_count++;
    }
    def->facet_count = def->point_count - !closed;
    for (int32_t f = 0; f < def->facet_count; f++)
        memcpy(def->facet[f], (const int32_t[4]){f, (f + 1) % def->point_count, -1, -1}, sizeof def->facet[f]);
    if (closed && points->count < 3)
        brunt_tree_complain(reader->tree, points, "a closed line has three points at least");
}

// The facets of a surface, turned over if the scene says so.
static void fill_mesh(scene_reader *reader, const scene_node *mesh, brunt_boundary_surface_def *def) {
    scene_node *file = brunt_tree_child(mesh, "file");
    const scene_node *group = brunt_tree_child(mesh, "group");
    char name[BRUNT_NAME_LENGTH] = "", path[BRUNT_SCENE_PATH];
    brunt_gmsh_facets facets;
    brunt_error error = {0};
    brunt_copy_text(reader, group, name, sizeof name);
    if (!file || !file->good || (group && !*name) || !brunt_find_mesh(reader, file, path)) return;
    if (brunt_gmsh_read_facets(path, name, &facets, &error)) {
        brunt_tree_complain(reader->tree, group ? group : file, "%s", error.message);
        return;
    }
    brunt_scale_places(mesh, "unit", facets.points, facets.point_count);
    def->point = facets.points, def->point_count = facets.point_count;
    def->facet = facets.corners, def->facet_count = facets.count;
    for (int32_t f = 0; f < def->facet_count && brunt_real_of(mesh, "reversed", 0) != 0; f++) {
        const int last = def->facet[f][3] < 0 ? 2 : 3;
        const int32_t kept = def->facet[f][1];
        def->facet[f][1] = def->facet[f][last], def->facet[f][last] = kept;
    }
}

static void fill_condition(scene_reader *reader, const scene_node *node, brunt_boundary_surface_def *def) {
    scene_node *condition = brunt_tree_child(node, "condition");
    if (!condition) brunt_tree_complain(reader->tree, node, "'condition' is missing: one of stick, slip and separate");
    def->condition = (brunt_condition)(int)brunt_real_of(node, "condition", BRUNT_STICK);
    if (brunt_conditions[def->condition].images)
        brunt_tree_complain(reader->tree, condition,
                            "a %s is no plane of symmetry: stick, slip and separate are possible",
                            reader->dimension == 2 ? "line" : "mesh");
    if (condition && condition->good && def->condition != BRUNT_SEPARATE)
        brunt_refuse_key(reader, node, "friction", "friction acts only with condition: separate");
    def->friction = brunt_real_of(node, "friction", 0);
}

// Three numbers of one: in two dimensions about z, in three about all axes if `all`.
static void fill_turn(scene_reader *reader, scene_node *node, bool all, double out[3]) {
    if (!node || !node->good) return;
    if (node->components == 3) {
        for (int a = 0; a < 3; a++) out[a] = node->value[a];
    } else if (reader->dimension == 3 && !all) {
        brunt_tree_complain(reader->tree, node, "in three dimensions an angular velocity is a vector");
    } else {
        for (int a = reader->dimension == 2 ? 2 : 0; a < 3; a++) out[a] = node->value[0];
    }
}

// What a rigid tool has that is free.
static void fill_tool(scene_reader *reader, scene_node *node, brunt_boundary_surface_def *def) {
    static const char *const parts[] = {"inertia", "center", "spin"};
    static const char *const prescribed[] = {"displacement", "rotation", "table"};
    scene_node *mass = brunt_tree_child(node, "mass"), *inertia = brunt_tree_child(node, "inertia");
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        if (!mass) brunt_refuse_key(reader, node, parts[k], "it is of a free tool, which has a mass");
        if (mass && k > 0 && !inertia)
            brunt_refuse_key(reader, node, parts[k], "without inertia the tool does not turn");
    }
    for (size_t k = 0; mass && k < sizeof prescribed / sizeof *prescribed; k++)
        brunt_refuse_key(reader, node, prescribed[k], "mass is given as well: what is free goes as forces have it");
    if (inertia && !brunt_tree_child(node, "center"))
        brunt_tree_complain_key(reader->tree, inertia, "center is missing: about what the tool turns");
    fill_turn(reader, inertia, true, def->inertia);
    for (int a = 0; inertia && inertia->good && a < inertia->components; a++)
        if (!(inertia->value[a] > 0)) {
            brunt_tree_complain(reader->tree, inertia, "%g is not above 0", inertia->value[a]);
            break;
        }
    fill_turn(reader, brunt_tree_child(node, "spin"), false, def->spin);
    brunt_vector_of(node, "center", def->center);
}

static void fill_motion(scene_reader *reader, scene_node *node, brunt_boundary_surface_def *def) {
    const scene_node *velocity = brunt_tree_child(node, "velocity"), *way = brunt_tree_child(node, "displacement"),
                     *turn = brunt_tree_child(node, "rotation"),
                     *given = way        ? way
                              : velocity ? velocity
                                         : turn;
    def->displacement = way != NULL || turn != NULL;
    fill_tool(reader, node, def);
    if (turn) brunt_fill_rotation(reader, turn, &def->rotation);
    if (turn && velocity)
        brunt_tree_complain_key(reader->tree, velocity,
                                "rotation is given as well, which goes with a displacement: the "
                                "table is the factor of both");
    if (velocity && way)
        brunt_tree_complain_key(reader->tree, way, "velocity is given as well: one of both moves the %s",
                                reader->dimension == 2 ? "line" : "mesh");
    if (!given) {
        brunt_refuse_key(reader, node, "table",
                         "a table is the factor of velocity, displacement or rotation, there is none of them");
        return;
    }
    if (given != turn && (given->free[0] || given->free[1] || given->free[2]))
        brunt_tree_complain(reader->tree, given, "`free` is for regions and groups; a line or mesh moves as a whole");
    for (int a = 0; a < reader->dimension && given != turn && given->good; a++) def->value[a] = given->value[a];
    brunt_fill_table(reader, brunt_tree_child(node, "table"), &def->table);
}

void brunt_fill_surface(scene_reader *reader, scene_node *node, brunt_boundary_surface_def *def) {
    const scene_node *line = brunt_tree_child(node, "line"), *mesh = brunt_tree_child(node, "mesh"),
                     *shape = line ? line : mesh, *body = brunt_tree_child(node, "body");
    if (reader->dimension != (line ? 2 : 3)) { // there is none, as has been said
        reader->scene->world.surface_count--;
        return;
    }
    if (shape->kind == SCENE_MAP) (line ? fill_points : fill_mesh)(reader, shape, def);
    fill_condition(reader, node, def);
    fill_motion(reader, node, def);
    brunt_fill_body_of(reader, node, def->body);
    if (!brunt_acts_on_particles(reader, def->body))
        brunt_tree_complain_key(reader->tree, body ? body : shape,
                                "a %s holds material points, %s of method mpm: `group` names nodes of elements, and "
                                "contact is with a mesh that one moves",
                                line ? "line" : "mesh", body ? "this body is not" : "no body is");
}
