// Materials of the library: `preset` is replaced, before the scene is checked, by the keys it stands for, as if they
// had been typed. What the user gives beside it stays. The resolved scene then has every value and needs no library.
#include "io/scene/scene_reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct model_values {
    const brunt_model *model;
    const double *value;
} model_values;

static scene_node *add(scene_tree *tree, scene_node *map, const char *key, scene_kind kind, const char *text) {
    scene_node *node = brunt_tree_node(tree, kind);
    if (!node) return NULL;
    node->key = brunt_tree_text(tree, key, strlen(key));
    if (kind == SCENE_SCALAR) node->text = brunt_tree_text(tree, text, strlen(text));
    if (!node->key || (kind == SCENE_SCALAR && !node->text)) return NULL;
    brunt_tree_append(map, node);
    return node;
}

static void add_number(scene_tree *tree, scene_node *map, const char *key, double value) {
    char text[32];
    if (brunt_tree_child(map, key) || !isfinite(value)) return;
    brunt_format_number(value, text);
    scene_node *node = add(tree, map, key, SCENE_SCALAR, text);
    if (node) node->number = node->plain = true;
}

// The model's name and parameters where they are not given; nothing when another model is.
static void add_model(scene_tree *tree, scene_node *map, model_values from) {
    const scene_node *given = brunt_tree_child(map, "model");
    if (given && (given->kind != SCENE_SCALAR || strcmp(given->text, from.model->name) != 0)) return;
    if (!given) add(tree, map, "model", SCENE_SCALAR, from.model->name);
    for (int p = 0; p < from.model->parameter_count; p++)
        if (from.value[p] != from.model->parameters[p].initial) // defaults are added to all
            add_number(tree, map, from.model->parameters[p].key, from.value[p]);
}

// The map of a component, made when it is not there; NULL when `none` is written in its place.
static scene_node *component(scene_tree *tree, scene_node *material, const char *key) {
    scene_node *map = brunt_tree_child(material, key);
    if (!map) return add(tree, material, key, SCENE_MAP, NULL);
    return map->kind == SCENE_MAP ? map : NULL;
}

static void drop_none(scene_node *material, const char *key) {
    scene_node *child = brunt_tree_child(material, key);
    if (child && child->kind == SCENE_SCALAR && strcmp(child->text, "none") == 0) brunt_tree_remove(child);
}

static void drop_nones(scene_node *material) {
    drop_none(material, "eos");
    drop_none(material, "failure");
    drop_none(material, "viscosity");
}

static void expand(scene_tree *tree, scene_node *material) {
    scene_node *preset = brunt_tree_child(material, "preset"), *map;
    brunt_material_def def;
    if (!preset || preset->kind != SCENE_SCALAR) return;
    if (brunt_material_preset(preset->text, material->key, &def, NULL) != BRUNT_OK) {
        drop_nones(material); // the check of words says what is wrong; these are as they should be
        return;
    }
    const scene_node *model = brunt_tree_child(material, "model");
    const bool other = model && (model->kind != SCENE_SCALAR || strcmp(model->text, def.strength) != 0);
    add_number(tree, material, "density", def.density);
    add_model(tree, material, (model_values){brunt_find_strength(def.strength), def.strength_parameters});
    // Another model may have a pressure of its own, and damage has been measured for one flow stress.
    const brunt_model *given = other && model->kind == SCENE_SCALAR ? brunt_find_strength(model->text) : NULL;
    const brunt_model *eos = given && !given->accepts_eos ? NULL : brunt_find_eos(def.eos),
                      *failure = other ? NULL : brunt_find_failure(def.failure);
    if (eos && (map = component(tree, material, "eos"))) add_model(tree, map, (model_values){eos, def.eos_parameters});
    if (failure && (map = component(tree, material, "failure"))) {
        add_model(tree, map, (model_values){failure, def.failure_parameters});
        if (def.failure_action == BRUNT_FAILURE_SOFTEN && !brunt_tree_child(map, "action"))
            add(tree, map, "action", SCENE_SCALAR, "soften");
    }
    if (def.bulk_viscosity && (map = component(tree, material, "viscosity")))
        for (int p = 0; p < brunt_bulk_viscosity.parameter_count; p++)
            add_number(tree, map, brunt_bulk_viscosity.parameters[p].key, def.viscosity_parameters[p]);
    drop_nones(material);
    brunt_tree_remove(preset);
}

void brunt_expand_presets(scene_reader *reader) {
    scene_node *materials = brunt_tree_child(reader->tree->root, "materials");
    if (!materials || materials->kind != SCENE_MAP) return;
    for (scene_node *child = materials->first; child; child = child->next)
        if (child->kind == SCENE_MAP) expand(reader->tree, child);
}
