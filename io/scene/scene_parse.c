// The world that a checked tree describes, and what its keys must say together.
#include "io/scene/scene_crowd.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "io/mesh/gmsh.h"

void brunt_copy_text(scene_reader *reader, const scene_node *node, char *out, size_t size) {
    if (!node || !node->good || !node->text) return;
    if (strlen(node->text) >= size) {
        brunt_tree_complain(reader->tree, node, "too long: at most %d bytes are wanted", (int)size - 1);
        return;
    }
    memcpy(out, node->text, strlen(node->text) + 1);
}

int brunt_children_of(const scene_node *node, scene_kind kind) { return node && node->kind == kind ? node->count : 0; }

void *brunt_entries_for(scene_reader *reader, int count, size_t size) {
    if (count == 0) return NULL;
    void *memory = brunt_alloc((size_t)count * size);
    if (!memory) reader->tree->exhausted = true;
    return memory;
}

bool brunt_nonzero(const double v[3]) { return v[0] != 0 || v[1] != 0 || v[2] != 0; }

void brunt_scene_warn(scene_reader *reader, const char *format, ...) {
    if (!reader->warnings) return;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(reader->warnings, format, arguments);
    va_end(arguments);
    fputc('\n', reader->warnings);
}

void brunt_scene_warn_at(scene_reader *reader, const scene_node *node, bool at_key, const char *format, ...) {
    if (!reader->warnings) return;
    char path[512];
    brunt_tree_path(node, path, sizeof path);
    if (node->option)
        fprintf(reader->warnings, "--set %s: ", node->option);
    else
        fprintf(reader->warnings, "%s:%d:%d: %s: ", reader->tree->name, at_key ? node->key_line : node->line,
                at_key ? node->key_column : node->column, path);
    va_list arguments;
    va_start(arguments, format);
    vfprintf(reader->warnings, format, arguments);
    va_end(arguments);
    fputc('\n', reader->warnings);
}

// ---------------------------------------------------------------------------------------------------- names

const brunt_body_def *brunt_body_named(const scene_reader *reader, const char *name) {
    const brunt_world_def *world = &reader->scene->world;
    int low = 0, high = world->body_count; // in order of name
    while (low < high) {
        const int middle = low + (high - low) / 2, order = strcmp(world->bodies[middle].name, name);
        if (order == 0) return &world->bodies[middle];
        *(order < 0 ? &low : &high) = order < 0 ? middle + 1 : middle;
    }
    return NULL;
}

void brunt_complain_name(scene_reader *reader, const scene_node *node, const char *what, const char *parent) {
    enum { SHOWN = 64 };
    const char *names[SHOWN];
    int count = 0;
    const scene_node *map = brunt_tree_child(reader->tree->root, parent);
    for (const scene_node *child = map ? map->first : NULL; child && child->key && count < SHOWN; child = child->next)
        names[count++] = child->key;
    const char *nearest = brunt_nearest_name(node->text, names, count);
    char all[512] = "";
    size_t used = 0;
    for (int i = 0; i < count && used + 4 < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    if (nearest)
        brunt_tree_complain(reader->tree, node, "there is no %s '%s', did you mean '%s'?", what, node->text, nearest);
    else
        brunt_tree_complain(reader->tree, node, "there is no %s '%s'; there are: %s", what, node->text,
                            count ? all : "none");
}

void brunt_refuse_key(scene_reader *reader, const scene_node *node, const char *key, const char *why) {
    const scene_node *child = brunt_tree_child(node, key);
    if (child) brunt_tree_complain_key(reader->tree, child, "%s", why);
}

void brunt_check_body_name(scene_reader *reader, const scene_node *node) {
    if (!node || !node->good || !node->text) return;
    int32_t first;
    const int32_t count = brunt_bodies_named(reader, node->text, &first);
    if (count > 1)
        brunt_tree_complain(reader->tree, node, "'%s' is a crowd, one of its %d members is wanted, as %s.1", node->text,
                            (int)count, node->text);
    else if (!brunt_body_named(reader, node->text) &&
             !brunt_tree_child(brunt_tree_child(reader->tree->root, "bodies"), node->text))
        brunt_complain_name(reader, node, "body", "bodies");
}

// ---------------------------------------------------------------------------------------------------- time and grid

static bool has_method(const scene_reader *reader, const char *method) {
    const scene_node *bodies = brunt_tree_child(reader->tree->root, "bodies");
    for (const scene_node *body = bodies && bodies->kind == SCENE_MAP ? bodies->first : NULL; body; body = body->next)
        if (body->kind == SCENE_MAP && strcmp(brunt_text_of(body, "method", ""), method) == 0) return true;
    return false;
}

static void fill_time(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *time = brunt_tree_child(reader->tree->root, "time");
    if (!time || time->kind != SCENE_MAP) return;
    brunt_fill_fields(reader, time, "time", 0, world);
    const scene_node *step = brunt_tree_child(time, "step"), *cfl = brunt_tree_child(time, "cfl");
    // Beside each other they are for both schemes: each takes its own (scene_scheme.c says what implicit ones leave).
    if (step && cfl && world->scheme == BRUNT_EXPLICIT) {
        brunt_scene_warn_at(reader, step, true, "of implicit steps where cfl is beside it, not used by explicit ones");
        world->step = 0;
    }
    if (step && world->scheme != BRUNT_STATIC && world->step > world->end && world->end > 0)
        brunt_tree_complain(reader->tree, step, "the step is longer than the run");
    world->cfl = brunt_real_of(time, "cfl", world->cfl);
}

// What the grid is of: cells, cells cut in two, or the triangles of a file.
static void fill_cells(scene_reader *reader, const scene_node *grid) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *cells = brunt_tree_child(grid, "cells"), *mesh;
    char path[BRUNT_SCENE_PATH];
    brunt_error error = {0};
    world->cells = (brunt_cells)(int)brunt_real_of(grid, "cells", BRUNT_QUADS);
    if (!cells || cells->kind != SCENE_MAP) return;
    world->cells = BRUNT_MESH_CELLS;
    mesh = brunt_tree_child(cells, "mesh");
    if (!mesh) brunt_tree_complain(reader->tree, cells, "{mesh: FILE} is wanted, or one of the words quads, triangles");
    if (!mesh || !mesh->good || reader->dimension != 2 || !brunt_find_mesh(reader, mesh, path)) return;
    if (brunt_gmsh_read(path, "", 2, &world->background, reader->warnings, &error))
        brunt_tree_complain(reader->tree, mesh, "%s", error.message);
    else if (world->background.kind != BRUNT_TRI3)
        brunt_tree_complain(reader->tree, mesh, "its elements are of kind %s, tri3 is wanted",
                            brunt_element_name(world->background.kind));
    brunt_scale_places(cells, "unit", world->background.nodes, world->background.node_count);
}

