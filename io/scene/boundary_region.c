// Regions of a scene with prescribed motion.
#include "io/scene/scene_boundary.h"

#include <math.h>

static const char *const methods[] = {"mpm", "fem", "membrane"}; // by brunt_method
_Static_assert(sizeof methods / sizeof *methods == BRUNT_MEMBRANE + 1, "a name for each method");

void brunt_fill_region(scene_reader *reader, scene_node *node, brunt_region_def *region) {
    const scene_node *velocity = brunt_tree_child(node, "velocity"), *until = brunt_tree_child(node, "until");
    brunt_fill_shape_def(reader, brunt_tree_child(node, "region"), &region->shape);
    region->place = brunt_fill_placement(reader, brunt_tree_child(node, "place"));
    if (!velocity)
        brunt_tree_complain(reader->tree, node, "'velocity' is missing: a list of numbers or `free`, in m/s");
    brunt_fill_partial(reader, velocity, region->component, region->velocity);
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
