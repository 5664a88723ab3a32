// Planes of a scene.
#include "contact/planes/condition.h"
#include "io/scene/scene_boundary.h"

#include <math.h>

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

void brunt_fill_plane(scene_reader *reader, scene_node *node, brunt_plane_def *plane) {
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