// The word alone and the map with its default are the same: the resolved scene has the map.
static void spell_out_flip(scene_reader *reader, scene_node *transfer) {
    if (transfer->kind != SCENE_SCALAR || !transfer->good || transfer->value[0] != BRUNT_FLIP) return;
    transfer->kind = SCENE_MAP;
    brunt_add_default(reader, transfer, "flip", "0.99");
}

// The share of FLIP was one of a step, in explicit steps too: whoever gives one is told, for a version.
static void tell_of_flip(scene_reader *reader, const scene_node *transfer, const scene_node *per_step) {
    const brunt_world_def *world = &reader->scene->world;
    if (per_step)
        brunt_scene_warn_at(reader, per_step, true,
                            "what 'flip' was: 'flip' is now what is left after the time cell / 2c (of implicit steps: "
                            "after each), this one goes with the next version");
    else if (world->scheme == BRUNT_EXPLICIT && world->flip > 0 && world->flip < 1)
        brunt_scene_warn_at(reader, transfer, true,
                            "flip: %g is now what is left after the time cell / 2c, a step at cfl "
                            "0.5; what each step keeps, which it was, is {flip_per_step: %g}",
                            world->flip, world->flip);
}

static void fill_transfer(scene_reader *reader, scene_node *transfer) {
    brunt_world_def *world = &reader->scene->world;
    spell_out_flip(reader, transfer);
    if (transfer->kind != SCENE_MAP) {
        world->transfer = (brunt_transfer)(int)brunt_real_of(transfer->parent, "transfer", BRUNT_APIC);
        return;
    }
    const scene_node *flip = brunt_tree_child(transfer, "flip"), *apic = brunt_tree_child(transfer, "apic"),
                     *per_step = brunt_tree_child(transfer, "flip_per_step");
    if (!!flip + !!apic + !!per_step != 1)
        brunt_tree_complain(reader->tree, transfer,
                            "{flip: SHARE} or {apic: SHARE} is wanted, or one of the words pic, flip, apic");
    world->transfer = apic ? BRUNT_APIC : BRUNT_FLIP;
    world->flip = brunt_real_of(transfer, per_step ? "flip_per_step" : "flip", world->flip);
    world->flip_per_step = per_step != NULL;
    world->apic = brunt_real_of(transfer, "apic", world->apic);
    if (!apic) tell_of_flip(reader, transfer, per_step);
}

