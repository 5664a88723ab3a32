// Explicit and implicit steps: the keys that are one's alone, which the other leaves unused, and what it cannot do.
#include "base/array.h"
#include "io/scene/scene_reader.h"

#include <string.h>

#include "world/definitions.h"

void brunt_note_unused(scene_reader *reader, const scene_node *map, const char *key) {
    const scene_node *child = brunt_tree_child(map, key);
    static const char *const owner[] = {"implicit", "explicit", "explicit or implicit"}, *const own[] = {
                                                                                             "explicit", "implicit",
                                                                                             "load"}; // by brunt_scheme
    _Static_assert(BRUNT_COUNT(owner) == BRUNT_STATIC + 1 && BRUNT_COUNT(own) == BRUNT_STATIC + 1,
                   "words for each scheme");
    const brunt_scheme scheme = reader->scene->world.scheme;
    if (child) brunt_scene_warn_at(reader, child, true, "of %s steps, not used by %s ones", owner[scheme], own[scheme]);
}

// Keys of Newton's method, with their defaults.
static void fill_newton(scene_reader *reader) {
    scene_node *root = reader->tree->root, *newton = brunt_tree_child(root, "newton");
    if (!newton) newton = brunt_add_default(reader, root, "newton", "{}");
    if (!newton || newton->kind != SCENE_MAP) return;
    static const char *const keys[] = {"tolerance", "iterations", "cut", "solver", "accuracy"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        char path[64];
        snprintf(path, sizeof path, "newton.%s", keys[k]);
        if (!brunt_tree_child(newton, keys[k]))
            brunt_add_default(reader, newton, keys[k], brunt_scene_row(path)->initial);
    }
    brunt_fill_fields(reader, newton, "newton", 0, &reader->scene->world);
}

static void note_unused_of_load_steps(scene_reader *reader, const scene_node *time, const char *key) {
    const scene_node *child = brunt_tree_child(time, key);
    const bool implicit = reader->scene->world.scheme == BRUNT_IMPLICIT;
    if (child)
        brunt_scene_warn_at(reader, child, true, "of load steps, not used by %s ones",
                            implicit ? "implicit" : "explicit");
}

// Load steps have a pseudo-time of their own, which tables go by: an end in seconds would change their meaning.
static void fill_load_steps(scene_reader *reader, scene_node *time) {
    brunt_world_def *world = &reader->scene->world;
    brunt_refuse_key(reader, time, "end", "load steps run over a pseudo-time from 0 to 1: no end is wanted");
    static const char *const unused[] = {"step", "cfl", "least_step", "integrator"};
    for (size_t k = 0; k < sizeof unused / sizeof *unused; k++) brunt_note_unused(reader, time, unused[k]);
    if (!brunt_tree_child(time, "predictor")) brunt_add_default(reader, time, "predictor", "tangent");
    world->predictor = (brunt_predictor)(int)brunt_real_of(time, "predictor", BRUNT_PREDICTOR_TANGENT);
    world->end = 1, world->step = world->cfl = world->least_step = 0;
    fill_newton(reader);
}

void brunt_fill_scheme(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *root = reader->tree->root, *time = brunt_tree_child(root, "time");
    if (!time || time->kind != SCENE_MAP) return;
    if (world->scheme == BRUNT_STATIC) {
        fill_load_steps(reader, time);
        return;
    }
    if (!brunt_tree_child(time, "end"))
        brunt_tree_complain_key(reader->tree, time, "'end' is missing: a time (s), the run ends exactly there");
    note_unused_of_load_steps(reader, time, "steps"), note_unused_of_load_steps(reader, time, "predictor");
    if (world->scheme == BRUNT_IMPLICIT) {
        if (!brunt_tree_child(time, "integrator")) brunt_add_default(reader, time, "integrator", "euler");
        world->integrator = (brunt_integrator)(int)brunt_real_of(time, "integrator", BRUNT_EULER);
        fill_newton(reader);
        brunt_note_unused(reader, time, "cfl"), brunt_note_unused(reader, time, "least_step");
        world->cfl = world->least_step = 0;
        return;
    }
    brunt_note_unused(reader, time, "integrator");
    brunt_note_unused(reader, root, "newton");
}

// At the value that asks for it, else at the key of what it is missing in.
static void refuse_at(void *context, const char *path, const char *reason) {
    scene_tree *tree = ((scene_reader *)context)->tree;
    const scene_node *node = brunt_tree_find(tree, path);
    // A step that is given is not missing: what is wrong with it has been said.
    if (node->kind == SCENE_SCALAR && (!strcmp(path, "time.step") || !strcmp(path, "time.steps"))) return;
    if (node->kind == SCENE_SCALAR)
        brunt_tree_complain(tree, node, "%s", reason);
    else
        brunt_tree_complain_key(tree, node, "%s", reason);
}

void brunt_check_scheme(scene_reader *reader) { brunt_scheme_refusals(&reader->scene->world, refuse_at, reader); }