// Only material points need the grid; one beside finite elements alone is accepted, so that a method can be changed by
// an override.
static void fill_grid(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *grid = brunt_tree_child(reader->tree->root, "grid");
    bool only_fem = (has_method(reader, "fem") || has_method(reader, "membrane")) && !has_method(reader, "mpm");
    if (!grid && has_method(reader, "mpm")) // a body of no method is asked for that first
        brunt_tree_complain_key(reader->tree, reader->tree->root, "'grid' is missing: %s",
                                brunt_scene_row("grid")->doc);
    if (grid && only_fem) brunt_scene_warn(reader, "grid: no body is of method mpm, it is not used");
    if (!grid || grid->kind != SCENE_MAP) return;
    brunt_fill_fields(reader, grid, "grid", 0, world);
    world->kernel = (brunt_kernel)(BRUNT_LINEAR + (int)brunt_real_of(grid, "kernel", 1));
    fill_cells(reader, grid);
    scene_node *transfer = brunt_tree_child(grid, "transfer");
    if (transfer) fill_transfer(reader, transfer);
}

// Where neither step nor cfl is given: as the grid, kernel and transfer of the points ask for, or meshes alone bear.
static void fill_cfl(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *time = brunt_tree_child(reader->tree->root, "time");
    if (!time || time->kind != SCENE_MAP || brunt_tree_child(time, "step") || brunt_tree_child(time, "cfl")) return;
    const double cfl =
        has_method(reader, "mpm") ? brunt_default_cfl(world->dimension, world->kernel, world->transfer) : 0.9;
    char text[16];
    snprintf(text, sizeof text, "%g", cfl);
    brunt_add_default(reader, time, "cfl", text);
    world->cfl = brunt_real_of(time, "cfl", cfl);
}

// ---------------------------------------------------------------------------------------------------- materials

static void check_model(scene_reader *reader, const scene_node *at, const brunt_model *model, const double *parameters,
                        double density, bool with_eos) {
    real constants[BRUNT_MAX_CONSTANTS] = {0};
    const char *wrong = model->prepare ? model->prepare(parameters, density, with_eos, constants) : NULL;
    if (wrong) brunt_tree_complain_key(reader->tree, at, "%s: %s", model->name, wrong);
}

static void fill_failure(scene_reader *reader, const scene_node *node, const brunt_model *strength, bool with_eos,
                         brunt_material_def *material) {
    const brunt_model *model = brunt_find_failure(brunt_text_of(node, "model", ""));
    const scene_node *action = brunt_tree_child(node, "action");
    material->failure_action = (brunt_failure_action)(int)brunt_real_of(node, "action", BRUNT_FAILURE_ERODE);
    if (!model) return;
    snprintf(material->failure, sizeof material->failure, "%s", model->name);
    brunt_read_parameters(node, model, material->failure_parameters);
    if (strength && !strength->plastic)
        brunt_tree_complain_key(reader->tree, node, "%s does not flow plastically: it has no failure model",
                                strength->name);
    if (action && material->failure_action == BRUNT_FAILURE_SOFTEN && !with_eos)
        brunt_tree_complain(reader->tree, action, "softening wants an eos: only there is tension taken away");
}

static void fill_material(scene_reader *reader, const scene_node *node, brunt_material_def *material) {
    if (node->kind != SCENE_MAP) return;
    scene_node *eos = brunt_tree_child(node, "eos"), *viscosity = brunt_tree_child(node, "viscosity"),
               *failure = brunt_tree_child(node, "failure");
    material->density = brunt_real_of(node, "density", 0);
    snprintf(material->strength, sizeof material->strength, "%s", brunt_text_of(node, "model", ""));
    const brunt_model *strength = brunt_find_strength(material->strength);
    bool density = material->density > 0;
    if (strength && brunt_read_parameters(node, strength, material->strength_parameters) && density)
        check_model(reader, node, strength, material->strength_parameters, material->density, eos != NULL);
    if (strength && eos && !strength->accepts_eos)
        brunt_tree_complain_key(reader->tree, eos, "%s has a pressure of its own and takes no equation of state",
                                strength->name);
    if (strength && !eos && strength->needs_eos)
        brunt_tree_complain_key(reader->tree, node,
                                "%s has no pressure of its own: eos, an equation of state, is missing", strength->name);
    if (eos && eos->kind == SCENE_MAP) {
        snprintf(material->eos, sizeof material->eos, "%s", brunt_text_of(eos, "model", ""));
        const brunt_model *model = brunt_find_eos(material->eos);
        if (model && brunt_read_parameters(eos, model, material->eos_parameters) && density)
            check_model(reader, eos, model, material->eos_parameters, material->density, true);
    }
    if (failure && failure->kind == SCENE_MAP) fill_failure(reader, failure, strength, eos != NULL, material);
    if (viscosity && viscosity->kind == SCENE_MAP) {
        material->bulk_viscosity = true;
        if (brunt_read_parameters(viscosity, &brunt_bulk_viscosity, material->viscosity_parameters) && density)
            check_model(reader, viscosity, &brunt_bulk_viscosity, material->viscosity_parameters, material->density,
                        eos != NULL);
    }
}

static void fill_materials(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *map = brunt_tree_child(reader->tree->root, "materials");
    int count = brunt_children_of(map, SCENE_MAP);
    world->materials = brunt_entries_for(reader, count, sizeof *world->materials);
    if (!world->materials) return;
    for (const scene_node *child = map->first; child; child = child->next) {
        brunt_material_def *material = &world->materials[world->material_count++];
        snprintf(material->name, sizeof material->name, "%s", child->key);
        fill_material(reader, child, material);
    }
}

// ---------------------------------------------------------------------------------------------------- detonations

static bool has_explosive(const brunt_world_def *world) {
    for (int i = 0; i < world->material_count; i++) {
        const brunt_model *eos = brunt_find_eos(world->materials[i].eos);
        if (eos && eos->explosive) return true;
    }
    return false;
}

static void fill_detonations(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *list = brunt_tree_child(reader->tree->root, "detonations");
    int count = brunt_children_of(list, SCENE_LIST);
    world->detonations = brunt_entries_for(reader, count, sizeof *world->detonations);
    if (!world->detonations) return;
    if (!has_explosive(world))
        brunt_tree_complain_key(reader->tree, list, "no material is an explosive (eos: {model: jwl, ...})");
    for (const scene_node *child = list->first; child; child = child->next) {
        brunt_detonation_def *detonation = &world->detonations[world->detonation_count++];
        const scene_node *normal = brunt_tree_child(child, "normal"), *body = brunt_tree_child(child, "body");
        brunt_vector_of(child, "point", detonation->point);
        if (normal && brunt_vector_of(child, "normal", detonation->normal) && !brunt_nonzero(detonation->normal))
            brunt_tree_complain(reader->tree, normal, "the normal has zero length");
        detonation->time = brunt_real_of(child, "time", 0);
        brunt_check_body_name(reader, body);
        brunt_copy_text(reader, body, detonation->body, sizeof detonation->body);
    }
}

// ---------------------------------------------------------------------------------------------------- world

void brunt_fill_world(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *root = reader->tree->root, *loads = brunt_tree_child(root, "loads");
    *world = brunt_world_def_default();
    if (reader->dimension) world->dimension = reader->dimension;
    brunt_copy_text(reader, brunt_tree_child(root, "title"), reader->scene->title, sizeof reader->scene->title);
    world->axisymmetric = brunt_real_of(root, "axisymmetric", 0) == 1;
    fill_time(reader);
    fill_grid(reader);
    if (world->scheme == BRUNT_EXPLICIT) fill_cfl(reader);
    brunt_fill_scheme(reader);
    fill_materials(reader);
    brunt_fill_bodies(reader);
    fill_detonations(reader);
    brunt_fill_boundaries(reader);
    brunt_fill_contact(reader);
    if (loads) brunt_fill_fields(reader, loads, "loads", 0, world);
    brunt_check_scheme(reader);
}

// ---------------------------------------------------------------------------------------------------- output

void brunt_fill_output(scene_reader *reader) {
    brunt_output_def *output = &reader->scene->output;
    scene_node *node = brunt_tree_child(reader->tree->root, "output");
    if (!node || node->kind != SCENE_MAP) return;
    brunt_fill_fields(reader, node, "output", 0, output);
    output->float32 = brunt_real_of(node, "precision", 0) == 0;
    if (output->tractions && (reader->scene->world.dimension != 2 || reader->scene->world.scheme == BRUNT_EXPLICIT))
        brunt_tree_complain(reader->tree, brunt_tree_child(node, "tractions"),
                            "of two dimensions, implicit or load steps and contact.method barrier or penalty");
    const scene_node *fields = brunt_tree_child(node, "fields"), *probes = brunt_tree_child(node, "probes");
    output->fields = brunt_entries_for(reader, brunt_children_of(fields, SCENE_LIST), sizeof *output->fields);
    for (const scene_node *child = output->fields ? fields->first : NULL; child; child = child->next)
        brunt_copy_text(reader, child, output->fields[output->field_count++], sizeof *output->fields);
    output->probes = brunt_entries_for(reader, brunt_children_of(probes, SCENE_MAP), sizeof *output->probes);
    for (const scene_node *child = output->probes ? probes->first : NULL; child; child = child->next) {
        brunt_probe *probe = &output->probes[output->probe_count++];
        snprintf(probe->name, sizeof probe->name, "%.*s", BRUNT_NAME_LENGTH - 1, child->key);
        brunt_check_body_name(reader, brunt_tree_child(child, "body"));
        brunt_copy_text(reader, brunt_tree_child(child, "body"), probe->body, sizeof probe->body);
        brunt_copy_text(reader, brunt_tree_child(child, "field"), probe->field, sizeof probe->field);
        brunt_vector_of(child, "point", probe->point);
    }
}
